"""Every solver of the contact problem: exact cases, hard cases, agreement, and honesty about failure."""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from outside_problems import (
    KINDS,
    LEAST_OBJECTIVES,
    factor_portfolio,
    maros_meszaros,
    mixture,
    outside_problems,
    overlapping_classes,
    portfolio,
    support_vectors,
)
from solver_choice import installed

from easeoff import EaseoffError, InputError, MissingSolverError
from easeoff.contact import SOLVERS, ContactProblem, ContactSolution, Status, available_solvers, solve
from easeoff.contact.problem.scaled_problem import ScaledProblem
from easeoff.contact.solvers.native import METHODS
from easeoff.contact.solvers.primal_dual_active_set import primal_dual_active_set
from easeoff.contact.solvers.solution import ScaledAnswer, course
from easeoff.contact.solvers.touching_system import DenseTouching
from easeoff.core.errors import how_to_install
from easeoff.verification import problems
from easeoff.verification.problem_classes import PROBLEM_CLASSES

Array = NDArray[np.float64]


def realistic(count: int = 1, seed: int = 0) -> list[ContactProblem]:
    return list(problems("realistic", count, seed))


def residual_in_extended_precision(problem: ContactProblem, solution: ContactSolution) -> float:
    """Natural residual of the conditions, independent of the package's certificate and in 80-bit numbers."""
    wide = np.longdouble
    force = solution.force.astype(wide)
    if isinstance(problem.compliance, tuple):
        diagonal, factor = (part.astype(wide) for part in problem.compliance)
        deflection = diagonal * force + factor @ (factor.T @ force)
    else:
        deflection = problem.compliance.astype(wide) @ force
    gap = deflection + problem.separation_at_first_contact.astype(wide)
    gap -= wide(solution.elastic_rotation) * problem.lever_arm.astype(wide)
    balance = abs(force @ problem.lever_arm.astype(wide) - wide(problem.torque)) / wide(problem.torque)
    natural = np.minimum(force / force.max(), gap / np.abs(deflection).max())
    return float(max(balance, np.abs(natural).max()))


# Exact cases


@pytest.mark.parametrize("name", SOLVERS)
def test_uniform_contact_shares_the_load_evenly(name: str) -> None:
    """n equal uncoupled springs at lever arm R: F = T / nR and theta = c T / nR^2."""
    n, arm, torque, spring = 8, 40.0, 3.2e5, 2e-6
    problem = ContactProblem(np.zeros(n), np.full(n, arm), torque, np.diag(np.full(n, spring)))
    solution = solve(problem, installed(name))
    assert solution.status is Status.CERTIFIED
    assert solution.force == pytest.approx(np.full(n, torque / (n * arm)), rel=1e-12)
    assert solution.rotation == pytest.approx(spring * torque / (n * arm**2), rel=1e-12)
    assert np.abs(solution.gap).max() < 1e-15


@pytest.mark.parametrize("name", SOLVERS)
def test_second_spring_touches_when_the_first_has_yielded_to_its_gap(name: str) -> None:
    """Two springs, the second behind a gap s: it touches above F = s / c, then both take equal shares of the rest."""
    spring, gap, arm = 2e-6, 0.01, 50.0
    touching = gap / spring * arm
    for torque in (0.5 * touching, touching, 3.0 * touching):
        problem = ContactProblem(np.array([0.0, gap]), np.full(2, arm), torque, np.diag([spring, spring]))
        solution = solve(problem, installed(name))
        first = min(torque, 0.5 * (torque + touching)) / arm
        assert solution.force == pytest.approx(np.array([first, torque / arm - first]), rel=1e-7, abs=1e-7 * first)
        assert solution.rotation == pytest.approx(spring * first / arm, rel=1e-7)


def test_one_segment_carries_all() -> None:
    problem = ContactProblem(np.array([0.3]), np.array([20.0]), 100.0, np.array([[1e-5]]))
    solution = solve(problem)
    assert solution.force[0] == 5.0
    assert solution.rotation == pytest.approx((0.3 + 5e-5) / 20.0, rel=1e-15)


