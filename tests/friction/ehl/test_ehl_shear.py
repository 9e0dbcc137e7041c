"""Shear of the film and friction coefficient: limits, ceilings, heat, and the heat of the inlet."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from easeoff import InputError
from easeoff.friction.ehl import LubricatedContact, Oil, heated_inlet, smooth_film, traction
from easeoff.friction.ehl.lubricated_contact import film_factor
from easeoff.friction.ehl.shear_traction import film_temperature

OIL = Oil(0.0499, 13.9e-9, temperature_viscosity=0.038, thermal_conductivity=0.14)
CONTACT = LubricatedContact(1e9, 0.02, 10.0, OIL, slide_to_roll=0.25, contact_modulus=2.273e11)
X = np.linspace(-1.0, 1.0, 401) * CONTACT.half_width
PRESSURE = 1e9 * np.sqrt(1.0 - (X / CONTACT.half_width) ** 2)
FILM = np.full_like(X, 1.3e-6)


def sliding(ratio: float, **changes: float | str | None) -> LubricatedContact:
    return replace(CONTACT, slide_to_roll=ratio, oil=replace(OIL, **changes))  # type: ignore[arg-type]


def test_newtonian_stress_is_viscosity_times_shear_rate() -> None:
    contact = sliding(0.01, eyring_stress=math.inf, pressure_viscosity=0.0)
    expected = 0.0499 * contact.sliding_velocity / 1.3e-6
    result = traction(contact, X, PRESSURE, FILM)
    np.testing.assert_allclose(result.stress[1:-1], expected, rtol=1e-12)
    assert result.coefficient == pytest.approx(expected * 2.0 * contact.half_width / contact.load, rel=0.01)


def test_eyring_stress_is_newtonian_when_slow_and_logarithmic_when_fast() -> None:
    slow, newtonian = (traction(sliding(1e-9, **law), X, PRESSURE, FILM) for law in ({}, {"eyring_stress": math.inf}))
    np.testing.assert_allclose(slow.stress, newtonian.stress, rtol=1e-4)
    fast, faster = (traction(sliding(ratio), X, PRESSURE, FILM).stress[200] for ratio in (0.1, 1.0))
    assert faster - fast == pytest.approx(5e6 * math.log(10.0), rel=1e-3)


def test_friction_has_the_sign_of_the_sliding_and_none_without() -> None:
    forth, back, none = (traction(sliding(ratio), X, PRESSURE, FILM, fluid_part=0.5) for ratio in (0.3, -0.3, 0.0))
    np.testing.assert_array_equal(forth.stress, -back.stress)
    assert forth.coefficient == back.coefficient > 0.0
    assert none.coefficient == 0.0
    assert np.abs(none.stress).max() == 0.0


def test_touching_asperities_have_the_boundary_coefficient() -> None:
    dry = traction(CONTACT, X, PRESSURE, FILM, fluid_part=0.0, boundary_friction=0.12)
    load = np.sum(PRESSURE) * (X[1] - X[0])
    assert dry.film == 0.0
    assert dry.asperities == pytest.approx(0.12 * load / CONTACT.load, rel=1e-12)
    half = traction(CONTACT, X, PRESSURE, FILM, fluid_part=0.5, boundary_friction=0.12)
    wet = traction(CONTACT, X, PRESSURE, FILM)
    assert half.coefficient == pytest.approx(0.5 * (dry.coefficient + wet.coefficient), rel=1e-12)


def test_ceiling_of_the_shear_stress() -> None:
    limited = traction(sliding(1.0, limiting_shear=0.01), X, PRESSURE, FILM)
    assert (limited.stress <= 0.01 * PRESSURE + 1e-9).all()
    assert limited.coefficient == pytest.approx(0.01, rel=0.01)


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        ("roelands", [0.0058, 0.0122, 0.0172, 0.0212, 0.0254]),
        ("two_slope", [0.0157, 0.0232, 0.0284, 0.0326, 0.0370]),
    ],
)
def test_friction_of_a_smooth_film_is_that_of_a_separate_program(law: str, expected: list[float]) -> None:
    """One that is no part of this repository.

    1 GPa, 20 mm, 10 m/s, 50 deg C, Eyring stress 5 MPa; film without shear thinning.
    """
    film = smooth_film(sliding(0.0, law="roelands", eyring_stress=math.inf), nodes=513)
    for ratio, friction in zip([0.025, 0.1, 0.25, 0.5, 1.0], expected, strict=True):
        contact = sliding(ratio, law=law)
        result = traction(contact, film.position, film.pressure, film.film)
        assert result.coefficient == pytest.approx(friction, rel=0.03)


def test_temperature_of_a_uniform_band_is_that_of_jaeger() -> None:
    """At its end 2 q sqrt(l / (pi u)) / b over both bodies, and q h / (12 k) within the film."""
    stress = np.full_like(X, 2e7)
    contact = sliding(2.0)  # one surface stands still and takes no heat away
    length = 2.0 * contact.half_width
    heat = 2e7 * contact.sliding_velocity
    passing = 12890.0 * math.sqrt(2.0 * contact.rolling_velocity)
    expected = 2.0 * heat * math.sqrt(length / math.pi) / passing + heat * 1.3e-6 / (12.0 * 0.14)
    assert film_temperature(contact, X, stress, FILM, 0.14, 12890.0)[-1] == pytest.approx(expected, rel=2e-3)


def test_heat_lowers_friction_more_the_more_slides() -> None:
    ratios = []
    for slide in (0.01, 0.1, 1.0):
        cold, warm = (traction(sliding(slide), X, PRESSURE, FILM, thermal=thermal) for thermal in (False, True))
        assert warm.temperature_rise.max() > 0.0
        ratios.append(warm.coefficient / cold.coefficient)
    assert 1.0 > ratios[0] > ratios[1] > ratios[2] > 0.2
    settled = traction(sliding(1.0), X, PRESSURE, FILM, thermal=True)
    own = film_temperature(sliding(1.0), X, settled.stress, FILM, OIL.thermal_conductivity_at(PRESSURE), 12890.0)
    np.testing.assert_allclose(settled.temperature_rise, own, rtol=1e-4, atol=1e-6)


def test_heated_oil_thins_by_roelands_law_of_the_temperature() -> None:
    """From viscosity and slope at 50 deg C to the viscosities of 75W90 printed for 25, 75 and 100 deg C."""
    oil = replace(OIL, temperature_viscosity=math.log(0.1626 / 0.0208) / 50.0, inlet_temperature=50.0)
    fall, slope = oil.thermal_thinning(np.array([-25.0, 0.0, 25.0, 50.0]))
    np.testing.assert_allclose(oil.viscosity * np.exp(-fall), [0.1626, 0.0499, 0.0208, 0.0106], rtol=0.06)
    assert slope[1] == pytest.approx(oil.temperature_viscosity, rel=1e-12)
    up, down = (oil.thermal_thinning(np.array([40.0 + d]))[0][0] for d in (1e-4, -1e-4))
    assert oil.thermal_thinning(np.array([40.0]))[1][0] == pytest.approx((up - down) / 2e-4, rel=1e-6)
    straight, _ = OIL.thermal_thinning(np.array([100.0]))
    assert straight[0] == pytest.approx(3.8)
    with pytest.raises(InputError, match="inlet_temperature"):
        replace(OIL, inlet_temperature=-200.0)


def test_conductivity_doubles_at_a_gigapascal() -> None:
    np.testing.assert_allclose(OIL.thermal_conductivity_at(np.array([0.0, 1e9])), [0.14, 0.14 * (1.0 + 1.54 / 1.33)])


def test_hottest_films_settle() -> None:
    """A thick, fast, cold film, where each kelvin lowers the heat."""
    oil = Oil(
        0.1626, 18e-9, law="two_slope", temperature_viscosity=0.047, thermal_conductivity=0.14, inlet_temperature=25.0
    )
    contact = LubricatedContact(2.5e9, 0.04, 20.0, oil, slide_to_roll=1.0)
    x = np.linspace(-1.0, 1.0, 201) * contact.half_width
    pressure = 2.5e9 * np.sqrt(1.0 - (x / contact.half_width) ** 2)
    film = np.full_like(x, 8e-6)
    result = traction(contact, x, pressure, film, thermal=True)
    assert result.temperature_rise.max() > 1000.0  # far beyond what an oil stands: the numerics must
    own = film_temperature(contact, x, result.stress, film, oil.thermal_conductivity_at(pressure), 12890.0)
    np.testing.assert_allclose(result.temperature_rise, own, rtol=1e-4, atol=1e-3)


def test_thermal_correction_asks_for_its_numbers() -> None:
    with pytest.raises(InputError, match="temperature_viscosity"):
        traction(sliding(0.1, thermal_conductivity=None), X, PRESSURE, FILM, thermal=True)


# Heat of the inlet


INLET_OIL = Oil(0.0499, 13.9e-9, temperature_viscosity=0.04, thermal_conductivity=0.14)
FAST = LubricatedContact(1.0e9, 0.02, 10.0, INLET_OIL, slide_to_roll=0.25)


def test_factors_are_those_of_their_formulas() -> None:
    """Thermal parameter 0.04 * 0.0499 * 100 / 0.14 = 1.4257; by hand."""
    assert film_factor(FAST, "murch_wilson") == pytest.approx(3.94 / (3.94 + 1.4257**0.62), rel=1e-4)
    over = 1.0 - 13.2 * (1.0 / 227.0) * 1.4257**0.42
    assert film_factor(FAST) == pytest.approx(over / (1.0 + 0.213 * (1.0 + 2.23 * 0.25**0.83) * 1.4257**0.64), rel=1e-4)


@pytest.mark.parametrize("name", ["gupta_cheng", "murch_wilson"])
def test_heat_thins_the_film_by_its_factor_and_not_the_shear(name: str) -> None:
    contact = replace(FAST, oil=replace(INLET_OIL, eyring_stress=float("inf")))
    warm, cold = smooth_film(heated_inlet(contact, name), nodes=257), smooth_film(contact, nodes=257)
    factor = film_factor(contact, name)
    assert factor < 0.85
    assert warm.certified
    assert warm.minimum_film / cold.minimum_film == pytest.approx(factor, rel=0.03)
    same = [traction(c, cold.position, cold.pressure, cold.film).coefficient for c in (contact, warm.contact)]
    assert same[0] == same[1]


def test_slow_inlet_is_not_heated() -> None:
    assert film_factor(replace(FAST, rolling_velocity=1e-3)) == pytest.approx(1.0, abs=1e-2)


def test_what_the_formula_cannot_do_is_refused() -> None:
    with pytest.raises(InputError, match="murch_wilson"):
        film_factor(FAST, "none")
    with pytest.raises(InputError, match="conductivity"):
        film_factor(replace(FAST, oil=replace(INLET_OIL, thermal_conductivity=None)))
    with pytest.raises(InputError, match="beyond"):
        film_factor(replace(FAST, hertz_pressure=4e9, rolling_velocity=1000.0))
