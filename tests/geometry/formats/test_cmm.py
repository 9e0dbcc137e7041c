"""Measuring points: where they lie on the flank, how both flanks stand to one another, and their files."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from runs import output_of, refusal_of

from easeoff import GeometryError, InputError
from easeoff.cases import gear_pair, read_case
from easeoff.geometry import GearPair, Member, tooth_angle
from easeoff.geometry.formats import EdgeMargins, cmm_points, read_cmm_points, write_cmm_points

INCH = 25.4
NO_MARGINS = EdgeMargins(0.0, 0.0, 0.0, 0.0)
# NASA CR-191009 (Bibel, Reddy & Kumar 1994), toe-root corner of both gear flanks as one cutter makes them [inch].
PUBLISHED_CONVEX = (2.487328996883535, -0.2265447761173172, 0.9856358798469023)
PUBLISHED_CONCAVE = (2.474433967420987, -0.3395653327372070, 0.9856358798469023)


@pytest.fixture(scope="module")
def pair() -> GearPair:
    return gear_pair(read_case("nasa-12x36"))


@pytest.fixture(scope="module")
def gear_points(pair: GearPair) -> xr.Dataset:
    points = cmm_points(pair.gear, tooth_angle=tooth_angle(pair, "gear"))
    return points.assign_attrs(member="gear", title="a pair: published, in two\nlines")


def azimuth(points: xr.Dataset, flank: str) -> NDArray[Any]:
    position = points["position"].sel(flank=flank).values
    return np.asarray(np.arctan2(position[..., 1], position[..., 0]))


def test_without_margins_the_corner_is_the_published_one(pair: GearPair) -> None:
    """One set-up cuts both flanks: the concave one belongs to the next tooth, one pitch away."""
    points = cmm_points(pair.gear, 3, 4, NO_MARGINS, tooth_angle=tooth_angle(pair, "gear"))
    corner = points["position"].sel(row=1, column=1) / INCH
    np.testing.assert_allclose(corner.sel(flank="convex"), PUBLISHED_CONVEX, rtol=0, atol=1e-6)
    x, y, z = corner.sel(flank="concave").values
    turned = math.atan2(y, x) - math.atan2(PUBLISHED_CONCAVE[1], PUBLISHED_CONCAVE[0])
    assert math.hypot(x, y) == pytest.approx(math.hypot(*PUBLISHED_CONCAVE[:2]), abs=1e-6)
    assert z == pytest.approx(PUBLISHED_CONCAVE[2], abs=1e-6)
    assert abs(turned) == pytest.approx(2.0 * math.pi / 36, abs=1e-6)


@pytest.mark.parametrize("name", ["pinion", "gear"])
def test_tooth_lies_between_its_flanks_and_is_as_thick_as_it_should_be(pair: GearPair, name: str) -> None:
    points = cmm_points(getattr(pair, name), 5, 9, NO_MARGINS, tooth_angle=tooth_angle(pair, name))
    apart = azimuth(points, "convex") - azimuth(points, "concave")
    assert abs(apart[2, 4]) == pytest.approx(tooth_angle(pair, name), abs=1e-12)
    # Outward normals point away from the other flank: seen along the axis, against the way to it.
    for flank, sense in (("concave", 1.0), ("convex", -1.0)):
        position, normal = (points[key].sel(flank=flank).values for key in ("position", "normal"))
        turning = position[..., 0] * normal[..., 1] - position[..., 1] * normal[..., 0]
        assert np.all(turning * sense * apart < 0.0)
    # A tooth is thicker at the root than at the tip.
    assert np.all(np.abs(apart[0]) > np.abs(apart[-1]))


def test_teeth_of_the_pair_fill_the_pitch(pair: GearPair) -> None:
    """Without a given thickness the pinion leaves no backlash."""
    total = sum(tooth_angle(pair, name) * teeth for name, teeth in (("pinion", 12), ("gear", 36)))
    assert total == pytest.approx(2.0 * math.pi, rel=1e-9)


def test_rows_and_columns_keep_their_distance_from_the_edges(pair: GearPair) -> None:
    """Distances from the cones themselves: root and face cone, and the two cones square to the front angle."""
    section = pair.pinion.section
    margins = EdgeMargins(toe=2.0, heel=3.0, root=0.7, tip=0.5)
    points = cmm_points(pair.pinion, 7, 11, margins)
    x, y, axial = np.moveaxis(points["position"].values[0], -1, 0)
    radial = np.hypot(x, y)
    above_root = section.height_above_root(axial, radial)
    np.testing.assert_allclose(above_root[0], section.clearance + 0.7, rtol=0, atol=1e-9)
    below_tip = (axial + section.face_apex) * math.sin(section.face_angle) - radial * math.cos(section.face_angle)
    np.testing.assert_allclose(below_tip[-1], 0.5, rtol=0, atol=1e-9)
    front = section.front_angle
    assert front is not None
    along = axial * math.cos(front) + radial * math.sin(front)
    toe, heel = (section.corners[i, 0] @ [math.cos(front), math.sin(front)] for i in (0, 1))
    np.testing.assert_allclose(along[:, 0], toe + 2.0, rtol=0, atol=1e-9)
    np.testing.assert_allclose(along[:, -1], heel - 3.0, rtol=0, atol=1e-9)
    # Columns are equally far apart, and so are the points of a column.
    np.testing.assert_allclose(np.diff(along, axis=1), (heel - toe - 5.0) / 10, rtol=0, atol=1e-9)
    height = np.hypot(np.diff(axial, axis=0), np.diff(radial, axis=0))
    np.testing.assert_allclose(height, np.broadcast_to(height.mean(axis=0), height.shape), rtol=0, atol=1e-9)


def test_default_margins_are_a_tenth(pair: GearPair, gear_points: xr.Dataset) -> None:
    section = pair.gear.section
    depth = np.linalg.norm(section.corners[:, 1] - section.corners[:, 0], axis=1).mean()
    for name, whole in (("toe", section.face_width), ("heel", section.face_width), ("root", depth), ("tip", depth)):
        assert gear_points.attrs[f"margin_{name}_mm"] == pytest.approx(0.1 * whole)


def test_default_root_margin_grows_where_the_flank_ends_early() -> None:
    """A wide edge radius ends this flank above the root line; a margin that was asked for is not changed."""
    whole = gear_pair(read_case("fm-11x41")).pinion
    blade = replace(whole.loaded.blade, edge_radius=3.5)
    member = replace(whole, loaded=replace(whole.loaded, blade=blade))
    found = cmm_points(member)
    assert found.attrs["margin_root_mm"] > 1.4 * found.attrs["margin_tip_mm"]
    with pytest.raises(GeometryError, match=r"concave flank.*row 1, column \d+ .*larger margins"):
        cmm_points(member, edge_margins=EdgeMargins(root=0.1))


def test_normals_are_square_to_the_flank(pair: GearPair) -> None:
    """Against central differences of a fine grid of positions."""
    points = cmm_points(pair.gear, 41, 61, tooth_angle=tooth_angle(pair, "gear"))
    position, normal = points["position"].values, points["normal"].values
    for axis in (1, 2):
        tangent = np.gradient(position, axis=axis)[:, 1:-1, 1:-1]
        tangent /= np.linalg.norm(tangent, axis=-1, keepdims=True)
        assert np.max(np.abs(np.sum(tangent * normal[:, 1:-1, 1:-1], axis=-1))) < 1e-4


def test_flank_that_is_not_known_is_left_out(pair: GearPair) -> None:
    alone: Member = replace(pair.gear, opposite=None)
    assert cmm_points(alone, tooth_angle=0.09)["flank"].values.tolist() == ["convex"]
    assert cmm_points(pair.gear)["flank"].values.tolist() == ["convex"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"rows": 1}, "rows = 1: must be a whole number from 2 to 1001"),
        ({"columns": 0}, "columns = 0: must be a whole number from 2 to 1001"),
        (
            {"edge_margins": EdgeMargins(toe=13.0, heel=13.0)},
            "toe 13, heel 13.*leave nothing of the flank.*25.* mm long",
        ),
        ({"edge_margins": EdgeMargins(root=4.0, tip=4.0)}, "root 4, tip 4.*leave nothing of the flank"),
        ({"edge_margins": EdgeMargins(20.0, 20.0, 9.0, 9.0)}, "leave nothing of the flank"),
    ],
)
def test_grids_without_a_flank_are_refused(pair: GearPair, arguments: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        cmm_points(pair.gear, **arguments)  # type: ignore[arg-type]


@pytest.mark.parametrize("value", [-0.1, math.nan])
def test_margins_that_are_no_lengths_are_refused(value: float) -> None:
    with pytest.raises(InputError, match=rf"edge margin tip = {value}: must be a finite number of 0 or more \[mm\]"):
        EdgeMargins(tip=value)


@pytest.mark.parametrize("suffix", [".csv", ".nc", ".CSV"])
def test_files_lose_nothing(gear_points: xr.Dataset, suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"points{suffix}"
    write_cmm_points(gear_points, path)
    found = read_cmm_points(path)
    expected = gear_points
    if suffix != ".nc":
        expected = gear_points.assign_attrs(title="a pair: published, in two lines")
    xr.testing.assert_identical(found, expected)
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_both_formats_say_what_the_numbers_are(gear_points: xr.Dataset, tmp_path: Path) -> None:
    write_cmm_points(gear_points, tmp_path / "x.csv")
    head = [line for line in (tmp_path / "x.csv").read_text().splitlines() if line.startswith("# ")]
    for word in ("length_unit: mm", "member: gear", "out of the tooth", "positive outward", "row 1 at the root"):
        assert any(word in line for line in head), word
    write_cmm_points(gear_points, tmp_path / "x.nc")
    with xr.open_dataset(tmp_path / "x.nc") as stored:
        assert stored["position"].attrs["units"] == "mm"
        assert all(variable.attrs["long_name"] for variable in stored.variables.values())


def test_points_have_their_place_on_the_flank_and_limits(pair: GearPair, tmp_path: Path) -> None:
    """Places give the positions back, by the section's own map; limits are the tolerance at every point."""
    member = pair.pinion
    points = cmm_points(
        member, 4, 6, EdgeMargins(root=1.0), tooth_angle=tooth_angle(pair, "pinion"), tolerance=(-5, 10)
    )
    x, y, axial = np.moveaxis(points["position"].values, -1, 0)
    found = member.section.points(points["lengthwise"].values, points["profile"].values)
    np.testing.assert_allclose(found, [axial, np.hypot(x, y)], rtol=0, atol=1e-9)
    assert np.all(points["lower_tolerance"] == -5.0)
    assert np.all(points["upper_tolerance"] == 10.0)
    assert points["upper_tolerance"].attrs["units"] == "um"
    path = tmp_path / "pinion.csv"
    output_of(
        "export", "nasa-12x36", "-o", path, "--tolerance", "-5,10", "--rows", 4, "--columns", 6, "--margins", "root=1"
    )
    head = next(line for line in path.read_text().splitlines() if not line.startswith("#"))
    assert head.endswith("nz,lengthwise,profile,lower_tolerance,upper_tolerance")
    xr.testing.assert_equal(read_cmm_points(path), points)


