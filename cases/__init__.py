"""Case and design files: schemas, reading, checking and writing, the shipped ones, exchange with other programs."""

from .conversion import designed_blanks, ease_off_target, elastic_model, gear_pair
from .load_cases import load_case_misalignment, read_load_cases
from .reading import (
    case_text,
    design_text,
    parse_case,
    parse_design,
    read_case,
    read_design,
    shipped_cases,
    shipped_designs,
)
from .rexs.rexs_reading import read_rexs
from .rexs.rexs_writing import write_rexs
from .schema.case_schema import Case, ContactTable
from .schema.design_schema import Design
from .schema.friction_table import FrictionTable
from .schema.load_case_table import LoadCase
from .session.session_script import read_session_script
from .writing import case_toml, write_case

__all__ = [
    "Case",
    "ContactTable",
    "Design",
    "FrictionTable",
    "LoadCase",
    "case_text",
    "case_toml",
    "design_text",
    "designed_blanks",
    "ease_off_target",
    "elastic_model",
    "gear_pair",
    "load_case_misalignment",
    "parse_case",
    "parse_design",
    "read_case",
    "read_design",
    "read_load_cases",
    "read_rexs",
    "read_session_script",
    "shipped_cases",
    "shipped_designs",
    "write_case",
    "write_rexs",
]
