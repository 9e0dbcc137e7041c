"""Drawings typed as they are, with what they omit left out: they are designed, and what was taken is told."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from drawings import drawing
from runs import output_of, refusal_of, text_file

from easeoff import GeometryError, InputError, analyze
from easeoff.cases import Design, designed_blanks, parse_design, read_case
from easeoff.cases.conversion import spiral_angle_difference
from easeoff.cases.schema.blank_design_table import BlankDesignTable
from easeoff.cases.schema.case_schema import PairTable
from easeoff.geometry.design.tooth_proportions import ToothProportions
from easeoff.study import design_case
from easeoff.study.cli.case_run import basic_data_lines
from easeoff.study.design import case_design
from easeoff.study.design.design_check import proportion_warnings

AXLE = """easeoff_design = 1
title = "An axle as drawn"
[pair]
hypoid_offset = 36.0
[blank_design]
gear_outer_pitch_diameter = 232.0
gear_face_width = 37.0
cutter_radius = 95.25
pinion_mean_spiral_angle = 48.0
nominal_drive_pressure_angle = 19.0
nominal_coast_pressure_angle = 19.0
[pinion]
number_of_teeth = 12
hand_of_spiral = "left"
[gear]
number_of_teeth = 37
"""


def on_shells(design: Design) -> Design:
    """For teeth as shells, whose check is a short one."""
    return design.model_copy(update={"compliance": design.compliance.model_copy(update={"model": "shell"})})


def test_a_drawing_is_designed_as_it_is_and_every_value_taken_is_told(tmp_path: Path) -> None:
    text = AXLE + '[compliance]\nmodel = "shell"\n'
    design = parse_design(text)
    said = output_of("design", text_file(tmp_path / "axle.toml", text), "-o", tmp_path / "case.toml")
    lines = [line.strip() for line in said.splitlines()]
    assert not [line for line in lines if "Warning" in line]
    assert [line for line in lines if line in set(map(str, design.defaults))] == list(map(str, design.defaults))
    assert "depth_factor = 2 (ISO 23509:2016, C.3.2.1)" in lines
    assert "target.coast.profile_crowning = 37.6 (rule of this package)" in lines
    assert 'gear.generation = "formate" (pitch angle of the gear)' in lines
    case = read_case(tmp_path / "case.toml")
    assert case.target.drive == design.target.drive
    assert case.target.drive is not None
    assert case.target.drive.lengthwise_crowning == 74.0


def test_an_empty_target_still_means_a_conjugate_pinion() -> None:
    design = parse_design(AXLE + "[target.drive]\n")
    assert (design.target.drive.lengthwise_crowning, design.target.coast.lengthwise_crowning) == (0.0, 74.0)


def test_a_design_in_inches_is_refused_at_once(tmp_path: Path) -> None:
    in_inches = {"36.0": "1.42", "232.0": "9.134", "= 37.0": "= 1.457", "95.25": "3.75"}
    text = AXLE
    for length, inches in in_inches.items():
        text = text.replace(length, inches)
    said = refusal_of("design", text_file(tmp_path / "inches.toml", text), "-o", tmp_path / "case.toml")
    assert "gear_outer_pitch_diameter = 9.134: lengths must be in mm" in said
    assert "9.134 in is 232.004 mm" in said


def test_all_that_a_drawing_must_give_is_named_at_once() -> None:
    text = AXLE.replace("gear_outer_pitch_diameter = 232.0\n", "").replace("pinion_mean_spiral_angle = 48.0\n", "")
    with pytest.raises(InputError) as caught:
        parse_design(text)
    head, *lines = str(caught.value).splitlines()
    assert head == "design has 2 mistakes:"
    assert [line.partition("] ")[2].split(":")[0] for line in lines] == [
        "pinion_mean_spiral_angle is missing",
        "gear_outer_pitch_diameter is missing",
    ]
    with pytest.raises(InputError, match=r"^\[blank_design\] gear_mean_spiral_angle is missing"):
        designed_blanks(BlankDesignTable(cutter_radius=95.25), (12, 37), PairTable())


@pytest.mark.parametrize(
    ("given", "wanted"),
    [
        (
            {"cutter_radius": "95.25", "gear_face_widht": "37.0"},
            ["gear_face_widht", "diameter is", "pinion_mean_spiral_angle is"],
        ),
        ({"depth_factor": "9.0"}, ["cutter_radius", "depth_factor = 9", "diameter is", "pinion_mean_spiral_angle is"]),
        ({"gear_outer_pitch_diameter": '"232"'}, ["cutter_radius", "'232'", "pinion_mean_spiral_angle is"]),
        (
            {"number_of_blade_groups": '"seven"', "gear_outer_pitch_diameter": "232.0", "depth_taper": '"standard"'},
            ["cutter_radius", "'seven'", "gear_mean_spiral_angle is", "face_hobbed teeth have uniform depth"],
        ),
        (
            {"cutter_radius": "95.25", "depth_factor": "2.0", "profile_shift_coefficient": "0.1"},
            ["diameter is", "pinion_mean_spiral_angle is", "give one type only"],
        ),
        ({"method": "7"}, ["cutter_radius", "method = 7"]),
    ],
)
def test_wrong_keys_and_missing_data_are_told_in_one_round(given: dict[str, str], wanted: list[str]) -> None:
    """Each once; nothing is said of what depends on a key that is wrong itself."""
    table = "".join(f"{key} = {value}\n" for key, value in given.items())
    head, rest = AXLE.split("gear_outer_pitch_diameter")
    with pytest.raises(InputError) as caught:
        parse_design(head + table + "[pinion]" + rest.split("[pinion]")[1])
    first, *lines = str(caught.value).splitlines()
    assert first == f"design has {len(wanted)} mistakes:"
    assert len(lines) == len(wanted)
    for words in wanted:
        assert sum(words in line for line in lines) == 1, words


SPIRALS = "pinion_mean_spiral_angle = 48.0\n"


@pytest.mark.parametrize("gear", [22.0, 28.0, 34.0])
def test_the_spiral_angle_of_the_gear_suffices_for_a_milled_hypoid_pair(gear: float) -> None:
    """The pinion's is found with which method 1 gives the gear's, and told."""
    design = parse_design(AXLE.replace(SPIRALS, f"gear_mean_spiral_angle = {gear}\n"))
    blank = designed_blanks(design.blank_design, (12, 37), design.pair)
    assert np.degrees(blank.gear.mean_spiral_angle) == pytest.approx(gear, abs=1e-8)
    (told,) = [str(each) for each in design.defaults if "spiral" in each.name]
    assert f"method 1 gives gear_mean_spiral_angle = {gear:g}" in told
    assert np.degrees(blank.pinion.mean_spiral_angle) == pytest.approx(
        design.blank_design.pinion_mean_spiral_angle, abs=0.05
    )


def test_the_spiral_angle_of_the_pinion_suffices_for_the_other_methods() -> None:
    hobbed = AXLE.replace("95.25", "88.0\nnumber_of_blade_groups = 13\nmethod = 3")
    blank = designed_blanks(parse_design(hobbed).blank_design, (12, 37), PairTable(hypoid_offset=36.0))
    assert np.degrees(blank.pinion.mean_spiral_angle) == pytest.approx(48.0, abs=1e-8)
    bevel = parse_design(AXLE.replace("hypoid_offset = 36.0\n", "").replace("48.0", "35.0"))
    assert bevel.blank_design.gear_mean_spiral_angle == 35.0
    with pytest.raises(InputError, match=r"pinion_mean_spiral_angle = 3: method 3: no pitch cones have a pinion"):
        parse_design(hobbed.replace("48.0", "3.0"))


def test_both_spiral_angles_are_compared() -> None:
    """With what method 1 gives, 28.5 degrees here: told where they differ, refused where they cannot be one pair's."""
    near, far = (AXLE.replace(SPIRALS, f"{SPIRALS}gear_mean_spiral_angle = {gear}\n") for gear in (28.0, 20.0))
    with pytest.raises(InputError, match=r"gear_mean_spiral_angle = 20: method 1 gives 28.5 .*angle = 48, 8.5 .* more"):
        parse_design(far)
    table = parse_design(near).blank_design
    difference, text = spiral_angle_difference(table, designed_blanks(table, (12, 37), PairTable(hypoid_offset=36.0)))
    assert difference == pytest.approx(-0.547, abs=2e-3)
    assert text.startswith(
        "gear_mean_spiral_angle = 28: method 1 gives 28.5 degrees with pinion_mean_spiral_angle = 48"
    )


