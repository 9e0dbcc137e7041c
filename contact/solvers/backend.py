"""Call of a backend behind qpsolvers, and its forces and rotation.

To add a backend: a row in `solver_table`. One that qpsolvers does not know has a module in ``adapters`` named after it
with a function ``solve_scaled(problem, settings) -> ScaledAnswer``. The answer may be anything; it is certified by the
caller.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping
from importlib import import_module
from time import perf_counter
from typing import Any

import numpy as np

from ...core.checks import one_of, shown
from ...core.errors import EaseoffError, InputError
from ..problem.programme_forms import lifted_programme
from ..problem.scaled_problem import ScaledProblem
from .solution import CallTimes, ScaledAnswer, Status
from .solver_limits import limit_hint, limit_met
from .solver_table import SOLVERS, Report

#: Forms in which a backend may get the problem.
FORMS = ("auto", "dense", "sparse", "lifted", "lcp", "products")


#: Function that calls a backend: takes the scaled problem and the settings of the backend.
Adapter = Callable[[ScaledProblem, Mapping[str, Any]], ScaledAnswer]
#: Where the times of a call stand among the extras of its solution.
CALL_TIMES = "call_times"


class NoAnswerError(EaseoffError):
    """A backend ended without numbers; carries its message. Never leaves this folder."""

    def __init__(self, message: str, suspicion: Status | None = None, *, claim: str | None = None) -> None:
        super().__init__(message)
        self.suspicion, self.claim = suspicion, claim


def solve_scaled(name: str, problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem with a backend behind qpsolvers, as its row in the table of solvers says."""
    entry = SOLVERS[name]
    report = entry.report or Report()
    refuse_unknown(name, settings)
    attempts = [settings]
    if entry.second_attempt and not entry.second_attempt.keys() & settings:
        attempts.append({**settings, **entry.second_attempt})
    start = perf_counter()
    for given in attempts:
        solution = run_qpsolvers(name, problem, given)
        met = None if solution.found else limit_met(name, settings, perf_counter() - start)
        if solution.found or met is not None:
            break
    message = "" if given is settings else f"with {', '.join(entry.second_attempt)}"
    if report.status:
        message = str(_reported(solution, report, report.status)).rpartition(".")[2]
    end = _reported(solution, report, report.end) if report.end else message
    suspicion = report.ends.get(end, report.other_end) if report.ends or report.other_end else met
    iterations = np.ravel(_reported(solution, report, report.iterations))[0] if report.iterations else -1
    return read_answer(solution, iterations=int(iterations), message=message, suspicion=suspicion)


def _reported(solution: Any, report: Report, name: str) -> Any:
    """Value that a backend reports by a name; None where it does not."""
    info = solution.extras.get(report.place, solution.extras)
    return info.get(name) if isinstance(info, Mapping) else getattr(info, name, None)


def run_qpsolvers(name: str, problem: ScaledProblem, settings: Mapping[str, Any]) -> Any:
    """Solve with the named backend; returns the `qpsolvers.Solution`, found or not.

    The setting ``form`` is dense by default, or lifted; ``initvals`` are scaled starting forces (n), which some ignore.
    """
    import qpsolvers

    options = dict(settings)
    start = options.pop("initvals", None)
    if options.pop("form", "dense") == "lifted":
        programme = lifted_programme(problem, compress=True)
        if start is not None:
            equalities: Any = programme.A  # the modal amplitudes of the start: V'F - z = 0
            start = np.concatenate([start, equalities[1:, : start.size] @ start])
    else:
        programme = problem.as_qp(sparse=SOLVERS[name].sparse)
    begin = perf_counter()
    with warnings.catch_warnings():
        # "Not found" comes as a warning too; here it becomes a status.
        warnings.simplefilter("ignore")
        solution = qpsolvers.solve_problem(programme, solver=name, initvals=start, verbose=False, **options)
    solution.extras[CALL_TIMES] = call_times(name, solution, perf_counter() - begin)
    return solution


