"""Tables of deviations and files of spreadsheets: read as the same grid in any writing, or refused with the line."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from runs import text_file

import easeoff
from easeoff import InputError
from easeoff.cases import gear_pair
from easeoff.geometry import GearPair
from easeoff.geometry.formats import (
    cmm_points,
    flank_deviation,
    measured_grid,
    measured_matrix,
    read_cmm_points,
    read_measured_grid,
    write_measured_grid,
)
from easeoff.geometry.tooth.tooth_flanks import MemberName, named_member, side
from easeoff.study import flank_deviations
from easeoff.study.export.geometry_export import export_points

VALUES = np.round(np.random.default_rng(5).uniform(-9.0, 9.0, (5, 9)), 2)
WAYS = {"flank": "convex", "rows": "root to tip", "columns": "toe to heel", "deviation_unit": "um"}


@cache
def pair() -> GearPair:
    return gear_pair(easeoff.read_case("fm-11x41"), "drive")


@cache
def grid() -> xr.Dataset:
    return measured_grid(cmm_points(pair().gear, 5, 9), VALUES)


def table(values: NDArray[np.float64], mark: str = ";", point: str = ",", **ways: str) -> str:
    head = "".join(f"# {key}: {value}\n" for key, value in (WAYS | ways).items() if value)
    return head + "\n".join(mark.join(f"{v:.2f}".replace(".", point) for v in row) for row in values) + "\n"


@pytest.mark.parametrize(("mark", "point"), [(";", ","), (";", "."), ("\t", ","), (",", "."), (", ", "."), ("  ", ",")])
def test_a_table_is_read_with_any_separator(mark: str, point: str, tmp_path: Path) -> None:
    path = text_file(tmp_path / "gear.csv", table(VALUES, mark, point))
    assert read_measured_grid(path, pair().gear).equals(grid())


@pytest.mark.parametrize(
    ("rows", "columns", "written"),
    [
        ("root to tip", "toe to heel", VALUES),
        ("tip to root", "toe to heel", VALUES[::-1]),
        ("root to tip", "heel to toe", VALUES[:, ::-1]),
        ("toe to heel", "root to tip", VALUES.T),
        ("heel to toe", "tip to root", VALUES[::-1, ::-1].T),
    ],
)
def test_the_comments_say_how_a_table_lies(
    rows: str, columns: str, written: NDArray[np.float64], tmp_path: Path
) -> None:
    path = text_file(tmp_path / "gear.csv", table(written, rows=rows, columns=columns))
    found = flank_deviations(pair(), {"gear": path})["gear"]
    expected = flank_deviation(grid(), pair().gear)
    np.testing.assert_array_equal(found.value, expected.value)
    np.testing.assert_array_equal(found.axial, expected.axial)


def test_unit_and_margins_of_a_table_are_read(tmp_path: Path) -> None:
    path = text_file(tmp_path / "gear.csv", "# margin_toe_mm: 5,5\n" + table(VALUES / 100.0, deviation_unit="mm"))
    found = read_measured_grid(path, pair().gear)
    np.testing.assert_allclose(found["deviation"].values[0], np.round(VALUES / 100.0, 2) * 1e3)
    assert found.attrs["margin_toe_mm"] == 5.5
    assert found.attrs["margin_heel_mm"] == grid().attrs["margin_heel_mm"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (table(VALUES, rows="", columns=""), r"line 3: .*numbers in 5 rows and 9 columns, without points.*# rows"),
        ("1;2\n3;4\n", r"line 1: '1;2': .*# flank: concave' \(or convex\); .*# deviation_unit: um' \(or mm\)"),
        (table(VALUES, rows="upwards"), "rows = 'upwards': must be one of root to tip"),
        (table(VALUES, columns="tip to root"), "must be one along the flank and one up it"),
        (table(VALUES, deviation_unit="mil"), "deviation_unit = 'mil': must be one of um, mm"),
        (table(VALUES) + "1;2;3\n", "line 10: '1;2;3': 3 values, expected 9 as in line 5"),
        (table(VALUES).replace("\n", "\n;;;;\n") + "1;2;3;x;5;6;7;8;9\n", "line 19: 'x': must be a finite number"),
        (table(VALUES).replace("-", "x", 1), "line 5: 'x"),
        (table(VALUES, flank="convex\n# flank: concave"), "line 2: flank = 'concave': must be 'convex', as it is"),
        (table(VALUES).replace(";", ","), "line 5: .* 18 columns|whole numbers, or decimal commas"),
        (table(VALUES[:1]), "rows = 1: must be at least 2"),
    ],
)  # fmt: skip
def test_tables_that_could_mean_something_else_are_refused(text: str, words: str, tmp_path: Path) -> None:
    path = text_file(tmp_path / "gear.csv", text)
    with pytest.raises(InputError, match=words):
        read_measured_grid(path, pair().gear)


def test_a_table_of_the_other_flank_is_read_there_and_refused_here(tmp_path: Path) -> None:
    path = text_file(tmp_path / "gear.txt", table(VALUES, flank="concave"))
    found = read_measured_grid(path, pair().gear)
    assert found["flank"].values.tolist() == ["concave"]
    assert flank_deviation(found, pair().gear.from_opposite).value.shape == (9, 5)
    with pytest.raises(InputError, match="has no convex flank, which is the one in contact; it has concave"):
        flank_deviations(pair(), {"gear": path})
    with pytest.raises(InputError, match="flank = 'concave': must be 'convex', the one given for this member"):
        read_measured_grid(path, replace(pair().gear, opposite=None))


@pytest.mark.parametrize(
    ("ways", "matrix"),
    [
        ({}, VALUES),
        ({"rows": "tip to root", "columns": "heel to toe"}, VALUES[::-1, ::-1]),
        ({"rows": "toe to heel", "columns": "root to tip"}, VALUES.T),
        ({"rows": "heel to toe", "columns": "tip to root", "deviation_unit": "mm"}, 1e-3 * VALUES[::-1, ::-1].T),
    ],
)
def test_a_matrix_is_read_as_its_orientation_says(ways: dict[str, str], matrix: NDArray[np.float64]) -> None:
    found = measured_matrix(pair().gear, matrix, **ways)  # type: ignore[arg-type]
    np.testing.assert_allclose(found["deviation"].values, grid()["deviation"].values, rtol=1e-12)
    np.testing.assert_array_equal(found["position"].values, grid()["position"].values)


@pytest.mark.parametrize(
    ("matrix", "ways", "words"),
    [
        (VALUES[0], {}, r"shape = \(9,\): must be rows x columns"),
        (VALUES[None], {}, r"shape = \(1, 5, 9\): must be rows x columns"),
        ([[1.0, 2.0], [3.0]], {}, "must be numbers in rows of one length"),
        ([["a", "b"], ["c", "d"]], {}, "must be numbers in rows of one length"),
        (np.zeros((0, 3)), {}, "rows, columns = 0, 3: must be 1 to"),
        (np.full((3, 3), np.nan), {}, "in row 1, column 1 is not finite"),
        (1e4 * VALUES, {}, "must be at most 1000 um"),
        (1e-3 * VALUES, {}, "must be at least 0.1 um"),
        (VALUES, {"rows": "root to tip", "columns": "tip to root"}, "must be one along the flank and one up it"),
        (VALUES, {"rows": "upwards"}, "rows = 'upwards': must be one of root to tip"),
        (VALUES, {"deviation_unit": "inch"}, "deviation_unit = 'inch': must be one of um, mm"),
        (VALUES, {"flank": "left"}, "flank = 'left': must be one of concave, convex"),
    ],
)
def test_matrices_that_cannot_be_deviations_are_refused(matrix: Any, ways: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        measured_matrix(pair().gear, matrix, **ways)


def test_a_table_needs_its_member(tmp_path: Path) -> None:
    (tmp_path / "gear.csv").write_text(table(VALUES), encoding="utf-8")
    with pytest.raises(InputError, match="give the member"):
        read_measured_grid(tmp_path / "gear.csv")


@pytest.mark.parametrize("mark", [";", "\t"])
@pytest.mark.parametrize("point", [",", "."])
def test_points_saved_by_a_spreadsheet_are_read(mark: str, point: str, tmp_path: Path) -> None:
    """Separators, decimal commas, padded lines, quoted comments and a byte order mark of a spreadsheet."""
    path = tmp_path / "gear.csv"
    write_measured_grid(grid(), path)
    lines = []
    for line in path.read_text(encoding="utf-8").splitlines():
        cells = [f'"{line}"' if mark in line else line] if line.startswith("#") else line.split(",")
        cells = [cell.replace(".", point) if not cell.startswith(("#", '"')) else cell for cell in cells]
        lines.append(mark.join(cells + [""] * (10 - len(cells))))
    path.write_text("\r\n".join([*lines, 9 * mark]), encoding="utf-8-sig", newline="")
    assert read_measured_grid(path).equals(grid())


def test_decimal_commas_among_commas_are_refused_with_a_way_out(tmp_path: Path) -> None:
    path = tmp_path / "gear.csv"
    write_measured_grid(grid(), path)
    head, _, body = path.read_text(encoding="utf-8").partition("deviation\n")
    path.write_text(f"{head}deviation\n{body.replace('.', ',')}", encoding="utf-8")
    with pytest.raises(InputError, match=r"line \d+: 'convex,1,1.*values, expected 10 .*columns by semicolons"):
        read_measured_grid(path)


@pytest.mark.parametrize("name", ["fm-11x41", "fh-12x41-45"])
@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_a_table_stands_at_the_points_of_an_export(name: str, member: MemberName, tmp_path: Path) -> None:
    case = easeoff.read_case(name)
    own = named_member(gear_pair(case), member)
    export_points(case, tmp_path / "points.csv", member)
    exported = read_cmm_points(tmp_path / "points.csv").sel(flank=side(own.loaded))["position"].values
    (tmp_path / "table.csv").write_text(table(VALUES, flank=side(own.loaded)), encoding="utf-8")
    found = read_measured_grid(tmp_path / "table.csv", own)["position"].values[0]
    np.testing.assert_allclose(found[..., 2], exported[..., 2], rtol=0, atol=1e-9)
    radius, expected = (np.hypot(points[..., 0], points[..., 1]) for points in (found, exported))
    np.testing.assert_allclose(radius, expected, rtol=0, atol=1e-9)
