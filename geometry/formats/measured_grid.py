"""Measured grids: nominal points, their normals and the deviations measured there; their files.

Deviations also come as plain matrices, or as a table of numbers without points: a row of the grid a line, or a column.

Comment lines before the table say what it holds; nothing is guessed:

- ``# flank: concave`` or ``convex``
- ``# rows: root to tip`` and ``# columns: toe to heel``, either the other way round, or rows and columns exchanged
- ``# deviation_unit: um`` or ``mm``
- ``# margin_toe_mm: 3.0`` and so on for heel, root and tip, where the margins are not those of ``cmm_points``

Of the Dimensional Measuring Interface Standard, DMIS (ANSI/DMIS 105.2, ISO 22093), only what a grid of points takes:
``F(label)=FEAT/POINT,CART,x,y,z,i,j,k`` for a nominal point with its outward normal, ``FA(label)=FEAT/POINT,CART,...``
for the measured one, ``UNITS/MM`` or ``UNITS/INCH``, comments after ``$$`` and lines continued by ``$``. Other
statements are passed over. Labels tell flank, row and column: ``CONCAVE_R1_C1`` for the root at the toe.

The standard is sold; this follows what is public of it. A file of results as the Dimensional Metrology Standards
Consortium's own example program writes it (github.com/QualityInformationFramework/qif-community, ``demoQIFin.py``):
``FILNAM/`` first, then ``UNITS/``, and ``OUTPUT/F(label)`` or ``OUTPUT/FA(label)`` before what is put out. The
statement of a point, with its spaces and its line continued by ``$``, as in an explanation of DMIS statements
(blog.csdn.net/weixin_34766547/article/details/117210587).
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ...core.attributes import labelled
from ...core.checks import array, file_path, instance, one_of, shown
from ...core.errors import InputError
from ...core.netcdf_file import read_dataset
from ...core.output_file import whole_file
from ...core.regular_file import LINE_LENGTH_LIMIT
from ..deviation.deviation import Deviation, Method
from ..flanks.flank import solve_flank
from ..pair.gear_pair import Member
from ..tooth.tooth_flanks import Side, side
from . import csv_points as cmm_csv, measuring_points as cmm
from .csv_points import cells, data_lines, excerpt, parted, require_size, separator, unit_name
from .measuring_points import EdgeMargins, cmm_points

FORMAT = cmm.GRID_FORMAT
DMIS_SUFFIXES = (".dmi", ".dmo", ".dmis")
TEXT_SUFFIXES = (".csv", ".txt")
SUFFIXES = (*cmm.SUFFIXES, ".txt", *DMIS_SUFFIXES)
# Formats without a public description that is good enough to read them.
UNSUPPORTED_FORMATS = {
    ".xml": "GDE (VDI/VDE 2610) and vendors' XML: their schema is not public",
    ".gde": "GDE (VDI/VDE 2610): its schema is not public",
    ".qif": "QIF (ISO 23952): not supported",
    ".spa": "Gleason measuring files: their format is not public",
    ".mes": "Klingelnberg and Zeiss measuring files: their formats are not public",
}
DEVIATION_RESOLUTION = 0.1  # [um]; a grid all of whose deviations are smaller was hardly measured
NO_DEVIATION = 1e-4  # [um]; below it in all points the flank is the one designed, in whichever unit
DEVIATION_LIMIT = 1000.0  # [um]
NOMINAL_DISTANCE_LIMIT = 0.05  # [mm] between the nominal points of a file and the designed flank
SIDE_DISTANCE_LIMIT = 0.5  # [mm] between a measured point and the normal of its nominal point


def measured_grid(points: xr.Dataset, deviation: ArrayLike) -> xr.Dataset:
    """A measured grid from nominal points and their deviations.

    Parameters
    ----------
    points
        From ``cmm_points``.
    deviation
        Deviations [um] over (flank, row, column), or (row, column) for points of one flank; along the outward normal,
        positive where there is more metal.

    Raises
    ------
    InputError
        If the deviations have another shape, are not finite, or are too small or too large to be measured ones.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry.formats import cmm_points
    >>> points = cmm_points(gear_pair(read_case("nasa-12x36")).gear, rows=3, columns=5)
    >>> grid = measured_grid(points, np.linspace(-6.0, 6.0, 15).reshape(3, 5))
    >>> grid["deviation"].attrs["units"]
    'um'
    """
    cmm.check_points(points, "points", cmm.FORMAT, FORMAT)
    sizes = tuple(points.sizes[name] for name in ("flank", "row", "column"))
    values = array("deviation", deviation, "um", anything=True)
    if values.ndim == 2 and sizes[0] == 1:
        values = values[None]
    if values.shape != sizes:
        rows, columns = sizes[1:]
        turned = values.ndim >= 2 and values.shape[-2:] == (columns, rows)
        raise InputError(
            f"shape of the deviations = {values.shape}: must be that of the points, {sizes[0]} flanks x {rows} rows x "
            f"{columns} columns" + ("; rows and columns seem to be exchanged: transpose them" if turned else "")
        )
    grid = points.assign(deviation=(("flank", "row", "column"), values))
    grid = grid.assign_attrs(format=FORMAT, format_version=cmm.FORMAT_VERSION, deviation_unit="um")
    _check_size(grid, "deviations")
    return labelled(grid)


def write_measured_grid(grid: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write a measured grid: ``.csv``, ``.nc`` or, as DMIS, ``.dmi``; complete or not at all.

    Parameters
    ----------
    grid
        From ``measured_grid``; more attributes (such as ``member`` or ``title``) are written, too, but not to DMIS.
    path
        The file, replaced if it exists.

    Raises
    ------
    InputError
        If the suffix is another one, or the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry.formats import cmm_points
    >>> points = cmm_points(gear_pair(read_case("nasa-12x36")).gear, rows=3, columns=5)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_measured_grid(measured_grid(points, np.full((3, 5), 4.0)), f"{folder}/gear.dmi")
    """
    if _suffix(path) in DMIS_SUFFIXES:
        cmm.check_points(grid, "grid", FORMAT)
        _require_deviation(grid, "grid")
        with whole_file(path) as temporary:
            temporary.write_text(dmis_text(grid), encoding="utf-8")
    else:
        cmm.write_cmm_points(grid, path)


