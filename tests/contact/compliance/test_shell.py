"""The Rayleigh-Ritz shell: reference solutions, closed-form limits, invariants and finite elements."""

from __future__ import annotations

import dataclasses
import math
import pickle

import numpy as np
import pytest
from numpy.typing import NDArray
from thesis_shell import monomials, thesis_kinematics

from easeoff import InputError
from easeoff.contact import STEEL, ElasticFoundation, Material, Shell, ToothDimensions
from easeoff.contact.compliance.shell import (
    PolynomialFamily,
    TrialFunctions,
    legendre,
    rooted_polynomials,
    stiffness_matrix,
)
from easeoff.contact.compliance.shell_kinematics import DisplacementAssumption, five_field

FloatArray = NDArray[np.float64]
RADIAL = (0.0, 0.0, 1.0)
# trace length and radius; height, root thickness and tip thickness at toe and heel [mm]
TABLE_TOOTH = ToothDimensions(36.0, 95.25, 7.0, 9.5, 5.5, 7.5, 2.5, 2.5)
FE_TOOTH = ToothDimensions(45.0, 114.3, 8.0, 11.0, 7.0, 9.0, 3.5, 3.5)
PLATE = ToothDimensions(30.0, math.inf, 10.0, 10.0, 4.0, 4.0, 4.0, 4.0)


def free_edge(shell: Shell, load: FloatArray, count: int = 181) -> FloatArray:
    """Radial deflection of the tip along the face [um] under 500 N."""
    y = np.linspace(0.0, shell.dimensions.trace_length, count)
    edge = shell.load_vectors(shell.dimensions.height(y), y, RADIAL)
    return np.asarray(500e3 * (shell.whiten(edge).T @ shell.whiten(load[None]))[:, 0])


def patch(tooth: ToothDimensions) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Gauss points and weights of a 2 x 2 mm patch at mid-face, mid-height."""
    point, weight = np.polynomial.legendre.leggauss(5)
    y = 0.5 * tooth.trace_length
    x_grid, y_grid = np.meshgrid(tooth.height(y) / 2 + point, y + point, indexing="ij")
    return x_grid.ravel(), y_grid.ravel(), np.outer(weight, weight).ravel() / 4.0


def condition_number(shell: Shell) -> float:
    """Condition number of the stiffness matrix after scaling to a unit diagonal."""
    stiffness = shell.stiffness()
    scale = 1.0 / np.sqrt(np.diagonal(stiffness))
    return float(np.linalg.cond(stiffness * scale[:, None] * scale))


def scattered_points(shell: Shell, count: int, seed: int = 3) -> tuple[FloatArray, FloatArray, FloatArray]:
    random = np.random.default_rng(seed)
    y = random.uniform(0.0, shell.dimensions.trace_length, count)
    x = shell.dimensions.height(y) * random.uniform(0.1, 1.0, count)
    return x, y, random.normal(size=(count, 3))


def scattered_loads(shell: Shell, count: int, seed: int = 3) -> FloatArray:
    return shell.load_vectors(*scattered_points(shell, count, seed))


@pytest.mark.parametrize(
    ("modes", "shear_factor", "radius", "expected"),
    [
        ((5, 9), 5 / 6, 95.25, [-0.040, 0.010, 0.182, 0.752, 1.052, 0.701, 0.186, 0.031, -0.023]),
        ((5, 15), 5 / 6, 95.25, [-0.018, 0.014, 0.196, 0.697, 1.128, 0.647, 0.203, 0.033, -0.030]),
        ((9, 21), 5 / 6, 95.25, [-0.021, 0.022, 0.199, 0.700, 1.154, 0.655, 0.202, 0.033, -0.027]),
        ((6, 13), 1.0, 95.25, [-0.024, 0.023, 0.169, 0.668, 1.050, 0.619, 0.181, 0.031, -0.029]),
        ((6, 13), 5 / 6, math.inf, [-0.028, 0.027, 0.189, 0.727, 1.140, 0.675, 0.203, 0.038, -0.032]),
    ],
)
def test_thesis_form_gives_the_independently_computed_tip_deflections(
    modes: tuple[int, int], shear_factor: float, radius: float, expected: list[float]
) -> None:
    """500 N at mid-face, mid-height; an independent implementation of Kolivand 2009, Eq. 3.5, printed to 0.001 um."""
    tooth = dataclasses.replace(TABLE_TOOTH, trace_radius=radius)
    shell = Shell(tooth, STEEL, modes=modes, shear_factor=shear_factor, assumption=thesis_kinematics)
    load = shell.load_vectors(tooth.height(18.0) / 2, 18.0, RADIAL)
    np.testing.assert_allclose(free_edge(shell, load, 9), expected, atol=0.002)


def test_averaging_over_a_segment_makes_the_self_compliance_converge() -> None:
    """A point's own compliance grows with the modes without limit; that of a 4 mm segment settles [1e-3 um/N]."""
    point, weight = np.polynomial.legendre.leggauss(9)
    height = float(TABLE_TOOTH.height(18.0)) / 2
    single, averaged = [], []
    for modes in ((5, 9), (5, 15), (7, 21), (11, 31)):
        shell = Shell(TABLE_TOOTH, STEEL, modes=modes, shear_factor=5 / 6, assumption=thesis_kinematics)
        at_point = shell.load_vectors(height, 18.0, RADIAL)
        over_segment = shell.load_vectors(np.full(9, height), 18.0 + 2.0 * point, RADIAL, weights=weight / 2.0)
        diagonal = 1e6 * np.diag(shell.compliance(np.stack([at_point, over_segment])))
        single.append(diagonal[0])
        averaged.append(diagonal[1])
    np.testing.assert_allclose(single, [1.52, 1.79, 2.03, 2.26], atol=0.006)
    np.testing.assert_allclose(averaged, [1.42, 1.58, 1.71, 1.76], atol=0.006)


