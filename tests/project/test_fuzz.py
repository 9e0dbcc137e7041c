"""The search for inputs that break the command line: it finds each fault it looks for, and with fixed seeds nothing."""

from __future__ import annotations

import os
import random
import resource
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import oracle
import pytest
from bases import COMMANDS as MADE, Bases
from kinds.box import INNER, Box
from kinds.drawing import KINDS, draw
from mutations.netcdf_mutations import Group, Variable, load, save
from mutations.option_values import OPTIONS
from places import ROOT
from processes import Limits, Outcome, forked
from writing_runs import content, equal

from easeoff.study.cli import main

COMMANDS = list(main.commands.items())
FUZZ = ROOT / "fuzz"

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs forked processes")


def hang() -> None:
    """As the system ends a process at its limit of processor time."""
    if resource.getrlimit(resource.RLIMIT_CPU)[0] == 1:
        os.kill(os.getpid(), signal.SIGXCPU)


def crash() -> None:
    os.kill(os.getpid(), signal.SIGTERM)


def fill_memory() -> None:
    bytearray(2**31)


def fail() -> None:
    raise ValueError("a bug")


def printing(text: str, code: int = 0) -> Callable[[], None]:
    def call() -> None:
        sys.stdout.write(text)
        sys.exit(code)

    return call


@pytest.mark.parametrize(
    ("call", "found"),
    [
        (hang, "hang"),
        (crash, "crash"),
        (fill_memory, "traceback"),
        (fail, "traceback"),
        (printing("", 3), "exit code 3"),
        (printing("", 1), "exit code 1"),
        (printing("", 2), "without a message"),
        (printing("\x1b[2J"), "control characters"),
        (printing("\x9b31m"), "control characters"),
        (printing("\u202e"), "control characters"),
        (printing("x" * 100_000), "output of"),
        (printing(oracle.SECRET), "shows a file"),
    ],
)
def test_faults_of_a_process_are_found(call: Callable[[], None], found: str, tmp_path: Path) -> None:
    outcome = forked(call, tmp_path, Limits(processor_time=1, memory=2**30))
    faults = oracle.process_faults(outcome, "show")
    assert any(found in fault for fault in faults), faults


def test_a_good_process_has_no_faults(tmp_path: Path) -> None:
    outcome = forked(printing("torque 50 N m, größe 3 µm\n"), tmp_path)
    assert outcome.code == 0
    assert oracle.process_faults(outcome, "show") == []


def left_file(folder: Path) -> None:
    (folder / "out.nc").write_text("half")


def temporary(folder: Path) -> None:
    (folder / ".out.nc.123.tmp").write_text("half")


def overwritten(folder: Path) -> None:
    (folder / "case.toml").write_text("other")


def deleted(folder: Path) -> None:
    (folder / "case.toml").unlink()


def mode(folder: Path) -> None:
    (folder / "older.nc").write_text("new")
    (folder / "older.nc").chmod(0o644)


def executed(folder: Path) -> None:
    (folder / oracle.EXECUTED).write_text("numpy")


def outside(folder: Path) -> None:
    (folder / "../../x.txt").write_text("x")


@pytest.mark.parametrize(
    ("change", "code", "found"),
    [
        (left_file, 2, "left behind: outer/inner/out.nc"),
        (overwritten, 2, "left behind"),
        (deleted, 0, "touched without being named"),
        (temporary, 0, "temporary file"),
        (mode, 0, "permissions"),
        (executed, 0, "code from the current folder"),
        (outside, 0, "touched without being named: x.txt"),
        (left_file, 0, ""),
    ],
)
def test_faults_in_a_folder_are_found(change: Callable[[Path], None], code: int, found: str, tmp_path: Path) -> None:
    folder = tmp_path / INNER
    folder.mkdir(parents=True)
    for name in ("case.toml", "older.nc"):
        (folder / name).write_text("old")
        (folder / name).chmod(0o600)
    before = oracle.snapshot(tmp_path)
    change(folder)
    outcome = Outcome(code, "", "", 0.0, 0.0)
    args = ["run", "x.toml", "-o", "out.nc", "older.nc"]
    faults = oracle.folder_faults(before, oracle.snapshot(tmp_path), outcome, args, INNER)
    assert any(found in fault for fault in faults) if found else faults == []


