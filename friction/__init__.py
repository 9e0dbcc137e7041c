"""Lubricants, film, friction coefficient, power loss and efficiency; in SI."""

from .coefficient import COEFFICIENTS, coefficient_model, contact_conditions, friction_coefficient
from .conditions import ContactConditions
from .efficiency import friction
from .feedback import friction_feedback
from .film_thickness import FILMS
from .kolivand_formula import formula_flags
from .lubricant import Lubricant, OilState, available_lubricants, lubricant
from .operation import FrictionModel, Operation
from .rolling_traction import THERMAL_FACTORS, rolling_traction

__all__ = [
    "COEFFICIENTS",
    "FILMS",
    "THERMAL_FACTORS",
    "ContactConditions",
    "FrictionModel",
    "Lubricant",
    "OilState",
    "Operation",
    "available_lubricants",
    "coefficient_model",
    "contact_conditions",
    "formula_flags",
    "friction",
    "friction_coefficient",
    "friction_feedback",
    "lubricant",
    "rolling_traction",
]
