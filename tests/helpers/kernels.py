"""The compiled modules, run as the Python that they are written in: for small problems."""

from __future__ import annotations

import importlib.util
import sys
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest

import easeoff

#: Modules by their package, each after those that it uses.
KERNELS = {
    "easeoff.contact.problem": ("mode_kernel",),
    "easeoff.contact.solvers.compiled": (
        *("block_algebra", "line_deflection", "proof_kernel", "dense_kernel", "newton_kernel"),
    ),
    "easeoff.contact.lines": ("spline_kernel",),
    "easeoff.contact.evaluation": ("least_gap_kernel",),
}


@cache
def in_python(name: str) -> ModuleType:
    """A kernel by its full name, read from its source, as are those that it uses."""
    package, _, _ = name.rpartition(".")
    with pytest.MonkeyPatch.context() as patch:
        for other in KERNELS[package]:
            full = f"{package}.{other}"
            source = Path(easeoff.__file__).parent.joinpath(*full.split(".")[1:]).with_suffix(".py")
            spec = importlib.util.spec_from_file_location(full, source)
            assert spec is not None
            assert spec.loader is not None
            module = importlib.util.module_from_spec(spec)
            patch.setitem(sys.modules, full, module)
            spec.loader.exec_module(module)
        return sys.modules[name]
