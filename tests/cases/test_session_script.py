"""Session scripts of another program: what is read, what is said of the rest, and its own chain of joints beside it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from runs import text_file
from session_chain import chain, curved, flank_points, straight
from session_scripts import BLANKS, CUTTERS, MACHINES, Machine, script

from easeoff import InputError
from easeoff.cases import Case, gear_pair, read_case, read_session_script
from easeoff.geometry import Member
from easeoff.geometry.flanks.flank import NodeStatus, solve_flank

MIRROR = np.diag([1.0, -1.0, 1.0, 1.0])

FORMATE = {"HORIZONTAL": 37.1573, "VERTICAL": 62.4178, "ROOTANGLE": 67.6833, "MACHCTRBACK": 0.4}
PINION_EXTRAS = {
    "TILTANGLE": 1.9, "SWIVELANGLE": -24.0, "MODROLL_2C": 0.031, "MODROLL_6D": -0.11, "MODROLL_24E": 0.2,
    "MODROLL_120F": -0.3, "MODROLL_720G": 0.4, "H1": 1.7, "H2": -2.1, "H3": 1.3, "R2": 1.1, "V2": -1.4,
}  # fmt: skip
GEAR_EXTRAS = {
    "BLANKOFFSET": 1.2, "SLIDINGBASE": 0.3, "MACHCTRBACK": 0.5, "MODROLL_2C": 0.02, "MODROLL_6D": 0.09, "H1": -0.8,
    "H2": 1.2, "V1": 0.9, "V2": -0.7, "R2": 0.6,
}  # fmt: skip


def with_extras(member: str, extras: Machine) -> dict[str, dict[str, Machine]]:
    machines = {name: dict(flanks) for name, flanks in MACHINES.items()}
    machines[member] = {flank: settings | extras for flank, settings in machines[member].items()}
    return machines


def read(text: str, folder: Path) -> tuple[Case, list[str]]:
    path = text_file(folder / "pair.ses", text)
    return read_session_script(path)


def points_of(case: Case, member: str, flank: str) -> np.ndarray[Any, Any]:
    """Points (3, n) of one flank, all of them good."""
    pinion_concave = (member == "PINION") == (flank == "CONCAVE")
    pair = gear_pair(case, "drive" if pinion_concave else "coast")
    chosen: Member = pair.pinion if member == "PINION" else pair.gear
    fractions = np.meshgrid([0.15, 0.5, 0.85], [0.45, 0.75], indexing="ij")
    axial, radial = chosen.section.points(*(f.ravel() for f in fractions))
    found = solve_flank(chosen.loaded, chosen.section, axial, radial)
    assert np.all(found.status == NodeStatus.INSIDE), found.status
    return found.position


@pytest.mark.parametrize("hand", ["LEFT", "RIGHT"])
@pytest.mark.parametrize("flank", ["CONCAVE", "CONVEX"])
@pytest.mark.parametrize("member", ["PINION", "GEAR"])
def test_flanks_are_those_of_the_programs_own_chain(member: str, flank: str, hand: str, tmp_path: Path) -> None:
    machines = with_extras(member, PINION_EXTRAS if member == "PINION" else GEAR_EXTRAS)
    case, _ = read(script(hand, machines), tmp_path)
    edge = straight(CUTTERS[member][flank], flank)
    points = points_of(case, member, flank)
    theirs = flank_points(member, hand, machines[member][flank], edge, points)
    np.testing.assert_allclose(points, theirs, rtol=0, atol=1e-9)


@pytest.mark.parametrize("keyword", ["R1", "V1", "R3", "V3"])
def test_odd_motions_of_a_left_hand_pinion_are_those_of_the_chain(keyword: str, tmp_path: Path) -> None:
    machines = with_extras("PINION", {keyword: 1.3})
    case, notes = read(script("LEFT", machines), tmp_path)
    assert not any(keyword in note for note in notes)
    edge = straight(CUTTERS["PINION"]["CONCAVE"], "CONCAVE")
    points = points_of(case, "PINION", "CONCAVE")
    theirs = flank_points("PINION", "LEFT", machines["PINION"]["CONCAVE"], edge, points)
    np.testing.assert_allclose(points, theirs, rtol=0, atol=1e-9)


@pytest.mark.parametrize("hand", ["LEFT", "RIGHT"])
@pytest.mark.parametrize("flank", ["CONCAVE", "CONVEX"])
def test_formate_flanks_are_those_of_the_programs_own_chain(flank: str, hand: str, tmp_path: Path) -> None:
    machines = with_extras("GEAR", {}) | {"GEAR": {"CONCAVE": FORMATE, "CONVEX": FORMATE}}
    case, _ = read(script(hand, machines, formate=True), tmp_path)
    polar = {
        "RADIALSETTING": float(np.hypot(FORMATE["HORIZONTAL"], FORMATE["VERTICAL"])),
        "CRADLEANGLE": float(np.degrees(np.arctan(FORMATE["VERTICAL"] / FORMATE["HORIZONTAL"]))),
        "ROOTANGLE": FORMATE["ROOTANGLE"],
        "MACHCTRBACK": FORMATE["MACHCTRBACK"],
    }
    edge = straight(CUTTERS["GEAR"][flank], flank)
    points = points_of(case, "GEAR", flank)
    np.testing.assert_allclose(points, flank_points("GEAR", hand, polar, edge, points), rtol=0, atol=1e-9)


def no_mirror_image(member: str) -> set[str]:
    """Keywords whose signs for the two hands are no mirror images of each other, in the program's chain."""
    base = {"RADIALSETTING": 74.0, "CRADLEANGLE": 60.0, "ROOTANGLE": 20.0, "RATIOROLL": 3.0}
    keywords = ["BLANKOFFSET", "SLIDINGBASE", "MACHCTRBACK", "TILTANGLE", "SWIVELANGLE"]
    keywords += ["MODROLL_2C", "MODROLL_6D", "MODROLL_24E", "MODROLL_120F", "MODROLL_720G"]
    keywords += [f"{letter}{n}" for letter in "RVH" for n in range(1, 7)]
    found = set()
    for keyword in keywords:
        machine = base | {keyword: 1.5} | ({"TILTANGLE": 5.0} if keyword == "SWIVELANGLE" else {})
        left, right = chain(member, "LEFT", machine, 0.4), chain(member, "RIGHT", machine, -0.4)
        # The tool is a body of revolution: its axis and centre are what counts.
        if not np.allclose(MIRROR @ left[:, 2:], right[:, 2:], rtol=0, atol=1e-9):
            found.add(keyword)
    return found


