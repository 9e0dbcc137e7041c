"""Key numbers of a result, each against the raw tree, a closed form, a difference of analyses or another method."""

from __future__ import annotations

import math
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from pairs import mirrored
from runs import SMALL, call, output_of, refusal_of, small

import easeoff
from easeoff import InputError, analyze, read_case, read_result, write_result
from easeoff.cases import Case, gear_pair, shipped_cases
from easeoff.contact import AssemblyRounds, ElasticModel, MeshCycle, Status
from easeoff.contact.evaluation.cycle_numbers import (
    contact_time,
    load_spot,
    loaded_contact_ratio,
    mesh_stiffnesses,
    with_loaded_numbers,
    with_unloaded_numbers,
)
from easeoff.contact.evaluation.flank_region import ProjectionPlane, flank_share, grid_triangles, region_below
from easeoff.contact.evaluation.marking_print import MarkingPrint, least_gap
from easeoff.contact.evaluation.pressure_map import LineEnd, nearest_border
from easeoff.contact.evaluation.tooth_passage import CarryingError, ToothPassage
from easeoff.contact.lines.contact_lines import boundary_distance, trace
from easeoff.contact.lines.mesh_lines import roll_limits
from easeoff.friction import FrictionModel, flash_temperature
from easeoff.geometry import Misalignment, pair_geometry
from easeoff.study import CaseInMesh, key_numbers, write_pictures
from easeoff.study.plot.tooth_view import tooth_view
from easeoff.study.summary.result_summary import loaded_table, result_summary, unloaded_table
from easeoff.verification.smallest_gap import flank_gap

Array = NDArray[np.float64]
NEW = (
    "contact_ratio",
    "geometric_contact_ratio",
    "least_gap",
    "max_load_share",
    "mean_mesh_stiffness",
    "mesh_stiffness",
    "max_pressure_position",
    "max_pressure_pair",
    "max_pressure_lengthwise",
    "max_pressure_profile",
    "max_pressure_line_end",
    "pinion_mean_level",
    "pinion_peak_to_peak",
    "pattern_centre_lengthwise",
    "pattern_centre_profile",
    "pattern_length",
    "pattern_height",
)


def coarse(name: str, **changed: object) -> Case:
    case = read_case(name)
    contact = {"mesh_positions": 8, "segments_per_line": 15, "lengthwise_nodes": 21, "profile_nodes": 15, **changed}
    shells = case.compliance.model_copy(update={"model": "shell"})
    return case.model_copy(
        update={"contact": case.contact.model_copy(update=contact), "compliance": shells, "friction": None}
    )


@cache
def tree_of(name: str, *, edges: bool) -> xr.DataTree:
    return analyze(coarse(name), edge_contact=edges)


@cache
def cycle_of(name: str, positions: int = 8) -> MeshCycle:
    return CaseInMesh.of(coarse(name, mesh_positions=positions)).cycle


# --- regions of a flank


@pytest.mark.parametrize("flipped", [False, True])
def test_region_of_a_circle_on_a_tapered_flank(flipped: bool) -> None:
    """Area, centroid and extent of a circle in the plane, whose fractions follow from the inverse map."""
    plane = ProjectionPlane(np.array([[0.0, 30.0, 0.0, 0.0], [0.0, 0.0, 6.0, 4.0]]))  # x = 30 t, y = (6 + 4 t) h
    middle, radius = np.array([14.0, 4.0]), 2.5
    shape = (301, 151)
    points = np.stack(np.meshgrid(*(np.linspace(0.0, 1.0, n) for n in shape), indexing="ij")).reshape(2, -1)
    values = np.hypot(*(plane(points) - middle[:, None])) - radius
    found = region_below(points, -values if flipped else values, grid_triangles(shape), 0.0, plane)
    area = math.pi * radius**2
    whole = 30.0 * 8.0
    assert found.area == pytest.approx(whole - area if flipped else area, rel=5e-4)
    if flipped:
        assert found.size.tolist() == [1.0, 1.0]
        return
    assert found.centre[0] == pytest.approx(middle[0] / 30.0, abs=1e-5)
    assert 30.0 * found.extent[0, 0] == pytest.approx(middle[0] - radius, abs=1e-3)
    # The centroid of y / (6 + 4 t) over the disc, by quadrature.
    r, angle = np.meshgrid(np.linspace(0.0, radius, 400), np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False))
    px, py = middle[0] + r * np.cos(angle), middle[1] + r * np.sin(angle)
    profile = np.sum(r * py / (6.0 + 4.0 * px / 30.0)) / np.sum(r)
    assert found.centre[1] == pytest.approx(profile, abs=1e-4)


def test_two_triangles_a_cell_turn_the_same_way() -> None:
    assert grid_triangles((2, 2)).tolist() == [[0, 2, 3], [0, 3, 1]]


def test_an_empty_region_has_no_centre() -> None:
    plane = ProjectionPlane(np.array([[0.0, 30.0, 0.0, 0.0], [0.0, 0.0, 6.0, 4.0]]))
    for points, triangles in ((np.eye(2, 3), np.array([[0, 1, 2]])), (np.zeros((2, 0)), np.zeros((0, 3), dtype=int))):
        found = region_below(points, np.ones(points.shape[1]), triangles, 0.0, plane)
        assert found.area == 0.0
        assert np.all(np.isnan([found.centre, found.size]))


# --- the marking print


