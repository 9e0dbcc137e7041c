"""Top lands, slot widths and edge radii: AGMA 929's worked examples and identities, generated teeth, and backlash."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from iso23509_symbols import blank_design_from_symbols
from numpy.typing import NDArray
from pairs import circular_backlash
from places import DATA
from scipy.interpolate import RectBivariateSpline

from easeoff import GeometryError, InputError
from easeoff.cases import designed_blanks, gear_pair, read_case, read_design
from easeoff.geometry import BlankDesign, GearPair, Member, blank_dimensions
from easeoff.geometry.cutting.generating_surface import GeneratingSurface
from easeoff.geometry.design.slot_width import EdgeRadiusLimits, SlotWidths, ToothLine, TopLands
from easeoff.geometry.design.tooth_proportions import ToothProportions, measured_proportions
from easeoff.geometry.pair.gear_pair import thickness_per_angle, tooth_angles
from easeoff.geometry.pair.tooth_thickness import filling_thickness
from easeoff.geometry.tooth import tooth_surface as tooth_surface_module
from easeoff.geometry.tooth.tooth_flanks import MemberName, PlacedFlank, placed_flanks, side
from easeoff.geometry.tooth.tooth_surface import ToothSide, contact_heights, land_widths, tooth_side, tooth_surface
from easeoff.study.design.design_check import ToothSpaces, tooth_spaces

SAMPLES: dict[str, Any] = tomllib.loads((DATA / "agma929_samples.toml").read_text())
BLANKS: dict[str, Any] = tomllib.loads((DATA / "iso23509_samples.toml").read_text())
#: The printed inputs are rounded to 1e-5 mm, the angles to 1e-4 degrees, which is 2e-4 mm at a cone distance of 100 mm.
ROUNDING = 5e-5
ANGLES = ("zeta_mp", "nu", "beta_1", "beta_2")


def proportions(sample: str) -> ToothProportions:
    def value(key: str, given: Any) -> Any:
        if key.endswith("_angle"):
            return tuple(map(math.radians, given)) if isinstance(given, list) else math.radians(given)
        return tuple(given) if isinstance(given, list) else given

    return ToothProportions(**{key: value(key, given) for key, given in SAMPLES[sample]["input"].items()})


def by_symbol(p: ToothProportions) -> dict[str, Any]:
    line = ToothLine(p)
    slots = SlotWidths(line)
    lands, limits = TopLands(slots), EdgeRadiusLimits(slots)
    on_gear = line.on_gear(line.pinion_places)
    return {
        "zeta_mp": p.offset_angle,
        "nu": line.crown.cutter_lead_angle,
        "rho_P0": line.crown.centre_distance,
        "rho_b": line.crown.base_radius,
        "R_21": on_gear,
        "beta_1": line.pinion_spiral(on_gear),
        "beta_2": line.gear_spiral(line.gear_places),
        "R_x2": line.involute_distance,
        "p_n": p.pitch,
        "j_en": slots.backlash,
        "Delta_c": slots.clearance_change,
        "W_eff": slots.effective_width,
        "W_1": slots.width[0],
        "W_2": slots.width[1],
        "W_x": slots.at_involute,
        "W_min": slots.least,
        "W_max": slots.greatest,
        "W_B": slots.finishing_blade_point,
        "r_i": limits.inner_radius,
        "h_ai": limits.inner_dedendum[::-1] - p.clearance,
        "Delta_h_ai": limits.shift,
        "h_inf": limits.interference_height,
        "r_a01": limits.by_interference,
        "r_a02": limits.by_manufacture,
        "r_a03": limits.by_mutilation,
        "r_a0max": limits.largest,
        "r_npt1": lands.pinion_radius(line.pinion_places),
        "r_npt2": lands.gear_radius(line.gear_places),
        "h_a1": line.pinion_addendum(on_gear),
        "h_a2": line.gear_addendum(line.gear_places),
        "s_n1": lands.pinion_thickness(line.pinion_places),
        "s_n2": lands.gear_thickness(line.gear_places),
        "s_an1": lands.width[0],
        "s_an2": lands.width[1],
    }


@pytest.mark.parametrize("sample", SAMPLES)
def test_worked_examples_are_reproduced(sample: str) -> None:
    """Every printed value, to what the rounding of the printed inputs leaves open."""
    found = by_symbol(proportions(sample))
    for symbol, printed in SAMPLES[sample]["output"].items():
        value = np.degrees(found[symbol]) if symbol in ANGLES else found[symbol]
        tolerance = 3e-4 if symbol.startswith(("r_npt", "r_i", "R_")) else ROUNDING
        assert value == pytest.approx(np.array(printed), rel=0.0, abs=tolerance), symbol


def blanks(sample: str, **changes: Any) -> BlankDesign:
    return blank_design_from_symbols({**BLANKS[sample]["input"], **changes}, degrees=True)


def line_of(design: BlankDesign, *, generated_gear: bool = True) -> ToothLine:
    """The tooth of a blank; F2 is a bevel pair, F3 and F5 are hypoid, F5 hobbed."""
    groups = design.number_of_blade_groups or 0
    made = ToothProportions.of(blank_dimensions(design), design.cutter_radius, groups, generated_gear=generated_gear)
    return ToothLine(made)


@pytest.mark.parametrize("sample", ["F2", "F3", "F5"])
def test_places_of_both_members_are_those_of_the_blank(sample: str) -> None:
    """Cone distances, spiral angles and offset angle against ISO 23509, and there and back again."""
    dimensions, line = blank_dimensions(blanks(sample)), line_of(blanks(sample))
    pinion, on_gear = dimensions.pinion, line.on_gear(line.pinion_places)
    assert np.allclose(line.on_pinion(on_gear), line.pinion_places, rtol=0.0, atol=1e-10)
    assert line.proportions.offset_angle == pytest.approx(dimensions.offset_angle, abs=1e-12)
    spiral = [pinion.inner_spiral_angle, pinion.mean_spiral_angle, pinion.outer_spiral_angle]
    # The ends of the pinion of ISO 23509 follow from its face width in the pitch plane, here from that on its cone.
    assert np.allclose(line.pinion_spiral(on_gear), spiral, rtol=0.0, atol=1e-2)
    assert line.pinion_spiral(on_gear)[1] == pytest.approx(spiral[1], abs=1e-9)
    gear = dimensions.gear
    spiral = [gear.inner_spiral_angle, gear.mean_spiral_angle, gear.outer_spiral_angle]
    assert np.allclose(line.gear_spiral(line.gear_places), spiral, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("sample", ["F2", "F3", "F5"])
def test_tooth_line_is_an_involute_where_it_is_said_to_be(sample: str) -> None:
    """R cos(beta), the radius of the circle that the normal touches, has its greatest value there."""
    line = line_of(blanks(sample))
    place = line.involute_distance
    assert line.crown.generating_angle(place) == pytest.approx(line.crown.spiral_angle(place), abs=1e-12)
    near = place * (1.0 + 1e-4 * np.array([-1.0, 0.0, 1.0]))
    behind, here, ahead = line.narrowing(near)
    assert here > max(behind, ahead)
    assert abs(ahead - behind) < 1e-3 * (2.0 * here - behind - ahead)


@pytest.mark.parametrize("sample", ["F2", "F3", "F5"])
def test_teeth_slots_and_backlash_fill_the_pitch(sample: str) -> None:
    design = blanks(sample)
    line = line_of(design)
    slots = SlotWidths(line)
    p, lands = line.proportions, TopLands(slots)
    mean = line.gear_places[1]
    assert slots.gear_width(mean) == pytest.approx(
        p.pitch - p.mean_normal_thickness[1] - p.mean_dedendum[1] * p.taper, abs=1e-12
    )
    for place in line.gear_places:
        pitch = line.narrowing(place) * p.pitch
        bottom = line.gear_dedendum(place) * p.taper
        assert lands.gear_thickness(place) + slots.gear_width(place) + bottom == pytest.approx(pitch, abs=1e-9)
    assert lands.gear_thickness(mean) == pytest.approx(p.mean_normal_thickness[1], abs=1e-9)


def test_given_slot_width_comes_back() -> None:
    """Without backlash, half of which ISO 23509 takes off the gear's tooth besides."""
    given = {key: value for key, value in BLANKS["F2"]["input"].items() if key not in ("k_t", "j_en")}
    design = blank_design_from_symbols({**given, "W_m2": 2.25}, degrees=True)
    assert SlotWidths(line_of(design)).width[1, 1] == pytest.approx(2.25, abs=1e-9)


