"""Draw the flow of data and the imports between folders for CONTRIBUTING.md: python docs/make overview.

Each picture carries what it shows in its metadata: a test computes that anew and compares. Folders, public names,
commands and formats in the flow are looked up in the package; one that is not there ends the script.

After a change of folders, of what they import, or of a result's groups.
"""

from __future__ import annotations

import importlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from folders import IMAGES
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch, Rectangle
from package_imports import PACKAGE, ROOMS, folder, folder_imports, modules

FLOW, IMPORTS = IMAGES / "data_flow.png", IMAGES / "imports.png"
#: The one import against the order.
EXCEPTION = ("study/cli", "verification")
COLOURS = dict(zip(ROOMS, ("#e8e8e8", "#d5e8d4", "#dae8fc", "#ffe6cc", "#fff2cc", "#e1d5e7", "#f8cecc"), strict=True))
INK, FAINT, RED = "#222222", "#7a7a7a", "#c00000"


@dataclass(frozen=True)
class Step:
    """A step of an analysis: the folders that compute it, a public name to begin reading with, groups it fills."""

    title: str
    folders: tuple[str, ...]
    name: str
    words: str
    groups: tuple[str, ...]
    inputs: str = ""  # files that come in here
    outputs: str = ""  # files that go out here


STEPS = (
    Step(
        "case",
        ("cases",),
        "cases.read_case",
        "blanks, cutters,\nmachine settings;\nchecked keys",
        (),
        "case.toml .rexs .ses\nor design.toml, fitted",
        "sheet .html\n.txt .rexs",
    ),
    Step(
        "flanks",
        ("geometry/cutting", "geometry/flanks"),
        "geometry.flank",
        "position, normal,\ncurvature on a grid",
        ("flanks",),
        "measured grid\n.csv .nc .dmi",
        "points .csv .nc\n.step .stl .vtu",
    ),
    Step(
        "ease-off",
        ("geometry/pair",),
        "geometry.ease_off",
        "gap to the conjugate\nflank; roll angle,\nlever arm",
        ("ease_off", "modification"),
    ),
    Step(
        "elastic teeth",
        ("geometry/tooth", "contact/compliance"),
        "contact.ElasticModel",
        "shell, solid shell,\nfinite elements;\nroot stress",
        ("teeth", "root_stress"),
    ),
    Step(
        "contact lines",
        ("contact/lines",),
        "contact.unloaded_contact",
        "lines of equal roll\nangle, segments,\nedges; print",
        ("unloaded", "backlash"),
    ),
    Step(
        "contact problem",
        ("contact/problem", "contact/solvers"),
        "contact.solve",
        "min ½ F·CF + S·F\nr·F = T, F ≥ 0;\ncertified",
        ("loaded", "light_load"),
        "deflections .csv\nload cases .csv",
        "problems .nc\n.mat .qps .npz",
    ),
    Step(
        "supports",
        ("contact/supports",),
        "contact.Supports",
        "shafts, bearings:\nease-off anew\nunder load",
        ("misalignment", "supports"),
        "supports.toml",
    ),
    Step(
        "friction",
        ("friction",),
        "friction.friction",
        "film, coefficient,\nloss, flash\ntemperature",
        ("friction",),
        "oil.toml",
    ),
)
#: Groups that searches add to the result of what they find.
SEARCHES = {"modify": ("optimization",), "optimize": ("optimal_settings", "front")}
NOTEBOOK = "in a notebook"
#: What reads a result: folder, commands, and what it makes.
READERS = (
    ("study/summary", "show, cite", "text"),
    ("study/plot", "plot", "{formats}"),
    ("study/report", "report, export", ".html .vtu .rexs"),
    ("study/notebook", NOTEBOOK, "tables, figures"),
)
#: What goes through all steps again and again: folders, commands, and what it makes.
STUDIES = (
    ("study/sweep", "sweep", "sweep.nc"),
    ("study/design", "modify, optimize", "result.nc, case.toml"),
    ("study", "vh, wear, correct", ".nc, case.toml"),
    ("verification", "verify", "table of differences"),
)


