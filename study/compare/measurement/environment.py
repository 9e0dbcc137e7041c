"""Environment of a comparison: processor, Python, and the version of every solver."""

from __future__ import annotations

import hashlib
import importlib
import importlib.metadata
import importlib.util
import os
import platform
import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from typing import Any

from ....contact.solvers import SOLVERS
from ....contact.solvers.declared.solver_lookup import entry_point


def machine(threads: int = 1) -> dict[str, str]:
    """Processor, cores, threads, system, and versions of Python, the numerical packages and their linear algebra."""
    versions = {name: _version(name) for name in ("numpy", "scipy", "qpsolvers", "easeoff")}
    return {
        "processor": processor(),
        "cores": str(os.cpu_count() or "unknown"),
        "threads": f"{threads} for linear algebra",
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "Python": f"{platform.python_implementation()} {platform.python_version()}",
        **versions,
        "code of easeoff": _code_digest(),
        "BLAS of numpy": _linear_algebra("numpy"),
        "BLAS of scipy": _linear_algebra("scipy"),
    }


def _linear_algebra(package: str) -> str:
    """Name and version of the BLAS that a package was built with, with the kernels chosen by the environment."""
    try:
        found: Any = importlib.import_module(package).show_config(mode="dicts")
        library = found["Build Dependencies"]["blas"]
        name = f"{library['name']} {library['version']}"
    except Exception:  # of another build or version, which may tell nothing
        name = "unknown"
    kernels = os.environ.get("OPENBLAS_CORETYPE", "")
    return f"{name}, kernels {kernels}" if kernels else name


def processor() -> str:
    """Model of the processor, as far as the system tells."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor() or platform.machine() or "unknown"


def solver_version(solver: str) -> str:
    """Version of a solver's package; for ``module:function`` and entry points a digest of the module's file, too."""
    if solver in SOLVERS:
        return _version(SOLVERS[solver].package or "easeoff")
    point = entry_point(solver)
    file = _digest((solver if point is None else point.value).partition(":")[0])
    if point is None or point.dist is None:
        return file
    return f"{point.dist.name} {point.dist.version}, {file}"


def _digest(module: str) -> str:
    """Digest of a module's file, in words."""
    found = find_module(module)
    if found is None or found.origin is None or not Path(found.origin).is_file():
        return "unknown"
    return "file " + hashlib.sha256(Path(found.origin).read_bytes()).hexdigest()[:12]


def find_module(module: str) -> ModuleSpec | None:
    """Find a module without running it, last of all in the current folder; ``None`` if there is none."""
    places: Sequence[str] | None = [*sys.path, os.getcwd()]
    found: ModuleSpec | None = None
    names = module.split(".")
    for end in range(1, len(names) + 1):  # `importlib.util.find_spec` would run the packages around it
        found = None if places is None else PathFinder.find_spec(".".join(names[:end]), places)
        places = None if found is None else found.submodule_search_locations
    return found


def _version(package: str, missing: str = "unknown") -> str:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return missing


def _code_digest() -> str:
    """Digest of the package's code that an attempt runs through."""
    digest = hashlib.sha256()
    root = Path(__file__).parents[3]
    for folder in (root / "contact", Path(__file__).parent):
        for path in sorted(folder.rglob("*.py")):
            digest.update(path.relative_to(root).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:12]
