"""The compiled contact solution beside other methods, and beside its own source run as Python."""

from __future__ import annotations

import importlib
import types
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import kernels
import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from runs import output_of, small
from shared_problems import compiled_certificate, line_contact_of, shared_problem

import easeoff
from easeoff import InputError, MissingPackageError
from easeoff.cases import LoadCase, write_case
from easeoff.contact import ContactProblem, Status, solve, solve_many
from easeoff.contact.evaluation import least_gap_kernel
from easeoff.contact.line_contact.line_contact_solution import solve_on_bending
from easeoff.contact.lines import flank_splines
from easeoff.contact.lines.flank_splines import TensorSpline
from easeoff.contact.problem import modal_basis as modal_basis_module, mode_kernel
from easeoff.contact.problem.compliance_matrix import ModalCompliance, compliance_matrix
from easeoff.contact.problem.modal_basis import ModalBasis, block_labels, modal_basis, mode_columns
from easeoff.contact.solvers.compiled import compiled_answer, dense_kernel, newton_kernel
from easeoff.contact.solvers.compiled.compiled_answer import (
    LARGEST_DENSE,
    LARGEST_FORMED,
    dense_answer,
    is_small,
    line_contact_answers,
    linear_answer,
)
from easeoff.contact.solvers.compiled.proof_kernel import certificate
from easeoff.contact.solvers.parametric.touching_form import touching_stiffness
from easeoff.core.kernels import kernel, source_digest
from easeoff.study import analyze_load_cases, key_numbers
from easeoff.verification import problems
from easeoff.verification.problem_classes import PROBLEM_CLASSES

Array = NDArray[np.float64]


def modal(problem: ContactProblem) -> ContactProblem:
    """The same problem with its modes compressed."""
    compliance = problem.compliance
    assert isinstance(compliance, tuple)
    basis = modal_basis(compliance[1])
    return ContactProblem.of_modes(problem.separation, problem.lever_arm, problem.torque, compliance[0], basis)


def lines(size: int, phase: float, torque: float = 1e6) -> ContactProblem:
    """Two teeth under lines whose segments soften with their number."""
    along = (np.arange(size) + 0.5) / size * 2.0 - 1.0
    modes = 1e-3 * np.polynomial.legendre.legvander(along, 7)
    half = size // 2
    factor = np.zeros((size, 16))
    factor[:half, :8], factor[half:, 8:] = modes[:half], modes[half:]
    gap = 0.03 * (along - phase) ** 2 + 0.004 * np.cos(9.0 * along)
    return ContactProblem(gap, 42.0 + 2.0 * along, torque, (np.full(size, 3e-8 * size), factor))


@pytest.mark.parametrize("name", PROBLEM_CLASSES)
def test_every_kind_of_problem_ends_as_with_the_active_set(name: str) -> None:
    for problem in problems(name, 40, 11):
        found, other = solve(problem), solve(problem, method="primal_dual_active_set")
        if found.certified and other.certified:
            # By strict convexity of the energy of local deformation, forces are unique up to the certificate.
            scale = other.force.max()
            assert found.certificate.worst <= 1e-10
            if found.method == "modal":
                assert np.abs(found.force - other.force).max() <= 1e-8 * scale
            assert found.elastic_rotation == pytest.approx(other.elastic_rotation, rel=1e-8)


@pytest.mark.parametrize("size", [1, 2, 3, 5, 17, 32, 33, 60, 151, 400, 1000])
def test_forces_are_those_of_the_plain_method_at_every_size(size: int) -> None:
    """From one segment to three levels of coarser parts."""
    for phase in (-0.9, -0.2, 0.4):
        for torque in (1e2, 1e6, 1e8):
            problem = modal(lines(size, phase, torque)) if size > 1 else lines(size, phase, torque)
            found, other = linear_answer(problem), solve(problem, method="primal_dual_active_set")
            assert found is not None
            assert np.abs(found.answer.force - other.force).max() <= 1e-11 * other.force.max()
            assert found.answer.elastic_rotation == pytest.approx(other.elastic_rotation, rel=1e-12)
            closing = other.elastic_rotation * problem.lever_arm.max()
            assert np.abs(found.answer.gap - other.gap).max() <= 1e-12 * max(closing, other.gap.max())
            assert found.answer.certificate.worst <= 1e-12


