"""Whether compiled code is used, and who is told before it is compiled.

It is used for the contact solution, the splines of the flank and the marking print. Compilation takes most of a minute
of processor time and the code is then kept on disk, so what does much work asks for it (``compiling``); all else uses
what is kept, and the methods in numpy where there is none. Within ``without_compiled_code`` it is not used at all:
loading it takes longer than it saves on a few hundred problems. The answers are the same but for rounding.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from enum import Enum
from functools import cache
from typing import Any

#: Contact problems up to which a process that solves nothing else is faster without compiled code: it costs 0.3 s of
#: processor time to load, and saves 4 ms a problem at first, of splines and prints, too.
FEWEST_PROBLEMS = 80
#: Problems in one call from which code that is not kept is compiled for them.
FEWEST_PROBLEMS_TO_COMPILE = 50_000
#: Switches the compiled code off, for a process and those that it starts.
SWITCH = "EASEOFF_COMPILED"
#: Set in the process that compiles for the one that started it.
COMPILES_APART = "EASEOFF_COMPILES_APART"
COMPILING = "compiling the contact analysis, once for this version on this machine: half a minute to one"


class Use(Enum):
    """Use of compiled code."""

    NONE = "none"
    KEPT = "kept"  # what is on disk
    COMPILED = "compiled"  # what is not on disk is compiled


_use: ContextVar[Use] = ContextVar("use_of_compiled_code", default=Use.KEPT)
_told: ContextVar[Callable[[str], None] | None] = ContextVar("compilation_told", default=None)


def is_used() -> bool:
    """Whether compiled code may be used here."""
    return _use.get() is not Use.NONE and _is_switched_on()


def may_compile() -> bool:
    """Whether code that is not kept on disk may be compiled here."""
    return _use.get() is Use.COMPILED or _compiles_apart()


@cache
def _compiles_apart() -> bool:
    return bool(os.environ.get(COMPILES_APART))


@cache
def _is_switched_on() -> bool:
    return os.environ.get(SWITCH, "1") != "0"


class NotCompiledError(ImportError):
    """Code is not kept on disk, and nobody asked for its compilation."""


def compiled_code_of(imported: Callable[[], Any]) -> Any:
    """The module of compiled functions that a function imports, once; None where they are not used or cannot be.

    Parameters
    ----------
    imported
        Imports the module and returns it.
    """
    return _loaded(imported, may_compile()) if is_used() else None


@cache
def _loaded(imported: Callable[[], Any], compiles: bool) -> Any:
    """The module, as far as it can be had with or without compilation."""
    try:
        return imported()
    except ImportError:  # no numba, none for this Python or numpy, or nothing kept
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
    with _using(Use.NONE if wanted else _use.get()):
        yield


@contextmanager
def compiling(wanted: bool = True) -> Iterator[None]:
    """Compile what is not kept on disk within this context, but not within ``without_compiled_code``.

    Parameters
    ----------
    wanted
        Whether there is work enough; otherwise nothing changes.

    Examples
    --------
    >>> with compiling():
    ...     may_compile()
    True
    """
    with _using(Use.COMPILED if wanted and _use.get() is Use.KEPT else _use.get()):
        yield


@contextmanager
def _using(use: Use) -> Iterator[None]:
    token = _use.set(use)
    try:
        yield
    finally:
        _use.reset(token)


@contextmanager
def compilation_told(tell: Callable[[str], None]) -> Iterator[None]:
    """Call a function with one line of text before code is compiled within this context, which takes seconds."""
    token = _told.set(tell)
    try:
        yield
    finally:
        _told.reset(token)


def tell_of_compilation() -> None:
    """Tell once that code is about to be compiled, to whom it may concern, and look anew for what was not kept."""
    _loaded.cache_clear()
    tell = _told.get()
    if tell is not None:
        _told.set(None)
        tell(COMPILING)
