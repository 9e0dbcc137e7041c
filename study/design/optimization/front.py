"""Front of two objectives: none of its points can be better in one without being worse in the other.

Both ends are the optima of one objective each. Between them one objective is minimised under a ceiling of the other,
each time in the middle of the widest gap, from the neighbour that keeps the ceiling, or else from the other one (method
of epsilon constraints).

A search is recorded as datasets of settings, objectives, limits, programmes, assemblies and the front.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from ....cases.deflections import assembly_columns
from ....core.arrays import RealArray as Array
from ....core.attributes import labelled
from ....core.errors import InputError
from ...result import GROUPS
from .aim import Aim, Judgement
from .analysed_settings import AnalysedSettings
from .setting_search import Outcome, Prices, SettingSearch
from .trust_region import GAIN_TOLERANCE, Ending, Step, Tolerance

#: Of the search for a point. Rounding changes as much, and steps towards less mostly fail: they would take a third of
#: all analyses.
FRONT_TOLERANCE = Tolerance(2.0 * GAIN_TOLERANCE, 1.0)
#: Attempts for each point that is wanted, and ratios that differ by less are the same.
ATTEMPT_COUNT, SAME_RATIO = 2, GAIN_TOLERANCE


@dataclass(frozen=True, eq=False)
class FrontPoint:
    """One point of a front."""

    found: Array
    setting: Array  # rounded
    ratio: Array  # objectives of the rounded settings over those of the start (2)
    value: Array  # of the objectives in their own units, the greatest of all loads (2)
    limited: Array  # quantities with a limit (k), the worst of all loads
    prices: Prices
    violation: float
    ceiling: float  # of the second objective's ratio; NaN at the ends
    converged: bool
    rounding_change: float
    rounding_loss: float
    analyses: int
    outcome: Outcome | None = None

    def analysed(self, searching: SettingSearch, judgement: Judgement) -> AnalysedSettings:
        """Its settings, analysed with their own teeth."""
        if self.outcome is not None:
            return self.outcome.point.judged_by(judgement)
        return searching.anew(self.setting, judgement)[0]

    def resumed(self, searching: SettingSearch, judgement: Judgement) -> Outcome:
        """The outcome of its search, analysed again if the point was read."""
        if self.outcome is not None:
            return self.outcome
        point, case, unrounded = searching.anew(self.setting, judgement)
        effect = self.rounding_change, self.rounding_loss
        ended: Ending | None = "converged" if self.converged else None
        return Outcome(self.found, point.values, case, point, (), ended, self.prices, *effect, unrounded)


#: Variables of the group ``front`` that are fields of a point's prices; all others are fields of the point itself.
PRICE_FIELDS = {
    "front_multiplier": "ceiling",
    "front_limit_multiplier": "limits",
    "front_low_multiplier": "low",
    "front_high_multiplier": "high",
}
POINT_FIELDS = {
    name: name.removeprefix("front_")
    for names in GROUPS["front"].values()
    for name in names
    if name not in PRICE_FIELDS
}


def front_point(outcome: Outcome, judgement: Judgement) -> FrontPoint:
    """Point of a front that a search found, under the judgement of both objectives without ceilings."""
    point = outcome.point.judged_by(judgement)
    ratio, objective, limited = judgement.worst(point.read)
    ((_, ceiling),) = outcome.point.judgement.ceilings
    violation, ceiling = judgement.merit(point.read).violation, ceiling if np.isfinite(ceiling) else np.nan
    numbers = outcome.values, outcome.rounded, ratio, objective, limited, outcome.prices, violation, ceiling
    rounding, analyses = (outcome.rounding_change, outcome.rounding_loss), point.workshop.effort.analyses
    return FrontPoint(*numbers, outcome.ended == "converged", *rounding, analyses, outcome)


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
    points = list(known)
    if len(points) < 2:
        searching.name("ends of the front")
        first = searching.settled(alone(judgement, 0))
        near = first.point if first.point.differentiable else None
        second = searching.settled(alone(judgement, 1), near)
        points = undominated([front_point(one, judgement) for one in (second, first)])
    spent: list[float] = []
    for _ in range(ATTEMPT_COUNT * count):
        ratios = np.array([one.ratio for one in points])
        ceilings = 0.5 * (ratios[1:, 1] + ratios[:-1, 1])
        gaps = np.hypot(*(np.diff(ratios, axis=0) / np.maximum(np.ptp(ratios, axis=0), 1e-9)).T)
        gaps[np.isin(ceilings, spent)] = 0.0
        if len(points) >= count or not np.any(gaps > 0.0):
            break
        gap = int(np.argmax(gaps))
        searching.name(f"point {len(points) + 1} of {count}")
        under = replace(judgement, ceilings=((1, float(ceilings[gap])),))
        attempts = _attempts(searching, judgement, under, points[gap : gap + 2])
        one = next((one for one in attempts if new(one, ratios)), None)
        if one is None:
            spent.append(float(ceilings[gap]))  # nothing new there
        else:
            points = undominated([*points, one])
    return points


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
    """True if no point with one of the ratios (k, 2) is as good as one in both objectives."""
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


def search_record(
    start: AnalysedSettings, outcome: Outcome, judgement: Judgement, steps: Sequence[tuple[int, Step]]
) -> xr.Dataset:
    """The group ``optimal_settings``, of all programmes with the number of the search; judged without ceilings."""
    workshop, aim = start.workshop, judgement.aim
    _, before, before_limited = judgement.worst(start.read)
    ratio, after, after_limited = judgement.worst(outcome.point.read)
    free = workshop.space.free
    data: dict[str, Any] = {
        "setting_start": ("setting", [one.start for one in free]),
        "setting_found": ("setting", outcome.values),
        "setting_value": ("setting", outcome.rounded),
        "setting_low": ("setting", [one.low for one in free]),
        "setting_high": ("setting", [one.high for one in free]),
        "ease_off_per_setting": ("setting", 1.0 / workshop.units),
        "low_multiplier": ("setting", outcome.prices.low),
        "high_multiplier": ("setting", outcome.prices.high),
        "objective_weight": ("objective", aim.weights),
        "objective_start": ("objective", before),
        "objective_value": ("objective", after),
        "objective_ratio": ("objective", ratio),
        "limit_bound": ("quantity_limit", [limit.bound for limit in aim.limits]),
        "limited_start": ("quantity_limit", before_limited),
        "limited_value": ("quantity_limit", after_limited),
        "limit_multiplier": ("quantity_limit", outcome.prices.limits),
        "ratio_by_assembly": (("objective", "assembly"), judgement.by_assembly(outcome.point.read)[0]),
        **assembly_columns(workshop.assemblies),
        **_programmes(start, steps),
    }
    coords = {
        "setting": ("setting", [one.name for one in free]),
        "setting_units": ("setting", [one.units for one in free]),
        "objective": ("objective", [one.quantity.text for one in aim.objectives]),
        "objective_units": ("objective", [one.quantity.meaning.units for one in aim.objectives]),
        "quantity_limit": ("quantity_limit", np.array([limit.text for limit in aim.limits], dtype=np.str_)),
        "limit_units": ("quantity_limit", np.array([one.quantity.meaning.units for one in aim.limits], dtype=np.str_)),
        "assembly": np.arange(len(workshop.assemblies)),
        "programme": np.arange(1, 1 + len(steps)),
    }
    merit = judgement.merit(outcome.point.read)
    record = labelled(xr.Dataset(data, coords=coords))
    record.attrs |= {
        "form": aim.form,
        "converged": int(outcome.ended == "converged"),
        "ended": outcome.ended or "",
        "refused_proposals": sum(bool(step.refusal) for _, step in steps),
        "objective_total": merit.objective,
        "violation": merit.violation,
        "rounding_change_um": outcome.rounding_change,
        "rounding_loss": outcome.rounding_loss,
        "unrounded": outcome.unrounded,
        "flanks": ", ".join(aim.flanks),
        "edge_contact": int(start.readings[aim.flanks[0], 0].solved.edge_contact),
    }
    return record


def _programmes(start: AnalysedSettings, steps: Sequence[tuple[int, Step]]) -> dict[str, Any]:
    workshop = start.workshop
    settings = [workshop.space.start + workshop.units * step.settings for _, step in steps]
    return {
        "search_number": ("programme", np.array([number for number, _ in steps], dtype=np.int64)),
        "reach": ("programme", [step.radius for _, step in steps]),
        "promised_objective": ("programme", [step.answer.objective for _, step in steps]),
        "fresh_objective": ("programme", [step.fresh.objective for _, step in steps]),
        "promised_violation": ("programme", [step.answer.violation for _, step in steps]),
        "fresh_violation": ("programme", [step.fresh.violation for _, step in steps]),
        "accepted": ("programme", np.array([step.accepted for _, step in steps], dtype=np.int8)),
        "mending": ("programme", np.array([step.mending for _, step in steps], dtype=np.int8)),
        "programme_status": ("programme", np.array([step.answer.status for _, step in steps], dtype=np.str_)),
        "refusal": ("programme", np.array([step.refusal for _, step in steps], dtype=np.str_)),
        "programme_settings": (("programme", "setting"), np.reshape(settings, (len(steps), workshop.units.size))),
    }


def front_record(points: Sequence[FrontPoint], record: xr.Dataset, chosen: int) -> xr.Dataset:
    """The group ``front``, in the order of the second objective; the result holds the analysis of point ``chosen``."""
    sizes = {**record.sizes, "point": len(points)}
    values = {name: [getattr(one, field) for one in points] for name, field in POINT_FIELDS.items()}
    values |= {name: [getattr(one.prices, field) for one in points] for name, field in PRICE_FIELDS.items()}
    data: dict[str, Any] = {
        name: (over, np.reshape(values[name], [sizes[one] for one in over]))
        for over, names in GROUPS["front"].items()
        for name in names
    }
    data["front_converged"] = ("point", np.array(values["front_converged"], dtype=np.int8))
    names = ("objective", "objective_units", "quantity_limit", "limit_units", "setting", "setting_units")
    coords = {name: record[name] for name in names} | {"point": np.arange(len(points))}
    group = labelled(xr.Dataset(data, coords=coords))
    group.attrs["chosen_point"] = chosen
    return group


def front_points(tree: xr.DataTree) -> list[FrontPoint]:
    """Points of the front of a result; none without one."""
    if "front" not in tree.children:
        return []
    front = tree["front"].to_dataset()

    def read(number: int, names: Mapping[str, str]) -> dict[str, Any]:
        each = {field: front[name].values[number] for name, field in names.items()}
        return {field: value if value.ndim else value.item() for field, value in each.items()}

    return [
        FrontPoint(**read(number, POINT_FIELDS), prices=Prices(**read(number, PRICE_FIELDS)))
        for number in range(front.sizes["point"])
    ]


def require_same_search(tree: xr.DataTree, start: AnalysedSettings, aim: Aim) -> None:
    """Refuse to resume from a result of a search with other settings or another start.

    Points of a front are kept for the same objectives and limits alone.
    """
    if "optimal_settings" not in tree.children:
        raise InputError("resume: must be a result of 'easeoff optimize'")
    known, space = tree["optimal_settings"].to_dataset(), start.workshop.space
    wanted = {"setting": [one.name for one in space.free]}
    if aim.form == "pareto":
        wanted["objective"] = [one.quantity.text for one in aim.objectives]
        wanted["quantity_limit"] = [limit.text for limit in aim.limits]
    for kind, names in wanted.items():
        given = known[kind].values.tolist()
        if given != names:
            raise InputError(
                f"resume: its {kind}s are {', '.join(given) or 'none'}: must be {', '.join(names) or 'none'}"
            )
    if not np.allclose(known["setting_start"].values, space.start, rtol=1e-9, atol=1e-9):
        raise InputError("resume: its search began at other settings: must be a result of the same case")
