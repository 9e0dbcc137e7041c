"""Marking print: where the flanks come nearer than the thickness of the marking compound while they roll unloaded.

Projection plane: the axial plane of a member, into which every point of its flank is turned about the axis.

There the flank is a quadrangle and its grid is bilinear, so that its corners describe it completely.

Region of a flank: centre, length and height of a contact pattern.

Unloaded pattern of a mesh cycle: the marking print, its centre and size, and the transmission error beside it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.attributes import ordered
from ...core.checks import frozen_arrays, number
from ...core.errors import InputError
from ...core.kernels import kernel
from ...geometry.tooth.tooth_flanks import MemberName
from ..lines.closest_approach import CURVATURE_SHARE_LIMIT, SEPARATION_FIELDS
from ..lines.contact_lines import BOUNDARY_FIELDS, curvature_and_skew, distance_inside
from ..lines.flank_splines import FlankSplines
from ..mesh_cycle import MeshCycle
from .carrying_error import CarryingError

Array = NDArray[Any]


@frozen_arrays
@dataclass(frozen=True)
class ProjectionPlane:
    """Bilinear map from the fractions of a flank to its projection plane.

    Parameters
    ----------
    coefficients
        Coefficients (2, 4) of 1, t, h and t h, for both coordinates of the plane [mm].

    Examples
    --------
    >>> plane = ProjectionPlane(np.array([[0.0, 30.0, 0.0, 0.0], [0.0, 0.0, 8.0, 2.0]]))
    >>> plane(np.array([1.0, 1.0])).tolist()
    [30.0, 10.0]
    """

    coefficients: Array

    @classmethod
    def of(cls, flanks: xr.Dataset, member: MemberName = "gear") -> ProjectionPlane:
        """Plane of a flank of ``geometry.pair_geometry``; the nodes that have a position are enough.

        The first coordinate runs from toe to heel at half height, from zero at the toe; the second is zero at the lower
        of the root's corners.
        """
        own = int(np.flatnonzero(ordered(flanks, "member", "member") == member)[0])
        position = ordered(flanks, "position", "member", "lengthwise", "profile", "xyz")[own]
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


@frozen_arrays
@dataclass(frozen=True)
class FlankRegion:
    """Part of a flank, such as a contact pattern.

    Parameters
    ----------
    centre
        Centroid of the area in the projection plane, as lengthwise and profile fractions (2); NaN if there is no area.
    extent
        Least and greatest lengthwise and profile fraction (2, 2): by the fraction, then from least to greatest.
    area
        In the projection plane [mm^2].

    Examples
    --------
    >>> region = FlankRegion(np.array([0.5, 0.4]), np.array([[0.2, 0.8], [0.1, 0.9]]), 120.0)
    >>> region.size.round(3).tolist()
    [0.6, 0.8]
    """

    centre: Array
    extent: Array
    area: float

    @property
    def size(self) -> Array:
        """Length along the face and height along the profile, as fractions (2)."""
        return np.asarray(self.extent[:, 1] - self.extent[:, 0])

    def reaching(self, points: Array) -> FlankRegion:
        """The region with an extent that includes points (2, n) without an area of their own, such as those of edges.

        A region without area stays one.
        """
        if not self.area > 0.0 or points.shape[1] == 0:
            return self
        least, greatest = points.min(axis=1), points.max(axis=1)
        low, high = np.minimum(self.extent[:, 0], least), np.maximum(self.extent[:, 1], greatest)
        return replace(self, extent=np.stack([low, high], axis=1))


def region_below(
    points: Array, values: Array, triangles: NDArray[np.int64], level: float, plane: ProjectionPlane
) -> FlankRegion:
    """Region of a flank on which values lie below a level; they are linear on every triangle.

    Parameters
    ----------
    points
        Lengthwise and profile fractions (2, n).
    values
        Values at the points (n).
    triangles
        Corners (m, 3).
    level
        The level.
    plane
        In which areas count.

    Examples
    --------
    >>> square = np.array([[0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 1.0]])
    >>> plane = ProjectionPlane(np.array([[0.0, 20.0, 0.0, 0.0], [0.0, 0.0, 10.0, 0.0]]))
    >>> halves = np.array([[0, 1, 2], [0, 2, 3]])
    >>> found = region_below(square, square[0], halves, 0.25, plane)
    >>> round(found.area, 9), found.centre.round(9).tolist(), found.size.round(9).tolist()
    (50.0, [0.125, 0.5], [0.25, 1.0])
    """
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


def grid_triangles(shape: tuple[int, ...]) -> NDArray[np.int64]:
    """Corners (m, 3) of the triangles of a grid of points, two a cell, counted along the last axis first.

    Examples
    --------
    >>> grid_triangles((2, 2)).tolist()
    [[0, 2, 3], [0, 3, 1]]
    """
    number = np.arange(shape[0] * shape[1]).reshape(shape)
    low, right, far, up = (n.ravel() for n in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    return np.concatenate([np.stack([low, right, far], axis=1), np.stack([low, far, up], axis=1)])


def _areas(corners: Array) -> Array:
    """Areas (m) of triangles (2, m, 3)."""
    first, second = corners[..., 1] - corners[..., 0], corners[..., 2] - corners[..., 0]
    return np.asarray(np.abs(0.5 * (first[0] * second[1] - first[1] * second[0])))


def flank_share(inside: NDArray[np.bool_]) -> float:
    """Share of a flank that has a property at the nodes of its grid (m, n), those at its border counting half.

    A mean of the nodes would count the border, where flanks seldom meet, twice: it is 2 % less at 31 by 21 nodes.

    Examples
    --------
    >>> inside = np.ones((11, 5), dtype=bool)
    >>> inside[:, 0] = False  # half a row of cells
    >>> flank_share(inside)
    0.875
    """
    weights = [np.ones(size) for size in inside.shape]
    for weight in weights:
        weight[[0, -1]] = 0.5
    weight_at = np.multiply.outer(*weights)
    return float(np.sum(weight_at, where=inside) / np.sum(weight_at))


least_beside = kernel(".least_gap_kernel", __package__).least_beside
PRINT_GRID = (241, 121)  # points along the face and the profile
SHIFT_LIMIT = 0.125  # of the pitch, between a point's roll angle and the rotation at which its gap is least
SHIFT_ROUND_COUNT, SHIFT_SAMPLE_COUNT = 2, 17  # of the search for that rotation
GAIN_MINIMUM = 0.001  # [um]; where the search could close less of the gap it is left out
THICKNESS_MINIMUM, THICKNESS_LIMIT = 1e-3, 1000.0  # [um] of the marking compound
BORDER_SLOPE = 20.0  # of the excess, by the distance from the boundary of the common flank
_GAP_FIELDS = ("roll_angle", "ease_off_angle", "lever_arm", *SEPARATION_FIELDS)


def checked_thickness(marking: Any) -> float:
    """Thickness of a marking compound [um], refused if no compound has it.

    Raises
    ------
    InputError
        If it is no number from ``THICKNESS_MINIMUM`` to below ``THICKNESS_LIMIT``.

    Examples
    --------
    >>> checked_thickness(6)
    6.0
    """
    thickness = number("marking", marking, "um", above=0.0, below=THICKNESS_LIMIT)
    if thickness < THICKNESS_MINIMUM:
        raise InputError(f"marking = {thickness:g}: must be at least {THICKNESS_MINIMUM:g} [um]")
    return thickness


def least_gap(splines: FlankSplines, error: CarryingError, points: Array) -> Array:
    """Least gap (...) [um] at points of the gear flank over the mesh, the carrying pair in contact.

    A point whose pinion rotation is ``d`` beyond its roll angle has the gap ``a - e + c d^2 / 2 + s d^3 / 6`` with its
    ease-off a, the transmission error e of the carrying pair at that rotation, separation curvature c and skew s. It is
    least beside the roll angle where e changes.

    Parameters
    ----------
    splines
        Splines from ``contact_lines.contact_splines``.
    error
        Transmission error of the unloaded pair.
    points
        Lengthwise and profile fractions (2, ...) on the gear.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=4, segments_per_line=5)
    >>> error = CarryingError.of(cycle.unloaded(), cycle.pinion_pitch)
    >>> middle, corner = least_gap(cycle.fields, error, np.array([[0.65, 0.02], [0.3, 0.98]]))
    >>> bool(middle < 6.0 < corner)
    True
    """
    gaps = _Gaps.of(splines.evaluate(list(_GAP_FIELDS), np.reshape(points, (2, -1))), error)
    gap = gaps.at_roll_angle.copy()
    gaps.search(gaps.gain > GAIN_MINIMUM, gap)
    return gap.reshape(np.shape(points)[1:])


@dataclass(frozen=True)
class _Gaps:
    """Gap at points (n) when the pinion is at their roll angle, and what is needed to search where it is least.

    The least gap is no further from there than ``reach`` [rad], and smaller by no more than ``gain`` [um].
    """

    error: CarryingError
    value: Mapping[str, Array]
    curvature: Array
    skew: Array
    at_roll_angle: Array
    reach: Array
    gain: Array

    @classmethod
    def of(cls, value: Mapping[str, Array], error: CarryingError) -> _Gaps:
        """From values (n) of the ``_GAP_FIELDS``."""
        curvature, skew = curvature_and_skew(*(value[name] for name in SEPARATION_FIELDS))
        # The gap is least where the error falls as fast as the flanks open: their curvature times the rotation from the
        # roll angle is at most the error's greatest slope.
        limit = SHIFT_LIMIT * error.pinion_pitch
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = np.where(curvature > 0.0, np.minimum(error.steepest / curvature, limit), limit)
        arm = 1e3 * value["lever_arm"]
        gap = arm * (value["ease_off_angle"] - error.least(value["roll_angle"]))
        return cls(error, value, curvature, skew, gap, reach, arm * (error.steepest * reach))

    def crossing(self, thickness: float, among: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Which of some points (n) may have a gap below a thickness [um], though not at their roll angle."""
        found = among & (self.at_roll_angle >= thickness)
        index = np.flatnonzero(found)
        if index.size:
            ease_off, roll, arm = (self.value[name][index] for name in ("ease_off_angle", "roll_angle", "lever_arm"))
            greatest = self.error.greatest_near(roll, float(np.max(self.reach[index])))
            found[index] = 1e3 * arm * (ease_off - greatest) < thickness
        return found

    def search(self, wanted: NDArray[np.bool_], gap: Array) -> None:
        """Put the least gaps [um] of the wanted points (n) among gaps (n)."""
        index = np.flatnonzero(wanted)
        ease_off, roll, arm = (self.value[name][index] for name in ("ease_off_angle", "roll_angle", "lever_arm"))
        curvature, skew, reach = self.curvature[index], self.skew[index], self.reach[index]
        gap[index] = 1e3 * arm * _least_beside(self.error, ease_off, curvature, skew, roll, reach)


