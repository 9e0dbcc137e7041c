"""Contact with a load-dependent local compliance: the line contact of each segment stiffens as its width grows.

With the local deflection delta_i(F_i), convex energy Phi_i' = delta_i, the problem is

    minimise 1/2 F'B F + S'F + sum Phi_i(F_i)   subject to   r'F = T,  F >= 0,

still convex, with B the bending compliance of the teeth. It is solved by Newton's method with exact subproblems: around
the forces F, the quadratic programme with compliance B + diag(tangent) and separation S + delta(F) - tangent F.
Convergence is quadratic. A line search makes the steps safe.

The result is handed back as the linear contact problem with compliance B + diag(secant) at the solution. Since secant
times force is the deflection, its residuals are those of the nonlinear problem, to the bit: the ordinary certificate
proves the nonlinear answer.

At many mesh positions and torques Newton's method runs in the bending modes. There it asks for a force at an
indentation, the line contact gives the indentation for a force: it is inverted segment by segment, see
``line_deflection``. As its compliance falls with the load, the deflection is a concave function of the force: Newton's
method on it comes from below after the first step, and never overshoots.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import fields
from typing import Any, Protocol, runtime_checkable

import numpy as np

from ...core.arrays import Bools, RealArray as Array
from ...core.errors import InputError
from ..compliance.weber_line_contact import WeberLineContact
from ..problem.certificate import EXACT_TOLERANCE, vector_of, with_certificate
from ..problem.contact_problem import ContactProblem
from ..problem.scaled_problem import Scaling
from ..solvers import ContactSolution, SolverChoice, Status, solve
from ..solvers.compiled.compiled_answer import CompiledAnswer, line_contact_answers
from ..solvers.native import answers
from ..solvers.registry import chosen_solver, start_force
from ..solvers.solution import judged, no_solution
from ..solvers.solver_declaration import ChosenSolver
from ..solvers.solver_limits import Limits, StepBudget

#: Linear problems solved before giving up; four to six are usual.
MAX_ITERATIONS = 50
#: Residual, relative to the scale of the gaps, at which the iteration is at rounding level.
ROUNDING_RESIDUAL = 4e-15
#: The iteration ends after so many steps without progress, once the residual is below this.
MAX_STALLED_STEPS, STALLED_RESIDUAL = 2, 1e-6
#: A slope of the energy below this, relative to its terms, is rounding.
ROUNDING_SLOPE = 1e-14
#: Shortest step of the damped iteration.
SHORTEST_STEP = 2.0**-20


@runtime_checkable
class LineContact(Protocol):
    """Local deflection of the segments as a function of their forces (n) [N]; each method returns an (n) array."""

    def deflection(self, force: Array) -> Array:
        """Return delta [mm]."""

    def secant(self, force: Array) -> Array:
        """Return delta / F [mm/N], finite also at zero force."""

    def tangent(self, force: Array) -> Array:
        """Return d delta / dF [mm/N], positive."""


class NativeStep:
    """Solves the scaled subproblems with the native methods, from the active set of the last one."""

    polished = False

    def __init__(self, linear: ContactProblem, bending: ContactProblem, settings: dict[str, Any]) -> None:
        names = [field.name for field in fields(Limits) if field.name in settings]
        limits = Limits(**{name: settings[name] for name in names})
        self._scaling, self._bending = linear.scaling, bending
        self._settings = {name: value for name, value in settings.items() if name not in names}
        self._budget = StepBudget(limits)
        self.tolerance = limits.exact_tolerance
        self.method = self.reason = ""

    def __call__(self, tangent: Array, separation: Array, active: Bools) -> tuple[Array, float] | Status:
        """Return forces [N] and rotation beyond first contact [rad] with this diagonal added, or why there are none."""
        compliance = self._bending.compliance_matrix.with_added(tangent)
        data = (separation, self._bending.lever_arm, self._bending.torque, compliance)
        problem = self._scaling.scale(*data, clip=False)
        for method, answer in answers(problem, active, self._settings, self._budget):
            self.method = method
            return answer.force * self._scaling.force, self._scaling.unscale_elastic_rotation(answer.rotation)
        return self._budget.met or Status.NOT_CONVERGED


class BackendStep:
    """Solves the subproblems with a backend, each one certified."""

    def __init__(self, bending: ContactProblem, solver: ChosenSolver, polish: bool, settings: dict[str, Any]) -> None:
        self._bending, self._solver, self._polish, self._settings = bending, solver, polish, settings
        self.tolerance = EXACT_TOLERANCE
        self.polished = polish
        self.method = self.reason = ""

    def __call__(self, tangent: Array, separation: Array, active: Bools) -> tuple[Array, float] | Status:
        """Return forces [N] and rotation beyond first contact [rad] with this diagonal added, or why there are none."""
        problem = self._bending.with_added_compliance(tangent, separation)
        solution = solve(problem, self._solver, polish=self._polish, **self._settings)
        if not solution.certified:
            self.reason = f": {solution.message}"
            return solution.status
        self.method = solution.method
        if not solution.polished:
            self.polished = False
            self.tolerance = max(self.tolerance, solution.tolerance)
        return solution.force, solution.rotation


class NewtonIteration:
    """Newton's method with a line search; holds the best point met."""

    def __init__(
        self, bending: ContactProblem, scaling: Scaling, line_contact: LineContact, step: NativeStep | BackendStep
    ) -> None:
        self._bending, self._scaling, self._line_contact, self.step = bending, scaling, line_contact, step
        self._separation = bending.separation_at_first_contact
        self.count, self.message = 0, ""
        self.force, self.rotation, self.residual = np.zeros(bending.size), 0.0, np.inf  # rotation beyond first contact

    def run(self, start: Array | None, linear: ContactProblem) -> Status | None:
        """Iterate until the residual is rounding or falls no further; return a status if a linear problem fails."""
        if start is None:
            # One problem with the secant compliance at the mean load gives a feasible start, near the solution.
            secant = self._line_contact.secant(np.full(linear.size, float(linear.scaling.force)))
            outcome = self._solve(secant, self._separation, linear.scaling.estimated_active)
            if isinstance(outcome, Status):
                return outcome
            force, rotation = outcome
            self._note(force, rotation)
            feasible = True
        else:
            force, feasible = start, False
        stalled = 0
        while self.count < MAX_ITERATIONS and self.residual > ROUNDING_RESIDUAL:
            deflection, tangent = self._line_contact.deflection(force), self._line_contact.tangent(force)
            outcome = self._solve(tangent, self._separation + (deflection - tangent * force), force > 0.0)
            if isinstance(outcome, Status):
                return outcome
            target, rotation = outcome
            length = self._step_length(force, target - force, rotation) if feasible else 1.0
            force = target if length == 1.0 else np.maximum(force + length * (target - force), 0.0)
            feasible = True
            stalled = 0 if self._note(force, rotation) else stalled + 1
            if stalled >= MAX_STALLED_STEPS and self.residual < STALLED_RESIDUAL:
                break  # nothing is left but the accuracy of the solver
        return None

    def _solve(self, local: Array, separation: Array, active: Bools) -> tuple[Array, float] | Status:
        if not (np.isfinite(local).all() and np.isfinite(separation).all() and local.min() >= 0.0):
            self.message = "line contact gives no finite positive compliance"
            return Status.INVALID_DATA
        self.count += 1
        outcome = self.step(local, separation, active)
        if isinstance(outcome, Status):
            self.message = f"linear problem {self.count} failed{self.step.reason}"
        return outcome

    def _note(self, force: Array, rotation: float) -> bool:
        """Keep the point if it is the best so far."""
        gap = self._bending.deflection(force) + self._line_contact.deflection(force) + self._separation
        gap -= rotation * self._bending.lever_arm
        residual = float(np.abs(np.minimum(force / self._scaling.force, gap / self._scaling.gap)).max())
        if not residual < self.residual:
            return False
        self.force, self.rotation, self.residual = force, rotation, residual
        return True

    def _step_length(self, force: Array, direction: Array, rotation: float) -> float:
        """Return 1, or a half, a quarter ... of it: the longest along which the energy surely falls.

        The slope of a convex energy never decreases, so over a step a its change is at most a/2 (slope(a/2) +
        slope(a)).
        """
        # Along the direction the torque is constant, so r theta may be taken off the gradient: that removes the
        # rounding of r'direction, which would drown the slope near the solution.
        gradient = self._bending.deflection(force) + self._separation - rotation * self._bending.lever_arm
        level, curvature = float(direction @ gradient), float(direction @ self._bending.deflection(direction))

        def slope(length: float) -> float:
            local = self._line_contact.deflection(force + length * direction)
            return level + length * curvature + float(direction @ local)

        rounding = ROUNDING_SLOPE * abs(rotation) * float(np.abs(direction) @ np.abs(self._bending.lever_arm))
        length, at_end = 1.0, slope(1.0)
        while at_end > rounding and length > SHORTEST_STEP:
            middle = slope(0.5 * length)
            if middle + at_end <= 0.0:
                break
            length, at_end = 0.5 * length, middle
        return length


