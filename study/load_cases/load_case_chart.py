"""Load case chart: pattern, greatest pressure, transmission error, power loss and damage by load case."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..plot.page import BLUE, GREY, INK, SMALL_SIZE, VERMILION, evenly_chosen, plain_axes, torque_name
from ..plot.panel_grid import OwnAxes, panels

Array = NDArray[Any]
ROW_COUNT_LIMIT = 30
ROW_HEIGHT = 0.26  # [in]
NAME_LENGTH_LIMIT = 22  # of a load case beside the chart [characters]


def draw(tree: xr.DataTree, own: OwnAxes = None) -> Figure:
    """Draw an analysis over load cases, a row each; ``own`` are axes of the caller, one a panel."""
    numbers = tree["load_cases"].to_dataset()
    count = numbers.sizes["load_case"]
    rows = np.sort(evenly_chosen(np.arange(float(count)), ROW_COUNT_LIMIT))
    shown = numbers.isel(load_case=rows)
    bars = _bars(tree, rows, shown)
    note = "" if rows.size == count else f"{rows.size} of {count} load cases"
    layout: dict[str, Any] = {"sharey": True, "width_ratios": (1.6, *(1.0 for _ in bars))}
    found = panels(tree, "Load cases", ROW_HEIGHT * rows.size + 1.0, note, (1, 1 + len(bars)), own, **layout)
    grid = found.axes
    _draw_patterns(grid[0], shown)
    for axes, (label, values) in zip(grid[1:], bars, strict=True):
        _draw_bars(axes, label, values)
    for axes in grid if not found.on_page else grid[:1]:
        axes.set_ylim(rows.size - 0.4, -0.6)
        axes.set_yticks(np.arange(rows.size), [_name(shown, i) for i in range(rows.size)])
    return found.figure


def _bars(tree: xr.DataTree, rows: Array, shown: xr.Dataset) -> list[tuple[str, Array]]:
    """Labels and values of the panels with bars."""
    bars = [
        ("greatest pressure [MPa]", shown["max_pressure"].values),
        ("peak to peak [µrad]", shown["peak_to_peak"].values),
    ]
    if "mean_power_loss" in shown:
        bars.append(("power loss [W]", shown["mean_power_loss"].values))
    if "duty" in tree.children:
        duty = tree["duty"].to_dataset().isel(load_case=rows)
        exponent = float(duty["damage_exponent"][0])
        bars.append((f"damage to the flank [%], p = {exponent:.3g}", 100.0 * duty["damage_share"].values[:, 0]))
    return bars


def _draw_patterns(axes: Axes, shown: xr.Dataset) -> None:
    """Length of the patterns about their centres, and where the greatest pressure is."""
    plain_axes(axes)
    centre, length = (100.0 * shown[f"pattern_{name}"].values for name in ("centre_lengthwise", "length"))
    rows = np.arange(centre.size)
    axes.barh(rows, length, left=centre - 0.5 * length, height=0.55, color=BLUE, alpha=0.35)
    axes.plot(centre, rows, "o", color=INK, markersize=3.5)
    axes.plot(100.0 * shown["max_pressure_lengthwise"].values, rows, "x", color=VERMILION, markersize=5)
    axes.set_xlim(0.0, 100.0)
    label = "length of the pattern about its centre (dot),\ngreatest pressure (cross) [% from toe]"
    axes.set_xlabel(label, fontsize=SMALL_SIZE, color=INK)
    axes.tick_params(axis="y", labelsize=SMALL_SIZE)


def _draw_bars(axes: Axes, label: str, values: Array) -> None:
    plain_axes(axes)
    axes.barh(np.arange(values.size), np.nan_to_num(values), height=0.55, color=BLUE, alpha=0.75)
    axes.set_xlabel(label.replace(" [", "\n["), fontsize=SMALL_SIZE, color=INK)
    for row in np.flatnonzero(np.isnan(values)):
        axes.text(0.0, float(row), " no value", va="center", fontsize=SMALL_SIZE, color=GREY, style="italic")


def _name(shown: xr.Dataset, row: int) -> str:
    """Name and torque of a load case."""
    name = str(shown["load_case"].values[row])
    short = name if len(name) <= NAME_LENGTH_LIMIT else f"{name[: NAME_LENGTH_LIMIT - 3]}..."
    coast = ", coast" if str(shown["flank"].values[row]) == "coast" else ""
    return f"{short}\n{torque_name(float(shown['torque'].values[row]))}{coast}"
