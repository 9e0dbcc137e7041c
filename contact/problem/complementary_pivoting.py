"""Lemke's complementary pivoting: exact up to rounding, without a starting point; for small problems.

The tableau of w - M z - d z0 = q, d = 1, is pivoted from w = q + z0 d, z = 0 until the artificial z0 leaves the basis.
After each pivot the complement of the variable that left enters. Ties in the ratio test are broken lexicographically
over the columns of the inverse basis, so that no basis can come back and the method ends, degenerate or not. With
a positive semidefinite M it ends in a solution, or on a ray, which proves that there is none (Lemke 1965, doi
10.1287/mnsc.11.7.681; Cottle, Pang and Stone 1992, chapter 4, doi 10.1137/1.9780898719000).

A pivot costs O(n^2), and about as many are needed as segments touch: two milliseconds at n = 100, a tenth of a second
at n = 400, two seconds at n = 1000. Conry and Seireg (1971) solved the contact of gears by such a tableau.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from time import perf_counter
from typing import Literal

import numpy as np

from ...core.arrays import Bools, Integers, RealArray as Array

#: An entry of the entering column below this, relative to the largest, is rounding.
PIVOT_TOLERANCE = 1e-11
#: Ratios that differ by less, relative to the level of the column, are ties.
TIE_TOLERANCE = 1e-12


@dataclass(frozen=True, eq=False, slots=True)
class LemkeResult:
    """End of the pivoting, z (n) NaN unless solved; a ray proves no solution if M is positive semidefinite."""

    z: Array
    pivots: int
    ended: Literal["solved", "ray", "pivot limit", "time limit"]


def lemke(matrix: Array, vector: Array, max_pivots: int = 10_000, time_limit: float = math.inf) -> LemkeResult:
    """Solve w = M z + q >= 0, z >= 0, w'z = 0 for M (n, n) and q (n); time limit in [s]."""
    size, start = vector.size, perf_counter()
    if vector.min() >= 0.0:
        return LemkeResult(np.zeros(size), 0, "solved")
    # Columns: w (they hold the inverse basis), z, z0, right side.
    tableau = np.hstack([np.eye(size), -matrix, -np.ones((size, 1)), vector[:, np.newaxis]])
    artificial = 2 * size
    basis = np.arange(size)
    # All rows with the lowest q tie; the lexicographic order of unit vectors prefers the last of them.
    row = int(np.flatnonzero(vector <= vector.min())[-1])
    entering = artificial
    for pivots in range(1, max_pivots + 1):
        if perf_counter() - start >= time_limit:
            return LemkeResult(np.full(size, np.nan), pivots - 1, "time limit")
        leaving = int(basis[row])
        _pivot(tableau, row, entering)
        basis[row] = entering
        if leaving == artificial:
            return LemkeResult(_solution(matrix, vector, basis, tableau[:, -1]), pivots, "solved")
        entering = leaving + size if leaving < size else leaving - size
        if (chosen := _leaving_row(tableau, entering, basis == artificial)) is None:
            return LemkeResult(np.full(size, np.nan), pivots, "ray")
        row = chosen
    return LemkeResult(np.full(size, np.nan), max_pivots, "pivot limit")


def _pivot(tableau: Array, row: int, column: int) -> None:
    tableau[row] /= tableau[row, column]
    factors = tableau[:, column].copy()
    factors[row] = 0.0
    tableau -= np.outer(factors, tableau[row])
    tableau[:, column] = 0.0
    tableau[row, column] = 1.0


def _leaving_row(tableau: Array, entering: int, is_artificial: Bools) -> int | None:
    """Row of the least ratio, the artificial variable first, then lexicographically; None on a ray."""
    column = tableau[:, entering]
    rows = np.flatnonzero(column > PIVOT_TOLERANCE * max(float(np.abs(column).max()), 1.0))
    if not rows.size:
        return None
    rows = _least(rows, np.maximum(tableau[rows, -1], 0.0) / column[rows])
    if is_artificial[rows].any():
        return int(rows[is_artificial[rows]][0])
    return _lexicographic_row(tableau, rows, column)


def _lexicographic_row(tableau: Array, rows: Integers, column: Array) -> int:
    """Of rows with the same ratio, the one whose row of the inverse basis, over its pivot, comes first."""
    for other in range(column.size):
        if rows.size == 1:
            break
        rows = _least(rows, tableau[rows, other] / column[rows])
    return int(rows[0])


def _least(rows: Integers, ratios: Array) -> Integers:
    least = float(ratios.min())
    return rows[ratios <= least + TIE_TOLERANCE * max(abs(least), 1.0)]


def _solution(matrix: Array, vector: Array, basis: Integers, right: Array) -> Array:
    """Values of z in the final basis, solved afresh so that the rounding of the pivots is gone."""
    size = vector.size
    columns = np.hstack([np.eye(size), -matrix])[:, basis]
    try:
        values = np.linalg.solve(columns, vector)
        values += np.linalg.solve(columns, vector - columns @ values)
    except np.linalg.LinAlgError:
        values = right
    z = np.zeros(2 * size)
    z[basis] = values if np.isfinite(values).all() else right
    return z[size:]
