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

Film, rupture and touching asperities are one complementarity condition a node, solved by a semismooth Newton method.
The lubricated contact asks at each node for

    P >= 0,   V >= 0,   g >= 0,   and one of them zero:    min(P, V, g) = 0.

P is the pressure, V what the film lacks to fill the gap, and g = H - H_c how far the gap is wider than the film left
between touching asperities. Where V vanishes the film is whole and P follows from Reynolds' equation; where P vanishes
the film is ruptured; where g vanishes the asperities touch. In a steady state V is the residual F of the mass balance
(Reynolds' condition at the end of the film). In time V(i) = F(i) + V(i-1) of the step before: what is lacking moves on
with the mean velocity, one node a step, so that no lubricant is made or lost. With the balance of the load,

    dX sum(P) = pi / 2,

these are as many equations as unknowns: the pressures, and the approach H_0 of the surfaces.

Each of the three is divided by a positive scale, and the smallest says which of them the next Newton step sets to zero.
The linear system is that of ``hierarchical_matrix``, with the derivative by H_0 as a second right-hand side.

The certificate of an answer holds the violations of each condition by pressures and approach. Everything is evaluated
anew from pressures and approach, never taken from the iteration. All entries are dimensionless; zero is perfect.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import astuple, dataclass, field, fields, replace

import numpy as np
from numpy.typing import NDArray

from ...core.arrays import RealArray as Array, record
from ...core.attributes import StoredStatus
from . import hierarchical_matrix as hierarchical
from .asperities import Asperities
from .hierarchical_matrix import Deflection
from .lubricated_contact import LubricatedContact

#: Smallest film thickness in the cube of the flow under pressure, as a fraction of the unit a^2 / R. The iteration may
#: pass through thinner and negative films; no answer may, see ``Certificate``.
THINNEST_FILM = 1e-9
#: Largest ln(viscosity) that is told apart from a solid: the flow under pressure is nil long before.
LOG_VISCOSITY_LIMIT = 100.0


@dataclass(frozen=True)
class History:
    """Storage of the steps in time before; in one step the mean flow advances by one node."""

    #: rho H on the mean flow's path (n): the node upstream a step ago, or twice that less half of two steps ago.
    storage: Array
    weight: float  # of the new rho H: 1 or 3/2


@record(frozen=True)
class Balance:
    """Mass balance of all nodes."""

    residual: Array  # (n), zero at both ends
    flow: Array  # between the nodes (n - 1); in time with that upstream
    by_pressure: Array  # of F(i) by P(i + k) at fixed H, for k of OFFSETS (4, n)
    by_film: Array  # by H(i + k) at fixed P (4, n)


def balance(
    contact: LubricatedContact,
    spacing: float,
    pressure: Array,
    film: Array,
    *,
    history: History | None = None,
    touching_film: float = -math.inf,
) -> Balance:
    """Mass balance of P and H (n) and its derivatives; negative values count as none and as next to none.

    Steady without a history; spacing in half widths.
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
    centre = np.full(mass.size - 1, 1.5 if history is None else 0.0)
    before, after = np.full_like(centre, -0.5 if history is None else 0.0), np.zeros_like(centre)
    if history is None:
        centre[0], before[0], after[0] = 0.5, 0.0, 0.5
    upstream = np.concatenate([mass[:1], mass[:-2]])
    flow = centre * mass[left] + before * upstream + after * mass[right] - conductance * slope

    residual = np.zeros_like(mass)
    residual[1:-1] = np.diff(flow)
    by_pressure, by_film = np.zeros((4, mass.size)), np.zeros((4, mass.size))
    for bands, node, l_part, r_part in (
        (by_pressure, mass_slope, q_pressure_left, q_pressure_right),
        (by_film, density, q_film_left, q_film_right),
    ):
        # Flow out, through the middle to the right of node i: nodes i - 1, i, i + 1.
        q_before = before * np.concatenate([node[:1], node[:-2]])
        q_own = centre * node[left] + l_part
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
    """Balance of a fluid pressure and a mean gap that depend on the separation: derivatives by separation for H."""
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

    All from twice the film of touching asperities on, none where they touch, a straight line between. The rest drives
    no flow: it would press the lubricant out of an asperity's surroundings, or into them.
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


States = NDArray[np.int8]

#: Load in units of half width times Hertz pressure.
HERTZ_LOAD = 0.5 * math.pi
#: Change of the pressures, in units of the Hertz pressure, at which the iteration has converged.
PRESSURE_TOLERANCE = 1e-9


class State(StoredStatus):
    """Condition that holds at a node; the order is that of the members of the condition.

    Examples
    --------
    >>> [state.name for state in State]
    ['FILM', 'RUPTURED', 'TOUCHING']
    """

    FILM = 0
    RUPTURED = 1
    TOUCHING = 2


@dataclass(frozen=True)
class Pace:
    """Limits and scales of the steps of the iteration."""

    step_limit: float  # of a pressure, over the Hertz pressure
    #: Over a node's own deflection; below 1 a penetrating node touches regardless of its mass balance.
    gap_scale: float = 0.1
    iterations: int = 40


#: Smooth surfaces: short steps from a dry contact.
SMOOTH = (Pace(0.3), Pace(3.0))
#: Rough surfaces: the scale and the limit decide only whether the iteration falls into a cycle, so that another pair
#: that starts again from the same point ends most of the cycles of the first.
ROUGH = (Pace(3.0, 0.1, 30), Pace(10.0, 0.1, 40), Pace(10.0, 1e-4, 40), Pace(3.0, 1.0, 60), Pace(1.0, 0.1, 60))


@record(frozen=True, eq=False)
class Problem:
    """One steady state or one step in time, in units of the Hertz contact."""

    contact: LubricatedContact
    deflection: Deflection
    profile: Array  # gap of the undeformed surfaces but for the approach (n)
    touching_film: float = -math.inf  # H_c; -inf: surfaces cannot touch
    history: History | None = None
    lacking: Array | float = 0.0  # V that arrives at each node from upstream (n)
    asperities: Asperities | None = None  # statistical roughness; H is then the mean planes' separation


@record(frozen=True, eq=False)
class Point:
    """A point of the iteration, with P, H and other fields of the nodes (n)."""

    pressure: Array
    film: Array
    approach: float  # H_0
    balance: Balance
    lack: Array
    gap: Array
    fluid: Array  # pressure of the lubricant: P, or what asperities leave
    fluid_by_film: Array
    clearance: Array  # mean film: H, or the mean gap of rough surfaces


@record(frozen=True, eq=False)
class Outcome:
    """End of an iteration."""

    point: Point
    state: States
    iterations: int
    converged: bool
    history: tuple[float, ...] = field(default=())  # largest violation at each step of the last attempt

    @property
    def pressure(self) -> Array:
        """Pressures (n); where the film is ruptured, without the lubricant's, which is rounding of either sign."""
        return np.where(self.state == State.RUPTURED, self.point.pressure - self.point.fluid, self.point.pressure)


def evaluate(problem: Problem, pressure: Array, approach: float) -> Point:
    """Film, mass balance and gap at given pressures and approach."""
    contact, deflection = problem.contact, problem.deflection
    film = problem.profile + approach + deflection(pressure)
    fluid, fluid_by_film, clearance, by_film = pressure, np.zeros_like(film), film, np.ones_like(film)
    if problem.asperities is not None:
        separation = contact.film_scale * film
        carried, slope = problem.asperities.pressure(separation, contact.contact_modulus)
        fluid = pressure - carried / contact.hertz_pressure
        fluid_by_film = -contact.film_scale / contact.hertz_pressure * slope
        clearance, by_film = problem.asperities.mean_gap(separation)
        clearance = clearance / contact.film_scale
    flow = balance(
        contact, deflection.spacing, fluid, clearance, history=problem.history, touching_film=problem.touching_film
    )
    if problem.asperities is not None:
        flow = chained(flow, fluid_by_film, by_film)
    gap = film - problem.touching_film
    return Point(pressure, film, approach, flow, flow.residual + problem.lacking, gap, fluid, fluid_by_film, clearance)


def solve(problem: Problem, pressure: Array, approach: float, paces: Sequence[Pace]) -> Outcome:
    """Find pressures and approach, one pace after the other until one of them converges.

    Parameters
    ----------
    problem
        The problem.
    pressure
        Where to start; zero at both ends (n).
    approach
        Of the surfaces, where to start.
    paces
        To be tried in turn.

    Returns
    -------
    Outcome
        Of the pace that converged, or of the last.
    """
    spent = 0
    for pace in paces:
        outcome = _attempt(problem, pressure, approach, pace, spent)
        spent = outcome.iterations
        if outcome.converged:
            break
    return outcome


def _attempt(problem: Problem, pressure: Array, approach: float, pace: Pace, spent: int) -> Outcome:
    point = evaluate(problem, pressure, approach)
    state, before = _states(problem, point, pace), None
    violations: list[float] = []
    for iteration in range(1, pace.iterations + 1):
        try:
            change, lift = _newton_step(problem, point, state)
        except np.linalg.LinAlgError:
            break
        size = float(np.abs(change).max())
        if not math.isfinite(size):
            break
        fraction = min(1.0, pace.step_limit / size) if size > 0.0 else 1.0
        point = evaluate(problem, point.pressure + fraction * change, point.approach + fraction * lift)
        settled = before is not None and np.array_equal(before, state)
        if fraction == 1.0 and settled and size < PRESSURE_TOLERANCE:
            return Outcome(point, state, spent + iteration, True, tuple(violations))
        before, state = state, _states(problem, point, pace)
        violations.append(size)
    return Outcome(point, state, spent + iteration, False, tuple(violations))


def _states(problem: Problem, point: Point, pace: Pace) -> States:
    """Number of the smallest member of the condition at each node, in units of pressure."""
    influence = problem.deflection.influence[[2, 1, 0, 1]]  # at the distances of hierarchical.OFFSETS
    by_own_pressure = np.abs(point.balance.by_pressure[2] + influence @ point.balance.by_film)
    by_own_pressure[[0, -1]] = 1.0
    members = np.stack(
        [point.lack / by_own_pressure, point.fluid, point.gap / (pace.gap_scale * abs(problem.deflection.influence[0]))]
    )
    members[State.RUPTURED, [0, -1]] = -math.inf  # no pressure at the ends
    return np.asarray(np.argmin(members, axis=0), dtype=np.int8)


def _newton_step(problem: Problem, point: Point, state: States) -> tuple[Array, float]:
    """Changes of pressures and approach that set the chosen members and the error of the load to zero, linearised."""
    spacing = problem.deflection.spacing
    whole, touching = state == State.FILM, state == State.TOUCHING
    ruptured = state == State.RUPTURED
    value = np.choose(state, [point.lack, point.fluid, point.gap])
    by_pressure = np.where(whole, point.balance.by_pressure, 0.0)
    by_pressure[2, ruptured] = 1.0
    by_film = np.where(whole, point.balance.by_film, 0.0)
    by_film[2, touching] = 1.0
    by_film[2, ruptured] = point.fluid_by_film[ruptured]
    # The influence is unit * (logarithm of hats + ln spacing). The second part lifts all nodes alike: it is left out of
    # the matrix and taken back from the approach.
    unit = -spacing / math.pi
    sides = np.stack([-value, by_film.sum(axis=0)], axis=1)
    by_value, by_lift = hierarchical.solve(by_pressure, unit * by_film, sides).T
    missing = HERTZ_LOAD / spacing - float(point.pressure.sum())
    total = float(by_lift.sum())
    if total == 0.0:
        raise np.linalg.LinAlgError("no node feels the approach")
    lift = (float(by_value.sum()) - missing) / total
    change = by_value - lift * by_lift
    return change, lift - unit * math.log(spacing) * float(change.sum())


#: What each entry must reach.
CERTIFICATE_TOLERANCE = 1e-8


class Status(StoredStatus):
    """End of a solve.

    Examples
    --------
    >>> Status(0).name
    'CERTIFIED'
    """

    CERTIFIED = 0
    NOT_CONVERGED = 1
    NOT_CERTIFIED = 2
    FAILED = 3
    NOT_RUN = 4


@dataclass(frozen=True)
class Certificate:
    """Violations of the conditions by an answer.

    Parameters
    ----------
    load
        ``|integral of P - load| / load``.
    negative_pressure
        max(-P, 0) of the lubricant, in units of the Hertz pressure.
    negative_lack
        max(-V, 0) over the mean flow: more lubricant than the gap holds.
    negative_gap
        max(-g, 0), penetration, over the film left between touching asperities; 0 where none can touch.
    negative_film
        How far the film is below the thinnest that the mass balance tells from none, over that: smooth surfaces, which
        have no asperities to touch with, may not pass through one another either.
    complementarity
        Largest of ``min(P, |V|, g)``, each by its scale: somewhere a node is neither film, nor ruptured, nor touching.

    Examples
    --------
    >>> Certificate(1e-12, 0.0, 0.0, 0.0, 0.0, 1e-9).passes()
    True
    """

    load: float
    negative_pressure: float
    negative_lack: float
    negative_gap: float
    negative_film: float
    complementarity: float

    @property
    def worst(self) -> float:
        """The largest of all violations; infinite if one of them is not a number."""
        entries: tuple[float, ...] = astuple(self)
        return math.inf if any(map(math.isnan, entries)) else max(entries)

    def passes(self, tolerance: float = CERTIFICATE_TOLERANCE) -> bool:
        """True if every violation is within the tolerance."""
        return self.worst <= tolerance


def certify(problem: Problem, pressure: Array, approach: float) -> Certificate:
    """Measure how well pressures and approach solve a problem.

    Parameters
    ----------
    problem
        The problem.
    pressure
        In units of the Hertz pressure (n).
    approach
        Of the surfaces, in units of the film thickness.

    Returns
    -------
    Certificate
        Infinite throughout where a number is not finite.
    """
    if not (np.isfinite(pressure).all() and math.isfinite(approach)):
        return Certificate(*(math.inf,) * len(fields(Certificate)))
    point = evaluate(problem, pressure, approach)
    inner = slice(1, -1)
    flow = float(np.abs(point.balance.flow).mean())
    lack = point.lack[inner] / flow
    can_touch = math.isfinite(problem.touching_film)
    gap = point.gap[inner] / problem.touching_film if can_touch else np.full_like(lack, math.inf)
    # Asperities also touch where they pass the ends of the domain, which carry no pressure.
    clearance = point.clearance[inner] if can_touch else point.clearance
    load = problem.deflection.spacing * float(pressure.sum())
    shared = np.minimum(np.minimum(point.fluid[inner], np.abs(lack)), np.abs(gap))
    return Certificate(
        load=abs(load - HERTZ_LOAD) / HERTZ_LOAD,
        negative_pressure=max(-float(point.fluid.min()), 0.0) + float(np.abs(point.fluid[[0, -1]]).max()),
        negative_lack=max(-float(lack.min()), 0.0),
        negative_gap=max(-float(gap.min()), 0.0),
        negative_film=max(1.0 - float(clearance.min()) / THINNEST_FILM, 0.0),
        complementarity=max(float(shared.max()), 0.0),
    )


def judge(converged: bool, certificate: Certificate) -> Status:
    """Status of an answer: the certificate alone decides whether it is one."""
    if certificate.passes():
        return Status.CERTIFIED
    return Status.NOT_CERTIFIED if converged else Status.NOT_CONVERGED
