"""The modification that makes loads small or even, as a convex programme (after Conry and Seireg 1973).

Loads and rotations being affine functions of the coefficients (see ``load_response``), the greatest line load, the
greatest of other positive multiples of it, the sum of its squares, and the peak to peak of the rotation are convex
functions of the coefficients. The programme has a handful of unknowns, however many segments there are.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from ..core.errors import InputError
from .load_response import LinearLoads

Array = NDArray[np.float64]
Objective = Literal["peak_load", "peak_pressure", "even_load"]
OBJECTIVES: tuple[str, ...] = get_args(Objective)

#: Price of a limit that is passed, per part of it, in units of the objective, which is one at the start.
PRICE = 10.0


@dataclass(frozen=True, eq=False)
class Goal:
    """What is asked for, and what must be kept.

    Parameters
    ----------
    objective
        ``peak_load``: the greatest line load; ``peak_pressure``: the greatest contact pressure; ``even_load``: the root
        of the sum of the squared line loads times the length. Of each torque in relation to the start; the torque that
        fares worst counts.
    reference
        The objective of each torque at the start (t), see ``figures``.
    load_reference
        The greatest line load of each torque at the start (t) [N/mm].
    weights
        Weight of each torque (t).
    transmission_error
        Limit of the rotation's peak to peak in each mesh cycle (c) [urad]; infinite for none.
    end_load
        Limit of the line load at the ends of the contact lines, for each torque (t) [N/mm]; infinite for none.
    surface
        The modification at places (s) on the flank for coefficients of one (s, p) [um].
    largest
        Limit of the modification at these places [um].
    """

    objective: Objective
    reference: Array
    load_reference: Array
    weights: Array
    transmission_error: Array
    end_load: Array
    surface: Array
    largest: float


@dataclass(frozen=True)
class Value:
    """How a modification fares.

    Parameters
    ----------
    objective
        Greatest over the torques of weight times figure over reference.
    violation
        By which part the worst limit is passed: of the peak to peak's own limit, of the line load's peak at the start.
    """

    objective: float
    violation: float

    @property
    def merit(self) -> float:
        """Objective with the price of the violation."""
        return self.objective + PRICE * self.violation


@dataclass(frozen=True, eq=False)
class ProgrammeAnswer:
    """What came of one convex programme.

    Parameters
    ----------
    status
        In the words of CVXPY: ``optimal``, ``optimal_inaccurate``, ...
    step
        Change of the coefficients (p), NaN if there is none.
    value
        What the programme promises.
    """

    status: str
    step: Array
    value: Value = field(default=Value(np.nan, np.nan))

    @property
    def solved(self) -> bool:
        """Whether there is an answer."""
        return bool(np.isfinite(self.step).all())


def _multiple(loads: LinearLoads, objective: Objective) -> Array:
    """What line loads are multiplied by in the objective (n): the pressure squared goes with load times curvature."""
    return loads.curvature if objective == "peak_pressure" else np.ones(loads.line_load.size)


def figures(loads: LinearLoads, objective: Objective, torques: int) -> Array:
    """The objective of each torque (t) in its own units: N/mm, its root over mm, or N/mm^0.5.

    The peak pressure counts as the root of line load times curvature, to which it is proportional.
    """
    values = np.zeros(torques)
    if objective == "even_load":
        np.add.at(values, loads.torque, loads.length * loads.carried**2)
        return np.sqrt(values)
    np.maximum.at(values, loads.torque, loads.carried * _multiple(loads, objective))
    return np.sqrt(values) if objective == "peak_pressure" else values


def greatest_load(loads: LinearLoads, torques: int, among: NDArray[np.bool_] | None = None) -> Array:
    """Greatest line load of each torque (t) [N/mm], over all or some of the segments (n)."""
    values = np.zeros(torques)
    chosen = np.ones(loads.line_load.size, dtype=bool) if among is None else among
    np.maximum.at(values, loads.torque[chosen], loads.carried[chosen])
    return values


def peak_to_peaks(loads: LinearLoads) -> Array:
    """Peak to peak of the rotation in each mesh cycle (c) [urad]."""
    return np.array([np.ptp(loads.rotation[loads.cycle == c]) for c in range(loads.cycle.max() + 1)])


def judged(loads: LinearLoads, goal: Goal) -> Value:
    """How solved loads fare."""
    torques = goal.reference.size
    reached = goal.weights * figures(loads, goal.objective, torques) / goal.reference
    end = (greatest_load(loads, torques, loads.at_end) - goal.end_load) / goal.load_reference
    ripple = peak_to_peaks(loads) / goal.transmission_error - 1.0
    return Value(float(reached.max()), max(float(end.max()), float(ripple.max()), 0.0))


def solve_programme(loads: LinearLoads, goal: Goal, coefficients: Array, reach: float) -> ProgrammeAnswer:
    """Find the best change of the coefficients while the same segments touch.

    Parameters
    ----------
    loads
        Loads at the present coefficients, and how they change.
    goal
        What is asked for.
    coefficients
        The present coefficients (p) [um].
    reach
        How far the surface may move [um].

    Returns
    -------
    ProgrammeAnswer
        A limit that cannot be kept is passed by as little as possible: the programme always has an answer.
    """
    import cvxpy as untyped

    cvxpy: Any = untyped

    # The surface moves by some micrometres: in units of the reach all numbers are of order one.
    step = cvxpy.Variable(coefficients.size)
    worst = cvxpy.Variable()
    violation = cvxpy.Variable(nonneg=True)
    moved = goal.surface @ step
    conditions = [
        cvxpy.abs(moved) <= 1.0,
        cvxpy.abs(goal.surface @ coefficients / reach + moved) <= goal.largest / reach,
    ]
    multiple = _multiple(loads, goal.objective)
    squared = goal.objective == "peak_pressure"
    for t, (weight, reference) in enumerate(zip(goal.weights, goal.reference, strict=True)):
        here = loads.torque == t
        if goal.objective == "even_load":
            chosen = here & (loads.line_load > 0.0)
            root = np.sqrt(loads.length[chosen])[:, None]
            rows = root * np.column_stack([reach * loads.line_load_slope[chosen], loads.line_load[chosen]])
            # As many rows as unknowns say the same as thousands of them.
            triangle = np.linalg.qr(rows / reference, mode="r")
            conditions.append(weight * cvxpy.norm(triangle[:, :-1] @ step + triangle[:, -1]) <= worst)
        else:
            scale = (weight / reference) ** (2 if squared else 1) * multiple[here]
            level, slope = scale * loads.line_load[here], scale[:, None] * loads.line_load_slope[here]
            conditions.append(level + reach * slope @ step <= worst)
        ends = here & loads.at_end
        if np.isfinite(goal.end_load[t]) and ends.any():
            excess = (loads.line_load[ends] - goal.end_load[t]) / goal.load_reference[t]
            slope = reach / goal.load_reference[t] * loads.line_load_slope[ends]
            conditions.append(excess + slope @ step <= violation)
    for c, limit in enumerate(goal.transmission_error):
        if np.isfinite(limit):
            here = loads.cycle == c
            level = (loads.rotation[here] - loads.rotation[here].mean()) / limit
            error = level + reach / limit * loads.rotation_slope[here] @ step
            conditions.append(cvxpy.max(error) - cvxpy.min(error) <= 1.0 + violation)
    programme = cvxpy.Problem(cvxpy.Minimize(worst + PRICE * violation), conditions)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            programme.solve(solver="CLARABEL")
        except cvxpy.error.SolverError as error:
            return ProgrammeAnswer(str(error), np.full(coefficients.size, np.nan))
    if step.value is None:
        return ProgrammeAnswer(str(programme.status), np.full(coefficients.size, np.nan))
    reached = float(worst.value)
    promise = Value(np.sqrt(reached) if squared else reached, float(violation.value))
    return ProgrammeAnswer(str(programme.status), reach * np.asarray(step.value, dtype=np.float64), promise)


def checked_objective(name: str) -> Objective:
    """The objective of that name.

    Raises
    ------
    InputError
        If there is none.
    """
    if name not in OBJECTIVES:
        raise InputError(f"objective = {name!r}: allowed are {', '.join(OBJECTIVES)}")
    return name  # type: ignore[return-value]