# Hard cases


@pytest.mark.parametrize("name", PROBLEM_CLASSES)
def test_native_solver_proves_every_degenerate_problem(name: str) -> None:
    for problem in problems(name, 15, seed=7):
        solution = solve(problem)
        assert solution.status is Status.CERTIFIED
        assert solution.certificate.worst < 1e-10
        assert residual_in_extended_precision(problem, solution) < 1e-10


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ["plain", "duplicated", "lattice", "mixed_arms", "realistic", "random_dense"])
def test_each_native_method_stands_alone(name: str, method: str) -> None:
    if (name, method) == ("random_dense", "modal"):
        pytest.skip("the modal method needs the compliance as diagonal and factor")
    for problem in problems(name, 5, seed=3):
        solution = solve(problem, method=method)
        assert solution.status is Status.CERTIFIED
        assert residual_in_extended_precision(problem, solution) < 1e-10
        assert solution.rotation == pytest.approx(solve(problem).rotation, rel=1e-9)


@pytest.mark.parametrize("name", ["weak_local", "nearly_singular", "spread_local"])
def test_last_method_does_not_need_the_local_compliance(name: str) -> None:
    """Where all but the bending vanishes, moving many segments at once cycles; moving one by one does not."""
    for problem in problems(name, 10, seed=3):
        solution = solve(problem, method="primal_active_set")
        assert solution.status is Status.CERTIFIED
        assert solution.method == "primal_active_set"
        assert residual_in_extended_precision(problem, solution) < 1e-9


@pytest.mark.parametrize(("assets", "observations"), [(7, 3), (40, 20), (60, 30), (150, 100), (200, 20)])
def test_singular_compliances_without_separations(assets: int, observations: int) -> None:
    for seed in range(3):
        problem = portfolio(assets, observations, seed)
        solution = solve(problem)
        assert solution.status is Status.CERTIFIED
        assert residual_in_extended_precision(problem, solution) < 1e-10 or solution.rotation < 1e-14
        other = solve(problem, installed("clarabel"), polish=False, tolerance=1e-6)
        variances = [force @ problem.dense_compliance @ force for force in (solution.force, other.force)]
        assert variances[0] <= variances[1] + 1e-9


@pytest.mark.parametrize("method", ["cascade", "primal_active_set"])
@pytest.mark.parametrize("dimensions", [1, 2, 5])
def test_widest_margin_between_parallel_planes(dimensions: int, method: str) -> None:
    """All points are on the margin: the forces are not unique, but the normal and the offset are."""
    rng = np.random.default_rng(dimensions)
    label = np.where(np.arange(60) % 2, 1.0, -1.0)
    points = np.column_stack([0.25 + 0.5 * label, rng.standard_normal((60, dimensions - 1))])
    solution = solve(support_vectors(points, label, points @ points.T), method=method)
    assert solution.status is Status.CERTIFIED
    normal = (solution.force * label) @ points
    assert normal == pytest.approx([2.0, *[0.0] * (dimensions - 1)], abs=1e-12)
    assert solution.force.sum() == pytest.approx(4.0, rel=1e-12)
    assert solution.rotation == pytest.approx(0.5, rel=1e-12)


@pytest.mark.parametrize("method", ["cascade", "primal_active_set"])
def test_support_vectors_of_points_that_overlap(method: str) -> None:
    points, label, kernel = overlapping_classes(80, seed=4)
    problem = support_vectors(points, label, kernel)
    solution = solve(problem, method=method)
    assert solution.status is Status.CERTIFIED
    assert abs(solution.force @ label) < 1e-11 * solution.force.sum()
    margin = label * (kernel @ (solution.force * label) - solution.rotation)
    assert margin.min() > 1.0 - 1e-10
    np.testing.assert_allclose(margin[solution.force > 0.0], 1.0, rtol=0.0, atol=1e-10)


