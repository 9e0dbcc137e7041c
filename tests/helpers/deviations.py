"""Deviations the tests are made with."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from easeoff.geometry import GlobalErrors

Array = NDArray[np.float64]

# Of the size of real manufacturing errors [um].
PINION_ERRORS = GlobalErrors(6.0, 8.0, -10.0, 5.0, -4.0)
GEAR_ERRORS = GlobalErrors(-5.0, 3.0, 4.0, -2.0, 6.0)


def worn(lengthwise: Array, profile: Array) -> Array:
    """A dent of 8 um in the middle of the flank [um]."""
    return np.asarray(-8.0 * np.exp(-(((lengthwise - 0.55) / 0.15) ** 2) - ((profile - 0.6) / 0.25) ** 2))
