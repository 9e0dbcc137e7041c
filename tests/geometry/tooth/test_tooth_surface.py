"""The real tooth: what the cutter leaves when it has been everywhere; thickness, and the foot of the contact normal."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from numpy.polynomial import legendre
from pairs import conjugate_pair

from easeoff import GeometryError
from easeoff.cases import case_text, gear_pair, parse_case, read_case
from easeoff.geometry import BladeSection, GearPair, GeneratingSurface, tooth_patches
from easeoff.geometry.cutting.machine import machine_pose
from easeoff.geometry.flanks.flank import solve_flank
from easeoff.geometry.pair.gear_pair import bodies
from easeoff.geometry.pair.tooth_body import ToothBody, tooth_body
from easeoff.geometry.tooth import tooth
from easeoff.geometry.tooth.tooth_flanks import side
from easeoff.geometry.tooth.tooth_surface import tooth_side, tooth_surface
from easeoff.geometry.vectors import dot, rotate_z

NODES = (7, 9)


def nasa(edge_radius: float = 0.6) -> GearPair:
    text = re.sub(r"(blade_pressure_angle = .*)", rf"\1\ntool_edge_radius = {edge_radius}", case_text("nasa-12x36"))
    return gear_pair(parse_case(text))


def _from_section(section: BladeSection, outward: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Signed distance (n) [mm] of points in the blade's plane from a section, positive on the side of the metal."""
    end = min(section.end, section.begin + 25.0)
    if section.radius is None:
        along = (outward - section.outward) * math.sin(section.angle)
        along += (height - section.height) * math.cos(section.angle)
        places = np.clip(section.begin + along, section.begin, end)
    else:
        side = np.sign(section.radius)
        angle = np.arctan2(side * (height - section.center[1]), -side * (outward - section.center[0]))
        places = np.clip(section.begin + (angle - section.angle) / section.rate, section.begin, end)
    at = np.array([(*section.point(place), section.angle_at(place)) for place in places])
    dx, dy = outward - at[:, 0], height - at[:, 1]
    return np.asarray(np.sign(dx * np.cos(at[:, 2]) - dy * np.sin(at[:, 2])) * np.hypot(dx, dy))


def clearance_to_cutter(surface: GeneratingSurface, points: np.ndarray) -> np.ndarray:
    """Smallest distance (n) [mm] of points (3, n) from the cutter's body over all cradle rotations, face milling.

    Point by point into the cutter's frame, and there from the outline of the blade: a check that knows nothing of the
    equation of meshing.
    """
    if surface.hand == "left":
        points = points * np.array([[1.0], [-1.0], [1.0]])
    blade = surface.blade

    def gap(cradle: np.ndarray) -> np.ndarray:
        pose = machine_pose(surface.settings, cradle, surface.sense)
        x, y, z = rotate_z(pose.work, points)
        cosine, sine = pose.root_turn
        machine = np.stack([sine * x + cosine * z, y, -cosine * x + sine * z])
        in_cradle = rotate_z(-pose.cradle, machine) + pose.origin - pose.center
        axial = dot(in_cradle, pose.frame[2])
        radius = np.sqrt(dot(in_cradle, in_cradle) - axial**2)
        outward = blade.side_sign * (radius - blade.point_radius)
        height = -axial
        distances = [_from_section(section, outward, height) for section in blade.sections.values()]
        nearest = np.argmin(np.abs(distances), axis=0)
        return np.asarray(np.take_along_axis(np.array(distances), nearest[None], axis=0)[0])

    smallest = np.full(points.shape[1], np.inf)
    middle = np.zeros(points.shape[1])
    for width, count in ((0.6, 61), (0.03, 31), (0.003, 31)):
        tries = middle + np.linspace(-width, width, count)[:, None]
        gaps = np.array([gap(row) for row in tries])
        at = np.argmin(gaps, axis=0)
        middle = np.take_along_axis(tries, at[None], axis=0)[0]
        smallest = np.minimum(smallest, gaps.min(axis=0))
    return smallest


@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_cutter_touches_the_whole_side_and_enters_it_nowhere(member: str) -> None:
    """Over all positions of the cradle the body of the cutter comes as near as zero to every point, never nearer."""
    which = getattr(nasa(), member)
    side = tooth_side(which.loaded, which.section, (0.0, 0.5, 1.0), 5, 5)
    points = np.concatenate([side.fillet.reshape(3, -1), side.flank.reshape(3, -1)], axis=1)
    np.testing.assert_allclose(clearance_to_cutter(which.loaded, points), 0.0, atol=2e-5)


