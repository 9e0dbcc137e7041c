"""Measuring points as text: comment lines ``# key: value``, one line of column names, one line a point.

Columns stand in any order, their names in any case, with or without their units in brackets. They may be separated by
semicolons or tabs, then also with decimal commas. Beside position and normal there may be the place on the flank and
limits of the deviation; a measured grid has the ``deviation`` or the measured coordinates.

A spreadsheet changes what it saves: with a decimal comma it separates columns by semicolons or tabs, it pads short
lines with separators, it quotes what holds one, and a first line ``sep=;`` names it. Fortran writes ``1.5D-03``. All
that is read.
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
from ...core.errors import InputError, suggestion

PLACE_COLUMNS, NODE_COLUMNS = ("flank", "row", "column"), ("x", "y", "z", "nx", "ny", "nz")
POINT_VARIABLES = ("deviation", "lengthwise", "profile", "lower_tolerance", "upper_tolerance")
MEASURED_COLUMNS = ("measured_x", "measured_y", "measured_z")
#: Units that the head may state, of every column; columns are written in this order.
COLUMN_UNITS: Mapping[str, tuple[str, ...]] = (
    dict.fromkeys((*PLACE_COLUMNS, *NODE_COLUMNS, *POINT_VARIABLES, *MEASURED_COLUMNS), ("1",))
    | dict.fromkeys((*NODE_COLUMNS[:3], *MEASURED_COLUMNS), ("mm",))
    | {"deviation": ("um", "mm"), "lower_tolerance": ("um",), "upper_tolerance": ("um",)}
)
MICROMETRES = ("μm", "mum", "micron", "microns")  # in the small letters of casefold, which makes the micro sign a mu
COORDINATE_LIMIT = 1e4  # of a node [mm]; no gear is larger
GRID_SIZE_LIMIT = 1001  # rows and columns, as of `easeoff export`
POINT_COUNT_LIMIT = 100_000  # of a flank
Points = dict[tuple[str, int, int], list[float]]
Number = TypeVar("Number", int, float)


def unit_name(text: object) -> str:
    """Unit as this package writes it: ``um`` for the micrometre in any spelling, no capitals."""
    name = str(text).strip().casefold()
    return "um" if name in MICROMETRES else name


def text(dataset: xr.Dataset) -> str:
    """Text of a dataset of measuring points, with enough digits to read the same numbers again."""
    lines = [f"# {key}: {' '.join(str(value).split())}" for key, value in dataset.attrs.items()]
    more = [name for name in POINT_VARIABLES if name in dataset]
    values = [dataset["position"].values, dataset["normal"].values, *(dataset[name].values[..., None] for name in more)]
    numbers = np.concatenate(values, axis=-1)
    lines.append(",".join((*PLACE_COLUMNS, *NODE_COLUMNS, *more)))
    lines += [",".join((*names, *map(repr, numbers[place].tolist()))) for place, names in grid_places(dataset)]
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
    head = re.sub(r"(?<!\s)\s+(?=[\[(])", "", head)  # from the first blank alone: a line may have 50,000
    mark = separator(head)
    heading = _heading(cells(head, mark), mark, attributes, f"{source}, line {number}")
    for number, line in lines[1:]:
        where = f"{source}, line {number}"
        index, values = _point(line.strip(), mark, heading, where)
        if index in points:
            raise InputError(f"{where}: a second point of the {index[0]} flank in row {index[1]}, column {index[2]}")
        points[index] = values
    if not points:
        raise InputError(f"{source}: there are no points in it")
    return gridded(points, [name for name in COLUMN_UNITS if name in heading], attributes, source)


def _heading(entries: Sequence[str], mark: str, attributes: Attributes, where: str) -> list[str]:
    """Names of the columns, once each and with their units; that of the deviation joins the attributes."""
    needed = (*PLACE_COLUMNS, *NODE_COLUMNS)
    expected = f"expected the column names {mark.join(needed)} in any order; of a measured grid also deviation or "
    expected += mark.join(MEASURED_COLUMNS)
    heading: list[str] = []
    for entry in entries:
        name, *units = re.split(r"[\[(]", entry.lower().rstrip("])"), maxsplit=1)
        if name not in COLUMN_UNITS or name in heading:
            why = "comes twice" if name in heading else f"is no column{suggestion(name, COLUMN_UNITS)}"
            raise InputError(f"{where}: {excerpt(entry)} {why}; {expected}")
        heading.append(name)
        for unit in units:
            known = one_of(f"{where}: unit of {name}", unit_name(unit), COLUMN_UNITS[name])
            if name == "deviation":
                _add(attributes, "deviation_unit", known, where)
    if not {*needed} <= {*heading} or len({*MEASURED_COLUMNS, "deviation"}.intersection(heading)) not in (0, 1, 3):
        raise InputError(f"{where}: {excerpt(mark.join(entries))}: {expected}")
    return heading


def _point(line: str, mark: str, heading: Sequence[str], where: str) -> tuple[tuple[str, int, int], list[float]]:
    entries = cells(line, mark)
    if len(entries) != len(heading):
        hint = "; with decimal commas, separate the columns by semicolons" if len(entries) > len(heading) else ""
        raise InputError(
            f"{where}: {excerpt(line)}: {len(entries)} values, expected {len(heading)} ({','.join(heading)}){hint}"
        )
    found = dict(zip(heading, entries, strict=True))
    row, column = (_read(int, where, name, found[name]) for name in ("row", "column"))
    values = [
        _read(float, where, name, found[name]) for name in COLUMN_UNITS if name in found and name not in PLACE_COLUMNS
    ]
    flank = one_of(f"{where}: flank", found["flank"].lower(), ("concave", "convex"))
    if min(row, column) < 1:
        raise InputError(f"{where}: row = {row}, column = {column}: must be 1 or more")
    for name, number in (("row", row), ("column", column)):
        whole(f"{where}: {name}", number, 1, GRID_SIZE_LIMIT)
    if not np.all(np.isfinite(values)):
        raise InputError(f"{where}: every value must be a finite number")
    if max(map(abs, values[:6])) > COORDINATE_LIMIT:
        raise InputError(f"{where}: every coordinate must be at most {COORDINATE_LIMIT:g} mm")
    if abs(float(np.linalg.norm(values[3:6])) - 1.0) > 1e-6:
        normal = ", ".join(found[name] for name in NODE_COLUMNS[3:])
        raise InputError(f"{where}: normal = ({normal}): must be of length 1")
    return (flank, row, column), values


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


def gridded(points: Points, heading: Sequence[str], attributes: dict[str, Any], source: str) -> xr.Dataset:
    """Dataset of a whole grid by (flank, row, column), whose points have the values of a heading in its order."""
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
    columns_of = [name for name in heading if name not in PLACE_COLUMNS]
    grid = ("flank", "row", "column", "xyz")
    more: dict[str, Any] = {
        name: (grid[:3], values[..., columns_of.index(name)]) for name in POINT_VARIABLES if name in columns_of
    }
    if MEASURED_COLUMNS[0] in columns_of:
        more["measured_position"] = (grid, values[..., -3:])
    return point_grid(flanks, values[..., :6], more, attributes)


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
FORTRAN_EXPONENT = re.compile(r"^([+-]?\d*[.,]\d*)[dD]([+-]?\d+)$")
SEPARATOR_LINE = re.compile(r'"?sep=.?"?[;,\t]*', re.IGNORECASE)


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


def data_lines(content: str) -> Lines:
    """Lines of a text with their numbers, without empty ones, comments and a first line that names the separator."""
    return [
        (number, line)
        for number, line in enumerate(content.splitlines(), start=1)
        if line.strip(' \t;,"')
        and comment(line) is None
        and not (number == 1 and SEPARATOR_LINE.fullmatch(line.strip()))
    ]


def separator(line: str) -> str:
    """Separator of the columns of a line: semicolon, tab, comma or blanks."""
    for mark in (";", "\t"):
        if mark in line.strip():
            return mark
    stripped = line.strip()
    decimal_commas = " " in stripped and "." not in stripped and not re.search(r",\s|,$", stripped)
    return "," if "," in stripped and not decimal_commas else " "


def cells(line: str, mark: str) -> list[str]:
    """Cells of a line, without the empty ones that pad it; a decimal comma becomes a point, Fortran's D an e."""
    entries = [cell.strip().strip('"').strip() for cell in (line.split() if mark == " " else line.split(mark))]
    while entries and not entries[-1]:
        entries.pop()
    entries = [FORTRAN_EXPONENT.sub(r"\1e\2", cell) for cell in entries]
    return entries if mark == "," else [DECIMAL_COMMA.sub(r"\1.\2", cell) for cell in entries]