def read_measured_grid(path: str | os.PathLike[str], member: Member | None = None) -> xr.Dataset:
    """Read a measured grid of this package (``.csv``, ``.txt``, ``.nc``) or of DMIS (``.dmi``, ``.dmo``, ``.dmis``).

    A text file may give a column ``deviation`` (in um, or in what ``# deviation_unit: mm`` says), or the measured
    coordinates; then the deviation is their distance along the normal. Or it is a table of deviations without points,
    see ``parsed_table``; they stand at the points of ``cmm_points``.

    Parameters
    ----------
    path
        The file.
    member
        The member as designed; it gives a table its points.

    Returns
    -------
    xr.Dataset
        ``position``, ``normal`` and ``deviation`` [um] over (flank, row, column).

    Raises
    ------
    InputError
        If the file cannot be read, is of a format that is not supported, or its numbers cannot be deviations.

    Examples
    --------
    >>> import tempfile
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry.formats import cmm_points
    >>> points = cmm_points(gear_pair(read_case("nasa-12x36")).gear, rows=3, columns=5)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_measured_grid(measured_grid(points, np.full((3, 5), 4.0)), f"{folder}/gear.csv")
    ...     float(read_measured_grid(f"{folder}/gear.csv")["deviation"].max())
    4.0
    """
    suffix, source = _suffix(path), Path(path)
    if suffix == ".nc":
        grid = read_dataset(source)
        if "easeoff_version" in grid.attrs and "position" not in grid:
            raise InputError(
                f"{source} is a result of an analysis, not a measured grid: give a grid as `easeoff export` writes it "
                "with deviations filled in, or a file of `easeoff wear`"
            )
    else:
        content = cmm.content(source)
        if suffix in TEXT_SUFFIXES and is_table(content):
            return parsed_table(content, str(source), member)
        grid = (parsed_dmis if suffix in DMIS_SUFFIXES else cmm_csv.parsed)(content, str(source))
    grid = grid.assign_attrs(format=FORMAT, format_version=cmm.FORMAT_VERSION)
    cmm.check_points(grid, source, FORMAT)
    if "measured_position" in grid:
        grid = _along_normals(grid, source)
    _require_deviation(grid, source)
    unit = unit_name(grid.attrs.get("deviation_unit", "um"))
    one_of(f"{source}: deviation_unit", unit, ("um", "mm"))
    cmm.require_units(grid, "deviation", unit, source)
    grid["deviation"] = grid["deviation"] * (1e3 if unit == "mm" else 1.0)
    grid = labelled(grid.assign_attrs(deviation_unit="um"))
    _check_size(grid, str(source))
    return grid


