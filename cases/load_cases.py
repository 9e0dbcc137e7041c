"""Tables of load cases as text in columns, and the misalignment of a load case."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from ..core.errors import InputError
from ..core.printable import printable, shortened
from ..core.reading.regular_file import named
from ..core.reading.text_file import TOML_SIZE_LIMIT
from ..core.suggestion import suggestion
from ..geometry.pair.assembly import Misalignment
from .mistakes import mistakes
from .schema.case_schema import Case
from .schema.load_case_table import LOAD_CASE_COUNT_LIMIT, LoadCase, named_load_cases
from .table_rows import read_table_rows

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
    found = read_table_rows(
        path, _is_text, _load_case, size_limit=TOML_SIZE_LIMIT, count_limit=LOAD_CASE_COUNT_LIMIT, needed="torque"
    )
    try:
        named_load_cases(found)
    except ValueError as error:
        raise InputError(f"{named(path)}: {error}") from error
    return found


def _is_text(column: str) -> bool:
    """Whether a column holds texts."""
    if column not in COLUMNS:
        shown = shortened(printable(repr(column)))
        raise ValueError(f"{shown} is no column; known are: {', '.join(COLUMNS)}{suggestion(column, COLUMNS)}")
    return column in TEXT_COLUMNS


def _load_case(row: Mapping[str, Any]) -> LoadCase:
    """The load case of a row."""
    try:
        return LoadCase.model_validate(row)
    except ValidationError as error:
        raise ValueError(mistakes(LoadCase, error)) from error


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
