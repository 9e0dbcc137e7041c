"""Units in which the numbers of a contact problem are of order one, and in which no bit of them is lost.

Unlike the scaling for solvers (`scaling`), units change neither the zero of the rotation nor any separation: the
problem can be had back to the bit.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..contact_problem import ContactProblem, problem_numbers


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
        numbers = problem_numbers(problem)
        with np.errstate(over="ignore", under="ignore", invalid="ignore"):
            back = units.restored(units.changed(numbers))
            exact = all(np.array_equal(back[name], values) for name, values in numbers.items())
        return units if exact else cls()

    def changed(self, numbers: Mapping[str, Any]) -> dict[str, Any]:
        """Return the numbers of a problem, see `problem_numbers`, in these units."""
        return {name: values / self._of[name] for name, values in numbers.items()}

    def restored(self, numbers: Mapping[str, Any]) -> dict[str, Any]:
        """Return numbers in these units in mm and N."""
        return {name: values * self._of[name] for name, values in numbers.items()}

    @property
    def _of(self) -> dict[str, float]:
        return {
            "separation": self.gap,
            "lever_arm": self.lever_arm,
            "torque": self.lever_arm * self.force,
            "compliance": self.compliance,
            "compliance_diagonal": self.compliance,
            "compliance_factor": math.sqrt(self.compliance),
        }
