"""Attempt of a solver at a problem: its claim, its certificate and its run time.

This runs in a process of its own.
"""

from __future__ import annotations

import importlib
import math
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...contact.problem.certificate import NO_CERTIFICATE, Certificate
from ...contact.problem.contact_problem import ContactProblem
from ...contact.solvers import SOLVERS, ContactSolution, solve
from ...contact.solvers.backend_solution import Adapter, adapter_of, backend_solution
from ...contact.solvers.solution import RAISED
from ...core.errors import InputError

#: Settings a backend can be run with, and what they mean.
SETTINGS = {
    "default": "scaled problem, settings of the table, polish",
    "unpolished": "scaled problem, settings of the table, no polish",
    "raw": "problem as given in mm and N, the backend's own settings, no polish",
}

#: Claims of a solver whose process ended, or was ended when its time was over.
CRASHED, TIME_LIMIT = "crashed", "time_limit"

_TIME_LIMIT_KEYS = ("time_limit", "time_limit_secs")
_LONGEST_MESSAGE = 160


@dataclass(frozen=True)
class Attempt:
    """Outcome of one attempt.

    Attributes
    ----------
    claim
        Report of the solver: ``solved``, a status in lower case, ``raised`` (an exception) or ``crashed`` (its
        process ended).
    message
        Its own words.
    run_time
        Wall time of the whole call [s]: check, scaling, solver, polish, certificate. NaN if it did not return.
    certificate
        Of the answer, on the problem as it was given; infinite without an answer.
    elastic_rotation
        Rotation beyond first contact [rad]; NaN without an answer.
    iterations
        -1 if unknown.
    polished
        Whether the answer is that of one exact solve on the active set the backend found.
    """

    claim: str
    message: str = ""
    run_time: float = math.nan
    certificate: Certificate = NO_CERTIFICATE
    elastic_rotation: float = math.nan
    iterations: int = -1
    polished: bool = False

    @classmethod
    def of(cls, solution: ContactSolution) -> Attempt:
        """Return the outcome that a solution is."""
        return cls(
            solution.claim,
            plain(solution.message),
            solution.run_time,
            solution.certificate,
            float(solution.answer.elastic_rotation),
            solution.iterations,
            solution.polished,
        )


def load_adapter(solver: str) -> Adapter | None:
    """Return the adapter of a solver for scaled problems; None for the native one, which needs none.

    Parameters
    ----------
    solver
        A name of the table of solvers, or ``module:function`` with the signature of an adapter.

    Raises
    ------
    InputError
        The module cannot be imported or has no such function.
    """
    if solver == "native":
        return None
    module, separator, function = solver.partition(":")
    if not separator:
        for package in filter(None, (SOLVERS[solver].package, "qpsolvers")):
            importlib.import_module(package)  # slow imports are not to be timed
        return adapter_of(solver)
    try:
        found: Adapter = getattr(importlib.import_module(module), function)
    except Exception as error:  # a foreign module may raise anything
        raise InputError(f"solver {solver!r} cannot be loaded: {error}") from error
    return found


def backend_settings(solver: str, settings: str, time_limit: float) -> dict[str, Any]:
    """Return the keywords an adapter is called with: of our table or, for ``raw``, a time limit where it takes one."""
    if solver not in SOLVERS:
        return {"time_limit": time_limit}
    table = dict(SOLVERS[solver].settings)
    limits = {key: time_limit for key in _TIME_LIMIT_KEYS if key in table}
    return limits if settings == "raw" else {**table, **limits}


def attempt(
    problem: ContactProblem,
    solver: str,
    adapter: Adapter | None,
    settings: str,
    time_limit: float,
    active: NDArray[np.bool_] | None = None,
) -> Attempt:
    """Let a solver try a problem.

    Parameters
    ----------
    problem
        Rebuilt for every attempt, so that nothing found by an earlier one is reused.
    solver
        A name of the table of solvers, or of one's own.
    adapter
        The adapter from `load_adapter`.
    settings
        A name of `SETTINGS`.
    time_limit
        Time limit passed to the backend [s], which may ignore it.
    active
        Warm start of the native solver (n).
    """
    fresh = ContactProblem(problem.separation, problem.lever_arm, problem.torque, problem.compliance)
    if adapter is None:
        return Attempt.of(solve(fresh, "native", initial_active=active))
    keywords = backend_settings(solver, settings, time_limit)
    polish, raw = settings == "default", settings == "raw"
    start = perf_counter()
    try:
        return Attempt.of(backend_solution(fresh, solver, adapter, keywords, polish=polish, raw=raw))
    except InputError as error:
        return Attempt(RAISED, plain(f"{type(error).__name__}: {error}"), perf_counter() - start)


def plain(text: str) -> str:
    """One printable line of bounded length."""
    line = " ".join("".join(c if c.isprintable() or c.isspace() else "?" for c in text).split())
    return line if len(line) <= _LONGEST_MESSAGE else line[: _LONGEST_MESSAGE - 3] + "..."