@pytest.mark.parametrize("name", ["nasa-12x36", "fm-11x41"])
@pytest.mark.thorough
def test_least_gap_is_the_smallest_between_the_flanks_over_all_rotations(name: str) -> None:
    """Along the gear's normals to the exact pinion, the gear turned until the carrying pair touches."""
    pair = gear_pair(read_case(name))
    geometry = pair_geometry(pair, (25, 17))
    cycle = MeshCycle.of(geometry, mesh_positions=32, segments_per_line=9)
    error = CarryingError.of(cycle.unloaded(), cycle.pinion_pitch)
    gear, exact = geometry.members.gear, geometry.exact
    axes = [geometry.ease_off[n].values for n in ("lengthwise", "profile")]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"))
    inner = (boundary_distance(cycle.fields, nodes) > 0.03).ravel()
    found = least_gap(cycle.fields, error, nodes).ravel()
    chosen = np.flatnonzero(inner & (found < 15.0))[::9]
    assert chosen.size > 4
    position, normal = (np.reshape(v, (3, -1))[:, chosen] for v in (gear.position, gear.normal))
    start = np.reshape(exact.pinion_parameters, (2, -1))[:, chosen]
    roll = cycle.fields("roll_angle", nodes).ravel()[chosen]
    first_contact = float(geometry.ease_off.attrs["first_contact_rad"])

    def gap(column: int, rotation: float) -> float:
        closing = first_contact + float(error.least(np.array(rotation)))
        at = (slice(None), slice(column, column + 1))
        turned = rotation + exact.motion.center
        return float(flank_gap(exact.motion, position[at], normal[at], turned, closing, start[at]).gap[0])

    for column, rotation in enumerate(roll):
        best, reach = float(rotation), 0.06
        for _ in range(2):
            tried = best + np.linspace(-reach, reach, 41)
            gaps = [gap(column, one) for one in tried]
            best, reach = float(tried[np.argmin(gaps)]), reach / 20.0
        # Far from its roll angle a point's gap is known from an expansion of third order.
        assert found[chosen[column]] == pytest.approx(1e3 * min(gaps), abs=0.06, rel=0.02)


def test_print_is_the_union_of_the_contact_lines_within_the_thickness() -> None:
    """Where the error of the carrying pair hardly changes: lines at many positions, cut where the gap is too wide."""
    cycle = cycle_of("fm-11x41", 32)
    unloaded = cycle.unloaded()
    error = CarryingError.of(unloaded, cycle.pinion_pitch)
    plane = ProjectionPlane.of(cycle.geometry.flanks)
    region = MarkingPrint.of(cycle.fields, error, 6.0).region(plane)
    lines = cycle.lines
    points = lines.lines.points
    rotation = lines.rotations[lines.position] - lines.pair * cycle.pinion_pitch
    arm = cycle.fields("lever_arm", points)
    gap = 1e3 * arm * (cycle.fields("ease_off_angle", points) - error.least(rotation)[:, None])
    within = points[:, gap < 6.0]
    np.testing.assert_allclose(region.extent, np.stack([within.min(axis=1), within.max(axis=1)], axis=1), atol=0.015)
    # The area element: length along the line times what the line moves across itself in a mesh position.
    weight = cycle.pinion_pitch / 32 * _across(cycle, points)
    element = (lines.lines.length[:, None] / 64 * weight)[gap < 6.0]
    np.testing.assert_allclose(within @ element / element.sum(), region.centre, atol=0.01)


def _across(cycle: MeshCycle, points: Array) -> Array:
    """Way of a contact line across itself by the pinion rotation [mm/rad]."""
    first = [cycle.fields.evaluate(["roll_angle", "position"], points, d) for d in ((1, 0), (0, 1))]
    e, f, g = (np.sum(first[i]["position"] * first[j]["position"], axis=0) for i, j in ((0, 0), (0, 1), (1, 1)))
    a, b = first[0]["roll_angle"], first[1]["roll_angle"]
    return np.asarray(np.sqrt((e * g - f**2) / (g * a**2 - 2.0 * f * a * b + e * b**2)))


def test_a_thicker_compound_prints_more_up_to_the_common_flank() -> None:
    cycle = cycle_of("nasa-12x36")
    error = CarryingError.of(cycle.unloaded(), cycle.pinion_pitch)
    plane = ProjectionPlane.of(cycle.geometry.flanks)
    areas = [MarkingPrint.of(cycle.fields, error, s).region(plane).area for s in (0.01, 3.0, 6.0, 20.0, 900.0)]
    assert np.all(np.diff(areas) > 0.0)
    grid = np.stack(np.meshgrid(*(np.linspace(0.0, 1.0, n) for n in (401, 201)), indexing="ij"))
    columns = np.stack([(plane(grid + d) - plane(grid)) / 1e-6 for d in STEPS])
    jacobian = np.linalg.det(np.moveaxis(columns, (0, 1), (-1, -2)))
    common = np.mean(jacobian * (boundary_distance(cycle.fields, grid) > 0.0))
    assert areas[-1] == pytest.approx(common, rel=0.01)


STEPS = np.array([[1e-6, 0.0], [0.0, 1e-6]]).reshape(2, 2, 1, 1)


@pytest.mark.parametrize("name", ["nasa-12x36", "fm-11x41", "fh-12x41-45"])
def test_print_searched_beside_its_border_alone_has_the_same_region(name: str) -> None:
    cycle = cycle_of(name)
    error = CarryingError.of(cycle.unloaded(), cycle.pinion_pitch)
    plane = ProjectionPlane.of(cycle.geometry.flanks)
    for thickness in (0.5, 6.0, 20.0, 100.0):
        whole, border = (MarkingPrint.of(cycle.fields, error, thickness, whole=w) for w in (True, False))
        wanted, found = (each.region(plane) for each in (whole, border))
        np.testing.assert_array_equal(border.excess < 0.0, whole.excess < 0.0)
        np.testing.assert_array_equal(found.extent, wanted.extent)
        assert (found.area, *found.centre) == (wanted.area, *wanted.centre)


