"""Run an input in a process of its own, forked or fresh, with limits of time, memory and file size."""

from __future__ import annotations

import contextlib
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

PROCESSOR_TIME_LIMIT = 60  # [s] of a process
WALL_TIME_LIMIT = 240.0  # [s], in which a process that waits for ever is found
MEMORY_LIMIT = 3 * 2**30  # [bytes] beyond what the parent of a forked process takes, or of address space of a fresh one
FILE_SIZE_LIMIT = 2**30  # [bytes] of a written file
END_TIME_LIMIT = 10.0  # [s] in which processes started by an ended one must be gone

#: What the console script runs, without the current folder on the path of modules.
CONSOLE_SCRIPT = "import sys; sys.argv[0] = 'easeoff'; from easeoff.study.cli import program; program()"
FRESH = [sys.executable, "-P", "-c", CONSOLE_SCRIPT]


@dataclass(frozen=True)
class Limits:
    """Limits of a process."""

    processor_time: int = PROCESSOR_TIME_LIMIT
    wall_time: float = WALL_TIME_LIMIT
    memory: int = MEMORY_LIMIT
    file_size: int = FILE_SIZE_LIMIT


@dataclass(frozen=True)
class Outcome:
    """How a process ended and what it wrote.

    Attributes
    ----------
    code
        Exit code; minus the signal that ended it.
    stdout, stderr
        What it wrote.
    processor_time
        Of it and the processes that it waited for [s].
    wall_time
        From start to end [s].
    late
        It was ended from outside because it did not end by itself.
    orphans
        Processes that it started still ran after it.
    """

    code: int
    stdout: str
    stderr: str
    processor_time: float
    wall_time: float
    late: bool = False
    orphans: bool = False

    @property
    def hung(self) -> bool:
        """Whether a limit of time ended it."""
        return self.late or self.code == -signal.SIGXCPU


def command_line(args: Sequence[str]) -> Callable[[], None]:
    """The command line of easeoff as a call, for ``forked``."""

    def call() -> None:
        from easeoff.study.cli import main

        main(list(args), prog_name="easeoff")

    return call


def forked(
    call: Callable[[], None], folder: Path, limits: Limits | None = None, environment: Mapping[str, str] | None = None
) -> Outcome:
    """Run a call in a forked process, which finds everything imported that its parent has imported."""
    return _watched(lambda: _child(call, folder, environment or {}, limits or Limits(), None), limits or Limits())


def fresh(
    args: Sequence[str], folder: Path, limits: Limits | None = None, environment: Mapping[str, str] | None = None
) -> Outcome:
    """Run the command line in a fresh interpreter."""
    words = [*FRESH, *args]
    return _watched(lambda: _child(None, folder, environment or {}, limits or Limits(), words), limits or Limits())


def start(
    call: Callable[[], None], folder: Path, limits: Limits | None = None, environment: Mapping[str, str] | None = None
) -> int:
    """Start a call in a forked process whose output is discarded; return its number."""
    pid = os.fork()
    if pid == 0:
        nowhere = os.open(os.devnull, os.O_RDWR)
        _redirect(nowhere, nowhere)
        _child(call, folder, environment or {}, limits or Limits(), None)
    return pid


def _watched(child: Callable[[], None], limits: Limits) -> Outcome:
    """Outcome of a child whose output goes into pipes: no limit of the size of files is one of theirs."""
    pipes = [os.pipe(), os.pipe()]
    began = time.monotonic()
    pid = os.fork()
    if pid == 0:
        _redirect(pipes[0][1], pipes[1][1])
        child()
    for source, sink in pipes:
        os.close(sink)
        os.set_blocking(source, False)
    sources = [source for source, _ in pipes]
    read: list[list[bytes]] = [[], []]
    outcome = _wait(pid, began, limits, lambda: _drain(sources, read))
    for source in sources:
        os.close(source)
    out, err = (b"".join(parts).decode("utf-8", "backslashreplace") for parts in read)
    return replace(outcome, stdout=out, stderr=err)


def _drain(sources: list[int], read: list[list[bytes]]) -> None:
    """Read what is in pipes without waiting for more."""
    for source, parts in zip(sources, read, strict=True):
        with contextlib.suppress(BlockingIOError):
            while part := os.read(source, 2**16):
                parts.append(part)


def _redirect(out: int, err: int) -> None:
    os.setsid()
    null = os.open(os.devnull, os.O_RDONLY)
    for source, target in ((null, 0), (out, 1), (err, 2)):
        os.dup2(source, target)


def _child(
    call: Callable[[], None] | None,
    folder: Path,
    environment: Mapping[str, str],
    limits: Limits,
    words: list[str] | None,
) -> None:
    """Become the process: never returns."""
    code = 1
    try:
        os.chdir(folder)
        os.environ.update(environment)
        tempfile.tempdir = None  # found anew from the environment
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (limits.processor_time, limits.processor_time + 5))
        taken = 0 if words else _address_space()
        resource.setrlimit(resource.RLIMIT_AS, (taken + limits.memory,) * 2)
        resource.setrlimit(resource.RLIMIT_FSIZE, (limits.file_size,) * 2)
        if words:
            signal.signal(signal.SIGXFSZ, signal.SIG_DFL)  # the new interpreter ignores it by itself
            os.execv(words[0], words)
        assert call is not None
        # As a new interpreter has them, whatever the parent made of its own.
        sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
        sys.stderr = open(2, "w", encoding="utf-8", errors="backslashreplace", closefd=False)  # noqa: SIM115
        call()
        code = 0
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 0 if end.code is None else 1
        if isinstance(end.code, str):
            sys.stderr.write(end.code)
    except BaseException:
        traceback.print_exc()
    finally:
        for stream in (sys.stdout, sys.stderr):
            try:
                stream.flush()
            except OSError:
                code = 120  # as the interpreter does
        os._exit(code)


def _address_space() -> int:
    """Size of this process's address space [bytes]; 2 GB where the system does not tell."""
    try:
        return int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    except OSError:
        return 2**31


def _wait(pid: int, began: float, limits: Limits, drain: Callable[[], None]) -> Outcome:
    pause, late = 0.002, False
    while True:
        drain()
        found, status, usage = os.wait4(pid, os.WNOHANG)
        if found:
            break
        if time.monotonic() - began > limits.wall_time and not late:
            late = True
            _end_group(pid)
        time.sleep(pause)
        pause = min(pause * 1.5, 0.05)
    wall = time.monotonic() - began
    ended = time.monotonic()
    while _group_runs(pid) and time.monotonic() - ended < END_TIME_LIMIT:
        time.sleep(0.02)
    orphans = _group_runs(pid) and not late
    _end_group(pid)
    drain()
    code = os.waitstatus_to_exitcode(status)
    return Outcome(code, "", "", usage.ru_utime + usage.ru_stime, wall, late, orphans)


def _group_runs(pid: int) -> bool:
    try:
        os.killpg(pid, 0)
    except OSError:
        return False
    return True


def _end_group(pid: int) -> None:
    with contextlib.suppress(OSError):
        os.killpg(pid, signal.SIGKILL)
