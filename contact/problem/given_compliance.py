"""What a user may give for a compliance, as arrays: sparse matrices, operators, a factor of one column."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import array
from ...core.errors import InputError

Array = NDArray[np.float64]

#: Entries of the largest array that is formed from a sparse matrix or from the products of a factor: 3.2 GB.
LARGEST_FORMED = 400_000_000


def is_sparse(value: object) -> bool:
    """Whether a value is a sparse array or matrix of scipy; nothing is imported for it."""
    module: Any = sys.modules.get("scipy.sparse")
    return module is not None and bool(module.issparse(value))


def is_operator(value: object) -> bool:
    """Whether a value is a `scipy.sparse.linalg.LinearOperator`; nothing is imported for it."""
    module: Any = sys.modules.get("scipy.sparse.linalg")
    return module is not None and isinstance(value, module.LinearOperator)


def dimensions(value: Any) -> int:
    """Number of dimensions of an array, a sparse array or an operator."""
    return len(value.shape) if is_sparse(value) or is_operator(value) else np.ndim(value)


def is_pair(given: Any, size: int) -> bool:
    """Whether a compliance was given as the pair (d, V) of n numbers and of an (n, k) or (n) array.

    Two rows of two numbers may be both, a matrix or a pair: a list is a matrix, a tuple a pair.

    Raises
    ------
    InputError
        A tuple of two rows of two numbers that is a symmetric matrix, too.
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
    """Return d of a pair (d, V): that of a diagonal matrix (n, n), sparse or not, is its diagonal; else as given.

    Raises
    ------
    InputError
        The matrix has entries beside its diagonal.
    """
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
    """Return a sparse matrix, or a factor known by its products, as an array; anything else as it is.

    Parameters
    ----------
    name, unit
        Of the argument.
    given
        Its value.

    Raises
    ------
    InputError
        Numbers that are not real, or an array that would be too large.
    """
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


def factor_of(given: Any, size: int) -> Array:
    """Return the factor V (n, k) [(mm/N)^0.5]; a single mode may be given as (n).

    Raises
    ------
    InputError
        Another number of rows, or what is no array of finite numbers.
    """
    whole = formed("compliance factor", given, "(mm/N)^0.5")
    if np.ndim(whole) == 1:
        whole = array("compliance factor", whole, "(mm/N)^0.5", ndim=1, size=size)[:, np.newaxis]
    factor = array("compliance factor", whole, "(mm/N)^0.5", ndim=2, frozen=True)
    if factor.shape[0] != size:
        raise InputError(f"compliance factor = array of shape {factor.shape}: must have {size} rows")
    return factor