def test_many_support_vectors_whose_kernel_is_singular_to_rounding() -> None:
    """Neither active set ends on the kernel as given: compliances that are less singular lead there."""
    points, label, kernel = overlapping_classes(600, seed=1)
    assert np.linalg.eigvalsh(kernel)[80] < 1e-9
    solution = solve(support_vectors(points, label, kernel))
    assert solution.status is Status.CERTIFIED
    margin = label * (kernel @ (solution.force * label) - solution.rotation)
    scale = np.abs(kernel @ (solution.force * label)).max()
    assert margin.min() > 1.0 - 1e-8 * scale
    np.testing.assert_allclose(margin[solution.force > 0.0], 1.0, rtol=0.0, atol=1e-8 * scale)


@pytest.mark.parametrize("problem", [factor_portfolio(60, 5, 3), mixture(60, 120, 3), mixture(60, 40, 3)])
def test_shares_that_add_up_to_one(problem: ContactProblem) -> None:
    """Marginal values of what is held are equal, of all else no better."""
    solution = solve(problem)
    assert solution.status is Status.CERTIFIED
    assert solution.force.sum() == pytest.approx(1.0, rel=1e-12)
    marginal = problem.dense_compliance @ solution.force + problem.separation
    held = solution.force > 0.0
    assert 1 < np.count_nonzero(held) < problem.size
    scale = np.abs(problem.dense_compliance @ solution.force).max()
    np.testing.assert_allclose(marginal[held], solution.rotation, rtol=0.0, atol=1e-11 * scale)
    assert marginal.min() > solution.rotation - 1e-11 * scale


def test_problems_of_other_fields_in_the_comparison_have_answers() -> None:
    kinds = [(kind, problem.size) for kind, _, problem in outside_problems()]
    assert len(kinds) == 20
    assert list(dict.fromkeys(kind for kind, _ in kinds)) == list(KINDS)
    for _, name, problem in outside_problems():
        if problem.size < 100:
            assert solve(problem).status is Status.CERTIFIED, name


def test_problems_of_maros_and_meszaros_have_the_published_least_objectives() -> None:
    """To the digits printed; TAME, of two unknowns and a singular compliance, has zero."""
    published = LEAST_OBJECTIVES | {"TAME": 0.0}
    tame = ContactProblem([0.0, 0.0], [1.0, 1.0], 1.0, [[2.0, -2.0], [-2.0, 2.0]])
    for name, problem in (*maros_meszaros(), ("TAME", tame)):
        solution = solve(problem)
        assert solution.status is Status.CERTIFIED, name
        force = solution.force
        objective = force @ (0.5 * problem.dense_compliance @ force + problem.separation)
        assert float(f"{objective:.7e}") == pytest.approx(published.pop(name), rel=1e-15, abs=1e-15), name
    assert not published


