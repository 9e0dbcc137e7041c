"""The whole blade: sections that join, each cut surface an envelope, curved flanks against other formulations."""

from __future__ import annotations

import itertools
import math
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from extreme_designs import Extreme
from numpy.typing import NDArray
from pairs import DRIVE_BLADE, GEAR_BLANK, GEAR_MACHINE, GENERATED, GROUPS, conjugate_pair
from scipy.optimize import brentq

from easeoff import InputError
from easeoff.cases import case_text, gear_pair, parse_case, parse_design, read_case
from easeoff.geometry import (
    Assembly,
    Blade,
    GearPair,
    GeneratingSurface,
    Hand,
    Member,
    conjugate_pinion,
    pair_geometry,
    principal_curvatures,
)
from easeoff.geometry.cutting.blade import Relief
from easeoff.geometry.cutting.machine import work_rotation
from easeoff.geometry.flanks.blank_section import BlankSection
from easeoff.geometry.flanks.flank import NodeStatus, mean_parameters, solve_flank
from easeoff.geometry.pair.ease_off import exact_ease_off
from easeoff.geometry.pair.gear_pair import grid
from easeoff.geometry.pair.tooth_thickness import unmet_tips
from easeoff.geometry.tooth.tooth_surface import TOE_MIDDLE_HEEL, tip_gap
from easeoff.geometry.vectors import rotate_z
from easeoff.study import design_case

WHOLE = Blade(
    75.0,
    math.radians(18.0),
    "outside",
    spheric_radius=700.0,
    edge_radius=0.9,
    toprem=Relief(2.2, math.radians(4.0), 60.0),
    flankrem=Relief(8.5, math.radians(2.0), 90.0),
)
BLADES = {
    "plain": Blade(75.0, math.radians(18.0), "outside"),
    "edge": Blade(75.0, math.radians(18.0), "outside", edge_radius=0.8),
    "curved": Blade(75.0, math.radians(18.0), "inside", spheric_radius=-600.0, reference_height=4.0, edge_radius=1.1),
    "toprem": Blade(75.0, math.radians(18.0), "outside", edge_radius=0.8, toprem=Relief(2.0, math.radians(5.0))),
    "whole": WHOLE,
}


@pytest.mark.parametrize("name", BLADES)
def test_sections_join(name: str) -> None:
    """End to end without a gap; with a kink of the relief's angle at a relief, without one at the edge radius."""
    sections = list(BLADES[name].sections.values())
    kinks = {"toprem": BLADES[name].toprem, "flankrem": BLADES[name].flankrem}
    for lower, upper in itertools.pairwise(sections):
        assert lower.end == upper.begin
        assert lower.point(lower.end) == pytest.approx(upper.point(upper.begin), abs=1e-12)
        relief = kinks.get(upper.name) if upper.name == "flankrem" else kinks.get(lower.name)
        kink = relief.angle if relief is not None else 0.0
        assert upper.angle - lower.angle_at(lower.end) == pytest.approx(kink, abs=1e-12)
    tip = sections[0]
    assert tip.point(-1.0)[1] == pytest.approx(0.0, abs=1e-12)
    assert tip.angle_at(-1.0) == pytest.approx(math.pi / 2)


def test_sections_are_arcs_of_their_radius() -> None:
    """Every point of an arc is one radius away from its centre, and the coordinate counts millimetres."""
    for section in WHOLE.sections.values():
        assert section.radius is not None
        end = min(section.end, section.begin + 5.0)
        places = np.linspace(section.begin, end, 201)
        points = np.array([section.point(place) for place in places])
        np.testing.assert_allclose(np.linalg.norm(points - section.center, axis=1), abs(section.radius), rtol=1e-13)
        if section.name != "edge":
            length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
            assert length == pytest.approx(end - section.begin, rel=1e-5)


