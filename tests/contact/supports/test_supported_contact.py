"""Loaded contact on supports: closed forms, identities, energy, balance, and rounds with the assembly found."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from solver_choice import LIFTING
from supported_pairs import FIRST_ORDER, POSITIONS, TORQUES, cycle, found, supports
from tooth_models import coarse_solid_shells

from easeoff.cases import gear_pair, read_case
from easeoff.contact import MeshCycle, available_solvers, solve
from easeoff.contact.line_contact.line_contact_solution import solve_on_bending
from easeoff.contact.mesh_wrench import MeshWrenches, SupportModes
from easeoff.contact.supports.assembly_rounds import AssemblyRounds, RoundsStatus, Update
from easeoff.contact.supports.support import (
    ORIGIN,
    BearingReaction,
    MemberAxis,
    Support,
    Supports,
    member_axes,
    shift_matrix,
    shifted_wrench,
)
from easeoff.contact.supports.supported_contact import PARTS, RelativeMotion, SupportedContact
from easeoff.geometry import FlankName, Misalignment, pair_geometry

Array = NDArray[np.float64]
TO_THE_END: dict[Update, AssemblyRounds] = {
    "none": FIRST_ORDER,
    "mean": AssemblyRounds(limit=1e-6),
    "position": AssemblyRounds(update="position", limit=1e-8),
}
CASES: list[tuple[str, FlankName]] = [
    ("fm-11x41", "drive"),
    ("fm-11x41", "coast"),
    ("nasa-12x36", "drive"),
    ("nasa-12x36", "coast"),
]


@cache
def on_shared_bodies() -> MeshCycle:
    """With solid shells, whose bodies move under the load of all teeth as supports do."""
    geometry = pair_geometry(gear_pair(read_case("fm-11x41")), (9, 7))
    model = coarse_solid_shells(geometry.pair, neighbours=True)
    return MeshCycle.of(geometry, model, mesh_positions=POSITIONS, segments_per_line=7)


@pytest.mark.parametrize("edge_contact", [True, False])
def test_rigid_supports_change_nothing(edge_contact: bool) -> None:
    here = cycle()
    plain, _ = here.loaded(TORQUES, edge_contact=edge_contact)
    rigid = here.supported(TORQUES, Supports.rigid(), rounds=FIRST_ORDER, edge_contact=edge_contact)
    assert plain.identical(rigid.loaded)
    assert plain.identical(here.loaded(TORQUES, edge_contact=edge_contact, supports=None)[0])
    assert not rigid.supports["supports_rotation"].values.any()


def test_stiffer_supports_come_near_to_rigid_ones() -> None:
    """What they add falls with their compliance, down to the least that is taken for one."""
    here, spring = cycle(), np.diag([1.0] * 3 + [1e-4] * 3)
    (rigid,) = (one.solution.force for one in here.solved([400.0])[:1])
    changes = []
    for size in (1e-7, 1e-8, 1e-9):
        stiff = Supports(Support(ORIGIN, size * spring), Support(ORIGIN, size * spring))
        case = here.supported([400.0], stiff, rounds=FIRST_ORDER, edge_contact=False).cases[0]
        changes.append(np.abs(case.solution.force - rigid).max() / rigid.max())
    np.testing.assert_allclose(np.log10(np.array(changes[:-1]) / changes[1:]), 1.0, atol=0.05)


@pytest.mark.parametrize("flank", ["drive", "coast"])
def test_one_spring_adds_the_product_of_the_normals(flank: FlankName) -> None:
    """A spring k in one direction d adds (n.d)(n.d)'/k to the compliance, n being the forces' directions."""
    here = on_shared_bodies() if flank == "drive" else cycle("fm-11x41", flank)
    direction, stiffness = np.array([0.48, -0.6, 0.64]), 2e5
    spring = np.zeros((6, 6))
    spring[:3, :3] = np.outer(direction, direction) / stiffness
    for member in (0, 1):
        one, other = Support(ORIGIN, spring), Support.rigid()
        held = Supports(one, other) if member == 0 else Supports(other, one)
        case = here.supported([200.0], held, rounds=FIRST_ORDER, edge_contact=False).cases[0]
        plain = here.solved([200.0])[0].segments
        data = here.geometry.ease_off
        added = case.segments.bending_problem.dense_compliance - plain.bending_problem.dense_compliance
        assert case.segments.wrench is not None
        normals = case.segments.wrench[:, :3]
        np.testing.assert_allclose(added, np.outer(normals @ direction, normals @ direction) / stiffness, atol=1e-16)
        # These are the flanks' normals, scaled by thousandths to the lever arm of the gear's.
        known = -data["action_normal"].values[data["inside"].values == 1]
        assert np.abs(np.linalg.norm(normals, axis=1) - 1.0).max() < 0.01
        assert min(np.linalg.norm(known - one, axis=1).min() for one in normals) < 0.05


def test_torsion_of_the_pinion_s_shaft_turns_the_gear_by_its_share() -> None:
    """Closed form: c T of the pinion, over the ratio, of the gear; the forces stay."""
    here = cycle()
    axis, torsion = member_axes(here.geometry.pair.assembly)[0], 3e-9
    shaft = Support(axis.point, torsion * np.outer(axis.couple, axis.couple))

    def contact(held: Supports) -> SupportedContact:
        return here.supported(TORQUES, held, rounds=FIRST_ORDER, edge_contact=False)

    rigid = contact(Supports.rigid())
    for held, share in ((Supports(shaft, Support.rigid(), wind_up=True), 1.0), (Supports(shaft, Support.rigid()), 0.0)):
        wound = contact(held)
        turned = 1e6 * share * torsion * 1e3 * np.array(TORQUES)[:, None]
        added = wound.supports["whole_rotation"].values - rigid.supports["whole_rotation"].values
        np.testing.assert_allclose(added, np.broadcast_to(turned / here.ratio, added.shape), rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(
            wound.supports["pinion_support_rotation"], -turned * np.ones(POSITIONS), rtol=1e-9, atol=1e-20
        )
        np.testing.assert_allclose(wound.loaded["force"], rigid.loaded["force"], rtol=1e-9, atol=1e-6)
        np.testing.assert_allclose(wound.loaded["transmission_error"], rigid.loaded["transmission_error"], rtol=1e-9)


@pytest.mark.quick(1)
@pytest.mark.parametrize(("name", "flank"), CASES)
def test_first_order_programme_is_the_limit_of_iterating_between_supports_and_contact(
    name: str, flank: FlankName
) -> None:
    """What other programs do: contact in the assembly that the forces before have led to. It takes many steps."""
    result = found(name, flank)
    for case in result.cases[:2]:
        here = case.segments
        assert here.support is not None
        twist, changes = np.zeros(6), [np.inf]
        while changes[-1] > 1e-12:
            moved = replace(here, support=SupportModes(np.zeros((6, 6)), -twist))
            solution, _ = solve_on_bending(moved.bending_problem.with_torque(case.problem.torque), here.line_contact)
            following = here.support.twist(here.mesh_wrench(solution.force))
            changes.append(float(np.abs(following - twist).max()))
            twist = following
            assert len(changes) < 200
        assert len(changes) > 5
        scale = case.solution.force.max()
        np.testing.assert_allclose(solution.force, case.solution.force, atol=1e-8 * scale, rtol=0)
        assert solution.rotation == pytest.approx(case.solution.rotation, rel=1e-8)


@pytest.mark.quick(1)
@pytest.mark.parametrize(("name", "flank"), CASES)
def test_contact_in_the_assembly_found_is_the_same_without_supports(name: str, flank: FlankName) -> None:
    """With the pinion turned as its support turns it, at every mesh position."""
    result = found(name, flank, TO_THE_END["position"])
    here = cycle(name, flank)
    assert result.supports["rounds_status"].values.tolist() == [RoundsStatus.ENDED] * 2
    parts = result.over_torque("parts")
    for place in ((0, 0), (1, 1)):  # every torque and mesh position once
        torque, position = place
        errors = [float(result.misalignment[name].values[place]) for name in PARTS[:4]]
        moved = here.misaligned(Misalignment(*errors))
        turned = parts[(*place, 4)] - (moved.geometry.exact.motion.center - here.geometry.exact.motion.center)
        alone = moved.at_rotations(here.lines.rotations[position : position + 1] + turned)
        loaded, _ = alone.loaded([TORQUES[torque]])
        with_supports = result.loaded.isel(torque=torque, mesh_position=position)
        for name in ("force", "pressure"):
            one, two = (np.nan_to_num(np.sort(d[name].values.ravel())) for d in (loaded, with_supports))
            one, two = one[one > 0.0], two[two > 0.0]
            np.testing.assert_allclose(one, two, atol=1e-8 * two.max(), rtol=0)
        shares = with_supports["load_share"].sel(pair=loaded["pair"]).values
        np.testing.assert_allclose(loaded["load_share"].values[0, 0], shares, atol=1e-8)
        # The rotation of the gear that the supports add beyond what they do to the gap.
        zero = [c.geometry.ease_off.attrs["first_contact_rad"] for c in (moved, here)]
        apart = zero[0] - zero[1] + parts[(*place, 5)] - parts[(*place, 4)] / here.ratio
        whole = loaded["transmission_error"].values[0, 0] + 1e6 * apart
        assert result.supports["whole_rotation"].values[place] == pytest.approx(whole, rel=1e-8)


@pytest.mark.parametrize("update", ["none", "mean", "position"])
def test_transmission_error_varies_as_the_whole_rotation_at_the_level_of_the_pair_in_the_mean_assembly(
    update: Update,
) -> None:
    result, here = found("fm-11x41", "drive", TO_THE_END[update]), cycle()
    data = result.supports
    left_out = (data["whole_rotation"] - data["transmission_error"]).transpose("torque", "mesh_position")
    np.testing.assert_allclose(
        left_out.values, data["support_rotation"].values[:, None] * np.ones(POSITIONS), rtol=1e-9
    )
    assert np.abs(left_out.values).min() > 10.0
    np.testing.assert_array_equal(data["transmission_error"], result.loaded["transmission_error"])
    for number, torque in enumerate(TORQUES):
        errors = [float(result.misalignment[name][number].mean()) for name in PARTS[:4]]
        alone, _ = here.misaligned(Misalignment(*errors)).loaded([torque])
        levels = [float(one["transmission_error"].mean()) for one in (alone, data.isel(torque=number))]
        assert levels[1] == pytest.approx(levels[0], rel=0.05 if update == "none" else 0.01)


@pytest.mark.parametrize("update", ["mean", "position"])
def test_every_round_leaves_a_small_part_of_the_change_before(update: Update) -> None:
    changes = [
        found("fm-11x41", "drive", AssemblyRounds(update, 1e-9, most), edge_contact=False)
        .supports["last_change"]
        .values
        for most in (1, 2, 3)
    ]
    assert (changes[0] > 20.0).all()
    assert (changes[1] < 0.01 * changes[0]).all()
    assert (changes[2] < 0.03 * changes[1]).all()


@pytest.mark.parametrize("rounds", [FIRST_ORDER, AssemblyRounds()], ids=["first order", "rounds"])
def test_progress_counts_every_torque_and_mesh_position_once(rounds: AssemblyRounds) -> None:
    calls: list[None] = []
    here = cycle()
    held = supports(here.geometry.pair.assembly)
    here.supported(TORQUES, held, rounds=rounds, edge_contact=False, progress=lambda: calls.append(None))
    assert len(calls) == len(TORQUES) * POSITIONS


def test_rounds_that_do_not_end_say_so_and_keep_the_last_certified_solutions() -> None:
    result = found("fm-11x41", "drive", AssemblyRounds("mean", 1e-9, 2), edge_contact=False)
    assert result.supports["rounds_status"].values.tolist() == [RoundsStatus.ROUND_LIMIT] * 2 == [1, 1]
    assert "120 N m: after 2 rounds the assembly still changes gaps by" in result.supports.attrs["rounds_not_ended"]
    assert (result.loaded["status"].values == 0).all()


def test_geometry_that_has_no_contact_ends_the_rounds_with_a_reason() -> None:
    here = cycle()
    soft = Support(ORIGIN, np.diag([9e-4, 9e-4, 9e-4, 9e-7, 9e-7, 9e-7]))
    result = here.supported([2000.0], Supports(soft, soft), edge_contact=False)
    assert result.supports["rounds_status"].values.tolist() == [RoundsStatus.NO_GEOMETRY]
    assert "the flanks have no contact in the assembly found" in result.supports.attrs["rounds_not_ended"]
    assert (result.loaded["status"].values == 0).all()


@pytest.mark.quick(1)
@pytest.mark.parametrize(("name", "flank"), CASES)
def test_every_position_is_certified_and_by_solvers_of_the_lifted_form(name: str, flank: FlankName) -> None:
    result = found(name, flank)
    entries = ("equilibrium", "negative_force", "negative_gap", "complementarity", "duality_gap")
    assert (result.loaded["status"].values == 0).all()
    for entry in entries:
        assert np.abs(result.loaded[entry].values).max() < 1e-9
    case = result.cases[1]
    for solver in sorted({"native", *LIFTING} & set(available_solvers())):
        again = solve(case.problem, solver, form="auto" if solver == "native" else "lifted")
        assert again.certified, solver
        np.testing.assert_allclose(again.force, case.solution.force, atol=1e-7 * case.solution.force.max())
        assert again.rotation == pytest.approx(case.solution.rotation, rel=1e-8)


@pytest.mark.quick(1)
@pytest.mark.parametrize(("name", "flank"), CASES)
def test_work_of_the_torque_is_the_energy_of_teeth_contact_and_supports(name: str, flank: FlankName) -> None:
    """By the rotation over the torque: the derivative of the complementary energy is the rotation of the problem."""
    here, held = cycle(name, flank), supports(cycle(name, flank).geometry.pair.assembly)
    step = 0.01
    torques = 300.0 * (1.0 + step * np.array([-1.0, 0.0, 1.0]))
    result = here.supported(torques, held, rounds=FIRST_ORDER, edge_contact=False)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    energies: dict[int, list[float]] = {}
    for case in sorted(result.cases, key=lambda one: one.torque):
        segments, force = case.segments, case.solution.force
        assert segments.support is not None
        wrench = segments.mesh_wrench(force)
        bending = 0.5 * np.sum((force @ segments.bending.factor) ** 2)
        motion = 0.5 * wrench @ segments.support.twist(wrench)
        along = [segments.line_contact.deflection(0.5 * (1.0 + node) * force) for node in nodes]
        local = 0.5 * sum(weight * (one @ force) for weight, one in zip(weights, along, strict=True))
        energy = bending + motion + local + force @ segments.separation
        energies.setdefault(case.mesh_position, []).append(float(energy))
    rotations = {case.mesh_position: case.solution.rotation for case in result.cases if case.torque == 1}
    for position, (low, _, high) in energies.items():
        slope = (high - low) / (1e3 * here.ratio * (torques[2] - torques[0]))
        assert slope == pytest.approx(rotations[position], rel=2e-5)


@pytest.mark.parametrize("rounds", [FIRST_ORDER, TO_THE_END["mean"]], ids=["first order", "rounds"])
def test_shares_of_the_rotation_add_up(rounds: AssemblyRounds) -> None:
    """To first order their ease-off part is the forces' work on the separations."""
    result = found("fm-11x41", "drive", rounds)
    data, ratio = result.supports, cycle().ratio
    names = ("teeth_rotation", "contact_rotation", "supports_rotation", "ease_off_rotation")
    np.testing.assert_allclose(sum(data[n] for n in names), data["whole_rotation"], rtol=1e-9)
    assert all((data[name] > 0.0).all() for name in names)
    if rounds is FIRST_ORDER:
        for case in result.cases:
            work = 1e6 * case.segments.separation @ case.solution.force / (1e6 * ratio * TORQUES[case.torque] / 1e3)
            share = data["ease_off_rotation"].values[case.torque, case.mesh_position]
            assert share == pytest.approx(work, rel=1e-7)


