"""Charts over a flank: topographies of measured ones, maps of what changes the ease-off, and the ease-off itself.

A topography shows deviations at the nodes of the grid as lines along the normal; the ease-off has contour lines over
the common flank, with the path of contact.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ...contact.lines.contact_lines import boundary_distance
from ...contact.lines.flank_splines import fit
from ...core.arrays import Array, Bools
from ...core.errors import InputError
from ...geometry.deviation.corrective_settings import CorrectedFlank, Correction
from ..case_correction import CaseCorrection
from ..summary.curves import torque_name
from ..summary.quantities import TITLES
from .axes_style import label_axes, plain_axes, plain_bar, plain_legend
from .contact_pattern_chart import draw_path, legend_below, unloaded_pattern
from .contours import number_lines, outlined
from .matplotlib_defaults import drawing, picture
from .page import FORMATS, save
from .panel_grid import AxesChoice, chosen_parts, panels, require_result
from .style import BLUE, FAINT, GREY, INK, SMALL_SIZE, VERMILION, WIDTH
from .tooth_view import ToothView, draw_flank, fine_grid, flank_views

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.contour import QuadContourSet
    from matplotlib.figure import Figure

FLANK_STATES = {"before": "measured", "after": "predicted after the correction"}
HEIGHT_SHARE = 0.36  # of the sheet's height over its length, as drawn
SHEAR = 0.08  # by which the sheet leans over to the right, of its length: bars of one column stand side by side
BAR_SHARE = 0.16  # of the greatest deviation over the sheet's length, as drawn
LABELLED_NODES_LIMIT = 63  # above which values stand at the corners and the middle alone


def topography(
    correction: Correction, *, title: str = "", parts: str | Sequence[str] | None = None, axes: AxesChoice = None
) -> Figure:
    """Topographies of measured flanks, before the correction and as predicted after it.

    Every node of the measuring grid stands on the flat sheet of the designed flank, toe on the left and root below;
    its deviation is a line along the normal, upwards where there is more metal. A rotation of the tooth is left out.

    Parameters
    ----------
    correction
        Of ``geometry.corrective_settings`` or ``study.correct_case``.
    title
        Small title of the page.
    parts
        ``before``, ``after`` or both; both if left out. Panels: a row a flank, a column a part.
    axes
        Axes to draw in, one a panel; a page of its own if left out.

    Raises
    ------
    InputError
        If ``correction`` is none, a part is unknown, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> case, measured = easeoff.read_case("fm-11x41"), {"gear": "fm-11x41-worn-gear"}
    >>> corrected = easeoff.study.correct_case(case, measured, free=["machine_root_angle"])
    >>> figure = easeoff.plot.topography(corrected.corrections["gear"][0])
    >>> len(figure.axes)
    2
    """
    if not isinstance(correction, Correction):
        raise InputError(
            f"correction = {type(correction).__name__}: must be a Correction, as corrective_settings gives it"
        )
    with drawing(axes):
        names = chosen_parts(tuple(FLANK_STATES), parts)
        flanks = correction.flanks
        tree = xr.DataTree(xr.Dataset(attrs={"title": title, "easeoff_version": version("easeoff")}))
        note = "µm along the normal, upwards (+) more metal · a rotation of the tooth is left out"
        subplots = panels(tree, "Topography", 2.6 * len(flanks), note, (len(flanks), len(names)), axes)
        for number, panel in enumerate(subplots.axes):
            flank, name = flanks[number // len(names)], names[number % len(names)]
            largest = max(float(np.nanmax(np.abs(getattr(flank, part)))) for part in names)
            _draw_flank(panel, flank, name, 1e3 * max(largest, 1e-4))
        return subplots.figure


def sheet_places(flank: CorrectedFlank) -> Array:
    """Places of the nodes on the drawn sheet (2, columns, rows): from toe to heel, and up from the root."""
    section, deviation = flank.member.section, flank.deviation
    sine, cosine = np.sin(section.pitch_angle), np.cos(section.pitch_angle)
    along = cosine * deviation.axial + sine * deviation.radial
    up = cosine * deviation.radial - sine * deviation.axial
    along, up = ((v - v.min()) / (v.max() - v.min()) for v in (along, up))
    return np.stack([along + SHEAR * up, HEIGHT_SHARE * up])


def _draw_flank(axes: Axes, flank: CorrectedFlank, part: str, largest: float) -> None:
    """Draw one flank with a scale at which a deviation [um] is as long as a bar may be."""
    x, y = sheet_places(flank)
    value = 1e3 * getattr(flank, part)
    scale = BAR_SHARE / largest
    thin = 1.0 if value.size <= LABELLED_NODES_LIMIT else 0.6
    for lines, colour, width in (((x, y), FAINT, 0.6 * thin), ((x, y + scale * value), INK, 0.9 * thin)):
        axes.plot(lines[0].T, lines[1].T, color=colour, linewidth=width, zorder=1)  # from root to top
        axes.plot(*lines, color=colour, linewidth=width, zorder=1)
    for one_x, one_y, one in zip(x.ravel(), y.ravel(), value.ravel(), strict=True):
        colour = VERMILION if one > 0.0 else BLUE
        axes.plot([one_x] * 2, [one_y, one_y + scale * one], color=colour, linewidth=1.6 * thin)
    for column, row in _labelled(value.shape):
        one = value[column, row]
        if np.isnan(one):
            continue
        text = f"{round(one, 1) or 0.0:+.1f}" if abs(one) < 10.0 else f"{one:+.0f}"
        place = (x[column, row], y[column, row] + scale * one)
        # Beside the bar and above the row's line: rows are near one another, columns are not.
        axes.annotate(
            text.replace("-", "−"), place, (1.5, 0.5), textcoords="offset points", ha="left", va="bottom",
            fontsize=5.5, color=INK,
        )  # fmt: skip
    _label(axes, x, y, flank, part, value)
    _draw_scale(axes, scale, largest)
    axes.set_axis_off()
    axes.set_xlim(-0.13, 1.27)
    axes.set_ylim(-BAR_SHARE - 0.14, HEIGHT_SHARE + BAR_SHARE + 0.12)


def _labelled(shape: tuple[int, ...]) -> list[tuple[int, int]]:
    """Nodes whose values are written: all of a usual grid, else corners and middle."""
    if shape[0] * shape[1] <= LABELLED_NODES_LIMIT:
        return [(column, row) for column in range(shape[0]) for row in range(shape[1])]
    columns, rows = ((0, size // 2, size - 1) for size in shape)
    return [(column, row) for column in columns for row in rows]


def _label(axes: Axes, x: Array, y: Array, flank: CorrectedFlank, part: str, value: Array) -> None:
    """Write the edges of the flank, its name, and the sizes of its deviations."""
    style: dict[str, Any] = {"fontsize": SMALL_SIZE, "color": GREY, "va": "center"}
    middle = 0.5 * HEIGHT_SHARE
    axes.text(-0.05, middle, "toe", ha="right", **style)
    axes.text(1.09 + SHEAR, middle, "heel", ha="left", **style)
    axes.text(0.5 + SHEAR, HEIGHT_SHARE + BAR_SHARE + 0.05, "top", ha="center", **style)
    axes.text(0.5, -BAR_SHARE - 0.05, "root", ha="center", **style)
    label_axes(axes, title=f"{flank.side} flank, {FLANK_STATES[part]}")
    known = value[np.isfinite(value)]
    sizes = f"rms {np.sqrt(np.mean(known**2)):.2f} · {known.min():+.1f} to {known.max():+.1f} µm"
    text = f"{sizes} · sum of squares {np.sum(known**2):.4g} µm²".replace("-", "−")
    axes.text(0.0, -BAR_SHARE - 0.12, text, ha="left", **style)


def _draw_scale(axes: Axes, scale: float, largest: float) -> None:
    """Draw a bar of a round length [um] beside the sheet."""
    power = 10.0 ** np.floor(np.log10(largest))
    length = power * max(step for step in (1.0, 2.0, 5.0) if step * power <= largest)
    axes.plot([1.16] * 2, [-BAR_SHARE, scale * length - BAR_SHARE], color=INK, linewidth=1.6, solid_capstyle="butt")
    style: dict[str, Any] = {"ha": "center", "va": "bottom", "fontsize": SMALL_SIZE, "color": INK}
    axes.text(1.16, scale * length - BAR_SHARE + 0.015, f"{length:g} µm", **style)


CHANGE_MAP = "RdBu_r"  # red where the gap grows
LEVEL_COUNT = 12
SPAN_MINIMUM = 0.2  # [um]
CHANGE_PARTS = ("surface", "max_line_load", "max_pressure", "max_end_load", "peak_to_peak")


@picture
def deviations(tree: xr.DataTree, *, axes: AxesChoice = None) -> Figure | None:
    """Part of the ease-off that the deviations of both flanks add.

    Parameters
    ----------
    tree
        A result of deviating flanks.
    axes
        One Axes to draw in; a page of its own if left out. With them nothing is returned;
        ``layout="constrained"`` of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result, its flanks do not deviate, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> case = easeoff.read_case("fm-11x41")
    >>> contact = case.contact.model_copy(update={"mesh_positions": 3})
    >>> shells = case.compliance.model_copy(update={"model": "shell"})
    >>> case = case.model_copy(update={"contact": contact, "compliance": shells})
    >>> tree = easeoff.analyze(case, torques=[100.0], deviations={"gear": "fm-11x41-worn-gear"})
    >>> len(easeoff.plot.deviations(tree).axes)  # the flank and its colour bar
    2
    """
    require_result(tree)
    if "ease_off_change" not in tree["ease_off"]:
        raise InputError("tree: its flanks have no deviations; give analyze(..., deviations=...)")
    view = flank_views(tree, "gear")[0]
    change = tree["ease_off"].to_dataset()["ease_off_change"]
    height = (WIDTH - 1.6) * view.aspect + 0.35
    note = "change of the gap along the normal, of both flanks together"
    subplots = panels(tree, "Deviations of the flanks, gear flank", height, note, (1, 1), axes)
    draw_change(subplots.axes[0], view, change, "gap added by the deviations [µm]")
    return subplots.figure


@picture
def optimization(
    tree: xr.DataTree, *, parts: str | Sequence[str] | None = None, axes: AxesChoice = None
) -> Figure | None:
    """Optimised modification of the ease-off, and what it changes, in the worst assembly.

    Parameters
    ----------
    tree
        Of ``easeoff.modify``.
    parts
        Panels: ``surface``, ``max_line_load``, ``max_pressure``, ``max_end_load``, ``peak_to_peak``; all if left out.
    axes
        An Axes a panel; a page of its own if left out. With them nothing is returned; ``layout="constrained"``
        of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is of no optimisation, a part is not known, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = easeoff.read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> tree = easeoff.modify(case, torques=[200.0], order=2, programmes=1)
    >>> len(easeoff.plot.optimization(tree, parts="peak_to_peak").axes)
    1
    """
    require_result(tree, "loaded", "optimization", "modification")
    view = flank_views(tree, "gear")[0]
    names = chosen_parts(CHANGE_PARTS, parts)
    record = tree["optimization"].to_dataset()
    rows, columns = -(-len(names) // 2), min(2, len(names))
    note = "worst assembly" if record.sizes["assembly"] > 1 else ""
    subplots = panels(tree, "Optimised ease-off", 2.35 * rows, note, (rows, columns), axes, count=len(names))
    for panel, name in zip(subplots.axes, names, strict=True):
        if name == "surface":
            draw_change(panel, view, tree["modification"].to_dataset()["modification"], "addition to the ease-off [µm]")
        else:
            _draw_stages(panel, record[name].max("assembly"), TITLES[name])
    return subplots.figure


def draw_change(axes: Axes, view: ToothView, change: xr.DataArray, label: str) -> None:
    """Draw a change of the ease-off [um] over (lengthwise, profile) on the common flank, with a colour bar."""
    from matplotlib.colors import TwoSlopeNorm
    from matplotlib.ticker import MaxNLocator

    draw_flank(axes, view)
    axes.tick_params(axis="y", pad=15, length=0)  # beyond the word at the toe
    label_axes(axes, title=label)
    grid = fine_grid()
    nodes = change.transpose("lengthwise", "profile").values
    values = fit(change["lengthwise"].values, change["profile"].values, {"change": nodes})("change", grid)
    inside = boundary_distance(view.fields, grid) >= 0.0
    if not np.any(inside):
        return
    low, high = (float(extreme(values[inside])) for extreme in (np.min, np.max))
    low, high = min(low, -0.5 * SPAN_MINIMUM), max(high, 0.5 * SPAN_MINIMUM)
    levels = np.asarray(MaxNLocator(LEVEL_COUNT, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high))
    extent = float(np.abs(levels).max())
    shades = {"cmap": CHANGE_MAP, "norm": TwoSlopeNorm(0.0, -extent, extent)}
    shading: Any = draw_map(axes, view, (grid, values, inside), levels, 0.5, **shades)
    figure: Any = axes.get_figure(root=True)
    ticks = levels[np.round(levels / (levels[1] - levels[0])) % 2 == 0]
    style: dict[str, Any] = {"shrink": 0.8, "pad": 0.02, "extendfrac": 0, "spacing": "proportional"}
    plain_bar(figure.colorbar(shading, ax=axes, ticks=ticks, **style), "")


def _draw_stages(axes: Axes, values: xr.DataArray, label: str) -> None:
    """Draw bars before and after, a pair a torque."""
    torques = values["torque"].values
    places = np.arange(torques.size)
    for number, (stage, colour) in enumerate((("before", FAINT), ("after", BLUE))):
        heights = np.nan_to_num(values.sel(stage=stage).values)
        axes.bar(places + 0.38 * (number - 0.5), heights, width=0.36, color=colour, label=stage)
    plain_axes(axes, title=label)
    axes.set_xticks(places, [torque_name(float(torque)) for torque in torques])
    plain_legend(axes)


def write_topographies(
    result: CaseCorrection, folder: str | os.PathLike[str], name: str, *, file_format: str = "png"
) -> list[Path]:
    """Draw all corrections of a case into a folder, a file a set-up: ``NAME-gear-convex-topography.png``.

    The folder is made if it does not exist; pictures of an earlier correction are replaced.
    """
    if file_format not in FORMATS:
        raise InputError(f"format = {file_format!r}: must be one of {', '.join(FORMATS)}")
    written = []
    for member, corrections in result.corrections.items():
        for correction in corrections:
            title = f"{result.case.title}, {member}"
            figure = topography(correction, title=title)
            sides = "-".join(flank.side for flank in correction.flanks)
            path = Path(folder) / f"{name}-{member}-{sides}-topography.{file_format}"
            written.append(save(figure, path, {"Title": title}))
    return written


SHADES = ("#ffffff", "#d9e6f0", "#a9c8df", "#6fa3c8")
LEVEL_COUNT_LIMIT = 16


def ease_off_map(view: ToothView) -> tuple[Array, Array, Bools]:
    """Fractions (2, nt, nh) on a fine grid, ease-off (nt, nh) [um], and truth on the common flank (nt, nh)."""
    grid = fine_grid()
    values = view.fields.evaluate(["ease_off_angle", "lever_arm"], grid)
    gap = 1e3 * values["ease_off_angle"] * values["lever_arm"]
    return grid, gap, boundary_distance(view.fields, grid) >= 0.0


def contour_levels(gap: Array) -> Array:
    """Round, evenly spaced levels [um] that span the ease-off of the common flank (n)."""
    from matplotlib.ticker import MaxNLocator

    largest = max(float(gap.max()), 1e-3) if gap.size else 1.0
    smallest = min(float(gap.min()), 0.0) if gap.size else 0.0
    return np.asarray(MaxNLocator(LEVEL_COUNT_LIMIT, steps=[1, 2, 2.5, 5, 10]).tick_values(smallest, largest))


@picture
def ease_off(tree: xr.DataTree, *, axes: AxesChoice = None) -> Figure | None:
    """Ease-off of the gear flank with the path of contact.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    axes
        One Axes to draw in; a page of its own if left out. With them nothing is returned;
        ``layout="constrained"`` of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> figure = easeoff.plot.ease_off(tree)
    >>> len(figure.axes)
    1
    """
    from matplotlib.lines import Line2D

    require_result(tree)
    view = flank_views(tree, "gear")[0]
    mapped = ease_off_map(view)
    levels = contour_levels(mapped[1][mapped[2]])
    step = levels[1] - levels[0]
    height, note = (WIDTH - 0.8) * view.aspect + 0.63, f"contours every {step:g}\u00a0µm"
    subplots = panels(tree, "Ease-off, gear flank", height, note, (1, 1), axes)
    panel = subplots.axes[0]
    draw_flank(panel, view)
    draw_map(panel, view, mapped, levels)
    pattern = unloaded_pattern(tree["unloaded"].to_dataset(), view.fields)
    draw_path(panel, view, pattern)
    entries = [
        Line2D([], [], color=INK, linewidth=0.7, label="ease-off [µm], a gap along the normal"),
        Line2D([], [], color=VERMILION, linewidth=1.8, label="path of contact, carrying pair"),
        Line2D([], [], color=GREY, linewidth=0.8, linestyle=(0, (4, 2)), label="boundary of the common flank"),
    ]
    if subplots.on_page:
        legend_below(panel, entries, columns=3)
    else:
        label_axes(panel, title="ease-off [µm]")
    return subplots.figure


def draw_map(
    axes: Axes,
    view: ToothView,
    mapped: tuple[Array, Array, Bools],
    levels: Array,
    linewidth: float = 0.7,
    **shades: Any,
) -> QuadContourSet | None:
    """Shade and contour values of the form of ``ease_off_map`` at levels; ``None`` if the common flank is empty."""
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.patches import PathPatch

    grid, values, inside = mapped
    if not np.any(inside):
        return None
    x, y = view.in_plane(grid)
    # The shading reaches beyond the boundary and is cut off there, so that its edge is smooth.
    shades = shades or {"cmap": LinearSegmentedColormap.from_list("ease_off", SHADES)}
    shading = axes.contourf(x, y, values, levels=levels, extend="both", zorder=1, **shades)
    shading.set_clip_path(PathPatch(view.outline(view.common), transform=axes.transData))
    inner = np.where(inside, values, np.nan)
    lines = axes.contour(x, y, inner, levels=levels, colors=INK, linewidths=linewidth, zorder=2)
    number_lines(axes, lines, outlined(view.outline(view.common)))
    return shading
