"""Gradient of a number read off a solution, with respect to all data of the contact problem."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ....core.checks import frozen_arrays
from ...problem.compliance_matrix import ModalCompliance
from ...problem.contact_problem import ContactProblem

Array = NDArray[np.float64]


@frozen_arrays
@dataclass(frozen=True, eq=False)
class ProblemGradient:
    """Derivatives of a number J by the data; NaN where J has none.

    Attributes
    ----------
    torque
        dJ/dT.
    separation
        dJ/dS (n).
    lever_arm
        dJ/dr (n).
    one_sided
        Whether some segment touches without a force, so that J has a kink here and these are the derivatives on one
        side of it.

    Examples
    --------
    How the rotation of two equal springs depends on the compliance of each:

    >>> from easeoff.contact import ContactProblem, sensitivity, solve
    >>> springs = ContactProblem([0.0, 0.0], [40.0, 40.0], 8e4, ([1e-6, 1e-6], [[0.0], [0.0]]))
    >>> sensitivity(springs, solve(springs)).adjoint(rotation=1.0).local.round(6).tolist()
    [12.5, 12.5]
    """

    torque: float
    separation: Array
    lever_arm: Array
    one_sided: bool
    _problem: ContactProblem = field(repr=False)
    _force: Array = field(repr=False)
    _energy_weight: float = field(repr=False)

    @cached_property
    def compliance(self) -> Array:
        """dJ/dC (n, n), symmetric: for a symmetric change of C, dJ is the sum of its entries times these."""
        product = np.outer(self.separation, self._force)
        return 0.5 * (product + product.T + self._energy_weight * np.outer(self._force, self._force))

    @cached_property
    def local(self) -> Array:
        """dJ/dd (n), where C = diag(d) + V V'; of a dense C the derivatives by its diagonal."""
        return self._force * (self.separation + 0.5 * self._energy_weight * self._force)

    @cached_property
    def factor(self) -> Array | None:
        """dJ/dV (n, k), where C = diag(d) + V V'; None if the compliance is dense."""
        matrix = self._problem.compliance_matrix
        if not isinstance(matrix, ModalCompliance):
            return None
        own = self.separation + self._energy_weight * self._force
        amplitudes = matrix.factor.T @ np.column_stack([self._force, self.separation])
        return np.outer(own, amplitudes[:, 0]) + np.outer(self._force, amplitudes[:, 1])
