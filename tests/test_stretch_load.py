"""Greatest load per length over stretches of a line: sums that do not depend on how the line is divided."""

from __future__ import annotations

import numpy as np
import pytest

from easeoff.verification.flank_contact.stretch_load import greatest_stretch_load


def parabola(pieces: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pieces of a line of 4 mm under the line load 300 (1 - (x/2)^2) N/mm: middles, lengths, forces."""
    ends = np.linspace(-2.0, 2.0, pieces + 1)
    force = np.diff(300.0 * (ends - ends**3 / 12.0))
    return 0.5 * (ends[1:] + ends[:-1]), np.diff(ends), force


@pytest.mark.parametrize("stretch", [0.5, 1.5, 3.0])
def test_mean_of_a_parabola(stretch: float) -> None:
    """In its middle 300 (1 - w^2 / 48) N/mm; pieces of a line are second order, and never above the true maximum."""
    exact = 300.0 * (1.0 - stretch**2 / 48.0)
    errors = [exact - greatest_stretch_load(*parabola(pieces), stretch) for pieces in (11, 44)]
    assert abs(errors[1]) < 1e-3 * exact
    assert abs(errors[1]) < 0.2 * abs(errors[0]) + 1e-9


def test_dividing_pieces_changes_nothing() -> None:
    place, length, force = parabola(7)
    halves = np.concatenate([place - 0.25 * length, place + 0.25 * length])
    twice = greatest_stretch_load(halves, np.tile(0.5 * length, 2), np.tile(0.5 * force, 2), 1.3)
    assert twice == pytest.approx(greatest_stretch_load(place, length, force, 1.3), rel=1e-12)


def test_overlapping_pieces_add_up() -> None:
    """Segments of a line and pieces of an edge beside them, and cells side by side across a line."""
    place, length, force = parabola(7)
    both = greatest_stretch_load(np.tile(place, 2), np.tile(length, 2), np.concatenate([force, 2.0 * force]), 1.0)
    assert both == pytest.approx(3.0 * greatest_stretch_load(place, length, force, 1.0), rel=1e-12)


def test_a_stretch_longer_than_the_line_bears_all_of_it() -> None:
    place, length, force = parabola(7)
    assert greatest_stretch_load(place, length, force, 8.0) == pytest.approx(force.sum() / 8.0, rel=1e-12)
    assert greatest_stretch_load(place, length, 0.0 * force, 8.0) == 0.0
