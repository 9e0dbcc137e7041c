"""Tolerance, time and steps: one word for each, understood by every solver, or refused."""

from __future__ import annotations

import ctypes
import os
from typing import Any

import numpy as np
import pytest
from shared_problems import three_segments
from solver_choice import BACKENDS, CHOLESKY, installed

from easeoff import InputError
from easeoff.contact import SOLVERS, ContactProblem, Status, solve
from easeoff.contact.line_contact.line_contact_solution import solve_on_bending
from easeoff.contact.problem.certificate import EXACT_TOLERANCE
from easeoff.contact.solvers.native import METHODS
from easeoff.contact.solvers.registry import start_force
from easeoff.contact.solvers.solver_limits import Limits, StepBudget, backend_keywords
from easeoff.verification import problems
from easeoff.verification.problem_classes import PROBLEM_CLASSES

PROBLEMS = [next(iter(problems(name, 1, seed=3))) for name in ("realistic", "plain", "lattice", "mixed_arms")]
REALISTIC = PROBLEMS[0]
WITH_TOLERANCE = [name for name in BACKENDS if SOLVERS[name].tolerance_settings]
WITH_TIME = [name for name in SOLVERS if SOLVERS[name].time_setting]
WITH_STEPS = [name for name in SOLVERS if SOLVERS[name].step_setting]
#: Asked for more digits, ECOS has none.
BEST_OF = {"ecos": 1e-4}
#: Looks at its clock every so many steps: small problems are solved before.
SELDOM_LOOKS = "daqp"


# Tolerance


@pytest.mark.parametrize("name", SOLVERS)
def test_certificate_reaches_the_tolerance(name: str) -> None:
    for tolerance in (1e-3, 1e-7):
        if tolerance < BEST_OF.get(name, 0.0):
            continue
        for problem in PROBLEMS[:2] if tolerance > 1e-5 else PROBLEMS:
            solution = solve(problem, installed(name), tolerance=tolerance, polish=False)
            assert solution.certified, (tolerance, solution.message)
            assert solution.certificate.worst <= tolerance
            assert solution.tolerance == (min(tolerance, EXACT_TOLERANCE) if name == "native" else tolerance)


@pytest.mark.thorough
@pytest.mark.parametrize("name", [name for name in SOLVERS if name not in CHOLESKY])
def test_every_class_of_problems_reaches_the_tolerance(name: str) -> None:
    for kind in PROBLEM_CLASSES:
        problem = next(iter(problems(kind, 1, seed=11)))
        for tolerance in (1e-2, 1e-4, 1e-6, 1e-8):
            if tolerance >= BEST_OF.get(name, 0.0):
                solution = solve(problem, installed(name), tolerance=tolerance, polish=False)
                assert solution.certificate.worst <= tolerance, (kind, solution.message)


@pytest.mark.parametrize("name", ["osqp", "scs", "proxqp", "qpalm", "sip", "piqp", "cvxopt", "cvxpy"])
def test_looser_tolerance_takes_fewer_steps(name: str) -> None:
    steps = [solve(REALISTIC, installed(name), tolerance=one, polish=False).iterations for one in (1e-1, 1e-4, 1e-8)]
    assert steps == sorted(steps)
    assert steps[0] < steps[-1]


@pytest.mark.parametrize("name", BACKENDS)
def test_tolerance_of_the_table_gives_the_settings_of_the_table(name: str) -> None:
    entry = SOLVERS[name]
    assert backend_keywords(name, Limits(tolerance=entry.tolerance), {}) == pytest.approx(dict(entry.settings))
    for key in entry.tolerance_settings:
        value = entry.settings[key]
        looser = backend_keywords(name, Limits(tolerance=10.0 * entry.tolerance), {})[key]
        assert looser == pytest.approx(value * 10.0**entry.tolerance_power)
        assert backend_keywords(name, Limits(tolerance=0.99), {})[key] <= 1e-2
        tight = backend_keywords(name, Limits(tolerance=1e-15), {})[key]
        assert min(value, 1e-13) <= tight <= value


@pytest.mark.parametrize("name", SOLVERS)
def test_exact_answers_stay_exact_at_a_loose_tolerance(name: str) -> None:
    solution = solve(REALISTIC, installed(name), tolerance=0.1)
    assert solution.tolerance == EXACT_TOLERANCE
    assert solution.certificate.passes()
    assert solution.rotation == pytest.approx(solve(REALISTIC).rotation, rel=1e-12)


