"""Load cases of a sweep from a table in CSV, a row a point."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ...core.checks import shown
from ...core.errors import InputError
from ...core.printable import printable, shortened
from ...core.reading.regular_file import named
from ...core.reading.text_file import LINE_LENGTH_LIMIT, TABLE_SIZE_LIMIT, read_text
from ...geometry.formats.separated_text import cells, comment, separator
from .axis import Axis, column
from .swept_quantity import Stage, swept_quantity

LOAD_CASE = "load_case"


def read_load_case_axis(path: str | Path) -> Axis:
    r"""Load cases of a table in CSV.

    Parameters
    ----------
    path
        The file. Its first row names the columns: quantities of ``swept_quantity``, ``share`` and ``name``. Lines that
        begin with ``#`` are comments. Columns are separated by commas, semicolons, tabs or blanks, as in a table of
        load cases for ``run``, which is read here, too, where it has no empty cells.

    Raises
    ------
    InputError
        If the file cannot be read, a column is unknown or comes twice, or a value is missing or not possible.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     table = Path(folder, "loads.csv")
    ...     _ = table.write_text("torque,E,share\n100,0.01,0.7\n300,0.05,0.3\n", encoding="utf-8")
    ...     read_load_case_axis(table).columns["torque"].tolist()
    [100.0, 300.0]
    """
    text = read_text(path, TABLE_SIZE_LIMIT, line_limit=LINE_LENGTH_LIMIT)
    lines = [(n, line) for n, line in enumerate(text.splitlines(), 1) if line.strip(' \t;,"') and comment(line) is None]
    if len(lines) < 2:
        raise InputError(f"{named(path)}: must have a row of names and a row for every load case")
    mark = separator(lines[0][1])
    names = cells(lines[0][1], mark)
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{named(path)}: the column {shown(name)} comes twice")
    columns: dict[str, list[Any]] = {name: [] for name in names}
    for number, line in lines[1:]:
        where, row = f"{named(path)}, line {number}", cells(line, mark)
        if len(row) != len(names):
            raise InputError(f"{where}: must have {len(names)} values, as the row of names has, and has {len(row)}")
        for name, entry in zip(names, row, strict=True):
            columns[name].append(_value(name, entry.strip(), where))
    return load_case_axis(columns)


def load_case_axis(columns: Any) -> Axis:
    """Load cases from values (n) by the names of their columns.

    Raises
    ------
    InputError
        If a column is unknown, they are not equally long, or a value is not possible.

    Examples
    --------
    >>> load_case_axis({"torque": [100.0, 300.0], "E": [0.01, 0.05]}).size
    2
    """
    found = {str(name): column(swept_quantity(str(name)), list(values)) for name, values in dict(columns).items()}
    if not any(swept_quantity(name).stage < Stage.NOTHING for name in found):
        raise InputError(
            f"load cases: must have a column that changes something, as torque or E; has {shown(list(found))}"
        )
    if len({values.size for values in found.values()}) > 1:
        raise InputError("load cases: the columns must be equally long")
    if "share" in found and not (np.all(found["share"] >= 0.0) and found["share"].sum() > 0.0):
        raise InputError("share: must be numbers of 0 or more, not all 0")
    return Axis(LOAD_CASE, found)


def _value(name: str, entry: str, where: str) -> Any:
    if swept_quantity(name).words:
        return entry
    try:
        return float(entry)
    except ValueError:
        value = printable(shortened(repr(entry)))
        raise InputError(f"{where}: {name} = {value}: must be a number; decimals have a point") from None
