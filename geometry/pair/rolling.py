"""Sliding of the flanks, and speed of the contact line across either flank.

All velocities are by the pinion rotation [mm/rad], at points in conjugate contact. Times the pinion's angular velocity
they are velocities in space.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from ..cutting.generating_surface import GeneratingSurface
from ..flanks.flank_parts import on_parts
from ..newton import complex_steps
from ..vectors import column, cross, dot
from .conjugate_motion import ConjugateMotion
from .ease_off import SKEW_STEP, EaseOff

Array = NDArray[Any]


@dataclass(frozen=True)
class Rolling:
    """Motion of the flanks past the contact line, at the nodes of an ease-off (n).

    Parameters
    ----------
    sliding
        Speed of the pinion flank relative to the gear flank [mm/rad].
    pinion_speed, gear_speed
        Speed of the contact line across either flank, at right angles to the line [mm/rad].
    """

    sliding: Array
    pinion_speed: Array
    gear_speed: Array


def relative_velocity(motion: ConjugateMotion, position: Array) -> Array:
    """Velocity of the pinion relative to the gear (3, n) [mm/rad] at points (3, n) [mm] in space."""
    pinion = cross(column(motion.pinion_axis, position), position - column(motion.assembly.pinion_origin, position))
    gear = cross(column(motion.gear_axis, position), position - column(motion.assembly.gear_origin, position))
    return np.asarray(pinion - gear / motion.assembly.ratio)


def rolling(ease_off: EaseOff) -> Rolling:
    """Sliding and rolling at the nodes of an ease-off.

    The speed of the line across a flank is one over the slope of the roll angle on that flank.

    Parameters
    ----------
    ease_off
        From ``ease_off.exact_ease_off``.
    """

    def on_part(surface: GeneratingSurface, parameters: Array) -> Array:
        motion = replace(ease_off.motion, surface=surface)

        def points_and_rotation(p: Array) -> Array:
            gear, rotation = motion.conjugate_gear(p)
            return np.concatenate([surface.evaluate(p)[0], gear, rotation[None]])

        value, slopes = complex_steps(points_and_rotation, parameters)
        space, _ = motion.action_point(parameters, value[6])
        speeds = [_across(slopes[:, k : k + 3], slopes[:, 6]) for k in (0, 3)]
        return np.stack([np.linalg.norm(relative_velocity(motion, space), axis=0), *speeds])

    with np.errstate(all="ignore"):
        values = on_parts(ease_off.motion.surface.flank_parts, ease_off.part, ease_off.pinion_parameters, on_part)
    return Rolling(*np.where(np.isfinite(ease_off.angle), values, np.nan))


def _across(tangents: Array, slopes: Array) -> Array:
    """One over the gradient (n) on a surface with tangents (2, 3, n) of a function with derivatives (2, n)."""
    first, second, mixed = dot(tangents[0], tangents[0]), dot(tangents[1], tangents[1]), dot(tangents[0], tangents[1])
    squared = second * slopes[0] ** 2 - 2.0 * mixed * slopes[0] * slopes[1] + first * slopes[1] ** 2
    return np.asarray(np.sqrt((first * second - mixed**2) / squared))


@frozen_arrays
@dataclass(frozen=True)
class Drift:
    """Rates, by the pinion rotation, of the pinion point opposite a fixed point of the gear, at the nodes (n).

    Parameters
    ----------
    axial, radial
        Coordinates of the pinion point there [mm/rad].
    lengthwise, profile
        First and second derivative of that point's fractions on the pinion flank (2, n) [1/rad, 1/rad^2].
    lever_arm
        Arm about the gear axis of a force along its normal [mm/rad].
    """

    axial: Array
    radial: Array
    lengthwise: Array
    profile: Array
    lever_arm: Array


def drift(ease_off: EaseOff) -> Drift:
    """Drift of the pinion points opposite the nodes of the gear flank, by central differences as the separation skew.

    Parameters
    ----------
    ease_off
        From ``ease_off.exact_ease_off``.
    """
    # Before and after that rotation, in one call.
    rotation = ease_off.roll_angle + ease_off.motion.center
    rotations = np.concatenate([rotation - SKEW_STEP, rotation + SKEW_STEP])

    def on_part(surface: GeneratingSurface, parameters: Array) -> Array:
        motion = replace(ease_off.motion, surface=surface)
        own, own_normal, _ = surface.evaluate(parameters)
        position, normal = motion.turned(*motion.assembly.pinion_to_global(own, own_normal), rotations)
        relative = position - column(motion.assembly.gear_origin, position)
        lever = np.abs(relative[0] * normal[1] - relative[1] * normal[0])
        radial = np.hypot(own[0], own[1])
        return np.stack([own[2], radial, lever, *ease_off.pinion_section.fractions(own[2], radial)])

    with np.errstate(all="ignore"):
        parts, both = ease_off.motion.surface.flank_parts, ease_off.pinion_passing.swapaxes(0, 1).reshape(2, -1)
        shown = on_parts(parts, np.tile(ease_off.part, 2), both, on_part).reshape(5, 2, -1)
        before, after = shown[:, 0], shown[:, 1]
        here = np.stack([ease_off.pinion_lengthwise, ease_off.pinion_profile])
        rates = (after - before) / (2.0 * SKEW_STEP)
        bends = (after[3:] - 2.0 * here + before[3:]) / SKEW_STEP**2
    missing = ~np.isfinite(ease_off.angle)
    rates[:, missing], bends[:, missing] = np.nan, np.nan
    return Drift(rates[0], rates[1], np.stack([rates[3], bends[0]]), np.stack([rates[4], bends[1]]), rates[2])
