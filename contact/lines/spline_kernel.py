"""Tensor splines at given points, compiled: the sums of B-splines of ``tensor_spline``, one point after another."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np

from ...core.compiled.compilation import compiled, readable

#: Splines of degree five alone: loops of a known length are unrolled.
SIZE = 6
ORDER_LIMIT = 2

_sums = compiled(fastmath={"contract"})


@_sums
def _interval(ends: Any, per_length: float, x: float) -> int:
    """Interval between ends in which a coordinate lies, the first or last beyond them, from their number per length."""
    last = ends.size - 2
    share = (x - ends[0]) * per_length
    if not share > 0.0:
        return 0
    here = int(min(share, float(last)))
    while here > 0 and ends[here] > x:
        here -= 1
    while here < last and ends[here + 1] <= x:
        here += 1
    return here


@_sums
def _b_splines(ends: Any, pieces: Any, x: float, i: int, values: Any) -> None:
    """Values and derivatives (orders, splines) of the B-splines with pieces (powers, splines) in an interval."""
    unit = 1.0 / (ends[i + 1] - ends[i])
    u, p = (x - 0.5 * (ends[i] + ends[i + 1])) * unit, pieces[i]
    for s in range(SIZE):
        values[0, s] = p[0, s] + u * (p[1, s] + u * (p[2, s] + u * (p[3, s] + u * (p[4, s] + u * p[5, s]))))
    if values.shape[0] > 1:
        for s in range(SIZE):
            slope = p[1, s] + u * (2.0 * p[2, s] + u * (3.0 * p[3, s] + u * (4.0 * p[4, s] + u * (5.0 * p[5, s]))))
            values[1, s] = unit * slope
    if values.shape[0] > 2:
        for s in range(SIZE):
            bend = 2.0 * p[2, s] + u * (6.0 * p[3, s] + u * (12.0 * p[4, s] + u * (20.0 * p[5, s])))
            values[2, s] = unit * unit * bend


@_sums
def _sum(c: Any, i: int, y: int, w: Any) -> float:
    """Sum of the B-splines of the first direction with weights, for one of the second."""
    low = w[0] * c[i, y] + w[1] * c[i + 1, y] + w[2] * c[i + 2, y]
    return low + (w[3] * c[i + 3, y] + w[4] * c[i + 4, y] + w[5] * c[i + 5, y])  # type: ignore[no-any-return]


_vector, _block = readable(numba.f8, 1), readable(numba.f8, 3)


@compiled(
    numba.void(_vector, _block, _vector, _block, _block, _vector, _vector, readable(numba.i8, 2), numba.f8[:, :, ::1]),
    fastmath={"contract"},
)
def evaluate(
    ends_t: Any, pieces_t: Any, ends_h: Any, pieces_h: Any, coefficients: Any, t: Any, h: Any, orders: Any, results: Any
) -> None:
    """Derivatives of a spline.

    Parameters
    ----------
    ends_t, pieces_t, ends_h, pieces_h
        Of the intervals of both directions, the pieces as (interval, power, B-spline).
    coefficients
        Of the B-splines (m, nt, nh).
    t, h
        Points (n).
    orders
        Orders of the derivatives by both coordinates (d, 2), up to ``ORDER_LIMIT``.
    results
        For the derivatives (d, m, n).
    """
    along, across = np.empty((orders[:, 0].max() + 1, SIZE)), np.empty((orders[:, 1].max() + 1, SIZE))
    per_t, per_h = (ends_t.size - 1) / (ends_t[-1] - ends_t[0]), (ends_h.size - 1) / (ends_h[-1] - ends_h[0])
    for n in range(t.size):
        i, j = _interval(ends_t, per_t, t[n]), _interval(ends_h, per_h, h[n])
        _b_splines(ends_t, pieces_t, t[n], i, along)
        _b_splines(ends_h, pieces_h, h[n], j, across)
        for m in range(coefficients.shape[0]):
            c = coefficients[m]
            for order in range(along.shape[0]):
                w = along[order]
                v0, v1, v2 = _sum(c, i, j, w), _sum(c, i, j + 1, w), _sum(c, i, j + 2, w)
                v3, v4, v5 = _sum(c, i, j + 3, w), _sum(c, i, j + 4, w), _sum(c, i, j + 5, w)
                for d in range(orders.shape[0]):
                    if orders[d, 0] == order:
                        b = across[orders[d, 1]]
                        low = b[0] * v0 + b[1] * v1 + b[2] * v2
                        results[d, m, n] = low + (b[3] * v3 + b[4] * v4 + b[5] * v5)
