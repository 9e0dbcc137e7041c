"""Dimensions that a case implies: what a gear's data sheet lists, measured on its blanks, cutters and flanks."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....cases.conversion import given_pair
from ....cases.schema.case_schema import Case
from ....cases.writing import with_blanks
from ....core.errors import EaseoffError
from ....geometry.design.blank import MeanPointAngles, angles_of_normal
from ....geometry.pair.gear_pair import MEMBERS, GearPair, thickness_per_angle
from ....geometry.pair.tooth_thickness import mean_cone_distances, mean_normal_thickness
from ....geometry.tooth.tooth_flanks import named_member, placed_flanks, tooth_angle

Array = NDArray[Any]
SIDES = ("concave", "convex")

#: Names of the rows, with their units, in their order.
ROWS = {
    "outer_pitch_diameter": ("outer pitch diameter", "mm"),
    "mean_pitch_diameter": ("mean pitch diameter", "mm"),
    "outer_transverse_module": ("outer transverse module", "mm"),
    "mean_normal_module": ("mean normal module", "mm"),
    "mean_spiral_angle": ("mean spiral angle", "°"),
    "concave_pressure_angle": ("normal pressure angle, concave flank", "°"),
    "convex_pressure_angle": ("normal pressure angle, convex flank", "°"),
    "outer_depth": ("tooth depth at the heel, to the end of the flank", "mm"),
    "mean_depth": ("tooth depth mid face, to the end of the flank", "mm"),
    "mean_normal_thickness": ("normal circular thickness at the mean point (ISO 23509)", "mm"),
    "mid_flank_thickness": ("normal circular thickness in the middle of the flank", "mm"),
    "cutter_radius": ("mean radius of the blade tips", "mm"),
    "point_width": ("difference of the radii of the blade tips", "mm"),
    "toe": ("toe of the pitch cone on the axis, from the crossing point", "mm"),
    "heel": ("heel of the pitch cone on the axis, from the crossing point", "mm"),
}


def implied_dimensions(case: Case) -> dict[str, dict[str, float]]:
    """Dimensions of both members by name, as far as the case implies them.

    Angles are measured on the flanks, mid face on the pitch cone: the spiral angle between tooth trace and cone
    element, as the mean of both flanks; pressure angles between the normal and the plane that touches the cone.

    Parameters
    ----------
    case
        A checked case.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> found = implied_dimensions(read_case("nasa-12x36"))
    >>> round(found["pinion"]["mean_spiral_angle"]), round(found["gear"]["mean_spiral_angle"])
    (35, 35)
    """
    case = with_blanks(case)
    try:
        pair = given_pair(case)
    except EaseoffError:
        return {}
    return {name: _blank(pair, name) | _flanks(pair, name) | _cutters(case, name) for name in MEMBERS}


def dimension_rows(case: Case) -> list[list[str]]:
    """Rows name, unit, key and a value a member; none where nothing is implied."""
    found = implied_dimensions(case)
    rows = []
    for key, (name, unit) in ROWS.items():
        values = [found.get(member, {}).get(key, math.nan) for member in MEMBERS]
        if np.any(np.isfinite(values)):
            rows.append([name, unit, "", *(f"{value:.3f}" if math.isfinite(value) else "–" for value in values)])
    return rows


def _blank(pair: GearPair, name: str) -> dict[str, float]:
    """Pitch diameters, module, depths and places on the axis."""
    member = named_member(pair, name)
    section = member.section
    teeth = getattr(pair.assembly, f"{name}_teeth")
    outer = section.outer_cone_distance
    diameter = 2.0 * outer * math.sin(section.pitch_angle)
    axial, radial = section.points(np.array([0.5, 0.5]), np.array([0.0, 1.0]))
    corners = section.corners
    cosine = math.cos(section.pitch_angle)
    return {
        "outer_pitch_diameter": diameter,
        "mean_pitch_diameter": 2.0 * float(section.on_pitch_cone(section.middle_distance)[1]),
        "outer_transverse_module": diameter / teeth,
        "outer_depth": float(np.linalg.norm(corners[1, 1] - corners[1, 0])),
        "mean_depth": float(np.hypot(axial[1] - axial[0], radial[1] - radial[0])),
        "toe": (outer - section.face_width) * cosine - section.pitch_apex,
        "heel": outer * cosine - section.pitch_apex,
    }


def _flanks(pair: GearPair, name: str) -> dict[str, float]:
    """Spiral angle, pressure angles, module and thickness, measured on both flanks of a tooth at the mean point."""
    member = named_member(pair, name)
    section = member.section
    point = section.on_pitch_cone(section.middle_distance)
    teeth, hand = (getattr(pair.assembly, f"{name}_{what}") for what in ("teeth", "hand"))
    try:
        flanks = placed_flanks(member, tooth_angle(pair, name))
        found = {side: one.at(*point[:, None]) for side, one in flanks.items()}
        middle = thickness_per_angle(member) * tooth_angle(pair, name)
        mean = mean_normal_thickness(member, middle, mean_cone_distances(pair)[MEMBERS.index(name)])
    except EaseoffError:
        return {}
    angles: dict[str, MeanPointAngles] = {
        side: angles_of_normal(one.position[:, 0], one.normal[:, 0], section.pitch_angle, hand)
        for side, one in found.items()
    }
    spiral = float(np.mean([one.spiral_angle for one in angles.values()]))
    return {
        "mean_spiral_angle": math.degrees(spiral),
        **{f"{side}_pressure_angle": math.degrees(one.pressure_angle) for side, one in angles.items()},
        "mean_normal_module": 2.0 * float(point[1]) * math.cos(spiral) / teeth,
        "mean_normal_thickness": mean,
        "mid_flank_thickness": middle,
    }


def _cutters(case: Case, name: str) -> dict[str, float]:
    """Mean radius of the blade tips of both flanks, and what they differ by."""
    member = getattr(case, name)
    flanks = [getattr(member, side) for side in SIDES]
    if any(flank is None for flank in flanks):
        return {}
    radii = [flank.cutter.blade_point_radius for flank in flanks]
    return {"cutter_radius": 0.5 * sum(radii), "point_width": radii[0] - radii[1]}
