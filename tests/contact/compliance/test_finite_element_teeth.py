"""Finite elements of generated teeth: lattice, condensed compliance, root stress, cache, and the contact with them."""

from __future__ import annotations

import os
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from runs import small, text_file

import easeoff
from easeoff import GeometryError, InputError
from easeoff.cases import gear_pair, read_case
from easeoff.contact import STEEL, ElasticModel, root_stress
from easeoff.contact.compliance.elastic_model import elastic_teeth, shells
from easeoff.contact.compliance.finite_elements import array_store as store, finite_element_tooth as members
from easeoff.contact.compliance.finite_elements.elastic_body import (
    Substructures,
    brick_gradients,
    elastic_body,
    functionals,
    gauss_rule,
    shape_functions,
)
from easeoff.contact.compliance.finite_elements.flank_compliance import (
    FlankCompliance,
    StressResponse,
    by_station,
    feet_of_normals,
    flank_loads,
    flank_shares,
    foot_displacements,
    spread_shares,
    square_root,
    stress_functionals,
)
from easeoff.contact.compliance.finite_elements.tooth_ring import ToothBody
from easeoff.geometry import GearPair, LatticeSize, ToothLattice, deviation_from_formula, pair_geometry, tooth_lattice
from easeoff.geometry.deviation.deviated_flank import deviated_pair
from easeoff.geometry.flanks.flank import solve_flank
from easeoff.geometry.pair.gear_pair import bodies
from easeoff.geometry.tooth.tooth_lattice import graded
from easeoff.study import CaseInMesh
from easeoff.study.summary.plausibility import plausibility
from easeoff.study.summary.result_summary import result_summary

Array = NDArray[Any]
COARSE = LatticeSize(7, 4, 2, 1, 1, 2)


def pair(name: str = "fm-11x41") -> GearPair:
    return gear_pair(read_case(name))


@cache
def coarse_lattice(name: str, member: str) -> ToothLattice:
    return tooth_lattice(pair(name), member, COARSE)


@cache
def gear_tooth() -> tuple[ToothLattice, Substructures]:
    lattice = coarse_lattice("fm-11x41", "gear")
    return lattice, elastic_body(lattice.nodes, lattice.cells, lattice.fixed_nodes, STEEL)


@cache
def kernel() -> Array:
    """Displacement at the feet (rows) by unit forces on the flank's nodes."""
    lattice, body = gear_tooth()
    return body.response(flank_loads(lattice), foot_displacements(lattice))


@pytest.mark.parametrize("name", ["fm-11x41", "fh-12x41-45"])
@pytest.mark.parametrize("member", ["pinion", "gear"])
@pytest.mark.quick(2)
def test_lattice_fills_the_generated_tooth(name: str, member: str) -> None:
    """Every brick is right way round, of every shipped pair and hand; the loaded side is the generated flank."""
    own = pair(name)
    lattice = coarse_lattice(name, member)
    _, determinant = brick_gradients(lattice.nodes[lattice.cells.reshape(-1, 27)], shape_functions(gauss_rule()[0])[1])
    assert determinant.min() > 0.0
    one = own.pinion if member == "pinion" else own.gear
    on_flank = lattice.profile >= 0.1
    flank = lattice.nodes[lattice.flank][on_flank].T
    true = solve_flank(one.loaded, one.section, flank[2], np.hypot(flank[0], flank[1]))
    np.testing.assert_allclose(flank, true.position, rtol=0, atol=2e-4)
    np.testing.assert_allclose(lattice.flank_normal[on_flank].T, true.normal, rtol=0, atol=2e-4)


