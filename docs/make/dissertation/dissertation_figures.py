"""Draw the dissertation's figures from our own results; ``make_dissertation_figures.py`` writes the page about them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator, MultipleLocator
from numpy.typing import NDArray
from PIL import Image
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from easeoff.contact.evaluation.pressure_map import pressure_map
from easeoff.contact.evaluation.tooth_passage import ToothPassage, tooth_passage, two_cycles
from easeoff.core.output_file import whole_file
from easeoff.study.plot.axes_style import plain_axes, plain_bar
from easeoff.study.plot.contact_pattern_chart import (
    ContactPattern,
    draw_path,
    draw_pattern,
    legend_below,
    path_beyond,
    unloaded_pattern,
)
from easeoff.study.plot.mesh_cycle_charts import draw_surface, pressure_levels
from easeoff.study.plot.page import sheet
from easeoff.study.plot.style import BLUE, BODY_SIZE, FAINT, GREEN, GREY, INK, SMALL_SIZE, VERMILION, WIDTH
from easeoff.study.plot.tooth_view import ToothView, draw_flank, tooth_view
from easeoff.study.plot.topography_chart import contour_levels, draw_map, ease_off_map

Array = NDArray[Any]

OURS, THEIRS = BLUE, VERMILION
PAIRS = ((-1, "i − 1", GREEN), (0, "i", BLUE), (1, "i + 1", VERMILION))


def halo(width: float = 2.4) -> Any:
    """A white rim that keeps writing legible on lines."""
    return [withStroke(linewidth=width, foreground="white")]


def title(axes: Axes, left: str, right: str = "") -> None:
    """Name of a panel on the left, its number on the right."""
    axes.set_title(left, loc="left", fontsize=BODY_SIZE, color=INK, weight="bold", pad=3)
    axes.set_title(right, loc="right", fontsize=SMALL_SIZE + 0.5, color=GREY, pad=3)


def swings(axes: Axes, middle: float, ours: float, theirs: float, *, named: bool = True) -> None:
    """Two peak-to-peak values [urad] as bars to the scale of the curves, about the same middle."""
    for place, name, value, colour in ((0.0, "ours", ours, OURS), (1.5, "dissertation", theirs, THEIRS)):
        low, high = middle - 0.5 * value, middle + 0.5 * value
        axes.annotate(
            "", (place, low), (place, high),
            arrowprops={"arrowstyle": "|-|,widthA=0.35,widthB=0.35", "color": colour, "linewidth": 1.6, "shrinkA": 0,
                        "shrinkB": 0},
        )  # fmt: skip
        axes.text(
            place + 0.08, middle, f"{value:.1f}", fontsize=SMALL_SIZE + 0.5, color=colour, va="center", ha="left"
        )  # fmt: skip
        if named:
            axes.text(
                place, -0.03, name, fontsize=SMALL_SIZE, color=colour, va="top", ha="center",
                transform=axes.get_xaxis_transform(),
            )  # fmt: skip
    axes.set_xlim(-0.6, 2.4)
    axes.axis("off")


def quiet_edges(axes: Axes, above_another: bool) -> None:
    """Ticks of a small flank: none between panels, and clear of the edges' names."""
    axes.tick_params(axis="x", bottom=not above_another)
    axes.tick_params(axis="y", length=0, pad=18)


def error_of_a_pair(tree: xr.DataTree) -> ToothPassage:
    """Unloaded transmission error [urad] of one tooth pair over its passage."""
    unloaded = tree["unloaded"].to_dataset()
    return tooth_passage(
        unloaded["pair"].values, unloaded["transmission_error"].transpose("pair", "mesh_position").values
    )


def transfer(course: ToothPassage) -> tuple[float, float]:
    """When the followed pair hands over to the next one [cycles of the result's own axis], and the error [urad]."""
    known = np.isfinite(course.values)
    error = PchipInterpolator(course.steps[known], course.values[known], extrapolate=False)
    steps = course.steps[known].astype(float)
    ahead = error(steps) - error(steps - course.per_cycle)  # of the pair that follows
    with np.errstate(invalid="ignore"):
        before = np.flatnonzero((ahead[:-1] <= 0.0) & (ahead[1:] > 0.0))[0]
    end = brentq(lambda step: float(error(step) - error(step - course.per_cycle)), steps[before], steps[before + 1])
    return end / course.per_cycle, float(error(end))


