"""Factor a stiffness matrix once: CHOLMOD where scikit-sparse is installed, SuperLU of scipy otherwise."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from ....core.errors import InputError, MissingPackageError, how_to_install

if TYPE_CHECKING:
    from scipy.sparse import csc_array

Array = NDArray[Any]
Factoriser = Literal["auto", "cholmod", "superlu"]
COLUMNS_PER_SOLVE = 64  # right-hand sides; bounds the memory


def solver_of(matrix: csc_array, factoriser: Factoriser = "auto") -> Callable[[Array], Array]:
    """Solve with one factorisation of a symmetric positive definite matrix.

    Parameters
    ----------
    matrix
        Stiffness of the free displacements (n, n).
    factoriser
        ``auto`` takes CHOLMOD if it is there.

    Returns
    -------
    Callable
        From right-hand sides (n, k) to solutions (n, k).

    Raises
    ------
    InputError
        If SuperLU finds no memory for the factor.
    MissingPackageError
        If CHOLMOD is asked for and scikit-sparse is not installed.
    """
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import splu

    if factoriser != "superlu":
        try:
            from sksparse.cholmod import cholesky
        except ImportError as error:
            if factoriser == "cholmod":
                raise MissingPackageError(
                    f"cholmod needs the package scikit-sparse: {how_to_install('easeoff[cholmod]')}"
                ) from error
        else:
            solve: Callable[[Array], Array] = cholesky(csc_matrix(matrix))
            return solve
    try:
        factor = splu(
            csc_matrix(matrix), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except (MemoryError, RuntimeError) as error:
        if isinstance(error, RuntimeError) and "MALLOC" not in str(error):
            raise
        raise InputError(
            f"displacements = {matrix.shape[0]}: must be fewer, as SuperLU found no memory to factor their stiffness; "
            "lower fineness under [compliance]"
        ) from error
    return lambda loads: np.asarray(factor.solve(loads))


def solve_in_parts(solve: Callable[[Array], Array], loads: csc_array, wanted: csc_array) -> Array:
    """``wanted^T K^-1 loads`` without ever holding all solutions.

    Parameters
    ----------
    solve
        From ``solver_of``.
    loads
        Right-hand sides (n, k).
    wanted
        Functionals (n, m) of the solutions.

    Returns
    -------
    Array
        (m, k).
    """
    transposed = wanted.T.tocsr()
    parts = [
        transposed @ solve(np.ascontiguousarray(loads[:, start : start + COLUMNS_PER_SOLVE].toarray()))
        for start in range(0, loads.shape[1], COLUMNS_PER_SOLVE)
    ]
    return np.concatenate(parts, axis=1)
