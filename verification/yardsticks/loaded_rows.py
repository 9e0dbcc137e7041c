"""Rows of the loaded contact: gaps of the segments that carry, other solvers on the same contact problems."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...contact.loaded_cases import LoadedCase
from ...contact.solvers import SOLVERS, available_solvers, solve
from ..flank_contact.segment_gap import segment_gaps
from .flank_rows import greatest
from .verification_row import VerificationRow, not_applicable
from .verified_pair import VerifiedPair

GAP_LIMIT = 0.2  # [%], of the rotation
POLISHED_LIMIT = 1e-9  # of the rotation; polished answers agree to rounding
UNPOLISHED_LIMIT = 1e-5  # of the rotation: what interior-point methods leave within their tolerance
GAP_POSITIONS, SOLVER_POSITIONS = 8, 4


def positions(pair: VerifiedPair, count: int) -> list[int]:
    """Evenly spread mesh positions, at most so many.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> positions(VerifiedPair.of(read_case("nasa-12x36")), 4)
    [0, 8, 16, 24]
    """
    number = pair.case.contact.mesh_positions
    return sorted({number * k // count for k in range(min(count, number))})


def cases_at(pair: VerifiedPair, count: int) -> list[LoadedCase]:
    """Solved cases at so many mesh positions, all torques."""
    chosen = set(positions(pair, count))
    return [case for case in pair.analysis.cases if case.mesh_position in chosen]


def certificate_row(pair: VerifiedPair) -> VerificationRow:
    """Mesh positions and torques without a certified solution.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> certificate_row(VerifiedPair.of(read_case("nasa-12x36"), torques=100.0)).difference
    0.0
    """
    status = pair.analysis.tree["loaded"].to_dataset()["status"].values
    failed = float(np.count_nonzero(status))
    return VerificationRow("certificates", f"solutions without one, of {status.size}", failed, 0.0, "1")


def gap_row(pair: VerifiedPair) -> VerificationRow:
    """What errors of the gaps of loaded segments do to the transmission error.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> gap_row(VerifiedPair.of(read_case("nasa-12x36"), torques=100.0)).status.name
    'WITHIN'
    """
    chosen = [case for case in cases_at(pair, GAP_POSITIONS) if case.solution.certified]
    found = [
        segment_gaps(pair.flanks, pair.state.cycle, case).rotation_error / case.solution.rotation for case in chosen
    ]
    compared = f"gaps of the turned flanks where they carry, {len(chosen)} positions and torques"
    return VerificationRow(
        "loaded transmission error by its gaps", compared, 100.0 * greatest(np.array(found)), GAP_LIMIT, "%"
    )


def solver_rows(pair: VerifiedPair, solvers: Sequence[str] | None = None) -> list[VerificationRow]:
    """Rotations by other solvers on the same contact problems, over those of the analysis.

    A row a solver, polished, and one for the least accurate answer that was not.

    Parameters
    ----------
    pair
        The pair.
    solvers
        Names of solvers; all that are installed if left out.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> rows = solver_rows(VerifiedPair.of(read_case("nasa-12x36"), torques=100.0), ["lemke"])
    >>> [(row.quantity, row.status.name) for row in rows]
    [('solver lemke', 'WITHIN'), ('solvers without polish', 'WITHIN')]
    """
    chosen = cases_at(pair, SOLVER_POSITIONS)
    greatest_size = max((case.problem.size for case in chosen), default=0)
    rows, plain = [], []
    for name in available_solvers() if solvers is None else solvers:
        if name == "native":
            continue
        largest = SOLVERS[name].largest if name in SOLVERS else None
        if largest is not None and greatest_size > largest:
            rows.append(not_applicable(f"solver {name}", f"{greatest_size} segments: known to work up to {largest}"))
            continue
        certified, apart = _apart(chosen, name, polish=True)
        compared = f"polished, {certified} of {len(chosen)} contact problems certified"
        rows.append(VerificationRow(f"solver {name}", compared, apart, POLISHED_LIMIT, "1"))
        certified, apart = _apart(chosen, name, polish=False)
        # Without polish a solver may miss its own tolerance, too: such an answer is refused, and nobody gets it.
        if certified:
            plain.append((apart, f"{name}, {certified} of {len(chosen)} contact problems certified"))
    apart, compared = max(plain, default=(float("nan"), "none"))
    if not plain:
        return [*rows, not_applicable("solvers without polish", "no answer of another solver was certified")]
    return [*rows, VerificationRow("solvers without polish", compared, apart, UNPOLISHED_LIMIT, "1")]


def _apart(cases: list[LoadedCase], name: str, *, polish: bool) -> tuple[int, float]:
    """Number of certified answers of a solver, and its greatest difference in the rotation.

    With polish every answer must be certified: NaN if one is not.
    """
    tolerance = SOLVERS[name].tolerance if name in SOLVERS and not polish else None
    found = [solve(case.problem, name, polish=polish, tolerance=tolerance) for case in cases]
    ratios = [one.rotation / case.solution.rotation for one, case in zip(found, cases, strict=True) if one.certified]
    return len(ratios), greatest(np.array(ratios) - 1.0) if len(ratios) == len(cases) or not polish else float("nan")
