"""Lubricants, film, friction coefficient, power loss and efficiency; in SI."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..core.lazy_names import lazy_names
from .rolling_traction import rolling_traction

if TYPE_CHECKING:
    from .coefficient import COEFFICIENTS, friction_coefficient
    from .conditions import ContactConditions
    from .contact_temperature import MatchedBand, blok_flash_temperature, flash_temperature, matched_band
    from .efficiency import friction
    from .feedback import friction_feedback
    from .film_thickness import FILM_FACTORS, FILMS, THERMAL_FACTORS
    from .kolivand_formula import formula_flags
    from .lubricants.data_sheet import data_sheet_lubricant, write_lubricant
    from .lubricants.lubricant import Lubricant, OilState, available_lubricants, lubricant
    from .operation import FrictionModel, Operation

__all__ = [
    "COEFFICIENTS",
    "FILMS",
    "FILM_FACTORS",
    "THERMAL_FACTORS",
    "ContactConditions",
    "FrictionModel",
    "Lubricant",
    "MatchedBand",
    "OilState",
    "Operation",
    "available_lubricants",
    "blok_flash_temperature",
    "data_sheet_lubricant",
    "flash_temperature",
    "formula_flags",
    "friction",
    "friction_coefficient",
    "friction_feedback",
    "lubricant",
    "matched_band",
    "rolling_traction",
    "write_lubricant",
]

_ORIGINS = {
    ".coefficient": ["COEFFICIENTS", "friction_coefficient"],
    ".conditions": ["ContactConditions"],
    ".contact_temperature": ["MatchedBand", "blok_flash_temperature", "flash_temperature", "matched_band"],
    ".efficiency": ["friction"],
    ".feedback": ["friction_feedback"],
    ".film_thickness": ["FILMS", "FILM_FACTORS", "THERMAL_FACTORS"],
    ".kolivand_formula": ["formula_flags"],
    ".lubricants.data_sheet": ["data_sheet_lubricant", "write_lubricant"],
    ".lubricants.lubricant": ["Lubricant", "OilState", "available_lubricants", "lubricant"],
    ".operation": ["FrictionModel", "Operation"],
}
__getattr__, __dir__ = lazy_names(__name__, _ORIGINS)