@pytest.mark.parametrize("sample", SAMPLES)
def test_edge_radius_at_its_limit_leaves_no_fillet_clearance(sample: str) -> None:
    limits = EdgeRadiusLimits(SlotWidths(ToothLine(proportions(sample))))
    left = limits.fillet_clearance(limits.by_interference.min(axis=1))
    assert np.allclose(left.min(axis=1), 0.0, atol=1e-12)
    assert np.all(limits.fillet_clearance(limits.largest) >= 0.0)
    assert limits.governing == ("manufacture", "manufacture")


def test_rough_and_finish_members_have_narrower_blades_and_limits_of_their_own() -> None:
    """A finishing blade may be as wide as the slot less the stock; half of the stock more clears the roughed fillet."""
    p = replace(proportions("C"), stock_allowance=(0.4, 0.4))
    slots = SlotWidths(ToothLine(p))
    assert np.allclose(slots.finishing_blade_point, slots.least - 0.4)
    assert np.allclose(slots.roughing_blade_point, (slots.least - 0.4) / 2.0 + 0.025)
    lean = 1.0 / math.cos(math.radians(20.0)) - math.tan(math.radians(20.0))
    roughed = (slots.roughing_blade_point - 0.2) / lean + 0.2 / lean
    assert np.allclose(EdgeRadiusLimits(slots).by_manufacture, roughed[:, None])


