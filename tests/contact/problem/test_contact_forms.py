"""The other forms of the contact problem: each has the answer of the native solver, and refuses what it cannot hold."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import qpsolvers
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from runs import small
from solver_choice import LIFTING, installed

from easeoff import InputError
from easeoff.contact import SOLVERS, ContactProblem, dual_qp, lcp, lifted_qp, read_npz, solve
from easeoff.contact.problem.certificate import Answer
from easeoff.contact.problem.complementary_pivoting import lemke
from easeoff.contact.problem.exchange.programme_file import write_npz
from easeoff.contact.problem.modal_basis import modal_basis
from easeoff.contact.solvers.backend import chosen_form
from easeoff.study import CaseInMesh
from easeoff.study.analysis.contact_analysis import contact_analysis
from easeoff.verification import problems
from easeoff.verification.problem_classes import PROBLEM_CLASSES

Array = NDArray[np.float64]

#: Classes whose forces are unique to nine digits: those of a numerically singular compliance are not.
REGULAR = sorted(set(PROBLEM_CLASSES) - {"weak_local", "nearly_singular", "spread_local", "random_dense"})


@st.composite
def contact_problems(draw: st.DrawFn, *, structured: bool) -> ContactProblem:
    """Small problems with ties, duplicates, zero separations and lever arms of either sign."""
    size, modes = draw(st.integers(1, 9)), draw(st.integers(0, 3))
    gap = st.sampled_from([0.0, 0.0, 0.01, 0.02]) | st.floats(0.0, 0.05)
    arm = st.sampled_from([40.0, 40.0, -40.0, 0.0]) | st.floats(20.0, 60.0)
    local = st.sampled_from([2e-6, 2e-6]) | st.floats(5e-7, 5e-6)
    entry = st.sampled_from([0.0, 1e-3, -1e-3]) | st.floats(-2e-3, 2e-3)
    separation, lever_arm, diagonal = (draw(arrays(float, size, elements=e)) for e in (gap, arm, local))
    factor = draw(arrays(float, (size, modes), elements=entry))
    lever_arm[draw(st.integers(0, size - 1))] = 45.0
    compliance: Any = (diagonal, factor) if structured else np.diag(diagonal) + factor @ factor.T
    torque = draw(st.sampled_from([0.0, 1e5]) | st.floats(1e3, 1e6))
    return ContactProblem(separation, lever_arm, torque, compliance)


def exact(programme: qpsolvers.Problem) -> tuple[Array, Array, Array]:
    """Unknowns, equality and inequality multipliers: by Clarabel, then from the linear system of what is active.

    Nothing of the package takes part, so that the forms are tried as another solver would see them.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = qpsolvers.solve_problem(programme, "clarabel", tol_gap_abs=1e-12, tol_gap_rel=1e-12, tol_feas=1e-12)
    assert found.x is not None
    assert found.z_box is not None
    size = found.x.size
    P, A, G = (
        np.zeros((0, size)) if m is None else np.asarray(m if isinstance(m, np.ndarray) else m.todense())
        for m in (programme.P, programme.A, programme.G)
    )
    b, h = (np.zeros(0) if v is None else v for v in (programme.b, programme.h))
    inequalities = G.shape[0]
    multiplier = np.zeros(0) if found.z is None else found.z
    if programme.lb is not None:
        bounded = np.flatnonzero(np.isfinite(programme.lb))
        G, h = np.vstack([G, -np.eye(size)[bounded]]), np.append(h, -programme.lb[bounded])
        multiplier = np.append(multiplier, -found.z_box[bounded])
    active = multiplier > h - G @ found.x
    for _ in range(10):  # near-ties below the resolution of Clarabel come out wrong at first
        rows, right = np.vstack([A, G[active]]), np.append(b, h[active])
        system = np.block([[P, rows.T], [rows, np.zeros((rows.shape[0],) * 2)]])
        side = np.append(-programme.q, right)
        answer, *_ = np.linalg.lstsq(system, side, rcond=1e-13)
        answer += np.linalg.lstsq(system, side - system @ answer, rcond=1e-13)[0]
        x, z = answer[:size], np.zeros(G.shape[0])
        z[active] = answer[size + b.size :]
        slack = h - G @ x
        wrong = np.where(active, z < -1e-12 * (1.0 + np.abs(z).max()), slack < -1e-12 * (1.0 + np.abs(h).max()))
        if not wrong.any():
            break
        active = active ^ wrong
    return x, answer[size : size + b.size], z[:inequalities]


