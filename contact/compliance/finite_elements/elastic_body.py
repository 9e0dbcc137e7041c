"""Finite elements of a tooth on its body, factored once for the response to any loads."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..material import Material
from .bricks import ShapeFunctions, shape_functions, stiffness
from .stiffness_factor import Factoriser, solve_in_parts, solver_of

if TYPE_CHECKING:
    from scipy.sparse import csc_array

Array = NDArray[Any]


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
    free
        Displacements that can move.
    solve
        Solutions of the stiffness matrix of the free displacements.
    """

    nodes: Array
    cells: NDArray[np.int64]
    free: NDArray[np.int64]
    solve: Callable[[Array], Array]

    def response(self, loads: csc_array, wanted: csc_array) -> Array:
        """Values (m, k) of the wanted functionals (3 n, m) of the displacements under loads (3 n, k)."""
        return solve_in_parts(self.solve, loads.tocsr()[self.free].tocsc(), wanted.tocsr()[self.free].tocsc())


def elastic_body(
    nodes: Array,
    cells: NDArray[np.int64],
    held: NDArray[np.int64],
    material: Material,
    *,
    functions: ShapeFunctions = shape_functions,
    factoriser: Factoriser = "auto",
) -> ElasticBody:
    """Assemble and factor.

    Parameters
    ----------
    nodes, cells
        The bricks, as ``bricks.stiffness``.
    held
        Nodes that do not move.
    material
        The material.
    functions
        Shape functions of a brick.
    factoriser
        As ``stiffness_factor.solver_of``.

    Raises
    ------
    GeometryError
        If a brick is turned inside out.
    MissingPackageError
        As ``stiffness_factor.solver_of``.
    """
    matrix = stiffness(nodes, cells, material, functions)
    movable = matrix.diagonal() > 0.0  # nodes that no brick uses stay where they are
    movable[(3 * held[:, None] + np.arange(3)).ravel()] = False
    free = np.flatnonzero(movable)
    return ElasticBody(nodes, cells, free, solver_of(matrix[free][:, free], factoriser))
