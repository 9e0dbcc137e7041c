"""Conversion of objects of the geometry to the tables of a case: the inverse of ``conversion``.

Numbers are rounded to ten decimals of a millimetre or degree, far below anything a flank feels.
"""

from __future__ import annotations

import math
from typing import Any

from ..core.errors import InputError
from ..geometry.cutting.blade import Blade
from ..geometry.cutting.generating_surface import GeneratingSurface
from ..geometry.cutting.machine import MachineSettings
from ..geometry.design.iso23509.blank_dimensions import MemberBlank
from ..geometry.pair.gear_pair import MEMBERS, GearPair
from ..geometry.pair.tooth_thickness import mean_cone_distances, mean_normal_thickness
from .conversion import designed_blanks, given_pair
from .schema.case_schema import Blank, Case
from .schema.cutting_table import ANGULAR_MOTIONS, ROLL_KEYS, Cutter, FlankSettings, Machine, Motions


def _rounded(value: float) -> float:
    return round(value, 10) + 0.0  # no minus zero


def _degrees(value: float) -> float:
    return _rounded(math.degrees(value))


def blank_table(member: MemberBlank, clearance: float) -> Blank:
    """Axial section of one member of a designed blank."""
    return Blank(
        pitch_angle=_degrees(member.pitch_angle),
        face_angle=_degrees(member.face_angle),
        root_angle=_degrees(member.root_angle),
        pitch_apex_beyond_crossing_point=_rounded(member.pitch_apex),
        face_apex_beyond_crossing_point=_rounded(member.face_apex),
        root_apex_beyond_crossing_point=_rounded(member.root_apex),
        outer_cone_distance=_rounded(member.outer_cone_distance),
        face_width=_rounded(member.face_width),
        clearance=_rounded(clearance),
    )


def with_blanks(case: Case) -> Case:
    """The case with its blanks as numbers, where it asks for them by basic data."""
    if case.blank_design is None:
        return case
    blanks = designed_blanks(case.blank_design, (case.pinion.number_of_teeth, case.gear.number_of_teeth), case.pair)
    pinion, gear = (blank_table(member, blanks.clearance) for member in (blanks.pinion, blanks.gear))
    return case.model_copy(
        update={
            "blank_design": None,
            "pinion": case.pinion.model_copy(update={"blank": pinion}),
            "gear": case.gear.model_copy(update={"blank": gear}),
        }
    )


def recorded_thicknesses(pair: GearPair) -> list[float | None]:
    """Mean normal circular thicknesses [mm] of the members of a pair that have a thickness of their own.

    Raises
    ------
    GeometryError
        If a flank does not pass through the mean point.
    """
    return [
        None if m.mean_thickness is None else _rounded(mean_normal_thickness(m, m.mean_thickness, distance))
        for m, distance in zip((pair.pinion, pair.gear), mean_cone_distances(pair), strict=True)
    ]


def with_mean_thickness(case: Case) -> Case:
    """The case with thicknesses in the middle of the flank as those at the mean point. Raises as above."""
    tables = {name: getattr(case, name) for name in MEMBERS}
    given = {name for name, table in tables.items() if table.mid_flank_normal_circular_thickness is not None}
    if not given:
        return case
    thicknesses = zip(MEMBERS, recorded_thicknesses(given_pair(case)), strict=True)
    return case.model_copy(
        update={
            name: tables[name].model_copy(
                update={"mean_normal_circular_thickness": value, "mid_flank_normal_circular_thickness": None}
            )
            for name, value in thicknesses
            if name in given
        }
    )


def flank_settings(surface: GeneratingSurface, teeth: int) -> FlankSettings:
    """Cutter and machine settings of one flank of a member with a number of teeth.

    Raises
    ------
    InputError
        If the surface has settings a case file cannot hold.
    """
    ratio = surface.settings.indexing_ratio
    groups = ratio * teeth
    if abs(groups - round(groups)) > 1e-9:
        raise InputError(f"indexing_ratio = {ratio}: must be a whole number of blade groups over {teeth} teeth")
    return FlankSettings(machine=machine_table(surface.settings), cutter=cutter_table(surface.blade, round(groups)))


def machine_table(settings: MachineSettings) -> Machine:
    """Machine settings in mm and degrees, modified roll and motions as derivatives."""
    if len(settings.modified_roll) > len(ROLL_KEYS):
        raise InputError(f"modified_roll = {settings.modified_roll}: must have at most {len(ROLL_KEYS)} orders")
    roll = {
        name: _rounded(coefficient * math.factorial(order))
        for order, (name, coefficient) in enumerate(zip(ROLL_KEYS, settings.modified_roll, strict=False), start=2)
    }
    motions = {}
    for name, coefficients in settings.motions:
        unit = math.degrees(1.0) if name in ANGULAR_MOTIONS else 1.0
        motions[name] = tuple(_rounded(unit * c * math.factorial(n)) for n, c in enumerate(coefficients, start=1))
    return Machine(
        radial_distance=_rounded(settings.radial_distance),
        cradle_angle=_degrees(math.remainder(settings.cradle_angle, 2.0 * math.pi)),
        machine_root_angle=_degrees(settings.machine_root_angle),
        work_offset=_rounded(settings.work_offset),
        sliding_base=_rounded(settings.sliding_base),
        machine_center_to_crossing_point=_rounded(settings.machine_center_to_crossing_point),
        cutter_tilt=_degrees(settings.cutter_tilt),
        cutter_swivel=_degrees(settings.cutter_swivel),
        ratio_of_roll=None if settings.ratio_of_roll is None else _rounded(settings.ratio_of_roll),
        **roll,
        motions=Motions(**motions),
    )


def cutter_table(blade: Blade, number_of_blade_groups: int = 0) -> Cutter:
    """A blade in mm and degrees."""
    reliefs: dict[str, Any] = {}
    for name, relief in (("toprem", blade.toprem), ("flankrem", blade.flankrem)):
        if relief is not None:
            reliefs[f"{name}_depth"], reliefs[f"{name}_angle"] = _rounded(relief.height), _degrees(relief.angle)
            reliefs[f"{name}_radius"] = relief.radius
    return Cutter(
        blade_point_radius=_rounded(blade.point_radius),
        blade_pressure_angle=_degrees(blade.pressure_angle),
        number_of_blade_groups=number_of_blade_groups,
        blade_offset_angle=_degrees(blade.offset_angle),
        blade_rake_angle=_degrees(blade.rake_angle),
        blade_hook_angle=_degrees(blade.hook_angle),
        blade_spheric_radius=blade.spheric_radius,
        blade_reference_height=0.0 if blade.spheric_radius is None else _rounded(blade.reference_height),
        tool_edge_radius=_rounded(blade.edge_radius),
        **reliefs,
    )
