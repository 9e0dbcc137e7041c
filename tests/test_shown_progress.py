"""Progress in Python: a line for True, calls of a function, and what is neither is refused before any work."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
import tqdm.auto
from runs import small_text

import easeoff
from easeoff.cases import parse_case
from easeoff.core.errors import InputError
from easeoff.study import WearLaw, analyze_load_cases, vh_check, wear

FUNCTIONS = (easeoff.analyze, easeoff.modify, easeoff.optimize, easeoff.sweep, analyze_load_cases, vh_check, wear)


def coarse() -> easeoff.Case:
    return parse_case(small_text(more='\n[compliance]\nmodel = "shell"\n'))


@pytest.mark.parametrize("function", FUNCTIONS)
def test_what_is_no_function_is_refused_before_any_work(function: Callable[..., Any]) -> None:
    assert "progress" in inspect.signature(function).parameters
    with pytest.raises(InputError, match="progress = 'yes': must be True, False, or a function"):
        function("no such case", progress="yes")


def test_a_line_is_shown_without_a_terminal(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("EASEOFF_PROGRESS", raising=False)
    monkeypatch.setattr("easeoff.study.cli.terminal.terminal_bar.FIRST_LINE", 0.0)
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
