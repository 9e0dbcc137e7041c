"""Contact pattern chart: contact lines, marking print and pattern at light load, on both flanks.

Contour labels: numbers on contour lines, within a region and clear of its border, other lines and each other.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from scipy.spatial import cKDTree

from ...contact.evaluation.flank_region import FlankRegion
from ...contact.evaluation.marking_print import MarkingPrint, checked_thickness
from ...contact.evaluation.pressure_map import pressure_map
from ...contact.evaluation.tooth_passage import CarryingError
from ...contact.outcomes import Status
from ...core.arrays import Array, Bools, Integers
from ...geometry.tooth.tooth_flanks import MemberName
from ..summary.curves import torque_name
from .drawing_style import picture
from .drawn_result import flank_views, require_result
from .mesh_cycle_charts import draw_surface, pressure_levels
from .page import BLUE, FAINT, GREY, INK, SMALL_SIZE, VERMILION, WIDTH, legend_at_foot, panel_titles
from .panel_grid import chosen_parts, panels
from .pattern_lines import contact_pattern as pattern_of, draw_pattern, path_beyond
from .tooth_view import ToothView, draw_flank, shared_aspect, side_by_side

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.contour import ContourSet
    from matplotlib.figure import Figure
    from matplotlib.path import Path
    from matplotlib.tri import Triangulation

    from .panel_grid import AxesChoice

FLANK_NAMES = {"gear": "gear flank", "pinion": "pinion flank"}
COMPOUND = "#7FB2D6"  # colour of the marking compound
PARTS = ("lines", "print", "light_load")
LEGEND_HEIGHT = 0.62  # [in]
DRAWN_GRID = (481, 241)  # points of a drawn print along the face and the profile
CENTRE_STYLE: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 3.5, "color": INK}


@picture
def contact_pattern(
    tree: xr.DataTree,
    *,
    member: MemberName | None = None,
    parts: str | Sequence[str] | None = None,
    marking: float | None = None,
    axes: AxesChoice = None,
) -> Figure | None:
    """Contact pattern without load and at light load.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    member
        ``gear`` or ``pinion``; both, side by side, if left out.
    parts
        Rows of panels: ``lines`` (contact lines and path of contact), ``print`` (marking print), ``light_load``; all if
        left out.
    marking
        Thickness of the marking compound [um]; that of the result if left out.
    axes
        An Axes a panel, row by row; a page of its own if left out. With them nothing is returned;
        ``layout="constrained"`` of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result, a name is not known, the thickness is out of range, or ``axes`` are not as many as the
        panels.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> figure = easeoff.plot.contact_pattern(tree, member="gear", parts="print")
    >>> figure.axes[0].get_title(loc="left")
    'marking print, 6 µm'
    """
    require_result(tree)
    if marking is not None:
        checked_thickness(marking)
    views = flank_views(tree, member)
    unloaded = tree["unloaded"].to_dataset()
    separation = float(unloaded.attrs.get("separation", float("nan")))
    thickness = separation if marking is None else marking
    light = tree["light_load"].to_dataset().isel(torque=0) if "light_load" in tree.children else None
    names = chosen_parts(PARTS if light is not None else PARTS[:2], parts)
    height = len(names) * ((WIDTH - 0.9) / len(views) * shared_aspect(views) + 0.28) + 0.35 + LEGEND_HEIGHT
    note = f"contact lines where the gap is within {separation:g} µm · toe left, tip at the top"
    if light is not None and math.isfinite(float(light["max_pressure"])) and "light_load" in names:
        note += f" · light load: yellow to dark red, 0 to {float(light['max_pressure']):.0f} MPa"
    subplots = panels(tree, "Contact pattern", height, note, (len(names), len(views)), axes)
    grid = subplots.axes.reshape(len(names), len(views))
    rows = dict(zip(names, grid, strict=True))
    pattern = pattern_of(unloaded, views[0].fields)
    error = CarryingError.of(unloaded, 2.0 * math.pi / tree.attrs["pinion_teeth"])
    printed, region = None, None
    if error.is_known:
        printed = MarkingPrint.of(views[0].fields, error, thickness, DRAWN_GRID)
        region = MarkingPrint.of(views[0].fields, error, thickness).region(views[0].plane)
    surface = None if light is None else pressure_map(light)
    for column, view in enumerate(views):
        left = column == 0
        if "lines" in rows:
            panel, shown = rows["lines"][column], (names[-1] == "lines", left)
            draw_pattern(panel, view, pattern, labels=shown)
            panel_titles(panel, FLANK_NAMES[view.member], "contact lines, path of contact")
        if "print" in rows:
            panel, shown = rows["print"][column], (names[-1] == "print", left)
            draw_flank(panel, view, labels=shown)
            if region is not None and printed is not None:
                draw_print(panel, view, printed, region)
            said = "no unloaded contact" if region is None else size_name(region)
            panel_titles(panel, f"marking print, {thickness:g} µm", said if left else "")
        if light is not None and surface is not None and "light_load" in rows:
            panel, shown = rows["light_load"][column], (names[-1] == "light_load", left)
            draw_flank(panel, view, labels=shown)
            draw_surface(panel, view, surface, pressure_levels(surface.peak if surface.pressure.size else 1.0))
            panel_titles(panel, f"light load, {torque_name(float(light['torque']))}", _light(light) if left else "")
    side_by_side(grid)
    if subplots.on_page:
        legend_at_foot(subplots.figure, _entries(), LEGEND_HEIGHT)
    return subplots.figure


def draw_print(axes: Axes, view: ToothView, printed: MarkingPrint, region: FlankRegion) -> None:
    """Draw a marking print on its flank, and the centre of its region on the gear."""
    x, y = view.in_plane(printed.points)
    if not region.area > 0.0:
        return
    axes.contourf(x, y, printed.excess, levels=[1.01 * float(np.min(printed.excess)), 0.0], colors=[COMPOUND], zorder=2)
    axes.contour(x, y, printed.excess, levels=[0.0], colors=BLUE, linewidths=0.9, zorder=3)
    axes.plot(*view.in_plane(region.centre), zorder=9, **CENTRE_STYLE)


def size_name(region: FlankRegion) -> str:
    """Length and height of a region of the gear flank, as text."""
    return "length {:.0f} %, height {:.0f} %".format(*(100.0 * region.size)) if region.area > 0.0 else "nothing printed"


def _light(light: xr.Dataset) -> str:
    """Size and greatest pressure of the pattern at light load."""
    length, height = (100.0 * float(light[f"pattern_{name}"]) for name in ("length", "height"))
    if not math.isfinite(length):
        return "no area" if np.all(light["status"].values == Status.CERTIFIED) else "no certified solution"
    peak = float(light["max_pressure"])
    carried = f"up to {peak:.0f} MPa" if math.isfinite(peak) else "load on sharp edges alone"
    return f"length {length:.0f} %, height {height:.0f} %, {carried}"


def _entries() -> list[Any]:
    """Entries of the legend."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    return [
        Line2D([], [], color=VERMILION, linewidth=1.8, label="path of contact, carrying pair"),
        path_beyond("path of contact, before and after"),
        Line2D([], [], color=BLUE, linewidth=1.4, label="outline of the carrying range"),
        Line2D([], [], color=BLUE, linewidth=0.8, alpha=0.75, label="contact lines, carrying pair"),
        Line2D([], [], color=FAINT, linewidth=0.8, label="contact lines, before and after"),
        Line2D([], [], color=GREY, linewidth=0.8, linestyle=(0, (4, 2)), label="boundary of the common flank"),
        Patch(facecolor=COMPOUND, edgecolor=BLUE, linewidth=0.9, label="print over a mesh cycle"),
        Line2D([], [], label="centre of the print", **CENTRE_STYLE),
        Line2D([], [], linestyle="none", marker="+", markersize=7, color=INK, label="greatest pressure"),
    ]


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