def test_more_lengthwise_modes_sharpen_the_peak_as_in_the_dissertation() -> None:
    """Kolivand 2009, Fig. 3.4: peaks about 0.6 : 0.7 : 0.93 : 1 for 3, 5, 9, 15 modes, ends rippling below zero."""
    x, y, weights = patch(FE_TOOTH)
    peaks, ends = [], []
    for lengthwise in (3, 5, 9, 15):
        shell = Shell(FE_TOOTH, STEEL, modes=(5, lengthwise), assumption=thesis_kinematics)
        edge = free_edge(shell, shell.load_vectors(x, y, RADIAL, weights))
        peaks.append(edge.max())
        ends.append(edge[[0, -1]].max())
    np.testing.assert_allclose(np.array(peaks) / peaks[-1], [0.6, 0.7, 0.93, 1.0], atol=0.05)
    assert max(ends) < 0.0
    assert abs(ends[0]) > 5.0 * abs(ends[-1])


def test_slim_tooth_against_finite_elements_as_in_the_dissertation() -> None:
    """Kolivand 2009, Fig. 3.4: 2.5 to 3 um, and the same steps to the finite elements, of a slim clamped tooth.

    2.555 um: benchmarks/finite_elements.py, the same tooth in quadratic bricks, loaded radially on its outer side.
    """
    slim = ToothDimensions(45.0, 114.3, 10.0, 12.0, 5.0, 6.0, 2.0, 2.0)
    x, y, weights = patch(slim)
    peaks = []
    for lengthwise in (3, 5, 9, 15):
        shell = Shell(slim, STEEL, modes=(5, lengthwise), assumption=thesis_kinematics)
        peaks.append(free_edge(shell, shell.load_vectors(x, y, RADIAL, weights)).max())
    np.testing.assert_allclose(np.array(peaks) / peaks[-1], [0.6, 0.7, 0.93, 1.0], atol=0.05)
    assert peaks[-1] == pytest.approx(2.555, rel=0.05)


@pytest.mark.parametrize(
    ("assumption", "modes", "error_spread", "error_flank"),
    [
        (thesis_kinematics, (5, 3), -0.45, -0.47),
        (thesis_kinematics, (5, 5), -0.29, -0.33),
        (thesis_kinematics, (5, 9), -0.08, -0.13),
        (thesis_kinematics, (5, 15), -0.008, -0.056),
        (thesis_kinematics, (8, 21), 0.017, -0.032),
        (five_field, (5, 15), 0.016, -0.033),
    ],
)
def test_clamped_shell_against_finite_elements(
    assumption: DisplacementAssumption, modes: tuple[int, int], error_spread: float, error_flank: float
) -> None:
    """Free-edge peak of a converged 3-D model: 0.755 um (load spread over the thickness), 0.793 um (on the flank)."""
    shell = Shell(FE_TOOTH, STEEL, modes=modes, assumption=assumption)
    x, y, weights = patch(FE_TOOTH)
    peak = free_edge(shell, shell.load_vectors(x, y, RADIAL, weights)).max()
    assert peak / 0.755 - 1.0 == pytest.approx(error_spread, abs=0.01)
    assert peak / 0.793 - 1.0 == pytest.approx(error_flank, abs=0.01)


