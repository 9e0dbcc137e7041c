"""Tensor splines through the nodes of a grid, evaluated with all derivatives asked for at once.

The interpolating spline of B-splines with the knots "not a knot" (de Boor, A Practical Guide to Splines, ch. XIII), as
that of ``scipy.interpolate``. Points share the search of their cell and the B-splines there among all components and
derivatives, which takes a fraction of the time of one evaluation a derivative.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from math import perm

import numpy as np

from ...core.arrays import Array, Integers, record
from ...core.kernels import kernel

evaluate = kernel(".spline_kernel", __package__).evaluate
#: B-splines that are not zero in an interval, of degree five: as many of a lower degree, the rest being zero.
SIZE = 6
PARTS_PER_INTERVAL = 8  # of the length, in the table that finds the interval of a point
#: Factor that a derivative of an order brings to a power, (order, 1, power, 1).
FALLING = np.array([[float(perm(power, order)) for power in range(SIZE)] for order in range(SIZE)])[:, None, :, None]


@record(frozen=True, eq=False)
class KnotIntervals:
    """The polynomial pieces of the B-splines of one direction."""

    ends: Array
    pieces: Array  # by powers from the middle over the width (k, degree + 1, degree + 1)

    @classmethod
    def through(cls, nodes: Array, degree: int) -> KnotIntervals:
        """Intervals of the spline through nodes (n), increasing, more than ``degree``."""
        half = (degree + 1) // 2
        inner = nodes if degree % 2 else 0.5 * (nodes[1:] + nodes[:-1])
        ends = np.concatenate([nodes[:1], inner[half : inner.size - half], nodes[-1:]])
        knots = np.concatenate([np.repeat(ends[0], degree), ends, np.repeat(ends[-1], degree)])
        middle, width = 0.5 * (ends[1:] + ends[:-1]), np.diff(ends)
        pieces = np.zeros((width.size, degree + 1, degree + 1))
        pieces[:, degree, 0] = 1.0
        first = np.arange(width.size)
        for order in range(1, degree + 1):  # the recurrence of Cox and de Boor, on the coefficients
            raised = np.zeros_like(pieces)
            for number in range(degree - order, degree + 1):
                left = first + number
                if number > degree - order:
                    rising = _line(knots[left], knots[left + order], middle, width)
                    raised[:, number] += _product(pieces[:, number], *rising)
                if number < degree:
                    falling = _line(knots[left + order + 1], knots[left + 1], middle, width)
                    raised[:, number] += _product(pieces[:, number + 1], *falling)
            pieces = raised
        return cls(ends, pieces)

    def place(self, points: Array) -> tuple[Integers, Array]:
        """Interval of each point (n), the first or last beyond the ends, and its coordinate in there (n)."""
        index = np.searchsorted(self.ends[1:-1], points, side="right")
        middle, width = 0.5 * (self.ends[1:] + self.ends[:-1]), np.diff(self.ends)
        return index, (points - middle[index]) / width[index]

    @cached_property
    def compiled(self) -> tuple[Array, Integers, Array, Array]:
        """Arrays that the compiled evaluation reads.

        Ends, intervals in which equal parts of the length begin, middles and one over widths (2, k), and the pieces of
        every derivative as (order, interval, power, B-spline).
        """
        parts = np.linspace(self.ends[0], self.ends[-1], PARTS_PER_INTERVAL * len(self.pieces), endpoint=False)
        first = np.searchsorted(self.ends[1:-1], parts, side="right")
        local = np.stack([0.5 * (self.ends[1:] + self.ends[:-1]), 1.0 / np.diff(self.ends)])
        return np.ascontiguousarray(self.ends), first, local, FALLING * _filled(self.pieces.swapaxes(1, 2))

    def collocation(self, points: Array) -> Array:
        """Values (n, s) of the s B-splines at points (n); at the nodes of the spline, the matrix of its equations."""
        index, local = self.place(points)
        degree = self.pieces.shape[1] - 1
        values = np.einsum("nbp,np->nb", self.pieces[index], local[:, None] ** np.arange(degree + 1))
        matrix = np.zeros((points.size, len(self.pieces) + degree))
        matrix[np.arange(points.size)[:, None], index[:, None] + np.arange(degree + 1)] = values
        return matrix


def _line(zero: Array, one: Array, middle: Array, width: Array) -> tuple[Array, Array]:
    """Value in the middle of intervals (k) and rise over them (k) of lines that are 0 and 1 at given places (k)."""
    return (middle - zero) / (one - zero), width / (one - zero)


def _product(polynomials: Array, value: Array, rise: Array) -> Array:
    """Coefficients (k, powers) of polynomials times lines; the highest power of the polynomials is zero."""
    result = value[:, None] * polynomials
    result[:, 1:] += rise[:, None] * polynomials[:, :-1]
    return np.asarray(result)


@record(frozen=True, eq=False)
class TensorSpline:
    """Spline of several components on a grid; ``through`` makes one."""

    intervals: tuple[KnotIntervals, KnotIntervals]
    coefficients: Array

    @classmethod
    def through(cls, nodes: tuple[Array, Array], values: Array, degrees: tuple[int, int]) -> TensorSpline:
        """The spline through values (nt, nh, m) at the nodes (nt) and (nh) of a grid."""
        along, across = (KnotIntervals.through(n, d) for n, d in zip(nodes, degrees, strict=True))
        nt, nh, count = values.shape
        first = np.linalg.solve(along.collocation(nodes[0]), values.reshape(nt, -1)).reshape(nt, nh, count)
        second = np.linalg.solve(across.collocation(nodes[1]), np.moveaxis(first, 1, 0).reshape(nh, -1))
        return cls((along, across), np.ascontiguousarray(second.reshape(nh, nt, count).transpose(2, 1, 0)))

    def part(self, components: Integers) -> TensorSpline:
        """The spline of some of the components alone."""
        return TensorSpline(self.intervals, np.ascontiguousarray(self.coefficients[components]))

    @cached_property
    def _filled(self) -> Array:
        """Coefficients as the compiled evaluation reads them."""
        return _filled(self.coefficients, *(len(each.pieces) for each in self.intervals))

    def evaluate(self, points: Array, derivatives: Sequence[tuple[int, int]]) -> list[Array]:
        """Values of derivatives, by their orders in both directions, at points (2, n): each (m, n).

        Beyond the grid the polynomials of its edge go on.
        """
        (t, h), (along, across) = np.ascontiguousarray(points, dtype=float), self.intervals
        results = np.empty((len(derivatives), len(self.coefficients), t.size))
        orders = np.array(derivatives, dtype=np.int64)
        evaluate(*along.compiled, *across.compiled, self._filled, t, h, orders, results)
        return list(results)

    def on_grid(self, along: Array, across: Array) -> Array:
        """Values (m, p, q) on the grid from coordinates (p) and (q), as the product of both directions."""
        first, second = (each.collocation(one) for each, one in zip(self.intervals, (along, across), strict=True))
        return np.asarray(first @ self.coefficients @ second.T)


def _filled(values: Array, *intervals: int) -> Array:
    """Values (..., p, q) with zeros behind them, as many as B-splines of the fifth degree have."""
    wanted = tuple(count + SIZE - 1 for count in intervals) or (SIZE, SIZE)
    behind = [(0, more - given) for more, given in zip(wanted, values.shape[-2:], strict=True)]
    return np.ascontiguousarray(np.pad(values, [(0, 0)] * (values.ndim - 2) + behind))