def test_a_run_tells_what_the_basic_data_of_a_case_leave_out() -> None:
    basic = parse_design(AXLE.replace(SPIRALS, f"{SPIRALS}gear_mean_spiral_angle = 28.0\n"))
    case = read_case("fm-11x41").model_copy(update={"blank_design": basic.blank_design, "pair": basic.pair})
    case = case.with_tables(pinion={"number_of_teeth": 12}, gear={"number_of_teeth": 37})
    head, *lines, warning = basic_data_lines(case)
    assert head == "Taken for what [blank_design] leaves out:"
    assert lines == [f"  {each}" for each in basic.blank_design.defaults]
    assert "gear_mean_spiral_angle = 28" in warning
    assert basic_data_lines(read_case("fm-11x41")) == []


def test_proportions_out_of_the_customary_range_are_warned_of() -> None:
    text = AXLE.replace("gear_face_width = 37.0", "gear_face_width = 60.0").replace("48.0", "62.0")
    design, usual = parse_design(text), parse_design(AXLE)
    blank = designed_blanks(design.blank_design, (12, 37), design.pair)
    face, spiral, *others = proportion_warnings(ToothProportions.of(blank, 50.0, generated_gear=True))
    assert "gear_face_width = 60 mm is" in face
    assert "the pinion's mean spiral angle of 61.9 degrees is large" in spiral
    assert "cutter_radius = 50 mm is 0.5" in others[-1]
    usual_blank = designed_blanks(usual.blank_design, (12, 37), usual.pair)
    assert list(proportion_warnings(ToothProportions.of(usual_blank, 95.25, generated_gear=True))) == []


