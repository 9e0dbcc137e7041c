"""The surface of one tooth as structured grids of points, patch by patch."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.errors import GeometryError, InputError
from .flank_surface import Flank
from .pair import GearPair
from .tooth_flanks import PlacedFlank, named_member, placed_flanks, tooth_angle

Array = NDArray[Any]


def tooth_patches(pair: GearPair, member_name: str, nodes: tuple[int, int]) -> dict[str, Array]:
    """Patches of one tooth of a member: its two flanks.

    Parameters
    ----------
    pair
        The gear pair; it decides how thick the tooth is.
    member_name
        ``pinion`` or ``gear``.
    nodes
        Nodes lengthwise and along the profile, at least 5 each.

    Returns
    -------
    dict
        Points (m, n, 3) [mm] by name of the patch, in the member's frame. The derivative along the first index times
        the derivative along the second one points out of the tooth.

    Raises
    ------
    InputError
        If the member is neither ``pinion`` nor ``gear``, or the grid is too coarse.
    GeometryError
        If the lower half of a flank does not exist.

    Notes
    -----
    Where the blade's tip or undercut ends a flank above the root line, the patch begins at the lowest profile fraction,
    in steps of 1/40, that exists along the whole face.
    """
    member = named_member(pair, member_name)
    if min(nodes) < 5:
        raise InputError(f"nodes = {nodes}: at least 5 are needed in each direction")
    return {
        f"{name}_flank": _outward(_complete(f"{name} flank of the {member_name}", flank, nodes).reshape(*nodes))
        for name, flank in placed_flanks(member, tooth_angle(pair, member_name)).items()
    }


def _complete(name: str, flank: PlacedFlank, nodes: tuple[int, int]) -> Flank:
    """The flank from the lowest profile fraction where all of it exists; nodes in lengthwise-major order."""
    for lowest in np.linspace(0.0, 0.5, 21):
        t, h = np.meshgrid(np.linspace(0.0, 1.0, nodes[0]), np.linspace(lowest, 1.0, nodes[1]), indexing="ij")
        found = flank.at(*flank.section.points(t.ravel(), h.ravel()))
        if np.all(found.inside):
            return found
    raise GeometryError(
        f"the {name} has holes above half its height (undercut, or not reached by the cutter): it cannot be written as "
        "a surface; check the machine settings and the blank's clearance"
    )


def _outward(flank: Flank) -> Array:
    """Points (m, n, 3) of a flank (m, n), turned so that the normal of the patch points out of the tooth."""
    points = np.moveaxis(flank.position, 0, -1)
    along, up = points[1:, :-1] - points[:-1, :-1], points[:-1, 1:] - points[:-1, :-1]
    outward = np.sum(np.cross(along, up) * np.moveaxis(flank.normal, 0, -1)[:-1, :-1])
    return np.ascontiguousarray(points if outward > 0.0 else points[::-1])
