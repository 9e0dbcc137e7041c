"""Adapter of SIP, a sparse regularised interior-point solver (https://github.com/joaospinto/sip_qp)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...problem.scaled_problem import ScaledProblem
from ..backend import read_answer, refuse_unknown, run_qpsolvers
from ..scaled_answer import ScaledAnswer
from ..solution import Status

_SUSPICIONS = {
    "LOCALLY_INFEASIBLE": Status.INFEASIBLE,
    "TIMEOUT": Status.TIME_LIMIT,
    "ITERATION_LIMIT": Status.NOT_CONVERGED,
}


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem."""
    import sip_qp_python

    known = sip_qp_python.Settings()
    refuse_unknown("sip", settings, ("eps_abs", "eps_rel", "time_limit"), known, known.sip)
    solution = run_qpsolvers("sip", problem, settings)
    info = solution.extras["sip_output"]
    status = str(info.exit_status).rpartition(".")[2]
    return read_answer(solution, iterations=int(info.num_iterations), message=status, suspicion=_SUSPICIONS.get(status))