def assert_same(problem: ContactProblem, answer: Answer, tolerance: float = 1e-9) -> None:
    """Forces, rotation and gaps are those of the native solver."""
    reference = solve(problem)
    assert reference.certified
    force = max(float(reference.force.max()), 1e-12 * problem.scaling.force)
    gap = float(np.abs(problem.deflection(reference.force)).max()) + float(np.spacing(problem.scaling.gap))
    gap += float(np.abs(reference.elastic_rotation * problem.lever_arm).max())
    assert np.abs(answer.force - reference.force).max() <= tolerance * force
    assert np.abs(answer.gap - reference.gap).max() <= tolerance * gap
    turn = (answer.elastic_rotation - reference.elastic_rotation) * np.abs(problem.lever_arm).max()
    assert abs(turn) <= tolerance * gap
    assert answer.rotation == problem.whole_rotation(answer.elastic_rotation)
    assert answer.certificate.passes(tolerance)


def try_all_forms(problem: ContactProblem) -> None:
    if problem.is_structured:
        for compress in (False, True):
            lifted = lifted_qp(problem, compress=compress)
            x, y, _ = exact(lifted.programme)
            assert_same(problem, lifted.recover(x, y))
    dual = dual_qp(problem)
    x, _, z = exact(dual.programme)
    assert_same(problem, dual.recover(x))
    assert_same(problem, dual.recover(x, z))
    form = lcp(problem)
    assert_same(problem, form.recover(lemke(form.matrix, form.vector, 1000).z))


def is_loaded(problem: ContactProblem) -> bool:
    """Whether the rotation is unique: without load, some interference must be left to hold the bodies."""
    return problem.torque > 0.0 or bool(solve(problem).force.max() > 1e-6 * problem.scaling.force)


@given(contact_problems(structured=True) | contact_problems(structured=False))
def test_every_form_has_the_answer_of_the_native_solver(problem: ContactProblem) -> None:
    if is_loaded(problem):
        try_all_forms(problem)


@pytest.mark.parametrize("name", REGULAR)
def test_every_form_holds_the_degenerate_classes(name: str) -> None:
    for problem in problems(name, 2, seed=21):
        try_all_forms(problem)


@pytest.mark.parametrize("name", ["nasa-12x36", "fm-11x41", "fh-12x41-45"])
def test_every_form_holds_the_problems_of_shipped_cases(name: str) -> None:
    solved = contact_analysis(CaseInMesh.of(small(name, "shell")), [40.0, 150.0]).cases
    chosen = [item.problem for item in solved if (item.torque + item.mesh_position) % 2 == 0]
    assert len(chosen) == 3
    for problem in chosen:
        try_all_forms(problem)
        # The same as diagonal plus factor.
        values, vectors = np.linalg.eigh(problem.dense_compliance)
        local = 0.5 * values[0]
        parts = (np.full(problem.size, local), vectors * np.sqrt(values - local))
        try_all_forms(ContactProblem(problem.separation, problem.lever_arm, problem.torque, parts))