def unloaded_error(tree: xr.DataTree, theirs: float) -> Figure:
    """Figure 2.9: error of three adjacent tooth pairs, where they take over, and the peak to peak."""
    course = error_of_a_pair(tree)
    end, level = transfer(course)
    figure = sheet(3.5)
    axes, bars = figure.subplots(1, 2, width_ratios=[6.2, 1.0], sharey=True)
    times = course.steps / course.per_cycle + 2.0 - end  # the zero of the axis is free: M1 at one, M2 at two
    top = 1.75 * max(level, 1e-3)
    for pair, name, colour in PAIRS:
        axes.plot(times + pair, course.values, color=colour, linewidth=1.2, zorder=2)
        carrying = (times >= 1.0) & (times <= 2.0) & np.isfinite(course.values)
        inner = np.concatenate([[1.0], times[carrying], [2.0]])
        values = np.concatenate([[level], course.values[carrying], [level]])
        axes.plot(inner + pair, values, color=colour, linewidth=2.6, zorder=3)
        # The middle of pair i belongs to the arrow.
        at = inner[np.argmin(values)] + pair - (0.07 if pair == 0 else 0.0)
        text = f"${name.replace('−', '-')}$"
        axes.text(at, 0.07 * top, text, color=colour, fontsize=BODY_SIZE + 2, ha="center", va="bottom")
    for place, name in ((1.0, "$M_1$"), (2.0, "$M_2$")):
        axes.plot([place, place], [0.0, level], color=GREY, linewidth=0.8, linestyle=(0, (4, 2)), zorder=1)
        axes.plot(place, level, marker="o", markersize=6, markerfacecolor="white", markeredgecolor=INK, zorder=5)
        axes.text(place, level + 0.07 * top, name, fontsize=BODY_SIZE + 2, color=INK, ha="center", va="bottom",
                  path_effects=halo(), zorder=6)  # fmt: skip
    plain_axes(axes)
    axes.set_xlim(0.3, 2.7)
    axes.set_ylim(-0.03 * top, top)
    axes.xaxis.set_major_locator(MultipleLocator(0.5))
    axes.set_xlabel("mesh cycles (pinion pitches)", fontsize=SMALL_SIZE + 1, color=INK)
    axes.set_ylabel("unloaded transmission error [µrad]", fontsize=SMALL_SIZE + 1, color=INK)
    ours = tree["unloaded"].attrs["peak_to_peak"]
    axes.annotate("", (1.5, 0.0), (1.5, level), arrowprops={"arrowstyle": "<->", "color": INK, "linewidth": 0.9,
                  "shrinkA": 0, "shrinkB": 0})  # fmt: skip
    axes.plot([1.0, 2.0], [level, level], color=GREY, linewidth=0.8, linestyle=(0, (4, 2)), zorder=1)
    axes.text(1.52, 0.62 * level, "P-P UTE", fontsize=SMALL_SIZE + 1, color=INK, va="center", path_effects=halo())
    swings(bars, 0.5 * level, ours, theirs)
    title(bars, "peak to peak")
    return figure


