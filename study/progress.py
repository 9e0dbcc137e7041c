"""Progress of what takes long: a bar on a terminal, one line in a notebook, plain lines elsewhere."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial, wraps
from inspect import signature
from typing import Any, ParamSpec, Self, TypeVar

from ..core.errors import InputError, printable, time_in_words

FIRST_LINE = 2.0  # [s] from the start
LEAST_INTERVAL, INTERVAL_SHARE = 5.0, 0.25  # between lines: [s], and of the time so far
FORETOLD_SHARE, FORETOLD_STEPS = 0.03, 3  # steps done before which nothing is said of those left: part, number
SWITCH = "EASEOFF_PROGRESS"  # an environment variable; "off" for no lines where there is no terminal


def terminal_bar(**options: Any) -> Any:
    """A bar of tqdm on a terminal, without tqdm's thread; elsewhere lines of ``desc``, ``total`` and ``unit``.

    In that thread Python may collect garbage, and close a netCDF file while the main thread is in the netCDF library,
    which ends the process.
    """
    if not _on_terminal() and lines_wanted():
        known = {name: options[name] for name in ("desc", "total", "unit") if name in options}
        return ProgressLines(**known)
    from tqdm import tqdm

    tqdm.monitor_interval = 0
    return tqdm(disable=not _on_terminal(), leave=False, **options)


@contextmanager
def working(what: str) -> Iterator[None]:
    """Name a step, such as "drawing the pictures", while it runs, if it is not counted and takes over two seconds."""
    if not _on_terminal() and lines_wanted():
        _line(f"{what} ...")
        yield
        return
    with terminal_bar(desc=what, bar_format="{desc} ..."):
        yield


def count(bar: Any, *numbers: float) -> None:
    """Count a step, or set the number of those that are done and of all."""
    if len(numbers) > 1:
        bar.total = numbers[1]
    bar.update(numbers[0] - bar.n if numbers else 1)


class ProgressLines:
    """Progress as lines on the standard error output: the first after two seconds, then ever fewer."""

    disable = False

    def __init__(self, desc: str = "", total: float | None = None, unit: str = "step") -> None:
        self.description, self.total, self.unit = desc, total, unit
        self.n = 0.0
        self._postfix = ""
        self._begin = self._stage_begin = time.perf_counter()
        self._next = self._begin + FIRST_LINE

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        return None

    def update(self, steps: float = 1) -> None:
        """Count steps that are done."""
        self.n += steps
        self._tell()

    def reset(self) -> None:
        """Begin a stage."""
        self.n = 0.0
        self._stage_begin = time.perf_counter()

    def set_description_str(self, desc: str) -> None:
        """Name the stage."""
        if desc != self.description:
            self.description = desc
            self._tell(at_once=True)

    def set_postfix_str(self, text: str) -> None:
        """Name what is done within the stage."""
        self._postfix = text

    def clear(self) -> None:
        """Nothing: lines stay; a bar leaves the terminal to other output until it is refreshed."""

    def words(self, seconds: float) -> str:
        """The line of now, which is a time [s] after the begin of the stage."""
        name = f"{self.description}, {self._postfix}" if self._postfix else self.description
        if not self.total:
            units = self.unit if self.n == 1 else f"{self.unit}s"
            return f"{name}: {self.n:.5g} {units}, {seconds:.0f} s" if self.n and seconds >= 1.0 else f"{name} ..."
        if not self.n:
            return f"{name}: {self.total:.5g} {self.unit}s ..."
        known = self.n >= max(FORETOLD_SHARE * self.total, FORETOLD_STEPS)
        left = seconds * (self.total - self.n) / self.n if known else 0.0
        line = f"{name}: {self.n:.5g} of {self.total:.5g} {self.unit}s, {seconds:.0f} s"
        return f"{line}, {time_in_words(left)} left" if left > 0.0 else line

    def _tell(self, *, at_once: bool = False) -> None:
        now = time.perf_counter()
        if now < self._next and not (at_once and now > self._begin + FIRST_LINE):
            return
        _line(self.words(now - self._stage_begin))
        self._next = now + max(LEAST_INTERVAL, INTERVAL_SHARE * (now - self._begin))


def _on_terminal() -> bool:
    return sys.stderr is not None and sys.stderr.isatty()


def lines_wanted() -> bool:
    """True if progress is told in lines where there is no terminal."""
    return sys.stderr is not None and os.environ.get(SWITCH, "") != "off"


def _line(text: str) -> None:
    with suppress(OSError, ValueError):  # of a full disk or a closed pipe; the work goes on
        print(printable(text), file=sys.stderr, flush=True)  # noqa: T201


P = ParamSpec("P")
R = TypeVar("R")
Call = TypeVar("Call", bound=Callable[..., None])


def shows_progress(name: str, unit: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Have a function show its progress for ``progress=True``; it also takes a function, False or None.

    ``name`` is that of the work, such as "analysis", ``unit`` that of a step, in the singular.
    """

    def decorated(function: Callable[P, R]) -> Callable[P, R]:
        from ..core.checks import instance, shown  # commands that count for themselves start without arrays

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


def callback(progress: Call | bool | None) -> Call | None:
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
