"""Mesh of quadrilaterals with data at points and cells, gathered part by part."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


class QuadMesh:
    """Quadrilaterals with their data.

    Parameters
    ----------
    point_names
        Names of the values at points.
    labels
        Names of the integers of every cell.
    cell_names
        Names of the values of cells.

    Examples
    --------
    >>> mesh = QuadMesh(["gap"], ["part"], ["force"])
    >>> mesh.add_grid(np.zeros((3, 2, 3)), {"gap": np.ones((3, 2))}, [0])
    >>> mesh.add_strips(np.zeros((1, 4, 3)), {"force": np.array([5.0])}, [1])
    >>> points, quads, cell_data, point_data = mesh.content()
    >>> quads.tolist(), cell_data["force"].tolist()
    ([[0, 2, 3, 1], [2, 4, 5, 3], [6, 7, 8, 9]], [nan, nan, 5.0])
    """

    def __init__(self, point_names: Sequence[str], labels: Sequence[str], cell_names: Sequence[str]) -> None:
        self.labels, self.cell_names = tuple(labels), tuple(cell_names)
        self._points: list[Array] = []
        self._quads: list[Array] = []
        self._point_data: dict[str, list[Array]] = {name: [] for name in point_names}
        self._cell_data: dict[str, list[Array]] = {name: [] for name in (*labels, *cell_names)}
        self._count = 0

    def add_grid(self, points: Array, fields: Mapping[str, Array], labels: Sequence[int]) -> None:
        """Add a grid of points (m, n, 3) with values (m, n) by name; those that are missing are NaN."""
        node = np.arange(points.shape[0] * points.shape[1]).reshape(points.shape[:2])
        quads = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], axis=-1).reshape(-1, 4)
        self._add(points.reshape(-1, 3), quads, fields, {}, labels)

    def add_strips(self, corners: Array, values: Mapping[str, Array], labels: Sequence[int]) -> None:
        """Add separate cells with their corners (k, 4, 3) and values (k) by name; those that are missing are NaN."""
        self._add(corners.reshape(-1, 3), np.arange(4 * len(corners)).reshape(-1, 4), {}, values, labels)

    def _add(
        self,
        points: Array,
        quads: Array,
        fields: Mapping[str, Array],
        values: Mapping[str, Array],
        labels: Sequence[int],
    ) -> None:
        self._points.append(points)
        self._quads.append(quads + self._count)
        self._count += len(points)
        for name, kept in self._point_data.items():
            kept.append(fields[name].ravel() if name in fields else np.full(len(points), np.nan))
        for name, label in zip(self.labels, labels, strict=True):
            self._cell_data[name].append(np.full(len(quads), label, dtype=np.int32))
        for name in self.cell_names:
            self._cell_data[name].append(values[name] if name in values else np.full(len(quads), np.nan))

    def content(self) -> tuple[Array, Array, dict[str, Array], dict[str, Array]]:
        """Points (n, 3), corners of the cells (c, 4), and data by name of cells and of points."""
        cells, points = (
            {name: np.concatenate(kept) for name, kept in data.items()} for data in (self._cell_data, self._point_data)
        )
        return np.concatenate(self._points), np.concatenate(self._quads), cells, points