def test_error_near_a_rotation_stays_below_its_bound() -> None:
    cycle = cycle_of("fm-11x41")
    error = CarryingError.of(cycle.unloaded(), cycle.pinion_pitch)
    rotations = np.linspace(-1.0, 1.0, 301) * cycle.pinion_pitch
    for reach in (0.0, 0.01, 0.07):
        near = error.least(rotations + reach * np.linspace(-1.0, 1.0, 501)[:, None]).max(axis=0)
        excess = error.greatest_near(rotations, reach) - near
        assert np.all(excess >= 0.0)
        assert np.min(excess) < 1e-3 * np.ptp(error.over_cycle)


def test_without_unloaded_contact_the_numbers_are_nan() -> None:
    cycle = cycle_of("fm-11x41")
    nothing = cycle.unloaded()
    nothing["transmission_error"] = nothing["transmission_error"] * np.nan
    found = with_unloaded_numbers(cycle, nothing)
    for name in ("contact_ratio", "pattern_length", "pattern_centre_profile"):
        assert math.isnan(found[name].item())
    assert np.all(np.isnan(found["least_gap"]))


def test_centre_and_extent_of_the_load_weigh_places_by_force() -> None:
    dims = ("torque", "mesh_position", "segment")
    loaded = xr.Dataset({"status": (dims[:2], [[0]]), "force": (dims, [[[1.0, 3.0]]])})
    loaded = loaded.assign(lengthwise=(dims, [[[0.2, 0.6]]]), profile=(dims, [[[0.5, 0.5]]]))
    found = [value[0] for _, value in load_spot(loaded).values()]
    np.testing.assert_allclose(found, [0.5, 0.5, math.sqrt(0.03), 0.0], atol=1e-12)


# --- the contact ratio


def test_time_in_contact_in_closed_form() -> None:
    time = np.arange(-10.0, 11.0)
    none = np.array([-100.0, 100.0])
    assert contact_time(time, 3.3 - np.abs(time), none) == pytest.approx(6.6)
    assert contact_time(time, np.where(np.abs(time) > 4, np.nan, 5.0), np.array([-4.25, 4.5])) == pytest.approx(8.75)
    # Beyond the last value: to where the margin leads to zero, if that is before the lines end.
    fading = np.where(time > 4, np.nan, np.minimum(2.0, 0.6 * (4.7 - time)))
    fading[time < 0] = -1.0
    assert contact_time(time, fading, np.array([-10.0, 4.9])) == pytest.approx(4.7 + 2.0 / 3.0)
    assert contact_time(time, fading, np.array([-10.0, 4.4])) == pytest.approx(4.4 + 2.0 / 3.0)
    assert contact_time(time, np.full(21, -1.0), none) == 0.0


@pytest.mark.parametrize("positions", [8, 32])
def test_contact_ratio_of_parabolas_under_an_even_rotation(positions: int) -> None:
    """Pairs whose gap angle is k psi^2 and a rotation theta: contact while psi^2 < theta / k."""
    pitch, k, theta, pairs = 0.5, 2e-3, 4e-4, np.array([-1, 0, 1, 2])
    rotation = (np.arange(positions) / positions - 0.5) * pitch
    own = rotation[None] - pairs[:, None] * pitch
    arm = 70.0
    at_torque = xr.Dataset(
        {
            "tooth": (("mesh_position", "segment"), np.tile(pairs.astype(float), (positions, 1))),
            "separation": (("mesh_position", "segment"), arm * k * own.T**2),
            "lever_arm": (("mesh_position", "segment"), np.full((positions, pairs.size), arm)),
            "transmission_error": ("mesh_position", np.full(positions, 1e6 * theta)),
            "status": ("mesh_position", np.zeros(positions, dtype=np.int8)),
        },
        coords={"pair": pairs},
    )
    expected = 2.0 * math.sqrt(theta / k) / pitch
    ratio = loaded_contact_ratio(at_torque, np.array([-1e3, 1e3]))
    assert ratio == pytest.approx(expected, abs=0.5 / positions**2)
    failed = at_torque.assign(status=at_torque["status"].copy(data=np.full(positions, Status.NOT_CONVERGED)))
    assert math.isnan(loaded_contact_ratio(failed, np.array([-1e3, 1e3])))


@pytest.mark.parametrize("edges", [False, True])
@pytest.mark.parametrize("name", ["nasa-12x36", "fm-11x41"])
def test_contact_ratio_is_the_mean_number_of_pairs_that_carry(name: str, edges: bool) -> None:
    """Counted at the mesh positions it is a whole number of steps for each end of contact."""
    loaded = tree_of(name, edges=edges)["loaded"].to_dataset()
    counted = (loaded["load_share"] > 0.0).sum("pair").mean("mesh_position")
    np.testing.assert_allclose(loaded["contact_ratio"], counted, atol=1.0 / 8 + 1e-9)


@pytest.mark.thorough
def test_contact_ratio_hardly_depends_on_the_number_of_mesh_positions() -> None:
    case = read_case("fm-11x41")
    coarse_ratio, fine_ratio = (
        with_loaded_numbers(cycle, *cycle.loaded(case.contact.torques, edge_contact=False))["contact_ratio"].values
        for cycle in (cycle_of("fm-11x41", 8), cycle_of("fm-11x41", 64))
    )
    np.testing.assert_allclose(coarse_ratio, fine_ratio, atol=0.01)


def test_heavy_load_on_lines_reaches_the_geometric_contact_ratio() -> None:
    cycle = cycle_of("fm-11x41")
    unloaded = with_unloaded_numbers(cycle, cycle.unloaded())
    loaded = with_loaded_numbers(cycle, *cycle.loaded([3000.0], edge_contact=False))
    assert loaded["contact_ratio"].item() == pytest.approx(unloaded["geometric_contact_ratio"].item(), abs=1e-9)
    assert 1.0 < unloaded["contact_ratio"].item() < unloaded["geometric_contact_ratio"].item()


