"""Parameter study of the film model: design, resuming, failures as rows, the formula fitted to it."""

from __future__ import annotations

import math
import sys
from dataclasses import asdict, replace
from functools import cache
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
import xarray as xr
from friction_studies import RIDGES_FILE, STUDY_FILES, stored_studies
from runs import read_only

import easeoff.friction
from easeoff import InputError, MissingPackageError
from easeoff.friction import friction_coefficient
from easeoff.friction.conditions import STEEL_MODULUS, pan_hamrock
from easeoff.friction.ehl import Status
from easeoff.friction.ehl.study import (
    Design,
    FrictionFormula,
    Resolution,
    compare,
    fit_friction,
    run_study,
    shipped_formula,
    study_design as cases_module,
    study_design as study_module,
)
from easeoff.friction.ehl.study.friction_formula import read_formula, study_inputs, write_formula
from easeoff.friction.ehl.study.study_design import NUMBERS, REFINED, Condition, Row, oil_75w90, run_case, study_dataset


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


@pytest.mark.parametrize("model", ["load_sharing", "passage"])
def test_case_of_the_study_has_its_numbers_and_a_lambda_ratio(model: Literal["load_sharing", "passage"]) -> None:
    condition = Condition(0.5, 5.0, 20.0, 0.5, 50.0, 0.2, 0.2)
    coarse = Resolution(model=model, fewest=97, most=129, travel=1.0, smooth_from=9.0)
    row = run_case(condition, coarse)
    assert row["status"] == Status.CERTIFIED
    assert row["certified_share"] == 1.0
    assert row["lambda_ratio"] == pytest.approx(row["smooth_film"] / (0.2 * np.sqrt(2.0)))
    assert 3.0 < row["lambda_ratio"] < 9.0
    assert 0.001 < row["film_friction"] < 0.06
    assert row["asperity_share"] < 1e-6
    cooler = run_case(condition, replace(coarse, thermal=False))
    assert cooler["film_friction"] > row["film_friction"]
    # So far above the roughness, the smooth film stands for the rough one, and both models agree.
    smooth = run_case(condition, replace(coarse, model="passage", smooth_from=3.0))
    assert smooth["film_friction"] == pytest.approx(row["film_friction"], rel=0.05)


@pytest.mark.parametrize("model", ["load_sharing", "passage"])
@pytest.mark.quick(1)
def test_friction_rises_as_the_lambda_ratio_falls(model: Literal["load_sharing", "passage"]) -> None:
    """The published trend of Stribeck, with speed as well as with roughness."""
    coarse = Resolution(model=model, fewest=97, travel=6.0)
    rougher = [run_case(Condition(0.7, 5.0, 5.0, 0.25, 90.0, s, s), coarse) for s in (0.1, 0.35, 1.0)]
    slower = [run_case(Condition(0.7, 5.0, u, 0.25, 90.0, 0.85, 0.85), coarse) for u in (20.0, 0.2)]
    for rows in (rougher, slower):
        assert all(row["status"] == Status.CERTIFIED for row in rows)
        friction = [row["film_friction"] + row["asperity_friction"] for row in rows]
        assert (np.diff([row["lambda_ratio"] for row in rows]) < 0.0).all()
        shares = [row["asperity_share"] for row in rows]
        assert (np.diff(shares) >= 0.0).all()
        assert shares[-1] > shares[0] + 0.01
        assert friction[-1] > 1.05 * friction[0]


def fake(calls: list[Condition]) -> object:
    def case(condition: Condition, resolution: Resolution) -> Row:
        calls.append(condition)
        row = dict.fromkeys(NUMBERS, 0.01)
        return {**row, "status": float(Status.CERTIFIED)}

    return case


def test_study_goes_on_where_it_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[Condition] = []
    monkeypatch.setattr(study_module, "run_case", fake(calls))
    path = tmp_path / "study.nc"
    none = run_study(path, 10, seconds=-1.0)
    assert none.sizes["combination"] == 10
    assert (none["status"] == Status.NOT_RUN).all()
    assert np.isnan(none["friction_coefficient"]).all()
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

    monkeypatch.setattr(cases_module, "_computed", broken)
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


