"""Contact pattern chart: contact lines, marking print and pattern at light load, on both flanks.

Pattern without load: contact lines, path of contact and outline of the range in which a pair carries.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ...contact.evaluation.flank_region import FlankRegion
from ...contact.evaluation.marking_print import MarkingPrint, checked_thickness
from ...contact.evaluation.pressure_map import pressure_map
from ...contact.evaluation.tooth_passage import CarryingError, ToothPassage, tooth_passage
from ...contact.lines.contact_lines import boundary_distance
from ...contact.lines.flank_splines import FlankSplines
from ...contact.outcomes import Status
from ...core.arrays import Array, Bools
from ...geometry.tooth.tooth_flanks import MemberName
from ..summary.curves import torque_name
from .axes_style import legend_at_foot, panel_titles
from .matplotlib_defaults import picture
from .mesh_cycle_charts import draw_surface, pressure_levels
from .panel_grid import AxesChoice, chosen_parts, panels, require_result
from .style import BLUE, FAINT, GREY, INK, SMALL_SIZE, VERMILION, WIDTH
from .tooth_view import ToothView, draw_flank, flank_views, shared_aspect, side_by_side

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

LINE_POINT_COUNT = 17  # along a drawn contact line
FADED_PATH: dict[str, Any] = {"color": GREY, "linewidth": 0.9, "linestyle": (0, (1, 1.5))}
BOUNDARY_SEARCH_LIMIT = 0.25  # distance beyond the common flank, as a fraction, from which the path is moved to it


@dataclass(frozen=True)
class CarryingRange:
    """Range in which one tooth pair carries alone, between the transfers from the pair before and to the next."""

    lines: Array  # (m, 2, LINE_POINT_COUNT), fractions, from transfer to transfer
    path: Array  # (2, m), fractions

    @property
    def outline(self) -> Array:
        """Closed curve (2, k) around the contact lines, as fractions."""
        lines = self.lines
        return np.concatenate([lines[:, :, 0].T, lines[-1], lines[::-1, :, -1].T, lines[0, :, ::-1]], axis=1)


@dataclass(frozen=True)
class ContactPattern:
    """Unloaded contact of a tooth pair on the gear flank, over its whole passage, in fractions of the flank.

    There are several carrying ranges if the pair carries, lets go and carries again.
    """

    lines: Array  # (m, 2, LINE_POINT_COUNT) within the separation, else NaN
    path: Array  # (m, 2)
    carrying: Bools  # (m), true where this pair carries
    ranges: tuple[CarryingRange, ...]


def unloaded_pattern(unloaded: xr.Dataset, splines: FlankSplines) -> ContactPattern:
    """Contact pattern of a result.

    Parameters
    ----------
    unloaded
        The group ``unloaded``.
    splines
        Splines on the gear flank, for the bend of the contact lines.
    """
    pairs = unloaded["pair"].values

    def course(*names: str) -> ToothPassage:
        tables = [unloaded[name].transpose("pair", "mesh_position", ...).values for name in names]
        return tooth_passage(pairs, np.stack(tables, axis=-1))

    ends = course("line_lengthwise", "line_profile")  # (m, end, 2)
    path = course("path_lengthwise", "path_profile")
    path = replace(path, values=on_common_flank(splines, path.values, ends.values))
    error = course("transmission_error")
    carries = (pairs[:, None] == unloaded["carrying_pair"].values).astype(float)
    carrying = (tooth_passage(pairs, carries).values == 1.0) & np.all(np.isfinite(path.values), axis=-1)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], carrying, [False]]).astype(np.int8))).reshape(-1, 2)
    ranges = []
    for start, stop in edges:
        first, last = path.first + start, path.first + stop - 1
        before, after = _transfer(error, first, -1), _transfer(error, last, 1)
        steps = np.concatenate([before, np.arange(first, last + 1), after])
        lines = bent_lines(splines, ends.at(steps))
        lines = lines[np.all(np.isfinite(lines), axis=(1, 2))]  # at an edge a pair may carry without a contact line
        if len(lines):
            ranges.append(CarryingRange(lines, path.at(steps).T))
    return ContactPattern(bent_lines(splines, ends.values), path.values, carrying, tuple(ranges))


def on_common_flank(splines: FlankSplines, path: Array, ends: Array) -> Array:
    """Path of contact (m, 2), points beyond the common flank moved along their contact lines onto its boundary.

    Lines end at (m, end, 2); NaN if none meets the common flank. An edge of the pinion may touch a little beyond it.
    """
    beyond = np.flatnonzero(np.all(np.isfinite(path), axis=-1) & np.all(np.isfinite(ends), axis=(1, 2)))
    if beyond.size:
        beyond = beyond[_outside(splines, path[beyond].T)]
    if beyond.size == 0:
        return path
    direction = (ends[beyond, 1] - ends[beyond, 0]).T
    length = np.linalg.norm(direction, axis=0)
    result = path.copy()
    result[beyond] = np.nan  # unless a point is found
    beyond, direction = beyond[length > 0.0], direction[:, length > 0.0] / length[length > 0.0]
    reach = np.linspace(0.0, BOUNDARY_SEARCH_LIMIT, 65)[1:]
    away = np.stack([reach, -reach], axis=1).ravel()  # ever further, to both sides
    outside = path[beyond].T
    tried = outside[..., None] + direction[..., None] * away
    within = ~_outside(splines, tried)
    first = np.argmax(within, axis=1)
    inside = np.take_along_axis(tried, first[None, :, None], axis=2)[..., 0]
    for _ in range(30):
        middle = 0.5 * (inside + outside)
        good = ~_outside(splines, middle)
        inside, outside = np.where(good, middle, inside), np.where(good, outside, middle)
    hits = np.any(within, axis=1)
    result[beyond[hits]] = inside[:, hits].T
    return result


def _outside(splines: FlankSplines, points: Array) -> Bools:
    """True (...) at points (2, ...) that lie beyond the common flank."""
    beyond_gear = np.any((points < 0.0) | (points > 1.0), axis=0)
    return np.asarray(beyond_gear | (boundary_distance(splines, points) < 0.0))


def _transfer(error: ToothPassage, step: int, direction: int) -> Array:
    """Fractional step beyond the last one of the carrying range at which the next pair takes over; empty if unknown."""
    steps = np.array([step, step + direction])
    ahead = error.at(steps) - error.at(steps - direction * error.per_cycle)
    lead, beyond = ahead[:, 0]
    if not (np.isfinite(lead) and np.isfinite(beyond) and lead <= 0.0 < beyond):
        return np.zeros(0)
    return np.array([step + direction * lead / (lead - beyond)])


def bent_lines(splines: FlankSplines, ends: Array, steps: int = 3) -> Array:
    """Contact lines (m, 2, LINE_POINT_COUNT) between ends (m, end, 2), as fractions.

    Points of the chord are moved along the gradient of the roll angle onto the level of the ends.
    """
    finite = np.all(np.isfinite(ends), axis=(1, 2))
    lines = np.full((ends.shape[0], 2, LINE_POINT_COUNT), np.nan)
    if not np.any(finite):
        return lines
    first, second = np.moveaxis(ends[finite], 0, -1)  # (2, m) each
    along = np.linspace(0.0, 1.0, LINE_POINT_COUNT)
    points = first[..., None] * (1.0 - along) + second[..., None] * along
    at_ends = splines("roll_angle", points[..., [0, -1]])
    level = at_ends[..., :1] * (1.0 - along) + at_ends[..., 1:] * along
    for _ in range(steps):
        slope = np.stack([splines("roll_angle", points, (1, 0)), splines("roll_angle", points, (0, 1))])
        step = (level - splines("roll_angle", points)) * slope / np.sum(slope**2, axis=0)
        points = np.clip(points + step, 0.0, 1.0)
    lines[finite] = np.moveaxis(points, 1, 0)
    return lines


def draw_pattern(
    axes: Axes, view: ToothView, pattern: ContactPattern, *, labels: tuple[bool, bool] = (True, True), path: bool = True
) -> None:
    """Draw a pattern on its flank: contact lines, outlines, and the path of contact unless ``path`` is false."""
    from matplotlib.collections import LineCollection

    draw_flank(axes, view, labels=labels)
    # Lines may run out of the flank by a hair; they end at its edge.
    styles = ((False, FAINT, 0.6, 1.0), (True, BLUE, 0.8, 0.75))
    for carrying, colour, width, alpha in styles:
        chosen = pattern.lines[(pattern.carrying == carrying) & np.isfinite(pattern.lines[:, 0, 0])]
        drawn = [view.in_plane(line).T for line in chosen]
        axes.add_collection(LineCollection(drawn, colors=colour, linewidths=width, alpha=alpha, zorder=2))
    axes.plot(*view.in_plane(pattern.path.T), zorder=3, **FADED_PATH)
    for span in pattern.ranges:
        axes.fill(*view.in_plane(span.outline), facecolor=BLUE, alpha=0.10, edgecolor="none", zorder=1)
        axes.plot(*view.in_plane(span.outline), color=BLUE, linewidth=1.4, zorder=4)
    if path:
        draw_path(axes, view, pattern)


def draw_path(axes: Axes, view: ToothView, pattern: ContactPattern) -> None:
    """Draw the path of contact of the carrying range and its ends."""
    for span in pattern.ranges:
        path = view.in_plane(span.path)
        axes.plot(*path, color="white", linewidth=3.4, zorder=6.5, solid_capstyle="round")
        axes.plot(*path, color=VERMILION, linewidth=1.8, zorder=7, solid_capstyle="round")
        axes.plot(
            *path[:, [0, -1]], linestyle="none", marker="o", markersize=4.5, markerfacecolor="white",
            markeredgecolor=VERMILION, markeredgewidth=1.2, zorder=8,
        )  # fmt: skip


def path_beyond(label: str) -> Line2D:
    """Legend entry of the path of contact outside the carrying range."""
    from matplotlib.lines import Line2D

    return Line2D([], [], label=label, **FADED_PATH)


def legend_below(axes: Axes, entries: list[Line2D], columns: int) -> None:
    """Legend under the axes, without a frame."""
    axes.legend(
        handles=entries, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=columns, fontsize=SMALL_SIZE + 0.5,
        frameon=False, labelcolor=INK, handlelength=2.4, columnspacing=2.0, borderaxespad=4.2,
    )  # fmt: skip


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
    pattern = unloaded_pattern(unloaded, views[0].fields)
    error = CarryingError.of(unloaded, 2.0 * math.pi / tree.attrs["pinion_teeth"])
    printed, region = None, None
    if error.is_known:
        printed = MarkingPrint.of(views[0].fields, error, thickness, DRAWN_GRID)
        region = MarkingPrint.of(views[0].fields, error, thickness).region(views[0].plane)
    surface = None if light is None else pressure_map(light)
    for name, row in zip(names, grid, strict=True):
        for column, (panel, view) in enumerate(zip(row, views, strict=True)):
            left, shown = column == 0, (name == names[-1], column == 0)
            if name == "lines":
                draw_pattern(panel, view, pattern, labels=shown)
                panel_titles(panel, FLANK_NAMES[view.member], "contact lines, path of contact")
                continue
            draw_flank(panel, view, labels=shown)
            if name == "print":
                if region is not None and printed is not None:
                    draw_print(panel, view, printed, region)
                said = "no unloaded contact" if region is None else size_name(region)
                panel_titles(panel, f"marking print, {thickness:g} µm", said if left else "")
            elif light is not None and surface is not None:
                draw_surface(panel, view, surface, pressure_levels(surface.peak if surface.pressure.size else 1.0))
                at = f"light load, {torque_name(float(light['torque']))}"
                panel_titles(panel, at, _light(light) if left else "")
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
