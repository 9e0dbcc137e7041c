"""Tensor splines at given points, compiled: the sums of B-splines of ``tensor_spline``, one point after another.

Six numbers side by side are taken as one row of eight: a processor multiplies and adds as many at once.
"""

from __future__ import annotations

from math import perm
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from ...core.compiled.compilation import compiled, readable

#: Splines of degree five alone: loops of a known length are unrolled.
SIZE = 6
#: Numbers of a row that are taken at once, of which ``SIZE`` count.
LANES = 8
ORDER_LIMIT = 2

_ROW, _INTEGER = ir.VectorType(ir.DoubleType(), LANES), ir.IntType(64)


def _constant(value: int) -> Any:
    return ir.Constant(_INTEGER, value)


def _shuffled(builder: Any, row: Any, lanes: list[int]) -> Any:
    """Some lanes of a row."""
    chosen = ir.Constant(ir.VectorType(ir.IntType(32), len(lanes)), lanes)
    return builder.shuffle_vector(row, ir.Constant(row.type, ir.Undefined), chosen)


def _repeated(builder: Any, number: Any) -> Any:
    """A row of one number."""
    row = builder.insert_element(ir.Constant(_ROW, ir.Undefined), number, ir.Constant(ir.IntType(32), 0))
    return _shuffled(builder, row, [0] * LANES)


def _sum_of_product(builder: Any, one: Any, other: Any, added: Any) -> Any:
    """The product of two rows, added to a third unless that is ``None``."""
    if added is None:
        return builder.fmul(one, other)
    kind = ir.FunctionType(_ROW, [_ROW] * 3)
    return builder.call(cgutils.get_or_insert_function(builder.module, kind, "llvm.fmuladd.v8f64"), [one, other, added])


def _place(context: Any, builder: Any, kind: Any, array: Any, index: list[Any]) -> Any:
    """Address of a number in an array."""
    return cgutils.get_item_pointer(
        context, builder, kind, context.make_array(kind)(context, builder, array), index, wraparound=False
    )


def _row(builder: Any, place: Any) -> Any:
    """The row of numbers at an address."""
    row = builder.load(builder.bitcast(place, _ROW.as_pointer()))
    row.align = 8
    return row


