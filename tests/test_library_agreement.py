"""Every backend on the problem library: within its row of the table, or an honest failure on a singular compliance."""

from __future__ import annotations

import math

import pytest
from solver_choice import AGREEMENT, BACKENDS, installed

from easeoff.contact import SOLVERS, ContactProblem, Status, solve
from easeoff.study.library import USUAL_PARTS, entries, generate, reference_answers

pytestmark = pytest.mark.thorough  # every backend on all problems

ANSWERS = reference_answers()
#: Larger ones take those backends seconds each that have no use for the structure; `docs/make agreement` has them.
LARGEST_DENSE = 500


@pytest.fixture(scope="module")
def library() -> dict[str, ContactProblem]:
    """The library, without sequences, whose problems are alike, and without what takes backends minutes each."""
    return {entry.name: problem for entry, problem in generate(e for e in entries() if e.part in USUAL_PARTS)}


@pytest.mark.parametrize("name", BACKENDS)
def test_backend_keeps_to_the_table_on_the_library(name: str, library: dict[str, ContactProblem]) -> None:
    installed(name)
    entry, (agreement, _) = SOLVERS[name], AGREEMENT[name]
    largest = math.inf if entry.largest is None else min(entry.largest, LARGEST_DENSE)
    for title, problem in library.items():
        if problem.size > largest:
            continue
        solution = solve(problem, name, polish=False)
        if not solution.certified:
            assert entry.definite, (title, solution.status, solution.certificate)
            assert math.isinf(ANSWERS[title].condition_number), title
            assert solution.status in (Status.SOLVER_FAILED, Status.NOT_CERTIFIED), title
            assert "singular to rounding" in solution.message
            continue
        assert solution.certificate.worst <= entry.tolerance
        expected = ANSWERS[title].elastic_rotation
        assert solution.elastic_rotation == pytest.approx(expected, rel=max(agreement, 1e-8)), title


@pytest.mark.parametrize("name", [name for name in BACKENDS if SOLVERS[name].largest])
def test_dense_backends_keep_to_the_table_at_a_thousand_segments(name: str, library: dict[str, ContactProblem]) -> None:
    installed(name)
    (title,) = (t for t, problem in library.items() if t.startswith("fm-11x41-fine") and problem.size == 999)
    solution = solve(library[title], name, polish=False)
    assert solution.certified, (solution.status, solution.message)
    assert solution.elastic_rotation == pytest.approx(ANSWERS[title].elastic_rotation, rel=AGREEMENT[name][0])


def test_polished_answers_are_exact_on_the_library(library: dict[str, ContactProblem]) -> None:
    for title, problem in library.items():
        for name in ("clarabel", "piqp"):
            solution = solve(problem, name)
            assert solution.certified, (title, name)
            assert solution.polished, (title, name)
            assert solution.certificate.worst <= 1e-9
