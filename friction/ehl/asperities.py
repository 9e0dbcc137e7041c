"""Asperities of rough surfaces by their statistics: they share the load with the film, in a steady state.

The lubricant flows through the mean gap and asperities press against each other the harder the narrower it is (Johnson,
Greenwood and Poon, Wear 19 (1972) 91). Roughness is isotropic here: the lubricant finds its way around the asperities,
while the transverse ridges of ``rough_passage`` must ride on it. No roughness moves, so that one steady solve stands
for a passage.

The asperities are those of Greenwood and Williamson: spherical summits, elastic, with the density, the curvature and
the heights that a Gaussian isotropic surface with the autocorrelation exp(-(r/l)^2) has (Nayak, Journal of Lubrication
Technology 93 (1971) 398; McCool, Wear 107 (1986) 37). Its spectral moments are m0 = s^2, m2 = 2 s^2 / l^2 and
m4 = 12 s^2 / l^4, so that rms height s and correlation length l of the two surfaces together say everything.

Roughness that does move is a profile: measured or generated heights, waves, or a single asperity. A profile is any
function from the position on the surface [m] to its height there [m], outward positive. Those here have no jumps, so
that they can move through the contact by any fraction of a grid spacing.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicHermiteSpline, CubicSpline
from scipy.special import gamma, ndtr, pbdv

from ...core import checks
from ...core.arrays import RealArray as Array, record
from ...core.errors import InputError

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

    composite_roughness: float = field(metadata=checks.bounded("m", above=0.0))
    correlation_length: float = field(metadata=checks.bounded("m", above=0.0))

    def __post_init__(self) -> None:
        checks.check_fields(self)
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


Profile = Callable[[Array], Array]

#: Points in a correlation length of a generated profile.
POINTS_PER_LENGTH = 12
#: A trace whose heights are smaller than this, over its largest number, is flat: what is left of it is rounding.
FLATNESS_TOLERANCE = 1e-12


@record(frozen=True, eq=False)
class RoughProfile:
    """A profile that repeats itself, given by heights at equal distances with a cubic spline in between.

    Parameters
    ----------
    heights
        Of the points (n) [m], with mean zero; the point after the last is the first again.
    spacing
        Distance of neighbouring points [m].

    Raises
    ------
    InputError
        If there are fewer than three heights, one is not finite, or the spacing is not positive.

    Examples
    --------
    >>> profile = RoughProfile(1e-6 * np.array([0.0, 1.0, 0.0, -1.0]), spacing=1e-5)
    >>> print(f"{1e6 * profile.rms:.3f} um rms over {1e6 * profile.length:.0f} um")
    0.707 um rms over 40 um
    """

    heights: Array
    spacing: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "heights", checks.array("heights", self.heights, "m", ndim=1, fewest=3))
        checks.positive("spacing", self.spacing, "m")

    @property
    def rms(self) -> float:
        """Root of the mean square of the heights [m]."""
        return float(np.sqrt(np.mean(self.heights**2)))

    @property
    def length(self) -> float:
        """Period [m]."""
        return self.heights.size * self.spacing

    @cached_property
    def _spline(self) -> CubicSpline:
        position = self.spacing * np.arange(self.heights.size + 1)
        return CubicSpline(position, np.append(self.heights, self.heights[0]), bc_type="periodic")

    def __call__(self, position: Array) -> Array:
        """Heights [m] at positions [m]."""
        return np.asarray(self._spline(np.mod(position, self.length)))

    def scaled(self, rms: float) -> RoughProfile:
        """Return the same profile with another rms height [m]; the dissertation varies a measured one in this way.

        Raises
        ------
        InputError
            If the rms height is negative, or positive while the profile is flat.
        """
        checks.positive("rms", rms, "m", zero=True)
        if rms == 0.0:
            return RoughProfile(np.zeros_like(self.heights), self.spacing)
        if self.rms == 0.0:
            raise InputError(f"rms = {rms:g}: must be 0 [m] for a flat profile, which has no heights to scale")
        return RoughProfile(self.heights * (rms / self.rms), self.spacing)


def generated_profile(rms: float, correlation_length: float, length: float, seed: int) -> RoughProfile:
    """Gaussian profile with the autocorrelation exp(-(x / correlation length)^2).

    Parameters
    ----------
    rms
        Root mean square height [m], met exactly.
    correlation_length
        Distance at which the autocorrelation has fallen to 1/e [m].
    length
        Period [m].
    seed
        The same seed gives the same profile.

    Raises
    ------
    InputError
        If a length is not positive, the period is shorter than ten correlation lengths, or the seed no whole number.

    Notes
    -----
    Sum of waves of the period's fundamental and its multiples, with the amplitudes of the spectral density,
    exp(-(k l)^2 / 8) for the wave number k and correlation length l, and random phases. The shortest wave kept is
    l / 6, whose amplitude is nil.

    Examples
    --------
    >>> print(f"{1e6 * generated_profile(0.3e-6, 20e-6, 1e-3, seed=1).rms:.3f} um")
    0.300 um
    """
    for name, value in (("rms", rms), ("correlation_length", correlation_length), ("length", length)):
        checks.positive(name, value, "m")
    checks.whole("seed", seed, 0)
    if length < 10.0 * correlation_length:
        raise InputError(
            f"length = {length:g}: must be ten correlation lengths, {10 * correlation_length:g} m, or more"
        )
    points = math.ceil(POINTS_PER_LENGTH * length / correlation_length)
    wave_number = 2.0 * math.pi * np.fft.rfftfreq(points, length / points)
    phase = 2.0 * math.pi * np.random.default_rng(seed).random(wave_number.size)
    spectrum = np.exp(-((wave_number * correlation_length) ** 2) / 8.0 + 1j * phase)
    spectrum[0] = 0.0
    heights = np.fft.irfft(spectrum, points)
    return RoughProfile(heights * (rms / np.sqrt(np.mean(heights**2))), length / points)


def measured_profile(heights: ArrayLike, spacing: float, *, detrend: bool = True) -> RoughProfile:
    """Profile from a measured trace.

    Parameters
    ----------
    heights
        Heights at equal distances (n) [m], at least 16.
    spacing
        Their distance [m].
    detrend
        Take out the straight line through them; their mean is taken out in any case.

    Returns
    -------
    RoughProfile
        The trace and its mirror image, one after the other, so that it repeats without a jump. Its heights are exactly
        zero if nothing but rounding is left of them.

    Raises
    ------
    InputError
        If there are too few heights, one is not finite, or the spacing is not positive.

    Examples
    --------
    >>> trace = 1e-6 * np.sin(np.arange(40.0)) + 0.1e-6 * np.arange(40.0)
    >>> print(f"{1e6 * measured_profile(trace, spacing=1e-6).rms:.2f} um")
    0.70 um
    """
    trace = checks.array("heights", heights, "m", ndim=1, fewest=16)
    checks.positive("spacing", spacing, "m")
    checks.truth("detrend", detrend)
    largest = np.abs(trace).max()
    if detrend:
        index = np.arange(trace.size)
        trace = trace - np.polyval(np.polyfit(index, trace, 1), index)
    trace = np.concatenate([trace, trace[-2:0:-1]])
    trace = trace - trace.mean()
    return RoughProfile(trace if np.abs(trace).max() > FLATNESS_TOLERANCE * largest else np.zeros_like(trace), spacing)


def wave(amplitude: float, wavelength: float) -> Profile:
    """Return a sinusoidal profile: amplitude and wavelength [m].

    Raises
    ------
    InputError
        If the amplitude is not finite, or the wavelength not positive.

    Examples
    --------
    >>> (1e6 * wave(0.1e-6, 1e-4)(np.array([0.0, 0.5e-4]))).round(3)
    array([ 0.1, -0.1])
    """
    checks.number("amplitude", amplitude, "m")
    checks.positive("wavelength", wavelength, "m")
    return lambda position: amplitude * np.cos(2.0 * math.pi * position / wavelength)


def asperity(height: float, width: float, point: float) -> Profile:
    """Return a single hump height ``cos^2(pi s / width)``, ``|s| < width / 2``, around a point of the surface; all [m].

    Raises
    ------
    InputError
        If a number is not finite, or the width not positive.

    Examples
    --------
    >>> (1e6 * asperity(0.5e-6, 4e-5, 1e-4)(np.array([0.0, 1e-4]))).round(3)
    array([0. , 0.5])
    """
    checks.number("height", height, "m")
    checks.positive("width", width, "m")
    checks.number("point", point, "m")

    def profile(position: Array) -> Array:
        s = (position - point) / width
        return np.where(np.abs(s) < 0.5, height * np.cos(math.pi * s) ** 2, 0.0)

    return profile


def smooth(position: Array) -> Array:
    """The profile without heights."""
    return np.zeros_like(position)
