"""Adapter of the quadratic solver in HiGHS (Huangfu and Hall 2018, doi 10.1007/s12532-017-0130-5)."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

from ...problem.scaled_problem import ScaledProblem
from ..backend import read_answer, refuse_unknown, run_qpsolvers
from ..scaled_answer import ScaledAnswer
from ..solution import Status


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem."""
    import highspy

    refuse_unknown("highs", settings, highspy.HighsOptions())
    start = time.perf_counter()
    solution = run_qpsolvers("highs", problem, settings)
    # The interface does not pass the reason on; at the time limit the clock tells.
    late = time.perf_counter() - start >= settings.get("time_limit", float("inf"))
    if late and not solution.found:
        return read_answer(solution, message="time limit reached", suspicion=Status.TIME_LIMIT)
    return read_answer(solution)
