"""Time figures: run time against the number of segments within each kind of problem, and work against precision."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, PercentFormatter

from ...plot.page import titled_sheet
from ..statistics.method_statistics import TIMES, headline, methods, of_method, time_of
from ..statistics.run_time_statistics import growth
from ..statistics.work_precision import work_precision
from .figure_style import PANEL_HEIGHT, abscissa, finish, plain_ticks, style
from .time_tables import group_of, size_groups

#: Kinds of problems that are drawn.
GROUP_LIMIT = 4


def draw_growth(dataset: xr.Dataset, problems: Any) -> Figure:
    """Run time of the headline against the number of segments with fitted powers, a panel for each kind of problem."""
    groups = size_groups(problems)[:GROUP_LIMIT]
    named = headline(methods(problems, float(dataset.attrs["time_limit_s"])))
    figure = titled_sheet(
        "Run time",
        f"{TIMES[time_of(dataset)]}, against the number of segments n, within one kind of problem",
        "points: certified problems, cold; lines: their median at each size; n^...: power fitted to the larger sizes",
        PANEL_HEIGHT * len(groups),
    )
    grid = figure.subplots(len(groups), 1, squeeze=False)[:, 0]
    for axes, group in zip(grid, groups, strict=True):
        chosen = problems[group_of(problems) == group]
        for method in named:
            found = of_method(chosen, method)
            size, time = found["size"].to_numpy(dtype=float), found["run_time"].to_numpy(dtype=float)
            known = np.isfinite(time)
            line = style(method[0], problems)
            fit = growth(size, time)
            label = method[0] if fit is None else f"{method[0]}  n^{fit[1]:.2f}".replace("-", "−")
            if not known.any():
                label = f"{method[0]}  none certified"
            axes.plot(size[known], 1e3 * time[known], "o", ms=2.4, mew=0, alpha=0.55, color=line["color"])
            sizes = np.unique(size[known])
            medians = np.array([np.median(time[known & (size == one)]) for one in sizes])
            axes.plot(sizes, 1e3 * medians, label=label, **line)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlim(chosen["size"].min() / 1.2, chosen["size"].max() * 1.2)
        if not axes.dataLim.height > 0.0:  # nothing is certified, or one time alone
            axes.set_ylim(0.1, 100.0)
        plain_ticks(axes.xaxis, np.unique(chosen["size"].to_numpy(dtype=float)))
        plain_ticks(axes.yaxis)
        count = len(chosen.drop_duplicates(["problem_file", "problem"]))
        finish(axes, f"{group}", f"{count} problems", f"{time_of(dataset)} time [ms]")
        abscissa(axes, "number of segments n")
    return figure


def _runs(dataset: xr.Dataset) -> set[tuple[str, float]]:
    """Solvers with the tolerances that a sweep gave them; zero for none."""
    return set(zip(dataset["solver"].values.tolist(), dataset["solver_tolerance"].values.tolist(), strict=True))


def draw_work_precision(dataset: xr.Dataset, problems: Any) -> Figure:
    """Time of the fastest run that reaches a certified accuracy, and the share of problems on which one does."""
    rank = [method[0] for method in headline(methods(problems, float(dataset.attrs["time_limit_s"])))]
    curves = sorted(work_precision(dataset), key=lambda one: rank.index(one.solver))
    count = len(problems.drop_duplicates(["problem_file", "problem"]))
    figure = titled_sheet(
        "Work and precision",
        f"{TIMES[time_of(dataset)]}, for a certified accuracy, over a sweep of the solver's tolerance",
        "median over all problems of the fastest run with that certificate, as far as half of them have one; "
        "scaled problems, cold",
        2.0 * PANEL_HEIGHT,
    )
    upper, lower = figure.subplots(2, 1, sharex=True)
    swept = {solver for solver, tolerance in _runs(dataset) if tolerance > 0.0}
    for curve in curves:
        line = style(curve.solver, problems)
        known = np.isfinite(curve.run_time)
        reach = "" if known.any() else "  none"
        label, times = f"{curve.solver}{reach}", 1e3 * curve.run_time
        if curve.solver in swept:
            upper.plot(curve.accuracy[known], times[known], label=label, **line)
            lower.plot(curve.accuracy, curve.share, **line)
            continue
        # One run at each problem, without a choice between work and precision: its time where half of them reach it.
        point = {**line, "marker": line.get("marker", "o"), "markersize": 5.0, "linestyle": "none"}
        point.pop("dashes", None)
        last = np.flatnonzero(known)[-1:]
        upper.plot(curve.accuracy[last], times[last], label=f"{label} (no tolerance)", **point)
        lower.plot(curve.accuracy[last], curve.share[last], **point)
    for axes in (upper, lower):
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(LogLocator(numticks=99))
        axes.xaxis.set_minor_formatter(NullFormatter())
    upper.set_xlim(2.0 * curves[0].accuracy[0], 0.5 * curves[0].accuracy[-1])
    upper.set_yscale("log")
    if not upper.dataLim.height > 0.0:
        upper.set_ylim(0.1, 100.0)
    plain_ticks(upper.yaxis)
    lower.set_ylim(-0.03, 1.05)
    lower.yaxis.set_major_formatter(PercentFormatter(1.0))
    finish(upper, "time", f"{count} problems", f"median {time_of(dataset)} time [ms]")
    finish(lower, "reach", "", "share of problems")
    abscissa(lower, "certified accuracy (largest violation of a condition)")
    return figure
