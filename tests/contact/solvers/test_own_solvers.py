"""Solvers of one's own: by a function, by module:function and by an entry point; good ones and those that are none."""

from __future__ import annotations

import contextlib
import gc
import importlib
import json
import os
import signal
import sys
import threading
import time
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import qpsolvers
from click.testing import CliRunner
from runs import SHELLS, output_of, refusal_of, small, small_file, text_file
from scipy.sparse.linalg import aslinearoperator
from shared_problems import three_segments

from easeoff import InputError, MissingSolverError, analyze, read_result
from easeoff.contact import (
    ContactProblem,
    OperatorCompliance,
    Solver,
    Status,
    available_solvers,
    lcp,
    solve,
    write_problems,
)
from easeoff.contact.line_contact.line_contact_solution import solve_on_bending
from easeoff.contact.problem.complementary_pivoting import lemke
from easeoff.contact.solvers import backend_solution as backend_solution_module, solver_declaration
from easeoff.contact.solvers.backend_solution import backend_solution
from easeoff.contact.solvers.registry import chosen_solver, require_solver
from easeoff.contact.solvers.solution import ScaledAnswer
from easeoff.contact.solvers.solver_table import SOLVERS
from easeoff.core import foreign_code as foreign_code_module
from easeoff.core.foreign_code import ForeignCodeError, foreign_code
from easeoff.study import cli as study_cli
from easeoff.study.cli import analysis_commands, main
from easeoff.study.summary.result_summary import result_summary
from easeoff.verification import problems

PROBLEM = next(iter(problems("realistic", 1)))
DENSE = ContactProblem(PROBLEM.separation, PROBLEM.lever_arm, PROBLEM.torque, PROBLEM.dense_compliance)
REFERENCE = solve(PROBLEM)


def by_daqp(problem: Any, **settings: Any) -> Any:
    return qpsolvers.solve_problem(problem, "daqp", primal_tol=1e-11, dual_tol=1e-12, **settings)


def by_osqp(problem: Any, **settings: Any) -> Any:
    return qpsolvers.solve_problem(problem, "osqp", eps_abs=1e-10, eps_rel=1e-10, polishing=True, **settings)


def by_lemke(problem: Any) -> Any:
    return lemke(problem.matrix, problem.vector).z


def by_products(problem: Any, max_iterations: int = 50_000, initvals: Any = None) -> Any:
    """Projected gradients with momentum for the shares of the torque: products with P alone."""
    P, q, row, torque = problem.P, problem.q, problem.A[0], float(problem.b[0])
    force = np.full(q.size, torque / row.sum()) if initvals is None else np.asarray(initvals)
    step = 1.0 / float(np.linalg.norm(P.matvec(np.ones(q.size))) / np.sqrt(q.size)) / 4.0
    ahead, weight = force, 1.0
    for _ in range(max_iterations):
        before = force
        force = onto_balance(ahead - step * (P.matvec(ahead) + q), row, torque)
        next_weight = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * weight**2))
        ahead = force + (weight - 1.0) / next_weight * (force - before)
        if (force - before) @ (ahead - force) < 0.0:
            ahead, next_weight = force, 1.0
        weight = next_weight
        if np.abs(force - before).max() < 1e-13 * force.max():
            break
    return force


def onto_balance(point: Any, row: Any, torque: float) -> Any:
    """The nearest forces without a pull that balance the torque; the lever arms are positive."""
    low, high = -1e6, 1e6
    for _ in range(90):
        shift = 0.5 * (low + high)
        if row @ np.maximum(point + shift * row, 0.0) < torque:
            low = shift
        else:
            high = shift
    return np.maximum(point + high * row, 0.0)


def assert_right(found: Any, tolerance: float = 1e-9) -> None:
    assert found.status is Status.CERTIFIED, found.message
    assert np.abs(found.force - REFERENCE.force).max() < tolerance * REFERENCE.force.max()
    assert found.elastic_rotation == pytest.approx(REFERENCE.elastic_rotation, rel=tolerance)


# Forms and returns


@pytest.mark.parametrize(
    ("function", "form"),
    [(by_daqp, "dense"), (by_osqp, "sparse"), (by_osqp, "lifted"), (by_lemke, "lcp"), (by_products, "products")],
)
@pytest.mark.parametrize("polish", [True, False])
def test_function_in_every_form_gives_the_answer(function: Callable[..., Any], form: str, polish: bool) -> None:
    solution = solve(PROBLEM, Solver("mine", function, forms=(form,), tolerance=1e-6), polish=polish)
    assert_right(solution, 1e-9 if polish else 1e-4)
    assert (solution.solver, solution.method, solution.polished, solution.claim) == ("mine", form, polish, "solved")
    assert solution.run_time > 0.0
    assert f"mine, form {form}" in solution.message


