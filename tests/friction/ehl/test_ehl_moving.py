"""Surfaces that move through the contact: steady limits, conservation, mixed lubrication, waves and asperities."""

from __future__ import annotations

import importlib
import math

import numpy as np
import pytest
from ehl_contacts import by_moes

from easeoff import InputError
from easeoff.friction.ehl import (
    LubricatedContact,
    Oil,
    State,
    Status,
    asperity,
    film_dataset,
    generated_profile,
    measured_profile,
    passage_dataset,
    rough_passage,
    smooth_film,
    wave,
)
from easeoff.friction.ehl.film import domain, touching_start
from easeoff.friction.ehl.passage import ROUGH_INLET_GAP_RATIO, TOUCHING_FILM, _March
from easeoff.friction.ehl.reynolds_equation import ROUGH

OIL = Oil(0.0139, 10.4e-9)
GEAR = LubricatedContact(0.7e9, 0.01, 2.2, OIL, slide_to_roll=0.45)
SPAN = (-2.5, 1.5)


@pytest.mark.parametrize("order", [1, 2])
def test_smooth_surfaces_stay_as_they_are(order: int) -> None:
    """To second order the steady film solves the equations of a step but for one node; to first, it moves a little."""
    start = smooth_film(GEAR, nodes=193, span=SPAN)
    passage = rough_passage(GEAR, steps=12, nodes=193, span=SPAN, ramp=0, settle=0, order=order, keep=12)
    assert (passage.status == Status.CERTIFIED).all()
    within = np.abs(start.position) < GEAR.half_width
    np.testing.assert_allclose(passage.film[0][within], start.film[within], rtol=1e-5 if order == 2 else 0.05)
    assert passage.average("asperity_share") == 0.0


def test_touching_and_rupture_neither_make_nor_lose_lubricant() -> None:
    """Change of what the domain holds = what flows in - what flows out, with what the broken film lacks."""
    contact = LubricatedContact(0.7e9, 0.01, 0.02, OIL, slide_to_roll=0.45)
    first, second = (generated_profile(0.4e-6, 20e-6, 3e-3, seed) for seed in (1, 2))
    start = smooth_film(contact, nodes=193, span=SPAN)
    march = _March(contact, start.position / contact.half_width, start, 4e-9 / contact.film_scale, 1)
    mass = march._mass
    seen: set[int] = set()
    for step in range(1, 50):
        held = (march.mass - march.lack)[1:-1].sum()
        lack, carried = march.lack.copy(), march.mass.copy()
        outcome, _ = march.advance(min(1.0, step / 20), first, second)
        assert outcome.converged
        point = outcome.point
        flow_in = carried[0] - lack[0] + point.balance.flow[0] - mass(point)[0]
        flow_out = carried[-2] - lack[-2] + point.balance.flow[-1] - mass(point)[-2]
        gained = (march.mass - march.lack)[1:-1].sum() - held
        assert gained == pytest.approx(flow_in - flow_out, abs=1e-9 * abs(point.balance.flow).sum())
        inner = slice(1, -1)
        members = np.stack([point.lack, point.pressure, point.gap])[:, inner]
        assert members.min() > -1e-9
        assert members.min(axis=0).max() < 1e-9
        seen |= set(outcome.state.tolist())
    assert seen == {State.FILM, State.RUPTURED, State.TOUCHING}


@pytest.mark.thorough
def test_asperities_take_the_load_as_the_film_becomes_thin() -> None:
    """From none of it to nearly all; and the friction coefficient goes to that of the boundary."""
    profiles = [generated_profile(0.4e-6, 20e-6, 3e-3, seed) for seed in (1, 2)]
    shares, frictions = [], []
    for velocity in (50.0, 1e-2, 1e-6):
        contact = LubricatedContact(0.7e9, 0.01, velocity, OIL, slide_to_roll=0.45)
        passage = rough_passage(contact, *profiles, steps=50, nodes=97, span=(-2.0, 1.4), settle=30)
        assert passage.certified_share >= 0.8
        shares.append(passage.average("asperity_share"))
        frictions.append(passage.friction_coefficient)
    assert shares[0] == 0.0
    assert shares[0] < shares[1] < shares[2]
    assert shares[2] > 0.95
    assert frictions[2] == pytest.approx(0.1, abs=0.006)


