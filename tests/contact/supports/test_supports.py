"""Supports as matrices: reference points, free rotations, coupling, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from supported_pairs import FIRST_ORDER, cycle, found

from easeoff.cases import gear_pair, read_case
from easeoff.contact import Supports, identified_support
from easeoff.contact.mesh_wrench import unit_wrenches
from easeoff.contact.supports.support import (
    ORIGIN,
    MemberAxis,
    Support,
    member_axes,
    shift_matrix,
    shifted_compliance,
    shifted_wrench,
)
from easeoff.contact.supports.supported_contact import RelativeMotion
from easeoff.core.errors import InputError

Array = NDArray[np.float64]
POINT, OTHER = np.array([30.0, -20.0, 65.0]), np.array([-12.0, 7.0, 40.0])
GEAR_AXIS = MemberAxis(ORIGIN, (0.0, 0.0, 1.0))


def stiffness(seed: int = 1) -> Array:
    """A stiffness of bearings about 60 mm apart, in no direction like in another."""
    part = np.random.default_rng(seed).normal(size=(6, 9))
    scale = np.repeat([np.sqrt(1e5), np.sqrt(1e8)], 3)
    return np.asarray((part @ part.T / 9.0 + 0.3 * np.eye(6)) * np.outer(scale, scale))


def shifted_stiffness(stiffness: Array, start: Array, end: Array) -> Array:
    """A stiffness (6, 6), wrench for twist at ``start``, at ``end``."""
    shift = shift_matrix(start, end)
    return np.asarray(shift @ stiffness @ shift.T)


def test_work_and_moments_do_not_depend_on_the_reference_point() -> None:
    wrench, twist = np.random.default_rng(2).normal(size=(2, 4, 6))
    moved_wrench, moved_twist = shifted_wrench(wrench, POINT, OTHER), twist @ shift_matrix(OTHER, POINT)
    np.testing.assert_allclose(np.sum(wrench * twist, axis=1), np.sum(moved_wrench * moved_twist, axis=1), rtol=1e-12)
    np.testing.assert_allclose(moved_wrench[:, 3:], wrench[:, 3:] + np.cross(POINT - OTHER, wrench[:, :3]))
    np.testing.assert_allclose(moved_twist[:, :3], twist[:, :3] + np.cross(twist[:, 3:], OTHER - POINT))
    np.testing.assert_allclose(shift_matrix(OTHER, POINT) @ shift_matrix(POINT, OTHER), np.eye(6), atol=1e-12)
    force = unit_wrenches(POINT[:, None], np.array([[0.0], [0.6], [0.8]]))[0]
    np.testing.assert_allclose(force, shifted_wrench(np.array([0.0, 0.6, 0.8, 0, 0, 0]), POINT, ORIGIN), atol=1e-12)


def test_shifted_compliance_is_the_inverse_of_the_shifted_stiffness() -> None:
    known = stiffness()
    there = shifted_stiffness(known, POINT, OTHER)
    compliance: Array = np.asarray(np.linalg.inv(known), dtype=np.float64)
    np.testing.assert_allclose(shifted_compliance(compliance, POINT, OTHER) @ there, np.eye(6), atol=1e-8)


def test_support_is_the_same_from_every_reference_point() -> None:
    assembly = gear_pair(read_case("fm-11x41")).assembly
    known = stiffness()
    here = Supports(Support.rigid(), Support.of_stiffness(POINT, known))
    there = Supports(Support.rigid(), Support.of_stiffness(OTHER, shifted_stiffness(known, POINT, OTHER)))
    one, two = here.relative(assembly), there.relative(assembly)
    np.testing.assert_allclose(one, two, atol=1e-10 * np.abs(one).max())


@pytest.mark.parametrize("member", [0, 1])
def test_rotation_about_the_own_axis_is_held_and_may_be_free(member: int) -> None:
    """Held by a couple it moves as if its stiffness were without end; where it has none nothing else changes."""
    assembly = gear_pair(read_case("fm-11x41")).assembly
    axis = member_axes(assembly)[member]
    reference = np.asarray(axis.point) + 50.0 * np.asarray(axis.direction)
    known = stiffness()
    clamped = np.linalg.inv(known + 1e20 * np.outer(axis.couple, axis.couple))

    def relative(support: Support) -> Array:
        both = Supports(Support.rigid(), support) if member else Supports(support, Support.rigid())
        return both.relative(assembly)

    found = relative(Support.of_stiffness(reference, known))
    np.testing.assert_allclose(found, relative(Support(reference, clamped)), atol=1e-9 * np.abs(found).max())
    np.testing.assert_allclose(
        found, relative(Support.of_stiffness(reference, known, axis)), atol=1e-12 * np.abs(found).max()
    )
    # A stiffness that leaves the rotation about the axis free: the axis goes through the reference.
    turning = np.concatenate([np.zeros(3), axis.direction])
    loose = np.eye(6) - np.outer(turning, turning)
    free = Support.of_stiffness(reference, loose @ known @ loose, axis)
    np.testing.assert_allclose(np.asarray(free.compliance) @ axis.couple, np.zeros(6), atol=1e-20)


def test_matrix_of_both_members_is_that_of_each_where_no_housing_couples_them() -> None:
    assembly = gear_pair(read_case("fm-11x41")).assembly
    axes = member_axes(assembly)
    each = Supports(Support.of_stiffness(POINT, stiffness(0)), Support.of_stiffness(OTHER, stiffness(1)))
    whole = np.zeros((12, 12))
    whole[:6, :6], whole[6:, 6:] = stiffness(0), stiffness(1)
    for arguments in ({"stiffness": whole}, {"compliance": np.linalg.inv(whole)}, {"stiffness": whole, "axes": axes}):
        found = Supports.of_matrix((POINT, OTHER), **arguments).relative(assembly)
        np.testing.assert_allclose(found, each.relative(assembly), atol=1e-10 * np.abs(found).max())


def test_housing_that_moves_as_a_whole_leaves_the_pair_where_it_is() -> None:
    """A frame on soft springs, rigid in itself: both members move alike, and no mesh force moves it."""
    assembly = gear_pair(read_case("fm-11x41")).assembly
    frame = np.linalg.inv(stiffness())  # about the origin
    rows = np.concatenate([shift_matrix(point, ORIGIN).T for point in (POINT, OTHER)])
    whole = rows @ frame @ rows.T
    found = Supports.of_matrix((POINT, OTHER), compliance=whole, wind_up=True)
    motion = np.concatenate([np.eye(6), -np.eye(6)])
    shift = np.zeros((12, 12))
    shift[:6, :6], shift[6:, 6:] = shift_matrix(ORIGIN, POINT), shift_matrix(ORIGIN, OTHER)
    relative = motion.T @ shift.T @ found.compliance @ shift @ motion
    np.testing.assert_allclose(relative, np.zeros((6, 6)), atol=1e-12 * np.abs(frame).max())
    assert np.linalg.eigvalsh(found.relative(assembly)).min() > -1e-15 * np.abs(frame).max()


def test_wind_up_lets_the_pinion_turn_by_the_torsion_of_its_shaft() -> None:
    assembly = gear_pair(read_case("fm-11x41")).assembly
    axis = member_axes(assembly)[0]
    torsion = 2e-9
    support = Support(axis.point, torsion * np.outer(axis.couple, axis.couple))
    for wind_up in (False, True):
        relative = Supports(support, Support.rigid(), wind_up=wind_up).relative(assembly)
        assert axis.rotation @ relative @ axis.rotation >= 0.0
        assert np.isclose(axis.couple @ relative @ axis.couple, torsion if wind_up else 0.0, atol=1e-25)


def diagonal(translation: float, rotation: float, **changed: float) -> Array:
    known = np.diag([translation] * 3 + [rotation] * 3)
    for name, value in changed.items():
        known["xyzabc".index(name), "xyzabc".index(name)] = value
    return known


ASYMMETRIC = diagonal(1e5, 1e9) + np.eye(6, k=1) * 1e3
REFUSED: dict[str, tuple[Any, str]] = {
    "not symmetric": (ASYMMETRIC, "stiffness = 1000 in row 1, column 2: must be symmetric; row 2, column 1 has 0"),
    "negative": (diagonal(1e5, 1e9, y=-1e5), "must be positive definite; its least eigenvalue is negative"),
    "in N/m and N m": (diagonal(1e8, 1e6), "other units, such as N/m and N m/rad"),
    "in N m": (diagonal(1e5, 1e5), "other units"),
    "in kN/mm": (diagonal(1e2, 1e6), r"stiffness = 100: must be from 1000 to 1e\+09 N/mm against translation"),
    "in GPa": (diagonal(210.0, 210.0), "check its units"),
    "too stiff": (diagonal(1e12, 1e16), "check its units"),
    "loose along z": (diagonal(1e5, 1e9, z=0.0), "leaves the translation along z free"),
    "loose about x": (diagonal(1e5, 1e9, a=0.0), "leaves the rotation about x free"),
    "too small": (np.eye(5), r"stiffness = array of shape \(5, 5\): must have the shape \(6, 6\)"),
    "not finite": (diagonal(1e5, np.nan), "must be a finite number"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refuses_what_is_no_stiffness_with_one_message(name: str) -> None:
    matrix, message = REFUSED[name]
    with pytest.raises(InputError, match=message):
        Support.of_stiffness(POINT, matrix)


def test_refuses_a_reference_that_leaves_a_mechanism() -> None:
    """The free rotation then is about a line beside the axis; the message says where."""
    loose = diagonal(1e5, 1e9, c=0.0)
    assert Support.of_stiffness((0.0, 0.0, 70.0), loose, GEAR_AXIS).bearings == ()
    message = r"rotation about z through \(30, -20, 65\) free, which is not the axis of the member: check stiffness and"
    with pytest.raises(InputError, match=message):
        Support.of_stiffness(POINT, loose, GEAR_AXIS)


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        (diagonal(1e-8, 1e-6), r"must be from 1e-09 to 0.001 mm/N against translation"),
        (diagonal(1e-12, 1e-13), "or zero where the support is rigid; check its units"),
        (diagonal(1e-5, 1e-9, b=-1e-9), "must have no negative eigenvalue"),
        (diagonal(1e-5, 1e-9) + 1e-7 * np.eye(6, k=1), "must be symmetric"),
    ],
)
def test_refuses_what_is_no_compliance(matrix: Array, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Support(POINT, matrix)
    whole = np.kron(np.eye(2), matrix)
    with pytest.raises(InputError, match=message):
        Supports.of_matrix((POINT, OTHER), compliance=whole)


def test_refuses_both_or_neither_of_the_matrices() -> None:
    with pytest.raises(InputError, match="must be given one of them"):
        Supports.of_matrix((POINT, OTHER))


# --- Stiffnesses of supports from deflections


ASSEMBLY = gear_pair(read_case("fm-11x41")).assembly
TWISTS = RelativeMotion(ASSEMBLY, 1.0).twists[:, :4]
SCALE: Array = np.array([1.0, 1.0, 1.0, 100.0])


def compliance(seed: int = 4) -> Array:
    part = np.random.default_rng(seed).normal(size=(4, 6))
    return np.asarray(1e-5 * part @ part.T / 6.0 / np.outer(SCALE, SCALE))


def wrenches(count: int) -> Array:
    return np.asarray(np.random.default_rng(5).normal(size=(count, 6)) * np.repeat([1e4, 5e5], 3))


def test_compliance_is_found_again_where_the_forces_differ_enough() -> None:
    forces, known = wrenches(4), compliance()
    result = identified_support(ASSEMBLY, forces, forces @ TWISTS @ known)
    scaled = known * np.outer(SCALE, SCALE)
    np.testing.assert_allclose(result.compliance * np.outer(SCALE, SCALE), scaled, atol=1e-8 * scaled.max())
    assert (result.determined, result.independent_forces) == (10, 4)
    np.testing.assert_allclose(result.residual, 0.0, atol=1e-8)


@pytest.mark.parametrize(("count", "determined"), [(1, 4), (2, 7), (3, 9), (5, 10)])
def test_result_says_how_far_the_forces_determine_it(count: int, determined: int) -> None:
    """Torques in proportion add nothing: one direction fixes four of the ten numbers."""
    forces = np.concatenate([wrenches(count), 0.5 * wrenches(count)])
    moved = forces @ TWISTS @ compliance()
    result = identified_support(ASSEMBLY, forces, moved)
    assert result.determined == determined
    assert result.independent_forces == min(count, 4)
    np.testing.assert_allclose(result.residual * SCALE, 0.0, atol=1e-5 * np.abs(moved * SCALE).max())
    assert np.linalg.eigvalsh(result.compliance).min() >= -1e-20


def test_negative_stiffness_is_not_the_answer_but_the_nearest_there_is() -> None:
    """No compliance without negative eigenvalues in the neighbourhood explains more."""
    forces = wrenches(6)
    scaled = compliance() * np.outer(SCALE, SCALE)
    values, vectors = np.linalg.eigh(scaled)
    values[0] = -0.5 * values[-1]
    wrong = (vectors * values) @ vectors.T / np.outer(SCALE, SCALE)
    moved = forces @ TWISTS @ wrong
    result = identified_support(ASSEMBLY, forces, moved)
    own = result.compliance * np.outer(SCALE, SCALE)
    assert np.linalg.eigvalsh(own).min() >= -1e-9 * np.abs(own).max()

    def misfit(matrix: Array) -> float:
        return float(np.sum((SCALE * (forces @ TWISTS @ (matrix / np.outer(SCALE, SCALE)) - moved)) ** 2))

    least, random = misfit(own), np.random.default_rng(6)
    assert least > 0.0
    for _ in range(200):
        part = random.normal(size=(4, 4))
        other = own + 1e-3 * np.abs(own).max() * (part + part.T)
        spectrum, frame = np.linalg.eigh(other)
        assert misfit((frame * np.maximum(spectrum, 0.0)) @ frame.T) > least * (1.0 - 1e-9)


def test_supports_found_from_drive_and_coast_move_the_pair_as_measured() -> None:
    """A table computed with supports, at two torques and on both flanks; the answer put in their place."""
    tables = {flank: found("fm-11x41", flank) for flank in ("drive", "coast")}
    forces = np.concatenate([one.mesh_wrench.mean(axis=1) for one in tables.values()])
    names = ("offset", "pinion_axial", "gear_axial", "shaft_angle")
    given = np.array([getattr(cycle().geometry.pair.assembly.misalignment, name) for name in names])
    rows = [
        np.stack([one.misalignment[n].values.mean(axis=1) for n in names], axis=1) - given for one in tables.values()
    ]
    whole = np.concatenate(rows)
    size = np.abs(whole * SCALE).max()
    for rotations, share in ((False, 2e-2), (True, 2e-3)):
        result = identified_support(cycle().geometry.pair.assembly, forces, whole, rotations=rotations)
        assert result.independent_forces >= 2
        assert np.abs(result.residual * SCALE).max() < share * size
        again = cycle().supported([120.0, 400.0], result.supports, rounds=FIRST_ORDER)
        moved = np.stack([again.misalignment[name].values.mean(axis=1) for name in names], axis=1) - given
        np.testing.assert_allclose(moved * SCALE, rows[0] * SCALE, atol=share * size, rtol=0)
    assert isinstance(result.supports, Supports)


@pytest.mark.parametrize(
    ("forces", "moved", "message"),
    [
        (np.ones((2, 6)), np.ones((3, 4)), r"must have the shapes \(n, 4\), \(n, 6\)"),
        (np.zeros((1, 6)), np.ones((1, 4)), "must have a force"),
        (np.ones((1, 6)), np.full((1, 4), np.nan), "must be a finite number"),
    ],
)
def test_refuses_what_does_not_fit(forces: Array, moved: Array, message: str) -> None:
    with pytest.raises(InputError, match=message):
        identified_support(ASSEMBLY, forces, moved)