def test_where_the_other_programs_signs_are_no_mirror_image() -> None:
    assert no_mirror_image("PINION") == {"R1", "R3", "R5", "V1", "V3", "V5"}
    assert no_mirror_image("GEAR") == {"R1", "R5", "V6", "SWIVELANGLE"}
    # The tilt of a gear is a mirror image, but opposite to that of a pinion of the same hand.
    plain = {"RADIALSETTING": 74.0, "CRADLEANGLE": 60.0, "ROOTANGLE": 20.0, "RATIOROLL": 3.0}
    pinion = chain("PINION", "RIGHT", plain | {"TILTANGLE": 5.0}, 0.0)
    assert np.allclose(pinion, chain("GEAR", "LEFT", plain | {"TILTANGLE": -5.0}, 0.0), rtol=0, atol=1e-12)


@pytest.mark.parametrize("member", ["PINION", "GEAR"])
@pytest.mark.parametrize("hand", ["LEFT", "RIGHT"])
def test_doubtful_signs_are_reported(member: str, hand: str, tmp_path: Path) -> None:
    """Wherever the signs of the two hands contradict each other, the reader says so."""
    keywords = [f"{letter}{n}" for letter in "RVH" for n in range(1, 7)] + ["TILTANGLE", "SWIVELANGLE"]
    case, notes = read(script(hand, with_extras(member, dict.fromkeys(keywords, 0.01))), tmp_path)
    told = {k for k in keywords if any(f" {k} " in note and "no mirror image" in note for note in notes)}
    assert told == (no_mirror_image(member) - {"SWIVELANGLE"} if hand == "RIGHT" else set())
    told = {k for k in keywords if any(f" {k} " in note and "sense it has for a pinion" in note for note in notes)}
    assert told == ({"TILTANGLE", "SWIVELANGLE"} if member == "GEAR" else set())
    told = {k for k in keywords if any(f" {k} " in note and "opposite to BLANKOFFSET" in note for note in notes)}
    assert ("V1" in told) == (member == "GEAR")
    motions = (case.pinion if member == "PINION" else case.gear).concave
    assert motions is not None
    assert motions.machine.motions.radial_distance == (0.01,) * 6
    assert motions.machine.motions.work_offset == ((0.01,) * 6 if member == "PINION" else (-0.01,) * 6)


def test_unnamed_flanks_are_concave_then_convex(tmp_path: Path) -> None:
    named, _ = read(script("RIGHT", MACHINES), tmp_path)
    unnamed, _ = read(script("RIGHT", MACHINES, named=False), tmp_path)
    assert unnamed == named