def test_feet_are_those_of_the_plate() -> None:
    """Distances from flank to middle surface as ``geometry.tooth`` finds them, by quite another way."""
    own = pair()
    for member, body in zip(("pinion", "gear"), bodies(own), strict=True):
        lattice = coarse_lattice("fm-11x41", member)
        depth = feet_of_normals(lattice).depth.reshape(lattice.flank.shape)
        on_flank = (lattice.profile > 0.1) & (np.abs(lattice.lengthwise - 0.5) < 0.3)[:, None]
        normal = lattice.flank_normal[on_flank].T
        expected = body.shell_coordinates(lattice.nodes[lattice.flank][on_flank].T, normal).depth
        np.testing.assert_allclose(depth[on_flank], expected, rtol=0.02)


def test_graded_places() -> None:
    places = graded(4, 2.0)
    np.testing.assert_allclose(np.diff(places[::2]), np.array([1, 2, 4, 8]) / 15)
    np.testing.assert_allclose(places[1::2], 0.5 * (places[:-2:2] + places[2::2]))


def test_shares_of_a_force_on_the_flank() -> None:
    """They add up to one and put the force where it belongs."""
    lattice, _ = gear_tooth()
    random = np.random.default_rng(3)
    points = random.uniform([[0.0], [0.05]], [[1.0], [1.0]], size=(2, 50))
    nodes, shares = flank_shares(lattice.lengthwise, lattice.profile, points)
    np.testing.assert_allclose(shares.sum(axis=1), 1.0, atol=1e-12)
    along = np.repeat(lattice.lengthwise, lattice.profile.shape[1])
    np.testing.assert_allclose(np.sum(shares * along[nodes], axis=1), points[0], atol=1e-12)
    np.testing.assert_allclose(np.sum(shares * lattice.profile.ravel()[nodes], axis=1), points[1], atol=1e-9)


def test_kernel_is_nearly_symmetric_and_its_root_is_a_compliance() -> None:
    """Reciprocity holds but for the last millimetres around a load; taking the symmetric part changes little."""
    compliance = kernel()
    symmetric = 0.5 * (compliance + compliance.T)
    assert np.linalg.norm(compliance - symmetric) < 0.06 * np.linalg.norm(compliance)
    factor = square_root(compliance)
    # What the roots of the negative eigenvalues leave out.
    assert np.linalg.norm(factor.T @ factor - symmetric) < 0.005 * np.linalg.norm(symmetric)


def test_segments_whitened_give_the_compliance_of_their_loads() -> None:
    """Inner products of whitened segments are the kernel between the same loads, solved directly."""
    lattice, _ = gear_tooth()
    condensed = FlankCompliance(lattice.lengthwise, lattice.profile, square_root(kernel()))
    ends = np.linspace(0.2, 0.8, 7)
    gauss, weights = np.polynomial.legendre.leggauss(3)
    t = ends[:-1, None] + 0.5 * np.diff(ends)[:, None] * (1.0 + gauss)
    points = np.stack([t, 0.8 - 0.5 * t])
    whitened = condensed.whitened(points, 0.5 * weights)
    shares = np.zeros((lattice.profile.size, 6))
    for segment in range(6):
        nodes, share = flank_shares(lattice.lengthwise, lattice.profile, points[:, segment])
        np.add.at(shares[:, segment], nodes.ravel(), (share * 0.5 * weights[:, None]).ravel())
    direct = shares.T @ kernel() @ shares
    np.testing.assert_allclose(whitened.T @ whitened, direct, rtol=0, atol=0.02 * direct.max())


def test_a_force_far_from_the_foot_does_not_mind_where_it_acts_on_its_line() -> None:
    """Saint-Venant: on the flank or at the foot of its normal, a force moves distant points alike."""
    lattice, body = gear_tooth()
    feet = feet_of_normals(lattice)
    count = lattice.profile.shape[1]
    chosen = np.array([2 * count + count - 4])
    at_foot = functionals(
        len(lattice.nodes), feet.nodes[chosen], feet.shares[chosen], -lattice.flank_normal.reshape(-1, 3)[chosen]
    )
    there = foot_displacements(lattice)
    from_foot = body.response(at_foot, there)[:, 0].reshape(lattice.profile.shape)
    from_flank = kernel()[:, chosen[0]].reshape(lattice.profile.shape)
    far = np.abs(lattice.lengthwise - lattice.lengthwise[2]) > 0.3
    np.testing.assert_allclose(from_foot[far], from_flank[far], rtol=0, atol=0.01 * from_flank[:, -1].max())


