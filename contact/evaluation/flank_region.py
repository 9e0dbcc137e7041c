"""Region of a flank: centre, length and height of a contact pattern.

It is measured in the projection plane, the axial plane of a member, into which every point of its flank is turned about
the axis. There the flank is a quadrangle and its grid is bilinear, so that its corners describe it completely.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr

from ...core.arrays import Array, Bools, Integers, record
from ...core.attributes import ordered
from ...geometry.pair.member_names import MemberName


@record(frozen=True)
class ProjectionPlane:
    """Bilinear map from the fractions t and h of a flank to its projection plane [mm]."""

    coefficients: Array  # of 1, t, h and t h (2, 4) [mm]

    @classmethod
    def of(cls, flanks: xr.Dataset, member: MemberName = "gear") -> ProjectionPlane:
        """Plane of a flank of ``geometry.pair_geometry``; the nodes that have a position are enough.

        The first coordinate runs from the toe (zero) to the heel at half height; the second is zero at the lower of the
        root's corners.
        """
        index = int(np.flatnonzero(ordered(flanks, "member", "member") == member)[0])
        position = ordered(flanks, "position", "member", "lengthwise", "profile", "xyz")[index]
        t, h = np.meshgrid(*(ordered(flanks, name, name) for name in ("lengthwise", "profile")), indexing="ij")
        valid = np.all(np.isfinite(position), axis=-1)
        axial, radial = position[valid][:, 2], np.hypot(position[valid][:, 0], position[valid][:, 1])
        t, h = t[valid], h[valid]
        basis = np.stack([np.ones_like(t), t, h, t * h], axis=1)
        section = np.linalg.lstsq(basis, np.stack([axial, radial], axis=1))[0].T
        along = section[:, 1] + 0.5 * section[:, 3]
        along /= np.linalg.norm(along)
        up = np.array([-along[1], along[0]])
        if up @ (section[:, 2] + 0.5 * section[:, 3]) < 0.0:
            up = -up
        plane = np.stack([along, up]) @ section
        plane[0, 0] = -0.5 * plane[0, 2]
        plane[1, 0] = -min(0.0, plane[1, 1])
        return cls(np.asarray(plane))

    def __call__(self, points: Array) -> Array:
        """Coordinates in the plane (2, ...) [mm] of lengthwise and profile fractions (2, ...)."""
        t, h = points
        return np.asarray(np.tensordot(self.coefficients, np.stack([np.ones_like(t), t, h, t * h]), axes=1))


@record(frozen=True)
class FlankRegion:
    """Part of a flank, such as a contact pattern."""

    centre: Array  # centroid of the area, as fractions (2); NaN without area
    extent: Array  # least and greatest by fraction (2, 2)
    area: float  # in the projection plane [mm^2]

    @property
    def size(self) -> Array:
        """Length along the face and height along the profile, as fractions (2)."""
        return np.asarray(self.extent[:, 1] - self.extent[:, 0])

    def reaching(self, points: Array) -> FlankRegion:
        """The region, if it has an area, with an extent that includes points (2, n) without area, as of edges."""
        if not self.area > 0.0 or points.shape[1] == 0:
            return self
        least, greatest = points.min(axis=1), points.max(axis=1)
        low, high = np.minimum(self.extent[:, 0], least), np.maximum(self.extent[:, 1], greatest)
        return replace(self, extent=np.stack([low, high], axis=1))


def region_below(
    points: Array, values: Array, triangles: Integers, level: float, plane: ProjectionPlane
) -> FlankRegion:
    """Region of a flank on which values (n) at points (2, n) lie below a level; they are linear on triangles (m, 3)."""
    reached_ones = (values < level)[triangles].any(axis=1)  # few of a fine grid
    corners, height = points[:, triangles[reached_ones]], values[triangles[reached_ones]] - level  # (2, m, 3), (m, 3)
    below = height < 0.0
    count = np.sum(below, axis=1)
    # Of a triangle that the level cuts, one corner stands alone; the level crosses the two sides from it.
    cut = (count == 1) | (count == 2)
    alone = np.where(count[cut] == 1, np.argmax(below[cut], axis=1), np.argmin(below[cut], axis=1))
    order = (alone[:, None] + np.arange(3)) % 3
    at = np.take_along_axis(corners[:, cut], order[None], axis=2)
    high = np.take_along_axis(height[cut], order, axis=1)
    crossing = at[..., :1] + high[:, :1] / (high[:, :1] - high[:, 1:]) * (at[..., 1:] - at[..., :1])
    tip = np.concatenate([at[..., :1], crossing], axis=2)
    # What lies below is the tip, or the triangle without it.
    parts = np.concatenate([corners[:, count >= 2], tip], axis=1)
    sign = np.concatenate([np.ones(np.sum(count >= 2)), np.where(count[cut] == 1, 1.0, -1.0)])
    area = sign * _areas(plane(parts))
    total = float(np.sum(area))
    if not total > 0.0:
        return FlankRegion(np.full(2, np.nan), np.full((2, 2), np.nan), 0.0)
    reached = np.concatenate([corners[:, below], crossing.reshape(2, -1)], axis=1)
    extent = np.stack([reached.min(axis=1), reached.max(axis=1)], axis=1)
    return FlankRegion(np.mean(parts, axis=2) @ area / total, extent, total)


def grid_triangles(shape: tuple[int, ...]) -> Integers:
    """Corners (m, 3) of the triangles of a grid of points, two a cell, counted along the last axis first."""
    number = np.arange(shape[0] * shape[1]).reshape(shape)
    low, right, far, up = (n.ravel() for n in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    return np.concatenate([np.stack([low, right, far], axis=1), np.stack([low, far, up], axis=1)])


def _areas(corners: Array) -> Array:
    """Areas (m) of triangles (2, m, 3)."""
    first, second = corners[..., 1] - corners[..., 0], corners[..., 2] - corners[..., 0]
    return np.asarray(np.abs(0.5 * (first[0] * second[1] - first[1] * second[0])))


def flank_share(inside: Bools) -> float:
    """Share of a flank that has a property at the nodes of its grid (m, n), those at its border counting half."""
    weights = [np.ones(size) for size in inside.shape]
    for weight in weights:
        weight[[0, -1]] = 0.5
    weight_at = np.multiply.outer(*weights)
    return float(np.sum(weight_at, where=inside) / np.sum(weight_at))
