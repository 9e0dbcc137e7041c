"""Primal active set: always feasible, the energy falls at every step, so it cannot cycle.

The forces stay nonnegative and in equilibrium. On the loaded segments the energy is minimised; if a force would turn
negative, the step stops there and that segment is released. At a minimum, the segment that penetrates most is loaded.
The pattern is that of Lawson and Hanson (1974, chapter 23) for nonnegative least squares. Slower than moving many
segments at once, and needed only where that fails.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...problem.scaled_problem import ScaledProblem
from ..scaled_answer import ScaledAnswer
from ..solver_limits import StepBudget
from .active_set_system import first_contact_index, solve_active_set

#: A penetration below this, relative to the largest term of the gap, is rounding.
GAP_TOLERANCE = 1e-13


def primal_active_set(
    problem: ScaledProblem,
    start: NDArray[np.bool_] | None = None,
    *,
    max_iterations: int | None = None,
    budget: StepBudget | None = None,
) -> ScaledAnswer | None:
    """Solve the scaled problem, with positive torque, by feasible descent.

    Parameters
    ----------
    problem
        The scaled problem.
    start
        Segments loaded at the start, equally (n); only those with a positive lever arm are taken.
    max_iterations
        Linear systems solved before giving up, 20 + 5 n by default.
    budget
        Limits of the whole solve.

    Returns
    -------
    ScaledAnswer or None
        None if it did not end or a system could not be solved.
    """
    size = problem.lever_arm.size
    force = _feasible_start(problem, start)
    loaded = force > 0.0
    refused = np.zeros(size, dtype=bool)
    newest = -1
    for iteration in range(1, (20 + 5 * size if max_iterations is None else max_iterations) + 1):
        if budget is not None and not budget.step():
            return None
        index = np.flatnonzero(loaded)
        point = solve_active_set(problem, index)
        if point is None:
            return None
        point.refine()
        current = force[index]
        blocking = point.force <= 0.0
        if newest >= 0 and point.force[index == newest][0] <= 0.0:
            # Rounding said that loading this segment would lower the energy; it does not.
            loaded[newest] = False
            refused[newest] = True
            newest = -1
            continue
        newest = -1
        if blocking.any():
            ratios = current[blocking] / (current[blocking] - point.force[blocking])
            step = float(ratios.min())
            moved = current + step * (point.force - current)
            moved[np.flatnonzero(blocking)[ratios <= step]] = 0.0
            force[index] = np.maximum(moved, 0.0)
            loaded = force > 0.0
            continue
        force[:] = 0.0
        force[index] = point.force
        gap = np.where(loaded | refused, 0.0, point.gap)
        level = GAP_TOLERANCE * (abs(point.rotation) + float(np.abs(problem.separation[index]).max()))
        candidate = int(gap.argmin())
        if gap[candidate] >= -level:
            return ScaledAnswer(force, point.rotation, iteration)
        loaded[candidate] = True
        refused[:] = False
        newest = candidate
    return None


def _feasible_start(problem: ScaledProblem, start: NDArray[np.bool_] | None) -> NDArray[np.float64]:
    loaded = np.zeros(problem.lever_arm.size, dtype=bool)
    if start is not None:
        loaded |= start & (problem.lever_arm > 0.0)
    if not loaded.any():
        loaded[first_contact_index(problem)] = True
    force = np.where(loaded, 1.0, 0.0)
    return force * (problem.torque / float(force @ problem.lever_arm))
