"""Outcomes that results store as numbers and names: ends of solves and of contact lines, violations of a certificate.

They stand by themselves, so that a result is read, shown and drawn without what solves its problems.
"""

from __future__ import annotations

from ..core.attributes import StoredStatus

#: Violations of a certificate, in its order.
CERTIFICATE_FIELDS = ("equilibrium", "negative_force", "negative_gap", "complementarity", "duality_gap")


class Status(StoredStatus):
    """End of a solve. Only `CERTIFIED` comes with forces.

    Examples
    --------
    >>> Status(0).name, Status.TIME_LIMIT.value
    ('CERTIFIED', 7)
    """

    CERTIFIED = 0
    NOT_CERTIFIED = 1
    INFEASIBLE = 2
    UNBOUNDED = 3
    NOT_POSITIVE_SEMIDEFINITE = 4
    INVALID_DATA = 5
    SOLVER_FAILED = 6
    TIME_LIMIT = 7
    NOT_CONVERGED = 8


class LineEnd(StoredStatus):
    """Border of the common flank at which a contact line ends near a segment, or none."""

    INSIDE = 0
    GEAR_TOE = 1
    GEAR_HEEL = 2
    GEAR_ROOT = 3
    GEAR_TIP = 4
    PINION_TOE = 5
    PINION_HEEL = 6
    PINION_ROOT = 7
    PINION_TIP = 8
    FILLET = 9
    UNKNOWN = 10
