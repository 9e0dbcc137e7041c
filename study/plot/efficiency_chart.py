"""Efficiency chart: power loss over the mesh cycle, and efficiency over every varied operating condition."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ...contact.evaluation.tooth_passage import two_cycles
from ...friction.operation import named_models
from ..report.notes.ranges import TOLD_SHARE, range_notes
from .friction_map_chart import chosen_condition, roughness_name
from .page import BODY_SIZE, GREY, INK, SMALL_SIZE, evenly_chosen, in_print, legend_of_curves, plain_axes
from .panel_grid import OwnAxes, chosen_parts, panels

Array = NDArray[Any]

AXES = {
    "speed": "speed of the pinion [1/min]",
    "torque": "torque at the pinion [N m]",
    "temperature": "oil temperature [°C]",
    "roughness": "RMS roughness [µm]",
}
UNITS = {"speed": "1/min", "torque": "N m", "temperature": "°C", "roughness": "µm"}
PLURALS = {"speed": "speeds", "torque": "torques", "temperature": "temperatures", "roughness": "roughnesses"}
COMPANION = {"speed": "torque", "torque": "speed", "roughness": "temperature", "temperature": "roughness"}
CURVE_COUNT_LIMIT = 5
ROUGHNESS_TICK_LIMIT, TICK_DISTANCE = 6, 0.12  # roughnesses ticked themselves, and their least distance over the axis
MARKED_COUNT_LIMIT = 40  # computed points of a curve that are marked
EFFICIENCY_SPAN_MINIMUM = 0.2  # [%] of the axis; less would exaggerate small differences


def curves(
    axes: Axes, friction: xr.Dataset, along: str, by: str, at: dict[str, float], *, on_page: bool = True
) -> None:
    """Draw the efficiency along one operating condition, a curve for each value of another, the rest as given.

    Marks are computed points, if they are few; open ones are conditions where more than ``TOLD_SHARE`` of the power
    loss lies beyond the range of the formula.
    """
    quantity = 100.0 * friction["efficiency"]
    fixed = {name: int(np.argmax(quantity[name].values == at[name])) for name in at if name not in (along, by)}
    here = quantity.isel(fixed).transpose(by, along)
    order = np.argsort(here[along].values)
    chosen = evenly_chosen(here[by].values, CURVE_COUNT_LIMIT)
    shades = colormaps["viridis"](np.linspace(0.0, 0.82, chosen.size) if chosen.size > 1 else [0.35])
    for index, colour in zip(chosen, shades, strict=True):
        label = value_name(quantity, by, int(index))
        x, y = here[along].values[order], here.values[index][order]
        axes.plot(x, y, color=colour, linewidth=1.6, label=label)
        if order.size > MARKED_COUNT_LIMIT:
            continue
        out = np.zeros(order.size, dtype=bool)
        if "extrapolated_share" in friction:
            out = friction["extrapolated_share"].isel(fixed).transpose(by, along).values[index][order] >= TOLD_SHARE
        axes.plot(x[~out], y[~out], "o", color=colour, markersize=3.5)
        axes.plot(x[out], y[out], "o", color=colour, markersize=3.5, markerfacecolor="white")
    plain_axes(axes)
    low, high = axes.get_ylim()
    more = max(0.0, 0.5 * (EFFICIENCY_SPAN_MINIMUM - (high - low)))
    axes.set_ylim(low - more, high + more)
    axes.set_xlabel(AXES[along], fontsize=SMALL_SIZE + 1, color=INK)
    if along == "roughness":
        name_pairs(axes, quantity)
    legend_of_curves(axes, on_page=on_page, heading=how_many(chosen.size, here.sizes[by], by))


def name_pairs(axes: Axes, quantity: xr.DataArray) -> None:
    """Label an axis of roughnesses with those of both flanks, if they differ."""
    values, indices = np.unique(quantity["roughness"].values, return_index=True)
    names = [roughness_name(quantity, int(index)).removesuffix(" µm") for index in indices]
    if not any("/" in name for name in names):
        return
    label = "quadratic mean of both flanks' RMS roughnesses [µm]"
    if values.size <= ROUGHNESS_TICK_LIMIT and np.all(np.diff(values) > TICK_DISTANCE * np.ptp(values)):
        axes.set_xticks(values, names)
        label = "RMS roughness, pinion/gear where they differ [µm]"
    axes.set_xlabel(label, fontsize=SMALL_SIZE + 1, color=INK)


def value_name(quantity: xr.DataArray | xr.Dataset, condition: str, index: int) -> str:
    """Value of an operating condition with its unit."""
    value = float(quantity[condition].values[index])
    return roughness_name(quantity, index) if condition == "roughness" else f"{value:.4g} {UNITS[condition]}"


def how_many(drawn: int, count: int, condition: str) -> str:
    """Number of values that have a curve; empty if all have one."""
    return "" if drawn == count else f"{drawn} of {count} {PLURALS[condition]}"


def over_the_cycle(axes: Axes, friction: xr.Dataset, at: dict[str, float], *, on_page: bool = True) -> None:
    """Draw the power loss over two mesh cycles as part of the input power, a curve a torque."""
    fixed = {name: int(np.argmax(friction[name].values == at[name])) for name in at if name != "torque"}
    loss = 100.0 * (1.0 - friction["mesh_efficiency"].isel(fixed).transpose("torque", "mesh_position").values)
    torques = friction["torque"].values
    chosen = evenly_chosen(torques, CURVE_COUNT_LIMIT)
    shades = colormaps["viridis"](np.linspace(0.0, 0.82, chosen.size) if chosen.size > 1 else [0.35])
    for index, colour in zip(chosen, shades, strict=True):
        times, values = two_cycles(loss[index])
        axes.plot(times, values, color=colour, linewidth=1.6, label=f"{torques[index]:.4g} N m")
    plain_axes(axes)
    axes.set_xlim(0, 2)
    axes.set_xlabel("mesh cycles (pinion pitches)", fontsize=SMALL_SIZE + 1, color=INK)
    axes.set_ylabel("power loss over input power [%]", fontsize=SMALL_SIZE + 1, color=INK)
    legend_of_curves(axes, on_page=on_page, heading=how_many(chosen.size, torques.size, "torque"))


def draw(tree: xr.DataTree, parts: str | Sequence[str] | None = None, own: OwnAxes = None) -> Figure:
    """Draw the efficiency chart of a result with friction; arguments as of ``friction_figures.efficiency``."""
    friction = tree["friction"].to_dataset()
    at = chosen_condition(friction)
    varied = [name for name in AXES if friction.sizes[name] > 1]
    names = chosen_parts(["cycle", *varied], parts)
    rows, columns = -(-len(names) // 2), min(2, len(names))
    marks = "open marks: 5 % of the power loss or more is beyond the range of the formula"
    beyond = [marks] if bool((friction.get("extrapolated_share", xr.DataArray(0.0)) >= TOLD_SHARE).any()) else []
    note = " · ".join([named_models(friction.attrs), *in_print(range_notes(friction)), *beyond])
    shape, count = (rows, columns), len(names)
    found = panels(tree, "Power loss and efficiency", 2.2 * rows + 0.2, note, shape, own, count=count)
    for axes, name in zip(found.axes, names, strict=True):
        if name == "cycle":
            over_the_cycle(axes, friction, at, on_page=found.on_page)
            title(axes, friction, at, ("torque",))
            continue
        by = COMPANION[name]
        curves(axes, friction, name, by, at, on_page=found.on_page)
        axes.set_ylabel("efficiency [%]", fontsize=SMALL_SIZE + 1, color=INK)
        title(axes, friction, at, (name, by))
    return found.figure


def title(axes: Axes, friction: xr.Dataset, at: dict[str, float], varied: tuple[str, ...]) -> None:
    """Title of a panel: the conditions that do not vary in it."""
    index = {name: int(np.argmax(friction[name].values == at[name])) for name in AXES}
    held = ", ".join(value_name(friction, name, index[name]) for name in AXES if name not in varied)
    axes.set_title(held, loc="left", fontsize=BODY_SIZE - 0.5, color=GREY, pad=3)
