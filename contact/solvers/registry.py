"""Registry of the solvers, and `solve`, which calls any of them and certifies its answer."""

from __future__ import annotations

import difflib
import importlib
import importlib.util
from dataclasses import asdict, dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...core.arrays import Bools, RealArray as Array
from ...core.checks import array, instance, one_of, shown, truth
from ...core.errors import InputError, MissingSolverError, how_to_install
from ..problem.certificate import EXACT_TOLERANCE, NO_CERTIFICATE, unscaled, with_certificate
from ..problem.compliance_matrix import ModalCompliance
from ..problem.conditioning import is_unbounded
from ..problem.contact_problem import ContactProblem
from ..problem.scaled_problem import ScaledProblem
from . import native
from .backend import FORMS, Adapter, chosen_form
from .backend_solution import ASSUMED, DEFAULT_POLISH, adapter_of, backend_solution
from .compiled.compiled_answer import dense_answer, is_small, linear_answer
from .solution import CallTimes, ContactSolution, Status, course, judged, no_solution
from .solver_declaration import ChosenSolver, Solver, SolverChoice, declared_solver, entry_point_names
from .solver_limits import Limits, StepBudget, backend_keywords
from .solver_table import SOLVERS

#: A certificate this good is rounding; the native cascade looks no further.
ROUNDING_LEVEL = 1e-10
#: Moment of forces to start from, over the greatest force on the longest lever arm, below which it is not scaled.
SMALLEST_MOMENT = 1e-3
_NATIVE = {asked: ChosenSolver("native", None, asked) for asked in ("auto", "native")}
#: Why a problem is unbounded, in words.
NO_MINIMUM = "segments without compliance penetrate at every rotation, no force can part them"


def available_solvers() -> list[str]:
    """Return the names of the solvers that can be used here: the native one, the table's, and those of entry points.

    Examples
    --------
    >>> available_solvers()[0]
    'native'
    """
    return [name for name in SOLVERS if _is_installed(name)] + entry_point_names()


def require_solver(solver: SolverChoice) -> str:
    """Return the name of a usable solver; ``"auto"`` stands for the native one.

    Parameters
    ----------
    solver
        As of `solve`.

    Raises
    ------
    InputError
        The name is unknown; the message lists the known ones. Or a solver of one's own cannot be imported.
    MissingSolverError
        Its package is not installed; the message says what installs it.

    Examples
    --------
    >>> require_solver("auto")
    'native'
    """
    return chosen_solver(solver).name


def chosen_solver(solver: SolverChoice) -> ChosenSolver:
    """Find what a user's choice stands for, where it enters; what was found is returned as it is. Raises as above."""
    if isinstance(solver, ChosenSolver):
        return solver
    if isinstance(solver, str) and solver in _NATIVE:
        return _NATIVE[solver]
    if (declared := declared_solver(solver)) is not None:
        return ChosenSolver(declared.name, declared, solver if isinstance(solver, str) else declared.name)
    name = str(solver)
    if name not in SOLVERS:
        known = [*SOLVERS, *entry_point_names()]
        close = difflib.get_close_matches(name, known, n=1)
        hint = f"; did you mean {close[0]!r}?" if close else ""
        raise InputError(f"solver = {shown(name)}: must be one of auto, {', '.join(known)}, or MODULE:FUNCTION{hint}")
    if not _is_installed(name):
        raise MissingSolverError(f"solver {name!r} is not installed: {how_to_install(SOLVERS[name].requirement)}")
    return ChosenSolver(name, None, name)


