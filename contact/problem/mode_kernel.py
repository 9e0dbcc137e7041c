# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
# cython: annotation_typing=False, infer_types=True
"""Blocks of a factor V, and modes in the order in which they are read.

Compiled; run as it stands here it gives the same bits.
"""

from __future__ import annotations

from typing import Any


def _root(parent: Any, column: int) -> int:
    """Column that stands for the group of a column."""
    while parent[column] != column:
        column = parent[column]
    return column


def label_blocks(
    factor: Any, row: Any, column: Any, rows: Any, filled: Any, parent: Any, number: Any
) -> tuple[int, bool]:
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
    filled, parent, number
        Room (n), (k), (k).

    Returns
    -------
    tuple
        Number of blocks, and whether each has a row without zeros.
    """
    size, width, blocks, zeros, left = factor.shape[0], factor.shape[1], 0, -1, 0
    for c in range(width):
        parent[c], number[c] = c, -1
    for i in range(size):
        first, entries = -1, 0
        for c in range(width):
            if factor[i, c] != 0.0:
                entries += 1
                if parent[c] != first:
                    other = _root(parent, c)
                    if first < 0:
                        first = other
                    elif other != first:
                        parent[other] = first
        row[i], rows[i], filled[i] = first, 0, entries
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
    for q in range(blocks):
        across, most = 0, 0
        for c in range(width):
            across += column[c] == q
        for i in range(size):
            if row[i] == q:
                most = max(most, filled[i])
        left += most < across
    return blocks, left == 0


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
