"""Choice of the form in which the system of the touching segments is solved."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...problem.compliance_matrix import ComplianceMatrix, ModalCompliance
from ..compiled.compiled_answer import SMALLEST_LOCAL_FRACTION
from .dense_touching import DenseTouching
from .modal_touching import ModalTouching
from .touching_system import TouchingSystem

Array = NDArray[np.float64]

#: Number of segments up to which the dense form is as fast as the modes.
DENSE_FIRST_SIZE = 300
#: Padding the blocks to one size may cost this many times the memory of the factor.
LARGEST_PADDING = 4


def touching_system(matrix: ComplianceMatrix, lever_arm: Array, active: NDArray[np.bool_]) -> TouchingSystem:
    """Return the system of a set of touching segments: in the modes where there are many segments, else dense.

    Parameters
    ----------
    matrix
        C [mm/N].
    lever_arm
        r (n) [mm].
    active
        Touching segments (n), some with a lever arm. Those whose forces would not be unique are left out.
    """
    large = lever_arm.size > DENSE_FIRST_SIZE
    if large and isinstance(matrix, ModalCompliance) and matrix.local_fraction > SMALLEST_LOCAL_FRACTION:
        basis = matrix.modes.basis
        if basis.modes.size <= LARGEST_PADDING * matrix.factor.size + matrix.local.size:
            return ModalTouching(matrix.local, basis, lever_arm, active)
    return DenseTouching(matrix.dense, lever_arm, active)


def part_of(matrix: ComplianceMatrix, segments: NDArray[np.intp]) -> Array | tuple[Array, Array]:
    """Return the compliance among some segments [mm/N], in the form of the whole."""
    if isinstance(matrix, ModalCompliance):
        return matrix.local[segments], matrix.factor[segments]
    return np.asarray(matrix.dense[np.ix_(segments, segments)])
