"""Quadratic bricks: shape functions, and the stiffness of all bricks at once.

The stiffness of an isotropic brick needs one sum over the Gauss points only, H = sum of w (grad N)(grad N)^T; both
Lame terms and the Laplacian are entries of H in another order. That makes the assembly one matrix product a brick.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....core.errors import GeometryError
from ..material import Material

if TYPE_CHECKING:
    from scipy.sparse import csc_array

Array = NDArray[Any]
GAUSS_POINTS = 3  # in each direction: exact for a brick with straight edges
BRICKS_PER_BATCH = 32  # as many as fit into a processor's cache
ShapeFunctions = Callable[[Array], tuple[Array, Array]]


def quadratic(x: Array) -> tuple[Array, Array]:
    """Values and slopes (..., 3) of the parabolas through -1, 0, 1."""
    x = np.asarray(x, dtype=float)
    values = np.stack([0.5 * x * (x - 1.0), 1.0 - x * x, 0.5 * x * (x + 1.0)], axis=-1)
    return values, np.stack([x - 0.5, -2.0 * x, x + 0.5], axis=-1)


def shape_functions(points: Array) -> tuple[Array, Array]:
    """Shape functions (n, 27) and their gradients (n, 27, 3) at points (n, 3) of the cube from -1 to 1.

    Nodes are in the order of an array (3, 3, 3).
    """
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


def require_right_way_round(nodes: Array, cells: NDArray[np.int64]) -> None:
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
    nodes: Array, cells: NDArray[np.int64], material: Material, functions: ShapeFunctions = shape_functions
) -> tuple[NDArray[np.int64], Array]:
    """Stiffness of every brick.

    Parameters
    ----------
    nodes
        Points (n, 3) [mm].
    cells
        Nodes (m, 3, 3, 3) of every brick.
    material
        Its material.
    functions
        Shape functions of a brick.

    Returns
    -------
    tuple
        Nodes (m, q) that have shape functions, and stiffness (m, 3 q, 3 q) [N/mm], x y z of a node together.

    Raises
    ------
    GeometryError
        If a brick is turned inside out somewhere.
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
    nodes: Array, cells: NDArray[np.int64], material: Material, functions: ShapeFunctions = shape_functions
) -> csc_array:
    """Stiffness matrix of a body of bricks: symmetric (3 n, 3 n) [N/mm], x y z of a node together.

    Arguments and errors as ``brick_stiffness``; a node without a shape function gets rows of zeros.
    """
    from scipy.sparse import csc_array

    of_bricks, entries = brick_stiffness(nodes, cells, material, functions)
    displacements = (3 * of_bricks[:, :, None] + np.arange(3)).reshape(len(of_bricks), -1).astype(np.int32)
    rows = np.broadcast_to(displacements[:, :, None], entries.shape).ravel()
    columns = np.broadcast_to(displacements[:, None, :], entries.shape).ravel()
    return csc_array((entries.ravel(), (rows, columns)), shape=(3 * len(nodes), 3 * len(nodes)))
