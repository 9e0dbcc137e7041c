"""The comparison itself: every problem, every solver, every settings and start, some repetitions."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...contact.problem.contact_problem import ContactProblem
from ...contact.problem.problem_file import read_labels, read_problems
from ...contact.solvers import ContactSolution, available_solvers, require_solver, solve
from ...core.errors import InputError
from ...core.files import check_folder, check_writable
from .attempt import CRASHED, SETTINGS, TIME_LIMIT, Attempt
from .checkpoint import Checkpoint, key, problem_digest
from .comparison_table import Row, table
from .environment import find_module, machine, solver_version
from .worker import Request, Worker, workers

#: Name of the file in the output folder that keeps what has been measured.
CHECKPOINT = "measurements.jsonl"
#: Certificate that an answer must reach if the caller asks for no other.
DEFAULT_TOLERANCE = 1e-5


@dataclass(frozen=True, eq=False)
class Posed:
    """A problem of a file, with the reference the answers are compared with, and name and kind if the file has them."""

    file: str
    number: int
    problem: ContactProblem
    digest: str
    reference: ContactSolution
    before: NDArray[np.bool_] | None
    name: str = ""
    kind: str = ""

    def row(self, solver: str, settings: str, start: str, repetition: int, attempt: Attempt) -> Row:
        """Put an attempt into the table's terms."""
        return Row(
            problem_file=self.file,
            problem=self.number,
            problem_name=self.name,
            kind=self.kind,
            size=self.problem.size,
            gear_torque=self.problem.torque * 1e-3,
            solver=solver,
            settings=settings,
            start=start,
            repetition=repetition,
            attempt=attempt,
            reference_rotation=self.reference.elastic_rotation,
        )


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
    """Run every solver on every problem, each solver in a process of its own.

    Parameters
    ----------
    paths : sequence of paths
        Files written by `easeoff.contact.write_problems`.
    folder : path
        Where measurements are kept as they are made; made if it does not exist.
    solvers : sequence of str, optional
        Names of the table of solvers, or ``module:function`` for one's own; all that are installed if left out.
    repetitions : int
        Attempts of each kind. After a crash or a time-out there is no other.
    time_limit : float
        Of one attempt [s]; a solver that does not keep it is ended from outside.
    tolerance : float
        Largest violation in a certificate of an answer that counts as certified, the same for all solvers.
    raw : bool
        Run the backends without polish, and without scaling and settings of ours, as well.
    fresh : bool
        Forget earlier measurements in the folder.
    progress : callable, optional
        Called with the number of measurements made and their total.

    Returns
    -------
    Dataset
        One row an attempt; see `table`.

    Raises
    ------
    InputError
        A file that cannot be read or has no problems, an unknown solver, a number out of range, a folder that cannot
        be written.
    MissingSolverError
        A solver is not installed.

    Notes
    -----
    The workers are started afresh, not forked: a script that calls this needs ``if __name__ == "__main__":``.
    """
    chosen = checked_solvers(solvers)
    _check_numbers(repetitions, time_limit, tolerance)
    target = Path(folder)
    check_folder(target, "comparison")
    check_writable(target / CHECKPOINT)
    given = list(dict.fromkeys(Path(path) for path in paths))
    names = [path.name for path in given]
    # Two files of the same name are told apart by their folders.
    posed = [item for path in given for item in pose(path, path.name if names.count(path.name) == 1 else str(path))]
    if not posed:
        raise InputError("no files of contact problems were given")
    checkpoint = Checkpoint(target / CHECKPOINT, fresh=fresh)
    made_with = machine()
    versions = {solver: solver_version(solver) for solver in chosen}
    cells = []
    for item, solver, settings, start in _cells(posed, chosen, raw):
        active = item.before if start == "warm" else None
        identity = key(
            problem=item.digest,
            active=None if active is None else active.tobytes().hex(),
            solver=solver,
            version=versions[solver],
            settings=settings,
            repetitions=repetitions,
            time_limit=time_limit,
            machine=made_with,
        )
        cells.append((identity, item, solver, settings, start))
    rows = []
    with workers(chosen) as pool:
        needed = {solver for identity, _, solver, _, _ in cells if checkpoint.get(identity) is None}
        for solver in needed:
            pool[solver].launch()
        for solver in needed:
            # Nothing is measured while others load; and a function that does not exist comes to light at once.
            pool[solver].greet()
        for done, (identity, item, solver, settings, start) in enumerate(cells, start=1):
            attempts = checkpoint.get(identity)
            if attempts is None:
                active = item.before if start == "warm" else None
                attempts = measure(pool[solver], Request(item.problem, settings, time_limit, active), repetitions)
                checkpoint.add(identity, attempts)
            rows += [item.row(solver, settings, start, number, a) for number, a in enumerate(attempts, start=1)]
            if progress is not None:
                progress(done, len(cells))
    attributes = {
        "repetitions": repetitions,
        "time_limit_s": time_limit,
        "machine": json.dumps(made_with),
        "solver_versions": json.dumps(versions),
    }
    return table(rows, tolerance, attributes)


