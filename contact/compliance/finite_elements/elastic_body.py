"""Finite elements of a tooth on its body, factored once for the response to any loads.

The elements are quadratic bricks. The stiffness of an isotropic brick needs one sum over the Gauss points only, H = sum
of w (grad N)(grad N)^T; both Lame terms and the Laplacian are entries of H in another order. That makes the assembly
one matrix product a brick.

The solution is direct, in substructures that are condensed to their borders by small full matrices. The bricks are
halved again and again, each time where the halves share few nodes (nested dissection, A. George 1973,
doi:10.1137/0710032). Then the halves are joined: a node that no other brick has is eliminated by Cholesky's method, and
what remains is the stiffness of the larger piece against its border.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ....core.arrays import Array, Integers, record
from ....core.errors import GeometryError
from ..material import Material

if TYPE_CHECKING:
    from scipy.sparse import csc_array

GAUSS_POINTS = 3  # in each direction: exact for a brick with straight edges
BRICKS_PER_BATCH = 32  # as many as fit into a processor's cache
ShapeFunctions = Callable[[Array], tuple[Array, Array]]


def quadratic(x: Array) -> tuple[Array, Array]:
    """Values and slopes (..., 3) of the parabolas through -1, 0, 1."""
    x = np.asarray(x, dtype=float)
    values = np.stack([0.5 * x * (x - 1.0), 1.0 - x * x, 0.5 * x * (x + 1.0)], axis=-1)
    return values, np.stack([x - 0.5, -2.0 * x, x + 0.5], axis=-1)


def shape_functions(points: Array) -> tuple[Array, Array]:
    """Shape functions (n, 27) and gradients (n, 27, 3) at points (n, 3) of the cube -1 to 1; nodes as (3, 3, 3)."""
    (a, da), (b, db), (c, dc) = (quadratic(points[:, k]) for k in range(3))

    def product(x: Array, y: Array, z: Array) -> Array:
        return np.asarray(np.einsum("ni,nj,nk->nijk", x, y, z).reshape(len(points), 27))

    return product(a, b, c), np.stack([product(da, b, c), product(a, db, c), product(a, b, dc)], axis=2)


def gauss_rule(count: int = GAUSS_POINTS) -> tuple[Array, Array]:
    """Points (count^3, 3) and weights of the cube from -1 to 1."""
    x, w = np.polynomial.legendre.leggauss(count)
    points = np.stack(np.meshgrid(x, x, x, indexing="ij"), axis=-1).reshape(-1, 3)
    return points, np.einsum("i,j,k->ijk", w, w, w).ravel()


def brick_gradients(corners: Array, gradients: Array) -> tuple[Array, Array]:
    """Gradients in space (m, g, 27, 3) [1/mm] and Jacobian determinants (m, g) of bricks with nodes (m, 27, 3)."""
    jacobian = np.einsum("mak,gal->mgkl", corners, gradients, optimize=True)
    determinant = np.linalg.det(jacobian)
    with np.errstate(divide="ignore", invalid="ignore"):
        safe = np.where((determinant == 0.0)[..., None, None], np.eye(3), jacobian)
    return gradients @ np.linalg.inv(safe), determinant


def require_right_way_round(nodes: Array, cells: Integers) -> None:
    """Refuse a brick that is turned inside out somewhere, as ``stiffness`` does, which takes them alike."""
    _, gradients = shape_functions(gauss_rule()[0])
    corners = nodes[cells.reshape(-1, 27)]
    _refuse_inside_out(corners, brick_gradients(corners, gradients)[1])


def _refuse_inside_out(corners: Array, determinant: Array) -> None:
    inside_out = np.flatnonzero(np.any(determinant <= 0.0, axis=1))
    if inside_out.size:
        where = corners[inside_out[0]].mean(axis=0)
        raise GeometryError(
            f"a brick near ({where[0]:.2f}, {where[1]:.2f}, {where[2]:.2f}) mm is turned inside out: the sides of "
            "the tooth or its fillets come too close to each other"
        )


def brick_stiffness(
    nodes: Array, cells: Integers, material: Material, functions: ShapeFunctions = shape_functions
) -> tuple[Integers, Array]:
    """Nodes (m, q) with shape functions, and stiffness (m, 3 q, 3 q) [N/mm] of every brick, x y z of a node together.

    A ``GeometryError`` refuses a brick that is turned inside out somewhere.
    """
    points, weights = gauss_rule()
    _, gradients = functions(points)
    flat = cells.reshape(-1, 27)
    young, nu = material.elastic_modulus, material.poisson_ratio
    first, shear = young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 0.5 * young / (1.0 + nu)
    used = np.flatnonzero(np.abs(gradients).sum(axis=(0, 2)) > 0.0)
    size = 3 * used.size
    result = np.empty((len(flat), size, size))
    for start in range(0, len(flat), BRICKS_PER_BATCH):
        batch = slice(start, start + BRICKS_PER_BATCH)
        spatial, determinant = brick_gradients(nodes[flat[batch]], gradients)
        _refuse_inside_out(nodes[flat[batch]], determinant)
        root = spatial[:, :, used] * np.sqrt(weights * determinant)[:, :, None, None]
        root = root.reshape(len(root), weights.size, size)
        outer = (np.swapaxes(root, 1, 2) @ root).reshape(-1, used.size, 3, used.size, 3)
        block = first * outer + shear * outer.transpose(0, 1, 4, 3, 2)
        laplacian = shear * np.einsum("maibi->mab", outer)
        for k in range(3):
            block[:, :, k, :, k] += laplacian
        result[batch] = block.reshape(-1, size, size)
    return flat[:, used], result


def stiffness(
    nodes: Array, cells: Integers, material: Material, functions: ShapeFunctions = shape_functions
) -> csc_array:
    """Stiffness matrix of a body of bricks (3 n, 3 n) [N/mm], x y z of a node together.

    A node without a shape function gets rows of zeros.
    """
    from scipy.sparse import csc_array

    of_bricks, entries = brick_stiffness(nodes, cells, material, functions)
    displacements = (3 * of_bricks[:, :, None] + np.arange(3)).reshape(len(of_bricks), -1).astype(np.int32)
    rows = np.broadcast_to(displacements[:, :, None], entries.shape).ravel()
    columns = np.broadcast_to(displacements[:, None, :], entries.shape).ravel()
    return csc_array((entries.ravel(), (rows, columns)), shape=(3 * len(nodes), 3 * len(nodes)))


BRICKS_PER_LEAF = 8  # of the smallest piece, whose bricks are joined at once
SMALLER_HALF_MINIMUM = 0.4  # share of a piece's bricks, where its lattice allows it
NO_NODES = np.empty(0, dtype=np.int64)
COLUMNS_PER_SOLVE = 128  # loads; bounds the memory


@record(frozen=True)
class Elimination:
    """Displacements that were eliminated when pieces were joined."""

    inner: Integers  # (n), eliminated
    border: Integers
    factor: Array  # lower Cholesky factor L (n, n) of the inner stiffness
    coupling: Array  # L^-1 times the stiffness between inner and border (n, m)


@record(frozen=True)
class Substructures:
    """A factored body of bricks."""

    kept: Integers
    stiffness: Array  # (3 k, 3 k) [N/mm]
    eliminations: tuple[Elimination, ...]

    @property
    def unknowns(self) -> int:
        """Number of displacements that were eliminated."""
        return sum(step.inner.size for step in self.eliminations)

    def solve(self, loads: Array) -> Array:
        """Displacements (3 n, c) [mm] under loads (3 n, c) [N], with the kept nodes held."""
        from scipy.linalg import solve_triangular

        waiting, solution = np.array(loads, dtype=float), np.zeros(np.shape(loads))
        for step in self.eliminations:
            moved = waiting[step.inner]
            if not moved.any():
                continue  # no load has come here
            moved = solve_triangular(step.factor, moved, lower=True, check_finite=False)
            waiting[step.inner] = moved
            waiting[step.border] -= step.coupling.T @ moved
        for step in reversed(self.eliminations):
            moved = waiting[step.inner] - step.coupling @ solution[step.border]
            solution[step.inner] = solve_triangular(step.factor, moved, trans=1, lower=True, check_finite=False)
        return solution

    def response(self, loads: csc_array, wanted: csc_array) -> Array:
        """Values (m, k) of the wanted functionals (3 n, m) of the displacements under loads (3 n, k)."""
        values, count = wanted.T.tocsr(), loads.shape[1]
        starts = range(0, count, COLUMNS_PER_SOLVE)
        batches = (loads[:, start : start + COLUMNS_PER_SOLVE].toarray() for start in starts)
        return np.concatenate([values @ self.solve(batch) for batch in batches], axis=1)


@dataclass(frozen=True)
class _Piece:
    """Bricks condensed to the nodes (n) that other bricks have, too, or that are kept: stiffness (3 n, 3 n)."""

    nodes: Integers
    brick_counts: Integers  # of the piece at each node
    stiffness: Array


@dataclass(frozen=True)
class _Bricks:
    """Bricks: nodes (m, q), negative where held; stiffness; places in the lattice; how many bricks have each node."""

    nodes: Integers
    stiffness: Array
    places: Integers
    counts: Integers


def substructures(
    cells: Integers, nodes: Integers, stiffness: Array, fixed: Integers, kept: Integers = NO_NODES
) -> Substructures:
    """Factor a body of bricks, keeping the nodes ``kept`` (k); the nodes ``fixed`` do not move.

    A ``GeometryError`` refuses held and kept nodes that leave a part of the body free to move.
    """
    fate = np.zeros(max(nodes.max(), cells.max()) + 1, dtype=np.int64)
    fate[fixed] = -1
    fate[kept] = 1
    counts = np.bincount(nodes.ravel(), minlength=fate.size)
    counts[kept] += 1  # a brick that never comes: they are not eliminated
    bricks = _Bricks(np.where(fate[nodes] < 0, -1, nodes), stiffness, lattice_places(cells), counts)
    eliminations: list[Elimination] = []
    whole = _condensed(bricks, np.arange(len(nodes)), eliminations)
    order = displacements(np.searchsorted(whole.nodes, kept))
    return Substructures(kept, whole.stiffness[np.ix_(order, order)], tuple(eliminations))


def lattice_places(cells: Integers) -> Integers:
    """Places (m, 3) of bricks, counted along their own axes; neighbours share the node in the middle of a face."""
    middles = np.stack([cells[:, 0, 1, 1], cells[:, 1, 0, 1], cells[:, 1, 1, 0]])
    middles = np.stack([middles, np.stack([cells[:, 2, 1, 1], cells[:, 1, 2, 1], cells[:, 1, 1, 2]])])  # (end, axis, m)
    order = np.argsort(middles, axis=None, kind="stable")
    shared = np.flatnonzero(np.diff(middles.ravel()[order]) == 0)
    pairs = np.stack([order[shared], order[shared + 1]])
    (end, axis, one), other = np.unravel_index(pairs[0], middles.shape), pairs[1] % len(cells)
    step = np.where(end == 1, 1, -1)[:, None] * np.eye(3, dtype=np.int64)[axis]
    one, other, step = np.concatenate([one, other]), np.concatenate([other, one]), np.concatenate([step, -step])
    places, has_place = np.zeros((len(cells), 3), dtype=np.int64), np.zeros(len(cells), dtype=bool)
    while not has_place.all():
        has_place[np.argmin(has_place)] = True  # the first brick of a part that hangs together with none before
        while (new := has_place[one] & ~has_place[other]).any():
            places[other[new]] = places[one[new]] + step[new]
            has_place[other[new]] = True
    return places


def _condensed(bricks: _Bricks, chosen: Integers, eliminations: list[Elimination]) -> _Piece:
    """The chosen bricks as one piece; adds what is eliminated."""
    if chosen.size > BRICKS_PER_LEAF:
        parts = [_condensed(bricks, half, eliminations) for half in _halves(bricks, chosen)]
    else:
        parts = [_one_brick(bricks.nodes[brick], bricks.stiffness[brick]) for brick in chosen]
    return _joined(parts, bricks.counts, eliminations)


def _one_brick(nodes: Integers, stiffness: Array) -> _Piece:
    moving = np.flatnonzero(nodes >= 0)
    if moving.size < nodes.size:
        among = displacements(moving)
        stiffness = stiffness[np.ix_(among, among)]
    return _Piece(nodes[moving], np.ones(moving.size, dtype=np.int64), stiffness)


def _joined(parts: list[_Piece], counts: Integers, eliminations: list[Elimination]) -> _Piece:
    """Pieces joined to one, without the nodes that no brick outside them has."""
    from scipy.linalg import solve_triangular

    nodes, places = np.unique(np.concatenate([part.nodes for part in parts]), return_inverse=True)
    brick_counts = np.zeros(nodes.size, dtype=np.int64)
    np.add.at(brick_counts, places, np.concatenate([part.brick_counts for part in parts]))
    done = brick_counts == counts[nodes]
    rank = np.empty(nodes.size, dtype=np.int64)
    rank[np.argsort(~done, kind="stable")] = np.arange(nodes.size)  # the inner nodes first
    whole = np.zeros((3 * nodes.size, 3 * nodes.size))
    start = 0
    for part in parts:
        among = displacements(rank[places[start : start + part.nodes.size]])
        whole[np.ix_(among, among)] += part.stiffness
        start += part.nodes.size
    inner, border = nodes[done], nodes[~done]
    split = 3 * inner.size
    try:
        factor = np.linalg.cholesky(whole[:split, :split])
    except np.linalg.LinAlgError as error:
        raise GeometryError("a part of the body is free to move: hold more of its nodes") from error
    coupling = solve_triangular(factor, whole[:split, split:], lower=True, check_finite=False)
    eliminations.append(Elimination(displacements(inner), displacements(border), factor, coupling))
    return _Piece(border, brick_counts[~done], whole[split:, split:] - coupling.T @ coupling)


def _halves(bricks: _Bricks, chosen: Integers) -> tuple[Integers, Integers]:
    """Two parts of some bricks, cut across the lattice where they share few nodes."""
    best, fewest = chosen < chosen[chosen.size // 2], np.inf
    for place in bricks.places[chosen].T:
        middle = np.partition(place, chosen.size // 2)[chosen.size // 2]
        for lower in (place < middle, place <= middle):
            smaller = min(np.count_nonzero(lower), np.count_nonzero(~lower)) / chosen.size
            if smaller == 0.0:
                continue
            shared = np.intersect1d(bricks.nodes[chosen[lower]], bricks.nodes[chosen[~lower]]).size
            weighted = shared * max(SMALLER_HALF_MINIMUM / smaller, 1.0)
            if weighted < fewest:
                best, fewest = lower, weighted
    return chosen[best], chosen[~best]


def displacements(nodes: Integers) -> Integers:
    """Numbers (3 n) of the displacements of nodes (n), x y z of a node together."""
    return np.asarray((3 * nodes[:, None] + np.arange(3)).ravel())


def functionals(count: int, nodes: Integers, weights: Array, direction: Array) -> csc_array:
    """Displacements in given directions as columns (3 count, m); as loads, unit forces in these directions.

    Each is a sum over nodes (m, q) by shares (m, q), in one direction (m, 3) or one for every share (m, q, 3).
    """
    from scipy.sparse import csc_array

    direction = np.broadcast_to(direction[:, None] if direction.ndim == 2 else direction, (*nodes.shape, 3))
    rows = 3 * nodes[..., None] + np.arange(3)
    columns = np.broadcast_to(np.arange(len(nodes))[:, None, None], rows.shape)
    values = weights[..., None] * direction
    return csc_array((values.ravel(), (rows.ravel(), columns.ravel())), shape=(3 * count, len(nodes)))


def elastic_body(
    nodes: Array, cells: Integers, fixed: Integers, material: Material, *, functions: ShapeFunctions = shape_functions
) -> Substructures:
    """Assemble and factor a body of bricks with some nodes held."""
    return substructures(cells, *brick_stiffness(nodes, cells, material, functions), fixed)
