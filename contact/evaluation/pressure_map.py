"""Pressure map: greatest contact pressure over the mesh cycle, as a surface over the gear flank.

All tooth pairs are alike, and together their contact lines at the mesh positions of one cycle are the lines of one
tooth's passage through the mesh, one beside the other. Every point of the flank is passed by one line, once; the
surface through the pressures on the lines is therefore the envelope of the pressure over the cycle.

Its maximum has a place, where a contact line may end; the greatest pressure away from ends of lines is given, too.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ...core.arrays import Array, Bools, Integers
from ...core.attributes import ordered
from ..outcomes import LineEnd as LineEnd

if TYPE_CHECKING:
    from ..lines.flank_splines import FlankSplines

PRESSURE_TOLERANCE = 1e-4  # over the greatest pressure of a line; less is rounding of a solver
TIE_TOLERANCE = 1e-9  # over the length of a line
EQUAL_LENGTH_TOLERANCE = 1e-9  # relative; the segments of a contact line are equally long
END_DISTANCE_MINIMUM = 0.05  # over the distance to the next segment or line; less would degenerate triangles


@dataclass(frozen=True)
class PressureMap:
    """Surface of pressure, as triangles between the loaded parts of the lines of neighbouring mesh positions."""

    points: Array  # fractions on the gear (2, n)
    pressure: Array
    triangles: Integers

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
    """Contact line with its pressure at its ends and the middles of its segments, zero where there is no load."""

    points: Array  # fractions (2, k)
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


def pressure_map(at_torque: xr.Dataset) -> PressureMap:
    """Pressure map from the group ``loaded`` at one torque; mesh positions that are not certified leave a gap in it."""
    positions = at_torque.sizes["mesh_position"]
    names = ("tooth", "lengthwise", "profile", "pressure", "length")
    table = np.stack([ordered(at_torque, name, "mesh_position", "segment") for name in names])
    steps: dict[int, list[Line]] = {}
    for position, tooth, line in _lines(table):
        # Pair -1 is now where pair 0 will be a cycle later.
        steps.setdefault(position - tooth * positions, []).append(line)
    return surface(steps)


def _lines(table: Array) -> Iterator[tuple[int, int, Line]]:
    """Mesh position, tooth pair and contact lines, from rows tooth, lengthwise, profile, pressure, length (5, k, n)."""
    known = np.all(np.isfinite(table), axis=0)
    position = np.nonzero(known)[0]
    segments = table[:, known]
    tooth, length = segments[0], segments[4]
    new = (position[1:] != position[:-1]) | ~_goes_on(tooth, length)
    first = np.concatenate([[0], np.flatnonzero(new) + 1]) if tooth.size else np.zeros(0, dtype=np.int64)
    last = np.append(first[1:], tooth.size) - 1
    first, last = first[last > first], last[last > first]
    # A segment's pressure is constant: it reaches to the end of the line, half a segment beyond the last middle.
    points, pressure = segments[1:3], segments[3]
    begin, end = (
        np.clip(points[:, at] + 0.5 * (points[:, at] - points[:, beside]), 0.0, 1.0)
        for at, beside in ((first, first + 1), (last, last - 1))
    )
    for number, (i, j) in enumerate(zip(first.tolist(), last.tolist(), strict=True)):
        nodes = np.column_stack([begin[:, number], points[:, i : j + 1], end[:, number]])
        at_nodes = np.concatenate([pressure[[i]], pressure[i : j + 1], pressure[[j]]])
        yield int(position[i]), int(tooth[i]), Line(nodes, at_nodes)


def _goes_on(tooth: Array, length: Array) -> Bools:
    """True where a segment (..., n - 1) is followed by one of the same line.

    The segments of a line are equally long: another length is another line, even on the same tooth.
    """
    alike = np.abs(length[..., 1:] - length[..., :-1]) <= EQUAL_LENGTH_TOLERANCE * length[..., 1:]
    return np.asarray((tooth[..., 1:] == tooth[..., :-1]) & alike)


def loaded_parts(lines: Sequence[Line]) -> list[Line | None]:
    """Loaded part of each contact line; ``None`` if there is no load.

    It ends where the square of the pressure of the last two loaded segments, linear in the distance, leads to zero.
    """
    parts: list[Line | None] = [None] * len(lines)
    sizes = [line.pressure.size for line in lines]
    for size in sorted(set(sizes)):
        alike = [number for number, line_size in enumerate(sizes) if line_size == size]
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
            parts[alike[row]] = Line(points[row, :, kept], pressure[row, kept])
    return parts


def falls_to_zero(last: Array, before: Array) -> Array:
    """Distance (...) from the last value to the end of a pressure, in steps, at most one; from the two last values."""
    with np.errstate(divide="ignore", invalid="ignore"):
        falling = np.clip(last**2 / (before**2 - last**2), END_DISTANCE_MINIMUM, 1.0)
    return np.where(before <= last, 1.0, np.where(np.isfinite(before), falling, 0.5))


def surface(steps: dict[int, list[Line]]) -> PressureMap:
    """Triangles between the loaded parts of the contact lines (by step) of neighbouring steps."""
    points, pressure, triangles = [np.zeros((2, 0))], [np.zeros(0)], [np.zeros((0, 3), dtype=np.int64)]
    pairs: list[tuple[Line, int, Line, int]] = []
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
    for step, step_parts in parts.items():
        # Each part meets its neighbour of the next step, or comes to a point before the next line that is not loaded.
        ahead, behind = list(parts.get(step + 1, [])), list(parts.get(step - 1, []))
        for part, start in step_parts:
            if (near := _nearest(part, [other for other, _ in ahead])) is not None:
                pairs.append((part, start, *ahead.pop(near)))
        for side, neighbours in ((1, parts.get(step + 1, [])), (-1, behind)):
            if neighbours or step + side not in steps:
                continue
            for part, start in step_parts:
                before = [other for other, _ in parts.get(step - side, [])]
                tip = _tip(part, steps[step + side], before)
                size = part.pressure.size
                i = start + np.arange(size - 1)
                triangles.append(np.stack([i, i + 1, np.full(size - 1, add(tip))], axis=1))
    corners = np.concatenate([*_strips(pairs), *triangles])
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


def _strips(pairs: Sequence[tuple[Line, int, Line, int]]) -> list[Integers]:
    """Triangles between pairs of lines, given with the indices of their first points; every point is a corner."""
    if not pairs:
        return []
    u, v, i, j = [], [], [], []
    for number, (first, start, second, other) in enumerate(pairs):
        along, points = second.along, np.arange(other, other + second.along.size)
        ways = [one.points[:, -1] - one.points[:, 0] for one in (first, second)]
        if ways[0] @ ways[1] < 0.0:  # they count their points in opposite directions
            along, points = 1.0 - along[::-1], points[::-1]
        # One ascending sequence of all pairs. Which of two places that are equal but for rounding comes first must not
        # depend on that.
        u.append(first.along + 2.0 * number)
        v.append(along + (2.0 * number + TIE_TOLERANCE))
        i.append(np.arange(start, start + first.along.size))
        j.append(points)
    places, others = np.concatenate(u), np.concatenate(v)
    of_first, of_second = np.concatenate(i), np.concatenate(j)
    begin, other_begin = (np.cumsum([0, *(one.size for one in each[:-1])]) for each in (u, v))
    next_one, next_other = (np.delete(np.arange(one.size), at) for one, at in ((places, begin), (others, other_begin)))
    first_other = np.repeat(other_begin, [one.size - 1 for one in u])
    before = np.maximum(np.searchsorted(others, places[next_one], side="left") - 1, first_other)
    before_other = np.searchsorted(places, others[next_other], side="right") - 1
    return [
        np.stack([of_first[next_one - 1], of_first[next_one], of_second[before]], axis=1),
        np.stack([of_second[next_other - 1], of_second[next_other], of_first[before_other]], axis=1),
    ]


LINE_END_SHARE = 0.1  # of a contact line, within which a segment counts as one at its end
BORDER_SHARE = 0.02  # of a flank, within which a point counts as one at its border
OVER = ("torque", "mesh_position", "segment")


@dataclass(frozen=True)
class PressurePlace:
    """Place of the greatest pressure of a mesh cycle."""

    mesh_position: float
    pair: float
    point: Array
    line_end: LineEnd  # within LINE_END_SHARE of its length, or BORDER_SHARE of the flank

    @classmethod
    def of(cls, at_torque: xr.Dataset, splines: FlankSplines) -> PressurePlace:
        """From the group ``/loaded`` at one torque, and splines from ``contact_lines.contact_splines``."""
        order = ("mesh_position", "segment")
        pressure = ordered(at_torque, "pressure", *order)
        if not np.any(pressure > 0.0):
            return cls(np.nan, np.nan, np.full(2, np.nan), LineEnd.UNKNOWN)
        position, segment = np.unravel_index(int(np.nanargmax(pressure)), pressure.shape)
        names = ("tooth", "length", "lengthwise", "profile")
        segments = np.stack([ordered(at_torque, name, *order)[position] for name in names])
        beside = _beside_on_line(np.isfinite(pressure[position]), *segments[:2])
        return cls(
            float(ordered(at_torque, "mesh_position", "mesh_position")[position]),
            float(segments[0, segment]),
            segments[2:, segment],
            _line_end(segments[2:], int(segment), [int(one[segment]) for one in beside], splines),
        )


def _line_end(points: Array, number: int, beside: list[int], splines: FlankSplines) -> LineEnd:
    """Border at which the line of a segment ends near it, from points (2, n) and how many are before and after it."""
    sign = -1 if beside[0] <= beside[1] else 1
    if min(beside) > LINE_END_SHARE * (1 + sum(beside)):
        # A line that cuts a corner of the flank is short: all of it is near its ends.
        place = points[:, number]
        return nearest_border(splines, place) if np.min(_margins(splines, place)) < BORDER_SHARE else LineEnd.INSIDE
    last = number + sign * min(beside)
    point = points[:, last]
    if sum(beside) > 0:
        point = point + 0.5 * (point - points[:, last - sign])
    return nearest_border(splines, point)


def _beside_on_line(on_line: Bools, tooth: Array, length: Array) -> tuple[Array, Array]:
    """Numbers (..., n) of the segments of the same line before each segment, and after it."""
    with np.errstate(invalid="ignore"):
        same = _goes_on(tooth, length) & on_line[..., 1:] & on_line[..., :-1]
    before, after = np.zeros(on_line.shape), np.zeros(on_line.shape)
    for number in range(same.shape[-1]):
        before[..., number + 1] = np.where(same[..., number], before[..., number] + 1.0, 0.0)
        back = same.shape[-1] - 1 - number
        after[..., back] = np.where(same[..., back], after[..., back + 1] + 1.0, 0.0)
    return before, after


def nearest_border(splines: FlankSplines, point: Array) -> LineEnd:
    """Border of the common flank that is nearest to a point (2) of the gear, in fractions."""
    blade = splines("blade_distance", np.clip(point, 0.0, 1.0)[:, None])
    return LineEnd(1 + int(np.argmin([*_margins(splines, point), *blade])))


def _margins(splines: FlankSplines, point: Array) -> Array:
    """Distances (8) of a point from the borders of both flanks, in fractions: toe, heel, root, tip of either."""
    point = np.clip(point, 0.0, 1.0)
    opposite = splines.evaluate(["pinion_lengthwise", "pinion_profile"], point[:, None]).values()
    on_both = np.array([*point, *(float(values[0]) for values in opposite)])
    return np.stack([on_both, 1.0 - on_both], axis=1).ravel()


def at_line_end(loaded: xr.Dataset) -> Bools:
    """True for segments among the outer ones of a contact line, or at the border of the gear flank."""
    names = ("pressure", "tooth", "length", "lengthwise", "profile")
    pressure, tooth, length, lengthwise, profile = (ordered(loaded, name, *OVER) for name in names)
    on_line = np.isfinite(pressure)
    before, after = _beside_on_line(on_line, tooth, length)
    with np.errstate(invalid="ignore"):
        margin = np.minimum(np.minimum(lengthwise, 1.0 - lengthwise), np.minimum(profile, 1.0 - profile))
    outer = np.minimum(before, after) <= LINE_END_SHARE * (1.0 + before + after)
    return np.asarray(on_line & (outer | (margin < BORDER_SHARE)))


def max_inner_pressure(loaded: xr.Dataset) -> Array:
    """Greatest pressure [MPa] (torque) away from the ends of the contact lines; NaN where nothing carries there."""
    pressure = ordered(loaded, "pressure", *OVER)
    inner = np.where(np.isfinite(pressure) & ~at_line_end(loaded), pressure, -np.inf).max(axis=(1, 2))
    return np.where(inner > 0.0, inner, np.nan)
