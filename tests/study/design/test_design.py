"""From a design to a case: shipped cases follow from their designs, and mistakes in a design are told plainly."""

from __future__ import annotations

import importlib
import math
import re
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from extreme_designs import EXTREMES, Extreme
from pairs import by_the_dissertation, circular_backlash
from places import DOCS
from runs import output_of, refusal_of, replaced

import easeoff
from easeoff import EaseoffError, GeometryError, InputError, analyze
from easeoff.cases import (
    Case,
    Design,
    case_toml,
    design_text,
    designed_blanks,
    gear_pair,
    parse_case,
    parse_design,
    read_case,
    read_design,
    shipped_cases,
    shipped_designs,
)
from easeoff.cases.conversion import blank_design, ease_off_target
from easeoff.geometry import BlankDimensions, FlankName, blank_dimensions, ease_off
from easeoff.geometry.design.blank import mean_point_angles
from easeoff.geometry.design.closest_fit import residual_limits
from easeoff.geometry.design.pinion_method import PinionMethod
from easeoff.geometry.flanks.flank import NodeStatus
from easeoff.geometry.pair.ease_off import exact_ease_off
from easeoff.geometry.pair.gear_pair import bodies, grid
from easeoff.study import DesignReport, design_case, rounded_case, rounding_effect
from easeoff.study.analysis.key_numbers import key_numbers
from easeoff.study.design import case_design
from easeoff.study.design.design_check import unfinished_teeth
from easeoff.study.summary.plausibility import edge_notes
from easeoff.study.summary.settings_report import unit_of

NAMES = list(shipped_designs())
WITH_CASE = [name for name in NAMES if name in shipped_cases()]
FM = design_text("fm-11x41")


def on_shells(design: Design) -> Design:
    """The design for teeth as shells, whose check is a short one."""
    return design.model_copy(update={"compliance": design.compliance.model_copy(update={"model": "shell"})})


@cache
def made(name: str) -> tuple[Case, DesignReport]:
    return design_case(on_shells(read_design(name)))


def blanks(name: str) -> BlankDimensions:
    design = read_design(name)
    teeth = design.pinion.number_of_teeth, design.gear.number_of_teeth
    return designed_blanks(design.blank_design, teeth, design.pair)


def numbers(table: dict[str, Any], place: str = "") -> dict[str, Any]:
    """Every value of a case under its dotted name."""
    found: dict[str, Any] = {}
    for key, value in table.items():
        name = f"{place}.{key}" if place else key
        if isinstance(value, dict):
            found |= numbers(value, name)
        else:
            found[name] = value
    return found


@pytest.mark.parametrize("name", WITH_CASE)
@pytest.mark.quick(1)
def test_shipped_case_follows_from_its_design(name: str) -> None:
    """Blank and gear to rounding; the pinion's settings as far as a least-squares fit stops at one point.

    Shipped cases were made before designs gave the pinion's thickness.
    """
    stored = numbers(
        read_case(name).model_dump() | {"compliance": on_shells(read_design(name)).compliance.model_dump()}
    )
    again = numbers(made(name)[0].model_dump())
    assert stored.keys() == again.keys()
    thickness = "pinion.mean_normal_circular_thickness"
    assert again.pop(thickness) is not None
    assert stored[thickness] is None
    for key, value in again.items():
        if isinstance(value, float):
            near = (3e-4, 1e-4) if key.startswith("pinion.con") else (1e-9, 1e-9)  # the valley of the fit is flat
            assert stored[key] == pytest.approx(value, rel=near[0], abs=near[1]), key
        else:
            assert stored[key] == value, key


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.quick(1)
def test_case_file_reads_back_as_the_same_case(name: str) -> None:
    case, _ = made(name)
    assert parse_case(case_toml(case)).model_dump() == case.model_dump()


