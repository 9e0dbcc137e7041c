"""Changes that the messages of a design name: each is applied to a design that provokes it, and helps."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from easeoff import GeometryError
from easeoff.cases import Design, designed_blanks, parse_design
from easeoff.geometry.design.basic_settings import formate_gear
from easeoff.geometry.design.blank import BlankDimensions
from easeoff.geometry.design.fitting_proportions import undercut_margin
from easeoff.geometry.design.slot_width import EdgeRadiusLimits, SlotWidths, ToothLine, TopLands
from easeoff.geometry.design.tooth_proportions import ToothProportions
from easeoff.study import design_case
from easeoff.study.design.design_check import (
    TOOTH_ADVICE,
    ToothSpaces,
    formate_advice,
    limit_pressure_angle_advice,
    proportion_warnings,
)

BASIC: dict[str, Any] = {
    "gear_outer_pitch_diameter": 180.0,
    "gear_mean_spiral_angle": 35.0,
    "gear_face_width": 27.0,
    "cutter_radius": 76.2,
    "nominal_drive_pressure_angle": 20.0,
    "nominal_coast_pressure_angle": 20.0,
    "gear_mean_addendum_factor": 0.25,
    "depth_factor": 2.0,
    "clearance_factor": 0.125,
    "thickness_factor": 0.08,
    "depth_taper": '"uniform"',
}


def drawn(teeth: tuple[int, int] = (14, 42), offset: float = 0.0, other: str = "", **changes: Any) -> Design:
    """Design with these basic data; ``None`` leaves a key out."""
    basic = {name: value for name, value in (BASIC | changes).items() if value is not None}
    lines = [f"{name} = {value}" for name, value in basic.items()]
    return parse_design(
        f'easeoff_design = 1\ntitle = "drawn"\n[pair]\nhypoid_offset = {offset}\n[blank_design]\n'
        + "\n".join(lines)
        + f'\n[pinion]\nnumber_of_teeth = {teeth[0]}\nhand_of_spiral = "left"\n{other}\n'
        + f"[gear]\nnumber_of_teeth = {teeth[1]}\n"
    )


def blanks(design: Design) -> BlankDimensions:
    teeth = design.pinion.number_of_teeth, design.gear.number_of_teeth
    return designed_blanks(design.blank_design, teeth, design.pair)


def spaces(design: Design) -> ToothSpaces:
    """Spaces by the formulas alone."""
    groups = design.blank_design.number_of_blade_groups or 0
    proportions = ToothProportions.of(
        blanks(design), design.blank_design.cutter_radius, groups, generated_gear=design.gear.generation == "generated"
    )
    slots = SlotWidths(ToothLine(proportions))
    measured: Any = ()
    return ToothSpaces(slots, TopLands(slots), EdgeRadiusLimits(slots), measured, np.ones(2), np.full((2, 2), np.nan))


def unevenness(design: Design, member: int) -> float:
    """Difference of the slot's ends over their mean."""
    toe, _, heel = spaces(design).slots.width[member]
    return float(2.0 * abs(toe - heel) / (toe + heel))


HOBBED = {"number_of_blade_groups": 11, "cutter_radius": 140.0}


@pytest.mark.parametrize(
    ("changes", "change", "helped"),
    [
        ({"cutter_radius": 105.0}, "a smaller cutter_radius", {"cutter_radius": 80.0}),
        ({"cutter_radius": 105.0}, 'depth_taper = "constant_slot_width"', {"depth_taper": '"constant_slot_width"'}),
        ({"cutter_radius": 34.0}, "a larger cutter_radius", {"cutter_radius": 42.0}),
        (HOBBED, "a smaller cutter_radius", {"cutter_radius": 95.0}),
    ],
    ids=["wide-heel", "taper", "wide-toe", "hobbed"],
)
def test_a_slot_becomes_more_even(changes: dict[str, Any], change: str, helped: dict[str, Any]) -> None:
    narrowing = [text for text in spaces(drawn(**changes)).warnings() if "fin" in text or "no width" in text]
    assert narrowing
    for text in narrowing:
        assert change in text
        assert ("depth_taper" in text) == (changes["cutter_radius"] == 105.0)
        member = 0 if "pinion" in text else 1
        assert unevenness(drawn(**changes | helped), member) < 0.9 * unevenness(drawn(**changes), member)


