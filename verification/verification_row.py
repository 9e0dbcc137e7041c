"""One row of a verification: what was compared with what, how far apart they are, and how far they may be."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..core.attributes import StoredStatus


class RowStatus(StoredStatus):
    """Outcome of a row.

    Examples
    --------
    >>> RowStatus(1).name
    'OUTSIDE'
    """

    WITHIN = 0
    OUTSIDE = 1
    NOT_APPLICABLE = 2


@dataclass(frozen=True)
class VerificationRow:
    """One comparison of a verification.

    Parameters
    ----------
    quantity
        What was checked.
    compared
        With what it was compared, and where the difference is greatest; for a row that is not applicable, why not.
    difference
        Greatest difference; NaN if there is none, which counts as outside.
    limit
        How large it may be.
    unit
        Of difference and limit.
    applicable
        Whether the comparison makes sense for this pair.

    Examples
    --------
    >>> VerificationRow("envelope condition, gear", "cutter by differences, 651 nodes", 2e-11, 1e-9, "mm").status.name
    'WITHIN'
    >>> not_applicable("envelope condition, gear", "the gear is cut without rolling").status.name
    'NOT_APPLICABLE'
    """

    quantity: str
    compared: str
    difference: float
    limit: float
    unit: str
    applicable: bool = True

    @property
    def status(self) -> RowStatus:
        """Within the limit, outside it, or not applicable."""
        if not self.applicable:
            return RowStatus.NOT_APPLICABLE
        return RowStatus.WITHIN if abs(self.difference) <= self.limit else RowStatus.OUTSIDE


def not_applicable(quantity: str, reason: str) -> VerificationRow:
    """A row for a comparison that makes no sense for this pair."""
    return VerificationRow(quantity, reason, math.nan, math.nan, "", applicable=False)
