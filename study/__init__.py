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
    from .analysis.contact_analysis import Analysis
    from .analysis.key_numbers import key_numbers
    from .analysis.setting_derivatives import contact_derivatives, derivative_settings, derivatives
    from .case_correction import CaseCorrection, correct_case
    from .case_in_mesh import CaseInMesh
    from .design.case_design import design_case
    from .design.design_check import DesignReport
    from .design.rounded_settings import rounded_case, rounding_effect
    from .deviation_source import measured_file
    from .load_case_analysis import analyze_load_cases, equivalent_torque
    from .notebook.result_accessor import ResultAccessor, ResultPlots, ResultSummary
    from .notebook.sweep_accessor import SweepAccessor, SweepPlots, SweepSummary
    from .plot import write_pictures
    from .report.contact_mesh import export_contact
    from .report.report_file import write_report
    from .report.written_comparison import write_comparison
    from .summary.summary_sheet import SummarySheet, summary_sheet
    from .vh import vh_check
    from .wear_simulation import WearLaw, wear

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
    "write_comparison",
    "write_pictures",
    "write_report",
]

_MODULES = {
    "Analysis": ".analysis.contact_analysis",
    "CaseCorrection": ".case_correction",
    "CaseInMesh": ".case_in_mesh",
    "DesignReport": ".design.design_check",
    "ResultAccessor": ".notebook.result_accessor",
    "ResultPlots": ".notebook.result_accessor",
    "ResultSummary": ".notebook.result_accessor",
    "SummarySheet": ".summary.summary_sheet",
    "SweepAccessor": ".notebook.sweep_accessor",
    "SweepPlots": ".notebook.sweep_accessor",
    "SweepSummary": ".notebook.sweep_accessor",
    "WearLaw": ".wear_simulation",
    "analyze_load_cases": ".load_case_analysis",
    "contact_analysis": ".analysis.contact_analysis",
    "contact_derivatives": ".analysis.setting_derivatives",
    "correct_case": ".case_correction",
    "derivative_settings": ".analysis.setting_derivatives",
    "derivatives": ".analysis.setting_derivatives",
    "design_case": ".design.case_design",
    "duty_means": ".load_case_analysis",
    "equivalent_torque": ".load_case_analysis",
    "export_contact": ".report.contact_mesh",
    "fit_modification": ".design.case_design",
    "flank_deviations": ".deviation_source",
    "key_numbers": ".analysis.key_numbers",
    "measured_file": ".deviation_source",
    "plausibility": ".summary.plausibility",
    "recorded_modification": ".design.case_design",
    "result_summary": ".summary.result_summary",
    "rounded_case": ".design.rounded_settings",
    "rounding_effect": ".design.rounded_settings",
    "shipped_deviations": "..cases.reading",
    "summary_sheet": ".summary.summary_sheet",
    "vh_check": ".vh",
    "wear": ".wear_simulation",
    "write_comparison": ".report.written_comparison",
    "write_pictures": ".plot",
    "write_report": ".report.report_file",
}


def __dir__() -> list[str]:
    return [*__all__, *(name for name in globals() if name.startswith("__"))]


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        return getattr(import_module(_MODULES[name], __name__), name)
    if name in __all__:
        return import_module(f".{name}", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
