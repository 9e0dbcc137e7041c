"""Conventional unloaded tooth contact analysis: an independent check of the ease-off method.

At a given pinion rotation the two flanks touch where positions and normals agree: five equations for the two
parameters of each flank and the gear rotation (Kolivand 2009, Eq. 2.14; Litvin).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.checks import frozen_arrays
from ..geometry.cutting.generating_surface import GeneratingSurface
from ..geometry.flanks.flank import Flank
from ..geometry.newton import complex_steps
from ..geometry.pair.conjugate_motion import ConjugateMotion
from ..geometry.pair.ease_off import EaseOff
from ..geometry.vectors import column, rotate

Array = NDArray[Any]


@frozen_arrays
@dataclass(frozen=True)
class PointContact:
    """Contact points at the given pinion rotations (n); columns that did not converge are NaN.

    Parameters
    ----------
    pinion_rotation
        Rotation of the pinion in the drive sense [rad].
    closing_angle
        Gear rotation against the drive sense, beyond the ideal ratio, at which the flanks touch [rad]: the ease-off
        method's transmission error plus its ``first_contact_rad``.
    gear_parameters, pinion_parameters
        Surface parameters (2, n).
    gear_position, pinion_position
        Contact point (3, n) in each member's own frame [mm].
    converged
        Where the equations are solved.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> path = path_of_contact(geometry.members.gear, geometry.exact, np.array([-0.1, 0.0, 0.1]))
    >>> path.converged.tolist(), path.gear_position.shape
    ([True, True, True], (3, 3))
    """

    pinion_rotation: Array
    closing_angle: Array
    gear_parameters: Array
    pinion_parameters: Array
    gear_position: Array
    pinion_position: Array
    converged: NDArray[np.bool_]


def point_contact(
    motion: ConjugateMotion,
    gear_surface: GeneratingSurface,
    pinion_rotation: Array,
    gear_start: Array,
    pinion_start: Array,
    closing_start: Array,
    *,
    iterations: int = 30,
) -> PointContact:
    """Solve the five equations of contact at every pinion rotation.

    Parameters
    ----------
    motion
        Axes, senses and pinion surface.
    gear_surface
        The gear flank.
    pinion_rotation
        Pinion rotations (n) in the drive sense, counted as in ``motion`` [rad].
    gear_start, pinion_start, closing_start
        First guess of the surface parameters (2, n) each, and of the closing angle (n).
    iterations
        Newton iterations.

    Returns
    -------
    PointContact
        Contact points, NaN where not converged.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> exact = geometry.exact
    >>> start = geometry.members.gear.parameters[:, 31:32], exact.pinion_parameters[:, 31:32], np.zeros(1)
    >>> found = point_contact(exact.motion, geometry.members.gear.surface, np.array([exact.motion.center]), *start)
    >>> bool(found.converged[0])
    True
    """
    assembly = motion.assembly
    # The five unknowns, and below them the given rotation.
    values = np.concatenate([gear_start, pinion_start, closing_start[None], pinion_rotation[None]])

    def mismatch(values: Array) -> Array:
        p, n_p = motion.action_point(values[2:4], values[5])
        g, n_g, _ = gear_surface.evaluate(values[:2])
        turn = values[5] / assembly.ratio - values[4]
        g = rotate(motion.gear_axis, turn, g) + column(assembly.gear_origin, g)
        n_g = rotate(motion.gear_axis, turn, n_g)
        return np.concatenate([p - g, n_p + n_g])

    limit = np.concatenate([gear_surface.max_step, motion.surface.max_step, [0.05]])[:, None]
    converged = np.zeros(pinion_rotation.shape, dtype=bool)
    with np.errstate(all="ignore"):
        for _ in range(iterations):
            value, derivatives = complex_steps(mismatch, values)
            # Two of the three normal equations are independent; least squares keeps the symmetry between them.
            jacobian = np.array(derivatives[:5].transpose(2, 1, 0))
            finite = np.all(np.isfinite(jacobian), axis=(1, 2))
            jacobian[~finite] = 0.0
            residual = np.where(finite, value, 0.0)
            step = -(np.linalg.pinv(jacobian) @ residual.T[..., None])[..., 0].T
            converged = finite & (np.max(np.abs(value), axis=0) < 1e-10)
            step = step / np.maximum(1.0, np.max(np.abs(step) / limit, axis=0))
            values[:5] += step
            if np.all(converged | ~finite):
                break
        gear_position, _, _ = gear_surface.evaluate(values[:2])
        pinion_position, _, _ = motion.surface.evaluate(values[2:4])
    blank = np.where(converged, 1.0, np.nan)
    return PointContact(
        pinion_rotation,
        values[4] * blank,
        values[:2] * blank,
        values[2:4] * blank,
        gear_position * blank,
        pinion_position * blank,
        converged,
    )


def path_of_contact(gear: Flank, ease_off: EaseOff, rotations: Array) -> PointContact:
    """Points of contact at the given pinion rotations, each started from the node that is nearest to touching.

    Parameters
    ----------
    gear
        The gear flank on its nodes.
    ease_off
        Ease-off at these nodes.
    rotations
        Pinion rotations (n) in the drive sense, from the middle of the pinion [rad].

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> path = path_of_contact(geometry.members.gear, geometry.exact, np.array([-0.1, 0.0, 0.1]))
    >>> path.converged.tolist()
    [True, True, True]
    """
    motion = ease_off.motion
    inside = np.flatnonzero(ease_off.inside)
    beyond = rotations[:, None] - ease_off.roll_angle[inside]
    gap = ease_off.angle[inside] + 0.5 * ease_off.separation_curvature[inside] * beyond**2
    node = inside[np.argmin(gap, axis=1)]
    return point_contact(
        motion,
        gear.surface,
        rotations + motion.center,
        gear.parameters[:, node],
        ease_off.pinion_parameters[:, node],
        gap.min(axis=1),
    )