def test_whole_edge_is_that_of_another_programs_tool() -> None:
    """Centres of four arcs from radius, angles and depths, as an open reading of HypoidFaceMilled (SpyGO) has them.

    The relations are written anew; no code of it is here.
    There the tip plane is z = 0, the body at negative z, and toprem and flankrem turn the angle of the blade at their
    depth by an angle of their own.
    """
    point, edge, blade, angle = 80.0, 0.7, 900.0, math.radians(19.0)
    toprem, flankrem = Relief(2.0, math.radians(3.0), 120.0), Relief(8.0, math.radians(1.5), 150.0)
    assert toprem.radius is not None
    assert flankrem.radius is not None
    height = blade * math.sin(angle)
    across = point + blade * math.cos(angle)
    low, high = (math.asin((height + relief.height) / blade) for relief in (toprem, flankrem))
    start, end = low - toprem.angle, high + flankrem.angle
    top = (
        across + toprem.radius * math.cos(start) - blade * math.cos(low),
        toprem.radius * math.sin(start) - toprem.height,
    )
    foot = math.asin((top[1] + edge) / (toprem.radius + edge))
    centers = {
        "edge": (top[0] - (toprem.radius + edge) * math.cos(foot), -edge),
        "toprem": top,
        "profile": (across, height),
        "flankrem": (
            across + flankrem.radius * math.cos(end) - blade * math.cos(high),
            flankrem.radius * math.sin(end) - flankrem.height,
        ),
    }
    ends = {"edge": (math.pi / 2, foot), "toprem": (foot, start), "profile": (low, high)}
    sections = Blade(
        point, angle, "outside", spheric_radius=blade, edge_radius=edge, toprem=toprem, flankrem=flankrem
    ).sections
    assert list(sections) == list(centers)
    for name, section in sections.items():
        assert (point + section.center[0], -section.center[1]) == pytest.approx(centers[name], abs=1e-11)
        if name in ends:
            assert (section.angle, section.angle_at(section.end)) == pytest.approx(ends[name], abs=1e-13)


def test_curved_profile_touches_its_pressure_line() -> None:
    blade = replace(BLADES["curved"], edge_radius=0.0)
    profile = blade.sections["profile"]
    place = profile.at_height(4.0)
    assert profile.point(place)[0] == pytest.approx(4.0 * math.tan(blade.pressure_angle), abs=1e-12)
    assert profile.angle_at(place) == pytest.approx(blade.pressure_angle)


@pytest.mark.parametrize("indexing", [0.0, GROUPS / 11])
def test_large_radius_tends_to_the_straight_blade(indexing: float) -> None:
    """The difference is of first order in the curvature."""
    parameters = np.array([[-2.1, -2.0, -1.9], [-0.1, 0.0, 0.15]])
    settings = replace(GENERATED, indexing_ratio=indexing)
    plain = GeneratingSurface(Blade(75.0, 0.3, "outside", edge_radius=0.8), settings, "right", -1)

    def difference(radius: float) -> float:
        curved = replace(plain, blade=replace(plain.blade, spheric_radius=radius))
        return float(np.abs(curved.evaluate(parameters)[0] - plain.evaluate(parameters)[0]).max())

    assert difference(1e6) / difference(2e6) == pytest.approx(2.0, rel=1e-3)
    assert difference(1e9) < 1e-4


@pytest.mark.parametrize("indexing", [0.0, GROUPS / 11])
@pytest.mark.parametrize("part", ["edge", "toprem", "profile", "flankrem"])
def test_every_section_cuts_an_envelope(part: str, indexing: float) -> None:
    """Blade, cutter and cradle derivatives of the blade points lie in one plane, by finite differences."""
    settings = replace(GENERATED, indexing_ratio=indexing)
    blade = replace(WHOLE, offset_angle=0.2, rake_angle=0.05, hook_angle=-0.08) if indexing else WHOLE
    surface = GeneratingSurface(blade, settings, "right", -1).on(part)  # type: ignore[arg-type]
    still = replace(settings, ratio_of_roll=None, modified_roll=())

    def family(angle: float, place: float, cradle: float) -> np.ndarray:
        turned = replace(surface, settings=replace(still, cradle_angle=settings.cradle_angle + cradle))
        point = turned.evaluate(np.array([[angle], [place]]))[0]
        return rotate_z(-work_rotation(settings, np.array([cradle]), -1)[0], point)[:, 0]

    angles, cradles = np.linspace(-2.3, -1.9, 4), np.array([-0.1, 0.0, 0.1, 0.2])
    position, normals, places = surface.evaluate(np.stack([angles, cradles]))
    for index, (angle, place, cradle) in enumerate(zip(angles, places, cradles, strict=True)):
        np.testing.assert_allclose(family(angle, place, cradle), position[:, index], atol=1e-9)
        here, h = np.array([angle, place, cradle]), 1e-5
        derivatives = [(family(*(here + h * e)) - family(*(here - h * e))) / (2 * h) for e in np.eye(3)]
        assert max(abs(v @ normals[:, index]) / np.linalg.norm(v) for v in derivatives) < 1e-7


