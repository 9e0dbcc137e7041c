"""Attempt of a solver at a problem: its claim, its certificate and its times.

It runs in a process of its own. The method is a solver with settings, a start and, in a sweep, a tolerance; the problem
has its number in a file, its digest and its reference.

A solver that returns what it has kept from an earlier call shall neither be right nor be fast. So no call has the data
of the one before: separations and torque are multiplied by a load factor, other for each call, and with them the forces
and the rotation of the answer. Active set and conditioning stay as they are, and each answer is certified, and compared
with the reference, on the data of its own call.

The residual is that of the answer on the problem as its solver got it, for its own tolerance. The certificate judges
the answer, this the solver. They differ: complementarity in the certificate is the largest of the smaller one of force
and gap, and of n products F_i Y_i the sum is the duality gap, so that a gap of 1e-6 leaves complementarity of up to
1e-3.
"""

from __future__ import annotations

import hashlib
import importlib
import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...contact.problem.certificate import NO_CERTIFICATE, Answer, Certificate, with_certificate
from ...contact.problem.contact_problem import ContactProblem
from ...contact.problem.exchange.problem_file import read_labels, read_problems
from ...contact.solvers import SOLVERS, ContactSolution, Solver, solve
from ...contact.solvers.backend import Adapter
from ...contact.solvers.backend_solution import adapter_of, backend_solution
from ...contact.solvers.polish import STRICT_POLISH
from ...contact.solvers.registry import chosen_solver
from ...contact.solvers.solution import RAISED
from ...core.errors import InputError

#: Settings a solver can be run with, and what they mean; the headline first.
SETTINGS = {
    "scaled": "scaled problem, tight tolerances; the solver's own answer",
    "polished": "the same, then one linear solve on the active set that the solver found",
    "raw": "problem in mm and N, the solver's default settings; its own answer",
    "sweep": "scaled problem, a tolerance of the sweep; the solver's own answer",
    "default": "scaled problem, the solver's default settings; its own answer",
}
HEADLINE, POLISHED, RAW, SWEEP, DEFAULT = SETTINGS
#: Starts of a solver.
COLD, WARM = "cold", "warm"

#: What a sweep calls the tolerance of a function of one's own.
OWN_TOLERANCE_NAME = "tolerance"
#: Solvers whose answers or iterations change with the start they are given. The others ignore it, or have none:
#: a warm start of theirs would measure noise.
STARTING_SOLVERS = tuple(name for name, entry in SOLVERS.items() if entry.warm_start)


@dataclass(frozen=True)
class Method:
    """A solver with everything that is chosen for it."""

    solver: str
    settings: str
    start: str = COLD
    tolerance: float = 0.0  # of a sweep; zero for that of the settings

    def keywords(self, time_limit: float) -> dict[str, Any]:
        """Return the keywords that the solver is called with; without those of the table a time limit alone."""
        if self.solver not in SOLVERS:
            keywords = {"time_limit": time_limit}
            return {**keywords, OWN_TOLERANCE_NAME: self.tolerance} if self.tolerance else keywords
        entry = SOLVERS[self.solver]
        limits = {entry.time_setting: time_limit} if entry.time_setting in entry.settings else {}
        if self.settings in (RAW, DEFAULT):
            return limits
        least = max(self.tolerance, entry.least_tolerance)
        swept = dict.fromkeys(entry.tolerance_settings, least) if self.tolerance else {}
        return {**entry.settings, **limits, **swept}


def polishes_itself(solver: str) -> bool:
    """True if the table's settings have a solver polish its own answer, whatever its tolerance."""
    return solver in SOLVERS and bool(SOLVERS[solver].settings.get("polishing", False))


#: Load factors are one and a number of such steps.
FACTOR_COUNT, FACTOR_STEP = 31, 1.0 / 62.0
#: Load factor of the call that is not measured, the first in a process.
UNMEASURED_FACTOR = 1.0 + 0.5 * FACTOR_STEP
#: Certificate below which the answer to the problem before solves this one, too: there is nothing to measure.
START_CERTIFICATE = 1e-3


