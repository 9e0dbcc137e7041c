"""Gear pairs the tests are made with."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from easeoff.cases import Case, read_case
from easeoff.cases.schema.case_schema import ComplianceTable
from easeoff.geometry import (
    Assembly,
    Blade,
    BlankDesign,
    BlankSection,
    Flank,
    GearPair,
    GeneratingSurface,
    Hand,
    MachineSettings,
    Member,
    PairGeometry,
    conjugate_pinion,
    pair_geometry,
)
from easeoff.geometry.cutting.blade import Relief
from easeoff.geometry.pair.ease_off import EaseOff, exact_ease_off
from easeoff.geometry.pair.gear_pair import grid, thickness_per_angle, tooth_angles
from easeoff.geometry.pair.tooth_thickness import filling_thickness
from easeoff.verification.conventional_analysis import PointContact, path_of_contact


def by_the_dissertation(name: str, **contact: Any) -> Case:
    """A shipped case by the dissertation's method, shells and contact on lines alone; with other keys of [contact]."""
    case = read_case(name)
    update = {"edge_contact": False, **contact}
    return case.model_copy(
        update={"compliance": ComplianceTable(model="shell"), "contact": case.contact.model_copy(update=update)}
    )


# Basic data of a face-milled 11 x 41 hypoid pair by ISO 23509 Method 1.
MILLED = BlankDesign(
    method=1,
    process="face_milled",
    number_of_teeth=(11, 41),
    hypoid_offset=20.0,
    mean_spiral_angle=math.radians(40.5),
    gear_outer_pitch_diameter=211.8355,
    gear_face_width=33.3,
    cutter_radius=95.25,
    nominal_drive_pressure_angle=math.radians(20.0),
    nominal_coast_pressure_angle=math.radians(20.0),
    limit_pressure_angle_influence=1.0,
    gear_mean_addendum_factor=0.2,
    depth_factor=2.0,
    clearance_factor=0.125,
    thickness_factor=0.1,
    depth_taper="modified_slot_width",
)
# A generated flank with all motions, and places on it: angles of cutter and cradle [rad].
GENERATED = MachineSettings(
    radial_distance=75.0,
    cradle_angle=1.1,
    machine_root_angle=0.3,
    work_offset=4.0,
    sliding_base=0.7,
    machine_center_to_crossing_point=-1.1,
    cutter_tilt=0.15,
    cutter_swivel=-0.4,
    ratio_of_roll=3.2,
    modified_roll=(0.02, -0.03),
)
PARAMETERS = np.array([[-2.1, -2.0, -1.9, -2.3], [-0.1, 0.0, 0.15, 0.3]])

# A face-milled 11 x 41 hypoid pair with offset 20 and a Formate gear: rounded ISO 23509 Method 1 blanks.
PINION_BLANK = BlankSection(
    pitch_angle=math.radians(17.05),
    face_angle=math.radians(22.38),
    root_angle=math.radians(15.71),
    pitch_apex=2.86,
    face_apex=-4.42,
    root_apex=1.76,
    outer_cone_distance=113.36,
    face_width=32.75,
    clearance=0.98,
)
GEAR_BLANK = BlankSection(
    pitch_angle=math.radians(72.595),
    face_angle=math.radians(73.95),
    root_angle=math.radians(67.16),
    pitch_apex=0.37,
    face_apex=-0.37,
    root_apex=2.38,
    outer_cone_distance=111.0,
    face_width=29.8,
    clearance=0.98,
)
GEAR_MACHINE = MachineSettings(
    radial_distance=98.04,
    cradle_angle=math.radians(58.63),
    machine_root_angle=math.radians(67.16),
    machine_center_to_crossing_point=2.38,
)
DRIVE_BLADE = Blade(93.76, math.radians(17.1), "inside")
COAST_BLADE = Blade(96.74, math.radians(22.9), "outside")


def conjugate_pair(pinion_hand: Hand = "left", *, coast: bool = False) -> GearPair:
    """The 11 x 41 pair with the pinion that is exactly conjugate to its Formate gear."""
    gear_hand: Hand = "right" if pinion_hand == "left" else "left"
    drive = GeneratingSurface(DRIVE_BLADE, GEAR_MACHINE, gear_hand, 1)
    other = replace(drive, blade=COAST_BLADE)
    if coast:
        drive, other = other, drive
    assembly = Assembly(11, 41, pinion_hand, math.pi / 2, 20.0)
    pinion, pinion_other = (conjugate_pinion(surface, assembly, 9.83) for surface in (drive, other))
    return GearPair(Member(11, PINION_BLANK, pinion, pinion_other), Member(41, GEAR_BLANK, drive, other), assembly)