def test_stress_functionals_return_a_uniform_stress() -> None:
    lattice, _ = gear_tooth()
    wanted, _ = stress_functionals(lattice, STEEL)
    strain = 1e-3 * np.array([[1.0, 0.2, -0.3], [0.2, -0.5, 0.4], [-0.3, 0.4, 0.7]])
    found = (wanted.T @ (lattice.nodes @ strain).ravel()).reshape(-1, 6)
    first = 2.0 * STEEL.shear_modulus * STEEL.poisson_ratio / (1.0 - 2.0 * STEEL.poisson_ratio)
    stress = first * np.trace(strain) * np.eye(3) + 2.0 * STEEL.shear_modulus * strain
    expected = stress[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]]
    np.testing.assert_allclose(
        found, np.broadcast_to(expected, found.shape), rtol=0, atol=1e-9 * np.abs(expected).max()
    )


def test_largest_tensile_stress_is_a_principal_stress() -> None:
    sigma = np.zeros((1, 1, 6, 2))
    sigma[0, 0, :, 0] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0]  # plane: 1/2 + sqrt(1/4 + 1)
    sigma[0, 0, :, 1] = [-3.0, -2.0, -1.0, 0.0, 0.0, 0.0]
    np.testing.assert_allclose(StressResponse(np.zeros(1), sigma).largest(np.eye(2)), [[0.5 + np.sqrt(1.25), -1.0]])


def test_root_stress_does_not_tell_where_a_brick_begins() -> None:
    """A force low on the flank moves along the face by a brick: its stress in the root moves with it."""
    lattice, body = gear_tooth()
    wanted, station = stress_functionals(lattice, STEEL)
    root = by_station(body.response(flank_loads(lattice), wanted), station)
    along = np.linspace(lattice.lengthwise[8], lattice.lengthwise[10], 9)
    swing = []
    for shares_of in (flank_shares, spread_shares):
        nodes, shares = shares_of(lattice.lengthwise, lattice.profile, np.stack([along, np.full(9, 0.1)]))
        forces = np.zeros((lattice.profile.size, 9))
        np.add.at(forces, (nodes, np.arange(9)[:, None]), 1000.0 * shares)
        np.testing.assert_allclose(forces.sum(axis=0), 1000.0)
        stress = root.largest(forces).max(axis=0)
        swing.append(np.ptp(stress) / stress.mean())
        assert shares_of(lattice.lengthwise, lattice.profile, np.empty((2, 0)))[0].shape == (0, nodes.shape[1])
    assert swing[0] > 0.2
    assert swing[1] < 0.25 * swing[0]


def test_root_stress_balances_the_bending_moment() -> None:
    """Tension at the root of the loaded side, the greater the higher the force acts; near it along the face."""
    lattice, body = gear_tooth()
    wanted, station = stress_functionals(lattice, STEEL)
    root = by_station(body.response(flank_loads(lattice), wanted), station)
    forces = np.zeros((*lattice.profile.shape, 3))
    middle = lattice.profile.shape[0] // 2
    for column, row in enumerate((-5, -3, -1)):
        forces[middle, row, column] = 1000.0
    stress = root.largest(forces.reshape(-1, 3))
    assert np.all(np.diff(stress.max(axis=0)) > 0.0)
    assert abs(root.lengthwise[stress[:, 2].argmax()] - 0.5) < 0.15


