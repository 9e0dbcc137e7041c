"""Verification of a case: its pair put through the independent methods, one row a comparison."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ..cases.deflection_table import MisalignmentSource
from ..cases.schema.case_schema import Case
from ..core.attributes import labelled
from ..core.checks import instance, truth
from ..core.errors import EaseoffError
from ..geometry.pair.gear_pair import FlankName
from ..study.case_in_mesh import checked_case
from .flank_contact.flank_contact import FlankContact
from .yardsticks.convergence_rows import convergence_rows, refinements
from .yardsticks.flank_rows import flank_rows
from .yardsticks.loaded_rows import certificate_row, gap_row, solver_rows
from .yardsticks.unloaded_rows import conventional_rows, smallest_gap_rows
from .yardsticks.unsplit_rows import UnsplitContact, unsplit_rows
from .yardsticks.verification_row import RowStatus, VerificationRow, not_applicable
from .yardsticks.verification_table import head_lines, row_lines
from .yardsticks.verified_pair import VerifiedPair

Step = tuple[str, Callable[[], list[VerificationRow]]]
Progress = Callable[[int, int, str], None]
RowSeen = Callable[[VerificationRow], None]


@dataclass(frozen=True)
class Verification:
    """Rows of a verified case.

    Parameters
    ----------
    title
        Of the case.
    flank
        ``drive`` or ``coast``.
    rows
        One a comparison.

    Examples
    --------
    >>> Verification("a pair", "drive", (VerificationRow("path", "another method", 1.0, 2.0, "um"),)).passed
    True
    """

    title: str
    flank: str
    rows: tuple[VerificationRow, ...]

    @property
    def outside(self) -> list[VerificationRow]:
        """Rows outside their limits."""
        return [row for row in self.rows if row.status == RowStatus.OUTSIDE]

    @property
    def passed(self) -> bool:
        """Whether every row that applies is within its limit."""
        return not self.outside

    def dataset(self) -> xr.Dataset:
        """The rows as a dataset over ``comparison``.

        Examples
        --------
        >>> rows = (VerificationRow("path", "another method", 1.0, 2.0, "um"), not_applicable("modes", "no shell"))
        >>> Verification("a pair", "drive", rows).dataset()["comparison_status"].values.tolist()
        [0, 2]
        """
        names = {"quantity": "quantity", "compared": "compared", "difference_unit": "unit"}
        data: dict[str, Any] = {
            name: ("comparison", np.array([getattr(row, own) for row in self.rows], dtype=str))
            for name, own in names.items()
        }
        data |= {
            name: ("comparison", np.array([getattr(row, name) for row in self.rows], dtype=float))
            for name in ("difference", "limit")
        }
        status = np.array([row.status for row in self.rows], dtype=np.int8)
        data["comparison_status"] = ("comparison", status, RowStatus.flag_attributes())
        attributes = {"Conventions": "CF-1.11", "title": f"{self.title}: verification", "flank": self.flank}
        return labelled(xr.Dataset(data, attrs=attributes))

    def table(self) -> str:
        """The rows as a table of text, with what those outside their limits mean.

        Examples
        --------
        >>> rows = (VerificationRow("path", "another method", 1.0, 2.0, "um"),)
        >>> print(Verification("a pair", "drive", rows).table().splitlines()[-1].split())
        ['path', 'another', 'method', '1', '2', 'um', 'yes']
        """
        return "\n".join([head_lines(), *map(row_lines, self.rows)])


def verify(
    case: Case | str | Path,
    *,
    flank: FlankName = "drive",
    misalignment: MisalignmentSource | None = None,
    torques: float | Sequence[float] | None = None,
    without_split: bool = False,
    progress: Progress | None = None,
    on_row: RowSeen | None = None,
) -> Verification:
    """Put the pair of a case through the independent methods.

    Parameters
    ----------
    case
        A checked case, or what ``read_case`` takes.
    flank, misalignment, torques
        As of ``analyze``. Where the misalignment depends on the torque, one torque at a time: the pair is verified in
        its assembly there.
    without_split
        Whether to solve the contact without the split into bending and indentation at some mesh positions, too; it
        takes minutes.
    progress
        Called before every step with its number, the number of steps, and its name; at the end once more.
    on_row
        Called with every row as soon as it is known.

    Raises
    ------
    InputError, GeometryError
        As ``analyze``.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 5, "edge_contact": False}
    >>> case = read_case("nasa-12x36")
    >>> contact, shells = (
    ...     case.contact.model_copy(update=coarse),
    ...     case.compliance.model_copy(update={"model": "shell"}),
    ... )
    >>> found = verify(case.model_copy(update={"contact": contact, "compliance": shells}), torques=250.0)
    >>> found.passed, [row.quantity for row in found.outside][0]
    (False, 'segments of a line: other numbers')
    """
    truth("without_split", without_split)
    instance("progress", progress, Callable | None)
    instance("on_row", on_row, Callable | None)
    pair = VerifiedPair.of(checked_case(case), flank, misalignment, torques)
    steps = list(_steps(pair))
    solutions: dict[tuple[int, int], FlankContact] = {}
    contact = UnsplitContact(pair)
    name = "contact without the split"
    if without_split:
        steps.append((f"{name}: bodies of the teeth", partial(_prepared, contact)))
        steps += [(name, partial(_solved, contact, place, solutions)) for place in contact.places]
        steps.append((name, lambda: list(unsplit_rows(contact, solutions))))
    rows: list[VerificationRow] = []
    for number, (label, step) in enumerate(steps):
        if progress is not None:
            progress(number, len(steps), label)
        for row in step() if label == ANALYSIS else _rows(label, step):
            rows.append(row)
            if on_row is not None:
                on_row(row)
    if progress is not None:
        progress(len(steps), len(steps), "")
    if not without_split:
        rows.append(not_applicable(name, "not asked for, see --without-split"))
        if on_row is not None:
            on_row(rows[-1])
    return Verification(pair.case.title, flank, tuple(rows))


ANALYSIS = "analysis"


def _steps(pair: VerifiedPair) -> Iterator[Step]:
    """Names and functions of the steps, the analysis first."""
    yield ANALYSIS, lambda: [certificate_row(pair)]
    for member in ("pinion", "gear"):
        yield f"flank of the {member}", partial(_flank_rows, pair, member)
    yield "conventional contact analysis", lambda: conventional_rows(pair)
    yield "smallest gap", lambda: smallest_gap_rows(pair)
    yield "gaps of loaded segments", lambda: [gap_row(pair)]
    yield "solvers", lambda: solver_rows(pair)
    for refinement in refinements(pair.case):
        yield f"convergence, {refinement.name}", partial(convergence_rows, pair, refinement)


def _flank_rows(pair: VerifiedPair, member: str) -> list[VerificationRow]:
    section = getattr(pair.state.pair, member).section
    return flank_rows(member, getattr(pair.state.cycle.geometry.members, member), section)


def _rows(label: str, step: Callable[[], list[VerificationRow]]) -> list[VerificationRow]:
    """Rows of a step; one that gives up counts as a difference without a number."""
    try:
        return step()
    except EaseoffError as error:
        return [VerificationRow(label, f"gave up: {error}", float("nan"), 0.0, "1")]


def _prepared(contact: UnsplitContact) -> list[VerificationRow]:
    _ = contact.responses
    return []


def _solved(
    contact: UnsplitContact, place: tuple[int, int], solutions: dict[tuple[int, int], FlankContact]
) -> list[VerificationRow]:
    solutions[place] = contact.solved(*place)
    return []
