"""Sweeps: every point is its analysis, on every engine; interrupted ones resume to the bit; reductions are exact."""

from __future__ import annotations

import json
import os
import signal
import socket
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, nullcontext
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from runs import call, output_of, read_only, refusal_of, small, text_file
from sweeps import CASE, RADIAL, SETTING, analyse_points_once, case_file

import easeoff
from easeoff import InputError
from easeoff.cases.writing import changed_case, numeric_keys, require_numeric_key
from easeoff.geometry import Misalignment
from easeoff.geometry.pair.modification import Modification
from easeoff.study import key_numbers
from easeoff.study.analysis.swept_quantity import swept_quantity
from easeoff.study.plot import page, written_pictures
from easeoff.study.plot.page import small_print
from easeoff.study.summary.sweep_report import _per
from easeoff.study.summary.table import Table
from easeoff.study.sweep import percentiles, read_sweep, sensitivities, sweep, worst_points
from easeoff.study.sweep.sweep_file import PointStatus, checked_sweep, write_sweep
from easeoff.study.sweep.sweep_plan import Distribution, Sampler, sample_values

OILS = ["75w90", "heavy-mineral"]
POINTED = RADIAL - 6.0  # with it the pinion's teeth, of solid shells, are pointed


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> str:
    return str(case_file(tmp_path_factory.mktemp("case")))


