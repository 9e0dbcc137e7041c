"""Memory that is free: the least of what the machine, its control groups and the process limit leave."""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
from pathlib import Path

import pytest

from easeoff import InputError
from easeoff.core.processes import memory
from easeoff.core.processes.child_environment import child_environment
from easeoff.core.processes.memory import MEMORY_VARIABLE, available_memory, require_memory


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
        from easeoff.core.processes.freed_memory import keep_freed_memory
        {}
        before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
        for _ in range(10):
            [np.ones(2**21) for _ in range(5)]
        print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
    """
    faults = {}
    for how, call in {"keep": "keep_freed_memory()", "free": ""}.items():
        with child_environment():
            ended = subprocess.run([sys.executable, "-c", code.format(call)], capture_output=True, check=True)
        faults[how] = int(ended.stdout)
    assert faults["keep"] < 0.3 * faults["free"]
