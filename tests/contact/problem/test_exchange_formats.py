"""Contact problems in the formats of other programs, each read back by the reader of its field."""

from __future__ import annotations

import csv
import math
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import h5py
import netCDF4
import numpy as np
import pytest
import qpsolvers
import scipy.io
from runs import output_of, refusal_of, text_file
from scipy.sparse import csc_array, csr_array

from easeoff import InputError
from easeoff.contact import (
    ContactProblem,
    ProblemSet,
    export_problems,
    import_problems,
    read_problems,
    read_references,
    solve,
    write_problems,
)
from easeoff.contact.problem.exchange.fclib_file import read_fclib, write_fclib
from easeoff.contact.problem.exchange.problem_formats import read_mat, write_mat
from easeoff.contact.problem.exchange.programme_file import qps_programme, read_qps, write_qps
from easeoff.study.compare.problem_export import write_problem_set, write_test_set
from easeoff.study.library import Entry, entries, generate, reference_answers
from easeoff.verification import problems
from easeoff.verification.problem_classes import PROBLEM_CLASSES

SINGLE = ("npz", "qps", "hdf5")


@cache
def every_class() -> list[ContactProblem]:
    return [problem for name in PROBLEM_CLASSES for problem in problems(name, 1)]


def springs() -> ContactProblem:
    """Uncoupled springs whose rotation is known in closed form."""
    arm, local = np.array([40.0, 41.0, 43.0]), np.array([1e-6, 2e-6, 3e-6])
    return ContactProblem(1e-3 * arm, arm, 1e5, np.diag(local))


def bed() -> ContactProblem:
    """Structured problem of two dozen segments, some of which stay open."""
    x = np.linspace(-1.0, 1.0, 24)
    modes = 2e-3 * np.stack([np.ones(24), x, x**2 - 0.4], axis=1)
    return ContactProblem(0.03 + 0.02 * x**2, 40.0 + 3.0 * x, 6e4, (np.full(24, 2e-5), modes))


def labelled_set() -> ProblemSet:
    chosen = [springs(), bed()]
    labels = {
        "name": np.array(["springs", "bed of x/y"]),
        "kind": np.array(["a", ""]),
        "torque_level": np.array([1, 2]),
    }
    return ProblemSet(chosen, labels, [solve(problem).answer for problem in chosen])


@pytest.mark.usefixtures("reading_here")
@pytest.mark.parametrize("format", SINGLE)
def test_single_problems_come_back_to_the_bit(tmp_path: Path, format: str) -> None:
    given = every_class()
    paths = export_problems(given, tmp_path, format)
    assert len(paths) == len(given)
    read = import_problems(tmp_path)
    assert all(a.identical(b) for a, b in zip(read.problems, given, strict=True))


@pytest.mark.parametrize("format", ["nc", "mat"])
def test_many_problems_come_back_with_labels_and_references(tmp_path: Path, format: str) -> None:
    given, path = labelled_set(), tmp_path / f"problems.{format}"
    assert export_problems(given, path) == [path]
    read = import_problems(path)
    assert all(a.identical(b) for a, b in zip(read.problems, given.problems, strict=True))
    assert {name: list(values) for name, values in read.labels.items()} == {
        name: list(values) for name, values in given.labels.items()
    }
    for i in range(2):
        found, expected = read.answer(i), given.answer(i)
        assert found is not None
        assert expected is not None
        assert found.force.tolist() == expected.force.tolist()
        np.testing.assert_allclose(found.gap, expected.gap, rtol=0.0, atol=1e-15 * np.abs(expected.gap).max())
        assert (found.rotation, found.elastic_rotation) == (expected.rotation, expected.elastic_rotation)
        assert found.certificate.worst < 1e-12


def test_all_classes_come_back_from_matlab(tmp_path: Path) -> None:
    given = every_class()
    write_mat(ProblemSet(given), tmp_path / "problems.mat")
    read = read_mat(tmp_path / "problems.mat")
    assert read.answers is None
    assert all(a.identical(b) for a, b in zip(read.problems, given, strict=True))


