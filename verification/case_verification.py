"""Verification of a case: its pair put through the independent methods, one row a comparison.

The table is text, row by row, with widths that do not depend on the rows that come. Of a row outside its limit a line
says what that means, and what to do.
"""

from __future__ import annotations

import math
import textwrap
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
from . import loaded_rows
from .flank_contact import FlankContact
from .geometry_rows import conventional_rows, flank_rows, smallest_gap_rows
from .loaded_rows import UnsplitContact
from .verified_pair import RowStatus, VerificationRow, VerifiedPair, not_applicable

REPORT_IT = "report it with the case file"
FINER_GRID = "try more lengthwise_nodes and profile_nodes"
#: Beginnings of rows that compare contact lines one by one; the largest differences are near the ends of the path.
LINE_ROWS = ("relative curvature", "direction of the contact line", "length of the contact line")
#: By the beginning of a row's quantity. {0} stands for the difference, {1} for half of it, each with its unit.
MEANINGS = {
    "certificates": "at these positions there is no result; try another --solver, or less torque",
    "flank position": f"the flank is off by {{0}} from what the settings cut; {REPORT_IT}",
    "flank normal": f"the flank is off by {{0}} from what the settings cut; {REPORT_IT}",
    "envelope condition": f"the flank is off by up to {{0}} from what the settings cut; {REPORT_IT}",
    "principal curvatures": f"curvatures, and with them pressures, are off by this part; {REPORT_IT}",
    "conventional analysis": "for these rotations the other method found no contact; look at the ease-off first",
    "transmission error of a tooth pair": f"the unloaded transmission error may be off by {{0}}; {FINER_GRID}",
    "path of contact": f"the path of contact may be off by {{0}}, transmission errors hardly; {FINER_GRID}",
    "relative curvature": "pressures may be off by about half of it, {1}; transmission error and load shares are not "
    "affected",
    "direction of the contact line": f"the lines may be turned by {{0}}, pressures at their ends most; {FINER_GRID}",
    "length of the contact line": f"lengths of the unloaded pattern may be off by {{0}}; {FINER_GRID}",
    "unloaded transmission error": f"it may be off by {{0}} where an edge touches; {FINER_GRID}",
    "loaded transmission error by its gaps": "it may be off by {0}; try more segments_per_line, see edges in the notes",
    "solver": "the other solver, not the result, is off, as its answers are less exact: do not choose it for this pair",
    "contact without the split": "the elastic model may be off by {0} in this number; compare compliance model 'fe'",
    "transmission error": "the elastic model may be off by {0} in this number; compare compliance model 'fe'",
    "load share of a tooth pair": "the elastic model may be off by {0} in this number; compare compliance model 'fe'",
    "greatest line load": "line loads may be off by {0}, pressures by half of it; most where edges carry",
    "grid of the flank": "numbers of this kind may be off by {0}; set more lengthwise_nodes and profile_nodes",
    "segments of a line": "numbers of this kind may be off by {0}; set more segments_per_line under [contact]",
    "mesh positions": "numbers of this kind may be off by {0}; set more mesh_positions under [contact]",
    "fineness of the teeth": "numbers of this kind may be off by {0}; set a greater fineness under [compliance]",
    "shell modes": "numbers of this kind may be off by {0}; set more modes under [compliance]",
}


def closing(outside: Sequence[VerificationRow]) -> str:
    """Meaning of these rows alone being outside their limits; empty if their own meanings say it."""
    if not outside or not all(row.quantity.startswith(LINE_ROWS) for row in outside):
        return ""
    return (
        "these are curvature and direction of contact lines, farthest off near the ends of the path: pressures may be "
        "off there as told above, transmission error and load shares are not"
    )


def meaning(row: VerificationRow) -> str:
    """Meaning of a row outside its limit; empty for one that is not."""
    if row.status != RowStatus.OUTSIDE:
        return ""
    if math.isnan(row.difference):
        return "the other method found no answer for this pair, so this is not checked"
    unit = "" if row.unit == "1" else f" {row.unit}"
    whole, half = (f"{abs(value):.2g}{unit}" for value in (row.difference, 0.5 * row.difference))
    beginning = max((start for start in MEANINGS if row.quantity.startswith(start)), key=len, default="")
    return MEANINGS.get(beginning, "numbers of this kind may be off by {0}").format(whole, half)


