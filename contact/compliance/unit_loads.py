"""Unit loads on the segments of a mesh cycle, and the bending compliance at a mesh position by modes of tooth pairs.

Segments on different tooth pairs are coupled through the blanks alone, which are taken as rigid.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..problem.modal_basis import ModalBasis, basis_of_blocks, compressed_block

Array = NDArray[Any]


@dataclass(frozen=True)
class UnitLoads:
    """Whitened unit loads of both teeth: the inner products of rows are bending compliances.

    Parameters
    ----------
    on_lines
        Of the segments of contact lines (n, k).
    on_edges
        Of pieces of edges (m, k), whose numbers follow those of the segments of lines; ``None`` for none.
    known
        Compressed blocks of segments of lines, by the numbers of these: kept for the next mesh with other edges.
    """

    on_lines: Array
    on_edges: Array | None = None
    known: dict[bytes, Array] = field(default_factory=dict, repr=False, compare=False)

    def with_edges(self, on_edges: Array) -> UnitLoads:
        """The same contact lines with pieces of edges."""
        return UnitLoads(self.on_lines, on_edges, self.known)

    def bending(self, pairs: NDArray[np.int64], rows: NDArray[np.int64]) -> ModalBasis:
        """Bending compliance of the segments (s) of a mesh position.

        Parameters
        ----------
        pairs
            Their tooth pairs (s).
        rows
            Their numbers (s), those on lines before those on edges.
        """
        blocks = [np.flatnonzero(pairs == pair) for pair in np.unique(pairs)]
        return basis_of_blocks(pairs.size, blocks, [self._compressed(rows[own]) for own in blocks])

    def _compressed(self, rows: NDArray[np.int64]) -> Array:
        """Modes of one tooth pair with the segments of given numbers (s)."""
        first = len(self.on_lines)
        count = int(np.searchsorted(rows >= first, True))
        if count < rows.size:
            assert self.on_edges is not None
            return compressed_block(np.concatenate([self.on_lines[rows[:count]], self.on_edges[rows[count:] - first]]))
        key = rows.tobytes()
        if key not in self.known:
            self.known[key] = compressed_block(self.on_lines[rows])
        return self.known[key]
