"""Placement of the teeth in mesh: the pair of a result, and the rotations of its members."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...cases.conversion import gear_pair
from ...cases.schema.case_schema import Case
from ...core.attributes import ordered
from ...geometry.pair.assembly import Misalignment
from ...geometry.pair.gear_pair import MEMBERS, GearPair
from ...geometry.tooth.tooth_flanks import MemberName

Array = NDArray[np.float64]


def pair_of_result(tree: xr.DataTree, case: Case) -> GearPair:
    """The pair of a case in the misalignment of the result."""
    keys = ("offset_mm", "pinion_axial_mm", "gear_axial_mm", "shaft_angle_rad")
    misalignment = Misalignment(*(float(tree.attrs[f"misalignment_{key}"]) for key in keys))
    return gear_pair(case, tree.attrs["flank"]).misaligned(misalignment)


def member_turns(tree: xr.DataTree, pair: GearPair) -> dict[str, float]:
    """Rotation [rad] from the stored position of each member to that at the pinion rotation zero.

    The middle of the flank, by what ``/ease_off`` says, then makes contact at its own roll angle.
    """
    ease_off, flanks = tree["ease_off"].to_dataset(), tree["flanks"].to_dataset()
    grid = ("lengthwise", "profile")
    inside = ordered(ease_off, "inside", *grid) == 1
    roll = ordered(ease_off, "roll_angle", *grid)[inside]
    action = ordered(ease_off, "action_position", *grid, "space")[inside]
    position = ordered(flanks, "position", "member", *grid, "xyz")
    gear = position[MEMBERS.index("gear")][inside] + pair.assembly.gear_origin
    own = np.stack([ordered(ease_off, f"pinion_{name}", *grid)[inside] for name in grid])
    from scipy.interpolate import RegularGridInterpolator

    axes = tuple(ordered(flanks, name, name) for name in grid)
    pinion = RegularGridInterpolator(axes, position[MEMBERS.index("pinion")])(np.clip(own.T, 0.0, 1.0))
    pinion = pinion @ pair.assembly.pinion_frame.T + pair.assembly.pinion_origin
    turns = {}
    for member, points, rate in (("pinion", pinion, 1.0), ("gear", gear, 1.0 / float(ease_off.attrs["ratio"]))):
        axis = np.asarray(ease_off.attrs[f"{member}_axis"], float)
        origin = np.asarray(ease_off.attrs[f"{member}_origin_mm"], float)
        angle = _azimuth(action - origin, axis) - _azimuth(points - origin, axis) - rate * roll
        known = angle[np.isfinite(angle)]
        # A mean of angles that do not jump from one turn to the next; of the pinion all are alike.
        turns[member] = float(np.angle(np.mean(np.exp(1j * known))))
    return turns


def flank_places(pair: GearPair, member: str, points: Array) -> Array:
    """Lengthwise and profile fractions (2, m, n) of points (m, n, 3) in a member's frame."""
    section = pair.pinion.section if member == "pinion" else pair.gear.section
    return np.stack(section.fractions(points[..., 2], np.hypot(points[..., 0], points[..., 1])))


def _azimuth(vectors: Array, axis: Array) -> Array:
    """Angle (n) [rad] of vectors (n, 3) about an axis."""
    first = np.cross(axis, [0.0, 1.0, 0.0])
    first /= np.linalg.norm(first)
    return np.asarray(np.arctan2(vectors @ np.cross(axis, first), vectors @ first))


def turned(points: Array, axis: Array, origin: Array, angle: float) -> Array:
    """Points (..., 3) turned about an axis through an origin by an angle [rad].

    Examples
    --------
    >>> turned(np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]), np.zeros(3), np.pi / 2).round(9).tolist()
    [0.0, 1.0, 0.0]
    """
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    rotation = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    return np.asarray((points - origin) @ rotation.T + origin)


def placed(points: Array, pair: GearPair, member: MemberName) -> Array:
    """Points (..., 3) of a member's own frame in the common one, at the member's stored position."""
    if member == "gear":
        return np.asarray(points + pair.assembly.gear_origin)
    return np.asarray(points @ pair.assembly.pinion_frame.T + pair.assembly.pinion_origin)
