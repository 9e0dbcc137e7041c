"""Lubricants: what the tables say, between them, and beyond them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from easeoff import InputError
from easeoff.friction import Lubricant, available_lubricants, lubricant

SHIPPED = available_lubricants()


def test_the_dissertations_oil_has_the_numbers_of_its_table() -> None:
    """Kolivand 2009, Table 5.2."""
    oil = lubricant("75W90")
    state = oil.at([25.0, 50.0, 75.0, 100.0])
    np.testing.assert_allclose(state.viscosity, [0.1626, 0.0499, 0.0208, 0.0106], rtol=1e-14)
    np.testing.assert_allclose(state.pressure_viscosity, [18.0e-9, 13.9e-9, 11.4e-9, 9.7e-9], rtol=1e-14)
    np.testing.assert_allclose(state.density, [844.3, 829.3, 814.3, 799.3], rtol=1e-14)


def test_between_the_table_the_logarithm_of_the_viscosity_is_linear() -> None:
    state = lubricant("75w90").at(90.0)
    assert state.viscosity == pytest.approx(0.0208**0.4 * 0.0106**0.6, rel=1e-14)
    assert state.pressure_viscosity == pytest.approx(0.4 * 11.4e-9 + 0.6 * 9.7e-9, rel=1e-14)


@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_lubricant_says_where_it_is_from_and_is_an_oil(name: str) -> None:
    oil = lubricant(name)
    assert oil.title
    assert oil.source
    temperature = np.linspace(oil.temperature[0], oil.temperature[-1], 50)
    state = oil.at(temperature)
    assert np.all(np.diff(state.viscosity) < 0.0)
    assert np.all(np.diff(state.pressure_viscosity) < 0.0)
    assert np.all((state.viscosity > 5e-4) & (state.viscosity < 1.0))
    assert np.all((state.pressure_viscosity > 3e-9) & (state.pressure_viscosity < 3e-8))
    assert np.all((state.temperature_viscosity > 0.01) & (state.temperature_viscosity < 0.07))
    assert not np.any(state.clamped)


# Arana, Larranaga and Ulacia 2019, tables 2 and 3: mm2/s at 40 and 100 degC, kg/m3 at 15.6 degC, a1 in 1e7 Pa, a2 in
# 1e5 Pa/K; C in K, D in 1e2 K, K in 1e-6 Pa s of their own law for the viscosity, K exp(C/(D + T)).
GEAR_OILS = {
    "mineral-vg100": ((96.0, 10.6), 882.0, (-2.28, 2.26), (890.0, -1.82, 86.86)),
    "pao-vg100": ((94.1, 14.0), 840.0, (-5.73, 3.90), (1740.0, -1.16, 12.26)),
}


@pytest.mark.parametrize("name", GEAR_OILS)
def test_gear_oils_are_those_of_the_paper(name: str) -> None:
    """To the digits written; and by the paper's own law of viscosity, printed with two to three digits, to 10 %."""
    kinematic, density, (a1, a2), (c, d, k) = GEAR_OILS[name]
    temperature = np.array([40.0, 70.0, 100.0])
    kelvin = temperature + 273.15
    state = lubricant(name).at(temperature)
    np.testing.assert_allclose(1e6 * (state.viscosity / state.density)[[0, 2]], kinematic, rtol=1e-3)
    np.testing.assert_allclose(state.pressure_viscosity, 1.0 / (1e7 * a1 + 1e5 * a2 * kelvin), rtol=1e-3)
    thinner = 0.6278 / density * (temperature - 15.6)  # ASTM D1250, lubricating oils
    np.testing.assert_allclose(state.density, density * np.exp(-thinner * (1.0 + 0.8 * thinner)), rtol=1e-3)
    np.testing.assert_allclose(state.viscosity, 1e-6 * k * np.exp(c / (1e2 * d + kelvin)), rtol=0.1)


@pytest.mark.parametrize("name", ["75w90", *GEAR_OILS])
def test_walther_bends_less_than_the_table_is_wide(name: str) -> None:
    """Both ways meet at the table; between, the logarithm is convex, so that Walther's curve lies below the chord."""
    oil = lubricant(name)
    np.testing.assert_allclose(
        oil.at(oil.temperature, interpolation="walther").viscosity, oil.dynamic_viscosity, rtol=1e-12
    )
    middles = 0.5 * (oil.temperature[1:] + oil.temperature[:-1])
    ratio = oil.at(middles, interpolation="walther").viscosity / oil.at(middles).viscosity
    assert np.all(ratio < 1.0)
    assert np.all(ratio > 1.0 - 1.5e-4 * np.diff(oil.temperature) ** 2)


