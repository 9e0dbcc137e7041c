"""Derivatives of the solution of a contact problem by its data: forward in a direction, adjoint for all data at once.

On the touching segments A the conditions are equations; their derivative is the system of `touching_system` with

    g = -dC F - dS + theta dr,    dT - F'dr

on the right. It is exact as long as the touching set does not change to first order. Where segments touch without a
force (F = Y = 0) the solution has a kink, and its derivative in a direction is one-sided; see `weak_segments`.

The sensitivity of an answer holds which segments are loaded, which are weak, and the compliance there. It gives the
derivative of the solution in one direction of the data, and the gradient of a number read off the solution.
"""

from __future__ import annotations

from dataclasses import field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ....core.arrays import Bools, RealArray as Array, record
from ....core.attributes import StoredStatus
from ....core.checks import array, positive
from ....core.errors import InputError
from ...problem.certificate import Answer
from ...problem.compliance_matrix import ComplianceMatrix, ModalCompliance
from ...problem.contact_problem import ContactProblem
from ..touching_system import TouchingAnswer
from .touching_form import TouchingSystem, touching_system
from .weak_segments import dependent_segments, loaded_and_weak, system_in_direction


def given(name: str, values: Any, unit: str, size: int) -> Array:
    """Return an array (n) that was given, or zeros; InputError if it is none."""
    return np.zeros(size) if values is None else array(name, values, unit, ndim=1, size=size)


def bending_change(
    problem: ContactProblem,
    force: Array,
    local: ArrayLike | None,
    factor: ArrayLike | None,
    compliance: ArrayLike | None,
) -> Array:
    """Change dC F (n) [mm] of the deflections under the same forces, see `Sensitivity.forward`.

    A change of V where C is dense is refused.
    """
    size, bent = problem.size, np.zeros(problem.size)
    if local is not None:
        bent += given("local", local, "mm/N", size) * force
    if factor is not None:
        matrix = problem.compliance_matrix
        if not isinstance(matrix, ModalCompliance):
            raise InputError("factor: must be left out where the compliance is dense; give compliance instead")
        change = array("factor", factor, "(mm/N)^0.5", ndim=2)
        if change.shape != matrix.factor.shape:
            raise InputError(f"factor = array of shape {change.shape}: must have the shape {matrix.factor.shape}")
        bent += change @ (matrix.factor.T @ force) + matrix.factor @ (change.T @ force)
    if compliance is not None:
        whole = array("compliance", compliance, "mm/N", ndim=2)
        if whole.shape != (size, size) or not np.allclose(whole, whole.T, rtol=1e-10, atol=0.0):
            raise InputError(f"compliance: must be a symmetric array of shape ({size}, {size})")
        bent += whole @ force
    return bent


@record(frozen=True, eq=False)
class ProblemGradient:
    """Derivatives of a number J by the data; NaN where J has none.

    Attributes
    ----------
    torque
        dJ/dT.
    separation
        dJ/dS (n).
    lever_arm
        dJ/dr (n).
    one_sided
        Whether some segment touches without a force, so that J has a kink here and these are the derivatives on one
        side of it.

    Examples
    --------
    How the rotation of two equal springs depends on the compliance of each:

    >>> from easeoff.contact import ContactProblem, sensitivity, solve
    >>> springs = ContactProblem([0.0, 0.0], [40.0, 40.0], 8e4, ([1e-6, 1e-6], [[0.0], [0.0]]))
    >>> sensitivity(springs, solve(springs)).adjoint(rotation=1.0).local.round(6).tolist()
    [12.5, 12.5]
    """

    torque: float
    separation: Array
    lever_arm: Array
    one_sided: bool
    _problem: ContactProblem = field(repr=False)
    _force: Array = field(repr=False)
    _energy_weight: float = field(repr=False)

    @cached_property
    def compliance(self) -> Array:
        """dJ/dC (n, n), symmetric: for a symmetric change of C, dJ is the sum of its entries times these."""
        product = np.outer(self.separation, self._force)
        return 0.5 * (product + product.T + self._energy_weight * np.outer(self._force, self._force))

    @cached_property
    def local(self) -> Array:
        """dJ/dd (n), where C = diag(d) + V V'; of a dense C the derivatives by its diagonal."""
        return self._force * (self.separation + 0.5 * self._energy_weight * self._force)

    @cached_property
    def factor(self) -> Array | None:
        """dJ/dV (n, k), where C = diag(d) + V V'; None if the compliance is dense."""
        matrix = self._problem.compliance_matrix
        if not isinstance(matrix, ModalCompliance):
            return None
        weights = self.separation + self._energy_weight * self._force
        amplitudes = matrix.factor.T @ np.column_stack([self._force, self.separation])
        return np.outer(weights, amplitudes[:, 0]) + np.outer(self._force, amplitudes[:, 1])


class Differentiability(StoredStatus):
    """Derivatives that a solution has.

    Examples
    --------
    >>> Differentiability(1).name
    'ONE_SIDED'
    """

    DIFFERENTIABLE = 0
    ONE_SIDED = 1
    FORCES_NOT_UNIQUE = 2