@pytest.mark.parametrize("name", ["fillet_mutilation", "blade_flat"])
def test_negative_allowances_are_refused(name: str) -> None:
    changed: dict[str, Any] = {name: -0.1}
    with pytest.raises(InputError, match=rf"{name} = -0.1: must be"):
        replace(proportions("C"), **changed)


# Lands, slots and fillets on generated teeth, beside what AGMA 929 says of them


ENDS = np.array([0.0, 0.5, 1.0])


@cache
def pair_of(name: str) -> GearPair:
    return gear_pair(read_case(name))


@cache
def spaces_of(name: str) -> ToothSpaces:
    pair = pair_of(name)
    return tooth_spaces(pair, gear_pair(read_case(name), "coast"), measured_proportions(pair))


def test_slot_of_a_spread_blade_is_as_wide_as_its_points_are_apart() -> None:
    """Formate, the blade tips of one cutter sweep two concentric circles in the plane of the slot's bottom."""
    pair = pair_of("fm-11x41")
    assert pair.gear.opposite is not None
    inside, outside = sorted((pair.gear.loaded.blade.point_radius, pair.gear.opposite.blade.point_radius))
    slot = land_widths(pair, "gear", ENDS).slot
    assert np.allclose(slot, outside - inside, rtol=0.0, atol=0.015)


