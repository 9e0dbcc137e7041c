"""Notes on what a customer must not overlook: line ends, edges, jumps of the pressure, supports of another pair."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr
from runs import small

import easeoff
from easeoff.cases import Case, read_supports, shipped_cases
from easeoff.cases.reading import with_supports
from easeoff.contact.evaluation.pressure_map import LineEnd, at_line_end, max_inner_pressure
from easeoff.geometry import Misalignment
from easeoff.study.plot import mesh_cycle_charts
from easeoff.study.plot.page import page
from easeoff.study.summary.plausibility import (
    EDGE_SHARE as TOLD_SHARE,
    EDGE_SHARE_LIMIT,
    JUMP_LIMIT,
    MESH_POSITION_MINIMUM,
    axial_face,
    doubts,
    edge_notes,
    end_notes,
    jump_notes,
    pressure_jumps,
    supports_notes,
)
from easeoff.study.summary.result_summary import efficiencies, result_summary
from easeoff.study.vh import round_values


@cache
def case() -> Case:
    return small(compliance="shell", torques=(100.0,), edge_contact=True)


@cache
def on_lines() -> xr.DataTree:
    """An analysis without supports, on lines alone."""
    return easeoff.analyze(case(), edge_contact=False)


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


@pytest.mark.parametrize(
    ("end", "told"), [(LineEnd.GEAR_HEEL, True), (LineEnd.PINION_TOE, True), (LineEnd.PINION_TIP, False)]
)
def test_what_is_too_low_at_the_ends_of_teeth_is_told(end: LineEnd, told: bool) -> None:
    (note,) = end_notes(one_line([840.0, *[700.0] * 10], end))
    assert ("up to some 8 % too low where the mate's tooth goes on beyond this end" in note) == told


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
        return easeoff.analyze(with_supports(case(), table))
    return easeoff.analyze(case(), supports=name)


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
    for member in ("pinion", "gear"):
        first, last = axial_face(tree, member)
        blank = getattr(case(), member).blank
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
    assert supports_notes(on_lines()) == []


def test_contact_ratios_say_whether_edges_count() -> None:
    """Edges carry beside the contact lines, so that the ratio under load may exceed the geometric one."""
    with_edges = " ".join(result_summary(supported("gearbox-nasa-12x36")).split())
    assert "contact ratio, with edges" in with_edges
    assert "of contact lines alone; under load edges beside them count, too" in with_edges
    lines = " ".join(result_summary(on_lines()).split())
    assert "with edges" not in lines
    assert "of contact lines alone" not in lines


@pytest.mark.parametrize(("beyond", "written"), [(0.3, ["0.0512", "1234.6", "1.5", "95.43"]), (0.5, ["0.051", "95.4"])])
def test_an_efficiency_beyond_the_formula_has_fewer_digits(beyond: float, written: list[str]) -> None:
    over = ("torque", "speed", "temperature", "roughness")
    values = {"efficiency": 0.95432, "mean_power_loss": 1234.56, "mean_rolling_loss": 18.5}
    values |= {"mean_friction_coefficient": 0.05123, "extrapolated_share": beyond}
    friction = xr.Dataset(
        {name: (over, np.full((1, 1, 1, 1), value)) for name, value in values.items()}
        | {"temperature_clamped": ("temperature", [0])}
        | {f"roughness_{member}": ("roughness", [0.8]) for member in ("pinion", "gear")},
        coords={"torque": [100.0], "speed": [500.0], "temperature": [90.0], "roughness": [0.8]},
    )
    table = efficiencies(friction)
    assert set(written) <= set(table.split())
    assert ("with fewer digits" in table) == (beyond > 0.4)


def test_a_picture_says_that_supports_misalign() -> None:
    tree = supported("gearbox-nasa-12x36")
    figure = page(tree, "Pressure", 2.0)
    words = " ".join(text.get_text() for text in figure.texts).split()
    assert "none without load, then that of the supports" in " ".join(words)


def test_values_of_a_vh_grid_are_multiples_of_half_a_round_step() -> None:
    assert round_values(-0.51, 0.43, 5).tolist() == pytest.approx([-0.6, -0.3, 0.0, 0.3, 0.6])


@pytest.mark.parametrize("low", [-0.51, -0.08, 0.0])
@pytest.mark.parametrize("count", [2, 5, 8])
def test_values_of_a_vh_grid_are_round_and_cover_the_range(low: float, count: int) -> None:
    values = round_values(low, low + 0.7, count)
    assert values[0] <= low + 1e-9
    assert values[-1] >= low + 0.7 - 1e-9
    assert np.ptp(values) < 2.6 * 0.7
    assert all(len(f"{value:.6g}".lstrip("-")) <= 6 for value in values)


# A pair whose edges carry much is told: there the contact on edges is coarse


@cache
def loaded(name: str, *, edges: bool = True) -> xr.DataTree:
    return easeoff.analyze(small(name, "shell"), torques=50.0, edge_contact=edges)


def test_only_a_pair_that_rests_on_its_edges_is_told() -> None:
    tree = loaded("nasa-12x36")
    share = tree["loaded"]["edge_share"].max().item()
    assert share > EDGE_SHARE_LIMIT
    (note,) = edge_notes(tree["loaded"].to_dataset())
    assert f"up to {100 * share:.0f} % of the load (50 N m)" in note
    assert "tooth edges carry" in " ".join(result_summary(tree).split())
    assert edge_notes(loaded("fm-11x41")["loaded"].to_dataset()) == []
    assert edge_notes(loaded("nasa-12x36", edges=False)["loaded"].to_dataset()) == []


def test_the_torque_that_loads_the_edges_most_is_named() -> None:
    share = np.array([[0.05, np.nan], [0.3, 0.1]])
    told = xr.Dataset({"edge_share": (("torque", "mesh_position"), share)}, coords={"torque": [10.0, 20.0]})
    assert "30 % of the load (20 N m)" in edge_notes(told)[0]
    unsolved = told.assign(edge_share=told["edge_share"] * np.nan)
    assert edge_notes(unsolved) == []


# A greatest pressure that stands out of its course over the mesh cycle is told, wherever the pressure is told


@cache
def plain() -> xr.DataTree:
    return easeoff.analyze(small("nasa-12x36", "shell", mesh_positions=MESH_POSITION_MINIMUM), torques=[50.0, 100.0])


def planted(places: dict[tuple[int, int], float]) -> xr.DataTree:
    """Greatest pressures at a torque and a mesh position as many times the greater of those beside it."""
    loaded = plain()["loaded"].to_dataset().copy(deep=True)
    greatest = loaded["pressure"].max("segment").values
    for (torque, position), factor in places.items():
        beside = max(greatest[torque, (position + step) % MESH_POSITION_MINIMUM] for step in (-1, 1))
        loaded["pressure"].values[torque, position] *= factor * beside / greatest[torque, position]
    groups = dict(plain().to_dict())
    return xr.DataTree.from_dict(groups | {"/loaded": loaded})


def test_a_smooth_course_has_no_note() -> None:
    loaded = plain()["loaded"].to_dataset()
    assert float(np.nanmax(pressure_jumps(loaded))) < JUMP_LIMIT
    assert jump_notes(loaded) == []


@pytest.mark.parametrize("position", [0, 5, MESH_POSITION_MINIMUM - 1])
def test_a_planted_jump_is_told_with_torque_position_and_size(position: int) -> None:
    """The first and the last position of the cycle are neighbours."""
    tree = planted({(1, position): 1.5})
    loaded = tree["loaded"].to_dataset()
    assert pressure_jumps(loaded)[1, position] == pytest.approx(0.5, rel=1e-12)
    (note,) = jump_notes(loaded)
    peak = loaded["pressure"].isel(torque=1, mesh_position=position).max().item()
    place = f"at 100 N m the greatest pressure jumps to {peak:.0f} MPa at mesh position {position / 16:.4g}, 50 % above"
    assert note.startswith(f"Note: {place} both neighbouring positions: more mesh_positions")
    assert note in doubts(tree)
    assert place in " ".join(result_summary(tree).split())


@pytest.mark.parametrize(("factor", "told"), [(1.0 + 0.95 * JUMP_LIMIT, False), (1.0 + 1.05 * JUMP_LIMIT, True)])
def test_the_limit_decides(factor: float, told: bool) -> None:
    assert bool(jump_notes(planted({(0, 7): factor})["loaded"].to_dataset())) == told


def test_the_greatest_jump_is_told_and_other_torques_are_counted() -> None:
    (note,) = jump_notes(planted({(0, 3): 1.3, (1, 9): 1.6})["loaded"].to_dataset())
    assert "at 100 N m" in note
    assert "60 % above both neighbouring positions, and likewise at 1 more torque:" in note


def test_beside_what_is_not_certified_nothing_is_told() -> None:
    loaded = planted({(0, 3): 1.5})["loaded"].to_dataset()
    loaded["pressure"].values[0, 4] = np.nan
    assert np.isnan(pressure_jumps(loaded)[0, [3, 4, 5]]).all()
    assert jump_notes(loaded) == []


def test_few_positions_are_no_course() -> None:
    loaded = planted({(0, 3): 1.5})["loaded"].to_dataset()
    assert jump_notes(loaded.isel(mesh_position=slice(1, 9))) == []


def test_the_picture_of_the_pressure_says_it() -> None:
    def words(tree: xr.DataTree) -> str:
        figure: Any = mesh_cycle_charts.pressure(tree)
        return " ".join(" ".join(text.get_text() for text in figure.texts).split())

    assert "the greatest pressure jumps to" in words(planted({(1, 5): 1.5}))
    assert "jumps" not in words(plain())


@pytest.mark.thorough
@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize("name", sorted(shipped_cases()))
def test_shipped_cases_have_none(name: str, flank: Any) -> None:
    loaded = easeoff.analyze(name, flank=flank, torques=[20.0, 300.0])["loaded"].to_dataset()
    assert float(np.nanmax(pressure_jumps(loaded))) < JUMP_LIMIT


def test_a_misaligned_pair_has_one_where_a_contact_line_ends_unless_edges_touch() -> None:
    positions = easeoff.read_case("fm-11x41").contact.mesh_positions
    case = small("fm-11x41", "shell", mesh_positions=positions, lengthwise_nodes=21, profile_nodes=15)

    def notes(edge_contact: bool) -> list[str]:
        misalignment = Misalignment(offset=-0.25, pinion_axial=0.3)
        tree = easeoff.analyze(case, torques=[30.0], misalignment=misalignment, edge_contact=edge_contact)
        return jump_notes(tree["loaded"].to_dataset())

    (note,) = notes(edge_contact=False)
    assert "at 30 N m the greatest pressure jumps" in note
    assert notes(edge_contact=True) == []
