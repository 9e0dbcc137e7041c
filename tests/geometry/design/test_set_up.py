"""Set-ups of the pinion as the shop has them: identities, limits, one set-up for both flanks, standard steps."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from easeoff import EaseoffError, GeometryError, InputError
from easeoff.cases import Case, design_text, designed_blanks, gear_pair, parse_design, read_case, read_design
from easeoff.cases.conversion import ease_off_target, machine_resolution, setting_limits, standard_steps
from easeoff.geometry import (
    Assembly,
    BlankDesign,
    EaseOffTarget,
    FlankName,
    blank_dimensions,
    blank_section,
    ease_off,
    formate_gear,
)
from easeoff.geometry.cutting.machine import machine_pose
from easeoff.geometry.cutting.named_settings import MachineResolution, get_setting, step_of
from easeoff.geometry.design.basic_settings import crown_gear_pinion, generated_gear
from easeoff.geometry.design.blank import mean_point_angles
from easeoff.geometry.design.closest_fit import StandardSteps
from easeoff.geometry.design.pair_design import PairDesign, design_pair
from easeoff.geometry.design.pinion_method import SettingLimits, SetUpMethod, at_limit, shared_settings
from easeoff.geometry.design.set_up_fit import MeanSlot, SetUpResidual, along_the_root, with_positive_tilt
from easeoff.geometry.design.synthesis import root_gap
from easeoff.geometry.flanks.flank import solve_flank
from easeoff.study import DesignReport, design_case
from easeoff.study.design.case_design import SEARCHED

METHODS: tuple[SetUpMethod, ...] = ("fixed_setting", "modified_roll", "tilt", "completing")
SIDES: tuple[FlankName, ...] = ("drive", "coast")
NO_EASE_OFF = {side: EaseOffTarget() for side in SIDES}


def bevel(taper: Any = "uniform", groups: int | None = None) -> BlankDesign:
    return BlankDesign(
        method=0,
        process="face_milled" if groups is None else "face_hobbed",
        number_of_teeth=(14, 39),
        mean_spiral_angle=math.radians(35.0),
        gear_outer_pitch_diameter=176.893,
        gear_face_width=25.4,
        cutter_radius=76.2,
        number_of_blade_groups=groups,
        nominal_drive_pressure_angle=math.radians(20.0),
        nominal_coast_pressure_angle=math.radians(20.0),
        gear_mean_addendum_factor=0.3,
        depth_factor=2.0,
        clearance_factor=0.125,
        thickness_factor=0.06,
        depth_taper=taper,
    )


def assembly_of(design: BlankDesign) -> Assembly:
    return Assembly(*design.number_of_teeth, "left", design.shaft_angle, design.hypoid_offset)


@cache
def made(method: SetUpMethod, groups: int | None = None, crowned: bool = False) -> PairDesign:
    """A spiral bevel pair of uniform depth, without ease-off or with crowning."""
    design = bevel(groups=groups)
    targets = {side: EaseOffTarget(0.06, 0.01) for side in SIDES} if crowned else NO_EASE_OFF
    return design_pair(design, assembly_of(design), targets, method=method, generated=True, edge_radii=(0.3, 0.3))


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("method", "groups"),
    [(method, groups) for method in METHODS for groups in (None, 13) if (method, groups) != ("completing", None)],
)
@pytest.mark.quick(2)
def test_every_method_cuts_the_conjugate_pinion_where_there_is_one(method: SetUpMethod, groups: int | None) -> None:
    """The crown gear of a bevel pair of uniform depth cuts both flanks of both members from one set-up.

    Face-milled and completing there is none: one cutter's outside blade has the larger radius on both members.
    """
    designed = made(method, groups)
    for side in SIDES:
        found = ease_off(designed.pair(side), (9, 7))
        assert float(abs(found["ease_off"]).max()) < 1e-3  # [um]
        assert designed.pinion[side].largest_residual < 1e-6


@pytest.mark.thorough
@pytest.mark.parametrize("groups", [None, 13])
@pytest.mark.quick(1)
def test_completing_has_one_set_of_machine_settings(groups: int | None) -> None:
    drive, coast = (made("completing", groups, groups is None).pinion[side].surface for side in SIDES)
    assert drive.settings == coast.settings
    assert (drive.blade.side, coast.blade.side) == ("outside", "inside")


@pytest.mark.thorough
def test_completing_leaves_the_tooth_of_the_blank() -> None:
    """Face-milled, the point width fixes the slot, which fills the pitch with the blank's tooth, to two micrometres."""
    designed = made("completing", None, True)
    concave, convex = (designed.pinion[side].surface for side in SIDES)
    section = blank_section(designed.blank.pinion, designed.blank.clearance)
    slot = MeanSlot(concave, convex, section, designed.blank)
    assert abs(slot.error(concave, convex)) < 2e-3
    blank = designed.blank
    assert slot.wanted + blank.pinion.mean_normal_thickness == pytest.approx(math.pi * blank.mean_normal_module)
    assert designed.pair("coast").pinion.mean_thickness == designed.pinion_thickness


