"""Figures as functions: panels, the caller's axes, names of files, formats, and the command that chooses among them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.patches import Rectangle
from matplotlib.text import Text
from pages import drawn_pages, drawn_result
from runs import output_of, refusal_of, small, text_file

import easeoff
from easeoff import InputError, plot
from easeoff.cases import LoadCase, with_supports
from easeoff.study import WearLaw, analyze_load_cases, vh_check, wear
from easeoff.study.plot import written_pictures
from easeoff.study.plot.friction_charts import loaded_map
from easeoff.study.plot.page import small_print
from easeoff.study.plot.tooth_view import EDGE_NAME
from easeoff.study.plot.written_pictures import (
    FURTHER_PICTURES,
    PICTURES,
    file_prefix,
    pictures_of_results,
    result_mark,
)
from easeoff.study.summary.curves import root_stress_charts
from easeoff.study.sweep.sweep_file import write_sweep


@pytest.fixture
def tree() -> xr.DataTree:
    return drawn_result().copy(deep=False)


def panels(page: Figure) -> list[Axes]:
    """The axes of a page but those of colour bars and what is not shown."""
    return [axes for axes in page.axes if axes.get_visible() and not hasattr(axes, "_colorbar")]


@pytest.fixture
def stressed(tree: xr.DataTree) -> xr.DataTree:
    """A result with root stress of known values."""
    shape = {"torque": 3, "member": 2, "mesh_position": 3, "pair": 3}
    history = np.arange(np.prod([*shape.values()]), dtype=float).reshape(tuple(shape.values()))
    history[0, 0, 1] = np.nan
    coords = {"torque": tree["loaded"]["torque"].values, "member": ["pinion", "gear"], "lengthwise": [0.0, 0.5, 1.0]}
    data = {
        "root_stress": (("torque", "member", "lengthwise"), np.arange(18.0).reshape(3, 2, 3)),
        "root_stress_history": (tuple(shape), history),
    }
    whole = xr.DataTree.from_dict({**tree.to_dict(), "/root_stress": xr.Dataset(data, coords=coords)})
    whole.attrs = tree.attrs
    return whole


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("result") / "out.nc"
    easeoff.write_result(drawn_result(), path)
    return path


# --- functions


def test_every_picture_of_a_result_is_a_public_function(tree: xr.DataTree) -> None:
    pages = drawn_pages()
    assert {*PICTURES, *FURTHER_PICTURES} <= set(plot.__all__)
    assert tuple(pages) == (*PICTURES, "friction_maps", "efficiency")
    for figure in pages.values():
        assert isinstance(figure, Figure)
        heading, title = (text.get_text() for text in figure.texts[:2])
        assert heading
        assert title == tree.attrs["title"]
    counts = {"ease_off": 1, "contact_pattern": 6, "pressure": 6, "transmission_error": 4, "load_sharing": 3}
    assert {name: len(panels(pages[name])) for name in counts} == counts


@pytest.mark.parametrize(
    ("name", "options", "count"),
    [
        ("ease_off", {}, 1),
        ("contact_pattern", {"member": "pinion"}, 3),
        ("contact_pattern", {"parts": ["print", "lines"], "member": "gear"}, 2),
        ("pressure", {"torque": [50.0, 200.0]}, 4),
        ("pressure", {"torque": 100, "member": "gear"}, 1),
        ("transmission_error", {}, 4),
        ("transmission_error", {"parts": "orders", "torque": 100.0}, 1),
        ("load_sharing", {}, 3),
        ("load_sharing", {"torque": 200.0}, 1),
        ("friction_maps", {"quantities": ["sliding_velocity", "lambda_ratio"], "torque": 50.0, "speed": 500.0}, 2),
        ("efficiency", {}, 3),
        ("efficiency", {"parts": "speed"}, 1),
        ("root_stress", {}, 4),
        ("root_stress", {"member": "gear", "parts": "face"}, 1),
    ],
)
def test_panels_come_on_a_page_or_on_axes_of_ones_own(
    stressed: xr.DataTree, name: str, options: dict[str, Any], count: int
) -> None:
    draw, pages = getattr(plot, name), drawn_pages()
    shown = panels(draw(stressed, **options) if options or name not in pages else pages[name])
    assert len(shown) == count
    figure = Figure()
    grid = figure.subplots(count, 1, squeeze=False)
    assert draw(stressed, **options, axes=grid if count > 1 else grid[0, 0]) is None
    assert not figure.texts  # no heading, no small print
    for own, of_page in zip(grid[:, 0], shown, strict=True):
        assert own.has_data()
        assert own.get_title(loc="left").strip() == of_page.get_title(loc="left") or not of_page.get_title(loc="left")
        assert len(own.lines) == len(of_page.lines)
        assert len(own.collections) == len(of_page.collections)
    with pytest.raises(InputError, match=rf"axes = {count + 1} of Axes: must be "):
        draw(stressed, **options, axes=[*grid[:, 0], Figure().subplots()])


def test_axes_of_a_subfigure_keep_the_settings_of_the_caller(tree: xr.DataTree) -> None:
    figure = Figure()
    left, right = np.ravel(np.array(figure.subfigures(1, 2), dtype=object))
    with matplotlib.rc_context({"lines.linestyle": ":"}):
        plot.load_sharing(tree, torque=50.0, axes=left.subplots())
        page = plot.load_sharing(tree, torque=50.0)
    assert {line.get_linestyle() for line in left.axes[0].lines} == {":"}
    assert {line.get_linestyle() for line in page.axes[0].lines} == {"-"}
    assert right.axes == []


def own_grid(layout: Any) -> tuple[Figure, Any]:
    """Four panels of the default size."""
    figure = Figure(layout=layout)
    return figure, figure.subplots(2, 2)


@pytest.mark.parametrize("layout", [None, "constrained"])
def test_nothing_is_cut_off_or_covered_in_panels_of_ones_own(tree: xr.DataTree, layout: Any) -> None:
    figure, axes = own_grid(layout)
    plot.transmission_error(tree, parts="loaded", axes=axes[0, 0])
    plot.pressure(tree, torque=100.0, member="gear", axes=axes[0, 1])
    plot.ease_off(tree, axes=axes[1, 0])
    plot.efficiency(tree, parts="speed", axes=axes[1, 1])
    figure.draw_without_rendering()
    for curves in (axes[0, 0], axes[1, 1]):
        legend, box = curves.get_legend().get_window_extent(), curves.get_window_extent()
        assert box.x0 <= legend.x0 < legend.x1 <= box.x1
        assert box.y0 <= legend.y0 < legend.y1 <= box.y1 + 1.0
        highest = max(float(np.max(line.get_ydata())) for line in curves.lines if len(line.get_ydata()))
        assert curves.transData.transform((0.0, highest))[1] <= legend.y0
    (bar,) = (one for one in figure.axes if hasattr(one, "_colorbar"))
    for flank in (axes[0, 1], axes[1, 0]):
        names = {text.get_text(): text.get_window_extent() for text in flank.texts if text.get_gid() == EDGE_NAME}
        assert sorted(names) == ["heel", "root", "tip", "toe"]
        assert all(not name.overlaps(bar.get_window_extent()) for name in names.values())
        ticks = [text.get_window_extent() for text in flank.get_yticklabels() if text.get_text()]
        assert ticks
        assert all(not names["toe"].overlaps(tick) for tick in ticks)


def test_panels_of_ones_own_name_the_quantity_in_the_sizes_of_their_figure(tree: xr.DataTree) -> None:
    for size in (7.0, 14.0):
        with matplotlib.rc_context({"font.size": size}):
            axes = own_grid(None)[1]
            axes[0, 0].set_title("mine", fontsize=5.0)
            plot.transmission_error(tree, parts="loaded", axes=axes[0, 0])
            plot.ease_off(tree, axes=axes[0, 1])
        assert axes[0, 0].get_title() == "mine"
        assert axes[0, 0].title.get_fontsize() == 5.0
        assert axes[0, 0].get_title(loc="left") == "transmission error"
        assert axes[0, 0].get_ylabel() == "lag under load [µrad]"
        assert axes[0, 1].get_title(loc="left") == "ease-off [µm]"
        for own in axes[0]:
            assert own._left_title.get_fontsize() == pytest.approx(size)
            assert own.xaxis.label.get_fontsize() == pytest.approx(size, rel=0.2)
            assert own.xaxis.get_ticklabels()[0].get_fontsize() == pytest.approx(size, rel=0.2)


def test_flanks_on_axes_of_ones_own_have_ticks_across_and_titles_on_one_level(tree: xr.DataTree) -> None:
    figure = Figure(figsize=(9.0, 3.0), layout="constrained")
    axes = figure.subplots(1, 2)
    plot.pressure(tree, torque=100.0, axes=axes)
    figure.canvas.draw()
    assert len({panel.get_title(loc="left").count("\n") for panel in axes}) == 1
    tops = [panel.get_window_extent().y1 for panel in axes]
    assert tops[0] == pytest.approx(tops[1], abs=0.5)
    low, high = axes[0].get_ylim()
    assert np.count_nonzero([low <= tick <= high for tick in axes[0].get_yticks()]) >= 2


def test_the_small_print_of_the_pressure_is_of_the_torques_shown(tree: xr.DataTree) -> None:
    loaded = tree["loaded"].to_dataset()
    share = xr.zeros_like(loaded["edge_share"]) + xr.DataArray([0.05, 0.2, 0.3], dims="torque")
    changed = tree.copy()
    changed["loaded"] = xr.DataTree(loaded.assign(edge_share=share.transpose(*loaded["edge_share"].dims)))
    for torque in loaded["torque"].values.tolist():
        drawn: Any = plot.pressure(changed, torque=torque, member="gear").findobj(Text)
        words = " ".join(text.get_text() for text in drawn).replace("\n", " ")
        told = [other for other in loaded["torque"].values if f"of the load ({other:g} N m)" in words]
        assert told == [torque]


def test_a_torque_draws_its_own_values(tree: xr.DataTree) -> None:
    loaded = tree["loaded"].to_dataset().sel(torque=100.0)
    figure = plot.transmission_error(tree, torque=100.0, parts=["loaded", "orders"])
    (course,) = figure.axes[0].lines
    error = loaded["transmission_error"].values
    np.testing.assert_array_equal(course.get_ydata(), [*error, *error, error[0]])
    heights = [bar.get_height() for bar in figure.axes[1].patches if isinstance(bar, Rectangle)]
    np.testing.assert_allclose(heights, loaded["harmonic"].values)
    over_torque = plot.transmission_error(tree, parts="orders").axes[0].lines
    for number, line in enumerate(over_torque):
        np.testing.assert_array_equal(line.get_xdata(), [50.0, 100.0, 200.0])
        np.testing.assert_array_equal(line.get_ydata(), tree["loaded"]["harmonic"].isel(order=number).values)
    pressure = plot.pressure(tree, torque=100.0, member="gear")
    assert pressure.axes[0].get_title(loc="right") == f"peak {float(loaded['max_pressure']):.0f} MPa"


def test_root_stress_over_the_cycle_is_the_greatest_of_the_pairs(stressed: xr.DataTree) -> None:
    stress = stressed["root_stress"].to_dataset()
    charts = {(one.name, one.member): one for one in root_stress_charts(stress, np.arange(stress.sizes["torque"]))}
    found = charts["root_cycle", "pinion"].curves[0].y
    np.testing.assert_array_equal(found, [2.0, np.nan, 8.0, 2.0])  # the first one again at the end
    face, cycle = plot.root_stress(stressed, member="gear", torque=200.0).axes
    np.testing.assert_array_equal(face.lines[0].get_ydata(), [15.0, 16.0, 17.0])
    assert np.max(np.asarray(cycle.lines[0].get_ydata())) == 53.0
    for axes in plot.root_stress(stressed).axes:  # no line runs out of its panel
        greatest = max(np.nanmax(np.asarray(line.get_ydata())) for line in axes.lines)
        assert axes.get_ylim()[0] <= 0.0 < greatest < axes.get_ylim()[1]


@pytest.mark.parametrize(
    ("name", "options", "said"),
    [
        ("pressure", {"torque": 75.0}, "torque = 75: must be one of the result's: 50, 100, 200 N m"),
        ("pressure", {"member": "pinio"}, "member = 'pinio': must be one of pinion, gear; did you mean 'pinion'?"),
        (
            "transmission_error",
            {"parts": "load"},
            "parts = 'load': must be one of unloaded, loaded, about_mean, orders",
        ),
        ("transmission_error", {"parts": []}, "parts: must name one at least of unloaded"),
        ("contact_pattern", {"marking": -1.0}, "marking = -1"),
        ("friction_maps", {"speed": 700.0}, "speed = 700: must be one of the result's: 500, 1500 1/min"),
        ("friction_maps", {"quantities": "film"}, "quantities = 'film': must be one of rolling_velocity, sliding_vel"),
        ("efficiency", {"parts": "roughness"}, "parts = 'roughness': must be one of cycle, speed, torque"),
        ("root_stress", {}, "tree: the result has no group 'root_stress': finite-element teeth have it"),
        ("misalignment", {}, "tree: its misalignment does not depend on the torque"),
        ("deviations", {}, "tree: its flanks have no deviations"),
        ("optimization", {}, "tree: the result has no group 'optimization': it must be a result of 'easeoff modify'"),
        ("load_cases", {}, "tree: the result has no group 'load_cases': it must be a result over load cases"),
    ],
)
def test_mistakes_say_what_there_is(tree: xr.DataTree, name: str, options: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as caught:
        getattr(plot, name)(tree, **options)
    assert said in str(caught.value)


@pytest.mark.parametrize("wrong", [xr.DataTree(), xr.Dataset(), None, "out.nc"])
def test_what_is_no_result_is_refused(wrong: Any) -> None:
    for draw in (plot.pressure, plot.friction_maps, plot.pictures):
        with pytest.raises(InputError, match="must be"):
            draw(wrong)


def test_friction_maps_leave_out_what_has_no_pressure_and_have_colour_bars(tree: xr.DataTree) -> None:
    friction, loaded = tree["friction"].to_dataset(), tree["loaded"].to_dataset().isel(torque=2)
    here = friction["friction_coefficient"].isel(torque=2, speed=0, temperature=0, roughness=0)
    assert bool((here.notnull() & loaded["pressure"].isnull()).any())  # of edges
    carried = here.where(loaded["pressure"] > 0.0)
    assert loaded_map(loaded, here).values.size == int(carried.notnull().sum())
    figure = plot.friction_maps(tree, torque=200.0, speed=500.0, quantities="friction_coefficient")
    digits = figure.axes[0].get_title(loc="right").split(" to ")
    np.testing.assert_allclose([float(one) for one in digits], [carried.min(), carried.max()], atol=1e-3)
    assert [hasattr(axes, "_colorbar") for axes in figure.axes] == [False, True]


def test_efficiency_marks_conditions_beyond_the_range_of_the_formula(tree: xr.DataTree) -> None:
    changed = tree.copy()
    share = 0.0 * changed["friction"].to_dataset()["extrapolated_share"]
    share[{"speed": 0}] = 0.5
    changed["friction"] = changed["friction"].to_dataset().assign(extrapolated_share=share)
    axes = plot.efficiency(changed, parts="speed").axes[0]
    marks = [line for line in axes.lines if line.get_marker() == "o"]
    assert len(marks) == 2 * 3  # two a torque
    for line in marks:
        wanted = [500.0] if str(line.get_markerfacecolor()) == "white" else [1500.0]
        assert np.asarray(line.get_xdata()).tolist() == wanted


# --- studies


@pytest.mark.thorough
def test_load_cases_of_both_flanks_are_drawn_into_their_folders(tmp_path: Path) -> None:
    rows = [LoadCase(name="climb", torque=100.0), LoadCase(name="brake", torque=50.0, flank="coast")]
    tree = analyze_load_cases(small(compliance="shell"), rows)
    assert plot.pictures(tree) == ("load_cases",)
    axes = Figure().subplots(1, 3)
    plot.load_cases(tree, axes=axes)
    assert all(one.has_data() for one in axes)
    written = plot.write_pictures(tree, tmp_path, names=["load_cases", "pressure"], dpi=30)
    assert [path.relative_to(tmp_path).as_posix() for path in written] == [
        "nasa-12x36-load_cases.png",
        "climb/nasa-12x36-drive-pressure.png",
        "brake/nasa-12x36-coast-pressure.png",
    ]
    (only,) = plot.write_pictures(tree, tmp_path, names="load_sharing", flank="coast", dpi=30)
    assert only == tmp_path / "brake" / "nasa-12x36-coast-load_sharing.png"
    with pytest.raises(InputError, match="torque: must go with a result of 'easeoff run' without load cases"):
        plot.write_pictures(tree, tmp_path, torque=50.0)


@pytest.mark.thorough
def test_sweeps_and_wear_are_drawn_from_their_files(tmp_path: Path) -> None:
    found = easeoff.sweep(small(compliance="shell"), {"E": [-0.02, 0.02], "flank": ["drive", "coast"]}, torques=[100.0])
    write_sweep(found, tmp_path / "sweep.nc")
    assert "sweep_curves" in plot.pictures(found)
    axes = Figure().subplots()
    plot.sweep(found, "curves", names=["max_pressure"], axes=axes)
    assert axes.get_title(loc="left") == "greatest pressure [MPa]"
    with pytest.raises(InputError, match=r"picture = 'curvs': must be one of curves, .*did you mean 'curves'"):
        plot.sweep(found, "curvs")
    assert file_prefix(found) == "nasa-12x36"
    output_of("plot", tmp_path / "sweep.nc", "-o", tmp_path / "p", "--flank", "coast", "--pictures", "sweep_curves")
    history = wear(small(compliance="shell"), WearLaw(1e-12, 1e-12, 1e6), torque=100.0)
    history.to_netcdf(tmp_path / "wear.nc", engine="netcdf4")
    output_of("plot", tmp_path / "wear.nc", tmp_path / "p", "--format", "pdf")
    assert {path.name for path in (tmp_path / "p").iterdir()} == {
        "nasa-12x36-coast-sweep_curves.png",
        "nasa-12x36-drive-wear.pdf",
    }
    depth = plot.wear(history, parts="largest_depth").axes[0].lines
    np.testing.assert_array_equal(depth[0].get_ydata(), history["largest_depth"].sel(member="pinion").values)
    history.isel(member=[0, 0]).to_netcdf(tmp_path / "bad.nc", engine="netcdf4")
    assert "bad.nc is damaged, changed by hand" in refusal_of("plot", tmp_path / "bad.nc", tmp_path / "p")


@pytest.mark.thorough
def test_prints_of_a_check_come_on_axes_of_ones_own(tmp_path: Path) -> None:
    found = vh_check("fh-design-a", grid=(2, 2))
    axes = Figure().subplots(1, 7)
    plot.vh_check(found, axes=axes)
    page = plot.vh_check(found)
    assert [len(one.lines) for one in axes] == [len(one.lines) for one in page.axes]
    with pytest.raises(InputError, match="axes = 7 of Axes: must be 3 Axes"):
        plot.vh_check(found, parts="places", axes=axes)
    flat = found["in_plane"].where(found["plane_axis"] == found["plane_axis"][0], 0.0)
    wrong = (found.assign(in_plane=plane) for plane in (found["in_plane"] * np.nan, flat))
    for number, broken in enumerate((found.drop_vars("v"), *wrong)):
        broken.to_netcdf(tmp_path / f"{number}.nc", engine="netcdf4")
        assert "is damaged, changed by hand" in refusal_of("plot", tmp_path / f"{number}.nc", tmp_path / "p")


# --- files


def test_files_are_named_after_case_and_flank(tree: xr.DataTree, tmp_path: Path) -> None:
    assert tree.attrs["case_name"] == "nasa-12x36"
    assert file_prefix(tree) == "nasa-12x36-drive"
    older = {key: value for key, value in tree.attrs.items() if key != "case_name"}
    assert file_prefix(xr.DataTree(xr.Dataset(attrs=older))) == "12x36-drive"
    for name, expected in (("../../etc/x y", "etc_x_y"), ("-.", "result"), ("Größe", "Größe"), ("a" * 200, "a" * 80)):
        assert file_prefix(xr.Dataset(attrs={"case_name": name})) == expected
    for flanks, expected in ((["coast"], "axle-coast"), (["drive", "coast"], "axle")):  # those of a sweep
        assert file_prefix(xr.Dataset(coords={"flank": flanks}, attrs={"case_name": "axle"})) == expected
    own = text_file(tmp_path / "my axle.toml", easeoff.cases.case_text("nasa-12x36"))
    assert easeoff.read_case(own).name == "my axle"


@pytest.mark.parametrize(("suffix", "begin"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_formats_are_marked_and_the_same_twice(tree: xr.DataTree, tmp_path: Path, suffix: str, begin: bytes) -> None:
    for folder in ("first", "second"):
        (path,) = plot.write_pictures(tree, tmp_path / folder, names="load_sharing", torque=50.0, file_format=suffix)
        assert path.name == f"nasa-12x36-drive-load_sharing.{suffix}"
        assert path.read_bytes().startswith(begin)
        ((_, mark),) = pictures_of_results(path.parent).values()
        assert mark == result_mark(tree)
    assert path.read_bytes() == (tmp_path / "first" / path.name).read_bytes()


def test_the_mark_of_a_result_is_that_of_what_was_analysed(tree: xr.DataTree, result: Path) -> None:
    """Not of when, nor of whether it went through a file."""
    assert result_mark(easeoff.read_result(result)) == result_mark(tree)
    later = tree.copy()
    later.attrs = {**tree.attrs, "history": "another day"}
    assert result_mark(later) == result_mark(tree)
    moved = tree.copy()
    moved.attrs = {**tree.attrs, "misalignment_offset_mm": 0.1}
    assert result_mark(moved) != result_mark(tree)


def test_the_command_chooses(tree: xr.DataTree, result: Path, tmp_path: Path) -> None:
    words = ["--pictures", "load_sharing, transmission_error", "--torque", "100", "--dpi", "40"]
    said = output_of("plot", result, "-o", tmp_path / "p", *words)
    names = [f"nasa-12x36-drive-{name}.png" for name in ("load_sharing", "transmission_error")]
    assert said.splitlines() == [f"wrote {tmp_path / 'p' / name}" for name in names]
    whole = plot.load_sharing(tree, torque=100.0)
    height, width = imread(tmp_path / "p" / names[0]).shape[:2]
    assert (width, height) == tuple(int(40 * inches) for inches in whole.get_size_inches())


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ["--pictures", "presure"],
            [
                "pictures = 'presure': must be one of ease_off, contact_pat",
                "did you mean 'pressure'?",
            ],
        ),
        (["--pictures", "pressure,pressure"], ["pressure comes twice"]),
        (["--torque", "75"], ["torque = 75: must be one of the result's: 50, 100, 200 N m"]),
        (["--torque", "100", "--pictures", "ease_off"], ["torque: must go with one of the pictures pressure, tran"]),
        (["--flank", "coast"], ["flank = 'coast': must be one of the result's: drive"]),
        (["--format", "svg", "--dpi", "100"], ["--dpi: must go with --format png"]),
        (["--format", "gif"], ["--format"]),
        (["{tmp}/q"], ["FOLDER: must be given once"]),
    ],
)
def test_wrong_choices_are_refused_before_anything_is_written(
    tree: xr.DataTree, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: list[str], said: list[str]
) -> None:
    monkeypatch.setattr(written_pictures, "read_drawn", lambda _: tree)
    done = refusal_of("plot", "out.nc", "-o", tmp_path / "p", *(word.format(tmp=tmp_path) for word in words))
    assert all(part in done for part in said)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.thorough
def test_a_sweep_leaves_the_pictures_of_a_result(tree: xr.DataTree, tmp_path: Path) -> None:
    kept = plot.write_pictures(tree, tmp_path, names="pressure")
    plot.write_pictures(easeoff.sweep(small(compliance="shell"), {"E": [0.0, 0.02]}, torques=[100.0]), tmp_path)
    assert kept[0].exists()


# --- the footer


@pytest.mark.thorough
def test_the_footer_names_the_supports() -> None:
    case = with_supports(small("fm-11x41", "shell"), "axle-fm-11x41")
    tree = easeoff.analyze(case, torques=[100.0])
    assert tree.attrs["supports_name"] == "axle-fm-11x41"
    assert "on supports axle-fm-11x41" in small_print(tree.attrs)
    assert "on supports axle-fm-11x41" in plot.ease_off(tree).texts[-1].get_text()
    own = case.model_copy()
    own._supports_name = ""
    assert own.supports_name == "of the case"
    assert case.model_copy(update={"supports": None}).supports_name == ""
