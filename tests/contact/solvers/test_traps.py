"""What misleads users of these programs does not mislead here; each trap is shown where its program is installed."""

from __future__ import annotations

import math
import warnings

import numpy as np
import pytest
import qpsolvers
from solver_choice import (
    AGREEMENT,
    BACKENDS,
    answer_of,
    installed,
    rotation_and_gap,
)

from easeoff.contact import SOLVERS, ContactProblem, Status, available_solvers, certify, solve
from easeoff.contact.solvers.backend_solution import adapter_of
from easeoff.study.compare.attempt import Method, Request
from easeoff.study.compare.worker import workers
from easeoff.verification import problems
from easeoff.verification.problem_classes import PROBLEM_CLASSES


def in_metres(problem: ContactProblem) -> qpsolvers.Problem:
    """The problem as one would hand it on: m, N and N m."""
    return qpsolvers.Problem(
        problem.dense_compliance * 1e-3,
        problem.separation * 1e-3,
        A=problem.lever_arm[np.newaxis, :] * 1e-3,
        b=np.array([problem.torque * 1e-3]),
        lb=np.zeros(problem.size),
    )


def judged(problem: ContactProblem, claim: qpsolvers.Solution) -> tuple[float, float]:
    """Greatest error of a force of a claimed solution, over the greatest force, and the worst entry of its certificate.

    The rotation is the one the forces themselves give, so that nothing else is blamed.
    """
    assert claim.x is not None
    reference = solve(problem)
    deflection = problem.deflection(claim.x)
    rotation = float(claim.x @ (deflection + problem.separation)) / problem.torque
    error = float(np.abs(claim.x - reference.force).max() / reference.force.max())
    return error, certify(problem, claim.x, rotation).worst


#: Backends whose tolerances are absolute.
ABSOLUTE = ("osqp", "scs", "proxqp", "qpalm", "piqp", "ecos")


def test_raw_units_mislead_where_scaled_ones_do_not() -> None:
    """In SI units, tolerances meant for numbers of order one stop solvers far off."""
    misled = []
    for name in [name for name in ABSOLUTE if name in available_solvers()]:
        for problem in problems("realistic", 2):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                claim = qpsolvers.solve_problem(in_metres(problem), name)
            error, worst = judged(problem, claim)
            if error > 1e-3:
                assert worst > 1e-4  # whatever it says of itself
                misled.append((name, claim.found))
            ours = solve(problem, name)
            assert np.abs(ours.force - solve(problem).force).max() < 1e-12 * ours.force.max()
    assert {("osqp", True)} <= set(misled)


@pytest.mark.thorough
def test_raw_units_that_bring_a_process_down_do_no_harm_when_scaled() -> None:
    """HiGHS goes round in circles, or writes where it must not: in a process of its own."""
    installed("highs")
    with workers(["highs"]) as pool:
        for seed in (0, 4):
            problem = next(problems("realistic", 1, seed=seed))
            reference = solve(problem).elastic_rotation
            found = pool["highs"].run(Request(problem, Method("highs", "raw"), 0.2))
            if not abs(found.elastic_rotation / reference - 1.0) < 1e-3:  # or there is no answer
                assert not found.certificate.passes(1e-4)
            ours = solve(problem, "highs", polish=False)
            assert ours.certificate.worst < 1e-12
            assert ours.elastic_rotation == pytest.approx(reference, rel=AGREEMENT["highs"][0])


def test_raw_units_mislead_an_active_set_method_on_light_loads() -> None:
    """It tells touching from open by absolute tolerances as well; scaled, the same problem is an everyday one."""
    misled = 0
    for problem in problems("light_load", 5, seed=11):
        claim = qpsolvers.solve_problem(in_metres(problem), "daqp")
        if claim.found and judged(problem, claim)[0] > 1e-3:
            assert judged(problem, claim)[1] > 1e-4
            misled += 1
        assert solve(problem, "daqp", polish=False).certified
    assert misled


