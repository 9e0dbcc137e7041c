"""Modes that all tooth pairs share: found, solved and proved as the dense problem, by every method."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from shared_problems import as_array, basis_of, compiled_certificate, dense, line_contact_of, shared_problem
from solver_choice import BACKENDS, LIFTING, installed

from easeoff import InputError
from easeoff.contact import (
    ContactProblem,
    ModalBasis,
    SharedModes,
    dual_qp,
    export_problems,
    import_problems,
    lcp,
    lifted_qp,
    read_npz,
    sensitivity,
    solve,
    solve_many,
    torque_path,
    with_shared_modes,
)
from easeoff.contact.line_contact.line_contact_solution import solve_on_bending
from easeoff.contact.problem.certificate import exact_residuals
from easeoff.contact.problem.complementary_pivoting import lemke
from easeoff.contact.problem.exchange.programme_file import read_qps, write_npz, write_qps
from easeoff.contact.problem.modal_basis import basis_of_blocks, modal_basis
from easeoff.contact.solvers.compiled.compiled_answer import line_contact_answers, linear_answer
from easeoff.contact.solvers.parametric.touching_form import ModalTouching, touching_stiffness
from easeoff.contact.solvers.touching_system import DenseTouching

Array = NDArray[np.float64]


def assert_same(found: Any, exact: Any, tolerance: float = 1e-10) -> None:
    """Forces, gaps and rotation of two solutions agree."""
    assert found.certified
    assert exact.certified
    assert np.abs(found.force - exact.force).max() <= tolerance * exact.force.max()
    closing = max(np.abs(exact.gap).max(), abs(exact.elastic_rotation) * 45.0)
    assert np.abs(found.gap - exact.gap).max() <= tolerance * closing
    assert found.elastic_rotation == pytest.approx(exact.elastic_rotation, rel=tolerance)


# The form


def test_factor_has_the_blocks_then_the_shared_modes() -> None:
    for seed in range(20):
        basis = basis_of(shared_problem(seed))
        if basis.shared is None:
            continue
        expected = np.zeros((basis.size, basis.size))
        shared = np.zeros((basis.size, basis.shared.mixing.shape[2]))
        for (rows, modes), mixing in zip(basis.blocks, basis.shared.mixing, strict=True):
            expected[np.ix_(rows, rows)] += modes @ modes.T
            shared[rows] = basis.shared.columns[rows] @ mixing
        expected += shared @ shared.T
        assert np.abs(basis.factor @ basis.factor.T - expected).max() <= 1e-14 * expected.max()
        assert np.array_equal(basis.factor[:, -basis.shared_factor.shape[1] :], basis.shared_factor)
        border = basis.border  # what solvers take
        assert border.mixing.shape[2] <= border.mixing.shape[0] * border.mixing.shape[1]
        taken = np.zeros((basis.size, border.mixing.shape[2]))
        for (rows, _), mixing in zip(basis.blocks, border.mixing, strict=True):
            taken[rows] = border.columns[rows] @ mixing
        assert np.abs(taken @ taken.T - shared @ shared.T).max() <= 1e-14 * expected.max()


def test_shared_modes_are_added_to_those_there_are() -> None:
    first = basis_of(shared_problem(1, pairs=3, columns=2, modes=2))
    assert first.shared is not None
    columns, mixing = np.ones((first.size, 1)), 1e-3 * np.ones((3, 1, 1))
    both = with_shared_modes(first, columns, mixing)
    expected = first.factor @ first.factor.T + 1e-6
    assert np.abs(both.factor @ both.factor.T - expected).max() <= 1e-15 * expected.max()


@pytest.mark.parametrize(
    ("columns", "mixing", "message"),
    [
        (np.ones((3, 1)), np.ones((2, 1, 1)), "shared columns = array of shape .3, 1.: must have 4 rows"),
        (np.ones(4), np.ones((2, 1, 1)), "shared columns: must be an array of floats of shape .4, q."),
        (np.ones((4, 1), dtype=int), np.ones((2, 1, 1)), "shared columns: must be an array of floats"),
        ([[1.0]] * 4, np.ones((2, 1, 1)), "shared columns: must be an array of floats"),
        (np.ones((4, 1)), np.ones((1, 1)), "shared mixing: must be an array of floats of shape .2, q, s."),
        (
            np.ones((4, 1)),
            np.ones((3, 1, 1)),
            "shared mixing = array of shape .3, 1, 1.: must have the shape .2, 1, s.",
        ),
        (np.ones((4, 2)), np.ones((2, 1, 1)), "2 shared columns"),
        (np.full((4, 1), np.nan), np.ones((2, 1, 1)), "shared columns: must be finite"),
        (np.ones((4, 1)), np.full((2, 1, 1), np.inf), "shared mixing: must be finite"),
    ],
)
def test_shared_modes_are_checked(columns: Any, mixing: Any, message: str) -> None:
    basis = ModalBasis(4, np.array([[0, 1], [2, 3]]), np.zeros((2, 2, 1)))
    with pytest.raises(InputError, match=message):
        with_shared_modes(basis, columns, mixing)
    with pytest.raises(InputError, match=message):
        ModalBasis(4, basis.index, basis.modes, SharedModes(columns, mixing))


@pytest.mark.parametrize("nothing", ["columns", "mixing", "no columns", "no modes"])
def test_rigid_supports_change_no_bit(nothing: str) -> None:
    problem = shared_problem(2, pairs=3, modes=0)
    basis = basis_of(problem)
    columns, mixing = np.ones((basis.size, 2)), np.ones((3, 2, 2))
    if nothing == "no columns":
        columns, mixing = columns[:, :0], mixing[:, :0]
    elif nothing == "no modes":
        mixing = mixing[:, :, :0]
    else:
        (columns if nothing == "columns" else mixing)[:] = 0.0
    known = solve(problem)
    for other in (with_shared_modes(basis, columns, mixing), replace(basis, shared=SharedModes(columns, mixing))):
        given = ContactProblem.of_modes(
            problem.separation, problem.lever_arm, problem.torque, problem.compliance[0], other
        )
        found = solve(given)
        assert np.array_equal(found.force, known.force)
        assert np.array_equal(found.gap, known.gap)
        assert found.rotation == known.rotation
        assert found.certificate == known.certificate
        assert np.array_equal(given.compliance[1], problem.compliance[1])


# A factor as an array


@pytest.mark.parametrize(("pairs", "columns", "modes"), [(2, 1, 1), (3, 6, 6), (6, 6, 4), (6, 6, 36), (8, 6, 48)])
def test_shared_modes_are_found_in_a_shuffled_factor(pairs: int, columns: int, modes: int) -> None:
    problem = shared_problem(4, pairs=pairs, columns=columns, modes=modes, longest=-31)
    given, rng = basis_of(problem), np.random.default_rng(0)
    rows, order = rng.permutation(problem.size), rng.permutation(given.factor.shape[1])
    found = modal_basis(given.factor[rows][:, order])
    assert found.shared is not None
    assert len(found.blocks) == len([own for _, own in given.blocks if own.shape[1]])
    assert found.shared.columns.shape[1] <= columns
    assert found.modes.shape[2] <= given.modes.shape[2] + 1
    exact = given.factor[rows] @ given.factor[rows].T
    assert np.abs(found.factor @ found.factor.T - exact).max() <= 1e-14 * exact.max()
    border = found.border
    mixed = np.zeros((problem.size, border.mixing.shape[2]))
    for (own, _), mixing in zip(found.blocks, border.mixing, strict=True):
        mixed[own] = border.columns[own] @ mixing
    apart = found.shared_factor
    assert np.abs(mixed @ mixed.T - apart @ apart.T).max() <= 1e-14 * exact.max()


def test_other_factors_stay_as_they_are() -> None:
    """Full ones, those that fall apart, chains, random zeros, and blocks coupled by almost all columns."""
    rng = np.random.default_rng(3)
    factors: list[Array] = [
        rng.standard_normal((40, 12)),
        np.kron(np.eye(3), rng.standard_normal((8, 4))).astype(np.float64),
        np.eye(50) + np.eye(50, k=1),
        rng.standard_normal((60, 20)) * (rng.random((60, 20)) < 0.3),
        np.hstack([np.kron(np.eye(2), rng.standard_normal((8, 1))), rng.standard_normal((16, 8))]),
        np.zeros((5, 3)),
        np.zeros((5, 0)),
    ]
    for factor in factors:
        assert modal_basis(factor).shared is None


def test_work_grows_with_the_segments_alone() -> None:
    """What the compiled method reads: no more numbers a segment than modes of its pair and shared columns."""
    for size in (31, 310):
        problem = shared_problem(5, pairs=6, columns=6, modes=36, longest=-size)
        basis = basis_of(as_array(problem))
        widest = basis.modes.shape[2] + 6
        assert widest <= 28  # 20 and 6, and what rounding adds on one processor or another
        assert basis.columns.columns.size <= 4.0 / 3.0 * problem.size * widest


# Answers


@pytest.mark.parametrize("signs", [False, True])
@pytest.mark.parametrize("softness", [1e-12, 1.0, 50.0])
def test_answers_are_those_of_the_dense_problem(softness: float, signs: bool) -> None:
    for seed in (0, 3, 6, 7, 14, 20):
        problem = shared_problem(seed, softness=softness, signs=signs, alike=seed % 3 == 0)
        exact = solve(dense(problem))
        for given in (problem, as_array(problem)):
            found = solve(given)
            assert_same(found, exact)
            assert found.method == "modal" or given is not problem  # a dense method where V has as many columns
            assert found.certificate.worst <= 1e-10


@pytest.mark.parametrize("pairs", range(1, 9))
def test_every_number_of_pairs_columns_and_modes(pairs: int) -> None:
    for columns in (1, 6):
        for modes in (0, 1, 24):
            problem = shared_problem(100 + pairs, pairs=pairs, columns=columns, modes=modes, longest=12)
            exact = solve(dense(problem))
            assert_same(solve(problem), exact, 1e-11)


@pytest.mark.parametrize("signs", [False, True])
def test_supports_a_thousand_times_softer_than_teeth(signs: bool) -> None:
    for seed in range(5):
        problem = shared_problem(seed, softness=1e3, signs=signs, modes=6, alike=True, longest=16)
        exact = solve(dense(problem))
        found = solve(problem)
        assert_same(found, exact)
        assert found.certificate.worst <= 1e-9


def test_several_problems_go_together() -> None:
    """Of different numbers of pairs, columns and modes, some of them without any."""
    given = [shared_problem(seed, modes=seed % 4 * 3) for seed in range(12)]
    for found, problem in zip(solve_many(given), given, strict=True):
        assert found.method == "modal"
        assert_same(found, solve(dense(problem)))


def test_arrays_are_solved_as_one_by_one() -> None:
    problem = shared_problem(7, pairs=3, columns=6, modes=6)
    gaps = problem.separation + 1e-3 * np.random.default_rng(0).random((5, problem.size))
    torques = np.geomspace(1e3, 1e7, 5)
    together = solve_many(problem, separation=gaps, torque=torques)
    for row in range(5):
        alone = ContactProblem(gaps[row], problem.lever_arm, torques[row], problem.compliance_matrix)
        assert np.array_equal(together.force[row], solve(alone).force)
        assert np.abs(together.force[row] - solve(dense(alone)).force).max() <= 1e-11 * together.force[row].max()


@pytest.mark.parametrize(("modes", "longest"), [(6, 150), (36, 80)])
def test_steps_do_not_grow_with_the_segments(modes: int, longest: int) -> None:
    steps = []
    for seed in range(2):
        problem = shared_problem(seed, pairs=6, columns=6, modes=modes, longest=-longest, torque=1e6)
        found = linear_answer(problem)
        assert found is not None
        assert found.answer.certificate.worst <= 1e-12
        steps.append(found.iterations)
    assert np.mean(steps) <= 6.0


# Line contact


@pytest.mark.parametrize(("modes", "softness"), [(1, 50.0), (6, 1.0), (24, 1e-12), (24, 50.0)])
def test_line_contact_is_that_of_exact_programmes(modes: int, softness: float) -> None:
    bendings, contacts = [], []
    for seed in (2, 3):
        given = shared_problem(seed, columns=6, modes=modes, softness=softness, torque=10.0 ** (4 + seed % 3))
        nothing = np.zeros(given.size)
        basis = basis_of(given)
        bendings.append(ContactProblem.of_modes(given.separation, given.lever_arm, given.torque, nothing, basis))
        contacts.append(line_contact_of(given.size, seed))
    for bending, contact in zip(bendings, contacts, strict=True):
        other, _ = solve_on_bending(bending, contact)
        assert bending.modal_basis is not None
        found = line_contact_answers([bending], contact.parameters)[0]
        assert found is not None
        force = found.answer.force
        assert found.answer.certificate.worst <= 1e-11
        assert np.abs(force - other.force).max() <= 1e-10 * force.max()
        assert found.answer.elastic_rotation == pytest.approx(other.elastic_rotation, rel=1e-11)
        stiffness = touching_stiffness(contact.tangent(force), bending.modal_basis, bending.lever_arm, force > 0.0)
        assert found.stiffness == pytest.approx(stiffness, rel=1e-9)


def test_line_contact_is_that_of_programmes_on_the_dense_matrix() -> None:
    for seed in range(3):
        given = shared_problem(seed, pairs=3, columns=6, modes=6, longest=12, torque=1e6)
        nothing, contact = np.zeros(given.size), line_contact_of(given.size, seed)
        parts = given.separation, given.lever_arm, given.torque
        bending = ContactProblem.of_modes(*parts, nothing, basis_of(given))
        whole = dense(bending)
        exact, _ = solve_on_bending(whole, contact)
        found = line_contact_answers([bending], contact.parameters)[0]
        assert found is not None
        assert np.abs(found.answer.force - exact.force).max() <= 1e-11 * exact.force.max()
        assert found.answer.elastic_rotation == pytest.approx(exact.elastic_rotation, rel=1e-11)


# Proof


def test_certificate_of_the_compiled_code_is_that_of_the_plain_one() -> None:
    """Also for answers that are wrong in every way."""
    rng = np.random.default_rng(3)
    for seed in range(8):
        problem = shared_problem(seed, softness=10.0 ** rng.uniform(-6.0, 3.0))
        right = solve(problem)
        found = linear_answer(problem)
        if found is not None:
            given = found.answer.certificate
            expected = exact_residuals(problem, found.answer.force, found.answer.elastic_rotation)
            assert given.worst <= 1e-9 or not given.passes()
            off = np.abs(found.answer.gap - expected.gap).max()
            assert off <= given.resolution * max(problem.deflection(found.answer.force).max(), expected.gap.max())
        for spoil in (1e-9, 1e-3, 1.0):
            force = right.force * (1.0 + spoil * rng.standard_normal(problem.size))
            elastic = right.elastic_rotation * (1.0 + spoil * rng.standard_normal())
            numbers, other = compiled_certificate(problem, force, elastic)
            assert numbers[:5] == pytest.approx(other.violations, rel=1e-6, abs=1e-14)


def test_terms_that_cancel_in_the_shared_modes_widen_the_bound() -> None:
    """Wrenches about a far point: what a block keeps of W is the small difference of large terms."""
    problem = shared_problem(6, pairs=3, columns=6, modes=0, longest=-20)
    basis, rng = basis_of(problem), np.random.default_rng(1)
    near = rng.standard_normal((problem.size, 2))
    resolution = []
    for far in (0.0, 1e3, 1e6):
        columns = np.column_stack([near[:, 0], near[:, 1] + far * near[:, 0]])
        mixing = rng.standard_normal((3, 2, 5)) * 1e-3
        mixing[:, 0] -= far * mixing[:, 1]
        given = ContactProblem.of_modes(
            problem.separation, problem.lever_arm, problem.torque, problem.compliance[0],
            with_shared_modes(basis, columns, mixing),
        )  # fmt: skip
        found = linear_answer(given)
        assert found is not None
        exact = exact_residuals(given, found.answer.force, found.answer.elastic_rotation)
        certificate = found.answer.certificate
        scale = float(given.deflection(found.answer.force) @ found.answer.force / found.answer.force.sum())
        assert np.abs(exact.gap - found.answer.gap).max() <= certificate.resolution * scale
        assert_same(solve(given), solve(dense(given)), 1e-9)
        resolution.append(certificate.resolution)
    assert resolution[0] < 1e-10


# Parametric


def test_system_of_the_touching_segments_is_the_dense_one() -> None:
    rng = np.random.default_rng(5)
    for seed in range(12):
        problem = shared_problem(seed, signs=seed % 2 == 1, alike=seed % 3 == 0)
        active = rng.random(problem.size) < 0.5
        active[np.argmax(problem.lever_arm)] = True
        modal = ModalTouching(problem.compliance[0], basis_of(problem), problem.lever_arm, active)
        exact = DenseTouching(problem.dense_compliance, problem.lever_arm, active)
        for _ in range(4):
            closing, torque = 1e-3 * rng.standard_normal((problem.size, 3)), 1e5 * rng.standard_normal(3)
            found, expected = modal.solve(closing, torque), exact.solve(closing, torque)
            for own, other in zip(found, expected, strict=True):
                assert np.abs(own - other).max() <= 1e-11 * max(np.abs(other).max(), 1e-9)
            assert np.abs(modal.yielding() - exact.yielding()).max() <= 1e-12 * problem.compliance_diagonal.max()
            some = rng.integers(0, problem.size, 2)
            assert modal.columns(some) == pytest.approx(exact.columns(some), rel=1e-12, abs=1e-20)
            segment = int(rng.integers(problem.size))
            way = "leave" if modal.active[segment] else "enter"
            assert getattr(modal, way)(segment) == getattr(exact, way)(segment)


def test_torque_path_and_derivatives_of_many_segments() -> None:
    """Beyond the size up to which the dense form is used."""
    problem = shared_problem(11, pairs=4, columns=6, modes=8, longest=-80, torque=1e6)
    path = torque_path(problem, 5e5, 2e6)
    for torque in (6e5, 1.1e6, 1.9e6):
        exact = solve(dense(problem.with_torque(torque)))
        at = path.at(torque)
        assert np.abs(at.force - exact.force).max() <= 1e-10 * exact.force.max()
    slope = sensitivity(problem, solve(problem))
    rng = np.random.default_rng(0)
    change = rng.standard_normal(problem.compliance[1].shape) * 1e-3 * np.abs(problem.compliance[1]).max()
    found = slope.forward(factor=change)
    step = 1e-4
    ends = []
    for sign in (-1.0, 1.0):
        moved = (problem.compliance[0], problem.compliance[1] + sign * step * change)
        ends.append(solve(ContactProblem(problem.separation, problem.lever_arm, problem.torque, moved)))
    rotation = (ends[1].rotation - ends[0].rotation) / (2.0 * step)
    assert found.rotation == pytest.approx(rotation, rel=1e-5)
    gradient = slope.adjoint(rotation=1.0).factor
    assert gradient is not None
    assert float(np.sum(gradient * change)) == pytest.approx(found.rotation, rel=1e-9)


# Forms and files


@pytest.mark.parametrize("name", BACKENDS)
def test_backends_take_the_shared_modes(name: str) -> None:
    installed(name)
    forms = ("dense", "lifted") if name in LIFTING else ("dense",)
    for seed in (0, 2):
        problem = shared_problem(seed, pairs=2 + seed, columns=6, modes=6, longest=10, torque=1e6)
        exact = solve(dense(problem))
        for form in forms:
            settings: dict[str, Any] = {"form": form} if form == "lifted" else {}
            found = solve(problem, name, polish=True, **settings)
            assert_same(found, exact, 1e-9)


def test_lifted_dual_and_complementarity_forms_have_them() -> None:
    problem = shared_problem(3, pairs=2, columns=3, modes=2, longest=8, torque=1e5)
    exact, rank = solve(problem), problem.compliance[1].shape[1]
    assert lifted_qp(problem).programme.P.shape[0] == problem.size + rank
    assert dual_qp(problem).programme.P.shape[0] == problem.size + rank + 1
    form = lcp(problem)
    result = lemke(form.matrix, form.vector)
    answer = form.recover(result.z)
    assert np.abs(answer.force - exact.force).max() <= 1e-10 * exact.force.max()


def test_files_give_the_identical_problem_back(tmp_path: Path) -> None:
    problem = shared_problem(9, pairs=3, columns=6, modes=6, longest=-15)
    write_npz(problem, tmp_path / "a.npz")
    export_problems([problem], tmp_path / "a.nc")
    read = import_problems(tmp_path / "a.nc").problems[0]
    for again in (ContactProblem.from_dataset(problem.to_dataset()), read_npz(tmp_path / "a.npz"), read):
        assert again.identical(problem)
        basis = basis_of(again)
        assert basis.shared is not None
        assert len(basis.blocks) == 3
        assert_same(solve(again), solve(problem), 1e-11)
    write_qps(problem, tmp_path / "a.qps")
    assert read_qps(tmp_path / "a.qps").identical(problem)


def test_basis_of_blocks_keeps_its_blocks() -> None:
    own = basis_of_blocks(4, [np.array([0, 1]), np.array([2, 3])], [np.ones((2, 1)), np.ones((2, 2))])
    shared = with_shared_modes(own, np.ones((4, 1)), np.ones((2, 1, 1)))
    assert [modes.shape for _, modes in shared.blocks] == [(2, 1), (2, 2)]
