"""Charts of studies: sweeps, misalignment over the torque, fronts, wear and load cases.

Charts of a sweep: maps, curves, shift of the contact pattern, histograms and tornado.

Misalignment chart: E, P, G and Sigma over the torque, and the centre of the pattern that moves with them.

Chart of a front: two objectives, the start, and fronts of other methods beside it.

Wear chart: depth on both flanks at the end, and what changes over the revolutions.

Load case chart: pattern, greatest pressure, transmission error, power loss and damage by load case.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, Rectangle
from matplotlib.ticker import FixedLocator, MaxNLocator
from numpy.typing import NDArray

from ...core.arrays import Array
from ...core.checks import instance
from ...core.errors import InputError
from ...geometry.pair.gear_pair import MEMBERS
from ..result_layout import PATTERN
from ..summary.deflection_report import misalignment_over_torque
from ..summary.quantities import TITLES
from ..summary.sweep_report import outcome
from ..sweep.reductions import LOADS, ROWS, numbers, point_dimensions, reduced_dimensions, sensitivities, swept_names
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
    label_axes,
    legend_at_foot,
    legend_of_curves,
    plain_axes,
    plain_bar,
    plain_legend,
    torque_colours,
    torque_name,
)
from .panel_grid import OwnAxes, chosen_parts, panels

#: Numbers that are drawn, where a sweep has them.
DRAWN = (
    *("peak_to_peak", "max_pressure", "contact_ratio"),
    *("pattern_centre_lengthwise", "max_root_stress", "efficiency"),
)
#: Names of the pictures of a sweep; which there are depends on what is swept.
PICTURES = ("sweep_map", "sweep_curves", "sweep_pattern", "sweep_histograms", "sweep_tornado")
PANEL_LIMIT = 4
CURVE_LIMIT = 5
PATTERN_LIMIT = 7  # patterns that are outlined
BAR_LIMIT = 12  # coordinates of a tornado
BIN_LIMIT = 40
UNITS = {"degree": "°", "degC": "°C", "um": "µm", "rpm": "1/min", "1": ""}
TICK_LIMIT = 7  # swept values that are ticked themselves
PERCENT = (5.0, 50.0, 95.0)


def pictures(dataset: xr.Dataset) -> tuple[str, ...]:
    """Names of the pictures that a sweep has, of ``PICTURES``.

    Raises
    ------
    InputError
        If no point has numbers.
    """
    names, grids = drawn_numbers(dataset), _grids(dataset)
    there = {
        "sweep_map": len(grids) >= 2,
        "sweep_curves": len(grids) == 1,
        "sweep_pattern": all(name in dataset for name in PATTERN),
        "sweep_histograms": dataset.sizes.get("sample", 0) > 1,
        "sweep_tornado": len(_effects(dataset, names)) > 0,
    }
    return tuple(name for name in PICTURES if there[name])


def drawn_numbers(dataset: xr.Dataset) -> list[str]:
    """Numbers of a sweep that are drawn unless others are asked for. Raises as ``pictures``."""
    names = [name for name in DRAWN if name in numbers(dataset) and bool(dataset[name].notnull().any())][:PANEL_LIMIT]
    if not names:
        raise InputError("the sweep has no point with numbers: there is nothing to draw")
    return names


def short_names(dataset: xr.Dataset) -> tuple[str, ...]:
    """Names of the pictures without the first word, as ``easeoff.plot.sweep`` takes them. Raises as ``pictures``."""
    return tuple(name.removeprefix("sweep_") for name in pictures(dataset))


def draw_sweep(
    dataset: xr.Dataset, picture: str | None = None, names: str | Sequence[str] | None = None, own: OwnAxes = None
) -> Figure:
    """Draw a picture of a sweep, its first if left out, with the numbers of ``DRAWN`` or of ``names``."""
    instance("picture", picture, str | None)
    there = short_names(dataset)
    if not there:
        raise InputError("the sweep has no picture: nothing in it takes several values")
    picture = chosen_parts(there, there[0] if picture is None else picture.removeprefix("sweep_"), "picture")[0]
    known = [name for name in DRAWN if name in numbers(dataset) and bool(dataset[name].notnull().any())]
    shown = drawn_numbers(dataset) if names is None else list(chosen_parts(known, names, "names"))
    if picture == "pattern":
        return _pattern(dataset, own)
    if picture == "histograms":
        return _histograms(dataset, shown, own)
    if picture == "tornado":
        return _tornado(dataset, shown, own)
    grids = _grids(dataset)
    if picture == "map":
        return _map(dataset, shown, grids[0], grids[1], own)
    return _curves(dataset, shown, grids[0], own)


def _grids(dataset: xr.Dataset) -> list[str]:
    """Swept grids of numbers with several values: those of points first, the longest first, then torque and speed."""
    swept = swept_names(dataset)
    dims = [str(dim) for dim in dataset["status"].dims if dim in swept and dataset.sizes[dim] > 1]
    dims = dims or [dim for dim in reduced_dimensions(dataset) if dim in LOADS and dataset.sizes[dim] > 1]
    dims = [dim for dim in dims if dataset[dim].dtype.kind in "fiu"]
    point_axes = set(point_dimensions(dataset))
    return sorted(dims, key=lambda dim: (dim not in point_axes, -dataset.sizes[dim]))


def _label(dataset: xr.Dataset, name: str) -> str:
    """A coordinate with its unit."""
    unit = str(dataset[name].attrs.get("units", ""))
    unit = UNITS.get(unit, unit)
    words = {"torque": "torque at the pinion", "Sigma": "Σ"}.get(name, name)
    return f"{words} [{unit}]" if unit else words


def _reduced(dataset: xr.Dataset, name: str, keep: tuple[str, ...]) -> tuple[xr.DataArray, list[str]]:
    """A number over some dimensions: samples and load cases by their median, others at their middle, which is said."""
    variable, said = dataset[name], []
    for dim in variable.dims:
        if dim in keep:
            continue
        if dim in ROWS:
            variable = variable.median(dim, keep_attrs=True)
            said.append(f"median of the {str(dim).replace('_', ' ')}s")
            continue
        order = np.argsort(dataset[dim].values, kind="stable")
        middle = int(order[order.size // 2])
        variable = variable.isel({dim: middle})
        if dataset.sizes[dim] > 1:
            value = dataset[dim].values[middle]
            words = f"{value:.4g}" if dataset[dim].dtype.kind in "fiu" else str(value)
            unit = str(dataset[dim].attrs.get("units", ""))
            said.append(f"{dim} {words} {UNITS.get(unit, unit)}".strip())
    return variable.transpose(*[dim for dim in keep if dim in variable.dims]), said


def _panels(
    dataset: xr.Dataset, heading: str, count: int, height: float, note: str, own: OwnAxes
) -> tuple[Figure, NDArray[Any]]:
    columns = 2 if count > 1 else 1
    rows = -(-count // columns)
    caption = " · ".join(filter(None, (outcome(dataset), note)))
    subplots = panels(xr.DataTree(dataset), heading, height * rows, caption, (rows, columns), own, count=count)
    return subplots.figure, subplots.axes


def _finish(axes: Axes, title: str, x: str = "", y: str = "") -> None:
    plain_axes(axes, x, y)
    axes.set_title(title, fontsize=BODY_SIZE, color=INK, loc="left")


def _map(dataset: xr.Dataset, names: list[str], along: str, up: str, own: OwnAxes) -> Figure:
    """Filled contours of numbers over two coordinates; failed points stay white."""
    said = _reduced(dataset, names[0], (up, along))[1]
    figure, grid = _panels(dataset, f"Map over {along} and {up}", len(names), 2.7, ", ".join(said), own)
    ordered = dataset.sortby([along, up])
    for axes, name in zip(grid, names, strict=True):
        values = _reduced(ordered, name, (up, along))[0]
        if values.ndim < 2:
            axes.set_visible(False)
            continue
        table = np.ma.masked_invalid(values.values)
        x, y = ordered[along].values, ordered[up].values
        spread = float(np.ptp(table.compressed())) if table.count() else 0.0
        if min(table.shape) > 1 and not table.mask.all() and spread > 0.0:
            drawn: Any = axes.contourf(x, y, table, levels=12, cmap="viridis")
            axes.contour(x, y, table, levels=12, colors="white", linewidths=0.3)
        else:
            drawn = axes.pcolormesh(x, y, table, cmap="viridis", shading="nearest")
        failed = np.nonzero(np.ma.getmaskarray(table))
        if failed[0].size:
            axes.plot(x[failed[1]], y[failed[0]], "x", color=VERMILION, markersize=4)
        known = np.nonzero(~np.ma.getmaskarray(table))
        axes.plot(
            x[known[1]], y[known[0]], "o", color="white", markersize=2.5, markeredgecolor=INK, markeredgewidth=0.4
        )
        _finish(axes, TITLES[name], _label(dataset, along), _label(dataset, up))
        axes.grid(False)
        for axis, at in ((axes.xaxis, x), (axes.yaxis, y)):
            axis.set_major_locator(FixedLocator(at.tolist()) if at.size <= TICK_LIMIT else MaxNLocator(5))
        plain_bar(figure.colorbar(drawn, ax=axes, pad=0.02), "")
    return figure


def _curves(dataset: xr.Dataset, names: list[str], along: str, own: OwnAxes) -> Figure:
    """Numbers over one coordinate, a curve a torque."""
    by = "torque" if "torque" in dataset.dims and along != "torque" else ""
    said = _reduced(dataset, names[0], (along, by))[1]
    figure, grid = _panels(dataset, f"Numbers over {along}", len(names), 2.3, ", ".join(said), own)
    order = np.argsort(dataset[along].values)
    for axes, name in zip(grid, names, strict=True):
        values = _reduced(dataset, name, (along, by))[0]
        lines = values.values.reshape(values.sizes[along], -1)[order]
        chosen, colours = np.zeros(1, int), np.array([colormaps["viridis"](0.35)])
        if by and by in values.dims:
            chosen = evenly_chosen(dataset[by].values, CURVE_LIMIT)
            colours = torque_colours(dataset[by].values[chosen])
        for index, colour in zip(chosen, colours, strict=True):
            label = torque_name(float(dataset[by].values[index])) if by else None
            line = {"color": colour, "linewidth": 1.6, "marker": "o", "markersize": 2.5}
            axes.plot(dataset[along].values[order], lines[:, index], label=label, **line)
        _finish(axes, TITLES[name], _label(dataset, along))
    if by:
        plain_legend(grid[0])
    return figure


def _pattern(dataset: xr.Dataset, own: OwnAxes) -> Figure:
    """Centre and extent of the contact pattern on the gear flank over one coordinate, a panel a torque."""
    points = point_dimensions(dataset)
    grids = [dim for dim in _grids(dataset) if dim in points]
    rows = [dim for dim in points if dim in ROWS]
    along = grids[0] if grids else rows[0] if rows else "torque"
    torques = evenly_chosen(dataset["torque"].values, 2) if "torque" in dataset.dims and along != "torque" else [0]
    keep = (along, "torque") if along != "torque" else (along,)
    said = _reduced(dataset, PATTERN[0], keep)[1]
    by, heading = along, f"Contact pattern under load over {along}"
    if along in ROWS:
        heading = f"Contact pattern under load of the {along.replace('_', ' ')}s"
        own_names = (name for name in swept_names(dataset) if dataset[name].dims == (along,))
        by = next((name for name in own_names if dataset[name].dtype.kind == "f"), along)
    else:
        said.append("dots: centre of the pattern, ellipses: its length and height")
    figure, grid = _panels(dataset, heading, len(torques), 2.6, ", ".join(said), own)
    shades = dataset[by].values.astype(float)
    scale = Normalize(float(shades.min()), float(shades.max()) if np.ptp(shades) else float(shades.min()) + 1.0)
    for axes, torque in zip(grid, torques, strict=True):
        t, h, length, height = (_at_torque(_reduced(dataset, name, keep)[0], int(torque)) for name in PATTERN)
        order = np.argsort(shades, kind="stable")
        colours = colormaps["viridis"](scale(shades))
        known = order[np.isfinite(t[order])]
        outlined = known[np.unique(np.linspace(0, known.size - 1, PATTERN_LIMIT).astype(int))] if known.size else known
        flank = axes.add_patch(Rectangle((0.0, 0.0), 1.0, 1.0, fill=False, edgecolor=GREY, linewidth=0.8))
        for i in outlined if along not in ROWS else []:
            style = {"fill": False, "edgecolor": colours[i], "linewidth": 0.9, "alpha": 0.8}
            outline = axes.add_patch(Ellipse((t[i], h[i]), length[i], height[i], **style))
            outline.set_clip_path(flank)
        if along not in ROWS:
            axes.plot(t[known], h[known], color=FAINT, linewidth=0.8)
        axes.scatter(t[known], h[known], c=colours[known], s=14, zorder=3)
        axes.set(xlim=(-0.03, 1.03), ylim=(-0.03, 1.03))
        of_torque = along != "torque" and "torque" in dataset.dims
        words = torque_name(float(dataset["torque"].values[torque])) if of_torque else ""
        _finish(axes, words, "toe 0 to heel 1", "root 0 to tip 1 (gear)")
    plain_bar(figure.colorbar(ScalarMappable(scale, "viridis"), ax=list(grid), pad=0.02), _label(dataset, by))
    return figure


def _at_torque(values: xr.DataArray, torque: int) -> Array:
    """Values over the coordinate alone."""
    if values.ndim == 2:
        values = values.isel(torque=torque)
    return np.asarray(values.values)


def _histograms(dataset: xr.Dataset, names: list[str], own: OwnAxes) -> Figure:
    """Histograms of the samples, one a torque, with percentiles."""
    said = _reduced(dataset, names[0], ("sample", "torque"))[1]
    heading = f"Histograms of {dataset.sizes['sample']} samples"
    figure, grid = _panels(dataset, heading, len(names), 2.3, ", ".join([*said, "lines: 5 %, median, 95 %"]), own)
    for axes, name in zip(grid, names, strict=True):
        values = _reduced(dataset, name, ("sample", "torque"))[0]
        columns = values.values.reshape(values.sizes["sample"], -1)
        by_torque = values.ndim == 2
        chosen = evenly_chosen(dataset["torque"].values, 3) if by_torque else np.zeros(1, int)
        colours = torque_colours(dataset["torque"].values[chosen]) if by_torque else [colormaps["viridis"](0.35)]
        count = int(np.clip(np.sqrt(values.sizes["sample"]), 5, BIN_LIMIT))
        for index, colour in zip(chosen, colours, strict=True):
            known = columns[:, index][np.isfinite(columns[:, index])]
            if not known.size:
                continue
            label = torque_name(float(dataset["torque"].values[index])) if by_torque else None
            axes.hist(known, bins=count, color=colour, alpha=0.55, label=label)
            for percent, value in zip(PERCENT, np.percentile(known, PERCENT), strict=True):
                style = "-" if percent == 50.0 else ":"
                axes.axvline(value, color=colour, linewidth=1.1, linestyle=style)
        _finish(axes, TITLES[name], y="samples")
    if "torque" in dataset.dims:
        plain_legend(grid[0])
    return figure


def _effects(dataset: xr.Dataset, names: list[str]) -> list[tuple[str, xr.Dataset]]:
    """Sensitivities of numbers by name; none of those to a single coordinate."""
    effects = []
    for name in names:
        try:
            effects.append((name, sensitivities(dataset, name)))
        except InputError:
            continue
    effects = [(name, one) for name, one in effects if bool(one["effect"].notnull().any())]
    return effects if effects and effects[0][1].sizes["coordinate"] > 1 else []


def _tornado(dataset: xr.Dataset, names: list[str], own: OwnAxes) -> Figure:
    """Change of numbers with one scale of every coordinate, the greatest on top."""
    effects = _effects(dataset, names)
    first = effects[0][1]
    at = {dim: -1 for dim in first["effect"].dims if dim != "coordinate"}
    said = [
        f"{dim} {first[dim].values[-1]:g} {UNITS.get(unit := str(first[dim].attrs.get('units', '')), unit)}"
        for dim in at
        if dim in first.coords and first.sizes[dim] > 1
    ]
    note = ", ".join([*said, "change with one standard deviation of the samples, or half the range of the grid"])
    bars = min(BAR_LIMIT, first.sizes["coordinate"])
    figure, grid = _panels(dataset, "Sensitivities, first order", len(effects), 0.9 + 0.28 * bars, note, own)
    for axes, (name, one) in zip(grid, effects, strict=True):
        effect = one["effect"].isel({dim: place for dim, place in at.items() if dim in one["effect"].dims}).values
        order = np.argsort(np.abs(np.nan_to_num(effect)))[::-1][:BAR_LIMIT][::-1]
        for sign, colour, label in ((1.0, BLUE, "coordinate increased"), (-1.0, FAINT, "decreased")):
            axes.barh(range(order.size), sign * effect[order], color=colour, height=0.6, label=label)
        axes.set_yticks(range(order.size), [_bar_label(dataset, one, int(i)) for i in order])
        widest = 1.1 * float(np.nanmax(np.abs(effect), initial=0.0)) or 1.0
        axes.set_xlim(-widest, widest)
        axes.axvline(0.0, color=GREY, linewidth=0.8)
        _finish(axes, f"change of {TITLES[name]}")
    if own is None:
        legend_at_foot(figure, grid[0].get_legend_handles_labels()[0], 0.28)
    return figure


def _bar_label(dataset: xr.Dataset, one: xr.Dataset, place: int) -> str:
    """A coordinate with its scale: of a key of the case file the member and the setting."""
    coordinate = str(one["coordinate"].values[place])
    unit = str(dataset[coordinate].attrs.get("units", ""))
    parts = coordinate.split(".")
    name = coordinate if len(parts) == 1 else f"{parts[0]} {parts[-1].replace('_', ' ')}"
    return f"{name}\n±{one['scale'].values[place]:.3g} {UNITS.get(unit, unit)}".strip()


DISPLACEMENTS = (
    ("E, offset", BLUE, "o"),
    ("P, pinion away along its axis", VERMILION, "s"),
    ("G, gear away along its axis", GREEN, "^"),
)
LINES: tuple[Any, ...] = ("-", (0, (5, 2)), (0, (1.5, 1.5)))  # of curves, told apart where they coincide


def draw_misalignment(tree: xr.DataTree, own: OwnAxes = None) -> Figure:
    """Draw the misalignment of a result over the torque; it has one that depends on it."""
    course = misalignment_over_torque(tree)
    assert course is not None
    torques, errors = course
    in_cycle = bool(np.any(np.ptp(errors, axis=1)))
    note = "marks: without load (pattern: at light load) and at every torque"
    last = float(np.asarray(tree.attrs.get("deflection_torques_N_m", (0.0, np.inf)))[1])
    layout: dict[str, Any] = {"sharex": True, "height_ratios": [1.6, 1.0, 1.0]}
    drawn_in = panels(tree, "Misalignment over the torque", 6.2, note, (3, 1), own, **layout)
    grid = drawn_in.axes
    for number, (label, colour, mark) in enumerate(DISPLACEMENTS):
        _curve(grid[0], torques, errors[:, :, number], label, colour, mark, LINES[number])
    _curve(grid[1], torques, np.degrees(errors[:, :, 3]), "Σ, shaft angle", INK, "D")
    for fraction, label, colour, mark, line in (
        ("lengthwise", "from toe", INK, "o", LINES[0]),
        ("profile", "from root", GREY, "s", LINES[1]),
    ):
        at, centres = _pattern_centres(tree, f"pattern_centre_{fraction}")
        _curve(grid[2], at, centres[:, None], label, colour, mark, line)
    grid[2].set_ylim(0.0, 100.0)
    labels = ("displacement [mm]", "angle [°]", "pattern centre [%]")
    for axes, label in zip(grid, labels, strict=True):
        plain_axes(axes, y=label)
        if torques[-1] > last:
            axes.axvspan(last, torques[-1], color=GREY, alpha=0.12, linewidth=0, zorder=0, label="beyond the table")
        if axes is not grid[2] and in_cycle:
            axes.fill_between([], [], [], color=GREY, alpha=0.18, linewidth=0, label="range over the mesh cycle")
        legend_of_curves(axes, on_page=drawn_in.on_page)
    for axes in grid[:2]:
        axes.axhline(0.0, color=GREY, linewidth=0.6, zorder=1)
    label_axes(grid[2], "torque at the pinion [N m]")
    for axes in grid:
        axes.set_xlim(left=0.0)
    if drawn_in.on_page:
        drawn_in.figure.align_ylabels(grid)
    return drawn_in.figure


def _pattern_centres(tree: xr.DataTree, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Torques (t), and the centre of the loaded pattern on the gear flank there (t) [%]; of light load, too."""
    groups = [tree[group].to_dataset() for group in ("light_load", "loaded") if group in tree.children]
    known = [group for group in groups if name in group]  # older results lack the pattern
    torques, centres = (np.concatenate([[], *(group[one].values for group in known)]) for one in ("torque", name))
    order = np.argsort(torques)
    return torques[order], 100.0 * centres[order]


