"""Style of axes: spines, labels, titles, legends, colour bars, and the colours of torques."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .style import BODY_SIZE, GREY, INK, SMALL_SIZE, TORQUE_MAP

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colorbar import Colorbar
    from matplotlib.figure import Figure

#: Height of a row of a legend over the size of its text, and greatest share of the axes that a legend takes.
LEGEND_ROW, LEGEND_SHARE_LIMIT = 1.25, 0.6


def plain_axes(axes: Axes, x: str = "", y: str = "", title: str = "") -> None:
    """Style axes: two thin spines, small ticks and a faint grid; with labels and a title if they are given."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color(GREY)
    axes.tick_params(labelsize=SMALL_SIZE + 0.5, colors=INK, length=3, width=0.6)
    axes.grid(True, color="#e6e6e6", linewidth=0.6)
    axes.set_axisbelow(True)
    label_axes(axes, x, y, title)


def label_axes(axes: Axes, x: str = "", y: str = "", title: str = "") -> None:
    """Labels and title of axes, as far as they are given."""
    if title:
        axes.set_title(title, loc="left", fontsize=BODY_SIZE, color=INK, pad=3)
    for set_label, text in ((axes.set_xlabel, x), (axes.set_ylabel, y)):
        if text:
            set_label(text, fontsize=SMALL_SIZE + 1, color=INK)


def panel_titles(axes: Axes, name: str, said: str = "") -> None:
    """Name of a panel on the left above it, and what is said of it on the right."""
    axes.set_title(name, loc="left", fontsize=BODY_SIZE, color=INK, weight="bold", pad=3)
    axes.set_title(said, loc="right", fontsize=SMALL_SIZE + 0.5, color=GREY, pad=3)


def plain_legend(axes: Axes) -> None:
    """Legend without a frame, where there is most room."""
    axes.legend(fontsize=SMALL_SIZE, frameon=False, labelcolor=INK)


def legend_of_curves(axes: Axes, *, on_page: bool, heading: str = "") -> None:
    """Legend to the right of the axes on a page; on axes of the caller above the curves, in room made for it."""
    style: dict[str, Any] = {"fontsize": SMALL_SIZE, "labelcolor": INK, "handlelength": 1.6, "alignment": "left"}
    style |= {"title": heading or None, "title_fontsize": SMALL_SIZE, "frameon": False}
    if on_page:
        legend = axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), borderaxespad=0.6, **style)
    else:
        from matplotlib import rcParams

        rows = len(axes.get_legend_handles_labels()[1]) + bool(heading)
        figure: Any = axes.figure
        height = axes.get_position().height * figure.bbox.height / figure.dpi
        share = min(rows * LEGEND_ROW * rcParams["font.size"] / 72.0 / height, LEGEND_SHARE_LIMIT)
        low, high = axes.get_ylim()
        axes.set_ylim(low, low + (high - low) / (1.0 - share))
        legend = axes.legend(loc="upper left", borderaxespad=0.3, labelspacing=0.25, **style)
    legend.get_title().set_color(GREY)


def legend_at_foot(figure: Figure, entries: list[Any], height: float) -> None:
    """Legend below the body of a page, in a strip of a height [in] that is taken from the body."""
    engine: Any = figure.get_layout_engine()
    left, bottom, width, whole = engine.get()["rect"]
    strip = height / figure.get_size_inches()[1]
    engine.set(rect=(left, bottom + strip, width, whole - strip))
    figure.legend(
        handles=entries, loc="center", bbox_to_anchor=(0.5, bottom + 0.5 * strip), ncols=3, fontsize=SMALL_SIZE + 0.5,
        frameon=False, labelcolor=INK, handlelength=2.2, columnspacing=2.0,
    )  # fmt: skip


def plain_bar(bar: Colorbar, label: str) -> None:
    """Style a colour bar: label, small ticks, no outline."""
    bar.set_label(label, fontsize=SMALL_SIZE + 0.5, color=INK)
    bar.ax.tick_params(labelsize=SMALL_SIZE, colors=INK, length=2.5, width=0.6)
    bar.outline.set_visible(False)


def torque_colours(torques: NDArray[Any]) -> NDArray[Any]:
    """Colours (n, 4) of torques (n), dark for the small ones."""
    from matplotlib import colormaps

    rank = np.empty(torques.size)
    rank[np.argsort(torques, kind="stable")] = np.linspace(0.0, 0.82, torques.size) if torques.size > 1 else 0.35
    return np.asarray(colormaps[TORQUE_MAP](rank))