def mark_lines(axes: Axes, view: ToothView, pattern: ContactPattern, names: tuple[str, str], *, inside: bool) -> None:
    """Draw the contact lines at the first and last moment of the carrying; their names within or beside the pattern."""
    centre = view.in_plane(np.mean(pattern.ranges[0].path, axis=1))
    for line, name in zip((pattern.ranges[0].lines[0], pattern.ranges[-1].lines[-1]), names, strict=True):
        if not name:
            continue
        drawn = view.in_plane(line)
        axes.plot(*drawn, color=INK, linewidth=2.2, zorder=6.2, solid_capstyle="round")
        within = 0.65 * drawn[:, drawn.shape[1] // 2] + 0.35 * centre
        beside = drawn[:, np.argmin(drawn[0])]
        (x, y), away, align = (within, (0, 0), "center") if inside else (beside, (-3, 4), "right")
        axes.annotate(name, (x, y), away, textcoords="offset points", fontsize=BODY_SIZE, color=INK, ha=align,
                      va="center", path_effects=halo(), zorder=9)  # fmt: skip


def thinned(pattern: ContactPattern, every: int) -> ContactPattern:
    """A pattern with some of its lines only, for small pictures; outline and path stay."""
    return replace(pattern, lines=pattern.lines[::every], carrying=pattern.carrying[::every])


def pattern_of_the_pair(tree: xr.DataTree) -> Figure:
    """Figure 2.10: paths, the lines at both transfers, and where all three pairs stand at these moments."""
    view = tooth_view(tree)
    whole = unloaded_pattern(tree["unloaded"].to_dataset(), view.fields)
    pattern = thinned(whole, 2)
    separation = tree["unloaded"].attrs["separation"]
    big, small = (WIDTH - 0.9) * view.aspect + 1.05, (WIDTH - 0.6) / 3.0 * view.aspect + 0.35
    figure = sheet(big + small)
    upper, lower = np.asarray(figure.subfigures(2, 1, height_ratios=[big, small]))
    axes = upper.subplots()
    draw_pattern(axes, view, pattern, path=False)
    finite = np.isfinite(whole.lines[:, 0, 0])
    for side in (0, -1):
        axes.plot(*view.in_plane(whole.lines[finite][:, :, side].T), color=GREEN, linewidth=1.1, zorder=4.5)
    axes.plot(*view.in_plane(whole.path.T), color=VERMILION, linewidth=1.1, zorder=4.5)
    draw_path(axes, view, pattern)
    mark_lines(axes, view, pattern, ("$M_1$", "$M_2$"), inside=False)
    # Named by the side of the picture they lie on.
    middle = pattern.ranges[0].lines[pattern.ranges[0].lines.shape[0] // 2]
    ends = view.in_plane(middle[:, [0, -1]])
    for end, name, away in zip(ends[:, np.argsort(ends[0])].T, ("LPP", "RPP"), (9, -9), strict=True):
        axes.annotate(name, end, (0, away), textcoords="offset points", fontsize=BODY_SIZE, color=GREEN, ha="center",
                      va="center", weight="bold", path_effects=halo(), zorder=9)  # fmt: skip
    path = view.in_plane(pattern.ranges[0].path)
    axes.annotate("CPP", path[:, path.shape[1] // 2], (0, 8), textcoords="offset points", fontsize=BODY_SIZE,
                  color=VERMILION, ha="center", weight="bold", path_effects=halo(3.5), zorder=9)  # fmt: skip
    entries = [
        Line2D([], [], color=VERMILION, linewidth=1.8, label="CPP: points of contact"),
        Line2D([], [], color=INK, linewidth=2.2, label="contact lines at $M_1$ and $M_2$"),
        Line2D([], [], color=GREEN, linewidth=1.1, label=f"RPP, LPP: {separation:g} µm apart, or the edge"),
        Line2D([], [], color=BLUE, linewidth=0.8, label="lines while the pair carries"),
        Line2D([], [], color=FAINT, linewidth=0.8, label="lines before and after"),
        Line2D([], [], color=GREY, linewidth=0.8, linestyle=(0, (4, 2)), label="boundary of the common flank"),
    ]
    legend_below(axes, entries, columns=3)
    panels = lower.subplots(1, 3)
    # What one pair does at the one transfer, its neighbour does at the other.
    moments = (("", "$M_1$"), ("$M_1$", "$M_2$"), ("$M_2$", ""))
    for panel, (_, name, _), lines in zip(panels, PAIRS, moments, strict=True):
        draw_flank(panel, view, labels=(False, False))
        for span in pattern.ranges:
            panel.fill(*view.in_plane(span.outline), facecolor=BLUE, alpha=0.10, edgecolor="none", zorder=1)
            panel.plot(*view.in_plane(span.outline), color=BLUE, linewidth=1.0, zorder=4)
        panel.tick_params(bottom=False)
        mark_lines(panel, view, pattern, lines, inside=True)
        title(panel, f"pair {name}")
    return figure


def patterns(panels: list[tuple[str, str, xr.DataTree]]) -> Figure:
    """Figure 2.11: unloaded patterns at several misalignments, two panels a row."""
    views = [tooth_view(tree) for _, _, tree in panels]
    rows = -(-len(panels) // 2)
    figure = sheet(rows * ((WIDTH - 1.2) / 2.0 * views[0].aspect + 0.27) + 0.75)
    grid = figure.subplots(rows, 2)
    for number, (axes, view, (name, where, tree)) in enumerate(zip(grid.flat, views, panels, strict=True)):
        pattern = unloaded_pattern(tree["unloaded"].to_dataset(), view.fields)
        draw_pattern(axes, view, thinned(pattern, 3), labels=(number >= len(panels) - 2, number % 2 == 0))
        quiet_edges(axes, number < len(panels) - 2)
        title(axes, name, where)
    entries = [
        Line2D([], [], color=VERMILION, linewidth=1.8, label="path of contact"),
        path_beyond("before and after"),
        Line2D([], [], color=BLUE, linewidth=1.4, label="outline of the pattern"),
        Line2D([], [], color=FAINT, linewidth=0.8, label="lines before and after"),
        Line2D([], [], color=GREY, linewidth=0.8, linestyle=(0, (4, 2)), label="boundary of the common flank"),
    ]
    figure.legend(handles=entries, loc="outside lower center", ncols=5, fontsize=SMALL_SIZE + 0.5, frameon=False,
                  labelcolor=INK, handlelength=2.4, columnspacing=2.0)  # fmt: skip
    return figure


def loaded_errors(tree: xr.DataTree, theirs: list[tuple[float, float, float]]) -> Figure:
    """Figure 3.6: loaded error over two cycles, one panel for torque, mean and peak to peak of the dissertation."""
    loaded = tree["loaded"].to_dataset()
    figure = sheet(5.6)
    grid = figure.subplots(len(theirs), 2, width_ratios=[6.2, 1.0], sharey="row", squeeze=False)
    extent = 1.25 * max(float(loaded["peak_to_peak"].max()), *(swing for _, _, swing in theirs))
    for number, ((axes, bars), (torque, mean, swing)) in enumerate(zip(grid, theirs, strict=True)):
        at_torque = loaded.sel(torque=torque)
        error = at_torque["transmission_error"].values
        times, values = two_cycles(error)
        axes.plot(times, values, color=OURS, linewidth=1.8)
        plain_axes(axes)
        middle = 0.5 * float(np.nanmin(error) + np.nanmax(error))
        axes.set_ylim(middle - 0.5 * extent, middle + 0.5 * extent)
        axes.set_xlim(0.0, 2.0)
        axes.xaxis.set_major_locator(MultipleLocator(0.5))
        axes.yaxis.set_major_locator(MultipleLocator(10.0))
        axes.tick_params(labelbottom=number == len(theirs) - 1)
        ours = float(at_torque["mean_level"])
        title(axes, f"({'abc'[number]})  {torque:g} N m", f"mean {ours:.0f} µrad, dissertation about {mean:.0f} µrad")
        swings(bars, middle, float(at_torque["peak_to_peak"]), swing, named=number == len(theirs) - 1)
    title(grid[0, 1], "peak to peak")
    grid[-1, 0].set_xlabel("mesh cycles (pinion pitches)", fontsize=SMALL_SIZE + 1, color=INK)
    figure.supylabel("loaded transmission error [µrad]", fontsize=SMALL_SIZE + 1, color=INK)
    return figure


def pressures(panels: list[tuple[str, str, xr.DataTree, float]]) -> Figure:
    """Figure 3.7: greatest pressure over the cycle, three panels on the left, the scale and two on the right."""
    views = [tooth_view(tree) for _, _, tree, _ in panels]
    maps = [pressure_map(tree["loaded"].to_dataset().sel(torque=torque)) for _, _, tree, torque in panels]
    levels = pressure_levels(max(surface.peak for surface in maps))
    figure = sheet(3 * ((WIDTH - 1.2) / 2.0 * views[0].aspect + 0.27) + 0.4)
    grid = figure.subplots(3, 2)
    places = [(0, 0), (1, 0), (2, 0), (1, 1), (2, 1)]
    shading = None
    for place, view, surface, (name, where, _, _) in zip(places, views, maps, panels, strict=True):
        axes = grid[place]
        draw_flank(axes, view, labels=(place[0] == 2, place[1] == 0))
        quiet_edges(axes, place[0] < 2)
        shading = draw_surface(axes, view, surface, levels) or shading
        title(axes, name, f"{where}, peak {surface.peak:.0f} MPa")
    grid[0, 1].axis("off")
    if shading is not None:
        inset = grid[0, 1].inset_axes((0.05, 0.5, 0.9, 0.1))
        bar = figure.colorbar(shading, cax=inset, orientation="horizontal", ticks=MaxNLocator(7))
        plain_bar(bar, "greatest contact pressure [MPa], all panels\n+ peak, dashed: boundary of the common flank")
    return figure


def ease_offs(panels: list[tuple[str, str, xr.DataTree]]) -> Figure:
    """Figure 5.3: ease-off maps at shared levels."""
    views = [tooth_view(tree) for _, _, tree in panels]
    mapped = [ease_off_map(view) for view in views]
    levels = contour_levels(np.maximum(np.concatenate([gap[inside] for _, gap, inside in mapped]), 0.0))
    figure = sheet(sum((WIDTH - 1.4) * view.aspect + 0.35 for view in views) + 0.2)
    grid = figure.subplots(len(panels), 1, squeeze=False)[:, 0]
    shading = None
    for number, (axes, view, values, (name, where, tree)) in enumerate(zip(grid, views, mapped, panels, strict=True)):
        draw_flank(axes, view, labels=(number == len(panels) - 1, True))
        shading = draw_map(axes, view, values, levels) or shading
        draw_path(axes, view, unloaded_pattern(tree["unloaded"].to_dataset(), view.fields))
        title(axes, name, where)
    if shading is not None:
        bar = figure.colorbar(shading, ax=list(grid), shrink=0.75, aspect=28, pad=0.015, extendfrac=0)
        plain_bar(bar, "ease-off along the normal [µm]")
    return figure


def save_small(figure: Figure, path: Path, finer: int = 1) -> None:
    """Write a figure as PNG with 256 colours, which is all it has, in a third of the size; reduced if drawn finer."""
    canvas: Any = figure.canvas
    canvas.draw()
    picture = Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3]).reduce(finer)
    with whole_file(path) as temporary:
        picture.quantize(256, kmeans=1, dither=Image.Dither.NONE).save(temporary, format="PNG", optimize=True)