def test_coarser_parts_leave_few_steps() -> None:
    steps = [linear_answer(modal(lines(2000, phase))) for phase in np.linspace(-0.5, 0.5, 9)]
    assert np.mean([found.iterations for found in steps if found is not None]) <= 5.5


@pytest.mark.parametrize("name", ["plain", "realistic", "mixed_arms", "interfering", "duplicated"])
def test_certificate_is_that_of_the_plain_code(name: str) -> None:
    """Also for answers that are wrong in every way."""
    rng = np.random.default_rng(3)
    for problem in map(modal, problems(name, 15, 5)):
        right = solve(problem)
        for spoil in (0.0, 1e-9, 1e-3, 1.0):
            force = right.force * (1.0 + spoil * rng.standard_normal(problem.size))
            elastic = right.elastic_rotation * (1.0 + spoil * rng.standard_normal())
            found, expected = compiled_certificate(problem, force, elastic)
            assert found[:5] == pytest.approx(expected.violations, rel=1e-6, abs=1e-14)
            assert found[5:] == pytest.approx([expected.resolution, expected.cancellation], rel=0.2)


def test_forces_that_are_not_finite_have_no_certificate() -> None:
    ones = np.ones(3)
    for wrong in (np.nan, np.inf):
        numbers = np.array([0.0, 1.0, *[0.0] * 7])
        certificate(np.array([1.0, wrong, 0.0]), ones, ones, ones, ones, ones, 1.0, 10.0, 0.0, numbers)
        assert np.isinf(numbers[2:7]).all()


# Arrays


def test_arrays_are_solved_as_one_by_one() -> None:
    problem = modal(lines(90, 0.1))
    gaps = np.array([lines(90, phase).separation for phase in np.linspace(-0.6, 0.6, 7)])
    torques = np.geomspace(1e2, 1e8, 7)
    together = solve_many(problem, separation=gaps, torque=torques)
    assert len(together) == 7
    assert together.certified.all()
    for row, (gap, torque) in enumerate(zip(gaps, torques, strict=True)):
        alone = solve(ContactProblem(gap, problem.lever_arm, torque, problem.compliance_matrix))
        assert np.array_equal(together.force[row], alone.force)
        assert np.array_equal(together.gap[row], alone.gap)
        assert (together.rotation[row], together.elastic_rotation[row]) == (alone.rotation, alone.elastic_rotation)
        assert together.certificate[row].tolist() == list(alone.certificate.violations)
        assert together.iterations[row] == alone.iterations


@pytest.mark.parametrize("form", ["modes", "factor", "dense"])
def test_arrays_with_rows_of_every_status(form: str) -> None:
    """No torque, no separations that differ, far segments: whatever `solve` says, row by row."""
    problem = lines(40, 0.0)
    if form == "modes":
        problem = modal(problem)
    elif form == "dense":
        problem = ContactProblem(problem.separation, problem.lever_arm, 1.0, problem.dense_compliance)
    gaps = np.stack([problem.separation, np.zeros(40), problem.separation + 1e6, problem.separation, np.arange(40.0)])
    torques = np.array([0.0, 1e6, 1e6, 1e-12, 1e12])
    together = solve_many(problem, separation=gaps, torque=torques)
    for row in range(5):
        alone = solve(ContactProblem(gaps[row], problem.lever_arm, torques[row], problem.compliance_matrix))
        assert together.status[row] == alone.status
        assert together.force[row] == pytest.approx(alone.force, rel=1e-9, abs=1e-9 * alone.force.max(), nan_ok=True)
        assert together.rotation[row] == pytest.approx(alone.rotation, rel=1e-12, nan_ok=True)