def least_slot(design: Design, member: int) -> float:
    return float(spaces(design).slots.least[member])


def least_land(design: Design, member: int) -> float:
    return float(spaces(design).lands.width[member].min())


def margin(design: Design, _: int) -> float:
    return undercut_margin(blanks(design))


#: What is too small, basic data that make it so, and what the advice calls larger (1) or smaller (-1) of the member.
SMALL: dict[str, tuple[str, Callable[[Design, int], float], int, dict[str, Any], dict[str, float]]] = {
    "pinion's slot": (
        "",
        least_slot,
        0,
        {"thickness_factor": 0.5},
        {"depth_factor": -0.1, "clearance_factor": -0.02, "thickness_factor": -0.1},
    ),
    "gear's slot": (
        "",
        least_slot,
        1,
        {"thickness_factor": -0.6},
        {"depth_factor": -0.1, "clearance_factor": -0.02, "thickness_factor": 0.1},
    ),
    "pinion's slot by width": (
        "",
        least_slot,
        0,
        {"thickness_factor": None, "gear_mean_slot_width": 4.0},
        {"gear_mean_slot_width": -0.5},
    ),
    "gear's slot by width": (
        "",
        least_slot,
        1,
        {"thickness_factor": None, "gear_mean_slot_width": 0.5},
        {"gear_mean_slot_width": 0.5},
    ),
    "pinion's top": (
        "pointed",
        least_land,
        0,
        {"thickness_factor": -0.2},
        {"depth_factor": -0.1, "gear_mean_addendum_factor": 0.05},
    ),
    "gear's top": (
        "pointed",
        least_land,
        1,
        {"gear_mean_addendum_factor": 0.6},
        {"depth_factor": -0.1, "gear_mean_addendum_factor": -0.05},
    ),
    "pinion's flank": (
        "undercut",
        margin,
        0,
        {"gear_mean_addendum_factor": 0.5, "gear_mean_spiral_angle": 10.0},
        {"gear_mean_addendum_factor": -0.05, "nominal_drive_pressure_angle": 2.0},
    ),
    "gear's flank": (
        "undercut",
        margin,
        1,
        {"gear_mean_addendum_factor": 0.02, "gear_mean_spiral_angle": 10.0},
        {"gear_mean_addendum_factor": 0.05, "nominal_drive_pressure_angle": 2.0},
    ),
}


@pytest.mark.parametrize("name", SMALL)
def test_what_the_advice_on_a_tooth_names_helps(name: str) -> None:
    """Each change alone; of undercut both pressure angles together, and more teeth of the same module."""
    word, measure, member, basic, changes = SMALL[name]
    teeth = {"gear's flank": (10, 11), "gear's top": (10, 24)}.get(name, (10, 42))
    advice, before = TOOTH_ADVICE[word][member], measure(drawn(teeth, **basic), member)
    for key, step in changes.items():
        assert re_key(key) in advice
        helped = basic | {key: (BASIC | basic)[key] + step}
        if key == "nominal_drive_pressure_angle":
            helped["nominal_coast_pressure_angle"] = helped[key]
        else:
            assert ("larger" in advice.split(key)[0].rpartition(", or ")[2]) == (step > 0.0) or "or a larger" in advice
        assert measure(drawn(teeth, **helped), member) > before, key
    if word == "undercut":
        more = (teeth[0] + 4, teeth[1] + 4)
        larger = {"gear_outer_pitch_diameter": 180.0 * more[1] / teeth[1]}
        assert measure(drawn(more, **basic | larger), member) > before


def re_key(key: str) -> str:
    """Words of an advice on a key."""
    return "pressure angles" if key.startswith("nominal") else key


def test_a_slot_too_narrow_for_a_blade_is_told() -> None:
    """Though one of that point width could be computed."""
    narrow = drawn(thickness_factor=None, gear_mean_slot_width=0.3)
    (told,) = [text for text in spaces(narrow).warnings() if "gear's slot" in text]
    assert "wide at its narrowest end" in told or "no width" in told
    assert "larger thickness_factor or gear_mean_slot_width" in told
    assert not [text for text in spaces(drawn()).warnings() if "gear's slot is" in text]


