"""Direction in which the data of a contact problem change, as its derivatives need it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ....core.checks import array
from ....core.errors import InputError
from ...problem.compliance_matrix import ModalCompliance
from ...problem.contact_problem import ContactProblem

Array = NDArray[np.float64]


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
    """Return the change of the deflections under the same forces, dC F (n) [mm].

    Parameters
    ----------
    problem
        The contact problem.
    force
        F (n) [N].
    local, factor, compliance
        See `Sensitivity.forward`.

    Raises
    ------
    InputError
        A wrong shape, a number that is not finite, or a change of V where C is dense.
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