def test_bare_function_gets_the_scaled_dense_programme() -> None:
    seen = []

    def watch(problem: Any) -> Any:
        seen.append(problem)
        return by_daqp(problem)

    assert_right(solve(PROBLEM, watch))
    expected: Any = PROBLEM.as_qp()
    assert np.array_equal(seen[0].P, expected.P)
    assert np.array_equal(seen[0].q, expected.q)
    assert np.array_equal(seen[0].A, expected.A)
    assert seen[0].b == expected.b


@pytest.mark.parametrize(
    "returned",
    [
        lambda found: found,
        lambda found: found.x,
        lambda found: list(found.x),
        lambda found: found.x[:, np.newaxis],
        lambda found: (found.x, -found.y[0]),
        lambda found: (found.x, -found.y),
        lambda found: ScaledAnswer(found.x, -found.y[0], 5, "done"),
        lambda found: ScaledAnswer(found.x, -found.y[0], 5, "done", Status.INFEASIBLE),
    ],
)
def test_answer_may_be_returned_in_several_ways(returned: Callable[[Any], Any]) -> None:
    solution = solve(PROBLEM, lambda problem: returned(by_daqp(problem)), polish=False, tolerance=1e-8)
    assert_right(solution)


def test_solution_without_multipliers_has_its_rotation_from_the_forces() -> None:
    def forgetful(problem: Any) -> Any:
        found = by_daqp(problem)
        found.y = None
        return found

    assert_right(solve(PROBLEM, forgetful, polish=False, tolerance=1e-8))


def test_first_form_that_the_problem_has_is_taken() -> None:
    both = Solver("both", by_osqp, forms=("lifted", "sparse"))
    assert solve(PROBLEM, both).method == "lifted"
    assert solve(DENSE, both).method == "sparse"
    assert solve(PROBLEM, both, form="sparse").method == "sparse"
    many = ContactProblem(np.zeros(2), np.full(2, 40.0), 1e4, (np.full(2, 1e-6), np.ones((2, 3)) * 1e-4))
    assert solve(many, both).method == "sparse"
    assert solve(many, Solver("lifted", by_osqp, forms=("lifted",))).method == "lifted"
    with pytest.raises(InputError, match=r"form = 'dense': must be one of auto, lifted, sparse"):
        solve(PROBLEM, both, form="dense")
    with pytest.raises(InputError, match=r"must be the pair \(d, V\) for lifted"):
        solve(DENSE, Solver("lifted", by_osqp, forms=("lifted",)))


def test_function_may_write_to_what_it_gets() -> None:
    def vandal(problem: Any) -> Any:
        answer = by_daqp(problem)
        for array in (problem.P, problem.q, problem.A, problem.b, problem.lb):
            array *= 0.0
        return answer

    assert_right(solve(PROBLEM, vandal))
    assert_right(solve(PROBLEM))


# Products alone


def test_projected_method_solves_a_compliance_known_by_products() -> None:
    given = OperatorCompliance(aslinearoperator(PROBLEM.dense_compliance), PROBLEM.compliance_diagonal)
    problem = ContactProblem(PROBLEM.separation, PROBLEM.lever_arm, PROBLEM.torque, given)
    solution = solve(problem, Solver("projected", by_products, forms=("products",)), tolerance=1e-6)
    assert_right(solution, 1e-4)
    assert (solution.method, solution.polished) == ("products", False)
    assert "positive semidefinite is assumed" in solution.message
    assert solution.energy == pytest.approx(REFERENCE.energy, rel=1e-6)
    with pytest.raises(InputError, match=r"compliance = LinearOperator: must be a matrix for .*forms dense"):
        solve(problem, by_daqp)
    negative = OperatorCompliance(aslinearoperator(-PROBLEM.dense_compliance), PROBLEM.compliance_diagonal)
    refused = ContactProblem(PROBLEM.separation, PROBLEM.lever_arm, PROBLEM.torque, negative)
    solver = Solver("projected", by_products, forms=("products",))
    assert solve(refused, solver).status is Status.NOT_POSITIVE_SEMIDEFINITE


# Liars and failures


def unfit(value: Any) -> Callable[..., Any]:
    return lambda problem: value


