"""The backends agree with the native solver, and their multipliers are its rotation and gaps."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from solver_choice import (
    AGREEMENT,
    BACKENDS,
    CHOLESKY,
    LIFTING,
    NEARLY_SINGULAR,
    POLISHED_AGREEMENT,
    answer_of,
    installed,
    rotation_and_gap,
)

from easeoff.contact import EXACT_TOLERANCE, SOLVERS, ContactProblem, Status, solve
from easeoff.verification import PROBLEM_CLASSES, problems

DOCS = Path(__file__).parents[1] / "docs"


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
        solution = solve(problem, name, polish=polish)
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
        raw = solve(problem, name, polish=False)
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
    solution = solve(problem, "clarabel", polish=False)
    assert np.count_nonzero(solution.force > 0.0) > 1  # its barrier keeps some from zero
    assert np.array_equal(solution.active, solve(problem).active)


@pytest.mark.parametrize("name", BACKENDS)
def test_backends_reach_their_level_on_degenerate_problems(name: str) -> None:
    """Or say that they do not: where the compliance is singular to rounding, a Cholesky factor may be worthless."""
    installed(name)
    for kind in PROBLEM_CLASSES:
        for problem in problems(kind, 1, seed=11):
            solution = solve(problem, name, polish=False)
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
