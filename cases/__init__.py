"""Case files: their schema, reading, checking and writing, the shipped cases, and exchange with other programs."""

from .conversion import gear_pair
from .model import Case
from .reading import parse_case, read_case, shipped_cases
from .rexs_reading import read_rexs
from .rexs_writing import write_rexs
from .session_script import read_session_script
from .writing import case_toml, write_case

__all__ = [
    "Case",
    "case_toml",
    "gear_pair",
    "parse_case",
    "read_case",
    "read_rexs",
    "read_session_script",
    "shipped_cases",
    "write_case",
    "write_rexs",
]
