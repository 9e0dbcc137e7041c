"""Waves and single asperities on their way through the contact, beside published amplitudes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from easeoff.friction.ehl import (
    LubricatedContact,
    Oil,
    Status,
    asperity,
    rough_passage,
    smooth_film,
    wave,
)

SPAN = (-2.5, 1.5)


def by_moes(load: float, viscous: float) -> LubricatedContact:
    """A Newtonian contact in pure rolling with given groups M and L."""
    modulus, radius, viscosity, coefficient = 2.2e11, 0.01, 0.04109, 2e-8
    speed = 0.5 * (viscous / (coefficient * modulus)) ** 4
    pressure = modulus * math.sqrt(load * math.sqrt(2.0 * speed) / (2.0 * math.pi))
    oil = Oil(viscosity, coefficient, eyring_stress=math.inf)
    return LubricatedContact(pressure, radius, speed * modulus * radius / viscosity, oil, 0.0, modulus)


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
    contact = by_moes(load, viscous)
    assert amplitude_ratio(contact, wavelength, 193) == pytest.approx(published(contact, wavelength), abs=0.035)


@pytest.mark.thorough
def test_reduction_does_not_depend_on_the_amplitude_and_long_waves_vanish() -> None:
    contact = by_moes(60, 8)
    small, large = (amplitude_ratio(contact, 1.0, 129, relative) for relative in (0.02, 0.3))
    assert large == pytest.approx(small, rel=0.05)
    assert amplitude_ratio(contact, 2.0, 129) < 0.5 * small


def test_single_asperity_is_flattened_and_drags_its_film_along() -> None:
    """In pure rolling the hump leaves the film where it was pressed: thinner at the hump, by less than its height."""
    contact = by_moes(60, 8)
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
