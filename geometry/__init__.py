"""Tooth flanks, blanks, ease-off and surface of roll angle: geometry alone, no loads."""

from .cutting.blade import Blade
from .cutting.generating_surface import GeneratingSurface
from .cutting.machine import MachineSettings
from .design.basic_settings import blank_section, formate_gear, generated_gear
from .design.blank import BlankDesign, BlankDimensions, blank_dimensions
from .design.conjugate_pinion import conjugate_pinion
from .design.synthesis import EaseOffTarget, Synthesis, fit_pinion
from .deviation.corrective_settings import Correction, corrective_settings
from .deviation.deviated_flank import deviated_pair
from .deviation.deviation import Deviation, deviation_from_dataset, deviation_from_formula
from .deviation.ease_off_update import deviated_ease_off
from .deviation.global_errors import GlobalErrors, fit_global_errors
from .flanks.blank_section import BlankSection
from .flanks.flank import NodeStatus
from .pair.assembly import Assembly, Misalignment
from .pair.gear_pair import GearPair, Member, PairGeometry, ease_off, flank, pair_geometry
from .pair.modification import Modification, modified_ease_off

__all__ = [
    "Assembly",
    "Blade",
    "BlankDesign",
    "BlankDimensions",
    "BlankSection",
    "Correction",
    "Deviation",
    "EaseOffTarget",
    "GearPair",
    "GeneratingSurface",
    "GlobalErrors",
    "MachineSettings",
    "Member",
    "Misalignment",
    "Modification",
    "NodeStatus",
    "PairGeometry",
    "Synthesis",
    "blank_dimensions",
    "blank_section",
    "conjugate_pinion",
    "corrective_settings",
    "deviated_ease_off",
    "deviated_pair",
    "deviation_from_dataset",
    "deviation_from_formula",
    "ease_off",
    "fit_global_errors",
    "fit_pinion",
    "flank",
    "formate_gear",
    "generated_gear",
    "modified_ease_off",
    "pair_geometry",
]