def line_changed(text: str, number: int, old: str, new: str) -> str:
    lines = text.splitlines()
    assert old in lines[number - 1]
    lines[number - 1] = lines[number - 1].replace(old, new, 1)
    return "\n".join(lines)


# In the file of the fixture line 17 holds the column names, lines 18 to 107 the points.
@pytest.mark.parametrize(
    ("number", "old", "new", "words"),
    [
        (1, "easeoff measurement points", "something", "holds no measuring points"),
        (2, "1", "99", "format version 99"),
        (2, "1", "one", "line 2.*format_version.*'one'"),
        (3, ": ", " ", "line 3.*# key: value"),
        (17, "row,column", "rows,column", "line 17: 'rows' is no column; did you mean 'row'.; expected the column"),
        (17, "row,column", "row,row", "line 17: 'row' comes twice; expected the column names"),
        (17, ",nz", "", "line 17: .*: expected the column names flank,row,column,x,y,z,nx,ny,nz in any order"),
        (17, ",x,", ",x [inch],", "line 17: unit of x = 'inch': must be one of mm"),
        (17, ",nz", ",nz,measured_x,deviation", "expected the column names.* deviation or measured_x,measured_y"),
        (20, "concave,1,3,", "concave,1,", "line 20.*10 values, expected 11"),
        (20, "concave,1,3,", "concave,1,three,", "line 20.*three"),
        (20, "concave,1,3,", "drive,1,3,", "line 20: flank = 'drive': must be one of concave, convex"),
        (20, "concave,1,3,", "concave,0,3,", "line 20: row = 0, column = 3: must be 1 or more"),
        (20, "concave,1,3,", "concave,1,2,", "line 20.*second point of the concave flank in row 1, column 2"),
        (20, "concave,1,3,", "concave,1,3,0.5,", "line 20.*12 values, expected 11"),
        (20, "concave,1,3,", "concave,1,10,", "no point in row 1, column 3"),
    ],
)
def test_bad_text_is_refused_with_its_line(
    gear_points: xr.Dataset, tmp_path: Path, number: int, old: str, new: str, words: str
) -> None:
    path = tmp_path / "x.csv"
    write_cmm_points(gear_points, path)
    path.write_text(line_changed(path.read_text(), number, old, new))
    with pytest.raises(InputError, match=words):
        read_cmm_points(path)


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("convex,1,1,1,2,inf,1,0,0", "line 4: every value must be a finite number"),
        ("convex,1,1,1,2,3,1,1,0", r"line 4: normal = \(1, 1, 0\): must be of length 1"),
    ],
)
def test_values_that_cannot_be_are_refused_with_their_line(row: str, words: str, tmp_path: Path) -> None:
    head = "# format: easeoff measurement points\n# format_version: 1\nflank,row,column,x,y,z,nx,ny,nz\n"
    (tmp_path / "x.csv").write_text(head + row + "\n")
    with pytest.raises(InputError, match=words):
        read_cmm_points(tmp_path / "x.csv")


