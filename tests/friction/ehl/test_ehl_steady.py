"""Smooth films in a steady state: limits in closed form, published formulas, convergence, conservation."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from ehl_contacts import MODULUS, NEWTONIAN, by_moes, contact
from ehl_penalty import films
from scipy.integrate import cumulative_simpson
from scipy.optimize import brentq
from scipy.stats import qmc

from easeoff import InputError
from easeoff.friction import lubricant
from easeoff.friction.ehl import Film, LubricatedContact, Oil, State, Status, smooth_film
from easeoff.friction.ehl.film import RESOLUTION_LIMIT
from easeoff.friction.ehl.hierarchical_matrix import OFFSETS
from easeoff.friction.ehl.reynolds_equation import History, balance, certify, evaluate


def by_groups(load: float, speed: float, material: float, *, viscosity: float = 0.04) -> LubricatedContact:
    """A contact with given groups W, U and G; the law of its oil also depends on the ambient viscosity [Pa s]."""
    pressure = MODULUS * math.sqrt(load / (2.0 * math.pi))
    return contact(pressure, 0.02, speed * MODULUS * 0.02 / viscosity, viscosity, material / MODULUS)


def viscosity_for(exponent: float, material: float) -> float:
    """Ambient viscosity [Pa s] with which Roelands' law has this exponent of the pressure; 1 is exponential."""
    return math.exp(material / MODULUS * 1.98e8 / exponent - 9.67)


def pan_hamrock(c: LubricatedContact) -> float:
    """Smallest film thickness of a line contact [m] (Pan and Hamrock, Journal of Tribology 111 (1989) 246)."""
    return float(
        1.714 * c.equivalent_radius * c.speed_parameter**0.694 * c.material_parameter**0.568 * c.load_parameter**-0.128
    )


#: Pressure, radius, velocity, viscosity, pressure-viscosity coefficient: W 2e-5 to 5e-4, U 1e-12 to 2e-10, G to 5000.
WITHIN_THREE_PERCENT = [
    (0.5e9, 0.02, 2.0, 0.0499, 13.9e-9),
    (0.7e9, 0.02, 5.0, 0.0208, 11.4e-9),
    (1.0e9, 0.02, 5.0, 0.0499, 13.9e-9),
    (1.0e9, 0.04, 2.0, 0.0139, 10.4e-9),
    (0.5e9, 0.04, 20.0, 0.0106, 9.7e-9),
    (1.5e9, 0.005, 20.0, 0.0106, 9.7e-9),
    (1.5e9, 0.04, 1.0, 0.0106, 9.7e-9),
    (2.0e9, 0.04, 1.0, 0.1626, 18.0e-9),
    (0.41e9, 0.01, 0.055, 0.04109, 22.1e-9),
    (2.0e9, 0.01, 0.055, 0.04109, 22.1e-9),
]


@pytest.mark.parametrize("numbers", WITHIN_THREE_PERCENT)
def test_minimum_film_is_that_of_pan_and_hamrock(numbers: tuple[float, float, float, float, float]) -> None:
    film = smooth_film(contact(*numbers), nodes=513)
    assert film.certified
    assert film.minimum_film == pytest.approx(pan_hamrock(film.contact), rel=0.03)


def test_minimum_film_is_that_of_pan_and_hamrock_over_a_range() -> None:
    """U 1e-12 to 1e-10, W 2e-5 to 5e-4, G 2200 to 5060, evenly, where L is from 4 to 8.

    For the scatter of the formula all around see docs/how_it_works/notes/mixed_lubrication.md.
    """
    ratios = []
    for a, b, c in qmc.Sobol(3, seed=3).random(32):
        speed, load, material = 1e-12 * 100.0**a, 2e-5 * 25.0**b, 2200.0 * 2.3**c
        if 4.0 < material * (2.0 * speed) ** 0.25 < 8.0:
            film = smooth_film(by_groups(load, speed, material), nodes=513)
            assert film.certified
            assert film.flow_variation < 1e-10
            ratios.append(film.minimum_film / pan_hamrock(film.contact))
    error = np.abs(np.array(ratios) - 1.0)
    assert error.size > 12
    assert (error < 0.03).mean() > 0.95
    assert error.max() < 0.035