def test_unknown_model_is_refused() -> None:
    with pytest.raises(InputError, match="load_sharing"):
        Resolution(model="dry")  # type: ignore[arg-type]


@pytest.mark.parametrize("number", [-1, 31500])
def test_combination_that_does_not_exist_is_refused(number: int, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="number = "):
        run_study(tmp_path / "study.nc", [number])
    with pytest.raises(InputError, match="size"):
        Design().subset(0)


@cache
def invented(noise: float, cases: int = 600) -> xr.Dataset:
    """A study that shares the load by a known law, with noise; read-only."""
    design = Design()
    rng = np.random.default_rng(5)
    certified: Row = {**dict.fromkeys(NUMBERS, 0.0), "status": float(Status.CERTIFIED)}
    dataset = study_dataset(design, dict.fromkeys(design.subset(cases).tolist(), certified))
    dataset.attrs["boundary_friction"] = 0.1
    p, r, u, s, eta, alpha, sigma, modulus = study_inputs(dataset)
    speed, load = eta * u / (modulus * r), 2.0 * np.pi * (p / modulus) ** 2
    ratio = pan_hamrock(speed, alpha * modulus, load) * r / sigma
    share = 1.0 / (1.0 + ratio**2)
    film = 0.02 * s**0.2 * (p / 1e9) ** 0.3 * np.exp(0.05 * np.log(u) * np.log(eta))
    dataset["asperity_share"][:] = share
    dataset["asperity_friction"][:] = 0.1 * share
    friction = (0.1 * share + (1.0 - share) * film) * np.exp(noise * rng.normal(size=cases))
    dataset["film_friction"][:] = friction - 0.1 * share
    dataset["friction_coefficient"][:] = friction
    return read_only(dataset)


@cache
def fitted(noise: float, cases: int = 600) -> FrictionFormula:
    return fit_friction(invented(noise, cases))