@pytest.mark.thorough
def test_unloaded_contact_ratio_runs_from_one_to_the_geometric_one() -> None:
    """With no thickness one pair touches at a time; with a thick one all that have lines."""
    cycle = cycle_of("nasa-12x36", 32)
    ratios = [
        [with_unloaded_numbers(cycle, cycle.unloaded(separation=s))[n].item() for n in (NEW[0], NEW[1])]
        for s in (1e-4, 6.0, 999.0)
    ]
    (none, limit), (some, _), (all_, _) = ratios
    assert none == pytest.approx(1.0, abs=2e-3)
    assert none < some < all_
    assert all_ == pytest.approx(limit, abs=1e-3)


def test_contact_lines_exist_within_the_roll_limits_alone() -> None:
    for name in ("nasa-12x36", "fm-11x41", "fh-12x41-45"):
        fields = cycle_of(name).fields
        low, high = roll_limits(fields)
        reach = 0.004 * (high - low)
        levels = np.array([low - reach, low + reach, 0.5 * (low + high), high - reach, high + reach])
        assert set(trace(fields, levels).level.tolist()) == {1, 2, 3}, name


# --- under load


@pytest.mark.parametrize("edges", [False, True])
@pytest.mark.parametrize("name", ["nasa-12x36", "fm-11x41"])
def test_mesh_stiffness_is_the_difference_quotient_of_two_analyses(name: str, edges: bool) -> None:
    cycle, torque, step = cycle_of(name), 200.0, 0.02  # so small that no segment begins to touch within it
    _, cases = cycle.loaded([torque - step, torque, torque + step], edge_contact=edges)
    by_position = {k: sorted((c for c in cases if c.mesh_position == k), key=lambda c: c.torque) for k in range(8)}
    for low, here, high in by_position.values():
        rotation = 1e6 * (high.solution.rotation - low.solution.rotation)
        secant = cycle.ratio * 2.0 * step / rotation
        assert mesh_stiffnesses([here])[0] == pytest.approx(secant, rel=2e-3)


def test_stiffness_of_the_tree_is_that_of_its_cases_and_grows_with_the_load() -> None:
    loaded = tree_of("fm-11x41", edges=False)["loaded"].to_dataset()
    case = coarse("fm-11x41")
    found = [mesh_stiffnesses([one])[0] for one in cycle_of("fm-11x41").solved(case.contact.torques)]
    np.testing.assert_allclose(loaded["mesh_stiffness"].values.T.ravel(), found, rtol=1e-6)
    np.testing.assert_allclose(loaded["mean_mesh_stiffness"], loaded["mesh_stiffness"].mean("mesh_position"))
    assert np.all(np.diff(loaded["mean_mesh_stiffness"]) > 0.0)


@pytest.mark.parametrize("edges", [False, True])
@pytest.mark.parametrize("name", ["nasa-12x36", "fm-11x41"])
def test_place_of_the_greatest_pressure(name: str, edges: bool) -> None:
    """The segment with that pressure; where a line ends there, it lies within half a segment of the border."""
    tree = tree_of(name, edges=edges)
    loaded = tree["loaded"].to_dataset()
    fields = cycle_of(name).fields
    for index in range(loaded.sizes["torque"]):
        here = loaded.isel(torque=index)
        at = here.sel(mesh_position=here["max_pressure_position"])
        chosen = np.flatnonzero(at["pressure"].values == here["max_pressure"].values)
        assert chosen.size == 1
        for name_, value in (("lengthwise", "lengthwise"), ("profile", "profile"), ("tooth", "pair")):
            assert at[name_].values[chosen[0]] == here[f"max_pressure_{value}"]
        point = np.array([[here["max_pressure_lengthwise"]], [here["max_pressure_profile"]]], dtype=float)
        same = (at["tooth"] == here["max_pressure_pair"]) & at["overhang"].isnull()
        line = np.stack([at[n].values[same.values] for n in ("lengthwise", "profile")])
        step = np.max(np.abs(np.diff(line, axis=1)))
        end = LineEnd(int(here["max_pressure_line_end"]))
        distance = float(boundary_distance(fields, point)[0])
        to_gear = float(np.min([point, 1.0 - point]))
        if end != LineEnd.INSIDE:
            assert min(distance, to_gear) < 1.5 * step
        else:
            ends = line[:, [0, -1]] - point
            assert np.min(np.max(np.abs(ends), axis=0)) > 0.3 * step


def test_borders_are_named() -> None:
    fields = cycle_of("fm-11x41").fields
    named = {(0.5, 0.99): "GEAR_TIP", (0.99, 0.6): "GEAR_HEEL", (0.003, 0.6): "GEAR_TOE"}
    for point, border in named.items():
        assert nearest_border(fields, np.array(point)).name == border
    # Below the dashed line the pinion's tip has passed.
    along = np.stack([np.full(200, 0.5), np.linspace(0.0, 0.5, 200)])
    low = along[:, np.argmax(boundary_distance(fields, along) > 0.0)]
    assert nearest_border(fields, low).name == "PINION_TIP"
    assert (LineEnd.INSIDE, LineEnd.PINION_TIP) == (0, 8)  # as stored


@pytest.mark.parametrize("flank", ["drive", "coast"])
def test_mirror_image_has_the_same_numbers(flank: easeoff.geometry.FlankName) -> None:
    pair = gear_pair(read_case("fm-11x41"), flank).misaligned(Misalignment(0.05, -0.02, 0.01, 0.0))
    numbers = []
    for one in (pair, mirrored(pair)):
        cycle = MeshCycle.of(pair_geometry(one, (13, 9)), ElasticModel(), mesh_positions=3, segments_per_line=9)
        loaded = with_loaded_numbers(cycle, *cycle.loaded([60.0, 300.0], edge_contact=True))
        unloaded = with_unloaded_numbers(cycle, cycle.unloaded())
        numbers.append([found[n].values for found in (loaded, unloaded) for n in NEW if n in found])
    for own, image in zip(*numbers, strict=True):
        np.testing.assert_allclose(own, image, rtol=1e-7, atol=1e-7)


