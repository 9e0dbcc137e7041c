"""Basic settings of a Formate gear: the generated flanks have the angles, the slot and the depth of the blank."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from pairs import MILLED

from easeoff import GeometryError
from easeoff.geometry import (
    BlankDesign,
    BlankDimensions,
    GeneratingSurface,
    Hand,
    Member,
    blank_dimensions,
    blank_section,
    formate_gear,
)
from easeoff.geometry.design.basic_settings import generated_gear, hobbing_blade
from easeoff.geometry.design.blank import mean_point_angles
from easeoff.geometry.flanks.flank import solve_flank
from easeoff.geometry.pair.gear_pair import left_by_cutter
from easeoff.geometry.pair.tooth_body import tooth_body
from easeoff.geometry.vectors import rotate_z

HOBBED = replace(
    MILLED,
    method=3,
    process="face_hobbed",
    number_of_teeth=(12, 41),
    hypoid_offset=45.0,
    mean_spiral_angle=math.radians(24.0),
    gear_outer_pitch_diameter=230.0,
    gear_face_width=35.0,
    cutter_radius=88.0,
    number_of_blade_groups=13,
    depth_taper="uniform",
)
BEVEL = replace(HOBBED, method=0, hypoid_offset=0.0, mean_spiral_angle=math.radians(35.0))
DESIGNS = {"milled": MILLED, "hobbed": HOBBED, "hobbed bevel": BEVEL}


@cache
def gear(
    design: BlankDesign, hand: Hand = "right", *, corrected: bool = True
) -> tuple[BlankDimensions, GeneratingSurface, GeneratingSurface]:
    blank = blank_dimensions(design)
    flanks = formate_gear(blank, design.cutter_radius, hand, design.number_of_blade_groups or 0, corrected=corrected)
    return blank, *flanks


def direct_angles(surface: GeneratingSurface, blank: BlankDimensions) -> tuple[float, float]:
    """Spiral and pressure angle by differences of surface points alone: no normal, no projection formula."""
    member = blank.gear
    sine, cosine = math.sin(member.pitch_angle), math.cos(member.pitch_angle)

    def at(cone_distance: float, lift: float) -> np.ndarray:
        axial = cone_distance * cosine - member.pitch_apex - lift * sine
        radial = cone_distance * sine + lift * cosine
        section = blank_section(member, blank.clearance)
        position = solve_flank(surface, section, np.array([axial]), np.array([radial])).position[:, 0]
        return np.array([axial, radial, math.atan2(position[1], position[0])])

    h, distance = 1e-3, member.mean_cone_distance
    radius = distance * sine
    along = (at(distance + h, 0.0) - at(distance - h, 0.0))[2] / (2 * h) * radius
    up = (at(distance, h) - at(distance, -h))[2] / (2 * h) * radius
    # Circumferential advance per length of the cone element is the tangent of the spiral angle; advance per height,
    # seen in the normal section, that of the pressure angle.
    return math.atan(along), math.atan(up * math.cos(math.atan(along)))


@pytest.mark.parametrize("hand", ["left", "right"])
@pytest.mark.parametrize("name", ["hobbed", "hobbed bevel"])
def test_hobbed_flanks_have_the_spiral_and_pressure_angles_of_the_blank(name: str, hand: Hand) -> None:
    blank, convex, concave = gear(DESIGNS[name], hand)
    section = blank_section(blank.gear, blank.clearance)
    for flank, angle in (
        (convex, blank.generated_drive_pressure_angle),
        (concave, blank.generated_coast_pressure_angle),
    ):
        found = mean_point_angles(flank, section, blank.gear)
        assert found.spiral_angle == pytest.approx(blank.gear.mean_spiral_angle, abs=1e-9)
        assert found.pressure_angle == pytest.approx(angle, abs=1e-9)


@pytest.mark.parametrize("hand", ["left", "right"])
@pytest.mark.parametrize("name", ["hobbed", "hobbed bevel"])
def test_generated_hobbed_flanks_have_them_in_closed_form(name: str, hand: Hand) -> None:
    """The pitch cone rolls on the cradle's plane: at the mean point rolling changes nothing."""
    design = DESIGNS[name]
    blank = blank_dimensions(design)
    groups = design.number_of_blade_groups or 0
    for flank, angle in zip(
        generated_gear(blank, design.cutter_radius, hand, groups, corrected=False),
        (blank.generated_drive_pressure_angle, blank.generated_coast_pressure_angle),
        strict=True,
    ):
        assert flank.settings.generated
        found = mean_point_angles(flank, blank_section(blank.gear, blank.clearance), blank.gear)
        assert found.spiral_angle == pytest.approx(blank.gear.mean_spiral_angle, abs=1e-9)
        assert found.pressure_angle == pytest.approx(angle, abs=1e-9)


