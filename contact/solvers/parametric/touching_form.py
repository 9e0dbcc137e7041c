"""Form in which the system of the touching segments is solved: dense, or in the bending modes.

In the bending modes C = diag(d) + U U', d > 0. With the amplitudes z = U'F of the modes, block by block, the forces are
F = w (g + r theta - U z), w = 1/d where a segment touches and zero elsewhere, and

    (I + U'w U) z - U'w r theta = U'w g,    r'w r theta - r'w U z = T - r'w g.

A segment that enters or leaves changes the small matrix of its block by one of rank one: O(k^2), and O(n k) a solve.
Modes that all blocks share, W_i = G_i M_b in block b, have amplitudes y = W'F beside these; what the modes of a block
leave on G and r is summed over the blocks, see ``newton_kernel``.
"""

from __future__ import annotations

import numpy as np

from ....core.arrays import Bools, Integers, RealArray as Array
from ...problem.compliance_matrix import ComplianceMatrix, ModalCompliance
from ...problem.modal_basis import ModalBasis
from ..compiled.compiled_answer import SMALLEST_LOCAL_FRACTION
from ..touching_system import DenseTouching, TouchingAnswer, TouchingFactor

#: Changes after which the matrices are summed anew.
MAX_UPDATES = 64


class ModalTouching:
    """The system of `DenseTouching` for a local compliance d (n) [mm/N], positive, and modes."""

    def __init__(self, local: Array, basis: ModalBasis, lever_arm: Array, active: Bools) -> None:
        self._local, self._arm = local, lever_arm
        self._index, border = basis.index, basis.border
        blocks, longest, rank = basis.modes.shape
        self._rank, self._mixing = rank, border.mixing
        self._rows = np.zeros((blocks, longest, rank + border.mixing.shape[1] + 1))
        self._rows[..., :rank] = basis.modes
        self._rows[..., rank:-1] = np.pad(border.columns, ((0, 1), (0, 0)))[basis.index]
        self._rows[..., -1] = np.append(lever_arm, 0.0)[basis.index]
        self._block, self._place = np.zeros(basis.size, dtype=np.intp), np.zeros(basis.size, dtype=np.intp)
        real = basis.index < basis.size
        block, place = np.nonzero(real)
        self._block[basis.index[real]], self._place[basis.index[real]] = block, place
        self._active = np.array(active, dtype=np.bool_)
        self._sum()

    @property
    def active(self) -> Bools:
        """See `DenseTouching`."""
        return self._active.copy()

    def enter(self, segment: int) -> bool:
        """See `DenseTouching`."""
        return self._change(segment, True)

    def leave(self, segment: int) -> bool:
        """See `DenseTouching`."""
        return self._change(segment, False)

    def solve(self, closing: Array, torque: Array) -> TouchingAnswer:
        """See `DenseTouching`."""
        count = torque.size
        wide = np.zeros((self._arm.size + 1, count))
        wide[:-1] = closing
        there, weight = wide[self._index], self._weight[..., None]
        rotation, common = np.zeros(count), np.zeros((self._mixing.shape[2], count))
        amplitudes = np.zeros((self._index.shape[0], self._rank, count))
        for _ in range(2):
            force = weight * (there - self._closed(amplitudes, common, rotation))
            loads = self._rows.swapaxes(1, 2) @ force
            left = self._mixed(loads[:, self._rank : -1]) - common
            imbalance = torque - loads[:, -1].sum(axis=0)
            change, moved, turn = self._step(loads[:, : self._rank] - amplitudes, left, imbalance)
            amplitudes, common, rotation = amplitudes + change, common + moved, rotation + turn
        closed = self._closed(amplitudes, common, rotation) - there
        force, gap = np.zeros((2, self._arm.size + 1, count))
        force[self._index] = -weight * closed
        gap[self._index] = np.where(weight > 0.0, 0.0, closed)
        return TouchingAnswer(force[:-1], rotation, gap[:-1])

    def yielding(self) -> Array:
        """See `DenseTouching`."""
        modes = self._rows[..., : self._rank]
        compliance = np.zeros(self._arm.size + 1)
        compliance[self._index] = np.sum((modes @ self._inverse) * modes, axis=2)
        if self._mixing.shape[2]:
            shared = (self._rows[..., self._rank : -1] - modes @ self._by_shared) @ self._mixing
            compliance[self._index] += np.sum((shared @ np.linalg.inv(self._common)) * shared, axis=2)
        return np.where(self._active, 0.0, self._local + compliance[:-1])

    def columns(self, segments: Integers) -> Array:
        """See `DenseTouching`."""
        wide = np.zeros((self._arm.size + 1, segments.size))
        for number, segment in enumerate(segments):
            block = self._block[segment]
            modes = self._rows[block, :, : self._rank]
            wide[self._index[block], number] = modes @ modes[self._place[segment]]
            if self._mixing.shape[2]:
                amplitudes = self._rows[block, self._place[segment], self._rank : -1] @ self._mixing[block]
                shared = self._rows[..., self._rank : -1] @ (self._mixing @ amplitudes)[..., None]
                wide[self._index, number] += shared[..., 0]
            wide[segment, number] += self._local[segment]
        return wide[:-1]

    @property
    def stiffness(self) -> float:
        """Torque that turns the gear by one radian while the touching segments are held [N mm/rad]."""
        return self._pivot

    def _closed(self, amplitudes: Array, common: Array, rotation: Array) -> Array:
        """U z + W y - r theta in blocks (p, m, q)."""
        turn = np.broadcast_to(-rotation, (amplitudes.shape[0], 1, rotation.size))
        local = [self._mixing @ common] if common.shape[0] else []
        return np.asarray(self._rows @ np.concatenate([amplitudes, *local, turn], axis=1))

    def _mixed(self, local: Array) -> Array:
        """Sum of M'x over the blocks (s, ...), x (p, j, ...) being of the shared columns."""
        return np.asarray((self._mixing.swapaxes(1, 2) @ local).sum(axis=0))

    def _step(self, loads: Array, shared: Array, imbalance: Array) -> tuple[Array, Array, Array]:
        """Changes of amplitudes (p, k, q), (s, q) and rotations (q) for residuals of the three equations."""
        amplitudes = self._inverse @ loads
        imbalance = imbalance + np.einsum("pk,pkq->q", self._border, amplitudes)
        if not shared.shape[0]:
            turn = imbalance / self._pivot
            return amplitudes + turn * self._by_arm[..., None], shared, turn
        rest = shared - self._mixed(self._by_shared.swapaxes(1, 2) @ loads)
        turn = (imbalance + self._turned @ rest) / self._pivot
        moved = np.asarray(np.linalg.solve(self._common, rest), dtype=np.float64) + turn * self._turned[:, None]
        return amplitudes + turn * self._by_arm[..., None] - self._by_shared @ (self._mixing @ moved), moved, turn

    def _change(self, segment: int, entering: bool) -> bool:
        active = self._active.copy()
        active[segment] = entering
        if not self._arm[active].any():
            return False
        block, place = self._block[segment], self._place[segment]
        row, weight = self._rows[block, place], 1.0 / self._local[segment]
        self._active = active
        self._weight[block, place] = weight if entering else 0.0
        self._updates += 1
        if self._updates >= MAX_UPDATES:
            self._sum()
        else:
            self._gram[block] += np.outer(row, row * (weight if entering else -weight))
            self._factorise(slice(block, block + 1))
        return True

    def _sum(self) -> None:
        """Sum the matrices of all blocks anew."""
        self._weight = np.append(np.where(self._active, 1.0 / self._local, 0.0), 0.0)[self._index]
        self._gram = (self._rows * self._weight[..., None]).swapaxes(1, 2) @ self._rows
        blocks, rank = self._gram.shape[0], self._rank
        self._inverse = np.empty((blocks, rank, rank))
        self._by_arm = np.empty((blocks, rank))
        self._by_shared = np.empty((blocks, rank, self._mixing.shape[1]))
        self._updates = 0
        self._factorise(slice(None))

    def _factorise(self, blocks: slice) -> None:
        gram, rank = self._gram[blocks], self._rank
        self._inverse[blocks] = np.linalg.inv(gram[:, :rank, :rank] + np.eye(rank))
        self._by_arm[blocks] = (self._inverse[blocks] @ gram[:, :rank, -1:])[..., 0]
        self._border = self._gram[:, :rank, -1]
        self._pivot = float(self._gram[:, -1, -1].sum() - np.sum(self._border * self._by_arm))
        if not self._mixing.shape[2]:
            return
        self._by_shared[blocks] = self._inverse[blocks] @ gram[:, :rank, rank:-1]
        beside = self._gram[:, :rank, rank:-1].swapaxes(1, 2)
        local = self._gram[:, rank:-1, rank:-1] - beside @ self._by_shared
        self._common = np.eye(self._mixing.shape[2]) + self._mixed(local @ self._mixing)
        turned = self._mixed(self._gram[:, rank:-1, -1:] - beside @ self._by_arm[..., None])[:, 0]
        self._turned = np.linalg.solve(self._common, turned)  # change of the shared amplitudes by that of the rotation
        self._pivot -= float(turned @ self._turned)


