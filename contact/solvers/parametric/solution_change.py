"""Derivative of a solution in one direction of its data, and what derivatives a solution has."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....core.attributes import StoredStatus
from ....core.checks import frozen_arrays

Array = NDArray[np.float64]


class Differentiability(StoredStatus):
    """What derivatives a solution has.

    Examples
    --------
    >>> Differentiability(1).name
    'ONE_SIDED'
    """

    DIFFERENTIABLE = 0
    ONE_SIDED = 1
    FORCES_NOT_UNIQUE = 2


@frozen_arrays
@dataclass(frozen=True, eq=False)
class SolutionChange:
    """Derivative of a solution in one direction of its data; NaN where there is none.

    Attributes
    ----------
    force
        dF (n) [N].
    rotation
        dtheta [rad].
    gap
        dY (n) [mm].
    energy
        Change of the deformation energy 1/2 F'CF [N mm].
    active
        Segments that touch just beyond, in this direction (n).
    one_sided
        Whether the derivative holds in this direction alone, and not against it.
    message
        Why there is none, if so.

    Examples
    --------
    The second of two springs is about to touch: turning on, it carries half; turning back, nothing.

    >>> from easeoff.contact import ContactProblem, sensitivity, solve
    >>> springs = ContactProblem([0.0, 1e-3], [40.0, 40.0], 4e4, np.diag([1e-6, 1e-6]))
    >>> slope = sensitivity(springs, solve(springs))
    >>> [slope.forward(torque=sign * 80.0).force.round(6).tolist() for sign in (1.0, -1.0)]
    [[1.0, 1.0], [-2.0, 0.0]]
    """

    force: Array
    rotation: float
    gap: Array
    energy: float
    active: NDArray[np.bool_]
    one_sided: bool
    message: str = ""
