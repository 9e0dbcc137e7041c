"""V-H check: V and H bring the pattern where it was wanted, by the analysis itself and by rigid-body theory."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from runs import call, output_of, refusal_of
from scipy.interpolate import RectBivariateSpline

import easeoff
from easeoff import InputError
from easeoff.cases import Case, gear_pair, read_case, shipped_cases
from easeoff.contact import MeshCycle
from easeoff.contact.evaluation.cycle_numbers import with_unloaded_numbers
from easeoff.contact.evaluation.flank_region import ProjectionPlane
from easeoff.geometry import Misalignment, PairGeometry, pair_geometry
from easeoff.geometry.pair.gear_pair import FlankName
from easeoff.study import vh_check
from easeoff.study.vh import PatternSearch

PLACES = {"toe": 0.25, "middle": 0.5, "heel": 0.75}
CASES = [(name, flank) for name in shipped_cases() for flank in ("drive", "coast")]


def shifted(case: Case, found: xr.Dataset, place: str) -> Misalignment:
    own, one = case.misalignment, found.sel(place=place)
    return Misalignment(
        own.offset + float(one["v"]),
        own.pinion_axial + float(one["h"]),
        own.gear_axial,
        math.radians(own.shaft_angle),
    )


def distance(geometry: PairGeometry, unloaded: xr.Dataset, wanted: tuple[float, float]) -> float:
    """Distance of the centre of the print from a place of the flank [mm]."""
    plane = ProjectionPlane.of(geometry.flanks)
    centre = [float(unloaded[f"pattern_centre_{name}"]) for name in ("lengthwise", "profile")]
    return float(np.linalg.norm(plane(np.array(centre)) - plane(np.array(wanted))))


@pytest.mark.thorough
@pytest.mark.parametrize(("name", "flank"), CASES)
def test_patterns_of_every_case_are_centred_where_wanted(name: str, flank: FlankName) -> None:
    """By the numbers of an analysis, on its own grids, in the misalignment that was found."""
    case = read_case(name)
    found = vh_check(name, flank=flank)
    assert found["status"].values.tolist() == [0, 0, 0]
    for place, wanted in PLACES.items():
        pair = gear_pair(case, flank).misaligned(shifted(case, found, place))
        geometry = pair_geometry(pair, (case.contact.lengthwise_nodes, case.contact.profile_nodes))
        cycle = MeshCycle.of(geometry, mesh_positions=case.contact.mesh_positions)
        numbers = with_unloaded_numbers(cycle, cycle.unloaded(separation=case.contact.separation))
        assert distance(geometry, numbers, (wanted, 0.5)) < 2e-3
        assert numbers.attrs["peak_to_peak"] == pytest.approx(float(found["peak_to_peak"].sel(place=place)), rel=1e-4)


@pytest.mark.thorough
def test_an_analysis_at_what_was_found_has_its_pattern_there() -> None:
    case = read_case("fh-design-a")
    found = vh_check(case)
    for place, wanted in PLACES.items():
        tree = easeoff.analyze(case, torques=[50.0], misalignment=shifted(case, found, place))
        geometry = pair_geometry(gear_pair(case), (9, 7))
        assert distance(geometry, tree["unloaded"].to_dataset(), (wanted, 0.5)) < 1e-3


@pytest.fixture(scope="module")
def quick() -> Case:
    """A case on coarse grids."""
    case = read_case("fh-design-a")
    coarse = {"mesh_positions": 12, "lengthwise_nodes": 11, "profile_nodes": 7}
    return case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})


@pytest.fixture(scope="module")
def found(quick: Case) -> xr.Dataset:
    return vh_check(quick, grid=(2, 3))


def test_centres_are_where_wanted_and_totals_run_from_toe_to_heel(found: xr.Dataset) -> None:
    assert found["status"].values.tolist() == [0, 0, 0]
    np.testing.assert_allclose(found["pattern_centre_lengthwise"], list(PLACES.values()), atol=3e-5)
    np.testing.assert_allclose(found["pattern_centre_profile"], 0.5, atol=2e-4)
    v, h = found["v"].values, found["h"].values
    assert (float(found["total_v"]), float(found["total_h"])) == (v[2] - v[0], h[2] - h[0])
    assert float(found["h_over_v"]) == (h[2] - h[0]) / (v[2] - v[0])
    np.testing.assert_allclose(found["pattern_to"] - found["pattern_from"], found["pattern_length"], atol=1e-12)


def test_the_grid_holds_what_was_found_and_zero(found: xr.Dataset) -> None:
    assert found["grid_print_excess"].dims[:2] == ("v_grid", "h_grid")
    for name in ("v", "h"):
        values, grid = found[name].values, found[f"{name}_grid"].values
        assert grid.min() < min(values.min(), 0.0)
        assert grid.max() > max(values.max(), 0.0)
    assert all(found[name].attrs["long_name"] for name in found.variables)


@pytest.mark.thorough
def test_v_and_h_are_added_to_the_misalignment(quick: Case, found: xr.Dataset) -> None:
    """From another assembly the same patterns are at the same places in space."""
    moved = vh_check(quick, misalignment=Misalignment(offset=0.05, pinion_axial=-0.03))
    np.testing.assert_allclose(moved["v"] + 0.05, found["v"], atol=2e-4)
    np.testing.assert_allclose(moved["h"] - 0.03, found["h"], atol=2e-4)


@pytest.mark.thorough
def test_the_mirrored_pair_has_the_same_v_and_h(quick: Case, found: xr.Dataset) -> None:
    other = {"left": "right", "right": "left"}[quick.pinion.hand_of_spiral]
    mirrored = quick.model_copy(update={"pinion": quick.pinion.model_copy(update={"hand_of_spiral": other})})
    again = vh_check(mirrored)
    for name in ("v", "h", "peak_to_peak", "pattern_length"):
        np.testing.assert_allclose(again[name], found[name], rtol=1e-6, atol=1e-8)


def stationary_point(geometry: PairGeometry) -> np.ndarray:
    """Where the ease-off is least, by Newton's method on a spline."""
    angle = geometry.ease_off["ease_off_angle"]
    spline = RectBivariateSpline(angle["lengthwise"], angle["profile"], angle.values, kx=4, ky=4, s=0)
    point = np.array([0.5, 0.5])
    for _ in range(30):
        point = point - np.linalg.solve(hessian(spline, point), gradient(spline, point))
    return point


