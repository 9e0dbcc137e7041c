"""Adapter of ProxQP, a proximal augmented Lagrangian solver (Bambade et al. 2022, doi 10.15607/RSS.2022.XVIII.040)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...problem.scaled_problem import ScaledProblem
from ..backend import read_answer, run_qpsolvers
from ..scaled_answer import ScaledAnswer
from ..solution import Status

_SUSPICIONS = {
    "PROXQP_PRIMAL_INFEASIBLE": Status.INFEASIBLE,
    "PROXQP_DUAL_INFEASIBLE": Status.UNBOUNDED,
    "PROXQP_MAX_ITER_REACHED": Status.NOT_CONVERGED,
}


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem."""
    solution = run_qpsolvers("proxqp", problem, settings)
    info = solution.extras["info"]
    status = str(info.status).rpartition(".")[2]
    return read_answer(solution, iterations=int(info.iter), message=status, suspicion=_SUSPICIONS.get(status))
