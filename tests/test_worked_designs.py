"""Designs worked through in the docs: they are cut within limits, and keep their edges free at the nominal torque."""

from __future__ import annotations

import importlib
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import easeoff
from easeoff.cases import Case, read_design, shipped_designs
from easeoff.geometry import FlankName
from easeoff.study import design_case, rounded_case, rounding_effect
from easeoff.study.report.key_numbers import key_numbers
from easeoff.study.report.notes.edge_load import edge_notes

SUPPORTS = {"axle-10x41": None, "axle-hobbed-11x39": None, "aero-12x36": "gearbox-nasa-12x36"}
NOMINAL = 200.0  # [N m]
DESIGNS = Path(__file__).parents[1] / "docs" / "engineer" / "designs"
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
