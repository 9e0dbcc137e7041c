"""Import everything before forking: no child spends its time on it."""

from __future__ import annotations

import importlib
import pkgutil


def load() -> None:
    """Import every module of the package, but for adapters of solvers that are not installed."""
    import easeoff

    for found in pkgutil.walk_packages(easeoff.__path__, "easeoff."):
        if ".adapters." not in found.name:
            importlib.import_module(found.name)
    for name in ("scipy.optimize", "scipy.interpolate", "tqdm", "PIL.Image", "netCDF4", "clarabel"):
        importlib.import_module(name)
