"""Transmission error chart: without load and at every torque, over two mesh cycles."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ...contact.evaluation.tooth_passage import ToothPassage, envelope, pairs_in_view, tooth_passage
from .page import BLUE, FAINT, GREY, INK, SMALL_SIZE, evenly_chosen, page, plain_axes, torque_colours, torque_name

Array = NDArray[Any]

CYCLES = 2
STEP_POINT_COUNT = 8  # points drawn a mesh position
NAMED_TORQUE_LIMIT = 8  # in the legend
NAMED_STYLE: dict[str, Any] = {"linewidth": 1.6, "zorder": 3}
FADED_STYLE: dict[str, Any] = {"linewidth": 0.5, "alpha": 0.35, "zorder": 2}  # of the torques that are not named


def draw(tree: xr.DataTree) -> Figure:
    """Draw the transmission error chart of a result."""
    unloaded, loaded = tree["unloaded"].to_dataset(), tree["loaded"].to_dataset()
    figure = page(tree, "Transmission error", 7.2, "rotation of the gear, positive where the gear lags")
    panels = figure.subplots(3, 1, sharex=True, height_ratios=[1.1, 1.0, 1.0])
    draw_unloaded(panels[0], unloaded)
    draw_loaded(panels[1], loaded, about_mean=False)
    draw_loaded(panels[2], loaded, about_mean=True)
    panels[2].set_xlabel("mesh cycles (pinion pitches)", fontsize=SMALL_SIZE + 1, color=INK)
    panels[2].set_xlim(0, CYCLES)
    figure.align_ylabels(panels)
    return figure


def two_cycles(values: Array, cycles: int = CYCLES) -> tuple[Array, Array]:
    """Times in cycles, and the values (n) of a cycle repeated, with the first one at the end."""
    count = values.size
    return np.arange(cycles * count + 1) / count, np.append(np.tile(values, cycles), values[:1])


def unloaded_curves(unloaded: xr.Dataset) -> tuple[ToothPassage, Array, Array]:
    """ToothPassage of a tooth pair [urad], and times in cycles with the envelope over all pairs [urad]."""
    course = tooth_passage(
        unloaded["pair"].values, unloaded["transmission_error"].transpose("pair", "mesh_position").values
    )
    times = np.arange(CYCLES * STEP_POINT_COUNT * course.per_cycle + 1) / (STEP_POINT_COUNT * course.per_cycle)
    return course, times, envelope(course, times)


def draw_unloaded(axes: Axes, unloaded: xr.Dataset) -> None:
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
    _finish(axes, "without load [µrad]")


def draw_loaded(axes: Axes, loaded: xr.Dataset, *, about_mean: bool) -> None:
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
    _finish(axes, "under load, about its mean [µrad]" if about_mean else "under load [µrad]", heading)


def _finish(axes: Axes, label: str, heading: str = "") -> None:
    plain_axes(axes)
    axes.set_ylabel(label, fontsize=SMALL_SIZE + 1, color=INK)
    if axes.get_legend_handles_labels()[0]:
        legend = axes.legend(
            fontsize=SMALL_SIZE, frameon=False, labelcolor=INK, loc="center left", bbox_to_anchor=(1.0, 0.5),
            handlelength=1.6, borderaxespad=0.6, title=heading or None, title_fontsize=SMALL_SIZE, alignment="left",
        )  # fmt: skip
        legend.get_title().set_color(GREY)
    else:
        axes.text(0.5, 0.5, "no certified solution", transform=axes.transAxes, ha="center", color=GREY)
