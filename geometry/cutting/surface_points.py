"""Points of a generating surface with their tangents, and the search for those with given coordinates.

Cutting a point is the costly part of every flank: here it is done once a point, with its derivatives, which tell
everything that depends on the place of the surface in space.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from ..newton import NewtonResult, complex_steps, solve_by
from .generating_surface import GeneratingSurface, area_ratio

Array = NDArray[Any]
Locate = Callable[["SurfacePoints"], tuple[Array, Array]]
LINEAR_STEP = 1e-11  # of the longest step; along so short a one a point and its tangents are followed linearly


@frozen_arrays
@dataclass(frozen=True)
class SurfacePoints:
    """Points of a generating surface (n) in the member's frame.

    Parameters
    ----------
    parameters
        Surface parameters (2, n).
    values
        Position [mm], outward normal and blade coordinate [mm], in this order (7, n).
    slopes
        Their derivatives by both parameters (2, 7, n).

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> surface = gear_pair(read_case("fm-11x41")).gear.loaded
    >>> points = SurfacePoints.of(surface, np.array([[1.0], [5.0]]))
    >>> bool((points.position == surface.evaluate(points.parameters)[0]).all())
    True
    """

    parameters: Array
    values: Array
    slopes: Array

    @classmethod
    def of(cls, surface: GeneratingSurface, parameters: Array) -> SurfacePoints:
        """Points at given parameters (2, n)."""

        def all_values(p: Array) -> Array:
            position, normal, coordinate = surface.evaluate(p)
            return np.concatenate([position, normal, coordinate[None]])

        return cls(parameters, *complex_steps(all_values, parameters))

    @property
    def position(self) -> Array:
        """Positions (3, n) [mm]."""
        return self.values[:3]

    @property
    def normal(self) -> Array:
        """Outward unit normals (3, n)."""
        return self.values[3:6]

    @property
    def coordinate(self) -> Array:
        """Blade coordinate (n) [mm]."""
        return np.asarray(self.values[6])

    @property
    def orientation(self) -> Array:
        """Signed area ratio (n), as ``GeneratingSurface.orientation``."""
        return area_ratio(self.slopes[0], self.slopes[1], self.normal)

    def at(self, chosen: Any) -> SurfacePoints:
        """Some of the points."""
        return SurfacePoints(self.parameters[:, chosen], self.values[:, chosen], self.slopes[..., chosen])

    def moved(self, step: Array) -> SurfacePoints:
        """The points after so short a step of the parameters (2, n) that it is linear."""
        return SurfacePoints(
            self.parameters + step, self.values + step[0] * self.slopes[0] + step[1] * self.slopes[1], self.slopes
        )

    def with_others(self, chosen: Any, others: SurfacePoints) -> SurfacePoints:
        """The points with others in place of some of them."""
        arrays = np.array(self.parameters), np.array(self.values), np.array(self.slopes)
        for own, other in zip(arrays, (others.parameters, others.values, others.slopes), strict=True):
            own[..., chosen] = other
        return SurfacePoints(*arrays)


def axial_and_radial(points: SurfacePoints) -> tuple[Array, Array]:
    """Axial and radial coordinates (2, n) [mm] about the member's axis, and their derivatives (2, 2, n)."""
    x, y, z = points.position
    radial = np.sqrt(x**2 + y**2)
    along, outward = points.slopes[:, 2], (x * points.slopes[:, 0] + y * points.slopes[:, 1]) / radial
    return np.stack([z, radial]), np.stack([along, outward], axis=1)


def points_at(
    locate: Locate, surface: GeneratingSurface, start: SurfacePoints, target: Array
) -> tuple[SurfacePoints, NewtonResult]:
    """Points with given coordinates, by Newton's method.

    Parameters
    ----------
    locate
        Two coordinates of points (2, n), and their derivatives by both parameters (2, 2, n).
    surface
        The surface.
    start
        First guess (n).
    target
        Coordinates (2, n).

    Returns
    -------
    tuple
        The points, and how the search ended.
    """
    held, known = start, True

    def derivatives(here: Array, active: NDArray[np.int64]) -> tuple[Array, Array]:
        nonlocal held, known
        if known:
            known = False
            return locate(held)
        points = SurfacePoints.of(surface, here)
        held = points if active.size == target.shape[1] else held.with_others(active, points)
        return locate(points)

    with np.errstate(all="ignore"):
        found = solve_by(derivatives, start.parameters, target, surface.max_step)
        step = found.parameters - held.parameters
        far = np.flatnonzero(~np.all(np.abs(step) < LINEAR_STEP * surface.max_step[:, None], axis=0))
        held = held.moved(step)
        if far.size:
            held = held.with_others(far, SurfacePoints.of(surface, found.parameters[:, far]))
    return held, found