def flank_deviation(grid: xr.Dataset, member: Member, method: Method = "spline") -> Deviation:
    """Deviation of a member's loaded flank from a measured grid.

    Parameters
    ----------
    grid
        From ``measured_grid`` or ``read_measured_grid``.
    member
        The member as designed.
    method
        As in ``Deviation``.

    Raises
    ------
    InputError
        If the grid does not hold this flank, its nominal points are no points of it, or rows and columns are exchanged.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry.formats import cmm_points
    >>> gear = gear_pair(read_case("nasa-12x36")).gear
    >>> grid = measured_grid(cmm_points(gear, rows=3, columns=5), np.full((3, 5), 4.0))
    >>> round(1e3 * float(flank_deviation(grid, gear).at(np.array([0.5]), np.array([0.5]))[0]), 9)  # [um]
    4.0
    """
    cmm.check_points(grid, "grid", FORMAT)
    _require_deviation(grid, "grid")
    instance("member", member, Member)
    name, known = side(member.loaded), [str(v) for v in grid["flank"].values]
    if name not in known:
        raise InputError(
            f"the measured grid has no {name} flank, which is the one in contact; it has {', '.join(known)}"
        )
    rows, columns = grid.sizes["row"], grid.sizes["column"]
    if min(rows, columns) < 2:
        raise InputError(f"rows x columns = {rows} x {columns} of the measured grid: must be at least 2 x 2")
    position = grid["position"].sel(flank=name).transpose("xyz", "column", "row").values
    axial, radial = position[2], np.hypot(position[0], position[1])
    lengthwise, profile = member.section.fractions(axial, radial)
    designed = solve_flank(member.loaded.designed, member.section, axial.ravel(), radial.ravel())
    turned = np.arctan2(*position[1::-1]).ravel() - np.arctan2(designed.position[1], designed.position[0])
    turned = np.mod(turned - turned[0] + np.pi, 2.0 * np.pi) - np.pi
    off = radial.ravel() * np.abs(turned - np.median(turned))
    beyond = np.max(np.abs(np.stack([lengthwise, profile]) - 0.5)) - 0.5
    if not np.all(np.isfinite(off)) or beyond > 0.05 or np.max(off) > NOMINAL_DISTANCE_LIMIT:
        raise InputError(
            f"the nominal points of the measured grid are no points of the {name} flank of this case"
            + (f" (up to {np.max(off):.3g} mm off)" if np.all(np.isfinite(off)) else "")
            + ": is it the grid of this member and design, and in mm?"
        )
    order = [np.sign(np.diff(lengthwise, axis=0).mean()), np.sign(np.diff(profile, axis=1).mean())]
    if abs(np.diff(lengthwise, axis=1).mean()) > abs(np.diff(lengthwise, axis=0).mean()):
        raise InputError("rows and columns of the measured grid are exchanged: columns run from toe to heel")
    for name_of, ends, sign in (("columns", "toe to heel", order[0]), ("rows", "root to tip", order[1])):
        if not sign > 0.0:
            raise InputError(f"the {name_of} of the measured grid run the wrong way: they are counted from {ends}")
    values = grid["deviation"].sel(flank=name).transpose("column", "row").values
    return Deviation(member.section, axial, radial, 1e-3 * values, method)


