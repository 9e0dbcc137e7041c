from . import (
    cases as cases,
    contact as contact,
    friction as friction,
    geometry as geometry,
    study as study,
    verification as verification,
)
from .cases import Case as Case, read_case as read_case
from .core.errors import (
    EaseoffError as EaseoffError,
    GeometryError as GeometryError,
    InputError as InputError,
    MissingPackageError as MissingPackageError,
    MissingSolverError as MissingSolverError,
)
from .study import plot as plot
from .study.analysis.case_analysis import analyze as analyze
from .study.design.optimal_modification import modify as modify
from .study.design.optimization.setting_optimization import optimize as optimize
from .study.result import read_result as read_result, write_result as write_result
from .study.sweep.parameter_sweep import sweep as sweep

__version__: str

__all__: list[str]
