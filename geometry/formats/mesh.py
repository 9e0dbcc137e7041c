"""Surface patches as meshes: triangles in STL, quadrilaterals with their patch and tooth in VTK."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import file_path
from ...core.errors import InputError
from ...core.writing.output_file import whole_file
from ..vectors import rotate_z
from .mesh_file import stl_file, vtk_file, vtu_file
from .patches import merged, oriented, rotations

Array = NDArray[Any]

SUFFIXES = (".stl", ".vtk", ".vtu")


def write_mesh(
    patches: Mapping[str, Array], path: str | os.PathLike[str], *, teeth: int = 1, pitch: float | None = None
) -> None:
    """Write the patches of a tooth as a mesh; the nodes of the patches are those of the mesh.

    Parameters
    ----------
    patches
        Points (m, n, 3) [mm] by name, see ``patches``; the first one of every connected group looks outwards.
    path
        ``.stl`` (triangles, single precision), ``.vtk`` or ``.vtu`` (quadrilaterals with the cell data ``patch`` and
        ``tooth``, counted from 0, and one of 0 and 1 under the name of every patch). It appears complete or not at all.
    teeth
        Number of copies of the tooth, about the z axis.
    pitch
        Angle between them [rad]; ``None`` to spread them over the whole turn.

    Raises
    ------
    InputError
        If a patch is no grid of points, the suffix is another one, or the file cannot be written.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import tooth_patches
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> with TemporaryDirectory() as folder:
    ...     write_mesh(tooth_patches(pair, "gear", (5, 5)), f"{folder}/gear.stl", teeth=36)
    ...     Path(f"{folder}/gear.stl").stat().st_size > 0
    True
    """
    suffix = file_path("path", path).suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(f"{path}: meshes are written as {', '.join(SUFFIXES)}")
    points, quads, patch, tooth = mesh(oriented(patches), rotations(teeth, pitch))
    if suffix == ".stl":
        content = stl_file(points, triangles(points, quads))
    else:
        data = {"patch": patch, "tooth": tooth}
        data |= {name: (patch == index).astype(np.int32) for index, name in enumerate(patches)}
        content = (vtk_file if suffix == ".vtk" else vtu_file)(points, quads, data)
    with whole_file(path) as temporary:
        temporary.write_bytes(content)


def mesh(patches: Mapping[str, Array], angles: Array) -> tuple[Array, Array, Array, Array]:
    """Nodes and quadrilaterals of a tooth and its copies.

    Parameters
    ----------
    patches
        Oriented patches by name.
    angles
        Rotations of the copies about the z axis (k) [rad].

    Returns
    -------
    tuple
        Points (n, 3), each once; corners of the quadrilaterals (c, 4), anticlockwise seen from outside; number of
        patch (c) and of tooth (c).
    """
    quads, numbers, start = [], [], 0
    for index, array in enumerate(patches.values()):
        m, n = array.shape[:2]
        node = start + np.arange(m * n).reshape(m, n)
        corners = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], axis=-1).reshape(-1, 4)
        quads.append(corners)
        numbers.append(np.full(len(corners), index, dtype=np.int32))
        start += m * n
    points = np.concatenate([array.reshape(-1, 3) for array in patches.values()])
    copies = np.concatenate([rotate_z(np.full(start, angle), points.T).T for angle in angles])
    one = np.concatenate(quads)
    every = np.concatenate([one + copy * start for copy in range(angles.size)])
    nodes, number = merged(copies)
    tooth = np.repeat(np.arange(angles.size, dtype=np.int32), len(one))
    return nodes, number[every], np.tile(np.concatenate(numbers), angles.size), tooth


def triangles(points: Array, quads: Array) -> Array:
    """Each quadrilateral (c, 4) as two triangles, cut along its shorter diagonal; those without area are left out."""
    a, b, c, d = quads.T
    shorter = np.linalg.norm(points[a] - points[c], axis=1) <= np.linalg.norm(points[b] - points[d], axis=1)
    first = np.where(shorter, np.stack([a, b, c]), np.stack([a, b, d]))
    second = np.where(shorter, np.stack([a, c, d]), np.stack([b, c, d]))
    both = np.stack([first, second], axis=0).transpose(2, 0, 1).reshape(-1, 3)
    different = (both[:, 0] != both[:, 1]) & (both[:, 1] != both[:, 2]) & (both[:, 2] != both[:, 0])
    return np.asarray(both[different])
