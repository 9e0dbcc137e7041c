"""Weber's line contact: the published example, limits, convexity, consistent derivatives; strips that an edge cuts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from easeoff import InputError
from easeoff.contact import STEEL, ContactProblem, Material, solve
from easeoff.contact.compliance.weber_line_contact import FOOT_OF_NORMAL_CORRECTION, WeberLineContact, strip_half_width

BRONZE = Material(105000.0, 0.34)


def contact(
    length: float = 1.0,
    foot_correction: float = 0.0,
    depth: tuple[float, float] = (3.5, 4.0),
    gear: Material = STEEL,
) -> WeberLineContact:
    return WeberLineContact(
        length=np.array([length]),
        equivalent_radius=np.array([40.0]),
        depth_pinion=np.array([depth[0]]),
        depth_gear=np.array([depth[1]]),
        material_pinion=STEEL,
        material_gear=gear,
        foot_correction=foot_correction,
    )


def test_example_of_500_newton_per_millimetre() -> None:
    """R = 40, depths 3.5 and 4 mm, steel: b = 0.474 mm, p = 671 MPa, 7.16 um.

    The logarithmic form gives 7.16 um, 0.01431 and 0.01150 um/(N/mm): it is 0.1 to 0.5 % below the exact form here.
    """
    one = contact()
    assert one.half_width(500.0)[0] == pytest.approx(0.474, abs=5e-4)
    assert one.pressure(500.0)[0] == pytest.approx(671.0, abs=0.5)
    assert 1e3 * one.deflection(500.0)[0] == pytest.approx(7.16, rel=2e-3)
    assert 1e3 * one.secant(500.0)[0] == pytest.approx(0.01431, rel=3e-3)
    assert 1e3 * one.tangent(500.0)[0] == pytest.approx(0.01150, rel=5e-3)


def test_narrow_contact_is_the_logarithmic_formula() -> None:
    """The difference to Weber's logarithm vanishes with the square of b / h."""
    one = contact()
    unit = 2.0 * (1.0 - 0.3**2) / (math.pi * 206000.0)
    differences = []
    for force in (40.0, 10.0, 2.5):
        width = one.half_width(force)[0]
        logarithm = unit * force * (math.log(4.0 * 3.5 * 4.0 / width**2) - 0.3 / 0.7)
        differences.append(one.deflection(force)[0] / force - logarithm / force)
    ratios = np.divide(differences[:-1], differences[1:])
    np.testing.assert_allclose(ratios, 4.0, rtol=0.02)
    # Secant and tangent differ by the constant of the logarithm.
    assert one.secant(2.5)[0] - one.tangent(2.5)[0] == pytest.approx(unit, rel=1e-3)


@pytest.mark.parametrize("ratio", [0.05, 0.4, 2.0])
def test_deflection_is_the_integral_of_the_axial_strain(ratio: float) -> None:
    """Plane strain stresses on the axis under an elliptic pressure (Johnson 1985, Eq. 4.46), integrated to depth h."""
    depth, nu = 3.5, 0.3
    one = contact(depth=(depth, depth))
    width = ratio * depth
    force = width**2 / float(one.half_width(1.0)[0]) ** 2
    peak = 2.0 * force / (math.pi * width)

    def strain(z: float) -> float:
        root = math.hypot(width, z)
        along = -peak * ((width**2 + 2.0 * z**2) / (width * root) - 2.0 * z / width)
        down = -peak * width / root
        return -(1.0 + nu) / 206000.0 * ((1.0 - nu) * down - nu * along)

    per_body = quad(strain, 0.0, depth, epsabs=0.0, epsrel=1e-12, limit=200)[0]
    assert one.deflection(force)[0] == pytest.approx(2.0 * per_body, rel=1e-9)


FORCES = np.concatenate([[1e-3, 0.01, 0.03, 0.032], np.geomspace(0.05, 1e6, 25)])


@pytest.mark.parametrize(("depth", "gear"), [((3.5, 4.0), STEEL), ((1.0, 5.0), BRONZE)])
@pytest.mark.parametrize("foot_correction", [0.0, FOOT_OF_NORMAL_CORRECTION])
def test_tangent_is_the_slope_of_the_deflection(
    depth: tuple[float, float], gear: Material, foot_correction: float
) -> None:
    """From below the floor to half-widths far beyond the depth."""
    one = contact(2.0, foot_correction, depth, gear)
    step = 1e-5
    for force in FORCES:
        slope = (one.deflection(force * (1 + step)) - one.deflection(force * (1 - step))) / (2 * step * force)
        assert slope[0] == pytest.approx(one.tangent(force)[0], rel=1e-7)


