"""Charts of friction: maps of the gear flank, and efficiency.

The maps show velocities, slide-to-roll ratio, radius, lambda ratio, friction and heat; the chart of efficiency shows
the power loss over the mesh cycle, and efficiency over every varied operating condition.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ...contact.evaluation.tooth_passage import two_cycles
from ...contact.lines.contact_lines import boundary_distance
from ...core.arrays import Array
from ...core.checks import number
from ...core.errors import InputError
from ...friction import FrictionModel
from ...friction.loaded_contacts import action_splines, axes_of, surface_velocities
from ...friction.operation import named_models
from ..result import CONDITIONS
from ..summary.curves import efficiency_chart, torque_name
from ..summary.plausibility import TOLD_SHARE, range_notes
from ..summary.quantities import CONDITION_LABELS, CONDITION_UNITS, roughness_words, value_name
from .axes_style import label_axes, legend_of_curves, panel_titles, plain_axes, plain_bar, torque_colours
from .contours import drop_short, number_lines, outlined, points_per_unit, triangulated, without_border, without_steep
from .matplotlib_defaults import picture
from .page import in_print
from .panel_grid import TORQUE_TOLERANCE, AxesChoice, chosen_parts, evenly_chosen, middle, panels, require_result
from .style import BODY_SIZE, GREY, INK, SMALL_SIZE, WIDTH
from .tooth_view import ToothView, draw_flank, fine_grid, flank_views

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from matplotlib.contour import ContourSet
    from matplotlib.figure import Figure

#: Name and colour map of every quantity.
QUANTITIES = {
    "rolling_velocity": ("rolling velocity [m/s]", "Blues"),
    "sliding_velocity": ("sliding velocity [m/s]", "Oranges"),
    "slide_to_roll": ("slide-to-roll ratio", "Purples"),
    "equivalent_radius": ("equivalent radius [mm]", "Greys"),
    "lambda_ratio": ("lambda ratio", "Greens"),
    "friction_coefficient": ("friction coefficient", "YlOrRd"),
    "flash_temperature": ("flash temperature [K]", "Reds"),
    "pressure_velocity": ("pressure × velocity [MPa m/s]", "PuBuGn"),
}
GRID = (121, 61)
LEVEL_COUNT = 7
COLOUR_LIMIT = 0.62  # darkest part of a colour map that is used
TRIANGLE_SIDE_LIMIT = 5.0  # longest side of a triangle over the median
CONTOUR_DISTANCE = 2.0  # [pt] between contour lines at least
CONTOUR_LENGTH_MINIMUM = 0.15  # of the panel's width
LEVEL_PERCENTILES = {True: (1.0, 99.0), False: (7.0, 95.0)}  # between which contour lines are drawn, if smooth or not


@dataclass(frozen=True)
class FlankMap:
    """Map of a quantity on the gear flank."""

    points: Array  # (2, n), fractions
    values: Array
    smooth: bool  # known on the whole common flank, not only under load


def velocity_maps(
    tree: xr.DataTree, view: ToothView, speed: float, model: FrictionModel | None = None
) -> dict[str, FlankMap]:
    """Maps of rolling and sliding velocity [m/s] at a speed of the pinion [1/min], and of the slide-to-roll ratio."""
    model = model or FrictionModel()
    ease_off = tree["ease_off"].to_dataset()
    grid = fine_grid(GRID).reshape(2, -1)
    velocities = surface_velocities(axes_of(ease_off), action_splines(ease_off), grid)
    omega = speed * 2.0 * np.pi / 60.0
    fields = {
        "rolling_velocity": np.abs(model.rolling(velocities)) * omega,
        "sliding_velocity": velocities.sliding_speed * omega,
        "slide_to_roll": model.slide_to_roll(velocities),
    }
    inside = boundary_distance(view.fields, grid) >= -0.05  # a little beyond: the outline cuts it off
    return {name: FlankMap(grid, np.where(inside, values, np.nan), True) for name, values in fields.items()}


def loaded_map(loaded: xr.Dataset, field: xr.DataArray) -> FlankMap:
    """Map of a field (mesh_position, segment) at one torque, NaN where there is no value.

    Segments of edges beside the lines are left out: their values are those of a whole strip.
    """
    order = ("mesh_position", "segment")
    values = field.transpose(*order).values
    chosen = np.isfinite(values) & (loaded["force"].transpose(*order).values > 0.0)
    chosen &= loaded["pressure"].transpose(*order).values > 0.0
    points = np.stack([loaded[n].transpose(*order).values[chosen] for n in ("lengthwise", "profile")])
    return FlankMap(points, values[chosen], False)


def draw_values(
    axes: Axes, view: ToothView, flank_map: FlankMap, colours: str, levels: Array | None = None
) -> ContourSet | None:
    """Draw a map in shades between labelled contour lines and return the shades; text if it has too few points."""
    from matplotlib.patches import PathPatch
    from matplotlib.ticker import MaxNLocator
    from matplotlib.tri import Triangulation

    x, y = view.in_plane(flank_map.points)
    finite = np.isfinite(flank_map.values)
    if np.sum(finite) < 4 or np.ptp(flank_map.values[finite]) == 0.0:
        x, y = view.in_plane(np.array([0.5, 0.5]))
        text = "the same everywhere" if np.any(finite) else "no values"
        axes.text(x, y, text, ha="center", va="center", fontsize=SMALL_SIZE, color=GREY)
        return None
    values = flank_map.values
    if levels is None:
        levels = np.asarray(
            MaxNLocator(LEVEL_COUNT).tick_values(*np.percentile(values[finite], LEVEL_PERCENTILES[flank_map.smooth]))
        )
    lines: ContourSet
    shading: ContourSet
    outline = view.outline(view.common)
    shades = pale(colours)
    if flank_map.smooth:
        shape = GRID
        known = np.ma.masked_invalid(values.reshape(shape))
        plane = (x.reshape(shape), y.reshape(shape), known)
        shading = axes.contourf(*plane, levels=levels, cmap=shades, extend="both", zorder=1)
        shading.set_clip_path(PathPatch(outline, transform=axes.transData))
        lines = axes.contour(*plane, levels=levels, colors=INK, linewidths=0.5, zorder=2)
        lines.set_clip_path(PathPatch(outline, transform=axes.transData))
        region = outlined(outline)
    else:
        mesh = Triangulation(x[finite], y[finite])
        # Long triangles would bridge bays of the loaded region.
        corners = np.stack([mesh.x, mesh.y])[:, mesh.triangles]
        longest = np.max(np.hypot(*(corners - np.roll(corners, 1, axis=2))), axis=1)
        mesh.set_mask(longest > TRIANGLE_SIDE_LIMIT * np.median(longest))
        shading = axes.tricontourf(mesh, values[finite], levels=levels, cmap=shades, extend="both", zorder=1)
        # The load ends within a segment: at the border values jump from one line of contact to the next.
        steepest = float(levels[1] - levels[0]) / (CONTOUR_DISTANCE / float(points_per_unit(axes)[0]))
        lined = without_steep(without_border(mesh), values[finite], steepest)
        if not lined.get_masked_triangles().size:  # of a coarse analysis
            return shading
        lines = axes.tricontour(lined, values[finite], levels=levels, colors=INK, linewidths=0.5, zorder=2)
        drop_short(lines, CONTOUR_LENGTH_MINIMUM * float(np.ptp(axes.get_xlim())))
        region = triangulated(mesh)
    number_lines(axes, lines, region, SMALL_SIZE - 0.5)
    return shading


def pale(name: str) -> Colormap:
    """Lighter part of a colour map, on which dark numbers are legible."""
    from matplotlib import colormaps
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list(f"pale {name}", colormaps[name](np.linspace(0.0, COLOUR_LIMIT, 64)))


def draw_panel(axes: Axes, view: ToothView, name: str, flank_map: FlankMap, levels: Array | None = None) -> None:
    """Draw a map on an empty flank, with its name and range above and a colour bar beside it."""
    draw_flank(axes, view, labels=(False, False))
    axes.tick_params(bottom=False, left=False, labelleft=False)
    title, colours = QUANTITIES[name]
    shading = draw_values(axes, view, flank_map, colours, levels)
    if shading is not None:
        figure: Any = axes.get_figure(root=True)
        plain_bar(figure.colorbar(shading, ax=axes, shrink=0.75, aspect=14, pad=0.02), "")
    extent, finite = "", flank_map.values[np.isfinite(flank_map.values)]
    if finite.size:
        low, high = float(finite.min()), float(finite.max())
        digits = int(np.clip(2 - np.floor(np.log10(max(high, 1e-9))), 0, 6))
        extent = f"{low:.{digits}f} to {high:.{digits}f}"
    panel_titles(axes, title, extent)


def middle_condition(friction: xr.Dataset) -> dict[str, int]:
    """Numbers of the middle torque, speed, temperature and roughness of a result."""
    return {name: middle(friction[name].values) for name in CONDITIONS}


def roughness_name(friction: xr.Dataset | xr.DataArray, index: int) -> str:
    """RMS roughness [um] of a number as pictures show it: pinion/gear if the flanks differ."""
    return f"{roughness_words(friction, index)} µm"


@picture
def friction_maps(
    tree: xr.DataTree,
    *,
    torque: float | None = None,
    speed: float | None = None,
    temperature: float | None = None,
    roughness: float | None = None,
    quantities: str | Sequence[str] | None = None,
    axes: AxesChoice = None,
) -> Figure | None:
    """Velocities, film, friction and temperature over the gear flank, at one operating condition.

    Parameters
    ----------
    tree
        A result with friction.
    torque, speed, temperature, roughness
        Torque at the pinion [N m], its speed [1/min], temperature of the oil [degC] and roughness [um], of those that
        the result has; the middle ones if left out.
    quantities
        Panels: ``rolling_velocity``, ``sliding_velocity``, ``slide_to_roll``, ``equivalent_radius``, ``lambda_ratio``,
        ``friction_coefficient``, ``flash_temperature``, ``pressure_velocity``; all if left out.
    axes
        An Axes a panel; a page of its own if left out. With them nothing is returned; ``layout="constrained"``
        of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result with friction, it does not have a condition or a quantity, or ``axes`` are not as many
        as the panels.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0], speed=1500.0)
    >>> figure = easeoff.plot.friction_maps(tree, quantities="sliding_velocity")
    >>> figure.axes[0].get_title(loc="left")
    'sliding velocity [m/s]'
    """
    require_result(tree, "loaded", "friction")
    view = flank_views(tree, "gear")[0]
    conditions = {"torque": torque, "speed": speed, "temperature": temperature, "roughness": roughness}
    friction, loaded = tree["friction"].to_dataset(), tree["loaded"].to_dataset()
    index = middle_condition(friction) | _given(friction, conditions)
    at = {name: float(friction[name].values[number]) for name, number in index.items()}
    subset, under_load = friction.isel(index), loaded.isel(torque=index["torque"])
    maps = velocity_maps(tree, view, at["speed"], FrictionModel(rolling_frame=friction.attrs["rolling_frame"]))
    force = subset["force"] if "force" in subset else under_load["force"]
    touching = under_load.assign(force=force)
    maps["equivalent_radius"] = loaded_map(touching, under_load["equivalent_radius"])
    for name in ("lambda_ratio", "friction_coefficient", "flash_temperature", "pressure_velocity"):
        if name in subset:
            maps[name] = loaded_map(touching, subset[name])
    clamped = " (clamped)" if int(friction["temperature_clamped"][index["temperature"]]) else ""
    rough = roughness_name(friction, index["roughness"])
    words = (
        f"{torque_name(at['torque'])}, {at['speed']:g} 1/min, "
        f"{named_models(friction.attrs)}, {at['temperature']:g} °C{clamped}, roughness {rough}"
    )
    note = " · ".join([words, *in_print(range_notes(friction, index))])
    names = chosen_parts(list(maps), quantities, "quantities")
    rows, columns = -(-len(names) // 2), min(2, len(names))
    height = rows * ((WIDTH - 0.4) / columns * view.aspect + 0.25)
    heading = "Sliding, rolling and friction, gear flank"
    subplots = panels(tree, heading, height, note, (rows, columns), axes, count=len(names))
    for panel, name in zip(subplots.axes, names, strict=True):
        draw_panel(panel, view, name, maps[name])
    return subplots.figure


def _given(friction: xr.Dataset, conditions: Mapping[str, float | None]) -> dict[str, int]:
    """Numbers of the values of the result that conditions ask for, by name; those that are ``None`` are left out."""
    condition = {}
    for name, wanted in conditions.items():
        if wanted is None:
            continue
        values = friction[name].values
        near = np.flatnonzero(np.isclose(values, number(name, wanted), rtol=TORQUE_TOLERANCE, atol=0.0))
        if not near.size:
            there = ", ".join(f"{value:g}" for value in np.sort(values))
            raise InputError(f"{name} = {wanted:g}: must be one of the result's: {there} {CONDITION_UNITS[name]}")
        condition[name] = int(near[0])
    return condition


PLURALS = {"speed": "speeds", "torque": "torques", "temperature": "temperatures", "roughness": "roughnesses"}
COMPANION = {"speed": "torque", "torque": "speed", "roughness": "temperature", "temperature": "roughness"}
CURVE_COUNT_LIMIT = 5
ROUGHNESS_TICK_LIMIT, TICK_DISTANCE = 6, 0.12  # roughnesses ticked themselves, and their least distance over the axis
MARKED_COUNT_LIMIT = 40  # computed points of a curve that are marked
EFFICIENCY_SPAN_MINIMUM = 0.2  # [%] of the axis; less would exaggerate small differences


def curves(axes: Axes, friction: xr.Dataset, along: str, by: str, at: dict[str, int], *, on_page: bool = True) -> None:
    """Draw the efficiency along one operating condition, a curve a value of another, the rest as given.

    Marks are computed points; open ones have more than ``TOLD_SHARE`` of the loss beyond the formula's range.
    """
    chosen = evenly_chosen(friction[by].values, CURVE_COUNT_LIMIT)
    chart = efficiency_chart(friction, along, by, at, chosen)
    for index, curve, colour in zip(chosen, chart.curves, torque_colours(friction[by].values[chosen]), strict=True):
        x, y = curve.x, curve.y
        axes.plot(x, y, color=colour, linewidth=1.6, label=curve.name)
        if x.size > MARKED_COUNT_LIMIT:
            continue
        out = np.zeros(x.size, dtype=bool)
        if "extrapolated_share" in friction:
            place = {name: number for name, number in at.items() if name != along} | {by: int(index)}
            out = friction["extrapolated_share"].isel(place).sortby(along).values >= TOLD_SHARE
        axes.plot(x[~out], y[~out], "o", color=colour, markersize=3.5)
        axes.plot(x[out], y[out], "o", color=colour, markersize=3.5, markerfacecolor="white")
    plain_axes(axes, chart.abscissa or chart.kind.x)
    low, high = axes.get_ylim()
    more = max(0.0, 0.5 * (EFFICIENCY_SPAN_MINIMUM - (high - low)))
    axes.set_ylim(low - more, high + more)
    if chart.abscissa:
        name_pairs(axes, friction)
    legend_of_curves(axes, on_page=on_page, heading=how_many(chosen.size, friction.sizes[by], by))


def name_pairs(axes: Axes, friction: xr.Dataset) -> None:
    """Name roughnesses on an axis by those of both flanks, if there is room."""
    values, indices = np.unique(friction["roughness"].values, return_index=True)
    if values.size <= ROUGHNESS_TICK_LIMIT and np.all(np.diff(values) > TICK_DISTANCE * np.ptp(values)):
        axes.set_xticks(values, [roughness_words(friction, int(index)) for index in indices])
        label_axes(axes, "RMS roughness, pinion/gear where they differ [µm]")


def how_many(drawn: int, count: int, condition: str) -> str:
    """Number of values that have a curve; empty if all have one."""
    return "" if drawn == count else f"{drawn} of {count} {PLURALS[condition]}"


def over_the_cycle(axes: Axes, friction: xr.Dataset, at: dict[str, int], *, on_page: bool = True) -> None:
    """Draw the power loss over two mesh cycles as part of the input power, a curve a torque."""
    fixed = {name: number for name, number in at.items() if name != "torque"}
    loss = 100.0 * (1.0 - friction["mesh_efficiency"].isel(fixed).transpose("torque", "mesh_position").values)
    torques = friction["torque"].values
    chosen = evenly_chosen(torques, CURVE_COUNT_LIMIT)
    for index, colour in zip(chosen, torque_colours(torques[chosen]), strict=True):
        times, values = two_cycles(loss[index])
        axes.plot(times, values, color=colour, linewidth=1.6, label=f"{torques[index]:.4g} N m")
    axes.set_xlim(0, 2)
    plain_axes(axes, "mesh cycles (pinion pitches)", "power loss over input power [%]")
    legend_of_curves(axes, on_page=on_page, heading=how_many(chosen.size, torques.size, "torque"))


@picture
def efficiency(
    tree: xr.DataTree, *, parts: str | Sequence[str] | None = None, axes: AxesChoice = None
) -> Figure | None:
    """Power loss over the mesh cycle, and efficiency over every operating condition that varies.

    Parameters
    ----------
    tree
        A result with friction.
    parts
        Panels: ``cycle``, and those of ``speed``, ``torque``, ``temperature`` and ``roughness`` of which the result has
        several; all if left out.
    axes
        An Axes a panel; a page of its own if left out. With them nothing is returned; ``layout="constrained"``
        of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result with friction, a part is not known, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0], speed=[500.0, 1500.0])
    >>> len(easeoff.plot.efficiency(tree).axes)
    2
    """
    require_result(tree, "loaded", "friction")
    friction = tree["friction"].to_dataset()
    at = middle_condition(friction)
    varied = [name for name in CONDITION_LABELS if friction.sizes[name] > 1]
    names = chosen_parts(["cycle", *varied], parts)
    rows, columns = -(-len(names) // 2), min(2, len(names))
    marks = "open marks: 5 % of the power loss or more is beyond the range of the formula"
    beyond = [marks] if bool((friction.get("extrapolated_share", xr.DataArray(0.0)) >= TOLD_SHARE).any()) else []
    note = " · ".join([named_models(friction.attrs), *in_print(range_notes(friction)), *beyond])
    shape, count = (rows, columns), len(names)
    subplots = panels(tree, "Power loss and efficiency", 2.2 * rows + 0.2, note, shape, axes, count=count)
    for panel, name in zip(subplots.axes, names, strict=True):
        if name == "cycle":
            over_the_cycle(panel, friction, at, on_page=subplots.on_page)
            title(panel, friction, at, ("torque",))
            continue
        by = COMPANION[name]
        curves(panel, friction, name, by, at, on_page=subplots.on_page)
        label_axes(panel, y="efficiency [%]")
        title(panel, friction, at, (name, by))
    return subplots.figure


def title(axes: Axes, friction: xr.Dataset, at: dict[str, int], varied: tuple[str, ...]) -> None:
    """Title of a panel: the conditions that do not vary in it."""
    heading = ", ".join(value_name(friction, name, at[name]) for name in CONDITION_LABELS if name not in varied)
    axes.set_title(heading, loc="left", fontsize=BODY_SIZE - 0.5, color=GREY, pad=3)
