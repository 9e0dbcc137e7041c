"""Memory: what is free, what an analysis takes as estimated; what is too large is refused before it runs."""

from __future__ import annotations

import ctypes
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from runs import call, refusal_of, text_file

import easeoff
from easeoff import InputError
from easeoff.cases import Case, gear_pair
from easeoff.cases.analysis_size import AnalysisSize
from easeoff.cases.conversion import finite_elements
from easeoff.cases.schema.case_schema import ComplianceTable
from easeoff.core import memory
from easeoff.core.memory import MEMORY_VARIABLE, available_memory, require_memory
from easeoff.core.process_settings import child_environment
from easeoff.friction.ehl import LubricatedContact, Oil, rough_passage
from easeoff.geometry.pair import gear_pair as geometry
from easeoff.study import WearLaw, wear

MEASURE = """
import json, re, sys
from pathlib import Path
import easeoff, easeoff.contact, easeoff.friction, easeoff.study.summary.result_summary

def peak():  # of this program; what getrusage says counts that of the process it was started from
    return int(re.search(r"VmHWM:\\s*(\\d+)", Path("/proc/self/status").read_text())[1])

contact, options = json.loads(sys.argv[1])
case = easeoff.read_case("nasa-12x36")
case = case.model_copy(update={"contact": case.contact.model_copy(update=contact)})
before = peak()
tree = easeoff.analyze(case, **options)
easeoff.write_result(tree, sys.argv[2])
print(peak() - before)
"""


def sized(**contact: Any) -> Case:
    case = easeoff.read_case("nasa-12x36")
    return case.model_copy(update={"contact": case.contact.model_copy(update=contact)})


@pytest.fixture(scope="module")
def kept_teeth() -> None:
    """Elastic teeth of the case: what it takes to make them is required apart."""
    easeoff.analyze(sized(mesh_positions=8), torques=50.0)


@pytest.mark.thorough
@pytest.mark.usefixtures("kept_teeth")
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="the system does not say what a process takes")
@pytest.mark.parametrize(
    ("contact", "torques", "speeds", "feedback"),
    [
        ({"lengthwise_nodes": 201, "profile_nodes": 201}, 1, 0, False),
        ({}, 150, 0, False),
        ({"mesh_positions": 8, "segments_per_line": 800}, 1, 0, False),
        ({}, 10, 60, False),
        ({"mesh_positions": 8}, 4, 12, True),
    ],
)
def test_the_estimate_is_what_a_process_takes(
    contact: dict[str, int], torques: int, speeds: int, feedback: bool, tmp_path: Path
) -> None:
    """No less, so that nothing too large begins; and no more than three times as much, so that nothing is refused
    without need."""
    options: dict[str, Any] = {"torques": [50.0 + i for i in range(torques)]}
    if speeds:
        options |= {"speed": [500.0 + 10.0 * i for i in range(speeds)], "friction_feedback": feedback}
    words = [sys.executable, "-c", MEASURE, json.dumps([contact, options]), str(tmp_path / "result.nc")]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    taken = 1024.0 * int(done.stdout)
    conditions = (speeds, 1, 1) if speeds else (0, 0, 0)
    estimated = AnalysisSize.of(sized(**contact), torques, conditions, feedback=feedback).memory
    assert taken <= estimated <= 3.0 * taken