@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_fillet_runs_smoothly_into_the_flank(member: str) -> None:
    """Same point and same normal at the joint; at the other end the normal is that of the root land."""
    which = getattr(nasa(), member)
    side = tooth_side(which.loaded, which.section, (0.0, 0.25, 0.5, 0.75, 1.0), 9)
    joint = side.fillet[:, :, -1]
    flank = solve_flank(which.loaded, which.section, joint[2], np.hypot(joint[0], joint[1]))
    np.testing.assert_allclose(flank.position, joint, atol=1e-9)
    np.testing.assert_allclose(flank.normal, side.fillet_normal[:, :, -1], atol=1e-9)
    np.testing.assert_allclose(flank.blade_distance, 0.0, atol=1e-9)
    np.testing.assert_array_equal(side.flank[:, :, 0], joint)


def test_formate_fillet_is_a_torus() -> None:
    """In the cutter's frame every point of the fillet is one edge radius away from the circle of its centre."""
    pair = conjugate_pair()
    loaded = replace(pair.gear.loaded, blade=replace(pair.gear.loaded.blade, edge_radius=0.9))
    side = tooth_side(loaded, pair.gear.section, (0.0, 0.25, 0.5, 0.75, 1.0), 9)
    pose = machine_pose(loaded.settings, np.zeros(1), loaded.sense)
    still = np.zeros(1)
    center, axis = pose.to_member(pose.center, still, point=True), pose.to_member(pose.frame[2], still, point=False)
    points = side.fillet.reshape(3, -1) - center
    along = dot(points, axis)
    radius = np.sqrt(dot(points, points) - along**2)
    blade = loaded.blade
    of_center = blade.point_radius + blade.side_sign * blade.sections["edge"].center[0]
    np.testing.assert_allclose(np.hypot(radius - of_center, -along - 0.9), 0.9, atol=1e-12)


@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_patches_share_their_borders(member: str, flank: str) -> None:
    text = re.sub(r"(blade_pressure_angle = .*)", r"\1\ntool_edge_radius = 0.5", case_text("nasa-12x36"))
    pair = gear_pair(parse_case(text), flank)  # type: ignore[arg-type]
    patches = tooth_patches(pair, member, NODES)
    assert set(patches) == {"top_land"} | {
        f"{side}_{part}" for side in ("concave", "convex") for part in ("flank", "fillet", "root_land")
    }
    loaded = side(getattr(pair, member).loaded)
    other = "convex" if loaded == "concave" else "concave"
    for own, top in ((loaded, 0), (other, -1)):
        flank_grid, fillet, land = (patches[f"{own}_{part}"] for part in ("flank", "fillet", "root_land"))
        tip, top_edge = (
            sorted(p.tolist(), key=lambda q: q[2]) for p in (flank_grid[:, -1], patches["top_land"][:, top])
        )
        np.testing.assert_allclose(tip, top_edge, atol=1e-12)
        np.testing.assert_allclose(flank_grid[:, 0], fillet[:, -1], atol=1e-12)
        np.testing.assert_allclose(fillet[:, 0], land[:, -1], atol=1e-12)
    # The root lands of neighbouring teeth meet in the middle of the slot.
    teeth = getattr(pair, member).teeth
    pinion_body, gear_body = bodies(pair)
    turn = (pinion_body if member == "pinion" else gear_body).turn
    mine, theirs = (sorted(patches[f"{own}_root_land"][:, 0].tolist(), key=lambda p: p[2]) for own in (other, loaded))
    next_tooth = rotate_z(np.full(NODES[0], turn * 2 * np.pi / teeth), np.array(theirs).T)
    np.testing.assert_allclose(np.array(mine).T, next_tooth, atol=1e-9)


def test_thickness_of_the_surface_is_that_of_the_tooth() -> None:
    """In the middle of the flank the real tooth is as thick as the plate's tooth, and it widens down the fillet."""
    pair = nasa()
    for member, body in zip(("pinion", "gear"), bodies(pair), strict=True):
        data = tooth(pair, member, (9, 15))
        assert data["position"].attrs["units"] == "mm"
        thickness = data["transverse_thickness"].values
        assert np.all(thickness > 0.0)
        assert np.all(np.diff(thickness[4]) < 0.0)
        section = getattr(pair, member).section
        middle = section.points(np.array([0.5]), np.array([0.5]))
        half = np.polynomial.legendre.legval2d(0.0, 0.0, body.half_angle)
        expected = 2.0 * middle[1, 0] * math.sin(half)
        sides = [data["position"].values[i, 4] for i in (0, 1)]
        azimuth = []
        for points in sides:
            _, height = section.fractions(points[:, 2], np.hypot(points[:, 0], points[:, 1]))
            order = np.argsort(height)
            azimuth.append(np.interp(0.5, height[order], np.unwrap(np.arctan2(points[:, 1], points[:, 0]))[order]))
        found = 2.0 * middle[1, 0] * abs(math.sin(0.5 * (azimuth[1] - azimuth[0])))
        assert found == pytest.approx(expected, rel=2e-3)