def units_of(path: Path) -> dict[str, float]:
    """Units that the comments of a QPS file name."""
    comments = qps_programme(path.read_text().splitlines()).comments
    return {line.split()[3]: float(line.split("=")[1]) for line in comments if "unit of" in line}


@pytest.mark.parametrize("form", ["dense", "lifted"])
def test_highs_reads_and_solves_a_qps_file(tmp_path: Path, form: str) -> None:
    """The forces and the dual of BALANCE in the units of the comments are those of the native solver."""
    highspy = pytest.importorskip("highspy")
    problem, path = bed(), tmp_path / "bed.mps"  # HiGHS takes no other suffix
    write_qps(problem, path, form=form, name="bed of springs")
    units = units_of(path)
    assert qps_programme(path.read_text().splitlines()).name == "bed_of_springs"
    program = highspy.Highs()
    program.setOptionValue("output_flag", False)
    program.setOptionValue("qp_regularization_value", 0.0)
    assert program.readModel(str(path)) == highspy.HighsStatus.kOk
    model = program.getLp()
    assert model.num_col_ == (24 if form == "dense" else 27)
    program.run()
    answer = program.getSolution()
    expected = solve(problem)
    force = np.array(answer.col_value)[:24] * units["force"]
    rotation = answer.row_dual[0] * units["force"] * units["compliance"] / units["lever_arm"]
    np.testing.assert_allclose(force, expected.force, rtol=0, atol=1e-6 * expected.force.max())
    assert rotation == pytest.approx(expected.rotation, rel=1e-6)
    assert 0 < np.count_nonzero(expected.force) < 24


@cache
def of_the_library() -> list[tuple[Entry, ContactProblem]]:
    chosen = [
        e for e in entries() if e.part == "small" and e.source.case == "nasa-12x36" and "scaled-torque" not in e.name
    ]
    return list(generate(chosen[::3]))


@pytest.mark.parametrize("form", ["dense", None])
def test_highs_solves_problems_of_the_library(tmp_path: Path, form: str | None) -> None:
    """Real, nearly singular, degenerate, with a singular compliance and without any local one."""
    highspy = pytest.importorskip("highspy")
    for number, (entry, problem) in enumerate(of_the_library()):
        if form == "dense" and not problem.is_structured:
            continue  # there is no other form of it
        (path,) = export_problems([problem], tmp_path / f"{number}.mps", form=form)
        program = highspy.Highs()
        program.setOptionValue("output_flag", False)
        program.setOptionValue("qp_regularization_value", 0.0)
        assert program.readModel(str(path)) != highspy.HighsStatus.kError
        program.run()
        units = units_of(path)
        rotation = program.getSolution().row_dual[0] * units["force"] * units["compliance"] / units["lever_arm"]
        expected = reference_answers()[entry.name].elastic_rotation
        assert rotation - problem.first_contact_rotation == pytest.approx(expected, rel=1e-7), entry.name


def test_qps_file_says_the_programme_in_numbers_of_order_one(tmp_path: Path) -> None:
    path = tmp_path / "springs.qps"
    write_qps(springs(), path)
    programme = qps_programme(path.read_text().splitlines())
    assert list(programme.linear) == ["F1", "F2", "F3"]
    assert programme.row_types == {"BALANCE": "E"}
    assert sorted(programme.quadratic) == [("F1", "F1"), ("F2", "F2"), ("F3", "F3")]
    numbers = [*programme.entries["BALANCE"].values(), *programme.quadratic.values()]
    assert 0.1 < min(numbers) < max(numbers) < 10.0
    assert max(map(len, path.read_text().split())) < 25  # 17 digits, sign, point and exponent
    assert all(len(name) <= 8 for name in [*programme.linear, *programme.row_types])


