"""Lubricants, film, friction coefficient, power loss and efficiency; in SI."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..core.lazy_names import lazy_names
from .rolling_traction import rolling_traction

if TYPE_CHECKING:
    from .coefficient import COEFFICIENTS, coefficient_model, contact_conditions, friction_coefficient
    from .conditions import ContactConditions
    from .efficiency import friction
    from .feedback import friction_feedback
    from .film_thickness import FILMS
    from .formula_range import FLAGS
    from .kolivand_formula import formula_flags
    from .lubricants.data_sheet import data_sheet_lubricant, lubricant_toml, write_lubricant
    from .lubricants.lubricant import Lubricant, OilState, available_lubricants, lubricant
    from .operation import FrictionModel, Operation
    from .thermal_factors import FILM_FACTORS, THERMAL_FACTORS

__all__ = [
    "COEFFICIENTS",
    "FILMS",
    "FILM_FACTORS",
    "FLAGS",
    "THERMAL_FACTORS",
    "ContactConditions",
    "FrictionModel",
    "Lubricant",
    "OilState",
    "Operation",
    "available_lubricants",
    "coefficient_model",
    "contact_conditions",
    "data_sheet_lubricant",
    "formula_flags",
    "friction",
    "friction_coefficient",
    "friction_feedback",
    "lubricant",
    "lubricant_toml",
    "rolling_traction",
    "write_lubricant",
]

_ORIGINS = {
    ".coefficient": ["COEFFICIENTS", "coefficient_model", "contact_conditions", "friction_coefficient"],
    ".conditions": ["ContactConditions"],
    ".efficiency": ["friction"],
    ".feedback": ["friction_feedback"],
    ".film_thickness": ["FILMS"],
    ".formula_range": ["FLAGS"],
    ".kolivand_formula": ["formula_flags"],
    ".lubricants.data_sheet": ["data_sheet_lubricant", "lubricant_toml", "write_lubricant"],
    ".lubricants.lubricant": ["Lubricant", "OilState", "available_lubricants", "lubricant"],
    ".operation": ["FrictionModel", "Operation"],
    ".thermal_factors": ["FILM_FACTORS", "THERMAL_FACTORS"],
}
__getattr__, __dir__ = lazy_names(__name__, _ORIGINS)
