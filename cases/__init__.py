"""Case and design files: schemas, reading, checking and writing, the shipped ones, exchange with other programs."""

from .conversion import gear_pair
from .reading import parse_case, parse_design, read_case, read_design, shipped_cases, shipped_designs
from .rexs.rexs_reading import read_rexs
from .rexs.rexs_writing import write_rexs
from .schema.case_schema import Case
from .schema.design_schema import Design
from .session.session_script import read_session_script
from .writing import case_toml, write_case

__all__ = [
    "Case",
    "Design",
    "case_toml",
    "gear_pair",
    "parse_case",
    "parse_design",
    "read_case",
    "read_design",
    "read_rexs",
    "read_session_script",
    "shipped_cases",
    "shipped_designs",
    "write_case",
    "write_rexs",
]
