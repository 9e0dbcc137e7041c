"""The backends: their multipliers are rotation and gaps, and what misleads others with them does not mislead here."""

from __future__ import annotations

import concurrent.futures
import importlib
import math
import multiprocessing
import re
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import qpsolvers
from numpy.typing import NDArray
from solver_choice import BACKENDS, LIFTING, installed

from easeoff.contact import ContactProblem, available_solvers, certify, solve
from easeoff.contact.certificate import EXACT_TOLERANCE
from easeoff.contact.solvers import SOLVERS, Status, cvxpy_programme
from easeoff.contact.solvers.answer import ScaledAnswer
from easeoff.contact.solvers.problem_classes import PROBLEM_CLASSES, problems
from easeoff.study.compare.worker import Request, workers

DOCS = Path(__file__).parents[1] / "docs"

#: Agreement with the native solver, unpolished: of the rotation from the multiplier of the balance, relative, and of
#: the gaps from the multipliers of the bounds, over the greatest deflection.
AGREEMENT = {
    "clarabel": (1e-8, 1e-4),
    "osqp": (1e-9, 1e-8),
    "daqp": (1e-9, 1e-8),
    "piqp": (1e-7, 1e-4),
    "proxqp": (1e-8, 1e-5),
    "highs": (1e-12, 1e-11),
    "scs": (1e-8, 1e-6),
    "sip": (1e-9, 1e-4),
    "pyqpmad": (1e-5, 1e-4),
    "qpalm": (1e-7, 1e-6),
    "quadprog": (1e-5, 1e-4),
    "cvxopt": (1e-7, 1e-4),
    "ecos": (1e-4, 1e-3),
    "cvxpy": (1e-8, 1e-4),
    "lemke": (1e-12, 1e-11),
}
POLISHED_AGREEMENT = 1e-13

#: Classes whose compliance may be singular to rounding, on which a method that begins with a Cholesky factor may fail.
NEARLY_SINGULAR = {"weak_local", "nearly_singular", "spread_local", "random_dense"}
CHOLESKY = {"pyqpmad", "quadprog"}

Array = NDArray[np.float64]


def adapter(name: str) -> Any:
    return importlib.import_module(f"easeoff.contact.solvers.{name}")


def answer_of(name: str, problem: ContactProblem, **settings: Any) -> ScaledAnswer:
    """What the backend answers to the scaled problem, before anybody judges it."""
    scaled = problem.scaling.scale(problem)
    found: ScaledAnswer = adapter(name).solve_scaled(scaled, {**SOLVERS[name].settings, **settings})
    return found


def rotation_and_gap(problem: ContactProblem) -> tuple[float, Array, float]:
    """Rotation and gaps of the native solver in scaled numbers, and the greatest deflection."""
    reference, scaled = solve(problem), problem.scaling.scale(problem)
    rotation = reference.elastic_rotation / problem.scaling.rotation
    deflection = scaled.compliance @ (reference.force / problem.scaling.force)
    return rotation, deflection + scaled.separation - rotation * scaled.lever_arm, float(np.abs(deflection).max())


# Agreement


@pytest.mark.parametrize("name", BACKENDS)
def test_multipliers_are_rotation_and_gaps(name: str) -> None:
    installed(name)
    forms = ("dense", "lifted") if name in LIFTING else ("dense",)
    for kind in ("realistic", "plain", "signed_modes", "far_apart", "interfering", "mixed_arms"):
        for problem in problems(kind, 2, seed=1):
            rotation, gap, deflection = rotation_and_gap(problem)
            for form in forms:
                answer = answer_of(name, problem, **({"form": form} if form == "lifted" else {}))
                assert answer.rotation == pytest.approx(rotation, rel=AGREEMENT[name][0])
                assert answer.gap is not None
                assert np.abs(answer.gap - gap).max() <= AGREEMENT[name][1] * deflection


@pytest.mark.parametrize("polish", [False, True])
@pytest.mark.parametrize("name", BACKENDS)
def test_backends_agree_with_the_native_solver(name: str, polish: bool) -> None:
    installed(name)
    for problem in [*problems("realistic", 4), *problems("plain", 4), *problems("signed_modes", 2)]:
        reference = solve(problem)
        solution = solve(problem, name, polish=polish)
        assert solution.status is Status.CERTIFIED
        assert solution.polished is polish
        assert solution.certificate.passes(EXACT_TOLERANCE if polish else SOLVERS[name].tolerance)
        agreement = POLISHED_AGREEMENT if polish else AGREEMENT[name][0]
        assert solution.elastic_rotation == pytest.approx(reference.elastic_rotation, rel=agreement)