def solve(
    problem: ContactProblem,
    solver: SolverChoice = "auto",
    *,
    tolerance: float | None = None,
    time_limit: float | None = None,
    max_iterations: int | None = None,
    polish: bool = True,
    initial_active: ArrayLike | None = None,
    initial_force: ArrayLike | None = None,
    form: str = "auto",
    **settings: Any,
) -> ContactSolution:
    """Solve a contact problem and prove the answer.

    Parameters
    ----------
    problem
        The contact problem.
    solver
        One of `available_solvers`, or ``"auto"``; or a solver of one's own: a `Solver`, a function, or
        ``module:function``.
    tolerance
        Largest violation that the certificate of the answer may have; by default `EXACT_TOLERANCE` whichever solver
        gave it, which a larger tolerance leaves as it is for polished and native answers. With it the stopping
        tolerances of a backend are set so that it reaches it, see `SolverSettings.tolerance_settings`; by default they
        are those of the table.
    time_limit
        Wall time for the solver [s]; for `Status.TIME_LIMIT`. The compiled modal method, which ends in 60 steps, is not
        interrupted.
    max_iterations
        Steps of the solver, for `Status.NOT_CONVERGED`. Of the native solver a step is a linear system, over all its
        methods.
    polish
        Make the answer of a backend exact by a solve on the active set it found, with up to `MAX_EXCHANGES` exchanges
        of segments; its certificate must then reach `EXACT_TOLERANCE`. The result says whether this was done, and with
        how many exchanges. The native solver needs none.
    initial_active
        Segments assumed in contact, a mask (n) or an array of indices, from a neighbouring problem; a warm start of the
        native solver, ignored by the others.
    initial_force
        Forces of a neighbouring problem (n) [N]: a warm start of all solvers that have one, ignored by the others.
        Their size does not matter: they are scaled to the torque, and negative ones left out.
    form
        Form of a structured problem for a backend: ``"dense"``, the matrix C; ``"lifted"``, the sparse form of
        `lifted_qp`, for those that have a size ``lifted_from`` in the table of settings; ``"auto"``, the lifted one
        from that size on. For a solver of one's own one of its forms; ``"auto"``, the first that the problem has.
    **settings
        Passed to the backend on top of the settings of the table; for the native solver, ``method``.

    Returns
    -------
    ContactSolution
        With NaN forces unless its status is `Status.CERTIFIED`. Its certificate alone decides, not the
        report of the backend.

    Raises
    ------
    InputError
        Unknown solver or setting, a limit that the solver cannot have, an initial set of the wrong shape, or a form
        that the solver or the problem cannot have.
    MissingSolverError
        The solver is not installed.

    Examples
    --------
    >>> import numpy as np
    >>> problem = ContactProblem(np.zeros(4), np.full(4, 50.0), 2.0e5, np.diag(np.full(4, 2e-6)))
    >>> solution = solve(problem)
    >>> solution.status.name, solution.force[0].item(), round(solution.rotation * 1e6, 6)
    ('CERTIFIED', 1000.0, 40.0)
    >>> solution = solve(problem, "osqp", tolerance=1e-4, time_limit=60.0, max_iterations=1000)
    >>> solution.message.split(": ")[1].split(";")[0]
    'made exact on the active set it found'
    """
    instance("problem", problem, ContactProblem)
    one_of("form", form, FORMS)
    truth("polish", polish)
    start = perf_counter()
    limits = Limits(tolerance, time_limit, max_iterations)
    chosen = chosen_solver(solver)
    plain = chosen.is_native and form == "auto" and not settings and max_iterations is None
    force = None if initial_force is None else array("initial_force", initial_force, "N", ndim=1, size=problem.size)
    active = None if force is None else force > 0.0
    if initial_active is not None:
        active = as_mask(initial_active, problem.size)
    if plain and (time_limit is None or perf_counter() - start < time_limit):
        solution = compiled_solution(problem, active, start)
        if solution is not None and solution.certificate.passes(limits.exact_tolerance):
            return solution if tolerance is None else replace(solution, tolerance=limits.exact_tolerance)
    request = _Request(problem, limits, polish, active, force, form, settings, start)
    return replace(_solved(request, chosen), run_time=perf_counter() - start)


@dataclass(frozen=True, eq=False)
class _Request:
    """Checked arguments of `solve`."""

    problem: ContactProblem
    limits: Limits
    polish: bool
    active: Bools | None
    force: Array | None
    form: str
    settings: dict[str, Any]
    start: float