def checked_solvers(solvers: Sequence[str] | None) -> list[str]:
    """Return the solvers to compare, each once.

    Raises
    ------
    InputError
        An unknown name, or a module that cannot be found.
    MissingSolverError
        A solver is not installed.
    """
    if solvers is None:
        return available_solvers()
    if not [name for name in solvers if name.strip()]:
        raise InputError(f"no solvers were given: choose from {', '.join(available_solvers())}")
    names = []
    for name in dict.fromkeys(name.strip() for name in solvers if name.strip()):
        module, own, function = name.partition(":")
        if not own:
            names.append(require_solver(name))
        elif not function.isidentifier() or find_module(module) is None:
            raise InputError(f"solver {name!r}: there is no module {module!r} to take a function {function!r} from")
        else:
            names.append(name)
    return list(dict.fromkeys(names))


def pose(path: Path, name: str) -> list[Posed]:
    """Read the problems of a file and solve them for reference; each knows the active set of the one before.

    Raises
    ------
    InputError
        The file cannot be read, has no problems, or has one that is not convex: no certificate could prove it.
    """
    problems = read_problems(path)
    if not problems:
        raise InputError(f"{path} holds no contact problems")
    labels = read_labels(path)
    names, kinds = ([str(value) for value in labels.get(key, [""] * len(problems))] for key in ("name", "kind"))
    posed: list[Posed] = []
    before: NDArray[np.bool_] | None = None
    for number, problem in enumerate(problems):
        if not problem.is_positive_semidefinite:
            raise InputError(
                f"{path}, problem {number}: its compliance has a negative eigenvalue, so no answer can be proved"
            )
        reference = solve(problem, "native")
        usable = before if before is not None and before.size == problem.size else None
        digest = problem_digest(problem)
        posed.append(Posed(name, number, problem, digest, reference, usable, names[number], kinds[number]))
        before = reference.active if reference.certified else None
    return posed


def measure(worker: Worker, request: Request, repetitions: int) -> list[Attempt]:
    """Return the attempts of one kind; a crash or a time-out is not repeated."""
    attempts: list[Attempt] = []
    for _ in range(repetitions):
        attempts.append(worker.run(request))
        if attempts[-1].claim in (CRASHED, TIME_LIMIT):
            break
    return attempts


def _cells(posed: list[Posed], solvers: list[str], raw: bool) -> Iterator[tuple[Posed, str, str, str]]:
    """Problem, solver, settings and start of every measurement; problems outermost: all share a disturbance."""
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
    if not 1 <= repetitions <= 1000:
        raise InputError(f"repetitions = {repetitions}: must lie between 1 and 1000")
    if not 0.0 < time_limit <= 86400.0:
        raise InputError(f"time limit = {time_limit:g}: must be greater than 0 and at most 86400 s")
    if not 0.0 < tolerance < 1.0:
        raise InputError(f"tolerance = {tolerance:g}: must lie between 0 and 1")