def test_compliance_with_supports_is_symmetric_and_without_negative_eigenvalue() -> None:
    for case in found("fm-11x41", "drive").cases:
        matrix = case.problem.dense_compliance
        np.testing.assert_allclose(matrix, matrix.T, atol=1e-20)
        assert np.linalg.eigvalsh(matrix).min() > -1e-15 * np.abs(matrix).max()


def test_mesh_force_balances_the_torques() -> None:
    """With contact on lines the moments about both axes are the torques themselves."""
    here = cycle()
    assembly = here.geometry.pair.assembly
    result = here.supported(TORQUES, supports(assembly), rounds=FIRST_ORDER, edge_contact=False)
    sense = here.geometry.exact.motion.pinion_sense
    pinion, gear = member_axes(assembly)
    wrench = result.over_torque("wrench")
    turning = np.array(TORQUES)[:, None] * 1e3 * np.ones((2, POSITIONS))
    np.testing.assert_allclose(wrench @ pinion.rotation, -sense * turning, rtol=1e-10)
    np.testing.assert_allclose(wrench @ gear.rotation, sense * here.ratio * turning, rtol=1e-10)
    force, moment = result.supports["mesh_force"], result.supports["mesh_moment"]
    np.testing.assert_array_equal(force.sel(member="pinion"), -force.sel(member="gear"))
    reference = result.supports["reference"].sel(member="gear").values
    about = shifted_wrench(-wrench, ORIGIN, reference)
    np.testing.assert_allclose(1e3 * moment.sel(member="gear").values, about[..., 3:], rtol=1e-12)


