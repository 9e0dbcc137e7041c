"""Charts over the mesh cycle: transmission error, load sharing, pressure and root stress.

Transmission error chart: without load and at every torque, over two mesh cycles.

Load share chart: share of the torque that each tooth pair carries, over two mesh cycles.

Pressure chart: contact pressure on both flanks over the mesh cycle, a row a torque.

Root stress chart: the greatest tensile stress in the fillets along the face and over the mesh cycle.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator, PercentFormatter
from matplotlib.tri import Triangulation, TriContourSet
from numpy.typing import NDArray

from ...contact.evaluation.pressure_map import PressureMap, pressure_map
from ...contact.evaluation.tooth_passage import (
    CYCLES,
    ToothPassage,
    pairs_in_view,
    tooth_passage,
    two_cycles,
    unloaded_curves,
)
from ...contact.outcomes import Status
from ...core.arrays import Array
from ...core.attributes import ordered
from ...geometry.pair.gear_pair import MEMBERS
from ..summary.plausibility import edge_notes, jump_notes
from .page import (
    BLUE,
    BODY_SIZE,
    FAINT,
    GREEN,
    GREY,
    INK,
    PANEL_COUNT_LIMIT,
    PRESSURE_MAP,
    SEPARATOR,
    SMALL_SIZE,
    VERMILION,
    WIDTH,
    evenly_chosen,
    in_print,
    label_axes,
    legend_of_curves,
    panel_titles,
    plain_axes,
    plain_bar,
    plain_legend,
    torque_colours,
    torque_name,
)
from .panel_grid import OwnAxes, chosen_parts, chosen_torques, panels
from .tooth_view import ToothView, draw_flank, shared_aspect, side_by_side

#: Panels, with their heights on a page [in].
HEIGHTS = {"unloaded": 2.5, "loaded": 2.3, "about_mean": 2.3, "orders": 2.3}
ERROR_PARTS = tuple(HEIGHTS)
ORDER_COUNT = 4  # of the orders drawn over torque
NAMED_TORQUE_LIMIT = 8  # in the legend
ORDER_COLOURS, ORDER_MARKS = (BLUE, VERMILION, GREEN, GREY), ("o", "s", "^", "D")
NAMED_STYLE: dict[str, Any] = {"linewidth": 1.6, "zorder": 3}
FADED_STYLE: dict[str, Any] = {"linewidth": 0.5, "alpha": 0.35, "zorder": 2}  # of the torques that are not named


def draw_transmission_error(
    tree: xr.DataTree,
    torque: float | Sequence[float] | None = None,
    parts: str | Sequence[str] | None = None,
    own: OwnAxes = None,
) -> Figure:
    """Draw the transmission error chart of a result; arguments as of ``contact_figures.transmission_error``."""
    unloaded, loaded = tree["unloaded"].to_dataset(), tree["loaded"].to_dataset()
    if torque is not None:
        loaded = loaded.isel(torque=chosen_torques(loaded["torque"].values, torque, 0))
    names = chosen_parts(ERROR_PARTS, parts)
    note = "rotation of the gear, positive where the gear lags"
    heights = [HEIGHTS[name] for name in names]
    layout: dict[str, Any] = {"height_ratios": heights}
    subplots = panels(tree, "Transmission error", sum(heights), note, (len(names), 1), own, **layout)
    over_time = [name for name in names if name != "orders"]
    for axes, name in zip(subplots.axes, names, strict=True):
        if name == "orders":
            draw_orders(axes, loaded, on_page=subplots.on_page)
            continue
        if name == "unloaded":
            draw_unloaded(axes, unloaded, on_page=subplots.on_page)
        else:
            draw_loaded(axes, loaded, about_mean=name == "about_mean", on_page=subplots.on_page)
        axes.set_xlim(0, CYCLES)
        if name == over_time[-1] or not subplots.on_page:
            label_axes(axes, "mesh cycles (pinion pitches)")
        else:
            axes.tick_params(labelbottom=False)
    if subplots.on_page:
        subplots.figure.align_ylabels(subplots.axes)
    return subplots.figure


def draw_unloaded(axes: Axes, unloaded: xr.Dataset, *, on_page: bool = True) -> None:
    """Draw the curves of the tooth pairs and their envelope."""
    course, times, lowest = unloaded_curves(unloaded)
    for pair in pairs_in_view(course, CYCLES):
        label = "each tooth pair" if pair == 0 else None
        axes.plot(course.steps / course.per_cycle + pair, course.values, color=FAINT, linewidth=1.1, label=label)
    swing = unloaded.attrs.get("peak_to_peak", np.nan)
    axes.plot(times, lowest, color=BLUE, linewidth=2.0, label=f"pair that carries,\npeak to peak {swing:.1f} µrad")
    finite = lowest[np.isfinite(lowest)]
    if finite.size:
        # The curves of the other pairs rise far above: show how they leave, not where they end.
        extent = max(float(np.ptp(finite)), 1e-3)
        axes.set_ylim(float(finite.min()) - 0.12 * extent, float(finite.max()) + 0.6 * extent)
    _finish(axes, "without load [µrad]", on_page=on_page)


def draw_loaded(axes: Axes, loaded: xr.Dataset, *, about_mean: bool, on_page: bool = True) -> None:
    """Draw the curves of all torques, as they are or about their means."""
    torques = loaded["torque"].values
    error = loaded["transmission_error"].transpose("torque", "mesh_position").values
    named = set(evenly_chosen(torques, NAMED_TORQUE_LIMIT).tolist())
    for index, colour in enumerate(torque_colours(torques)):
        finite = error[index][np.isfinite(error[index])]
        if finite.size == 0:
            continue
        level = float(finite.mean())
        swing = float(loaded["peak_to_peak"].values[index])
        text = f"peak to peak {swing:.1f} µrad" if about_mean else f"mean {level:.0f} µrad"
        if finite.size < error.shape[1]:
            text = f"{error.shape[1] - finite.size} of {error.shape[1]} missing"
        label = f"{torque_name(torques[index])}, {text}" if index in named else None
        times, values = two_cycles(error[index] - level if about_mean else error[index])
        axes.plot(times, values, color=colour, label=label, **(NAMED_STYLE if index in named else FADED_STYLE))
    heading = "" if len(named) == torques.size else f"{len(named)} of {torques.size} torques, the others pale"
    label = "under load, about its mean [µrad]" if about_mean else "under load [µrad]"
    _finish(axes, label, on_page=on_page, heading=heading)


def draw_orders(axes: Axes, loaded: xr.Dataset, *, on_page: bool = True) -> None:
    """Draw the amplitudes of the first orders of mesh frequency over torque, or of all orders at a single torque."""
    orders = loaded["order"].values
    amplitudes = loaded["harmonic"].transpose("torque", "order").values
    torques = loaded["torque"].values
    label = "amplitude of the orders [µrad]"
    if torques.size == 1:
        if np.any(np.isfinite(amplitudes)):
            axes.bar(orders, amplitudes[0], width=0.55, color=BLUE, label=torque_name(float(torques[0])))
            axes.set_xticks(orders)
        _finish(axes, label, "order of the mesh frequency", on_page=on_page)
        return
    rank = np.argsort(torques)
    for number in range(min(ORDER_COUNT, orders.size)):
        if np.any(np.isfinite(amplitudes[:, number])):
            line: dict[str, Any] = {"color": ORDER_COLOURS[number], "linewidth": 1.4}
            mark: dict[str, Any] = {"marker": ORDER_MARKS[number], "markersize": 3.5}
            axes.plot(torques[rank], amplitudes[rank, number], label=f"order {orders[number]:g}", **line, **mark)
    axes.set_ylim(bottom=0.0)
    _finish(axes, label, "torque at the pinion [N m]", on_page=on_page)


def _finish(axes: Axes, label: str, abscissa: str = "", *, on_page: bool, heading: str = "") -> None:
    plain_axes(axes, abscissa, label, "" if on_page else "transmission error")
    if axes.get_legend_handles_labels()[0]:
        legend_of_curves(axes, on_page=on_page, heading=heading)
    else:
        axes.text(0.5, 0.5, "no certified solution", transform=axes.transAxes, ha="center", color=GREY)


NAME_WIDTH = 0.15  # of a pair's name [cycles]
COLOURS = (BLUE, VERMILION, GREEN)


def share_passage(at_torque: xr.Dataset) -> ToothPassage:
    """Share of the torque of one tooth pair over its passage, NaN outside contact but for a zero at both ends."""
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


def draw_load_sharing(tree: xr.DataTree, torque: float | Sequence[float] | None = None, own: OwnAxes = None) -> Figure:
    """Draw the load share chart of a result; arguments as of ``contact_figures.load_sharing``."""
    loaded = tree["loaded"].to_dataset()
    torques = loaded["torque"].values
    chosen = chosen_torques(torques, torque, PANEL_COUNT_LIMIT)
    columns = 1 if chosen.size <= 3 else 2
    rows = -(-chosen.size // columns)
    note = "" if chosen.size == torques.size else f"{chosen.size} of {torques.size} torques"
    layout = {"count": chosen.size, "sharex": True, "sharey": True}
    heading = "Load sharing between tooth pairs"
    subplots = panels(tree, heading, 1.75 * rows + 0.4, note, (rows, columns), own, **layout)
    for number, (axes, index) in enumerate(zip(subplots.axes, chosen, strict=True)):
        draw_shares(axes, loaded.isel(torque=int(index)), torque_name(torques[index]), named=number == 0)
        last, first = number + columns >= chosen.size, number % columns == 0
        if last or not subplots.on_page:
            label_axes(axes, "mesh cycles (pinion pitches)")
            axes.tick_params(labelbottom=True)
        if first or not subplots.on_page:
            label_axes(axes, y="share of the torque")
    return subplots.figure


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


PRESSURE_THRESHOLD = 0.01  # over the greatest pressure; less is not coloured
LEVEL_COUNT = 24


def draw_pressure(
    tree: xr.DataTree,
    views: tuple[ToothView, ...],
    torque: float | Sequence[float] | None = None,
    own: OwnAxes = None,
) -> Figure:
    """Draw the pressure chart of a result on its flanks; arguments as of ``contact_figures.pressure``."""
    loaded = tree["loaded"].to_dataset()
    torques = loaded["torque"].values
    chosen = chosen_torques(torques, torque, PANEL_COUNT_LIMIT)
    shown = loaded.isel(torque=chosen)
    maps = [pressure_map(loaded.isel(torque=int(i))) for i in chosen]
    note = "+ peak, dashed: boundary of the common flank"
    note += "" if chosen.size == torques.size else f" · {chosen.size} of {torques.size} torques"
    note = SEPARATOR.join([note, *in_print([*edge_notes(shown), *jump_notes(shown)])])
    # What the axis labels and the colour bar leave of the page's width.
    height = chosen.size * ((WIDTH - 1.6) / len(views) * shared_aspect(views) + 0.27) + 0.35
    names = " and ".join(view.member for view in views)
    heading = f"Contact pressure over the mesh cycle, {names} flank"
    drawn_in = panels(tree, heading, height, note, (chosen.size, len(views)), own)
    figure, grid = drawn_in.figure, drawn_in.axes.reshape(chosen.size, len(views))
    peaks = [surface.peak for surface in maps if np.isfinite(surface.peak)]
    levels = pressure_levels(max(peaks, default=1.0))
    shading = None
    for row, (index, surface) in enumerate(zip(chosen, maps, strict=True)):
        for column, view in enumerate(views):
            axes = grid[row, column]
            draw_flank(axes, view, labels=(row == chosen.size - 1, column == 0))
            drawn = draw_surface(axes, view, surface, levels)
            shading = shading or drawn
            panel_title(axes, f"{torque_name(torques[index])}, {view.member}", surface, loaded.isel(torque=int(index)))
    side_by_side(grid)
    if shading is not None:
        bar = figure.colorbar(shading, ax=list(grid.flat), shrink=0.75, aspect=28, pad=0.015, ticks=MaxNLocator(7))
        plain_bar(bar, "greatest contact pressure [MPa]")
    return figure


def pressure_levels(peak: float) -> NDArray[Any]:
    """Round, evenly spaced levels [MPa] beyond the peak; below the lowest, slightly above zero, nothing is coloured."""
    levels = np.asarray(MaxNLocator(LEVEL_COUNT, steps=[1, 2, 2.5, 5, 10]).tick_values(0.0, max(peak, 1e-3)))
    levels[0] = PRESSURE_THRESHOLD * levels[-1]
    return levels


def draw_surface(axes: Axes, view: ToothView, surface: PressureMap, levels: NDArray[Any]) -> TriContourSet | None:
    """Colour the loaded area and mark the greatest pressure; ``None`` if nothing carries load."""
    if surface.triangles.size == 0 or not surface.peak > levels[0]:
        return None
    points = view.in_plane(surface.points)
    mesh = Triangulation(points[0], points[1], surface.triangles)
    shading = axes.tricontourf(mesh, surface.pressure, levels=levels, cmap=PRESSURE_MAP, zorder=2)
    if np.min(surface.pressure) < levels[0]:
        axes.tricontour(mesh, surface.pressure, levels=levels[:1], colors=INK, linewidths=0.6, zorder=3)
    peak = view.in_plane(surface.peak_point)
    axes.plot(*peak, marker="+", markersize=8, markeredgewidth=2.4, color="white", zorder=8)
    axes.plot(*peak, marker="+", markersize=7, markeredgewidth=1.1, color=INK, zorder=9)
    return shading


def panel_title(axes: Axes, torque: str, surface: PressureMap, at_torque: xr.Dataset) -> None:
    """Title of a panel: torque, greatest pressure and number of missing mesh positions."""
    missing = int(np.sum(at_torque["status"].values != Status.CERTIFIED))
    peak = "no certified solution"
    if missing < at_torque.sizes["mesh_position"]:
        peak = f"peak {surface.peak:.0f} MPa" if surface.peak > 0.0 else "load on sharp edges alone"
    if missing and surface.peak > 0.0:
        peak += f" · {missing} of {at_torque.sizes['mesh_position']} mesh positions missing"
    panel_titles(axes, torque, peak)


ROOT_STRESS_PARTS = ("face", "cycle")
LABELS = {"face": "from the toe, along the face [%]", "cycle": "mesh cycles (pinion pitches)"}


def draw_root_stress(
    tree: xr.DataTree,
    torque: float | Sequence[float] | None = None,
    member: str | None = None,
    parts: str | Sequence[str] | None = None,
    own: OwnAxes = None,
) -> Figure:
    """Draw the root stress chart of a result; arguments as of ``contact_figures.root_stress``."""
    stress = tree["root_stress"].to_dataset()
    torques = stress["torque"].values
    chosen = chosen_torques(torques, torque, PANEL_COUNT_LIMIT)
    names, members = chosen_parts(ROOT_STRESS_PARTS, parts), chosen_parts(MEMBERS, member, "member")
    note = "greatest tensile stress around the fillet of the loaded side, over the mesh cycle or anywhere on the face"
    note += "" if torque is not None or chosen.size == torques.size else f" · {chosen.size} of {torques.size} torques"
    shape = (len(names), len(members))
    subplots = panels(tree, "Root stress", 2.5 * len(names), note, shape, own, sharey="row")
    for number, axes in enumerate(subplots.axes):
        part, name = names[number // len(members)], members[number % len(members)]
        _draw_lines(axes, stress, part, name, chosen)
        axes.set_title(name, loc="left", fontsize=SMALL_SIZE + 1.5, color=INK, weight="bold", pad=3)
        leftmost = number % len(members) == 0 or not subplots.on_page
        label_axes(axes, LABELS[part], "root stress [MPa]" if leftmost else "")
    for axes in subplots.axes:  # only now: panels of a row share their limits
        axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    plain_legend(subplots.axes[0])
    return subplots.figure


def greatest_over_pairs(stress: xr.Dataset, torque: int, member: str) -> NDArray[np.float64]:
    """Greatest root stress of the teeth in mesh (mesh_position) [MPa]; NaN where there is none."""
    history = stress["root_stress_history"].isel(torque=torque).sel(member=member)
    values = history.transpose("mesh_position", "pair").values
    return np.where(np.any(np.isfinite(values), axis=1), np.max(np.nan_to_num(values, nan=-np.inf), axis=1), np.nan)


def _draw_lines(axes: Axes, stress: xr.Dataset, part: str, member: str, chosen: NDArray[np.int64]) -> None:
    """Draw a line a torque."""
    torques = stress["torque"].values
    along = ordered(stress.sel(member=member), "root_stress", "torque", "lengthwise")
    for index, colour in zip(chosen, torque_colours(torques[chosen]), strict=True):
        label = torque_name(float(torques[index]))
        if part == "face":
            axes.plot(100.0 * stress["lengthwise"].values, along[index], color=colour, linewidth=1.6, label=label)
        else:
            times, values = two_cycles(greatest_over_pairs(stress, int(index), member))
            axes.plot(times, values, color=colour, linewidth=1.6, label=label)
    plain_axes(axes)
    axes.set_xlim((0.0, 100.0) if part == "face" else (0.0, 2.0))
    if not np.any(np.isfinite(along[chosen])):
        axes.text(0.5, 0.5, "no certified solution", transform=axes.transAxes, ha="center", color=GREY)
