"""Primal-dual active set, also called block principal pivoting: the first method for small problems.

Assume which segments touch, solve the linear system, then move every segment with a wrong sign at once: out of the set
where the force is negative, into it where the gap is. This is Newton's method on the complementarity conditions and
ends, mostly after two to five solves, when no sign is wrong; the answer is then exact up to rounding. It can cycle
where C is nearly singular. After a few steps without progress single segments move, always the last one of the wrong
sign (Murty 1974; Kostreva 1978; Judice and Pires 1994). Where C is singular on the set, progress must go on: the primal
active set does better.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...problem.scaled_problem import ScaledProblem
from ..scaled_answer import ScaledAnswer
from ..solver_limits import StepBudget
from .active_set_system import first_contact_index, solve_active_set

#: Steps without fewer wrong signs before segments move one at a time.
MAX_STALLED_STEPS = 4
#: A wrong sign below this, relative to the largest force or gap term, is rounding.
SIGN_TOLERANCE = 1e-14
#: The same once single segments move.
RELAXED_SIGN_TOLERANCE = 1e-11


class SolvedSet(Protocol):
    """Forces, rotation and gaps of an active set, as `ActiveSetPoint` has them."""

    index: NDArray[np.intp]
    force: NDArray[np.float64]
    rotation: float
    gap: NDArray[np.float64]

    @property
    def shifted(self) -> bool:
        """Whether the block of the active segments is singular to rounding."""

    def refine(self) -> None:
        """Take one step of iterative refinement."""


def primal_dual_active_set(
    problem: ScaledProblem,
    active: NDArray[np.bool_],
    *,
    max_iterations: int | None = None,
    solve_set: Callable[[NDArray[np.intp]], SolvedSet | None] | None = None,
    budget: StepBudget | None = None,
) -> ScaledAnswer | None:
    """Solve the scaled problem from a starting set.

    Parameters
    ----------
    problem
        The scaled problem.
    active
        Segments assumed in contact (n).
    max_iterations
        Linear systems solved before giving up, 40 + n by default.
    solve_set
        Solves the system of active segments (a); by default with the matrix C.
    budget
        Limits of the whole solve.

    Returns
    -------
    ScaledAnswer or None
        None if it did not end.
    """
    active = active.copy()
    limit = 40 + active.size if max_iterations is None else max_iterations
    fewest, patience = active.size + 1, MAX_STALLED_STEPS
    tolerance = SIGN_TOLERANCE
    for iteration in range(1, limit + 1):
        if budget is not None and not budget.step():
            return None
        index = np.flatnonzero(active)
        if not problem.lever_arm[index].any():
            active[first_contact_index(problem)] = True
            index = np.flatnonzero(active)
        point: SolvedSet | None = solve_active_set(problem, index) if solve_set is None else solve_set(index)
        if point is None:
            return None
        wrong = _wrong_signs(problem, point, active, tolerance)
        if not wrong.size:
            point.refine()
            wrong = _wrong_signs(problem, point, active, max(tolerance, 10.0 * SIGN_TOLERANCE))
            if not wrong.size:
                return answer_of(point, active.size, iteration)
        if wrong.size < fewest:
            fewest, patience = wrong.size, MAX_STALLED_STEPS
        elif point.shifted:
            return None
        elif patience > 0:
            patience -= 1
        else:
            tolerance = RELAXED_SIGN_TOLERANCE
            wrong = wrong[-1:]
        active[wrong] ^= True
    return None


def _wrong_signs(
    problem: ScaledProblem, point: SolvedSet, active: NDArray[np.bool_], tolerance: float
) -> NDArray[np.intp]:
    """Segments that pull or penetrate."""
    force, gap = point.force, point.gap
    force_level = tolerance * max(float(force.max()), -float(force.min()))
    gap_level = tolerance * (abs(point.rotation) + float(np.abs(problem.separation[point.index]).max()))
    # On the active set the gap is rounding; there the sign of the force decides.
    wrong = gap < -gap_level
    wrong[point.index] = force < -force_level
    return np.flatnonzero(wrong)


def answer_of(point: SolvedSet, size: int, iterations: int) -> ScaledAnswer:
    """Forces of all segments from those of the active set; what is negative there is rounding."""
    force = np.zeros(size)
    force[point.index] = np.maximum(point.force, 0.0)
    return ScaledAnswer(force, point.rotation, iterations)
