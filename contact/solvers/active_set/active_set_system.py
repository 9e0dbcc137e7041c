"""The linear system of a given active set: its segments touch, all others are open.

    [ C_AA  -r_A ] [ F_A   ]   [ -S_A ]
    [ r_A'    0  ] [ theta ] = [  T   ]

is solved with one Cholesky factor of C_AA and two right-hand sides, u = C_AA^-1 r_A and v = C_AA^-1 S_A:
theta = (T + r_A'v) / (r_A'u), F_A = theta u - v. A block that is singular to rounding is shifted and the answer
refined, or refused, as the caller wants; `DenseTouching` leaves segments out, and goes from one set to the next.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dpocon, dpotrf, dpotri, dpotrs

from ...problem.scaled_problem import ScaledProblem

Array = NDArray[np.float64]

#: Compliance of a segment while the touching ones may yield, relative to the terms it is the difference of: below this
#: the forces are taken for not unique.
DEPENDENCE_TOLERANCE = 1e-11
#: First shift of a numerically singular block, and the largest that is tried, relative to its mean diagonal.
SMALLEST_SHIFT, LARGEST_SHIFT = 1e-14, 1e-6
#: Steps of iterative refinement where the block was shifted.
SHIFTED_REFINEMENTS = 8


@dataclass(frozen=True, eq=False, slots=True)
class TouchingFactor:
    """Cholesky factor of the compliance among the touching segments.

    Attributes
    ----------
    lower
        L with L L' = C_AA (a, a).
    arm
        r_A (a).
    turning
        u = C_AA^-1 r_A (a).
    moment
        r_A'u: the torque that turns the gear by one radian, the touching segments being held [N mm/rad].
    shifted
        Whether C_AA is singular to rounding, and the factor that of C_AA + shift I.
    """

    lower: Array
    arm: Array
    turning: Array
    moment: float
    shifted: bool = False

    @classmethod
    def of(cls, block: Array, arm: Array, *, shift: bool = False) -> TouchingFactor | None:
        """Factorise; a block that is singular to rounding is shifted, or else there is no factor.

        None also where the block has no factor with a shift (it is not positive semidefinite), or overflows.
        """
        # The block is symmetric: its transpose is the same matrix in the order LAPACK wants.
        lower, failed = dpotrf(block.T, lower=1, clean=0)
        if failed and shift:
            lower = _shifted(block)
        elif not failed and not shift:
            # The trace bounds the largest eigenvalue, and costs less than a norm.
            reciprocal_condition, _ = dpocon(lower, float(block.trace()), uplo="L")
            failed = not reciprocal_condition > DEPENDENCE_TOLERANCE
        if lower is None or (failed and not shift):
            return None
        turning = dpotrs(lower, arm, lower=1)[0]
        moment = float(arm @ turning)
        return cls(lower, arm, turning, moment, bool(failed)) if 0.0 < moment < np.inf else None

    def balance(self, separation: Array, torque: float) -> tuple[Array, float]:
        """Forces (a) and rotation that close the separations (a) under a torque."""
        rigid = dpotrs(self.lower, separation, lower=1)[0]
        rotation = (torque + float(self.arm @ rigid)) / self.moment
        return rotation * self.turning - rigid, rotation

    def solve(self, sides: Array) -> Array:
        """C_AA^-1 times right-hand sides (a, q)."""
        return np.asarray(dpotrs(self.lower, sides, lower=1)[0])

    def apply(self, sides: Array) -> Array:
        """K^-1 times right-hand sides (1 + a, q)."""
        held = self.solve(sides[1:])
        first = (self.arm @ held - sides[0]) / self.moment
        return np.vstack([first, held - self.turning[:, None] * first])

    def inverse(self) -> Array:
        """K^-1."""
        half = np.tril(dpotri(self.lower, lower=1)[0])
        held = half + np.tril(half, -1).T
        size = self.arm.size + 1
        whole = np.empty((size, size))
        whole[0, 0] = -1.0 / self.moment
        whole[0, 1:] = whole[1:, 0] = self.turning / self.moment
        whole[1:, 1:] = held - np.outer(self.turning, self.turning / self.moment)
        return whole


def _shifted(block: Array) -> Array | None:
    """Cholesky factor of block + shift I, with the smallest shift that gives one."""
    level = float(block.diagonal().mean())
    level = level if level > 0.0 else 1.0
    shift = SMALLEST_SHIFT
    while shift < LARGEST_SHIFT:
        trial = block.copy()
        trial[np.diag_indices_from(trial)] += shift * level
        lower, failed = dpotrf(trial.T, lower=1, overwrite_a=1, clean=0)
        if not failed:
            return np.asarray(lower)
        shift *= 10.0
    return None


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
    force: Array
    rotation: float
    gap: Array
    _problem: ScaledProblem
    _rows: Array
    _factor: TouchingFactor

    @property
    def shifted(self) -> bool:
        """Whether the block of the active segments is singular to rounding."""
        return self._factor.shifted

    def refine(self) -> None:
        """Take one step of iterative refinement; several if the block is singular and was shifted.

        The residual is that of the true system, so that the shift speeds or slows the convergence but leaves no bias.
        """
        for _ in range(SHIFTED_REFINEMENTS if self.shifted else 1):
            imbalance = self._problem.torque - float(self._factor.arm @ self.force)
            correction, turn = self._factor.balance(self.gap[self.index], imbalance)
            self.force = self.force + correction
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
    factor = TouchingFactor.of(rows[:, index], problem.lever_arm[index], shift=True)
    if factor is None:
        return None
    force, rotation = factor.balance(problem.separation[index], problem.torque)
    point = ActiveSetPoint(index, force, rotation, problem.separation, problem, rows, factor)
    point._update_gap()
    if factor.shifted:
        point.refine()
    return point


def first_contact_index(problem: ScaledProblem) -> int:
    """Return the segment that touches first as the rigid bodies turn."""
    positive = np.flatnonzero(problem.lever_arm > 0.0)
    return int(positive[np.argmin(problem.separation[positive] / problem.lever_arm[positive])])
