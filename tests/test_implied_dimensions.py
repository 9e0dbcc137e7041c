"""Dimensions that a case implies, against published ones and against each other; means by force in the report."""

from __future__ import annotations

import math

import numpy as np
import pytest

import easeoff
from easeoff.cases import Case, shipped_cases
from easeoff.cases.recording import with_blanks
from easeoff.study.report.contact_report.cycle_charts import _weighted_mean
from easeoff.study.report.contact_report.implied_dimensions import ROWS, dimension_rows, implied_dimensions


def test_published_dimensions_of_the_nasa_pair() -> None:
    """NASA CR-191009: mean spiral angle 35 degrees, 20 degrees of pressure angle, a 12 inch cutter of the gear."""
    found = implied_dimensions(easeoff.read_case("nasa-12x36"))
    for member in ("pinion", "gear"):
        assert found[member]["mean_spiral_angle"] == pytest.approx(35.0, abs=0.1)
    assert 2.0 * found["gear"]["cutter_radius"] == pytest.approx(6.0 * 25.4, abs=1e-6)
    assert found["gear"]["point_width"] == pytest.approx(0.065 * 25.4, abs=1e-6)


@pytest.mark.parametrize("name", shipped_cases())
def test_members_in_mesh_have_one_normal_module(name: str) -> None:
    """Measured spiral angles and pitch radii of pinion and gear give the same module, with an offset, too."""
    found = implied_dimensions(easeoff.read_case(name))
    pinion, gear = (found[member]["mean_normal_module"] for member in ("pinion", "gear"))
    assert pinion == pytest.approx(gear, rel=3e-3)  # one was rebuilt from rounded settings


@pytest.mark.parametrize("name", shipped_cases())
def test_depth_thickness_and_places_suit_each_other(name: str) -> None:
    case = with_blanks(easeoff.read_case(name))
    for member, own in implied_dimensions(case).items():
        blank = getattr(case, member).blank
        assert set(own) == set(ROWS)
        assert own["heel"] - own["toe"] == pytest.approx(blank.face_width * math.cos(math.radians(blank.pitch_angle)))
        assert 1.5 < own["mean_depth"] / own["mean_normal_module"] < 2.5
        assert 0.3 < own["mean_normal_thickness"] / (math.pi * own["mean_normal_module"]) < 0.7


def test_what_one_set_of_flanks_cannot_tell_is_left_out() -> None:
    case: Case = easeoff.read_case("nasa-12x36")
    one_side = case.model_copy(update={"gear": case.gear.model_copy(update={"concave": None})})
    rows = {row[0]: row[3:] for row in dimension_rows(one_side)}
    assert rows["mean radius of the blade tips"][1] == "–"
    assert rows["outer pitch diameter"][1] != "–"


def test_means_by_force_ignore_what_has_none() -> None:
    """A segment that ceases to carry does so without force: the mean does not jump, as the greatest does."""
    table = np.array([[[0.05, 0.09, np.nan], [0.05, 0.09, np.nan], [np.nan] * 3]])
    force = np.array([[[100.0, 1e-9, 0.0], [100.0, 0.0, 0.0], [0.0, 0.0, 0.0]]])
    first, second, none = _weighted_mean(table, force)[0]
    assert first == pytest.approx(second, rel=1e-9)
    assert second == 0.05
    assert math.isnan(none)
