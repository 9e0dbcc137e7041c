"""The compiled contact solution beside the plain one: answers, certificates, statuses; and without numba."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import Any

import kernels
import numpy as np
import pytest
from numpy.typing import NDArray
from shared_problems import compiled_certificate, line_contact_of

import easeoff
from easeoff import InputError
from easeoff.contact import ContactProblem, Status, solve, solve_many
from easeoff.contact.line_contact.line_contact_law import LineContacts, newton_answers
from easeoff.contact.problem.modal_basis import modal_basis
from easeoff.contact.solvers import registry
from easeoff.contact.solvers.compiled import compiled_answer
from easeoff.contact.solvers.compiled.compiled_answer import (
    CompiledAnswer,
    compiled_code,
    line_contact_answers,
    linear_answer,
)
from easeoff.contact.solvers.parametric.touching_form import touching_stiffness
from easeoff.contact.solvers.problem_batch import plain_solutions
from easeoff.verification import problems
from easeoff.verification.problem_classes import PROBLEM_CLASSES

Array = NDArray[np.float64]

pytestmark = pytest.mark.usefixtures("kernels_in_python")


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


@pytest.fixture
def plain(monkeypatch: pytest.MonkeyPatch) -> None:
    """`solve` without compiled code."""
    monkeypatch.setattr(registry, "linear_answer", lambda *_: None)


@pytest.mark.parametrize("name", PROBLEM_CLASSES)
def test_every_kind_of_problem_ends_as_with_the_plain_methods(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    given = list(problems(name, 40, 11))
    compiled = [solve(problem) for problem in given]
    monkeypatch.setattr(registry, "linear_answer", lambda *_: None)
    for problem, found, other in zip(given, compiled, plain_solutions(given, [None] * len(given)), strict=True):
        assert found.status is other.status
        if found.certified:
            # By strict convexity of the energy of local deformation, forces are unique up to the certificate.
            scale = other.force.max()
            assert found.certificate.worst <= 1e-10
            if problem.is_structured and found.method == other.method == "modal":
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
        known = (10.0, 0.0)
        compiled_code()._certificate(np.array([1.0, wrong, 0.0]), ones, ones, ones, ones, ones, 1.0, known, numbers)
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
    vars(problem.compliance_matrix.modes)["basis"] = replace(basis, modes=1.001 * basis.modes)  # type: ignore[union-attr]
    assert linear_answer(problem) is None or not linear_answer(problem).answer.certificate.passes()  # type: ignore[union-attr]


# Line contact


@pytest.mark.parametrize("edges", [False, True])
@pytest.mark.parametrize("size", [4, 30, 62, 300])
def test_line_contact_is_that_of_the_plain_method(size: int, edges: bool) -> None:
    bendings, contacts = [], []
    for number, torque in enumerate((1e2, 1e4, 1e6, 3e6)):
        given = lines(size, 0.2 * number - 0.3, torque)
        basis = modal_basis(given.compliance[1])
        bendings.append(ContactProblem.of_modes(given.separation, given.lever_arm, torque, np.zeros(size), basis))
        contacts.append(line_contact_of(size, number, edges=edges))
    expected = newton_answers(bendings, LineContacts(contacts), [None] * 4)
    for bending, contact, other in zip(bendings, contacts, expected, strict=True):
        assert other is not None
        found = line_contact_answers([bending], contact.parameters)[0]
        assert found is not None
        force = found.answer.force
        assert np.abs(force - other[0].force).max() <= 1e-11 * force.max()
        assert found.answer.elastic_rotation == pytest.approx(other[0].elastic_rotation, rel=1e-12)
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


@pytest.mark.parametrize("edges", [False, True])
def test_strip_is_the_formula_over_all_decades(edges: bool) -> None:
    size = 200
    contact = line_contact_of(size, 1, edges=edges)
    for scale in np.geomspace(1e-6, 1e7, 14):
        force = np.full(size, scale)
        secant, tangent = np.array(
            [compiled_code()._strip(p, f / p[0]) for p, f in zip(contact.parameters, force, strict=True)]
        ).T
        assert secant / contact.length == pytest.approx(contact.secant(force), rel=1e-14)
        assert tangent / contact.length == pytest.approx(contact.tangent(force), rel=1e-13)


# Without numba


def test_package_works_without_numba(tmp_path: Path) -> None:
    """The plain methods give the same answers where numba cannot be imported, or is switched off."""
    program = (
        "import sys, numpy as np\n"
        "if sys.argv[1] == 'missing': sys.modules['numba'] = None\n"
        "from easeoff.contact import ContactProblem, solve, solve_many\n"
        "from easeoff.contact.solvers.compiled.compiled_answer import compiled_code\n"
        "assert compiled_code() is None\n"
        "springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8e4, (np.full(2, 1e-6), np.full((2, 1), 1e-4)))\n"
        "print(solve(springs).force.tolist(), solve_many(springs, torque=[8e4, 4e4]).certified.all())\n"
    )
    root = str(Path(easeoff.__file__).parent.parent)
    for way, switch in (("missing", "1"), ("off", "0")):
        environment = {"PYTHONPATH": root, "EASEOFF_COMPILED": switch, "PATH": ""}
        done = subprocess.run(
            [sys.executable, "-c", program, way], env=environment, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        assert done.stdout.strip() == "[1000.0, 1000.0] True"


def test_statuses_have_numbers_in_arrays() -> None:
    assert solve_many(modal(lines(12, 0.0))).status.tolist() == [Status.CERTIFIED]


@pytest.mark.thorough
def test_compiled_code_is_its_source() -> None:
    """On all classes of problems, lines of every size and line contact; its sums may be taken in another order."""
    given = [*chain.from_iterable(problems(name, 10, 11) for name in PROBLEM_CLASSES)]
    given += [modal(lines(size, phase)) for size in (60, 151, 400) for phase in (-0.9, 0.4)]
    soft, contact = lines(62, 0.1), line_contact_of(62, 3, edges=True)
    basis = modal_basis(soft.compliance[1])
    bending = ContactProblem.of_modes(soft.separation, soft.lever_arm, 1e6, np.zeros(62), basis)

    def answers() -> list[CompiledAnswer | None]:
        return [*map(linear_answer, given), *line_contact_answers([bending], contact.parameters)]

    expected = answers()
    with kernels.compiled():
        assert compiled_code().solve_batch.signatures
        found = answers()
    assert sum(answer is not None for answer in found) > 100
    for mine, other in zip(found, expected, strict=True):
        assert (mine is None) == (other is None)
        if mine is not None and other is not None:
            assert np.abs(mine.answer.force - other.answer.force).max() <= 1e-10 * other.answer.force.max()
            assert mine.answer.elastic_rotation == pytest.approx(other.answer.elastic_rotation, rel=1e-11)
            assert mine.secant == pytest.approx(other.secant, rel=1e-10)
            assert mine.stiffness == pytest.approx(other.stiffness, rel=1e-10, nan_ok=True)


@pytest.mark.thorough
def test_the_process_that_compiles_gives_the_same_bits_as_later_ones(tmp_path: Path) -> None:
    """Inner sums are taken in any order: which copies of them run must not depend on who compiled them."""
    code = """