@pytest.mark.parametrize(
    ("function", "status", "words"),
    [
        (lambda p: (np.full(p.q.size, float(p.b[0]) / p.A.sum()), 1.0), Status.NOT_CERTIFIED, "misses 1.0e-09"),
        (lambda p: (np.zeros(p.q.size), 0.0), Status.NOT_CERTIFIED, "misses"),
        (lambda p: np.full(p.q.size, np.nan), Status.SOLVER_FAILED, "36 of 36 unknowns are not finite"),
        (lambda p: (np.ones(p.q.size), np.inf), Status.SOLVER_FAILED, "rotation inf: must be finite"),
        (lambda p: (np.ones(p.q.size), "x"), Status.SOLVER_FAILED, "rotation 'x': must be a number"),
        (lambda p: np.ones(3), Status.SOLVER_FAILED, "shape (3,): must have (36,)"),
        (lambda p: np.ones((6, 6)), Status.SOLVER_FAILED, "shape (6, 6)"),
        (lambda p: np.ones(p.q.size) * 1j, Status.SOLVER_FAILED, "complex128: must be floats"),
        (lambda p: np.ma.array(p.q, mask=p.q > 0.0), Status.SOLVER_FAILED, "must be floats"),
        (lambda p: (1.0, 2.0, 3.0), Status.SOLVER_FAILED, "3 values"),
        (unfit(None), Status.SOLVER_FAILED, "no answer"),
        (unfit("solved"), Status.SOLVER_FAILED, "must be floats"),
        (unfit({"x": 1.0}), Status.SOLVER_FAILED, "must be floats"),
        (lambda p: 1 / 0, Status.SOLVER_FAILED, "ZeroDivisionError"),
        (lambda p: sys.exit(3), Status.SOLVER_FAILED, "ended with code 3"),
        (lambda p: qpsolvers.Solution(p), Status.SOLVER_FAILED, "found no answer"),
    ],
)
def test_what_is_no_answer_becomes_a_status_with_a_reason(
    function: Callable[..., Any], status: Status, words: str
) -> None:
    solution = solve(PROBLEM, function, polish=False)
    assert solution.status is status
    assert words in solution.message
    assert np.isnan(solution.force).all()


def test_time_out_of_a_function_is_the_status_of_a_time_limit() -> None:
    def late(problem: Any, time_limit: float) -> Any:
        raise TimeoutError(f"after {time_limit} s")

    solution = solve(PROBLEM, late, time_limit=3.0)
    assert solution.status is Status.TIME_LIMIT
    assert "time limit met: after 3.0 s" in solution.message


def test_lcp_returns_z_alone() -> None:
    solution = solve(PROBLEM, Solver("pair", lambda p: (by_lemke(p), 1.0), forms=("lcp",)))
    assert solution.status is Status.SOLVER_FAILED
    assert "z alone" in solution.message


def test_solver_for_definite_matrices_is_told_why_it_failed() -> None:
    singular = ContactProblem(np.zeros(3), np.full(3, 40.0), 1e4, np.ones((3, 3)) * 1e-6)
    solution = solve(singular, Solver("cholesky", lambda p: np.linalg.cholesky(p.P), definite=True))
    assert solution.status is Status.SOLVER_FAILED
    assert "cholesky is for positive definite compliances" in solution.message


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"name": ""}, "name = ''"),
        ({"function": 3}, "function = 3: must be a function"),
        ({"forms": ("dual",)}, "forms = 'dual': must be one of dense, sparse, lifted, lcp, products"),
        ({"forms": ()}, "at least one of dense"),
        ({"warm_start": 1}, "warm_start = 1"),
        ({"tolerance": 0.0}, "tolerance = 0"),
    ],
)
def test_declaration_that_says_nothing_is_refused(values: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError) as error:
        Solver(**{"name": "mine", "function": by_daqp, **values})
    assert words in str(error.value)


# Limits, settings and starts


def test_limits_and_settings_reach_the_function_by_name() -> None:
    seen: dict[str, Any] = {}

    def watch(problem: Any, tolerance: float, time_limit: float, max_iterations: int, rho: float = 0.0) -> Any:
        seen.update(tolerance=tolerance, time_limit=time_limit, max_iterations=max_iterations, rho=rho)
        return by_daqp(problem)

    solve(PROBLEM, watch, tolerance=1e-5, time_limit=2.0, max_iterations=7, rho=0.5)
    assert seen == {"tolerance": 1e-5, "time_limit": 2.0, "max_iterations": 7, "rho": 0.5}


