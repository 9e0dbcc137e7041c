"""Direct solver for a banded matrix plus a banded one times the matrix of elastic influence, in n log^2 n.

The Jacobian of the lubricated contact is

    J = A + C K,    K(i, j) = kernel(|i - j|),

A and C banded, K dense: the logarithm, integrated over hat functions. Away from its diagonal K is smooth, so that each
block of J beside the diagonal has a rank of about a dozen at any size. The matrix is halved recursively; each
block beside the diagonal is kept as a product of two thin matrices, and

    [ J1      U12 V12' ] [ x1 ]   [ b1 ]
    [ U21 V21'      J2 ] [ x2 ] = [ b2 ]

is reduced to the solutions of its halves, with b and U as right-hand sides, and one small system. K is Toeplitz: all
blocks of one size share V, and their U are products of C with one matrix. Blocks of one size are treated together.

K is the deflection of two half planes in line contact, a convolution with the logarithm. In units of the Hertz contact
the deflection under the pressure P is

    D(X) = -1/pi  integral P(X') ln|X - X'| dX'.

P is piecewise linear between the nodes of a uniform grid. The integral of a hat function against the logarithm is known
in closed form, so that the only error is that of the linear interpolation: second order in the spacing. The sum over
all nodes is a product with a Toeplitz matrix, taken by fast Fourier transforms of twice the length, padded with zeros:
n log n work and no wrap-around.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

from ...core.arrays import RealArray as Array, record

#: From this distance on, in grid spacings, a series replaces the closed form, whose digits cancel there.
SERIES_DISTANCE = 40


def logarithm_of_hats(distance: NDArray[np.int_]) -> NDArray[np.float64]:
    """Integral (n) of a hat function of unit spacing against ln|k - x|, for whole distances k of either sign.

    G(k + 1) - 2 G(k) + G(k - 1) with G(x) = x^2 ln|x| / 2 - 3 x^2 / 4; for large k ln k - 1/(12 k^2) - 1/(60 k^4) -
    1/(168 k^6), to rounding.
    """
    k = np.abs(np.asarray(distance, dtype=np.float64))
    near = k < SERIES_DISTANCE

    def antiderivative(x: NDArray[np.float64]) -> NDArray[np.float64]:
        size = np.abs(x)
        return 0.5 * x**2 * np.log(np.where(size > 0.0, size, 1.0)) - 0.75 * x**2

    small, large = np.where(near, k, 0.0), np.where(near, SERIES_DISTANCE, k)
    closed = antiderivative(small + 1.0) - 2.0 * antiderivative(small) + antiderivative(small - 1.0)
    inverse = large**-2
    series = np.log(large) - inverse * (1.0 / 12.0 + inverse * (1.0 / 60.0 + inverse / 168.0))
    return np.where(near, closed, series)


@record(frozen=True)
class Deflection:
    """Deflection of the surfaces on a uniform grid, with its spacing in half widths of the Hertz contact."""

    nodes: int
    spacing: float

    @cached_property
    def influence(self) -> NDArray[np.float64]:
        """Deflection at distances 0 ... n - 1 spacings from a node of unit pressure, (n)."""
        hats = logarithm_of_hats(np.arange(self.nodes))
        return np.asarray(-self.spacing / np.pi * (hats + np.log(self.spacing)))

    @cached_property
    def _length(self) -> int:
        return int(next_fast_len(2 * self.nodes - 1, real=True))

    @cached_property
    def _transform(self) -> NDArray[np.complex128]:
        ring = np.zeros(self._length)
        ring[: self.nodes] = self.influence
        ring[self._length - self.nodes + 1 :] = self.influence[:0:-1]
        return np.asarray(rfft(ring))

    def __call__(self, pressure: NDArray[np.float64]) -> NDArray[np.float64]:
        """Deflection under nodal pressures; both (..., n), dimensionless."""
        spectrum = rfft(pressure, self._length, axis=-1)
        spectrum *= self._transform
        return np.asarray(irfft(spectrum, self._length, axis=-1)[..., : self.nodes])


#: Diagonals of A and C: two below the main one (second-order upstream differences), one above.
OFFSETS = (-2, -1, 0, 1)
_BELOW, _ABOVE = 2, 1
_BANDS = len(OFFSETS)

#: Blocks on the diagonal are not halved below about this size.
LEAF_SIZE = 48
#: Accuracy of the blocks beside the diagonal, relative to their largest entry.
BLOCK_TOLERANCE = 1e-12


@dataclass(frozen=True, eq=False)
class _Halving:
    """Influence of one half of a block on the other, as pairs (rows, v) with influence = rows v'.

    Rows (h + 3, r) are the nodes that feel it and the neighbours that the bands of C reach; v (h, r) those that act.
    """

    on_first: tuple[Array, Array]
    on_second: tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class _Tree:
    """Parts that all systems with the same number of nodes share."""

    padded: int
    leaf: int
    within_leaf: Array
    halvings: tuple[_Halving, ...]


@lru_cache(maxsize=16)
def _tree(nodes: int) -> _Tree:
    levels = max(0, int(np.log2(nodes / LEAF_SIZE)))
    leaf = -(-nodes // 2**levels)
    halvings = tuple(_halving(leaf * 2 ** (levels - level - 1)) for level in range(levels))
    within = logarithm_of_hats(np.subtract.outer(np.arange(-_BELOW, leaf + _ABOVE), np.arange(leaf)))
    return _Tree(leaf * 2**levels, leaf, within, halvings)


def _halving(half: int) -> _Halving:
    reach = np.arange(-_BELOW, half + _ABOVE)

    def factors(apart: int) -> tuple[Array, Array]:
        return _thin_factors(lambda i, j: logarithm_of_hats(reach[i] + apart - j), reach.size, half)

    return _Halving(on_first=factors(-half), on_second=factors(half))


def _thin_factors(entry: Callable[..., Array], rows: int, columns: int) -> tuple[Array, Array]:
    """Factors u, v with entry(i, j) = (u v')(i, j): cross approximation, then the shortest such product."""
    all_rows, all_columns = np.arange(rows), np.arange(columns)
    left: list[Array] = []
    right: list[Array] = []
    free = np.ones(rows, dtype=bool)
    pivot_row, largest = 0, 0.0
    for _ in range(min(rows, columns)):
        free[pivot_row] = False
        row = entry(pivot_row, all_columns) - sum(u[pivot_row] * v for u, v in zip(left, right, strict=True))
        pivot_column = int(np.argmax(np.abs(row)))
        pivot = row[pivot_column]
        if abs(pivot) <= 0.1 * BLOCK_TOLERANCE * largest:
            if not free.any() or len(left) > 3:
                break
        else:
            largest = max(largest, abs(pivot))
            column = entry(all_rows, pivot_column) - sum(u * v[pivot_column] for u, v in zip(left, right, strict=True))
            left.append(column / pivot)
            right.append(row)
        remaining = np.where(free, np.abs(left[-1]), -1.0)
        pivot_row = int(np.argmax(remaining))
    q_left, r_left = np.linalg.qr(np.array(left).T)
    q_right, r_right = np.linalg.qr(np.array(right).T)
    u, values, v = np.linalg.svd(r_left @ r_right.T)
    kept = int(np.sum(values > BLOCK_TOLERANCE * values[0]))
    return q_left @ (u[:, :kept] * values[:kept]), q_right @ v[:kept].T


def solve(a: Array, c: Array, sides: Array) -> Array:
    """Solve (A + C K) x = b for several right-hand sides.

    Parameters
    ----------
    a, c
        Diagonals of A and C by row (4, n): ``a[k, i]`` is the entry of row i in column i + OFFSETS[k]. Entries outside
        the matrix are zero in ``a``; in ``c`` they must be zero too.
    sides
        Right-hand sides (n, q).

    Returns
    -------
    (n, q) array

    Raises
    ------
    numpy.linalg.LinAlgError
        If a block on the diagonal is singular.
    """
    nodes, columns = sides.shape
    tree = _tree(nodes)
    padding = tree.padded - nodes
    a_rows = np.zeros((tree.padded, _BANDS))
    c_rows = np.zeros((tree.padded, _BANDS))
    b = np.zeros((tree.padded, columns))
    a_rows[:nodes], c_rows[:nodes], b[:nodes] = a.T, c.T, sides
    if padding:
        a_rows[nodes:, OFFSETS.index(0)] = 1.0  # decoupled: their solution is zero
    return _solve_level(tree, 0, a_rows, c_rows, b[None])[0, :nodes]


def _solve_level(tree: _Tree, level: int, a: Array, c: Array, b: Array) -> Array:
    """Solve all blocks of a level; b and the result are (blocks, size, q)."""
    if level == len(tree.halvings):
        return np.asarray(np.linalg.solve(_leaf_blocks(tree, a, c), b))
    halving = tree.halvings[level]
    blocks, size, columns = b.shape
    half = size // 2
    a_halves, c_halves = a.reshape(blocks, 2, half, _BANDS), c.reshape(blocks, 2, half, _BANDS)
    u_first, v_first = _beside(halving.on_first, a_halves[:, 0], c_halves[:, 0], first=True)
    u_second, v_second = _beside(halving.on_second, a_halves[:, 1], c_halves[:, 1], first=False)
    rank_first, rank_second = u_first.shape[2], u_second.shape[2]
    sides = np.zeros((blocks, 2, half, columns + max(rank_first, rank_second)))
    sides[..., :columns] = b.reshape(blocks, 2, half, columns)
    sides[:, 0, :, columns : columns + rank_first] = u_first
    sides[:, 1, :, columns : columns + rank_second] = u_second
    solved = _solve_level(tree, level + 1, a, c, sides.reshape(2 * blocks, half, -1)).reshape(sides.shape)
    x, z = solved[..., :columns], solved[..., columns:]
    z_first, z_second = z[:, 0, :, :rank_first], z[:, 1, :, :rank_second]
    # x1 = y1 - Z1 s, x2 = y2 - Z2 t with s = V12' x2 and t = V21' x1.
    system = np.zeros((blocks, rank_first + rank_second, rank_first + rank_second))
    system[:] = np.eye(rank_first + rank_second)
    system[:, :rank_first, rank_first:] = v_first.T @ z_second
    system[:, rank_first:, :rank_first] = v_second.T @ z_first
    known = np.concatenate([v_first.T @ x[:, 1], v_second.T @ x[:, 0]], axis=1)
    coupling = np.linalg.solve(system, known)
    first = x[:, 0] - z_first @ coupling[:, :rank_first]
    second = x[:, 1] - z_second @ coupling[:, rank_first:]
    return np.concatenate([first, second], axis=1)


def _beside(factors: tuple[Array, Array], a: Array, c: Array, *, first: bool) -> tuple[Array, Array]:
    """Factors of the block beside the diagonal in the rows of one half: u (blocks, h, r), v (h, r)."""
    rows, v = factors
    half, rank = v.shape
    blocks = a.shape[0]
    # The diagonals of A reach one column into the second half, or two into the first.
    reached = _ABOVE if first else _BELOW
    u = np.zeros((blocks, half, rank + reached))
    v_all = np.zeros((half, rank + reached))
    v_all[:, :rank] = v
    for k, offset in enumerate(OFFSETS):
        start = offset + _BELOW
        u[..., :rank] += c[..., k, None] * rows[start : start + half]
    if first:
        u[:, -1, rank] = a[:, -1, OFFSETS.index(1)]
        v_all[0, rank] = 1.0
    else:
        u[:, 0, rank] = a[:, 0, OFFSETS.index(-1)]
        u[:, 1, rank] = a[:, 1, OFFSETS.index(-2)]
        u[:, 0, rank + 1] = a[:, 0, OFFSETS.index(-2)]
        v_all[-1, rank] = v_all[-2, rank + 1] = 1.0
    return u, v_all


def _leaf_blocks(tree: _Tree, a: Array, c: Array) -> Array:
    """Blocks on the diagonal, (blocks, leaf, leaf)."""
    leaf = tree.leaf
    a, c = a.reshape(-1, leaf, _BANDS), c.reshape(-1, leaf, _BANDS)
    dense = np.zeros((a.shape[0], leaf, leaf))
    for k, offset in enumerate(OFFSETS):
        start = offset + _BELOW
        dense += c[..., k, None] * tree.within_leaf[start : start + leaf]
        row = np.arange(max(0, -offset), leaf - max(0, offset))
        dense[:, row, row + offset] += a[:, row, k]
    return dense
