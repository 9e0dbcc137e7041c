"""Defaults of matplotlib, the same in whatever folder and with whatever configuration it runs."""

from __future__ import annotations

import contextlib
import functools
import importlib
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec

if TYPE_CHECKING:
    from matplotlib.figure import Figure

P = ParamSpec("P")
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


def picture(draw: Callable[P, Figure | None]) -> Callable[P, Figure | Any]:
    """Function that draws a page, or on ``axes`` of the caller: it then returns nothing, so a notebook shows them once.

    Whoever gives no axes always gets a figure: ``Any`` spares them a question that the types cannot answer.
    """

    @functools.wraps(draw)
    def drawn(*arguments: P.args, **options: P.kwargs) -> Figure | Any:
        axes = options.get("axes")
        with drawing(axes):
            figure = draw(*arguments, **options)
        return figure if axes is None else None

    return drawn


def _load() -> None:
    """Load matplotlib, from another folder if there is a configuration in the current one."""
    elsewhere = "matplotlib" not in sys.modules and os.path.lexists(CONFIGURATION)
    with contextlib.chdir(Path(__file__).parent) if elsewhere else contextlib.nullcontext():
        importlib.import_module("matplotlib")
