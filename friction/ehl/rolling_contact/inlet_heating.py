"""Heat of the inlet: the film thins where lubricant is sheared before the contact, by factors with a name."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

from ....core.errors import InputError
from ...rolling_traction import THERMAL_FACTORS
from .lubricated_contact import LineContact

#: Those of the factors that were made for the film thickness.
FACTORS = ("gupta_cheng", "murch_wilson")
#: Power of the viscosity in the smallest film (Pan and Hamrock).
_POWER = 0.694


def film_factor(contact: LineContact, factor: str = "gupta_cheng") -> float:
    """Film thickness with a heated inlet over that without, by a published formula.

    Parameters
    ----------
    contact : LineContact
        Its oil needs `temperature_viscosity` and `conductivity`.
    factor : {"gupta_cheng", "murch_wilson"}
        Gupta, Cheng, Zhu, Forster and Schrand, ASME Journal of Tribology 114 (1992) 55, with sliding; Murch and Wilson,
        ASME Journal of Lubrication Technology 97 (1975) 212, in pure rolling.

    Raises
    ------
    InputError
        There is no such factor, a property is missing, or the conditions are beyond the formula.
    """
    oil = contact.oil
    if factor not in FACTORS:
        raise InputError(f"factor = {factor!r}: must be one of {', '.join(FACTORS)}")
    if oil.temperature_viscosity is None or oil.conductivity is None:
        raise InputError("the heat of the inlet needs the oil's temperature_viscosity and conductivity")
    groups: Any = SimpleNamespace(
        thermal_parameter=oil.temperature_viscosity * oil.viscosity * contact.rolling_velocity**2 / oil.conductivity,
        pressure_parameter=contact.hertz_pressure / contact.reduced_modulus,
        slide_to_roll=abs(contact.slide_to_roll),
    )
    value = float(THERMAL_FACTORS[factor](groups))
    if not 0.0 < value <= 1.0:
        raise InputError(f"the {factor} factor is {value:g} here: these conditions are beyond it")
    return value


def heated_inlet(contact: LineContact, factor: str = "gupta_cheng") -> LineContact:
    """Return the contact with the inlet's viscosity lowered so that the film thins by `film_factor`.

    The viscosity in the shear of the film stays: its own heat is the `thermal` correction of `shear.traction`.
    """
    return replace(contact, inlet_viscosity=film_factor(contact, factor) ** (1.0 / _POWER))