def test_second_tooth_against_finite_elements() -> None:
    """500 N at mid-face, mid-height: 1.124 um at the free edge in a 3-D model of 27-node bricks, and its neighbours."""
    shell = Shell(TABLE_TOOTH, STEEL)
    edge = free_edge(shell, shell.load_vectors(TABLE_TOOTH.height(18.0) / 2, 18.0, RADIAL), 9)
    finite_elements = np.array([-0.026, 0.015, 0.185, 0.678, 1.124, 0.633, 0.189, 0.026, -0.033])
    assert np.abs(edge - finite_elements).max() < 0.05 * finite_elements.max()


def test_shear_factor_one_is_closer_to_finite_elements_than_five_sixths() -> None:
    """Load spread over the thickness: +1.6 % with 1, +9.7 % with 5/6."""
    x, y, weights = patch(FE_TOOTH)
    peaks = []
    for shear_factor in (1.0, 5 / 6):
        shell = Shell(FE_TOOTH, STEEL, shear_factor=shear_factor)
        peaks.append(free_edge(shell, shell.load_vectors(x, y, RADIAL, weights)).max() / 0.755 - 1.0)
    np.testing.assert_allclose(peaks, [0.016, 0.097], atol=0.005)


def test_normal_load_on_the_flank_against_finite_elements() -> None:
    """Load along the flank's normal: 0.641 um; the moment of the flank's offset counts, within 5 % of that."""
    shell = Shell(FE_TOOTH, STEEL)
    x, y, weights = patch(FE_TOOTH)
    tilt = math.atan((8.0 - 3.5) / 2.0 / 9.5)
    normal = (-math.sin(tilt), 0.0, math.cos(tilt))
    half = 0.5 * FE_TOOTH.thickness(x, y)
    on_flank = free_edge(shell, shell.load_vectors(x, y, normal, weights, offset=-half)).max()
    at_mid_surface = free_edge(shell, shell.load_vectors(x, y, normal, weights)).max()
    assert on_flank == pytest.approx(0.641, rel=0.05)
    assert at_mid_surface == pytest.approx(0.641, rel=0.20)
    assert abs(on_flank - 0.641) < abs(at_mid_surface - 0.641)


def test_foot_of_the_normal_is_the_flank_offset_to_first_order() -> None:
    """In the response along the load, moving a load down its own line of action changes only the shear in between."""
    beam = dataclasses.replace(PLATE, root_thickness_toe=2.0, root_thickness_heel=2.0)
    beam = dataclasses.replace(beam, tip_thickness_toe=2.0, tip_thickness_heel=2.0, height_toe=20.0, height_heel=20.0)
    shell = Shell(beam, STEEL, modes=(7, 5))
    tilt, half = math.radians(10.0), 1.0
    normal = (-math.sin(tilt), 0.0, math.cos(tilt))
    y, weights = uniform_line(beam)
    on_flank = shell.load_vectors(np.full(y.size, 15.0), y, normal, weights, offset=-half)
    at_foot = shell.load_vectors(np.full(y.size, 15.0 - half * math.tan(tilt)), y, normal, weights)
    compliance = shell.compliance(np.stack([on_flank, at_foot]))
    assert compliance[0, 0] == pytest.approx(compliance[1, 1], rel=2e-3)


def uniform_line(tooth: ToothDimensions) -> tuple[FloatArray, FloatArray]:
    point, weight = np.polynomial.legendre.leggauss(20)
    return 0.5 * tooth.trace_length * (point + 1.0), 0.5 * weight


