"""Page of a picture: size, heading, small print, colours, and the PNG file."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.arrays import Integers
from ...core.errors import printable
from ...core.output_file import whole_file
from ..analysis.key_numbers import deviations, model_name, modification
from ..summary.deflection_report import error_values, misalignment_over_torque
from ..summary.table import with_signs

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colorbar import Colorbar
    from matplotlib.figure import Figure

DPI = 160
COMPRESSION = 3  # of PNG files: 6, the usual one, takes nearly twice as long for a few percent
TRUETYPE = 42  # kind of the fonts in a PDF file: text that can be searched and edited
WIDTH = 8.6  # [in]
HEADER, FOOTER = 0.60, 0.40  # heights [in]
SMALL_PRINT_LENGTH, SMALL_PRINT_HEIGHT = 145, 0.14  # of a line: characters, height [in]
SEPARATOR = " · "
HELD = "\0"  # a blank at which no line ends
BEFORE_UNIT = re.compile(r"(?<=\d) (?=(?:µm|mm|MPa|N m|1/min|°C|%))")
BODY_SIZE, SMALL_SIZE, HEADING_SIZE = 9.0, 7.5, 12.0  # [pt]

# Okabe and Ito's colours, told apart by readers with any kind of colour vision.
INK, GREY, FAINT, PAPER = "#222222", "#6b6b6b", "#b8b8b8", "#f1f1ef"
BLUE, VERMILION, GREEN = "#0072B2", "#D55E00", "#009E73"
PRESSURE_MAP = "YlOrRd"
TORQUE_MAP = "viridis"

PANEL_COUNT_LIMIT = 6
#: Height of a row of a legend over the size of its text, and greatest share of the axes that a legend takes.
LEGEND_ROW, LEGEND_SHARE_LIMIT = 1.25, 0.6


def page(tree: xr.DataTree, heading: str, body_height: float, note: str = "") -> Figure:
    """Empty page with heading and small print, and a height [in] for the body between them."""
    on_supports = {"supports_name": ""} if "supports" in tree.children else {}
    moving = {"misalignment_by_supports": ""} if on_supports and misalignment_over_torque(tree) is not None else {}
    parts = small_print(on_supports | moving | tree.attrs)
    print_ = even_lines([printable(part) for part in (*parts, *note.split(SEPARATOR)) if part])
    footer = FOOTER + SMALL_PRINT_HEIGHT * (len(print_) - 1)
    title = textwrap.shorten(printable(str(tree.attrs.get("title", ""))), 110, placeholder=" ...")
    return titled_sheet(heading, title, "\n".join(print_), body_height, footer)


def in_print(notes: list[str]) -> list[str]:
    """Notes as small print: without their first word and last stop, with the signs of the pictures."""
    return [with_signs(note.removeprefix("Note: ").removesuffix(".")) for note in notes]


def even_lines(parts: Sequence[str], longest: int = SMALL_PRINT_LENGTH) -> list[str]:
    """Parts of the small print in the fewest lines of at most ``longest`` characters, of about equal length.

    A part stays on one line unless longer than half a line, and a number stays with its unit.
    """
    unbroken_parts = [
        BEFORE_UNIT.sub(HELD, part) if 2 * len(part) > longest else part.replace(" ", HELD) for part in parts
    ]
    text = f"{HELD}· ".join(unbroken_parts)
    lines = textwrap.wrap(text, longest, break_on_hyphens=False)
    for length in range(longest - 1, 0, -1):
        shorter = textwrap.wrap(text, length, break_on_hyphens=False, break_long_words=False)
        if len(shorter) > len(lines) or max(map(len, shorter), default=0) > length:
            break
        lines = shorter
    return [line.replace(HELD, " ") for line in lines]


def titled_sheet(heading: str, title: str, print_: str, body_height: float, footer: float = FOOTER) -> Figure:
    """Sheet with heading, title and small print around a body of a height [in], above a footer of a height [in]."""
    height = body_height + HEADER + footer
    figure = sheet(height)
    engine: Any = figure.get_layout_engine()
    engine.set(rect=(0.01, footer / height, 0.98, body_height / height), h_pad=0.05, w_pad=0.05)
    top, left = 1.0 - 0.13 / height, 0.02
    figure.text(left, top, heading, fontsize=HEADING_SIZE, color=INK, va="top", weight="bold")
    figure.text(left, top - 0.25 / height, title, fontsize=BODY_SIZE, color=GREY, va="top", parse_math=False)
    figure.text(left, 0.10 / height, print_, fontsize=SMALL_SIZE, color=GREY, va="bottom", parse_math=False)
    return figure


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


def sheet(height: float) -> Figure:
    """White sheet of the page's width and a height [in], without heading and small print."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, height), dpi=DPI, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def small_print(attributes: Mapping[Any, Any]) -> list[str]:
    """Small print of a result: teeth, flanks, misalignment, supports, departures, elastic model and version."""
    flanks = {"drive": "drive: pinion concave, gear convex", "coast": "coast: pinion convex, gear concave"}
    errors = [error.words(value, "+.4g") for error, value in error_values(attributes).items() if value]
    given = ", ".join(errors).replace("-", "−").replace("Sigma", "Σ").replace("deg", "°")
    teeth = f"{attributes['pinion_teeth']} x {attributes['gear_teeth']}" if "pinion_teeth" in attributes else ""
    name = str(attributes.get("flank", ""))
    version = attributes.get("easeoff_version", "")
    departures = (("deviating flanks", deviations(attributes)), ("modified ease-off", modification(attributes)))
    departed = [with_signs(f"{what}: {words}").replace(" -", " −") for what, words in departures if words]
    # A sweep and load cases say by themselves which errors they have.
    if "deflections" in attributes:  # what stands in the other attributes is without torque
        given = f"over the torque: {attributes['deflections']}"
    if "misalignment_by_supports" in attributes:
        given = f"{given or 'none'} without load, then that of the supports"
    misalignment = given or ("none" if "flank" in attributes and "swept" not in attributes else "")
    misaligned = f"misalignment {misalignment}" if misalignment else ""
    supports = f"on supports {attributes['supports_name']}".strip() if "supports_name" in attributes else ""
    model = model_name(attributes)
    return [teeth, flanks.get(name, name), misaligned, supports, *departed, model, f"easeoff {version}".strip()]


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


