"""Environment of a comparison: processor, Python, and the version of every solver."""

from __future__ import annotations

import hashlib
import importlib.metadata
import importlib.util
import os
import platform
import sys
from importlib.machinery import ModuleSpec
from pathlib import Path

from ...contact.solvers import SOLVERS


def machine() -> dict[str, str]:
    """Processor, cores, system, and versions of Python and the numerical packages, by name."""
    versions = {name: _version(name) for name in ("numpy", "scipy", "qpsolvers", "easeoff")}
    return {
        "processor": processor(),
        "cores": str(os.cpu_count() or "unknown"),
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "Python": f"{platform.python_implementation()} {platform.python_version()}",
        **versions,
    }


def processor() -> str:
    """Model of the processor, as far as the system tells."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor() or platform.machine() or "unknown"


def solver_version(solver: str) -> str:
    """Version of a solver's package; for ``module:function`` a digest of the module's file."""
    module, own, _ = solver.partition(":")
    if own:
        found = find_module(module)
        if found is None or found.origin is None or not Path(found.origin).is_file():
            return "unknown"
        return "file " + hashlib.sha256(Path(found.origin).read_bytes()).hexdigest()[:12]
    return _version(SOLVERS[solver].package or "easeoff")


def find_module(module: str) -> ModuleSpec | None:
    """Find a module without running it, last of all in the current folder; ``None`` if there is none."""
    before = list(sys.path)
    sys.path.append(os.getcwd())
    try:
        return importlib.util.find_spec(module)
    except (ImportError, ValueError, AttributeError):
        return None
    finally:
        sys.path[:] = before


def _version(package: str) -> str:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "unknown"