def test_residuals_with_units_prove_nothing() -> None:
    """Forces wrong by a thousandth leave 1e-8 metres: `is_optimal(1e-6)` is content, the certificate is not."""
    problem = next(problems("realistic", 1))
    solution = solve(problem)
    arm, touching = problem.lever_arm, np.flatnonzero(solution.active)[-2:]
    wrong = solution.force.copy()
    shift = 1e-3 * solution.force.max()
    wrong[touching] += shift * np.array([1.0, -arm[touching[0]] / arm[touching[1]]])  # the torque still balances
    assert wrong.min() >= 0.0
    rotation = float(wrong @ (problem.deflection(wrong) + problem.separation)) / problem.torque  # and so does the work

    claim = qpsolvers.Solution(in_metres(problem))
    claim.found, claim.x, claim.y, claim.z = True, wrong, np.array([-rotation]), np.empty(0)
    claim.z_box = -1e-3 * np.where(solution.active, 0.0, solution.gap)
    assert claim.is_optimal(1e-6)
    assert not certify(problem, wrong, rotation).passes(1e-5)


def test_bias_of_highs_is_taken_out() -> None:
    """HiGHS adds a number to the diagonal: a bias, which the certificate sees, and which the settings set to zero."""
    installed("highs")
    problem = next(problems("realistic", 1))
    biased = solve(problem, "highs", polish=False, qp_regularization_value=1e-5)
    assert biased.status is Status.NOT_CERTIFIED
    assert biased.certificate.worst > 1e-7
    assert solve(problem, "highs", polish=False).certificate.worst < 1e-12
    assert math.isfinite(SOLVERS["highs"].settings["time_limit"])


def test_accuracy_that_a_backend_denies_is_certified() -> None:
    """Asked for more digits than it has, ECOS says that it failed; its best is good enough for its level."""
    installed("ecos")
    chosen = list(problems("realistic", 5))
    assert any(answer_of("ecos", problem).suspicion is not None for problem in chosen)
    level = SOLVERS["ecos"].tolerance
    assert all(solve(problem, "ecos", polish=False, tolerance=level).certified for problem in chosen)


@pytest.mark.parametrize("name", [name for name in BACKENDS if SOLVERS[name].sparse])
def test_sparse_backends_get_sparse_matrices(name: str) -> None:
    """Otherwise qpsolvers converts them at every call, with a warning that may be an error elsewhere."""
    problem = next(problems("realistic", 1))
    warning = qpsolvers.warnings.SparseConversionWarning
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        warnings.simplefilter("error", warning)
        qpsolvers.solve_problem(problem.as_qp(sparse=True), installed(name))
        if name != "sip":  # converts in silence
            with pytest.raises(warning):
                qpsolvers.solve_problem(problem.as_qp(), name)


def test_matrices_are_symmetric_to_the_bit() -> None:
    """Some backends read the upper triangle, some the lower: were these different, so would be the answers."""
    for kind in PROBLEM_CLASSES:
        for problem in problems(kind, 3):
            matrix = np.asarray(problem.as_qp().P)
            assert np.array_equal(matrix, matrix.T)


@pytest.mark.parametrize("name", BACKENDS)
def test_no_backend_writes_into_the_problem(name: str) -> None:
    """A matrix with columns in a row, or of one entry, goes on without a copy, and some factor in place."""
    installed(name)
    for size in (1, 5):
        matrix = np.asfortranarray(np.diag(np.full(size, 2e-6)) + 1e-6)
        problem = ContactProblem(np.linspace(0.0, 0.01, size), np.full(size, 40.0), 1e5, matrix)
        scaled = problem.scaled()
        parts = (scaled.compliance, scaled.separation, scaled.lever_arm)
        before = [part.copy() for part in parts]
        answer = adapter_of(name)(scaled, SOLVERS[name].settings)
        assert all(np.array_equal(a, b) for a, b in zip(parts, before, strict=True))
        rotation, _, _ = rotation_and_gap(problem)
        assert answer.rotation == pytest.approx(rotation, rel=AGREEMENT[name][0])
