"""The compliance matrix C of a contact problem: dense, diagonal plus low rank, or known by its products alone.

Solvers choose their method by the class of a compliance and of its modes, never by values computed earlier.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import array, frozen_arrays, read_only
from ...core.errors import InputError
from .given_compliance import diagonal_of, factor_of, formed, is_operator, is_pair
from .modal_basis import BendingFactor, ModalBasis
from .operator_compliance import OperatorCompliance

Array = NDArray[np.float64]

#: Local compliance over the whole below which the shared modes are looked at.
SMALL_LOCAL_FRACTION = 1e-3
#: Smallest eigenvalue of C, relative to the largest, that is still taken for a rounded zero.
NEGATIVE_EIGENVALUE_TOLERANCE = 1e-12
#: Largest difference between C and its transpose, relative to the largest entry, that is taken for rounding.
ASYMMETRY_TOLERANCE = 1e-10


@frozen_arrays
@dataclass(frozen=True, eq=False)
class DenseCompliance:
    """A compliance given as one matrix.

    Attributes
    ----------
    dense
        C (n, n) [mm/N], symmetric.
    """

    dense: Array

    @property
    def given(self) -> Array:
        """The compliance as a contact problem takes it: the matrix."""
        return self.dense

    def __str__(self) -> str:
        """Form in a few words."""
        return "dense matrix"

    @cached_property
    def diagonal(self) -> Array:
        """Diagonal of C [mm/N], (n)."""
        return read_only(self.dense.diagonal().copy())

    @cached_property
    def is_positive_semidefinite(self) -> bool:
        """Whether no eigenvalue is negative beyond rounding."""
        from scipy.linalg.lapack import dpotrf  # the rest of this module needs no scipy

        # The matrix is symmetric, so its transpose is the same matrix in the order LAPACK wants.
        if dpotrf(self.dense.T, lower=1, clean=0)[1] == 0:
            return True
        eigenvalues = np.linalg.eigvalsh(self.dense)
        least = -NEGATIVE_EIGENVALUE_TOLERANCE * self.dense.shape[0] * max(eigenvalues[-1], 0.0)
        return bool(eigenvalues[0] >= least)

    def deflection(self, force: Array) -> Array:
        """Return C F [mm], (n)."""
        return self.dense @ force

    def with_added(self, local: Array) -> DenseCompliance:
        """Return the compliance with the local one (n) [mm/N] added to its diagonal."""
        dense = self.dense.copy()
        dense[np.diag_indices_from(dense)] += local
        return DenseCompliance(read_only(dense))


@frozen_arrays
@dataclass(frozen=True, eq=False)
class ModalCompliance:
    """A compliance of local springs and bending modes, C = diag(d) + V V^T.

    Attributes
    ----------
    local
        Compliance d of each segment by itself (n) [mm/N], not negative.
    modes
        The factor V as it was given, or already compressed.

    Examples
    --------
    >>> from easeoff.contact import ContactProblem
    >>> problem = ContactProblem([0.0, 1e-3], [50.0, 50.0], 1e4, ([1e-5, 1e-5], [[1e-3], [2e-3]]))
    >>> matrix = problem.compliance_matrix
    >>> type(matrix).__name__, matrix.deflection(np.array([100.0, 0.0])).round(6)
    ('ModalCompliance', array([0.0011, 0.0002]))
    """

    local: Array
    modes: BendingFactor | ModalBasis

    @property
    def factor(self) -> Array:
        """V (n, k) [(mm/N)^0.5]."""
        return self.modes.factor

    @property
    def given(self) -> tuple[Array, Array]:
        """The compliance as a contact problem takes it: the pair of d and V."""
        return self.local, self.factor

    def __str__(self) -> str:
        """Form in a few words."""
        columns = self.factor.shape[1]
        return f"diagonal + {columns} column{'' if columns == 1 else 's'}"

    @property
    def has_few_modes(self) -> bool:
        """Whether modes are fewer than segments, in blocks of half of them, or compressed; else C is the smaller."""
        modes, (size, columns) = self.modes, self.factor.shape
        return isinstance(modes, ModalBasis) or columns < size or 2 * max(rows.size for rows, _ in modes.blocks) <= size

    @cached_property
    def dense(self) -> Array:
        """C as an (n, n) array [mm/N]."""
        dense = self.factor @ self.factor.T
        dense[np.diag_indices_from(dense)] += self.local
        return read_only(dense)

    @cached_property
    def diagonal(self) -> Array:
        """Diagonal of C [mm/N], (n)."""
        return read_only(self.local + np.vecdot(self.factor, self.factor))

    @property
    def is_positive_semidefinite(self) -> bool:
        """True: d is not negative."""
        return True

    @cached_property
    def local_fraction(self) -> float:
        """Least part that a segment's own compliance d has in the whole, min d_i / C_ii.

        Where that is small, the shared modes are left out of the whole: they move many segments alike, as the rotation
        does, and cost the modal method no steps.
        """
        whole = self.diagonal
        least = float((self.local / whole).min()) if whole.min() > 0.0 else 0.0
        if not 0.0 < least < SMALL_LOCAL_FRACTION:
            return least
        shared = self.modes.shared_factor
        without = np.maximum(whole - np.vecdot(shared, shared), self.local)
        return float((self.local / without).min())

    def deflection(self, force: Array) -> Array:
        """Return C F [mm], (n), in O(n k)."""
        return self.local * force + self.factor @ (force @ self.factor)

    def with_added(self, local: Array) -> ModalCompliance:
        """Return the compliance with the local one (n) [mm/N] added to its diagonal; the modes stay the same object."""
        return ModalCompliance(read_only(self.local + local), self.modes)


ComplianceMatrix = DenseCompliance | ModalCompliance | OperatorCompliance


def compliance_matrix(given: Any, size: int) -> ComplianceMatrix:
    """Return the compliance that a contact problem of a number of segments was given.

    Parameters
    ----------
    given
        A `ComplianceMatrix`; an (n, n) array [mm/N], sparse or not, or a `LinearOperator`; or the pair of an (n) array
        d [mm/N] and of V [(mm/N)^0.5], an (n, k) or (n) array, sparse or not, a `LinearOperator` or a `ModalBasis`.
    size
        Number of segments n.

    Raises
    ------
    InputError
        A wrong shape, a number that is not finite, a negative diagonal or an asymmetric matrix.
    """
    if is_operator(given):
        given = OperatorCompliance(given)
    if isinstance(given, ComplianceMatrix):
        if isinstance(given, OperatorCompliance) and given.size != size:
            shape = tuple(given.operator.shape)
            raise InputError(f"compliance = LinearOperator of shape {shape}: must have the shape ({size}, {size})")
        return given
    if isinstance(given, tuple) and len(given) == 2:
        given = diagonal_of(given[0], size), given[1]
    modal = isinstance(given, tuple | list) and len(given) == 2 and isinstance(given[1], ModalBasis)
    if modal or is_pair(given, size):
        diagonal = array("compliance diagonal", given[0], "mm/N", ndim=1, size=size, least=0.0, frozen=True)
        if not modal:
            return ModalCompliance(diagonal, BendingFactor(factor_of(given[1], size)))
        if given[1].size != size:
            raise InputError(f"compliance factor = ModalBasis of {given[1].size} segments: must have {size}")
        return ModalCompliance(diagonal, given[1])
    return DenseCompliance(_symmetric(formed("compliance", given, "mm/N"), size))


def _symmetric(given: Any, size: int) -> Array:
    """The symmetric (n, n) matrix without negative diagonal; asymmetry of the size of rounding is averaged out."""
    compliance = array("compliance", given, "mm/N", ndim=2, frozen=True)
    if compliance.shape != (size, size):
        raise InputError(f"compliance = array of shape {compliance.shape}: must have the shape ({size}, {size})")
    array("compliance diagonal", compliance.diagonal(), "mm/N", least=0.0)
    if np.array_equal(compliance, compliance.T):
        return compliance
    asymmetry = float(np.abs(compliance - compliance.T).max()) / float(np.abs(compliance).max())
    if asymmetry > ASYMMETRY_TOLERANCE:
        raise InputError(
            f"compliance: must be symmetric, by reciprocity; its relative difference from its transpose is "
            f"{asymmetry:.1e}"
        )
    return read_only(0.5 * (compliance + compliance.T))
