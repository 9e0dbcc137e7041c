"""Charts of a sweep: maps, curves, shift of the contact pattern, histograms and tornado."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.checks import instance
from ...core.errors import InputError
from ..result import PATTERN
from ..summary.curves import torque_name
from ..summary.quantities import TITLES, UNIT_SIGNS, with_percent
from ..summary.sweep_report import outcome
from ..sweep.reductions import LOADS, ROWS, numbers, point_dimensions, reduced_dimensions, sensitivities, swept_names
from ..sweep.sweep_file import is_sweep
from .axes_style import legend_at_foot, plain_axes, plain_bar, plain_legend, torque_colours
from .matplotlib_defaults import picture
from .panel_grid import AxesChoice, chosen_parts, evenly_chosen, panels
from .style import BLUE, BODY_SIZE, FAINT, GREY, INK, VERMILION

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Numbers that are drawn, where a sweep has them.
DRAWN = (
    "peak_to_peak",
    "max_pressure",
    "contact_ratio",
    "pattern_centre_lengthwise",
    "max_root_stress",
    "efficiency",
)
#: Names of the pictures of a sweep; which there are depends on what is swept.
PICTURES = ("sweep_map", "sweep_curves", "sweep_pattern", "sweep_histograms", "sweep_tornado")
PANEL_LIMIT = 4
CURVE_LIMIT = 5
PATTERN_LIMIT = 7  # patterns that are outlined
BAR_LIMIT = 12  # coordinates of a tornado
BIN_LIMIT = 40
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


@picture
def sweep(
    dataset: xr.Dataset,
    picture: str | None = None,
    *,
    names: str | Sequence[str] | None = None,
    axes: AxesChoice = None,
) -> Figure | None:
    """A picture of a sweep.

    Parameters
    ----------
    dataset
        Of ``easeoff.sweep`` or ``study.sweep.read_sweep``.
    picture
        ``map`` over two grids, ``curves`` over one, ``pattern``, ``histograms`` of samples or ``tornado`` of
        sensitivities; the first of them that the sweep has if left out. ``pictures`` lists them with ``sweep_`` before.
    names
        Numbers to draw, a panel each: ``peak_to_peak``, ``max_pressure``, ``contact_ratio``,
        ``pattern_centre_lengthwise``, ``max_root_stress``, ``efficiency``; the first four of them if left out.
    axes
        An Axes a panel; a page of its own if left out. With them nothing is returned; ``layout="constrained"``
        of their figure makes room.

    Raises
    ------
    InputError
        If ``dataset`` is no sweep, does not have the picture or a number, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> dataset = easeoff.sweep("nasa-12x36", {"E": [0.0, 0.02, 0.04]}, torques=[100.0])
    >>> easeoff.plot.pictures(dataset)
    ('sweep_curves', 'sweep_pattern')
    >>> len(easeoff.plot.sweep(dataset, "curves", names="max_pressure").axes)
    1
    """
    if not is_sweep(dataset):
        raise InputError("dataset: must be of easeoff.sweep or study.sweep.read_sweep")
    instance("picture", picture, str | None)
    there = short_names(dataset)
    if not there:
        raise InputError("the sweep has no picture: nothing in it takes several values")
    picture = chosen_parts(there, there[0] if picture is None else picture.removeprefix("sweep_"), "picture")[0]
    known = [name for name in DRAWN if name in numbers(dataset) and bool(dataset[name].notnull().any())]
    shown = drawn_numbers(dataset) if names is None else list(chosen_parts(known, names, "names"))
    draw = {"map": _map, "curves": _curves, "pattern": _pattern, "histograms": _histograms, "tornado": _tornado}
    return draw[picture](with_percent(dataset), shown, axes)


def _grids(dataset: xr.Dataset) -> list[str]:
    """Swept grids of numbers with several values: those of points first, the longest first, then torque and speed."""
    swept = swept_names(dataset)
    dims = [str(dim) for dim in dataset["status"].dims if dim in swept and dataset.sizes[dim] > 1]
    dims = dims or [dim for dim in reduced_dimensions(dataset) if dim in LOADS and dataset.sizes[dim] > 1]
    dims = [dim for dim in dims if dataset[dim].dtype.kind in "fiu"]
    point_axes = set(point_dimensions(dataset))
    return sorted(dims, key=lambda dim: (dim not in point_axes, -dataset.sizes[dim]))


def _unit(variable: xr.DataArray) -> str:
    """Unit of a variable as pictures show it."""
    unit = str(variable.attrs.get("units", ""))
    return UNIT_SIGNS.get(unit, unit)


def _label(dataset: xr.Dataset, name: str) -> str:
    """A coordinate with its unit."""
    unit = _unit(dataset[name])
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
            said.append(f"{dim} {words} {_unit(dataset[dim])}".strip())
    return variable.transpose(*[dim for dim in keep if dim in variable.dims]), said


def _panels(
    dataset: xr.Dataset, heading: str, count: int, height: float, note: str, given: AxesChoice
) -> tuple[Figure, NDArray[Any]]:
    columns = 2 if count > 1 else 1
    rows = -(-count // columns)
    caption = " · ".join(filter(None, (outcome(dataset), note)))
    subplots = panels(xr.DataTree(dataset), heading, height * rows, caption, (rows, columns), given, count=count)
    return subplots.figure, subplots.axes


def _finish(axes: Axes, title: str, x: str = "", y: str = "") -> None:
    plain_axes(axes, x, y)
    axes.set_title(title, fontsize=BODY_SIZE, color=INK, loc="left")


def _map(dataset: xr.Dataset, names: list[str], given: AxesChoice) -> Figure:
    """Filled contours of numbers over the first two grids; failed points stay white."""
    from matplotlib.ticker import FixedLocator, MaxNLocator

    along, up, *_ = _grids(dataset)
    said = _reduced(dataset, names[0], (up, along))[1]
    figure, grid = _panels(dataset, f"Map over {along} and {up}", len(names), 2.7, ", ".join(said), given)
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


def _curves(dataset: xr.Dataset, names: list[str], given: AxesChoice) -> Figure:
    """Numbers over the first grid, a curve a torque."""
    along = _grids(dataset)[0]
    by = "torque" if "torque" in dataset.dims and along != "torque" else ""
    said = _reduced(dataset, names[0], (along, by))[1]
    figure, grid = _panels(dataset, f"Numbers over {along}", len(names), 2.3, ", ".join(said), given)
    order = np.argsort(dataset[along].values)
    for axes, name in zip(grid, names, strict=True):
        values = _reduced(dataset, name, (along, by))[0]
        lines = values.values.reshape(values.sizes[along], -1)[order]
        for index, colour, label in _by_torque(dataset, CURVE_LIMIT if by in values.dims else 0):
            line = {"color": colour, "linewidth": 1.6, "marker": "o", "markersize": 2.5}
            axes.plot(dataset[along].values[order], lines[:, index], label=label, **line)
        _finish(axes, TITLES[name], _label(dataset, along))
    if by:
        plain_legend(grid[0])
    return figure


def _by_torque(dataset: xr.Dataset, most: int) -> list[tuple[int, Any, str | None]]:
    """Numbers, colours and names of at most so many torques; of zero, the first without a name."""
    if not most:
        return [(0, torque_colours(np.zeros(1))[0], None)]
    torques = dataset["torque"].values
    chosen = evenly_chosen(torques, most)
    names = [torque_name(float(torques[index])) for index in chosen]
    return list(zip(chosen.tolist(), torque_colours(torques[chosen]), names, strict=True))


def _pattern(dataset: xr.Dataset, _names: list[str], given: AxesChoice) -> Figure:
    """Centre and extent of the contact pattern on the gear flank over one coordinate, a panel a torque."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.patches import Ellipse, Rectangle

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
    figure, grid = _panels(dataset, heading, len(torques), 2.6, ", ".join(said), given)
    shades = dataset[by].values.astype(float)
    scale = Normalize(float(shades.min()), float(shades.max()) if np.ptp(shades) else float(shades.min()) + 1.0)
    for axes, torque in zip(grid, torques, strict=True):
        at = {} if along == "torque" else {"torque": int(torque)}
        patterns = (_reduced(dataset, name, keep)[0].isel(at, missing_dims="ignore") for name in PATTERN)
        t, h, length, height = (np.asarray(one.values) for one in patterns)
        order = np.argsort(shades, kind="stable")
        colours = colormaps["viridis"](scale(shades))
        known = order[np.isfinite(t[order])]
        outlined = known[np.unique(np.linspace(0, known.size - 1, PATTERN_LIMIT).astype(int))] if known.size else known
        flank = axes.add_patch(Rectangle((0.0, 0.0), 100.0, 100.0, fill=False, edgecolor=GREY, linewidth=0.8))
        for i in outlined if along not in ROWS else []:
            style = {"fill": False, "edgecolor": colours[i], "linewidth": 0.9, "alpha": 0.8}
            outline = axes.add_patch(Ellipse((t[i], h[i]), length[i], height[i], **style))
            outline.set_clip_path(flank)
        if along not in ROWS:
            axes.plot(t[known], h[known], color=FAINT, linewidth=0.8)
        axes.scatter(t[known], h[known], c=colours[known], s=14, zorder=3)
        axes.set(xlim=(-3.0, 103.0), ylim=(-3.0, 103.0))
        of_torque = along != "torque" and "torque" in dataset.dims
        words = torque_name(float(dataset["torque"].values[torque])) if of_torque else ""
        _finish(axes, words, "from the toe [%]", "from the root [%] (gear)")
    plain_bar(figure.colorbar(ScalarMappable(scale, "viridis"), ax=list(grid), pad=0.02), _label(dataset, by))
    return figure


