"""Adapter of qpmad, a dense dual active-set solver in C++ (method: Goldfarb and Idnani 1983, doi 10.1007/BF02591962).

Called directly: it factors the matrix in place, and what qpsolvers passes on may be the caller's own array, which it
then reads the multipliers from. Where the matrix is singular to rounding, the answers may be wrong.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...problem.scaled_problem import ScaledProblem
from ..backend import NoAnswerError, refuse_unknown
from ..solution import ScaledAnswer, Status


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem."""
    import pyqpmad

    parameters = pyqpmad.SolverParameters()
    refuse_unknown("pyqpmad", settings)
    for name, value in settings.items():
        setattr(parameters, name, value)
    size = problem.separation.size
    force, torque = np.zeros(size), np.array([problem.torque])
    solver, limits = pyqpmad.Solver(), (np.zeros(size), np.full(size, np.inf))
    matrix = np.array(problem.compliance, order="F")  # a copy, which is overwritten
    row = np.asfortranarray(problem.lever_arm[np.newaxis])
    status = solver.solve(force, matrix, problem.separation, *limits, row, torque, torque, parameters)
    if status != pyqpmad.ReturnStatus.OK:
        raise NoAnswerError(status.name, Status.NOT_CONVERGED)
    bounds = solver.get_inequality_dual()
    gap = np.zeros(size)
    gap[bounds.indices] = bounds.dual
    # It gives no multiplier of the balance: that of the segment under the greatest moment follows from its gap.
    loaded = int(np.argmax(force * problem.lever_arm))
    rotation = float(problem.compliance[loaded] @ force + problem.separation[loaded]) / problem.lever_arm[loaded]
    return ScaledAnswer(force, float(rotation), int(solver.get_num_iterations()), status.name, gap=gap)
