"""The solid shell: a tooth of polynomials on a body of bricks, alone, against bricks, and against finite elements."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from places import DATA
from runs import small
from tooth_models import COARSE, with_teeth

import easeoff
from easeoff import GeometryError, InputError
from easeoff.cases import case_toml, gear_pair, parse_case, read_case
from easeoff.cases.conversion import finite_elements
from easeoff.contact import STEEL, root_stress
from easeoff.contact.compliance.finite_elements import array_store as store, finite_element_tooth as members
from easeoff.contact.compliance.finite_elements.elastic_body import elastic_body, functionals, stiffness
from easeoff.contact.compliance.finite_elements.finite_element_tooth import (
    body_stiffness,
    solid_shell,
    tooth_shape,
    tooth_stiffness,
)
from easeoff.contact.compliance.finite_elements.flank_compliance import (
    FlankCompliance,
    flank_loads,
    foot_displacements,
    square_root,
)
from easeoff.contact.compliance.finite_elements.tooth_ring import ToothBody
from easeoff.contact.compliance.shell import legendre
from easeoff.geometry import LatticeSize, Misalignment, ToothLattice, tooth_lattice
from easeoff.study import CaseInMesh, WearLaw, wear

Array = NDArray[Any]
REFERENCE = DATA / "finite_element_teeth.npz"
TEETH = [(name, member) for name in ("fm-11x41", "fh-12x41-45") for member in ("gear", "pinion")]
FORCE = 500.0


def even(count: int, low: float = 0.0, high: float = 1.0) -> Array:
    return np.linspace(low, high, 2 * count + 1)


def block_tooth(length: float, across: tuple[Array, Array, Array], deep: Array, up: Array, bricks: int) -> ToothLattice:
    """A straight tooth of rectangular section on a straight body, held at the bottom and both sides.

    ``across``: places left of the tooth, through it, and right of it; ``deep`` from the bottom to the root, at zero.
    """
    left, through, right = across
    x = np.concatenate([left[:-1], through, right[1:]])
    z = np.concatenate([deep[:-1], up])
    y = even(bricks, 0.0, length)
    points = np.stack(np.meshgrid(y, x, z, indexing="ij"), axis=-1)
    number = np.arange(points[..., 0].size).reshape(points.shape[:3])
    root = deep.size - 1
    tooth = slice(left.size - 1, left.size - 1 + through.size)

    def cells(part: NDArray[np.int64]) -> NDArray[np.int64]:
        windows = np.lib.stride_tricks.sliding_window_view(part, (3, 3, 3))[::2, ::2, ::2]
        return np.array(windows.reshape(-1, 3, 3, 3))

    body = cells(number[:, :, : root + 1])
    held = np.unique(np.concatenate([number[:, :, 0].ravel(), number[:, [0, -1], : root + 1].ravel()]))
    sides = np.zeros((y.size, up.size, 3))
    sides[..., 1] = -1.0
    places = ((p - p[0]) / (p[-1] - p[0]) for p in (y, through, up))
    lengthwise, in_thickness, upward = places
    return ToothLattice(
        points.reshape(-1, 3),
        np.concatenate([body, cells(number[:, tooth, root:])]),
        number[:, tooth],
        root,
        held,
        sides,
        lengthwise,
        np.broadcast_to(upward, (y.size, up.size)),
        np.zeros((2, y.size, 1), dtype=np.int64),
        in_thickness,
        upward,
        len(body),
    )


SMALL = block_tooth(3.0, (even(1, -2.0, 0.0), even(1), even(1, 1.0, 3.0)), even(2, -2.0, 0.0), even(1, 0.0, 2.0), 1)


def test_polynomials_of_a_brick_have_its_stiffness() -> None:
    """Parabolas in all directions span the functions of one quadratic brick."""
    axes = [np.linspace(0.0, size, 3) for size in (3.0, 1.0, 2.0)]
    shear = np.array([[1.0, 0.3, 0.0], [0.0, 1.0, 0.2], [0.1, 0.0, 1.0]])
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1) @ shear
    brick = stiffness(nodes.reshape(-1, 3), np.arange(27).reshape(1, 3, 3, 3), STEEL).toarray()
    place = even(1)
    found = tooth_stiffness(tooth_shape(nodes, (place, place, place)), (3, 3, 3), STEEL)
    values = legendre(place, 3)[0]
    functions = np.kron(np.einsum("ia,jb,kc->ijkabc", values, values, values).reshape(27, 27), np.eye(3))
    expected = functions.T @ brick @ functions
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_one_brick_of_polynomials_on_the_body_is_the_finite_element_tooth() -> None:
    """With the same functions in the tooth the whole is the same: the joint adds nothing and loses nothing."""
    shell = solid_shell(SMALL, STEEL, (3, 3, 3))
    body = elastic_body(SMALL.nodes, SMALL.cells, SMALL.fixed_nodes, STEEL)
    loads = flank_loads(SMALL)
    expected = body.response(loads, loads)
    np.testing.assert_allclose(shell.response(loads, loads), expected, rtol=0, atol=1e-9 * expected.max())


def test_every_function_adds_compliance() -> None:
    """Whatever the load: a Ritz system is too stiff, and less so with every function."""
    lattice = tooth_lattice(gear_pair(read_case("fm-11x41")), "pinion", LatticeSize(7, 4, 2, 1, 1, 2, 1))
    loads = flank_loads(lattice)
    work = [
        np.diag(solid_shell(lattice, STEEL, counts).response(loads, loads))
        for counts in ((4, 2, 2), (7, 2, 3), (7, 3, 4), (10, 4, 6))
    ]
    for fewer, more in pairwise(work):
        assert np.all(more > fewer * (1.0 - 1e-9))


def test_body_turns_under_a_moment_as_a_half_plane_does() -> None:
    """A deep and wide body under a long face, linear stress at the root.

    Work of the stress 12 M s / t^3 on the deflections -2 (1 - nu^2) / (pi E) int p ln|x - s| of a half plane: a turn of
    18 / pi times M (1 - nu^2) / (E t^2). A rigid root turns by 16 / pi; Weber's 5.2 and O'Donnell's 5.3 lie between.
    """
    length, deep, wide = 40.0, 12.0, 12.0
    fine = np.concatenate([even(1, 0.0, 0.25), even(1, 0.25, 0.75)[1:], even(1, 0.75, 1.0)[1:]])
    grading = np.array([0.25, 1.0, 3.0, wide])
    beside = np.sort(
        np.concatenate([[0.0], grading, 0.5 * np.diff(np.concatenate([[0.0], grading])) + [0, 0.25, 1, 3]])
    )
    lattice = block_tooth(length, (-beside[::-1], fine, 1.0 + beside), -beside[::-1] * deep / wide, even(1), 6)
    joint = lattice.column[:, :, lattice.root_row].ravel()
    through = legendre(lattice.through, 6)[0]
    functions = np.tile(through, (lattice.lengthwise.size, 1))
    body = body_stiffness(lattice, joint, functions, STEEL)
    np.testing.assert_allclose(body, body.T)
    assert np.linalg.eigvalsh(body).min() > 0.0
    # Unit moment per length as a linear stress 6 / t^2, which does work on the linear polynomial alone.
    moment = np.zeros(body.shape[0])
    moment[3 * 1 + 2] = 6.0 * length / 3.0
    turn = moment @ np.linalg.solve(body, moment) / length * STEEL.plane_strain_modulus
    assert turn == pytest.approx(18.0 / np.pi, rel=0.02)


def test_a_tooth_turned_inside_out_is_refused() -> None:
    nodes = SMALL.nodes.copy()
    tip = SMALL.column[:, :, -1]
    nodes[tip[:, ::-1]] = SMALL.nodes[tip]
    with pytest.raises(GeometryError, match="inside out"):
        tooth_stiffness(
            tooth_shape(nodes[SMALL.column[:, :, SMALL.root_row :]], (SMALL.lengthwise, SMALL.through, SMALL.upward)),
            (3, 3, 3),
            STEEL,
        )


@pytest.mark.parametrize(("name", "member"), TEETH)
@pytest.mark.quick(1)
def test_solid_shell_against_finite_elements(name: str, member: str) -> None:
    """Free edge within 3 %, matrix and uniform load within 5 % of the finest lattices of benchmarks/finite_elements.py.

    Nothing was fitted to these teeth: by the test above, every function more brings it nearer.
    """
    pair = gear_pair(read_case(name))
    with np.load(REFERENCE) as stored:
        expected = {key: stored[f"{name} {member} {key}"] for key in ("matrix", "edge", "patches", "middle")}
        weights = stored["weights"]
    size, counts = members.solid_shell_size(pair, "pinion" if member == "pinion" else "gear")
    lattice = tooth_lattice(pair, member, size)
    shell = solid_shell(lattice, STEEL, counts)
    loads = flank_loads(lattice)
    factor = square_root(shell.response(loads, foot_displacements(lattice, in_tooth=True)))
    flank = FlankCompliance(lattice.lengthwise, lattice.profile, factor)
    on_patches = flank.whitened(expected["patches"], weights)
    matrix = on_patches.T @ on_patches
    assert np.linalg.norm(matrix - expected["matrix"]) < 0.05 * np.linalg.norm(expected["matrix"])
    assert matrix.sum() == pytest.approx(expected["matrix"].sum(), rel=0.05)

    # Deflection of the middle of the tip by a force in the middle of the flank, across the tooth.
    middle = lattice.column[:, lattice.column.shape[1] // 2]
    points = lattice.nodes[middle]
    normal = np.cross(np.gradient(points[:, -1], axis=0), points[:, -1] - points[:, -3])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    normal *= -np.sign(np.sum(normal * lattice.flank_normal[:, -1], axis=1))[:, None]
    wanted = functionals(len(lattice.nodes), middle[:, -1:], np.ones((len(normal), 1)), normal)
    unit = FlankCompliance(lattice.lengthwise, lattice.profile, np.eye(lattice.profile.size))
    edge = shell.response(loads, wanted) @ unit.whitened(expected["middle"], weights)
    assert FORCE * edge.max() == pytest.approx(float(expected["edge"]), rel=0.03)


def test_one_word_of_the_case_file_is_enough() -> None:
    """Certified contact near that of the shell, without root stress."""
    levels = []
    for model in ("shell", "solid_shell"):
        tree = easeoff.analyze(small("fm-11x41", model), torques=[300.0])
        assert "root_stress" not in tree.children
        loaded = tree["loaded"].to_dataset()
        assert np.all(loaded["status"] == 0)
        levels.append(float(loaded["mean_level"].item()))
    assert levels[1] == pytest.approx(levels[0], rel=0.1)
    assert levels[1] != pytest.approx(levels[0], rel=1e-6)


@pytest.mark.thorough
def test_kept_on_disk_and_each_member_with_its_own_depth(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(store.FOLDER_VARIABLE, str(tmp_path))
    pair = gear_pair(read_case("fm-11x41"))

    def factors(*depth: float) -> list[Array]:
        teeth = finite_elements(
            with_teeth(read_case("fm-11x41"), "solid_shell", rim_depth=depth, neighbours=False), pair
        )
        assert teeth is not None
        return [tooth.flank.factor for tooth in teeth]

    thin_pinion, thin_gear = factors(3.0, 10.0), factors(10.0, 3.0)
    assert len(list(tmp_path.iterdir())) == 4
    # The thinner a body, the stiffer its tooth under a load all over the flank.
    work = [[np.sum(factor.sum(axis=1) ** 2) for factor in teeth] for teeth in (thin_pinion, thin_gear)]
    assert work[0][0] < 0.9 * work[1][0]
    assert work[1][1] < 0.9 * work[0][1]
    monkeypatch.setattr(members, "solid_shell", None)
    for kept, made in zip(factors(3.0, 10.0), thin_pinion, strict=True):
        np.testing.assert_array_equal(kept, made)


def test_rim_depth_of_both_members_or_of_each() -> None:
    text = case_toml(read_case("fm-11x41"))

    def depth(value: str) -> Any:
        return parse_case(text + f"\n[compliance]\nrim_depth = {value}\n").compliance.rim_depth

    assert depth("8") == (8.0, 8.0)
    assert depth("[8, 12.5]") == (8.0, 12.5)
    for wrong in ("[8]", "-1.0", "[8.0, 1e4]", '"deep"'):
        with pytest.raises(InputError, match="rim_depth"):
            depth(wrong)


def test_a_solid_shell_too_large_for_a_full_matrix_is_refused() -> None:
    with pytest.raises(InputError, match=r"fineness = 4\.0.*unknowns"):
        members.solid_shell_tooth(gear_pair(read_case("fm-11x41")), "pinion", STEEL, fineness=4.0)


def test_root_stress_wants_finite_elements() -> None:
    state = CaseInMesh.of(small("fm-11x41", "solid_shell"))
    assert state.teeth is not None
    loaded, cases = state.cycle.loaded([200.0])
    with pytest.raises(InputError, match='model = "fe"'):
        root_stress(state.cycle.fields, state.teeth, cases, loaded)


@pytest.mark.parametrize(("model", "teeth"), [("solid_shell", "solid shell"), ("shell", None)])
def test_every_stage_is_named_before_it_begins(model: Any, teeth: str | None) -> None:
    case = small("fm-11x41", model)
    said: list[str] = []
    easeoff.analyze(case, torques=[100.0], stage=said.append, progress=lambda: said.append("step"))
    named = [] if teeth is None else [f"{teeth} of the pinion", f"{teeth} of the gear"]
    assert said[: len(named) + 1] == [*named, "loaded contact"]
    assert said.count("step") == len(said) - len(named) - 1 == case.contact.mesh_positions
    for study, last in ((easeoff.modify, "convex programmes"), (wear, "wear")):
        said.clear()
        options: dict[str, Any] = {"stage": said.append}
        if study is wear:
            wear(case, WearLaw(1e-12, 1e-12, revolutions=1e4), torque=100.0, **options)
        else:
            easeoff.modify(case, torques=[100.0], order=2, programmes=1, **options)
        assert said == [*named, last]


def test_a_stored_tooth_is_found_without_its_lattice(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In any assembly; but not that of another blade, thickness, material, size or depth."""
    monkeypatch.setenv(store.FOLDER_VARIABLE, str(tmp_path))
    pair = gear_pair(read_case("fm-11x41"))
    made = members.solid_shell_tooth(pair, "gear", STEEL, fineness=COARSE).flank

    def refused(*_: object, **__: object) -> None:
        raise AssertionError("made again")

    monkeypatch.setattr(members, "tooth_lattice", refused)
    again = members.solid_shell_tooth(pair.misaligned(Misalignment(offset=0.2)), "gear", STEEL, fineness=COARSE).flank
    for name in ("lengthwise", "profile", "factor"):
        np.testing.assert_array_equal(getattr(again, name), getattr(made, name))
    # The pinion fills the slot that this gear leaves, so that it is another tooth; the gear does not know the pinion.
    thinner = replace(pair, gear=replace(pair.gear, mean_thickness=5.0))
    blade = replace(pair.gear.loaded, blade=replace(pair.gear.loaded.blade, point_radius=94.0))
    others: list[tuple[Any, dict[str, Any]]] = [
        (thinner, {}),
        (replace(pair, gear=replace(pair.gear, loaded=blade)), {}),
        (pair, {"fineness": 0.5}),
        (pair, {"body": ToothBody(rim_depth=9.0)}),
    ]
    for other, changed in others:
        with pytest.raises(AssertionError, match="made again"):
            members.solid_shell_tooth(other, "gear", STEEL, **{"fineness": COARSE, **changed})
    with pytest.raises(AssertionError, match="made again"):
        members.solid_shell_tooth(pair, "gear", replace(STEEL, poisson_ratio=0.29), fineness=COARSE)
    same = replace(pair, pinion=replace(pair.pinion, mean_thickness=8.0))
    np.testing.assert_array_equal(
        members.solid_shell_tooth(same, "gear", STEEL, fineness=COARSE).flank.factor, made.factor
    )
