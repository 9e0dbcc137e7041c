"""Edges beside the contact lines: against the exact gap of the turned flanks, and what they do to a loaded pair."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr
from runs import small
from tooth_models import coarse_solid_shells, with_teeth

from easeoff import analyze, read_case
from easeoff.cases import gear_pair
from easeoff.contact import ElasticModel, MeshLines, lines_in_mesh
from easeoff.contact.compliance.elastic_model import ElasticTeeth
from easeoff.contact.compliance.finite_elements.flank_compliance import FlankCompliance
from easeoff.contact.compliance.spread_deflection import MODES
from easeoff.contact.lines.closest_approach import OppositePoints, across_line, one_step, pinion_points
from easeoff.contact.lines.contact_lines import ContactLines
from easeoff.contact.lines.flank_splines import FlankSplines
from easeoff.contact.lines.mesh_edges import (
    EDGES,
    EdgeElements,
    edge_distance,
    edge_elements,
    edges_in_mesh,
    flank_edges,
    line_rotations,
    lines_to_edges,
)
from easeoff.contact.loaded import EDGE_SEARCH_ROTATION_FACTOR, CycleSolver, loaded_splines
from easeoff.contact.segments import CycleSegments, LineSegments
from easeoff.geometry import GearPair, Misalignment, PairGeometry, pair_geometry
from easeoff.study import CaseInMesh
from easeoff.verification import FlanksInMesh, flanks_in_mesh
from easeoff.verification.surface_cells import exact_gap

PAIRS = {
    "fm-11x41": Misalignment(offset=-0.15, pinion_axial=0.12),
    "fm-11x41 at its toe": Misalignment(offset=-0.08, pinion_axial=0.05),
    "fh-12x41-45": Misalignment(),
    "nasa-12x36": Misalignment(),
}
WIDEST = 3e-4  # [rad]


def misaligned(name: str) -> GearPair:
    return gear_pair(read_case(name.split()[0])).misaligned(PAIRS[name])


@cache
def prepared(name: str) -> tuple[PairGeometry, FlankSplines, MeshLines]:
    pair = misaligned(name)
    geometry = pair_geometry(pair)
    fields = loaded_splines(geometry.flanks, geometry.ease_off, geometry.teeth)
    return geometry, fields, lines_in_mesh(fields, pair.assembly.pinion_pitch, 8)


@cache
def found(name: str) -> tuple[np.ndarray, EdgeElements]:
    """Pinion rotations over the whole passage of a tooth pair and a little beyond, and what may touch there."""
    _, _, mesh = prepared(name)
    pairs = np.arange(mesh.pair.min() - 1, mesh.pair.max() + 2)
    rotations = (mesh.rotations[:, None] - pairs * mesh.pinion_pitch).ravel()
    fields = prepared(name)[1]
    return rotations, edge_elements(fields, rotations, np.full(rotations.size, WIDEST), flank_edges(fields))


@cache
def flanks(name: str) -> FlanksInMesh:
    return flanks_in_mesh(misaligned(name))


@cache
def exact(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Gap as a gear rotation (n) and fractions on the pinion (2, n) along the normals of the turned gear flank."""
    rotations, elements = found(name)
    return exact_gap(flanks(name), elements.points, rotations[elements.level])


def off_edge(places: np.ndarray) -> np.ndarray:
    """How far places (2, n) lie from toe, heel and tip, as fractions."""
    return np.asarray(np.min(np.abs([places[0], 1.0 - places[0], 1.0 - places[1]]), axis=0))


@pytest.mark.parametrize("name", PAIRS)
def test_gap_is_that_of_the_turned_flanks(name: str) -> None:
    """The expansion about conjugate contact holds over the millimetre to an edge: 3 % of the gap and half a urad."""
    elements = found(name)[1]
    assert elements.level.size > 40
    gap, _ = exact(name)
    assert np.all(np.abs(elements.separation_angle - gap) < 0.03 * np.abs(elements.separation_angle) + 0.5e-6)
    assert np.all(elements.separation_angle < WIDEST)