@pytest.mark.parametrize("shear_factor", [1.0, 5 / 6])
@pytest.mark.parametrize(
    ("assumption", "profile_modes", "shear_share"),
    [(five_field, 3, 1.0), (five_field, 5, 1.0), (thesis_kinematics, 3, 15 / 16), (thesis_kinematics, 5, 35 / 36)],
)
def test_straight_uniform_tooth_is_the_timoshenko_cantilever(
    assumption: DisplacementAssumption, profile_modes: int, shear_share: float, shear_factor: float
) -> None:
    """Line load at the tip of a straight tooth without lateral strain: bending plus shear deflection, exactly.

    The shear strain of the thesis form is tied to zero at the root, while the true one is constant. The best
    polynomial of degree m without constant term leaves 1 / (m + 1)^2 of the shear deflection out.
    """
    no_contraction = Material(206000.0, 0.0)
    shell = Shell(PLATE, no_contraction, assumption=assumption, shear_factor=shear_factor, modes=(profile_modes, 7))
    y, weights = uniform_line(PLATE)
    load = shell.load_vectors(np.full(y.size, 10.0), y, RADIAL, weights)
    width, height, thickness = 30.0, 10.0, 4.0
    bending = height**3 / (3.0 * 206000.0 * width * thickness**3 / 12.0)
    shear = height / (shear_factor * no_contraction.shear_modulus * width * thickness)
    assert shell.compliance(load[None])[0, 0] == pytest.approx(bending + shear_share * shear, rel=1e-9)


def test_thin_tooth_tends_to_the_euler_bernoulli_cantilever() -> None:
    """The excess over bending theory falls with the square of the thickness: no shear locking."""
    excess = []
    for thickness in (1.0, 0.5, 0.25):
        plate = ToothDimensions(30.0, math.inf, 10.0, 10.0, thickness, thickness, thickness, thickness)
        shell = Shell(plate, Material(206000.0, 0.0), modes=(5, 5))
        y, weights = uniform_line(plate)
        load = shell.load_vectors(np.full(y.size, 10.0), y, RADIAL, weights)
        bending = 10.0**3 / (3.0 * 206000.0 * 30.0 * thickness**3 / 12.0)
        excess.append(shell.compliance(load[None])[0, 0] / bending - 1.0)
    np.testing.assert_allclose(np.log2(np.divide(excess[:-1], excess[1:])), 2.0, atol=1e-3)


def test_large_trace_radius_tends_to_the_straight_tooth() -> None:
    straight = Shell(dataclasses.replace(TABLE_TOOTH, trace_radius=math.inf), STEEL)
    curved = Shell(dataclasses.replace(TABLE_TOOTH, trace_radius=1e7), STEEL)
    expected = straight.compliance(scattered_loads(straight, 20))
    difference = curved.compliance(scattered_loads(curved, 20)) - expected
    assert np.abs(difference).max() < 1e-6 * np.abs(expected).max()


def test_loads_along_the_tooth_stretch_and_shear_it() -> None:
    """Straight uniform tooth, tip line load: a bar along the height, a deep Timoshenko beam (6/5) along the trace."""
    shell = Shell(PLATE, Material(206000.0, 0.0), modes=(5, 9))
    y, weights = uniform_line(PLATE)
    loads = np.stack(
        [shell.load_vectors(np.full(y.size, 10.0), y, d, weights) for d in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))]
    )
    compliance = np.diag(shell.compliance(loads))
    assert compliance[0] == pytest.approx(10.0 / (206000.0 * 4.0 * 30.0), rel=1e-9)
    beam = 10.0**3 / (3.0 * 206000.0 * 4.0 * 30.0**3 / 12.0) + 1.2 * 10.0 / (103000.0 * 4.0 * 30.0)
    assert compliance[1] == pytest.approx(beam, rel=0.02)


@pytest.mark.parametrize("radius", [95.25, math.inf])
def test_unsupported_tooth_has_exactly_six_motions_without_energy(radius: float) -> None:
    """Rigid-body motions strain nothing, curved or straight: the strain tables and the metric agree."""
    tooth = dataclasses.replace(TABLE_TOOTH, trace_radius=radius)
    kinematics = five_field(tooth.trace_curvature, 0.0)
    functions = TrialFunctions(tooth.largest_height, tooth.trace_length, 4, 11, kinematics.sprung_powers, legendre)
    stiffness = stiffness_matrix(tooth, STEEL, kinematics, functions)
    eigenvalues = np.linalg.eigvalsh(stiffness)
    assert np.abs(eigenvalues[:6]).max() < 1e-14 * eigenvalues[-1]
    assert eigenvalues[6] > 1e-5 * eigenvalues[-1]


