"""Attempt of a solver at a problem: its claim, its certificate and its times.

This runs in a process of its own.
"""

from __future__ import annotations

import importlib
import math
from dataclasses import dataclass, replace
from time import perf_counter, process_time

import numpy as np
from numpy.typing import NDArray

from ....contact.problem.certificate import NO_CERTIFICATE, Certificate
from ....contact.problem.contact_problem import ContactProblem
from ....contact.solvers import ContactSolution, Solver, solve
from ....contact.solvers.active_set.polish import STRICT_POLISH
from ....contact.solvers.backend_solution import Adapter, adapter_of, backend_solution
from ....contact.solvers.declared.solver_lookup import declared_solver
from ....contact.solvers.solution import RAISED
from ....core.errors import InputError
from .method import POLISHED, RAW, Method
from .posed_residual import posed_residual

#: Claims of a solver whose process ended, or was ended when its time was over.
CRASHED, TIME_LIMIT = "crashed", "time_limit"

_LONGEST_MESSAGE = 160


@dataclass(frozen=True)
class Attempt:
    """Outcome of one attempt. Times are NaN where they are not known.

    Attributes
    ----------
    claim
        Report of the solver: ``solved``, a status in lower case, ``raised`` (an exception) or ``crashed`` (its
        process ended).
    message
        Its own words.
    run_time, processor_time
        Wall time and processor time of the whole call [s]: check, scaling, solver, polish, certificate.
    call_time
        Wall time of the bare call of the solver, from its data in its form to its answer [s].
    setup_time, solve_time
        Its set-up and its solve [s], as it reports them, or else as they were measured around it.
    time_source
        Who measured these two: ``solver``, ``interface``, or an empty text.
    polish_time
        Wall time of the polish [s].
    certificate
        Of the answer, on the problem as it was given; infinite without an answer.
    posed_residual
        Of the answer, on the problem as the solver got it, see `posed_residual`; NaN without an answer.
    elastic_rotation, reference_rotation
        Rotation beyond first contact [rad], and that of the certified reference; NaN without an answer.
    iterations
        -1 if unknown.
    polished
        Whether the answer is that of one exact solve on the active set the solver found.
    exchanges
        Exchanges of segments made for that.
    load_factor
        Factor of separations and torque in this call.
    """

    claim: str
    message: str = ""
    run_time: float = math.nan
    processor_time: float = math.nan
    call_time: float = math.nan
    setup_time: float = math.nan
    solve_time: float = math.nan
    time_source: str = ""
    polish_time: float = math.nan
    certificate: Certificate = NO_CERTIFICATE
    posed_residual: float = math.nan
    elastic_rotation: float = math.nan
    reference_rotation: float = math.nan
    iterations: int = -1
    polished: bool = False
    exchanges: int = 0
    load_factor: float = 1.0

    @classmethod
    def of(cls, solution: ContactSolution) -> Attempt:
        """Return the outcome that a solution is, without what is worked out afterwards."""
        times = solution.times
        return cls(
            solution.claim,
            plain(solution.words),
            solution.run_time,
            call_time=times.call,
            setup_time=times.setup,
            solve_time=times.solve,
            time_source=times.measured_by,
            polish_time=times.polish,
            certificate=solution.certificate,
            elastic_rotation=float(solution.answer.elastic_rotation),
            iterations=solution.iterations,
            polished=solution.polished,
            exchanges=solution.exchanges,
        )


def load_adapter(solver: str) -> Adapter | Solver | None:
    """Return the adapter of a solver, or the declaration of one's own; None for the native one, which needs none.

    Parameters
    ----------
    solver
        A name of the table of solvers or of an entry point, or ``module:function``.

    Raises
    ------
    InputError
        The module cannot be imported or has no such function.
    MissingSolverError
        The package of a solver of the table cannot be loaded.
    """
    if solver == "native":
        return None
    declared = declared_solver(solver)
    if declared is None:
        return adapter_of(solver)
    importlib.import_module("qpsolvers")  # slow imports are not to be timed
    return declared


def attempt(
    problem: ContactProblem,
    method: Method,
    adapter: Adapter | Solver | None,
    time_limit: float,
    start: NDArray[np.float64] | None = None,
) -> Attempt:
    """Let a solver try a problem.

    Parameters
    ----------
    problem
        Rebuilt for every attempt, so that nothing found by an earlier one is reused.
    method
        The solver and its settings.
    adapter
        The adapter from `load_adapter`.
    time_limit
        Time limit passed to the backend [s], which may ignore it.
    start
        Forces (n) [N] that solve a neighbouring problem, for a warm start.
    """
    fresh = ContactProblem(problem.separation, problem.lever_arm, problem.torque, problem.compliance)
    begin, processor = perf_counter(), process_time()
    solution: ContactSolution | None
    refused = ""
    if adapter is None:
        solution = solve(fresh, "native", initial_active=None if start is None else start > 0.0)
    else:
        solution, refused = _backend_solution(fresh, method, adapter, time_limit, start)
    # One clock for all: what a solution says of its own run time may come from a function of the user's.
    run_time, processor_time = perf_counter() - begin, process_time() - processor
    found = Attempt(RAISED, refused) if solution is None else Attempt.of(solution)
    if solution is not None:
        residual = posed_residual(fresh, solution.answer, raw=method.settings == RAW)
        found = replace(found, posed_residual=residual)
    return replace(found, run_time=run_time, processor_time=processor_time)


def _backend_solution(
    problem: ContactProblem,
    method: Method,
    adapter: Adapter | Solver,
    time_limit: float,
    start: NDArray[np.float64] | None,
) -> tuple[ContactSolution | None, str]:
    """Solution of a backend; or none, and why it refused its settings."""
    raw = method.settings == RAW
    keywords = method.keywords(time_limit)
    if isinstance(adapter, Solver):
        keywords = {key: value for key, value in keywords.items() if adapter.takes(key)}
    if start is not None:
        keywords["initvals"] = start.copy() if raw else start / problem.scaling.force
    rule = STRICT_POLISH if method.settings == POLISHED else None
    try:
        return backend_solution(problem, method.solver, adapter, keywords, polish=rule, raw=raw), ""
    except InputError as error:
        return None, plain(f"{type(error).__name__}: {error}")


def plain(text: str) -> str:
    """One printable line of bounded length."""
    line = " ".join("".join(c if c.isprintable() or c.isspace() else "?" for c in text).split())
    return line if len(line) <= _LONGEST_MESSAGE else line[: _LONGEST_MESSAGE - 3] + "..."
