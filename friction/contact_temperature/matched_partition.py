"""Both flanks at one temperature at every point of the contact: how the heat divides, from a linear system.

Blok's partition matches the greatest temperatures alone. Here the band is cut into strips of uniform heat, each with
the temperature of a moving uniform band in closed form, and the heat of every strip divides so that both flanks are
equally warm in its middle.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import kve

from ...core.checks import array, frozen_arrays, instances, positive, whole
from .flash_temperature import STEEL_PAIR, peclet_number
from .thermal_material import ThermalMaterial

Array = NDArray[Any]
STRIP_LIMIT = 10_000


@frozen_arrays
@dataclass(frozen=True)
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
    with np.errstate(invalid="ignore"):
        found = (
            z * (kve(0, size) + np.sign(z) * kve(1, size)) * np.where(z < 0.0, np.exp(2.0 * np.minimum(z, 0.0)), 1.0)
        )
    return np.where(size > 0.0, found, 1.0)


def _influence(middles: Array, ends: Array, peclet: float) -> Array:
    """Temperature times conductivity in the middle of strips (n, n) by a unit of heat flux over half width in each.

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