def compiled_solution(problem: ContactProblem, active: Bools | None, start: float) -> ContactSolution | None:
    """Certified solution of a compiled method, or None; ``start`` is when the call began [s]."""
    matrix = problem.compliance_matrix
    if is_small(matrix, problem.size):
        outcome, method = dense_answer(problem, active), "primal_dual_active_set"
    elif isinstance(matrix, ModalCompliance) and matrix.has_few_modes:  # else to find few costs more than the solution
        outcome, method = linear_answer(problem, active), "modal"
    else:
        return None
    if outcome is None:
        return None
    certificate = outcome.answer.certificate
    if not (certificate.worst <= ROUNDING_LEVEL and certificate.passes()):
        return None
    return judged(
        "native",
        outcome.answer,
        tolerance=EXACT_TOLERANCE,
        iterations=outcome.iterations,
        method=method,
        run_time=perf_counter() - start,
        message=f"native, {native.METHODS[method][0]}, {outcome.iterations} steps: certified",
        times=CallTimes(outcome.setup_time + outcome.solve_time, outcome.setup_time, outcome.solve_time, "solver"),
    )


def _solved(request: _Request, solver: ChosenSolver) -> ContactSolution:
    problem, name = request.problem, solver.name
    if not problem.is_positive_semidefinite:
        message = f"{name}, not begun: the compliance has a negative eigenvalue, some forces would release energy"
        return no_solution(problem.size, Status.NOT_POSITIVE_SEMIDEFINITE, name, message=message)
    if problem.torque == 0.0 and problem.separation_at_first_contact.min() >= 0.0:
        # Nothing to solve: the bodies just touch. (A segment with a negative lever arm may have to be forced open.)
        touching = with_certificate(problem, np.zeros(problem.size), 0.0)
        message = f"{name}, not begun: without a torque the bodies just touch"
        return judged(name, touching, tolerance=EXACT_TOLERANCE, iterations=0, message=message)
    begin = perf_counter()
    scaled = problem.scaled()
    setup = perf_counter() - begin
    if not scaled.is_finite:
        message = f"{name}, not begun: the numbers overflow when scaled"
        return no_solution(problem.size, Status.INVALID_DATA, name, message=message)
    if solver.is_native:
        chosen_form(name, scaled, request.form)
        try:
            begin = perf_counter()
            solution = _solve_native(request, scaled)
            spent = perf_counter() - begin
            return replace(solution, times=CallTimes(setup + spent, setup, spent, "solver"))
        except (ArithmeticError, np.linalg.LinAlgError) as error:  # pragma: no cover - no data are known that lead here
            message = f"native: it failed; {type(error).__name__}: {error}"
            return no_solution(problem.size, Status.SOLVER_FAILED, name, message=message)
    solution = _solve_backend(request, solver)
    limited = request.limits.time_limit is not None or request.limits.max_iterations is not None
    ended = limited and solution.status in (Status.TIME_LIMIT, Status.NOT_CONVERGED)
    missed = scaled.has_matrix and not solution.certified
    if missed and not ended and is_unbounded(problem):
        return replace(solution, status=Status.UNBOUNDED, message=f"{solution.message}; {NO_MINIMUM}")
    if missed and solver.facts.definite and not _is_definite(scaled.compliance):
        reason = f"{name} is for positive definite compliances, and this one is singular to rounding"
        return replace(solution, message=f"{solution.message}; {reason}")
    return solution


def _solve_backend(request: _Request, solver: ChosenSolver) -> ContactSolution:
    limits, settings, start, name, declared = request.limits, request.settings, {}, solver.name, solver.declaration
    if request.force is not None and solver.facts.warm_start:
        start["initvals"] = start_force(request.force, request.problem) / request.problem.scaling.force
    adapter: Adapter | Solver
    if declared is None:
        adapter, keywords = adapter_of(name), backend_keywords(name, limits, settings)
    else:
        adapter, keywords = declared, declared.keywords(asdict(limits), settings)
    return backend_solution(
        request.problem,
        name,
        adapter,
        {**keywords, **start},
        form=request.form,
        polish=DEFAULT_POLISH if request.polish else None,
        options=tuple(settings) if declared is None else (),  # what a function of one's own takes is known already
        limits=limits,
    )


