"""Every backend on the problem library: within its row of the table, or an honest failure on a singular compliance."""

from __future__ import annotations

import math

import pytest
from solver_choice import AGREEMENT, BACKENDS, LIFTING, installed

from easeoff.contact import ContactProblem, Status, solve
from easeoff.contact.solvers import SOLVERS
from easeoff.study.library import entries, generate, reference_answers

ANSWERS = reference_answers()
#: Larger problems take those backends minutes that have no use for the structure.
LARGEST_DENSE = 500
#: These begin with a Cholesky factor of the whole matrix, and say so where there is none.
WITHOUT_SINGULAR = {"pyqpmad", "quadprog", "ecos"}


@pytest.fixture(scope="module")
def library() -> dict[str, ContactProblem]:
    """The library."""
    return {entry.name: problem for entry, problem in generate(entries())}


@pytest.mark.parametrize("name", BACKENDS)
def test_backend_keeps_to_the_table_on_the_library(name: str, library: dict[str, ContactProblem]) -> None:
    installed(name)
    tolerance, (agreement, _) = SOLVERS[name].tolerance, AGREEMENT[name]
    for title, problem in library.items():
        if problem.size > LARGEST_DENSE and name not in LIFTING:
            continue
        solution = solve(problem, name, polish=False)
        if not solution.certified:
            assert name in WITHOUT_SINGULAR, (title, solution.status, solution.certificate)
            assert math.isinf(ANSWERS[title].condition_number), title
            assert solution.status is Status.SOLVER_FAILED, title
            continue
        assert solution.certificate.worst <= tolerance
        expected = ANSWERS[title].elastic_rotation
        assert solution.elastic_rotation == pytest.approx(expected, rel=max(agreement, 1e-8)), title


def test_polished_answers_are_exact_on_the_library(library: dict[str, ContactProblem]) -> None:
    for title, problem in library.items():
        for name in ("clarabel", "piqp"):
            solution = solve(problem, name)
            assert solution.certified, (title, name)
            assert solution.polished, (title, name)
            assert solution.certificate.worst <= 1e-9
