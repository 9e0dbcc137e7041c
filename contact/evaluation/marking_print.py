"""Marking print: where the flanks come nearer than the thickness of the marking compound while they roll unloaded."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays, number
from ...core.errors import InputError
from ...core.kernels import kernel
from ..lines.closest_approach import CURVATURE_SHARE_LIMIT, SEPARATION_FIELDS
from ..lines.contact_lines import BOUNDARY_FIELDS, curvature_and_skew, distance_inside
from ..lines.flank_splines import FlankSplines
from .carrying_error import CarryingError
from .flank_region import FlankRegion, ProjectionPlane, grid_triangles, region_below

Array = NDArray[Any]


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