def test_qps_file_without_a_power_of_two_that_fits_stays_in_mm_and_newton(tmp_path: Path) -> None:
    """Scaled, its smallest number would underflow: it is written as it is."""
    extreme = ContactProblem(np.array([5e-324, 1.0]), np.full(2, 40.0), 1e-3, np.diag([1.0, 3e-5]))
    write_qps(extreme, tmp_path / "extreme.qps")
    assert read_qps(tmp_path / "extreme.qps").identical(extreme)


QPS = """* from elsewhere
NAME          QP example
OBJSENSE
    MIN
ROWS
 N  obj
 E  c1
 N  other
COLUMNS
    x1        c1        40.0   obj       1.D-3
    x2        c1        41.0
    x2        other     7.0
RHS
    rhs1      c1        1e5    obj       -4.0
BOUNDS
 LO bnd1      x1        0.0
 PL bnd1      x2
QUADOBJ
    x1        x1        2e-6
    x1        x2        1e-6
    x2        x2        2e-6
ENDATA
"""


def test_qps_file_from_elsewhere_in_either_triangle(tmp_path: Path) -> None:
    path = tmp_path / "other.qps"
    expected = ContactProblem([1e-3, 0.0], [40.0, 41.0], 1e5, [[2e-6, 1e-6], [1e-6, 2e-6]])
    other = QPS.replace("x1        x2        1e-6", "x2        x1        1e-6")
    full = QPS.replace("QUADOBJ", "QMATRIX").replace("x2        x2", "x2        x1   1e-6  x2")
    for text in (QPS, other, full, QPS.replace("    rhs1      c1", "    c1")):
        path.write_text(text)
        assert read_qps(path).identical(expected)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda t: t.replace(" MIN", " MAX"), "OBJSENSE = 'MAX': must be MIN"),
        (lambda t: t.replace(" E  c1", " L  c1"), "type of the row c1 = L"),
        (lambda t: t.replace("PL bnd1      x2", "UP bnd1      x2  9.0"), "bounds of x2 = 0, 9"),
        (lambda t: t.replace("PL bnd1      x2", "FR bnd1      x2"), "rows: must be one equality"),
        (lambda t: t.replace("BOUNDS", "RANGES\n rng c1 2.0\nBOUNDS"), "RANGES: must be left out"),
        (lambda t: t.replace("x1        x2        1e-6", "x1        x1        1e-6"), "must come once"),
        (lambda t: t.replace("x2        x2        2e-6", "x3        x2        2e-6"), "'x3': must be declared"),
        (lambda t: t.replace("2e-6\n", "two\n"), "line 19 = .* must be a line of the section QUADOBJ"),
        (lambda t: t.replace("QUADOBJ", "CONES"), "must be one of the sections"),
        (lambda t: t.replace("1e5", "-1e5"), "torque"),
        (lambda t: "", "ends without ENDATA"),
    ],
)
def test_qps_files_of_other_programmes_are_refused(tmp_path: Path, change: Any, words: str) -> None:
    path = text_file(tmp_path / "other.qps", change(QPS))
    with pytest.raises(InputError, match=words) as found:
        read_qps(path)
    assert str(path) in str(found.value)


def test_scipy_reads_a_matlab_file_as_columns(tmp_path: Path) -> None:
    write_mat(labelled_set(), tmp_path / "problems.mat")
    array = scipy.io.loadmat(tmp_path / "problems.mat")["problem"]
    assert array.shape == (1, 2)
    dense, structured = array[0]
    assert dense["separation"].shape == (3, 1)
    assert dense["compliance_factor"].shape == (0, 0)
    assert structured["compliance_factor"].shape == (24, 3)
    assert structured["kind"].size == 0
    assert dense["name"][0] == "springs"
    C = (
        np.diag(structured["compliance_diagonal"].ravel())
        + structured["compliance_factor"] @ structured["compliance_factor"].T
    )
    force, gap = structured["reference_force"].ravel(), structured["reference_gap"].ravel()
    arm, rotation = structured["lever_arm"].ravel(), structured["reference_rotation"].item()
    found = C @ force + structured["separation"].ravel() - arm * rotation
    np.testing.assert_allclose(found, gap, rtol=0, atol=1e-13)
    assert arm @ force == pytest.approx(structured["torque"].item(), rel=1e-12)


