"""Comparison of solvers: every failure is a row, nothing is measured twice, and the numbers agree with each other."""

from __future__ import annotations

import csv
import importlib
import importlib.metadata
import json
import math
import multiprocessing
import os
import re
import shutil
import subprocess
import sys
import types
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fake_solvers
import netCDF4
import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from places import DOCS
from runs import call, output_of, refusal_of
from solver_choice import BACKENDS, installed

from easeoff import InputError
from easeoff.contact import SOLVERS as SOLVER_TABLE, ContactProblem, read_problems, write_problems
from easeoff.contact.problem.certificate import EXACT_TOLERANCE
from easeoff.study import write_comparison
from easeoff.study.compare import compare, worker
from easeoff.study.compare.attempt import Method, Request, attempt, load_adapter
from easeoff.study.compare.comparison import CHECKPOINT
from easeoff.study.compare.comparison_table import RESIDUALS, read_table
from easeoff.study.compare.method_statistics import by_problem
from easeoff.study.compare.problem_export import write_test_set
from easeoff.study.plot.page import save
from easeoff.study.report import comparison_figures
from easeoff.study.report.comparison_figures import draw_growth, draw_performance_profile
from easeoff.study.report.comparison_report import comparison_report, write_report
from easeoff.study.report.written_comparison import FIGURE_NAMES, TABLE_NAMES
from easeoff.verification import problems

FAKES = ["lie", "stale", "fault", "hang", "fail", "deny"]
SOLVERS = ["native", *(f"fake_solvers:{name}" for name in FAKES)]
REPETITIONS = 2
LIMIT = 3600.0  # no solver of these tests is ended because the machine is busy
AFRESH = multiprocessing.get_context


class Hurried:
    """A connection whose time limit is over as soon as it is asked for an answer."""

    def __init__(self, connection: Any) -> None:
        self._connection = connection

    def poll(self, limit: float) -> bool:
        return limit == worker.START_TIME_LIMIT and self._connection.poll(limit)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._connection, name)


@pytest.fixture(scope="module", autouse=True)
def clock() -> Iterator[None]:
    """All solvers have as long as they need; only the one that would never end has no time at all."""
    honest = worker.Worker.launch

    def launch(self: worker.Worker) -> None:
        honest(self)
        if self.solver == "fake_solvers:hang":
            self._connection = Hurried(self._connection)  # type: ignore[assignment]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(worker, "START_TIME_LIMIT", 7200.0)
        patch.setattr(worker.Worker, "launch", launch)
        yield


@pytest.fixture(scope="module", autouse=True)
def forked() -> Iterator[None]:
    """Processes of the solvers come from one that has imported all they need; a test may start one ``AFRESH``.

    Files are read without a process.
    """
    server: Any = multiprocessing.get_context("forkserver")
    server.set_forkserver_preload(["pytest", "qpsolvers", worker.__name__])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(multiprocessing, "get_context", lambda _: server)
        yield


