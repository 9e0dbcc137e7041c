"""Ease-off and roll angle: exact conjugacy, conventional contact analysis, published contact path."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pairs import conjugate_pair, contact_path, surfaces

from easeoff import GeometryError
from easeoff.cases import gear_pair, read_case
from easeoff.geometry import (
    Blade,
    BlankSection,
    EaseOffTarget,
    Flank,
    GearPair,
    GeneratingSurface,
    MachineSettings,
    Member,
    Misalignment,
    ease_off,
    fit_pinion,
)
from easeoff.geometry.cutting.generating_surface import SurfacePoints
from easeoff.geometry.cutting.named_settings import with_settings
from easeoff.geometry.flanks.flank import shape_operator
from easeoff.geometry.newton import complex_steps
from easeoff.geometry.pair.conjugate_motion import ConjugateMotion
from easeoff.geometry.pair.ease_off import SKEW_STEP, EaseOff, exact_ease_off
from easeoff.geometry.pair.gear_pair import FlankName
from easeoff.geometry.vectors import cross, dot

Array = NDArray[Any]
ARC_SECOND = math.pi / 180 / 3600


def spread(result: EaseOff) -> float:
    """Largest difference of the normal ease-off over every node that has one [mm]."""
    values = result.angle[np.isfinite(result.angle)]
    return float((values.max() - values.min()) * np.nanmax(result.lever_arm))


@pytest.mark.parametrize("coast", [False, True])
@pytest.mark.parametrize("hand", ["left", "right"])
def test_conjugate_pinion_has_no_ease_off(hand: str, coast: bool) -> None:
    _, result = surfaces(conjugate_pair(hand, coast=coast))  # type: ignore[arg-type]
    assert np.isfinite(result.angle).all()
    assert spread(result) < 1e-9
    assert spread(result) < 1e-11  # rounding, in fact


@pytest.mark.parametrize("shaft_angle", [75.0, 100.0])
def test_conjugate_pinion_at_other_shaft_angles(shaft_angle: float) -> None:
    """The machine root angle of the conjugate pinion follows the shaft angle."""
    from easeoff.geometry import conjugate_pinion

    pair = conjugate_pair()
    assembly = replace(pair.assembly, shaft_angle=math.radians(shaft_angle))
    pinion = conjugate_pinion(pair.gear.loaded, assembly, 9.83)
    assert pinion.settings.machine_root_angle == pytest.approx(math.radians(shaft_angle - 90.0))
    # The pinion's own blank no longer fits; its points are conjugate wherever they are.
    motion = ConjugateMotion(pinion, assembly, -1.0)
    parameters = np.stack([np.linspace(-2.7, -2.5, 5), np.linspace(0.1, 0.3, 5)])
    cradle = parameters[1]
    position, normal = motion.pinion_point(parameters)
    expected = assembly.ratio * cradle
    misses = [np.abs(np.abs(root) - np.abs(expected)) for root in motion.roots(position, normal)]
    np.testing.assert_allclose(np.min(misses, axis=0), 0.0, atol=1e-12)


def test_crown_gear_pair_is_conjugate() -> None:
    """Both members of a spiral bevel pair cut by the two sides of one crown gear."""
    angles = (math.atan2(11, 41), math.atan2(41, 11))
    horizontal, vertical = 90.0 - 76.2 * math.sin(math.radians(35)), 76.2 * math.cos(math.radians(35))
    machine = MachineSettings(math.hypot(horizontal, vertical), math.atan2(vertical, horizontal), 0.0)
    members = []
    for angle, side, hand, sense in ((angles[0], "inside", "left", -1), (angles[1], "outside", "right", 1)):
        settings = replace(machine, machine_root_angle=angle, ratio_of_roll=1.0 / math.sin(angle))
        blade = Blade(76.2, math.radians(20.0), side)  # type: ignore[arg-type]
        # The blade tips run on the pitch cone; flank and mate both reach 2 mm to either side of it.
        section = BlankSection(angle, angle + 0.023, angle - 0.023, 103.0, 26.0)
        members.append(Member(11 if sense < 0 else 41, section, GeneratingSurface(blade, settings, hand, sense)))  # type: ignore[arg-type]
    from easeoff.geometry import Assembly

    pair = GearPair(members[0], members[1], Assembly(11, 41, "left", math.pi / 2, 0.0))
    _, result = surfaces(pair)
    known = np.isfinite(result.angle)
    assert known.mean() > 0.9
    assert spread(result) < 1e-9


def test_roll_angle_residual_and_branch() -> None:
    """At its roll angle every node satisfies the equation of meshing, on one branch of its roots."""
    pair = gear_pair(read_case("nasa-12x36"))
    _, result = surfaces(pair)
    motion = result.motion
    rotation = result.roll_angle + motion.center
    position, normal = motion.action_point(result.pinion_parameters, rotation)
    assert np.nanmax(np.abs(motion.closing_velocity(position, normal))) < 1e-13
    field = result.roll_angle.reshape(13, 9)
    assert np.nanmax(np.abs(np.diff(field, axis=0))) < 0.5


def test_misalignment_is_a_rigid_motion_of_the_members() -> None:
    """On a conjugate pair an axial shift of the gear opens the flanks by the normal's axial part, to first order."""
    pair = conjugate_pair()
    errors = []
    for shift in (0.02, 0.01):
        gear, moved = surfaces(pair.misaligned(Misalignment(gear_axial=shift)))
        normal_gap = moved.angle * moved.lever_arm
        expected = -shift * gear.normal[2]
        difference = normal_gap - expected
        lever = moved.lever_arm
        # Up to a rotation of the gear, and of the pinion, which is a rotation of the gear at the ideal ratio.
        difference = difference - lever * (lever @ difference) / (lever @ lever)
        errors.append(np.abs(difference).max())
    assert errors[0] < 0.02
    assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.2) or errors[0] / errors[1] > 3.5