def test_only_failed_steps_make_or_lose_lubricant() -> None:
    """Slow ridges on a coarse grid: some steps fail, and what follows is certified for the lubricant that is left."""
    profiles = [generated_profile(0.3e-6, 30e-6, 5e-3, seed) for seed in (1, 2)]
    oil = Oil(0.0208, 11.4e-9)
    slow, fast = (
        rough_passage(
            LubricatedContact(1e9, 0.02, u, oil, slide_to_roll=0.25), *profiles, steps=34, nodes=97, settle=30
        )
        for u in (3e-3, 0.3)
    )
    certified = slow.status == Status.CERTIFIED
    assert 0.5 < certified.mean() < 1.0
    assert np.abs(slow.leak[certified]).max() < 1e-9
    assert slow.leakage > 1e-6
    assert fast.leakage < 1e-9


@pytest.mark.thorough
def test_slow_surfaces_start_from_films_that_touch_or_from_faster_ones() -> None:
    """Where the smooth film would be thinner than the layers on the surfaces, and thinner than the grid can tell."""
    oil = Oil(0.0208, 11.4e-9)
    for velocity in (1e-6, 1e-3, 1e-2):
        contact = LubricatedContact(1e9, 0.02, velocity, oil, slide_to_roll=0.25)
        start = touching_start(contact, 193, domain(contact, ROUGH_INLET_GAP_RATIO), TOUCHING_FILM)
        assert start.certified
        assert start.film.min() > 0.999 * TOUCHING_FILM


@pytest.mark.thorough
def test_rough_film_depends_neither_on_the_grid_nor_on_the_order() -> None:
    """Lambda ratio 0.3: what the flow carries along is neither smeared nor made to ripple."""
    contact = LubricatedContact(0.7e9, 0.02, 2.0, Oil(0.0106, 9.7e-9), slide_to_roll=0.45)
    profiles = [generated_profile(0.3e-6, 30e-6, 10e-3, seed) for seed in (1, 2)]
    found = []
    for nodes, order in ((121, 1), (121, 2), (241, 2)):
        passage = rough_passage(
            contact, *profiles, steps=nodes, nodes=nodes, span=(-2.0, 1.5), settle=7 * nodes // 10, order=order
        )
        assert passage.certified_share == 1.0
        found.append([passage.average("mean_film"), passage.friction_coefficient])
    np.testing.assert_allclose(found[0], found[2], rtol=0.1)
    np.testing.assert_allclose(found[1], found[2], rtol=0.1)


def test_rough_contact_of_the_dissertation_is_certified_at_every_step() -> None:
    """90 deg C, 0.8 um on both surfaces, lambda ratio 0.19."""
    contact = LubricatedContact(0.7e9, 0.042, 2.2, OIL, slide_to_roll=0.45)
    profiles = [generated_profile(0.8e-6, 60e-6, 20 * contact.half_width, seed) for seed in (1, 2)]
    passage = rough_passage(contact, *profiles, steps=50, nodes=129, settle=20)
    assert passage.certified_share == 1.0
    assert np.nanmax(passage.violation) < 1e-8
    assert 0.002 < passage.friction_coefficient < 0.1
    assert passage.iterations.max() < sum(pace.iterations for pace in ROUGH)