@pytest.mark.parametrize("name", ["native", "osqp", "lemke"])
def test_tolerance_below_rounding_is_not_met_and_not_claimed(name: str) -> None:
    solution = solve(REALISTIC, name, tolerance=1e-30)
    assert solution.status is Status.NOT_CERTIFIED
    assert "misses 1.0e-30" in solution.message
    assert np.isnan(solution.force).all()
    assert solution.certificate.worst < 1e-9


# Time


@pytest.mark.parametrize("name", WITH_TIME)
def test_no_time_is_a_status(name: str) -> None:
    solution = solve(REALISTIC, installed(name), time_limit=0.0, polish=False)
    if name == SELDOM_LOOKS:
        assert solution.certified
    else:
        assert solution.status is Status.TIME_LIMIT
        assert "time limit" in solution.message
        assert np.isnan(solution.force).all()


@pytest.mark.parametrize("name", WITH_TIME)
def test_ample_time_changes_nothing(name: str) -> None:
    assert solve(REALISTIC, installed(name), time_limit=3600.0).certified
    assert solve(REALISTIC, name, time_limit=np.inf).certified


@pytest.mark.parametrize("method", METHODS)
def test_native_method_looks_at_the_clock_before_every_step(method: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """With a clock that goes on by a second at every look, a limit of one leaves no time for a second step."""
    ticks = iter(range(10_000))
    monkeypatch.setattr("easeoff.contact.solvers.solver_limits.perf_counter", lambda: float(next(ticks)))
    monkeypatch.setattr("easeoff.contact.solvers.registry.perf_counter", lambda: 0.0)
    solution = solve(REALISTIC, method=method, time_limit=1.0)
    assert solution.status is Status.TIME_LIMIT
    assert solution.message == "native: ended at the time limit of 1 s"


# Steps


@pytest.mark.parametrize("name", WITH_STEPS)
def test_one_step_is_too_few(name: str) -> None:
    solution = solve(REALISTIC, installed(name), max_iterations=1, polish=False)
    assert solution.status is Status.NOT_CONVERGED
    assert solution.message
    assert np.isnan(solution.force).all()


@pytest.mark.parametrize(
    ("name", "word", "value"),
    [
        *((name, "time_limit", 1.0) for name in SOLVERS if name not in WITH_TIME),
        *((name, "max_iterations", 5) for name in SOLVERS if name not in WITH_STEPS),
    ],
)
def test_solver_without_a_limit_says_who_has_one(name: str, word: str, value: Any) -> None:
    with pytest.raises(InputError, match=rf"^{word} = {value}: must not be given for {name}.*native, clarabel"):
        solve(REALISTIC, installed(name), **{word: value})


@pytest.mark.parametrize("method", [*METHODS, "cascade"])
def test_native_solver_takes_no_step_more_than_allowed(method: str) -> None:
    needed = solve(REALISTIC, method=method).iterations
    solved = [solve(REALISTIC, method=method, max_iterations=limit) for limit in range(1, needed + 1)]
    assert [one.status for one in solved[:-1]] == [Status.NOT_CONVERGED] * (needed - 1)
    assert solved[-1].certified
    assert solved[-1].iterations == needed


def test_steps_are_counted_over_all_methods() -> None:
    budget = StepBudget(Limits(max_iterations=3))
    assert [budget.step() for _ in range(5)] == [True, True, True, False, False]
    assert budget.met is Status.NOT_CONVERGED


# What is no limit


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        ({"tolerance": 0.0}, "tolerance = 0: must be a number above 0 and below 1"),
        ({"tolerance": 1.0}, "tolerance = 1: must be"),
        ({"tolerance": "tight"}, "tolerance = 'tight'"),
        ({"time_limit": -1.0}, "time_limit = -1"),
        ({"time_limit": np.nan}, "time_limit = nan"),
        ({"max_iterations": 0}, "max_iterations = 0"),
        ({"max_iterations": 2.5}, "max_iterations = 2.5"),
    ],
)
@pytest.mark.parametrize("name", ["native", "osqp"])
def test_what_is_no_limit_is_refused(name: str, limits: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError) as error:
        solve(REALISTIC, name, **limits)
    assert words in str(error.value)


def test_limit_in_both_words_is_refused() -> None:
    with pytest.raises(InputError, match=r"eps_abs = 1e-05: must not be given beside tolerance"):
        solve(REALISTIC, "osqp", tolerance=1e-3, eps_abs=1e-5)
    with pytest.raises(InputError, match=r"max_iter = 5: must not be given beside"):
        solve(REALISTIC, "osqp", max_iterations=3, max_iter=5)
    with pytest.raises(InputError, match=r"backend = 'OSQP': must be clarabel"):
        solve(REALISTIC, installed("cvxpy"), tolerance=1e-3, backend="OSQP")


