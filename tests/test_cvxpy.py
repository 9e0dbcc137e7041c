"""CVXPY with the problem translated once: right whatever was solved before, beside or in another process."""

from __future__ import annotations

import concurrent.futures
import multiprocessing
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from solver_choice import (
    AGREEMENT,
)

from easeoff.contact import ContactProblem, solve
from easeoff.contact.solvers.adapters import cvxpy_programme
from easeoff.verification import problems


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
        root = cvxpy_programme.compliance_root(problem.scaled(), lifted=True)
        np.testing.assert_allclose(
            (root.matrix @ root.matrix.T).toarray(), problem.scaled().compliance, rtol=1e-12, atol=1e-15
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
    for size in range(2, 4 + cvxpy_programme.MAX_KEPT_PROGRAMMES):
        parts = (np.full(size, 2e-6), np.zeros((size, 0)))
        assert_right(dense(ContactProblem(np.zeros(size), np.full(size, 40.0), 1e5, parts)))
    assert len(cvxpy_programme._shelf) == cvxpy_programme.MAX_KEPT_PROGRAMMES


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
