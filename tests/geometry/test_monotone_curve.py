"""Monotone curves are those of scipy, to the bit."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from easeoff.geometry.monotone_curve import monotone_curve


@pytest.mark.parametrize("count", [2, 3, 4, 12])
def test_numbers_are_those_of_scipy(count: int) -> None:
    draw = np.random.default_rng(count)
    for step in (0.0, 1.0):  # whole numbers have level pieces, and turns
        places = np.cumsum(draw.random(count) + 1e-9)
        values = draw.standard_normal((3, count)) if step == 0.0 else draw.integers(-2, 3, (3, count)).astype(float)
        wanted = np.concatenate([places, draw.uniform(places[0] - 0.1, places[-1] + 0.1, 9)])
        known = PchipInterpolator(places, values, axis=1)(wanted)
        np.testing.assert_array_equal(monotone_curve(places, values, wanted), known)
        np.testing.assert_array_equal(monotone_curve(places, values[0], wanted), known[0])


def test_values_between_two_points_are_no_greater_than_both() -> None:
    places, values = np.arange(5.0), np.array([0.0, 0.0, 1.0, 1.0, 1.0])
    between = monotone_curve(places, values, np.linspace(0.0, 4.0, 81))
    assert (between.min(), between.max()) == (0.0, 1.0)
    assert np.all(np.diff(between) >= 0.0)
