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
TOLERANCE_NAMES: dict[str, tuple[str, ...]] = {
    "clarabel": ("tol_gap_abs", "tol_gap_rel", "tol_feas"),
    "osqp": ("eps_abs", "eps_rel"),
    "daqp": ("primal_tol", "dual_tol"),
    "piqp": ("eps_abs", "eps_rel", "eps_duality_gap_abs", "eps_duality_gap_rel"),
    "proxqp": ("eps_abs",),
    "highs": ("primal_feasibility_tolerance", "dual_feasibility_tolerance"),
    "scs": ("eps_abs", "eps_rel"),
    "sip": ("eps_abs", "eps_rel"),
    "pyqpmad": ("tolerance",),
    "qpalm": ("eps_abs", "eps_rel"),
    "cvxopt": ("abstol", "reltol", "feastol"),
    "ecos": ("abstol", "reltol", "feastol"),
    "cvxpy": ("tol_gap_abs", "tol_gap_rel", "tol_feas"),
}
#: What a sweep calls the tolerance of a function of one's own.
OWN_TOLERANCE_NAME = "tolerance"
#: Smallest tolerance that a solver takes.
LEAST_TOLERANCE = {"highs": 1e-10}
#: Solvers whose answers or iterations change with the start they are given. The others ignore it, or have none:
#: a warm start of theirs would measure noise.
STARTING_SOLVERS = ("native", "osqp", "daqp", "proxqp", "scs", "sip", "cvxopt")

_TIME_LIMIT_KEYS = ("time_limit", "time_limit_secs")


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
        limits = {key: time_limit for key in _TIME_LIMIT_KEYS if key in table}
        if self.settings == RAW:
            return limits
        least = max(self.tolerance, LEAST_TOLERANCE.get(self.solver, 0.0))
        swept = dict.fromkeys(TOLERANCE_NAMES[self.solver], least) if self.tolerance else {}
        return {**table, **limits, **swept}


def has_tolerance(solver: str) -> bool:
    """Whether a sweep of tolerances changes anything for a solver."""
    return solver in TOLERANCE_NAMES or solver not in SOLVERS


def takes_start(solver: str) -> bool:
    """Whether a solver makes use of the answer to a neighbouring problem."""
    return solver in STARTING_SOLVERS
