"""Adapter of PIQP, a proximal interior-point solver (Schwan et al. 2023, doi 10.1109/CDC49753.2023.10383915)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...problem.scaled_problem import ScaledProblem
from ..backend import read_answer, refuse_unknown, run_qpsolvers
from ..scaled_answer import ScaledAnswer
from ..solution import Status

_SUSPICIONS = {
    "PIQP_PRIMAL_INFEASIBLE": Status.INFEASIBLE,
    "PIQP_DUAL_INFEASIBLE": Status.UNBOUNDED,
    "PIQP_MAX_ITER_REACHED": Status.NOT_CONVERGED,
}


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem."""
    import piqp

    refuse_unknown("piqp", settings, ("backend",), piqp.DenseSolver().settings)
    solution = run_qpsolvers("piqp", problem, settings)
    info = solution.extras["info"]
    status = str(info.status).rpartition(".")[2]
    return read_answer(solution, iterations=int(info.iter), message=status, suspicion=_SUSPICIONS.get(status))
