"""Tables of load cases as text in columns, and the misalignment of a load case."""

from __future__ import annotations

import os

from ..core.errors import InputError
from ..core.regular_file import named
from ..geometry.pair.assembly import Misalignment
from ..geometry.pair.gear_pair import FlankName
from .conversion import misalignment as case_misalignment
from .deflections import SYMBOLS, Deflections, misalignment_at, with_errors
from .schema.case_schema import Case
from .schema.load_case_table import LOAD_CASE_COUNT_LIMIT, LoadCase, named_load_cases
from .table_rows import read_schema_rows


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
    load_cases = read_schema_rows(path, LoadCase, count_limit=LOAD_CASE_COUNT_LIMIT)
    try:
        named_load_cases(load_cases)
    except ValueError as error:
        raise InputError(f"{named(path)}: {error}") from error
    return load_cases


def load_case_misalignment(
    load_case: LoadCase, case: Case, misalignment: Misalignment | Deflections | None = None, flank: FlankName = "drive"
) -> Misalignment:
    """Misalignment of a load case [mm, rad] at its torque: its own values, else the given ones or the case's."""
    given = case_misalignment(case.misalignment) if misalignment is None else misalignment
    base = misalignment_at(given, load_case.torque, load_case.flank or flank)
    return with_errors(base, load_case.model_dump(include=set(SYMBOLS)))


def has_own_misalignment(load_case: LoadCase) -> bool:
    """True if a load case has a value of its own for some assembly error."""
    return any(getattr(load_case, symbol) is not None for symbol in SYMBOLS)
