"""Designs at the edges of what is cut, by every method: a case whose flanks meet, or a message that says what to do."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import get_args

import numpy as np
import pytest
from extreme_designs import EXTREMES, Extreme

from easeoff import GeometryError, InputError, analyze
from easeoff.cases import case_toml, ease_off_target, gear_pair, parse_case, parse_design
from easeoff.cases.conversion import blank_design
from easeoff.geometry import blank_dimensions, exact_ease_off
from easeoff.geometry.design.fit_quality import residual_limits
from easeoff.geometry.design.set_up.pinion_method import PinionMethod
from easeoff.geometry.pair.gear_pair import grid
from easeoff.study import design_case

METHODS = get_args(PinionMethod)
#: What a refusal may advise: another method, limits, a generated gear, or other blanks.
ADVICE = ("method = ", "[pinion.limits]", "generation = ", "cutter_radius", "more teeth", "free_settings")


@pytest.mark.thorough
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", EXTREMES)
def test_extreme_design_is_cut_or_refused_with_advice(name: str, method: str) -> None:
    """A case is read back as it is, keeps the report's residual on another grid, and is within what may be used."""
    refusal = ""
    try:
        case, report = design_case(parse_design(EXTREMES[name].text(method)))
    except GeometryError as error:
        refusal = str(error)
    if refusal:
        assert any(word in refusal for word in ADVICE), refusal
        return
    assert parse_case(case_toml(case)).model_dump() == case.model_dump()
    for side, item in report.sides.items():
        target = ease_off_target(getattr(case.target, side))
        _, usable = residual_limits(target)
        assert item.largest_residual <= usable
        pair = gear_pair(case, side)
        t, h = grid((13, 9))
        found = exact_ease_off(pair.gear.flank(t, h), pair.pinion.loaded, pair.pinion.section, pair.assembly)
        known, lever = found.inside, found.lever_arm[found.inside]
        wanted = target(*(f.ravel() for f in np.meshgrid(t, h, indexing="ij")))[known]
        left = found.angle[known] * lever - wanted
        left = left - lever * float(lever @ left) / float(lever @ lever)
        # Closest fits of a Formate gear state the residual at the nodes of the fit; it grows towards undercut flanks.
        factor = 2.0 if max(item.uncut) > 0.0 else 1.5
        assert np.abs(left).max() < factor * item.largest_residual + 2e-3


@pytest.mark.thorough
def test_what_a_design_says_can_be_analysed_is_analysed() -> None:
    """The usual edge radius of this pinion suits its tooth but not the body of all teeth: a smaller one is taken."""
    extreme = Extreme((13, 44), shaft=100.0, spiral=32.0, addendum=0.22, taper="modified_slot_width")
    case, report = design_case(parse_design(extreme.text("fixed_setting")))
    assert report.analysable
    coarse = {"mesh_positions": 2, "segments_per_line": 9, "lengthwise_nodes": 17, "profile_nodes": 11}
    case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    assert np.all(np.isfinite(analyze(case, torques=[100.0])["loaded"]["transmission_error"]))


@pytest.mark.thorough
def test_a_refusal_names_another_method_than_the_one_that_was_tried() -> None:
    extreme = Extreme((16, 37), module=0.5, generated=True, taper="uniform", cutter=0.6)
    with pytest.raises(GeometryError, match=r"of the method tilt was found") as refused:
        design_case(parse_design(extreme.text("tilt")))
    advice = str(refused.value)
    assert 'method = "modified_roll"' in advice
    assert 'method = "tilt"' not in advice
    assert advice.count("another method") == 1


@pytest.mark.parametrize(("teeth", "greatest"), [((12, 45), 105.4), ((17, 51), 109.4), ((23, 49), 117.9)])
def test_the_greatest_shaft_angle_is_told_and_works(teeth: tuple[int, int], greatest: float) -> None:
    """Where the gear would be a crown gear or have internal teeth."""
    with pytest.raises(InputError, match=rf"shaft_angle = 120 deg.*does not below {greatest} deg"):
        design_case(parse_design(Extreme(teeth, shaft=120.0).text("tilt")))
    basic_data = Extreme(teeth, shaft=greatest).text("tilt")
    design = parse_design(basic_data)
    blank = blank_dimensions(blank_design(design.blank_design, teeth, design.pair))
    assert math.degrees(blank.gear.pitch_angle) < 90.0


@pytest.mark.thorough
def test_a_pointed_pinion_is_mended_as_its_warning_says() -> None:
    pointed = Extreme((4, 40), groups=11, generated=True, spiral=38.0, addendum=0.1, thickness=0.2)
    _, report = design_case(parse_design(pointed.text("completing")))
    assert any("pointed" in w and "larger gear_mean_addendum_factor or thickness_factor" in w for w in report.warnings)
    _, mended = design_case(parse_design(replace(pointed, addendum=0.25, thickness=0.3).text("completing")))
    assert not report.analysable
    assert mended.analysable