@pytest.mark.thorough
def test_compliance_settles_as_the_bricks_get_smaller() -> None:
    """Differences to the finest of three lattices shrink at least with the first power of the bricks' size."""
    gauss, weights = np.polynomial.legendre.leggauss(3)
    t, h = np.meshgrid(np.linspace(0.15, 0.85, 5), [0.4, 0.8], indexing="ij")
    points = np.stack([t.ravel()[:, None] + 0.03 * gauss, h.ravel()[:, None] + 0.0 * gauss])
    found = []
    for size in (LatticeSize(4, 2, 2, 1, 1, 1), LatticeSize(8, 4, 2, 1, 1, 2), LatticeSize(11, 5, 3, 1, 1, 2)):
        lattice = tooth_lattice(pair(), "gear", size)
        body = elastic_body(lattice.nodes, lattice.cells, lattice.fixed_nodes, STEEL)
        factor = square_root(body.response(flank_loads(lattice), foot_displacements(lattice)))
        whitened = FlankCompliance(lattice.lengthwise, lattice.profile, factor).whitened(points, 0.5 * weights)
        found.append(whitened.T @ whitened)
    coarse, middle = (np.linalg.norm(c - found[2]) / np.linalg.norm(found[2]) for c in found[:2])
    assert middle < 0.5 * coarse
    assert middle < 0.06


def test_second_analysis_does_not_factor_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(store.FOLDER_VARIABLE, str(tmp_path))
    first = members.finite_element_tooth(pair(), "gear", STEEL, fineness=0.25)
    assert len(list(tmp_path.iterdir())) == 2  # the tooth, and the body it shares with the others

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("factored again")

    monkeypatch.setattr(members, "elastic_body", refuse)
    monkeypatch.setattr(members, "body_modes", refuse)
    again = members.finite_element_tooth(pair(), "gear", STEEL, fineness=0.25)
    np.testing.assert_array_equal(first.flank.factor, again.flank.factor)
    assert first.root is not None
    assert again.root is not None
    np.testing.assert_array_equal(first.root.stress, again.root.stress)
    others: tuple[dict[str, Any], ...] = ({"fineness": 0.3}, {"fineness": 0.25, "body": ToothBody(rim_depth=5.0)})
    for other in others:
        with pytest.raises(AssertionError, match="factored again"):
            members.finite_element_tooth(pair(), "gear", STEEL, **other)
    with pytest.raises(AssertionError, match="factored again"):
        members.finite_element_tooth(pair(), "gear", replace(STEEL, poisson_ratio=0.25), fineness=0.25)
    # Misalignment moves the pair, not the tooth.
    moved = pair().misaligned(replace(pair().assembly.misalignment, offset=0.1))
    members.finite_element_tooth(moved, "gear", STEEL, fineness=0.25)


def test_store_survives_damage_and_a_folder_that_cannot_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls = []

    shapes: store.Shapes = {"a": (3,)}

    def make() -> dict[str, Array]:
        calls.append(1)
        return {"a": np.arange(3.0)}

    monkeypatch.setenv(store.FOLDER_VARIABLE, str(tmp_path))
    key = store.key_of(np.arange(4), "x", 1.0)
    assert key == store.key_of(np.arange(4), "x", 1.0) != store.key_of(np.arange(4.0), "x", 1.0)
    for _ in range(2):
        np.testing.assert_array_equal(store.kept(key, shapes, make)["a"], np.arange(3.0))
    assert len(calls) == 1
    file, whole = tmp_path / f"{key}.npz", {"a": np.arange(3.0), store.KEY_NAME: np.array(key)}

    def damage(arrays: dict[str, Any]) -> bytes:
        np.savez(tmp_path / "other.npz", **arrays)
        return (tmp_path / "other.npz").read_bytes()

    content = damage(whole)
    assert b"\x00\x40" in content
    damaged = {
        "cut off": b"PK\x03\x04 cut off",
        "one bit": content.replace(b"\x00\x40", b"\x00\x41", 1),
        "empty": b"",
        "without its array": damage({store.KEY_NAME: np.array(key)}),
        "of another pair": damage(whole | {store.KEY_NAME: np.array(store.key_of("another"))}),
        "without a key": damage({"a": np.arange(3.0)}),
        "another shape": damage(whole | {"a": np.arange(4.0)}),
        "another kind": damage(whole | {"a": np.arange(3)}),
        "not finite": damage(whole | {"a": np.array([0.0, np.nan, 2.0])}),
        "one more": damage(whole | {"b": np.arange(3.0)}),
    }
    for number, (what, content) in enumerate(damaged.items(), start=2):
        file.write_bytes(content)
        np.testing.assert_array_equal(store.kept(key, shapes, make)["a"], np.arange(3.0), err_msg=what)
        assert len(calls) == number, what
    made = len(calls)
    store.kept(key, shapes, make)
    assert len(calls) == made
    monkeypatch.setenv(store.FOLDER_VARIABLE, "")
    store.kept(key, shapes, make)
    assert len(calls) == made + 1
    blocked = text_file(tmp_path / "file", "")
    monkeypatch.setenv(store.FOLDER_VARIABLE, str(blocked))
    with pytest.warns(UserWarning, match="not kept"):
        assert store.kept(key, shapes, make)["a"].size == 3


