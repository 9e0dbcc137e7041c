"""A body of bricks in substructures, each condensed to its border: direct solution by small full matrices.

The bricks are halved again and again, each time where the halves share few nodes (nested dissection, A. George 1973,
doi:10.1137/0710032). Then the halves are joined: a node that no other brick has is eliminated by Cholesky's method, and
what remains is the stiffness of the larger piece against its border.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....core.checks import frozen_arrays
from ....core.errors import GeometryError

Array = NDArray[Any]
Integers = NDArray[np.int64]
BRICKS_PER_LEAF = 8  # of the smallest piece, whose bricks are joined at once
SMALLER_HALF_MINIMUM = 0.4  # share of a piece's bricks, where its lattice allows it
NO_NODES = np.empty(0, dtype=np.int64)


@frozen_arrays
@dataclass(frozen=True)
class Elimination:
    """Displacements that were eliminated when pieces were joined.

    Parameters
    ----------
    inner, border
        Those eliminated (n), and those of the border (m).
    factor
        Cholesky factor L (n, n) of the stiffness of the inner ones, lower.
    coupling
        L^-1 times the stiffness between inner ones and border (n, m).
    """

    inner: Integers
    border: Integers
    factor: Array
    coupling: Array


@frozen_arrays
@dataclass(frozen=True)
class Substructures:
    """A factored body of bricks.

    Parameters
    ----------
    kept
        Nodes (k) that were not eliminated.
    stiffness
        Of the body against the displacements of these (3 k, 3 k) [N/mm].
    eliminations
        In the order in which displacements were eliminated.
    """

    kept: Integers
    stiffness: Array
    eliminations: tuple[Elimination, ...]

    @property
    def unknowns(self) -> int:
        """Number of displacements that were eliminated."""
        return sum(step.inner.size for step in self.eliminations)

    def solve(self, loads: Array) -> Array:
        """Displacements (3 n, c) [mm] under loads (3 n, c) [N], with the kept nodes held."""
        from scipy.linalg import solve_triangular

        waiting, found = np.array(loads, dtype=float), np.zeros(np.shape(loads))
        for step in self.eliminations:
            moved = waiting[step.inner]
            if not moved.any():
                continue  # no load has come here
            moved = solve_triangular(step.factor, moved, lower=True, check_finite=False)
            waiting[step.inner] = moved
            waiting[step.border] -= step.coupling.T @ moved
        for step in reversed(self.eliminations):
            moved = waiting[step.inner] - step.coupling @ found[step.border]
            found[step.inner] = solve_triangular(step.factor, moved, trans=1, lower=True, check_finite=False)
        return found


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
    cells: Integers, nodes: Integers, stiffness: Array, held: Integers, kept: Integers = NO_NODES
) -> Substructures:
    """Factor a body of bricks.

    Parameters
    ----------
    cells
        Nodes (m, 3, 3, 3) of every brick.
    nodes
        Those (m, q) of its shape functions.
    stiffness
        Of every brick (m, 3 q, 3 q) [N/mm], x y z of a node together.
    held
        Nodes that do not move.
    kept
        Nodes (k) that are not eliminated, in any order.

    Raises
    ------
    GeometryError
        If held and kept nodes leave a part of the body free to move.

    Examples
    --------
    Two bricks of 1 mm, held at one end and pulled at the other; without contraction a bar.

    >>> from easeoff.contact import Material
    >>> from easeoff.contact.compliance.finite_elements.bricks import brick_stiffness
    >>> points = np.stack(np.meshgrid(*(0.5 * np.arange(n) for n in (5, 3, 3)), indexing="ij"), axis=-1)
    >>> numbers = np.arange(45).reshape(5, 3, 3)
    >>> cells = np.stack([numbers[:3], numbers[2:]])
    >>> nodes, stiffness = brick_stiffness(points.reshape(-1, 3), cells, Material(200000.0, 0.0))
    >>> body = substructures(cells, nodes, stiffness, held=numbers[0].ravel())
    >>> pull = np.zeros((5, 3, 3, 3))
    >>> pull[-1, ..., 0] = np.outer([1, 4, 1], [1, 4, 1]) / 36
    >>> print(f"{body.solve(pull.reshape(-1, 1)).max():.3g}")
    1e-05
    """
    fate = np.zeros(max(nodes.max(), cells.max()) + 1, dtype=np.int64)
    fate[held] = -1
    fate[kept] = 1
    counts = np.bincount(nodes.ravel(), minlength=fate.size)
    counts[kept] += 1  # a brick that never comes: they are not eliminated
    bricks = _Bricks(np.where(fate[nodes] < 0, -1, nodes), stiffness, lattice_places(cells), counts)
    eliminations: list[Elimination] = []
    whole = _condensed(bricks, np.arange(len(nodes)), eliminations)
    order = displacements(np.searchsorted(whole.nodes, kept))
    return Substructures(kept, whole.stiffness[np.ix_(order, order)], tuple(eliminations))


def lattice_places(cells: Integers) -> Integers:
    """Places (m, 3) of bricks (m, 3, 3, 3), counted along their own axes from neighbour to neighbour.

    Neighbours have the node in the middle of a face in common.
    """
    middles = np.stack([cells[:, 0, 1, 1], cells[:, 1, 0, 1], cells[:, 1, 1, 0]])
    middles = np.stack([middles, np.stack([cells[:, 2, 1, 1], cells[:, 1, 2, 1], cells[:, 1, 1, 2]])])  # (end, axis, m)
    order = np.argsort(middles, axis=None, kind="stable")
    shared = np.flatnonzero(np.diff(middles.ravel()[order]) == 0)
    pairs = np.stack([order[shared], order[shared + 1]])
    (end, axis, one), other = np.unravel_index(pairs[0], middles.shape), pairs[1] % len(cells)
    step = np.where(end == 1, 1, -1)[:, None] * np.eye(3, dtype=np.int64)[axis]
    one, other, step = np.concatenate([one, other]), np.concatenate([other, one]), np.concatenate([step, -step])
    places, found = np.zeros((len(cells), 3), dtype=np.int64), np.zeros(len(cells), dtype=bool)
    while not found.all():
        found[np.argmin(found)] = True  # the first brick of a part that hangs together with none before
        while (new := found[one] & ~found[other]).any():
            places[other[new]] = places[one[new]] + step[new]
            found[other[new]] = True
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
    here = np.zeros(nodes.size, dtype=np.int64)
    np.add.at(here, places, np.concatenate([part.brick_counts for part in parts]))
    done = here == counts[nodes]
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
    return _Piece(border, here[~done], whole[split:, split:] - coupling.T @ coupling)


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