def evaluated(formula: FrictionFormula, dataset: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    p, r, u, s, *rest = study_inputs(dataset)
    return formula(p, r, u, -np.asarray(s), *rest)


def test_formula_finds_a_law_of_its_own_form() -> None:
    dataset = invented(0.0)
    formula = fitted(0.0)
    friction, inside = evaluated(formula, dataset)
    assert inside.all()
    np.testing.assert_allclose(friction, dataset["friction_coefficient"], rtol=5e-3)
    assert formula.prediction_error < 1e-3
    assert formula.cases == 600


def test_prediction_error_is_that_of_leaving_out_and_as_large_as_the_noise() -> None:
    formula = fitted(0.1, 1200)
    assert 0.08 < formula.fit_error <= formula.prediction_error < 0.13
    assert formula.determination > 0.8
    assert sum(regime.cases for regime in formula.regimes) == 1200
    squares = sum(regime.cases * regime.rms**2 for regime in formula.regimes)
    assert np.sqrt(squares / 1200) == pytest.approx(formula.prediction_error)
    # Without the noise, the formula is much nearer to the law.
    clean = invented(0.0, 1200)
    error = np.log(evaluated(formula, clean)[0] / clean["friction_coefficient"].values)
    assert np.sqrt(np.mean(error**2)) < 0.5 * formula.prediction_error


def test_formula_is_held_at_the_ends_of_its_range_and_says_so() -> None:
    formula = fitted(0.0)
    oil = oil_75w90(50.0)
    slides = np.array([0.0, 0.025, 0.1])
    friction, inside = formula(1e9, 0.02, 5.0, slides, oil.viscosity, oil.pressure_viscosity, 0.5e-6, STEEL_MODULUS)
    assert friction[0] == pytest.approx(friction[1], rel=1e-12)
    assert inside.tolist() == [False, True, True]
    coefficients = oil.pressure_viscosity * np.array([1.0, 1.4])
    other, inside = formula(1e9, 0.02, 5.0, 0.1, oil.viscosity, coefficients, 0.5e-6)
    assert inside.tolist() == [True, False]  # another kind of oil
    end, _ = formula(1e9, 0.02, 5.0, 0.1, oil.viscosity, 2.0 * oil.pressure_viscosity, 0.5e-6)
    assert float(end) == pytest.approx(other[1], rel=1e-15)
    smooth, inside = formula(1e9, 0.02, 5.0, 0.1, oil.viscosity, oil.pressure_viscosity, [0.0, 5e-6])
    assert not inside.any()
    assert np.isfinite(smooth).all()


def test_formula_takes_a_million_conditions_at_once() -> None:
    """In pieces: as one by one."""
    formula = fitted(0.0)
    slides = np.geomspace(0.025, 1.0, 40000).reshape(4, -1)
    friction, inside = formula(1e9, 0.02, 5.0, slides, 0.0208, 11.4e-9, 0.6e-6)
    assert friction.shape == inside.shape == slides.shape
    single, _ = formula(1e9, 0.02, 5.0, slides[3, 77], 0.0208, 11.4e-9, 0.6e-6)
    assert float(single) == pytest.approx(friction[3, 77], rel=1e-12)


def test_comparison_with_a_formula_is_its_error_by_regime() -> None:
    dataset = invented(0.0)
    model = dataset["friction_coefficient"].values
    twice = compare(dataset, lambda **_: 2.0 * model)
    assert sum(regime.cases for regime in twice) == 600
    assert [regime.mean for regime in twice] == pytest.approx([np.log(2.0)] * len(twice))
    assert [regime.worst for regime in twice] == pytest.approx([regime.rms for regime in twice])


def test_too_few_cases_for_a_formula_are_refused() -> None:
    with pytest.raises(InputError, match="certified cases = 12: must be"):
        fit_friction(invented(0.0).isel(combination=slice(0, 12)))


def test_stored_studies_are_no_part_of_the_package() -> None:
    assert not list(Path(easeoff.friction.__file__).parent.rglob("*.nc"))


@pytest.mark.parametrize(("number", "design"), [(0, Design()), (1, REFINED)])
def test_stored_studies_have_every_case_of_their_subset(number: int, design: Design) -> None:
    dataset = stored_studies()[number]
    cases = dataset.sizes["combination"]
    assert cases == (31500, 3000)[number]
    np.testing.assert_array_equal(np.sort(dataset["combination"]), np.sort(design.subset(cases)))
    assert (dataset["status"] == Status.CERTIFIED).mean() > 0.99
    assert np.isnan(dataset["friction_coefficient"].where(dataset["status"] != Status.CERTIFIED)).all()
    # The limits: asperities carry everything, or nothing.
    assert float(dataset["asperity_share"].where(dataset["lambda_ratio"] < 0.05).min()) > 0.8
    edges = [0.0, 0.05, 0.1, 0.2, 0.5, 1.0, 3.0]
    middle = dataset["friction_coefficient"].groupby_bins(dataset["lambda_ratio"], edges).median()
    assert (np.diff(middle) < 0.0).all()
    assert float(dataset["asperity_share"].where(dataset["lambda_ratio"] > 4.0).max()) < 1e-3
    assert STUDY_FILES[number].stat().st_size < 1_000_000
    assert {name: dataset.attrs[name] for name in asdict(Resolution())} == {
        name: int(value) if isinstance(value, bool) else value for name, value in asdict(Resolution()).items()
    }


@pytest.mark.parametrize("count", [3, pytest.param(100, marks=pytest.mark.thorough)])
@pytest.mark.parametrize(("number", "design"), [(0, Design()), (1, REFINED)])
def test_shipped_studies_are_what_this_version_computes(number: int, design: Design, count: int) -> None:
    """Rows at random to their five digits."""
    dataset = stored_studies()[number]
    for row in np.random.default_rng(7).choice(dataset.sizes["combination"], count, replace=False):
        stored = dataset.isel(combination=row)
        again = run_case(design.condition(int(stored["combination"])), Resolution())
        for name in set(NUMBERS) - {"run_time", "newton_steps"}:
            assert again[name] == pytest.approx(float(stored[name]), rel=5e-5, abs=1e-12), (row, name)
        assert again["status"] == stored["status"]


def test_shipped_ridges_are_a_whole_subset_in_which_films_agree_and_asperities_carry_less() -> None:
    with xr.open_dataset(RIDGES_FILE, engine="netcdf4") as dataset:
        dataset.load()
    cases = dataset.sizes["combination"]
    assert cases >= 48
    np.testing.assert_array_equal(dataset["combination"], Design().subset(cases))
    assert dataset.attrs["model"] == "passage"
    good = dataset["status"] == Status.CERTIFIED
    assert good.mean() > 0.8
    assert np.isfinite(dataset["status"]).all()
    sharing = stored_studies()[0].sel(combination=dataset["combination"])
    ratio = (dataset["friction_coefficient"] / sharing["friction_coefficient"]).where(good)
    thick = ratio.where(dataset["lambda_ratio"] >= 3.0).dropna("combination")
    assert float(np.abs(np.log(thick)).max()) < 0.05
    thin = ratio.where(dataset["lambda_ratio"] < 0.5).dropna("combination")
    assert float(thin.median()) < 0.6


def test_stored_study_beside_the_formula_of_the_dissertation() -> None:
    """Full films agree on the mean, mixed ones within a factor of 2.1; both rise together."""
    dataset = stored_studies()[0]
    regimes = compare(dataset, friction_coefficient)
    assert abs(regimes[-1].mean) < 0.1
    assert all(abs(regime.mean) < math.log(2.1) for regime in regimes)
    assert all(math.sqrt(regime.rms**2 - regime.mean**2) < 0.6 for regime in regimes)


def test_shipped_formula_has_the_error_it_states_on_the_stored_studies(tmp_path: Path) -> None:
    formula = shipped_formula()
    errors = []
    for dataset in stored_studies():
        friction, inside = formula(*study_inputs(dataset))
        assert inside.all()
        errors.append(np.log(friction / dataset["friction_coefficient"].values))
    together = np.concatenate(errors)
    assert together.size == formula.cases
    assert np.sqrt(np.mean(together**2)) == pytest.approx(formula.fit_error, rel=1e-2)
    write_formula(tmp_path / "formula.json", formula)
    again = read_formula(tmp_path / "formula.json")
    assert again.regimes == formula.regimes
    assert float(again(1e9, 0.02, 5.0, 0.1, 0.02, 1.1e-8, 5e-7)[0]) == float(
        formula(1e9, 0.02, 5.0, 0.1, 0.02, 1.1e-8, 5e-7)[0]
    )
    (tmp_path / "other.json").write_text('{"share": [1.0]}')
    with pytest.raises(InputError, match=r"other\.json"):
        read_formula(tmp_path / "other.json")


def test_shipped_formula_predicts_the_model_where_it_was_not_fitted() -> None:
    """Between the levels of the study."""
    formula = shipped_formula()
    assert formula.prediction_error < 0.1
    rng = np.random.default_rng(8)
    errors = []
    for _ in range(10):
        low, high = np.log([0.5, 5.0, 1.0, 0.025]), np.log([2.5, 40.0, 20.0, 1.0])
        p, r, u, s = np.exp(low + rng.random(4) * (high - low))
        condition = Condition(p, r, u, s, 25.0 + 75.0 * rng.random(), *(0.1 + 0.9 * rng.random(2)))
        row = run_case(condition, Resolution())
        oil = condition.contact.oil
        friction, inside = formula(
            1e9 * p, 1e-3 * r, u, s, oil.viscosity, oil.pressure_viscosity, condition.composite_roughness
        )
        assert inside
        errors.append(np.log(float(friction) / (row["film_friction"] + row["asperity_friction"])))
    assert np.sqrt(np.mean(np.square(errors))) < 0.15


def test_shipped_formula_is_a_model_for_gears() -> None:
    formula = shipped_formula()
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


def test_composite_roughness_is_the_root_of_the_sum_of_squares() -> None:
    condition = Condition(0.5, 5.0, 20.0, 0.5, 50.0, roughness_1=0.3, roughness_2=0.4)
    assert condition.composite_roughness == pytest.approx(0.5e-6)