@pytest.mark.parametrize("seed", [229, 369, 496, 605])
def test_support_vectors_of_a_wide_kernel(seed: int) -> None:
    """Digits that a descent loses on nearly singular systems come back where its last segments are solved for anew."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(int(rng.integers(8, 26)), 1))
    label = np.where(rng.random(len(points)) < 0.5, -1.0, 1.0)
    solution = solve(support_vectors(points, label, np.exp(-0.5 * ((points - points.T) / 3.0) ** 2)))
    assert solution.status is Status.CERTIFIED
    assert solution.certificate.worst < 1e-10


def test_touching_segments_that_change_one_by_one_are_those_of_a_system_made_at_once() -> None:
    """In any order, in and out; what a segment sheds is what the system says of its column."""
    rng = np.random.default_rng(2)
    problem = next(problems("realistic", 1, seed=1))
    compliance, arm, size = problem.dense_compliance, problem.lever_arm, problem.size
    system = DenseTouching(compliance, arm, np.arange(size) < 3)
    for segment in rng.integers(0, size, 120):
        (system.leave if system.active[segment] else system.enter)(int(segment))
        index = np.flatnonzero(system.active)
        matrix = np.block([[np.zeros((1, 1)), arm[None, index]], [arm[index, None], compliance[np.ix_(index, index)]]])
        scale = np.concatenate([[1e3], np.full(index.size, 1e-3)])  # entries of order one
        both = scale[:, None] * matrix * scale * 1e6
        side = np.concatenate([[problem.torque], -problem.separation[index]])
        direct = scale * np.linalg.solve(both, scale * side) * 1e6
        np.testing.assert_allclose(
            system.forces(-problem.separation, problem.torque)[index], direct[1:], atol=1e-9 * np.abs(direct).max()
        )
        other = int(rng.integers(0, size))
        if not system.active[other]:
            column = np.concatenate([[arm[other]], compliance[index, other]])
            shed = scale * np.linalg.solve(both, scale * column) * 1e6
            np.testing.assert_allclose(system.shares(other)[index], shed[1:], atol=1e-9 * np.abs(shed[1:]).max())


def test_moving_single_segments_ends_some_cycles(monkeypatch: pytest.MonkeyPatch) -> None:
    """Exchanging all wrong segments at once can go round in circles; after a while they move one by one."""

    def solved() -> int:
        cases = [(problem.scaled(), problem) for problem in problems("nearly_singular", 60, seed=9)]
        return sum(primal_dual_active_set(scaled, p.scaling.estimated_active) is not None for scaled, p in cases)

    safeguarded = solved()
    monkeypatch.setattr("easeoff.contact.solvers.primal_dual_active_set.MAX_STALLED_STEPS", 10**9)
    assert solved() < safeguarded < 60  # not all: hence the further methods


def test_everyday_problems_take_a_few_linear_systems() -> None:
    for problem in problems("realistic", 20):
        assert solve(problem).iterations <= 5


def test_singular_compliance_still_has_a_proved_answer() -> None:
    """Without local compliance the forces are not unique; any that satisfy all conditions will do."""
    rng = np.random.default_rng(4)
    for _ in range(30):
        n, rank = int(rng.integers(2, 30)), int(rng.integers(1, 4))
        factor = rng.standard_normal((n, rank)) * 1e-3
        problem = ContactProblem(rng.random(n) * 0.01, rng.uniform(30.0, 50.0, n), 1e5, (np.zeros(n), factor))
        assert solve(problem).certificate.passes(1e-9)
    rigid = ContactProblem(np.array([0.02, 0.01]), np.array([40.0, 40.0]), 1e5, np.zeros((2, 2)))
    assert solve(rigid).force == pytest.approx(np.array([0.0, 2500.0]))


# Physics


def test_rotation_never_falls_as_the_torque_rises() -> None:
    for name in ("realistic", "plain", "lattice", "mixed_arms"):
        for problem in problems(name, 5, seed=2):
            torques = np.concatenate([[0.0], np.geomspace(1e-6, 1e2, 15) * problem.torque])
            rotations = [solve(problem.with_torque(float(torque))).rotation for torque in torques]
            assert (np.diff(rotations) >= -1e-15 * np.abs(rotations[:-1])).all()


def test_rotation_tends_to_first_contact_as_the_torque_vanishes() -> None:
    for problem in [*realistic(5), *problems("interfering", 5)]:
        contact = float(np.min(problem.separation / problem.lever_arm))
        assert solve(problem.with_torque(0.0)).rotation == contact
        assert solve(problem.with_torque(0.0)).status is Status.CERTIFIED
        assert not solve(problem.with_torque(0.0)).force.any()
        assert solve(problem.with_torque(1e-12)).rotation == pytest.approx(contact, rel=1e-12)


def test_rotation_is_the_derivative_of_the_energy_by_the_torque() -> None:
    """v(T) = min 1/2 F'CF + S'F has v'(T) = theta; v is quadratic in T as long as the same segments touch."""

    def energy(problem: ContactProblem) -> float:
        force = solve(problem).force
        return float(force @ (0.5 * problem.deflection(force) + problem.separation))

    for problem in realistic(5):
        step = 1e-4 * problem.torque
        difference = energy(problem.with_torque(problem.torque + step)) - energy(
            problem.with_torque(problem.torque - step)
        )
        assert difference / (2.0 * step) == pytest.approx(solve(problem).rotation, rel=1e-7)