def _curve(
    axes: Axes, torques: np.ndarray, values: np.ndarray, label: str, colour: str, mark: str, line: Any = "-"
) -> None:
    """Draw values over the torques (t, k): mean over the mesh cycle, and their range as a band."""
    mean = values.mean(axis=1)
    axes.plot(
        torques, mean, label=label, color=colour, marker=mark, markersize=3.5, linewidth=1.4, linestyle=line, zorder=3
    )
    if np.any(np.ptp(values, axis=1)):
        axes.fill_between(torques, values.min(axis=1), values.max(axis=1), color=colour, alpha=0.18, linewidth=0)


HEIGHT = 4.2  # [in]
MARKERS = "sd^v"
PRINTED = {"urad": "µrad", "um": "µm"}


def draw_front(tree: xr.DataTree, others: Mapping[str, Array], own: OwnAxes = None) -> Figure:
    """Draw a front; arguments as of ``study_figures.front``."""
    front, record = tree["front"].to_dataset(), tree["optimal_settings"].to_dataset()
    names = [str(name) for name in front["objective"].values]
    values = front["front_value"].transpose("point", "objective").values
    subplots = panels(tree, "Front of two objectives", HEIGHT, "every point analysed, settings rounded", (1, 1), own)
    axes = subplots.axes[0]
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
    plain_legend(axes)
    return subplots.figure