def test_what_the_function_does_not_take_is_refused() -> None:
    def plain(problem: Any) -> Any:
        return by_daqp(problem)

    for keyword in ("time_limit", "max_iterations", "rho"):
        given: dict[str, Any] = {keyword: 1}
        with pytest.raises(InputError, match=rf"^{keyword} = 1: must not be given, .*plain takes no such keyword"):
            solve(PROBLEM, plain, **given)
    assert solve(PROBLEM, plain, tolerance=1e-5, polish=False).tolerance == 1e-5


@pytest.mark.parametrize("form", ["dense", "lifted"])
def test_warm_start_is_given_to_those_that_take_one(form: str) -> None:
    starts = []

    def watch(problem: Any, initvals: Any = None) -> Any:
        starts.append(initvals)
        return by_osqp(problem) if form == "lifted" else by_daqp(problem)

    warm = Solver("warm", watch, forms=(form,), warm_start=True)
    solve(PROBLEM, warm)
    solve(PROBLEM, warm, initial_force=REFERENCE.force)
    solve(PROBLEM, Solver("cold", watch, forms=(form,)), initial_force=REFERENCE.force)
    assert starts[0] is None
    assert starts[2] is None
    assert starts[1][: PROBLEM.size] == pytest.approx(REFERENCE.force / PROBLEM.scaling.force)
    if form == "lifted":
        programme = by_osqp(PROBLEM.as_qp(sparse=True)).problem
        assert starts[1].size > programme.q.size


# Modules that change the process, end it, or raise what is none of an answer

GOOD = """
import qpsolvers
def solver(problem):
    return qpsolvers.solve_problem(problem, "daqp", primal_tol=1e-11, dual_tol=1e-12)
"""
DUMB = "    def __str__(self): raise SystemExit(0)\n    __repr__ = __str__\n"
HOSTILE = {
    # At their import: what the refusal says.
    "raise SystemExit(0)": "cannot be loaded: it ended with code 0",
    "raise BaseException('base')": "BaseException: base",
    "raise GeneratorExit": "GeneratorExit",
    "raise KeyboardInterrupt": "KeyboardInterrupt",
    f"class E(Exception):\n{DUMB}raise E": "E: its text raises an exception, too",
    f"from easeoff import InputError\nclass E(InputError):\n{DUMB}raise E": "E: its text raises an exception, too",
    "while True: pass": "time limit met: it was ended after 0.1 s; if only the first import takes long",
    "import time\ntime.sleep(1e6)": "time limit met: it was ended after 0.1 s",
    "def __getattr__(name): raise BaseException('lazy')": "BaseException: lazy",
    "from easeoff.contact import Solver\nclass Own(Solver):\n"
    "    def __getattribute__(self, name): raise SystemExit(0)\nsolver = object.__new__(Own)": "it ended with code 0",
    "import qpsolvers\ndef solver(: pass": "SyntaxError",
    # At their call: what the message of the solution says.
    "def solver(problem): raise SystemExit(0)": "it ended with code 0",
    "def solver(problem): raise BaseException('base')": "BaseException: base",
    "def solver(problem): raise GeneratorExit": "GeneratorExit",
    "def solver(problem): raise KeyboardInterrupt": "KeyboardInterrupt",
    f"class E(Exception):\n{DUMB}def solver(problem): raise E": "E: its text raises an exception, too",
    f"class E(TimeoutError):\n{DUMB}def solver(problem): raise E": "time limit met: its text raises",
    "class S(str):\n    def __format__(self, how): raise SystemExit(0)\nclass E(Exception):\n"
    "    def __str__(self): return S('mine')\ndef solver(problem): raise E": "E: mine",
    "class E(Exception):\n    @property\n    def __class__(self): raise SystemExit(0)\n"
    "def solver(problem): raise E": "its own words: E",
    "class R:\n    def __getattr__(self, name): raise BaseException('name')\n"
    "def solver(problem): return R()": "BaseException: name",
    f"class T(str):\n{DUMB}def solver(problem): return problem.q, T()": "it ended with code 0",
    "from easeoff.contact.solvers.solution import ScaledAnswer\n"
    "def solver(problem): return ScaledAnswer(problem.q, 0.0, 1, '', 'sure')": "suspicion is no Status",
    "class F:\n    @property\n    def __signature__(self): raise BaseException\n"
    "    def __call__(self, problem): return None\nsolver = F()": "no answer",
    # What they change is put back, at import and after every call.
    **{
        first + GOOD + "found = solver\ndef solver(problem):\n    " + second + "\n    return found(problem)\n": ""
        for first, second in (
            ("", "pass"),
            ("import os\nos.chdir('/')", "os.chdir('/')"),
            ("import numpy as np\nnp.seterr(all='raise')", "np.seterr(all='raise')"),
            ("print('here')", "import os; print('here'); os.write(1, b'here'); os.system('echo here')"),
            ("import sys\nsys.stdout.close()\nsys.stdout = sys.stderr = None", "sys.stdout = None"),
            ("import os\nos.close(1)", "os.close(1)"),
            ("import warnings\nwarnings.simplefilter('ignore')", "warnings.simplefilter('ignore')"),
            ("import warnings\nwarnings.showwarning = None", "warnings.showwarning = None"),
            ("import sys\nsys.setrecursionlimit(100)", "pass"),
            ("import os\nos.umask(0o777)", "os.umask(0o777)"),
            ("import signal\nsignal.signal(signal.SIGINT, signal.SIG_IGN)", "pass"),
            ("import sys\nsys.path.remove(sys.path[0])", "sys.path.remove(sys.path[0])"),
        )
    },
}


