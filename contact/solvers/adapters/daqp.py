"""Adapter of DAQP, a dense dual active-set solver (Arnstrom et al. 2022, doi 10.1109/TAC.2022.3176430)."""

from __future__ import annotations

from collections.abc import Mapping
from time import perf_counter
from typing import Any

from ...problem.scaled_problem import ScaledProblem
from ..backend import read_answer, run_qpsolvers
from ..scaled_answer import ScaledAnswer
from ..solver_limits import limit_met

#: Proximal iterations, for matrices that are numerically singular, where the plain method finds nothing.
_PROXIMAL = {"eps_prox": 1e-4, "eta_prox": 1e-13}


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem; once more with proximal iterations if that fails."""
    start = perf_counter()
    solution = run_qpsolvers("daqp", problem, settings)
    met = None if solution.found else limit_met("daqp", settings, perf_counter() - start)
    if solution.found or met is not None or "eps_prox" in settings:
        return read_answer(solution, suspicion=met)
    solution = run_qpsolvers("daqp", problem, {**settings, **_PROXIMAL})
    met = None if solution.found else limit_met("daqp", settings, perf_counter() - start)
    return read_answer(solution, message="proximal iterations", suspicion=met)