@pytest.mark.parametrize(("depth", "gear"), [((3.5, 4.0), STEEL), ((1.0, 5.0), BRONZE)])
def test_energy_is_the_integral_of_the_deflection(depth: tuple[float, float], gear: Material) -> None:
    one = contact(2.0, FOOT_OF_NORMAL_CORRECTION, depth, gear)
    for force in (0.02, 0.5, 40.0, 1e3, 1e5):
        breaks = [f for f in (0.01, 0.0622, 0.1, 1.0, 10.0, 100.0, 1e4) if f < force]
        work = quad(lambda f: float(one.deflection(f)[0]), 0.0, force, points=breaks or None, epsrel=1e-12, limit=400)[
            0
        ]
        assert one.energy(force)[0] == pytest.approx(work, rel=1e-9)


@pytest.mark.parametrize("poisson_ratio", [0.0, 0.3, 0.499])
def test_energy_is_strictly_convex_for_every_load(poisson_ratio: float) -> None:
    """The tangent is positive everywhere, even where the logarithm would have turned it negative."""
    material = Material(206000.0, poisson_ratio)
    forces = np.concatenate([[-1.0, 0.0], np.geomspace(1e-6, 1e9, 400)])
    one = WeberLineContact(np.ones(402), np.full(402, 40.0), np.full(402, 0.3), np.full(402, 4.0), material, material)
    tangent = one.tangent(forces)
    assert tangent.min() > 0.0
    assert np.all(np.diff(tangent[1:]) < 0.0)  # the deflection itself is concave: it stiffens, below the floor too
    assert np.all(np.diff(one.deflection(forces)) > 0.0)


def test_deflection_and_tangent_are_continuous_at_the_floor_and_at_zero() -> None:
    one = contact()
    floor = 1e-6 * 3.5 * 4.0 / one.half_width(1.0)[0] ** 2
    for method in (one.deflection, one.tangent, one.secant, one.energy):
        below, above = method(floor * (1 - 1e-12)), method(floor * (1 + 1e-12))
        np.testing.assert_allclose(below, above, rtol=1e-10)
    assert one.deflection(0.0)[0] == 0.0
    assert one.energy(0.0)[0] == 0.0
    assert one.secant(0.0)[0] == one.tangent(0.0)[0] == one.tangent(-5.0)[0]
    assert np.isfinite(one.secant(0.0)[0])


def test_secant_times_force_is_the_deflection() -> None:
    one = contact(0.7)
    forces = np.array([-3.0, 0.001, 5.0, 700.0])
    np.testing.assert_allclose([one.secant(f)[0] * f for f in forces], [one.deflection(f)[0] for f in forces])


def test_splitting_a_segment_changes_nothing() -> None:
    """Only the line load counts: half the length under half the force deflects the same, with half the energy."""
    whole, half = contact(2.0), contact(1.0)
    assert half.deflection(300.0)[0] == pytest.approx(whole.deflection(600.0)[0], rel=1e-14)
    assert half.pressure(300.0)[0] == pytest.approx(whole.pressure(600.0)[0], rel=1e-14)
    assert 2.0 * half.energy(300.0)[0] == pytest.approx(whole.energy(600.0)[0], rel=1e-14)


def test_pressure_carries_the_load() -> None:
    """The ellipse of height p and half-width b holds pi / 2 p b per length."""
    one = contact(1.7)
    assert 0.5 * math.pi * one.pressure(900.0)[0] * one.half_width(900.0)[0] * 1.7 == pytest.approx(900.0, rel=1e-12)
    assert one.pressure(-1.0)[0] == one.half_width(0.0)[0] == 0.0