def test_edge_of_no_radius_is_the_path_of_the_corner() -> None:
    surface = GeneratingSurface(BLADES["plain"], GENERATED, "right", -1)
    parameters = np.array([[-2.1, -2.0], [-0.1, 0.1]])
    still = replace(GENERATED, ratio_of_roll=None, modified_roll=())
    corner, _, _ = surface.on("edge").evaluate(parameters)
    for (angle, cradle), point in zip(parameters.T, corner.T, strict=True):
        turned = replace(surface, settings=replace(still, cradle_angle=GENERATED.cradle_angle + cradle))
        tip = turned.evaluate(np.array([[angle], [0.0]]))[0]
        expected = rotate_z(-work_rotation(GENERATED, np.array([cradle]), -1)[0], tip)[:, 0]
        np.testing.assert_allclose(point, expected, atol=1e-9)


@pytest.mark.parametrize(("hand", "coast"), [("left", False), ("right", True)])
@pytest.mark.parametrize("radius", [700.0, -700.0, 120.0])
@pytest.mark.parametrize("hobbed", [False, True])
def test_conjugate_pinion_of_a_curved_blade_has_no_ease_off(
    hobbed: bool, radius: float, hand: Hand, coast: bool
) -> None:
    blade = replace(DRIVE_BLADE, spheric_radius=radius, reference_height=3.0, side="outside" if coast else "inside")
    if hobbed:
        blade = replace(blade, offset_angle=0.2, rake_angle=0.05, hook_angle=-0.08)
    machine = replace(GEAR_MACHINE, indexing_ratio=GROUPS / 41 if hobbed else 0.0)
    gear = GeneratingSurface(blade, machine, "right" if hand == "left" else "left", 1)
    pair = conjugate_pair(hand, coast=coast)
    assembly = Assembly(11, 41, hand, math.pi / 2, 20.0)
    pinion = conjugate_pinion(gear, assembly, 9.83)
    t, h = grid((9, 7))
    result = exact_ease_off(Member(41, GEAR_BLANK, gear).flank(t, h), pinion, pair.pinion.section, assembly)
    known = np.isfinite(result.angle)
    assert known.mean() > 0.8
    values, lever = (result.angle * result.lever_arm)[known], result.lever_arm[known]
    assert np.abs(values - lever * (lever @ values) / (lever @ lever)).max() < 1e-9


def test_hollow_blade_crowns_the_profile() -> None:
    """Against the straight blade the gap grows with the square of the distance from the tangent point, over 2 R."""
    pair = conjugate_pair()
    straight, t = pair.gear.loaded, np.array([0.5])
    radius, height = 500.0, 5.0
    hollow = replace(straight, blade=replace(straight.blade, spheric_radius=radius, reference_height=height))
    flanks = [Member(41, GEAR_BLANK, s).flank(t, np.linspace(0.1, 0.9, 9)) for s in (straight, hollow)]
    gap = -np.sum((flanks[1].position - flanks[0].position) * flanks[0].normal, axis=0)
    along = flanks[0].blade_distance - height / math.cos(straight.blade.pressure_angle)
    np.testing.assert_allclose(gap, along**2 / (2 * radius), rtol=0.03, atol=2e-5)


def _relieved(pair: GearPair) -> Member:
    blade = replace(
        pair.gear.loaded.blade, edge_radius=0.5, toprem=Relief(3.0, math.radians(1.5)), flankrem=Relief(7.5, 0.0, 200.0)
    )
    return replace(pair.gear, loaded=replace(pair.gear.loaded, blade=blade))


