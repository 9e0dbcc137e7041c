"""The system of the touching segments by its explicit inverse, updated by Schur complements.

    K = [ 0    r_A' ]        K [ -theta ]   [ T   ]
        [ r_A  C_AA ],         [  F_A   ] = [ g_A ].

A segment that enters or leaves changes the inverse by a matrix of rank one: O(a^2) instead of O(a^3). One step of
iterative refinement with C itself takes away what the updates lose, and after many of them the inverse is made anew.
C_AA itself may be singular.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .touching_system import TouchingAnswer

Array = NDArray[np.float64]

#: What is left of a segment's own compliance when the touching ones may yield, relative to it: below this the forces
#: are taken for not unique.
DEPENDENCE_TOLERANCE = 1e-11
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
        self._inverse = np.empty((0, 0))
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
        pivot = own - float(side @ solved)
        if not pivot > DEPENDENCE_TOLERANCE * own:
            return False
        size = solved.size
        inverse = np.empty((size + 1, size + 1))
        inverse[:size, :size] = self._inverse + np.outer(solved, solved / pivot)
        inverse[size, :size] = inverse[:size, size] = -solved / pivot
        inverse[size, size] = 1.0 / pivot
        self._changed(np.append(self._index, segment), inverse)
        return True

    def leave(self, segment: int) -> bool:
        """See `TouchingSystem`."""
        place = int(np.flatnonzero(self._index == segment)[0])
        column = self._inverse[:, place + 1]
        pivot = float(column[place + 1])
        rest = np.delete(self._index, place)
        if not rest.size or not pivot > 0.0 or not self._arm[rest].any():
            return False
        inverse = self._inverse - np.outer(column, column / pivot)
        kept = np.delete(np.arange(column.size), place + 1)
        self._changed(rest, inverse[np.ix_(kept, kept)])
        return True

    def solve(self, closing: Array, torque: Array) -> TouchingAnswer:
        """See `TouchingSystem`."""
        index, arm = self._index, self._arm
        rows = self._compliance[index]
        own, part = np.zeros((index.size, torque.size)), np.vstack([torque, closing[index]])
        rotation = np.zeros(torque.size)
        gap = -closing
        for _ in range(2):
            step = self._inverse @ part
            rotation, own = rotation - step[0], own + step[1:]
            gap = rows.T @ own - arm[:, None] * rotation - closing
            part = np.vstack([torque - arm[index] @ own, -gap[index]])
        force = np.zeros((arm.size, torque.size))
        force[index], gap[index] = own, 0.0
        return TouchingAnswer(force, rotation, gap)

    def solve_held(self, closing: Array) -> Array:
        """See `TouchingSystem`; C_AA must be positive definite."""
        from scipy.linalg import cho_factor, cho_solve

        force = np.zeros(closing.shape)
        block = self._compliance[np.ix_(self._index, self._index)]
        force[self._index] = cho_solve(cho_factor(block, lower=True), closing[self._index])
        return force

    def columns(self, segments: NDArray[np.intp]) -> Array:
        """See `TouchingSystem`."""
        return self._compliance[:, segments]

    def _changed(self, index: NDArray[np.intp], inverse: Array) -> None:
        self._index, self._inverse = index, inverse
        self._updates += 1
        if self._updates >= MAX_UPDATES:
            self._make(index)

    def _make(self, index: NDArray[np.intp]) -> bool:
        """Make the inverse of a set anew, if it is not singular."""
        size = index.size + 1
        system = np.zeros((size, size))
        system[0, 1:] = system[1:, 0] = self._arm[index]
        system[1:, 1:] = self._compliance[np.ix_(index, index)]
        scale = np.ones(size)
        level = float(system.diagonal().mean())
        scale[1:] = 1.0 / np.sqrt(level) if level > 0.0 else 1.0
        largest = float(np.abs(system[0] * scale).max())
        if largest == 0.0:
            return False
        scale[0] = 1.0 / largest
        scaled = system * np.outer(scale, scale)
        try:
            inverse = np.linalg.inv(scaled)
        except np.linalg.LinAlgError:
            return False
        condition = float(np.abs(scaled).sum(axis=0).max()) * float(np.abs(inverse).sum(axis=0).max())
        if not condition * DEPENDENCE_TOLERANCE < 1.0:
            return False
        self._index, self._inverse, self._updates = index, inverse * np.outer(scale, scale), 0
        return True
