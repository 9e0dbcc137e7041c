"""Registry of the solvers, and `solve`, which calls any of them and certifies its answer."""

from __future__ import annotations

import difflib
import importlib
import importlib.util
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...core.checks import one_of, shown
from ...core.errors import InputError, MissingSolverError, how_to_install
from ..problem.answer import unscaled, with_certificate
from ..problem.certificate import EXACT_TOLERANCE
from ..problem.contact_problem import ContactProblem
from ..problem.scaled_problem import ScaledProblem
from . import native
from .active_set.polish import PolishRule
from .backend import FORMS, chosen_form
from .backend_solution import adapter_of, backend_solution
from .compiled.compiled_answer import linear_answer
from .scaled_answer import ScaledAnswer
from .solution import SOLVED, ContactSolution, Status, judged, no_solution
from .solver_table import SOLVERS

#: A certificate this good is rounding; the native cascade looks no further.
ROUNDING_LEVEL = 1e-10


def available_solvers() -> list[str]:
    """Return the names of the solvers that can be used here, the native one first.

    Examples
    --------
    >>> available_solvers()[0]
    'native'
    """
    return [name for name in SOLVERS if _is_installed(name)]


def require_solver(name: str) -> str:
    """Return the name of a usable solver; ``"auto"`` stands for the native one.

    Raises
    ------
    InputError
        The name is unknown; the message lists the known ones.
    MissingSolverError
        Its package is not installed; the message says what installs it.

    Examples
    --------
    >>> require_solver("auto")
    'native'
    """
    if name == "auto":
        return "native"
    if name not in SOLVERS:
        close = difflib.get_close_matches(str(name), SOLVERS, n=1)
        hint = f"; did you mean {close[0]!r}?" if close else ""
        raise InputError(f"solver = {shown(name)}: must be one of auto, {', '.join(SOLVERS)}{hint}")
    if not _is_installed(name):
        raise MissingSolverError(f"solver {name!r} is not installed: {how_to_install(SOLVERS[name].requirement)}")
    return name


def solve(
    problem: ContactProblem,
    solver: str = "auto",
    *,
    polish: bool = True,
    initial_active: ArrayLike | None = None,
    form: str = "auto",
    **settings: Any,
) -> ContactSolution:
    """Solve a contact problem and prove the answer.

    Parameters
    ----------
    problem
        The contact problem.
    solver
        One of `available_solvers`, or ``"auto"``.
    polish
        Make the answer of a backend exact by a solve on the active set it found, with up to `MAX_EXCHANGES` exchanges
        of segments; its certificate must then reach `EXACT_TOLERANCE`. The result says whether this was done, and with
        how many exchanges. The native solver needs none.
    initial_active
        Segments assumed in contact, a mask (n) or an array of indices, from a neighbouring problem; a warm start of the
        native solver, ignored by the others.
    form
        Form of a structured problem for a backend: ``"dense"``, the matrix C; ``"lifted"``, the sparse form of
        `lifted_qp`, for those that have a size ``lifted_from`` in the table of settings; ``"auto"``, the lifted one
        from that size on.
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
        Unknown solver or setting, an initial set of the wrong shape, or a form that the solver or the problem cannot
        have.
    MissingSolverError
        The solver is not installed.

    Examples
    --------
    >>> import numpy as np
    >>> problem = ContactProblem(np.zeros(4), np.full(4, 50.0), 2.0e5, np.diag(np.full(4, 2e-6)))
    >>> solution = solve(problem)
    >>> solution.status.name, solution.force[0].item(), round(solution.rotation * 1e6, 6)
    ('CERTIFIED', 1000.0, 40.0)
    """
    start = perf_counter()
    if solver in ("auto", "native") and form == "auto" and not settings:
        compiled = compiled_solution(problem, initial_active, start)
        if compiled is not None:
            return compiled
    solution = _solved(problem, require_solver(solver), polish, initial_active, form, settings)
    return replace(solution, run_time=perf_counter() - start)


def compiled_solution(problem: ContactProblem, initial: ArrayLike | None, start: float) -> ContactSolution | None:
    """Return the certified solution of the compiled modal method; None where it has none.

    Parameters
    ----------
    problem, initial
        As of `solve`.
    start
        Time at which the call began [s].
    """
    found = linear_answer(problem, None if initial is None else as_mask(initial, problem.size))
    if found is None:
        return None
    certificate = found.answer.certificate
    if not (certificate.worst <= ROUNDING_LEVEL and certificate.passes()):
        return None
    return ContactSolution(
        found.answer,
        Status.CERTIFIED,
        "native",
        found.iterations,
        SOLVED,
        "modal",
        perf_counter() - start,
        False,
        EXACT_TOLERANCE,
        "modal",
    )


