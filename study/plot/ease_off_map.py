"""Ease-off map: contour lines over the common flank, with the path of contact."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...contact.lines.contact_lines import boundary_distance
from ...core.arrays import Array
from .contact_pattern_chart import number_lines, outlined
from .drawing_style import picture
from .drawn_result import flank_views, require_result
from .page import GREY, INK, VERMILION, WIDTH, label_axes
from .panel_grid import panels
from .pattern_lines import contact_pattern, draw_path, legend_below
from .tooth_view import ToothView, draw_flank, fine_grid

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.contour import QuadContourSet
    from matplotlib.figure import Figure

    from .panel_grid import AxesChoice

SHADES = ("#ffffff", "#d9e6f0", "#a9c8df", "#6fa3c8")
LEVEL_COUNT_LIMIT = 16


def ease_off_map(view: ToothView) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Fractions (2, nt, nh) on a fine grid, ease-off (nt, nh) [um], and truth on the common flank (nt, nh)."""
    grid = fine_grid()
    values = view.fields.evaluate(["ease_off_angle", "lever_arm"], grid)
    gap = 1e3 * values["ease_off_angle"] * values["lever_arm"]
    return grid, gap, boundary_distance(view.fields, grid) >= 0.0


def contour_levels(gap: Array) -> Array:
    """Round, evenly spaced levels [um] that span the ease-off of the common flank (n)."""
    from matplotlib.ticker import MaxNLocator

    largest = max(float(gap.max()), 1e-3) if gap.size else 1.0
    smallest = min(float(gap.min()), 0.0) if gap.size else 0.0
    return np.asarray(MaxNLocator(LEVEL_COUNT_LIMIT, steps=[1, 2, 2.5, 5, 10]).tick_values(smallest, largest))


@picture
def ease_off(tree: xr.DataTree, *, axes: AxesChoice = None) -> Figure | None:
    """Ease-off of the gear flank with the path of contact.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    axes
        One Axes to draw in; a page of its own if left out. With them nothing is returned;
        ``layout="constrained"`` of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> figure = easeoff.plot.ease_off(tree)
    >>> len(figure.axes)
    1
    """
    from matplotlib.lines import Line2D

    require_result(tree)
    view = flank_views(tree, "gear")[0]
    mapped = ease_off_map(view)
    levels = contour_levels(mapped[1][mapped[2]])
    step = levels[1] - levels[0]
    height, note = (WIDTH - 0.8) * view.aspect + 0.63, f"contours every {step:g}\u00a0µm"
    subplots = panels(tree, "Ease-off, gear flank", height, note, (1, 1), axes)
    panel = subplots.axes[0]
    draw_flank(panel, view)
    draw_map(panel, view, mapped, levels)
    pattern = contact_pattern(tree["unloaded"].to_dataset(), view.fields)
    draw_path(panel, view, pattern)
    entries = [
        Line2D([], [], color=INK, linewidth=0.7, label="ease-off [µm], a gap along the normal"),
        Line2D([], [], color=VERMILION, linewidth=1.8, label="path of contact, carrying pair"),
        Line2D([], [], color=GREY, linewidth=0.8, linestyle=(0, (4, 2)), label="boundary of the common flank"),
    ]
    if subplots.on_page:
        legend_below(panel, entries, columns=3)
    else:
        label_axes(panel, title="ease-off [µm]")
    return subplots.figure


def draw_map(
    axes: Axes,
    view: ToothView,
    mapped: tuple[Array, Array, NDArray[np.bool_]],
    levels: Array,
    linewidth: float = 0.7,
    **shades: Any,
) -> QuadContourSet | None:
    """Shade and contour values of the form of ``ease_off_map`` at levels; ``None`` if the common flank is empty."""
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.patches import PathPatch

    grid, values, inside = mapped
    if not np.any(inside):
        return None
    x, y = view.in_plane(grid)
    # The shading reaches beyond the boundary and is cut off there, so that its edge is smooth.
    shades = shades or {"cmap": LinearSegmentedColormap.from_list("ease_off", SHADES)}
    shading = axes.contourf(x, y, values, levels=levels, extend="both", zorder=1, **shades)
    shading.set_clip_path(PathPatch(view.outline(view.common), transform=axes.transData))
    inner = np.where(inside, values, np.nan)
    lines = axes.contour(x, y, inner, levels=levels, colors=INK, linewidths=linewidth, zorder=2)
    number_lines(axes, lines, outlined(view.outline(view.common)))
    return shading