def test_order_of_the_segments_does_not_matter() -> None:
    rng = np.random.default_rng(5)
    for problem in realistic(5):
        order = rng.permutation(problem.size)
        compliance = problem.dense_compliance[np.ix_(order, order)]
        shuffled = ContactProblem(problem.separation[order], problem.lever_arm[order], problem.torque, compliance)
        solution, reference = solve(shuffled), solve(problem)
        assert solution.rotation == pytest.approx(reference.rotation, rel=1e-13)
        assert np.abs(solution.force - reference.force[order]).max() < 1e-11 * reference.force.max()


def test_segments_with_negative_lever_arm_may_be_forced_open() -> None:
    """At no torque, two springs pressed against each other by interference: equal moments, no net torque."""
    problem = ContactProblem(np.array([0.0, -0.1]), np.array([40.0, -40.0]), 0.0, np.diag([1e-6, 1e-6]))
    solution = solve(problem)
    assert solution.status is Status.CERTIFIED
    assert solution.force == pytest.approx(np.array([5e4, 5e4]))
    assert solution.rotation == pytest.approx(0.05 / 40.0)


def test_gap_is_that_of_the_reported_forces() -> None:
    for problem in realistic(3):
        solution = solve(problem)
        gap = problem.dense_compliance @ solution.force + problem.separation - solution.rotation * problem.lever_arm
        assert np.abs(solution.gap - gap).max() < 1e-15
        assert np.array_equal(solution.active, solution.force > 0.0)


# Warm start


@pytest.mark.parametrize("as_indices", [False, True])
def test_warm_start_takes_one_solve_to_the_same_answer(as_indices: bool) -> None:
    for problem in realistic(5):
        cold = solve(problem, method="primal_dual_active_set")
        start = np.flatnonzero(cold.active) if as_indices else cold.active
        warm = solve(problem, initial_active=start, method="primal_dual_active_set")
        assert warm.iterations == 1
        assert np.array_equal(warm.force, cold.force)


def test_warm_start_takes_one_step_of_the_compiled_method() -> None:
    """Its last bits depend on where it began, as the steps to the end are others."""
    for problem in realistic(5):
        cold = solve(problem)
        warm = solve(problem, initial_active=cold.active)
        assert warm.iterations == 1
        assert np.array_equal(warm.active, cold.active)
        assert np.abs(warm.force - cold.force).max() <= 1e-14 * cold.force.max()


def test_bad_warm_start_costs_time_only() -> None:
    problem = realistic()[0]
    reference = solve(problem)
    for start in (np.zeros(problem.size, dtype=bool), np.ones(problem.size, dtype=bool), ~reference.active):
        assert solve(problem, initial_active=start).rotation == pytest.approx(reference.rotation, rel=1e-14)


@pytest.mark.parametrize("start", [np.ones(3, dtype=bool), np.array([0.5]), np.array([-1]), np.array([10**6])])
def test_impossible_warm_start_is_refused(start: Any) -> None:
    with pytest.raises(InputError, match="initial_active"):
        solve(realistic()[0], initial_active=start)


# Honesty


def assert_no_answer(solution: ContactSolution, status: Status) -> None:
    assert solution.status is status
    assert not solution.certified
    assert np.isnan(solution.force).all()
    assert np.isnan(solution.gap).all()
    assert np.isnan(solution.rotation)


