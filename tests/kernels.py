"""Files of compiled functions, compiled or run as the Python that they are written in."""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from easeoff.core.compiled import compiled_use

_LOADED = compiled_use._loaded.__wrapped__


@contextmanager
def in_python() -> Iterator[None]:
    """Use compiled functions within this context, but as plain Python: for small problems, and nothing is compiled.

    Splines are evaluated with numpy: their kernel is written for the processor, and no Python.
    """
    with pytest.MonkeyPatch.context() as patch, np.errstate(all="ignore"):
        patch.setattr(compiled_use, "_is_switched_on", lambda: True)
        patch.setattr(compiled_use, "_loaded", lambda imported, _: _uncompiled(_kernel_of(imported)))
        yield


@contextmanager
def compiled() -> Iterator[None]:
    """Use compiled functions within this context, compiled if they are not kept."""
    with pytest.MonkeyPatch.context() as patch, compiled_use.compiling():
        patch.setattr(compiled_use, "_is_switched_on", lambda: True)
        patch.setattr(compiled_use, "_loaded", cache(_LOADED))
        yield


def _kernel_of(imported: Callable[[], Any]) -> str:
    """Full name of the kernel that a function of the product imports."""
    (name,) = (name for name in imported.__code__.co_names if name.endswith("_kernel"))
    return f"{imported.__module__.rpartition('.')[0]}.{name}"


@cache
def _uncompiled(name: str) -> ModuleType | None:
    """A module of compiled functions, read once more with a decorator that does nothing."""
    if name == "easeoff.contact.lines.spline_kernel":
        return None
    found = importlib.util.find_spec(name)
    assert found is not None
    assert found.origin is not None
    package, _, own = name.rpartition(".")
    spec = importlib.util.spec_from_file_location(f"{package}.uncompiled_{own}", found.origin)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    with pytest.MonkeyPatch.context() as patch:
        compilation = importlib.import_module("easeoff.core.compiled.compilation")
        patch.setattr(compilation, "compiled", lambda *_, **__: lambda function: function)
        spec.loader.exec_module(module)
    return module
