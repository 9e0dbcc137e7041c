"""Draw figure 3.7 with shells beside finite elements, print its table: python docs/make pattern_comparison."""

from __future__ import annotations

import numpy as np
import xarray as xr
from dissertation_figures import quiet_edges, save_small, title
from dissertation_tables import PANELS_3_7, centre_of_load, named, table
from folders import IMAGES
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

import easeoff
from easeoff.contact.evaluation.pressure_map import PressureMap, pressure_map
from easeoff.geometry import Misalignment
from easeoff.study.plot.axes_style import plain_bar
from easeoff.study.plot.mesh_cycle_charts import draw_surface, pressure_levels
from easeoff.study.plot.page import sheet
from easeoff.study.plot.style import WIDTH
from easeoff.study.plot.tooth_view import draw_flank, tooth_view
from easeoff.study.summary.curves import torque_name

IMAGE = IMAGES / "finite_elements" / "patterns.png"
MODELS = {"shell": "shell", "solid_shell": "solid shell", "fe": "finite elements"}
DRAWN = ("shell", "fe")


def analysed(model: str, panel: str) -> xr.DataTree:
    """One panel with one model of the teeth."""
    torque, (offset, pinion_axial, _) = PANELS_3_7[panel]
    case = easeoff.read_case("fm-11x41")
    # The shell has no body between the teeth; the others do without it here.
    compliance = case.compliance.model_copy(update={"model": model, "neighbours": model == "shell"})
    errors = Misalignment(offset, pinion_axial)
    changed = case.model_copy(update={"compliance": compliance})
    # The compliances are compared, so all have the shell's contact lines alone.
    return easeoff.analyze(changed, torques=[torque], misalignment=errors, edge_contact=False)


def row(panel: str, model: str, loaded: xr.Dataset, best: xr.Dataset) -> tuple[object, ...]:
    """Figures of one panel with one model, and how far its pressures are from those of finite elements (rms)."""
    torque, position = PANELS_3_7[panel]
    t, h = centre_of_load(loaded)
    seen, expected = (np.nan_to_num(one["pressure"].values) for one in (loaded, best))
    apart = 100.0 * float(np.linalg.norm(seen - expected) / np.linalg.norm(expected))
    values = (loaded["mean_level"], loaded["peak_to_peak"], loaded["max_pressure"])
    mean, swing, peak = (float(value) for value in values)
    where = f"{panel} {torque_name(torque)}, {named(position)}"
    return (where, MODELS[model], f"{t:.3f}, {h:.3f}", f"{mean:.1f}", f"{swing:.1f}", f"{peak:.0f}", f"{apart:.1f}")


def drawn(panels: list[tuple[str, str, xr.DataTree, PressureMap]]) -> Figure:
    """Maps of greatest pressure, two models a row."""
    levels = pressure_levels(max(surface.peak for *_, surface in panels))
    views = [tooth_view(tree) for _, _, tree, _ in panels]
    rows = len(panels) // 2
    figure = sheet(rows * ((WIDTH - 1.2) / 2.0 * views[0].aspect + 0.27) + 0.7)
    grid = figure.subplots(rows, 2)
    shading = None
    for number, (axes, view, (name, where, _, surface)) in enumerate(zip(grid.flat, views, panels, strict=True)):
        draw_flank(axes, view, labels=(number >= len(panels) - 2, number % 2 == 0))
        quiet_edges(axes, number < len(panels) - 2)
        shading = draw_surface(axes, view, surface, levels) or shading
        title(axes, name, f"{where}, peak {surface.peak:.0f} MPa")
    if shading is not None:
        bar = figure.colorbar(shading, ax=list(grid.flat), location="bottom", shrink=0.6, aspect=40, pad=0.01,
                              ticks=MaxNLocator(7))  # fmt: skip
        plain_bar(bar, "greatest contact pressure [MPa], all panels")
    return figure


def main() -> None:
    """Write the picture, print the table."""
    rows, panels = [], []
    for panel, (torque, _) in PANELS_3_7.items():
        trees = {model: analysed(model, panel) for model in MODELS}
        results = {model: tree["loaded"].to_dataset().isel(torque=0) for model, tree in trees.items()}
        rows += [row(panel, model, loaded, results["fe"]) for model, loaded in results.items()]
        for model in DRAWN:
            where = f"{MODELS[model]}, {torque_name(torque)}"
            panels.append((panel, where, trees[model], pressure_map(results[model])))
    save_small(drawn(panels), IMAGE)
    heads = ["panel", "teeth", "centre of load", "mean urad", "peak to peak urad", "peak MPa", "pressures apart %"]
    print(table(rows, heads))


if __name__ == "__main__":
    main()
