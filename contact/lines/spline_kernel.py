# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
# cython: annotation_typing=False, infer_types=True
"""Tensor splines at given points: the sums of the B-splines of ``flank_splines``, one point after another. Compiled."""

from __future__ import annotations

from typing import Any


def _interval(ends: Any, first: Any, per_length: float, x: float) -> int:
    """Interval between ends in which a coordinate lies, the first or last beyond them.

    ``first`` has the interval in which each equal part of the whole length begins, so many per length.
    """
    parts, last = first.shape[0], ends.shape[0] - 2
    share = (x - ends[0]) * per_length
    if not share > 0.0:
        return 0
    part = int(min(share, parts - 1.0))
    i: int = first[part]
    while i < last and ends[i + 1] <= x:
        i += 1
    return i


def _b_splines(pieces: Any, i: int, u: float, unit: float, orders: int, values: Any) -> None:
    """Values and derivatives (orders, 6) of the B-splines of an interval, at a coordinate from its middle."""
    s, scale = [0.0] * 6, 1.0
    for order in range(orders):
        for b in range(6):
            s[b] = pieces[order, i, 5, b]
        for down in range(5 - order):
            for b in range(6):
                s[b] = s[b] * u + pieces[order, i, 4 - down, b]
        for b in range(6):
            values[6 * order + b] = s[b] * scale
        scale *= unit


def evaluate(
    ends_t: Any, first_t: Any, local_t: Any, pieces_t: Any, ends_h: Any, first_h: Any, local_h: Any, pieces_h: Any,
    coefficients: Any, t: Any, h: Any, orders: Any, results: Any,
) -> None:  # fmt: skip
    """Write derivatives of a spline of orders (d, 2), up to five, at points (n) to ``results`` (d, m, n).

    Of each direction: ends of intervals, table of ``_interval``, middles and one over widths (2, interval), pieces
    (order, interval, power, B-spline) with the factors of the derivatives; coefficients (m, nt, nh).
    """
    components, count = coefficients.shape[0], orders.shape[0]
    most_t, most_h = 0, 0
    for d in range(count):
        most_t, most_h = max(most_t, orders[d, 0]), max(most_h, orders[d, 1])
    along, across, sums, s = [0.0] * 36, [0.0] * 36, [0.0] * 36, [0.0] * 6
    per_t = first_t.shape[0] / (ends_t[ends_t.shape[0] - 1] - ends_t[0])
    per_h = first_h.shape[0] / (ends_h[ends_h.shape[0] - 1] - ends_h[0])
    for n in range(t.shape[0]):
        i, j = _interval(ends_t, first_t, per_t, t[n]), _interval(ends_h, first_h, per_h, h[n])
        _b_splines(pieces_t, i, (t[n] - local_t[0, i]) * local_t[1, i], local_t[1, i], most_t + 1, along)
        _b_splines(pieces_h, j, (h[n] - local_h[0, j]) * local_h[1, j], local_h[1, j], most_h + 1, across)
        for m in range(components):
            for order in range(most_t + 1):
                for b in range(6):
                    s[b] = 0.0
                for a in range(6):
                    weight = along[6 * order + a]
                    for b in range(6):
                        s[b] += weight * coefficients[m, i + a, j + b]
                for b in range(6):
                    sums[6 * order + b] = s[b]
            for d in range(count):
                one, other = 6 * orders[d, 0], 6 * orders[d, 1]
                for b in range(6):
                    s[b] = sums[one + b] * across[other + b]
                results[d, m, n] = (s[0] + s[1]) + (s[2] + s[3]) + (s[4] + s[5])