def test_damaged_file_of_another_user_is_replaced_where_it_can_be_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One that may not be written to, in a folder that may."""
    monkeypatch.setenv(store.FOLDER_VARIABLE, str(tmp_path))
    key, access = store.key_of("tooth"), os.access
    file = tmp_path / f"{key}.npz"
    file.write_bytes(b"damaged")
    monkeypatch.setattr(
        os,
        "access",
        lambda path, mode: access(path, mode) and not (path == file and file.exists() and file.stat().st_size < 9),
    )
    assert store.kept(key, {"a": (3,)}, lambda: {"a": np.arange(3.0)})["a"].size == 3
    assert store.kept(key, {"a": (3,)}, dict)["a"].size == 3


def test_keys_go_by_values() -> None:
    """Of dataclasses with arrays inside, too; and no two parts run into each other."""
    pinion = pair().pinion
    assert store.key_of(pinion) == store.key_of(replace(pinion))
    moved = replace(pinion, section=replace(pinion.section, face_width=pinion.section.face_width * (1.0 + 1e-15)))
    assert store.key_of(pinion) != store.key_of(moved)
    deviation = deviation_from_formula(pair().gear.section, lambda t, h: 1e-3 * t * h)
    bent = [deviated_pair(pair(), gear=replace(deviation, value=k * deviation.value)).gear for k in (1.0, 1.0 + 1e-12)]
    assert len({store.key_of(bent[0]), store.key_of(bent[1]), store.key_of(pair().gear)}) == 3
    assert store.key_of("ab", "c") != store.key_of("a", "bc") != store.key_of(("a", "b"), "c")
    assert store.key_of(1, None) != store.key_of(1.0, None)
    with pytest.raises(TypeError, match="no key"):
        store.key_of(object())


def test_another_code_finds_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    before = store.key_of("tooth")
    monkeypatch.setattr(store, "code_digest", lambda: "another release")
    assert store.key_of("tooth") != before


def test_store_lets_go_of_what_was_not_asked_for_the_longest(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(store.FOLDER_VARIABLE, str(tmp_path))
    keys = [store.key_of(number) for number in range(4)]

    def ask(number: int, time: float) -> None:
        store.kept(keys[number], {"a": (None,)}, lambda: {"a": np.zeros(1000)})
        os.utime(tmp_path / f"{keys[number]}.npz", (time, time))

    for time, number in enumerate((0, 1, 2), start=1):
        ask(number, time)
    (tmp_path / "note.npz").write_bytes(b"not ours")
    monkeypatch.setattr(store, "FOLDER_SIZE_LIMIT", 3.5 * (tmp_path / f"{keys[0]}.npz").stat().st_size)
    ask(0, 4.0)
    ask(3, 5.0)
    kept = {path.stem for path in tmp_path.iterdir()}
    assert kept == {keys[0], keys[2], keys[3], "note"}


def test_a_tooth_that_cannot_be_filled_is_refused_and_the_shell_remains() -> None:
    """A tooth so thin that its flanks meet below the tip."""
    own = pair()
    thin = replace(own, gear=replace(own.gear, mean_thickness=2.5))
    with pytest.raises(GeometryError, match=r"pointed.*shell"):
        tooth_lattice(thin, "gear", COARSE)
    teeth = pair_geometry(thin, (11, 9)).teeth
    assert len(shells(teeth, ElasticModel())) == 2


def test_numbers_out_of_range_are_refused() -> None:
    with pytest.raises(InputError, match="rim_depth"):
        tooth_lattice(pair(), "gear", COARSE, rim_depth=-1.0)
    with pytest.raises(InputError, match="fineness"):
        members.finite_element_tooth(pair(), "gear", STEEL, fineness=9.0)
    with pytest.raises(InputError, match="must be a whole number of 1 or more"):
        LatticeSize(0)


@cache
def quick_analysis(name: str) -> xr.DataTree:
    return easeoff.analyze(small(name, "fe"), torques=[300.0])


def test_one_word_of_the_case_file_is_enough() -> None:
    """Certified contact near that of the shell, with root stresses beside it."""
    tree = quick_analysis("fm-11x41")
    loaded = tree["loaded"].to_dataset()
    assert np.all(loaded["status"] == 0)
    shell = easeoff.analyze(small("fm-11x41", "shell"), torques=[300.0])["loaded"].to_dataset()
    assert loaded["mean_level"].item() == pytest.approx(shell["mean_level"].item(), rel=0.1)
    assert not np.allclose(loaded["mean_level"], shell["mean_level"], rtol=1e-6)
    stress = tree["root_stress"].to_dataset()
    assert np.all(np.isfinite(stress["root_stress"]))
    assert np.all(stress["max_root_stress"] > 0.0)
    # The largest over cycle and face either way; along the face it is put on even fractions, which cut its top off.
    history = stress["root_stress_history"].max(["mesh_position", "pair"])
    np.testing.assert_array_equal(stress["max_root_stress"], history)
    np.testing.assert_allclose(stress["root_stress"].max("lengthwise"), history, rtol=0.05)
    shown = [line.split() for line in result_summary(tree).splitlines()]
    for member, value in zip(stress["member"].values, stress["max_root_stress"].values[0], strict=True):
        assert ["greatest", "root", "stress,", str(member), "[MPa]", f"{value:.0f}"] in shown
    (note,) = plausibility(tree)
    assert stress["max_root_stress"].attrs["comment"].partition("; ")[2] in note


def test_a_blade_without_edge_radius_has_no_root_stress() -> None:
    """The contact is analysed; the function refuses, and the result says why it has no such group."""
    tree = quick_analysis("nasa-12x36")
    assert np.all(tree["loaded/status"] == 0)
    assert "root_stress" not in tree.children
    for words in ("pinion's concave flank", "gear's convex flank", "tool_edge_radius = 0", "give the edge radius"):
        assert words in tree.attrs["root_stress_left_out"]
    (note,) = [note for note in plausibility(tree) if "root stress" in note]
    assert note in " ".join(result_summary(tree).split())
    state = CaseInMesh.of(small("nasa-12x36", "fe"))
    assert state.teeth is not None
    loaded, cases = state.cycle.loaded([100.0])
    with pytest.raises(InputError, match=r"tool_edge_radius = 0 of the pinion's concave flank: must be above 0 mm"):
        root_stress(state.cycle.fields, state.teeth, cases, loaded)


def test_condensed_teeth_stand_in_for_the_shells() -> None:
    lattice, _ = gear_tooth()
    condensed = FlankCompliance(lattice.lengthwise, lattice.profile, square_root(kernel()))
    model = ElasticModel(condensed=(condensed, condensed))
    teeth = pair_geometry(pair(), (11, 9)).teeth
    assert elastic_teeth(teeth, model) == (condensed, condensed)
