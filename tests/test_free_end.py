"""Free ends of teeth: the formula against finite elements, its place in the line contact, distances from the ends."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from easeoff import InputError
from easeoff.cases import gear_pair, read_case
from easeoff.contact import STEEL, Material, MeshCycle, WeberLineContact
from easeoff.contact.compliance.free_end import NEAREST_END, free_end_deflection, remaining_depth
from easeoff.contact.lines.tooth_ends import tooth_ends
from easeoff.geometry import pair_geometry
from easeoff.verification import end_relief

FARTHEST = 3.0  # depths from the end


@pytest.mark.thorough
@pytest.mark.parametrize("poisson_ratio", [0.1, 0.2, 0.25, 0.3, 0.35, 0.4])
def test_the_formula_agrees_with_finite_elements_of_a_quarter_space(poisson_ratio: float) -> None:
    material = Material(206000.0, poisson_ratio)
    found = end_relief(material, borders=9)
    row = int(np.argmin(np.abs(found.depth - 1.0)))
    depth = found.depth[row]
    share = found.distance / depth
    chosen = (share > NEAREST_END) & (share < FARTHEST)
    reference = found.approach(row)[chosen] * material.plane_strain_modulus
    # The logarithm itself: the distance that the formula levels off to that of the finite elements.
    levelled = np.sqrt(found.distance[chosen] ** 2 - (NEAREST_END * depth) ** 2)
    formula = free_end_deflection(np.full(chosen.sum(), depth), levelled, material) * material.plane_strain_modulus
    assert np.abs(formula - reference).max() < 0.012


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


@pytest.mark.thorough
@pytest.mark.parametrize(("degrees", "within"), [(30.0, 0.05), (45.0, 0.09)])
def test_an_oblique_line_gains_more(degrees: float, within: float) -> None:
    found = end_relief(STEEL, oblique=math.radians(degrees), borders=9)
    row = int(np.argmin(np.abs(found.depth - 1.0)))
    depth, cosine = found.depth[row], math.cos(math.radians(degrees))
    share = found.distance / depth
    chosen = (share > 0.1) & (share < FARTHEST)
    reference = found.approach(row)[chosen]
    formula = free_end_deflection(np.full(chosen.sum(), depth), cosine * found.distance[chosen], STEEL, cosine)
    assert np.abs(formula - reference).max() * STEEL.plane_strain_modulus < within


def test_the_end_of_a_load_takes_off_what_is_missing_beyond() -> None:
    """Against Boussinesq's displacements under the line, integrated over the load beyond the end."""
    depth, nu = 3.0, STEEL.poisson_ratio
    for away in (0.5, 1.0, 3.0):

        def approach(y: float) -> float:
            r = math.hypot(y, depth)
            return (1.0 / y - 1.0 / r - 0.5 * depth**2 / ((1.0 - nu) * r**3)) / math.pi

        missing = quad(approach, away, np.inf)[0]
        part = remaining_depth(np.array([depth]), np.array([away]), np.array([1e4]), STEEL)[0]
        assert -2.0 / math.pi * math.log(part) == pytest.approx(missing, abs=0.02)


def test_a_load_that_ends_with_its_body_takes_nothing_off() -> None:
    distance = np.linspace(0.0, 9.0, 7)
    assert np.all(remaining_depth(np.full(7, 3.0), distance, distance, STEEL) == 1.0)


def test_distances_from_both_ends_are_at_right_angles_to_them() -> None:
    geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (17, 11))
    fields = MeshCycle.of(geometry, mesh_positions=4, segments_per_line=5).segments.fields
    points = np.stack([np.array([0.0, 0.25, 0.5, 1.0]), np.full(4, 0.5)])
    of_gear = tooth_ends(fields, "gear", points)
    assert of_gear.distance[0, 0] == of_gear.distance[1, 3] == 0.0
    along, up = (fields("position", points[:, [1]], order)[:, 0] for order in ((1, 0), (0, 1)))
    across = along - up * (along @ up) / (up @ up)
    assert of_gear.distance[0, 1] == pytest.approx(0.25 * np.linalg.norm(across), rel=1e-9)
    roll = [fields("roll_angle", points[:, [1]], order)[0] for order in ((1, 0), (0, 1))]
    line = roll[1] * along - roll[0] * up
    assert of_gear.cosine[1] == pytest.approx(abs(line @ across) / np.linalg.norm(line) / np.linalg.norm(across))
    of_pinion = tooth_ends(fields, "pinion", points)
    assert np.all(of_pinion.distance >= 0.0)
    assert of_pinion.distance[:, 2] == pytest.approx(of_gear.distance[:, 2], rel=0.25)


def test_plates_know_nothing_of_it() -> None:
    geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    solid = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=5).segments.table["free_end"]
    assert np.all(solid > 0.0)
    assert solid.max() * STEEL.plane_strain_modulus < 4.0 * math.log1p(1.0 / 0.03) * 0.15
