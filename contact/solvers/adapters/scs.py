"""Adapter of SCS, a splitting conic solver (O'Donoghue 2021, doi 10.1137/20M1366307)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...problem.scaled_problem import ScaledProblem
from ..backend import read_answer, run_qpsolvers
from ..scaled_answer import ScaledAnswer
from ..solution import Status

_SUSPICIONS = {
    "infeasible": Status.INFEASIBLE,
    "unbounded": Status.UNBOUNDED,
    "solved (inaccurate - reached time_limit_secs)": Status.TIME_LIMIT,
    "solved (inaccurate - reached max_iters)": Status.NOT_CONVERGED,
}


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem."""
    solution = run_qpsolvers("scs", problem, settings)
    status = str(solution.extras["status"])
    return read_answer(
        solution, iterations=int(solution.extras["iter"]), message=status, suspicion=_SUSPICIONS.get(status)
    )
