"""Convex programmes and trust region of a search for settings: against scipy, closed forms and a search on a grid."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import linprog, minimize

from easeoff import GeometryError
from easeoff.study.design.optimization.step_programme import (
    LIMIT_MARGIN,
    SINGLE_REACH,
    VIOLATION_PRICE,
    Composite,
    Form,
    LocalModel,
    StepProgramme,
    judged_objective,
)
from easeoff.study.design.optimization.trust_region import RADIUS_MINIMUM, Merit, search

Array = NDArray[np.float64]
RADIUS = 2.0


def composites(random: np.random.Generator, kind: Any, count: int, size: int = 3) -> tuple[Composite, ...]:
    rows = 2 if kind == "norm" else 6
    return tuple(
        Composite(kind, 1.0 + 0.2 * random.standard_normal(rows), 0.1 * random.standard_normal((rows, size)))
        for _ in range(count)
    )


def model(random: np.random.Generator, kinds: tuple[str, str], limited: str) -> LocalModel:
    reach = np.clip(random.standard_normal((12, 3)), -1.0, 1.0)
    return LocalModel(
        (composites(random, kinds[0], 2), composites(random, kinds[1], 1)),
        (composites(random, limited, 2),),
        reach,
        np.array([-0.5, -5.0, -1.0]),
        np.array([3.0, 0.4, 5.0]),
    )


def by_scipy(near: LocalModel, form: Form, weights: Array) -> float:
    """Objective with the price of the violation, by another method from several starts."""

    def values(step: Array) -> float:
        ratios = [np.array([one.value(step) for one in group]) for group in near.objectives]
        passed = sum(max(0.0, max(one.value(step) for one in group) - 1.0 + LIMIT_MARGIN) for group in near.limits)
        return judged_objective(ratios, weights, form) + VIOLATION_PRICE * passed

    low = np.maximum(near.low, -SINGLE_REACH * RADIUS)
    high = np.minimum(near.high, SINGLE_REACH * RADIUS)

    def bounded(step: Array) -> float:
        inside = np.clip(step, low, high)
        far = max(0.0, float(np.max(np.abs(near.reach @ inside))) - RADIUS)
        return values(inside) + 1e3 * far + float(np.sum(np.abs(step - inside)))

    found = []
    for seed in range(2):
        step = 0.1 * np.random.default_rng(seed).standard_normal(3)
        for _ in range(3):
            step = minimize(bounded, step, method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-11}).x
        found.append(bounded(step))
    return min(found)


@pytest.mark.parametrize("seed", [1, 2])
def test_affine_programmes_agree_with_linear_programming(seed: int) -> None:
    random = np.random.default_rng(seed)
    near = model(random, ("greatest", "range"), "greatest")
    answer = StepProgramme(near, np.ones(2), "worst").solve(near, RADIUS)
    # Unknowns: step (3), worst, violation, and of every range its greatest and least.
    size = 5 + 2 * len(near.objectives[1])
    upper, right = [], []

    def add(step: Array, bound: float, **others: float) -> None:
        row = np.zeros(size)
        row[:3] = step
        for place, value in others.items():
            row[int(place[1:])] = value
        upper.append(row)
        right.append(bound)

    for one in near.objectives[0]:
        for level, slope in zip(one.level, one.slope, strict=True):
            add(slope, -level, _3=-1.0)
    for number, one in enumerate(near.objectives[1]):
        top, least = f"_{5 + 2 * number}", f"_{6 + 2 * number}"
        for level, slope in zip(one.level, one.slope, strict=True):
            add(slope, -level, **{top: -1.0})
            add(-slope, level, **{least: 1.0})
        add(np.zeros(3), 0.0, _3=-1.0, **{top: 1.0, least: -1.0})
    for one in near.limits[0]:
        for level, slope in zip(one.level, one.slope, strict=True):
            add(slope, 1.0 - LIMIT_MARGIN - level, _4=-1.0)
    for row in near.reach:
        add(row, RADIUS)
        add(-row, RADIUS)
    low = np.maximum(near.low, -SINGLE_REACH * RADIUS)
    high = np.minimum(near.high, SINGLE_REACH * RADIUS)
    free = [(None, None)] * (size - 5)
    bounds = [*zip(low, high, strict=True), (None, None), (0.0, None), *free]
    cost = np.zeros(size)
    cost[3], cost[4] = 1.0, VIOLATION_PRICE
    known = linprog(cost, np.array(upper), np.array(right), bounds=bounds)
    assert answer.solved
    assert answer.merit == pytest.approx(known.fun, abs=1e-7)
    assert np.all(np.abs(near.reach @ answer.step) <= RADIUS + 1e-6)


@pytest.mark.parametrize("form", ["worst", "weighted"])
def test_programmes_with_norms_agree_with_a_direct_search(form: Form) -> None:
    near = model(np.random.default_rng(3), ("norm", "range"), "norm")
    weights = np.array([1.0, 0.7])
    answer = StepProgramme(near, weights, form).solve(near, RADIUS)
    direct = by_scipy(near, form, weights)
    assert answer.merit <= direct + 1e-7
    assert answer.merit == pytest.approx(direct, rel=2e-3)


def test_a_programme_is_compiled_once_for_models_of_one_shape() -> None:
    random = np.random.default_rng(4)
    first, second = (model(random, ("greatest", "norm"), "range") for _ in range(2))
    shared = StepProgramme(first, np.ones(2), "worst")
    assert first.shape == second.shape
    shared.solve(first, RADIUS)
    again, alone = shared.solve(second, 0.5), StepProgramme(second, np.ones(2), "worst").solve(second, 0.5)
    assert again.merit == pytest.approx(alone.merit, abs=1e-8)
    assert shared._problem.is_dcp(dpp=True)


@dataclass(frozen=True, eq=False)
class Bowl:
    """A problem in closed form: the greater of two parabolas, under a limit of a coordinate's square."""

    settings: Array
    limit: float

    def rows(self) -> Composite:
        x, y = self.settings
        level = np.array(
            [1.0 + 0.02 * (x - 3.0) ** 2 + 0.01 * y**2, 1.0 + 0.02 * (x + 1.0) ** 2 + 0.01 * (y - 2.0) ** 2]
        )
        slope = np.array([[0.04 * (x - 3.0), 0.02 * y], [0.04 * (x + 1.0), 0.02 * (y - 2.0)]])
        return Composite("greatest", level, slope)

    def limited(self) -> Composite:
        x, _ = self.settings
        return Composite("affine", np.array([1.0 + x - self.limit]), np.array([[1.0, 0.0]]))

    @property
    def merit(self) -> Merit:
        return Merit(self.rows().value(), max(0.0, self.limited().value() - 1.0))

    @property
    def differentiable(self) -> bool:
        return True

    def model(self, radius: float) -> LocalModel:
        far = np.full(2, 50.0)
        return LocalModel(((self.rows(),),), ((self.limited(),),), np.eye(2), -far - self.settings, far - self.settings)

    def moved(self, step: Array) -> Bowl:
        return replace(self, settings=self.settings + step)

    def by_differences(self) -> Bowl | None:
        return None


