"""Measuring points as text: comment lines ``# key: value``, one line of column names, one line a point.

Columns may be separated by semicolons or tabs, then also with decimal commas. A measured grid has one more column,
``deviation``; or three more, the measured coordinates.

A spreadsheet changes what it saves: with a decimal comma it separates columns by semicolons or tabs, it pads short
lines with separators, and it quotes what holds one. All that is read.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import product
from typing import Any, TypeVar

import numpy as np
import xarray as xr

from ...core.arrays import Array
from ...core.checks import one_of, whole
from ...core.errors import InputError

NOMINAL_COLUMNS = ("flank", "row", "column", "x", "y", "z", "nx", "ny", "nz")
DEVIATION_COLUMN = "deviation"
MEASURED_COLUMNS = ("measured_x", "measured_y", "measured_z")
HEADINGS = (NOMINAL_COLUMNS, (*NOMINAL_COLUMNS, DEVIATION_COLUMN), (*NOMINAL_COLUMNS, *MEASURED_COLUMNS))
COORDINATE_LIMIT = 1e4  # of a node [mm]; no gear is larger
GRID_SIZE_LIMIT = 1001  # rows and columns, as of `easeoff export`
POINT_COUNT_LIMIT = 100_000  # of a flank
Points = dict[tuple[str, int, int], list[float]]
Number = TypeVar("Number", int, float)


def text(dataset: xr.Dataset) -> str:
    """Text of a dataset of measuring points, with enough digits to read the same numbers again."""
    lines = [f"# {key}: {' '.join(str(value).split())}" for key, value in dataset.attrs.items()]
    position, normal = dataset["position"].values, dataset["normal"].values
    measured = DEVIATION_COLUMN in dataset
    extra = dataset[DEVIATION_COLUMN].values[..., None] if measured else np.zeros((*position.shape[:3], 0))
    lines.append(",".join(HEADINGS[extra.shape[-1]]))
    for place, names in grid_places(dataset):
        numbers = [repr(float(value)) for value in (*position[place], *normal[place], *extra[place])]
        lines.append(",".join([*names, *numbers]))
    return "\n".join(lines) + "\n"


def grid_places(dataset: xr.Dataset) -> Iterator[tuple[tuple[int, ...], tuple[str, ...]]]:
    """Indices of every point of a grid, and the names of its flank, row and column."""
    names = [[str(name) for name in dataset[dimension].values] for dimension in ("flank", "row", "column")]
    yield from zip(np.ndindex(*map(len, names)), product(*names), strict=True)


def parsed(content: str, source: str) -> xr.Dataset:
    """Dataset of a text file; a line that cannot be used is refused with its number."""
    attributes, lines = parted(content, source)
    points: Points = {}
    number, head = lines[0]
    mark = separator(head)
    heading = tuple(cells(head, mark))
    if heading not in HEADINGS:
        raise InputError(
            f"{source}, line {number}: {excerpt(head)}: expected the column names {mark.join(NOMINAL_COLUMNS)}; "
            f"of a measured grid also {DEVIATION_COLUMN} or {mark.join(MEASURED_COLUMNS)}"
        )
    for number, line in lines[1:]:
        where = f"{source}, line {number}"
        index, values = _point(line.strip(), mark, heading, where)
        if index in points:
            raise InputError(f"{where}: a second point of the {index[0]} flank in row {index[1]}, column {index[2]}")
        points[index] = values
    if not points:
        raise InputError(f"{source}: there are no points in it")
    return gridded(points, attributes, source)


def _point(line: str, mark: str, heading: tuple[str, ...], where: str) -> tuple[tuple[str, int, int], list[float]]:
    entries = cells(line, mark)
    if len(entries) != len(heading):
        hint = "; with decimal commas, separate the columns by semicolons" if len(entries) > len(heading) else ""
        raise InputError(
            f"{where}: {excerpt(line)}: {len(entries)} values, expected {len(heading)} ({','.join(heading)}){hint}"
        )
    row, column = (_read(int, where, name, cell) for name, cell in zip(heading[1:3], entries[1:3], strict=True))
    values = [_read(float, where, name, cell) for name, cell in zip(heading[3:], entries[3:], strict=True)]
    one_of(f"{where}: flank", entries[0], ("concave", "convex"))
    if min(row, column) < 1:
        raise InputError(f"{where}: row = {row}, column = {column}: must be 1 or more")
    for name, number in (("row", row), ("column", column)):
        whole(f"{where}: {name}", number, 1, GRID_SIZE_LIMIT)
    if not np.all(np.isfinite(values)):
        raise InputError(f"{where}: every value must be a finite number")
    if max(map(abs, values[:6])) > COORDINATE_LIMIT:
        raise InputError(f"{where}: every coordinate must be at most {COORDINATE_LIMIT:g} mm")
    if abs(float(np.linalg.norm(values[3:6])) - 1.0) > 1e-6:
        raise InputError(f"{where}: normal = ({', '.join(entries[6:9])}): must be of length 1")
    return (entries[0], row, column), values


def _read(kind: Callable[[str], Number], where: str, name: str, cell: str) -> Number:
    """Read a number from its column's cell."""
    try:
        return kind(cell)
    except ValueError as error:
        wanted = "whole number" if kind is int else "number"
        raise InputError(f"{where}: {name} = {excerpt(cell)}: must be a {wanted}") from error