def test_one_row_serves_all() -> None:
    problem = modal(lines(40, 0.0))
    assert solve_many(problem).force.shape == (1, 40)
    assert solve_many(problem, torque=[1e3, 1e4, 1e5]).force.shape == (3, 40)
    assert solve_many(problem, separation=np.zeros((2, 40))).rotation.shape == (2,)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"separation": np.zeros((2, 7))}, "must have the shapes"),
        ({"separation": np.zeros((2, 40)), "torque": [1.0, 2.0, 3.0]}, "must be as many"),
        ({"separation": np.full((2, 40), np.nan)}, "separation"),
        ({"separation": np.full((2, 40), np.inf)}, "separation"),
        ({"torque": [np.nan]}, "torque"),
        ({"torque": [-1.0]}, "torque"),
    ],
)
def test_arrays_are_checked(given: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        solve_many(modal(lines(40, 0.0)), **given)


def test_arrays_go_with_one_problem_alone() -> None:
    problem = lines(40, 0.0)
    with pytest.raises(InputError, match="one problem"):
        solve_many([problem], torque=[1.0])  # type: ignore[call-overload]
    with pytest.raises(InputError, match="initial_active"):
        solve_many(problem, initial_active=[None])  # type: ignore[call-overload]


# Limits of the method


def test_what_the_method_does_not_end_is_left_to_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nearly rigid segments touch, steps or digits do not suffice: no answer, or one that is refused."""
    monkeypatch.setattr(compiled_answer, "SMALLEST_LOCAL_FRACTION", 0.0)
    given = [*problems("weak_local", 60, 2), *problems("nearly_singular", 60, 2)]
    assert any(linear_answer(problem) is None for problem in given)
    for problem in given:
        solution = solve(problem)
        assert solution.certified
        assert solution.certificate.worst <= 1e-9


def test_dense_and_idle_problems_are_not_for_the_compiled_method() -> None:
    problem = lines(20, 0.0)
    assert linear_answer(problem.with_torque(0.0)) is None
    assert linear_answer(ContactProblem(problem.separation, problem.lever_arm, 1.0, problem.dense_compliance)) is None
    nearly_rigid = ContactProblem(
        problem.separation, problem.lever_arm, 1e6, (np.full(20, 1e-14), problem.compliance[1])
    )
    assert linear_answer(nearly_rigid) is None
    assert solve(nearly_rigid).certified


def test_proof_is_on_the_factor_as_given() -> None:
    """A factor whose compression is not its equal: the answer is refused."""
    problem = lines(30, 0.0)
    basis = problem.modal_basis
    assert basis is not None
    vars(problem.compliance_matrix.modes)["columns"] = replace(basis, modes=1.001 * basis.modes).columns  # type: ignore[union-attr]
    assert linear_answer(problem) is None or not linear_answer(problem).answer.certificate.passes()  # type: ignore[union-attr]


@pytest.mark.parametrize("size", [1, 2, 3, 17, 60, 99])
def test_active_set_of_a_small_matrix_is_that_of_the_plain_method(size: int) -> None:
    """Of a matrix that is given, and of one that is formed."""
    for phase in (-0.9, -0.2, 0.4):
        for torque in (1e2, 1e6, 1e8):
            given = lines(size, phase, torque)
            wide = np.hstack([given.compliance[1]] * -(-size // 16)) / size
            for compliance in (given.dense_compliance, (given.compliance[0], wide)):
                problem = ContactProblem(given.separation, given.lever_arm, torque, compliance)
                assert is_small(problem.compliance_matrix, size)
                found, other = dense_answer(problem), solve(problem, method="primal_dual_active_set")
                assert found is not None
                assert np.abs(found.answer.force - other.force).max() <= 1e-11 * other.force.max()
                assert found.answer.elastic_rotation == pytest.approx(other.elastic_rotation, rel=1e-12)
                assert found.answer.certificate.worst <= 1e-12
                warm = dense_answer(problem, found.answer.force > 0.0)
                assert warm is not None
                assert warm.iterations == 1
                assert solve(problem).method == "primal_dual_active_set"


def test_large_and_indefinite_matrices_are_not_for_the_compiled_active_set() -> None:
    problem = lines(LARGEST_DENSE + 1, 0.0)
    assert not is_small(compliance_matrix(problem.dense_compliance, problem.size), problem.size)
    assert not is_small(problem.compliance_matrix, problem.size)
    assert not is_small(modal(lines(40, 0.0)).compliance_matrix, 40)
    indefinite = ContactProblem(np.zeros(2), np.full(2, 40.0), 1e4, np.array([[1e-6, 2e-6], [2e-6, 1e-6]]))
    assert dense_answer(indefinite) is None
    assert dense_answer(ContactProblem(np.zeros(2), np.full(2, 40.0), 0.0, np.diag([1e-6, 1e-6]))) is None
    assert solve(indefinite).status is Status.NOT_POSITIVE_SEMIDEFINITE


# Line contact


@pytest.mark.parametrize("edges", [False, True])
@pytest.mark.parametrize("size", [4, 30, 62, 300])
def test_line_contact_is_that_of_exact_programmes(size: int, edges: bool) -> None:
    bendings, contacts = [], []
    for number, torque in enumerate((1e2, 1e4, 1e6, 3e6)):
        given = lines(size, 0.2 * number - 0.3, torque)
        basis = modal_basis(given.compliance[1])
        bendings.append(ContactProblem.of_modes(given.separation, given.lever_arm, torque, np.zeros(size), basis))
        contacts.append(line_contact_of(size, number, edges=edges))
    for bending, contact in zip(bendings, contacts, strict=True):
        other, _ = solve_on_bending(bending, contact)
        found = line_contact_answers([bending], contact.parameters)[0]
        assert found is not None
        force = found.answer.force
        assert np.abs(force - other.force).max() <= 1e-11 * force.max()
        assert found.answer.elastic_rotation == pytest.approx(other.elastic_rotation, rel=1e-12)
        assert found.secant == pytest.approx(contact.secant(force), rel=1e-14)
        assert found.answer.certificate.worst <= 1e-11
        assert bending.modal_basis is not None
        stiffness = touching_stiffness(contact.tangent(force), bending.modal_basis, bending.lever_arm, force > 0.0)
        assert found.stiffness == pytest.approx(stiffness, rel=1e-10)


def test_torques_solved_together_are_those_solved_alone() -> None:
    given = lines(62, 0.1, 1e6)
    parts = given.separation, given.lever_arm, 1e6, np.zeros(62), modal_basis(given.compliance[1])
    contact, first = line_contact_of(62, 3, edges=True), ContactProblem.of_modes(*parts)
    bendings = [first.with_torque(torque) for torque in (3e6, 1e2, 1e5)]
    for bending, found in zip(bendings, line_contact_answers(bendings, contact.parameters), strict=True):
        alone = line_contact_answers([bending], contact.parameters)[0]
        assert found is not None
        assert alone is not None
        assert found.answer.force.tolist() == alone.answer.force.tolist()
        assert (found.iterations, found.stiffness) == (alone.iterations, alone.stiffness)
        assert found.answer.problem is not None
        assert found.answer.problem.torque == bending.torque


def test_statuses_have_numbers_in_arrays() -> None:
    assert solve_many(modal(lines(12, 0.0))).status.tolist() == [Status.CERTIFIED]


# The source


def bits_of(kernel: Any, given: ContactProblem, law: Array, torques: Array, mask: NDArray[np.uint8]) -> list[Array]:
    """What `solve_batch` gives of a problem at several torques."""
    matrix, count, size = given.compliance_matrix, torques.size, given.size
    assert isinstance(matrix, ModalCompliance)
    factor = np.empty(0) if isinstance(matrix.modes, ModalBasis) else matrix.factor.reshape(-1)
    found = [np.full((count, size), np.nan) for _ in range(3)]
    numbers, counts = np.full((count, 10), np.nan), np.zeros((count, 2), dtype=np.int64)
    with np.errstate(all="ignore"):
        kernel.solve_batch(
            tuple(matrix.modes.columns), factor, torques, np.repeat(given.separation[None], count, axis=0),
            given.lever_arm, matrix.local, matrix.diagonal, law, mask, *found, numbers, counts,
        )  # fmt: skip
    return [*found, numbers, counts]


def assert_same_bits(
    given: ContactProblem, law: Array, torques: Array, mask: NDArray[np.uint8], what: str = ""
) -> None:
    source = kernels.in_python("easeoff.contact.solvers.compiled.newton_kernel")
    pairs = zip(
        bits_of(newton_kernel, given, law, torques, mask), bits_of(source, given, law, torques, mask), strict=True
    )
    for mine, other in pairs:
        np.testing.assert_array_equal(mine, other, err_msg=what)


@pytest.mark.parametrize("name", PROBLEM_CLASSES)
def test_dense_problems_have_the_bits_of_the_source(name: str) -> None:
    source = kernels.in_python("easeoff.contact.solvers.compiled.dense_kernel")
    for given in problems(name, 30, 11):
        size, matrix = given.size, given.dense_compliance.reshape(-1)
        for start in (None, np.arange(size) % 3 == 0):
            found = []
            for one in (dense_kernel, source):
                room, places = np.zeros((size + 4) * (size + 9)), np.zeros(2 * size, dtype=np.int64)
                places[:size] = 0 if start is None else start
                result = np.full(size, np.nan), np.full(size, np.nan), np.full(10, np.nan)
                with np.errstate(all="ignore"):
                    steps = one.solve_dense(
                        matrix, 3, given.torque, given.separation, given.lever_arm, start is not None, room, places,
                        *result,
                    )  # fmt: skip
                found.append((steps, *(result if steps else ())))
            for mine, other in zip(*found, strict=True):
                np.testing.assert_array_equal(mine, other)


@pytest.mark.parametrize("size", [1, 9, 33])
def test_blocks_and_modes_have_the_bits_of_the_source(size: int) -> None:
    """With rows and columns of zeros, and shared columns."""
    source, rng = kernels.in_python("easeoff.contact.problem.mode_kernel"), np.random.default_rng(size)
    smooth = rng.standard_normal((size, 3)) @ rng.standard_normal((3, 7))
    factor = np.zeros((2 * size + 2, 15))
    factor[:size, 1:8], factor[size : 2 * size, 8:14] = smooth, rng.standard_normal((size, 6))
    shared = rng.standard_normal((2 * size + 2, 2))
    found = []
    for kernel_functions in (mode_kernel, source):
        with pytest.MonkeyPatch.context() as patch:
            for name in ("label_blocks", "arrange"):
                patch.setattr(modal_basis_module, name, getattr(kernel_functions, name))
            labels = block_labels(factor)
            compressed = [(rows, factor[rows][:, columns]) for rows, columns in labels.blocks]
            columns = mode_columns(2 * size + 2, compressed, shared, np.ones((3, 2, 2)), shared)
            found.append([*labels, *columns])
    assert [block.shape for _, block in compressed] == [(size, 7), (size, 6), (2, 0)]
    for mine, other in zip(*found, strict=True):
        np.testing.assert_array_equal(mine, other)


NO_LAW, NO_MASK = np.empty((0, 14)), np.empty((0, 0), dtype=np.uint8)


@pytest.mark.parametrize("count", [1, pytest.param(30, marks=pytest.mark.thorough)])
@pytest.mark.parametrize("name", sorted(set(PROBLEM_CLASSES) - {"random_dense"}))
def test_linear_problems_have_the_bits_of_the_source(name: str, count: int) -> None:
    every = list(problems(name, count, 11))
    for given in [*every, *map(modal, every)]:
        torques = np.array([max(given.torque, 1.0), 0.0])
        for mask in (NO_MASK, np.array([np.arange(given.size) % 3 == 0] * 2).view(np.uint8)):
            assert_same_bits(given, NO_LAW, torques, mask)


@pytest.mark.parametrize("seeds", [(0, 1, 6), pytest.param(range(10, 60), marks=pytest.mark.thorough)], ids=str)
@pytest.mark.parametrize("alike", [False, True])
def test_shared_modes_and_line_contact_have_the_bits_of_the_source(seeds: Sequence[int], alike: bool) -> None:
    for seed in seeds:
        given = shared_problem(seed, alike=alike, signs=seed % 3 == 0, longest=12)
        assert_same_bits(given, NO_LAW, np.array([1e4]), NO_MASK, f"seed {seed}")
        law = line_contact_of(given.size, seed, edges=alike).parameters
        assert_same_bits(given, law, np.array([1e2, 1e6]), NO_MASK, f"seed {seed}, in line contact")


@pytest.mark.parametrize("size", [4, 33, 400])
def test_levels_of_coarser_parts_have_the_bits_of_the_source(size: int) -> None:
    given = modal(lines(size, 0.2))
    assert_same_bits(given, NO_LAW, np.array([1e2, 1e6]), NO_MASK)
    assert_same_bits(given, line_contact_of(size, 3).parameters, np.array([1e4]), NO_MASK)


@pytest.mark.parametrize("name", ["nasa-12x36", pytest.param("fh-12x41-45", marks=pytest.mark.thorough)])
def test_every_way_to_analyse_a_case_gives_the_same_bits(name: str, tmp_path: Path) -> None:
    """First and later, by a command, as a point of a sweep, in a pool, and as a load case."""
    case, torques = small(name, "shell"), [50.0, 150.0]
    tree = easeoff.analyze(case, torques=torques)
    write_case(case, tmp_path / "case.toml")
    output_of("run", tmp_path / "case.toml", "--torque", "50,150", "-o", tmp_path / "r.nc")
    for other in (easeoff.analyze(case, torques=torques), easeoff.read_result(tmp_path / "r.nc")):
        for group in ("ease_off", "unloaded", "light_load", "loaded"):
            xr.testing.assert_equal(other[group].to_dataset(), tree[group].to_dataset())
    numbers, offset = key_numbers(tree), case.misalignment.offset
    for workers in (1, 2):
        point = easeoff.sweep(case, {"E": [offset, offset + 0.01]}, torques=torques, workers=workers).isel(E=0)
        for variable in set(point.data_vars) & set(numbers.data_vars):
            np.testing.assert_array_equal(point[variable].values, numbers[variable].values, err_msg=str(variable))
    alone = easeoff.analyze(case, torques=torques[:1])["loaded"].to_dataset()
    loads = analyze_load_cases(case, [LoadCase(torque=torques[0])])["results/1/loaded"].to_dataset()
    xr.testing.assert_equal(loads, alone)
    loaded = tree["loaded"].to_dataset()  # of another list of torques, as the page of results has it
    xr.testing.assert_equal(easeoff.analyze(case, torques=torques[1:])["loaded"].to_dataset(), loaded.isel(torque=[1]))
    for number, tolerance in {"transmission_error": 1e-8, "max_pressure": 1e-8, "contact_ratio": 0.02}.items():
        np.testing.assert_allclose(alone[number], loaded[number].isel(torque=[0]), rtol=tolerance)


def test_splines_and_least_gaps_have_the_bits_of_the_source() -> None:
    rng = np.random.default_rng(4)
    nodes = np.linspace(0.0, 1.0, 9) ** 1.1, np.linspace(0.0, 2.0, 5)
    spline = TensorSpline.through(nodes, rng.normal(size=(9, 5, 2)), (5, 4))
    points, orders = rng.uniform(-0.1, 2.1, (2, 60)), [(0, 0), (2, 1), (0, 5), (3, 0)]
    points[0, 7] = np.nan
    found = spline.evaluate(points, orders)
    with pytest.MonkeyPatch.context() as patch, np.errstate(all="ignore"):
        patch.setattr(flank_splines, "evaluate", kernels.in_python("easeoff.contact.lines.spline_kernel").evaluate)
        for mine, other in zip(found, spline.evaluate(points, orders), strict=True):
            np.testing.assert_array_equal(mine, other)
    at_points = [*rng.uniform(-1.0, 1.0, (3, 40)), rng.uniform(-5.0, 20.0, 40), rng.uniform(0.0, 0.2, 40)]
    at_points[0][3] = np.nan
    given: Any = [*at_points, np.linspace(-1.0, 1.0, 17), 30.0, 12.0, 0.1, rng.uniform(0.0, 0.1, 25), 2]
    source = kernels.in_python("easeoff.contact.evaluation.least_gap_kernel")
    mine, other = np.empty(40), np.empty(40)
    least_gap_kernel.least_beside(*(*given, mine))
    source.least_beside(*(*given, other))
    np.testing.assert_array_equal(mine, other)


def test_a_kernel_that_is_not_that_of_its_source_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    for name, files in {"missing": (), "uncompiled": ("one.py",), "stale": ("one.py", "one.pxd")}.items():
        folder = tmp_path / name
        folder.mkdir()
        (folder / "__init__.py").touch()
        for file in files:
            (folder / file).write_text("x = 1\n")
    honest = Path(newton_kernel.__file__)
    (tmp_path / "stale" / f"one{honest.name.removeprefix('newton_kernel')}").touch()
    stale = types.SimpleNamespace(SOURCE_DIGEST="another")
    monkeypatch.setattr(importlib, "import_module", lambda *_: stale)
    for name, message in {"missing": "not compiled", "uncompiled": "not compiled", "stale": "has changed"}.items():
        with pytest.raises(MissingPackageError, match=f"^{name}.one: .*{message}.*; run 'make'"):
            kernel(".one", name)
    digest = source_digest(tmp_path / "stale" / "one.py")
    stale.SOURCE_DIGEST = digest
    assert kernel(".one", "stale") is stale
    for file in ("two.py", "two.pxd"):  # which it may use
        (tmp_path / "stale" / file).write_text("y = 2\n")
    with pytest.raises(MissingPackageError, match="has changed"):
        kernel(".one", "stale")


@pytest.mark.parametrize("size", [24, 120])
def test_no_modes_are_sought_where_there_are_as_many_as_segments(size: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The matrix is the smaller form then; with compressed modes the answer is the same."""
    rng = np.random.default_rng(5)
    along = np.linspace(-1.0, 1.0, size)
    factor = 1e-3 * np.polynomial.legendre.legvander(along, 5) @ rng.uniform(-1.0, 1.0, (6, size))
    given = ContactProblem(0.02 * along**2, np.full(size, 40.0), 8e4, (np.full(size, 2e-6), factor))
    with monkeypatch.context() as patch:
        patch.setattr("easeoff.contact.problem.modal_basis.compressed_block", _refused)
        solution = solve(given)
    assert (solution.certified, solution.method) == (True, "primal_dual_active_set")
    columns = 1e-3 * rng.uniform(-1.0, 1.0, (2, size // 2, size))
    halves = np.block([[columns[0], np.zeros((size // 2, size))], [np.zeros((size // 2, size)), columns[1]]])
    few = "modal" if size > LARGEST_FORMED else "primal_dual_active_set"
    for factor, method in ((halves, few), (halves + 1e-300, "primal_dual_active_set")):
        blocks = ContactProblem(given.separation, given.lever_arm, given.torque, (given.compliance[0], factor))
        assert solve(blocks).method == method
    other = solve(modal(given))
    assert (other.certified, other.method) == (True, "modal")
    np.testing.assert_allclose(solution.force, other.force, rtol=1e-10, atol=1e-9 * other.force.max())
    assert solution.rotation == pytest.approx(other.rotation, rel=1e-12)
    for one in (solution, other):
        assert one.times.solve > 0.0
        assert one.times.setup > 0.0
        assert one.times.call == pytest.approx(one.times.setup + one.times.solve)


def _refused(*_: Array) -> Array:
    raise AssertionError("modes are sought")