@pytest.mark.parametrize("name", SOLVERS)
def test_indefinite_compliance_is_a_status(name: str) -> None:
    problem = ContactProblem(np.zeros(2), np.full(2, 40.0), 10.0, np.array([[1e-6, 2e-6], [2e-6, 1e-6]]))
    assert_no_answer(solve(problem, installed(name)), Status.NOT_POSITIVE_SEMIDEFINITE)


def test_interference_without_compliance_is_unbounded() -> None:
    problem = ContactProblem(np.array([0.1, -0.3]), np.array([40.0, 0.0]), 10.0, np.diag([1e-6, 0.0]))
    assert_no_answer(solve(problem), Status.UNBOUNDED)


def test_absurd_magnitudes_end_in_a_status_or_an_answer() -> None:
    for torque in (5e-324, 1e-300, 1e200, 1e306):
        problem = ContactProblem(np.array([0.1, 0.3]), np.full(2, 40.0), torque, np.eye(2) * 1e-6)
        solution = solve(problem)
        assert solution.certified or np.isnan(solution.force).all()


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("clarabel", {"max_iter": 1}),
        ("osqp", {"max_iter": 1}),
        ("piqp", {"max_iter": 1}),
        ("proxqp", {"max_iter": 1}),
        ("scs", {"max_iters": 1}),
        ("sip", {"max_iterations": 1}),
        ("pyqpmad", {"max_iter": 1}),
        ("qpalm", {"max_iter": 1}),
        ("cvxopt", {"maxiters": 1}),
        ("ecos", {"max_iters": 1}),
    ],
)
def test_iteration_limit_is_a_status(name: str, settings: dict[str, Any]) -> None:
    solution = solve(realistic()[0], installed(name), polish=False, **settings)
    assert_no_answer(solution, Status.NOT_CONVERGED)
    assert solution.message


@pytest.mark.parametrize("name", ["highs", "qpalm", "sip"])
def test_time_limit_is_a_status(name: str) -> None:
    solution = solve(realistic()[0], installed(name), polish=False, time_limit=0.0)
    assert_no_answer(solution, Status.TIME_LIMIT)


@pytest.mark.parametrize(
    ("answer", "status"),
    [
        (lambda p: ScaledAnswer(np.full(p.separation.size, 1.0), 1.0, 3, "solved"), Status.NOT_CERTIFIED),
        (lambda p: ScaledAnswer(np.full(p.separation.size, np.nan), 1.0, 3, "solved"), Status.NOT_CERTIFIED),
        (lambda p: ScaledAnswer(np.zeros(p.separation.size), np.inf, 3, "solved"), Status.NOT_CERTIFIED),
        (lambda p: ScaledAnswer(np.ones(1), 1.0, 3, "solved"), Status.SOLVER_FAILED),
        (lambda p: 1 / 0, Status.SOLVER_FAILED),
    ],
)
def test_backend_that_lies_or_breaks_is_not_believed(
    monkeypatch: pytest.MonkeyPatch, answer: Callable[[ScaledProblem], ScaledAnswer], status: Status
) -> None:
    monkeypatch.setattr("easeoff.contact.solvers.backend_solution.solve_scaled", lambda *given: answer(given[1]))
    assert_no_answer(solve(realistic()[0], "clarabel", polish=False), status)


