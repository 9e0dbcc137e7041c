"""Greatest temperature under a moving band of elliptic heat, at any Peclet number, quickly."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray
from scipy.special import ellipe

from .band_source import band_temperature

Array = NDArray[Any]
#: Parameter m at which K(m) = 2 E(m): there the fast elliptic band is hottest, at 2 m - 1 = 0.652 of the half width.
HOTTEST_PARAMETER = 0.8261147659849827
#: Greatest temperature of the fast band times the root of the Peclet number, 8 E(m)/(3 pi^1.5).
FAST_LIMIT = float(8.0 * ellipe(HOTTEST_PARAMETER) / (3.0 * np.pi**1.5))
#: Blok's factor, of heat over the root of the whole width: 1.11 as he gave it.
BLOK_FACTOR = 2.0 * FAST_LIMIT
PECLET_MINIMUM = 1e-12  # nothing moves: the temperature grows without bound, but as slowly as a logarithm
SLOW, FAST = 1e-4, 1e3  # beyond which the limits hold within 1e-7
POSITIONS = (-0.05, 0.75)  # between which the greatest temperature is: from the middle to where the fast band has it
POSITION_COUNT, PECLET_COUNT = 28, 64
BISECTIONS = 40


def _nodes(count: int) -> Array:
    return np.cos(np.pi * (np.arange(count) + 0.5) / count)


def searched_greatest(peclet: Array) -> Array:
    """Greatest temperature (n) over the band, from its quadrature at many positions.

    Parameters
    ----------
    peclet
        Peclet numbers (n).

    Examples
    --------
    >>> bool(abs(searched_greatest(np.array([1e3])) * np.sqrt(1e3) / FAST_LIMIT - 1.0) < 1e-6)
    True
    """
    nodes, (low, high) = _nodes(POSITION_COUNT), POSITIONS
    found = band_temperature(low + 0.5 * (high - low) * (nodes + 1.0), peclet[:, None])
    series = chebyshev.chebfit(nodes, found.T, POSITION_COUNT - 1)
    slope = chebyshev.chebder(series)
    left, right = -np.ones(peclet.size), np.ones(peclet.size)
    for _ in range(BISECTIONS):
        middle = 0.5 * (left + right)
        rising = chebyshev.chebval(middle, slope, tensor=False) > 0.0
        left, right = np.where(rising, middle, left), np.where(rising, right, middle)
    return np.asarray(chebyshev.chebval(left, series, tensor=False))


@cache
def _logarithms() -> Array:
    """Chebyshev series of the logarithm of the greatest temperature in that of the Peclet number."""
    nodes = _nodes(PECLET_COUNT)
    peclet = SLOW * (FAST / SLOW) ** (0.5 * (nodes + 1.0))
    return np.asarray(chebyshev.chebfit(nodes, np.log(searched_greatest(peclet)), PECLET_COUNT - 1))


def greatest_temperature(peclet: Array) -> Array:
    """Greatest temperature times conductivity over heat per length (...), within 1e-7.

    Parameters
    ----------
    peclet
        Velocity times half width over twice the diffusivity (...); below 1e-12 it counts as that.

    Examples
    --------
    >>> greatest_temperature(np.array([0.1, 1.0, 10.0, 100.0])).round(4)
    array([1.1571, 0.5231, 0.1756, 0.0556])
    """
    number = np.maximum(np.asarray(peclet, float), PECLET_MINIMUM)
    within = np.clip(np.log(number / SLOW) / np.log(FAST / SLOW), 0.0, 1.0)
    found = np.exp(chebyshev.chebval(2.0 * within - 1.0, _logarithms()))
    found = np.where(number > FAST, FAST_LIMIT / np.sqrt(number), found)
    slow = (np.log(4.0 / number) - np.euler_gamma + 0.5) / np.pi
    return np.asarray(np.where(number < SLOW, slow, found))
