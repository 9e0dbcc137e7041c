"""The native solver: a cascade of methods, the fast one first, with every answer certified.

1. Newton's method in the space of bending modes, if the compliance is diagonal plus low rank, from the warm start or
   from the Winkler estimate.
2. Primal-dual active set, from the same start. It comes first where as many modes were given as segments, in blocks of
   more than half of these: to find few among them costs more than the solution.
3. Primal active set, which cannot cycle; where the compliance is nearly singular, its segments in contact solved for
   anew.

The cascade ends at the first answer whose certificate is at rounding level; otherwise the best one is judged. Limits of
time and steps hold for all methods together.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ...core.arrays import Bools
from ...core.checks import one_of
from ...core.errors import InputError
from ..problem.scaled_problem import ScaledProblem
from .compiled.compiled_answer import scaled_answer
from .polish import exact_answer
from .primal_dual_active_set import primal_active_set, primal_dual_active_set
from .projected_conjugate_gradients import projected_conjugate_gradients
from .solution import ScaledAnswer
from .solver_limits import UNLIMITED, StepBudget

Answers = Iterator[ScaledAnswer | None]


def _modal(problem: ScaledProblem, active: Bools, budget: StepBudget) -> ScaledAnswer | None:
    if not budget.step():
        return None
    answer = scaled_answer(problem, active)
    if answer is None or not all(budget.step() for _ in range(answer[2] - 1)):
        return None
    return ScaledAnswer(*answer, "modal")


def _anew(problem: ScaledProblem, active: Bools, budget: StepBudget, near: ScaledAnswer | None) -> Answers:
    """Answers of the primal active set whose segments in contact are solved for anew.

    Near a singular compliance its updated inverse loses digits; the touching set is then better known of a compliance
    further from singular, and solved for in the given one.
    """
    if near is not None:
        yield exact_answer(problem, near, exchanges=0)
    further = np.array(problem.compliance)
    further[np.diag_indices(further.shape[0])] *= 1.0 + DIAGONAL_SHARE
    other = replace(problem, given_compliance=further)
    near = primal_dual_active_set(other, active, budget) or primal_active_set(other, active, budget)
    if near is not None:
        yield exact_answer(problem, near)


#: Methods by name, in the order of the cascade: in words, for messages, and as a function.
METHODS: dict[str, tuple[str, Callable[[ScaledProblem, Bools, StepBudget], ScaledAnswer | None]]] = {
    "modal": ("Newton's method in the space of the modes", _modal),
    "primal_dual_active_set": ("primal-dual active set", primal_dual_active_set),
    "primal_active_set": ("primal active set", primal_active_set),
    "projected_conjugate_gradients": ("projected conjugate gradients", projected_conjugate_gradients),
}
#: By this share more of its diagonal a compliance is so far from singular that rounding seldom matters.
DIAGONAL_SHARE = 1e-10


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
        answer = METHODS[method][1](problem, active, budget)
        if answer is not None:
            yield method, answer
        if method == "primal_active_set" and budget.met is None:
            for better in filter(None, _anew(problem, active, budget, answer)):
                yield method, better


def _cascade(problem: ScaledProblem) -> tuple[str, ...]:
    modal, dense, *others, products = METHODS
    if not problem.has_matrix:
        return (products,)
    if problem.modal is None:
        return (dense, *others)
    return (modal, dense, *others) if problem.modal.compliance.has_few_modes else (dense, modal, *others)
