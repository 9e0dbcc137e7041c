"""Operating conditions of lubricated line contacts, in SI, and their dimensionless groups."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np

from ..core.arrays import Array
from ..core.checks import array, frozen_arrays, one_of, positive
from .film_thickness import FILM_FACTORS, THERMAL_FACTORS, film_formula
from .lubricants.lubricant import THERMAL_CONDUCTIVITY

STEEL_MODULUS = 2.27e11  # [Pa]; 2/[(1 - v1^2)/E1 + (1 - v2^2)/E2] of steel on steel


@frozen_arrays
@dataclass(frozen=True)
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
        return np.asarray(
            self.temperature_viscosity * self.viscosity / self.thermal_conductivity * self.rolling_velocity**2
        )

    @property
    def composite_roughness(self) -> Array:
        """Root of the sum of both squared RMS roughnesses [m]."""
        return np.hypot(self.roughness_pinion, self.roughness_gear)

    @cached_property
    def lambda_ratio(self) -> Array:
        """Film thickness over composite roughness; infinite for perfectly smooth flanks."""
        with np.errstate(divide="ignore"):
            return self.film_thickness / self.composite_roughness
