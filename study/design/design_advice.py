"""Design advice: what in the basic data of a doubtful design to look at, a sentence each."""

from __future__ import annotations

import math

from ...cases.schema.design_schema import Design
from ...core.errors import EaseoffError, GeometryError
from ...geometry.design.blank import BlankDesign, blank_dimensions

FORMATE_PITCH_ANGLE = 60.0  # [deg]; customary for ratios of two and a half and more
CUTTER_RADIUS_RATIO = 1.5  # over the gear's mean cone distance; pairs in use lie between 0.7 and 1.2
LEAST_PRESSURE_ANGLE = 10.0  # generated [deg]; next to it a slot has parallel walls
LEAST_CROWNING = 1.0  # [um]; a smaller one looks like mm


def limit_pressure_angle_advice(basic_data: BlankDesign) -> list[str]:
    """Advice, a line each, on what the limit pressure angle of a hypoid pair makes of its pressure angles."""
    if basic_data.hypoid_offset == 0.0:
        return []
    try:
        blank = blank_dimensions(basic_data)
    except GeometryError:
        return []
    limit = math.degrees(blank.limit_pressure_angle)
    if not basic_data.limit_pressure_angle_influence > 0.0:
        return [
            f"limit_pressure_angle_influence = 0 while the limit pressure angle of this offset is {limit:.1f} degrees: "
            "1 gives drive and coast flanks pressure angles that allow for it"
        ]
    generated = {"drive": blank.generated_drive_pressure_angle, "coast": blank.generated_coast_pressure_angle}
    return [
        f"the generated {side} pressure angle of {math.degrees(angle):.1f} degrees is small, as the limit pressure "
        f"angle of this offset is {limit:.1f} degrees: a smaller hypoid_offset or a larger "
        f"nominal_{side}_pressure_angle helps"
        for side, angle in generated.items()
        if math.degrees(angle) < LEAST_PRESSURE_ANGLE
    ]


def formate_advice(design: Design, basic_data: BlankDesign) -> list[str]:
    """Advice, in one line or none, on a Formate gear with so small a pitch angle that generation serves it better."""
    if design.gear.generation == "generated":
        return []
    try:
        angle = math.degrees(blank_dimensions(basic_data).gear.pitch_angle)
    except GeometryError:
        return []
    if angle >= FORMATE_PITCH_ANGLE:
        return []
    return [
        f"the gear's pitch angle of {angle:.0f} degrees is small for a gear cut without generation: generation = "
        '"generated" in [gear] helps'
    ]


def cutter_radius_advice(basic_data: BlankDesign) -> list[str]:
    """Advice, in one line or none, on a cutter so large that its diameter seems to be given."""
    try:
        gear = blank_dimensions(basic_data).gear
    except EaseoffError:
        return []
    distance = gear.outer_cone_distance - 0.5 * gear.face_width
    if basic_data.cutter_radius < CUTTER_RADIUS_RATIO * distance:
        return []
    return [
        f"cutter_radius = {basic_data.cutter_radius:g} mm is {basic_data.cutter_radius / distance:.1f} times the "
        f"gear's mean cone distance of {distance:.0f} mm, 0.7 to 1.2 are usual: the radius is meant, not the diameter?"
    ]


def small_target_advice(design: Design) -> list[str]:
    """Advice on crownings of the target that seem to be given in mm."""
    return [
        f"target.{side}.{key} = {value:g}: next to no crowning; um are meant, not mm?"
        for side in ("drive", "coast")
        for key in ("lengthwise_crowning", "profile_crowning")
        if 0.0 < abs(value := getattr(getattr(design.target, side), key)) < LEAST_CROWNING
    ]


def offset_advice(design: Design, basic_data: BlankDesign) -> list[str]:
    """Advice, in one line or none, on what a negative offset means."""
    if basic_data.hypoid_offset >= 0.0:
        return []
    hand = design.pinion.hand_of_spiral
    place = "above" if hand == "left" else "below"
    return [
        f"hypoid_offset = {basic_data.hypoid_offset:g} mm is negative: the {hand}-hand pinion lies {place} centre and "
        "has the smaller spiral angle; the usual hypoid pair has a positive one"
    ]
