"""Deviations as a table of numbers without points: a row of the measuring grid a line, or a column.

Comment lines before the table say what it holds; nothing is guessed:

- ``# flank: concave`` or ``convex``
- ``# rows: root to tip`` and ``# columns: toe to heel``, either the other way round, or rows and columns exchanged
- ``# deviation_unit: um`` or ``mm``
- ``# margin_toe_mm: 3.0`` and so on for heel, root and tip, where the margins are not those of ``cmm_points``
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ...core.checks import array, frozen_arrays, one_of, shown
from ...core.errors import InputError
from ..pair.gear_pair import Member
from ..tooth.tooth_flanks import side
from .csv_points import require_size
from .measuring_points import EdgeMargins, cmm_points
from .separated_text import Attributes, cells, comment, excerpt, parted, separator

UPWARDS, LENGTHWISE = ("root to tip", "tip to root"), ("toe to heel", "heel to toe")
WANTED = {
    "flank": ("concave", "convex"),
    "rows": (*UPWARDS, *LENGTHWISE),
    "columns": (*LENGTHWISE, *UPWARDS),
    "deviation_unit": ("um", "mm"),
}
EDGES = ("toe", "heel", "root", "tip")


@frozen_arrays
@dataclass(frozen=True, eq=False)
class DeviationTable:
    """Table of deviations."""

    deviation: NDArray[np.float64]  # (root to tip, toe to heel) [um]
    flank: str
    margins: EdgeMargins
    source: str

    def points(self, member: Member) -> xr.Dataset:
        """Nominal points of the table on its flank of a member, where ``easeoff export`` has them."""
        if self.flank != side(member.loaded):
            if member.opposite is None:
                known = side(member.loaded)
                raise InputError(
                    f"{self.source}: flank = {self.flank!r}: must be {known!r}, the one given for this member"
                )
            member = member.from_opposite
        rows, columns = self.deviation.shape
        margins = self.margins
        if member.opposite is not None:
            # As exported, both flanks have one grid; the thickness of the tooth does not matter to its margins.
            both = cmm_points(member, rows, columns, margins, tooth_angle=np.pi / member.teeth)
            margins = EdgeMargins(**{edge: both.attrs[f"margin_{edge}_mm"] for edge in EDGES})
        return cmm_points(member, rows, columns, margins)


def is_table(content: str) -> bool:
    """True if the first line that is no comment holds numbers, and is neither a point nor column names."""
    lines = [line for line in content.splitlines() if line.strip(' \t;,"') and comment(line) is None]
    first = cells(lines[0], separator(lines[0])) if lines else []
    return first[:1] not in (["concave"], ["convex"]) and any(_is_number(cell, finite=False) for cell in first)


def parsed_table(content: str, source: str) -> DeviationTable:
    """Table of a text file, whose comments must say what it holds; a bad line is refused with its number."""
    attributes, lines = parted(content, source)
    first, head = lines[0]
    mark = separator(head)
    require_size(len(lines), len(cells(head, mark)), source)
    rows = [cells(line, mark) for _, line in lines]
    for (number, line), row in zip(lines, rows, strict=True):
        if len(row) != len(rows[0]):
            expected = f"{len(row)} values, expected {len(rows[0])} as in line {first}"
            raise InputError(f"{source}, line {number}: {excerpt(line)}: {expected}")
        for cell in row:
            if not _is_number(cell):
                raise InputError(f"{source}, line {number}: {shown(cell)}: must be a finite number")
    missing = [
        f"'# {key}: {first_choice}' (or {', '.join(others)})"
        for key, (first_choice, *others) in WANTED.items()
        if key not in attributes
    ]
    if missing:
        raise InputError(
            f"{source}, line {first}: {excerpt(head)}: numbers in {len(rows)} rows and {len(rows[0])} columns, without "
            f"points. If they are deviations at the points of 'easeoff export', say in lines before them what they "
            f"are: {'; '.join(missing)}. Or give the points, too, with a column 'deviation'"
        )
    for key, allowed in WANTED.items():
        one_of(f"{source}: {key}", attributes[key], allowed)
    if mark == "," and not any("." in cell for row in rows for cell in row):
        raise InputError(
            f"{source}, line {first}: {excerpt(head)}: whole numbers, or decimal commas? Write decimal points, or "
            "separate the columns by semicolons"
        )
    deviation = np.array(rows, dtype=float) * (1e3 if attributes["deviation_unit"] == "mm" else 1.0)
    deviation = _oriented(deviation, attributes["rows"], attributes["columns"], source)
    return DeviationTable(deviation, attributes["flank"], _margins(attributes), source)


def table_of_matrix(
    deviation: ArrayLike,
    flank: str,
    *,
    rows: str = UPWARDS[0],
    columns: str = LENGTHWISE[0],
    deviation_unit: str = "um",
    margins: EdgeMargins | None = None,
) -> DeviationTable:
    """Table of a plain matrix of deviations, positive for more metal, in ``deviation_unit``: ``um`` or ``mm``.

    ``rows`` and ``columns`` are ``root to tip`` or ``tip to root``, and ``toe to heel`` or ``heel to toe``; they may be
    exchanged.
    """
    given = {"flank": flank, "rows": rows, "columns": columns, "deviation_unit": deviation_unit}
    for key, allowed in WANTED.items():
        one_of(key, given[key], allowed)
    values = array("matrix of deviations", deviation, deviation_unit, ndim=2, anything=True)
    require_size(values.shape[0], values.shape[1], "matrix of deviations")
    values = _oriented(values * (1e3 if deviation_unit == "mm" else 1.0), rows, columns, "matrix of deviations")
    return DeviationTable(values, flank, margins or EdgeMargins(), "matrix of deviations")


def _oriented(deviation: NDArray[np.float64], rows: str, columns: str, source: str) -> NDArray[np.float64]:
    """Deviations with rows from root to tip and columns from toe to heel."""
    if (rows in UPWARDS) == (columns in UPWARDS):
        raise InputError(f"{source}: rows = {rows!r}, columns = {columns!r}: must be one along the flank and one up it")
    if rows in LENGTHWISE:
        deviation, rows, columns = deviation.T, columns, rows
    return np.ascontiguousarray(deviation[:: 1 if rows == UPWARDS[0] else -1, :: 1 if columns == LENGTHWISE[0] else -1])


def _margins(attributes: Attributes) -> EdgeMargins:
    return EdgeMargins(**{edge: attributes.get(f"margin_{edge}_mm") for edge in EDGES})


def _is_number(cell: str, *, finite: bool = True) -> bool:
    try:
        return bool(np.isfinite(float(cell))) or not finite
    except ValueError:
        return False
