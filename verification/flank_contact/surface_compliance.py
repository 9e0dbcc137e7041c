"""Compliance of a loaded surface with itself, the indentation included.

The displacement under a point force has no limit, and bricks of some millimetres know nothing of it. It is known in
closed form, though: near the force the body is a half space. The finite elements solve for the rest alone. With the
half space's field u* in the bricks around the loaded surface, and its values at their nodes b,

    u = v + u* - (interpolation of b),       K v = K_near b - (tractions of u* on the surface of these bricks),

for any value of b at the loaded node itself. On the loaded surface u* has hardly any traction, on all others it is
smooth. At every other node u = v; at the loaded one, with b = 0 there, v is what the body adds to its half space.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array

from ...contact.compliance.finite_elements.bricks import quadratic, stiffness
from ...contact.compliance.finite_elements.elastic_body import COLUMNS_PER_SOLVE, elastic_body
from ...contact.compliance.material import Material
from .half_space import point_force_displacement, point_force_traction

Array = NDArray[Any]
FACE_GAUSS_POINTS = 6  # points in each direction of a face; an even number, which leaves its middle node out
RAY_CLEARANCE_LIMIT = 0.3  # (rho + z) / rho of bricks that take part in the field; less is near its singular ray
LOAD_DISTANCE_LIMIT = 0.02  # [mm]


def surface_compliance(
    nodes: Array,
    cells: NDArray[np.int64],
    held: NDArray[np.int64],
    material: Material,
    loaded: NDArray[np.int64],
    normal: Array,
) -> Array:
    """Normal displacements of a smooth surface under normal forces on it.

    Parameters
    ----------
    nodes, cells
        The bricks, as ``bricks.stiffness``.
    held
        Nodes that do not move.
    material
        The material.
    loaded
        Nodes (k) of the surface, none of them on its edge.
    normal
        Outward unit normals (k, 3) there.

    Returns
    -------
    Array
        (k, k) [mm/N]: displacement into the body of a node by a force into the body at another. On the diagonal what
        the body adds to the displacement of its half space.

    Raises
    ------
    GeometryError
        If a brick is turned inside out.
    """
    body = elastic_body(nodes, cells, held, material)
    near = _near(nodes, cells, loaded, normal)
    field_matrix = stiffness(nodes, near, material).tocsr()
    points, weighted_normals, onto_nodes = _faces(nodes, near)
    area = np.linalg.norm(weighted_normals, axis=1, keepdims=True)
    direction = weighted_normals / area
    inside = np.unique(near)
    result = np.empty((loaded.size, loaded.size))
    for start in range(0, loaded.size, COLUMNS_PER_SOLVE):
        part = slice(start, min(start + COLUMNS_PER_SOLVE, loaded.size))
        count = part.stop - start
        known = np.zeros((len(nodes), 3, count))
        loads = np.zeros((3 * len(nodes), count))
        for k in range(count):
            node, inward = loaded[start + k], -normal[start + k]
            others = inside[inside != node]
            known[others, :, k] = point_force_displacement(nodes[others] - nodes[node], inward, material)
            offset = points - nodes[node]
            with np.errstate(divide="ignore", invalid="ignore"):
                traction = area * point_force_traction(offset, inward, direction, material.poisson_ratio)
            traction[np.linalg.norm(offset, axis=1) < LOAD_DISTANCE_LIMIT] = 0.0
            loads[:, k] = (onto_nodes @ traction).ravel()
        answer = body.solve(np.asarray(field_matrix @ known.reshape(-1, count) - loads))
        at_loaded = answer.reshape(len(nodes), 3, count)[loaded]
        result[:, part] = -np.einsum("mx,mxk->mk", normal, at_loaded)
    return result


def _near(nodes: Array, cells: NDArray[np.int64], loaded: NDArray[np.int64], normal: Array) -> NDArray[np.int64]:
    """Bricks that stay clear of the singular rays of all forces."""
    middles = nodes[cells[:, 1, 1, 1]]
    clear = np.ones(len(cells), dtype=bool)
    for node, outward in zip(loaded, normal, strict=True):
        offset = middles - nodes[node]
        clear &= 1.0 - offset @ outward / np.linalg.norm(offset, axis=1) > RAY_CLEARANCE_LIMIT
    return cells[clear]


def _faces(nodes: Array, cells: NDArray[np.int64]) -> tuple[Array, Array, csc_array]:
    """Surface of bricks: quadrature points (q, 3), outward normals times weights, and their shares in the nodes."""
    sides = [(np.take(cells, end, axis=1 + axis).reshape(-1, 9), axis, end) for axis in range(3) for end in (0, 2)]
    all_faces = np.concatenate([face for face, _, _ in sides])
    inner = np.concatenate([cells[:, 1, 1, 1]] * 6)
    _, first, count = np.unique(np.sort(all_faces, axis=1), axis=0, return_index=True, return_counts=True)
    chosen = first[count == 1]
    faces, inner = all_faces[chosen], inner[chosen]
    x, w = np.polynomial.legendre.leggauss(FACE_GAUSS_POINTS)
    (value, slope), count_points = quadratic(x), FACE_GAUSS_POINTS**2
    shape = np.einsum("ia,jb->ijab", value, value).reshape(count_points, 9)
    along = [np.einsum("ia,jb->ijab", a, b).reshape(count_points, 9) for a, b in ((slope, value), (value, slope))]
    corners = nodes[faces]
    points = np.einsum("qa,fax->fqx", shape, corners)
    normal = np.cross(*(np.einsum("qa,fax->fqx", d, corners) for d in along))
    outward = np.sign(np.einsum("fqx,fqx->f", normal, points - nodes[inner][:, None]))
    normal *= outward[:, None, None] * np.outer(w, w).ravel()[:, None]
    rows = np.broadcast_to(faces[:, None, :], (len(faces), count_points, 9)).ravel()
    columns = np.repeat(np.arange(len(faces) * count_points), 9)
    shares = np.broadcast_to(shape, (len(faces), count_points, 9)).ravel()
    onto = csc_array((shares, (rows, columns)), shape=(len(nodes), len(faces) * count_points))
    return points.reshape(-1, 3), normal.reshape(-1, 3), onto
