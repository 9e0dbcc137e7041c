"""Surface patches as meshes: triangles in STL, quadrilaterals with their patch and tooth in VTK.

Files of meshes: triangles in binary STL, quadrilaterals with data in legacy VTK and in the XML of VTK.
"""

from __future__ import annotations

import os
import zlib
from base64 import b64encode
from collections.abc import Mapping
from urllib.parse import quote
from xml.etree import ElementTree

import numpy as np

from ...core.arrays import Array
from ...core.checks import file_path
from ...core.errors import InputError
from ...core.output_file import whole_file
from ..vectors import rotate_z
from .step import merged, oriented, rotations

TITLE = "Surface mesh in mm, written by easeoff"
QUADRILATERAL = 9  # number of this kind of cell in VTK
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
VTK_TYPES = {"f8": "Float64", "i8": "Int64", "i4": "Int32", "u1": "UInt8"}


def stl_file(points: Array, triangles: Array) -> bytes:
    """Binary STL, single precision, of points (n, 3) [mm] and corners (c, 3), anticlockwise seen from outside."""
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    records = np.zeros(len(triangles), dtype=TRIANGLE)
    records["normal"] = (normals.T / np.sqrt(np.einsum("ij,ij->i", normals, normals))).T
    records["corners"] = corners
    return TITLE.ljust(80).encode() + np.array(len(records), dtype="<u4").tobytes() + records.tobytes()


def vtk_file(points: Array, quads: Array, cell_data: Mapping[str, Array]) -> bytes:
    """Legacy VTK 4.2, which every reader knows, in binary: points (n, 3) [mm], corners (c, 4), values (c) by name."""
    count = len(quads)
    parts: list[str | Array] = [
        f"# vtk DataFile Version 4.2\n{TITLE}\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS {len(points)} double\n",
        points.astype(">f8"),
        f"\nCELLS {count} {5 * count}\n",
        np.insert(quads, 0, 4, axis=1).astype(">i4"),  # each with its number of corners
        f"\nCELL_TYPES {count}\n",
        np.full(count, QUADRILATERAL, dtype=">i4"),
        f"\nCELL_DATA {count}\nFIELD FieldData {len(cell_data)}\n",
    ]
    for name, values in cell_data.items():
        parts += [f"{quote(name)} 1 {count} int\n", values.astype(">i4"), "\n"]
    return b"".join(part.encode() if isinstance(part, str) else part.tobytes() for part in parts)


def vtu_file(
    points: Array, quads: Array, cell_data: Mapping[str, Array], point_data: Mapping[str, Array] | None = None
) -> bytes:
    """Unstructured grid in the XML of VTK, compressed: as ``vtk_file``, and values (n) at the points by name."""
    root = ElementTree.Element(
        "VTKFile", type="UnstructuredGrid", version="0.1", byte_order="LittleEndian", compressor="vtkZLibDataCompressor"
    )
    root.append(ElementTree.Comment(f" {TITLE} "))
    grid = ElementTree.SubElement(root, "UnstructuredGrid")
    piece = ElementTree.SubElement(grid, "Piece", NumberOfPoints=f"{len(points)}", NumberOfCells=f"{len(quads)}")
    cells = {
        "connectivity": quads.ravel(),
        "offsets": 4 * np.arange(1, len(quads) + 1),
        "types": np.full(len(quads), QUADRILATERAL, dtype=np.uint8),
    }
    groups = {"Points": {"Points": points}, "Cells": cells, "CellData": cell_data}
    for group, arrays in (groups | ({"PointData": point_data} if point_data else {})).items():
        parent = ElementTree.SubElement(piece, group)
        for name, values in arrays.items():
            _add_array(parent, name, values)
    content: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return content


def _add_array(parent: ElementTree.Element, name: str, values: Array) -> None:
    """One block, compressed; before it the number of blocks, the size of all but the last, of the last, and packed."""
    kind = f"{values.dtype.kind}{values.dtype.itemsize}"
    element = ElementTree.SubElement(parent, "DataArray", type=VTK_TYPES[kind], Name=name, format="binary")
    if values.ndim == 2:
        element.set("NumberOfComponents", f"{values.shape[1]}")
    plain = values.astype(f"<{kind}").tobytes()
    packed = zlib.compress(plain)
    head = np.array([1, len(plain), len(plain), len(packed)], dtype="<u4").tobytes()
    element.text = (b64encode(head) + b64encode(packed)).decode()


SUFFIXES = (".stl", ".vtk", ".vtu")


def write_mesh(
    patches: Mapping[str, Array], path: str | os.PathLike[str], *, teeth: int = 1, pitch: float | None = None
) -> None:
    """Write the patches of a tooth as a mesh; the nodes of the patches are those of the mesh.

    Parameters
    ----------
    patches
        Points (m, n, 3) [mm] by name, see ``step``; the first one of every connected group looks outwards.
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
    """Points (n, 3), corners (c, 4), and numbers of patch (c) and tooth (c) of oriented patches and their copies.

    Copies stand at angles (k) [rad] about z; each point comes once, corners anticlockwise seen from outside.
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
    return np.asarray(both[np.all(both != np.roll(both, 1, axis=1), axis=1)])
