"""Tooth flanks, blanks, ease-off and surface of roll angle: geometry alone, no loads."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..core.lazy_names import lazy_names

if TYPE_CHECKING:
    from .cutting.blade import Blade, BladeSection
    from .cutting.generating_surface import GeneratingSurface, Hand
    from .cutting.machine import MachineSettings
    from .cutting.named_settings import MachineResolution
    from .design.basic_settings import blank_section, formate_gear
    from .design.blank import BlankDesign, BlankDimensions, blank_dimensions
    from .design.conjugate_pinion import conjugate_pinion
    from .design.synthesis import EaseOffTarget, Synthesis, fit_pinion
    from .deviation.corrective_settings import Correction, corrective_settings
    from .deviation.deviated_flank import departure
    from .deviation.deviation import Deviation, deviation_from_formula
    from .deviation.global_errors import GlobalErrors, angle_errors, fit_global_errors
    from .deviation.machine_set_up import shares_set_up, usual_settings
    from .flanks.blank_section import BlankSection
    from .flanks.curvature import principal_curvatures
    from .flanks.flank import Flank
    from .pair.assembly import Assembly, Misalignment
    from .pair.gear_pair import FlankName, GearPair, Member, PairGeometry, ease_off, flank, pair_geometry
    from .pair.modification import Modification
    from .tooth.tooth_flanks import tooth_angle
    from .tooth.tooth_lattice import LatticeSize, ToothLattice, tooth_lattice
    from .tooth.tooth_surface import tooth_patches

__all__ = [
    "Assembly",
    "Blade",
    "BladeSection",
    "BlankDesign",
    "BlankDimensions",
    "BlankSection",
    "Correction",
    "Deviation",
    "EaseOffTarget",
    "Flank",
    "FlankName",
    "GearPair",
    "GeneratingSurface",
    "GlobalErrors",
    "Hand",
    "LatticeSize",
    "MachineResolution",
    "MachineSettings",
    "Member",
    "Misalignment",
    "Modification",
    "PairGeometry",
    "Synthesis",
    "ToothLattice",
    "angle_errors",
    "blank_dimensions",
    "blank_section",
    "conjugate_pinion",
    "corrective_settings",
    "departure",
    "deviation_from_formula",
    "ease_off",
    "fit_global_errors",
    "fit_pinion",
    "flank",
    "formate_gear",
    "pair_geometry",
    "principal_curvatures",
    "shares_set_up",
    "tooth_angle",
    "tooth_lattice",
    "tooth_patches",
    "usual_settings",
]

_ORIGINS = {
    ".cutting.blade": ["Blade", "BladeSection"],
    ".cutting.generating_surface": ["GeneratingSurface", "Hand"],
    ".cutting.machine": ["MachineSettings"],
    ".cutting.named_settings": ["MachineResolution"],
    ".design.basic_settings": ["blank_section", "formate_gear"],
    ".design.blank": ["BlankDesign", "BlankDimensions", "blank_dimensions"],
    ".design.conjugate_pinion": ["conjugate_pinion"],
    ".design.synthesis": ["EaseOffTarget", "Synthesis", "fit_pinion"],
    ".deviation.corrective_settings": ["Correction", "corrective_settings"],
    ".deviation.deviated_flank": ["departure"],
    ".deviation.deviation": ["Deviation", "deviation_from_formula"],
    ".deviation.global_errors": ["GlobalErrors", "angle_errors", "fit_global_errors"],
    ".deviation.machine_set_up": ["shares_set_up", "usual_settings"],
    ".flanks.blank_section": ["BlankSection"],
    ".flanks.curvature": ["principal_curvatures"],
    ".flanks.flank": ["Flank"],
    ".pair.assembly": ["Assembly", "Misalignment"],
    ".pair.gear_pair": ["FlankName", "GearPair", "Member", "PairGeometry", "ease_off", "flank", "pair_geometry"],
    ".pair.modification": ["Modification"],
    ".tooth.tooth_flanks": ["tooth_angle"],
    ".tooth.tooth_lattice": ["LatticeSize", "ToothLattice", "tooth_lattice"],
    ".tooth.tooth_surface": ["tooth_patches"],
}
__getattr__, __dir__ = lazy_names(__name__, _ORIGINS)
