# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
# cython: annotation_typing=False, infer_types=True
"""Primal-dual active set for one small matrix C, from the given data to the certificate.

The method of ``primal_dual_active_set``, without what that does where C is nearly singular or the set does not settle:
there it gives up. Compiled; run as it stands here it gives the same bits.
"""

from __future__ import annotations

import math
from typing import Any

import cython

if not cython.compiled:
    from math import ldexp

    from .block_algebra import backward, dot, eliminate, forward, row_products
    from .proof_kernel import certificate, first_contact, ilogb, winkler_rotation

NAN = math.nan
MAX_STEPS = 30
#: A wrong sign below this, relative to the largest force or gap term, is rounding.
SIGN_TOLERANCE = 1e-14
#: A pivot of Cholesky's factor below this, relative to the diagonal of C, is one of a nearly singular matrix.
SMALLEST_PIVOT = 1e-10
WINKLER_ROW_SUM_FRACTION = 0.4


class Touching:
    """The problem that is solved, and the touching segments with the factor of their matrix times ``scale``."""


def _begin(n: Any, torque: float) -> None:
    """Segments that touch where each is a spring of its own; their stiffness stands where the gaps do later."""
    for i in range(n.size):
        row_sum = 0.0
        for j in range(n.size):
            row_sum += n.matrix[i * n.size + j]
        n.gap[i] = 1.0 / max(WINKLER_ROW_SUM_FRACTION * row_sum, n.diagonal[i])
    rotation = winkler_rotation(n.gap, n.shifted, n.arm, n.size, torque)
    for i in range(n.size):
        n.touching[i] = n.arm[i] > 0.0 and rotation * n.arm[i] > n.shifted[i]


