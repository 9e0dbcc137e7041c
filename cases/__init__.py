"""Case and design files: their schema, reading, checking and writing, and the shipped ones."""

from .conversion import gear_pair
from .design_model import Design
from .model import Case
from .reading import parse_case, parse_design, read_case, read_design, shipped_cases, shipped_designs
from .writing import case_toml

__all__ = [
    "Case",
    "Design",
    "case_toml",
    "gear_pair",
    "parse_case",
    "parse_design",
    "read_case",
    "read_design",
    "shipped_cases",
    "shipped_designs",
]
