"""The parameter study of the film model, and the friction formula fitted to it."""

from .friction_formula import FrictionFormula, compare, fit_friction, shipped_formula
from .study_design import Design, Resolution, run_study

__all__ = [
    "Design",
    "FrictionFormula",
    "Resolution",
    "compare",
    "fit_friction",
    "run_study",
    "shipped_formula",
]
