"""The pair that a verification puts through the yardsticks: its state in mesh and its analysis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...cases.schema.case_schema import Case
from ...geometry.pair.assembly import Misalignment
from ...geometry.pair.gear_pair import FlankName
from ...study.analysis.contact_analysis import case_torques, contact_analysis
from ...study.analysis.joined_analysis import Analysis
from ...study.case_in_mesh import CaseInMesh
from ..flank_contact.surface_cells import FlanksInMesh, flanks_of

Array = NDArray[Any]


@dataclass(frozen=True)
class VerifiedPair:
    """A case's pair in mesh with its analysis, and what makes others of it.

    Parameters
    ----------
    case
        The checked case.
    flank
        ``drive`` or ``coast``.
    misalignment
        Assembly errors; the case's own if ``None``.
    torques
        Torques at the pinion (t) [N m].

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> pair = VerifiedPair.of(read_case("nasa-12x36"), torques=100.0)
    >>> pair.analysis.tree["loaded"].sizes["torque"]
    1
    """

    case: Case
    flank: FlankName
    misalignment: Misalignment | None
    torques: Array

    @classmethod
    def of(
        cls,
        case: Case,
        flank: FlankName = "drive",
        misalignment: Misalignment | None = None,
        torques: float | Sequence[float] | None = None,
    ) -> VerifiedPair:
        """The pair of a case; arguments as of ``verify``."""
        return cls(case, flank, misalignment, np.sort(case_torques(case, torques)))

    @cached_property
    def state(self) -> CaseInMesh:
        """The pair in mesh."""
        return CaseInMesh.of(self.case, flank=self.flank, misalignment=self.misalignment)

    @cached_property
    def analysis(self) -> Analysis:
        """Its contact analysis."""
        return contact_analysis(self.state, self.torques.tolist())

    @cached_property
    def flanks(self) -> FlanksInMesh:
        """Its generated flanks."""
        return flanks_of(self.state.cycle.geometry)

    def changed(self, table: str, **values: Any) -> VerifiedPair:
        """The same pair with other values in a table of its case."""
        changed = getattr(self.case, table).model_copy(update=values)
        return VerifiedPair(self.case.model_copy(update={table: changed}), self.flank, self.misalignment, self.torques)
