"""Load share chart: share of the torque that each tooth pair carries, over two mesh cycles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator, PercentFormatter
from numpy.typing import NDArray

from ...contact.evaluation.tooth_passage import CYCLES, ToothPassage, pairs_in_view, tooth_passage
from .page import (
    BLUE,
    BODY_SIZE,
    GREEN,
    GREY,
    INK,
    PANEL_COUNT_LIMIT,
    SMALL_SIZE,
    VERMILION,
    plain_axes,
    torque_name,
)
from .panel_grid import OwnAxes, chosen_torques, panels

Array = NDArray[Any]

NAME_WIDTH = 0.15  # of a pair's name [cycles]
COLOURS = (BLUE, VERMILION, GREEN)


def share_passage(at_torque: xr.Dataset) -> ToothPassage:
    """Share of the torque of one tooth pair over its passage, NaN outside contact.

    The last step without load before and after contact is kept as zero, so that a curve starts and ends there.
    """
    course = tooth_passage(at_torque["pair"].values, at_torque["load_share"].transpose("pair", "mesh_position").values)
    share = course.values
    loaded = share > 0.0
    beside = loaded.copy()
    beside[1:] |= loaded[:-1]
    beside[:-1] |= loaded[1:]
    return ToothPassage(course.first, course.per_cycle, np.where(beside, share, np.nan))


def mean_pairs_in_contact(at_torque: xr.Dataset) -> float:
    """Tooth pairs under load at the same time, on average over the mesh cycle; NaN if a position has no solution."""
    share = at_torque["load_share"].transpose("pair", "mesh_position").values
    if np.any(np.all(np.isnan(share), axis=0)):
        return float("nan")
    return float(np.mean(np.sum(share > 0.0, axis=0)))


def draw(tree: xr.DataTree, torque: float | Sequence[float] | None = None, own: OwnAxes = None) -> Figure:
    """Draw the load share chart of a result; arguments as of ``contact_figures.load_sharing``."""
    loaded = tree["loaded"].to_dataset()
    torques = loaded["torque"].values
    chosen = chosen_torques(torques, torque, PANEL_COUNT_LIMIT)
    columns = 1 if chosen.size <= 3 else 2
    rows = -(-chosen.size // columns)
    note = "" if chosen.size == torques.size else f"{chosen.size} of {torques.size} torques"
    layout = {"count": chosen.size, "sharex": True, "sharey": True}
    heading = "Load sharing between tooth pairs"
    found = panels(tree, heading, 1.75 * rows + 0.4, note, (rows, columns), own, **layout)
    for number, (axes, index) in enumerate(zip(found.axes, chosen, strict=True)):
        draw_shares(axes, loaded.isel(torque=int(index)), torque_name(torques[index]), named=number == 0)
        last, first = number + columns >= chosen.size, number % columns == 0
        if last or not found.on_page:
            axes.set_xlabel("mesh cycles (pinion pitches)", fontsize=SMALL_SIZE + 1, color=INK)
            axes.tick_params(labelbottom=True)
        if first or not found.on_page:
            axes.set_ylabel("share of the torque", fontsize=SMALL_SIZE + 1, color=INK)
    return found.figure


def draw_shares(axes: Axes, at_torque: xr.Dataset, title: str, *, named: bool) -> None:
    """Draw the curves of the tooth pairs at one torque, with their numbers if ``named``."""
    course = share_passage(at_torque)
    for pair in pairs_in_view(course, CYCLES):
        times = course.steps / course.per_cycle + pair
        colour = COLOURS[pair % len(COLOURS)]
        axes.fill_between(times, 0.0, course.values, color=colour, alpha=0.10, linewidth=0)
        axes.plot(times, course.values, color=colour, linewidth=1.6)
        if named:
            _name(axes, pair, times, course.values, colour)
    plain_axes(axes)
    axes.set_xlim(0, CYCLES)
    axes.set_ylim(0, 1.05)
    axes.xaxis.set_major_locator(MultipleLocator(0.5))
    axes.yaxis.set_major_locator(MultipleLocator(0.25))
    axes.yaxis.set_major_formatter(PercentFormatter(1.0))
    axes.set_title(title, loc="left", fontsize=BODY_SIZE, color=INK, weight="bold", pad=3)
    # Older results lack the contact ratio.
    pairs = float(at_torque["contact_ratio"]) if "contact_ratio" in at_torque else mean_pairs_in_contact(at_torque)
    missing = "some mesh positions missing" if np.any(np.isfinite(course.values)) else "no certified solution"
    text = f"contact ratio {pairs:.2f}" if np.isfinite(pairs) else missing
    axes.set_title(text, loc="right", fontsize=SMALL_SIZE + 0.5, color=GREY, pad=3)


def _name(axes: Axes, pair: int, times: Array, share: Array, colour: str) -> None:
    """Write a pair's number under the crest of its curve if it fits."""
    seen = np.isfinite(share) & (times >= 0.0) & (times <= CYCLES)
    if not np.any(seen):
        return
    height = float(np.max(share[seen]))
    crest = times[seen][share[seen] >= 0.9 * height]
    if height >= 0.5 and np.ptp(crest) >= NAME_WIDTH:
        text = f"pair {pair}".replace("-", "−")
        axes.text(crest.mean(), 0.9 * height - 0.02, text, ha="center", va="top", fontsize=SMALL_SIZE, color=colour)