def test_a_finished_sweep_removes_its_batches_and_leaves_none(tmp_path: Path) -> None:
    store = tmp_path / INNER / "out.nc.batches"
    args, outcome = ["sweep", "case.toml", "-o", "out.nc"], Outcome(0, "", "", 0.0, 0.0)
    (tmp_path / INNER).mkdir(parents=True)
    without = oracle.snapshot(tmp_path)
    store.mkdir()
    (store / "sweep.json").touch()
    with_batches = oracle.snapshot(tmp_path)
    assert oracle.folder_faults(with_batches, without, outcome, args, INNER) == []
    assert "touched without being named" in oracle.folder_faults(without, with_batches, outcome, args, INNER)[0]


@pytest.fixture(scope="module")
def bases(tmp_path_factory: pytest.TempPathFactory) -> Bases:
    """Files that no command makes, and stand-ins for those that one makes."""
    folder = tmp_path_factory.mktemp("bases")
    found = Bases(folder, folder / "cache")
    found.write_texts()
    for name in MADE:
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.touch()
    return found


@pytest.mark.parametrize("kind", ["case", "design", "oil"])
def test_a_seed_gives_the_same_input_each_time(kind: str, bases: Bases, tmp_path: Path) -> None:
    for seed in range(8):
        made = [draw(seed, Box(tmp_path / f"{seed}-{n}", bases), kind) for n in (1, 2)]
        assert made[0] == made[1]
        first, second = (oracle.snapshot(tmp_path / f"{seed}-{n}") for n in (1, 2))
        assert first == second


def test_seeds_differ(bases: Bases, tmp_path: Path) -> None:
    texts = set()
    for seed in range(20):
        box = Box(tmp_path / str(seed), bases)
        draw(seed, box, "case")
        texts.add((box.folder / "case.toml").read_bytes())
    assert len(texts) >= 19


def test_every_kind_can_be_drawn() -> None:
    assert all(weight > 0 for weight, _ in KINDS.values())
    drawn = random.Random(1).choices(list(KINDS), [weight for weight, _ in KINDS.values()], k=5000)
    assert set(drawn) == set(KINDS)


def test_every_option_is_known_to_the_search() -> None:
    """But for the one that takes minutes."""
    given = {f"{name} {word}" for name, command in COMMANDS for option in command.params for word in option.opts}
    known = {f"{name} {word}" for name, words in OPTIONS.items() for word in (*words, "--output", "--without-split")}
    assert {words for words in given if " --" in words} <= known


def test_every_command_gets_odd_options(bases: Bases, tmp_path: Path) -> None:
    """There are words for each command, so that no seed ends the search."""
    drawn = (draw(seed, Box(tmp_path / str(seed), bases), "options").args for seed in range(250))
    assert set(OPTIONS) <= {words[0] for words in drawn if words}


def test_a_file_of_the_old_format_takes_no_room_for_what_is_not_written(tmp_path: Path) -> None:
    """Its format has no compression: a variable of a thousand million numbers would take 8 GB."""
    content = Group(dims={"x": 10**9, "y": 3})
    content.variables = {
        "large": Variable(("x",), None, dtype=np.dtype("f8")),
        "small": Variable(("y",), np.arange(3.0)),
    }
    save(content, tmp_path / "old.nc", "NETCDF3_CLASSIC")
    assert (tmp_path / "old.nc").stat().st_size < 1000
    assert list(load(tmp_path / "old.nc").variables) == ["small"]


def test_a_cut_file_is_no_whole_one(bases: Bases, tmp_path: Path) -> None:
    whole = bases["grid.nc"].read_bytes()
    for name, data in (("a.nc", whole), ("b.nc", whole), ("cut.nc", whole[:-100])):
        (tmp_path / name).write_bytes(data)
    assert equal(content(tmp_path / "a.nc"), content(tmp_path / "b.nc"))
    assert not equal(content(tmp_path / "a.nc"), content(tmp_path / "cut.nc"))


@pytest.mark.thorough
def test_fixed_seeds_find_nothing() -> None:
    """Sixty inputs and a few of the other parts, but for disks that have to be mounted."""
    parts = ["inputs", "analyses", "kill", "fill", "together"]
    words = [sys.executable, str(FUZZ / "fuzz.py"), *parts, "--seed", "1", "--count", "60"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
