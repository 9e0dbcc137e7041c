"""The parameter study of the film model, and the friction formula fitted to it."""

from .formula_regression import compare, fit_friction, study_inputs
from .friction_formula import FrictionFormula, read_formula, shipped_formula, write_formula
from .parameter_study import run_study, study_dataset
from .study_case import Resolution, run_case
from .study_design import Condition, Design

__all__ = [
    "Condition",
    "Design",
    "FrictionFormula",
    "Resolution",
    "compare",
    "fit_friction",
    "read_formula",
    "run_case",
    "run_study",
    "shipped_formula",
    "study_dataset",
    "study_inputs",
    "write_formula",
]
