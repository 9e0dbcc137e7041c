"""Summary sheets: settings are multiples of their steps, and the stated effect is that of the rounded settings."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from easeoff import InputError
from easeoff.cases import case_toml, gear_pair, parse_case, read_case, shipped_cases, write_case
from easeoff.cases.changes import changed_case
from easeoff.geometry import MachineResolution, ease_off
from easeoff.study import rounded_case, rounding_effect, summary_sheet
from easeoff.study.cli import main
from easeoff.study.design.pair_warnings import case_warnings, unusual_set_ups
from easeoff.study.design.rounded_settings import FLANKS, step_of_key

SIDES: tuple[Any, Any] = ("drive", "coast")
COARSE = MachineResolution(length=0.02, angle=0.02, blade_radius=0.05, blade_angle=0.25, edge_radius=0.1)


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


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("name", ["fm-11x41", "fh-design-a"])
@pytest.mark.quick(2)
def test_rounded_settings_analysed_anew_are_within_the_stated_effect(name: str, side: Any) -> None:
    """By the public ease-off on a grid that the statement did not use."""
    case = read_case(name)
    rounded = rounded_case(case, COARSE)
    stated = rounding_effect(case, rounded)[side]
    before, after = (ease_off(gear_pair(each, side), (13, 9)) for each in (case, rounded))
    known = before["inside"].values.astype(bool) & after["inside"].values.astype(bool)
    lever = before["lever_arm"].values[known]
    change = 1e-3 * (after["ease_off"].values - before["ease_off"].values)[known]
    change = change - lever * (lever @ change) / (lever @ lever)
    assert 0.5 * stated < np.abs(change).max() < 1.2 * stated


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
    assert re.search(r"drive: rounding the settings changes the ease-off by up to \d", made.text())


def test_sheet_tells_blade_tips_off_the_root_cone() -> None:
    """A blank moved along its axis by a takes its root cone a sin(root angle) away from the tips, at the root line."""
    case, shift = read_case("fm-11x41"), 2.0
    key = "machine.machine_center_to_crossing_point"
    moved = changed_case(case, {f"gear.{flank}.{key}": 2.3610377387 + shift for flank in FLANKS})
    spaces, _ = case_warnings(moved)
    assert spaces is not None
    away = shift * np.sin(np.radians(67.0896087038))
    assert spaces.measured[1].root_line[:, 1] == pytest.approx(away, rel=0.01)
    told = [note for note in summary_sheet(moved).notes if "the gear's blade tips deviate" in note]
    assert [note.split()[1] for note in told] == ["drive:", "coast:"]
    assert all(away <= float(re.findall(r"up to ([0-9.]+) mm", note)[0]) < 1.25 * away for note in told)


def test_sheet_tells_what_is_doubtful_of_the_teeth_on_every_way_out(tmp_path: Path) -> None:
    """Edge radii too large for the slot: text, page and terminal say so; the exit code stays 0."""
    case = changed_case(read_case("nasa-12x36"), {f"gear.{f}.cutter.tool_edge_radius": 3.0 for f in FLANKS})
    write_case(case, tmp_path / "case.toml")
    for name in ("sheet.txt", "sheet.html"):
        outcome = CliRunner().invoke(main, ["sheet", str(tmp_path / "case.toml"), "-o", str(tmp_path / name)])
        assert outcome.exit_code == 0, outcome.output
        assert "Warning: the gear's" in outcome.stderr
        text = (tmp_path / name).read_text(encoding="utf-8")
        assert 0 < text.index("Warning: the gear") < text.index("Blanks")
    assert not any("Warning" in note for note in summary_sheet(read_case("nasa-12x36")).notes)


def test_half_a_pair_says_that_its_teeth_are_not_checked() -> None:
    case = read_case("nasa-12x36")
    half = case.model_copy(update={"gear": case.gear.model_copy(update={"concave": None})})
    assert [note for note in summary_sheet(half).notes if "are not checked" in note]


def test_sheet_tells_set_ups_that_no_method_of_the_shop_makes() -> None:
    """Tilt beside modified roll, unless one machine cuts both flanks, as completing does."""
    case = read_case("fm-11x41")
    assert case.pinion.concave is not None
    assert case.pinion.convex is not None
    (note,) = summary_sheet(case).notes
    assert "concave and convex" in note
    upright = {f"pinion.concave.machine.{key}": 0.0 for key in ("modified_roll_2c", "modified_roll_6d")}
    (note,) = unusual_set_ups(changed_case(case, upright))
    assert "pinion's convex flank has" in note
    convex = case.pinion.convex.model_copy(update={"machine": case.pinion.concave.machine})
    assert unusual_set_ups(case.model_copy(update={"pinion": case.pinion.model_copy(update={"convex": convex})})) == ()
    rolled = {f"pinion.{flank}.machine.cutter_tilt": 0.0 for flank in FLANKS}
    assert unusual_set_ups(changed_case(case, rolled)) == ()


def test_command_writes_sheets(tmp_path: Path) -> None:
    for name in ("sheet.txt", "sheet.html"):
        outcome = CliRunner().invoke(
            main, ["sheet", "fm-11x41", "-o", str(tmp_path / name), "--resolution", "length=0.01,angle=0.05"]
        )
        assert outcome.exit_code == 0, outcome.output
        assert "ease-off by up to" in outcome.output
        assert "0.05" in (tmp_path / name).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["sheet", "fm-11x41", "-o", "x.pdf"], ["x.pdf", ".txt or .html"]),
        (["sheet", "fm-11x41", "-o", "x.txt", "--resolution", "tilt=1"], ["'tilt'", "must be one of", "angle"]),
        (["sheet", "fm-11x41", "-o", "x.txt", "--resolution", "angle=0"], ["resolution of angle = 0", "above 0"]),
        (["design", "fm-11x41", "-o", "x.toml", "--resolution", "angle=0.1"], ["--resolution", "--round"]),
    ],
)
def test_mistakes_are_told(arguments: list[str], words: list[str], tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    outcome = CliRunner().invoke(main, arguments)
    assert outcome.exit_code == 2
    for word in words:
        assert word in outcome.output
    assert list(tmp_path.iterdir()) == []


@pytest.mark.thorough
def test_design_writes_rounded_settings(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    outcome = CliRunner().invoke(main, ["design", "fh-design-a", "-o", str(path), "--round"])
    assert outcome.exit_code == 0, outcome.output
    assert "coast: rounding the settings changes the ease-off by up to" in outcome.output
    case = read_case(path)
    assert rounded_case(case).model_dump() == case.model_dump()


def test_steps_must_be_positive() -> None:
    with pytest.raises(InputError, match="resolution of length = 0"):
        MachineResolution(length=0.0)
