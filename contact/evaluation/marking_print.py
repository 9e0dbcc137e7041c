"""Marking print: where the flanks come nearer than the thickness of the marking compound while they roll unloaded."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ...core.arrays import Array, Bools, Integers, record
from ...core.checks import number
from ...core.errors import InputError
from ...core.kernels import kernel
from ..lines.closest_approach import CURVATURE_SHARE_LIMIT, SEPARATION_FIELDS
from ..lines.contact_lines import BOUNDARY_FIELDS, curvature_and_skew, distance_inside
from ..lines.flank_splines import FlankSplines
from .flank_region import FlankRegion, ProjectionPlane, grid_triangles, region_below
from .tooth_passage import CarryingError

if TYPE_CHECKING:
    from ..mesh_cycle import MeshCycle


least_beside = kernel(".least_gap_kernel", __package__).least_beside
PRINT_GRID = (241, 121)  # points along the face and the profile
SHIFT_LIMIT = 0.125  # of the pitch, between a point's roll angle and the rotation at which its gap is least
SHIFT_ROUND_COUNT, SHIFT_SAMPLE_COUNT = 2, 17  # of the search for that rotation
GAIN_MINIMUM = 0.001  # [um]; where the search could close less of the gap it is left out
THICKNESS_MINIMUM, THICKNESS_LIMIT = 1e-3, 1000.0  # [um] of the marking compound
BORDER_SLOPE = 20.0  # of the excess, by the distance from the boundary of the common flank
_GAP_FIELDS = ("roll_angle", "ease_off_angle", "lever_arm", *SEPARATION_FIELDS)


def checked_thickness(marking: Any) -> float:
    """Thickness of a marking compound [um], from ``THICKNESS_MINIMUM`` to below ``THICKNESS_LIMIT`` or refused."""
    thickness = number("marking", marking, "um", above=0.0, below=THICKNESS_LIMIT)
    if thickness < THICKNESS_MINIMUM:
        raise InputError(f"marking = {thickness:g}: must be at least {THICKNESS_MINIMUM:g} [um]")
    return thickness


def least_gap(splines: FlankSplines, error: CarryingError, points: Array) -> Array:
    """Least gap (...) [um] at points (2, ...) of the gear flank over the mesh, the carrying pair in contact.

    At a rotation d beyond its roll angle a point has the gap a - e + c d^2 / 2 + s d^3 / 6: ease-off a, transmission
    error e of the carrying pair there, separation curvature c and skew s.
    """
    gaps = _Gaps.of(splines.evaluate(list(_GAP_FIELDS), np.reshape(points, (2, -1))), error)
    gap = gaps.at_roll_angle.copy()
    gaps.search(gaps.gain > GAIN_MINIMUM, gap)
    return gap.reshape(np.shape(points)[1:])


@dataclass(frozen=True)
class _Gaps:
    """Gap at points (n) when the pinion is at their roll angle, and the data to search where it is least."""

    error: CarryingError
    value: Mapping[str, Array]
    curvature: Array
    skew: Array
    at_roll_angle: Array
    reach: Array  # of the least gap from there [rad]
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

    def crossing(self, thickness: float, among: Bools) -> Bools:
        """True for those of some points (n) that may have a gap below a thickness [um], not at their roll angle."""
        candidates = among & (self.at_roll_angle >= thickness)
        index = np.flatnonzero(candidates)
        if index.size:
            ease_off, roll, arm = (self.value[name][index] for name in ("ease_off_angle", "roll_angle", "lever_arm"))
            greatest = self.error.greatest_near(roll, float(np.max(self.reach[index])))
            candidates[index] = 1e3 * arm * (ease_off - greatest) < thickness
        return candidates

    def search(self, wanted: Bools, gap: Array) -> None:
        """Put the least gaps [um] of the wanted points (n) among gaps (n)."""
        index, error = np.flatnonzero(wanted), self.error
        ease_off, roll, arm = (self.value[name][index] for name in ("ease_off_angle", "roll_angle", "lever_arm"))
        sample, least = np.linspace(-1.0, 1.0, SHIFT_SAMPLE_COUNT), np.empty(index.size)
        per_cycle = float(error.passage.per_cycle)
        least_beside(
            ease_off, self.curvature[index], self.skew[index], error.step(roll), self.reach[index], sample,
            per_cycle / error.pinion_pitch, per_cycle, CURVATURE_SHARE_LIMIT, error.over_cycle, SHIFT_ROUND_COUNT,
            least,
        )  # fmt: skip
        gap[index] = 1e3 * arm * least


@record(frozen=True)
class MarkingPrint:
    """Print of a marking compound on the gear flank."""

    points: Array
    excess: Array  # greater of gap over thickness less one and distance beyond the flank (nt, nh), negative within

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
        """Print of a marking compound of a thickness [um], on a grid of a shape (along the face, the profile).

        Unless ``whole``, gaps are the least only in the cells on the border of the print; elsewhere they are but on the
        right side of the thickness.
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
def _triangles(shape: tuple[int, int]) -> Integers:
    """Triangles of a grid, made once: read only."""
    triangles = grid_triangles(shape)
    triangles.setflags(write=False)
    return triangles


def _corners(values: Array) -> Array:
    """Values (4, p - 1, q - 1) at the corners of the cells of a grid (p, q)."""
    return np.stack([values[:-1, :-1], values[1:, :-1], values[1:, 1:], values[:-1, 1:]])


def _beside_border(inside: Bools) -> Bools:
    """Corners (p, q) of the cells that have corners (p, q) inside and outside."""
    corners = _corners(inside)
    cut = np.any(corners, axis=0) & ~np.all(corners, axis=0)
    border = np.zeros_like(inside)
    for i in (slice(None, -1), slice(1, None)):
        for j in (slice(None, -1), slice(1, None)):
            border[i, j] |= cut
    return border


@dataclass(frozen=True)
class UnloadedPattern:
    """Marking print of a pair on the gear flank."""

    printed: MarkingPrint
    region: FlankRegion
    peak_to_peak: float

    @classmethod
    def of(cls, cycle: MeshCycle, thickness: float, shape: tuple[int, int] = PRINT_GRID) -> UnloadedPattern:
        """Pattern of a compound of a thickness [um]; a ``GeometryError`` refuses a pair that never nears contact."""
        unloaded = cycle.unloaded(separation=thickness)
        error = CarryingError.of(unloaded, cycle.pinion_pitch)
        printed = MarkingPrint.of(cycle.fields, error, thickness, shape)
        region = printed.region(ProjectionPlane.of(cycle.geometry.flanks))
        return cls(printed, region, float(unloaded.attrs["peak_to_peak"]))