def _along_normals(grid: xr.Dataset, source: Path) -> xr.Dataset:
    """Deviations from measured coordinates; a tooth turned in the measuring machine is not turned back."""
    measured = grid["measured_position"]
    if set(measured.dims) != set(grid["position"].dims) or measured.dtype.kind not in "fiu":
        raise InputError(f"{source} is incomplete: no numbers 'measured_position' over the points")
    cmm.require_units(grid, "measured_position", "mm", source)
    way = (grid["measured_position"] - grid["position"]).transpose("flank", "row", "column", "xyz").values
    normal = grid["normal"].transpose("flank", "row", "column", "xyz").values
    with np.errstate(over="ignore", invalid="ignore"):  # a slip in a number: it is refused here or by _check_size
        along = np.sum(way * normal, axis=-1)
        aside = np.hypot.reduce(way - along[..., None] * normal, axis=-1)
    if np.max(aside) > SIDE_DISTANCE_LIMIT:
        raise InputError(
            f"{source}: measured points are up to {np.max(aside):.3g} mm beside the normals of their nominal points: "
            "both must be in one frame, in mm, and in one order"
        )
    deviation = (("flank", "row", "column"), 1e3 * along)
    return grid.drop_vars("measured_position").assign(deviation=deviation).assign_attrs(deviation_unit="um")


def _require_deviation(grid: xr.Dataset, source: Path | str) -> None:
    """Refuse points without deviations."""
    if (
        "deviation" not in grid
        or set(grid["deviation"].dims) != {"flank", "row", "column"}
        or grid["deviation"].dtype.kind not in "fiu"
    ):
        raise InputError(
            f"{source} holds nominal points but nothing measured: add a column 'deviation' [um], or measured_x, "
            "measured_y and measured_z [mm]"
        )


def _check_size(grid: xr.Dataset, source: str) -> None:
    """Refuse deviations that are not finite, or too small or too large to be measured ones in um."""
    values = grid["deviation"].values
    if not np.all(np.isfinite(values)):
        flank, row, column = (int(v) for v in np.argwhere(~np.isfinite(values))[0])
        raise InputError(
            f"{source}: the deviation of the {grid['flank'].values[flank]} flank in row {row + 1}, column {column + 1} "
            "is not finite: measure the point again, or leave its row or column out"
        )
    largest = float(np.max(np.abs(values)))
    if NO_DEVIATION < largest < DEVIATION_RESOLUTION:
        raise InputError(
            f"{source}: largest deviation = {largest:g} um: must be at least {DEVIATION_RESOLUTION:g} um. "
            "If the values are in mm, add the line '# deviation_unit: mm'"
        )
    if largest > DEVIATION_LIMIT:
        raise InputError(
            f"{source}: largest deviation = {largest:g} um: must be at most {DEVIATION_LIMIT:g} um. "
            "Are the values in um, and of this flank?"
        )


def _suffix(path: str | os.PathLike[str]) -> str:
    suffix = file_path("path", path).suffix.lower()
    if suffix not in SUFFIXES:
        why = f" ({UNSUPPORTED_FORMATS[suffix]})" if suffix in UNSUPPORTED_FORMATS else ""
        raise InputError(
            f"{path}: measured grids are read and written as {', '.join(SUFFIXES)}{why}. Export the points as text or "
            "DMIS, or fill the deviations into a file of `easeoff export`"
        )
    return suffix


