from . import compare as compare, library as library, plot as plot, sweep as sweep
from .analysis.contact_analysis import Analysis as Analysis
from .analysis.key_numbers import key_numbers as key_numbers
from .analysis.setting_derivatives import (
    contact_derivatives as contact_derivatives,
    derivative_settings as derivative_settings,
    derivatives as derivatives,
)
from .case_correction import CaseCorrection as CaseCorrection, correct_case as correct_case
from .case_in_mesh import CaseInMesh as CaseInMesh
from .design.case_design import design_case as design_case
from .design.design_check import DesignReport as DesignReport
from .design.rounded_settings import rounded_case as rounded_case, rounding_effect as rounding_effect
from .deviations import measured_file as measured_file, shipped_deviations as shipped_deviations
from .load_case_analysis import analyze_load_cases as analyze_load_cases, equivalent_torque as equivalent_torque
from .notebook.accessors import (
    ResultAccessor as ResultAccessor,
    ResultPlots as ResultPlots,
    ResultSummary as ResultSummary,
    SweepAccessor as SweepAccessor,
    SweepPlots as SweepPlots,
    SweepSummary as SweepSummary,
)
from .plot import write_pictures as write_pictures
from .report.contact_mesh import export_contact as export_contact
from .report.report_file import write_report as write_report
from .report.written_comparison import write_comparison as write_comparison
from .summary.summary_sheet import SummarySheet as SummarySheet, summary_sheet as summary_sheet
from .vh import vh_check as vh_check
from .wear_simulation import WearLaw as WearLaw, wear as wear

__all__: list[str]
