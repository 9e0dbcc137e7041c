"""Comparison figures, each as PNG, PDF and SVG.

Profiles are performance and data profiles, and pairs of solvers; times are run time against the number of segments
within each kind of problem, and work against precision. All have a colour a solver, legends ordered by merit, and plain
logarithmic axes.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter, PercentFormatter

from ...core.arrays import Array
from ..compare import method_statistics as statistics
from ..compare.attempt import COLD, RAW, SETTINGS
from ..compare.method_statistics import TIMES, MethodName, by_problem, has_sweep, headline, methods, of_method, time_of
from ..plot.axes_style import label_axes, plain_axes
from ..plot.page import save, titled_sheet
from ..plot.style import BLUE, GREEN, GREY, INK, SMALL_SIZE, VERMILION
from .comparison_report import FIGURE_FOLDER, FIGURE_FORMATS, Picture, group_of, size_groups

#: Okabe and Ito's colours without yellow, which is too faint for lines; the first is for the native solver.
#: Five darker ones follow.
DARKER = ("#7F4F24", "#6A3D9A", "#808000", "#A50026", "#7A7A7A")
COLOURS = (INK, BLUE, VERMILION, GREEN, "#CC79A7", "#E69F00", "#56B4E9", *DARKER)
#: Dashes and markers, in numbers that share no factor with each other nor with that of the colours behind the first:
#: neighbours differ in all three, and lines can be told apart in grey.
DASHES = ((), (5, 1.5), (1.5, 1.2), (6, 1.5, 1.5, 1.5), (9, 2))
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
MARKED_POINTS = 7  # on a curve of many points

PANEL_HEIGHT = 2.9  # [in]
SIZE_TICK_LIMIT, TICK_DISTANCE = 8, 0.05  # sizes that are ticked themselves, and their least distance over the axis
ROUND_NUMBERS = ((1.0, 2.0, 5.0), (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0))  # ticks of a decade, and of less


def panels(problems: Any, time_limit: float) -> list[tuple[str, list[MethodName]]]:
    """Settings and cold methods of each panel, in the order of the first one, which is by merit.

    The native solver, without settings, stands beside answers to the scaled problem.
    """
    named = [
        method for method in methods(problems, time_limit) if method[2] == COLD
    ]  # not every problem has a warm one
    used = [name for name in SETTINGS if any(method[1] == name for method in named)]
    if not used:
        return []
    first = sorted(_of_panel(named, used[0]), key=lambda one: statistics.merit(problems, one, time_limit))
    rank = {method[0]: number for number, method in enumerate(first)}
    return [(name, sorted(_of_panel(named, name), key=lambda one: rank.get(one[0], len(rank)))) for name in used]


def _of_panel(named: list[MethodName], settings: str) -> list[MethodName]:
    return [one for one in named if one[1] == settings or (one[0] == "native" and settings != RAW)]


def style(solver: str, problems: Any) -> dict[str, Any]:
    """Line style of a solver, its own in all figures: colour, dashes and marker; native is a plain thick line."""
    if solver == "native":
        return {"color": COLOURS[0], "linewidth": 1.8}
    number = [name for name in dict.fromkeys(problems["solver"]) if name != "native"].index(solver)
    palette = COLOURS[1:]
    return {
        "color": palette[number % len(palette)],
        "linewidth": 1.3,
        "dashes": DASHES[number % len(DASHES)],
        "marker": MARKERS[number % len(MARKERS)],
        "markersize": 3.2,
        "markeredgewidth": 0,
    }


def sparse_markers(count: int, number: int) -> tuple[int, int]:
    """First marked point of a curve and the step to the next; curves of other numbers in the panel begin elsewhere."""
    step = max(count // MARKED_POINTS, 1)
    return (number * step // MARKED_POINTS) % step, step


def finish(axes: Axes, title: str, right: str, label: str) -> None:
    """Titles, label of the ordinate and the legend at the side."""
    plain_axes(axes, y=label, title=title)
    axes.tick_params(which="minor", length=1.5, width=0.5, colors=GREY)
    axes.set_title(right, loc="right", fontsize=SMALL_SIZE + 0.5, color=GREY, pad=3)
    if axes.get_legend_handles_labels()[0]:
        style: dict[str, Any] = {"fontsize": SMALL_SIZE, "frameon": False, "labelcolor": INK, "handlelength": 2.6}
        axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), **style)


def plain_ticks(axis: Axis, values: Array | None = None) -> None:
    """Plain numbers on a logarithmic axis: the values themselves if they are few, otherwise round ones."""
    low, high = axis.get_view_interval()
    few = (
        values is not None
        and values.size <= SIZE_TICK_LIMIT
        and np.all(np.diff(np.log(values)) > TICK_DISTANCE * np.log(high / low))
    )
    for subs in ROUND_NUMBERS if high / low < 1e3 else ((1.0,),):
        ticks = np.outer(10.0 ** np.arange(-9.0, 10.0), subs)
        if np.count_nonzero((ticks >= low) & (ticks <= high)) > 1:
            break
    axis.set_major_locator(FixedLocator(values.tolist()) if few and values is not None else LogLocator(subs=subs))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


#: Height of a row of the figure of pairs, and what is left around the rows [in].
ROW_HEIGHT, PAIR_MARGIN = 0.27, 1.3
#: Share above which a cell is so dark that its number is white.
DARK_SHARE = 0.55
#: Colour of the cells of a solver against itself.
DIAGONAL_GREY = "#d9d9d9"


def draw_performance_profile(dataset: xr.Dataset, problems: Any) -> Figure:
    """Share of problems that each method solves within a factor of the fastest, a panel for each settings."""
    return _profile_figure(
        dataset,
        problems,
        ("Performance profile", "share of problems solved within a factor of the fastest"),
        statistics.performance_profile,
        ("{time}, over that of the fastest", 1.0),
    )


def draw_data_profile(dataset: xr.Dataset, problems: Any) -> Figure:
    """Share of problems that each method solves within a run time, a panel for each settings."""
    return _profile_figure(
        dataset,
        problems,
        ("Data profile", "share of problems solved within a run time; no curve depends on another"),
        lambda times: statistics.data_profile(1e3 * times),
        ("{time} [ms]", None),
    )


def _profile_figure(
    dataset: xr.Dataset,
    problems: Any,
    titles: tuple[str, str],
    profile: Callable[[Array], tuple[Array, Array]],
    axis: tuple[str, float | None],
) -> Figure:
    shown = panels(problems, float(dataset.attrs["time_limit_s"]))
    best = "the best of the first panel" if len(shown) > 1 else "the best"
    note = f"solved: certified to {dataset.attrs['tolerance']:g}; cold starts; legend: {best} first"
    figure = titled_sheet(*titles, note, PANEL_HEIGHT * len(shown))
    grid = figure.subplots(len(shown), 1, squeeze=False)[:, 0]
    label, left = axis[0].format(time=TIMES[time_of(dataset)]), axis[1]
    for axes, (settings, named) in zip(grid, shown, strict=True):
        compared = statistics.run_time_table(problems, named)
        limit, share = profile(compared.to_numpy(dtype=float).T)
        if not limit.size:
            limit, share = np.ones(1), np.zeros((len(named), 1))
        start = float(limit[0]) / 1.15 if left is None else left
        right = max(2.0 * start, 1.15 * float(limit[-1]))
        for number, (method, curve) in enumerate(zip(named, share, strict=True)):
            x, y = np.array([start, *limit, right]), np.array([0.0, *curve, curve[-1]])
            if left is not None:  # the curve begins at the factor one, with its own value there
                x, y = x[1:], y[1:]
            marked = sparse_markers(x.size, number)
            axes.step(x, y, where="post", label=method[0], markevery=marked, **style(method[0], problems))
        axes.set_xscale("log")
        axes.set_xlim(start, right)
        axes.set_ylim(-0.02, 1.03)
        axes.yaxis.set_major_formatter(PercentFormatter(1.0))
        plain_ticks(axes.xaxis)
        finish(axes, f"{settings}: {SETTINGS[settings]}", f"{len(compared)} problems", "share solved")
        label_axes(axes, label)
    return figure


def draw_pairs(dataset: xr.Dataset, problems: Any) -> Figure:
    """Share of problems that the solver of the row solves in at most the time of that of the column."""
    named = headline(_named(dataset, problems))
    compared = statistics.run_time_table(problems, named)
    share = statistics.pairwise_matrix(compared.to_numpy(dtype=float).T)
    count = len(named)
    figure = titled_sheet(
        "Pairs of solvers",
        f"share of {len(compared)} problems that the row solves in at most the time of the column [%]",
        f"{named[0][1]}, cold; solved: certified to {dataset.attrs['tolerance']:g}; the best first; what one alone "
        "solves counts for it",
        ROW_HEIGHT * count + PAIR_MARGIN,
    )
    axes = figure.subplots()
    axes.imshow(share, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
    for i in range(count):
        for j in range(count):
            text = "" if i == j else f"{100.0 * share[i, j]:.0f}"
            colour = "white" if share[i, j] > DARK_SHARE else INK
            axes.text(j, i, text, ha="center", va="center", fontsize=SMALL_SIZE, color=colour)
    names = [method[0].replace(":", ":\n", 1) for method in named]
    axes.set_xticks(range(count), names, rotation=45, ha="left", rotation_mode="anchor", fontsize=SMALL_SIZE)
    axes.set_yticks(range(count), [method[0] for method in named], fontsize=SMALL_SIZE)
    axes.xaxis.tick_top()
    axes.tick_params(length=0, colors=INK)
    axes.spines[:].set_visible(False)
    axes.fill(*_diagonal(count), color=DIAGONAL_GREY)
    edges = np.arange(1, count) - 0.5
    axes.vlines(edges, -0.5, count - 0.5, colors="white", linewidth=1.0)
    axes.hlines(edges, -0.5, count - 0.5, colors="white", linewidth=1.0)
    return figure


def _diagonal(count: int) -> list[Array]:
    """Corners of the cells of the diagonal, for each its four abscissas and ordinates."""
    square = np.array([[-0.5, 0.5, 0.5, -0.5], [-0.5, -0.5, 0.5, 0.5]])
    return [part for i in range(count) for part in square + i]


def _named(dataset: xr.Dataset, problems: Any) -> list[MethodName]:
    return methods(problems, float(dataset.attrs["time_limit_s"]))


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
            records = of_method(chosen, method)
            size, time = records["size"].to_numpy(dtype=float), records["run_time"].to_numpy(dtype=float)
            known = np.isfinite(time)
            line = style(method[0], problems)
            fit = statistics.growth(size, time)
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
        label_axes(axes, "number of segments n")
    return figure


def _runs(dataset: xr.Dataset) -> set[tuple[str, float]]:
    """Solvers with the tolerances that a sweep gave them; zero for none."""
    return set(zip(dataset["solver"].values.tolist(), dataset["solver_tolerance"].values.tolist(), strict=True))


def draw_work_precision(dataset: xr.Dataset, problems: Any) -> Figure:
    """Time of the fastest run that reaches a certified accuracy, and the share of problems on which one does."""
    rank = [method[0] for method in headline(methods(problems, float(dataset.attrs["time_limit_s"])))]
    curves = sorted(statistics.work_precision(dataset), key=lambda one: rank.index(one.solver))
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
    label_axes(lower, "certified accuracy (largest violation of a condition)")
    return figure


Drawing = Callable[[xr.Dataset, Any], Figure]


def write_figures(dataset: xr.Dataset, folder: Path) -> tuple[list[Path], list[Picture]]:
    """Draw the figures into a folder; returns all files, and the pictures of the report."""
    problems = by_problem(dataset)
    drawings: list[tuple[str, str, str, Drawing]] = [
        ("Run time", "performance_profile", "Performance profile", draw_performance_profile),
        ("Run time", "data_profile", "Data profile", draw_data_profile),
    ]
    if len(headline(methods(problems, float(dataset.attrs["time_limit_s"])))) > 1:
        drawings.append(("Pairs of solvers", "pairs", "Pairs of solvers", draw_pairs))
    if has_sweep(dataset):
        drawings.append(("Work and precision", "work_precision", "Work and precision", draw_work_precision))
    if size_groups(problems):
        drawings.append(("Growth", "run_time", "Run time against size", draw_growth))
    written, pictures = [], []
    for section, name, caption, draw in drawings:
        files = write_figure(draw(dataset, problems), folder / FIGURE_FOLDER, name)
        written += files
        pictures.append(Picture(section, f"{FIGURE_FOLDER}/{files[0].name}", caption))
    return written, pictures


def write_figure(figure: Figure, folder: Path, name: str) -> list[Path]:
    """Write a figure as ``NAME.png``, ``NAME.pdf`` and ``NAME.svg``; the same figure gives the same files."""
    return [save(figure, folder / f"{name}.{suffix}") for suffix in FIGURE_FORMATS]
