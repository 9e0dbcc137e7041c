"""Free ends of teeth: the formula against finite elements, its place in the line contact, distances from the ends."""

from __future__ import annotations

import math

import numpy as np
import pytest

from easeoff import InputError
from easeoff.cases import gear_pair, read_case
from easeoff.contact import STEEL, Material, MeshCycle, WeberLineContact
from easeoff.contact.compliance.free_end import free_end_deflection
from easeoff.contact.lines.end_distance import end_distances
from easeoff.geometry import pair_geometry
from easeoff.verification import end_relief

PART_OF_DEPTH = (0.02, 3.0)


@pytest.mark.thorough
@pytest.mark.parametrize("poisson_ratio", [0.1, 0.2, 0.25, 0.3, 0.35, 0.4])
def test_the_formula_agrees_with_finite_elements_of_a_quarter_space(poisson_ratio: float) -> None:
    material = Material(206000.0, poisson_ratio)
    found = end_relief(material, borders=9)
    row = int(np.argmin(np.abs(found.depth - 1.0)))
    depth = found.depth[row]
    share = found.distance / depth
    chosen = (share > PART_OF_DEPTH[0]) & (share < PART_OF_DEPTH[1])
    reference = found.approach(row)[chosen] * material.plane_strain_modulus
    formula = free_end_deflection(np.full(chosen.sum(), depth), found.distance[chosen], material)
    away = share[chosen] > 0.1  # nearer, the distance of the formula levels off
    difference = formula * material.plane_strain_modulus - reference
    assert np.abs(difference[away]).max() < 0.012
    assert np.abs(difference[~away]).max() < 0.07


@pytest.mark.thorough
def test_farther_borders_change_the_relief_little() -> None:
    coarse, fine = (end_relief(STEEL, borders=borders) for borders in (7, 8))
    row = int(np.argmin(np.abs(fine.depth - 0.24)))
    chosen = slice(2, 9)
    assert fine.approach(row)[chosen] == pytest.approx(coarse.approach(row)[chosen], rel=0.03)


def test_without_lateral_contraction_a_square_end_adds_nothing() -> None:
    nothing = Material(206000.0, 0.0)
    assert np.abs(end_relief(nothing, borders=4).sinking).max() < 1e-16
    assert free_end_deflection(np.ones(1), np.zeros(1), nothing) == 0.0


def test_it_is_a_part_of_the_deflection_that_grows_with_the_load() -> None:
    one = np.ones(2)
    size = (2.0 * one, 30.0 * one, 3.0 * one, 4.0 * one, STEEL, STEEL)
    free = np.array([0.0, 2e-6])
    plain, softer = WeberLineContact(*size), WeberLineContact(*size, free_end=free)
    for force in (1e-3 * one, 800.0 * one):
        added = force / 2.0 * free
        assert softer.deflection(force) == pytest.approx(plain.deflection(force) + added, rel=1e-12)
        assert softer.tangent(force) == pytest.approx(plain.tangent(force) + free / 2.0, rel=1e-12)
        assert softer.energy(force) == pytest.approx(plain.energy(force) + 0.5 * force * added, rel=1e-9)
    joined = WeberLineContact.joined([plain, softer])
    assert joined.deflection(np.full(4, 9.0))[3] == softer.deflection(9.0 * one)[1]
    assert joined.part(slice(3, 4)).deflection(np.array([9.0])) == softer.deflection(9.0 * one)[1]
    with pytest.raises(InputError, match="free_end = -1: must be at least 0"):
        WeberLineContact(*size, free_end=np.array(-1.0))


def test_distances_from_both_ends_add_up_along_a_cross_section() -> None:
    pair = gear_pair(read_case("nasa-12x36"))
    geometry = pair_geometry(pair, (17, 11))
    cycle = MeshCycle.of(geometry, mesh_positions=4, segments_per_line=5)
    fields = cycle.segments.fields
    points = np.stack([np.array([0.0, 0.25, 0.5, 1.0]), np.full(4, 0.5)])
    of_gear = end_distances(fields, "gear", points)
    assert of_gear[0, 0] == of_gear[1, 3] == 0.0
    # A short step at right angles to the toe: along the gradient of the lengthwise fraction.
    tangents = [fields("position", points[:, [1]], order)[:, 0] for order in ((1, 0), (0, 1))]
    across = tangents[0] - tangents[1] * (tangents[0] @ tangents[1]) / (tangents[1] @ tangents[1])
    assert of_gear[0, 1] == pytest.approx(0.25 * np.linalg.norm(across), rel=1e-9)
    of_pinion = end_distances(fields, "pinion", points)
    assert np.all(of_pinion >= 0.0)
    assert of_pinion[:, 2] == pytest.approx(of_gear[:, 2], rel=0.25)


def test_plates_know_nothing_of_it() -> None:
    geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    solid = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=5).segments.table["free_end"]
    assert np.all(solid > 0.0)
    assert solid.max() * STEEL.plane_strain_modulus < 4.0 * math.log1p(1.0 / 0.03) * 0.15