@pytest.mark.parametrize("taper", ["uniform", "standard", "modified_slot_width"])
def test_tip_of_an_upright_cutter_envelops_the_root_cone(taper: str) -> None:
    """Points of the tip circle over the roll: none is below the root cone, and the lowest ones touch it."""
    blank = blank_dimensions(bevel(taper))
    section = blank_section(blank.pinion, blank.clearance)
    gear = generated_gear(blank, 76.2, "right", corrected=False)
    start = crown_gear_pinion(gear[0], assembly_of(bevel(taper)), blank.gear.mean_dedendum + blank.pinion.mean_dedendum)
    surface = along_the_root(start, blank)
    assert surface.settings.machine_root_angle == blank.pinion.root_angle
    cradle, turn = (f.ravel() for f in np.meshgrid(np.linspace(-0.6, 0.6, 121), np.linspace(-1.5, 2.5, 401)))
    pose = machine_pose(surface.settings, cradle, surface.sense)
    tip = pose.center + surface.blade.point_radius * (pose.frame[0] * np.cos(turn) + pose.frame[1] * np.sin(turn))
    position = pose.to_member(tip, np.zeros_like(turn), point=True)
    height = section.height_above_root(position[2], np.hypot(position[0], position[1]))
    near = np.hypot(position[2], np.hypot(position[0], position[1])) < 2.0 * blank.pinion.outer_cone_distance
    assert float(height[near].min()) == pytest.approx(0.0, abs=2e-3)
    assert float(height[near].min()) > -1e-9


@pytest.mark.thorough
@pytest.mark.parametrize("method", ["modified_roll", "completing"])
@pytest.mark.quick(1)
def test_derivatives_of_a_set_up_are_those_of_its_residuals(method: SetUpMethod) -> None:
    """Against central differences, with those of the slot, which both flanks share."""
    designed = made("fixed_setting")
    cut = SIDES if method == "completing" else SIDES[:1]
    pairs = {side: designed.pair(side) for side in cut}
    targets = {side: EaseOffTarget(0.02, 0.01) for side in SIDES}
    shared = shared_settings(method, SettingLimits(), 76.2)
    sides = {
        side: (pair, targets[side], root_gap(pair.pinion.loaded, pair.pinion.section)) for side, pair in pairs.items()
    }
    fit = SetUpResidual(sides, shared, designed.blank)
    here = np.full(fit.size, 0.01)
    fit(here)
    found = fit.jacobian(here)
    for index in range(fit.size):
        shift = np.zeros(fit.size)
        shift[index] = 1e-4
        differences = (fit(here + shift) - fit(here - shift)) / 2e-4
        assert np.abs(found[:, index] - differences).max() < 2e-4 * np.abs(differences).max(), index


def test_limits_take_settings_out_of_use() -> None:
    free = shared_settings("completing", SettingLimits(cutter_tilt=0.0, helical_motion=0.0), 80.0)
    assert not {"cutter_tilt", "cutter_swivel", "sliding_base_motion_1"} & set(free)
    assert "modified_roll_24e" in shared_settings("modified_roll", SettingLimits(modified_roll_24e=3.0), 80.0)
    assert "modified_roll_6d" not in shared_settings("modified_roll", SettingLimits(modified_roll_6d=0.0), 95.0)
    assert SettingLimits(cutter_tilt=0.3).allowed("cutter_tilt", 0.27, 95.0) == (-0.3, 0.3)
    assert SettingLimits().allowed("sliding_base", 0.27, 80.0) == (-40.0, 40.0)
    with pytest.raises(InputError, match="cutter_tilt"):
        SettingLimits(cutter_tilt=-0.1)
    with pytest.raises(InputError, match="blade_pressure_angle"):
        SettingLimits(blade_pressure_angle=(0.4, 0.3))


