"""Summary sheets: settings are multiples of their steps, and the stated effect is that of the rounded settings."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from extreme_designs import EXTREMES
from pairs import by_the_dissertation
from runs import call, output_of, text_file
from shared import Shared, replace_everywhere

from easeoff import InputError
from easeoff.cases import (
    Case,
    case_toml,
    design_text,
    designed_blanks,
    gear_pair,
    parse_case,
    parse_design,
    read_case,
    read_design,
    read_rexs,
    shipped_cases,
    write_case,
)
from easeoff.cases.schema.case_schema import motion_name, usual_name
from easeoff.cases.writing import changed_case, with_blanks
from easeoff.geometry import MachineResolution, ease_off
from easeoff.geometry.pair.gear_pair import tooth_angles
from easeoff.geometry.pair.tooth_thickness import filling_thickness
from easeoff.geometry.tooth.tooth_flanks import placed_flanks
from easeoff.study import DesignReport, design_case, rounded_case, rounding_effect, summary_sheet, vh_check
from easeoff.study.design.design_check import ToothSpaces, case_warnings, rounding_limits, unusual_set_ups
from easeoff.study.design.rounded_settings import FLANKS, step_of_key
from easeoff.study.summary.blank_drawing import ROWS, case_backlash

SIDES: tuple[Any, Any] = ("drive", "coast")
COARSE = MachineResolution(length=0.02, angle=0.02, blade_radius=0.05, blade_angle=0.25, edge_radius=0.1)


@cache
def checked(text: str) -> tuple[ToothSpaces | None, tuple[str, ...]]:
    return case_warnings(parse_case(text))


@pytest.fixture(scope="module", autouse=True)
def rounded_once() -> Iterator[None]:
    """What rounding does to a case is computed once, for its sheet and beside it."""
    with pytest.MonkeyPatch.context() as patch:
        once = Shared().once(rounding_effect)
        replace_everywhere(patch, rounding_effect, once)
        patch.setitem(globals(), "rounding_effect", once)
        yield


@pytest.fixture(autouse=True)
def teeth_are_checked_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of all sheets of one case."""
    monkeypatch.setattr("easeoff.study.summary.summary_sheet.case_warnings", lambda case: checked(case_toml(case)))


@pytest.mark.parametrize("name", list(shipped_cases()))
@pytest.mark.quick(2)
def test_rounded_settings_are_multiples_of_their_steps(name: str) -> None:
    """Within half a step of what they were; rounding again changes nothing, and the case file keeps them."""
    case = read_case(name)
    rounded = rounded_case(case, COARSE)
    for member in ("pinion", "gear"):
        for flank in ("concave", "convex"):
            before, after = (getattr(getattr(each, member), flank) for each in (case, rounded))
            if before is None:
                assert after is None
                continue
            keys = [(table, key) for table in ("machine", "cutter") for key, _ in getattr(before, table)]
            for table, key in keys:
                old, new = (getattr(getattr(each, table), key) for each in (before, after))
                step = step_of_key(COARSE, table, key)
                if old is None or step is None:
                    assert new == old
                    continue
                assert new / step == pytest.approx(round(new / step), abs=1e-7), key
                assert abs(new - old) <= 0.5 * step * (1 + 1e-9), key
    assert rounded_case(rounded, COARSE).model_dump() == rounded.model_dump()
    assert parse_case(case_toml(rounded)).model_dump() == rounded.model_dump()


def ease_off_change(case: Case, other: Case, side: Any) -> float:
    """Greatest change of the ease-off [mm] beside a rotation, on a grid that no statement used."""
    before, after = (ease_off(gear_pair(each, side), (13, 9)) for each in (case, other))
    known = before["inside"].values.astype(bool) & after["inside"].values.astype(bool)
    lever = before["lever_arm"].values[known]
    change = 1e-3 * (after["ease_off"].values - before["ease_off"].values)[known]
    return float(np.abs(change - lever * (lever @ change) / (lever @ lever)).max())


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("name", ["fm-11x41", "fh-design-a"])
@pytest.mark.quick(2)
def test_rounded_settings_analysed_anew_are_within_the_stated_effect(name: str, side: Any) -> None:
    """By the public ease-off on a grid that the statement did not use."""
    case = read_case(name)
    rounded = rounded_case(case, COARSE)
    stated = rounding_effect(case, rounded)[side]
    assert 0.5 * stated < ease_off_change(case, rounded, side) < 1.2 * stated


