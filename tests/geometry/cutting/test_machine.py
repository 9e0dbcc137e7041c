"""The kinematic chain: identities of its rotations, the hand of the member, and a crown gear in closed form."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from pairs import GENERATED, PARAMETERS

from easeoff import InputError
from easeoff.geometry import Assembly, Blade, GeneratingSurface, MachineSettings
from easeoff.geometry.cutting.machine import work_rotation
from easeoff.geometry.newton import complex_steps
from easeoff.geometry.pair.conjugate_motion import ConjugateMotion
from easeoff.geometry.vectors import cross, dot, rotate_z

SETTINGS = replace(GENERATED, modified_roll=(0.02, -0.03, 0.01))
OUTSIDE = Blade(75.0, math.radians(18.0), "outside")


def surface(settings: MachineSettings = SETTINGS, **changes: object) -> GeneratingSurface:
    return replace(GeneratingSurface(OUTSIDE, settings, "right", -1), **changes)  # type: ignore[arg-type]


def test_without_tilt_swivel_only_shifts_the_cutter_angle() -> None:
    """R_z(-swivel) R_x(0) R_z(angle) is one rotation about the cutter axis."""
    upright = replace(SETTINGS, cutter_tilt=0.0)
    straight = replace(upright, cutter_swivel=0.0)
    shifted = PARAMETERS + np.array([[upright.cutter_swivel], [0.0]])
    swivelled = surface(upright).evaluate(shifted)
    plain = surface(straight).evaluate(PARAMETERS)
    for one, other in zip(swivelled, plain, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-12)


def test_left_hand_is_the_mirror_image_of_right_hand() -> None:
    right, left = surface().evaluate(PARAMETERS), surface(hand="left").evaluate(PARAMETERS)
    mirror = np.array([[1.0], [-1.0], [1.0]])
    np.testing.assert_array_equal(left[0], right[0] * mirror)
    np.testing.assert_array_equal(left[1], right[1] * mirror)


@pytest.mark.parametrize("side", ["outside", "inside"])
def test_normal_is_the_normal_of_the_generated_surface(side: str) -> None:
    """The envelope's tangents, differentiated with the meshing solution, are at right angles to the cone's normal."""
    blade = Blade(75.0, 0.3, side)  # type: ignore[arg-type]
    generated = surface(blade=blade)
    _, (first, second) = complex_steps(lambda p: generated.evaluate(p)[0], PARAMETERS)
    normal = generated.evaluate(PARAMETERS)[1]
    area = cross(first, second)
    np.testing.assert_allclose(np.abs(dot(area, normal)) / np.sqrt(dot(area, area)), 1.0, rtol=0, atol=1e-12)


MOTIONS = (
    ("sliding_base", (1.5, -0.8, 0.3)),
    ("work_offset", (-2.0, 1.1)),
    ("radial_distance", (0.9, 0.0, -1.4, 0.2, 0.1, -0.3)),
    ("machine_center_to_crossing_point", (0.4,)),
    ("machine_root_angle", (0.02, -0.03)),
    ("cutter_tilt", (0.05, 0.02)),
    ("cutter_swivel", (-0.1, 0.04)),
)


@pytest.mark.parametrize("sense", [-1, 1])
@pytest.mark.parametrize("motions", [*((motion,) for motion in MOTIONS), MOTIONS], ids=lambda m: f"{len(m)} {m[0][0]}")
def test_moving_settings_satisfy_the_equation_of_meshing(motions: tuple[Any, ...], sense: Any) -> None:
    """Central differences of the blade points on machines whose settings stand where the motion has brought them."""
    moving = surface(replace(SETTINGS, motions=motions, indexing_ratio=1.3), sense=sense)

    def family(angle: float, distance: float, cradle: float) -> np.ndarray:
        increment = sense * cradle
        now = {n: getattr(SETTINGS, n) + sum(c * increment**k for k, c in enumerate(cs, 1)) for n, cs in motions}
        still = replace(SETTINGS, **now, cradle_angle=SETTINGS.cradle_angle + cradle, ratio_of_roll=None,
                        modified_roll=(), indexing_ratio=1.3)  # fmt: skip
        point = surface(still, sense=sense).evaluate(np.array([[angle], [distance]]))[0]
        roll, _ = work_rotation(SETTINGS, np.array([cradle]), sense)
        return rotate_z(-roll, point)[:, 0]

    position, normal, distances = moving.evaluate(PARAMETERS)
    for k, ((angle, cradle), distance) in enumerate(zip(PARAMETERS.T, distances, strict=True)):
        here, h = np.array([angle, distance, cradle]), 1e-5
        np.testing.assert_allclose(family(*here), position[:, k], rtol=0, atol=1e-10)
        d = [(family(*(here + h * e)) - family(*(here - h * e))) / (2 * h) for e in np.eye(3)]
        assert max(abs(v @ normal[:, k]) / np.linalg.norm(v) for v in d) < 1e-7


def test_motions_of_zero_change_nothing_and_others_are_refused() -> None:
    still = surface().evaluate(PARAMETERS)
    moved = surface(replace(SETTINGS, motions=(("sliding_base", (0.0, 0.0)),))).evaluate(PARAMETERS)
    for one, other in zip(still, moved, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-12)
    with pytest.raises(InputError, match=r"motion = .*: must be one of"):
        replace(SETTINGS, motions=(("cradle_angle", (0.1,)),))
    with pytest.raises(InputError, match="Formate"):
        replace(SETTINGS, motions=MOTIONS, ratio_of_roll=None, modified_roll=())


def triple_product(parameters: np.ndarray, distance: float) -> tuple[float, float]:
    """Triple product of the derivatives by distance, cutter angle and cradle rotation (Kolivand 2009, Eq. 2.8).

    By central differences on the family of blade points before the envelope is taken; with the product of the lengths.
    """
    formate = replace(SETTINGS, ratio_of_roll=None, modified_roll=())

    def work_point(angle: float, along: float, rotation: float) -> np.ndarray:
        # The same blade point on a machine whose cradle and work have turned.
        turned = replace(formate, cradle_angle=SETTINGS.cradle_angle + rotation)
        still = surface(turned).evaluate(np.array([[angle], [along]]))[0][:, 0]
        roll = float(work_rotation(SETTINGS, np.array(rotation), -1)[0])
        c, s = math.cos(roll), math.sin(roll)
        return np.array([c * still[0] + s * still[1], -s * still[0] + c * still[1], still[2]])

    here, h = np.array([parameters[0], distance, parameters[1]]), 1e-5
    derivatives = [(work_point(*(here + h * e)) - work_point(*(here - h * e))) / (2 * h) for e in np.eye(3)]
    value = np.dot(np.cross(derivatives[1], derivatives[0]), derivatives[2])
    return float(value), float(np.prod([np.linalg.norm(d) for d in derivatives]))


def test_meshing_condition_vanishes_at_the_distance_found() -> None:
    distances = surface().evaluate(PARAMETERS)[2]
    for parameters, distance in zip(PARAMETERS.T, distances, strict=True):
        for beyond, vanishes in ((0.0, True), (5.0, False)):
            value, scale = triple_product(parameters, float(distance) + beyond)
            assert (abs(value) < 1e-8 * scale) == vanishes


def test_meshing_condition_is_quadratic_along_the_blade() -> None:
    """Three distances give every other; one root is always the apex of the cutter cone and not a contact."""
    apex = -OUTSIDE.point_radius / math.sin(OUTSIDE.pressure_angle)
    for parameters in PARAMETERS.T:
        distances = np.array([-3.0, 4.0, 11.0])
        quadratic = np.polyfit(distances, [triple_product(parameters, s)[0] for s in distances], 2)
        value, scale = triple_product(parameters, 25.0)
        assert np.polyval(quadratic, 25.0) == pytest.approx(value, abs=1e-7 * scale)
        roots = np.roots(quadratic)
        assert np.abs(roots - apex).min() < 1e-3 * abs(apex)
        found = surface().evaluate(parameters[:, None])[2][0]
        assert np.abs(roots - found).min() < 1e-5


@pytest.mark.parametrize("sense", [-1, 1])
def test_ratio_is_the_derivative_of_the_work_rotation(sense: int) -> None:
    angle = np.array([-0.3, 0.0, 0.2]) + 1e-30j
    rotation, ratio = work_rotation(SETTINGS, angle, sense)  # type: ignore[arg-type]
    np.testing.assert_allclose(rotation.imag / 1e-30, ratio.real, rtol=1e-14)


def test_formate_member_with_modified_roll_is_refused() -> None:
    with pytest.raises(InputError, match="ratio_of_roll"):
        MachineSettings(90.0, 1.0, 1.2, modified_roll=(0.1,))


GAMMA_GEAR = math.atan2(41, 11)


def crown_generated(angle: float, side: str, hand: str, sense: int) -> GeneratingSurface:
    """A member of a spiral bevel pair cut by the flat crown gear both members share."""
    horizontal, vertical = 90.0 - 76.2 * math.sin(math.radians(35)), 76.2 * math.cos(math.radians(35))
    settings = MachineSettings(
        radial_distance=math.hypot(horizontal, vertical),
        cradle_angle=math.atan2(vertical, horizontal),
        machine_root_angle=angle,
        ratio_of_roll=1.0 / math.sin(angle),
    )
    blade = Blade(76.2, math.radians(20.0), side)  # type: ignore[arg-type]
    return GeneratingSurface(blade, settings, hand, sense)  # type: ignore[arg-type]


def test_crown_gear_gives_the_conjugate_rotation_in_closed_form() -> None:
    """Points cut at a cradle angle of 5 deg meet the mate at 5 deg times the ratio of roll: 5.176826 deg."""
    # The 41-tooth member in the part of the pinion: the equation is the same with the ratio inverted.
    gear = crown_generated(GAMMA_GEAR, "outside", "right", 1)
    motion = ConjugateMotion(gear, Assembly(41, 11, "right", math.pi / 2, 0.0), 1.0)
    cradle = np.radians([5.0, 5.0, -3.0])
    points = motion.pinion_point(np.stack([np.array([-2.2, -1.9, -2.0]), cradle]))
    rotations = np.degrees(np.stack(motion.roots(*points)))
    found = rotations[np.argmin(np.abs(np.abs(rotations) - abs(np.degrees(cradle)) * 1.0353), axis=0), range(3)]
    np.testing.assert_allclose(np.abs(found), np.abs(np.degrees(cradle)) / math.sin(GAMMA_GEAR), rtol=1e-12)
    assert abs(found[0]) == pytest.approx(5.176826, abs=5e-7)


def test_synthetic_hypoid_reproduces_its_published_figures() -> None:
    """Position, normal and both conjugate rotations of a Formate gear point, computed independently."""
    horizontal, vertical = 93.0 - 95.25 * math.sin(math.radians(28.5)), 95.25 * math.cos(math.radians(28.5))
    assert horizontal == pytest.approx(47.550628, abs=5e-7)
    assert vertical == pytest.approx(83.707330, abs=5e-7)
    cradle = math.atan2(vertical, horizontal)
    settings = MachineSettings(math.hypot(horizontal, vertical), cradle, math.radians(68.5))
    gear = GeneratingSurface(Blade(93.85, math.radians(21.5), "inside"), settings, "right", 1)
    angles = np.array([math.radians(-61.5), math.radians(-61.5) + 18 / 95.25]) - cradle
    parameters = np.stack([angles, np.array([4.0, 8.0])])
    position, normal, _ = gear.evaluate(parameters)
    np.testing.assert_allclose(position[:, 0], [86.620448, 2.518694, 30.120702], rtol=0, atol=5e-7)
    np.testing.assert_allclose(normal[:, 0], [0.547388442, -0.817666881, -0.178288434], rtol=0, atol=5e-10)
    lever = abs(position[0, 0] * normal[1, 0] - position[1, 0] * normal[0, 0])
    assert lever == pytest.approx(72.2054, abs=5e-5)
    assert lever / math.hypot(*position[:2, 0]) == pytest.approx(0.8332, abs=5e-5)

    # The gear in the part of the pinion: the mate's axis passes 3.258651425 mm from the gear's origin. The figures
    # count the rotation about the other end of the axis, from an assembly turned by the angle of the mate's axis.
    assembly = Assembly(41, 11, "left", math.pi / 2, 20.0)
    assembly = assembly.misaligned(replace(assembly.misalignment, pinion_axial=-3.258651425))
    motion = ConjugateMotion(gear, assembly, -1.0)
    turned = math.degrees(math.atan2(0.181168855, 0.983452005))
    roots = -np.degrees(np.stack(motion.roots(*motion.pinion_point(parameters)))) - turned
    first = sorted(roots[:, 0], key=abs)
    assert first[0] == pytest.approx(-0.186400, abs=2e-6)
    assert first[1] == pytest.approx(-129.661029, abs=2e-6)
    second = min(roots[:, 1], key=abs)
    assert second == pytest.approx(-11.582677, abs=2e-6)