def gradient(spline: RectBivariateSpline, point: np.ndarray) -> np.ndarray:
    return np.array([spline(point[0], point[1], dx=1)[0, 0], spline(point[0], point[1], dy=1)[0, 0]])


def hessian(spline: RectBivariateSpline, point: np.ndarray) -> np.ndarray:
    mixed = spline(point[0], point[1], dx=1, dy=1)[0, 0]
    return np.array([[spline(point[0], point[1], dx=2)[0, 0], mixed], [mixed, spline(point[0], point[1], dy=2)[0, 0]]])


@pytest.mark.parametrize("flank", ["drive", "coast"])
def test_the_contact_moves_as_the_gap_of_a_rigid_displacement_says(flank: FlankName) -> None:
    """Least ease-off: its place moves by minus the inverse second derivatives times the gradient of the gap added.

    A displacement d of the pinion changes the gap along the normal by -d . n, n being the pinion's outward normal, in
    first order and for flanks that are conjugate; of the rest, the part of the ease-off in the slope of the flank, a
    twentieth is left.
    """
    pair = gear_pair(read_case("fh-design-a"), flank)
    geometry = pair_geometry(pair, (21, 15))
    ease_off, assembly = geometry.ease_off, pair.assembly
    along, up = (ease_off[name].values for name in ("lengthwise", "profile"))
    normal = ease_off["action_normal"].transpose("lengthwise", "profile", "space").values
    hand = 1.0 if assembly.pinion_hand == "left" else -1.0
    directions = (
        np.array([0.0, hand, 0.0]),
        np.array([math.sin(assembly.shaft_angle), 0.0, math.cos(assembly.shaft_angle)]),
    )
    angle = RectBivariateSpline(along, up, ease_off["ease_off_angle"].values, kx=4, ky=4, s=0)
    point = stationary_point(geometry)
    theory, differences = np.empty((2, 2)), np.empty((2, 2))
    for column, (direction, name) in enumerate(zip(directions, ("offset", "pinion_axial"), strict=True)):
        added = RectBivariateSpline(along, up, -(normal @ direction) / ease_off["lever_arm"].values, kx=4, ky=4, s=0)
        theory[:, column] = -np.linalg.solve(hessian(angle, point), gradient(added, point))
        ends = [stationary_point(geometry.misaligned(Misalignment(**{name: size}))) for size in (1e-3, -1e-3)]
        differences[:, column] = (ends[0] - ends[1]) / 2e-3
    np.testing.assert_allclose(theory, differences, atol=0.06 * np.abs(differences).max())


