"""Ease-off map: contour lines over the common flank, with the path of contact."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from ...contact.lines.contact_lines import boundary_distance
from ...core.arrays import Array
from .contact_pattern_chart import number_lines, outlined
from .page import GREY, INK, VERMILION, WIDTH, label_axes
from .panel_grid import OwnAxes, panels
from .pattern_lines import contact_pattern, draw_path, legend_below
from .tooth_view import ToothView, draw_flank, fine_grid

SHADES = LinearSegmentedColormap.from_list("ease_off", ["#ffffff", "#d9e6f0", "#a9c8df", "#6fa3c8"])
LEVEL_COUNT_LIMIT = 16


def ease_off_map(view: ToothView) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Fractions (2, nt, nh) on a fine grid, ease-off (nt, nh) [um], and truth on the common flank (nt, nh)."""
    grid = fine_grid()
    values = view.fields.evaluate(["ease_off_angle", "lever_arm"], grid)
    gap = 1e3 * values["ease_off_angle"] * values["lever_arm"]
    return grid, gap, boundary_distance(view.fields, grid) >= 0.0


def contour_levels(gap: Array) -> Array:
    """Round, evenly spaced levels [um] that span the ease-off of the common flank (n)."""
    largest = max(float(gap.max()), 1e-3) if gap.size else 1.0
    smallest = min(float(gap.min()), 0.0) if gap.size else 0.0
    return np.asarray(MaxNLocator(LEVEL_COUNT_LIMIT, steps=[1, 2, 2.5, 5, 10]).tick_values(smallest, largest))


def draw(tree: xr.DataTree, view: ToothView, own: OwnAxes = None) -> Figure:
    """Draw the ease-off map of a result, on a page or on one Axes of the caller."""
    mapped = ease_off_map(view)
    levels = contour_levels(mapped[1][mapped[2]])
    step = levels[1] - levels[0]
    height, note = (WIDTH - 0.8) * view.aspect + 0.63, f"contours every {step:g}\u00a0µm"
    subplots = panels(tree, "Ease-off, gear flank", height, note, (1, 1), own)
    axes = subplots.axes[0]
    draw_flank(axes, view)
    draw_map(axes, view, mapped, levels)
    pattern = contact_pattern(tree["unloaded"].to_dataset(), view.fields)
    draw_path(axes, view, pattern)
    entries = [
        Line2D([], [], color=INK, linewidth=0.7, label="ease-off [µm], a gap along the normal"),
        Line2D([], [], color=VERMILION, linewidth=1.8, label="path of contact, carrying pair"),
        Line2D([], [], color=GREY, linewidth=0.8, linestyle=(0, (4, 2)), label="boundary of the common flank"),
    ]
    if subplots.on_page:
        legend_below(axes, entries, columns=3)
    else:
        label_axes(axes, title="ease-off [µm]")
    return subplots.figure


def draw_map(
    axes: Axes, view: ToothView, mapped: tuple[Array, Array, NDArray[np.bool_]], levels: Array
) -> QuadContourSet | None:
    """Shade and contour an ease-off of ``ease_off_map`` at levels [um]; ``None`` if the common flank is empty."""
    grid, gap, inside = mapped
    if not np.any(inside):
        return None
    x, y = view.in_plane(grid)
    # The shading reaches beyond the boundary and is cut off there, so that its edge is smooth.
    shading = axes.contourf(x, y, gap, levels=levels, cmap=SHADES, extend="both", zorder=1)
    shading.set_clip_path(PathPatch(view.outline(view.common), transform=axes.transData))
    inner = np.where(inside, gap, np.nan)
    lines = axes.contour(x, y, inner, levels=levels, colors=INK, linewidths=0.7, zorder=2)
    number_lines(axes, lines, outlined(view.outline(view.common)))
    return shading