@pytest.fixture
def points_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Points of another test are not analysed again."""
    analyse_points_once(monkeypatch)


@cache
def sampled() -> xr.Dataset:
    """A sweep of two samples at two torques."""
    over = {"E": "normal(0,0.03)", "torque": [100.0, 200.0]}
    return read_only(sweep(CASE, over, samples=2, seed=5, workers=1))


def assert_is_analysis(point: xr.Dataset, tree: xr.DataTree) -> None:
    """Every key number of an analysis is that of a point of a sweep."""
    for name, variable in key_numbers(tree).data_vars.items():
        own = point[name]
        extra = [dim for dim in variable.dims if dim not in own.dims]
        np.testing.assert_allclose(
            own.values, variable.isel(dict.fromkeys(extra, 0)).values, 1e-12, 0, err_msg=str(name)
        )


def assert_same(one: xr.Dataset, other: xr.Dataset) -> None:
    """To the bit, but for the time they were made at."""
    unlike = [str(name) for name in one.variables if one[name].values.tobytes() != other[name].values.tobytes()]
    assert unlike == [], {n: np.nanmax(abs(one[n] - other[n])).item() for n in unlike if one[n].dtype.kind == "f"}
    assert one.drop_attrs(deep=False).identical(other.drop_attrs(deep=False))


@pytest.mark.thorough
def test_every_point_of_a_grid_is_its_analysis() -> None:
    values = [RADIAL, RADIAL + 0.02]
    found = sweep(CASE, {"E": "0:0.05:2", SETTING: values, "torque": [300.0, 100.0], "Sigma": [0.02]}, workers=1)
    assert found["peak_to_peak"].dims == ("E", SETTING, "Sigma", "torque")
    assert (found["status"] == PointStatus.CERTIFIED).all()
    for e in (0.0, 0.05):
        for value in values:
            changed = changed_case(CASE, {SETTING: value})
            moved = Misalignment(e, shaft_angle=np.radians(0.02))
            tree = easeoff.analyze(changed, torques=[300.0, 100.0], misalignment=moved)
            assert_is_analysis(found.sel({"E": e, SETTING: value}).isel(Sigma=0), tree)


def test_every_load_case_is_its_analysis(tmp_path: Path) -> None:
    """Also where load cases have the assembly in common, at a torque each, with friction."""
    table = text_file(
        tmp_path / "loads.csv",
        "# a duty cycle\nname,torque,E,speed,share\n"
        "first,100,0.05,1000,0.5\nsecond,300,0,500,0.2\nthird,300,0.05,2000,0.3\n",
    )
    found = sweep(CASE, load_cases=table, temperature=60.0, workers=1, edge_contact=False)
    assert found["peak_to_peak"].dims == ("load_case",)
    assert found["share"].values.tolist() == [0.5, 0.2, 0.3]
    for i in range(3):
        point = found.isel(load_case=i)
        torque, e, speed = (point[name].item() for name in ("torque", "E", "speed"))
        moved = Misalignment(offset=e)
        operation = {"speed": speed, "temperature": 60.0}
        assert_is_analysis(
            point, easeoff.analyze(CASE, torques=[torque], misalignment=moved, edge_contact=False, **operation)
        )


@pytest.mark.thorough
def test_conditions_oils_modifications_flanks_and_deviations_are_swept() -> None:
    term = "modification.lengthwise_crowning"
    over = {"oil": OILS, "speed": [500.0, 1000.0], term: [0.0, 5.0]}
    found = sweep(CASE, over, torques=[200.0], workers=1)
    assert found["efficiency"].dims == ("oil", term, "torque", "speed", "temperature", "roughness")
    for oil in OILS:
        modified = Modification({"lengthwise_crowning": 5.0})
        tree = easeoff.analyze(CASE, torques=[200.0], speed=[500.0, 1000.0], oil=oil, modification=modified)
        assert_is_analysis(found.sel({"oil": oil, term: 5.0}), tree)
    both = sweep(CASE, {"flank": ["drive", "coast"]}, torques=[200.0], workers=1)
    assert_is_analysis(both.sel(flank="coast"), easeoff.analyze(CASE, flank="coast", torques=[200.0]))
    hypoid = small("fm-11x41")
    worn = sweep(hypoid, {"deviation.gear": "fm-11x41-worn-gear", "E": [-0.1]}, torques=[200.0], workers=1)
    moved = Misalignment(-0.1, hypoid.misalignment.pinion_axial)
    tree = easeoff.analyze(hypoid, torques=[200.0], misalignment=moved, deviations={"gear": "fm-11x41-worn-gear"})
    assert_is_analysis(worn.isel({"deviation.gear": 0, "E": 0}), tree)


def test_grid_point_off_the_design_is_its_analysis() -> None:
    """Misaligned from the design, in the other order of torques."""
    found = sweep(CASE, {"torque": [200.0, 100.0], "G": [0.03], "E": [-0.04]}, workers=1)
    tree = easeoff.analyze(CASE, torques=[200.0, 100.0], misalignment=Misalignment(-0.04, gear_axial=0.03))
    assert_is_analysis(found.isel(G=0, E=0), tree)


def test_swept_quantities_have_the_units_of_the_case_file() -> None:
    units = {"Sigma": "degree", "pinion.concave.cutter.blade_point_radius": "mm"}
    assert {name: swept_quantity(name).units for name in units} == units


def test_failures_are_rows_with_a_reason() -> None:
    over = {SETTING: [1e4, RADIAL], "G": [0.0, 9.9]}
    found = sweep(CASE, over, torques=[100.0, 200.0], workers=1, edge_contact=False)
    impossible, certified, apart = PointStatus.NOT_POSSIBLE, PointStatus.CERTIFIED, PointStatus.NO_CONTACT
    assert found["status"].values.tolist() == [[[impossible] * 2] * 2, [[certified] * 2, [apart] * 2]]
    assert "must be below 5000" in found["reason"].values[0, 0, 0]
    assert found["reason"].values[1, 0, 0] == ""
    assert "no part of the gear flank meets the pinion flank" in found["reason"].values[1, 1, 1]
    assert np.isnan(found["peak_to_peak"].values[[0, 0, 1], [0, 1, 1]]).all()
    assert found["max_pressure_line_end"].values[0, 0, 0] == -1
    assert "not_computed" in found["max_pressure_line_end"].attrs["flag_meanings"]


def test_teeth_that_cannot_be_meshed_are_no_contact() -> None:
    found = sweep(small(), {SETTING: [POINTED]}, torques=[100.0], workers=1)
    assert found["status"].values.tolist() == [[PointStatus.NO_CONTACT]]
    assert "pointed" in found["reason"].item()


@pytest.mark.parametrize(
    ("over", "wanted"),
    [
        ({"EE": [0.1]}, "EE: must be one of E, P"),
        ({"misalignment.offset": [0.1]}, "is swept as E"),
        ({"pinion.concave.machine.radial_distanc": [70.0]}, "did you mean"),
        ({"E": [0.1, 0.1]}, "0.1 comes twice"),
        ({"E": "0:1"}, "must be FROM:TO:COUNT"),
        ({"E": [np.nan]}, "E = nan: must be a number above -10 and below 10"),
        ({"E": []}, "must have from 1"),
        ({"E": "normal(0,0.1)"}, "samples = None: must be given"),
        ({"E": "normal(0,-0.1)"}, "standard_deviation in normal"),
        ({"E": "cauchy(0,1)"}, "must be one of normal"),
        ({}, "must name at least one coordinate"),
        ({"torque": [0.0, 1.0]}, "torques"),
        ({"oil": ["75w90"]}, "oil without a speed"),
        ({"share": [0.1]}, "is a column of load cases"),
    ],
)
def test_mistakes_are_refused_before_the_work(over: dict[str, Any], wanted: str) -> None:
    with pytest.raises(InputError, match=wanted.replace("(", r"\(")):
        sweep(CASE, over, workers=1)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("torque\n", "a head but no load cases: give a load case a line"),
        ("torque,E\n100\n", "line 2, E: is missing; every column must have a value"),
        ("torque,E\n100,0\n,0.1\n", "line 3, torque: is missing"),
        ("torque,E\n100,0.1\n\n200,x\n", "line 4, E = 'x': must be a number"),
        ("torque,E\n100,11\n", "line 2, E = 11: must be a number above -10 and below 10"),
        ("torque,torque\n1,2\n", "comes twice"),
        ("share\n1\n", "must have a column that changes something"),
        ("torque,share\n100,-1\n", "share: must be numbers of 0 or more"),
        ("torque,colour\n100,1\n", "colour: must be one of"),
    ],
)
def test_mistakes_in_a_table_of_load_cases_are_named(text: str, wanted: str, tmp_path: Path) -> None:
    (tmp_path / "loads.csv").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=wanted):
        sweep(CASE, load_cases=tmp_path / "loads.csv", workers=1)


def test_sweep_too_large_for_the_memory_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("EASEOFF_MEMORY", "0.5")
    with pytest.raises(InputError, match="9000000 points x 1 workers: must be smaller, as the sweep needs"):
        sweep(CASE, {"E": "-0.1:0.1:3000", "P": "-0.1:0.1:3000"}, torques=[100.0], workers=1)


def test_changed_case_has_other_numbers_and_is_checked() -> None:
    assert {"pinion.concave.cutter.blade_point_radius", "gear.blank.face_width"} <= set(numeric_keys())
    assert not {"contact.torques", "title", "pinion.concave.machine.motions.cutter_tilt"} & set(numeric_keys())
    assert numeric_keys()["pinion.concave.machine.radial_distance"] == ("mm", "radial setting")
    assert require_numeric_key("gear.blank.face_width")[0] == "mm"
    changed = changed_case(CASE, {"contact.mesh_positions": 5.0, "gear.material.elastic_modulus": 2e5})
    assert (changed.contact.mesh_positions, changed.gear.material.elastic_modulus) == (5, 2e5)
    assert changed.contact.torques == CASE.contact.torques
    with pytest.raises(InputError, match=r"no table \[blank_design\]"):
        changed_case(CASE, {"blank_design.depth_factor": 2.0})


def test_samples_follow_their_distributions_and_their_seed() -> None:
    """Each sequence has one point in each of the equal parts of a coordinate."""
    wanted = {"E": Distribution.parsed("normal(1, 0.5)"), "P": Distribution("triangular", (0.0, 1.0, 4.0))}
    wanted["G"] = Distribution("uniform", (-0.1, 0.3))
    samplers: tuple[Sampler, ...] = ("sobol", "latin_hypercube")
    for sampler in samplers:
        drawn = sample_values(wanted, 64, seed=7, sampler=sampler)
        again = sample_values(wanted, 64, seed=7, sampler=sampler)
        other = sample_values(wanted, 64, seed=8, sampler=sampler)
        assert all(np.array_equal(drawn[name], again[name]) for name in wanted)
        assert not np.array_equal(drawn["E"], other["E"])
        normal = statistics.NormalDist(1.0, 0.5)
        assert sorted(int(64 * normal.cdf(value)) for value in drawn["E"]) == list(range(64))
        rise = [value**2 / 4.0 if value <= 1.0 else 1.0 - (4.0 - value) ** 2 / 12.0 for value in drawn["P"]]
        assert sorted(int(64 * value) for value in rise) == list(range(64))
        assert sorted(int(64 * (value + 0.1) / 0.4) for value in drawn["G"]) == list(range(64))


def test_samples_of_a_sweep_keep_their_seed() -> None:
    found = sampled()
    assert dict(found.sizes) == {"sample": 2, "torque": 2, "order": 3}
    assert (found.attrs["seed"], found.attrs["sampler"]) == (5, "sobol")
    assert json.loads(found.attrs["distributions"]) == {"E": "normal(0.0, 0.03)"}
    assert np.array_equal(found["E"], sample_values({"E": Distribution("normal", (0.0, 0.03))}, 2, seed=5)["E"])


def synthetic(values: dict[str, Any], coords: dict[str, Any], swept: list[str]) -> xr.Dataset:
    """A dataset in the form of a sweep."""
    first = next(iter(values.values()))
    status = xr.zeros_like(first, dtype=np.int8)
    dataset = xr.Dataset({**values, "status": status, "reason": status.astype(str)}, coords=coords)
    return dataset.assign_attrs(swept=json.dumps(swept), sweep_schema_version=1, title="synthetic")


def test_regression_finds_a_linear_dependence_and_its_variance() -> None:
    rng = np.random.default_rng(3)
    e, p = rng.normal(0.0, 2.0, 4000), rng.normal(0.0, 1.0, 4000)
    y = xr.DataArray(np.stack([3.0 * e - 8.0 * p + 1.0, e], axis=1), dims=("sample", "torque"))
    y[5] = np.nan  # a failure
    found = sensitivities(
        synthetic({"y": y}, {"E": ("sample", e), "P": ("sample", p), "torque": [1.0, 2.0]}, ["E", "P"]), "y"
    )
    np.testing.assert_allclose(found["slope"].sel(torque=1.0), [3.0, -8.0], rtol=1e-12)
    np.testing.assert_allclose(found["effect"].sel(torque=1.0), [3.0 * e.std(), -8.0 * p.std()], rtol=1e-12)
    np.testing.assert_allclose(found["variance_share"].sel(torque=1.0), [36.0 / 100.0, 64.0 / 100.0], atol=0.03)
    np.testing.assert_allclose(found["variance_share"].sel(torque=2.0), [1.0, 0.0], atol=1e-12)


def test_difference_quotients_are_exact_for_quadratics() -> None:
    e, p = np.linspace(-1.0, 1.0, 5), np.linspace(0.0, 4.0, 3)
    y = xr.DataArray(2.0 * e[:, None] + e[:, None] ** 2 + p**2, dims=("E", "P"))
    found = sensitivities(synthetic({"y": y}, {"E": e, "P": p}, ["E", "P"]), "y")
    np.testing.assert_allclose(found["slope"], [2.0, 4.0], rtol=1e-12)
    np.testing.assert_allclose(found["effect"], [2.0, 8.0], rtol=1e-12)
    assert found["variance_share"].isnull().all()


def test_percentiles_and_worst_points_leave_failures_out() -> None:
    values = np.arange(101.0)[::-1].copy()
    values[:1] = np.nan
    y = xr.DataArray(values, dims="sample")
    dataset = synthetic({"y": y}, {"E": ("sample", np.arange(101.0))}, ["E"])
    np.testing.assert_allclose(percentiles(dataset, [0.0, 50.0, 100.0])["y"], [0.0, 49.5, 99.0])
    worst = worst_points(dataset, "y", 2)
    assert worst["y"].values.tolist() == [99.0, 98.0]
    assert worst["E"].values.tolist() == worst["row"].values.tolist() == [1.0, 2.0]
    assert worst_points(dataset, "y", 1, least=True)["E"].item() == 100.0
    with pytest.raises(InputError, match="must be one of"):
        worst_points(dataset, "z")


class StopError(Exception):
    """An interruption."""


@pytest.mark.thorough
def test_interrupted_sweep_resumes_to_the_bit(tmp_path: Path) -> None:
    """Also with a batch whose file is damaged, and another that the map does not have."""
    over = {"E": "-0.1:0.1:6"}
    whole = sweep(CASE, over, torques=[100.0], workers=1)

    def stop(done: int, total: int) -> None:
        assert total == 6
        if done >= 4:
            raise StopError

    store = tmp_path / "store"
    with pytest.raises(StopError):
        sweep(CASE, over, torques=[100.0], workers=1, store=store, progress=stop)
    assert_same(sweep(CASE, over, torques=[100.0], workers=1, store=store), whole)
    batches = sorted(store.glob("*.npz"))
    content = batches[1].read_bytes()
    batches[1].write_bytes(content[: len(content) // 2])
    batches[0].unlink()
    steps: list[int] = []
    again = sweep(CASE, over, torques=[100.0], workers=1, store=store, progress=lambda done, _: steps.append(done))
    assert_same(again, whole)
    assert steps[-1] == 6


@pytest.mark.usefixtures("points_once")
def test_store_of_another_sweep_is_refused(tmp_path: Path) -> None:
    store = tmp_path / "store"
    first = sweep(CASE, {"E": [0.0, 0.05]}, torques=[100.0], workers=1, store=store)
    for other in ({"E": [0.0, 0.06]}, {"P": [0.0, 0.05]}):
        with pytest.raises(InputError, match=r"must hold the batches of this sweep \(NASA .* holds those of another"):
            sweep(CASE, other, torques=[100.0], workers=1, store=store)
    with pytest.raises(InputError, match="holds those of another"):
        sweep(CASE, {"E": [0.0, 0.05]}, torques=[101.0], workers=1, store=store)
    assert_same(sweep(CASE, {"E": [0.0, 0.05]}, torques=[100.0], workers=1, store=store), first)
    sweep(CASE, {"E": [0.0]}, torques=[100.0], workers=1, store=store, fresh=True)
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "letter.txt").touch()
    with pytest.raises(InputError, match=r"must be an empty folder, or not exist.*letter\.txt"):
        sweep(CASE, {"E": [0.0]}, torques=[100.0], workers=1, store=tmp_path / "full")


def test_file_holds_the_dataset(tmp_path: Path) -> None:
    found = sweep(CASE, {SETTING: [RADIAL, 1e4]}, torques=[100.0], workers=1, edge_contact=False)
    write_sweep(found, tmp_path / "sweep.nc")
    assert read_sweep(tmp_path / "sweep.nc").identical(found)
    assert all(variable.attrs["long_name"] for variable in found.variables.values())


@pytest.mark.parametrize("value", [np.inf, -1e300])
def test_a_file_with_wild_numbers_is_refused(tmp_path: Path, value: float) -> None:
    found = sampled()
    write_sweep(found.assign(peak_to_peak=xr.full_like(found["peak_to_peak"], value)), tmp_path / "sweep.nc")
    with pytest.raises(InputError, match=r"'peak_to_peak' holds numbers beyond 1e\+30"):
        read_sweep(tmp_path / "sweep.nc")


def test_a_file_with_a_dimension_by_another_name_is_refused(tmp_path: Path) -> None:
    write_sweep(sampled().rename_dims(sample="other"), tmp_path / "sweep.nc")
    with pytest.raises(InputError, match="'E' must hold values in a row, over itself or over sample or load_case"):
        read_sweep(tmp_path / "sweep.nc")


def test_sweep_names_what_every_point_departs_by() -> None:
    """Deviations, modification and contact on lines alone stand in the file and so on its pictures."""
    given = {"bias": -3.0, "lengthwise_crowning": 10.0}
    dataset = sweep(
        small("fm-11x41", "shell"), {"E": [0.0], "modification.bias": [1.0]}, torques=[100.0], workers=1,
        edge_contact=False, deviations={"gear": "fm-11x41-worn-gear"}, modification=Modification(given),
    )  # fmt: skip
    words = " ".join(small_print(dataset.attrs))
    assert "lines only" in words
    assert "gear up to" in words
    assert "lengthwise crowning +10 µm" in words
    assert "bias" not in words
    checked_sweep(dataset, "sweep.nc")


@pytest.mark.parametrize(
    ("units", "unit", "slope"), [("urad", "mm", "urad/mm"), ("1", "mm", "1/mm"), ("MPa", "1", "MPa")]
)
def test_slopes_have_the_quotient_of_the_units(units: str, unit: str, slope: str) -> None:
    assert _per(units, unit) == slope


def test_numbers_of_a_table_end_under_the_end_of_its_heads() -> None:
    assert Table(["E"], [["0.1"]], 0, "Points").text().splitlines() == ["Points", "", "  E", "---", "0.1"]


def test_command_sweeps_shows_and_keeps_the_worst(case: str, tmp_path: Path) -> None:
    out = tmp_path / "sweep.nc"
    words = ["sweep", case, "--over", "E=-0.1:0.1:2", "--over", "torque=100,300", "-o", str(out), "--workers", "1"]
    said = output_of(*words, "--keep", "worst=max_pressure:1")
    lines = said.splitlines()
    assert lines[0] == f"wrote {out}: 4 of 4 points certified"
    dataset = read_sweep(out)
    worst = int(np.argmax(dataset["max_pressure"].max("torque").values))
    e, kept = float(dataset["E"].values[worst]), tmp_path / "sweep-points" / f"{worst:06d}.nc"
    assert lines[1] == f"wrote {kept}: E = {e:g}"
    tree = easeoff.read_result(kept)
    assert tree.attrs["misalignment_offset_mm"] == e
    np.testing.assert_array_equal(tree["loaded/max_pressure"], dataset["max_pressure"].sel(E=e))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["sweep-points", "sweep.nc"]
    shown = output_of("show", out)
    assert "E             2 values from -0.1 to 0.1 mm" in shown
    assert "First-order sensitivities of max_pressure at 300 N m" in shown


@pytest.mark.usefixtures("points_once")
def test_a_kept_result_that_cannot_be_written_is_a_mistake(case: str, tmp_path: Path) -> None:
    """Here its folder is a file; the batches stay, from which the next run goes on."""
    (tmp_path / "sweep-points").touch()
    words = ["sweep", case, "-o", tmp_path / "sweep.nc", "--over", "E=0", "--torque", "100", "--workers", "1"]
    assert "000000.nc cannot be written" in refusal_of(*words, "--keep", "worst=max_pressure:1")
    assert (tmp_path / "sweep.nc.batches").is_dir()


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        (["--over", "E=0.1:0.2"], "FROM:TO:COUNT"),
        (["--over", "E"], "must be NAME=FROM:TO:COUNT"),
        (["--over", "E=normal(0,1)"], "'~' before a distribution"),
        (["--over", "E=1", "--over", "E=2"], "E comes twice"),
        (["--over", "E=0.1", "--keep", "max_pressure"], "must be worst=NUMBER:COUNT"),
        (["--over", "E=0.1", "--workers", "0"], "workers = 0"),
        (["--over", "E=0.1", "--samples", "8"], "must go with a distribution"),
        ([], "must name at least one coordinate"),
    ],
)
def test_mistakes_of_the_command_line_are_one_message(words: list[str], wanted: str, case: str, tmp_path: Path) -> None:
    assert wanted in refusal_of("sweep", case, "-o", tmp_path / "x.nc", *words)
    assert list(tmp_path.iterdir()) == []


def test_failed_points_make_the_exit_code_1(case: str, tmp_path: Path) -> None:
    out = tmp_path / "x.nc"
    found = call("sweep", case, "-o", out, "--over", "G=0,9.9", "--torque", "100", "--workers", "1")
    assert found.exit_code == 1
    assert "1 of 2 points certified, 1 no contact" in found.output
    assert read_sweep(out)["status"].values.tolist() == [[0], [3]]


@pytest.mark.thorough
def test_pool_of_processes_gives_the_same_bits(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    from easeoff.study.sweep import parameter_sweep

    over = {"E": "-0.1:0.1:9", "torque": [100.0, 200.0]}
    whole = sweep(CASE, over, workers=1)
    monkeypatch.setattr(parameter_sweep, "POOL_TIME", 0.0)
    assert_same(sweep(CASE, over, workers=2, store=tmp_path / "store"), whole)


@contextmanager
def process(*words: str, **options: Any) -> Iterator[subprocess.Popen[str]]:
    """A process that does not outlive its context."""
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "text": True, **options}
    started = subprocess.Popen([sys.executable, *words], **quiet)
    try:
        yield started
    finally:
        started.kill()
        started.wait()


@contextmanager
def dask_cluster(folder: Path, workers: int) -> Iterator[tuple[str, list[subprocess.Popen[str]]]]:
    """Address of a scheduler with some workers; its process and theirs."""
    distributed, file = pytest.importorskip("distributed"), folder / "scheduler.json"
    common = ["--scheduler-file", str(file), "--no-dashboard", "--host", "127.0.0.1"]
    cluster = ["-m", "distributed.cli.dask_scheduler", "--port", "0", *common]
    worker = ["-m", "distributed.cli.dask_worker", "--nthreads", "1", "--no-nanny", *common]
    with ExitStack() as context:
        started = [context.enter_context(process(*cluster))]
        started += [context.enter_context(process(*worker, cwd=folder)) for _ in range(workers)]
        limit = time.monotonic() + 60.0
        while not file.exists() and time.monotonic() < limit:
            time.sleep(0.1)
        scheduler = json.loads(file.read_text())["address"]
        with distributed.Client(scheduler, set_as_default=False) as client:
            client.wait_for_workers(workers, timeout=60.0)
        yield scheduler, started


@pytest.mark.thorough
def test_dask_cluster_that_loses_a_worker_gives_the_same_bits(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A real scheduler and two real workers, one of them killed while it computes."""
    pytest.importorskip("distributed")
    from easeoff.study.sweep import parameter_sweep

    over = {"E": "-0.1:0.1:15"}
    whole = sweep(CASE, over, torques=[100.0], workers=1)
    monkeypatch.setattr(parameter_sweep, "BATCH_TIME", 0.0)  # many batches
    with dask_cluster(tmp_path, 2) as (scheduler, (_, victim, _)):

        def kill(done: int, _: int) -> None:
            if done == 6:
                victim.kill()

        found = sweep(CASE, over, torques=[100.0], scheduler=scheduler, progress=kill)
        assert victim.wait(timeout=60.0) == -signal.SIGKILL
    assert_same(found, whole)


