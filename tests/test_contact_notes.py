"""Notes on what a customer must not overlook: pressure at line ends, load on edges, supports of another pair."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr

import easeoff
from easeoff.cases import Case, read_supports
from easeoff.cases.supported_case import with_supports
from easeoff.contact.evaluation.pressure_place import LineEnd, at_line_end, max_inner_pressure
from easeoff.study import result_summary
from easeoff.study.report.notes.edge_load import TOLD_SHARE, edge_notes
from easeoff.study.report.notes.end_pressure import end_notes
from easeoff.study.report.notes.supports_notes import axial_face, supports_notes

COARSE = {"torques": (100.0,), "mesh_positions": 4, "segments_per_line": 9, "lengthwise_nodes": 11, "profile_nodes": 9}


def coarse(name: str) -> Case:
    case = easeoff.read_case(name)
    return case.model_copy(update={"contact": case.contact.model_copy(update=COARSE), "friction": None})


def one_line(pressure: list[float], end: LineEnd) -> xr.Dataset:
    """A contact line across the middle of the flank, beside one on the next tooth."""
    over = ("torque", "mesh_position", "segment")
    count = len(pressure)
    fields: dict[str, Any] = {"pressure": [*pressure, 100.0], "tooth": [0.0] * count + [1.0]}
    fields |= {name: [value] * (count + 1) for name, value in (("length", 1.0), ("lengthwise", 0.5), ("profile", 0.5))}
    found = xr.Dataset({name: (over, [[values]]) for name, values in fields.items()}, coords={"torque": [50.0]})
    found["max_pressure"] = ("torque", [max(pressure)])
    found["max_pressure_line_end"] = ("torque", [int(end)])
    return found


def test_a_segment_is_at_the_end_within_a_tenth_of_its_line() -> None:
    line = one_line([900.0, *[700.0] * 8, 600.0, 500.0], LineEnd.GEAR_TOE)
    assert at_line_end(line)[0, 0].tolist() == [True, True, *[False] * 7, True, True, True]
    assert max_inner_pressure(line).tolist() == [700.0]


def test_the_border_of_the_flank_counts_as_an_end() -> None:
    line = one_line([700.0] * 11, LineEnd.GEAR_TIP)
    line["profile"][..., 5] = 0.99
    assert at_line_end(line)[0, 0, 5]


def test_the_excess_over_the_greatest_pressure_inside_is_told() -> None:
    line = one_line([840.0, *[700.0] * 10], LineEnd.GEAR_TOE)
    (note,) = end_notes(line)
    assert "at 50 N m the greatest pressure, 840 MPa, is at the end of a contact line (gear toe): 20 % above" in note
    assert "some 6 %" in note
    assert end_notes(one_line([700.0] * 11, LineEnd.INSIDE)) == []
    assert end_notes(line.drop_vars("max_pressure_line_end")) == []  # an older result


def test_where_only_ends_carry_nothing_is_inside() -> None:
    (note,) = end_notes(one_line([840.0, 0.0, 0.0, 0.0, 0.0], LineEnd.GEAR_HEEL))
    assert "no pressure is inside" in note


@pytest.mark.parametrize(("share", "told"), [(0.9 * TOLD_SHARE, False), (1.1 * TOLD_SHARE, True)])
def test_load_on_edges_is_told_from_a_few_per_cent_on(share: float, told: bool) -> None:
    loaded = xr.Dataset({"edge_share": (("torque", "mesh_position"), [[share]])}, coords={"torque": [50.0]})
    assert [("no pressure is given" in note) for note in edge_notes(loaded)] == ([True] if told else [])


@cache
def supported(name: str, position: float | None = None) -> xr.DataTree:
    """``nasa-12x36`` on shipped supports, the first bearing of the pinion at another place if one is given."""
    table = read_supports(name)
    if position is not None:
        assert table.pinion is not None
        first, *others = table.pinion.bearings
        moved = (first.model_copy(update={"position": position}), *others)
        table = table.model_copy(update={"pinion": table.pinion.model_copy(update={"bearings": moved})})
        return easeoff.analyze(with_supports(coarse("nasa-12x36"), table))
    return easeoff.analyze(coarse("nasa-12x36"), supports=name)


def test_supports_of_another_pair_are_told() -> None:
    other = supports_notes(supported("axle-fm-11x41"))
    assert "those of another pair, fm-11x41" in other[0]
    assert "those of another pair" in " ".join(result_summary(supported("axle-fm-11x41")).split())
    assert not any("another pair" in note for note in supports_notes(supported("gearbox-nasa-12x36")))


def test_a_bearing_between_toe_and_heel_is_told() -> None:
    tree = supported("gearbox-nasa-12x36")
    assert not any("within the teeth" in note for note in supports_notes(tree))
    first, last = axial_face(tree, "pinion")
    middle = round(0.5 * (first + last), 1)
    (note,) = [n for n in supports_notes(supported("gearbox-nasa-12x36", middle)) if "within the teeth" in n]
    assert f"is at {middle:.1f} mm on the axis" in note
    assert "pinion" in note


def test_the_face_on_the_axis_is_that_of_the_blank() -> None:
    """Along its axis a face is as long as its middle, between root and face cone, times the cosine of its angle."""
    tree = supported("gearbox-nasa-12x36")
    case = easeoff.read_case("nasa-12x36")
    for member in ("pinion", "gear"):
        first, last = axial_face(tree, member)
        blank = getattr(case, member).blank
        pitch = np.radians(blank.pitch_angle)
        heel = blank.outer_cone_distance * np.cos(pitch) - blank.pitch_apex_beyond_crossing_point
        assert first < heel - 0.5 * blank.face_width * np.cos(pitch) < last
        assert abs(last - heel) < 6.0  # the height of the tooth at the heel


def test_bearings_that_share_the_axial_load_in_one_sense_are_told() -> None:
    """Equal springs on a stiff shaft share the axial load, which opposed taper rollers do not."""
    (note,) = [n for n in supports_notes(supported("gearbox-nasa-12x36")) if "same sense" in n]
    assert "pinion head" in note
    assert "one is relieved" in note


def test_no_supports_have_no_note() -> None:
    assert supports_notes(easeoff.analyze(coarse("nasa-12x36"))) == []
