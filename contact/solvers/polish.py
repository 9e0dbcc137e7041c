"""Exact answer from an approximate one: solve on the active set that it shows.

Interior-point and first-order methods leave forces with six to nine digits, but they nearly always tell the touching
segments from the open ones. One linear system on that set gives all digits; if a sign comes out wrong, a few exchanges
of segments may follow, which are steps of our own active-set method: a comparison of solvers allows none. Where the
compliance is diag(d) + V V^T, the matrix is never formed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from ...core.arrays import Integers
from ..problem.certificate import EXACT_TOLERANCE, Answer, unscaled
from ..problem.contact_problem import ContactProblem
from ..problem.scaled_problem import ScaledProblem
from .primal_dual_active_set import answer_of, primal_dual_active_set
from .solution import ScaledAnswer
from .touching_system import ActiveSetPoint, ModalProblem, solve_active_set, solve_modal_active_set

#: Exchanges of segments that a polish may make. A poor answer must stay visible as such, not be replaced by a solve
#: from scratch.
MAX_EXCHANGES = 9


@dataclass(frozen=True)
class PolishRule:
    """Limits of a polish; without exchanges an answer with a wrong active set stays as it is."""

    exchanges: int = MAX_EXCHANGES
    roughest: float = math.inf  # certificate up to which an answer is polished


#: Polish in a comparison: the active set was right or it was not, and the answer was at least roughly right. Without
#: the second condition whoever says that every segment touches would be right wherever that is so.
STRICT_POLISH = PolishRule(exchanges=0, roughest=1e-3)


@dataclass(frozen=True, eq=False, slots=True)
class Polish:
    """Result of a polish: the answer, exact or as the solver gave it, in the units of the problem."""

    answer: Answer
    polished: bool
    exchanges: int


def polished_answer(
    problem: ContactProblem, scaled: ScaledProblem, answer: ScaledAnswer, rule: PolishRule | None
) -> Polish:
    """Answer in the units of the problem with its certificate, exact where the rule lets it be made so."""
    if rule is None or not (math.isfinite(answer.rotation) and np.isfinite(answer.force).all()):
        return Polish(unscaled(problem, answer.force, answer.rotation), False, 0)
    if math.isfinite(rule.roughest):
        original = unscaled(problem, answer.force, answer.rotation)
        if not original.certificate.passes(rule.roughest):
            return Polish(original, False, 0)
    if (exact := exact_answer(scaled, answer, rule.exchanges)) is not None:
        better = unscaled(problem, exact.force, exact.rotation)
        if better.certificate.passes(EXACT_TOLERANCE):
            return Polish(better, True, exact.iterations - 1)
    return Polish(unscaled(problem, answer.force, answer.rotation), False, 0)


def exact_answer(problem: ScaledProblem, answer: ScaledAnswer, exchanges: int = MAX_EXCHANGES) -> ScaledAnswer | None:
    """Make an approximate answer exact; None if a system has no solution or the active set does not settle.

    Without exchanges negative forces are set to zero: the certificate tells whether they were more than rounding. Its
    iterations are the linear systems solved.
    """
    modal = ModalProblem.of(problem)
    solve_set: Callable[[Integers], ActiveSetPoint | None]
    solve_set = partial(solve_active_set, problem) if modal is None else partial(solve_modal_active_set, modal)
    gap = problem.deflection(answer.force) + problem.separation - answer.rotation * problem.lever_arm
    active = answer.force > gap
    if exchanges > 0:
        return primal_dual_active_set(problem, active, max_iterations=exchanges + 1, solve_set=solve_set)
    index = np.flatnonzero(active)
    point = solve_set(index) if problem.lever_arm[index].any() else None
    if point is None:
        return None
    point.refine()
    return answer_of(point, active.size, 1)
