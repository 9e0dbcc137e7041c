"""Nodes that scatter: flanks without line contact are refused with a way out, and the smooth surface is one."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from runs import output_of, refusal_of, small

import easeoff
from easeoff import GeometryError
from easeoff.cases import Case, gear_pair, write_case
from easeoff.geometry import GearPair, named_member
from easeoff.geometry.formats import cmm_points, measured_grid, write_measured_grid

NOISE = 3.0  # um


@cache
def small_case() -> Case:
    """With as many nodes as show the noise."""
    return small("fm-11x41", "shell", lengthwise_nodes=31, profile_nodes=21)


@cache
def pair() -> GearPair:
    return gear_pair(small_case(), "drive")


def noisy(member: str, size: tuple[int, int], noise: float = NOISE) -> xr.Dataset:
    return measured_grid(
        cmm_points(named_member(pair(), member), *size), noise * np.random.default_rng(0).normal(size=size)
    )


@pytest.mark.parametrize(
    ("member", "size"), [("pinion", (5, 9)), ("pinion", (15, 25)), ("gear", (5, 9)), ("gear", (15, 25))]
)
@pytest.mark.quick(1)
def test_noise_is_refused_or_harmless_never_wrong(member: str, size: tuple[int, int]) -> None:
    """Either the update and the flanks themselves agree, or both are refused and say of which member and what to do."""
    deviations = {member: noisy(member, size)}
    smooth = easeoff.analyze(small_case(), torques=[200.0], deviations=deviations, interpolation="smooth")  # type: ignore[arg-type]
    assert smooth["unloaded"].attrs["peak_to_peak"] < 60.0
    found, refusals = [], []
    for way in ("ease_off", "surface"):
        try:
            tree = easeoff.analyze(small_case(), torques=[200.0], deviations=deviations, deviated=way)  # type: ignore[arg-type]
            found.append(float(tree["unloaded"].attrs["peak_to_peak"]))
        except GeometryError as error:
            refusals.append(str(error))
    for refusal in refusals:
        for part in ("no line contact", f"flank of the {member}", "interpolation 'smooth'"):
            assert part in refusal
    assert len(found) in (0, 2)
    if found:
        assert found[0] == pytest.approx(found[1], rel=0.02)
    if size == (15, 25):
        assert not found


def test_the_member_that_scatters_is_named() -> None:
    both = {"pinion": noisy("pinion", (15, 25), 0.3), "gear": noisy("gear", (15, 25), 3.0)}
    with pytest.raises(GeometryError, match=r"flank of the gear .* scatters by (2|3)\.\d um"):
        easeoff.analyze(small_case(), torques=[200.0], deviations=both)  # type: ignore[arg-type]


def test_smoothing_keeps_a_smooth_deviation_and_loses_noise() -> None:
    """The contact of a global error with noise, smoothed, is near that without."""
    size = (15, 25)
    points = cmm_points(pair().gear, *size)
    place = points["position"].values[0]
    t, h = pair().gear.section.fractions(place[..., 2], np.hypot(place[..., 0], place[..., 1]))
    form = 8.0 * (2 * t - 1) * (2 * h - 1) - 6.0 * (2 * t - 1) ** 2
    noise = np.random.default_rng(5).normal(size=size)
    swings = []
    for values, way in ((form, "spline"), (form, "smooth"), (form + noise, "smooth")):
        grid = measured_grid(points, values)
        tree = easeoff.analyze(small_case(), torques=[200.0], deviations={"gear": grid}, interpolation=way)  # type: ignore[arg-type]
        swings.append(float(tree["unloaded"].attrs["peak_to_peak"]))
    assert swings[1] == pytest.approx(swings[0], abs=0.2)  # rows and columns are not quite the fractions of the form
    assert swings[2] == pytest.approx(swings[0], abs=2.0)


def test_the_command_line_says_so_and_smooths(tmp_path: Path) -> None:
    write_case(small_case(), tmp_path / "case.toml")
    write_measured_grid(noisy("pinion", (15, 25)), tmp_path / "pinion.csv")
    common = ["run", tmp_path / "case.toml", "--torque", "200", "--deviation", f"pinion={tmp_path / 'pinion.csv'}"]
    out = tmp_path / "out.nc"
    assert "flank of the pinion" in refusal_of(*common, "-o", out)
    assert not out.exists()
    output_of(*common, "--interpolation", "smooth", "-o", out)
