"""The modal method: the blocks it finds, its line search, and its answers beside those of all other methods."""

from __future__ import annotations

import importlib.util
import sys
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from easeoff.cases import read_case
from easeoff.contact.problem.contact_problem import ContactProblem
from easeoff.contact.problem.modal_basis import factor_blocks, modal_basis
from easeoff.contact.solvers import ContactSolution, Status, available_solvers, modal_newton, native, solve
from easeoff.contact.solvers.modal_system import ModalPoint, has_modal_form, modal_system
from easeoff.study.analysis import contact_analysis
from easeoff.study.case_in_mesh import CaseInMesh
from easeoff.verification.problem_classes import PROBLEM_CLASSES, problems

#: Classes in which every segment has a compliance of its own that counts.
MODAL_CLASSES = tuple(
    name for name in PROBLEM_CLASSES if name not in ("weak_local", "nearly_singular", "spread_local", "random_dense")
)
HAS_NUMBA = importlib.util.find_spec("numba") is not None


@pytest.fixture(params=["arrays", "compiled"])
def path(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Both forms of the method; the compiled one where numba is installed."""
    if request.param == "compiled" and not HAS_NUMBA:
        pytest.skip("numba is not installed")
    if request.param == "arrays":
        monkeypatch.setattr(modal_newton, "compiled_kernel", lambda: None)
    return str(request.param)


def rebuilt(factor: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """U U^T of the compressed blocks."""
    basis, size = modal_basis(factor), factor.shape[0]
    dense = np.zeros((size + 1, size + 1))
    for index, modes in zip(basis.index, basis.modes, strict=True):
        dense[np.ix_(index, index)] += modes @ modes.T
    return dense[:size, :size]


def relative_difference(problem: ContactProblem, method: str, other: ContactSolution) -> tuple[float, float]:
    """Greatest difference of a force over the greatest force, and of the elastic rotations."""
    solution = solve(problem, method=method)
    assert solution.status is Status.CERTIFIED
    assert other.status is Status.CERTIFIED
    force = float(np.abs(solution.force - other.force).max() / other.force.max())
    return force, abs(solution.elastic_rotation / other.elastic_rotation - 1.0)


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
    found = factor_blocks(factor)
    assert len(found) == len(set(owner))
    assert sorted(np.concatenate([rows for rows, _ in found])) == list(range(size))
    for rows, columns in found:
        assert len(set(owner[rows])) == 1
        assert not np.delete(factor[rows], columns, axis=1).any()
    exact = factor @ factor.T
    assert np.abs(rebuilt(factor) - exact).max() <= 1e-14 * max(exact.max(), 1e-300)


def test_blocks_joined_by_one_entry_are_one() -> None:
    factor = np.kron(np.eye(3), np.ones((4, 2))).astype(np.float64)
    assert len(factor_blocks(factor)) == 3
    factor[0, 2] = 1e-300
    assert [rows.size for rows, _ in factor_blocks(factor)] == [8, 4]
    chain = (np.eye(50) + np.eye(50, k=1)).astype(np.float64)
    assert len(factor_blocks(chain)) == 1


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
def test_modal_method_agrees_with_the_dense_one(name: str, path: str) -> None:
    for problem in problems(name, 30, seed=21):
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
def test_modal_method_agrees_with_other_programs(backend: str, path: str) -> None:
    assert backend in available_solvers()
    for name in ("realistic", "plain", "signed_modes", "far_apart"):
        for problem in problems(name, 5, seed=4):
            force, rotation = relative_difference(problem, "modal", solve(problem, backend))
            assert force < 1e-11
            assert rotation < 1e-13


@pytest.mark.parametrize("name", ["fm-11x41", "nasa-12x36"])
def test_modal_method_agrees_on_the_shipped_cases(name: str, path: str) -> None:
    case = read_case(name)
    case = case.model_copy(update={"contact": case.contact.model_copy(update={"mesh_positions": 3})})
    for loaded in contact_analysis(CaseInMesh.of(case), case.contact.torques[:2]).cases:
        problem = loaded.problem
        assert has_modal_form(problem.scaling.scale(problem))
        assert len(factor_blocks(problem.compliance[1])) == len(set(loaded.segments.pair))
        force, rotation = relative_difference(problem, "modal", solve(problem, method="primal_dual_active_set"))
        assert force < 1e-11
        assert rotation < 1e-13
        assert np.abs(solve(problem).force - loaded.solution.force).max() < 1e-9 * loaded.solution.force.max()


def test_one_segment_carries_all(path: str) -> None:
    """F = T / r, theta = (S + C F) / r."""
    problem = ContactProblem(np.array([0.3]), np.array([20.0]), 100.0, (np.array([1e-5]), np.array([[2e-3, 1e-3]])))
    solution = solve(problem, method="modal")
    assert solution.force[0] == pytest.approx(5.0, rel=1e-15)
    assert solution.rotation == pytest.approx((0.3 + 5.0 * 1.5e-5) / 20.0, rel=1e-15)


@pytest.mark.parametrize("width", [0, 3])
def test_springs_without_coupling_share_the_load_evenly(width: int, path: str) -> None:
    n, arm, torque, spring = 8, 40.0, 3.2e5, 2e-6
    problem = ContactProblem(np.zeros(n), np.full(n, arm), torque, (np.full(n, spring), np.zeros((n, width))))
    solution = solve(problem, method="modal")
    assert solution.force == pytest.approx(np.full(n, torque / (n * arm)), rel=1e-14)
    assert solution.rotation == pytest.approx(spring * torque / (n * arm**2), rel=1e-14)


def test_segment_doubled_into_two_halves_changes_nothing(path: str) -> None:
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


def test_any_start_leads_to_the_same_answer(path: str) -> None:
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


def test_springs_pressed_against_each_other_without_torque(path: str) -> None:
    """Full steps go to and fro between the two springs, at the same energy; the line search meets in the middle."""
    compliance = (np.full(2, 1e-6), np.zeros((2, 1)))
    problem = ContactProblem(np.array([0.0, -0.1]), np.array([40.0, -40.0]), 0.0, compliance)
    solution = solve(problem, method="modal")
    assert solution.status is Status.CERTIFIED
    assert solution.force == pytest.approx(np.array([5e4, 5e4]), rel=1e-14)
    assert solution.rotation == pytest.approx(0.05 / 40.0, rel=1e-14)


@pytest.mark.parametrize("magnitude", [1e-300, 1e-160, 1e160, 1e300])
def test_absurd_magnitudes_change_nothing(magnitude: float, path: str) -> None:
    compliance = (np.full(2, magnitude), np.full((2, 1), np.sqrt(magnitude)))
    for torque in (1e-300, 1e5, 1e306):
        problem = ContactProblem(np.array([0.1, 0.3]), np.full(2, 40.0), torque, compliance)
        solution = solve(problem)
        assert solution.certified or np.isnan(solution.force).all()


# Line search


def energy_along(point: ModalPoint, target: ModalPoint, length: float) -> float:
    return point.system.towards(point, target, length).energy


def test_step_is_the_minimum_along_the_line() -> None:
    """Between random points, against a fine grid: the functional is convex, so its least grid value brackets it."""
    rng = np.random.default_rng(3)
    inside = 0
    for problem in problems("realistic", 40, seed=6):
        scaled = problem.scaling.scale(problem)
        system = modal_system(scaled)
        points = [
            system.point(scale * rng.standard_normal(system.rows[:, 0, :-2].shape), float(rng.uniform(-1.0, 20.0)))
            for scale in (3.0, 1.0)
        ]
        for point, target in (points, points[::-1]):
            length = modal_newton.exact_step(system, point, target)
            grid = [energy_along(point, target, float(at)) for at in np.linspace(0.0, 1.0, 201)]
            least = energy_along(point, target, length)
            assert least <= min(grid) + 1e-12 * abs(min(grid))
            inside += 0.0 < length < 1.0
    assert inside > 10


def test_line_search_ends_what_full_steps_do_not(monkeypatch: pytest.MonkeyPatch) -> None:
    """Full steps are enough on everyday problems; with little local compliance they can go round in circles."""
    searched = 0
    search = modal_newton.exact_step

    def counted(*arguments: Any) -> float:
        nonlocal searched
        searched += 1
        return search(*arguments)

    monkeypatch.setattr(modal_newton, "compiled_kernel", lambda: None)
    monkeypatch.setattr(modal_newton, "exact_step", counted)

    def unsolved(name: str, count: int) -> int:
        scaled = [(p.scaling.scale(p), p.scaling.estimated_active) for p in problems(name, count, seed=1)]
        return sum(modal_newton.modal_newton(s, active) is None for s, active in scaled if has_modal_form(s))

    assert unsolved("realistic", 50) == 0
    assert searched == 0
    assert unsolved("weak_local", 400) == 0
    assert searched > 0
    monkeypatch.setattr(modal_newton, "exact_step", lambda *arguments: 1.0)
    assert unsolved("weak_local", 400) > 0


# Where it has no place


def test_tiny_local_compliance_is_left_to_the_other_methods() -> None:
    for problem in problems("nearly_singular", 10, seed=2):
        assert not has_modal_form(problem.scaling.scale(problem))
        solution = solve(problem)
        assert solution.status is Status.CERTIFIED
        assert solution.message == ""
        assert solve(problem, method="modal").status is Status.NOT_CONVERGED


def test_rigid_segment_is_left_to_the_other_methods() -> None:
    """Two springs, one rigid: it carries all until the torque has closed the gap of the other."""
    compliance = (np.array([0.0, 1e-6]), np.zeros((2, 1)))
    problem = ContactProblem(np.zeros(2), np.array([40.0, 40.0]), 1e5, compliance)
    assert solve(problem).force == pytest.approx(np.array([2500.0, 0.0]))


def test_blocks_of_very_different_size_are_left_to_the_other_methods() -> None:
    """One block of many modes among many of one: padded to one size they would be nearly all zeros."""
    rng = np.random.default_rng(0)
    factor = np.zeros((200, 200))
    factor[:100, :100] = rng.standard_normal((100, 100)) * 1e-4
    factor[100:, 100:] = np.eye(100) * 1e-3
    problem = ContactProblem(np.zeros(200), np.full(200, 40.0), 1e5, (np.full(200, 1e-6), factor))
    assert not has_modal_form(problem.scaling.scale(problem))
    assert solve(problem).status is Status.CERTIFIED


def test_matrix_is_never_formed(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(problem: ContactProblem) -> None:
        raise AssertionError("the dense compliance was asked for")

    monkeypatch.setattr(ContactProblem, "dense_compliance", property(refuse))
    for problem in problems("realistic", 3):
        assert solve(problem, method="modal").status is Status.CERTIFIED


@pytest.mark.parametrize(
    ("size", "compiled", "compressed", "first"),
    [(60, False, True, ""), (60, True, False, ""), (60, True, True, "modal"), (240, False, False, "modal")],
)
def test_what_is_faster_comes_first(
    size: int, compiled: bool, compressed: bool, first: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Calling numpy costs the modal method more than small dense matrices cost the active set."""
    monkeypatch.setattr(native, "compiled_kernel", lambda: object() if compiled else None)
    monkeypatch.setattr(modal_newton, "compiled_kernel", lambda: None)
    along = np.linspace(-1.0, 1.0, size)
    factor = np.asarray(1e-3 * np.polynomial.legendre.legvander(along, 5), dtype=np.float64)
    problem = ContactProblem(0.01 * along**2, np.full(size, 40.0), 1e5, (np.full(size, 1e-6), factor))
    if compressed:
        assert problem.modal_basis is not None
    solution = solve(problem)
    assert solution.certified
    assert solution.message == first


# Compiled


def test_solution_says_which_form_ran(path: str) -> None:
    expected = {"arrays": "modal", "compiled": "modal, compiled"}[path]
    assert solve(next(problems("realistic", 1)), method="modal").message == expected


def test_missing_or_broken_numba_is_no_error(monkeypatch: pytest.MonkeyPatch) -> None:
    modal_newton.compiled_kernel.cache_clear()
    real = importlib.util.find_spec
    with monkeypatch.context() as patch:
        patch.setattr(importlib.util, "find_spec", lambda name: None if name == "numba" else real(name))
        assert solve(next(problems("realistic", 1)), method="modal").message == "modal"
    modal_newton.compiled_kernel.cache_clear()
    with monkeypatch.context() as patch:
        patch.setattr(importlib.util, "find_spec", lambda name: object())
        patch.setitem(sys.modules, "easeoff.contact.solvers.modal_kernel", None)
        assert solve(next(problems("realistic", 1)), method="modal").message == "modal"
    modal_newton.compiled_kernel.cache_clear()


@pytest.mark.skipif(not HAS_NUMBA, reason="numba is not installed")
@pytest.mark.parametrize("name", [*MODAL_CLASSES, "weak_local"])
def test_compiled_form_takes_the_same_steps(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for problem in problems(name, 40, seed=1):
        scaled, start = problem.scaling.scale(problem), problem.scaling.estimated_active
        compiled = modal_newton.modal_newton(scaled, start)
        with monkeypatch.context() as patch:
            patch.setattr(modal_newton, "compiled_kernel", lambda: None)
            arrays = modal_newton.modal_newton(scaled, start)
        if arrays is None or compiled is None:
            assert arrays is compiled
            continue
        assert name == "lattice" or compiled.iterations == arrays.iterations  # rounding decides about its ties
        assert compiled.rotation == pytest.approx(arrays.rotation, rel=1e-13)
        assert np.abs(compiled.force - arrays.force).max() < 1e-11 * arrays.force.max()
