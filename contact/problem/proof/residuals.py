"""Residuals of the contact problem as given, each with a bound of its own rounding, in three degrees of care.

1. In double precision, the rounding bounded by Cauchy and Schwarz, |C_ij| <= sqrt(C_ii C_jj), for no more than a few
   sums.
2. The same numbers, the rounding bounded segment by segment with |C| |F|, for a product with C.
3. Sums free of error, rounded once, for some hundred products with C.

The bounds hold for sums taken in any order (Higham 2002, Accuracy and Stability of Numerical Algorithms, chapter 3).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compliance_matrix import ComplianceMatrix, ModalCompliance
from ..contact_problem import ContactProblem
from ..operator_compliance import OperatorCompliance
from .error_free import UNIT_ROUNDOFF, dot_terms, double_double
from .first_contact import ERROR_FREE

Array = NDArray[np.float64]

#: Greatest error of operations whose result is below the normal numbers [in any unit].
UNDERFLOW = 1e-318
#: Rounding of a product that is not ours, over its greatest entry: assumed, for nothing is known of it. A convolution
#: by FFT of a million segments has 1e-15.
PRODUCT_ROUNDING = 1e-13


class Sizes(NamedTuple):
    """Sizes of forces and of the terms of the residuals.

    Attributes
    ----------
    force
        |F| (n) [N].
    lever_arm
        |r| (n) [mm].
    least_force, largest_force, total
        Least F, largest |F| and the sum of |F| [N].
    moment, strain, preload
        Sums of |F| |r|, |F| |C F| and |F| |S|, S from first contact [N mm].
    roots
        Sum of |F| over the roots of the diagonal of C.
    root
        Largest of these roots.
    """

    force: Array
    lever_arm: Array
    least_force: float
    largest_force: float
    total: float
    moment: float
    strain: float
    preload: float
    roots: float
    root: float

    @classmethod
    def of(cls, problem: ContactProblem, force: Array, deflection: Array) -> Sizes:
        """Gather them for forces (n) [N] and C F (n) [mm]."""
        contact, arm = problem.first_contact, problem.lever_arm
        separation, magnitude, least = contact.separation, force, float(force.min())
        if contact.signs:
            arm, separation = np.abs(arm), np.abs(separation)
        if least < 0.0:
            magnitude = np.abs(force)
        root = np.sqrt(problem.compliance_matrix.diagonal)
        return cls(
            magnitude,
            arm,
            least,
            float(magnitude.max()),
            float(magnitude.sum()),
            float(magnitude @ arm),
            float(magnitude @ np.abs(deflection)),
            float(magnitude @ separation),
            float(magnitude @ root),
            float(root.max()),
        )


class Residuals(NamedTuple):
    """What forces and a rotation leave of the conditions, and bounds of the rounding in it.

    Attributes
    ----------
    gap, gap_error
        Y = C F + S - r theta (n), and the bound for segments that carry load or may touch [mm].
    imbalance, imbalance_error
        r'F - T [N mm].
    surplus, surplus_error
        F'C F + S'F - theta T, S and theta counted from first contact [N mm].
    """

    gap: Array
    gap_error: float
    imbalance: float
    imbalance_error: float
    surplus: float
    surplus_error: float


def rounded_residuals(
    problem: ContactProblem,
    force: Array,
    elastic_rotation: float,
    deflection: Array,
    gap: Array,
    sizes: Sizes,
    *,
    sharp: bool = False,
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
    sizes
        Of these forces and deflections.
    sharp
        Bound the rounding segment by segment, with |C| |F|; else by the largest entries of the diagonal of C and of r.
    """
    contact, matrix, size = problem.first_contact, problem.compliance_matrix, force.size
    columns = matrix.factor.shape[1] + 2 if isinstance(matrix, ModalCompliance) else 0
    # A gap that may be none has |S| <= |C F| + |r theta|, and three times its rounding is within these terms.
    terms = (size + columns + 8) * UNIT_ROUNDOFF
    of_arm = 6.0 * UNIT_ROUNDOFF * abs(elastic_rotation) + contact.error * abs(contact.rotation)
    if isinstance(matrix, OperatorCompliance):
        of_product = PRODUCT_ROUNDING * float(np.abs(deflection).max())
        gap_error = of_product + of_arm * float(sizes.lever_arm.max()) + UNDERFLOW
    elif sharp:
        bound = terms * _term_sizes(matrix, sizes.force) + of_arm * sizes.lever_arm + UNDERFLOW
        bound = bound[(force != 0.0) | (gap <= bound)]
        gap_error = float(bound.max()) if bound.size else 0.0
    else:
        gap_error = terms * sizes.roots * sizes.root + of_arm * float(sizes.lever_arm.max()) + UNDERFLOW
    turned, rounding = elastic_rotation * problem.torque, (size + 4) * UNIT_ROUNDOFF
    return Residuals(
        gap,
        gap_error,
        float(force @ problem.lever_arm) - problem.torque,
        rounding * sizes.moment,
        float(force @ deflection) + float(force @ contact.separation) - turned,
        sizes.total * gap_error + rounding * (sizes.strain + sizes.preload + abs(turned)),
    )


