"""Asperities of rough surfaces by their statistics: they share the load with the film, in a steady state.

The lubricant flows through the mean gap and asperities press against each other the harder the narrower it is (Johnson,
Greenwood and Poon, Wear 19 (1972) 91). Roughness is isotropic here: the lubricant finds its way around the asperities,
while the transverse ridges of ``rough_passage`` must ride on it. No roughness moves, so that one steady solve stands
for a passage.

The asperities are those of Greenwood and Williamson: spherical summits, elastic, with the density, the curvature and
the heights that a Gaussian isotropic surface with the autocorrelation exp(-(r/l)^2) has (Nayak, Journal of Lubrication
Technology 93 (1971) 398; McCool, Wear 107 (1986) 37). Its spectral moments are m0 = s^2, m2 = 2 s^2 / l^2 and
m4 = 12 s^2 / l^4, so that rms height s and correlation length l of the two surfaces together say everything.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline
from scipy.special import gamma, ndtr, pbdv

from ....core import checks
from ....core.errors import InputError

Array = NDArray[np.float64]

#: m0 m4 / m2^2 of the autocorrelation exp(-(r/l)^2).
BANDWIDTH = 3.0
#: Mean height of the summits over the mean plane, and rms of their heights, both over the rms height.
SUMMIT_HEIGHT = 4.0 / math.sqrt(math.pi * BANDWIDTH)
SUMMIT_SPREAD = math.sqrt(1.0 - 0.8968 / BANDWIDTH)
#: Density of the summits times l^2, and their mean curvature times l^2 / s.
SUMMIT_DENSITY, SUMMIT_CURVATURE = 1.0 / (math.pi * math.sqrt(3.0)), 8.0 / 3.0 * math.sqrt(12.0 / math.pi)
#: Beyond as many spreads of the summits nothing touches.
LEVEL_LIMIT = 12.0


@dataclass(frozen=True)
class Asperities:
    """Asperities of both surfaces together, by their statistics.

    Parameters
    ----------
    composite_roughness
        Root of the sum of the squares of both rms heights [m].
    correlation_length
        Distance at which the autocorrelation has fallen to 1/e [m].

    Raises
    ------
    InputError
        If a number is not positive, or the surface is steeper than Hertz contacts of summits allow.

    Examples
    --------
    >>> pressure, _ = Asperities(0.42e-6, 20e-6).pressure(np.array([0.0, 0.4e-6, 1.2e-6]), 2.27e11)
    >>> (1e-6 * pressure).round(1)  # MPa
    array([444.8, 146.6,   1.9])
    """

    composite_roughness: float
    correlation_length: float

    def __post_init__(self) -> None:
        for name in ("composite_roughness", "correlation_length"):
            checks.positive(name, getattr(self, name), "m")
        if self.composite_roughness > 0.5 * self.correlation_length:
            raise InputError(
                f"composite_roughness = {self.composite_roughness:g}: must be up to half of the correlation_length, "
                f"{0.5 * self.correlation_length:g} m"
            )

    def pressure(self, separation: Array, contact_modulus: float) -> tuple[Array, Array]:
        """Mean pressure between the asperities [Pa], and its derivative by the separation [Pa/m].

        Parameters
        ----------
        separation
            Of the mean planes (n) [m]; negative where they would lie within one another.
        contact_modulus
            E' [Pa].
        """
        spread = SUMMIT_SPREAD * self.composite_roughness
        level = (separation - SUMMIT_HEIGHT * self.composite_roughness) / spread
        steepness = self.composite_roughness / self.correlation_length
        unit = (2.0 / 3.0) * contact_modulus * SUMMIT_DENSITY * SUMMIT_CURVATURE**-0.5 * SUMMIT_SPREAD**1.5 * steepness
        load, slope = _summit_load(level)
        return unit * load, unit / spread * slope

    def mean_gap(self, separation: Array) -> tuple[Array, Array]:
        """Mean of the gap [m] between surfaces that do not overlap, and its derivative by the separation [1]."""
        t = separation / self.composite_roughness
        bell = np.exp(-0.5 * t**2) / math.sqrt(2.0 * math.pi)
        part = ndtr(t)
        # For a deeply negative t both parts cancel: the gap goes on as bell / t^2.
        gap = np.where(t > -5.0, t * part + bell, bell / np.maximum(t**2, 1.0))
        return self.composite_roughness * np.maximum(gap, 1e-12), part


def mean_power(power: float, level: Array) -> Array:
    """Mean of max(s - level, 0)^power over normally distributed s: a parabolic cylinder function."""
    scale = gamma(power + 1.0) / math.sqrt(2.0 * math.pi)
    return np.asarray(scale * np.exp(-0.25 * level**2) * pbdv(-power - 1.0, level)[0])


@cache
def _tabulated() -> CubicHermiteSpline:
    """``mean_power`` of 3/2 within ``LEVEL_LIMIT``, good to 1e-9 of its value at 0: what Hertz contacts ask for."""
    level = np.linspace(-LEVEL_LIMIT, LEVEL_LIMIT, 2401)
    return CubicHermiteSpline(level, mean_power(1.5, level), -1.5 * mean_power(0.5, level))


def _summit_load(level: Array) -> tuple[Array, Array]:
    """``mean_power`` of 3/2, and its derivative."""
    inside = np.clip(level, -LEVEL_LIMIT, LEVEL_LIMIT)
    load, slope = _tabulated()(inside), _tabulated()(inside, 1)
    # Beyond, in a straight line: such separations occur only on the way to a solution.
    load = load + slope * (level - inside)
    return np.where(level > LEVEL_LIMIT, 0.0, load), np.where(level > LEVEL_LIMIT, 0.0, slope)
