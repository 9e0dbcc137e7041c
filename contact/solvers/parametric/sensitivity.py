"""Derivatives of the solution of a contact problem by its data: forward in a direction, adjoint for all data at once.

On the touching segments A the conditions are equations; their derivative is the system of `touching_system` with

    g = -dC F - dS + theta dr,    dT - F'dr

on the right. It is exact as long as the touching set does not change to first order. Where segments touch without a
force (F = Y = 0) the solution has a kink, and its derivative in a direction is one-sided; see `weak_segments`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ....core.checks import array, frozen_arrays
from ....core.errors import InputError
from ...problem.compliance_matrix import ComplianceMatrix
from ...problem.contact_problem import ContactProblem
from ..active_set.touching_system import TouchingSystem
from .data_direction import bending_change, given
from .problem_gradient import ProblemGradient
from .solution_change import Differentiability, SolutionChange
from .touching_form import touching_system
from .weak_segments import system_in_direction

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

#: Gap that opens at segments whose forces are not unique, relative to the largest, that is taken for rounding.
CONSISTENCY_TOLERANCE = 1e-9


class Changes(NamedTuple):
    """Derivatives in several directions: forces (n, q) [N], rotations (q) [rad] and gaps (n, q) [mm]."""

    force: Array
    rotation: Array
    gap: Array


@frozen_arrays
@dataclass(frozen=True, eq=False)
class Sensitivity:
    """Derivatives of one solution; see `sensitivity`.

    Attributes
    ----------
    problem
        The contact problem.
    force, gap, rotation
        Its solution F (n) [N], Y (n) [mm], theta [rad].
    loaded
        Segments that carry load, or could at no cost (n).
    weak
        Segments that touch without a force (n).

    Examples
    --------
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem, sensitivity, solve
    >>> bed = ContactProblem([0.0, 1e-3], [50.0, 50.0], 2e5, ([1e-6, 1e-6], [[0.0], [0.0]]))
    >>> slope = sensitivity(bed, solve(bed))
    >>> slope.status.name, round(slope.forward(torque=1.0).rotation * 1e10, 6)
    ('DIFFERENTIABLE', 2.0)
    >>> slope.adjoint(force=[1.0, 0.0]).separation.tolist()
    [-500000.0, 500000.0]
    """

    problem: ContactProblem
    force: Array
    gap: Array
    rotation: float
    loaded: Mask
    weak: Mask
    _tangent: ComplianceMatrix = field(repr=False)
    _deflection: Array = field(repr=False)

    @property
    def status(self) -> Differentiability:
        """Whether the solution is differentiable, has a kink, or has forces that are not unique."""
        if self._undetermined(self._smooth).any():
            return Differentiability.FORCES_NOT_UNIQUE
        return Differentiability.ONE_SIDED if self.weak.any() else Differentiability.DIFFERENTIABLE

    def forward(
        self,
        *,
        torque: float = 0.0,
        separation: ArrayLike | None = None,
        lever_arm: ArrayLike | None = None,
        local: ArrayLike | None = None,
        factor: ArrayLike | None = None,
        compliance: ArrayLike | None = None,
    ) -> SolutionChange:
        """Return the derivative in a direction of the data.

        Parameters
        ----------
        torque
            dT [N mm].
        separation
            dS (n) [mm].
        lever_arm
            dr (n) [mm].
        local
            Change of the diagonal of C (n) [mm/N].
        factor
            dV (n, k) [(mm/N)^0.5], of a structured compliance.
        compliance
            Change of C as a symmetric matrix (n, n) [mm/N], of any form; adds to the two before.

        Raises
        ------
        InputError
            A wrong shape, a number that is not finite, or a change of V where C is dense.
        """
        size = self.problem.size
        turn = float(array("torque", torque, "N mm", ndim=0))
        gap = given("separation", separation, "mm", size)
        arm = given("lever_arm", lever_arm, "mm", size)
        bent = bending_change(self.problem, self.force, local, factor, compliance)
        closing, moment = self.rotation * arm - gap - bent, turn - float(arm @ self.force)
        moving = bool(arm.any() or bent.any())
        system = self._toward(closing, moment)
        if system is None:
            return self._none("no solution in this direction: the bodies part, or the touching segments cannot be told")
        force, rotation, opening = system.solve(closing[:, None], np.array([moment])).column(0)
        energy = float(self._deflection @ force + 0.5 * self.force @ bent)
        undetermined = self._undetermined(system)
        if undetermined.any():
            level = max(float(np.abs(opening).max()), float(np.abs(closing).max()))
            if moving or np.abs(opening[undetermined]).max() > CONSISTENCY_TOLERANCE * level:
                return self._none("the forces are not unique, and this change of the data decides between them")
            opening, force = np.where(undetermined, 0.0, opening), np.full(size, np.nan)
        return SolutionChange(force, rotation, opening, energy, system.active, bool(self.weak.any()))

    def forward_all(
        self, *, torque: ArrayLike, separation: ArrayLike, lever_arm: ArrayLike, bent: ArrayLike
    ) -> Changes:
        """Return the derivatives in many directions at once (q), with one system for all.

        Parameters
        ----------
        torque
            dT (q) [N mm].
        separation, lever_arm
            dS and dr (n, q) [mm].
        bent
            Change of the deflections under the same forces, dC F (n, q) [mm].

        Returns
        -------
        Changes
            NaN where the solution has a kink, or forces that are not unique: `forward` has its one-sided derivatives.

        Raises
        ------
        InputError
            A wrong shape, or a number that is not finite.

        Examples
        --------
        >>> from easeoff.contact import ContactProblem, sensitivity, solve
        >>> springs = ContactProblem([0.0, 0.0], [40.0, 40.0], 8e4, ([1e-6, 1e-6], [[0.0], [0.0]]))
        >>> none = np.zeros((2, 1))
        >>> changes = sensitivity(springs, solve(springs)).forward_all(
        ...     torque=[80.0], separation=none, lever_arm=none, bent=none
        ... )
        >>> changes.force[:, 0].round(9).tolist()
        [1.0, 1.0]
        """
        turn = array("torque", torque, "N mm", ndim=1)
        gap, arm, bending = (
            array(name, values, "mm", ndim=2)
            for name, values in (("separation", separation), ("lever_arm", lever_arm), ("bent", bent))
        )
        wanted = (self.problem.size, turn.size)
        for name, values in (("separation", gap), ("lever_arm", arm), ("bent", bending)):
            if values.shape != wanted:
                raise InputError(f"{name} = array of shape {values.shape}: must have the shape {wanted}")
        if self.status is not Differentiability.DIFFERENTIABLE:
            return Changes(*(np.full(shape, np.nan) for shape in (wanted, turn.size, wanted)))
        closing = self.rotation * arm - gap - bending
        return Changes(*self._smooth.solve(closing, turn - self.force @ arm))

    def adjoint(
        self,
        *,
        force: ArrayLike | None = None,
        rotation: float = 0.0,
        gap: ArrayLike | None = None,
        energy: float = 0.0,
        active: ArrayLike | None = None,
    ) -> ProblemGradient:
        """Return the gradient of J = sum of weights times forces, rotation, gaps and energy, by all data.

        Parameters
        ----------
        force
            Weights of the forces (n).
        rotation
            Weight of the rotation.
        gap
            Weights of the gaps (n).
        energy
            Weight of the deformation energy 1/2 F'CF.
        active
            Where segments touch without a force: the touching set of the side of the kink on which the gradient is
            wanted (n), see `SolutionChange.active`. By default these segments are taken for open.

        Raises
        ------
        InputError
            A wrong shape, or a number that is not finite.
        """
        size = self.problem.size
        by_force, by_gap = given("force", force, "", size), given("gap", gap, "", size)
        by_rotation = float(array("rotation", rotation, ndim=0))
        by_energy = float(array("energy", energy, ndim=0))
        system = self._smooth if active is None else self._side(active)
        touching, undetermined = system.active, self._undetermined(system)
        if not touching.any() or (undetermined.any() and by_force.any()):
            return self._gradient(np.nan, np.full(size, np.nan), np.nan)
        by_gap = np.where(touching | undetermined, 0.0, by_gap)
        pull = by_force + by_energy * self._deflection + self._tangent.deflection(by_gap)
        moment = by_rotation - float(self.problem.lever_arm @ by_gap)
        # The transposed system is the system itself with the signs of moment and rotation changed.
        held, turned, _ = system.solve(pull[:, None], np.array([-moment])).column(0)
        if undetermined.any():
            return self._gradient(-turned, np.full(size, np.nan), by_energy)
        return self._gradient(-turned, by_gap - held, by_energy)

    def _gradient(self, torque: float, separation: Array, energy: float) -> ProblemGradient:
        arm = -self.rotation * separation - torque * self.force
        one_sided = bool(self.weak.any())
        return ProblemGradient(torque, separation, arm, one_sided, self.problem, self.force, energy)

    def _toward(self, closing: Array, moment: float) -> TouchingSystem | None:
        """The system on the side of a kink to which a direction leads."""
        if not self.weak.any() and self.loaded.any():
            return self._smooth
        return system_in_direction(self._tangent, self.problem.lever_arm, self.loaded, self.weak, closing, moment)

    def _side(self, active: ArrayLike) -> TouchingSystem:
        mask = np.asarray(active, dtype=np.bool_)
        if mask.shape != self.loaded.shape or (mask & ~(self.loaded | self.weak)).any() or (self.loaded & ~mask).any():
            raise InputError("active: must be the loaded segments and some of the weak ones, as a mask")
        return touching_system(self._tangent, self.problem.lever_arm, mask)

    @cached_property
    def _smooth(self) -> TouchingSystem:
        """The system of the loaded segments; it is never changed."""
        return touching_system(self._tangent, self.problem.lever_arm, self.loaded)

    def _undetermined(self, system: TouchingSystem) -> Mask:
        """Loaded segments that the system leaves out, because their forces are not unique (n)."""
        return np.asarray(self.loaded & ~system.active)

    def _none(self, message: str) -> SolutionChange:
        nothing = np.full(self.problem.size, np.nan)
        return SolutionChange(nothing, np.nan, nothing, np.nan, self.loaded, bool(self.weak.any()), message)
