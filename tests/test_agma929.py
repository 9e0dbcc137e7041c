"""Top lands, slot widths and edge radii by AGMA 929: its worked examples, and identities of its formulas."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from easeoff import InputError
from easeoff.geometry import BlankDesign, blank_design_from_symbols, blank_dimensions
from easeoff.geometry.design.agma929.edge_radius_limit import EdgeRadiusLimits
from easeoff.geometry.design.agma929.slot_width import SlotWidths
from easeoff.geometry.design.agma929.tooth_line import ToothLine
from easeoff.geometry.design.agma929.tooth_proportions import ToothProportions
from easeoff.geometry.design.agma929.top_land import TopLands

DATA = Path(__file__).parent / "data"
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