def test_exchanging_the_bodies_changes_nothing() -> None:
    here = WeberLineContact(np.ones(1), np.full(1, 30.0), np.full(1, 2.0), np.full(1, 4.0), STEEL, BRONZE)
    there = WeberLineContact(np.ones(1), np.full(1, 30.0), np.full(1, 4.0), np.full(1, 2.0), BRONZE, STEEL)
    np.testing.assert_allclose(here.deflection(400.0), there.deflection(400.0), rtol=1e-14)
    np.testing.assert_allclose(here.energy(400.0), there.energy(400.0), rtol=1e-14)


def test_foot_correction_adds_its_share_per_body() -> None:
    plain, corrected = contact(2.0), contact(2.0, FOOT_OF_NORMAL_CORRECTION)
    added = corrected.deflection(1000.0)[0] - plain.deflection(1000.0)[0]
    assert added == pytest.approx(0.14 * 500.0 * 2.0 * (1.0 - 0.3**2) / 206000.0, rel=1e-10)


def test_any_leading_shape_and_no_segments() -> None:
    random = np.random.default_rng(0)
    shape = (3, 2, 5)
    many = WeberLineContact(
        random.uniform(0.5, 2.0, shape),
        np.array(40.0),
        random.uniform(1.0, 4.0, 5),
        np.full((2, 5), 3.0),
        STEEL,
        STEEL,
    )
    force = random.uniform(0.0, 800.0, shape)
    single = WeberLineContact(
        many.length[2, 1], many.equivalent_radius[2, 1], many.depth_pinion[2, 1], many.depth_gear[2, 1], STEEL, STEEL
    )
    for name in ("deflection", "secant", "tangent", "energy", "pressure", "half_width"):
        values = getattr(many, name)(force)
        assert values.shape == shape
        np.testing.assert_allclose(values[2, 1], getattr(single, name)(force[2, 1]), rtol=1e-13)
    empty = WeberLineContact(np.zeros(0), np.zeros(0), np.zeros(0), np.zeros(0), STEEL, STEEL)
    assert empty.deflection(np.zeros(0)).shape == (0,)
    assert empty.energy(np.zeros(0)).sum() == 0.0


def test_bad_inputs_are_named() -> None:
    one = np.ones(2)
    with pytest.raises(InputError, match="equivalent_radius"):
        WeberLineContact(one, np.array([1.0, -3.0]), one, one, STEEL, STEEL)
    with pytest.raises(InputError, match="broadcast"):
        WeberLineContact(one, np.ones(3), one, one, STEEL, STEEL)
    with pytest.raises(InputError, match="foot_correction"):
        WeberLineContact(one, one, one, one, STEEL, STEEL, foot_correction=-0.1)
    with pytest.raises(InputError, match="floor_ratio"):
        WeberLineContact(one, one, one, one, STEEL, STEEL, floor_ratio=0.0)


# Strips that an edge cuts: against pressures found cell by cell, and consistency of deflection and slope


RADIUS, DEEP = 40.0, 4000.0  # so deep that the logarithm is exact


def cut(overhang: float, depth: float = DEEP, gear: Material = STEEL) -> WeberLineContact:
    one = np.ones(1)
    floor = 1e-3 if depth < DEEP else 1e-9
    size = (one, RADIUS * one, depth * one, depth * one)
    return WeberLineContact(*size, STEEL, gear, floor_ratio=floor, overhang=overhang * one)


def by_cells(overhang: float, load: float, cells: int) -> tuple[float, float]:
    """Deflection beyond the first touch and width of the strip [mm], of half planes under even pressures."""
    law = cut(overhang)
    flexibility, contraction = law.flexibility, 0.3 / 0.7
    width = 2.6 * float(law.half_width(load)[0])
    # Narrow cells towards the edge, where the pressure is a root of the distance.
    ends = overhang + width * np.linspace(0.0, 1.0, cells + 1) ** 2
    middle, size = 0.5 * (ends[1:] + ends[:-1]), np.diff(ends)

    def integral(x: np.ndarray) -> np.ndarray:
        return np.asarray(x * (np.log(np.abs(x)) - 1.0))

    logarithm = integral(ends[None, 1:] - middle[:, None]) - integral(ends[None, :-1] - middle[:, None])
    matrix = -2.0 * logarithm / size + 2.0 * np.log(DEEP) - 1.0 - contraction
    matrix = flexibility / np.pi * 0.5 * (matrix + matrix.T)
    separation = (middle**2 - max(overhang, 0.0) ** 2) / (2.0 * RADIUS)
    found = solve(ContactProblem(separation, np.ones(cells), load, matrix))
    assert found.certified
    return found.rotation, float(size[found.force > 0.0].sum())


