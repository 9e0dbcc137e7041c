"""The functional of the modal method, and its Newton system: an arrowhead of one small block a tooth pair.

For a given set of touching segments A, with W = diag(1/d) on A and zero elsewhere,

    (I + U'W U) c - U'W r theta = -U'W S,      r'W r theta - r'W U c = T + r'W S.

One product [U r S]'W [U r S] for each block holds the block, its border and both right-hand sides.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..problem.scaling import ScaledPair, ScaledProblem

Array = NDArray[np.float64]

#: Smallest local compliance for which the method is tried, relative to the whole compliance of a segment.
SMALLEST_LOCAL_FRACTION = 1e-4
#: Padding the blocks to one size may cost this many times the memory of the factor.
LARGEST_PADDING = 4


@dataclass(eq=False)
class ModalPoint:
    """Modal amplitudes and rotation, with what follows from them: (p, k) and (p, m) arrays, one row a block."""

    system: ModalSystem
    amplitudes: Array
    rotation: float
    gap: Array

    @cached_property
    def force(self) -> Array:
        """Forces of the segments by blocks, (p, m)."""
        return np.maximum(-self.gap, 0.0) * self.system.stiffness

    @cached_property
    def _terms(self) -> tuple[float, float, float]:
        closed = np.minimum(self.gap, 0.0)
        local = float(np.vdot(closed * self.system.stiffness, closed))
        return (
            0.5 * float(np.vdot(self.amplitudes, self.amplitudes)),
            0.5 * local,
            -self.system.torque * self.rotation,
        )

    @property
    def energy(self) -> float:
        """The functional phi at this point."""
        return sum(self._terms)

    @property
    def energy_scale(self) -> float:
        """Sum of the magnitudes of the terms of phi."""
        return sum(map(abs, self._terms))


@dataclass(frozen=True, eq=False)
class ModalSystem:
    """A scaled problem in blocks.

    Attributes
    ----------
    index : (p, m) int array
        Segments of each block; n where padded.
    rows : (p, m, k + 2) array
        Of each segment: modes, lever arm, separation.
    stiffness : (p, m) array
        1/d, zero where padded.
    torque : float
    size : int
        Number of segments n.
    """

    index: NDArray[np.intp]
    rows: Array
    stiffness: Array
    torque: float
    size: int

    @property
    def lever_arm(self) -> Array:
        """Lever arms by blocks, (p, m)."""
        return self.rows[..., -2]

    @cached_property
    def largest_arm(self) -> float:
        """Largest magnitude of a lever arm."""
        return float(np.abs(self.lever_arm).max())

    def to_blocks(self, mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return a mask of the segments by blocks, (p, m)."""
        return np.append(mask, False)[self.index]

    def from_blocks(self, values: Array) -> Array:
        """Return values by blocks as a vector over the segments, (n)."""
        result = np.zeros(self.size + 1)
        result[self.index] = values
        return result[:-1]

    def point(self, amplitudes: Array, rotation: float) -> ModalPoint:
        """Return the point with the given amplitudes (p, k) and rotation."""
        weights = np.empty((*amplitudes.shape[:1], amplitudes.shape[1] + 2, 1))
        weights[:, :-2, 0] = amplitudes
        weights[:, -2] = -rotation
        weights[:, -1] = 1.0
        return ModalPoint(self, amplitudes, rotation, (self.rows @ weights)[..., 0])

    def towards(self, point: ModalPoint, target: ModalPoint, length: float) -> ModalPoint:
        """Return the point a fraction of the way to another."""
        return ModalPoint(
            self,
            point.amplitudes + length * (target.amplitudes - point.amplitudes),
            point.rotation + length * (target.rotation - point.rotation),
            point.gap + length * (target.gap - point.gap),
        )

    def newton_system(self, active: NDArray[np.bool_]) -> NewtonSystem | None:
        """Return the linear system of a set of touching segments (p, m); None if it has no solution in numbers."""
        weighted = self.rows * np.where(active, self.stiffness, 0.0)[..., None]
        gram = weighted.transpose(0, 2, 1) @ self.rows
        hessian = gram[:, :-2, :-2] + np.eye(gram.shape[1] - 2)
        try:
            solved = np.asarray(np.linalg.solve(hessian, gram[:, :-2, -2:]), dtype=np.float64)
        except np.linalg.LinAlgError:
            return None
        border = gram[:, -2, -2:] - np.einsum("pk,pkj->pj", gram[:, :-2, -2], solved)
        pivot, level = border.sum(axis=0).tolist()
        if not 0.0 < pivot < np.inf:
            return None
        return NewtonSystem(self, hessian, gram[:, :-2, -2], solved, pivot, level)


@dataclass(frozen=True, eq=False, slots=True)
class NewtonSystem:
    """The arrowhead of a set of touching segments, solved."""

    system: ModalSystem
    hessian: Array
    border: Array
    solved: Array
    pivot: float
    level: float

    def solution(self) -> ModalPoint:
        """Return the point at which phi would be least if no segment opened or closed."""
        rotation = (self.system.torque + self.level) / self.pivot
        return self.system.point(rotation * self.solved[..., 0] - self.solved[..., 1], rotation)

    def refined(self, point: ModalPoint) -> ModalPoint:
        """Return the point after one step of refinement on the gradient of phi."""
        loads = point.force[:, None, :] @ self.system.rows[..., :-1]
        residual = loads[:, 0, :-1] - point.amplitudes
        imbalance = self.system.torque - float(loads[:, 0, -1].sum())
        free = np.linalg.solve(self.hessian, residual[..., None])[..., 0]
        turn = (imbalance + float(np.vdot(self.border, free))) / self.pivot
        return self.system.point(point.amplitudes + free + turn * self.solved[..., 0], point.rotation + turn)


def has_modal_form(problem: ScaledProblem) -> bool:
    """Whether the modal method has a place.

    It has none if the compliance is a dense matrix, if some segment has (nearly) no compliance of its own, or if
    blocks of very different sizes would be mostly padding.
    """
    pair = problem.pair
    if pair is None or not pair.problem.local_fraction > SMALLEST_LOCAL_FRACTION:
        return False
    return pair.modal_basis.modes.size <= LARGEST_PADDING * problem.separation.size * (pair.mode_count + 1)


def modal_system(problem: ScaledProblem) -> ModalSystem:
    """Return the problem in blocks; it must have the modal form."""
    pair = problem.given_compliance
    assert isinstance(pair, ScaledPair)
    basis = pair.modal_basis
    rows = np.empty((*basis.index.shape, basis.modes.shape[2] + 2))
    rows[..., :-2] = pair.mode_unit * basis.modes
    rows[..., -2] = np.append(problem.lever_arm, 0.0)[basis.index]
    rows[..., -1] = np.append(problem.separation, 1.0)[basis.index]  # the padding never touches
    stiffness = np.append(1.0 / pair.diagonal, 0.0)[basis.index]
    return ModalSystem(basis.index, rows, stiffness, problem.torque, problem.separation.size)
