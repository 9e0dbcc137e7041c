"""Tooth view: a flank true to scale in its member's projection plane, toe on the left, tip at the top.

Points are given on the gear flank; the view of the pinion flank shows their conjugate points.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import contourpy
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...contact.evaluation.flank_region import ProjectionPlane
from ...contact.lines.contact_lines import boundary_distance, contact_splines
from ...contact.lines.flank_splines import FlankSplines
from ...core.arrays import Array
from ...geometry.pair.gear_pair import MEMBERS
from ...geometry.tooth.tooth_flanks import MemberName
from .panel_grid import chosen_parts
from .style import GREY, INK, PAPER, SMALL_SIZE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.path import Path as Outline

FINE_GRID = (241, 121)  # points along the face and the profile
EDGE_NAME = "edge name"  # mark of the words beside the edges of a flank
MARGIN_WIDTH = 1.3  # around the flank, for the names of its edges [mm per 30 mm of face]


@dataclass(frozen=True)
class ToothView:
    """Flank and the plane it is drawn in."""

    plane: ProjectionPlane
    fields: FlankSplines
    common: tuple[Array, ...]  # closed curves (2, k) around the common flank, as fractions on the gear
    member: MemberName = "gear"

    def fractions(self, points: Array) -> Array:
        """Fractions (2, ...) on the flank in view of fractions (2, ...) on the gear's; NaN stays NaN."""
        if self.member == "gear":
            return points
        known = np.nan_to_num(np.clip(points, 0.0, 1.0)).reshape(2, -1)
        fractions = self.fields.evaluate(["pinion_lengthwise", "pinion_profile"], known)
        opposite = np.stack(list(fractions.values())).reshape(np.shape(points))
        return np.where(np.isfinite(points), opposite, np.nan)

    def in_plane(self, points: Array) -> Array:
        """Coordinates in the plane (2, ...) [mm] of lengthwise and profile fractions (2, ...) on the gear."""
        return self.plane(self.fractions(points))

    @property
    def corners(self) -> Array:
        """Corners (2, 4) [mm], around the flank from toe and root along the root."""
        return self.plane(np.array([[0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 1.0]]))

    @property
    def window(self) -> tuple[float, float, float, float]:
        """Left, right, bottom and top of the view [mm]."""
        (left, bottom), (right, top) = self.corners.min(axis=1), self.corners.max(axis=1)
        margin = MARGIN_WIDTH * (right - left) / 30.0
        return float(left - margin), float(right + margin), float(bottom - margin), float(top + margin)

    @property
    def aspect(self) -> float:
        """Height over width of the window."""
        left, right, bottom, top = self.window
        return (top - bottom) / (right - left)

    def outline(self, curves: tuple[Array, ...]) -> Outline:
        """Closed curves (2, k), given as fractions, as one path in the plane."""
        from matplotlib.path import Path as Outline

        parts = [Outline(self.in_plane(curve).T, closed=True) for curve in curves]
        return Outline.make_compound_path(*parts) if parts else Outline(np.zeros((0, 2)))


def tooth_view(tree: xr.DataTree, member: MemberName = "gear") -> ToothView:
    """View of a flank of a result; at least half of the flank's nodes must have values."""
    flanks, ease_off = tree["flanks"].to_dataset(), tree["ease_off"].to_dataset()
    fields = contact_splines(flanks, ease_off)
    return ToothView(ProjectionPlane.of(flanks, member), fields, common_flank(fields), member)


def flank_views(tree: xr.DataTree, member: str | None = None) -> tuple[ToothView, ...]:
    """Views of the flanks of gear and pinion, or of one of them."""
    names: tuple[MemberName, ...] = ("gear", "pinion")
    chosen = chosen_parts(MEMBERS, member, "member")
    return tuple(tooth_view(tree, name) for name in names if name in chosen)


def fine_grid(shape: tuple[int, int] = FINE_GRID) -> Array:
    """Lengthwise and profile fractions (2, *shape) of an even grid over the whole flank."""
    return np.stack(np.meshgrid(*(np.linspace(0.0, 1.0, n) for n in shape), indexing="ij"))


