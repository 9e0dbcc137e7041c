"""Reads meshes by the definitions of their formats: binary STL, legacy VTK and the XML of VTK."""

from __future__ import annotations

import base64
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import unquote
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

QUADRILATERAL = 9  # VTK_QUAD


@dataclass
class Mesh:
    """Points (n, 3), corners of the cells (c, 3 or 4), values (c) by name."""

    points: Array
    cells: Array
    data: dict[str, Array] = field(default_factory=dict)


def read_mesh(path: Path) -> Mesh:
    return {".stl": read_stl, ".vtk": read_vtk, ".vtu": read_vtu}[path.suffix](path.read_bytes())


def read_stl(content: bytes) -> Mesh:
    """80 bytes of title, the number of triangles, and 50 bytes each: normal, three corners, two bytes more."""
    assert not content.startswith(b"solid")  # the sign of the format in text
    (count,) = np.frombuffer(content, "<u4", 1, 80)
    assert len(content) == 84 + 50 * count
    numbers = (
        np.frombuffer(content, np.uint8, offset=84).reshape(count, 50)[:, :48].copy().view("<f4").reshape(-1, 4, 3)
    )
    corners = numbers[:, 1:]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    np.testing.assert_allclose(numbers[:, 0], normal, atol=1e-3)
    points, cells = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    return Mesh(points, cells.reshape(-1, 3))


def read_vtk(content: bytes) -> Mesh:
    """Four lines of head, then keywords in lines of text, each followed by its numbers, big-endian."""
    position = 0

    def line() -> list[str]:
        nonlocal position
        end = content.index(b"\n", position)
        text, position = content[position:end].decode(), end + 1
        return text.split()

    def numbers(kind: str, count: int) -> Array:
        nonlocal position
        found = np.frombuffer(content, kind, count, position)
        position += found.nbytes
        assert line() == []
        return found

    assert content.startswith(b"# vtk DataFile Version 4.2\n")
    line(), line()
    assert (line(), line()) == (["BINARY"], ["DATASET", "UNSTRUCTURED_GRID"])
    keyword, count, kind = line()
    assert (keyword, kind) == ("POINTS", "double")
    points = numbers(">f8", 3 * int(count)).reshape(-1, 3)
    keyword, count, size = line()
    assert (keyword, int(size)) == ("CELLS", 5 * int(count))
    cells = numbers(">i4", int(size)).reshape(-1, 5)
    assert np.all(cells[:, 0] == 4)
    assert line() == ["CELL_TYPES", count]
    assert np.all(numbers(">i4", int(count)) == QUADRILATERAL)
    assert line() == ["CELL_DATA", count]
    *keywords, fields = line()
    assert keywords == ["FIELD", "FieldData"]
    data = {}
    for _ in range(int(fields)):
        name, *shape = line()
        assert shape == ["1", count, "int"]
        data[unquote(name)] = numbers(">i4", int(count))
    assert position == len(content)
    return Mesh(points, cells[:, 1:], data)


def read_vtu(content: bytes) -> Mesh:
    """Arrays in base 64: a head of 32-bit numbers, then the blocks that it counts, compressed."""
    root = ElementTree.fromstring(content)
    assert root.attrib["byte_order"] == "LittleEndian"
    assert root.attrib["compressor"] == "vtkZLibDataCompressor"
    assert "header_type" not in root.attrib  # hence UInt32
    (piece,) = root.findall("UnstructuredGrid/Piece")

    def arrays(group: str) -> dict[str, Array]:
        found = {}
        for element in piece.findall(f"{group}/DataArray"):
            text = element.text or ""
            (blocks,) = np.frombuffer(base64.b64decode(text[:8]), "<u4", 1)
            length = 4 * -(-(4 * (3 + int(blocks))) // 3)
            _, whole, last, *packed = np.frombuffer(base64.b64decode(text[:length]), "<u4", 3 + int(blocks)).tolist()
            rest, plain = base64.b64decode(text[length:]), b""
            for size in packed:
                plain, rest = plain + zlib.decompress(rest[:size]), rest[size:]
            assert len(plain) == (len(packed) - 1) * whole + last
            kind = {"Float64": "<f8", "Int64": "<i8", "Int32": "<i4", "UInt8": "u1"}[element.attrib["type"]]
            width = int(element.attrib.get("NumberOfComponents", 1))
            values = np.frombuffer(plain, kind)
            found[element.attrib["Name"]] = values if width == 1 else values.reshape(-1, width)
        return found

    points, cells = arrays("Points")["Points"], arrays("Cells")
    assert len(points) == int(piece.attrib["NumberOfPoints"])
    assert len(cells["types"]) == int(piece.attrib["NumberOfCells"])
    assert np.all(cells["types"] == QUADRILATERAL)
    np.testing.assert_array_equal(cells["offsets"], 4 * np.arange(1, len(cells["types"]) + 1))
    return Mesh(points, cells["connectivity"].reshape(-1, 4), arrays("CellData"))
