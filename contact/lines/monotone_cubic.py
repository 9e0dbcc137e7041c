"""Cubic through given values that overshoots none of them (Fritsch and Butland 1984, doi:10.1137/0905021)."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ...core.arrays import Array, record


@record(frozen=True, eq=False)
class MonotoneCubic:
    """Piecewise cubic with a continuous slope, monotone wherever the values are.

    Slopes are weighted harmonic means of those of the chords beside, zero at an extreme; at the ends that of the
    parabola through three values, limited to keep the shape.
    """

    places: Array  # (n), increasing, at least two
    values: Array

    @cached_property
    def slopes(self) -> Array:
        """Slopes at the values (n)."""
        width = np.diff(self.places)
        chord = np.diff(self.values) / width
        if chord.size == 1:
            return np.repeat(chord, 2)
        before, after = chord[:-1], chord[1:]
        heavy, light = 2.0 * width[1:] + width[:-1], width[1:] + 2.0 * width[:-1]
        with np.errstate(divide="ignore", invalid="ignore"):
            mean = (heavy + light) / (heavy / before + light / after)
        inner = np.where(before * after > 0.0, mean, 0.0)
        return np.concatenate([[_end(width[:2], chord[:2])], inner, [_end(width[:-3:-1], chord[:-3:-1])]])

    def __call__(self, at: Array) -> Array:
        """Values at places (...), NaN outside."""
        index = np.clip(np.searchsorted(self.places, at, side="right") - 1, 0, self.places.size - 2)
        width, slopes = np.diff(self.places)[index], self.slopes
        rise = np.diff(self.values)[index]
        u = (at - self.places[index]) / width
        start, end = slopes[index] * width, slopes[index + 1] * width
        bend = (3.0 * rise - 2.0 * start - end) + u * (start + end - 2.0 * rise)
        cubic = self.values[index] + u * (start + u * bend)
        return np.where((at >= self.places[0]) & (at <= self.places[-1]), cubic, np.nan)


def _end(width: Array, chord: Array) -> float:
    """Slope at an end from the widths and the slopes of the two chords next to it."""
    slope = ((2.0 * width[0] + width[1]) * chord[0] - width[0] * chord[1]) / (width[0] + width[1])
    if slope * chord[0] <= 0.0:
        return 0.0
    if chord[0] * chord[1] <= 0.0 and abs(slope) > 3.0 * abs(chord[0]):
        return float(3.0 * chord[0])
    return float(slope)