@pytest.mark.parametrize(
    ("exponent", "factor", "powers"),
    [(0.45, 1.714, (-0.128, 0.694, 0.568)), (1.0, 2.65, (-0.13, 0.70, 0.54))],
    ids=["Pan and Hamrock", "Dowson and Higginson"],
)
@pytest.mark.quick(1)
def test_smallest_film_depends_on_load_speed_and_material_as_published(
    exponent: float, factor: float, powers: tuple[float, float, float]
) -> None:
    """The same ranges. The law of the oil decides which formula it is; 0.45 is chosen, not known to be Pan's."""
    groups = np.array([2e-5, 1e-12, 2200.0]) * np.array([25.0, 100.0, 2.3]) ** qmc.Sobol(3, seed=3).random(32)
    heights = []
    for load, speed, material in groups:
        film = smooth_film(by_groups(load, speed, material, viscosity=viscosity_for(exponent, material)), nodes=385)
        assert film.certified
        heights.append(film.minimum_film / film.contact.equivalent_radius)
    fit = np.linalg.lstsq(np.column_stack([np.ones(32), np.log(groups)]), np.log(heights))[0]
    np.testing.assert_allclose(fit[1:], powers, atol=0.02)
    excess = np.log(heights) - math.log(factor) - np.log(groups) @ powers
    assert abs(excess.mean()) < 0.02


def test_oil_of_exponent_one_is_exponential_and_makes_thicker_films() -> None:
    """At equal W, U and G, which so cannot be all a formula needs."""
    load, speed, material = 1.3e-4, 1e-11, 5007.0
    one = by_groups(load, speed, material, viscosity=viscosity_for(1.0, material))
    weak = by_groups(load, speed, material, viscosity=viscosity_for(0.45, material))
    slope = one.oil.pressure_viscosity
    straight = replace(one, oil=replace(one.oil, law="two_slope", high_pressure_viscosity=slope))
    film, same, thinner = (smooth_film(c, nodes=513) for c in (one, straight, weak))
    assert film.certified
    assert film.minimum_film == pytest.approx(same.minimum_film, rel=1e-9)
    assert film.minimum_film > 1.05 * thinner.minimum_film


@pytest.mark.parametrize(
    ("load", "speed", "material"), [(1.3e-4, 1e-11, 5007.0), (2e-5, 1e-11, 5007.0), (1.3e-4, 1e-11, 10010.0)]
)
@pytest.mark.quick(1)
def test_film_is_that_of_a_second_solver(load: float, speed: float, material: float) -> None:
    """Also where the formula of Pan and Hamrock gives 15 % less: the last."""
    film = smooth_film(by_groups(load, speed, material), nodes=1025)
    smallest, central = films(load, speed, material, MODULUS, film.contact.oil.viscosity)
    assert film.minimum_film / film.contact.equivalent_radius == pytest.approx(smallest, rel=0.01)
    assert film.central_film / film.contact.equivalent_radius == pytest.approx(central, rel=0.01)


@pytest.mark.parametrize(("load", "viscous"), [(10, 5), (30, 5), (10, 10), (30, 10), (10, 15), (30, 15), (10, 20)])
def test_central_film_of_an_incompressible_oil_is_that_of_moes(load: float, viscous: float) -> None:
    """Also where the formula of Pan and Hamrock, a power law, is up to 14 % too low: L = 20."""
    film = smooth_film(by_moes(load, viscous), nodes=513)
    assert film.certified
    assert film.central_film == pytest.approx(film.contact.central_film_estimate(), rel=0.03)


@pytest.mark.parametrize("numbers", WITHIN_THREE_PERCENT[:4])
def test_halving_the_grid_changes_the_film_by_less_than_a_percent(
    numbers: tuple[float, float, float, float, float],
) -> None:
    coarse, fine = (smooth_film(contact(*numbers), nodes=n) for n in (513, 1025))
    assert coarse.minimum_film == pytest.approx(fine.minimum_film, rel=0.01)
    assert coarse.central_film == pytest.approx(fine.central_film, rel=0.01)


def test_central_film_converges_to_second_order() -> None:
    films = [smooth_film(contact(*WITHIN_THREE_PERCENT[1]), nodes=n).central_film for n in (257, 513, 1025, 2049)]
    order = np.log2(np.abs(np.diff(films))[:-1] / np.abs(np.diff(films))[1:])
    assert (order > 1.6).all()


@pytest.mark.parametrize("numbers", WITHIN_THREE_PERCENT)
def test_mass_flow_is_the_same_everywhere_in_the_film(numbers: tuple[float, float, float, float, float]) -> None:
    film = smooth_film(contact(*numbers, slide=0.5, eyring=5e6), nodes=385)
    assert film.certified
    assert film.flow_variation < 1e-10


