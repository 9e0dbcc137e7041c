"""Bending modes as the compiled contact solution reads them: block by block, and again for a part of the segments.

On level 0 stand all segments, on level 1 every fourth of each block, on level 2 every fourth of these. Places are
numbers of segments in the order of the blocks; a mode of a block is contiguous in ``columns``, and so is a shared
column on its segments, behind the modes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

#: One segment stands for so many on the next level.
STRIDE = 4
#: On every level a block has at least so many segments.
FEWEST_SEGMENTS = 4
MAX_LEVELS = 5


class ModeColumns(NamedTuple):
    """Modes of one compliance.

    Attributes
    ----------
    places
        First place of every level in ``order`` (l).
    blocks
        On every level, of each block: first place from that of the level, number of segments, first entry of
        ``columns``, number of modes (l, q, 4).
    order
        Segment at each place, one level after the other.
    columns
        Modes of each block, one after the other [(mm/N)^0.5], and the shared columns of its segments.
    sums
        Diagonal and row sums of U U', diagonal of W W', and what that would be if no terms of W cancelled (4, n)
        [mm/N], by segments; the last two only with shared modes.
    mixing
        Of the shared columns (q, j, s); (q, 0, 0) without shared modes.
    """

    places: Whole
    blocks: Whole
    order: Whole
    columns: Array
    sums: Array
    mixing: Array


def mode_columns(
    size: int,
    blocks: Sequence[tuple[NDArray[np.intp], Array]],
    shared_columns: Array,
    mixing: Array,
    shared_factor: Array,
) -> ModeColumns:
    """Arrange modes.

    Parameters
    ----------
    size
        Number of segments n.
    blocks
        Segments (m) and modes (m, k) of every block [(mm/N)^0.5].
    shared_columns, mixing
        Of the shared modes (n, j) and (q, j, s).
    shared_factor
        W (n, s) [(mm/N)^0.5]; the shared columns themselves where the mixing is one of ones.
    """
    sums = np.zeros((4 if mixing.shape[2] else 2, size))
    for index, modes in blocks:
        sums[0, index] = np.einsum("ij,ij->i", modes, modes)
        sums[1, index] = modes @ modes.sum(axis=0)
    shortest = min(index.size for index, _ in blocks)
    levels = 1
    while levels < MAX_LEVELS and shortest // STRIDE**levels >= FEWEST_SEGMENTS:
        levels += 1
    places, table = np.zeros(levels, dtype=np.int64), np.zeros((levels, len(blocks), 4), dtype=np.int64)
    order: list[NDArray[np.intp]] = []
    columns: list[Array] = []
    place = entry = 0
    for level in range(levels):
        places[level], first = place, 0
        chosen = slice(STRIDE**level // 2, None, STRIDE**level)
        for number, (index, modes) in enumerate(blocks):
            own, part = index[chosen], modes[chosen]
            table[level, number] = first, own.size, entry, modes.shape[1]
            order.append(own)
            columns.append(part.T.ravel())
            first, entry = first + own.size, entry + part.size
            if shared_columns.shape[1]:
                columns.append(shared_columns[own].T.ravel())
                entry += columns[-1].size
        place += first
    whole = np.concatenate(order).astype(np.int64)
    if mixing.shape[2]:
        sums[2:] = np.einsum("ij,ij->i", shared_factor, shared_factor)
        if shared_factor is not shared_columns:
            for (index, _), own_mixing in zip(blocks, np.abs(mixing), strict=True):
                terms = np.abs(shared_columns[index]) @ own_mixing
                sums[3, index] = np.einsum("ij,ij->i", terms, terms)
    return ModeColumns(places, table, whole, np.concatenate(columns), sums, np.ascontiguousarray(mixing))
