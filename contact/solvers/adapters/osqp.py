"""Adapter of OSQP, an alternating direction method (Stellato et al. 2020, doi 10.1007/s12532-020-00179-2)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...problem.scaled_problem import ScaledProblem
from ..backend import read_answer, run_qpsolvers
from ..scaled_answer import ScaledAnswer
from ..solution import Status

_SUSPICIONS = {
    "primal infeasible": Status.INFEASIBLE,
    "dual infeasible": Status.UNBOUNDED,
    "problem non convex": Status.NOT_POSITIVE_SEMIDEFINITE,
    "run time limit reached": Status.TIME_LIMIT,
    "maximum iterations reached": Status.NOT_CONVERGED,
}


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem."""
    solution = run_qpsolvers("osqp", problem, settings)
    info = solution.extras["info"]
    return read_answer(
        solution, iterations=int(info.iter), message=str(info.status), suspicion=_SUSPICIONS.get(str(info.status))
    )
