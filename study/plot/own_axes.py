"""Axes of the caller: text in the size of their figure, and room for the names of a flank's edges."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties
from matplotlib.text import Text

from .panel_grid import one_by_one
from .style import BODY_SIZE
from .tooth_view import EDGE_NAME, tick_step

COLOUR_BAR_SHARE = 0.2  # of the width that a layout may still take for a colour bar and the labels of an axis
TEXT_DISTANCE = 2.0  # [pt]
TICK_DISTANCE = 3.5  # [pt]
TICK_COUNT_LIMIT = 4  # of finer ticks across a flank


@contextlib.contextmanager
def on_own_axes(axes: Any) -> Iterator[None]:
    """Draw on axes of the caller, then fit text, edge names and titles to them.

    Sizes of text, which are those of a page, become those of the figure: a title has ``font.size``.
    """
    given = [one for one in one_by_one(axes) if isinstance(one, Axes)]
    figures = {id(one.figure): one.get_figure(root=True) for one in given}
    before = {id(one) for figure in figures.values() if figure is not None for one in figure.axes}
    sizes = {id(text): text.get_fontsize() for one in given for text in _texts(one)}
    ticks = {(id(one), name): _tick_size(one, name) for one in given for name in ("x", "y")}
    yield
    bars = [one for figure in figures.values() if figure is not None for one in figure.axes if id(one) not in before]
    factor = rcParams["font.size"] / BODY_SIZE
    for one in (*given, *bars):
        for text in _texts(one):
            if sizes.get(id(text)) != text.get_fontsize():
                text.set_fontsize(factor * text.get_fontsize())
        for name in ("x", "y"):
            size = _tick_size(one, name)
            if size != ticks.get((id(one), name)):
                one.tick_params(axis=name, labelsize=factor * size)
    for one in given:
        if any(text.get_gid() == EDGE_NAME for text in one.texts):
            _make_room(one)
    _level(given)
    _separate_titles(given)


def _texts(axes: Axes) -> list[Text]:
    """Texts of axes but the labels of ticks, which have a size of their own."""
    ticks = {id(text) for axis in (axes.xaxis, axes.yaxis) for text in axis.findobj(Text) if text is not axis.label}
    texts: list[Any] = axes.findobj(Text)
    return [text for text in texts if id(text) not in ticks]


def _tick_size(axes: Axes, name: str) -> float:
    """Size of the labels of ticks [pt]."""
    axis, usual = (
        (axes.xaxis, rcParams["xtick.labelsize"]) if name == "x" else (axes.yaxis, rcParams["ytick.labelsize"])
    )
    return float(FontProperties(size=axis.get_tick_params().get("labelsize", usual)).get_size_in_points())


def _inches(axes: Axes) -> tuple[float, float]:
    """Width and height of axes before their aspect shrinks them [in]."""
    box = axes.get_position(original=True)
    figure: Any = axes.figure
    whole = figure.bbox.size / figure.dpi
    return float(box.width * whole[0]), float(box.height * whole[1])


def _make_room(axes: Axes) -> None:
    """Widen the view of a flank until the names of its edges, at their size, are within the axes."""
    figure: Any = axes.get_figure(root=True)
    names = [text for text in axes.texts if text.get_gid() == EDGE_NAME]
    extents = [text.get_window_extent() for text in names]
    line = max(extent.height for extent in extents) / figure.dpi
    word = max(extent.width for extent in extents) / figure.dpi
    width, height = _inches(axes)
    places = np.array([text.get_position() for text in names])
    low, high = places.min(axis=0), places.max(axis=0)
    room = np.array([(1.0 - COLOUR_BAR_SHARE) * width - 2.0 * word, height - 2.0 * line])
    scale = float(np.min(np.maximum(room, 0.25 * np.array([width, height])) / (high - low)))  # [in/mm]
    margin = np.array([word, line]) / scale
    axes.set_xticks([tick for tick in axes.get_xticks() if low[0] <= tick <= high[0]])
    axes.set_yticks(_ticks_within(axes.get_yticks(), float(low[1]), float(high[1])))
    axes.set_xlim(low[0] - margin[0], high[0] + margin[0])
    axes.set_ylim(low[1] - margin[1], high[1] + margin[1])
    axes.tick_params(axis="y", pad=TICK_DISTANCE)


def _ticks_within(ticks: Any, low: float, high: float) -> list[float]:
    """Those ticks that are within limits, or finer ones if these are fewer than two."""
    inner_ticks = [float(tick) for tick in ticks if low <= tick <= high]
    if len(inner_ticks) > 1:
        return inner_ticks
    step = tick_step(high - low)
    finer = step * np.arange(np.ceil(low / step), np.floor(high / step) + 1.0)
    return [float(tick) for tick in (finer if finer.size <= TICK_COUNT_LIMIT else finer[finer % (2.0 * step) == 0.0])]


def _level(panels: list[Axes]) -> None:
    """Give flanks in panels of one size one extent, so that they have one scale and their titles one height."""
    flanks = [one for one in panels if any(text.get_gid() == EDGE_NAME for text in one.texts)]
    if len(flanks) < 2 or not np.allclose([_inches(one) for one in flanks], _inches(flanks[0]), rtol=0.02):
        return
    limits = np.array([[one.get_xlim(), one.get_ylim()] for one in flanks])  # (panels, x and y, low and high)
    half = 0.5 * np.max(limits[..., 1] - limits[..., 0], axis=0)
    for one, centre in zip(flanks, limits.mean(axis=2), strict=True):
        one.set_xlim(centre[0] - half[0], centre[0] + half[0])
        one.set_ylim(centre[1] - half[1], centre[1] + half[1])


def _separate_titles(panels: list[Axes]) -> None:
    """Put titles on the left above those on the right, in all panels, if in one they do not stand side by side."""
    pairs = [(one, one.get_title(loc="left"), one.get_title(loc="right")) for one in panels]
    titled = [(one, left, _title_width(one, (left, right))) for one, left, right in pairs if left and right]
    if any(width > (1.0 - COLOUR_BAR_SHARE) * _inches(one)[0] for one, _, width in titled):
        for one, left, _ in titled:
            next(text for text in _texts(one) if text.get_text() == left).set_text(f"{left}\n")


def _title_width(axes: Axes, titles: tuple[str, str]) -> float:
    """Width that two titles need beside each other [in]."""
    figure: Any = axes.get_figure(root=True)
    texts = [text for text in axes.get_children() if isinstance(text, Text) and text.get_text() in titles]
    return float(sum(text.get_window_extent().width for text in texts) / figure.dpi + TEXT_DISTANCE / 72.0)