def test_exact_answer_in_closed_form_comes_out_of_every_form() -> None:
    """Two springs c, the second behind a gap s, at lever arm R: F1 - F2 = s / c, F1 + F2 = T / R, R theta = c F1."""
    spring, gap, arm, torque = 2e-6, 0.01, 50.0, 8e5
    problem = ContactProblem(np.array([0.0, gap]), np.full(2, arm), torque, (np.full(2, spring), np.zeros((2, 0))))
    first = 0.5 * (torque / arm + gap / spring)
    dense = ContactProblem(problem.separation, problem.lever_arm, torque, problem.dense_compliance)
    lifted, form = lifted_qp(problem), lcp(problem)
    x, y, _ = exact(lifted.programme)
    answers = [lifted.recover(x, y), form.recover(lemke(form.matrix, form.vector, 10).z)]
    answers += [dual_qp(p).recover(exact(dual_qp(p).programme)[0]) for p in (problem, dense)]
    for answer in answers:
        np.testing.assert_allclose(answer.force, [first, torque / arm - first], rtol=1e-12)
        assert answer.rotation == pytest.approx(spring * first / arm, rel=1e-12)
        assert np.abs(answer.gap).max() < 1e-15


def test_dual_has_minus_the_value_of_the_primal() -> None:
    for problem in problems("realistic", 3):
        x, _, _ = exact(dual_qp(problem).programme)
        programme, primal = dual_qp(problem).programme, problem.as_qp()
        force = solve(problem).force / problem.scaling.force
        value = 0.5 * x @ (programme.P @ x) + programme.q @ x
        assert value == pytest.approx(-(0.5 * force @ primal.P @ force + primal.q @ force), rel=1e-12)


def test_matrix_of_the_lcp_is_positive_semidefinite_for_any_lever_arms() -> None:
    for name in ("mixed_arms", "signed_modes", "random_dense", "lattice"):
        for problem in problems(name, 10, seed=4):
            matrix = lcp(problem).matrix
            eigenvalues = np.linalg.eigvalsh(0.5 * (matrix + matrix.T))
            assert eigenvalues[0] >= -1e-13 * max(eigenvalues[-1], 1.0)


def test_lifted_form_loses_no_bit_in_scaling() -> None:
    """The factor is scaled by a power of two; where its square is not that of the compliance, 1/2 is left over."""
    weights = set()
    for problem in problems("plain", 10):
        for factor_of_two in (1.0, 2.0):
            assert isinstance(problem.compliance, tuple)
            diagonal, factor = problem.compliance
            parts = (diagonal * factor_of_two, factor)
            other = ContactProblem(problem.separation, problem.lever_arm, problem.torque, parts)
            scaled = other.scaled()
            assert scaled.modal is not None
            ratio = factor[factor != 0.0] / scaled.modal.factor[factor != 0.0]
            assert np.frexp(ratio[0])[0] == 0.5
            assert np.all(ratio == ratio[0])
            assert np.array_equal(scaled.modal.diagonal * other.scaling.compliance, parts[0])
            dense = scaled.modal.weight * scaled.modal.factor @ scaled.modal.factor.T
            dense += np.diag(scaled.modal.diagonal)
            np.testing.assert_allclose(dense, scaled.compliance, rtol=1e-13)
            weights.add(scaled.modal.weight)
    assert weights == {0.5, 1.0}


def test_compression_keeps_the_product_and_the_tooth_pairs_apart() -> None:
    along = np.linspace(-1.0, 1.0, 40)
    block = np.polynomial.legendre.legvander(along, 5) @ np.random.default_rng(0).standard_normal((6, 50))
    factor = np.zeros((81, 100))
    factor[:40, :50], factor[40:80, 50:] = block, 2.0 * block  # the last segment has no modes
    compressed = modal_basis(factor).factor
    assert compressed.shape == (81, 12)
    largest = np.abs(factor @ factor.T).max()
    np.testing.assert_allclose(compressed @ compressed.T, factor @ factor.T, rtol=0, atol=1e-14 * largest)
    assert not (compressed[:40].any(axis=0) & compressed[40:].any(axis=0)).any()
    for nothing in (np.zeros((3, 0)), np.zeros((3, 2))):
        assert modal_basis(nothing).factor.shape == (3, 0)


