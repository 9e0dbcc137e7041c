"""Tooth flanks, blanks, ease-off and surface of roll angle: geometry alone, no loads."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..core.lazy_names import lazy_names

if TYPE_CHECKING:
    from .cutting.blade import Blade
    from .cutting.blade_sections import BladeSection, Relief
    from .cutting.generating_surface import GeneratingSurface, Hand
    from .cutting.machine import MachineSettings, work_rotation
    from .cutting.machine_pose import machine_pose
    from .cutting.machine_resolution import MachineResolution, SettingStep, setting_step
    from .cutting.named_settings import get_setting, with_settings
    from .design.basic_settings import blank_section, formate_gear, generated_gear, hobbing_blade
    from .design.blank import (
        BlankDesign,
        BlankDimensions,
        PitchCones,
        blank_design_from_symbols,
        blank_dimensions,
        dimensions_by_symbol,
    )
    from .design.conjugate_pinion import conjugate_pinion
    from .design.synthesis import FREE_SETTINGS, EaseOffTarget, Synthesis, fit_pinion
    from .deviation.corrective_settings import CorrectedFlank, Correction, corrective_settings
    from .deviation.deviated_flank import deviated_pair
    from .deviation.deviation import Deviation, deviation_from_dataset, deviation_from_formula
    from .deviation.ease_off_update import deviated_ease_off
    from .deviation.global_errors import GlobalErrors, angle_errors, fit_global_errors
    from .deviation.machine_set_up import (
        FREE_FORMATE_SETTINGS,
        FREE_MACHINE_SETTINGS,
        movable_settings,
        shares_set_up,
        usual_settings,
    )
    from .deviation.recut_flank import departure
    from .flanks.blank_section import BlankSection
    from .flanks.curvature import principal_curvatures
    from .flanks.flank import Flank, NodeStatus, solve_flank
    from .pair.assembly import Assembly, Misalignment
    from .pair.ease_off import EaseOff, exact_ease_off
    from .pair.gear_pair import FlankName, GearPair, Member, PairGeometry, ease_off, flank, pair_geometry
    from .pair.modification import Modification, modified_ease_off
    from .tooth.lattice_spacing import LatticeSpacing
    from .tooth.tooth_flanks import MemberName, named_member, tooth_angle
    from .tooth.tooth_lattice import LatticeSize, ToothLattice, tooth_lattice
    from .tooth.tooth_surface import tooth_patches

__all__ = [
    "FREE_FORMATE_SETTINGS",
    "FREE_MACHINE_SETTINGS",
    "FREE_SETTINGS",
    "Assembly",
    "Blade",
    "BladeSection",
    "BlankDesign",
    "BlankDimensions",
    "BlankSection",
    "CorrectedFlank",
    "Correction",
    "Deviation",
    "EaseOff",
    "EaseOffTarget",
    "Flank",
    "FlankName",
    "GearPair",
    "GeneratingSurface",
    "GlobalErrors",
    "Hand",
    "LatticeSize",
    "LatticeSpacing",
    "MachineResolution",
    "MachineSettings",
    "Member",
    "MemberName",
    "Misalignment",
    "Modification",
    "NodeStatus",
    "PairGeometry",
    "PitchCones",
    "Relief",
    "SettingStep",
    "Synthesis",
    "ToothLattice",
    "angle_errors",
    "blank_design_from_symbols",
    "blank_dimensions",
    "blank_section",
    "conjugate_pinion",
    "corrective_settings",
    "departure",
    "deviated_ease_off",
    "deviated_pair",
    "deviation_from_dataset",
    "deviation_from_formula",
    "dimensions_by_symbol",
    "ease_off",
    "exact_ease_off",
    "fit_global_errors",
    "fit_pinion",
    "flank",
    "formate_gear",
    "generated_gear",
    "get_setting",
    "hobbing_blade",
    "machine_pose",
    "modified_ease_off",
    "movable_settings",
    "named_member",
    "pair_geometry",
    "principal_curvatures",
    "setting_step",
    "shares_set_up",
    "solve_flank",
    "tooth_angle",
    "tooth_lattice",
    "tooth_patches",
    "usual_settings",
    "with_settings",
    "work_rotation",
]

_ORIGINS = {
    ".cutting.blade": ["Blade"],
    ".cutting.blade_sections": ["BladeSection", "Relief"],
    ".cutting.generating_surface": ["GeneratingSurface", "Hand"],
    ".cutting.machine": ["MachineSettings", "work_rotation"],
    ".cutting.machine_pose": ["machine_pose"],
    ".cutting.machine_resolution": ["MachineResolution", "SettingStep", "setting_step"],
    ".cutting.named_settings": ["get_setting", "with_settings"],
    ".design.basic_settings": ["blank_section", "formate_gear", "generated_gear", "hobbing_blade"],
    ".design.blank": [
        "BlankDesign",
        "BlankDimensions",
        "PitchCones",
        "blank_design_from_symbols",
        "blank_dimensions",
        "dimensions_by_symbol",
    ],
    ".design.conjugate_pinion": ["conjugate_pinion"],
    ".design.synthesis": ["FREE_SETTINGS", "EaseOffTarget", "Synthesis", "fit_pinion"],
    ".deviation.corrective_settings": ["CorrectedFlank", "Correction", "corrective_settings"],
    ".deviation.deviated_flank": ["deviated_pair"],
    ".deviation.deviation": ["Deviation", "deviation_from_dataset", "deviation_from_formula"],
    ".deviation.ease_off_update": ["deviated_ease_off"],
    ".deviation.global_errors": ["GlobalErrors", "angle_errors", "fit_global_errors"],
    ".deviation.machine_set_up": [
        "FREE_FORMATE_SETTINGS",
        "FREE_MACHINE_SETTINGS",
        "movable_settings",
        "shares_set_up",
        "usual_settings",
    ],
    ".deviation.recut_flank": ["departure"],
    ".flanks.blank_section": ["BlankSection"],
    ".flanks.curvature": ["principal_curvatures"],
    ".flanks.flank": ["Flank", "NodeStatus", "solve_flank"],
    ".pair.assembly": ["Assembly", "Misalignment"],
    ".pair.ease_off": ["EaseOff", "exact_ease_off"],
    ".pair.gear_pair": ["FlankName", "GearPair", "Member", "PairGeometry", "ease_off", "flank", "pair_geometry"],
    ".pair.modification": ["Modification", "modified_ease_off"],
    ".tooth.lattice_spacing": ["LatticeSpacing"],
    ".tooth.tooth_flanks": ["MemberName", "named_member", "tooth_angle"],
    ".tooth.tooth_lattice": ["LatticeSize", "ToothLattice", "tooth_lattice"],
    ".tooth.tooth_surface": ["tooth_patches"],
}
__getattr__, __dir__ = lazy_names(__name__, _ORIGINS)
