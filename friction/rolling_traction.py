"""Rolling traction of a line contact, and the thermal factors by which heat of the inlet lowers it.

>>> from easeoff.friction import THERMAL_FACTORS
>>> list(THERMAL_FACTORS)
['goksem_hargreaves', 'murch_wilson', 'gupta_cheng', 'none']
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.checks import one_of
from .conditions import ContactConditions, DimensionlessGroups

Array = NDArray[Any]


def isothermal_traction(conditions: ContactConditions) -> Array:
    """Rolling traction without heating of the inlet [N/m of contact length] (...).

    Goksem and Hargreaves, ASME Journal of Lubrication Technology 100, 1978, doi 10.1115/1.3453183; Kolivand 2009, Eq.
    5.10: 4.318 (G U)^0.658 W^0.0126 R / alpha.
    """
    c = conditions
    scale = 4.318 * c.equivalent_radius / c.pressure_viscosity
    return np.asarray(scale * (c.material_parameter * c.speed_parameter) ** 0.658 * c.load_parameter**0.0126)


def goksem_hargreaves(conditions: DimensionlessGroups) -> Array:
    """Thermal factor that goes with the traction's own formula (...), in its isothermal part Eq. 5.10."""
    c = conditions
    thermal = c.thermal_parameter
    group = 11.81221 * c.material_parameter * c.speed_parameter / c.load_parameter**1.5
    return np.asarray(group ** (0.0106383 * thermal**0.31746) / (1.0 + 0.411483 * thermal**0.707071))


def murch_wilson(conditions: DimensionlessGroups) -> Array:
    """Thermal factor (...) of Murch and Wilson, Journal of Lubrication Technology 97, 1975, doi 10.1115/1.3452559."""
    return np.asarray(3.94 / (3.94 + conditions.thermal_parameter**0.62))


def gupta_cheng(conditions: DimensionlessGroups) -> Array:
    """Thermal factor with sliding (...).

    Gupta, Cheng and others, Tribology Transactions 35, 1992, doi 10.1080/10402009208982117, as quoted by Arana,
    Larranaga and Ulacia 2019, Eq. 24, doi 10.1177/1350650118778655. Zero where the formula, far beyond its range of
    pressure and speed, would be negative.
    """
    c = conditions
    thermal = c.thermal_parameter
    cooling = 1.0 - 13.2 * c.pressure_parameter * thermal**0.42
    return np.asarray(np.maximum(cooling, 0.0) / (1.0 + 0.213 * (1.0 + 2.23 * c.slide_to_roll**0.83) * thermal**0.64))


def no_heating(conditions: DimensionlessGroups) -> Array:
    """No thermal factor: one."""
    return np.ones(())


THERMAL_FACTORS: Mapping[str, Callable[[DimensionlessGroups], Array]] = {
    "goksem_hargreaves": goksem_hargreaves,
    "murch_wilson": murch_wilson,
    "gupta_cheng": gupta_cheng,
    "none": no_heating,
}


def rolling_traction(conditions: ContactConditions, thermal_factor: str = "goksem_hargreaves") -> Array:
    """Rolling traction [N/m of contact length] (...). Times rolling velocity and length it is the rolling power loss.

    Parameters
    ----------
    conditions
        Operating conditions of the contacts.
    thermal_factor
        Name of the factor for the inlet's heating, see ``THERMAL_FACTORS``.

    Raises
    ------
    InputError
        If there is no factor of that name.

    Examples
    --------
    >>> from easeoff.friction import contact_conditions
    >>> contact = contact_conditions(hertz_pressure=0.7e9, equivalent_radius=0.042, rolling_velocity=2.2,
    ...                              slide_to_roll=0.45, roughness=0.8e-6)
    >>> print(f"{rolling_traction(contact):.1f} N/m")
    68.3 N/m
    """
    factor = THERMAL_FACTORS[one_of("thermal_factor", thermal_factor, THERMAL_FACTORS)]
    return np.asarray(isothermal_traction(conditions) * factor(conditions))