@pytest.mark.parametrize("overhang", [-0.02, 0.0, 0.05, 0.3, 1.5])
@pytest.mark.parametrize("load", [5.0, 300.0])
def test_pressures_found_cell_by_cell(overhang: float, load: float) -> None:
    law = cut(overhang)
    coarse, fine = (by_cells(overhang, load, n) for n in (60, 240))
    deflection, width = float(law.deflection(load)[0]), 2.0 * float(law.half_width(load)[0])
    assert fine[0] == pytest.approx(deflection, rel=2e-6)
    assert fine[1] == pytest.approx(width, rel=0.007)
    assert fine[1] - width < 0.4 * (coarse[1] - width)


@pytest.mark.parametrize("depth", [0.05, 1.0, DEEP])
@pytest.mark.parametrize("overhang", [-0.3, -0.02, 0.0, 0.02, 0.3, 3.0])
def test_slope_is_the_derivative_and_the_energy_convex(depth: float, overhang: float) -> None:
    """Stiffer with every newton, never stiff without limit, from below the floor to strips far wider than deep."""
    law = cut(overhang, depth, BRONZE)
    forces = np.geomspace(1e-9, 1e8, 100)
    slopes = np.array([law.tangent(f)[0] for f in forces])
    step = 1e-5
    numeric = [(law.deflection(f * (1 + step)) - law.deflection(f * (1 - step)))[0] / (2 * step * f) for f in forces]
    np.testing.assert_allclose(slopes, numeric, rtol=1e-6)
    assert slopes.min() > 0.0
    assert np.all(np.diff(slopes) <= 1e-13 * slopes[1:])


def test_a_cut_strip_gives_way_more_than_a_whole_one() -> None:
    one = np.ones(1)
    whole = WeberLineContact(one, RADIUS * one, 3.0 * one, 3.0 * one, STEEL, STEEL)
    deflections = [cut(e, 3.0).deflection(400.0)[0] for e in (0.0, 0.1, 0.4, 1.0)]
    assert np.all(np.diff([whole.deflection(400.0)[0], *deflections]) > 0.0)
    widths = [cut(e, 3.0).half_width(400.0)[0] for e in (0.0, 0.1, 0.4, 1.0)]
    assert np.all(np.diff([whole.half_width(400.0)[0], *widths]) < 0.0)
    b = whole.half_width(400.0)[0]
    assert widths[0] == pytest.approx(b / np.sqrt(3.0))
    assert np.isnan(cut(0.1).pressure(400.0)[0])
    assert np.isnan(cut(0.1).energy(400.0)[0])


def test_strips_without_an_edge_are_whole() -> None:
    half_width = strip_half_width(np.array([np.nan, 0.0]), np.array([0.04, 0.04]))
    np.testing.assert_allclose(half_width, [0.2, 0.2 / np.sqrt(3.0)])


def test_a_strip_is_whole_until_it_reaches_the_edge() -> None:
    """From there on deflection and slope go on without a jump, and the strip becomes narrower than a whole one."""
    one = np.ones(1)
    whole = WeberLineContact(one, RADIUS * one, 3.0 * one, 3.0 * one, STEEL, STEEL)
    reach = float(whole.half_width(400.0)[0])
    for force in (4.0, 399.99):
        assert cut(-reach, 3.0).deflection(force)[0] == pytest.approx(whole.deflection(force)[0], rel=1e-12)
        assert cut(-reach, 3.0).pressure(force)[0] == pytest.approx(whole.pressure(force)[0], rel=1e-12)
    for depth in (0.05, 1.0, 10.0):
        law, there = cut(-reach, depth), 400.0
        for value in (law.deflection, law.tangent, law.half_width):
            assert value(there * (1.0 + 1e-9))[0] == pytest.approx(value(there * (1.0 - 1e-9))[0], rel=1e-8)
    assert cut(-0.5 * reach, 3.0).half_width(400.0)[0] < reach


@pytest.mark.parametrize("overhang", [np.inf, -np.inf])
def test_overhang_is_a_distance(overhang: float) -> None:
    with pytest.raises(InputError, match="must be finite or NaN"):
        cut(overhang)
