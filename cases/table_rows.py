"""Rows of a table as text in columns, read alike for load cases, of an analysis or a sweep, and for deflections."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, TypeVar

from pydantic import ValidationError

from ..core.checks import shown
from ..core.errors import InputError, printable, shortened, suggestion
from ..core.regular_file import LINE_LENGTH_LIMIT, TOML_SIZE_LIMIT, named, read_text
from ..geometry.formats.csv_points import cells, data_lines, excerpt, separator
from .mistakes import LINE_COUNT_LIMIT, mistakes
from .schema.schema_table import Table, extra_of

Row = TypeVar("Row")
TableRow = TypeVar("TableRow", bound=Table)


def read_schema_rows(path: str | os.PathLike[str], model: type[TableRow], **options: Any) -> tuple[TableRow, ...]:
    """Rows of a table whose columns are keys of a schema, the torque among them; options of ``read_table_rows``."""
    columns = model.model_fields

    def is_text(column: str) -> bool:
        if column not in columns:
            near = suggestion(column, columns)
            raise ValueError(f"{shown(column)} is no column; known are: {', '.join(columns)}{near}")
        return not extra_of(columns[column], "unit")

    checked = partial(schema_row, model)
    return read_table_rows(path, is_text, checked, size_limit=TOML_SIZE_LIMIT, needed="torque", **options)


def schema_row(model: type[TableRow], row: Mapping[str, Any]) -> TableRow:
    """A row checked by its schema; mistakes are a ``ValueError`` with a line each."""
    try:
        return model.model_validate(row)
    except ValidationError as error:
        raise ValueError(mistakes(model, error)) from error


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
    """Rows of a table with a head, without empty cells; ``#`` begins a comment.

    Columns are separated by commas, semicolons, tabs or blanks; beside commas a decimal has a point. ``is_text`` and
    ``checked`` raise ``ValueError`` on an unknown column and on mistakes, a line each; the size limit is in bytes.
    """
    source = named(path)
    lines = data_lines(read_text(path, size_limit, line_limit=LINE_LENGTH_LIMIT))
    if not lines:
        raise InputError(f"{source} has no {what}s: give a head such as {head} and a {what} a line")
    if count_limit is not None and len(lines) - 1 > count_limit:
        raise InputError(f"{source} has {len(lines) - 1} {what}s: must have at most {count_limit}")
    mark = separator(lines[0][1])
    texts = _columns(lines[0], mark, source, is_text, needed)
    if len(lines) == 1:
        raise InputError(f"{source} has a head but no {what}s: give a {what} a line")
    rows, wrong = [], []
    for at, line in lines[1:]:
        try:
            rows.append(checked(_values(line, mark, texts, complete=complete)))
        except ValueError as error:
            wrong += [f"line {at}, {mistake.strip()}" for mistake in str(error).splitlines()]
    if wrong:
        if len(wrong) == 1:
            raise InputError(f"{source}, {wrong[0]}")
        left = len(wrong) - LINE_COUNT_LIMIT
        messages = [*wrong[:LINE_COUNT_LIMIT], *([f"and {left} more"] if left > 0 else [])]
        raise InputError("\n  ".join([f"{source} has {len(wrong)} mistakes:", *messages]))
    return tuple(rows)


def _columns(
    head: tuple[int, str], mark: str, source: str, is_text: Callable[[str], bool], needed: str | None
) -> dict[str, bool]:
    """True for each column that holds texts, by name; each is known and given once."""
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
