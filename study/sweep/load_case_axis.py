"""Load cases of a sweep from a table in CSV, a row a point."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...cases.deflections import read_table_rows
from ...cases.reading import shipped_deviations
from ...core.checks import shown
from ...core.errors import InputError
from ...core.regular_file import TABLE_SIZE_LIMIT, leads_outside
from ...friction.lubricants.lubricant import is_shipped
from .axis import Axis, column
from .swept_quantity import Stage, swept_quantity

LOAD_CASE = "load_case"
FILES = ("oil", "deviation.pinion", "deviation.gear")  # columns that name files


def read_load_case_axis(path: str | Path, *, allow_outside: bool = False) -> Axis:
    r"""Load cases of a table in CSV.

    Parameters
    ----------
    path
        The file, as of ``read_table_rows``. Its columns are quantities of ``swept_quantity``, ``share`` and
        ``name``: those of a table of load cases for ``run``, and more. No cell is empty.
    allow_outside
        Whether the table may name files of oils and deviations outside its folder: it may be anybody's.

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

    def checked(row: Mapping[str, Any]) -> dict[str, Any]:
        for name in FILES:
            if name in row and not allow_outside:
                _require_inside(path, name, row[name])
        return {name: swept_quantity(name).checked(value) for name, value in row.items()}

    rows = read_table_rows(
        path, lambda column: swept_quantity(column).words, checked, size_limit=TABLE_SIZE_LIMIT, complete=True
    )
    return load_case_axis({name: [row[name] for row in rows] for name in rows[0]})


def _require_inside(path: str | Path, name: str, value: str) -> None:
    """Refuse a file outside the folder of the table, and say nothing of it."""
    is_known = is_shipped(value) if name == "oil" else value in shipped_deviations()
    if not is_known and leads_outside(os.path.dirname(os.path.abspath(path)), os.path.abspath(value)):
        raise InputError(
            f"{name} = {shown(value)}: must be a shipped one, or a file inside the folder of the table; if you trust "
            "the table, --allow-outside (in Python columns in place of a file) opens files elsewhere"
        )


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