@pytest.mark.parametrize("fanning", [0.02, -0.02])
def test_fanning_heights_keep_the_six_motions(fanning: float) -> None:
    """A flat plate in polar coordinates: displacements along fanning heights and bent traces are still a plate's."""
    tooth = ToothDimensions(
        30.0, math.inf, 8.0, 10.0, 4.0, 5.0, 2.0, 3.0, bulge_toe=0.5, bulge_heel=0.3, fanning=fanning
    )
    kinematics = five_field(0.0, fanning)
    functions = TrialFunctions(tooth.largest_height, tooth.trace_length, 4, 11, kinematics.sprung_powers, legendre)
    eigenvalues = np.linalg.eigvalsh(stiffness_matrix(tooth, STEEL, kinematics, functions))
    assert np.abs(eigenvalues[:6]).max() < 1e-14 * eigenvalues[-1]
    assert eigenvalues[6] > 1e-6 * eigenvalues[-1]


def test_root_of_a_fanning_plate_is_shorter() -> None:
    """A plate that is rigid against its root springs: deflection goes with the inverse of the root's length.

    Not exactly: the rotation that comes with it wants another direction everywhere along the fan.
    """
    soft = ElasticFoundation(factor=1e5)
    deflections = []
    for fanning in (0.0, 0.02):
        shell = Shell(dataclasses.replace(PLATE, fanning=fanning), STEEL, (5, 9), foundation=soft)
        y, weights = np.polynomial.legendre.leggauss(9)
        at_root = shell.load_vectors(np.zeros(9), 15.0 * (1.0 + y), RADIAL, 0.5 * weights)
        deflections.append(shell.compliance(at_root[None])[0, 0])
    assert deflections[1] / deflections[0] == pytest.approx(1.0 / (1.0 - 0.02 * 5.0), rel=5e-3)


def test_bulge_is_a_parabola_on_the_even_taper() -> None:
    even = dataclasses.replace(FE_TOOTH)
    bulged = dataclasses.replace(FE_TOOTH, bulge_toe=1.0, bulge_heel=2.0)
    y = np.array([0.0, 22.5, 45.0])
    for share, expected in ((0.0, 0.0), (0.25, 0.75), (0.5, 1.0), (1.0, 0.0)):
        x = share * even.height(y)
        np.testing.assert_allclose(bulged.thickness(x, y) - even.thickness(x, y), expected * np.array([1.0, 1.5, 2.0]))
    with pytest.raises(InputError, match="bulge"):
        dataclasses.replace(FE_TOOTH, bulge_heel=-8.0)
    with pytest.raises(InputError, match="fanning"):
        dataclasses.replace(FE_TOOTH, fanning=0.2)
    with pytest.raises(InputError, match="parallel heights"):
        Shell(dataclasses.replace(FE_TOOTH, fanning=0.01), STEEL, assumption=thesis_kinematics)


def test_compliance_is_symmetric_and_positive_semidefinite() -> None:
    for shell in (Shell(FE_TOOTH, STEEL), Shell(FE_TOOTH, STEEL, assumption=thesis_kinematics)):
        compliance = shell.compliance(scattered_loads(shell, 60))
        np.testing.assert_array_equal(compliance, compliance.T)
        eigenvalues = np.linalg.eigvalsh(compliance)
        assert eigenvalues[0] > -1e-14 * eigenvalues[-1]


def test_rank_is_that_of_the_loaded_fields() -> None:
    """Radial loads see the deflection functions only; loads in all directions see three fields."""
    shell = Shell(FE_TOOTH, STEEL, modes=(2, 3))
    random = np.random.default_rng(1)
    x, y = random.uniform(1.0, 8.0, 30), random.uniform(0.0, 45.0, 30)
    radial = shell.compliance(shell.load_vectors(x, y, RADIAL))
    general = shell.compliance(shell.load_vectors(x, y, random.normal(size=(30, 3))))
    assert np.linalg.matrix_rank(radial) == 6
    assert np.linalg.matrix_rank(general) == 18


