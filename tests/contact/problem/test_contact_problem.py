"""The contact problem, its scaling and its certificate."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import qpsolvers
import xarray as xr

from easeoff import InputError
from easeoff.contact import Certificate, ContactProblem, certify, solve
from easeoff.contact.problem.scaled_problem import power_of_two
from easeoff.contact.solvers.native import answers
from easeoff.contact.solvers.touching_system import solve_active_set
from easeoff.verification import problems
from easeoff.verification.problem_classes import PROBLEM_CLASSES


def small(**changes: Any) -> ContactProblem:
    data: dict[str, Any] = {
        "separation": np.array([0.0, 0.01, 0.5]),
        "lever_arm": np.array([40.0, 42.0, 41.0]),
        "torque": 1.0e5,
        "compliance": np.diag([2e-6, 3e-6, 2e-6]) + 1e-6,
    }
    return ContactProblem(**{**data, **changes})


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"separation": np.zeros((3, 1))}, "separation"),
        ({"separation": np.zeros(0), "lever_arm": np.zeros(0)}, "1 or more in a row"),
        ({"separation": np.array([0.0, np.nan, 0.0])}, "separation"),
        ({"separation": ["a", "b", "c"]}, "separation"),
        ({"lever_arm": np.ones(2)}, "lever_arm"),
        ({"lever_arm": np.array([1.0, np.inf, 1.0])}, "lever_arm"),
        ({"lever_arm": -np.ones(3)}, "must have a positive entry"),
        ({"torque": -1.0}, "torque"),
        ({"torque": np.nan}, "torque"),
        ({"torque": np.ones(1)}, "torque"),
        ({"compliance": np.eye(2)}, "shape"),
        ({"compliance": np.ones(3)}, "compliance"),
        ({"compliance": np.full((3, 3), np.nan)}, "compliance"),
        ({"compliance": np.diag([1.0, -1.0, 1.0])}, "compliance diagonal = -1: must be"),
        ({"compliance": np.eye(3) + np.triu(np.full((3, 3), 0.01), 1)}, "must be symmetric"),
        ({"compliance": (np.ones(2), np.ones((3, 1)))}, "diagonal"),
        ({"compliance": (np.ones(3), np.ones((2, 1)))}, "factor"),
        ({"compliance": (-np.ones(3), np.ones((3, 1)))}, "diagonal = -1: must be"),
        ({"compliance": (np.ones(3), np.full((3, 1), np.nan))}, "factor"),
    ],
)
def test_unusable_data_are_refused_by_name(changes: dict[str, Any], word: str) -> None:
    with pytest.raises(InputError, match=word):
        small(**changes)


def test_asymmetry_of_rounding_is_averaged_out() -> None:
    matrix = np.diag([2e-6, 3e-6, 2e-6]) + 1e-6
    matrix[0, 1] *= 1.0 + 1e-14
    dense = small(compliance=matrix).dense_compliance
    assert np.array_equal(dense, dense.T)
    assert np.allclose(dense, matrix, rtol=1e-13, atol=0.0)


def test_problem_neither_shares_nor_lends_its_arrays() -> None:
    separation = np.array([0.0, 0.01, 0.5])
    problem = small(separation=separation)
    separation[0] = 7.0
    assert problem.separation[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        problem.separation[0] = 1.0
    with pytest.raises(AttributeError):
        problem.torque = 2.0  # type: ignore[misc]


def test_pair_and_matrix_stand_for_the_same_compliance() -> None:
    rng = np.random.default_rng(1)
    diagonal, factor, force = rng.random(7), rng.standard_normal((7, 3)), rng.random(7)
    pair = ContactProblem(rng.random(7), np.ones(7), 1.0, (diagonal, factor))
    dense = ContactProblem(pair.separation, np.ones(7), 1.0, np.diag(diagonal) + factor @ factor.T)
    assert pair.is_structured
    assert not dense.is_structured
    assert np.allclose(pair.dense_compliance, dense.dense_compliance, rtol=1e-15, atol=1e-15)
    assert np.allclose(pair.deflection(force), dense.deflection(force), rtol=1e-14)
    assert np.allclose(pair.compliance_diagonal, dense.compliance_diagonal, rtol=1e-14)
    assert np.allclose(pair.gap(force, 0.3), dense.gap(force, 0.3), rtol=1e-12)


def test_changed_copies_do_not_keep_what_has_become_wrong() -> None:
    problem = small()
    solve(problem)  # fills every cache
    local = np.array([1e-6, 2e-6, 3e-6])
    added = problem.with_added_compliance(local, separation=problem.separation + 0.1)
    fresh = small(compliance=problem.dense_compliance + np.diag(local), separation=problem.separation + 0.1)
    assert added.identical(fresh)
    assert np.array_equal(added.compliance_diagonal, fresh.compliance_diagonal)
    assert solve(added).rotation == solve(fresh).rotation
    heavier = problem.with_torque(1e9)
    assert heavier.scaling.force > 1e3 * problem.scaling.force
    assert solve(heavier).rotation == solve(small(torque=1e9)).rotation
    with pytest.raises(InputError, match="torque"):
        problem.with_torque(-1.0)
    with pytest.raises(InputError, match="local compliance"):
        problem.with_added_compliance(-local)


@pytest.mark.parametrize("compliance", [None, (np.array([1e-6, 0.0, 3e-6]), np.array([[1e-3], [2e-3], [0.1]]))])
def test_dataset_holds_the_problem_to_the_bit(compliance: Any) -> None:
    problem = small(torque=1.0 / 3.0) if compliance is None else small(compliance=compliance, torque=0.1)
    dataset = problem.to_dataset()
    assert ContactProblem.from_dataset(dataset).identical(problem)
    for variable in dataset.data_vars.values():
        assert variable.dtype == np.float64
        assert variable.attrs["units"]
        assert variable.attrs["long_name"]


def test_dataset_without_a_variable_is_refused() -> None:
    with pytest.raises(InputError, match="lever_arm"):
        ContactProblem.from_dataset(small().to_dataset().drop_vars("lever_arm"))
    with pytest.raises(InputError, match="compliance"):
        ContactProblem.from_dataset(xr.Dataset())


def test_indefinite_compliance_is_recognised() -> None:
    assert small().is_positive_semidefinite
    assert small(compliance=np.ones((3, 3))).is_positive_semidefinite  # singular is allowed
    assert not small(compliance=np.ones((3, 3)) - 0.5 * np.eye(3)).is_positive_semidefinite


# Scaling


@pytest.mark.parametrize("value", [1e-300, 0.7, 1.0, 3.0, 1e17])
def test_power_of_two_is_the_nearest_in_ratio(value: float) -> None:
    power = power_of_two(value)
    assert math.frexp(power)[0] == 0.5
    assert 2**-0.5 * (1 - 1e-15) <= power / value <= 2**0.5 * (1 + 1e-15)


@pytest.mark.parametrize("value", [0.0, math.inf, math.nan, -1.0])
def test_no_scale_is_taken_from_nothing(value: float) -> None:
    assert power_of_two(value) == 1.0


@pytest.mark.parametrize("torque", [1e-9, 1e-3, 1e3, 1e6, 1e12])
def test_scaled_numbers_are_of_order_one_whatever_the_load(torque: float) -> None:
    for problem in problems("realistic", 5):
        loaded = problem.with_torque(torque)
        scaled = loaded.scaled()
        solution = solve(loaded)
        assert 0.5 < scaled.compliance.diagonal().mean() < 2.0
        assert 0.5 < np.abs(scaled.lever_arm).mean() < 2.0
        assert 0.1 < scaled.torque < 10.0 * loaded.size
        assert 0.05 < solution.force.max() / loaded.scaling.force < 20.0
        assert np.abs(scaled.separation).max() < 100.0 * loaded.size


@pytest.mark.parametrize("name", PROBLEM_CLASSES)
def test_change_of_units_by_powers_of_two_changes_no_bit(name: str) -> None:
    """The scaled problem, and hence every answer, does not depend on the units of the data."""
    length, newton = 2.0**-10, 2.0**7
    for problem in problems(name, 4):
        other = ContactProblem(
            problem.separation * length,
            problem.lever_arm * length,
            problem.torque * length * newton,
            problem.dense_compliance * (length / newton),
        )
        reference = solve(
            ContactProblem(problem.separation, problem.lever_arm, problem.torque, problem.dense_compliance)
        )
        solution = solve(other)
        assert np.array_equal(solution.force / newton, reference.force)
        assert np.array_equal(solution.gap / length, reference.gap)
        assert solution.rotation == reference.rotation
        assert solution.certificate == reference.certificate


@pytest.mark.parametrize("name", PROBLEM_CLASSES)
def test_clipping_changes_no_answer(name: str) -> None:
    """Segments beyond the limit are open in the solution, and the clipped problem has the solution of the full one."""
    clipped_somewhere = 0
    for problem in problems(name, 8):
        solution = solve(problem)
        scaling = problem.scaling
        clipped_somewhere += int(scaling.certainly_open.any())
        assert not (solution.force[scaling.certainly_open] > 0.0).any()
        assert (solution.gap[scaling.certainly_open] > 0.0).all()
        full = problem.scaled(clip=False)
        clipped = problem.scaled()
        for _, answer in answers(full, solution.active, {}):
            deflection = full.compliance @ answer.force - answer.rotation * full.lever_arm
            tolerance = 1e-9 * (1.0 + abs(answer.rotation))
            assert (deflection + clipped.separation > -tolerance).all()
            assert (np.minimum(answer.force, deflection + clipped.separation) < tolerance).all()
            break
    if name in ("light_load", "far_apart"):
        assert clipped_somewhere > 5


def test_winkler_estimate_is_exact_without_coupling() -> None:
    rng = np.random.default_rng(2)
    for _ in range(20):
        n = int(rng.integers(1, 30))
        diagonal = np.diag(rng.uniform(1e-6, 3e-6, n))
        problem = ContactProblem(rng.random(n) * 0.05, rng.uniform(30.0, 50.0, n), 10.0 ** rng.uniform(3, 6), diagonal)
        assert np.array_equal(problem.scaling.estimated_active, solve(problem).active)


def test_unscaling_inverts_scaling() -> None:
    problem = small()
    scaling, solution = problem.scaling, solve(problem)
    force, rotation = scaling.unscale(solution.force / scaling.force, solution.elastic_rotation / scaling.rotation)
    assert np.array_equal(force, solution.force)
    assert rotation == solution.rotation


@pytest.mark.parametrize("sparse", [False, True])
def test_scaled_programme_goes_to_any_solver_of_qpsolvers(sparse: bool) -> None:
    problem = next(problems("realistic", 1))
    programme = problem.as_qp(sparse=sparse)
    assert isinstance(programme.P, np.ndarray) is not sparse
    backend = "clarabel" if sparse else "daqp"
    found = qpsolvers.solve_problem(programme, backend)
    assert found.x is not None
    assert found.y is not None
    force, rotation = problem.scaling.unscale(found.x, -found.y[0])
    solution = solve(problem)
    assert rotation == pytest.approx(solution.rotation, rel=1e-6)
    assert np.abs(force - solution.force).max() < 1e-3 * solution.force.max()


# Certificate


def test_exact_answer_has_an_empty_certificate() -> None:
    """Two equal springs in parallel: F = T / 2r, theta = c T / 2r^2."""
    problem = ContactProblem(np.zeros(2), np.full(2, 32.0), 6400.0, np.diag([2.0**-19, 2.0**-19]))
    assert certify(problem, np.array([100.0, 100.0]), 2.0**-19 * 100.0 / 32.0) == Certificate(0.0, 0.0, 0.0, 0.0, 0.0)


def test_each_violation_shows_in_its_own_entry() -> None:
    problem = small()
    solution = solve(problem)
    assert certify(problem, solution.force, solution.rotation).worst < 1e-12

    heavier = certify(problem, solution.force * 1.01, solution.rotation)
    assert heavier.equilibrium == pytest.approx(0.01, rel=1e-6)

    turned_on = certify(problem, solution.force, solution.rotation + 0.02 * solution.elastic_rotation)
    assert turned_on.negative_gap > 1e-3
    assert turned_on.duality_gap > 1e-3

    turned_back = certify(problem, solution.force, solution.rotation - 0.02 * solution.elastic_rotation)
    assert turned_back.negative_gap == 0.0
    assert turned_back.complementarity > 1e-3

    pulling = solution.force.copy()
    pulling[2] = -0.01 * pulling.max()
    assert certify(problem, pulling, solution.rotation).negative_force == pytest.approx(0.01, rel=1e-6)


def test_no_numbers_no_certificate() -> None:
    problem = small()
    for force, rotation in (
        (np.full(3, np.nan), 0.0),
        (np.zeros(3), math.inf),
        (np.zeros(2), 0.0),
        (np.full(3, 1e300), 1e300),
    ):
        certificate = certify(problem, np.asarray(force), rotation)
        assert not certificate.passes(1e6)


def test_idle_forces_prove_nothing_under_load() -> None:
    problem = small()
    assert certify(problem, np.zeros(3), problem.first_contact_rotation).equilibrium == 1.0


def test_rotation_in_floating_point_is_not_blamed_for_its_last_digit() -> None:
    """A light load on widely separated teeth: the elastic rotation is lost in the digits of the whole rotation."""
    problem = small(separation=np.array([1e6, 1.1e6, 2e6]), torque=1e-6)
    solution = solve(problem)
    assert solution.elastic_rotation < np.spacing(solution.rotation)
    assert certify(problem, solution.force, solution.rotation, solution.elastic_rotation).worst < 1e-12
    assert certify(problem, solution.force, solution.rotation).passes()


def test_wrong_signs_that_qpsolvers_calls_optimal_are_refused() -> None:
    """qpsolvers checks residuals, not the sign of multipliers: a penetrating solution passes its test, but not ours."""
    problem = next(problems("realistic", 1))
    solution = solve(problem)
    scaled = problem.scaled()
    crippled = np.flatnonzero(solution.active)[1:]  # one touching segment is forgotten
    point = solve_active_set(scaled, crippled)
    assert point is not None
    assert point.force.min() > 0.0
    point.refine()

    claim = qpsolvers.Solution(problem.as_qp())
    claim.found = True
    claim.x = np.zeros(problem.size)
    claim.x[crippled] = point.force
    claim.y = np.array([-point.rotation])
    claim.z, claim.z_box = (
        np.empty(0),
        -(scaled.compliance @ claim.x + scaled.separation - point.rotation * scaled.lever_arm),
    )
    assert claim.is_optimal(1e-9)

    force, rotation = problem.scaling.unscale(claim.x, point.rotation)
    certificate = certify(problem, force, rotation)
    assert certificate.negative_gap > 1e-3
    assert not certificate.passes(1e-4)


def test_problem_and_solution_are_told_in_a_line_or_two() -> None:
    pair = (np.full(3, 1e-6), 1e-3 * np.ones((3, 1)))
    problem = ContactProblem(np.zeros(3), np.full(3, 40.0), 4.5e5, pair)
    assert repr(problem) == "ContactProblem: 3 segments, diagonal + 1 column, torque 450000 N mm"
    dense = ContactProblem(np.zeros(1), np.full(1, 40.0), 1e3, [[1e-6]])
    assert repr(dense) == "ContactProblem: 1 segment, dense matrix, torque 1000 N mm"
    head, proof = repr(solve(problem)).splitlines()
    assert head.startswith("ContactSolution: native, certified, 3 of 3 segments in contact, rotation ")
    assert proof.strip().startswith("passes 1e-09: ")
    assert "rounding bound" in proof
    pulling = ContactProblem(np.zeros(2), np.full(2, 40.0), 1e3, [[1e-6, 2e-6], [2e-6, 1e-6]])
    refused = repr(solve(pulling)).splitlines()
    assert refused[0] == "ContactSolution: native, not positive semidefinite"
    assert refused[1].strip().startswith("native, not begun")
