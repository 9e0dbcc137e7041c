"""Primal-dual interior point with Mehrotra's predictor and corrector: the last resort of the native solver.

Its iteration count hardly depends on the data, and the matrix it factors, C + diag(Y/F), is positive definite even
where C is singular.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dpotrf, dpotrs

from ..problem.scaling import ScaledProblem
from .scaled_answer import ScaledAnswer

#: Step to the boundary, as a fraction; approaches one with the iteration.
BOUNDARY_FRACTION = 0.995
#: Relative residuals and complementarity at which it stops.
STOP = 1e-15


def interior_point(
    problem: ScaledProblem, *, max_iterations: int = 80
) -> tuple[ScaledAnswer, NDArray[np.float64]] | None:
    """Solve the scaled problem.

    Returns
    -------
    (ScaledAnswer, (n) array) or None
        The best point met and its bound multipliers (the gaps), which tell the active set apart; None after a
        breakdown.
    """
    matrix, arm, separation, torque = problem.compliance, problem.lever_arm, problem.separation, problem.torque
    size = arm.size
    force = np.full(size, max(torque / max(float(np.abs(arm).sum()), 1e-300), 1.0))
    rotation = 0.0
    gap = np.maximum(matrix @ force + separation, 1.0)
    best: tuple[float, ScaledAnswer, NDArray[np.float64]] | None = None
    for iteration in range(max_iterations + 1):
        deflection = matrix @ force
        dual = deflection + separation - rotation * arm - gap
        primal = torque - float(arm @ force)
        mean = float(force @ gap) / size
        gap_level = float(np.abs(deflection).max()) + abs(rotation) or 1.0
        error = max(
            float(np.abs(dual).max()) / gap_level,
            abs(primal) / max(torque, float(force @ np.abs(arm)) * 1e-5),
            float(np.minimum(force / force.max(), gap / gap_level).max()),
        )
        if not (np.isfinite(error) and mean > 0.0):
            break
        if best is None or error < best[0]:
            best = (error, ScaledAnswer(force.copy(), rotation, iteration), gap.copy())
        if error <= STOP or iteration == max_iterations:
            break
        system = _Condensed(matrix, arm, gap / force)
        if system.failed:
            break
        # Predictor: aim straight at the solution; how far one gets tells how much to centre.
        d_force, d_rotation, d_gap = system.step(-dual - gap, primal, force, gap, -force * gap)
        length = min(_longest(force, d_force), _longest(gap, d_gap))
        aim = float((force + length * d_force) @ (gap + length * d_gap)) / size
        centre = mean * min(max(aim / mean, 0.0), 1.0) ** 3
        target = centre - d_force * d_gap - force * gap
        d_force, d_rotation, d_gap = system.step(-dual + target / force, primal, force, gap, target)
        fraction = max(BOUNDARY_FRACTION, 1.0 - mean)
        length = min(1.0, fraction * _longest(force, d_force), fraction * _longest(gap, d_gap))
        force = force + length * d_force
        gap = gap + length * d_gap
        rotation += length * d_rotation
        if not (force.min() > 0.0 and gap.min() > 0.0):
            break
    return None if best is None else (best[1], best[2])


class _Condensed:
    """The Newton system with gaps eliminated: (C + diag(Y/F)) dF - r dtheta = a, r'dF = b."""

    def __init__(self, matrix: NDArray[np.float64], arm: NDArray[np.float64], diagonal: NDArray[np.float64]) -> None:
        condensed = matrix.copy()
        condensed[np.diag_indices_from(condensed)] += diagonal
        self.arm = arm
        self.factor, info = dpotrf(condensed.T, lower=1, overwrite_a=1, clean=0)
        self.failed = info != 0
        if not self.failed:
            self.unit = self._solve(arm)
            self.pivot = float(arm @ self.unit)
            self.failed = not (0.0 < self.pivot < np.inf)

    def _solve(self, side: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(dpotrs(self.factor, side, lower=1)[0])

    def step(
        self,
        side: NDArray[np.float64],
        imbalance: float,
        force: NDArray[np.float64],
        gap: NDArray[np.float64],
        target: NDArray[np.float64],
    ) -> tuple[NDArray[np.float64], float, NDArray[np.float64]]:
        """Return dF, dtheta and dY, the last from Y dF + F dY = target."""
        free = self._solve(side)
        d_rotation = (imbalance - float(self.arm @ free)) / self.pivot
        d_force = free + d_rotation * self.unit
        return d_force, d_rotation, (target - gap * d_force) / force


def _longest(value: NDArray[np.float64], change: NDArray[np.float64]) -> float:
    """Longest step, at most 1, that keeps the values nonnegative."""
    falling = change < 0.0
    return min(1.0, float((value[falling] / -change[falling]).min())) if falling.any() else 1.0
