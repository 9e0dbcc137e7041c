"""Files of meshes: triangles in binary STL, quadrilaterals with data in legacy VTK and in the XML of VTK."""

from __future__ import annotations

import zlib
from base64 import b64encode
from collections.abc import Mapping
from typing import Any
from urllib.parse import quote
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

TITLE = "Surface mesh in mm, written by easeoff"
QUADRILATERAL = 9  # number of this kind of cell in VTK
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
VTK_TYPES = {"f8": "Float64", "i8": "Int64", "i4": "Int32", "u1": "UInt8"}


def stl_file(points: Array, triangles: Array) -> bytes:
    """Binary STL, single precision.

    Parameters
    ----------
    points
        Points (n, 3) [mm].
    triangles
        Corners (c, 3), anticlockwise seen from outside.
    """
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    records = np.zeros(len(triangles), dtype=TRIANGLE)
    records["normal"] = (normals.T / np.sqrt(np.einsum("ij,ij->i", normals, normals))).T
    records["corners"] = corners
    return TITLE.ljust(80).encode() + np.array(len(records), dtype="<u4").tobytes() + records.tobytes()


def vtk_file(points: Array, quads: Array, cell_data: Mapping[str, Array]) -> bytes:
    """Legacy VTK 4.2, which every reader of VTK files knows, in binary.

    Parameters
    ----------
    points
        Points (n, 3) [mm].
    quads
        Corners of the quadrilaterals (c, 4).
    cell_data
        Values (c) by name.
    """
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
    """Unstructured grid in the XML of VTK, compressed.

    Parameters
    ----------
    points, quads, cell_data
        As of ``vtk_file``.
    point_data
        Values (n) at the points by name.
    """
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
