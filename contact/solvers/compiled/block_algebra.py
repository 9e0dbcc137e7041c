# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
# cython: annotation_typing=False, infer_types=True
"""Products, factors and solutions of small dense matrices, four rows at a time.

A matrix is a place ``at`` in an array and the distance ``stride`` from a row to the next. Compiled, see
``compiled_backend``, with the types in the file of the same name that ends in ``.pxd``.
"""

from __future__ import annotations

from typing import Any

import cython

if not cython.compiled:
    from numpy import sqrt


def row_products(
    matrix: Any, at: int, stride: int, rows: int, vector: Any, first: int, length: int, result: Any, out: int
) -> None:
    """Product of every row with a vector, each sum in four parts."""
    s = [0.0] * 16
    whole, a = length - length % 4, 0
    while a < rows:
        count = min(rows - a, 4)
        for k in range(16):
            s[k] = 0.0
        if count == 4:
            for x in range(0, whole, 4):
                for k in range(4):
                    for lane in range(4):
                        s[4 * k + lane] += matrix[at + k * stride + x + lane] * vector[first + x + lane]
        else:
            for k in range(count):
                for x in range(0, whole, 4):
                    for lane in range(4):
                        s[4 * k + lane] += matrix[at + k * stride + x + lane] * vector[first + x + lane]
        for k in range(count):
            total = (s[4 * k] + s[4 * k + 1]) + (s[4 * k + 2] + s[4 * k + 3])
            for x in range(whole, length):
                total += matrix[at + k * stride + x] * vector[first + x]
            result[out + a + k] = total
        a, at = a + 4, at + 4 * stride


def dot(one: Any, first: int, other: Any, second: int, length: int) -> float:
    """Sum of products, in four parts."""
    s = [0.0] * 4
    for k in range(4):
        s[k] = 0.0
    whole = length - length % 4
    for x in range(0, whole, 4):
        for lane in range(4):
            s[lane] += one[first + x + lane] * other[second + x + lane]
    total = (s[0] + s[1]) + (s[2] + s[3])
    for x in range(whole, length):
        total += one[first + x] * other[second + x]
    return total


def add_rows(
    matrix: Any, at: int, stride: int, rows: int, factor: Any, first: int, result: Any, out: int, length: int
) -> None:
    """Add the rows, each times its factor."""
    a = 0
    while a + 4 <= rows:
        c, d, e, f = factor[first + a], factor[first + a + 1], factor[first + a + 2], factor[first + a + 3]
        for x in range(length):
            result[out + x] += (
                c * matrix[at + x]
                + d * matrix[at + stride + x]
                + e * matrix[at + 2 * stride + x]
                + f * matrix[at + 3 * stride + x]
            )
        a, at = a + 4, at + 4 * stride
    while a < rows:
        c = factor[first + a]
        for x in range(length):
            result[out + x] += c * matrix[at + x]
        a, at = a + 1, at + stride


def products(
    one: Any, first: int, stride: int, rows: int, other: Any, second: int, other_stride: int, others: int,
    length: int, lower: bool, result: Any, out: int, width: int,
) -> None:  # fmt: skip
    """Products of rows with other rows, or the lower triangle of them.

    The number of rows is a multiple of four, and so many other rows can be read.
    """
    s = [0.0] * 16
    for a in range(0, rows, 4):
        for b in range(0, min(a + 1, others) if lower else others, 4):
            for k in range(16):
                s[k] = 0.0
            p, q = first + a * stride, second + b * other_stride
            for x in range(length):
                for i in range(4):
                    for j in range(4):
                        s[4 * i + j] += one[p + i * stride + x] * other[q + j * other_stride + x]
            for i in range(4):
                for j in range(min(4, others - b)):
                    result[out + (a + i) * width + b + j] = s[4 * i + j]


def gram(
    rows: Any, at: int, stride: int, count: int, length: int, result: Any, out: int, width: int, ones: int
) -> None:
    """Lower triangle of the products of rows with each other, and one more on so much of the diagonal."""
    products(rows, at, stride, count, rows, at, stride, count, length, True, result, out, width)
    for a in range(ones):
        result[out + a * (width + 1)] += 1.0


def eliminate(matrix: Any, at: int, stride: int, begin: int, end: int, size: int) -> None:
    """Rows of Cholesky's factor of a symmetric matrix of which the lower triangle is given, in place.

    Of the first ``size`` columns they are the factor, with one over its diagonal on the diagonal, behind that the Schur
    complement. All numbers are multiples of four; the rows before ``begin`` are done.
    """
    s = [0.0] * 16
    for i in range(begin, end, 4):
        p = at + i * stride
        for j in range(0, i + 1, 4):
            q = at + j * stride
            for a in range(4):
                for b in range(4):
                    s[4 * a + b] = matrix[p + a * stride + j + b]
            for t in range(min(j, size)):
                for a in range(4):
                    for b in range(4):
                        s[4 * a + b] -= matrix[p + a * stride + t] * matrix[q + b * stride + t]
            if j < size and i == j:
                for b in range(4):
                    for t in range(b):
                        s[5 * b] -= s[4 * b + t] * s[4 * b + t]
                    s[5 * b] = 1.0 / sqrt(s[5 * b])
                    for a in range(b + 1, 4):
                        for t in range(b):
                            s[4 * a + b] -= s[4 * a + t] * s[4 * b + t]
                        s[4 * a + b] *= s[5 * b]
            elif j < size:
                for b in range(4):
                    for t in range(b):
                        lower = matrix[q + b * stride + j + t]
                        for a in range(4):
                            s[4 * a + b] -= s[4 * a + t] * lower
                    inverse = matrix[q + b * stride + j + b]
                    for a in range(4):
                        s[4 * a + b] *= inverse
            for a in range(4):
                for b in range(4):
                    matrix[p + a * stride + j + b] = s[4 * a + b]


def forward(factor: Any, at: int, stride: int, size: int, right: Any, first: int) -> None:
    """Solve with the factor L, in place."""
    s = [0.0] * 4
    for i in range(0, size, 4):
        p = at + i * stride
        for a in range(4):
            s[a] = right[first + i + a]
        for t in range(i):
            value = right[first + t]
            for a in range(4):
                s[a] -= factor[p + a * stride + t] * value
        for a in range(4):
            for b in range(a):
                s[a] -= s[b] * factor[p + a * stride + i + b]
            s[a] *= factor[p + a * stride + i + a]
        for a in range(4):
            right[first + i + a] = s[a]


def backward(factor: Any, at: int, stride: int, size: int, right: Any, first: int) -> None:
    """Solve with the transpose of the factor L, in place."""
    s = [0.0] * 4
    for k in range(size // 4):
        i = size - 4 * k - 4
        p = at + i * stride
        for a in range(4):
            s[a] = right[first + i + a]
        for c in range(4):
            a = 3 - c
            for b in range(a + 1, 4):
                s[a] -= s[b] * factor[p + b * stride + i + a]
            s[a] *= factor[p + a * stride + i + a]
        for a in range(4):
            right[first + i + a] = s[a]
        for t in range(i):
            right[first + t] -= (
                s[0] * factor[p + t]
                + s[1] * factor[p + stride + t]
                + s[2] * factor[p + 2 * stride + t]
                + s[3] * factor[p + 3 * stride + t]
            )
