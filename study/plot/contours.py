"""Numbers on contour lines: on their line, within a region, off its border, off other lines and off one another."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.path import Path
from matplotlib.tri import Triangulation
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from .page import SMALL_SIZE

Array = NDArray[Any]
Truths = NDArray[np.bool_]

PANEL = 0.87  # of its column, that the layout leaves a panel
DIGIT, POINT, TALL = 0.64, 0.32, 0.74  # of the size of the type: widths of a digit and a point, height of a digit
STEP = 3.0  # [pt] from one place that is tried to the next
SPARE = 1.6  # times the length of a number, that its line has at least
BENT = 0.93  # of its length, that a line's chord has at least under a number
OFF_LINES, OFF_BORDER, OFF_NUMBERS = 0.5, 1.0, 2.5  # [pt] between a number and whatever else there is
ROOMY = 9.0  # [pt]; more room is no better
SAME = 150.0  # [pt] within which a level gets one number


@dataclass(frozen=True)
class Region:
    """Where numbers may stand.

    Parameters
    ----------
    holds
        Whether points (n, 2) [mm] are in it (n).
    border
        Points (k, 2) [mm] around it, close to one another.
    """

    holds: Callable[[Array], Truths]
    border: Array


def outlined(outline: Path) -> Region:
    """What closed curves surround."""
    curves = [curve for curve in map(np.asarray, outline.to_polygons()) if len(curve) > 2]
    return Region(outline.contains_points, np.concatenate([dense(curve) for curve in curves] or [np.zeros((0, 2))]))


def triangulated(mesh: Triangulation) -> Region:
    """What triangles cover."""
    find = mesh.get_trifinder()
    corners = np.stack([mesh.x, mesh.y], axis=1)
    sides = border_sides(mesh)
    points = np.concatenate([dense(corners[side]) for side in sides]) if len(sides) else np.zeros((0, 2))

    def holds(places: Array) -> Truths:
        triangles: Any = find(*places.T)
        return np.asarray(triangles >= 0)

    return Region(holds, points)


def border_sides(mesh: Triangulation) -> NDArray[np.int64]:
    """Both ends (n, 2) of the triangles' sides that no two triangles share."""
    shown = mesh.get_masked_triangles()
    sides = np.sort(np.concatenate([shown[:, [0, 1]], shown[:, [1, 2]], shown[:, [2, 0]]]), axis=1)
    unique, count = np.unique(sides, axis=0, return_counts=True)
    return np.asarray(unique[count == 1])


def without_border(mesh: Triangulation) -> Triangulation:
    """The same triangles without those that have a corner on the border."""
    at_border = np.zeros(mesh.x.size, dtype=bool)
    at_border[border_sides(mesh)] = True
    hidden = np.any(at_border[mesh.triangles], axis=1)
    return Triangulation(mesh.x, mesh.y, mesh.triangles, hidden if mesh.mask is None else mesh.mask | hidden)


def without_steep(mesh: Triangulation, values: Array, steepest: float) -> Triangulation:
    """The same triangles without those where values (n) at their corners are steeper than so much [1/mm]."""
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
    """A line (n, 2) with so many points along its length at least."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    every = np.union1d(along, np.linspace(0.0, along[-1], parts))
    return np.stack([np.interp(every, along, values) for values in line.T], axis=1)


def drop_short(lines: ContourSet, shortest: float) -> None:
    """Take pieces of contour lines away that are shorter than so much [mm]."""
    paths = []
    for level in lines.allsegs:
        kept = [Path(piece) for piece in level if np.hypot(*np.diff(piece, axis=0).T).sum() >= shortest]
        paths.append(Path.make_compound_path(*kept) if kept else Path(np.zeros((0, 2))))
    lines.set_paths(paths)


def number_lines(axes: Axes, lines: ContourSet, region: Region, size: float = SMALL_SIZE) -> None:
    """Write the levels on contour lines where there is room."""
    places: Any = label_places(axes, lines, region, size)
    if places:
        axes.clabel(lines, fmt=lambda value: f"{value:g}", fontsize=size, inline_spacing=1, manual=places)


def label_places(axes: Axes, lines: ContourSet, region: Region, size: float = SMALL_SIZE) -> list[tuple[float, float]]:
    """Where contour lines get their numbers: the longest first, and each where there is most room.

    Parameters
    ----------
    axes
        Where they are drawn, as high as wide if its aspect is equal.
    lines
        The contour lines.
    region
        Where numbers may stand.
    size
        Of the type [pt].
    """
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
    places: list[tuple[float, Array]] = []
    numbers: list[Array] = []
    for index, (level, piece) in enumerate(pieces):
        centres, written = candidates(piece, length(f"{level:g}", size))
        if not len(centres):
            continue
        flat = written.reshape(-1, 2)
        half = 0.5 * TALL * size
        room = np.full(len(centres), ROOMY)
        others = [line for other, line in enumerate(drawn) if other != index]
        for tree, own, least in (
            (cKDTree(np.concatenate(others)) if others else None, half, OFF_LINES),
            (border, half, OFF_BORDER),
            (cKDTree(np.concatenate(numbers)) if numbers else None, 2.0 * half, OFF_NUMBERS),
        ):
            if tree is not None:
                free = np.asarray(tree.query(flat)[0]).reshape(len(centres), -1).min(axis=1) - own
                room = np.where(free < least, -np.inf, np.minimum(room, free))
        room[~np.all(region.holds(flat / scale).reshape(len(centres), -1), axis=1)] = -np.inf
        for other, place in places:
            if other == level:
                room[np.hypot(*(centres - place).T) < SAME] = -np.inf
        # As good as the best, and then nearest to the middle.
        best = np.flatnonzero(np.isfinite(room) & (room >= room.max() - 0.5))
        if best.size:
            chosen = best[np.argmin(np.abs(best - 0.5 * (len(centres) - 1)))]
            places.append((level, centres[chosen]))
            numbers.append(written[chosen])
    return [(float(x), float(y)) for x, y in (place / scale for _, place in places)]


def candidates(line: Array, extent: float) -> tuple[Array, Array]:
    """Places (n, 2) on a line (k, 2) where it is long and straight enough for a number, and points (n, 7, 2) of it."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    if along[-1] < SPARE * extent:
        return np.zeros((0, 2)), np.zeros((0, 7, 2))
    middles = np.arange(0.5 * SPARE * extent, along[-1] - 0.5 * SPARE * extent + 1e-9, STEP)

    def at(places: Array) -> Array:
        return np.stack([np.interp(places, along, values) for values in line.T], axis=1)

    centres, first, last = at(middles), at(middles - 0.5 * extent), at(middles + 0.5 * extent)
    chord = last - first
    straight = np.hypot(*chord.T) > BENT * extent
    offsets = np.linspace(-0.5, 0.5, 7)[None, :, None]
    return centres[straight], (centres[:, None] + offsets * chord[:, None])[straight]


def length(text: str, size: float) -> float:
    """Length of a number [pt] in type of a size [pt]."""
    return size * sum(POINT if character == "." else DIGIT for character in text)


def points_per_unit(axes: Axes) -> Array:
    """How large the units of both axes (2) will be [pt] when the page is laid out."""
    figure, spec = axes.figure, axes.get_subplotspec()
    rows, columns = spec.get_gridspec().get_geometry() if spec is not None else (1, 1)
    width, height = 72.0 / figure.dpi * PANEL * np.asarray(figure.bbox.size)
    extent = np.array([np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())])
    scale = np.array([width / columns, height / rows]) / extent
    return np.full(2, scale[0]) if axes.get_aspect() == 1.0 else np.asarray(scale)
