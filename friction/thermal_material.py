"""Thermal properties of the teeth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..core.checks import number
from ..core.errors import InputError

#: Of steel: thermal conductivity [W/(m K)], density [kg/m^3], specific heat capacity [J/(kg K)].
CONDUCTIVITY, DENSITY, HEAT_CAPACITY = 46.0, 7850.0, 460.0


CONDUCTIVITY_RANGE, DENSITY_RANGE, HEAT_CAPACITY_RANGE = (0.01, 1e4), (10.0, 1e5), (1.0, 1e5)


@dataclass(frozen=True)
class ThermalMaterial:
    """Thermal properties of a member: conductivity, density and specific heat capacity."""

    conductivity: float = CONDUCTIVITY  # [W/(m K)]
    density: float = DENSITY  # [kg/m^3]
    heat_capacity: float = HEAT_CAPACITY  # [J/(kg K)]

    def __post_init__(self) -> None:
        for name, unit, (least, most) in (
            ("conductivity", "W/(m K)", CONDUCTIVITY_RANGE),
            ("density", "kg/m^3", DENSITY_RANGE),
            ("heat_capacity", "J/(kg K)", HEAT_CAPACITY_RANGE),
        ):
            object.__setattr__(self, name, number(name, getattr(self, name), unit, least=least, most=most))

    @property
    def diffusivity(self) -> float:
        """Conductivity over density and heat capacity [m^2/s]."""
        return self.conductivity / (self.density * self.heat_capacity)

    @property
    def thermal_contact_coefficient(self) -> float:
        """Root of conductivity, density and heat capacity [J/(m^2 K s^0.5)], also called effusivity."""
        return float(np.sqrt(self.conductivity * self.density * self.heat_capacity))


def by_member(name: str, value: Any, unit: str, bounds: tuple[float, float]) -> tuple[float, float]:
    """Property of pinion and gear, given as one number for both or as a pair; refused out of its bounds."""
    pair = value if isinstance(value, tuple | list) else (value, value)
    if len(pair) != 2:
        raise InputError(f"{name} = {value!r}: must be a number, or a pair for pinion and gear [{unit}]")
    first, second = (number(name, each, unit, least=bounds[0], most=bounds[1]) for each in pair)
    return first, second
