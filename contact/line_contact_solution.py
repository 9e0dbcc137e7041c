"""Contact with a load-dependent local compliance: the line contact of each segment stiffens as its width grows.

With the local deflection delta_i(F_i), convex energy Phi_i' = delta_i, the problem is

    minimise 1/2 F'B F + S'F + sum Phi_i(F_i)   subject to   r'F = T,  F >= 0,

still convex, with B the bending compliance of the teeth. It is solved by Newton's method with exact subproblems: around the forces F, the
quadratic programme with compliance B + diag(tangent) and separation S + delta(F) - tangent F. Convergence is quadratic.

The result is handed back as the linear contact problem with compliance B + diag(secant) at the solution. Since secant times force is the
deflection, its residuals are those of the nonlinear problem, to the bit: the ordinary certificate proves the nonlinear answer.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .certificate import EXACT_TOLERANCE, certify
from .problem import ContactProblem
from .scaling import ScaledProblem, Scaling
from .solvers import ContactSolution, Status, require_solver, solve
from .solvers.native import answers
from .solvers.settings import SOLVERS
from .solvers.status import no_solution

Array = NDArray[np.float64]
Compliance = Array | tuple[Array, Array]

#: Linear problems solved before giving up; four to six are usual.
MAX_ITERATIONS = 50
#: Residual, relative to the scale of the gaps, at which the iteration is at rounding level.
ROUNDING_RESIDUAL = 4e-15
#: Shortest step of the damped iteration.
SHORTEST_STEP = 2.0**-20


class LineContact(Protocol):
    """Local deflection of the segments as a function of their forces (n) [N]; each method returns an (n) array."""

    def deflection(self, force: Array) -> Array:
        """Return delta [mm]."""
        ...

    def secant(self, force: Array) -> Array:
        """Return delta / F [mm/N], finite also at zero force."""
        ...

    def tangent(self, force: Array) -> Array:
        """Return d delta / dF [mm/N], positive."""
        ...


def solve_line_contact(
    separation: Array,
    lever_arm: Array,
    torque: float,
    bending_compliance: Compliance,
    line_contact: LineContact,
    solver: str = "auto",
    *,
    initial_force: Array | None = None,
    polish: bool = True,
    **settings: Any,
) -> tuple[ContactSolution, ContactProblem]:
    """Solve the contact problem with load-dependent line contact, and prove the answer.

    Parameters
    ----------
    separation, lever_arm : (n) array
        [mm], see `ContactProblem`.
    torque : float
        [N mm].
    bending_compliance : (n, n) array, or pair of an (n) and an (n, k) array
        Compliance B of teeth and roots, without the local part [mm/N], positive semidefinite.
    line_contact : LineContact
        The local part.
    solver : str
        What solves the linear problems; see `solve`.
    initial_force : (n) array, optional
        Warm start: the forces of a neighbouring problem [N].
    polish : bool
        See `solve`.
    **settings
        Passed to the solver.

    Returns
    -------
    ContactSolution
        Its certificate is that of the nonlinear problem, ``iterations`` counts the linear problems solved. The status is
        `Status.NOT_CONVERGED` if the iteration did not settle, or that of the linear problem that failed.
    ContactProblem
        The linear problem with the secant compliance at the solution, which has the same solution.

    Raises
    ------
    InputError, MissingSolverError
        As `ContactProblem` and `solve`.
    """
    name = require_solver(solver)
    bending = ContactProblem(separation, lever_arm, torque, bending_compliance)
    uniform = np.full(bending.size, bending.torque / float(np.maximum(bending.lever_arm, 0.0).sum()))
    start = uniform if initial_force is None else np.maximum(np.asarray(initial_force, dtype=np.float64), 0.0)
    linear = _with_local(bending, line_contact.secant(start))
    if linear is None:
        return _failed(bending, Status.INVALID_DATA, name, "line contact gives no finite positive compliance"), bending
    if bending.torque == 0.0:
        return solve(linear, name, polish=polish, **settings), linear
    if not bending.is_positive_semidefinite:
        return solve(linear, name), linear  # says so, or the local part has made it right

    step = _NativeStep(linear, bending, settings) if name == "native" else _BackendStep(bending, name, polish, settings)
    iteration = _Iteration(bending, linear.scaling, line_contact, step)
    status = iteration.run(None if initial_force is None else start, linear)
    if status is not None:
        return _failed(bending, status, name, iteration.message, iteration.count), linear
    return _finish(bending, line_contact, iteration, name, step.tolerance)


class _NativeStep:
    """Solves the scaled subproblems with the native methods, from the active set of the last one."""

    tolerance = EXACT_TOLERANCE
    polished = False

    def __init__(self, linear: ContactProblem, bending: ContactProblem, settings: dict[str, Any]) -> None:
        self._scaling = linear.scaling
        self._arm = bending.lever_arm / self._scaling.lever_arm
        self._torque = bending.torque / self._scaling.lever_arm / self._scaling.force
        self._matrix = bending.dense_compliance / self._scaling.compliance
        self._diagonal = np.diag_indices(bending.size)
        self._settings = settings

    def __call__(
        self, tangent: Array, separation: Array, active: NDArray[np.bool_]
    ) -> tuple[Array, float] | Status:
        matrix = self._matrix.copy()
        matrix[self._diagonal] += tangent / self._scaling.compliance
        problem = ScaledProblem(matrix, separation / self._scaling.gap, self._arm, self._torque)
        for answer in answers(problem, active, self._settings):
            return answer.force * self._scaling.force, self._scaling.unscale_elastic_rotation(answer.rotation)
        return Status.NOT_CONVERGED


class _BackendStep:
    """Solves the subproblems with a backend, each one certified."""

    def __init__(self, bending: ContactProblem, name: str, polish: bool, settings: dict[str, Any]) -> None:
        self._bending, self._name, self._polish, self._settings = bending, name, polish, settings
        self.tolerance = EXACT_TOLERANCE
        self.polished = polish

    def __call__(
        self, tangent: Array, separation: Array, active: NDArray[np.bool_]
    ) -> tuple[Array, float] | Status:
        problem = _with_local(self._bending, tangent, separation)
        if problem is None:
            return Status.INVALID_DATA
        solution = solve(problem, self._name, polish=self._polish, **self._settings)
        if not solution.certified:
            return solution.status
        if not solution.polished:
            self.polished = False
            self.tolerance = max(self.tolerance, SOLVERS[self._name].tolerance)
        return solution.force, solution.rotation


class _Iteration:
    """Newton's method with a line search; holds the best point met."""

    def __init__(
        self, bending: ContactProblem, scaling: Scaling, line_contact: LineContact, step: _NativeStep | _BackendStep
    ) -> None:
        self._bending, self._scaling, self._line_contact, self._step = bending, scaling, line_contact, step
        self._separation = bending.separation_at_first_contact
        self.count = 0
        self.message = ""
        self.force = np.zeros(bending.size)
        self.rotation = 0.0  # beyond first contact
        self.residual = np.inf

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
        while self.count < MAX_ITERATIONS and self.residual > ROUNDING_RESIDUAL:
            previous = self.residual
            deflection, tangent = self._line_contact.deflection(force), self._line_contact.tangent(force)
            outcome = self._solve(tangent, self._separation + (deflection - tangent * force), force > 0.0)
            if isinstance(outcome, Status):
                return outcome
            target, rotation = outcome
            length = self._step_length(force, target - force) if feasible else 1.0
            force = target if length == 1.0 else np.maximum(force + length * (target - force), 0.0)
            feasible = True
            improved = self._note(force, rotation)
            if length == 1.0 and not improved and previous < 1e-6:
                break  # nothing left but the rounding of the solver
        return None

    def _solve(self, local: Array, separation: Array, active: NDArray[np.bool_]) -> tuple[Array, float] | Status:
        if not (np.isfinite(local).all() and np.isfinite(separation).all() and local.min() >= 0.0):
            self.message = "line contact gives no finite positive compliance"
            return Status.INVALID_DATA
        self.count += 1
        outcome = self._step(local, separation, active)
        if isinstance(outcome, Status):
            self.message = f"linear problem {self.count} failed"
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

    def _step_length(self, force: Array, direction: Array) -> float:
        """Return 1, or a half, a quarter ... of it: the longest along which the energy surely falls.

        The slope of a convex energy never decreases, so over a step a its change is at most a/2 (slope(a/2) + slope(a)).
        """
        deflection = self._bending.deflection(direction)
        level = float(direction @ (self._bending.deflection(force) + self._separation))
        curvature = float(direction @ deflection)

        def slope(length: float) -> float:
            local = self._line_contact.deflection(force + length * direction)
            return level + length * curvature + float(direction @ local)

        length, at_end = 1.0, slope(1.0)
        while at_end > 0.0 and length > SHORTEST_STEP:
            middle = slope(0.5 * length)
            if middle + at_end <= 0.0 or middle >= slope(0.0):
                break  # it falls, or all slopes agree to rounding
            length, at_end = 0.5 * length, middle
        return length


