"""The real tooth: what the cutter leaves when it has been everywhere, whole and without gaps."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from pairs import conjugate_pair

from easeoff import GeometryError
from easeoff.cases import case_text, gear_pair, parse_case
from easeoff.geometry import BladeSection, GearPair, GeneratingSurface, machine_pose, solve_flank, tooth_patches
from easeoff.geometry.pair.gear_pair import bodies
from easeoff.geometry.tooth import tooth
from easeoff.geometry.tooth.tooth_flanks import side
from easeoff.geometry.tooth.tooth_surface import tooth_side
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
    side = tooth_side(which.loaded, which.section, np.linspace(0.0, 1.0, 3), 5, 5)
    points = np.concatenate([side.fillet.reshape(3, -1), side.flank.reshape(3, -1)], axis=1)
    np.testing.assert_allclose(clearance_to_cutter(which.loaded, points), 0.0, atol=2e-5)


@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_fillet_runs_smoothly_into_the_flank(member: str) -> None:
    """Same point and same normal at the joint; at the other end the normal is that of the root land."""
    which = getattr(nasa(), member)
    side = tooth_side(which.loaded, which.section, np.linspace(0.0, 1.0, 5), 9)
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
    side = tooth_side(loaded, pair.gear.section, np.linspace(0.0, 1.0, 5), 9)
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
