"""Style of the comparison's figures: a colour a solver, legends ordered by merit, plain logarithmic axes."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

from ...plot.page import BODY_SIZE, GREY, INK, SMALL_SIZE, plain_axes
from ..measurement.method import COLD, RAW, SETTINGS
from ..statistics.method_statistics import MethodName, merit, methods

#: Okabe and Ito's colours without yellow, which is too faint for lines; the first is for the native solver.
#: Five darker ones follow.
COLOURS = (
    *("#222222", "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"),
    *("#7F4F24", "#6A3D9A", "#808000", "#A50026", "#7A7A7A"),
)
#: Dashes and markers, in numbers that share no factor with each other nor with that of the colours behind the first:
#: neighbours differ in all three, and lines can be told apart in grey.
DASHES = ((), (5, 1.5), (1.5, 1.2), (6, 1.5, 1.5, 1.5), (9, 2))
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
MARKED_POINTS = 7  # on a curve of many points

PANEL_HEIGHT = 2.9  # [in]
SIZE_TICK_LIMIT, TICK_DISTANCE = 8, 0.05  # sizes that are ticked themselves, and their least distance over the axis
ROUND_NUMBERS = ((1.0, 2.0, 5.0), (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0))  # ticks of a decade, and of less

Array = NDArray[Any]


def panels(problems: Any, time_limit: float) -> list[tuple[str, list[MethodName]]]:
    """Settings and cold methods of each panel, in the order of the first panel, which is by merit.

    The native solver, which has no settings, stands beside answers to the scaled problem, not in a panel of raw runs.
    """
    named = [
        method for method in methods(problems, time_limit) if method[2] == COLD
    ]  # not every problem has a warm one
    used = [name for name in SETTINGS if any(method[1] == name for method in named)]
    if not used:
        return []
    first = sorted(_of_panel(named, used[0]), key=lambda one: merit(problems, one, time_limit))
    rank = {method[0]: number for number, method in enumerate(first)}
    return [(name, sorted(_of_panel(named, name), key=lambda one: rank.get(one[0], len(rank)))) for name in used]


def _of_panel(named: list[MethodName], settings: str) -> list[MethodName]:
    return [one for one in named if one[1] == settings or (one[0] == "native" and settings != RAW)]


def style(solver: str, problems: Any) -> dict[str, Any]:
    """Line style of a solver, its own in all figures: colour, dashes and marker; native is a plain thick line."""
    if solver == "native":
        return {"color": COLOURS[0], "linewidth": 1.8}
    number = [name for name in dict.fromkeys(problems["solver"]) if name != "native"].index(solver)
    own = COLOURS[1:]
    return {
        "color": own[number % len(own)],
        "linewidth": 1.3,
        "dashes": DASHES[number % len(DASHES)],
        "marker": MARKERS[number % len(MARKERS)],
        "markersize": 3.2,
        "markeredgewidth": 0,
    }


def sparse_markers(count: int, number: int) -> tuple[int, int]:
    """First marked point of a curve of a number of points, and the step to the next; other curves begin elsewhere.

    Parameters
    ----------
    count
        Points of the curve.
    number
        Of the curve among those of the panel.
    """
    step = max(count // MARKED_POINTS, 1)
    return (number * step // MARKED_POINTS) % step, step


def finish(axes: Axes, title: str, right: str, label: str) -> None:
    """Titles, label of the ordinate and the legend at the side."""
    plain_axes(axes)
    axes.tick_params(which="minor", length=1.5, width=0.5, colors=GREY)
    axes.set_title(title, loc="left", fontsize=BODY_SIZE, color=INK, pad=3)
    axes.set_title(right, loc="right", fontsize=SMALL_SIZE + 0.5, color=GREY, pad=3)
    axes.set_ylabel(label, fontsize=SMALL_SIZE + 1, color=INK)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(
            loc="center left",
            bbox_to_anchor=(1.01, 0.5),
            fontsize=SMALL_SIZE,
            frameon=False,
            labelcolor=INK,
            handlelength=2.6,
        )


def abscissa(axes: Axes, label: str) -> None:
    """Label of the abscissa."""
    axes.set_xlabel(label, fontsize=SMALL_SIZE + 1, color=INK)


def settings_title(settings: str) -> str:
    """Title of a panel of one settings."""
    return f"{settings}: {SETTINGS[settings]}"


def plain_ticks(axis: Axis, values: Array | None = None) -> None:
    """Plain numbers on a logarithmic axis: the values themselves if they are few, otherwise round ones."""
    low, high = axis.get_view_interval()
    few = (
        values is not None
        and values.size <= SIZE_TICK_LIMIT
        and np.all(np.diff(np.log(values)) > TICK_DISTANCE * np.log(high / low))
    )
    for subs in ROUND_NUMBERS if high / low < 1e3 else ((1.0,),):
        ticks = np.outer(10.0 ** np.arange(-9.0, 10.0), subs)
        if np.count_nonzero((ticks >= low) & (ticks <= high)) > 1:
            break
    axis.set_major_locator(FixedLocator(values.tolist()) if few and values is not None else LogLocator(subs=subs))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())
