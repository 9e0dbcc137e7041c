"""Misalignment that depends on the torque: rows of a table of deflections, and the curve through them.

Rows of a table as text in columns, read alike for load cases, of an analysis or a sweep, and for deflections.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..core.checks import array, frozen_arrays, one_of, words
from ..core.errors import InputError, printable, shortened
from ..core.regular_file import LINE_LENGTH_LIMIT, named, read_text
from ..geometry.formats.separated_text import cells, comment, excerpt, separator
from ..geometry.pair.assembly import Misalignment
from .mistakes import LINE_COUNT_LIMIT
from .schema.usual_torques import TORQUE_LIMIT

if TYPE_CHECKING:
    from ..geometry.pair.gear_pair import FlankName

Array = NDArray[Any]

ERRORS = ("offset", "pinion_axial", "gear_axial", "shaft_angle")
UNITS = {"offset": "mm", "pinion_axial": "mm", "gear_axial": "mm", "shaft_angle": "rad"}
SYMBOLS = ("E", "P", "G", "Sigma")
#: Beyond these no row may lie, nor what is continued beyond the last [mm, rad].
ERROR_LIMITS = (10.0, 10.0, 10.0, float(np.radians(5.0)))
NONE = Misalignment()
FLANKS: tuple[FlankName, ...] = ("drive", "coast")


@frozen_arrays
@dataclass(frozen=True)
class Deflections:
    """Misalignment over the torque, as deflections of shafts, bearings and housing make it.

    Each of E, P, G and Sigma is a monotone cubic curve through the rows (PCHIP): between two rows it does not leave
    their values. Below the first row its values hold; a row at torque zero says what is there without load. Beyond the
    last row the curve goes straight on, with the slope it ends with.

    Parameters
    ----------
    torque
        At the pinion, rising from row to row (n) [N m].
    offset, pinion_axial, gear_axial
        E, P and G (n) [mm]; zero if left out.
    shaft_angle
        Sigma (n) [rad]; zero if left out.
    flank
        Flanks in mesh of each row (n) or of all, whose torques rise for themselves; both if left out.
    constant
        Added at every torque.

    Examples
    --------
    >>> found = Deflections([0.0, 100.0, 300.0], offset=[0.0, 0.02, 0.05])
    >>> found.at(100.0).offset, round(found.at(400.0).offset, 4)
    (0.02, 0.0617)
    """

    torque: Sequence[float] | Array
    offset: Sequence[float] | Array = ()
    pinion_axial: Sequence[float] | Array = ()
    gear_axial: Sequence[float] | Array = ()
    shaft_angle: Sequence[float] | Array = ()
    flank: FlankName | Sequence[FlankName] = ()
    constant: Misalignment = NONE

    def __post_init__(self) -> None:
        torque = array("torque", self.torque, "N m", ndim=1, fewest=1, least=0.0)
        object.__setattr__(self, "torque", tuple(torque.tolist()))
        if torque.max() >= TORQUE_LIMIT:
            raise InputError(f"torque = {torque.max():g}: must be below {TORQUE_LIMIT:g} [N m]")
        for name, limit in zip(ERRORS, ERROR_LIMITS, strict=True):
            values = array(name, getattr(self, name), UNITS[name], ndim=1)
            values = values if values.size else np.zeros(torque.size)
            if values.size != torque.size:
                raise InputError(f"{name}: has {values.size} values: must have {torque.size}, one a torque")
            if np.abs(values).max() >= limit:
                worst = values[np.argmax(np.abs(values))]
                raise InputError(f"{name} = {worst:g}: must lie between {-limit:.4g} and {limit:.4g} [{UNITS[name]}]")
            object.__setattr__(self, name, tuple(values.tolist()))
        given = (self.flank,) * torque.size if isinstance(self.flank, str) else words("flank", self.flank)
        flanks = tuple(one_of("flank", one, FLANKS) for one in given)
        if flanks and len(flanks) != torque.size:
            raise InputError(f"flank: has {len(flanks)} values: must have {torque.size}, one a torque, or none")
        object.__setattr__(self, "flank", flanks)
        for flank in self._flanks or FLANKS[:1]:
            for before, after in pairwise(self._rows(flank)[0].tolist()):
                if after <= before:
                    of_flank = f" of the {flank} flanks" if flanks else ""
                    said = "comes twice" if after == before else f"comes after {before:g}"
                    raise InputError(f"torque = {after:g}: {said}: torques{of_flank} must rise from row to row [N m]")

    def at(self, torque: float, flank: FlankName = "drive") -> Misalignment:
        """Misalignment at a torque [N m].

        Raises
        ------
        InputError
            If there are rows of the other flanks alone, or the curve goes out of the range of a misalignment.
        """
        rows, values = self._rows(flank)
        known = np.flatnonzero(rows == torque)
        if known.size:
            found = values[known[0]]
        elif torque <= rows[0] or rows.size == 1:
            found = values[0]
        elif torque < rows[-1]:
            found = self._curves[flank](torque)
        else:
            found = values[-1] + (torque - rows[-1]) * self._curves[flank](rows[-1], 1)
        whole = found + np.array([getattr(self.constant, name) for name in ERRORS])
        for symbol, value, limit in zip(SYMBOLS, whole, ERROR_LIMITS, strict=True):
            if abs(value) >= limit:
                units, shown = ("deg", np.degrees([value, limit])) if symbol == "Sigma" else ("mm", (value, limit))
                raise InputError(
                    f"torque = {torque:g}: {symbol} = {shown[0]:.4g} there: must lie between {-shown[1]:g} and "
                    f"{shown[1]:g} [{units}]; the table of deflections ends at {rows[-1]:g} N m"
                )
        return Misalignment(*whole.tolist())

    def torque_range(self, flank: FlankName = "drive") -> tuple[float, float]:
        """First and last torque of the rows [N m].

        Raises
        ------
        InputError
            If there are rows of the other flanks alone.
        """
        rows, _ = self._rows(flank)
        return float(rows[0]), float(rows[-1])

    def with_constant(self, constant: Misalignment) -> Deflections:
        """The same rows, with this added at every torque in place of what was."""
        return replace(self, constant=constant)

    @property
    def _flanks(self) -> tuple[FlankName, ...]:
        """Flanks that have rows of their own; none if the rows are of both."""
        return tuple(flank for flank in FLANKS if flank in self.flank)

    def _rows(self, flank: FlankName) -> tuple[Array, Array]:
        """Torques (n) and values (n, 4) of the rows of a flank."""
        own = np.array([one == flank for one in self.flank] if self._flanks else [True] * len(self.torque))
        if not own.any():
            raise InputError(
                f"misalignment: the table of deflections has rows of the {self._flanks[0]} flanks alone: give rows of "
                f"the {flank} flanks, too"
            )
        return np.array(self.torque)[own], np.array([getattr(self, name) for name in ERRORS]).T[own]

    @cached_property
    def _curves(self) -> dict[FlankName, Any]:
        """Curves through the rows of every flank that has two or more."""
        from scipy.interpolate import PchipInterpolator

        found = {flank: self._rows(flank) for flank in self._flanks or FLANKS}
        return {flank: PchipInterpolator(*rows) for flank, rows in found.items() if rows[0].size > 1}


def misalignment_at(given: Misalignment | Deflections, torque: float, flank: FlankName) -> Misalignment:
    """A misalignment, or that of deflections at a torque [N m]; raises as ``Deflections.at``.

    Examples
    --------
    >>> misalignment_at(Misalignment(offset=0.1), 100.0, "drive").offset
    0.1
    """
    return given if isinstance(given, Misalignment) else given.at(torque, flank)


Row = TypeVar("Row")


def read_table_rows(
    path: str | os.PathLike[str],
    is_text: Callable[[str], bool],
    checked: Callable[[Mapping[str, Any]], Row],
    *,
    size_limit: int,
    count_limit: int | None = None,
    needed: str | None = None,
    complete: bool = False,
    what: str = "load case",
    head: str = "torque,E,P,share",
) -> tuple[Row, ...]:
    r"""Rows of a table: a head with the names of the columns, then a row a line.

    Columns are separated by commas, semicolons, tabs or blanks; beside commas a decimal has a point. Lines that begin
    with ``#`` are comments.

    Parameters
    ----------
    path
        The file.
    is_text
        Whether a column holds texts, and not numbers; raises ``ValueError`` if there is no such column.
    checked
        A row from its values by column, without those of empty cells; raises ``ValueError`` with a mistake a line.
    size_limit
        Of the file [bytes].
    count_limit
        Of the rows; none if left out.
    needed
        A column that must be there.
    complete
        Whether no cell may be empty.
    what, head
        What a row is, and a head for an example; for messages.

    Raises
    ------
    InputError
        If the file cannot be read as such; naming line, column, value and what is allowed.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     table = Path(folder, "duty.csv")
    ...     _ = table.write_text("name;torque;E\ncruise;100,5\n;300;0,05\n")
    ...     read_table_rows(table, lambda column: column == "name", dict, size_limit=1000)
    ({'name': 'cruise', 'torque': 100.5}, {'torque': 300.0, 'E': 0.05})
    """
    source = named(path)
    content = read_text(path, size_limit, line_limit=LINE_LENGTH_LIMIT)
    lines = [
        (at, line)
        for at, line in enumerate(content.splitlines(), start=1)
        if line.strip(' \t;,"') and comment(line) is None
    ]
    if not lines:
        raise InputError(f"{source} has no {what}s: give a head such as {head} and a {what} a line")
    if count_limit is not None and len(lines) - 1 > count_limit:
        raise InputError(f"{source} has {len(lines) - 1} {what}s: must have at most {count_limit}")
    mark = separator(lines[0][1])
    texts = _columns(lines[0], mark, source, is_text, needed)
    if len(lines) == 1:
        raise InputError(f"{source} has a head but no {what}s: give a {what} a line")
    found, wrong = [], []
    for at, line in lines[1:]:
        try:
            found.append(checked(_values(line, mark, texts, complete=complete)))
        except ValueError as error:
            wrong += [f"line {at}, {mistake.strip()}" for mistake in str(error).splitlines()]
    if wrong:
        if len(wrong) == 1:
            raise InputError(f"{source}, {wrong[0]}")
        left = len(wrong) - LINE_COUNT_LIMIT
        told = [*wrong[:LINE_COUNT_LIMIT], *([f"and {left} more"] if left > 0 else [])]
        raise InputError("\n  ".join([f"{source} has {len(wrong)} mistakes:", *told]))
    return tuple(found)


def _columns(
    head: tuple[int, str], mark: str, source: str, is_text: Callable[[str], bool], needed: str | None
) -> dict[str, bool]:
    """Whether the columns hold texts, by their names; each is known and given once."""
    at, line = head
    columns = cells(line, mark)
    texts = {}
    for column in columns:
        try:
            texts[column] = is_text(column)
        except ValueError as error:
            raise InputError(f"{source}, line {at}: {error}") from error
        if columns.count(column) > 1:
            raise InputError(f"{source}, line {at}: the column {column} comes twice")
    if needed is not None and needed not in columns:
        raise InputError(f"{source}, line {at}: {excerpt(line)}: the column {needed} is missing")
    return texts


def _values(line: str, mark: str, texts: Mapping[str, bool], *, complete: bool) -> dict[str, Any]:
    """Values of a line by column, without those of empty cells."""
    values = cells(line, mark)
    if len(values) > len(texts):
        comma = "; a decimal has a point" if mark == "," else ""
        raise ValueError(f"{excerpt(line)}: {len(values)} values, but the head has {len(texts)} columns{comma}")
    row: dict[str, Any] = {}
    for (column, text), value in zip(texts.items(), values, strict=False):
        if not value:
            continue
        try:
            row[column] = value if text else float(value)
        except ValueError as error:
            raise ValueError(f"{column} = {shortened(printable(repr(value)))}: must be a number") from error
    missing = [column for column in texts if column not in row]
    if missing and complete:
        raise ValueError(f"{missing[0]}: is missing; every column must have a value in every row here")
    return row
