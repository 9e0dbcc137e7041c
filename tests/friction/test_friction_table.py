"""The table [friction] of a case: checked when it is read, used by an analysis, changed by what the call gives."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from runs import SHELLS, output_of, read_only, small_text, text_file

import easeoff
from easeoff import InputError
from easeoff.cases import case_text, case_toml, parse_case
from easeoff.friction import FILMS, THERMAL_FACTORS, FrictionModel, Operation, friction
from easeoff.study.analysis.operating import operation_of

TABLE = """
[friction]
speed = [500, 1500]
temperature = 60
roughness = [[0.8, 0.4], 0.2]
oil = "PAO-VG100"
coefficient = 0.06
film = "dowson_higginson"
thermal_factor = "none"
rolling_frame = "contact_line"
feedback = true
"""
TEXT = case_text("nasa-12x36") + TABLE


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return text_file(tmp_path_factory.mktemp("case") / "mine.toml", small_text(more=SHELLS + TABLE))


def result(file: Path, *options: str) -> xr.DataTree:
    """What the command makes of the case."""
    out = file.parent / "out.nc"
    output_of("run", file, "-o", out, "--torque", "200", *options)
    return easeoff.read_result(out)


@pytest.fixture(scope="module")
def tree(file: Path) -> xr.DataTree:
    return read_only(result(file))


def test_every_key_arrives() -> None:
    table = parse_case(TEXT).friction
    assert table is not None
    operation = table.operation()
    assert operation.speeds.tolist() == [500.0, 1500.0]
    assert operation.temperatures.tolist() == [60.0]
    assert operation.roughnesses.tolist() == [[0.8, 0.4], [0.2, 0.2]]
    assert operation.lubricant.name == "pao-vg100"
    assert table.model() == FrictionModel(
        0.06,
        "dowson_higginson",
        "none",
        rolling_frame="contact_line",
    )
    assert table.feedback


def test_defaults_are_those_of_operation_and_model() -> None:
    table = parse_case(case_text("nasa-12x36") + "[friction]\nspeed = 1500\n").friction
    assert table is not None
    assert table.model() == FrictionModel()
    plain = Operation(1500.0)
    for name in ("speeds", "temperatures", "roughnesses"):
        np.testing.assert_array_equal(getattr(table.operation(), name), getattr(plain, name))
    assert table.operation().lubricant.name == plain.lubricant.name
    assert not table.feedback


def test_written_cases_read_the_same() -> None:
    case = parse_case(TEXT)
    assert parse_case(case_toml(case)).model_dump() == case.model_dump()


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ("", ["friction.speed", "is missing"]),
        ("speed = 0", ["friction", "speed = 0", "above 0"]),
        ("speed = -10", ["friction", "speed = -10"]),
        ("speed = [100, nan]", ["friction.speed.1", "nan", "finite"]),
        ("speed = [100, 100]", ["comes twice"]),
        ('speed = "fast"', ["friction.speed.0", "'fast'", "number"]),
        ("speed = []", ["friction.speed", "at least 1 value"]),
        ("speed = true", ["friction.speed.0 = true: must be a number"]),
        ('speed = ["100"]', ["friction.speed.0 = '100': must be a number"]),
        ("speed = 100\ntemperature = true", ["friction.temperature.0 = true: must be a number"]),
        ("speed = 100\nroughness = true", ["a mistake", "friction.roughness: true", "pinion and gear"]),
        ("speed = 100\nroughness = [nan]", ["a mistake", "friction.roughness: nan", "pinion and gear"]),
        ("speed = 100\ncoefficient = nan", ["a mistake", "coefficient: nan", "kolivand_blended", "or a number"]),
        ("speed = 100\ncoefficient = inf", ["a mistake", "coefficient: inf", "kolivand_blended", "or a number"]),
        ("speed = 100\ncoefficient = true", ["a mistake", "coefficient: true", "kolivand_blended", "or a number"]),
        ("speed = 100\ncoefficient = [0.05]", ["a mistake", "[0.05]", "kolivand_blended", "or a number"]),
        ("speed = 100\ntemperature = 140", ["temperature = 140", "25 to 100", "clamp"]),
        ("speed = 100\nroughness = -1", ["roughness", "-1", "from 0 to 100 [um]"]),
        ("speed = 100\nroughness = [[1, 2, 3]]", ["friction.roughness", "[1, 2, 3]", "pinion and gear"]),
        ('speed = 100\nroughness = ["0.8/0.4"]', ["friction.roughness", "'0.8/0.4'", "pinion and gear"]),
        ('speed = 100\noil = "butter"', ["oil = 'butter'", "75w90"]),
        ('speed = 100\ncoefficient = "sand"', ["'sand'", "kolivand_blended"]),
        ("speed = 100\ncoefficient = 1000", ["coefficient = 1000: must be a number from 0 to 1"]),
        ("speed = 1e-308", ["speed = 1e-308: must be a number from 1e-06 to 1e+06 [1/min]"]),
        ('speed = 100\ntemperature = 1e308\nout_of_range = "clamp"', ["temperature = 1e+308: must be", "400 [degC]"]),
        ("speed = 100\ncoefficient = -0.1", ["-0.1", "from 0 to 1"]),
        ('speed = 100\nfilm = "thick"', ["film = 'thick'", *FILMS]),
        ('speed = 100\nthermal_factor = "hot"', ["thermal_factor = 'hot'", *THERMAL_FACTORS]),
        ('speed = 100\nradius_direction = "along"', ["friction.radius_direction", "known are", "rolling_frame"]),
        ('speed = 100\nrolling_frame = "moon"', ["friction.rolling_frame", "'moon'", "'fixed' or 'contact_line'"]),
        ("speed = 100\nfeedback = 1", ["friction.feedback = 1: must be true or false"]),
        ("speeds = 100\nspeed = 100", ["friction.speeds", "known are", "temperature"]),
    ],
)
def test_mistakes_name_key_value_and_what_is_allowed(lines: str, words: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        parse_case(f"{case_text('nasa-12x36')}\n[friction]\n{lines}\n", "mine.toml")
    for word in ["mine.toml has a mistake", *words]:
        assert word in str(caught.value)


@pytest.mark.parametrize("key", ["coefficient", "roughness"])
def test_whole_numbers_that_toml_does_not_have_are_refused(key: str) -> None:
    lines = f"speed = 100\n{key} = {10**400}"
    with pytest.raises(InputError, match=f"mine.toml: friction.{key}: must be a whole number of at most 64 bits"):
        parse_case(f"{case_text('nasa-12x36')}\n[friction]\n{lines}\n", "mine.toml")


def test_beyond_the_oil_is_flagged_if_asked() -> None:
    lines = 'speed = 100\ntemperature = 140\nout_of_range = "clamp"\n'
    table = parse_case(f"{case_text('nasa-12x36')}\n[friction]\n{lines}").friction
    assert table is not None
    assert table.model().oil_states(table.operation()).clamped.tolist() == [True]


def test_an_analysis_takes_the_table(tree: xr.DataTree) -> None:
    """The same as with everything given by hand; the feedback shows in variables of its own."""
    found = tree["friction"].to_dataset()
    assert "energy_balance" in found
    assert found.attrs["oil"] == "pao-vg100"
    assert found.attrs["rolling_frame"] == "contact_line"
    by_hand = easeoff.analyze(
        parse_case(small_text(more=SHELLS)),
        torques=200.0,
        speed=[500.0, 1500.0],
        temperature=60.0,
        roughness=[(0.8, 0.4), 0.2],
        oil="pao-vg100",
        friction_model=FrictionModel(
            0.06,
            "dowson_higginson",
            "none",
            rolling_frame="contact_line",
        ),
        friction_feedback=True,
    )
    xr.testing.assert_identical(by_hand["friction"].to_dataset(), found)


def test_arguments_go_before_the_table(tree: xr.DataTree, file: Path) -> None:
    given: dict[str, Any] = {"temperature": [50.0, 80.0], "friction_model": FrictionModel(), "friction_feedback": False}
    found = easeoff.analyze(file, torques=200.0, **given)["friction"].to_dataset()
    assert "energy_balance" not in found
    assert found["speed"].values.tolist() == [500.0, 1500.0]
    expected = friction(tree, Operation([500.0, 1500.0], [50.0, 80.0], [(0.8, 0.4), 0.2], "pao-vg100"))
    xr.testing.assert_identical(found, expected)


def test_what_is_given_by_hand_is_checked_with_the_table() -> None:
    table = parse_case(TEXT).friction
    assert table is not None
    with pytest.raises(InputError, match="oil = 'butter'"):
        operation_of(table, oil="butter")


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ([], {"speed": [500.0, 1500.0], "oil": "pao-vg100", "coefficient": "0.06", "fed_back": True}),
        (
            ["--speed", "800", "--oil", "75w90", "--friction-model", "kolivand", "--no-friction-feedback"],
            {"speed": [800.0], "oil": "75w90", "coefficient": "kolivand", "fed_back": False},
        ),
    ],
)
def test_command_line(tree: xr.DataTree, file: Path, options: list[str], expected: dict[str, Any]) -> None:
    group = (result(file, *options) if options else tree)["friction"].to_dataset()
    assert group["speed"].values.tolist() == expected["speed"]
    assert group["temperature"].values.tolist() == [60.0]
    assert group["roughness_gear"].values.tolist() == [0.4, 0.2]
    assert group.attrs["oil"] == expected["oil"]
    assert group.attrs["friction_coefficient"] == expected["coefficient"]
    assert group.attrs["film"] == "dowson_higginson"
    assert ("energy_balance" in group) == expected["fed_back"]
