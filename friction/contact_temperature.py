"""Temperature of the contact: flash temperature, moving bands of heat, and how the heat divides.

The flash temperature is the rise of the greatest temperature of a line contact over that of the teeth, after Blok. The
heat of friction is spread over the contact as the Hertz pressure is. It moves over each flank at the velocity of that
flank relative to the contact line, and divides so that both flanks have one greatest temperature (H. Blok, Theoretical
study of temperature rise at surfaces of actual contact under oiliness lubricating conditions, Proceedings of the
General Discussion on Lubrication, Institution of Mechanical Engineers, vol. 2, 1937, 222-235).

The surface temperature is that under a band of heat that moves over a half space (J. C. Jaeger, Moving sources of heat
and the temperature at sliding contacts, Journal and Proceedings of the Royal Society of New South Wales 76, 1942,
203-224). In the frame of the band the material runs towards positive x. With the half width b, the distribution w of
the heat over xi = x/b (its integral is one) and the Peclet number L = u b/(2 a), a the diffusivity,

    T k/Q = 1/pi integral w(s) exp(L (xi - s)) K0(L |xi - s|) ds

where Q is the heat per length of the band and k the conductivity. All temperatures here are T k/Q.

Blok's partition matches the greatest temperatures alone. For one temperature of both flanks at every point a linear
system divides the heat: the band is cut into strips of uniform heat, each with the temperature of a moving uniform band
in closed form, and the heat of every strip divides so that both flanks are equally warm in its middle.
"""

from __future__ import annotations

from functools import cache
from typing import Any, Literal

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike
from scipy.special import ellipe, k0e, kve

from ..core.arrays import Array, record
from ..core.checks import array, instances, positive, two, whole
from .operation import ThermalMaterial

Distribution = Literal["elliptic", "uniform"]
STEP, REACH = 0.05, 3.6  # of the double exponential rule


def _rule() -> tuple[Array, Array, Array]:
    """Nodes in (0, 1), their distances from one, and weights of the double exponential rule.

    Both the logarithm at one end and the root at the other cost it nothing.
    """
    steps = np.arange(-REACH, REACH + 0.5 * STEP, STEP)
    exponent = np.pi * np.sinh(steps)
    node, rest = 1.0 / (1.0 + np.exp(-exponent)), 1.0 / (1.0 + np.exp(exponent))
    return node, rest, STEP * np.pi * np.cosh(steps) * node * rest


def band_temperature(position: Array, peclet: Array, distribution: Distribution = "elliptic") -> Array:
    """Temperature (...) within a moving band, by quadrature: within 2e-9 up to a Peclet number of 1e6.

    Positions over the half width run from -1, where the material enters, to 1; the Peclet number is velocity times half
    width over twice the diffusivity.
    """
    node, rest, weight = _rule()
    xi, number = (np.asarray(each, float)[..., None] for each in (position, peclet))
    total = np.zeros(())
    for side in (1.0, -1.0):  # heat that entered the material before, and heat that comes
        reach = 1.0 + side * xi
        distance = reach * node
        elliptic = distribution == "elliptic"
        heat = 2.0 / np.pi * np.sqrt(reach * rest * (1.0 - side * xi + distance)) if elliptic else 0.5
        kernel = k0e(number * distance) * (1.0 if side > 0.0 else np.exp(-2.0 * number * distance))
        total = total + np.sum(heat * kernel * weight * reach, axis=-1)
    return np.asarray(total / np.pi)


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
    """Greatest temperature (n) over the band, from its quadrature at many positions."""
    nodes, (low, high) = _nodes(POSITION_COUNT), POSITIONS
    temperatures = band_temperature(low + 0.5 * (high - low) * (nodes + 1.0), peclet[:, None])
    series = chebyshev.chebfit(nodes, temperatures.T, POSITION_COUNT - 1)
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
    """Greatest temperature times conductivity over heat per length (...), within 1e-7; Peclet number from 1e-12."""
    number = np.maximum(np.asarray(peclet, float), PECLET_MINIMUM)
    within = np.clip(np.log(number / SLOW) / np.log(FAST / SLOW), 0.0, 1.0)
    temperature = np.exp(chebyshev.chebval(2.0 * within - 1.0, _logarithms()))
    temperature = np.where(number > FAST, FAST_LIMIT / np.sqrt(number), temperature)
    slow = (np.log(4.0 / number) - np.euler_gamma + 0.5) / np.pi
    return np.asarray(np.where(number < SLOW, slow, temperature))


