"""The gap between two flanks at a position of the mesh, along the normal of the gear, without any approximation.

Both members stand where their shafts have turned them; from points of the gear flank a ray runs along the outward
normal to the pinion flank. Negative where the flanks overlap.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.checks import frozen_arrays
from ..geometry.newton import COLUMNS_PER_BLOCK, complex_steps
from ..geometry.pair.conjugate_motion import ConjugateMotion
from ..geometry.vectors import column, rotate

Array = NDArray[Any]
ITERATION_LIMIT = 25
RESIDUAL_TOLERANCE = 1e-9  # [mm]


@frozen_arrays
@dataclass(frozen=True)
class FlankGap:
    """Gap at points (n) of the gear flank; NaN where no pinion flank was found.

    Parameters
    ----------
    gap
        Distance along the gear's outward normal [mm].
    pinion_parameters
        Parameters (2, n) of the pinion point opposite.
    pinion_position, pinion_normal
        That point [mm] and its outward normal (3, n), in the pinion's frame.
    facing
        Cosine of the angle between the normals of both flanks (n).

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> gear, exact = geometry.members.gear, geometry.exact
    >>> start = exact.pinion_parameters
    >>> found = flank_gap(exact.motion, gear.position, gear.normal, exact.motion.center, 0.0, start)
    >>> found.pinion_position.shape
    (3, 63)
    """

    gap: Array
    pinion_parameters: Array
    pinion_position: Array
    pinion_normal: Array
    facing: Array


def flank_gap(
    motion: ConjugateMotion,
    position: Array,
    normal: Array,
    rotation: float,
    closing: float,
    start: Array,
) -> FlankGap:
    """Gap between the flanks at one mesh position.

    Parameters
    ----------
    motion
        Axes, senses and the pinion flank.
    position, normal
        Points of the gear flank and their outward unit normals (3, n), in the gear's frame [mm].
    rotation
        Pinion rotation in the drive sense, counted as in ``motion`` [rad].
    closing
        Gear rotation against the drive sense, beyond the ideal ratio [rad].
    start
        First guess of the pinion parameters (2, n).

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> gear, exact = geometry.members.gear, geometry.exact
    >>> middle, start = exact.motion.center, exact.pinion_parameters
    >>> before = flank_gap(exact.motion, gear.position, gear.normal, middle, 0.0, start)
    >>> closer = flank_gap(exact.motion, gear.position, gear.normal, middle, 1e-5, start)
    >>> bool(np.nanmax(closer.gap - before.gap) < 0.0)
    True
    """
    if position.shape[1] > COLUMNS_PER_BLOCK:
        parts = [slice(i, i + COLUMNS_PER_BLOCK) for i in range(0, position.shape[1], COLUMNS_PER_BLOCK)]
        found = [flank_gap(motion, position[:, p], normal[:, p], rotation, closing, start[:, p]) for p in parts]
        return FlankGap(*(np.concatenate([getattr(f, one.name) for f in found], axis=-1) for one in fields(FlankGap)))
    turn = np.asarray(rotation / motion.assembly.ratio - closing)
    origin = column(motion.assembly.gear_origin, position)
    here = rotate(motion.gear_axis, turn, position) + origin
    along = rotate(motion.gear_axis, turn, normal)
    # From here on all rays stand still: three equations for the pinion's two parameters and the distance.
    values = np.concatenate([start, np.zeros((1, position.shape[1]))])

    def miss(v: Array) -> Array:
        point, _ = motion.action_point(v[:2], np.full(v.shape[1], rotation))
        repeats = v.shape[1] // here.shape[1]
        return np.asarray(point - np.tile(here, repeats) - v[2] * np.tile(along, repeats))

    limit = np.concatenate([motion.surface.max_step, [2.0]])[:, None]
    converged = np.zeros(position.shape[1], dtype=bool)
    with np.errstate(all="ignore"):
        for _ in range(ITERATION_LIMIT):
            value, derivatives = complex_steps(miss, values)
            jacobian = np.array(derivatives.transpose(2, 1, 0))
            finite = np.all(np.isfinite(jacobian), axis=(1, 2)) & (np.abs(np.linalg.det(jacobian)) > 0.0)
            jacobian[~finite] = np.eye(3)
            step = -np.linalg.solve(jacobian, np.where(finite, value, 0.0).T[..., None])[..., 0].T
            converged = finite & (np.max(np.abs(value), axis=0) < RESIDUAL_TOLERANCE)
            values = values + step / np.maximum(1.0, np.max(np.abs(step) / limit, axis=0))
            if np.all(converged | ~finite):
                break
        own, own_normal, _ = motion.surface.evaluate(values[:2])
        _, turned = motion.action_point(values[:2], np.full(values.shape[1], rotation))
    blank = np.where(converged, 1.0, np.nan)
    facing = -np.sum(turned * along, axis=0)
    return FlankGap(values[2] * blank, values[:2], own * blank, own_normal * blank, facing * blank)
