"""The accessor of a dataset in a notebook: summary, pictures and file of a sweep, and its refusal of others."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse
from runs import small

import easeoff
from easeoff import InputError
from easeoff.study.report.notebook.html_table import html_text
from easeoff.study.report.sweep_report import sweep_head, sweep_summary, sweep_tables
from easeoff.study.sweep import read_sweep, sensitivities


@pytest.fixture(scope="module")
def found() -> xr.Dataset:
    return easeoff.sweep(small(compliance="shell"), {"E": [-0.05, 0.05], "P": [0.0, 0.02]}, torques=[100.0], workers=1)


def test_the_summary_is_that_of_show(found: xr.Dataset) -> None:
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
    (left, bottom), (right, top) = figure.axes[0].transData.transform([(0.0, 0.0), (1.0, 1.0)])
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
