"""Method of a comparison: a solver with settings, a start and, in a sweep, a tolerance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ....contact.solvers import SOLVERS

#: Settings a solver can be run with, and what they mean; the headline first.
SETTINGS = {
    "scaled": "scaled problem, tight tolerances; the solver's own answer",
    "polished": "the same, then one linear solve on the active set that the solver found",
    "raw": "problem in mm and N, the solver's default settings; its own answer",
    "sweep": "scaled problem, a tolerance of the sweep; the solver's own answer",
}
HEADLINE, POLISHED, RAW, SWEEP = SETTINGS
#: Starts of a solver.
COLD, WARM = "cold", "warm"

#: What a solver calls the tolerances that a sweep sets all alike; one that is not listed has none.
TOLERANCE_NAMES = {name: entry.tolerance_settings for name, entry in SOLVERS.items() if entry.tolerance_settings}
#: What a sweep calls the tolerance of a function of one's own.
OWN_TOLERANCE_NAME = "tolerance"
#: Smallest tolerance that a solver takes.
LEAST_TOLERANCE = {name: entry.least_tolerance for name, entry in SOLVERS.items() if entry.least_tolerance}
#: Solvers whose answers or iterations change with the start they are given. The others ignore it, or have none:
#: a warm start of theirs would measure noise.
STARTING_SOLVERS = tuple(name for name, entry in SOLVERS.items() if entry.warm_start)


@dataclass(frozen=True)
class Method:
    """A solver with everything that is chosen for it.

    Attributes
    ----------
    solver
        A name of the table of solvers, or of one's own.
    settings
        A name of `SETTINGS`.
    start
        ``cold`` or ``warm``.
    tolerance
        Tolerance of a sweep; zero for those of the settings.

    Examples
    --------
    >>> Method("osqp", "sweep", "cold", 1e-3).keywords(10.0)["eps_abs"]
    0.001
    """

    solver: str
    settings: str
    start: str = COLD
    tolerance: float = 0.0

    def keywords(self, time_limit: float) -> dict[str, Any]:
        """Return the keywords that the solver is called with; for ``raw`` a time limit alone, where it takes one."""
        if self.solver not in SOLVERS:
            own = {"time_limit": time_limit}
            return {**own, OWN_TOLERANCE_NAME: self.tolerance} if self.tolerance else own
        table: Mapping[str, Any] = SOLVERS[self.solver].settings
        key = SOLVERS[self.solver].time_setting
        limits = {key: time_limit} if key in table else {}
        if self.settings == RAW:
            return limits
        least = max(self.tolerance, LEAST_TOLERANCE.get(self.solver, 0.0))
        swept = dict.fromkeys(TOLERANCE_NAMES[self.solver], least) if self.tolerance else {}
        return {**table, **limits, **swept}


def has_tolerance(solver: str) -> bool:
    """Whether a sweep of tolerances changes anything for a solver."""
    return solver in TOLERANCE_NAMES or solver not in SOLVERS


def polishes_itself(solver: str) -> bool:
    """Whether the table's settings have a solver polish its own answer, whatever its tolerance."""
    return solver in SOLVERS and bool(SOLVERS[solver].settings.get("polishing", False))
