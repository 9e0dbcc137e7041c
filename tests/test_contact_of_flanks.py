"""Contact of a pair without the split, on few bricks: statics, places, and the answer kept from many bricks."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from easeoff import InputError
from easeoff.cases import gear_pair, read_case
from easeoff.contact import STEEL, MeshLines, lines_in_mesh
from easeoff.geometry import LatticeSize, LatticeSpacing
from easeoff.verification import (
    FlankContact,
    FlankResponse,
    FlanksInMesh,
    contact_of_flanks,
    flank_response,
    flanks_in_mesh,
)
from easeoff.verification.flank_contact.flank_response import thinner_edges
from easeoff.verification.flank_contact.surface_cells import cells_on_line

NAME, TORQUE, POSITIONS = "fm-11x41", 250.0, 32
KEPT = Path(__file__).parent / "data" / "contact_reference" / f"{NAME}.nc"
FEW = LatticeSize(lengthwise=6, upward=4, through=2, slot=1, beside=1, deep=1, overhang=1)


@cache
def in_mesh() -> tuple[FlanksInMesh, MeshLines]:
    flanks = flanks_in_mesh(gear_pair(read_case(NAME)), (17, 13))
    return flanks, lines_in_mesh(flanks.splines, flanks.pair.assembly.pinion_pitch, POSITIONS)


@cache
def responses() -> tuple[FlankResponse, FlankResponse]:
    pair = gear_pair(read_case(NAME))
    return flank_response(pair, "pinion", STEEL, FEW), flank_response(pair, "gear", STEEL, FEW)


@cache
def contact(position: int, beyond_lines: bool = True) -> FlankContact:
    flanks, mesh = in_mesh()
    guess = {"half_width": 0.4, "rotation": 1e-4, "cells_per_half_width": 4.0, "beyond_lines": beyond_lines}
    return contact_of_flanks(flanks, responses(), (STEEL, STEEL), mesh, position, TORQUE, **guess)  # type: ignore[arg-type]


@pytest.mark.thorough
def test_pressures_carry_the_torque_and_end_within_the_cells() -> None:
    """Though the cells were laid for a quarter of the rotation."""
    for position in (0, 16):
        found = contact(position)
        moment = sum(float(f @ c.lever_arm) for f, c in zip(found.force, found.cells, strict=True))
        assert moment == pytest.approx(1e3 * TORQUE * 41 / 11, rel=1e-10)
        assert found.load_share.sum() == pytest.approx(1.0, rel=1e-12)
        for cells, force in zip(found.cells, found.force, strict=True):
            assert force.min() >= 0.0
            for place in (cells.gear_fractions, cells.pinion_fractions):
                assert place.min() >= 0.0
                assert place.max() <= 1.0
            loaded = np.abs(cells.row[force > 0.0])
            assert loaded.size == 0 or loaded.max() < np.abs(cells.row).max()


def test_few_bricks_tell_nearly_as_much_as_many() -> None:
    """The bricks know of bending and body alone: transmission error and shares within 3 % of what is kept."""
    with xr.open_dataset(KEPT, engine="netcdf4") as kept:
        for position in (0, 16):
            many = kept.sel(torque=TORQUE, mesh_position=position / POSITIONS, edges="all")
            found = contact(position)
            assert 1e6 * found.rotation == pytest.approx(float(many["transmission_error"]), rel=0.03)
            for pair, share in zip(found.pairs, found.load_share, strict=True):
                assert share == pytest.approx(float(many["load_share"].sel(pair=pair)), abs=0.03)


def test_edges_touch_before_there_is_a_line() -> None:
    """At the beginning of the cycle the next tooth has no line yet, and its edge carries some load."""
    with_edges, without = contact(0), contact(0, beyond_lines=False)
    assert 1 not in without.pairs
    assert 0.005 < with_edges.load_share[with_edges.pairs.index(1)] < 0.1
    assert with_edges.rotation < without.rotation


@pytest.mark.parametrize(("name", "value"), [("torque", -1.0), ("half_width", 0.0), ("rotation", np.nan)])
def test_impossible_numbers_are_refused(name: str, value: float) -> None:
    flanks, mesh = in_mesh()
    given = {"torque": 50.0, "half_width": 0.3, "rotation": 1e-4, name: value}
    with pytest.raises(InputError, match=name):
        contact_of_flanks(flanks, responses(), (STEEL, STEEL), mesh, 0, **given)  # type: ignore[arg-type]


def test_thin_bricks_at_the_edges() -> None:
    even = LatticeSpacing.of_size(LatticeSize(lengthwise=10, upward=6))
    thin = thinner_edges(even, (0.25, 0.5))
    for before, after, ends in ((even.lengthwise, thin.lengthwise, 2), (even.upward, thin.upward, 1)):
        assert after.size == before.size
        assert (after[0], after[-1]) == (0.0, pytest.approx(1.0))
        ratio = np.diff(after[::2]) / np.diff(before[::2])
        np.testing.assert_allclose(ratio[[-2, -1]] / ratio[3], [0.5 if ends == 2 else 1.0, 0.25])
        if ends == 2:
            np.testing.assert_allclose(after, 1.0 - after[::-1], atol=1e-15)
    assert thin.through is even.through


def test_a_line_shorter_than_a_cell_is_filled_by_two() -> None:
    flanks, _ = in_mesh()
    middle = np.array([[0.5], [0.5]])
    line = middle + np.linspace(0.0, 1e-3, 3) * np.array([[1.0], [0.0]])
    cells = cells_on_line(flanks, line, 0.0, step=(0.4, 0.05), half_band=0.05, extension=0.0, widest_gap=1.0)
    assert set(cells.station) == {0, 1}
    assert cells.sides[cells.row == 0, 0].sum() == pytest.approx(1e-3 * flanks.pair.gear.section.face_width, rel=0.5)
