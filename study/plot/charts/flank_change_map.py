"""Maps of what changes the ease-off of the gear flank: deviations, and a modification."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from ....contact.lines.contact_lines import boundary_distance
from ....contact.lines.flank_splines import fit
from ..contour_labels import number_lines, outlined
from ..page import BLUE, BODY_SIZE, FAINT, INK, SMALL_SIZE, WIDTH, plain_axes, plain_bar, torque_name
from ..panel_grid import OwnAxes, chosen_parts, panels
from ..tooth_view import ToothView, draw_flank, fine_grid

Array = NDArray[Any]

CHANGE_MAP = "RdBu_r"  # red where the gap grows
LEVEL_COUNT = 12
SPAN_MINIMUM = 0.2  # [um]
COMPARED = {
    "max_line_load": "greatest line load [N/mm]",
    "max_pressure": "greatest pressure [MPa]",
    "max_end_load": "greatest line load at the edges [N/mm]",
    "peak_to_peak": "transmission error, peak to peak [µrad]",
}
PARTS = ("surface", *COMPARED)


def draw_deviations(tree: xr.DataTree, view: ToothView, own: OwnAxes = None) -> Figure:
    """Draw what the deviations of both flanks add to the ease-off."""
    change = tree["ease_off"].to_dataset()["ease_off_change"]
    height = (WIDTH - 1.6) * view.aspect + 0.35
    note = "change of the gap along the normal, of both flanks together"
    found = panels(tree, "Deviations of the flanks, gear flank", height, note, (1, 1), own)
    draw_change(found.axes[0], view, change, "gap added by the deviations [µm]")
    return found.figure


def draw_optimization(
    tree: xr.DataTree, view: ToothView, parts: str | Sequence[str] | None = None, own: OwnAxes = None
) -> Figure:
    """Draw an optimised modification, and what it changes; arguments as of ``study_figures.optimization``."""
    names = chosen_parts(PARTS, parts)
    record = tree["optimization"].to_dataset()
    rows, columns = -(-len(names) // 2), min(2, len(names))
    note = "worst assembly" if record.sizes["assembly"] > 1 else ""
    found = panels(tree, "Optimised ease-off", 2.35 * rows, note, (rows, columns), own, count=len(names))
    for axes, name in zip(found.axes, names, strict=True):
        if name == "surface":
            draw_change(axes, view, tree["modification"].to_dataset()["modification"], "addition to the ease-off [µm]")
        else:
            _draw_stages(axes, record[name].max("assembly"), COMPARED[name])
    return found.figure


def draw_change(axes: Axes, view: ToothView, change: xr.DataArray, label: str) -> None:
    """Draw a change of the ease-off [um] over (lengthwise, profile) on the common flank, with a colour bar."""
    draw_flank(axes, view)
    axes.tick_params(axis="y", pad=15, length=0)  # beyond the word at the toe
    axes.set_title(label, loc="left", fontsize=BODY_SIZE, color=INK, pad=3)
    grid = fine_grid()
    nodes = change.transpose("lengthwise", "profile").values
    values = fit(change["lengthwise"].values, change["profile"].values, {"change": nodes})("change", grid)
    inside = boundary_distance(view.fields, grid) >= 0.0
    if not np.any(inside):
        return
    low, high = (float(extreme(values[inside])) for extreme in (np.min, np.max))
    low, high = min(low, -0.5 * SPAN_MINIMUM), max(high, 0.5 * SPAN_MINIMUM)
    levels = np.asarray(MaxNLocator(LEVEL_COUNT, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high))
    extent = float(np.abs(levels).max())
    x, y = view.in_plane(grid)
    outline = view.outline(view.common)
    style: dict[str, Any] = {"levels": levels, "zorder": 1, "extend": "both"}
    shading = axes.contourf(x, y, values, cmap=CHANGE_MAP, norm=TwoSlopeNorm(0.0, -extent, extent), **style)
    shading.set_clip_path(PathPatch(outline, transform=axes.transData))  # the edge of the shading is smooth
    lines = axes.contour(x, y, np.where(inside, values, np.nan), levels=levels, colors=INK, linewidths=0.5, zorder=2)
    number_lines(axes, lines, outlined(outline))
    figure: Any = axes.get_figure(root=True)
    plain_bar(figure.colorbar(shading, ax=axes, shrink=0.8, pad=0.02, extendfrac=0, ticks=MaxNLocator(7)), "")


def _draw_stages(axes: Axes, values: xr.DataArray, label: str) -> None:
    """Draw bars before and after, a pair a torque."""
    torques = values["torque"].values
    places = np.arange(torques.size)
    for number, (stage, colour) in enumerate((("before", FAINT), ("after", BLUE))):
        heights = np.nan_to_num(values.sel(stage=stage).values)
        axes.bar(places + 0.38 * (number - 0.5), heights, width=0.36, color=colour, label=stage)
    plain_axes(axes)
    axes.set_xticks(places, [torque_name(float(torque)) for torque in torques])
    axes.set_title(label, loc="left", fontsize=BODY_SIZE, color=INK, pad=3)
    axes.legend(fontsize=SMALL_SIZE, frameon=False, labelcolor=INK)
