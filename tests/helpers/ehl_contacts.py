"""Lubricated line contacts by their numbers or by the groups of Moes."""

from __future__ import annotations

import math

from easeoff.friction.ehl import LubricatedContact, Oil

MODULUS = 2.273e11
NEWTONIAN = math.inf


def contact(
    pressure: float,
    radius: float,
    velocity: float,
    viscosity: float,
    coefficient: float,
    *,
    slide: float = 0.0,
    eyring: float = NEWTONIAN,
    modulus: float = MODULUS,
    compressible: bool = True,
) -> LubricatedContact:
    oil = Oil(viscosity, coefficient, eyring_stress=eyring, compressible=compressible)
    return LubricatedContact(pressure, radius, velocity, oil, slide, modulus)


def by_moes(load: float, viscous: float, *, compressible: bool = False) -> LubricatedContact:
    """A contact with given groups M and L; isoviscous for L = 0."""
    modulus, radius, viscosity, coefficient = 2.2e11, 0.01, 0.04109, 2e-8
    speed = 0.5 * (viscous / (coefficient * modulus)) ** 4 if viscous else 1e-11
    pressure = modulus * math.sqrt(load * math.sqrt(2.0 * speed) / (2.0 * math.pi))
    return contact(
        pressure,
        radius,
        speed * modulus * radius / viscosity,
        viscosity,
        coefficient if viscous else 0.0,
        modulus=modulus,
        compressible=compressible,
    )
