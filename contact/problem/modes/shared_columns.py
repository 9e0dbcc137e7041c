"""Columns of a factor that couple groups of segments which else fall apart, such as modes of shafts and housing.

They are found by counting: an entry is zero or it is not.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Work with shared columns set apart, over that with all columns in one block, below which it is worth while.
WORTHWHILE_WORK = 0.8
#: Size of a direction left out, relative to the largest.
DIRECTION_TOLERANCE = 1e-15


def shared_columns(factor: Array) -> NDArray[np.bool_]:
    """Return the columns of a factor that couple groups of rows, if setting them apart saves work enough, (k).

    Columns are taken in turn, those of the fewest entries first. One that meets rows of a single group extends it; one
    that meets rows of several groups couples them.

    Parameters
    ----------
    factor
        V (n, k).
    """
    size, width = factor.shape
    none = np.zeros(width, dtype=np.bool_)
    present = factor != 0.0
    if width < 3 or present.all():
        return none
    # Few patterns occur among many rows.
    patterns, rows = np.unique(present, axis=0, return_counts=True)
    entries = rows @ patterns
    group, coupling, groups = np.full(rows.size, -1), none.copy(), 0
    for column in np.argsort(entries, kind="stable"):
        own = patterns[:, column]
        met = np.unique(group[own & (group >= 0)])
        if met.size > 1:
            coupling[column] = True
        elif own.any():
            number = met[0] if met.size else groups
            groups += not met.size
            group[own] = number
    if not coupling.any():
        return none
    shared = int(np.count_nonzero(coupling))
    owned = [group == number for number in range(groups)]
    split = [
        _work(int(rows[own].sum()), int(np.count_nonzero(patterns[own][:, ~coupling].any(axis=0))), shared)
        for own in owned
    ]
    return coupling if sum(split) + shared**3 / 3 < WORTHWHILE_WORK * _work(size, width, 0) else none


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