def on_two_bearings(axis: MemberAxis, places: tuple[float, float]) -> Support:
    """A rigid shaft on two bearings of equal stiffness, one of them fixed along the shaft."""
    direction = np.asarray(axis.direction)
    across = np.eye(3) - np.outer(direction, direction)
    points = [np.asarray(axis.point) + place * direction for place in places]
    reference = points[0] + 7.0 * direction
    stiffness, own = np.zeros((6, 6)), []
    for point, axial in zip(points, (4e5, 0.0), strict=True):
        at_bearing = np.zeros((6, 6))
        at_bearing[:3, :3] = 2e5 * across + axial * np.outer(direction, direction)
        to_reference = shift_matrix(point, reference)
        own.append(at_bearing @ to_reference.T)  # load on the bearing for a twist of the member at its reference
        stiffness += to_reference @ at_bearing @ to_reference.T
    held = Support.of_stiffness(reference, stiffness, axis)
    loads = [one @ np.asarray(held.compliance) for one in own]
    bearings = [BearingReaction(name, p, load) for name, p, load in zip(("head", "tail"), points, loads, strict=True)]
    return Support(reference, held.compliance, tuple(bearings))


@pytest.mark.quick(2)
@pytest.mark.parametrize(("name", "flank"), CASES)
@pytest.mark.parametrize("rounds", [FIRST_ORDER, AssemblyRounds()], ids=["first order", "rounds"])
def test_bearing_forces_balance_the_mesh_force_and_the_torques(
    name: str, flank: FlankName, rounds: AssemblyRounds
) -> None:
    here = cycle(name, flank)
    axes = member_axes(here.geometry.pair.assembly)
    held = Supports(on_two_bearings(axes[0], (90.0, 150.0)), on_two_bearings(axes[1], (-40.0, 60.0)))
    result = here.supported(TORQUES, held, rounds=rounds)
    assert result.supports["bearing"].values.tolist() == ["pinion head", "pinion tail", "gear head", "gear tail"]
    wrench, data = result.over_torque("wrench"), result.supports
    for sign, member, axis in zip((1.0, -1.0), ("pinion", "gear"), axes, strict=True):
        total = sign * wrench
        for bearing in ("head", "tail"):
            own = data.sel(bearing=f"{member} {bearing}")
            load = np.concatenate([own["bearing_force"].values, 1e3 * own["bearing_moment"].values], axis=-1)
            total = total - shifted_wrench(load, own["bearing_position"].values, ORIGIN)
        torque = total @ axis.rotation
        scale = np.abs(wrench[..., 3:]).max()
        np.testing.assert_allclose(total, torque[..., None] * axis.couple, atol=1e-10 * scale)
        if member == "gear":
            sense = here.geometry.exact.motion.pinion_sense
            gear_torque = np.array(TORQUES)[:, None] * 1e3 * here.ratio * np.ones(POSITIONS)
            np.testing.assert_allclose(-sense * torque, gear_torque, rtol=1e-10)