def test_teeth_that_do_not_exist_are_refused() -> None:
    pair = nasa()
    with pytest.raises(GeometryError, match="overlap"):
        tooth_patches(nasa(1.6), "gear", NODES)
    with pytest.raises(GeometryError, match="pointed"):
        tooth_patches(replace(pair, pinion=replace(pair.pinion, mean_thickness=4.0)), "pinion", NODES)
    with pytest.raises(GeometryError, match="overlap on 100 % of the face"):
        tooth_patches(nasa(2.4), "pinion", NODES)


# The tooth behind the flank: thickness from the cutter, and the foot of the contact normal


@pytest.fixture(scope="module")
def pair() -> GearPair:
    return conjugate_pair()


def angle(body: ToothBody, t: float = 0.5, h: float = 0.5) -> float:
    """Angular thickness at fractions of the flank [rad]."""
    return float(2.0 * legendre.legval2d(2 * t - 1, 2 * h - 1, body.half_angle))


def test_one_set_up_leaves_what_its_slot_does_not_take(pair: GearPair) -> None:
    """Gear tooth and slot fill the pitch: the slot is the difference of the two flanks the cutter makes."""
    gear = pair.gear
    _, body = bodies(pair)
    convex, concave = gear.middle(), replace(gear, loaded=gear.opposite).middle()  # type: ignore[arg-type]
    slot = abs(math.atan2(*convex.position[1::-1, 0]) - math.atan2(*concave.position[1::-1, 0]))
    assert angle(body) + slot == pytest.approx(2 * math.pi / 41, abs=1e-6)


def test_wider_point_makes_a_thinner_tooth(pair: GearPair) -> None:
    """Moving the inside blade in by w takes w / cos(pressure angle) off the normal thickness, to first order."""
    gear, w = pair.gear, 0.05
    _, before = bodies(pair)
    narrow = replace(gear.loaded, blade=replace(gear.loaded.blade, point_radius=gear.loaded.blade.point_radius - w))
    _, after = bodies(replace(pair, gear=replace(gear, loaded=narrow)))
    middle = gear.middle()
    arm = abs(middle.position[0, 0] * middle.normal[1, 0] - middle.position[1, 0] * middle.normal[0, 0])
    lost = (angle(before) - angle(after)) * arm
    assert lost == pytest.approx(w * math.cos(gear.loaded.blade.pressure_angle), rel=0.02)


def test_pinion_fills_the_gears_slot(pair: GearPair) -> None:
    pinion, gear = bodies(pair)
    assert angle(pinion) / (2 * math.pi / 11) + angle(gear) / (2 * math.pi / 41) == pytest.approx(1.0, abs=1e-4)


def test_given_thickness_is_met(pair: GearPair) -> None:
    """The plate through the middle is as thick as asked for, up to the taper between normal arc and chord."""
    given = replace(pair, gear=replace(pair.gear, mean_thickness=5.0))
    _, body = bodies(given)
    middle = body.height / 2.0
    plate = body.thickness.mean(axis=0)
    section = pair.gear.section
    up = float(section.height_above_root(*section.points(np.array([0.5]), np.array([0.5])))[0]) / (2 * middle.mean())
    assert plate[0] * (1 - up) + plate[1] * up == pytest.approx(5.0, rel=0.06)


def test_foot_of_the_normal_lies_on_the_middle_surface(pair: GearPair) -> None:
    """Going on from the foot to the other flank takes about as far again."""
    gear = pair.gear
    _, body = bodies(pair)
    nodes = gear.flank(np.linspace(0.3, 0.7, 5), np.linspace(0.3, 0.8, 4))
    found = body.shell_coordinates(nodes.position, nodes.normal)
    foot = nodes.position - found.depth * nodes.normal
    t, h = gear.section.fractions(foot[2], np.hypot(foot[0], foot[1]))
    # The foot is half a thickness from the loaded flank, measured around the axis at the foot's own place.
    own = gear.flank(np.array([0.5]), np.array([0.5]))
    assert own.inside.all()
    from easeoff.geometry.flanks.flank import solve_flank

    flank = solve_flank(gear.loaded, gear.section, *gear.section.points(t, h))
    behind = body.turn * (np.arctan2(foot[1], foot[0]) - np.arctan2(flank.position[1], flank.position[0]))
    half = legendre.legval2d(2 * t - 1, 2 * h - 1, body.half_angle)
    np.testing.assert_allclose(behind, half, rtol=0.03)
    np.testing.assert_allclose(dot(found.direction, found.direction), 1.0, rtol=0, atol=1e-12)


