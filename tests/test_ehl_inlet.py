"""Heat of the inlet."""

from __future__ import annotations

from dataclasses import replace

import pytest

from easeoff import InputError
from easeoff.friction.ehl import LubricatedContact, Oil, film_factor, heated_inlet, smooth_film, traction

OIL = Oil(0.0499, 13.9e-9, temperature_viscosity=0.04, thermal_conductivity=0.14)
FAST = LubricatedContact(1.0e9, 0.02, 10.0, OIL, slide_to_roll=0.25)


def test_factors_are_those_of_their_formulas() -> None:
    """Thermal parameter 0.04 * 0.0499 * 100 / 0.14 = 1.4257; by hand."""
    assert film_factor(FAST, "murch_wilson") == pytest.approx(3.94 / (3.94 + 1.4257**0.62), rel=1e-4)
    over = 1.0 - 13.2 * (1.0 / 227.0) * 1.4257**0.42
    assert film_factor(FAST) == pytest.approx(over / (1.0 + 0.213 * (1.0 + 2.23 * 0.25**0.83) * 1.4257**0.64), rel=1e-4)


@pytest.mark.parametrize("name", ["gupta_cheng", "murch_wilson"])
def test_heat_thins_the_film_by_its_factor_and_not_the_shear(name: str) -> None:
    contact = replace(FAST, oil=replace(OIL, eyring_stress=float("inf")))
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
        film_factor(replace(FAST, oil=replace(OIL, thermal_conductivity=None)))
    with pytest.raises(InputError, match="beyond"):
        film_factor(replace(FAST, hertz_pressure=4e9, rolling_velocity=1000.0))
