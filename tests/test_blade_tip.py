"""Blade tips against a search over the whole sweep, and the flanks that the mate's tip finds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from extreme_designs import Extreme
from numpy.typing import NDArray

from easeoff.cases import gear_pair, parse_design, read_case
from easeoff.geometry.cutting.generating_surface import GeneratingSurface
from easeoff.geometry.flanks.blank_section import BlankSection
from easeoff.geometry.flanks.seed_lattice import mean_parameters
from easeoff.geometry.pair.gear_pair import GearPair
from easeoff.geometry.pair.tip_mates import unmet_tips
from easeoff.geometry.tooth.blade_tip import TOE_MIDDLE_HEEL, tip_gap
from easeoff.study import design_case

Array = NDArray[Any]


def deepest_of_the_sweep(surface: GeneratingSurface, section: BlankSection) -> Array:
    """Least height of the blade's tip above the root cone next to toe, middle and heel (3) [mm]."""
    cutter, cradle = mean_parameters(surface, section)
    angles = np.meshgrid(cutter + np.linspace(-0.7, 0.7, 281), cradle + np.linspace(-0.9, 0.9, 361), indexing="ij")
    edge = surface.on("edge")
    points, _, _ = edge.at_coordinate(np.stack([a.ravel() for a in angles]), -1.0)
    radial = np.hypot(points[0], points[1])
    lengthwise, _ = section.fractions(points[2], radial)
    height = section.height_above_root(points[2], radial)
    return np.array([height[np.abs(lengthwise - t) < 0.03].min() for t in TOE_MIDDLE_HEEL])


@pytest.mark.parametrize(("name", "side"), [("fm-11x41", "drive"), ("fm-11x41", "coast"), ("nasa-12x36", "drive")])
def test_tip_gap_is_the_deepest_point_of_the_sweep(name: str, side: Any) -> None:
    pinion = gear_pair(read_case(name), side).pinion
    swept = deepest_of_the_sweep(pinion.loaded, pinion.section)
    assert tip_gap(pinion.loaded, pinion.section) == pytest.approx(swept, abs=0.02)


def with_edge_radius(pair: GearPair, radius: float) -> GearPair:
    pinion = pair.pinion
    blade = replace(pinion.loaded.blade, edge_radius=radius)
    return replace(pair, pinion=replace(pinion, loaded=replace(pinion.loaded, blade=blade)))


def test_a_fillet_that_grows_takes_the_flank_from_the_mates_tip() -> None:
    """The pinion's tip still meets the whole gear, whose blade is as it was."""
    pair = gear_pair(read_case("fm-11x41"))
    shares = [unmet_tips(with_edge_radius(pair, radius)) for radius in (0.3, 2.0, 4.0)]
    of_pinion, of_gear = zip(*shares, strict=True)
    assert of_pinion == (0.0, 0.0, 0.0)
    assert of_gear[0] == 0.0 <= of_gear[1] <= of_gear[2] == 1.0


@pytest.mark.thorough
@pytest.mark.parametrize("spiral", [0.0, 35.0])
def test_pair_of_equal_teeth_has_whole_teeth_and_blade_tips_on_the_root(spiral: float) -> None:
    """Generated flanks of few teeth end far above the root cone, where the mate's tip hardly comes: at one end at most.

    The shares do not depend on the last digits of linear algebra: the fit ends where passes change nothing.
    """
    extreme = Extreme((20, 20), module=6.0, spiral=spiral, generated=True, addendum=0.5, thickness=0.0, face=0.236)
    case, report = design_case(parse_design(extreme.text("closest_fit")))
    assert report.analysable
    for side in ("drive", "coast"):
        pair = gear_pair(case, side)
        at_one_end = 0.15 if spiral == 0.0 and side == "coast" else 0.0
        assert max(unmet_tips(pair)) <= at_one_end
        told = any(warning.startswith(side) and "undercut" in warning for warning in report.warnings)
        assert told == (max(unmet_tips(pair)) > 0.0)
        assert np.abs(tip_gap(pair.pinion.loaded, pair.pinion.section)).max() < 0.05
        assert report.sides[side].root_gap == pytest.approx(tip_gap(pair.pinion.loaded, pair.pinion.section), abs=1e-6)


@pytest.mark.thorough
def test_an_undercut_pinion_is_told_by_the_mates_tip() -> None:
    """A gear of 45 degrees without generation wants a pinion that no cutter leaves a root."""
    extreme = Extreme((20, 20), module=6.0, addendum=0.5, thickness=0.0, face=0.236)
    _, report = design_case(parse_design(extreme.text("closest_fit")))
    assert any("the gear's tip meets no flank" in warning for warning in report.warnings)
    assert any('generation = "generated"' in warning for warning in report.warnings)
