"""Profile figures: performance profile, data profile, and pairs of solvers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from ...plot.page import INK, SMALL_SIZE, titled_sheet
from ..statistics.method_statistics import TIMES, MethodName, headline, methods, run_time_table, time_of
from ..statistics.profiles import Array, data_profile, pairwise_matrix, performance_profile
from .figure_style import PANEL_HEIGHT, abscissa, finish, panels, plain_ticks, settings_title, sparse_markers, style

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
        performance_profile,
        ("{time}, over that of the fastest", 1.0),
    )


def draw_data_profile(dataset: xr.Dataset, problems: Any) -> Figure:
    """Share of problems that each method solves within a run time, a panel for each settings."""
    return _profile_figure(
        dataset,
        problems,
        ("Data profile", "share of problems solved within a run time; no curve depends on another"),
        lambda times: data_profile(1e3 * times),
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
        compared = run_time_table(problems, named)
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
        finish(axes, settings_title(settings), f"{len(compared)} problems", "share solved")
        abscissa(axes, label)
    return figure


def draw_pairs(dataset: xr.Dataset, problems: Any) -> Figure:
    """Share of problems that the solver of the row solves in at most the time of that of the column."""
    named = headline(_named(dataset, problems))
    compared = run_time_table(problems, named)
    share = pairwise_matrix(compared.to_numpy(dtype=float).T)
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