@pytest.mark.parametrize("name", PAIRS)
def test_elements_lie_on_an_edge_of_one_flank_and_within_the_other(name: str) -> None:
    """Of the gear exactly; of the pinion, which moves over the gear, within 0.2 % of the flank."""
    elements = found(name)[1]
    _, pinion = exact(name)
    on_gear, on_pinion = off_edge(elements.points) < 1e-12, off_edge(pinion) < 2e-3
    assert np.all(on_gear | on_pinion)
    assert np.any(on_pinion)
    # The gear of this pair has the higher teeth: no edge of it comes near.
    assert np.any(on_gear) == (name != "nasa-12x36")
    assert np.all((pinion > -5e-3) & (pinion < 1.005))
    assert np.all((elements.points >= 0.0) & (elements.points <= 1.0))


@pytest.mark.parametrize("name", PAIRS)
def test_the_pinion_is_loaded_where_it_faces_the_gear(name: str) -> None:
    """At the foot of the gear's normal on the turned flank within 0.15 % of the flank, on its own edge within 2e-5.

    In conjugate contact with the same points of the gear are other points of the pinion, up to a tenth of its height
    away.
    """
    rotations, elements = found(name)
    fields = prepared(name)[1]
    loaded = pinion_points(fields, elements.points, rotations[elements.level])
    own, conjugate = (OppositePoints.of(fields, points).fractions for points in (loaded, elements.points))
    facing = exact(name)[1]
    assert np.max(np.abs(own - facing)) < 1.5e-3
    assert np.max(np.abs(conjugate - facing)) > 0.04
    for number, (fraction, value) in enumerate(EDGES):
        of_pinion = elements.edge == 2 * number + 1
        assert np.all(np.abs(own[fraction, of_pinion] - value) < 2e-5)


def test_in_conjugate_contact_the_pinion_is_loaded_at_the_same_point() -> None:
    _, fields, mesh = prepared("nasa-12x36")
    points = mesh.lines.points
    found = pinion_points(fields, points, line_rotations(mesh)[:, None])
    np.testing.assert_allclose(found, points, rtol=0, atol=1e-9)


def test_a_force_on_the_tip_of_the_pinion_bends_its_tooth_at_the_tip() -> None:
    """The bending compliance of pieces of an edge against that of the teeth at the fractions of both members."""
    geometry, fields, mesh = prepared("nasa-12x36")
    teeth = ElasticTeeth(geometry.teeth, coarse_solid_shells(geometry.pair), geometry.pair)
    cycle = CycleSegments(fields, LineSegments(fields, mesh, teeth, 5))
    here = next(one for one in cycle.with_edges(np.full(8, WIDEST)) if one is not None and np.any(one.edge == 5))
    tip, weight = here.edge == 5, np.ones(1)
    pinion, gear = cycle.on_lines.teeth.both
    assert isinstance(pinion, FlankCompliance)
    assert isinstance(gear, FlankCompliance)
    on_pinion = OppositePoints.of(fields, here.pinion_point[:, tip]).fractions
    assert np.all(np.abs(on_pinion[1] - 1.0) < 2e-5)
    both = (pinion, on_pinion), (gear, here.point[:, tip])
    own = sum(np.sum(tooth.whitened(at[..., None], weight) ** 2, axis=0) for tooth, at in both)
    loads = cycle.on_lines.loads_on((here.pinion_point[:, tip, None], here.point[:, tip, None]), weight).on_teeth
    beside = sum(one.nodes.size for one in cycle.on_lines.spread) + 4 * MODES  # two ends of two teeth
    assert loads[2].shape[1] == beside
    np.testing.assert_allclose(sum(np.sum(part**2, axis=1) for part in loads[:2]), own, rtol=1e-9)


