"""Tensor splines through the nodes of a grid, evaluated as a polynomial a cell with all derivatives asked for at once.

The interpolating spline of B-splines with the knots "not a knot" (de Boor, A Practical Guide to Splines, ch. XIII), as
that of ``scipy.interpolate``. Points share the search of their cell and its coefficients among all components and
derivatives, which takes a fraction of the time of one evaluation a derivative.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import perm
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from ...core.compiled.compiled_use import compiled_code_of

Array = NDArray[Any]
TABLE_SIZE_LIMIT = 2_000_000  # numbers of a table of all cells; beyond it those of the cells that are asked for
BLOCK_SIZE = 60_000  # numbers that are read from the table at a time
PARTS_PER_INTERVAL = 8  # of the length, in the table that finds the interval of a point


@frozen_arrays
@dataclass(frozen=True, eq=False)
class KnotIntervals:
    """The polynomial pieces of the B-splines of one direction.

    Parameters
    ----------
    ends
        Ends of the intervals between knots (k + 1).
    pieces
        Coefficients (k, degree + 1, degree + 1) of each B-spline that is not zero in an interval by the powers of the
        coordinate from the middle of the interval over its width.
    """

    ends: Array
    pieces: Array

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

    def place(self, points: Array) -> tuple[NDArray[np.int64], Array]:
        """Interval of each point (n), the first or last beyond the ends, and its coordinate in there (n)."""
        index = np.searchsorted(self.ends[1:-1], points, side="right")
        middle, width = 0.5 * (self.ends[1:] + self.ends[:-1]), np.diff(self.ends)
        return index, (points - middle[index]) / width[index]

    @cached_property
    def compiled(self) -> tuple[Array, NDArray[np.int64], Array, Array]:
        """What the compiled evaluation reads.

        Ends, intervals in which equal parts of the length begin, middles and one over widths (2, k), and pieces as
        (interval, power, B-spline).
        """
        parts = np.linspace(self.ends[0], self.ends[-1], PARTS_PER_INTERVAL * len(self.pieces), endpoint=False)
        first = np.searchsorted(self.ends[1:-1], parts, side="right")
        local = np.stack([0.5 * (self.ends[1:] + self.ends[:-1]), 1.0 / np.diff(self.ends)])
        return np.ascontiguousarray(self.ends), first, local, _with_zeros(self.pieces.swapaxes(1, 2))

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


@frozen_arrays
@dataclass(frozen=True, eq=False)
class TensorSpline:
    """Spline of several components on a grid; ``through`` makes one.

    Parameters
    ----------
    intervals
        Of both directions.
    coefficients
        Of the B-splines (m, nt, nh).
    """

    intervals: tuple[KnotIntervals, KnotIntervals]
    coefficients: Array

    @classmethod
    def through(cls, nodes: tuple[Array, Array], values: Array, degrees: tuple[int, int]) -> TensorSpline:
        """The spline through values (nt, nh, m) at the nodes (nt) and (nh) of a grid.

        Examples
        --------
        >>> nodes = np.linspace(0.0, 1.0, 9), np.linspace(0.0, 2.0, 7)
        >>> values = (nodes[0][:, None] ** 3 * nodes[1] ** 2)[..., None]
        >>> spline = TensorSpline.through(nodes, values, (5, 5))
        >>> value, slope = spline.evaluate(np.array([[0.5], [1.0]]), [(0, 0), (0, 1)])
        >>> value[0].round(12).tolist(), slope[0].round(12).tolist()
        ([0.125], [0.25])
        """
        along, across = (KnotIntervals.through(n, d) for n, d in zip(nodes, degrees, strict=True))
        nt, nh, count = values.shape
        first = np.linalg.solve(along.collocation(nodes[0]), values.reshape(nt, -1)).reshape(nt, nh, count)
        second = np.linalg.solve(across.collocation(nodes[1]), np.moveaxis(first, 1, 0).reshape(nh, -1))
        return cls((along, across), np.ascontiguousarray(second.reshape(nh, nt, count).transpose(2, 1, 0)))

    def part(self, components: NDArray[np.int64]) -> TensorSpline:
        """The spline of some of the components alone."""
        return TensorSpline(self.intervals, np.ascontiguousarray(self.coefficients[components]))

    @cached_property
    def _rows(self) -> Array:
        """Coefficients as the compiled evaluation reads them."""
        return _with_zeros(self.coefficients)

    @cached_property
    def _table(self) -> Array:
        return self._polynomials(np.arange(self._cell_count))

    @property
    def _cell_count(self) -> int:
        return len(self.intervals[0].pieces) * len(self.intervals[1].pieces)

    def _polynomials(self, cells: NDArray[np.int64]) -> Array:
        """Coefficients (profile power, lengthwise power, m, n) of the polynomials of cells (n)."""
        along, across = (each.pieces for each in self.intervals)
        i, j = np.divmod(cells, across.shape[0])
        windows = sliding_window_view(self.coefficients, (along.shape[1], across.shape[1]), axis=(1, 2))[:, i, j]
        half = np.einsum("mnab,nap->pmnb", windows, along[i], optimize=True)
        return np.ascontiguousarray(np.einsum("pmnb,nbq->qpmn", half, across[j], optimize=True))

    def evaluate(self, points: Array, derivatives: Sequence[tuple[int, int]]) -> list[Array]:
        """Values of derivatives, by their orders in both directions, at points (2, n): each (m, n).

        Beyond the grid the polynomials of its edge go on.
        """
        kernel = compiled_code_of(_kernel)
        if kernel is not None and self._suits(kernel, derivatives):
            return self._compiled(kernel, points, derivatives)
        (i, u), (j, v) = (each.place(one) for each, one in zip(self.intervals, points, strict=True))
        cells = i * self.intervals[1].pieces.shape[0] + j
        components, orders = len(self.coefficients), [each.pieces.shape[1] for each in self.intervals]
        terms = components * orders[0] * orders[1]
        if self._cell_count * terms <= TABLE_SIZE_LIMIT:
            table = self._table
        else:
            wanted, cells = np.unique(cells, return_inverse=True)
            table = self._polynomials(wanted)
        scales = [1.0 / np.diff(each.ends)[index] for each, index in zip(self.intervals, (i, j), strict=True)]
        results = [np.empty((components, u.size)) for _ in derivatives]
        step = max(BLOCK_SIZE // terms, 64)
        for start in range(0, u.size, step):
            block = slice(start, start + step)
            rows = table.take(cells[block], axis=-1, mode="clip")
            partial = {b: _horner(rows, v[block], b) for b in {b for _, b in derivatives}}
            for result, (a, b) in zip(results, derivatives, strict=True):
                result[:, block] = _horner(partial[b], u[block], a)
        for result, orders_of in zip(results, derivatives, strict=True):
            for scale, order in zip(scales, orders_of, strict=True):
                for _ in range(order):
                    result *= scale
        return results

    def on_grid(self, along: Array, across: Array) -> Array:
        """Values (m, p, q) at all points of a grid from coordinates (p) and (q), as the product of both directions.

        Examples
        --------
        >>> nodes = np.linspace(0.0, 1.0, 6)
        >>> cubes = np.repeat(nodes[:, None, None] ** 3, 6, axis=1)
        >>> spline = TensorSpline.through((nodes, nodes), cubes, (5, 5))
        >>> spline.on_grid(np.array([0.5]), np.array([0.2, 0.9])).round(12).tolist()
        [[[0.125, 0.125]]]
        """
        first, second = (each.collocation(one) for each, one in zip(self.intervals, (along, across), strict=True))
        return np.asarray(first @ self.coefficients @ second.T)

    def _suits(self, kernel: Any, derivatives: Sequence[tuple[int, int]]) -> bool:
        """Whether the compiled evaluation is made for this spline and these derivatives."""
        sizes = {each.pieces.shape[1] for each in self.intervals}
        return sizes == {kernel.SIZE} and max(map(max, derivatives)) <= kernel.ORDER_LIMIT

    def _compiled(self, kernel: Any, points: Array, derivatives: Sequence[tuple[int, int]]) -> list[Array]:
        """As ``evaluate``."""
        (t, h), (along, across) = np.ascontiguousarray(points, dtype=float), self.intervals
        results = np.empty((len(derivatives), len(self.coefficients), t.size))
        orders = np.array(derivatives, dtype=np.int64)
        kernel.evaluate(*along.compiled, *across.compiled, self._rows, t, h, orders, results)
        return list(results)


def _with_zeros(values: Array) -> Array:
    """Values (..., n) with two zeros more in every row: compiled code reads six numbers as a row of eight."""
    return np.concatenate([values, np.zeros((*values.shape[:-1], 2))], axis=-1)


def _kernel() -> Any:
    from . import spline_kernel

    return spline_kernel


def _horner(coefficients: Array, at: Array, order: int) -> Array:
    """Derivative of an order of polynomials with coefficients (powers, ..., n) at coordinates (n)."""
    last = len(coefficients) - 1
    if order > last:
        return np.zeros(coefficients.shape[1:])
    total = perm(last, order) * coefficients[last]
    for power in range(last - 1, order - 1, -1):
        total *= at
        total += perm(power, order) * coefficients[power] if order else coefficients[power]
    return np.asarray(total)
