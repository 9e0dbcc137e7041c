"""The linear system of the segments that touch, kept up to date as segments enter and leave.

With the set A of touching segments the system

    C_AA F_A - r_A theta = g_A,    r_A'F_A = T,    F = 0 elsewhere

has a unique solution if no change of the forces of A is free: none that costs no energy and has no moment. The gaps
are Y = C F - r theta - g; with g = -S they are those of the contact problem. Derivatives of a solution solve the same
system with other right-hand sides.

For a given set, all other segments open, and g = -S the system

    [ C_AA  -r_A ] [ F_A   ]   [ -S_A ]
    [ r_A'    0  ] [ theta ] = [  T   ]

is solved with one Cholesky factor of C_AA and two right-hand sides, u = C_AA^-1 r_A and v = C_AA^-1 S_A:
theta = (T + r_A'v) / (r_A'u), F_A = theta u - v. A block that is singular to rounding is shifted and the answer
refined, or refused, as the caller wants; `DenseTouching` leaves segments out, and goes from one set to the next.

Once segments enter or leave, the explicit inverse takes the place of the factor:

    K = [ 0    r_A' ]        K [ -theta ]   [ T   ]
        [ r_A  C_AA ],         [  F_A   ] = [ g_A ].

A segment that enters or leaves changes the inverse by a matrix of rank one (Schur complement): O(a^2) instead of
O(a^3). One step of iterative refinement with C itself takes away what the updates lose, and after many of them the
inverse is made anew. C_AA itself may be singular.

For C = diag(d) + U U^T the matrix C is never formed. With the modal amplitudes c = U_A'F_A, the segments P of the
active set that have a local compliance are eliminated, F_P = (theta r_P - S_P - U_P c) / d_P. What is left is small:
the amplitudes, the forces of the segments Z that have (nearly) no local compliance, and the rotation,

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
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dgetrf, dgetrs, dpocon, dpotrf, dpotri, dpotrs

from ...core.arrays import Bools, Integers, RealArray as Array
from ..problem.scaled_problem import ScaledProblem


class TouchingAnswer(NamedTuple):
    """Solution of the system for q right-hand sides: forces (n, q), rotations (q) and gaps (n, q)."""

    force: Array
    rotation: Array
    gap: Array

    def column(self, number: int) -> tuple[Array, float, Array]:
        """Force (n), rotation and gap (n) of one right-hand side."""
        return self.force[:, number], float(self.rotation[number]), self.gap[:, number]


#: Compliance of a segment while the touching ones may yield, relative to the terms it is the difference of: below this
#: the forces are taken for not unique.
DEPENDENCE_TOLERANCE = 1e-11
#: First shift of a numerically singular block, and the largest that is tried, relative to its mean diagonal.
SMALLEST_SHIFT, LARGEST_SHIFT = 1e-14, 1e-6
#: Steps of iterative refinement where the block was shifted.
SHIFTED_REFINEMENTS = 8


@dataclass(frozen=True, eq=False, slots=True)
class TouchingFactor:
    """Cholesky factor L of the compliance C_AA (a, a) among the touching segments, and u = C_AA^-1 r_A."""

    lower: Array
    arm: Array
    turning: Array  # u (a)
    moment: float  # r_A'u, torque that turns the gear by one radian [N mm/rad]
    shifted: bool = False  # C_AA singular to rounding; factor of C_AA + shift I

    @classmethod
    def of(
        cls, block: Array, arm: Array, *, shift: bool = False, dependence: float = DEPENDENCE_TOLERANCE
    ) -> TouchingFactor | None:
        """Factorise; a block that is singular to rounding is shifted, or else there is no factor.

        None also where it has no factor with a shift (it is not positive semidefinite), or overflows.
        """
        # The block is symmetric: its transpose is the same matrix in the order LAPACK wants.
        lower, failed = dpotrf(block.T, lower=1, clean=0)
        if failed and shift:
            lower = _shifted(block)
        elif not failed and not shift:
            # The trace bounds the largest eigenvalue, and costs less than a norm.
            reciprocal_condition, _ = dpocon(lower, float(block.trace()), uplo="L")
            failed = not reciprocal_condition > dependence
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
        forces = self.solve(sides[1:])
        first = (self.arm @ forces - sides[0]) / self.moment
        return np.vstack([first, forces - self.turning[:, None] * first])

    def inverse(self) -> Array:
        """K^-1."""
        half = np.tril(dpotri(self.lower, lower=1)[0])
        block = half + np.tril(half, -1).T
        size = self.arm.size + 1
        whole = np.empty((size, size))
        whole[0, 0] = -1.0 / self.moment
        whole[0, 1:] = whole[1:, 0] = self.turning / self.moment
        whole[1:, 1:] = block - np.outer(self.turning, self.turning / self.moment)
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


class ActiveSetPoint:
    """Forces of any sign (a) and rotation that close the gaps of an active set, in scaled numbers."""

    def __init__(
        self,
        problem: ScaledProblem,
        index: Integers,
        system: _BorderedSystem | TouchingFactor,
        deflection: Callable[[Array], Array],
        refinements: int = 1,
    ) -> None:
        """Solve the system once; ``deflection`` (n) is that of all segments under forces of the active ones (a)."""
        self.index = index
        self.force, self.rotation = system.balance(problem.separation[index], problem.torque)  # beyond first contact
        #: Whether the block of the active segments is singular to rounding.
        self.shifted = system.shifted
        self._problem, self._system, self._deflection, self._refinements = problem, system, deflection, refinements
        self._update_gap()

    def refine(self) -> None:
        """Take one step of iterative refinement, or several.

        The residual is that of the true system: a shift changes the convergence but leaves no bias.
        """
        arm = self._problem.lever_arm[self.index]
        for _ in range(self._refinements):
            imbalance = self._problem.torque - float(arm @ self.force)
            correction, turn = self._system.balance(self.gap[self.index], imbalance)
            self.force = self.force + correction
            self.rotation += turn
            self._update_gap()

    def _update_gap(self) -> None:
        """Gaps of all segments (n); zero up to rounding on the active."""
        self.gap = self._deflection(self.force)
        self.gap += self._problem.separation
        self.gap -= self.rotation * self._problem.lever_arm


def solve_active_set(problem: ScaledProblem, index: Integers) -> ActiveSetPoint | None:
    """Solve the system of active segments (a), one of them with a lever arm other than zero.

    None where the block has no Cholesky factor even with a shift (C is not positive semidefinite) or overflows.
    """
    rows = problem.compliance[index]
    if (factor := TouchingFactor.of(rows[:, index], problem.lever_arm[index], shift=True)) is None:
        return None
    refinements = SHIFTED_REFINEMENTS if factor.shifted else 1
    point = ActiveSetPoint(problem, index, factor, lambda force: force @ rows, refinements)
    if factor.shifted:
        point.refine()
    return point


def first_contact_index(problem: ScaledProblem) -> int:
    """Return the segment that touches first as the rigid bodies turn."""
    positive = np.flatnonzero(problem.lever_arm > 0.0)
    return int(positive[np.argmin(problem.separation[positive] / problem.lever_arm[positive])])


#: Updates after which the inverse is made anew.
MAX_UPDATES = 100


class DenseTouching:
    """The system for a set of touching segments that changes one by one.

    Of a symmetric, positive semidefinite C (n, n) [mm/N] and r (n) [mm]; touching segments whose forces would not be
    unique, to a tolerance, are left out.
    """

    def __init__(
        self, compliance: Array, lever_arm: Array, active: Bools, dependence: float = DEPENDENCE_TOLERANCE
    ) -> None:
        self._compliance, self._arm, self._dependence = compliance, lever_arm, dependence
        self._index = np.empty(0, dtype=np.intp)
        self._factor: TouchingFactor | None = None
        self._known = np.empty((0, 0))  # the inverse, where there is no factor
        self._updates = 0
        index = np.flatnonzero(active)
        if index.size and not self._make(index):
            # The most compliant first, so that the system stays as far from singular as it can.
            order = np.argsort(-compliance.diagonal()[index], kind="stable")
            turning = np.flatnonzero(lever_arm[index[order]] != 0.0)[:1]
            for segment in index[np.concatenate([order[turning], np.delete(order, turning)])]:
                self.enter(int(segment))

    @property
    def active(self) -> Bools:
        """The touching segments (n), a copy."""
        mask = np.zeros(self._arm.size, dtype=np.bool_)
        mask[self._index] = True
        return mask

    def enter(self, segment: int) -> bool:
        """Add a segment; return False, and change nothing, where the forces would then not be unique."""
        if not self._index.size:
            return self._make(np.array([segment], dtype=np.intp))
        side = np.append(self._arm[segment], self._compliance[self._index, segment])
        solved = self._inverse @ side
        diagonal = float(self._compliance[segment, segment])
        yielded = float(side @ solved)
        pivot = diagonal - yielded
        if not pivot > self._dependence * max(diagonal, abs(yielded)):
            return False
        size = solved.size
        inverse = np.empty((size + 1, size + 1))
        part = np.multiply.outer(solved, solved / pivot, out=inverse[:size, :size])
        part += self._inverse
        inverse[size, :size] = inverse[:size, size] = -solved / pivot
        inverse[size, size] = 1.0 / pivot
        self._changed(np.append(self._index, segment), inverse)
        return True

    def shares(self, segment: int) -> Array:
        """Return the forces of the touching segments that a unit force of another one replaces (n)."""
        solved = self._inverse @ np.append(self._arm[segment], self._compliance[self._index, segment])
        result = np.zeros(self._arm.size)
        result[self._index] = solved[1:]
        return result

    def leave(self, segment: int) -> bool:
        """Remove a segment; return False, and change nothing, where the rest cannot carry a torque by itself."""
        place = int(np.flatnonzero(self._index == segment)[0])
        column = self._inverse[:, place + 1]
        pivot = float(column[place + 1])
        rest = self._index[:-1].copy()
        if place < rest.size:
            rest[place] = self._index[-1]
        if not rest.size or not pivot > 0.0 or not self._arm[rest].any():
            return False
        inverse = np.multiply.outer(column, column / -pivot)
        inverse += self._inverse
        inverse[place + 1], inverse[:, place + 1] = inverse[-1], inverse[:, -1]  # the last takes its place
        self._changed(rest, inverse[:-1, :-1])
        return True

    def forces(self, closing: Array, torque: float) -> Array:
        """Return the forces of one right-hand side (n), without the gaps and not refined."""
        result = np.zeros(closing.size)
        result[self._index] = self._apply(np.append(torque, closing[self._index])[:, None])[1:, 0]
        return result

    def solve(self, closing: Array, torque: Array) -> TouchingAnswer:
        """Solve for right-hand sides g (n, q) and T (q); the gaps of A are set to zero."""
        index, arm = self._index, self._arm[self._index]
        solution = self._apply(np.vstack([torque, closing[index]]))
        force, rotation = np.zeros(closing.shape), -solution[0]
        force[index] = solution[1:]
        gap = self._gap(force, rotation, closing)
        if self._factor is None:
            solution = self._apply(np.vstack([torque - arm @ force[index], -gap[index]]))
            force[index] += solution[1:]
            rotation = rotation - solution[0]
            gap = self._gap(force, rotation, closing)
        gap[index] = 0.0
        return TouchingAnswer(force, rotation, gap)

    def _gap(self, force: Array, rotation: Array, closing: Array) -> Array:
        return np.asarray(self._compliance @ force - self._arm[:, None] * rotation - closing)

    def yielding(self) -> Array:
        """Return how much a segment yields to a unit force of its own at a fixed rotation (n) [mm/N]; zero in A.

        C_AA must not be singular.
        """
        rows = self._compliance[self._index]
        if self._factor is not None:
            forces = self._factor.solve(rows)
        else:
            turning = self._known[1:, 0]
            forces = (self._known[1:, 1:] - np.outer(turning, turning / self._known[0, 0])) @ rows
        result = self._compliance.diagonal() - np.einsum("ij,ij->j", rows, forces)
        result[self._index] = 0.0
        return np.asarray(result)

    def columns(self, segments: Integers) -> Array:
        """Return columns of C (n, q)."""
        return self._compliance[:, segments]

    @property
    def _inverse(self) -> Array:
        """K^-1, made of the factor when segments begin to change."""
        if self._factor is not None:
            self._known, self._factor = self._factor.inverse(), None
        return self._known

    def _apply(self, sides: Array) -> Array:
        """K^-1 times right-hand sides (1 + a, q)."""
        return self._known @ sides if self._factor is None else self._factor.apply(sides)

    def _changed(self, index: Integers, inverse: Array) -> None:
        self._index, self._known = index, inverse
        self._updates += 1
        if self._updates >= MAX_UPDATES:
            self._make(index)

    def _make(self, index: Integers) -> bool:
        """Factorise a set anew, if it is not singular."""
        block, arm = self._compliance[np.ix_(index, index)], self._arm[index]
        if (factor := TouchingFactor.of(block, arm, dependence=self._dependence)) is None:
            if (inverse := _inverse_of_border(block, arm, self._dependence)) is None:
                return False
            self._known = inverse
        self._index, self._factor, self._updates = index, factor, 0
        return True


def _inverse_of_border(block: Array, arm: Array, dependence: float) -> Array | None:
    """Inverse of K, where C_AA may be singular; None if K is."""
    size, level, largest = arm.size + 1, float(block.diagonal().mean()), float(np.abs(arm).max())
    if largest == 0.0:
        return None
    scale = np.full(size, 1.0 / np.sqrt(level) if level > 0.0 else 1.0)
    scale[0] = 1.0 / (largest * scale[-1])
    system = np.zeros((size, size))
    system[0, 1:] = system[1:, 0] = arm
    system[1:, 1:] = block
    system *= np.outer(scale, scale)
    try:
        inverse = np.linalg.inv(system)
    except np.linalg.LinAlgError:
        return None
    condition = float(np.abs(system).sum(axis=0).max()) * float(np.abs(inverse).sum(axis=0).max())
    return np.asarray(inverse * np.outer(scale, scale)) if condition * dependence < 1.0 else None


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
    """A scaled problem with C = diag(d) + U U^T, taken apart once for several active sets."""

    problem: ScaledProblem
    local: Array
    modes: Array  # U (n, m), compressed where there are many segments
    rigid: Bools  # (n), local compliance not divided by

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

    def deflection(self, force: Array) -> Array:
        """Return C F, (n)."""
        deflection = self.local * force
        deflection += self.modes @ (force @ self.modes)
        return deflection


class _BorderedSystem:
    """Factored system of the modal amplitudes, the forces of the segments without local compliance and the rotation."""

    shifted = False

    def __init__(self, modal: ModalProblem, index: Integers) -> None:
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
        soft_separation = separation[self._soft]
        loads = soft_separation @ self._weighted
        side = np.concatenate([-loads[:-1], separation[self._rigid], [torque + loads[-1]]])
        solution, _info = dgetrs(self._factor, self._pivots, side)
        rotation = float(solution[-1])
        force = np.empty(separation.size)
        force[self._rigid] = solution[self._count : -1]
        closing = self._soft_rows @ np.concatenate([solution[: self._count], [-rotation]])
        force[self._soft] = -(closing + soft_separation) / self._local
        return force, rotation


def _block_factor(modal: ModalProblem, index: Integers) -> TouchingFactor | None:
    """Cholesky factor of the block C_AA of the active segments, shifted where it is singular to rounding."""
    modes = modal.modes[index]
    block = modes @ modes.T
    block[np.diag_indices_from(block)] += modal.local[index]
    return TouchingFactor.of(block, modal.problem.lever_arm[index], shift=True)


def solve_modal_active_set(modal: ModalProblem, index: Integers) -> ActiveSetPoint | None:
    """Solve the system of active segments (a), one of them with a lever arm other than zero.

    None where no factor gives a solution, or the block of segments without local compliance is too large.
    """
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        if index.size > SMALL_BLOCK:
            bordered = _BorderedSystem(modal, index)
            point = _refined(modal, index, bordered, REFINEMENTS) if bordered.is_regular else None
            if _is_solved(point, modal.problem.separation) or index.size > LARGEST_BLOCK:
                return point
        if (factor := _block_factor(modal, index)) is None:
            return None
        return _refined(modal, index, factor, SHIFTED_REFINEMENTS if factor.shifted else REFINEMENTS)


def _refined(
    modal: ModalProblem, index: Integers, system: _BorderedSystem | TouchingFactor, refinements: int
) -> ActiveSetPoint | None:
    def deflection(force: Array) -> Array:
        whole = np.zeros(modal.local.size)
        whole[index] = force
        return modal.deflection(whole)

    point = ActiveSetPoint(modal.problem, index, system, deflection)
    for _ in range(refinements):
        point.refine()
    return point if np.isfinite(point.gap).all() else None


def _is_solved(point: ActiveSetPoint | None, separation: Array) -> bool:
    if point is None:
        return False
    level = abs(point.rotation) + float(np.abs(separation[point.index]).max())
    return float(np.abs(point.gap[point.index]).max()) <= RESIDUAL_LIMIT * level
