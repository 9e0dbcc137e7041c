"""Convex programme for the modification that makes loads small or even (after Conry and Seireg 1973).

Loads and rotations being affine functions of the coefficients (see ``load_response``), the greatest line load, the
greatest of other positive multiples of it, the sum of its squares, and the peak to peak of the rotation are convex
functions of the coefficients. The programme has a handful of unknowns, however many segments there are.

Conry and Seireg, A mathematical programming technique for the evaluation of load distribution and optimal modifications
for gear systems, ASME Journal of Engineering for Industry 95(4) (1973) 1115-1122.

Loads and rotations are affine while the same segments touch. On the segments A in contact the gap is zero, elsewhere
the force is. With the separation S + B m the conditions

    C_AA F_A + S_A + B_A m - r_A theta = 0,    r_A'F_A = T

are linear, so forces and rotation are affine functions of the coefficients m (Conry and Seireg 1973). They are solved
by the system of the touching segments that sensitivities and torque paths are solved by, too.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any, Literal, cast, get_args

import numpy as np

from ...core.arrays import Bools, Integers, RealArray as Array
from ...core.checks import one_of
from ..problem.compliance_matrix import ComplianceMatrix
from ..solvers.parametric.touching_form import touching_system


def held_in_contact(
    compliance: ComplianceMatrix, separation: Array, lever_arm: Array, torque: float
) -> tuple[Array, float]:
    """Forces [N], pulling ones allowed, and rotation [rad] that close all gaps (n); positive definite compliance."""
    system = touching_system(compliance, lever_arm, np.ones(separation.size, dtype=np.bool_))
    force, rotation, _ = system.solve(-separation[:, None], np.array([torque])).column(0)
    return force, rotation


@dataclass(frozen=True, eq=False)
class LoadResponse:
    """Line loads (n) and rotations (m) of many contact problems as affine functions of p coefficients.

    Without contact a line load is minus the gap over the yielding; it turns positive where the segment would touch, and
    is then too high, as the neighbours touch too. A mesh cycle is one torque in one assembly.
    """

    line_load: Array  # [N/mm]
    line_load_slope: Array
    touching: Bools
    length: Array
    curvature: Array
    at_end: Bools
    cycle: Integers
    rotation: Array  # [urad]
    rotation_slope: Array
    rotation_cycle: Integers

    @property
    def carried(self) -> Array:
        """Line loads (n) [N/mm], zero where there is no contact."""
        return np.maximum(self.line_load, 0.0)


def stacked(parts: Sequence[LoadResponse]) -> LoadResponse:
    """Concatenate the loads of many contact problems."""
    return LoadResponse(*(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(LoadResponse)))


def load_response(
    compliance: ComplianceMatrix,
    force: Array,
    gap: Array,
    rotation: float,
    separation: Array,
    *,
    lever_arm: Array,
    length: Array,
    curvature: Array,
    at_end: Bools,
    cycle: int,
    pull: bool = False,
) -> LoadResponse:
    """One solved contact problem as affine functions of the coefficients, from its tangent compliance [mm/N].

    That is positive definite on the segments in contact, at least one.
    Solution (n) [N], (n) [mm], [rad]; derivatives of the separation (n, p) [mm per unit]. With ``pull`` all segments
    are in contact, by pulling if need be.
    """
    active = np.full(force.size, pull) | (force > 0.0)
    system = touching_system(compliance, lever_arm, active)
    change = system.solve(-separation, np.zeros(separation.shape[1]))
    # To a force of its own while the loaded segments keep contact [mm/N].
    yielding = compliance.diagonal if active.all() else np.where(active, compliance.diagonal, system.yielding())
    would_be = np.where(active, force, -np.maximum(gap, 0.0) / yielding)
    would_be_slope = np.where(active[:, None], change.force, -change.gap / yielding[:, None])
    return LoadResponse(
        line_load=would_be / length,
        line_load_slope=would_be_slope / length[:, None],
        touching=active,
        length=length,
        curvature=curvature,
        at_end=at_end,
        cycle=np.full(force.size, cycle),
        rotation=np.array([1e6 * rotation]),
        rotation_slope=1e6 * change.rotation[None],
        rotation_cycle=np.array([cycle]),
    )


Objective = Literal["peak_load", "peak_pressure", "even_load"]
OBJECTIVES: tuple[Objective, ...] = get_args(Objective)

#: Price of passing a limit, per share of the limit, in units of the objective, which is one at the start.
VIOLATION_PRICE = 10.0
#: Share of a limit by which a programme aims below it, so that the fresh solution does not pass it.
LIMIT_MARGIN = 1e-3


@dataclass(frozen=True, eq=False)
class Goal:
    """Objective and limits of a modification.

    Mesh cycles count through the torques of the first assembly, then of the next. Of each torque relative to the start
    the worst assembly counts; then the torque that fares worst.
    """

    objective: Objective
    reference: Array
    load_reference: Array  # greatest line load at the start (t) [N/mm]
    transmission_error: float  # limit of every cycle's peak to peak [urad], infinite for none
    end_load: Array  # limit at the ends of contact lines (t) [N/mm], infinite for none
    surface: Array  # modification at points (s) by coefficients of one (s, p) [um]
    largest: float  # limit of the modification [um]


@dataclass(frozen=True)
class Value:
    """Objective and violation of the limits that a modification reaches."""

    objective: float  # figure over reference, greatest of the torques
    violation: float

    @property
    def merit(self) -> float:
        """Objective with the price of the violation."""
        return self.objective + VIOLATION_PRICE * self.violation


@dataclass(frozen=True, eq=False)
class ProgrammeAnswer:
    """Answer of one convex programme."""

    status: str
    step: Array  # of the coefficients (p) [um], NaN if there is none
    value: Value

    @property
    def solved(self) -> bool:
        """True if the programme gave a step."""
        return bool(np.isfinite(self.step).all())


def figures(loads: LoadResponse, objective: Objective) -> Array:
    """The objective of each mesh cycle (c), in its own units.

    Greatest line load [N/mm]; root of it times the curvature [N^0.5/mm], proportional to the pressure; root of the
    squared line loads times the length, summed [N/mm^0.5].
    """
    values = np.zeros(1 + loads.cycle.max())
    if objective == "even_load":
        np.add.at(values, loads.cycle, loads.length * loads.carried**2)
        return np.sqrt(values)
    np.maximum.at(values, loads.cycle, loads.carried * _multiple(loads, objective))
    return np.sqrt(values) if objective == "peak_pressure" else values


def end_loads(loads: LoadResponse) -> Array:
    """Greatest line load at the ends of the contact lines in each mesh cycle (c) [N/mm]; negative if all are clear."""
    values = np.full(1 + loads.cycle.max(), -np.inf)
    np.maximum.at(values, loads.cycle[loads.at_end], loads.line_load[loads.at_end])
    return values


def peak_to_peaks(loads: LoadResponse) -> Array:
    """Peak to peak of the rotation in each mesh cycle (c) [urad]."""
    return np.array([np.ptp(loads.rotation[loads.rotation_cycle == c]) for c in range(1 + loads.cycle.max())])


def worst_assembly(values: Array, torques: int) -> Array:
    """Greatest value of each torque (t), from the values of all mesh cycles (c)."""
    return np.asarray(values.reshape(-1, torques).max(axis=0))


def judged(loads: LoadResponse, goal: Goal) -> Value:
    """Value of solved loads."""
    torques = goal.reference.size
    reached = worst_assembly(figures(loads, goal.objective), torques) / goal.reference
    end = (worst_assembly(end_loads(loads), torques) - goal.end_load) / goal.load_reference
    ripple = peak_to_peaks(loads) / goal.transmission_error - 1.0
    return Value(float(reached.max()), max(float(end.max()), float(ripple.max()), 0.0))


def solve_programme(loads: LoadResponse, goal: Goal, coefficients: Array, trust_radius: float) -> ProgrammeAnswer:
    """Best change of the coefficients (p) [um] while the same segments touch.

    The surface changes by ``trust_radius`` [um] at most. There is always an answer: a limit that cannot be kept is
    passed by as little as possible.
    """
    import cvxpy as untyped

    cvxpy: Any = untyped

    # In units of the trust radius, all numbers are of order one.
    step, worst, violation = cvxpy.Variable(coefficients.size), cvxpy.Variable(), cvxpy.Variable(nonneg=True)
    moved = goal.surface @ step
    present = goal.surface @ coefficients / trust_radius
    conditions = [cvxpy.abs(moved) <= 1.0, cvxpy.abs(present + moved) <= goal.largest / trust_radius]
    torques = goal.reference.size
    for cycle in range(1 + loads.cycle.max()):
        segments = loads.cycle == cycle
        conditions.append(_objective(cvxpy, loads, segments, goal, trust_radius, step) <= worst)
        limit, reference = goal.end_load[cycle % torques], goal.load_reference[cycle % torques]
        ends = segments & loads.at_end
        if np.isfinite(limit):
            excess = (loads.line_load[ends] - limit) / reference
            rise = trust_radius / reference * loads.line_load_slope[ends] @ step
            conditions.append(excess + rise <= violation - LIMIT_MARGIN)
        if np.isfinite(goal.transmission_error):
            now = loads.rotation_cycle == cycle
            level = (loads.rotation[now] - loads.rotation[now].mean()) / goal.transmission_error
            error = level + trust_radius / goal.transmission_error * loads.rotation_slope[now] @ step
            conditions.append(cvxpy.max(error) - cvxpy.min(error) <= 1.0 - LIMIT_MARGIN + violation)
    programme = cvxpy.Problem(cvxpy.Minimize(worst + VIOLATION_PRICE * violation), conditions)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            programme.solve(solver="CLARABEL")
        except cvxpy.error.SolverError as error:
            return _no_answer(str(error), coefficients.size)
    if step.value is None:
        return _no_answer(str(programme.status), coefficients.size)
    reached = max(float(worst.value), 0.0)
    promise = Value(float(np.sqrt(reached)) if _squared(goal) else reached, float(violation.value))
    return ProgrammeAnswer(str(programme.status), trust_radius * np.asarray(step.value, dtype=np.float64), promise)


def _objective(cvxpy: Any, loads: LoadResponse, mask: Bools, goal: Goal, trust_radius: float, step: Any) -> Any:
    """Convex function of the step that is the relative objective of one cycle, squared for the pressure."""
    reference = goal.reference[loads.cycle[mask][0] % goal.reference.size]
    if goal.objective == "even_load":
        chosen = mask & loads.touching
        slope, level = loads.line_load_slope[chosen], loads.line_load[chosen]
        rows = np.sqrt(loads.length[chosen])[:, None] * np.column_stack([trust_radius * slope, level]) / reference
        # As many rows as unknowns hold the same information as thousands of them.
        triangle: Array = np.asarray(np.linalg.qr(rows, mode="r"))
        return cvxpy.norm(triangle[:, :-1] @ step + triangle[:, -1])
    scale = _multiple(loads, goal.objective)[mask] / reference ** (2 if _squared(goal) else 1)
    return cvxpy.max(scale * loads.line_load[mask] + trust_radius * scale[:, None] * loads.line_load_slope[mask] @ step)


def _squared(goal: Goal) -> bool:
    """True if the objective is squared in the programme: the squared pressure is affine in the line load."""
    return goal.objective == "peak_pressure"


def _multiple(loads: LoadResponse, objective: Objective) -> Array:
    """Factor of the line loads in the objective (n): the squared pressure is proportional to load times curvature."""
    return loads.curvature if objective == "peak_pressure" else np.ones(loads.line_load.size)


def _no_answer(status: str, size: int) -> ProgrammeAnswer:
    return ProgrammeAnswer(status, np.full(size, np.nan), Value(np.nan, np.nan))


def checked_objective(name: str) -> Objective:
    """The objective of that name; an ``InputError`` refuses an unknown one."""
    return cast(Objective, one_of("objective", name, OBJECTIVES))
