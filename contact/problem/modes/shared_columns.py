"""Columns of a factor that couple groups of segments which else fall apart, such as modes of shafts and housing.

They are found by counting: an entry is zero or it is not.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Work with shared columns set apart, over that with all columns in one block, below which it is worth while.
WORTHWHILE_WORK = 0.8
#: Size of a direction left out, relative to the largest.
DIRECTION_TOLERANCE = 1e-15


def shared_columns(factor: Array, blocks: Sequence[tuple[NDArray[np.intp], NDArray[np.intp]]]) -> NDArray[np.bool_]:
    """Return the columns of a factor that couple groups of rows, if setting them apart saves work enough, (k).

    Parameters
    ----------
    factor
        V (n, k).
    blocks
        Rows and columns that share no entry with others, see ``factor_blocks``.
    """
    shared = np.zeros(factor.shape[1], dtype=np.bool_)
    work, split_work = 0.0, 0.0
    for rows, columns in blocks:
        own = _work(rows.size, columns.size, 0)
        present = part_of(factor, rows, columns) != 0.0
        if present.all():
            work, split_work = work + own, split_work + own
            continue
        order = np.argsort(np.count_nonzero(present, axis=0), kind="stable")
        present, columns = present[:, order], columns[order]
        coupling, split = _coupling(present)
        work, split_work = work + own, split_work + (split if coupling.any() else own)
        shared[columns[coupling]] = True
    count = int(np.count_nonzero(shared))
    return shared if not count or split_work + count**3 / 3 < WORTHWHILE_WORK * work else np.zeros_like(shared)


def part_of(factor: Array, rows: NDArray[np.intp], columns: NDArray[np.intp]) -> Array:
    """Some rows and columns of a factor, in ascending order; no copy where they are all in a row."""
    both = [slice(one[0], one[-1] + 1) if one.size and one[-1] - one[0] < one.size else one for one in (rows, columns)]
    return factor[both[0]][:, both[1]]


def _coupling(present: NDArray[np.bool_]) -> tuple[NDArray[np.bool_], float]:
    """Columns that couple groups of rows (k), and the work with these set apart.

    Columns are taken in turn, those of the fewest entries first. One that meets rows of a single group extends it; one
    that meets rows of several groups couples them.

    Parameters
    ----------
    present
        Which entries are not zero (n, k), columns of fewer entries first.
    """
    coupling = np.zeros(present.shape[1], dtype=np.bool_)
    if not (present[:, :-1] & ~present[:, 1:]).any():  # each column has the entries of the one before
        return coupling, 0.0
    # Few patterns occur among many rows. Sets of patterns are bits of a whole number.
    patterns, rows = np.unique(present, axis=0, return_counts=True)
    sets = [int.from_bytes(own.tobytes(), "little") for own in np.packbits(patterns.T, axis=1, bitorder="little")]
    groups: list[tuple[int, int]] = []  # patterns and number of columns of each
    for column, own in enumerate(sets):
        met = [group for group in groups if group[0] & own]
        if len(met) > 1:
            coupling[column] = True
        elif met:
            groups[groups.index(met[0])] = (met[0][0] | own, met[0][1] + 1)
        else:
            groups.append((own, 1))
    shared = int(np.count_nonzero(coupling))
    sizes = [sum(int(count) for bit, count in enumerate(rows) if group >> bit & 1) for group, _ in groups]
    return coupling, sum(_work(size, own, shared) for size, (_, own) in zip(sizes, groups, strict=True))


def _work(segments: int, own: int, shared: int) -> float:
    """Operations on a block of so many segments, modes of its own and shared modes."""
    return float(segments * (min(segments, own) + min(segments, shared)) ** 2)


def few_directions(rows: Array) -> tuple[Array, Array]:
    """Return orthonormal Q (m, r) and M (r, s) with Q M = W up to rounding, for the rows W (m, s) of one block."""
    from scipy.linalg import qr  # the contact problem itself needs no scipy

    directions, triangle, order = qr(rows, mode="economic", pivoting=True)
    sizes = np.abs(triangle.diagonal())
    rank = int(np.count_nonzero(sizes > DIRECTION_TOLERANCE * sizes.max(initial=0.0)))
    mixing = np.empty((rank, rows.shape[1]))
    mixing[:, order] = triangle[:rank]
    return np.ascontiguousarray(directions[:, :rank]), mixing
