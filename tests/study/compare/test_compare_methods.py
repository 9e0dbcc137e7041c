"""Methods of a comparison: liars, other data in every call, starts that are used, tolerances, threads."""

from __future__ import annotations

import itertools
import warnings
from pathlib import Path
from typing import Any

import fake_solvers
import numpy as np
import pytest
import qpsolvers
from solver_choice import BACKENDS, installed

from easeoff.contact import SOLVERS, ContactProblem, solve, write_problems
from easeoff.contact.problem.certificate import no_answer, with_certificate
from easeoff.study.compare import compare
from easeoff.study.compare.attempt import (
    FACTOR_STEP,
    STARTING_SOLVERS,
    UNMEASURED_FACTOR,
    Attempt,
    Method,
    PosedProblem,
    Request,
    attempt,
    load_adapter,
    load_factor,
    multiplied,
    posed_problems,
    posed_residual,
)
from easeoff.study.compare.comparison import Choice, methods_of
from easeoff.study.library.library_files import write_library
from easeoff.verification import problems
from easeoff.verification.problem_classes import PROBLEM_CLASSES

LIARS = ["lie", "zero", "start", "stale"]
LIMIT = 3600.0
KINDS = {"polish": True, "raw": True, "defaults": False, "tolerances": (), "threads": 1}


def choice(repetitions: int = 2, **chosen: Any) -> Choice:
    return Choice(repetitions, LIMIT, **{**KINDS, **chosen})


def tried(name: str, posed: list[PosedProblem], chosen: Choice) -> dict[tuple[Any, ...], list[Attempt]]:
    """Attempts of a fake solver at problems, in the order of a comparison; it gets a warm start, too."""
    solver, adapter = f"fake_solvers:{name}", getattr(fake_solvers, name)
    fake_solvers._kept.clear()
    found: dict[tuple[Any, ...], list[Attempt]] = {}
    first = next(methods_of(solver, chosen))
    attempt(Request(multiplied(posed[0].problem, UNMEASURED_FACTOR), first, LIMIT), adapter)
    for item in posed:
        methods = list(methods_of(solver, chosen))
        if item.before is not None:
            methods.insert(1, Method(solver, "scaled", "warm"))
        for method in methods:
            for repetition in range(1, chosen.repetitions + 1):
                one = item.varied(load_factor(method, repetition, item.number))
                outcome = attempt(Request(one.problem, method, LIMIT, one.start(method)), adapter)
                found.setdefault((item.name or item.number, method.settings, method.start), []).append(outcome)
    return found


def assert_found_out(name: str, posed: list[PosedProblem]) -> None:
    """For the one that remembers its answers, the next call is at the next problem or at the same one once more."""
    for repetitions in (1, 2) if name == "stale" else (1,):
        for at, outcomes in tried(name, posed, choice(repetitions)).items():
            assert {one.claim for one in outcomes} <= {"solved", "raised"}, at
            assert not any(one.certificate.passes(1e-5) for one in outcomes), at
            assert not any(one.polished for one in outcomes), at


@pytest.fixture(scope="module")
def classes(tmp_path_factory: pytest.TempPathFactory) -> list[list[PosedProblem]]:
    """Two problems of each class, as a comparison reads them."""
    path, found = tmp_path_factory.mktemp("classes") / "class.nc", []
    for kind in PROBLEM_CLASSES:
        loaded = [problem for problem in problems(kind, 2, seed=11) if problem.torque > 0.0 and problem.size > 1]
        write_problems(loaded, path)
        found.append(posed_problems(path, kind))
    return found


@pytest.mark.parametrize("name", LIARS)
def test_liar_is_found_out_on_every_class_of_problem(name: str, classes: list[list[PosedProblem]]) -> None:
    for posed in classes:
        assert_found_out(name, posed)


@pytest.mark.thorough
@pytest.mark.parametrize("name", LIARS)
@pytest.mark.parametrize("part", ["small", "medium"])
def test_liar_is_found_out_on_the_library(name: str, part: str, library_files: dict[str, Path]) -> None:
    assert_found_out(name, posed_problems(library_files[part], part))


@pytest.fixture(scope="module")
def library_files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("library")
    return {written.path.stem: written.path for written in write_library(folder, ("small", "medium"))}


# Other data in every call


def test_no_call_has_the_data_of_the_one_before() -> None:
    chosen = choice(5, tolerances=(1e-3, 1e-6, 1e-9))
    factors = [UNMEASURED_FACTOR]
    for number, method in itertools.product(range(60), methods_of("osqp", chosen)):
        factors += [load_factor(method, repetition, number) for repetition in range(1, 6)]
    assert min(factors) == 1.0
    assert max(factors) < 1.5
    assert np.abs(np.diff(factors)).min() >= 0.49 * FACTOR_STEP


