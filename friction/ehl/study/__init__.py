"""The parameter study of the film model, and the friction formula fitted to it."""

from .formula_regression import compare, fit_friction
from .friction_formula import FrictionFormula, shipped_formula
from .parameter_study import run_study
from .study_case import Resolution
from .study_design import Design

__all__ = [
    "Design",
    "FrictionFormula",
    "Resolution",
    "compare",
    "fit_friction",
    "run_study",
    "shipped_formula",
]
