"""Chart of a front: two objectives, the start, and fronts of other methods beside it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..page import BLUE, BODY_SIZE, FAINT, INK, SMALL_SIZE, plain_axes
from ..panel_grid import OwnAxes, panels

Array = NDArray[Any]

HEIGHT = 4.2  # [in]
MARKERS = "sd^v"
PRINTED = {"urad": "µrad", "um": "µm"}


def draw_front(tree: xr.DataTree, others: Mapping[str, Array], own: OwnAxes = None) -> Figure:
    """Draw a front; arguments as of ``study_figures.front``."""
    front, record = tree["front"].to_dataset(), tree["optimal_settings"].to_dataset()
    names = [str(name) for name in front["objective"].values]
    values = front["front_value"].transpose("point", "objective").values
    found = panels(tree, "Front of two objectives", HEIGHT, "every point analysed, settings rounded", (1, 1), own)
    axes = found.axes[0]
    for (label, points), marker in zip(others.items(), MARKERS * len(others), strict=False):
        axes.plot(*np.asarray(points, dtype=float).T, marker, color=FAINT, markersize=4.0, label=label)
    axes.plot(*values.T, "o-", color=BLUE, linewidth=1.0, markersize=4.5, label="front")
    chosen = int(front.attrs["chosen_point"])
    axes.plot(*values[chosen], "o", color=BLUE, markersize=8.0, fillstyle="none", label="in this result")
    axes.plot(*record["objective_start"].values, "x", color=INK, markersize=7.0, label="start")
    plain_axes(axes)
    units = [PRINTED.get(unit, unit) for unit in front["objective_units"].values.tolist()]
    axes.set_xlabel(f"{names[0]} [{units[0]}]", fontsize=BODY_SIZE, color=INK, parse_math=False)
    axes.set_ylabel(f"{names[1]} [{units[1]}]", fontsize=BODY_SIZE, color=INK, parse_math=False)
    axes.legend(fontsize=SMALL_SIZE, frameon=False, labelcolor=INK)
    return found.figure