def _histograms(dataset: xr.Dataset, names: list[str], given: AxesChoice) -> Figure:
    """Histograms of the samples, one a torque, with percentiles."""
    said = _reduced(dataset, names[0], ("sample", "torque"))[1]
    heading = f"Histograms of {dataset.sizes['sample']} samples"
    figure, grid = _panels(dataset, heading, len(names), 2.3, ", ".join([*said, "lines: 5 %, median, 95 %"]), given)
    for axes, name in zip(grid, names, strict=True):
        values = _reduced(dataset, name, ("sample", "torque"))[0]
        columns = values.values.reshape(values.sizes["sample"], -1)
        count = int(np.clip(np.sqrt(values.sizes["sample"]), 5, BIN_LIMIT))
        for index, colour, label in _by_torque(dataset, 3 if values.ndim == 2 else 0):
            known = columns[:, index][np.isfinite(columns[:, index])]
            if not known.size:
                continue
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


def _tornado(dataset: xr.Dataset, names: list[str], given: AxesChoice) -> Figure:
    """Change of numbers with one scale of every coordinate, the greatest on top."""
    effects = _effects(dataset, names)
    first = effects[0][1]
    at = {dim: -1 for dim in first["effect"].dims if dim != "coordinate"}
    several = [dim for dim in at if dim in first.coords and first.sizes[dim] > 1]
    said = [f"{dim} {first[dim].values[-1]:g} {_unit(first[dim])}" for dim in several]
    note = ", ".join([*said, "change with one standard deviation of the samples, or half the range of the grid"])
    bars = min(BAR_LIMIT, first.sizes["coordinate"])
    figure, grid = _panels(dataset, "Sensitivities, first order", len(effects), 0.9 + 0.28 * bars, note, given)
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
    if given is None:
        legend_at_foot(figure, grid[0].get_legend_handles_labels()[0], 0.28)
    return figure


def _bar_label(dataset: xr.Dataset, one: xr.Dataset, place: int) -> str:
    """A coordinate with its scale: of a key of the case file the member and the setting."""
    coordinate = str(one["coordinate"].values[place])
    parts = coordinate.split(".")
    name = coordinate if len(parts) == 1 else f"{parts[0]} {parts[-1].replace('_', ' ')}"
    return f"{name}\n±{one['scale'].values[place]:.3g} {_unit(dataset[coordinate])}".strip()
