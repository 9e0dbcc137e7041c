"""Convex programme of one step: objectives and limits as composites, the step within a trust region.

Limits may be passed at a price, so that the programme always has an answer. It is compiled once for rows of one shape;
rows, derivatives, bounds and trust region are its parameters.

Composites are convex functions of affine rows: what an analysis yields as its outputs change with the settings to first
order. A peak to peak is the range of the transmission errors of all mesh positions, a greatest pressure the greatest of
the pressures of all segments, a harmonic the norm of its two parts. Made affine is what stands inside, not the
function: the model keeps the corners that a derivative of the whole would cut.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

import numpy as np

from ....core.arrays import RealArray as Array, record
from ....core.checks import check_fields

Kind = Literal["affine", "greatest", "range", "norm"]
KINDS: tuple[Kind, ...] = get_args(Kind)
Form = Literal["weighted", "worst", "pareto"]
FORMS: tuple[Form, ...] = get_args(Form)

#: Price of passing a limit, per share of it, in units of the objective, which is about one at the start.
VIOLATION_PRICE = 10.0
#: Share of a limit by which a programme stays below it for what is lost by linearising; to which rounding adds its own.
LIMIT_MARGIN = 2e-3
#: Largest change of the ease-off by one setting alone, over the largest one by all together.
SINGLE_REACH = 20.0


@record(frozen=True, eq=False)
class Composite:
    """Function of affine rows (m): the only, the greatest, greatest less least, or root of the sum of squares."""

    kind: Kind
    level: Array
    slope: Array  # (m, n) by the settings

    def __post_init__(self) -> None:
        check_fields(self)

    def value(self, step: Array | None = None) -> float:
        """Value after a step (n) of the settings; at the present ones without."""
        rows = self.level if step is None else self.level + self.slope @ step
        if self.kind == "norm":
            return float(np.sqrt(np.sum(rows**2)))
        return float(rows.max() - rows.min()) if self.kind == "range" else float(rows.max())

    def rise(self, change: Array | float) -> float:
        """Its usual rise if the settings change independently by so much each (n): root sum of squares of every row."""
        spread = np.linalg.norm(self.slope * change, axis=1)
        if self.kind == "norm":
            return float(np.linalg.norm(spread))
        top = float((self.level + spread).max() - self.level.max())
        return top + float(self.level.min() - (self.level - spread).min()) if self.kind == "range" else top

    def scaled(self, factor: float, added: float = 0.0) -> Composite:
        """The same times a positive factor; of an affine one also with a number added, and of either sign."""
        return replace(self, level=factor * self.level + added, slope=factor * self.slope)

    def expression(self, cvxpy: Any, level: Any, slope: Any, step: Any) -> Any:
        """The same in words of CVXPY, of rows and derivatives that may be parameters."""
        rows = level + slope @ step
        if self.kind == "norm":
            return cvxpy.norm(rows)
        return cvxpy.max(rows) - cvxpy.min(rows) if self.kind == "range" else cvxpy.max(rows)


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
            [self._function(one) <= 1.0 - self._margins[number] + self._violation[number] for one in composites]
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
        multipliers = [float(sum(np.sum(one.dual_value) for one in kept)) for kept in self._kept]
        return StepAnswer(
            str(self._problem.status),
            radius * np.asarray(self._step.value, dtype=np.float64),
            float(self._goal.value),
            float(np.sum(self._violation.value)),
            np.array(multipliers),
            np.asarray(self._above.dual_value) / radius,
            np.asarray(self._below.dual_value) / radius,
        )


def _no_answer(status: str, model: LocalModel) -> StepAnswer:
    none, limits = np.full(model.size, np.nan), np.full(len(model.limits), np.nan)
    return StepAnswer(status, none, np.nan, np.nan, limits, none, none)
