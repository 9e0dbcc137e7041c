# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
# cython: annotation_typing=False, infer_types=True
"""Blocks of a factor V, each in as few modes as it has, and modes in the order in which they are read.

Compiled; run as it stands here it gives the same bits.
"""

from __future__ import annotations

import math
from typing import Any

import cython

if not cython.compiled:
    from numpy import sqrt

INFINITY = math.inf


def _root(parent: Any, column: int) -> int:
    """Column that stands for the group of a column."""
    while parent[column] != column:
        column = parent[column]
    return column


def label_blocks(factor: Any, row: Any, column: Any, rows: Any, parent: Any, number: Any) -> tuple[int, bool]:
    """Number groups of rows and columns that share no entry but zero, in the order of their first rows.

    Parameters
    ----------
    factor
        V (n, k).
    row, column
        For the number of the block of each row (n) and column (k): -1 of a column of zeros. Rows of zeros make one
        block together.
    rows
        For the number of rows of each block (n).
    parent, number
        Room (k).

    Returns
    -------
    tuple
        Number of blocks, and whether no entry in a block is zero.
    """
    size, width, entries, area, blocks, zeros = factor.shape[0], factor.shape[1], 0, 0, 0, -1
    for c in range(width):
        parent[c], number[c] = c, -1
    for i in range(size):
        first, rows[i] = -1, 0
        for c in range(width):
            if factor[i, c] != 0.0:
                entries += 1
                other = _root(parent, c)
                if first < 0:
                    first = other
                elif other != first:
                    parent[other] = first
        row[i] = first
    for i in range(size):
        if row[i] < 0:
            if zeros < 0:
                zeros, blocks = blocks, blocks + 1
            row[i] = zeros
        else:
            first = _root(parent, row[i])
            if number[first] < 0:
                number[first], blocks = blocks, blocks + 1
            row[i] = number[first]
        rows[row[i]] += 1
    for c in range(width):
        column[c] = number[_root(parent, c)]
        if column[c] >= 0:
            area += rows[column[c]]
    return blocks, entries == area


def _pivoted(block: Any, size: int, width: int, most: int, tolerance: float, left: Any, modes: Any) -> int:
    """Modes (r, m) of the rows of a block (m, w), contiguous: Cholesky's factor of their products, with pivots.

    No more columns of these products are formed than there are modes; ``left`` (m) is for what is left of their
    diagonal. Returns the number of modes, or one more than ``most``.
    """
    largest = 0.0
    for i in range(size):
        left[i] = _dot(block, i * width, i * width, width)
        largest = max(largest, left[i])
    least = tolerance * largest
    for rank in range(most + 1):
        largest, pivot = least, -1
        for i in range(size):
            if left[i] > largest:
                largest, pivot = left[i], i
        if pivot < 0:
            return rank
        if rank == most:
            break
        at = rank * size
        _rows(block, size, width, pivot * width, modes, at)
        for t in range(rank):
            factor = modes[t * size + pivot]
            for i in range(size):
                modes[at + i] -= factor * modes[t * size + i]
        root = sqrt(largest)
        for i in range(size):
            if left[i] > -INFINITY:
                modes[at + i] /= root
                left[i] -= modes[at + i] * modes[at + i]
            else:  # a pivot before
                modes[at + i] = 0.0
        modes[at + pivot], left[pivot] = root, -INFINITY
    return most + 1


def _dot(block: Any, first: int, second: int, length: int) -> float:
    """Sum of products, in four parts; the length is a multiple of four."""
    s = [0.0] * 4
    for k in range(4):
        s[k] = 0.0
    for x in range(0, length, 4):
        for lane in range(4):
            s[lane] += block[first + x + lane] * block[second + x + lane]
    return (s[0] + s[1]) + (s[2] + s[3])


def _rows(block: Any, size: int, width: int, other: int, result: Any, out: int) -> None:
    """Product of every row of a block with one of them."""
    s = [0.0] * 16
    whole = size - size % 4
    for i in range(0, whole, 4):
        at = i * width
        for k in range(16):
            s[k] = 0.0
        for x in range(0, width, 4):
            for k in range(4):
                for lane in range(4):
                    s[4 * k + lane] += block[at + k * width + x + lane] * block[other + x + lane]
        for k in range(4):
            result[out + i + k] = (s[4 * k] + s[4 * k + 1]) + (s[4 * k + 2] + s[4 * k + 3])
    for i in range(whole, size):
        result[out + i] = _dot(block, i * width, other, width)


def compress(
    factor: Any, row: Any, column: Any, q: int, most: int, tolerance: float, index: Any, chosen: Any, room: Any,
    modes: Any,
) -> tuple[int, int]:  # fmt: skip
    """Compress one block of a factor.

    Parameters
    ----------
    factor
        V (n, k).
    row, column, q
        As `label_blocks` has them, and the number of the block.
    most
        Most modes of a block.
    tolerance
        Largest part of the diagonal of V V' that is left out, relative to its greatest entry.
    index
        For the rows of the block (n), the first of them.
    chosen, room
        Room (k), and (n (k + 4)).
    modes
        For the modes (r, m), the first of (32 n).

    Returns
    -------
    tuple
        Number of rows and of modes: one more than ``most`` where these do not suffice.
    """
    size, count, across = factor.shape[0], 0, 0
    for i in range(size):
        if row[i] == q:
            index[count], count = i, count + 1
    for c in range(factor.shape[1]):
        if column[c] == q:
            chosen[across], across = c, across + 1
    padded = 4 * ((across + 3) // 4)
    for i in range(count):
        for c in range(across):
            room[size + i * padded + c] = factor[index[i], chosen[c]]
        for c in range(across, padded):
            room[size + i * padded + c] = 0.0
    return count, _pivoted(room[size:], count, padded, most, tolerance, room, modes)


def arrange(
    segments: Any, modes: Any, shared: Any, begin: int, step: int, count: int, place: int, entry: int, order: Any,
    columns: Any,
) -> None:  # fmt: skip
    """Put every so many segments of a block, and their modes one after another, where they are read.

    Parameters
    ----------
    segments, modes
        Of the block: its segments (m), and its modes (m, r).
    shared
        Columns of shared modes (n, j), which stand behind.
    begin, step, count
        First segment, distance and number of those that are taken.
    place, entry
        Of the first of them in ``order``, and of their modes in ``columns``.
    order, columns
        To be filled.
    """
    for x in range(count):
        order[place + x] = segments[begin + x * step]
    for a in range(modes.shape[1]):
        for x in range(count):
            columns[entry + x] = modes[begin + x * step, a]
        entry += count
    for a in range(shared.shape[1]):
        for x in range(count):
            columns[entry + x] = shared[order[place + x], a]
        entry += count
