"""Tensor splines of several fields on the gear flank, through the nodes of a grid.

They interpolate, with B-splines and the knots "not a knot" (de Boor, A Practical Guide to Splines, ch. XIII), as those
of ``scipy.interpolate``. Points share the search of their cell and the B-splines there among all components and all
derivatives asked for, which takes a fraction of the time of one evaluation a derivative. Where a curve must overshoot
none of its values it is the cubic of Fritsch and Butland (1984, doi:10.1137/0905021).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from functools import cached_property
from math import perm

import numpy as np

from ...core.arrays import Array, Bools, Integers, record
from ...core.errors import InputError
from ...core.kernels import kernel


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


SPLINE_DEGREE = 5
Orders = Sequence[tuple[int, int]]  # of derivatives by the two fractions
SLOPES = [(1, 0), (0, 1)]  # orders of derivatives, for ``FlankSplines.derivatives``
VALUE_AND_SLOPES = [(0, 0), *SLOPES]
BENDS = [(2, 0), (1, 1), (0, 2)]


@record(frozen=True)
class FlankSplines:
    """Splines of named fields on the unit square (lengthwise, profile)."""

    spline: TensorSpline
    columns: Mapping[str, tuple[slice, tuple[int, ...]]]  # place among the components, and shape of the field
    holes: Array
    lengthwise: Array
    profile: Array
    _parts: dict[tuple[str, ...], TensorSpline] = field(default_factory=dict, init=False, repr=False, compare=False)

    def __call__(self, name: str, points: Array, derivative: tuple[int, int] = (0, 0)) -> Array:
        """Values (*field shape, ...) of one field, or of a derivative by the two fractions, at points (2, ...)."""
        return self.evaluate([name], points, derivative)[name]

    def evaluate(self, names: list[str], points: Array, derivative: tuple[int, int] = (0, 0)) -> dict[str, Array]:
        """Evaluate several fields at once; see ``__call__``."""
        return self.derivatives(names, points, [derivative])[0]

    def derivatives(self, names: Sequence[str], points: Array, orders: Orders) -> list[dict[str, Array]]:
        """Values (*field shape, ...) by name of several fields, for several derivatives by both fractions."""
        shape = np.shape(points)[1:]
        derivatives = self._part(tuple(names)).evaluate(np.reshape(points, (2, -1)), orders)
        return self._by_name(names, [values.reshape(len(values), *shape) for values in derivatives])

    def on_grid(self, names: Sequence[str], lengthwise: Array, profile: Array) -> dict[str, Array]:
        """Values (*field shape, p, q) of fields on the grid from fractions (p) and (q), quicker than by point."""
        return self._by_name(names, [self._part(tuple(names)).on_grid(lengthwise, profile)])[0]

    def _by_name(self, names: Sequence[str], derivatives: Sequence[Array]) -> list[dict[str, Array]]:
        """Values (components, ...) of several derivatives, by the names of the fields."""
        results: list[dict[str, Array]] = [{} for _ in derivatives]
        start = 0
        for name in names:
            components, of_field = self.columns[name]
            rows = slice(start, start := start + components.stop - components.start)
            for result, values in zip(results, derivatives, strict=True):
                result[name] = values[rows].reshape(*of_field, *values.shape[1:])
        return results

    def _part(self, names: tuple[str, ...]) -> TensorSpline:
        """Spline of some of the fields alone, made once."""
        if names not in self._parts:
            components = [np.arange(one.start, one.stop) for one in (self.columns[name][0] for name in names)]
            self._parts[names] = self.spline.part(np.concatenate(components))
        return self._parts[names]

    def in_hole(self, points: Array) -> Bools:
        """True where points (2, ...) lie in a cell with a node that has no value."""
        if not self.holes.any():
            return np.zeros(np.shape(points)[1:], dtype=bool)
        i = np.clip(np.searchsorted(self.lengthwise, points[0], side="right") - 1, 0, self.lengthwise.size - 2)
        j = np.clip(np.searchsorted(self.profile, points[1], side="right") - 1, 0, self.profile.size - 2)
        return np.asarray(self.holes[i, j], dtype=bool)


def fit(lengthwise: Array, profile: Array, fields: Mapping[str, Array]) -> FlankSplines:
    """Splines of degree five (less on small grids) through fields (nt, nh, ...) by name, on a grid that increases.

    Nodes with NaN in any field are holes: bridged, and every cell that touches one is marked. An ``InputError`` refuses
    fewer than four nodes in a direction, or fewer than half of all valid.
    """
    shape = (lengthwise.size, profile.size)
    if min(shape) < 4:
        raise InputError(f"grid of {shape[0]} x {shape[1]} nodes: must have at least 4 in each direction")
    stacked = np.concatenate([np.reshape(v, (*shape, -1)) for v in fields.values()], axis=2)
    missing = ~np.all(np.isfinite(stacked), axis=2)
    if missing.mean() > 0.5:
        raise InputError(
            f"{100 * (1 - missing.mean()):.0f} % of the grid's nodes have values, too few: must be at least 50 %"
        )
    if np.any(missing):
        from scipy.interpolate import RBFInterpolator

        grid = np.stack(np.meshgrid(lengthwise, profile, indexing="ij"), axis=-1)
        bridge = RBFInterpolator(grid[~missing], stacked[~missing], neighbors=40, degree=2)
        stacked[missing] = bridge(grid[missing])
    degrees = [min(SPLINE_DEGREE, n - 1) for n in shape]
    spline = TensorSpline.through((lengthwise, profile), stacked, (degrees[0], degrees[1]))
    columns, start = {}, 0
    for name, value in fields.items():
        shape_of_field = np.shape(value)[2:]
        columns[name] = (slice(start, start := start + int(np.prod(shape_of_field, dtype=int))), shape_of_field)
    holes = missing[:-1, :-1] | missing[1:, :-1] | missing[:-1, 1:] | missing[1:, 1:]
    return FlankSplines(spline, columns, holes, np.asarray(lengthwise), np.asarray(profile))