def _solved(
    problem: ContactProblem, name: str, polish: bool, initial: ArrayLike | None, form: str, settings: dict[str, Any]
) -> ContactSolution:
    one_of("form", form, FORMS)
    active = None if initial is None else as_mask(initial, problem.size)
    if not problem.is_positive_semidefinite:
        message = "the compliance has a negative eigenvalue: some forces would release energy"
        return no_solution(problem.size, Status.NOT_POSITIVE_SEMIDEFINITE, name, message=message)
    if problem.torque == 0.0 and problem.separation_at_first_contact.min() >= 0.0:
        # Nothing to solve: the bodies just touch. (A segment with a negative lever arm may have to be forced open.)
        touching = with_certificate(problem, np.zeros(problem.size), 0.0)
        message = "no torque: the bodies touch where they meet first"
        return judged(name, touching, tolerance=EXACT_TOLERANCE, iterations=0, message=message)
    scaled = problem.scaled()
    if not scaled.is_finite:
        return no_solution(problem.size, Status.INVALID_DATA, name, message="the numbers overflow when scaled")
    if name == "native":
        chosen_form(name, scaled, form)
        try:
            return _solve_native(problem, scaled, active, settings)
        except (ArithmeticError, np.linalg.LinAlgError) as error:  # pragma: no cover - no data are known that lead here
            return no_solution(problem.size, Status.SOLVER_FAILED, name, message=f"{type(error).__name__}: {error}")
    keywords, own = {**SOLVERS[name].settings, **settings}, tuple(settings)
    rule = PolishRule() if polish else None
    solution = backend_solution(problem, name, adapter_of(name), keywords, form=form, polish=rule, own=own)
    if SOLVERS[name].definite and not solution.certified and not _is_definite(scaled.compliance):
        reason = f"{name} is for positive definite compliances, and this one is singular to rounding"
        return replace(solution, message=f"{solution.message}; {reason}")
    return solution


def _solve_native(
    problem: ContactProblem, scaled: ScaledProblem, active: NDArray[np.bool_] | None, settings: dict[str, Any]
) -> ContactSolution:
    start = problem.scaling.estimated_active if active is None else active
    best: ContactSolution | None = None
    for method, answer in native.answers(scaled, start, settings):
        solution = judged_native(problem, method, answer)
        if best is None or solution.certificate.worst < best.certificate.worst:
            best = solution
        if best.certificate.worst <= ROUNDING_LEVEL:
            break
    if best is None:
        message = "no method had an answer"
        best = no_solution(problem.size, Status.NOT_CONVERGED, "native", message=message, tolerance=EXACT_TOLERANCE)
    if not best.certified and _is_unbounded(scaled):
        message = "segments without compliance penetrate at every rotation: no force can part them"
        return no_solution(problem.size, Status.UNBOUNDED, "native", certificate=best.certificate, message=message)
    return best


def judged_native(problem: ContactProblem, method: str, answer: ScaledAnswer) -> ContactSolution:
    """Return the solution of an answer of a method of the native solver; see `judged`."""
    return judged(
        "native",
        unscaled(problem, answer.force, answer.rotation),
        tolerance=EXACT_TOLERANCE,
        suspicion=answer.suspicion,
        iterations=answer.iterations,
        method=method,
        message=answer.message,
    )


def _is_unbounded(problem: ScaledProblem) -> bool:
    """Whether some combination of forces meets no compliance, has no moment, and closes penetration for ever."""
    if problem.separation.min() >= 0.0:
        return False  # then the energy of every admissible load is bounded below by zero
    from scipy.optimize import linprog

    rows = np.vstack([problem.compliance, problem.lever_arm[np.newaxis, :]])
    result = linprog(problem.separation, A_eq=rows, b_eq=np.zeros(rows.shape[0]), bounds=(0.0, 1.0))
    return result.status == 0 and float(result.fun or 0.0) < -1e-6 * float(np.abs(problem.separation).max())


def _is_definite(matrix: NDArray[np.float64]) -> bool:
    """Whether a positive semidefinite matrix has no eigenvalue that rounding could have made."""
    eigenvalues = np.linalg.eigvalsh(matrix)
    return bool(eigenvalues[0] > matrix.shape[0] * np.finfo(np.float64).eps * eigenvalues[-1])


def _is_installed(name: str) -> bool:
    package = SOLVERS[name].package
    if not package:
        return True
    if package != "cvxpy" and importlib.util.find_spec("qpsolvers") is None:
        return False
    return importlib.util.find_spec(package) is not None


def as_mask(active: ArrayLike, size: int) -> NDArray[np.bool_]:
    """Return a warm start as a mask of the segments (n); raises as `solve`."""
    array = np.asarray(active)
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
