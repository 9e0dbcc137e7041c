"""Progress of what is called from Python: one line in a notebook or on a terminal, plain lines elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial, wraps
from inspect import signature
from typing import Any, ParamSpec, TypeVar

from ..core.checks import instance, shown
from ..core.errors import InputError
from .terminal_bar import count, terminal_bar

P = ParamSpec("P")
R = TypeVar("R")
Call = TypeVar("Call", bound=Callable[..., None])


def shows_progress(name: str, unit: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Have a function show its progress for ``progress=True``; it also takes a function, False or None.

    ``name`` is that of the work, such as "analysis", ``unit`` that of a step, in the singular.
    """

    def decorated(function: Callable[P, R]) -> Callable[P, R]:
        staged = "stage" in signature(function).parameters

        @wraps(function)
        def showing(*args: P.args, **kwargs: P.kwargs) -> R:
            given: Any = kwargs
            progress = given.get("progress")
            if staged:
                instance("stage", given.get("stage"), Callable | None)
            if progress is False:
                given["progress"] = progress = None
            if progress is not True:
                if progress is not None and not callable(progress):
                    words = "must be True, False, or a function that is called after every step"
                    raise InputError(f"progress = {shown(progress)}: {words}")
                return function(*args, **kwargs)
            make = _notebook_bar if "ipykernel" in sys.modules else terminal_bar
            with make(desc=name, unit=unit) as bar:
                given["progress"] = partial(count, bar)
                if staged and given.get("stage") is None:
                    given["stage"] = bar.set_description_str
                return function(*args, **kwargs)

        return showing

    return decorated


def told(progress: Call | bool | None) -> Call | None:
    """The function to call after every step of a function that ``shows_progress``; ``None`` if there is none."""
    return None if isinstance(progress, bool) else progress


@contextmanager
def _notebook_bar(**options: Any) -> Iterator[Any]:
    """A bar of tqdm that is gone at the end."""
    from tqdm.auto import tqdm

    tqdm.monitor_interval = 0  # no thread, see terminal_bar
    bar: Any
    widgets = "tqdm.notebook" in sys.modules and issubclass(tqdm, sys.modules["tqdm.notebook"].tqdm_notebook)
    if not widgets:
        with tqdm(leave=False, **options) as bar:
            yield bar
        return
    from IPython.display import display

    # Displayed here and not by tqdm, whose bar leaves its first line as text in the notebook's file.
    with tqdm(leave=False, display=False, **options) as bar:
        shown_bar = display(bar.container, display_id=True)
        try:
            yield bar
        finally:
            if shown_bar is not None:
                shown_bar.update({"text/plain": ""}, raw=True)
