"""The accessor of a dataset in a notebook: summary, pictures and file of a sweep, and its refusal of others."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

import easeoff
from easeoff import InputError
from easeoff.study.report.sweep_report import sweep_summary
from easeoff.study.sweep import read_sweep

COARSE = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}


@pytest.fixture(scope="module")
def found() -> xr.Dataset:
    case = easeoff.read_case("nasa-12x36")
    case = case.model_copy(update={"contact": case.contact.model_copy(update=COARSE)})
    return easeoff.sweep(case, {"E": [-0.05, 0.0, 0.05], "P": [0.0, 0.02]}, torques=[100.0], workers=1)


def test_the_summary_is_that_of_show(found: xr.Dataset) -> None:
    assert str(found.easeoff.summary()) == repr(found.easeoff) == sweep_summary(found)
    assert found.easeoff._repr_html_().startswith("<pre>")


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
