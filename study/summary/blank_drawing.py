"""Data of a pair as its drawings list them: blanks, teeth, backlash and tolerances, measured on blanks and flanks."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict

import numpy as np
import xarray as xr

from ...cases.conversion import given_pair
from ...cases.schema.case_schema import Case
from ...cases.writing import with_blanks
from ...core.arrays import Array
from ...core.errors import EaseoffError
from ...geometry.design.tolerances import accuracy_tolerances, usual_backlash
from ...geometry.design.tooth_proportions import mean_flank_angles, measured_blank
from ...geometry.pair.gear_pair import MEMBERS, GearPair, pair_geometry
from ...geometry.pair.tooth_thickness import mean_cone_distances, mean_thicknesses
from ...geometry.tooth.tooth_flanks import named_member, side
from .assembly import millimetres
from .quantities import TABLES

SIDES = ("concave", "convex")

#: Names of the rows with their units, in their order; symbols are those of ISO 23509.
ROWS: dict[str, tuple[str, str]] = {key: (name, unit) for key, (name, unit) in TABLES["drawing"].items()}
CUTTER_ROWS = ("cutter_radius", "point_width")


def implied_dimensions(case: Case) -> dict[str, dict[str, float]]:
    """Dimensions of both members by name, as far as the case implies them, in mm and degrees, at the mean point.

    Spiral angle: between tooth trace and cone element, mean of both flanks; pressure angle: normal to tangent plane.
    """
    case = with_blanks(case)
    try:
        pair = given_pair(case)
        measured = [_measured(pair, number) for number in range(len(MEMBERS))]
    except EaseoffError:
        return {}
    both = {name: each | _cutters(case, name) for name, each in zip(MEMBERS, measured, strict=True)}
    return {name: {key: each[key] for key in ROWS if key in each} for name, each in both.items()}


def dimension_rows(case: Case) -> list[list[str]]:
    """Rows name, unit, key and a value a member; none where nothing is implied."""
    dimensions = implied_dimensions(case)
    rows = []
    for key, (name, unit) in ROWS.items():
        values = [dimensions.get(member, {}).get(key, math.nan) for member in MEMBERS]
        if np.any(np.isfinite(values)):
            rows.append([name, unit, "", *(f"{value:.3f}" if math.isfinite(value) else "–" for value in values)])
    return rows


def _measured(pair: GearPair, number: int) -> dict[str, float]:
    """Dimensions of one member's blank and teeth [mm, deg]."""
    member = named_member(pair, MEMBERS[number])
    section, distance = member.section, mean_cone_distances(pair)[number]
    middle = float(mean_thicknesses(pair)[number])
    blank, module = measured_blank(member, distance, middle)
    cosine = math.cos(section.pitch_angle)
    degrees = {name: math.degrees(value) for name, value in asdict(blank).items() if name.endswith("_angle")}
    angles = mean_flank_angles(member, distance)
    return (
        asdict(blank)
        | degrees
        | {
            **{
                f"{side(surface)}_pressure_angle": math.degrees(each.pressure_angle)
                for surface, each in zip((member.loaded, member.other), angles, strict=True)
            },
            "mean_normal_module": module,
            "outer_transverse_module": blank.outer_pitch_diameter / member.teeth,
            # Ends of the face cone as the blank has them, also where its ends lean against the pitch cone.
            "outer_tip_diameter": 2.0 * float(section.corners[1, 1, 1]),
            "crown_distance": float(section.corners[1, 1, 0]),
            "front_crown_distance": float(section.corners[0, 1, 0]),
            "mid_flank_thickness": middle,
            "toe": blank.inner_cone_distance * cosine - section.pitch_apex,
            "heel": blank.outer_cone_distance * cosine - section.pitch_apex,
        }
    )


