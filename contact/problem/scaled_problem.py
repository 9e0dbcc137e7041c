"""The contact problem in scaled numbers, every one of order one: what solvers get."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .compliance_matrix import ModalCompliance
from .modal_basis import ModalBasis, SharedModes
from .operator_compliance import OperatorCompliance

if TYPE_CHECKING:
    import qpsolvers

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ScaledModes:
    """The compliance diag(d) + V V^T in another unit; nothing is formed before it is asked for.

    Attributes
    ----------
    compliance
        In a unit of its own.
    unit
        Unit in which its numbers are wanted [mm/N], a power of two.
    """

    compliance: ModalCompliance
    unit: float

    @property
    def dense(self) -> Array:
        """C, (n, n)."""
        return self.compliance.dense * (1.0 / self.unit)

    @cached_property
    def diagonal(self) -> Array:
        """Local compliance d, (n)."""
        return self.compliance.local * (1.0 / self.unit)

    @cached_property
    def factor(self) -> Array:
        """V, (n, k): C = diag(d) + w V V^T with the weight w."""
        return self.compliance.factor * (1.0 / self._root)

    @property
    def compressed_factor(self) -> Array:
        """V in as few columns as it has directions, (n, r)."""
        return self.compliance.modes.basis.factor * (1.0 / self._root)

    @property
    def weight(self) -> float:
        """Weight w of the factor, one or one half: the root of a power of two may be none, and no bit shall be lost."""
        return self._root * (self._root / self.unit)

    @property
    def _root(self) -> float:
        return math.ldexp(1.0, (math.frexp(self.unit)[1] - 1) // 2)

    @property
    def whole_diagonal(self) -> Array:
        """Diagonal of C, (n)."""
        return self.compliance.diagonal * (1.0 / self.unit)

    @property
    def mode_count(self) -> int:
        """Columns of V."""
        return int(self.compliance.factor.shape[1])

    @property
    def basis(self) -> ModalBasis:
        """V compressed by blocks, scaled: with weight one."""
        given, scale = self.compliance.modes.basis, 1.0 / math.sqrt(self.unit)
        shared = given.shared and SharedModes(given.shared.columns, given.shared.mixing * scale)
        return ModalBasis(given.size, given.index, given.modes * scale, shared)


@dataclass(frozen=True, eq=False)
class ScaledOperator:
    """A compliance known by its products alone, in another unit.

    Attributes
    ----------
    compliance
        In a unit of its own.
    unit
        Unit in which its numbers are wanted [mm/N], a power of two.
    """

    compliance: OperatorCompliance
    unit: float

    @property
    def dense(self) -> Array:
        """Refused, see `OperatorCompliance.dense`."""
        return self.compliance.dense

    @property
    def whole_diagonal(self) -> Array:
        """Diagonal of C, (n)."""
        return self.compliance.diagonal * (1.0 / self.unit)

    def deflection(self, force: Array) -> Array:
        """C F, (n)."""
        return self.compliance.deflection(force) * (1.0 / self.unit)


@dataclass(frozen=True, eq=False)
class ScaledProblem:
    """A contact problem in scaled numbers: minimise 1/2 F'CF + S'F subject to r'F = T, F >= 0.

    Attributes
    ----------
    given_compliance
        Mean diagonal of order one: an (n, n) array, local compliance and modes, or what gives products alone.
    separation
        Counted from first contact and clipped (n).
    lever_arm
        Mean of order one (n).
    torque
        Of the order of the number of segments in contact.
    """

    given_compliance: Array | ScaledModes | ScaledOperator
    separation: Array
    lever_arm: Array
    torque: float

    @cached_property
    def compliance(self) -> Array:
        """C as an (n, n) array; `InputError` where only its products are known."""
        given = self.given_compliance
        return given if isinstance(given, np.ndarray) else given.dense

    @property
    def modal(self) -> ScaledModes | None:
        """The compliance as local part and modes, if it was given so."""
        return self.given_compliance if isinstance(self.given_compliance, ScaledModes) else None

    @property
    def has_matrix(self) -> bool:
        """Whether C can be had as an array."""
        return not isinstance(self.given_compliance, ScaledOperator)

    def deflection(self, force: Array) -> Array:
        """C F, (n), in O(n k) of a structured compliance."""
        given = self.given_compliance
        if isinstance(given, ScaledModes):
            return given.diagonal * force + given.weight * (given.factor @ (force @ given.factor))
        return given @ force if isinstance(given, np.ndarray) else given.deflection(force)

    @property
    def is_finite(self) -> bool:
        """Whether no number has overflowed."""
        # No entry of a positive semidefinite matrix exceeds its diagonal.
        given = self.given_compliance
        compliance = given if isinstance(given, np.ndarray) else given.whole_diagonal
        return bool(np.isfinite(self.separation).all() and np.isfinite(compliance).all() and math.isfinite(self.torque))

    def as_products(self) -> qpsolvers.Problem:
        """Return the qpsolvers problem with P as a `scipy.sparse.linalg.LinearOperator`."""
        import qpsolvers
        from scipy.sparse.linalg import LinearOperator

        size = self.separation.size
        product: Any = LinearOperator((size, size), dtype=np.float64, matvec=lambda x: self.deflection(x.ravel()))
        row, torque = self.lever_arm[np.newaxis, :].copy(), np.array([self.torque])
        return qpsolvers.Problem(product, self.separation.copy(), A=row, b=torque, lb=np.zeros(size))

    def as_qp(self, *, sparse: bool = False) -> qpsolvers.Problem:
        """Return the qpsolvers problem, with csc matrices if `sparse`."""
        import qpsolvers  # imports every installed solver: half a second, paid only here

        matrix: Any = self.compliance
        row: Any = self.lever_arm[np.newaxis, :]
        if sparse:
            from scipy.sparse import csc_matrix

            matrix, row = csc_matrix(matrix), csc_matrix(row)
        return qpsolvers.Problem(
            matrix, self.separation, A=row, b=np.array([self.torque]), lb=np.zeros(self.separation.size)
        )