# Warm starts and line contacts


@pytest.mark.parametrize("name", SOLVERS)
def test_start_from_the_forces_of_a_neighbour(name: str) -> None:
    """All give the same answer; those that make use of a start take no more steps from the answer itself."""
    cold = solve(REALISTIC, installed(name), polish=False, tolerance=1e-6)
    neighbour = solve(REALISTIC.with_torque(1.01 * REALISTIC.torque))
    warm = solve(REALISTIC, name, initial_force=neighbour.force, polish=False, tolerance=1e-6)
    assert warm.rotation == pytest.approx(cold.rotation, rel=1e-6)
    own = solve(REALISTIC, name, initial_force=solve(REALISTIC).force, polish=False, tolerance=1e-6)
    if SOLVERS[name].warm_start and name != "cvxopt":
        assert own.iterations <= cold.iterations


def test_start_of_the_wrong_shape_is_refused() -> None:
    with pytest.raises(InputError, match="initial_force = "):
        solve(REALISTIC, initial_force=np.ones(3))
    with pytest.raises(InputError, match="initial_force = "):
        solve(REALISTIC, "osqp", initial_force=np.full(REALISTIC.size, np.nan))


def test_limits_hold_for_line_contacts() -> None:
    data, contact = three_segments()
    statuses: dict[Status, dict[str, Any]] = {
        Status.CERTIFIED: {"max_iterations": 1000, "time_limit": 3600.0, "tolerance": 1e-9},
        Status.NOT_CONVERGED: {"max_iterations": 2},
        Status.TIME_LIMIT: {"time_limit": 0.0},
    }
    for status, limits in statuses.items():
        assert solve_on_bending(ContactProblem(*data), contact, **limits)[0].status is status
        assert solve_on_bending(ContactProblem(*data), contact, "clarabel", polish=False, **limits)[0].status is status


def test_dense_problem_has_limits_too() -> None:
    dense = ContactProblem(REALISTIC.separation, REALISTIC.lever_arm, REALISTIC.torque, REALISTIC.dense_compliance)
    assert solve(dense, max_iterations=1).status is Status.NOT_CONVERGED
    assert solve(dense, tolerance=1e-3, max_iterations=100, time_limit=3600.0).certified


@pytest.mark.parametrize("name", ["clarabel", "piqp", "daqp"])
def test_limit_in_other_words_is_refused_with_the_word_for_it(name: str) -> None:
    problem = ContactProblem(np.zeros(2), np.full(2, 50.0), 2.0e5, np.diag([2e-6, 2e-6]))
    with pytest.raises(InputError, match="give max_iterations, which every solver takes that has one"):
        solve(problem, installed(name), maxiter=5)


@pytest.mark.skipif(os.name == "nt", reason="its library has an output of its own there")
def test_highs_says_nothing(capfd: pytest.CaptureFixture[str]) -> None:
    """Its banner comes from its own library, past Python's output."""
    problem = ContactProblem(np.zeros(2), np.full(2, 50.0), 2.0e5, np.diag([2e-6, 2e-6]))
    assert solve(problem, installed("highs")).certified
    ctypes.CDLL(None).fflush(None)  # what the library would have said waits there
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("name", [name for name, entry in SOLVERS.items() if entry.warm_start])
@pytest.mark.parametrize("size", [1e-300, 1e-60, 1e60, 1e150, 1e307])
def test_the_size_of_forces_to_start_from_does_not_matter(name: str, size: float) -> None:
    """They are scaled to the torque: at 1e150 N a backend did not return."""
    reference = solve(REALISTIC)
    found = solve(REALISTIC, installed(name), initial_force=size * (reference.force / reference.force.max()))
    assert found.status is Status.CERTIFIED
    assert found.rotation == pytest.approx(reference.rotation, rel=1e-12)


def test_forces_to_start_from_are_in_balance_or_of_the_size_of_the_load() -> None:
    near = solve(REALISTIC)
    for size in (1e-3, 1.0, 1e200):
        assert start_force(size * near.force, REALISTIC) == pytest.approx(near.force, rel=1e-9)
    back = ContactProblem([0.0, 0.0], [40.0, -40.0], 1e3, np.diag([1e-6, 1e-6]))
    for given in ([0.0, 1.0], [1.0, 1.0], [1e300, 1e300]):
        assert 0.0 < start_force(np.array(given), back).max() == back.scaling.force
    assert start_force(np.array([-1.0, 0.0]), back).tolist() == [0.0, 0.0]
