"""Many problems at once: the native solver on arrays of problems, every answer certified as by `solve`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...core.errors import InputError
from ..problem.certificate import EXACT_TOLERANCE
from ..problem.contact_problem import ContactProblem
from ..problem.recovered import recovered
from ..problem.scaling import ScaledProblem
from .judge import judge_scaled
from .modal_batch import LinearLaw, ModalBatch, newton_batch
from .modal_newton import compiled_kernel
from .modal_system import has_modal_form
from .registry import ROUNDING_LEVEL, as_mask, solve
from .scaled_answer import ScaledAnswer
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
    problems : sequence of ContactProblem
        Of any size and form. Structured ones are solved together, which is much faster where numba is not installed;
        the others, and what the method for many cannot prove, one by one.
    initial_active : sequence, optional
        Warm start of each problem, see `solve`.

    Returns
    -------
    list of ContactSolution
        In the order of the problems; what `solve` gives for each, up to rounding.

    Raises
    ------
    InputError
        As many warm starts as problems were not given, or one has the wrong shape.
    """
    starts: Sequence[ArrayLike | None] = [None] * len(problems) if initial_active is None else initial_active
    if len(starts) != len(problems):
        raise InputError(f"initial_active has {len(starts)} entries for {len(problems)} problems")
    known = [None if start is None else as_mask(start, p.size) for p, start in zip(problems, starts, strict=True)]
    found: dict[int, ContactSolution] = {}
    if compiled_kernel() is None:
        together = [(number, scaled) for number, scaled in enumerate(map(_scaled, problems)) if scaled is not None]
        together.sort(key=lambda item: item[1].separation.size)
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
    scaled = problem.scaling.scale(problem)
    return scaled if scaled.is_finite and has_modal_form(scaled) else None


def _solve_batch(
    problems: Sequence[ContactProblem],
    chosen: Sequence[tuple[int, ScaledProblem]],
    known: Sequence[NDArray[np.bool_] | None],
) -> dict[int, ContactSolution]:
    """Return the certified answers among the chosen problems, by their number."""
    numbers, own = [number for number, _ in chosen], [scaled for _, scaled in chosen]
    pairs = [scaled.pair for scaled in own if scaled.pair is not None]
    batch = ModalBatch.of(
        [replace(pair.modal_basis, modes=pair.mode_unit * pair.modal_basis.modes) for pair in pairs],
        [item.lever_arm for item in own],
        [item.separation for item in own],
        np.array([item.torque for item in own]),
    )
    local = [pair.diagonal for pair in pairs]
    forces = [_even(item, known[n], problems[n]) for n, item in chosen]
    start = batch.start(
        batch.in_blocks(forces, 0.0), batch.in_blocks([d * f for d, f in zip(local, forces, strict=True)], 0.0)
    )
    answer = newton_batch(batch, LinearLaw(batch.in_blocks([1.0 / d for d in local], 0.0)), *start)
    found = {}
    for i, force in enumerate(batch.by_segments(answer.force)):
        if answer.ended[i]:
            given = ScaledAnswer(force, float(answer.rotation[i]), int(answer.iterations[i]), "modal, many at once")
            result = recovered(problems[numbers[i]], given.force, given.rotation)
            solution = judge_scaled("native", given, result, EXACT_TOLERANCE)
            if solution.certificate.worst <= ROUNDING_LEVEL:
                found[numbers[i]] = solution
    return found


def _even(scaled: ScaledProblem, active: NDArray[np.bool_] | None, problem: ContactProblem) -> NDArray[np.float64]:
    """Even forces (n) that balance the torque, on the segments thought to touch."""
    force = (problem.scaling.estimated_active if active is None else active) * (scaled.lever_arm > 0.0)
    if not force.any():
        force = scaled.lever_arm > 0.0
    return np.asarray(force * (scaled.torque / float(force @ scaled.lever_arm)), dtype=np.float64)