def shown_flow() -> dict[str, Any]:
    """What the picture of the flow shows; everything that is named exists."""
    known = {folder(name) for name in modules()}
    for step in STEPS:
        package, name = step.name.split(".")
        assert hasattr(importlib.import_module(f"easeoff.{package}"), name), step.name
        assert known.issuperset(step.folders), step.folders
    assert known.issuperset(place for place, _, _ in (*READERS, *STUDIES))
    steps = [[step.title, *step.folders, step.name, *step.groups, step.inputs, step.outputs] for step in STEPS]
    return {"steps": steps, "searches": list(SEARCHES.values()), "readers": readers(), "studies": STUDIES}


def readers() -> list[tuple[str, str, str]]:
    """What reads a result, with the formats of pictures that there are; the commands exist."""
    from easeoff.study.cli import main

    for _, commands, _ in (*READERS, *STUDIES):
        assert commands == NOTEBOOK or main.commands.keys() >= set(commands.split(", ")), commands
    (option,) = (one for one in main.commands["plot"].params if one.name == "file_format")
    formats = " ".join(f".{name}" for name in option.type.choices)  # type: ignore[attr-defined]
    return [(place, command, words.format(formats=formats)) for place, command, words in READERS]


def groups_in_the_flow() -> set[str]:
    """Groups of a result that the picture names."""
    return {group for names in (*(step.groups for step in STEPS), *SEARCHES.values()) for group in names}


def shown_imports() -> dict[str, Any]:
    """What the picture of the imports shows: folders in their order, and which import which."""
    pairs = folder_imports()
    return {"folders": ordered(pairs), "imports": sorted(map(list, pairs))}


def ordered(pairs: Iterable[tuple[str, str]]) -> list[str]:
    """Folders, room by room, each as far as possible behind those that it imports."""
    left = {folder(name) for name in modules()} - {""}
    found: list[str] = []
    for room in ROOMS:
        waiting = {name for name in left if name.split("/")[0] == room}
        while waiting:
            wanted = {name: sum(one == name and other in waiting for one, other in pairs) for name in waiting}
            found.append(min(waiting, key=lambda name: (wanted[name], name)))
            waiting.remove(found[-1])
    return found


def box(axes: Axes, place: tuple[float, float], size: tuple[float, float], colour: str, **options: Any) -> None:
    """A rounded box by its lower left corner."""
    axes.add_patch(FancyBboxPatch(place, *size, boxstyle="round,pad=0,rounding_size=0.06", facecolor=colour, **options))


def arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float]) -> None:
    """An arrow from place to place."""
    axes.add_patch(FancyArrowPatch(start, end, arrowstyle="-|>", mutation_scale=9, color=INK, linewidth=0.9))


def draw_flow() -> Figure:
    """Files above, steps in the middle, the result with its groups below, and what reads it or repeats the steps."""
    wide, gap = 1.44, 0.16
    figure = Figure(figsize=(12.95, 5.55))
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, 12.95), ylim=(0.0, 5.55))
    axes.axis("off")
    left = [0.15 + (wide + gap) * number for number in range(len(STEPS))]
    right = left[-1] + wide
    small: dict[str, Any] = {"fontsize": 7.6, "ha": "center", "va": "center", "color": INK}
    faint = {**small, "fontsize": 7.2, "color": FAINT}
    for number, (step, x) in enumerate(zip(STEPS, left, strict=True)):
        middle, room = x + 0.5 * wide, step.folders[-1].split("/")[0]
        box(axes, (x, 2.72), (wide, 1.42), COLOURS[room], edgecolor=INK, linewidth=0.9)
        axes.text(middle, 3.98, step.title, **{**small, "fontsize": 9.5, "weight": "bold"})
        axes.text(middle, 3.53, step.words, **small)
        axes.text(middle, 2.97, "\n".join(step.folders), **faint)
        if step.inputs:
            frame = {"boxstyle": "square,pad=0.25", "fc": "white", "ec": INK}
            axes.text(middle, 5.22, step.inputs, bbox=frame, **small)
            at = x + 0.2 if step.outputs else middle
            arrow(axes, (at, 5.02), (at, 4.15))
        if step.outputs:
            frame = {"boxstyle": "square,pad=0.25", "fc": "white", "ec": FAINT, "linestyle": "--"}
            axes.text(x + 0.88, 4.62, step.outputs, bbox=frame, **small)
            arrow(axes, (x + 0.88, 4.15), (x + 0.88, 4.42))
        if number:
            arrow(axes, (x - gap, 3.43), (x, 3.43))
        for place, group in enumerate(step.groups):
            axes.text(middle, 2.13 - 0.27 * place, f"/{group}", **{**small, "fontsize": 8.2, "family": "monospace"})
        if step.groups:
            arrow(axes, (middle, 2.72), (middle, 2.36))
    box(axes, (0.15, 1.58), (right - 0.15, 0.78), "none", edgecolor=INK, linewidth=1.2)
    axes.text(0.27, 2.08, "result.nc", fontsize=10.5, weight="bold", va="center", color=INK)
    axes.text(0.27, 1.82, "study/result", **{**faint, "ha": "left"})
    cells = [(f"{what}\n{place}", commands) for place, commands, what in readers()]
    cells += [(f"{what}\n{place}", commands) for place, commands, what in STUDIES]
    for number, (x, (words, commands)) in enumerate(zip(left, cells, strict=True)):
        reads = number < len(READERS)
        box(axes, (x, 0.45), (wide, 0.74), "white" if reads else "#f4f4f4", edgecolor=FAINT, linewidth=0.8)
        axes.text(x + 0.5 * wide, 1.03, commands, **{**small, "fontsize": 7.6, "weight": "bold"})
        axes.text(x + 0.5 * wide, 0.7, words, **{**faint, "color": INK})
        if reads:
            arrow(axes, (x + 0.5 * wide, 1.58), (x + 0.5 * wide, 1.2))
    middle = left[len(READERS)]
    axes.text(0.15, 0.22, "read the result", **{**faint, "ha": "left", "fontsize": 8.2})
    searches = "; ".join(f"{name} adds {', '.join('/' + g for g in SEARCHES[name])}" for name in SEARCHES)
    said = f"run all steps again with other inputs; {searches}"
    axes.text(middle, 0.22, said, **{**faint, "ha": "left", "fontsize": 8.2})
    return figure


