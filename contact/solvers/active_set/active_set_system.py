"""The linear system of a given active set: its segments touch, all others are open.

    [ C_AA  -r_A ] [ F_A   ]   [ -S_A ]
    [ r_A'    0  ] [ theta ] = [  T   ]

is solved with one Cholesky factor of C_AA and two right-hand sides, u = C_AA^-1 r_A and v = C_AA^-1 S_A:
theta = (T + r_A'v) / (r_A'u), F_A = theta u - v.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dpotrf, dpotrs

from ...problem.scaled_problem import ScaledProblem

#: First shift of a numerically singular block, relative to its mean diagonal.
SMALLEST_SHIFT = 1e-14


@dataclass(slots=True)
class ActiveSetPoint:
    """Forces and rotation that close the gaps of an active set, in scaled numbers.

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
    force: NDArray[np.float64]
    rotation: float
    gap: NDArray[np.float64]
    _problem: ScaledProblem
    _rows: NDArray[np.float64]
    _factor: NDArray[np.float64]
    _arm: NDArray[np.float64]
    _unit: NDArray[np.float64]
    _pivot: float
    _shifted: bool

    def refine(self) -> None:
        """Take one step of iterative refinement; several if the block is singular and was shifted.

        The residual is that of the true system, so that the shift speeds or slows the convergence but leaves no bias.
        """
        for _ in range(8 if self._shifted else 1):
            correction, _info = dpotrs(self._factor, -self.gap[self.index], lower=1, overwrite_b=1)
            imbalance = self._problem.torque - float(self._arm @ (self.force + correction))
            turn = imbalance / self._pivot
            self.force = self.force + correction + turn * self._unit
            self.rotation += turn
            self._update_gap()

    def _update_gap(self) -> None:
        self.gap = self.force @ self._rows
        self.gap += self._problem.separation
        self.gap -= self.rotation * self._problem.lever_arm


def solve_active_set(problem: ScaledProblem, index: NDArray[np.intp]) -> ActiveSetPoint | None:
    """Solve the system of an active set.

    Parameters
    ----------
    problem
        The scaled problem.
    index
        Active segments (a), at least one of them with a lever arm other than zero.

    Returns
    -------
    ActiveSetPoint or None
        None where the block has no Cholesky factor even with a shift (C is not positive semidefinite) or overflows.
    """
    rows = problem.compliance[index]
    block = rows[:, index]
    factor, shifted = cholesky_factor(block)
    if factor is None:
        return None
    arm = problem.lever_arm[index]
    sides = np.empty((2, index.size))
    sides[0] = arm
    sides[1] = problem.separation[index]
    solved, _info = dpotrs(factor, sides.T, lower=1, overwrite_b=1)
    unit = solved[:, 0]
    pivot = float(arm @ unit)
    if not pivot > 0.0 or pivot == np.inf:
        return None
    rotation = (problem.torque + float(arm @ solved[:, 1])) / pivot
    force = rotation * unit - solved[:, 1]
    point = ActiveSetPoint(index, force, rotation, problem.separation, problem, rows, factor, arm, unit, pivot, shifted)
    point._update_gap()
    if shifted:
        point.refine()
    return point


def cholesky_factor(block: NDArray[np.float64]) -> tuple[NDArray[np.float64] | None, bool]:
    """Return the lower Cholesky factor of a symmetric block (a, a), and whether the block had to be shifted for it.

    None for a block that has no factor even with a shift.
    """
    # C is symmetric: the transpose of a C-ordered copy is the same matrix in Fortran order, so LAPACK makes no copy.
    factor, info = dpotrf(block.T, lower=1, clean=0)
    return (factor, False) if info == 0 else (_shifted_factor(block), True)


def _shifted_factor(block: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Cholesky factor of block + shift I, with the smallest shift that gives one."""
    level = float(block.diagonal().mean())
    if not level > 0.0:
        level = 1.0
    shift = SMALLEST_SHIFT * level
    while shift < 1e-6 * level:
        trial = block.copy()
        trial[np.diag_indices_from(trial)] += shift
        factor, info = dpotrf(trial.T, lower=1, overwrite_a=1, clean=0)
        if info == 0:
            return np.asarray(factor)
        shift *= 10.0
    return None


def first_contact_index(problem: ScaledProblem) -> int:
    """Return the segment that touches first as the rigid bodies turn."""
    positive = np.flatnonzero(problem.lever_arm > 0.0)
    return int(positive[np.argmin(problem.separation[positive] / problem.lever_arm[positive])])
