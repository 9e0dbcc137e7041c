"""Contact problems of a diagonal plus low-rank compliance as arrays: one row a problem, one column a tooth pair."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..problem.modal_basis import ModalBasis

Array = NDArray[np.float64]


class Amplitudes(NamedTuple):
    """Amplitudes of the modes of every block (b, p, k), and of the shared modes (b, s)."""

    own: Array
    shared: Array

    def part(self, chosen: NDArray[Any]) -> Amplitudes:
        """Return those of some of the problems."""
        return Amplitudes(self.own[chosen], self.shared[chosen])

    def moved(self, change: Amplitudes, length: float = 1.0) -> Amplitudes:
        """Return the amplitudes after a part of a change."""
        return Amplitudes(self.own + length * change.own, self.shared + length * change.shared)

    def put(self, chosen: NDArray[Any], values: Amplitudes) -> None:
        """Set those of some of the problems."""
        self.own[chosen], self.shared[chosen] = values

    def dot(self, other: Amplitudes) -> Array:
        """Return the products with others (b)."""
        return np.asarray(np.sum(self.own * other.own, axis=(1, 2)) + np.sum(self.shared * other.shared, axis=1))


class Loads(NamedTuple):
    """Loads of the modes, and moments of the blocks (b, p)."""

    amplitudes: Amplitudes
    moment: Array


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
        Of each segment (b, p, m, k + q + 1): modes, shared columns, lever arm; zero where padded.
    separation
        From first contact (b, p, m); positive where padded, so that nothing touches there.
    torque
        About the gear axis (b).
    mixing
        Of the shared columns (b, p, q, s); zero where padded.
    """

    sizes: NDArray[np.intp]
    segment: NDArray[np.intp]
    rows: Array
    separation: Array
    torque: Array
    mixing: Array

    @classmethod
    def of(
        cls, bases: Sequence[ModalBasis], lever_arms: Sequence[Array], separations: Sequence[Array], torque: Array
    ) -> ModalBatch:
        """Gather problems."""
        borders = [basis.border for basis in bases]
        blocks, longest, rank = np.array([basis.modes.shape for basis in bases]).max(axis=0)
        _, local, shared = np.array([border.mixing.shape for border in borders]).max(axis=0)
        sizes = np.array([basis.size for basis in bases])
        segment = np.tile(sizes[:, None, None], (1, blocks, longest))
        rows, mixing = np.zeros((*segment.shape, rank + local + 1)), np.zeros((len(bases), blocks, local, shared))
        for own, own_rows, own_mixing, basis, border in zip(segment, rows, mixing, bases, borders, strict=True):
            p, m, k = basis.modes.shape
            q, s = border.mixing.shape[1:]
            own[:p, :m] = basis.index
            own_rows[:p, :m, :k] = basis.modes
            own_rows[:p, :m, rank : rank + q] = np.pad(border.columns, ((0, 1), (0, 0)))[basis.index]
            own_mixing[:p, :q, :s] = border.mixing
        batch = cls(sizes, segment, rows, np.empty(0), np.asarray(torque, dtype=np.float64), mixing)
        rows[..., -1] = batch.in_blocks(lever_arms, 0.0)
        return replace(batch, separation=batch.in_blocks(separations, 1.0))

    @property
    def rank(self) -> int:
        """Number k of modes of a block."""
        return int(self.rows.shape[3] - self.mixing.shape[2] - 1)

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

    def closing(self, amplitudes: Amplitudes, rotation: Array) -> Array:
        """Return U c + W a - r theta of every segment, (b, p, m), of amplitudes and rotations (b)."""
        parts = [amplitudes.own]
        turn = np.broadcast_to(-rotation[:, None, None], (*amplitudes.own.shape[:2], 1))
        if self.mixing.shape[3]:
            parts.append((self.mixing @ amplitudes.shared[:, None, :, None])[..., 0])
        return np.asarray((self.rows @ np.concatenate([*parts, turn], axis=2)[..., None])[..., 0])

    def loads(self, force: Array) -> Loads:
        """Return [U W r]'F of forces (b, p, m)."""
        rank = self.rank
        every = (force[..., None, :] @ self.rows)[..., 0, :]
        shared = np.zeros((force.shape[0], self.mixing.shape[3]))
        if self.mixing.shape[3]:
            shared = self.mixed(every[..., rank:-1])
        return Loads(Amplitudes(every[..., :rank], shared), every[..., -1])

    def mixed(self, local: Array) -> Array:
        """Return the sum of M'x over the blocks (b, s), x (b, p, q) being of the shared columns."""
        return np.asarray((local[..., None, :] @ self.mixing)[..., 0, :].sum(axis=1))

    def start(self, force: Array, deflection: Array) -> tuple[Amplitudes, Array]:
        """Return amplitudes and rotations (b) at which the torque does the work of given forces.

        Parameters
        ----------
        force, deflection
            Forces (b, p, m) that balance a positive torque, not negative, and the local deflections they cause. At
            least one segment is then in contact: the forces weigh the gaps so that their mean is minus the local
            deflection.
        """
        amplitudes = self.loads(force).amplitudes
        work = np.sum(amplitudes.own**2, axis=(1, 2)) + np.sum(force * (self.separation + deflection), axis=(1, 2))
        return amplitudes, (work + np.sum(amplitudes.shared**2, axis=1)) / self.torque
