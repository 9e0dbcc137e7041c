"""A process for each solver: a crash or an endless solve becomes an outcome of the comparison."""

from __future__ import annotations

import contextlib
import importlib
import multiprocessing
import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....contact.problem.contact_problem import ContactProblem
from ....contact.solvers import Solver
from ....contact.solvers.backend_solution import GRACE_TIME
from ....core.errors import EaseoffError, InputError, MissingSolverError
from ....core.process_settings import THREAD_VARIABLES, child_environment, children_without_interrupts, end_with_parent
from .attempt import CRASHED, TIME_LIMIT, Attempt, attempt, load_adapter, plain
from .method import Method
from .posed_problem import UNMEASURED_FACTOR, multiplied

#: Seconds in which a process must have imported what it needs.
START_TIME_LIMIT = 120.0


@dataclass(frozen=True, eq=False)
class Request:
    """One attempt that a worker is asked for."""

    problem: ContactProblem
    method: Method
    time_limit: float
    start: NDArray[np.float64] | None = None


class Worker:
    """The process of one solver, started at the first request and again after it had to be ended.

    Parameters
    ----------
    solver
        A name of the table of solvers, or ``module:function``.
    threads
        Number of threads for linear algebra in the process.
    """

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
        """Whether there is a process."""
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
        """Wait until the process is ready and says whether its own solver makes use of a start.

        Returns
        -------
        Attempt | None
            The outcome that stands for a failed start.

        Raises
        ------
        InputError
            There is no such solver.
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
    if ":" in solver:
        _add_current_folder()
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
        connection.send(attempt(request.problem, request.method, adapter, request.time_limit, request.start))


def _add_current_folder() -> None:
    """Let a solver of one's own be imported from the current folder, where it is looked for last."""
    with contextlib.suppress(ImportError):
        importlib.import_module("qpsolvers")  # first, because it tries to import every solver it knows
    if os.getcwd() not in sys.path:
        sys.path.append(os.getcwd())


def _silence() -> None:
    """Discard all output of backends, in any language."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for descriptor in (1, 2):
        os.dup2(nowhere, descriptor)
    os.close(nowhere)
