"""Work in a process of its own, so that a library which a damaged file makes crash takes nothing else with it."""

from __future__ import annotations

import contextlib
import faulthandler
import os
import signal
import sys
import warnings
from collections.abc import Callable, Iterator
from multiprocessing.connection import Connection, Pipe
from typing import Any, TypeVar

from .errors import EaseoffError, InputError

Result = TypeVar("Result")

PROCESSOR_TIME_LIMIT = 100  # of the process [s]; the largest file that is read takes a third
TIME_LIMIT = 1000.0  # by the clock [s], of a process that waits for what never comes


class ProcessEndedError(EaseoffError):
    """The process ended without a result."""


@contextlib.contextmanager
def netcdf_to_oneself() -> Iterator[None]:
    """Context in which no other thread is inside the libraries for netCDF and HDF5, which take one at a time.

    It holds the locks that xarray takes for every call of them: within it xarray must not read files.
    """
    from xarray.backends.netCDF4_ import NETCDF4_PYTHON_LOCK

    with NETCDF4_PYTHON_LOCK:  # of several locks, in the order in which xarray takes them
        yield


def in_forked_process(work: Callable[[], Result]) -> Result:
    """Result, which must pickle, of a function called in a copy of this process; in this one on Windows and browsers.

    No other thread is inside netCDF and HDF5 while the copy is made. An InputError passes; a crash, any other exception
    and the limits of time raise ProcessEndedError.
    """
    if not hasattr(os, "fork") or sys.platform == "emscripten":  # there it is a name alone
        return work()
    with netcdf_to_oneself(), warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # other threads, of which the copy uses nothing
        source, sink = Pipe(duplex=False)  # here, so that no copy which another thread makes holds it open
        child = os.fork()
        if child:
            sink.close()
    if child == 0:
        source.close()
        _work_and_exit(work, sink)
    answer: tuple[bool, Any] | None = None
    ended = False
    try:
        ended = source.poll(TIME_LIMIT)
        with contextlib.suppress(EOFError, OSError):  # it ended without an answer, or within one
            answer = source.recv() if ended else None
    finally:
        if answer is None:
            os.kill(child, signal.SIGKILL)
        source.close()
        _, status = os.waitpid(child, 0)
    if not ended or (os.WIFSIGNALED(status) and os.WTERMSIG(status) == getattr(signal, "SIGXCPU", None)):
        raise ProcessEndedError("the library that reads it comes to no end")
    if status != 0 or answer is None:
        raise ProcessEndedError("the library that reads it crashed")
    succeeded, result = answer
    if not succeeded:
        raise InputError(result)
    return result  # type: ignore[no-any-return]


def _work_and_exit(work: Callable[[], Any], sink: Connection) -> None:
    """Call the function and send its result or the message of its error; nothing of the first process is run again."""
    code = 1
    try:
        faulthandler.disable()
        nowhere = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(nowhere, stream)
        for name in ("SIGINT", "SIGTERM"):
            signal.signal(getattr(signal, name), signal.SIG_DFL)
        with contextlib.suppress(ImportError, OSError, ValueError):
            import resource

            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            # The second number ends it by another signal, if it is not greater.
            resource.setrlimit(resource.RLIMIT_CPU, (PROCESSOR_TIME_LIMIT, PROCESSOR_TIME_LIMIT + 1))
        try:
            answer: tuple[bool, Any] = (True, work())
        except InputError as error:
            answer = (False, str(error))
        sink.send(answer)
        code = 0
    finally:
        os._exit(code)
