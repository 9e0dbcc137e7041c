"""Case files: their schema, reading and checking, and the shipped cases."""

from .conversion import gear_pair
from .model import Case
from .reading import parse_case, read_case, shipped_cases

__all__ = ["Case", "gear_pair", "parse_case", "read_case", "shipped_cases"]