def left_empty(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.touch()
    return path


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures are made, but their files are left empty."""
    monkeypatch.setattr(comparison_figures, "save", lambda _, path: left_empty(path))


def same_size(count: int) -> list[ContactProblem]:
    """Realistic problems of one size: the later ones can start from the active set of the one before."""
    problem = next(problems("realistic", 1, seed=4))
    return [problem.with_torque(problem.torque * (1.0 + 0.2 * i)) for i in range(count)]


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("problems") / "two.nc"
    write_problems(same_size(2), path)
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("comparison")


@pytest.fixture(scope="module")
def dataset(file: Path, folder: Path) -> xr.Dataset:
    """A comparison of a solver with others that misbehave."""
    return compare([file], folder, solvers=SOLVERS, repetitions=REPETITIONS, time_limit=LIMIT)


@pytest.fixture(scope="module")
def lies(file: Path, tmp_path_factory: pytest.TempPathFactory) -> xr.Dataset:
    """A comparison of a solver that lies with an honest one, in all settings."""
    solvers = ["fake_solvers:lie", "osqp"]
    folder = tmp_path_factory.mktemp("lies")
    return compare(
        [file], folder, solvers=solvers, repetitions=1, time_limit=LIMIT, polish=True, raw=True, defaults=True
    )


@pytest.fixture(scope="module")
def written(dataset: xr.Dataset, folder: Path) -> list[Path]:
    """Files of the report; one figure alone is drawn in all formats, the others as PNG."""

    def saved(figure: Figure, path: Path) -> Path:
        return save(figure, path) if path.suffix == ".png" or path.stem == "data_profile" else left_empty(path)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(comparison_figures, "save", saved)
        return write_comparison(dataset, folder)


def rows(dataset: xr.Dataset, solver: str) -> Any:
    frame: Any = dataset.to_dataframe()
    return frame[frame["solver"] == solver]


def nobody(*_: Any) -> Any:
    raise AssertionError("measured again")


# Failures are rows


@pytest.mark.parametrize(
    ("name", "claim", "words"),
    [
        ("fault", "crashed", "ended with code -11"),
        ("hang", "time_limit", "ended from outside after 3601 s"),
        ("fail", "raised", "RuntimeError: no?[2J luck | today"),
    ],
)
def test_solver_that_fails_is_a_row_with_its_status(dataset: xr.Dataset, name: str, claim: str, words: str) -> None:
    found = rows(dataset, f"fake_solvers:{name}")
    assert set(found["problem"]) == {0, 1}  # the process was started again, and the study went on
    assert set(found["claim"]) == {claim}
    assert all(words in message for message in found["message"])
    assert not found["certified"].any()
    assert found["worst_residual"].isna().all()
    assert found["rotation_error"].isna().all()
    lasting = claim in ("crashed", "time_limit")
    assert len(found) == (2 if lasting else 2 * REPETITIONS)
    assert found["run_time"].isna().all() == lasting


def test_solver_that_lies_is_found_out(lies: xr.Dataset) -> None:
    found = rows(lies, "fake_solvers:lie")
    assert set(found["claim"]) == {"solved"}
    assert set(found["iterations"]) == {7}
    assert set(found["settings"]) == {"scaled", "polished", "raw", "default"}
    assert not found["certified"].any()
    assert not found["polished"].any()
    assert (found["equilibrium"] < 1e-12).all()  # its forces do balance the torque
    assert (found["worst_residual"] > 0.1).all()
    assert (found["rotation_error"] > 0.1).all()


def test_answer_of_the_wrong_length_is_an_error() -> None:
    for settings in ("scaled", "polished"):
        found = attempt(Request(same_size(1)[0], Method("nonsense", settings), LIMIT), fake_solvers.nonsense)
        assert found.claim == "raised"
        assert "Error" in found.message
    found = attempt(Request(same_size(1)[0], Method("nonsense", "raw"), LIMIT), fake_solvers.nonsense)
    assert found.claim == "solved"
    assert not found.certificate.passes(1.0)


@pytest.mark.parametrize("name", BACKENDS)
def test_every_solver_of_the_table_is_tried_as_it_is(name: str) -> None:
    adapter = load_adapter(installed(name))
    for settings in ("scaled", "polished"):
        found = attempt(Request(same_size(1)[0], Method(name, settings), LIMIT), adapter)
        assert found.certificate.passes(SOLVER_TABLE[name].tolerance)
        assert found.polished == (settings == "polished")
        assert found.exchanges == 0
    if not SOLVER_TABLE[name].package:  # others need a process of their own: raw units can bring one down
        assert attempt(Request(same_size(1)[0], Method(name, "raw"), LIMIT), adapter).certificate.passes(1e-9)


def test_solver_that_denies_its_right_answer_is_certified(dataset: xr.Dataset) -> None:
    found = rows(dataset, "fake_solvers:deny")
    assert set(found["claim"]) == {"infeasible"}
    assert found["certified"].all()
    assert (found["rotation_error"] < 1e-12).all()


def test_native_solver_is_certified_and_exact_cold_and_warm(dataset: xr.Dataset) -> None:
    native = rows(dataset, "native")
    assert native["certified"].all()
    assert not native["polished"].any()
    assert (native["worst_residual"] <= EXACT_TOLERANCE).all()
    assert (native["rotation_error"] < 1e-12).all()
    assert set(native["settings"]) == {"scaled"}
    assert (native["run_time"] > 0.0).all()
    assert sorted(native["start"]) == ["cold"] * 2 * REPETITIONS + ["warm"] * REPETITIONS
    warm = native[native["start"] == "warm"]
    assert set(warm["problem"]) == {1}
    assert (warm["iterations"] <= native[native["problem"] == 1]["iterations"].max()).all()


def test_without_polish_the_answer_is_the_backends_own(lies: xr.Dataset) -> None:
    found = rows(lies, "osqp")
    assert list(dict.fromkeys(found["settings"])) == ["scaled", "polished", "raw", "default"]
    by_settings = dict(list(found.groupby("settings")))
    assert by_settings["polished"]["polished"].all()
    assert not by_settings["scaled"]["polished"].any()
    assert not by_settings["raw"]["polished"].any()
    # Its own tolerances, met in units in which they mean little: the error is what the certificate says it is.
    assert (by_settings["raw"]["worst_residual"] > 1e3 * by_settings["scaled"]["worst_residual"].max()).all()
    assert (by_settings["raw"]["rotation_error"] > 1e3 * by_settings["polished"]["rotation_error"].max()).all()
    assert (by_settings["default"]["worst_residual"] > by_settings["scaled"]["worst_residual"].max()).all()
    assert (by_settings["default"]["worst_residual"] < 1e-2).all()
    assert all(set(by_settings[settings]["claim"]) == {"solved"} for settings in ("raw", "default"))


OWN_SOLVER = """
import qpsolvers


def by_daqp(problem, time_limit=10.0):
    answer = qpsolvers.solve_problem(problem, solver="daqp", time_limit=time_limit)
    if answer.x is None:
        raise RuntimeError("no answer")
    return answer.x, -answer.y[0]
"""


def test_process_that_ends_at_an_import_is_an_outcome_and_started_once(
    file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It would end the comparison, if that imported what it only looks up."""
    (tmp_path / "gone").mkdir()
    for name in ("__init__", "at_import"):
        (tmp_path / "gone" / f"{name}.py").write_text("import os\nos._exit(5)", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    started: list[str] = []
    launch = worker.Worker.launch

    def launched(one: worker.Worker) -> None:
        started.append(one.solver)
        launch(one)

    monkeypatch.setattr(worker.Worker, "launch", launched)
    table = compare([file], tmp_path / "out", solvers=["gone.at_import:solver"], repetitions=2, time_limit=LIMIT)
    assert started == ["gone.at_import:solver"]
    assert set(table["message"].values) == {"its process ended with code 5"}
    assert table.sizes["attempt"] == 2
    assert "file " in table.attrs["solver_versions"]


@pytest.mark.thorough
def test_process_that_imports_ends_with_the_comparison_however_that_does(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "alive")
    (tmp_path / "slow.py").write_text(
        "import time\nwith open('alive', 'w') as alive:\n    time.sleep(30.0)\n    alive.write('outlived')\n",
        encoding="utf-8",
    )
    (tmp_path / "killed.py").write_text(
        "from easeoff.study.compare.worker import Worker\n"
        "if __name__ == '__main__':\n    Worker('slow:solver').launch()\n    input()\n",
        encoding="utf-8",
    )
    with (
        subprocess.Popen([sys.executable, "killed.py"], cwd=tmp_path, stdin=subprocess.PIPE) as study,
        open(tmp_path / "alive", encoding="utf-8") as alive,  # once the module is being imported
    ):
        study.kill()
        assert alive.read() == ""


def test_function_of_a_module_is_a_solver(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "my_solver.py").write_text(OWN_SOLVER, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    adapter = load_adapter("my_solver:by_daqp")
    for settings in ("scaled", "polished", "raw"):
        found = attempt(Request(same_size(1)[0], Method("my_solver:by_daqp", settings), LIMIT), adapter)
        assert (found.claim, found.message) == ("solved", "")
        assert found.certificate.passes(1e-6)
        assert found.polished == (settings == "polished")


# Resuming


def test_second_call_measures_nothing(
    dataset: xr.Dataset, file: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(worker.Worker, "run", nobody)
    again = compare([file], folder, solvers=SOLVERS, repetitions=REPETITIONS, time_limit=LIMIT)
    assert again.identical(dataset)


def test_interrupted_comparison_goes_on_where_it_stopped(
    file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls: list[str] = []
    honest = worker.Worker.run

    def counted(self: worker.Worker, request: Request) -> Any:
        if len(calls) == 2:
            calls.append("interrupted")
            raise KeyboardInterrupt
        calls.append(self.solver)
        return honest(self, request)

    monkeypatch.setattr(worker.Worker, "run", counted)
    with pytest.raises(KeyboardInterrupt):
        compare([file], tmp_path, solvers=["native"], repetitions=1)
    with (tmp_path / CHECKPOINT).open("a") as file_of_measurements:
        file_of_measurements.write('\n{"key": "abc", "attem')  # what a full disk or a power cut may leave
    whole = compare([file], tmp_path, solvers=["native"], repetitions=1)
    assert calls == ["native", "native", "interrupted", "native"]
    assert whole["certified"].values.tolist() == [1, 1, 1]
    monkeypatch.setattr(worker.Worker, "launch", nobody)
    assert compare([file], tmp_path, solvers=["native"], repetitions=1).identical(whole)
    with pytest.raises(AssertionError, match="measured again"):
        compare([file], tmp_path, solvers=["native"], repetitions=1, time_limit=9.0)
    with pytest.raises(AssertionError, match="measured again"):
        compare([file], tmp_path, solvers=["native"], repetitions=1, fresh=True)


@pytest.mark.parametrize("changed", ["scipy", "BLAS", "kernels", "processor", "threads"])
def test_measurements_of_another_machine_are_stale(
    changed: str, dataset: xr.Dataset, file: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    honest: Any = importlib.metadata.version

    def version(package: str) -> str:
        return str(honest(package)) + (".1" if package == changed else "")

    monkeypatch.setattr(importlib.metadata, "version", version)
    if changed == "BLAS":
        library = {"Build Dependencies": {"blas": {"name": "another", "version": "1"}}}
        monkeypatch.setattr(np, "show_config", lambda mode: library)
    if changed == "kernels":
        monkeypatch.setenv("OPENBLAS_CORETYPE", "Haswell" if "OPENBLAS_CORETYPE" not in os.environ else "Zen")
    if changed == "processor":
        monkeypatch.setattr(worker, "processor", lambda: "another")
    monkeypatch.setattr(worker.Worker, "launch", nobody)
    with pytest.raises(AssertionError, match="measured again"):
        compare(
            [file], folder, solvers=["native"], repetitions=REPETITIONS, time_limit=LIMIT,
            threads=2 if changed == "threads" else 1,
        )  # fmt: skip


def test_change_of_the_code_makes_measurements_stale(monkeypatch: pytest.MonkeyPatch) -> None:
    before = worker.machine()
    assert worker.machine() == before
    source = Path(worker.__file__).read_bytes()
    honest = Path.read_bytes

    def read(self: Path) -> bytes:
        return source + b"#" if self.name == "newton_kernel.py" else honest(self)

    monkeypatch.setattr(Path, "read_bytes", read)
    assert {name for name, value in worker.machine().items() if value != before[name]} == {"code of easeoff"}


def test_other_data_are_measured_anew(file: Path, folder: Path, dataset: xr.Dataset, tmp_path: Path) -> None:
    other = tmp_path / "two.nc"
    changed = [p.with_torque(math.nextafter(p.torque, math.inf)) for p in read_problems(file)]
    write_problems(changed, other)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(worker.Worker, "launch", nobody)
        with pytest.raises(AssertionError, match="measured again"):
            compare([other], folder, solvers=["native"], repetitions=REPETITIONS, time_limit=LIMIT)


def test_files_of_the_same_name_are_told_apart(
    file: Path, folder: Path, dataset: xr.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = tmp_path / file.name
    other.write_bytes(file.read_bytes())
    monkeypatch.setattr(worker.Worker, "launch", nobody)  # the same problems: known by their content
    both = compare([file, other, file], folder, solvers=["native"], repetitions=REPETITIONS, time_limit=LIMIT)
    assert set(both["problem_file"].values) == {str(file), str(other)}
    assert len(by_problem(both)) == 2 * 3


# Table


def test_numbers_of_the_table_agree_with_each_other(dataset: xr.Dataset) -> None:
    frame: Any = dataset.to_dataframe()
    tolerance = dataset.attrs["tolerance"]
    worst = frame[list(RESIDUALS)].max(axis=1, skipna=False)
    assert np.array_equal(worst, frame["worst_residual"], equal_nan=True)
    assert np.array_equal(frame["certified"] == 1, frame["worst_residual"] <= tolerance)
    assert (frame["worst_residual"][frame["polished"] == 1] <= EXACT_TOLERANCE).all()
    posed = same_size(2)
    assert all(size == posed[i].size for i, size in zip(frame["problem"], frame["size"], strict=True))
    torques = [posed[i].torque * 1e-3 for i in frame["problem"]]
    np.testing.assert_allclose(frame["gear_torque"], torques, rtol=1e-15)


def test_csv_and_netcdf_agree(dataset: xr.Dataset, written: list[Path], folder: Path) -> None:
    stored = read_table(folder / "results.nc")
    xr.testing.assert_identical(stored.drop_attrs(), dataset.drop_attrs())
    with (folder / "results.csv").open(newline="", encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    assert list(lines[0]) == list(dataset.data_vars)
    for name, variable in stored.data_vars.items():
        texts = [line[str(name)] for line in lines]
        if variable.dtype.kind == "f":
            numbers = np.array([float(text) if text else math.nan for text in texts])
            np.testing.assert_array_equal(numbers, variable.values)
        else:
            assert texts == [str(value) for value in variable.values], name


def test_every_variable_says_its_unit_and_meaning(written: list[Path], folder: Path) -> None:
    with netCDF4.Dataset(folder / "results.nc") as file:
        for name, variable in file.variables.items():
            assert variable.long_name, name
            assert variable.dtype is str or variable.units, name


def test_columns_of_the_page_are_those_of_the_table(dataset: xr.Dataset) -> None:
    page = (DOCS / "researcher" / "compare.md").read_text(encoding="utf-8")
    listed = page.split("## The table\n")[1].split("\n\n")[1]
    assert set(re.findall(r"`(\w+)`", listed)) == {str(name) for name in dataset.data_vars}


# Report and pictures


def cells(text: str, heading: str) -> dict[tuple[str, ...], dict[str, str]]:
    """Rows of the tables with the first head behind a heading, by solver, settings and start."""
    section = text.split(f"## {heading}\n", 1)[1].split("\n## ")[0]
    lines = [line for line in section.splitlines() if line.startswith("|")]
    split = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    width = len(split[0])
    found = [row for row in split if len(row) == width and row[0] != "solver" and set(row[0]) != {"-"}]
    return {tuple(row[:3]): dict(zip(split[0], row, strict=True)) for row in found}


def counts(line: dict[str, str]) -> tuple[int, ...]:
    names = ("problems", "says solved", "certified", "exact", "polished", "says solved, not certified", "denied")
    return tuple(int(line[name]) for name in names)


def test_report_counts_claims_against_certificates(dataset: xr.Dataset, written: list[Path], folder: Path) -> None:
    text = (folder / "report.md").read_text(encoding="utf-8")
    success = cells(text, "Answers")

    def row(solver: str, start: str = "cold") -> tuple[int, ...]:
        return counts(success[(solver, "scaled", start)])

    assert row("native") == (2, 2, 2, 2, 0, 0, 0)
    assert row("native", "warm") == (1, 1, 1, 1, 0, 0, 0)
    assert row("fake_solvers:deny") == (2, 0, 2, 2, 0, 0, 2)
    for name in ("fault", "hang", "fail"):
        assert row(f"fake_solvers:{name}") == (2, 0, 0, 0, 0, 0, 0)
    for name in ("lie", "stale"):
        assert row(f"fake_solvers:{name}") == (2, 2, 0, 0, 0, 2, 0)


def test_who_is_wrong_is_last_in_every_table(written: list[Path], folder: Path) -> None:
    """Who has no answer is before who has a wrong one, called solved."""
    tables = [path for path in written if path.parent.name == "tables" and path.suffix == ".csv"]
    assert {"answers_scaled.csv", "run_time.csv", "time_parts.csv", "residuals.csv"} <= {path.name for path in tables}
    for path in tables:
        with path.open(newline="", encoding="utf-8") as file:
            head, *lines = csv.reader(file)
        if path.stem == "failures" or head[:3] != ["solver", "settings", "start"]:
            continue
        cold = [line[0].removeprefix("fake_solvers:") for line in lines if line[2] == "cold"]
        assert set(cold[:2]) == {"native", "deny"}, path.name
        assert set(cold[2:5]) == {"fault", "hang", "fail"}, path.name
        assert set(cold[5:]) == {"lie", "stale"}, path.name


def test_report_counts_what_is_not_certified_and_does_not_time_it(lies: xr.Dataset) -> None:
    text = comparison_report(lies)
    success, times = cells(text, "Answers"), cells(text, "Run time")
    for settings in ("scaled", "polished", "raw", "default"):
        method = ("fake_solvers:lie", settings, "cold")
        assert counts(success[method]) == (2, 2, 0, 0, 0, 2, 0)
        assert float(times[method]["mean [ms]"]) == pytest.approx(1e3 * LIMIT)  # a wrong answer counts as none
        assert times[method]["median [ms]"] == "-"


def test_backend_gets_the_form_that_solve_gives_it() -> None:
    seen: list[str] = []

    def adapter(_: Any, keywords: Any) -> Any:
        seen.append(keywords.get("form", "dense"))
        raise RuntimeError

    size = SOLVER_TABLE["piqp"].lifted_from
    assert size is not None
    rng = np.random.default_rng(1)
    pair = (np.full(size, 1e-6), 1e-3 * rng.standard_normal((size, 4)))
    large = ContactProblem(1e-3 * rng.standard_normal(size) ** 2, np.full(size, 40.0), 1e5, pair)
    for problem in (large, same_size(1)[0]):
        for settings in ("scaled", "polished", "raw", "default"):
            attempt(Request(problem, Method("piqp", settings), LIMIT), adapter)
    attempt(Request(large, Method("my_solver:solve_scaled", "scaled"), LIMIT), adapter)
    assert seen == ["lifted", "lifted", "dense", "lifted", *["dense"] * 5]


def test_names_and_kinds_of_a_file_come_into_table_and_report(tmp_path: Path) -> None:
    labels = {"name": ["first", "second", "third"], "kind": ["easy", "hard", "hard"]}
    write_problems(same_size(3), tmp_path / "kinds.nc", labels)
    solvers = ["native", "lemke"]
    table = compare([tmp_path / "kinds.nc"], tmp_path, solvers=solvers, repetitions=1, time_limit=LIMIT, raw=True)
    for solver in solvers:
        found = rows(table, solver)
        for label, column in (("name", "problem_name"), ("kind", "kind")):
            assert found[column].tolist() == [labels[label][number] for number in found["problem"]]
    # Lemke's method needs no package of its own, and no settings.
    assert rows(table, "lemke")["certified"].all()
    assert set(rows(table, "lemke")["settings"]) == {"scaled", "raw"}
    text = comparison_report(table)
    by_kind = cells(text.replace("Certified, by kind of problem:", "## kinds\n"), "kinds")
    wanted = {"easy": "1 of 1", "hard": "2 of 2"}
    assert {kind: by_kind[("lemke", "raw", "cold")][kind] for kind in wanted} == wanted
    assert {kind: by_kind[("native", "scaled", "warm")][kind] for kind in ("hard",)} == {"hard": "2 of 2"}


def test_report_says_which_problems_failed(dataset: xr.Dataset, written: list[Path], folder: Path) -> None:
    failures = cells((folder / "report.md").read_text(encoding="utf-8"), "Failures")
    assert failures[("fake_solvers:hang", "scaled", "cold")]["which"] == "two.nc 0, two.nc 1"
    named = dataset.assign(problem_name=dataset["problem"].astype(str).astype(object) + " of many")
    failures = cells(comparison_report(named), "Failures")
    assert failures[("fake_solvers:hang", "scaled", "cold")]["which"] == "0 of many, 1 of many"


def test_files_name_all_problems_that_failed_and_the_report_the_first(dataset: xr.Dataset, tmp_path: Path) -> None:
    many = xr.concat([dataset.assign(problem=dataset["problem"] + 2 * i) for i in range(3)], "attempt")
    many.attrs = dataset.attrs
    report, *_ = write_report(many, tmp_path)
    failures = cells(report.read_text(encoding="utf-8"), "Failures")[("fake_solvers:hang", "scaled", "cold")]
    assert failures["which"] == "two.nc 0, two.nc 1, two.nc 2, ..."
    with (tmp_path / "tables" / "failures.csv").open(newline="", encoding="utf-8") as file:
        found = {row["solver"]: row["which"] for row in csv.DictReader(file)}
    names = ", ".join(f"two.nc {number}" for number in range(6))
    assert found["fake_solvers:hang"] == names
    assert names in (tmp_path / "tables" / "failures.tex").read_text(encoding="utf-8").replace("\\_", "_")


def test_problems_without_a_kind_have_a_column(dataset: xr.Dataset) -> None:
    some = dataset.assign(kind=("attempt", np.where(dataset["problem"].values == 0, "easy", "").astype(object)))
    by_kind = cells(comparison_report(some).replace("Certified, by kind of problem:", "## kinds\n"), "kinds")
    native = by_kind[("native", "scaled", "cold")]
    assert (native["easy"], native["without a kind"]) == ("1 of 1", "1 of 1")


@pytest.mark.usefixtures("undrawn")
def test_a_report_takes_nothing_over_from_another_in_its_folder(
    file: Path, tmp_path: Path, written: list[Path], folder: Path
) -> None:
    tables = {path.stem for path in written if path.parent.name == "tables"}
    figures = {path.stem for path in written if path.parent.name == "figures"}
    assert tables <= set(TABLE_NAMES)
    assert figures <= set(FIGURE_NAMES)
    out = tmp_path / "used"
    shutil.copytree(folder, out)
    for name in ("own.csv", "certified_by_kind.csv"):
        (out / "tables" / name).write_text("a,b", encoding="utf-8")
    arguments = ["compare", file, "-o", out, "--solvers", "native", "--repetitions", "1"]
    said = call(*arguments)
    assert said.output.count(f"replaced the report of a former comparison in {out}") == 1
    left = {path.name for path in (out / "tables").iterdir()}
    assert {"own.csv", "answers_scaled.csv", "starts.tex"} <= left
    assert not {"failures.csv", "failures.tex", "pairs.csv", "certified_by_kind.csv"} & left
    assert not (out / "figures" / "pairs.png").exists()
    again = call(*arguments)
    assert "replaced" not in again.output
    assert {path.name for path in (out / "tables").iterdir()} == left


def test_without_kinds_the_report_has_no_table_of_kinds(lies: xr.Dataset) -> None:
    assert set(lies["kind"].values) == {""}
    assert "by kind" not in comparison_report(lies)


def test_report_says_what_it_was_made_with_and_how_means_were_taken(written: list[Path], folder: Path) -> None:
    text = (folder / "report.md").read_text(encoding="utf-8")
    made_with = json.loads(read_table(folder / "results.nc").attrs["machine"])
    assert {"processor", "Python", "numpy", "easeoff"} <= set(made_with)
    for words in (
        *made_with.values(),
        "solver `fake_solvers:hang`",
        "shift 1 ms",
        f"time limit, {1e3 * LIMIT:g} ms",
        "1e-05",
        "![Performance profile](figures/performance_profile.png)",
        "![Data profile](figures/data_profile.png)",
        "ended with code -11",
        "no?[2J luck / today",
    ):
        assert words in text


def test_report_of_failures_that_are_none(dataset: xr.Dataset) -> None:
    decent = dataset.isel(attempt=np.isin(dataset["solver"].values, ["native"]))
    assert "every attempt is certified" in comparison_report(decent)


def test_profile_counts_the_problems_of_files_of_different_length(dataset: xr.Dataset) -> None:
    """Three problems in one file and one in another are four, not six."""
    native = dataset.isel(attempt=(dataset["solver"].values == "native") & (dataset["start"].values == "cold"))
    one = native.isel(attempt=native["problem"].values == 0)
    more = native.assign(problem_file=native["problem_file"].copy(data=np.full(native.sizes["attempt"], "other.nc")))
    both = xr.concat([one, more], "attempt")
    (axes,) = draw_performance_profile(both, by_problem(both)).axes
    count = len(np.unique(native["problem"].values))
    assert count > 1
    assert axes.get_title("right") == f"{count + 1} problems"


def test_pictures_show_the_numbers(dataset: xr.Dataset, written: list[Path]) -> None:
    figures = {path.name for path in written if path.parent.name == "figures"}
    names = ("performance_profile", "data_profile", "pairs")  # of two sizes no growth is drawn
    assert figures == {f"{name}.{suffix}" for name in names for suffix in ("png", "pdf", "svg")}
    drawn = [path for path in written if path.suffix == ".png" or path.stem == "data_profile"]
    assert len(drawn) == 3 + 2
    assert all(path.stat().st_size > 1000 for path in drawn)
    problems_of_all = by_problem(dataset)
    (axes,) = draw_performance_profile(dataset, problems_of_all).axes
    heights = {str(line.get_label()): float(np.asarray(line.get_ydata())[-1]) for line in axes.lines}
    assert heights == {name: float(name in ("native", "fake_solvers:deny")) for name in SOLVERS}
    by_size = [dataset.assign(size=dataset["size"] * factor) for factor in (1, 2, 3, 4)]
    sizes = [factor * int(dataset["size"][0]) for factor in (1, 2, 3, 4)]
    more = xr.concat([one.assign(problem=one["problem"] + 2 * number) for number, one in enumerate(by_size)], "attempt")
    (axes,) = draw_growth(more, by_problem(more)).axes
    assert list(axes.get_xticks()) == sizes
    assert [label.get_text() for label in axes.get_xticklabels()] == [f"{size:g}" for size in sizes]
    assert not any(label.get_text() for label in axes.get_yticklabels(minor=True))
    legend = axes.get_legend()
    assert legend is not None
    assert any(text.get_text().startswith("native  n^") for text in legend.get_texts())
    assert "fake_solvers:hang  none certified" in {text.get_text() for text in legend.get_texts()}


# Command line


@pytest.mark.usefixtures("undrawn")
def test_command_writes_everything_and_is_not_upset_by_failures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(multiprocessing, "get_context", AFRESH)
    file, out = tmp_path / "one.nc", tmp_path / "new" / "out"
    write_problems(same_size(1), file)
    said = output_of("compare", file, "-o", out, "--solvers", "fake_solvers:leave", "--repetitions", "1", "--test-set")
    names = ["report.md", "results.nc", "results.csv"]
    assert set(read_table(out / "results.nc")["message"].values) == {"its process ended with code 3"}
    folders = [f"{out / name}: {len(list((out / name).iterdir()))} files" for name in ("tables", "figures")]
    expected = [*(str(out / name) for name in names), *folders, str(out / "test_set" / "contact_qpbenchmark.py")]
    assert said.startswith("".join(f"wrote {path}\n" for path in expected))
    assert sorted(p.name for p in out.iterdir()) == sorted([*names, CHECKPOINT, "tables", "figures", "test_set"])


@pytest.fixture(scope="module")
def wrong(file: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of files that hold no problems, or one that no answer can be proved of."""
    folder = tmp_path_factory.mktemp("wrong")
    (folder / "text.nc").write_text("no problems")
    xr.load_dataset(file, engine="netcdf4").isel(problem=slice(0)).to_netcdf(folder / "empty.nc", engine="netcdf4")
    indefinite = np.array([[1e-6, 2e-6], [2e-6, 1e-6]])
    write_problems([ContactProblem(np.zeros(2), np.full(2, 40.0), 10.0, indefinite)], folder / "indefinite.nc")
    return folder


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["{file}", "--solvers", "magic"], ["magic", "native", "clarabel"]),
        (["{file}", "--solvers", ","], ["solvers = []", "native"]),
        (["{file}", "--solvers", "nowhere_at_all:solve"], ["nowhere_at_all", "no module"]),
        (["{file}", "--solvers", "fake_solvers:sleep"], ["fake_solvers:sleep", "cannot be loaded", "sleep"]),
        (["{file}", "--solvers", "fake_solvers:"], ["fake_solvers:"]),
        (["{file}", "--repetitions", "0"], ["repetitions = 0", "1"]),
        (["{file}", "--time-limit", "-1"], ["time_limit = -1"]),
        (["{file}", "--time-limit", "nan"], ["time_limit = nan"]),
        (["{file}", "--tolerance", "2"], ["tolerance = 2"]),
        (["{file}", "--tolerances", "1e-3,2"], ["tolerances = 2"]),
        (["{file}", "--tolerances", "1e-3,0.001"], ["tolerances = 0.001", "twice"]),
        (["{file}", "--tolerances", "fine"], ["fine", "1e-3,1e-6,1e-9"]),
        (["{file}", "--threads", "0"], ["threads = 0"]),
        (["{wrong}/none.nc"], ["none.nc", "no such file"]),
        (["{wrong}/text.nc"], ["text.nc", "not a netCDF file"]),
        (["{wrong}/empty.nc"], ["empty.nc", "must hold one problem of one segment, or more"]),
        (["{wrong}/indefinite.nc"], ["indefinite.nc", "problem 0", "negative eigenvalue"]),
        (["{file}", "-o", "{file}"], ["two.nc", "is a file"]),
        (["{file}", "-o", "/proc/nothing"], ["/proc/nothing", "cannot be written"]),
        ([], ["PROBLEMS"]),
    ],
)
def test_mistakes_give_one_message_and_exit_code_2(
    arguments: list[str], words: list[str], file: Path, wrong: Path, tmp_path: Path
) -> None:
    given = [argument.format(file=file, wrong=wrong) for argument in arguments]
    if "-o" not in given:
        given += ["-o", str(tmp_path / "out")]
    said = refusal_of("compare", *given)
    assert all(word in said for word in words), said
    assert "Traceback" not in said


def test_missing_solver_is_told_how_to_install_it(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import importlib.util

    real = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name == "highspy" else real(name))
    said = refusal_of("compare", file, "--solvers", "highs", "-o", tmp_path)
    assert "easeoff[solvers] installs it" in said
    assert " install " in said


def test_table_from_elsewhere_is_refused(file: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_table(tmp_path / "none.nc")
    with pytest.raises(InputError, match="easeoff compare"):
        read_table(file)


# Test set


def test_test_set_holds_the_scaled_problems(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Read through the interface of qpbenchmark: a class named after the file, problems that have a name."""
    import qpsolvers

    def load(path: str) -> Any:
        problem = qpsolvers.Problem.load(path)
        problem.name = Path(path).stem
        return problem

    interface: Any = types.ModuleType("qpbenchmark")
    interface.TestSet = type("TestSet", (), {"__init__": lambda self: self.define_tolerances()})
    interface.Problem = types.SimpleNamespace(load=load)
    interface.Tolerance = lambda primal, dual, gap, runtime: (primal, dual, gap, runtime)
    program: Any = types.ModuleType("qpbenchmark.benchmark")
    program.main = None
    monkeypatch.setitem(sys.modules, "qpbenchmark", interface)
    monkeypatch.setitem(sys.modules, "qpbenchmark.benchmark", program)
    monkeypatch.syspath_prepend(tmp_path)

    write_test_set([*read_problems(file)] * 2, tmp_path)
    (script,) = write_test_set(read_problems(file), tmp_path, time_limit=5.0)
    assert sorted(p.name for p in (tmp_path / "data").iterdir()) == ["contact_0000.npz", "contact_0001.npz"]
    name = script.stem
    test_set = getattr(importlib.import_module(name), name.title().replace("_", ""))()
    assert test_set.tolerances["high_accuracy"] == (1e-9, 1e-9, 1e-9, 5.0)
    found = list(test_set)
    assert [problem.name for problem in found] == ["contact_0000", "contact_0001"]
    for problem, original in zip(found, read_problems(file), strict=True):
        scaled = original.as_qp()
        assert problem.G is None
        assert problem.ub is None
        for part in ("P", "q", "A", "b", "lb"):
            np.testing.assert_array_equal(getattr(problem, part), getattr(scaled, part))
    with pytest.raises(InputError, match="must hold at least one contact problem"):
        write_test_set([], tmp_path)


def test_folder_of_problems_is_refused_with_what_makes_a_file_of_it(tmp_path: Path) -> None:
    (tmp_path / "qps").mkdir()
    said = refusal_of("compare", tmp_path / "qps", "-o", tmp_path / "out")
    assert f"easeoff convert {tmp_path / 'qps'} -o problems.nc" in " ".join(said.split())
    assert not (tmp_path / "out").exists()
