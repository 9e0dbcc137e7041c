"""Smooth measures of the loaded pattern: centre and extent of the normal forces on the gear flank over a mesh cycle.

The pattern itself ends at a pressure, and its borders jump from segment to segment. Means over the forces change
smoothly with settings and torque, also where further segments begin to touch.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from .loaded_slopes import CaseSlopes

Array = NDArray[Any]
_Variables = dict[str, tuple[tuple[str, ...], Array]]


def load_spot(loaded: xr.Dataset, found: Sequence[CaseSlopes]) -> tuple[_Variables, _Variables]:
    """Load-weighted centre and root-mean-square extents, and their derivatives, with their dimensions.

    Parameters
    ----------
    loaded
        From ``MeshCycle.loaded``.
    found
        Derivatives of its cases by settings, and last by the torque.

    Returns
    -------
    tuple
        ``load_centre_lengthwise`` and ``load_centre_profile``, mean fractions on the gear over all forces of all mesh
        positions; ``load_extent_lengthwise`` and ``load_extent_profile``, the root of the mean squared distance from
        them. NaN at a torque without load.
    """
    torques, count = loaded.sizes["torque"], found[0].rotation.size
    whole, by_whole = np.zeros(torques), np.zeros((torques, count))
    first, second = np.zeros((2, torques)), np.zeros((2, torques))
    by_first, by_second = np.zeros((2, torques, count)), np.zeros((2, torques, count))
    for one in found:
        at, point, force = one.case.torque, one.case.segments.point, one.case.solution.force
        whole[at] += force.sum()
        by_whole[at] += one.force.sum(axis=0)
        first[:, at] += point @ force
        second[:, at] += point**2 @ force
        moved = force[:, None] * one.place
        by_first[:, at] += point @ one.force + moved.sum(axis=1)
        by_second[:, at] += point**2 @ one.force + 2.0 * np.einsum("xn,xnj->xj", point, moved)
    with np.errstate(divide="ignore", invalid="ignore"):
        centre = first / whole
        by_centre = (by_first - centre[..., None] * by_whole) / whole[:, None]
        square = second / whole
        by_square = (by_second - square[..., None] * by_whole) / whole[:, None]
        extent = np.sqrt(np.maximum(square - centre**2, 0.0))
        by_extent = (0.5 * by_square - centre[..., None] * by_centre) / extent[..., None]
    values, slopes = {}, {}
    for axis, way in enumerate(("lengthwise", "profile")):
        for name, own, change in (("centre", centre, by_centre), ("extent", extent, by_extent)):
            values[f"load_{name}_{way}"] = (("torque",), own[axis])
            slopes[f"load_{name}_{way}"] = (("torque", "setting"), change[axis])
    return values, slopes
