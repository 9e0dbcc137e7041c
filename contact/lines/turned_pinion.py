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
from ...geometry.newton import COLUMNS_PER_BLOCK, complex_steps, cramers_rule
from ...geometry.pair.conjugate_motion import ConjugateMotion
from ...geometry.pair.ease_off import EaseOff
from ...geometry.vectors import column, rotate

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
        parts = [slice(i, i + COLUMNS_PER_BLOCK) for i in range(0, rotations.size, COLUMNS_PER_BLOCK)]
        blocks = [circles_met(exact, surface, parameters[:, i], rotations[i], place[:, i]) for i in parts]
        names = [one.name for one in fields(CirclesMet)]
        return CirclesMet(*(np.concatenate([getattr(met, name) for met in blocks], axis=-1) for name in names))
    motion, section = exact.motion, exact.pinion_section
    turned = rotations + motion.center

    def seen(p: Array) -> Array:
        own, own_normal, coordinate = surface.evaluate(p)
        x, y, z, *normal = _in_space(motion, own, own_normal, np.tile(turned, len(parameters)))
        radial = np.sqrt(x**2 + y**2)
        # Along the surface the azimuth changes so that the step is at right angles to the normal.
        share = -motion.pinion_sense / (x * normal[1] - y * normal[0])
        by_radial = share * (x * normal[0] + y * normal[1]) / radial
        bounds = section.fractions(own[2], np.sqrt(own[0] ** 2 + own[1] ** 2))
        rows = [z, radial, share * normal[2], by_radial, *bounds, coordinate, x, y, *normal, *own, *own_normal]
        return np.stack(rows)

    with np.errstate(all="ignore"):
        value, (first, second) = complex_steps(seen, parameters)
        inverse = np.stack([cramers_rule(first[:2], second[:2], unit) for unit in np.eye(2)], axis=1)
        away = place - value[:2]
        slopes = first[:, None] * inverse[0] + second[:, None] * inverse[1]
        bend, bound_slopes = slopes[2:4], slopes[4:7]
        slope, bounds = value[2:4] + _along(bend, away), value[4:7] + _along(bound_slopes, away)
        x, y, z = value[7], value[8], value[0]
        here = np.stack([x, y, z + motion.assembly.gear_origin[2]])
        orientation = area_ratio(first[12:15], second[12:15], value[15:18])
        cut = orientation * seed_lattice(surface, section).orientation > 0.0
        azimuth = motion.pinion_sense * np.arctan2(y, x) + turned / motion.assembly.ratio
        return CirclesMet(
            azimuth=azimuth + np.sum((value[2:4] + 0.5 * _along(bend, away)) * away, axis=0),
            slope=slope,
            bend=bend,
            ahead=-motion.closing_velocity(here, value[9:12]),
            bounds=bounds,
            bound_slopes=bound_slopes,
            parameters=parameters + _along(inverse, away),
            following=inverse,
            miss=np.where(cut, np.max(np.abs(away), axis=0), np.inf),
        )


def _in_space(motion: ConjugateMotion, position: Array, normal: Array, turned: Array) -> Array:
    """Pinion points from the origin of the gear, and below them their normals (6, n), after the pinion has turned."""
    assembly = motion.assembly
    position, normal = assembly.pinion_to_global(position, normal)
    origin = column(assembly.pinion_origin, position)
    position = rotate(motion.pinion_axis, turned, position - origin) + origin
    gear = column(assembly.gear_origin, position)
    return np.concatenate([position - gear, rotate(motion.pinion_axis, turned, normal)])


def _along(slopes: Array, way: Array) -> Array:
    """Changes (k, n) over a way (2, n) of quantities with derivatives (k, 2, n)."""
    return np.asarray(slopes[:, 0] * way[0] + slopes[:, 1] * way[1])