def test_separation_curvature_is_the_relative_curvature_across_the_contact_line() -> None:
    """On a conjugate pair, lever arm x separation curvature x slope^2 of the roll angle = relative normal curvature."""
    pair = conjugate_pair()
    t, h = np.linspace(0.3, 0.7, 9), np.linspace(0.4, 0.8, 9)
    gear = pair.gear.flank(t, h)
    result = exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)
    pinion = replace(gear, surface=pair.pinion.loaded, parameters=result.pinion_parameters)
    position, normal, _ = pair.pinion.loaded.evaluate(result.pinion_parameters)
    middle = 4 * 9 + 4

    # Across the line on the gear flank: the gradient of the roll angle, by central differences on the grid.
    def derivative(values: np.ndarray, axis: int) -> np.ndarray:
        field = values.reshape(*values.shape[:-1], 9, 9)
        step = (t if axis == 0 else h)[1] - (t if axis == 0 else h)[0]
        weights = np.array([1, -8, 0, 8, -1]) / (12 * step)
        picked = field[..., 2:7, 4] if axis == 0 else field[..., 4, 2:7]
        return np.asarray(picked @ weights)

    tangents = np.stack([derivative(gear.position, 0), derivative(gear.position, 1)], axis=1)
    gradient = np.array([derivative(result.roll_angle, 0), derivative(result.roll_angle, 1)])
    metric = tangents.T @ tangents
    across = np.linalg.solve(metric, gradient)
    slope = math.sqrt(gradient @ across)
    direction = tangents @ across / slope

    def normal_curvature(flank: Flank, vector: np.ndarray) -> float:
        basis, first, second = shape_operator(flank)
        weights = np.linalg.lstsq(basis[:, :, middle], vector, rcond=None)[0]
        return float(weights @ second[..., middle] @ weights / (weights @ first[..., middle] @ weights))

    # Carry the direction from the gear frame to the pinion's: gear turned, then the pinion turned back.
    motion = result.motion
    from easeoff.geometry.vectors import rotate

    rotation = result.roll_angle[middle] + motion.center
    in_space = rotate(motion.gear_axis, np.array(rotation / pair.assembly.ratio), direction)
    back = rotate(motion.pinion_axis, np.array(-rotation), in_space)
    on_pinion = pair.assembly.pinion_frame.T @ back
    assert abs(on_pinion @ normal[:, middle]) < 1e-6
    relative = normal_curvature(gear, direction) + normal_curvature(pinion, on_pinion)
    predicted = result.lever_arm[middle] * result.separation_curvature[middle] * slope**2
    assert predicted == pytest.approx(relative, rel=1e-5)
    assert position.shape == (3, 81)


