"""Peak to peak and harmonics of a transmission error over one mesh cycle."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

EXTREME_ROUNDS = 6
WINDOW = 4  # samples on either side of an extreme that its place is estimated from
PLACES = np.linspace(0.0, 1.0, 1001)[1:-1]  # between two samples, at which the estimate is looked at


def peak_to_peak(values: Array) -> float:
    """Largest minus smallest value of a cycle (n), in the units of the values.

    Examples
    --------
    >>> peak_to_peak(np.array([1.0, 4.0, 2.0]))
    3.0
    """
    return float(np.max(values) - np.min(values))


def continuous_range(values: Array, at: Callable[[Array], Array], tolerance: float) -> float:
    """Peak to peak of a periodic function between its samples as well, with kinks where it is the least of several.

    On either side of a kink the function is smooth: parabolas through the samples beside it meet at its peak. There the
    function is evaluated, and again with that sample added, until the estimate comes true.

    Parameters
    ----------
    values
        Samples (n) at i / n of the period, seven at least; NaN makes the result NaN.
    at
        The function at places (m), as fractions of the period from 0 to 1.
    tolerance
        Difference between an estimate and the value there that ends the search, in the units of the values.

    Examples
    --------
    >>> def sawtooth(x):
    ...     return np.minimum(np.mod(x - 0.03, 1.0), 2.0 * np.mod(0.03 - x, 1.0))
    >>> round(continuous_range(sawtooth(np.arange(16) / 16), sawtooth, 1e-6), 3)
    0.667
    """
    (_, greatest), (_, least) = extremes(values, at, tolerance)
    return greatest - least


def extremes(
    values: Array, at: Callable[[Array], Array], tolerance: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Place and value of the greatest and of the least value; arguments as of ``continuous_range``.

    Examples
    --------
    >>> def wave(x):
    ...     return np.cos(2.0 * np.pi * x)
    >>> (place, value), _ = extremes(wave(np.arange(16) / 16), wave, 1e-6)
    >>> round(value, 6)
    1.0
    """
    if not np.all(np.isfinite(values)):
        return (np.nan, np.nan), (np.nan, np.nan)
    windows = [(sign, *window) for sign in (1.0, -1.0) for window in _windows(sign * values)]
    open_ones = list(range(len(windows)))
    for _ in range(EXTREME_ROUNDS):
        estimates = [_estimated(*windows[k][1:]) for k in open_ones]
        found = at(np.mod([place for place, _ in estimates], 1.0))
        following = []
        for k, (place, estimate), value in zip(open_ones, estimates, found, strict=True):
            sign, places, heights = windows[k]
            index = np.searchsorted(places, place)
            windows[k] = sign, np.insert(places, index, place), np.insert(heights, index, sign * value)
            if abs(sign * value - estimate) > tolerance:
                following.append(k)
        open_ones = following
        if not open_ones:
            break

    def highest(sign: float) -> tuple[float, float]:
        known = [(w[2][k], w[1][k]) for w in windows if w[0] == sign for k in [np.argmax(w[2])]]
        value, place = max(known)
        return float(np.mod(place, 1.0)), float(sign * value)

    return highest(1.0), highest(-1.0)


def _windows(values: Array) -> list[tuple[Array, Array]]:
    """Places and values around every sample beside which the greatest value may lie."""
    before, after = np.roll(values, 1), np.roll(values, -1)
    rise = np.maximum(np.abs(values - before), np.abs(values - after))
    high = (values >= before) & (values >= after) & (values + rise >= np.max(values))
    around = np.flatnonzero(high)[:, None] + np.arange(-WINDOW, WINDOW + 1)
    return [(index / values.size, values[index % values.size]) for index in around]


def _estimated(places: Array, values: Array) -> tuple[float, float]:
    """Where a function that is the least of smooth ones is greatest beside its greatest sample, and its value there."""
    middle = int(np.clip(np.argmax(values), 3, values.size - 4))
    tried, heights = [], []
    for left in (middle - 1, middle):
        x = places[left] + (places[left + 1] - places[left]) * PLACES
        sides = (slice(left - 2, left + 1), slice(left + 1, left + 4))
        tried.append(x)
        heights.append(np.minimum(*(_parabola(places[side], values[side], x) for side in sides)))
    x, height = np.concatenate(tried), np.concatenate(heights)
    best = int(np.argmax(height))
    return float(x[best]), float(height[best])


def _parabola(places: Array, values: Array, x: Array) -> Array:
    """Parabola through three points, at places (m)."""
    a, b, c = places
    slope, other = (values[1] - values[0]) / (b - a), (values[2] - values[1]) / (c - b)
    return np.asarray(values[0] + (x - a) * (slope + (x - b) * (other - slope) / (c - a)))


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
