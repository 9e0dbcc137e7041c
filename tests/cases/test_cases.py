"""Case files: reading, messages about mistakes, and writing to the last digit."""

from __future__ import annotations

import math
import re
import tomllib
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from case_strategies import cases
from hypothesis import given, settings, strategies as st
from runs import replaced

from easeoff import EaseoffError, GeometryError, InputError
from easeoff.cases import Case, case_text, case_toml, gear_pair, parse_case, read_case, shipped_cases, write_case
from easeoff.cases.conversion import given_pair
from easeoff.cases.reading import stem
from easeoff.geometry import Misalignment, pair_geometry, tooth_angle
from easeoff.geometry.design.blank import angles_of_normal
from easeoff.geometry.pair.tooth_thickness import filling_thickness, mean_cone_distances, mean_thicknesses
from easeoff.geometry.tooth.tooth_flanks import placed_flanks

NASA = case_text("nasa-12x36")


@pytest.mark.parametrize("name", shipped_cases())
def test_shipped_cases_make_a_pair(name: str) -> None:
    case = read_case(name)
    assert (case.text, case.title) == (case_text(name), shipped_cases()[name])
    assert gear_pair(case).assembly.ratio > 1.0


def test_a_thickness_means_what_iso_23509_means() -> None:
    """The normal arc between both flanks of the tooth on the pitch cone at the mean point, seen from either side."""
    case = read_case("fh-design-b")
    for pair in (gear_pair(case), gear_pair(case, "coast")):
        distance, section = mean_cone_distances(pair)[1], pair.gear.section
        sides = placed_flanks(pair.gear, tooth_angle(pair, "gear")).values()
        points = [side.at(*section.on_pitch_cone(distance)[:, None]) for side in sides]
        places = [(point.position[:, 0], point.normal[:, 0]) for point in points]
        azimuths = [math.atan2(position[1], position[0]) for position, _ in places]
        spirals = [angles_of_normal(*place, section.pitch_angle, "right").spiral_angle for place in places]
        radius = distance * math.sin(section.pitch_angle)
        angle = abs(math.remainder(azimuths[1] - azimuths[0], 2.0 * math.pi))
        thickness = radius * angle * math.cos(sum(spirals) / 2.0)
        assert thickness == pytest.approx(case.gear.mean_normal_circular_thickness, abs=1e-12)


def test_thicknesses_and_cone_distances_of_shipped_pairs_stay() -> None:
    assert mean_thicknesses(gear_pair(read_case("nasa-12x36"))) == pytest.approx([5.27, 5.87], abs=5e-3)
    pair = gear_pair(read_case("fm-11x41"))
    assert filling_thickness(pair) == pytest.approx(6.34, abs=5e-3)
    assert mean_cone_distances(pair) == pytest.approx((95.4, 93.7), abs=0.05)


def test_version_1_of_a_case_has_the_thickness_in_the_middle_of_the_flank(tmp_path: Path) -> None:
    case = read_case("fh-design-a")
    middle = gear_pair(case).gear.mean_thickness
    text = replaced(case.text, r"^easeoff_case = 2", "easeoff_case = 1")
    text = replaced(text, r"^mean_normal_circular_thickness = .*$", f"mean_normal_circular_thickness = {middle!r}")
    path = tmp_path / "old.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.warns(UserWarning, match=r"gear\.mean_normal_circular_thickness is read as the .* middle of the flank"):
        old = read_case(path)
    assert gear_pair(old).gear.mean_thickness == middle
    with warnings.catch_warnings(action="error"):
        assert parse_case(case_toml(old)).model_dump() == old.model_dump()
        parse_case(text)  # what a result keeps of its case is read without a word
    both = replaced(case.text, r"^(mean_normal_circular)(.*)$", r"\1\2\nmid_flank_normal_circular_thickness = 3.0")
    with pytest.raises(InputError, match="must not both be given"):
        parse_case(both)


