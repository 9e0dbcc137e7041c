"""Whether compiled code is used, and who is told before it is compiled.

It is used for the contact solution, the splines of the flank and the marking print, everywhere but within
``without_compiled_code``: loading it takes longer than it saves on a few hundred problems. The choice is the caller's
alone, and the answers are the same but for rounding.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from typing import Any

#: Contact problems up to which a process that solves nothing else is faster without compiled code: it costs 0.45 s of
#: processor time to load, and saves 0.5 ms a problem.
FEWEST_PROBLEMS = 1000
#: Switches the compiled code off, for a process and those that it starts.
SWITCH = "EASEOFF_COMPILED"
#: Set in the process that compiles for the one that started it.
COMPILES_APART = "EASEOFF_COMPILES_APART"
COMPILING = "compiling the contact analysis, once for this version on this machine: about 20 s"

_used: ContextVar[bool] = ContextVar("compiled_code_used", default=True)
_told: ContextVar[Callable[[str], None] | None] = ContextVar("compilation_told", default=None)


def is_used() -> bool:
    """Whether compiled code may be used here."""
    return _used.get() and _is_switched_on()


@cache
def _is_switched_on() -> bool:
    return os.environ.get(SWITCH, "1") != "0"


def compiled_code_of(imported: Callable[[], Any]) -> Any:
    """The module of compiled functions that a function imports, once; None where they are not used or cannot be.

    Parameters
    ----------
    imported
        Imports the module and returns it.
    """
    return _loaded(imported) if is_used() else None


@cache
def _loaded(imported: Callable[[], Any]) -> Any:
    try:
        return imported()
    except ImportError:  # no numba, or none for this Python or numpy
        return None


@contextmanager
def without_compiled_code(wanted: bool = True) -> Iterator[None]:
    """Solve by the methods in numpy within this context; unless it is not ``wanted``.

    Examples
    --------
    >>> with without_compiled_code():
    ...     is_used()
    False
    """
    token = _used.set(_used.get() and not wanted)
    try:
        yield
    finally:
        _used.reset(token)


@contextmanager
def compilation_told(tell: Callable[[str], None]) -> Iterator[None]:
    """Call a function with one line of text before code is compiled within this context, which takes seconds."""
    token = _told.set(tell)
    try:
        yield
    finally:
        _told.reset(token)


def tell_of_compilation() -> None:
    """Tell once that code is about to be compiled, to whom it may concern."""
    tell = _told.get()
    if tell is not None:
        _told.set(None)
        tell(COMPILING)
