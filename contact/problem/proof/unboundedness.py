"""Proof that a contact problem has no solution: forces that meet no compliance and close a penetration for ever.

The torque can always be carried, for some lever arm is positive. So a problem has no solution only if its energy has
no lower bound: if forces D >= 0 without moment, r'D = 0, meet no compliance, D'C D = 0, and gain energy, S'D < 0.
Such forces are found by a linear programme and proved in rational numbers.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ..compliance_matrix import ModalCompliance
from ..contact_problem import ContactProblem

Array = NDArray[np.float64]
Row = list[Fraction]

#: Parts of the direction that are rounding, relative to the greatest; and gain of energy that is none.
SUPPORT_TOLERANCE, GAIN_TOLERANCE = 1e-9, 1e-6
#: Segments in the direction up to which rational numbers are tried.
SUPPORT_LIMIT = 60


def is_unbounded(problem: ContactProblem) -> bool:
    """Whether it is proved that a problem has no solution.

    Parameters
    ----------
    problem
        The contact problem.

    Examples
    --------
    A rigid segment without lever arm penetrates at every rotation:

    >>> is_unbounded(ContactProblem([0.1, -0.3], [40.0, 0.0], 10.0, np.diag([1e-6, 0.0])))
    True
    """
    scaled = problem.scaled()
    if not scaled.is_finite or scaled.separation.min() >= 0.0:
        return False  # the energy of every admissible load is bounded below by zero
    from scipy.optimize import linprog

    rows = np.vstack([scaled.compliance, scaled.lever_arm[np.newaxis, :]])
    found = linprog(scaled.separation, A_eq=rows, b_eq=np.zeros(rows.shape[0]), bounds=(0.0, 1.0))
    least = -GAIN_TOLERANCE * float(np.abs(scaled.separation).max())
    if found.status != 0 or found.x is None or not float(found.fun or 0.0) < least:
        return False
    support = np.flatnonzero(found.x > SUPPORT_TOLERANCE * found.x.max())
    return support.size <= SUPPORT_LIMIT and _is_proved(problem, support.tolist(), found.x)


def _is_proved(problem: ContactProblem, support: list[int], near: Array) -> bool:
    """Whether a direction on some segments, near a given one, has neither moment nor deflection, and gains energy.

    Where there are several directions, segments leave until there is one.
    """
    matrix = problem.compliance_matrix
    while support:
        if isinstance(matrix, ModalCompliance):
            support = [number for number in support if matrix.local[number] == 0.0]
            rows = matrix.factor[support].T
        else:
            rows = matrix.dense[np.ix_(support, support)]
        given = np.vstack([rows, problem.lever_arm[support]])
        direction = _null_vector([[Fraction(value) for value in row] for row in given.tolist()], len(support))
        if direction is None:
            return False
        separation = problem.separation[support].tolist()
        gain = sum(part * Fraction(own) for part, own in zip(direction, separation, strict=True))
        if gain > 0 or (gain == 0 and min(direction) >= 0):
            gain, direction = -gain, [-part for part in direction]
        if min(direction) >= 0:
            return gain < 0
        steps = {
            number: near[number] / -float(part) for number, part in zip(support, direction, strict=True) if part < 0
        }
        near = near.copy()
        step = min(steps.values())
        for number, part in zip(support, direction, strict=True):
            near[number] += step * float(part)
        support = [number for number in support if number != min(steps, key=lambda number: steps[number])]
    return False


def _null_vector(rows: list[Row], size: int) -> Row | None:
    """A vector, not zero, that a rational matrix takes to zero; None if there is none."""
    pivots: list[int] = []
    for column in range(size):
        done = len(pivots)
        pivot = next((i for i in range(done, len(rows)) if rows[i][column]), None)
        if pivot is None:
            continue
        rows[done], rows[pivot] = rows[pivot], rows[done]
        head = rows[done][column]
        rows[done] = [value / head for value in rows[done]]
        for i, row in enumerate(rows):
            if i != done and row[column]:
                factor = row[column]
                rows[i] = [value - factor * own for value, own in zip(row, rows[done], strict=True)]
        pivots.append(column)
    free = [column for column in range(size) if column not in pivots]
    if not free:
        return None
    vector = [Fraction(0)] * size
    vector[free[0]] = Fraction(1)
    for i, column in enumerate(pivots):
        vector[column] = -rows[i][free[0]]
    return vector
