"""Standard steps of the cutters: taken before the fit, which makes up for them."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from easeoff import InputError
from easeoff.cases import Case, design_text, designed_blanks, gear_pair, parse_design, read_case, read_design
from easeoff.cases.conversion import machine_resolution
from easeoff.geometry import formate_gear, generated_gear
from easeoff.geometry.cutting.machine_resolution import MachineResolution, step_of
from easeoff.geometry.design.basic_settings import blank_section
from easeoff.geometry.design.mean_point import mean_point_angles
from easeoff.geometry.design.standard_steps import StandardSteps
from easeoff.study import DesignReport, design_case

STEPS = StandardSteps(math.radians(0.5), 0.1, 0.05)


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
    assert step_of("sliding_base_motion_2", fine) == fine.motion
    assert gear_pair(read_case("fm-11x41")).pinion.loaded.blade.edge_radius == 0.8
