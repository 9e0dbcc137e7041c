"""Projected conjugate gradients for the contact problem: only products with C are needed, never the matrix.

In each step the gaps of the segments in contact are the gradient; less their part along r they keep the balance
r'F = T. Along conjugate directions of these the energy falls to its minimum on the line; forces that become negative
are set to zero, and segments that the bodies penetrate join. As long as segments join or leave, the direction starts
anew; once they no longer do, the method is that of conjugate gradients and converges as these do.

I. A. Polonsky, L. M. Keer, Wear 231 (1999) 206-219, doi 10.1016/S0043-1648(99)00113-1, with lever arms r in place of
ones, and with directions in balance, so that forces need no correction unless some were cut off.
"""

from __future__ import annotations

import math

import numpy as np

from ...core.arrays import Bools, RealArray as Array
from ..problem.scaled_problem import ScaledProblem
from .solution import ScaledAnswer, Status
from .solver_limits import StepBudget

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