def call_times(name: str, solution: Any, call: float) -> CallTimes:
    """Times of a call [s]: as the backend reports them, or else as qpsolvers measured them."""
    report = SOLVERS[name].report
    if report is not None and report.solve_time:
        values = [key and _reported(solution, report, key) for key in (report.set_up_time, report.solve_time)]
        setup, solve = (report.unit * float(value) if value else math.nan for value in values)
        if solve > 0.0:
            return CallTimes(call, setup, solve, "solver")
    if solution.solve_time is None:
        return CallTimes(call)
    return CallTimes(call, float(solution.build_time), float(solution.solve_time), "interface")


def chosen_form(name: str, problem: ScaledProblem, form: str) -> str:
    """Form in which a backend gets a problem, ``dense`` or ``lifted``.

    ``auto`` is lifted for a structured compliance with fewer modes than segments, if so large that the backend gains.
    """
    one_of("form", form, ("auto", "dense", "lifted"))
    if not problem.has_matrix and name != "native":
        raise InputError(
            f"compliance = LinearOperator: must be a matrix for {name}; native takes it, and a solver of your own that "
            "declares the form 'products'; operator @ numpy.eye(n) forms the matrix"
        )
    least = SOLVERS[name].lifted_from
    if form == "lifted":
        if least is None:
            able = ", ".join(other for other, entry in SOLVERS.items() if entry.lifted_from is not None)
            raise InputError(f"form = 'lifted': must be dense for {name}; the lifted form is for {able}")
        if problem.modal is None:
            raise InputError(
                "form = 'lifted': must be dense for a single dense matrix; the lifted form needs the pair (d, V)"
            )
        return "lifted"
    if form == "auto" and least is not None and problem.modal is not None:
        size, modes = problem.separation.size, problem.modal.mode_count
        return "lifted" if size >= least and modes < size else "dense"
    return "dense"


def read_answer(
    solution: Any, *, iterations: int = -1, message: str = "", suspicion: Status | None = None
) -> ScaledAnswer:
    """Forces, rotation and gaps of a `qpsolvers.Solution`.

    qpsolvers has P x + q + A'y + z_box = 0: rotation -y, gaps -z_box. A missing rotation follows from the forces, as
    the gap is zero on loaded segments: theta T = F'CF + S'F.
    """
    if not message:
        message = "found" if solution.found else "not found"
    if not solution.found and suspicion is None:
        suspicion = Status.SOLVER_FAILED
    if solution.x is None or not np.isfinite(solution.x).all():
        raise NoAnswerError(message, suspicion)
    # In the lifted form the unknowns behind the forces are the modal amplitudes, which have no bounds.
    unknowns = np.asarray(solution.x, dtype=np.float64)
    bounded = np.isfinite(solution.problem.lb)
    rotation = math.nan if solution.y is None or len(solution.y) == 0 else -float(solution.y[0])
    if not math.isfinite(rotation):
        problem = solution.problem
        torque = float(problem.b[0])
        if not torque > 0.0:
            raise NoAnswerError(message, suspicion)
        rotation = float(unknowns @ (problem.P @ unknowns) + problem.q @ unknowns) / torque
    multipliers = solution.z_box
    gap = None if multipliers is None or len(multipliers) != unknowns.size else -np.asarray(multipliers)[bounded]
    claim = None if solution.found else suspicion
    return ScaledAnswer(unknowns[bounded], rotation, iterations, message, claim, gap, solution.extras.get(CALL_TIMES))


def refuse_unknown(name: str, settings: Mapping[str, Any]) -> None:
    """Refuse misspelt settings, which some backends ignore in silence."""
    entry = SOLVERS[name]
    if not (entry.known or entry.known_of):
        return
    package = import_module(entry.package)
    known = {"form", "initvals", *entry.known}
    for path in entry.known_of:
        kind, _, part = path.partition(".")
        settings_object = getattr(package, kind)()
        known |= set(dir(getattr(settings_object, part) if part else settings_object))
    for key in settings:
        if key not in known:
            hint = limit_hint(name, [key])
            raise InputError(f"{key} = {shown(settings[key])}: must not be given, {name} has no such setting{hint}")
