"""The linear system of a given active set for C = diag(d) + U U^T, without the matrix C.

With the modal amplitudes c = U_A'F_A, the segments P of the active set that have a local compliance are eliminated,
F_P = (theta r_P - S_P - U_P c) / d_P. What is left is small: the amplitudes, the forces of the segments Z that have
(nearly) no local compliance, and the rotation,

    [ I + U_P'U_P/d   -U_Z'   -U_P'r_P/d ] [ c     ]   [ -U_P'S_P/d    ]
    [ -U_Z            -d_Z     r_Z       ] [ F_Z   ] = [  S_Z          ]
    [ -r_P'U_P/d       r_Z'    r_P'r_P/d ] [ theta ]   [  T + r_P'S_P/d ]

(the Woodbury identity with two borders). It costs O(a m^2) for a active segments and m modes. Digits lost where d is
small come back by iterative refinement, whose residual takes O(n m). Where more segments without local compliance touch
than there are modes, this matrix is singular: then the block C_AA of the active segments is factored instead, as it is
where few segments touch.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf, dgetrs

from ...problem.scaled_problem import ScaledProblem
from .active_set_system import SHIFTED_REFINEMENTS, TouchingFactor

Array = NDArray[np.float64]

#: Part of a segment's compliance below which its local compliance is not divided by.
SMALLEST_LOCAL_FRACTION = 1e-4
#: Steps of iterative refinement that are always taken.
REFINEMENTS = 2
#: Gap of a touching segment, relative to the largest term of the gaps, beyond which a system counts as singular.
RESIDUAL_LIMIT = 1e-12
#: Touching segments up to which their block of C is formed first, and up to which it is formed at all.
SMALL_BLOCK, LARGEST_BLOCK = 150, 4000
#: Segments up to which modes are not compressed: that costs more than it saves.
SMALL_PROBLEM = 300


@dataclass(frozen=True, eq=False)
class ModalProblem:
    """A scaled problem with C = diag(d) + U U^T, taken apart once for several active sets.

    Attributes
    ----------
    problem
        The scaled problem.
    local
        d, (n).
    modes
        U, compressed where there are many segments (n, m).
    rigid
        Segments whose local compliance is not divided by (n).
    """

    problem: ScaledProblem
    local: Array
    modes: Array
    rigid: NDArray[np.bool_]

    @classmethod
    def of(cls, problem: ScaledProblem) -> ModalProblem | None:
        """Take a problem apart; None where its compliance is one dense matrix."""
        modal = problem.modal
        if modal is None:
            return None
        rigid = ~(modal.diagonal > SMALLEST_LOCAL_FRACTION * modal.whole_diagonal)
        small = modal.diagonal.size <= SMALL_PROBLEM
        modes = math.sqrt(modal.weight) * modal.factor if small else modal.basis.factor
        return cls(problem, modal.diagonal, modes, rigid)

    def gap(self, force: Array, rotation: float) -> Array:
        """Return C F + S - r theta, (n)."""
        gap = self.local * force
        gap += self.modes @ (force @ self.modes)
        gap += self.problem.separation
        gap -= rotation * self.problem.lever_arm
        return gap


@dataclass(slots=True)
class ModalActiveSetPoint:
    """Forces and rotation that close the gaps of an active set; as `ActiveSetPoint`, from the modes.

    Attributes
    ----------
    index
        The active segments (a).
    force
        Their forces (a), of any sign.
    rotation
        Beyond first contact.
    gap
        Gaps of all segments (n); zero up to rounding on the active ones.
    """

    index: NDArray[np.intp]
    force: Array
    rotation: float
    gap: Array
    _modal: ModalProblem
    _system: _BorderedSystem | TouchingFactor

    @property
    def shifted(self) -> bool:
        """Whether the block of the active segments is singular to rounding."""
        return isinstance(self._system, TouchingFactor) and self._system.shifted

    def refine(self) -> None:
        """Take one step of iterative refinement."""
        problem = self._modal.problem
        left = problem.torque - float(problem.lever_arm[self.index] @ self.force)
        correction, turn = self._system.balance(self.gap[self.index], left)
        self.force = self.force + correction
        self.rotation += turn
        self._update_gap()

    def _update_gap(self) -> None:
        force = np.zeros(self.gap.size)
        force[self.index] = self.force
        self.gap = self._modal.gap(force, self.rotation)


class _BorderedSystem:
    """Factored system of the modal amplitudes, the forces of the segments without local compliance and the rotation."""

    def __init__(self, modal: ModalProblem, index: NDArray[np.intp]) -> None:
        rigid = modal.rigid[index]
        self._soft, self._rigid = np.flatnonzero(~rigid), np.flatnonzero(rigid)
        modes, arm, local = modal.modes[index], modal.problem.lever_arm[index], modal.local[index]
        soft_rows = np.column_stack([modes[self._soft], arm[self._soft]])
        self._weighted = soft_rows / local[self._soft, None]
        self._soft_rows, self._local = soft_rows, local[self._soft]
        count, hard = modes.shape[1], self._rigid.size
        gram = soft_rows.T @ self._weighted
        matrix = np.zeros((count + hard + 1, count + hard + 1), order="F")
        last = count + hard
        matrix[:count, :count] = gram[:-1, :-1] + np.eye(count)
        matrix[:count, last] = matrix[last, :count] = -gram[:-1, -1]
        matrix[last, last] = gram[-1, -1]
        matrix[count:last, :count] = -modes[self._rigid]
        matrix[:count, count:last] = -modes[self._rigid].T
        matrix[np.arange(count, last), np.arange(count, last)] = -local[self._rigid]
        matrix[count:last, last] = matrix[last, count:last] = arm[self._rigid]
        self._count = count
        self._factor, self._pivots, info = dgetrf(matrix, overwrite_a=1)
        self.is_regular = info == 0

    def balance(self, separation: Array, torque: float) -> tuple[Array, float]:
        """Return forces (a) and rotation for separations (a) of the active segments and a torque."""
        own = separation[self._soft]
        loads = own @ self._weighted
        side = np.concatenate([-loads[:-1], separation[self._rigid], [torque + loads[-1]]])
        found, _info = dgetrs(self._factor, self._pivots, side)
        rotation = float(found[-1])
        force = np.empty(separation.size)
        force[self._rigid] = found[self._count : -1]
        closing = self._soft_rows @ np.concatenate([found[: self._count], [-rotation]])
        force[self._soft] = -(closing + own) / self._local
        return force, rotation


def _block_factor(modal: ModalProblem, index: NDArray[np.intp]) -> TouchingFactor | None:
    """Cholesky factor of the block C_AA of the active segments, shifted where it is singular to rounding."""
    modes = modal.modes[index]
    block = modes @ modes.T
    block[np.diag_indices_from(block)] += modal.local[index]
    return TouchingFactor.of(block, modal.problem.lever_arm[index], shift=True)


def solve_modal_active_set(modal: ModalProblem, index: NDArray[np.intp]) -> ModalActiveSetPoint | None:
    """Solve the system of an active set.

    Parameters
    ----------
    modal
        The problem.
    index
        Active segments (a), at least one of them with a lever arm other than zero.

    Returns
    -------
    ModalActiveSetPoint or None
        None where no factor gives a solution, or the block of that many segments without local compliance is too large.
    """
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        if index.size > SMALL_BLOCK:
            bordered = _BorderedSystem(modal, index)
            point = _refined(modal, index, bordered, REFINEMENTS) if bordered.is_regular else None
            if _is_solved(point) or index.size > LARGEST_BLOCK:
                return point
        factor = _block_factor(modal, index)
        if factor is None:
            return None
        return _refined(modal, index, factor, SHIFTED_REFINEMENTS if factor.shifted else REFINEMENTS)


def _refined(
    modal: ModalProblem, index: NDArray[np.intp], system: _BorderedSystem | TouchingFactor, refinements: int
) -> ModalActiveSetPoint | None:
    problem = modal.problem
    force, rotation = system.balance(problem.separation[index], problem.torque)
    point = ModalActiveSetPoint(index, force, rotation, np.empty(modal.local.size), modal, system)
    point._update_gap()
    for _ in range(refinements):
        point.refine()
    return point if np.isfinite(point.gap).all() else None


def _is_solved(point: ModalActiveSetPoint | None) -> bool:
    if point is None:
        return False
    separation = point._modal.problem.separation[point.index]
    level = abs(point.rotation) + float(np.abs(separation).max())
    return float(np.abs(point.gap[point.index]).max()) <= RESIDUAL_LIMIT * level
