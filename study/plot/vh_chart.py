"""V-H chart: marking prints at toe, middle and heel, and over the grid of V and H."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ...core.arrays import Array
from ...core.checks import instance
from ...core.errors import InputError
from ..summary.sweep_report import SIGNS, totals
from .drawing_style import picture
from .page import BLUE, BODY_SIZE, GREY, INK, PAPER, SEPARATOR, SMALL_SIZE, VERMILION, WIDTH, page, panel_titles
from .panel_grid import chosen_parts, panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .panel_grid import AxesChoice

PARTS = ("places", "grid")
COMPOUND = "#7FB2D6"  # colour of the marking compound
PLACE_COLOUR = VERMILION


@picture
def vh_check(found: xr.Dataset, *, parts: str | Sequence[str] | None = None, axes: AxesChoice = None) -> Figure | None:
    """Marking prints of a V-H check at toe, middle and heel, and over the grid of V and H.

    Parameters
    ----------
    found
        Of ``study.vh_check``.
    parts
        ``places`` and, if it was asked for, ``grid``; both if left out.
    axes
        An Axes a print: toe, middle, heel, then the grid from the greatest H, from left to right; a page of its
        own if left out. With them nothing is returned; ``layout="constrained"`` of their figure makes room.

    Raises
    ------
    InputError
        If ``found`` is no V-H check, a part is not known, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> found = easeoff.study.vh_check("fh-design-a")
    >>> len(easeoff.plot.vh_check(found).axes)
    3
    """
    instance("found", found, xr.Dataset)
    if "print_excess" not in found or "in_plane" not in found:
        raise InputError("found: must be of 'easeoff vh' or study.vh_check")
    names = chosen_parts(PARTS if "v_grid" in found.sizes else PARTS[:1], parts)
    plane = found["in_plane"].values
    count, columns = found.sizes["place"], found.sizes.get("v_grid", 0)
    wanted = {"places": count, "grid": columns * found.sizes.get("h_grid", 0)}
    if axes is not None:
        shape = (1, sum(wanted[name] for name in names))
        given = panels(xr.DataTree(found), "V-H check", 0.0, "", shape, axes)
        if "places" in names:
            _draw_places(given.axes[:count], found, plane)
        if "grid" in names:
            _draw_grid(given.axes[-wanted["grid"] :].reshape(-1, columns), found, plane)
        return given.figure
    aspect = float(np.ptp(plane[1]) / np.ptp(plane[0]))
    heights = {"places": (WIDTH - 0.5) / 3 * aspect + 0.45}
    if columns:
        heights["grid"] = found.sizes["h_grid"] * ((WIDTH - 0.7) / columns * aspect + 0.06) + 0.75
    ratios = [heights[name] for name in names]
    figure = page(xr.DataTree(found), "V-H check", sum(ratios), _small_print(found))
    subfigures: Any = figure.subfigures(len(names), 1, height_ratios=ratios, squeeze=False)[:, 0]
    for part, name in zip(subfigures, names, strict=True):
        if name == "places":
            _draw_places(part.subplots(1, count), found, plane)
            continue
        _draw_grid(part.subplots(found.sizes["h_grid"], columns, squeeze=False), found, plane)
        part.supxlabel("V [mm]", fontsize=SMALL_SIZE + 0.5, color=INK)
        part.supylabel("H [mm]", fontsize=SMALL_SIZE + 0.5, color=INK)
        part.suptitle("prints over V and H", x=0.02, ha="left", fontsize=BODY_SIZE, color=INK, weight="bold")
    return figure


def _small_print(found: xr.Dataset) -> str:
    """Totals, thickness of the compound, marks, and what V and H are positive for."""
    parts = [totals(found)] if "total_v" in found else []
    parts.append(f"print of {found.attrs['separation']:g} µm, toe left")
    parts += ["dot: centre", "cross: where it is wanted"]
    parts += SIGNS
    return SEPARATOR.join(parts).replace("-0", "−0")


def _draw_places(grid: Any, found: xr.Dataset, plane: Array) -> None:
    for axes, place in zip(grid, found["place"].values, strict=True):
        one = found.sel(place=place)
        wanted = np.array([float(one["place_lengthwise"]), float(one["place_profile"])])
        centre = np.array([float(one["pattern_centre_lengthwise"]), float(one["pattern_centre_profile"])])
        _draw_print(axes, plane, one["print_excess"].values, found, centre, wanted)
        for name, t, across in (("toe", 0.0, -1), ("heel", 1.0, 1)):
            x, y = _at(found, plane, np.array([t, 0.5]))
            axes.annotate(
                name, (x, y), (4 * across, 0), textcoords="offset points", ha=("right", "left")[across > 0],
                va="center", rotation=90, fontsize=SMALL_SIZE, color=GREY, style="italic",
            )  # fmt: skip
        v, h = float(one["v"]), float(one["h"])
        said = "not reached" if np.isnan(v) else f"V {v:+.3f}, H {h:+.3f} mm".replace("-", "−")
        panel_titles(axes, str(place), said)


def _draw_grid(grid: Any, found: xr.Dataset, plane: Array) -> None:
    """Prints over V, to the right, and H, upwards."""
    v, h = found["v_grid"].values, found["h_grid"].values
    prints = found["grid_print_excess"].transpose("v_grid", "h_grid", "lengthwise", "profile").values
    along = found["grid_pattern_centre_lengthwise"].transpose("v_grid", "h_grid").values
    up = found["grid_pattern_centre_profile"].transpose("v_grid", "h_grid").values
    for row, j in enumerate(reversed(range(h.size))):
        for i in range(v.size):
            _draw_print(grid[row, i], plane, prints[i, j], found, np.array([along[i, j], up[i, j]]))
        grid[row, 0].set_ylabel(_signed(h[j]), fontsize=SMALL_SIZE, color=INK, labelpad=4)
    for i in range(v.size):
        grid[-1, i].set_xlabel(_signed(v[i]), fontsize=SMALL_SIZE, color=INK, labelpad=2)


def _signed(value: float) -> str:
    """A value of the grid, which is round."""
    return f"{value:+.4g}".replace("-", "−") if value else "0"


def _draw_print(
    axes: Axes, plane: Array, excess: Array, found: xr.Dataset, centre: Array, wanted: Array | None = None
) -> None:
    """Draw a print on its flank, its centre, and where the centre is wanted."""
    edge = np.concatenate([plane[:, :, 0], plane[:, -1], plane[:, ::-1, -1], plane[:, 0, ::-1]], axis=1)
    axes.fill(*edge, facecolor=PAPER, edgecolor="none", zorder=0)
    axes.plot(*edge, color=INK, linewidth=0.9, zorder=6)
    if np.any(excess < 0.0):
        axes.contourf(*plane, excess, levels=[1.01 * float(np.min(excess)), 0.0], colors=[COMPOUND], zorder=2)
        axes.contour(*plane, excess, levels=[0.0], colors=BLUE, linewidths=0.8, zorder=3)
    if wanted is not None:
        axes.plot(*_at(found, plane, wanted), "+", color=PLACE_COLOUR, markersize=9, markeredgewidth=1.1, zorder=8)
    if np.all(np.isfinite(centre)):
        axes.plot(*_at(found, plane, centre), "o", color=INK, markersize=3.0, zorder=9)
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.spines[:].set_visible(False)


def _at(found: xr.Dataset, plane: Array, point: Array) -> tuple[float, float]:
    """Coordinates in the plane of a lengthwise and a profile fraction (2)."""
    flank = xr.DataArray(
        plane, dims=("plane_axis", "lengthwise", "profile"),
        coords={"lengthwise": found["lengthwise"].values, "profile": found["profile"].values},
    )  # fmt: skip
    x, y = flank.interp(lengthwise=float(point[0]), profile=float(point[1])).values
    return float(x), float(y)