@pytest.mark.parametrize("name", BACKENDS)
def test_backends_reach_their_level_on_degenerate_problems(name: str) -> None:
    """Or say that they do not: where the compliance is singular to rounding, a Cholesky factor may be worthless."""
    installed(name)
    for kind in PROBLEM_CLASSES:
        for problem in problems(kind, 1 if name == "cvxpy" else 3, seed=11):
            solution = solve(problem, name, polish=False)
            if name in CHOLESKY and kind in NEARLY_SINGULAR:
                assert solution.status in (Status.CERTIFIED, Status.NOT_CERTIFIED, Status.SOLVER_FAILED)
            else:
                assert solution.status is Status.CERTIFIED


def test_table_of_the_page_keeps_the_tolerances() -> None:
    """If not: run docs/make_agreement.py."""
    page = (DOCS / "contact_problems.md").read_text(encoding="utf-8").split("### Agreement\n", 1)[1]
    table = [[c.strip() for c in line.strip("|").split("|")] for line in page.splitlines() if line.startswith("| `")]
    listed = {row[0].strip("`"): row[1:] for row in table[: len(BACKENDS)]}
    assert list(listed) == BACKENDS
    for name, cells in listed.items():
        for certified, rotation, gap, certificate in (cells[:4], cells[4:]):
            assert float(rotation) <= AGREEMENT[name][0]
            assert float(gap) <= AGREEMENT[name][1]
            assert float(certificate) <= SOLVERS[name].tolerance
            solved, number = map(int, re.findall(r"\d+", certified))
            assert solved == number or (name in CHOLESKY and solved > 0.9 * number)


# CVXPY


@pytest.fixture
def translations(monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, int]]:
    """Shapes of the programmes that CVXPY had to translate, with an empty shelf."""
    made: list[tuple[int, int]] = []

    class Counted(cvxpy_programme.ParametrisedProgramme):
        def __init__(self, root: cvxpy_programme.Root) -> None:
            super().__init__(root)
            made.append(root.shape)

    monkeypatch.setattr(cvxpy_programme, "ParametrisedProgramme", Counted)
    monkeypatch.setattr(cvxpy_programme, "_shelf", type(cvxpy_programme._shelf)())
    return made


def dense(problem: ContactProblem) -> ContactProblem:
    return ContactProblem(problem.separation, problem.lever_arm, problem.torque, problem.dense_compliance)


def mesh_cycle() -> Iterator[ContactProblem]:
    """Two sizes, two torques and small changes of all data, as along a mesh cycle."""
    for size_seed in (0, 3):
        problem = next(problems("realistic", 1, seed=size_seed))
        diagonal, factor = problem.compliance
        for change in (1.0, 1.1, 1.3):
            parts = (diagonal * change, factor * change)
            for torque in (problem.torque, 0.4 * problem.torque):
                separation, arm = problem.separation * change, problem.lever_arm + change
                yield ContactProblem(separation, arm, torque, parts)


def assert_right(problem: ContactProblem, **settings: Any) -> None:
    solution = solve(problem, "cvxpy", polish=False, **settings)
    assert solution.certified
    assert solution.elastic_rotation == pytest.approx(solve(problem).elastic_rotation, rel=AGREEMENT["cvxpy"][0])


def test_programme_is_translated_once_for_each_form(translations: list[tuple[int, int]]) -> None:
    for problem in mesh_cycle():
        assert_right(dense(problem))
        assert_right(problem, form="lifted")
    first, second = (next(problems("realistic", 1, seed=seed)) for seed in (0, 3))
    modes = [p.modal_basis.modes.shape[0] * p.modal_basis.modes.shape[2] for p in (first, second) if p.modal_basis]
    sizes = (first.size, second.size)
    assert first.size != second.size
    expected = [(n, n) for n in sizes] + [(n, n + k) for n, k in zip(sizes, modes, strict=True)]
    assert sorted(translations) == sorted(expected)


def test_every_number_of_the_programme_is_a_parameter(translations: list[tuple[int, int]]) -> None:
    for problem in mesh_cycle():
        root = cvxpy_programme.compliance_root(problem.scaling.scale(problem), lifted=True)
        np.testing.assert_allclose(
            (root.matrix @ root.matrix.T).toarray(), problem.scaling.scale(problem).compliance, rtol=1e-12, atol=1e-15
        )
        assert cvxpy_programme.ParametrisedProgramme(root).programme.is_dpp()