def test_multiplied_problem_has_the_multiplied_answer() -> None:
    for problem in problems("realistic", 3, seed=2):
        for factor in (1.25, 1.3):
            one, other = solve(problem), solve(multiplied(problem, factor))
            np.testing.assert_allclose(other.force, factor * one.force, rtol=0.0, atol=1e-10 * one.force.max())
            assert other.elastic_rotation == pytest.approx(factor * one.elastic_rotation, rel=1e-12)


def test_answer_to_the_problem_before_is_no_start_where_it_solves_this_one(tmp_path: Path) -> None:
    problem = next(problems("realistic", 1, seed=4))
    same = ContactProblem(problem.separation, problem.lever_arm, problem.torque, problem.dense_compliance)
    write_problems([problem, same, problem.with_torque(1.2 * problem.torque)], tmp_path / "three.nc")
    assert [item.before is None for item in posed_problems(tmp_path / "three.nc", "three")] == [True, True, False]


# Starts


def neighbours(factor: float = 1.01) -> list[tuple[ContactProblem, np.ndarray[Any, np.dtype[np.float64]]]]:
    return [
        (problem, solve(problem.with_torque(factor * problem.torque)).force)
        for problem in problems("realistic", 4, seed=4)
    ]


@pytest.mark.parametrize("name", [name for name in BACKENDS if name in STARTING_SOLVERS])
def test_start_is_used(name: str) -> None:
    adapter = load_adapter(installed(name))
    changed = 0
    # The alternating direction method looks at its iterates once in 25 steps: a start must be near to save any.
    for problem, force in neighbours(1.0 if name == "osqp" else 1.01):
        cold = attempt(Request(problem, Method(name, "scaled"), LIMIT), adapter)
        warm = attempt(Request(problem, Method(name, "scaled", "warm"), LIMIT, force), adapter)
        assert warm.claim == cold.claim == "solved"
        assert warm.certificate.passes(SOLVERS[name].tolerance)
        changed += (warm.iterations, warm.elastic_rotation) != (cold.iterations, cold.elastic_rotation)
    assert changed > 0


@pytest.mark.parametrize("name", ["clarabel", "piqp", "highs", "qpalm", "quadprog", "ecos", "pyqpmad"])
def test_start_is_ignored_by_those_that_are_not_measured_with_one(name: str) -> None:
    """To the bit: a warm start of these would measure noise."""
    assert installed(name) not in STARTING_SOLVERS
    for problem, force in neighbours():
        programme = problem.as_qp(sparse=SOLVERS[name].sparse)
        given: dict[str, Any] = {"solver": name, "verbose": False, **SOLVERS[name].settings}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            cold = qpsolvers.solve_problem(programme, **given)
            warm = qpsolvers.solve_problem(programme, initvals=force / problem.scaling.force, **given)
        np.testing.assert_array_equal(cold.x, warm.x)


def test_start_of_the_lifted_form_has_its_modal_amplitudes() -> None:
    size = SOLVERS["osqp"].lifted_from
    assert size is not None
    x = np.linspace(-1.0, 1.0, size)
    pair = (np.full(size, 2e-6), 1e-3 * np.polynomial.legendre.legvander(x, 7))
    problem = ContactProblem(0.02 * x**2, np.full(size, 40.0), 1e5, pair)
    adapter = load_adapter(installed("osqp"))
    cold = attempt(Request(problem, Method("osqp", "scaled"), LIMIT), adapter)
    warm = attempt(Request(problem, Method("osqp", "scaled", "warm"), LIMIT, solve(problem).force), adapter)
    assert warm.certificate.passes(1e-6)
    assert warm.iterations < cold.iterations


# Tolerances


@pytest.mark.parametrize("name", BACKENDS)
def test_sweep_gives_a_solver_its_tolerance_by_its_own_names(name: str) -> None:
    adapter = load_adapter(installed(name))
    swept = list(methods_of(name, choice(tolerances=(1e-2, 1e-8))))[-2:]
    names = SOLVERS[name].tolerance_settings
    if not names:
        assert [method.settings for method in swept] != ["sweep", "sweep"]
        return
    assert [method.tolerance for method in swept] == [1e-2, 1e-8]
    table = SOLVERS[name].settings
    for method in swept:
        given = method.keywords(LIMIT)
        assert {given[key] for key in names} == {method.tolerance}
        assert set(given) >= set(table)
        found = attempt(Request(next(problems("realistic", 1, seed=4)), method, LIMIT), adapter)
        assert found.claim != "raised", found.message
        assert found.certificate.passes(1.0)


@pytest.mark.parametrize("name", ["clarabel", "piqp", "scs", "cvxopt"])
def test_finer_tolerance_gives_a_better_certificate(name: str) -> None:
    adapter = load_adapter(installed(name))
    problem = next(problems("realistic", 1, seed=4))
    worst = [
        attempt(Request(problem, Method(name, "sweep", "cold", tolerance), LIMIT), adapter).certificate.worst
        for tolerance in (1e-2, 1e-9)
    ]
    assert worst[1] < 1e-3 * worst[0]