def test_matlab_files_of_other_programs(tmp_path: Path) -> None:
    """The variables of one problem, vectors as rows, a sparse matrix; and what is refused."""
    path, problem = tmp_path / "other.mat", springs()
    given = {"separation": problem.separation, "lever_arm": problem.lever_arm, "torque": problem.torque}
    scipy.io.savemat(path, {**given, "compliance": csc_array(problem.compliance)}, oned_as="row")
    assert read_mat(path).problems[0].identical(problem)
    for content, words in (
        (given, "without compliance"),
        ({**given, "compliance": 1j * np.ones((3, 3))}, "must hold real numbers"),
        ({"compliance": np.eye(3)}, "without separation, lever_arm, torque"),
        ({**given, "torque": np.ones(2), "compliance": np.eye(3)}, "torque .* must be one number"),
    ):
        scipy.io.savemat(path, content)
        with pytest.raises(InputError, match=words):
            read_mat(path)
    path.write_bytes(b"not a MATLAB file" * 20)
    with pytest.raises(InputError, match="not a MATLAB file"):
        read_mat(path)
    with pytest.raises(InputError, match="label = 'a b'"):
        write_mat(ProblemSet([problem], {"a b": np.zeros(1)}), path)


def read_matrix(group: Any) -> Any:
    """A matrix as FCLib's C reader takes it: nz, then as many numbers of p, i and x as it says."""
    m, n, nz, nzmax = (int(group[name][0]) for name in ("m", "n", "nz", "nzmax"))
    assert all(group[name].shape == (1,) and group[name].dtype == np.int32 for name in ("m", "n", "nz", "nzmax"))
    assert group["p"].dtype == group["i"].dtype == np.int32
    assert group["x"].dtype == np.float64
    assert nz == -1
    assert group["p"].shape == (n + 1,)
    assert group["i"].shape == group["x"].shape == (nzmax,)
    return csc_array((group["x"][()], group["i"][()], group["p"][()]), shape=(m, n))


@pytest.mark.parametrize("problem", [springs(), bed()])
def test_h5py_reads_the_layout_of_fclib(tmp_path: Path, problem: ContactProblem) -> None:
    """u = W r + V l + q, V'r + R l + s = 0, with the stored solution, the normal direction of each contact first."""
    answer, path = solve(problem).answer, tmp_path / "one.hdf5"
    write_fclib(problem, path, answer=answer, name="one")
    n = problem.size
    with h5py.File(path) as file:
        local, solution = file["fclib_local"], file["solution"]
        assert (local["spacedim"].shape, local["spacedim"][0]) == ((1,), 3)
        assert local["info/title"][()] == b"one"
        assert local["info/title"].dtype.itemsize == 4  # with the zero at which C stops
        W, V, R = (read_matrix(local[name]) for name in "WVR")
        q, mu, s = (local["vectors"][name][()] for name in ("q", "mu", "s"))
        u, r, multiplier = (solution[name][()] for name in "url")
    assert (W.shape, V.shape, R.shape) == ((3 * n, 3 * n), (3 * n, 1), (1, 1))
    assert (q.shape, mu.shape, s.shape) == ((3 * n,), (n,), (1,))
    assert not mu.any()
    np.testing.assert_allclose(V.T @ r + R @ multiplier + s, 0.0, atol=1e-12 * problem.torque)
    np.testing.assert_allclose(W @ r + V @ multiplier + q, u, rtol=0, atol=1e-13)
    assert np.linalg.eigvalsh(W.toarray()).min() > 0.0
    assert np.minimum(u, r).min() >= -1e-13
    assert multiplier[0] == answer.rotation
    _, stored = read_fclib(path)
    assert stored is not None
    assert stored.force.tolist() == answer.force.tolist()
    assert stored.elastic_rotation == answer.elastic_rotation


