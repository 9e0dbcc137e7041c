"""Tables of load cases as text in columns, and the misalignment of a load case."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from pydantic import ValidationError

from ..core.errors import InputError, printable, shortened, suggestion
from ..core.regular_file import TOML_SIZE_LIMIT, named
from ..geometry.pair.assembly import Misalignment
from ..geometry.pair.gear_pair import FlankName
from .conversion import misalignment as case_misalignment
from .deflections import ERRORS, SYMBOLS, Deflections, misalignment_at
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
    load_cases = read_table_rows(
        path, _is_text, _load_case, size_limit=TOML_SIZE_LIMIT, count_limit=LOAD_CASE_COUNT_LIMIT, needed="torque"
    )
    try:
        named_load_cases(load_cases)
    except ValueError as error:
        raise InputError(f"{named(path)}: {error}") from error
    return load_cases


def _is_text(column: str) -> bool:
    """True if a column holds texts."""
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


def load_case_misalignment(
    load_case: LoadCase, case: Case, misalignment: Misalignment | Deflections | None = None, flank: FlankName = "drive"
) -> Misalignment:
    """Misalignment of a load case [mm, rad] at its torque: its own values, else the given ones or the case's."""
    given = case_misalignment(case.misalignment) if misalignment is None else misalignment
    base = misalignment_at(given, load_case.torque, load_case.flank or flank)
    errors = {error: getattr(load_case, symbol) for error, symbol in zip(ERRORS, SYMBOLS, strict=True)}
    if errors["shaft_angle"] is not None:
        errors["shaft_angle"] = math.radians(errors["shaft_angle"])
    return replace(base, **{error: value for error, value in errors.items() if value is not None})


def has_own_misalignment(load_case: LoadCase) -> bool:
    """True if a load case has a value of its own for some assembly error."""
    return any(getattr(load_case, symbol) is not None for symbol in SYMBOLS)
