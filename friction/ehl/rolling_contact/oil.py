"""Oil at its inlet temperature: viscosity, density and conductivity under pressure."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ....core import checks
from ....core.errors import InputError
from ...lubricants.lubricant import OilState

Array = NDArray[np.float64]

#: Constants of Roelands' law [Pa], [1].
ROELANDS_PRESSURE, ROELANDS_LOGARITHM = 1.98e8, 9.67
#: Where Roelands' law of the temperature has its pole [deg C].
ROELANDS_TEMPERATURE = -135.0
#: Rise of the conductivity of a naphthenic mineral oil with the pressure, as k / k0 = 1 + a p / (1 + b p) [1/Pa]
#: (Larsson and Andersson, Proceedings IMechE Part J 214 (2000) 337; other oils are within a tenth at 1 GPa).
CONDUCTIVITY_COEFFICIENTS = (1.54e-9, 0.33e-9)
#: Transition of the two-slope law [Pa]: start, where the two lines would meet, and end.
TRANSITION_PRESSURES = (70e6, 380e6, 1400e6)
#: Coefficients of the density by Dowson and Higginson [1/Pa].
DENSITY_RISE, DENSITY_FALL = 2.266e-9, 1.683e-9

ViscosityLaw = Literal["roelands", "two_slope"]


@dataclass(frozen=True)
class Oil:
    """Oil at its inlet temperature.

    Parameters
    ----------
    viscosity
        Dynamic viscosity at ambient pressure [Pa s].
    pressure_viscosity
        Slope of ln(viscosity) over the pressure at ambient pressure [1/Pa]; 0 is an isoviscous oil.
    eyring_stress
        Shear stress from which the film thins under shear [Pa]; infinity is a Newtonian oil.
    law
        Viscosity under pressure: by Roelands, or straight in ln(viscosity) at low and at high pressure with a cubic
        in between.
    high_pressure_viscosity
        Slope of ln(viscosity) at high pressure [1/Pa], two-slope law only; half of ``pressure_viscosity`` if not given.
    limiting_shear
        Ceiling of the shear stress in the film as a fraction of the pressure [1]; no ceiling if not given.
    compressible
        Density by Dowson and Higginson, or constant.
    temperature_viscosity
        Fall of ln(viscosity) with the temperature at the inlet [1/K]; needed for the thermal correction.
    thermal_conductivity
        Thermal conductivity at ambient pressure [W/(m K)]; needed for the thermal correction.
    inlet_temperature
        [deg C]. With it a heated film thins by Roelands' law, less and less; without it ln(viscosity) falls in a
        straight line, too far once the rise is some tens of kelvin.

    Raises
    ------
    InputError
        If a number is not positive (or, where zero has a meaning, negative) or not finite.

    Examples
    --------
    >>> thickening, _ = Oil(viscosity=0.0208, pressure_viscosity=11.4e-9).log_viscosity(np.array([0.0, 1e9]))
    >>> (0.0208 * np.exp(thickening)).round(2)
    array([0.02, 7.5 ])
    """

    viscosity: float
    pressure_viscosity: float
    eyring_stress: float = 5e6
    law: ViscosityLaw = "roelands"
    high_pressure_viscosity: float | None = None
    limiting_shear: float | None = None
    compressible: bool = True
    temperature_viscosity: float | None = None
    thermal_conductivity: float | None = None
    inlet_temperature: float | None = None

    def __post_init__(self) -> None:
        checks.positive("viscosity", self.viscosity, "Pa s")
        checks.positive("pressure_viscosity", self.pressure_viscosity, "1/Pa", zero=True)
        checks.positive("eyring_stress", self.eyring_stress, "Pa", infinite=True)
        checks.truth("compressible", self.compressible)
        for name, unit in (
            ("high_pressure_viscosity", "1/Pa"),
            ("limiting_shear", "1"),
            ("temperature_viscosity", "1/K"),
            ("thermal_conductivity", "W/(m K)"),
        ):
            if getattr(self, name) is not None:
                checks.positive(name, getattr(self, name), unit)
        if self.inlet_temperature is not None:
            checks.number("inlet_temperature", self.inlet_temperature, "degC", above=ROELANDS_TEMPERATURE)
        checks.one_of("law", self.law, ("roelands", "two_slope"))
        by_roelands = self.law == "roelands" or self.inlet_temperature is not None
        if by_roelands and math.log(self.viscosity) + ROELANDS_LOGARITHM <= 0.0:
            raise InputError(
                f"viscosity = {self.viscosity:g}: must be above {math.exp(-ROELANDS_LOGARITHM):.2g} [Pa s], where "
                "Roelands' laws end; or give the two-slope law and no inlet_temperature"
            )

    @classmethod
    def of(cls, state: OilState, **rheology: Any) -> Oil:
        """Oil from a lubricant at one temperature; ``rheology`` are further attributes."""
        return cls(
            float(state.viscosity),
            float(state.pressure_viscosity),
            temperature_viscosity=float(state.temperature_viscosity),
            thermal_conductivity=float(state.thermal_conductivity),
            **rheology,
        )

    def log_viscosity(self, pressure: Array) -> tuple[Array, Array]:
        """Return ln(viscosity / viscosity at ambient pressure) and its derivative [1/Pa] at pressures >= 0 [Pa]."""
        if self.law == "roelands":
            span = math.log(self.viscosity) + ROELANDS_LOGARITHM
            exponent = self.pressure_viscosity * ROELANDS_PRESSURE / span
            base = 1.0 + pressure / ROELANDS_PRESSURE
            power = base**exponent
            return span * (power - 1.0), self.pressure_viscosity * power / base
        return self._two_slope(pressure)

    def _two_slope(self, pressure: Array) -> tuple[Array, Array]:
        low, first = self.pressure_viscosity, TRANSITION_PRESSURES[0]
        high = 0.5 * low if self.high_pressure_viscosity is None else self.high_pressure_viscosity
        middle, last = TRANSITION_PRESSURES[1:]
        # Cubic with the values and slopes of the two lines at the ends of the transition.
        width = last - first
        rise = low * middle + high * (last - middle) - low * first
        s = np.clip((pressure - first) / width, 0.0, 1.0)
        cubic = (low + high) * width - 2.0 * rise
        square = 3.0 * rise - (2.0 * low + high) * width
        value = low * first + s * (low * width + s * (square + s * cubic))
        slope = low + s * (2.0 * square + 3.0 * s * cubic) / width
        value = np.where(pressure < first, low * pressure, value + high * np.maximum(pressure - last, 0.0))
        return value, slope

    def thermal_thinning(self, rise: Array) -> tuple[Array, Array]:
        """Return by how much ln(viscosity) falls with a rise of the temperature [K], and the derivative [1/K].

        That of the viscosity at ambient pressure; what the pressure adds to ln(viscosity) stays.
        """
        fall = self.temperature_viscosity or 0.0
        if self.inlet_temperature is None:
            return fall * rise, np.full_like(rise, fall)
        above = self.inlet_temperature - ROELANDS_TEMPERATURE
        span = math.log(self.viscosity) + ROELANDS_LOGARITHM
        exponent = fall * above / span
        base = 1.0 + rise / above
        power = base**-exponent
        return span * (1.0 - power), fall * power / base

    def thermal_conductivity_at(self, pressure: Array) -> Array:
        """Thermal conductivity at pressures >= 0 [Pa], in W/(m K)."""
        rise, fall = CONDUCTIVITY_COEFFICIENTS
        return np.asarray((self.thermal_conductivity or 0.0) * (1.0 + rise * pressure / (1.0 + fall * pressure)))

    def relative_density(self, pressure: Array) -> tuple[Array, Array]:
        """Return density over that at ambient pressure, and its derivative [1/Pa], at pressures >= 0 [Pa]."""
        if not self.compressible:
            return np.ones_like(pressure), np.zeros_like(pressure)
        below = 1.0 + DENSITY_FALL * pressure
        return (1.0 + DENSITY_RISE * pressure) / below, (DENSITY_RISE - DENSITY_FALL) / below**2
