"""Contact problems of a diagonal plus low-rank compliance as arrays: one row a problem, one column a tooth pair."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..problem.modal_basis import ModalBasis

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ModalBatch:
    """Several problems in blocks, padded to one size.

    Attributes
    ----------
    sizes
        Number of segments of each problem (b).
    segment
        Number of the segment that stands here (b, p, m); the number of segments where padded.
    rows
        Of each segment (b, p, m, k + 1): modes, then lever arm; zero where padded.
    separation
        From first contact (b, p, m); positive where padded, so that nothing touches there.
    torque
        About the gear axis (b).
    """

    sizes: NDArray[np.intp]
    segment: NDArray[np.intp]
    rows: Array
    separation: Array
    torque: Array

    @classmethod
    def of(
        cls, bases: Sequence[ModalBasis], lever_arms: Sequence[Array], separations: Sequence[Array], torque: Array
    ) -> ModalBatch:
        """Gather problems."""
        blocks, longest, rank = np.array([basis.modes.shape for basis in bases]).max(axis=0)
        sizes = np.array([basis.size for basis in bases])
        segment = np.tile(sizes[:, None, None], (1, blocks, longest))
        rows = np.zeros((*segment.shape, rank + 1))
        for own, own_rows, basis in zip(segment, rows, bases, strict=True):
            p, m, k = basis.modes.shape
            own[:p, :m] = basis.index
            own_rows[:p, :m, :k] = basis.modes
        batch = cls(sizes, segment, rows, np.empty(0), np.asarray(torque, dtype=np.float64))
        rows[..., -1] = batch.in_blocks(lever_arms, 0.0)
        return cls(sizes, segment, rows, batch.in_blocks(separations, 1.0), batch.torque)

    def in_blocks(self, values: Sequence[Array], padding: float) -> Array:
        """Return values of the segments of every problem in blocks, (b, p, m)."""
        return np.stack([np.append(own, padding)[number] for own, number in zip(values, self.segment, strict=True)])

    def by_segments(self, values: Array) -> list[Array]:
        """Return values in blocks (b, p, m) as an array (n) for every problem."""
        result = []
        for size, number, own in zip(self.sizes, self.segment, values, strict=True):
            flat = np.zeros(size + 1)
            flat[number] = own
            result.append(flat[:-1])
        return result

    def part(self, chosen: NDArray[Any]) -> ModalBatch:
        """Return some of the problems."""
        return ModalBatch(*(getattr(self, field.name)[chosen] for field in fields(self)))

    def closing(self, amplitudes: Array, rotation: Array) -> Array:
        """Return U c - r theta of every segment, (b, p, m), of amplitudes (b, p, k) and rotations (b)."""
        turn = np.broadcast_to(-rotation[:, None, None], (*amplitudes.shape[:2], 1))
        return np.asarray((self.rows @ np.concatenate([amplitudes, turn], axis=2)[..., None])[..., 0])

    def loads(self, force: Array) -> Array:
        """Return [U r]'F of every block, (b, p, k + 1), of forces (b, p, m)."""
        return (force[..., None, :] @ self.rows)[..., 0, :]

    def start(self, force: Array, deflection: Array) -> tuple[Array, Array]:
        """Return amplitudes (b, p, k) and rotations (b) at which the torque does the work of given forces.

        Parameters
        ----------
        force, deflection
            Forces (b, p, m) that balance a positive torque, not negative, and the local deflections they cause. At
            least one segment is then in contact: the forces weigh the gaps so that their mean is minus the local
            deflection.
        """
        amplitudes = self.loads(force)[..., :-1]
        work = np.sum(amplitudes**2, axis=(1, 2)) + np.sum(force * (self.separation + deflection), axis=(1, 2))
        return amplitudes, work / self.torque
