"""The modal method: its blocks, its line search, its answers beside those of all other methods, one or many at once."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise
from typing import Any

import kernels
import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from runs import small
from shared_problems import basis_of, line_contact_of

import easeoff.contact.loaded as loaded_module
from easeoff import InputError
from easeoff.contact import ContactProblem, ContactSolution, Material, Status, available_solvers, solve, solve_many
from easeoff.contact.compliance.weber_line_contact import WeberLineContact
from easeoff.contact.line_contact.line_contact_solution import solve_on_bending
from easeoff.contact.loaded import LoadedCase
from easeoff.contact.problem.compliance_matrix import ModalCompliance
from easeoff.contact.problem.modal_basis import block_labels, modal_basis
from easeoff.contact.solvers import problem_batch
from easeoff.contact.solvers.compiled import compiled_answer
from easeoff.contact.solvers.compiled.compiled_answer import (
    SMALLEST_LOCAL_FRACTION,
    line_contact_answers,
    scaled_answer,
)
from easeoff.contact.solvers.compiled.line_deflection import pressed
from easeoff.contact.solvers.native import METHODS
from easeoff.study import CaseInMesh
from easeoff.study.analysis.contact_analysis import contact_analysis
from easeoff.verification import problems
from easeoff.verification.problem_classes import PROBLEM_CLASSES

Array = NDArray[np.float64]

#: Classes in which every segment has a compliance of its own that counts.
MODAL_CLASSES = tuple(
    name for name in PROBLEM_CLASSES if name not in ("weak_local", "nearly_singular", "spread_local", "random_dense")
)


#: Of the pinion in analyses [N m].
TORQUES = [50.0, 200.0]


def rebuilt(factor: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """U U^T of the compressed blocks."""
    basis, size = modal_basis(factor), factor.shape[0]
    dense = np.zeros((size + 1, size + 1))
    for index, modes in zip(basis.index, basis.modes, strict=True):
        dense[np.ix_(index, index)] += modes @ modes.T
    return dense[:size, :size]


def is_modal(problem: ContactProblem) -> bool:
    """Whether every segment has a compliance of its own that counts."""
    matrix = problem.compliance_matrix
    return isinstance(matrix, ModalCompliance) and matrix.local_fraction > SMALLEST_LOCAL_FRACTION


def relative_difference(problem: ContactProblem, method: str, other: ContactSolution) -> tuple[float, float]:
    """Greatest difference of a force over the greatest force, and of the elastic rotations."""
    solution = solve(problem, method=method)
    assert solution.status is Status.CERTIFIED
    assert other.status is Status.CERTIFIED
    force = float(np.abs(solution.force - other.force).max() / other.force.max())
    return force, abs(solution.elastic_rotation / other.elastic_rotation - 1.0)


@cache
def in_mesh(name: str) -> CaseInMesh:
    """A small shipped case on shells."""
    return CaseInMesh.of(small(name, "shell"))


@cache
def analysed(name: str) -> list[LoadedCase]:
    """Its problems at two torques, solved."""
    return contact_analysis(in_mesh(name), TORQUES).cases


# Blocks


@given(
    st.lists(st.tuples(st.integers(1, 9), st.integers(0, 6)), min_size=1, max_size=5),
    st.integers(0, 2**32 - 1),
)
def test_blocks_of_a_shuffled_factor_are_found_again(shapes: list[tuple[int, int]], seed: int) -> None:
    rng = np.random.default_rng(seed)
    size, width = (sum(shape[i] for shape in shapes) for i in (0, 1))
    factor, owner, column = np.zeros((size, width)), np.empty(size, dtype=int), 0
    row = 0
    for number, (height, breadth) in enumerate(shapes):
        factor[row : row + height, column : column + breadth] = rng.uniform(0.5, 1.0, (height, breadth))
        owner[row : row + height] = number if breadth else -1  # rows of zeros go together
        row, column = row + height, column + breadth
    order = rng.permutation(size)
    factor, owner = factor[order][:, rng.permutation(width)], owner[order]
    found = block_labels(factor).blocks
    assert len(found) == len(set(owner))
    assert sorted(np.concatenate([rows for rows, _ in found])) == list(range(size))
    for rows, columns in found:
        assert len(set(owner[rows])) == 1
        assert not np.delete(factor[rows], columns, axis=1).any()
    exact = factor @ factor.T
    assert np.abs(rebuilt(factor) - exact).max() <= 1e-14 * max(exact.max(), 1e-300)


def test_blocks_joined_by_one_entry_are_one() -> None:
    factor = np.kron(np.eye(3), np.ones((4, 2))).astype(np.float64)
    assert len(block_labels(factor).blocks) == 3
    factor[0, 2] = 1e-300
    assert [rows.size for rows, _ in block_labels(factor).blocks] == [8, 4]
    chain = (np.eye(50) + np.eye(50, k=1)).astype(np.float64)
    assert len(block_labels(chain).blocks) == 1


@pytest.mark.parametrize("size", [10, 60, 500])
def test_smooth_modes_along_a_line_have_a_small_rank(size: int) -> None:
    """Eighty products of polynomials of degree up to 7 in x and 6 in y = y(x): no more than 14 functions of x."""
    x = np.linspace(-1.0, 1.0, size)
    height = 0.5 + 0.4 * x
    factor = np.stack([x**i * height ** (2 + j) for i in range(8) for j in range(5)] * 2, axis=1)
    modes = modal_basis(factor).modes
    assert modes.shape[2] <= min(size, 14)
    exact = factor @ factor.T
    assert np.abs(rebuilt(factor) - exact).max() <= 1e-14 * exact.max()


def test_basis_is_kept_when_torque_or_local_compliance_change() -> None:
    problem = next(problems("realistic", 1))
    basis = problem.modal_basis
    assert problem.with_torque(1.0).modal_basis is basis
    assert problem.with_added_compliance(np.full(problem.size, 1e-6)).modal_basis is basis


# Answers


@pytest.mark.parametrize("name", MODAL_CLASSES)
def test_modal_method_agrees_with_the_dense_one(name: str) -> None:
    for problem in problems(name, 12, seed=21):
        force, rotation = relative_difference(problem, "modal", solve(problem, method="primal_dual_active_set"))
        assert force < 1e-11
        assert rotation < 1e-13


@given(st.sampled_from(MODAL_CLASSES), st.integers(0, 10**6), st.floats(-2.0, 2.0))
def test_modal_method_proves_any_load(name: str, seed: int, decades: float) -> None:
    problem = next(problems(name, 1, seed))
    problem = problem.with_torque(problem.torque * 10.0**decades)
    solution = solve(problem, method="modal")
    assert solution.status is Status.CERTIFIED
    assert solution.certificate.worst < 1e-12
    assert solution.iterations <= 15


@pytest.mark.parametrize("backend", ["clarabel", "daqp"])
def test_modal_method_agrees_with_other_programs(backend: str) -> None:
    assert backend in available_solvers()
    for name in ("realistic", "plain", "signed_modes", "far_apart"):
        for problem in problems(name, 5, seed=4):
            force, rotation = relative_difference(problem, "modal", solve(problem, backend))
            assert force < 1e-11
            assert rotation < 1e-13


@pytest.mark.parametrize("name", ["fm-11x41", "nasa-12x36"])
def test_modal_method_agrees_on_the_shipped_cases(name: str) -> None:
    for loaded in analysed(name):
        problem = loaded.problem
        basis = problem.modal_basis
        assert basis is not None
        assert len(basis.blocks) == len(set(loaded.segments.pair))
        force, rotation = relative_difference(problem, "modal", solve(problem, method="primal_dual_active_set"))
        assert force < 1e-11
        assert rotation < 1e-13
        assert np.abs(solve(problem).force - loaded.solution.force).max() < 1e-9 * loaded.solution.force.max()


@pytest.mark.parametrize("method", METHODS)
def test_every_native_method_serves_an_analysis(method: str) -> None:
    chosen = contact_analysis(in_mesh("fm-11x41"), TORQUES[:1], solver="native", method=method).cases
    usually = [one for one in analysed("fm-11x41") if one.torque == 0]
    for found, usual in zip(chosen, usually, strict=True):
        assert found.solution.certified
        assert found.solution.method == method
        assert found.solution.rotation == pytest.approx(usual.solution.rotation, rel=1e-13)


def test_one_segment_carries_all() -> None:
    """F = T / r, theta = (S + C F) / r."""
    problem = ContactProblem(np.array([0.3]), np.array([20.0]), 100.0, (np.array([1e-5]), np.array([[2e-3, 1e-3]])))
    solution = solve(problem, method="modal")
    assert solution.force[0] == pytest.approx(5.0, rel=1e-15)
    assert solution.rotation == pytest.approx((0.3 + 5.0 * 1.5e-5) / 20.0, rel=1e-15)


@pytest.mark.parametrize("width", [0, 3])
def test_springs_without_coupling_share_the_load_evenly(width: int) -> None:
    n, arm, torque, spring = 8, 40.0, 3.2e5, 2e-6
    problem = ContactProblem(np.zeros(n), np.full(n, arm), torque, (np.full(n, spring), np.zeros((n, width))))
    solution = solve(problem, method="modal")
    assert solution.force == pytest.approx(np.full(n, torque / (n * arm)), rel=1e-14)
    assert solution.rotation == pytest.approx(spring * torque / (n * arm**2), rel=1e-14)


def test_segment_doubled_into_two_halves_changes_nothing() -> None:
    """Two segments in one place, each with twice the local compliance, carry half the load each."""
    for problem in problems("realistic", 5, seed=8):
        assert isinstance(problem.compliance, tuple)
        twice = np.repeat(np.arange(problem.size), 2)
        local, factor = problem.compliance
        double = ContactProblem(
            problem.separation[twice], problem.lever_arm[twice], problem.torque, (2.0 * local[twice], factor[twice])
        )
        one, two = solve(problem, method="modal"), solve(double, method="modal")
        assert two.rotation == pytest.approx(one.rotation, rel=1e-13)
        assert np.abs(2.0 * two.force - one.force[twice]).max() < 1e-11 * one.force.max()


def test_any_start_leads_to_the_same_answer() -> None:
    rng = np.random.default_rng(12)
    for problem in problems("realistic", 5, seed=1):
        reference = solve(problem, method="modal")
        warm = solve(problem, method="modal", initial_active=reference.active)
        assert warm.iterations == 1
        starts = [np.zeros(problem.size, bool), np.ones(problem.size, bool), rng.random(problem.size) < 0.5]
        for start in [reference.active, *starts]:
            start.setflags(write=False)
            solution = solve(problem, method="modal", initial_active=start)
            assert solution.rotation == pytest.approx(reference.rotation, rel=1e-14)
            assert np.abs(solution.force - reference.force).max() < 1e-13 * reference.force.max()


def test_springs_pressed_against_each_other_without_torque() -> None:
    """Full steps go to and fro between the two springs, at the same energy; the line search meets in the middle."""
    compliance = (np.full(2, 1e-6), np.zeros((2, 1)))
    problem = ContactProblem(np.array([0.0, -0.1]), np.array([40.0, -40.0]), 0.0, compliance)
    solution = solve(problem, method="modal")
    assert solution.status is Status.CERTIFIED
    assert solution.force == pytest.approx(np.array([5e4, 5e4]), rel=1e-14)
    assert solution.rotation == pytest.approx(0.05 / 40.0, rel=1e-14)


@pytest.mark.parametrize("magnitude", [1e-300, 1e-160, 1e160, 1e300])
def test_absurd_magnitudes_change_nothing(magnitude: float) -> None:
    compliance = (np.full(2, magnitude), np.full((2, 1), np.sqrt(magnitude)))
    for torque in (1e-300, 1e5, 1e306):
        problem = ContactProblem(np.array([0.1, 0.3]), np.full(2, 40.0), torque, compliance)
        solution = solve(problem)
        assert solution.certified or np.isnan(solution.force).all()


# Line search


def test_line_search_ends_what_full_steps_do_not(monkeypatch: pytest.MonkeyPatch) -> None:
    """With little local compliance full steps can go round in circles: one of 400 random problems does."""
    source = kernels.in_python("easeoff.contact.solvers.compiled.newton_kernel")
    given = list(problems("weak_local", 400, seed=1))
    for number, problem in enumerate(given):
        scaled, start = problem.scaled(), problem.scaling.estimated_active
        if is_modal(problem):
            assert scaled_answer(scaled, start) is not None
        if number == 317:
            with monkeypatch.context() as patch, np.errstate(all="ignore"):
                patch.setattr(compiled_answer, "solve_batch", source.solve_batch)
                patch.setattr(source, "MAX_HALVINGS", 0)
                assert scaled_answer(scaled, start) is None


# Where it has no place


def test_tiny_local_compliance_is_left_to_the_other_methods() -> None:
    for problem in problems("nearly_singular", 10, seed=2):
        assert not is_modal(problem)
        solution = solve(problem)
        assert solution.status is Status.CERTIFIED
        assert solution.method != "modal"
        assert solve(problem, method="modal").status is Status.NOT_CONVERGED


def test_rigid_segment_is_left_to_the_other_methods() -> None:
    """Two springs, one rigid: it carries all until the torque has closed the gap of the other."""
    compliance = (np.array([0.0, 1e-6]), np.zeros((2, 1)))
    problem = ContactProblem(np.zeros(2), np.array([40.0, 40.0]), 1e5, compliance)
    assert solve(problem).force == pytest.approx(np.array([2500.0, 0.0]))


def test_blocks_of_very_different_size() -> None:
    """One block of many modes among many of one."""
    rng = np.random.default_rng(0)
    factor = np.zeros((200, 200))
    factor[:100, :100] = rng.standard_normal((100, 100)) * 1e-4
    factor[100:, 100:] = np.eye(100) * 1e-3
    problem = ContactProblem(np.zeros(200), np.full(200, 40.0), 1e5, (np.full(200, 1e-6), factor))
    assert relative_difference(problem, "modal", solve(problem, method="primal_dual_active_set")) < (1e-11, 1e-13)


def test_matrix_is_never_formed(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(compliance: ModalCompliance) -> None:
        raise AssertionError("the dense compliance was asked for")

    monkeypatch.setattr(ModalCompliance, "dense", property(refuse))
    for problem in problems("realistic", 3):
        assert solve(problem, method="modal").status is Status.CERTIFIED


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("size", [60, 480])
def test_modes_come_first(size: int, compressed: bool) -> None:
    along = np.linspace(-1.0, 1.0, size)
    factor = np.asarray(1e-3 * np.polynomial.legendre.legvander(along, 5), dtype=np.float64)
    gap, arm, local = 0.01 * along**2, np.full(size, 40.0), np.full(size, 1e-6)
    problem = ContactProblem(gap, arm, 1e5, (local, factor))
    if compressed:
        problem = ContactProblem.of_modes(gap, arm, 1e5, local, modal_basis(factor))
    solution = solve(problem)
    assert solution.certified
    assert solution.method == "modal"
    assert problem.modal_basis is not None
    assert solve(problem).method == "modal"  # whatever has been computed before


# Many at once


def structured(count: int, seed: int = 0) -> list[ContactProblem]:
    return [*problems("plain", count, seed), *problems("signed_modes", count, seed)]


@pytest.mark.parametrize("name", PROBLEM_CLASSES)
def test_every_kind_of_problem_has_the_answer_of_solve(name: str) -> None:
    given = list(problems(name, 15, 7))
    for problem, found in zip(given, solve_many(given), strict=True):
        alone = solve(problem)
        assert found.status is alone.status
        if found.certified:
            assert found.certificate.worst <= 1e-9
            assert found.rotation == pytest.approx(alone.rotation, rel=1e-9)


def test_many_problems_may_come_from_a_generator() -> None:
    given = structured(2)
    starts = (None for _ in given)
    found = solve_many((problem for problem in given), initial_active=starts)
    assert [one.rotation for one in found] == [one.rotation for one in solve_many(given)]
    for wrong in (5, [given[0], 5], "problems"):
        with pytest.raises(InputError, match=r"problems = .*: must be a ContactProblem"):
            solve_many(wrong)  # type: ignore[arg-type]


def test_solutions_of_many_can_be_had_one_by_one() -> None:
    problem = structured(1)[0]
    torques = [problem.torque, 0.5 * problem.torque]
    many = solve_many(problem, torque=torques)
    assert len(list(many)) == 2
    for row, (one, torque) in enumerate(zip(many, torques, strict=True)):
        assert one.certified
        assert one.problem is not None
        assert one.problem.torque == torque
        assert one.force.tolist() == many.force[row].tolist()
        assert one.sensitivity().forward(torque=1.0).rotation > 0.0
    assert many[-1].rotation == many.rotation[1]
    rigid = ContactProblem([0.1, -0.3], [40.0, 0.0], 10.0, np.diag([1e-6, 0.0]))
    assert [one.status for one in solve_many(rigid)] == [Status.UNBOUNDED]


def test_the_common_kinds_need_no_other_method(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any, **__: Any) -> None:
        raise AssertionError("solved one by one")

    monkeypatch.setattr(problem_batch, "solve", refuse)
    for name in ("plain", "touching", "duplicated", "light_load", "heavy_load", "far_apart", "interfering"):
        assert all(found.certified for found in solve_many(list(problems(name, 60, 3))))


def test_answers_come_in_order_whatever_the_form() -> None:
    given = structured(3)
    dense = [ContactProblem(p.separation, p.lever_arm, p.torque, p.dense_compliance) for p in given]
    idle = given[0].with_torque(0.0)
    mixed = [dense[2], given[0], idle, given[1], dense[1]]
    for problem, found in zip(mixed, solve_many(mixed), strict=True):
        assert found.rotation == pytest.approx(solve(problem).rotation, rel=1e-12, abs=1e-15)
    assert solve_many([]) == []


def test_company_changes_nothing() -> None:
    """A problem is not touched by those that stand beside it, larger, smaller or without an answer yet."""
    given = structured(20)
    together = solve_many(given)
    for problem, found in zip(given, together, strict=True):
        alone = solve_many([problem])[0]
        assert np.abs(found.force - alone.force).max() <= 1e-13 * alone.force.max()


def test_any_start_of_many_leads_to_the_same_answer() -> None:
    given = structured(10)
    right = solve_many(given)
    rng = np.random.default_rng(0)
    wrong = solve_many(given, initial_active=[rng.random(p.size) < 0.3 for p in given])
    none = solve_many(given, initial_active=[np.zeros(p.size, dtype=bool) for p in given])
    for a, b, c in zip(right, wrong, none, strict=True):
        assert np.abs(a.force - b.force).max() <= 1e-12 * a.force.max()
        assert np.abs(a.force - c.force).max() <= 1e-12 * a.force.max()


def test_warm_starts_are_checked() -> None:
    given = structured(1)
    with pytest.raises(InputError, match="initial_active = 1 sets: must be 2"):
        solve_many(given, initial_active=[None])
    with pytest.raises(InputError, match="shape"):
        solve_many(given, initial_active=[None, np.zeros(10_000, dtype=bool)])


# Local laws


def test_line_contact_converges_quadratically(monkeypatch: pytest.MonkeyPatch) -> None:
    """The residual falls by the square from step to step once it is small."""
    source = kernels.in_python("easeoff.contact.solvers.compiled.newton_kernel")
    seen: list[float] = []
    honest = source._residual

    def noted(*arguments: Any) -> float:
        seen.append(honest(*arguments))
        return seen[-1]

    monkeypatch.setattr(source, "_residual", noted)
    monkeypatch.setattr(compiled_answer, "solve_batch", source.solve_batch)
    for problem in problems("realistic", 3, 2):
        bending = ContactProblem.of_modes(
            problem.separation, problem.lever_arm, problem.torque, np.zeros(problem.size), basis_of(problem)
        )
        with np.errstate(all="ignore"):
            (found,) = line_contact_answers([bending], line_contact_of(problem.size, 2, edges=False).parameters)
        assert found is not None
        assert found.iterations <= 20
    for before, after in pairwise(seen):
        if before < 1e-5 and after < before:
            assert after <= max(1e6 * before**2, 1e-12)


def test_line_contact_is_inverted_over_all_decades() -> None:
    steel = Material(206000.0, 0.3)
    count = 200
    contact = WeberLineContact(
        np.full(count, 1.3), np.full(count, 40.0), np.full(count, 2.0), np.full(count, 3.0), steel, steel
    )
    force = np.geomspace(1e-9, 1e6, count)
    indentation = contact.deflection(force)
    found, stiffness = np.array([pressed(contact.parameters, i, own, 100.0) for i, own in enumerate(indentation)]).T
    assert np.abs(found / force - 1.0).max() < 1e-13
    assert np.abs(stiffness * contact.tangent(force) - 1.0).max() < 1e-7


@pytest.mark.parametrize("name", ["fm-11x41", "nasa-12x36"])
def test_loaded_analysis_agrees_with_exact_programmes_one_by_one(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two methods: modes with the law inverted, and a sequence of quadratic programmes on the dense matrix."""
    together = analysed(name)

    def one_by_one(given: Any, contacts: Any, torques: Any, *_: Any) -> list[Any]:
        pairs = list(zip(given, contacts, strict=True))
        return [[solve_on_bending(one.with_torque(torque), contact) for one, contact in pairs] for torque in torques]

    monkeypatch.setattr(loaded_module, "solve_at_torques", one_by_one)
    for found, exact in zip(together, contact_analysis(in_mesh(name), TORQUES).cases, strict=True):
        assert found.solution.message.startswith("modal")
        assert exact.solution.message.endswith("linear problems")
        assert (found.torque, found.mesh_position) == (exact.torque, exact.mesh_position)
        assert np.abs(found.solution.force - exact.solution.force).max() <= 1e-12 * exact.solution.force.max()
        assert found.solution.rotation == pytest.approx(exact.solution.rotation, rel=1e-13)


def test_basis_knows_its_factor() -> None:
    for problem in structured(5):
        basis = problem.modal_basis
        assert basis is not None
        again = ContactProblem.of_modes(
            problem.separation, problem.lever_arm, problem.torque, problem.compliance[0], basis
        )
        largest = np.abs(problem.dense_compliance).max()
        assert np.abs(again.dense_compliance - problem.dense_compliance).max() <= 1e-14 * largest
        assert again.modal_basis is basis
        assert replace(basis).factor.shape == (problem.size, np.count_nonzero(basis.modes.any(axis=1)))