@pytest.mark.parametrize(("cones", "shaft_angle"), [(95.0, 95.0), (80.0, 80.0), (90.004, 90.0)])
def test_the_shaft_angle_follows_from_the_cones_of_a_pair_without_offset(
    cones: float, shaft_angle: float, tmp_path: Path
) -> None:
    sigma = np.radians(cones)
    pinion = np.degrees(np.arctan2(np.sin(sigma), 3.0 + np.cos(sigma)))
    text = script("LEFT", MACHINES)
    for member, angle in (("PINION", pinion), ("GEAR", cones - pinion)):
        for key, more in (("PITCHANGLE", 0.0), ("FACEANGLE", 2.0), ("ROOTANGLE", -2.0)):
            text = text.replace(f"{key} {BLANKS[member][key]!r}", f"{key} {angle + more:.7f}")
    case, notes = read(text, tmp_path)
    assert case.pair.shaft_angle == pytest.approx(shaft_angle, abs=1e-6)
    assert f"shaft angle {case.pair.shaft_angle:g} deg, the sum of the pitch angles" in "\n".join(notes)


def test_cones_of_a_pair_with_offset_leave_the_axes_to_the_user(tmp_path: Path) -> None:
    case, notes = read(script("LEFT", MACHINES).replace("PITCHANGLE 18.4333333", "PITCHANGLE 19.5"), tmp_path)
    assert (case.pair.shaft_angle, case.pair.hypoid_offset) == (90.0, 0.0)
    assert "give shaft_angle and hypoid_offset in [pair]" in "\n".join(notes)


def test_values_arrive_under_our_names(tmp_path: Path) -> None:
    case, notes = read(script("LEFT", with_extras("PINION", PINION_EXTRAS)), tmp_path)
    shipped = read_case("nasa-12x36")
    assert case.pinion.hand_of_spiral == "left"
    assert case.pinion.blank is not None
    assert case.gear.blank is not None
    assert shipped.pinion.blank is not None
    assert case.pinion.blank.pitch_angle == shipped.pinion.blank.pitch_angle
    assert case.pinion.blank.pitch_apex_beyond_crossing_point == 0.1
    assert case.gear.blank.back_angle == 69.0
    assert case.pinion.concave is not None
    machine = case.pinion.concave.machine
    assert machine.modified_roll == (0.031, -0.11, 0.2, -0.3, 0.4)
    assert machine.motions.sliding_base == (1.7, -2.1, 1.3)
    assert machine.motions.radial_distance == (0.0, 1.1)
    text = "\n".join(notes)
    for words in ("SPIRALANGLE 35.0", "USE_SPRD_BLD_THICKNESS TRUE", "pair.ses", "USENEWCUTTER TRUE", "offset 0 mm"):
        assert words in text
    lines = script("LEFT", with_extras("PINION", PINION_EXTRAS)).splitlines()
    for note in (n for n in notes if n.startswith("not understood: line ")):
        number, _, content = note.removeprefix("not understood: line ").partition(": ")
        assert lines[int(number) - 1].split() == content.split()
    assert "RADIALSETTING" not in text


def test_a_keyword_given_twice_is_told_with_both_lines(tmp_path: Path) -> None:
    """The last one counts, as in the menus of the program; the same keyword in another menu is another setting."""
    once = script("LEFT", MACHINES)
    first = next(at for at, line in enumerate(once.splitlines(), start=1) if "RADIALSETTING" in line)
    lines = once.splitlines()
    lines.insert(first, "RADIALSETTING 80.5")
    case, notes = read("\n".join(lines), tmp_path)
    _, quiet = read(once, tmp_path)
    told = [note for note in notes if "replaces" in note]
    value = lines[first - 1].split("RADIALSETTING")[1].split()[0]
    assert told == [f"line {first + 1}: RADIALSETTING 80.5 replaces {value} of line {first}"]
    assert not any("replaces" in note for note in quiet)
    assert 80.5 in [flank.machine.radial_distance for flank in (case.pinion.concave, case.pinion.convex) if flank]


def test_blades_arrive_under_our_names(tmp_path: Path) -> None:
    cutters: dict[str, dict[str, dict[str, Any]]] = {
        member: {flank: dict(values) for flank, values in flanks.items()} for member, flanks in CUTTERS.items()
    }
    cutters["PINION"]["CONCAVE"] |= {
        "TYPE": "CURVED", "RHO": 900.0, "EDGERADIUS": 1.2, "TOPREM_OPTION": "BLENDED", "TOPREM_DEPTH": 1.5,
        "TOPREM_BLEND_RADIUS": 60.0, "FLANKREM_OPTION": "STRAIGHT", "FLANKREM_DEPTH": 7.0, "FLANKREM_ANGLE": 2.0,
    }  # fmt: skip
    cutters["PINION"]["CONVEX"] |= {"TYPE": "STRAIGHT", "RHO": 900.0, "TOPREM_OPTION": "NONE", "TOPREM_DEPTH": 1.5}
    case, _ = read(script("LEFT", MACHINES, cutters=cutters), tmp_path)
    assert case.pinion.concave is not None
    assert case.pinion.convex is not None
    assert case.pinion.concave.cutter.model_dump(exclude_defaults=True) == {
        "blade_point_radius": 75.3268,
        "blade_pressure_angle": 18.0457,
        "blade_spheric_radius": 900.0,
        "tool_edge_radius": 1.2,
        "toprem_depth": 1.5,
        "toprem_radius": 60.0,
        "flankrem_depth": 7.0,
        "flankrem_angle": 2.0,
    }
    assert case.pinion.convex.cutter.model_dump(exclude_defaults=True).keys() == {
        "blade_point_radius",
        "blade_pressure_angle",
    }


