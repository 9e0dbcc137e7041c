"""Both members in mesh for the turnable picture: one tooth of each as grids, and the rotations that place them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ....cases.schema.case_schema import Case
from ....core.attributes import ordered
from ....core.errors import EaseoffError
from ....geometry.pair.gear_pair import MEMBERS
from ....geometry.tooth.tooth_surface import tooth_patches
from ...export.mesh_placement import flank_places, member_turns, pair_of_result
from .packed_array import packed, packed_exactly

Array = NDArray[Any]

FLANK_NODES = (41, 15)  # of a drawn tooth along the face and the profile


def mesh_scene(tree: xr.DataTree, case: Case) -> dict[str, Any] | None:
    """Teeth of both members and their motion; ``None`` if a tooth's surface does not exist.

    At the pinion rotation q of a mesh position the tooth of the pair p of a member stands, from its stored position,
    turned about the member's axis by ``turn + rate * (q - p * pitch)``.

    Parameters
    ----------
    tree
        A result.
    case
        Its case.
    """
    try:
        pair = pair_of_result(tree, case)
        patches = {member: tooth_patches(pair, member, FLANK_NODES) for member in MEMBERS}
    except EaseoffError:
        return None
    attributes = tree["ease_off"].attrs
    turns = member_turns(tree, pair)
    flanks = {"pinion": ("concave", "convex"), "gear": ("convex", "concave")}
    members = {}
    for member in MEMBERS:
        loaded = f"{flanks[member][tree.attrs['flank'] != 'drive']}_flank"
        own = patches[member]
        frame = pair.assembly.pinion_frame if member == "pinion" else np.eye(3)
        origin = pair.assembly.pinion_origin if member == "pinion" else pair.assembly.gear_origin
        placed = {name: points @ frame.T + origin for name, points in own.items()}
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
    """A flank's grid (m, n, 3) with its first index from the toe and its second one from the root.

    And 1 if the derivative along the first index times that along the second one points out of the tooth, else -1.
    """
    turned = [(points[::a, ::b], a * b) for a in (1, -1) for b in (1, -1)]
    return min(turned, key=lambda each: float(np.linalg.norm(each[0][0, 0] - corner)))