def measured_matrix(
    member: Member,
    deviation: ArrayLike,
    flank: Side | None = None,
    *,
    rows: str = "root to tip",
    columns: str = "toe to heel",
    deviation_unit: str = "um",
    edge_margins: EdgeMargins | None = None,
) -> xr.Dataset:
    """A measured grid from a plain matrix of deviations, at the points of ``cmm_points``.

    Parameters
    ----------
    member
        The member as designed.
    deviation
        Deviations over rows and columns, positive where there is more metal.
    flank
        ``concave`` or ``convex``; the loaded flank if left out.
    rows, columns
        ``root to tip`` or ``tip to root``, and ``toe to heel`` or ``heel to toe``; rows and columns may be exchanged.
    deviation_unit
        ``um`` or ``mm``.
    edge_margins
        Strips left out at the edges of the flank; a tenth if left out.

    Raises
    ------
    InputError
        If the matrix cannot be used, or the words do not say how it lies.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> gear = gear_pair(read_case("nasa-12x36")).gear
    >>> grid = measured_matrix(gear, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], rows="tip to root")
    >>> float(grid["deviation"].sel(flank="convex", row=1, column=3))  # at root and heel
    6.0
    """
    instance("member", member, Member)
    instance("edge_margins", edge_margins, EdgeMargins | None)
    name, source = side(member.loaded) if flank is None else flank, "matrix of deviations"
    deviation_unit = unit_name(deviation_unit)
    given = {"flank": name, "rows": rows, "columns": columns, "deviation_unit": deviation_unit}
    values = array(source, deviation, deviation_unit, ndim=2, anything=True)
    require_size(values.shape[0], values.shape[1], source)
    return _table_grid(values, given, edge_margins or EdgeMargins(), source, member)


UPWARDS, LENGTHWISE = ("root to tip", "tip to root"), ("toe to heel", "heel to toe")
WANTED = {
    "flank": ("concave", "convex"),
    "rows": (*UPWARDS, *LENGTHWISE),
    "columns": (*LENGTHWISE, *UPWARDS),
    "deviation_unit": ("um", "mm"),
}
EDGES = ("toe", "heel", "root", "tip")


def _table_grid(
    values: NDArray[np.float64],
    given: Mapping[str, str],
    margins: EdgeMargins,
    source: str,
    member: Member | None,
    before: str = "",
) -> xr.Dataset:
    """Measured grid at the points where ``easeoff export`` has them, of values in rows and columns.

    They lie as the words for the keys of ``WANTED`` say.
    """
    for key, allowed in WANTED.items():
        one_of(before + key, given[key], allowed)
    values = values * (1e3 if given["deviation_unit"] == "mm" else 1.0)
    values, flank = _oriented(values, given["rows"], given["columns"], source), given["flank"]
    if member is None:
        raise InputError(f"{source}: a table of deviations without points: give the member that it is of")
    if flank != side(member.loaded):
        if member.opposite is None:
            wanted = f"must be {side(member.loaded)!r}, the one given for this member"
            raise InputError(f"{source}: flank = {flank!r}: {wanted}")
        member = member.from_opposite
    rows, columns = values.shape
    if member.opposite is not None:
        # As exported, both flanks have one grid; the thickness of the tooth does not matter to its margins.
        both = cmm_points(member, rows, columns, margins, tooth_angle=np.pi / member.teeth)
        margins = EdgeMargins(**{edge: both.attrs[f"margin_{edge}_mm"] for edge in EDGES})
    return measured_grid(cmm_points(member, rows, columns, margins), values)


def is_table(content: str) -> bool:
    """True if the first line that is no comment holds numbers, and is neither a point nor column names."""
    lines = data_lines(content)
    first = cells(lines[0][1], separator(lines[0][1])) if lines else []
    return first[:1] not in (["concave"], ["convex"]) and any(_is_number(cell, finite=False) for cell in first)