def test_right_answer_is_accepted_whatever_its_flag(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = realistic()[0]
    reference = solve(problem)
    modest = ScaledAnswer(
        reference.force / problem.scaling.force,
        reference.elastic_rotation / problem.scaling.rotation,
        3,
        "not found",
        Status.INFEASIBLE,
    )
    monkeypatch.setattr("easeoff.contact.solvers.backend_solution.solve_scaled", lambda *given: modest)
    solution = solve(problem, "clarabel", polish=False)
    assert solution.status is Status.CERTIFIED
    assert solution.claim == "infeasible"


def test_polish_makes_exact_what_is_roughly_right_and_says_so() -> None:
    problem = realistic()[0]
    reference = solve(problem)
    rough: dict[str, Any] = {"eps_abs": 0.1, "eps_rel": 0.1, "polishing": False}
    unpolished = solve(problem, "osqp", polish=False, **rough)
    assert unpolished.status is Status.NOT_CERTIFIED
    assert unpolished.claim == "solved"
    assert not unpolished.polished
    assert np.isnan(unpolished.force).all()
    assert np.abs(unpolished.answer.force - reference.force).max() < 0.5 * reference.force.max()
    polished = solve(problem, "osqp", **rough)
    assert polished.polished
    assert np.abs(polished.force - reference.force).max() < 1e-13 * reference.force.max()


@pytest.mark.parametrize("name", SOLVERS)
def test_solution_says_how_it_was_found_and_how_long_it_took(name: str) -> None:
    solution = solve(realistic()[0], installed(name))
    assert solution.claim in {"solved", "solver_failed"}  # ECOS is not content with what it finds
    assert solution.method in ({"modal", "primal_dual_active_set"} if name == "native" else {"dense", "lifted"})
    assert 0.0 < solution.run_time < 60.0


def test_unknown_solver_is_told_the_known_ones() -> None:
    with pytest.raises(InputError, match=r"clarabel.*cvxpy"):
        solve(realistic()[0], "simplex")
    with pytest.raises(InputError, match="did you mean 'highs'"):
        solve(realistic()[0], "high")


@pytest.mark.parametrize("name", [name for name in SOLVERS if SOLVERS[name].package])
def test_missing_solver_is_told_how_to_install_it(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    real, entry = importlib.util.find_spec, SOLVERS[name]
    monkeypatch.setattr(importlib.util, "find_spec", lambda found: None if found == entry.package else real(found))
    assert name not in available_solvers()
    with pytest.raises(MissingSolverError, match=re.escape(how_to_install(entry.requirement))):
        solve(realistic()[0], name)


@pytest.mark.parametrize("name", SOLVERS)
def test_misspelt_setting_is_refused(name: str) -> None:
    """Some backends ignore unknown settings in silence; here none does."""
    with pytest.raises(EaseoffError, match=name):
        solve(realistic()[0], installed(name), tolerence=1e-6)


def test_unknown_native_method_is_refused() -> None:
    with pytest.raises(InputError, match="primal_active_set"):
        solve(realistic()[0], method="ellipsoid")


def test_status_flags_follow_the_cf_conventions() -> None:
    attributes = Status.flag_attributes()
    meanings = attributes["flag_meanings"].split()
    assert len(meanings) == len(attributes["flag_values"]) == len(Status)
    assert all(Status[word.upper()] == value for word, value in zip(meanings, attributes["flag_values"], strict=True))
    assert int(Status.CERTIFIED) == 0


def test_native_solver_comes_first_and_needs_nothing() -> None:
    assert available_solvers()[0] == "native"
    assert solve(realistic()[0], "auto").solver == "native"


@pytest.mark.parametrize("name", SOLVERS)
def test_energy_is_the_work_of_the_torque_less_the_work_on_the_separations(name: str) -> None:
    """Of springs, 1/2 c F^2 each; of any problem 1/2 (theta T - S'F), both counted from first contact."""
    for problem in realistic():
        solution = solve(problem, installed(name))
        work = solution.elastic_rotation * problem.torque - problem.separation_at_first_contact @ solution.force
        assert solution.energy == pytest.approx(0.5 * work, rel=1e-9)
        assert solution.problem is problem
    springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    assert solve(springs, name).energy == pytest.approx(2 * 0.5 * 1e-6 * 1000.0**2)


def test_energy_without_an_answer_is_not_a_number() -> None:
    assert np.isnan(solve(realistic()[0], installed("clarabel"), polish=False, max_iter=1).energy)


def test_course_tells_method_steps_and_end() -> None:
    springs = ContactProblem([0.0, 0.0], [40.0, 40.0], 8.0e4, [[1e-6, 0.0], [0.0, 1e-6]])
    assert course("two springs", solve(springs)) == "two springs, 1 step: certified"
