"""Many problems at once: the native solver on arrays of problems, every answer certified as by `solve`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...core.errors import InputError
from ..problem.contact_problem import ContactProblem
from ..problem.scaled_problem import ScaledProblem
from .modal_newton import has_modal_form, modal_newton
from .registry import ROUNDING_LEVEL, as_mask, judged_native, solve
from .solution import ContactSolution

#: Problems of a batch are padded to one size, so that only those of like size go together; and in numbers that fit the
#: processor's cache.
BATCH_SIZE = 64


def solve_many(
    problems: Sequence[ContactProblem], *, initial_active: Sequence[ArrayLike | None] | None = None
) -> list[ContactSolution]:
    """Solve contact problems with the native solver, many at once.

    Parameters
    ----------
    problems
        Of any size and form. Structured ones are solved together by the modal method, which is much faster; the
        others, and what it cannot prove, one by one.
    initial_active
        Warm start of each problem, see `solve`.

    Returns
    -------
    list of ContactSolution
        In the order of the problems; what `solve` gives for each, up to rounding.

    Raises
    ------
    InputError
        As many warm starts as problems were not given, or one has the wrong shape.

    Examples
    --------
    >>> import numpy as np
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, (np.full(2, 1e-6), np.zeros((2, 1))))
    >>> [solution.force[0].item() for solution in solve_many([springs, springs.with_torque(4.0e4)])]
    [1000.0, 500.0]
    """
    starts: Sequence[ArrayLike | None] = [None] * len(problems) if initial_active is None else initial_active
    if len(starts) != len(problems):
        raise InputError(f"initial_active = {len(starts)} sets: must be {len(problems)}, one a problem")
    known = [None if start is None else as_mask(start, p.size) for p, start in zip(problems, starts, strict=True)]
    together = [(number, scaled) for number, scaled in enumerate(map(_scaled, problems)) if scaled is not None]
    together.sort(key=lambda item: item[1].separation.size)
    found: dict[int, ContactSolution] = {}
    for first in range(0, len(together), BATCH_SIZE):
        found |= _solve_batch(problems, together[first : first + BATCH_SIZE], known)
    return [
        found[number] if number in found else solve(problem, initial_active=active)
        for number, (problem, active) in enumerate(zip(problems, known, strict=True))
    ]


def _scaled(problem: ContactProblem) -> ScaledProblem | None:
    """Scale a problem that the batch can take."""
    if not problem.is_structured or problem.torque == 0.0:
        return None
    scaled = problem.scaled()
    return scaled if scaled.is_finite and has_modal_form(scaled) else None


def _solve_batch(
    problems: Sequence[ContactProblem],
    chosen: Sequence[tuple[int, ScaledProblem]],
    known: Sequence[NDArray[np.bool_] | None],
) -> dict[int, ContactSolution]:
    """Return the certified answers among the chosen problems, by their number."""
    start = perf_counter()
    active = [problems[n].scaling.estimated_active if (mask := known[n]) is None else mask for n, _ in chosen]
    answers = modal_newton([scaled for _, scaled in chosen], active)
    found = {}
    for (number, _), answer in zip(chosen, answers, strict=True):
        if answer is not None:
            solution = judged_native(problems[number], "modal", answer)
            if solution.certificate.worst <= ROUNDING_LEVEL:
                found[number] = solution
    share = (perf_counter() - start) / len(chosen)
    return {number: replace(solution, run_time=share) for number, solution in found.items()}
