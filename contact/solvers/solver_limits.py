"""Limits of a solve: tolerance, time and steps, in the words of every solver.

The tolerance is the same for all solvers: the largest violation that the certificate may have. A solver of the table
reaches its certificate, ``SolverSettings.tolerance``, with the settings of the table; for another one its own
stopping tolerances are changed in proportion, those of interior-point methods with the square: they leave force and gap
of a touching segment both at the root of theirs. Exact methods have no tolerance: theirs is the certificate alone.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any

from ...core.checks import bounded, check_fields
from ...core.errors import InputError
from ..problem.certificate import EXACT_TOLERANCE
from .solution import Status
from .solver_table import SOLVERS

#: Stopping tolerances given to a backend: below, rounding keeps it from ever stopping; above, it would not begin.
OWN_TOLERANCE_RANGE = (1e-13, 1e-2)
#: Time limits given to a backend [s]: some take zero for no limit, and some no infinity.
OWN_TIME_RANGE = (1e-9, 1e9)


@dataclass(frozen=True)
class Limits:
    """Limits of a solve; None for those of the solver."""

    tolerance: float | None = field(default=None, metadata=bounded(above=0.0, below=1.0))
    time_limit: float | None = field(default=None, metadata=bounded("s", least=0.0, infinite=True))
    max_iterations: int | None = field(default=None, metadata=bounded(least=1))

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def exact_tolerance(self) -> float:
        """Certificate that an answer made on its active set must reach."""
        return EXACT_TOLERANCE if self.tolerance is None else min(self.tolerance, EXACT_TOLERANCE)


def backend_keywords(name: str, limits: Limits, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Keywords for a backend: settings of the table, limits in its own words, and the caller's settings on top.

    A limit that the backend cannot have, or that is given in both words, is refused.
    """
    entry = SOLVERS[name]
    keywords, limit_keywords = dict(entry.settings), {}
    foreign = name == "cvxpy" and str(settings.get("backend", "clarabel")).lower() != "clarabel"
    if foreign and limits != Limits():
        raise InputError(
            f"backend = {settings['backend']!r}: must be clarabel with tolerance, time_limit or max_iterations; give "
            "limits in the words of that solver"
        )
    if limits.tolerance is not None:
        ratio = (limits.tolerance / entry.tolerance) ** entry.tolerance_power
        least, most = OWN_TOLERANCE_RANGE
        for key in entry.tolerance_settings:
            asked = max(keywords[key] * ratio, min(least, keywords[key]), entry.least_tolerance)
            limit_keywords[key] = min(asked, most)
    for word, setting in (("time_limit", "time_setting"), ("max_iterations", "step_setting")):
        value, key = getattr(limits, word), getattr(entry, setting)
        if value is None:
            continue
        if not key:
            able = ", ".join(other for other, facts in SOLVERS.items() if getattr(facts, setting))
            raise InputError(f"{word} = {value}: must not be given for {name}, which has none; {able} have one")
        limit_keywords[key] = min(max(value, OWN_TIME_RANGE[0]), OWN_TIME_RANGE[1]) if word == "time_limit" else value
    if twice := sorted(set(limit_keywords) & set(settings)):
        raise InputError(
            f"{twice[0]} = {settings[twice[0]]}: must not be given beside tolerance, time_limit and max_iterations, "
            "which set it"
        )
    return {**keywords, **limit_keywords, **settings}


def limit_met(name: str, settings: Mapping[str, Any], elapsed: float) -> Status | None:
    """Limit that ended a backend without an answer, if it does not say so itself; run time in [s]."""
    entry = SOLVERS[name]
    if elapsed >= settings.get(entry.time_setting, math.inf):
        return Status.TIME_LIMIT
    # A contact problem has a solution: where the caller lowered the steps, these ended it.
    usual = entry.settings.get(entry.step_setting, math.inf)
    return Status.NOT_CONVERGED if settings.get(entry.step_setting, math.inf) < usual else None


def limit_hint(name: str, given: Collection[str]) -> str:
    """Advice for settings that look like a limit in other words; empty where there is none."""
    if name not in SOLVERS:
        return ""
    entry = SOLVERS[name]
    limits = (
        ("max_iterations", "iter", entry.step_setting),
        ("time_limit", "time", entry.time_setting),
        ("tolerance", "tol", entry.tolerance_settings),
    )
    hints = [word for word, part, has in limits if has and any(part in key.lower() for key in given)]
    return f"; give {' and '.join(hints)}, which every solver takes that has one" if hints else ""


class StepBudget:
    """Steps and time left to the native solver over all its methods, from a start by `time.perf_counter` [s]."""

    def __init__(self, limits: Limits, start: float | None = None) -> None:
        begin = perf_counter() if start is None else start
        self._end = None if limits.time_limit is None else begin + limits.time_limit
        self._left = limits.max_iterations
        #: The limit that was met, or None.
        self.met: Status | None = None

    def step(self) -> bool:
        """Take one step off, and return whether it may be made."""
        if self._left is not None and self._left <= 0:
            self.met = self.met or Status.NOT_CONVERGED
        elif self._end is not None and perf_counter() >= self._end:
            self.met = self.met or Status.TIME_LIMIT
        elif self._left is not None:
            self._left -= 1
        return self.met is None


#: Without limits; it keeps no count.
UNLIMITED = StepBudget(Limits())
