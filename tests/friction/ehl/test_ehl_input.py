"""What the film model is given: wrong arguments are refused by name, value and what is allowed."""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from friction_studies import stored_studies
from runs import text_file

from easeoff import EaseoffError, InputError
from easeoff.friction import ContactConditions
from easeoff.friction.ehl import (
    LubricatedContact,
    Oil,
    RoughProfile,
    Status,
    asperity,
    generated_profile,
    measured_profile,
    traction,
    wave,
)
from easeoff.friction.ehl.study import (
    Design,
    Resolution,
    compare,
    fit_friction,
    run_study,
    shipped_formula,
    study_design as cases_module,
    study_design as study_module,
)
from easeoff.friction.ehl.study.friction_formula import FORMULA_FILE, read_formula
from easeoff.friction.ehl.study.study_design import MODEL_VERSION, NUMBERS, Condition, Row, numbers, oil_75w90, run_case

NAN, INF = math.nan, math.inf
OIL: dict[str, Any] = {"viscosity": 0.02, "pressure_viscosity": 1.1e-8}
CONTACT = LubricatedContact(1e9, 0.02, 5.0, Oil(**OIL), 0.25)
X = np.linspace(-1.0, 1.0, 41) * CONTACT.half_width
PRESSURE = 1e9 * np.sqrt(1.0 - (X / CONTACT.half_width) ** 2)
FILM = np.full_like(X, 5e-7)
SMALL = Design((0.5, 1.0), (5.0, 20.0), (1.0, 5.0), (0.1,), (50.0,), (0.1,))
COARSE = Resolution(fewest=65)
CONDITIONS_OF_OIL = ("viscosity", "pressure_viscosity", "temperature_viscosity", "thermal_conductivity")
POSITIVE = [NAN, INF, 0, -1.0, None, "1", True, [1.0], np.array([1.0, 2.0]), 1 + 0j]