def test_generated_milled_flanks_are_corrected_to_the_blank() -> None:
    blank = blank_dimensions(MILLED)
    flanks = generated_gear(blank, MILLED.cutter_radius, "right")
    found = [mean_point_angles(flank, blank_section(blank.gear, blank.clearance), blank.gear) for flank in flanks]
    assert found[0].pressure_angle == pytest.approx(blank.generated_drive_pressure_angle, abs=1e-9)
    assert found[1].pressure_angle == pytest.approx(blank.generated_coast_pressure_angle, abs=1e-9)
    assert (found[0].spiral_angle + found[1].spiral_angle) / 2 == pytest.approx(blank.gear.mean_spiral_angle, abs=1e-9)


@pytest.mark.parametrize("name", DESIGNS)
def test_measured_angles_agree_with_differences_of_points(name: str) -> None:
    blank, *flanks = gear(DESIGNS[name])
    for flank, sign in zip(flanks, (1.0, -1.0), strict=True):
        found = mean_point_angles(flank, blank_section(blank.gear, blank.clearance), blank.gear)
        spiral, pressure = direct_angles(flank, blank)
        assert found.spiral_angle == pytest.approx(spiral, abs=1e-7)
        assert found.pressure_angle == pytest.approx(sign * pressure, abs=1e-7)


def test_crown_gear_is_that_of_the_standard() -> None:
    """The cutter centre stands at rho_P0 from the apex of the crown gear, and the closed form needs no correction."""
    blank, *flanks = gear(HOBBED)
    _, *plain = gear(HOBBED, corrected=False)
    machine = flanks[0].settings
    # The crown gear's apex is the pitch apex; uniform depth lets the root line run parallel to the pitch line.
    apart = (blank.gear.root_apex - blank.gear.pitch_apex) * math.cos(blank.gear.root_angle)
    horizontal = machine.radial_distance * math.cos(machine.cradle_angle) - apart
    vertical = machine.radial_distance * math.sin(machine.cradle_angle)
    assert math.hypot(horizontal, vertical) == pytest.approx(blank.crown_centre_distance, abs=1e-9)
    assert machine.indexing_ratio == pytest.approx(13 / 41)
    for one, two in zip(flanks, plain, strict=True):
        assert one.blade.point_radius == pytest.approx(two.blade.point_radius, abs=1e-8)
        assert one.blade.pressure_angle == pytest.approx(two.blade.pressure_angle, abs=1e-10)


def test_hobbing_path_has_the_curvature_of_the_extended_epicycloid() -> None:
    """The trace on the crown gear plane, by differences, against formula 40 of the standard."""
    blank = blank_dimensions(BEVEL)
    _, convex, _ = gear(BEVEL)
    machine, teeth = convex.settings, BEVEL.number_of_teeth[1] / math.sin(blank.gear.pitch_angle)
    centre, radius = blank.crown_centre_distance, BEVEL.cutter_radius
    course = blank.gear.mean_spiral_angle - blank.cutter_lead_angle
    distance = blank.gear.mean_cone_distance
    start = math.atan2(-radius * math.cos(course), radius * math.sin(course))
    start_centre = np.array([distance - radius * math.sin(course), radius * math.cos(course), 0.0])
    assert np.hypot(*start_centre[:2]) == pytest.approx(centre)

    def point(turn: float) -> np.ndarray:
        blade = start_centre + radius * np.array([math.cos(start + turn), math.sin(start + turn), 0.0])
        # As the crown gear sees it, which turns against the cutter by blade groups over teeth.
        return np.asarray(rotate_z(np.array([turn * 13 / teeth]), blade[:, None])[:, 0])

    h = 1e-3
    first = (point(h) - point(-h)) / (2 * h)
    second = (point(h) - 2 * point(0.0) + point(-h)) / h**2
    curvature = abs(first[0] * second[1] - first[1] * second[0]) / np.linalg.norm(first) ** 3
    assert 1.0 / curvature == pytest.approx(blank.tooth_line_radius_of_curvature, rel=1e-5)
    assert machine.indexing_ratio * BEVEL.number_of_teeth[1] == pytest.approx(13)


