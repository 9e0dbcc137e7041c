"""Operating conditions of lubricated line contacts, in SI, and their dimensionless groups.

With formulas by name of the least film thickness of a smooth, isothermal line contact:

>>> from easeoff.friction import FILMS
>>> list(FILMS)
['pan_hamrock', 'dowson_higginson']
>>> print(f"{FILMS['pan_hamrock'](1e-11, 5000.0, 1.3e-4):.2e}")
1.58e-05

and thermal factors, by which the heat of the sheared inlet lowers rolling traction and film thickness:

>>> from easeoff.friction import FILM_FACTORS, THERMAL_FACTORS
>>> list(THERMAL_FACTORS)
['goksem_hargreaves', 'murch_wilson', 'gupta_cheng', 'none']
>>> FILM_FACTORS
('none', 'gupta_cheng', 'murch_wilson')
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from ..core.arrays import Array, record
from ..core.checks import array, one_of, positive
from .lubricants.lubricant import THERMAL_CONDUCTIVITY


def pan_hamrock(speed: Array, material: Array, load: Array) -> Array:
    """Least film over radius (...), 1.714 U^0.694 G^0.568 W^-0.128: Pan and Hamrock, doi 10.1115/1.3261900."""
    return 1.714 * speed**0.694 * material**0.568 * load**-0.128


def dowson_higginson(speed: Array, material: Array, load: Array) -> Array:
    """Least film over radius (...), 2.65 U^0.7 G^0.54 W^-0.13: Dowson and Higginson, Pergamon 1966."""
    return 2.65 * speed**0.7 * material**0.54 * load**-0.13


FilmFormula = Callable[[Array, Array, Array], Array]
FILMS: dict[str, FilmFormula] = {"pan_hamrock": pan_hamrock, "dowson_higginson": dowson_higginson}


def film_formula(name: str) -> FilmFormula:
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


THERMAL_FACTORS: Mapping[str, Callable[[DimensionlessGroups], Array]] = {
    "goksem_hargreaves": goksem_hargreaves,
    "murch_wilson": murch_wilson,
    "gupta_cheng": gupta_cheng,
    "none": lambda _: np.ones(()),
}
#: Those of the factors that were made for the film thickness, and none.
FILM_FACTORS = ("none", "gupta_cheng", "murch_wilson")


STEEL_MODULUS = 2.27e11  # [Pa]; 2/[(1 - v1^2)/E1 + (1 - v2^2)/E2] of steel on steel


@record(frozen=True)
class ContactConditions:
    """Operating conditions of line contacts; all arrays broadcast against each other, everything in SI.

    Parameters
    ----------
    hertz_pressure
        Greatest Hertz pressure [Pa].
    equivalent_radius
        Radius of relative curvature across the contact line [m].
    rolling_velocity
        Mean of both surface velocities across the contact line [m/s].
    sliding_velocity
        Whole sliding velocity [m/s].
    slide_to_roll
        Size of the sliding velocity across the contact line over the rolling velocity [1].
    temperature
        Of the oil [degC].
    viscosity
        At ambient pressure [Pa s].
    pressure_viscosity
        [1/Pa].
    roughness_pinion, roughness_gear
        RMS heights Rq [m].
    temperature_viscosity
        Fall of the viscosity's logarithm with temperature [1/K].
    thermal_conductivity
        Of the oil [W/(m K)].
    contact_modulus
        2/[(1 - v1^2)/E1 + (1 - v2^2)/E2] [Pa].
    film_formula
        Name of the formula for the least film thickness, see ``FILMS``.
    film_heating
        Factor by which heat of the inlet thins the film, a name in ``FILM_FACTORS``.

    Examples
    --------
    >>> from easeoff.friction.coefficient import contact_conditions
    >>> contact = contact_conditions(hertz_pressure=0.7e9, equivalent_radius=0.042, rolling_velocity=2.2,
    ...                              slide_to_roll=0.45, roughness=0.8e-6)
    >>> print(f"{1e6 * contact.film_thickness:.3f} um, lambda ratio {contact.lambda_ratio:.3f}")
    0.214 um, lambda ratio 0.189
    """

    hertz_pressure: Array
    equivalent_radius: Array
    rolling_velocity: Array
    sliding_velocity: Array
    slide_to_roll: Array
    temperature: Array
    viscosity: Array
    pressure_viscosity: Array
    roughness_pinion: Array
    roughness_gear: Array
    temperature_viscosity: Array | float = 0.035
    thermal_conductivity: float = THERMAL_CONDUCTIVITY
    contact_modulus: float = STEEL_MODULUS
    film_formula: str = "pan_hamrock"
    film_heating: str = "none"

    def __post_init__(self) -> None:
        for entry in fields(self):
            if entry.name not in ("film_formula", "film_heating"):
                array(entry.name, getattr(self, entry.name), anything=True)
        positive("contact_modulus", self.contact_modulus, "Pa")
        film_formula(self.film_formula)
        one_of("film_heating", self.film_heating, FILM_FACTORS)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape that all arrays broadcast to."""
        values = (getattr(self, entry.name) for entry in fields(self))
        return np.broadcast_shapes(*(np.shape(value) for value in values if not isinstance(value, str)))

    def described(self, index: tuple[int, ...]) -> str:
        """The conditions of one contact in words.

        Examples
        --------
        >>> from easeoff.friction.coefficient import contact_conditions
        >>> contact = contact_conditions(hertz_pressure=0.7e9, equivalent_radius=0.042, rolling_velocity=2.2,
        ...                              slide_to_roll=0.45, roughness=0.8e-6)
        >>> contact.described(())
        '700 MPa, radius 42 mm, rolling velocity 2.2 m/s, slide-to-roll ratio 0.45, 90 degC, lambda ratio 0.19'
        """

        def at(values: Any) -> float:
            return float(np.broadcast_to(values, self.shape)[index])

        return (
            f"{1e-6 * at(self.hertz_pressure):.4g} MPa, radius {1e3 * at(self.equivalent_radius):.3g} mm, rolling "
            f"velocity {at(self.rolling_velocity):.3g} m/s, slide-to-roll ratio {at(self.slide_to_roll):.3g}, "
            f"{at(self.temperature):g} degC, lambda ratio {at(self.lambda_ratio):.2g}"
        )

    @property
    def pressure_parameter(self) -> Array:
        """Hertz pressure over contact modulus, H."""
        return self.hertz_pressure / self.contact_modulus

    @property
    def load_parameter(self) -> Array:
        """Load per length over contact modulus and radius, W = 2 pi H^2."""
        return 2.0 * np.pi * self.pressure_parameter**2

    @property
    def load(self) -> Array:
        """Load per length [N/m]."""
        return self.load_parameter * self.contact_modulus * self.equivalent_radius

    @cached_property
    def speed_parameter(self) -> Array:
        """Viscosity times rolling velocity over contact modulus and radius, U."""
        return self.viscosity * (self.rolling_velocity / (self.contact_modulus * self.equivalent_radius))

    @property
    def material_parameter(self) -> Array:
        """Pressure-viscosity coefficient times contact modulus, G."""
        return self.pressure_viscosity * self.contact_modulus

    @cached_property
    def film_thickness(self) -> Array:
        """Least thickness of the smooth film [m], thinned by ``film_heating``."""
        formula = film_formula(self.film_formula)
        cold = self.equivalent_radius * formula(self.speed_parameter, self.material_parameter, self.load_parameter)
        return cold if self.film_heating == "none" else cold * THERMAL_FACTORS[self.film_heating](self)

    @property
    def thermal_parameter(self) -> Array:
        """Thermal loading of the inlet, L = temperature-viscosity coefficient * viscosity * V^2 / conductivity."""
        per_velocity = self.temperature_viscosity * self.viscosity / self.thermal_conductivity
        return np.asarray(per_velocity * self.rolling_velocity**2)

    @property
    def composite_roughness(self) -> Array:
        """Root of the sum of both squared RMS roughnesses [m]."""
        return np.hypot(self.roughness_pinion, self.roughness_gear)

    @cached_property
    def lambda_ratio(self) -> Array:
        """Film thickness over composite roughness; infinite for perfectly smooth flanks."""
        with np.errstate(divide="ignore"):
            return self.film_thickness / self.composite_roughness
