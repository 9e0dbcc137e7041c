"""A greatest pressure that stands out of its course over the mesh cycle is told, wherever the pressure is told."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr
from runs import small

import easeoff
from easeoff.cases import shipped_cases
from easeoff.geometry import Misalignment
from easeoff.study import result_summary
from easeoff.study.plot import pressure_chart
from easeoff.study.plot.tooth_view import tooth_view
from easeoff.study.report.notes.pressure_jumps import JUMP_LIMIT, MESH_POSITION_MINIMUM, jump_notes, pressure_jumps
from easeoff.study.report.summary.result_summary import doubts


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
        figure: Any = pressure_chart.draw(tree, (tooth_view(tree, "gear"), tooth_view(tree, "pinion")))
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