def excerpt(line: str) -> str:
    """A line as messages show it, its beginning in quotes."""
    text = line.strip()
    return repr(text if len(text) <= EXCERPT_LENGTH else f"{text[:EXCERPT_LENGTH]} ...")


def parted(content: str, source: str) -> tuple[Attributes, Lines]:
    """Comments of a text by key, and its other lines with their numbers; comments that contradict are refused."""
    attributes: Attributes = {}
    for number, line in enumerate(content.splitlines(), start=1):
        said = comment(line)
        if said is not None:
            key, colon, value = said.partition(":")
            if not colon:
                raise InputError(f"{source}, line {number}: '# {said}': a comment must have the form '# key: value'")
            key, where = key.strip(), f"{source}, line {number}"
            _add(attributes, key, _attribute(key, value.strip(), where), where)
    lines = data_lines(content)
    if not lines:
        raise InputError(f"{source}: there are no points in it")
    return attributes, lines


def _add(attributes: Attributes, key: str, value: Any, where: str) -> None:
    """Add an attribute, unless another value of it is there."""
    if attributes.setdefault(key, value) != value:
        raise InputError(f"{where}: {key} = {value!r}: must be {attributes[key]!r}, as it is above")


def _attribute(key: str, value: str, where: str) -> Any:
    try:
        if key in WHOLE_KEYS:
            return int(value)
        if key == "deviation_unit":
            return unit_name(value)
        return float(value.replace(",", ".")) if key.endswith(REAL_ENDINGS) else value
    except ValueError as error:
        raise InputError(f"{where}: {key} = {value!r}: must be a number") from error
