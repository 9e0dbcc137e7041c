"""Supports in case files: what they become, what is refused, and the shipped ones."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from places import DOCS
from runs import text_file

from easeoff.cases import (
    case_text,
    case_toml,
    parse_case,
    read_case,
    read_supports,
    shipped_supports,
    support_system,
    with_supports,
)
from easeoff.cases.conversion import gear_pair, sections
from easeoff.cases.reading import SUPPORT
from easeoff.cases.schema.schema_table import Table
from easeoff.contact.supports.shaft import ShaftSupports
from easeoff.contact.supports.support import ORIGIN, Support, Supports, shifted_wrench
from easeoff.core.errors import InputError
from easeoff.geometry.pair.gear_pair import pair_geometry

SHIPPED = {"axle-fm-11x41": "fm-11x41", "gearbox-nasa-12x36": "nasa-12x36"}
SECTION = {"start": 60.0, "end": 200.0, "outer_diameter": 40.0}
SHAFT = {"sections": [SECTION], "torque_position": 190.0}
BEARINGS = [
    {"name": "head", "position": 100.0, "radial_stiffness": 1e6, "axial_stiffness": 2e5},
    {"name": "tail", "position": 170.0, "radial_stiffness": 8e5},
]
PINION = {"shaft": SHAFT, "bearings": BEARINGS}
MATRIX = np.diag([4e5, 4e5, 3e5, 5e8, 5e8, 5e8]).tolist()


def supported(tables: dict[str, Any]) -> str:
    """Text of a shipped case with supports."""
    return case_text("nasa-12x36") + "\n" + tomli_w.dumps({"supports": tables})


def test_a_case_with_supports_is_written_and_read_again_alike() -> None:
    for supports, name in SHIPPED.items():
        case = with_supports(read_case(name), supports)
        again = parse_case(case_toml(case))
        assert again.supports == case.supports
        assert again.model_dump() == case.model_dump()
    assert read_case("nasa-12x36").supports is None
    assert support_system(read_case("nasa-12x36")) is None
    assert list(shipped_supports()) == list(SHIPPED)


def test_a_shaft_is_held_in_the_pair_s_frame_about_the_middle_of_its_face() -> None:
    case = parse_case(supported({"pinion": PINION}))
    found = support_system(case)
    assert isinstance(found, Supports)
    middle = sections(case)[0].points(np.array(0.5), np.array(0.5))[0]
    np.testing.assert_allclose(
        np.asarray(found.pinion.reference), [middle, 0.0, 0.0], atol=1e-12
    )  # the pinion axis is x
    assert [bearing.name for bearing in found.pinion.bearings] == ["head", "tail"]
    np.testing.assert_allclose(np.asarray(found.pinion.bearings[1].point), [170.0, 0.0, 0.0], atol=1e-12)
    # Along the pinion's axis the head bearing alone holds: its spring, and the shaft up to it.
    shaft = (100.0 - middle) / (206000.0 * math.pi / 4.0 * 40.0**2)
    assert np.asarray(found.pinion.compliance)[0, 0] == pytest.approx(1.0 / 2e5 + shaft, rel=1e-12)
    assert not np.asarray(found.gear.compliance).any()  # left out: does not give way
    assert not found.wind_up


def test_wind_up_needs_the_place_of_the_torque() -> None:
    found = support_system(parse_case(supported({"pinion": PINION, "wind_up": True})))
    assert isinstance(found, Supports)
    assert found.wind_up
    length = 190.0 - float(np.asarray(found.pinion.reference)[0])
    torsion = length / (206000.0 / 2.6 * math.pi / 32.0 * 40.0**4)
    assert np.asarray(found.pinion.compliance)[3, 3] == pytest.approx(torsion, rel=1e-12)
    bare = {"shaft": {"sections": SHAFT["sections"]}, "bearings": BEARINGS}
    with pytest.raises(InputError, match=r"wind_up = true: must go with torque_position in \[supports.pinion.shaft\]"):
        parse_case(supported({"pinion": bare, "wind_up": True}))


def test_matrices_are_taken_as_they_are() -> None:
    reference = [80.0, 1.0, 2.0]
    by_stiffness = support_system(
        parse_case(supported({"pinion": {"reference": reference, "stiffness": MATRIX}, "wind_up": True}))
    )
    inverse = np.linalg.inv(np.array(MATRIX)).tolist()
    by_compliance = support_system(
        parse_case(supported({"pinion": {"reference": reference, "compliance": inverse}, "wind_up": True}))
    )
    assert isinstance(by_stiffness, Supports)
    assert isinstance(by_compliance, Supports)
    np.testing.assert_allclose(np.asarray(by_stiffness.pinion.compliance), inverse, rtol=1e-12)
    np.testing.assert_allclose(np.asarray(by_compliance.pinion.compliance), inverse, rtol=1e-12)
    assert np.asarray(by_compliance.pinion.reference).tolist() == reference


def test_a_housing_couples_both_members_pinion_first() -> None:
    compliance = np.kron(np.array([[2.0, 0.5], [0.5, 1.0]]), np.linalg.inv(np.array(MATRIX)))
    tables = {
        "pinion_reference": [80.0, 0.0, 0.0],
        "gear_reference": [0.0, 0.0, 30.0],
        "compliance": compliance.tolist(),
    }
    found = support_system(parse_case(supported({"housing": tables})))
    assert isinstance(found, Supports)
    np.testing.assert_allclose(np.asarray(found.compliance), compliance, rtol=1e-12)
    assert np.asarray(found.gear.reference).tolist() == [0.0, 0.0, 30.0]


def test_curves_make_supports_that_depend_on_the_load() -> None:
    loads = [100.0, 1000.0, 10000.0, 100000.0]
    displacement = [[load, 2e-6 * load**0.9] for load in loads]
    stiffness = [[load, load**0.1 / 2e-6] for load in loads]
    curved = [
        [{**BEARINGS[0], **curve}, BEARINGS[1]]
        for curve in ({"radial_stiffness": stiffness}, {"radial_displacement": displacement})
    ]
    del curved[1][0]["radial_stiffness"]
    wrench = np.array([0.0, 5e3, 2e3, 0.0, 0.0, 0.0])
    found = []
    for bearings in curved:
        system = support_system(parse_case(supported({"pinion": {"shaft": SHAFT, "bearings": bearings}})))
        assert isinstance(system, ShaftSupports)
        assert not system.is_linear
        found.append(system.at(wrench, np.zeros(6)))
        twice = system.at(2.0 * wrench, np.zeros(6)).pinion
        assert not np.allclose(found[-1].pinion.compliance, twice.compliance, atol=0.0)
    np.testing.assert_allclose(
        np.asarray(found[0].pinion.compliance), np.asarray(found[1].pinion.compliance), rtol=1e-12
    )


@pytest.mark.parametrize(
    ("tables", "message"),
    [
        ({}, "supports: no support is given: give [supports.pinion], [supports.gear] or [supports.housing]"),
        ({"pinion": {}}, "supports.pinion: none given: give one of stiffness, compliance, or a shaft with bearings"),
        (
            {"pinion": {"reference": [0.0, 0.0, 0.0], "stiffness": MATRIX, "compliance": MATRIX}},
            "stiffness and compliance given: give one of",
        ),
        ({"pinion": {"stiffness": MATRIX}}, "reference is missing: give the point at which the stiffness holds"),
        ({"pinion": {"reference": [0.0, 0.0, 0.0], **PINION}}, "reference goes with a matrix: leave it out"),
        ({"pinion": {"shaft": SHAFT}}, "bearings are missing"),
        (
            {"pinion": {"reference": [0.0, 0.0, 0.0], "stiffness": MATRIX[:5]}},
            "supports.pinion.stiffness",
        ),
        (
            {"gear": {"shaft": {**SHAFT, "seat": 90.0}, "bearings": BEARINGS}},
            "gear.shaft.torque_position: must be left out: the rotation of the gear is that of the mesh",
        ),
        (
            {"pinion": PINION, "housing": {"pinion_reference": [0.0] * 3, "gear_reference": [0.0] * 3}},
            "stiffness, compliance: give one of them",
        ),
        (
            {"pinion": {"shaft": SHAFT, "bearings": [BEARINGS[0], {**BEARINGS[1], "name": "Head"}]}},
            "name = 'head' comes twice",
        ),
        (
            {"pinion": {"shaft": SHAFT, "bearings": [{"name": "a", "position": 100.0}]}},
            "bearing 'a' has no stiffness",
        ),
        (
            {"pinion": {"shaft": SHAFT, "bearings": [{**BEARINGS[0], "radial_stiffness": 1e12}]}},
            "radial_stiffness = 1e+12: must be from 0 to 1e+09 [N/mm]",
        ),
        (
            {"pinion": {"shaft": SHAFT, "bearings": [{**BEARINGS[0], "radial_stiffness": "stiff"}]}},
            "'stiff': must be a number, or pairs of load and load over displacement",
        ),
        (
            {"pinion": {"shaft": SHAFT, "bearings": [{**BEARINGS[0], "axial_stiffness": [[2.0, 1e5], [1.0, 1e5]]}]}},
            "loads must increase, and 1 follows 2",
        ),
        (
            {"pinion": {"shaft": SHAFT, "bearings": [{**BEARINGS[0], "tilting_displacement": [[1.0, 2.0, 3.0]]}]}},
            "must be 2 to 100 pairs of positive numbers",
        ),
        (
            {"pinion": {"shaft": SHAFT, "bearings": [{**BEARINGS[0], "axial_displacement": [[1.0, 1.0], [2.0, 2.0]]}]}},
            "axial_stiffness and axial_displacement are both given",
        ),
        (
            {"pinion": {"shaft": SHAFT, "bearings": [BEARINGS[0], {**BEARINGS[1], "position": 300.0}]}},
            "[supports.pinion] bearing tail: position = 300: must be on the shaft, from 60 to 200 [mm]",
        ),
        (
            {"pinion": {"shaft": SHAFT, "bearings": [{**BEARINGS[0], "axial_stiffness": 0.0}, BEARINGS[1]]}},
            "[supports.pinion] the shaft is free to move along its axis",
        ),
        (
            {
                "pinion": {
                    "shaft": {"sections": [{**SECTION, "inner_diameter": 41.0}]},
                    "bearings": BEARINGS,
                }
            },
            "[supports.pinion] section 1: inner_diameter = 41: must be smaller than outer_diameter = 40 [mm]",
        ),
        (
            {"gear": {"shaft": {"sections": SHAFT["sections"]}, "bearings": BEARINGS}},
            "[supports.gear] seat (the middle of the face, as it is left out) = 26.817655839: must be on the shaft",
        ),
        (
            {"pinion": {"reference": [0.0, 0.0, 0.0], "stiffness": np.diag([1e5] * 3 + [-1e9] * 3).tolist()}},
            "[supports.pinion] stiffness",
        ),
    ],
)
def test_what_cannot_be_is_refused_in_one_message(tables: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_case(supported(tables), "mine.toml")
    assert message in str(caught.value)
    assert len(str(caught.value).splitlines()) <= 2


def test_a_file_of_another_kind_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="axle-fm-11x41 is a file of supports: give it beside a case with --supports"):
        read_case("axle-fm-11x41")
    with pytest.raises(InputError, match="fm-11x41 is a case"):
        read_supports("fm-11x41")
    with pytest.raises(InputError, match=r"there is no such file, and the shipped supports are: axle-fm-11x41"):
        read_supports("axle")
    path = text_file(tmp_path / "mine.toml", 'easeoff_support = 1\ntitle = "mine"\n[supports.pinion]\nseat = 3\n')
    with pytest.raises(InputError, match=r"mine.toml has 2? ?a? ?mistake"):
        read_supports(path)


def test_supports_of_another_pair_are_refused_with_their_name() -> None:
    """A pinion of three times the size does not sit on that shaft."""
    case = read_case("nasa-12x36")
    blank = case.pinion.blank
    assert blank is not None
    larger = blank.model_copy(update={"outer_cone_distance": 300.0})
    case = case.model_copy(update={"pinion": case.pinion.model_copy(update={"blank": larger})})
    with pytest.raises(InputError, match=r"^axle-fm-11x41: \[supports.pinion\] seat .* must be on the shaft"):
        with_supports(case, "axle-fm-11x41")


# The shipped systems.


@pytest.mark.parametrize("supports", SHIPPED)
def test_shipped_shafts_fit_their_blanks(supports: str) -> None:
    """The pinion's shaft is below its root; the gear's is out of the way of the pinion."""
    case, table = read_case(SHIPPED[supports]), read_supports(supports)
    pinion, gear = sections(case)
    assert table.pinion is not None
    assert table.gear is not None
    along = np.linspace(0.0, 1.0, 50)
    axial, radial = pinion.points(along, np.zeros(50))
    for section in table.pinion.shaft.sections:  # type: ignore[union-attr]
        within = (axial >= section.start) & (axial <= section.end)
        assert np.all(0.5 * section.outer_diameter < radial[within])
    bearings = table.pinion.bearings
    heel = axial[-1]
    assert all(bearing.position > heel for bearing in bearings)  # overhung
    spread, overhang = bearings[1].position - bearings[0].position, bearings[0].position - axial.mean()
    assert spread > 2.5 * overhang
    toe = np.array([pinion.points(np.zeros(1), np.array([h]))[:, 0] for h in (0.0, 1.0)])
    nose, tip = toe[:, 0].min(), toe[:, 1].max()
    bore = gear.points(np.zeros(1), np.zeros(1))[1, 0]
    positions = [bearing.position for bearing in table.gear.bearings]
    face = gear.points(np.array(0.5), np.array(0.5))[0]
    assert min(positions) < face < max(positions)  # straddled
    for section in table.gear.shaft.sections:  # type: ignore[union-attr]
        if section.start < tip and section.end > -tip:
            assert 0.5 * section.outer_diameter < min(nose, bore)


def test_the_page_has_the_numbers_of_the_shipped_systems() -> None:
    page = (DOCS / "engineer" / "guides" / "supports.md").read_text(encoding="utf-8")
    told = re.search(r"is (\d+) and (\d+) kN/mm across the axis of the pinions, (\d+) and (\d+) kN/mm", page)
    assert told is not None
    across = []
    for member, direction in (("pinion", 1), ("gear", 0)):
        for supports in ("axle-fm-11x41", "gearbox-nasa-12x36"):
            system = support_system(with_supports(read_case(SHIPPED[supports]), supports))
            assert isinstance(system, Supports)
            across.append(1e-3 / np.asarray(getattr(system, member).compliance)[direction, direction])
    assert [float(each) for each in told.groups()] == pytest.approx(across, rel=5e-3)


def test_the_tables_of_the_page_are_supports() -> None:
    page = (DOCS / "engineer" / "guides" / "supports.md").read_text(encoding="utf-8")
    shaft, stiffness, displacement, matrix = re.findall(r"^```toml\n(.*?)^```$", page, flags=re.MULTILINE | re.DOTALL)
    case = parse_case(case_text("nasa-12x36") + shaft)
    assert isinstance(support_system(case), Supports)
    for curve, other in ((stiffness, "radial_stiffness = 0.9e6"), (displacement, "radial_stiffness = 0.9e6")):
        curved = parse_case(case_text("nasa-12x36") + shaft.replace(other, curve.split("#")[0]))
        system = support_system(curved)
        assert isinstance(system, ShaftSupports)
        head = system.pinion.shaft.bearings[0].radial  # type: ignore[union-attr]
        assert head.stiffness(5000.0) == pytest.approx(0.92e6, rel=2e-3)  # type: ignore[union-attr]
    assert isinstance(
        with_supports(read_case("fm-11x41"), SUPPORT.parse(matrix, "page", None).supports).supports, Table
    )


def _roller_stiffness(rollers: int, length: float, factor: float, radial: float, preload: float) -> tuple[float, float]:
    """Radial and axial stiffness [N/mm] by 0.000077 Q^0.9 / l^0.8, see the shipped files."""
    angle = math.atan(factor / 1.5)
    most = 4.08 * radial / (rollers * math.cos(angle))
    each = preload / (rollers * math.sin(angle))
    across = 7.7e-5 * most**0.9 / length**0.8 / math.cos(angle)
    along = 7.7e-5 * each**0.9 / length**0.8 / math.sin(angle)
    return radial / across, preload / along / 0.9


@pytest.mark.parametrize(
    ("supports", "member", "rollers"),
    [
        ("axle-fm-11x41", "pinion", [(17, 15.0, 0.37, 11300.0, 4000.0), (17, 12.5, 0.37, 3700.0, 4000.0)]),
        ("axle-fm-11x41", "gear", [(19, 15.0, 0.40, 9200.0, 3000.0), (19, 15.0, 0.40, 3700.0, 3000.0)]),
        ("gearbox-nasa-12x36", "pinion", [(17, 14.3, 0.37, 7500.0, 2500.0), (17, 12.5, 0.37, 2500.0, 2500.0)]),
        ("gearbox-nasa-12x36", "gear", [(17, 15.0, 0.37, 5100.0, 2500.0), (17, 15.0, 0.37, 2600.0, 2500.0)]),
    ],
)
def test_shipped_stiffnesses_follow_from_their_formula_and_load(
    supports: str, member: str, rollers: list[tuple[int, float, float, float, float]]
) -> None:
    bearings = getattr(read_supports(supports), member).bearings
    for bearing, data in zip(bearings, rollers, strict=True):
        radial, axial = _roller_stiffness(*data)
        assert bearing.radial_stiffness == pytest.approx(radial, rel=0.01)
        assert bearing.axial_stiffness == pytest.approx(axial, rel=0.01)
    case = with_supports(read_case(SHIPPED[supports]), supports)
    system, wrench = support_system(case), _mean_wrench(supports)
    assert isinstance(system, Supports)
    held: Support = getattr(system, member)
    about = shifted_wrench(wrench if member == "gear" else -wrench, ORIGIN, held.reference)
    axis = np.array([0.0, 0.0, 1.0]) if member == "gear" else np.array([1.0, 0.0, 0.0])
    for bearing, data in zip(held.bearings, rollers, strict=True):
        force = bearing.load(about)[:3]
        assert np.linalg.norm(force - (force @ axis) * axis) == pytest.approx(data[3], rel=0.03)


def _mean_wrench(supports: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Wrench on the gear about the origin, of contact at the middle of its drive flank under the middle torque."""
    case = read_case(SHIPPED[supports])
    pair = gear_pair(case)
    middle = pair_geometry(pair, (9, 7)).ease_off.isel(lengthwise=4, profile=3)
    force = 1e3 * case.contact.torques[1] * pair.assembly.ratio / float(middle["lever_arm"])
    normal = middle["action_normal"].values
    return np.asarray(force * np.concatenate([normal, np.cross(middle["action_position"].values, normal)]))
