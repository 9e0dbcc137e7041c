"""Where solvers of one's own are found: a declaration, a function, ``module:function``, or an entry point.

A distribution announces its solvers in the entry-point group ``easeoff.solvers``, each by a name and the place of a
function or a `Solver`. Nothing of it is imported before the solver is used.
"""

from __future__ import annotations

import contextlib
import functools
import importlib
import importlib.metadata
import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from ....core.checks import shown
from ....core.errors import InputError
from ....core.foreign_code import IMPORT_TIME_LIMIT, ForeignCodeError, foreign_code
from ..solver_table import SOLVERS
from .solver_declaration import Solver

#: Group of entry points of distributions that bring solvers.
ENTRY_POINT_GROUP = "easeoff.solvers"

#: What names a solver: a name, ``module:function``, a function, or its declaration.
SolverChoice = str | Solver | Callable[..., Any]


def declared_solver(solver: SolverChoice) -> Solver | None:
    """Return the declaration of a solver of one's own; None for a name that is none, such as those of the table.

    Parameters
    ----------
    solver
        A `Solver`, a function, ``module:function``, or a name of the entry-point group ``easeoff.solvers``. Names of
        the table come first.

    Raises
    ------
    InputError
        It is nothing of the kind, or cannot be imported.
    """
    if isinstance(solver, Solver):
        return solver
    if isinstance(solver, str) and (solver == "auto" or solver in SOLVERS):
        return None
    try:
        with foreign_code(IMPORT_TIME_LIMIT):
            if not isinstance(solver, str):
                if callable(solver):
                    return Solver(_name_of(solver), solver)
                what = shown(solver)
                raise InputError(
                    f"solver = {what}: must be the name of a solver, MODULE:FUNCTION, a function or a Solver"
                )
            return _solver_at(solver) if declares_place(solver) else _entry_point_solver(solver, tuple(sys.path))
    except ForeignCodeError as error:
        once = "; if only the first import takes long, import it in Python once" if error.is_time_limit else ""
        raise InputError(f"solver = {shown(solver)}: cannot be loaded: {error}{once}") from error


def entry_point_names() -> list[str]:
    """Names of the solvers that installed distributions bring, in order, without those of the table."""
    return sorted({point.name for point in _entry_points()} - {*SOLVERS, "auto"})


def entry_point(name: str) -> importlib.metadata.EntryPoint | None:
    """The entry point that brings a solver, with its distribution; None if none does."""
    return next((point for point in _entry_points() if point.name == name), None)


@contextlib.contextmanager
def current_folder_last() -> Iterator[None]:
    """Let modules be found in the current folder, too, which is searched last."""
    folder = os.getcwd()
    if folder in sys.path or "" in sys.path:
        yield
        return
    with contextlib.suppress(ImportError):
        importlib.import_module("qpsolvers")  # first, because it tries to import every solver it knows
    sys.path.append(folder)
    try:
        yield
    finally:
        with contextlib.suppress(ValueError):
            sys.path.remove(folder)


def _entry_points() -> list[importlib.metadata.EntryPoint]:
    return list(importlib.metadata.entry_points(group=ENTRY_POINT_GROUP))


@functools.lru_cache(maxsize=64)
def _entry_point_solver(name: str, _path: tuple[str, ...]) -> Solver | None:
    points = [point for point in _entry_points() if point.name == name]
    if not points:
        return None
    if len({point.value for point in points}) > 1:
        owners = ", ".join(sorted(str(point.dist.name) if point.dist else point.value for point in points))
        raise InputError(f"solver = {name!r}: must be brought by one distribution; {owners} bring it")
    return _named(name, points[0].load(), points[0].value)


def declares_place(text: str) -> bool:
    """Whether a text is of the form ``module:function``.

    Raises
    ------
    InputError
        It has a colon, and is none.
    """
    module, colon, path = text.partition(":")
    if colon and not (module.replace(".", "a").isidentifier() and path.replace(".", "a").isidentifier()):
        raise InputError(f"solver = {text!r}: must be MODULE:FUNCTION")
    return bool(colon)


def _solver_at(text: str) -> Solver:
    module, _, path = text.partition(":")
    try:
        with current_folder_last():
            found: Any = importlib.import_module(module)
        for name in path.split("."):
            found = getattr(found, name)
    except ModuleNotFoundError as error:
        if error.name is None or not f"{module}.".startswith(f"{error.name}."):
            raise
        raise InputError(f"solver = {text!r}: must be MODULE:FUNCTION; there is no module {error.name!r}") from error
    return _named(text, found, text)


def _named(name: str, found: Any, place: str) -> Solver:
    if isinstance(found, Solver):
        return replace(found, name=name)
    if not callable(found):
        raise InputError(f"solver = {name!r}: must be a function or a Solver, and {place} is {shown(found)}")
    return Solver(name, found)


def _name_of(function: Callable[..., Any]) -> str:
    name = getattr(function, "__name__", type(function).__name__)
    module = getattr(function, "__module__", None)
    return name if module in (None, "__main__") else f"{module}:{name}"
