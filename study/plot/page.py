"""Page of a picture: size, heading, small print, and the file."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray as xr

from ...core.errors import printable
from ...core.output_file import whole_file
from ..analysis.key_numbers import deviations, model_name, modification
from ..summary.assembly import error_values, misalignment_over_torque
from ..summary.table import with_signs
from .style import BODY_SIZE, GREY, HEADING_SIZE, INK, SMALL_SIZE, WIDTH

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = ("png", "svg", "pdf")
DPI = 160
COMPRESSION = 3  # of PNG files: 6, the usual one, takes nearly twice as long for a few percent
TRUETYPE = 42  # kind of the fonts in a PDF file: text that can be searched and edited
HEADER, FOOTER = 0.60, 0.40  # heights [in]
SMALL_PRINT_LENGTH, SMALL_PRINT_HEIGHT = 145, 0.14  # of a line: characters, height [in]
SEPARATOR = " · "
HELD = "\0"  # a blank at which no line ends
BEFORE_UNIT = re.compile(r"(?<=\d) (?=(?:µm|mm|MPa|N m|1/min|°C|%))")


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
    return [line.replace(HELD, " ").removesuffix(" ·") for line in lines]


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