def _finish(
    bending: ContactProblem, line_contact: LineContact, iteration: _Iteration, name: str, tolerance: float
) -> tuple[ContactSolution, ContactProblem]:
    """Certify the end point on the linear problem with its secant compliance."""
    force, elastic_rotation = iteration.force, iteration.rotation
    problem = _with_local(bending, line_contact.secant(force))
    if problem is None:
        return _failed(bending, Status.INVALID_DATA, name, "secant compliance is not finite", iteration.count), bending
    rotation = problem.first_contact_rotation + elastic_rotation
    certificate = certify(problem, force, rotation, elastic_rotation)
    message = f"{iteration.count} linear problems"
    if not certificate.passes(tolerance):
        failed = no_solution(
            bending.size,
            Status.NOT_CONVERGED,
            name,
            message=message,
            iterations=iteration.count,
            certificate=certificate,
            tolerance=tolerance,
        )
        return failed, problem
    gap = problem.deflection(force) + problem.separation_at_first_contact - elastic_rotation * problem.lever_arm
    solution = ContactSolution(
        force=force,
        rotation=rotation,
        gap=gap,
        status=Status.CERTIFIED,
        solver=name,
        iterations=iteration.count,
        certificate=certificate,
        elastic_rotation=elastic_rotation,
        polished=iteration._step.polished,
        tolerance=tolerance,
        message=message,
    )
    return solution, problem


def _with_local(bending: ContactProblem, local: Array, separation: Array | None = None) -> ContactProblem | None:
    """Add a local compliance to the diagonal; None if it is not finite and nonnegative."""
    local = np.asarray(local, dtype=np.float64)
    if local.shape != (bending.size,) or not np.isfinite(local).all() or local.min() < 0.0:
        return None
    if isinstance(bending.compliance, tuple):
        compliance: Compliance = (bending.compliance[0] + local, bending.compliance[1])
    else:
        compliance = bending.compliance.copy()
        compliance[np.diag_indices(bending.size)] += local
    chosen = bending.separation if separation is None else separation
    return ContactProblem(chosen, bending.lever_arm, bending.torque, compliance)


def _failed(
    bending: ContactProblem, status: Status, name: str, message: str, iterations: int = 0
) -> ContactSolution:
    return no_solution(bending.size, status, name, message=message, iterations=iterations)