def test_answer_does_not_depend_on_what_was_solved_before(translations: list[tuple[int, int]]) -> None:
    first, *others = (dense(problem) for problem in mesh_cycle())
    alone = solve(first, "cvxpy", polish=False)
    for other in others:
        solve(other, "cvxpy", polish=False)
    again = solve(first, "cvxpy", polish=False)
    assert len(translations) == 2
    assert np.array_equal(again.force, alone.force)
    assert again.rotation == alone.rotation


def test_written_out_and_parametrised_agree(translations: list[tuple[int, int]]) -> None:
    for problem in [*problems("plain", 2), *problems("nearly_singular", 2), *problems("mixed_arms", 2)]:
        for form in ("dense", "lifted"):
            for parametrised in (True, False):
                assert_right(problem, form=form, parametrised=parametrised)
    before = len(translations)
    assert_right(next(problems("plain", 1)), parametrised=False)
    assert len(translations) == before


def test_shelf_is_small_and_keeps_nothing_that_failed(translations: list[tuple[int, int]]) -> None:
    problem = dense(next(problems("realistic", 1)))
    assert not solve(problem, "cvxpy", backend="nobody").certified
    assert not cvxpy_programme._shelf
    for size in range(2, 4 + cvxpy_programme.KEPT):
        parts = (np.full(size, 2e-6), np.zeros((size, 0)))
        assert_right(dense(ContactProblem(np.zeros(size), np.full(size, 40.0), 1e5, parts)))
    assert len(cvxpy_programme._shelf) == cvxpy_programme.KEPT


def test_backend_behind_cvxpy_has_a_programme_of_its_own(translations: list[tuple[int, int]]) -> None:
    problem = dense(next(problems("realistic", 1)))
    by_osqp: dict[str, Any] = {"backend": "osqp", "eps_abs": 1e-9, "eps_rel": 1e-9}
    nothing: dict[str, Any] = {}
    for settings in (nothing, by_osqp, nothing):
        solution = solve(problem, "cvxpy", **settings)
        assert solution.rotation == pytest.approx(solve(problem).rotation, rel=1e-9)
    assert len(translations) == 2


def test_threads_do_not_share_a_programme() -> None:
    cycle = [dense(problem) for problem in mesh_cycle()] * 3
    reference = [solve(problem).elastic_rotation for problem in cycle]
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda problem: solve(problem, "cvxpy", polish=False), cycle))
    assert [f.elastic_rotation for f in found] == pytest.approx(reference, rel=AGREEMENT["cvxpy"][0])


def rotation_by_cvxpy(problem: ContactProblem) -> float:
    return solve(problem, "cvxpy", polish=False).elastic_rotation


def test_process_that_was_forked_uses_what_it_inherits() -> None:
    if "fork" not in multiprocessing.get_all_start_methods():
        pytest.skip("there is no fork here")
    cycle = [dense(problem) for problem in mesh_cycle()]
    here = [rotation_by_cvxpy(problem) for problem in cycle]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # other tests may have left threads, which newer versions warn of
        context = multiprocessing.get_context("fork")
        with concurrent.futures.ProcessPoolExecutor(1, mp_context=context) as pool:
            assert list(pool.map(rotation_by_cvxpy, cycle, timeout=60.0)) == here


# Traps


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


def test_raw_units_that_bring_a_process_down_do_no_harm_when_scaled() -> None:
    """HiGHS goes round in circles, or writes where it must not: in a process of its own."""
    installed("highs")
    with workers(["highs"]) as pool:
        for seed in (0, 4):
            problem = next(problems("realistic", 1, seed=seed))
            reference = solve(problem).elastic_rotation
            found = pool["highs"].run(Request(problem, "raw", 0.2))
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
    assert all(solve(problem, "ecos", polish=False).certified for problem in chosen)


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
        scaled = problem.scaling.scale(problem)
        parts = (scaled.compliance, scaled.separation, scaled.lever_arm)
        before = [part.copy() for part in parts]
        answer: ScaledAnswer = adapter(name).solve_scaled(scaled, SOLVERS[name].settings)
        assert all(np.array_equal(a, b) for a, b in zip(parts, before, strict=True))
        rotation, _, _ = rotation_and_gap(problem)
        assert answer.rotation == pytest.approx(rotation, rel=AGREEMENT[name][0])