def _term_sizes(matrix: ComplianceMatrix, magnitude: Array) -> Array:
    """|C| |F| of the terms that are summed (n)."""
    if isinstance(matrix, ModalCompliance):
        factor = np.abs(matrix.factor)
        return np.asarray(matrix.local * magnitude + factor @ (magnitude @ factor))
    return np.asarray(np.abs(matrix.dense) @ magnitude)


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
    arm, turned = problem.lever_arm, dot_terms(problem.lever_arm, np.full(force.size, -elastic_rotation))
    rigid = np.vstack([*_exact_separation(problem), turned.reshape(2, -1)]).T.tolist()  # S - r theta as terms (n, 4)
    rows = zip(_deflection_terms(problem, force), rigid, strict=True)
    gap = np.array([math.fsum([*row, *own]) for row, own in rows])
    imbalance = math.fsum([*dot_terms(force, arm), -problem.torque])
    bound = exact_gap_error(problem, gap)
    bound = np.where((force != 0.0) | (gap <= bound), bound, 0.0)
    # F'C F + S'F - theta T = F'Y + theta (r'F - T), the gaps being rounded already.
    of_gaps, of_balance = math.fsum(dot_terms(force, gap)), elastic_rotation * imbalance
    rounding = float(np.abs(force) @ bound) + 4.0 * UNIT_ROUNDOFF * (abs(of_gaps) + abs(of_balance))
    largest = float(bound.max())
    return Residuals(gap, largest, imbalance, UNIT_ROUNDOFF * abs(imbalance), of_gaps + of_balance, rounding)


def exact_gap_error(problem: ContactProblem, gap: Array) -> Array:
    """Return the bound of the error (n) of the gaps of `exact_residuals`."""
    return UNIT_ROUNDOFF * np.abs(gap) + ERROR_FREE * np.abs(problem.separation_at_first_contact) + UNDERFLOW


def _exact_separation(problem: ContactProblem) -> tuple[Array, Array]:
    """S - r S_f / r_f to twice the digits of a double: rounded, and what this lacks (n), see ``first_contact``."""
    first = problem.first_contact.segment
    own, lever = float(problem.separation[first]), float(problem.lever_arm[first])
    scale = math.ldexp(1.0, -math.frexp(lever)[1])
    size, lever = problem.size, lever * scale
    products = np.concatenate([
        dot_terms(problem.separation, np.full(size, lever)), dot_terms(problem.lever_arm * scale, np.full(size, -own)),
    ]).reshape(4, -1).T  # fmt: skip
    rounded = np.array([math.fsum(row) for row in products]) / lever
    left = np.column_stack([products, dot_terms(rounded, np.full(size, -lever)).reshape(2, -1).T])
    return rounded, np.array([math.fsum(row) for row in left]) / lever


def _deflection_terms(problem: ContactProblem, force: Array) -> Iterator[list[float]]:
    """For each segment, numbers whose exact sum is its deflection."""
    matrix = problem.compliance_matrix
    if not isinstance(matrix, ModalCompliance):
        for row in matrix.dense:
            yield dot_terms(row, force).tolist()
        return
    # The amplitudes V'F to twice the digits of a double: their error is then far below that of one rounding.
    pairs = [double_double(dot_terms(column, force)) for column in matrix.factor.T]
    amplitudes = np.array(pairs).reshape(-1, 2).T.ravel()
    own = dot_terms(matrix.local, force).reshape(2, -1).T.tolist()
    for row, local in zip(np.hstack([matrix.factor, matrix.factor]), own, strict=True):
        yield [*dot_terms(row, amplitudes).tolist(), *local]
