"""Wear chart: depth on both flanks at the end, and what changes over the revolutions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ....geometry.pair.gear_pair import MEMBERS
from ..page import BLUE, BODY_SIZE, INK, SMALL_SIZE, VERMILION, plain_axes, plain_bar, torque_colours, torque_name
from ..panel_grid import OwnAxes, chosen_parts, panels

DEPTH_MAP = "YlOrBr"
OVER_TIME = {
    "largest_depth": "largest wear depth [µm]",
    "peak_to_peak": "transmission error, peak to peak [µrad]",
    "max_pressure": "greatest pressure [MPa]",
}
PARTS = (*MEMBERS, *OVER_TIME)


def draw(history: xr.Dataset, parts: str | Sequence[str] | None = None, own: OwnAxes = None) -> Figure:
    """Draw a history of wear; arguments as of ``study_figures.wear``."""
    names = chosen_parts(PARTS, parts)
    rows, columns = -(-len(names) // 2), min(2, len(names))
    last = float(history["revolutions"][-1])
    note = f"{last:.4g} revolutions of the pinion, {history.sizes['step'] - 1} steps"
    found = panels(xr.DataTree(history), "Wear", 2.3 * rows, note, (rows, columns), own, count=len(names))
    for axes, name in zip(found.axes, names, strict=True):
        if name in MEMBERS:
            _draw_depth(axes, history["wear_depth"].isel(step=-1).sel(member=name), name)
        else:
            _draw_history(axes, history, name)
    return found.figure


def _draw_depth(axes: Axes, depth: xr.DataArray, member: str) -> None:
    """Draw the depth over the flank of a member."""
    values = depth.transpose("profile", "lengthwise").values
    place = 100.0 * depth["lengthwise"].values, 100.0 * depth["profile"].values
    levels = np.asarray(MaxNLocator(12).tick_values(0.0, max(float(np.nanmax(values, initial=0.0)), 1e-9)))
    drawn = axes.contourf(*place, values, levels=levels, cmap=DEPTH_MAP)
    plain_axes(axes)
    axes.grid(False)
    axes.set_xlabel("from the toe [%]", fontsize=SMALL_SIZE + 1, color=INK)
    axes.set_ylabel("from the root [%]", fontsize=SMALL_SIZE + 1, color=INK)
    axes.set_title(f"depth on the {member} [µm]", loc="left", fontsize=BODY_SIZE, color=INK, pad=3)
    figure: Any = axes.get_figure(root=True)
    plain_bar(figure.colorbar(drawn, ax=axes, pad=0.02, ticks=MaxNLocator(6)), "")


def _draw_history(axes: Axes, history: xr.Dataset, name: str) -> None:
    """Draw a number over the revolutions, a line a member or torque."""
    over = history["revolutions"].values
    if name == "largest_depth":
        for member, colour in zip(MEMBERS, (BLUE, VERMILION), strict=True):
            axes.plot(over, history[name].sel(member=member), "o-", color=colour, markersize=3, label=member)
    else:
        torques = history["torque"].values
        for index, colour in enumerate(torque_colours(torques)):
            label = torque_name(float(torques[index]))
            axes.plot(over, history[name].isel(torque=index), "o-", color=colour, markersize=3, label=label)
    plain_axes(axes)
    axes.set_xlim(left=0.0)
    axes.set_xlabel("revolutions of the pinion", fontsize=SMALL_SIZE + 1, color=INK)
    axes.set_title(OVER_TIME[name], loc="left", fontsize=BODY_SIZE, color=INK, pad=3)
    axes.legend(fontsize=SMALL_SIZE, frameon=False, labelcolor=INK)
