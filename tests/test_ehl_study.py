"""Parameter study of the film model: design, resuming, failures as rows, the formula fitted to it."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from easeoff.core.errors import InputError, MissingPackageError
from easeoff.friction import friction_coefficient
from easeoff.friction.ehl import Status
from easeoff.friction.ehl import study as study_module
from easeoff.friction.ehl.conditions import STEEL
from easeoff.friction.ehl.design import Condition, Design, oil_75w90
from easeoff.friction.ehl.regression import SHIPPED, FrictionFormula, fit_friction, shipped_formula, study_groups
from easeoff.friction.ehl.study import Resolution, Row, run_case, run_study, study_dataset


def test_design_has_the_combinations_of_the_dissertation() -> None:
    design = Design()
    assert design.size == 31500
    first, last = design.condition(0), design.condition(31499)
    assert first == Condition(0.5, 5.0, 1.0, 0.025, 25.0, 0.1, 0.1)
    assert last == Condition(2.5, 40.0, 20.0, 1.0, 100.0, 1.0, 1.0)
    assert len({design.condition(number) for number in range(0, 31500, 7)}) == 4500
    assert all(c.roughness_1 <= c.roughness_2 for c in map(design.condition, range(0, 31500, 11)))


def test_subset_fills_the_space_evenly() -> None:
    """Each level of each parameter about equally often; the short subset begins the long one; all are different."""
    design = Design()
    subset = design.subset(256)
    assert len(set(subset.tolist())) == 256
    np.testing.assert_array_equal(design.subset(64), subset[:64])
    for axis, size in zip(np.unravel_index(subset, design.shape), design.shape, strict=True):
        counts = np.bincount(axis, minlength=size)
        assert np.abs(counts - 256 / size).max() <= 0.25 * 256 / size + 2
    assert not np.array_equal(design.subset(64, seed=1), subset[:64])
    np.testing.assert_array_equal(np.sort(Design(temperature=(25.0,)).subset(7875)), np.arange(7875))


def test_oil_of_the_design() -> None:
    oil = oil_75w90(75.0)
    assert (oil.viscosity, oil.pressure_viscosity) == pytest.approx((0.0208, 11.4e-9), rel=1e-12)
    assert oil.temperature_viscosity == pytest.approx(np.log(0.0499 / 0.0106) / 50.0)
    with pytest.raises(InputError, match="101"):
        oil_75w90(101.0)


def test_case_of_the_study_has_its_numbers_and_a_lambda_ratio() -> None:
    condition = Condition(0.5, 5.0, 20.0, 0.5, 50.0, 0.1, 0.1)
    row = run_case(condition, Resolution(fewest=97, travel=2.0))
    assert row["status"] == Status.CERTIFIED
    assert row["certified_share"] == 1.0
    assert row["lambda_ratio"] == pytest.approx(row["smooth_film"] / (0.1 * np.sqrt(2.0)))
    assert 0.001 < row["film_friction"] < 0.06
    assert row["asperity_share"] == 0.0
    cooler = run_case(condition, Resolution(fewest=97, travel=2.0, thermal=False))
    assert cooler["film_friction"] > row["film_friction"]


def fake(calls: list[Condition]) -> object:
    def case(condition: Condition, resolution: Resolution) -> Row:
        calls.append(condition)
        row = dict.fromkeys(study_module._NUMBERS, 0.01)
        return {**row, "status": float(Status.CERTIFIED)}

    return case


def test_study_goes_on_where_it_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[Condition] = []
    monkeypatch.setattr(study_module, "run_case", fake(calls))
    path = tmp_path / "study.nc"
    assert run_study(path, 10, seconds=-1.0).sizes["combination"] == 0
    run_study(path, 6)
    with (tmp_path / "study.nc.rows").open("a") as file:
        file.write('\n{"key": "half a li')
    progress: list[tuple[int, int]] = []
    dataset = run_study(path, 10, progress=lambda done, missing: progress.append((done, missing)))
    assert len(calls) == 10
    assert len(set(calls)) == 10
    assert progress[-1] == (4, 4)
    np.testing.assert_array_equal(dataset["combination"], Design().subset(10))
    with xr.open_dataset(path, engine="netcdf4") as stored:
        xr.testing.assert_identical(stored.load(), dataset)
        assert stored["status"].attrs["flag_meanings"].startswith("certified")
        assert stored["friction_coefficient"].attrs["units"] == "1"
    run_study(path, 3, resolution=Resolution(seed=2))
    assert len(calls) == 13


def test_failed_case_is_a_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> Row:
        raise FloatingPointError("overflow")

    monkeypatch.setattr(study_module, "_computed", broken)
    dataset = run_study(tmp_path / "study.nc", [0, 5])
    assert (dataset["status"] == Status.FAILED).all()
    assert np.isnan(dataset["friction_coefficient"]).all()
    assert "overflow" in (tmp_path / "study.nc.rows").read_text()


def test_missing_dask_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "dask", None)
    with pytest.raises(MissingPackageError, match="easeoff\\[dask\\]"):
        run_study(tmp_path / "study.nc", 2, dask=True)


def test_dask_gives_the_same_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    dask = pytest.importorskip("dask")
    monkeypatch.setattr(study_module, "run_case", fake([]))
    with dask.config.set(scheduler="synchronous"):
        spread = run_study(tmp_path / "a.nc", 12, dask=True)
    xr.testing.assert_identical(spread, run_study(tmp_path / "b.nc", 12))


@pytest.mark.parametrize("number", [-1, 31500])
def test_combination_that_does_not_exist_is_refused(number: int, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        run_study(tmp_path / "study.nc", [number])
    with pytest.raises(InputError, match="size"):
        Design().subset(0)


def invented(noise: float) -> xr.Dataset:
    """A study whose friction coefficient is a known product of powers, with noise."""
    design = Design()
    rng = np.random.default_rng(5)
    rows: dict[int, Row] = {}
    for number in design.subset(200).tolist():
        row = dict.fromkeys(study_module._NUMBERS, 0.0)
        rows[number] = {**row, "status": float(Status.CERTIFIED)}
    dataset = study_dataset(design, rows)
    groups = study_groups(dataset)
    logarithm = -4.0 + 0.3 * groups[:, 1] - 0.2 * (groups[:, 0] + 5.0) + 0.01 * groups[:, 1] * groups[:, 4]
    dataset["film_friction"][:] = np.exp(logarithm + noise * rng.normal(size=200))
    dataset["friction_coefficient"][:] = dataset["film_friction"].values
    return dataset


def evaluated(formula: FrictionFormula, dataset: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    oils = [oil_75w90(float(t)) for t in dataset["temperature"].values]
    return formula(
        1e9 * dataset["contact_pressure"].values,
        1e-3 * dataset["contact_radius"].values,
        dataset["rolling_velocity"].values,
        -dataset["slide_to_roll"].values,
        [oil.viscosity for oil in oils],
        [oil.pressure_viscosity for oil in oils],
        1e-6 * np.hypot(dataset["roughness_1"].values, dataset["roughness_2"].values),
    )


def test_formula_finds_a_law_of_its_own_form() -> None:
    dataset = invented(0.0)
    formula = fit_friction(dataset)
    friction, inside = evaluated(formula, dataset)
    assert inside.all()
    np.testing.assert_allclose(friction, dataset["friction_coefficient"], rtol=1e-6)
    assert formula.prediction_error < 1e-6
    assert formula.cases == 200


def test_prediction_error_is_that_of_leaving_out_and_as_large_as_the_noise() -> None:
    dataset = invented(0.1)
    formula = fit_friction(dataset)
    assert 0.08 < formula.fit_error <= formula.prediction_error < 0.13
    assert formula.determination > 0.8
    # New noise, the same law: the formula predicts it as well as it says.
    clean, _ = evaluated(formula, invented(0.0))
    error = np.log(clean / invented(0.0)["friction_coefficient"].values)
    assert np.sqrt(np.mean(error**2)) < 0.5 * formula.prediction_error


def test_formula_is_held_at_the_ends_of_its_range() -> None:
    formula = fit_friction(invented(0.0))
    oil = oil_75w90(50.0)
    slides = np.array([0.0, 0.025, 0.1])
    friction, inside = formula(1e9, 0.02, 5.0, slides, oil.viscosity, oil.pressure_viscosity, 0.5e-6, STEEL)
    assert friction[0] == pytest.approx(friction[1], rel=1e-12)
    assert inside.tolist() == [False, True, True]
    assert np.isfinite(friction).all()


def test_too_few_cases_for_a_formula_are_refused() -> None:
    with pytest.raises(InputError, match="too few"):
        fit_friction(invented(0.0).isel(combination=slice(0, 12)))


def test_shipped_study_is_certified_and_its_formula_a_model_for_gears() -> None:
    formula = shipped_formula()
    with xr.open_dataset(SHIPPED, engine="netcdf4") as dataset:
        dataset.load()
        assert dataset.sizes["combination"] >= formula.cases >= 60
        assert {float(v) for v in np.unique(dataset["status"])} <= {Status.CERTIFIED, Status.NOT_CONVERGED}
        assert float(dataset["asperity_share"].max()) > 0.02
        # Full films carry all of the load.
        full = dataset["asperity_share"].where(dataset["lambda_ratio"] > 3.0)
        assert float(full.max()) < 1e-3
    assert SHIPPED.stat().st_size < 300_000
    slides = np.array([0.1, 0.5])
    by_gear = friction_coefficient(
        formula.coefficient,
        hertz_pressure=1e9,
        equivalent_radius=0.02,
        rolling_velocity=5.0,
        slide_to_roll=slides,
        roughness=0.4e-6,
        temperature=75.0,
    )
    expected, inside = formula(1e9, 0.02, 5.0, slides, 0.0208, 11.4e-9, 0.4e-6 * np.sqrt(2.0))
    assert inside.all()
    np.testing.assert_allclose(by_gear, expected, rtol=1e-9)
    assert (expected > 1e-3).all()
    assert (expected < 0.1).all()
