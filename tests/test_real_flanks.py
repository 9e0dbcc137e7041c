"""The two examples of the dissertation's chapter 4: shipped grids, sizes and trends of its Tables 4.2 and 4.4."""

from __future__ import annotations

import importlib
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pairs import by_the_dissertation
from runs import output_of, refusal_of

import easeoff
from easeoff.study import measured_file, shipped_deviations

GREATEST = {  # um of missing metal; Kolivand 2009, sections 4.5.1 and 4.5.2
    "fm-11x41-worn-pinion": 10.0,
    "fm-11x41-worn-gear": 5.0,
    "fh-12x41-45-measured-pinion": 50.0,
    "fh-12x41-45-measured-gear": 25.0,
}
CASES = {"worn": "fm-11x41", "measured": "fh-12x41-45"}


@cache
def analysed(example: str, deviating: bool) -> xr.DataTree:
    case = CASES[example]
    files: Any = {m: f"{case}-{example}-{m}" for m in ("pinion", "gear")} if deviating else None
    return easeoff.analyze(by_the_dissertation(case), torques=[200.0], deviations=files)


def growth(example: str) -> tuple[float, float]:
    """Peak to peak with deviations over that without: unloaded, and at 200 N m."""
    trees = [analysed(example, deviating) for deviating in (True, False)]
    unloaded = [float(tree["unloaded"].attrs["peak_to_peak"]) for tree in trees]
    loaded = [float(tree["loaded"].to_dataset()["peak_to_peak"][0]) for tree in trees]
    return unloaded[0] / unloaded[1], loaded[0] / loaded[1]


def test_every_shipped_grid_has_the_greatest_deviation_of_the_dissertation() -> None:
    assert shipped_deviations() == sorted(GREATEST)
    for name, wanted in GREATEST.items():
        grid = measured_file(name)
        missing = -grid["deviation"].values[0]
        # At the edge of the flank; the 5 x 9 grid keeps a tenth clear of it.
        assert 0.75 * wanted < missing.max() <= wanted + 1.0
        assert "made to resemble" in grid.attrs["source"]
        if "measured" in name:
            assert missing.shape == (5, 9)
    # Greatest at heel and top of the pinion, and at toe and root of the gear.
    pinion = -measured_file("fh-12x41-45-measured-pinion")["deviation"].values[0]
    gear = -measured_file("fh-12x41-45-measured-gear")["deviation"].values[0]
    assert np.unravel_index(pinion.argmax(), pinion.shape) == (4, 8)
    assert np.unravel_index(gear.argmax(), gear.shape) == (0, 0)


def test_the_shipped_grids_are_those_of_the_script(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """If not: run docs/make real_flanks."""
    examples = importlib.import_module("real_flanks_examples")
    shipped = examples.FOLDER
    monkeypatch.setattr(examples, "FOLDER", tmp_path)
    examples.write_examples()
    for name in GREATEST:
        made, there = (easeoff.geometry.formats.read_measured_grid(f / f"{name}.csv") for f in (tmp_path, shipped))
        np.testing.assert_array_equal(made["deviation"].values, there["deviation"].values)
        np.testing.assert_allclose(made["position"].values, there["position"].values, rtol=0, atol=2e-7)


def test_worn_flanks_lower_both_errors_and_relieve_the_edge() -> None:
    """Table 4.2: 21.1 to 15.0 and 14.2 to 10.2 urad; figures 4.7 and 4.9: longer lines, less pressure at the root."""
    unloaded, loaded = growth("worn")
    assert unloaded == pytest.approx(15.0 / 21.1, abs=0.05)
    assert loaded == pytest.approx(10.2 / 14.2, abs=0.05)
    pressures, lengths = [], []
    for deviating in (False, True):
        tree = analysed("worn", deviating)
        here = tree["loaded"].to_dataset()
        t, h = here["lengthwise"], here["profile"]
        edges = (h < 0.2, h > 0.8, t < 0.2, t > 0.8, h >= 0.0)
        pressures.append([float(here["pressure"].where(edge).max()) for edge in edges])
        lengths.append(float(tree["unloaded"]["line_length"].sel(pair=0).mean()))
    share = np.divide(pressures[1], pressures[0])
    assert share[0] < 0.7  # the gear's root
    assert np.all(share[1:] < 1.06)  # and hardly another edge pays for it: 5 % at heel and tip
    assert lengths[1] > 1.05 * lengths[0]


@pytest.mark.thorough
def test_the_measured_deviation_raises_both_errors_and_moves_the_contact_to_the_heel() -> None:
    """Table 4.4: 36.9 to 61.5 and 23.9 to 29.8 urad; figures 4.11, 4.12 and 4.14."""
    unloaded, loaded = growth("measured")
    assert unloaded == pytest.approx(61.5 / 36.9, abs=0.12)
    assert loaded == pytest.approx(29.8 / 23.9, abs=0.12)
    trees = [analysed("measured", deviating) for deviating in (False, True)]
    centres = [float(tree["unloaded"]["path_lengthwise"].sel(pair=0).mean()) for tree in trees]
    assert 0.005 < centres[1] - centres[0] < 0.05
    peaks = [float(tree["loaded"].to_dataset()["max_pressure"][0]) for tree in trees]
    assert peaks[1] == pytest.approx(peaks[0], rel=0.1)


@pytest.mark.thorough
def test_the_measured_deviations_compensate_one_another() -> None:
    """Figure 4.11: either alone changes the ease-off more than both together do."""
    case = CASES["measured"]
    changes = []
    for members in (("pinion",), ("gear",), ("pinion", "gear")):
        files: Any = {m: f"{case}-measured-{m}" for m in members}
        ease_off = easeoff.analyze(case, torques=[200.0], deviations=files)["ease_off"]
        changes.append(float(ease_off["ease_off_change"].where(ease_off["inside"] == 1).std()))
    assert changes[2] < 0.7 * min(changes[:2])


@pytest.mark.thorough
def test_the_update_stands_up_to_the_surfaces_on_both_examples() -> None:
    for example, case in CASES.items():
        files: Any = {m: f"{case}-{example}-{m}" for m in ("pinion", "gear")}
        exact = easeoff.analyze(case, torques=[200.0], deviations=files, deviated="surface")
        update = easeoff.analyze(case, torques=[200.0], deviations=files)
        swing = [t["unloaded"].attrs["peak_to_peak"] for t in (update, exact)]
        assert swing[0] == pytest.approx(swing[1], abs=0.6)
        ours, theirs = (float(t["loaded"].to_dataset()["max_pressure"][0]) for t in (update, exact))
        assert ours == pytest.approx(theirs, rel=0.02)
        assert np.all(exact["loaded"]["status"].values == 0)


def test_the_command_line_names_errors_and_corrections() -> None:
    said = output_of("correct", "fh-12x41-45", "--deviation", "gear=fh-12x41-45-measured-gear")
    for word in ("twist", "pressure_angle", "machine_root_angle", "after the correction"):
        assert word in said
    missing = refusal_of("correct", "fh-12x41-45", "--deviation", "gear=nothing")
    assert "the shipped ones are: fh-12x41-45-measured-gear" in missing
