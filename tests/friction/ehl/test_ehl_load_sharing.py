"""Asperities by their statistics: their load and gap, the limits of the mixed film, its rise of friction."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from easeoff import InputError
from easeoff.friction.ehl import (
    Asperities,
    Film,
    LubricatedContact,
    Oil,
    Status,
    film_dataset,
    mixed_film,
    smooth_film,
    traction,
)
from easeoff.friction.ehl.asperities import mean_power
from easeoff.friction.ehl.hierarchical_matrix import OFFSETS
from easeoff.friction.ehl.reynolds_equation import evaluate

OIL = Oil(0.0139, 10.4e-9, law="two_slope")
GEAR = LubricatedContact(0.7e9, 0.02, 2.2, OIL, slide_to_roll=0.45)
ROUGH = Asperities(0.5e-6, 20e-6)


def friction_of(film: Film) -> float:
    """Friction coefficient of a film and the asperities in it."""
    fluid = film.pressure - film.asperity_pressure
    return traction(film.contact, film.position, fluid, film.film, asperity_pressure=film.asperity_pressure).coefficient


def bell(s: float) -> float:
    return math.exp(-0.5 * s * s) / math.sqrt(2.0 * math.pi)


@pytest.mark.parametrize("level", [-8.0, -1.3, 0.0, 0.7, 3.0])
@pytest.mark.parametrize("power", [0.5, 1.5])
def test_mean_power_is_its_integral(power: float, level: float) -> None:
    expected, _ = quad(lambda s: (s - level) ** power * bell(s), level, max(level, 0.0) + 12.0, limit=400, epsrel=1e-10)
    assert float(mean_power(power, np.array([level]))[0]) == pytest.approx(expected, rel=1e-6)


def test_mean_gap_is_that_of_surfaces_cut_off_where_they_overlap() -> None:
    for t in (-4.0, -0.5, 0.0, 2.0):
        expected, _ = quad(lambda s, t=t: max(t + s, 0.0) * bell(s), -12.0, 12.0, points=[-t], epsabs=1e-14)
        gap, slope = ROUGH.mean_gap(np.array([t * ROUGH.composite_roughness]))
        assert gap[0] == pytest.approx(ROUGH.composite_roughness * expected, rel=1e-6)
        up, down = (ROUGH.mean_gap(np.array([(t + d) * ROUGH.composite_roughness]))[0][0] for d in (1e-5, -1e-5))
        assert slope[0] == pytest.approx((up - down) / (2e-5 * ROUGH.composite_roughness), rel=1e-5)


def test_asperity_pressure_is_the_sum_over_the_summits_of_a_generated_surface() -> None:
    """Summits of a random isotropic surface, each with its height and curvature, as Hertz contacts."""
    nodes, per_length = 768, 12
    rng = np.random.default_rng(2)
    k = 2.0 * np.pi * np.fft.fftfreq(nodes, 1.0 / per_length)
    noise = np.fft.fft2(rng.normal(size=(nodes, nodes)))
    z = np.fft.ifft2(noise * np.exp(-(k[:, None] ** 2 + k[None, :] ** 2) / 8.0)).real
    z /= z.std()  # in rms heights; distances in correlation lengths
    around = [
        np.roll(z, shift, (0, 1)) for shift in ((0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1))
    ]
    summit = np.all([z > other for other in around], axis=0)
    curvature = (4.0 * z - np.sum(around[:4], axis=0))[summit] * per_length**2 / 2.0
    area = (nodes / per_length) ** 2
    for level in (0.5, 1.0, 2.0):
        depth = np.maximum(z[summit] - level, 0.0)
        # 2/3 E' sqrt(radius) depth^1.5 each, in units of rms and correlation length.
        load = 2.0 / 3.0 * np.sum(depth**1.5 / np.sqrt(curvature)) / area
        expected = load * 2.27e11 * ROUGH.composite_roughness / ROUGH.correlation_length
        pressure, slope = ROUGH.pressure(np.array([level * ROUGH.composite_roughness]), 2.27e11)
        assert pressure[0] == pytest.approx(expected, rel=0.25)
        assert slope[0] < 0.0


def test_derivatives_of_the_balance_by_the_separation_are_those_of_finite_differences() -> None:
    film = mixed_film(GEAR, ROUGH, nodes=129)
    problem, point = film.problem, film.outcome.point
    rng = np.random.default_rng(1)
    pressure, approach = point.pressure * (1.0 + 0.01 * rng.random(129)), point.approach
    at = evaluate(problem, pressure, approach)
    h = 1e-7
    up, down = (evaluate(problem, pressure, approach + d) for d in (h, -h))
    total = np.zeros(129)  # the approach lifts all nodes alike
    for band, offset in zip(at.balance.by_film, OFFSETS, strict=True):
        total += np.where((np.arange(129) + offset >= 0) & (np.arange(129) + offset < 129), band, 0.0)
    scale = np.abs(total).max()
    np.testing.assert_allclose(total, (up.lack - down.lack) / (2.0 * h), atol=1e-5 * scale)
    np.testing.assert_allclose(at.fluid_by_film, (up.fluid - down.fluid) / (2.0 * h), rtol=1e-4, atol=1e-6)


def test_without_roughness_the_film_is_the_smooth_one() -> None:
    contact = replace(GEAR, rolling_velocity=20.0)
    smooth = smooth_film(contact, nodes=257)
    film = mixed_film(contact, Asperities(1e-3 * smooth.minimum_film, 20e-6), nodes=257)
    assert film.certified
    assert film.asperity_share == 0.0
    assert film.minimum_film == pytest.approx(smooth.minimum_film, rel=1e-6)


def test_without_speed_the_asperities_carry_everything() -> None:
    """The contact is the dry one: at each place the pressure is that of the asperities at their separation."""
    contact = replace(GEAR, rolling_velocity=1e-4)
    film = mixed_film(contact, ROUGH, nodes=257)
    assert film.certified
    assert film.asperity_share > 0.999
    separation = contact.film_scale * film.outcome.point.film
    np.testing.assert_allclose(film.pressure, ROUGH.pressure(separation, contact.contact_modulus)[0], atol=1e6)
    # Dry roughness spreads the load: less than Hertz in the middle, something beyond the edge.
    assert 0.8e9 * 0.7 < film.pressure.max() < 0.7e9
    assert film.pressure[np.abs(film.position) > 1.02 * contact.half_width].max() > 1e6
    assert friction_of(film) == pytest.approx(0.1, rel=2e-3)


def test_friction_and_asperity_share_fall_with_the_lambda_ratio() -> None:
    """Stribeck: from the boundary to the film, without a step."""
    shares, frictions, ratios = [], [], []
    for rms in (2e-6, 1e-6, 0.5e-6, 0.3e-6, 0.2e-6, 0.1e-6, 0.05e-6):
        film = mixed_film(GEAR, Asperities(rms, 20e-6), nodes=257)
        assert film.status is Status.CERTIFIED
        assert film.certificate.worst < 1e-8
        shares.append(film.asperity_share)
        frictions.append(friction_of(film))
        ratios.append(smooth_film(GEAR, nodes=257).minimum_film / rms)
    assert ratios[0] < 0.2
    assert ratios[-1] > 3.0
    assert (np.diff(shares) < 0.0).all()
    assert (np.diff(frictions) < 0.0).all()
    assert shares[0] > 0.9
    assert shares[-1] < 1e-4


def test_mixed_film_as_a_labelled_dataset() -> None:
    film = mixed_film(GEAR, ROUGH, nodes=129)
    data = film_dataset(film)
    assert data["asperity_pressure"].attrs["units"] == "MPa"
    share = float(data["asperity_pressure"].sum() / data["film_pressure"].sum())
    assert share == pytest.approx(float(data["asperity_share"]))
    assert 0.1 < share < 1.0


def test_mass_flow_and_grid() -> None:
    films = [mixed_film(GEAR, ROUGH, nodes=n) for n in (257, 513, 1025)]
    assert all(film.flow_variation < 1e-10 for film in films)
    assert films[0].asperity_share == pytest.approx(films[2].asperity_share, rel=0.01)
    assert films[1].central_film == pytest.approx(films[2].central_film, rel=0.002)


@pytest.mark.parametrize(
    ("rms", "length", "word"), [(0.0, 20e-6, "composite_roughness"), (1e-6, -1.0, "correlation"), (1e-5, 1e-5, "half")]
)
def test_bad_roughness_is_refused(rms: float, length: float, word: str) -> None:
    with pytest.raises(InputError, match=word):
        Asperities(rms, length)