def with_method(method: str, *limits: str, name: str = "fh-design-a") -> str:
    lines = "\n".join(["[pinion.limits]", *limits]) if limits else ""
    text = design_text(name).replace("follow_root = true", f'method = "{method}"')
    assert text != design_text(name)
    return text.replace("[gear]", f"{lines}\n\n[gear]", 1)


@cache
def shop_case(method: str, name: str, *limits: str) -> tuple[Case, DesignReport]:
    return design_case(parse_design(with_method(method, *limits, name=name)))


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "method", "within"),
    [
        ("fm-11x41", "modified_roll", 0.007),
        ("fm-11x41", "tilt", 0.006),
        ("fm-11x41", "completing", 0.012),
        ("fh-design-a", "modified_roll", 0.006),
        ("fh-design-a", "tilt", 0.002),
        ("fh-design-a", "completing", 0.005),
    ],
)
def test_methods_reach_the_targets_of_the_shipped_designs(name: str, method: str, within: float) -> None:
    """On another grid than the fit's, from the case as written; a completing case has one machine for both flanks."""
    case, report = shop_case(method, name)
    root, pinion = report.blank.pinion.root_angle, case.pinion
    assert pinion.concave is not None
    assert pinion.convex is not None
    machines = pinion.concave.machine, pinion.convex.machine
    assert (machines[0] == machines[1]) == (method == "completing")
    if method == "modified_roll":
        assert {machine.cutter_tilt for machine in machines} == {0.0}
        assert all(machine.machine_root_angle == pytest.approx(math.degrees(root)) for machine in machines)
    for side in SIDES:
        found = ease_off(gear_pair(case, side), (13, 9))
        t, h = np.meshgrid(found["lengthwise"], found["profile"], indexing="ij")
        known = found["inside"].values.astype(bool)
        left = (1e-3 * found["ease_off"].values - ease_off_target(getattr(case.target, side))(t, h))[known]
        lever = found["lever_arm"].values[known]
        left = left - lever * (lever @ left) / (lever @ lever)
        assert np.abs(left).max() < min(within, 1.3 * report.sides[side].largest_residual + 3e-4)


@pytest.mark.thorough
def test_limits_hold_and_are_told() -> None:
    case, report = shop_case("tilt", "fh-design-a", "cutter_tilt = 15.0", "machine_root_angle = 20.0")
    for flank in (case.pinion.concave, case.pinion.convex):
        assert flank is not None
        assert 0.0 <= flank.machine.cutter_tilt <= 15.0 + 1e-9
        assert abs(flank.machine.machine_root_angle - math.degrees(report.blank.pinion.root_angle)) <= 20.0 + 1e-9
    assert any("cutter_tilt stands at its limit" in warning for warning in report.warnings)


@pytest.mark.thorough
def test_a_method_that_cannot_reach_its_target_is_refused_with_advice() -> None:
    """With the Formate gear that the file asks for; one that leaves the gear open gets a generated one."""
    text = with_method("fixed_setting", name="fm-11x41")
    formate = text.replace("[gear]", '[gear]\ngeneration = "formate"')
    with pytest.raises(GeometryError, match=r'drive: .* misses it by up to .* take method = "modified_roll" or "tilt"'):
        design_case(parse_design(formate))
    case, report = shop_case("fixed_setting", "fm-11x41")
    assert [each.name for each in report.defaults if each.source == SEARCHED] == ["gear.generation"]
    assert case.gear.convex is not None


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (with_method("rolling"), ["pinion.method", "rolling", "completing"]),
        (with_method("closest_fit", "cutter_tilt = 5.0"), ["limits belong to a method of the shop"]),
        (
            with_method("tilt").replace('hand_of_spiral = "left"', 'hand_of_spiral = "left"\nfollow_root = false'),
            ["follow_root", "closest_fit"],
        ),
        (with_method("tilt", "cutter_tilt = 95.0"), ["pinion.limits.cutter_tilt", "60"]),
        (
            with_method("tilt", "smallest_blade_pressure_angle = 30.0", "largest_blade_pressure_angle = 20.0"),
            ["smallest_blade_pressure_angle = 30.0", "must be below"],
        ),
    ],
)
def test_mistakes_in_the_method_are_told(text: str, words: list[str]) -> None:
    with pytest.raises(EaseoffError) as caught:
        parse_design(text)
    for word in words:
        assert word in str(caught.value)


