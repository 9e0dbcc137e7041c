"""Search for settings with elastic teeth that follow them, and the settings rounded at its end.

Teeth are held within a search. At its end the settings are rounded, and analysed with their own teeth; if that changes
what was found, a further search begins there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ....cases.schema.case_schema import Case
from ....core.arrays import RealArray as Array, record
from ....core.errors import EaseoffError
from . import step_programme
from .aim import EaseOffForm, Judgement
from .analysed_settings import AnalysedSettings, Readings, Workshop, in_units
from .step_programme import LocalModel, StepAnswer, StepProgramme
from .trust_region import FIRST_RADIUS, LATER_RADIUS, USUAL_TOLERANCE, Ending, Search, Step, Tolerance, search

#: The most searches, each with teeth built anew.
ROUND_LIMIT = 3
#: Numbers of steps that one setting is moved by, and the most rounds through all settings.
STEP_COUNTS = (64, 16, 4, 1)
ROUND_COUNT_LIMIT = 50
#: Largest change of the ease-off by rounding [um], unless the nearest steps change it more.
ROUNDING_REACH = 0.3


@dataclass(frozen=True, eq=False)
class Prices:
    """Prices of limits: the fall of the objective if they are widened."""

    limits: Array  # (k) by a unit of each limit
    low: Array  # (n) by a unit of the case file of each setting, as ``high``
    high: Array
    ceiling: float  # by one of the other objective's ratio; NaN without a ceiling

    @classmethod
    def of(cls, answer: StepAnswer, judgement: Judgement, units: Array) -> Prices:
        """Multipliers of a programme whose settings (n) have these units."""
        scales = np.array([limit.scale for limit in judgement.aim.limits])
        bounds = [ceiling for _, ceiling in judgement.ceilings if np.isfinite(ceiling)]
        of_ceiling = float(answer.multipliers[scales.size]) / bounds[0] if bounds else np.nan
        limits = answer.multipliers[: scales.size] / scales
        return cls(limits, answer.low_multipliers / units, answer.high_multipliers / units, of_ceiling)


@record(frozen=True, eq=False)
class Outcome:
    """Settings that a search found."""

    values: Array
    rounded: Array
    case: Case
    point: AnalysedSettings
    steps: tuple[tuple[int, Step], ...]
    ended: Ending | None
    prices: Prices
    rounding_change: float  # of the ease-off, a rotation left out [um]
    rounding_loss: float  # rise of the merit from found, teeth held, to rounded settings, own teeth
    #: reason if the rounded settings have no analysis: ``rounded`` and ``case`` are then the settings found or, where
    #: these have none with teeth of their own, those at the start
    unrounded: str = ""


class SettingSearch:
    """Searches of one case for several aims; programmes of one shape are compiled once.

    At most ``steps`` programmes for one aim; a predicted gain, or loss by rounding, below ``tolerance`` ends a search.
    """

    def __init__(
        self,
        workshop: Workshop,
        start: Readings,
        *,
        steps: int,
        tolerance: Tolerance = USUAL_TOLERANCE,
        progress: Callable[[], None] | None = None,
        stage: Callable[[str], None] | None = None,
    ) -> None:
        self._workshop, self._start, self._steps, self._tolerance = workshop, start, steps, tolerance
        self._progress, self._stage = progress, stage
        self._programmes: dict[str, StepProgramme] = {}
        self._name = "search"

    def name(self, name: str | None = None) -> None:
        """Name the search for those who wait for it, or tell its name again."""
        self._name = name or self._name
        if self._stage is not None:
            self._stage(self._name)

    def begun(self, judgement: Judgement) -> AnalysedSettings:
        """The start under a judgement."""
        origin = self._workshop.space.start
        return AnalysedSettings(origin, np.zeros(origin.size), self._start, self._start, judgement, self._workshop)

    def anew(
        self, values: Array, judgement: Judgement, near: Array | None = None
    ) -> tuple[AnalysedSettings, Case, str]:
        """Settings (n), rounded, analysed with their own teeth; the case with them; and the reason if not rounded.

        Rounded ones that cannot be analysed are left unrounded; ``near`` are the settings that can be set, if known.
        Raises as ``Workshop.with_teeth`` and ``readings`` where neither can be analysed.
        """
        space, unrounded = self._workshop.space, ""
        for settings in (space.nearest(values if near is None else near), values):
            try:
                case = space.case_at(settings, rounded=not unrounded)
                workshop = self._workshop.with_teeth(case, self._stage)
                self.name()
                changes = (settings - workshop.space.start) / workshop.units
                readings = workshop.readings(case)
                break
            except EaseoffError as error:
                if unrounded:
                    raise
                unrounded = str(error)
        return AnalysedSettings(settings, changes, readings, self._start, judgement, workshop), case, unrounded

    def settled(self, judgement: Judgement, start: AnalysedSettings | None = None) -> Outcome:
        """The best settings for a judgement, from the start or from others that are analysed with their own teeth."""
        start = self.begun(judgement) if start is None else start.judged_by(judgement)
        done: list[tuple[int, Step]] = []
        outcomes: list[Outcome] = []
        radius = FIRST_RADIUS
        for number in range(ROUND_LIMIT):
            programme, left = partial(self._programme, judgement), self._steps - len(done)
            local_search = search(
                start, programme, steps=left, radius=radius, tolerance=self._tolerance, progress=self._progress
            )
            done += [(number, step) for step in local_search.steps]
            if outcomes and not any(step.accepted for step in local_search.steps):
                break
            outcomes.append(self._rounded(local_search, start, judgement))
            last = outcomes[-1]
            enough = not last.unrounded and last.rounding_loss <= self._tolerance.gain
            if enough or len(done) >= self._steps or last.point is start or not last.point.differentiable:
                break
            start, radius = last.point, float(np.clip(local_search.radius, LATER_RADIUS, FIRST_RADIUS))
        best = min(outcomes, key=lambda one: (bool(one.unrounded), one.point.merit.total))
        return replace(best, steps=tuple(done), ended=local_search.ended)

    def _rounded(self, search: Search, start: AnalysedSettings, judgement: Judgement) -> Outcome:
        """The settings of a search from ``start`` as they are set on the machine, with their own teeth."""
        best: AnalysedSettings = search.point
        try:
            point, case, unrounded = self.anew(best.values, judgement, _rounded_settings(best))
        except EaseoffError as error:
            point, case, unrounded = start, self._workshop.space.case_at(start.values), str(error)
        prices = Prices.of(search.last, judgement, self._workshop.units)
        change, loss = best.ease_off_change(case), point.merit.total - best.merit.total
        return Outcome(best.values, point.values, case, point, (), search.ended, prices, change, loss, unrounded)

    def _programme(self, judgement: Judgement, model: LocalModel) -> StepProgramme:
        weights = judgement.weights
        key = repr((model.shape, weights.tolist(), judgement.aim.form))
        if key not in self._programmes:
            self._programmes[key] = StepProgramme(model, weights, judgement.aim.form)
        return self._programmes[key]


def first_workshop(workshop: Workshop) -> tuple[Workshop, Readings]:
    """The workshop with units in which every setting changes the ease-off by one micrometre at most, and the start."""
    readings = workshop.readings(workshop.space.case)
    reach = np.max([np.abs(EaseOffForm.of(one).slopes).max(axis=0) for one in readings.values()], axis=0)
    units = 1.0 / np.maximum(reach, 1e-12)
    scaled_workshop = replace(workshop, units=units * workshop.units)
    return scaled_workshop, {key: in_units(one, scaled_workshop, units) for key, one in readings.items()}


def _rounded_settings(point: AnalysedSettings) -> Array:
    """Settings (n) that can be set near analysed ones, in the units of the case file: those best by the model.

    The nearest may pass a limit; neighbours are tried by the model alone, as far as the ease-off stays as it is.
    """
    space, units = point.workshop.space, point.workshop.units
    model, judgement = point.model(1.0), point.judgement

    def reach(values: Array) -> float:
        """Change of the ease-off [um]; that by one setting alone counts as in a programme."""
        step = (values - point.values) / units
        return float(max(np.abs(model.reach @ step).max(), np.abs(step).max() / step_programme.SINGLE_REACH))

    def merit(values: Array) -> float:
        step = (values - point.values) / units
        ratios = [np.array([one.value(step) for one in group]) for group in model.objectives]
        margin = 0.5 * step_programme.LIMIT_MARGIN
        passed = [max(one.value(step) for one in group) - 1.0 + margin for group in model.limits]
        price = step_programme.VIOLATION_PRICE * sum(max(0.0, excess) for excess in passed)
        return step_programme.judged_objective(ratios, judgement.weights, judgement.aim.form) + price

    best = space.nearest(point.values)
    least, most = merit(best), max(reach(best), ROUNDING_REACH)
    for _ in range(ROUND_COUNT_LIMIT):
        before = least
        for number, step in enumerate(space.steps):
            for count in (sign * size for size in STEP_COUNTS for sign in (1, -1)):
                tried = best.copy()
                tried[number] += count * step
                tried = space.nearest(tried)
                if reach(tried) > most:
                    continue
                tried_merit = merit(tried)
                if tried_merit < least - 1e-9:
                    best, least = tried, tried_merit
        if least == before:
            break
    return best
