"""Distance of a flank from points along given normals: what a deviation is, whatever its size."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..cutting.generating_surface import GeneratingSurface
from ..cutting.surface_points import SurfacePoints
from ..newton import complex_steps, solve_by
from ..vectors import cross, dot

Array = NDArray[Any]


def normal_distance(
    surface: GeneratingSurface, position: Array, normal: Array, start: Array
) -> tuple[Array, SurfacePoints]:
    """Distance from points along their normals to a surface, by Newton's method.

    A point of the surface is on a normal where two of its coordinates, at right angles to the normal, are those of the
    normal; the third is the distance.

    Parameters
    ----------
    surface
        The surface.
    position, normal
        Points [mm] and unit normals (3, n) in the member's frame.
    start
        Surface parameters near the crossings (2, n).

    Returns
    -------
    tuple
        Distance (n) [mm], positive along the normal, and the points of the surface; NaN where no crossing is found
        with the outward side ahead.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> gear = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7)).members.gear
    >>> beside = gear.position - 0.25 * gear.normal
    >>> distance, _ = normal_distance(gear.surface, beside, gear.normal, gear.parameters)
    >>> bool(np.abs(distance - 0.25).max() < 1e-9)
    True
    """
    first = cross(np.eye(3)[:, np.argmin(np.abs(normal), axis=0)], normal)
    first = first / np.sqrt(dot(first, first))
    across = first, cross(normal, first)

    def derivatives(here: Array, active: NDArray[np.int64]) -> tuple[Array, Array]:
        own = [direction[:, active] for direction in across]
        point, slopes = complex_steps(lambda p: surface.evaluate(p)[0], here)
        return (
            np.stack([dot(direction, point) for direction in own]),
            np.stack([np.stack([dot(direction, slope) for direction in own]) for slope in slopes]),
        )

    target = np.stack([dot(direction, position) for direction in across])
    found = solve_by(derivatives, start, target, surface.max_step)
    with np.errstate(all="ignore"):
        points = SurfacePoints.of(surface, found.parameters)
    usable = found.converged & (dot(points.normal, normal) > 0.0)
    return np.where(usable, dot(points.position - position, normal), np.nan), points