def test_a_negative_tilt_is_written_as_a_positive_one_the_other_way() -> None:
    """The same flank up to a turn of the work: the same differences of azimuth at equal axial and radial places."""
    pair = gear_pair(read_case("nasa-12x36"))
    settings = replace(pair.pinion.loaded.settings, cutter_tilt=-0.03, cutter_swivel=0.4)
    negative = replace(pair.pinion.loaded, settings=settings)
    positive = with_positive_tilt(negative)
    assert positive.settings.cutter_tilt == 0.03
    axial, radial = pair.pinion.section.points(np.linspace(0.1, 0.9, 5), np.full(5, 0.5))
    one, two = (solve_flank(s, pair.pinion.section, axial, radial) for s in (negative, positive))
    turn = np.arctan2(one.position[1], one.position[0]) - np.arctan2(two.position[1], two.position[0])
    assert np.ptp(turn) < 1e-9


def test_at_limit_knows_both_ends() -> None:
    assert at_limit({"pressure_angle": math.radians(5.0)}, SettingLimits(), 0.2, 80.0) == ("pressure_angle",)
    assert at_limit({"ratio_of_roll": 3.0, "point_radius": 80.0}, SettingLimits(), 0.2, 80.0) == ()


# Standard steps of the cutters: taken before the fit, which makes up for them


STEPS = StandardSteps(math.radians(0.5), 0.1, 0.05)


def test_an_edge_radius_is_rounded_down_and_an_angle_to_its_step() -> None:
    assert STEPS.edge(0.93) == pytest.approx(0.9, abs=1e-9)
    assert math.degrees(STEPS.angle(math.radians(18.83))) == pytest.approx(19.0, abs=1e-9)


@pytest.mark.parametrize("make", [formate_gear, generated_gear])
@pytest.mark.parametrize(("name", "groups"), [("fm-11x41", 0), ("fh-design-a", 13)])
def test_gear_has_the_blank_angles_that_the_steps_leave(make: Any, name: str, groups: int) -> None:
    """Blade angles and point width on their steps; the spiral angle to rounding, pressure angles within half a step."""
    design = read_design(name)
    teeth = design.pinion.number_of_teeth, design.gear.number_of_teeth
    blank = designed_blanks(design.blank_design, teeth, design.pair)
    flanks = make(blank, design.blank_design.cutter_radius, "right", groups, steps=STEPS)
    section = blank_section(blank.gear, blank.clearance)
    found = [mean_point_angles(flank, section, blank.gear) for flank in flanks]
    for flank, angles, wanted in zip(
        flanks, found, (blank.generated_drive_pressure_angle, blank.generated_coast_pressure_angle), strict=True
    ):
        half_degrees = math.degrees(flank.blade.pressure_angle) / 0.5
        assert half_degrees == pytest.approx(round(half_degrees), abs=1e-9)
        assert abs(angles.pressure_angle - wanted) < math.radians(0.3)
    assert np.mean([angles.spiral_angle for angles in found]) == pytest.approx(blank.gear.mean_spiral_angle, abs=1e-9)
    if groups == 0:
        width = 10.0 * (flanks[1].blade.point_radius - flanks[0].blade.point_radius)
        assert width == pytest.approx(round(width), abs=1e-9)


@cache
def designed(method: str, steps: str = "") -> tuple[Case, DesignReport]:
    text = design_text("fh-design-a").replace("follow_root = true", f'method = "{method}"')
    text = text.replace("blade_angle = 0.0 ", "blade_angle = 0.5 ").replace("point_width = 0.0", "point_width = 0.1")
    return design_case(parse_design(text if not steps else text.replace("blade_angle = 0.5", steps)))