@dataclass(frozen=True, eq=False)
class PosedProblem:
    """A problem of a file and the reference that answers to it are compared with."""

    file: str
    number: int
    problem: ContactProblem
    digest: str
    reference: ContactSolution
    #: forces (n) [N] of the problem before, for a warm start; None if unfit or the same answer
    before: NDArray[np.float64] | None
    name: str = ""
    kind: str = ""

    def start(self, method: Method) -> NDArray[np.float64] | None:
        """Return the forces (n) [N] that a method starts from; None for a cold start."""
        return self.before if method.start == WARM else None

    @cached_property
    def before_digest(self) -> str:
        """Digest of the warm start; empty if there is none."""
        return "" if self.before is None else hashlib.sha256(self.before.tobytes()).hexdigest()

    def varied(self, factor: float) -> PosedProblem:
        """Return the same problem with separations, torque and warm start multiplied by a factor."""
        if factor == 1.0:
            return self
        problem = multiplied(self.problem, factor)
        before = None if self.before is None else factor * self.before
        return replace(self, problem=problem, reference=solve(problem, "native"), before=before)


def multiplied(problem: ContactProblem, factor: float) -> ContactProblem:
    """Return a problem with separations and torque multiplied: its forces and rotation are multiplied alike."""
    return ContactProblem(factor * problem.separation, problem.lever_arm, factor * problem.torque, problem.compliance)


def load_factor(method: Method, repetition: int, number: int) -> float:
    """Load factor of a call, the same in every comparison; it differs from that of the calls before and after."""
    kind = (2 * list(SETTINGS).index(method.settings)) + (method.start == WARM)
    if method.tolerance:
        kind += round(-10.0 * math.log10(method.tolerance))
    # Multiples of other primes: neighbours in any of the three are apart.
    return 1.0 + FACTOR_STEP * ((11 * kind + 7 * number + repetition - 1) % FACTOR_COUNT)


def posed_problems(path: Path, name: str) -> list[PosedProblem]:
    """Problems of a file, solved for reference; InputError if there are none, or one is not convex."""
    problems = read_problems(path)
    if not problems:
        raise InputError(f"{path} holds no contact problems")
    labels = read_labels(path)
    names, kinds = ([str(value) for value in labels.get(key, [""] * len(problems))] for key in ("name", "kind"))
    posed: list[PosedProblem] = []
    before: NDArray[np.float64] | None = None
    for number, problem in enumerate(problems):
        if not problem.is_positive_semidefinite:
            raise InputError(
                f"{path}, problem {number}: its compliance has a negative eigenvalue, so no answer can be proved"
            )
        reference = solve(problem, "native")
        usable = before if before is not None and _is_start(problem, before) else None
        digest = problem_digest(problem)
        posed.append(PosedProblem(name, number, problem, digest, reference, usable, names[number], kinds[number]))
        before = reference.force if reference.certified else None
    return posed


def _is_start(problem: ContactProblem, force: NDArray[np.float64]) -> bool:
    """True if forces (n) [N] can start the solution of a problem: of its size, and not its answer already."""
    if force.size != problem.size:
        return False
    work = float(force @ (problem.deflection(force) + problem.separation_at_first_contact))
    rotation = work / problem.torque if problem.torque > 0.0 else 0.0
    return not with_certificate(problem, force, rotation).certificate.passes(START_CERTIFICATE)


