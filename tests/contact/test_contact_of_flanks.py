"""Contact of a pair without the split: statics, places, the answer kept from many bricks, and analyses beside it."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr
from places import DATA
from tooth_models import FEW

from easeoff import InputError
from easeoff.cases import Case, gear_pair, read_case
from easeoff.contact import STEEL, MeshLines, lines_in_mesh
from easeoff.geometry import LatticeSize
from easeoff.geometry.tooth.tooth_lattice import LatticeSpacing
from easeoff.verification import (
    FlankContact,
    FlankResponse,
    FlanksInMesh,
    contact_of_flanks,
    flank_response,
    flanks_in_mesh,
)
from easeoff.verification.flank_contact import greatest_stretch_load, line_directions, stretch_load
from easeoff.verification.flank_response import thinner_edges
from easeoff.verification.surface_cells import cells_on_line

NAME, TORQUE, POSITIONS = "fm-11x41", 250.0, 32
KEPT = DATA / "contact_reference" / f"{NAME}.nc"


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


# Today's analyses against the stored contact without the split: docs/make contact_reference


FINENESS = 0.7  # of the bricks here, for the sake of time: one per cent softer or stiffer
FEW_POSITIONS = {"mesh_positions": 16, "segments_per_line": 21, "lengthwise_nodes": 21, "profile_nodes": 15}


@pytest.fixture(scope="module")
def kept() -> Any:
    """What is kept, and how an analysis differs from it."""
    return importlib.import_module("contact_reference")


@pytest.fixture
def coarse_analyses(kept: Any, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """The same with analyses at no other positions than what is kept, on few segments and nodes."""
    read_case = kept.easeoff.read_case

    def coarse(name: str) -> Case:
        case: Case = read_case(name)
        return case.model_copy(update={"contact": case.contact.model_copy(update=FEW_POSITIONS)})

    monkeypatch.setattr(kept.easeoff, "read_case", coarse)
    kept.analysed.cache_clear()
    yield kept
    kept.analysed.cache_clear()


def test_kept_contact_balances(kept: Any) -> None:
    """Every position solved, shares adding up, enough positions for a mean and a peak to peak, no pull."""
    for name in kept.NAMES:
        reference = kept.reference(name)
        assert reference.sizes["mesh_position"] >= 5
        assert np.all(np.isfinite(reference["transmission_error"]))
        np.testing.assert_allclose(reference["load_share"].sum("pair"), 1.0, atol=1e-9)
        assert float(reference["load_share"].min()) >= 0.0
        assert float(reference["pressure"].min()) > 0.0


@pytest.mark.thorough
def test_finite_elements(kept: Any) -> None:
    """Mean within 3 %, peak to peak within 10 %, load share within 3 % of the load, pressure within 5 %.

    Also where edges beside the contact lines carry up to 8 % of it: at great torque, and misaligned.
    """
    torques = [("fm-11x41", torque) for torque in kept.TORQUES["fm-11x41"]]
    for name, torque in (*torques, ("fm-11x41-toe", 50.0), ("fm-11x41-heel", 50.0), ("fh-12x41-45", 200.0)):
        found = kept.difference(name, "fe", torque, FINENESS)
        assert abs(found.mean) < 3.0
        assert found.error < 3.0
        theirs, ours = found.peak_to_peak
        assert ours == pytest.approx(theirs, rel=0.1)
        assert found.share < 3.0
        assert abs(found.peak) < 5.0
        assert found.pressure < 3.0


def test_finite_elements_where_lines_touch(coarse_analyses: Any) -> None:
    """Without edges on either side the split alone is left: load share within 2 %."""
    for torque in coarse_analyses.TORQUES["fm-11x41"]:
        found = coarse_analyses.difference("fm-11x41", "fe", torque, 0.5, edges="on lines")
        assert abs(found.mean) < 3.0
        theirs, ours = found.peak_to_peak
        assert ours == pytest.approx(theirs, rel=0.1)
        assert found.share < 2.0


def test_edges_are_what_a_line_contact_lacks(coarse_analyses: Any) -> None:
    """Load shares at the toe, where the next tooth pair is met at its edge: off by 6.5 % without, 1.5 % with."""
    without, with_edges = (
        coarse_analyses.difference("fm-11x41-toe", "shell", 50.0, edge_contact=edge_contact)
        for edge_contact in (False, True)
    )
    assert without.share > 5.0
    assert with_edges.share < 3.0


@pytest.mark.thorough
def test_solid_shell(kept: Any) -> None:
    """As finite elements in the mean and the pressure, without their time."""
    for torque in kept.TORQUES["fm-11x41"]:
        found = kept.difference("fm-11x41", "solid_shell", torque)
        assert abs(found.mean) < 3.0
        assert abs(found.peak) < 5.0


@pytest.mark.thorough
def test_the_default(kept: Any) -> None:
    """Solid shells whose edges may touch, as every case has them that says nothing else.

    At every position of both pairs, misaligned ones too: rotation within 0.5 % of its mean, shares within 0.5 % of the
    load (1 % at the toe, where edges meet), peak to peak within 4 % or 0.5 urad, greatest pressure away from edges
    within 1 %: a line load within 2 %.
    """
    for name in kept.NAMES:
        case = kept.easeoff.read_case(kept.setting(name)[0])
        assert case.contact.edge_contact
        for torque in kept.setting(name)[1]:
            found = kept.difference(name, case.compliance.model, torque)
            assert found.error < 0.5
            assert abs(found.mean) < 0.3
            theirs, ours = found.peak_to_peak
            assert ours == pytest.approx(theirs, rel=0.04, abs=0.5)
            assert found.share < (1.0 if name == "fm-11x41-toe" else 0.5)
            assert abs(found.peak) < 1.0
            assert found.pressure < 3.3


def test_shell(coarse_analyses: Any) -> None:
    """On lines alone: mean within 5 % on both pairs and with misalignment; pressure within 5 %."""
    for name in coarse_analyses.NAMES:
        for torque in coarse_analyses.setting(name)[1]:
            found = coarse_analyses.difference(name, "shell", torque, edge_contact=False)
            assert abs(found.mean) < 5.0
            assert abs(found.peak) < 5.0


# Greatest load per length over stretches of a line: sums that do not depend on how the line is divided


def parabola(pieces: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pieces of a line of 4 mm under the line load 300 (1 - (x/2)^2) N/mm: middles, lengths, forces."""
    ends = np.linspace(-2.0, 2.0, pieces + 1)
    force = np.diff(300.0 * (ends - ends**3 / 12.0))
    return 0.5 * (ends[1:] + ends[:-1]), np.diff(ends), force


