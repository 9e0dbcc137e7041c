"""Contact pattern chart: contact lines, marking print and pattern at light load, on both flanks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from ...contact.evaluation.carrying_error import CarryingError
from ...contact.evaluation.marking_print import FlankRegion, MarkingPrint
from ...contact.evaluation.pressure_map import pressure_map
from ...contact.solvers import Status
from .page import (
    BLUE,
    BODY_SIZE,
    FAINT,
    GREY,
    INK,
    SMALL_SIZE,
    VERMILION,
    WIDTH,
    legend_at_foot,
    torque_name,
)
from .panel_grid import OwnAxes, chosen_parts, panels
from .pattern_lines import contact_pattern, draw_pattern, path_beyond
from .pressure_chart import draw_surface, pressure_levels
from .tooth_view import ToothView, draw_flank, shared_aspect, side_by_side

Array = NDArray[Any]
FLANK_NAMES = {"gear": "gear flank", "pinion": "pinion flank"}
COMPOUND = "#7FB2D6"  # colour of the marking compound
PARTS = ("lines", "print", "light_load")
LEGEND_HEIGHT = 0.62  # [in]
DRAWN_GRID = (481, 241)  # points of a drawn print along the face and the profile
CENTRE_STYLE: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 3.5, "color": INK}


def draw(
    tree: xr.DataTree,
    views: tuple[ToothView, ...],
    marking: float | None = None,
    parts: str | Sequence[str] | None = None,
    own: OwnAxes = None,
) -> Figure:
    """Draw the contact pattern of a result; arguments as of ``contact_figures.contact_pattern``."""
    unloaded = tree["unloaded"].to_dataset()
    separation = float(unloaded.attrs.get("separation", float("nan")))
    thickness = separation if marking is None else marking
    light = tree["light_load"].to_dataset().isel(torque=0) if "light_load" in tree.children else None
    names = chosen_parts(PARTS if light is not None else PARTS[:2], parts)
    height = len(names) * ((WIDTH - 0.9) / len(views) * shared_aspect(views) + 0.28) + 0.35 + LEGEND_HEIGHT
    note = f"contact lines where the gap is within {separation:g} µm · toe left, tip at the top"
    if light is not None and math.isfinite(float(light["max_pressure"])) and "light_load" in names:
        note += f" · light load: yellow to dark red, 0 to {float(light['max_pressure']):.0f} MPa"
    found = panels(tree, "Contact pattern", height, note, (len(names), len(views)), own)
    grid = found.axes.reshape(len(names), len(views))
    rows = dict(zip(names, grid, strict=True))
    pattern = contact_pattern(unloaded, views[0].fields)
    error = CarryingError.of(unloaded, 2.0 * math.pi / tree.attrs["pinion_teeth"])
    printed, region = None, None
    if error.is_known:
        printed = MarkingPrint.of(views[0].fields, error, thickness, DRAWN_GRID)
        region = MarkingPrint.of(views[0].fields, error, thickness).region(views[0].plane)
    surface = None if light is None else pressure_map(light)
    for column, view in enumerate(views):
        left = column == 0
        if "lines" in rows:
            axes, shown = rows["lines"][column], (names[-1] == "lines", left)
            draw_pattern(axes, view, pattern, labels=shown)
            _title(axes, FLANK_NAMES[view.member], "contact lines, path of contact")
        if "print" in rows:
            axes, shown = rows["print"][column], (names[-1] == "print", left)
            draw_flank(axes, view, labels=shown)
            if region is not None and printed is not None:
                draw_print(axes, view, printed, region)
            said = "no unloaded contact" if region is None else size_name(region)
            _title(axes, f"marking print, {thickness:g} µm", said if left else "")
        if light is not None and surface is not None and "light_load" in rows:
            axes, shown = rows["light_load"][column], (names[-1] == "light_load", left)
            draw_flank(axes, view, labels=shown)
            draw_surface(axes, view, surface, pressure_levels(surface.peak if surface.pressure.size else 1.0))
            _title(axes, f"light load, {torque_name(float(light['torque']))}", _light(light) if left else "")
    side_by_side(grid)
    if found.on_page:
        legend_at_foot(found.figure, _entries(), LEGEND_HEIGHT)
    return found.figure


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


def _title(axes: Axes, name: str, said: str) -> None:
    axes.set_title(name, loc="left", fontsize=BODY_SIZE, color=INK, weight="bold", pad=3)
    axes.set_title(said, loc="right", fontsize=SMALL_SIZE + 0.5, color=GREY, pad=3)


def _entries() -> list[Any]:
    """Entries of the legend."""
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