# Conventional contact analysis of the pair by a separate program, which is no part of this repository: pinion
# rotation [deg], transmission error [arc seconds], then lengthwise and profile fractions on gear and pinion.
NASA_PATH = np.array(
    [
        [-12.5, 89.7629, 0.68785, 0.14320, 0.67130, 0.88733],
        [-10.0, 70.7170, 0.68317, 0.21357, 0.66947, 0.78633],
        [-5.0, 34.1230, 0.67103, 0.35571, 0.66250, 0.59374],
        [0.0, 0.0, 0.65514, 0.50000, 0.65110, 0.41658],
        [5.0, -31.0563, 0.63540, 0.64684, 0.63538, 0.25887],
        [10.0, -58.4260, 0.61172, 0.79670, 0.61546, 0.12519],
        [15.0, -81.4717, 0.58405, 0.95016, 0.59153, 0.02052],
    ]
)


def nasa_path(pair: GearPair) -> tuple[np.ndarray, np.ndarray]:
    """Rotations [deg], and (error [arc seconds], gear t, gear h, pinion t, pinion h) relative to gear mid height."""
    rotations = np.linspace(-30.0, 24.0, 541)
    found = contact_path(pair, rotations)
    gear = pair.gear.section.fractions(found.gear_position[2], np.hypot(*found.gear_position[:2]))
    pinion = pair.pinion.section.fractions(found.pinion_position[2], np.hypot(*found.pinion_position[:2]))
    good = found.converged & (gear[1] > -0.2) & (gear[1] < 1.2)
    rotations, angle = rotations[good], found.closing_angle[good]
    columns = np.stack([angle / ARC_SECOND, gear[0][good], gear[1][good], pinion[0][good], pinion[1][good]])
    order = np.argsort(columns[2])
    middle = np.interp(0.5, columns[2][order], rotations[order])
    columns[0] -= np.interp(middle, rotations, columns[0])
    return rotations - middle, columns


def test_published_settings_give_the_computed_contact_path() -> None:
    # The table counts the pinion's rotation and the error against the drive sense.
    rotations, columns = nasa_path(gear_pair(read_case("nasa-12x36")))
    found = np.stack([np.interp(-NASA_PATH[:, 0], rotations, c) for c in columns])
    np.testing.assert_allclose(-found[0], NASA_PATH[:, 1], rtol=0, atol=0.1)
    np.testing.assert_allclose(found[1:], NASA_PATH[:, 2:].T, rtol=0, atol=1e-3)


@cache
def middle_of_path(errors: Misalignment) -> tuple[float, float]:
    """Place of the contact along the gear at half height, and slope of the error there [arc seconds/deg]."""
    rotations, columns = nasa_path(gear_pair(read_case("nasa-12x36")).misaligned(errors))
    near = np.abs(rotations) < 2.0
    return float(np.interp(0.0, rotations, columns[1])), float(np.polyfit(rotations[near], columns[0][near], 1)[0])


@pytest.mark.parametrize(
    ("errors", "shift", "slope"),
    [
        (Misalignment(offset=0.254), -0.139, -3.95),
        (Misalignment(pinion_axial=0.254), -0.058, -3.36),
        (Misalignment(gear_axial=0.254), 0.050, -7.90),
    ],
)
def test_misalignment_sensitivities_of_the_published_pair(errors: Misalignment, shift: float, slope: float) -> None:
    """Shift of the contact at half height [face], and slope of the error [arc seconds/deg], per 0.01 inch."""
    nominal, moved = middle_of_path(Misalignment()), middle_of_path(errors)
    assert moved[0] - nominal[0] == pytest.approx(shift, abs=0.0015, rel=0.02)
    assert -abs(moved[1]) == pytest.approx(slope, rel=0.02)


def test_synthesis_returns_to_the_conjugate_settings() -> None:
    """A zero target, started from disturbed settings, is met to rounding."""
    pair = conjugate_pair()
    exact = pair.pinion.loaded
    moved = with_settings(exact, {"point_radius": exact.blade.point_radius + 0.5, "modified_roll_2c": 0.003})
    start = replace(pair, pinion=replace(pair.pinion, loaded=moved))
    free = ("point_radius", "modified_roll_2c", "radial_distance")
    found = fit_pinion(start, EaseOffTarget(), free=free, nodes=(5, 5))
    assert np.abs(found.residual).max() < 1e-9
    assert found.surface.blade.point_radius == pytest.approx(exact.blade.point_radius, abs=1e-6)