def test_milled_slot_has_the_angles_and_the_width_of_the_blank() -> None:
    blank, convex, concave = gear(MILLED)
    section = blank_section(blank.gear, blank.clearance)
    angles = [mean_point_angles(flank, section, blank.gear) for flank in (convex, concave)]
    spiral = blank.gear.mean_spiral_angle
    assert (angles[0].spiral_angle + angles[1].spiral_angle) / 2 == pytest.approx(spiral, abs=1e-9)
    assert angles[0].pressure_angle == pytest.approx(blank.generated_drive_pressure_angle, abs=1e-9)
    assert angles[1].pressure_angle == pytest.approx(blank.generated_coast_pressure_angle, abs=1e-9)
    assert convex.settings == concave.settings
    slot = (angles[0].azimuth - angles[1].azimuth) * blank.gear.mean_pitch_diameter / 2 * math.cos(spiral)
    pitch = math.pi * blank.mean_normal_module
    assert pitch - slot == pytest.approx(blank.gear.mean_normal_thickness, abs=1e-9)


def test_closed_form_of_the_milled_gear_misses_the_pressure_angles_by_the_dedendum_angle() -> None:
    """Tilting the cutter with the root line turns the normals about it by about dedendum angle x sin(spiral angle)."""
    blank, *flanks = gear(MILLED, corrected=False)
    section = blank_section(blank.gear, blank.clearance)
    turned = blank.gear.dedendum_angle * math.sin(blank.gear.mean_spiral_angle)
    wanted = (blank.generated_drive_pressure_angle, blank.generated_coast_pressure_angle)
    found = [mean_point_angles(flank, section, blank.gear).pressure_angle for flank in flanks]
    missed = ((wanted[0] - found[0]) - (wanted[1] - found[1])) / 2
    assert missed == pytest.approx(turned, rel=0.1)


def test_tooth_between_the_milled_flanks_has_the_thickness_of_the_blank() -> None:
    """The tooth body interpolates over the flank; at pitch height it comes near the blank's circular thickness."""
    blank, convex, concave = gear(MILLED)
    section = blank_section(blank.gear, blank.clearance)
    body = tooth_body(section, convex, concave, left_by_cutter(Member(41, section, convex, concave)))
    mean = body.thickness.mean(axis=0)
    up = blank.gear.mean_dedendum / body.height.mean()
    assert mean[0] * (1 - up) + mean[1] * up == pytest.approx(blank.gear.mean_normal_thickness, abs=0.15)


def test_edge_of_the_hobbing_blade_passes_its_reference_point() -> None:
    blade = hobbing_blade(88.0, 0.3, "outside", 6.0, 0.25)
    (tip_r, tip_t), (edge_r, edge_t, edge_z) = blade.tip, blade.edge
    along = -6.0 / edge_z
    assert math.hypot(tip_r + along * edge_r, tip_t + along * edge_t) == pytest.approx(88.0)
    assert edge_z == pytest.approx(-math.cos(0.3))
    assert 86.0 < blade.point_radius < 88.0
    assert blade.rake_angle == pytest.approx(0.255, abs=5e-4)


def test_a_slot_too_narrow_for_a_cutter_is_refused() -> None:
    with pytest.raises(GeometryError, match="point width"):
        gear(replace(MILLED, thickness_factor=-1.9))


def test_too_many_blade_groups_are_refused() -> None:
    blank = blank_dimensions(HOBBED)
    with pytest.raises(GeometryError, match="number_of_blade_groups = 90"):
        formate_gear(blank, 88.0, "right", 90)
