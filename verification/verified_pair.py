"""The pair that a verification puts through the yardsticks: its state in mesh and its analysis.

One row of a verification: what was compared with what, how far apart they are, and how far they may be.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..cases.analysis_size import AnalysisSize
from ..cases.conversion import misalignment as case_misalignment
from ..cases.deflection_table import MisalignmentSource, misalignment_of
from ..cases.deflections import misalignment_at
from ..cases.schema.case_schema import Case
from ..core.arrays import Array, record
from ..core.attributes import StoredStatus
from ..core.errors import InputError
from ..geometry.pair.assembly import Misalignment
from ..geometry.pair.gear_pair import FlankName
from ..study.analysis.contact_analysis import Analysis, case_torques, contact_analysis, in_assembly_under_load
from ..study.case_in_mesh import CaseInMesh
from .surface_cells import FlanksInMesh, flanks_of


@record(frozen=True)
class VerifiedPair:
    """A case's pair in mesh with its analysis, and what makes others of it."""

    case: Case
    flank: FlankName
    misalignment: Misalignment
    torques: Array

    @classmethod
    def of(
        cls,
        case: Case,
        flank: FlankName = "drive",
        misalignment: MisalignmentSource | None = None,
        torques: float | Sequence[float] | None = None,
    ) -> VerifiedPair:
        """The pair of a case; arguments and raises as of ``verify``."""
        load = np.sort(case_torques(case, torques))
        AnalysisSize.of(case, load.size).require_memory()
        given = case_misalignment(case.misalignment) if misalignment is None else misalignment_of(misalignment)
        if case.supports is not None:
            deflected = in_assembly_under_load(CaseInMesh.of(case, flank=flank, misalignment=given), load)
            case, given = deflected.case, deflected.misalignment
        misalignments = {misalignment_at(given, torque, flank) for torque in load.tolist()}
        if len(misalignments) > 1:
            raise InputError(
                f"torques = {', '.join(f'{torque:g}' for torque in load)}: must be one where the misalignment depends "
                "on the torque: every torque has its own assembly to verify"
            )
        return cls(case, flank, misalignments.pop(), load)

    @cached_property
    def state(self) -> CaseInMesh:
        """The pair in mesh."""
        return CaseInMesh.of(self.case, flank=self.flank, misalignment=self.misalignment)

    @cached_property
    def analysis(self) -> Analysis:
        """Its contact analysis."""
        return contact_analysis(self.state, self.torques)

    @cached_property
    def flanks(self) -> FlanksInMesh:
        """Its generated flanks."""
        return flanks_of(self.state.cycle.geometry)

    def changed(self, table: str, **values: Any) -> VerifiedPair:
        """The same pair with other values in a table of its case."""
        changed = getattr(self.case, table).model_copy(update=values)
        return VerifiedPair(self.case.model_copy(update={table: changed}), self.flank, self.misalignment, self.torques)


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
