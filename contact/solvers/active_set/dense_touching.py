"""The system of the touching segments by a Cholesky factor, and by its explicit inverse once the segments change.

    K = [ 0    r_A' ]        K [ -theta ]   [ T   ]
        [ r_A  C_AA ],         [  F_A   ] = [ g_A ].

A segment that enters or leaves changes the inverse by a matrix of rank one (Schur complement): O(a^2) instead of
O(a^3). One step of iterative refinement with C itself takes away what the updates lose, and after many of them the
inverse is made anew. C_AA itself may be singular.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .active_set_system import DEPENDENCE_TOLERANCE, TouchingFactor
from .touching_system import TouchingAnswer

Array = NDArray[np.float64]

#: Updates after which the inverse is made anew.
MAX_UPDATES = 100


class DenseTouching:
    """See `touching_system.TouchingSystem`.

    Parameters
    ----------
    compliance
        C (n, n) [mm/N], symmetric and positive semidefinite.
    lever_arm
        r (n) [mm].
    active
        Touching segments (n). Those whose forces would not be unique are left out.
    """

    def __init__(self, compliance: Array, lever_arm: Array, active: NDArray[np.bool_]) -> None:
        self._compliance, self._arm = compliance, lever_arm
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
    def active(self) -> NDArray[np.bool_]:
        """See `TouchingSystem`."""
        mask = np.zeros(self._arm.size, dtype=np.bool_)
        mask[self._index] = True
        return mask

    def enter(self, segment: int) -> bool:
        """See `TouchingSystem`."""
        if not self._index.size:
            return self._make(np.array([segment], dtype=np.intp))
        side = np.append(self._arm[segment], self._compliance[self._index, segment])
        solved = self._inverse @ side
        own = float(self._compliance[segment, segment])
        yielded = float(side @ solved)
        pivot = own - yielded
        if not pivot > DEPENDENCE_TOLERANCE * max(own, abs(yielded)):
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
        """See `TouchingSystem`."""
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
        """See `TouchingSystem`."""
        index, arm = self._index, self._arm[self._index]
        found = self._apply(np.vstack([torque, closing[index]]))
        force, rotation = np.zeros(closing.shape), -found[0]
        force[index] = found[1:]
        gap = self._gap(force, rotation, closing)
        if self._factor is None:
            found = self._apply(np.vstack([torque - arm @ force[index], -gap[index]]))
            force[index] += found[1:]
            rotation = rotation - found[0]
            gap = self._gap(force, rotation, closing)
        gap[index] = 0.0
        return TouchingAnswer(force, rotation, gap)

    def _gap(self, force: Array, rotation: Array, closing: Array) -> Array:
        return np.asarray(self._compliance @ force - self._arm[:, None] * rotation - closing)

    def yielding(self) -> Array:
        """See `TouchingSystem`; C_AA must not be singular."""
        rows = self._compliance[self._index]
        if self._factor is not None:
            held = self._factor.solve(rows)
        else:
            turning = self._known[1:, 0]
            held = (self._known[1:, 1:] - np.outer(turning, turning / self._known[0, 0])) @ rows
        result = self._compliance.diagonal() - np.einsum("ij,ij->j", rows, held)
        result[self._index] = 0.0
        return np.asarray(result)

    def columns(self, segments: NDArray[np.intp]) -> Array:
        """See `TouchingSystem`."""
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

    def _changed(self, index: NDArray[np.intp], inverse: Array) -> None:
        self._index, self._known = index, inverse
        self._updates += 1
        if self._updates >= MAX_UPDATES:
            self._make(index)

    def _make(self, index: NDArray[np.intp]) -> bool:
        """Factorise a set anew, if it is not singular."""
        block, arm = self._compliance[np.ix_(index, index)], self._arm[index]
        factor = TouchingFactor.of(block, arm)
        if factor is None:
            inverse = _inverse_of_border(block, arm)
            if inverse is None:
                return False
            self._known = inverse
        self._index, self._factor, self._updates = index, factor, 0
        return True


def _inverse_of_border(block: Array, arm: Array) -> Array | None:
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
    return np.asarray(inverse * np.outer(scale, scale)) if condition * DEPENDENCE_TOLERANCE < 1.0 else None