def test_pitch_cones_touch_where_a_search_finds_them() -> None:
    """The point of the pinion's cone next to the gear's circle mid face, by a fine search over the circle."""
    pair = gear_pair(read_case("fh-12x41-45"))
    pinion, gear = pair.pinion.section, pair.gear.section
    assembly = replace(pair.assembly, misalignment=Misalignment())
    axial, radial = gear.on_pitch_cone(gear.middle_distance)
    azimuth = np.linspace(0.0, 2.0 * np.pi, 400_001)
    circle = np.stack([radial * np.cos(azimuth), radial * np.sin(azimuth), np.full_like(azimuth, axial)])
    points = circle + (assembly.gear_origin - assembly.pinion_origin)[:, None]
    along = assembly.pinion_frame[:, 2] @ points
    out = np.sqrt(np.sum(points**2, axis=0) - along**2)
    nearest = np.argmin(out * np.cos(pinion.pitch_angle) - (along + pinion.pitch_apex) * np.sin(pinion.pitch_angle))
    distance = math.hypot(along[nearest] + pinion.pitch_apex, out[nearest])
    assert mean_cone_distances(pair)[0] == pytest.approx(distance, abs=2e-3)
    apart = replace(pair, pinion=replace(pair.pinion, section=replace(pinion, pitch_apex=20.0)))
    assert mean_cone_distances(apart)[0] == pinion.middle_distance
    with pytest.raises(GeometryError, match="apart, not in touch"):
        mean_cone_distances(apart, must_touch=True)


def test_a_copy_with_a_dict_for_a_table_is_refused_with_the_way_to_do_it() -> None:
    case = read_case("nasa-12x36")
    recipe = r"copy it too: .*'contact': case\.contact\.model_copy\(update=\{'mesh_positions': \.\.\.\}\)"
    with pytest.raises(InputError, match=recipe):
        case.model_copy(update={"contact": {"mesh_positions": 8}})
    copied = case.model_copy(update={"contact": case.contact.model_copy(update={"mesh_positions": 8})})
    assert copied.contact.mesh_positions == 8


def test_a_case_shows_itself_in_a_few_lines() -> None:
    case = read_case("fm-11x41").model_copy(update={"title": "<b>mine</b>"})
    page = case._repr_html_()
    assert "<td>11 x 41</td>" in page
    assert "<td>50, 250, 500 N m at the pinion</td>" in page
    assert "&lt;b&gt;mine&lt;/b&gt;" in page
    assert len(page) < 2000


def test_settings_arrive_in_radians_and_as_polynomial_coefficients() -> None:
    case = parse_case(
        replaced(NASA, r"^ratio_of_roll = .*$", "ratio_of_roll = 3.2\nmodified_roll_2c = 0.04\nmodified_roll_6d = 0.6")
    )
    settings = gear_pair(case).pinion.loaded.settings
    assert settings.cradle_angle == pytest.approx(math.radians(63.9420304635))
    assert settings.modified_roll == pytest.approx((0.02, 0.1))


def test_motions_arrive_as_polynomial_coefficients() -> None:
    text = replaced(
        NASA,
        r"^\[pinion.concave.cutter\]$",
        "[pinion.concave.machine.motions]\nsliding_base = [1.2, -0.6]\ncutter_tilt = [2.0]\n\n[pinion.concave.cutter]",
    )
    motions = dict(gear_pair(parse_case(text)).pinion.loaded.settings.motions)
    assert motions["sliding_base"] == pytest.approx((1.2, -0.3))
    assert motions["cutter_tilt"] == pytest.approx((math.radians(2.0),))