def refused(match: str, call: Callable[[], object]) -> None:
    """Refused by name, and without a warning before."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(InputError, match=match):
            call()


@pytest.mark.parametrize("value", POSITIVE)
def test_oil_and_contact_refuse_what_is_no_positive_number(value: Any) -> None:
    refused("^viscosity = .*: must", lambda: Oil(value, 1e-8))
    if value is not None:
        refused("^thermal_conductivity", lambda: Oil(**OIL, thermal_conductivity=value))
    for name in ("hertz_pressure", "equivalent_radius", "rolling_velocity", "contact_modulus", "inlet_viscosity"):
        refused(f"^{name} .*: must", lambda name=name: replace(CONTACT, **{name: value}))  # type: ignore[misc]


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("oil", None),
        ("oil", 3),
        ("slide_to_roll", 1 + 0j),
        ("slide_to_roll", None),
        ("slide_to_roll", 2.1),
        ("slide_to_roll", NAN),
        ("slide_to_roll", np.array([0.1, 0.2])),
    ],
)
def test_contact_refuses_a_wrong_oil_or_sliding(name: str, value: Any) -> None:
    refused(f"^{name} .*: must", lambda: replace(CONTACT, **{name: value}))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("inlet_temperature", INF),
        ("inlet_temperature", "20"),
        ("law", np.array([1.0, 2.0])),
        ("law", None),
        ("compressible", "no"),
        ("eyring_stress", NAN),
        ("eyring_stress", "5e6"),
    ],
)
def test_oil_refuses_other_mistakes(name: str, value: Any) -> None:
    refused(f"^{name} ", lambda: Oil(**{**OIL, name: value}))


def test_names_and_groups_are_those_of_the_conditions_of_friction() -> None:
    """One name for one quantity: the same contact says the same here and there."""
    contact = replace(CONTACT, oil=Oil(**OIL, temperature_viscosity=0.04, thermal_conductivity=0.14))
    names = ("hertz_pressure", "equivalent_radius", "rolling_velocity", "sliding_velocity", "slide_to_roll")
    conditions = ContactConditions(
        **{name: getattr(contact, name) for name in (*names, "contact_modulus")},
        **{name: getattr(contact.oil, name) for name in asdict(contact.oil) if name in CONDITIONS_OF_OIL},
        temperature=np.asarray(50.0),
        roughness_pinion=np.asarray(0.0),
        roughness_gear=np.asarray(0.0),
    )
    for group in ("pressure", "load", "speed", "material", "thermal"):
        name = f"{group}_parameter"
        assert getattr(contact, name) == pytest.approx(float(getattr(conditions, name)), rel=1e-14)
    assert contact.load == pytest.approx(float(conditions.load), rel=1e-14)


def test_numbers_of_numpy_are_numbers() -> None:
    contact = LubricatedContact(np.float64(1e9), np.float32(0.02), np.int64(5), Oil(np.float64(0.02), 1.1e-8, INF))  # type: ignore[arg-type]
    assert contact.load == pytest.approx(CONTACT.load, rel=1e-6)
    for value in ("50", [50], None, True):
        refused("^temperature", lambda value=value: oil_75w90(value))  # type: ignore[misc]


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("position", X[::-1]),
        ("position", X[:-1]),
        ("position", X**3),
        ("position", 0.0),
        ("position", X[:1]),
        ("pressure", PRESSURE * NAN),
        ("pressure", PRESSURE[:-1]),
        ("film", -FILM),
        ("film", 0.0 * FILM),
        ("film", FILM[:-1]),
        ("film", ["a"] * X.size),
        ("fluid_part", 2.0),
        ("fluid_part", -1.0),
        ("fluid_part", NAN),
        ("fluid_part", None),
        ("fluid_part", np.ones(3)),
        ("fluid_part", np.full_like(X, 1.5)),
        ("asperity_pressure", NAN),
        ("asperity_pressure", np.full_like(X, -1.0)),
        ("boundary_friction", -1.0),
        ("boundary_friction", NAN),
        ("boundary_friction", "a"),
        ("effusivity", -1.0),
        ("thermal", "no"),
    ],
)
def test_traction_refuses_wrong_fields_and_coefficients(name: str, value: Any) -> None:
    given = {"position": X, "pressure": PRESSURE, "film": FILM, name: value}
    wrong = "pressure|position" if name == "position" else name
    refused(f"({wrong}) .*: must", lambda: traction(CONTACT, **given))


def test_traction_does_not_mind_a_gap_that_nothing_presses() -> None:
    """At the ends of a domain, and in lists."""
    film = FILM.copy()
    film[[0, -1]] = -1e-9
    expected = traction(CONTACT, X, PRESSURE, FILM).coefficient
    assert PRESSURE[0] == PRESSURE[-1] == 0.0
    assert traction(CONTACT, X.tolist(), PRESSURE.tolist(), film.tolist()).coefficient == expected


@pytest.mark.parametrize("value", [NAN, INF, None, "a"])
def test_profiles_refuse_what_is_no_number(value: Any) -> None:
    refused("^amplitude", lambda: wave(value, 1e-4))
    refused("^wavelength", lambda: wave(1e-7, value))
    refused("^height", lambda: asperity(value, 1e-4, 0.0))
    refused("^width", lambda: asperity(1e-7, value, 0.0))
    refused("^point", lambda: asperity(1e-7, 1e-4, value))
    refused("^seed", lambda: generated_profile(1e-7, 1e-5, 1e-3, value))
    refused("^rms", lambda: generated_profile(value, 1e-5, 1e-3, 1))
    refused("^rms", lambda: generated_profile(1e-7, 1e-5, 1e-3, 1).scaled(value))
    refused("^spacing", lambda: measured_profile(np.arange(20.0) ** 2, value))
    refused("^heights", lambda: measured_profile([value] * 20, 1e-6))
    refused("^heights", lambda: RoughProfile([value] * 20, 1e-6))  # type: ignore[arg-type]


def test_flat_trace_is_flat_and_cannot_be_scaled_up() -> None:
    for trace in (np.full(20, 3.7), 0.1 * np.arange(20.0), np.zeros(20)):
        profile = measured_profile(trace, 1e-6)
        assert profile.rms == 0.0
        refused("flat", lambda profile=profile: profile.scaled(1e-7))  # type: ignore[misc]
        assert profile.scaled(0.0).rms == 0.0
    assert measured_profile(1.0 + 1e-9 * np.sin(np.arange(40.0)), 1e-6).scaled(1e-7).rms == pytest.approx(1e-7)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("correlation_length", -1.0),
        ("correlation_length", NAN),
        ("fewest", 10),
        ("fewest", 257.0),
        ("fewest", NAN),
        ("fewest", "a"),
        ("most", 3),
        ("most", 255),
        ("points", -1.0),
        ("travel", -5.0),
        ("smooth_from", NAN),
        ("flooded", NAN),
        ("flooded", 0.0),
        ("flooded", 1e-9),
        ("flooded", INF),
        ("order", 3),
        ("seed", -1),
        ("seed", 1.5),
        ("touching_film", 0.0),
        ("boundary_friction", -1.0),
        ("boundary_friction", NAN),
        ("thermal", "no"),
        ("model", None),
        ("model", ["passage"]),
    ],
)
def test_resolution_refuses_what_it_cannot_use(name: str, value: Any) -> None:
    refused(f"^{name} ", lambda: Resolution(**{"model": "passage", name: value}))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("hertz_pressure", ()),
        ("hertz_pressure", 1.0),
        ("hertz_pressure", (NAN,)),
        ("hertz_pressure", (500.0,)),
        ("hertz_pressure", "1"),
        ("hertz_pressure", np.ones((2, 2))),
        ("equivalent_radius", ("a",)),
        ("rolling_velocity", (0.0,)),
        ("slide_to_roll", (3.0,)),
        ("temperature", (20.0,)),
        ("roughness", (-0.1,)),
        ("roughness", (0.0,)),
    ],
)
def test_design_and_condition_refuse_levels_that_are_none(name: str, value: Any) -> None:
    refused(f"^{name} .*: must", lambda: Design(**{name: value}))
    if isinstance(value, tuple) and value:
        name = {"roughness": "roughness_2"}.get(name, name)
        given = asdict(Design().condition(0)) | {name: value[0]}
        refused(f"^{name} .*: must", lambda: Condition(**given))


def test_design_takes_lists_and_arrays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    design = Design(hertz_pressure=np.array([0.5, 1.0]), equivalent_radius=[5, 20], temperature=(50.0,))  # type: ignore[arg-type]
    assert design == Design(hertz_pressure=(0.5, 1.0), equivalent_radius=(5.0, 20.0), temperature=(50.0,))
    monkeypatch.setattr(study_module, "run_case", certified)
    assert run_study(tmp_path / "x.nc", 3, design=design).sizes["combination"] == 3


def certified(condition: Condition, resolution: Resolution) -> Row:
    return {**dict.fromkeys(NUMBERS, 0.01), "status": float(Status.CERTIFIED)}


def unexpected(*_: object) -> Row:
    raise AssertionError("a case was computed")


@pytest.mark.parametrize("wanted", ["3", True, np.array(3.0), 1.5, [1.7], [NAN], ["a"], [], [[0, 1]], [True]])
def test_wanted_cases_that_are_none_are_refused(wanted: Any, tmp_path: Path) -> None:
    refused("^wanted = .*: must", lambda: run_study(tmp_path / "x.nc", wanted, design=SMALL))


def test_wanted_cases_by_numbers_of_numpy() -> None:
    np.testing.assert_array_equal(numbers(SMALL, np.int64(3)), SMALL.subset(3))  # type: ignore[arg-type]
    assert numbers(SMALL, np.array([0, 5])).tolist() == numbers(SMALL, range(0, 6, 5)).tolist() == [0, 5]
    for number in (1.5, NAN, "a", None, [0], True):
        refused("^number = .*: must", lambda number=number: SMALL.condition(number))  # type: ignore[misc]
        refused("^size", lambda number=number: SMALL.subset(number))  # type: ignore[misc]
    refused("^seed", lambda: SMALL.subset(3, -1))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("seconds", NAN),
        ("seconds", "a"),
        ("seconds", None),
        ("progress", 3),
        ("design", 0),
        ("resolution", "passage"),
        ("resolution", Resolution(correlation_length=1e-9)),
    ],
)
def test_study_refuses_wrong_arguments_before_any_work(
    name: str, value: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(study_module, "run_case", unexpected)
    word = "correlation_length" if isinstance(value, Resolution) else f"^{name}"
    refused(word, lambda: run_study(tmp_path / "x.nc", 2, **{"design": SMALL, name: value}))
    assert not list(tmp_path.iterdir())


def test_case_fails_as_a_row_only_where_the_model_does(monkeypatch: pytest.MonkeyPatch) -> None:
    refused("^condition", lambda: run_case(None))  # type: ignore[arg-type]
    refused("^resolution", lambda: run_case(SMALL.condition(0), "passage"))  # type: ignore[arg-type]

    def raising(error: Exception) -> None:
        def computed(*_: object) -> Row:
            raise error

        monkeypatch.setattr(cases_module, "_computed", computed)

    for error in (EaseoffError("a"), ZeroDivisionError("b"), np.linalg.LinAlgError("c")):
        raising(error)
        assert run_case(SMALL.condition(0))["status"] == Status.FAILED
    raising(AttributeError("a mistake"))
    with pytest.raises(AttributeError, match="a mistake"):
        run_case(SMALL.condition(0))


def test_what_failed_is_in_the_dataset(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(condition: Condition, _: Resolution) -> Row:
        if condition.hertz_pressure > 0.6:
            raise FloatingPointError("overflow")
        return {"status": 0.0}

    monkeypatch.setattr(cases_module, "_computed", broken)
    run_study(tmp_path / "x.nc", design=SMALL)
    with xr.open_dataset(tmp_path / "x.nc", engine="netcdf4") as dataset:
        failed = dataset["status"].values == Status.FAILED
        assert failed.sum() == 4
        assert all("overflow" in text for text in dataset["failure"].values[failed])
        assert not any(dataset["failure"].values[~failed])


def test_study_makes_its_folder(tmp_path: Path) -> None:
    path = tmp_path / "a" / "b" / "x.nc"
    dataset = run_study(path, 2, design=SMALL, resolution=COARSE)
    assert path.exists()
    assert (dataset["status"] == Status.CERTIFIED).all()
    assert dataset.attrs["model_version"] == MODEL_VERSION


def test_path_that_cannot_be_written_is_refused_before_any_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(study_module, "run_case", unexpected)
    (tmp_path / "file").write_text("")
    (tmp_path / "folder.nc.rows").mkdir()
    refused("cannot be written", lambda: run_study(tmp_path / "file" / "x.nc", 2, design=SMALL))
    refused("is a folder", lambda: run_study(tmp_path / "folder.nc", 2, design=SMALL))
    if Path("/proc/self").exists():
        refused("cannot be written", lambda: run_study("/proc/x.nc", 2, design=SMALL))


def test_file_that_is_no_study_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study_module, "run_case", certified)
    (tmp_path / "notes.nc").write_text("precious")
    xr.Dataset({"a": ("x", [1, 2])}).to_netcdf(tmp_path / "other.nc")
    for name in ("notes.nc", "other.nc"):
        before = (tmp_path / name).read_bytes()
        refused("no study", lambda name=name: run_study(tmp_path / name, 2, design=SMALL))  # type: ignore[misc]
        assert (tmp_path / name).read_bytes() == before
    run_study(tmp_path / "x.nc", 2, design=SMALL)
    assert run_study(tmp_path / "x.nc", 3, design=SMALL).sizes["combination"] == 3


def test_rows_of_another_version_or_broken_ones_are_computed_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls: list[Condition] = []

    def counted(condition: Condition, resolution: Resolution) -> Row:
        calls.append(condition)
        return certified(condition, resolution)

    monkeypatch.setattr(study_module, "run_case", counted)
    path, store = tmp_path / "x.nc", tmp_path / "x.nc.rows"
    run_study(path, design=SMALL)
    assert len(calls) == 8
    header, *lines = store.read_text().splitlines()
    entries = [json.loads(line) for line in lines]
    entries[0]["record"] = {}
    entries[1]["record"]["status"] = None
    entries[2]["record"]["status"] = 77
    entries[3]["record"] = 5
    entries[4]["record"]["film_friction"] = "x"
    store.write_text("\n".join([header, "3", "[1]", "null", *map(json.dumps, entries)]))
    assert (run_study(path, design=SMALL)["status"] == Status.CERTIFIED).all()
    assert len(calls) == 13
    run_study(path, design=SMALL)
    assert len(calls) == 13
    monkeypatch.setattr(study_module, "MODEL_VERSION", MODEL_VERSION + 1)
    run_study(path, design=SMALL)
    assert len(calls) == 21


@pytest.mark.parametrize("place", range(8))
def test_formula_has_no_number_where_an_input_is_none(place: int) -> None:
    formula = shipped_formula()
    good = [1e9, 0.02, 5.0, 0.25, 0.0208, 11.4e-9, 0.6e-6, 2.27e11]
    bad = np.array([NAN, INF, -INF, 0.0, -good[place]])
    given: list[Any] = [*good[:place], bad, *good[place + 1 :]]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        friction, inside = formula(*given)
        usual, _ = formula(*good)
    expected = [False, False, False, place in (3, 6), place == 3]  # zero is taken at the end; sliding has a sign
    assert np.isfinite(friction).tolist() == expected
    assert inside.tolist() == [False, False, False, False, place == 3]
    assert place != 3 or friction[-1] == pytest.approx(float(usual), rel=1e-12)


@pytest.mark.parametrize("content", ["[]", "3", "null", "{}", "{", '"a"'])
def test_file_that_is_no_formula_is_refused(content: str, tmp_path: Path) -> None:
    path = text_file(tmp_path / "x.json", content)
    refused(r"x\.json is not a friction formula", lambda: read_formula(path))


@pytest.mark.parametrize("name", ["share", "film", "lowest", "ratios", "oil", "boundary_friction", "regimes"])
@pytest.mark.parametrize("value", [None, [1.0, 2.0, 3.0], "a"])
def test_formula_with_a_wrong_shape_inside_is_refused(name: str, value: Any, tmp_path: Path) -> None:
    path = text_file(tmp_path / "x.json", json.dumps(json.loads(FORMULA_FILE.read_text()) | {name: value}))
    refused(r"x\.json is not a friction formula", lambda: read_formula(path))


def test_fit_refuses_what_is_no_study_or_does_not_fit_together() -> None:
    study = stored_studies()[1].isel(combination=slice(0, 600))
    other = study.assign_attrs(boundary_friction=0.2)
    bare = study.copy()
    del bare.attrs["boundary_friction"]
    holed = study.copy(deep=True)
    holed["asperity_share"][5] = NAN
    refused("^studies = none: must be", fit_friction)
    refused("^study", lambda: fit_friction([study, study]))  # type: ignore[arg-type]
    refused("must be a study of run_study", lambda: fit_friction(xr.Dataset()))
    refused("boundary_friction", lambda: fit_friction(study, other))
    refused("boundary_friction", lambda: fit_friction(bare))
    refused(f"asperity_share of combination {int(study['combination'][5])} = nan", lambda: fit_friction(study, holed))


def test_own_formula_is_compared_as_any_other() -> None:
    """Over both studies its error is the one it states."""
    formula = shipped_formula()
    regimes = [regime for study in stored_studies() for regime in compare(study, formula)]
    assert sum(regime.cases for regime in regimes) == formula.cases
    total = sum(regime.cases * regime.rms**2 for regime in regimes)
    assert math.sqrt(total / formula.cases) == pytest.approx(formula.fit_error, rel=1e-2)
    refused("^formula", lambda: compare(stored_studies()[1], None))  # type: ignore[arg-type]
    refused("must be a study of run_study", lambda: compare(xr.Dataset(), formula))
