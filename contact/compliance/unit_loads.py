"""Unit loads on the segments of a mesh cycle, and the bending compliance at a mesh position by modes of tooth pairs.

Segments on different tooth pairs are coupled through the bodies of the members alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from ..problem.modal_basis import ModalBasis, basis_of_blocks, compressed_block
from .body_coupling import BodyCoupling

Array = NDArray[Any]


@frozen_arrays
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


@frozen_arrays
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
            shared = self.coupling.shared_modes(numbers, blocks, self._rows(rows, lambda loads: (loads.on_bodies,)))
        return basis_of_blocks(pairs.size, blocks, [self._compressed(rows[own]) for own in blocks], shared)

    def _compressed(self, rows: NDArray[np.int64]) -> Array:
        """Modes of one tooth pair with the segments of given numbers (s)."""
        key = rows.tobytes()
        if key in self.known:
            return self.known[key]
        compressed = compressed_block(self._rows(rows, lambda loads: loads.own))
        if np.all(rows < len(self.on_lines.on_bodies)):
            self.known[key] = compressed
        return compressed

    def _rows(self, rows: NDArray[np.int64], parts: Callable[[Loads], tuple[Array, ...]]) -> Array:
        """Rows of given numbers (s), those on lines first, of parts of the loads side by side."""
        lines = parts(self.on_lines)
        count = int(np.count_nonzero(rows < len(lines[0])))
        result = np.empty((rows.size, sum(part.shape[1] for part in lines)))
        np.concatenate([part[rows[:count]] for part in lines], axis=1, out=result[:count])
        if count < rows.size:
            assert self.on_edges is not None
            beyond = rows[count:] - len(lines[0])
            np.concatenate([part[beyond] for part in parts(self.on_edges)], axis=1, out=result[count:])
        return result
