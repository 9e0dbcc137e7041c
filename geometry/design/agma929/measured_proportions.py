"""Tooth proportions of a pair whose basic data are not known: measured on its blanks and flanks."""

from __future__ import annotations

import math

import numpy as np

from ....core.errors import GeometryError
from ...cutting.generating_surface import GeneratingSurface
from ...flanks.blank_section import BlankSection
from ...flanks.flank import solve_flank
from ...pair.gear_pair import GearPair, Member
from ...pair.tooth_thickness import mean_cone_distances, mean_normal_thickness, mean_thicknesses
from ..mean_point import MeanPointAngles, angles_of_normal
from .tooth_proportions import BLADE_FLAT, BLADE_FLAT_SHARE, ToothProportions


def measured_proportions(pair: GearPair) -> ToothProportions:
    """Tooth proportions at the middle of the gear's face, where the pitch cones touch.

    Parameters
    ----------
    pair
        The pair seen from its drive side, with both flanks of both members.

    Raises
    ------
    GeometryError
        If the pitch cones of the blanks do not touch, or a flank does not pass through the mean point.
    InputError
        If a member has one flank only.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> round(measured_proportions(gear_pair(read_case("fm-11x41"))).mean_normal_module, 2)
    3.85
    """
    members, sections = (pair.pinion, pair.gear), (pair.pinion.section, pair.gear.section)
    distance = mean_cone_distances(pair, must_touch=True)
    thickness = [
        mean_normal_thickness(member, middle, r)
        for member, middle, r in zip(members, mean_thicknesses(pair), distance, strict=True)
    ]
    heights = [_heights(section, r) for section, r in zip(sections, distance, strict=True)]
    angles = [_angles(member, r) for member, r in zip(members, distance, strict=True)]
    spiral = [sum(abs(each.spiral_angle) for each in both) / 2.0 for both in angles]
    gear = pair.gear
    settings = gear.loaded.settings
    radius = distance[1] * math.sin(sections[1].pitch_angle)
    module = 2.0 * radius * math.cos(spiral[1]) / gear.teeth
    flanks = gear.loaded, gear.from_opposite.loaded
    return ToothProportions(
        number_of_teeth=(pair.pinion.teeth, gear.teeth),
        shaft_angle=pair.assembly.shaft_angle,
        hypoid_offset=pair.assembly.hypoid_offset,
        mean_normal_module=module,
        face_width=(sections[0].face_width, sections[1].face_width),
        outer_cone_distance=(sections[0].outer_cone_distance, sections[1].outer_cone_distance),
        mean_cone_distance=distance,
        pitch_angle=(sections[0].pitch_angle, sections[1].pitch_angle),
        dedendum_angle=(
            sections[0].pitch_angle - sections[0].root_angle,
            sections[1].pitch_angle - sections[1].root_angle,
        ),
        mean_addendum=(heights[0][0], heights[1][0]),
        mean_dedendum=(heights[0][1], heights[1][1]),
        mean_normal_thickness=(thickness[0], thickness[1]),
        clearance=(heights[1][1] - heights[0][0] + heights[0][1] - heights[1][0]) / 2.0,
        drive_pressure_angle=angles[1][0].pressure_angle,
        coast_pressure_angle=angles[1][1].pressure_angle,
        gear_spiral_angle=spiral[1],
        cutter_radius=sum(_cutter_radius(each, heights[1][1]) for each in flanks) / 2.0,
        number_of_blade_groups=round(settings.indexing_ratio * gear.teeth),
        generated_gear=settings.generated,
        inside_blade_angle=flanks[0].blade.pressure_angle,
        blade_flat=min(BLADE_FLAT, BLADE_FLAT_SHARE * module),
    )


def _heights(section: BlankSection, distance: float) -> tuple[float, float]:
    """Addendum and dedendum at right angles to the pitch cone at a cone distance [mm]."""
    pitch = section.pitch_angle
    axial, radial = map(float, section.on_pitch_cone(distance))

    def to_cone(angle: float, apex: float) -> float:
        off = (axial + apex) * math.sin(angle) - radial * math.cos(angle)
        return off / math.cos(pitch - angle)

    return to_cone(section.face_angle, section.face_apex), -to_cone(section.root_angle, section.root_apex)


def _angles(member: Member, distance: float) -> tuple[MeanPointAngles, MeanPointAngles]:
    """Angles of the loaded and of the other flank at a cone distance."""
    found = []
    for surface in (member.loaded, member.from_opposite.loaded):
        flank = solve_flank(surface, member.section, *member.section.on_pitch_cone(distance)[:, None])
        position, normal = flank.position[:, 0], flank.normal[:, 0]
        if not np.all(np.isfinite(position)):
            raise GeometryError("a flank does not pass through the mean point of its blank")
        found.append(angles_of_normal(position, normal, member.section.pitch_angle, surface.hand))
    return found[0], found[1]


def _cutter_radius(surface: GeneratingSurface, height: float) -> float:
    """Distance from the cutter axis of the edge at a height above the tip [mm]."""
    blade = surface.blade
    along = height / abs(blade.edge[2])
    return math.hypot(blade.tip[0] + along * blade.edge[0], blade.tip[1] + along * blade.edge[1])
