"""The compliance matrix C of a contact problem: dense, diagonal plus low rank, or known by its products alone.

Solvers choose their method by the class of a compliance and of its modes, never by values computed earlier.

Users may give sparse matrices and a factor of one column, which become arrays, or a
`scipy.sparse.linalg.LinearOperator`, such as a convolution by FFT: then C is known by its products alone. From products
one can prove that C is not positive semidefinite, never that it is: an answer found with such a compliance is proved on
that assumption, and says so.
"""

from __future__ import annotations

import sys
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ...core.arrays import RealArray as Array, record
from ...core.checks import array, read_only, shown
from ...core.errors import InputError
from .modal_basis import BendingFactor, ModalBasis

if TYPE_CHECKING:
    from scipy.sparse.linalg import LinearOperator


#: Entries of the largest array that is formed from a sparse matrix or from the products of a factor: 3.2 GB.
LARGEST_FORMED = 400_000_000


def is_sparse(value: object) -> bool:
    """True for a sparse array or matrix of scipy; nothing is imported for it."""
    module: Any = sys.modules.get("scipy.sparse")
    return module is not None and bool(module.issparse(value))


def is_operator(value: object) -> bool:
    """True for a `scipy.sparse.linalg.LinearOperator`; nothing is imported for it."""
    module: Any = sys.modules.get("scipy.sparse.linalg")
    return module is not None and isinstance(value, module.LinearOperator)


def dimensions(value: Any) -> int:
    """Number of dimensions of an array, a sparse array or an operator."""
    return len(value.shape) if is_sparse(value) or is_operator(value) else np.ndim(value)


def is_pair(given: Any, size: int) -> bool:
    """True if a compliance is the pair (d, V) of (n) numbers and an (n, k) or (n) array.

    For n = 2 a list is a matrix and a tuple a pair; a tuple that is a symmetric matrix, too, is refused.
    """
    if not (isinstance(given, tuple | list) and len(given) == 2 and dimensions(given[0]) == 1):
        return False
    if dimensions(given[1]) != 1:
        return dimensions(given[1]) == 2
    if size != 2 or is_sparse(given[1]):
        return True
    if isinstance(given, list):
        return False
    if len(given[0]) == len(given[1]) == 2 and given[0][1] == given[1][0]:
        raise InputError(
            "compliance = two rows of two numbers: must be an array or a list for a matrix, and have V as an array of "
            "shape (2, 1) for the pair (d, V)"
        )
    return True


def diagonal_of(given: Any, size: int) -> Any:
    """Vector d of a pair (d, V): the diagonal of a diagonal matrix (n, n), sparse or not; else as given."""
    if dimensions(given) != 2 or tuple(np.shape(given)) != (size, size):
        return given
    row, column = given.nonzero() if is_sparse(given) else np.nonzero(given)
    if (row != column).any():
        raise InputError(
            f"compliance diagonal = matrix of shape ({size}, {size}): must have zeros beside its diagonal, or be the "
            f"diagonal d alone, {size} numbers [mm/N]"
        )
    return given.diagonal() if is_sparse(given) else np.diagonal(given)


def formed(name: str, given: Any, unit: str) -> Any:
    """A sparse matrix, or a factor known by its products, as an array; anything else as it is."""
    if not (is_sparse(given) or is_operator(given)):
        return given
    sparse, kind = is_sparse(given), np.dtype(given.dtype)
    what = "sparse matrix" if sparse else "LinearOperator"
    if kind.kind not in "fiu":
        part = "; give its real part (.real), if the imaginary one is zero" if kind.kind == "c" and sparse else ""
        raise InputError(f"{name} = {what} of {kind.name}: must be of real numbers [{unit}]{part}")
    if np.prod(given.shape, dtype=float) > LARGEST_FORMED:
        raise InputError(
            f"{name} = {what} of shape {tuple(given.shape)}: must have at most {LARGEST_FORMED} entries in all; of a "
            "larger one give the products, OperatorCompliance(aslinearoperator(matrix), matrix.diagonal())"
        )
    return given.toarray() if sparse else given.matmat(np.eye(given.shape[1]))


def _diagonal(given: Any, size: int) -> Array:
    return array("compliance diagonal", given, "mm/N", ndim=1, size=size, least=0.0, frozen=True)