def test_step_that_cannot_be_solved_is_a_status_and_not_a_number(monkeypatch: pytest.MonkeyPatch) -> None:
    module = importlib.import_module("easeoff.friction.ehl.reynolds_equation")
    monkeypatch.setattr(module, "ROUGH", (ROUGH[0].__class__(3.0, 0.1, 1),))
    passage = rough_passage(GEAR, wave(1e-7, 1e-4), steps=5, nodes=129, settle=0)
    assert (passage.status == Status.NOT_CONVERGED).all()
    assert np.isnan(passage.film_friction).all()
    assert math.isnan(passage.friction_coefficient)
    assert passage.certified_share == 0.0


def test_passage_and_film_as_labelled_datasets() -> None:
    start = smooth_film(GEAR, nodes=129)
    film = film_dataset(start)
    assert film["film"].attrs["units"] == "um"
    assert float(film["film_pressure"].max()) == pytest.approx(1e-6 * start.pressure.max())
    passage = rough_passage(GEAR, wave(2e-8, 5e-5), steps=9, nodes=129, settle=3, keep=3)
    data = passage_dataset(passage)
    assert dict(data.sizes) == {"time": 9, "kept_time": 3, "rolling_position": 129}
    np.testing.assert_allclose(data["kept_time"], data["time"][2::3])
    at_contact = np.abs(data["rolling_position"]) < 1e6 * GEAR.half_width
    least = data["film"].where(at_contact).min("rolling_position")
    np.testing.assert_allclose(least, data["minimum_film"][2::3], rtol=1e-12)
    settled = data["film_friction"].where(data["settled"] == 1).mean()
    assert float(settled) == pytest.approx(passage.average("film_friction"), rel=1e-12)


@pytest.mark.parametrize(
    ("make", "word"),
    [
        (lambda: generated_profile(-1e-6, 20e-6, 1e-3, 1), "rms"),
        (lambda: generated_profile(1e-6, 20e-6, 1e-4, 1), "ten correlation"),
        (lambda: measured_profile([0.0] * 3, 1e-6), "16"),
        (lambda: measured_profile(np.arange(20.0), 0.0), "spacing"),
        (lambda: rough_passage(GEAR, steps=0), "steps"),
        (lambda: rough_passage(GEAR, steps=1, order=3), "order"),
        (lambda: rough_passage(GEAR, steps=30, nodes=129), "steps = 30: must be above"),
        (lambda: rough_passage(GEAR, steps=1, touching_film=0.0), "touching_film"),
    ],
)
def test_bad_input_is_refused_by_name(make: object, word: str) -> None:
    with pytest.raises(InputError, match=word):
        make()  # type: ignore[operator]


# Waves and single asperities on their way through the contact, beside published amplitudes


def amplitude_ratio(contact: LubricatedContact, wavelength: float, nodes: int, relative: float = 0.1) -> float:
    """Amplitude of the film in the middle of the contact over that of the wave, in pure rolling."""
    amplitude = relative * smooth_film(contact, nodes=nodes, span=SPAN).central_film
    spacing = (SPAN[1] - SPAN[0]) / (nodes - 1)
    period = wavelength / spacing
    passage = rough_passage(
        contact,
        wave(amplitude, wavelength * contact.half_width),
        steps=int(2.6 / spacing + 1.2 * period),
        nodes=nodes,
        span=SPAN,
        order=2,
        keep=1,
    )
    assert passage.certified_share == 1.0
    middle = passage.film[-math.ceil(period) - 1 :, int(np.argmin(np.abs(passage.position)))]
    return float(np.ptp(middle) / (2.0 * amplitude))


def published(contact: LubricatedContact, wavelength: float) -> float:
    """Amplitude ratio of waves in pure rolling, a function of one variable for all conditions.

    Variable wavelength M^(3/4) / L^(1/2): Venner, Couhier, Lubrecht and Greenwood 1997,
    DOI 10.1016/S0167-8922(08)70440-1; the fitted curve is that of the later papers of Lubrecht and Venner.
    """
    reach = wavelength * contact.moes_load**0.75 / contact.moes_viscosity**0.5
    return float(1.0 / (1.0 + 0.125 * reach + 0.04 * reach**2))