def test_other_files_are_refused(tmp_path: Path, gear_points: xr.Dataset) -> None:
    (tmp_path / "x.nc").write_text("no netCDF")
    (tmp_path / "x.csv").write_text("")
    (tmp_path / "y.csv").write_bytes(b"\xff\xfe\x00")
    xr.Dataset({"x": 1}).to_netcdf(tmp_path / "y.nc")
    xr.Dataset(attrs={"format": "easeoff measurement points", "format_version": 1}).to_netcdf(tmp_path / "z.nc")
    gear_points.assign_attrs(format_version="new").to_netcdf(tmp_path / "v.nc")
    gear_points.astype(str).to_netcdf(tmp_path / "u.nc")
    gear_points.drop_vars("row").to_netcdf(tmp_path / "t.nc")
    gear_points.isel(xyz=slice(2)).to_netcdf(tmp_path / "s.nc")
    gear_points.assign(normal=2.0 * gear_points["normal"]).to_netcdf(tmp_path / "w.nc")
    for name, words in (
        ("x.nc", "not a netCDF file"),
        ("y.nc", "holds no measuring points"),
        ("z.nc", "incomplete: no numbers 'position'"),
        ("v.nc", "format version new"),
        ("u.nc", "incomplete: no numbers 'position'"),
        ("t.nc", "no coordinate 'row'"),
        ("s.nc", "no coordinate 'xyz', or not of three values"),
        ("w.nc", "not of length 1"),
        ("x.csv", "no points in it"),
        ("y.csv", "cannot be read as text"),
        ("none.csv", "no such file"),
        ("x.txt", "written as .csv or .nc"),
    ):
        with pytest.raises(InputError, match=words):
            read_cmm_points(tmp_path / name)
    with pytest.raises(InputError, match=r"written as \.csv or \.nc"):
        write_cmm_points(gear_points, tmp_path / "x.txt")


