"""Solution of a problem by a backend: scaled, polished and certified; every failure becomes a status."""

from __future__ import annotations

import importlib
import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cache, partial
from time import perf_counter
from typing import Any

from ...core.arrays import RealArray as Array
from ...core.errors import InputError, MissingSolverError
from ...core.foreign_code import IMPORT_TIME_LIMIT, ForeignCodeError, foreign_code, reason_of
from ..problem.certificate import EXACT_TOLERANCE, of_whole_rotation
from ..problem.compliance_matrix import ModalCompliance
from ..problem.contact_problem import ContactProblem
from ..problem.scaled_problem import ScaledModes, ScaledProblem
from .backend import Adapter, NoAnswerError, chosen_form, solve_scaled
from .polish import Polish, PolishRule, polished_answer
from .solution import OWN_ENDS, RAISED, SOLVED, CallTimes, ContactSolution, Status, course, judged, no_solution
from .solver_declaration import Solver
from .solver_limits import Limits, limit_hint
from .solver_table import SOLVERS

#: What is said of a compliance that is known by its products alone.
ASSUMED = "that the compliance is positive semidefinite is assumed, products cannot prove it"
#: Time beyond its limit in which a solver of one's own may still end by itself, before it is ended [s].
GRACE_TIME = 1.0
#: Polish of `solve`, and no limits.
DEFAULT_POLISH, NO_LIMITS = PolishRule(), Limits()


def adapter_of(solver: str) -> Adapter:
    """Adapter of a solver of the table, with its package loaded; the native one has none."""
    if SOLVERS[solver].report:
        _load(solver)
        return partial(solve_scaled, solver)
    adapter: Adapter = _load(solver, f".adapters.{solver}").solve_scaled
    return adapter


@cache
def _load(solver: str, adapter: str = "") -> Any:
    """Load the package of a solver and the module of its adapter, if it has one."""
    try:
        with foreign_code(IMPORT_TIME_LIMIT, silent=True):
            for package in filter(None, ("qpsolvers" if SOLVERS[solver].report else "", SOLVERS[solver].package)):
                importlib.import_module(package)
            return importlib.import_module(adapter, __package__) if adapter else None
    except ForeignCodeError as error:
        raise MissingSolverError(f"solver {solver!r} cannot be loaded: {error}") from error


def backend_solution(
    problem: ContactProblem,
    solver: str,
    adapter: Adapter | Solver,
    settings: Mapping[str, Any],
    *,
    form: str = "auto",
    polish: PolishRule | None = DEFAULT_POLISH,
    raw: bool = False,
    options: tuple[str, ...] = (),
    limits: Limits = NO_LIMITS,
) -> ContactSolution:
    """Solve a contact problem with a backend, named or of one's own, and certify its answer.

    ``raw`` gives it the problem in mm and N as it is and leaves its answer; an exception that one of the user's
    ``options`` can have caused is raised as `InputError`.
    """
    start = perf_counter()
    declared = adapter if isinstance(adapter, Solver) else None
    limit = None if declared is None or limits.time_limit is None else limits.time_limit + GRACE_TIME
    tolerance = limits.tolerance or (EXACT_TOLERANCE if declared is None else declared.tolerance)
    scaled = _as_given(problem, structured=declared is not None) if raw else problem.scaled()
    if declared is not None:
        method, what = declared.chosen_form(scaled, form), declared.method
    elif solver in SOLVERS:
        method, what = "dense" if raw else chosen_form(solver, scaled, form), SOLVERS[solver].kind
    else:
        method, what = "dense", ""
    facts: dict[str, Any] = {"tolerance": tolerance, "method": method}  # of a solution without an answer
    try:
        with foreign_code(limit, silent=declared is None):
            begin = perf_counter()
            if isinstance(adapter, Solver):
                given = adapter.solve_scaled(scaled, method, settings)
            else:
                given = adapter(scaled, {**settings, "form": method} if method == "lifted" else settings)
            answered = perf_counter()
        times = given.times or CallTimes(call=answered - begin)
        if raw:
            outcome = Polish(of_whole_rotation(problem, given.force, float(given.rotation)), False, 0)
        else:
            outcome = polished_answer(problem, scaled, given, polish if scaled.has_matrix else None)
            if polish is not None:
                times = replace(times, polish=perf_counter() - answered)
        solution = judged(
            solver,
            outcome.answer,
            tolerance=limits.exact_tolerance if outcome.polished else tolerance,
            suspicion=given.suspicion,
            claim=SOLVED if given.suspicion is None else given.suspicion.name.lower(),
            iterations=int(given.iterations),
            method=method,
            polished=outcome.polished,
            exchanges=outcome.exchanges,
            times=times,
            words=given.message,
        )
    except InputError:
        raise
    except NoAnswerError as error:
        said = Status.SOLVER_FAILED if error.suspicion is None else error.suspicion
        status, claim = said if said in OWN_ENDS else Status.NOT_CERTIFIED, error.claim or said.name.lower()
        facts |= {"claim": claim, "words": str(error)}
        solution = no_solution(problem.size, status, solver, **facts)
    except Exception as error:
        foreign = error if isinstance(error, ForeignCodeError) else None
        if options and isinstance(error.__cause__ if foreign else error, TypeError | AttributeError | ValueError):
            hint = limit_hint(solver, options)
            raise InputError(f"{solver} refuses the settings {', '.join(sorted(options))}: {error}{hint}") from error
        late = foreign is not None and foreign.is_time_limit
        status, report = (Status.TIME_LIMIT, "") if late else (Status.SOLVER_FAILED, RAISED)
        facts |= {"claim": report, "words": str(foreign) if foreign else reason_of(error)}
        solution = no_solution(problem.size, status, solver, **facts)
    label = f"{solver} ({what})" if what else solver
    message = course(f"{label}, form {method}", solution, solution.words)
    missed = not solution.certified and math.isfinite(solution.certificate.worst)
    if missed and limits.tolerance is None:
        message += f"; give tolerance=...{'' if declared is None else ', or Solver(..., tolerance=...),'} to accept it"
    if not scaled.has_matrix and solution.certified:
        message += f"; {ASSUMED}"
    return replace(solution, message=message, run_time=perf_counter() - start)


def _as_given(problem: ContactProblem, *, structured: bool) -> ScaledProblem:
    """The problem in mm and N; copies, because some backends cannot take arrays that are read-only."""
    matrix = problem.compliance_matrix
    given: Array | ScaledModes
    if structured and isinstance(matrix, ModalCompliance):
        given = ScaledModes(matrix, 1.0)
    else:
        given = problem.dense_compliance.copy()
    return ScaledProblem(given, problem.separation.copy(), problem.lever_arm.copy(), problem.torque)
