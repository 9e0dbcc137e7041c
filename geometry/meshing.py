"""The equation of meshing: where on the blade a generated flank is touched (Kolivand 2009, Eq. 2.8).

The edge, the velocity of its point by the cutter's turning and that by the cradle's lie in one plane there. A velocity
by a rotation is given as (spin, shift): velocity = spin x point + shift.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .vectors import cos_sin, cross, dot

Array = NDArray[Any]
Velocity = tuple[Array, Array]

ITERATIONS = 12  # from a start within a few degrees; five are usual
FLAT = 0.2  # [rad] an arc and its tangent are near enough up to here


def _of(velocity: Velocity, point: Array) -> Array:
    return cross(velocity[0], point) + velocity[1]


def straight_edge(origin: Array, edge: Array, by_cutter: Velocity, by_cradle: Velocity) -> Array:
    """Distance from the origin along a straight edge (n) [mm], in closed form.

    Both velocities are linear in the distance, so the condition is quadratic. Its other root is far away: for a
    face-milling cutter it is always the apex of the cone.

    Parameters
    ----------
    origin, edge
        A point [mm] and the unit vector of the edge (3, n).
    by_cutter, by_cradle
        Velocities of its points.
    """
    at_origin = [_of(velocity, origin) for velocity in (by_cutter, by_cradle)]
    along = [cross(spin, edge) for spin, _ in (by_cutter, by_cradle)]
    constant = dot(edge, cross(at_origin[0], at_origin[1]))
    linear = dot(edge, cross(along[0], at_origin[1]) + cross(at_origin[0], along[1]))
    quadratic = dot(edge, cross(along[0], along[1]))
    root = np.sqrt(linear * linear - 4.0 * constant * quadratic)
    return np.asarray(-2.0 * constant / (linear + np.sign(linear.real) * root))


def circular_edge(
    center: Array,
    radius: float,
    plane: tuple[Array, Array],
    by_cutter: Velocity,
    by_cradle: Velocity,
    middle_angle: float,
) -> Array:
    """Angle (n) [rad] between edge and cutter axis at the touched point of a circular edge.

    Closed form for a face-milling cutter, whose points all move along one direction. In face hobbing that is the start
    of a Newton iteration.

    Parameters
    ----------
    center
        Centre of the arc (3, n) [mm].
    radius
        Radius [mm], positive with the centre on the side of the metal; it may be zero.
    plane
        Unit vectors outward and towards the shank (3, n).
    by_cutter, by_cradle
        Velocities of the blade's points.
    middle_angle
        Angle in the middle of the arc [rad]: the nearest solution is taken.
    """

    def real(values: Array) -> Array:
        return np.asarray(values.real)

    arguments = (real(center), (real(plane[0]), real(plane[1])))
    velocities = [(real(spin), real(shift)) for spin, shift in (by_cutter, by_cradle)]
    angle = _start(*arguments, radius, velocities, middle_angle)
    for _ in range(ITERATIONS):
        step = _newton_step(angle, *arguments, radius, velocities)
        angle = angle + step
        if not np.any(np.abs(step) > 1e-14):
            break
    # One more step in the possibly complex data carries the derivatives.
    return np.asarray(angle + _newton_step(angle, center, plane, radius, [by_cutter, by_cradle]))


def _start(
    center: Array, plane: tuple[Array, Array], radius: float, velocities: list[Velocity], middle_angle: float
) -> Array:
    """Solution with the cutting velocity of the middle of the arc; for a flat arc, that of its tangent there."""
    outward, upward = plane
    sine, cosine = np.sin(middle_angle), np.cos(middle_angle)
    middle = center + radius * (sine * upward - cosine * outward)
    cutting, rolling = _of(velocities[0], middle), _of(velocities[1], center)
    angle = np.arctan2(-dot(rolling, cross(upward, cutting)), dot(rolling, cross(outward, cutting)))
    angle = np.mod(angle - middle_angle + np.pi / 2, np.pi) - np.pi / 2
    if radius != 0.0:
        along_tangent = straight_edge(middle, sine * outward + cosine * upward, *velocities) / radius
        angle = np.where(np.abs(along_tangent) < FLAT, along_tangent, angle)
    return np.asarray(middle_angle + angle)


def _newton_step(
    angle: Array, center: Array, plane: tuple[Array, Array], radius: float, velocities: list[Velocity]
) -> Array:
    outward, upward = plane
    cosine, sine = cos_sin(angle)
    edge, inward = sine * outward + cosine * upward, sine * upward - cosine * outward
    point = center + radius * inward
    cutting, rolling = (_of(velocity, point) for velocity in velocities)
    plane_normal = cross(cutting, rolling)
    value = dot(edge, plane_normal)
    changes = cross(cross(velocities[0][0], edge), rolling) + cross(cutting, cross(velocities[1][0], edge))
    slope = radius * dot(edge, changes) - dot(inward, plane_normal)
    return np.asarray(-value / slope)