@record(frozen=True, eq=False)
class SolutionChange:
    """Derivative of a solution in one direction of its data; NaN where there is none.

    Attributes
    ----------
    force
        dF (n) [N].
    rotation
        dtheta [rad].
    gap
        dY (n) [mm].
    energy
        Change of the deformation energy 1/2 F'CF [N mm].
    active
        Segments that touch just beyond, in this direction (n).
    one_sided
        Whether the derivative holds in this direction alone, and not against it.
    message
        Why there is none, if so.

    Examples
    --------
    The second of two springs is about to touch: turning on, it carries half; turning back, nothing.

    >>> from easeoff.contact import ContactProblem, sensitivity, solve
    >>> springs = ContactProblem([0.0, 1e-3], [40.0, 40.0], 4e4, np.diag([1e-6, 1e-6]))
    >>> slope = sensitivity(springs, solve(springs))
    >>> [slope.forward(torque=sign * 80.0).force.round(6).tolist() for sign in (1.0, -1.0)]
    [[1.0, 1.0], [-2.0, 0.0]]
    """

    force: Array
    rotation: float
    gap: Array
    energy: float
    active: Bools
    one_sided: bool
    message: str = ""


#: Gap that opens at segments whose forces are not unique, relative to the largest, that is taken for rounding.
CONSISTENCY_TOLERANCE = 1e-9


@record(frozen=True, eq=False)
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
    loaded: Bools
    weak: Bools
    _tangent: ComplianceMatrix = field(repr=False)
    _deflection: Array = field(repr=False)

    @property
    def status(self) -> Differentiability:
        """Differentiability of the solution: it is differentiable, has a kink, or has forces that are not unique."""
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
        if (system := self._toward(closing, moment)) is None:
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
    ) -> TouchingAnswer:
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
        TouchingAnswer
            Derivatives of forces (n, q) [N], rotations (q) [rad] and gaps (n, q) [mm]; NaN where the solution has a
            kink, or forces that are not unique: `forward` has its one-sided derivatives.

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
        wanted, given_arrays = (self.problem.size, turn.size), []
        for name, values in (("separation", separation), ("lever_arm", lever_arm), ("bent", bent)):
            given_arrays.append(array(name, values, "mm", ndim=2))
            if given_arrays[-1].shape != wanted:
                raise InputError(f"{name} = array of shape {given_arrays[-1].shape}: must have the shape {wanted}")
        gap, arm, bending = given_arrays
        if self.status is not Differentiability.DIFFERENTIABLE:
            return TouchingAnswer(*(np.full(shape, np.nan) for shape in (wanted, turn.size, wanted)))
        return self._smooth.solve(self.rotation * arm - gap - bending, turn - self.force @ arm)

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
        by_rotation, by_energy = (float(array(n, v, ndim=0)) for n, v in (("rotation", rotation), ("energy", energy)))
        system = self._smooth if active is None else self._side(active)
        touching, undetermined = system.active, self._undetermined(system)
        if not touching.any() or (undetermined.any() and by_force.any()):
            return self._gradient(np.nan, np.full(size, np.nan), np.nan)
        by_gap = np.where(touching | undetermined, 0.0, by_gap)
        pull = by_force + by_energy * self._deflection + self._tangent.deflection(by_gap)
        moment = by_rotation - float(self.problem.lever_arm @ by_gap)
        # The transposed system is the system itself with the signs of moment and rotation changed.
        forces, turned, _ = system.solve(pull[:, None], np.array([-moment])).column(0)
        if undetermined.any():
            return self._gradient(-turned, np.full(size, np.nan), by_energy)
        return self._gradient(-turned, by_gap - forces, by_energy)

    def _gradient(self, torque: float, separation: Array, energy: float) -> ProblemGradient:
        arm = -self.rotation * separation - torque * self.force
        return ProblemGradient(torque, separation, arm, bool(self.weak.any()), self.problem, self.force, energy)

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

    def _undetermined(self, system: TouchingSystem) -> Bools:
        """Loaded segments that the system leaves out, because their forces are not unique (n)."""
        return np.asarray(self.loaded & ~system.active)

    def _none(self, message: str) -> SolutionChange:
        nothing = np.full(self.problem.size, np.nan)
        return SolutionChange(nothing, np.nan, nothing, np.nan, self.loaded, bool(self.weak.any()), message)


#: A force and a gap that are both below this part of their scales count as none.
DEGENERACY_TOLERANCE = 1e-10
#: Deflection, relative to what the most compliant segment has under the largest force, that is taken for rounding.
RIGID_FRACTION = 1e-12


def answer_sensitivity(problem: ContactProblem, answer: Answer, tolerance: float = DEGENERACY_TOLERANCE) -> Sensitivity:
    """Return the derivatives of a proved answer to a contact problem; see `sensitivity`."""
    deflection = problem.deflection(answer.force)
    return tangent_answer_sensitivity(problem, answer, problem.compliance_matrix, deflection, tolerance)


def tangent_answer_sensitivity(
    problem: ContactProblem, answer: Answer, tangent: ComplianceMatrix, deflection: Array, tolerance: float
) -> Sensitivity:
    """Derivatives where the compliance depends on the load; tangent of deflections (n) [mm] by forces [mm/N]."""
    positive("tolerance", tolerance, zero=True)
    force, gap = answer.force, answer.gap
    scale = abs(answer.elastic_rotation) * float(np.abs(problem.lever_arm[force > 0.0]).max(initial=0.0))
    yielding = float(force.max()) * float(tangent.diagonal.max())
    if scale <= RIGID_FRACTION * yielding:  # what touches is rigid
        scale = yielding or float(np.abs(problem.separation_at_first_contact).max()) or 1.0
    loaded, weak = loaded_and_weak(force, gap, scale, tolerance)
    dependent = dependent_segments(tangent, problem.lever_arm, loaded, weak)
    loaded, weak = loaded | dependent, weak & ~dependent
    return Sensitivity(problem, force, gap, answer.rotation, loaded, weak, tangent, deflection)