def circular_backlash(pair: GearPair) -> float:
    """Normal circular backlash in the middle of the gear's flank [mm]; negative if the teeth overlap."""
    pitch = 2.0 * np.pi / pair.pinion.teeth
    filling = filling_thickness(pair) / thickness_per_angle(pair.pinion)
    # More than half a pitch too thin is as much too thick, a tooth further on.
    thinner = np.mod(filling - tooth_angles(pair)[0] + pitch / 2.0, pitch) - pitch / 2.0
    return float(thinner) / pair.assembly.ratio * thickness_per_angle(pair.gear)


# Blade groups of the hobbed pair, and the blades of its gear.
GROUPS = 13
DRIVE = Blade(93.76, math.radians(17.1), "inside", math.radians(12.0), math.radians(3.0), math.radians(5.0))
COAST = Blade(96.74, math.radians(22.9), "outside", math.radians(11.0), math.radians(-2.0), math.radians(4.0))


def hobbed_pair(hand: Hand, *, coast: bool = False) -> GearPair:
    """A Formate gear and the pinion that is conjugate to it, both face-hobbed."""
    other_hand: Hand = "right" if hand == "left" else "left"
    gear = GeneratingSurface(DRIVE, replace(GEAR_MACHINE, indexing_ratio=GROUPS / 41), other_hand, 1)
    flanks = [gear, replace(gear, blade=COAST)]
    if coast:
        flanks.reverse()
    assembly = Assembly(11, 41, hand, math.pi / 2, 20.0)
    pinion = [conjugate_pinion(flank, assembly, 9.83) for flank in flanks]
    return GearPair(
        Member(11, PINION_BLANK, pinion[0], pinion[1]), Member(41, GEAR_BLANK, flanks[0], flanks[1]), assembly
    )


def mirrored(pair: GearPair) -> GearPair:
    """The pair with the hands of both members swapped and every other number kept."""

    def other(hand: Hand) -> Hand:
        return "left" if hand == "right" else "right"

    def surface(one: GeneratingSurface) -> GeneratingSurface:
        return replace(one, hand=other(one.hand))

    def member(one: Member) -> Member:
        opposite = None if one.opposite is None else surface(one.opposite)
        return replace(one, loaded=surface(one.loaded), opposite=opposite)

    assembly = replace(pair.assembly, pinion_hand=other(pair.assembly.pinion_hand))
    return GearPair(member(pair.pinion), member(pair.gear), assembly)


def relieved(
    pair: GearPair,
    member: Literal["pinion", "gear"],
    nodes: tuple[int, int] | None = None,
    /,
    *,
    toprem: Relief | None = None,
    flankrem: Relief | None = None,
) -> PairGeometry:
    """The pair with a toprem or flankrem at a share of a member's depth, on the default grid if no nodes are given."""
    own = pair.pinion if member == "pinion" else pair.gear
    ends = own.section.points(np.array([0.5, 0.5]), np.array([0.0, 1.0]))
    depth = float(np.linalg.norm(ends[:, 1] - ends[:, 0]))
    low, high = (relief and replace(relief, height=relief.height * depth) for relief in (toprem, flankrem))
    blade = replace(own.loaded.blade, toprem=low, flankrem=high)
    changed = replace(own, loaded=replace(own.loaded, blade=blade))
    other = replace(pair, pinion=changed) if member == "pinion" else replace(pair, gear=changed)
    return pair_geometry(other) if nodes is None else pair_geometry(other, nodes)


def surfaces(pair: GearPair, nodes: tuple[int, int] = (13, 9)) -> tuple[Flank, EaseOff]:
    t, h = grid(nodes)
    gear = pair.gear.flank(t, h)
    return gear, exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)


def contact_path(pair: GearPair, rotations: np.ndarray) -> PointContact:
    """Conventional point contact, rotations in degrees from the middle of the pinion."""
    return path_of_contact(*surfaces(pair, (13, 9)), np.radians(rotations))