@pytest.mark.parametrize("side", ["drive", "coast"])
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.quick(1)
def test_ease_off_of_the_case_is_the_target_as_reported(name: str, side: Any) -> None:
    """The case, read back and computed on another grid than the fit's."""
    case, report = made(name)
    found = ease_off(gear_pair(case, side), (13, 9))
    t, h = np.meshgrid(found["lengthwise"], found["profile"], indexing="ij")
    target = ease_off_target(getattr(case.target, side))
    known = found["inside"].values == 1
    left = (1e-3 * found["ease_off"].values - target(t, h))[known]
    lever = found["lever_arm"].values[known]
    left = left - lever * (lever @ left) / (lever @ lever)
    assert np.abs(left).max() < 1.3 * report.sides[side].largest_residual + 2e-4
    assert np.sqrt(np.mean(left**2)) == pytest.approx(report.sides[side].rms_residual, rel=0.3)


@pytest.mark.thorough
def test_report_warns_of_what_is_doubtful() -> None:
    """The shipped designs are sound; tips off the root cone are told, a fit without freedom is refused."""
    for name in NAMES:
        case, report = made(name)
        assert report.warnings == ()
        assert list(unfinished_teeth(gear_pair(case), "solid_shell")) == []
    straying = design_case(parse_design(replaced(FM, r"^follow_root = true$", "follow_root = false")))[1].warnings
    assert any("mm from its root cone" in warning and "follow_root" in warning for warning in straying)
    poor = replaced(FM, r'^hand_of_spiral = "left"$', 'hand_of_spiral = "left"\nfree_settings = ["point_radius"]')
    poor = replaced(poor, r"^number_of_teeth = 41$", 'number_of_teeth = 41\ngeneration = "formate"')
    with pytest.raises(EaseoffError, match=r"misses it by up to .* free other settings"):
        design_case(parse_design(poor))


@pytest.mark.thorough
def test_report_warns_of_narrow_top_lands() -> None:
    thin = replaced(FM, r"^thickness_factor = .*$", "thickness_factor = 0.75")
    warnings = design_case(parse_design(thin))[1].warnings
    assert any("gear's tooth has a narrow top land" in warning for warning in warnings), warnings


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("radial_distance", "mm"),
        ("point_radius", "mm"),
        ("cutter_tilt", "deg"),
        ("pressure_angle", "deg"),
        ("ratio_of_roll", ""),
        ("modified_roll_2c", ""),
        ("blade_curvature", "1/mm"),
        ("sliding_base_motion_1", "mm/rad^1"),
        ("cutter_tilt_motion_2", "deg/rad^2"),
    ],
)
def test_report_gives_every_setting_its_unit(name: str, unit: str) -> None:
    assert unit_of(name) == unit


def mean_thickness(case: Case, report: DesignReport, number: int) -> float:
    """Normal circular thickness at the mean point [mm], from the azimuths of the two flanks of the tooth body."""
    pair = gear_pair(case)
    blank, member = ((report.blank.pinion, pair.pinion), (report.blank.gear, pair.gear))[number]
    radius = blank.mean_pitch_diameter / 2.0
    t, h = member.section.fractions(
        np.array(blank.mean_cone_distance * math.cos(blank.pitch_angle) - blank.pitch_apex), np.array(radius)
    )
    half = np.polynomial.legendre.legval2d(2 * t - 1, 2 * h - 1, bodies(pair)[number].half_angle)
    opposite = member.opposite
    assert opposite is not None
    angles = [mean_point_angles(flank, member.section, blank) for flank in (member.loaded, opposite)]
    spiral = (angles[0].spiral_angle + angles[1].spiral_angle) / 2.0
    return 2.0 * float(half) * radius * math.cos(spiral)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.quick(1)
