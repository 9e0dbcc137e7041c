"""Make the tables and pictures of ``optimal_modification.md``: python docs/make optimal_modification (minutes)."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from dissertation_figures import save_small, title
from dissertation_method import by_its_method
from folders import GUIDES, IMAGES, NOTES
from generated_part import with_generated
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation

import easeoff
from easeoff.contact.evaluation.pressure_map import PressureMap, pressure_map
from easeoff.study.design.case_design import fit_modification, recorded_modification
from easeoff.study.plot.axes_style import plain_bar
from easeoff.study.plot.mesh_cycle_charts import pressure_levels
from easeoff.study.plot.page import DPI, sheet
from easeoff.study.plot.style import INK, SMALL_SIZE

PICTURES = IMAGES / "optimal_modification"
PAGES = (GUIDES / "optimal_modification.md", NOTES / "modification_search.md")
CASES = ("fm-11x41", "fh-12x41-45")
RUNS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("`peak_load`", {"objective": "peak_load"}),
    ("`peak_load`, error up to 10 µrad", {"objective": "peak_load", "transmission_error": 10.0}),
    ("`peak_pressure`", {"objective": "peak_pressure"}),
    ("`even_load`", {"objective": "even_load"}),
)
COLUMNS = (("max_line_load", 0), ("max_pressure", 0), ("max_end_load", 0), ("peak_to_peak", 1))
LIMITS = (20.0, 14.0, 11.0, 9.0)
SHOWN = 250.0  # [N m]


def cells(tree: xr.DataTree, stage: str) -> list[str]:
    """Figures of all torques, in the order of ``COLUMNS``."""
    here = tree["optimization"].to_dataset().sel(stage=stage).isel(assembly=0)
    return [" / ".join(f"{value:.{digits}f}" for value in here[name].values) for name, digits in COLUMNS]


def programmes(tree: xr.DataTree) -> str:
    """How many programmes were solved, and the largest relative error of a promise once the search had settled."""
    record = tree["optimization"].to_dataset()
    taken = record.isel(programme=np.flatnonzero(record["accepted"]))
    error = abs(taken["promised_objective"].values[-1] / taken["fresh_objective"].values[-1] - 1.0)
    ended = "" if record.attrs["converged"] else ", cut short"
    return f"{record.sizes['programme']}{ended} | {error:.0e}"


def fitted_cells(name: str, tree: xr.DataTree) -> tuple[str, list[str]]:
    """What machine settings leave [um], and the figures of the case cut with them."""
    fitted, fit = fit_modification(by_its_method(name), recorded_modification(tree))
    loaded = easeoff.analyze(fitted)["loaded"].to_dataset()
    load = (loaded["force"] / loaded["length"]).transpose("torque", "mesh_position", "segment").values
    number = np.arange(load.shape[-1]) % fitted.contact.segments_per_line
    at_end = load[..., (number == 0) | (number == number.max())]
    values = {
        "max_line_load": np.nanmax(load, axis=(1, 2)),
        "max_pressure": loaded["max_pressure"].values,
        "max_end_load": np.nanmax(at_end, axis=(1, 2)),
        "peak_to_peak": loaded["peak_to_peak"].values,
    }
    row = [" / ".join(f"{value:.{digits}f}" for value in values[key]) for key, digits in COLUMNS]
    return f"settings fitted to it, {1e3 * fit.rms:.1f} µm left (rms)", row


def table(name: str, made: dict[str, xr.DataTree]) -> str:
    """Before and after of one case, as Markdown."""
    torques = " / ".join(f"{value:g}" for value in made[RUNS[0][0]]["loaded"].to_dataset()["torque"].values)
    lines = [
        f"`{name}` at {torques} N m:",
        "",
        "| | line load [N/mm] | pressure [MPa] | at the edges [N/mm] | error, peak to peak [µrad] "
        "| programmes | last promise off by |",
        "| --- | --- | --- | --- | --- | --- | --- |",
        f"| before | {' | '.join(cells(made[RUNS[0][0]], 'before'))} | | |",
    ]
    for label, _ in RUNS:
        lines.append(f"| {label} | {' | '.join(cells(made[label], 'after'))} | {programmes(made[label])} |")
        if label == RUNS[0][0]:
            said, row = fitted_cells(name, made[label])
            lines.append(f"| {said} | {' | '.join(row)} | | |")
    return "\n".join(lines)


def greatest_loads(tree: xr.DataTree) -> PressureMap:
    """Line load [N/mm] over the gear's flank at the shown torque, over all mesh positions."""
    loaded = tree["loaded"].to_dataset().sel(torque=SHOWN)
    # The root of the load, like a pressure, says where it ends.
    roots = pressure_map(loaded.assign(pressure=np.sqrt(np.maximum(loaded["force"], 0.0) / loaded["length"])))
    return replace(roots, pressure=roots.pressure**2)