@pytest.mark.thorough
@pytest.mark.parametrize("method", ["closest_fit", "modified_roll", "completing"])
@pytest.mark.quick(1)
def test_pinion_is_fitted_with_blades_on_their_steps(method: str) -> None:
    """And comes as near to the target as with free ones; completing, the gear's blades alone have steps."""
    case, report = designed(method)
    for member in (case.gear,) if method == "completing" else (case.pinion, case.gear):
        for flank in (member.concave, member.convex):
            assert flank is not None
            halves = flank.cutter.blade_pressure_angle / 0.5
            assert halves == pytest.approx(round(halves), abs=1e-6)
    free = designed(method, "blade_angle = 0.0")[1]
    for side, item in report.sides.items():
        assert item.largest_residual < 1.3 * free.sides[side].largest_residual + 3e-4


def test_small_teeth_have_a_tenth_of_the_steps_and_edge_radii_are_rounded_down() -> None:
    assert STEPS.of_module(0.5).point_width == pytest.approx(0.01)
    assert STEPS.of_module(3.0) == STEPS
    assert STEPS.edge(0.999) == pytest.approx(0.95)
    assert STEPS.edge(0.03) == 0.03
    assert STEPS.width(0.02) == pytest.approx(0.1)
    assert StandardSteps().angle(0.3123) == 0.3123


@pytest.mark.parametrize("end", [0, 1])
def test_blades_are_rounded_within_the_limits_of_the_design(end: int) -> None:
    """The nearest step beyond a limit is not taken; without a step between the limits a blade stays as it is."""
    surface = gear_pair(read_case("nasa-12x36")).pinion.loaded
    angle, radius = get_setting(surface, "pressure_angle"), get_setting(surface, "point_radius")
    nearest = STEPS.blade(surface, with_radius=True)
    one, other = math.radians(0.2), 0.02
    limits = {
        "pressure_angle": (angle - one, angle + 3.0 * one) if end else (angle - 3.0 * one, angle + one),
        "point_radius": (radius - other, radius + 3.0 * other) if end else (radius - 3.0 * other, radius + other),
    }
    found = STEPS.blade(surface, with_radius=True, allowed=limits.__getitem__)
    assert found.keys() == nearest.keys()
    for name, step in (("pressure_angle", STEPS.blade_angle), ("point_radius", 0.5 * STEPS.point_width)):
        low, high = limits[name]
        assert low <= found[name] <= high
        assert found[name] / step == pytest.approx(round(found[name] / step), abs=1e-9)
    held = STEPS.blade(surface, with_radius=True, allowed=lambda name: (limits[name][end],) * 2)
    assert held == {name: get_setting(surface, name) for name in held}


def test_negative_steps_are_refused() -> None:
    with pytest.raises(InputError, match=r"step of point_width = -0.1: must be"):
        StandardSteps(point_width=-0.1)
    with pytest.raises(InputError, match=r"cutter_steps.blade_angle"):
        parse_design(design_text("fm-11x41").replace("blade_angle = 0.0", "blade_angle = -0.5"))


def test_resolution_of_the_design_is_that_of_the_machine() -> None:
    text = design_text("fm-11x41").replace("[cutter_steps]", "[resolution]\nlength = 0.01\n\n[cutter_steps]")
    assert machine_resolution(parse_design(text).resolution) == MachineResolution(length=0.01)
    with pytest.raises(InputError, match=r"resolution.length = 0.0: must be"):
        parse_design(text.replace("length = 0.01", "length = 0.0"))


def test_settings_of_files_and_of_surfaces_have_one_step() -> None:
    fine = MachineResolution(blade_angle=0.25)
    assert step_of("pressure_angle", fine) == step_of("offset_angle", fine) == 0.25
    assert step_of("horizontal_distance", fine) == step_of("radial_distance", fine) == 0.001
    assert (step_of("work_offset_motion_1", fine), step_of("toprem_depth", fine)) == (0.001, None)
    assert step_of("sliding_base_motion_2", fine) == fine.motion
    assert gear_pair(read_case("fm-11x41")).pinion.loaded.blade.edge_radius == 0.8


def test_limits_steps_and_targets_of_a_design_are_in_mm_and_rad() -> None:
    design = read_design("fm-11x41")
    assert setting_limits(design.pinion.limits).cutter_tilt == pytest.approx(math.radians(30.0))
    assert standard_steps(design.cutter_steps).point_width == 0.0
    target = read_case("fm-11x41").target.drive
    assert target is not None
    assert ease_off_target(target).profile_crowning == pytest.approx(0.0199, abs=5e-5)
