"""Adapter of the interior-point method for quadratic programmes in CVXOPT (Vandenberghe 2010, "coneqp")."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...problem.scaled_problem import ScaledProblem
from ..backend import read_answer, refuse_unknown, run_qpsolvers
from ..scaled_answer import ScaledAnswer
from ..solution import Status

_KNOWN = ("maxiters", "abstol", "reltol", "feastol", "refinement", "kktreg", "use_correction")


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem."""
    refuse_unknown("cvxopt", settings, _KNOWN)
    solution = run_qpsolvers("cvxopt", problem, settings)
    # Its only other status is "unknown": the iterations are used up, or a matrix could not be factored.
    return read_answer(
        solution,
        iterations=int(solution.extras["iterations"]),
        message=str(solution.extras["status"]),
        suspicion=Status.NOT_CONVERGED,
    )
