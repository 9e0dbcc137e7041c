"""Compilation of functions by numba, kept on disk where it finds a folder that can be written.

A file of compiled functions calls none of another file: numba recompiles a function when the file that it is in has
changed, but does not notice a change of a file from which that calls another one.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba

from .compiled_use import tell_of_compilation

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(signature: Any = None, **options: Any) -> Callable[[Function], Function]:
    """Decorator that compiles a function, with a signature when its file is imported."""

    def decorate(function: Function) -> Function:
        try:
            found = numba.njit(cache=True, error_model="numpy", **options)(function)
        except RuntimeError as error:
            if "cache" not in str(error):
                raise
            found = numba.njit(error_model="numpy", **options)(function)
        if signature is not None:
            if not _is_kept(found, Path(function.__code__.co_filename)):
                tell_of_compilation()
            found.compile(signature)
            found.disable_compile()
        return found  # type: ignore[no-any-return]

    return decorate


def _is_kept(function: Any, source: Path) -> bool:
    """Whether there is code of a compiled function on disk that is not older than its file."""
    folder = function.stats.cache_path
    if folder is None or not source.exists():
        return False
    kept = list(Path(folder).glob(f"{source.stem}.{function.__name__}-*.nbi"))
    return any(index.stat().st_mtime >= source.stat().st_mtime for index in kept)


def readable(kind: Any, dimensions: int) -> Any:
    """Type of an array that is read: writeable ones may stand for it."""
    return numba.types.Array(kind, dimensions, "C", readonly=True)