def optimum(limit: float) -> Any:
    start = Bowl(np.array([-2.0, 5.0]), limit)
    shared = StepProgramme(start.model(1.0), np.ones(1), "worst")
    return search(start, lambda _: shared, steps=60)


def test_a_search_finds_the_optimum_of_a_grid() -> None:
    x, y = np.meshgrid(np.linspace(-2.0, 4.0, 241), np.linspace(-2.0, 4.0, 241))
    values = np.maximum(1.0 + 0.02 * (x - 3.0) ** 2 + 0.01 * y**2, 1.0 + 0.02 * (x + 1.0) ** 2 + 0.01 * (y - 2.0) ** 2)
    assert optimum(10.0).point.merit.objective == pytest.approx(values.min(), abs=2e-3)
    kept = values[x <= 0.5]
    bounded = optimum(0.5)
    assert bounded.point.merit.objective == pytest.approx(kept.min(), abs=2e-3)
    assert bounded.point.merit.violation == 0.0


def test_the_merit_never_rises_and_steps_stay_in_the_trust_region() -> None:
    found = optimum(0.5)
    accepted = [step.fresh.total for step in found.steps if step.accepted]
    assert accepted == sorted(accepted, reverse=True)
    assert all(np.max(np.abs(step.answer.step)) <= step.radius + 1e-6 for step in found.steps)


