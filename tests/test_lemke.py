"""Lemke's pivoting: it ends, whatever ties there are, and tells a solution from a ray."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from easeoff import InputError
from easeoff.contact import ContactProblem, Status, lcp, solve
from easeoff.contact.problem.forms.complementary_pivoting import lemke
from easeoff.contact.solvers.solver_table import LARGEST_PIVOTING
from easeoff.verification import problems


def residual(matrix: np.ndarray, vector: np.ndarray, z: np.ndarray) -> float:
    w = matrix @ z + vector
    return float(max(-z.min(), -w.min(), np.minimum(z, w).max()))


def test_lattice_ties_never_cycle() -> None:
    """Hundreds of problems of small integers, full of ties: a basis that came back would end at the pivot limit."""
    for problem in problems("lattice", 300, seed=31):
        form = lcp(problem)
        result = lemke(form.matrix, form.vector, 10 * problem.size + 20)
        assert result.ended == "solved"
        answer = form.recover(result.z)
        assert answer.certificate.worst < 1e-12


def test_coarser_ties_do_not_cycle_either() -> None:
    """Entries of 0 and 1 alone, duplicated segments, and all segments in touch."""
    rng = np.random.default_rng(8)
    for _ in range(120):
        n = int(rng.integers(2, 30))
        pick = rng.integers(0, max(n // 3, 1), n)
        factor = rng.integers(0, 2, (n, 2)).astype(float)[pick]
        separation = rng.integers(0, 2, n).astype(float)[pick] * rng.integers(0, 2)
        problem = ContactProblem(separation.astype(float), np.ones(n), float(rng.integers(1, 4)), (np.ones(n), factor))
        solution = solve(problem, "lemke", polish=False)
        assert solution.certificate.worst < 1e-12


def test_rule_for_ties_breaks_a_cycle(monkeypatch: pytest.MonkeyPatch) -> None:
    """A cyclic matrix on which pivoting that takes the first of tied rows goes round for ever."""
    matrix, vector = np.array([[1.0, 2.0, 0.0], [0.0, 1.0, 2.0], [2.0, 0.0, 1.0]]), -np.ones(3)
    result = lemke(matrix, vector, 10)
    assert result.ended == "solved"
    np.testing.assert_allclose(result.z, np.full(3, 1.0 / 3.0), rtol=1e-15)
    monkeypatch.setattr(f"{lemke.__module__}._lexicographic_row", lambda tableau, rows, column: int(rows[0]))
    assert lemke(matrix, vector, 1000).ended == "pivot limit"


@pytest.mark.thorough
def test_semidefinite_problems_full_of_ties_all_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """Skew matrices of small integers with one right side in all rows; without the rule some go round for ever."""

    def unfinished() -> int:
        rng = np.random.default_rng(0)
        ends = []
        for _ in range(1000):
            n = int(rng.integers(4, 8))
            root = rng.integers(-2, 3, (n, int(rng.integers(1, n + 1)))).astype(float) * rng.integers(0, 2)
            skew = np.triu(rng.integers(-2, 3, (n, n)), 1).astype(float)
            ends.append(lemke(root @ root.T + skew - skew.T, -np.ones(n), 200).ended)
        return ends.count("pivot limit")

    assert unfinished() == 0
    monkeypatch.setattr(f"{lemke.__module__}._lexicographic_row", lambda tableau, rows, column: int(rows[0]))
    assert unfinished() > 0


def test_solution_is_that_of_trying_every_basis() -> None:
    """Positive semidefinite M of size 4: one of the 16 complementary bases solves it, or none does and a ray is met."""
    rng = np.random.default_rng(2)
    ends = {"solved": 0, "ray": 0}
    for _ in range(300):
        root = rng.integers(-1, 2, (4, int(rng.integers(1, 4)))).astype(float)
        skew = np.triu(rng.integers(-1, 2, (4, 4)), 1).astype(float)
        matrix, vector = root @ root.T + skew - skew.T, rng.integers(-2, 3, 4).astype(float)
        solvable = False
        for choice in product([False, True], repeat=4):
            basis = np.where(np.array(choice), -matrix, np.eye(4))
            if abs(np.linalg.det(basis)) > 1e-9:
                solvable |= bool(np.linalg.solve(basis, vector).min() > -1e-9)
        result = lemke(matrix, vector, 200)
        ends[result.ended] += 1
        assert result.ended == ("solved" if solvable else "ray")
        if solvable:
            assert residual(matrix, vector, result.z) < 1e-12
    assert min(ends.values()) > 30


def test_nothing_to_do_takes_no_pivot() -> None:
    result = lemke(np.eye(3), np.array([0.0, 1.0, 2.0]), 0)
    assert (result.ended, result.pivots) == ("solved", 0)
    assert not result.z.any()


def test_ray_is_a_status() -> None:
    problem = ContactProblem(np.array([0.1, -0.3]), np.array([40.0, 0.0]), 10.0, np.diag([1e-6, 0.0]))
    solution = solve(problem, "lemke")
    assert solution.status is Status.UNBOUNDED
    assert "ray" in solution.message
    assert np.isnan(solution.force).all()


def test_pivot_limit_is_a_status() -> None:
    problem = next(problems("realistic", 1))
    solution = solve(problem, "lemke", max_pivots=2)
    assert solution.status is Status.NOT_CONVERGED
    assert "2 pivots" in solution.message


def test_large_problems_are_refused() -> None:
    n = LARGEST_PIVOTING + 1
    problem = ContactProblem(np.zeros(n), np.ones(n), 1.0, (np.ones(n), np.zeros((n, 0))))
    with pytest.raises(InputError, match=f"size = {n}: must be at most"):
        solve(problem, "lemke")


@pytest.mark.parametrize("name", ["weak_local", "nearly_singular", "spread_local", "random_dense", "far_apart"])
def test_pivoting_needs_no_polish_where_the_compliance_is_nearly_singular(name: str) -> None:
    for problem in problems(name, 15, seed=12):
        solution = solve(problem, "lemke", polish=False)
        assert solution.certificate.worst < 1e-11
        assert solution.elastic_rotation == pytest.approx(solve(problem).elastic_rotation, rel=1e-10)
