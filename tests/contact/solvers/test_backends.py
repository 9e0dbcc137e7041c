"""The backends agree with the native solver, on the problem library too; CVXPY with the problem translated once."""

from __future__ import annotations

import concurrent.futures
import importlib
import math
import multiprocessing
import re
import sys
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from places import DOCS
from runs import in_copies
from solver_choice import (
    AGREEMENT,
    BACKENDS,
    CHOLESKY,
    LIFTING,
    NEARLY_SINGULAR,
    POLISHED_AGREEMENT,
    answer_of,
    dense,
    installed,
    rotation_and_gap,
)

from easeoff.contact import SOLVERS, ContactProblem, Status, solve
from easeoff.contact.problem.certificate import EXACT_TOLERANCE
from easeoff.contact.solvers.adapters import cvxpy
from easeoff.study.library import entries, generate, reference_answers
from easeoff.study.library.library_entries import USUAL_PARTS
from easeoff.verification import problems
from easeoff.verification.problem_classes import PROBLEM_CLASSES


@pytest.mark.parametrize("name", BACKENDS)
def test_multipliers_are_rotation_and_gaps(name: str) -> None:
    installed(name)
    forms = ("dense", "lifted") if name in LIFTING else ("dense",)
    for kind in ("realistic", "plain", "signed_modes", "far_apart", "interfering", "mixed_arms"):
        for problem in problems(kind, 1, seed=1):
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
    for problem in [*problems("realistic", 2), *problems("plain", 2), *problems("signed_modes", 1)]:
        reference = solve(problem)
        solution = solve(problem, name, polish=polish, tolerance=SOLVERS[name].tolerance)
        assert solution.status is Status.CERTIFIED
        assert solution.polished is polish
        assert solution.certificate.passes(EXACT_TOLERANCE if polish else SOLVERS[name].tolerance)
        agreement = POLISHED_AGREEMENT if polish else AGREEMENT[name][0]
        assert solution.elastic_rotation == pytest.approx(reference.elastic_rotation, rel=agreement)


@pytest.mark.parametrize("name", BACKENDS)
def test_forces_below_the_tolerance_are_no_contact(name: str) -> None:
    """Of an answer that is not exact; the sets of exact ones are those of their forces."""
    installed(name)
    for problem in problems("plain", 2, seed=3):
        reference = solve(problem)
        assert np.array_equal(reference.active, reference.force > 0.0)
        polished = solve(problem, name, polish=True)
        assert np.array_equal(polished.active, polished.force > 0.0)
        raw = solve(problem, name, polish=False, tolerance=SOLVERS[name].tolerance)
        lost = reference.active & ~raw.active
        assert np.all(raw.force[raw.active] > raw.tolerance * raw.force.max())
        assert np.all(raw.force[lost] <= raw.tolerance * raw.force.max())
        assert np.all(reference.force[raw.active & ~reference.active] == 0.0)
        told = f"{np.count_nonzero(raw.active)} of {problem.size} segments in contact"
        assert told in repr(raw)


def test_tiny_forces_of_an_interior_point_method_do_not_count() -> None:
    installed("clarabel")
    random = np.random.default_rng(0)
    rows = random.normal(size=(30, 30))
    compliance = 1e-6 * (rows @ rows.T / 30.0 + 0.1 * np.eye(30))
    problem = ContactProblem(random.uniform(0.0, 0.02, 30), random.uniform(40.0, 60.0, 30), 5e4, compliance)
    solution = solve(problem, "clarabel", polish=False, tolerance=SOLVERS["clarabel"].tolerance)
    assert np.count_nonzero(solution.force > 0.0) > 1  # its barrier keeps some from zero
    assert np.array_equal(solution.active, solve(problem).active)


@pytest.mark.parametrize("name", BACKENDS)
def test_backends_reach_their_level_on_degenerate_problems(name: str) -> None:
    """Or say that they do not: where the compliance is singular to rounding, a Cholesky factor may be worthless."""
    installed(name)
    for kind in PROBLEM_CLASSES:
        for problem in problems(kind, 1, seed=11):
            solution = solve(problem, name, polish=False, tolerance=SOLVERS[name].tolerance)
            if name in CHOLESKY and kind in NEARLY_SINGULAR:
                assert solution.status in (Status.CERTIFIED, Status.NOT_CERTIFIED, Status.SOLVER_FAILED)
            else:
                assert solution.status is Status.CERTIFIED


def test_table_of_the_page_keeps_the_tolerances() -> None:
    """If not: run docs/make agreement."""
    page = (DOCS / "how_it_works" / "notes" / "contact_solvers.md").read_text(encoding="utf-8")
    lines = page.split("## Agreement\n", 1)[1].splitlines()
    table = [[c.strip() for c in line.strip("|").split("|")] for line in lines if line.startswith("| `")]
    listed = {row[0].strip("`"): row[1:] for row in table[: len(BACKENDS)]}
    assert list(listed) == BACKENDS
    for name, cells in listed.items():
        for certified, rotation, gap, certificate in (cells[:4], cells[4:]):
            assert float(rotation) <= AGREEMENT[name][0]
            assert float(gap) <= AGREEMENT[name][1]
            assert float(certificate) <= SOLVERS[name].tolerance
            solved, number = map(int, re.findall(r"\d+", certified))
            assert solved == number or (name in CHOLESKY and solved > 0.9 * number)


