"""Contact of the shipped pairs without the split into bending and indentation, and its comparison with the analyses.

``python docs/make contact_reference [solve] [convergence] [tables] [figure]``: all of them if none is named.
``solve`` writes tests/data/contact_reference, which takes some minutes a pair once the responses of the teeth are kept.

After a change of flanks, teeth or elastic bodies; takes half an hour.
"""

from __future__ import annotations

import sys
from functools import cache
from typing import Any

import numpy as np
import xarray as xr
from contact_reference import (
    EDGE_MARGIN,
    EDGES,
    FOLDER,
    NAMES,
    analysed,
    away_from_edges,
    difference,
    line_stations,
    reference,
    setting,
)
from dissertation_figures import save_small
from folders import IMAGES
from matplotlib.ticker import MaxNLocator
from tabulate import tabulate

import easeoff
from easeoff.cases import gear_pair
from easeoff.cases.conversion import materials
from easeoff.contact import MeshLines, lines_in_mesh
from easeoff.contact.evaluation.pressure_map import Line, PressureMap, pressure_map, surface
from easeoff.core.output_file import whole_file
from easeoff.geometry import GearPair
from easeoff.geometry.tooth.tooth_flanks import MemberName
from easeoff.study.plot.axes_style import plain_bar
from easeoff.study.plot.mesh_cycle_charts import draw_surface, pressure_levels
from easeoff.study.plot.page import sheet
from easeoff.study.plot.style import GREY, SMALL_SIZE, WIDTH
from easeoff.study.plot.tooth_view import draw_flank, tooth_view
from easeoff.verification import (
    FlankContact,
    FlankResponse,
    FlanksInMesh,
    contact_of_flanks,
    flank_response,
    flanks_in_mesh,
)
from easeoff.verification.flank_contact import response_size

IMAGE = IMAGES / "finite_elements" / "contact_reference.png"
EVERY = 2  # of the case's mesh positions
MEMBERS: tuple[MemberName, ...] = ("pinion", "gear")
CHECKED = (("fm-11x41", 250.0), ("fh-12x41-45", 200.0))
CHANGES: dict[str, dict[str, Any]] = {
    "as kept": {},
    "5 cells in a half-width": {"cells": 5.0},
    "12 cells in a half-width": {"cells": 12.0},
    "finer bricks": {"finer": True},
    "none beyond the lines": {"beyond_lines": False},
}
MODELS = (("fe", True), ("solid_shell", True), ("shell", False), ("shell, edges", True))  # and whether edges touch
STATION = ("tooth", "lengthwise", "profile", "pressure", "line_load", "edge_distance")
UNITS = dict(zip(STATION, ("1", "1", "1", "MPa", "N/mm", "mm"), strict=True))


@cache
def responses(name: str, finer: bool = False) -> tuple[FlankResponse, FlankResponse]:
    """Of pinion and gear."""
    case = easeoff.read_case(name)
    pair = gear_pair(case)
    pinion, gear = (
        flank_response(pair, member, material, response_size(pair, member, finer=finer))
        for member, material in zip(MEMBERS, materials(case), strict=True)
    )
    return pinion, gear


@cache
def in_mesh(name: str) -> tuple[FlanksInMesh, MeshLines]:
    """Flanks and contact lines."""
    case, _, misalignment = setting(name)
    read = easeoff.read_case(case)
    pair = gear_pair(read).misaligned(misalignment)
    flanks = flanks_in_mesh(pair, (read.contact.lengthwise_nodes, read.contact.profile_nodes))
    return flanks, lines_in_mesh(flanks.splines, pair.assembly.pinion_pitch, read.contact.mesh_positions)


def solved(
    name: str, torque: float, position: int, *, cells: float = 8.0, finer: bool = False, beyond_lines: bool = True
) -> FlankContact:
    """Contact at one mesh position."""
    case = setting(name)[0]
    flanks, mesh = in_mesh(name)
    # Of the shell's answer no more is taken than how small the cells should be.
    near = analysed(name, "shell", edge_contact=False)["loaded"].to_dataset().sel(torque=torque)
    return contact_of_flanks(
        flanks,
        responses(case, finer),
        materials(easeoff.read_case(case)),
        mesh,
        position,
        torque,
        half_width=float(near["half_width"].max()),
        rotation=1e-6 * float(near["transmission_error"].max()),
        cells_per_half_width=cells,
        beyond_lines=beyond_lines,
    )


