"""Search by convex programmes in a trust region: steps are taken if fresh analyses confirm what was predicted.

What is judged is the merit: the objective, and the violation of the limits at a price that makes passing them never
pay (an exact penalty). Fletcher, Practical Methods of Optimization (1987), section 14.4.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import takewhile
from typing import Any, Literal, Protocol

import numpy as np

from ....core.arrays import RealArray as Array
from ....core.errors import EaseoffError
from .step_programme import VIOLATION_PRICE, LocalModel, StepAnswer, StepProgramme

Ending = Literal["converged", "steps", "no_gain"]

#: Least ratios of the gain to the predicted one for a step to be taken, and for a larger trust region after it.
TAKEN_GAIN_RATIO, FAIR_GAIN_RATIO, GOOD_GAIN_RATIO = 0.05, 0.25, 0.75
#: Of the first programme, and below which a search ends, as rounding to the machine's steps changes as much [um].
FIRST_RADIUS, RADIUS_MINIMUM, RADIUS_LIMIT = 3.0, 0.2, 40.0
#: Least of the first programme of a later search, or of one with derivatives by differences [um].
LATER_RADIUS = 0.5
#: A predicted gain below this ends the search; in proportion within a smaller trust region than the first, but no less
#: than a share of it.
GAIN_TOLERANCE, TOLERANCE_SHARE = 1e-3, 0.25
#: Programmes that may mend a step which did not gain, and the ratio of their trust regions; not one that lost more.
MENDING_LIMIT, MENDING_RADIUS_RATIO, HOPELESS_LOSS = 1, 0.35, 0.3


@dataclass(frozen=True)
class Tolerance:
    """Predicted gain below which a search ends, smaller in proportion within a small trust region."""

    gain: float = GAIN_TOLERANCE  # within a trust region like the usual first one, or larger
    share: float = TOLERANCE_SHARE

    def within(self, radius: float) -> float:
        """Within a trust region [um]."""
        return float(self.gain * np.clip(radius / FIRST_RADIUS, self.share, 1.0))


USUAL_TOLERANCE = Tolerance()


@dataclass(frozen=True)
class Merit:
    """Objective in relation to the start, and sum over the limits of the share by which each is passed."""

    objective: float
    violation: float

    @property
    def total(self) -> float:
        """Objective with the price of the violation."""
        return self.objective + VIOLATION_PRICE * self.violation


class Point(Protocol):
    """Analysed settings."""

    @property
    def settings(self) -> Array:
        """The settings (n), in units that change the ease-off by one micrometre at most."""

    @property
    def merit(self) -> Merit:
        """Objective and violation that they reach."""

    @property
    def differentiable(self) -> bool:
        """True if there is a model."""

    def model(self, radius: float) -> LocalModel:
        """Model near them, within a trust region [um]."""

    def moved(self, step: Array) -> Point:
        """Other settings after a step (n), analysed. Raises EaseoffError if they have no certified analysis."""

    def by_differences(self) -> Point | None:
        """The same with derivatives by differences of analyses, which see kinks ahead; ``None`` if it has them."""


@dataclass(frozen=True, eq=False)
class Step:
    """One programme and its outcome."""

    radius: float
    answer: StepAnswer
    settings: Array  # (n) analysed, or meant to be
    fresh: Merit
    accepted: bool
    mending: bool = False  # True if it began at the step before, to mend that one, not at the best settings
    refusal: str = ""  # reason of no certified analysis or, though better, no derivatives; else empty


@dataclass(frozen=True, eq=False)
class Search:
    """Result of a search."""

    point: Any
    steps: tuple[Step, ...]
    #: ``converged``: nothing left to gain; ``steps``: no more of them; ``no_gain``: none in the smallest region
    ended: Ending
    last: StepAnswer
    radius: float


def search(
    start: Any,
    programme: Callable[[LocalModel], StepProgramme],
    *,
    steps: int = 30,
    radius: float = FIRST_RADIUS,
    tolerance: Tolerance = USUAL_TOLERANCE,
    progress: Callable[[], None] | None = None,
) -> Search:
    """Improve a ``Point`` until no programme predicts a gain above the tolerance; a local optimum at best.

    ``programme`` compiles one for a model, ``radius`` is the first trust region's [um]; the merit never rises.
    """
    best, done = start, list[Step]()
    while True:
        model = best.model(radius)
        answer = programme(model).solve(model, radius)
        predicted = best.merit.total - answer.merit
        # A trust region that is small because steps were refused shows no optimum.
        refused = any(step.refusal for step in takewhile(lambda step: not step.accepted, reversed(done)))
        ended: Ending | None = None
        if answer.solved and predicted < tolerance.within(radius) and not refused:
            ended = "converged"
        elif len(done) >= steps:
            ended = "steps"
        elif radius < RADIUS_MINIMUM:
            other = best.by_differences()
            if other is not None and other.differentiable:
                best, radius = other, LATER_RADIUS
                continue
            ended = "no_gain"
        if ended is not None:
            return Search(best, tuple(done), ended, answer, radius)
        point = best
        for mending in range(1 + MENDING_LIMIT):
            span = radius * MENDING_RADIUS_RATIO**mending
            if mending and (len(done) >= steps or not point.differentiable):
                break
            if mending:
                model = point.model(span)
                answer = programme(model).solve(model, span)
            trial, refusal = _moved(point, answer)
            wanted = point.settings + answer.step if trial is None else trial.settings
            fresh = Merit(np.nan, np.nan) if trial is None else trial.merit
            came_true = (best.merit.total - fresh.total) / predicted
            accepted = bool(came_true > TAKEN_GAIN_RATIO) and trial.differentiable
            if came_true > TAKEN_GAIN_RATIO and not accepted:
                refusal = "analysed, and better, but without derivatives of either kind"
            done.append(Step(span, answer, wanted, fresh, accepted, mending > 0, refusal))
            if progress is not None:
                progress()
            if trial is None or accepted or fresh.total > best.merit.total + HOPELESS_LOSS:
                break
            point = trial
        best = trial if accepted else best
        if not accepted:
            radius *= 0.35
        elif came_true < FAIR_GAIN_RATIO:
            radius *= 0.6
        elif came_true > GOOD_GAIN_RATIO and not done[-1].mending:
            radius = min(2.0 * radius, RADIUS_LIMIT)


def _moved(point: Any, answer: StepAnswer) -> tuple[Any, str]:
    """The point that a programme proposes; or none, and why it has no analysis."""
    if not answer.solved:
        return None, f"the programme has no answer: {answer.status}"
    try:
        return point.moved(answer.step), ""
    except EaseoffError as error:
        return None, str(error)