@pytest.mark.parametrize("name", ["nasa-12x36", "fm-11x41"])
def test_loaded_pattern_from_the_segments_that_carry(name: str) -> None:
    """Extent between the outermost carrying segments, centre as the mean of segment length times way of the line."""
    cycle = cycle_of(name, 32)
    loaded = with_loaded_numbers(cycle, *cycle.loaded([100.0], edge_contact=False))
    here = loaded.isel(torque=0)
    carries = (here["force"] > 0.0).values
    points = np.stack([here[n].values for n in ("lengthwise", "profile")])[:, carries]
    weight = here["length"].values[carries] * _across(cycle, points)
    centre = points @ weight / weight.sum()
    found = [float(here[f"pattern_centre_{n}"]) for n in ("lengthwise", "profile")]
    np.testing.assert_allclose(found, centre, atol=0.015)
    for axis, size in enumerate(("pattern_length", "pattern_height")):
        extent = float(np.ptp(points[axis]))
        assert extent < float(here[size]) < extent + 0.1


def test_loaded_pattern_reaches_to_the_edges_that_carry() -> None:
    cycle = cycle_of("nasa-12x36", 32)
    here = with_loaded_numbers(cycle, *cycle.loaded([3.0])).isel(torque=0)
    sharp = ((here["force"] > 0.0) & np.isnan(here["pressure"])).values
    assert sharp.any()
    for axis, size in (("lengthwise", "pattern_length"), ("profile", "pattern_height")):
        place = here[axis].values[(here["force"] > 0.0).values]
        assert float(here[size]) >= np.ptp(place)
        assert float(here[size]) < np.ptp(place) + 0.1


def test_pinion_turns_by_the_ratio_more() -> None:
    tree = tree_of("fm-11x41", edges=True)
    numbers = key_numbers(tree)
    for name in ("mean_level", "peak_to_peak"):
        np.testing.assert_allclose(numbers[f"pinion_{name}"], 41.0 / 11.0 * numbers[name])
    assert numbers["unloaded_pinion_peak_to_peak"] == pytest.approx(41 / 11 * tree["unloaded"].attrs["peak_to_peak"])


# --- the light load, the film, and the tree


def test_light_load_is_an_analysis_at_one_percent_of_the_greatest_torque() -> None:
    tree = tree_of("fm-11x41", edges=True)
    light, torques = tree["light_load"].to_dataset(), coarse("fm-11x41").contact.torques
    assert light["torque"].values.tolist() == [0.01 * max(torques)]
    assert tree["loaded"].to_dataset()["torque"].values.tolist() == list(torques)
    again = analyze(coarse("fm-11x41"), torques=light["torque"].values.tolist(), edge_contact=True)[
        "loaded"
    ].to_dataset()
    for name in ("transmission_error", "max_pressure", "contact_ratio", "pattern_length"):
        np.testing.assert_allclose(light[name], again[name], rtol=1e-9)


@pytest.mark.parametrize("feedback", [False, True])
def test_least_film_is_that_of_the_segments(feedback: bool) -> None:
    conditions = {"speed": [500.0, 2000.0], "temperature": [60.0, 90.0]}
    case = coarse("fm-11x41", mesh_positions=3, segments_per_line=9)
    tree = analyze(case, torques=[100.0, 300.0], friction_feedback=feedback, **conditions)  # type: ignore[arg-type]
    friction, loaded = tree["friction"].to_dataset(), tree["loaded"].to_dataset()
    numbers = key_numbers(tree)
    thinnest = friction["film_thickness"].min(("mesh_position", "segment"))
    np.testing.assert_array_equal(numbers["min_film_thickness"], thinnest.broadcast_like(numbers["min_film_thickness"]))
    at = {"torque": 1, "speed": 0, "temperature": 1}
    least = numbers.isel(at)
    where = friction["film_thickness"].isel(at).sel(mesh_position=least["min_film_position"].values.ravel()[0])
    segment = int(np.nanargmin(where.values))
    there = loaded.isel(torque=1, segment=segment).sel(mesh_position=least["min_film_position"].values.ravel()[0])
    assert there["lengthwise"] == least["min_film_lengthwise"].values.ravel()[0]
    assert there["profile"] == least["min_film_profile"].values.ravel()[0]


def test_key_numbers_are_those_of_the_tree_with_units() -> None:
    tree = tree_of("fm-11x41", edges=True)
    numbers, loaded = key_numbers(tree), tree["loaded"].to_dataset()
    for name in ("mean_level", "max_pressure", "contact_ratio", "mean_mesh_stiffness", "pattern_length"):
        np.testing.assert_array_equal(numbers[name], loaded[name])
    np.testing.assert_array_equal(numbers["max_load_share"], loaded["load_share"].max(("mesh_position", "pair")))
    assert numbers["certified_positions"].values.tolist() == [8, 8, 8]
    for key, variable in numbers.variables.items():
        name = str(key)
        assert variable.dtype.kind in "fi", name
        assert "long_name" in variable.attrs, name
        assert {"units", "flag_meanings"} & variable.attrs.keys(), name
    assert numbers["max_pressure_line_end"].attrs["flag_meanings"].split()[8] == "pinion_tip"


@pytest.mark.thorough
def test_results_of_older_versions_are_shown_without_what_they_lack(tmp_path: Path) -> None:
    tree = tree_of("nasa-12x36", edges=False)
    groups = {name: tree[name].to_dataset().drop_vars(NEW, errors="ignore") for name in tree.children}
    del groups["light_load"]
    old = xr.DataTree.from_dict(groups)
    old.attrs = {name: value for name, value in tree.attrs.items() if name != "compliance_model"}
    write_result(old, tmp_path / "old.nc")
    again = read_result(tmp_path / "old.nc")
    assert "contact_ratio" not in key_numbers(again)
    shown = result_summary(again)
    assert "greatest pressure [MPa]" in shown
    assert "contact ratio" not in shown
    assert "print of" not in shown
    assert len(write_pictures(again, tmp_path)) == 5


