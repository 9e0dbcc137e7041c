"""Adapter of quadprog, the dense dual active-set method of Goldfarb and Idnani (1983, doi 10.1007/BF02591962).

It begins with the Cholesky factor of the matrix: where that is singular to rounding, the answers may be wrong.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...problem.scaled_problem import ScaledProblem
from ..backend import read_answer, run_qpsolvers
from ..scaled_answer import ScaledAnswer


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem."""
    solution = run_qpsolvers("quadprog", problem, settings)
    iterations = solution.extras.get("iterations", (-1,))[0]  # constraints added; the second number is those dropped
    return read_answer(solution, iterations=int(iterations))
