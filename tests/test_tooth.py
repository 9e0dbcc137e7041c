"""The tooth behind the flank: thickness from the cutter, and the foot of the contact normal."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.polynomial import legendre
from pairs import conjugate_pair

from easeoff import GeometryError
from easeoff.geometry import GearPair
from easeoff.geometry.pair.gear_pair import bodies
from easeoff.geometry.pair.tooth_body import ToothBody, tooth_body
from easeoff.geometry.vectors import dot


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
    from easeoff.geometry import solve_flank

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
