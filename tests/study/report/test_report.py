"""The report: its numbers are those of the result, odd results keep it whole, and a browser shows and moves it."""

from __future__ import annotations

import io
import math
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from browser import Browser, opened
from matplotlib.image import imread
from numpy.typing import NDArray
from report_content import coarse, content, unpacked
from runs import call, output_of, read_only, small
from scipy.interpolate import RegularGridInterpolator

from easeoff import InputError, analyze, write_result
from easeoff.cases import Deflections, LoadCase
from easeoff.contact import Status
from easeoff.contact.evaluation.pressure_map import pressure_map
from easeoff.core.attributes import ordered
from easeoff.friction.loaded_contacts import axes_of
from easeoff.geometry.pair.gear_pair import MEMBERS
from easeoff.study import analyze_load_cases, key_numbers, summary_sheet, write_report
from easeoff.study.plot.tooth_view import tooth_view
from easeoff.study.report import page_data
from easeoff.study.report.contact_mesh import mesh_scene, stored_case
from easeoff.study.report.report_file import RESULT_COUNT_LIMIT, report_page
from easeoff.study.report.report_tables import case_tables
from easeoff.study.summary import summary_sheet as sheet_module

Array = NDArray[Any]
SIZE_LIMIT = 6e6  # [byte] of a report


@pytest.fixture(scope="module")
def drive() -> xr.DataTree:
    return read_only(analyze(coarse(), torques=[40.0, 400.0], speed=[1000.0, 3000.0]))


@pytest.fixture(scope="module")
def coast() -> xr.DataTree:
    return read_only(analyze(coarse(mesh_positions=4), torques=[100.0], flank="coast"))


@pytest.fixture(scope="module")
def shown(drive: xr.DataTree) -> Any:
    """Data of the only result of a page."""
    return content(report_page({"drive": drive}))["results"][0]


def changed(tree: xr.DataTree, **groups: xr.Dataset | None) -> xr.DataTree:
    """A copy of a tree with other groups, or without them."""
    found = dict(tree.to_dict()) | {f"/{name}": group for name, group in groups.items()}
    return xr.DataTree.from_dict({name: group for name, group in found.items() if group is not None})


def without_solutions(loaded: xr.Dataset, positions: list[int]) -> xr.Dataset:
    """The group ``/loaded`` as if mesh positions had no certified solution."""
    result = loaded.copy(deep=True)
    for variable in result.data_vars.values():
        if "mesh_position" in variable.dims and "torque" in variable.dims:
            variable[{"mesh_position": positions}] = Status.NOT_CERTIFIED if variable.dtype.kind == "i" else np.nan
    return result


# --- data


@pytest.mark.parametrize("shape", [(7,), (3, 5)])
def test_packed_values_are_within_half_a_step_and_nan_stays(shape: tuple[int, ...]) -> None:
    values = np.random.default_rng(1).normal(size=shape)
    values.flat[2] = np.nan
    found = unpacked(page_data.packed(values))
    assert np.array_equal(np.isnan(found), np.isnan(values))
    span = np.ptp(values[np.isfinite(values)])
    assert 0.0 < np.nanmax(np.abs(found - values)) <= 1.0001 * span / 131068
    assert np.array_equal(unpacked(page_data.packed_exactly(values)), values.astype(np.float32), equal_nan=True)


@pytest.mark.parametrize("values", [[], [np.nan], [2.5, 2.5]])
def test_values_without_a_range_are_packed(values: list[float]) -> None:
    assert np.array_equal(unpacked(page_data.packed(values)), values, equal_nan=True)


def test_a_raster_of_a_linear_field_is_that_field_inside_its_triangles() -> None:
    """And a triangle without area, as at the tips of a load, changes nothing."""
    points = np.array([[0.1, 0.9, 0.2, 0.5], [0.1, 0.3, 0.8, 0.2]])
    values = 2.0 * points[0] - 3.0 * points[1] + 1.0
    grid = page_data.rasterised(points, values, np.array([[0, 1, 2], [0, 3, 1]]), (41, 31))
    t, h = np.meshgrid(np.linspace(0.0, 1.0, 41), np.linspace(0.0, 1.0, 31), indexing="ij")
    inside = np.isfinite(grid)
    assert np.allclose(grid[inside], (2.0 * t - 3.0 * h + 1.0)[inside], atol=1e-12)
    area = 0.5 * abs(0.8 * 0.7 - 0.2 * 0.1)
    assert inside.mean() == pytest.approx(area, rel=0.1)