@pytest.mark.parametrize(
    ("key", "step"), [("thickness_factor", 0.8), ("depth_factor", -0.8), ("clearance_factor", -0.12)]
)
def test_a_gear_without_point_width_is_helped(key: str, step: float) -> None:
    basic = BASIC | {"thickness_factor": -0.7 if key == "clearance_factor" else -0.75}
    with pytest.raises(GeometryError, match=rf"no cutter fits; .*{key}"):
        formate_gear(blanks(drawn(**basic)), 76.2, "right", corrected=False)
    formate_gear(blanks(drawn(**basic | {key: basic[key] + step})), 76.2, "right", corrected=False)


def test_a_gear_without_thickness_is_helped() -> None:
    with pytest.raises(GeometryError, match=r"mean normal thickness -.* for the gear a smaller .*gear_mean_slot_width"):
        drawn(thickness_factor=None, gear_mean_slot_width=9.0)
    assert blanks(drawn(thickness_factor=None, gear_mean_slot_width=4.0)).gear.mean_normal_thickness > 0.0


def test_a_small_generated_pressure_angle_is_helped() -> None:
    hypoid = {"gear_mean_spiral_angle": None, "pinion_mean_spiral_angle": 48.0, "depth_taper": None}
    angles = {"nominal_drive_pressure_angle": 14.0, "nominal_coast_pressure_angle": 14.0}

    def small(offset: float, **changes: Any) -> tuple[float, list[str]]:
        design = drawn((12, 42), offset, **hypoid | angles | changes)
        teeth = design.pinion.number_of_teeth, design.gear.number_of_teeth
        basic = design.blank_design.basic_data(teeth, 90.0, offset)
        return blanks(design).generated_drive_pressure_angle, limit_pressure_angle_advice(basic, blanks(design))

    before, (text,) = small(30.0)
    assert "a smaller hypoid_offset or a larger nominal_drive_pressure_angle helps" in text
    assert small(20.0)[0] > before
    assert small(30.0, nominal_drive_pressure_angle=19.0)[0] > before
    nothing, (text,) = small(30.0, limit_pressure_angle_influence=0.0)
    assert "1 gives drive and coast flanks pressure angles that allow for it" in text
    assert nothing == pytest.approx(math.radians(14.0))


def test_default_and_advice_have_one_limit_of_formate() -> None:
    for gear, usual in ((34, "generated"), (36, "formate")):
        design = drawn((14, gear))
        assert design.gear.generation == design.usual_generation == usual
        formate = design.model_copy(update={"gear": design.gear.model_copy(update={"generation": "formate"})})
        assert bool(formate_advice(formate)) == (usual == "generated")
        assert formate_advice(design) == []


def test_a_diameter_for_the_radius_is_told_of_itself() -> None:
    blank = blanks(drawn())
    (text,) = proportion_warnings(ToothProportions.of(blank, 152.4, generated_gear=True))
    assert "cutter_radius = 152.4 mm" in text
    assert "not the diameter" in text
    assert list(proportion_warnings(ToothProportions.of(blank, 76.2, generated_gear=True))) == []


@pytest.mark.thorough
def test_blade_angles_are_brought_within_the_limits_that_a_warning_names() -> None:
    hypoid = {"gear_mean_spiral_angle": None, "pinion_mean_spiral_angle": 48.0, "cutter_radius": 114.3}
    free: dict[str, Any] = dict.fromkeys(("depth_taper", "gear_mean_addendum_factor", "depth_factor"))
    size = {"gear_outer_pitch_diameter": 232.0, "gear_face_width": 37.0, "thickness_factor": None}
    angles = {"nominal_drive_pressure_angle": 19.0, "nominal_coast_pressure_angle": 19.0}
    shell = '[compliance]\nmodel = "shell"\n'

    def told(other: str) -> list[str]:
        design = drawn((12, 37), 36.0, other + shell, **hypoid | free | size | angles)
        return [text for text in design_case(design)[1].warnings if "pinion's blade has an angle" in text]

    (text,) = told("")
    limits = "smallest_blade_pressure_angle = 8\nlargest_blade_pressure_angle = 32\n"
    assert 'in [pinion.limits] with method = "tilt" helps' in text
    assert told(f'method = "tilt"\n[pinion.limits]\n{limits}') == []