@pytest.mark.thorough
def test_near_the_middle_v_and_h_follow_the_derivatives_of_the_centre(quick: Case) -> None:
    """Toe and heel close to the middle: V and H over the way between them solve the equations of the derivatives."""
    near = vh_check(quick, share=0.45)
    way = np.array([float(near["total_v"]), float(near["total_h"])])
    middle = near.sel(place="middle")
    base = Misalignment(float(middle["v"]), float(middle["h"]))
    cycle = MeshCycle.of(pair_geometry(gear_pair(quick), (11, 7)), mesh_positions=12)
    slope = np.empty((2, 2))
    for column, step in enumerate(0.02 * np.eye(2)):
        ends = []
        for sign in (1.0, -1.0):
            at = cycle.misaligned(Misalignment(base.offset + sign * step[0], base.pinion_axial + sign * step[1]))
            numbers = with_unloaded_numbers(at, at.unloaded(separation=quick.contact.separation))
            ends.append([float(numbers[f"pattern_centre_{name}"]) for name in ("lengthwise", "profile")])
        slope[:, column] = (np.array(ends[0]) - np.array(ends[1])) / 0.04
    np.testing.assert_allclose(slope @ way, [0.1, 0.0], atol=5e-3)


def test_what_is_out_of_reach_is_nan_with_a_reason(quick: Case) -> None:
    found = vh_check(quick, largest=0.1)
    assert found["status"].values.tolist() == [2, 0, 2]
    assert np.isnan(found["v"].values).tolist() == [True, False, True]
    assert np.isnan(float(found["total_v"]))
    assert "V or H would exceed the range; nearest: centre" in found.attrs["reason_toe"]
    assert "reason_middle" not in found.attrs


def test_without_a_pattern_to_start_from_the_search_says_so() -> None:
    search = PatternSearch(lambda x: np.full(2, np.nan), 30.0, 3.0, 1e-3)
    assert search.find(np.array([15.0, 4.0]), search.start()).status.name == "NO_PATTERN"


def test_the_search_says_when_a_place_does_not_exist() -> None:
    """The centre saturates, as does that of a pattern which an edge cuts off."""
    search = PatternSearch(lambda x: np.array([15.0 + 5.0 * np.tanh(x[0]), 4.0 + x[1]]), 30.0, 3.0, 1e-3)
    found = search.find(np.array([25.0, 4.0]), search.start())
    assert found.status.name in ("NOT_REACHED", "OUT_OF_RANGE")
    assert search.evaluations < 60
    assert 5.0 <= found.distance(np.array([25.0, 4.0])) < 5.6


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"share": 0.5}, "share = 0.5"),
        ({"share": 0.0}, "share = 0: "),
        ({"height": 1.0}, "height = 1: "),
        ({"largest": -1.0}, "largest = -1: "),
        ({"grid": (1, 5)}, "grid[0] = 1"),
        ({"marking": 0.0}, "marking = 0: "),
    ],
)
def test_wrong_arguments_are_refused(quick: Case, wrong: dict[str, float], said: str) -> None:
    with pytest.raises(InputError) as caught:
        vh_check(quick, **wrong)  # type: ignore[arg-type]
    assert said in str(caught.value)


@pytest.mark.thorough
def test_the_command_writes_table_file_and_picture(tmp_path: Path, quick: Case) -> None:
    case, file = tmp_path / "case.toml", tmp_path / "vh.nc"
    easeoff.cases.write_case(quick, case)
    said = output_of("vh", case, "-o", file, "--plots", tmp_path, "--grid", "2x2")
    assert "toe to heel: total V" in said
    assert next(tmp_path.glob("*-drive-vh_check.png")).stat().st_size > 10_000
    with xr.open_dataset(file, engine="netcdf4") as stored:
        assert f"{float(stored['h_over_v']):+.3f}" in said
    short = call("vh", case, "-o", file, "--largest", "0.05")
    assert short.exit_code == 1
    assert "toe: V or H would exceed the range" in short.output
    assert "share = 0.6: must be" in refusal_of("vh", case, "-o", file, "--share", "0.6")
