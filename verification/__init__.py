"""Independent methods that check the product; the product imports nothing from here but the command ``verify``.

================================  =================================================================================
what is checked                   by
================================  =================================================================================
whole case                        ``verify``: all below that apply to a pair, one row a comparison
flanks                            ``envelope_condition``: motion of the cutter joint by joint, by differences
ease-off, unloaded contact        ``both_methods``, ``path_of_contact``: conventional analysis, five equations
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
free ends of teeth                ``end_relief``: bricks of a body with a free end face, at which a line load ends
================================  =================================================================================
"""

from .case_verification import Verification, verify
from .conventional_analysis import RelativeCurvature, relative_curvature
from .correction_loop import CorrectionLoop, correction_loop
from .end_relief import EndRelief, end_relief
from .envelope_condition import EnvelopeCondition, envelope_condition
from .flank_contact import FlankContact, contact_of_flanks
from .flank_response import FlankResponse, flank_response
from .problem_classes import problems
from .shell_root_stress import shell_root_stress
from .smallest_gap import SmallestGap, smallest_gap
from .surface_cells import FlanksInMesh, flanks_in_mesh
from .verified_pair import RowStatus, VerificationRow

__all__ = ["CorrectionLoop", "EndRelief", "EnvelopeCondition", "FlankContact", "FlankResponse", "FlanksInMesh"]
__all__ += ["RelativeCurvature", "RowStatus", "SmallestGap", "Verification", "VerificationRow", "contact_of_flanks"]
__all__ += ["correction_loop", "end_relief", "envelope_condition", "flank_response", "flanks_in_mesh", "problems"]
__all__ += ["relative_curvature", "shell_root_stress", "smallest_gap", "verify"]