def test_reciprocity_of_the_solved_displacements() -> None:
    """The displacement at i under a load at j, solved without the factor, equals that at j under i and the matrix."""
    shell = Shell(FE_TOOTH, STEEL)
    first, second = scattered_loads(shell, 2)
    forward = second @ np.linalg.solve(shell.stiffness(), first)
    backward = first @ np.linalg.solve(shell.stiffness(), second)
    assert forward == pytest.approx(backward, rel=1e-9)
    assert forward == pytest.approx(shell.compliance(np.stack([first, second]))[0, 1], rel=1e-9)


def test_swapping_toe_and_heel_mirrors_the_compliance() -> None:
    mirrored = ToothDimensions(45.0, 114.3, 11.0, 8.0, 9.0, 7.0, 3.5, 3.5)
    y = np.linspace(2.0, 43.0, 12)
    x = np.linspace(2.0, 7.0, 12)
    direction = np.random.default_rng(2).normal(size=(12, 3))
    one, other = Shell(FE_TOOTH, STEEL), Shell(mirrored, STEEL)
    here = one.compliance(one.load_vectors(x, y, direction))
    there = other.compliance(other.load_vectors(x, 45.0 - y, direction * [1.0, -1.0, 1.0]))
    np.testing.assert_allclose(there, here, atol=1e-11 * np.abs(here).max())


def test_uniform_straight_tooth_has_no_preferred_side() -> None:
    """Turning a straight tooth inside out and end for end leaves the radial compliance as it was."""
    shell = Shell(PLATE, STEEL)
    y, x = np.linspace(1.0, 29.0, 9), np.linspace(2.0, 9.0, 9)
    here = shell.compliance(shell.load_vectors(x, y, RADIAL))
    turned = shell.compliance(shell.load_vectors(x, 30.0 - y, (0.0, 0.0, -1.0)))
    np.testing.assert_allclose(turned, here, atol=1e-12 * np.abs(here).max())


def test_compliance_scales_with_size_and_modulus() -> None:
    """A tooth k times larger is k times stiffer against a force; doubling the modulus halves every compliance."""
    base = Shell(FE_TOOTH, STEEL)
    doubled = ToothDimensions(*(2.0 * value for value in dataclasses.astuple(FE_TOOTH)))
    larger = Shell(doubled, Material(412000.0, 0.3))
    y, x = np.linspace(2.0, 43.0, 8), np.linspace(2.0, 7.0, 8)
    small = base.compliance(base.load_vectors(x, y, RADIAL))
    large = larger.compliance(larger.load_vectors(2.0 * x, 2.0 * y, RADIAL))
    np.testing.assert_allclose(4.0 * large, small, atol=1e-11 * small.max())


@pytest.mark.parametrize("assumption", [five_field, thesis_kinematics])
def test_more_modes_never_stiffen_the_tooth(assumption: DisplacementAssumption) -> None:
    """Nested trial spaces: the work of a fixed load grows monotonically (Rayleigh-Ritz bound)."""
    work = []
    for modes in ((3, 5), (4, 9), (5, 15), (6, 17)):
        shell = Shell(FE_TOOTH, STEEL, modes=modes, assumption=assumption)
        x, y, weights = patch(FE_TOOTH)
        work.append(shell.compliance(shell.load_vectors(x, y, RADIAL, weights)[None])[0, 0])
    assert np.all(np.diff(work) > 0.0)


def test_monomials_and_legendre_polynomials_give_the_same_answer() -> None:
    """They span the same space; at (5, 5) the monomials still hold six digits."""
    y, x = np.linspace(2.0, 34.0, 9), np.linspace(2.0, 6.5, 9)
    answers = []
    families: tuple[PolynomialFamily, ...] = (monomials, legendre)
    for family in families:
        shell = Shell(TABLE_TOOTH, STEEL, modes=(5, 5), assumption=thesis_kinematics, family=family)
        answers.append(shell.compliance(shell.load_vectors(x, y, RADIAL)))
    np.testing.assert_allclose(answers[0], answers[1], atol=1e-6 * answers[1].max())