def test_certificate_is_made_of_the_conditions_and_notices_a_change() -> None:
    film = smooth_film(contact(*WITHIN_THREE_PERCENT[1]), nodes=257)
    point = film.outcome.point
    assert film.status is Status.CERTIFIED
    assert film.certificate.worst < 1e-11
    assert np.trapezoid(film.pressure, film.position) == pytest.approx(film.contact.load, rel=1e-10)
    assert film.pressure.min() >= -1e-12 * film.pressure.max()
    assert certify(film.problem, 1.001 * point.pressure, point.approach).load == pytest.approx(1e-3, rel=1e-6)
    thinner = certify(film.problem, point.pressure, point.approach - 0.01)
    assert not thinner.passes()
    assert thinner.negative_lack > 1e-3
    assert certify(film.problem, point.pressure, math.nan).worst == math.inf


def reynolds_load(minimum: float, contact: LubricatedContact) -> float:
    """Load of an isoviscous film between rigid cylinders, with Reynolds' condition at its end (Martin; Kapitza).

    With x = sqrt(2 R h0) tan(t) the pressure is 12 eta u sqrt(2 R) / h0^1.5 times an integral over t in closed form.
    """

    def pressure_like(t: Any, end: float) -> Any:
        # Integral of cos^2 - cos^4 / cos^2(end) from -pi/2 to t.
        square = t / 2 + np.sin(2 * t) / 4 + np.pi / 4
        fourth = 3 * t / 8 + np.sin(2 * t) / 4 + np.sin(4 * t) / 32 + 3 * np.pi / 16
        return square - fourth / np.cos(end) ** 2

    end = brentq(lambda t: float(pressure_like(t, t)), 0.1, 1.0)
    t = np.linspace(-np.pi / 2 + 1e-4, end, 20001)
    integral = cumulative_simpson(pressure_like(t, end) / np.cos(t) ** 2, x=t)[-1]
    viscosity, velocity = contact.oil.viscosity, contact.rolling_velocity
    return float(24.0 * viscosity * velocity * contact.equivalent_radius / minimum * integral)


def test_isoviscous_film_between_hardly_deformed_cylinders_is_martins() -> None:
    """h / R = 4.9 U / W; a domain that ends at 600 times the film costs some 0.5 %, the deformation M^2 per cent."""
    film = smooth_film(by_moes(0.05, 0.0), nodes=1025, flooded=1200.0)
    assert film.certified
    assert reynolds_load(film.minimum_film, film.contact) == pytest.approx(film.contact.load, rel=0.01)
    rigid = 4.896 * film.contact.equivalent_radius * film.contact.speed_parameter / film.contact.load_parameter
    assert film.minimum_film == pytest.approx(rigid, rel=0.01)


def test_slow_and_heavily_loaded_contact_is_that_of_hertz() -> None:
    """The thinner the film, the nearer the dry pressure."""
    errors = []
    for velocity in (1.0, 0.1, 0.01):
        film = smooth_film(contact(1.5e9, 0.02, velocity, 0.0106, 9.7e-9), nodes=1025)
        assert film.certified
        x = film.position / film.contact.half_width
        hertz = film.contact.hertz_pressure * np.sqrt(np.maximum(1.0 - x**2, 0.0))
        errors.append(float(np.abs(film.pressure - hertz)[np.abs(x) < 0.95].max() / hertz.max()))
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 2e-3


@pytest.mark.parametrize("span", [None, (-1.0001, 1.0001)])
def test_no_negative_film_is_certified(span: tuple[float, float] | None) -> None:
    """Slow and coarse, or cut off within the dry contact: the equations of the grid hold, for surfaces that overlap."""
    slow = LubricatedContact(2e9, 0.02, 1e-3, Oil(0.0208, 11.4e-9), slide_to_roll=0.25)
    fast = LubricatedContact(1e9, 0.02, 5.0, Oil(0.02, 1.1e-8), slide_to_roll=0.25)
    film = smooth_film(slow, nodes=513) if span is None else smooth_film(fast, nodes=129, span=span)
    assert film.film.min() < 0.0
    assert film.certificate.negative_film > 1.0
    assert film.status == Status.NOT_CERTIFIED


