from .friction_formula import (
    FrictionFormula as FrictionFormula,
    compare as compare,
    fit_friction as fit_friction,
    shipped_formula as shipped_formula,
)
from .study_design import Design as Design, Resolution as Resolution, run_study as run_study

__all__: list[str]
