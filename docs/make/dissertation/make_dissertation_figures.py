"""Write dissertation.md and its pictures from fresh analyses: python docs/make dissertation_figures."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from dissertation_figures import (
    ease_offs,
    loaded_errors,
    pattern_of_the_pair,
    patterns,
    pressures,
    save_small,
    unloaded_error,
)
from dissertation_method import by_its_method
from dissertation_tables import (
    BASE,
    EDGE_SHARE,
    HEADS,
    HEEL,
    LOADED,
    PANELS_3_7,
    POSITIONS_2_11,
    TOE,
    UNLOADED,
    analysed,
    figure_2_9,
    figure_2_11,
    figure_3_6,
    figure_3_7,
    named,
    table,
)
from folders import IMAGES, NOTES

import easeoff
from easeoff.cases import shipped_cases
from easeoff.study.plot.tooth_view import tooth_view
from easeoff.study.plot.topography_chart import ease_off_map
from easeoff.study.summary.curves import torque_name

HERE = Path(__file__).parent
FIGURES = IMAGES / "dissertation"
DESIGNS = {"fh-design-a": ("(a)", "design A"), "fh-design-b": ("(b)", "design B")}
OFFSET_RATIOS = {"fh-design-a": 0.07, "fh-design-b": 0.14}
EASE_OFF_SCALE = 100.0  # top of the colour scale of figure 5.3 [um]

SECTION_5_3 = """
## Figure 5.3: ease-off of designs A and B

![Ease-off of designs A and B](../../images/dissertation/figure_5_3.png)

Two face-hobbed pairs, `fh-design-a` and `fh-design-b`, that differ in their offset alone as far as possible. The thick
line is the path of contact of the pair that carries.

{table}

The ease-off was fitted to what the figure shows: its scale and its corners.
"""


def figure_5_3() -> str:
    """The section on designs A and B with its picture, empty while they are not shipped."""
    if not set(DESIGNS) <= set(shipped_cases()):
        return ""
    trees = {name: easeoff.analyze(by_its_method(name), torques=[500.0]) for name in DESIGNS}
    panels, maps = [], []
    rows: list[tuple[object, ...]] = []
    for name, (letter, design) in DESIGNS.items():
        case = easeoff.read_case(name)
        _, gap, inside = ease_off_map(tooth_view(trees[name]))
        maps.append((gap, inside))
        panels.append((f"{letter}  {design}", f"offset {case.pair.hypoid_offset:g} mm", trees[name]))
        blank = case.gear.blank
        assert blank is not None
        diameter = 2.0 * blank.outer_cone_distance * math.sin(math.radians(blank.pitch_angle))
        ratio = case.pair.hypoid_offset / diameter
        rows.append((f"offset over pitch diameter, {design}", f"{ratio:.2f}", f"{OFFSET_RATIOS[name]:.2f}"))
        greatest = f"{gap[inside].max():.0f}"
        rows.append((f"greatest ease-off, {design} [µm]", greatest, f"scale to {EASE_OFF_SCALE:.0f}"))
    save_small(ease_offs(panels), FIGURES / "figure_5_3.png")
    both = maps[0][1] & maps[1][1]
    difference = np.abs(maps[0][0] - maps[1][0])[both]
    rows.append(("greatest difference of A and B [µm]", f"{difference.max():.1f}", "similar"))
    return SECTION_5_3.format(table=table(rows, HEADS[:3]))


def draw() -> None:
    """Write the pictures of fm-11x41."""
    base = analysed(BASE)
    save_small(unloaded_error(base, UNLOADED.peak_to_peak), FIGURES / "figure_2_9.png")
    save_small(pattern_of_the_pair(base), FIGURES / "figure_2_10.png")
    save_small(patterns([(n, named(p), analysed(p)) for n, p in POSITIONS_2_11.items()]), FIGURES / "figure_2_11.png")
    levels = [(torque, row.mean, row.peak_to_peak) for torque, row in LOADED.items()]
    save_small(loaded_errors(base, levels), FIGURES / "figure_3_6.png")
    panels = [(f"{n}  {torque_name(q)}", named(p), analysed(p), q) for n, (q, p) in PANELS_3_7.items()]
    save_small(pressures(panels), FIGURES / "figure_3_7.png")


def sections() -> dict[str, str]:
    """What the template leaves open, but for figure 5.3."""
    parts = {"base": named(BASE), "toe": f"{TOE:g}", "heel": f"{HEEL:g}", "edge_share": f"{100 * EDGE_SHARE:.0f} %"}
    for name, make in (("2_9", figure_2_9), ("2_11", figure_2_11), ("3_6", figure_3_6), ("3_7", figure_3_7)):
        parts[f"figure_{name}"], parts[f"statements_{name}"] = make()
    return parts


def main() -> None:
    """Write the page."""
    draw()
    template = (HERE / "dissertation.md.in").read_text(encoding="utf-8")
    page = template.format(**sections(), figure_5_3=figure_5_3()).rstrip() + "\n"
    (NOTES / "dissertation.md").write_text(page, encoding="utf-8")
    print("wrote docs/how_it_works/notes/dissertation.md")


if __name__ == "__main__":
    main()
