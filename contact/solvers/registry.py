"""One door to every solver: `solve` scales, calls, polishes, certifies, and turns every failure into a status."""

from __future__ import annotations

import difflib
import importlib
import importlib.util
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...core.errors import InputError, MissingSolverError, how_to_install
from ..problem.certificate import EXACT_TOLERANCE
from ..problem.contact_problem import ContactProblem
from ..problem.recovered import recovered, with_certificate
from ..problem.scaling import ScaledProblem
from . import native
from .backend import FORMS, NoAnswerError, chosen_form
from .judge import judge, judge_scaled
from .polish import recover_answer
from .scaled_answer import ScaledAnswer
from .solution import ContactSolution, Status, no_solution
from .solver_table import SOLVERS

#: A certificate this good is rounding; the native cascade looks no further.
ROUNDING_LEVEL = 1e-10


def available_solvers() -> list[str]:
    """Return the names of the solvers that can be used here, the native one first."""
    return [name for name in SOLVERS if _is_installed(name)]


def require_solver(name: str) -> str:
    """Return the name of a usable solver; ``"auto"`` stands for the native one.

    Raises
    ------
    InputError
        The name is unknown; the message lists the known ones.
    MissingSolverError
        Its package is not installed; the message says what installs it.
    """
    if name == "auto":
        return "native"
    if name not in SOLVERS:
        close = difflib.get_close_matches(str(name), SOLVERS, n=1)
        hint = f" (did you mean {close[0]!r}?)" if close else ""
        raise InputError(f"unknown solver {name!r}{hint}: choose from auto, {', '.join(SOLVERS)}")
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
    problem : ContactProblem
    solver : str
        One of `available_solvers`, or ``"auto"``.
    polish : bool
        Make the answer of a backend exact by one solve on the active set it found; its certificate must then reach
        `EXACT_TOLERANCE`. The result says whether this was done. The native solver needs none.
    initial_active : (n) bool array or array of indices, optional
        Segments thought to touch, from a neighbouring problem; a warm start of the native solver, ignored by the
        others.
    form : str
        What a backend gets of a structured problem: ``"dense"``, the matrix C; ``"lifted"``, the sparse form of
        `lifted_qp`, for those that have a size ``lifted_from`` in the table of settings; ``"auto"``, the lifted one
        from that size on.
    **settings
        Passed to the backend on top of the settings of the table; for the native solver, ``method``.

    Returns
    -------
    ContactSolution
        With NaN forces unless its status is `Status.CERTIFIED`. What a backend says of itself is not believed: the
        certificate decides, in both directions.

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
    name = require_solver(solver)
    if form not in FORMS:
        raise InputError(f"unknown form {form!r}: choose from {', '.join(FORMS)}")
    active = None if initial_active is None else as_mask(initial_active, problem.size)
    if not problem.is_positive_semidefinite:
        return no_solution(
            problem.size,
            Status.NOT_POSITIVE_SEMIDEFINITE,
            name,
            message="the compliance has a negative eigenvalue: forces would do work for nothing",
        )
    if problem.torque == 0.0 and problem.separation_at_first_contact.min() >= 0.0:
        # Nothing to solve: the bodies just touch. (A segment with a negative lever arm may have to be forced open.)
        touching = with_certificate(problem, np.zeros(problem.size), 0.0)
        return judge(name, touching, tolerance=EXACT_TOLERANCE, iterations=0, message="no torque: first contact")
    scaled = problem.scaling.scale(problem)
    if not scaled.is_finite:
        return no_solution(problem.size, Status.INVALID_DATA, name, message="the numbers overflow when scaled")
    chosen = chosen_form(name, scaled, form)
    if name == "native":
        try:
            return _solve_native(problem, scaled, active, settings)
        except (ArithmeticError, np.linalg.LinAlgError) as error:  # pragma: no cover - no data are known that lead here
            return no_solution(problem.size, Status.SOLVER_FAILED, name, message=f"{type(error).__name__}: {error}")
    return _solve_backend(problem, scaled, name, polish, chosen, settings)


def _solve_native(
    problem: ContactProblem, scaled: ScaledProblem, active: NDArray[np.bool_] | None, settings: dict[str, Any]
) -> ContactSolution:
    start = problem.scaling.estimated_active if active is None else active
    best: ContactSolution | None = None
    for answer in native.answers(scaled, start, settings):
        result = recovered(problem, answer.force, answer.rotation)
        solution = judge_scaled("native", answer, result, EXACT_TOLERANCE)
        if best is None or solution.certificate.worst < best.certificate.worst:
            best = solution
        if best.certificate.worst <= ROUNDING_LEVEL:
            break
    if best is None:
        best = no_solution(
            problem.size, Status.NOT_CONVERGED, "native", message="no method had an answer", tolerance=EXACT_TOLERANCE
        )
    if not best.certified and _is_unbounded(scaled):
        return no_solution(
            problem.size,
            Status.UNBOUNDED,
            "native",
            certificate=best.certificate,
            message="segments without compliance penetrate at every rotation: no force can part them",
        )
    return best


def _solve_backend(
    problem: ContactProblem, scaled: ScaledProblem, name: str, polish: bool, form: str, settings: dict[str, Any]
) -> ContactSolution:
    solution = _backend_solution(problem, scaled, name, polish, form, settings)
    if SOLVERS[name].definite and not solution.certified and not _is_definite(scaled.compliance):
        reason = f"{name} is for positive definite compliances, and this one is singular to rounding"
        return replace(solution, message=f"{solution.message}; {reason}")
    return solution


def _backend_solution(
    problem: ContactProblem, scaled: ScaledProblem, name: str, polish: bool, form: str, settings: dict[str, Any]
) -> ContactSolution:
    entry = SOLVERS[name]
    options = {**entry.settings, **settings}
    if form == "lifted":
        options["form"] = form
    adapter = importlib.import_module(f".adapters.{name}", __package__)
    try:
        answer: ScaledAnswer = adapter.solve_scaled(scaled, options)
    except InputError:
        raise
    except NoAnswerError as error:
        status = error.suspicion or Status.SOLVER_FAILED
        return no_solution(problem.size, status, name, message=str(error), tolerance=entry.tolerance)
    except Exception as error:
        if settings and isinstance(error, TypeError | AttributeError | ValueError):
            raise InputError(f"{name} refuses the settings {', '.join(sorted(settings))}: {error}") from error
        message = f"{type(error).__name__}: {error}"
        return no_solution(problem.size, Status.SOLVER_FAILED, name, message=message, tolerance=entry.tolerance)
    result, polished = recover_answer(problem, scaled, answer, polished=polish)
    tolerance = EXACT_TOLERANCE if polished else entry.tolerance
    return judge_scaled(name, answer, result, tolerance, polished=polished)


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
            raise InputError(f"initial_active has the shape {array.shape}, expected ({size},)")
        return array
    if array.ndim != 1 or (array.size and not np.issubdtype(array.dtype, np.integer)):
        raise InputError("initial_active is neither a mask of the segments nor a list of their indices")
    if array.size and (array.min() < 0 or array.max() >= size):
        raise InputError(f"initial_active names segments outside 0..{size - 1}")
    mask = np.zeros(size, dtype=np.bool_)
    mask[array.astype(np.intp)] = True
    return mask
