"""Film thickness by formulas, and thermal factors of the inlet, by name.

Least film thickness of a smooth, isothermal line contact, by name.

>>> from easeoff.friction import FILMS
>>> list(FILMS)
['pan_hamrock', 'dowson_higginson']
>>> print(f"{FILMS['pan_hamrock'](1e-11, 5000.0, 1.3e-4):.2e}")
1.58e-05

Thermal factors: by how much the heat of the sheared inlet lowers rolling traction and film thickness.

>>> from easeoff.friction import FILM_FACTORS, THERMAL_FACTORS
>>> list(THERMAL_FACTORS)
['goksem_hargreaves', 'murch_wilson', 'gupta_cheng', 'none']
>>> FILM_FACTORS
('none', 'gupta_cheng', 'murch_wilson')
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Protocol

import numpy as np

from ..core.arrays import Array
from ..core.checks import one_of


def pan_hamrock(speed: Array, material: Array, load: Array) -> Array:
    """Least film over radius (...), 1.714 U^0.694 G^0.568 W^-0.128: Pan and Hamrock, doi 10.1115/1.3261900."""
    return 1.714 * speed**0.694 * material**0.568 * load**-0.128


def dowson_higginson(speed: Array, material: Array, load: Array) -> Array:
    """Least film over radius (...), 2.65 U^0.7 G^0.54 W^-0.13: Dowson and Higginson, Pergamon 1966."""
    return 2.65 * speed**0.7 * material**0.54 * load**-0.13


FILMS: dict[str, Callable[[Array, Array, Array], Array]] = {
    "pan_hamrock": pan_hamrock,
    "dowson_higginson": dowson_higginson,
}


def film_formula(name: str) -> Callable[[Array, Array, Array], Array]:
    """Film formula by name; an unknown one is refused."""
    return FILMS[one_of("film", name, FILMS)]


class DimensionlessGroups(Protocol):
    """Dimensionless groups of line contacts, in ``ContactConditions`` and ``ehl.LubricatedContact`` alike."""

    @property
    def pressure_parameter(self) -> Any:
        """Hertz pressure over contact modulus, H."""

    @property
    def load_parameter(self) -> Any:
        """Load per length over contact modulus and radius, W."""

    @property
    def speed_parameter(self) -> Any:
        """Viscosity times rolling velocity over contact modulus and radius, U."""

    @property
    def material_parameter(self) -> Any:
        """Pressure-viscosity coefficient times contact modulus, G."""

    @property
    def thermal_parameter(self) -> Any:
        """Thermal loading of the inlet, L."""

    @property
    def slide_to_roll(self) -> Any:
        """Sliding over rolling velocity, SR."""


def goksem_hargreaves(conditions: DimensionlessGroups) -> Array:
    """Thermal factor that goes with the rolling traction's own formula (...), in its isothermal part Eq. 5.10."""
    c = conditions
    thermal = c.thermal_parameter
    group = 11.81221 * c.material_parameter * c.speed_parameter / c.load_parameter**1.5
    return np.asarray(group ** (0.0106383 * thermal**0.31746) / (1.0 + 0.411483 * thermal**0.707071))


def murch_wilson(conditions: DimensionlessGroups) -> Array:
    """Thermal factor of the film in pure rolling (...), Murch and Wilson 1975, doi 10.1115/1.3452559."""
    return np.asarray(3.94 / (3.94 + conditions.thermal_parameter**0.62))


def gupta_cheng(conditions: DimensionlessGroups) -> Array:
    """Thermal factor of the film with sliding (...), doi 10.1080/10402009208982117.

    As quoted by Arana, Larranaga and Ulacia 2019, Eq. 24, doi 10.1177/1350650118778655; zero where it would be
    negative, far beyond its range of pressure and speed.
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
#: Those of the factors that were made for the film thickness, and none.
FILM_FACTORS = ("none", "gupta_cheng", "murch_wilson")
