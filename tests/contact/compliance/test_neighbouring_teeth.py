"""Teeth that share the body of their member: waves round it, few modes of the flank, and the contact with them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse import csc_array
from toothed_sector import toothed_sector

from easeoff.cases import case_text, case_toml, gear_pair, parse_case, read_case
from easeoff.contact import STEEL, MeshCycle
from easeoff.contact.compliance.elastic_model import PITCHES_PER_PAIR, body_coupling, member_points, solid_shells
from easeoff.contact.compliance.finite_elements.elastic_body import elastic_body
from easeoff.contact.compliance.finite_elements.flank_compliance import (
    FlankCompliance,
    flank_loads,
    flank_shares,
    foot_displacements,
    square_root,
)
from easeoff.contact.compliance.finite_elements.tooth_ring import (
    SURFACE_NODES,
    RingCompliance,
    ToothBody,
    body_modes,
    modes_of,
    nodal_areas,
    pitch_angle,
    ring_compliance,
    ring_size,
    with_body,
)
from easeoff.core.errors import GeometryError, InputError
from easeoff.geometry import GearPair, LatticeSize, ToothLattice, pair_geometry, tooth_lattice
from easeoff.geometry.tooth.tooth_flanks import MemberName, named_member
from easeoff.geometry.tooth.tooth_lattice import Web
from easeoff.geometry.vectors import rotate_z

Array = NDArray[Any]
SMALL = LatticeSize(3, 2, 2, 1, 0, 1, 1)
MEMBERS: tuple[MemberName, MemberName] = ("pinion", "gear")


@cache
def pair_of(name: str, flank: Any = "drive") -> GearPair:
    return gear_pair(read_case(name), flank)


def teeth_of(name: str, member: MemberName) -> int:
    return named_member(pair_of(name), member).teeth


@cache
def pitch_of(name: str, member: MemberName, size: LatticeSize = SMALL, flank: str = "drive") -> ToothLattice:
    return tooth_lattice(pair_of(name, flank), member, size, surface_nodes=SURFACE_NODES)


@cache
def ring_of(name: str, member: MemberName, size: LatticeSize = SMALL) -> RingCompliance:
    pitch = pitch_of(name, member, size)
    held = np.unique(pitch.body[:, :, 0])
    return ring_compliance(pitch, teeth_of(name, member), STEEL, flank_loads(pitch), held)


@pytest.mark.parametrize(("name", "flank"), [("fm-11x41", "drive"), ("fm-11x41", "coast"), ("fh-12x41-45", "drive")])
def test_one_pitch_ends_where_the_next_begins(name: str, flank: str) -> None:
    for member in MEMBERS:
        pitch, teeth = pitch_of(name, member, SMALL, flank), teeth_of(name, member)
        start, end = (pitch.nodes[side].reshape(-1, 3).T for side in pitch.sides)
        angle = pitch_angle(pitch, teeth)
        assert abs(angle) == pytest.approx(2.0 * np.pi / teeth)
        np.testing.assert_allclose(rotate_z(np.full(start.shape[1], angle), start), end, atol=1e-10)


def test_a_lattice_of_more_than_a_pitch_is_refused() -> None:
    wide = pitch_of("fm-11x41", "gear", replace(SMALL, beside=1))
    with pytest.raises(GeometryError, match="one pitch apart"):
        pitch_angle(wide, 41)


@pytest.mark.parametrize("member", [pytest.param("pinion"), pytest.param("gear", marks=pytest.mark.thorough)])
def test_waves_round_the_member_are_all_its_teeth_solved_at_once(member: MemberName) -> None:
    ring, teeth = ring_of("nasa-12x36", member), teeth_of("nasa-12x36", member)
    whole, _ = toothed_sector(pitch_of("nasa-12x36", member), teeth).compliance(STEEL, 0)
    found = ring.shared.copy()
    found[0] += ring.alone
    np.testing.assert_allclose(found, whole, rtol=0, atol=1e-10 * whole.max())


def test_coupling_is_reciprocal_and_takes_no_energy_away() -> None:
    ring = ring_of("fm-11x41", "pinion")
    teeth, size = len(ring.shared), ring.alone.shape[0]
    np.testing.assert_allclose(ring.shared, np.swapaxes(ring.shared[-np.arange(teeth)], 1, 2), rtol=0, atol=1e-16)
    distance = np.arange(teeth)[:, None] - np.arange(teeth)
    whole = np.moveaxis(ring.shared[distance], 1, 2).reshape(teeth * size, -1)
    assert np.linalg.eigvalsh(whole)[0] > -1e-12 * np.abs(whole).max()
    # A load moves the next tooth by less than its own, and that after it by less again.
    pushed = ring.shared[:4].sum(axis=(1, 2))
    assert np.all(np.diff(pushed) < 0.0)
    assert np.all(pushed > 0.0)


def test_a_rigid_body_couples_nothing() -> None:
    pitch = pitch_of("fm-11x41", "gear")
    rigid = ring_compliance(pitch, 41, STEEL, flank_loads(pitch), np.unique(pitch.body))
    assert rigid.alone.max() > 0.0
    assert not rigid.shared.any()


def test_coupling_falls_with_the_depth_of_the_body() -> None:
    def coupled(depth: float) -> float:
        pitch = tooth_lattice(pair_of("fm-11x41"), "gear", SMALL, depth, surface_nodes=SURFACE_NODES)
        held = np.unique(pitch.body[:, :, 0])
        shared = ring_compliance(pitch, 41, STEEL, flank_loads(pitch), held).shared
        return float(shared[1].sum() + shared[-1].sum())

    deep, usual, thin = (coupled(depth) for depth in (16.0, 8.0, 1.0))
    assert deep > 1.5 * usual > 10.0 * thin


def test_modes_of_the_body_give_back_what_they_are_made_of() -> None:
    """With as many modes as nodes nothing is lost; with the usual dozen little of a smooth load."""
    pitch, ring = pitch_of("fm-11x41", "gear"), ring_of("fm-11x41", "gear")
    single = ring.alone + 0.5 * ring.shared[0]
    areas = nodal_areas(pitch)
    full = modes_of(ring, single, areas, areas.size)
    for k in (0, 1, 2, 40):
        found = full["shapes"].T @ full["coupling"][k] @ full["shapes"]
        np.testing.assert_allclose(found, ring.shared[k], rtol=0, atol=1e-10 * ring.shared[0].max())
    own = full["shapes"].T @ full["own"] @ full["shapes"]
    np.testing.assert_allclose(own, 0.5 * ring.shared[0], rtol=0, atol=1e-15)
    few = modes_of(ring, single, areas, 12)
    smooth = np.stack([areas, areas * pitch.profile.ravel()], axis=1)
    for k in (1, 2, 40):
        found = smooth.T @ few["shapes"].T @ few["coupling"][k] @ few["shapes"] @ smooth
        np.testing.assert_allclose(found, smooth.T @ ring.shared[k] @ smooth, rtol=5e-3)


def test_teeth_of_neighbouring_pairs_stand_where_their_contact_is() -> None:
    """Turned to the rotations of their pairs, contact points of pinion and gear meet in space, and only there."""
    pair = pair_of("nasa-12x36")
    cycle = MeshCycle.of(pair_geometry(pair, (15, 11)), mesh_positions=4)
    lines = cycle.lines.at(1)
    assert len(set(lines.pair.tolist())) > 1
    points, pairs = lines.lines.points[:, :, 0], lines.pair
    places = []
    for member, pitches, sense in zip(MEMBERS, PITCHES_PER_PAIR, (-1.0, 1.0), strict=True):
        lattice = tooth_lattice(pair, member, LatticeSize(8, 4, 2, 1, 1, 1, 1), surface_nodes=SURFACE_NODES)
        angle = pitch_angle(pitch_of("nasa-12x36", member), teeth_of("nasa-12x36", member))
        nodes, shares = flank_shares(lattice.lengthwise, lattice.profile, member_points(cycle.fields, member, points))
        here = np.einsum("nk,xnk->xn", shares, lattice.nodes[lattice.flank].reshape(-1, 3).T[:, nodes])
        rolled = sense * lines.rotations[0] / (1.0 if member == "pinion" else pair.assembly.ratio)
        places.append(rotate_z(rolled + pitches * angle * pairs, here))
    on_pinion, _ = pair.assembly.pinion_to_global(places[0], places[0])
    # [mm]: the flanks meet but for a turn of both about their axes; a tooth on the wrong side would be 15 mm away.
    assert np.linalg.norm(on_pinion - places[1], axis=0).max() < 1.0


def loads_of(name: str, torque: float) -> tuple[MeshCycle, list[Any]]:
    """Solved mesh positions with teeth on bodies of their own."""
    geometry = pair_geometry(pair_of(name), (31, 21))
    cycle = MeshCycle.of(geometry, solid_shells(geometry.pair, neighbours=False), mesh_positions=2)
    return cycle, cycle.solved([torque])


@pytest.mark.thorough
@pytest.mark.parametrize(("name", "torque"), [("fm-11x41", 500.0), ("nasa-12x36", 200.0)])
def test_loaded_teeth_turn_as_those_on_one_body_solved_whole(name: str, torque: float) -> None:
    """Under the forces of an analysis, held: all teeth of the pinion, eleven on a sector of the gear."""
    size = LatticeSize(8, 3, 2, 1, 0, 2, 1)
    cycle, cases = loads_of(name, torque)
    turned = np.zeros((3, len(cases)))  # separate, on one body solved whole, and by the modes
    for member, pitches in zip(MEMBERS, PITCHES_PER_PAIR, strict=True):
        alone = tooth_lattice(pair_of(name), member, replace(size, beside=2))
        body = elastic_body(alone.nodes, alone.cells, alone.fixed_nodes, STEEL)
        own = square_root(body.response(flank_loads(alone), foot_displacements(alone)))
        tooth = FlankCompliance(alone.lengthwise, alone.profile, own)
        model = with_body(tooth, *body_modes(pair_of(name), member, STEEL, ring_size()))
        assert model.body is not None
        pitch, teeth = pitch_of(name, member, size), teeth_of(name, member)
        sector = toothed_sector(pitch, teeth, None if member == "pinion" else 11)
        middle = len(sector.angles) // 2
        between, at_feet = sector.compliance(STEEL, middle)
        for number, case in enumerate(cases):
            force, of_pair = case.solution.force, case.segments.pair
            loaded = [pair for pair in np.unique(of_pair) if force[of_pair == pair].sum() > 0.0]
            points = member_points(cycle.fields, member, case.segments.point)
            nodes, shares = flank_shares(alone.lengthwise, alone.profile, points)
            loads = {}
            for pair in loaded:
                here = of_pair == pair
                on_nodes = (shares * force[:, None])[here].ravel()
                loads[pair] = np.bincount(nodes[here].ravel(), on_nodes, minlength=alone.profile.size)
            separate = sum(float(np.sum((own @ load) ** 2)) for load in loads.values())
            whole = sum(float(load @ at_feet @ load) for load in loads.values())
            found = sum(float(np.sum((model.factor @ load) ** 2)) for load in loads.values())
            for one, first in loads.items():
                for other, second in loads.items():
                    away = pitches * int(one - other)
                    if away:
                        whole += float(first @ between[(middle + away) % len(between)] @ second)
                    modes = model.body.coupling[away % teeth]
                    found += float((model.body.shapes @ first) @ modes @ (model.body.shapes @ second))
            turned[:, number] += separate, whole, found
    assert np.all(np.abs(turned[2] - turned[1]) < 4e-3 * turned[0])
    assert np.max(turned[1] / turned[0]) > 1.04


@pytest.mark.thorough
@pytest.mark.parametrize("member", MEMBERS)
def test_a_finer_lattice_of_the_body_changes_the_coupling_little(member: MemberName) -> None:
    pair, loads = pair_of("fm-11x41"), []
    for size in (ring_size(), replace(ring_size(), lengthwise=10, upward=4, through=4, deep=3)):
        lattice, modes = body_modes(pair, member, STEEL, size)
        areas = nodal_areas(lattice)
        smooth = modes["shapes"] @ np.stack([areas, areas * lattice.profile.ravel()], axis=1) / areas.sum()
        loads.append(np.einsum("qa,kqr,rb->kab", smooth, modes["coupling"], smooth))
    for k in (1, 2, -1):
        np.testing.assert_allclose(loads[0][k], loads[1][k], rtol=0.08)


@cache
def coarse_cycle(neighbours: bool) -> MeshCycle:
    geometry = pair_geometry(pair_of("fm-11x41"), (15, 11))
    model = solid_shells(geometry.pair, neighbours=neighbours)
    return MeshCycle.of(geometry, model, mesh_positions=2, segments_per_line=11)


@pytest.mark.thorough
def test_compliance_of_a_mesh_position_holds_the_bodies_of_both_members() -> None:
    """Own blocks as without neighbours but for a smooth part, blocks between pairs those of the bodies."""
    coupled, separate = (coarse_cycle(neighbours).segments for neighbours in (True, False))
    coupling = body_coupling(coupled.on_lines.teeth.both)
    assert coupling is not None
    here, alone = coupled.by_position[1], separate.by_position[1]
    assert here is not None
    assert alone is not None
    numbers = np.unique(here.pair)
    assert numbers.size > 1
    whole, apart = (one.bending.factor @ one.bending.factor.T for one in (here, alone))
    between = here.pair[:, None] != here.pair
    assert not apart[between].any()
    points, weights = coupled.on_lines.quadrature
    row = np.flatnonzero(coupled.on_lines.table["position"] == 1)
    own = points.reshape(2, -1, weights.size)[:, row]
    loads = coupled.on_lines.loads_on((own, own), weights).on_bodies
    bodies = coupling.compliance(numbers)
    place = np.searchsorted(numbers, here.pair)
    wanted = np.einsum("iq,iqjr,jr->ij", loads, bodies[place][:, :, place], loads)
    scale = np.median(apart.diagonal())  # next to free ends it is much greater
    np.testing.assert_allclose(whole[between], wanted[between], rtol=0, atol=1e-3 * scale)
    assert wanted[between].max() > 0.02 * scale
    assert np.linalg.eigvalsh(whole)[0] > -1e-12 * scale


@pytest.mark.thorough
def test_neighbours_give_way_and_every_position_is_certified() -> None:
    torques = [100.0, 400.0]
    coupled, separate = (coarse_cycle(neighbours).loaded(torques)[0] for neighbours in (True, False))
    for found in (coupled, separate):
        assert np.all(found["status"] == 0)
        assert float(found["duality_gap"].max()) < 1e-9
    more = coupled["mean_level"] / separate["mean_level"] - 1.0
    assert np.all((more > 0.01) & (more < 0.08))
    assert more[1] > more[0]


def twist(web: Web) -> tuple[float, float]:
    """Rotation [rad/(N mm)] of the teeth of the gear of fm-11x41 under a torque on all; mean radius of the bore."""
    pitch = tooth_lattice(pair_of("fm-11x41"), "gear", replace(SMALL, deep=2), surface_nodes=SURFACE_NODES, web=web)
    nodes = pitch.flank.ravel()
    x, y, _ = pitch.nodes[nodes].T
    radius = np.hypot(x, y)
    around = np.stack([-y, x, 0.0 * x], axis=1) / radius[:, None]
    torque = np.zeros((3 * len(pitch.nodes), 1))
    torque.reshape(-1, 3)[nodes] = around / radius.sum()
    ring = ring_compliance(pitch, 41, STEEL, csc_array(torque), np.unique(pitch.body[0]))
    bore = np.hypot(*pitch.nodes[pitch.body[0].ravel(), :2].T)
    assert 2.0 * bore.min() == pytest.approx(web.bore_diameter)
    return float(ring.shared.sum() + ring.alone.sum()) / 41.0, 0.5 * float(bore.min() + bore.max())


@pytest.mark.parametrize("thickness", [3.0, 10.0])
def test_a_web_twists_as_a_conical_disc(thickness: float) -> None:
    """Between two bores, under a torque T: T / (4 pi G t sin(cone angle)) times the difference of 1 / r^2."""
    cone = pair_of("fm-11x41").gear.section.root_angle
    (inner, first), (outer, second) = twist(Web(70.0, thickness)), twist(Web(110.0, thickness))
    wanted = (first**-2 - second**-2) / (4.0 * np.pi * STEEL.shear_modulus * thickness * np.sin(cone))
    assert inner - outer == pytest.approx(wanted, rel=0.01)


def test_a_thin_web_couples_all_teeth() -> None:
    """The whole rim leans under a load on one tooth: its opposite goes the other way, and the thinner the farther."""
    size = replace(ring_size(), lengthwise=3)

    def modes(web: Web | None) -> Array:
        found = body_modes(pair_of("fm-11x41"), "gear", STEEL, size, ToothBody(web=web))[1]
        load = found["shapes"].mean(axis=1)
        return np.asarray(np.einsum("q,kqr,r->k", load, found["coupling"], load))

    held, thick, thin = modes(None), modes(Web(80.0)), modes(Web(80.0, 4.0))
    assert 1.0 < 1.5 * thick[1] / held[1] < thin[1] / held[1]
    assert abs(held[20]) < 1e-3 * held[1]
    assert thin[20] < 0.0
    assert abs(thin[20]) > 0.02 * thin[1]


def test_webs_that_lead_nowhere_are_refused() -> None:
    for member, bore in (("gear", 700.0), ("pinion", 7.0)):
        with pytest.raises(InputError, match="bore_diameter"):
            tooth_lattice(pair_of("fm-11x41"), member, SMALL, surface_nodes=SURFACE_NODES, web=Web(bore))
    text = case_text("fm-11x41")
    with pytest.raises(InputError, match=r"gear_web: must go with neighbours = true"):
        parse_case(f"{text}\n[compliance]\nneighbours = false\n[compliance.gear_web]\nbore_diameter = 70\n")
    with pytest.raises(InputError, match=r"neighbours = false: must go with model"):
        parse_case(f'{text}\n[compliance]\nmodel = "shell"\nneighbours = false\n')
    case = parse_case(f"{text}\n[compliance.gear_web]\nbore_diameter = 70\n")
    assert parse_case(case_toml(case)).model_dump() == case.model_dump()