def factor_of(given: Any, size: int) -> Array:
    """Factor V (n, k) [(mm/N)^0.5]; a single mode may be given as (n)."""
    whole = formed("compliance factor", given, "(mm/N)^0.5")
    if np.ndim(whole) == 1:
        whole = array("compliance factor", whole, "(mm/N)^0.5", ndim=1, size=size)[:, np.newaxis]
    factor = array("compliance factor", whole, "(mm/N)^0.5", ndim=2, frozen=True)
    if factor.shape[0] != size:
        raise InputError(f"compliance factor = array of shape {factor.shape}: must have {size} rows")
    return factor


#: Products spent in the search for a negative eigenvalue; found are those at the end of the spectrum.
LANCZOS_STEPS = 20
#: Smallest eigenvalue of C, relative to n times the largest, that is still taken for a rounded zero.
NEGATIVE_EIGENVALUE_TOLERANCE = 1e-12
#: Largest difference of x'C y and y'C x, relative to the lengths of their vectors, that is taken for rounding.
ASYMMETRY_TOLERANCE = 1e-10


@record(frozen=True, eq=False)
class OperatorCompliance:
    """A compliance given by its products with forces.

    Methods that need the matrix refuse it; those that need only products take it, see ``Solver``. Symmetry is checked
    on a pair of random vectors, and a negative eigenvalue is searched for in a Krylov space of 20 products. That there
    is none cannot be proved so: it is assumed, and the message of a solution says it.

    Attributes
    ----------
    operator
        C (n, n) [mm/N] as a `scipy.sparse.linalg.LinearOperator` of real numbers, symmetric and positive semidefinite.
    known_diagonal
        Its diagonal (n) [mm/N]; that of the method ``diagonal()`` of the operator, if it has one, where left out.
        Without it the problem has no scaling and no certificate.

    Raises
    ------
    InputError
        The operator is not square, not real or not symmetric, or the diagonal has another length or a negative entry.

    Examples
    --------
    >>> from scipy.sparse.linalg import aslinearoperator
    >>> from easeoff.contact import ContactProblem, certify
    >>> springs = OperatorCompliance(aslinearoperator(np.diag([1e-6, 1e-6])), [1e-6, 1e-6])
    >>> problem = ContactProblem([0.0, 0.0], [40.0, 40.0], 8.0e4, springs)
    >>> problem.deflection(np.array([1000.0, 0.0])).tolist()
    [0.001, 0.0]
    >>> certify(problem, np.array([1000.0, 1000.0]), 2.5e-5).passes()
    True
    """

    operator: LinearOperator
    known_diagonal: ArrayLike | None = None

    def __post_init__(self) -> None:
        """Check shape, numbers and symmetry."""
        if not is_operator(self.operator):
            raise InputError(f"operator = {shown(self.operator)}: must be a scipy.sparse.linalg.LinearOperator")
        shape = tuple(self.operator.shape)
        if shape[0] != shape[1]:
            raise InputError(f"compliance = LinearOperator of shape {shape}: must be square")
        kind = np.dtype(self.operator.dtype).kind
        if kind not in "fiu":
            raise InputError(
                f"compliance = LinearOperator of {np.dtype(self.operator.dtype).name}: must be of real numbers; where "
                "the imaginary part is zero, return the real part of the product and give dtype=float"
            )
        if self.known_diagonal is not None:
            object.__setattr__(self, "known_diagonal", _diagonal(self.known_diagonal, shape[0]))
        self._require_symmetry()

    @property
    def size(self) -> int:
        """Number of segments n."""
        return int(self.operator.shape[0])

    def __str__(self) -> str:
        """Form in a few words."""
        return "products alone"

    @property
    def given(self) -> OperatorCompliance:
        """The compliance as a contact problem takes it: this one."""
        return self

    @property
    def dense(self) -> Array:
        """Refused: the matrix is not formed.

        Raises
        ------
        InputError
            Always; the message says how to form it.
        """
        raise InputError(
            f"compliance = LinearOperator of shape {shown(tuple(self.operator.shape))}: must be a matrix for this; "
            "operator @ numpy.eye(n) forms it"
        )

    @cached_property
    def diagonal(self) -> Array:
        """Diagonal of C [mm/N], (n).

        Raises
        ------
        InputError
            It was not given, and the operator has none.
        """
        if self.known_diagonal is not None:
            return np.asarray(self.known_diagonal)
        method: Any = getattr(self.operator, "diagonal", None)
        if not callable(method):
            raise InputError(
                "compliance diagonal: must be given with a LinearOperator, for scaling and certificate: "
                "OperatorCompliance(operator, diagonal)"
            )
        return _diagonal(method(), self.size)

    @cached_property
    def is_positive_semidefinite(self) -> bool:
        """False if a negative eigenvalue was found, beyond rounding; True proves nothing."""
        least, largest = _extreme_ritz_values(self)
        return least >= -NEGATIVE_EIGENVALUE_TOLERANCE * self.size * max(largest, 0.0)

    def deflection(self, force: Array) -> Array:
        """Return C F [mm], (n)."""
        return np.asarray(self.operator.matvec(force), dtype=np.float64)

    def with_added(self, local: Array) -> OperatorCompliance:
        """Return the compliance with the local one (n) [mm/N] added to its diagonal."""
        from scipy.sparse import diags
        from scipy.sparse.linalg import aslinearoperator

        whole = None if self.known_diagonal is None else read_only(self.diagonal + local)
        return OperatorCompliance(self.operator + aslinearoperator(diags(local)), whole)

    def _require_symmetry(self) -> None:
        left, right = np.random.default_rng(0).standard_normal((2, self.size))
        of_left, of_right = self.deflection(left), self.deflection(right)
        scale = float(np.linalg.norm(left) * np.linalg.norm(of_right) + np.linalg.norm(right) * np.linalg.norm(of_left))
        difference = abs(float(left @ of_right) - float(right @ of_left))
        if not np.isfinite(scale):
            raise InputError("compliance = LinearOperator: must give finite numbers [mm/N]; a product has others")
        if difference > ASYMMETRY_TOLERANCE * scale:
            raise InputError(
                f"compliance: must be symmetric, by reciprocity; x'C y and y'C x of two random vectors differ by "
                f"{difference / scale:.1e}"
            )


