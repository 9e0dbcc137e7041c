"""Envelope condition of a generated flank by finite differences of the cutter's motion.

The blade touches the flank where its edge, its motion by the cutter's turning and its motion by the cradle's lie in one
plane. All three are differences of positions from ``cutter_position``; the product takes them from velocities in closed
form.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.checks import frozen_arrays, instance
from ..geometry.cutting.generating_surface import GeneratingSurface
from ..geometry.flanks.flank import Flank
from ..geometry.flanks.flank_parts import on_parts
from ..geometry.vectors import cross, dot
from .cutter_motion import cutter_position

Array = NDArray[Any]
DIFFERENCE_WEIGHTS = ((1, 45.0 / 60.0), (2, -9.0 / 60.0), (3, 1.0 / 60.0))  # central, of sixth order
ANGLE_STEP = 5e-3  # [rad]; with it the difference's error and rounding are both about 1e-11 of the value
EDGE_STEP = 0.05  # [mm]


@frozen_arrays
@dataclass(frozen=True)
class EnvelopeCondition:
    """Flank against cutter at n nodes; NaN where there is no flank.

    Parameters
    ----------
    position
        Distance between the node and the blade's point there [mm].
    normal
        Angle between the flank's normal and the one of edge and cutting motion [rad].
    along_blade
        Distance along the blade from the node's point to where the condition holds [mm]; NaN for a Formate member, on
        which no cradle turns.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> found = envelope_condition(gear_pair(read_case("nasa-12x36")).pinion.middle())
    >>> found.along_blade.shape
    (1,)
    """

    position: Array
    normal: Array
    along_blade: Array


def envelope_condition(flank: Flank) -> EnvelopeCondition:
    """Compare a flank's nodes with the motion of the cutter.

    Parameters
    ----------
    flank
        A flank on its nodes.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> found = envelope_condition(gear_pair(read_case("nasa-12x36")).pinion.middle())
    >>> bool(found.position[0] < 1e-11), bool(found.normal[0] < 1e-11), bool(found.along_blade[0] < 1e-9)
    (True, True, True)
    """
    instance("flank", flank, Flank)

    def on_part(surface: GeneratingSurface, rows: Array) -> Array:
        return _compared(surface, rows[:2], rows[2:5], rows[5:8], rows[8])

    nodes = np.concatenate([flank.parameters, flank.position, flank.normal, flank.blade_distance[None]])
    with np.errstate(all="ignore"):
        position, normal, along = on_parts(flank.surface.flank_parts, flank.part, nodes, on_part)
    missing = ~np.isfinite(flank.position[0])
    return EnvelopeCondition(*(np.where(missing, np.nan, one) for one in (position, normal, along)))


def _compared(
    surface: GeneratingSurface, parameters: Array, position: Array, normal: Array, coordinate: Array
) -> Array:
    angle, second = parameters
    generated = surface.settings.generated
    at = np.stack([coordinate, angle, second if generated else np.zeros_like(second)])

    def place(values: Array) -> Array:
        return cutter_position(surface, *values)

    def own_normal(values: Array) -> Array:
        return cross(difference(place, values, 0, EDGE_STEP), difference(place, values, 1, ANGLE_STEP))

    def condition(values: Array) -> Array:
        across = own_normal(values)
        return dot(across, difference(place, values, 2, ANGLE_STEP)) / np.sqrt(dot(across, across))

    away = np.linalg.norm(place(at) - position, axis=0)
    across = cross(own_normal(at), normal)
    turned = np.sqrt(dot(across, across) / dot(own_normal(at), own_normal(at)))
    if not generated:
        return np.stack([away, turned, np.full(away.shape, np.nan)])
    along = np.abs(condition(at) / difference(condition, at, 0, EDGE_STEP))
    return np.stack([away, turned, along])


def difference(function: Callable[[Array], Array], values: Array, row: int, step: float) -> Array:
    """Derivative of a function of values (k, n) by one of their rows, as a central difference of sixth order.

    Examples
    --------
    >>> at = np.array([[0.3]])
    >>> bool(abs(difference(np.sin, at, 0, 0.01)[0, 0] - np.cos(0.3)) < 1e-12)
    True
    """
    shift = np.zeros_like(values)
    shift[row] = step
    ends = [weight * (function(values + k * shift) - function(values - k * shift)) for k, weight in DIFFERENCE_WEIGHTS]
    return np.asarray(sum(ends) / step)
