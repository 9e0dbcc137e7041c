"""Scaled answer: forces and rotation of a contact problem in scaled numbers, not yet certified."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .solution import CallTimes, Status


@dataclass(frozen=True, eq=False, slots=True)
class ScaledAnswer:
    """An answer to a `ScaledProblem`, not yet certified.

    Attributes
    ----------
    force
        Of every segment (n).
    rotation
        Beyond first contact.
    iterations
        -1 if unknown.
    message
        The solver's own message.
    suspicion
        Status that the solver reports; used only if the certificate refuses the answer.
    gap
        Multipliers of the bounds (n), as the solver gave them, in the sign of gaps. Only for comparison: the gaps
        of a solution are computed from its forces.
    times
        Times of the call, where they were taken.
    """

    force: NDArray[np.float64]
    rotation: float
    iterations: int
    message: str = ""
    suspicion: Status | None = None
    gap: NDArray[np.float64] | None = None
    times: CallTimes | None = None
