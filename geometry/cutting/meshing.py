"""The equation of meshing: the point of the blade that touches a generated flank (Kolivand 2009, Eq. 2.8).

The edge, the velocity of its point by the cutter's turning and that by the cradle's lie in one plane there. A velocity
by a rotation is given as (spin, shift): velocity = spin x point + shift.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..vectors import cos_sin, cross, dot

Array = NDArray[Any]
Velocity = tuple[Array, Array]

ITERATION_LIMIT = 12  # from a start within a few degrees; five are usual
FLAT_TURN_LIMIT = 0.2  # [rad] an arc and its tangent are near enough up to here


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


def on_arc(
    middle: Array, radius: float, plane: tuple[Array, Array], middle_angle: float, turn: Array
) -> tuple[Array, Array]:
    """Point [mm] and direction (3, n) of a circular edge, ``turn`` (n) [rad] of its direction away from the middle.

    The point lies on the chord, whose direction is that of the edge half way: exact for a radius of any size.
    """
    outward, upward = plane
    _, half_sine = cos_sin(0.5 * turn)
    cosine, sine = cos_sin(middle_angle + 0.5 * turn)
    chord = sine * outward + cosine * upward
    end_cosine, end_sine = cos_sin(middle_angle + turn)
    return middle + 2.0 * radius * half_sine * chord, end_sine * outward + end_cosine * upward


def circular_edge(
    middle: Array,
    radius: float,
    plane: tuple[Array, Array],
    by_cutter: Velocity,
    by_cradle: Velocity,
    middle_angle: float,
) -> Array:
    """Turn (n) [rad] of a circular edge's direction from its middle to the touched point.

    Closed form for a face-milling cutter, whose points all move along one direction. In face hobbing that is the start
    of a Newton iteration.

    Parameters
    ----------
    middle
        Middle of the arc (3, n) [mm].
    radius
        Radius [mm], positive with the centre on the side of the metal; it may be zero.
    plane
        Unit vectors outward and towards the shank (3, n).
    by_cutter, by_cradle
        Velocities of the blade's points.
    middle_angle
        Angle between edge and cutter axis in the middle of the arc [rad]: the nearest solution is taken.
    """

    def real(values: Array) -> Array:
        return np.asarray(values.real)

    arc = (real(middle), radius, (real(plane[0]), real(plane[1])), middle_angle)
    velocities = [(real(spin), real(shift)) for spin, shift in (by_cutter, by_cradle)]
    turn = _start(*arc, velocities)
    for _ in range(ITERATION_LIMIT):
        step = _newton_step(*arc, velocities, turn)
        turn = turn + step
        if not np.any(np.abs(step) > 1e-14):
            break
    # One more step in the possibly complex data carries the derivatives.
    return np.asarray(turn + _newton_step(middle, radius, plane, middle_angle, [by_cutter, by_cradle], turn))


def _start(
    middle: Array, radius: float, plane: tuple[Array, Array], middle_angle: float, velocities: list[Velocity]
) -> Array:
    """Solution with the cutting velocity of the middle of the arc; for a flat arc, that of its tangent there."""
    outward, upward = plane
    sine, cosine = np.sin(middle_angle), np.cos(middle_angle)
    center = middle + radius * (cosine * outward - sine * upward)
    cutting, rolling = _of(velocities[0], middle), _of(velocities[1], center)
    angle = np.arctan2(-dot(rolling, cross(upward, cutting)), dot(rolling, cross(outward, cutting)))
    turn = np.mod(angle - middle_angle + np.pi / 2, np.pi) - np.pi / 2
    if radius != 0.0:
        along_tangent = straight_edge(middle, sine * outward + cosine * upward, *velocities) / radius
        turn = np.where(np.abs(along_tangent) < FLAT_TURN_LIMIT, along_tangent, turn)
    return np.asarray(turn)


def _newton_step(
    middle: Array,
    radius: float,
    plane: tuple[Array, Array],
    middle_angle: float,
    velocities: list[Velocity],
    turn: Array,
) -> Array:
    point, edge = on_arc(middle, radius, plane, middle_angle, turn)
    cosine, sine = cos_sin(middle_angle + turn)
    inward = sine * plane[1] - cosine * plane[0]
    cutting, rolling = (_of(velocity, point) for velocity in velocities)
    plane_normal = cross(cutting, rolling)
    value = dot(edge, plane_normal)
    changes = cross(cross(velocities[0][0], edge), rolling) + cross(cutting, cross(velocities[1][0], edge))
    slope = radius * dot(edge, changes) - dot(inward, plane_normal)
    return np.asarray(-value / slope)