def solve_on_bending(
    bending: ContactProblem,
    line_contact: LineContact,
    solver: SolverChoice = "auto",
    *,
    initial_force: Array | None = None,
    polish: bool = True,
    **settings: Any,
) -> tuple[ContactSolution, ContactProblem]:
    """Solution of the contact problem with load-dependent line contact, proven, and the equivalent linear problem.

    That has the secant compliance. The problem given has the compliance of bending alone; a NaN start is ignored; a
    time or step limit holds for all linear problems with the native solver, for each with another.
    """
    solver = chosen_solver(solver)
    name = solver.name
    uniform = np.full(bending.size, bending.torque / float(np.maximum(bending.lever_arm, 0.0).sum()))
    start = _warm_start(initial_force, bending)
    try:
        linear = bending.with_added_compliance(line_contact.secant(uniform if start is None else start))
    except InputError as error:
        return _failed(bending, Status.INVALID_DATA, name, f"line contact: {error}"), bending
    idle = bending.torque == 0.0 and bending.separation_at_first_contact.min() >= 0.0
    if idle or not linear.is_positive_semidefinite:
        return solve(linear, solver, polish=polish, **settings), linear

    step = NativeStep(linear, bending, settings) if solver.is_native else BackendStep(bending, solver, polish, settings)
    iteration = NewtonIteration(bending, linear.scaling, line_contact, step)
    if (status := iteration.run(start, linear)) is not None:
        return _failed(bending, status, name, iteration.message, iteration.count), linear
    force, method, count = iteration.force, step.method, iteration.count
    try:
        problem = bending.with_added_compliance(line_contact.secant(force))
    except InputError as error:
        return _failed(bending, Status.INVALID_DATA, name, f"line contact: {error}", count), bending
    # On the linear problem with the secant compliance the residuals are those of the nonlinear one.
    solution = judged(
        name,
        with_certificate(problem, force, iteration.rotation),
        tolerance=step.tolerance,
        iterations=count,
        method=method,
        polished=step.polished,
        message=f"Newton's method on the line contacts with {name} ({method}): {count} linear problems",
        suspicion=Status.NOT_CONVERGED,
    )
    return solution, problem


