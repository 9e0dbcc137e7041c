"""Units in which the numbers of a contact problem are of order one, and in which no bit of them is lost.

Unlike the scaling for solvers (`scaling`), units change neither the zero of the rotation nor any separation: the
problem can be had back to the bit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..contact_problem import ContactProblem

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ProblemUnits:
    """Units of force [N], compliance [mm/N] and lever arm [mm] for the numbers of a problem, powers of two."""

    force: float = 1.0
    compliance: float = 1.0  # [mm/N], a power of four: its root is the unit of V
    lever_arm: float = 1.0

    @property
    def gap(self) -> float:
        """Of separations and gaps [mm]."""
        return self.force * self.compliance

    @property
    def rotation(self) -> float:
        """Of rotations [rad]."""
        return self.gap / self.lever_arm

    @classmethod
    def of(cls, problem: ContactProblem) -> ProblemUnits:
        """Units in which the numbers of a problem are of order one; mm and N where those would lose a bit."""
        scale = problem.scaling
        exponent = math.frexp(scale.compliance)[1] - 1
        units = cls(scale.force, math.ldexp(1.0, exponent - exponent % 2), scale.lever_arm)
        given = problem_data(problem)
        with np.errstate(over="ignore", under="ignore", invalid="ignore"):
            back = units.restored(*units.changed(*given))
            exact = all(np.array_equal(a, b) for a, b in zip(_flat(back), _flat(given), strict=True))
        return units if exact else cls()

    def changed(self, separation: Array, lever_arm: Array, torque: float, compliance: Any) -> tuple[Any, ...]:
        """Return the data of a problem in these units."""
        return (
            separation / self.gap, lever_arm / self.lever_arm, torque / self.lever_arm / self.force,
            _scaled(compliance, 1.0 / self.compliance),
        )  # fmt: skip

    def restored(self, separation: Array, lever_arm: Array, torque: float, compliance: Any) -> tuple[Any, ...]:
        """Return data in these units in mm and N."""
        return (
            separation * self.gap, lever_arm * self.lever_arm, torque * self.lever_arm * self.force,
            _scaled(compliance, self.compliance),
        )  # fmt: skip


def problem_data(problem: ContactProblem) -> tuple[Array, Array, float, Any]:
    """Return separation, lever arm, torque and compliance as it was given."""
    compliance = problem.compliance if isinstance(problem.compliance, tuple) else problem.dense_compliance
    return problem.separation, problem.lever_arm, problem.torque, compliance


def _scaled(compliance: Any, factor: float) -> Any:
    """A compliance, matrix or pair, times a power of four."""
    if isinstance(compliance, tuple):
        return compliance[0] * factor, compliance[1] * math.sqrt(factor)
    return compliance * factor


def _flat(data: tuple[Any, ...]) -> list[Any]:
    return [*data[:3], *(data[3] if isinstance(data[3], tuple) else data[3:])]