@pytest.mark.parametrize("name", shipped_cases())
@pytest.mark.quick(2)
def test_show_fits_a_terminal(name: str) -> None:
    tree = analyze(coarse(name, **SMALL), speed=[500.0, 2000.0], edge_contact=True)
    text = result_summary(tree)
    assert max(len(line) for line in text.splitlines()) <= 100
    numbers = key_numbers(tree)
    for value in (numbers["contact_ratio"].values[0], numbers["unloaded_contact_ratio"].item()):
        assert f"{value:.2f}" in text
    assert f"{numbers['max_pressure'].values[-1]:.0f}" in text
    assert f"print of {numbers['marking'].item():g} um" in text


def test_a_pattern_without_area_is_shown_in_words() -> None:
    numbers = key_numbers(tree_of("fm-11x41", edges=True)).copy(deep=True)
    for state in ("", "light_load_"):
        for name in ("pattern_centre_lengthwise", "pattern_centre_profile", "pattern_length", "pattern_height"):
            numbers[state + name][...] = np.nan
    text = f"{unloaded_table(numbers)}\n{loaded_table(numbers, 8)}"
    assert text.count("no area") == 1 + 2 * numbers.sizes["torque"]  # at light load; centre and length under load
    assert "nan" not in text


def test_sharp_edges_that_carry_all_of_the_load_have_no_pressure(tmp_path: Path) -> None:
    tree = analyze(
        coarse("nasa-12x36", mesh_positions=2), torques=1e-3, misalignment=Misalignment(offset=-0.5), edge_contact=True
    )
    loaded = tree["loaded"].to_dataset()
    assert np.all(loaded["status"] == Status.CERTIFIED)
    carries = loaded["force"].values > 0.0
    assert np.any(carries)
    assert np.all(np.isnan(loaded["pressure"].values[carries]))
    assert np.all(np.isnan(loaded["max_pressure"]))
    text = result_summary(tree)
    assert "nan" not in text.split()
    (row,) = (line.split() for line in text.splitlines() if line.startswith("greatest pressure"))
    assert row[-1] == "-"
    write_pictures(tree, tmp_path, names="pressure", dpi=30)


def test_many_torques_are_shown_below_each_other() -> None:
    tree = analyze(coarse("nasa-12x36", **SMALL), torques=(np.arange(1.0, 13.0) * 20.0).tolist())
    text = result_summary(tree)
    assert max(len(line) for line in text.splitlines()) <= 100
    assert text.count("torque at the pinion [N m]") == 3


# --- the thickness of the compound


def test_thickness_of_the_compound_is_an_option(tmp_path: Path) -> None:
    case = coarse("nasa-12x36", **SMALL)
    thin, thick = (analyze(case, torques=[100.0], marking=s)["unloaded"].to_dataset() for s in (3.0, 9.0))
    assert (thin.attrs["separation"], thick.attrs["separation"]) == (3.0, 9.0)
    assert thin["pattern_length"] < thick["pattern_length"]
    with pytest.raises(InputError, match="marking = 0: must be a number above 0"):
        analyze(case, marking=0)
    with pytest.raises(InputError, match=r"marking = 1e-308: must be at least 0\.001 \[um\]"):
        analyze(case, marking=1e-308)
    with pytest.raises(InputError, match="marking = nan"):
        write_pictures(tree_of("nasa-12x36", edges=False), tmp_path, marking=math.nan)
    assert "marking = 10000" in refusal_of("run", "nasa-12x36", "-o", tmp_path / "x.nc", "--marking", "1e4")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.thorough
def test_run_and_plot_take_the_thickness(tmp_path: Path) -> None:
    result = tmp_path / "x.nc"
    words = ["run", "nasa-12x36", "-o", result, "--torque", "50", "--marking", "4"]
    output_of(*words)
    assert "print of 4 um" in call("show", result).output
    pictures = []
    for thickness in ("4", "12"):
        folder = tmp_path / thickness
        output_of("plot", result, folder, "--marking", thickness)
        pictures.append((folder / "nasa-12x36-drive-contact_pattern.png").read_bytes())
    assert pictures[0] != pictures[1]


# --- both flanks


def test_pinion_view_shows_the_conjugate_points_true_to_scale() -> None:
    tree = tree_of("fm-11x41", edges=False)
    ease_off, flanks = tree["ease_off"].to_dataset(), tree["flanks"].to_dataset()
    view = tooth_view(tree, "pinion")
    nodes = np.stack(np.meshgrid(ease_off["lengthwise"], ease_off["profile"], indexing="ij"))
    usable = ease_off["inside"].values == 1
    opposite = np.stack([ease_off[f"pinion_{n}"].values for n in ("lengthwise", "profile")])
    np.testing.assert_allclose(view.in_plane(nodes)[:, usable], view.plane(opposite)[:, usable], atol=1e-6)
    position = flanks["position"].sel(member="pinion").values
    section = np.stack([position[..., 2], np.hypot(position[..., 0], position[..., 1])])
    drawn = view.plane(nodes)
    for axis in (1, 2):
        own, other = (np.linalg.norm(np.diff(v, axis=axis), axis=0) for v in (drawn, section))
        np.testing.assert_allclose(own, other, rtol=1e-9)


def test_passage_of_one_pair_repeats_in_the_error_of_the_carrying_one() -> None:
    rotation = np.linspace(-0.75, 0.75, 25)
    error = CarryingError(ToothPassage(-12, 8, 1e-3 * rotation**2), 0.0, 0.5)
    asked = np.linspace(-2.0, 2.0, 101)
    nearest = (asked + 0.25) % 0.5 - 0.25
    np.testing.assert_allclose(error.least(asked), 1e-3 * nearest**2, atol=2e-6)
    assert error.steepest == pytest.approx(2e-3 * 0.25, rel=0.05)


