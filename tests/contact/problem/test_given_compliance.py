"""Compliances as users have them: sparse, a single mode, products alone; and data that are no real numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.sparse
from scipy.sparse.linalg import LinearOperator, aslinearoperator

from easeoff import InputError
from easeoff.contact import (
    ContactProblem,
    ModalBasis,
    OperatorCompliance,
    Status,
    certify,
    dual_qp,
    lcp,
    lifted_qp,
    solve,
    solve_many,
    write_problems,
)
from easeoff.contact.problem.exchange.programme_file import write_npz
from easeoff.verification import problems

FORMATS = ["csr", "csc", "coo", "lil", "dok", "dia", "bsr"]
STRUCTURED = next(iter(problems("realistic", 1)))
LOCAL, FACTOR = STRUCTURED.compliance
SIZE = STRUCTURED.size


def with_compliance(compliance: Any) -> ContactProblem:
    return ContactProblem(STRUCTURED.separation, STRUCTURED.lever_arm, STRUCTURED.torque, compliance)


def dense() -> ContactProblem:
    return with_compliance(STRUCTURED.dense_compliance)


# Sparse


@pytest.mark.parametrize("kind", [scipy.sparse.coo_array, scipy.sparse.coo_matrix])
@pytest.mark.parametrize("form", FORMATS)
def test_sparse_compliance_is_the_same_problem(form: str, kind: Any) -> None:
    assert with_compliance(kind(STRUCTURED.dense_compliance).asformat(form)).identical(dense())
    assert with_compliance((LOCAL, kind(FACTOR).asformat(form))).identical(STRUCTURED)


@pytest.mark.parametrize("form", [np.diag, scipy.sparse.diags, lambda d: scipy.sparse.csr_array(np.diag(d))])
def test_local_compliance_may_be_a_diagonal_matrix(form: Any) -> None:
    assert with_compliance((form(LOCAL), FACTOR)).identical(STRUCTURED)
    assert with_compliance((form(LOCAL), scipy.sparse.csr_array(FACTOR))).identical(STRUCTURED)
    wrong = form(LOCAL) + np.eye(SIZE, k=1)
    with pytest.raises(InputError, match=r"compliance diagonal = matrix of shape .*: must have zeros beside"):
        with_compliance((wrong, FACTOR))


def test_factor_known_by_its_products_is_multiplied_out() -> None:
    assert with_compliance((LOCAL, aslinearoperator(FACTOR))).identical(STRUCTURED)


@pytest.mark.parametrize("size", [1, 2, 3, 36])
def test_single_mode_may_be_a_vector(size: int) -> None:
    rng = np.random.default_rng(size)
    gap, arm, local, mode = rng.random((4, size)) + 0.1
    column = ContactProblem(gap, arm, 1.0, (local, mode[:, np.newaxis]))
    assert column.is_structured
    assert ContactProblem(gap, arm, 1.0, (local, mode)).identical(column)
    assert ContactProblem(gap, arm, 1.0, (list(local), tuple(mode))).identical(column)
    assert ContactProblem(gap, arm, 1.0, (local, scipy.sparse.coo_array(mode[:, np.newaxis]))).identical(column)


def test_two_rows_of_two_numbers_are_never_guessed_at() -> None:
    rows = [[2e-6, 1e-6], [1e-6, 2e-6]]
    assert not ContactProblem(np.zeros(2), np.ones(2), 1.0, rows).is_structured
    with pytest.raises(InputError, match=r"two rows of two numbers: must be"):
        ContactProblem(np.zeros(2), np.ones(2), 1.0, tuple(rows))


def test_compressed_modes_are_taken_as_a_factor() -> None:
    basis = STRUCTURED.modal_basis
    assert basis is not None
    problem = with_compliance((LOCAL, basis))
    assert problem.modal_basis is basis
    assert solve(problem).rotation == pytest.approx(solve(STRUCTURED).rotation, rel=1e-12)
    with pytest.raises(InputError, match=rf"ModalBasis of {SIZE} segments: must have 2"):
        ContactProblem(np.zeros(2), np.ones(2), 1.0, (np.ones(2), basis))


@pytest.mark.parametrize(
    ("index", "modes", "words"),
    [
        ([[0, 1]], np.ones((1, 2, 1)), "once"),
        ([[0, 1], [1, 2]], np.ones((2, 2, 1)), "once"),
        ([[0, 1, 2, 7]], np.ones((1, 4, 1)), "once"),
        ([[0, 1, -1]], np.ones((1, 3, 1)), "once"),
        ([[0, 1, 2]], np.ones((1, 2, 1)), "shape"),
        ([[0, 1, 2]], np.full((1, 3, 1), np.nan), "finite"),
        ([[0, 1, 2, 3]], np.ones((1, 4, 1)), "padded"),
        ([[0.0, 1.0, 2.0]], np.ones((1, 3, 1)), "whole numbers"),
    ],
)
def test_modes_that_do_not_fit_are_refused(index: Any, modes: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        ModalBasis(3, np.array(index), modes)


# Products alone


def operator(problem: ContactProblem) -> OperatorCompliance:
    return OperatorCompliance(aslinearoperator(problem.dense_compliance), problem.compliance_diagonal)


def test_certificate_and_scaling_of_products_are_those_of_the_matrix() -> None:
    known, given = dense(), with_compliance(operator(STRUCTURED))
    solution = solve(known)
    proof = certify(given, solution.force, solution.rotation, solution.elastic_rotation)
    assert proof.worst < 1e-12
    assert given.deflection(solution.force) == pytest.approx(known.deflection(solution.force), rel=1e-13)
    one, other = given.scaled(), known.scaled()
    assert (one.separation == other.separation).all()
    assert one.torque == other.torque
    assert one.deflection(solution.force) == pytest.approx(other.compliance @ solution.force, rel=1e-13)
    assert given.is_positive_semidefinite
    wrong = certify(given, solution.force * 1.01, solution.rotation)
    assert not wrong.passes(1e-3)


def test_operator_alone_is_a_compliance_and_its_own_diagonal_is_used() -> None:
    class Springs(LinearOperator):
        def __init__(self, stiffness: Any) -> None:
            super().__init__(np.float64, (stiffness.size, stiffness.size))  # type: ignore[call-arg]
            self.stiffness = stiffness

        def _matvec(self, x: Any) -> Any:
            return x.ravel() / self.stiffness

        def diagonal(self) -> Any:
            return 1.0 / self.stiffness

    problem = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, Springs(np.full(2, 1e6)))
    assert certify(problem, np.array([1000.0, 1000.0]), 2.5e-5).worst < 1e-15
    unknown = with_compliance(aslinearoperator(STRUCTURED.dense_compliance))
    assert unknown.deflection(np.ones(SIZE)) == pytest.approx(STRUCTURED.deflection(np.ones(SIZE)))
    with pytest.raises(InputError, match=r"compliance diagonal: must be given"):
        unknown.scaled()


def test_local_compliance_adds_to_products() -> None:
    force = np.linspace(0.0, 1.0, SIZE)
    added = with_compliance(operator(STRUCTURED)).with_added_compliance(LOCAL)
    assert added.deflection(force) == pytest.approx(STRUCTURED.deflection(force) + LOCAL * force, rel=1e-13)
    assert added.compliance_diagonal == pytest.approx(STRUCTURED.compliance_diagonal + LOCAL, rel=1e-13)


def test_what_needs_the_matrix_says_so() -> None:
    problem = with_compliance(operator(STRUCTURED))
    calls: list[Any] = [
        lambda: problem.dense_compliance,
        lambda: problem.as_qp(),
        lambda: problem.to_dataset(),
        lambda: lcp(problem),
        lambda: dual_qp(problem),
        lambda: lifted_qp(problem),
        lambda: write_problems([problem], "nowhere.nc"),
        lambda: write_npz(problem, "nowhere.npz"),
        lambda: solve(problem, method="primal_active_set"),
        lambda: solve(problem, "clarabel"),
        lambda: solve(problem, "lemke"),
    ]
    for call in calls:
        with pytest.raises(InputError, match="LinearOperator"):
            call()


def test_native_solver_takes_products_and_says_what_it_assumes() -> None:
    problem, reference = with_compliance(operator(STRUCTURED)), solve(STRUCTURED)
    solution = solve(problem)
    assert solution.certified
    assert "positive semidefinite is assumed" in solution.message
    assert np.abs(solution.force - reference.force).max() < 1e-8 * reference.force.max()
    assert solution.energy == pytest.approx(reference.energy, rel=1e-9)
    assert solution.conditioning.unique is None
    assert solve_many([problem])[0].certified
    assert solve_many(problem, torque=[problem.torque, 2.0 * problem.torque]).certified.all()
    needed = solution.iterations
    assert solve(problem, max_iterations=needed).certified
    assert solve(problem, max_iterations=needed - 1).status is Status.NOT_CONVERGED
    assert solve(problem, time_limit=0.0).status is Status.TIME_LIMIT
    indefinite = OperatorCompliance(aslinearoperator(-STRUCTURED.dense_compliance), STRUCTURED.compliance_diagonal)
    assert solve(with_compliance(indefinite)).status is Status.NOT_POSITIVE_SEMIDEFINITE


def test_products_that_no_contact_has_are_refused() -> None:
    gap, arm = np.zeros(3), np.full(3, 40.0)
    with pytest.raises(InputError, match="symmetric, by reciprocity"):
        ContactProblem(gap, arm, 1.0, aslinearoperator(np.triu(np.ones((3, 3)))))
    with pytest.raises(InputError, match=r"shape \(2, 2\): must have the shape \(3, 3\)"):
        ContactProblem(gap, arm, 1.0, aslinearoperator(np.eye(2)))
    with pytest.raises(InputError, match=r"shape \(3, 2\): must be square"):
        ContactProblem(gap, arm, 1.0, aslinearoperator(np.ones((3, 2))))
    with pytest.raises(InputError, match="finite"):
        ContactProblem(gap, arm, 1.0, aslinearoperator(np.diag([1.0, np.nan, 1.0])))
    with pytest.raises(InputError, match=r"LinearOperator of complex128: must be of real numbers"):
        ContactProblem(gap, arm, 1.0, aslinearoperator(np.eye(3).astype(complex)))
    with pytest.raises(InputError, match=r"compliance diagonal = array|compliance diagonal = \[1.0"):
        OperatorCompliance(aslinearoperator(np.eye(3)), [1.0, 1.0])


@pytest.mark.parametrize("size", [1, 2, 5, 200])
def test_negative_eigenvalue_at_the_end_of_the_spectrum_is_found_from_products(size: int) -> None:
    rng = np.random.default_rng(size)
    vectors = np.linalg.qr(rng.standard_normal((size, size)))[0]
    values = np.linspace(1.0, 2.0, size)
    for least, definite in ((-0.5, False), (0.0, True), (1e-3, True)):
        values[0] = least
        matrix = (vectors * values) @ vectors.T
        given = OperatorCompliance(aslinearoperator(0.5 * (matrix + matrix.T)), np.abs(matrix.diagonal()))
        assert given.is_positive_semidefinite == definite


# No real numbers

IMAGINARY, TRUTH = np.ones(2, dtype=complex), np.ones(2, dtype=bool)
MASKED = np.ma.array([1.0, 2.0], mask=[False, True])
TEXTS, OBJECTS = np.array(["1", "2"], dtype=object), np.array([None, 1.0], dtype=object)


@pytest.mark.parametrize(
    ("bad", "words"),
    [
        (IMAGINARY, "complex: give their real part"),
        (np.array([1.0 + 0.0j, 2.0], dtype=object), "complex: give their real part"),
        (TRUTH, "truth values"),
        (np.array([True, 1.0], dtype=object), "truth values"),
        (MASKED, "1 are masked"),
        (TEXTS, "texts or other objects"),
        (np.array(["1", "2"]), "texts or other objects"),
        (OBJECTS, "finite number"),
        ([[1.0], [1.0, 2.0]], "must be finite numbers"),
    ],
)
def test_data_that_are_no_real_numbers_are_refused_by_name(bad: Any, words: str) -> None:
    good, square = np.ones(2), np.eye(2)
    wide = bad if isinstance(bad, list) else np.ma.array([bad, bad]) if bad is MASKED else np.array([bad, bad])
    words = words.replace("1 are masked", "[12] are masked")
    for name, arguments in {
        "separation": (bad, good, 1.0, square),
        "lever_arm": (good, bad, 1.0, square),
        "compliance": (good, good, 1.0, wide),
        "compliance diagonal": (good, good, 1.0, (bad, square)),
        "compliance factor": (good, good, 1.0, (good, wide)),
    }.items():
        if isinstance(bad, list) and "compliance" in name:
            continue
        with pytest.raises(InputError, match=rf"^{name} = .*{words}"):
            ContactProblem(*arguments)


def test_complex_torque_is_refused() -> None:
    with pytest.raises(InputError, match=r"torque = .*complex: give their real part"):
        ContactProblem(np.ones(2), np.ones(2), 1.0 + 0.0j, np.eye(2))  # type: ignore[arg-type]


def test_sparse_matrices_of_no_real_numbers_are_refused() -> None:
    for kind, word in ((complex, "complex128"), (bool, "bool")):
        for compliance in (scipy.sparse.csr_array(np.eye(2).astype(kind)), (np.ones(2), np.eye(2).astype(kind))):
            with pytest.raises(InputError, match=word if not isinstance(compliance, tuple) else "compliance factor"):
                ContactProblem(np.ones(2), np.ones(2), 1.0, compliance)


def test_array_with_a_mask_that_hides_nothing_and_exact_fractions_are_numbers() -> None:
    from fractions import Fraction

    problem = ContactProblem(np.ma.array([1.0, 2.0]), np.array([Fraction(1, 2)] * 2), 1.0, np.eye(2))
    assert problem.separation.tolist() == [1.0, 2.0]
    assert problem.lever_arm.tolist() == [0.5, 0.5]


def test_sparse_matrix_too_large_for_an_array_is_told_what_to_give() -> None:
    large = scipy.sparse.eye_array(100_000, format="csr")
    with pytest.raises(InputError, match=r"aslinearoperator"):
        ContactProblem(np.zeros(100_000), np.ones(100_000), 1.0, large)
    given = OperatorCompliance(aslinearoperator(large), large.diagonal())
    problem = ContactProblem(np.zeros(100_000), np.ones(100_000), 1e5, given)
    assert certify(problem, np.ones(100_000), 1.0).worst < 1e-12
