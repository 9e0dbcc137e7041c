"""Studies of a pair: analysis, sweeps, design, optimisation, wear, reports, pictures, solver comparison, commands.

``easeoff.analyze``, ``modify`` and ``optimize`` stand at the top of the package; all names here are imported on first
use.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..cases.reading import shipped_deviations
    from . import compare, library, plot, sweep
    from .analysis.joined_analysis import Analysis
    from .analysis.named_setting import derivative_settings
    from .analysis.setting_derivatives import contact_derivatives, derivatives
    from .case_in_mesh import CaseInMesh
    from .design.case_design import design_case
    from .design.design_check import DesignReport
    from .design.rounded_settings import rounded_case, rounding_effect
    from .deviations.case_correction import CaseCorrection, correct_case
    from .deviations.deviation_source import measured_file
    from .export.contact_mesh import export_contact
    from .flank_wear.wear_law import WearLaw
    from .flank_wear.wear_simulation import wear
    from .load_cases.duty_means import equivalent_torque
    from .load_cases.load_case_analysis import analyze_load_cases
    from .plot import write_pictures
    from .report.contact_report.report_file import write_report
    from .report.key_numbers import key_numbers
    from .report.notebook.result_accessor import ResultAccessor, ResultPlots, ResultSummary
    from .report.notebook.sweep_accessor import SweepAccessor, SweepPlots, SweepSummary
    from .report.summary_sheet import SummarySheet, summary_sheet
    from .vh.vh_check import vh_check

__all__ = [
    "Analysis",
    "CaseCorrection",
    "CaseInMesh",
    "DesignReport",
    "ResultAccessor",
    "ResultPlots",
    "ResultSummary",
    "SummarySheet",
    "SweepAccessor",
    "SweepPlots",
    "SweepSummary",
    "WearLaw",
    "analyze_load_cases",
    "compare",
    "contact_derivatives",
    "correct_case",
    "derivative_settings",
    "derivatives",
    "design_case",
    "equivalent_torque",
    "export_contact",
    "key_numbers",
    "library",
    "measured_file",
    "plot",
    "rounded_case",
    "rounding_effect",
    "shipped_deviations",
    "summary_sheet",
    "sweep",
    "vh_check",
    "wear",
    "write_pictures",
    "write_report",
]

_MODULES = {
    "Analysis": ".analysis.joined_analysis",
    "CaseCorrection": ".deviations.case_correction",
    "CaseInMesh": ".case_in_mesh",
    "DesignReport": ".design.design_check",
    "ResultAccessor": ".report.notebook.result_accessor",
    "ResultPlots": ".report.notebook.result_accessor",
    "ResultSummary": ".report.notebook.result_accessor",
    "SummarySheet": ".report.summary_sheet",
    "SweepAccessor": ".report.notebook.sweep_accessor",
    "SweepPlots": ".report.notebook.sweep_accessor",
    "SweepSummary": ".report.notebook.sweep_accessor",
    "WearLaw": ".flank_wear.wear_law",
    "analyze_load_cases": ".load_cases.load_case_analysis",
    "contact_analysis": ".analysis.contact_analysis",
    "contact_derivatives": ".analysis.setting_derivatives",
    "correct_case": ".deviations.case_correction",
    "derivative_settings": ".analysis.named_setting",
    "derivatives": ".analysis.setting_derivatives",
    "design_case": ".design.case_design",
    "duty_means": ".load_cases.duty_means",
    "equivalent_torque": ".load_cases.duty_means",
    "export_contact": ".export.contact_mesh",
    "fit_modification": ".design.fitted_settings",
    "flank_deviations": ".deviations.deviation_source",
    "key_numbers": ".report.key_numbers",
    "measured_file": ".deviations.deviation_source",
    "plausibility": ".report.notes.plausibility",
    "recorded_modification": ".design.fitted_settings",
    "result_summary": ".report.summary.result_summary",
    "rounded_case": ".design.rounded_settings",
    "rounding_effect": ".design.rounded_settings",
    "shipped_deviations": "..cases.reading",
    "summary_sheet": ".report.summary_sheet",
    "vh_check": ".vh.vh_check",
    "wear": ".flank_wear.wear_simulation",
    "write_pictures": ".plot",
    "write_report": ".report.contact_report.report_file",
}


def __dir__() -> list[str]:
    return [*__all__, *(name for name in globals() if name.startswith("__"))]


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        return getattr(import_module(_MODULES[name], __name__), name)
    if name in __all__:
        return import_module(f".{name}", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
