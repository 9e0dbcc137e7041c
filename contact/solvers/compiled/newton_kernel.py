# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
# cython: annotation_typing=False, infer_types=True
"""Newton's method in the bending modes: contact problems from the given data to the certificate.

With forces eliminated the unknowns are the modal amplitudes c = U'F, a dozen per tooth pair, and the rotation. The
local law F = f(indentation) may be any that is convex; with its energy Psi, Psi' = f, the function to be minimised is

    phi(c, theta) = 1/2 c'c + sum Psi(max(0, -g)) - T theta,    g = U c + S - r theta,

convex and once differentiable, with the gradient (c - U'F, r'F - T) and, K being the tangent stiffness of the law, the
Hessian [I + U'K U, -U'K r; -r'K U, r'K r]: one small block a tooth pair, with theta as a border. An iteration costs
O(n m^2) for m modes a pair, and C is never formed. A step that passes the minimum along its line is halved until phi
surely falls. With a linear law the iteration ends after finitely many steps, with a smooth one its convergence is
quadratic. Signs and complementarity of the forces are exact by construction; what is left is rounding in c and theta.

The start is that of uncoupled springs, solved on a part of the segments of each block first, see ``mode_columns``, each
standing for its neighbours. Where fewer segments of a block touch than it has modes, its matrix is inverted by
Woodbury's identity. As long as the touching segments of a block stay the same and the law is linear, its factor is
kept.

Modes that all blocks share, W_i = G_i M_b in block b, stand behind those of a block as its shared columns G; their
amplitudes in a block, M_b a, follow from the amplitudes a = W'F, which stand behind those of all blocks. A block leaves
the Schur complement of its modes on [G r], and M_b takes that to a and theta.

Compiled; run as it stands here it gives the same bits. The arrays are one-dimensional, and matrices are a place and a
distance of rows in them, see ``block_algebra``.
"""

from __future__ import annotations

import math
from typing import Any

import cython
import numpy as np

if not cython.compiled:
    from math import isfinite

    from numpy import sqrt

    from .block_algebra import add_rows, backward, dot, eliminate, forward, gram, products, row_products
    from .line_deflection import pressed, strip, tangent_root
    from .proof_kernel import certificate, first_contact, winkler_rotation

INFINITY, NAN = math.inf, math.nan
MAX_ITERATIONS = 60
#: Halvings of a step before a problem is given up.
MAX_HALVINGS = 20
#: Gradient, relative to its terms, at which only rounding is left; and below which a problem is done when a step gains
#: less than a factor of two.
ROUNDING_RESIDUAL, STALLED_RESIDUAL = 2e-15, 1e-8
#: A slope of phi below this, relative to its terms, is rounding.
ROUNDING_SLOPE = 1e-12
#: Steps on a part of the segments, and the residual at which they end where the law is not linear.
MAX_COARSE_ITERATIONS, COARSE_RESIDUAL = 12, 1e-2
WINKLER_ROW_SUM_FRACTION = 0.4
#: Part of the segments that is taken to touch before anything is known.
TOUCHING_GUESS = 0.4


class Newton:
    """The problem that is solved, and the arrays of the iteration.

    Those of segments are in the order of the blocks of a level, amplitudes in that of the blocks, each ``width`` wide,
    with the amplitudes of the shared modes last.
    """


