"""Relative motion of pinion and gear: a twist as E, P, G, Sigma and the rotations of both about their axes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from ...geometry.pair.assembly import Assembly, Misalignment
from .support import member_axes

Array = NDArray[np.float64]
#: Parts of a relative motion, in this order: the four of ``Misalignment``, then the rotations in the drive sense.
PARTS = ("offset", "pinion_axial", "gear_axial", "shaft_angle", "pinion_rotation", "gear_rotation")


@frozen_arrays
@dataclass(frozen=True, eq=False)
class RelativeMotion:
    """The twist of the pinion relative to the gear, about the origin of the global frame, by its six parts.

    Parameters
    ----------
    assembly
        Where the members are: the map is its derivative there.
    pinion_sense
        Sense of the drive rotation about the pinion axis, +1 or -1, see ``ConjugateMotion``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> motion = RelativeMotion(gear_pair(read_case("fm-11x41")).assembly, 1.0)
    >>> motion.parts(motion.twist(np.arange(6.0))).round(12).tolist()
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    """

    assembly: Assembly
    pinion_sense: float

    @cached_property
    def twists(self) -> Array:
        """The twist (6, 6) of a unit of each part, one a column."""
        pinion, gear = member_axes(self.assembly)
        side = 1.0 if self.assembly.pinion_hand == "left" else -1.0
        nothing = np.zeros(3)
        columns = [
            np.concatenate([[0.0, side, 0.0], nothing]),
            np.concatenate([pinion.direction, nothing]),
            np.concatenate([[0.0, 0.0, -1.0], nothing]),
            np.array([0.0, 0.0, 0.0, 0.0, 1.0, 0.0]),
            self.pinion_sense * pinion.rotation,
            self.pinion_sense * gear.rotation,  # the gear turns against it, and its motion counts negative
        ]
        return np.stack(columns, axis=1)

    def twist(self, parts: Array) -> Array:
        """The twist (..., 6) of parts (..., 6) [mm, rad]."""
        return np.asarray(parts @ self.twists.T)

    def parts(self, twist: Array) -> Array:
        """The parts (..., 6) [mm, rad] of a twist (..., 6)."""
        return np.asarray(np.linalg.solve(self.twists, np.asarray(twist)[..., None])[..., 0])


def moved(misalignment: Misalignment, parts: Array) -> Misalignment:
    """A misalignment with the first four parts (6) of a relative motion added.

    Examples
    --------
    >>> moved(Misalignment(offset=0.1), np.array([0.1, 0.0, 0.0, 0.0, 0.0, 0.0])).offset
    0.2
    """
    return Misalignment(*(float(value) for value in np.array(list(vars(misalignment).values())) + parts[:4]))
