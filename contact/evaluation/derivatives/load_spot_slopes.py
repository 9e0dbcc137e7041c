"""Derivatives of centre and extent of the load on the flank over a mesh cycle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..load_spot import WAYS
from .loaded_slopes import CaseSlopes

Array = NDArray[Any]


def load_spot_slopes(
    spot: Mapping[str, tuple[tuple[str, ...], Array]], found: Sequence[CaseSlopes]
) -> dict[str, tuple[tuple[str, ...], Array]]:
    """Derivatives of load-weighted centre and extents, with their dimensions.

    Parameters
    ----------
    spot
        From ``load_spot``.
    found
        Derivatives of the cases by settings, and last by the torque (j).
    """
    torques, count = spot[f"load_centre_{WAYS[0]}"][1].size, found[0].rotation.size
    centre, extent = (np.stack([spot[f"load_{name}_{way}"][1] for way in WAYS]) for name in ("centre", "extent"))
    whole = np.zeros(torques)
    by_centre, by_square = np.zeros((2, torques, count)), np.zeros((2, torques, count))
    for one in found:
        at, force = one.case.torque, one.case.solution.force
        whole[at] += force.sum()
        away = one.case.segments.point - centre[:, at, None]
        moved = force[:, None] * one.place
        by_centre[:, at] += away @ one.force + moved.sum(axis=1)
        # About the centre, whose own motion does not count to first order.
        by_square[:, at] += (away**2 - extent[:, at, None] ** 2) @ one.force + 2.0 * np.einsum(
            "xn,xnj->xj", away, moved
        )
    with np.errstate(divide="ignore", invalid="ignore"):
        by_centre = by_centre / whole[:, None]
        by_extent = 0.5 * by_square / (whole[:, None] * extent[..., None])
    dims = ("torque", "setting")
    return {
        f"load_{name}_{way}": (dims, values[axis])
        for name, values in (("centre", by_centre), ("extent", by_extent))
        for axis, way in enumerate(WAYS)
    }
