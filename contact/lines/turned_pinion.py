"""Where circles about the gear axis meet the turned pinion flank, with derivatives by the circle.

The azimuth of a meeting follows from one step of Newton's method on the generated surface; its derivatives by the axial
and the radial coordinate of the circle follow from the pinion's normal.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.cutting.generating_surface import GeneratingSurface, area_ratio
from ...geometry.flanks.seed_lattice import seed_lattice
from ...geometry.newton import COLUMNS_PER_BLOCK, complex_steps, cramers_rule, determinant
from ...geometry.pair.conjugate_motion import ConjugateMotion
from ...geometry.pair.ease_off import EaseOff
from ...geometry.vectors import column, cos_sin, turn_z

Array = NDArray[Any]


@dataclass(frozen=True)
class CirclesMet:
    """Where circles (n) about the gear axis meet the pinion flank; derivatives by axial and radial coordinate.

    Parameters
    ----------
    azimuth
        In the drive sense of the gear, the gear turned by the ratio [rad].
    slope, bend
        Its derivatives (2, n) and (2, 2, n) [rad/mm, rad/mm^2].
    ahead
        Its derivative by the pinion rotation (n).
    bounds, bound_slopes
        Lengthwise and profile fraction, and coordinate along the blade [mm] (3, n), and their derivatives (3, 2, n).
    parameters, following
        Surface parameters (2, n) and their derivatives (2, 2, n).
    miss
        Distance (n) over which all this is extrapolated [mm]; infinite where the pinion is undercut.
    """

    azimuth: Array
    slope: Array
    bend: Array
    ahead: Array
    bounds: Array
    bound_slopes: Array
    parameters: Array
    following: Array
    miss: Array


def circles_met(
    exact: EaseOff, surface: GeneratingSurface, parameters: Array, rotations: Array, place: Array
) -> CirclesMet:
    """Where circles meet one part of the pinion flank.

    Parameters
    ----------
    exact
        Ease-off of the pair, with its motion and the pinion's blank.
    surface
        The flank part.
    parameters
        Its parameters (2, n) near the meeting.
    rotations
        Pinion rotations (n) [rad].
    place
        Axial and radial coordinates (2, n) of the circles [mm].
    """
    if rotations.size > COLUMNS_PER_BLOCK:  # of which each has a rotation of its own
        parts = _blocks(rotations.size)
        blocks = [circles_met(exact, surface, parameters[:, i], rotations[i], place[:, i]) for i in parts]
        names = [one.name for one in fields(CirclesMet)]
        return CirclesMet(*(np.concatenate([getattr(met, name) for met in blocks], axis=-1) for name in names))
    motion, section = exact.motion, exact.pinion_section
    turned = rotations + motion.center

    def seen(p: Array) -> Array:
        own, own_normal, coordinate = surface.evaluate(p)
        (x, y, z), normal = _in_space(motion, np.tile(turned, len(parameters)), own, own_normal)
        radial = np.sqrt(x**2 + y**2)
        # Along the surface the azimuth changes so that the step is at right angles to the normal.
        share = -motion.pinion_sense / (x * normal[1] - y * normal[0])
        by_radial = share * (x * normal[0] + y * normal[1]) / radial
        bounds = section.fractions(own[2], np.sqrt(own[0] ** 2 + own[1] ** 2))
        return np.array([x, y, z, radial, share * normal[2], by_radial, *bounds, coordinate, *normal])

    with np.errstate(all="ignore"):
        value, (first, second) = complex_steps(seen, parameters)
        inverse = np.array([[second[3], -second[2]], [-first[3], first[2]]]) / determinant(first[2:4], second[2:4])
        away = place - value[2:4]
        slopes = first[4:9, None] * inverse[0] + second[4:9, None] * inverse[1]
        bend, bound_slopes = slopes[:2], slopes[2:]
        position, normal = value[:3], value[9:]
        cut = area_ratio(first[:3], second[:3], normal) * seed_lattice(surface, section).orientation > 0.0
        azimuth = motion.pinion_sense * np.arctan2(value[1], value[0]) + turned / motion.assembly.ratio
        return CirclesMet(
            azimuth=azimuth + np.sum((value[4:6] + 0.5 * _along(bend, away)) * away, axis=0),
            slope=value[4:6] + _along(bend, away),
            bend=bend,
            ahead=-motion.closing_velocity(position + column(motion.assembly.gear_origin, position), normal),
            bounds=value[6:9] + _along(bound_slopes, away),
            bound_slopes=bound_slopes,
            parameters=parameters + _along(inverse, away),
            following=inverse,
            miss=np.where(cut, np.max(np.abs(away), axis=0), np.inf),
        )


def nearer_parameters(
    motion: ConjugateMotion, surface: GeneratingSurface, parameters: Array, rotations: Array, place: Array
) -> Array:
    """Of ``circles_met`` the parameters (2, n) alone."""
    if rotations.size > COLUMNS_PER_BLOCK:
        parts = _blocks(rotations.size)
        blocks = [nearer_parameters(motion, surface, parameters[:, i], rotations[i], place[:, i]) for i in parts]
        return np.concatenate(blocks, axis=-1)
    turned = rotations + motion.center

    def seen(p: Array) -> Array:
        ((x, y, z),) = _in_space(motion, np.tile(turned, len(parameters)), surface.evaluate(p)[0])
        return np.array([z, np.sqrt(x**2 + y**2)])

    with np.errstate(all="ignore"):
        value, (first, second) = complex_steps(seen, parameters)
        return parameters + cramers_rule(first, second, place - value)


def _blocks(count: int) -> list[slice]:
    return [slice(start, start + COLUMNS_PER_BLOCK) for start in range(0, count, COLUMNS_PER_BLOCK)]


def _in_space(motion: ConjugateMotion, turned: Array, *vectors: Array) -> tuple[Array, ...]:
    """Pinion points (3, n) from the origin of the gear, and normals (3, n) if given, after the pinion has turned."""
    assembly = motion.assembly
    cosine, sine = cos_sin(motion.pinion_sense * turned)
    found = [np.tensordot(assembly.pinion_frame, turn_z(cosine, sine, vector), axes=1) for vector in vectors]
    found[0] += column(assembly.pinion_origin - assembly.gear_origin, found[0])
    return tuple(found)


def _along(slopes: Array, way: Array) -> Array:
    """Changes (k, n) over a way (2, n) of quantities with derivatives (k, 2, n)."""
    return np.asarray(slopes[:, 0] * way[0] + slopes[:, 1] * way[1])
