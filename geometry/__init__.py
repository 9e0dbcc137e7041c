"""Tooth flanks, blanks, ease-off and surface of roll angle: geometry alone, no loads."""

from .assembly import Assembly, Misalignment
from .basic_settings import blank_section, formate_gear, generated_gear
from .blade import Blade
from .blank import BlankDesign, BlankDimensions, blank_dimensions
from .conjugate_pinion import conjugate_pinion
from .corrective_settings import Correction, corrective_settings
from .deviated_ease_off import deviated_ease_off
from .deviated_surface import deviated_pair
from .deviation import Deviation, deviation_from_dataset, deviation_from_formula
from .flank_errors import FlankErrors, fit_flank_errors
from .flank_surface import NodeStatus
from .generating_surface import GeneratingSurface
from .machine import MachineSettings
from .modification import Modification, modified_ease_off
from .pair import GearPair, Member, PairGeometry, ease_off, flank, pair_geometry
from .section import BlankSection
from .synthesis import EaseOffTarget, Synthesis, fit_pinion

__all__ = [
    "Assembly",
    "Blade",
    "BlankDesign",
    "BlankDimensions",
    "BlankSection",
    "Correction",
    "Deviation",
    "EaseOffTarget",
    "FlankErrors",
    "GearPair",
    "GeneratingSurface",
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
    "fit_flank_errors",
    "fit_pinion",
    "flank",
    "formate_gear",
    "generated_gear",
    "modified_ease_off",
    "pair_geometry",
]