def test_reliefs_remove_metal_where_they_should() -> None:
    """A Formate flank with reliefs lies in the metal of the plain one by the relief's own geometry, and nowhere out."""
    pair = conjugate_pair()
    relieved, (t, h) = _relieved(pair), grid((7, 41))
    plain, flank = pair.gear.flank(t, h), relieved.flank(t, h)
    parts = [part.part for part in relieved.loaded.flank_parts]
    assert parts == ["toprem", "profile", "flankrem"]
    assert set(np.unique(flank.part)) == {0, 1, 2}
    gap = -np.sum((flank.position - plain.position) * plain.normal, axis=0)
    angle = pair.gear.loaded.blade.pressure_angle
    height = plain.blade_distance * math.cos(angle)
    assert gap[flank.part == 1] == pytest.approx(0.0, abs=1e-12)
    low = flank.part == 0
    np.testing.assert_allclose(
        gap[low], (3.0 - height[low]) / math.cos(angle) * math.tan(math.radians(1.5)), rtol=0.015
    )
    high = flank.part == 2
    np.testing.assert_allclose(gap[high], ((height[high] - 7.5) / math.cos(angle)) ** 2 / 400.0, rtol=0.05, atol=1e-7)
    assert np.all(height[low] < 3.0 + 1e-9)
    assert np.all(height[high] > 7.5 - 1e-9)


def test_reliefs_of_either_member_show_in_the_ease_off() -> None:
    """A relieved gear on its conjugate pinion has the relief as ease-off, as has the same relief on the pinion."""
    pair = conjugate_pair()
    t, h = grid((9, 15))
    exact = exact_ease_off(pair.gear.flank(t, h), pair.pinion.loaded, pair.pinion.section, pair.assembly)
    gear = _relieved(pair).flank(t, h)
    found = exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)
    gap = (found.angle - exact.angle) * exact.lever_arm
    removed = -np.sum((gear.position - pair.gear.flank(t, h).position) * gear.normal, axis=0)
    known = np.isfinite(gap)
    np.testing.assert_allclose(gap[known], removed[known], rtol=0.02, atol=1e-6)
    pinion = replace(pair.pinion.loaded, blade=replace(pair.pinion.loaded.blade, toprem=Relief(2.5, math.radians(2.0))))
    relieved = exact_ease_off(pair.gear.flank(t, h), pinion, pair.pinion.section, pair.assembly)
    gap = (relieved.angle - exact.angle) * exact.lever_arm
    known = np.isfinite(gap)
    assert np.nanmin(gap) > -1e-10
    low = exact.blade_distance < 2.4 / math.cos(pair.pinion.loaded.blade.pressure_angle)
    assert np.nanmax(gap[known & low]) > 0.02
    assert relieved.pinion_position[:, known] == pytest.approx(relieved.pinion_position[:, known])
    geometry = pair_geometry(replace(pair, pinion=replace(pair.pinion, loaded=pinion)), (9, 7))
    assert np.isfinite(geometry.ease_off["ease_off"].values).mean() > 0.8


def test_curvature_follows_the_part() -> None:
    """Up a Formate flank the normal curvature of an arc is one over its radius, of a straight line zero."""
    relieved = _relieved(conjugate_pair())
    flank = relieved.flank(np.array([0.5]), np.linspace(0.1, 0.95, 15))
    curvature = principal_curvatures(flank).curvature
    assert np.abs(curvature[:, flank.part < 2]).min(axis=0) == pytest.approx(0.0, abs=1e-12)
    top = curvature[:, flank.part == 2]
    assert np.any(np.isclose(np.abs(top), 1.0 / 200.0, rtol=1e-9), axis=0).all()