@pytest.mark.parametrize(
    ("family", "modes", "expected"),
    [
        (monomials, (5, 3), 3e9),
        (monomials, (5, 5), 2e12),
        (legendre, (5, 3), 1e4),
        (legendre, (5, 5), 3e4),
        (legendre, (5, 9), 6e4),
        (legendre, (5, 15), 1e6),
        (legendre, (7, 15), 7e6),
        (legendre, (9, 21), 2e9),
    ],
)
def test_condition_numbers_of_the_thesis_form(
    family: PolynomialFamily, modes: tuple[int, int], expected: float
) -> None:
    shell = Shell(TABLE_TOOTH, STEEL, modes=modes, assumption=thesis_kinematics, shear_factor=5 / 6, family=family)
    assert abs(math.log10(condition_number(shell) / expected)) < 0.5


def test_monomials_fail_loudly_at_the_dissertation_modes() -> None:
    with pytest.raises(InputError, match="Legendre"):
        Shell(TABLE_TOOTH, STEEL, assumption=thesis_kinematics, family=monomials)


def test_five_field_form_is_better_conditioned() -> None:
    assert condition_number(Shell(FE_TOOTH, STEEL)) < 2e4


@pytest.mark.parametrize("family", [monomials, legendre])
@pytest.mark.parametrize("root_power", [0, 1, 2])
def test_derivatives_of_the_trial_functions(family: PolynomialFamily, root_power: int) -> None:
    """Against numpy's polynomial algebra, values and two derivatives."""
    s = np.linspace(-0.1, 1.2, 7)
    values = rooted_polynomials(s, 5, root_power, 2, family)
    for degree in range(5):
        base = np.polynomial.Polynomial.basis(degree)
        if family is legendre:
            base = np.polynomial.Legendre.basis(degree).convert(kind=np.polynomial.Polynomial)
            base = base(np.polynomial.Polynomial([-1.0, 2.0]))
        exact = base * np.polynomial.Polynomial([0.0, 1.0]) ** root_power
        for order in range(3):
            np.testing.assert_allclose(values[order, :, degree], exact.deriv(order)(s), rtol=1e-11, atol=1e-11)


def test_one_polynomial_is_the_constant() -> None:
    np.testing.assert_array_equal(legendre(np.array([0.2, 0.7]), 1, order=1)[..., 0], [[1.0, 1.0], [0.0, 0.0]])


def test_thickness_and_height_meet_the_corners() -> None:
    """Bilinear thickness, linear height; with one tip thickness it is Kolivand 2009, Eq. 3.1a."""
    tooth = ToothDimensions(36.0, 95.25, 7.0, 9.5, 5.5, 7.5, 2.5, 3.0)
    np.testing.assert_allclose(tooth.height([0.0, 18.0, 36.0]), [7.0, 8.25, 9.5])
    np.testing.assert_allclose(tooth.thickness([0.0, 0.0, 7.0, 9.5], [0.0, 36.0, 0.0, 36.0]), [5.5, 7.5, 2.5, 3.0])
    x, y = np.array([1.0, 3.0, 6.0]), np.array([3.0, 20.0, 30.0])
    h = TABLE_TOOTH.height(y)
    equation = 5.5 + x * (2.5 - 5.5) / h + (7.5 - 5.5) * y * (h - x) / (36.0 * h)
    np.testing.assert_allclose(TABLE_TOOTH.thickness(x, y), equation, rtol=1e-14)


def test_weights_sum_the_load_vectors_of_the_points() -> None:
    shell = Shell(FE_TOOTH, STEEL, modes=(3, 5))
    random = np.random.default_rng(5)
    x, y = random.uniform(1.0, 8.0, (4, 6)), random.uniform(0.0, 45.0, (4, 6))
    direction, weights = random.normal(size=(4, 6, 3)), random.uniform(size=6)
    offset = random.normal(size=(4, 6))
    points = shell.load_vectors(x, y, direction, offset=offset)
    assert points.shape == (4, 6, shell.size)
    summed = shell.load_vectors(x, y, direction, weights, offset)
    np.testing.assert_allclose(summed, np.einsum("q,iqd->id", weights, points), atol=1e-13)


def test_points_outside_the_tooth_continue_the_polynomials() -> None:
    """Cubic in x with so few modes: five points inside fix the load vector at one below the root and one above."""
    shell = Shell(FE_TOOTH, STEEL, modes=(3, 2))
    inside = np.linspace(1.0, 8.0, 5)
    for outside in (-0.5, 10.5):
        weights = [np.prod([(outside - b) / (a - b) for b in inside if b != a]) for a in inside]
        extrapolated = weights @ shell.load_vectors(inside, 20.0, RADIAL)
        np.testing.assert_allclose(shell.load_vectors(outside, 20.0, RADIAL), extrapolated, atol=1e-12)