@pytest.mark.thorough
@pytest.mark.parametrize("lost", ["scheduler", "worker"])
def test_cluster_that_is_lost_is_named_and_the_sweep_resumes(
    lost: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A real scheduler or its only worker is killed; without workers it waits, and says so."""
    pytest.importorskip("distributed")
    from easeoff.study.sweep import engine, parameter_sweep

    monkeypatch.setattr(parameter_sweep, "BATCH_TIME", 0.0)  # many batches
    monkeypatch.setattr(engine, "LOOK_INTERVAL", 0.1)
    monkeypatch.setattr(engine, "CONNECTION_TIME_LIMIT", 5.0)
    monkeypatch.setattr(engine, "WORKERS_TIME_LIMIT", 0.3)
    over, store = {"E": "-0.1:0.1:9"}, tmp_path / "store"
    with dask_cluster(tmp_path, 1) as (scheduler, killed):
        victim = killed[lost == "worker"]

        def kill(done: int, _: int) -> None:
            if done == 3:
                victim.kill()

        told: Any = (
            pytest.warns(UserWarning, match="no workers any more; waiting") if lost == "worker" else nullcontext()
        )
        words = f"scheduler = '{scheduler}': {'has no workers any more' if lost == 'worker' else 'is gone'}; start it"
        with told, pytest.raises(InputError, match=words):
            sweep(CASE, over, torques=[100.0], scheduler=scheduler, store=store, progress=kill)
    found = sweep(CASE, over, torques=[100.0], workers=1, store=store)
    assert_same(found, sweep(CASE, over, torques=[100.0], workers=1))


@pytest.mark.parametrize(
    ("package", "found", "said"),
    [
        ("easeoff", "9.9", "is 9.9"),
        ("easeoff", PackageNotFoundError("easeoff"), "is unknown (PackageNotFoundError"),
        ("dask", "2020.1.0", "is 2020.1.0"),
    ],
)
def test_workers_of_other_versions_are_refused(package: str, found: object, said: str) -> None:
    pytest.importorskip("distributed")
    from easeoff.study.sweep import engine

    class Client:
        def run(self, function: Callable[[str], str], name: str, on_error: str) -> dict[str, object]:
            return {"tcp://one": function(name), "tcp://two": found if name == package else function(name)}

    with pytest.raises(InputError) as error:
        engine._check_versions(Client(), "tcp://scheduler")
    own = version(package)
    assert f"must have workers with {package} {own}, as here; that of its worker tcp://two {said}" in str(error.value)


def test_missing_scheduler_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    from easeoff.study.sweep import engine

    monkeypatch.setattr(engine, "CONNECTION_TIME_LIMIT", 0.5)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
        words = f"scheduler = '{address}': must be the address of a dask scheduler that runs"
        with pytest.raises(InputError, match=words):  # while nobody else can take the port
            sweep(CASE, {"E": [0.0, 0.02, 0.04]}, torques=[100.0], scheduler=address)


@pytest.mark.parametrize(
    "address",
    ["case.toml", "tcp://", "tcp://host:port", *(f"{kind}://127.0.0.1:1" for kind in ("post", "ucx", "inproc", "tls"))],
)
def test_an_address_that_is_none_is_named_at_once(address: str) -> None:
    distributed = pytest.importorskip("distributed")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(distributed, "Client", None)  # no client is made of it
        with pytest.raises(InputError, match=f"scheduler = '{address}': must be the address of a dask scheduler"):
            sweep(CASE, {"E": [0.0]}, torques=[100.0], scheduler=address)


def test_missing_dask_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(easeoff.MissingPackageError, match=r"easeoff\[dask\]"):
        sweep(CASE, {"E": [0.0]}, torques=[100.0], scheduler="tcp://127.0.0.1:1")


def environment() -> dict[str, str]:
    """Environment in which a fresh process finds the package."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}


@pytest.mark.thorough
def test_sweep_killed_at_any_moment_resumes_to_the_bit(case: str, tmp_path: Path) -> None:
    """Killed again and again, it goes on from what it has, and leaves nothing behind but its file."""
    out, whole = tmp_path / "killed.nc", tmp_path / "whole.nc"
    words = ["sweep", case, "--over", "E=-0.1:0.1:12", "--torque", "100,300", "--workers", "1"]
    code = "import easeoff.study.sweep.parameter_sweep as p, easeoff.study.cli as c; p.BATCH_TIME = 0.0; c.main()"
    output_of(*words, "-o", whole)
    kept = 0
    for attempt in range(40):
        store = tmp_path / "killed.nc.batches"
        with process("-c", code, *words, "-o", str(out), env=environment()) as run:
            begun = len(list(store.glob("*.npz")))
            limit = time.monotonic() + 60.0
            while run.poll() is None and time.monotonic() < limit and len(list(store.glob("*.npz"))) < begun + 2:
                time.sleep(0.01)
            time.sleep(0.01 * (attempt % 7))
            ended = run.poll() is not None  # else it is killed on leaving
        if ended:
            break
        found = len(list(store.glob("*.npz")))
        assert found >= kept or out.exists()
        kept = found
    assert ended
    assert_same(read_sweep(out), read_sweep(whole))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["killed.nc", "whole.nc"]


@pytest.mark.usefixtures("points_once")
def test_pictures_are_those_of_what_is_swept(case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page, "DPI", 40)
    out, folder = tmp_path / "x.nc", tmp_path / "pictures"
    words = ["--over", "E=0,0.05", "--over", "torque=100,300", "--workers", "1", "--plots", folder]
    with monkeypatch.context() as patch:
        patch.setattr(written_pictures, "draw_picture", lambda *_, **__: FigureCanvasAgg(Figure()).figure)
        output_of("sweep", case, "-o", out, *words)
    assert sorted(path.stem.split("-")[-1] for path in folder.iterdir()) == ["sweep_map", "sweep_pattern"]
    dataset = read_sweep(out).isel(torque=0, drop=True).rename(E="sample").assign_coords(E=("sample", [0.0, 0.05]))
    write_sweep(dataset.drop_vars("sample").assign_attrs(swept='["E"]'), out)
    output_of("plot", out, folder)
    assert sorted(path.stem.split("-")[-1] for path in folder.iterdir()) == ["sweep_histograms", "sweep_pattern"]