def solve(name: str) -> xr.Dataset:
    """Every second mesh position at every torque."""
    torques = setting(name)[1]
    flanks, mesh = in_mesh(name)
    positions = range(0, mesh.rotations.size, EVERY)
    found = {
        edges: [[solved(name, torque, k, beyond_lines=beyond) for k in positions] for torque in torques]
        for edges, beyond in zip(EDGES, (True, False), strict=True)
    }
    return kept(name, flanks.pair, np.array(torques), np.array(positions) / mesh.rotations.size, found)


def convergence() -> None:
    """What cells, bricks and edges do at four positions."""
    rows = []
    for name, torque in CHECKED:
        _, mesh = in_mesh(name)
        positions = range(0, mesh.rotations.size, mesh.rotations.size // 4)
        for label, change in CHANGES.items():
            if change.get("finer") and name != CHECKED[0][0]:
                continue  # minutes a member
            found = [solved(name, torque, k, **change) for k in positions]
            tables = [line_stations(in_mesh(name)[0].pair, one) for one in found]
            peak = max(table[3, table[5] > EDGE_MARGIN].max() for table in tables)
            middle = [100.0 * float(one.load_share[one.pairs.index(0)]) for one in found]
            numbers = [*(f"{1e6 * one.rotation:.1f}" for one in found), *(f"{share:.1f}" for share in middle)]
            rows.append([name, f"{torque:.0f}", label, *numbers, f"{peak:.0f}"])
        analysis = analysed(name, "fe")["loaded"].to_dataset().sel(torque=torque).isel(mesh_position=list(positions))
        errors, shares = analysis["transmission_error"].values, 100.0 * analysis["load_share"].sel(pair=0).values
        rows.append([name, f"{torque:.0f}", "with the split, fe", *(f"{x:.1f}" for x in (*errors, *shares)), ""])
    quarters = ("0", "1/4", "1/2", "3/4")
    head = ["case", "N m", "", *(f"urad at {k}" for k in quarters), *(f"share % at {k}" for k in quarters), "MPa"]
    print(tabulate(rows, head, "github", disable_numparse=True))


def kept(
    name: str, pair: GearPair, torques: np.ndarray, positions: np.ndarray, found: dict[str, list[list[FlankContact]]]
) -> xr.Dataset:
    """What is kept of the contact: every tooth pair's share, and pressure and line load along its line."""
    pairs = np.unique(np.concatenate([one.pairs for rows in found.values() for row in rows for one in row]))
    shape = (len(found), torques.size, positions.size)
    errors, shares = np.full(shape, np.nan), np.zeros((*shape, pairs.size))
    for place in np.ndindex(shape):
        one = found[EDGES[place[0]]][place[1]][place[2]]
        errors[place] = 1e6 * one.rotation
        shares[(*place, np.searchsorted(pairs, one.pairs))] = one.load_share
    tables = [[line_stations(pair, one) for one in row] for row in found[EDGES[0]]]
    widest = max(table.shape[1] for row in tables for table in row)
    stacked = np.full((len(STATION), *shape[1:], widest), np.nan, dtype=np.float32)
    for i, k in np.ndindex(shape[1:]):
        stacked[:, i, k, : tables[i][k].shape[1]] = tables[i][k]
    cycle = ("torque", "mesh_position")
    data: dict[str, Any] = {n: ((*cycle, "station"), stacked[m], {"units": UNITS[n]}) for m, n in enumerate(STATION)}
    data["transmission_error"] = (("edges", *cycle), errors, {"units": "urad"})
    data["load_share"] = (("edges", *cycle, "pair"), shares, {"units": "1"})
    title = f"{name}: contact of generated flanks without the split into bending and indentation"
    coords = {"edges": list(EDGES), "torque": torques, "mesh_position": positions, "pair": pairs}
    return xr.Dataset(data, coords=coords, attrs={"title": title})


def solve_all() -> None:
    """Write the kept files."""
    for name in NAMES:
        dataset = solve(name)
        encoding = {n: {"zlib": True, "complevel": 9} for n in (*STATION, "load_share", "transmission_error")}
        with whole_file(FOLDER / f"{name}.nc") as temporary:
            dataset.to_netcdf(temporary, engine="netcdf4", encoding=encoding)


def tables() -> None:
    """Differences of all models, with all edges and on the lines of contact alone."""
    head = ["case", "N m", "model", "mean urad", "mean %", "greatest %", "p-p urad", "model's", "share %"]
    for edges in EDGES:
        rows = []
        for name in NAMES:
            for torque in setting(name)[1]:
                for label, edge_contact in MODELS[: 4 if edges == EDGES[0] else 3]:
                    model = label.split(",")[0]
                    d = difference(name, model, torque, edges=edges, edge_contact=edge_contact)
                    level = float(reference(name).sel(torque=torque, edges=edges)["transmission_error"].mean())
                    numbers = [f"{x:.1f}" for x in (level, d.mean, d.error, *d.peak_to_peak, d.share)]
                    # Of the contact on lines alone the pressures were not kept: its peak is compared with all edges.
                    pressures = [f"{x:.1f}" for x in ((d.peak, d.pressure) if edges == EDGES[0] else (d.peak,))]
                    rows.append([name, f"{torque:.0f}", label, *numbers, *pressures])
        pressed = ["peak %", "pressure %"] if edges == EDGES[0] else ["peak %"]
        print(tabulate(rows, [*head, *pressed], "github", disable_numparse=True), end="\n\n")


def map_of(name: str, torque: float) -> PressureMap:
    """Pressure over the mesh cycle of the contact without the split."""
    dataset = reference(name).sel(torque=torque)
    positions = dataset.sizes["mesh_position"]
    steps: dict[int, list[Line]] = {}
    for k in range(positions):
        here = dataset.isel(mesh_position=k)
        for tooth in dataset["pair"].values:
            own = (here["tooth"].values == tooth) & (here["edge_distance"].values > 0.3)
            if np.count_nonzero(own) > 1:
                points = np.stack([here[n].values[own] for n in ("lengthwise", "profile")])
                order = np.argsort(points[0])
                line = Line(points[:, order].astype(float), here["pressure"].values[own][order].astype(float))
                steps.setdefault(k - int(tooth) * positions, []).append(line)
    return surface(steps)


def figure() -> None:
    """Reference, finite elements with edges and shell on lines alone side by side."""
    rows = [("fm-11x41", 250.0), ("fm-11x41-toe", 50.0), ("fm-11x41-heel", 50.0), ("fh-12x41-45", 500.0)]
    views = [tooth_view(analysed(name, "fe")) for name, _ in rows]
    page = sheet(sum((WIDTH - 1.4) / 3.0 * view.aspect + 0.4 for view in views) + 0.7)
    grid = page.subplots(len(rows), 3)
    for r, ((name, torque), view) in enumerate(zip(rows, views, strict=True)):
        models = (("fe", True), ("shell", False))
        maps = [map_of(name, torque)]
        trees = [analysed(name, m, edge_contact=edges) for m, edges in models]
        maps += [pressure_map(tree["loaded"].to_dataset().sel(torque=torque)) for tree in trees]
        peak = away_from_edges(reference(name).sel(torque=torque))
        peaks = [peak, *(peak * (1.0 + 0.01 * difference(name, m, torque, edge_contact=e).peak) for m, e in models)]
        levels = pressure_levels(max(one.peak for one in maps))
        shading = None
        for c, label in enumerate(("without the split", "finite elements", "shell")):
            axes = grid[r, c]
            draw_flank(axes, view, labels=(r == len(rows) - 1, False))
            axes.tick_params(axis="x", bottom=r == len(rows) - 1)
            axes.spines["bottom"].set_position(("outward", 5.0))  # beyond the word at the root
            shading = draw_surface(axes, view, maps[c], levels) or shading
            title = f"{name}, {torque:.0f} N m\n{label}, {peaks[c]:.0f} MPa off the edges"
            axes.set_title(title, fontsize=SMALL_SIZE, loc="left")
        assert shading is not None
        bar = page.colorbar(shading, ax=list(grid[r]), shrink=0.8, aspect=18, pad=0.01, ticks=MaxNLocator(5))
        plain_bar(bar, "MPa")
    note = f"numbers: greatest more than {EDGE_MARGIN:g} mm off the edges; +: greatest of all that is drawn"
    page.supxlabel(note, fontsize=SMALL_SIZE, color=GREY)
    save_small(page, IMAGE)


if __name__ == "__main__":
    parts = {"solve": solve_all, "convergence": convergence, "tables": tables, "figure": figure}
    for part in sys.argv[1:] or parts:
        parts[part]()
