"""Choice of the form in which the system of the touching segments is solved."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...problem.compliance_matrix import ComplianceMatrix, ModalCompliance
from ...problem.modal_basis import ModalBasis
from ..compiled.compiled_answer import SMALLEST_LOCAL_FRACTION
from ..touching_system import DenseTouching, TouchingFactor, TouchingSystem
from .modal_touching import ModalTouching

Array = NDArray[np.float64]

#: Number of segments up to which the dense form is as fast as the modes.
DENSE_FIRST_SIZE = 300
#: Padding the blocks to one size may cost this many times the memory of the factor.
LARGEST_PADDING = 4


def touching_system(matrix: ComplianceMatrix, lever_arm: Array, active: NDArray[np.bool_]) -> TouchingSystem:
    """System of a set of touching segments: in the modes where there are many segments, else dense.

    Some must have a lever arm; those whose forces would not be unique are left out.
    """
    large = lever_arm.size > DENSE_FIRST_SIZE
    if large and isinstance(matrix, ModalCompliance) and matrix.local_fraction > SMALLEST_LOCAL_FRACTION:
        basis = matrix.modes.basis
        if basis.modes.size <= LARGEST_PADDING * matrix.factor.size + matrix.local.size:
            return ModalTouching(matrix.local, basis, lever_arm, active)
    return DenseTouching(matrix.dense, lever_arm, active)


def touching_stiffness(local: Array, basis: ModalBasis, lever_arm: Array, active: NDArray[np.bool_]) -> float:
    """Torque that turns the gear by one radian while these segments keep contact [N mm/rad].

    It is dT / dtheta = r_A' C_AA^-1 r_A for C = diag(local) + modes; NaN where C_AA is singular.
    """
    if np.count_nonzero(active) > DENSE_FIRST_SIZE:
        return ModalTouching(local, basis, lever_arm, active).stiffness
    touching = [(segments, active[segments]) for segments, _ in basis.blocks]
    index = np.concatenate([segments[chosen] for segments, chosen in touching])
    shared = basis.shared_factor[index]
    part, start = shared @ shared.T, 0
    for (_, chosen), (_, modes) in zip(touching, basis.blocks, strict=True):
        rows = modes[chosen]
        block = slice(start, start := start + len(rows))
        part[block, block] += rows @ rows.T
    part.reshape(-1)[:: index.size + 1] += local[index]
    known = TouchingFactor.of(part, lever_arm[index])
    return np.nan if known is None else known.moment


def part_of(matrix: ComplianceMatrix, segments: NDArray[np.intp]) -> Array | tuple[Array, Array]:
    """Return the compliance among some segments [mm/N], in the form of the whole."""
    if isinstance(matrix, ModalCompliance):
        return matrix.local[segments], matrix.factor[segments]
    return np.asarray(matrix.dense[np.ix_(segments, segments)])
