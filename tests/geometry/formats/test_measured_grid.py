"""Measured grids and tables of deviations: what is written is read, other units and writings mean the same."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from deviations import GEAR_ERRORS
from numpy.typing import NDArray
from runs import output_of, refusal_of, small, text_file

import easeoff
from easeoff import InputError
from easeoff.cases import gear_pair, write_case
from easeoff.geometry import GearPair, deviation_from_formula, tooth_angle
from easeoff.geometry.formats import (
    cmm_points,
    flank_deviation,
    measured_grid,
    measured_matrix,
    read_cmm_points,
    read_measured_grid,
    write_cmm_points,
    write_measured_grid,
)
from easeoff.geometry.tooth.tooth_flanks import MemberName, named_member, side
from easeoff.study.deviations import flank_deviations
from easeoff.study.geometry_export import export_points

FORMS = (".csv", ".nc", ".dmi")


@cache
def pair() -> GearPair:
    return gear_pair(easeoff.read_case("fm-11x41"), "drive")


@cache
def points(rows: int = 5, columns: int = 9) -> xr.Dataset:
    return cmm_points(pair().gear, rows, columns, tooth_angle=tooth_angle(pair(), "gear"))


@cache
def grid(rows: int = 5, columns: int = 9) -> xr.Dataset:
    """Both flanks of the gear, the convex one with the errors of the tests."""
    nominal = points(rows, columns)
    place = nominal["position"].values
    fractions = pair().gear.section.fractions(place[..., 2], np.hypot(place[..., 0], place[..., 1]))
    return measured_grid(nominal, GEAR_ERRORS(*fractions)).assign_attrs(member="gear")


@pytest.mark.parametrize("suffix", FORMS)
@pytest.mark.parametrize("size", [(5, 9), (3, 7), (12, 4)])
def test_a_grid_of_any_size_is_read_as_it_was_written(suffix: str, size: tuple[int, int], tmp_path: Path) -> None:
    path = tmp_path / f"gear{suffix}"
    write_measured_grid(grid(*size), path)
    again = read_measured_grid(path)
    tolerance = 2e-7 if suffix == ".dmi" else 0.0  # of um; DMIS holds coordinates, here to 1e-10 mm
    np.testing.assert_allclose(again["deviation"].values, grid(*size)["deviation"].values, rtol=0, atol=tolerance)
    np.testing.assert_allclose(again["position"].values, grid(*size)["position"].values, rtol=0, atol=1e-10)
    deviation = flank_deviation(again, pair().gear)
    formula = deviation_from_formula(pair().gear.section, GEAR_ERRORS)
    t, h = np.array([0.2, 0.5, 0.85]), np.array([0.8, 0.5, 0.3])
    np.testing.assert_allclose(deviation.at(t, h), formula.at(t, h), rtol=0, atol=1e-5)


def csv(tmp_path: Path) -> Path:
    """The grid as a text file."""
    path = tmp_path / "gear.csv"
    write_measured_grid(grid(), path)
    return path


def rewritten(tmp_path: Path, change: Callable[[list[str]], list[str]]) -> Path:
    """A text file whose cells went through a function, a list for each point."""
    path = csv(tmp_path)
    head = [line for line in path.read_text().splitlines() if line.startswith("#")]
    body = [line.split(",") for line in path.read_text().splitlines() if not line.startswith("#")]
    changed = [body[0], *(change(cells) for cells in body[1:])]
    path.write_text("\n".join([*head, *(",".join(cells) for cells in changed)]) + "\n")
    return path


def test_a_file_of_nominal_points_can_be_filled_in(tmp_path: Path) -> None:
    """The way of the workshop: `easeoff export`, measure, add a column."""
    path = tmp_path / "gear.csv"
    write_cmm_points(points(), path)
    values = iter(grid()["deviation"].values.ravel())
    lines = path.read_text().splitlines()
    filled = [
        line if line.startswith("#") else f"{line},{'deviation' if line.startswith('flank') else float(next(values))!r}"
        for line in lines
    ]
    path.write_text("\n".join(filled).replace(",'deviation'", ",deviation"))
    np.testing.assert_array_equal(read_measured_grid(path)["deviation"].values, grid()["deviation"].values)


def test_measured_coordinates_stand_for_the_deviations(tmp_path: Path) -> None:
    path = csv(tmp_path)
    lines = path.read_text().splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("flank,"))
    lines[start] = lines[start].replace("deviation", "measured_x,measured_y,measured_z")
    for i in range(start + 1, len(lines)):
        cells = lines[i].split(",")
        place, normal, d = np.array(cells[3:6], float), np.array(cells[6:9], float), float(cells[9])
        lines[i] = ",".join([*cells[:9], *(repr(float(v)) for v in place + 1e-3 * d * normal), *cells[10:]])
    path.write_text("\n".join(lines))
    np.testing.assert_allclose(
        read_measured_grid(path)["deviation"].values, grid()["deviation"].values, rtol=0, atol=1e-9
    )
    for mistake in ("1.0", "1e300"):
        lines[-1] = ",".join([*lines[-1].split(",")[:9], mistake, "2.0", "3.0", *lines[-1].split(",")[12:]])
        path.write_text("\n".join(lines))
        with pytest.raises(InputError, match="beside the normals"):
            read_measured_grid(path)


def test_millimetres_are_read_if_said_and_noticed_if_not(tmp_path: Path) -> None:
    def in_mm(cells: list[str]) -> list[str]:
        return [*cells[:9], repr(1e-3 * float(cells[9])), *cells[10:]]

    path = rewritten(tmp_path, in_mm)
    with pytest.raises(InputError, match=r"must be at least 0.1 um. If the values are in mm, add"):
        read_measured_grid(path)
    path.write_text(path.read_text().replace("# deviation_unit: um", "# deviation_unit: mm"))
    np.testing.assert_allclose(
        read_measured_grid(path)["deviation"].values, grid()["deviation"].values, rtol=1e-12, atol=1e-12
    )
    path.write_text(path.read_text().replace("# deviation_unit: mm", "# deviation_unit: inch"))
    with pytest.raises(InputError, match="must be one of um, mm"):
        read_measured_grid(path)


def test_nanometres_are_noticed(tmp_path: Path) -> None:
    path = rewritten(tmp_path, lambda cells: [*cells[:9], repr(1e3 * float(cells[9])), *cells[10:]])
    with pytest.raises(InputError, match=r"largest deviation = .* um: must be at most 1000 um"):
        read_measured_grid(path)


def test_a_hole_in_the_grid_is_refused(tmp_path: Path) -> None:
    hole = ["convex", "2", "4"]
    path = rewritten(tmp_path, lambda cells: [*cells[:9], "nan" if cells[:3] == hole else cells[9], *cells[10:]])
    with pytest.raises(InputError, match=r"line .*: every value must be a finite number"):
        read_measured_grid(path)
    holed = grid()["deviation"].values.copy()
    holed[1, 1, 3] = np.nan
    with pytest.raises(InputError, match="convex flank in row 2, column 4"):
        measured_grid(points(), holed)
    path = csv(tmp_path)
    path.write_text("\n".join(path.read_text().splitlines()[:-1]))
    with pytest.raises(InputError, match="no point in row 5, column 9"):
        read_measured_grid(path)


def test_a_grid_of_another_size_is_refused() -> None:
    with pytest.raises(InputError, match=r"5 rows x 9 columns.*rows and columns seem to be exchanged"):
        measured_grid(points(), grid()["deviation"].values.transpose(0, 2, 1))
    with pytest.raises(InputError, match="5 rows x 9 columns"):
        measured_grid(points(), np.ones((2, 4, 9)))


@pytest.mark.parametrize(("rows", "columns"), [(1, 9), (5, 1)])
def test_a_single_row_or_column_is_refused(rows: int, columns: int) -> None:
    few = grid().isel(row=slice(rows), column=slice(columns))
    with pytest.raises(InputError, match=f"rows x columns = {rows} x {columns} of the measured grid: must be at least"):
        flank_deviation(few, pair().gear)


def test_exchanged_or_reversed_rows_and_columns_are_noticed(tmp_path: Path) -> None:
    exchanged = rewritten(tmp_path, lambda cells: [cells[0], cells[2], cells[1], *cells[3:]])
    with pytest.raises(InputError, match="rows and columns of the measured grid are exchanged"):
        flank_deviation(read_measured_grid(exchanged), pair().gear)
    reversed_columns = rewritten(tmp_path, lambda cells: [*cells[:2], str(10 - int(cells[2])), *cells[3:]])
    with pytest.raises(InputError, match=r"columns.*wrong way.*toe to heel"):
        flank_deviation(read_measured_grid(reversed_columns), pair().gear)
    reversed_rows = rewritten(tmp_path, lambda cells: [cells[0], str(6 - int(cells[1])), *cells[2:]])
    with pytest.raises(InputError, match=r"rows.*wrong way.*root to tip"):
        flank_deviation(read_measured_grid(reversed_rows), pair().gear)


def test_a_flank_that_does_not_exist_is_refused(tmp_path: Path) -> None:
    path = rewritten(tmp_path, lambda cells: ["left", *cells[1:]])
    with pytest.raises(InputError, match="flank = 'left': must be one of concave, convex"):
        read_measured_grid(path)
    only = grid().sel(flank=["concave"])
    with pytest.raises(InputError, match="no convex flank, which is the one in contact; it has concave"):
        flank_deviation(only, pair().gear)


def test_the_grid_of_another_gear_is_refused() -> None:
    with pytest.raises(InputError, match="no points of the concave flank of this case"):
        flank_deviation(grid(), pair().pinion)
    other = gear_pair(easeoff.read_case("nasa-12x36"), "drive").gear
    with pytest.raises(InputError, match="no points of the convex flank of this case"):
        flank_deviation(grid(), other)
    inches = grid().assign(position=grid()["position"] / 25.4)
    with pytest.raises(InputError, match="and in mm"):
        flank_deviation(inches, pair().gear)


def test_files_of_other_programs_are_refused_with_a_way_out(tmp_path: Path) -> None:
    for name, reason in (("a.xml", "VDI/VDE 2610"), ("a.gde", "not public"), ("a.qif", "23952"), ("a.xlsx", "")):
        with pytest.raises(InputError, match=rf"read and written as .*{reason}.*easeoff export"):
            read_measured_grid(tmp_path / name)
    with pytest.raises(InputError, match="there is no such file"):
        read_measured_grid(tmp_path / "missing.csv")
    write_cmm_points(points(), tmp_path / "nominal.csv")
    with pytest.raises(InputError, match="nothing measured: add a column 'deviation'"):
        read_measured_grid(tmp_path / "nominal.csv")


def test_a_dmis_file_of_another_hand_is_read(tmp_path: Path) -> None:
    """Inches, comments, continued lines, other statements, other separators in the labels."""
    path = tmp_path / "gear.dmi"
    write_measured_grid(grid(), path)
    lines = (
        path.read_text().replace("UNITS/MM", "UNITS/INCH").replace("_R", " row ").replace("_C", " col ").splitlines()
    )
    for i, line in enumerate(lines):
        if "=FEAT" in line:
            head, *cells = line.replace("=FEAT/", " = FEAT/ ").split(",")
            inches = [f"{float(v) / 25.4:.12f}" for v in cells[1:4]]
            lines[i] = f"{head}, {cells[0]}, {', '.join(inches)}, $ $$ continued\n{', '.join(cells[4:])} $$ normal"
    lines.insert(2, "MODE/PROG,MAN")
    path.write_text("\n".join(lines))
    again = read_measured_grid(path)
    np.testing.assert_allclose(again["deviation"].values, grid()["deviation"].values, rtol=0, atol=1e-6)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("UNITS/MM,ANGDEC", "", "before the first UNITS"),
        ("UNITS/MM", "UNITS/YARD", "UNITS = 'YARD': must be one of MM"),
        ("F(CONCAVE_R1_C1)=", "F(POINT1)=", "must tell flank, row and column"),
        ("F(CONCAVE_R1_C2)=", "F(CONCAVE_R1_C1)=", "a second F"),
        ("F(CONVEX_R1_C2)=FEAT/POINT,CART", "F(CONVEX_R1_C2)=FEAT/POINT,POL", "in POL coordinates: only CART"),
        ("FA(CONCAVE_R2_C3)=FEAT/POINT", "FA(CONCAVE_R2_C3)=FEAT/PLANE", "1 points were not measured"),
    ],
)
def test_mistakes_in_a_dmis_file_are_named(old: str, new: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "gear.dmi"
    write_measured_grid(grid(), path)
    path.write_text(path.read_text().replace(old, new, 1))
    with pytest.raises(InputError, match=message):
        read_measured_grid(path)


def test_results_begin_as_those_of_the_consortium_and_a_point_may_come_twice(tmp_path: Path) -> None:
    """FILNAM, UNITS, OUTPUT/F, F, OUTPUT/FA, FA, as its example program writes them."""
    path = tmp_path / "gear.dmo"
    write_measured_grid(grid(), path)
    lines = path.read_text().splitlines()
    assert lines[0].startswith("FILNAM/'")
    assert lines[1] == "UNITS/MM,ANGDEC"
    assert [line.split("=")[0] for line in lines[2:6]] == [
        f"{word}(CONCAVE_R1_C1)" for word in ("OUTPUT/F", "F", "OUTPUT/FA", "FA")
    ]
    path.write_text("\n".join([*lines[:2], "DATDEF/FA(PLANE1),DAT(A)", lines[3], *lines[2:]]))
    np.testing.assert_allclose(
        read_measured_grid(path)["deviation"].values, grid()["deviation"].values, rtol=0, atol=2e-7
    )


def test_the_command_line_takes_measured_grids(tmp_path: Path) -> None:
    write_measured_grid(grid(), tmp_path / "gear.csv")
    case, out = small("fm-11x41", "shell"), tmp_path / "out.nc"
    write_case(case, tmp_path / "case.toml")
    common = ["run", tmp_path / "case.toml", "--torque", "200", "-o", out]
    output_of(*common, "--deviation", f"gear={tmp_path / 'gear.csv'}")
    tree = easeoff.read_result(out)
    by_python = easeoff.analyze(case, torques=[200.0], deviations={"gear": grid()})
    assert tree.attrs["largest_deviation_gear_um"] == pytest.approx(np.max(np.abs(grid()["deviation"].values[1])))
    np.testing.assert_array_equal(
        tree["loaded"]["transmission_error"].values, by_python["loaded"]["transmission_error"].values
    )
    for text, message in (
        ("gear.csv", "must be pinion=FILE or gear=FILE"),
        ("gear=nowhere", "there is no such file"),
        (f"pinion={tmp_path / 'gear.csv'}", "no points of the concave flank"),
    ):
        said = refusal_of(*common, "--deviation", text)
        assert message in said.replace("\n", " ")


# Tables of deviations and files of spreadsheets: read as the same grid in any writing, or refused with the line


VALUES = np.round(np.random.default_rng(5).uniform(-9.0, 9.0, (5, 9)), 2)
WAYS = {"flank": "convex", "rows": "root to tip", "columns": "toe to heel", "deviation_unit": "um"}


@cache
def random_grid() -> xr.Dataset:
    return measured_grid(cmm_points(pair().gear, 5, 9), VALUES)


def table(values: NDArray[np.float64], mark: str = ";", point: str = ",", **ways: str) -> str:
    head = "".join(f"# {key}: {value}\n" for key, value in (WAYS | ways).items() if value)
    return head + "\n".join(mark.join(f"{v:.2f}".replace(".", point) for v in row) for row in values) + "\n"


@pytest.mark.parametrize(("mark", "point"), [(";", ","), (";", "."), ("\t", ","), (",", "."), (", ", "."), ("  ", ",")])
def test_a_table_is_read_with_any_separator(mark: str, point: str, tmp_path: Path) -> None:
    path = text_file(tmp_path / "gear.csv", table(VALUES, mark, point))
    assert read_measured_grid(path, pair().gear).equals(random_grid())


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
    expected = flank_deviation(random_grid(), pair().gear)
    np.testing.assert_array_equal(found.value, expected.value)
    np.testing.assert_array_equal(found.axial, expected.axial)


def test_unit_and_margins_of_a_table_are_read(tmp_path: Path) -> None:
    path = text_file(tmp_path / "gear.csv", "# margin_toe_mm: 5,5\n" + table(VALUES / 100.0, deviation_unit="mm"))
    found = read_measured_grid(path, pair().gear)
    np.testing.assert_allclose(found["deviation"].values[0], np.round(VALUES / 100.0, 2) * 1e3)
    assert found.attrs["margin_toe_mm"] == 5.5
    assert found.attrs["margin_heel_mm"] == random_grid().attrs["margin_heel_mm"]


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
        (table(VALUES[:1]), "rows = 1: must be a whole number from 2 to 1001"),
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
    np.testing.assert_allclose(found["deviation"].values, random_grid()["deviation"].values, rtol=1e-12)
    np.testing.assert_array_equal(found["position"].values, random_grid()["position"].values)


@pytest.mark.parametrize(
    ("matrix", "ways", "words"),
    [
        (VALUES[0], {}, r"must be numbers \[um\], in rows and columns$"),
        (VALUES[None], {}, r"array of shape \(1, 5, 9\): must be numbers \[um\], in rows and columns$"),
        ([[1.0, 2.0], [3.0]], {}, r"must be numbers \[um\], in rows and columns"),
        ([["a", "b"], ["c", "d"]], {}, r"must be numbers \[um\], in rows and columns"),
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
    write_measured_grid(random_grid(), path)
    lines = []
    for line in path.read_text(encoding="utf-8").splitlines():
        cells = [f'"{line}"' if mark in line else line] if line.startswith("#") else line.split(",")
        cells = [cell.replace(".", point) if not cell.startswith(("#", '"')) else cell for cell in cells]
        lines.append(mark.join(cells + [""] * (10 - len(cells))))
    path.write_text("\r\n".join([*lines, 9 * mark]), encoding="utf-8-sig", newline="")
    assert read_measured_grid(path).equals(random_grid())


HEADS: dict[str, Callable[[str], str]] = {
    "capitals": lambda name: name.upper(),
    "units": lambda name: f"{name.title()} [{'mm' if name in 'xyz' else 'µm' if name == 'deviation' else '1'}]",
    "parentheses": lambda name: f"{name}(microns)" if name == "deviation" else name,
}


@pytest.mark.parametrize("mark", [",", ";", " "])
@pytest.mark.parametrize("head", HEADS)
def test_heads_are_read_in_any_case_and_order_and_with_units(head: str, mark: str, tmp_path: Path) -> None:
    path = tmp_path / "gear.csv"
    write_measured_grid(random_grid(), path)
    comments, _, body = path.read_text(encoding="utf-8").partition("flank,")
    rows = [line.split(",")[::-1] for line in f"flank,{body}".splitlines()]
    rows[0] = [HEADS[head](name) for name in rows[0]]
    path = text_file(path, comments + "\n".join(map(mark.join, rows)))
    assert read_measured_grid(path).equals(random_grid())


@pytest.mark.parametrize("unit", ["\u00b5m", "\u03bcm", "\u039cM", "um", "UM", "micron", "Microns", "mum"])
def test_micrometres_are_read_in_any_spelling(unit: str, tmp_path: Path) -> None:
    path = text_file(tmp_path / "gear.csv", table(VALUES, deviation_unit=unit))
    assert read_measured_grid(path, pair().gear).equals(random_grid())
    found = measured_matrix(pair().gear, VALUES, deviation_unit=unit)
    assert found.equals(random_grid())
    named = random_grid().assign(deviation=random_grid()["deviation"].assign_attrs(units=unit))
    named.assign_attrs(deviation_unit=unit).to_netcdf(tmp_path / "gear.nc")
    assert read_measured_grid(tmp_path / "gear.nc").equals(random_grid())


def test_the_head_states_the_unit_of_the_deviation_once(tmp_path: Path) -> None:
    path = tmp_path / "gear.csv"
    write_measured_grid(measured_grid(random_grid(), VALUES / 50.0), path)
    written = path.read_text(encoding="utf-8").replace(",deviation,", ",deviation [mm],")
    with pytest.raises(InputError, match=r"line \d+: deviation_unit = 'mm': must be 'um', as it is above"):
        read_measured_grid(text_file(path, written))
    found = read_measured_grid(text_file(path, written.replace("# deviation_unit: um\n", "")))
    np.testing.assert_allclose(found["deviation"].values[0], 20.0 * VALUES)


@pytest.mark.parametrize(
    ("encoding", "named"),
    [("utf-8", "sep=;\n"), ("utf-8-sig", '"sep=;"\n'), ("utf-16", ""), ("utf-16-le", "SEP=;\n"), ("utf-16-be", "")],
)
def test_encodings_and_the_separator_of_a_spreadsheet_are_read(encoding: str, named: str, tmp_path: Path) -> None:
    path = tmp_path / "gear.csv"
    mark = "\ufeff" if encoding.endswith("e") else ""
    path.write_bytes((mark + named + table(VALUES, deviation_unit="µm")).encode(encoding))
    assert read_measured_grid(path, pair().gear).equals(random_grid())


@pytest.mark.parametrize("point", [",", "."])
def test_exponents_of_fortran_are_read(point: str, tmp_path: Path) -> None:
    written = table(VALUES / 10.0, point=point).replace(";", "D+01;").splitlines()
    text = "\n".join(line if line.startswith("#") else f"{line}d1" for line in written)
    found = read_measured_grid(text_file(tmp_path / "gear.csv", text), pair().gear)
    np.testing.assert_allclose(found["deviation"].values[0], 10.0 * np.round(VALUES / 10.0, 2), rtol=1e-12)


def test_decimal_commas_among_commas_are_refused_with_a_way_out(tmp_path: Path) -> None:
    path = tmp_path / "gear.csv"
    write_measured_grid(random_grid(), path)
    head, _, body = path.read_text(encoding="utf-8").partition("profile\n")
    path.write_text(f"{head}profile\n{body.replace('.', ',')}", encoding="utf-8")
    with pytest.raises(InputError, match=r"line \d+: 'convex,1,1.*values, expected 12 .*columns by semicolons"):
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