def parsed_table(content: str, source: str, member: Member | None) -> xr.Dataset:
    """Measured grid of a table in a text file, whose comments say what it holds; bad lines are refused by number."""
    attributes, lines = parted(content, source)
    first, head = lines[0]
    mark = separator(head)
    require_size(len(lines), len(cells(head, mark)), source)
    rows = [cells(line, mark) for _, line in lines]
    for (number, line), row in zip(lines, rows, strict=True):
        if len(row) != len(rows[0]):
            expected = f"{len(row)} values, expected {len(rows[0])} as in line {first}"
            raise InputError(f"{source}, line {number}: {excerpt(line)}: {expected}")
        for cell in row:
            if not _is_number(cell):
                raise InputError(f"{source}, line {number}: {shown(cell)}: must be a finite number")
    missing = [
        f"'# {key}: {first_choice}' (or {', '.join(others)})"
        for key, (first_choice, *others) in WANTED.items()
        if key not in attributes
    ]
    if missing:
        raise InputError(
            f"{source}, line {first}: {excerpt(head)}: numbers in {len(rows)} rows and {len(rows[0])} columns, without "
            f"points. If they are deviations at the points of 'easeoff export', say in lines before them what they "
            f"are: {'; '.join(missing)}. Or give the points, too, with a column 'deviation'"
        )
    if mark == "," and not any("." in cell for row in rows for cell in row):
        raise InputError(
            f"{source}, line {first}: {excerpt(head)}: whole numbers, or decimal commas? Write decimal points, or "
            "separate the columns by semicolons"
        )
    margins = EdgeMargins(**{edge: attributes.get(f"margin_{edge}_mm") for edge in EDGES})
    return _table_grid(np.array(rows, dtype=float), attributes, margins, source, member, f"{source}: ")


def _oriented(deviation: NDArray[np.float64], rows: str, columns: str, source: str) -> NDArray[np.float64]:
    """Deviations with rows from root to tip and columns from toe to heel."""
    if (rows in UPWARDS) == (columns in UPWARDS):
        raise InputError(f"{source}: rows = {rows!r}, columns = {columns!r}: must be one along the flank and one up it")
    if rows in LENGTHWISE:
        deviation, rows, columns = deviation.T, columns, rows
    return np.ascontiguousarray(deviation[:: 1 if rows == UPWARDS[0] else -1, :: 1 if columns == LENGTHWISE[0] else -1])


def _is_number(cell: str, *, finite: bool = True) -> bool:
    try:
        return bool(np.isfinite(float(cell))) or not finite
    except ValueError:
        return False


DMIS_LABEL = re.compile(r"(CONCAVE|CONVEX)\D+(\d{1,6})\D+(\d{1,6})")
DMIS_FEATURE = re.compile(r"(FA?)\s*\(([^)]*)\)\s*=\s*FEAT\s*/\s*POINT\s*,\s*(\w+)\s*,(.*)", re.IGNORECASE)
LABEL_LENGTH_LIMIT = 200  # [characters]
UNIT_LENGTHS = {"MM": 1.0, "CM": 10.0, "M": 1000.0, "INCH": 25.4, "FEET": 304.8}


def dmis_text(dataset: xr.Dataset) -> str:
    """Text of a measured grid: every nominal point as ``F``, every measured one as ``FA``."""
    title = str(dataset.attrs.get("title", "measured grid")).replace("'", "")
    lines = [f"FILNAM/'{title}',05.2", "UNITS/MM,ANGDEC"]
    position, normal = dataset["position"].values, dataset["normal"].values
    measured = position + 1e-3 * dataset["deviation"].values[..., None] * normal
    for place, (flank, row, column) in cmm_csv.grid_places(dataset):
        label = f"{flank.upper()}_R{row}_C{column}"
        for kind, points in (("F", position), ("FA", measured)):
            numbers = ",".join(f"{value:.10f}" for value in (*points[place], *normal[place]))
            lines += [f"OUTPUT/{kind}({label})", f"{kind}({label})=FEAT/POINT,CART,{numbers}"]
    return "\n".join([*lines, "ENDFIL", ""])


