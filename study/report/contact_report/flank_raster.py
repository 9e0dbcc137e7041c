"""Flank rasters: values at an even grid over the fractions of a member's flank, from contact lines or from splines."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ....contact.evaluation.pressure_map import pressure_map
from ....contact.lines.flank_splines import FlankSplines
from ....core.attributes import ordered
from ...plot.tooth_view import ToothView, fine_grid

Array = NDArray[Any]

RASTER = (121, 49)  # points along the face and the profile
CORNER_TOLERANCE = 1e-9  # of a barycentric coordinate
AREA_MINIMUM = 1e-9  # of a triangle, twice, in meshes of the raster


def on_member(fields: FlankSplines, points: Array, member: str) -> Array:
    """Fractions (2, ...) on a member's flank of points (2, ...) of the gear's; NaN stays NaN."""
    if member == "gear":
        return points
    known = np.nan_to_num(np.clip(points, 0.0, 1.0)).reshape(2, -1)
    found = fields.evaluate(["pinion_lengthwise", "pinion_profile"], known)
    opposite = np.stack(list(found.values())).reshape(np.shape(points))
    return np.where(np.isfinite(points), opposite, np.nan)


def rasterised(points: Array, values: Array, triangles: NDArray[np.int64], shape: tuple[int, int] = RASTER) -> Array:
    """Values of a triangulated surface at the nodes of an even grid.

    Parameters
    ----------
    points
        Fractions (2, n) of the corners.
    values
        Values there (n).
    triangles
        Corners (m, 3).
    shape
        Nodes lengthwise and along the profile.

    Returns
    -------
    Array
        Values (*shape), linear within a triangle, the greatest of those that overlap; NaN beside all of them.

    Examples
    --------
    >>> corners = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    >>> rasterised(corners, np.array([0.0, 1.0, 2.0]), np.array([[0, 1, 2]]), (3, 3)).tolist()
    [[0.0, 1.0, 2.0], [0.5, 1.5, nan], [1.0, nan, nan]]
    """
    grid = np.full(shape[0] * shape[1], np.nan)
    corners = (points.T * (np.array(shape) - 1))[triangles]  # (m, 3, 2), in nodes
    known = np.all(np.isfinite(corners), axis=(1, 2)) & np.all(np.isfinite(values[triangles]), axis=1)
    known &= np.abs(_cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])) > AREA_MINIMUM
    corners, at_corners = corners[known], values[triangles][known]
    low = np.clip(np.ceil(corners.min(axis=1) - 1e-9).astype(int), 0, None)
    high = np.minimum(np.floor(corners.max(axis=1) + 1e-9).astype(int), np.array(shape) - 1)
    count = np.clip(high - low + 1, 0, None)
    each = count.prod(axis=1)
    owner = np.repeat(np.arange(each.size), each)
    number = np.arange(owner.size) - np.repeat(np.cumsum(each) - each, each)
    rows = count[owner, 1]
    node = low[owner] + np.stack([number // np.maximum(rows, 1), number % np.maximum(rows, 1)], axis=1)
    a, b, c = np.moveaxis(corners[owner], 1, 0)
    area = _cross(b - a, c - a)
    second, third = _cross(node - a, c - a) / area, _cross(b - a, node - a) / area
    weight = np.stack([1.0 - second - third, second, third], axis=1)
    within = np.all(weight >= -CORNER_TOLERANCE, axis=1)
    found = np.sum(weight * at_corners[owner], axis=1)[within]
    index = (node[:, 0] * shape[1] + node[:, 1])[within]
    np.fmax.at(grid, index, found)
    return grid.reshape(shape)


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def pressure_raster(at_torque: xr.Dataset, view: ToothView) -> Array:
    """Greatest pressure [MPa] over the mesh cycle on a flank; zero where there is no load."""
    found = pressure_map(at_torque)
    points = on_member(view.fields, found.points, view.member)
    return np.nan_to_num(rasterised(points, found.pressure, found.triangles))


def gear_raster(grid: Array, values: Array, view: ToothView, shape: tuple[int, int] = RASTER) -> Array:
    """Values (nt, nh) at a grid of fractions (2, nt, nh) of the gear's flank, on the flank of a view; NaN elsewhere."""
    node = np.arange(values.size).reshape(values.shape)
    first = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:]], axis=-1).reshape(-1, 3)
    second = np.stack([node[:-1, :-1], node[1:, 1:], node[:-1, 1:]], axis=-1).reshape(-1, 3)
    points = on_member(view.fields, grid.reshape(2, -1), view.member)
    return rasterised(points, values.ravel(), np.concatenate([first, second]), shape)


def on_lines(at_torque: xr.Dataset) -> tuple[NDArray[np.bool_], Array]:
    """Which segments (mesh_position, segment) of contact lines carry load, and the fractions (2, n) of those."""
    order = ("mesh_position", "segment")
    loaded = np.nan_to_num(ordered(at_torque, "pressure", *order)) > 0.0
    return loaded, np.stack([ordered(at_torque, name, *order)[loaded] for name in ("lengthwise", "profile")])


def scattered_rasters(points: Array, values: Array, view: ToothView) -> Array:
    """Values (k, n) at points (2, n) of the gear flank, on its raster (k, *RASTER): linear between, else the nearest.

    The page shows them where there is load; beyond, they keep the border even.
    """
    from scipy.interpolate import LinearNDInterpolator
    from scipy.spatial import Delaunay, QhullError, cKDTree

    here, wanted = view.plane(points).T, view.plane(fine_grid(RASTER)).reshape(2, -1).T
    nearest = values[:, cKDTree(here).query(wanted)[1]]
    try:
        between = LinearNDInterpolator(Delaunay(here), values.T)(wanted).T
    except QhullError:  # fewer than three points, or all on one line
        between = np.full_like(nearest, np.nan)
    return np.where(np.isfinite(between), between, nearest).reshape(-1, *RASTER)
