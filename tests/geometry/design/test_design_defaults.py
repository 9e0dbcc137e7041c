"""Generated gears, and what a design does without being asked: crown-gear start, fillet, torques, root line."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from runs import refusal_of

from easeoff import GeometryError, InputError
from easeoff.cases import case_text, case_toml, design_text, gear_pair, parse_case, parse_design, read_case
from easeoff.cases.schema.usual_torques import usual_torques
from easeoff.geometry import (
    Assembly,
    BlankDesign,
    BlankDimensions,
    EaseOffTarget,
    GearPair,
    GeneratingSurface,
    Member,
    blank_dimensions,
    blank_section,
)
from easeoff.geometry.design import closest_fit
from easeoff.geometry.design.basic_settings import crown_gear_pinion, generated_gear, pitch_point_azimuth
from easeoff.geometry.design.closest_fit import StandardSteps, require_usable, residual_limits, target_range
from easeoff.geometry.design.pair_design import design_pair
from easeoff.geometry.design.slot_width import (
    EdgeRadiusLimits,
    SlotWidths,
    ToothLine,
    fitting_edge_radius,
    usual_edge_radii,
)
from easeoff.geometry.design.synthesis import FREE_SETTINGS_WITH_TILT, EaseOffResidual
from easeoff.geometry.design.tooth_proportions import ToothProportions
from easeoff.geometry.pair.ease_off import exact_ease_off
from easeoff.geometry.pair.gear_pair import grid
from easeoff.geometry.tooth.tooth_surface import tooth_surface
from easeoff.study.design.case_design import design_case
from easeoff.study.design.design_check import off_the_root


def bevel(teeth: tuple[int, int], spiral: float, module: float = 4.0, *, hobbed: bool = False) -> BlankDesign:
    """A spiral bevel pair at right angles with teeth of the usual depth."""
    diameter = module * teeth[1]
    outer = diameter / 2.0 / math.sin(math.atan2(teeth[1], teeth[0]))
    width = min(0.3 * outer, 10.0 * module)
    return BlankDesign(
        method=0,
        process="face_hobbed" if hobbed else "face_milled",
        number_of_teeth=teeth,
        mean_spiral_angle=math.radians(spiral),
        gear_outer_pitch_diameter=diameter,
        gear_face_width=width,
        cutter_radius=outer - width / 2.0,
        number_of_blade_groups=7 if hobbed else None,
        nominal_drive_pressure_angle=math.radians(20.0),
        nominal_coast_pressure_angle=math.radians(20.0),
        gear_mean_addendum_factor=0.21 + 0.29 / (teeth[1] / teeth[0]) ** 2,
        depth_factor=2.0,
        clearance_factor=0.125,
        thickness_factor=0.0,
        depth_taper="uniform" if hobbed else "standard",
    )


def assembly_of(design: BlankDesign) -> Assembly:
    return Assembly(*design.number_of_teeth, "left", design.shaft_angle, design.hypoid_offset)


def crown_gear_spreads(design: BlankDesign) -> list[tuple[float, float]]:
    """Range of the ease-off of gear and crown-gear pinion [mm], and the share of the gear flank that they share.

    Of the convex flank of the gear and of the concave one.
    """
    blank, assembly = blank_dimensions(design), assembly_of(design)
    groups = design.number_of_blade_groups or 0
    gears = generated_gear(blank, design.cutter_radius, assembly.gear_hand, groups, corrected=False)
    return [_spread(design, blank, gear) for gear in gears]


def _spread(design: BlankDesign, blank: BlankDimensions, flank: GeneratingSurface) -> tuple[float, float]:
    assembly, height = assembly_of(design), blank.gear.mean_dedendum + blank.pinion.mean_dedendum
    surface = crown_gear_pinion(flank, assembly, height, pitch_point_azimuth(blank, design.hypoid_offset))
    pinion = Member(assembly.pinion_teeth, blank_section(blank.pinion, blank.clearance), surface)
    gear = Member(assembly.gear_teeth, blank_section(blank.gear, blank.clearance), flank)
    pair = GearPair(pinion, gear, assembly)
    found = exact_ease_off(pair.gear.flank(*grid((9, 7))), surface, pinion.section, assembly)
    known = np.isfinite(found.angle)
    gap, lever = (found.angle * found.lever_arm)[known], found.lever_arm[known]
    left = gap - lever * float(lever @ gap) / float(lever @ lever)
    return float(np.ptp(left)), float(known.mean())


@pytest.mark.parametrize("hobbed", [False, True])
@pytest.mark.parametrize(("teeth", "spiral"), [((20, 20), 30.0), ((12, 36), 35.0)])
def test_pinion_of_the_common_crown_gear_is_conjugate(teeth: tuple[int, int], spiral: float, hobbed: bool) -> None:
    """Three bodies with one instantaneous axis: no ease-off, on every node that both flanks have."""
    for spread, share in crown_gear_spreads(bevel(teeth, spiral, hobbed=hobbed)):
        assert spread < 1e-6
        assert share > 0.7


def test_small_spiral_angles_stay_on_the_tooth() -> None:
    """The envelope of a Zerol cutter folds twice within reach of the search: no node comes from beyond."""
    for spread, share in crown_gear_spreads(bevel((16, 20), 0.0)):
        assert spread < 1e-6
        assert share > 0.5


def test_hypoid_crown_gear_is_nearer_at_the_pitch_point() -> None:
    """Turned to the pitch point it leaves a fraction of what it leaves in the plane of the gear axis."""
    design = replace(bevel((12, 36), 35.0), method=1, hypoid_offset=10.0)
    blank = blank_dimensions(design)
    azimuth = pitch_point_azimuth(blank, 10.0)
    assert 0.0 < azimuth < math.pi / 2
    assert pitch_point_azimuth(blank, 0.0) == 0.0
    assert crown_gear_spreads(design)[0][0] < 0.1


def test_formate_gear_has_no_crown_gear() -> None:
    pair = gear_pair(read_case("fm-11x41"))
    with pytest.raises(GeometryError, match="Formate"):
        crown_gear_pinion(pair.gear.loaded, pair.assembly, 10.0)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("teeth", "spiral", "module"), [((18, 36), 0.0, 3.0), ((20, 25), 35.0, 0.5), ((25, 25), 30.0, 4.0)]
)
def test_generated_gears_reach_their_target(teeth: tuple[int, int], spiral: float, module: float) -> None:
    """Fitted to some micrometres, on the root cone, with fillets in the slot, for gears that are no plane wheels."""
    design = bevel(teeth, spiral, module)
    target = EaseOffTarget(lengthwise_crowning=4e-3 * module, profile_crowning=1.3e-3 * module)
    designed = design_pair(design, assembly_of(design), {"drive": target, "coast": target}, generated=True)
    for fit in designed.pinion.values():
        assert fit.largest_residual < residual_limits(target)[0] * 1.5
        assert np.all(np.abs(fit.root_gap) < designed.blank.clearance)
    for name in ("pinion", "gear"):
        tooth_surface(designed.pair(), name, (9, 7))


def test_a_fit_far_off_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """After one fit from each start; the blade tips do not come onto the root cone."""
    monkeypatch.setattr(closest_fit, "ROOT_PASSES", 1)
    design = bevel((12, 36), 35.0)
    target = EaseOffTarget(lengthwise_crowning=0.05)
    with pytest.raises(
        GeometryError, match=r"drive: no pinion near the target .* range is 50.0 um and 25.0 um would do"
    ):
        design_pair(
            design, assembly_of(design), {"drive": target, "coast": target}, generated=True, free=["point_radius"]
        )
    assert target_range(target) == pytest.approx(0.05)


@pytest.mark.parametrize("name", ["fm-11x41", "fh-12x41-45", "nasa-12x36"])
@pytest.mark.parametrize("side", ["drive", "coast"])
@pytest.mark.quick(2)
def test_derivatives_of_the_fit_are_those_of_its_residuals(name: str, side: Any) -> None:
    """Against central differences of the residuals, for which every conjugate point is sought anew."""
    pair = gear_pair(read_case(name), side)
    names = (*FREE_SETTINGS_WITH_TILT, "machine_root_angle", "sliding_base_motion_1", "blade_curvature")
    fit = EaseOffResidual(pair, EaseOffTarget(0.03, 0.01), names, (7, 5), 0.0, follow_root=True)
    here = np.full(len(names), 0.01)
    found = fit.jacobian(here)
    for column, name_of, step in zip(found.T, names, fit.difference, strict=True):
        shift = np.where(np.array(names) == name_of, step, 0.0)
        differences = (fit(here + shift) - fit(here - shift)) / (2.0 * step)
        assert np.abs(column - differences).max() < 1e-4 * np.abs(differences).max(), name_of


def test_a_fit_far_off_on_the_whole_flank_is_refused() -> None:
    target = EaseOffTarget(lengthwise_crowning=0.05)
    assert residual_limits(target) == pytest.approx((0.005, 0.025))
    require_usable("drive", 0.024, target)
    for residual in (0.026, math.nan):
        with pytest.raises(GeometryError, match=r"drive: no pinion near the target"):
            require_usable("drive", residual, target)


def test_edge_radius_is_made_smaller_until_the_tooth_passes() -> None:
    pair, tried = gear_pair(read_case("fm-11x41")), []

    def require(made: GearPair, member: str) -> None:
        tried.append(made.gear.loaded.blade.edge_radius)
        if tried[-1] > 0.65:
            raise GeometryError("too large")

    assert fitting_edge_radius([pair], "gear", 1.0, require, StandardSteps()) == (0.6, True)
    assert tried == [1.0, 0.8, 0.6]
    assert fitting_edge_radius([pair], "gear", 100.0, require, StandardSteps()) == (100.0, False)


def slotted(taper: str, model: str) -> str:
    """A pair of module 0.9 whose pinion has no room at the bottom of its slot if its teeth have uniform depth."""
    return f"""easeoff_design = 1
