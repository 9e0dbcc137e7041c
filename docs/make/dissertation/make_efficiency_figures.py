"""Write efficiency.md and its pictures from fresh analyses: python docs/make efficiency_figures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from dissertation_figures import save_small, title
from efficiency_radius import everywhere
from efficiency_tables import (
    DESIGNS,
    MAPS,
    TORQUES,
    Direction,
    analysed,
    maps,
    over_roughness,
    over_speed,
    parts,
)
from folders import IMAGES, NOTES
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from easeoff.contact.evaluation.pressure_map import pressure_map
from easeoff.study.plot.axes_style import plain_axes, plain_bar, torque_colours
from easeoff.study.plot.friction_charts import QUANTITIES, draw_values
from easeoff.study.plot.mesh_cycle_charts import draw_surface, pressure_levels
from easeoff.study.plot.style import INK, SMALL_SIZE, WIDTH
from easeoff.study.plot.tooth_view import draw_flank

HERE = Path(__file__).parent
FIGURES = IMAGES / "dissertation"
LETTERS = {"a": "(a)  design A", "b": "(b)  design B"}
# Contour lines of the dissertation's figures.
LEVELS = {
    "rolling_velocity": np.arange(0.5, 4.6, 0.5),
    "sliding_velocity": np.arange(0.5, 3.6, 0.25),
    "slide_to_roll": np.arange(0.1, 0.95, 0.1),
    "equivalent_radius": np.arange(5.0, 56.0, 5.0),
    "lambda_ratio": np.arange(0.1, 0.31, 0.05),
    "friction_coefficient": np.arange(0.01, 0.071, 0.01),
}

LINES: dict[Direction, dict[str, Any]] = {
    "across": {"linewidth": 1.6},
    "line": {"linewidth": 1.1, "linestyle": (0, (4, 2))},
}


def pressures() -> Figure:
    """Figure 5.4: greatest pressure at 500 N m."""
    views = {letter: maps(letter)[0] for letter in DESIGNS}
    surfaces = {
        letter: pressure_map(analysed(letter).tree["loaded"].to_dataset().sel(torque=500.0)) for letter in DESIGNS
    }
    levels = pressure_levels(max(surface.peak for surface in surfaces.values()))
    figure = sheet_of(1, views["a"].aspect, 0.75)
    panels = figure.subplots(1, 2)
    for axes, letter in zip(panels, DESIGNS, strict=True):
        draw_flank(axes, views[letter], labels=(False, False))
        axes.tick_params(bottom=False, left=False, labelleft=False)
        shading = draw_surface(axes, views[letter], surfaces[letter], levels)
        title(axes, LETTERS[letter], f"peak {surfaces[letter].peak:.0f} MPa")
    assert shading is not None
    bar = figure.colorbar(shading, ax=list(panels), orientation="horizontal", aspect=60, ticks=MaxNLocator(8))
    plain_bar(bar, "greatest contact pressure [MPa]")
    return figure


def sheet_of(rows: int, aspect: float, extra: float) -> Figure:
    """A sheet for so many rows of two flanks."""
    from easeoff.study.plot.page import sheet

    return sheet(rows * ((WIDTH - 0.4) / 2 * aspect + 0.25) + extra)


def flank_maps(names: tuple[str, ...], direction: Direction = "across") -> Figure:
    """Rows of maps, design A on the left."""
    figure = sheet_of(len(names), maps("a")[0].aspect, 0.1)
    panels = figure.subplots(len(names), 2, squeeze=False)
    for row, name in zip(panels, names, strict=True):
        for axes, letter in zip(row, DESIGNS, strict=True):
            view, found, _ = maps(letter, direction)
            draw_flank(axes, view, labels=(False, False))
            axes.tick_params(bottom=False, left=False, labelleft=False)
            words, colours = QUANTITIES[name]
            draw_values(axes, view, found[name], colours, LEVELS[name])
            title(axes, LETTERS[letter], words)
    return figure


def over_speeds() -> Figure:
    """Figure 5.11: power loss and efficiency over the speed at three torques."""
    from easeoff.study.plot.page import sheet

    figure = sheet(5.0)
    panels = figure.subplots(2, 2, sharex=True, sharey="row")
    for column, letter in zip(panels.T, DESIGNS, strict=True):
        for direction in LINES:
            found = over_speed(letter, direction).squeeze(("temperature", "roughness"))
            for torque, colour in zip(TORQUES, torque_colours(np.array(TORQUES)), strict=True):
                here = found.sel(torque=torque)
                style = {"color": colour, **LINES[direction]}
                style["label"] = f"{torque:g} N m" if direction == "across" else None
                column[0].semilogy(here["speed"], here["mean_power_loss"], **style)
                column[1].plot(here["speed"], 100.0 * here["efficiency"], **style)
        title(column[0], LETTERS[letter])
        column[1].set_xlabel("speed of the pinion [1/min]", fontsize=SMALL_SIZE + 1, color=INK)
    panels[0, 0].set_ylabel("power loss [W]", fontsize=SMALL_SIZE + 1, color=INK)
    panels[1, 0].set_ylabel("efficiency [%]", fontsize=SMALL_SIZE + 1, color=INK)
    panels[0, 0].set_ylim(1.0, 2e4)
    panels[1, 0].set_ylim(95.5, 99.5)
    for axes in panels.flat:
        plain_axes(axes)
        axes.set_xlim(0, 3000)
    panels[0, 1].legend(fontsize=SMALL_SIZE, frameon=False, labelcolor=INK, loc="lower right")
    return figure


def over_roughnesses() -> Figure:
    """Figure 5.12: efficiency over the roughness at three temperatures."""
    from easeoff.study.plot.page import sheet

    figure = sheet(2.8)
    panels = figure.subplots(1, 2, sharey=True)
    for axes, letter in zip(panels, DESIGNS, strict=True):
        for direction in LINES:
            found = over_roughness(letter, direction)
            for temperature, colour in zip(found["temperature"].values, torque_colours(np.arange(3.0)), strict=True):
                here = 100.0 * found["efficiency"].sel(temperature=temperature)
                label = f"{temperature:g} °C" if direction == "across" else None
                axes.plot(here["roughness"], here, color=colour, label=label, **LINES[direction])
        plain_axes(axes)
        axes.set_xlabel("RMS roughness of both flanks [µm]", fontsize=SMALL_SIZE + 1, color=INK)
        title(axes, LETTERS[letter])
    panels[0].set_ylabel("efficiency [%]", fontsize=SMALL_SIZE + 1, color=INK)
    panels[0].set_ylim(95.5, 99.5)
    panels[1].legend(fontsize=SMALL_SIZE, frameon=False, labelcolor=INK)
    return figure


def main() -> None:
    """Write the page."""
    save_small(pressures(), FIGURES / "figure_5_4.png")
    save_small(flank_maps(MAPS[:4]), FIGURES / "figure_5_5.png")
    save_small(flank_maps(MAPS[4:]), FIGURES / "figure_5_9.png")
    save_small(flank_maps(MAPS[3:], "line"), FIGURES / "figure_5_8_along.png")
    save_small(over_speeds(), FIGURES / "figure_5_11.png")
    save_small(over_roughnesses(), FIGURES / "figure_5_12.png")
    template = (HERE / "efficiency.md.in").read_text(encoding="utf-8")
    (NOTES / "efficiency.md").write_text(
        template.format(**parts(), everywhere=everywhere()),
        encoding="utf-8",
    )
    print("wrote docs/how_it_works/notes/efficiency.md")


if __name__ == "__main__":
    main()