def test_force_pushes_into_the_tooth_and_towards_the_root(pair: GearPair) -> None:
    pinion, gear = bodies(pair)
    for member, body in ((pair.pinion, pinion), (pair.gear, gear)):
        nodes = member.middle()
        found = body.shell_coordinates(nodes.position, nodes.normal)
        outward = found.direction[2, 0]
        assert abs(outward) > 0.9
        assert (outward < 0.0) == body.convex
        assert found.direction[0, 0] < 0.0
        assert 0.0 < found.height[0] < body.height.max()
        assert 0.0 < found.arc[0] < body.trace_length


def test_trace_radius_of_a_formate_gear_is_that_of_its_cutter(pair: GearPair) -> None:
    """Normal curvature of the middle surface along the face: the cutter radius, within taper and pressure angle."""
    _, body = bodies(pair)
    assert body.trace_radius == pytest.approx(95.25, rel=0.05)
    assert body.trace_length == pytest.approx(29.8 / math.cos(math.radians(28.5)), rel=0.02)
    assert body.convex


def test_drive_and_coast_flanks_describe_the_same_tooth() -> None:
    for drive, coast in zip(bodies(conjugate_pair()), bodies(conjugate_pair(coast=True)), strict=True):
        np.testing.assert_allclose(drive.thickness, coast.thickness, rtol=1e-3)
        assert drive.trace_radius == pytest.approx(coast.trace_radius, rel=1e-3)
        assert drive.convex != coast.convex
        assert drive.turn == -coast.turn


def test_flanks_that_cross_leave_no_tooth(pair: GearPair) -> None:
    gear = pair.gear
    with pytest.raises(GeometryError, match="thick"):
        tooth_body(gear.section, gear.loaded, gear.opposite, 0.005)  # type: ignore[arg-type]


def test_fitted_plate_follows_the_tooth(pair: GearPair) -> None:
    """Thickness over the height better than an even taper's; a pinion's heights fan out, a Formate gear's hardly."""
    pinion, gear = bodies(pair)
    section = pinion.section
    t, h = (g.ravel() for g in np.meshgrid(np.linspace(0.1, 0.9, 7), np.linspace(0.05, 0.95, 7), indexing="ij"))
    normal = np.stack([legendre.legval2d(2 * t - 1, 2 * h - 1, c) for c in pinion.middle_normal])
    axial, radial = section.points(t, h)
    half = legendre.legval2d(2 * t - 1, 2 * h - 1, pinion.half_angle)
    real = 2.0 * radial * np.sin(half) * np.abs(normal[1]) / np.sqrt(dot(normal, normal))
    up = section.height_above_root(axial, radial) / (pinion.height[0] * (1 - t) + pinion.height[1] * t)

    def plate(corners: np.ndarray, bulge: np.ndarray) -> np.ndarray:
        root, tip = (corners[0, k] * (1 - t) + corners[1, k] * t for k in (0, 1))
        return np.asarray(root * (1 - up) + tip * up + 4.0 * up * (1 - up) * (bulge[0] * (1 - t) + bulge[1] * t))

    even = np.abs(plate(pinion.thickness, np.zeros(2)) - real).max()
    fitted = np.abs(plate(pinion.fitted_thickness, pinion.bulge) - real).max()
    assert fitted < 0.6 * even
    # Lengths of the trace at root and tip, by sums over points of the middle surface.
    assert abs(gear.fanning) < 0.003
    assert pinion.fanning > 0.01


@pytest.mark.parametrize("name", ["fm-11x41", "fh-design-a"])
def test_a_fillet_of_two_nodes_ends_where_one_of_many_does(name: str) -> None:
    """A long stride along the fillet once led to no points: such teeth were refused, though they can be built."""
    pair = gear_pair(read_case(name))
    few, many = (tooth_surface(pair, "pinion", (7, 5), count) for count in (2, 17))
    for one, other in ((few.loaded, many.loaded), (few.opposite, many.opposite)):
        np.testing.assert_allclose(one.fillet[:, :, [0, -1]], other.fillet[:, :, [0, -1]], rtol=0, atol=1e-9)