def test_forms_refuse_what_they_cannot_hold() -> None:
    dense, structured = next(problems("realistic", 1)), next(problems("plain", 1))
    dense = ContactProblem(dense.separation, dense.lever_arm, dense.torque, dense.dense_compliance)
    separation, arm = np.zeros(2), np.full(2, 40.0)
    with pytest.raises(InputError, match="compliance = dense matrix: must be the pair"):
        lifted_qp(dense)
    rigid = ContactProblem(separation, arm, 1.0, (np.array([0.0, 1e-6]), np.ones((2, 1))))
    with pytest.raises(InputError, match="is zero for 1 segments"):
        dual_qp(rigid)
    singular = ContactProblem(separation, arm, 1.0, np.ones((2, 2)))
    with pytest.raises(InputError, match="positive definite"):
        dual_qp(singular)
    indefinite = ContactProblem(separation, arm, 1.0, np.array([[1.0, 2.0], [2.0, 1.0]]))
    for form in (dual_qp, lcp):
        with pytest.raises(InputError, match="negative eigenvalue"):
            form(indefinite)
    lifted = lifted_qp(structured)
    with pytest.raises(InputError, match=r"x = .*must have the shape"):
        lifted.recover(np.zeros(structured.size), np.zeros(1))
    with pytest.raises(InputError, match=r"z = .*must have the shape"):
        lcp(structured).recover(np.zeros(structured.size + 1))


def test_a_wrong_answer_comes_back_with_its_certificate() -> None:
    problem = next(problems("realistic", 1))
    answer = dual_qp(problem).recover(np.ones(dual_qp(problem).programme.q.size))
    assert not answer.certificate.passes(1e-3)


# Backends


def large(size: int = 300) -> ContactProblem:
    """Three tooth pairs of 20 modes each, of which 6 are independent on a line."""
    rng = np.random.default_rng(3)
    per_pair = size // 3
    along = np.linspace(-1.0, 1.0, per_pair)
    block = np.sqrt(3e-6) * np.polynomial.legendre.legvander(along, 5) @ rng.standard_normal((6, 20)) / 4.0
    factor = np.kron(np.eye(3), block)
    separation = np.concatenate([0.03 * (along - 0.2) ** 2 + 0.004 * pair for pair in range(3)])
    diagonal = 3e-6 * rng.uniform(0.7, 1.5, size)
    return ContactProblem(separation, rng.normal(42.0, 1.0, size), 5e5, (diagonal, factor))


@pytest.mark.parametrize("name", LIFTING)
def test_backends_give_the_same_in_either_form(name: str) -> None:
    installed(name)
    for problem in [large(), *problems("realistic", 1), *problems("signed_modes", 1), *problems("mixed_arms", 1)]:
        reference = solve(problem)
        for form in ("dense", "lifted", "auto"):
            solution = solve(problem, name, form=form)
            assert solution.polished
            assert np.abs(solution.force - reference.force).max() < 1e-12 * reference.force.max()
            assert solution.elastic_rotation == pytest.approx(reference.elastic_rotation, rel=1e-12)
        rough = solve(problem, name, form="lifted", polish=False, tolerance=SOLVERS[name].tolerance)
        assert rough.certified
        assert rough.certificate.passes(SOLVERS[name].tolerance)


def test_form_follows_the_size_and_the_table() -> None:
    problem = large()
    scaled = problem.scaled()
    least = SOLVERS["osqp"].lifted_from
    assert least is not None
    assert least <= problem.size
    assert chosen_form("osqp", scaled, "auto") == chosen_form("osqp", scaled, "lifted") == "lifted"
    assert chosen_form("osqp", scaled, "dense") == chosen_form("daqp", scaled, "auto") == "dense"
    few = next(problems("realistic", 1))
    assert chosen_form("osqp", few.scaled(), "auto") == "dense"


def test_impossible_form_is_refused() -> None:
    structured = next(problems("realistic", 1))
    dense = ContactProblem(structured.separation, structured.lever_arm, 1.0, structured.dense_compliance)
    for name in ("daqp", "native", "lemke"):
        with pytest.raises(InputError, match=r"must be dense for.*clarabel"):
            solve(structured, name, form="lifted")
        assert solve(structured, name, form="dense").certified
    with pytest.raises(InputError, match="must be dense for a single dense matrix"):
        solve(dense, "osqp", form="lifted")
    with pytest.raises(InputError, match="auto, dense, lifted"):
        solve(structured, "osqp", form="sparse")


