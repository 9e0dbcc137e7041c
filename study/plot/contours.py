"""Contours on a flank: their regions, and numbers on the lines, clear of border, other lines and each other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...core.arrays import Array, Bools, Integers
from .style import SMALL_SIZE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.contour import ContourSet
    from matplotlib.path import Path
    from matplotlib.tri import Triangulation

PANEL_SHARE = 0.87  # width of a panel over that of its column
DIGIT_WIDTH, POINT_WIDTH, DIGIT_HEIGHT = 0.64, 0.32, 0.74  # over the size of the type
CANDIDATE_STEP = 3.0  # [pt] between points that are tried
LINE_LENGTH_MINIMUM = 1.6  # length of a line over that of its number
CHORD_MINIMUM = 0.93  # chord of a line under a number over the number's length
LINE_CLEARANCE, BORDER_CLEARANCE, LABEL_CLEARANCE = 0.5, 1.0, 2.5  # [pt] around a number
CLEARANCE_LIMIT = 9.0  # [pt]; more is no better
LABEL_DISTANCE = 150.0  # [pt] between numbers of the same level


@dataclass(frozen=True)
class Region:
    """Region in which the numbers of contour lines may stand."""

    holds: Callable[[Array], Bools]  # of points (n, 2) [mm]
    border: Array  # (k, 2) [mm], closely spaced


def outlined(outline: Path) -> Region:
    """Region inside closed curves."""
    curves = [curve for curve in map(np.asarray, outline.to_polygons()) if len(curve) > 2]
    return Region(outline.contains_points, np.concatenate([dense(curve) for curve in curves] or [np.zeros((0, 2))]))


def triangulated(mesh: Triangulation) -> Region:
    """Region covered by triangles."""
    find = mesh.get_trifinder()
    corners = np.stack([mesh.x, mesh.y], axis=1)
    sides = border_sides(mesh)
    border = np.concatenate([dense(corners[side]) for side in sides]) if len(sides) else np.zeros((0, 2))

    def holds(points: Array) -> Bools:
        triangles: Any = find(*points.T)
        return np.asarray(triangles >= 0)

    return Region(holds, border)


def border_sides(mesh: Triangulation) -> Integers:
    """Both ends (n, 2) of the sides that belong to one triangle only."""
    shown = mesh.get_masked_triangles()
    sides = np.sort(np.concatenate([shown[:, [0, 1]], shown[:, [1, 2]], shown[:, [2, 0]]]), axis=1)
    unique, count = np.unique(sides, axis=0, return_counts=True)
    return np.asarray(unique[count == 1])


def without_border(mesh: Triangulation) -> Triangulation:
    """Triangles without those that have a corner on the border."""
    from matplotlib.tri import Triangulation

    at_border = np.zeros(mesh.x.size, dtype=bool)
    at_border[border_sides(mesh)] = True
    hidden = np.any(at_border[mesh.triangles], axis=1)
    return Triangulation(mesh.x, mesh.y, mesh.triangles, hidden if mesh.mask is None else mesh.mask | hidden)


def without_steep(mesh: Triangulation, values: Array, steepest: float) -> Triangulation:
    """Triangles without those on which values (n) at the corners are steeper than a limit [1/mm]."""
    from matplotlib.tri import Triangulation

    plane = np.stack([mesh.x, mesh.y, values], axis=1)[mesh.triangles]
    normal = np.cross(plane[:, 1] - plane[:, 0], plane[:, 2] - plane[:, 0])
    normal *= np.sign(normal[:, 2:])
    shown = np.ones(len(normal), dtype=bool) if mesh.mask is None else ~mesh.mask
    around = np.zeros((mesh.x.size, 3))
    for corner in mesh.triangles[shown].T:
        np.add.at(around, corner, normal[shown])  # weighted by their areas
    mean = around[mesh.triangles].sum(axis=1)
    hidden = np.hypot(mean[:, 0], mean[:, 1]) > steepest * mean[:, 2]
    return Triangulation(mesh.x, mesh.y, mesh.triangles, hidden | ~shown)


def dense(line: Array, parts: int = 200) -> Array:
    """Line (n, 2) refined to at least as many parts."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    every = np.union1d(along, np.linspace(0.0, along[-1], parts))
    return np.stack([np.interp(every, along, values) for values in line.T], axis=1)


def drop_short(lines: ContourSet, shortest: float) -> None:
    """Remove pieces of contour lines that are shorter than a length [mm]."""
    from matplotlib.path import Path

    paths = []
    for level in lines.allsegs:
        kept = [Path(piece) for piece in level if np.hypot(*np.diff(piece, axis=0).T).sum() >= shortest]
        paths.append(Path.make_compound_path(*kept) if kept else Path(np.zeros((0, 2))))
    lines.set_paths(paths)