@pytest.mark.parametrize("kind", ["rows", "triplets", "two directions"])
def test_other_matrices_of_fclib_are_read(tmp_path: Path, kind: str) -> None:
    path, problem = tmp_path / "other.hdf5", springs()
    write_fclib(problem, path)
    with h5py.File(path, "r+") as file:
        local = file["fclib_local"]
        W = read_matrix(local["W"])
        keep = np.arange(9) % 3 < (2 if kind == "two directions" else 3)
        W = csc_array(W.toarray()[np.ix_(keep, keep)])
        del local["W"], local["spacedim"]
        group = local.create_group("W")
        local["spacedim"] = np.array([keep.sum() // 3])
        stored = csr_array(W) if kind == "rows" else W
        p, i, nz = stored.indptr, stored.indices, -2 if kind == "rows" else -1
        if kind == "triplets":
            p, i, nz = W.tocoo().coords[0], W.tocoo().coords[1], W.nnz
        for name, value in {"m": W.shape[0], "n": W.shape[1], "nz": nz, "nzmax": W.nnz}.items():
            group[name] = np.array([value])
        group["p"], group["i"] = p, i
        group["x"] = W.tocoo().data if kind == "triplets" else stored.data
        if kind == "two directions":
            V, q = read_matrix(local["V"]).toarray()[keep], local["vectors/q"][()][keep]
            del local["V"], local["vectors/q"]
            local["vectors/q"], matrix = q, local.create_group("V")
            column = csc_array(V)
            for name, value in {"m": V.shape[0], "n": 1, "nz": -1, "nzmax": column.nnz}.items():
                matrix[name] = np.array([value])
            matrix["p"], matrix["i"], matrix["x"] = column.indptr, column.indices, column.data
    assert read_fclib(path)[0].identical(problem)


@pytest.mark.usefixtures("reading_here")
@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("vectors/mu", np.full(3, 0.3), "mu = .* must be zero"),
        ("spacedim", np.array([4]), "spacedim = 4"),
        ("R/x", np.ones(1), "V, R, s: must be one equality"),
        ("W/p", np.full(10, 99), "W: must be a matrix"),
        ("W/m", np.array([7]), "W: must be a matrix|W = matrix"),
        ("vectors/s", None, "vectors/s is missing"),
    ],
)
def test_problems_of_fclib_that_are_not_ours_are_refused(tmp_path: Path, name: str, value: Any, words: str) -> None:
    path = tmp_path / "other.hdf5"
    write_fclib(springs(), path)
    with h5py.File(path, "r+") as file:
        del file["fclib_local"][name]
        if value is not None:
            file["fclib_local"][name] = value
    with pytest.raises(InputError, match=words):
        read_fclib(path)


@pytest.mark.parametrize("form", ["dense", "lifted"])
def test_qpsolvers_reads_and_solves_what_was_exported(tmp_path: Path, form: str) -> None:
    problem = bed()
    (path,) = export_problems([problem], tmp_path / "bed.npz", form=form)
    found = qpsolvers.solve_problem(qpsolvers.Problem.load(str(path)), "clarabel")
    scale, expected = problem.scaling, solve(problem)
    assert found.x is not None
    assert found.y is not None
    force, rotation = scale.unscale(found.x[:24], -found.y[0])
    np.testing.assert_allclose(force, expected.force, rtol=0, atol=1e-5 * expected.force.max())
    assert rotation == pytest.approx(expected.rotation, rel=1e-6)


