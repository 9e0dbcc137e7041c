"""Faults while a command writes: it is killed, the disk is full, or others write the same at the same time."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import time
from pathlib import Path

from bases import Bases
from processes import Limits, Outcome, command_line, forked, start
from writing_runs import OLDER, Reference, Stage, WritingRun, content, equal

WAIT_LIMIT = 120.0  # [s] for a run to begin to write


def kill(rng: random.Random, run: WritingRun, reference: Reference, bases: Bases, work: Path) -> list[str]:
    """Kill a run at a random moment, mostly while it writes, and run it again."""
    stage = Stage(work / "killed", run, bases)
    began = time.monotonic()
    pid = start(command_line(run.words.split()), stage.folder, environment=stage.environment)
    if rng.random() < 0.35:
        time.sleep(rng.uniform(0.0, 1.05 * reference.time))
    else:
        known = _listing(stage)
        while _listing(stage) == known and time.monotonic() - began < WAIT_LIMIT and not _ended(pid):
            time.sleep(0.0005)
        time.sleep(rng.choice([0.0, 0.0, 0.001, 0.005, 0.02, 0.05, 0.2]))
    _kill_group(pid)
    faults = _states_between(stage, reference)
    outcome = stage.again()
    if outcome.code != reference.code:
        faults.append(f"exit code {outcome.code} of the rerun: {outcome.stderr.strip()[-200:]}")
    elif not reference.same(stage.contents()):
        faults.append("the rerun writes something else")
    remains = stage.remains()
    if remains:
        faults.append(f"the rerun leaves remains of the killed run: {', '.join(remains[:3])}")
    stage.clear()
    return faults


def fill(rng: random.Random, run: WritingRun, reference: Reference, bases: Bases, work: Path) -> list[str]:
    """Let a file grow to a random size and no further."""
    stage = Stage(work / "filled", run, bases)
    size = rng.choice([0, 1, 100, 4096, rng.randrange(max(reference.size, 1)), rng.randrange(max(reference.size, 1))])
    words = command_line(run.words.split())
    outcome = forked(words, stage.folder, Limits(file_size=size), environment=stage.environment)
    faults = _faults_of_a_full_disk(outcome, stage, reference)
    stage.clear()
    return [f"files of at most {size} bytes: {fault}" for fault in faults]


def fill_disk(rng: random.Random, run: WritingRun, reference: Reference, bases: Bases, work: Path) -> list[str] | None:
    """Let the disk be full after a random size; ``None`` where no disk can be mounted."""
    stage = Stage(work / "disk", run, bases, older=False)
    disk = stage.folder / "disk"
    disk.mkdir()
    size = rng.choice([4096, 16384, 4096 * rng.randint(2, 2 + reference.size // 2048)])
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(disk)], capture_output=True, check=False
    )
    if mounted.returncode != 0:
        stage.clear()
        return None
    try:
        words = [f"disk/{word}" if word in run.outputs else word for word in run.words.split()]
        outcome = forked(command_line(words), stage.folder, environment=stage.environment)
        left = [str(path.relative_to(disk)) for path in disk.rglob("*") if path.is_file()]
        left = [name for name in left if not name.startswith("out.nc.batches/")]  # a sweep goes on from them
        faults = _faults_of_an_end(outcome)
        remains = [name for name in left if Path(name).name.startswith(".") or name.endswith(".tmp")]
        if outcome.code == 2 and len(run.outputs) == 1 and Path(run.outputs[0]).suffix:
            remains = left
        elif outcome.code == 2:  # of several outputs the first may be there, whole
            whole = reference.contents
            left = [name for name in left if whole.get(name, "") is not None]  # ``None``: no two runs write it alike
            remains += [name for name in left if not equal(content(disk / name), whole.get(name))]
        if remains:
            faults.append(f"left behind: {', '.join(remains[:3])}")
    finally:
        subprocess.run(["umount", str(disk)], check=True)
    stage.clear()
    return [f"a disk of {size} bytes: {fault}" for fault in faults]


def together(rng: random.Random, run: WritingRun, reference: Reference, bases: Bases, work: Path) -> list[str]:
    """Run the same command several times at once, with the same outputs and the same cache."""
    stage = Stage(work / "together", run, bases)
    pids = []
    for _ in range(rng.choice([2, 3, 4])):
        pids.append(start(command_line(run.words.split()), stage.folder, environment=stage.environment))
        time.sleep(rng.choice([0.0, 0.0, 0.02, 0.5 * reference.time]))
    codes = [os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) for pid in pids]
    faults = [f"exit codes {codes}"] if any(code not in (reference.code, 2) for code in codes) or 2 in codes else []
    if not reference.same(stage.contents()):
        faults.append("the output is not that of one run")
    if stage.remains():
        faults.append(f"left behind: {', '.join(stage.remains()[:3])}")
    stage.clear()
    return faults


def _states_between(stage: Stage, reference: Reference) -> list[str]:
    """Whether each output is the old file or a whole new one."""
    faults = []
    for name in stage.run.outputs:
        path = stage.folder / name
        if Path(name).suffix:
            if not path.is_file():
                faults.append(f"the old {name} is gone")
            elif path.read_bytes() != OLDER:
                new = reference.contents[name]
                found = content(path)
                if not (equal(found, new) if new is not None else found and "damaged" not in str(found)[:8]):
                    faults.append(f"{name} is neither the old file nor a whole new one")
        elif path.is_dir():
            for file in path.rglob("*"):
                known = reference.contents.get(str(file.relative_to(stage.folder)))
                if file.is_file() and known is not None and not equal(content(file), known):
                    faults.append(f"{name}/{file.name} is not whole")
    return faults


def _faults_of_a_full_disk(outcome: Outcome, stage: Stage, reference: Reference) -> list[str]:
    faults = _faults_of_an_end(outcome)
    if outcome.code == reference.code != 2:
        if not reference.same(stage.contents()):
            faults.append(f"exit code {outcome.code}, but the output is not whole")
    else:
        for name in stage.run.outputs:
            path = stage.folder / name
            if Path(name).suffix and (not path.is_file() or path.read_bytes() != OLDER) and len(stage.run.outputs) == 1:
                faults.append(f"the old {name} is not intact")
    remains = [name for name in stage.remains() if name not in ("study", "parts", "pictures", "out.nc.batches")]
    return faults + ([f"left behind: {', '.join(remains[:3])}"] if remains else [])


def _faults_of_an_end(outcome: Outcome) -> list[str]:
    from oracle import place

    if "Traceback (most recent call last)" in outcome.stderr:
        return [f"traceback at {place(outcome.stderr)}: {outcome.stderr.strip().splitlines()[-1][:160]}"]
    if outcome.code not in (0, 1, 2):
        return [f"exit code {outcome.code}: {outcome.stderr.strip()[-160:]}"]
    if outcome.code == 2 and "Error: " not in outcome.stderr:
        return ["exit code 2 without a message"]
    return []


def _listing(stage: Stage) -> set[str]:
    """Names in the folder, in those within, and in the cache."""
    found: set[str] = set()
    for folder in (stage.folder, stage.cache):
        for root, folders, files in os.walk(folder):
            found.update(os.path.join(root, name) for name in (*folders, *files))
    return found


def _ended(pid: int) -> bool:
    """Whether a child has ended; it stays there to be waited for."""
    return os.waitid(os.P_PID, pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None


def _kill_group(pid: int) -> None:
    try:
        os.killpg(pid, signal.SIGKILL)
    except OSError:  # it has no group yet
        os.kill(pid, signal.SIGKILL)
    os.waitpid(pid, 0)
