"""Operating conditions of one lubricated line contact, with its scales and its dimensionless groups.

The oil has viscosity, density and conductivity under pressure, at its inlet temperature. There lubricant is sheared
before the contact, and its heat thins the film by factors with a name.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from ...core import checks
from ...core.arrays import RealArray as Array
from ...core.checks import bounded
from ...core.errors import InputError
from ..conditions import FILM_FACTORS, STEEL_MODULUS, THERMAL_FACTORS
from ..lubricants.lubricant import OilState

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

    viscosity: float = field(metadata=bounded("Pa s", above=0.0))
    pressure_viscosity: float = field(metadata=bounded("1/Pa", least=0.0))
    eyring_stress: float = field(default=5e6, metadata=bounded("Pa", above=0.0, infinite=True))
    law: ViscosityLaw = "roelands"
    high_pressure_viscosity: float | None = field(default=None, metadata=bounded("1/Pa", above=0.0))
    limiting_shear: float | None = field(default=None, metadata=bounded(above=0.0))
    compressible: bool = True
    temperature_viscosity: float | None = field(default=None, metadata=bounded("1/K", above=0.0))
    thermal_conductivity: float | None = field(default=None, metadata=bounded("W/(m K)", above=0.0))
    inlet_temperature: float | None = field(default=None, metadata=bounded("degC", above=ROELANDS_TEMPERATURE))

    def __post_init__(self) -> None:
        checks.check_fields(self)
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


#: Greatest Hertz pressure over contact modulus: beyond, nothing is a Hertz contact.
PRESSURE_PARAMETER_LIMIT = 0.1


@dataclass(frozen=True)
class LubricatedContact:
    """Two cylinders, rolling and sliding, with an oil in between; in SI.

    Names and symbols are those of ``ContactConditions``, here of one contact.

    Parameters
    ----------
    hertz_pressure
        Greatest Hertz pressure [Pa]; it stands for the load.
    equivalent_radius
        Radius of relative curvature R [m].
    rolling_velocity
        Mean velocity of the surfaces (u1 + u2) / 2 [m/s].
    oil
        At the temperature of the inlet.
    slide_to_roll
        Sliding velocity u1 - u2 over the rolling velocity, with its sign [1]; at 2 or -2 one surface stands still.
    contact_modulus
        E' = 2 / [(1 - nu1^2) / E1 + (1 - nu2^2) / E2] [Pa].
    inlet_viscosity
        Viscosity in the flow over that in the shear [1]: below 1 where the inlet is heated, see ``heated_inlet``.

    Raises
    ------
    InputError
        If a number is not positive or not finite, the slide-to-roll ratio is not from -2 to 2, or ``oil`` is no
        ``Oil``.

    Examples
    --------
    >>> contact = LubricatedContact(1e9, 0.02, 5.0, Oil(0.02, 1.1e-8), slide_to_roll=0.25)
    >>> print(f"{1e6 * contact.half_width:.0f} um, {1e-3 * contact.load:.0f} N/mm")
    352 um, 554 N/mm
    """

    hertz_pressure: float = field(metadata=bounded("Pa", above=0.0))
    equivalent_radius: float = field(metadata=bounded("m", above=0.0))
    rolling_velocity: float = field(metadata=bounded("m/s", above=0.0))
    oil: Oil
    slide_to_roll: float = field(default=0.0, metadata=bounded(least=-2.0, most=2.0))
    contact_modulus: float = field(default=STEEL_MODULUS, metadata=bounded("Pa", above=0.0))
    inlet_viscosity: float = field(default=1.0, metadata=bounded(above=0.0))

    def __post_init__(self) -> None:
        checks.check_fields(self)
        if self.hertz_pressure > PRESSURE_PARAMETER_LIMIT * self.contact_modulus:
            raise InputError(
                f"hertz_pressure = {self.hertz_pressure:g}: must be up to {PRESSURE_PARAMETER_LIMIT:g} of the contact "
                f"modulus, {PRESSURE_PARAMETER_LIMIT * self.contact_modulus:g} Pa: give pascals"
            )

    @property
    def half_width(self) -> float:
        """Half width of the dry contact, a [m]."""
        return 4.0 * self.equivalent_radius * self.hertz_pressure / self.contact_modulus

    @property
    def load(self) -> float:
        """Load per length [N/m]."""
        return 0.5 * math.pi * self.half_width * self.hertz_pressure

    @property
    def sliding_velocity(self) -> float:
        """Difference of the surface velocities u1 - u2 [m/s]."""
        return self.slide_to_roll * self.rolling_velocity

    @property
    def film_scale(self) -> float:
        """Unit of the film thickness a^2 / R [m]."""
        return self.half_width**2 / self.equivalent_radius

    @property
    def pressure_parameter(self) -> float:
        """Hertz pressure over contact modulus, H [1]."""
        return self.hertz_pressure / self.contact_modulus

    @property
    def load_parameter(self) -> float:
        """Load per length over contact modulus and radius, W [1]."""
        return self.load / (self.contact_modulus * self.equivalent_radius)

    @property
    def speed_parameter(self) -> float:
        """Viscosity times rolling velocity over contact modulus and radius, U [1]."""
        return self.oil.viscosity * self.rolling_velocity / (self.contact_modulus * self.equivalent_radius)

    @property
    def material_parameter(self) -> float:
        """Pressure-viscosity coefficient times contact modulus, G [1]."""
        return self.oil.pressure_viscosity * self.contact_modulus

    @property
    def thermal_parameter(self) -> float:
        """Thermal loading of the inlet, L = temperature-viscosity coefficient * viscosity * V^2 / conductivity [1].

        Raises
        ------
        InputError
            If the oil has no ``temperature_viscosity`` or no ``thermal_conductivity``.
        """
        oil = self.oil
        if oil.temperature_viscosity is None or oil.thermal_conductivity is None:
            raise InputError(
                "the heat of the inlet needs temperature_viscosity and thermal_conductivity of the oil: give both"
            )
        return oil.temperature_viscosity * oil.viscosity * self.rolling_velocity**2 / oil.thermal_conductivity

    @property
    def moes_load(self) -> float:
        """Load parameter of the diagram of lubrication regimes, M = W / sqrt(2 U) [1]."""
        return self.load_parameter / math.sqrt(2.0 * self.speed_parameter)

    @property
    def moes_viscosity(self) -> float:
        """Piezoviscous parameter of the diagram of lubrication regimes, G (2 U)^(1/4) [1]."""
        return float(self.material_parameter * (2.0 * self.speed_parameter) ** 0.25)

    @property
    def reynolds_number(self) -> float:
        """The only group of the isoviscous equation in Hertz units, 12 viscosity velocity R^2 / (a^3 p_h) [1]."""
        drag = 12.0 * self.inlet_viscosity * self.oil.viscosity * self.rolling_velocity
        return drag * self.equivalent_radius**2 / (self.half_width**3 * self.hertz_pressure)

    def central_film_estimate(self) -> float:
        """Film thickness where the pressure is greatest, by Moes' formula for all regimes of line contacts [m].

        Within some 5 % from rigid to elastic and from isoviscous to piezoviscous; for starting values and domains.
        (H. Moes, Lubrication and Beyond, University of Twente 2000; the film is in units of R sqrt(2 U).)
        """
        m, viscous = self.moes_load, self.moes_viscosity
        rigid, elastic = 3.0 / m, 2.621 * m**-0.2
        exponent = (7.0 + 8.0 * math.exp(-2.0 * elastic / rigid)) / 5.0
        film = (rigid ** (7 / 3) + elastic ** (7 / 3)) ** (3.0 * exponent / 7.0)
        if viscous > 0.0:
            stiff_rigid, stiff_elastic = 1.287 * viscous ** (2 / 3), 1.311 * m**-0.125 * viscous**0.75
            film += (stiff_rigid**-3.5 + stiff_elastic**-3.5) ** (-2.0 * exponent / 7.0)
        return float(self.equivalent_radius * math.sqrt(2.0 * self.speed_parameter) * film ** (1.0 / exponent))


#: Power of the viscosity in the smallest film (Pan and Hamrock).
VISCOSITY_EXPONENT = 0.694


def film_factor(contact: LubricatedContact, factor: str = "gupta_cheng") -> float:
    """Film thickness with a heated inlet over that without, by ``gupta_cheng``, or ``murch_wilson`` in pure rolling.

    The oil needs ``temperature_viscosity`` and ``thermal_conductivity``.
    """
    checks.instance("contact", contact, LubricatedContact)
    groups = replace(contact, slide_to_roll=abs(contact.slide_to_roll))
    value = float(THERMAL_FACTORS[checks.one_of("factor", factor, FILM_FACTORS[1:])](groups))
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
