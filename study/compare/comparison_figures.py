"""Comparison figures: performance profile, and run time against the number of segments."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter, PercentFormatter
from numpy.typing import NDArray

from ..plot.page import BODY_SIZE, GREY, INK, SMALL_SIZE, plain_axes, save, titled_sheet
from .attempt import SETTINGS
from .comparison_statistics import (
    METHOD_COLUMNS,
    PROBLEM_COLUMNS,
    by_problem,
    growth,
    methods,
    of_method,
    performance_profile,
)

#: Okabe and Ito's colours without yellow, which is too faint for lines; the first is for the native solver.
COLOURS = ("#222222", "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
DASHES = ((), (5, 1.5), (1.5, 1.2))

PANEL_HEIGHT = 2.9  # [in]
SIZE_TICK_LIMIT, TICK_DISTANCE = 8, 0.05  # sizes that are ticked themselves, and their least distance over the axis
ROUND_NUMBERS = ((1.0, 2.0, 5.0), (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0))  # ticks of a decade, and of less

Array = NDArray[Any]
Method = tuple[str, str, str]


def write_figures(dataset: xr.Dataset, folder: Path) -> list[tuple[Path, str]]:
    """Draw the figures; returns the path and caption of each.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    problems = by_problem(dataset)
    pictures = (("performance_profile.png", draw_profiles), ("run_time.png", draw_growth))
    return [
        (save(draw(dataset, problems), folder / name), caption)
        for (name, draw), caption in zip(pictures, ("Performance profile", "Run time against size"), strict=True)
    ]


def draw_profiles(dataset: xr.Dataset, problems: Any) -> Figure:
    """Share of problems that each method solves within a factor of the fastest, a panel for each settings."""
    panels = _panels(problems)
    note = f"solved: certified to {dataset.attrs['tolerance']:g}; cold starts only"
    figure = titled_sheet(
        "Performance profile",
        "share of problems solved within a factor of the fastest",
        note,
        PANEL_HEIGHT * len(panels),
    )
    grid = figure.subplots(len(panels), 1, squeeze=False)[:, 0]
    for axes, (settings, named) in zip(grid, panels, strict=True):
        # Not a pivot table: that would have a row for every number in every file.
        table = problems.set_index([*PROBLEM_COLUMNS, *METHOD_COLUMNS])["run_time"].unstack(METHOD_COLUMNS)
        named = [method for method in named if method[2] == "cold"]  # not every problem has a warm start
        compared = table[named]
        factor, share = performance_profile(compared.to_numpy(dtype=float).T)
        right = max(2.0, 1.15 * factor[-1])
        for method, curve in zip(named, share, strict=True):
            x, y = np.append(factor, right), np.append(curve, curve[-1])
            axes.step(x, y, where="post", label=_name(method), **_style(method, problems))
        axes.set_xscale("log")
        axes.set_xlim(1.0, right)
        axes.set_ylim(-0.02, 1.03)
        axes.yaxis.set_major_formatter(PercentFormatter(1.0))
        _plain_ticks(axes.xaxis)
        _finish(axes, settings, f"{len(compared)} problems", "share solved")
        axes.set_xlabel("run time over that of the fastest", fontsize=SMALL_SIZE + 1, color=INK)
    return figure


def draw_growth(dataset: xr.Dataset, problems: Any) -> Figure:
    """Run time against the number of segments with fitted powers, a panel for each settings."""
    panels = _panels(problems)
    note = "points: certified problems; lines: their median at each size; n^...: power fitted to the larger sizes"
    figure = titled_sheet(
        "Run time", "wall time of the whole call against the number of segments n", note, PANEL_HEIGHT * len(panels)
    )
    grid = figure.subplots(len(panels), 1, squeeze=False, sharex=True)[:, 0]
    for axes, (settings, named) in zip(grid, panels, strict=True):
        for method in named:
            found = of_method(problems, method)
            size, time = found["size"].to_numpy(dtype=float), found["run_time"].to_numpy(dtype=float)
            known = np.isfinite(time)
            style = _style(method, problems)
            fit = growth(size, time)
            label = _name(method) if fit is None else f"{_name(method)}  n^{fit[1]:.2f}".replace("-", "−")
            if not known.any():
                label = f"{_name(method)}  none certified"
            axes.plot(size[known], 1e3 * time[known], "o", ms=2.4, mew=0, alpha=0.55, color=style["color"])
            sizes = np.unique(size[known])
            medians = np.array([np.median(time[known & (size == one)]) for one in sizes])
            axes.plot(sizes, 1e3 * medians, label=label, **style)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlim(problems["size"].min() / 1.2, problems["size"].max() * 1.2)
        if not axes.dataLim.height > 0.0:  # nothing is certified, or one time alone
            axes.set_ylim(0.1, 100.0)
        _plain_ticks(axes.xaxis, np.unique(problems["size"].to_numpy(dtype=float)))
        _plain_ticks(axes.yaxis)
        _finish(axes, settings, "", "run time [ms]")
    grid[-1].set_xlabel("number of segments n", fontsize=SMALL_SIZE + 1, color=INK)
    return figure


def _panels(problems: Any) -> list[tuple[str, list[Method]]]:
    """Settings and methods of each panel; the native solver is in all of them."""
    named = methods(problems)
    used = [name for name in SETTINGS if any(settings == name for _, settings, _ in named)]
    return [(name, [m for m in named if m[1] == name or m[0] == "native"]) for name in used]


def _finish(axes: Axes, settings: str, right: str, label: str) -> None:
    plain_axes(axes)
    axes.tick_params(which="minor", length=1.5, width=0.5, colors=GREY)
    axes.set_title(f"{settings}: {SETTINGS[settings]}", loc="left", fontsize=BODY_SIZE, color=INK, pad=3)
    axes.set_title(right, loc="right", fontsize=SMALL_SIZE + 0.5, color=GREY, pad=3)
    axes.set_ylabel(label, fontsize=SMALL_SIZE + 1, color=INK)
    axes.legend(
        loc="center left",
        bbox_to_anchor=(1.01, 0.5),
        fontsize=SMALL_SIZE,
        frameon=False,
        labelcolor=INK,
        handlelength=2.6,
    )


def _plain_ticks(axis: Axis, values: Array | None = None) -> None:
    """Plain numbers on a logarithmic axis: the values themselves if they are few, otherwise round ones."""
    low, high = axis.get_view_interval()
    few = (
        values is not None
        and values.size <= SIZE_TICK_LIMIT
        and np.all(np.diff(np.log(values)) > TICK_DISTANCE * np.log(high / low))
    )
    for subs in ROUND_NUMBERS:
        ticks = np.outer(10.0 ** np.arange(-9.0, 10.0), subs)
        if np.count_nonzero((ticks >= low) & (ticks <= high)) > 1:
            break
    axis.set_major_locator(FixedLocator(values.tolist()) if few and values is not None else LogLocator(subs=subs))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def _style(method: Method, problems: Any) -> dict[str, Any]:
    """Line style: a colour a solver, dashes where the colours repeat and for warm starts."""
    solvers = [name for name in dict.fromkeys(problems["solver"]) if name != "native"]
    if method[0] == "native":
        return {"color": COLOURS[0], "linewidth": 1.6, "dashes": DASHES[0 if method[2] == "cold" else 2]}
    number = solvers.index(method[0])
    own = COLOURS[1:]
    return {"color": own[number % len(own)], "linewidth": 1.3, "dashes": DASHES[number // len(own) % len(DASHES)]}


def _name(method: Method) -> str:
    return method[0] if method[2] == "cold" else f"{method[0]}, {method[2]}"
