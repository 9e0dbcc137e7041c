"""Transmission error chart: without load and at every torque, over two mesh cycles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ...contact.evaluation.tooth_passage import CYCLES, pairs_in_view, two_cycles, unloaded_curves
from .page import (
    BLUE,
    BODY_SIZE,
    FAINT,
    GREEN,
    GREY,
    INK,
    SMALL_SIZE,
    VERMILION,
    evenly_chosen,
    legend_of_curves,
    plain_axes,
    torque_colours,
    torque_name,
)
from .panel_grid import OwnAxes, chosen_parts, chosen_torques, panels

Array = NDArray[Any]

#: Panels, with their heights on a page [in].
HEIGHTS = {"unloaded": 2.5, "loaded": 2.3, "about_mean": 2.3, "orders": 2.3}
PARTS = tuple(HEIGHTS)
ORDER_COUNT = 4  # of the orders drawn over torque
NAMED_TORQUE_LIMIT = 8  # in the legend
ORDER_COLOURS, ORDER_MARKS = (BLUE, VERMILION, GREEN, GREY), ("o", "s", "^", "D")
NAMED_STYLE: dict[str, Any] = {"linewidth": 1.6, "zorder": 3}
FADED_STYLE: dict[str, Any] = {"linewidth": 0.5, "alpha": 0.35, "zorder": 2}  # of the torques that are not named


def draw(
    tree: xr.DataTree,
    torque: float | Sequence[float] | None = None,
    parts: str | Sequence[str] | None = None,
    own: OwnAxes = None,
) -> Figure:
    """Draw the transmission error chart of a result; arguments as of ``contact_figures.transmission_error``."""
    unloaded, loaded = tree["unloaded"].to_dataset(), tree["loaded"].to_dataset()
    if torque is not None:
        loaded = loaded.isel(torque=chosen_torques(loaded["torque"].values, torque, 0))
    names = chosen_parts(PARTS, parts)
    note = "rotation of the gear, positive where the gear lags"
    heights = [HEIGHTS[name] for name in names]
    layout: dict[str, Any] = {"height_ratios": heights}
    found = panels(tree, "Transmission error", sum(heights), note, (len(names), 1), own, **layout)
    over_time = [name for name in names if name != "orders"]
    for axes, name in zip(found.axes, names, strict=True):
        if name == "orders":
            draw_orders(axes, loaded, on_page=found.on_page)
            continue
        if name == "unloaded":
            draw_unloaded(axes, unloaded, on_page=found.on_page)
        else:
            draw_loaded(axes, loaded, about_mean=name == "about_mean", on_page=found.on_page)
        axes.set_xlim(0, CYCLES)
        if name == over_time[-1] or not found.on_page:
            axes.set_xlabel("mesh cycles (pinion pitches)", fontsize=SMALL_SIZE + 1, color=INK)
        else:
            axes.tick_params(labelbottom=False)
    if found.on_page:
        found.figure.align_ylabels(found.axes)
    return found.figure


def draw_unloaded(axes: Axes, unloaded: xr.Dataset, *, on_page: bool = True) -> None:
    """Draw the curves of the tooth pairs and their envelope."""
    course, times, lowest = unloaded_curves(unloaded)
    for pair in pairs_in_view(course, CYCLES):
        label = "each tooth pair" if pair == 0 else None
        axes.plot(course.steps / course.per_cycle + pair, course.values, color=FAINT, linewidth=1.1, label=label)
    swing = unloaded.attrs.get("peak_to_peak", np.nan)
    axes.plot(times, lowest, color=BLUE, linewidth=2.0, label=f"pair that carries,\npeak to peak {swing:.1f} µrad")
    finite = lowest[np.isfinite(lowest)]
    if finite.size:
        # The curves of the other pairs rise far above: show how they leave, not where they end.
        extent = max(float(np.ptp(finite)), 1e-3)
        axes.set_ylim(float(finite.min()) - 0.12 * extent, float(finite.max()) + 0.6 * extent)
    _finish(axes, "without load [µrad]", on_page=on_page)


def draw_loaded(axes: Axes, loaded: xr.Dataset, *, about_mean: bool, on_page: bool = True) -> None:
    """Draw the curves of all torques, as they are or about their means."""
    torques = loaded["torque"].values
    error = loaded["transmission_error"].transpose("torque", "mesh_position").values
    named = set(evenly_chosen(torques, NAMED_TORQUE_LIMIT).tolist())
    for index, colour in enumerate(torque_colours(torques)):
        finite = error[index][np.isfinite(error[index])]
        if finite.size == 0:
            continue
        level = float(finite.mean())
        swing = float(loaded["peak_to_peak"].values[index])
        text = f"peak to peak {swing:.1f} µrad" if about_mean else f"mean {level:.0f} µrad"
        if finite.size < error.shape[1]:
            text = f"{error.shape[1] - finite.size} of {error.shape[1]} missing"
        label = f"{torque_name(torques[index])}, {text}" if index in named else None
        times, values = two_cycles(error[index] - level if about_mean else error[index])
        axes.plot(times, values, color=colour, label=label, **(NAMED_STYLE if index in named else FADED_STYLE))
    heading = "" if len(named) == torques.size else f"{len(named)} of {torques.size} torques, the others pale"
    label = "under load, about its mean [µrad]" if about_mean else "under load [µrad]"
    _finish(axes, label, on_page=on_page, heading=heading)


def draw_orders(axes: Axes, loaded: xr.Dataset, *, on_page: bool = True) -> None:
    """Draw the amplitudes of the first orders of mesh frequency over torque, or of all orders at a single torque."""
    orders = loaded["order"].values
    amplitudes = loaded["harmonic"].transpose("torque", "order").values
    torques = loaded["torque"].values
    label = "amplitude of the orders [µrad]"
    if torques.size == 1:
        if np.any(np.isfinite(amplitudes)):
            axes.bar(orders, amplitudes[0], width=0.55, color=BLUE, label=torque_name(float(torques[0])))
            axes.set_xticks(orders)
        _finish(axes, label, on_page=on_page)
        axes.set_xlabel("order of the mesh frequency", fontsize=SMALL_SIZE + 1, color=INK)
        return
    rank = np.argsort(torques)
    for number in range(min(ORDER_COUNT, orders.size)):
        if np.any(np.isfinite(amplitudes[:, number])):
            line: dict[str, Any] = {"color": ORDER_COLOURS[number], "linewidth": 1.4}
            mark: dict[str, Any] = {"marker": ORDER_MARKS[number], "markersize": 3.5}
            axes.plot(torques[rank], amplitudes[rank, number], label=f"order {orders[number]:g}", **line, **mark)
    axes.set_ylim(bottom=0.0)
    _finish(axes, label, on_page=on_page)
    axes.set_xlabel("torque at the pinion [N m]", fontsize=SMALL_SIZE + 1, color=INK)


def _finish(axes: Axes, label: str, *, on_page: bool, heading: str = "") -> None:
    plain_axes(axes)
    axes.set_ylabel(label, fontsize=SMALL_SIZE + 1, color=INK)
    if not on_page:
        axes.set_title("transmission error", loc="left", fontsize=BODY_SIZE, color=INK, pad=3)
    if axes.get_legend_handles_labels()[0]:
        legend_of_curves(axes, on_page=on_page, heading=heading)
    else:
        axes.text(0.5, 0.5, "no certified solution", transform=axes.transAxes, ha="center", color=GREY)