DEPTH_MAP = "YlOrBr"
OVER_TIME = ("largest_depth", "peak_to_peak", "max_pressure")
WEAR_PARTS = (*MEMBERS, *OVER_TIME)


def draw_wear(history: xr.Dataset, parts: str | Sequence[str] | None = None, own: OwnAxes = None) -> Figure:
    """Draw a history of wear; arguments as of ``study_figures.wear``."""
    names = chosen_parts(WEAR_PARTS, parts)
    rows, columns = -(-len(names) // 2), min(2, len(names))
    last = float(history["revolutions"][-1])
    note = f"{last:.4g} revolutions of the pinion, {history.sizes['step'] - 1} steps"
    subplots = panels(xr.DataTree(history), "Wear", 2.3 * rows, note, (rows, columns), own, count=len(names))
    for axes, name in zip(subplots.axes, names, strict=True):
        if name in MEMBERS:
            _draw_depth(axes, history["wear_depth"].isel(step=-1).sel(member=name), name)
        else:
            _draw_history(axes, history, name)
    return subplots.figure


def _draw_depth(axes: Axes, depth: xr.DataArray, member: str) -> None:
    """Draw the depth over the flank of a member."""
    values = depth.transpose("profile", "lengthwise").values
    place = 100.0 * depth["lengthwise"].values, 100.0 * depth["profile"].values
    levels = np.asarray(MaxNLocator(12).tick_values(0.0, max(float(np.nanmax(values, initial=0.0)), 1e-9)))
    drawn = axes.contourf(*place, values, levels=levels, cmap=DEPTH_MAP)
    plain_axes(axes, "from the toe [%]", "from the root [%]", f"depth on the {member} [µm]")
    axes.grid(False)
    figure: Any = axes.get_figure(root=True)
    plain_bar(figure.colorbar(drawn, ax=axes, pad=0.02, ticks=MaxNLocator(6)), "")


def _draw_history(axes: Axes, history: xr.Dataset, name: str) -> None:
    """Draw a number over the revolutions, a line a member or torque."""
    over = history["revolutions"].values
    if name == "largest_depth":
        for member, colour in zip(MEMBERS, (BLUE, VERMILION), strict=True):
            axes.plot(over, history[name].sel(member=member), "o-", color=colour, markersize=3, label=member)
    else:
        torques = history["torque"].values
        for index, colour in enumerate(torque_colours(torques)):
            label = torque_name(float(torques[index]))
            axes.plot(over, history[name].isel(torque=index), "o-", color=colour, markersize=3, label=label)
    axes.set_xlim(left=0.0)
    plain_axes(axes, "revolutions of the pinion", title=TITLES[name])
    plain_legend(axes)


ROW_COUNT_LIMIT = 30
ROW_HEIGHT = 0.26  # [in]
NAME_LENGTH_LIMIT = 22  # of a load case beside the chart [characters]


def draw_load_cases(tree: xr.DataTree, own: OwnAxes = None) -> Figure:
    """Draw an analysis over load cases, a row each; ``own`` are axes of the caller, one a panel."""
    numbers = tree["load_cases"].to_dataset()
    count = numbers.sizes["load_case"]
    rows = np.sort(evenly_chosen(np.arange(float(count)), ROW_COUNT_LIMIT))
    shown = numbers.isel(load_case=rows)
    bars = _bars(tree, rows, shown)
    note = "" if rows.size == count else f"{rows.size} of {count} load cases"
    layout: dict[str, Any] = {"sharey": True, "width_ratios": (1.6, *(1.0 for _ in bars))}
    subplots = panels(tree, "Load cases", ROW_HEIGHT * rows.size + 1.0, note, (1, 1 + len(bars)), own, **layout)
    grid = subplots.axes
    _draw_patterns(grid[0], shown)
    for axes, (label, values) in zip(grid[1:], bars, strict=True):
        _draw_bars(axes, label, values)
    for axes in grid if not subplots.on_page else grid[:1]:
        axes.set_ylim(rows.size - 0.4, -0.6)
        axes.set_yticks(np.arange(rows.size), [_name(shown, i) for i in range(rows.size)])
    return subplots.figure


def _bars(tree: xr.DataTree, rows: Array, shown: xr.Dataset) -> list[tuple[str, Array]]:
    """Labels and values of the panels with bars."""
    bars = [
        ("greatest pressure [MPa]", shown["max_pressure"].values),
        ("peak to peak [µrad]", shown["peak_to_peak"].values),
    ]
    if "mean_power_loss" in shown:
        bars.append(("power loss [W]", shown["mean_power_loss"].values))
    if "duty" in tree.children:
        duty = tree["duty"].to_dataset().isel(load_case=rows)
        exponent = float(duty["damage_exponent"][0])
        bars.append((f"damage to the flank [%], p = {exponent:.3g}", 100.0 * duty["damage_share"].values[:, 0]))
    return bars


def _draw_patterns(axes: Axes, shown: xr.Dataset) -> None:
    """Length of the patterns about their centres, and where the greatest pressure is."""
    plain_axes(axes)
    centre, length = (100.0 * shown[f"pattern_{name}"].values for name in ("centre_lengthwise", "length"))
    rows = np.arange(centre.size)
    axes.barh(rows, length, left=centre - 0.5 * length, height=0.55, color=BLUE, alpha=0.35)
    axes.plot(centre, rows, "o", color=INK, markersize=3.5)
    axes.plot(100.0 * shown["max_pressure_lengthwise"].values, rows, "x", color=VERMILION, markersize=5)
    axes.set_xlim(0.0, 100.0)
    label = "length of the pattern about its centre (dot),\ngreatest pressure (cross) [% from toe]"
    axes.set_xlabel(label, fontsize=SMALL_SIZE, color=INK)
    axes.tick_params(axis="y", labelsize=SMALL_SIZE)


def _draw_bars(axes: Axes, label: str, values: Array) -> None:
    plain_axes(axes)
    axes.barh(np.arange(values.size), np.nan_to_num(values), height=0.55, color=BLUE, alpha=0.75)
    axes.set_xlabel(label.replace(" [", "\n["), fontsize=SMALL_SIZE, color=INK)
    for row in np.flatnonzero(np.isnan(values)):
        axes.text(0.0, float(row), " no value", va="center", fontsize=SMALL_SIZE, color=GREY, style="italic")


def _name(shown: xr.Dataset, row: int) -> str:
    """Name and torque of a load case."""
    name = str(shown["load_case"].values[row])
    short = name if len(name) <= NAME_LENGTH_LIMIT else f"{name[: NAME_LENGTH_LIMIT - 3]}..."
    coast = ", coast" if str(shown["flank"].values[row]) == "coast" else ""
    return f"{short}\n{torque_name(float(shown['torque'].values[row]))}{coast}"