# Every backend on the problem library: within its row of the table, or an honest failure on a singular compliance


ANSWERS = reference_answers()
#: Larger ones take those backends seconds each that have no use for the structure; `docs/make agreement` has them.
LARGEST_DENSE = 500


@pytest.fixture(scope="module")
def library() -> dict[str, ContactProblem]:
    """The library, without sequences, whose problems are alike, and without what takes backends minutes each."""
    return {entry.name: problem for entry, problem in generate(e for e in entries() if e.part in USUAL_PARTS)}


@pytest.mark.thorough
@pytest.mark.parametrize("name", BACKENDS)
def test_backend_keeps_to_the_table_on_the_library(name: str, library: dict[str, ContactProblem]) -> None:
    installed(name)
    entry, (agreement, _) = SOLVERS[name], AGREEMENT[name]
    largest = math.inf if entry.largest is None else min(entry.largest, LARGEST_DENSE)
    for title, problem in library.items():
        if problem.size > largest:
            continue
        solution = solve(problem, name, polish=False, tolerance=entry.tolerance)
        if not solution.certified:
            assert entry.definite, (title, solution.status, solution.certificate)
            assert math.isinf(ANSWERS[title].condition_number), title
            assert solution.status in (Status.SOLVER_FAILED, Status.NOT_CERTIFIED), title
            assert "singular to rounding" in solution.message
            continue
        assert solution.certificate.worst <= entry.tolerance
        expected = ANSWERS[title].elastic_rotation
        assert solution.elastic_rotation == pytest.approx(expected, rel=max(agreement, 1e-8)), title


@pytest.mark.thorough
@pytest.mark.parametrize("name", [name for name in BACKENDS if SOLVERS[name].largest])
def test_dense_backends_keep_to_the_table_at_a_thousand_segments(name: str, library: dict[str, ContactProblem]) -> None:
    installed(name)
    (title,) = (t for t, problem in library.items() if t.startswith("fm-11x41-fine") and problem.size == 999)
    solution = solve(library[title], name, polish=False, tolerance=SOLVERS[name].tolerance)
    assert solution.certified, (solution.status, solution.message)
    assert solution.elastic_rotation == pytest.approx(ANSWERS[title].elastic_rotation, rel=AGREEMENT[name][0])


@pytest.mark.thorough
def test_polished_answers_are_exact_on_the_library(library: dict[str, ContactProblem]) -> None:
    for title, problem in library.items():
        for name in ("clarabel", "piqp"):
            solution = solve(problem, name)
            assert solution.certified, (title, name)
            assert solution.polished, (title, name)
            assert solution.certificate.worst <= 1e-9


# CVXPY with the problem translated once: right whatever was solved before, beside or in another process


@pytest.fixture
def translations(monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, int]]:
    """Shapes of the programmes that CVXPY had to translate, with an empty shelf."""
    made: list[tuple[int, int]] = []

    class Counted(cvxpy.ParametrisedProgramme):
        def __init__(self, root: cvxpy.Root) -> None:
            super().__init__(root)
            made.append(root.shape)

    monkeypatch.setattr(cvxpy, "ParametrisedProgramme", Counted)
    monkeypatch.setattr(cvxpy, "_shelf", type(cvxpy._shelf)())
    return made


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
        root = cvxpy.compliance_root(problem.scaled(), lifted=True)
        np.testing.assert_allclose(
            (root.matrix @ root.matrix.T).toarray(), problem.scaled().compliance, rtol=1e-12, atol=1e-15
        )
        assert cvxpy.ParametrisedProgramme(root).programme.is_dpp()


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
    assert not cvxpy._shelf
    for size in range(2, 4 + cvxpy.MAX_KEPT_PROGRAMMES):
        parts = (np.full(size, 2e-6), np.zeros((size, 0)))
        assert_right(dense(ContactProblem(np.zeros(size), np.full(size, 40.0), 1e5, parts)))
    assert len(cvxpy._shelf) == cvxpy.MAX_KEPT_PROGRAMMES


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
            assert list(pool.map(rotation_by_cvxpy, cycle, timeout=3600.0)) == here


def test_solvers_that_are_not_behind_qpsolvers_run_without_it() -> None:
    """In a copy of this process that imports the package anew."""

    def solve_without(_: int) -> None:
        for name in [name for name in sys.modules if name.split(".")[0] in ("easeoff", "qpsolvers")]:
            del sys.modules[name]
        sys.modules["qpsolvers"] = None  # type: ignore[assignment]
        contact = importlib.import_module("easeoff.contact")
        problem = contact.ContactProblem([0.0, 1e-3], [50.0, 50.0], 1e4, ([1e-5, 1e-5], [[1e-3], [2e-3]]))
        found = [contact.solve(problem, name).status.name for name in ("native", "lemke", "cvxpy")]
        assert found == ["CERTIFIED"] * 3

    in_copies(1, solve_without)
