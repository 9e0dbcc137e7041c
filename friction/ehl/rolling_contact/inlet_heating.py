"""Heat of the inlet: the film thins where lubricant is sheared before the contact, by factors with a name."""

from __future__ import annotations

from dataclasses import replace

from ....core.checks import instance, one_of
from ....core.errors import InputError
from ...oil_film.thermal_factors import FILM_FACTORS, THERMAL_FACTORS
from .lubricated_contact import LubricatedContact

#: Power of the viscosity in the smallest film (Pan and Hamrock).
VISCOSITY_EXPONENT = 0.694


def film_factor(contact: LubricatedContact, factor: str = "gupta_cheng") -> float:
    """Film thickness with a heated inlet over that without, by a published formula.

    Parameters
    ----------
    contact
        Its oil needs ``temperature_viscosity`` and ``thermal_conductivity``.
    factor
        Name in ``friction.FILM_FACTORS`` other than ``none``: ``gupta_cheng`` with sliding, ``murch_wilson`` in pure
        rolling.

    Raises
    ------
    InputError
        If there is no such factor, a property is missing, or the conditions are beyond the formula.

    Examples
    --------
    >>> from easeoff.friction.ehl import LubricatedContact, Oil
    >>> oil = Oil(0.05, 1.4e-8, temperature_viscosity=0.04, thermal_conductivity=0.14)
    >>> print(f"{film_factor(LubricatedContact(1e9, 0.02, 10.0, oil)):.3f}")
    0.736
    """
    instance("contact", contact, LubricatedContact)
    groups = replace(contact, slide_to_roll=abs(contact.slide_to_roll))
    value = float(THERMAL_FACTORS[one_of("factor", factor, FILM_FACTORS[1:])](groups))
    if not 0.0 < value <= 1.0:
        raise InputError(f"the {factor} factor is {value:g} here: these conditions are beyond it")
    return value


def heated_inlet(contact: LubricatedContact, factor: str = "gupta_cheng") -> LubricatedContact:
    """Lower the viscosity of the inlet so that the film thins by ``film_factor``.

    The viscosity in the shear of the film stays: its own heat is the ``thermal`` correction of ``traction``.

    Parameters
    ----------
    contact, factor
        As for ``film_factor``.

    Raises
    ------
    InputError
        As ``film_factor``.

    Examples
    --------
    >>> from easeoff.friction.ehl import LubricatedContact, Oil
    >>> oil = Oil(0.05, 1.4e-8, temperature_viscosity=0.04, thermal_conductivity=0.14)
    >>> print(f"{heated_inlet(LubricatedContact(1e9, 0.02, 10.0, oil)).inlet_viscosity:.3f}")
    0.642
    """
    return replace(contact, inlet_viscosity=film_factor(contact, factor) ** (1.0 / VISCOSITY_EXPONENT))
