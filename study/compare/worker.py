"""A process for each solver: a crash or an endless solve becomes an outcome of the comparison.

Environment of a comparison: processor, Python, and the version of every solver.
"""

from __future__ import annotations

import contextlib
import hashlib
import importlib
import importlib.metadata
import importlib.util
import multiprocessing
import os
import platform
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from importlib.machinery import ModuleSpec, PathFinder
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from ...contact.solvers import SOLVERS, Solver
from ...contact.solvers.backend_solution import GRACE_TIME
from ...contact.solvers.solver_declaration import current_folder_last, entry_point
from ...core.errors import EaseoffError, InputError, MissingSolverError
from ...core.process_settings import THREAD_VARIABLES, child_environment, children_without_interrupts, end_with_parent
from .attempt import CRASHED, TIME_LIMIT, UNMEASURED_FACTOR, Attempt, Request, attempt, load_adapter, multiplied, plain

#: Seconds in which a process must have imported what it needs.
START_TIME_LIMIT = 120.0


class Worker:
    """The process of one solver, started at the first request and again after it had to be ended."""

    def __init__(self, solver: str, threads: int = 1) -> None:
        self.solver = solver
        self._threads = str(threads)
        self._process: Any = None
        self._greeted = self._tried = False
        self._connection: Connection | None = None
        self._failed: Attempt | None = None
        self.takes_start = False

    @property
    def running(self) -> bool:
        """True if there is a process."""
        return self._process is not None

    def launch(self) -> None:
        """Start the process without waiting for it: several can load what they need at the same time."""
        self._greeted = self._tried = False
        context = multiprocessing.get_context("spawn")  # a fork would inherit threads and half-imported libraries
        self._connection, theirs = context.Pipe()
        self._process = context.Process(target=serve, args=(theirs, self.solver), daemon=True)
        with child_environment(dict.fromkeys(THREAD_VARIABLES, self._threads)), children_without_interrupts():
            self._process.start()
        theirs.close()

    def greet(self) -> Attempt | None:
        """Outcome that stands for a failed start; ``None`` once the process is ready.

        The process then has reported if its own solver makes use of a start. InputError if there is no such solver.
        """
        greeting = self._receive(START_TIME_LIMIT)
        if isinstance(greeting, str):
            self.stop()
            raise InputError(greeting)
        self._greeted = True
        self._failed = greeting if isinstance(greeting, Attempt) else None
        self.takes_start = greeting is True
        return self._failed

    def run(self, request: Request) -> Attempt:
        """Return the outcome of a request, also if the process crashes; one that cannot start is not started again."""
        if not self.running and self._failed is None:
            self.launch()
        if not self._greeted:
            self.greet()
        if self._failed is not None:
            return self._failed
        if not self._tried:
            # What is slow only once, such as loading, is left out of the times; with other data, of which
            # nothing is worth keeping.
            self._tried = True
            outcome = self._ask(replace(request, problem=multiplied(request.problem, UNMEASURED_FACTOR)))
            if not self.running:
                return outcome
        return self._ask(request)

    def stop(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process = None
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    def _ask(self, request: Request) -> Attempt:
        assert self._connection is not None
        try:
            self._connection.send(request)
        except OSError:
            return self._ended()
        outcome = self._receive(request.time_limit + GRACE_TIME)
        assert isinstance(outcome, Attempt)
        return outcome

    def _receive(self, limit: float) -> Any:
        assert self._connection is not None
        try:
            if self._connection.poll(limit):
                return self._connection.recv()
        except (EOFError, OSError):
            return self._ended()
        self.stop()
        return Attempt(TIME_LIMIT, f"ended from outside after {limit:g} s")

    def _ended(self) -> Attempt:
        self._process.join()
        code = self._process.exitcode
        self.stop()
        return Attempt(CRASHED, f"its process ended with code {code}")


@contextlib.contextmanager
def workers(solvers: list[str], threads: int = 1) -> Iterator[dict[str, Worker]]:
    """Workers by solver; their processes are ended on leaving."""
    pool = {solver: Worker(solver, threads) for solver in solvers}
    try:
        yield pool
    finally:
        for worker in pool.values():
            worker.stop()


def launched(pool: Mapping[str, Worker], solvers: Iterable[str]) -> set[str]:
    """Start the processes of some solvers at the same time, wait until they are ready, and return their names."""
    names = set(solvers)
    for solver in names:
        pool[solver].launch()
    for solver in names:
        pool[solver].greet()
    return names


def serve(connection: Connection, solver: str) -> None:
    """Answer requests until the other side closes: the main function of a worker's process."""
    end_with_parent()
    _silence()
    folders = contextlib.ExitStack()  # until the process ends: a solver of one's own may import more at any time
    if ":" in solver:
        folders.enter_context(current_folder_last())
    try:
        adapter = load_adapter(solver)
    except MissingSolverError as error:
        connection.send(Attempt(CRASHED, plain(str(error))))
        return
    except EaseoffError as error:
        connection.send(str(error))
        return
    connection.send(isinstance(adapter, Solver) and adapter.warm_start)
    while True:
        try:
            request: Request = connection.recv()
        except EOFError:
            return
        connection.send(attempt(request, adapter))


def _silence() -> None:
    """Discard all output of backends, in any language."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for descriptor in (1, 2):
        os.dup2(nowhere, descriptor)
    os.close(nowhere)


def machine(threads: int = 1) -> dict[str, str]:
    """Processor, cores, threads, system, and versions of Python, the numerical packages and their linear algebra."""
    versions = {name: _version(name) for name in ("numpy", "scipy", "qpsolvers", "easeoff")}
    return {
        "processor": processor(),
        "cores": str(os.cpu_count() or "unknown"),
        "threads": f"{threads} for linear algebra",
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "Python": f"{platform.python_implementation()} {platform.python_version()}",
        **versions,
        "code of easeoff": _code_digest(),
        "BLAS of numpy": _linear_algebra("numpy"),
        "BLAS of scipy": _linear_algebra("scipy"),
    }


def _linear_algebra(package: str) -> str:
    """Name and version of the BLAS that a package was built with, with the kernels chosen by the environment."""
    try:
        configuration: Any = importlib.import_module(package).show_config(mode="dicts")
        library = configuration["Build Dependencies"]["blas"]
        name = f"{library['name']} {library['version']}"
    except Exception:  # of another build or version, which may tell nothing
        name = "unknown"
    kernels = os.environ.get("OPENBLAS_CORETYPE", "")
    return f"{name}, kernels {kernels}" if kernels else name


def processor() -> str:
    """Model of the processor, as far as the system tells."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor() or platform.machine() or "unknown"


def solver_version(solver: str) -> str:
    """Version of a solver's package; for ``module:function`` and entry points a digest of the module's file, too."""
    if solver in SOLVERS:
        return _version(SOLVERS[solver].package or "easeoff")
    point = entry_point(solver)
    file = _digest((solver if point is None else point.value).partition(":")[0])
    if point is None or point.dist is None:
        return file
    return f"{point.dist.name} {point.dist.version}, {file}"


def _digest(module: str) -> str:
    """Digest of a module's file, in words."""
    specification = find_module(module)
    if specification is None or specification.origin is None or not Path(specification.origin).is_file():
        return "unknown"
    return "file " + hashlib.sha256(Path(specification.origin).read_bytes()).hexdigest()[:12]


def find_module(module: str) -> ModuleSpec | None:
    """Find a module without running it, last of all in the current folder; ``None`` if there is none."""
    places: Sequence[str] | None = [*sys.path, os.getcwd()]
    specification: ModuleSpec | None = None
    names = module.split(".")
    for end in range(1, len(names) + 1):  # `importlib.util.find_spec` would run the packages around it
        specification = None if places is None else PathFinder.find_spec(".".join(names[:end]), places)
        places = None if specification is None else specification.submodule_search_locations
    return specification


def _version(package: str) -> str:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "unknown"


def _code_digest() -> str:
    """Digest of the package's code that an attempt runs through."""
    digest = hashlib.sha256()
    root = Path(__file__).parents[2]
    for folder in (root / "contact", Path(__file__).parent):
        for path in sorted(folder.rglob("*.py")):
            digest.update(path.relative_to(root).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:12]
