"""Style of the drawing library: its own defaults, in whatever folder and with whatever configuration it runs."""

from __future__ import annotations

import contextlib
import importlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path

#: File that matplotlib looks for in the current folder when it is loaded.
CONFIGURATION = "matplotlibrc"


@contextlib.contextmanager
def drawing(axes: object) -> Iterator[None]:
    """Draw pages with matplotlib's defaults, and on axes of the caller with the caller's settings.

    A file ``matplotlibrc`` in the current folder, which may be a stranger's, is not read.
    """
    if axes is not None:
        from .own_axes import on_own_axes

        with on_own_axes(axes):
            yield
        return
    _load()
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        yield


def _load() -> None:
    """Load matplotlib, from another folder if there is a configuration in the current one."""
    elsewhere = "matplotlib" not in sys.modules and os.path.lexists(CONFIGURATION)
    with contextlib.chdir(Path(__file__).parent) if elsewhere else contextlib.nullcontext():
        importlib.import_module("matplotlib")
