"""Progress, of commands and in Python: lines where there is no terminal, by a clock of the test; what the end says."""

from __future__ import annotations

import inspect
import os
import subprocess
import sys
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import tqdm.auto
from runs import SHELLS, call, small, small_text

import easeoff
from easeoff.cases import parse_case, write_case
from easeoff.core.errors import InputError
from easeoff.study import WearLaw, analyze_load_cases, vh_check, wear
from easeoff.study.cli.case_run import TOOTH_STAGES, show_stage
from easeoff.study.progress import LEAST_INTERVAL, ProgressLines, terminal_bar, working


class Clock:
    """A clock that goes when it is told to."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    found = Clock()
    monkeypatch.setattr("easeoff.study.progress.time.perf_counter", found)
    monkeypatch.delenv("EASEOFF_PROGRESS", raising=False)
    return found


def lines(capsys: pytest.CaptureFixture[str]) -> list[str]:
    out, err = capsys.readouterr()
    assert out == ""
    return err.splitlines()


def test_what_is_quick_says_nothing(clock: Clock, capsys: pytest.CaptureFixture[str]) -> None:
    with terminal_bar(total=100, desc="loaded contact", unit="solve") as bar:
        for _ in range(100):
            clock.now += 0.019
            bar.update(1)
    assert lines(capsys) == []


def test_the_first_line_comes_after_two_seconds_and_then_ever_fewer(
    clock: Clock, capsys: pytest.CaptureFixture[str]
) -> None:
    at = []
    with terminal_bar(total=1000, desc="loaded contact", unit="solve") as bar:
        for step in range(1000):
            clock.now += 0.5
            bar.update(1)
            if found := lines(capsys):
                at.append(0.5 * (step + 1))
                if len(at) == 2:
                    assert found == ["loaded contact: 14 of 1000 solves, 7 s"]
                if at[-1] > 15.0:
                    left = float(found[0].split("about ")[1].split()[0])
                    assert "s left" in found[0] or "min left" in found[0]
                    assert left > 0.0
    assert at[0] == 2.0
    gaps = [later - earlier for earlier, later in pairwise(at)]
    assert gaps[0] == LEAST_INTERVAL
    assert gaps == sorted(gaps)
    assert len(at) < 20


def test_a_stage_after_two_seconds_is_named_at_once_and_its_time_is_its_own(
    clock: Clock, capsys: pytest.CaptureFixture[str]
) -> None:
    bar = ProgressLines("elastic teeth", total=10, unit="solve")
    bar.set_description_str("geometry")
    assert lines(capsys) == []
    clock.now += 30.0
    bar.reset()
    bar.set_description_str("loaded contact")
    assert lines(capsys) == ["loaded contact: 10 solves ..."]
    clock.now += 20.0
    bar.update(5)
    assert lines(capsys) == ["loaded contact: 5 of 10 solves, 20 s, about 20 s left"]
    bar.total = None
    bar.set_postfix_str("speed 3")
    clock.now += 100.0
    bar.update(1)
    assert lines(capsys) == ["loaded contact, speed 3: 6 solves, 120 s"]


def test_nothing_is_foretold_before_three_steps(clock: Clock) -> None:
    bar = ProgressLines("loaded contact", total=32, unit="solve")
    bar.n = 2
    assert bar.words(224.0) == "loaded contact: 2 of 32 solves, 224 s"
    bar.n = 3
    assert bar.words(224.0).endswith(" left")


def test_teeth_are_built_in_a_stage_without_solves(clock: Clock, capsys: pytest.CaptureFixture[str]) -> None:
    bar = ProgressLines("geometry", total=32, unit="solve")
    clock.now += 30.0
    show_stage(bar, f"{TOOTH_STAGES[0]} of the pinion")
    show_stage(bar, "loaded contact")
    assert lines(capsys) == ["solid shell of the pinion ...", "loaded contact: 32 solves ..."]


def test_what_has_no_steps_is_said_at_once(clock: Clock, capsys: pytest.CaptureFixture[str]) -> None:
    with working("drawing the pictures"):
        assert lines(capsys) == ["drawing the pictures ..."]
    assert lines(capsys) == []


def test_lines_are_switched_off(
    clock: Clock, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("EASEOFF_PROGRESS", "off")
    with working("drawing"), terminal_bar(total=2) as bar:
        clock.now += 1e3
        bar.update(1)
    assert lines(capsys) == []


def test_a_full_disk_behind_the_lines_stops_nothing(clock: Clock, monkeypatch: pytest.MonkeyPatch) -> None:
    class Full:
        def isatty(self) -> bool:
            return False

        def write(self, text: str) -> int:
            raise OSError(28, "No space left on device")

        def flush(self) -> None:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(sys, "stderr", Full())
    with working("drawing"):
        pass
    monkeypatch.setattr(sys, "stderr", None)
    with working("drawing"), terminal_bar(total=1) as bar:
        bar.update(1)


@pytest.mark.thorough
def test_commands_without_a_terminal_say_what_they_do_and_what_comes_next(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    write_case(small(lengthwise_nodes=11, profile_nodes=9), "small.toml")
    environment = {**os.environ, "EASEOFF_PROGRESS": ""}
    words = ["export", "small.toml", "-o", "teeth.csv"]
    command = [sys.executable, "-c", "from easeoff.study.cli import main; main()", *words]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    assert done.stderr.splitlines() == ["teeth of the pinion ..."]
    assert done.stdout.startswith("wrote teeth.csv")
    ends = {
        ("run", "small.toml", "-o", "out.nc", "--torque", "100"): "next: easeoff show out.nc, or easeoff plot out.nc",
        ("problems", "small.toml", "-o", "p.nc", "--torque", "100"): "next: easeoff compare p.nc",
        ("report", "out.nc", "-o", "r.html"): "next: open it in a browser",
        ("vh", "small.toml", "-o", "vh.nc"): "next: easeoff plot vh.nc FOLDER",
        ("wear", "small.toml", "--torque", "100", "--revolutions", "10", "-o", "w.nc"): "next: easeoff run small.toml",
    }
    for words_of, end in ends.items():
        made = call(*words_of)
        assert made.exit_code in (0, 1), made.output
        assert made.stdout.splitlines()[-1].startswith(end), made.output


# Progress in Python: a line for True, calls of a function, and what is neither is refused before any work


FUNCTIONS = (easeoff.analyze, easeoff.modify, easeoff.optimize, easeoff.sweep, analyze_load_cases, vh_check, wear)


def coarse() -> easeoff.Case:
    return parse_case(small_text(more=SHELLS))


@pytest.mark.parametrize("function", FUNCTIONS)
def test_what_is_no_function_is_refused_before_any_work(function: Callable[..., Any]) -> None:
    assert "progress" in inspect.signature(function).parameters
    with pytest.raises(InputError, match="progress = 'yes': must be True, False, or a function"):
        function("no such case", progress="yes")


def test_a_line_is_shown_without_a_terminal(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("EASEOFF_PROGRESS", raising=False)
    monkeypatch.setattr("easeoff.study.progress.FIRST_LINE", 0.0)
    easeoff.analyze(coarse(), torques=[100.0], progress=True)
    assert "loaded contact" in capsys.readouterr().err
    easeoff.analyze(coarse(), torques=[100.0])
    assert capsys.readouterr().err == ""


def test_a_notebook_has_a_bar_of_tqdm(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[Any] = []

    class Bar:
        """A bar that keeps what it is told."""

        monitor_interval = 10
        total, n = None, 0

        def __init__(self, **options: Any) -> None:
            self.options = options
            seen.append(self)

        def __enter__(self) -> Bar:
            return self

        def __exit__(self, *_: object) -> None:
            return None

        def update(self, steps: int) -> None:
            self.n += steps

    monkeypatch.setitem(sys.modules, "ipykernel", SimpleNamespace())
    monkeypatch.setattr(tqdm.auto, "tqdm", Bar)
    easeoff.sweep(coarse(), {"E": [0.0, 0.02]}, torques=[50.0], workers=1, progress=True)
    assert Bar.monitor_interval == 0  # a thread may end the process
    assert (seen[0].n, seen[0].total, seen[0].options) == (2, 2, {"desc": "sweep", "unit": "point", "leave": False})


def test_a_sweep_counts_its_points(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[tuple[int, int]] = []
    over = {"E": [0.0, 0.02], "torque": [50.0, 100.0]}
    found = easeoff.sweep(coarse(), over, workers=1, progress=lambda done, points: calls.append((done, points)))
    assert calls[-1] == (found["status"].size, found["status"].size) == (4, 4)
    assert [done for done, _ in calls] == sorted(done for done, _ in calls)


def test_wear_of_no_progress_is_that_of_a_function() -> None:
    law, seen = WearLaw(1e-12, 1e-12, 1e5), list[float]()
    history = wear(coarse(), law, torque=100.0, progress=seen.append)
    assert seen == history["revolutions"].values[1:].tolist()
    assert wear(coarse(), law, torque=100.0, progress=False).equals(history)
