"""Film, rupture and touching asperities as one complementarity condition a node, and its semismooth Newton method.

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
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ....core.checks import frozen_arrays
from ....core.stored_status import StoredStatus
from ..rolling_contact.asperities import Asperities
from ..rolling_contact.lubricated_contact import LubricatedContact
from . import hierarchical_matrix as hierarchical
from .elastic_deflection import Deflection
from .reynolds_equation import Balance, History, balance, chained

Array = NDArray[np.float64]
States = NDArray[np.int8]

#: Load in units of half width times Hertz pressure.
HERTZ_LOAD = 0.5 * math.pi
#: Change of the pressures, in units of the Hertz pressure, at which the iteration has converged.
PRESSURE_TOLERANCE = 1e-9


class State(StoredStatus):
    """Which condition holds at a node; the order is that of the members of the condition.

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
    """Limits and scales of the steps of the iteration.

    Parameters
    ----------
    step_limit
        Largest change of a pressure in one step, in units of the Hertz pressure.
    gap_scale
        Scale of the gap in the condition, in units of the deflection under a node's own pressure. Below 1, a node that
        penetrates is taken to touch regardless of its mass balance.
    iterations
        After as many the iteration gives up.
    """

    step_limit: float
    gap_scale: float = 0.1
    iterations: int = 40


#: Smooth surfaces: short steps from a dry contact.
SMOOTH = (Pace(0.3), Pace(3.0))
#: Rough surfaces: the scale and the limit decide only whether the iteration falls into a cycle, so that another pair
#: that starts again from the same point ends most of the cycles of the first.
ROUGH = (Pace(3.0, 0.1, 30), Pace(10.0, 0.1, 40), Pace(10.0, 1e-4, 40), Pace(3.0, 1.0, 60), Pace(1.0, 0.1, 60))


@frozen_arrays
@dataclass(frozen=True, eq=False)
class Problem:
    """One steady state or one step in time, in units of the Hertz contact.

    Parameters
    ----------
    contact
        Operating conditions.
    deflection
        Of the surfaces, on the grid.
    profile
        Gap of the undeformed surfaces but for the approach: the parabola less the heights of both surfaces (n).
    touching_film
        H_c; minus infinity for surfaces that cannot touch.
    history
        The steps in time before; none for a steady state.
    lacking
        V that arrives at each node from upstream (n).
    asperities
        Roughness by its statistics, which carries a part of the pressure; H is then the separation of the mean planes.
    """

    contact: LubricatedContact
    deflection: Deflection
    profile: Array
    touching_film: float = -math.inf
    history: History | None = None
    lacking: Array | float = 0.0
    asperities: Asperities | None = None


@frozen_arrays
@dataclass(frozen=True, eq=False)
class Point:
    """A point of the iteration.

    Parameters
    ----------
    pressure, film
        P and H (n).
    approach
        H_0.
    balance
        Of the lubricant's mass.
    lack
        V (n).
    gap
        g (n).
    fluid, fluid_by_film
        Pressure of the lubricant, and its derivative by H: P itself, or what statistical asperities leave of it (n).
    clearance
        Mean thickness of the film: H, or the mean gap between statistically rough surfaces (n).
    """

    pressure: Array
    film: Array
    approach: float
    balance: Balance
    lack: Array
    gap: Array
    fluid: Array
    fluid_by_film: Array
    clearance: Array


@frozen_arrays
@dataclass(frozen=True, eq=False)
class Outcome:
    """End of an iteration.

    Parameters
    ----------
    point
        Where it ended.
    state
        Values of ``State`` (n).
    iterations
        Of all attempts together.
    converged
        Whether the last change was below the tolerance with the states settled.
    history
        Largest violation of the condition at each step of the last attempt.
    """

    point: Point
    state: States
    iterations: int
    converged: bool
    history: tuple[float, ...] = field(default=())

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
        contact,
        deflection.spacing,
        fluid,
        clearance,
        history=problem.history,
        touching_film=problem.touching_film,
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
    """Which member of the condition is the smallest, each in units of pressure."""
    own = problem.deflection.influence[[2, 1, 0, 1]]  # at the distances of hierarchical.OFFSETS
    by_own_pressure = np.abs(point.balance.by_pressure[2] + own @ point.balance.by_film)
    by_own_pressure[[0, -1]] = 1.0
    members = np.stack(
        [
            point.lack / by_own_pressure,
            point.fluid,
            point.gap / (pace.gap_scale * abs(problem.deflection.influence[0])),
        ]
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
