"""Shear of the film and of touching asperities, and the friction coefficient.

In the film the stress is that of an Eyring fluid, tau0 asinh(eta u_s / (tau0 h)), with the sliding velocity u_s, if
wanted under a ceiling proportional to the pressure; where asperities touch it is the boundary friction coefficient
times the pressure (dissertation, equations 5.7-5.9); where the film is ruptured there is none.
"""

from __future__ import annotations

import math

import numpy as np

from ...core import checks
from ...core.arrays import RealArray as Array, record
from ...core.errors import InputError
from .lubricated_contact import LubricatedContact

#: Root of conductivity, density and specific heat of steel (46 W/(m K), 7850 kg/m^3, 460 J/(kg K)) [J/(m^2 K s^0.5)].
STEEL_EFFUSIVITY = 12890.0
#: Friction coefficient of touching asperities.
BOUNDARY_FRICTION = 0.1

#: ln(viscosity) beyond which the Eyring stress is that of its asymptote anyway; keeps exp from overflowing.
LOG_VISCOSITY_LIMIT = 600.0
#: Relative change of the heat at which film temperature and shear agree, and how many times they are adjusted; change
#: of the temperature [K] that ends the inner steps, and their number.
HEAT_TOLERANCE, HEAT_ITERATIONS = 1e-6, 60
TEMPERATURE_TOLERANCE, NEWTON_ITERATIONS = 1e-6, 30
#: By how much distances of positions may differ, relative; pressures of asperities below zero that are rounding, over
#: the Hertz pressure.
SPACING_TOLERANCE, PRESSURE_ROUNDING = 1e-6, 1e-12


@record(frozen=True, eq=False)
class Traction:
    """Shear in a contact.

    Parameters
    ----------
    stress
        Shear stress (n) [Pa], with the sign of the sliding velocity.
    film, asperities
        Friction coefficients: shear force of the film, and of the touching asperities, over the load [1]. That of the
        film is NaN if the thermal correction does not settle.
    temperature_rise
        Mean rise of the film over the inlet temperature (n) [K]; zero without the thermal correction.

    Examples
    --------
    >>> print(f"{Traction(np.zeros(1), 0.03, 0.01, np.zeros(1)).coefficient:.2f}")
    0.04
    """

    stress: Array
    film: float
    asperities: float
    temperature_rise: Array

    @property
    def coefficient(self) -> float:
        """Friction coefficient [1]."""
        return self.film + self.asperities


