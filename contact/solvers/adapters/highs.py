"""Adapter of the quadratic solver in HiGHS (Huangfu and Hall 2018, doi 10.1007/s12532-017-0130-5)."""

from __future__ import annotations

from collections.abc import Mapping
from time import perf_counter
from typing import Any

from ...problem.scaled_problem import ScaledProblem
from ..backend import read_answer, refuse_unknown, run_qpsolvers
from ..scaled_answer import ScaledAnswer
from ..solver_limits import limit_met


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem."""
    import highspy

    refuse_unknown("highs", settings, highspy.HighsOptions())
    start = perf_counter()
    solution = run_qpsolvers("highs", problem, settings)
    return read_answer(
        solution, suspicion=None if solution.found else limit_met("highs", settings, perf_counter() - start)
    )
