"""The native solver: a cascade of methods, the fast one first, with every answer certified.

1. Newton's method in the space of bending modes, if the compliance is diagonal plus low rank, from the warm start or
   from the Winkler estimate.
2. Primal-dual active set, from the same start. It comes first where as many modes were given as segments, in blocks of
   more than half of these: to find few among them costs more than the solution.
3. Primal active set, which cannot cycle; where the compliance is nearly singular, after compliances that are less so.

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
