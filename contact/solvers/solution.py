"""What a solver hands back: the answer, its certificate, and an honest status."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...core.stored_status import StoredStatus
from ..problem.certificate import NO_CERTIFICATE, Certificate


class Status(StoredStatus):
    """How a solve ended. Only `CERTIFIED` comes with forces."""

    CERTIFIED = 0
    NOT_CERTIFIED = 1
    INFEASIBLE = 2
    UNBOUNDED = 3
    NOT_POSITIVE_SEMIDEFINITE = 4
    INVALID_DATA = 5
    SOLVER_FAILED = 6
    TIME_LIMIT = 7
    NOT_CONVERGED = 8


@dataclass(frozen=True, eq=False)
class ContactSolution:
    """Forces, rotation and gaps of one contact problem, with proof.

    Attributes
    ----------
    force : (n) array
        Normal forces [N]; NaN unless the status is `CERTIFIED`.
    rotation : float
        Rotation of the gear [rad]; NaN unless certified.
    gap : (n) array
        Gaps left under load [mm]; NaN unless certified.
    status : Status
    solver : str
        Name of the solver that was used.
    iterations : int
        Its iterations; -1 where it does not tell.
    certificate : Certificate
        Of the answer, also of one that was refused.
    elastic_rotation : float
        Rotation beyond the first contact of the rigid bodies [rad], free of the cancellation in the difference.
    polished : bool
        Whether the answer was made exact by solving on the active set that the solver had found.
    tolerance : float
        What the certificate had to reach.
    message : str
        A few words on what happened, for people.
    """

    force: NDArray[np.float64]
    rotation: float
    gap: NDArray[np.float64]
    status: Status
    solver: str
    iterations: int
    certificate: Certificate
    elastic_rotation: float
    polished: bool = False
    tolerance: float = 0.0
    message: str = ""

    @property
    def certified(self) -> bool:
        """Whether the answer is proved."""
        return self.status is Status.CERTIFIED

    @property
    def active(self) -> NDArray[np.bool_]:
        """Segments that carry load, (n): the warm start of a neighbouring problem."""
        return self.force > 0.0


def no_solution(
    size: int,
    status: Status,
    solver: str,
    *,
    message: str = "",
    iterations: int = -1,
    certificate: Certificate = NO_CERTIFICATE,
    tolerance: float = 0.0,
) -> ContactSolution:
    """Return the record of a solve without an answer: NaN forces, and the reason."""
    nothing = np.full(size, np.nan)
    return ContactSolution(
        force=nothing,
        rotation=np.nan,
        gap=nothing.copy(),
        status=status,
        solver=solver,
        iterations=iterations,
        certificate=certificate,
        elastic_rotation=np.nan,
        tolerance=tolerance,
        message=message,
    )