def test_another_taper_is_searched_for_where_the_usual_one_has_no_pinion(monkeypatch: pytest.MonkeyPatch) -> None:
    """And not where the file gives it; what was tried in vain is told with the reason of the first failure."""
    tried: list[tuple[str, str]] = []

    def designed(design: Design) -> None:
        tried.append((str(design.blank_design.depth_taper), design.pinion.method))
        raise GeometryError(f"no pinion with {tried[-1][0]}")

    monkeypatch.setattr(case_design, "_designed", designed)
    with pytest.raises(GeometryError) as caught:
        design_case(parse_design(AXLE))
    assert [taper for taper, _ in tried[:3]] == ["modified_slot_width", "standard", "uniform"]
    assert tried[-1] == ("modified_slot_width", "tilt")
    assert str(caught.value).startswith('no pinion with modified_slot_width; tried in vain: depth_taper = "standard", ')
    tried.clear()
    with pytest.raises(GeometryError):
        design_case(parse_design(AXLE.replace("[pinion]", 'depth_taper = "uniform"\n[pinion]')))
    assert {taper for taper, _ in tried} == {"uniform"}


POINTED = """easeoff_design = 1
title = "A pointed pinion, hobbed, with proportions of its own"
[blank_design]
gear_outer_pitch_diameter = 50.7
gear_face_width = 7.4
cutter_radius = 25.0
number_of_blade_groups = 5
gear_mean_spiral_angle = 30.0
gear_mean_addendum_factor = 0.21
depth_factor = 2.0
thickness_factor = 0.05
[pinion]
number_of_teeth = 7
hand_of_spiral = "right"
method = "closest_fit"
[gear]
number_of_teeth = 28
generation = "formate"
"""


@pytest.mark.thorough
def test_the_changes_that_a_message_names_help_a_pointed_pinion() -> None:
    """Each alone; and the model that needs no whole tooth takes the pinion as it is."""

    def pointed(text: str) -> tuple[bool, int]:
        """If it can be analysed, and the share of the face that is pointed [%]."""
        report = design_case(parse_design(text))[1]
        messages = [each for each in report.warnings if "tooth is pointed" in each]
        assert all("a smaller depth_factor or a larger gear_mean_addendum_factor helps" in each for each in messages)
        return report.analysable, sum(int(re.findall(r"on (\d+) % of the face", each)[0]) for each in messages)

    analysable, share = pointed(POINTED)
    assert not analysable
    assert pointed(POINTED.replace("factor = 0.21", "factor = 0.33"))[1] < 0.5 * share
    assert pointed(POINTED.replace("depth_factor = 2.0", "depth_factor = 1.7")) == (True, 0)
    case, report = design_case(parse_design(POINTED + '[compliance]\nmodel = "shell"\n'))
    assert report.analysable
    assert np.all(analyze(case)["loaded"]["status"] == 0)


#: Of drawings of seed 11; each takes some ten seconds.
GROUPS = [range(start, 50, 10) for start in range(10)]


@pytest.mark.thorough
@pytest.mark.parametrize("group", GROUPS, ids=lambda group: f"from-{group[0]}")
def test_drawings_as_typed_are_analysed(group: range) -> None:
    """At first, without a change."""
    for number in group:
        text = drawing(11, number)
        case, report = design_case(parse_design(text))
        assert report.analysable, text
        contact = case.contact.model_copy(update={"mesh_positions": 4})
        tree = analyze(case.model_copy(update={"contact": contact}))
        assert np.all(tree["loaded"]["status"] == 0), text
