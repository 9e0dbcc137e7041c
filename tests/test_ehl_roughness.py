"""Generated and measured profiles."""

from __future__ import annotations

import numpy as np
import pytest

from easeoff.friction.ehl import (
    generated_profile,
    measured_profile,
)


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