@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_top_land_is_that_of_the_tooth_surface(member: str) -> None:
    """Its width along the circle, turned to the normal of the edge, which is measured on the surface itself."""
    pair = pair_of("nasa-12x36")
    edge = tooth_surface(pair, member, (41, 5)).top_land
    middle = edge[:, :, edge.shape[2] // 2]
    along = np.gradient(middle, axis=1, edge_order=2)[:, 20]
    across = edge[:, 20, -1] - edge[:, 20, 0]
    along = along / np.linalg.norm(along)
    normal = across - along * float(along @ across)
    found = land_widths(pair, member, np.array([0.5])).top_land[0]
    assert found == pytest.approx(float(np.linalg.norm(normal)), rel=5e-3)


def test_measured_proportions_are_those_of_the_blank() -> None:
    """Face-hobbed of uniform depth, whose flanks have the blank's angles; of a tapered pair at another mean point."""
    for name, groups, tolerance in (("fh-design-a", 13, 1e-6), ("fm-11x41", 0, 0.01)):
        design = read_design(name)
        teeth = design.pinion.number_of_teeth, design.gear.number_of_teeth
        blank = designed_blanks(design.blank_design, teeth, design.pair)
        radius = design.blank_design.cutter_radius
        wanted = ToothProportions.of(blank, radius, groups, generated_gear=False)
        found = measured_proportions(pair_of(name))
        for field in ("mean_cone_distance", "mean_addendum", "mean_dedendum", "pitch_angle", "cutter_radius"):
            assert np.allclose(getattr(found, field), getattr(wanted, field), rtol=tolerance), field
        for field in ("mean_normal_module", "clearance", "drive_pressure_angle", "coast_pressure_angle"):
            assert getattr(found, field) == pytest.approx(getattr(wanted, field), rel=tolerance), field
        assert found.mean_normal_thickness[1] == pytest.approx(wanted.mean_normal_thickness[1], rel=tolerance)
        assert found.offset_angle == pytest.approx(wanted.offset_angle, rel=tolerance)


def test_formulas_and_teeth_agree_on_a_published_pair() -> None:
    """The 12 x 36 pair by its published settings: gear slot to 0.02 mm, the rest to 0.2 mm of 1.2 to 3.3 mm."""
    spaces = spaces_of("nasa-12x36")
    for k, slot in ((0, 0.2), (1, 0.02)):
        measured = spaces.measured[k]
        assert np.abs(measured.slot - spaces.slots.width[k]).max() < slot
        assert np.abs(measured.top_land - spaces.lands.width[k]).max() < 0.15
        assert np.abs(measured.root_line).max() < 2e-3
    assert list(spaces.warnings()) == []


def test_contact_ends_deeper_where_the_addendum_of_the_mate_is_larger() -> None:
    """The path of a tip is as far from the root as the clearance at the pitch point, or further off it."""
    pair = pair_of("fh-design-a")
    heights, along = contact_heights(pair, ENDS)
    assert heights.shape == along.shape == (2, 3)
    assert np.nanmin(heights) > pair.gear.section.clearance


@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_slot_of_blades_whose_corner_cuts_no_whole_flank_is_that_of_their_edge_radii(
    member: MemberName, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To a tenth of the edge radius; on an upright machine the tip plane holds corner and deepest point alike."""
    pair = gear_pair(read_case("nasa-12x36"))
    pinion, gear = (
        replace(each, loaded=each.loaded.rounded(0.6), opposite=each.from_opposite.loaded.rounded(0.6))
        for each in (pair.pinion, pair.gear)
    )
    pair = replace(pair, pinion=pinion, gear=gear)
    sharp = land_widths(pair, member, ENDS)

    def refused(surface: GeneratingSurface, *others: Any) -> ToothSide:
        if surface.blade.edge_radius == 0.0:
            raise GeometryError("undercut")
        return tooth_side(surface, *others)

    monkeypatch.setattr(tooth_surface_module, "tooth_side", refused)
    found = land_widths(pair, member, ENDS)
    assert np.allclose(found.slot, sharp.slot, rtol=0.0, atol=0.1 * 0.6)
    assert np.allclose(found.root_line, sharp.root_line, rtol=0.0, atol=1e-4)


# Backlash: dense points of the pinion's tooth, turned through the gear's slot, touch both of its flanks


Array = NDArray[Any]
BACKLASH_NODES = (41, 27)
#: On both flanks in one position.
LEAST_POINTS = 100


def both_sides(member: Member, angle: float) -> list[PlacedFlank]:
    """The loaded flank and the other one of a tooth."""
    placed = placed_flanks(member, angle)
    loaded = placed.pop(side(member.loaded))
    return [loaded, *placed.values()]


def points(member: Member, flank: PlacedFlank) -> Array:
    """Points (3, nt, nh) of a flank; NaN where it is undercut."""
    t, h = (np.linspace(0.0, 1.0, n) for n in BACKLASH_NODES)
    axial, radial = member.section.points(*(each.ravel() for each in np.meshgrid(t, h, indexing="ij")))
    return flank.at(axial, radial).position.reshape(3, *BACKLASH_NODES)


def measured_backlash(pair: GearPair, turns: Array) -> float:
    """Normal circular backlash at the gear [mm], by pinion points in single positions of the pinion."""
    assembly, pitch = pair.assembly, 2.0 * np.pi / pair.gear.teeth
    angles = tooth_angles(pair)
    teeth, slots = (both_sides(m, a) for m, a in zip((pair.pinion, pair.gear), angles, strict=True))
    gaps = []
    for tooth, slot in zip(teeth, slots, strict=True):
        wall = points(pair.gear, slot)
        azimuth = np.unwrap(np.unwrap(np.arctan2(wall[1], wall[0]), axis=0), axis=1)
        spline = RectBivariateSpline(
            np.linspace(0.0, 1.0, BACKLASH_NODES[0]), np.linspace(0.0, 1.0, BACKLASH_NODES[1]), azimuth
        )
        middle = slot.at(*pair.gear.section.points(np.array([0.5]), np.array([0.5])))
        out = np.sign(middle.position[0] * middle.normal[1] - middle.position[1] * middle.normal[0])
        own = points(pair.pinion, tooth).reshape(3, -1)
        own = own[:, np.all(np.isfinite(own), axis=0)]
        nearest = []
        for turn in turns:
            c, s = np.cos(turn), np.sin(turn)
            turned = np.stack([c * own[0] - s * own[1], s * own[0] + c * own[1], own[2]])
            seen = assembly.pinion_frame @ turned + (assembly.pinion_origin - assembly.gear_origin)[:, None]
            t, h = pair.gear.section.fractions(seen[2], np.hypot(seen[0], seen[1]))
            on = (t >= 0.0) & (t <= 1.0) & (h >= 0.0) & (h <= 1.0)
            if np.count_nonzero(on) < LEAST_POINTS:
                continue
            apart = np.arctan2(seen[1], seen[0])[on] - spline(t[on], h[on], grid=False) + turn / assembly.ratio
            nearest.append(np.min(out * (np.mod(apart - apart[0] + np.pi, 2.0 * np.pi) - np.pi + apart[0])))
        gaps.append(min(np.mod(each - nearest[0] + pitch / 2.0, pitch) + nearest[0] for each in nearest))
    both = np.mod(sum(gaps) + pitch / 2.0, pitch) - pitch / 2.0
    return float(both) * thickness_per_angle(pair.gear)


@pytest.mark.parametrize(("name", "thinner"), [("fm-11x41", 0.3), ("nasa-12x36", 0.1), ("fh-design-a", 0.0)])
def test_backlash_is_that_of_points_in_the_slot(name: str, thinner: float) -> None:
    """Within what edges, and positions 0.025 rad apart, differ from the smooth least ease-off."""
    pair = gear_pair(read_case(name))
    pair = replace(pair, pinion=replace(pair.pinion, mean_thickness=filling_thickness(pair) - thinner))
    found = circular_backlash(pair)
    assert found == pytest.approx(measured_backlash(pair, np.linspace(-1.2, 1.2, 97)), abs=0.006)
    shares = thickness_per_angle(pair.gear) / thickness_per_angle(pair.pinion) / pair.assembly.ratio
    assert found == pytest.approx(thinner * shares, abs=1e-9)


def test_backlash_is_the_same_from_both_sides() -> None:
    pair = gear_pair(read_case("nasa-12x36"))
    other = gear_pair(read_case("nasa-12x36"), "coast")
    angles = [circular_backlash(each) / thickness_per_angle(each.gear) for each in (pair, other)]
    assert angles[0] == pytest.approx(angles[1], abs=1e-9)
