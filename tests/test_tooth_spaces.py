"""Lands, slots and fillets on generated teeth, beside what AGMA 929 says of them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from easeoff import GeometryError
from easeoff.cases import designed_blanks, gear_pair, read_case, read_design
from easeoff.geometry import GearPair
from easeoff.geometry.cutting.generating_surface import GeneratingSurface
from easeoff.geometry.design.agma929.measured_proportions import measured_proportions
from easeoff.geometry.design.agma929.tooth_proportions import ToothProportions
from easeoff.geometry.design.edge_radius import rounded
from easeoff.geometry.tooth import land_width
from easeoff.geometry.tooth.contact_height import contact_heights
from easeoff.geometry.tooth.land_width import land_widths
from easeoff.geometry.tooth.tooth_flanks import MemberName
from easeoff.geometry.tooth.tooth_surface import ToothSide, tooth_side, tooth_surface
from easeoff.study.design.tooth_spaces import ToothSpaces, tooth_spaces

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
        replace(each, loaded=rounded(each.loaded, 0.6), opposite=rounded(each.from_opposite.loaded, 0.6))
        for each in (pair.pinion, pair.gear)
    )
    pair = replace(pair, pinion=pinion, gear=gear)
    sharp = land_widths(pair, member, ENDS)

    def refused(surface: GeneratingSurface, *others: Any) -> ToothSide:
        if surface.blade.edge_radius == 0.0:
            raise GeometryError("undercut")
        return tooth_side(surface, *others)

    monkeypatch.setattr(land_width, "tooth_side", refused)
    found = land_widths(pair, member, ENDS)
    assert np.allclose(found.slot, sharp.slot, rtol=0.0, atol=0.1 * 0.6)
    assert np.allclose(found.root_line, sharp.root_line, rtol=0.0, atol=1e-4)
