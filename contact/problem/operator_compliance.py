"""A compliance C known by its products alone: a `scipy.sparse.linalg.LinearOperator`, such as a convolution by FFT.

From products one can prove that C is not positive semidefinite, never that it is: an answer found with such a
compliance is proved on that assumption, and says so.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...core.checks import array, frozen_arrays, read_only, shown
from ...core.errors import InputError
from .given_compliance import is_operator

if TYPE_CHECKING:
    from scipy.sparse.linalg import LinearOperator

Array = NDArray[np.float64]

#: Products spent in the search for a negative eigenvalue; found are those at the end of the spectrum.
LANCZOS_STEPS = 20
#: Smallest eigenvalue of C, relative to n times the largest, that is still taken for a rounded zero.
NEGATIVE_EIGENVALUE_TOLERANCE = 1e-12
#: Largest difference of x'C y and y'C x, relative to the lengths of their vectors, that is taken for rounding.
ASYMMETRY_TOLERANCE = 1e-10


@frozen_arrays
@dataclass(frozen=True, eq=False)
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
            diagonal = array(
                "compliance diagonal", self.known_diagonal, "mm/N", ndim=1, size=shape[0], least=0.0, frozen=True
            )
            object.__setattr__(self, "known_diagonal", diagonal)
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
        own: Any = getattr(self.operator, "diagonal", None)
        if not callable(own):
            raise InputError(
                "compliance diagonal: must be given with a LinearOperator, for scaling and certificate: "
                "OperatorCompliance(operator, diagonal)"
            )
        return array("compliance diagonal", own(), "mm/N", ndim=1, size=self.size, least=0.0, frozen=True)

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
    diagonal: list[float] = []
    beside: list[float] = []
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
    matrix = np.diag(diagonal)
    if len(diagonal) > 1:
        inner = beside[: len(diagonal) - 1]
        matrix += np.diag(inner, 1) + np.diag(inner, -1)
    values = np.linalg.eigvalsh(matrix)
    return float(values[0]), float(values[-1])
