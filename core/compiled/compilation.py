"""Compilation of functions by numba, kept on disk where it finds a folder that can be written.

A file of compiled functions calls none of another file: numba recompiles a function when the file that it is in has
changed, but does not notice a change of a file from which that calls another one.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from collections.abc import Callable
from typing import Any, TypeVar

import numba

from .compiled_use import COMPILES_APART, NotCompiledError, may_compile, tell_of_compilation

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(signature: Any = None, **options: Any) -> Callable[[Function], Function]:
    """Decorator that compiles a function, with a signature when its file is imported.

    A file whose functions are not kept on disk cannot be imported where none may be compiled.
    """

    def decorate(function: Function) -> Function:
        try:
            found = numba.njit(cache=True, error_model="numpy", **options)(function)
        except RuntimeError as error:
            if "cache" not in str(error):
                raise
            found = numba.njit(error_model="numpy", **options)(function)
        if signature is not None:
            if not _is_kept(found, signature):
                if not may_compile():
                    raise NotCompiledError(f"{function.__name__} is not kept as compiled code")
                tell_of_compilation()
                _compile_apart(found, function.__module__)
            found.compile(signature)
            found.disable_compile()
        return found  # type: ignore[no-any-return]

    return decorate


def _compile_apart(function: Any, module: str) -> None:
    """Compile in a process of its own, and keep the code on disk; this process then loads it, as all later ones do.

    In the process that compiles, LLVM runs other copies of the inner functions than in one that loads the code, and
    they take their sums in another order: a sweep would have other bits the first time on a machine.
    """
    if function.stats.cache_path is None or not sys.executable or os.environ.get(COMPILES_APART):
        return
    code = f"import sys; sys.path[:] = {sys.path!r}; import {module}"
    quiet: dict[str, Any] = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
    with contextlib.suppress(OSError):  # else it is compiled here
        subprocess.run(
            [sys.executable, "-P", "-c", code], env={**os.environ, COMPILES_APART: "1"}, check=False, **quiet
        )


def _is_kept(function: Any, signature: Any) -> bool:
    """Whether code of a function is on disk for the file as it is now, by the index that numba loads it from."""
    if function.stats.cache_path is None:
        return False
    kept = function._cache  # numba asks it when it compiles; there is no other way to ask
    return kept._index_key(signature, function.targetctx.codegen()) in kept._cache_file._load_index()


def readable(kind: Any, dimensions: int) -> Any:
    """Type of an array that is read: writeable ones may stand for it."""
    return numba.types.Array(kind, dimensions, "C", readonly=True)
