"""Flanks that bend over a short way, and nodes that scatter: no gap is wild; no line contact is told with a way out."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from runs import output_of, refusal_of, small

import easeoff
from easeoff import GeometryError
from easeoff.cases import Case, gear_pair, write_case
from easeoff.contact import lines_in_mesh
from easeoff.contact.lines.closest_approach import ClosestApproach, closest_approach, one_step
from easeoff.contact.lines.mesh_lines import gauss_points, lost_contact
from easeoff.geometry import Deviation, GearPair, deviation_from_formula
from easeoff.geometry.deviation.deviated_flank import deviated_pair
from easeoff.geometry.formats import cmm_points, measured_grid, write_measured_grid
from easeoff.geometry.tooth.tooth_flanks import named_member
from easeoff.study.deviations import require_line_contact
from easeoff.verification import FlanksInMesh, flanks_in_mesh
from easeoff.verification.surface_cells import exact_gap

Array = NDArray[np.float64]
CORNER = (0.95, 0.20)  # of the gear flank; most gaps there are open
DEEP = {"slight": 9.0, "deep": 10.0}  # um


@cache
def designed() -> GearPair:
    return gear_pair(easeoff.read_case("fm-11x41"))


@cache
def dent(depth: float) -> Deviation:
    """A smooth dent of the gear, in which c + a'' comes near to zero."""
    section = designed().gear.section
    return deviation_from_formula(
        section, lambda t, h: -depth * np.exp(-(((t - CORNER[0]) / 0.12) ** 2) - ((h - CORNER[1]) / 0.08) ** 2)
    )


@cache
def flanks(depth: float) -> FlanksInMesh:
    return flanks_in_mesh(deviated_pair(designed(), gear=dent(depth)))


@cache
def points(depth: float) -> Array:
    here = flanks(depth)
    return gauss_points(lines_in_mesh(here.splines, here.pair.assembly.pinion_pitch, 8).lines, 15)[0].reshape(2, -1)


@cache
def found(depth: float) -> ClosestApproach:
    return closest_approach(flanks(depth).splines, points(depth))


def least_gap(depth: float, chosen: Array) -> Array:
    """Least gap [rad] between the surfaces across the contact curve through points (2, n), by rays along the normal."""
    here = flanks(depth)
    rotation = here.splines("roll_angle", chosen)
    slope = np.stack([here.splines("roll_angle", chosen, d) for d in ((1, 0), (0, 1))])
    position = [here.splines("position", chosen, d) for d in ((1, 0), (0, 1))]
    e, f, g = (np.sum(position[i] * position[j], axis=0) for i, j in ((0, 0), (0, 1), (1, 1)))
    across = np.stack([g * slope[0] - f * slope[1], e * slope[1] - f * slope[0]])
    across /= np.max(np.abs(across), axis=0)
    gaps = []
    for n in range(chosen.shape[1]):
        way = np.linspace(-0.1, 0.1, 201)
        place = chosen[:, n, None] + across[:, n, None] * way
        place = place[:, np.all((place >= 0.0) & (place <= 1.0), axis=0)]
        gap, _ = exact_gap(here, place, np.full(place.shape[1], rotation[n]))
        gaps.append(np.nanmin(gap))
    return np.array(gaps)


@pytest.mark.parametrize("depth", DEEP.values(), ids=DEEP)
def test_one_step_goes_wild_and_is_not_taken(depth: float) -> None:
    """The step alone is wrong by hundreds of microradians or even far below zero; the search is between bounds."""
    step = one_step(flanks(depth).splines, points(depth))
    lost = ~step.expanded
    assert 2 <= np.count_nonzero(lost) <= 20
    assert 1e6 * np.abs(step.separation_angle - found(depth).separation_angle).max() > 100.0
    on_curve = flanks(depth).splines("ease_off_angle", points(depth))
    corner = np.linspace(0.0, 1.0, 201)
    least = flanks(depth).splines("ease_off_angle", np.stack(np.meshgrid(corner, corner, indexing="ij"))).min()
    assert np.all(found(depth).separation_angle[lost] <= on_curve[lost])
    assert np.all(found(depth).separation_angle > least - 1e-6)


@pytest.mark.parametrize("depth", DEEP.values(), ids=DEEP)
def test_the_gap_found_is_that_between_the_surfaces(depth: float) -> None:
    """Rays from flank to flank, which know nothing of ease-off and roll angle, find the same gap; the step does not."""
    step = one_step(flanks(depth).splines, points(depth))
    lost = ~step.expanded
    exact = least_gap(depth, points(depth)[:, lost])
    np.testing.assert_allclose(found(depth).separation_angle[lost], exact, rtol=0.01)
    assert 1e6 * np.abs(step.separation_angle[lost] - exact).max() > 100.0


def test_elsewhere_the_step_is_kept_to_the_last_digit() -> None:
    for name in ("separation_angle", "shift", "curvature"):
        step, whole = (getattr(one, name) for one in (one_step(flanks(9.0).splines, points(9.0)), found(9.0)))
        kept = found(9.0).expanded
        np.testing.assert_array_equal(whole[..., kept], step[..., kept])
    plain = flanks_in_mesh(designed())
    mesh = lines_in_mesh(plain.splines, plain.pair.assembly.pinion_pitch, 8)
    assert np.all(closest_approach(plain.splines, mesh.lines.points).expanded)
    assert lost_contact(plain.splines, mesh) == 0.0


def test_the_loaded_contact_stays_as_it_is_next_to_such_a_place() -> None:
    """A corner that hardly carries: update and surfaces agree, and the result says how many segments were searched."""
    case = small("fm-11x41", "shell", mesh_positions=8, segments_per_line=15, lengthwise_nodes=31, profile_nodes=21)
    swings, levels = [], []
    for deviations in ({}, {"gear": dent(9.0)}):
        for way in ("ease_off", "surface"):
            tree = easeoff.analyze(case, torques=[200.0], deviations=deviations, deviated=way)  # type: ignore[arg-type]
            loaded = tree["loaded"].to_dataset()
            assert (int(loaded.attrs["searched_segments"]) > 0) == bool(deviations)
            assert float(loaded["separation"].min()) > -1e-4  # mm
            swings.append(float(loaded["peak_to_peak"][0]))
            levels.append(float(loaded["mean_level"][0]))
    assert swings[0] == swings[1]
    assert swings[3] == pytest.approx(swings[2], abs=0.5)
    assert levels[3] == pytest.approx(levels[2], rel=0.01)
    assert abs(levels[2] - levels[0]) < 10.0


# Nodes that scatter: flanks without line contact are refused with a way out, and the smooth surface is one


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


def test_designed_flanks_without_line_contact_are_not_refused() -> None:
    require_line_contact(0.3, {})


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