def test_a_multiplier_is_what_a_moved_limit_gains() -> None:
    here = optimum(0.5)
    gain = (optimum(0.4).point.merit.objective - optimum(0.6).point.merit.objective) / 0.2
    assert here.last.multipliers[0] == pytest.approx(gain, rel=0.1)
    assert optimum(10.0).last.multipliers[0] == pytest.approx(0.0, abs=1e-5)


@dataclass(frozen=True, eq=False)
class Walled(Bowl):
    """The same, with no analysis at negative y."""

    def moved(self, step: Array) -> Bowl:
        if (self.settings + step)[1] < 0.0:
            raise GeometryError("there is a wall")
        return super().moved(step)


@dataclass(frozen=True, eq=False)
class Misled(Bowl):
    """The same with exact derivatives of the wrong sign, but right differences."""

    by_sign: float = -1.0

    def rows(self) -> Composite:
        found = super().rows()
        return replace(found, slope=self.by_sign * found.slope)

    def moved(self, step: Array) -> Bowl:
        return replace(self, settings=self.settings + step, by_sign=-1.0)

    def by_differences(self) -> Bowl | None:
        return replace(self, by_sign=1.0) if self.by_sign < 0.0 else None


def searched(start: Bowl, steps: int = 60) -> Any:
    shared = StepProgramme(start.model(1.0), np.ones(1), "worst")
    return search(start, lambda _: shared, steps=steps)


def test_a_search_says_why_it_ended_and_why_settings_were_refused() -> None:
    far = np.array([-2.0, 5.0])
    assert searched(Bowl(far, 10.0)).ended == "converged"
    assert searched(Bowl(far, 10.0), steps=2).ended == "steps"
    # The bowl falls towards its wall: near it smaller and smaller steps gain, until none does.
    walled = searched(Walled(np.array([3.0, 0.5]), 10.0))
    refused = [step for step in walled.steps if step.refusal]
    assert {step.refusal for step in refused} == {"there is a wall"}
    assert all(np.isnan(step.fresh.objective) == bool(step.refusal) for step in walled.steps)
    assert walled.point.settings[1] >= 0.0
    closed = searched(Walled(np.array([-2.0, -20.0]), 10.0))
    assert closed.ended == "no_gain"
    assert all(step.refusal == "there is a wall" for step in closed.steps)
    assert closed.radius < RADIUS_MINIMUM


def test_where_exact_derivatives_lead_nowhere_differences_go_on() -> None:
    misled = searched(Misled(np.array([-2.0, 5.0]), 10.0))
    assert misled.point.merit.total < Bowl(np.array([-2.0, 5.0]), 10.0).merit.total - 0.1
    accepted = [step.accepted for step in misled.steps]
    assert not any(accepted[:2])
    assert any(accepted)


@pytest.mark.parametrize("kind", ["affine", "greatest", "range", "norm"])
def test_the_rise_bounds_that_of_any_change_of_one_setting(kind: Any) -> None:
    """Of one setting it is the greatest rise by either sign, but for a norm, which rises by no more."""
    random = np.random.default_rng(3)
    rows = {"affine": 1, "norm": 2}.get(kind, 6)
    for _ in range(20):
        one = Composite(kind, 1.0 + 0.2 * random.standard_normal(rows), 0.1 * random.standard_normal((rows, 3)))
        for number in range(3):
            change = np.zeros(3)
            change[number] = 0.3
            greatest = max(one.value(sign * change) for sign in (-1.0, 1.0)) - one.value()
            assert greatest <= one.rise(change) + 1e-12
            if kind == "affine":
                assert greatest == pytest.approx(one.rise(change), abs=1e-12)


def test_programmes_leave_room_for_rounding() -> None:
    """Of a limit that every row reaches, as much as rounding of both settings may raise it."""
    reached = Composite("greatest", np.array([0.5]), np.array([[0.03, 0.04]]))
    objective = Composite("affine", np.array([1.0]), np.array([[-0.03, -0.04]]))
    wide = np.array([99.0, 99.0])
    for rounding in (0.0, 0.5):
        near = LocalModel(((objective,),), ((reached,),), 0.01 * np.eye(2), -wide, wide, rounding)
        found = StepProgramme(near, np.ones(1), "weighted").solve(near, 50.0)
        assert near.margins == pytest.approx(LIMIT_MARGIN + 0.05 * rounding, rel=1e-12)
        assert reached.value(found.step) == pytest.approx(1.0 - near.margins[0], abs=1e-6)