def test_edges_begin_where_contact_lines_end() -> None:
    """Next to both ends of every line on the flank there is an edge with the gap of the line's end."""
    _, fields, mesh = prepared("fh-12x41-45")
    edges = edges_in_mesh(fields, mesh, np.full(mesh.rotations.size, WIDEST), flank_edges(fields))
    position = fields("position", edges.elements.points)
    checked = 0
    for m in range(mesh.pair.size):
        own = (edges.position == mesh.position[m]) & (edges.pair == mesh.pair[m])
        for end in (0, -1):
            place = mesh.lines.points[:, m, end, None]
            gap = float(fields("ease_off_angle", place)[0])
            if gap > 0.5 * WIDEST:
                continue
            distance = np.linalg.norm(position[:, own] - fields("position", place), axis=0)
            nearest = int(np.argmin(distance))
            assert distance[nearest] < 0.5
            assert abs(edges.elements.separation_angle[own][nearest] - gap) < 0.05 * WIDEST
            assert edges.elements.overhang[own][nearest] < 0.2
            checked += 1
    assert checked >= 6


def test_finer_elements_change_little(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of what edges carry as they are pressed evenly: the length times the overlap."""
    _, fields, _ = prepared("fm-11x41")
    rotations, elements = found("fm-11x41")

    def overlap(e: EdgeElements) -> float:
        return float(np.sum(e.length * (WIDEST - e.separation_angle)))

    widest = np.full(rotations.size, WIDEST)
    values = {}
    for count in (40, 80, 640):
        monkeypatch.setattr("easeoff.contact.lines.mesh_edges.ELEMENTS_PER_EDGE", count)
        values[count] = overlap(edge_elements(fields, rotations, widest, flank_edges(fields)))
    errors = {count: abs(value / values[640] - 1.0) for count, value in {**values, 160: overlap(elements)}.items()}
    assert errors[160] < 0.015
    assert errors[160] < 0.6 * errors[80] < 0.6 * errors[40]


def segments_of(geometry: PairGeometry, fields: FlankSplines, mesh: MeshLines, count: int = 31) -> CycleSegments:
    """Segments of contact lines between teeth that are shells."""
    return CycleSegments(fields, LineSegments(fields, mesh, ElasticTeeth(geometry.teeth, ElasticModel()), count))


def loaded(name: str, torque: float, *, edge_contact: bool) -> tuple[np.ndarray, np.ndarray]:
    """Rotation [rad] and share of the edges over the mesh cycle."""
    geometry, fields, mesh = prepared(name)
    cycle = segments_of(geometry, fields, mesh)
    result, _ = CycleSolver(misaligned(name).assembly.ratio, edge_contact).loaded(cycle, np.array([torque]))
    assert np.all(result["status"] == 0)
    np.testing.assert_allclose(result["load_share"].sum("pair"), 1.0, atol=1e-9)
    return 1e-6 * result["transmission_error"].values[0], result["edge_share"].values[0]


def on_lines_to_edges(name: str, torque: float, mesh: MeshLines, segments: int = 31) -> np.ndarray:
    """Rotation [rad] over the mesh cycle on the lines that end at the edges, without the edges."""
    geometry, fields, _ = prepared(name)
    cycle, ratio = segments_of(geometry, fields, mesh, segments).to_edges, misaligned(name).assembly.ratio
    found, _ = CycleSolver(ratio, edge_contact=False).loaded(cycle, np.array([torque]))
    assert float(found["edge_share"].max()) == 0.0
    return np.asarray(1e-6 * found["transmission_error"].values[0])


@pytest.mark.parametrize(
    ("name", "torque"), [("fm-11x41", 500.0), ("fm-11x41 at its toe", 50.0), ("fh-12x41-45", 500.0)]
)
def test_what_touches_besides_holds_the_pair_back(name: str, torque: float) -> None:
    """So the search within the rotation that the lines allow misses nothing; away from edges nothing changes."""
    lines = on_lines_to_edges(name, torque, prepared(name)[2])
    edges, share = loaded(name, torque, edge_contact=True)
    assert np.all(edges <= lines * (1.0 + 1e-9))
    assert EDGE_SEARCH_ROTATION_FACTOR >= 1.0
    assert 0.025 < share.max() < 0.2
    without = share < 1e-12
    np.testing.assert_allclose(edges[without], lines[without], rtol=1e-9)
    assert np.all(edges[share > 0.01] < lines[share > 0.01])


def test_a_little_load_touches_no_edge() -> None:
    """An ease-off keeps the edges clear of each other: that is what it is for."""
    assert np.max(loaded("fm-11x41", 20.0, edge_contact=True)[1]) < 1e-3


@cache
def at_500(model: str, edges: bool, **argument: Any) -> xr.DataTree:
    """Analysed with the word of the case file, and perhaps with the argument."""
    case = small("fm-11x41", edge_contact=edges, mesh_positions=2)
    teeth: dict[str, Any] = {} if model == "shell" else {"fineness": 0.3, "neighbours": False}
    return analyze(with_teeth(case, model, **teeth), torques=[500.0], **argument)


def on_edges(tree: xr.DataTree) -> tuple[int, bool]:
    return tree.attrs["edge_contact"], float(tree["loaded/edge_share"].max()) > 0.03


@pytest.mark.parametrize("model", ["shell", "solid_shell"])
def test_edges_touch_with_every_model_unless_lines_alone_are_asked_for(model: str) -> None:
    assert on_edges(at_500(model, True)) == (1, True)
    assert on_edges(at_500(model, False)) == (0, False)


def test_an_argument_counts_before_the_case_and_a_cycle_has_its_own() -> None:
    assert read_case("fm-11x41").contact.edge_contact
    assert on_edges(at_500("shell", True, edge_contact=False)) == (0, False)
    assert on_edges(at_500("shell", False, edge_contact=True)) == (1, True)
    cycle = CaseInMesh.of(small("fm-11x41", "shell", mesh_positions=2)).cycle
    assert float(cycle.loaded([500.0])[0]["edge_share"].max()) > 0.03
    assert float(cycle.loaded([500.0], edge_contact=False)[0]["edge_share"].max()) == 0.0


def test_one_word_in_the_case_lets_edges_touch() -> None:
    on, off = (at_500("shell", edges)["loaded"].to_dataset() for edges in (True, False))
    assert float(on["edge_share"].max()) > 0.03
    assert float(off["edge_share"].max()) == 0.0
    assert np.all(np.isnan(off["overhang"]))
    at_edge = np.isfinite(on["overhang"].values)
    assert np.all(np.isnan(on["pressure"].values[at_edge]))
    assert np.all(np.isfinite(on["pressure"].values[np.isfinite(on["force"].values) & ~at_edge]))
    assert np.all(on["half_width"].values[at_edge & (on["force"].values > 0.0)] > 0.0)
    assert np.isfinite(on["max_pressure"].item())


def test_friction_on_edges_is_in_the_balance_of_power() -> None:
    """An edge slides as the flank it is on does: what it takes is in the losses and off the output."""
    case = small("fh-design-a", "shell", edge_contact=True)
    tree = analyze(case, torques=[500.0], speed=1000.0, temperature=90.0, roughness=0.8, friction_feedback=True)
    assert float(tree["loaded/edge_share"].max()) > 0.02
    assert float(np.abs(tree["friction/energy_balance"]).max()) < 1e-10
    losses = tree["friction/power_loss"].isel(torque=0).squeeze(drop=True)
    on_edges = np.isfinite(tree["loaded/overhang"].isel(torque=0)) & (losses > 0.0)
    assert int(on_edges.sum()) > 0
    assert float(losses.where(on_edges).sum()) < 0.2 * float(losses.sum())


@pytest.mark.parametrize("solver", ["clarabel", "daqp", "piqp"])
def test_other_solvers_find_the_same_on_edges(solver: str) -> None:
    native, other = (solved_by(name) for name in ("native", solver))
    assert np.all(other["status"] == 0)
    np.testing.assert_allclose(other["transmission_error"], native["transmission_error"], rtol=1e-9)
    np.testing.assert_allclose(other["force"], native["force"], atol=1e-6 * float(native["force"].max()))


@cache
def solved_by(solver: str) -> xr.Dataset:
    return analyze(small("fh-12x41-45", "shell", mesh_positions=2), torques=[300.0], solver=solver)[
        "loaded"
    ].to_dataset()


def test_edges_alone_hold_a_pair_without_a_line() -> None:
    """As with too little overlap: the pair turns farther than on its lines, and the search goes as far as it does."""
    name = "fm-11x41"
    geometry, fields, mesh = prepared(name)
    kept = np.flatnonzero(mesh.position != 2)
    lines = ContactLines(mesh.lines.level[kept], mesh.lines.points[:, kept], mesh.lines.length[kept])
    gap = replace(mesh, lines=lines, position=mesh.position[kept], pair=mesh.pair[kept])
    bare = on_lines_to_edges(name, 20.0, gap, 15)
    solver = CycleSolver(misaligned(name).assembly.ratio)
    held, cases = solver.loaded(segments_of(geometry, fields, gap, 15), np.array([20.0]))
    assert np.isnan(bare).nonzero()[0].tolist() == [2]
    assert np.all(held["status"] == 0)
    turned = 1e-6 * held["transmission_error"].values[0]
    assert turned[2] > 1.5 * np.delete(turned, 2).max()
    (here,) = (case for case in cases if case.mesh_position == 2)
    assert here.segments.separation_angle.max() > turned[2]
    assert float(held["edge_share"][0, 2]) == pytest.approx(1.0)
    np.testing.assert_allclose(np.delete(turned, 2), np.delete(bare, 2), rtol=1e-6)


@pytest.mark.parametrize("name", PAIRS)
def test_lines_end_where_their_closest_approach_meets_an_edge(name: str) -> None:
    """Of the turned flanks: at either end the lowest point across the line lies on the boundary of a flank."""
    _, fields, mesh = prepared(name)
    ended = lines_to_edges(fields, mesh)
    assert ended.pair.size > 0.9 * mesh.pair.size
    rotation = line_rotations(ended)
    for end in (0, -1):
        points = ended.lines.points[:, :, end]
        closest = points + one_step(fields, points).shift
        _, pinion = exact_gap(flanks(name), closest, rotation)
        border = np.min(np.abs([*closest, *(1.0 - closest), *pinion, *(1.0 - pinion)]), axis=0)
        assert np.nanmax(border) < 1e-2


def test_edges_begin_exactly_where_lines_end() -> None:
    """A contact line along the tip edge: no part of it is covered twice, by line and edge, and none is left out.

    On the lines as they are traced some tenths of a millimetre are.
    """
    _, fields, mesh = prepared("nasa-12x36")
    edges = edges_in_mesh(fields, mesh, np.full(mesh.rotations.size, WIDEST), flank_edges(fields))
    way = [fields("position", np.array([[0.5], [0.5]]), d)[:, 0] for d in ((1, 0), (0, 1))]
    worst = []
    for lines in (mesh, lines_to_edges(fields, mesh)):
        missed = []
        for m in range(lines.pair.size):
            own = (edges.position == lines.position[m]) & (edges.pair == lines.pair[m])
            least = edges.elements.overhang[own].min(initial=np.inf)
            if least > 0.1:
                continue
            begin = edges.elements.points[:, own][:, np.argmin(edges.elements.overhang[own])]
            ends = lines.lines.points[:, m][:, [0, -1]]
            ends = ends + one_step(fields, ends).shift
            apart = np.tensordot(np.stack(way), ends - begin[:, None], axes=(0, 0))
            missed.append(np.linalg.norm(apart, axis=0).min())
        worst.append(max(missed))
    assert worst[0] > 0.3
    assert worst[1] < 0.15


def test_distance_from_an_edge_is_that_across_the_line() -> None:
    """A step of that length across the line, from the closest approach, ends on the edge."""
    _, fields, mesh = prepared("fh-12x41-45")
    lines = lines_to_edges(fields, mesh)
    points = lines.lines.points[:, :, ::16].reshape(2, -1)
    rotation = np.repeat(line_rotations(lines), lines.lines.points[0, 0, ::16].size)
    distance = edge_distance(fields, points, rotation)
    near = np.flatnonzero(distance < 0.6)
    assert near.size > 5
    closest = points + one_step(fields, points).shift
    direction = across_line(fields, closest[:, near]).direction
    border = []
    for sense in (-1.0, 1.0):
        reached = closest[:, near] + sense * distance[near] * direction
        _, pinion = exact_gap(flanks("fh-12x41-45"), np.clip(reached, 0.0, 1.0), rotation[near])
        border.append(np.minimum(off_edge(reached), off_edge(pinion)))
    assert np.max(np.min(border, axis=0)) < 6e-3