@pytest.mark.parametrize(
    ("contact", "options", "numbers"),
    [
        ({"lengthwise_nodes": 1001, "profile_nodes": 1001}, {}, "1001 lengthwise_nodes x 1001 profile_nodes"),
        (
            {"mesh_positions": 200},
            {"torques": [float(i) for i in range(1, 1001)]},
            "1000 torques x 200 mesh_positions x 31 segments_per_line",
        ),
        (
            {"mesh_positions": 2000, "segments_per_line": 2000},
            {"torques": 100.0},
            "2000 mesh_positions x 2000 segments_per_line",
        ),
        (
            {},
            {"speed": [float(i) for i in range(1, 10001)], "temperature": [30.0 + 0.01 * i for i in range(5000)]},
            "10000 speeds x 5000 temperatures x 1 roughnesses",
        ),
    ],
)
def test_what_is_too_large_is_refused_before_it_begins(
    contact: dict[str, int], options: dict[str, Any], numbers: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(MEMORY_VARIABLE, "3")
    monkeypatch.setattr(geometry, "grid", None)  # nothing is computed
    with pytest.raises(InputError) as refused:
        easeoff.analyze(sized(**contact), **options)
    assert str(refused.value).startswith(f"{numbers}: must be smaller, as the analysis needs about ")
    assert "and 3 GB are free" in str(refused.value)


def test_studies_refuse_what_is_too_large(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(MEMORY_VARIABLE, "3")
    case = sized(lengthwise_nodes=1001, profile_nodes=1001)
    with pytest.raises(InputError, match="1001 profile_nodes: must be smaller"):
        easeoff.modify(case, torques=[100.0])
    with pytest.raises(InputError, match="1001 profile_nodes: must be smaller"):
        wear(case, WearLaw(1e-12, 1e-12, 1e6), torque=100.0)


@pytest.mark.parametrize("command", ["run", "problems"])
def test_commands_refuse_it_and_leave_nothing(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(MEMORY_VARIABLE, "0.5")
    text = easeoff.cases.case_text("nasa-12x36").replace("[contact]", "[contact]\nmesh_positions = 2000")
    case = text_file(tmp_path / "case.toml", text)
    torques = ",".join(str(i) for i in range(1, 301))
    said = refusal_of(command, case, "--torque", torques, "-o", tmp_path / "out.nc")
    assert "300 torques x 2000 mesh_positions x 31 segments_per_line: must be smaller" in said
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]


def test_memory_grows_with_every_number() -> None:
    own = AnalysisSize.of(sized(), 3, (2, 2, 2))
    for name in ("torques", "mesh_positions", "segments_per_line", "lengthwise_nodes", "profile_nodes", "speeds"):
        more = AnalysisSize(**{**vars(own), name: 2 * getattr(own, name)})
        assert more.memory > own.memory
        assert more.seconds > own.seconds


def test_a_long_analysis_says_before_it_begins_what_it_takes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(*arguments: Any, **options: Any) -> Any:
        raise InputError("begun")

    monkeypatch.setattr("easeoff.study.analysis.case_analysis.analyze", stop)
    torques = ",".join(str(i) for i in range(1, 3001))
    said = call("run", "nasa-12x36", "--torque", torques, "-o", tmp_path / "out.nc")
    assert said.output.splitlines()[-2:] == ["96000 contact problems: about 3 min", "Error: begun"]
    said = call("run", "nasa-12x36", "-o", tmp_path / "out.nc")
    assert said.output.splitlines() == ["Error: begun"]


def test_fine_teeth_say_what_they_take(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(*arguments: Any, **options: Any) -> Any:
        raise InputError("begun")

    monkeypatch.setattr("easeoff.study.analysis.case_analysis.analyze", stop)
    case = text_file(tmp_path / "case.toml", easeoff.cases.case_text("nasa-12x36") + "\n[compliance]\nfineness = 2.0\n")
    said = call("run", case, "-o", tmp_path / "out.nc")
    assert said.output.splitlines()[0] == (
        "elastic teeth with fineness = 2: about 110 s, unless they are kept from an earlier run"
    )


@pytest.mark.parametrize(("model", "words"), [("fe", "by finite elements"), ("solid_shell", "as a solid shell")])
def test_teeth_too_large_for_the_memory_are_refused(
    model: Any, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(MEMORY_VARIABLE, "0.08")
    monkeypatch.setenv("EASEOFF_CACHE", str(tmp_path))
    case = sized().model_copy(update={"compliance": ComplianceTable(model=model, fineness=1.5)})
    pair = gear_pair(case)
    with pytest.raises(InputError, match=rf"^fineness = 1.5: must be smaller, as the pinion {words} needs about"):
        finite_elements(case, pair)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("options", "size"),
    [
        (["--nodes", "1001x1001", "-o", "gear.stl"], "nodes = 1001x1001: must be smaller, as the surface needs"),
        (["--teeth", "all", "-o", "gear.vtu"], "nodes = 61x31, teeth = 36: must be smaller, as the surface needs"),
        (["--rows", "900", "--columns", "900", "-o", "gear.csv"], "rows = 900, columns = 900: must be smaller"),
    ],
)
def test_files_too_large_for_the_memory_are_refused(
    options: list[str], size: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(MEMORY_VARIABLE, "0.1")
    monkeypatch.chdir(tmp_path)
    said = refusal_of("export", "nasa-12x36", "--member", "gear", *options)
    assert size in " ".join(said.split())
    assert not list(tmp_path.iterdir())


def test_a_passage_that_keeps_too_much_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(MEMORY_VARIABLE, "1")
    contact = LubricatedContact(1e9, 0.02, 5.0, Oil(0.02, 1.1e-8), slide_to_roll=0.25)
    with pytest.raises(InputError, match=r"^steps = 1000000, nodes = 513, keep = 1: must be smaller, as the passage"):
        rough_passage(contact, steps=10**6, nodes=513, keep=1)


@pytest.mark.parametrize(("reason", "said"), [("", "for this: lower"), ("no 75 GB", "for this (no 75 GB): lower")])
def test_memory_that_runs_out_all_the_same_is_one_message(
    reason: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*arguments: Any, **options: Any) -> Any:
        raise MemoryError(reason)

    monkeypatch.setattr("easeoff.study.analysis.case_analysis.analyze", fail)
    failed = refusal_of("run", "nasa-12x36", "-o", tmp_path / "out.nc")
    assert f"Error: there is not enough memory {said} the numbers" in failed
    assert not list(tmp_path.iterdir())


# Memory that is free: the least of what the machine, its control groups and the process limit leave


def write(root: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        file = root / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return root


@pytest.mark.parametrize(
    ("files", "left"),
    [
        ({}, None),
        ({"proc/self/cgroup": "0::/"}, None),
        ({"proc/self/cgroup": "0::/", "sys/fs/cgroup/memory.max": "max", "sys/fs/cgroup/memory.current": "5"}, None),
        (
            {
                "proc/self/cgroup": "0::/user/job",
                "sys/fs/cgroup/user/job/memory.max": "4000",
                "sys/fs/cgroup/user/job/memory.current": "1500",
                "sys/fs/cgroup/user/job/memory.stat": "anon 900\ninactive_file 500\n",
                "sys/fs/cgroup/user/memory.max": "9000",
                "sys/fs/cgroup/user/memory.current": "7000",
            },
            2000.0,  # of the folder above; the job's own would leave 3000
        ),
        (
            {
                "proc/self/cgroup": "3:cpu:/\n2:memory:/outside\n0::/\n",
                "sys/fs/cgroup/memory/memory.limit_in_bytes": "8000",
                "sys/fs/cgroup/memory/memory.usage_in_bytes": "6000",
                "sys/fs/cgroup/memory/memory.stat": "inactive_file 9\ntotal_inactive_file 100\n",
            },
            2100.0,
        ),
        (
            {
                "proc/self/cgroup": "2:memory:/",
                "sys/fs/cgroup/memory/memory.limit_in_bytes": "9223372036854771712",  # none
                "sys/fs/cgroup/memory/memory.usage_in_bytes": "6000",
            },
            None,
        ),
        ({"proc/self/cgroup": "nonsense\n0::/", "sys/fs/cgroup/memory.max": "many"}, None),
    ],
)
def test_control_groups_leave_the_least_of_their_limits(
    files: dict[str, str], left: float | None, tmp_path: Path
) -> None:
    assert memory._container(write(tmp_path, files)) == left


def test_the_least_of_all_limits_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(MEMORY_VARIABLE, raising=False)
    for name, size in (("_machine", 3e9), ("_process", 2e9)):
        monkeypatch.setattr(memory, name, lambda size=size: size)
    monkeypatch.setattr(memory, "_container", lambda root: 4e9)
    assert available_memory() == 2e9
    monkeypatch.setattr(memory, "_process", lambda: None)
    assert available_memory() == 3e9
    monkeypatch.setattr(memory, "_container", lambda root: -1.0)
    assert available_memory() == 0.0


def test_where_nothing_is_known_nothing_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(MEMORY_VARIABLE, raising=False)
    for name in ("_machine", "_process"):
        monkeypatch.setattr(memory, name, lambda: None)
    monkeypatch.setattr(memory, "_container", lambda root: None)
    assert available_memory() is None
    require_memory("nodes = 1", 1e30, "the grid")


def test_this_machine_has_some_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(MEMORY_VARIABLE, raising=False)
    free = available_memory()
    assert free is not None
    assert 1e6 < free < 1e16


def test_the_limit_of_the_process_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """What it leaves is the limit less the addresses that are taken."""
    resource = pytest.importorskip("resource")  # not on Windows
    monkeypatch.setattr(resource, "getrlimit", lambda which: (2**40, 2**40))
    taken = 2**40 - (memory._process() or 0.0)
    assert os.sysconf("SC_PAGE_SIZE") < taken < 2**40
    monkeypatch.setattr(resource, "getrlimit", lambda which: (resource.RLIM_INFINITY,) * 2)
    assert memory._process() is None


def test_a_variable_takes_the_place_of_what_is_free(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(MEMORY_VARIABLE, "1.5")
    assert available_memory() == 1.5e9
    require_memory("nodes = 1", 1.5e9, "the grid")
    with pytest.raises(InputError) as refused:
        require_memory("nodes = 900", 2.5e9, "the grid")
    assert str(refused.value) == (
        "nodes = 900: must be smaller, as the grid needs about 2.5 GB of memory, and 1.5 GB are free; the environment "
        "variable EASEOFF_MEMORY [GB] allows more or less"
    )


@pytest.mark.parametrize("text", ["much", "-1", "0", "nan", "inf", "1e400"])
def test_a_variable_that_is_no_size_is_refused(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(MEMORY_VARIABLE, text)
    with pytest.raises(InputError, match=rf"^{MEMORY_VARIABLE} = .*: must be a .*number above 0 \[GB\]$"):
        available_memory()


@pytest.mark.skipif(sys.platform != "linux" or not hasattr(ctypes.CDLL(None), "mallopt"), reason="glibc alone")
def test_freed_memory_is_kept_and_taken_again_without_page_faults() -> None:
    """Ten times five arrays of 16 MB have the pages of five, not of fifty."""
    code = """if True:
        import resource
        import numpy as np
        from easeoff.core.process_settings import keep_freed_memory
        {}
        before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
        for _ in range(10):
            [np.ones(2**21) for _ in range(5)]
        print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
    """
    faults = {}
    for how, kept in {"keep": "keep_freed_memory()", "free": ""}.items():
        with child_environment():
            ended = subprocess.run([sys.executable, "-c", code.format(kept)], capture_output=True, check=True)
        faults[how] = int(ended.stdout)
    assert faults["keep"] < 0.3 * faults["free"]


def test_time_to_make_the_teeth_of_a_shipped_case_is_told() -> None:
    assert AnalysisSize.teeth_seconds(easeoff.read_case("nasa-12x36")) == 2.5
