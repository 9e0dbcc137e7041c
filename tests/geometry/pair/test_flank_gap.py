"""The gap between flanks along a ray and its least value: closed form, conventional contact analysis, bounds."""

from __future__ import annotations

import numpy as np
import pytest
from pairs import conjugate_pair

from easeoff.cases import gear_pair, read_case
from easeoff.geometry import PairGeometry, pair_geometry
from easeoff.geometry.pair.ease_off import exact_ease_off
from easeoff.geometry.pair.gear_pair import grid
from easeoff.verification import smallest_gap, smallest_gap as search
from easeoff.verification.conventional_analysis import path_of_contact
from easeoff.verification.smallest_gap import flank_gap, smallest_envelope


def test_no_gap_where_the_flanks_touch() -> None:
    """At the points of contact of the five equations gap and place agree; turning on closes by the lever arm."""
    pair = gear_pair(read_case("fm-11x41"))
    gear = pair.gear.flank(*grid((9, 7)))
    surface = exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)
    motion = surface.motion
    for rotation in (-0.15, 0.0, 0.2):
        contact = path_of_contact(gear, surface, np.array([rotation]))
        assert contact.converged.all()
        position, normal, _ = pair.gear.loaded.evaluate(contact.gear_parameters)
        turned, closing = rotation + motion.center, float(contact.closing_angle[0])
        start = contact.pinion_parameters + 0.01
        found = flank_gap(motion, position, normal, turned, closing, start)
        assert abs(found.gap[0]) < 1e-8
        np.testing.assert_allclose(found.pinion_position, contact.pinion_position, atol=1e-7)
        np.testing.assert_allclose(found.facing, 1.0, atol=1e-12)
        arm = np.abs(position[0] * normal[1] - position[1] * normal[0])
        further = flank_gap(motion, position, normal, turned, closing - 1e-5, start)
        np.testing.assert_allclose(further.gap, 1e-5 * arm, rtol=1e-3)


def test_no_gap_is_a_number_where_no_flank_is() -> None:
    pair = gear_pair(read_case("fm-11x41"))
    gear = pair.gear.flank(*grid((5, 5)))
    surface = exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)
    far = gear.position[:, :1] + np.array([[0.0], [0.0], [300.0]])
    found = flank_gap(surface.motion, far, gear.normal[:, :1], 0.0, 0.0, surface.pinion_parameters[:, :1])
    assert np.all(np.isnan(found.gap))


# Direct search of the smallest gap: closed form, conventional contact analysis, its own grid, edges as bounds


@pytest.fixture(scope="module")
def nasa() -> PairGeometry:
    return pair_geometry(gear_pair(read_case("nasa-12x36")), (15, 11))


def test_conjugate_pair_has_no_gap() -> None:
    geometry = pair_geometry(conjugate_pair(), (9, 7))
    found = smallest_gap(geometry, np.array([0.1]))
    np.testing.assert_allclose(found.closing_angle, geometry.ease_off.attrs["first_contact_rad"], rtol=0, atol=1e-10)


def test_agrees_with_conventional_contact_analysis_inside(nasa: PairGeometry) -> None:
    """Five equations for a point where the normals are opposed."""
    rotations = np.array([-0.05, 0.03])
    found = smallest_gap(nasa, rotations)
    assert found.edge.tolist() == ["", ""]
    contact = path_of_contact(nasa.members.gear, nasa.exact, rotations)
    assert contact.converged.all()
    np.testing.assert_allclose(found.closing_angle, contact.closing_angle, rtol=0, atol=1e-11)
    section = nasa.pair.gear.section
    own = section.fractions(contact.gear_position[2], np.hypot(*contact.gear_position[:2]))
    np.testing.assert_allclose(found.gear, np.stack(own), atol=2e-5)


def test_an_edge_holds_the_gear_before_the_point_where_the_normals_are_opposed(nasa: PairGeometry) -> None:
    """That point lies beyond the tip of the pinion: the bounded flanks touch later, at the tip."""
    rotation = np.array([0.12])
    found = smallest_gap(nasa, rotation)
    assert found.edge.tolist() == ["pinion tip"]
    assert found.pinion[1, 0] == pytest.approx(1.0, abs=1e-12)
    beyond = path_of_contact(nasa.members.gear, nasa.exact, rotation)
    tip = nasa.pair.pinion.section.fractions(beyond.pinion_position[2], np.hypot(*beyond.pinion_position[:2]))[1]
    assert tip[0] > 1.0
    assert found.closing_angle[0] > beyond.closing_angle[0] + 1e-6


def test_envelope_is_the_smallest_of_all_tooth_pairs(nasa: PairGeometry) -> None:
    smallest, pair = smallest_envelope(nasa, np.array([-0.2, 0.0]))
    assert pair.tolist() == [-1, 0]
    single = smallest_gap(nasa, np.array([-0.2, -0.2 + nasa.pair.assembly.pinion_pitch]))
    assert smallest.closing_angle[0] == pytest.approx(single.closing_angle.min(), abs=1e-12)


@pytest.mark.thorough
def test_does_not_depend_on_its_nodes(nasa: PairGeometry, monkeypatch: pytest.MonkeyPatch) -> None:
    rotations = np.linspace(-0.4, 0.4, 5)
    usual = smallest_gap(nasa, rotations).closing_angle
    module = __import__(search.__module__, fromlist=["FIELD_NODES"])
    monkeypatch.setattr(module, "FIELD_NODES", (67, 49))
    monkeypatch.setattr(module, "EDGE_NODES", 201)
    np.testing.assert_allclose(smallest_gap(nasa, rotations).closing_angle, usual, rtol=0, atol=1e-10)