def of_the_process() -> list[Any]:
    """What a solver must not change."""
    mask = os.umask(0o077)
    os.umask(mask)
    places = [(os.fstat(number).st_dev, os.fstat(number).st_ino) for number in (1, 2)]
    handlers = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGALRM)]
    warned = warnings.filters[:], warnings.showwarning
    streams = sys.stdout, sys.stderr, sys.stdout.closed, places
    return [os.getcwd(), np.geterr(), *streams, *warned, sys.getrecursionlimit(), mask, *handlers, set(sys.path)]


@pytest.mark.parametrize("source", HOSTILE)
def test_hostile_module_is_a_reason_and_changes_nothing(
    source: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    text_file(tmp_path / "hostile_solver.py", source)
    monkeypatch.chdir(tmp_path)
    monkeypatch.delitem(sys.modules, "hostile_solver", raising=False)
    monkeypatch.setattr(
        solver_declaration, "IMPORT_TIME_LIMIT", 0.1 if "time limit met: it" in HOSTILE[source] else 1e3
    )
    importlib.invalidate_caches()
    before = of_the_process()
    try:
        solution = solve(PROBLEM, "hostile_solver:solver")
        said = "" if solution.certified else solution.message
    except InputError as error:
        said = str(error)
    assert of_the_process() == before
    assert HOSTILE[source] in said
    assert bool(said) == bool(HOSTILE[source])
    assert capfd.readouterr().out == ""
    sys.modules.pop("hostile_solver", None)


def test_command_tells_the_reason_and_writes_where_it_was_told_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """The folder changes once more behind its back, as by a thread of the module."""
    own = "import os, warnings\ndef solver(problem):\n    warnings.warn('mine', RuntimeWarning)\n    print('here')\n"
    text_file(tmp_path / "own_hostile.py", own + "    raise ValueError('no luck')\n")
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path)
    frozen: list[bool] = []
    monkeypatch.setattr(gc, "freeze", lambda: frozen.append(True))
    monkeypatch.setattr(analysis_commands, "check_cost", lambda *given: os.chdir("elsewhere"))
    monkeypatch.syspath_prepend(tmp_path)
    small_file(tmp_path, more=SHELLS)
    done = CliRunner().invoke(
        main,
        ["run", "nasa-12x36.toml", "-o", "r.nc", "--torque", "100", "--solver", "own_hostile:solver"],
        obj="program",
    )
    assert not frozen  # what other packages made is cleaned up: some tell of what is not
    sys.modules.pop("own_hostile")
    assert done.exit_code == 1
    assert done.stdout.startswith("wrote r.nc: 0 of 3 mesh positions certified at 100 N m\nnext: easeoff show r.nc, ")
    assert "here" not in done.stdout
    assert done.stderr.count("Note: RuntimeWarning: mine\n") == 1
    assert "RuntimeWarning" not in done.stderr.replace("Note: RuntimeWarning: mine\n", "")
    reason = "own_hostile:solver, form dense: it failed; its own words: ValueError: no luck"
    assert f"the first of them: linear problem 1 failed: {reason}" in done.stderr
    assert reason in " ".join(result_summary(read_result(tmp_path / "r.nc")).split())


