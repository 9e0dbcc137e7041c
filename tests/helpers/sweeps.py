"""What tests of sweeps share: a small case, and points that are analysed once."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import pytest
from runs import small

from easeoff.cases import write_case
from easeoff.study.analysis.contact_analysis import Analysis
from easeoff.study.sweep.batch_analysis import _Assembly
from easeoff.study.sweep.sweep_plan import SweepSetup

CASE = small(compliance="shell")
SETTING = "pinion.concave.machine.radial_distance"
assert CASE.pinion.concave is not None
RADIAL = CASE.pinion.concave.machine.radial_distance or 0.0
_ANALYSIS = _Assembly.analysis


def case_file(folder: Path) -> Path:
    """The file of the case."""
    write_case(CASE, folder / "case.toml")
    return folder / "case.toml"


def analyse_points_once(patch: pytest.MonkeyPatch) -> None:
    """Take the analysis of a point from the sweep that had it first: where batches, files or messages are tested."""

    def analysis(own: _Assembly, values: dict[str, Any]) -> Analysis:
        return _analysis(own.setup, tuple(values.items()))

    patch.setattr(_Assembly, "analysis", analysis)


@cache
def _analysis(setup: SweepSetup, values: tuple[tuple[str, Any], ...]) -> Analysis:
    return _ANALYSIS(_Assembly(setup, dict(values)), dict(values))
