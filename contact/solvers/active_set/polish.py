"""Exact answer from an approximate one: solve on the active set that it shows.

Interior-point and first-order methods leave forces with six to nine digits, but they nearly always tell the touching
segments from the open ones. One linear system on that set, and a few exchanges if a sign comes out wrong, then give
all digits.
"""

from __future__ import annotations

import math

import numpy as np

from ...problem.answer import Answer, unscaled
from ...problem.certificate import EXACT_TOLERANCE
from ...problem.contact_problem import ContactProblem
from ...problem.scaled_problem import ScaledProblem
from ..scaled_answer import ScaledAnswer
from .primal_dual_active_set import primal_dual_active_set

#: Linear systems a polish may solve. A poor answer must stay visible as such, not be replaced by a solve from scratch.
MAX_POLISH_ITERATIONS = 10


def exact_answer(problem: ScaledProblem, answer: ScaledAnswer) -> ScaledAnswer | None:
    """Make an approximate answer exact.

    Parameters
    ----------
    problem
        The scaled problem.
    answer
        Forces and rotation, approximately right.

    Returns
    -------
    ScaledAnswer or None
        None if the active set could not be settled in a few steps.
    """
    gap = problem.compliance @ answer.force + problem.separation - answer.rotation * problem.lever_arm
    return primal_dual_active_set(problem, answer.force > gap, max_iterations=MAX_POLISH_ITERATIONS)


def polished_answer(
    problem: ContactProblem, scaled: ScaledProblem, answer: ScaledAnswer, *, polish: bool
) -> tuple[Answer, bool]:
    """Return an answer in the units of the problem with its certificate, and whether it was made exact.

    Parameters
    ----------
    problem
        The contact problem.
    scaled
        The same, scaled.
    answer
        Answer of a solver, scaled.
    polish
        Make it exact, if that succeeds. Numbers that are not finite show no active set.
    """
    if polish and math.isfinite(answer.rotation) and np.isfinite(answer.force).all():
        exact = exact_answer(scaled, answer)
        if exact is not None:
            better = unscaled(problem, exact.force, exact.rotation)
            if better.certificate.passes(EXACT_TOLERANCE):
                return better, True
    return unscaled(problem, answer.force, answer.rotation), False