def _extreme_ritz_values(compliance: OperatorCompliance) -> tuple[float, float]:
    """Least and largest eigenvalue of C in a Krylov space, by Lanczos' method with full orthogonalisation."""
    size = compliance.size
    vector = np.random.default_rng(1).standard_normal(size)
    basis = [vector / np.linalg.norm(vector)]
    diagonal, beside = list[float](), list[float]()
    for _ in range(min(LANCZOS_STEPS, size)):
        product = compliance.deflection(basis[-1])
        diagonal.append(float(basis[-1] @ product))
        for _ in range(2):  # the second time removes what rounding left
            for known in basis:
                product = product - float(known @ product) * known
        length = float(np.linalg.norm(product))
        if not length > 1e-14 * max(map(abs, [*diagonal, *beside])):
            break
        beside.append(length)
        basis.append(product / length)
    inner = beside[: len(diagonal) - 1]
    values = np.linalg.eigvalsh(np.diag(diagonal) + np.diag(inner, 1) + np.diag(inner, -1))
    return float(values[0]), float(values[-1])


#: Local compliance over the whole below which the shared modes are looked at.
SMALL_LOCAL_FRACTION = 1e-3


@record(frozen=True, eq=False)
class DenseCompliance:
    """A compliance given as one symmetric matrix (n, n) [mm/N]."""

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
        """True if no eigenvalue is negative beyond rounding."""
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


@record(frozen=True, eq=False)
class ModalCompliance:
    """A compliance C = diag(d) + V V^T of local springs d (n) [mm/N], not negative, and bending modes V."""

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
        """True if modes are fewer than segments, in blocks of half of them, or compressed; else C is smaller."""
        modes, (size, columns) = self.modes, self.factor.shape
        return isinstance(modes, ModalBasis) or columns < size or 2 * int(modes.labels.rows.max()) <= size

    @cached_property
    def dense(self) -> Array:
        """C as an (n, n) array [mm/N]."""
        dense = self.factor @ self.factor.T
        dense.ravel()[:: dense.shape[0] + 1] += self.local  # the diagonal, at once
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
        """Least part of a segment's own compliance d in the whole, min d_i / C_ii.

        Where that is small, the shared modes are left out of C_ii: they move many segments alike, as the rotation does,
        and cost the modal method no steps.
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
    """Compliance [mm/N] from C (n, n), a `LinearOperator`, or a pair d (n) [mm/N] and V (n, k) [(mm/N)^0.5].

    C and V may be sparse, V an operator or a `ModalBasis`; C must be symmetric, its diagonal not negative.
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
        diagonal = _diagonal(given[0], size)
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
