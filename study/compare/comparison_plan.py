"""Comparison plan: which methods try which problems, in which order, and the key under which each outcome is kept."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from ...core.checkpoint import digest
from ...core.checks import number, truth, whole
from ...core.errors import InputError
from .measurement.method import (
    COLD,
    HEADLINE,
    POLISHED,
    RAW,
    SWEEP,
    WARM,
    Method,
    has_tolerance,
)
from .measurement.posed_problem import PosedProblem

#: Most tolerances of a sweep.
TOLERANCE_COUNT_LIMIT = 20


@dataclass(frozen=True)
class Choice:
    """What the user chose to measure.

    Attributes
    ----------
    repetitions
        Attempts at each problem by the same method.
    time_limit
        Of an attempt [s].
    polish, raw
        Whether the backends also run with polish, and in mm and N at their own settings.
    tolerances
        Tolerances of the sweep; empty for none.
    threads
        Threads for linear algebra in each process.

    Raises
    ------
    InputError
        A number out of range.
    """

    repetitions: int
    time_limit: float
    polish: bool
    raw: bool
    tolerances: tuple[float, ...]
    threads: int

    def __post_init__(self) -> None:
        whole("repetitions", self.repetitions, 1, 1000)
        number("time_limit", self.time_limit, "s", above=0.0, most=86400.0)
        whole("threads", self.threads, 1, 1024)
        truth("polish", self.polish)
        truth("raw", self.raw)
        for tolerance in self.tolerances:
            number("tolerances", tolerance, above=0.0, below=1.0)
        if len(self.tolerances) > TOLERANCE_COUNT_LIMIT:
            raise InputError(f"tolerances = {len(self.tolerances)} numbers: must be at most {TOLERANCE_COUNT_LIMIT}")
        if len(set(self.tolerances)) < len(self.tolerances):
            twice = next(one for one in self.tolerances if self.tolerances.count(one) > 1)
            raise InputError(f"tolerances = {twice:g}: must not come twice")


@dataclass(frozen=True, eq=False)
class Cell:
    """A problem and a method that tries it."""

    posed: PosedProblem
    method: Method

    def key(self, choice: Choice, made_with: dict[str, str], version: str) -> str:
        """Return the key of the outcome: other for whatever it depends on."""
        values: dict[str, Any] = asdict(self.method)
        return digest(
            problem=self.posed.digest,
            before=self.posed.before_digest if self.method.start == WARM else "",
            version=version,
            repetitions=choice.repetitions,
            time_limit=choice.time_limit,
            machine=made_with,
            **values,
        )


def cells(posed: Sequence[PosedProblem], starting: Mapping[str, bool], choice: Choice) -> Iterator[Cell]:
    """All measurements of solvers, each with whether it makes use of a start.

    Problems are the outermost loop, so that a disturbance of the machine meets all solvers.
    """
    for item in posed:
        for solver, warm in starting.items():
            for method in methods_of(solver, choice, warm=warm):
                if method.start == COLD or item.before is not None:
                    yield Cell(item, method)


def methods_of(solver: str, choice: Choice, *, warm: bool = False) -> Iterator[Method]:
    """Methods in which a solver is measured, the headline first.

    The native solver has one: its answer needs no polish, and it takes no tolerance and no problem without scaling.
    """
    yield Method(solver, HEADLINE)
    if warm:
        yield Method(solver, HEADLINE, WARM)
    if solver == "native":
        return
    if choice.polish:
        yield Method(solver, POLISHED)
    if choice.raw:
        yield Method(solver, RAW)
    if has_tolerance(solver):
        for tolerance in choice.tolerances:
            yield Method(solver, SWEEP, COLD, tolerance)
