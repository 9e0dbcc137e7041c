"""Charts over the mesh cycle: transmission error, load sharing, pressure and root stress.

The transmission error is drawn without load and at every torque, and the share of the torque that each tooth pair
carries, both over two mesh cycles. The contact pressure on both flanks has a row a torque; the root stress is the
greatest tensile one in the fillets along the face.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...contact.evaluation.pressure_map import PressureMap, pressure_map
from ...contact.evaluation.tooth_passage import CYCLES, pairs_in_view, two_cycles, unloaded_curves
from ...contact.outcomes import Status
from ...core.arrays import Array
from ...geometry.pair.gear_pair import MEMBERS
from ...geometry.tooth.tooth_flanks import MemberName
from ..summary import curves
from ..summary.curves import Chart, torque_name
from ..summary.plausibility import edge_notes, jump_notes
from .axes_style import label_axes, legend_of_curves, panel_titles, plain_axes, plain_bar, plain_legend, torque_colours
from .matplotlib_defaults import picture
from .page import SEPARATOR, in_print
from .panel_grid import AxesChoice, chosen_parts, chosen_torques, evenly_chosen, panels, require_result
from .style import BLUE, FAINT, GREEN, GREY, INK, PRESSURE_MAP, SMALL_SIZE, VERMILION, WIDTH
from .tooth_view import ToothView, draw_flank, flank_views, shared_aspect, side_by_side

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.tri import TriContourSet

#: Panels, with their heights on a page [in].
HEIGHTS = {"unloaded": 2.5, "loaded": 2.3, "about_mean": 2.3, "orders": 2.3}
NAMED_TORQUE_LIMIT = 8  # in the legend
ORDER_COLOURS, ORDER_MARKS = (BLUE, VERMILION, GREEN, GREY), ("o", "s", "^", "D")
NAMED_STYLE: dict[str, Any] = {"linewidth": 1.6, "zorder": 3}
FADED_STYLE: dict[str, Any] = {"linewidth": 0.5, "alpha": 0.35, "zorder": 2}  # of the torques that are not named


@picture
def transmission_error(
    tree: xr.DataTree,
    *,
    torque: float | Sequence[float] | None = None,
    parts: str | Sequence[str] | None = None,
    axes: AxesChoice = None,
) -> Figure | None:
    """Transmission error over two mesh cycles, and its orders.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    torque
        One or several torques of the result at the pinion [N m]; all if left out.
    parts
        Panels: ``unloaded``, ``loaded``, ``about_mean`` (loaded, about its mean), ``orders`` (amplitudes at multiples
        of the mesh frequency: the first four over torque, or all at a single torque); all if left out.
    axes
        An Axes a panel; a page of its own if left out. With them nothing is returned; ``layout="constrained"``
        of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result, it does not have a torque, a part is not known, or ``axes`` are not as many as the
        panels.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> from matplotlib.figure import Figure
    >>> axes = Figure().subplots()
    >>> easeoff.plot.transmission_error(tree, parts="about_mean", axes=axes)
    >>> axes.get_title(loc="left"), axes.get_ylabel()
    ('transmission error', 'lag about its mean [µrad]')
    """
    require_result(tree)
    unloaded, loaded = tree["unloaded"].to_dataset(), tree["loaded"].to_dataset()
    if torque is not None:
        loaded = loaded.isel(torque=chosen_torques(loaded["torque"].values, torque))
    names = chosen_parts(tuple(HEIGHTS), parts)
    note = "lag of the gear, drawn downwards"
    heights = [HEIGHTS[name] for name in names]
    subplots = panels(tree, "Transmission error", sum(heights), note, (len(names), 1), axes, height_ratios=heights)
    over_time = [name for name in names if name != "orders"]
    every = np.arange(loaded.sizes["torque"])
    charts = {one.name: one for one in curves.transmission_error_charts(unloaded, loaded, every)}
    for panel, name in zip(subplots.axes, names, strict=True):
        if name == "orders":
            draw_orders(panel, charts, on_page=subplots.on_page)
            continue
        if name == "unloaded":
            draw_unloaded(panel, unloaded, on_page=subplots.on_page)
        else:
            draw_loaded(panel, loaded, charts, about_mean=name == "about_mean", on_page=subplots.on_page)
        panel.set_xlim(0, CYCLES)
        if name == over_time[-1] or not subplots.on_page:
            label_axes(panel, "mesh cycles (pinion pitches)")
        else:
            panel.tick_params(labelbottom=False)
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
        # The curves of the other pairs end far below: show how they leave, not where they end.
        extent = max(float(np.ptp(finite)), 1e-3)
        axes.set_ylim(float(finite.max()) + 0.6 * extent, float(finite.min()) - 0.12 * extent)
    else:
        axes.invert_yaxis()
    _finish(axes, "lag without load [µrad]", on_page=on_page)


def draw_loaded(
    axes: Axes, loaded: xr.Dataset, charts: Mapping[str, Chart], *, about_mean: bool, on_page: bool = True
) -> None:
    """Draw the curves of all torques, as they are or about their means."""
    torques, drawn = loaded["torque"].values, charts["te_mean" if about_mean else "te_loaded"].curves
    named = set(evenly_chosen(torques, NAMED_TORQUE_LIMIT).tolist())
    for index, (curve, colour) in enumerate(zip(drawn, torque_colours(torques), strict=True)):
        times, values = two_cycles(curve.y[:-1])
        finite = curve.y[:-1][np.isfinite(curve.y[:-1])]
        if finite.size == 0:
            continue
        swing = float(loaded["peak_to_peak"].values[index])
        text = f"peak to peak {swing:.1f} µrad" if about_mean else f"mean {finite.mean():.0f} µrad"
        if missing := curve.y.size - 1 - finite.size:
            text = f"{missing} of {curve.y.size - 1} missing"
        label = f"{curve.name}, {text}" if index in named else None
        axes.plot(times, values, color=colour, label=label, **(NAMED_STYLE if index in named else FADED_STYLE))
    heading = "" if len(named) == torques.size else f"{len(named)} of {torques.size} torques, the others pale"
    label = "lag about its mean [µrad]" if about_mean else "lag under load [µrad]"
    axes.invert_yaxis()
    _finish(axes, label, on_page=on_page, heading=heading)


def draw_orders(axes: Axes, charts: Mapping[str, Chart], *, on_page: bool = True) -> None:
    """Draw the amplitudes of the first orders of mesh frequency over torque, or of all orders at a single torque."""
    label = "amplitude of the orders [µrad]"
    if "te_torque" not in charts:
        (one,) = charts["te_orders"].curves
        if np.any(np.isfinite(one.y)):
            axes.bar(one.x, one.y, width=0.55, color=BLUE, label=one.name)
            axes.set_xticks(one.x)
        _finish(axes, label, charts["te_orders"].kind.x, on_page=on_page)
        return
    for one, colour, mark in zip(charts["te_torque"].curves[1:], ORDER_COLOURS, ORDER_MARKS, strict=False):
        if np.any(np.isfinite(one.y)):
            axes.plot(one.x, one.y, label=one.name, color=colour, linewidth=1.4, marker=mark, markersize=3.5)
    axes.set_ylim(bottom=0.0)
    _finish(axes, label, charts["te_torque"].kind.x, on_page=on_page)


def _finish(axes: Axes, label: str, abscissa: str = "", *, on_page: bool, heading: str = "") -> None:
    plain_axes(axes, abscissa, label, "" if on_page else "transmission error")
    if axes.get_legend_handles_labels()[0]:
        legend_of_curves(axes, on_page=on_page, heading=heading)
    else:
        axes.text(0.5, 0.5, "no certified solution", transform=axes.transAxes, ha="center", color=GREY)


NAME_WIDTH = 0.15  # of a pair's name [cycles]
COLOURS = (BLUE, VERMILION, GREEN)


@picture
def load_sharing(
    tree: xr.DataTree, *, torque: float | Sequence[float] | None = None, axes: AxesChoice = None
) -> Figure | None:
    """Share of the torque that each tooth pair carries, a panel a torque.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    torque
        One or several torques of the result at the pinion [N m]; up to six, spread evenly, if left out.
    axes
        An Axes a panel; a page of its own if left out. With them nothing is returned; ``layout="constrained"``
        of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result, it does not have a torque, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> figure = easeoff.plot.load_sharing(tree)
    >>> figure.axes[0].get_title(loc="left")
    '100 N m'
    """
    require_result(tree)
    loaded = tree["loaded"].to_dataset()
    torques = loaded["torque"].values
    chosen = chosen_torques(torques, torque)
    columns = 1 if chosen.size <= 3 else 2
    rows = -(-chosen.size // columns)
    note = "" if chosen.size == torques.size else f"{chosen.size} of {torques.size} torques"
    layout = {"count": chosen.size, "sharex": True, "sharey": True}
    heading = "Load sharing between tooth pairs"
    subplots = panels(tree, heading, 1.75 * rows + 0.4, note, (rows, columns), axes, **layout)
    for number, (panel, index) in enumerate(zip(subplots.axes, chosen, strict=True)):
        draw_shares(panel, loaded.isel(torque=int(index)), torque_name(torques[index]), named=number == 0)
        last, first = number + columns >= chosen.size, number % columns == 0
        if last or not subplots.on_page:
            label_axes(panel, "mesh cycles (pinion pitches)")
            panel.tick_params(labelbottom=True)
        if first or not subplots.on_page:
            label_axes(panel, y="share of the torque")
    return subplots.figure


def draw_shares(axes: Axes, at_torque: xr.Dataset, title: str, *, named: bool) -> None:
    """Draw the curves of the tooth pairs at one torque, with their numbers if ``named``."""
    from matplotlib.ticker import MultipleLocator, PercentFormatter

    course = curves.share_passage(at_torque)
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
    # Older results lack the contact ratio.
    known = "contact_ratio" in at_torque
    pairs = float(at_torque["contact_ratio"]) if known else curves.mean_pairs_in_contact(at_torque)
    missing = "some mesh positions missing" if np.any(np.isfinite(course.values)) else "no certified solution"
    text = f"contact ratio {pairs:.2f}" if np.isfinite(pairs) else missing
    panel_titles(axes, title, text)


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


@picture
def pressure(
    tree: xr.DataTree,
    *,
    torque: float | Sequence[float] | None = None,
    member: MemberName | None = None,
    axes: AxesChoice = None,
) -> Figure | None:
    """Greatest contact pressure over the mesh cycle, a row a torque.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    torque
        One or several torques of the result at the pinion [N m]; up to six, spread evenly, if left out.
    member
        ``gear`` or ``pinion``; both, side by side, if left out.
    axes
        An Axes a panel, row by row; a page of its own if left out. With them nothing is returned;
        ``layout="constrained"`` of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result, it does not have a torque, the member is not known, or ``axes`` are not as many as the
        panels.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0, 200.0])
    >>> figure = easeoff.plot.pressure(tree, torque=100.0)
    >>> [panel.get_title(loc="left") for panel in figure.axes[:2]]
    ['100 N m, gear', '100 N m, pinion']
    """
    from matplotlib.ticker import MaxNLocator

    require_result(tree)
    views = flank_views(tree, member)
    loaded = tree["loaded"].to_dataset()
    torques = loaded["torque"].values
    chosen = chosen_torques(torques, torque)
    shown = loaded.isel(torque=chosen)
    maps = [pressure_map(loaded.isel(torque=int(i))) for i in chosen]
    note = "+ peak, dashed: boundary of the common flank"
    note += "" if chosen.size == torques.size else f" · {chosen.size} of {torques.size} torques"
    note = SEPARATOR.join([note, *in_print([*edge_notes(shown), *jump_notes(shown)])])
    # What the axis labels and the colour bar leave of the page's width.
    height = chosen.size * ((WIDTH - 1.6) / len(views) * shared_aspect(views) + 0.27) + 0.35
    names = " and ".join(view.member for view in views)
    heading = f"Contact pressure over the mesh cycle, {names} flank"
    drawn_in = panels(tree, heading, height, note, (chosen.size, len(views)), axes)
    figure, grid = drawn_in.figure, drawn_in.axes.reshape(chosen.size, len(views))
    peaks = [surface.peak for surface in maps if np.isfinite(surface.peak)]
    levels = pressure_levels(max(peaks, default=1.0))
    shading = None
    for row, (index, surface) in enumerate(zip(chosen, maps, strict=True)):
        for column, view in enumerate(views):
            panel = grid[row, column]
            draw_flank(panel, view, labels=(row == chosen.size - 1, column == 0))
            drawn = draw_surface(panel, view, surface, levels)
            shading = shading or drawn
            panel_title(panel, f"{torque_name(torques[index])}, {view.member}", surface, loaded.isel(torque=int(index)))
    side_by_side(grid)
    if shading is not None:
        bar = figure.colorbar(shading, ax=list(grid.flat), shrink=0.75, aspect=28, pad=0.015, ticks=MaxNLocator(7))
        plain_bar(bar, "greatest contact pressure [MPa]")
    return figure


def pressure_levels(peak: float) -> NDArray[Any]:
    """Round, evenly spaced levels [MPa] beyond the peak; below the lowest, slightly above zero, nothing is coloured."""
    from matplotlib.ticker import MaxNLocator

    levels = np.asarray(MaxNLocator(LEVEL_COUNT, steps=[1, 2, 2.5, 5, 10]).tick_values(0.0, max(peak, 1e-3)))
    levels[0] = PRESSURE_THRESHOLD * levels[-1]
    return levels


def draw_surface(axes: Axes, view: ToothView, surface: PressureMap, levels: NDArray[Any]) -> TriContourSet | None:
    """Colour the loaded area and mark the greatest pressure; ``None`` if nothing carries load."""
    from matplotlib.tri import Triangulation

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


#: Panels of the root stress, each with the chart of its curves, the label of its abscissa and the end of it.
ROOT_STRESS_PARTS = {
    "face": ("root", "from the toe, along the face [%]", 100.0),
    "cycle": ("root_cycle", "mesh cycles (pinion pitches)", 2.0),
}


@picture
def root_stress(
    tree: xr.DataTree,
    *,
    torque: float | Sequence[float] | None = None,
    member: MemberName | None = None,
    parts: str | Sequence[str] | None = None,
    axes: AxesChoice = None,
) -> Figure | None:
    """Greatest root stress along the face and over the mesh cycle, of results with finite-element teeth.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    torque
        One or several torques of the result at the pinion [N m]; up to six, spread evenly, if left out.
    member
        ``pinion`` or ``gear``; both, side by side, if left out.
    parts
        Rows of panels: ``face``, ``cycle``; both if left out.
    axes
        An Axes a panel, row by row; a page of its own if left out. With them nothing is returned;
        ``layout="constrained"`` of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result or has no root stress, a name or torque is not known, or ``axes`` are not as many as
        the panels.

    Examples
    --------
    >>> import easeoff
    >>> case = easeoff.read_case("fm-11x41")
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 5, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> elastic = case.compliance.model_copy(update={"model": "fe", "fineness": 0.3})
    >>> contact = case.contact.model_copy(update=coarse)
    >>> case = case.model_copy(update={"contact": contact, "compliance": elastic})
    >>> tree = easeoff.analyze(case, torques=[100.0])
    >>> len(easeoff.plot.root_stress(tree).axes)
    4
    """
    require_result(tree, "root_stress")
    stress = tree["root_stress"].to_dataset()
    torques = stress["torque"].values
    chosen = chosen_torques(torques, torque)
    names, members = chosen_parts(tuple(ROOT_STRESS_PARTS), parts), chosen_parts(MEMBERS, member, "member")
    note = "greatest tensile stress around the fillet of the loaded side, over the mesh cycle or anywhere on the face"
    note += "" if torque is not None or chosen.size == torques.size else f" · {chosen.size} of {torques.size} torques"
    charts = {(one.name, one.member): one for one in curves.root_stress_charts(stress, chosen)}
    shape = (len(names), len(members))
    subplots = panels(tree, "Root stress", 2.5 * len(names), note, shape, axes, sharey="row")
    for number, panel in enumerate(subplots.axes):
        part, name = ROOT_STRESS_PARTS[names[number // len(members)]], members[number % len(members)]
        _draw_lines(panel, charts[part[0], name], torque_colours(torques[chosen]), part[2])
        panel_titles(panel, name)
        leftmost = number % len(members) == 0 or not subplots.on_page
        label_axes(panel, part[1], "root stress [MPa]" if leftmost else "")
    for panel in subplots.axes:  # only now: panels of a row share their limits
        panel.set_ylim(bottom=min(0.0, panel.get_ylim()[0]))
    plain_legend(subplots.axes[0])
    return subplots.figure


def _draw_lines(axes: Axes, chart: Chart, colours: NDArray[Any], span: float) -> None:
    """Draw a line a torque along the face, or over two mesh cycles."""
    for one, colour in zip(chart.curves, colours, strict=True):
        x, y = two_cycles(one.y[:-1]) if chart.kind.x == curves.CYCLE else (one.x, one.y)
        axes.plot(x, y, color=colour, linewidth=1.6, label=one.name)
    plain_axes(axes)
    axes.set_xlim(0.0, span)
    if not any(np.any(np.isfinite(one.y)) for one in chart.curves):
        axes.text(0.5, 0.5, "no certified solution", transform=axes.transAxes, ha="center", color=GREY)
