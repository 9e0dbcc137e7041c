"""The figures of chapter 4 redrawn: pictures of worn_and_measured_flanks.md."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from dissertation_figures import ease_offs, patterns, save_small
from folders import IMAGES
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator
from real_flanks_analyses import CASES, MEMBERS, TORQUE, analysed, files

import easeoff
from easeoff.cases import gear_pair
from easeoff.contact.evaluation.pressure_map import pressure_map
from easeoff.contact.evaluation.tooth_passage import two_cycles
from easeoff.study.deviations import flank_deviations
from easeoff.study.plot.axes_style import plain_axes, plain_bar
from easeoff.study.plot.mesh_cycle_charts import draw_surface, pressure_levels
from easeoff.study.plot.page import sheet
from easeoff.study.plot.style import BLUE, GREY, INK, SMALL_SIZE, VERMILION, WIDTH
from easeoff.study.plot.tooth_view import draw_flank, tooth_view
from easeoff.study.plot.topography_chart import draw_map, ease_off_map

FIGURES = IMAGES / "real_flanks"
ROUNDED = 0.1  # [um]; the last digit of the grids


def deviation_maps(example: str) -> Figure:
    """Figures 4.5 and 4.10: the deviations, metal missing, on their own flanks."""
    pair = gear_pair(easeoff.read_case(CASES[example]), "drive")
    deviations = flank_deviations(pair, files(example))  # type: ignore[arg-type]
    figure = sheet(2.5)
    t, h = np.linspace(0, 1, 241), np.linspace(0, 1, 181)
    for axes, (name, deviation) in zip(figure.subplots(1, 2), deviations.items(), strict=True):
        dataset = deviation.on_grid(t, h)
        missing = -dataset["deviation"].values.T
        # The grids' numbers are rounded: what is as good as nothing is not divided by the level zero.
        missing = np.where(np.abs(missing) < ROUNDED, 0.5 * ROUNDED, missing)
        extent = float(missing.min()), float(missing.max())
        levels = np.asarray(MaxNLocator(16, steps=[1, 2, 5, 10]).tick_values(*extent))
        every_second = levels[np.round(levels / (levels[1] - levels[0])) % 2 == 0]
        drawn = axes.contourf(t, h, missing, levels, cmap="viridis")
        axes.contour(t, h, dataset["extrapolated"].values.T, [0.5], colors="white", linestyles="--", linewidths=0.9)
        place = deviation.section.fractions(deviation.axial, deviation.radial)
        axes.plot(place[0].ravel(), place[1].ravel(), ".", color="white", markersize=1.5)
        axes.set_title(f"{name}: metal missing [µm]", fontsize=SMALL_SIZE + 1, color=INK, loc="left")
        axes.set_xlabel("toe to heel", fontsize=SMALL_SIZE, color=INK)
        axes.set_ylabel("root to tip", fontsize=SMALL_SIZE, color=INK)
        axes.tick_params(labelsize=SMALL_SIZE, colors=INK, length=2.5, width=0.6)
        plain_bar(figure.colorbar(drawn, ax=axes, ticks=every_second), "")
    note = "white points: the grid; beyond the white dashed line the deviation is extrapolated"
    figure.supxlabel(note, fontsize=SMALL_SIZE, color=GREY)
    return figure


def change_map(example: str) -> Figure:
    """Figure 4.6d: what the deviations add to the ease-off."""
    tree = analysed(example)
    view = tooth_view(tree)
    gap = tree["ease_off"]["ease_off_change"].values
    figure = sheet((WIDTH - 1.4) * view.aspect + 0.4)
    axes = figure.subplots()
    draw_flank(axes, view)
    grid, values, inside = easeoff_map(tree, gap)
    # Where no metal is missing, rounding and extrapolation give half a micrometre either side of zero: no line there.
    values = np.maximum(values, 0.5 * ROUNDED)
    levels = np.asarray(MaxNLocator(8, steps=[1, 2, 5, 10]).tick_values(0.0, float(values[inside].max())))
    shading = draw_map(axes, view, (grid, values, inside), levels)
    if shading is not None:
        plain_bar(figure.colorbar(shading, ax=axes, shrink=0.8, extendfrac=0), "gap added [µm]")
    return figure


def easeoff_map(tree: xr.DataTree, gap: Any) -> Any:
    """As ``ease_off_map``, for another variable of the ease-off's grid."""
    swapped = tree.copy()
    dataset = swapped["ease_off"].to_dataset().assign(ease_off=(("lengthwise", "profile"), gap))
    lever = dataset["lever_arm"].values
    swapped["ease_off"] = xr.DataTree(dataset.assign(ease_off_angle=(("lengthwise", "profile"), 1e-3 * gap / lever)))
    return ease_off_map(tooth_view(swapped))


