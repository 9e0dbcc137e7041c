"""Front of two objectives: none of its points can be better in one without being worse in the other.

Both ends are the optima of one objective each. Between them one objective is minimised under a ceiling of the other,
each time in the middle of the widest gap, from the neighbour that keeps the ceiling (method of epsilon constraints).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .aim import Judgement
from .setting_search import Outcome, SettingSearch

Array = NDArray[np.float64]


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
    multiplier
        How much the first objective's ratio falls if that of the second may rise by one; NaN at the ends.
    violation
        Sum over the limits of the share by which each is passed.
    ceiling
        Of the second objective's ratio; NaN at the ends.
    outcome
        Of the search; ``None`` of a point that was read.
    """

    values: Array
    rounded: Array
    ratio: Array
    objective: Array
    limited: Array
    multiplier: float
    violation: float
    ceiling: float
    outcome: Outcome | None = None


def front_point(outcome: Outcome, judgement: Judgement) -> FrontPoint:
    """Point of a front that a search found, under the judgement of both objectives without ceilings."""
    point = outcome.point.judged_by(judgement)
    ratio, objective, limited = judgement.worst(point.read)
    ((_, ceiling),) = outcome.point.judgement.ceilings
    bounded = np.isfinite(ceiling)
    multiplier = float(outcome.last.multipliers[-1]) / ceiling if bounded else np.nan
    return FrontPoint(
        outcome.values,
        outcome.rounded,
        ratio,
        objective,
        limited,
        multiplier,
        judgement.merit(point.read).violation,
        ceiling if bounded else np.nan,
        outcome,
    )


def front(
    searching: SettingSearch,
    judgement: Judgement,
    count: int,
    known: Sequence[FrontPoint] = (),
    kept: Callable[[FrontPoint], None] | None = None,
) -> list[FrontPoint]:
    """Points of the front of two objectives, in the order of the second; without those that another one dominates.

    Parameters
    ----------
    searching
        Searches of the case.
    judgement
        Of both objectives.
    count
        Number of points to search for, two at least.
    known
        Points that are there already.
    kept
        Called with every new point.
    """
    found = list(known)

    def add(outcome: Outcome) -> None:
        found.append(front_point(outcome, judgement))
        if kept is not None:
            kept(found[-1])

    if len(found) < 2:
        found.clear()
        for number in (0, 1):
            add(searching.settled(alone(judgement, number), found[0].values if found else None))
    while len(found) < count:
        found.sort(key=lambda one: one.ratio[1])
        ratios = np.array([one.ratio for one in found])
        span = np.maximum(np.ptp(ratios, axis=0), 1e-9)
        gaps = np.hypot(*(np.diff(ratios, axis=0) / span).T)
        gap = int(np.argmax(gaps))
        ceiling = float(ratios[gap : gap + 2, 1].mean())
        under = replace(judgement, ceilings=((1, ceiling),))
        add(searching.settled(under, found[gap].values))
    return sorted(undominated(found), key=lambda one: one.ratio[1])


def undominated(points: Sequence[FrontPoint]) -> list[FrontPoint]:
    """The points than which no other is better in one objective and no worse in the other."""
    ratios = np.array([one.ratio for one in points])
    return [
        one for one in points if not np.any(np.all(ratios <= one.ratio, axis=1) & np.any(ratios < one.ratio, axis=1))
    ]


def alone(judgement: Judgement, number: int) -> Judgement:
    """A judgement of one of two objectives alone; the ceiling of the other is none."""
    return replace(judgement, ceilings=((1 - number, np.inf),))


def best_of(points: Sequence[FrontPoint]) -> int:
    """Number of the point of a front that is nearest to the best of both objectives, in relation to its extent."""
    ratios = np.array([one.ratio for one in points])
    least, span = ratios.min(axis=0), np.maximum(np.ptp(ratios, axis=0), 1e-9)
    return int(np.argmin(np.hypot(*((ratios - least) / span).T)))
