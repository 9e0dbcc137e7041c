"""Code from elsewhere, such as a user's solver: it changes nothing of the process, and what it raises is a reason."""

from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import sys
import threading
import warnings
from functools import cache
from types import FrameType, TracebackType
from typing import Any

import numpy as np

from .errors import EaseoffError, message, shortened

OUTPUT, ERRORS = 1, 2  # descriptors of the standard output and of standard error of a process
IMPORT_TIME_LIMIT = 60.0  # [s], in which a package or a module must have been imported
REASON_LENGTH_LIMIT = 300  # [characters]
NO_LIMIT = 1e8  # [s]; no alarm is set this late
ALARM_INTERVAL = 1.0  # [s]; for code that goes on after the first alarm


class ForeignCodeError(EaseoffError):
    """Foreign code raised something, which is the cause of this, or took too long; the text is the reason in a line."""

    @property
    def is_time_limit(self) -> bool:
        """True if it took too long, or said so."""
        return issubclass(type(self.__cause__), TimeoutError | _TimeOver)


class _TimeOver(BaseException):
    """Its time is over; no Exception, which foreign code might pass over."""


class foreign_code:  # noqa: N801  # a context, called like a function
    """Context for foreign code (imports, calls, use of its results): what it raises becomes a ForeignCodeError.

    Exceptions of this package pass. Folder, streams, warnings and numpy's errors are put back; standard output goes to
    standard error, or nowhere. The time limit [s] holds in the main thread, where the system has alarms.
    """

    def __init__(self, time_limit: float | None = None, *, silent: bool = False) -> None:
        self._limit, self._silent = time_limit, silent
        self._interrupted, self._within, self._alarm_count = False, False, 0
        self._before: list[tuple[int, Any]] = []
        self._alarm = (0.0, 0.0)

    def __enter__(self) -> None:
        """Keep what must not change."""
        _PROCESS.enter(silent=self._silent)
        self._errors = np.errstate()
        self._errors.__enter__()
        self._within = True
        if threading.current_thread() is not threading.main_thread():
            return
        self._user: Any = signal.getsignal(signal.SIGINT)
        if callable(self._user):
            self._before.append((signal.SIGINT, signal.signal(signal.SIGINT, self._interrupt)))
        if self._limit is None or not hasattr(signal, "setitimer"):
            return
        around = signal.getitimer(signal.ITIMER_REAL)[0]
        if self._limit < (around or NO_LIMIT):  # else the alarm of what is around comes first
            self._before.append((signal.SIGALRM, signal.signal(signal.SIGALRM, self._end)))
            self._alarm = signal.setitimer(signal.ITIMER_REAL, self._limit, ALARM_INTERVAL)

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> None:
        """Put everything back, and raise the reason."""
        self._within = False
        for number, handler in reversed(self._before):
            if number != signal.SIGINT:
                signal.setitimer(signal.ITIMER_REAL, *self._alarm)
            signal.signal(number, handler)
        self._errors.__exit__(None, None, None)
        _PROCESS.leave()
        if self._interrupted:
            raise KeyboardInterrupt
        if error is None or (type(error) is _TimeOver and error.args != (self._limit,)):
            return  # the latter is for a context around this one
        if not (issubclass(type(error), EaseoffError) and _text(error) is not None):
            raise ForeignCodeError(reason_of(error)) from error

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        self._interrupted = True
        self._user(number, frame)

    def _end(self, _number: int, _frame: FrameType | None) -> None:
        self._alarm_count += 1
        if self._alarm_count == 2:
            warnings.warn(f"code from elsewhere goes on after {self._limit:g} s, whatever it is told", stacklevel=2)
        if self._within:
            raise _TimeOver(self._limit)


def reason_of(error: BaseException) -> str:
    """Kind and text of an exception in a line of bounded length, also where its text cannot be had."""
    kind, text = type(error), _text(error)  # not even to ask whether it is an instance is safe
    if issubclass(kind, SystemExit):
        return f"it ended with code {text or 0}"
    if kind is _TimeOver:
        text = f"it was ended after {error.args[0]:g} s"
    late = issubclass(kind, TimeoutError | _TimeOver)
    name = "time limit met" if late else type.__dict__["__name__"].__get__(kind)
    return ": ".join(filter(None, (name, "its text raises an exception, too" if text is None else text)))


def _text(error: BaseException) -> str | None:
    """Text of an exception in one line; None where it has none."""
    try:
        return shortened(message(" ".join(str.split(str(error)))), REASON_LENGTH_LIMIT)
    except BaseException:  # its text is foreign code, too
        return None


class _Process:
    """State of the whole process: the first thread in foreign code keeps it, the last one puts it back."""

    def __init__(self) -> None:
        self._lock, self._count = threading.Lock(), 0

    def enter(self, *, silent: bool) -> None:
        with self._lock:
            self._count += 1
            if self._count > 1:
                return
            self._streams, self._path = (sys.stdout, sys.stderr), sys.path[:]
            self._shown, self._filters = warnings.showwarning, warnings.filters[:]
            self._folder, self._depth, self._mask = _folder(), sys.getrecursionlimit(), os.umask(0o077)
            os.umask(self._mask)
            _flush(sys.stdout)
            self._output = _copy(OUTPUT)
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, OUTPUT)
            if not silent and self._output is not None:
                with contextlib.suppress(OSError):
                    os.dup2(ERRORS, OUTPUT)
            if nowhere != OUTPUT:
                os.close(nowhere)
            self._diverted = open(  # noqa: SIM115  # closed with the context
                OUTPUT, "w", buffering=1, encoding="utf-8", errors="backslashreplace", closefd=False
            )
            sys.stdout = self._diverted

    def leave(self) -> None:
        with self._lock:
            self._count -= 1
            if self._count:
                return
            sys.stdout, sys.stderr = self._streams
            for stream in (self._diverted, sys.__stdout__):
                _flush(stream)
            with contextlib.suppress(OSError):
                if self._output is None:
                    os.close(OUTPUT)
                else:
                    os.dup2(self._output, OUTPUT)
                    os.close(self._output)
            with contextlib.suppress(OSError):
                if self._folder not in (None, _folder()):
                    os.chdir(self._folder or "")
            os.umask(self._mask)
            sys.setrecursionlimit(max(self._depth, sys.getrecursionlimit()))
            sys.path += [place for place in self._path if place not in sys.path]
            warnings.showwarning = self._shown
            if warnings.filters != self._filters:
                warnings.resetwarnings()  # which also lets what was shown once be shown again
                warnings.filters[:] = self._filters  # type: ignore[index]


_PROCESS = _Process()


def _folder() -> str | None:
    """The working folder, if it is still there."""
    try:
        return os.getcwd()
    except OSError:
        return None


def _copy(descriptor: int) -> int | None:
    try:
        return os.dup(descriptor)
    except OSError:
        return None


def _flush(stream: Any) -> None:
    """Write what Python and the C library keep of the standard output."""
    with contextlib.suppress(OSError, ValueError, AttributeError):
        stream.flush()
    with contextlib.suppress(OSError, AttributeError, TypeError):  # where the C library is not found like this
        _c_library().fflush(None)


@cache
def _c_library() -> Any:
    return ctypes.CDLL(None)
