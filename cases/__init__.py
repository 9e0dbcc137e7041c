"""Case and design files: schemas, reading, checking and writing, the shipped ones, exchange with other programs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..core.lazy_names import lazy_names

if TYPE_CHECKING:
    from .conversion import designed_blanks, gear_pair
    from .deflection_table import read_deflections
    from .deflections import Deflections
    from .load_cases import read_load_cases
    from .reading import (
        case_text,
        design_text,
        parse_case,
        parse_design,
        read_case,
        read_design,
        read_supports,
        shipped_cases,
        shipped_designs,
        shipped_supports,
        with_supports,
    )
    from .rexs.rexs_reading import read_rexs
    from .rexs.rexs_writing import write_rexs
    from .schema.case_schema import Case
    from .schema.design_schema import Design
    from .schema.load_case_table import LoadCase
    from .schema.supports_table import SupportsTable
    from .session_script import read_session_script
    from .support_conversion import support_system
    from .writing import case_toml, write_case

__all__ = [
    "Case",
    "Deflections",
    "Design",
    "LoadCase",
    "SupportsTable",
    "case_text",
    "case_toml",
    "design_text",
    "designed_blanks",
    "gear_pair",
    "parse_case",
    "parse_design",
    "read_case",
    "read_deflections",
    "read_design",
    "read_load_cases",
    "read_rexs",
    "read_session_script",
    "read_supports",
    "shipped_cases",
    "shipped_designs",
    "shipped_supports",
    "support_system",
    "with_supports",
    "write_case",
    "write_rexs",
]

_ORIGINS = {
    ".conversion": ["designed_blanks", "gear_pair"],
    ".deflection_table": ["read_deflections"],
    ".deflections": ["Deflections"],
    ".load_cases": ["read_load_cases"],
    ".reading": [
        "case_text",
        "design_text",
        "parse_case",
        "parse_design",
        "read_case",
        "read_design",
        "read_supports",
        "shipped_cases",
        "shipped_designs",
        "shipped_supports",
        "with_supports",
    ],
    ".rexs.rexs_reading": ["read_rexs"],
    ".rexs.rexs_writing": ["write_rexs"],
    ".schema.case_schema": ["Case"],
    ".schema.design_schema": ["Design"],
    ".schema.load_case_table": ["LoadCase"],
    ".schema.supports_table": ["SupportsTable"],
    ".session_script": ["read_session_script"],
    ".support_conversion": ["support_system"],
    ".writing": ["case_toml", "write_case"],
}
__getattr__, __dir__ = lazy_names(__name__, _ORIGINS)