# Files of qpsolvers


@pytest.mark.parametrize("form", ["dense", "lifted", "dual"])
def test_file_of_qpsolvers_holds_the_programme_and_the_problem(tmp_path: Path, form: str) -> None:
    path = tmp_path / "problem.npz"
    for problem in [*problems("realistic", 2), *([] if form == "lifted" else problems("random_dense", 2))]:
        write_npz(problem, path, form=form)
        assert read_npz(path).identical(problem)
        programme = qpsolvers.Problem.load(str(path))
        if problem.is_structured:
            # Someone with qpsolvers and numpy alone gets the answer from what is in the file.
            x, y, _ = exact(programme)
            scale = np.load(path, allow_pickle=False)
            rotation = float(
                scale["first_contact_rotation"] + scale["scale_rotation"] * (x[-1] if form == "dual" else -y[0])
            )
            reference = solve(problem)
            assert rotation == pytest.approx(reference.rotation, rel=1e-12)
            force = scale["scale_force"] * x[: problem.size]
            assert np.abs(force - reference.force).max() < 1e-9 * reference.force.max()
    assert [file.name for file in tmp_path.iterdir()] == ["problem.npz"]


def test_programme_of_another_hand_is_read_as_it_stands(tmp_path: Path) -> None:
    problem = next(problems("random_dense", 1))
    arrays_of = {"P": problem.dense_compliance, "q": problem.separation, "lb": np.zeros(problem.size)}
    row = problem.lever_arm[np.newaxis]
    qpsolvers.Problem(**arrays_of, A=row, b=np.array([problem.torque])).save(str(tmp_path / "theirs.npz"))
    assert read_npz(tmp_path / "theirs.npz").identical(problem)
    # A plain NumPy file with these names will do.
    np.savez(tmp_path / "plain.npz", A=problem.lever_arm, b=problem.torque, **arrays_of)  # type: ignore[arg-type]
    assert read_npz(tmp_path / "plain.npz").identical(problem)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"A": None, "b": None}, "A = none: must be the balance of torque"),
        ({"A": np.ones((2, 3)), "b": np.ones(2)}, "must be one equality"),
        ({"lb": None}, "lb = None: must be zero"),
        ({"lb": -np.ones(3)}, r"lb = \[-1.0, -1.0, -1.0\]: must be zero"),
        ({"ub": np.ones(3)}, "no upper bounds"),
        ({"G": np.ones((1, 3)), "h": np.ones(1)}, "no inequalities"),
        ({"b": -np.ones(1)}, "torque"),
        ({"P": np.arange(9.0).reshape(3, 3)}, "must be symmetric"),
    ],
)
def test_programme_that_is_no_contact_problem_is_refused(tmp_path: Path, changes: dict[str, Any], words: str) -> None:
    data: dict[str, Any] = {"P": np.eye(3), "q": np.zeros(3), "A": np.ones((1, 3)), "b": np.ones(1), "lb": np.zeros(3)}
    path = tmp_path / "theirs.npz"
    qpsolvers.Problem(**{**data, **changes}).save(str(path))
    with pytest.raises(InputError, match=words):
        read_npz(path)


def test_file_without_a_programme_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_npz(tmp_path / "missing.npz")
    (tmp_path / "text.npz").write_text("not a NumPy file")
    np.savez(tmp_path / "other.npz", a=np.zeros(3))
    np.save(tmp_path / "single.npy", np.zeros(3))
    for name in ("text.npz", "other.npz", "single.npy"):
        with pytest.raises(InputError, match=name):
            read_npz(tmp_path / name)
    problem = next(problems("random_dense", 1))
    for form in ("lifted", "triple"):
        with pytest.raises(InputError):
            write_npz(problem, tmp_path / "new.npz", form=form)
    assert not (tmp_path / "new.npz").exists()