def test_command_writes_the_points_of_a_case(tmp_path: Path, pair: GearPair) -> None:
    path = tmp_path / "gear.csv"
    options = ["--member", "gear", "--flank", "convex", "--rows", "3", "--columns", "4", "--margins", "root=1,heel=2"]
    said = output_of("export", "nasa-12x36", "-o", path, *options)
    assert said == f"wrote {path}: 3 x 4 points of the gear, convex flank\n"
    found = read_cmm_points(path)
    expected = cmm_points(pair.gear, 3, 4, EdgeMargins(root=1.0, heel=2.0))
    np.testing.assert_array_equal(found["position"].values, expected["position"].values)
    assert found.attrs["member"] == "gear"
    assert "NASA" in found.attrs["title"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["x.csv", "--teeth", "2"], "--teeth: must go with surfaces, not with a .csv file"),
        (["x.stl", "--rows", "5"], "--rows: must go with measuring points, not with a .stl file"),
        (["x.xyz"], ".csv, .nc for measuring points, .step, .stp, .stl, .vtk, .vtu for surfaces"),
        (["x.csv", "--margins", "top=1"], "must be one of toe, heel, root, tip"),
        (["x.csv", "--margins", "toe"], "toe=3,root=1.2"),
        (["x.csv", "--margins", "toe=30"], "leave nothing of the flank"),
        (["x.csv", "--tolerance", "0"], "tolerance = 0, 0: must be a lower limit and a greater upper one [um]"),
        (["x.csv", "--tolerance", "10,5,2"], "must be a tolerance in um, or its lower and upper limit"),
        (["x.stl", "--tolerance", "5"], "--tolerance: must go with measuring points, not with a .stl file"),
        (["x.stl", "--nodes", "61"], "61x31"),
        (["x.stl", "--nodes", "3x3"], "between 5 and 1001"),
        (["x.stl", "--teeth", "few"], "a number of teeth, or all"),
        (["x.stl", "--teeth", "13"], "teeth = 13: must be a whole number from 1 to 12"),
        (["x.stl", "--teeth", "0"], "teeth = 0: must be a whole number from 1 to 12"),
    ],
)
def test_mistakes_give_one_message_and_no_file(arguments: list[str], words: str, tmp_path: Path) -> None:
    name, *options = arguments
    assert words in refusal_of("export", "nasa-12x36", "-o", tmp_path / name, *options)
    assert list(tmp_path.iterdir()) == []


def test_flank_a_case_does_not_describe_is_refused(tmp_path: Path) -> None:
    from easeoff.cases import case_text

    text = case_text("nasa-12x36")
    start, end = text.index("[gear.concave.machine]"), text.index("[gear.convex.machine]")
    (tmp_path / "one.toml").write_text(text[:start] + text[end:])
    options = ["-o", str(tmp_path / "x.csv"), "--member", "gear", "--flank", "concave"]
    said = refusal_of("export", tmp_path / "one.toml", *options)
    assert "flank = 'concave': must be convex, the only flank of the gear" in said