def test_gear_tooth_has_the_thickness_of_the_blank(name: str) -> None:
    """At the mean point, from the azimuths of the two flanks of the tooth body."""
    case, report = made(name)
    gear, thickness = report.blank.gear, mean_thickness(case, report, 1)
    design = read_design(name)
    along_root = design.gear.basic_settings == "root_line"
    # Point width and blade angles are multiples of their standard steps.
    steps = design.cutter_steps
    by_angles = 2.0 * math.tan(math.radians(0.5 * steps.blade_angle)) * gear.mean_dedendum
    tolerance = 0.1 if along_root else max(1e-3, steps.point_width + by_angles)
    assert thickness == pytest.approx(gear.mean_normal_thickness, abs=tolerance)
    if case.gear.mean_normal_circular_thickness is not None:
        assert case.gear.mean_normal_circular_thickness == pytest.approx(gear.mean_normal_thickness, abs=1e-7)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.quick(2)
def test_pinion_tooth_takes_what_the_gear_leaves(name: str) -> None:
    """At the mean point, thicknesses of both members and the blanks' backlash are the pitch, as ISO 23509 has it."""
    case, report = made(name)
    blanks, both = report.blank, sum(mean_thickness(case, report, number) for number in (0, 1))
    assert both == pytest.approx(blanks.pinion.mean_normal_thickness + blanks.gear.mean_normal_thickness, abs=0.06)
    lost = math.pi * blanks.mean_normal_module - blanks.pinion.mean_normal_thickness - blanks.gear.mean_normal_thickness
    assert circular_backlash(gear_pair(case)) == pytest.approx(lost, rel=0.06, abs=2e-3)  # mid-flank


