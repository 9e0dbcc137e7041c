"""Draw a worked design: ease-off and pressure on the gear, transmission error before and after optimisation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from dissertation_figures import title
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from easeoff.contact.evaluation.pressure_map import pressure_map
from easeoff.contact.evaluation.tooth_passage import two_cycles
from easeoff.study.plot.axes_style import plain_axes, plain_bar
from easeoff.study.plot.mesh_cycle_charts import draw_surface, pressure_levels
from easeoff.study.plot.page import sheet
from easeoff.study.plot.style import BLUE, BODY_SIZE, GREEN, SMALL_SIZE, VERMILION, WIDTH
from easeoff.study.plot.tooth_view import ToothView, draw_flank, tooth_view
from easeoff.study.plot.topography_chart import contour_levels, draw_map, ease_off_map

CHART_HEIGHT = 2.1  # [in]
COLOURS = (BLUE, GREEN, VERMILION, "#CC79A7")


def draw(results: Mapping[str, xr.DataTree], torque: float) -> Figure:
    """Ease-off, pressure at a torque [N m] and transmission error of results by their names."""
    views = [tooth_view(tree) for tree in results.values()]
    rows = -(-len(results) // 2)
    height = rows * ((WIDTH - 1.6) / 2.0 * max(view.aspect for view in views) + 0.3)
    figure = sheet(2 * height + CHART_HEIGHT)
    parts: Any = figure.subfigures(3, 1, height_ratios=[height, height, CHART_HEIGHT])
    _ease_offs(parts[0].subplots(rows, 2, squeeze=False), results)
    _pressures(parts[1], parts[1].subplots(rows, 2, squeeze=False), results, torque)
    left, right = parts[2].subplots(1, 2)
    _curves(left, results, torque)
    _levels(right, results)
    return figure


def _ease_offs(grid: NDArray[Any], results: Mapping[str, xr.DataTree]) -> None:
    """Ease-off of the gear flanks, with the same contour lines."""
    views = [tooth_view(tree) for tree in results.values()]
    maps = [ease_off_map(view) for view in views]
    levels = contour_levels(np.concatenate([gap[inside] for _, gap, inside in maps]))
    for axes, name, view, values in zip(grid.flat, results, views, maps, strict=False):
        _flank(axes, view)
        draw_map(axes, view, values, levels)
        title(axes, f"{name}: ease-off", "µm, on the gear flank")
    _hide(grid, len(results))


def _pressures(figure: SubFigure, grid: NDArray[Any], results: Mapping[str, xr.DataTree], torque: float) -> None:
    """Greatest pressure over the mesh cycle on the gear flanks, in the same colours."""
    surfaces = [pressure_map(tree["loaded"].to_dataset().sel(torque=torque)) for tree in results.values()]
    levels = pressure_levels(max(surface.peak for surface in surfaces))
    shading = None
    for axes, (name, tree), surface in zip(grid.flat, results.items(), surfaces, strict=False):
        view = tooth_view(tree)
        _flank(axes, view)
        shading = draw_surface(axes, view, surface, levels) or shading
        title(axes, f"{name}: pressure", f"{torque:g} N m, peak {surface.peak:.0f} MPa")
    _hide(grid, len(results))
    if shading is not None:
        bar = figure.colorbar(shading, ax=list(grid.flat), shrink=0.8, pad=0.015, ticks=MaxNLocator(6))
        plain_bar(bar, "MPa")


def _flank(axes: Axes, view: ToothView) -> None:
    """Outline of a flank without scales."""
    draw_flank(axes, view, labels=(False, False))
    axes.tick_params(length=0)


def _hide(grid: NDArray[Any], used: int) -> None:
    for axes in grid.flat[used:]:
        axes.set_axis_off()


def _curves(axes: Axes, results: Mapping[str, xr.DataTree], torque: float) -> None:
    """Transmission error about its mean over two mesh cycles."""
    for (name, tree), colour in zip(results.items(), COLOURS, strict=False):
        loaded = tree["loaded"].to_dataset().sel(torque=torque)
        error = loaded["transmission_error"].values
        axes.plot(*two_cycles(error - error.mean()), color=colour, label=name)
    title(axes, "transmission error", f"{torque:g} N m")
    _named(axes, "mesh cycles", "about its mean [µrad]")


def _levels(axes: Axes, results: Mapping[str, xr.DataTree]) -> None:
    """Peak to peak over the torque."""
    for (name, tree), colour in zip(results.items(), COLOURS, strict=False):
        loaded = tree["loaded"].to_dataset()
        axes.plot(loaded["torque"], loaded["peak_to_peak"], "o-", color=colour, markersize=4, label=name)
    title(axes, "peak to peak over the torque")
    _named(axes, "torque at the pinion [N m]", "peak to peak [µrad]")
    axes.set_ylim(bottom=0.0)
    axes.legend(fontsize=SMALL_SIZE, frameon=False)


def _named(axes: Axes, across: str, upwards: str) -> None:
    plain_axes(axes)
    axes.set_xlabel(across, fontsize=BODY_SIZE)
    axes.set_ylabel(upwards, fontsize=BODY_SIZE)
