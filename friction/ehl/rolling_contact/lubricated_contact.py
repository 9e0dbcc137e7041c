"""Operating conditions of a lubricated line contact, its scales and its dimensionless groups."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ....core import checks
from ....core.errors import InputError
from .oil import Oil

#: Reduced modulus of steel on steel, 2 / sum((1 - nu^2) / E) [Pa].
STEEL = 2.27e11


@dataclass(frozen=True)
class LineContact:
    """Two cylinders, rolling and sliding, with an oil in between; SI units.

    Attributes
    ----------
    hertz_pressure : float
        Greatest pressure of the dry contact [Pa]; it stands for the load.
    radius : float
        Equivalent radius R of the cylinders [m].
    rolling_velocity : float
        Mean velocity of the surfaces (u1 + u2) / 2 [m/s].
    oil : Oil
    slide_to_roll : float
        (u1 - u2) over the rolling velocity [1]; |slide_to_roll| = 2 holds one surface still.
    reduced_modulus : float
        E' = 2 / [(1 - nu1^2) / E1 + (1 - nu2^2) / E2] [Pa].
    inlet_viscosity : float
        Viscosity in the flow over that in the shear [1]: below 1 where the inlet is heated, see `inlet`.

    Raises
    ------
    InputError
        A number is not positive or not finite, the slide-to-roll ratio is not within [-2, 2], or `oil` is no `Oil`.
    """

    hertz_pressure: float
    radius: float
    rolling_velocity: float
    oil: Oil
    slide_to_roll: float = 0.0
    reduced_modulus: float = STEEL
    inlet_viscosity: float = 1.0

    def __post_init__(self) -> None:
        checks.positive("hertz_pressure", self.hertz_pressure, "Pa")
        checks.positive("radius", self.radius, "m")
        checks.positive("rolling_velocity", self.rolling_velocity, "m/s")
        checks.positive("reduced_modulus", self.reduced_modulus, "Pa")
        checks.positive("inlet_viscosity", self.inlet_viscosity, "1")
        checks.number("slide_to_roll", self.slide_to_roll, least=-2.0, most=2.0)
        checks.instance("oil", self.oil, Oil)
        if self.hertz_pressure > 0.1 * self.reduced_modulus:
            raise InputError(
                f"hertz_pressure = {self.hertz_pressure:g}: must be up to a tenth of the contact modulus, "
                f"{0.1 * self.reduced_modulus:g} Pa: give pascals"
            )

    @property
    def half_width(self) -> float:
        """Half width a of the dry contact [m]."""
        return 4.0 * self.radius * self.hertz_pressure / self.reduced_modulus

    @property
    def load(self) -> float:
        """Normal load per length of the contact [N/m]."""
        return 0.5 * math.pi * self.half_width * self.hertz_pressure

    @property
    def sliding_velocity(self) -> float:
        """Difference of the surface velocities u1 - u2 [m/s]."""
        return self.slide_to_roll * self.rolling_velocity

    @property
    def film_scale(self) -> float:
        """Unit of the film thickness a^2 / R [m]."""
        return self.half_width**2 / self.radius

    @property
    def load_group(self) -> float:
        """W = load / (E' R) [1]."""
        return self.load / (self.reduced_modulus * self.radius)

    @property
    def speed_group(self) -> float:
        """U = viscosity times rolling velocity / (E' R) [1]."""
        return self.oil.viscosity * self.rolling_velocity / (self.reduced_modulus * self.radius)

    @property
    def material_group(self) -> float:
        """G = pressure-viscosity coefficient times E' [1]."""
        return self.oil.pressure_viscosity * self.reduced_modulus

    @property
    def moes_load(self) -> float:
        """M = W / sqrt(2 U): load parameter of the diagram of lubrication regimes [1]."""
        return self.load_group / math.sqrt(2.0 * self.speed_group)

    @property
    def moes_viscosity(self) -> float:
        """L = G (2 U)^(1/4): piezoviscous parameter of the diagram of lubrication regimes [1]."""
        return float(self.material_group * (2.0 * self.speed_group) ** 0.25)

    @property
    def reynolds_number(self) -> float:
        """12 viscosity velocity R^2 / (a^3 p_h): the only group of the isoviscous equation in Hertz units [1]."""
        return (
            12.0
            * self.inlet_viscosity
            * self.oil.viscosity
            * self.rolling_velocity
            * self.radius**2
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
        return float(self.radius * math.sqrt(2.0 * self.speed_group) * film ** (1.0 / exponent))
