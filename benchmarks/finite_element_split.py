"""What the choices of the split of bending and indentation do to the loaded contact: a part of the benchmark."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr
from finite_element_teeth import CASES, MEMBERS, pair_of
from tabulate import tabulate

from easeoff.cases import read_case
from easeoff.cases.conversion import elastic_model
from easeoff.contact import STEEL
from easeoff.contact import ElasticFoundation
from easeoff.contact.compliance.finite_elements.elastic_body import elastic_body, functionals
from easeoff.contact.compliance.finite_elements.flank_compliance import (
    FlankCompliance,
    flank_loads,
    foot_displacements,
    square_root,
)
from easeoff.contact.compliance.finite_elements.finite_element_tooth import solid_shell_tooth, usual_size
from easeoff.contact.loaded import CycleSolver, loaded_splines
from easeoff.contact.compliance.elastic_model import ElasticTeeth
from easeoff.contact.segments import CycleSegments, LineSegments
from easeoff.contact import lines_in_mesh
from easeoff.geometry import GearPair, PairGeometry, pair_geometry
from easeoff.geometry import tooth_lattice


def split() -> None:
    """What the choices of the split do to the loaded contact."""
    rows = []
    for name in CASES:
        case, pair = read_case(name), pair_of(name)
        geometry = pair_geometry(pair, (case.contact.lengthwise_nodes, case.contact.profile_nodes))
        fields = loaded_splines(geometry.flanks, geometry.ease_off, geometry.teeth)
        mesh = lines_in_mesh(fields, pair.assembly.pinion_pitch, case.contact.mesh_positions)
        kernels: dict[str, list[FlankCompliance]] = {"foot": [], "same": [], "flank": []}
        for member in MEMBERS:
            lattice = tooth_lattice(pair, member, usual_size(pair, member))
            solved = elastic_body(lattice.nodes, lattice.cells, lattice.fixed_nodes, STEEL)
            loads, count = flank_loads(lattice), len(lattice.nodes)
            across = lattice.column[:, lattice.column.shape[1] // 2, lattice.root_row :].reshape(-1, 1)
            inward = -lattice.flank_normal.reshape(-1, 3)
            for label, wanted in (
                ("foot", foot_displacements(lattice)),
                ("same", functionals(count, across, np.ones(across.shape), inward)),
                ("flank", loads),
            ):
                factor = square_root(solved.response(loads, wanted))
                kernels[label].append(FlankCompliance(lattice.lengthwise, lattice.profile, factor))
            kernels.setdefault("solid", []).append(solid_shell_tooth(pair, member, STEEL).flank)
        base = elastic_model(case, None)
        same_height = geometry.teeth.copy(deep=True)
        same_height["shell_height"] = _own_height(pair, geometry)
        rim = ElasticFoundation("odonnell", 0.8)
        with_elements = {k: replace(base, condensed=(v[0], v[1])) for k, v in kernels.items()}
        variants = [
            ("finite elements, foot of the normal", with_elements["foot"], None),
            ("the same + 0.14 q (1 - nu^2) / E", replace(with_elements["foot"], foot_correction=0.14), None),
            ("finite elements, straight across", with_elements["same"], None),
            ("finite elements, the flank itself (counts twice)", with_elements["flank"], None),
            ("solid shell, foot of the normal", with_elements["solid"], None),
            ("shell, foot of the normal", base, None),
            ("shell, fitted plate", replace(base, plate="fitted"), None),
            ("shell, fitted plate, 0.8 O'Donnell", replace(base, plate="fitted", foundation=rim), None),
            ("shell, same height", base, same_height),
            ("shell, clamped", replace(base, foundation=None), None),
        ]
        for label, model, teeth in variants:
            splines = fields if teeth is None else loaded_splines(geometry.flanks, geometry.ease_off, teeth)
            on_lines = LineSegments(splines, mesh, ElasticTeeth(geometry.teeth, model), case.contact.segments_per_line)
            solver = CycleSolver(pair.assembly.ratio, edge_contact=False)
            loaded, _ = solver.loaded(CycleSegments(splines, on_lines), np.array(case.contact.torques))
            last = loaded.isel(torque=-1)
            numbers = [float(last[n]) for n in ("mean_level", "peak_to_peak", "max_pressure")]
            rows.append([name, float(last["torque"]), label, *numbers])
    print(tabulate(rows, ["case", "N m", "model", "mean urad", "peak to peak urad", "pressure MPa"], "github", ".1f"))


def _own_height(pair: GearPair, geometry: PairGeometry) -> xr.DataArray:
    """Height of the contact points themselves above the root cone, as ``shell_height``."""
    teeth = geometry.teeth
    heights = teeth["shell_height"].copy(deep=True)
    grid = [g.ravel() for g in np.meshgrid(teeth["lengthwise"], teeth["profile"], indexing="ij")]
    gear = pair.gear.section
    heights.loc[{"member": "gear"}] = gear.height_above_root(*gear.points(*grid)).reshape(heights.shape[1:])
    ease_off = geometry.ease_off
    on_pinion = [ease_off[n].values.ravel() for n in ("pinion_lengthwise", "pinion_profile")]
    pinion = pair.pinion.section
    heights.loc[{"member": "pinion"}] = pinion.height_above_root(*pinion.points(*on_pinion)).reshape(heights.shape[1:])
    return heights