def plain_bar(bar: Colorbar, label: str) -> None:
    """Style a colour bar: label, small ticks, no outline."""
    bar.set_label(label, fontsize=SMALL_SIZE + 0.5, color=INK)
    bar.ax.tick_params(labelsize=SMALL_SIZE, colors=INK, length=2.5, width=0.6)
    bar.outline.set_visible(False)


def evenly_chosen(values: NDArray[Any], most: int = PANEL_COUNT_LIMIT) -> Integers:
    """Indices of at most ``most`` values (n), rising with the values, spread evenly with both ends."""
    order = np.argsort(values, kind="stable")
    ranks = np.unique(np.linspace(0, order.size - 1, min(most, order.size)).round().astype(int))
    return np.asarray(order[ranks], dtype=np.int64)


def middle(values: NDArray[Any]) -> int:
    """Number of the middle one of values (n), the lower of two."""
    return int(np.argsort(values)[(values.size - 1) // 2])


def torque_colours(torques: NDArray[Any]) -> NDArray[Any]:
    """Colours (n, 4) of torques (n), dark for the small ones."""
    from matplotlib import colormaps

    rank = np.empty(torques.size)
    rank[np.argsort(torques, kind="stable")] = np.linspace(0.0, 0.82, torques.size) if torques.size > 1 else 0.35
    return np.asarray(colormaps[TORQUE_MAP](rank))


def save(figure: Figure, path: Path, marks: Mapping[str, str] | None = None) -> Path:
    """Write a figure as .png, .svg or .pdf with its marks; undated, so the same figure gives the same file."""
    kind = path.suffix[1:]
    with whole_file(path) as temporary:
        if kind == "png":
            canvas: Any = figure.canvas  # its own method, unlike that of the figure, does not draw everything twice
            canvas.print_png(temporary, metadata=marks, pil_kwargs={"compress_level": COMPRESSION})
            return path
        from matplotlib import rc_context

        source = "Subject" if kind == "pdf" else "Source"
        metadata: dict[str, str | None] = {"CreationDate" if kind == "pdf" else "Date": None}
        metadata |= {source if key == "Source" else key: text for key, text in (marks or {}).items()}
        with rc_context({"svg.hashsalt": "easeoff", "pdf.fonttype": TRUETYPE}):
            figure.savefig(temporary, format=kind, metadata=metadata)
    return path