def test_formate_centre_in_cartesian_coordinates() -> None:
    formate = re.sub(r"ratio_of_roll = 1\.0516.*\n", "", NASA)
    polar = parse_case(formate)
    radial, cradle = 72.6427312, math.radians(59.2342023)
    cartesian = re.sub(
        r"radial_distance = 72\.64.*\ncradle_angle = 59\.2.*\n",
        f"horizontal_distance = {radial * math.cos(cradle)}\nvertical_distance = {radial * math.sin(cradle)}\n",
        formate,
    )
    one, two = (gear_pair(c).gear.loaded.settings for c in (polar, parse_case(cartesian)))
    assert two.radial_distance == pytest.approx(one.radial_distance, abs=1e-6)
    assert two.cradle_angle == pytest.approx(one.cradle_angle, abs=1e-9)
    assert not two.generated


MISTAKES = {
    "missing key": (r"^number_of_teeth = 12$", "", ["pinion.number_of_teeth", "missing"]),
    "unknown key": (
        r"^number_of_teeth = 12$",
        "number_of_teeth = 12\nteeth = 12",
        ["pinion.teeth", "known are", "number_of_teeth"],
    ),
    "key of a table that is off": (
        r"^\[pair\]$",
        "[pair]\nmesh_positions = 3",
        ["pair.mesh_positions", "one of [contact]"],
    ),
    "unknown table": (r"^\[pair\]$", "[gears]\n[pair]", ["gears", "known are", "pinion"]),
    "a key of earlier versions": (
        r"^\[contact\]$",
        '[compliance]\nshell_form = "thesis"\n[contact]',
        [
            "compliance.shell_form = 'thesis': is not a key of [compliance]; known are: fineness, gear_web, "
            "lengthwise_modes"
        ],
    ),
    "a key of the shell without it": (
        r"^\[contact\]$",
        '[compliance]\nplate = "even"\n[contact]',
        ['compliance: plate = \'even\': must go with model = "shell"; it is "solid_shell", the default'],
    ),
    "a key of the shell with finite elements": (
        r"^\[contact\]$",
        '[compliance]\nmodel = "fe"\nroot_factor = 0.8\n[contact]',
        ['root_factor = 0.8: must go with model = "shell"; it is "fe"'],
    ),
    "depth of the body with the shell": (
        r"^\[contact\]$",
        '[compliance]\nmodel = "shell"\nrim_depth = 8.0\n[contact]',
        ['rim_depth = (8.0, 8.0): must go with model = "solid_shell" or "fe"; it is "shell"'],
    ),
    "edges by another word": (
        r"^\[contact\]$",
        '[contact]\nedge_contact = "none"',
        ["contact.edge_contact = 'none': must be true or false"],
    ),
    "negative tooth count": (
        r"^number_of_teeth = 12$",
        "number_of_teeth = -12",
        ["number_of_teeth", "-12", "at least"],
    ),
    "fractional tooth count": (
        r"^number_of_teeth = 12$",
        "number_of_teeth = 12.5",
        ["number_of_teeth = 12.5: must be a whole number"],
    ),
    "not a number": (r"^radial_distance = .*$", "radial_distance = nan", ["radial_distance", "nan", "finite"]),
    "infinite": (r"^radial_distance = .*$", "radial_distance = inf", ["radial_distance", "inf"]),
    "text for a number": (
        r"^radial_distance = .*$",
        'radial_distance = "large"',
        ["radial_distance", "large", "number"],
    ),
    "wrong hand": (r"^hand_of_spiral = .*$", 'hand_of_spiral = "up"', ["hand_of_spiral", "up", "left", "right"]),
    "out of range": (r"^shaft_angle = .*$", "shaft_angle = 190.0", ["shaft_angle", "190", "175"]),
    "cones the wrong way": (r"^face_angle = .*$", "face_angle = 10.0", ["face_angle", "10", "root_angle"]),
    "face too wide": (r"^face_width = .*$", "face_width = 100.0", ["face_width", "100", "outer_cone_distance"]),
    "negative torque": (r"^torques = .*$", "torques = [50.0, -1.0]", ["torques", "-1", "at least 1e-06"]),
    "no torque": (r"^torques = .*$", "torques = []", ["contact.torques = []: must have at least 1 value"]),
    "true for a number": (r"^shaft_angle = .*$", "shaft_angle = true", ["pair.shaft_angle = true: must be a number"]),
    "a number in quotes": (r"^shaft_angle = .*$", 'shaft_angle = "90"', ["pair.shaft_angle = '90': must be a number"]),
    "true for a torque": (r"^torques = .*$", "torques = [true]", ["a mistake", "torques.0 = true: must be a number"]),
    "a table for a torque": (r"^torques = .*$", "torques = [{x = 1}]", ["a mistake", "torques.0 = {x = 1}: must be"]),
    "a torque in quotes": (r"^torques = .*$", 'torques = ["50"]', ["a mistake", "torques.0 = '50': must be a number"]),
    "true for a count": (r"^number_of_teeth = 12$", "number_of_teeth = true", ["true: must be a whole number"]),
    "a number for text": (r"^title = .*$", "title = 3", ["title = 3: must be text in quotes"]),
    "a number for a choice": (r"^hand_of_spiral = .*$", "hand_of_spiral = 3", ["= 3: must be 'left' or 'right'"]),
    "true for depths": (r"^\[contact\]$", "[compliance]\nrim_depth = true\n[contact]", ["rim_depth.0 = true: must be"]),
    "one torque twice": (r"^torques = .*$", "torques = [50.0, 60.0, 50]", ["torques contains 50.0 twice"]),
    "a torque that is no list": (r"^torques = .*$", "torques = 50.0", ["contact.torques = 50.0", "list in brackets"]),
    "torque zero": (r"^torques = .*$", "torques = [0.0]", ["torques", "0.0", "at least 1e-06"]),
    "modified roll without roll": (r"^ratio_of_roll = .*$", "modified_roll_2c = 0.1", ["ratio_of_roll"]),
    "centre missing": (r"^radial_distance = .*$", "", ["radial_distance and cradle_angle"]),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes_name_key_value_and_what_is_allowed(name: str) -> None:
    pattern, replacement, words = MISTAKES[name]
    with pytest.raises(InputError) as caught:
        parse_case(replaced(NASA, pattern, replacement), "mycase.toml")
    message = str(caught.value)
    assert "mycase.toml" in message
    for word in words:
        assert word in message, message
    for foreign in ("pydantic", "validation", "input should", "tuple"):
        assert foreign not in message, message


def test_whole_numbers_are_numbers() -> None:
    case = parse_case(replaced(NASA, r"^torques = .*$", "torques = [50, 150]"))
    assert case.contact.torques == (50.0, 150.0)


def test_several_mistakes_come_in_one_message() -> None:
    text = NASA.replace("number_of_teeth = 12", "number_of_teeth = 1").replace(
        "shaft_angle = 90.0", "shaft_angle = 0.0"
    )
    with pytest.raises(InputError, match="2 mistakes") as caught:
        parse_case(text)
    assert len(str(caught.value).splitlines()) == 3


def test_a_file_that_is_not_toml() -> None:
    with pytest.raises(InputError, match="not a TOML file"):
        parse_case("this is no case", "x")


def test_an_unknown_name_lists_the_shipped_cases() -> None:
    with pytest.raises(InputError, match="nasa-12x36"):
        read_case("nasa-12x37")


def test_flanks_that_the_case_does_not_have() -> None:
    case = read_case("nasa-12x36")
    drive_only = case.model_copy(update={"gear": case.gear.model_copy(update={"concave": None})})
    with pytest.raises(InputError, match=r"\[gear.concave\]"):
        gear_pair(drive_only, "coast")


def test_a_case_with_the_loaded_flanks_alone_runs() -> None:
    """The other flank is then assumed; the teeth differ little from the true ones."""
    case = read_case("nasa-12x36")
    bare = case.model_copy(
        update={
            "gear": case.gear.model_copy(update={"concave": None}),
            "pinion": case.pinion.model_copy(update={"convex": None}),
        }
    )
    true, assumed = (pair_geometry(gear_pair(c), (9, 7)).teeth["plate_thickness"] for c in (case, bare))
    change = abs(assumed / true - 1.0)
    assert change.sel(plate_edge="root").max() < 0.1
    assert change.max() < 0.5  # thin tips feel the unknown pressure angle most


def test_settings_with_no_tooth_in_the_blank() -> None:
    case = parse_case(replaced(NASA, r"^machine_root_angle = .*$", "machine_root_angle = 100.0"))
    with pytest.raises(GeometryError, match="no tooth in this blank"):
        pair_geometry(gear_pair(case), (9, 7))


def test_every_number_has_a_unit_in_its_documentation() -> None:
    schema = Case.model_json_schema()
    for name, table in schema["$defs"].items():
        for key, entry in table["properties"].items():
            options = [entry, *entry.get("anyOf", [])]
            if any(o.get("type") in ("number", "integer") for o in options):
                assert "unit" in entry, f"{name}.{key} has no unit"
                assert f"[{entry['unit']}]" in entry["description"]


def test_errors_share_one_base() -> None:
    assert issubclass(InputError, EaseoffError)
    assert issubclass(GeometryError, EaseoffError)


BASIC_DATA = """
[blank_design]
method = 1
process = "face_milled"
pinion_mean_spiral_angle = 40.5
gear_outer_pitch_diameter = 211.8355
gear_face_width = 34.5
cutter_radius = 95.25
limit_pressure_angle_influence = 0.0
gear_mean_addendum_factor = 0.2
depth_factor = 2.0
clearance_factor = 0.125
thickness_factor = 0.1
depth_taper = "modified_slot_width"
"""


def with_basic_data(basic_data: str = BASIC_DATA) -> str:
    """The case fm-11x41 with its blanks as basic data."""
    text = case_text("fm-11x41")
    text = re.sub(r"\[(pinion|gear)\.blank\]\n(.+\n)+", "", text)
    return text.replace("\n[misalignment]\n", f"{basic_data}\n[misalignment]\n", 1)


def test_basic_data_make_the_same_pair_as_the_blanks_they_stand_for() -> None:
    """The blanks of fm-11x41 come from these basic data and stand in its file with ten digits."""
    given, designed = gear_pair(read_case("fm-11x41")), gear_pair(parse_case(with_basic_data()))
    for one, two in ((given.pinion, designed.pinion), (given.gear, designed.gear)):
        for key, value in vars(one.section).items():
            if isinstance(value, float):
                assert getattr(two.section, key) == pytest.approx(value, abs=1e-9), key


BLANK_MISTAKES = {
    "no blank": (with_basic_data(""), ["[pinion.blank]", "missing", "[blank_design]"]),
    "both": (
        case_text("fm-11x41").replace("\n[misalignment]\n", f"{BASIC_DATA}\n[misalignment]\n"),
        ["both given", "[blank_design]"],
    ),
    "missing diameter": (
        with_basic_data(BASIC_DATA.replace("gear_outer_pitch_diameter = 211.8355\n", "")),
        ["[blank_design]", "gear_outer_pitch_diameter", "method 1 needs it"],
    ),
    "method without a process": (
        with_basic_data(BASIC_DATA.replace("method = 1", "method = 3").replace("pinion_mean", "gear_mean")),
        ["[blank_design]", "process", "face_hobbed"],
    ),
    "unknown method": (with_basic_data(BASIC_DATA.replace("method = 1", "method = 7")), ["blank_design.method", "7"]),
    "no pitch cones": (
        with_basic_data(BASIC_DATA.replace("cutter_radius = 95.25", "cutter_radius = 9.0")),
        ["[blank_design]", "cutter_radius"],
    ),
    "too wide": (
        with_basic_data(BASIC_DATA.replace("gear_face_width = 34.5", "gear_face_width = 300.0")),
        ["[blank_design]"],
    ),
}


@pytest.mark.parametrize("name", BLANK_MISTAKES)
def test_mistakes_in_basic_data_name_the_key(name: str) -> None:
    text, words = BLANK_MISTAKES[name]
    with pytest.raises(EaseoffError) as caught:
        parse_case(text, "mycase.toml")
    for word in ["mycase.toml", *words]:
        assert word in str(caught.value), str(caught.value)


def test_a_case_takes_solid_shells_and_edges_unless_it_says_otherwise() -> None:
    """Shells and lines alone on asking, with their keys; a case in full is a case again."""
    case = read_case("fm-11x41")
    assert case.compliance.model == "solid_shell"
    assert case.contact.edge_contact
    text = case_text("fm-11x41").replace("[contact]\n", "[contact]\nedge_contact = false\n")
    shells = parse_case(text + '\n[compliance]\nmodel = "shell"\nplate = "fitted"\nroot = "odonnell"\n')
    assert shells.compliance.plate == "fitted"
    assert not shells.contact.edge_contact
    for whole in (case, shells):
        assert Case.model_validate(whole.model_dump()).model_dump() == whole.model_dump()


# Case files that the package writes: they read as the case they were written from, to the last digit


@pytest.mark.parametrize("name", shipped_cases())
def test_shipped_cases_survive(name: str) -> None:
    case = read_case(name)
    assert parse_case(case_toml(case)).model_dump() == case.model_dump()


@settings(max_examples=settings().max_examples // 2)
@given(cases())
def test_any_case_survives(case: Case) -> None:
    text = case_toml(case)
    assert parse_case(text).model_dump() == case.model_dump()
    assert case_toml(parse_case(text)) == text


def test_only_what_says_something_is_written_and_in_the_order_of_the_schema() -> None:
    case = read_case("nasa-12x36")
    data = tomllib.loads(case_toml(case))
    assert list(data) == ["easeoff_case", "title", "description", "pair", "pinion", "gear", "contact"]
    assert data["pair"] == {}  # must be there, but says nothing that is not the default
    assert list(data["contact"]) == ["torques"]
    assert "pitch_apex_beyond_crossing_point" not in data["pinion"]["blank"]
    assert "work_offset" not in data["gear"]["convex"]["machine"]
    assert data["pinion"]["concave"]["cutter"]["blade_point_radius"] == 75.3267830027
    assert "motions" not in data["pinion"]["concave"]["machine"]


@given(st.text(max_size=80))
def test_a_comment_stays_a_comment(comment: str) -> None:
    case = read_case("nasa-12x36")
    text = case_toml(case, comment)
    assert parse_case(text).model_dump() == case.model_dump()


def test_comment_lines_stand_at_the_top() -> None:
    assert case_toml(read_case("nasa-12x36"), "one\n\ntwo").startswith("# one\n#\n# two\neaseoff_case = 2\n")


def test_a_file_is_whole_or_not_there(tmp_path: Path) -> None:
    case = read_case("fm-11x41")
    write_case(case, tmp_path / "new" / "pair.toml", "made by a test")
    assert read_case(tmp_path / "new" / "pair.toml").model_dump() == case.model_dump()
    assert [p.name for p in (tmp_path / "new").iterdir()] == ["pair.toml"]
    with pytest.raises(InputError, match="folder"):
        write_case(case, tmp_path)


def test_given_pair_is_that_of_the_drive_side_where_the_case_has_it() -> None:
    case = read_case("nasa-12x36")
    assert given_pair(case) == gear_pair(case, "drive")


@pytest.mark.parametrize(("given_name", "shown"), [("fm-11x41", "fm-11x41"), ("cases/mine.toml", "mine")])
def test_name_of_a_case_is_that_of_its_file(given_name: str, shown: str) -> None:
    assert stem(given_name) == shown