import easeoff
from easeoff.cases import read_case
from easeoff.core.compiled.compiled_use import compiling
coarse = {"mesh_positions": 6, "segments_per_line": 21}
case = read_case("nasa-12x36")
case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
with compiling():
    print(easeoff.analyze(case, torques=[50.0, 150.0])["loaded/force"].values.tobytes().hex())
"""
    variables = {
        "EASEOFF_COMPILED": "1",
        "NUMBA_CACHE_DIR": str(tmp_path),
        "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
    }
    first, second = (
        subprocess.run(
            [sys.executable, "-c", code], env={**os.environ, **variables}, capture_output=True, text=True, check=True
        ).stdout
        for _ in range(2)
    )
    assert list(tmp_path.rglob("newton_kernel.solve_batch*.nbc"))
    assert first == second


@pytest.mark.thorough
def test_code_counts_as_kept_where_numba_loads_it(tmp_path: Path) -> None:
    """Not compiled at all where it may not be: loaded if the file is as it was, and refused if it has changed."""
    module = tmp_path / "doubled.py"
    text = (
        "from easeoff.core.compiled.compilation import compiled\n\n\n"
        "@compiled('float64(float64)')\ndef doubled(x):\n    return {} * x\n"
    )
    compiling = "from easeoff.core.compiled.compiled_use import compiling\nwith compiling(): import doubled\n"
    plain = "import doubled\nprint(doubled.doubled.stats.cache_hits)\n"
    folders = os.pathsep.join(filter(None, [str(tmp_path), *sys.path]))
    kept = {"EASEOFF_COMPILED": "1", "NUMBA_CACHE_DIR": str(tmp_path / "kept"), "PYTHONPATH": folders}
    variables = os.environ | kept

    def run(code: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([sys.executable, "-c", code], env=variables, capture_output=True, text=True, check=False)

    module.write_text(text.format("2.0"))
    assert "NotCompiledError" in run(plain).stderr
    assert run(compiling).returncode == 0
    assert run(plain).stdout == "Counter({'float64(float64)': 1})\n"
    module.write_text(text.format("3.0 + 0.0"))
    assert "NotCompiledError" in run(plain).stderr


def test_no_modes_are_sought_where_there_are_as_many_as_segments(monkeypatch: pytest.MonkeyPatch) -> None:
    """The matrix is the smaller form then; with compressed modes the answer is the same."""
    rng = np.random.default_rng(5)
    size = 24
    along = np.linspace(-1.0, 1.0, size)
    factor = 1e-3 * np.polynomial.legendre.legvander(along, 5) @ rng.uniform(-1.0, 1.0, (6, size))
    given = ContactProblem(0.02 * along**2, np.full(size, 40.0), 8e4, (np.full(size, 2e-6), factor))
    with monkeypatch.context() as patch:
        patch.setattr("easeoff.contact.problem.modal_basis.compressed_block", _refused)
        solution = solve(given)
    assert (solution.certified, solution.method) == (True, "primal_dual_active_set")
    other = solve(modal(given))
    assert (other.certified, other.method) == (True, "modal")
    np.testing.assert_allclose(solution.force, other.force, rtol=1e-10, atol=1e-9 * other.force.max())
    assert solution.rotation == pytest.approx(other.rotation, rel=1e-12)
    for one in (solution, other):
        assert one.times.solve > 0.0
        assert one.times.setup > 0.0
        assert one.times.call == pytest.approx(one.times.setup + one.times.solve)


def _refused(_: Array) -> Array:
    raise AssertionError("modes are sought")