@pytest.mark.parametrize("member", MEMBERS)
def test_the_pressure_raster_has_the_peak_of_the_pressure_map_in_its_place(drive: xr.DataTree, member: str) -> None:
    at_torque = drive["loaded"].to_dataset().isel(torque=0)
    view = tooth_view(drive, member)  # type: ignore[arg-type]
    raster, exact = page_data.pressure_raster(at_torque, view), pressure_map(at_torque)
    assert 0.97 * exact.peak < raster.max() <= exact.peak * (1.0 + 1e-12)
    place = np.array(np.unravel_index(np.argmax(raster), raster.shape)) / (np.array(raster.shape) - 1)
    wanted = view.fractions(exact.peak_point)
    assert np.allclose(place, wanted, atol=0.05)
    assert np.mean(raster > 0.0) > 0.2


def test_values_between_contact_lines_follow_a_linear_field(drive: xr.DataTree) -> None:
    view = tooth_view(drive)
    carries, points = page_data.on_lines(drive["loaded"].to_dataset().isel(torque=1))
    x, y = view.plane(points)
    raster = page_data.scattered_rasters(points, (x - 2.0 * y)[None], view)[0]
    middle = tuple(n // 2 for n in raster.shape)
    px, py = view.plane(np.array([0.5, 0.5]))
    assert raster[middle] == pytest.approx(px - 2.0 * py, abs=1e-9)
    assert np.all(np.isfinite(raster))
    assert carries.sum() == points.shape[1]


def test_both_members_stand_in_mesh(drive: xr.DataTree) -> None:
    """Turned as the page turns them, flank nodes of both members come to where ``/ease_off`` has their contact."""
    case = stored_case(drive)
    assert case is not None
    scene = mesh_scene(drive, case)
    assert scene is not None
    ease_off = drive["ease_off"].to_dataset()
    action = ordered(ease_off, "action_position", "lengthwise", "profile", "space")
    roll = ordered(ease_off, "roll_angle", "lengthwise", "profile")
    middle = tuple(n // 2 for n in roll.shape)
    axes = axes_of(ease_off)
    for member, ratio in (("pinion", 1.0), ("gear", axes.ratio)):
        own = scene["members"][member]
        points = unpacked(own["flank"]).reshape(-1, 3)
        angle = own["turn"] + own["rate"] * roll[middle]
        axis, origin = np.array(own["axis"]), np.array(own["origin"])
        arm = points - origin
        turned = arm * math.cos(angle) + np.cross(axis, arm) * math.sin(angle)
        turned += np.outer(arm @ axis, axis) * (1.0 - math.cos(angle)) + origin
        distance = np.linalg.norm(turned - action[middle], axis=1)
        # A node of the drawn flank is never further from any point of it than its meshes are wide.
        assert distance.min() < 1.0
        assert own["rate"] == pytest.approx(1.0 / ratio)


def test_drawn_flanks_are_those_of_the_result(drive: xr.DataTree) -> None:
    """Nodes of a tooth's surface, at the fractions that are sent along, lie on the stored flank."""
    case = stored_case(drive)
    assert case is not None
    scene = mesh_scene(drive, case)
    assert scene is not None
    own = scene["members"]["gear"]
    t, h = unpacked(own["places"])
    assert t.min() > -1e-3
    assert np.all(np.diff(t, axis=0) > 0.0)
    assert np.all(np.diff(h, axis=1) > 0.0)
    grid, flanks = unpacked(own["grid"]), drive["flanks"].to_dataset()
    axes = tuple(np.linspace(0.0, 1.0, n) for n in grid.shape[:2])
    on_flank = RegularGridInterpolator(axes, grid, method="cubic")(np.stack([t, h], axis=-1).clip(0.0, 1.0))
    within = (h >= 0.0) & (h <= 1.0)
    assert np.allclose(on_flank[within], unpacked(own["flank"])[within], atol=5e-3)
    stored = ordered(flanks, "position", "member", "lengthwise", "profile", "xyz")[1]
    assert np.allclose(grid, stored, atol=2e-3)


def test_numbers_of_the_page_are_the_key_numbers(drive: xr.DataTree, shown: Any) -> None:
    numbers, result = key_numbers(drive), shown
    rows = {row[2]: [float(cell) for cell in row[3:]] for row in result["loaded_numbers"]["rows"] if row[1] == "MPa"}
    assert rows["loaded/max_pressure"] == numbers["max_pressure"].values.round().tolist()
    for name, _, path, *_ in result["loaded_numbers"]["rows"]:
        group, variable = path.partition(" ")[0].split("/")
        assert variable in drive[group], name
    heads = result["friction"]["table"]["heads"]
    efficiency = [float(row[heads.index("efficiency [%]")]) for row in result["friction"]["table"]["rows"]]
    assert np.allclose(efficiency, 100.0 * drive["friction"].to_dataset()["efficiency"].values.ravel(), atol=0.005)


def test_the_first_numbers_are_the_key_numbers_and_the_power_at_the_speed_of_the_charts(
    drive: xr.DataTree, shown: Any
) -> None:
    first, speed = shown["first_numbers"], shown["friction"]["condition"]["speed"]
    rows = {row[0]: row[3:] for row in first["rows"]}
    ratio = drive.attrs["gear_teeth"] / drive.attrs["pinion_teeth"]
    assert [float(v) for v in rows["torque of the gear, without losses"]] == pytest.approx(
        ratio * np.array([40, 400]), rel=1e-3
    )
    assert [float(v) for v in rows["power of the pinion"]] == pytest.approx(
        speed * np.pi / 3e4 * np.array([40, 400]), rel=1e-3
    )
    assert rows["greatest pressure"] == [f"{v:.0f}" for v in key_numbers(drive)["max_pressure"].values]
    efficiency = 100.0 * np.ravel(drive["friction"].to_dataset()["efficiency"].sel(speed=speed))
    assert [float(v) for v in rows["efficiency"]] == pytest.approx(efficiency, abs=0.005)
    assert f"at {speed:g} 1/min of the pinion, {speed / ratio:.4g} 1/min of the gear" in first["condition"]


def test_names_in_the_tables_of_the_case_name_what_the_key_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each shares a word with its key, is alone in its table, and is what the summary sheet says."""
    monkeypatch.setattr(sheet_module, "case_warnings", lambda _: (None, ()))  # which has no part of the tables
    case = small("fh-design-a", "shell")
    sheet = {row[1]: row[0] for table in summary_sheet(case).tables.values() for row in table}
    for table in case_tables(case):
        rows = [(str(name), str(key).rpartition(".")[2]) for name, _, key, *_ in table["rows"] if key]
        assert len({name for name, _ in rows}) == len(rows)
        for name, key in rows:
            assert set(re.findall(r"[a-z0-9]+", name.lower())) & set(key.split("_")), (name, key)
            assert sheet.get(key, name) == name


def test_stiffness_and_error_along_the_normal_are_those_of_a_rigid_lever(drive: xr.DataTree) -> None:
    """Of a pair whose lever arms are all a, a rotation e closes a e; the force T / a gives T / (a^2 e) of stiffness."""
    ease_off = drive["ease_off"].to_dataset()
    arm = 50.0
    even = ease_off.assign(lever_arm=xr.full_like(ease_off["lever_arm"], arm))
    loaded = drive["loaded"].to_dataset()
    result = content(report_page({"one": changed(drive, ease_off=even, friction=None)}))["results"][0]
    rows = [row for row in result["loaded_numbers"]["rows"] if "along the normal" in row[0]]
    error, stiffness = ([float(value) for value in row[3:]] for row in rows)
    assert np.allclose(error, 1e-3 * arm * loaded["peak_to_peak"].values, atol=6e-4)
    width = 34.5  # mm, of the case, along the pitch cone
    newton_per_um = loaded["mean_mesh_stiffness"].values * 1e6 / arm * 1e3 / (arm * 1e3)
    assert np.allclose(stiffness, newton_per_um / width, rtol=0.02)


def test_a_misalignment_over_the_torque_is_told() -> None:
    axle = Deflections([0.0, 200.0], offset=[0.0, 0.05])
    tree = analyze(small("fm-11x41", "shell"), torques=[100.0], misalignment=axle)
    rows = content(report_page({"axle": tree}))["results"][0]["misalignment"][0]["rows"]
    assert [row[0] for row in rows] == ["0", "100"]
    assert [float(row[1]) for row in rows] == pytest.approx([0.0, 0.025])


def test_shares_of_a_pair_end_where_the_pair_before_it_begins(drive: xr.DataTree, shown: Any) -> None:
    chart = next(chart for chart in shown["charts"]["contact"] if chart["id"] == "load_share")
    share = ordered(drive["loaded"].to_dataset(), "load_share", "torque", "mesh_position", "pair")
    ends = [unpacked(series["y"])[-1] for series in chart["series"] if series["number"] < chart["per"]]
    assert sum(ends) == pytest.approx(100.0, abs=1e-3)
    began = np.sort(100.0 * share[0, 0])[::-1]
    assert sorted(ends, reverse=True) == pytest.approx(began[: len(ends)], abs=1e-3)


# --- odd results


@pytest.mark.parametrize("lost", [[2, 3], list(range(8))])
def test_positions_without_a_solution_leave_a_whole_page(drive: xr.DataTree, lost: list[int]) -> None:
    loaded = without_solutions(drive["loaded"].to_dataset(), lost)
    result = content(report_page({"drive": changed(drive, loaded=loaded, friction=None)}))["results"][0]
    assert result["friction"] is None
    starts = result["segments"]["start"][0]
    assert all(starts[k] == starts[k + 1] for k in lost)
    assert any("no certified solution" in note for note in result["notes"])
    assert f"{8 - len(lost)} of 8" in result["loaded_numbers"]["rows"][-1][3]


def test_load_on_edges_alone_is_told(drive: xr.DataTree) -> None:
    loaded = drive["loaded"].to_dataset()
    edges = loaded.assign(
        pressure=xr.full_like(loaded["pressure"], np.nan), max_pressure=xr.full_like(loaded["max_pressure"], np.nan)
    )
    result = content(report_page({"drive": changed(drive, loaded=edges)}))["results"][0]
    assert not np.any(unpacked(result["pressure"]["gear"][0]))
    assert result["friction"]["fields"]["friction_coefficient"] == [[None, None], [None, None]]


def test_an_older_result_has_what_it_has(drive: xr.DataTree) -> None:
    loaded = drive["loaded"].to_dataset().drop_vars(["edge_share", "overhang"])
    tree = changed(drive, loaded=loaded, friction=None, light_load=None)
    tree.attrs = {key: value for key, value in drive.attrs.items() if key != "case"}
    result = content(report_page({"old": tree}))["results"][0]
    assert result["scene"] is None
    assert result["case"] == []
    assert result["marks"]["light_torque"] is None


def test_text_of_a_case_cannot_leave_the_data(drive: xr.DataTree) -> None:
    tree = changed(drive, friction=None)
    tree.attrs = drive.attrs | {"title": "</script><script>alert(1)</script><!--"}
    page = report_page({"<b>": tree})
    assert "<script>alert" not in page
    assert content(page)["title"] == tree.attrs["title"]


# --- files


def test_the_file_is_small_whole_and_alone(drive: xr.DataTree, coast: xr.DataTree, tmp_path: Path) -> None:
    path = tmp_path / "new" / "report.html"
    write_report([drive, coast], path)
    text = path.read_text(encoding="utf-8")
    assert [result["name"] for result in content(text)["results"]] == ["drive", "coast"]
    assert len(text.encode()) < SIZE_LIMIT
    assert "default-src 'none'" in text
    assert re.findall(r"""(?:src|href)\s*=\s*["'](?!#)""", text) == []
    assert [entry.name for entry in path.parent.iterdir()] == ["report.html"]


def test_a_result_of_load_cases_counts_as_those_of_all(tmp_path: Path) -> None:
    rows = [LoadCase(name="climb", torque=300.0), LoadCase(name="overrun", torque=50.0, flank="coast")]
    write_report(analyze_load_cases(small("fm-11x41", "shell"), rows), tmp_path / "report.html")
    found = content((tmp_path / "report.html").read_text(encoding="utf-8"))["results"]
    assert [(result["name"], result["flank"]) for result in found] == [("climb", "drive"), ("overrun", "coast")]


@pytest.mark.parametrize("count", [0, RESULT_COUNT_LIMIT + 1])
def test_too_few_or_too_many_results_are_refused(drive: xr.DataTree, tmp_path: Path, count: int) -> None:
    with pytest.raises(InputError, match=f"results = {count} results"):
        write_report([drive] * count, tmp_path / "report.html")
    assert list(tmp_path.iterdir()) == []


@pytest.fixture(scope="module")
def file(coast: xr.DataTree, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of a result that keeps no case."""
    path, tree = tmp_path_factory.mktemp("result") / "a.nc", coast.copy()
    tree.attrs = {key: value for key, value in coast.attrs.items() if key != "case"}
    write_result(tree, path)
    return path


@pytest.mark.usefixtures("reading_here")
def test_the_command_names_results_by_their_files(file: Path, tmp_path: Path) -> None:
    output = tmp_path / "r.html"
    files = [shutil.copy(file, tmp_path / name) for name in ("before.nc", "after.nc")]
    said = output_of("report", *files, "-o", output)
    assert re.match(r"wrote .*r\.html: \d\.\d MB\nnext: ", said)
    assert [result["name"] for result in content(output.read_text(encoding="utf-8"))["results"]] == ["before", "after"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["{0}", "-o", "{0}"], "is the file that is read"),
        (["{0}", "-o", "report.pdf"], "must be a name that ends in .html"),
        (["{0}", "{0}", "-o", "r.html"], "must come once, but comes 2 times"),
        (["nasa-12x36", "-o", "r.html"], "is a case, not a result"),
        (["no.nc", "-o", "r.html"], "no.nc"),
        (["-o", "r.html"], "RESULT"),
    ],
)
def test_mistakes_are_one_message_and_leave_no_file(
    file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: list[str], message: str
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copy(file, "a.nc")
    done = call("report", *(word.format("a.nc") for word in words))
    assert done.exit_code == 2
    assert message in done.stderr
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.nc"]


# --- in a browser


@pytest.fixture(scope="module")
def browser(drive: xr.DataTree, coast: xr.DataTree, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    path = tmp_path_factory.mktemp("report") / "report.html"
    write_report({"drive": drive, "coast": coast}, path)
    yield from opened(path)


def pixels(browser: Browser, selector: str) -> Array:
    """Red, green and blue (rows, columns, 3) of an element, from 0 to 1."""
    return np.asarray(imread(io.BytesIO(browser.picture(selector))))[..., :3].astype(float)


def warm(image: Array) -> float:
    """Share of the pixels in the colours of pressure."""
    return float(np.mean(image[..., 0] - image[..., 2] > 0.25))


def slide(browser: Browser, key: str, number: int) -> None:
    """Move a slider as a reader does: by the keys of the keyboard."""
    browser.run(f"document.getElementById('slide-{key}').focus()")
    for name, code, times in (("Home", 36, 1), ("ArrowRight", 39, number)):
        for _ in range(times):
            for kind in ("keyDown", "keyUp"):
                browser.send("Input.dispatchKeyEvent", type=kind, key=name, code=name, windowsVirtualKeyCode=code)


def test_the_page_loads_without_errors_and_asks_the_network_for_nothing(browser: Browser) -> None:
    assert browser.errors == []
    assert browser.run("document.body.dataset.ready") == "yes"
    assert [url for url in browser.requests if not url.startswith("file:")] == []


@pytest.mark.thorough
def test_names_of_variables_can_be_switched_off(browser: Browser) -> None:
    shown = "[...document.querySelectorAll('code, .variable, .variable-line')].filter(e => e.offsetParent).length"
    before = browser.run(shown)
    browser.run("document.getElementById('variable-names').click()")
    assert before > 100
    assert browser.run(shown) == 0
    browser.run("document.getElementById('variable-names').click()")
    assert browser.run(shown) == before


@pytest.mark.thorough
def test_no_picture_is_empty_and_none_stands_over(browser: Browser) -> None:
    numbers = browser.run(
        "[...document.querySelectorAll('figure')].map(f => [f.id, f.getBoundingClientRect().right, "
        "f.querySelectorAll('canvas, svg path, table, .none').length])"
    )
    assert len(numbers) > 50
    assert all(right <= 1300.0 for _, right, _ in numbers)
    assert [name for name, _, count in numbers if not count] == []
    assert browser.run("document.documentElement.scrollWidth") <= 1300


@pytest.mark.thorough
def test_more_torque_colours_more_of_the_flank(browser: Browser) -> None:
    """The share of the coloured pixels is that of the loaded area in the result's own map."""
    shares = []
    for number in (0, 2):
        slide(browser, "torque", number)
        shares.append(warm(pixels(browser, "#r0-pressure-gear .stage")))
    assert 0.05 < shares[0] < 0.6 * shares[1] < 0.6


@pytest.mark.thorough
def test_the_mesh_position_moves_the_contact(browser: Browser) -> None:
    slide(browser, "torque", 2)
    found = []
    for number in (0, 4):
        slide(browser, "position", number)
        found.append((pixels(browser, "#r0-bands-gear .stage"), pixels(browser, "#r0-teeth canvas")))
    (flat, teeth), (later, teeth_later) = found
    assert all(0.005 < warm(image) < 0.3 for image in (flat, later))
    moved = np.mean(np.abs(flat - later).max(axis=2) > 0.2)
    assert moved > 0.005
    assert np.mean(np.abs(teeth - teeth_later).max(axis=2) > 0.1) > 0.01
    assert browser.run("document.querySelector('#r0-bands-gear .foot').textContent").startswith(
        "400 N m, mesh position 0.5"
    )


@pytest.mark.thorough
@pytest.mark.parametrize("teeth", ["#r0-teeth", "#r1-teeth"], ids=["drive", "coast"])
def test_the_teeth_fill_their_picture_carry_pressure_and_turn(browser: Browser, teeth: str) -> None:
    before = pixels(browser, f"{teeth} canvas")
    assert 0.4 < np.mean(before.min(axis=2) < 0.95) < 0.95
    assert warm(before) > 2e-4
    left, top, width, height = browser.place(f"{teeth} canvas")
    middle = (left + 0.5 * width, top + 0.5 * height)
    browser.drag(middle, (middle[0] + 120.0, middle[1] + 30.0))
    after = pixels(browser, f"{teeth} canvas")
    assert np.mean(np.abs(before - after).max(axis=2) > 0.1) > 0.1


def test_the_pointer_reads_the_pressure_of_the_result(browser: Browser, drive: xr.DataTree) -> None:
    slide(browser, "torque", 2)
    at_torque = drive["loaded"].to_dataset().isel(torque=1)
    exact, view = pressure_map(at_torque), tooth_view(drive)
    left, top, width, height = browser.place("#r0-pressure-gear .stage")
    x0, y0, wide, high = (float(v) for v in browser.run(
        "document.querySelector('#r0-pressure-gear .stage svg').getAttribute('viewBox')"
    ).split())  # fmt: skip
    x, y = view.plane(exact.peak_point)
    browser.move(left + (x - x0) / wide * width, top + (-y - y0) / high * height)
    told = browser.run("document.querySelector('.hint').textContent")
    pressure, place, source = told.split("\n")
    assert float(pressure.removesuffix(" MPa")) == pytest.approx(exact.peak, rel=0.03)
    t, h = 100.0 * exact.peak_point
    assert place == f"{t:.0f} % from the toe, {h:.0f} % from the root of the gear"
    assert source == "loaded/pressure"


def test_a_result_without_friction_says_so(browser: Browser) -> None:
    assert "coast has no friction" in browser.run("document.getElementById('friction').textContent")


@pytest.mark.thorough
def test_the_address_chooses_torque_and_mesh_position(browser: Browser) -> None:
    words = "document.querySelector('#r0-bands-gear .foot').textContent"
    path = Path(browser.run("location.pathname"))
    for fragment, said in (("torque=40&position=0.25", "40 N m, mesh position 0.25"), ("torque=400", "400 N m")):
        browser.open(path, fragment)
        assert browser.run(words).startswith(said)


@pytest.mark.thorough
def test_the_page_prints_on_a_handful_of_sheets(browser: Browser) -> None:
    found = browser.pdf()
    assert found.startswith(b"%PDF")
    assert 6 <= len(re.findall(rb"/Type\s*/Page\b", found)) <= 24
