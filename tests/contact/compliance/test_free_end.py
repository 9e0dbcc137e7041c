"""Free ends of teeth: the formula against finite elements, its place among the unit loads, distances from the ends."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad
from tooth_models import coarse_solid_shells

from easeoff.cases import gear_pair, read_case
from easeoff.contact import STEEL, ElasticModel, Material, MeshCycle
from easeoff.contact.compliance.elastic_model import ElasticTeeth
from easeoff.contact.compliance.spread_deflection import (
    MODES,
    NEAREST_END,
    end_decay,
    end_loads,
    end_strength,
    missing_approach,
    remaining_depth,
)
from easeoff.contact.lines.mesh_lines import LoadedPlaces, tooth_ends
from easeoff.contact.segments import DEPTHS, END_MIDDLES, end_loads_at
from easeoff.geometry import LatticeSize, pair_geometry
from easeoff.geometry.tooth.tooth_lattice import tooth_lattice
from easeoff.geometry.tooth.tooth_surface import end_faces
from easeoff.verification import end_relief

Array = NDArray[np.float64]
HIGH = 99.0  # [mm], above the root, where the body holds nothing


def even_load(share: Array, slant: float, material: Material) -> Array:
    """What an end adds under an even load, at distances over the depth, in units of q (1 - nu^2) / E."""
    ends = np.concatenate([[0.0], np.geomspace(1e-3, 12.0, 400)])
    places, sizes = 0.5 * (ends[1:] + ends[:-1]), np.diff(ends)
    both = np.concatenate([np.sqrt(share**2 - NEAREST_END**2), places])  # without levelling off
    loads = end_loads(np.ones(both.size), both, np.full(both.size, HIGH), slant, material)
    return np.asarray(loads[:, : share.size].T @ (loads[:, share.size :] @ sizes) * material.plane_strain_modulus)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("poisson_ratio", "degrees", "relative", "absolute"),
    [
        (0.3, -35.0, 0.0, 0.05),
        (0.3, -20.0, 0.0, 0.06),
        (0.3, 0.0, 0.1, 0.06),
        (0.25, 0.0, 0.1, 0.06),
        (0.25, -25.0, 0.0, 0.06),
        (0.3, 20.0, 0.1, 0.15),
        (0.3, 30.0, 0.12, 0.3),
        (0.3, 40.0, 0.15, 0.5),
        (0.3, 50.0, 0.15, 0.8),
    ],
)
def test_under_even_load_it_agrees_with_finite_elements_of_wedges(
    poisson_ratio: float, degrees: float, relative: float, absolute: float
) -> None:
    material = Material(206000.0, poisson_ratio)
    found = end_relief(material, slant=math.radians(degrees), borders=11)
    row = int(np.argmin(np.abs(found.depth - 1.0)))
    depth = found.depth[row]
    share = found.distance / depth
    chosen = (share > 0.06) & (share < 3.0)
    # The relief is on top of plane strain; the formula on top of a load that ends with the body.
    reference = found.approach(row)[chosen] * material.plane_strain_modulus
    reference += missing_approach(np.full(chosen.sum(), depth), found.distance[chosen], material)
    ours = even_load(share[chosen], math.radians(degrees), material)
    assert np.max(np.abs(ours - reference) - relative * reference) < absolute


@pytest.mark.thorough
def test_farther_borders_change_the_relief_little() -> None:
    coarse, fine = (end_relief(STEEL, borders=borders) for borders in (7, 8))
    row = int(np.argmin(np.abs(fine.depth - 0.24)))
    chosen = slice(2, 9)
    assert fine.approach(row)[chosen] == pytest.approx(coarse.approach(row)[chosen], rel=0.03)


def test_without_lateral_contraction_a_square_end_is_a_mirror() -> None:
    nothing = Material(206000.0, 0.0)
    assert np.abs(end_relief(nothing, borders=4).sinking).max() < 1e-16
    assert end_strength(0.0, nothing) == 1.0


def test_the_sharper_an_end_the_more_it_adds_and_the_farther_it_reaches() -> None:
    strength = [end_strength(math.radians(degrees), STEEL) for degrees in (-35.0, 0.0, 20.0)]
    decay = [end_decay(math.radians(degrees)) for degrees in (0.0, 30.0, 45.0)]
    np.testing.assert_allclose(strength, [0.2, 1.67, 5.41], atol=0.005)
    np.testing.assert_allclose(decay, [(2.0, 1.0), (1.0, 1.0), (0.62, 0.9)], atol=0.005)


@pytest.mark.parametrize("degrees", [-30.0, 0.0, 43.0])
def test_the_unit_loads_are_those_of_the_kernel(degrees: float) -> None:
    """Products of unit loads against f(s / h) f(t / h) / (s + t), where distances do not level off."""
    depth, slant = 3.0, math.radians(degrees)
    distance = depth * np.geomspace(4.0 * NEAREST_END, 0.7, 9)
    loads = end_loads(np.full(9, depth), distance, np.full(9, HIGH), slant, STEEL)
    linear, quadratic = end_decay(slant)
    fallen = np.exp(-linear * distance / depth - (quadratic * distance / depth) ** 2)
    strength = end_strength(slant, STEEL) / (math.pi * STEEL.plane_strain_modulus)
    kernel = strength * np.outer(fallen, fallen) / (distance[:, None] + distance)
    assert np.abs(loads.T @ loads / kernel - 1.0).max() < 0.05
    assert np.all(np.linalg.eigvalsh(loads.T @ loads) > -1e-12 * kernel.max())


def test_the_body_holds_a_sharp_end_at_its_root() -> None:
    """By a third of its strength at 39 degrees, and a blunt one not at all; a thick root reaches no farther."""
    places = np.full(2, 1.0), np.full(2, 0.5), np.array([0.0, HIGH])
    at_root, above = np.sum(end_loads(*places, math.radians(39.0), STEEL) ** 2, axis=0)
    assert at_root / above == pytest.approx(1.0 - 0.95 * math.sin(math.radians(39.0)) ** 2)
    blunt = end_loads(*places, math.radians(-30.0), STEEL)
    np.testing.assert_array_equal(blunt[:, 0], blunt[:, 1])
    thick = end_loads(np.full(1, 5.0), np.ones(1), np.full(1, HIGH), 0.5, STEEL, middle_depth=3.0)
    np.testing.assert_array_equal(thick, end_loads(np.full(1, 3.0), np.ones(1), np.full(1, HIGH), 0.5, STEEL))


def test_the_end_of_a_load_takes_off_what_is_missing_beyond() -> None:
    """Against Boussinesq's displacements under the line, integrated over the load beyond the end."""
    depth, nu = 3.0, STEEL.poisson_ratio
    for away in (0.5, 1.0, 3.0):

        def approach(y: float) -> float:
            r = math.hypot(y, depth)
            return (1.0 / y - 1.0 / r - 0.5 * depth**2 / ((1.0 - nu) * r**3)) / math.pi

        missing = quad(approach, away, np.inf)[0]
        part = remaining_depth(np.array([depth]), np.array([away]), STEEL)[0]
        assert -2.0 / math.pi * math.log(part) == pytest.approx(missing, abs=0.02)


