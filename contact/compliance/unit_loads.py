"""Unit loads on the segments of a mesh cycle, and the bending compliance at a mesh position by modes of tooth pairs.

Segments on different tooth pairs are coupled through the bodies of the members alone.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..problem.modal_basis import ModalBasis, basis_of_blocks, compressed_block
from .body_coupling import BodyCoupling

Array = NDArray[Any]


@dataclass(frozen=True)
class Loads:
    """Unit loads on segments (n).

    Parameters
    ----------
    own
        Whitened, in parts (n, k): the inner products of rows, summed over the parts, are bending compliances of
        segments on one tooth pair. They are not one array, which would take longer to fill than to use.
    on_bodies
        In the modes of the bodies of both members (n, q).
    """

    own: tuple[Array, ...]
    on_bodies: Array


@dataclass(frozen=True)
class UnitLoads:
    """Unit loads on both teeth, and the bodies through which tooth pairs are coupled.

    Parameters
    ----------
    on_lines
        Of the segments of contact lines (n).
    on_edges
        Of pieces of edges (m), whose numbers follow those of the segments of lines; ``None`` for none.
    coupling
        Of tooth pairs through the bodies; ``None`` if each tooth has a body of its own.
    known
        Compressed blocks of segments of lines, by the numbers of these: kept for the next mesh with other edges.
    """

    on_lines: Loads
    on_edges: Loads | None = None
    coupling: BodyCoupling | None = None
    known: dict[bytes, Array] = field(default_factory=dict, repr=False, compare=False)

    def with_edges(self, on_edges: Loads) -> UnitLoads:
        """The same contact lines with pieces of edges."""
        return replace(self, on_edges=on_edges)

    def bending(self, pairs: NDArray[np.int64], rows: NDArray[np.int64]) -> ModalBasis:
        """Bending compliance of the segments (s) of a mesh position.

        Parameters
        ----------
        pairs
            Their tooth pairs (s).
        rows
            Their numbers (s), those on lines before those on edges.
        """
        numbers = np.unique(pairs)
        blocks = [np.flatnonzero(pairs == pair) for pair in numbers]
        shared = None
        if self.coupling is not None:
            on_edges = None if self.on_edges is None else self.on_edges.on_bodies
            shared = self.coupling.shared_modes(numbers, blocks, _rows(rows, self.on_lines.on_bodies, on_edges))
        return basis_of_blocks(pairs.size, blocks, [self._compressed(rows[own]) for own in blocks], shared)

    def _compressed(self, rows: NDArray[np.int64]) -> Array:
        """Modes of one tooth pair with the segments of given numbers (s)."""
        if self.on_edges is not None and np.any(rows >= len(self.on_lines.on_bodies)):
            return compressed_block(self._own(rows))
        key = rows.tobytes()
        if key not in self.known:
            self.known[key] = compressed_block(self._own(rows))
        return self.known[key]

    def _own(self, rows: NDArray[np.int64]) -> Array:
        lines = self.on_lines.own
        edges = (None,) * len(lines) if self.on_edges is None else self.on_edges.own
        return np.concatenate([_rows(rows, *parts) for parts in zip(lines, edges, strict=True)], axis=1)


def _rows(rows: NDArray[np.int64], lines: Array, edges: Array | None) -> Array:
    """Rows of given numbers (s), in any order of lines and edges."""
    if edges is None or not np.any(on_edges := rows >= len(lines)):
        return lines[rows]
    result = np.empty((rows.size, lines.shape[1]))
    result[~on_edges], result[on_edges] = lines[rows[~on_edges]], edges[rows[on_edges] - len(lines)]
    return result
