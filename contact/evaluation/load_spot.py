"""Smooth measures of the loaded pattern: centre and extent of the normal forces on the gear flank over a mesh cycle.

The pattern itself ends at a pressure, and its borders jump from segment to segment. Means over the forces change
smoothly with settings and torque, also where further segments begin to touch.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.ordered_values import ordered
from ..solvers import Status

Array = NDArray[Any]
WAYS = ("lengthwise", "profile")


def load_spot(loaded: xr.Dataset) -> dict[str, tuple[tuple[str, ...], Array]]:
    """Load-weighted centre and root-mean-square extents at every torque, with their dimensions.

    Parameters
    ----------
    loaded
        From ``MeshCycle.loaded``.

    Returns
    -------
    dict
        ``load_centre_lengthwise`` and ``load_centre_profile``, mean fractions on the gear over the forces of all mesh
        positions; ``load_extent_lengthwise`` and ``load_extent_profile``, the root of the mean squared distance from
        them. NaN at a torque where a mesh position is not certified.

    Examples
    --------
    >>> dims = ("torque", "mesh_position", "segment")
    >>> loaded = xr.Dataset({"status": (dims[:2], [[0]]), "force": (dims, [[[1.0, 3.0]]])})
    >>> loaded = loaded.assign(lengthwise=(dims, [[[0.2, 0.6]]]), profile=(dims, [[[0.5, 0.5]]]))
    >>> [round(float(value[0]), 3) for _, value in load_spot(loaded).values()]
    [0.5, 0.5, 0.173, 0.0]
    """
    dims = ("torque", "mesh_position", "segment")
    force = np.nan_to_num(ordered(loaded, "force", *dims))
    certified = np.all(ordered(loaded, "status", *dims[:2]) == Status.CERTIFIED, axis=1)
    whole = np.where(certified, force.sum(axis=(1, 2)), np.nan)
    centres: dict[str, tuple[tuple[str, ...], Array]] = {}
    extents: dict[str, tuple[tuple[str, ...], Array]] = {}
    for way in WAYS:
        place = np.nan_to_num(ordered(loaded, way, *dims))
        centre = np.sum(force * place, axis=(1, 2)) / whole
        away = place - centre[:, None, None]
        centres[f"load_centre_{way}"] = (("torque",), centre)
        extents[f"load_extent_{way}"] = (("torque",), np.sqrt(np.sum(force * away**2, axis=(1, 2)) / whole))
    return centres | extents