def _least_beside(
    error: CarryingError, ease_off: Array, curvature: Array, skew: Array, roll: Array, reach: Array
) -> Array:
    """Least gaps (n) [rad] no further from roll angles (n) than the reach (n) [rad]."""
    sample, least = np.linspace(-1.0, 1.0, SHIFT_SAMPLE_COUNT), np.empty(reach.size)
    per_cycle = float(error.passage.per_cycle)
    least_beside(
        ease_off, curvature, skew, error.step(roll), reach, sample, per_cycle / error.pinion_pitch, per_cycle,
        CURVATURE_SHARE_LIMIT, error.over_cycle, SHIFT_ROUND_COUNT, least,
    )  # fmt: skip
    return least


@frozen_arrays
@dataclass(frozen=True)
class MarkingPrint:
    """Print of a marking compound on the gear flank.

    Parameters
    ----------
    points
        Lengthwise and profile fractions of a grid (2, nt, nh).
    excess
        Negative within the print, zero on its border (nt, nh): the gap over the thickness, less one, or the
        distance beyond the common flank if that is greater.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=4, segments_per_line=5)
    >>> error = CarryingError.of(cycle.unloaded(), cycle.pinion_pitch)
    >>> thin, thick = (MarkingPrint.of(cycle.fields, error, thickness) for thickness in (3.0, 6.0))
    >>> plane = ProjectionPlane.of(geometry.flanks)
    >>> thin.region(plane).area < thick.region(plane).area
    True
    """

    points: Array
    excess: Array

    @classmethod
    def of(
        cls,
        splines: FlankSplines,
        error: CarryingError,
        thickness: float,
        shape: tuple[int, int] = PRINT_GRID,
        *,
        whole: bool = True,
    ) -> MarkingPrint:
        """Print of a marking compound.

        Parameters
        ----------
        splines, error
            As of ``least_gap``.
        thickness
            Of the compound [um].
        shape
            Points of the grid along the face and the profile.
        whole
            Whether the gap is the least one at every point where it is below twice the thickness, or only in the cells
            through which the border of the print runs; then it is elsewhere on the right side of the thickness.
        """
        axes = [np.linspace(0.0, 1.0, n) for n in shape]
        points = np.stack(np.meshgrid(*axes, indexing="ij"))
        value = splines.on_grid([*_GAP_FIELDS, *BOUNDARY_FIELDS], *axes)
        beyond = -BORDER_SLOPE * distance_inside(value, splines.in_hole(points)).ravel()
        gaps = _Gaps.of({name: value[name].ravel() for name in _GAP_FIELDS}, error)
        gap = gaps.at_roll_angle.copy()
        worth = (gaps.gain > GAIN_MINIMUM) & (gap - gaps.gain < 2.0 * thickness)
        if not whole:
            undecided = gaps.crossing(thickness, worth & (beyond < 0.0))
            gaps.search(undecided, gap)
            worth &= ~undecided & _beside_border(((beyond < 0.0) & (gap < thickness)).reshape(shape)).ravel()
        gaps.search(worth, gap)
        return cls(points, np.maximum(gap / thickness - 1.0, beyond).reshape(shape))

    def region(self, plane: ProjectionPlane) -> FlankRegion:
        """The printed part of the flank."""
        touched = np.any(_corners(self.excess < 0.0), axis=0).ravel()
        triangles = _triangles(self.excess.shape)[np.tile(touched, 2)]
        return region_below(self.points.reshape(2, -1), self.excess.ravel(), triangles, 0.0, plane)


