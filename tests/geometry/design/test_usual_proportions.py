"""Basic data that a drawing omits: values of the standard, and proportions that fit few teeth and uniform depth."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from easeoff.geometry import BlankDesign, blank_dimensions
from easeoff.geometry.design.fitting_proportions import (
    FREE_PROPORTIONS,
    LEAST_LAND,
    LEAST_MARGIN,
    fitting_proportions,
    undercut_margin,
)
from easeoff.geometry.design.iso23509.usual_proportions import usual_proportions
from easeoff.geometry.design.slot_width import SlotWidths, ToothLine, TopLands
from easeoff.geometry.design.tooth_proportions import ToothProportions

#: What a drawing of sample F.2 of ISO 23509:2016 shows.
SAMPLE: dict[str, Any] = {
    "gear_outer_pitch_diameter": 176.893,
    "gear_mean_spiral_angle": math.radians(35.0),
    "cutter_radius": 114.3,
}


def usual(given: dict[str, Any], teeth: tuple[int, int], offset: float = 0.0, shaft: float = 90.0) -> dict[str, Any]:
    return {each.name: each.value for each in usual_proportions(given, teeth, math.radians(shaft), offset)}


def test_values_are_those_of_the_sample_of_the_standard() -> None:
    taken = usual(SAMPLE, (14, 39))
    assert taken["gear_mean_addendum_factor"] == pytest.approx(0.24737, abs=5e-6)
    assert taken["thickness_factor"] == pytest.approx(0.0915, abs=5e-5)
    assert (taken["depth_factor"], taken["clearance_factor"], taken["method"]) == (2.0, 0.125, 0)
    # 0.3 of the outer cone distance is 28.19 mm; the sample has an inch.
    assert taken["gear_face_width"] == pytest.approx(28.1, abs=1e-9)
    assert taken["process"] == "face_milled"


def test_what_is_given_is_kept_and_all_is_taken_once() -> None:
    given = SAMPLE | {"depth_factor": 1.8, "process": "face_milled", "depth_taper": "standard", "method": None}
    taken = usual(given, (14, 39))
    assert taken.keys().isdisjoint(name for name, value in given.items() if value is not None)
    assert "method" in taken
    again = usual(given | taken, (14, 39))
    assert again == {}


def test_equal_members_of_a_mitre_pair_have_equal_teeth() -> None:
    taken = usual(SAMPLE, (20, 20))
    assert taken["thickness_factor"] == pytest.approx(0.0, abs=1e-12)
    assert taken["gear_mean_addendum_factor"] == pytest.approx(0.5, abs=1e-12)


@pytest.mark.parametrize(
    ("given", "teeth", "offset", "wanted"),
    [
        ({"number_of_blade_groups": 13}, (12, 37), 0.0, {"process": "face_hobbed", "depth_taper": "uniform"}),
        ({"number_of_blade_groups": 13}, (12, 37), 20.0, {"method": 3, "limit_pressure_angle_influence": 0.0}),
        ({"pinion_mean_spiral_angle": 0.8}, (12, 37), 20.0, {"method": 1, "limit_pressure_angle_influence": 1.0}),
        ({"gear_mean_pitch_diameter": 150.0}, (12, 37), 20.0, {"method": 2}),
        ({"cutter_radius": 40.0}, (14, 39), 0.0, {"depth_taper": "uniform"}),
        ({}, (14, 39), 0.0, {"depth_taper": "modified_slot_width"}),
        ({}, (7, 39), 0.0, {"depth_factor": 1.835}),
        ({}, (10, 41), 20.0, {"gear_mean_addendum_factor": 0.17}),
        (
            {"basic_addendum_factor": 1.1},
            (20, 20),
            0.0,
            {"basic_dedendum_factor": 1.25, "profile_shift_coefficient": 0.0},
        ),
        ({"gear_mean_spiral_angle": 0.0}, (14, 39), 0.0, {"gear_face_width": 23.4}),
        ({}, (14, 140), 0.0, {"gear_face_width": 12.6}),
    ],
)
def test_defaults_follow_process_offset_and_teeth(
    given: dict[str, Any], teeth: tuple[int, int], offset: float, wanted: dict[str, Any]
) -> None:
    taken = usual(SAMPLE | given, teeth, offset)
    assert {name: taken[name] for name in wanted} == pytest.approx(wanted)


def basic_data(teeth: tuple[int, int], **given: Any) -> BlankDesign:
    """Basic data of a pair at right angles with all defaults."""
    whole = SAMPLE | given
    values = whole | usual(whole, teeth)
    spiral = values.pop("gear_mean_spiral_angle")
    angle = math.radians(20.0)
    return BlankDesign(
        number_of_teeth=teeth,
        mean_spiral_angle=spiral,
        nominal_drive_pressure_angle=angle,
        nominal_coast_pressure_angle=angle,
        **values,
    )


def least_width(design: BlankDesign) -> float:
    """Least top land or slot over the module."""
    blank = blank_dimensions(design)
    groups = design.number_of_blade_groups or 0
    lands = TopLands(
        SlotWidths(ToothLine(ToothProportions.of(blank, design.cutter_radius, groups, generated_gear=True)))
    )
    return float(min(lands.width.min(), lands.slots.width.min())) / blank.mean_normal_module


@pytest.mark.parametrize(
    ("teeth", "given"),
    [
        ((7, 28), {"number_of_blade_groups": 7, "cutter_radius": 76.0}),  # pointed at the toe
        (
            (10, 17),
            {
                "number_of_blade_groups": 7,
                "cutter_radius": 51.0,
                "gear_outer_pitch_diameter": 110.0,
                "gear_mean_spiral_angle": math.radians(27.0),
            },
        ),
        ((8, 12), {"gear_mean_spiral_angle": 0.45}),  # with roots that rise too steeply
    ],
)
def test_proportions_that_were_left_out_are_changed_until_the_teeth_fit(
    teeth: tuple[int, int], given: dict[str, Any]
) -> None:
    design = basic_data(teeth, **given)
    fitted, changes = fitting_proportions(design, FREE_PROPORTIONS, generated_gear=True)
    assert changes
    assert {each.name for each in changes} <= set(FREE_PROPORTIONS)
    assert fitted == replace(design, **{each.name: each.value for each in changes})
    blank = blank_dimensions(fitted)
    assert least_width(fitted) >= LEAST_LAND
    assert undercut_margin(blank) >= LEAST_MARGIN * blank.mean_normal_module
    assert max(abs(blank.pinion.dedendum_angle), abs(blank.gear.dedendum_angle)) <= math.radians(12.0)
    assert fitting_proportions(fitted, FREE_PROPORTIONS, generated_gear=True) == (fitted, ())
    assert fitting_proportions(design, (), generated_gear=True) == (design, ())


def test_teeth_that_fit_are_left_as_they_are() -> None:
    design = basic_data((14, 39))
    assert fitting_proportions(design, FREE_PROPORTIONS, generated_gear=True) == (design, ())


def test_undercut_begins_where_the_involute_does() -> None:
    """Of a straight-toothed bevel pinion of 17 virtual teeth the rack of 20 degrees just fits: z sin^2 = 2."""
    for teeth, sign in ((17, -1.0), (18, 1.0)):
        design = replace(
            basic_data((teeth, 40 * teeth), gear_mean_spiral_angle=0.0, gear_outer_pitch_diameter=4000.0),
            gear_mean_addendum_factor=0.5,
            gear_face_width=1.0,
            cutter_radius=1e6,
            depth_taper="uniform",
        )
        blank = blank_dimensions(design)
        assert np.sign(undercut_margin(blank)) == sign
        virtual = teeth / math.cos(blank.pinion.pitch_angle)
        exact = blank.mean_normal_module * (0.5 * virtual * math.sin(math.radians(20.0)) ** 2 - 1.0)
        assert undercut_margin(blank) == pytest.approx(exact, abs=2e-3 * blank.mean_normal_module)
