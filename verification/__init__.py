"""Independent methods that check the product; the product imports nothing from here but the command ``verify``.

================================  =================================================================================
what is checked                   by
================================  =================================================================================
whole case                        ``verify``: all below that apply to a pair, one row a comparison
flanks                            ``envelope_condition``: motion of the cutter joint by joint, by differences
ease-off, unloaded contact        ``both_methods``, ``point_contact``: conventional contact analysis, five equations
unloaded contact, edges included  ``smallest_gap``, ``smallest_envelope``: direct search over both bounded flanks
gap beside a contact line         ``flank_gap``: along the normal between the generated flanks; ``segment_gaps``
curvatures of a flank             ``directional_curvatures``: along two directions, by complex steps
contact line and ellipse          ``relative_curvature``
loaded contact                    ``contact_of_flanks``: pressures on cells of the flank, without a split into bending
                                  and indentation, by ``flank_response`` and ``half_space_compliance``
root stress                       ``shell_root_stress``: section forces in the shell's root springs
measured deviations               ``distance_along_normals``
corrective settings               ``correction_loop``: cut, measure, correct, cut with the same errors, measure
solvers of the contact problem    ``problems`` of the ``PROBLEM_CLASSES``
shell                             ``thesis_kinematics``, ``monomials``: the dissertation's own
teeth on one body                 ``toothed_sector``: all teeth and their body as one lattice, solved whole
free ends of teeth                ``end_relief``: bricks of a body with a free end face, at which a line load ends
finite elements                   ``serendipity_functions``: the element of other programs
================================  =================================================================================
"""

from .case_verification import Verification, verify
from .conventional_analysis import BothMethods, both_methods, line_differences, methods_compared, point_differences
from .cutter_motion import cutter_position
from .directional_curvature import DirectionalCurvatures, ShapeOperator, directional_curvatures
from .envelope_condition import EnvelopeCondition, envelope_condition
from .finite_element_bodies.end_relief import EndRelief, end_relief
from .finite_element_bodies.serendipity_brick import serendipity_functions
from .finite_element_bodies.toothed_sector import ToothedSector, toothed_sector
from .flank_contact.flank_contact import FlankContact, contact_of_flanks
from .flank_contact.flank_response import FlankResponse, flank_response
from .flank_contact.line_stations import LineStations, line_stations, response_size
from .flank_contact.segment_gap import SegmentGaps, exact_gap, segment_gaps
from .flank_contact.surface_cells import FlanksInMesh, SurfaceCells, flanks_in_mesh, flanks_of
from .flank_contact.surface_contact import half_space_compliance
from .flank_gap import FlankGap, flank_gap
from .measuring.correction_loop import CORRECTION_LOOPS, CorrectionLoop, correction_loop
from .measuring.measured_distance import distance_along_normals
from .point_contact import PointContact, path_of_contact, point_contact
from .problem_classes import PROBLEM_CLASSES, problems
from .relative_curvature import RelativeCurvature, relative_curvature
from .shell_root_stress import shell_root_stress
from .smallest_gap import SmallestGap, smallest_envelope, smallest_gap
from .thesis_shell import monomials, thesis_kinematics
from .yardsticks.verification_row import RowStatus, VerificationRow

__all__ = [
    "CORRECTION_LOOPS",
    "PROBLEM_CLASSES",
    "BothMethods",
    "CorrectionLoop",
    "DirectionalCurvatures",
    "EndRelief",
    "EnvelopeCondition",
    "FlankContact",
    "FlankGap",
    "FlankResponse",
    "FlanksInMesh",
    "LineStations",
    "PointContact",
    "RelativeCurvature",
    "RowStatus",
    "SegmentGaps",
    "ShapeOperator",
    "SmallestGap",
    "SurfaceCells",
    "ToothedSector",
    "Verification",
    "VerificationRow",
    "both_methods",
    "contact_of_flanks",
    "correction_loop",
    "cutter_position",
    "directional_curvatures",
    "distance_along_normals",
    "end_relief",
    "envelope_condition",
    "exact_gap",
    "flank_gap",
    "flank_response",
    "flanks_in_mesh",
    "flanks_of",
    "half_space_compliance",
    "line_differences",
    "line_stations",
    "methods_compared",
    "monomials",
    "path_of_contact",
    "point_contact",
    "point_differences",
    "problems",
    "relative_curvature",
    "response_size",
    "segment_gaps",
    "serendipity_functions",
    "shell_root_stress",
    "smallest_envelope",
    "smallest_gap",
    "thesis_kinematics",
    "toothed_sector",
    "verify",
]
