"""REXS files: a case survives the way there and back, units are honoured, and mistakes are named."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from case_strategies import cases
from hypothesis import HealthCheck, given, settings
from places import DOCS

from easeoff import InputError
from easeoff.cases import Case, gear_pair, read_case, read_rexs, shipped_cases, write_rexs
from easeoff.cases.conversion import machine_settings
from easeoff.cases.reading import MEAN, MID_FLANK
from easeoff.cases.rexs.rexs_vocabulary import BLANK_TERMS, MEMBER_TERMS, STAGE_TERMS
from easeoff.cases.schema.cutting_table import FlankSettings

NASA = read_case("nasa-12x36")
SCHEMA_UNITS = {"mm", "deg", "none", "MPa"}
GEOMETRY = ("title", "pair", "misalignment", "pinion", "gear")


@pytest.fixture
def text(tmp_path: Path) -> str:
    """The published pair as a REXS file."""
    write_rexs(NASA, tmp_path / "nasa.rexs")
    return (tmp_path / "nasa.rexs").read_text(encoding="utf-8-sig")


def read(text: str, folder: Path) -> tuple[Case, list[str]]:
    (folder / "file.rexs").write_text(text, encoding="utf-8")
    return read_rexs(folder / "file.rexs")


def changed(text: str, pattern: str, replacement: str) -> str:
    result, count = re.subn(pattern, replacement, text, count=1)
    assert count == 1, pattern
    return result


@pytest.mark.parametrize("name", shipped_cases())
def test_shipped_cases_survive(name: str, tmp_path: Path) -> None:
    case = read_case(name)
    write_rexs(case, tmp_path / "case.rexs")
    again, notes = read_rexs(tmp_path / "case.rexs")
    for key in GEOMETRY:
        close(case.model_dump()[key], again.model_dump()[key])
    assert not any("not used" in note for note in notes)
    for side in ("drive", "coast"):
        one, two = (gear_pair(c, "drive" if side == "drive" else "coast") for c in (case, again))
        close(asdict(one), asdict(two))


def close(one: Any, two: Any) -> None:
    """The same numbers within the rounding of a factorial and of degrees and radians."""
    assert type(one) is type(two)
    if isinstance(one, dict):
        assert one.keys() == two.keys()
        for key in one:
            close(one[key], two[key])
    elif isinstance(one, tuple) and one and not isinstance(one[0], float):
        for first, second in zip(one, two, strict=True):
            close(first, second)
    elif isinstance(one, float | tuple):
        np.testing.assert_allclose(np.asarray(two), np.asarray(one), rtol=1e-15, atol=1e-300)
    else:
        assert one == two


def test_the_thickness_is_that_of_the_standard(tmp_path: Path) -> None:
    """At the mean point, whichever of the two a case gives; files of version 1 are told from those of today."""
    case = read_case("fh-design-a")
    assert case.gear.mean_normal_circular_thickness is not None
    middle = gear_pair(case).gear.mean_thickness
    update = {"mean_normal_circular_thickness": None, "mid_flank_normal_circular_thickness": middle}
    given = case.model_copy(update={"gear": case.gear.model_copy(update=update)})
    notes = write_rexs(given, tmp_path / "new.rexs")
    assert "gear.mid_flank_normal_circular_thickness: written as that at the mean point" in notes
    text = (tmp_path / "new.rexs").read_text(encoding="utf-8-sig")
    written = re.search(r'"mean_normal_circular_tooth_thickness" unit="mm">([0-9.]+)<', text)
    assert written is not None
    assert float(written[1]) == pytest.approx(case.gear.mean_normal_circular_thickness, abs=1e-9)
    text = changed(text, r'<attribute id="custom_easeoff_case".*?</attribute>', "")
    earlier, notes = read(text, tmp_path)
    assert earlier.gear.mid_flank_normal_circular_thickness == float(written[1])
    assert earlier.gear.mean_normal_circular_thickness is None
    assert any("an earlier easeoff" in note for note in notes)
    other, _ = read(changed(text, 'applicationId="easeoff"', 'applicationId="another"'), tmp_path)
    assert other.gear.mean_normal_circular_thickness == float(written[1])


def test_every_attribute_of_the_standard_is_in_the_table_of_names() -> None:
    """Keys with a name of REXS that the page does not list are of machine and cutter, explained on other pages."""
    page = DOCS.joinpath("engineer/reference/exchange.md").read_text(encoding="utf-8")
    table = page.split("### Names of standards")[1].split("### Assumptions")[0]
    for key in (*STAGE_TERMS, *MEMBER_TERMS, *(k for k, term in BLANK_TERMS.items() if not term.custom)):
        assert f"`{key}`" in table, key


@settings(suppress_health_check=list(HealthCheck), max_examples=settings().max_examples // 2)
@given(cases())
def test_any_geometry_survives(tmp_path: Path, case: Case) -> None:
    write_rexs(case, tmp_path / "case.rexs")
    again, _ = read_rexs(tmp_path / "case.rexs")
    assert (again.title, again.pair, again.misalignment) == (case.title, case.pair, case.misalignment)
    for member in ("pinion", "gear"):
        one, two = getattr(case, member).model_dump(), getattr(again, member).model_dump()
        for side in ("concave", "convex"):
            before: FlankSettings | None = getattr(getattr(case, member), side)
            after: FlankSettings | None = getattr(getattr(again, member), side)
            assert (before is None) == (after is None)
            if before is None or after is None:
                continue
            if before.machine.horizontal_distance is not None:
                expected, found = machine_settings(before.machine), machine_settings(after.machine)
                assert found.radial_distance == expected.radial_distance
                assert found.cradle_angle == pytest.approx(expected.cradle_angle, rel=1e-15)
                assert not found.generated
                one[side].pop("machine")
                two[side].pop("machine")
        assert two.pop(MID_FLANK) is None
        if one.pop(MID_FLANK) is not None:  # written as that at the mean point, where the teeth have one
            del one[MEAN], two[MEAN]
        close(one, two)


def test_file_is_built_as_the_schema_wants_it(text: str) -> None:
    root = ET.fromstring(text)
    assert root.tag == "model"
    assert {"version", "applicationId", "applicationVersion", "date"} <= set(root.attrib)
    assert [child.tag for child in root] == ["relations", "components"]
    kinds = {c.attrib["id"]: c.attrib["type"] for c in root.iter("component")}
    assert len(kinds) == len(list(root.iter("component")))
    roles: dict[str, list[list[tuple[str, str]]]] = {}
    for relation in root.iter("relation"):
        ends = [(r.attrib["role"], kinds[r.attrib["id"]]) for r in relation.iter("ref")]
        roles.setdefault(relation.attrib["type"], []).append(ends)
        assert ("order" in relation.attrib) == (relation.attrib["type"] == "manufacturing_step")
    # Roles and component types of every relation, as the schema of REXS 2.0.0 allows them.
    assert roles["stage"] == [[("stage", "bevel_stage"), ("gear_1", "bevel_gear"), ("gear_2", "bevel_gear")]]
    flanks = [("gear", "bevel_gear"), ("left", "bevel_gear_flank"), ("right", "bevel_gear_flank")]
    assert roles["flank"] == [flanks] * 2
    step = [
        ("workpiece", "bevel_gear_flank"),
        ("tool", "bevel_gear_tool"),
        ("manufacturing_settings", "bevel_gear_manufacturing_settings"),
    ]
    assert roles["manufacturing_step"] == [step] * 4
    assert roles["reference"] == [[("origin", "bevel_gear"), ("referenced", "material")]] * 2
    assert {a.attrib["unit"] for a in root.iter("attribute")} <= SCHEMA_UNITS


def test_left_and_right_are_seen_from_the_heel(tmp_path: Path) -> None:
    """The normal of a flank says on which side of the tooth it is."""
    for hand in ("left", "right"):
        case = NASA.model_copy(update={"pinion": NASA.pinion.model_copy(update={"hand_of_spiral": hand})})
        write_rexs(case, tmp_path / "x.rexs")
        root = ET.parse(tmp_path / "x.rexs").getroot()
        names = {c.attrib["id"]: c.attrib["name"] for c in root.iter("component")}
        pair = gear_pair(case, "drive")
        for member, name in ((pair.pinion, "pinion concave"), (pair.gear, "gear convex")):
            middle = member.middle()
            position, normal = middle.position[:, 0], middle.normal[:, 0]
            # The heel towards the observer, z comes out of the page; with the tip up, z x position points to the left.
            to_the_left = np.cross([0.0, 0.0, 1.0], position) @ normal > 0.0
            role = next(r.attrib["role"] for r in root.iter("ref") if names[r.attrib["id"]] == name
                        and r.attrib["role"] in ("left", "right"))  # fmt: skip
            assert role == ("left" if to_the_left else "right")


def test_flanks_without_our_own_attribute_are_told_by_hand_and_side(text: str, tmp_path: Path) -> None:
    foreign = re.sub(r'\s*<attribute id="custom_easeoff_flank".*?</attribute>', "", text)
    case, notes = read(foreign, tmp_path)
    assert case.pinion == NASA.pinion
    assert case.gear == NASA.gear
    assert sum("seen from the heel" in note for note in notes) == 4


def test_units_are_honoured(text: str, tmp_path: Path) -> None:
    def converted(match: re.Match[str]) -> str:
        unit, value = match.group(2), float(match.group(3))
        other, factor = {"mm": ("m", 1e-3), "deg": ("rad", math.radians(1.0)), "MPa": ("Pa", 1e6)}[unit]
        return f'{match.group(1)} unit="{other}">{value * factor!r}<'

    foreign = re.sub(r'(<attribute id="\w+") unit="(mm|deg|MPa)">([^<\s]+)<', converted, text)
    assert 'unit="mm"' not in foreign
    case, _ = read(foreign, tmp_path)
    for key in ("pair", "pinion", "gear"):
        one, two = getattr(NASA, key).model_dump(), getattr(case, key).model_dump()
        np.testing.assert_allclose(flat(two), flat(one), rtol=1e-14)
    old = re.sub('unit="deg"', 'unit="°"', text).replace('unit="MPa"', 'unit="N / mm^2"')
    assert read(old, tmp_path)[0].pinion == NASA.pinion
    assert read(re.sub(r' unit="\w+"', "", text), tmp_path)[0].pinion == NASA.pinion


def flat(table: Any) -> list[float]:
    if isinstance(table, dict):
        return [number for value in table.values() for number in flat(value)]
    if isinstance(table, tuple):
        return list(table)
    return [float(table)] if isinstance(table, int | float) else []


def test_what_goes_over_only_in_part_is_reported(tmp_path: Path) -> None:
    notes = "\n".join(write_rexs(NASA, tmp_path / "x.rexs"))
    for words in ("pinion.blank.front_angle", "custom_easeoff_front_angle", "description", "contact"):
        assert words in notes
    assert "compliance" not in notes
    assert "misalignment" not in notes


def test_what_is_not_used_is_reported(text: str, tmp_path: Path) -> None:
    more = text.replace(
        "</components>",
        '<component id="90" type="shaft" name="s"/><component id="91" type="shaft" name="t"/></components>'
        '<load_spectrum id="1"/>',
    ).replace(
        '<attribute id="blade_point_radius"',
        '<attribute id="side_rake_angle" unit="deg">3.0</attribute><attribute id="blade_point_radius"',
        1,
    )
    case, notes = read(more, tmp_path)
    assert case.pinion == NASA.pinion
    text_of_notes = "\n".join(notes)
    for words in ("side_rake_angle", "bevel_gear_tool", "type shaft (2)", "load spectrum"):
        assert words in text_of_notes


def test_namespaces_members_and_steps_in_another_order(text: str, tmp_path: Path) -> None:
    spaced = text.replace("<model ", '<model xmlns="http://www.rexs.info/namespace" ')
    assert read(spaced, tmp_path)[0].pinion == NASA.pinion
    swapped = text.replace("gear_1", "gear_0").replace("gear_2", "gear_1").replace("gear_0", "gear_2")
    case, notes = read(swapped, tmp_path)
    assert case.pinion == NASA.pinion
    assert any("taken as the pinion" in note for note in notes)
    # A later manufacturing step wins.
    step = re.search(r'<relation id="\d+" type="manufacturing_step" order="1">(.*?)</relation>', text, re.DOTALL)
    assert step is not None
    rough = f'<relation id="99" type="manufacturing_step" order="0">{step.group(1)}</relation></relations>'
    case, notes = read(text.replace("</relations>", rough), tmp_path)
    assert case.pinion == NASA.pinion
    assert any("last of 2" in note for note in notes)


def test_a_formate_member_has_no_roll(text: str, tmp_path: Path) -> None:
    case, notes = read(re.sub(r'\s*<attribute id="ratio_of_roll".*?</attribute>', "", text), tmp_path)
    assert case.gear.convex is not None
    assert case.gear.convex.machine.ratio_of_roll is None
    assert sum("Formate" in note for note in notes) == 4


MISTAKES = {
    "missing blank": (r'<attribute id="face_width".*?</attribute>', "", ["bevel_gear", "face_width", "component 2"]),
    "missing machine": (
        r'<attribute id="center_roll_position".*?</attribute>',
        "",
        ["bevel_gear_manufacturing_settings", "center_roll_position", "component 6"],
    ),
    "missing tool": (
        r'<attribute id="blade_pressure_angle".*?</attribute>',
        "",
        ["component 5", "blade_pressure_angle"],
    ),
    "unknown unit": (r'(id="face_width" unit=)"mm"', r'\1"furlong"', ["component 2", "face_width", "furlong", "'mm'"]),
    "wrong quantity": (r'(id="face_width" unit=)"mm"', r'\1"deg"', ["component 2", "face_width", "'deg'", "'mm'"]),
    "no number": (r'(id="face_width" unit="mm">)[\d.]+', r"\1wide", ["component 2", "face_width", "wide", "number"]),
    "not finite": (r'(id="face_width" unit="mm">)[\d.]+', r"\1inf", ["component 2", "face_width", "inf", "finite"]),
    "half a tooth": (r'(id="number_of_teeth" unit="none">)12', r"\g<1>12.5", ["number_of_teeth", "12.5", "whole"]),
    "out of range": (r'(id="face_width" unit="mm">)[\d.]+', r"\g<1>0.1", ["face_width", "0.1", "greater than 0.5"]),
    "wrong hand": (
        r'(id="spiral_angle_pitch_direction" unit="none">)left',
        r"\1up",
        ["= 'up': must be one of left, right"],
    ),
    "one hand": (r'(id="spiral_angle_pitch_direction" unit="none">)left', r"\1right", ["opposite hand"]),
    "no stage": (r'type="bevel_stage"', 'type="worm_stage"', ["0 bevel stages"]),
    "no gear": (r'type="bevel_gear" ', 'type="worm_gear" ', ["bevel_gear"]),
    "no such flank": (
        r'(id="custom_easeoff_flank" unit="none">)concave',
        r"\1hollow",
        ["'hollow': must be one of concave, convex"],
    ),
    "not closed": (r"</model>", "", ["cannot be read as XML"]),
    "no id": (r'<component id="1" ', "<component ", ["id"]),
    "doctype": (r"<model ", "<!DOCTYPE model [<!ENTITY a 'b'>]><model ", ["document type"]),
    "other file": (r"(?s)<model .*</model>", "<gears/>", ["<gears>", "<model>"]),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes_name_component_attribute_and_value(name: str, text: str, tmp_path: Path) -> None:
    pattern, replacement, words = MISTAKES[name]
    with pytest.raises(InputError) as caught:
        read(changed(text, pattern, replacement), tmp_path)
    for word in ("file.rexs", *words):
        assert word in str(caught.value)


def test_all_missing_attributes_come_in_one_message(text: str, tmp_path: Path) -> None:
    bare = re.sub(r'\s*<attribute id="(face_width|root_angle)".*?</attribute>', "", text)
    with pytest.raises(InputError) as caught:
        read(bare, tmp_path)
    assert str(caught.value).count("face_width") == 2
    assert str(caught.value).count("root_angle") >= 2


def test_coefficients_that_cannot_be_read(text: str, tmp_path: Path) -> None:
    coded = '<attribute id="modified_roll_coefficients" unit="none"><array code="float64">AAAA</array></attribute>'
    many = "<array>" + "<c>0.1</c>" * 6 + "</array>"
    roll = f'<attribute id="modified_roll_coefficients" unit="none">{many}</attribute>'
    for attribute, words in ((coded, "binary code"), (roll, "more than 5")):
        with pytest.raises(InputError, match=words):
            read(
                text.replace('<attribute id="ratio_of_roll"', f'{attribute}<attribute id="ratio_of_roll"', 1), tmp_path
            )


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no such file"):
        read_rexs(tmp_path / "none.rexs")