HEADS = ("quantity", "compared with", "difference", "limit", "unit", "within")
WIDTHS = (36, 46, 10, 7, 4, 6)  # characters
GAP = "  "
WORDS = {RowStatus.WITHIN: "yes", RowStatus.OUTSIDE: "NO", RowStatus.NOT_APPLICABLE: "-"}


def cells(row: VerificationRow) -> tuple[str, ...]:
    """Cells of a row."""
    if not row.applicable:
        return row.quantity, f"not applicable: {row.compared}", "", "", "", WORDS[row.status]
    unit, difference = "" if row.unit == "1" else row.unit, difference_text(row.difference, row.limit)
    return row.quantity, row.compared, difference, f"{row.limit:.2g}", unit, WORDS[row.status]


def difference_text(difference: float, limit: float) -> str:
    """A difference, to as many digits as tell it from its limit."""
    text = f"{difference:.2g}"
    for digits in range(3, 6):
        if difference <= limit or float(text) > limit:
            break
        text = f"{difference:.{digits}g}"
    return text


def head_lines() -> str:
    """Heads of the table, underlined."""
    return f"{_line(HEADS)}\n{GAP.join('-' * width for width in WIDTHS)}"


def row_lines(row: VerificationRow) -> str:
    """Lines of a row, with its meaning if it is outside its limit."""
    columns = cells(row)
    wrapped = [textwrap.wrap(cell, width) or [""] for cell, width in zip(columns, WIDTHS, strict=True)]
    height = max(map(len, wrapped))
    lines = [_line([cell[at] if at < len(cell) else "" for cell in wrapped]) for at in range(height)]
    if said := meaning(row):
        width = sum(WIDTHS) + len(GAP) * (len(WIDTHS) - 1)
        lines += textwrap.wrap(f"-> {said}", width, initial_indent=GAP, subsequent_indent=" " * 5)
    return "\n".join(lines)


def _line(texts: Sequence[str]) -> str:
    return GAP.join(text.ljust(width) for text, width in zip(texts, WIDTHS, strict=True)).rstrip()


Step = tuple[str, Callable[[], list[VerificationRow]]]


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
        """True if every row that applies is within its limit."""
        return not self.outside

    def dataset(self) -> xr.Dataset:
        """The rows as a dataset over ``comparison``.

        Examples
        --------
        >>> rows = (VerificationRow("path", "another method", 1.0, 2.0, "um"), not_applicable("modes", "no shell"))
        >>> Verification("a pair", "drive", rows).dataset()["comparison_status"].values.tolist()
        [0, 2]
        """
        kinds = {"quantity": str, "compared": str, "difference_unit": str, "difference": float, "limit": float}
        given = {name: [getattr(row, name.removeprefix("difference_")) for row in self.rows] for name in kinds}
        data: dict[str, Any] = {name: ("comparison", np.array(given[name], dtype=kind)) for name, kind in kinds.items()}
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
    progress: Callable[[int, int, str], None] | None = None,
    on_row: Callable[[VerificationRow], None] | None = None,
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
    >>> verification = verify(case.model_copy(update={"contact": contact, "compliance": shells}), torques=250.0)
    >>> verification.passed, [row.quantity for row in verification.outside][0]
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
        steps.append((name, lambda: list(loaded_rows.unsplit_rows(contact, solutions))))
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
    yield ANALYSIS, lambda: [loaded_rows.certificate_row(pair)]
    for member in ("pinion", "gear"):
        yield f"flank of the {member}", partial(_flank_rows, pair, member)
    yield "conventional contact analysis", lambda: conventional_rows(pair)
    yield "smallest gap", lambda: smallest_gap_rows(pair)
    yield "gaps of loaded segments", lambda: [loaded_rows.gap_row(pair)]
    yield "solvers", lambda: loaded_rows.solver_rows(pair)
    for refinement in loaded_rows.refinements(pair.case):
        yield f"convergence, {refinement.name}", partial(loaded_rows.convergence_rows, pair, refinement)


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
