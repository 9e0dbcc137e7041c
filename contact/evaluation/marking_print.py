"""Marking print: where the flanks come nearer than the thickness of the marking compound while they roll unloaded."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import number
from ...core.compiled.compiled_use import compiled_code_of
from ...core.errors import InputError
from ..lines.closest_approach import CURVATURE_SHARE_LIMIT, SEPARATION_FIELDS, gap_beside, still_opens
from ..lines.contact_lines import boundary_distance, curvature_and_skew
from ..lines.flank_splines import FlankSplines
from .carrying_error import CarryingError
from .flank_region import FlankRegion, grid_triangles, region_below
from .projection_plane import ProjectionPlane

Array = NDArray[Any]
PRINT_GRID = (241, 121)  # points along the face and the profile
SHIFT_LIMIT = 0.125  # of the pitch, between a point's roll angle and the rotation at which its gap is least
SHIFT_ROUND_COUNT, SHIFT_SAMPLE_COUNT = 2, 17  # of the search for that rotation
GAIN_MINIMUM = 0.001  # [um]; where the search could close less of the gap it is left out
THICKNESS_MINIMUM, THICKNESS_LIMIT = 1e-3, 1000.0  # [um] of the marking compound
BORDER_SLOPE = 20.0  # of the excess, by the distance from the boundary of the common flank


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


def least_gap(splines: FlankSplines, error: CarryingError, points: Array, below: float = np.inf) -> Array:
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
    below
        Gaps above it need not be the least [um].

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
    flat = np.reshape(points, (2, -1))
    value = splines.evaluate(["roll_angle", "ease_off_angle", "lever_arm", *SEPARATION_FIELDS], flat)
    curvature, skew = curvature_and_skew(*(value[name] for name in SEPARATION_FIELDS))
    roll, ease_off, arm = (value[name] for name in ("roll_angle", "ease_off_angle", "lever_arm"))
    gap = ease_off - error.least(roll)
    # The gap is least where the error falls as fast as the flanks open: c d is at most the error's greatest slope.
    limit = SHIFT_LIMIT * error.pinion_pitch
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = np.where(curvature > 0.0, np.minimum(error.steepest / curvature, limit), limit)
    gain = 1e3 * arm * error.steepest * reach
    searched = np.flatnonzero((gain > GAIN_MINIMUM) & (1e3 * arm * gap - gain < below))

    gap[searched] = _least_beside(error, *(v[searched] for v in (ease_off, curvature, skew, roll, reach)))
    return np.asarray((1e3 * arm * gap).reshape(np.shape(points)[1:]))


def _least_beside(
    error: CarryingError, ease_off: Array, curvature: Array, skew: Array, roll: Array, reach: Array
) -> Array:
    """Least gaps (n) [rad] no further from roll angles (n) than the reach (n) [rad]."""
    sample = np.linspace(-1.0, 1.0, SHIFT_SAMPLE_COUNT)
    best, least = np.zeros_like(reach), np.full(reach.shape, np.inf)
    kernel, per_cycle = compiled_code_of(_kernel), float(error.passage.per_cycle)
    if kernel is not None:
        steps = per_cycle / error.pinion_pitch, per_cycle
        kernel.least_beside(
            ease_off, curvature, skew, error.step(roll), reach, sample,
            *steps, CURVATURE_SHARE_LIMIT, error.over_cycle, SHIFT_ROUND_COUNT, least,
        )  # fmt: skip
        return least
    for _ in range(SHIFT_ROUND_COUNT):
        tried = best + sample[:, None] * reach
        opens = still_opens(curvature, skew, tried) | (tried == 0.0)
        found = np.where(opens, gap_beside(ease_off, curvature, skew, tried) - error.least(roll + tried), np.inf)
        chosen = np.argmin(found, axis=0)[None]
        best, least = (np.take_along_axis(values, chosen, axis=0)[0] for values in (tried, found))
        reach = 2.0 * reach / (SHIFT_SAMPLE_COUNT - 1)
    return least


def _kernel() -> Any:
    from . import least_gap_kernel

    return least_gap_kernel


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
        cls, splines: FlankSplines, error: CarryingError, thickness: float, shape: tuple[int, int] = PRINT_GRID
    ) -> MarkingPrint:
        """Print of a compound of a thickness [um], on a grid of a shape; other arguments as of ``least_gap``."""
        points = np.stack(np.meshgrid(*(np.linspace(0.0, 1.0, n) for n in shape), indexing="ij"))
        beyond = -BORDER_SLOPE * boundary_distance(splines, points)
        return cls(points, np.maximum(least_gap(splines, error, points, 2.0 * thickness) / thickness - 1.0, beyond))

    def region(self, plane: ProjectionPlane) -> FlankRegion:
        """The printed part of the flank."""
        flat = self.points.reshape(2, -1)
        return region_below(flat, self.excess.ravel(), grid_triangles(self.excess.shape), 0.0, plane)