@pytest.mark.thorough
def test_grid_is_refined_until_it_resolves_the_film() -> None:
    """Below a resolution of one a film may be far off although every equation of its grid holds."""
    for velocity, nodes in ((1.0, 513), (3e-3, 1025), (1e-3, 4097)):
        contact = LubricatedContact(2e9, 0.02, velocity, Oil(0.0208, 11.4e-9), slide_to_roll=0.25)
        film = smooth_film(contact)
        assert film.certified
        assert film.position.size >= nodes
        assert film.resolution >= RESOLUTION_LIMIT
        fine = smooth_film(contact, nodes=4 * film.position.size - 3)
        assert film.minimum_film == pytest.approx(fine.minimum_film, rel=0.04)
        assert fine.resolution == pytest.approx(8.0 * film.resolution, rel=0.05)


def test_published_shape_of_the_film() -> None:
    """Parallel film, constriction of 10 to 25 % before the exit, pressure spike there, end just behind the contact."""
    film = smooth_film(contact(*WITHIN_THREE_PERCENT[2]), nodes=1025)
    x = film.position / film.contact.half_width
    assert 1.10 < film.central_film / film.minimum_film < 1.25
    assert 0.8 < x[np.argmin(np.where(np.abs(x) < 1.5, film.film, np.inf))] < 1.0
    assert 1.0 < x[film.within_film.stop] < 1.25
    rising = np.diff(film.pressure[(x > 0.5) & (x < 1.0)])
    assert (rising > 0).any()


def smallest(**changes: float | str | bool | None) -> Film:
    base = contact(1.0e9, 0.02, 5.0, 0.0499, 13.9e-9, slide=0.5, eyring=5e6)
    return smooth_film(replace(base, oil=replace(base.oil, **changes)), nodes=257)  # type: ignore[arg-type]


def test_shear_thinning_and_viscosity_laws_change_the_film_in_the_known_sense() -> None:
    newtonian, thinning, thinner = smallest(eyring_stress=NEWTONIAN), smallest(), smallest(eyring_stress=2e6)
    assert newtonian.minimum_film > thinning.minimum_film > thinner.minimum_film > 0.5 * newtonian.minimum_film
    # The film is made in the inlet, at low pressure, where both laws have the same slope.
    two_slope = smallest(eyring_stress=NEWTONIAN, law="two_slope")
    assert two_slope.certified
    assert two_slope.minimum_film == pytest.approx(newtonian.minimum_film, rel=0.12)


def test_derivatives_of_the_mass_balance_are_those_of_finite_differences() -> None:
    film = smooth_film(contact(1.0e9, 0.02, 5.0, 0.0499, 13.9e-9, slide=0.5, eyring=5e6), nodes=129)
    problem, point = film.problem, film.outcome.point
    n, spacing = problem.deflection.nodes, problem.deflection.spacing
    rng = np.random.default_rng(3)
    pressure = point.pressure + 0.01 * rng.random(n)
    thickness = np.maximum(point.film, 0.02) + 0.01 * rng.random(n)
    kinds = [(None, -math.inf), (History(thickness, 1.0), -math.inf), (History(thickness, 1.5), 0.1)]
    assert ((thickness > 0.1) & (thickness < 0.2)).sum() > 10  # lubricant and asperities share the pressure there
    for history, touching in kinds:
        keywords: dict[str, Any] = {"history": history, "touching_film": touching}
        at = balance(film.contact, spacing, pressure, thickness, **keywords)
        for bands, which in ((at.by_pressure, 0), (at.by_film, 1)):
            for j in range(1, n - 1, 7):
                step = 1e-6
                moved = [pressure.copy(), thickness.copy()]
                moved[which][j] += step
                up = balance(film.contact, spacing, *moved, **keywords).residual
                moved[which][j] -= 2.0 * step
                down = balance(film.contact, spacing, *moved, **keywords).residual
                column = np.zeros(n)
                for k, offset in enumerate(OFFSETS):
                    if 0 <= j - offset < n:
                        column[j - offset] = bands[k, j - offset]
                np.testing.assert_allclose(column, (up - down) / (2.0 * step), atol=3e-6 * np.abs(bands).max())


def test_newton_steps_do_not_grow_with_the_grid() -> None:
    numbers = WITHIN_THREE_PERCENT[2]
    assert all(smooth_film(contact(*numbers), nodes=n).iterations <= 8 for n in (129, 513, 2049))


