"""Marking print: where the flanks come nearer than the thickness of the marking compound while they roll unloaded."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..lines.closest_approach import SEPARATION_FIELDS, gap_beside
from ..lines.contact_lines import boundary_distance, curvature_and_skew
from ..lines.flank_splines import FlankSplines
from .carrying_error import CarryingError
from .flank_region import FlankRegion, grid_triangles, region_below
from .projection_plane import ProjectionPlane

Array = NDArray[Any]
PRINT_GRID = (241, 121)  # points along the face and the profile
BORDER_SLOPE = 20.0  # of the excess, by the distance from the boundary of the common flank


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
    >>> bool(least_gap(cycle.fields, error, np.array([0.5, 0.5])) < 6.0)
    True
    """
    value = splines.evaluate(["roll_angle", "ease_off_angle", "lever_arm", *SEPARATION_FIELDS], points)
    curvature, skew = curvature_and_skew(*(value[name] for name in SEPARATION_FIELDS))
    roll = value["roll_angle"]

    def gap(beyond: Array) -> Array:
        return gap_beside(value["ease_off_angle"], curvature, skew, beyond) - error.least(roll + beyond)

    with np.errstate(divide="ignore", invalid="ignore"):
        beside = np.where(curvature > 0.0, error.least_slope(roll) / curvature, 0.0)
    limit = error.pinion_pitch / error.passage.per_cycle
    both = np.minimum(gap(np.zeros_like(roll)), gap(np.clip(beside, -limit, limit)))
    return np.asarray(1e3 * both * value["lever_arm"])


@dataclass(frozen=True)
class MarkingPrint:
    """Print of a marking compound on the gear flank.

    Parameters
    ----------
    points
        Lengthwise and profile fractions (2, *PRINT_GRID).
    excess
        Negative within the print, zero on its border (*PRINT_GRID): the gap over the thickness, less one, or the
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
    def of(cls, splines: FlankSplines, error: CarryingError, thickness: float) -> MarkingPrint:
        """Print of a compound of a thickness [um]; other arguments as of ``least_gap``."""
        points = np.stack(np.meshgrid(*(np.linspace(0.0, 1.0, n) for n in PRINT_GRID), indexing="ij"))
        beyond = -BORDER_SLOPE * boundary_distance(splines, points)
        return cls(points, np.maximum(least_gap(splines, error, points) / thickness - 1.0, beyond))

    def region(self, plane: ProjectionPlane) -> FlankRegion:
        """The printed part of the flank."""
        flat = self.points.reshape(2, -1)
        return region_below(flat, self.excess.ravel(), grid_triangles(PRINT_GRID), 0.0, plane)
