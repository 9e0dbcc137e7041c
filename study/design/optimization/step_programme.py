"""Convex programme of one step: objectives and limits as composites, the step within a trust region.

Limits may be passed at a price, so that the programme always has an answer. It is compiled once for rows of one shape;
rows, derivatives, bounds and trust region are its parameters.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from ....core.arrays import RealArray as Array
from .composite import Composite

Form = Literal["weighted", "worst", "pareto"]
FORMS: tuple[Form, ...] = get_args(Form)

#: Price of passing a limit, per share of it, in units of the objective, which is about one at the start.
VIOLATION_PRICE = 10.0
#: Share of a limit by which a programme stays below it for what is lost by linearising; to which rounding adds its own.
LIMIT_MARGIN = 2e-3
#: Largest change of the ease-off by one setting alone, over the largest one by all together.
SINGLE_REACH = 20.0


@dataclass(frozen=True, eq=False)
class LocalModel:
    """Model of objectives and limits near the present settings (n): composites of all loads over reference or limit."""

    objectives: tuple[tuple[Composite, ...], ...]
    limits: tuple[tuple[Composite, ...], ...]
    reach: Array  # change of the ease-off at points of the flanks (s, n) [um]
    low: Array
    high: Array
    rounding: Array | float = 0.0  # most that rounding changes each setting (n)

    @property
    def margins(self) -> Array:
        """Shares of the limits by which a programme stays below them."""
        rises = [max(one.rise(self.rounding) for one in group) for group in self.limits]
        return LIMIT_MARGIN + np.array(rises, dtype=np.float64)

    @property
    def size(self) -> int:
        """Number of settings."""
        return self.low.size

    @property
    def shape(self) -> tuple[Any, ...]:
        """Shape on which a compiled programme depends."""
        groups = (self.objectives, self.limits)
        return (*([[(c.kind, c.level.size) for c in one] for one in group] for group in groups), self.reach.shape)


def judged_objective(values: Sequence[Array], weights: Array, form: Form) -> float:
    """Objective from the values of each objective's loads over their references, and the weights.

    ``weighted``: sum of the weighted means over the loads; else the greatest of all, times their weights.
    """
    if form == "weighted":
        return float(sum(w * np.mean(v) for w, v in zip(weights, values, strict=True)))
    return float(max(w * np.max(v) for w, v in zip(weights, values, strict=True)))


@dataclass(frozen=True, eq=False)
class StepAnswer:
    """Answer of a programme."""

    status: str
    step: Array
    objective: float
    violation: float
    multipliers: Array  # fall of the objective if a limit is raised by its own size
    low_multipliers: Array  # (n) fall of the objective if a bound is moved out by one, as ``high``
    high_multipliers: Array

    @property
    def solved(self) -> bool:
        """True if there is a step."""
        return bool(np.isfinite(self.step).all())

    @property
    def merit(self) -> float:
        """Objective with the price of the violation."""
        return self.objective + VIOLATION_PRICE * self.violation


class StepProgramme:
    """Programme for models of one shape."""

    def __init__(self, model: LocalModel, weights: Array, form: Form) -> None:
        import cvxpy as untyped

        cvxpy: Any = untyped
        self._cvxpy = cvxpy
        size = model.size
        self._step = cvxpy.Variable(size)
        self._violation = cvxpy.Variable(max(1, len(model.limits)), nonneg=True)
        self._parameters: list[tuple[Any, Any]] = []
        conditions, terms = [], []
        worst = cvxpy.Variable()
        for weight, composites in zip(weights, model.objectives, strict=True):
            functions = [weight * self._function(composite) for composite in composites]
            terms += [function / len(functions) for function in functions]
            conditions += [function <= worst for function in functions] if form != "weighted" else []
        self._goal = cvxpy.sum(cvxpy.hstack(terms)) if form == "weighted" else worst
        self._margins = cvxpy.Parameter(max(1, len(model.limits)))
        self._kept = [
            [
                self._function(composite) <= 1.0 - self._margins[number] + self._violation[number]
                for composite in composites
            ]
            for number, composites in enumerate(model.limits)
        ]
        self._reach = cvxpy.Parameter(model.reach.shape)
        self._low, self._high = cvxpy.Parameter(size), cvxpy.Parameter(size)
        self._above, self._below = self._step >= self._low, self._step <= self._high
        conditions += [one for kept in self._kept for one in kept]
        conditions += [cvxpy.abs(self._reach @ self._step) <= 1.0, cvxpy.abs(self._step) <= SINGLE_REACH]
        conditions += [self._above, self._below]
        price = VIOLATION_PRICE * cvxpy.sum(self._violation)
        self._problem = cvxpy.Problem(cvxpy.Minimize(self._goal + price), conditions)

    def _function(self, composite: Composite) -> Any:
        level = self._cvxpy.Parameter(composite.level.size)
        slope = self._cvxpy.Parameter(composite.slope.shape)
        self._parameters.append((level, slope))
        return composite.expression(self._cvxpy, level, slope, self._step)

    def solve(self, model: LocalModel, radius: float) -> StepAnswer:
        """Solve the programme of a model within a trust region, by the largest change of the ease-off [um]."""
        # In units of the radius, all numbers are of order one.
        composites = [c for group in (model.objectives, model.limits) for one in group for c in one]
        for composite, (level, slope) in zip(composites, self._parameters, strict=True):
            level.value, slope.value = composite.level, radius * composite.slope
        self._margins.value = np.append(model.margins, [0.0] * (not model.limits))
        self._reach.value = model.reach
        self._low.value, self._high.value = model.low / radius, model.high / radius
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                self._problem.solve(solver="CLARABEL", warm_start=False)  # no trace of earlier ones
            except self._cvxpy.error.SolverError as error:
                return _no_answer(str(error), model)
        if self._step.value is None:
            return _no_answer(str(self._problem.status), model)
        violation = float(np.sum(self._violation.value))
        multipliers = [float(sum(np.sum(one.dual_value) for one in kept)) for kept in self._kept]
        return StepAnswer(
            str(self._problem.status),
            radius * np.asarray(self._step.value, dtype=np.float64),
            float(self._goal.value),
            violation,
            np.array(multipliers),
            np.asarray(self._above.dual_value) / radius,
            np.asarray(self._below.dual_value) / radius,
        )


def _no_answer(status: str, model: LocalModel) -> StepAnswer:
    none, limits = np.full(model.size, np.nan), np.full(len(model.limits), np.nan)
    return StepAnswer(status, none, np.nan, np.nan, limits, none, none)
