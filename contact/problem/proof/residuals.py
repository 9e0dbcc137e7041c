"""Residuals of the contact problem as given, each with a bound of its own rounding, in three degrees of care.

1. In double precision. The rounding of a deflection is bounded by Cauchy and Schwarz, |C_ij| <= sqrt(C_ii C_jj), at the
   price of a vector.
2. The same numbers, their rounding bounded by |C| |F|, at the price of a product with C.
3. Sums free of error, rounded once: some hundred times the price of a product with C.

The bounds hold for sums taken in any order (Higham 2002, Accuracy and Stability of Numerical Algorithms, chapter 3).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..compliance_matrix import DenseCompliance, ModalCompliance
from ..contact_problem import ContactProblem
from ..operator_compliance import OperatorCompliance
from .error_free import UNIT_ROUNDOFF, dot_terms, double_double

Array = NDArray[np.float64]

#: Greatest error of operations whose result is below the normal numbers [in any unit].
UNDERFLOW = 1e-318
#: Rounding of a product that is not ours, over its greatest entry: assumed, for nothing is known of it. A convolution
#: by FFT of a million segments has 1e-15.
PRODUCT_ROUNDING = 1e-13


@dataclass(frozen=True, eq=False, slots=True)
class Residuals:
    """What forces and a rotation leave of the conditions.

    Attributes
    ----------
    deflection, gap
        C F and Y = C F + S - r theta (n) [mm].
    gap_error
        Bound of the rounding of each gap (n) [mm].
    imbalance, imbalance_error
        r'F - T and the bound of its rounding [N mm].
    surplus, surplus_error
        F'C F + S'F - theta T, S and theta counted from first contact, and the bound of its rounding [N mm].
    """

    deflection: Array
    gap: Array
    gap_error: Array
    imbalance: float
    imbalance_error: float
    surplus: float
    surplus_error: float


def rounded_residuals(
    problem: ContactProblem, force: Array, elastic_rotation: float, deflection: Array, gap: Array, *, sharp: bool = False
) -> Residuals:
    """Return the residuals in double precision.

    Parameters
    ----------
    problem
        The contact problem.
    force, elastic_rotation
        Forces (n) [N] and rotation beyond first contact [rad].
    deflection, gap
        C F and Y in double precision (n) [mm].
    sharp
        Bound the rounding of deflections by |C| |F|, not by the diagonal of C.
    """
    contact, matrix, size = problem.first_contact, problem.compliance_matrix, force.size
    separation, arm_size, magnitude = contact.separation, np.abs(problem.lever_arm), np.abs(force)
    if isinstance(matrix, ModalCompliance):
        terms = size + matrix.factor.shape[1] + 6
    else:
        terms = size + 4
    if isinstance(matrix, OperatorCompliance):
        terms, sizes = 1, np.full(size, PRODUCT_ROUNDING / UNIT_ROUNDOFF * float(np.abs(deflection).max()))
    elif not sharp:
        root = np.sqrt(matrix.diagonal)
        sizes = float(magnitude @ root) * root
    elif isinstance(matrix, ModalCompliance):
        factor = np.abs(matrix.factor)
        sizes = matrix.local * magnitude + factor @ (magnitude @ factor)
    else:
        sizes = np.abs(matrix.dense) @ magnitude
    gap_error = (terms * UNIT_ROUNDOFF) * sizes
    gap_error += arm_size * (3.0 * UNIT_ROUNDOFF * abs(elastic_rotation) + contact.error * abs(contact.rotation))
    separation_size = np.abs(separation)
    gap_error += 3.0 * UNIT_ROUNDOFF * separation_size + UNDERFLOW
    work = float(force @ deflection + force @ separation)
    work_size = float(magnitude @ np.abs(deflection)) + float(magnitude @ separation_size)
    turned = elastic_rotation * problem.torque
    return Residuals(
        deflection,
        gap,
        gap_error,
        float(force @ problem.lever_arm) - problem.torque,
        (size + 2) * UNIT_ROUNDOFF * float(magnitude @ arm_size),
        work - turned,
        float(magnitude @ gap_error) + (size + 4) * UNIT_ROUNDOFF * work_size + 2.0 * UNIT_ROUNDOFF * abs(turned),
    )


def exact_residuals(problem: ContactProblem, force: Array, elastic_rotation: float) -> Residuals:
    """Return the residuals, every one the rounded sum of exact products.

    Parameters
    ----------
    problem
        The contact problem.
    force, elastic_rotation
        Forces (n) [N] and rotation beyond first contact [rad].

    Raises
    ------
    OverflowError, ValueError
        Numbers near 10^300.
    """
    contact, arm = problem.first_contact, problem.lever_arm
    angles = (contact.rotation, contact.remainder, elastic_rotation)
    turned = [dot_terms(arm, np.full(arm.size, -angle)).reshape(2, -1) for angle in angles]
    rigid = np.concatenate([problem.separation[np.newaxis], *turned]).T.tolist()  # S - r theta as terms (n, 7)
    deflection, gap = np.empty((2, arm.size))
    for number, (row, own) in enumerate(zip(_deflection_terms(problem, force), rigid, strict=True)):
        deflection[number], gap[number] = math.fsum(row), math.fsum([*row, *own])
    # F'C F + S'F - theta T = F'Y + theta (r'F - T): the first sum is over gaps that are rounded already.
    imbalance = math.fsum([*dot_terms(force, arm), -problem.torque])
    gap_error = UNIT_ROUNDOFF * np.abs(gap) + UNDERFLOW
    gap_error += np.abs(arm) * (contact.error * abs(contact.rotation))
    shift = elastic_rotation * imbalance
    surplus = math.fsum(dot_terms(force, gap)) + shift
    return Residuals(
        deflection,
        gap,
        gap_error,
        imbalance,
        UNIT_ROUNDOFF * abs(imbalance),
        surplus,
        float(np.abs(force) @ gap_error) + 4.0 * UNIT_ROUNDOFF * (abs(surplus) + abs(shift)),
    )


def _deflection_terms(problem: ContactProblem, force: Array) -> Iterator[list[float]]:
    """For each segment, numbers whose exact sum is its deflection."""
    matrix = problem.compliance_matrix
    if isinstance(matrix, DenseCompliance):
        for row in matrix.dense:
            yield dot_terms(row, force).tolist()
        return
    # The amplitudes V'F to twice the digits of a double: their error is then far below that of one rounding.
    pairs = [double_double(dot_terms(column, force)) for column in matrix.factor.T]
    amplitudes = np.array(pairs).reshape(-1, 2).T.ravel()
    own = dot_terms(matrix.local, force).reshape(2, -1).T.tolist()
    for row, local in zip(np.hstack([matrix.factor, matrix.factor]), own, strict=True):
        yield [*dot_terms(row, amplitudes).tolist(), *local]