def test_larger_cutter_radius_gives_lengthwise_crowning_of_second_order() -> None:
    """Moving the cutter centre back along its radius keeps the middle; toe and heel open by curvature."""
    pair = conjugate_pair()
    crowned = []
    for change in (0.5, 1.0, 2.0):
        exact = pair.pinion.loaded
        surface = with_settings(exact, {"point_radius": exact.blade.point_radius + change})
        target = EaseOffTarget(lengthwise_crowning=0.0)
        fitted = fit_pinion(
            replace(pair, pinion=replace(pair.pinion, loaded=surface)),
            target,
            free=("radial_distance", "cradle_angle"),
            nodes=(5, 5),
        )
        crowned.append(float(np.ptp(fitted.residual)))
    assert crowned[1] / crowned[0] == pytest.approx(2.0, rel=0.1)
    assert crowned[2] / crowned[1] == pytest.approx(2.0, rel=0.1)


def test_flanks_that_cannot_meet_say_so() -> None:
    pair = conjugate_pair()
    wrong = replace(
        pair,
        pinion=replace(pair.pinion, section=replace(pair.pinion.section, outer_cone_distance=60.0, face_width=10.0)),
    )
    with pytest.raises(GeometryError):
        ease_off(wrong)


def test_normal_vectors_agree_at_conjugate_points() -> None:
    pair = conjugate_pair()
    gear, result = surfaces(pair)
    motion = result.motion
    rotation = result.roll_angle + motion.center
    _, pinion_normal = motion.action_point(result.pinion_parameters, rotation)
    from easeoff.geometry.vectors import rotate

    gear_normal = rotate(motion.gear_axis, rotation / pair.assembly.ratio, gear.normal)
    turned = result.angle  # the conjugate gear may be stored turned against the gear
    gear_normal = rotate(motion.gear_axis, -turned, gear_normal)
    assert np.abs(cross(pinion_normal, gear_normal)).max() < 1e-10
    assert np.all(dot(pinion_normal, gear_normal) < 0.0)


@pytest.mark.parametrize("name", ["fm-11x41", "fh-12x41-45"])
@pytest.mark.parametrize("flank", ["drive", "coast"])
def test_derivatives_of_contact_are_those_of_turned_pinion_points(name: str, flank: FlankName) -> None:
    """Of the closing velocity and the place in the gear, and of the conjugate point, misaligned and out of contact."""
    errors = Misalignment(offset=0.3, pinion_axial=-0.2, gear_axial=0.1, shaft_angle=2e-3)
    _, result = surfaces(gear_pair(read_case(name), flank).misaligned(errors), (7, 5))
    motion, origin = result.motion, result.motion.assembly.gear_origin
    points = SurfacePoints.of(motion.surface, result.pinion_parameters)
    rotation = result.roll_angle + motion.center + 0.02

    def turned(arguments: Array) -> Array:
        position, normal = motion.action_point(arguments[:2], arguments[2])
        place = position[2] - origin[2], np.sqrt(position[0] ** 2 + position[1] ** 2)
        return np.stack([motion.closing_velocity(position, normal), *place])

    def conjugate(parameters: Array) -> Array:
        point, _ = motion.conjugate_gear(parameters)
        return np.stack([point[2], np.sqrt(point[0] ** 2 + point[1] ** 2)])

    values, slopes = motion.closing_and_place(points, rotation)
    wanted, wanted_slopes = complex_steps(turned, np.stack([*points.parameters, rotation]))
    np.testing.assert_allclose(values, wanted, rtol=1e-11, atol=1e-13)
    np.testing.assert_allclose(slopes, wanted_slopes, rtol=1e-9, atol=1e-10)
    place, place_slopes = motion.conjugate_place(points)
    wanted, wanted_slopes = complex_steps(conjugate, points.parameters)
    np.testing.assert_allclose(place, wanted, rtol=1e-12)
    np.testing.assert_allclose(place_slopes, wanted_slopes, rtol=1e-9, atol=1e-9)


def test_points_facing_a_node_before_and_after_keep_its_place_in_the_gear() -> None:
    gear, result = surfaces(gear_pair(read_case("fm-11x41")).misaligned(Misalignment(offset=0.2)), (7, 5))
    motion = result.motion
    for sign, parameters in zip((-1.0, 1.0), result.pinion_passing, strict=True):
        position, _ = motion.action_point(parameters, result.roll_angle + motion.center + sign * SKEW_STEP)
        np.testing.assert_allclose(position[2], gear.position[2], rtol=0, atol=1e-9)
        np.testing.assert_allclose(np.hypot(*position[:2]), np.hypot(*gear.position[:2]), rtol=0, atol=1e-9)
