"""Finite elements of a tooth on its body, factored once for the response to any loads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..material import Material
from .bricks import ShapeFunctions, brick_stiffness, shape_functions
from .substructures import Substructures, substructures

if TYPE_CHECKING:
    from scipy.sparse import csc_array

Array = NDArray[Any]
COLUMNS_PER_SOLVE = 128  # loads; bounds the memory


def functionals(count: int, nodes: NDArray[np.int64], weights: Array, direction: Array) -> csc_array:
    """Displacements in given directions as columns (3 count, m); as loads, unit forces in these directions.

    Parameters
    ----------
    count
        Nodes of the body.
    nodes
        Nodes (m, q) that share in each of them.
    weights
        Their shares (m, q).
    direction
        Directions (m, 3), or one for every share (m, q, 3).
    """
    from scipy.sparse import csc_array

    direction = np.broadcast_to(direction[:, None] if direction.ndim == 2 else direction, (*nodes.shape, 3))
    rows = 3 * nodes[..., None] + np.arange(3)
    columns = np.broadcast_to(np.arange(len(nodes))[:, None, None], rows.shape)
    values = weights[..., None] * direction
    return csc_array((values.ravel(), (rows.ravel(), columns.ravel())), shape=(3 * count, len(nodes)))


@dataclass(frozen=True)
class ElasticBody:
    """Factored body of bricks with some nodes held.

    Parameters
    ----------
    nodes
        Points (n, 3) [mm].
    cells
        Nodes (m, 3, 3, 3) of every brick.
    parts
        The body in substructures.
    """

    nodes: Array
    cells: NDArray[np.int64]
    parts: Substructures

    def solve(self, loads: Array) -> Array:
        """Displacements (3 n, c) [mm] under loads (3 n, c) [N]; zero where nodes are held."""
        return self.parts.solve(loads)

    def response(self, loads: csc_array, wanted: csc_array) -> Array:
        """Values (m, k) of the wanted functionals (3 n, m) of the displacements under loads (3 n, k)."""
        values, count = wanted.T.tocsr(), loads.shape[1]
        starts = range(0, count, COLUMNS_PER_SOLVE)
        batches = (loads[:, start : start + COLUMNS_PER_SOLVE].toarray() for start in starts)
        return np.concatenate([values @ self.solve(batch) for batch in batches], axis=1)


def elastic_body(
    nodes: Array,
    cells: NDArray[np.int64],
    held: NDArray[np.int64],
    material: Material,
    *,
    functions: ShapeFunctions = shape_functions,
) -> ElasticBody:
    """Assemble and factor.

    Parameters
    ----------
    nodes, cells, material, functions
        As ``bricks.brick_stiffness``.
    held
        Nodes that do not move.

    Raises
    ------
    GeometryError
        If a brick is turned inside out, or the held nodes leave a part of the body free to move.
    """
    return ElasticBody(nodes, cells, substructures(cells, *brick_stiffness(nodes, cells, material, functions), held))
