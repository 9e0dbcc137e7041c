"""One attempt of one solver at one problem: what it says, what the certificate says, and how long it took.

This runs in a process of its own. The steps are those of `easeoff.contact.solve`, which does not do here for two
reasons: the backend's own word has to be kept beside the verdict, and the numbers of a refused answer are wanted too.
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...contact.problem.certificate import NO_CERTIFICATE, Certificate, certify
from ...contact.problem.contact_problem import ContactProblem
from ...contact.problem.scaling import ScaledProblem
from ...contact.solvers import SOLVERS, solve
from ...contact.solvers.backend import NoAnswerError, chosen_form
from ...contact.solvers.polish import recover_answer
from ...contact.solvers.scaled_answer import ScaledAnswer
from ...core.errors import InputError

Adapter = Callable[[ScaledProblem, Mapping[str, Any]], ScaledAnswer]

#: Settings a backend can be run with, and what they mean.
SETTINGS = {
    "default": "scaled problem, settings of the table, polish",
    "unpolished": "scaled problem, settings of the table, no polish",
    "raw": "problem as given in mm and N, the backend's own settings, no polish",
}

#: What a backend may say besides the names of `easeoff.contact.Status`.
SOLVED, RAISED, CRASHED, TIME_LIMIT = "solved", "raised", "crashed", "time_limit"

_TIME_LIMIT_KEYS = ("time_limit", "time_limit_secs")
_LONGEST_MESSAGE = 160


@dataclass(frozen=True)
class Attempt:
    """Outcome of one attempt.

    Attributes
    ----------
    claim : str
        What the solver says: ``solved``, a status in lower case, ``raised`` (an exception) or ``crashed`` (its
        process ended).
    message : str
        Its own words.
    run_time : float
        Wall time of the whole call [s]: check, scaling, solver, polish, certificate. NaN if it did not return.
    certificate : Certificate
        Of the answer, on the problem as it was given; infinite without an answer.
    elastic_rotation : float
        Rotation beyond first contact [rad]; NaN without an answer.
    iterations : int
        -1 where the solver does not tell.
    polished : bool
        Whether the answer is that of one exact solve on the active set the backend found.
    """

    claim: str
    message: str = ""
    run_time: float = math.nan
    certificate: Certificate = NO_CERTIFICATE
    elastic_rotation: float = math.nan
    iterations: int = -1
    polished: bool = False


def load_adapter(solver: str) -> Adapter | None:
    """Return what solves scaled problems for a solver; None for the native one, which is reached by its own door.

    Parameters
    ----------
    solver : str
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
        module, function = f"easeoff.contact.solvers.adapters.{solver}", "solve_scaled"
    try:
        found: Adapter = getattr(importlib.import_module(module), function)
    except Exception as error:  # whatever a module of somebody else's raises
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
    problem : ContactProblem
        Rebuilt for every attempt, so that nothing found by an earlier one is reused.
    solver : str
    adapter : callable or None
        What `load_adapter` returned.
    settings : str
        A name of `SETTINGS`.
    time_limit : float
        What the backend is told [s]; it may not listen.
    active : (n) bool array, optional
        Warm start of the native solver.
    """
    compliance = problem.compliance
    fresh = ContactProblem(problem.separation, problem.lever_arm, problem.torque, compliance)
    if adapter is None:
        return _native(fresh, active)
    if solver in SOLVERS and settings != "raw":
        adapter = in_its_form(solver, adapter)
    keywords = backend_settings(solver, settings, time_limit)
    start = perf_counter()
    try:
        outcome = _backend(fresh, adapter, keywords, settings)
    except NoAnswerError as error:
        claim = error.suspicion.name.lower() if error.suspicion else "solver_failed"
        return Attempt(claim, plain(str(error)), perf_counter() - start)
    except Exception as error:
        return Attempt(RAISED, plain(f"{type(error).__name__}: {error}"), perf_counter() - start)
    answer, certificate, rotation, polished = outcome
    run_time = perf_counter() - start
    claim = SOLVED if answer.suspicion is None else answer.suspicion.name.lower()
    return Attempt(claim, plain(answer.message), run_time, certificate, rotation, int(answer.iterations), polished)


def in_its_form(solver: str, adapter: Adapter) -> Adapter:
    """Return an adapter that gets each problem in the form in which `easeoff.contact.solve` gives it to the solver."""

    def solve_scaled(problem: ScaledProblem, keywords: Mapping[str, Any]) -> ScaledAnswer:
        lifted = chosen_form(solver, problem, "auto") == "lifted"
        return adapter(problem, {**keywords, "form": "lifted"} if lifted else keywords)

    return solve_scaled


def plain(text: str) -> str:
    """One printable line of bounded length."""
    line = " ".join("".join(c if c.isprintable() or c.isspace() else "?" for c in text).split())
    return line if len(line) <= _LONGEST_MESSAGE else line[: _LONGEST_MESSAGE - 3] + "..."


def _native(problem: ContactProblem, active: NDArray[np.bool_] | None) -> Attempt:
    start = perf_counter()
    solution = solve(problem, "native", initial_active=active)
    run_time = perf_counter() - start
    claim = SOLVED if solution.certified else solution.status.name.lower()
    return Attempt(
        claim,
        plain(solution.message),
        run_time,
        solution.certificate,
        solution.elastic_rotation,
        solution.iterations,
    )


def _backend(
    problem: ContactProblem, adapter: Adapter, keywords: dict[str, Any], settings: str
) -> tuple[ScaledAnswer, Certificate, float, bool]:
    """Return the answer as the backend gave it, and certificate and elastic rotation of what became of it."""
    if settings == "raw":
        # Copies: some backends cannot take arrays that are read-only.
        given = ScaledProblem(
            problem.dense_compliance.copy(), problem.separation.copy(), problem.lever_arm.copy(), problem.torque
        )
        answer = adapter(given, keywords)
        rotation = float(answer.rotation)
        elastic = rotation - problem.first_contact_rotation
        return answer, certify(problem, answer.force, rotation), elastic, False
    scaled = problem.scaling.scale(problem)
    answer = adapter(scaled, keywords)
    result, polished = recover_answer(problem, scaled, answer, polished=settings == "default")
    return answer, result.certificate, result.elastic_rotation, polished