def draw(before: xr.DataTree, after: xr.DataTree, path: Path) -> None:
    """The modification, and where the load was and is."""
    figure = sheet(2.7)
    left, *rest = figure.subplots(1, 3, sharey=True)
    surface = after["modification"].to_dataset()["modification"]
    t, h = surface["lengthwise"].values, surface["profile"].values
    filled = left.contourf(t, h, surface.values.T, levels=12, cmap="RdBu_r", vmin=-50, vmax=50)
    plain_bar(figure.colorbar(filled, ax=left, ticks=MaxNLocator(7, steps=[1, 2, 5, 10])), "µm")
    title(left, "modification")
    left.set_ylabel("root to tip", fontsize=SMALL_SIZE, color=INK)
    both = [greatest_loads(before), greatest_loads(after)]
    levels = pressure_levels(max(one.peak for one in both))
    for axes, loads, name in zip(rest, both, ("before", "after"), strict=True):
        mesh = Triangulation(loads.points[0], loads.points[1], loads.triangles)
        shading = axes.tricontourf(mesh, loads.pressure, levels=levels, cmap="viridis")
        title(axes, name, f"up to {loads.peak:.0f} N/mm")
    bar = figure.colorbar(shading, ax=rest, ticks=MaxNLocator(7))
    plain_bar(bar, f"line load at {SHOWN:g} N m [N/mm]")
    for axes in (left, *rest):
        axes.set_xlabel("toe to heel", fontsize=SMALL_SIZE, color=INK)
        axes.tick_params(labelsize=SMALL_SIZE, colors=INK, length=2.5, width=0.6)
        axes.set_xlim(0.0, 1.0)
        axes.set_ylim(0.0, 1.0)
    save_small(figure, path)


def trade(name: str, free: xr.DataTree) -> list[tuple[float, float]]:
    """Peak to peak [urad] and line load over that before, worst torque, under one limit after the other and none."""
    reached = []
    for tree in (*(easeoff.modify(by_its_method(name), transmission_error=limit) for limit in LIMITS), free):
        record = tree["optimization"].to_dataset().isel(assembly=0)
        load, after = record["max_line_load"], record.sel(stage="after")
        ratio = (load.sel(stage="after") / load.sel(stage="before")).max().item()
        reached.append((after["peak_to_peak"].max().item(), ratio))
        print(reached[-1], flush=True)
    return reached


def draw_trade(reached: list[tuple[float, float]], path: Path) -> None:
    """What a limit of the transmission error costs."""
    figure = Figure(figsize=(4.6, 3.0), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    axes.plot(*np.array(sorted(reached)).T, "o-")
    axes.axhline(1.0, color="0.6", linewidth=0.8)
    axes.set_xlabel("transmission error, peak to peak [µrad]")
    axes.set_ylabel("line load / before")
    save_small(figure, path)


def main() -> None:
    """Optimise, draw, and write the tables into the pages."""
    for name, page in zip(CASES, PAGES, strict=True):
        made = {}
        for label, options in RUNS:
            made[label] = easeoff.modify(by_its_method(name), **options)
            print(name, label, cells(made[label], "after"), programmes(made[label]), flush=True)
        write_table(page, name, table(name, made))
        if name == CASES[0]:
            free = made[RUNS[0][0]]
            draw(easeoff.analyze(by_its_method(name)), free, PICTURES / "optimal_modification.png")
            draw_trade(trade(name, free), PICTURES / "optimal_modification_trade.png")


def write_table(path: Path, name: str, made: str) -> None:
    """Put the table of a case between the comments of a page that name it."""
    path.write_text(with_generated(path.read_text(encoding="utf-8"), name, made), encoding="utf-8")


if __name__ == "__main__":
    main()