@pytest.mark.parametrize("angle", [0.3, 0.8, 1.2])
def test_the_share_of_a_flank_does_not_depend_on_the_grid(angle: float) -> None:
    """A half plane across the unit square: its share is nearer than the mean of the nodes, on the coarse grid alike."""

    def inside(nodes: tuple[int, int]) -> np.ndarray:
        t, h = np.meshgrid(*(np.linspace(0.0, 1.0, n) for n in nodes), indexing="ij")
        return np.asarray(np.cos(angle) * t + np.sin(angle) * h > 0.4)

    exact = flank_share(inside((1201, 901)))
    for nodes in ((15, 11), (31, 21)):
        assert abs(flank_share(inside(nodes)) - exact) < 0.015
        assert abs(flank_share(inside(nodes)) - exact) < abs(inside(nodes).mean() - exact) + 0.004
    assert flank_share(np.ones((7, 5), dtype=bool)) == 1.0
    assert flank_share(np.arange(5) + np.zeros((11, 1)) > 0) == 0.875  # half a row of cells is outside


# --- what is stored is what was used


@cache
def stored() -> dict[str, xr.Dataset]:
    """Groups of an analysis whose lines end at edges, with friction, on supports, as they are read back."""
    case = read_case("nasa-12x36")
    case = case.model_copy(update={"contact": case.contact.model_copy(update=SMALL | {"mesh_positions": 4})})
    model = FrictionModel(rolling_frame="contact_line")  # flash temperatures are by velocities over the line
    tree = analyze(
        case,
        torques=[50.0, 300.0],
        supports="gearbox-nasa-12x36",
        rounds=AssemblyRounds("none"),
        speed=[500.0, 1500.0],
        temperature=90.0,
        roughness=[0.4, 0.8],
        friction_model=model,
    )
    tree["root_stress"] = analyze(small("fm-11x41", "fe"), torques=[200.0])["root_stress"]
    return {name: group.to_dataset() for name, group in tree.children.items()}


CYCLE, POINT = ("mesh_position",), ("mesh_position", "segment")


def share_of(moment: xr.DataArray, chosen: xr.DataArray) -> xr.DataArray:
    return moment.where(chosen, 0.0).sum("segment") / moment.sum("segment")


def amplitudes(error: xr.DataArray, orders: int) -> NDArray[np.float64]:
    """Of the harmonics of an even number of positions (torque, order), zero where there are none."""
    count = error.sizes["mesh_position"]
    found = np.zeros((error.sizes["torque"], orders))
    whole = np.abs(np.fft.rfft(error.values, axis=1))[:, 1:] * 2.0 / count
    whole[:, -1] /= 2.0
    found[:, : whole.shape[1]] = whole
    return found


def at_greatest(place: xr.DataArray, of: xr.DataArray) -> xr.DataArray:
    """A place over torque, mesh position and segment, or over the mesh position, where something is greatest."""
    which = of.stack(z=POINT).fillna(-np.inf).argmax("z")
    flat = (place + xr.zeros_like(of)).stack(z=POINT).drop_vars(("z", *POINT))
    return flat.isel(z=which)