def test_references_of_a_file_belong_to_its_problems(tmp_path: Path) -> None:
    path, problem = tmp_path / "problems.nc", springs()
    write_problems([problem], path)
    assert read_references(path, [problem]) is None
    with pytest.raises(InputError, match="answers = 0"):
        write_problems([problem], path, answers=[])
    with pytest.raises(InputError, match="must have the forces of 3 segments"):
        write_problems([problem], path, answers=[solve(bed()).answer])
    refused = solve(ContactProblem(np.zeros(2), np.ones(2), 1.0, [[1.0, 2.0], [2.0, 1.0]]))
    indefinite = ContactProblem(np.zeros(2), np.ones(2), 1.0, [[1.0, 2.0], [2.0, 1.0]])
    write_problems([problem, indefinite], path, answers=[solve(problem).answer, refused.answer])
    found = read_references(path, read_problems(path))
    assert found is not None
    exact = 1e-3 + 1e5 / float((problem.lever_arm**2 / problem.dense_compliance.diagonal()).sum())
    assert found[0].rotation == pytest.approx(exact, rel=1e-13)
    assert math.isnan(found[1].rotation)
    with netCDF4.Dataset(path) as file:
        assert file["reference_force"].units == "N"


def test_column_major_readers_see_the_dimensions_in_reverse(tmp_path: Path) -> None:
    """MATLAB and Julia keep the order in memory: there the last index of netCDF comes first."""
    path, problem = tmp_path / "problems.nc", bed()
    write_problems([problem, problem], path)
    with netCDF4.Dataset(path) as file:
        stored = np.asarray(file["compliance_factor"][:])
    seen = np.reshape(stored.ravel(order="C"), stored.shape[::-1], order="F")
    assert seen.shape == (3, 24, 2)
    assert isinstance(problem.compliance, tuple)
    assert np.array_equal(seen[:, :, 1].T, problem.compliance[1])


def test_exports_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    pair = [springs(), bed()]
    for output, format, form, words in (
        ("many.qps", None, None, "must be a folder, and the format qps be given"),
        ("many.txt", None, None, "must be a file whose name ends in .nc"),
        ("many.nc", "mat", None, "must be a file whose name ends in .mat, which holds all problems"),
        ("many.nc", None, "dense", "form = 'dense': must be left out"),
        ("many", "qps", "dual", "form = 'dual'"),
        ("many", "csv", None, "format = 'csv'"),
    ):
        with pytest.raises(InputError, match=words):
            export_problems(pair, tmp_path / output, format, form=form)
    with pytest.raises(InputError, match=r"problems = \[\]"):
        export_problems([], tmp_path / "none.nc")
    with pytest.raises(InputError, match="it has none"):
        import_problems(tmp_path)
    with pytest.raises(InputError, match="must be dense for a single dense matrix"):
        write_qps(springs(), tmp_path / "one.qps", form="lifted")
    assert list(tmp_path.iterdir()) == []


def test_writing_tells_the_number_of_problems_and_if_each_has_a_file(tmp_path: Path) -> None:
    one = ProblemSet([springs()])
    assert write_problem_set(one, tmp_path / "one.mat", None, None).endswith("one.mat: 1 contact problem")
    assert write_problem_set(one, tmp_path / "folder", "qps", None).endswith("folder: 1 contact problem, a file each")


@pytest.mark.parametrize("format", ["mat", "npz", "qps", "hdf5", "qpbenchmark"])
def test_command_converts_a_file_of_problems(tmp_path: Path, format: str) -> None:
    given, source = labelled_set(), tmp_path / "problems.nc"
    export_problems(given, source)
    target = tmp_path / ("problems.mat" if format == "mat" else "folder")
    assert "2 contact problems" in output_of("convert", source, "-o", target, "--format", format)
    if format == "qpbenchmark":
        assert sorted(path.name for path in (target / "data").iterdir()) == ["bed_of_x_y.npz", "springs.npz"]
        return
    read = import_problems(target)
    order = [0, 1] if format == "mat" else [1, 0]  # files in a folder are in the order of their names
    for i, problem in zip(order, read.problems, strict=True):
        if format == "npz":
            assert problem.identical(given.problems[i])
        assert solve(problem).elastic_rotation == pytest.approx(solve(given.problems[i]).elastic_rotation, rel=1e-13)
    output_of("convert", target, "-o", tmp_path / "back.nc")
    assert [p.identical(given.problems[i]) for i, p in zip(order, read_problems(tmp_path / "back.nc"), strict=True)]


