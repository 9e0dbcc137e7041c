"""Draw the shipped shafts and bearings of ``supports.md``: python docs/make support_drawings.

Writes docs/images/supports.png.
"""

from __future__ import annotations

import numpy as np
from dissertation_figures import save_small
from folders import IMAGES
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from easeoff.cases import read_case, read_supports
from easeoff.cases.conversion import sections
from easeoff.cases.schema.supports_table import MemberSupportTable
from easeoff.geometry.flanks.blank_section import BlankSection

PICTURE = IMAGES / "supports.png"
SYSTEMS = {"axle-fm-11x41": "fm-11x41", "gearbox-nasa-12x36": "nasa-12x36"}
#: Width and outer diameter of the bearings, by the names of case, member and bearing (ISO 355) [mm].
BEARING_SIZES = {
    ("fm-11x41", "head"): (24.75, 80.0),
    ("fm-11x41", "tail"): (21.25, 62.0),
    ("fm-11x41", "flange side"): (24.75, 85.0),
    ("fm-11x41", "far side"): (24.75, 85.0),
    ("nasa-12x36", "head"): (24.25, 72.0),
    ("nasa-12x36", "tail"): (21.25, 62.0),
    ("nasa-12x36", "gear side"): (24.75, 80.0),
    ("nasa-12x36", "far side"): (24.75, 80.0),
}
LOAD_CENTRE = 5.5  # inside the large face of the inner ring, about [mm]
SHAFT, BEARING, TOOTH = "0.85", "tab:blue", "tab:orange"


def draw_member(axes: Axes, case: str, member: str, blank: BlankSection, held: MemberSupportTable) -> None:
    """Axial section of a shaft with its bearings and the teeth of its member."""
    assert held.shaft is not None
    for section in held.shaft.sections:
        inner, outer = 0.5 * section.inner_diameter, 0.5 * section.outer_diameter
        for low in (inner, -outer) if inner else (-outer,):
            size = section.end - section.start, outer - inner if inner else 2.0 * outer
            axes.add_patch(Rectangle((section.start, low), *size, facecolor=SHAFT, edgecolor="k", linewidth=0.6))
    corners = blank.corners[[0, 0, 1, 1], [0, 1, 1, 0]]
    for side in (1.0, -1.0):
        axes.add_patch(Polygon(corners * [1.0, side], facecolor=TOOTH, edgecolor="k", linewidth=0.6))
    lowest = -4.0 - max(float(corners[:, 1].max()), *(0.5 * BEARING_SIZES[case, b.name][1] for b in held.bearings))
    for bearing in held.bearings:
        width, outer = BEARING_SIZES[case, bearing.name]
        shaft = _diameter(held, bearing.position)
        # The large face is towards the pinion's head, the nut, or the middle of the gear's shaft.
        sense = 1.0 if bearing.name in ("head", "flange side", "gear side") else -1.0
        start = bearing.position - sense * LOAD_CENTRE
        for low in (0.5 * shaft, -0.5 * outer):
            box = Rectangle((min(start, start + sense * width), low), width, 0.5 * (outer - shaft))
            box.set(facecolor="none", edgecolor=BEARING, linewidth=1.2)
            axes.add_patch(box)
        axes.plot(bearing.position, 0.0, "^", color=BEARING, markersize=7, clip_on=False)
        axes.annotate(bearing.name, (bearing.position, lowest), ha="center", va="top", color=BEARING)
    middle = float(blank.points(np.array(0.5), np.array(0.5))[0])
    seat = held.shaft.seat if held.shaft.seat is not None else middle
    axes.plot(middle, 0.0, "o", color=TOOTH, markeredgecolor="k")
    if held.shaft.seat is not None:
        axes.plot(seat, 0.0, "s", color="k", markersize=4)
    axes.axhline(0.0, color="k", linewidth=0.6, dashes=(12, 3, 2, 3))
    axes.set_title(f"{case}, {member}", fontsize=10)
    axes.set_xlabel("place on the axis [mm]")
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.margins(0.05, 0.12)


def _diameter(held: MemberSupportTable, place: float) -> float:
    """Outer diameter of the shaft at a place [mm]."""
    assert held.shaft is not None
    return next(s.outer_diameter for s in held.shaft.sections if s.start <= place <= s.end)


def main() -> None:
    """Draw both members of both systems."""
    figure = Figure(figsize=(10.0, 8.0), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.subplots(2, 2, width_ratios=(1.5, 1.0))
    for row, (supports, case) in zip(grid, SYSTEMS.items(), strict=True):
        table, blanks = read_supports(supports), sections(read_case(case))
        for axes, member, blank in zip(row, ("pinion", "gear"), blanks, strict=True):
            draw_member(axes, case, member, blank, getattr(table, member))
        row[0].set_ylabel("radius [mm]")
    save_small(figure, PICTURE)


if __name__ == "__main__":
    main()