#: The system for a set of touching segments that changes one by one, in either form.
TouchingSystem = DenseTouching | ModalTouching
#: Number of segments up to which the dense form is as fast as the modes.
DENSE_FIRST_SIZE = 300
#: Padding the blocks to one size may cost this many times the memory of the factor.
LARGEST_PADDING = 4


def touching_system(matrix: ComplianceMatrix, lever_arm: Array, active: Bools) -> TouchingSystem:
    """System of a set of touching segments: in the modes where there are many segments, else dense.

    Some must have a lever arm; those whose forces would not be unique are left out.
    """
    large = lever_arm.size > DENSE_FIRST_SIZE
    if large and isinstance(matrix, ModalCompliance) and matrix.local_fraction > SMALLEST_LOCAL_FRACTION:
        basis = matrix.modes.basis
        if basis.modes.size <= LARGEST_PADDING * matrix.factor.size + matrix.local.size:
            return ModalTouching(matrix.local, basis, lever_arm, active)
    return DenseTouching(matrix.dense, lever_arm, active)


def touching_stiffness(local: Array, basis: ModalBasis, lever_arm: Array, active: Bools) -> float:
    """Torque that turns the gear by one radian while these segments keep contact [N mm/rad].

    It is dT / dtheta = r_A' C_AA^-1 r_A for C = diag(local) + modes; NaN where C_AA is singular.
    """
    if np.count_nonzero(active) > DENSE_FIRST_SIZE:
        return ModalTouching(local, basis, lever_arm, active).stiffness
    touching = [(segments, active[segments]) for segments, _ in basis.blocks]
    index = np.concatenate([segments[chosen] for segments, chosen in touching])
    shared = basis.shared_factor[index]
    part, start = shared @ shared.T, 0
    for (_, chosen), (_, modes) in zip(touching, basis.blocks, strict=True):
        rows = modes[chosen]
        block = slice(start, start := start + len(rows))
        part[block, block] += rows @ rows.T
    part.reshape(-1)[:: index.size + 1] += local[index]
    known = TouchingFactor.of(part, lever_arm[index])
    return np.nan if known is None else known.moment


def part_of(matrix: ComplianceMatrix, segments: Integers) -> Array | tuple[Array, Array]:
    """Return the compliance among some segments [mm/N], in the form of the whole."""
    if isinstance(matrix, ModalCompliance):
        return matrix.local[segments], matrix.factor[segments]
    return np.asarray(matrix.dense[np.ix_(segments, segments)])
