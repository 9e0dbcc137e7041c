"""Bending compliance in as few modes as it has: the factor V of C = diag(d) + V V^T, block by block and compressed.

Segments on different tooth pairs share no bending mode, so V has a zero pattern: groups of columns with disjoint rows.
Along a contact line the modes are smooth, so the rows of a group span a space of small numerical rank: a dozen of
eighty modes make up V V^T to all digits. The blocks U with U U^T = V V^T are what the modal solver works on.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dpstrf

Array = NDArray[np.float64]

#: What a dropped mode adds to a block of V V^T is below this times the greatest entry (or eigenvalue) of the block.
DROP_TOLERANCE = 1e-15


@dataclass(frozen=True, eq=False, slots=True)
class ModalBasis:
    """Blocks of a compressed factor, padded to the size of the largest.

    Attributes
    ----------
    index : (p, m) int array
        Segments of each block; n, the number of segments, where padded. Every segment is in one block.
    modes : (p, m, k) array
        U of each block [(mm/N)^0.5], zero where padded.
    """

    index: NDArray[np.intp]
    modes: Array


def modal_basis(factor: Array) -> ModalBasis:
    """Find the blocks of a factor and compress them.

    Parameters
    ----------
    factor : (n, k) array
        V [(mm/N)^0.5].

    Returns
    -------
    ModalBasis
    """
    blocks = factor_blocks(factor)
    compressed = [_compressed(factor[np.ix_(rows, columns)]) for rows, columns in blocks]
    longest = max(rows.size for rows, _ in blocks)
    rank = max(block.shape[1] for block in compressed)
    index = np.full((len(blocks), longest), factor.shape[0], dtype=np.intp)
    modes = np.zeros((len(blocks), longest, rank))
    for place, ((rows, _), block) in enumerate(zip(blocks, compressed, strict=True)):
        index[place, : rows.size] = rows
        modes[place, : rows.size, : block.shape[1]] = block
    return ModalBasis(index, modes)


def factor_blocks(factor: Array) -> list[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Find the groups of rows and columns that share no entry other than zero.

    Parameters
    ----------
    factor : (n, k) array

    Returns
    -------
    list of (rows, columns)
        Index arrays; every row is in one group. Rows of zeros make one group without columns.
    """
    present = factor != 0.0
    # Few patterns occur among many rows: compare patterns, not rows.
    packed = np.ascontiguousarray(np.packbits(present, axis=1))
    if packed.shape[1] == 0:
        return [(np.arange(factor.shape[0]), np.empty(0, dtype=np.intp))]
    keys = packed.view(np.dtype((np.void, packed.shape[1])))[:, 0]
    _, first, pattern = np.unique(keys, return_index=True, return_inverse=True)
    groups: list[tuple[NDArray[np.bool_], list[int]]] = []
    for number, row in enumerate(first):
        columns, members = present[row], [number]
        separate = []
        for group in groups:
            if (group[0] & columns).any():
                columns = group[0] | columns
                members += group[1]
            else:
                separate.append(group)
        groups = [*separate, (columns, members)]
    result = [(np.flatnonzero(np.isin(pattern, members)), np.flatnonzero(columns)) for columns, members in groups]
    return sorted(result, key=lambda block: int(block[0][0]))


def _compressed(block: Array) -> Array:
    """Return U with U U^T = V V^T up to rounding, of as few columns as that takes."""
    rows, columns = block.shape
    if rows <= 2 * columns:
        product = block @ block.T
        lower, pivot, rank, _info = dpstrf(product, tol=DROP_TOLERANCE * float(product.diagonal().max()), lower=1)
        compressed = np.zeros((rows, rank))
        compressed[pivot - 1] = np.tril(lower)[:, :rank]
        return compressed
    # What the small eigenvalues of V^T V lose in relative accuracy is of the size of rounding in V V^T.
    eigenvalues, vectors = np.linalg.eigh(block.T @ block)
    kept = eigenvalues > DROP_TOLERANCE * max(float(eigenvalues[-1]) if columns else 0.0, 0.0)
    return np.asarray(block @ vectors[:, kept])