def traction(
    contact: LubricatedContact,
    position: Array,
    pressure: Array,
    film: Array,
    *,
    fluid_part: Array | float = 1.0,
    asperity_pressure: Array | float = 0.0,
    boundary_friction: float = BOUNDARY_FRICTION,
    thermal: bool = False,
    effusivity: float = STEEL_EFFUSIVITY,
) -> Traction:
    """Shear stress and friction coefficient from a film.

    Parameters
    ----------
    contact
        Operating conditions.
    position, pressure, film
        Of the nodes, at equal distances (n) [m], [Pa], [m].
    fluid_part
        Part of the pressure that the lubricant carries (n), see ``reynolds_equation``; asperities carry the rest.
    asperity_pressure
        Pressure on asperities beside ``pressure`` (n) [Pa], see ``Asperities``.
    boundary_friction
        Friction coefficient of touching asperities [1].
    thermal
        Lower the viscosity in the shear stress by the film's own heat, see ``film_temperature`` and
        ``Oil.thermal_thinning``. The film thickness stays as it is, see ``heated_inlet``.
    effusivity
        Root of conductivity, density and specific heat of the bodies [J/(m^2 K s^0.5)].

    Raises
    ------
    InputError
        If the positions do not increase by equal distances, an array has another length, a number is not finite, a film
        under pressure not positive or a part not from 0 to 1; or the thermal correction is asked for and the oil has no
        ``temperature_viscosity`` or ``thermal_conductivity``.

    Examples
    --------
    >>> from easeoff.friction.ehl import LubricatedContact, Oil, smooth_film
    >>> contact = LubricatedContact(1e9, 0.02, 5.0, Oil(0.02, 1.1e-8), slide_to_roll=0.25)
    >>> film = smooth_film(contact, nodes=257)
    >>> print(f"{traction(contact, film.position, film.pressure, film.film).coefficient:.4f}")
    0.0076
    """
    checks.instance("contact", contact, LubricatedContact)
    oil = contact.oil
    position = checks.array("position", position, "m", ndim=1, fewest=2)
    steps = np.diff(position)
    if not (steps > 0.0).all() or np.ptp(steps) > SPACING_TOLERANCE * steps.mean():
        raise InputError(
            f"position with steps from {steps.min():g} to {steps.max():g}: must increase by equal distances [m]"
        )
    pressure = checks.array("pressure", pressure, "Pa", ndim=1, size=position.size)
    film = checks.array("film", film, "m", ndim=1, size=position.size)
    # Without a pressure nothing is sheared: at the ends of the domain rough surfaces may overlap on paper.
    if (film[pressure > 0.0] <= 0.0).any():
        raise InputError(f"film = {film[pressure > 0.0].min():g}: must be above 0 [m] under pressure")
    fluid_part = checks.array("fluid_part", fluid_part, least=0.0, most=1.0)
    rounding = -PRESSURE_ROUNDING * contact.hertz_pressure
    asperity_pressure = checks.array("asperity_pressure", asperity_pressure, "Pa", least=rounding)
    for name, values in (("fluid_part", fluid_part), ("asperity_pressure", asperity_pressure)):
        if values.ndim:
            checks.array(name, values, ndim=1, size=position.size)
    checks.positive("boundary_friction", boundary_friction, zero=True)
    checks.positive("effusivity", effusivity, "J/(m^2 K s^0.5)", infinite=True)
    checks.truth("thermal", thermal)
    loaded = np.maximum(pressure, 0.0)
    whole = loaded > 0.0  # where it is not, the film is ruptured
    thickening, _ = oil.log_viscosity(loaded)
    sliding = abs(np.sign(contact.sliding_velocity))
    solid = sliding * boundary_friction * ((1.0 - fluid_part) * loaded + asperity_pressure)

    def stress_at(rise: Array) -> tuple[Array, Array]:
        fall, by_rise = oil.thermal_thinning(rise)
        fluid, by_fall = _eyring(contact, np.where(whole, thickening - fall, 0.0), film)
        if oil.limiting_shear is not None:
            ceiling = oil.limiting_shear * loaded
            fluid, by_fall = np.minimum(fluid, ceiling), np.where(fluid < ceiling, by_fall, 0.0)
        part = np.where(whole, fluid_part, 0.0)
        return part * fluid + solid, -part * by_fall * by_rise

    rise = np.zeros_like(pressure)
    stress, _ = stress_at(rise)
    if thermal:
        if oil.temperature_viscosity is None or oil.thermal_conductivity is None:
            raise InputError("the thermal correction needs the oil's temperature_viscosity and thermal_conductivity")
        conductivity = oil.thermal_conductivity_at(loaded)
        within = abs(contact.sliding_velocity) * film / (12.0 * conductivity)  # rise over the surfaces by the stress
        for _ in range(HEAT_ITERATIONS):
            surface = film_temperature(contact, position, stress, film, math.inf, effusivity)
            last = stress
            # Where a film heats itself, less heat arises: the rise is the root of an increasing, concave function.
            rise = surface
            for _ in range(NEWTON_ITERATIONS):
                stress, slope = stress_at(rise)
                change = (surface + within * stress - rise) / (1.0 - within * slope)
                rise = np.maximum(rise + change, surface)
                if float(np.abs(change).max()) < TEMPERATURE_TOLERANCE:
                    break
            stress, _ = stress_at(rise)
            if float(np.abs(stress - last).sum()) <= HEAT_TOLERANCE * float(stress.sum()):
                break
            stress = 0.5 * (stress + last)
        else:
            stress = np.full_like(stress, math.nan)
    spacing = float(position[1] - position[0])
    over_load = spacing / contact.load
    return Traction(
        stress=math.copysign(1.0, contact.sliding_velocity) * stress,
        film=over_load * float((stress - solid).sum()),
        asperities=over_load * float(np.sum(solid)),
        temperature_rise=rise,
    )


def _eyring(contact: LubricatedContact, thickening: Array, film: Array) -> tuple[Array, Array]:
    """Shear stress of the film [Pa] >= 0 from ln(viscosity) over that at the inlet, and its derivative by that."""
    oil = contact.oil
    rate = abs(contact.sliding_velocity) / np.maximum(film, 1e-12)
    newtonian = oil.viscosity * np.exp(np.minimum(thickening, LOG_VISCOSITY_LIMIT)) * rate
    if math.isinf(oil.eyring_stress):
        return np.asarray(newtonian), np.asarray(newtonian)
    strain = newtonian / oil.eyring_stress
    return np.asarray(oil.eyring_stress * np.arcsinh(strain)), np.asarray(newtonian / np.hypot(1.0, strain))


def film_temperature(
    contact: LubricatedContact,
    position: Array,
    stress: Array,
    film: Array,
    conductivity: Array | float,
    effusivity: float,
) -> Array:
    """Mean temperature rise (n) over the film thickness [K], from |tau u_s| at nodes [m], [Pa], [m]; SI.

    Surfaces by the theory of moving heat sources (Blok; Jaeger): the integral of heat over the root of the upstream
    distance, by effusivity times root velocity of both; conduction in the film adds heat times thickness / (12 k).
    """
    heat = np.abs(stress * contact.sliding_velocity)
    spacing = float(position[1] - position[0])
    # Heat constant around each node: the integral over one spacing of 1 / sqrt(distance).
    edge = np.maximum(np.arange(position.size + 1) - 0.5, 0.0)
    weight = 2.0 * np.sqrt(spacing) * np.diff(np.sqrt(edge))
    first, second = (contact.rolling_velocity * (1.0 + side * contact.slide_to_roll / 2.0) for side in (1.0, -1.0))
    passing = math.sqrt(math.pi) * effusivity * (math.sqrt(abs(first)) + math.sqrt(abs(second)))
    surface = np.convolve(heat, weight)[: position.size] / passing
    return np.asarray(surface + heat * film / (12.0 * conductivity))