def _warm_start(force: Array | None, bending: ContactProblem) -> Array | None:
    if force is None:
        return None
    array = vector_of(force, "initial_force", bending.size)
    return start_force(array, bending) if np.isfinite(array).all() else None


def _failed(bending: ContactProblem, status: Status, name: str, message: str, iterations: int = 0) -> ContactSolution:
    return no_solution(bending.size, status, name, message=message, iterations=iterations)


Problems = Sequence[ContactProblem]
LineContacts = Sequence[WeberLineContact]
Starts = Sequence[Array | None]
_Found = tuple[ContactSolution, ContactProblem]


def solve_at_torques(
    bendings: Problems, contacts: LineContacts, torques: Array, solver: SolverChoice = "auto", **options: Any
) -> Iterator[list[_Found]]:
    """Solutions at rising torques (t) [N mm], each from the one before; the torque of the problems is of no account."""
    solver = chosen_solver(solver)
    at_torques = [[one.with_torque(torque) for one in bendings] for torque in torques.tolist()]
    known: list[list[_Found | None]] = [[None] * len(at_torques)] * len(bendings)
    if solver.is_native and not options:
        by_problem = zip(*at_torques, strict=True)
        known = [_compiled_answers(series, contact) for series, contact in zip(by_problem, contacts, strict=True)]
    starts: list[Array | None] = [None] * len(bendings)
    for number, problems in enumerate(at_torques):
        at_torque = [answers[number] for answers in known]
        solved = list(_completed(problems, contacts, starts, at_torque, solver, **options))
        starts = [solution.force if solution.certified else None for solution, _ in solved]
        yield solved


def solve_line_contacts(
    bendings: Problems, contacts: LineContacts, starts: Starts, solver: SolverChoice = "auto", **options: Any
) -> Iterator[_Found]:
    """Solve contact problems with load-dependent line contact, and prove the answers; one result a problem.

    Linear programmes solve what the native solver without options leaves uncertified, and all of other solvers.
    ``bendings`` have bending compliance alone and a positive torque; ``starts`` are forces (n) [N].
    """
    known: Sequence[_Found | None] = [None] * len(bendings)
    solver = chosen_solver(solver)
    if solver.is_native and not options and len(bendings) > 0:
        known = [_compiled_answers([one], contact)[0] for one, contact in zip(bendings, contacts, strict=True)]
    yield from _completed(bendings, contacts, starts, known, solver, **options)


def _completed(
    bendings: Problems,
    contacts: LineContacts,
    starts: Starts,
    known: Sequence[_Found | None],
    solver: ChosenSolver,
    **options: Any,
) -> Iterator[_Found]:
    """Answers that are known, and those of the other problems, solved one by one."""
    for bending, contact, start, answer in zip(bendings, contacts, starts, known, strict=True):
        yield answer or solve_on_bending(bending, contact, solver, initial_force=start, **options)


def _compiled_answers(bendings: Sequence[ContactProblem], contact: WeberLineContact) -> list[_Found | None]:
    """Answers of the compiled method at several torques, which needs no start; None where it has no certified one."""
    return [
        None if outcome is None or not outcome.answer.certificate.passes(EXACT_TOLERANCE) else _judged(bending, outcome)
        for bending, outcome in zip(bendings, line_contact_answers(bendings, contact.parameters), strict=True)
    ]


def _judged(bending: ContactProblem, compiled: CompiledAnswer) -> _Found:
    solution = judged(
        "native",
        compiled.answer,
        tolerance=EXACT_TOLERANCE,
        iterations=compiled.iterations,
        method="modal",
        message=f"modal Newton's method on the line contacts themselves, {compiled.iterations} steps",
        stiffness=compiled.stiffness,
    )
    return solution, compiled.answer.problem or bending.with_secant(compiled.secant)
