"""Pressure map: greatest contact pressure over the mesh cycle, as a surface over the gear flank.

All tooth pairs are alike, and together their contact lines at the mesh positions of one cycle are the lines of one
tooth's passage through the mesh, one beside the other. Every point of the flank is passed by one line, once; the
surface through the pressures on the lines is therefore the envelope of the pressure over the cycle.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.ordered_values import ordered

Array = NDArray[Any]

PRESSURE_TOLERANCE = 1e-4  # over the greatest pressure of a line; less is rounding of a solver
TIE_TOLERANCE = 1e-9  # over the length of a line
END_DISTANCE_MINIMUM = 0.05  # over the distance to the next segment or line; less would degenerate triangles


@dataclass(frozen=True)
class PressureMap:
    """Surface of pressure, as triangles.

    Parameters
    ----------
    points
        Fractions (2, n) on the gear flank: the middles of the loaded segments, and where the load ends.
    pressure
        Pressure at the points (n) [MPa].
    triangles
        Corners (m, 3) of the triangles, between the loaded parts of the lines of neighbouring mesh positions.
    """

    points: Array
    pressure: Array
    triangles: NDArray[np.int64]

    @property
    def peak(self) -> float:
        """Greatest pressure [MPa]; NaN if there is none."""
        return float(np.max(self.pressure)) if self.pressure.size else float("nan")

    @property
    def peak_point(self) -> Array:
        """Fractions (2) of the greatest pressure."""
        return np.asarray(self.points[:, np.argmax(self.pressure)])


@dataclass(frozen=True)
class Line:
    """Contact line with its pressure.

    Parameters
    ----------
    points
        Fractions (2, k) of its ends and the middles of its segments.
    pressure
        Pressure at the points (k) [MPa], zero where there is no load.
    """

    points: Array
    pressure: Array

    @cached_property
    def along(self) -> Array:
        """Distance of the points (k) from the first one, as a part of the length."""
        x, y = self.points[:, 1:] - self.points[:, :-1]
        along = np.zeros(x.size + 1)
        np.cumsum(np.sqrt(x * x + y * y), out=along[1:])
        return along / max(float(along[-1]), 1e-12)

    @cached_property
    def middle(self) -> Array:
        """Mean of the points (2)."""
        return np.asarray(self.points.mean(axis=1))

    def runs_against(self, other: Line) -> bool:
        """Whether the two lines count their points in opposite directions."""
        return bool((self.points[:, -1] - self.points[:, 0]) @ (other.points[:, -1] - other.points[:, 0]) < 0.0)


def pressure_map(at_torque: xr.Dataset) -> PressureMap:
    """Pressure map of the mesh cycle at one torque.

    Parameters
    ----------
    at_torque
        The group ``loaded`` at one torque: variables over (mesh_position, segment). Mesh positions without a certified
        solution are NaN and leave a gap in the surface.
    """
    positions = at_torque.sizes["mesh_position"]
    names = ("tooth", "lengthwise", "profile", "pressure", "length")
    table = np.stack([ordered(at_torque, name, "mesh_position", "segment") for name in names])
    steps: dict[int, list[Line]] = {}
    for k in range(positions):
        for tooth, line in _lines(table[:, k]):
            # Pair -1 is now where pair 0 will be a cycle later.
            steps.setdefault(k - tooth * positions, []).append(line)
    return surface(steps)


def _lines(segments: Array) -> Iterator[tuple[int, Line]]:
    """Tooth pair and contact lines of one mesh position, from rows tooth, lengthwise, profile, pressure, length."""
    segments = segments[:, np.all(np.isfinite(segments), axis=0)]
    tooth, length = segments[0], segments[4]
    # The segments of a line are equally long: another length is another line, even on the same tooth.
    new = (tooth[1:] != tooth[:-1]) | (np.abs(length[1:] - length[:-1]) > 1e-9 * length[1:])
    cuts = (np.flatnonzero(new) + 1).tolist()
    for first, beyond in zip([0, *cuts], [*cuts, tooth.size], strict=True):
        part = segments[:, first:beyond]
        points, pressure = part[1:3], part[3]
        if pressure.size < 2:
            continue
        # A segment's pressure is constant: it reaches to the end of the line, half a segment beyond the last middle.
        half = 0.5 * (points[:, [0, -1]] - points[:, [1, -2]])
        ends = np.clip(points[:, [0, -1]] + half, 0.0, 1.0)
        points = np.concatenate([ends[:, :1], points, ends[:, 1:]], axis=1)
        yield int(part[0, 0]), Line(points, np.concatenate([pressure[:1], pressure, pressure[-1:]]))


def loaded_parts(lines: Sequence[Line]) -> list[Line | None]:
    """Loaded part of each contact line; ``None`` if there is no load.

    Towards its end a load falls off in proportion to the distance, and with it the square of the pressure; the last two
    loaded segments say where that leads to zero.
    """
    found: list[Line | None] = [None] * len(lines)
    sizes = [line.pressure.size for line in lines]
    for size in sorted(set(sizes)):
        alike = [number for number, own in enumerate(sizes) if own == size]
        points = np.stack([lines[number].points for number in alike])
        pressure = np.stack([lines[number].pressure for number in alike])
        loaded = pressure > PRESSURE_TOLERANCE * np.maximum(pressure.max(axis=1, keepdims=True), 1e-9)
        pressure = np.where(loaded, pressure, 0.0)
        first, last = np.argmax(loaded, axis=1), size - 1 - np.argmax(loaded[:, ::-1], axis=1)
        for edge, side in ((first, -1), (last, 1)):
            rows = np.flatnonzero((edge + side >= 0) & (edge + side < size))
            at, before = edge[rows], edge[rows] - side
            within = (first[rows] <= before) & (before <= last[rows])
            further = np.where(within, pressure[rows, np.clip(before, 0, size - 1)], np.inf)
            way = points[rows, :, at + side] - points[rows, :, at]
            points[rows, :, at + side] += (falls_to_zero(pressure[rows, at], further) - 1.0)[:, None] * way
        for row in np.flatnonzero(loaded.any(axis=1)):
            kept = slice(max(first[row] - 1, 0), last[row] + 2)
            found[alike[row]] = Line(points[row, :, kept], pressure[row, kept])
    return found


def falls_to_zero(last: Array, before: Array) -> Array:
    """Distance (...) from the last value to the end of a pressure, in steps, at most one; from the two last values."""
    with np.errstate(divide="ignore", invalid="ignore"):
        falling = np.where(
            np.isfinite(before), np.clip(last**2 / (before**2 - last**2), END_DISTANCE_MINIMUM, 1.0), 0.5
        )
    return np.where(before <= last, 1.0, falling)


def surface(steps: dict[int, list[Line]]) -> PressureMap:
    """Triangles between the loaded parts of the contact lines (by step) of neighbouring steps."""
    points: list[Array] = []
    pressure: list[Array] = []
    triangles: list[NDArray[np.int64]] = []
    count = 0

    def add(line: Line) -> int:
        nonlocal count
        points.append(line.points)
        pressure.append(line.pressure)
        count += line.pressure.size
        return count - line.pressure.size

    together = iter(loaded_parts([line for lines in steps.values() for line in lines]))
    parts = {
        step: [(part, add(part)) for part in islice(together, len(lines)) if part is not None]
        for step, lines in steps.items()
    }
    for step, here in parts.items():
        # Each part meets its neighbour of the next step, or comes to a point before the next line that is not loaded.
        ahead, behind = list(parts.get(step + 1, [])), list(parts.get(step - 1, []))
        for part, start in here:
            near = _nearest(part, [other for other, _ in ahead])
            if near is not None:
                other, other_start = ahead.pop(near)
                triangles.append(_strip(part, start, other, other_start))
        for side, neighbours in ((1, parts.get(step + 1, [])), (-1, behind)):
            if neighbours or step + side not in steps:
                continue
            for part, start in here:
                before = [other for other, _ in parts.get(step - side, [])]
                tip = _tip(part, steps[step + side], before)
                size = part.pressure.size
                i = start + np.arange(size - 1)
                triangles.append(np.stack([i, i + 1, np.full(size - 1, add(tip))], axis=1))
    if not points:
        return PressureMap(np.zeros((2, 0)), np.zeros(0), np.zeros((0, 3), dtype=np.int64))
    corners = np.concatenate(triangles) if triangles else np.zeros((0, 3), dtype=np.int64)
    return PressureMap(np.concatenate(points, axis=1), np.concatenate(pressure), corners)


def _nearest(line: Line, others: list[Line]) -> int | None:
    """Index of the line whose middle is nearest; ``None`` if there are no others."""
    if len(others) < 2:
        return 0 if others else None
    return int(np.argmin([float(np.linalg.norm(other.middle - line.middle)) for other in others]))


def _tip(part: Line, unloaded: list[Line], before: list[Line]) -> Line:
    """Point at which the load ends between a loaded part and the unloaded line of the next step."""
    greatest = int(np.argmax(part.pressure))
    point = part.points[:, greatest]
    target = np.concatenate([line.points for line in unloaded], axis=1)
    target = target[:, np.argmin(np.linalg.norm(target - point[:, None], axis=0))]
    near = _nearest(part, before)
    further = np.asarray(np.max(before[near].pressure) if near is not None else np.inf)
    share = falls_to_zero(part.pressure[greatest], further)
    return Line((point + share * (target - point))[:, None], np.zeros(1))


def _strip(first: Line, start: int, second: Line, other: int) -> NDArray[np.int64]:
    """Triangles between two lines, given with the indices of their first points.

    The points of both lines are taken in turn, in their order along the lines, so that the ends meet the
    ends and every point is a corner.
    """
    turned = second.runs_against(first)
    u, v = first.along, 1.0 - second.along[::-1] if turned else second.along
    v = v + TIE_TOLERANCE  # which of two places that are equal but for rounding comes first must not depend on that
    at = other + (np.arange(v.size)[::-1] if turned else np.arange(v.size))
    i = start + np.arange(u.size)
    of_first = np.stack([i[:-1], i[1:], at[np.maximum(np.searchsorted(v, u[1:], side="left") - 1, 0)]], axis=1)
    of_second = np.stack([at[:-1], at[1:], i[np.searchsorted(u, v[1:], side="right") - 1]], axis=1)
    return np.concatenate([of_first, of_second])