def test_process_is_not_ended_as_if_all_were_done(monkeypatch: pytest.MonkeyPatch) -> None:
    """That of a command; copies of it end as they want to."""
    monkeypatch.setattr(os, "_exit", os._exit)

    def command(obj: str) -> None:
        child = os.fork()
        if child == 0:
            os._exit(7)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
        with pytest.raises(ForeignCodeError, match=r"^it ended with code 0$"), foreign_code():
            os._exit(0)

    monkeypatch.setattr(study_cli, "main", command)
    study_cli.program()


@pytest.mark.parametrize("swallowed", [True, False])
def test_interrupt_of_the_user_is_none_of_the_solver(swallowed: bool) -> None:
    def interrupted(problem: Any) -> Any:
        with contextlib.suppress(KeyboardInterrupt if swallowed else ValueError):
            signal.raise_signal(signal.SIGINT)
        return by_daqp(problem)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell in the background ignores interrupts
    try:
        with pytest.raises(KeyboardInterrupt):
            solve(PROBLEM, interrupted)
    finally:
        signal.signal(signal.SIGINT, before)


def test_function_that_takes_no_notice_of_its_time_limit_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also one that passes over the first alarm, of which it is told."""
    monkeypatch.setattr(backend_solution_module, "GRACE_TIME", 0.01)
    monkeypatch.setattr(foreign_code_module, "ALARM_INTERVAL", 0.01)

    def endless(problem: Any, time_limit: float, patience: int) -> Any:
        while patience:
            try:
                time.sleep(1e6)
            except BaseException:
                patience -= 1
        time.sleep(1e6)

    solution = solve(PROBLEM, endless, time_limit=0.01, patience=0)
    assert solution.status is Status.TIME_LIMIT
    assert "time limit met: it was ended after 0.02 s" in solution.message
    with pytest.warns(UserWarning, match="goes on after 0.02 s"):
        assert solve(PROBLEM, endless, time_limit=0.01, patience=2).status is Status.TIME_LIMIT
    assert signal.setitimer(signal.ITIMER_REAL, 0.0) == (0.0, 0.0)


def test_limit_of_what_is_around_foreign_code_is_its_own() -> None:
    message = r"ended after 0\.02 s"
    with pytest.raises(ForeignCodeError, match=message), foreign_code(0.02), foreign_code(), foreign_code(1e3):
        time.sleep(1e6)


def test_foreign_code_of_many_threads_leaves_the_process_as_it_was(capfd: pytest.CaptureFixture[str]) -> None:
    """However their calls overlap; an interrupt is the main thread's, and an alarm is not had."""
    before, both = of_the_process(), threading.Barrier(2)

    def work(number: int) -> str:
        said = ""
        try:
            with foreign_code(1e-6):
                both.wait()
                os.chdir("/")
                sys.stdout.write("here")
                if number:
                    both.wait()
                raise KeyboardInterrupt
        except ForeignCodeError as error:
            said = str(error)
        if not number:
            both.wait()
        return said

    with ThreadPoolExecutor(2) as pool:
        assert list(pool.map(work, range(2))) == ["KeyboardInterrupt"] * 2
    assert of_the_process() == before
    assert capfd.readouterr().out == ""