def recomputed() -> dict[str, dict[str, xr.DataArray]]:
    """By group what the words of result_variables.md make of other variables there."""
    tree = stored()
    loaded, friction, ease_off, supports = (tree[name] for name in ("loaded", "friction", "ease_off", "supports"))
    unloaded, ratio = tree["unloaded"], ease_off.attrs["ratio"]
    on_line, force, error = loaded["overhang"].isnull(), loaded["force"], loaded["transmission_error"]
    moment = (force * loaded["lever_arm"]).fillna(0.0)
    line_load = force / loaded["length"]
    modulus = loaded.attrs["contact_modulus_MPa"]
    band = np.sqrt(8.0 * line_load * loaded["equivalent_radius"] / (np.pi * modulus))
    whole = (2.0 * line_load / (np.pi * loaded["half_width"])).where(on_line & (force > 0.0), 0.0)
    pressure, total = loaded["pressure"], force.sum(POINT)
    centre = {name: (force * loaded[name]).sum(POINT) / total for name in ("lengthwise", "profile")}
    shares = [share_of(moment, loaded["tooth"] == pair) for pair in loaded["pair"].values]
    of_load = {
        "half_width": band.where(on_line, loaded["half_width"]),
        "pressure": whole.where(pressure.notnull()),
        "max_pressure": pressure.max(POINT),
        **{f"max_pressure_{name}": at_greatest(loaded[name], pressure) for name in ("lengthwise", "profile")},
        "max_pressure_pair": at_greatest(loaded["tooth"], pressure),
        "max_pressure_position": at_greatest(loaded["mesh_position"], pressure),
        "peak_to_peak": error.max(CYCLE) - error.min(CYCLE),
        "mean_level": error.mean(CYCLE),
        "harmonic": loaded["harmonic"].copy(data=amplitudes(error, loaded.sizes["order"])),
        "rms": np.sqrt((loaded["harmonic"].sel(order=slice(1, 3)) ** 2).sum("order")),
        "pinion_peak_to_peak": ratio * loaded["peak_to_peak"],
        "pinion_mean_level": ratio * loaded["mean_level"],
        "edge_share": share_of(moment, ~on_line),
        "load_share": xr.concat(shares, loaded["pair"]),
        "max_load_share": loaded["load_share"].max(("mesh_position", "pair")),
        "mean_mesh_stiffness": loaded["mesh_stiffness"].mean(CYCLE),
        "negative_force": (-force.min("segment")).clip(0.0) / force.max("segment"),
        **{f"load_centre_{name}": found for name, found in centre.items()},
        **{
            f"load_extent_{name}": np.sqrt((force * (loaded[name] - found) ** 2).sum(POINT) / total)
            for name, found in centre.items()
        },
    }
    omega = 2.0 * np.pi / 60.0 * friction["speed"]
    sliding, rolling = friction["sliding_velocity"], friction["rolling_velocity"]
    heat = friction["friction_coefficient"] * 1e3 * line_load * sliding
    over_line = [rolling + sign * 0.5 * friction["sliding_across"] for sign in (-1.0, 1.0)]
    given = xr.broadcast(heat, 1e-3 * loaded["half_width"], *over_line)
    flash = flash_temperature(given[0].values, given[1].values, (given[2].values, given[3].values))
    loss, film = friction["power_loss"], friction["film_thickness"].where(on_line)
    flags = friction["formula_flags"].astype(int)
    by_flag = [loss.where(flags & int(flag) > 0, 0.0).sum(POINT) for flag in friction["formula_flag"].values]
    least = {name: at_greatest(loaded[name], -film) for name in ("lengthwise", "profile")}
    hottest = {name: at_greatest(loaded[name], friction["flash_temperature"]) for name in ("lengthwise", "profile")}
    of_friction = {
        "sliding_velocity": np.hypot(friction["sliding_along"], friction["sliding_across"]),
        "slide_to_roll": (abs(friction["sliding_across"]) / rolling).isel(speed=0, drop=True),
        "lambda_ratio": friction["film_thickness"] / np.hypot(friction["roughness_pinion"], friction["roughness_gear"]),
        "flash_temperature": given[0].copy(data=flash).where(on_line),
        "pressure_velocity": pressure.where(force > 0.0) * sliding,
        "mesh_power_loss": loss.sum("segment"),
        "input_power": friction["torque"] * omega,
        "mesh_efficiency": 1.0 - friction["mesh_power_loss"] / friction["input_power"],
        "mean_power_loss": friction["mesh_power_loss"].mean(CYCLE),
        "mean_sliding_loss": (friction["friction_coefficient"] * force * sliding).sum("segment").mean(CYCLE),
        "mean_rolling_loss": friction["mean_power_loss"] - friction["mean_sliding_loss"],
        "efficiency": friction["mesh_efficiency"].mean(CYCLE),
        "mean_friction_coefficient": friction["mean_sliding_loss"] / (force * sliding).sum("segment").mean(CYCLE),
        "flagged_share": xr.concat(by_flag, friction["formula_flag"]) / loss.sum(POINT),
        "max_flash_temperature": friction["flash_temperature"].max(POINT),
        "max_contact_temperature": friction["bulk_temperature"] + friction["max_flash_temperature"],
        "max_pressure_velocity": friction["pressure_velocity"].max(POINT),
        "max_flash_position": at_greatest(loaded["mesh_position"], friction["flash_temperature"]),
        **{f"max_flash_{name}": found for name, found in hottest.items()},
        "min_film_thickness": film.min(POINT),
        "min_film_position": at_greatest(loaded["mesh_position"], -film),
        **{f"min_film_{name}": found for name, found in least.items()},
    }
    parts = ("teeth_rotation", "contact_rotation", "supports_rotation", "ease_off_rotation")
    return {
        "loaded": of_load,
        "friction": of_friction,
        "ease_off": {"ease_off": 1e3 * ease_off["ease_off_angle"] * ease_off["lever_arm"]},
        "unloaded": {
            "transmission_error_envelope": unloaded["transmission_error"].sel(pair=unloaded["carrying_pair"]),
            "pinion_peak_to_peak": xr.DataArray(ratio * unloaded.attrs["peak_to_peak"]),
        },
        "root_stress": {"max_root_stress": tree["root_stress"]["root_stress_history"].max(("mesh_position", "pair"))},
        "supports": {
            "whole_rotation": sum((supports[name] for name in parts[1:]), supports[parts[0]]),
            "transmission_error": supports["whole_rotation"] - supports["support_rotation"],
        },
    }


#: Words of a formula, and variables that have them of what is not stored.
FORMULA = re.compile(
    r"\b(peak to peak|mean|greatest|least|share|sum|over|times|less|residual|efficiency|ratio|amplitude|part of)\b"
)
NOT_STORED = {
    "loaded": {
        *("equilibrium", "negative_gap", "complementarity", "duality_gap", "cancellation", "contact_ratio"),
        *("max_pressure_line_end", "pattern_length", "pattern_height"),
    },
    "friction": {
        # Which contacts these are of is not stored, nor the velocity of either surface.
        *("film_thinning", "thinned_share", "extrapolated_share", "transition_share", "friction_coefficient"),
        *("film_thickness", "rolling_velocity", "sliding_across"),
    },
    "ease_off": {"blade_distance"},
    "unloaded": {"contact_ratio", "geometric_contact_ratio", "least_gap", "pattern_length", "pattern_height"},
    "root_stress": {"root_stress", "root_stress_history"},  # each along the face or over the cycle, not both
    "supports": {"last_change", "support_rotation", "teeth_rotation", "contact_rotation", "supports_rotation"}
    | {"ease_off_rotation"},
}


@pytest.mark.thorough
def test_every_variable_with_a_formula_is_what_it_makes_of_stored_ones() -> None:
    """Widths at the ends of contact lines were once not those of pressures and flash temperatures there."""
    for group, formulas in recomputed().items():
        known = stored()[group]
        worded = {
            str(name)
            for name, one in known.data_vars.items()
            if FORMULA.search(f"{one.attrs['long_name']} {one.attrs.get('comment', '')}")
        }
        assert worded <= formulas.keys() | NOT_STORED[group] | {"fine_envelope"}, group
        for name, made in formulas.items():
            one = known[name]
            found = (made + xr.zeros_like(one).fillna(0.0)).transpose(*one.dims)
            scale = float(np.abs(one).max())
            np.testing.assert_allclose(found, one, rtol=1e-9, atol=1e-12 * scale, err_msg=f"{group}/{name}")
