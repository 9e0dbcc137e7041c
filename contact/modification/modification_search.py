"""Search for the best modification by convex programmes, each at the contact regions of the last accepted one.

A programme is exact while its contact regions hold. Where they change it promises too much or too little, so its
answer is solved afresh, and taken only if it is better; else the next programme has a smaller trust radius.

What is found is a local optimum: segments that do not touch yet show no gain. Therefore a second search begins at the
answer of the programme in which all segments are held in contact, the one of Conry and Seireg. Where the transmission
error bends with the set of touching segments, both may end beside a limit that can be kept; a detour by a tighter
limit then leads to other regions.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np

from ...core.arrays import RealArray as Array
from .convex_programme import Goal, LoadResponse, Value, judged, solve_programme

#: Least ratios of the gain to the promised one for a step to be taken, and for a larger trust radius after it.
TAKEN_GAIN_RATIO, GOOD_GAIN_RATIO = 0.1, 0.75
#: Trust radius of the first programme, and below which a search ends [um].
FIRST_TRUST_RADIUS, TRUST_RADIUS_MINIMUM = 8.0, 0.01
#: A promise below this, or in proportion within a smaller trust radius than the first, ends the search.
GAIN_TOLERANCE = 1e-4
#: Programmes that may mend a step which gained but broke a limit, and the ratio of their trust radii.
MENDING_LIMIT, MENDING_RADIUS_RATIO = 2, 0.25
#: Limits of the transmission error, over the given one, of the searches made while the given one was not kept.
TIGHTER_LIMIT_RATIOS = (0.8, 0.7, 0.6, 0.9)

Start = Literal["full_contact", "present", "tighter_limit"]
NO_VALUE = Value(np.nan, np.nan)


@dataclass(frozen=True)
class Step:
    """One programme of a search and its outcome."""

    status: str
    trust_radius: float
    promised: Value
    fresh: Value  # of the fresh solution; NaN if there was none
    accepted: bool
    mending: bool = False  # from the step before, not from the best so far
    search: Start = "present"


@dataclass(frozen=True, eq=False)
class ModificationSearch:
    """Result of a search: the best modification, its loads and value, and all programmes."""

    coefficients: Array  # (p) [um]
    loads: LoadResponse
    value: Value
    steps: tuple[Step, ...]
    converged: bool


def search(
    solved: Callable[[Array], LoadResponse | None],
    start: LoadResponse,
    goal: Goal,
    *,
    coefficients: Array | None = None,
    programmes: int = 40,
    trust_radius: float = FIRST_TRUST_RADIUS,
    progress: Callable[[], None] | None = None,
) -> ModificationSearch:
    """Improve a modification (p) [um] until no convex programme promises a gain; its merit never rises.

    ``solved`` gives certified loads at coefficients, or ``None``. If the start keeps the limits, no torque fares worse.
    """
    first = np.zeros(goal.surface.shape[1]) if coefficients is None else coefficients
    best = _Point(first, start, judged(start, goal))
    steps: list[Step] = []
    converged = False
    while len(steps) < programmes and not converged and trust_radius >= TRUST_RADIUS_MINIMUM:
        point, gain = best, 0.0
        for mending in range(1 + MENDING_LIMIT):
            span = trust_radius * MENDING_RADIUS_RATIO**mending
            answer = solve_programme(point.loads, goal, point.coefficients, span)
            if mending == 0:
                gain = best.value.merit - answer.value.merit
                converged = answer.solved and gain < GAIN_TOLERANCE * min(1.0, trust_radius / FIRST_TRUST_RADIUS)
            loads = None if converged or not answer.solved else solved(point.coefficients + answer.step)
            fresh = NO_VALUE if loads is None else judged(loads, goal)
            came_true = (best.value.merit - fresh.merit) / gain
            steps.append(Step(answer.status, span, answer.value, fresh, came_true > TAKEN_GAIN_RATIO, mending > 0))
            if progress is not None:
                progress()
            if loads is None:
                break
            point = _Point(point.coefficients + answer.step, loads, fresh)
            if came_true > TAKEN_GAIN_RATIO or fresh.violation <= best.value.violation:
                break
        if steps[-1].accepted:
            best = point
            trust_radius *= 2.0 if came_true > GOOD_GAIN_RATIO and not steps[-1].mending else 1.0
        else:
            trust_radius *= 0.25
    return ModificationSearch(best.coefficients, best.loads, best.value, tuple(steps), converged)


def optimal_modification(
    solved: Callable[[Array], LoadResponse | None],
    start: LoadResponse,
    full_contact: LoadResponse,
    goal: Goal,
    *,
    programmes: int = 40,
    progress: Callable[[], None] | None = None,
) -> ModificationSearch:
    """Search from full contact and from no modification, and keep the better end; its merit never rises.

    While neither keeps the limit of the transmission error, both search again under a tighter one, and a third begins
    at their better end. ``full_contact`` has all segments in contact by force, at coefficients of zero.
    """
    improved = partial(search, solved, programmes=programmes, progress=progress)

    def ends(aim: Goal) -> list[ModificationSearch]:
        """From the programme of full contact, if that has an answer, and from no modification."""
        whole = 2.0 * aim.largest
        answer = solve_programme(full_contact, aim, np.zeros(aim.surface.shape[1]), whole)
        loads = solved(answer.step) if answer.solved else None
        fresh = NO_VALUE if loads is None else judged(loads, aim)
        first = Step(answer.status, whole, answer.value, fresh, loads is not None, False, "full_contact")
        present = improved(start, aim)
        if loads is None:
            return [replace(present, steps=(first, *present.steps))]
        full = improved(loads, aim, coefficients=answer.step)
        named = (replace(step, search="full_contact") for step in full.steps)
        return [replace(full, steps=(first, *named)), present]

    searches = ends(goal)
    steps = [step for end in searches for step in end.steps]
    for ratio in TIGHTER_LIMIT_RATIOS if np.isfinite(goal.transmission_error) else ():
        if min(end.value.violation for end in searches) <= 0.0:
            break
        tighter = replace(goal, transmission_error=ratio * goal.transmission_error)
        detour = min(ends(tighter), key=lambda end: end.value.merit)
        back = improved(detour.loads, goal, coefficients=detour.coefficients)
        searches.append(back)
        steps += [replace(step, search="tighter_limit") for step in (*detour.steps, *back.steps)]
    return replace(min(searches, key=lambda end: end.value.merit), steps=tuple(steps))


@dataclass(frozen=True, eq=False)
class _Point:
    """A modification, solved."""

    coefficients: Array
    loads: LoadResponse
    value: Value