def _factor(n: Any) -> float:
    """Factor C of the touching segments, L L', and lever arms L^-1 r; returns r'C^-1 r, or zero if nearly singular."""
    n.count = 0
    for i in range(n.size):
        if n.touching[i]:
            n.index[n.count], n.count = i, n.count + 1
    padded = 4 * ((n.count + 3) // 4)
    n.padded = padded
    for a in range(n.count):
        for b in range(a + 1):
            n.gram[a * padded + b] = n.matrix[n.index[a] * n.size + n.index[b]] * n.scale
        for b in range(a + 1, padded):
            n.gram[a * padded + b] = 0.0
        n.lever[a] = n.arm[n.index[a]]
    for a in range(n.count, padded):
        for b in range(padded):
            n.gram[a * padded + b] = 1.0 if a == b else 0.0
        n.lever[a] = 0.0
    eliminate(n.gram, 0, padded, 0, padded, padded)
    for a in range(n.count):
        inverse = n.gram[a * (padded + 1)]
        if not (inverse > 0.0 and SMALLEST_PIVOT * n.diagonal[n.index[a]] * n.scale * inverse * inverse < 1.0):
            return 0.0
    forward(n.gram, 0, padded, padded, n.lever, 0)
    return dot(n.lever, 0, n.lever, 0, padded)


def _balance(n: Any, torque: float, pivot: float) -> float:
    """Forces ``right`` of the touching segments that close the gaps under a torque; returns the rotation."""
    for a in range(n.padded):
        n.right[a] = n.gap[n.index[a]] * n.scale if a < n.count else 0.0
    forward(n.gram, 0, n.padded, n.padded, n.right, 0)
    turn = (torque + dot(n.lever, 0, n.right, 0, n.padded)) / pivot
    for a in range(n.padded):
        n.right[a] = turn * n.lever[a] - n.right[a]
    backward(n.gram, 0, n.padded, n.padded, n.right, 0)
    rotation: float = turn / n.scale
    return rotation


def _gaps(n: Any, rotation: float) -> None:
    """Deflections and gaps under the forces."""
    row_products(n.matrix, 0, n.size, n.size, n.force, 0, n.size, n.deflection, 0)
    for i in range(n.size):
        n.gap[i] = n.deflection[i] + n.shifted[i] - rotation * n.arm[i]


def _exchange(n: Any, rotation: float, tolerance: float) -> int:
    """Let segments that pull or penetrate change sides; returns their number."""
    largest, far, moved = 0.0, 0.0, 0
    for i in range(n.size):
        largest = max(largest, abs(n.force[i]))
        if n.touching[i]:
            far = max(far, abs(n.shifted[i]))
    for i in range(n.size):
        if n.touching[i]:
            if n.force[i] < -tolerance * largest:
                n.touching[i], moved = 0, moved + 1
        elif n.gap[i] < -tolerance * (abs(rotation) + far):
            n.touching[i], moved = 1, moved + 1
    return moved


def _solve(n: Any, torque: float) -> tuple[int, float]:
    """Forces and gaps; returns the number of systems solved, zero without an answer, and the rotation."""
    for step in range(1, MAX_STEPS + 1):
        pivot = _factor(n)
        if not pivot > 0.0:
            return 0, 0.0
        for i in range(n.size):
            n.force[i], n.gap[i] = 0.0, n.shifted[i]
        rotation, left = 0.0, torque
        for refined in range(2):
            rotation += _balance(n, left, pivot)
            left = torque
            for a in range(n.count):
                n.force[n.index[a]] += n.right[a]
                left -= n.force[n.index[a]] * n.arm[n.index[a]]
            _gaps(n, rotation)
            if _exchange(n, rotation, SIGN_TOLERANCE * (1.0 + 9.0 * refined)):
                break
            if refined:
                return step, rotation
    return 0, 0.0


def solve_dense(
    matrix: Any, columns: int, torque: float, separation: Any, arm: Any, started: bool, room: Any, places: Any,
    force: Any, gap: Any, numbers: Any,
) -> int:  # fmt: skip
    """Solve one problem.

    Parameters
    ----------
    matrix
        C row by row (n n) [mm/N].
    columns
        Of the factor that it was formed of, or none.
    torque
        [N mm].
    separation, arm
        Of the segments (n) [mm].
    started
        Whether segments are assumed in contact.
    room
        Room ((n + 4) (n + 9)).
    places
        Whether a segment is assumed in contact (n); then room (n).
    force, gap
        For the results (n).
    numbers
        For the numbers (10), see `solve_batch`.

    Returns
    -------
    int
        Number of linear systems, zero without an answer.
    """
    n: Any = Touching()
    n.size, n.matrix, n.arm, n.force, n.gap = arm.shape[0], matrix, arm, force, gap
    side = n.size + 4
    n.shifted, n.diagonal, n.deflection = room[: n.size], room[side : side + n.size], room[2 * side : 2 * side + n.size]
    n.lever, n.right, n.gram = room[3 * side : 4 * side], room[4 * side : 5 * side], room[5 * side :]
    n.touching, n.index = places[: n.size], places[n.size :]
    first, remainder, shift_error = first_contact(separation, arm, n.shifted)
    largest = 0.0
    for i in range(n.size):
        n.diagonal[i] = matrix[i * (n.size + 1)]
        largest = max(largest, n.diagonal[i])
    if not largest > 0.0:
        return 0
    n.scale = ldexp(1.0, -ilogb(largest))  # else units would change bits of the roots
    if not started:
        _begin(n, torque)
    steps, rotation = _solve(n, torque)
    if not steps:
        return 0
    negative = False
    for i in range(n.size):
        negative = negative or force[i] < 0.0
        force[i] = force[i] if force[i] > 0.0 else 0.0  # never -0
    if negative:  # by rounding
        _gaps(n, rotation)
    numbers[0], numbers[1], numbers[9] = first + (remainder + rotation), rotation, NAN
    certificate(
        force, n.deflection, gap, n.shifted, arm, n.diagonal, torque, n.size + columns + 10.0,
        shift_error * abs(first), numbers,
    )  # fmt: skip
    return steps