def test_walther_follows_its_own_law_where_the_table_has_none() -> None:
    """A fluid with log log (v + 0.7) linear in log T, tabulated at two points, is met exactly between."""
    kelvin = np.array([313.15, 333.0, 373.15])
    kinematic = 10.0 ** (10.0 ** (9.0 - 3.5 * np.log10(kelvin))) - 0.7
    oil = Lubricant(
        "x", "x", "x", kelvin[[0, 2]] - 273.15, 9e-4 * kinematic[[0, 2]], np.full(2, 2e-8), np.full(2, 900.0)
    )
    found = oil.at(kelvin[1] - 273.15, interpolation="walther").viscosity
    assert found == pytest.approx(9e-4 * kinematic[1], rel=1e-12)


def test_slope_of_the_viscosity_is_that_of_its_logarithm() -> None:
    """exp(-b T): b everywhere, clamped ends included."""
    temperature = np.array([20.0, 30.0, 60.0, 100.0])
    oil = Lubricant("x", "x", "x", temperature, np.exp(-0.04 * temperature), np.full(4, 2e-8))
    np.testing.assert_allclose(oil.at(np.linspace(20, 100, 33)).temperature_viscosity, 0.04, rtol=1e-12)


def test_beyond_the_table_is_an_error_or_a_flagged_clamp() -> None:
    oil = lubricant("75w90")
    with pytest.raises(InputError, match=r"temperature = 120: must be from 25 to 100 \[degC\]"):
        oil.at([50.0, 120.0])
    with pytest.raises(InputError, match="temperature = nan"):
        oil.at(np.nan)
    state = oil.at([10.0, 50.0, 120.0], out_of_range="clamp")
    assert state.clamped.tolist() == [True, False, True]
    np.testing.assert_allclose(state.viscosity, [0.1626, 0.0499, 0.0106])


def test_an_oil_without_density_says_so() -> None:
    oil = lubricant("heavy-mineral")
    assert np.isnan(oil.at(60.0).density)
    with pytest.raises(InputError, match="no density"):
        oil.at(50.0, interpolation="walther")


def test_options_that_do_not_exist() -> None:
    oil = lubricant("75w90")
    with pytest.raises(InputError, match="interpolation = 'spline'"):
        oil.at(50.0, interpolation="spline")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="out_of_range = 'guess'"):
        oil.at(50.0, out_of_range="guess")  # type: ignore[arg-type]


GOOD = """title = "t"
source = "s"
temperature = [20, 80]
dynamic_viscosity = [0.1, 0.01]
pressure_viscosity = [20, 12]
"""


def test_an_oil_of_ones_own(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(GOOD + "density = [900, 860]\nthermal_conductivity = 0.13\n", encoding="utf-8")
    oil = lubricant(path)
    assert oil.name == "mine"
    state = oil.at(50.0)
    assert state.pressure_viscosity == pytest.approx(16e-9)
    assert state.density == pytest.approx(880.0)
    assert state.thermal_conductivity == 0.13


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (GOOD + "densty = [1, 2]\n", "unknown key densty"),
        (GOOD.replace('source = "s"\n', ""), "no key source"),
        (GOOD.replace("[20, 80]", "[80, 20]"), "must increase"),
        (GOOD.replace("[0.1, 0.01]", "[0.1, -0.01]"), "dynamic_viscosity of lubricant bad = -0.01: must be"),
        (GOOD.replace("[0.1, 0.01]", "[0.1]"), "dynamic_viscosity of lubricant bad .*, 2 in a row"),
        (GOOD.replace("[0.1, 0.01]", '["a", "b"]'), "lists of numbers"),
        (GOOD.replace("[20, 80]", "20"), "temperature of lubricant bad .*, 2 or more in a row"),
        (GOOD + "thermal_conductivity = 0\n", "thermal_conductivity of lubricant bad = 0: must be"),
        (GOOD.replace("[0.1, 0.01]", "[0.01, 0.1]"), "dynamic_viscosity of lubricant bad = 0.01, 0.1: must fall as"),
        (GOOD.replace("[0.1, 0.01]", "[100, 10]"), "dynamic_viscosity of lubricant bad = 10: must be up to 1 .*mPa s"),
        (
            GOOD.replace("[20, 12]", "[20e-9, 12e-9]"),
            r"pressure_viscosity of lubricant bad = 2e-08: must be a number from 1 to 100 \[1/GPa\]",
        ),
        (GOOD.replace("[20, 80]", "[-500, 80]"), "temperature of lubricant bad = -500"),
        (GOOD.replace("[20, 80]", "[20, inf]"), "temperature of lubricant bad = inf"),
        (GOOD + "density = [0.9, 0.86]\n", "density of lubricant bad = 0.9"),
        ("title = ", "not a TOML file"),
    ],
)
def test_a_file_that_is_no_oil(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=message):
        lubricant(path)


def test_an_oil_that_does_not_exist() -> None:
    with pytest.raises(InputError, match="75w90"):
        lubricant("olive")