def test_root_angle_of_the_machine_serves_without_tilt_alone(tmp_path: Path) -> None:
    bare = "\n".join(line for line in script("LEFT", MACHINES).splitlines() if not line.startswith("ROOTANGLE"))
    case, notes = read(bare, tmp_path)
    assert case.pinion.blank is not None
    assert case.pinion.blank.root_angle == 16.8667
    assert any("root angle of the pinion" in note for note in notes)
    with pytest.raises(InputError, match="add ROOTANGLE"):
        read(bare.replace("RADIALSETTING", "TILTANGLE 2.0\nRADIALSETTING"), tmp_path)


MISTAKES = {
    "no number": ("RATIOROLL 3.2427", "RATIOROLL fast", ["line", "RATIOROLL", "fast", "number"]),
    "no value": ("\t\tRATIOROLL 3.2427", "\t\tRATIOROLL", ["line", "RATIOROLL", "no value"]),
    "missing setting": ("\t\tRATIOROLL 3.2427\n", "", ["MACHINE", "CONCAVE", "pinion", "RATIOROLL"]),
    "missing blank": ("FACEANGLE 22.3166667\n", "", ["COMMON", "pinion", "FACEANGLE"]),
    "unknown hand": ("HAND_PINION LEFT", "HAND_PINION UP", ["HAND_PINION", "UP", "LEFT", "RIGHT"]),
    "two hands": ("HAND_PINION LEFT", "HAND_PINION RIGHT", ["HAND_PINION", "contradict"]),
    "unknown type": ("GEAR_TYPE generated", "GEAR_TYPE hobbed", ["GEAR_TYPE", "hobbed", "FORMATE"]),
    "out of range": ("NTEETH 12", "NTEETH 2", ["number_of_teeth", "2", "at least 3"]),
    "half a tooth": ("NTEETH 12", "NTEETH 12.5", ["number_of_teeth", "12.5"]),
    "infinite": ("RATIOROLL 3.2427", "RATIOROLL inf", ["ratio_of_roll", "inf", "finite"]),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes_name_line_keyword_and_value(name: str, tmp_path: Path) -> None:
    old, new, words = MISTAKES[name]
    text = script("LEFT", MACHINES)
    assert old in text
    with pytest.raises(InputError) as caught:
        read(text.replace(old, new, 1), tmp_path)
    for word in ("pair.ses", *words):
        assert word in str(caught.value)


def test_files_that_are_no_script(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="hand of the pinion"):
        read("nothing of the kind", tmp_path)
    (tmp_path / "binary.ses").write_bytes(b"\xff\xfe\x00\xd8")
    for name, words in (("binary.ses", "cannot be read"), ("none.ses", "there is no such file")):
        with pytest.raises(InputError, match=words):
            read_session_script(tmp_path / name)


# Flanks cut by a curved blade, read from a session script, against that program's own chain of joints


@pytest.mark.parametrize("hand", ["LEFT", "RIGHT"])
@pytest.mark.parametrize("flank", ["CONCAVE", "CONVEX"])
@pytest.mark.parametrize("member", ["PINION", "GEAR"])
@pytest.mark.parametrize("radius", [300.0, 900.0])
def test_curved_blades_cut_the_flanks_of_the_programs_own_chain(
    member: str, flank: str, hand: str, radius: float, tmp_path: Path
) -> None:
    machines = with_extras(member, PINION_EXTRAS if member == "PINION" else GEAR_EXTRAS)
    blade = {"TYPE": "CURVED", "RHO": radius, "EDGERADIUS": 0.5}
    cutters: dict[str, dict[str, dict[str, Any]]] = {
        name: {side: dict(values) | (blade if (name, side) == (member, flank) else {}) for side, values in both.items()}
        for name, both in CUTTERS.items()
    }
    case, _ = read(script(hand, machines, cutters=cutters), tmp_path)
    edge = curved(cutters[member][flank], flank)
    points = points_of(case, member, flank)
    theirs = flank_points(member, hand, machines[member][flank], edge, points)
    np.testing.assert_allclose(points, theirs, rtol=0, atol=1e-9)
