"""Charts of studies: misalignment over the torque, fronts of two objectives, wear, load cases and V-H checks."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.arrays import Array
from ...core.checks import instance
from ...core.errors import InputError
from ...geometry.pair.gear_pair import MEMBERS
from ..summary.assembly import misalignment_over_torque
from ..summary.curves import Chart, torque_name, wear_charts
from ..summary.quantities import TITLES, UNIT_SIGNS
from ..summary.sweep_report import SIGNS, totals
from .axes_style import label_axes, legend_of_curves, panel_titles, plain_axes, plain_bar, plain_legend, torque_colours
from .contact_pattern_chart import COMPOUND
from .matplotlib_defaults import picture
from .page import SEPARATOR, page
from .panel_grid import AxesChoice, chosen_parts, evenly_chosen, panels, require_result
from .style import BLUE, BODY_SIZE, FAINT, GREEN, GREY, INK, PAPER, SMALL_SIZE, VERMILION, WIDTH

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DISPLACEMENTS = (
    ("E, offset", BLUE, "o"),
    ("P, pinion away along its axis", VERMILION, "s"),
    ("G, gear away along its axis", GREEN, "^"),
)
LINES: tuple[Any, ...] = ("-", (0, (5, 2)), (0, (1.5, 1.5)))  # of curves, told apart where they coincide


@picture
def misalignment(tree: xr.DataTree, *, axes: AxesChoice = None) -> Figure | None:
    """Misalignment E, P, G and Sigma over the torque, and the centre of the pattern that moves with them.

    Parameters
    ----------
    tree
        A result on supports, or with deflections over the torque.
    axes
        Three Axes: displacements, angle, centre of the pattern; a page of its own if left out. With them
        nothing is returned; ``layout="constrained"`` of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result, its misalignment does not depend on the torque, or there are not three ``axes``.

    Examples
    --------
    >>> import easeoff
    >>> from easeoff.cases import Deflections
    >>> axle = Deflections([0.0, 200.0], offset=[0.0, 0.05])
    >>> case = easeoff.read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update={"mesh_positions": 3})})
    >>> tree = easeoff.analyze(case, torques=[100.0], misalignment=axle)
    >>> len(easeoff.plot.misalignment(tree).axes)
    3
    """
    require_result(tree)
    course = misalignment_over_torque(tree)
    if course is None:
        raise InputError(
            "tree: its misalignment does not depend on the torque; give supports, or a table of deflections"
        )
    torques, errors = course
    in_cycle = bool(np.any(np.ptp(errors, axis=1)))
    note = "marks: without load (pattern: at light load) and at every torque"
    last = float(np.asarray(tree.attrs.get("deflection_torques_N_m", (0.0, np.inf)))[1])
    layout: dict[str, Any] = {"sharex": True, "height_ratios": [1.6, 1.0, 1.0]}
    drawn_in = panels(tree, "Misalignment over the torque", 6.2, note, (3, 1), axes, **layout)
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
    for panel, label in zip(grid, labels, strict=True):
        plain_axes(panel, y=label)
        if torques[-1] > last:
            panel.axvspan(last, torques[-1], color=GREY, alpha=0.12, linewidth=0, zorder=0, label="beyond the table")
        if panel is not grid[2] and in_cycle:
            panel.fill_between([], [], [], color=GREY, alpha=0.18, linewidth=0, label="range over the mesh cycle")
        legend_of_curves(panel, on_page=drawn_in.on_page)
    for panel in grid[:2]:
        panel.axhline(0.0, color=GREY, linewidth=0.6, zorder=1)
    label_axes(grid[2], "torque at the pinion [N m]")
    for panel in grid:
        panel.set_xlim(left=0.0)
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


@picture
def front(
    tree: xr.DataTree, *, others: Mapping[str, NDArray[Any]] | None = None, axes: AxesChoice = None
) -> Figure | None:
    """Front of two objectives, with the start.

    Parameters
    ----------
    tree
        Of ``easeoff.optimize`` with ``form="pareto"``.
    others
        Points (n, 2) of both objectives that other methods found, by the name in the legend.
    axes
        An Axes; a page of its own if left out. With it nothing is returned.

    Raises
    ------
    InputError
        If ``tree`` has no front, or ``axes`` is not one.

    Examples
    --------
    >>> import easeoff
    >>> easeoff.plot.front(easeoff.analyze("nasa-12x36", torques=[100.0]))
    Traceback (most recent call last):
    easeoff.core.errors.InputError: tree: the result has no group 'front': 'easeoff optimize --form pareto' makes it
    """
    require_result(tree, "loaded", "front", "optimal_settings")
    of_front, record = tree["front"].to_dataset(), tree["optimal_settings"].to_dataset()
    names = [str(name) for name in of_front["objective"].values]
    values = of_front["front_value"].transpose("point", "objective").values
    subplots = panels(tree, "Front of two objectives", HEIGHT, "every point analysed, settings rounded", (1, 1), axes)
    panel = subplots.axes[0]
    for (label, points), marker in zip((others or {}).items(), itertools.cycle(MARKERS), strict=False):
        panel.plot(*np.asarray(points, dtype=float).T, marker, color=FAINT, markersize=4.0, label=label)
    panel.plot(*values.T, "o-", color=BLUE, linewidth=1.0, markersize=4.5, label="front")
    chosen = int(of_front.attrs["chosen_point"])
    panel.plot(*values[chosen], "o", color=BLUE, markersize=8.0, fillstyle="none", label="in this result")
    panel.plot(*record["objective_start"].values, "x", color=INK, markersize=7.0, label="start")
    plain_axes(panel)
    units = [UNIT_SIGNS.get(unit, unit) for unit in of_front["objective_units"].values.tolist()]
    panel.set_xlabel(f"{names[0]} [{units[0]}]", fontsize=BODY_SIZE, color=INK, parse_math=False)
    panel.set_ylabel(f"{names[1]} [{units[1]}]", fontsize=BODY_SIZE, color=INK, parse_math=False)
    plain_legend(panel)
    return subplots.figure


DEPTH_MAP = "YlOrBr"
OVER_TIME = ("largest_depth", "peak_to_peak", "max_pressure")
WEAR_PARTS = (*MEMBERS, *OVER_TIME)


@picture
def wear(history: xr.Dataset, *, parts: str | Sequence[str] | None = None, axes: AxesChoice = None) -> Figure | None:
    """Wear of both flanks at the end, and depth, transmission error and pressure over the revolutions.

    Parameters
    ----------
    history
        Of ``study.wear``.
    parts
        Panels: ``pinion``, ``gear``, ``largest_depth``, ``peak_to_peak``, ``max_pressure``; all if left out.
    axes
        An Axes a panel; a page of its own if left out. With them nothing is returned; ``layout="constrained"``
        of their figure makes room.

    Raises
    ------
    InputError
        If ``history`` is none of wear, a part is not known, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> coarse = {"mesh_positions": 4, "segments_per_line": 9, "lengthwise_nodes": 11, "profile_nodes": 9}
    >>> case = easeoff.read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> history = easeoff.study.wear(case, easeoff.study.WearLaw(1e-12, 1e-12, revolutions=1e5), torque=100.0)
    >>> len(easeoff.plot.wear(history, parts=["largest_depth", "max_pressure"]).axes)
    2
    """
    instance("history", history, xr.Dataset)
    if "wear_depth" not in history or "revolutions" not in history:
        raise InputError("history: must be of 'easeoff wear' or study.wear")
    names = chosen_parts(WEAR_PARTS, parts)
    rows, columns = -(-len(names) // 2), min(2, len(names))
    last = float(history["revolutions"][-1])
    note = f"{last:.4g} revolutions of the pinion, {history.sizes['step'] - 1} steps"
    subplots = panels(xr.DataTree(history), "Wear", 2.3 * rows, note, (rows, columns), axes, count=len(names))
    charts = {one.kind.source: one for one in wear_charts(history)}
    for panel, name in zip(subplots.axes, names, strict=True):
        if name in MEMBERS:
            _draw_depth(panel, history["wear_depth"].isel(step=-1).sel(member=name), name)
        else:
            _draw_history(panel, charts[name], history["torque"].values)
    return subplots.figure


def _draw_depth(axes: Axes, depth: xr.DataArray, member: str) -> None:
    """Draw the depth over the flank of a member."""
    from matplotlib.ticker import MaxNLocator

    values = depth.transpose("profile", "lengthwise").values
    place = 100.0 * depth["lengthwise"].values, 100.0 * depth["profile"].values
    levels = np.asarray(MaxNLocator(12).tick_values(0.0, max(float(np.nanmax(values, initial=0.0)), 1e-9)))
    drawn = axes.contourf(*place, values, levels=levels, cmap=DEPTH_MAP)
    plain_axes(axes, "from the toe [%]", "from the root [%]", f"depth on the {member} [µm]")
    axes.grid(False)
    figure: Any = axes.get_figure(root=True)
    plain_bar(figure.colorbar(drawn, ax=axes, pad=0.02, ticks=MaxNLocator(6)), "")


def _draw_history(axes: Axes, chart: Chart, torques: Array) -> None:
    """Draw a number over the revolutions, a line a member or torque."""
    colours = (BLUE, VERMILION) if chart.name == "wear_depth" else torque_colours(torques)
    for one, colour in zip(chart.curves, colours, strict=True):
        axes.plot(one.x, one.y, "o-", color=colour, markersize=3, label=one.name)
    axes.set_xlim(left=0.0)
    plain_axes(axes, chart.kind.x, title=TITLES[chart.kind.source])
    plain_legend(axes)


ROW_COUNT_LIMIT = 30
ROW_HEIGHT = 0.26  # [in]
NAME_LENGTH_LIMIT = 22  # of a load case beside the chart [characters]


@picture
def load_cases(tree: xr.DataTree, *, axes: AxesChoice = None) -> Figure | None:
    """Pattern, pressure, transmission error, power loss and damage of load cases, a row each.

    Parameters
    ----------
    tree
        Of ``study.analyze_load_cases``.
    axes
        An Axes a panel: pattern, greatest pressure, peak to peak, and power loss and damage if the result has
        them; a page of its own if left out. With them nothing is returned; ``layout="constrained"`` of their
        figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result over load cases, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> from easeoff.cases import LoadCase
    >>> from easeoff.study import analyze_load_cases
    >>> case = easeoff.read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update={"mesh_positions": 3})})
    >>> tree = analyze_load_cases(case, [LoadCase(name="climb", torque=100.0)])
    >>> len(easeoff.plot.load_cases(tree).axes)
    3
    """
    require_result(tree, "load_cases")
    numbers = tree["load_cases"].to_dataset()
    count = numbers.sizes["load_case"]
    rows = np.sort(evenly_chosen(np.arange(float(count)), ROW_COUNT_LIMIT))
    shown = numbers.isel(load_case=rows)
    bars = _bars(tree, rows, shown)
    note = "" if rows.size == count else f"{rows.size} of {count} load cases"
    layout: dict[str, Any] = {"sharey": True, "width_ratios": (1.6, *(1.0 for _ in bars))}
    subplots = panels(tree, "Load cases", ROW_HEIGHT * rows.size + 1.0, note, (1, 1 + len(bars)), axes, **layout)
    grid = subplots.axes
    _draw_patterns(grid[0], shown)
    for panel, (label, values) in zip(grid[1:], bars, strict=True):
        _draw_bars(panel, label, values)
    for panel in grid if not subplots.on_page else grid[:1]:
        panel.set_ylim(rows.size - 0.4, -0.6)
        panel.set_yticks(np.arange(rows.size), [_name(shown, i) for i in range(rows.size)])
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


VH_PARTS = ("places", "grid")


@picture
def vh_check(check: xr.Dataset, *, parts: str | Sequence[str] | None = None, axes: AxesChoice = None) -> Figure | None:
    """Marking prints of a V-H check at toe, middle and heel, and over the grid of V and H.

    Parameters
    ----------
    check
        Of ``study.vh_check``.
    parts
        ``places`` and, if it was asked for, ``grid``; both if left out.
    axes
        An Axes a print: toe, middle, heel, then the grid from the greatest H, from left to right; a page of its
        own if left out. With them nothing is returned; ``layout="constrained"`` of their figure makes room.

    Raises
    ------
    InputError
        If ``check`` is no V-H check, a part is not known, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> check = easeoff.study.vh_check("fh-design-a")
    >>> len(easeoff.plot.vh_check(check).axes)
    3
    """
    instance("check", check, xr.Dataset)
    if "print_excess" not in check or "in_plane" not in check:
        raise InputError("check: must be of 'easeoff vh' or study.vh_check")
    names = chosen_parts(VH_PARTS if "v_grid" in check.sizes else VH_PARTS[:1], parts)
    plane = check["in_plane"].values
    count, columns = check.sizes["place"], check.sizes.get("v_grid", 0)
    wanted = {"places": count, "grid": columns * check.sizes.get("h_grid", 0)}
    if axes is not None:
        shape = (1, sum(wanted[name] for name in names))
        given = panels(xr.DataTree(check), "V-H check", 0.0, "", shape, axes)
        if "places" in names:
            _draw_places(given.axes[:count], check, plane)
        if "grid" in names:
            _draw_grid(given.axes[-wanted["grid"] :].reshape(-1, columns), check, plane)
        return given.figure
    aspect = float(np.ptp(plane[1]) / np.ptp(plane[0]))
    heights = {"places": (WIDTH - 0.5) / 3 * aspect + 0.45}
    if columns:
        heights["grid"] = check.sizes["h_grid"] * ((WIDTH - 0.7) / columns * aspect + 0.06) + 0.75
    ratios = [heights[name] for name in names]
    figure = page(xr.DataTree(check), "V-H check", sum(ratios), _small_print(check))
    subfigures: Any = figure.subfigures(len(names), 1, height_ratios=ratios, squeeze=False)[:, 0]
    for part, name in zip(subfigures, names, strict=True):
        if name == "places":
            _draw_places(part.subplots(1, count), check, plane)
            continue
        _draw_grid(part.subplots(check.sizes["h_grid"], columns, squeeze=False), check, plane)
        part.supxlabel("V [mm]", fontsize=SMALL_SIZE + 0.5, color=INK)
        part.supylabel("H [mm]", fontsize=SMALL_SIZE + 0.5, color=INK)
        part.suptitle("prints over V and H", x=0.02, ha="left", fontsize=BODY_SIZE, color=INK, weight="bold")
    return figure


def _small_print(check: xr.Dataset) -> str:
    """Totals, thickness of the compound, marks, and what V and H are positive for."""
    parts = [totals(check)] if "total_v" in check else []
    parts.append(f"print of {check.attrs['separation']:g} µm, toe left")
    parts += ["dot: centre", "cross: where it is wanted"]
    parts += SIGNS
    return SEPARATOR.join(parts).replace("-0", "−0")


def _draw_places(grid: Any, check: xr.Dataset, plane: Array) -> None:
    for axes, place in zip(grid, check["place"].values, strict=True):
        one = check.sel(place=place)
        wanted = np.array([float(one["place_lengthwise"]), float(one["place_profile"])])
        centre = np.array([float(one["pattern_centre_lengthwise"]), float(one["pattern_centre_profile"])])
        _draw_print(axes, plane, one["print_excess"].values, check, centre, wanted)
        for name, t, across in (("toe", 0.0, -1), ("heel", 1.0, 1)):
            x, y = _at(check, plane, np.array([t, 0.5]))
            axes.annotate(
                name, (x, y), (4 * across, 0), textcoords="offset points", ha=("right", "left")[across > 0],
                va="center", rotation=90, fontsize=SMALL_SIZE, color=GREY, style="italic",
            )  # fmt: skip
        v, h = float(one["v"]), float(one["h"])
        said = "not reached" if np.isnan(v) else f"V {v:+.3f}, H {h:+.3f} mm".replace("-", "−")
        panel_titles(axes, str(place), said)


def _draw_grid(grid: Any, check: xr.Dataset, plane: Array) -> None:
    """Prints over V, to the right, and H, upwards."""
    v, h = check["v_grid"].values, check["h_grid"].values
    prints = check["grid_print_excess"].transpose("v_grid", "h_grid", "lengthwise", "profile").values
    along = check["grid_pattern_centre_lengthwise"].transpose("v_grid", "h_grid").values
    up = check["grid_pattern_centre_profile"].transpose("v_grid", "h_grid").values
    for row, j in enumerate(reversed(range(h.size))):
        for i in range(v.size):
            _draw_print(grid[row, i], plane, prints[i, j], check, np.array([along[i, j], up[i, j]]))
        grid[row, 0].set_ylabel(_signed(h[j]), fontsize=SMALL_SIZE, color=INK, labelpad=4)
    for i in range(v.size):
        grid[-1, i].set_xlabel(_signed(v[i]), fontsize=SMALL_SIZE, color=INK, labelpad=2)


def _signed(value: float) -> str:
    """A value of the grid, which is round."""
    return f"{value:+.4g}".replace("-", "−") if value else "0"


def _draw_print(
    axes: Axes, plane: Array, excess: Array, check: xr.Dataset, centre: Array, wanted: Array | None = None
) -> None:
    """Draw a print on its flank, its centre, and where the centre is wanted."""
    edge = np.concatenate([plane[:, :, 0], plane[:, -1], plane[:, ::-1, -1], plane[:, 0, ::-1]], axis=1)
    axes.fill(*edge, facecolor=PAPER, edgecolor="none", zorder=0)
    axes.plot(*edge, color=INK, linewidth=0.9, zorder=6)
    if np.any(excess < 0.0):
        axes.contourf(*plane, excess, levels=[1.01 * float(np.min(excess)), 0.0], colors=[COMPOUND], zorder=2)
        axes.contour(*plane, excess, levels=[0.0], colors=BLUE, linewidths=0.8, zorder=3)
    if wanted is not None:
        axes.plot(*_at(check, plane, wanted), "+", color=VERMILION, markersize=9, markeredgewidth=1.1, zorder=8)
    if np.all(np.isfinite(centre)):
        axes.plot(*_at(check, plane, centre), "o", color=INK, markersize=3.0, zorder=9)
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.spines[:].set_visible(False)


def _at(check: xr.Dataset, plane: Array, point: Array) -> tuple[float, float]:
    """Coordinates in the plane of a lengthwise and a profile fraction (2)."""
    flank = xr.DataArray(
        plane, dims=("plane_axis", "lengthwise", "profile"),
        coords={"lengthwise": check["lengthwise"].values, "profile": check["profile"].values},
    )  # fmt: skip
    x, y = flank.interp(lengthwise=float(point[0]), profile=float(point[1])).values
    return float(x), float(y)