def number_lines(axes: Axes, lines: ContourSet, region: Region, size: float = SMALL_SIZE) -> None:
    """Write the levels on contour lines where there is room."""
    points: Any = label_points(axes, lines, region, size)
    if points:
        axes.clabel(lines, fmt=lambda value: f"{value:g}", fontsize=size, inline_spacing=1, manual=points)


def label_points(axes: Axes, lines: ContourSet, region: Region, size: float = SMALL_SIZE) -> list[tuple[float, float]]:
    """Points of contour lines for their numbers: longest lines first, each where there is most room.

    The axes must be as high as wide if their aspect is equal; the size of the type is in points.
    """
    from scipy.spatial import cKDTree

    scale = points_per_unit(axes)
    pieces = [
        (float(level), np.asarray(piece) * scale)
        for level, parts in zip(lines.levels, lines.allsegs, strict=True)
        for piece in parts
        if len(piece) > 2
    ]
    pieces.sort(key=lambda piece: -np.hypot(*np.diff(piece[1], axis=0).T).sum())
    drawn = [dense(piece) for _, piece in pieces]
    border = cKDTree(region.border * scale) if len(region.border) else None
    chosen: list[tuple[float, Array]] = []
    numbers: list[Array] = []
    for index, (level, piece) in enumerate(pieces):
        centres, written = candidates(piece, length(f"{level:g}", size))
        if not len(centres):
            continue
        flat = written.reshape(-1, 2)
        half = 0.5 * DIGIT_HEIGHT * size
        room = np.full(len(centres), CLEARANCE_LIMIT)
        others = [line for other, line in enumerate(drawn) if other != index]
        for tree, margin, least in (
            (cKDTree(np.concatenate(others)) if others else None, half, LINE_CLEARANCE),
            (border, half, BORDER_CLEARANCE),
            (cKDTree(np.concatenate(numbers)) if numbers else None, 2.0 * half, LABEL_CLEARANCE),
        ):
            if tree is not None:
                free = np.asarray(tree.query(flat)[0]).reshape(len(centres), -1).min(axis=1) - margin
                room = np.where(free < least, -np.inf, np.minimum(room, free))
        room[~np.all(region.holds(flat / scale).reshape(len(centres), -1), axis=1)] = -np.inf
        for other, point in chosen:
            if other == level:
                room[np.hypot(*(centres - point).T) < LABEL_DISTANCE] = -np.inf
        # Of those with about the most room the one nearest to the middle.
        best = np.flatnonzero(np.isfinite(room) & (room >= room.max() - 0.5))
        if best.size:
            middle = best[np.argmin(np.abs(best - 0.5 * (len(centres) - 1)))]
            chosen.append((level, centres[middle]))
            numbers.append(written[middle])
    return [(float(x), float(y)) for x, y in (point / scale for _, point in chosen)]


def candidates(line: Array, extent: float) -> tuple[Array, Array]:
    """Points (n, 2) of a line (k, 2) that is straight enough there for a number, and points (n, 7, 2) of the number."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    if along[-1] < LINE_LENGTH_MINIMUM * extent:
        return np.zeros((0, 2)), np.zeros((0, 7, 2))
    middles = np.arange(
        0.5 * LINE_LENGTH_MINIMUM * extent, along[-1] - 0.5 * LINE_LENGTH_MINIMUM * extent + 1e-9, CANDIDATE_STEP
    )

    def at(distances: Array) -> Array:
        return np.stack([np.interp(distances, along, values) for values in line.T], axis=1)

    centres, first, last = at(middles), at(middles - 0.5 * extent), at(middles + 0.5 * extent)
    chord = last - first
    straight = np.hypot(*chord.T) > CHORD_MINIMUM * extent
    offsets = np.linspace(-0.5, 0.5, 7)[None, :, None]
    return centres[straight], (centres[:, None] + offsets * chord[:, None])[straight]


def length(text: str, size: float) -> float:
    """Length of a number [pt] at a size of the type [pt]."""
    return size * sum(POINT_WIDTH if character == "." else DIGIT_WIDTH for character in text)


def points_per_unit(axes: Axes) -> Array:
    """Size of the units of both axes (2) [pt] on the laid-out page."""
    figure, spec = axes.figure, axes.get_subplotspec()
    rows, columns = spec.get_gridspec().get_geometry() if spec is not None else (1, 1)
    width, height = 72.0 / figure.dpi * PANEL_SHARE * np.asarray(figure.bbox.size)
    extent = np.array([np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())])
    scale = np.array([width / columns, height / rows]) / extent
    return np.full(2, scale[0]) if axes.get_aspect() == 1.0 else np.asarray(scale)
