"""Rolling traction of a line contact."""

from __future__ import annotations

import numpy as np

from ..core.arrays import Array
from ..core.checks import instance, one_of
from .conditions import ContactConditions
from .film_thickness import THERMAL_FACTORS


def isothermal_traction(conditions: ContactConditions) -> Array:
    """Rolling traction without heating of the inlet [N/m of contact length] (...).

    4.318 (G U)^0.658 W^0.0126 R / alpha: Goksem and Hargreaves 1978, doi 10.1115/1.3453183; Kolivand 2009, Eq. 5.10.
    """
    c = conditions
    scale = 4.318 * c.equivalent_radius / c.pressure_viscosity
    return np.asarray(scale * (c.material_parameter * c.speed_parameter) ** 0.658 * c.load_parameter**0.0126)


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
    >>> from easeoff.friction.coefficient import contact_conditions
    >>> contact = contact_conditions(hertz_pressure=0.7e9, equivalent_radius=0.042, rolling_velocity=2.2,
    ...                              slide_to_roll=0.45, roughness=0.8e-6)
    >>> print(f"{rolling_traction(contact):.1f} N/m")
    67.5 N/m
    """
    instance("conditions", conditions, ContactConditions)
    factor = THERMAL_FACTORS[one_of("thermal_factor", thermal_factor, THERMAL_FACTORS)]
    return np.asarray(isothermal_traction(conditions) * factor(conditions))