def draw_imports(shown: Mapping[str, Any]) -> Figure:
    """A row a folder, with a mark in the column of every folder that it imports."""
    names, pairs = shown["folders"], {tuple(pair) for pair in shown["imports"]}
    count, cell = len(names), 0.22
    left, top, bottom = 2.3 / cell, 1.25 / cell, 0.65 / cell
    figure = Figure(figsize=((left + count + 0.5) * cell, (top + count + bottom) * cell))
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(-left, count + 0.5), ylim=(count + bottom, -top))
    axes.axis("off")
    for room in ROOMS:
        places = [place for place, name in enumerate(names) if name.split("/")[0] == room]
        first, size = places[0], len(places)
        axes.add_patch(Rectangle((-left, first), left + count, size, facecolor=COLOURS[room], alpha=0.5))
        axes.add_patch(Rectangle((first, first), size, size, facecolor=COLOURS[room], edgecolor=FAINT, linewidth=0.8))
        axes.text(0.4 - left, first + 0.5, room, fontsize=9, weight="bold", va="center", color=INK)
    for place, name in enumerate(names):
        text = name.split("/")[1] if "/" in name else f"{name}/*.py"
        style: dict[str, Any] = {"fontsize": 8.5, "color": INK, "style": "normal" if "/" in name else "italic"}
        axes.text(-0.4, place + 0.5, text, va="center", ha="right", **style)
        axes.text(place + 0.5, -0.3, text, rotation=90, va="bottom", ha="center", **style)
        axes.plot(place + 0.5, place + 0.5, "s", color=FAINT, markersize=3)
    for one, other in pairs:
        if one in names and other in names:
            colour = RED if (one, other) == EXCEPTION else INK
            axes.plot(names.index(other) + 0.5, names.index(one) + 0.5, "o", markersize=6, color=colour)
    said = (
        "A row imports from the columns with a dot. From one colour to another nothing imports to the right, but the",
        "command verify when it is run (red). Dots right of the diagonal are of single modules: no circle.",
    )
    for place, line in enumerate(said):
        axes.text(0.4 - left, count + 0.9 + 1.1 * place, line, fontsize=8.5, va="center", color=INK)
    return figure


def main() -> None:
    """Draw both pictures."""
    assert (PACKAGE / "pyproject.toml").exists(), "drawn from a checkout"
    for path, shown, figure in (
        (FLOW, shown_flow(), draw_flow()),
        (IMPORTS, imports := shown_imports(), draw_imports(imports)),
    ):
        figure.savefig(path, dpi=110, facecolor="white", metadata={"Description": json.dumps(shown)})
        print(f"wrote {path}")


if __name__ == "__main__":
    main()
