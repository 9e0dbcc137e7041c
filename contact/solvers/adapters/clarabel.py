"""Adapter of Clarabel, a sparse interior-point solver (Goulart and Chen 2024, doi 10.48550/arXiv.2405.12762)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...problem.scaled_problem import ScaledProblem
from ..backend import read_answer, run_qpsolvers
from ..scaled_answer import ScaledAnswer
from ..solution import Status

_SUSPICIONS = {
    "PrimalInfeasible": Status.INFEASIBLE,
    "DualInfeasible": Status.UNBOUNDED,
    "MaxTime": Status.TIME_LIMIT,
    "MaxIterations": Status.NOT_CONVERGED,
}


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem."""
    solution = run_qpsolvers("clarabel", problem, settings)
    status = str(solution.extras.get("status", ""))
    return read_answer(solution, message=status, suspicion=_SUSPICIONS.get(status))