def test_conditions_of_the_whole_study_are_certified() -> None:
    """Corners and middles of the dissertation's ranges of pressure, radius, speed and oil, Newtonian and Eyring."""
    oils = [(0.1626, 18.0e-9), (0.0208, 11.4e-9), (0.0106, 9.7e-9)]
    for pressure in (0.5e9, 1.5e9, 2.5e9):
        for radius in (0.005, 0.04):
            for velocity in (1.0, 20.0):
                for viscosity, coefficient in oils:
                    film = smooth_film(
                        contact(pressure, radius, velocity, viscosity, coefficient, slide=1.0, eyring=5e6), nodes=193
                    )
                    assert film.certified, film.contact
                    assert film.flow_variation < 1e-8


def test_states_of_a_smooth_film() -> None:
    film = smooth_film(contact(*WITHIN_THREE_PERCENT[0]), nodes=129)
    assert set(film.state.tolist()) == {State.FILM, State.RUPTURED}
    point = evaluate(film.problem, film.outcome.point.pressure, film.outcome.point.approach)
    ruptured = film.state == State.RUPTURED
    assert (point.lack[ruptured][1:-1] > 0.0).all()
    assert np.abs(film.pressure[ruptured]).max() < 1e-6  # Pa


def test_viscosity_laws_and_their_slopes() -> None:
    pressure = np.array([0.0, 5e7, 7e7, 2e8, 1.3e9, 1.4e9, 2e9])
    for law in ("roelands", "two_slope"):
        oil = Oil(0.0208, 11.4e-9, law=law)
        value, slope = oil.log_viscosity(pressure)
        up, down = oil.log_viscosity(pressure + 1e3)[0], oil.log_viscosity(np.maximum(pressure - 1e3, 0.0))[0]
        np.testing.assert_allclose(slope[1:], (up - down)[1:] / 2e3, rtol=1e-4)
        assert value[0] == 0.0
        assert slope[0] == pytest.approx(11.4e-9)
    high, slope = Oil(0.0208, 11.4e-9, law="two_slope", high_pressure_viscosity=5e-9).log_viscosity(np.array([2e9]))
    assert high[0] == pytest.approx(11.4e-9 * 380e6 + 5e-9 * (2e9 - 380e6))
    assert slope[0] == pytest.approx(5e-9)
    density, rise = Oil(0.02, 1e-8).relative_density(np.array([0.0, 1e9]))
    np.testing.assert_allclose(density, [1.0, 1.0 + 0.583 / 2.683], rtol=1e-3)
    assert rise[0] == pytest.approx(0.583e-9)


@pytest.mark.parametrize(
    ("make", "word"),
    [
        (lambda: Oil(0.0, 1e-8), "viscosity"),
        (lambda: Oil(0.02, -1e-8), "pressure_viscosity"),
        (lambda: Oil(2e-5, 1e-8), "Roelands"),
        (lambda: Oil(0.02, 1e-8, law="barus"), "law"),  # type: ignore[arg-type]
        (lambda: Oil(0.02, 1e-8, limiting_shear=math.nan), "limiting_shear"),
        (lambda: contact(1.0, 0.02, math.nan, 0.02, 1e-8), "rolling_velocity"),
        (lambda: contact(1e9, 0.02, 1.0, 0.02, 1e-8, slide=2.1), "slide_to_roll"),
        (lambda: contact(1e12, 0.02, 1.0, 0.02, 1e-8), "pascals"),
        (lambda: smooth_film(contact(1e9, 0.02, 1.0, 0.02, 1e-8), nodes=10), "nodes"),
        (lambda: smooth_film(contact(1e9, 0.02, 1.0, 0.02, 1e-8), span=(-0.5, 1.5)), "span"),
    ],
)
def test_bad_input_is_refused_by_name(make: object, word: str) -> None:
    with pytest.raises(InputError, match=word):
        make()  # type: ignore[operator]


def test_oil_from_the_numbers_of_a_lubricant() -> None:
    oil = Oil.of(lubricant("75w90").at(75.0), eyring_stress=4e6)
    assert (oil.viscosity, oil.pressure_viscosity) == pytest.approx((0.0208, 11.4e-9), rel=1e-12)
    assert oil.eyring_stress == 4e6
    around = [float(lubricant("75w90").at(temperature).viscosity) for temperature in (74.9, 75.1)]
    assert oil.temperature_viscosity == pytest.approx(math.log(around[0] / around[1]) / 0.2, rel=1e-3)
