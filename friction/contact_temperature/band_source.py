"""Surface temperature under a band of heat that moves over a half space (Jaeger 1942).

J. C. Jaeger, Moving sources of heat and the temperature at sliding contacts, Journal and Proceedings of the Royal
Society of New South Wales 76, 1942, 203-224. In the frame of the band the material runs towards positive x. With the
half width b, the distribution w of the heat over xi = x/b (its integral is one) and the Peclet number L = u b/(2 a), a
the diffusivity,

    T k/Q = 1/pi integral w(s) exp(L (xi - s)) K0(L |xi - s|) ds

where Q is the heat per length of the band and k the conductivity. All temperatures here are T k/Q.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import ellipe, ellipk, k0e, kve

Array = NDArray[Any]
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

    Parameters
    ----------
    position
        Over the half width, from -1, where the material enters, to 1 (...).
    peclet
        Velocity times half width over twice the diffusivity (...), positive.
    distribution
        Of the heat: ``elliptic`` as the Hertz pressure, or ``uniform``.

    Examples
    --------
    >>> print(f"{float(band_temperature(np.array(0.65), np.array(10.0))):.4f}")
    0.1755
    """
    node, rest, weight = _rule()
    xi, number = (np.asarray(each, float)[..., None] for each in (position, peclet))
    total = np.zeros(())
    for side in (1.0, -1.0):  # heat that entered the material before, and heat that comes
        reach = 1.0 + side * xi
        distance = reach * node
        if distribution == "elliptic":
            heat = 2.0 / np.pi * np.sqrt(reach * rest * (1.0 - side * xi + distance))
        else:
            heat = np.full(np.shape(distance), 0.5)
        kernel = k0e(number * distance) * (1.0 if side > 0.0 else np.exp(-2.0 * number * distance))
        total = total + np.sum(heat * kernel * weight * reach, axis=-1)
    return np.asarray(total / np.pi)


def uniform_band(position: Array, peclet: Array) -> Array:
    """Temperature (...) within a uniform band at any Peclet number, in closed form.

    From the integral of exp(z) K0(|z|), which is z exp(z) (K0(|z|) + sign(z) K1(|z|)).

    Parameters
    ----------
    position, peclet
        As for ``band_temperature``.

    Examples
    --------
    >>> at = np.array(0.3), np.array(10.0)
    >>> bool(abs(uniform_band(*at) - band_temperature(*at, "uniform")) < 1e-12)
    True
    """
    behind, ahead = peclet * (1.0 + position), peclet * (1.0 - position)
    with np.errstate(invalid="ignore"):
        first, second = (
            np.where(z > 0.0, z * (kve(0, z) + sign * kve(1, z)) * (1.0 if sign > 0 else np.exp(-2.0 * z)), sign)
            for z, sign in ((behind, 1.0), (ahead, -1.0))
        )
    return np.asarray((first + second) / (2.0 * np.pi * peclet))


def fast_band(position: Array, distribution: Distribution = "elliptic") -> Array:
    """Limit of the temperature times the root of the Peclet number, for large ones, in closed form (...).

    Heat flows straight into the material. Elliptic, with m = (1 + xi)/2 and complete elliptic integrals of that
    parameter, 8/(3 pi^1.5) [(2 m - 1) E + (1 - m) K]; uniform, sqrt(m/pi).

    Parameters
    ----------
    position
        As for ``band_temperature``.

    Examples
    --------
    >>> [f"{float(fast_band(np.array(1.0), name)):.4f}" for name in ("uniform", "elliptic")]
    ['0.5642', '0.4789']
    """
    m = 0.5 * (1.0 + np.asarray(position, float))
    if distribution == "uniform":
        return np.sqrt(m / np.pi)
    with np.errstate(invalid="ignore"):
        tail = np.where(m < 1.0, (1.0 - m) * ellipk(m), 0.0)
    return np.asarray(8.0 / (3.0 * np.pi**1.5) * ((2.0 * m - 1.0) * ellipe(m) + tail))


def slow_band(position: Array, peclet: Array, distribution: Distribution = "elliptic") -> Array:
    """Limit of the temperature for small Peclet numbers, in closed form (...).

    Elliptic, [ln(4/L) - gamma + 1/2 - xi^2]/pi; uniform, [ln(2/L) - gamma + 1 - sum of (1 +- xi) ln(1 +- xi)/2]/pi.

    Parameters
    ----------
    position, peclet
        As for ``band_temperature``.

    Examples
    --------
    >>> print(f"{float(slow_band(np.array(0.0), np.array(1e-4))):.4f}")
    3.3484
    """
    xi = np.asarray(position, float)
    if distribution == "elliptic":
        return np.asarray((np.log(4.0 / peclet) - np.euler_gamma + 0.5 - xi**2) / np.pi)
    ends = sum(0.5 * (1.0 + side * xi) * np.log(np.maximum(1.0 + side * xi, 1e-300)) for side in (1.0, -1.0))
    return np.asarray((np.log(2.0 / peclet) - np.euler_gamma + 1.0 - ends) / np.pi)
