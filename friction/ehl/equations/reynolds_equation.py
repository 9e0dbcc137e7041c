"""The Reynolds equation on the grid: residual of the mass balance of each node, and its derivatives by bands.

In units of the Hertz contact (X = x / a, P = p / p_h, H = h R / a^2, time in a / u) the flow through the middle between
two nodes and the balance of a node are

    q = rho H - eps dP/dX,                      eps = rho H^3 phi / (eta lambda),
    F(i) = q(i+1/2) - q(i-1/2) + dX d(rho H)/dT.

F vanishes where the film is whole, and is positive where it breaks: more leaves than arrives. phi is the flow factor of
an Eyring fluid that is sheared much faster than it is pressed along: cosh of the asinh of the Newtonian shear stress
over the Eyring stress (Ehret, Dowson and Taylor, Proceedings of the Royal Society A 454 (1998) 763).

The flow with the surfaces, m = rho H, is taken from upstream to second order, (3 m(i) - m(i-1)) / 2. In time, it and
the storage are one derivative along the path of the mean flow, which advances by one node a step:

    dX (d/dX + d/dT) m = (3 m(i) - 4 m(i-1) of the last step + m(i-2) of the one before) / 2.

What the flow carries is neither smeared nor made to ripple by it, and a state that does not change is one of the steady
equations. The flow under pressure has the mean of rho phi / eta of both nodes, but the harmonic mean of their H^3:
where a gap closes, nothing flows through. Where asperities touch, only the part of P that the lubricant carries drives
it, see ``fluid_part``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ....core.checks import frozen_arrays
from ..rolling_contact.lubricated_contact import LubricatedContact

Array = NDArray[np.float64]

#: Smallest film thickness in the cube of the flow under pressure, as a fraction of the unit a^2 / R. The iteration may
#: pass through thinner and negative films; no answer may, see ``film_certificate``.
THINNEST_FILM = 1e-9
#: Largest ln(viscosity) that is told apart from a solid: the flow under pressure is nil long before.
LOG_VISCOSITY_LIMIT = 100.0


@dataclass(frozen=True)
class History:
    """Storage of the steps in time before; in one step the mean flow advances by one node.

    Parameters
    ----------
    storage
        What rho H of the new step is compared with, along the path of the mean flow (n): rho H of the node upstream a
        step ago (first order), or twice that less half of the next node upstream two steps ago (second order).
    weight
        Factor of the new rho H: 1 or 3/2.
    """

    storage: Array
    weight: float


@frozen_arrays
@dataclass(frozen=True)
class Balance:
    """Mass balance of all nodes.

    Parameters
    ----------
    residual
        F (n); zero at both ends.
    flow
        q between the nodes (n - 1); in time with m of the node upstream.
    by_pressure, by_film
        Derivatives of F(i) by P(i + k) at fixed H and by H(i + k) at fixed P, for k of ``OFFSETS`` (4, n).
    """

    residual: Array
    flow: Array
    by_pressure: Array
    by_film: Array


def balance(
    contact: LubricatedContact,
    spacing: float,
    pressure: Array,
    film: Array,
    *,
    history: History | None = None,
    touching_film: float = -math.inf,
) -> Balance:
    """Mass balance and its derivatives.

    Parameters
    ----------
    contact
        Operating conditions.
    spacing
        Distance of the nodes in half widths.
    pressure, film
        P and H (n); negative values, which occur on the way to a solution, count as none and as next to none.
    history
        The steps before; none for the steady state.
    touching_film
        H_c, see ``fluid_part``.
    """
    oil, unit = contact.oil, contact.hertz_pressure
    positive = np.maximum(pressure, 0.0)
    inside = pressure >= 0.0
    density, density_slope = oil.relative_density(unit * positive)
    density_slope = np.where(inside, unit * density_slope, 0.0)
    thick = np.maximum(film, THINNEST_FILM)
    mobility, mobility_slope, mobility_by_film = _mobility(contact, positive, thick, density, density_slope)
    mobility_slope = np.where(inside, mobility_slope, 0.0)
    mass, mass_slope = density * film, density_slope * film

    # Flow under pressure through the middles.
    left, right = slice(None, -1), slice(1, None)
    cube = thick**3
    total = cube[left] + cube[right]
    shared = 2.0 * cube[left] * cube[right] / total
    mean = 0.5 * (mobility[left] + mobility[right])
    part, part_slope = fluid_part(film, touching_film)
    fluid, fluid_by_film = part * pressure, part_slope * pressure
    slope = (fluid[right] - fluid[left]) / spacing
    conductance = mean * shared
    # d(shared)/dH: 2 c_r^2 / (c_l + c_r)^2 * 3 H_l^2, and the same with left and right exchanged.
    shared_left = 6.0 * (cube[right] / total) ** 2 * thick[left] ** 2
    shared_right = 6.0 * (cube[left] / total) ** 2 * thick[right] ** 2
    driving = conductance / spacing
    q_film_left = driving * fluid_by_film[left] - slope * (mean * shared_left + 0.5 * mobility_by_film[left] * shared)
    q_film_right = -driving * fluid_by_film[right] - slope * (
        mean * shared_right + 0.5 * mobility_by_film[right] * shared
    )
    q_pressure_left = driving * part[left] - slope * shared * 0.5 * mobility_slope[left]
    q_pressure_right = -driving * part[right] - slope * shared * 0.5 * mobility_slope[right]

    # Flow with the surfaces: the first middle has no second node upstream and takes the mean of its two. In time, the
    # comparison along the path of the mean flow stands for it.
    own = np.full(mass.size - 1, 1.5 if history is None else 0.0)
    before, after = np.full_like(own, -0.5 if history is None else 0.0), np.zeros_like(own)
    if history is None:
        own[0], before[0], after[0] = 0.5, 0.0, 0.5
    upstream = np.concatenate([mass[:1], mass[:-2]])
    flow = own * mass[left] + before * upstream + after * mass[right] - conductance * slope

    residual = np.zeros_like(mass)
    residual[1:-1] = np.diff(flow)
    by_pressure, by_film = np.zeros((4, mass.size)), np.zeros((4, mass.size))
    for bands, node, l_part, r_part in (
        (by_pressure, mass_slope, q_pressure_left, q_pressure_right),
        (by_film, density, q_film_left, q_film_right),
    ):
        # Flow out, through the middle to the right of node i: nodes i - 1, i, i + 1.
        q_before = before * np.concatenate([node[:1], node[:-2]])
        q_own = own * node[left] + l_part
        q_after = after * node[right] + r_part
        bands[1, 1:-1] += q_before[1:]
        bands[2, 1:-1] += q_own[1:]
        bands[3, 1:-1] += q_after[1:]
        # Flow in, through the middle to the left of node i: nodes i - 2, i - 1, i.
        bands[0, 1:-1] -= q_before[:-1]
        bands[1, 1:-1] -= q_own[:-1]
        bands[2, 1:-1] -= q_after[:-1]
    if history is not None:
        residual[1:-1] += (history.weight * mass - history.storage)[1:-1]
        by_pressure[2, 1:-1] += history.weight * mass_slope[1:-1]
        by_film[2, 1:-1] += history.weight * density[1:-1]
        flow += mass[left]
    return Balance(residual, flow, by_pressure, by_film)


def chained(flow: Balance, pressure_by_film: Array, film_by_film: Array) -> Balance:
    """Balance of a fluid pressure and a mean gap that depend on the separation: derivatives by separation for H.

    Parameters
    ----------
    flow
        With derivatives by the lubricant's own pressure and the mean gap.
    pressure_by_film, film_by_film
        Derivatives of both by the separation (n).
    """
    by_film = np.zeros_like(flow.by_film)
    nodes = pressure_by_film.size
    for k, offset in enumerate((-2, -1, 0, 1)):
        row = slice(max(0, -offset), nodes - max(0, offset))
        column = slice(max(0, offset), nodes + min(0, offset))
        by_film[k, row] = flow.by_film[k, row] * film_by_film[column]
        by_film[k, row] += flow.by_pressure[k, row] * pressure_by_film[column]
    return replace(flow, by_film=by_film)


def fluid_part(film: Array, touching_film: float) -> tuple[Array, Array]:
    """Part of the pressure that the lubricant carries, and its derivative by H.

    All of it from twice the film of touching asperities on, none where they touch, with a straight line in between.
    The rest is carried by the layers on the surfaces and drives no flow: otherwise the load of an asperity would press
    the lubricant out of its surroundings, or into them.
    """
    if math.isinf(touching_film):
        return np.ones_like(film), np.zeros_like(film)
    part = film / touching_film - 1.0
    between = (part > 0.0) & (part < 1.0)
    return np.clip(part, 0.0, 1.0), np.where(between, 1.0 / touching_film, 0.0)


def _mobility(
    contact: LubricatedContact, pressure: Array, film: Array, density: Array, density_slope: Array
) -> tuple[Array, Array, Array]:
    """Return rho phi / (eta lambda), and its derivatives by P and H."""
    thickening, slope = contact.oil.log_viscosity(contact.hertz_pressure * pressure)
    slope = np.where(thickening < LOG_VISCOSITY_LIMIT, contact.hertz_pressure * slope, 0.0)
    viscosity = np.exp(np.minimum(thickening, LOG_VISCOSITY_LIMIT))
    newtonian = density / (viscosity * contact.reynolds_number)
    # Newtonian shear stress over the Eyring stress.
    strain = contact.oil.viscosity * abs(contact.sliding_velocity) / contact.film_scale
    shear = strain / contact.oil.eyring_stress * viscosity / film
    factor = np.sqrt(1.0 + shear**2)
    softening = shear**2 / (1.0 + shear**2)  # d ln(phi) / d ln(shear)
    value = newtonian * factor
    by_pressure = value * (density_slope / density - slope * (1.0 - softening))
    return value, by_pressure, -value * softening / film
