"""Peak to peak and harmonics of a transmission error over one mesh cycle."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


def peak_to_peak(values: Array) -> float:
    """Largest minus smallest value of a cycle (n), in the units of the values.

    Examples
    --------
    >>> peak_to_peak(np.array([1.0, 4.0, 2.0]))
    3.0
    """
    return float(np.max(values) - np.min(values))


def harmonics(values: Array, orders: int = 3) -> Array:
    """Amplitudes (orders) of the first harmonics of a cycle sampled evenly at n points.

    Examples
    --------
    >>> cycle = 5.0 + 2.0 * np.cos(2 * np.pi * np.arange(16) / 16 + 0.3)
    >>> [float(a) for a in harmonics(cycle).round(12)]
    [2.0, 0.0, 0.0]
    """
    spectrum = np.abs(np.fft.rfft(values)) * 2.0 / len(values)
    if len(values) % 2 == 0:
        spectrum[-1] /= 2.0  # the highest order of an even sample is not shared with its mirror
    result = np.zeros(orders)
    count = min(orders, spectrum.size - 1)
    result[:count] = spectrum[1 : count + 1]
    return result


def rms(amplitudes: Array) -> float:
    """Root of the sum of the squared amplitudes, as the dissertation's tables use it (without the factor 1/sqrt 2).

    Examples
    --------
    >>> rms(np.array([3.0, 4.0]))
    5.0
    """
    return float(np.sqrt(np.sum(np.square(amplitudes))))