def errors(example: str) -> Figure:
    """Figures 4.8 and 4.13: transmission errors of designed and deviating flanks."""
    figure = sheet(2.6)
    for axes, group in zip(figure.subplots(1, 2), ("unloaded", "loaded"), strict=True):
        for members, name, colour in (((), "designed", BLUE), (MEMBERS, "deviating", VERMILION)):
            tree = analysed(example, members)
            variable = "transmission_error_envelope" if group == "unloaded" else "transmission_error"
            values = np.atleast_2d(tree[group].to_dataset()[variable].values)[0]
            axes.plot(*two_cycles(values - (values.min() if group == "unloaded" else 0.0)), color=colour, label=name)
        plain_axes(axes)
        axes.set_xlim(0.0, 2.0)
        axes.xaxis.set_major_locator(MultipleLocator(0.5))
        axes.set_title(
            "unloaded [µrad]" if group == "unloaded" else "200 N m [µrad]", fontsize=SMALL_SIZE + 1, loc="left"
        )
        axes.set_xlabel("mesh cycles", fontsize=SMALL_SIZE, color=INK)
    axes.legend(fontsize=SMALL_SIZE, frameon=False)
    return figure


def pressure_maps(example: str) -> Figure:
    """Figures 4.9 and 4.14: greatest pressure over the cycle."""
    trees = [analysed(example, members) for members in ((), MEMBERS)]
    views = [tooth_view(tree) for tree in trees]
    maps = [pressure_map(tree["loaded"].to_dataset().sel(torque=TORQUE)) for tree in trees]
    levels = pressure_levels(max(surface.peak for surface in maps))
    figure = sheet((WIDTH - 1.6) / 2.0 * views[0].aspect + 0.6)
    grid = figure.subplots(1, 2)
    shading = None
    for axes, view, surface, name in zip(grid, views, maps, ("designed", "deviating"), strict=True):
        draw_flank(axes, view, labels=(True, axes is grid[0]))
        axes.tick_params(axis="y", pad=16, length=0)  # beyond the word at the toe
        shading = draw_surface(axes, view, surface, levels) or shading
        axes.set_title(f"{name}, peak {surface.peak:.0f} MPa", fontsize=SMALL_SIZE + 1, color=INK, loc="left")
    if shading is not None:
        plain_bar(figure.colorbar(shading, ax=list(grid), shrink=0.8, ticks=MaxNLocator(7)), "pressure [MPa]")
    return figure


def draw() -> None:
    """Write the pictures."""
    for example, numbers in (("worn", "4_5 4_6 4_7 4_8 4_9"), ("measured", "4_10 4_11 4_12 4_13 4_14")):
        names = [FIGURES / f"figure_{number}.png" for number in numbers.split()]
        both = [("designed", "", analysed(example, ())), ("deviating", "", analysed(example))]
        alone = [(f"{m} alone", "", analysed(example, (m,))) for m in MEMBERS]
        save_small(deviation_maps(example), names[0])
        save_small(ease_offs(both if example == "worn" else [both[0], *alone, both[1]]), names[1])
        save_small(patterns(both), names[2])
        save_small(errors(example), names[3])
        save_small(pressure_maps(example), names[4])
    save_small(change_map("worn"), FIGURES / "figure_4_6d.png")
