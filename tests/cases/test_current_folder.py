"""No code from the current folder runs unless it is asked for, and no configuration there changes what is drawn."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from runs import text_file

import easeoff
from easeoff.contact import ContactProblem, write_problems
from easeoff.core.process_settings import child_environment, children_without_interrupts

#: Modules that a command may look for: of Python, of what the package needs, and solvers that are not installed.
LIBRARIES = (
    "click", "clarabel", "coptpy", "cvxopt", "cvxpy", "cupy", "dask", "daqp", "easeoff", "ecos", "gurobipy", "highspy",
    "jax", "jaxopt", "matplotlib", "mosek", "mpi4py", "netCDF4", "nppro", "numba", "numpy", "osqp", "pandas", "piqp",
    "proxsuite", "pydantic", "pyqpmad", "qpalm", "qpax", "qpsolvers", "quadprog", "scipy", "scs", "sip_qp_python",
    "sitecustomize", "tabulate", "tqdm", "usercustomize", "xarray",
)  # fmt: skip
MARK = "executed.txt"
PLANTED = f"with open({MARK!r}, 'a') as mark: mark.write(__name__ + ' ')\nraise ImportError(__name__)\n"
#: What the entry point of the installed package does; started from a folder of its own, as that is.
ENTRY_POINT = """
import sys
from easeoff.study.cli import main
if __name__ == "__main__":
    sys.exit(main())
"""
TEX = "text.usetex: True\nfont.size: 30\nbackend: module://evil_backend\n"


@pytest.fixture
def trap(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which every module is waiting, and that is the current one."""
    folder = tmp_path / "trap"
    folder.mkdir()
    for name in {*sys.stdlib_module_names, *LIBRARIES, "evil_backend"}:
        (folder / f"{name}.py").write_text(PLANTED, encoding="utf-8")
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "easeoff").write_text(ENTRY_POINT, encoding="utf-8")
    problem = ContactProblem(np.array([0.0, 1e-3]), np.full(2, 50.0), 1e4, ([1e-5, 1e-5], [[1e-3], [2e-3]]))
    write_problems([problem], folder / "problems.nc")
    monkeypatch.chdir(folder)
    return folder


def command(trap: Path, *words: str) -> str:
    """Output of a command in the trap."""
    call = [sys.executable, str(trap.parent / "bin" / "easeoff"), *words]
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONSAFEPATH"}
    done = subprocess.run(call, capture_output=True, text=True, check=False, cwd=trap, env=environment)
    assert done.returncode == 0, done.stderr
    return done.stdout


def compared(trap: Path, solvers: str) -> None:
    """Compare solvers in the trap; each has to solve the problem."""
    command(trap, "compare", "problems.nc", "--solvers", solvers, "--repetitions", "1", "-o", "study")
    rows = (trap / "study" / "results.csv").read_text(encoding="utf-8").splitlines()[1:]
    assert {row.split(",")[6] for row in rows} == set(solvers.split(","))
    assert all(",solved," in row for row in rows)


def executed(trap: Path) -> str:
    mark = trap / MARK
    return mark.read_text(encoding="utf-8") if mark.exists() else ""


def test_the_trap_catches(trap: Path) -> None:
    """Started as ``python -c``, Python looks into the current folder first; 3.13 even before the code."""
    subprocess.run([sys.executable, "-c", "import quadprog"], capture_output=True, check=False, cwd=trap)
    assert {"quadprog", "linecache"} & set(executed(trap).split())


def test_a_process_of_a_solver_starts_without_the_current_folder(trap: Path) -> None:
    """Python itself would import its modules from there."""
    with child_environment():
        subprocess.run([sys.executable, "-c", "import multiprocessing, quadprog"], capture_output=True, check=False)
    assert executed(trap) == ""
    assert "PYTHONSAFEPATH" not in os.environ


def test_processes_may_be_started_to_ignore_an_interrupt() -> None:
    before = signal.getsignal(signal.SIGINT)
    with children_without_interrupts():
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.thorough
def test_a_comparison_runs_nothing_of_the_current_folder(trap: Path) -> None:
    compared(trap, "native,clarabel")
    assert executed(trap) == ""


@pytest.mark.thorough
def test_libraries_that_look_for_further_solvers_find_none_in_the_current_folder(trap: Path) -> None:
    compared(trap, "cvxpy,osqp")
    assert executed(trap) == ""


@pytest.mark.thorough
def test_a_solver_of_ones_own_is_run_and_brings_no_other_module(trap: Path) -> None:
    """It is in the current folder, where the names of solvers that are not installed wait beside it."""
    own = "import qpsolvers\ndef mine(problem):\n    return qpsolvers.solve_problem(problem, 'clarabel')\n"
    (trap / "my_solver.py").write_text(own, encoding="utf-8")
    compared(trap, "my_solver:mine")
    assert executed(trap) == ""


@pytest.mark.thorough
def test_an_analysis_runs_nothing_of_the_current_folder(trap: Path) -> None:
    command(trap, "run", "nasa-12x36", "--torque", "100", "-o", "result.nc", "--plots", "pictures")
    command(trap, "show", "result.nc")
    command(trap, "export", "nasa-12x36", "-o", "tooth.stl")
    command(trap, "cases")
    assert executed(trap) == ""


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("result") / "result.nc"
    easeoff.write_result(easeoff.analyze("nasa-12x36", torques=[100.0]), path)
    return path


def drawn(trap: Path, result: Path) -> dict[str, bytes]:
    command(trap, "plot", str(result), "pictures")
    return {path.name: path.read_bytes() for path in (trap / "pictures").iterdir()}


@pytest.mark.thorough
def test_a_configuration_in_the_current_folder_changes_no_picture(trap: Path, result: Path) -> None:
    """Neither does one that is no text, or a pipe that nobody writes to."""
    plain = drawn(trap, result)
    configuration = text_file(trap / "matplotlibrc", TEX)
    assert drawn(trap, result) == plain
    configuration.write_bytes(b"\xff\xfe\x00")
    assert drawn(trap, result) == plain
    configuration.unlink()
    os.mkfifo(configuration)
    assert drawn(trap, result) == plain
    assert executed(trap) == ""


@pytest.mark.thorough
def test_the_settings_of_the_caller_change_no_picture_and_stay(tmp_path: Path, result: Path) -> None:
    import matplotlib

    tree = easeoff.read_result(result)
    first = easeoff.study.write_pictures(tree, tmp_path / "first")
    with matplotlib.rc_context({"font.size": 30.0, "axes.grid": True, "text.color": "white"}):
        second = easeoff.study.write_pictures(tree, tmp_path / "second")
        assert matplotlib.rcParams["font.size"] == 30.0
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]


@pytest.mark.thorough
def test_drawing_chooses_no_window_system(result: Path) -> None:
    """Without ``pyplot`` no backend is loaded, whatever one the configuration names."""
    code = (
        "import sys, tempfile, easeoff; from easeoff.study import write_pictures\n"
        f"write_pictures(easeoff.read_result({str(result)!r}), tempfile.mkdtemp())\n"
        "assert 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
