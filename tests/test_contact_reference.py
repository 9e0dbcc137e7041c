"""Today's analyses against the stored contact without the split: docs/make contact_reference."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from easeoff.cases import Case

FINENESS = 0.7  # of the bricks here, for the sake of time: one per cent softer or stiffer
FEW = {"mesh_positions": 16, "segments_per_line": 21, "lengthwise_nodes": 21, "profile_nodes": 15}


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
        return case.model_copy(update={"contact": case.contact.model_copy(update=FEW)})

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
