"""The accessor of a tree and of a sweep in a notebook: summary, pictures, tables and file; its refusal of others."""

from __future__ import annotations

import inspect
import math
import subprocess
import sys
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse
from runs import small

import easeoff
from easeoff import InputError
from easeoff.cases import Case, LoadCase, case_toml, parse_case, read_case
from easeoff.contact.evaluation.pressure_map import LineEnd
from easeoff.core.import_hooks import after_import, show_figures_in_notebooks
from easeoff.geometry import Misalignment
from easeoff.study import analyze_load_cases, key_numbers
from easeoff.study.summary.assembly import bearing_loads
from easeoff.study.summary.result_summary import CLAMPED_NOTE, ROUGH_NOTE, result_summary, unloaded_rows
from easeoff.study.summary.sweep_report import sweep_head, sweep_summary, sweep_tables
from easeoff.study.summary.table import html_table, html_text
from easeoff.study.sweep import read_sweep, sensitivities


@cache
def coarse() -> Case:
    return parse_case(case_toml(small(compliance="shell")))


@pytest.fixture(scope="module")
def tree() -> xr.DataTree:
    errors = Misalignment(offset=0.02, shaft_angle=math.radians(0.05))
    return easeoff.analyze(coarse(), torques=[100.0, 200.0], misalignment=errors, speed=1000.0)


@pytest.fixture(scope="module")
def duty() -> xr.DataTree:
    return analyze_load_cases(coarse(), [LoadCase(torque=100.0, name="climb", Sigma=0.1), LoadCase(torque=200.0)])