def problem_digest(problem: ContactProblem) -> str:
    """Digest of all data of a problem: the same for identical problems only."""
    parts = problem.compliance if isinstance(problem.compliance, tuple) else (problem.compliance,)
    digest = hashlib.sha256(np.float64(problem.torque).tobytes())
    for array in (problem.separation, problem.lever_arm, *parts):
        digest.update(repr(array.shape).encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def posed_residual(problem: ContactProblem, answer: Answer, *, raw: bool = False) -> float:
    """Largest of primal residual, dual residual and duality gap, each over one plus the size of its terms.

    Of a ``raw`` problem in mm and N; NaN without an answer. One plus the size: tolerances may be absolute or relative.
    """
    force, rotation = np.asarray(answer.force, dtype=np.float64), answer.elastic_rotation
    if force.shape != problem.separation.shape or not (math.isfinite(rotation) and np.isfinite(force).all()):
        return math.nan
    with np.errstate(over="ignore", invalid="ignore"):
        if raw:
            rotation, separation = answer.rotation, problem.separation
            deflection, arm, torque = problem.deflection(force), problem.lever_arm, problem.torque
        else:
            scaled, scaling = problem.scaled(), problem.scaling
            force, rotation = force / scaling.force, rotation / scaling.rotation
            separation, arm, torque = scaled.separation, scaled.lever_arm, scaled.torque
            deflection = scaled.deflection(force)
        closing = rotation * arm
        gap = deflection + separation - closing  # the multiplier of F >= 0 where it is not negative
        largest = max(float(np.abs(term).max()) for term in (deflection, separation, closing))
        work, preload = float(force @ deflection), float(force @ separation)
        primal = max(
            abs(float(arm @ force) - torque) / (1.0 + abs(torque)),
            -float(force.min()) / (1.0 + float(np.abs(force).max())),
        )
        dual = -float(gap.min()) / (1.0 + largest)
        surplus = abs(work + preload - rotation * torque) / (1.0 + max(abs(work), abs(preload), abs(rotation * torque)))
    worst = max(primal, dual, surplus)
    return worst if math.isfinite(worst) else math.nan


#: Claims of a solver whose process ended, or was ended when its time was over.
CRASHED, TIME_LIMIT = "crashed", "time_limit"

_LONGEST_MESSAGE = 160


@dataclass(frozen=True)
class Attempt:
    """Outcome of one attempt; times [s] are NaN where they are not known."""

    claim: str  # ``solved``, a status of the solver, ``raised`` (an exception) or ``crashed`` (the process ended)
    message: str = ""
    run_time: float = math.nan  # wall time of the whole call: check, scaling, solver, polish, certificate
    processor_time: float = math.nan
    call_time: float = math.nan  # wall time of the bare solver, from its data in its form to its answer
    setup_time: float = math.nan
    solve_time: float = math.nan
    time_source: str = ""  # set-up and solve as measured by ``solver``, ``interface`` or none
    polish_time: float = math.nan
    certificate: Certificate = NO_CERTIFICATE
    posed_residual: float = math.nan  # on the problem as the solver got it
    elastic_rotation: float = math.nan  # [rad] beyond first contact; NaN without an answer
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
    """Adapter of a solver by name, or the declaration of one's own (``module:function``); None for the native one."""
    chosen = chosen_solver(solver)
    if chosen.declaration is None:
        return None if chosen.is_native else adapter_of(chosen.name)
    importlib.import_module("qpsolvers")  # slow imports are not to be timed
    return chosen.declaration


@dataclass(frozen=True, eq=False)
class Request:
    """One attempt that a solver is asked for, with a time limit [s] and forces (n) [N] to start from, if any."""

    problem: ContactProblem
    method: Method
    time_limit: float
    start: NDArray[np.float64] | None = None


def attempt(request: Request, adapter: Adapter | Solver | None) -> Attempt:
    """Let a solver try a problem, rebuilt so that nothing found before is reused."""
    given = request.problem
    fresh = ContactProblem(given.separation, given.lever_arm, given.torque, given.compliance)
    begin, processor = perf_counter(), process_time()
    solution: ContactSolution | None
    refused = ""
    if adapter is None:
        solution = solve(fresh, "native", initial_active=None if request.start is None else request.start > 0.0)
    else:
        solution, refused = _backend_solution(replace(request, problem=fresh), adapter)
    # One clock for all: what a solution says of its own run time may come from a function of the user's.
    run_time, processor_time = perf_counter() - begin, process_time() - processor
    outcome = Attempt(RAISED, refused) if solution is None else Attempt.of(solution)
    if solution is not None:
        residual = posed_residual(fresh, solution.answer, raw=request.method.settings == RAW)
        outcome = replace(outcome, posed_residual=residual)
    return replace(outcome, run_time=run_time, processor_time=processor_time)


def _backend_solution(request: Request, adapter: Adapter | Solver) -> tuple[ContactSolution | None, str]:
    """Solution of a backend; or none, and why it refused its settings."""
    problem, method, start = request.problem, request.method, request.start
    raw = method.settings == RAW
    keywords = method.keywords(request.time_limit)
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
