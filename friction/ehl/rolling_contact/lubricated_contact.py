"""Operating conditions of one lubricated line contact, with its scales and its dimensionless groups."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ....core import checks
from ....core.errors import InputError
from ...conditions import STEEL_MODULUS
from .oil import Oil

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

    hertz_pressure: float
    equivalent_radius: float
    rolling_velocity: float
    oil: Oil
    slide_to_roll: float = 0.0
    contact_modulus: float = STEEL_MODULUS
    inlet_viscosity: float = 1.0

    def __post_init__(self) -> None:
        for name, unit in (
            ("hertz_pressure", "Pa"),
            ("equivalent_radius", "m"),
            ("rolling_velocity", "m/s"),
            ("contact_modulus", "Pa"),
            ("inlet_viscosity", "1"),
        ):
            checks.positive(name, getattr(self, name), unit)
        checks.number("slide_to_roll", self.slide_to_roll, least=-2.0, most=2.0)
        checks.instance("oil", self.oil, Oil)
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
        return (
            12.0
            * self.inlet_viscosity
            * self.oil.viscosity
            * self.rolling_velocity
            * self.equivalent_radius**2
            / (self.half_width**3 * self.hertz_pressure)
        )

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
