"""Greatest contact pressure on the tooth over the mesh cycle, as a surface over the gear flank.

All tooth pairs are alike, and together their contact lines at the mesh positions of one cycle are the lines of one tooth's
passage through the mesh, one beside the other. Every point of the flank is passed by one line, once; the surface
through the pressures on the lines is therefore the envelope of the pressure over the cycle.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

Array = NDArray[Any]


@dataclass(frozen=True)
class PressureMap:
    """A surface of pressure in triangles.

    Parameters
    ----------
    points
        Fractions (2, n) on the gear flank: the middles of all segments, and the ends of their lines.
    pressure
        Pressure at the points (n) [MPa].
    triangles
        Corners (m, 3) of the triangles, between lines of neighbouring mesh positions.
    """

    points: Array
    pressure: Array
    triangles: NDArray[np.int64]

    @property
    def peak(self) -> float:
        """Greatest pressure [MPa]; NaN if there is none."""
        return float(np.max(self.pressure)) if self.pressure.size else float("nan")

    @property
    def peak_place(self) -> Array:
        """Fractions (2) of the greatest pressure."""
        return np.asarray(self.points[:, np.argmax(self.pressure)])


@dataclass(frozen=True)
class _Line:
    """A contact line with its pressures: segments (k) and both ends."""

    points: Array
    pressure: Array

    @property
    def middle(self) -> Array:
        return np.asarray(self.points.mean(axis=1))

    def turned(self) -> _Line:
        return _Line(self.points[:, ::-1], self.pressure[::-1])


def pressure_map(at_torque: xr.Dataset) -> PressureMap:
    """The pressure over the mesh cycle at one torque.

    Parameters
    ----------
    at_torque
        The group ``loaded`` at one torque: variables over (mesh_position, segment). Mesh positions without a certified
        solution are NaN and leave a gap in the surface.
    """
    positions = at_torque.sizes["mesh_position"]
    names = ("tooth", "lengthwise", "profile", "pressure", "length")
    table = np.stack([at_torque[name].transpose("mesh_position", "segment").values for name in names])
    steps: dict[int, list[_Line]] = {}
    for k in range(positions):
        for tooth, line in _lines(table[:, k]):
            steps.setdefault(k - tooth * positions, []).append(line)
    return _surface(steps)


def _lines(segments: Array) -> Iterator[tuple[int, _Line]]:
    """Tooth pair and contact lines of one mesh position, from rows tooth, lengthwise, profile, pressure, length."""
    segments = segments[:, np.all(np.isfinite(segments), axis=0)]
    tooth, length = segments[0], segments[4]
    # The segments of a line are equally long: another length is another line, even on the same tooth.
    new = (np.diff(tooth) != 0) | (np.abs(np.diff(length)) > 1e-9 * length[1:])
    for part in np.split(segments, np.flatnonzero(new) + 1, axis=1):
        if part.shape[1] == 0:
            continue
        points, pressure = part[1:3], part[3]
        # A segment's pressure is constant: it reaches to the end of the line, half a segment beyond the last middle.
        if part.shape[1] > 1:
            half = 0.5 * (points[:, [0, -1]] - points[:, [1, -2]])
            ends = np.clip(points[:, [0, -1]] + half, 0.0, 1.0)
            points = np.concatenate([ends[:, :1], points, ends[:, 1:]], axis=1)
            pressure = np.concatenate([pressure[:1], pressure, pressure[-1:]])
        yield int(part[0, 0]), _Line(points, pressure)


def _surface(steps: dict[int, list[_Line]]) -> PressureMap:
    """Triangles between the lines of neighbouring steps."""
    points: list[Array] = []
    pressure: list[Array] = []
    triangles: list[NDArray[np.int64]] = []
    count = 0
    before: list[tuple[_Line, int]] = []  # lines of the step before, and where their points start
    last = None
    for step in sorted(steps):
        here: list[tuple[_Line, int]] = []
        free = before if last is not None and step == last + 1 else []
        for line in steps[step]:
            near = min(free, key=lambda other: float(np.linalg.norm(other[0].middle - line.middle)), default=None)
            if near is not None and np.sum(_span(near[0]) * _span(line)) < 0.0:
                line = line.turned()  # noqa: PLW2901
            if near is not None and near[0].pressure.size == line.pressure.size:
                free = [other for other in free if other is not near]
                triangles.append(_strip(near[1], count, line.pressure.size))
            here.append((line, count))
            points.append(line.points)
            pressure.append(line.pressure)
            count += line.pressure.size
        before, last = here, step
    if not points:
        return PressureMap(np.zeros((2, 0)), np.zeros(0), np.zeros((0, 3), dtype=np.int64))
    corners = np.concatenate(triangles) if triangles else np.zeros((0, 3), dtype=np.int64)
    return PressureMap(np.concatenate(points, axis=1), np.concatenate(pressure), corners)


def _span(line: _Line) -> Array:
    """From the first to the last point."""
    return np.asarray(line.points[:, -1] - line.points[:, 0])


def _strip(first: int, second: int, size: int) -> NDArray[np.int64]:
    """Two triangles for each pair of neighbouring points of two lines."""
    i = np.arange(size - 1)
    a, b, c, d = first + i, first + i + 1, second + i, second + i + 1
    return np.concatenate([np.stack([a, b, d], axis=1), np.stack([a, d, c], axis=1)])