def test_package_of_a_solver_that_cannot_be_loaded_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text_file(tmp_path / "pyqpmad.py", "raise SystemExit('broken')")
    for name in [name for name in sys.modules if name.partition(".")[0] == "pyqpmad"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.syspath_prepend(tmp_path)
    backend_solution_module._load.cache_clear()
    with pytest.raises(MissingSolverError, match="solver 'pyqpmad' cannot be loaded: it ended with code broken"):
        solve(PROBLEM, "pyqpmad")


# Where they are found


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A module in a folder on the path."""
    (tmp_path / "a_solver_of_mine.py").write_text(
        "import qpsolvers\n"
        "from easeoff.contact import Solver\n"
        "def function(problem, **settings):\n"
        "    return qpsolvers.solve_problem(problem, 'daqp', primal_tol=1e-11, dual_tol=1e-12, **settings)\n"
        "declared = Solver('other', function, warm_start=True, method='by DAQP')\n"
        "number = 3\n",
        encoding="utf-8",
    )
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.delitem(sys.modules, "a_solver_of_mine", raising=False)
    importlib.invalidate_caches()
    return tmp_path


def test_solver_is_found_in_the_current_folder_by_its_text(module: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(module)
    for text in ("a_solver_of_mine:function", "a_solver_of_mine:declared"):
        solution = solve(PROBLEM, text)
        assert_right(solution)
        assert solution.solver == text
    before = list(sys.path)
    solve(PROBLEM, "a_solver_of_mine:function")
    assert sys.path == before


@pytest.mark.parametrize(
    "text",
    [
        "no_such_module_at_all:function",
        "numpy:no_such_function",
        "numpy:pi",
        ":function",
        "numpy:",
        "a b:c",
        "os:path:x",
    ],
)
def test_place_without_a_solver_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="solver = "):
        solve(PROBLEM, text)


def test_value_that_names_no_solver_is_refused() -> None:
    with pytest.raises(
        InputError, match=r"solver = 3: must be the name of a solver, MODULE:FUNCTION, a function or a Solver"
    ):
        solve(PROBLEM, 3)  # type: ignore[arg-type]


def distribution(folder: Path, name: str, **points: str) -> None:
    """Install a distribution by hand: the folder in which importlib.metadata finds its entry points."""
    info = folder / f"{name}-1.2.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.2\n", encoding="utf-8")
    lines = [f"{key} = {place}\n" for key, place in points.items()]
    (info / "entry_points.txt").write_text("[easeoff.solvers]\n" + "".join(lines), encoding="utf-8")


@pytest.fixture
def installed(module: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    distribution(
        module,
        "solvers-of-mine",
        mine="a_solver_of_mine:function",
        declared="a_solver_of_mine:declared",
        osqp="a_solver_of_mine:function",
        broken="a_solver_of_mine:nothing",
        number="a_solver_of_mine:number",
    )
    monkeypatch.syspath_prepend(module)
    return module


def test_entry_point_is_a_solver_by_its_name(installed: Path) -> None:
    assert available_solvers()[0] == "native"
    assert {"mine", "declared"} < set(available_solvers())
    for name in ("mine", "declared"):
        solution = solve(PROBLEM, name)
        assert_right(solution)
        assert solution.solver == name
    assert "by DAQP" in solve(PROBLEM, "declared").message
    assert "alternating direction" in solve(PROBLEM, "osqp").message  # names of the table come first


def test_entry_point_that_is_none_says_so(installed: Path) -> None:
    with pytest.raises(
        InputError, match=r"solver = 'broken': cannot be loaded: .*'a_solver_of_mine' has no attribute 'nothing'"
    ):
        solve(PROBLEM, "broken")
    with pytest.raises(InputError, match=r"must be a function or a Solver, and a_solver_of_mine:number is 3"):
        solve(PROBLEM, "number")
    with pytest.raises(InputError, match=r"mine.*did you mean 'mine'"):
        solve(PROBLEM, "mime")


def test_two_distributions_with_one_name_are_told_apart(installed: Path) -> None:
    distribution(installed, "another", mine="a_solver_of_mine:declared")
    importlib.invalidate_caches()
    sys.path.append("nowhere to be found")  # what was found is kept for a path
    with pytest.raises(InputError, match=r"must be brought by one distribution; another, solvers-of-mine bring it"):
        solve(PROBLEM, "mine")


# In line contacts and analyses


def test_line_contacts_are_solved_by_a_function() -> None:
    data, contact = three_segments()
    reference, _ = solve_on_bending(ContactProblem(*data), contact)
    found, _ = solve_on_bending(ContactProblem(*data), contact, by_daqp)
    assert found.force == pytest.approx(reference.force, rel=1e-9)
    loose, _ = solve_on_bending(ContactProblem(*data), contact, Solver("mine", by_daqp, tolerance=1e-6), polish=False)
    assert loose.certified
    assert loose.tolerance == 1e-6


@pytest.mark.thorough
def test_analysis_takes_a_solver_of_ones_own() -> None:
    case = small(mesh_positions=2)
    reference = analyze(case, torques=[100.0])
    found = analyze(case, torques=[100.0], solver=Solver("mine", by_daqp))
    assert found.attrs["solver"] == "mine"
    assert (found["loaded/status"] == 0).all()
    error = np.abs(found["loaded/transmission_error"] - reference["loaded/transmission_error"]).max()
    assert error < 1e-6 * np.abs(reference["loaded/transmission_error"]).max()
    limited = analyze(case, torques=[100.0], max_iterations=1)
    assert (limited["loaded/status"] == Status.NOT_CONVERGED).all()


# In comparisons and commands


@pytest.mark.thorough
def test_comparison_takes_texts_and_names_of_entry_points(installed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from easeoff.study.compare import compare

    monkeypatch.chdir(installed)
    write_problems([PROBLEM, PROBLEM.with_torque(1.1 * PROBLEM.torque)], installed / "problems.nc")
    chosen = ["native", "mine", "declared", "a_solver_of_mine:function"]
    table = compare(["problems.nc"], "study", solvers=chosen, repetitions=1)
    assert set(table["solver"].values) == set(chosen)
    assert table["certified"].values.all()
    assert (table["rotation_error"] < 1e-9).all()
    starts = {name: set(table["start"].values[table["solver"].values == name]) for name in chosen}
    assert starts["declared"] == starts["native"] == {"cold", "warm"}  # it declares that it takes a start
    assert starts["mine"] == {"cold"}
    versions = json.loads(table.attrs["solver_versions"])
    assert versions["mine"].startswith("solvers-of-mine 1.2, file ")
    assert versions["a_solver_of_mine:function"].startswith("file ")


@pytest.mark.thorough
def test_commands_take_solvers_of_ones_own(installed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(installed)
    for name in ("mine", "a_solver_of_mine:declared"):
        output_of("run", "nasa-12x36", "--torque", "100", "--solver", name, "-o", "out.nc")
        result = read_result("out.nc")
        assert result.attrs["solver"] == name
        assert (result["loaded/status"] == 0).all()
        Path("out.nc").unlink()
    for name in ("no_such_solver", "no_such_module_at_all:solve"):
        assert name in refusal_of("run", "nasa-12x36", "--solver", name, "-o", "out.nc")


@pytest.mark.parametrize(
    ("function", "form"), [(by_daqp, "dense"), (by_daqp, "lifted"), (by_lemke, "lcp"), (by_daqp, "sparse")]
)
def test_problem_in_mm_and_newtons_is_given_in_every_form(function: Callable[..., Any], form: str) -> None:
    solver = Solver("mine", function, forms=(form,), tolerance=1e-6)
    solution = backend_solution(PROBLEM, "mine", solver, {}, raw=True, polish=None)
    assert_right(solution, 1e-6)
    assert solution.method == form


def test_exception_is_a_status_with_settings_of_ones_own_too() -> None:
    def fails(problem: Any, rho: float) -> Any:
        raise ValueError(f"rho = {rho} is too much")

    solution = solve(PROBLEM, fails, rho=3.0)
    assert solution.status is Status.SOLVER_FAILED
    assert "ValueError: rho = 3.0 is too much" in solution.message
    assert solution.claim == "raised"


def test_message_of_an_answer_that_misses_says_how_to_accept_it() -> None:
    problem = ContactProblem(np.zeros(2), np.full(2, 50.0), 2.0e5, np.diag([2e-6, 2e-6]))

    def nearly(posed: Any, **_: Any) -> Any:
        answer = qpsolvers.solve_problem(posed, "daqp")
        assert answer.x is not None
        return answer.x * (1.0 + 1e-6)

    missed = solve(problem, nearly, polish=False)
    assert not missed.certified
    assert "misses 1.0e-09" in missed.message
    assert missed.message.endswith("give tolerance=..., or Solver(..., tolerance=...), to accept it")
    assert solve(problem, nearly, polish=False, tolerance=1e-3).certified
    assert solve(problem, Solver("nearly", nearly, tolerance=1e-3), polish=False).certified


# --- Lemke's method


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
    n = (SOLVERS["lemke"].largest or 0) + 1
    problem = ContactProblem(np.zeros(n), np.ones(n), 1.0, (np.ones(n), np.zeros((n, 0))))
    with pytest.raises(InputError, match=f"size = {n}: must be at most"):
        solve(problem, "lemke")


@pytest.mark.parametrize("name", ["weak_local", "nearly_singular", "spread_local", "random_dense", "far_apart"])
def test_pivoting_needs_no_polish_where_the_compliance_is_nearly_singular(name: str) -> None:
    for problem in problems(name, 15, seed=12):
        solution = solve(problem, "lemke", polish=False)
        assert solution.certificate.worst < 1e-11
        assert solution.elastic_rotation == pytest.approx(solve(problem).elastic_rotation, rel=1e-10)


def test_choice_of_a_solver_is_found_once() -> None:
    """What was found is taken wherever a name is, and is found as itself."""
    springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    for choice, native in (("auto", True), ("native", True), ("osqp", False), (lambda problem: [1.0, 1.0], False)):
        found = chosen_solver(choice)
        assert chosen_solver(found) is found
        assert found.is_native is native
        assert found.name == require_solver(choice) == require_solver(found) == solve(springs, found).solver
        assert found.asked == (choice if isinstance(choice, str) else found.name)
