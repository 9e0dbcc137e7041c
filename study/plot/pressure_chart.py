"""Pressure chart: contact pressure on both flanks over the mesh cycle, a row a torque."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation, TriContourSet
from numpy.typing import NDArray

from ...contact.evaluation.pressure_map import PressureMap, pressure_map
from ...contact.solvers import Status
from ..report.notes.edge_load import edge_notes
from ..report.notes.pressure_jumps import jump_notes
from .page import (
    BODY_SIZE,
    GREY,
    INK,
    PANEL_COUNT_LIMIT,
    PRESSURE_MAP,
    SEPARATOR,
    SMALL_SIZE,
    WIDTH,
    in_print,
    plain_bar,
    torque_name,
)
from .panel_grid import OwnAxes, chosen_torques, panels
from .tooth_view import ToothView, draw_flank, shared_aspect, side_by_side

PRESSURE_THRESHOLD = 0.01  # over the greatest pressure; less is not coloured
LEVEL_COUNT = 24


def draw(
    tree: xr.DataTree,
    views: tuple[ToothView, ...],
    torque: float | Sequence[float] | None = None,
    own: OwnAxes = None,
) -> Figure:
    """Draw the pressure chart of a result on its flanks; arguments as of ``contact_figures.pressure``."""
    loaded = tree["loaded"].to_dataset()
    torques = loaded["torque"].values
    chosen = chosen_torques(torques, torque, PANEL_COUNT_LIMIT)
    shown = loaded.isel(torque=chosen)
    maps = [pressure_map(loaded.isel(torque=int(i))) for i in chosen]
    note = "+ peak, dashed: boundary of the common flank"
    note += "" if chosen.size == torques.size else f" · {chosen.size} of {torques.size} torques"
    note = SEPARATOR.join([note, *in_print([*edge_notes(shown), *jump_notes(shown)])])
    # What the axis labels and the colour bar leave of the page's width.
    height = chosen.size * ((WIDTH - 1.6) / len(views) * shared_aspect(views) + 0.27) + 0.35
    names = " and ".join(view.member for view in views)
    heading = f"Contact pressure over the mesh cycle, {names} flank"
    drawn_in = panels(tree, heading, height, note, (chosen.size, len(views)), own)
    figure, grid = drawn_in.figure, drawn_in.axes.reshape(chosen.size, len(views))
    peaks = [surface.peak for surface in maps if np.isfinite(surface.peak)]
    levels = pressure_levels(max(peaks, default=1.0))
    shading = None
    for row, (index, surface) in enumerate(zip(chosen, maps, strict=True)):
        for column, view in enumerate(views):
            axes = grid[row, column]
            draw_flank(axes, view, labels=(row == chosen.size - 1, column == 0))
            drawn = draw_surface(axes, view, surface, levels)
            shading = shading or drawn
            panel_title(axes, f"{torque_name(torques[index])}, {view.member}", surface, loaded.isel(torque=int(index)))
    side_by_side(grid)
    if shading is not None:
        bar = figure.colorbar(shading, ax=list(grid.flat), shrink=0.75, aspect=28, pad=0.015, ticks=MaxNLocator(7))
        plain_bar(bar, "greatest contact pressure [MPa]")
    return figure


def pressure_levels(peak: float) -> NDArray[Any]:
    """Round, evenly spaced levels [MPa] beyond the peak; below the lowest, slightly above zero, nothing is coloured."""
    levels = np.asarray(MaxNLocator(LEVEL_COUNT, steps=[1, 2, 2.5, 5, 10]).tick_values(0.0, max(peak, 1e-3)))
    levels[0] = PRESSURE_THRESHOLD * levels[-1]
    return levels


def draw_surface(axes: Axes, view: ToothView, surface: PressureMap, levels: NDArray[Any]) -> TriContourSet | None:
    """Colour the loaded area and mark the greatest pressure; ``None`` if nothing carries load."""
    if surface.triangles.size == 0 or not surface.peak > levels[0]:
        return None
    points = view.in_plane(surface.points)
    mesh = Triangulation(points[0], points[1], surface.triangles)
    shading = axes.tricontourf(mesh, surface.pressure, levels=levels, cmap=PRESSURE_MAP, zorder=2)
    if np.min(surface.pressure) < levels[0]:
        axes.tricontour(mesh, surface.pressure, levels=levels[:1], colors=INK, linewidths=0.6, zorder=3)
    peak = view.in_plane(surface.peak_point)
    axes.plot(*peak, marker="+", markersize=8, markeredgewidth=2.4, color="white", zorder=8)
    axes.plot(*peak, marker="+", markersize=7, markeredgewidth=1.1, color=INK, zorder=9)
    return shading


def panel_title(axes: Axes, torque: str, surface: PressureMap, at_torque: xr.Dataset) -> None:
    """Title of a panel: torque, greatest pressure and number of missing mesh positions."""
    missing = int(np.sum(at_torque["status"].values != Status.CERTIFIED))
    peak = "no certified solution"
    if missing < at_torque.sizes["mesh_position"]:
        peak = f"peak {surface.peak:.0f} MPa" if surface.peak > 0.0 else "load on sharp edges alone"
    if missing and surface.peak > 0.0:
        peak += f" · {missing} of {at_torque.sizes['mesh_position']} mesh positions missing"
    axes.set_title(torque, loc="left", fontsize=BODY_SIZE, color=INK, weight="bold", pad=3)
    axes.set_title(peak, loc="right", fontsize=SMALL_SIZE + 0.5, color=GREY, pad=3)
