"""Comparison of solvers: attempts of every solver at every problem, with all settings and starts."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import xarray as xr

from ...contact.problem.certificate import Certificate
from ...contact.solvers import available_solvers, require_solver
from ...core.checkpoint import Checkpoint, digest
from ...core.checks import number, whole
from ...core.errors import InputError
from ...core.writing.output_file import check_folder
from .attempt import CRASHED, SETTINGS, TIME_LIMIT, Attempt
from .comparison_table import comparison_table
from .environment import find_module, machine, solver_version
from .posed_problem import PosedProblem, posed_problems
from .worker import Request, Worker, workers

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
    raw: bool = False,
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
        Attempts at each problem with the same solver, settings and start; none follows a crash or a time-out.
    time_limit
        Time limit of one attempt [s]; a solver that exceeds it is ended from outside.
    tolerance
        Largest violation of a condition in a certified answer, the same for all solvers.
    raw
        Whether the backends are also run without polish, and also without the package's scaling and settings.
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
    _check_numbers(repetitions, time_limit, tolerance)
    target = Path(folder)
    check_folder(target, "comparison")
    checkpoint = Checkpoint(target / CHECKPOINT, STUDY, encode=_stored, decode=_attempts, fresh=fresh)
    given = list(dict.fromkeys(Path(path) for path in paths))
    names = [path.name for path in given]
    # Two files of the same name are told apart by their folders.
    shown = [path.name if names.count(path.name) == 1 else str(path) for path in given]
    posed = [item for path, name in zip(given, shown, strict=True) for item in posed_problems(path, name)]
    if not posed:
        raise InputError("paths = []: must name at least one file of contact problems")
    made_with = machine()
    versions = {solver: solver_version(solver) for solver in chosen}
    cells = []
    for item, solver, settings, start in _cells(posed, chosen, raw):
        active = item.before if start == "warm" else None
        key = digest(
            problem=item.digest,
            active=None if active is None else active.tobytes().hex(),
            solver=solver,
            version=versions[solver],
            settings=settings,
            repetitions=repetitions,
            time_limit=time_limit,
            machine=made_with,
        )
        cells.append((key, item, solver, settings, start))
    rows = []
    with workers(chosen) as pool:
        needed = {solver for key, _, solver, _, _ in cells if checkpoint.get(key) is None}
        for solver in needed:
            pool[solver].launch()
        for solver in needed:
            # Nothing is measured while others load; and a function that does not exist comes to light at once.
            pool[solver].greet()
        for done, (key, item, solver, settings, start) in enumerate(cells, start=1):
            attempts = checkpoint.get(key)
            if attempts is None:
                active = item.before if start == "warm" else None
                attempts = measure(pool[solver], Request(item.problem, settings, time_limit, active), repetitions)
                checkpoint.add(key, attempts)
            rows += [item.row(solver, settings, start, number, a) for number, a in enumerate(attempts, start=1)]
            if progress is not None:
                progress(done, len(cells))
    attributes = {
        "repetitions": repetitions,
        "time_limit_s": time_limit,
        "machine": json.dumps(made_with),
        "solver_versions": json.dumps(versions),
    }
    return comparison_table(rows, tolerance, attributes)


def checked_solvers(solvers: Sequence[str] | None) -> list[str]:
    """Names of the solvers to compare, each once.

    Raises
    ------
    InputError
        If a name is unknown, or a module cannot be found.
    MissingSolverError
        If a solver is not installed.
    """
    if solvers is None:
        return available_solvers()
    if not [name for name in solvers if name.strip()]:
        raise InputError(f"solvers = []: must name at least one of {', '.join(available_solvers())}")
    names = []
    for name in dict.fromkeys(name.strip() for name in solvers if name.strip()):
        module, own, function = name.partition(":")
        if not own:
            names.append(require_solver(name))
        elif not function.isidentifier() or find_module(module) is None:
            raise InputError(
                f"solvers = {name!r}: must be a solver of the table, or MODULE:FUNCTION; there is no module {module!r} "
                f"with a function {function!r}"
            )
        else:
            names.append(name)
    return list(dict.fromkeys(names))


def measure(worker: Worker, request: Request, repetitions: int) -> list[Attempt]:
    """Attempts at one problem with the same solver, settings and start; a crash or a time-out is not repeated."""
    attempts: list[Attempt] = []
    for _ in range(repetitions):
        attempts.append(worker.run(request))
        if attempts[-1].claim in (CRASHED, TIME_LIMIT):
            break
    return attempts


def _stored(attempts: list[Attempt]) -> list[dict[str, Any]]:
    return [asdict(attempt) for attempt in attempts]


def _attempts(stored: list[dict[str, Any]]) -> list[Attempt]:
    """Attempts of a checkpoint; raises if a value is of another type than an attempt has."""
    attempts = [Attempt(**{**one, "certificate": Certificate(**one["certificate"])}) for one in stored]
    for attempt in attempts:
        values: dict[str, Any] = asdict(attempt)
        numbers = [values["run_time"], values["elastic_rotation"], *values["certificate"].values()]
        if not (
            all(isinstance(values[name], str) for name in ("claim", "message"))
            and all(isinstance(value, int | float) for value in numbers)
            and isinstance(values["iterations"], int)
            and abs(values["iterations"]) < 2**31
            and isinstance(values["polished"], bool)
        ):
            raise ValueError("no attempt")
    if not attempts:
        raise ValueError("no attempts")
    return attempts


def _cells(posed: list[PosedProblem], solvers: list[str], raw: bool) -> Iterator[tuple[PosedProblem, str, str, str]]:
    """Problem, solver, settings and start of every measurement.

    Problems are the outermost loop, so that a disturbance of the machine meets all solvers.
    """
    for item in posed:
        for solver in solvers:
            if solver == "native":
                yield item, solver, "default", "cold"
                if item.before is not None:
                    yield item, solver, "default", "warm"
                continue
            for settings in SETTINGS if raw else ("default",):
                yield item, solver, settings, "cold"


def _check_numbers(repetitions: int, time_limit: float, tolerance: float) -> None:
    whole("repetitions", repetitions, 1, 1000)
    number("time_limit", time_limit, "s", above=0.0, most=86400.0)
    number("tolerance", tolerance, above=0.0, below=1.0)
