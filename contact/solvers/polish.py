"""Exact answer from an approximate one: solve on the active set that it shows.

Interior-point and first-order methods leave forces with six to nine digits, but they nearly always tell the touching
segments from the open ones. One linear system on that set, and a few exchanges if a sign comes out wrong, then give
all digits.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..problem.certificate import EXACT_TOLERANCE
from ..problem.contact_problem import ContactProblem
from ..problem.recovered import RecoveredAnswer, recovered
from ..problem.scaling import ScaledProblem
from .primal_dual_active_set import primal_dual_active_set
from .scaled_answer import ScaledAnswer

#: Linear systems a polish may solve. A poor answer must stay visible as such, not be replaced by a solve from scratch.
POLISH_LIMIT = 10


def polish(problem: ScaledProblem, answer: ScaledAnswer, gap: NDArray[np.float64] | None = None) -> ScaledAnswer | None:
    """Make an approximate answer exact.

    Parameters
    ----------
    problem : ScaledProblem
    answer : ScaledAnswer
        Forces and rotation, approximately right.
    gap : (n) array, optional
        Bound multipliers, where known better than from forces and rotation.

    Returns
    -------
    ScaledAnswer or None
        None if the active set could not be settled in a few steps.
    """
    if gap is None:
        gap = problem.compliance @ answer.force + problem.separation - answer.rotation * problem.lever_arm
    return primal_dual_active_set(problem, answer.force > gap, max_iterations=POLISH_LIMIT)


def recover_answer(
    problem: ContactProblem, scaled: ScaledProblem, answer: ScaledAnswer, *, polished: bool
) -> tuple[RecoveredAnswer, bool]:
    """Return an answer in the units of the problem with its certificate, and whether it was made exact.

    Parameters
    ----------
    problem : ContactProblem
    scaled : ScaledProblem
        The same, scaled.
    answer : ScaledAnswer
    polished : bool
        Make it exact, if that succeeds. Numbers that are not finite show no active set.
    """
    if polished and math.isfinite(answer.rotation) and np.isfinite(answer.force).all():
        exact = polish(scaled, answer)
        if exact is not None:
            better = recovered(problem, exact.force, exact.rotation)
            if better.certificate.passes(EXACT_TOLERANCE):
                return better, True
    return recovered(problem, answer.force, answer.rotation), False