def test_curved_flank_in_another_formulation() -> None:
    """Surface of revolution on a chain of rotations, meshing by a root search: the same points to 1e-9 mm."""
    blade = replace(BLADES["curved"], edge_radius=0.0)
    surface = GeneratingSurface(blade, GENERATED, "right", -1)
    s, radius, alpha = GENERATED, blade.spheric_radius, blade.pressure_angle
    assert radius is not None

    def turn(axis: int, angle: float) -> np.ndarray:
        c, n = math.cos(angle), math.sin(angle)
        i, j = ((1, 2), (2, 0), (0, 1))[axis]
        matrix = np.eye(3)
        matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -n, n, c
        return matrix

    def to_work(point: np.ndarray, cradle: float) -> np.ndarray:
        cutter = turn(2, -s.cutter_swivel) @ turn(0, s.cutter_tilt)
        in_machine = turn(2, s.cradle_angle + cradle) @ (cutter @ point + np.array([s.radial_distance, 0.0, 0.0]))
        in_machine -= np.array([0.0, s.work_offset, s.sliding_base])
        x, y, z = turn(1, s.machine_root_angle) @ in_machine
        x -= s.machine_center_to_crossing_point
        roll, _ = work_rotation(s, np.array([cradle]), -1)
        return np.asarray(turn(2, -float(roll[0])) @ np.array([-z, y, x]))

    def on_cone(theta: float, along: float) -> tuple[np.ndarray, np.ndarray]:
        height = 4.0 * math.tan(alpha), 4.0
        angle = alpha + along / radius
        outward = height[0] + radius * (math.cos(alpha) - math.cos(angle))
        up = height[1] + radius * (math.sin(angle) - math.sin(alpha))
        r = blade.point_radius - outward
        normal = -math.cos(angle), math.sin(angle)
        direction = np.array([math.cos(theta), math.sin(theta), 0.0])
        return r * direction - np.array([0, 0, up]), normal[0] * direction + np.array([0, 0, normal[1]])

    for theta, cradle in ((-2.1, -0.05), (-2.0, 0.0), (-1.9, 0.1)):

        def meshing(along: float, theta: float = theta, cradle: float = cradle) -> float:
            point, normal = on_cone(theta, along)
            h = 1e-6
            speed = (to_work(point, cradle + h) - to_work(point, cradle - h)) / (2 * h)
            origin = to_work(np.zeros(3), cradle)
            return float(speed @ (to_work(normal, cradle) - origin))

        expected, _, place = surface.evaluate(np.array([[theta], [cradle]]))
        near = float(place[0]) - blade.sections["profile"].at_height(4.0)
        along = brentq(meshing, near - 3.0, near + 3.0, xtol=1e-12)
        np.testing.assert_allclose(to_work(on_cone(theta, along)[0], cradle), expected[:, 0], atol=1e-6)


def _with_cutter(lines: str) -> str:
    plain = re.sub(r"tool_edge_radius = .*\n", "", case_text("fm-11x41"))
    return plain.replace("[gear.convex.cutter]", f"[gear.convex.cutter]\n{lines}")


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("toprem_angle = 2.0", "toprem_depth"),
        ("toprem_depth = 2.0", "toprem_angle or toprem_radius"),
        ("toprem_depth = 0.3\ntoprem_angle = 2.0\ntool_edge_radius = 2.0", "edge radius"),
        ("flankrem_depth = 0.3\nflankrem_angle = 2.0\ntool_edge_radius = 2.0", "flankrem_depth"),
        ("blade_spheric_radius = 0.5", "must be above 1 mm or below -1 mm"),
        ("blade_reference_height = 3.0", "blade_spheric_radius"),
        ("tool_edge_radius = -1.0", "at least 0"),
        ("blade_spheric_radius = 5.0\nblade_reference_height = 30.0", "no such arc"),
    ],
)
def test_blades_that_cannot_be_made(lines: str, message: str) -> None:
    text = _with_cutter(lines)
    with pytest.raises(InputError, match=message):
        gear_pair(parse_case(text))


def test_case_file_takes_a_whole_blade() -> None:
    lines = (
        "blade_spheric_radius = 800.0\nblade_reference_height = 3.0\ntool_edge_radius = 0.8\ntoprem_depth = 2.0\n"
        "toprem_angle = 1.5\nflankrem_depth = 8.0\nflankrem_radius = 150.0"
    )
    text = _with_cutter(lines)
    blade = gear_pair(parse_case(text)).gear.loaded.blade
    assert (blade.spheric_radius, blade.reference_height, blade.edge_radius) == (800.0, 3.0, 0.8)
    assert blade.toprem == Relief(2.0, math.radians(1.5))
    assert blade.flankrem == Relief(8.0, 0.0, 150.0)
    assert solve_flank(
        gear_pair(parse_case(text)).gear.loaded, GEAR_BLANK, *GEAR_BLANK.points(np.array([0.5]), np.array([0.5]))
    ).inside.all()


def test_a_part_does_not_stand_in_for_another() -> None:
    """Where the profile has no point at the root, a flankrem high above cuts none either, far beyond its end."""
    pair = gear_pair(read_case("fm-11x41"), "coast")
    plain = pair.pinion.loaded
    relieved = replace(plain, blade=replace(plain.blade, flankrem=Relief(5.76, math.radians(1.0))))
    t, h = np.meshgrid(np.linspace(0.0, 0.2, 9), np.linspace(0.0, 0.3, 9), indexing="ij")
    low = pair.pinion.section.points(t.ravel(), h.ravel())
    before, after = (solve_flank(surface, pair.pinion.section, *low) for surface in (plain, relieved))
    assert np.any(before.status == NodeStatus.NO_SOLUTION)
    np.testing.assert_array_equal(after.status, before.status)
    one = pair.pinion.section.points(np.array([0.0646]), np.array([0.0375]))
    assert not solve_flank(relieved, pair.pinion.section, *one).inside.any()