@dataclass(frozen=True, eq=False)
class Stiffening:
    """Supports that are the stiffer, the greater the force."""

    soft: Supports
    force: float

    def at(self, pinion_wrench: Array, gear_wrench: Array) -> Supports:
        np.testing.assert_array_equal(pinion_wrench, -gear_wrench)
        share = 1.0 / (1.0 + float(np.linalg.norm(pinion_wrench[:3])) / self.force)
        pinion, gear = (
            Support(one.reference, share * np.asarray(one.compliance)) for one in (self.soft.pinion, self.soft.gear)
        )
        return Supports(pinion, gear)


@pytest.mark.parametrize("update", ["none", "mean", "position"])
def test_supports_that_depend_on_the_load_are_those_under_the_load_found(update: Update) -> None:
    here = cycle()
    held = Stiffening(supports(here.geometry.pair.assembly), 8e3)
    torques = TORQUES[1:] if update == "position" else TORQUES
    result = here.supported(torques, held, rounds=AssemblyRounds(update=update, limit=1e-8), edge_contact=False)
    assert (result.supports["rounds_status"] == 0).all()
    wrench = result.over_torque("wrench")
    motion = result.pair.motion(here)
    for one in result.rounds:
        (torque,) = one.torques
        for position in range(POSITIONS):
            under = wrench[torque, position] if update == "position" else wrench[torque].mean(axis=0)
            relative = held.at(under, -under).relative(here.geometry.pair.assembly)
            twist = relative @ wrench[torque, position]
            own = RelativeMotion(one.round.cycle.geometry.pair.assembly, motion.pinion_sense)
            if update != "position":
                np.testing.assert_allclose(own.twist(one.round.parts[0, position]), twist, atol=1e-10)
            else:
                size = np.abs(twist).max()
                np.testing.assert_allclose(own.twist(one.round.parts[0, position]), twist, atol=1e-3 * size)


