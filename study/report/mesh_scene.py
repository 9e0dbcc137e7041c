"""Both members in mesh for the turnable picture: one tooth of each as grids, and the rotations that place them.

Placement of the teeth in mesh: the pair of a result, and the rotations of its members.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from ...cases.conversion import gear_pair
from ...cases.schema.case_schema import MATING_SIDES, Case
from ...core.arrays import Array
from ...core.attributes import ordered
from ...core.errors import EaseoffError
from ...geometry.pair.assembly import Misalignment
from ...geometry.pair.gear_pair import MEMBERS, GearPair
from ...geometry.tooth.tooth_flanks import MemberName
from ...geometry.tooth.tooth_surface import tooth_patches
from ..summary.deflection_report import ERRORS
from .cycle_charts import packed, packed_exactly


def pair_of_result(tree: xr.DataTree, case: Case) -> GearPair:
    """The pair of a case in the misalignment of the result."""
    misalignment = Misalignment(*(float(tree.attrs[error.attribute]) for error in ERRORS))
    return gear_pair(case, tree.attrs["flank"]).misaligned(misalignment)


def member_turns(tree: xr.DataTree, pair: GearPair) -> dict[str, float]:
    """Rotation [rad] of each member from its stored position to that at the pinion rotation zero.

    The middle of the flank, by what ``/ease_off`` says, then makes contact at its own roll angle.
    """
    ease_off, flanks = tree["ease_off"].to_dataset(), tree["flanks"].to_dataset()
    grid = ("lengthwise", "profile")
    inside = ordered(ease_off, "inside", *grid) == 1
    roll = ordered(ease_off, "roll_angle", *grid)[inside]
    action = ordered(ease_off, "action_position", *grid, "space")[inside]
    position = ordered(flanks, "position", "member", *grid, "xyz")
    gear = position[MEMBERS.index("gear")][inside] + pair.assembly.gear_origin
    fractions = np.stack([ordered(ease_off, f"pinion_{name}", *grid)[inside] for name in grid])
    from scipy.interpolate import RegularGridInterpolator

    axes = tuple(ordered(flanks, name, name) for name in grid)
    pinion = RegularGridInterpolator(axes, position[MEMBERS.index("pinion")])(np.clip(fractions.T, 0.0, 1.0))
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
    """Points (..., 3) turned about an axis through an origin by an angle [rad]."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    rotation = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    return np.asarray((points - origin) @ rotation.T + origin)


def placed(points: Array, pair: GearPair, member: MemberName) -> Array:
    """Points (..., 3) of a member's own frame in the common one, at the member's stored position."""
    if member == "gear":
        return np.asarray(points + pair.assembly.gear_origin)
    return np.asarray(points @ pair.assembly.pinion_frame.T + pair.assembly.pinion_origin)


def loaded_patch(tree: xr.DataTree, member: str) -> str:
    """Name of the loaded flank among the patches of a tooth."""
    return f"{MATING_SIDES[tree.attrs['flank']][MEMBERS.index(member)]}_flank"


FLANK_NODES = (41, 15)  # of a drawn tooth along the face and the profile


def mesh_scene(tree: xr.DataTree, case: Case) -> dict[str, Any] | None:
    """Teeth of both members and their motion; ``None`` if a tooth's surface does not exist.

    At the pinion rotation q, the tooth of the pair p is turned by ``turn + rate * (q - p * pitch)`` about its axis.
    """
    try:
        pair = pair_of_result(tree, case)
        patches = {member: tooth_patches(pair, member, FLANK_NODES) for member in MEMBERS}
    except EaseoffError:
        return None
    attributes = tree["ease_off"].attrs
    turns = member_turns(tree, pair)
    members = {}
    for member in MEMBERS:
        loaded = loaded_patch(tree, member)
        surfaces = patches[member]
        frame = pair.assembly.pinion_frame if member == "pinion" else np.eye(3)
        origin = pair.assembly.pinion_origin if member == "pinion" else pair.assembly.gear_origin
        placed = {name: points @ frame.T + origin for name, points in surfaces.items()}
        node = ordered(tree["flanks"].to_dataset(), "position", "member", "lengthwise", "profile", "xyz")
        flank, outward = _from_toe(placed[loaded], node[MEMBERS.index(member), 0, 0] @ frame.T + origin)
        members[member] = {
            "axis": np.asarray(attributes[f"{member}_axis"], float).tolist(),
            "origin": np.asarray(attributes[f"{member}_origin_mm"], float).tolist(),
            "turn": turns[member],
            "rate": 1.0 if member == "pinion" else 1.0 / float(attributes["ratio"]),
            "teeth": int(tree.attrs[f"{member}_teeth"]),
            "flank": packed(flank),
            "outward": outward,
            "places": packed(flank_places(pair, member, flank @ frame - origin @ frame)),
            "grid": packed(node[MEMBERS.index(member)] @ frame.T + origin),
            "others": [packed(points) for name, points in placed.items() if name != loaded],
        }
    middle = ordered(tree["ease_off"].to_dataset(), "action_position", "lengthwise", "profile", "space")
    return {
        "members": members,
        "pitch": 2.0 * math.pi / int(tree.attrs["pinion_teeth"]),
        "rotation": packed_exactly(tree["loaded"].to_dataset()["pinion_rotation"].values),
        "middle": np.nanmean(middle, axis=(0, 1)).tolist(),
    }


def _from_toe(points: Array, corner: Array) -> tuple[Array, int]:
    """Flank's grid (m, n, 3) with the first index from the toe and the second from the root, and its sense.

    The sense is 1 if the first derivative times the second one points out of the tooth, else -1.
    """
    turned = [(points[::a, ::b], a * b) for a in (1, -1) for b in (1, -1)]
    return min(turned, key=lambda each: float(np.linalg.norm(each[0][0, 0] - corner)))