@pytest.mark.parametrize("stretch", [0.5, 1.5, 3.0])
def test_mean_of_a_parabola(stretch: float) -> None:
    """In its middle 300 (1 - w^2 / 48) N/mm; pieces of a line are second order, and never above the true maximum."""
    exact = 300.0 * (1.0 - stretch**2 / 48.0)
    errors = [exact - greatest_stretch_load(*parabola(pieces), stretch) for pieces in (11, 44)]
    assert abs(errors[1]) < 1e-3 * exact
    assert abs(errors[1]) < 0.2 * abs(errors[0]) + 1e-9


def test_dividing_pieces_changes_nothing() -> None:
    place, length, force = parabola(7)
    halves = np.concatenate([place - 0.25 * length, place + 0.25 * length])
    twice = greatest_stretch_load(halves, np.tile(0.5 * length, 2), np.tile(0.5 * force, 2), 1.3)
    assert twice == pytest.approx(greatest_stretch_load(place, length, force, 1.3), rel=1e-12)


def test_overlapping_pieces_add_up() -> None:
    """Segments of a line and pieces of an edge beside them, and cells side by side across a line."""
    place, length, force = parabola(7)
    both = greatest_stretch_load(np.tile(place, 2), np.tile(length, 2), np.concatenate([force, 2.0 * force]), 1.0)
    assert both == pytest.approx(3.0 * greatest_stretch_load(place, length, force, 1.0), rel=1e-12)


def test_a_stretch_longer_than_the_line_bears_all_of_it() -> None:
    place, length, force = parabola(7)
    assert greatest_stretch_load(place, length, force, 8.0) == pytest.approx(force.sum() / 8.0, rel=1e-12)
    assert greatest_stretch_load(place, length, 0.0 * force, 8.0) == 0.0


def test_a_contact_without_load_has_no_stations_and_no_load_per_length(kept: Any) -> None:
    pair, contact = gear_pair(read_case("nasa-12x36")), FlankContact(0.0, [], [], [])
    assert kept.line_stations(pair, contact).shape == (6, 0)
    assert line_directions(contact) == []
    assert stretch_load(contact, 1.0) == 0.0
    assert kept.edge_distance(pair.gear.section, np.array([0.5, 1.0])) == 0.0
