"""Ranges of friction formulas: flags of what was clamped or extrapolated, and its part of the power loss."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Flags = NDArray[np.uint16]

#: Flags of all formulas: an input is clamped to the end of its range, or the formula continued beyond it.
FLAGS = {
    1: "slide_to_roll_clamped",
    2: "pressure_clamped",
    4: "roughness_clamped",
    8: "pressure_extrapolated",
    16: "radius_extrapolated",
    32: "rolling_velocity_extrapolated",
    64: "roughness_extrapolated",
    128: "temperature_extrapolated",
    256: "lambda_clamped",
    512: "coefficient_limited",
    1024: "radius_clamped",
    2048: "rolling_velocity_clamped",
    4096: "viscosity_clamped",
    8192: "pressure_viscosity_clamped",
    16384: "lambda_extrapolated",
}
#: Least thinning of the film by heat of the inlet that is told.
TOLD_THINNING = 0.1


def combined_flags(conditions_of: dict[int, Array]) -> Flags:
    """Sum of the flags (...) from where each holds (...).

    Examples
    --------
    >>> combined_flags({1: np.array([True, False]), 4: np.array([[True], [False]])})
    array([[5, 4],
           [1, 0]], dtype=uint16)
    """
    # One after the other, small arrays first: the sum is large.
    total: Any = np.uint16(0)
    for bit, where in sorted(conditions_of.items(), key=lambda item: np.size(item[1])):
        total = total + np.uint16(bit) * where
    return np.asarray(total, dtype=np.uint16)


@dataclass
class LossShares:
    """Parts of the power loss that need a word, summed over the segments of a mesh cycle.

    Arrays over (torque, speed, temperature, roughness), those of the flags with the flag first.

    Parameters
    ----------
    shape
        Numbers of torques, speeds, temperatures and roughnesses.
    """

    shape: tuple[int, int, int, int]
    whole: Array = field(init=False)
    outside: Array = field(init=False)
    by_flag: Array = field(init=False)
    between: Array = field(init=False)
    thinned: Array = field(init=False)
    thinning: Array = field(init=False)

    def __post_init__(self) -> None:
        self.whole, self.outside, self.between, self.thinned, self.thinning = (np.zeros(self.shape) for _ in range(5))
        self.by_flag = np.zeros((len(FLAGS), *self.shape))

    def add(self, torque: NDArray[np.int64], loss: Array, flags: Flags | None, between: Array, thinning: Array) -> None:
        """Add a block of segments.

        Parameters
        ----------
        torque
            Number of the torque of each (n), sorted.
        loss
            Power loss (speed, temperature, roughness, n).
        flags
            Of the formula (...), or none if it has no range.
        between
            Whether the coefficient is where two expressions of the formula meet (...).
        thinning
            Part by which heat of the inlet thins the film (...).
        """
        starts = np.flatnonzero(np.diff(torque, prepend=-1))
        at = torque[starts]

        def put(target: Array, values: Array, reduce: np.ufunc = np.add) -> None:
            found = np.moveaxis(reduce.reduceat(values, starts, axis=-1), -1, 0)
            target[at] = reduce(target[at], found)

        put(self.whole, loss)
        put(self.thinning, np.broadcast_to(thinning, (*thinning.shape[:-1], loss.shape[-1])), np.maximum)
        thin = thinning > TOLD_THINNING
        if np.any(thin):
            put(self.thinned, loss * thin)
        if np.any(between):
            put(self.between, loss * between)
        present = 0 if flags is None else int(np.bitwise_or.reduce(flags, axis=None))
        if flags is None or not present:
            return
        put(self.outside, loss * (flags > 0))
        for number, bit in enumerate(FLAGS):
            if present & bit:
                put(self.by_flag[number], loss * (flags & bit > 0))

    def variables(self, dimensions: tuple[str, ...], *, ranged: bool, joined: bool) -> dict[str, Any]:
        """The shares as variables of a dataset.

        Parameters
        ----------
        dimensions
            Names of torque, speed, temperature and roughness.
        ranged
            Whether the formula has a range.
        joined
            Whether it is made of several expressions.
        """
        with np.errstate(invalid="ignore", divide="ignore"):
            data: dict[str, Any] = {
                "film_thinning": (dimensions, self.thinning),
                "thinned_share": (dimensions, self.thinned / self.whole),
            }
            if ranged:
                data["extrapolated_share"] = (dimensions, self.outside / self.whole)
                data["flagged_share"] = (("formula_flag", *dimensions), self.by_flag / self.whole)
                data["formula_flag"] = ("formula_flag", np.array(list(FLAGS), dtype=np.uint16))
            if joined:
                data["transition_share"] = (dimensions, self.between / self.whole)
        return data
