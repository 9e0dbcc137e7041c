"""Flash temperature: rise of the greatest temperature of a line contact over that of the teeth, after Blok.

The heat of friction is spread over the contact as the Hertz pressure is. It moves over each flank at the velocity of
that flank relative to the contact line, and divides so that both flanks have one greatest temperature (H. Blok,
Theoretical study of temperature rise at surfaces of actual contact under oiliness lubricating conditions, Proceedings
of the General Discussion on Lubrication, Institution of Mechanical Engineers, vol. 2, 1937, 222-235).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...core.checks import array, instances, two
from .greatest_temperature import BLOK_FACTOR, greatest_temperature
from .thermal_material import ThermalMaterial

Array = NDArray[Any]
STEEL_PAIR = (ThermalMaterial(), ThermalMaterial())


def peclet_number(velocity: ArrayLike, half_width: ArrayLike, material: ThermalMaterial) -> Array:
    """Velocity times half width over twice the diffusivity (...).

    Parameters
    ----------
    velocity
        Of the flank relative to the contact line, across it [m/s] (...).
    half_width
        Of the band of contact [m] (...).
    material
        Of the flank.

    Examples
    --------
    >>> print(f"{float(peclet_number(2.0, 0.3e-3, ThermalMaterial())):.1f}")
    23.5
    """
    return np.asarray(np.abs(velocity) * np.asarray(half_width) / (2.0 * material.diffusivity))


def rise_per_heat(
    half_width: ArrayLike,
    velocities: tuple[ArrayLike, ArrayLike],
    materials: tuple[ThermalMaterial, ThermalMaterial] = STEEL_PAIR,
) -> tuple[Array, Array]:
    """Greatest temperature [K] of pinion and gear (...), each with a watt a metre of contact all to itself.

    Parameters
    ----------
    half_width
        Of the band of contact [m] (...).
    velocities
        Of pinion and gear relative to the contact line, across it [m/s] (...).
    materials
        Of pinion and gear.

    Examples
    --------
    >>> pinion, gear = rise_per_heat(0.3e-3, (4.0, 1.0))
    >>> print(f"{gear / pinion:.3f}")
    1.999
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