STEEL_PAIR = (ThermalMaterial(), ThermalMaterial())


def peclet_number(velocity: ArrayLike, half_width: ArrayLike, material: ThermalMaterial) -> Array:
    """Peclet number (...): velocity [m/s] across the contact line times half width [m] over twice the diffusivity."""
    return np.asarray(np.abs(velocity) * np.asarray(half_width) / (2.0 * material.diffusivity))


def rise_per_heat(
    half_width: ArrayLike,
    velocities: tuple[ArrayLike, ArrayLike],
    materials: tuple[ThermalMaterial, ThermalMaterial] = STEEL_PAIR,
) -> tuple[Array, Array]:
    """Greatest temperature [K] of pinion and gear (...), each with a watt a metre of contact all to itself.

    From the half width [m] and the flanks' velocities relative to the contact line, across it [m/s].
    """
    width, speeds, bodies = _checked(half_width, velocities, materials)
    pinion, gear = (
        greatest_temperature(peclet_number(velocity, width, material)) / material.conductivity
        for velocity, material in zip(speeds, bodies, strict=True)
    )
    return pinion, gear


def _checked(half_width: ArrayLike, velocities: Any, materials: Any) -> tuple[Array, list[Array], tuple[Any, ...]]:
    """Arguments of ``rise_per_heat`` as arrays; NaN is a value, as of mesh positions without a solution."""
    speeds = [array("velocities", one, "m/s", anything=True) for one in two("velocities", velocities, "velocities")]
    width = array("half_width", half_width, "m", anything=True)
    return width, speeds, instances("materials", materials, ThermalMaterial, 2)


def flash_temperature(
    heat: ArrayLike,
    half_width: ArrayLike,
    velocities: tuple[ArrayLike, ArrayLike],
    materials: tuple[ThermalMaterial, ThermalMaterial] = STEEL_PAIR,
) -> Array:
    """Flash temperature of line contacts [K] (...), at any velocity.

    Parameters
    ----------
    heat
        Of friction, per length of contact: coefficient times line load times sliding velocity [W/m] (...).
    half_width, velocities, materials
        As for ``rise_per_heat``.

    Examples
    --------
    A line load of 400 N/mm, friction 0.06, pinion 4 m/s and gear 2.5 m/s:

    >>> from easeoff.friction import flash_temperature
    >>> print(f"{float(flash_temperature(0.06 * 400e3 * 1.5, 0.3e-3, (4.0, 2.5))):.1f} K")
    35.4 K
    """
    pinion, gear = rise_per_heat(half_width, velocities, materials)
    return np.asarray(array("heat", heat, "W/m", anything=True) * (pinion * gear / (pinion + gear)))


def blok_flash_temperature(
    heat: ArrayLike,
    half_width: ArrayLike,
    velocities: tuple[ArrayLike, ArrayLike],
    materials: tuple[ThermalMaterial, ThermalMaterial] = STEEL_PAIR,
) -> Array:
    """Flash temperature by Blok's formula for fast flanks [K] (...): 1.11 Q/[(B1 sqrt(u1) + B2 sqrt(u2)) sqrt(2 b)].

    It is the limit of ``flash_temperature`` for large Peclet numbers and above it otherwise: by 0.1 % where both are
    10, by 6 % where they are 1.

    Parameters
    ----------
    heat, half_width, velocities, materials
        As for ``flash_temperature``.

    Examples
    --------
    >>> print(f"{float(blok_flash_temperature(0.06 * 400e3 * 1.5, 0.3e-3, (4.0, 2.5))):.1f} K")
    35.4 K
    """
    width, speeds, bodies = _checked(half_width, velocities, materials)
    carried: Any = sum(
        material.thermal_contact_coefficient * np.sqrt(np.abs(velocity))
        for velocity, material in zip(speeds, bodies, strict=True)
    )
    return np.asarray(BLOK_FACTOR * array("heat", heat, "W/m", anything=True) / (carried * np.sqrt(2.0 * width)))