def test_effect_falls_with_the_steps() -> None:
    """Linearly: a tenth of the steps leaves about a tenth, and steps below the file's rounding nothing."""
    case = read_case("fm-11x41")
    fine = MachineResolution(*(1e-9,) * 9)
    assert max(rounding_effect(case, rounded_case(case, fine)).values()) < 1e-7
    usual, coarse = (max(rounding_effect(case, rounded_case(case, each)).values()) for each in (None, COARSE))
    assert usual < 1e-3 < coarse


class _Cells(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.cells: list[str] = []

    def handle_data(self, data: str) -> None:
        if data.strip():
            self.cells.append(data.strip())


def test_sheet_holds_the_settings_as_text_and_as_a_page() -> None:
    case = read_case("fm-11x41")
    made = summary_sheet(case)
    page = _Cells()
    page.feed(made.page())
    concave = rounded_case(case).pinion.concave
    assert concave is not None
    for value in (f"{concave.machine.radial_distance:.3f}", f"{concave.machine.cutter_tilt:.3f}"):
        assert value in made.text()
        assert value in page.cells
    for word in ("machine centre to back", "machine_center_to_crossing_point", "point width", "modified roll 2C"):
        assert word in made.text()
        assert word in page.cells
    for side, effect in rounding_effect(case, rounded_case(case)).items():
        assert f"{side}: rounding the settings changes the ease-off by up to {1e3 * effect:.2f} um" in made.text()
    assert "Positive: basic cradle angle, from the root line to the cutter centre" in made.text()


def test_sheet_tells_the_place_of_the_cutter_of_a_formate_gear() -> None:
    """Horizontal and vertical, whose hypotenuse is the radial setting; none of generated members."""
    rows = {row[0]: row for row in summary_sheet(read_case("fm-11x41")).tables["Machine settings"]}
    places = [np.array(rows[f"{name} (Formate)"][6:], dtype=float) for name in ("horizontal", "vertical")]
    assert np.hypot(places[0], places[1]) == pytest.approx([float(one) for one in rows["radial setting"][6:]], abs=1e-3)
    assert rows["vertical (Formate)"][4:6] == ("-", "-")
    generated = {row[0]: row for row in summary_sheet(by_the_dissertation("nasa-12x36")).tables["Machine settings"]}
    assert "-" not in generated["ratio of roll"]
    assert "vertical (Formate)" not in generated


PLACE = 2.3610377387, 4.35  # of the gear blank along its axis, as shipped and moved [mm]


def doubtful() -> Case:
    """A gear blank moved along its axis, and edge radii too large for its slot."""
    changes = {"machine.machine_center_to_crossing_point": PLACE[1], "cutter.tool_edge_radius": 2.0}
    numbers = {f"gear.{flank}.{key}": value for flank in FLANKS for key, value in changes.items()}
    return changed_case(by_the_dissertation("fm-11x41"), numbers)


def test_sheet_tells_blade_tips_off_the_root_cone() -> None:
    """A blank moved along its axis by a takes its root cone a sin(root angle) away from the tips, at the root line."""
    away = (PLACE[1] - PLACE[0]) * np.sin(np.radians(67.0896087038))
    made = summary_sheet(doubtful(), MachineResolution(length=0.05, angle=0.002))
    rows = {row[0]: row for row in made.tables["Teeth and slots"]}
    told = [note for note in made.notes if "the gear's blade tips deviate" in note]
    assert [note.split()[1] for note in told] == ["drive:", "coast:"]
    for flank, note in zip(("convex", "concave"), told, strict=True):
        path = [float(gap) for gap in rows[f"gear {flank}: blade tip above the root cone"][2].split(" / ")]
        assert path[1] == pytest.approx(away, rel=0.01)
        greatest = float(re.findall(r"up to ([0-9.]+) mm", note)[0])
        assert greatest == pytest.approx(max(path), abs=0.006)
        assert away <= greatest < 1.25 * away


def test_command_writes_sheets_that_tell_what_is_doubtful_of_the_teeth(tmp_path: Path) -> None:
    """Edge radii too large for the slot: text, page and terminal say so; the exit code stays 0."""
    write_case(doubtful(), tmp_path / "case.toml")
    for name in ("sheet.txt", "sheet.html", "sheet.rexs"):
        path = tmp_path / name
        outcome = call(
            "sheet", tmp_path / "case.toml", "-o", path, "--resolution", "length=0.05,angle=0.002", "--without-vh"
        )
        assert outcome.exit_code == 0, outcome.output
        assert "ease-off by up to" in outcome.output
        assert "Warning: the gear's fillet reaches" in outcome.stderr
        if name != "sheet.rexs":
            text = path.read_text(encoding="utf-8")
            assert 0 < text.index("Warning: the fillets of the gear") < text.index("Blanks")
            assert "0.05" in text
    assert not any("Warning" in note for note in summary_sheet(by_the_dissertation("nasa-12x36")).notes)


def test_sheet_shows_formulas_teeth_and_their_difference() -> None:
    text = summary_sheet(by_the_dissertation("nasa-12x36")).text()
    row = next(line for line in text.splitlines() if line.startswith("gear slot width"))
    numbers = [float(value) for value in re.findall(r"[+-]?\d+\.\d+", row)]
    assert len(numbers) == 9
    assert np.allclose(np.array(numbers[3:6]) - numbers[:3], numbers[6:], atol=2e-3)
    assert "blade tip above the root cone" in text
    assert "edge radius: greatest" in text


def test_half_a_pair_says_that_its_teeth_are_not_checked() -> None:
    case = read_case("nasa-12x36")
    half = case.model_copy(update={"gear": case.gear.model_copy(update={"concave": None})})
    assert [note for note in summary_sheet(half).notes if "are not checked" in note]


def test_sheet_tells_set_ups_that_no_method_of_the_shop_makes() -> None:
    """Tilt beside modified roll, unless one machine cuts both flanks, as completing does."""
    case = read_case("fm-11x41")
    assert case.pinion.concave is not None
    assert case.pinion.convex is not None
    note, doubt = summary_sheet(case).notes
    assert "concave and convex" in note
    assert "the thickness of the teeth of the pinion is not given" in doubt
    upright = {f"pinion.concave.machine.{key}": 0.0 for key in ("modified_roll_2c", "modified_roll_6d")}
    (note,) = unusual_set_ups(changed_case(case, upright))
    assert "pinion's convex flank has" in note
    convex = case.pinion.convex.model_copy(update={"machine": case.pinion.concave.machine})
    assert unusual_set_ups(case.model_copy(update={"pinion": case.pinion.model_copy(update={"convex": convex})})) == ()
    rolled = {f"pinion.{flank}.machine.cutter_tilt": 0.0 for flank in FLANKS}
    assert unusual_set_ups(changed_case(case, rolled)) == ()


def _tables(page: str) -> dict[str, list[list[str]]]:
    """Tables of a page by heading, read as XML, in texts of cells."""
    body = ET.fromstring(page.replace("<!DOCTYPE html>", "").replace('<meta charset="utf-8">', "")).find("body")
    assert body is not None
    found: dict[str, list[list[str]]] = {}
    heading = ""
    for element in body:
        if element.tag == "h2":
            heading = element.text or ""
        if element.tag == "table":
            found[heading] = [["".join(cell.itertext()).strip() for cell in row] for row in element.iter("tr")]
    return found


def _text_tables(text: str) -> dict[str, list[list[str]]]:
    """The same of the sheet as text: columns stand where the dashes of the rule stand."""
    found: dict[str, list[list[str]]] = {}
    lines = text.splitlines()
    for number in (n for n, line in enumerate(lines) if line.startswith("---")):
        columns = [match.span() for match in re.finditer("-+", lines[number])]
        last = next(n for n in range(number, len(lines)) if not lines[n].strip())
        rows = [lines[number - 1], *lines[number + 1 : last]]
        found[lines[number - 3]] = [[row[low:high].strip() for low, high in columns] for row in rows]
    return found


def _read_back(folder: Path, case: Case) -> None:
    """Every number of a sheet, in all three files, is that of the case within half its step."""
    path = folder / "case.toml"
    write_case(case, path)
    for suffix in ("txt", "html", "rexs"):
        outcome = call("sheet", path, "-o", folder / f"sheet.{suffix}", "--without-vh")
        assert outcome.exit_code == 0, outcome.output
    page = _tables((folder / "sheet.html").read_text(encoding="utf-8"))
    text = _text_tables((folder / "sheet.txt").read_text(encoding="utf-8"))
    assert page == text
    whole = with_blanks(case)
    for label, *row in page["Blanks"][1:]:
        key = label.replace(" ", "_")
        for name, shown in zip(("pinion", "gear"), row[1:], strict=True):
            member, blank = getattr(whole, name), getattr(whole, name).blank
            if key in ("number_of_teeth", "hand_of_spiral"):
                hand = case.pinion.hand_of_spiral
                other = "left" if hand == "right" else "right"
                wanted = {
                    "number_of_teeth": str(member.number_of_teeth),
                    "hand_of_spiral": (hand, other)[name == "gear"],
                }
                assert shown == wanted[key]
            else:
                value = getattr(whole.pair, key, None)
                assert float(shown) == pytest.approx(getattr(blank, key) if value is None else value, abs=5.001e-5)
    again, _ = read_rexs(folder / "sheet.rexs")
    seen = 0
    for heading, table in (("Cutters", "cutter"), ("Machine settings", "machine")):
        head, *rows = page[heading]
        flanks = [name.split() for name in head[4:]]
        order: dict[str, int] = {}
        for _, dotted, _, step, *cells in rows:
            moves, _, key = dotted.rpartition(".")
            if not key:
                continue
            order[dotted] = order.get(dotted, -1) + 1
            for (member, side), shown in zip(flanks, cells, strict=True):
                values, read = (getattr(getattr(getattr(each, member), side), table) for each in (case, again))
                if moves:
                    values, read = (getattr(each.motions, key) for each in (values, read))
                    place = order[dotted]
                    value, back = (each[place] if place < len(each) else 0.0 for each in (values, read))
                else:
                    value, back = getattr(values, key), getattr(read, key)
                if shown == "-":
                    assert value is None
                    continue
                reach = 0.5 * float(step) * (1 + 1e-6) if step != "-" else 1e-6 * abs(value)
                assert abs(float(shown) - value) <= reach, (dotted, shown, value)
                assert back == pytest.approx(float(shown), abs=1e-9, rel=1e-9), (dotted, shown, back)
                seen += 1
    assert seen >= 30


@pytest.mark.parametrize("name", sorted(shipped_cases(), reverse=True))
@pytest.mark.quick(2)
def test_sheet_reads_back_as_the_case(name: str, tmp_path: Path) -> None:
    _read_back(tmp_path, by_the_dissertation(name))


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "method"),
    [
        ("ratio 6", "modified_roll"),
        ("shaft angle 75, generated", "fixed_setting"),
        ("wide hypoid offset", "tilt"),
        ("module 0.5, hobbed", "completing"),
        ("uniform depth, generated", "completing"),
        ("Zerol", "closest_fit"),
    ],
)
def test_sheet_of_a_design_reads_back_within_its_stated_effect(name: str, method: str, tmp_path: Path) -> None:
    """Rounded settings are analysed anew on another grid than the statement's."""
    case, _ = design_case(parse_design(EXTREMES[name].text(method)))
    _read_back(tmp_path, case)
    again, _ = read_rexs(tmp_path / "sheet.rexs")
    stated = rounding_effect(case, rounded_case(case))
    for side in SIDES:
        assert ease_off_change(case, again, side) < 1.2 * stated[side]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["sheet", "fm-11x41", "-o", "x.pdf"], ["x.pdf", ".txt, .html or .rexs"]),
        (["sheet", "fm-11x41", "-o", "x.txt", "--resolution", "tilt=1"], ["'tilt'", "must be one of", "angle"]),
        (["sheet", "fm-11x41", "-o", "x.txt", "--resolution", "angle=0"], ["resolution of angle = 0", "above 0"]),
        (["design", "fm-11x41", "-o", "x.toml", "--resolution", "angle=0.1"], ["--resolution", "--round"]),
    ],
)
def test_mistakes_are_told(arguments: list[str], words: list[str], tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    outcome = call(*arguments)
    assert outcome.exit_code == 2
    for word in words:
        assert word in outcome.output
    assert list(tmp_path.iterdir()) == []


@pytest.mark.thorough
def test_design_writes_rounded_settings(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    outcome = call("design", "fh-design-a", "-o", path, "--round")
    assert outcome.exit_code == 0, outcome.output
    assert "coast: rounding the settings changes the ease-off by up to" in outcome.output
    case = read_case(path)
    assert rounded_case(case).model_dump() == case.model_dump()


def test_steps_must_be_positive() -> None:
    with pytest.raises(InputError, match="resolution of length = 0"):
        MachineResolution(length=0.0)


def test_settings_of_a_designed_pinion_are_rounded_within_their_limits() -> None:
    """Inwards where the nearest step is beyond a limit; without a step between its limits a setting stays as it is."""
    case = read_case("fm-11x41")
    concave = case.pinion.concave
    assert concave is not None
    tilt, radial = concave.machine.cutter_tilt, concave.machine.radial_distance
    assert radial is not None
    steps = MachineResolution(angle=0.02, length=0.01)
    nearest = rounded_case(case, steps).pinion.concave
    assert nearest is not None
    assert nearest.machine.cutter_tilt > tilt
    limits = {"cutter_tilt": (0.0, math.radians(tilt)), "radial_distance": (radial, radial)}
    found = rounded_case(case, steps, limits)
    assert found.pinion.concave is not None
    assert found.pinion.concave.machine.cutter_tilt == pytest.approx(nearest.machine.cutter_tilt - 0.02, abs=1e-9)
    assert found.pinion.concave.machine.radial_distance == radial
    assert found.gear == rounded_case(case, steps).gear


def test_edge_radii_of_a_design_become_smaller_by_rounding_but_stay_fillets() -> None:
    """The nearest step is larger than what tooth and blade allow; below the smallest fillet there is none."""
    case, design = read_case("fm-11x41"), read_design("fm-11x41")
    blank = designed_blanks(design.blank_design, (11, 41), design.pair)
    least = 0.05 * blank.mean_normal_module
    report = DesignReport(blank, sides={}, warnings=())
    for radius, rounded in ((0.936, 0.93), (0.93, 0.93), (least + 1e-4, least + 1e-4), (0.001, 0.001)):
        keys = [f"{name}.{side}.cutter.tool_edge_radius" for name in ("pinion", "gear") for side in FLANKS]
        cut = changed_case(case, dict.fromkeys(keys, radius))
        found = rounded_case(cut, None, *rounding_limits(design, report, cut)).model_dump()
        assert [found[a][b][c][d] for a, b, c, d in (key.split(".") for key in keys)] == [rounded] * 4


@pytest.mark.thorough
def test_limits_of_a_design_reach_its_rounding(tmp_path: Path) -> None:
    """A tilt at its limit stays within it, as written."""
    text = design_text("fh-design-a").replace("follow_root = true", 'method = "tilt"')
    path = text_file(tmp_path / "d.toml", text + "\n[pinion.limits]\ncutter_tilt = 15.0006\n")
    output_of("design", path, "-o", tmp_path / "c.toml", "--round")
    tilts = [getattr(read_case(tmp_path / "c.toml").pinion, side).machine.cutter_tilt for side in FLANKS]
    assert max(tilts) <= 15.0006
    assert min(tilts) == 15.0


def test_settings_and_their_motions_have_the_usual_names() -> None:
    assert [usual_name(key) for key in ("cutter_tilt", "hypoid_offset")] == ["tilt", "hypoid offset"]
    assert [motion_name(key) for key in ("sliding_base", "cutter_tilt")] == ["helical motion", "motion of tilt"]


# --- What a shop makes and inspects


SHIFTED = ("pinion away from the crossing point", "gear away from the crossing point")


@cache
def drawn() -> tuple[Case, dict[str, dict[str, tuple[str, ...]]]]:
    """A pair with a title block whose pinion is 0.15 mm thinner than the slot; cells of its sheet by table and row."""
    case = by_the_dissertation("fh-design-a")
    thickness = {"mid_flank_normal_circular_thickness": filling_thickness(gear_pair(case)) - 0.15}
    drawing = {"drawing_number": "4711-02", "revision": "B", "accuracy_grade": 6, "pinion_mounting_distance": 120.0}
    tolerances = {"mounting_tolerance": 0.03, "thickness_tolerance": 0.04}
    contact = {"mesh_positions": 6, "lengthwise_nodes": 15, "profile_nodes": 11}
    case = case.with_tables(pinion=thickness, drawing=drawing | tolerances, contact=contact)
    sheet = summary_sheet(case)
    assert "drawing 4711-02, revision B, ISO 17485 grade 6" in sheet.text()
    assert sheet.tables["Dimensions"][1] == ("mounting distance", "mm", "120.000 ± 0.03", "-")
    return case, {heading: {row[0].strip(): row[1:] for row in rows} for heading, rows in sheet.tables.items()}


def test_sheet_has_the_backlash_of_a_thinner_pinion() -> None:
    """Between the flanks at the heel where both sides are in contact; elsewhere more, by both transmission errors."""
    _, tables = drawn()
    unit, least, greatest = tables["Backlash"]["normal backlash at the heel"]
    assert unit == "mm"
    assert float(least) == pytest.approx(0.15, rel=0.06)  # a mid-flank arc, seen at the heel of the gear
    assert float(least) < float(greatest) < float(least) + 0.02
    _, low, high = tables["Backlash"]["with the tolerances"]
    run_out = sum(map(float, tables["Tolerances by ISO 17485"]["run-out F_rT"][1:])) * 1e-3 * math.sin(math.radians(20))
    shims = [max(map(float, tables["Backlash"][f"change by 0.1 mm, {each}"][1:])) for each in SHIFTED]
    assert float(low) == pytest.approx(float(least) - 0.3 * sum(shims) - run_out, abs=3e-3)
    # Two teeth thinner by 0.04 mm at the mean point, seen at the heel between the flanks.
    assert float(high) - float(greatest) == pytest.approx(0.3 * sum(shims) + run_out + 0.08, abs=0.01)


@pytest.mark.thorough
def test_design_leaves_the_backlash_that_it_asked_for() -> None:
    """ISO 23509 takes half of it off each tooth; measured on the flanks it is there, least over the mesh cycle."""
    design = read_design("axle-hobbed-11x39")
    basic = design.blank_design.model_copy(update={"outer_normal_backlash": 0.15})
    shells = design.compliance.model_copy(update={"model": "shell"})
    case, _ = design_case(design.model_copy(update={"blank_design": basic, "compliance": shells}))
    assert float(case_backlash(case)["outer_normal_backlash"].min()) == pytest.approx(0.15, abs=0.006)


def test_thicknesses_and_backlash_add_up_to_the_pitch() -> None:
    """Both normal circular thicknesses at the mean point and the backlash, as an arc: to the ease-off of the flanks."""
    _, tables = drawn()
    rows = tables["Dimensions"]
    thickness = sum(map(float, rows["mean normal circular thickness s_mn"][1:]))
    module, spiral = (float(rows[name][2]) for name in ("mean normal module m_mn", "mean spiral angle"))
    least = float(tables["Backlash"]["transverse backlash at the mean point"][1]) * math.cos(math.radians(spiral))
    assert thickness + least == pytest.approx(math.pi * module, abs=0.03)


@pytest.mark.parametrize("name", ["pinion", "gear"])
def test_chordal_thickness_is_the_distance_of_both_flanks(name: str) -> None:
    """Least distance of the traces of both flanks of a tooth on the pitch cone, through the mean point of one."""
    case, tables = drawn()
    pair = gear_pair(case)
    member = getattr(pair, name)
    number = ("pinion", "gear").index(name)
    distance = float(tables["Dimensions"]["mean cone distance R_m"][1 + number])
    flanks = placed_flanks(member, tooth_angles(pair)[number])
    along = distance + np.linspace(-12.0, 12.0, 801)
    traces = [each.at(*member.section.on_pitch_cone(along[:, None]).T).position for each in flanks.values()]
    apart = np.linalg.norm(traces[0][:, :, None] - traces[1][:, None, :], axis=0)
    # The chord whose middle is at the mean cone distance, not that where the tooth is thinnest.
    middle = 0.5 * (along[:, None] + along[None, :])
    near = np.abs(middle - distance) < 0.02
    chord = float(apart[near].min())
    assert chord == pytest.approx(
        float(tables["Dimensions"]["mean normal chordal thickness s_mnc"][1 + number]), rel=0.004
    )


def test_blank_dimensions_are_those_of_the_standard() -> None:
    """Measured on the case, against ISO 23509 from the basic data: two ways to the same blank."""
    _, tables = drawn()
    design = read_design("fh-design-a")
    blanks = designed_blanks(design.blank_design, (12, 41), design.pair)
    for key in ("outer_pitch_diameter", "outer_tip_diameter", "outer_whole_depth", "crown_distance", "mean_addendum"):
        for number, member in enumerate((blanks.pinion, blanks.gear)):
            shown = float(tables["Dimensions"][ROWS[key][0]][1 + number])
            assert shown == pytest.approx(getattr(member, key), abs=2e-3)


@pytest.mark.thorough
def test_v_h_check_stands_on_the_sheet() -> None:
    case = by_the_dissertation("fh-design-a").with_tables(contact={"mesh_positions": 4})
    check = vh_check(case)
    sheet = summary_sheet(case, vh_checks={"drive": check})
    assert [row[0] for row in sheet.tables["V-H check, drive"][1:]] == ["toe", "middle", "heel"]
    assert f"total V {float(check['total_v']):+.3f} mm" in sheet.text()