def test_function_of_ones_own_gets_the_tolerance_of_the_sweep() -> None:
    assert Method("my:own", "sweep", "cold", 1e-3).keywords(5.0) == {"time_limit": 5.0, "tolerance": 1e-3}
    assert Method("my:own", "scaled").keywords(5.0) == {"time_limit": 5.0}


def test_raw_gives_a_solver_nothing_but_a_time_limit() -> None:
    assert Method("clarabel", "raw").keywords(5.0) == {"time_limit": 5.0}
    assert Method("scs", "raw").keywords(5.0) == {"time_limit_secs": 5.0}
    assert Method("quadprog", "raw").keywords(5.0) == {}


# Threads


@pytest.mark.thorough
def test_verdicts_are_the_same_with_other_threads(tmp_path: Path) -> None:
    """The dense solvers, whose sums depend on how many threads share them."""
    chosen = [next(problems(kind, 1, seed=5)) for kind in PROBLEM_CLASSES]
    write_problems(chosen, tmp_path / "problems.nc")
    solvers = [name for name in ("native", "clarabel", "daqp", "piqp", "quadprog") if name in ["native", *BACKENDS]]
    verdicts = []
    for threads in (1, 2):
        given: dict[str, Any] = {"solvers": solvers, "repetitions": 1, "time_limit": LIMIT, "polish": True}
        table = compare([tmp_path / "problems.nc"], tmp_path / str(threads), threads=threads, **given)
        exact = table["worst_residual"].values <= 1e-9
        verdicts.append([table["certified"].values.tolist(), exact.tolist(), table["polished"].values.tolist()])
    assert verdicts[0] == verdicts[1]


# Residuals on the problem as the solver got it


def _programme(problem: ContactProblem) -> qpsolvers.Problem:
    """The problem in mm and N."""
    row, torque = problem.lever_arm[np.newaxis, :], np.array([problem.torque])
    return qpsolvers.Problem(problem.dense_compliance, problem.separation, A=row, b=torque, lb=np.zeros(problem.size))


@pytest.mark.parametrize("raw", [False, True])
def test_posed_residual_is_the_worst_that_qpsolvers_finds(raw: bool) -> None:
    """Of the programme in the solver's own numbers, with the gaps as multipliers where they are not negative."""
    problem = next(problems("realistic", 1, seed=4))
    given = ContactProblem(problem.separation, problem.lever_arm, problem.torque, problem.dense_compliance)
    truth = solve(given).answer
    rng = np.random.default_rng(3)
    for size in (1e-9, 1e-6, 1e-3):
        force = truth.force * (1.0 + size * rng.uniform(-1.0, 1.0, given.size))
        turned = truth.elastic_rotation * (1.0 + size)
        answer = with_certificate(given, force, turned)
        scaled, scaling = given.scaled(), given.scaling
        programme: Any = _programme(given) if raw else scaled.as_qp()
        unknowns = force if raw else force / scaling.force
        rotation = answer.rotation if raw else turned / scaling.rotation
        gap = programme.P @ unknowns + programme.q - rotation * programme.A[0]
        multipliers = -np.maximum(gap, 0.0)
        found = qpsolvers.Solution(programme, found=True, x=unknowns, y=np.array([-rotation]), z=np.empty(0))
        found.z_box = multipliers
        work, preload = unknowns @ programme.P @ unknowns, programme.q @ unknowns
        terms = (programme.P @ unknowns, programme.q, rotation * programme.A[0])
        worst = max(
            found.primal_residual() / (1.0 + programme.b[0]),
            found.dual_residual() / (1.0 + max(np.abs(term).max() for term in terms)),
            found.duality_gap() / (1.0 + max(abs(work), abs(preload), abs(rotation * programme.b[0]))),
        )
        assert posed_residual(given, answer, raw=raw) == pytest.approx(worst, rel=1e-6, abs=1e-15)


def test_answer_may_keep_its_own_criterion_and_not_be_certified() -> None:
    """A force of 1e-3 on a segment with a gap of 1e-3: their product is 1e-6, the smaller one of the two is not."""
    small = 1e-3
    problem = ContactProblem([0.0, 1e-3], [50.0, 50.0], 5.0e4, np.diag([1e-6, 1e-6]))
    force = np.array([1000.0 * (1.0 - small), 1000.0 * small])
    answer = with_certificate(problem, force, 1e-6 * force[0] / 50.0)  # no gap at the first segment
    assert answer.certificate.complementarity == pytest.approx(small, rel=0.01)
    assert posed_residual(problem, answer) < 4.0 * small**2
    assert np.isnan(posed_residual(problem, no_answer(2)))