def _prepare(n: Any, modes: Any, law: Any, size: int) -> None:
    """Make room for the problems of one compliance, see `solve_batch`."""
    n.places, blocks, n.order, n.columns, n.sums, mixing = modes
    n.law, n.table, n.mixing = law, blocks.reshape(-1, 4), mixing.reshape(-1)
    n.blocks, n.level, n.size = blocks.shape[1], 0, size
    n.local_shared, n.shared = mixing.shape[1], mixing.shape[2]
    n.padded_shared, n.plain, n.width = _padded(n.shared), n.local_shared == n.shared, 4
    for q in range(n.blocks):
        n.width = max(n.width, _padded(n.table[q, 3]))
        for k in range(n.local_shared):
            for t in range(n.shared):
                one = 1.0 if k == t else 0.0
                n.plain = n.plain and n.mixing[(q * n.local_shared + k) * n.shared + t] == one
    if n.shared:
        n.width += _padded(n.local_shared + 1)
    n.modes, n.mixed_stride = n.blocks * n.width + n.padded_shared, 0 if n.plain else n.blocks * n.local_shared
    matrix, few, mixed = n.blocks * n.width * n.width, max(n.width, n.padded_shared), n.padded_shared * n.mixed_stride
    zeros = 7 * n.modes + 2 * mixed
    whole = (n.padded_shared + 2) * n.padded_shared + 1
    n.pool, n.taken = np.empty(zeros + (10 + n.width) * size + 2 * matrix + few + whole), 0
    n.pool[:zeros] = 0.0
    n.amplitudes, n.loads, n.change = _room(n, n.modes), _room(n, n.modes), _room(n, n.modes)
    n.begin, n.best = _room(n, n.modes), _room(n, n.modes)
    n.border, n.solved = _room(n, n.modes), _room(n, n.modes)
    n.mixed, n.stiff_mixed = _room(n, mixed), _room(n, mixed)
    n.shifted, n.separation, n.arm = _room(n, size), _room(n, size), _room(n, size)
    n.stiff, n.gap, n.root = _room(n, size), _room(n, size), _room(n, size)
    n.pull, n.lever, n.force, n.local = _room(n, size), _room(n, size), _room(n, size), _room(n, size)
    n.z, n.grams, n.rows = _room(n, n.width * size), _room(n, matrix), _room(n, matrix)
    n.few, n.whole = _room(n, few), _room(n, whole)
    places = np.empty(3 * n.blocks + 2 * size, dtype=np.int64)
    n.spans, n.segment, n.touching = places[: 3 * n.blocks], places[3 * n.blocks : -size], places[-size:]
    for t in range(0 if n.plain else n.shared):  # the mixing of all blocks side by side, transposed
        for q in range(n.mixed_stride):
            n.mixed[t * n.mixed_stride + q] = n.mixing[q * n.shared + t]


def _room(n: Any, size: int) -> Any:
    """The next numbers of the pool."""
    n.taken += size
    return n.pool[n.taken - size : n.taken]


