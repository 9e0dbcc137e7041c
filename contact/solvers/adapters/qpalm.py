"""Adapter of QPALM, a proximal augmented Lagrangian solver (Hermans et al. 2022, doi 10.1007/s12532-022-00218-0)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...problem.scaled_problem import ScaledProblem
from ..backend import read_answer, refuse_unknown, run_qpsolvers
from ..scaled_answer import ScaledAnswer
from ..solution import Status

_SUSPICIONS = {
    "primal infeasible": Status.INFEASIBLE,
    "dual infeasible": Status.UNBOUNDED,
    "time limit exceeded": Status.TIME_LIMIT,
    "maximum iterations reached": Status.NOT_CONVERGED,
}


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem."""
    import qpalm

    refuse_unknown("qpalm", settings, qpalm.Settings())
    solution = run_qpsolvers("qpalm", problem, settings)
    info = solution.extras["info"]
    status = str(info.status)
    return read_answer(solution, iterations=int(info.iter), message=status, suspicion=_SUSPICIONS.get(status))
