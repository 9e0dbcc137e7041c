"""Tensor splines at given points, compiled: the sums of B-splines of ``tensor_spline``, one point after another.

Six numbers side by side are taken as one row of eight: a processor multiplies and adds as many at once. Within the loop
over the points numbers are read from addresses: of an array that is handed on, numba counts the references, which takes
longer than the sums.
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
NUMBER_BYTES = 8
ROW_BYTES = LANES * NUMBER_BYTES

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


def _pointer(builder: Any, address: Any, kind: Any = _ROW) -> Any:
    """Pointer to a number or a row at an address."""
    return builder.inttoptr(address, kind.as_pointer())


def _row(builder: Any, pointer: Any) -> Any:
    """The row of numbers at a pointer."""
    row = builder.load(pointer)
    row.align = 8
    return row


@intrinsic  # type: ignore[untyped-decorator]
def _address(typing: Any, array: Any) -> Any:
    """Address of the first number of a contiguous array."""

    def generated(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        return builder.ptrtoint(data, _INTEGER)

    return types.int64(array), generated


@intrinsic  # type: ignore[untyped-decorator]
def _number(typing: Any, address: Any, index: Any) -> Any:
    """Number of an array from its address."""

    def generated(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        address, index = arguments
        return builder.load(builder.gep(_pointer(builder, address, ir.DoubleType()), [index]))

    return types.float64(address, index), generated


@intrinsic  # type: ignore[untyped-decorator]
def _whole_number(typing: Any, address: Any, index: Any) -> Any:
    """Whole number of an array from its address."""

    def generated(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        address, index = arguments
        return builder.load(builder.gep(_pointer(builder, address, _INTEGER), [index]))

    return types.int64(address, index), generated


@intrinsic  # type: ignore[untyped-decorator]
def _b_splines(typing: Any, pieces: Any, u: Any, order: Any, scale: Any, values: Any) -> Any:
    """Derivative of an order, times a scale, of the B-splines with pieces (power, lanes), into the row at ``values``.

    ``pieces`` and ``values`` are addresses.
    """
    if not isinstance(order, types.IntegerLiteral):
        return None
    degree_lost = order.literal_value

    def generated(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pieces, u, _, scale, values = arguments
        place, at, total = _pointer(builder, pieces), _repeated(builder, u), None
        for power in range(SIZE - 1, degree_lost - 1, -1):
            row = _row(builder, builder.gep(place, [_constant(power)]))
            if degree_lost:
                row = builder.fmul(row, ir.Constant(_ROW, [float(perm(power, degree_lost))] * LANES))
            total = row if total is None else _sum_of_product(builder, total, at, row)
        total = builder.fmul(total, _repeated(builder, scale))
        builder.store(total, _pointer(builder, values)).align = 8
        return context.get_dummy_value()

    return types.void(pieces, u, order, scale, values), generated


@intrinsic  # type: ignore[untyped-decorator]
def _sum(typing: Any, coefficients: Any, length: Any, along: Any, across: Any) -> Any:
    """Sum of the B-splines with coefficients in rows so long, of which the values are in two rows; all addresses."""

    def generated(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        coefficients, length, along, across = arguments
        place = _pointer(builder, coefficients, ir.DoubleType())
        weights = _pointer(builder, along, ir.DoubleType())
        halves: list[Any] = [None, None]  # two sums that need not wait for each other
        for number in range(SIZE):
            weight = _repeated(builder, builder.load(builder.gep(weights, [_constant(number)])))
            row = _row(builder, builder.bitcast(place, _ROW.as_pointer()))
            halves[number % 2] = _sum_of_product(builder, weight, row, halves[number % 2])
            place = builder.gep(place, [length])
        rest = _row(builder, _pointer(builder, across))
        total, lanes = builder.fmul(builder.fadd(*halves), rest), LANES
        while lanes > 1:
            lanes //= 2
            low, high = (_shuffled(builder, total, list(range(k, k + lanes))) for k in (0, lanes))
            total = builder.fadd(low, high)
        return builder.extract_element(total, ir.Constant(ir.IntType(32), 0))

    return types.float64(coefficients, length, along, across), generated


_sums = compiled(fastmath={"contract"})


@_sums
def _interval(ends: int, first: int, parts: int, last: int, per_length: float, x: float) -> int:
    """Interval between ends in which a coordinate lies, the first or last beyond them.

    ``first`` has the interval in which each of so many equal parts of the whole length begins, so many per length;
    ``last`` is the last interval. Arrays are given by their addresses.
    """
    share = (x - _number(ends, 0)) * per_length
    if not share > 0.0:
        return 0
    here = _whole_number(first, int(min(share, parts - 1.0)))
    while here < last and _number(ends, here + 1) <= x:
        here += 1
    return here  # type: ignore[no-any-return]


@_sums
def _values(local: int, count: int, pieces: int, i: int, x: float, orders: int, values: int) -> None:
    """Values and derivatives (orders, lanes) of the B-splines that are not zero in one of so many intervals.

    Arrays are given by their addresses.
    """
    unit = _number(local, count + i)
    u = (x - _number(local, i)) * unit
    pieces += i * SIZE * ROW_BYTES
    _b_splines(pieces, u, 0, 1.0, values)
    if orders > 1:
        _b_splines(pieces, u, 1, unit, values + ROW_BYTES)
    if orders > 2:
        _b_splines(pieces, u, 2, unit * unit, values + 2 * ROW_BYTES)


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
    count_t, count_h, components = ends_t.size - 1, ends_h.size - 1, coefficients.shape[0]
    length, size = coefficients.shape[2], coefficients.shape[1] * coefficients.shape[2] * NUMBER_BYTES
    at_along, at_across, at_coefficients = _address(along), _address(across), _address(coefficients)
    of_t = _address(ends_t), _address(first_t), _address(local_t), _address(pieces_t)
    of_h = _address(ends_h), _address(first_h), _address(local_h), _address(pieces_h)
    for n in range(t.size):
        i = _interval(of_t[0], of_t[1], first_t.size, count_t - 1, per_t, t[n])
        j = _interval(of_h[0], of_h[1], first_h.size, count_h - 1, per_h, h[n])
        _values(of_t[2], count_t, of_t[3], i, t[n], along.shape[0], at_along)
        _values(of_h[2], count_h, of_h[3], j, h[n], across.shape[0], at_across)
        place = at_coefficients + (i * length + j) * NUMBER_BYTES
        for m in range(components):
            for d in range(orders.shape[0]):
                row, column = at_along + orders[d, 0] * ROW_BYTES, at_across + orders[d, 1] * ROW_BYTES
                results[d, m, n] = _sum(place + m * size, length, row, column)
