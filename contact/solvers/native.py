"""The native solver: a cascade of methods, the fast one first, with every answer certified.

1. Newton's method in the space of bending modes, if the compliance is diagonal plus low rank, from the warm start or
   from the Winkler estimate.
2. Primal-dual active set, from the same start. It comes first where as many modes were given as segments, in blocks of
   more than half of these: to find few among them costs more than the solution.
3. Primal active set, which cannot cycle; where the compliance is nearly singular, after compliances that are less so.

Where the compliance is known by its products alone: projected conjugate gradients (I. A. Polonsky, L. M. Keer, Wear 231
(1999) 206-219, doi 10.1016/S0043-1648(99)00113-1, with lever arms r in place of ones, and with directions in balance,
so that forces need no correction unless some were cut off). In each step the gaps of the segments in contact are the
gradient; less their part along r they keep the balance r'F = T. Along conjugate directions of these the energy falls to
its minimum on the line; forces that become negative are set to zero, and segments that the bodies penetrate join. As
long as segments join or leave, the direction starts anew; once they no longer do, the method is that of conjugate
gradients and converges as these do.

The cascade ends at the first answer whose certificate is at rounding level; otherwise the best one is judged. Limits of
time and steps hold for all methods together.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ...core.arrays import Bools, RealArray as Array
from ...core.checks import one_of
from ...core.errors import InputError
from ..problem.scaled_problem import ScaledProblem
from .compiled.compiled_answer import scaled_answer
from .polish import exact_answer
from .primal_dual_active_set import primal_active_set, primal_dual_active_set
from .solution import ScaledAnswer, Status
from .solver_limits import UNLIMITED, StepBudget

#: Gap of a segment in contact, over the mean deflection, at which the method ends.
GAP_TOLERANCE = 1e-11
#: Steps, over the root of the number of segments, after which it gives up; and their least number.
STEP_LIMIT_FACTOR, LEAST_STEP_LIMIT = 20.0, 2000
#: Steps after which deflections that were added up are computed anew.
RENEWAL_INTERVAL = 50


def projected_conjugate_gradients(problem: ScaledProblem, active: Bools, budget: StepBudget) -> ScaledAnswer | None:
    """Solve a scaled contact problem by products with its compliance; None without torque."""
    arm, separation, torque = problem.lever_arm, problem.separation, problem.torque
    if not torque > 0.0:
        return None
    start = active & (arm > 0.0)
    if not start.any():
        start = (arm > 0.0) & (separation <= separation[arm > 0.0].min())
    force = np.where(start, torque / float(arm @ start), 0.0)
    deflection, renewed = problem.deflection(force), 0
    direction, squared, before = np.zeros_like(force), 0.0, np.zeros(force.size, dtype=np.bool_)
    limit = max(int(STEP_LIMIT_FACTOR * math.sqrt(force.size)), LEAST_STEP_LIMIT)
    message = f"no convergence in {limit} steps"
    suspicion: Status | None = Status.NOT_CONVERGED
    for step in range(limit + 1):
        loaded = force > 0.0
        rotation, gap = _gaps(deflection + separation, arm, loaded)
        scale = float(force @ deflection) / float(force.sum())
        if _settled(gap, loaded, scale):
            if renewed == step:
                message, suspicion = "converged", None
                break
            deflection, renewed = problem.deflection(force), step
            rotation, gap = _gaps(deflection + separation, arm, loaded)
            if _settled(gap, loaded, scale):
                message, suspicion = "converged", None
                break
        if not budget.step():
            message, suspicion = "ended at a limit", budget.met or Status.NOT_CONVERGED
            break
        free = loaded | (gap < -GAP_TOLERANCE * scale)
        gradient = np.where(free, gap, 0.0)
        free_arm = np.where(free, arm, 0.0)
        gradient -= (float(free_arm @ gradient) / float(free_arm @ free_arm)) * free_arm
        length = float(gradient @ gradient)
        same = squared > 0.0 and np.array_equal(free, before)
        direction = gradient + (length / squared) * direction if same else gradient
        squared, before = length, free
        product = problem.deflection(direction)
        curvature = float(direction @ product)
        if not curvature > 0.0:
            message = "no more descent"
            break
        width = float(gradient @ direction) / curvature
        force = force - width * direction
        cut = force < 0.0
        if cut.any():
            force = _balanced(np.where(cut, 0.0, force), arm, torque)
            deflection, renewed, squared = problem.deflection(force), step + 1, 0.0
        elif step + 1 - renewed >= RENEWAL_INTERVAL:
            deflection, renewed = problem.deflection(force), step + 1
        else:
            deflection = deflection - width * product
    return ScaledAnswer(force, rotation, step, message, suspicion)


def _balanced(force: Array, arm: Array, torque: float) -> Array:
    """Forces that are not negative, in balance with the torque again."""
    moment = float(arm @ force)
    if moment > 0.5 * torque:
        return force * (torque / moment)
    # Where lever arms have both signs, what is left may have no moment at all.
    closing = np.where(force > 0.0, np.maximum(arm, 0.0), 0.0)
    if not closing.any():
        closing = np.maximum(arm, 0.0)
    return force + ((torque - moment) / float(closing @ closing)) * closing


def _gaps(rigid: Array, arm: Array, loaded: Bools) -> tuple[float, Array]:
    """Rotation at which the gaps of the loaded segments vanish in the mean, weighted by arms, and all gaps there."""
    loaded_arm = np.where(loaded, arm, 0.0)
    rotation = float(loaded_arm @ rigid) / float(loaded_arm @ loaded_arm)
    return rotation, rigid - rotation * arm


def _settled(gap: Array, loaded: Bools, scale: float) -> bool:
    """True if the loaded segments touch and no other is penetrated."""
    return max(float(np.abs(gap[loaded]).max()), -float(gap.min())) <= GAP_TOLERANCE * scale


Answers = Iterator[ScaledAnswer | None]


def _modal(problem: ScaledProblem, active: Bools, budget: StepBudget) -> ScaledAnswer | None:
    if not budget.step():
        return None
    answer = scaled_answer(problem, active)
    if answer is None or not all(budget.step() for _ in range(answer[2] - 1)):
        return None
    return ScaledAnswer(*answer, "modal")


def _regularised(problem: ScaledProblem, active: Bools, budget: StepBudget, near: ScaledAnswer | None) -> Answers:
    """Answers near a singular compliance, where updated inverses lose digits: one better than the next.

    The segments in contact of the answer before, solved for anew; then compliances with an addition to the diagonal,
    smaller each time, from the forces of the one before. The addition acts on the change of the forces alone (proximal
    points, Rockafellar 1976, doi 10.1137/0314056): where they no longer change, the answer is that of the compliance as
    given.
    """
    if near is not None:
        yield exact_answer(problem, near, exchanges=0)
    diagonal, force = problem.compliance.diagonal(), np.zeros(active.size)
    for share in SHARES:
        added = share * diagonal
        other = replace(
            problem,
            given_compliance=problem.compliance + np.diag(added),
            separation=problem.separation - added * force,
        )
        start = force > 0.0 if force.any() else active
        answer = primal_dual_active_set(other, start, budget, max_iterations=SHARE_STEPS)
        answer = answer or primal_active_set(other, start, budget, force=force)
        if answer is None:
            return
        force = answer.force
        if share == SHARES[-1]:
            yield answer
            yield exact_answer(problem, answer, exchanges=0)


#: Methods by name, in the order of the cascade: in words, for messages, and as a function.
METHODS: dict[str, tuple[str, Callable[[ScaledProblem, Bools, StepBudget], ScaledAnswer | None]]] = {
    "modal": ("Newton's method in the space of the modes", _modal),
    "primal_dual_active_set": ("primal-dual active set", primal_dual_active_set),
    "primal_active_set": ("primal active set", primal_active_set),
    "projected_conjugate_gradients": ("projected conjugate gradients", projected_conjugate_gradients),
}
#: Shares of the diagonal that are added to a nearly singular compliance, the last several times for what is then left,
#: and steps of the primal-dual method at each: where it cycles, the primal one goes on.
SHARES = (1e-2, 1e-4, *(10.0**-power for power in range(5, 10)), *[1e-10] * 5)
SHARE_STEPS = 30


def answers(
    problem: ScaledProblem, active: Bools, settings: dict[str, Any], budget: StepBudget = UNLIMITED
) -> Iterator[tuple[str, ScaledAnswer]]:
    """Yield methods and their answers in turn; the caller stops at the first it accepts.

    The setting ``method`` names a single method instead of the cascade; ``active`` (n) are assumed in contact.
    """
    settings = dict(settings)
    chosen = settings.pop("method", "cascade")
    if settings:
        raise InputError(f"settings = {', '.join(sorted(settings))}: must be method, the only one of native")
    one_of("method", chosen, ("cascade", *METHODS))
    for method in _cascade(problem) if chosen == "cascade" else (chosen,):
        if budget.met is not None:
            return
        if (answer := METHODS[method][1](problem, active, budget)) is not None:
            yield method, answer
        if method == "primal_active_set" and budget.met is None:
            for better in filter(None, _regularised(problem, active, budget, answer)):
                yield method, better


def _cascade(problem: ScaledProblem) -> tuple[str, ...]:
    modal, dense, *others, products = METHODS
    if not problem.has_matrix:
        return (products,)
    if problem.modal is None:
        return (dense, *others)
    return (modal, dense, *others) if problem.modal.compliance.has_few_modes else (dense, modal, *others)