def test_slants_are_those_of_the_bricks() -> None:
    """Against the end faces of the teeth's lattices."""
    pair = gear_pair(read_case("fm-11x41"))
    for member, one in (("pinion", pair.pinion), ("gear", pair.gear)):
        lattice = tooth_lattice(pair, member, LatticeSize(lengthwise=8, upward=6))
        found = []
        for end, inner in ((0, 1), (-1, -2)):
            row = lattice.flank.shape[1] // 2
            place = lattice.nodes[lattice.flank[end, row]]
            up = lattice.nodes[lattice.flank[end, row + 1]] - lattice.nodes[lattice.flank[end, row - 1]]
            face = np.cross(up, np.cross([0.0, 0.0, 1.0], place * [1.0, 1.0, 0.0]))
            face *= np.sign(face @ (place - lattice.nodes[lattice.flank[inner, row]])) / np.linalg.norm(face)
            found.append(-math.asin(face @ lattice.flank_normal[end, row]))
        assert np.degrees([end.slant for end in end_faces(one)]) == pytest.approx(np.degrees(found), abs=2.0)


def test_ends_of_a_spiral_tooth_are_a_blunt_toe_and_a_sharp_heel() -> None:
    found = [(math.degrees(end.slant), end.height) for end in end_faces(gear_pair(read_case("nasa-12x36")).pinion)]
    assert np.allclose(found, [(-30.0, 5.7), (39.0, 8.2)], rtol=0.0, atol=[0.5, 0.05])


def test_depths_are_those_of_either_tooth_at_the_point() -> None:
    geometry, middle = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7)), np.full((2, 1), 0.5)
    fields = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=5).segments.fields
    assert np.round(LoadedPlaces(fields, middle, middle).depths, 1).tolist() == [[3.1], [3.1]]


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
    at, *slope = (fields("pinion_lengthwise", points[:, [1]], order)[0] for order in ((0, 0), (1, 0), (0, 1)))
    end = slope[1] * along - slope[0] * up
    away = np.linalg.norm(np.cross(along, end)) / np.linalg.norm(end)
    assert of_pinion.distance[0, 1] == pytest.approx(float(at * away / slope[0]), rel=1e-9)
    sine = np.linalg.norm(np.cross(line, end)) / np.linalg.norm(line) / np.linalg.norm(end)
    assert of_pinion.cosine[1] == pytest.approx(float(sine), rel=1e-9)
    assert np.all(of_pinion.distance >= 0.0)
    assert of_pinion.distance[:, 2] == pytest.approx(of_gear.distance[:, 2], rel=0.25)


def test_an_end_whose_flank_crosses_the_mid_surface_adds_finite_compliances() -> None:
    """A pair at a shaft angle for which its settings are not made, on a coarse grid."""
    pair = gear_pair(read_case("nasa-12x36"))
    moved = replace(pair, assembly=replace(pair.assembly, shaft_angle=math.radians(81.0)))
    geometry = pair_geometry(moved, (9, 7))
    fields = MeshCycle.of(geometry, mesh_positions=3, segments_per_line=9).segments.fields
    assert min(float(fields(name, END_MIDDLES).mean(axis=-1).min()) for name in DEPTHS) < 0.0
    middle = np.full((2, 1), 0.5)
    with np.errstate(all="raise", under="ignore"):
        teeth = ElasticTeeth(geometry.teeth, coarse_solid_shells(moved), moved)
        loads = end_loads_at(LoadedPlaces(fields, middle, middle), teeth)
    assert np.all(np.isfinite(loads))


def test_plates_know_nothing_of_it() -> None:
    geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    fields = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=5).segments.fields
    middle = np.full((2, 1), 0.5)
    for model, count in ((ElasticModel(), 0), (coarse_solid_shells(geometry.pair), 4 * MODES)):
        teeth = ElasticTeeth(geometry.teeth, model, geometry.pair)
        assert len(end_loads_at(LoadedPlaces(fields, middle, middle), teeth)) == count