@pytest.mark.thorough
@pytest.mark.parametrize("flank", ["drive", "coast"])
def test_mirror_image_moves_alike(flank: FlankName) -> None:
    """The other hand: E, P, G, Sigma and the rotation are the same, the forces along the offset turn round."""
    one, other = (found("fm-11x41", flank, TO_THE_END["mean"], mirror) for mirror in (False, True))
    for name in PARTS[:4]:
        np.testing.assert_allclose(one.misalignment[name], other.misalignment[name], rtol=1e-7, atol=1e-10)
    for name in ("whole_rotation", "transmission_error", "pinion_support_rotation", "gear_support_rotation"):
        np.testing.assert_allclose(one.supports[name], other.supports[name], rtol=1e-6, atol=1e-6)
    turned = one.supports["mesh_force"].values * [1.0, -1.0, 1.0]
    np.testing.assert_allclose(other.supports["mesh_force"].values, turned, rtol=1e-6, atol=1e-3)


def test_motion_within_the_mean_assembly_varies_little_and_is_told() -> None:
    """Groups are labelled, and the misalignment is the whole one, that without load included."""
    here = cycle()
    errors = Misalignment(0.05, -0.04, 0.03, 0.0002)
    moved = here.misaligned(errors)
    rigid = moved.supported([100.0], Supports.rigid())
    for name, value in vars(errors).items():
        np.testing.assert_allclose(rigid.misalignment[name].values, value, rtol=1e-12)
    result = found("fm-11x41", "drive", TO_THE_END["mean"])
    for data in (result.loaded, result.misalignment, result.supports):
        assert all("long_name" in variable.attrs for variable in data.variables.values())
    assert result.misalignment["shaft_angle"].attrs["units"] == "rad"
    assert result.supports["mesh_moment"].dims == ("member", "torque", "mesh_position", "space")


def test_edges_are_searched_as_far_as_gaps_close() -> None:
    """The answer is that with every piece of edge within a much greater rotation."""
    here = cycle("nasa-12x36", "coast")
    held = supports(here.geometry.pair.assembly)
    result = here.supported([700.0], held, rounds=FIRST_ORDER)
    wrenches = MeshWrenches.of(here.geometry)
    segments = replace(here.segments, wrenches=wrenches).with_edges(np.full(POSITIONS, 4e-3))
    modes = SupportModes(held.relative(here.geometry.pair.assembly), np.zeros(6))
    assert result.loaded["edge_share"].values.max() > 0.01
    for case in result.cases:
        every = segments[case.mesh_position]
        assert every is not None
        assert every.pair.size > case.segments.pair.size
        whole = replace(every, support=modes)
        solution, _ = solve_on_bending(whole.bending_problem.with_torque(case.problem.torque), whole.line_contact)
        assert solution.rotation == pytest.approx(case.solution.rotation, rel=1e-9)
        touching = np.count_nonzero(solution.force > 1e-9 * solution.force.max())
        assert touching == np.count_nonzero(case.solution.force > 1e-9 * solution.force.max())