def _padded(size: int) -> int:
    """The next multiple of four."""
    return 4 * ((size + 3) // 4)


def _count(n: Any, q: int) -> int:
    """Number of amplitudes of a block; behind the last one, of the shared modes."""
    count: int = n.table[n.level + q, 3] if q < n.blocks else n.shared
    return count


def _spread(n: Any, vector: Any) -> None:
    """Amplitudes of the shared columns in every block, M_b a, from those behind all blocks."""
    first = n.blocks * n.width
    for q in range(n.blocks):
        at = q * n.width + n.table[n.level + q, 3]
        if n.plain:
            for t in range(n.shared):
                vector[at + t] = vector[first + t]
        else:
            row_products(
                n.mixing, q * n.local_shared * n.shared, n.shared, n.local_shared, vector, first, n.shared, vector, at
            )


def _gather(n: Any) -> None:
    """Loads of the shared modes from those of the shared columns in every block, the sum of M_b' x."""
    first = n.blocks * n.width
    for t in range(n.shared):
        n.loads[first + t] = 0.0
    for q in range(n.blocks):
        at = q * n.width + n.table[n.level + q, 3]
        if n.plain:
            for t in range(n.shared):
                n.loads[first + t] += n.loads[at + t]
        else:
            add_rows(
                n.mixing, q * n.local_shared * n.shared, n.shared, n.local_shared, n.loads, at, n.loads, first, n.shared
            )


def _point(n: Any, rotation: float, linear: bool) -> tuple[float, float, bool]:
    """Gaps, forces and loads at the amplitudes and a rotation.

    Returns the moment of the forces, the sum of stiffness times squared arm, and whether the touching set has changed;
    blocks in which it has are marked in ``spans``: first touching place, end, mark.
    """
    _spread(n, n.amplitudes)
    moment, pivot, changed = 0.0, 0.0, not linear
    for q in range(n.blocks):
        at = n.level + q
        x0, count, column, rank = n.table[at, 0], n.table[at, 1], n.table[at, 2], n.table[at, 3]
        x1 = x0 + count
        for x in range(x0, x1):
            n.gap[x] = n.separation[x] - rotation * n.arm[x]
        add_rows(n.columns, column, count, rank + n.local_shared, n.amplitudes, q * n.width, n.gap, x0, count)
        low, high, different = x1, x0, not linear
        if linear:
            for x in range(x0, x1):
                if n.gap[x] < 0.0:
                    if n.root[x] == 0.0:
                        different = True
                    n.root[x] = n.stiff[x]
                    low, high = min(low, x), x + 1
                else:
                    if n.root[x] != 0.0:
                        different = True
                    n.root[x] = 0.0
                n.pull[x] = -n.gap[x] * n.root[x]
        else:
            weight = n.stiff[x0]
            for x in range(x0, x1):
                n.root[x], n.pull[x] = 0.0, 0.0
                if n.gap[x] < 0.0:
                    force, tangent = pressed(n.law, n.segment[x], -n.gap[x], n.force[x])
                    n.force[x], n.root[x] = force, sqrt(weight * tangent)
                    n.pull[x] = weight * force / n.root[x]
                    low, high = min(low, x), x + 1
        if different:
            changed = True
            low = min(low, high)
            n.spans[3 * q], n.spans[3 * q + 1], n.spans[3 * q + 2] = low, high, 1
            for x in range(low, high):
                n.lever[x] = n.root[x] * n.arm[x]
        moment, pivot = _loads_of(n, q, moment, pivot)
    _gather(n)
    return moment, pivot, changed


def _loads_of(n: Any, q: int, moment: float, pivot: float) -> tuple[float, float]:
    """Loads of a block from the pull of its touching segments; returns the sums of `_point` with those of the block."""
    at, low, high = n.level + q, n.spans[3 * q], n.spans[3 * q + 1]
    x0, count, column, rank = n.table[at, 0], n.table[at, 1], n.table[at, 2], n.table[at, 3]
    for x in range(low, high):
        moment += n.pull[x] * n.lever[x]
        pivot += n.lever[x] * n.lever[x]
        n.pull[x] *= n.root[x]
    row_products(
        n.columns, column + low - x0, count, rank + n.local_shared, n.pull, low, high - low, n.loads, q * n.width
    )
    return moment, pivot


def _fill(n: Any, q: int, low: int, high: int, segments: bool) -> None:
    """Modes of a block times the roots of the stiffness, one mode after the other or one segment."""
    at = n.level + q
    x0, count, column, rank = n.table[at, 0], n.table[at, 1], n.table[at, 2], n.table[at, 3]
    first, rows, padded = column - x0, q * n.width * n.width, _padded(rank)
    if not segments:
        for a in range(rank):
            row, place = a * n.size, first + a * count
            for x in range(low, high):
                n.z[row + x] = n.columns[place + x] * n.root[x]
        for a in range(rank, padded):
            for x in range(low, high):
                n.z[a * n.size + x] = 0.0
        return
    for x in range(high - low):
        row, stiff, place = rows + x * n.width, n.root[low + x], first + low + x
        for a in range(rank):
            n.rows[row + a] = n.columns[place] * stiff
            place += count
        for a in range(rank, padded):
            n.rows[row + a] = 0.0
    for x in range(high - low, _padded(high - low)):
        for a in range(padded):
            n.rows[rows + x * n.width + a] = 0.0


def _direction(n: Any, imbalance: float, pivot: float) -> float:
    """Newton's change of amplitudes; returns that of the rotation.

    The matrix of a block is I + Z Z'. Where fewer segments touch than there are modes, it is solved by Woodbury's
    identity: its inverse is I - Z (I + Z'Z)^-1 Z'.
    """
    width = n.width
    for q in range(n.blocks):
        rank, c0, low, high = n.table[n.level + q, 3], q * width, n.spans[3 * q], n.spans[3 * q + 1]
        padded, size, matrix = _padded(rank), _padded(high - low), q * width * width
        segments = size < padded
        if n.spans[3 * q + 2] == 1:
            n.spans[3 * q + 2] = 0
            if segments:
                _fill(n, q, low, high, True)
                gram(n.rows, matrix, width, size, padded, n.grams, matrix, width, size)
                eliminate(n.grams, matrix, width, 0, size, size)
                for x in range(size):
                    n.few[x] = n.lever[low + x] if x < high - low else 0.0
                for a in range(padded):
                    n.border[c0 + a] = 0.0
                    n.solved[c0 + a] = 0.0
                add_rows(n.rows, matrix, width, size, n.few, 0, n.border, c0, padded)
                forward(n.grams, matrix, width, size, n.few, 0)
                backward(n.grams, matrix, width, size, n.few, 0)
                add_rows(n.rows, matrix, width, size, n.few, 0, n.solved, c0, padded)
            else:
                _fill(n, q, low, high, False)
                gram(n.z, low, n.size, padded, high - low, n.grams, matrix, width, padded)
                eliminate(n.grams, matrix, width, 0, padded, padded)
                row_products(n.z, low, n.size, padded, n.lever, low, high - low, n.border, c0)
                for a in range(c0, c0 + padded):
                    n.solved[a] = n.border[a]
                forward(n.grams, matrix, width, padded, n.solved, c0)
                backward(n.grams, matrix, width, padded, n.solved, c0)
        for a in range(c0, c0 + padded):
            n.change[a] = n.loads[a] - n.amplitudes[a] if a < c0 + rank else 0.0
        if segments:
            row_products(n.rows, matrix, width, size, n.change, c0, padded, n.few, 0)
            forward(n.grams, matrix, width, size, n.few, 0)
            backward(n.grams, matrix, width, size, n.few, 0)
            for x in range(size):
                n.few[x] = -n.few[x]
            add_rows(n.rows, matrix, width, size, n.few, 0, n.change, c0, padded)
        else:
            forward(n.grams, matrix, width, padded, n.change, c0)
            backward(n.grams, matrix, width, padded, n.change, c0)
        for a in range(c0, c0 + rank):
            pivot -= n.border[a] * n.solved[a]
            imbalance += n.border[a] * n.change[a]
    turn = imbalance / pivot
    for q in range(n.blocks):
        for a in range(q * width, q * width + n.table[n.level + q, 3]):
            n.change[a] += turn * n.solved[a]
    return turn


def _factor_with_shared(n: Any, q: int) -> None:
    """Factor the matrix of a block; below it its shared columns and the lever arm, behind that their Schur complement.

    Their rows become H = [G r]'Z' L^-T. Of Woodbury's matrix I + Z'Z the rows are those of G and r themselves, and the
    Schur complement is H H'.
    """
    at = n.level + q
    x0, count, column, rank = n.table[at, 0], n.table[at, 1], n.table[at, 2], n.table[at, 3]
    low, high, width, matrix = n.spans[3 * q], n.spans[3 * q + 1], n.width, q * n.width * n.width
    padded, size, extended = _padded(rank), _padded(high - low), _padded(n.local_shared + 1)
    edge = min(size, padded)
    if high == low:
        for k in range(edge, edge + extended):
            for t in range(edge, edge + extended):
                n.grams[matrix + k * width + t] = 0.0
        return
    shared_column = column + rank * count - x0
    if size < padded:
        _fill(n, q, low, high, True)
        gram(n.rows, matrix, width, size, padded, n.grams, matrix, width, size)
        eliminate(n.grams, matrix, width, 0, size, size)
        for k in range(extended):
            row = matrix + (edge + k) * width
            _border_row(n, k, shared_column + k * count, low, high, n.grams, row - low)
            for t in range(high - low, edge + extended):
                n.grams[row + t] = 0.0
        eliminate(n.grams, matrix, width, edge, edge + extended, edge)
        for k in range(edge, edge + extended):
            for t in range(edge, k + 1):
                n.grams[matrix + k * width + t] = -n.grams[matrix + k * width + t]
    else:
        _fill(n, q, low, high, False)
        for k in range(extended):
            _border_row(n, k, shared_column + k * count, low, high, n.z, (edge + k) * n.size)
        gram(n.z, low, n.size, edge + extended, high - low, n.grams, matrix, width, edge)
        eliminate(n.grams, matrix, width, 0, edge + extended, edge)


def _border_row(n: Any, k: int, column: int, low: int, high: int, result: Any, out: int) -> None:
    """Row of [G r]' times the roots of the stiffness: a shared column, the lever arm, or zeros."""
    for x in range(low, high):
        if k < n.local_shared:
            result[out + x] = n.columns[column + x] * n.root[x]
        else:
            result[out + x] = n.lever[x] if k == n.local_shared else 0.0


def _factor_whole(n: Any) -> None:
    """Matrix of the shared modes, I plus what the blocks leave on them, factored; then its border, and the corner."""
    width, shared, local, padded = n.width, n.shared, n.local_shared, n.padded_shared
    turning = padded * padded
    corner = turning + padded
    n.whole[: corner + 1] = 0.0
    for t in range(padded):
        n.whole[t * (padded + 1)] = 1.0
    for q in range(n.blocks):
        low, high, rank, matrix = n.spans[3 * q], n.spans[3 * q + 1], n.table[n.level + q, 3], q * width * width
        if high == low:
            if not n.plain:
                for t in range(shared):
                    for k in range(local):
                        n.stiff_mixed[t * n.mixed_stride + q * local + k] = 0.0
            continue
        edge = min(_padded(high - low), _padded(rank))
        last = matrix + (edge + local) * width + edge
        n.whole[corner] += n.grams[last + local]
        if n.plain:
            for t in range(shared):
                n.whole[turning + t] += n.grams[last + t]
                for k in range(t + 1):
                    n.whole[t * padded + k] += n.grams[matrix + (edge + t) * width + edge + k]
            continue
        for k in range(local):
            for m in range(k):
                n.grams[matrix + (edge + m) * width + edge + k] = n.grams[matrix + (edge + k) * width + edge + m]
        add_rows(n.mixing, q * local * shared, shared, local, n.grams, last, n.whole, turning, shared)
        products(
            n.mixed, q * local, n.mixed_stride, padded, n.grams, matrix + edge * (width + 1), width, local, local,
            False, n.stiff_mixed, q * local, n.mixed_stride,
        )  # fmt: skip
    if not n.plain:
        stride = n.mixed_stride
        products(n.mixed, 0, stride, padded, n.stiff_mixed, 0, stride, padded, stride, True, n.whole, 0, padded)
        for t in range(padded):
            n.whole[t * (padded + 1)] += 1.0
    eliminate(n.whole, 0, padded, 0, padded, padded)
    forward(n.whole, 0, padded, padded, n.whole, turning)
    n.whole[corner] -= dot(n.whole, turning, n.whole, turning, padded)


def _shared_direction(n: Any, imbalance: float) -> float:
    """As `_direction`, with shared modes."""
    width, shared, local, padded_shared = n.width, n.shared, n.local_shared, n.padded_shared
    first, stale = n.blocks * width, False
    turning = padded_shared * padded_shared
    for t in range(padded_shared):
        n.change[first + t] = n.loads[first + t] - n.amplitudes[first + t] if t < shared else 0.0
    border, onto = n.border, n.solved
    for q in range(n.blocks):
        rank, c0, low, high = n.table[n.level + q, 3], q * width, n.spans[3 * q], n.spans[3 * q + 1]
        padded, size, matrix = _padded(rank), _padded(high - low), q * width * width
        edge = min(size, padded)
        if n.spans[3 * q + 2] == 1:
            n.spans[3 * q + 2], stale = 0, True
            _factor_with_shared(n, q)
        for a in range(c0, c0 + padded):
            n.change[a] = n.loads[a] - n.amplitudes[a] if a < c0 + rank else 0.0
        if size < padded:
            row_products(n.rows, matrix, width, size, n.change, c0, padded, border, c0)
        else:
            for a in range(c0, c0 + padded):
                border[a] = n.change[a]
        forward(n.grams, matrix, width, edge, border, c0)
        row_products(n.grams, matrix + edge * width, width, local + 1, border, c0, edge, onto, c0)
        imbalance += onto[c0 + local]
        for k in range(local):
            onto[c0 + k] = -onto[c0 + k]
        if n.plain:
            for t in range(shared):
                n.change[first + t] += onto[c0 + t]
        else:
            add_rows(n.mixing, q * local * shared, shared, local, onto, c0, n.change, first, shared)
    if stale:
        _factor_whole(n)
    forward(n.whole, 0, padded_shared, padded_shared, n.change, first)
    turn: float = (imbalance + dot(n.whole, turning, n.change, first, padded_shared)) / n.whole[turning + padded_shared]
    for t in range(padded_shared):
        n.change[first + t] += turn * n.whole[turning + t]
    backward(n.whole, 0, padded_shared, padded_shared, n.change, first)
    _spread(n, n.change)
    for q in range(n.blocks):
        rank, c0, low, high = n.table[n.level + q, 3], q * width, n.spans[3 * q], n.spans[3 * q + 1]
        if high == low:
            continue
        padded, size, matrix = _padded(rank), _padded(high - low), q * width * width
        edge = min(size, padded)
        if size < padded:
            for x in range(c0, c0 + edge):
                border[x] = -border[x]
        for k in range(local):
            onto[c0 + k] = -n.change[c0 + rank + k]
        onto[c0 + local] = turn
        add_rows(n.grams, matrix + edge * width, width, local + 1, onto, c0, border, c0, edge)
        backward(n.grams, matrix, width, edge, border, c0)
        if size < padded:
            add_rows(n.rows, matrix, width, size, border, c0, n.change, c0, rank)
        else:
            for a in range(c0, c0 + rank):
                n.change[a] = border[a]
    return turn


def _turn(n: Any, imbalance: float, pivot: float) -> float:
    """Newton's change of the amplitudes; returns that of the rotation."""
    if n.shared:
        return _shared_direction(n, imbalance)
    return _direction(n, imbalance, pivot)


def _stiffness(n: Any) -> float:
    """Torque that turns the gear by one radian while the touching segments keep contact, at a solution.

    Newton's change of the rotation for a torque of one more. The amplitudes become the loads, so that these are in
    balance; the tangents of the line contacts are those at the forces themselves.
    """
    pivot = 0.0
    _copy(n.loads, n.amplitudes)
    for q in range(n.blocks):
        n.spans[3 * q + 2] = 1
        for x in range(n.spans[3 * q], n.spans[3 * q + 1]):
            if n.root[x] > 0.0:
                n.root[x] = tangent_root(n.law, n.segment[x], n.force[x])
            n.lever[x] = n.root[x] * n.arm[x]
            pivot += n.lever[x] * n.lever[x]
    return 1.0 / _turn(n, 1.0, pivot)


def _stuck(n: Any) -> tuple[float, float]:
    """As `_point` at amplitudes and rotation zero, where the touching segments stick together and no others touch."""
    moment, pivot = 0.0, 0.0
    for q in range(n.blocks):
        x0, count = n.table[n.level + q, 0], n.table[n.level + q, 1]
        low, high = x0 + count, x0
        for x in range(x0, x0 + count):
            n.root[x] = 0.0
            if n.touching[x] != 0:
                n.root[x] = n.stiff[x]
                low, high = min(low, x), x + 1
            n.pull[x] = -n.separation[x] * n.root[x]
            n.lever[x] = n.root[x] * n.arm[x]
        n.spans[3 * q], n.spans[3 * q + 1], n.spans[3 * q + 2] = min(low, high), high, 1
        moment, pivot = _loads_of(n, q, moment, pivot)
    _gather(n)
    return moment, pivot


def _residual(n: Any, torque: float, moment: float) -> float:
    """Gradient of phi relative to its terms."""
    amplitude, left, of_blocks, level = 0.0, 0.0, 0.0, torque
    for q in range(n.blocks + 1):
        if q == n.blocks:
            of_blocks, left = left / amplitude if amplitude > 0.0 else left, 0.0
        for a in range(q * n.width, q * n.width + _count(n, q)):
            amplitude = max(amplitude, abs(n.amplitudes[a]))
            left = max(left, abs(n.loads[a] - n.amplitudes[a]))
    if amplitude > 0.0:
        left /= amplitude
    if not torque > 0.0:  # without a torque, segments press against each other
        for q in range(n.blocks):
            for x in range(n.spans[3 * q], n.spans[3 * q + 1]):
                level += abs(n.pull[x] * n.arm[x])
    residual: float = max(max(abs(torque - moment) / level, of_blocks), left)
    return residual


def _slope(n: Any, torque: float, moment: float, turn: float) -> tuple[float, float]:
    """Slope of phi along a step, and what of it is rounding."""
    bending, local = 0.0, -turn * moment
    for q in range(n.blocks + 1):
        for a in range(q * n.width, q * n.width + _count(n, q)):
            bending += n.change[a] * n.amplitudes[a]
            local += n.change[a] * n.loads[a]
    work = torque * turn
    return bending - local - work, ROUNDING_SLOPE * (abs(bending) + abs(local) + abs(work))


def _move(n: Any, length: float, rotation: float, linear: bool) -> tuple[float, float, bool]:
    """As `_point`, at the amplitudes so far along a step and the rotation there."""
    for a in range(n.modes):
        n.amplitudes[a] = n.begin[a] + length * n.change[a]
    return _point(n, rotation, linear)


def _copy(given: Any, result: Any) -> None:
    """Copy a vector."""
    for a in range(given.shape[0]):
        result[a] = given[a]


def _iterate(n: Any, torque: float, rotation: float, linear: bool, coarse: bool) -> tuple[float, int, bool]:
    """Newton's method from the amplitudes and a rotation; returns rotation, steps and whether it ended."""
    least, steps, ended, kept, current = INFINITY, 0, False, rotation, 0
    moment, pivot, changed = _point(n, rotation, linear)
    for iteration in range(MAX_COARSE_ITERATIONS if coarse else MAX_ITERATIONS):
        current = iteration
        residual = _residual(n, torque, moment)
        if coarse and (residual < COARSE_RESIDUAL or (linear and iteration > 0 and not changed)):
            return rotation, iteration, True
        before = least
        if residual < least:
            least, steps, kept = residual, iteration, rotation
            _copy(n.amplitudes, n.best)
        if residual <= ROUNDING_RESIDUAL or (not residual < 0.5 * before and before < STALLED_RESIDUAL):
            ended = True
            break
        if not isfinite(residual):
            break
        turn = _turn(n, torque - moment, pivot)
        _copy(n.amplitudes, n.begin)
        begin, rotation = rotation, rotation + turn
        moment, pivot, changed = _move(n, 1.0, rotation, linear)
        if coarse:
            continue
        slope, rounding = _slope(n, torque, moment, turn)
        length = 1.0
        for _halving in range(MAX_HALVINGS):
            if not slope > rounding:
                break
            rotation = begin + 0.5 * length * turn
            moment, pivot, changed = _move(n, 0.5 * length, rotation, linear)
            half_slope, _half_rounding = _slope(n, torque, moment, turn)
            if not half_slope + slope > 0.0:  # the longer step it is
                rotation = begin + length * turn
                moment, pivot, changed = _move(n, length, rotation, linear)
                break
            length, slope = 0.5 * length, half_slope
    if coarse:
        return rotation, current, True
    if steps != current:
        _copy(n.best, n.amplitudes)
        rotation = kept
        _point(n, rotation, linear)
    return rotation, steps, ended


def _take(n: Any, level: int, arm: Any, local: Any, linear: bool, guess: float, highest: bool) -> int:
    """Take the segments of a level; returns their number. Local compliances of the highest are those at a load."""
    total, first = 0, n.places[level]
    n.level = level * n.blocks
    for q in range(n.blocks):
        x0, count = n.table[n.level + q, 0], n.table[n.level + q, 1]
        weight = n.table[q, 1] / (1.0 * count)
        total = x0 + count
        for x in range(x0, total):
            i = n.order[first + x]
            n.segment[x], n.separation[x], n.arm[x], n.root[x] = i, n.shifted[i], arm[i], 0.0
            if linear:
                n.local[x] = local[i]
            elif highest:
                secant, _tangent = strip(n.law, i, guess / n.law[i, 0])
                n.local[x] = secant / n.law[i, 0]
            n.stiff[x] = sqrt(weight / n.local[x]) if linear or highest else weight
        n.spans[3 * q], n.spans[3 * q + 1], n.spans[3 * q + 2] = x0, x0, 1
    return total


def _start(n: Any, total: int, torque: float, mask: Any, b: int) -> tuple[float, float]:
    """Amplitudes and rotation at which the segments that are taken to touch stick; and `winkler_rotation`."""
    winkler, some = 0.0, False
    if mask.shape[0]:
        for x in range(total):
            n.touching[x] = mask[b, n.segment[x]] != 0 and n.arm[x] > 0.0
            some = some or n.touching[x] != 0
        if not some:
            for x in range(total):
                n.touching[x] = n.separation[x] == 0.0 and n.arm[x] > 0.0
    else:
        for q in range(n.blocks):
            x0, count = n.table[n.level + q, 0], n.table[n.level + q, 1]
            weight = n.table[q, 1] / (1.0 * count)
            for x in range(x0, x0 + count):
                i = n.segment[x]
                whole = max(WINKLER_ROW_SUM_FRACTION * (n.sums[1, i] + n.local[x]), n.local[x] + n.sums[0, i])
                n.gap[x] = weight / whole
        winkler = winkler_rotation(n.gap, n.separation, n.arm, total, torque)
        for x in range(total):
            n.touching[x] = n.arm[x] > 0.0 and winkler * n.arm[x] > n.separation[x]
    n.amplitudes[:] = 0.0
    moment, pivot = _stuck(n)
    rotation = _turn(n, torque - moment, pivot)
    _copy(n.change, n.amplitudes)
    if not isfinite(rotation):
        n.amplitudes[:] = 0.0
        rotation = winkler
    return rotation, winkler


def _forces_of_level(n: Any, level: int, top: int, guess: float) -> None:
    """Forces to begin with on a level: those of the nearest segments of the level above, in ``local``."""
    for q in range(n.blocks):
        x0, count, above = n.table[n.level + q, 0], n.table[n.level + q, 1], (level + 1) * n.blocks + q
        for j in range(count):
            if level == top:
                n.force[x0 + j] = guess
            else:
                n.force[x0 + j] = n.local[n.table[above, 0] + j * n.table[above, 1] // count]


def _solve(n: Any, torque: float, arm: Any, local: Any, linear: bool, mask: Any, b: int) -> tuple[float, int, bool]:
    """Solve one problem, level by level; returns rotation, steps and whether the method ended."""
    rotation, winkler, steps, ended, guess = 0.0, 0.0, 0, False, 0.0
    if not linear:
        longest = 0.0
        for i in range(n.size):
            longest += max(arm[i], 0.0)
        guess = torque / (longest * TOUCHING_GUESS)
    top = 0 if mask.shape[0] else n.places.shape[0] - 1
    for down in range(top + 1):
        level = top - down
        total = _take(n, level, arm, local, linear, guess, level == top)
        if level == top:
            rotation, winkler = _start(n, total, torque, mask, b)
            if not linear:
                rotation, steps, ended = _iterate(n, torque, rotation, True, True)
                for q in range(n.blocks):
                    x0, count = n.table[n.level + q, 0], n.table[n.level + q, 1]
                    for x in range(x0, x0 + count):
                        n.stiff[x] = n.table[q, 1] / (1.0 * count)
        if not linear:
            _forces_of_level(n, level, top, guess)
        rotation, steps, ended = _iterate(n, torque, rotation, linear, level > 0)
        if level > 0:
            amplitudes = 0.0
            for a in range(n.modes):
                amplitudes += n.amplitudes[a]
            if not (isfinite(rotation) and isfinite(amplitudes)):
                n.amplitudes[:] = 0.0
                rotation = winkler
            for x in range(total):
                n.local[x] = n.force[x]
    return rotation, steps, ended


def _answer(
    n: Any, linear: bool, local: Any, diagonal: Any, factor: Any, rotation: float, arm: Any, force: Any, gap: Any,
    secant: Any, b: int,
) -> float:  # fmt: skip
    """Forces and gaps in the order of the segments, the deflection from the forces themselves.

    Deflections and diagonal of the compliance are then in ``pull`` and ``lever``. Returns the spread of terms that
    cancel in W, which leave more rounding than its diagonal tells.
    """
    columns = n.given.shape[0]
    n.given[:] = 0.0
    for x in range(n.size):
        if linear:
            n.separation[x] = n.pull[x] if n.root[x] > 0.0 else 0.0  # never -0
        else:
            n.separation[x] = n.force[x] if n.gap[x] < 0.0 else 0.0
        n.gap[x] = 0.0
        if columns and n.separation[x] > 0.0:
            add_rows(factor, n.segment[x] * columns, columns, 1, n.separation, x, n.given, 0, columns)
    if columns:
        row_products(factor, 0, columns, n.size, n.given, 0, columns, n.local, 0)
    elif n.shared:
        _spread(n, n.loads)
    for q in range(0 if columns else n.blocks):
        x0, count, column, rank = n.table[q, 0], n.table[q, 1], n.table[q, 2], n.table[q, 3]
        add_rows(n.columns, column, count, rank + n.local_shared, n.loads, q * n.width, n.gap, x0, count)
    spread = 1.0
    for x in range(n.size):
        i = n.segment[x]
        force[b, i] = n.separation[x]
        compliance = 0.0
        if linear:
            compliance = local[i]
        else:
            compliance, _tangent = strip(n.law, i, n.separation[x] / n.law[i, 0])
            compliance /= n.law[i, 0]
            secant[b, i] = compliance
        n.pull[i] = compliance * n.separation[x] + (n.local[i] if columns else n.gap[x])
        n.lever[i] = diagonal[i] if linear else compliance + n.sums[0, i]
        if n.shared and not columns:
            terms = compliance + n.sums[0, i] + n.sums[3, i]
            n.lever[i] = compliance + n.sums[0, i] + n.sums[2, i]
            spread = max(spread, terms / n.lever[i])
    for i in range(n.size):
        gap[b, i] = n.pull[i] + n.shifted[i] - rotation * arm[i]
    return spread


def solve_batch(
    modes: Any, factor: Any, torque: Any, separation: Any, arm: Any, local: Any, diagonal: Any, law: Any, mask: Any,
    force: Any, gap: Any, secant: Any, numbers: Any, counts: Any,
) -> None:  # fmt: skip
    """Solve problems of one compliance one after another.

    Parameters
    ----------
    modes
        See ``mode_columns``.
    factor
        What the modes were compressed from, row by row (n k): the answer is proved on it; empty for none.
    torque
        Of every problem (b) [N mm].
    separation
        Of every problem (b, n) [mm].
    arm, local, diagonal
        Of the segments (n) [mm], [mm/N]: the latter two their local and whole compliances, where these are given.
    law
        Parameters of line contacts (n, 14), else empty.
    mask
        Of every problem, segments that are assumed in contact (b, n); empty for none.
    force, gap
        For the results (b, n).
    secant
        For the secant compliance of line contacts (b, n); empty if there are none.
    numbers, counts
        For the numbers (b, 10), and steps and whether the method ended (b, 2). The stiffness is that of line contacts,
        see `_stiffness`.
    """
    n: Any = Newton()
    linear = law.shape[0] == 0
    _prepare(n, modes, law, arm.shape[0])
    n.given = np.empty(factor.shape[0] // n.size)
    known = n.size + 10.0 + (n.given.shape[0] or n.width + n.local_shared + n.shared)
    for b in range(torque.shape[0]):
        first, remainder, shift_error = first_contact(separation[b], arm, n.shifted)
        rotation, steps, ended = _solve(n, torque[b], arm, local, linear, mask, b)
        counts[b, 0], counts[b, 1] = steps + 1, ended
        numbers[b, 9] = NAN if linear else _stiffness(n)
        spread = _answer(n, linear, local, diagonal, factor, rotation, arm, force, gap, secant, b)
        numbers[b, 0], numbers[b, 1] = first + (remainder + rotation), rotation
        certificate(
            force[b], n.pull, gap[b], n.shifted, arm, n.lever, torque[b], spread * known, shift_error * abs(first),
            numbers[b],
        )  # fmt: skip
