"""Tables of load cases as text in columns, and the misalignment of a load case."""

from __future__ import annotations

import math
import os
from typing import Any

from pydantic import ValidationError

from ..core.errors import InputError
from ..core.printable import printable, shortened
from ..core.reading.regular_file import named
from ..core.reading.text_file import LINE_LENGTH_LIMIT, TOML_SIZE_LIMIT, read_text
from ..core.suggestion import suggestion
from ..geometry.formats.separated_text import cells, comment, excerpt, separator
from ..geometry.pair.assembly import Misalignment
from .mistakes import LINE_COUNT_LIMIT, mistakes
from .schema.case_schema import Case
from .schema.load_case_table import LOAD_CASE_COUNT_LIMIT, LoadCase, named_load_cases

COLUMNS = tuple(LoadCase.model_fields)
TEXT_COLUMNS = ("name", "flank")


def read_load_cases(path: str | os.PathLike[str]) -> tuple[LoadCase, ...]:
    r"""Load cases of a table: a head with the names of the columns, then a load case a line.

    Columns are those keys of a load case that are needed, in any order. They are separated by commas, semicolons, tabs
    or blanks; beside commas a decimal has a point. A cell may be empty; lines that begin with ``#`` are comments.

    Parameters
    ----------
    path
        The file.

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
    ...     _ = table.write_text("name,torque,E,share\ncruise,100,,0.9\nclimb,300,0.05,0.1\n")
    ...     cruise, climb = read_load_cases(table)
    >>> cruise.E, climb.E
    (None, 0.05)
    """
    source = named(path)
    content = read_text(path, TOML_SIZE_LIMIT, line_limit=LINE_LENGTH_LIMIT)
    lines = [
        (at, line)
        for at, line in enumerate(content.splitlines(), start=1)
        if line.strip(' \t;,"') and comment(line) is None
    ]
    if not lines:
        raise InputError(f"{source} has no load cases: give a head such as torque,E,P,share and a load case a line")
    if len(lines) - 1 > LOAD_CASE_COUNT_LIMIT:
        raise InputError(f"{source} has {len(lines) - 1} load cases: must have at most {LOAD_CASE_COUNT_LIMIT}")
    mark = separator(lines[0][1])
    columns = _columns(lines[0], mark, source)
    found, wrong = [], []
    for at, line in lines[1:]:
        try:
            found.append(LoadCase.model_validate(_row(line, mark, columns)))
        except ValidationError as error:
            wrong += [f"line {at}, {mistake.strip()}" for mistake in mistakes(LoadCase, error).splitlines()]
        except ValueError as error:
            wrong.append(f"line {at}, {error}")
    if wrong:
        if len(wrong) == 1:
            raise InputError(f"{source}, {wrong[0]}")
        left = len(wrong) - LINE_COUNT_LIMIT
        told = [*wrong[:LINE_COUNT_LIMIT], *([f"and {left} more"] if left > 0 else [])]
        raise InputError("\n  ".join([f"{source} has {len(wrong)} mistakes:", *told]))
    if not found:
        raise InputError(f"{source} has a head but no load cases")
    try:
        named_load_cases(found)
    except ValueError as error:
        raise InputError(f"{source}: {error}") from error
    return tuple(found)


def _columns(head: tuple[int, str], mark: str, source: str) -> list[str]:
    """Names of the columns, each known and given once."""
    at, line = head
    columns = cells(line, mark)
    for column in columns:
        if column not in COLUMNS:
            shown = shortened(printable(repr(column)))
            near = suggestion(column, COLUMNS)
            raise InputError(f"{source}, line {at}: {shown} is no column; known are: {', '.join(COLUMNS)}{near}")
        if columns.count(column) > 1:
            raise InputError(f"{source}, line {at}: the column {column} comes twice")
    if "torque" not in columns:
        raise InputError(f"{source}, line {at}: {excerpt(line)}: the column torque is missing")
    return columns


def _row(line: str, mark: str, columns: list[str]) -> dict[str, Any]:
    """Values of a line by column, without those of empty cells."""
    values = cells(line, mark)
    if len(values) > len(columns):
        comma = "; a decimal has a point" if mark == "," else ""
        raise ValueError(f"{excerpt(line)}: {len(values)} values, but the head has {len(columns)} columns{comma}")
    row: dict[str, Any] = {}
    for column, value in zip(columns, values, strict=False):
        if not value:
            continue
        try:
            row[column] = value if column in TEXT_COLUMNS else float(value)
        except ValueError as error:
            raise ValueError(f"{column} = {shortened(printable(repr(value)))}: must be a number") from error
    return row


def load_case_misalignment(load_case: LoadCase, case: Case) -> Misalignment:
    """Misalignment of a load case [mm, rad]: its own values, and those of the case where it has none.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> load_case_misalignment(LoadCase(torque=100.0, E=0.1), read_case("nasa-12x36")).offset
    0.1
    """
    own, given = case.misalignment, load_case
    offset, pinion_axial, gear_axial, shaft_angle = (
        value if value is not None else other
        for value, other in (
            (given.E, own.offset),
            (given.P, own.pinion_axial),
            (given.G, own.gear_axial),
            (given.Sigma, own.shaft_angle),
        )
    )
    return Misalignment(offset, pinion_axial, gear_axial, math.radians(shaft_angle))
