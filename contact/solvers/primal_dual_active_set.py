"""Active sets: primal-dual, the first method for small problems, and primal, where that cycles.

The primal-dual one is also called block principal pivoting. Assume which segments touch, solve the linear system, then
move every segment with a wrong sign at once: out of the set where the force is negative, into it where the gap is. This
is Newton's method on the complementarity conditions and ends, mostly after two to five solves, when no sign is wrong;
the answer is then exact up to rounding. It can cycle where C is nearly singular. After a few steps without progress
single segments move, always the last one of the wrong sign (Murty 1974; Kostreva 1978; Judice and Pires 1994). Where C
is singular on the set, progress must go on: the primal active set does better.

The primal one is always feasible, and its energy never rises. The forces stay nonnegative and in equilibrium. On the
touching segments the energy is minimised; if a force would turn negative, the step stops there and that segment is
released. At a minimum, the segment that penetrates most enters. The pattern is that of Lawson and Hanson (1974, chapter
23) for nonnegative least squares. Where the forces of the touching segments would not be unique with another one,
loading that one changes nothing but the forces of the others, at no cost: it enters in place of the first whose force
vanishes, as in the simplex method. The system of the touching segments is kept up to date from step to step
(`DenseTouching`): O(n a) a step for a touching segments.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...core.arrays import Bools, Integers, RealArray as Array
from ..problem.scaled_problem import ScaledProblem
from .solution import ScaledAnswer
from .solver_limits import UNLIMITED, StepBudget
from .touching_system import ActiveSetPoint, DenseTouching, TouchingFactor, first_contact_index, solve_active_set

#: Steps without fewer wrong signs before segments move one at a time.
MAX_STALLED_STEPS = 4
#: Single moves of large problems.
MAX_SINGLE_MOVES = 100
#: A wrong sign below this, relative to the largest force or gap term, is rounding.
SIGN_TOLERANCE = 1e-14
#: The same once single segments move.
RELAXED_SIGN_TOLERANCE = 1e-11


def primal_dual_active_set(
    problem: ScaledProblem,
    active: Bools,
    budget: StepBudget = UNLIMITED,
    *,
    max_iterations: int | None = None,
    solve_set: Callable[[Integers], ActiveSetPoint | None] | None = None,
) -> ScaledAnswer | None:
    """Solve the scaled problem from a starting set (n); None if it did not end.

    Iterations are linear systems, 40 + n at most by default, or 140: where that many single moves do not help, C is
    nearly singular. They are of C unless ``solve_set`` solves them.
    """
    active = active.copy()
    limit = 40 + min(active.size, MAX_SINGLE_MOVES) if max_iterations is None else max_iterations
    fewest, patience = active.size + 1, MAX_STALLED_STEPS
    tolerance = SIGN_TOLERANCE
    for iteration in range(1, limit + 1):
        if not budget.step():
            return None
        index = np.flatnonzero(active)
        if not problem.lever_arm[index].any():
            active[first_contact_index(problem)] = True
            index = np.flatnonzero(active)
        point = solve_active_set(problem, index) if solve_set is None else solve_set(index)
        if point is None:
            return None
        wrong = _wrong_signs(problem, point, tolerance)
        if not wrong.size:
            point.refine()
            wrong = _wrong_signs(problem, point, max(tolerance, 10.0 * SIGN_TOLERANCE))
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


def _wrong_signs(problem: ScaledProblem, point: ActiveSetPoint, tolerance: float) -> Integers:
    """Segments that pull or penetrate."""
    force, gap = point.force, point.gap
    force_level = tolerance * max(float(force.max()), -float(force.min()))
    gap_level = tolerance * (abs(point.rotation) + float(np.abs(problem.separation[point.index]).max()))
    # On the active set the gap is rounding; there the sign of the force decides.
    wrong = gap < -gap_level
    wrong[point.index] = force < -force_level
    return np.flatnonzero(wrong)


def answer_of(point: ActiveSetPoint, size: int, iterations: int) -> ScaledAnswer:
    """Forces of all segments from those of the active set; what is negative there is rounding."""
    force = np.zeros(size)
    force[point.index] = np.maximum(point.force, 0.0)
    return ScaledAnswer(force, point.rotation, iterations)


#: A penetration below this, relative to the largest term of the gap, is rounding; and where steps stall.
GAP_TOLERANCE, RELAXED_GAP_TOLERANCE = 1e-13, 1e-11
#: Steps without progress after which the first segment that penetrates enters, not the one that does most (Bland), and
#: the part of a step below which there is none.
STALLED_STEPS, SMALLEST_STEP = 20, 1e-12
#: Dependence tolerance where the compliance is known not to be singular.
NO_DEPENDENCE = 1e-14


def primal_active_set(
    problem: ScaledProblem, start: Bools, budget: StepBudget, force: Array | None = None
) -> ScaledAnswer | None:
    """Solve the scaled problem by feasible descent; None if it did not end, or the energy has no minimum.

    Descent begins with forces (n) that balance the torque, of a compliance that is not singular; else the start (n) is
    loaded equally, where lever arms are positive; no load without a torque. Iterations are linear systems, 20 + 2 n at
    most.
    """
    size, closing, torque = problem.lever_arm.size, -problem.separation, problem.torque
    root = np.sqrt(problem.compliance.diagonal())
    system, force = _start(problem, start, force)
    refused = np.zeros(size, dtype=np.bool_)
    newest, stalled = -1, 0
    for iteration in range(1, 20 + 2 * size + 1):
        if not budget.step():
            return None
        wanted = system.forces(closing, torque)
        active = system.active
        if newest >= 0 and wanted[newest] <= 0.0 and system.leave(newest):
            # Rounding said that loading this segment would lower the energy; it does not.
            refused[newest], newest = True, -1
            continue
        newest = -1
        falling = active & (wanted < 0.0)
        if falling.any():
            left = np.flatnonzero(falling)
            ratio = force[left] / (force[left] - wanted[left])
            step = float(ratio.min())
            force += step * (wanted - force)
            leaving = left[ratio <= step]
            force[leaving] = 0.0
            np.maximum(force, 0.0, out=force)
            stalled = 0 if step > SMALLEST_STEP else stalled + 1
            gone = [system.leave(int(segment)) for segment in leaving]
            if not any(gone):
                return None
            continue
        force, rotation, gap = system.solve(closing[:, None], np.array([torque])).column(0)
        # Terms of a gap: rotation, separation, and deflections that may cancel each other, |C_ij| <= (C_ii C_jj)^(1/2).
        level = abs(rotation) + float(np.abs(problem.separation[active]).max()) + float(root.max() * (root @ force))
        level *= GAP_TOLERANCE if stalled < STALLED_STEPS else RELAXED_GAP_TOLERANCE
        gap[active | refused] = 0.0
        entering = int(gap.argmin()) if stalled < STALLED_STEPS else int(np.argmax(gap < -level))
        if gap[entering] >= -level:
            return ScaledAnswer(force, rotation, iteration)
        refused[:] = False
        newest = entering
        while not system.enter(entering):
            # Its load replaces that of others, and costs nothing.
            shed, newest = system.shares(entering), -1
            left = np.flatnonzero(system.active & (shed > 0.0))
            if not left.size:
                return None
            ratio = force[left] / shed[left]
            step, emptied = float(ratio.min()), int(left[ratio.argmin()])
            force -= step * shed
            force[entering] += step
            force[emptied] = 0.0
            np.maximum(force, 0.0, out=force)
            stalled = 0 if step > SMALLEST_STEP else stalled + 1
            if not system.leave(emptied):
                return None
    return None


def _start(problem: ScaledProblem, start: Bools, force: Array | None) -> tuple[DenseTouching, Array]:
    """Touching segments whose forces are unique, and these, or equal ones (n); no forces without a torque."""
    if force is not None and force.any():
        return DenseTouching(problem.compliance, problem.lever_arm, force > 0.0, NO_DEPENDENCE), force.copy()
    loaded = np.zeros(problem.lever_arm.size, dtype=np.bool_)
    if problem.torque > 0.0:
        loaded |= start & (problem.lever_arm > 0.0)
    index = np.flatnonzero(loaded)
    block, arm = problem.compliance[np.ix_(index, index)], problem.lever_arm[index]
    if not index.size or TouchingFactor.of(block, arm) is None:
        loaded[:] = False  # from one, as it is not known which of them to leave out
        loaded[first_contact_index(problem)] = True
    system = DenseTouching(problem.compliance, problem.lever_arm, loaded)
    force = np.where(system.active, 1.0, 0.0)
    return system, force * (problem.torque / float(force @ problem.lever_arm))
