"""Lemke's complementary pivoting as a solver of contact problems, see ``complementary_pivoting``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ....core.errors import InputError
from ...problem.complementary_pivoting import lemke
from ...problem.programme_forms import eliminated_system, forces_and_rotation
from ...problem.scaled_problem import ScaledProblem
from ..backend import NoAnswerError
from ..solution import ScaledAnswer, Status
from ..solver_table import SOLVERS


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem; the settings are ``max_pivots`` and ``time_limit`` [s]."""
    if unknown := sorted(set(settings) - {"max_pivots", "time_limit"}):
        raise InputError(f"settings = {', '.join(unknown)}: must be max_pivots or time_limit, the settings of lemke")
    size, largest = problem.separation.size, SOLVERS["lemke"].largest
    if largest is not None and size > largest:
        raise InputError(f"size = {size}: must be at most {largest} segments for lemke")
    matrix, vector, eliminated = eliminated_system(problem)
    result = lemke(matrix, vector, **settings)
    if result.ended == "ray":
        raise NoAnswerError("ended on a ray: no forces satisfy all conditions", Status.UNBOUNDED)
    if result.ended == "pivot limit":
        raise NoAnswerError(f"not at the end after {result.pivots} pivots", Status.NOT_CONVERGED)
    if result.ended == "time limit":
        raise NoAnswerError(f"time limit met after {result.pivots} pivots", Status.TIME_LIMIT)
    force, rotation = forces_and_rotation(problem, eliminated, result.z)
    gap = matrix @ result.z + vector  # w, in which the eliminated segment has its force
    gap[eliminated] = result.z[eliminated]
    return ScaledAnswer(force, rotation, result.pivots, "solved", gap=gap)
