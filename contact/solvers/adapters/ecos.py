"""Adapter of ECOS, an interior-point solver for cones (Domahidi et al. 2013, doi 10.23919/ECC.2013.6669541).

The energy becomes a second-order cone. Its value is resolved to rounding, the forces thus to the root of that.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...problem.scaled_problem import ScaledProblem
from ..backend import read_answer, run_qpsolvers
from ..scaled_answer import ScaledAnswer
from ..solution import Status

#: Exit flags; those from 10 on have the same meanings, for an answer that misses the tolerances.
_SUSPICIONS = {
    1: Status.INFEASIBLE,
    2: Status.UNBOUNDED,
    11: Status.INFEASIBLE,
    12: Status.UNBOUNDED,
    -1: Status.NOT_CONVERGED,
}


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem."""
    solution = run_qpsolvers("ecos", problem, settings)
    info = solution.extras
    return read_answer(
        solution,
        iterations=int(info["iter"]),
        message=str(info["infostring"]),
        suspicion=_SUSPICIONS.get(int(info["exitFlag"])),
    )