def _cutters(case: Case, name: str) -> dict[str, float]:
    """Mean radius of the blade tips of both flanks, and what they differ by."""
    member = getattr(case, name)
    flanks = [getattr(member, side) for side in SIDES]
    if any(flank is None for flank in flanks):
        return {}
    radii = [flank.cutter.blade_point_radius for flank in flanks]
    return {"cutter_radius": 0.5 * sum(radii), "point_width": radii[0] - radii[1]}


#: Names of the backlash, with their variables, units and factors.
PLAY = {
    "normal backlash at the heel": ("outer_normal_backlash", "mm", 1.0),
    "transverse backlash at the heel": ("outer_transverse_backlash", "mm", 1.0),
    "normal backlash at the mean point": ("mean_normal_backlash", "mm", 1.0),
    "transverse backlash at the mean point": ("mean_transverse_backlash", "mm", 1.0),
    "rotation of the gear, pinion held": ("backlash_rotation", "deg", math.degrees(1e-6)),
}
SHIM = 0.1  # [mm]
#: Changes of the normal backlash at the heel, with their variables and the change of the assembly.
SHIMS = {
    f"change by {SHIM:g} mm, pinion away from the crossing point": ("backlash_by_pinion_axial", SHIM),
    f"change by {SHIM:g} mm, gear away from the crossing point": ("backlash_by_gear_axial", SHIM),
    f"change by {SHIM:g} mm more offset": ("backlash_by_offset", SHIM),
}


def case_backlash(case: Case) -> xr.Dataset:
    """Backlash of a case over a mesh cycle; ``contact.backlash`` raises GeometryError where it is not known."""
    from ...contact.backlash import backlash  # reports have no need of it
    from ...contact.mesh_cycle import MeshCycle

    contact = case.contact
    geometry = pair_geometry(given_pair(case), (contact.lengthwise_nodes, contact.profile_nodes))
    cycle = MeshCycle.of(geometry, mesh_positions=contact.mesh_positions, segments_per_line=1)
    return backlash(geometry, cycle.unloaded())


def backlash_rows(
    play: xr.Dataset, within: tuple[float, float] | None, outer_module: float
) -> Iterator[tuple[str, ...]]:
    """Rows name, unit, least and greatest of the backlash, with its tolerances, and its changes by shims."""
    for name, (variable, unit, factor) in PLAY.items():
        yield _range(name, unit, factor * play[variable].values)
        if name == next(iter(PLAY)):
            if within is not None:
                yield _range("  with the tolerances", unit, np.array(within))
            if (usual := usual_backlash(outer_module)) is not None:
                yield _range("  usual for this module (AGMA, qualities 7 to 13)", unit, np.array(usual))
    for name, (variable, change) in SHIMS.items():
        yield _range(name, "mm", change * play[variable].values, "+.3f")


def _range(name: str, unit: str, values: Array, form: str = ".3f") -> tuple[str, ...]:
    return name, unit, *(millimetres(each, form) for each in (np.min(values), np.max(values)))


TOLERANCES = {
    "single_pitch": "single pitch f_ptT",
    "total_cumulative_pitch": "total cumulative pitch F_pT",
    "run_out": "run-out F_rT",
}


def case_tolerances(case: Case, dimensions: Mapping[str, Mapping[str, float]]) -> dict[str, dict[str, float]]:
    """Tolerances of both members by their names [um], by the accuracy grade of a case with blanks; none without one.

    InputError outside the range of the standard.
    """
    grade = case.drawing.accuracy_grade
    if grade is None or not dimensions:
        return {}
    depth = sum(each["mean_addendum"] for each in dimensions.values())
    made = {}
    for name, each in dimensions.items():
        above = each["mean_addendum"] - 0.5 * depth
        member = getattr(case, name)
        diameter = each["mean_pitch_diameter"] + 2.0 * above * math.cos(math.radians(member.blank.pitch_angle))
        made[name] = accuracy_tolerances(grade, each["mean_normal_module"], member.number_of_teeth, diameter)
    return made
