"""Rough surfaces moving through the contact: implicit steps in time from the smooth film.

The surfaces move with their own velocities u1 and u2, the lubricant on average with their mean u; a step in time lets
the mean advance by one node. With that step, what a broken film lacks moves on by exactly one node, and is conserved.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core import checks
from ...core.arrays import Bools, RealArray as Array, record
from ...core.attributes import labelled
from ...core.errors import InputError
from ...core.memory import require_memory
from . import reynolds_equation as reynolds
from .asperities import Profile, smooth
from .film import FEWEST_NODES, MOST_NODES, Film, domain, touching_start
from .hierarchical_matrix import Deflection
from .lubricated_contact import LubricatedContact
from .reynolds_equation import History, Outcome, Point, Problem, State, States, Status
from .shear_traction import BOUNDARY_FRICTION, traction

#: Film left between touching asperities [m]: a few layers of molecules.
TOUCHING_FILM = 4e-9
#: The inlet of rough passages, see ``domain``: less than the smooth film's, for the sake of the nodes.
ROUGH_INLET_GAP_RATIO = 25.0


@record(frozen=True, eq=False)
class RoughPassage:
    """Passage of rough surfaces through the contact, step by step; (t) arrays unless said otherwise.

    Parameters
    ----------
    contact
        Operating conditions.
    position
        Of the nodes (n) [m].
    time
        At the end of each step [s].
    settled
        Whether the step counts for averages (t): the heights have their full size and the smooth start is over.
    status
        Values of ``Status`` (t); of steps that are not certified the other numbers are NaN.
    iterations
        Of the Newton method (t).
    violation
        Largest entry of the certificate [1].
    leak
        Lubricant that a step has made (positive) or lost, over what flows through the contact in a step [1]: nil but
        for rounding where the step is certified. The steps after one that is not are certified for what is left.
    film_friction, asperity_friction
        Friction coefficients of film and touching asperities [1].
    asperity_share
        Part of the load that touching asperities carry [1].
    minimum_film, mean_film
        Smallest and mean film thickness within the dry contact [m].
    pressure, film, state
        At the steps ``kept`` (k, n): [Pa], [m], values of ``State``; NaN, NaN and nothing meant where the step is not
        certified.
    kept
        Numbers of the steps whose fields were kept (k).

    Examples
    --------
    >>> from easeoff.friction.ehl import LubricatedContact, Oil, generated_profile, rough_passage
    >>> contact = LubricatedContact(1e9, 0.02, 5.0, Oil(0.02, 1.1e-8), slide_to_roll=0.25)
    >>> profile = generated_profile(0.1e-6, 40e-6, 1e-3, seed=1)
    >>> passage = rough_passage(contact, profile, steps=40, nodes=65, settle=30, keep=20)
    >>> passage.time.size, passage.kept.tolist()
    (40, [20, 40])
    """

    contact: LubricatedContact
    position: Array
    time: Array
    settled: Bools
    status: NDArray[np.int8]
    iterations: NDArray[np.int_]
    violation: Array
    leak: Array
    film_friction: Array
    asperity_friction: Array
    asperity_share: Array
    minimum_film: Array
    mean_film: Array
    pressure: Array
    film: Array
    state: States
    kept: NDArray[np.int_]

    @property
    def leakage(self) -> float:
        """Lubricant made and lost by steps that are not certified, over what flows through in all steps [1]."""
        return float(np.abs(self.leak).sum() / self.leak.size)

    @property
    def certified_share(self) -> float:
        """Part of the settled steps that is certified [1]."""
        return float(np.mean(self.status[self.settled] == Status.CERTIFIED))

    def average(self, name: str) -> float:
        """Mean of one of the quantities by step over the settled, certified steps; NaN if there are none.

        What it leaves out is told by ``certified_share``, and what the steps left out do to the others by ``leakage``.
        """
        values = getattr(self, name)[self.settled & (self.status == Status.CERTIFIED)]
        return float(values.mean()) if values.size else math.nan

    @property
    def friction_coefficient(self) -> float:
        """Mean friction coefficient [1] (dissertation, equation 5.9)."""
        return self.average("film_friction") + self.average("asperity_friction")


def rough_passage(
    contact: LubricatedContact,
    first: Profile = smooth,
    second: Profile = smooth,
    *,
    steps: int,
    nodes: int = 513,
    span: tuple[float, float] | None = None,
    ramp: int = 20,
    settle: int | None = None,
    touching_film: float = TOUCHING_FILM,
    order: int = 2,
    keep: int = 0,
    boundary_friction: float = BOUNDARY_FRICTION,
    thermal: bool = False,
) -> RoughPassage:
    """Let two surfaces roll and slide through the contact.

    Parameters
    ----------
    contact
        Operating conditions.
    first, second
        Heights [m] of the faster surface (for a positive slide-to-roll ratio) and of the other, by the point on it [m].
    steps
        Steps in time; with ``nodes`` of them the mean flow passes once through the domain.
    nodes
        Nodes of the grid. A correlation length should have five or more.
    span
        Ends of the domain in half widths; those of ``domain`` for a gap of 25 times the film at the inlet if not
        given.
    ramp
        Steps over which the heights grow from nothing to their size; 0 for profiles that start outside the domain.
    settle
        Steps before averages begin; by default those that bring the flow from the inlet to the middle, or the ramp if
        that takes longer.
    touching_film
        Film left between touching asperities [m].
    order
        Order of the steps in time. Either carries the film along without damping.
    keep
        Keep the fields of every so many steps; 0 keeps none.
    boundary_friction, thermal
        See ``traction``.

    Returns
    -------
    RoughPassage
        If the film of smooth surfaces cannot be found, a passage whose steps all have the status ``FAILED``.

    Raises
    ------
    InputError
        If a number cannot be used, or the record needs more memory than is free.

    Examples
    --------
    >>> from easeoff.friction.ehl import LubricatedContact, Oil, generated_profile
    >>> contact = LubricatedContact(1e9, 0.02, 5.0, Oil(0.02, 1.1e-8), slide_to_roll=0.25)
    >>> profile = generated_profile(0.1e-6, 40e-6, 1e-3, seed=1)
    >>> passage = rough_passage(contact, profile, steps=40, nodes=65, settle=30, keep=20)
    >>> print(f"{passage.certified_share:.0%} of the steps, friction coefficient {passage.friction_coefficient:.4f}")
    100% of the steps, friction coefficient 0.0079
    """
    checks.instance("first", first, Callable)
    checks.instance("second", second, Callable)
    checks.whole("steps", steps, 1, STEP_LIMIT)
    nodes = checks.whole("nodes", nodes, FEWEST_NODES, MOST_NODES)
    for name, value in (("ramp", ramp), ("keep", keep), ("settle", 0 if settle is None else settle)):
        checks.whole(name, value, 0, STEP_LIMIT)
    checks.whole("order", order, 1, 2)
    checks.positive("touching_film", touching_film, "m")
    rows = steps // keep if keep else 0
    size = STEP_SIZE * steps + KEPT_NODE_SIZE * rows * nodes
    require_memory(f"steps = {steps}, nodes = {nodes}, keep = {keep}", size, "the passage")
    span = domain(contact, ROUGH_INLET_GAP_RATIO) if span is None else span
    start = touching_start(contact, nodes, span, touching_film)
    x = start.position / contact.half_width
    settle = max(ramp, round(-x[0] / (x[1] - x[0]))) if settle is None else settle
    if settle >= steps:
        raise InputError(f"steps = {steps}: must be above {settle}, after which averages begin")
    kept = keep * np.arange(1, rows + 1)
    records = {name: np.full(steps, math.nan) for name in _RECORDED}
    status = np.full(steps, Status.FAILED, dtype=np.int8)
    iterations = np.zeros(steps, dtype=int)
    pressure, film = np.full((kept.size, nodes), math.nan), np.full((kept.size, nodes), math.nan)
    states = np.zeros((kept.size, nodes), dtype=np.int8)
    if start.certified:
        march = _March(contact, x, start, touching_film / contact.film_scale, order)
        for step in range(1, steps + 1):
            outcome, problem = march.advance(min(1.0, step / ramp) if ramp else 1.0, first, second)
            point = outcome.point
            certificate = reynolds.certify(problem, point.pressure, point.approach)
            at = step - 1
            status[at], iterations[at] = reynolds.judge(outcome.converged, certificate), outcome.iterations
            records["violation"][at], records["leak"][at] = certificate.worst, march.leak
            if status[at] == Status.CERTIFIED:
                values = _record(start.position, problem, outcome, boundary_friction, thermal)
                for quantity, number in values.items():
                    records[quantity][at] = number
                if keep and step % keep == 0:
                    row = step // keep - 1
                    pressure[row] = contact.hertz_pressure * outcome.pressure
                    film[row], states[row] = contact.film_scale * point.film, outcome.state
    return RoughPassage(
        contact=contact,
        position=start.position,
        time=np.asarray(np.arange(1, steps + 1) * float(x[1] - x[0]) * contact.half_width / contact.rolling_velocity),
        settled=np.arange(1, steps + 1) > settle,
        status=status,
        iterations=iterations,
        pressure=pressure,
        film=film,
        state=states,
        kept=kept,
        **records,
    )


STEP_LIMIT = 1_000_000_000  # beyond, not even the record of the steps fits into memory
STEP_SIZE, KEPT_NODE_SIZE = 100.0, 20.0  # memory of the record of a step, and of a node of fields kept [byte]
#: Quantities of a certified step.
FRICTION = ("film_friction", "asperity_friction", "asperity_share")
_RECORDED = ("violation", "leak", *FRICTION, "minimum_film", "mean_film")


def _record(
    position: Array, problem: Problem, outcome: Outcome, boundary_friction: float, thermal: bool
) -> dict[str, float]:
    """Friction and film of one certified step."""
    contact, point = problem.contact, outcome.point
    pressure, film = contact.hertz_pressure * outcome.pressure, contact.film_scale * point.film
    part, _ = reynolds.fluid_part(point.film, problem.touching_film)
    shear = traction(
        contact, position, pressure, film, fluid_part=part, boundary_friction=boundary_friction, thermal=thermal
    )
    within = np.abs(position) < contact.half_width
    return {
        "film_friction": shear.film,
        "asperity_friction": shear.asperities,
        "asperity_share": float(((1.0 - part) * pressure).sum() / pressure.sum()),
        "minimum_film": film[within].min(),
        "mean_film": film[within].mean(),
    }


class _March:
    """The state that one step in time hands to the next."""

    def __init__(self, contact: LubricatedContact, x: Array, start: Film, touching_film: float, order: int) -> None:
        self.contact, self.x, self.order = contact, x, order
        self.deflection = Deflection(x.size, float(x[1] - x[0]))
        self.touching_film = touching_film
        self.step, self.leak = 0, 0.0
        point = start.outcome.point
        self.pressure, self.approach = point.pressure, point.approach
        self.smooth = point.pressure
        self.mass = self.mass_before = self._mass(point)
        # Behind a steady film each node lacks what the one before lacks, and what its own balance adds.
        ruptured = start.state == State.RUPTURED
        self.lack = np.where(ruptured, np.cumsum(np.where(ruptured, point.balance.residual, 0.0)), 0.0)

    def advance(self, size: float, first: Profile, second: Profile) -> tuple[Outcome, Problem]:
        """Take one step, with the heights at ``size`` times their own."""
        self.step += 1
        contact, spacing = self.contact, self.deflection.spacing
        moved = self.step * spacing
        slide = 0.5 * contact.slide_to_roll
        heights = first(contact.half_width * (self.x - (1.0 + slide) * moved))
        heights = heights + second(contact.half_width * (self.x - (1.0 - slide) * moved))
        # Along the path of the mean flow: the node upstream a step ago, and the next two steps ago. (The first step has
        # only one before; from a steady state that makes no difference.)
        last = np.concatenate([self.mass[:1], self.mass[:-1]])
        before = np.concatenate([self.mass_before[:1], self.mass_before[:1], self.mass_before[:-2]])
        history = History(2.0 * last - 0.5 * before, 1.5) if self.order == 2 else History(last, 1.0)
        profile = 0.5 * self.x**2 - size * heights / contact.film_scale
        lacking = np.concatenate([[0.0], self.lack[:-1]])
        problem = Problem(contact, self.deflection, profile, self.touching_film, history, lacking)
        # What roughness makes of the pressure moves on with the mean flow, more or less: a third fewer Newton steps.
        carried = self.smooth + np.concatenate([[0.0], (self.pressure - self.smooth)[:-1]])
        carried[-1] = 0.0
        outcome = reynolds.solve(problem, np.maximum(carried, 0.0), self.approach, reynolds.ROUGH[:1])
        if not outcome.converged:
            spent = outcome.iterations
            outcome = reynolds.solve(problem, self.pressure, self.approach, reynolds.ROUGH)
            outcome = replace(outcome, iterations=spent + outcome.iterations)
        point = outcome.point
        if outcome.converged:
            self.pressure, self.approach = point.pressure, point.approach
        if outcome.converged or np.isfinite(point.film).all():
            self.mass_before, self.mass = self.mass, self._mass(point)
            self.lack = np.where(outcome.state == State.FILM, 0.0, np.maximum(point.lack, 0.0))
            self.lack[[0, -1]] = 0.0
            # What is handed on differs from what was balanced where nodes are neither whole, nor ruptured, nor apart.
            made = (point.lack - self.lack + self.mass - self._mass(point, -math.inf))[1:-1]
            self.leak = float(made.sum() / np.abs(point.balance.flow).mean())
        else:
            self.leak = math.nan
        return outcome, problem

    def _mass(self, point: Point, thinnest: float = 0.0) -> Array:
        pressure = self.contact.hertz_pressure * np.maximum(point.pressure, 0.0)
        density, _ = self.contact.oil.relative_density(pressure)
        return np.asarray(density * np.maximum(point.film, thinnest))


def passage_dataset(passage: RoughPassage) -> xr.Dataset:
    """Friction, film and status of a passage by time step, and the fields that were kept.

    Returns
    -------
    xarray.Dataset
        Dimensions ``time`` [us], and ``kept_time`` and ``rolling_position`` [um] of the fields.

    Examples
    --------
    >>> from easeoff.friction.ehl import LubricatedContact, Oil, generated_profile, rough_passage
    >>> contact = LubricatedContact(1e9, 0.02, 5.0, Oil(0.02, 1.1e-8), slide_to_roll=0.25)
    >>> profile = generated_profile(0.1e-6, 40e-6, 1e-3, seed=1)
    >>> passage = rough_passage(contact, profile, steps=40, nodes=65, settle=30, keep=20)
    >>> dict(passage_dataset(passage).sizes)
    {'time': 40, 'kept_time': 2, 'rolling_position': 65}
    """
    checks.instance("passage", passage, RoughPassage)
    time = 1e6 * passage.time
    data: dict[str, Any] = {
        "status": ("time", passage.status, Status.flag_attributes()),
        "settled": ("time", passage.settled.astype(np.int8)),
        "iterations": ("time", passage.iterations),
        "worst_residual": ("time", passage.violation),
        **{name: ("time", getattr(passage, name)) for name in ("leak", *FRICTION)},
        "minimum_film": ("time", 1e6 * passage.minimum_film),
        "mean_film": ("time", 1e6 * passage.mean_film),
        "film_pressure": (("kept_time", "rolling_position"), 1e-6 * passage.pressure),
        "film": (("kept_time", "rolling_position"), 1e6 * passage.film),
        "node_state": (("kept_time", "rolling_position"), passage.state, State.flag_attributes()),
    }
    coords = {"time": time, "kept_time": time[passage.kept - 1], "rolling_position": 1e6 * passage.position}
    return labelled(xr.Dataset(data, coords=coords))
