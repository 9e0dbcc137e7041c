"""Comparison of solvers: attempts of every solver at every problem, with all settings and starts.

Comparison plan: which methods try which problems, in which order, and the key under which each outcome is kept.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import xarray as xr

from ...contact.problem.certificate import Certificate
from ...contact.solvers import SOLVERS, available_solvers, require_solver
from ...contact.solvers.solver_declaration import declares_place, entry_point_names
from ...core.checkpoint import Checkpoint, digest
from ...core.checks import array, bounded, check_fields, file_path, instance, number, one_of, words
from ...core.errors import InputError
from ...core.output_file import check_folder
from . import attempt as attempting
from .attempt import COLD, HEADLINE, WARM, Attempt, Method, PosedProblem, Request
from .comparison_table import Row, comparison_table
from .method_statistics import TIMES, WALL
from .worker import Worker, launched, machine, solver_version, workers

#: Most tolerances of a sweep.
TOLERANCE_COUNT_LIMIT = 20


@dataclass(frozen=True)
class Choice:
    """Measurements that the user chose, checked."""

    repetitions: int = field(metadata=bounded(least=1, most=1000))
    time_limit: float = field(metadata=bounded("s", above=0.0, most=86400.0))
    polish: bool
    raw: bool  # also measure in mm and N at the backends' own settings
    defaults: bool  # also measure the scaled problem at the backends' own settings
    tolerances: tuple[float, ...]
    threads: int = field(metadata=bounded(least=1, most=1024))

    def __post_init__(self) -> None:
        check_fields(self)
        for tolerance in self.tolerances:
            number("tolerances", tolerance, above=0.0, below=1.0)
        if len(self.tolerances) > TOLERANCE_COUNT_LIMIT:
            raise InputError(f"tolerances = {len(self.tolerances)} numbers: must be at most {TOLERANCE_COUNT_LIMIT}")
        if len(set(self.tolerances)) < len(self.tolerances):
            twice = next(one for one in self.tolerances if self.tolerances.count(one) > 1)
            raise InputError(f"tolerances = {twice:g}: must not come twice")


@dataclass(frozen=True, eq=False)
class Cell:
    """A problem and a method that tries it."""

    posed: PosedProblem
    method: Method

    def key(self, choice: Choice, made_with: dict[str, str], version: str) -> str:
        """Return the key of the outcome: other for whatever it depends on."""
        return digest(
            problem=self.posed.digest,
            before=self.posed.before_digest if self.method.start == WARM else "",
            version=version,
            repetitions=choice.repetitions,
            time_limit=choice.time_limit,
            machine=made_with,
            **asdict(self.method),
        )


def cells(posed: Sequence[PosedProblem], starting: Mapping[str, bool], choice: Choice) -> Iterator[Cell]:
    """All measurements of solvers, each with True if it makes use of a start.

    Problems are the outermost loop, so that a disturbance of the machine meets all solvers.
    """
    for item in posed:
        for solver, warm in starting.items():
            for method in methods_of(solver, choice, warm=warm):
                if method.start == COLD or item.before is not None:
                    yield Cell(item, method)


def methods_of(solver: str, choice: Choice, *, warm: bool = False) -> Iterator[Method]:
    """Methods in which a solver is measured, the headline first.

    The native solver has one: its answer needs no polish, and it takes no tolerance and no problem without scaling.
    """
    yield Method(solver, HEADLINE)
    if warm:
        yield Method(solver, HEADLINE, WARM)
    if solver == "native":
        return
    if choice.polish:
        yield Method(solver, attempting.POLISHED)
    if choice.raw:
        yield Method(solver, attempting.RAW)
    if choice.defaults:
        yield Method(solver, attempting.DEFAULT)
    if solver not in SOLVERS or SOLVERS[solver].tolerance_settings:  # else a sweep changes nothing
        yield from (Method(solver, attempting.SWEEP, COLD, tolerance) for tolerance in choice.tolerances)


#: Checkpoint in the output folder, and the study it names.
CHECKPOINT, STUDY = "measurements.jsonl", "comparison of solvers"
#: Certificate that an answer must reach if the caller asks for no other.
DEFAULT_TOLERANCE = 1e-5


def compare(
    paths: Sequence[str | os.PathLike[str]],
    folder: str | os.PathLike[str],
    *,
    solvers: Sequence[str] | None = None,
    repetitions: int = 3,
    time_limit: float = 10.0,
    tolerance: float = DEFAULT_TOLERANCE,
    polish: bool = False,
    raw: bool = False,
    defaults: bool = False,
    tolerances: Sequence[float] = (),
    threads: int = 1,
    time: str = WALL,
    fresh: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """Comparison of solvers on contact problems, each solver in a process of its own.

    Parameters
    ----------
    paths
        Files written by ``easeoff.contact.write_problems``.
    folder
        Folder in which measurements are kept as they are made, to resume from; made if it does not exist.
    solvers
        Names of the table of solvers, or ``module:function`` for one of your own; all installed ones if left out.
    repetitions
        Attempts at each problem by the same method; none follows a crash or a time-out.
    time_limit
        Time limit of one attempt [s]; a solver that exceeds it is ended from outside.
    tolerance
        Largest violation of a condition in a certified answer, the same for all solvers.
    polish
        Whether the backends are also run with a polish, one linear solve on the active set they found.
    raw
        Whether the backends are also run without the package's scaling and settings.
    defaults
        Whether the backends are also run with their own settings on the scaled problem.
    tolerances
        Tolerances with which the backends are also run, each under the names it has for them, for the work-precision
        diagram.
    threads
        Threads for linear algebra in each process.
    time
        Time that order, tables and profiles go by: ``"wall"``, or ``"processor"``, which other work on the machine
        changes less. Both are measured.
    fresh
        Whether earlier measurements in the folder are ignored and replaced.
    progress
        Called with the number of measurements made and their total.

    Returns
    -------
    xr.Dataset
        One row an attempt, see ``comparison_table``.

    Raises
    ------
    InputError
        If a file cannot be read or has no problems, a solver is unknown, a number is out of range, or the folder cannot
        be written.
    MissingSolverError
        If a solver is not installed.

    Notes
    -----
    The workers are started afresh, not forked: a script that calls this needs ``if __name__ == "__main__":``.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from easeoff.contact import ContactProblem, write_problems
    >>> problem = ContactProblem([0.0, 1e-3], [50.0, 50.0], 1e4, ([1e-5, 1e-5], [[1e-3], [2e-3]]))
    >>> with TemporaryDirectory() as folder:
    ...     write_problems([problem], f"{folder}/problems.nc")
    ...     table = compare([f"{folder}/problems.nc"], folder, solvers=["native"], repetitions=2)
    >>> table["certified"].values.tolist()
    [1, 1]
    """
    chosen = checked_solvers(solvers)
    number("tolerance", tolerance, above=0.0, below=1.0)
    one_of("time", time, tuple(TIMES))
    instance("progress", progress, Callable | None)
    tried = tuple(array("tolerances", tolerances, ndim=1).tolist())
    choice = Choice(repetitions, time_limit, polish, raw, defaults, tried, threads)
    target = file_path("folder", folder)
    check_folder(target, "comparison")
    checkpoint = Checkpoint(target / CHECKPOINT, STUDY, encode=_stored, decode=_attempts, fresh=fresh)
    made_with = machine(threads)
    versions = {solver: solver_version(solver) for solver in chosen}
    posed, rows = _posed(paths), list[Row]()
    with workers(chosen, threads) as pool:
        # A function that does not exist comes to light at once.
        started = launched(pool, (solver for solver in chosen if solver not in SOLVERS))
        starting = {solver: solver in attempting.STARTING_SOLVERS or pool[solver].takes_start for solver in chosen}
        chosen_cells = list(cells(posed, starting, choice))
        planned = [(cell, cell.key(choice, made_with, versions[cell.method.solver])) for cell in chosen_cells]
        needed = {cell.method.solver for cell, key in planned if checkpoint.get(key) is None}
        launched(pool, needed - started)  # nothing is measured while others load
        for done, (cell, key) in enumerate(planned, start=1):
            attempts = checkpoint.get(key)
            if attempts is None:
                attempts = measure(pool[cell.method.solver], cell, choice)
                checkpoint.add(key, attempts)
            rows += [Row(cell.posed, cell.method, number, one) for number, one in enumerate(attempts, start=1)]
            if progress is not None:
                progress(done, len(planned))
    attributes = {
        "repetitions": repetitions,
        "time_limit_s": time_limit,
        "threads": threads,
        "time": time,
        "machine": json.dumps(made_with),
        "solver_versions": json.dumps(versions),
    }
    return comparison_table(rows, tolerance, attributes)


def _posed(paths: Sequence[str | os.PathLike[str]]) -> list[PosedProblem]:
    """Problems of all files, solved for reference."""
    instance("paths", paths, list | tuple)
    given = list(dict.fromkeys(file_path("paths", path) for path in paths))
    names = [path.name for path in given]
    # Two files of the same name are told apart by their folders.
    shown = [path.name if names.count(path.name) == 1 else str(path) for path in given]
    posed = [item for path, name in zip(given, shown, strict=True) for item in attempting.posed_problems(path, name)]
    if not posed:
        raise InputError("paths = []: must name at least one file of contact problems")
    return posed


def checked_solvers(solvers: Sequence[str] | None) -> list[str]:
    """Names of the solvers to compare, each once, known and installed."""
    if solvers is None:
        return available_solvers()
    given = [name.strip() for name in words("solvers", solvers) if name.strip()]
    if not given:
        raise InputError(f"solvers = []: must name at least one of {', '.join(available_solvers())}")
    # A solver of one's own is imported in its process alone: there it may hang or crash.
    declared = {name for name in given if declares_place(name) or name in entry_point_names()}
    return list(dict.fromkeys(name if name in declared else require_solver(name) for name in given))


def measure(worker: Worker, cell: Cell, choice: Choice) -> list[Attempt]:
    """Attempts at one problem by one method, each with other data; a crash or a time-out is not repeated."""
    attempts: list[Attempt] = []
    for repetition in range(1, choice.repetitions + 1):
        factor = attempting.load_factor(cell.method, repetition, cell.posed.number)
        posed = cell.posed.varied(factor)
        attempt = worker.run(Request(posed.problem, cell.method, choice.time_limit, posed.start(cell.method)))
        reference = float(posed.reference.elastic_rotation)
        attempts.append(replace(attempt, load_factor=factor, reference_rotation=reference))
        if attempt.claim in (attempting.CRASHED, attempting.TIME_LIMIT):
            break
    return attempts


def _stored(attempts: list[Attempt]) -> list[dict[str, Any]]:
    return [asdict(attempt) for attempt in attempts]


def _attempts(stored: list[dict[str, Any]]) -> list[Attempt]:
    return [Attempt(**{**one, "certificate": Certificate(**one["certificate"])}) for one in stored]