MISTAKES = {
    "unknown key": (r"^gear_face_width", "gear_width", ["blank_design.gear_width", "known are", "gear_face_width"]),
    "missing value": (r"^gear_outer_pitch_diameter.*$", "", ["[blank_design]", "gear_outer_pitch_diameter"]),
    "a hand like neither": (r'"left"', '"up"', ["pinion.hand_of_spiral", "up"]),
    "no such side": (r"^\[target.coast\]$", "[target.other]", ["target.other", "coast, drive"]),
    "unknown setting": (
        r'^hand_of_spiral = "left"$',
        'hand_of_spiral = "left"\nfree_settings = ["blade"]',
        ["pinion.free_settings", "'blade'", "modified_roll_2c", "_motion_1"],
    ),
    "face too wide": (r"^gear_face_width = .*$", "gear_face_width = 500.0", ["[blank_design]"]),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes_name_key_and_what_is_allowed(name: str) -> None:
    pattern, replacement, words = MISTAKES[name]
    with pytest.raises(EaseoffError) as caught:
        parse_design(replaced(FM, pattern, replacement), "mine.toml")
    for word in ["mine.toml", *words]:
        assert word in str(caught.value), str(caught.value)


def test_a_design_that_is_not_there_lists_the_shipped_ones() -> None:
    with pytest.raises(EaseoffError, match=r"the shipped designs are: .*fm-11x41"):
        read_design("fm-11x42")


def test_command_writes_a_case_and_reports(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Design] = []

    def shared(design: Design) -> tuple[Case, DesignReport]:
        asked.append(design)
        return made("fh-12x41-45")

    monkeypatch.setattr(case_design, "design_case", shared)
    said = output_of("design", "fh-12x41-45", "-o", tmp_path / "case.toml", "--report")
    assert asked == [read_design("fh-12x41-45")]
    assert read_case(tmp_path / "case.toml").model_dump() == made("fh-12x41-45")[0].model_dump()
    for word in ("Drive side", "Coast side", "mean spiral angle", "modified_roll_2c", "um"):
        assert word in said
    assert [p.name for p in tmp_path.iterdir()] == ["case.toml"]


def test_command_leaves_nothing_behind_after_a_mistake(tmp_path: Path) -> None:
    (tmp_path / "bad.toml").write_text(replaced(FM, r"^cutter_radius = .*$", "cutter_radius = 20.0"))
    assert "cutter_radius" in refusal_of("design", tmp_path / "bad.toml", "-o", tmp_path / "case.toml")
    assert [p.name for p in tmp_path.iterdir()] == ["bad.toml"]


@pytest.mark.parametrize("name", ["fm-11x41", "fh-design-a"])
@pytest.mark.thorough
def test_generated_gear_takes_the_same_target(name: str) -> None:
    """Rolled on its pitch cone it is fitted like the Formate one, and the pair is certified under load."""
    text = design_text(name).replace("[gear]\n", '[gear]\ngeneration = "generated"\n')
    case, report = design_case(parse_design(text))
    assert gear_pair(case).gear.loaded.settings.generated
    # Over the whole common flank the form of a generated gear is met to a few micrometres, which the report says.
    told = ("misses the target by up to", "limit_pressure_angle_influence = 0")
    assert all(any(words in warning for words in told) for warning in report.warnings)
    for side in report.sides.values():
        assert side.largest_residual < 6e-3
        assert np.abs(side.root_gap).max() < 0.1
    assert np.all(analyze(case, torques=[200.0])["loaded"]["status"].values == 0)


@pytest.mark.thorough
def test_both_hands_make_the_same_pair() -> None:
    """The pinion of the other hand has the same settings, and the ease-off is the same."""
    mirrored, _ = design_case(on_shells(parse_design(replaced(FM, r'"left"', '"right"'))))
    one, two = numbers(made("fm-11x41")[0].model_dump()), numbers(mirrored.model_dump())
    for key, value in one.items():
        if isinstance(value, float):
            assert two[key] == pytest.approx(value, rel=1e-5, abs=1e-5), key
        elif key != "pinion.hand_of_spiral":
            assert two[key] == value, key


# Kolivand 2009, Tables 4.3 and 5.4: spiral angles of pinion and gear [deg] and how far they are rounded, offset, and
# outer cone distances or the gear's pitch diameter [mm].
PRINTED: dict[str, tuple[tuple[float, float], float, float, dict[str, tuple[float | None, float]]]] = {
    "fh-12x41-45": ((50.0, 24.0), 0.5, 45.0, {"outer_cone_distance": (105.0, 130.0)}),
    "fh-design-a": ((40.0, 31.3), 0.05, 15.0, {"outer_pitch_diameter": (None, 220.0)}),
    "fh-design-b": ((47.0, 29.6), 0.05, 30.0, {"outer_pitch_diameter": (None, 220.0)}),
}


@pytest.mark.parametrize("name", PRINTED)
def test_printed_numbers_of_the_dissertation_come_out(name: str) -> None:
    """Of the blanks of the design, and of the case as read from its file."""
    spirals, rounding, offset, lengths = PRINTED[name]
    case, blank = read_case(name), blanks(name)
    assert (case.pinion.number_of_teeth, case.gear.number_of_teeth) == (12, 41)
    assert case.pinion.hand_of_spiral == "left"
    assert case.pair.hypoid_offset == offset
    assert case.gear.convex is not None
    assert case.gear.convex.machine.ratio_of_roll is None
    assert case.gear.convex.cutter.number_of_blade_groups > 0
    for k, member in enumerate((blank.pinion, blank.gear)):
        assert math.degrees(member.mean_spiral_angle) == pytest.approx(spirals[k], abs=rounding)
        for key, values in lengths.items():
            if values[k] is not None:
                assert getattr(member, key) == pytest.approx(values[k], abs=0.5)


@pytest.mark.parametrize("side", ["drive", "coast"])
@pytest.mark.parametrize("name", PRINTED)
def test_hobbed_gear_flanks_have_the_spiral_angle_of_the_blank(name: str, side: Any) -> None:
    """Measured on the case as read from its file, with its ten decimals."""
    gear, blank = gear_pair(read_case(name), side).gear, blanks(name)
    found = mean_point_angles(gear.loaded, gear.section, blank.gear)
    assert found.spiral_angle == pytest.approx(blank.gear.mean_spiral_angle, abs=1e-9)


@pytest.mark.parametrize("side", ["drive", "coast"])
def test_designs_a_and_b_have_matched_ease_offs(side: Any) -> None:
    """The dissertation compares them at one ease-off: they differ by less than 1 um of 100 um on the common flank."""
    maps = [ease_off(gear_pair(read_case(name), side), (21, 15)) for name in ("fh-design-a", "fh-design-b")]
    inside = np.all([m["inside"].values == 1 for m in maps], axis=0)
    one, two = (m["ease_off"].values[inside] for m in maps)
    assert np.abs(one - two).max() < 1.0
    for values in (one, two):
        assert 85.0 < values.max() < 105.0


@pytest.mark.parametrize("side", ["drive", "coast"])
@pytest.mark.parametrize("name", PRINTED)
@pytest.mark.quick(2)
def test_hobbed_pairs_are_certified_from_50_to_500_newton_metres(name: str, side: Any) -> None:
    """With a pattern in the middle of the flank at 50 N m that carries little at the ends of the lines."""
    case = by_the_dissertation(name, edge_contact=True, mesh_positions=6)
    tree = analyze(case, flank=side, torques=[50.0, 200.0, 500.0])
    loaded = tree["loaded"].to_dataset()
    assert np.all(loaded["status"].values == 0)
    force = loaded["force"].sel(torque=50.0)
    for direction in ("lengthwise", "profile"):
        centre = float((force * loaded[direction].sel(torque=50.0)).sum() / force.sum())
        assert 0.42 < centre < 0.6


def test_errors_of_the_wide_offset_pair_are_near_the_dissertations() -> None:
    """Table 4.4: 36.9 urad unloaded and 23.9 urad at 200 N m, peak to peak; an equivalent design, not the same one."""
    tree = analyze(by_the_dissertation("fh-12x41-45", mesh_positions=8, segments_per_line=15), torques=[200.0])
    assert tree["unloaded"].attrs["peak_to_peak"] == pytest.approx(36.9, rel=0.25)
    loaded = tree["loaded"].to_dataset()
    assert float(loaded["peak_to_peak"][0]) == pytest.approx(23.9, rel=0.25)
    assert float(loaded["harmonic"][0, 0]) == pytest.approx(12.1, rel=0.25)


# --- Designs of the literature


SUPPORTS = {"axle-10x41": None, "axle-hobbed-11x39": None, "aero-12x36": "gearbox-nasa-12x36"}
NOMINAL = 200.0  # [N m]
DESIGNS = DOCS / "engineer" / "designs"
PAGES = sorted(DESIGNS.glob("*.md"))


@cache
def cut(name: str) -> Case:
    """The case of a design, with settings rounded; its design has nothing to warn of."""
    case, report = design_case(read_design(name))
    assert report.warnings == ()
    rounded = rounded_case(case)
    assert max(rounding_effect(case, rounded).values()) < 1.0
    return rounded


@pytest.mark.thorough
@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize("name", SUPPORTS)
def test_pattern_lies_in_the_middle_and_off_the_edges(name: str, flank: FlankName) -> None:
    tree = easeoff.analyze(cut(name), flank=flank, torques=[NOMINAL], supports=SUPPORTS[name])
    loaded, numbers = tree["loaded"].to_dataset(), key_numbers(tree).squeeze()
    assert numbers["certified_positions"] == loaded.sizes["mesh_position"]
    assert edge_notes(loaded) == []
    assert numbers["max_edge_share"] < 0.02
    assert numbers["max_pressure_line_end"] == 0
    assert 0.45 < numbers["pattern_centre_lengthwise"] < 0.6
    assert 1000.0 < numbers["max_pressure"] < 1500.0
    assert 10.0 < numbers["peak_to_peak"] < 60.0
    assert 0.94 < numbers["efficiency"] < 0.999


@pytest.mark.thorough
@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_completing_design_has_one_set_up(member: str) -> None:
    """Equal machine settings on both flanks; blades of their own."""
    flanks = getattr(cut("axle-hobbed-11x39"), member)
    assert flanks.concave.machine == flanks.convex.machine


def test_drawing_data_of_the_bevel_pair_are_those_of_its_source() -> None:
    """NASA CR-191009: mean cone distance 3.191 inch, face width 1 inch, pitch angle 71.5667 degrees."""
    blank = read_design("aero-12x36").blank_design
    assert blank.gear_face_width == 25.4
    assert blank.gear_outer_pitch_diameter is not None
    mean_cone_distance = blank.gear_outer_pitch_diameter / 2.0 / np.sin(np.arctan(36 / 12)) - blank.gear_face_width / 2
    assert mean_cone_distance == pytest.approx(3.191 * 25.4, abs=2e-3)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_commands_of_a_page_name_their_outputs(page: Path) -> None:
    """What a command reads is shipped, or was written by one above it."""
    made = importlib.import_module("make_designs")
    text = page.read_text(encoding="utf-8")
    known = {*shipped_designs()}
    words = list(made.commands(text))
    assert [one[0] for one in words][:1] == ["design"]
    for one in words:
        assert one[1] in known, one
        known |= {one[one.index(option) + 1] for option in ("-o", "--case") if option in one}
    assert {f"{made.PAGES[page.stem]}-{name}.nc" for name in ("drive", "coast", "verify", "best-drive")} <= known


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_generated_parts_of_a_page_are_made(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    made = re.findall(r"<!-- begin generated: (\w+) -->(.*?)<!-- end generated: \1 -->", text, flags=re.DOTALL)
    assert [name for name, _ in made] == ["sheet", "numbers", "verification"]
    assert all(part.strip() for _, part in made)


# --- Extreme designs


METHODS = get_args(PinionMethod)
#: What a refusal may advise: another method, limits, a generated gear, or other blanks.
ADVICE = ("method = ", "[pinion.limits]", "generation = ", "cutter_radius", "more teeth", "free_settings")


def wrong_in(case: Case, report: DesignReport) -> Iterator[str]:
    """What is not as it must be in a case: how it is read back, and each side's residual on another grid."""
    if parse_case(case_toml(case)).model_dump() != case.model_dump():
        yield "read back as another case"
    for side, item in report.sides.items():
        target = ease_off_target(getattr(case.target, side))
        _, usable = residual_limits(target)
        if not item.largest_residual <= usable:
            yield f"{side}: residual {item.largest_residual} above the usable {usable}"
        pair = gear_pair(case, side)
        t, h = grid((13, 9))
        found = exact_ease_off(pair.gear.flank(t, h), pair.pinion.loaded, pair.pinion.section, pair.assembly)
        known, lever = found.inside, found.lever_arm[found.inside]
        wanted = target(*(f.ravel() for f in np.meshgrid(t, h, indexing="ij")))[known]
        left = found.angle[known] * lever - wanted
        left = left - lever * float(lever @ left) / float(lever @ lever)
        # Closest fits of a Formate gear state the residual at the nodes of the fit; it grows towards undercut flanks.
        nodes = [member.flank(*grid((15, 11))).status for member in (pair.pinion, pair.gear)]
        factor = 2.0 if np.isin(nodes, (NodeStatus.UNDERCUT, NodeStatus.NO_SOLUTION)).any() else 1.5
        largest, limit = np.abs(left).max(), factor * item.largest_residual + 2e-3
        if not largest < limit:
            yield f"{side}: residual {largest} on another grid, above {limit}"


@pytest.mark.thorough
@pytest.mark.parametrize("name", EXTREMES)
def test_extreme_design_is_cut_or_refused_with_advice(name: str) -> None:
    """By every method a case that may be used, or advice."""
    wrong: list[str] = []
    for method in METHODS:
        try:
            case, report = design_case(parse_design(EXTREMES[name].text(method)))
        except GeometryError as error:
            if not any(word in str(error) for word in ADVICE):
                wrong.append(f"{method}: no advice in: {error}")
        else:
            wrong += [f"{method}: {what}" for what in wrong_in(case, report)]
    assert not wrong, "\n".join(wrong)


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