def test_mistakes_of_the_command_are_told(tmp_path: Path) -> None:
    export_problems(labelled_set(), tmp_path / "problems.nc")
    for words, message in (
        (["problems.nc", "-o", "one.qps"], "must be a folder, and the format qps be given"),
        (["problems.nc", "-o", "one.toml"], "one.toml: must be a file whose name ends in .nc"),
        (["problems.nc", "-o", "folder", "--format", "hdf5", "--form", "dense"], "form = 'dense': must be left out"),
        (["problems.nc", "-o", "folder", "--format", "qpbenchmark", "--form", "dense"], "form = 'dense'"),
        (["nasa-12x36", "-o", "case.toml", "--format", "qps"], "must be that of contact problems"),
    ):
        given = [str(tmp_path / w) if i in (0, 2) and "nasa" not in w else w for i, w in enumerate(words)]
        said = refusal_of("convert", *given)
        assert message in " ".join(said.split()), said
    assert [path.name for path in tmp_path.iterdir()] == ["problems.nc"]


@pytest.mark.thorough
def test_qpbenchmark_runs_our_test_set_without_a_terminal(tmp_path: Path) -> None:
    """Its own reader and runner; the table gives the objective and rotation that they find."""
    pytest.importorskip("qpbenchmark")
    given = labelled_set()
    (script,) = write_test_set(given, tmp_path)
    listed = subprocess.run(
        [sys.executable, script, "list_problems"], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=True
    )
    assert listed.stdout.split()[-2:] == ["springs", "bed_of_x_y"]
    run = [sys.executable, str(script), "run", "--solver", "clarabel"]
    subprocess.run(run, stdin=subprocess.DEVNULL, capture_output=True, check=True, cwd=tmp_path)
    assert "@unknown" in (tmp_path / "contact_qpbenchmark.md").read_text()
    results = list(csv.DictReader((tmp_path / "results.csv").open(newline="")))
    accurate = [row for row in results if row["settings"] == "high_accuracy"]
    assert {row["problem"] for row in accurate} == {"springs", "bed_of_x_y"}
    assert all(row["found"] == "True" and float(row["duality_gap"]) < 1e-8 for row in accurate)


def test_table_of_a_test_set_gives_objective_and_rotation_of_the_programme(tmp_path: Path) -> None:
    given = labelled_set()
    write_test_set(given, tmp_path)
    rows = list(csv.DictReader((tmp_path / "problems.csv").open(newline="")))
    assert [(row["problem"], row["kind"], row["torque_level"]) for row in rows] == [
        ("springs", "a", "1"),
        ("bed_of_x_y", "", "2"),
    ]
    for row in rows:
        programme = qpsolvers.Problem.load(str(tmp_path / "data" / f"{row['problem']}.npz"))
        found = qpsolvers.solve_problem(programme, "clarabel", tol_gap_abs=1e-12, tol_gap_rel=1e-12, tol_feas=1e-12)
        assert found.y is not None
        assert -found.y[0] == pytest.approx(float(row["rotation"]), rel=1e-7)
        assert found.obj == pytest.approx(float(row["objective"]), rel=1e-7)
        assert np.count_nonzero(np.asarray(found.x) > 1e-4) == int(row["touching"])


def test_an_earlier_test_set_in_the_folder_is_replaced(tmp_path: Path) -> None:
    write_test_set(labelled_set(), tmp_path)
    write_test_set([springs()], tmp_path)
    assert [path.name for path in (tmp_path / "data").iterdir()] == ["contact_0000.npz"]


def test_file_that_was_cut_off_says_so(tmp_path: Path) -> None:
    path = tmp_path / "whole.qps"
    write_qps(ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6])), path)
    text = path.read_text(encoding="ascii")
    path.write_text(text[: text.index("ENDATA")], encoding="ascii")
    with pytest.raises(InputError, match="ends without ENDATA"):
        read_qps(path)
