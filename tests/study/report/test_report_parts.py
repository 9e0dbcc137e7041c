"""Parts of the report: supports, deviations, modifications, V-H checks, wear, load cases; and what it must have."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from browser import Browser, opened
from numpy.typing import NDArray
from report_content import (
    checked_pattern,
    coarse,
    content,
    strength_result,
    supported_result,
    unpacked,
    worn_flanks,
)
from runs import output_of, refusal_of, small

from easeoff import InputError, analyze, modify, write_result
from easeoff.cases import LoadCase
from easeoff.core.attributes import labelled, ordered, units_of, variable_attributes
from easeoff.study import analyze_load_cases, write_report
from easeoff.study.report import report_file
from easeoff.study.report.report_file import RESULT_COUNT_LIMIT, GivenResults, by_name, report_page
from easeoff.study.report.report_tables import limit_table, load_case_rows
from easeoff.study.summary.assembly import bearing_loads, supports_tables, supports_words
from easeoff.study.summary.result_summary import result_summary
from easeoff.study.summary.table import with_signs
from easeoff.study.sweep import sweep
from easeoff.study.vh import write_vh_check

Array = NDArray[Any]

#: What commercial programs print of a hypoid pair's contact, and where the page has it: a row of the numbers, a column
#: of the table of friction, or a picture by the end of its name.
ITEMS = {
    "greatest pressure": ("row", "greatest pressure"),
    "greatest pressure, chart": ("picture", "pressure-gear"),
    "efficiency": ("column", "efficiency [%]"),
    "friction coefficient": ("column", "mean friction coefficient"),
    "friction coefficient, chart": ("picture", "friction_coefficient"),
    "sliding velocity": ("column", "greatest sliding [m/s]"),
    "sliding velocity, chart": ("picture", "sliding_velocity-gear"),
    "results over rotation": ("picture", "te_loaded"),
    "root stress of the pinion": ("row", "greatest root stress, pinion"),
    "root stress of the gear": ("row", "greatest root stress, gear"),
    "root stress of the pinion, chart": ("picture", "root_pinion"),
    "root stress of the gear, chart": ("picture", "root_gear"),
    "transmission error, linear": ("row", "transmission error at the mean pitch radius, peak to peak"),
    "transmission error, angular": ("row", "transmission error, peak to peak"),
    "mean mesh stiffness per face width": ("row", "mesh stiffness along the normal by face width"),
    "contact ratio under load": ("row", "contact ratio under load"),
    "flash temperature": ("column", "greatest flash temperature [K]"),
    "flash temperature, chart": ("picture", "flash_temperature-gear"),
    "pressure times velocity": ("column", "greatest pressure × sliding [MPa m/s]"),
}


@pytest.fixture(scope="module")
def strength() -> xr.DataTree:
    return strength_result()


@pytest.fixture(scope="module")
def supported() -> xr.DataTree:
    return supported_result()


@pytest.fixture(scope="module")
def check() -> xr.Dataset:
    return checked_pattern()


@pytest.fixture(scope="module")
def worn() -> xr.Dataset:
    return worn_flanks()


def one(tree: xr.DataTree) -> Any:
    """Data of the only result of a page."""
    return content(report_page({"one": tree}))["results"][0]


@cache
def strong() -> Any:
    """Data of the page of the result with root stress."""
    return one(strength_result())


@cache
def on_bearings() -> Any:
    """Data of the page of the result on supports."""
    return one(supported_result())


# --- supports


def test_shares_of_the_rotation_add_up_and_bearings_carry_the_mesh_force(supported: xr.DataTree) -> None:
    shares, loads = supports_tables(supported)
    assert [row[0] for row in shares.rows] == [row[0] for row in loads.rows] == ["50", "200"]
    for row in shares.rows:
        assert sum(map(float, row[2:])) == pytest.approx(100.0, abs=0.25)
    whole = supported["supports"].to_dataset()["whole_rotation"].sel(torque=200.0).mean("mesh_position")
    assert float(shares.rows[1][1]) == pytest.approx(float(whole), abs=0.051)
    # The axial loads of a member's bearings together are the axial part of the mesh force on it.
    names, _, axial = bearing_loads(supported)
    group, attributes = supported["supports"].to_dataset().sortby("torque"), supported["ease_off"].attrs
    for member in ("pinion", "gear"):
        own = sum(axial[i] for i, name in enumerate(names) if name.startswith(member))
        force = ordered(group.sel(member=member), "mesh_force", "torque", "mesh_position", "space")
        assert np.allclose(np.abs(own), np.abs(force @ np.asarray(attributes[f"{member}_axis"])), rtol=1e-6)


def test_the_axial_thrust_of_a_left_hand_pinion_that_drives_points_to_its_heel(supported: xr.DataTree) -> None:
    """It turns so that its concave flank drives: the mesh pushes it away from the crossing point."""
    names, _, axial = bearing_loads(supported)
    thrust = sum(axial[i] for i, name in enumerate(names) if name.startswith("pinion"))
    assert np.all(thrust > 0.0)


def test_the_summary_names_the_supports_and_has_a_line_a_torque(supported: xr.DataTree) -> None:
    text = result_summary(supported)
    assert "supports      axle-fm-11x41: pinion on bearings head, tail; gear on bearings flange side, far side" in text
    assert "pair          11 x 41, left-hand pinion, drive flanks" in text
    shares, loads = supports_tables(supported)
    for table in (shares, loads):
        assert table.title in text
        for row in table.rows:
            assert any(line.split()[0] == row[0] and row[-1] in line for line in text.splitlines() if line.split())


def test_members_without_bearings_are_named_by_how_the_case_holds_them(supported: xr.DataTree) -> None:
    group = supported["supports"].to_dataset()
    bare = group.drop_dims("bearing")
    tree = supported.copy()
    tree["supports"] = xr.DataTree(bare)
    for text, words in (
        ("[supports.pinion]\nreference = [0.0, 0.0, 0.0]", "pinion by a matrix; gear rigid"),
        ("[supports.housing]\nx = 1", "both members by one matrix, with the housing"),
        ("", "by matrices"),
        ("no toml", "by matrices"),
    ):
        tree.attrs["case"] = text
        assert supports_words(tree) == f"axle-fm-11x41: {words}"
    assert len(supports_tables(tree)) == 1


def test_supports_stand_on_the_page(supported: xr.DataTree) -> None:
    result = on_bearings()
    assert [table["rows"] for table in result["supports"]] == [
        [list(row) for row in table.rows] for table in supports_tables(supported)
    ]
    assert result["supports"][0]["heads"][:3] == ["torque [N m]", "whole [µrad]", "teeth [%]"]
    charts = {chart["id"]: chart for chart in result["charts"]["supports"]}
    assert list(charts) == ["rotation_parts", "bearing_radial", "bearing_axial"]
    # Torques rise in charts and loads, also if they were not given so.
    _, radial, _ = bearing_loads(supported)
    series = charts["bearing_radial"]["series"][0]
    assert series["name"] == "50 N m, pinion head"
    assert np.allclose(unpacked(series["y"])[:-1], radial[0, 0], rtol=1e-6)
    given = np.linalg.norm(supported["supports/bearing_force"].sel(bearing="pinion head", torque=50.0), axis=-1)
    assert np.all(radial[0, 0] < given)


# --- deviations, modification, wear, V-H check


@pytest.mark.parametrize("deviated", ["ease_off", "surface"])
def test_deviations_on_the_page_are_those_that_were_given(deviated: str) -> None:
    t, h = np.meshgrid(*(np.linspace(0.0, 1.0, n) for n in (13, 9)), indexing="ij")
    given = xr.Dataset(
        {"deviation": (("lengthwise", "profile"), 4.0 * t - 3.0 * h, {"units": "um"})},
        coords={"lengthwise": t[:, 0], "profile": h[0]},
    )
    tree = analyze(small("fm-11x41", "shell"), torques=[100.0], deviations={"gear": given}, deviated=deviated)  # type: ignore[arg-type]
    fields = one(tree)["deviations"]
    assert list(fields) == ["gear"]
    raster = unpacked(fields["gear"]["raster"])
    fine_t, fine_h = np.meshgrid(*(np.linspace(0.0, 1.0, n) for n in raster.shape), indexing="ij")
    known = np.isfinite(raster)
    assert known.mean() > 0.7
    # The unit of a deviation is the micrometre; the surface is compared to first order.
    assert np.allclose(raster[known], (4.0 * fine_t - 3.0 * fine_h)[known], atol=0.02)


def test_a_result_without_deviations_has_no_picture_of_them() -> None:
    assert on_bearings()["deviations"] == {}
    assert on_bearings()["modification"] is None


@pytest.mark.thorough
def test_a_modification_shows_its_terms_and_both_stages() -> None:
    tree = modify(coarse(), torques=[100.0], order=2)
    part = one(tree)["modification"]
    surface, record = tree["modification"].to_dataset(), tree["optimization"].to_dataset()
    assert [float(value) for _, value in part["terms"]] == pytest.approx(surface["coefficient"].values, abs=0.006)
    assert np.nanmax(np.abs(unpacked(part["raster"]))) == pytest.approx(
        float(np.abs(surface["modification"]).max()), rel=1e-3
    )
    (stage,) = part["stages"]
    pressure = next(row for row in stage["rows"] if row[-1] == "optimization/max_pressure")
    assert [float(value) for value in pressure[1].split(" → ")] == pytest.approx(
        record["max_pressure"].values[:, 0, 0], abs=0.5
    )


def test_wear_stands_on_the_page_alone(worn: xr.Dataset) -> None:
    data = content(report_page({"wear": worn}))
    assert data["results"] == []
    (part,) = data["wear"]
    depth = worn["wear_depth"].isel(step=-1)
    for member in ("pinion", "gear"):
        assert np.max(unpacked(part["depth"][member])) == pytest.approx(float(depth.sel(member=member).max()), rel=0.02)
    last = [float(cell) for cell in part["table"]["rows"][-1]]
    assert last[1:3] == pytest.approx(worn["largest_depth"].values[-1], abs=0.006)
    assert last[3] == pytest.approx(float(worn["peak_to_peak"][-1, 0]), abs=0.006)


def test_a_vh_check_has_its_prints_in_their_places(check: xr.Dataset) -> None:
    (part,) = content(report_page({"check": check}))["checks"]
    assert [place["name"] for place in part["places"]] == ["toe", "middle", "heel"]
    plane = np.array(part["flanks"]["gear"]["plane"])
    t, h = np.meshgrid(check["lengthwise"].values, check["profile"].values, indexing="ij")
    in_plane = np.tensordot(plane, np.stack([np.ones_like(t), t, h, t * h]), axes=1)
    assert np.allclose(in_plane, ordered(check, "in_plane", "plane_axis", "lengthwise", "profile"), atol=1e-9)
    for place in part["places"]:
        printed = unpacked(place["print"]) < 0.0
        assert np.array([t[printed].mean(), h[printed].mean()]) == pytest.approx(place["centre"], abs=0.05)
    # Rows of the grid go from the greatest H down.
    assert part["grid"]["h"] == sorted(part["grid"]["h"], reverse=True)
    cell = part["grid"]["cells"][0][2]["print"]
    stored = ordered(check, "grid_print_excess", "v_grid", "h_grid", "lengthwise", "profile")[2, -1]
    assert cell is not None
    assert np.array_equal(unpacked(cell) < 0.0, stored[::2, ::2] < 0.0)


# --- load cases


def test_load_cases_stand_in_a_table_and_the_heaviest_have_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    assert RESULT_COUNT_LIMIT == 6
    monkeypatch.setattr(report_file, "RESULT_COUNT_LIMIT", 2)
    rows = [LoadCase(name=f"case {n}", torque=40.0 * n, share=1.0) for n in (1, 2, 3)]
    tree = analyze_load_cases(small("fm-11x41", "shell"), rows)
    given = GivenResults.of({"duty": tree})
    assert list(given.results) == [row.name for row in rows[1:]]
    assert given.notes == [
        "duty: pictures of 2 of 3 load cases, those of the greatest pressure; the table has all of them."
    ]
    first = tree.children["results"].children["case 1"]
    assert "other, case 3" in GivenResults.of({"other": tree, "one": first}).results
    part = load_case_rows(tree)
    inputs, results = part["tables"]
    assert [row[0] for row in inputs["rows"]] == [row[0] for row in results["rows"]] == [row.name for row in rows]
    assert inputs["heads"][:3] == ["load case", "flank", "torque [N m]"]
    assert results["heads"][1] == "transmission error, peak to peak [µrad]"
    assert part["duty"]


# --- files


def test_results_are_named_by_what_distinguishes_them() -> None:
    """By no more than that takes; a number where nothing does. Kinds are named apart."""
    flanks = ("drive", "coast", "drive")
    given = [xr.Dataset(attrs={"flank": flank, "misalignment_offset_mm": 0.1 * n}) for n, flank in enumerate(flanks)]
    assert list(by_name(given[:2])) == ["drive", "coast"]
    assert list(by_name(given[::2])) == ["aligned", "E +0.2 mm"]
    assert list(by_name(given)) == ["drive, aligned", "coast, E +0.1 mm", "drive, E +0.2 mm"]
    assert list(by_name([given[0], given[0]])) == ["1: drive", "2: drive"]
    assert list(by_name([given[0], given[0].assign(wear_depth=0.0)])) == ["drive", "wear"]


def test_limits_are_compared_with_the_worst_value(strength: xr.DataTree) -> None:
    greatest = float(strength["loaded/max_pressure"].max())
    limits = [
        f"max_pressure<={greatest + 1.0}",
        f"max_pressure<={greatest - 1.0}",
        "contact_ratio>=9",
        "efficiency>=90",
    ]
    table = limit_table(limits, {"one": strength})
    assert table is not None
    cells = [row[2] for row in table.rows]
    assert cells[0] == f"{greatest:.0f}"
    assert cells[1] == f"{greatest:.0f}: beyond"
    assert cells[2].endswith(": beyond")
    assert [table.rows[0][0], table.rows[1][1]] == ["greatest pressure [MPa]", f"<= {greatest - 1.0:g}"]
    with pytest.raises(InputError, match="did you mean"):
        limit_table(["max_presure<=1"], {"one": strength})
    with pytest.raises(InputError, match="must be such as"):
        limit_table(["max_pressure=1"], {"one": strength})


@pytest.mark.thorough
def test_a_sweep_stands_in_the_report_with_its_tables_and_pictures(strength: xr.DataTree) -> None:
    swept = sweep(small("fm-11x41", "shell"), {"E": [-0.05, 0.05], "torque": [50.0, 150.0]})
    found = content(report_page({"one": strength, "sweep": swept}))["sweeps"]
    assert [part["name"] for part in found] == ["sweep"]
    assert found[0]["tables"][0]["title"].startswith("Percentiles")
    assert all(picture.startswith("data:image/svg+xml;base64,") for picture in found[0]["pictures"])
    assert found[0]["pictures"]


def test_units_on_the_page_have_their_signs() -> None:
    assert with_signs("0.8 um at 90 degC") == "0.8 µm at 90 °C"


@pytest.mark.thorough
def test_the_command_takes_checks_and_wear_beside_results(
    supported: xr.DataTree, check: xr.Dataset, worn: xr.Dataset, tmp_path: Path
) -> None:
    files = [str(tmp_path / name) for name in ("axle.nc", "vh.nc", "wear.nc")]
    write_result(supported, files[0])
    write_vh_check(check, files[1])
    worn.to_netcdf(files[2], engine="netcdf4")
    output = tmp_path / "r.html"
    output_of("report", *files, "-o", output)
    data = content(output.read_text(encoding="utf-8"))
    names = {key: [part["name"] for part in data[key]] for key in ("results", "checks", "wear")}
    assert names == {"results": ["drive"], "checks": ["V-H check"], "wear": ["wear"]}


def test_a_damaged_check_and_a_sweep_are_one_message(check: xr.Dataset, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no numbers 'v' over place; make it anew with 'easeoff vh'"):
        report_page({"check": check.drop_vars("v")})
    with pytest.raises(InputError, match="no numbers 'in_plane' over"):
        report_page({"check": check.assign(in_plane=check["v"])})
    with pytest.raises(InputError, match="'place' must be toe, middle, heel"):
        report_page({"check": check.isel(place=[1, 0, 2])})
    with pytest.raises(InputError, match="no text in the attribute 'title'"):
        report_page({"check": check.assign_attrs(title=3)})
    with pytest.raises(InputError, match="nothing: must be a result of 'easeoff run', 'modify', 'optimize', 'wear' or"):
        report_page({"nothing": xr.Dataset({"other": 1.0})})
    path = tmp_path / "sweep.nc"
    xr.Dataset({"a": 1.0}, attrs={"sweep_schema_version": 1}).to_netcdf(path)
    said = refusal_of("report", path, "-o", tmp_path / "r.html")
    assert "easeoff sweep CASE -o FILE" in said
    assert not (tmp_path / "r.html").exists()


@pytest.mark.parametrize(
    ("group", "change", "message"),
    [
        ("root_stress", "max_root_stress", "root_stress: no numbers 'max_root_stress' over torque, member"),
        ("ease_off", "blade_distance", "ease_off: no numbers 'blade_distance' over lengthwise, profile"),
    ],
)
def test_a_damaged_result_is_one_message(strength: xr.DataTree, group: str, change: str, message: str) -> None:
    tree = strength.copy()
    tree[group] = xr.DataTree(tree[group].to_dataset().drop_vars(change))
    with pytest.raises(InputError, match=f"one is damaged, .*: {message}"):
        report_page({"one": tree})


# --- numbers


def test_linear_transmission_error_is_the_angle_times_the_mean_pitch_radius(strength: xr.DataTree) -> None:
    rows = {row[0]: row for row in strong()["loaded_numbers"]["rows"]}
    row = rows["transmission error at the mean pitch radius, peak to peak"]
    blank = coarse().gear.blank
    assert blank is not None
    radius = math.sin(math.radians(blank.pitch_angle)) * (blank.outer_cone_distance - blank.face_width / 2.0)
    assert row[1] == "µm"
    assert f"{radius:.2f} mm" in row[2]
    wanted = 1e-3 * radius * strength["loaded"].to_dataset()["peak_to_peak"].values
    assert [float(cell) for cell in row[3:]] == pytest.approx(wanted, abs=6e-4)


def test_greatest_friction_is_that_of_segments_which_carry(strength: xr.DataTree) -> None:
    table = strong()["friction"]["table"]
    friction, loaded = strength["friction"].to_dataset(), strength["loaded"].to_dataset()
    for name, head in (
        ("friction_coefficient", "greatest friction coefficient"),
        ("sliding_velocity", "greatest sliding [m/s]"),
    ):
        found = [float(row[table["heads"].index(head)]) for row in table["rows"]]
        for i, j in np.ndindex(2, 2):
            here = friction[name].isel(speed=j)
            values = here.isel({key: i for key in ("torque",) if key in here.dims}).squeeze()
            carries = loaded["pressure"].isel(torque=i) > 0.0
            assert found[2 * i + j] == pytest.approx(float(values.where(carries).max()), abs=0.006)


def test_every_item_of_a_commercial_contact_report_is_on_the_page() -> None:
    assert len(ITEMS) == 19
    result = strong()
    rows = {row[0] for row in result["loaded_numbers"]["rows"]}
    columns = set(result["friction"]["table"]["heads"])
    charts = {chart["id"] for group in result["charts"].values() for chart in group}
    fields = {"pressure-gear", "sliding_velocity-gear", *(f"{name}-gear" for name in result["friction"]["fields"])}
    places = {"row": rows, "column": columns, "picture": charts | fields}
    assert [item for item, (kind, name) in ITEMS.items() if name not in places[kind]] == []


def test_every_row_names_a_variable_that_the_result_has(strength: xr.DataTree, supported: xr.DataTree) -> None:
    for tree, result in ((strength, strong()), (supported, on_bearings())):
        named = [row[2] for row in result["loaded_numbers"]["rows"] + result["unloaded_numbers"]]
        named += [name for table in result["supports"] for name in table["variables"]]
        named += result["friction"]["table"]["variables"] if result["friction"] else []
        for path in (name.partition(" ")[0] for name in named):
            group, _, variable = path.partition("/")
            if variable:
                assert variable in tree[group].to_dataset(), path
            else:
                group, _, attribute = path.partition(".")
                assert attribute in tree[group].attrs, path


# --- in a browser


@pytest.fixture(scope="module")
def browser(
    strength: xr.DataTree, supported: xr.DataTree, check: xr.Dataset, worn: xr.Dataset,
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[Browser]:  # fmt: skip
    path = tmp_path_factory.mktemp("report") / "report.html"
    write_report({"strength": strength, "axle": supported, "check": check, "wear": worn}, path)
    yield from opened(path)


@pytest.mark.thorough
def test_every_item_is_drawn(browser: Browser) -> None:
    shown = browser.run("document.querySelector('main').innerText")
    for kind, name in ITEMS.values():
        if kind == "picture":
            drawn = browser.run(
                f'document.querySelectorAll(\'[id^="r0-{name}"] canvas, [id^="r0-{name}"] svg path\').length'
            )
            assert drawn > 0, name
        else:
            assert name in shown


@pytest.mark.thorough
def test_all_parts_are_drawn_and_none_stands_over(browser: Browser) -> None:
    for name in ("supports", "vh", "wear", "comparison"):
        assert browser.run(f"document.querySelectorAll('#{name} figure').length") > 0, name
    for width in (1300, 400):
        browser.resize(width, 900)
        assert browser.run("document.documentElement.scrollWidth") <= width
    browser.resize(1300, 900)


@pytest.mark.thorough
def test_dragging_over_a_chart_shows_a_part_of_it_and_a_double_click_all(browser: Browser) -> None:
    labels = "[...document.querySelectorAll('#r0-te_loaded svg.chart > text')].map(t => t.textContent)"
    before = browser.run(labels)
    left, top, width, height = browser.place("#r0-te_loaded svg.chart")
    browser.drag((left + 0.4 * width, top + 0.4 * height), (left + 0.6 * width, top + 0.4 * height))
    assert browser.run(labels) != before
    assert browser.run("document.querySelector('#r0-te_loaded .back').style.display") == ""
    browser.run("document.querySelector('#r0-te_loaded .back').click()")
    assert browser.run(labels) == before


@pytest.mark.thorough
def test_the_pointer_reads_angle_and_length_of_a_transmission_error(browser: Browser, strength: xr.DataTree) -> None:
    left, top, width, height = browser.place("#r0-te_loaded svg.chart")
    browser.move(left + 0.5 * width, top + 0.5 * height)
    told = browser.run("document.querySelector('.hint').textContent").split("\n")
    assert told[0].startswith("mesh position 0.5, pinion 16.36°")
    error = strength["loaded"].to_dataset()["transmission_error"].sel(torque=40.0, mesh_position=0.5)
    name, values = told[1].split(": ")
    angle, length = values.removesuffix(" µm").split(", ")
    assert name == "40 N m"
    assert float(angle) == pytest.approx(float(error), rel=1e-3)
    assert float(length) == pytest.approx(89.45e-3 * float(error), rel=2e-3)


@pytest.mark.thorough
def test_the_comparison_follows_the_torque(browser: Browser) -> None:
    heads = "[...document.querySelectorAll('#comparison .numbers th')].map(t => t.textContent)"
    path = Path(browser.run("location.pathname"))
    browser.open(path, "torque=400")
    assert browser.run(heads)[2:5] == ["strength, 400 N m", "axle, 200 N m", "difference"]
    browser.open(path, "torque=40")
    assert browser.run(heads)[2:5] == ["strength, 40 N m", "axle, 50 N m", "difference"]


@pytest.mark.thorough
def test_paper_has_every_torque_and_the_teeth_name_their_ends(browser: Browser, strength: xr.DataTree) -> None:
    """On paper nobody moves a slider; the picture of the teeth begins with both members and toe and heel named."""
    count = strength["loaded"].sizes["torque"]
    assert browser.run("document.querySelectorAll('.on-paper [id^=\"r0-pressure-\"] canvas').length") == count
    assert browser.run("getComputedStyle(document.querySelector('.on-paper')).display") == "none"
    if browser.run("document.querySelectorAll('.scene').length"):
        assert browser.run("[...document.querySelectorAll('#r0-teeth .end')].map(e => e.textContent)") == [
            "toe",
            "heel",
        ]
        assert browser.run("document.querySelector('#r0-teeth select').value") == "both"


@pytest.mark.thorough
def test_names_of_contour_lines_stand_inside_the_common_flank_and_apart(browser: Browser) -> None:
    """Every corner of a label lies within the dashed boundary, and no two labels overlap."""
    script = """[...document.querySelectorAll('[id$="-ease_off-gear"]')].map(figure => {
        const inside = figure.querySelector('polygon[stroke-dasharray]');
        const boxes = [...figure.querySelectorAll('text.level')].map(e => e.getBBox());
        const point = inside.ownerSVGElement.createSVGPoint();
        const corners = b => [0, 1].flatMap(i => [0.2, 0.8].map(j => [b.x + i * b.width, b.y + j * b.height]));
        const clear = b => corners(b).every(([x, y]) => {
            [point.x, point.y] = [x, y];
            return inside.isPointInFill(point);
        });
        const before = (a, b) => a.x + a.width < b.x || a.y + 0.8 * a.height < b.y;
        const apart = (a, b) => before(a, b) || before(b, a);
        return [boxes.length, boxes.every(clear), boxes.every((a, i) => boxes.slice(i + 1).every(b => apart(a, b)))];
    })"""
    found = browser.run(script)
    assert len(found) == 2
    for count, inside, apart in found:
        assert count > 2
        assert inside
        assert apart


@pytest.mark.thorough
def test_tables_and_pictures_name_their_variables_on_paper_too(browser: Browser) -> None:
    browser.send("Emulation.setEmulatedMedia", media="print")
    hidden = (
        "[...document.querySelectorAll('td.variable, figcaption code')].filter(e => !e.getClientRects().length).length"
    )
    shown = "[...document.querySelectorAll('#comparison td.variable')].map(e => e.textContent)"
    try:
        assert browser.run(hidden) == 0
        assert "loaded/pinion_peak_to_peak" in browser.run(shown)
    finally:
        browser.send("Emulation.setEmulatedMedia", media="")


@pytest.mark.thorough
def test_efficiencies_beyond_the_formula_are_hatched(browser: Browser, strength: xr.DataTree) -> None:
    """Where a twentieth of the power loss or more is extrapolated, by the variable itself."""
    share = strength["friction"].to_dataset()["extrapolated_share"].squeeze().transpose("torque", "speed").values
    rows = "[...document.querySelectorAll('#friction table.heat tr')].slice(1)"
    cells = f"{rows}.map(r => [...r.cells].slice(1).map(c => getComputedStyle(c).backgroundImage !== 'none'))"
    hatched = np.array(browser.run(cells))
    assert np.array_equal(hatched, share >= 0.05)
    assert hatched.sum() > 0


@pytest.mark.thorough
def test_what_is_alike_in_all_results_is_told_once(browser: Browser) -> None:
    alike = browser.run("document.querySelector('#comparison .wide .small').textContent")
    assert alike.startswith("Alike in all: ")
    rows = "[...document.querySelectorAll('#comparison .numbers tbody tr')].map(r => r.cells[0].textContent)"
    names = browser.run(rows)
    assert not any(name and f"{name} " in alike.split(": ", 1)[1].split("; ") for name in names)
    dashed = "[...document.querySelectorAll('#comparison .series path')].map(p => p.hasAttribute('stroke-dasharray'))"
    assert set(browser.run(dashed)) == {True, False}


def test_variables_have_units_and_tell_of_which_contact_they_are() -> None:
    force = labelled(xr.Dataset({"force": (("segment", "torque"), [[1.0], [2.0]])}))
    assert force["force"].attrs["units"] == "N"
    assert ordered(force, "force", "torque", "segment").tolist() == [[1.0, 2.0]]
    assert (units_of("light_load_max_pressure"), units_of("member")) == ("MPa", None)
    assert variable_attributes("unloaded_contact_ratio")["long_name"] == "without load: contact ratio"