@lru_cache(maxsize=2)
def _triangles(shape: tuple[int, int]) -> NDArray[np.int64]:
    """Triangles of a grid, made once: read only."""
    triangles = grid_triangles(shape)
    triangles.setflags(write=False)
    return triangles


def _corners(values: Array) -> Array:
    """Values (4, p - 1, q - 1) at the corners of the cells of a grid (p, q)."""
    return np.stack([values[:-1, :-1], values[1:, :-1], values[1:, 1:], values[:-1, 1:]])


def _beside_border(inside: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Corners (p, q) of the cells that have corners (p, q) inside and outside."""
    corners = _corners(inside)
    cut = np.any(corners, axis=0) & ~np.all(corners, axis=0)
    found = np.zeros_like(inside)
    for i in (slice(None, -1), slice(1, None)):
        for j in (slice(None, -1), slice(1, None)):
            found[i, j] |= cut
    return found


@dataclass(frozen=True)
class UnloadedPattern:
    """Marking print of a pair on the gear flank.

    Parameters
    ----------
    printed
        The print.
    region
        Its centre, extent and area.
    peak_to_peak
        Of the unloaded transmission error [urad].

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=4, segments_per_line=5)
    >>> pattern = UnloadedPattern.of(cycle, 6.0)
    >>> bool(0.0 < pattern.region.centre[0] < 1.0)
    True
    """

    printed: MarkingPrint
    region: FlankRegion
    peak_to_peak: float

    @classmethod
    def of(cls, cycle: MeshCycle, thickness: float, shape: tuple[int, int] = PRINT_GRID) -> UnloadedPattern:
        """Pattern of a marking compound of a thickness [um], on a grid of a shape.

        Raises
        ------
        GeometryError
            If no tooth pair comes near contact at any rotation.
        """
        unloaded = cycle.unloaded(separation=thickness)
        error = CarryingError.of(unloaded, cycle.pinion_pitch)
        printed = MarkingPrint.of(cycle.fields, error, thickness, shape)
        region = printed.region(ProjectionPlane.of(cycle.geometry.flanks))
        return cls(printed, region, float(unloaded.attrs["peak_to_peak"]))
