"""Bending modes as the compiled contact solution reads them: block by block, and again for a part of the segments.

On level 0 stand all segments, on level 1 every eighth of each block, on level 2 every eighth of these. Places are
numbers of segments in the order of the blocks; a mode of a block is contiguous in ``columns``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..problem.modal_basis import ModalBasis

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

#: One segment stands for so many on the next level.
STRIDE = 8
#: A level has at least so many segments for every mode.
FEWEST_SEGMENTS_PER_MODE = 0.7
LEVELS = 4


class ModeColumns(NamedTuple):
    """Modes of one or several problems.

    Attributes
    ----------
    ranges
        First block, end of the blocks, first segment and number of segments of each problem (p, 4).
    places
        Highest level of each problem, then its first place on every level (1 + l, p).
    blocks
        On every level, of each block: first place, number of segments, first entry of ``columns``, number of modes
        (l, q, 4); places count from the first of the problem.
    order
        Segment at each place, on one level after the other.
    columns
        Modes of each block, one after the other [(mm/N)^0.5].
    bending
        Diagonal of U U' (n) [mm/N], by segments.
    row_sum
        Row sums of U U' (n) [mm/N], by segments.
    """

    ranges: Whole
    places: Whole
    blocks: Whole
    order: Whole
    columns: Array
    bending: Array
    row_sum: Array


def mode_columns(bases: Sequence[ModalBasis]) -> ModeColumns:
    """Gather the modes of problems."""
    count = sum(basis.index.shape[0] for basis in bases)
    ranges = np.zeros((len(bases), 4), dtype=np.int64)
    places = np.zeros((1 + LEVELS, len(bases)), dtype=np.int64)
    blocks = np.zeros((LEVELS, count, 4), dtype=np.int64)
    order: list[NDArray[np.intp]] = []
    columns: list[Array] = []
    bending, row_sum = [], []
    q = segment = entry = place = 0
    for own, basis in enumerate(bases):
        parts = [(index[index < basis.size], modes[index < basis.size]) for index, modes in _blocks(basis)]
        ranges[own] = q, q + len(parts), segment, basis.size
        squares, sums = np.zeros(basis.size), np.zeros(basis.size)
        for index, modes in parts:
            squares[index] = np.einsum("ij,ij->i", modes, modes)
            sums[index] = modes @ modes.sum(axis=0)
        bending.append(squares)
        row_sum.append(sums)
        for level in range(LEVELS):
            stride = STRIDE**level
            chosen = [(index[stride // 2 :: stride], modes[stride // 2 :: stride]) for index, modes in parts]
            if level and any(index.size < FEWEST_SEGMENTS_PER_MODE * modes.shape[1] + 1 for index, modes in chosen):
                break
            places[0, own], places[1 + level, own] = level, place
            first = 0
            for number, (index, modes) in enumerate(chosen):
                blocks[level, q + number] = first, index.size, entry, modes.shape[1]
                order.append(index)
                columns.append(modes.T.ravel())
                first, entry = first + index.size, entry + modes.size
            place += first
        q, segment = q + len(parts), segment + basis.size
    return ModeColumns(
        ranges,
        places,
        blocks,
        np.concatenate(order).astype(np.int64),
        np.concatenate(columns),
        np.concatenate(bending),
        np.concatenate(row_sum),
    )


def _blocks(basis: ModalBasis) -> list[tuple[NDArray[np.intp], Array]]:
    """Segments and modes of every block, columns of zeros left out."""
    return [
        (index, modes[:, modes.any(axis=0)]) for index, modes in zip(basis.index, basis.modes, strict=True)
    ]
