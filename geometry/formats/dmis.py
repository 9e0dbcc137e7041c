"""Measured points in the Dimensional Measuring Interface Standard, DMIS (ANSI/DMIS 105.2, ISO 22093).

Of the language only what a grid of points takes: ``F(label)=FEAT/POINT,CART,x,y,z,i,j,k`` for a nominal point with its
outward normal, ``FA(label)=FEAT/POINT,CART,...`` for the measured one, ``UNITS/MM`` or ``UNITS/INCH``, comments after
``$$`` and lines continued by ``$``. Other statements are passed over. Labels tell flank, row and column:
``CONCAVE_R1_C1`` for the root at the toe.

The standard is sold; this follows what is public of it. A file of results as the Dimensional Metrology Standards
Consortium's own example program writes it (github.com/QualityInformationFramework/qif-community, ``demoQIFin.py``):
``FILNAM/`` first, then ``UNITS/``, and ``OUTPUT/F(label)`` or ``OUTPUT/FA(label)`` before what is put out. The
statement of a point, with its spaces and its line continued by ``$``, as in an explanation of DMIS statements
(blog.csdn.net/weixin_34766547/article/details/117210587).
"""

from __future__ import annotations

import re
from typing import Any

import xarray as xr

from ...core.checks import one_of
from ...core.errors import InputError
from ...core.regular_file import LINE_LENGTH_LIMIT
from . import csv_points as cmm_csv
from .csv_points import excerpt

LABEL_PATTERN = re.compile(r"(CONCAVE|CONVEX)\D+(\d{1,6})\D+(\d{1,6})")
FEATURE_PATTERN = re.compile(r"(FA?)\s*\(([^)]*)\)\s*=\s*FEAT\s*/\s*POINT\s*,\s*(\w+)\s*,(.*)", re.IGNORECASE)
LABEL_LENGTH_LIMIT = 200  # [characters]
UNIT_LENGTHS = {"MM": 1.0, "CM": 10.0, "M": 1000.0, "INCH": 25.4, "FEET": 304.8}


def text(dataset: xr.Dataset) -> str:
    """Text of a measured grid: every nominal point as ``F``, every measured one as ``FA``."""
    title = str(dataset.attrs.get("title", "measured grid")).replace("'", "")
    lines = [f"FILNAM/'{title}',05.2", "UNITS/MM,ANGDEC"]
    position, normal = dataset["position"].values, dataset["normal"].values
    measured = position + 1e-3 * dataset["deviation"].values[..., None] * normal
    for f, flank in enumerate(dataset["flank"].values):
        for r, row in enumerate(dataset["row"].values):
            for c, column in enumerate(dataset["column"].values):
                label = f"{str(flank).upper()}_R{row}_C{column}"
                direction = normal[f, r, c]
                for kind, point in (("F", position[f, r, c]), ("FA", measured[f, r, c])):
                    numbers = ",".join(f"{value:.10f}" for value in (*point, *direction))
                    lines += [f"OUTPUT/{kind}({label})", f"{kind}({label})=FEAT/POINT,CART,{numbers}"]
    return "\n".join([*lines, "ENDFIL", ""])


def parsed(content: str, source: str) -> xr.Dataset:
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
        match = FEATURE_PATTERN.fullmatch(line)
        if match is None:
            continue
        if scale is None:
            raise InputError(f"{where}: a point stands before the first UNITS/ statement, so that its unit is unknown")
        kind, label = match[1].upper(), match[2].strip().upper()
        if match[3].upper() != "CART":
            raise InputError(
                f"{where}: {kind}({label[:LABEL_LENGTH_LIMIT]}) in {match[3]} coordinates: only CART is read"
            )
        index = LABEL_PATTERN.search(label[:LABEL_LENGTH_LIMIT])
        if index is None:
            raise InputError(
                f"{where}: label = {excerpt(label)}: must tell flank, row and column, as CONCAVE_R1_C1 does"
            )
        key = (index[1].lower(), int(index[2]), int(index[3]))
        values = _numbers(match[4], scale, where)
        # A program defines a point, and its results put it out again.
        if features[kind].setdefault(key, values) != values:
            raise InputError(f"{where}: a second {kind}({label[:LABEL_LENGTH_LIMIT]}), other than the first")
    return _combined(features["F"], features["FA"], source)


def _statements(content: str) -> list[tuple[int, str]]:
    """Numbered statements, comments left out and continued lines joined."""
    result: list[tuple[int, list[str]]] = []
    open_line = False
    for number, raw in enumerate(content.splitlines(), start=1):
        line = raw.split("$$")[0].strip()
        if not line:
            continue
        continued = line.endswith("$")
        part = line.rstrip("$").strip()
        if open_line:
            result[-1][1].append(part)
        else:
            result.append((number, [part]))
        open_line = continued
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
    missing = [key for key in nominal if key not in actual]
    if missing:
        flank, row, column = missing[0]
        raise InputError(
            f"{source}: {len(missing)} points were not measured, the first {flank}, row {row}, col. {column}"
        )
    attributes: dict[str, Any] = {"length_unit": "mm"}
    return cmm_csv.gridded(points, attributes, source)