def parsed_dmis(content: str, source: str) -> xr.Dataset:
    """Dataset of a DMIS file, with the measured positions; bad lines, labels and gaps are refused by number."""
    scale: float | None = None
    features: dict[str, dict[tuple[str, int, int], list[float]]] = {"F": {}, "FA": {}}
    for number, line in _statements(content):
        where = f"{source}, line {number}"
        word, _, rest = line.partition("/")
        if word.strip().upper() == "UNITS":
            unit = rest.split(",")[0].strip().upper()
            one_of(f"{where}: UNITS", unit, UNIT_LENGTHS)
            scale = UNIT_LENGTHS[unit]
        match = DMIS_FEATURE.fullmatch(line)
        if match is None:
            continue
        if scale is None:
            raise InputError(f"{where}: a point stands before the first UNITS/ statement, so that its unit is unknown")
        kind, label = match[1].upper(), match[2].strip().upper()[:LABEL_LENGTH_LIMIT]
        if match[3].upper() != "CART":
            raise InputError(f"{where}: {kind}({label}) in {match[3]} coordinates: only CART is read")
        index = DMIS_LABEL.search(label)
        if index is None:
            raise InputError(
                f"{where}: label = {excerpt(label)}: must tell flank, row and column, as CONCAVE_R1_C1 does"
            )
        key = (index[1].lower(), int(index[2]), int(index[3]))
        values = _numbers(match[4], scale, where)
        # A program defines a point, and its results put it out again.
        if features[kind].setdefault(key, values) != values:
            raise InputError(f"{where}: a second {kind}({label}), other than the first")
    return _combined(features["F"], features["FA"], source)


def _statements(content: str) -> list[tuple[int, str]]:
    """Numbered statements, comments left out and continued lines joined."""
    result: list[tuple[int, list[str]]] = []
    open_line = False
    for number, raw in enumerate(content.splitlines(), start=1):
        line = raw.split("$$")[0].strip()
        if not line:
            continue
        part = line.rstrip("$").strip()
        if open_line:
            result[-1][1].append(part)
        else:
            result.append((number, [part]))
        open_line = line.endswith("$")
    return [(number, "".join(parts)[:LINE_LENGTH_LIMIT]) for number, parts in result]


def _numbers(cells: str, scale: float, where: str) -> list[float]:
    try:
        values = [float(cell) for cell in cells.split(",")]
    except ValueError as error:
        raise InputError(f"{where}: {excerpt(cells)}: must be numbers separated by commas") from error
    if len(values) not in (3, 6):
        raise InputError(f"{where}: {len(values)} numbers: must be x,y,z,i,j,k")
    return [scale * v for v in values[:3]] + values[3:]


def _combined(nominal: cmm_csv.Points, actual: cmm_csv.Points, source: str) -> xr.Dataset:
    if not actual:
        raise InputError(f"{source}: no measured points (FA(...)=FEAT/POINT,CART,...) in it")
    points: cmm_csv.Points = {}
    for key, measured in actual.items():
        name = f"{key[0].upper()}_R{key[1]}_C{key[2]}"
        if len(nominal.get(key, [])) != 6:
            raise InputError(f"{source}: FA({name}) has no nominal point F({name}) with its normal")
        points[key] = [*nominal[key], *measured[:3]]
    gaps = [key for key in nominal if key not in actual]
    if gaps:
        flank, row, column = gaps[0]
        raise InputError(f"{source}: {len(gaps)} points were not measured, the first {flank}, row {row}, col. {column}")
    return cmm_csv.gridded(points, (*cmm_csv.NODE_COLUMNS, *cmm_csv.MEASURED_COLUMNS), {"length_unit": "mm"}, source)