STRIP_LIMIT = 10_000


@record(frozen=True)
class MatchedBand:
    """Temperature across a contact whose flanks are equally warm.

    Parameters
    ----------
    position
        Over the half width (n), in the direction of positive velocities.
    temperature
        Rise over the teeth [K] (n).
    pinion_share
        Part of the whole heat that goes into the pinion.

    Examples
    --------
    >>> band = matched_band(36e3, 0.3e-3, (4.0, 2.5))
    >>> print(f"{band.temperature.max():.1f} K, {100 * band.pinion_share:.0f} % into the pinion")
    35.4 K, 56 % into the pinion
    """

    position: Array
    temperature: Array
    pinion_share: float


def _kernel_integral(z: Array) -> Array:
    """Integral of exp(t) K0(|t|) up to z, counted so that it is one at zero."""
    size = np.abs(z)
    damped = np.where(z < 0.0, np.exp(2.0 * np.minimum(z, 0.0)), 1.0)
    with np.errstate(invalid="ignore"):
        return np.where(size > 0.0, z * (kve(0, size) + np.sign(z) * kve(1, size)) * damped, 1.0)


def _influence(middles: Array, ends: Array, peclet: float) -> Array:
    """Temperature times conductivity in the middle of strips (n, n) by unit heat flux over half width in each.

    The Peclet number is negative where the material runs towards negative positions.
    """
    primitive = _kernel_integral(peclet * (middles[:, None] - ends[None, :]))
    return np.asarray((primitive[:, :-1] - primitive[:, 1:]) / (np.pi * peclet))


def matched_band(
    heat: float,
    half_width: float,
    velocities: tuple[float, float],
    materials: tuple[ThermalMaterial, ThermalMaterial] = STEEL_PAIR,
    strips: int = 200,
) -> MatchedBand:
    """Temperature across one contact, the same on both flanks at every point.

    Parameters
    ----------
    heat
        Of friction, per length of contact [W/m].
    half_width
        Of the band [m].
    velocities
        Of pinion and gear relative to the contact line, across it [m/s]; with their signs, as opposite ones differ.
    materials
        Of pinion and gear.
    strips
        Number of strips; the error falls with its square.

    Raises
    ------
    InputError
        If a number is not possible.

    Examples
    --------
    >>> from easeoff.friction import flash_temperature, matched_band
    >>> hottest = matched_band(36e3, 0.3e-3, (1.0, 0.3)).temperature.max()
    >>> print(f"{hottest:.1f} K, by equal maxima {float(flash_temperature(36e3, 0.3e-3, (1.0, 0.3))):.1f} K")
    81.7 K, by equal maxima 81.6 K
    """
    positive("heat", heat, "W/m")
    speeds = array("velocities", velocities, "m/s", ndim=1, size=2)
    bodies = instances("materials", materials, ThermalMaterial, 2)
    for velocity in speeds:
        positive("size of a velocity", abs(velocity), "m/s")
    positive("half_width", half_width, "m")
    count = whole("strips", strips, least=4, most=STRIP_LIMIT)
    ends = -np.cos(np.pi * np.arange(count + 1) / count)
    middles = 0.5 * (ends[1:] + ends[:-1])
    below = 2.0 / np.pi * 0.5 * (ends * np.sqrt(1.0 - ends**2) + np.arcsin(ends))
    flux = np.diff(below) / np.diff(ends)  # mean of the elliptic heat over each strip, of a whole of one
    first, second = (
        _influence(middles, ends, float(np.sign(v) * peclet_number(v, half_width, material))) / material.conductivity
        for v, material in zip(speeds, bodies, strict=True)
    )
    into_pinion = np.linalg.solve(first + second, second @ flux)
    return MatchedBand(middles, heat * (first @ into_pinion), float(into_pinion @ np.diff(ends)))
