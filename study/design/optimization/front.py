"""Front of two objectives: none of its points can be better in one without being worse in the other.

Both ends are the optima of one objective each. Between them one objective is minimised under a ceiling of the other,
each time in the middle of the widest gap, from the neighbour that keeps the ceiling, or else from the other one (method
of epsilon constraints).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .aim import Judgement
from .analysed_settings import AnalysedSettings
from .setting_search import Outcome, Prices, SettingSearch
from .trust_region import GAIN_TOLERANCE, Ending, Tolerance

Array = NDArray[np.float64]


#: Of the search for a point. Rounding changes as much, and steps towards less mostly fail: they would take a third of
#: all analyses.
FRONT_TOLERANCE = Tolerance(2.0 * GAIN_TOLERANCE, 1.0)
#: Attempts for each point that is wanted, and ratios that differ by less are the same.
ATTEMPT_COUNT, SAME_RATIO = 2, GAIN_TOLERANCE


@dataclass(frozen=True, eq=False)
class FrontPoint:
    """One point of a front.

    Parameters
    ----------
    values, rounded
        Settings found (n) and as they are set on the machine, in the units of the case file.
    ratio
        Objectives of the rounded settings over those of the start (2).
    objective
        The same in their own units, the greatest of all loads (2).
    limited
        Quantities with a limit (k), the worst of all loads.
    prices
        What limits cost there; the ceiling is that of the second objective.
    violation
        Sum over the limits of the share by which each is passed.
    ceiling
        Of the second objective's ratio; NaN at the ends.
    converged
        Whether the search had nothing left to gain.
    rounding_change, rounding_loss
        See ``Outcome``.
    analyses
        Number of all analyses when the point was found.
    outcome
        Of the search; ``None`` of a point that was read.
    """

    values: Array
    rounded: Array
    ratio: Array
    objective: Array
    limited: Array
    prices: Prices
    violation: float
    ceiling: float
    converged: bool
    rounding_change: float
    rounding_loss: float
    analyses: int
    outcome: Outcome | None = None

    def analysed(self, searching: SettingSearch, judgement: Judgement) -> AnalysedSettings:
        """Its settings, analysed with their own teeth."""
        if self.outcome is not None:
            return self.outcome.point.judged_by(judgement)
        return searching.anew(self.rounded, judgement)[0]

    def resumed(self, searching: SettingSearch, judgement: Judgement) -> Outcome:
        """The outcome of its search, analysed again if the point was read."""
        if self.outcome is not None:
            return self.outcome
        point, case, unrounded = searching.anew(self.rounded, judgement)
        effect = self.rounding_change, self.rounding_loss
        ended: Ending | None = "converged" if self.converged else None
        return Outcome(self.values, point.values, case, point, (), ended, self.prices, *effect, unrounded)


def front_point(outcome: Outcome, judgement: Judgement) -> FrontPoint:
    """Point of a front that a search found, under the judgement of both objectives without ceilings."""
    point = outcome.point.judged_by(judgement)
    ratio, objective, limited = judgement.worst(point.read)
    ((_, ceiling),) = outcome.point.judgement.ceilings
    return FrontPoint(
        outcome.values,
        outcome.rounded,
        ratio,
        objective,
        limited,
        outcome.prices,
        judgement.merit(point.read).violation,
        ceiling if np.isfinite(ceiling) else np.nan,
        outcome.ended == "converged",
        outcome.rounding_change,
        outcome.rounding_loss,
        point.workshop.effort.analyses,
        outcome,
    )


def front(
    searching: SettingSearch, judgement: Judgement, count: int, known: Sequence[FrontPoint] = ()
) -> list[FrontPoint]:
    """Points of the front of two objectives, in the order of the second; none of them dominates another one.

    Parameters
    ----------
    searching
        Searches of the case.
    judgement
        Of both objectives.
    count
        Number of points to search for, two at least; fewer are found where the front has no more.
    known
        Points that are there already.
    """
    found = list(known)
    if len(found) < 2:
        searching.name("ends of the front")
        first = searching.settled(alone(judgement, 0))
        near = first.point if first.point.differentiable else None
        second = searching.settled(alone(judgement, 1), near)
        found = undominated([front_point(one, judgement) for one in (second, first)])
    spent: list[float] = []
    for _ in range(ATTEMPT_COUNT * count):
        ratios = np.array([one.ratio for one in found])
        ceilings = 0.5 * (ratios[1:, 1] + ratios[:-1, 1])
        gaps = np.hypot(*(np.diff(ratios, axis=0) / np.maximum(np.ptp(ratios, axis=0), 1e-9)).T)
        gaps[np.isin(ceilings, spent)] = 0.0
        if len(found) >= count or not np.any(gaps > 0.0):
            break
        gap = int(np.argmax(gaps))
        searching.name(f"point {len(found) + 1} of {count}")
        under = replace(judgement, ceilings=((1, float(ceilings[gap])),))
        one = next(
            (one for one in _attempts(searching, judgement, under, found[gap : gap + 2]) if new(one, ratios)), None
        )
        if one is None:
            spent.append(float(ceilings[gap]))  # nothing new there
        else:
            found = undominated([*found, one])
    return found


def _attempts(
    searching: SettingSearch, judgement: Judgement, under: Judgement, neighbours: Sequence[FrontPoint]
) -> Iterator[FrontPoint]:
    """Points under a ceiling, searched from either neighbour, that which keeps it first."""
    for neighbour in neighbours:
        start = neighbour.analysed(searching, under)
        if start.differentiable:
            outcome = searching.settled(under, start)
            if not outcome.unrounded:  # teeth of the settings found may be such that none can be built
                yield front_point(outcome, judgement)


def new(one: FrontPoint, ratios: Array) -> bool:
    """Whether no point with one of the ratios (k, 2) is as good as one in both objectives."""
    return not np.any(np.all(ratios <= one.ratio + SAME_RATIO, axis=1))


def undominated(points: Sequence[FrontPoint]) -> list[FrontPoint]:
    """The points than which no other is better in one objective and no worse in the other, in order of the second."""
    ratios = np.array([one.ratio for one in points])
    kept = [
        one for one in points if not np.any(np.all(ratios <= one.ratio, axis=1) & np.any(ratios < one.ratio, axis=1))
    ]
    return sorted(kept, key=lambda one: one.ratio[1])


def alone(judgement: Judgement, number: int) -> Judgement:
    """A judgement of one of two objectives alone; the ceiling of the other is none."""
    return replace(judgement, ceilings=((1 - number, np.inf),))


def best_of(points: Sequence[FrontPoint]) -> int:
    """Number of the point of a front that is nearest to the best of both objectives, in relation to its extent."""
    ratios = np.array([one.ratio for one in points])
    least, span = ratios.min(axis=0), np.maximum(np.ptp(ratios, axis=0), 1e-9)
    return int(np.argmin(np.hypot(*((ratios - least) / span).T)))