title = "narrow slot"
[pair]
[blank_design]
method = 0
process = "face_milled"
gear_mean_spiral_angle = 37.9
gear_outer_pitch_diameter = 28.644
gear_face_width = 4.77
cutter_radius = 15.15
nominal_drive_pressure_angle = 22.5
nominal_coast_pressure_angle = 22.5
gear_mean_addendum_factor = 0.28
depth_factor = 2.0
clearance_factor = 0.125
thickness_factor = 0.08
depth_taper = "{taper}"
[pinion]
number_of_teeth = 15
hand_of_spiral = "left"
[gear]
number_of_teeth = 31
generation = "generated"
[compliance]
model = "{model}"
[target.drive]
lengthwise_crowning = 10.0
profile_crowning = 3.0
[target.coast]
lengthwise_crowning = 10.0
profile_crowning = 3.0
"""


@pytest.mark.thorough
@pytest.mark.parametrize("model", ["solid_shell", "shell"])
def test_a_narrow_slot_is_told_with_what_was_tried(model: str) -> None:
    wider = slotted("uniform", model).replace("cutter_radius = 15.15", "cutter_radius = 17.0")
    warnings = design_case(parse_design(wider))[1].warnings
    assert any("the pinion's slot overlap" in w and "were tried" in w and "depth_taper" in w for w in warnings)


def test_lost_root_is_told_and_does_not_hide_the_rest() -> None:
    told = list(off_the_root("pinion", np.array([math.nan, 1.44, 0.1]), 0.86))
    assert len(told) == 2
    assert "1.44 mm" in told[0]
    assert "0.86 mm" in told[0]
    assert "toe" in told[1]
    assert list(off_the_root("pinion", np.array([0.1, -0.2, 0.1]), 0.86)) == []


def test_edge_radius_is_that_of_the_basic_rack_up_to_the_limit_of_agma_929() -> None:
    wide, tight = bevel((25, 60), 30.0), replace(bevel((25, 60), 30.0), clearance_factor=0.05)
    for design, limited in ((wide, False), (tight, True)):
        blank = blank_dimensions(design)
        proportions = ToothProportions.of(blank, design.cutter_radius, generated_gear=False)
        limits = EdgeRadiusLimits(SlotWidths(ToothLine(proportions)))
        pinion, _ = usual_edge_radii(proportions)
        wanted = limits.largest[0] if limited else 0.25 * blank.mean_normal_module
        assert pinion == pytest.approx(wanted, abs=1e-4)
        assert limits.governing[0] == ("interference" if limited else "manufacture")


def test_a_design_makes_no_tooth_without_fillet() -> None:
    with pytest.raises(InputError, match=r"pinion.tool_edge_radius = 0.0: must be greater than 0"):
        parse_design(design_text("fm-11x41").replace("tool_edge_radius = 0.8", "tool_edge_radius = 0.0"))
    design = parse_design(
        design_text("fm-11x41").replace("tool_edge_radius = 0.8", "").replace("follow_root = true", "")
    )
    assert design.pinion.tool_edge_radius is None
    assert design.pinion.follow_root


def test_old_spiral_angle_key_says_its_new_names() -> None:
    old = design_text("fm-11x41").replace("pinion_mean_spiral_angle", "mean_spiral_angle")
    with pytest.raises(InputError, match=r"mean_spiral_angle: is now pinion_mean_spiral_angle in method 1"):
        parse_design(old)
    with pytest.raises(InputError, match=r"pinion_mean_spiral_angle is missing: method 1 needs it"):
        parse_design(design_text("fm-11x41").replace("pinion_mean_spiral_angle = 40.5", ""))


def test_torques_grow_with_the_cube_of_the_size() -> None:
    assert usual_torques(5.0, 30.0, 11) == (33.0, 160.0, 330.0)
    small, large = usual_torques(2.0, 20.0, 15), usual_torques(20.0, 200.0, 15)
    assert [big / little for big, little in zip(large, small, strict=True)] == pytest.approx([1000.0] * 3)


def test_a_case_without_torques_takes_those_of_its_size() -> None:
    text = case_text("nasa-12x36").replace("torques = [50.0, 150.0, 300.0]", "")
    case = parse_case(text)
    assert case.contact.torques[1] == pytest.approx(150.0, rel=0.3)
    assert parse_case(case_toml(case)).contact.torques == case.contact.torques


def test_command_refuses_the_old_key(tmp_path: Path) -> None:
    (tmp_path / "old.toml").write_text(design_text("fm-11x41").replace("pinion_mean_", "mean_"))
    said = refusal_of("design", tmp_path / "old.toml", "-o", tmp_path / "case.toml")
    assert "is now pinion_mean_spiral_angle" in said