def test_thesis_form_feels_radial_loads_only() -> None:
    shell = Shell(FE_TOOTH, STEEL, assumption=thesis_kinematics)
    assert not shell.load_vectors(4.0, 20.0, (1.0, 1.0, 0.0)).any()
    tilted = shell.load_vectors(4.0, 20.0, (0.3, 0.2, 0.9))
    np.testing.assert_allclose(tilted, 0.9 * shell.load_vectors(4.0, 20.0, RADIAL))


def test_no_loads_give_an_empty_matrix() -> None:
    shell = Shell(FE_TOOTH, STEEL, modes=(2, 3))
    vectors = shell.load_vectors(np.zeros(0), np.zeros(0), RADIAL)
    assert vectors.shape == (0, shell.size)
    assert shell.whiten(vectors).shape == (shell.size, 0)
    assert shell.compliance(vectors).shape == (0, 0)
    on_segments = shell.load_vectors(np.zeros((0, 3)), np.zeros((0, 3)), RADIAL, weights=np.full(3, 1.0 / 3.0))
    assert on_segments.shape == (0, shell.size)
    points = np.zeros((0, 3))
    whitened = shell.whitened_mid_surface_loads(points, points, RADIAL, weights=np.full(3, 1.0 / 3.0))
    assert whitened.shape == (0, shell.size - shell.idle_size)


def test_loads_on_the_mid_surface_are_whitened_without_the_rows_that_are_zero() -> None:
    shell = Shell(FE_TOOTH, STEEL, modes=(3, 4))
    vectors = scattered_loads(shell, 5)
    whole = shell.whiten(vectors)
    assert not whole[: shell.idle_size].any()
    whitened = shell.whitened_mid_surface_loads(*scattered_points(shell, 5))
    np.testing.assert_array_equal(whitened, whole[shell.idle_size :].T)
    np.testing.assert_allclose(
        whole.T @ whole,
        vectors @ np.linalg.solve(shell.stiffness(), vectors.T),
        rtol=0,
        atol=1e-10 * np.abs(whole).max(),
    )


def test_whitening_leaves_its_argument_alone() -> None:
    shell = Shell(FE_TOOTH, STEEL, modes=(2, 3))
    vectors = scattered_loads(shell, 5)
    kept = vectors.copy()
    shell.whiten(vectors)
    np.testing.assert_array_equal(vectors, kept)


def test_shells_compare_by_their_inputs_and_survive_pickling() -> None:
    shell = Shell(FE_TOOTH, STEEL, modes=(2, 3))
    assert shell == Shell(FE_TOOTH, STEEL, modes=(2, 3))
    assert shell != Shell(FE_TOOTH, STEEL, modes=(2, 4))
    restored = pickle.loads(pickle.dumps(shell))
    assert restored == shell
    loads = scattered_loads(shell, 4)
    np.testing.assert_array_equal(restored.compliance(loads), shell.compliance(loads))


def test_bad_inputs_are_named() -> None:
    with pytest.raises(InputError, match="elastic_modulus"):
        Material(0.0, 0.3)
    with pytest.raises(InputError, match="poisson_ratio"):
        Material(206000.0, 0.5)
    with pytest.raises(InputError, match="height_heel"):
        dataclasses.replace(FE_TOOTH, height_heel=math.nan)
    with pytest.raises(InputError, match="trace_radius"):
        dataclasses.replace(FE_TOOTH, trace_radius=4.0)
    with pytest.raises(InputError, match="modes"):
        Shell(FE_TOOTH, STEEL, modes=(0, 5))
    with pytest.raises(InputError, match="shear_factor"):
        Shell(FE_TOOTH, STEEL, shear_factor=0.0)
    shell = Shell(FE_TOOTH, STEEL, modes=(2, 3))
    with pytest.raises(InputError, match="direction"):
        shell.load_vectors(4.0, 20.0, 1.0)
    with pytest.raises(InputError, match="weights"):
        shell.load_vectors(4.0, 20.0, RADIAL, weights=1.0)
    with pytest.raises(InputError, match="load_vectors"):
        shell.whiten(np.zeros((3, 4)))
