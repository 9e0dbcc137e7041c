"""Convex functions of affine rows: what an analysis yields as its outputs change with the settings to first order.

A peak to peak is the range of the transmission errors of all mesh positions, a greatest pressure the greatest of the
pressures of all segments, a harmonic the norm of its two parts. Made affine is what stands inside, not the function:
the model keeps the corners that a derivative of the whole would cut.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal, get_args

import numpy as np

from ....core.arrays import RealArray as Array, record
from ....core.checks import one_of

Kind = Literal["affine", "greatest", "range", "norm"]
KINDS: tuple[Kind, ...] = get_args(Kind)


@record(frozen=True, eq=False)
class Composite:
    """Function of affine rows (m): the only, the greatest, greatest less least, or root of the sum of squares."""

    kind: Kind
    level: Array
    slope: Array  # (m, n) by the settings

    def __post_init__(self) -> None:
        one_of("kind", self.kind, KINDS)

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

    def per(self, units: Array) -> Composite:
        """The same with its settings (n) in other units, of so much of the present ones each."""
        return replace(self, slope=self.slope * units)

    def expression(self, cvxpy: Any, level: Any, slope: Any, step: Any) -> Any:
        """The same in words of CVXPY, of rows and derivatives that may be parameters."""
        rows = level + slope @ step
        if self.kind == "norm":
            return cvxpy.norm(rows)
        return cvxpy.max(rows) - cvxpy.min(rows) if self.kind == "range" else cvxpy.max(rows)