def require_size(rows: int, columns: int, source: str) -> None:
    """Refuse a grid of more points than are ever measured."""
    if not (1 <= rows <= GRID_SIZE_LIMIT and 1 <= columns <= GRID_SIZE_LIMIT and rows * columns <= POINT_COUNT_LIMIT):
        raise InputError(
            f"{source}: rows, columns = {rows}, {columns}: must be 1 to {GRID_SIZE_LIMIT} each, and at most "
            f"{POINT_COUNT_LIMIT} points on a flank"
        )


def gridded(points: Points, attributes: dict[str, Any], source: str) -> xr.Dataset:
    """Dataset of a whole grid by (flank, row, column): position, normal, and deviation or measured position if any."""
    flanks = sorted({key[0] for key in points})
    rows, columns = max(key[1] for key in points), max(key[2] for key in points)
    require_size(rows, columns, source)
    if len(points) != len(flanks) * rows * columns:
        every = product(flanks, range(1, rows + 1), range(1, columns + 1))
        missing = next(place for place in every if place not in points)
        raise InputError(
            f"{source}: the grid has {rows} rows and {columns} columns, but the {missing[0]} flank has no point in row "
            f"{missing[1]}, column {missing[2]}"
        )
    values = np.array([points[key] for key in sorted(points)]).reshape(len(flanks), rows, columns, -1)
    grid = ("flank", "row", "column", "xyz")
    more: dict[int, dict[str, Any]] = {
        1: {DEVIATION_COLUMN: (grid[:3], values[..., -1])},
        3: {"measured_position": (grid, values[..., 6:])},
    }
    return point_grid(flanks, values[..., :6], more.get(values.shape[-1] - 6, {}), attributes)


def point_grid(flanks: Sequence[str], points: Array, more: Mapping[str, Any], attrs: Mapping[str, Any]) -> xr.Dataset:
    """Dataset of positions and normals (flank, row, column, 6), with further variables."""
    rows, columns = (np.arange(1, count + 1) for count in points.shape[1:3])
    grid = ("flank", "row", "column", "xyz")
    return xr.Dataset(
        {"position": (grid, points[..., :3]), "normal": (grid, points[..., 3:]), **more},
        coords={"flank": list(flanks), "row": rows, "column": columns, "xyz": list("xyz")},
        attrs=attrs,
    )


Attributes = dict[str, Any]
Lines = list[tuple[int, str]]
WHOLE_KEYS = ("format_version", "number_of_teeth")
REAL_ENDINGS = ("_mm", "_rad")
EXCERPT_LENGTH = 60  # of a line in a message [characters]
DECIMAL_COMMA = re.compile(r"^([+-]?\d*),(\d+(?:[eE][+-]?\d+)?)$")


def comment(line: str) -> str | None:
    """Text of a comment line after its sign; ``None`` of any other line."""
    stripped = line.strip()
    quoted = re.fullmatch(r'"(#(?:[^"]|"")*)"[;,\t]*', stripped)
    if quoted:
        stripped = quoted[1].replace('""', '"')
    if not stripped.startswith("#"):
        return None
    unpadded = stripped[1:].rstrip(";,\t")
    return (unpadded if len(stripped) - 1 - len(unpadded) >= 2 else stripped[1:]).strip()


def separator(line: str) -> str:
    """Separator of the columns of a line: semicolon, tab, comma or blanks."""
    for mark in (";", "\t"):
        if mark in line.strip():
            return mark
    stripped = line.strip()
    decimal_commas = " " in stripped and "." not in stripped and not re.search(r",\s|,$", stripped)
    return "," if "," in stripped and not decimal_commas else " "


def cells(line: str, mark: str) -> list[str]:
    """Cells of a line, without the empty ones that pad it; a decimal comma becomes a point."""
    entries = [cell.strip().strip('"').strip() for cell in (line.split() if mark == " " else line.split(mark))]
    while entries and not entries[-1]:
        entries.pop()
    return entries if mark == "," else [DECIMAL_COMMA.sub(r"\1.\2", cell) for cell in entries]


def excerpt(line: str) -> str:
    """A line as messages show it, its beginning in quotes."""
    text = line.strip()
    return repr(text if len(text) <= EXCERPT_LENGTH else f"{text[:EXCERPT_LENGTH]} ...")


def parted(content: str, source: str) -> tuple[Attributes, Lines]:
    """Comments of a text by key, and its other lines with their numbers; comments that contradict are refused."""
    attributes: Attributes = {}
    lines: Lines = []
    for number, line in enumerate(content.splitlines(), start=1):
        said = comment(line)
        if said is not None:
            key, colon, value = said.partition(":")
            if not colon:
                raise InputError(f"{source}, line {number}: '# {said}': a comment must have the form '# key: value'")
            key, where = key.strip(), f"{source}, line {number}"
            attribute = _attribute(key, value.strip(), where)
            if attributes.setdefault(key, attribute) != attribute:
                raise InputError(f"{where}: {key} = {attribute!r}: must be {attributes[key]!r}, as it is above")
        elif line.strip(' \t;,"'):
            lines.append((number, line))
    if not lines:
        raise InputError(f"{source}: there are no points in it")
    return attributes, lines


def _attribute(key: str, value: str, where: str) -> Any:
    try:
        if key in WHOLE_KEYS:
            return int(value)
        return float(value.replace(",", ".")) if key.endswith(REAL_ENDINGS) else value
    except ValueError as error:
        raise InputError(f"{where}: {key} = {value!r}: must be a number") from error