def common_flank(splines: FlankSplines) -> tuple[Array, ...]:
    """Closed curves (2, k) around the part of the flank that meets the pinion's, as fractions."""
    grid = fine_grid()
    # A frame of outside points just beyond the edges closes every curve.
    distance = np.pad(boundary_distance(splines, grid), 1, constant_values=-1.0)
    t, h = (np.pad(np.linspace(0.0, 1.0, n), 1, constant_values=(-1e-9, 1.0 + 1e-9)) for n in FINE_GRID)
    lines = contourpy.contour_generator(t, h, distance.T).lines(0.0)
    return tuple(np.clip(np.asarray(line).T, 0.0, 1.0) for line in lines)


def draw_flank(axes: Axes, view: ToothView, *, boundary: bool = True, labels: tuple[bool, bool] = (True, True)) -> None:
    """Draw an empty flank, true to scale, its edges named, with labels along face and profile as asked for."""
    from matplotlib.patches import PathPatch, Polygon
    from matplotlib.ticker import MultipleLocator

    corners = view.corners  # shapes change no limits, which are set below
    axes.add_artist(Polygon(corners.T, facecolor=PAPER, edgecolor="none", zorder=0))
    axes.plot(*np.append(corners, corners[:, :1], axis=1), color=INK, linewidth=1.1, zorder=6)
    if boundary:
        axes.add_artist(PathPatch(view.outline(view.common), facecolor="white", edgecolor="none", zorder=0.5))
        for curve in view.common:
            axes.plot(*view.in_plane(curve), color=GREY, linewidth=0.8, linestyle=(0, (4, 2)), zorder=5)
    left, right, bottom, top = view.window
    gap = 0.3 * (corners[0].min() - left)
    names = (("toe", 0.0, 0.5, -1, 0), ("heel", 1.0, 0.5, 1, 0), ("root", 0.5, 0.0, 0, -1), ("tip", 0.5, 1.0, 0, 1))
    for name, t, h, across, up in names:
        x, y = view.plane(np.array([t, h])) + gap * np.array([across, up])
        horizontal, vertical = ("right", "center", "left")[across + 1], ("top", "center", "bottom")[up + 1]
        words: dict[str, Any] = {"fontsize": SMALL_SIZE + 0.5, "color": GREY, "style": "italic", "gid": EDGE_NAME}
        axes.text(x, y, name, ha=horizontal, va=vertical, **words)
    axes.set_aspect("equal")
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    axes.spines[:].set_visible(False)
    axes.tick_params(labelsize=SMALL_SIZE, colors=GREY, length=2.5, width=0.6, labelbottom=labels[0])
    step = tick_step(right - left)
    axes.xaxis.set_major_locator(MultipleLocator(step))
    axes.yaxis.set_major_locator(MultipleLocator(step))
    if labels[0]:
        axes.set_xlabel("along the face [mm]", fontsize=SMALL_SIZE, color=GREY, labelpad=2)
    axes.yaxis.set_visible(labels[1])
    if labels[1]:
        axes.set_ylabel("height [mm]", fontsize=SMALL_SIZE, color=GREY, labelpad=2)


def shared_aspect(views: tuple[ToothView, ...]) -> float:
    """Height over width of a window in which each of the views finds room, to one scale."""
    left, right, bottom, top = np.array([view.window for view in views]).T
    return float(np.max(top - bottom) / np.max(right - left))


def side_by_side(panels: NDArray[Any]) -> None:
    """Bring flanks that stand side by side to one scale, their numbers clear of the names of their edges."""
    limits = np.array([[axes.get_xlim(), axes.get_ylim()] for axes in panels.flat])  # (axes, x and y, low and high)
    extent = np.max(limits[..., 1] - limits[..., 0], axis=0)
    step = tick_step(float(extent[0]))
    for axes, bounds in zip(panels.flat, limits, strict=True):
        low, high = bounds.mean(axis=1) - 0.5 * extent, bounds.mean(axis=1) + 0.5 * extent
        axes.set_xticks(np.arange(0.0, bounds[0, 1], step))
        axes.set_yticks(np.arange(0.0, bounds[1, 1], step))
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.tick_params(axis="y", pad=15, length=0)


def tick_step(extent: float) -> float:
    """Round step that divides an extent into about six parts."""
    power = 10.0 ** np.floor(np.log10(extent / 6.0))
    return float(power * min((1.0, 2.0, 5.0, 10.0), key=lambda factor: abs(np.log(extent / 6.0 / (factor * power)))))