@intrinsic  # type: ignore[untyped-decorator]
def _b_splines(typing: Any, pieces: Any, i: Any, u: Any, order: Any, scale: Any, values: Any) -> Any:
    """Derivative of an order, times a scale, of the B-splines with pieces (interval, power, lanes) into ``values``."""
    if not isinstance(order, types.IntegerLiteral):
        return None
    degree_lost = order.literal_value

    def generated(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pieces, i, u, _, scale, values = arguments
        at, total = _repeated(builder, u), None
        for power in range(SIZE - 1, degree_lost - 1, -1):
            row = _row(
                builder, _place(context, builder, signature.args[0], pieces, [i, _constant(power), _constant(0)])
            )
            if degree_lost:
                row = builder.fmul(row, ir.Constant(_ROW, [float(perm(power, degree_lost))] * LANES))
            total = row if total is None else _sum_of_product(builder, total, at, row)
        total = builder.fmul(total, _repeated(builder, scale))
        place = _place(context, builder, signature.args[5], values, [_constant(degree_lost), _constant(0)])
        builder.store(total, builder.bitcast(place, _ROW.as_pointer())).align = 8
        return context.get_dummy_value()

    return types.void(pieces, i, u, order, scale, values), generated


@intrinsic  # type: ignore[untyped-decorator]
def _sum(typing: Any, c: Any, m: Any, i: Any, j: Any, along: Any, a: Any, across: Any, b: Any) -> Any:
    """Sum of the B-splines with coefficients (m, nt, nh + ``LANES``), in rows ``a`` and ``b`` of their values."""

    def generated(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        c, m, i, j, along, a, across, b = arguments
        place = _place(context, builder, signature.args[0], c, [m, i, j])
        length = cgutils.unpack_tuple(builder, context.make_array(signature.args[0])(context, builder, c).shape)[2]
        weights = _place(context, builder, signature.args[4], along, [a, _constant(0)])
        halves: list[Any] = [None, None]  # two sums that need not wait for each other
        for number in range(SIZE):
            weight = _repeated(builder, builder.load(builder.gep(weights, [_constant(number)])))
            halves[number % 2] = _sum_of_product(builder, weight, _row(builder, place), halves[number % 2])
            place = builder.gep(place, [length])
        rest = _row(builder, _place(context, builder, signature.args[6], across, [b, _constant(0)]))
        total, lanes = builder.fmul(builder.fadd(*halves), rest), LANES
        while lanes > 1:
            lanes //= 2
            low, high = (_shuffled(builder, total, list(range(k, k + lanes))) for k in (0, lanes))
            total = builder.fadd(low, high)
        return builder.extract_element(total, ir.Constant(ir.IntType(32), 0))

    return types.float64(c, m, i, j, along, a, across, b), generated


_sums = compiled(fastmath={"contract"})


@_sums
def _interval(ends: Any, first: Any, per_length: float, x: float) -> int:
    """Interval between ends in which a coordinate lies, the first or last beyond them.

    ``first`` has the interval in which each of many equal parts of the whole length begins, so many per length.
    """
    share = (x - ends[0]) * per_length
    if not share > 0.0:
        return 0
    here, last = first[int(min(share, first.size - 1.0))], ends.size - 2
    while here < last and ends[here + 1] <= x:
        here += 1
    return here  # type: ignore[no-any-return]


@_sums
def _values(local: Any, pieces: Any, i: int, x: float, values: Any) -> None:
    """Values and derivatives (orders, lanes) of the B-splines that are not zero in an interval."""
    unit = local[1, i]
    u = (x - local[0, i]) * unit
    _b_splines(pieces, i, u, 0, 1.0, values)
    if values.shape[0] > 1:
        _b_splines(pieces, i, u, 1, unit, values)
    if values.shape[0] > 2:
        _b_splines(pieces, i, u, 2, unit * unit, values)


_vector, _block, _numbers = readable(numba.f8, 1), readable(numba.f8, 3), readable(numba.i8, 1)


@compiled(
    numba.void(
        *(_vector, _numbers, readable(numba.f8, 2), _block) * 2,
        *(_block, _vector, _vector, readable(numba.i8, 2), numba.f8[:, :, ::1]),
    ),
    fastmath={"contract"},
)
def evaluate(
    ends_t: Any,
    first_t: Any,
    local_t: Any,
    pieces_t: Any,
    ends_h: Any,
    first_h: Any,
    local_h: Any,
    pieces_h: Any,
    coefficients: Any,
    t: Any,
    h: Any,
    orders: Any,
    results: Any,
) -> None:
    """Derivatives of a spline.

    Parameters
    ----------
    ends_t, first_t, local_t, pieces_t, ends_h, first_h, local_h, pieces_h
        Of the intervals of both directions: their ends, the table of ``_interval``, their middles and one over their
        widths (2, interval), and the pieces as (interval, power, B-spline), with zeros up to ``LANES``.
    coefficients
        Of the B-splines (m, nt, nh), and ``LANES - SIZE`` numbers more at the end of every row, which do not count.
    t, h
        Points (n).
    orders
        Orders of the derivatives by both coordinates (d, 2), up to ``ORDER_LIMIT``.
    results
        For the derivatives (d, m, n).
    """
    along, across = np.empty((orders[:, 0].max() + 1, LANES)), np.empty((orders[:, 1].max() + 1, LANES))
    per_t, per_h = first_t.size / (ends_t[-1] - ends_t[0]), first_h.size / (ends_h[-1] - ends_h[0])
    for n in range(t.size):
        i, j = _interval(ends_t, first_t, per_t, t[n]), _interval(ends_h, first_h, per_h, h[n])
        _values(local_t, pieces_t, i, t[n], along)
        _values(local_h, pieces_h, j, h[n], across)
        for m in range(coefficients.shape[0]):
            for d in range(orders.shape[0]):
                results[d, m, n] = _sum(coefficients, m, i, j, along, orders[d, 0], across, orders[d, 1])