# --- Tips of blades


Array = NDArray[Any]


def deepest_of_the_sweep(surface: GeneratingSurface, section: BlankSection) -> Array:
    """Least height of the blade's tip above the root cone next to toe, middle and heel (3) [mm]."""
    cutter, cradle = mean_parameters(surface, section)
    angles = np.meshgrid(cutter + np.linspace(-0.7, 0.7, 281), cradle + np.linspace(-0.9, 0.9, 361), indexing="ij")
    edge = surface.on("edge")
    points, _, _ = edge.at_coordinate(np.stack([a.ravel() for a in angles]), -1.0)
    radial = np.hypot(points[0], points[1])
    lengthwise, _ = section.fractions(points[2], radial)
    height = section.height_above_root(points[2], radial)
    return np.array([height[np.abs(lengthwise - t) < 0.03].min() for t in TOE_MIDDLE_HEEL])


@pytest.mark.parametrize(("name", "side"), [("fm-11x41", "drive"), ("fm-11x41", "coast"), ("nasa-12x36", "drive")])
def test_tip_gap_is_the_deepest_point_of_the_sweep(name: str, side: Any) -> None:
    pinion = gear_pair(read_case(name), side).pinion
    swept = deepest_of_the_sweep(pinion.loaded, pinion.section)
    assert tip_gap(pinion.loaded, pinion.section) == pytest.approx(swept, abs=0.02)


def rounded(pair: GearPair, radius: float) -> GearPair:
    pinion = pair.pinion
    blade = replace(pinion.loaded.blade, edge_radius=radius)
    return replace(pair, pinion=replace(pinion, loaded=replace(pinion.loaded, blade=blade)))


def test_a_fillet_that_grows_takes_the_flank_from_the_mates_tip() -> None:
    """The pinion's tip still meets the whole gear, whose blade is as it was."""
    pair = gear_pair(read_case("fm-11x41"))
    shares = [unmet_tips(rounded(pair, radius)) for radius in (0.3, 2.0, 4.0)]
    of_pinion, of_gear = zip(*shares, strict=True)
    assert of_pinion == (0.0, 0.0, 0.0)
    assert of_gear[0] == 0.0 <= of_gear[1] <= of_gear[2] == 1.0


@pytest.mark.thorough
@pytest.mark.parametrize("spiral", [0.0, 35.0])
def test_pair_of_equal_teeth_has_whole_teeth_and_blade_tips_on_the_root(spiral: float) -> None:
    """Generated flanks of few teeth end far above the root cone, where the mate's tip hardly comes: at one end at most.

    The shares do not depend on the last digits of linear algebra: the fit ends where passes change nothing.
    """
    extreme = Extreme((20, 20), module=6.0, spiral=spiral, generated=True, addendum=0.5, thickness=0.0, face=0.236)
    case, report = design_case(parse_design(extreme.text("closest_fit")))
    assert report.analysable
    for side in ("drive", "coast"):
        pair = gear_pair(case, side)
        at_one_end = 0.15 if spiral == 0.0 and side == "coast" else 0.0
        assert max(unmet_tips(pair)) <= at_one_end
        told = any(warning.startswith(side) and "undercut" in warning for warning in report.warnings)
        assert told == (max(unmet_tips(pair)) > 0.0)
        assert np.abs(tip_gap(pair.pinion.loaded, pair.pinion.section)).max() < 0.05
        assert report.sides[side].root_gap == pytest.approx(tip_gap(pair.pinion.loaded, pair.pinion.section), abs=1e-6)


@pytest.mark.thorough
def test_an_undercut_pinion_is_told_by_the_mates_tip() -> None:
    """A gear of 45 degrees without generation wants a pinion that no cutter leaves a root."""
    extreme = Extreme((20, 20), module=6.0, addendum=0.5, thickness=0.0, face=0.236)
    _, report = design_case(parse_design(extreme.text("closest_fit")))
    assert any("the gear's tip meets no flank" in warning for warning in report.warnings)
    assert any('generation = "generated"' in warning for warning in report.warnings)
