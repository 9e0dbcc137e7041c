"""Contact with a load-dependent local compliance: the line contact of each segment stiffens as its width grows.

With the local deflection delta_i(F_i), convex energy Phi_i' = delta_i, the problem is

    minimise 1/2 F'B F + S'F + sum Phi_i(F_i)   subject to   r'F = T,  F >= 0,

still convex, with B the bending compliance of the teeth. It is solved by Newton's method with exact subproblems:
around the forces F, the quadratic programme with compliance B + diag(tangent) and separation S + delta(F) - tangent
F. Convergence is quadratic.

The result is handed back as the linear contact problem with compliance B + diag(secant) at the solution. Since secant
times force is the deflection, its residuals are those of the nonlinear problem, to the bit: the ordinary certificate
proves the nonlinear answer.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.errors import InputError
from ..problem.answer import vector_of, with_certificate
from ..problem.contact_problem import ContactProblem
from ..solvers import ContactSolution, SolverChoice, Status, require_solver, solve
from ..solvers.registry import start_force
from ..solvers.solution import judged, no_solution
from .line_contact_newton import BackendStep, LineContact, NativeStep, NewtonIteration

Array = NDArray[np.float64]
Compliance = Array | tuple[Array, Array]


def solve_line_contact(
    separation: Array,
    lever_arm: Array,
    torque: float,
    bending_compliance: Compliance,
    line_contact: LineContact,
    solver: SolverChoice = "auto",
    *,
    initial_force: Array | None = None,
    polish: bool = True,
    **settings: Any,
) -> tuple[ContactSolution, ContactProblem]:
    """Solve the contact problem with load-dependent line contact, and prove the answer.

    Parameters
    ----------
    separation, lever_arm
        Of the segments (n) [mm], see `ContactProblem`.
    torque
        About the gear axis [N mm].
    bending_compliance
        Compliance B of teeth and roots, without the local part [mm/N], positive semidefinite: an (n, n) array, or the
        pair of an (n) and an (n, k) array.
    line_contact
        The local part.
    solver
        Solver of the linear problems; see `solve`.
    initial_force
        Warm start: the forces of a neighbouring problem (n) [N]. Ignored if they are NaN, as where that problem failed.
    polish
        See `solve`.
    **settings
        Passed to the solver: a time limit or a step limit of the native solver holds for all linear problems together,
        that of another one for each.

    Returns
    -------
    ContactSolution
        Its certificate is that of the nonlinear problem, ``iterations`` counts the linear problems solved. The status
        is `Status.NOT_CONVERGED` if the iteration did not settle, or that of the linear problem that failed.
    ContactProblem
        The linear problem with the secant compliance at the solution, which has the same solution.

    Raises
    ------
    InputError, MissingSolverError
        As `ContactProblem` and `solve`.

    Examples
    --------
    >>> import numpy as np
    >>> from easeoff.contact import Material
    >>> from easeoff.contact.compliance.weber_line_contact import WeberLineContact
    >>> steel = Material(206000.0, 0.3)
    >>> sizes = [np.full(3, value) for value in (1.5, 30.0, 3.0, 3.0)]  # length, radius and depths [mm]
    >>> bending = (np.zeros(3), np.full((3, 1), 1e-3))
    >>> gap, arm = np.array([0.01, 0.0, 0.01]), np.full(3, 40.0)
    >>> solution, _ = solve_line_contact(gap, arm, 1.2e5, bending, WeberLineContact(*sizes, steel, steel))
    >>> solution.certified, round(float(solution.force.sum()), 6)
    (True, 3000.0)
    """
    bending = ContactProblem(separation, lever_arm, torque, bending_compliance)
    return solve_on_bending(bending, line_contact, solver, initial_force=initial_force, polish=polish, **settings)


def solve_on_bending(
    bending: ContactProblem,
    line_contact: LineContact,
    solver: SolverChoice = "auto",
    *,
    initial_force: Array | None = None,
    polish: bool = True,
    **settings: Any,
) -> tuple[ContactSolution, ContactProblem]:
    """As `solve_line_contact`, for a contact problem whose compliance is that of bending alone."""
    name = require_solver(solver)
    uniform = np.full(bending.size, bending.torque / float(np.maximum(bending.lever_arm, 0.0).sum()))
    start = _warm_start(initial_force, bending)
    warm = start is not None
    start = uniform if start is None else start
    try:
        linear = bending.with_added_compliance(line_contact.secant(start))
    except InputError as error:
        return _failed(bending, Status.INVALID_DATA, name, f"line contact: {error}"), bending
    idle = bending.torque == 0.0 and bending.separation_at_first_contact.min() >= 0.0
    if idle or not linear.is_positive_semidefinite:
        return solve(linear, solver, polish=polish, **settings), linear

    step = NativeStep(linear, bending, settings) if name == "native" else BackendStep(bending, solver, polish, settings)
    iteration = NewtonIteration(bending, linear.scaling, line_contact, step)
    status = iteration.run(start if warm else None, linear)
    if status is not None:
        return _failed(bending, status, name, iteration.message, iteration.count), linear
    return certified_on_secant(
        bending,
        line_contact,
        iteration.force,
        iteration.rotation,
        name,
        tolerance=iteration.step.tolerance,
        iterations=iteration.count,
        method=iteration.step.method,
        polished=iteration.step.polished,
        message=(
            f"Newton's method on the line contacts with {name} ({iteration.step.method}): "
            f"{iteration.count} linear problems"
        ),
    )


def certified_on_secant(
    bending: ContactProblem,
    line_contact: LineContact,
    force: Array,
    elastic_rotation: float,
    name: str,
    *,
    tolerance: float,
    iterations: int,
    message: str,
    method: str = "",
    polished: bool = False,
) -> tuple[ContactSolution, ContactProblem]:
    """Certify an answer of the nonlinear problem on the linear one with its secant compliance; see `judged`."""
    try:
        problem = bending.with_added_compliance(line_contact.secant(force))
    except InputError as error:
        return _failed(bending, Status.INVALID_DATA, name, f"line contact: {error}", iterations), bending
    solution = judged(
        name,
        with_certificate(problem, force, elastic_rotation),
        tolerance=tolerance,
        iterations=iterations,
        method=method,
        polished=polished,
        message=message,
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