def _solve_native(request: _Request, scaled: ScaledProblem) -> ContactSolution:
    problem, limits = request.problem, request.limits
    budget = StepBudget(limits, request.start)
    start = problem.scaling.estimated_active if request.active is None else request.active
    best: ContactSolution | None = None
    for method, answer in native.answers(scaled, start, request.settings, budget):
        solution = judged(
            "native",
            unscaled(problem, answer.force, answer.rotation),
            tolerance=limits.exact_tolerance,
            suspicion=answer.suspicion,
            iterations=answer.iterations,
            method=method,
        )
        solution = replace(solution, message=course(f"native, {native.METHODS[method][0]}", solution))
        if best is None or solution.certificate.worst < best.certificate.worst:
            best = solution
        if best.certificate.worst <= min(ROUNDING_LEVEL, limits.exact_tolerance) and best.certified:
            break
    if best is not None and best.certified:
        return best if scaled.has_matrix else replace(best, message=f"{best.message}; {ASSUMED}")
    if budget.met is not None:
        limit = f"time limit of {limits.time_limit:g} s" if budget.met is Status.TIME_LIMIT else "step limit"
        limit += f" of {limits.max_iterations}" if budget.met is Status.NOT_CONVERGED else ""
        status, reason = budget.met, f"ended at the {limit}"
    elif scaled.has_matrix and is_unbounded(problem):
        status, reason = Status.UNBOUNDED, NO_MINIMUM
    elif best is None:
        status, reason = Status.NOT_CONVERGED, "no method had an answer"
    else:
        return best
    certificate = NO_CERTIFICATE if best is None else best.certificate
    facts: dict[str, Any] = {"certificate": certificate, "message": f"native: {reason}", "tolerance": EXACT_TOLERANCE}
    return no_solution(problem.size, status, "native", **facts)


def start_force(force: Array, problem: ContactProblem) -> Array:
    """Forces of any size (n) [N] as a start: in balance with the torque, or of the size of the load where none are."""
    start = np.maximum(force, 0.0)
    if not start.max() > 0.0:
        return start
    start /= start.max()
    moment, longest = float(start @ problem.lever_arm), float(np.abs(problem.lever_arm).max())
    balanced = problem.torque > 0.0 and moment > SMALLEST_MOMENT * longest
    return np.asarray(start * (problem.torque / moment if balanced else problem.scaling.force))


def _is_definite(matrix: Array) -> bool:
    """True if a positive semidefinite matrix has no eigenvalue that rounding could have made."""
    eigenvalues = np.linalg.eigvalsh(matrix)
    return bool(eigenvalues[0] > matrix.shape[0] * np.finfo(np.float64).eps * eigenvalues[-1])


def _is_installed(name: str) -> bool:
    package = SOLVERS[name].package
    needed = [package] if package in ("", "cvxpy") else ["qpsolvers", package]
    return all(not one or importlib.util.find_spec(one) is not None for one in needed)


def as_mask(active: ArrayLike, size: int) -> Bools:
    """Return a warm start as a mask of the segments (n); raises as `solve`."""
    try:
        array = np.asarray(active)
    except (TypeError, ValueError):
        array = np.asarray(None)
    if array.dtype == np.bool_:
        if array.shape != (size,):
            raise InputError(f"initial_active = {shown(array)}: must be a mask of shape ({size},), or indices")
        return array
    if array.ndim != 1 or (array.size and not np.issubdtype(array.dtype, np.integer)):
        raise InputError(f"initial_active = {shown(array)}: must be a mask of the segments, or a list of their indices")
    if array.size and (array.min() < 0 or array.max() >= size):
        raise InputError(f"initial_active = {array.tolist()}: must be segments from 0 to {size - 1}")
    mask = np.zeros(size, dtype=np.bool_)
    mask[array.astype(np.intp)] = True
    return mask