@pytest.mark.parametrize(("load", "viscous", "wavelength"), [(60, 8, 1.0), (20, 14, 1.0), (60, 8, 0.5)])
@pytest.mark.quick(1)
def test_amplitude_of_waves_is_reduced_as_published(load: float, viscous: float, wavelength: float) -> None:
    contact = by_moes(load, viscous, compressible=True)
    assert amplitude_ratio(contact, wavelength, 193) == pytest.approx(published(contact, wavelength), abs=0.035)


@pytest.mark.thorough
def test_reduction_does_not_depend_on_the_amplitude_and_long_waves_vanish() -> None:
    contact = by_moes(60, 8, compressible=True)
    small, large = (amplitude_ratio(contact, 1.0, 129, relative) for relative in (0.02, 0.3))
    assert large == pytest.approx(small, rel=0.05)
    assert amplitude_ratio(contact, 2.0, 129) < 0.5 * small


def test_single_asperity_is_flattened_and_drags_its_film_along() -> None:
    """In pure rolling the hump leaves the film where it was pressed: thinner at the hump, by less than its height."""
    contact = by_moes(60, 8, compressible=True)
    smooth = smooth_film(contact, nodes=129, span=SPAN)
    height = 0.5 * smooth.central_film
    width = 0.6 * contact.half_width
    place = -2.9 * contact.half_width  # starts before the inlet
    nodes = 129
    steps = round(2.9 / (4.0 / (nodes - 1)))
    passage = rough_passage(
        contact, asperity(height, width, place), steps=steps, nodes=nodes, span=SPAN, ramp=0, order=2, keep=steps
    )
    assert (passage.status == Status.CERTIFIED).all()
    film = passage.film[0]
    middle = int(np.argmin(np.abs(passage.position)))
    lowest = int(np.argmin(np.where(np.abs(passage.position) < 0.5 * contact.half_width, film, np.inf)))
    assert abs(passage.position[lowest]) < 0.25 * contact.half_width
    loss = smooth.film[middle] - film[middle]
    assert 0.1 * height < loss < 0.95 * height
    assert passage.pressure[0][middle] > 1.02 * smooth.pressure[middle]


# Generated and measured profiles


def test_generated_profile_has_the_height_and_the_correlation_asked_for() -> None:
    profile = generated_profile(0.5e-6, 20e-6, 40e-3, seed=4)
    assert profile.rms == pytest.approx(0.5e-6, rel=1e-12)
    assert abs(profile.heights.mean()) < 1e-15
    spectrum = np.abs(np.fft.rfft(profile.heights)) ** 2
    correlation = np.fft.irfft(spectrum)[:100] / np.fft.irfft(spectrum)[0]
    lag = profile.spacing * np.arange(100.0)
    np.testing.assert_allclose(correlation, np.exp(-((lag / 20e-6) ** 2)), atol=1e-3)
    np.testing.assert_array_equal(profile.heights, generated_profile(0.5e-6, 20e-6, 40e-3, seed=4).heights)
    here = np.array([1e-3, 7e-3])
    np.testing.assert_allclose(profile(here + profile.length), profile(here), rtol=1e-9)
    assert profile.scaled(1e-6).rms == pytest.approx(1e-6)


def test_measured_profile_is_the_trace_without_its_slope() -> None:
    place = np.arange(400.0)
    trace = 0.3e-6 * np.sin(2 * np.pi * place / 50) + 2e-9 * place + 5e-6
    profile = measured_profile(trace, 1e-6)
    np.testing.assert_allclose(profile(1e-6 * place), profile.heights[:400], atol=1e-18)
    assert profile.rms == pytest.approx(0.3e-6 / np.sqrt(2), rel=0.02)
    assert np.abs(np.diff(np.append(profile.heights, profile.heights[0]))).max() < 0.05e-6