class Cells(HTMLParser):
    """Texts of the cells of the tables of a page, and its tags."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.tags: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: Any) -> None:
        self.tags.append(tag)
        if tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_data(self, data: str) -> None:
        if self.tags and self.tags[-1] in ("td", "th") and self.rows:
            self.rows[-1][-1] += data


@pytest.mark.parametrize(
    "code",
    [
        "import xarray, easeoff",
        "import easeoff, importlib\nimportlib.import_module('xarray.core.dtypes')\nimport xarray",
    ],
)
def test_every_tree_has_it_whichever_is_imported_first(code: str) -> None:
    code += "\nimport sys; print(xarray.DataTree().easeoff, [m for m in sys.meta_path if 'AfterImport' in repr(m)])"
    done = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=True)
    assert "must be a result of easeoff.analyze" in done.stdout
    assert done.stdout.strip().endswith("[]")  # the finder is gone


def test_the_summary_is_that_of_show(tree: xr.DataTree) -> None:
    summary = tree.easeoff.summary()
    assert str(summary) == repr(summary) == repr(tree.easeoff) == result_summary(tree)


def test_tables_hold_the_key_numbers_in_the_units_people_read(tree: xr.DataTree, duty: xr.DataTree) -> None:
    tables = tree.easeoff.summary().tables
    numbers = key_numbers(tree)
    loaded = tables["loaded"]
    assert loaded.index.name == "torque [N m]"
    assert loaded.index.tolist() == [100.0, 200.0]
    np.testing.assert_array_equal(loaded["max_pressure [MPa]"], numbers["max_pressure"])
    np.testing.assert_array_equal(loaded["harmonic 2 [urad]"], numbers["harmonic"].sel(order=2))
    assert tables["unloaded"]["unloaded_peak_to_peak [urad]"].item() == numbers["unloaded_peak_to_peak"].item()
    friction = tables["friction"]
    assert friction.index.names == ["torque [N m]", "speed [1/min]", "temperature [degC]", "roughness [um]"]
    np.testing.assert_array_equal(friction["efficiency"], numbers["efficiency"].values.ravel())
    assert {name for table in tables.values() for name in table if "[rad" in name or "[N mm" in name} == set()
    assert sum(map(len, (table.columns for table in tables.values()))) >= len(numbers.data_vars)
    cases = duty.easeoff.summary().tables["load_cases"]
    assert cases.index.tolist() == ["climb", "2"]
    assert cases["misalignment_shaft_angle [deg]"].tolist() == pytest.approx([0.1, 0.0])
    kept = duty["load_cases"].to_dataset()["misalignment_shaft_angle"]
    assert kept.attrs["units"] == "rad"
    assert kept.values.tolist() == pytest.approx([math.radians(0.1), 0.0])


def test_names_of_rows_are_on_the_left_and_numbers_under_heads_on_the_right() -> None:
    left, right = '<td style="text-align:left">a</td>', '<td style="text-align:right">1</td>'
    assert html_table([], [["a"]]) == f"<table><tbody><tr>{left}</tr></tbody></table>"
    assert f"<tbody><tr>{left}{right}</tr></tbody>" in html_table(["name", "value"], [["a", "1"]])


def test_the_page_shows_the_numbers_of_the_text(tree: xr.DataTree) -> None:
    page = tree.easeoff.summary()._repr_html_()
    assert page == tree.easeoff._repr_html_()
    rows = {row[0]: row[1:] for row in Cells(page).rows}
    numbers = key_numbers(tree)
    assert rows["torque at the pinion [N m]"] == ["100", "200"]
    assert rows["greatest pressure [MPa]"] == [f"{value:.0f}" for value in numbers["max_pressure"].values]
    friction = tree["friction"].to_dataset()
    conditions = [row for row in Cells(page).rows if len(row) == 10][1:]
    assert [row[:4] for row in conditions] == [["100", "1000", "90", "0.8"], ["200", "1000", "90", "0.8"]]
    assert [row[7] for row in conditions] == [f"{100 * value:.2f}" for value in friction["efficiency"].values.ravel()]
    assert rows["misalignment"] == ["E +0.02 mm, Sigma +0.05 °"]
    for name, words in unloaded_rows(numbers):
        (shown,) = rows[name.strip().replace(" um", " µm")]
        assert shown.strip() == words.replace(" urad", " µrad").replace(" um", " µm")
    assert "script" not in Cells(page).tags
    assert len(page) < 20_000


def test_the_page_marks_what_is_outside_the_ranges_as_the_text_does(tree: xr.DataTree) -> None:
    assert ROUGH_NOTE not in str(tree.easeoff.summary())
    changed = tree.copy(deep=True)
    friction = changed["friction"].to_dataset()
    share = xr.full_like(friction["mean_friction_coefficient"], 0.9)
    clamped = xr.ones_like(friction["temperature_clamped"])
    changed["friction"] = xr.DataTree(friction.assign(extrapolated_share=share, temperature_clamped=clamped))
    summary = changed.easeoff.summary()
    page = summary._repr_html_()
    for note in (ROUGH_NOTE, CLAMPED_NOTE):
        assert note in str(summary)
        assert html_text(note) in page
    conditions = [row for row in Cells(page).rows if len(row) == 10][1:]
    assert [row[2] for row in conditions] == ["90*", "90*"]
    assert [row[7] for row in conditions] == [f"{100 * value:.1f}" for value in friction["efficiency"].values.ravel()]


@pytest.fixture(scope="module")
def held() -> xr.DataTree:
    case = small(compliance="shell", mesh_positions=2, edge_contact=False)
    return easeoff.analyze(case, torques=np.linspace(50.0, 230.0, 9).tolist(), supports="gearbox-nasa-12x36")


def test_misalignment_and_supports_are_tables(held: xr.DataTree) -> None:
    tables = held.easeoff.summary().tables
    assert list(tables) == ["unloaded", "misalignment", "supports", "loaded"]
    moved, supports = tables["misalignment"], tables["supports"]
    assert moved.index.tolist() == [0.0, *held["loaded"].to_dataset()["torque"].values.tolist()]
    group = held["misalignment"].to_dataset().mean("mesh_position")
    np.testing.assert_allclose(moved["P [mm]"].iloc[1:], group["pinion_axial"])
    np.testing.assert_allclose(moved["Sigma [deg]"].iloc[1:], np.degrees(group["shaft_angle"]))
    parts = [name for name in supports if "rotation" in name]
    assert parts[0] == "whole_rotation [urad]"
    np.testing.assert_allclose(supports[parts[1:]].sum(axis=1), supports[parts[0]])
    names, radial, axial = bearing_loads(held)
    np.testing.assert_allclose(supports[f"{names[0]}, radial [N]"], radial[0].mean(axis=1))
    np.testing.assert_allclose(supports[f"{names[0]}, axial [N]"], axial[0].mean(axis=1))
    assert len(supports.columns) == len(parts) + 2 * len(names)


def test_flags_are_words_in_the_tables(tree: xr.DataTree, duty: xr.DataTree) -> None:
    loaded = tree.easeoff.summary().tables["loaded"]
    ends = key_numbers(tree)["max_pressure_line_end"].values
    assert loaded["max_pressure_line_end"].tolist() == [
        LineEnd(int(end)).name.lower().replace("_", " ") for end in ends
    ]
    assert duty.easeoff.summary().tables["load_cases"]["status"].tolist() == ["certified", "certified"]


def test_the_page_shows_assembly_stiffness_and_places_as_the_text_does(held: xr.DataTree) -> None:
    page = held.easeoff.summary()._repr_html_()
    rows = {row[0]: row[1:] for row in Cells(page).rows}
    assert rows["torque [N m]"][0].startswith("pinion")  # the last table with a row a torque: bearing loads
    assert "Misalignment over the torque" in page
    assert "Bearing loads" in page
    for name in ("mesh stiffness, mean [N m/µrad]", "pattern, length [%]", "greatest pressure, from the toe [%]"):
        assert len(rows[name]) == 8
    assert "and 1 more: <code>summary().tables[&quot;loaded&quot;]</code>" in page


def test_the_page_of_load_cases_has_a_row_each(duty: xr.DataTree) -> None:
    rows = {row[0]: row[1:] for row in Cells(duty.easeoff._repr_html_()).rows[:3]}
    assert rows["climb"][-1] == "+0.1"
    assert rows["load case"][-1] == "Sigma [°]"


def test_foreign_text_is_shown_and_does_nothing(tree: xr.DataTree) -> None:
    foreign = tree.copy()
    foreign.attrs["title"] = "<script>alert(1)</script> & co"
    page = foreign.easeoff._repr_html_()
    assert "<script" not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt; &amp; co" in page


def test_result_and_report_are_written(tree: xr.DataTree, tmp_path: Path) -> None:
    assert easeoff.read_result(tree.easeoff.save(tmp_path / "here" / "out.nc")).identical(tree)
    assert tree.easeoff.report(tmp_path / "report.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


def test_the_case_is_that_of_the_analysis(tree: xr.DataTree) -> None:
    assert tree.easeoff.case.model_dump() == coarse().model_dump()
    assert tree.easeoff.case.text == tree.attrs["case"] == coarse().text


def test_a_result_keeps_the_case_as_it_was_changed_in_python() -> None:
    changed = coarse().model_copy(update={"title": "Changed"})
    assert changed.text == ""
    assert coarse().model_copy().text
    assert easeoff.analyze(changed, torques=[100.0]).easeoff.case.model_dump() == changed.model_dump()


def test_a_case_whose_oil_is_elsewhere_comes_without_friction_and_says_so(tree: xr.DataTree) -> None:
    moved = tree.copy()
    moved.attrs["case"] = read_case("nasa-12x36").text + '\n[friction]\nspeed = 1000.0\noil = "oils/ours.toml"\n'
    with pytest.warns(UserWarning, match=r"friction and load cases of the case are left out: .*oils/ours\.toml"):
        assert moved.easeoff.case.friction is None
    moved.attrs["case"] = "no case"
    with pytest.raises(InputError, match="the case of the result"):
        _ = moved.easeoff.case


def test_of_another_tree_every_method_says_what_is_wanted(tree: xr.DataTree, tmp_path: Path) -> None:
    other = xr.DataTree.from_dict({"/a": xr.Dataset({"x": 1})}, name="mine")
    group = tree["loaded"]
    damaged = tree.copy()
    del damaged["loaded"]["pressure"]
    for found, said in (
        (other, "tree = 'mine': must be a result of easeoff.analyze"),
        (group, "tree = '/loaded': must be a whole result; this is a group of one: take tree.root"),
        (damaged, "tree: damaged or changed: .*pressure"),
    ):
        accessor = found.easeoff
        for use in (
            accessor.summary,
            lambda accessor=accessor: accessor.report(tmp_path / "r.html"),
            lambda accessor=accessor: accessor.save(tmp_path / "r.nc"),
            lambda accessor=accessor: accessor.plot,
            lambda accessor=accessor: accessor.case,
        ):
            with pytest.raises(InputError, match=said):
                use()
        assert accessor._repr_html_() is None
        assert "must be" in repr(accessor) or "damaged" in repr(accessor)
    assert list(tmp_path.iterdir()) == []


def test_a_result_within_load_cases_is_one(duty: xr.DataTree) -> None:
    assert "12 x 36" in str(duty["results/climb"].easeoff.summary())


def test_pictures_are_the_functions_of_the_package(tree: xr.DataTree, monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []

    def pressure(tree: xr.DataTree, torque: float | None = None, *, title: str = "p") -> str:
        """Draw the pressure."""
        calls.append((tree, torque, title))
        return "figure"

    stand_in = SimpleNamespace(__all__=["NAMES", "pressure", "write"], NAMES=(), pressure=pressure, write=lambda f: f)
    monkeypatch.setattr(easeoff, "plot", stand_in, raising=False)
    plot = tree.easeoff.plot
    assert dir(plot) == ["pressure"]
    assert plot.pressure(100.0, title="q") == "figure"
    assert calls == [(tree, 100.0, "q")]
    assert plot.pressure.__doc__ == "Draw the pressure."
    assert str(inspect.signature(plot.pressure)).startswith("(torque: ")
    with pytest.raises(AttributeError, match=r"no picture 'presure'; there are: pressure; did you mean 'pressure'"):
        plot.presure()


def test_pictures_of_a_result_are_drawn(tree: xr.DataTree) -> None:
    plot = tree.easeoff.plot
    assert {"pressure", "ease_off", "transmission_error"} <= set(dir(plot))
    assert "vh_check" not in dir(plot)  # of a dataset
    assert set(plot.pictures()) <= set(dir(plot))
    figure = plot.pressure(torque=200.0)
    assert len(figure.axes) >= 1


class Formatter:
    """A formatter of IPython as far as it is used."""

    def __init__(self, *known: str) -> None:
        self.known: dict[str, Any] = dict.fromkeys(known)

    def lookup_by_type(self, name: str) -> Any:
        return self.known[name]

    def for_type_by_name(self, module: str, name: str, call: Any) -> None:
        self.known[f"{module}.{name}"] = call


@pytest.mark.parametrize("known", [(), ("matplotlib.figure.Figure",)])
def test_a_notebook_shows_figures_unless_it_does_already(
    known: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    formatter = Formatter(*known)
    shell = SimpleNamespace(display_formatter=SimpleNamespace(formatters={"image/png": formatter}))
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    show_figures_in_notebooks()
    assert list(formatter.known) == ["matplotlib.figure.Figure"]
    assert (formatter.known["matplotlib.figure.Figure"] is None) == bool(known)


def test_a_package_that_is_loaded_counts_as_imported() -> None:
    told: list[str] = []
    after_import("sys", lambda: told.append("loaded already"))
    assert told == ["loaded already"]


def test_without_a_notebook_figures_are_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "IPython", raising=False)
    show_figures_in_notebooks()
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: None))
    show_figures_in_notebooks()


# The accessor of a dataset in a notebook: summary, pictures and file of a sweep, and its refusal of others


@pytest.fixture(scope="module")
def found() -> xr.Dataset:
    return easeoff.sweep(small(compliance="shell"), {"E": [-0.05, 0.05], "P": [0.0, 0.02]}, torques=[100.0], workers=1)


def test_the_summary_of_a_sweep_is_that_of_show(found: xr.Dataset) -> None:
    assert str(found.easeoff.summary()) == repr(found.easeoff) == sweep_summary(found)
    page = found.easeoff._repr_html_()
    assert page == found.easeoff.summary()._repr_html_()
    assert page.startswith("<div>")
    assert page.count("<table>") == 1 + len(sweep_tables(found))
    for table in sweep_tables(found):
        for row in table.rows:
            assert all(f">{html_text(text)}</td>" in page for text in row)


def test_what_is_held_is_told_and_slopes_have_units(found: xr.Dataset) -> None:
    head = dict(sweep_head(found))
    assert head["torque"] == "100 N m, held"
    assert head["flank"] == "drive, held"
    assert head["misalignment"] == "G 0 mm, Sigma 0 deg, held"  # E and P are swept
    shifted = sweep_head(found.assign_attrs(misalignment_gear_axial_mm=0.12))
    assert dict(shifted)["misalignment"] == "G +0.12 mm, Sigma 0 deg, held"
    text = " ".join(sweep_summary(found).split())
    assert text.count("effect: change of the number with one scale") == 1
    slopes = next(table for table in sweep_tables(found) if table.title.startswith("First-order"))
    values = sensitivities(found, "peak_to_peak").sel(coordinate="E")
    row = next(row for row in slopes.rows if row[0] == "E")
    assert row[1:] == ["0.05 mm", f"{values['effect'].item():+.3g} urad", f"{values['slope'].item():+.4g} urad/mm"]


def test_tables_hold_every_number_at_every_point(found: xr.Dataset) -> None:
    tables = found.easeoff.summary().tables
    points = tables["points"]
    assert points.index.names == ["E [mm]", "P [mm]", "torque [N m]"]
    assert len(points) == 4
    for (e, p, torque), row in points.iterrows():
        at = found.sel(E=e, P=p, torque=torque)
        assert row["peak_to_peak [urad]"] == at["peak_to_peak"].item()
        assert row["unloaded_peak_to_peak [urad]"] == at["unloaded_peak_to_peak"].item()
        assert row["harmonic 2 [urad]"] == at["harmonic"].sel(order=2).item()
        assert row["status"] == "certified"
    least = tables["percentiles"]["max_pressure [MPa]"].xs(0.0, level=0).item()
    assert least == found["max_pressure"].values.min()
    assert tables["worst"]["max_pressure [MPa]"].iloc[0] == found["max_pressure"].values.max()
    slopes = tables["sensitivities_peak_to_peak"]
    assert slopes.loc[("E", 100.0), "effect [urad]"] == sensitivities(found, "peak_to_peak")["effect"].sel(
        coordinate="E"
    )


def test_samples_are_columns_of_the_table_of_points() -> None:
    drawn = easeoff.sweep(small(compliance="shell"), {"E": "normal(0, 0.01)"}, samples=2, torques=[100.0], workers=1)
    points = drawn.easeoff.summary().tables["points"]
    assert points.index.names == ["sample", "torque [N m]"]
    assert points["E [mm]"].tolist() == drawn["E"].values.tolist()


def test_a_sweep_is_saved_and_read(found: xr.Dataset, tmp_path: Path) -> None:
    path = found.easeoff.save(tmp_path / "sweep.nc")
    assert read_sweep(path).identical(found)
    with pytest.raises(InputError, match=r"sweep\.nc is of a sweep: easeoff\.study\.sweep\.read_sweep reads it"):
        easeoff.read_result(path)


def test_pictures_by_short_names(found: xr.Dataset) -> None:
    assert dir(found.easeoff.plot) == sorted(["map", "pattern", "tornado"])
    first, named = found.easeoff.plot(), found.easeoff.plot.map()
    assert isinstance(first, Figure)
    assert [axes.get_title(loc="left") for axes in first.axes] == [axes.get_title(loc="left") for axes in named.axes]
    with pytest.raises(AttributeError, match="did you mean 'pattern'"):
        found.easeoff.plot.patterns()


def test_a_map_marks_every_point_and_ticks_the_swept_values(found: xr.Dataset) -> None:
    axes = Figure().subplots()
    easeoff.plot.sweep(found, "map", names="peak_to_peak", axes=axes)
    assert sorted(axes.get_xticks()) == sorted(found["E"].values)
    assert sorted(axes.get_yticks()) == sorted(found["P"].values)
    assert sorted(map(tuple, np.asarray(axes.lines[0].get_xydata()).tolist())) == [
        (e, p) for e in found["E"].values for p in (0.0, 0.02)
    ]


def test_a_pattern_ends_at_the_flank(found: xr.Dataset) -> None:
    figure = easeoff.plot.sweep(found, "pattern")
    figure.draw_without_rendering()
    ellipses = [patch for patch in figure.axes[0].patches if isinstance(patch, Ellipse)]
    assert ellipses
    (left, bottom), (right, top) = figure.axes[0].transData.transform([(0.0, 0.0), (100.0, 100.0)])
    for one in ellipses:
        box = one.get_tightbbox()
        assert box is not None
        drawn = box.padded(-1.0)
        assert left <= drawn.x0 < drawn.x1 <= right
        assert bottom <= drawn.y0 < drawn.y1 <= top


def test_other_datasets_are_refused(found: xr.Dataset, tmp_path: Path) -> None:
    for other, said in (
        (xr.Dataset({"x": 1}), "dataset: must be a sweep of easeoff.sweep"),
        (found.drop_vars("status"), "dataset: a sweep that is damaged or changed"),
    ):
        for use in (
            other.easeoff.summary,
            lambda other=other: other.easeoff.plot,
            lambda other=other: other.easeoff.save(tmp_path / "x.nc"),
        ):
            with pytest.raises(InputError, match=said):
                use()
        assert "dataset:" in repr(other.easeoff)
        assert other.easeoff._repr_html_() is None
    with pytest.raises(InputError, match=r"dataset: must be of easeoff\.sweep"):
        easeoff.plot.sweep(xr.Dataset())
