"""The elastic root: closed plane strain formulas, finite elements of rims, limits of springs; the cheap root stress."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray
from thesis_shell import thesis_kinematics

from easeoff import InputError
from easeoff.contact import STEEL, ElasticFoundation, Material, Shell, ToothDimensions
from easeoff.contact.compliance.shell_kinematics import (
    ROOT_DEFLECTION,
    ROOT_HEIGHT_SHIFT,
    ROOT_ROTATION,
    DisplacementAssumption,
    FoundationSource,
    five_field,
)
from easeoff.verification import shell_root_stress
from easeoff.verification.shell_root_stress import notch_factor, root_section_forces

FloatArray = NDArray[np.float64]
RADIAL = (0.0, 0.0, 1.0)
MEDIUM_TOOTH = ToothDimensions(45.0, 114.3, 8.0, 11.0, 7.0, 9.0, 3.5, 3.5)
SLIM_TOOTH = ToothDimensions(45.0, 114.3, 10.0, 13.0, 6.0, 7.5, 2.5, 2.5)
PLATE = ToothDimensions(30.0, math.inf, 10.0, 10.0, 4.0, 4.0, 4.0, 4.0)
SOURCES: tuple[FoundationSource, ...] = ("weber", "odonnell")
ASSUMPTIONS: tuple[DisplacementAssumption, ...] = (five_field, thesis_kinematics)


def free_edge_peak(shell: Shell) -> float:
    """Peak radial deflection of the tip [um] under 500 N on a 2 x 2 mm patch at mid-face, mid-height."""
    tooth = shell.dimensions
    point, weight = np.polynomial.legendre.leggauss(5)
    middle = 0.5 * tooth.trace_length
    x, y = np.meshgrid(tooth.height(middle) / 2 + point, middle + point, indexing="ij")
    load = shell.load_vectors(x.ravel(), y.ravel(), RADIAL, np.outer(weight, weight).ravel() / 4.0)
    edge_y = np.linspace(0.0, tooth.trace_length, 181)
    edge = shell.load_vectors(tooth.height(edge_y), edge_y, RADIAL)
    return float((500e3 * shell.whiten(edge).T @ shell.whiten(load[None])).max())


def plane_flexibility(
    foundation: ElasticFoundation, height: ArrayLike, thickness: float, material: Material, load_angle: float = 0.0
) -> FloatArray:
    """Deflection of the load point that a unit line load gains from the body, by the plane formula [mm/(N/mm)].

    The line of action crosses the tooth's centre line at the height [mm], at an angle to the thickness [rad].
    """
    a, b, c, k = foundation.constants(material.poisson_ratio)
    slenderness = np.asarray(height, dtype=np.float64) / thickness
    across = a * slenderness**2 + b * slenderness + c
    cosine, sine = math.cos(load_angle), math.sin(load_angle)
    return np.asarray(foundation.factor / material.plane_strain_modulus * (across * cosine**2 + c * k * sine**2))


def line_load(shell: Shell, height: float, direction: tuple[float, float, float]) -> float:
    """Compliance under a uniform line load, per unit of load per length [mm/(N/mm)]."""
    length = shell.dimensions.trace_length
    point, weight = np.polynomial.legendre.leggauss(20)
    y = 0.5 * length * (point + 1.0)
    vector = shell.load_vectors(np.full(y.size, height), y, direction, 0.5 * weight)
    return float(shell.compliance(vector[None])[0, 0]) * length


@pytest.mark.parametrize(
    ("tooth", "foundation", "finite_elements"),
    [
        (MEDIUM_TOOTH, ElasticFoundation("odonnell", 0.8), 1.265),
        (MEDIUM_TOOTH, ElasticFoundation("weber"), 1.323),
        (SLIM_TOOTH, ElasticFoundation("odonnell", 0.8), 2.37),
    ],
    ids=["rim 2.5 modules", "deep body", "slim tooth on rim"],
)
def test_springs_match_finite_elements_of_a_tooth_on_its_rim(
    tooth: ToothDimensions, foundation: ElasticFoundation, finite_elements: float
) -> None:
    """Free-edge peak within 3 % of converged 3-D models that include the body."""
    assert free_edge_peak(Shell(tooth, STEEL, foundation=foundation)) == pytest.approx(finite_elements, rel=0.03)


def test_body_adds_more_than_half_to_the_clamped_peak() -> None:
    """Finite elements: 60 to 67 % for a concentrated load, twice the clamped compliance for a uniform one."""
    clamped, sprung = Shell(MEDIUM_TOOTH, STEEL), Shell(MEDIUM_TOOTH, STEEL, foundation=ElasticFoundation())
    assert 1.55 < free_edge_peak(sprung) / free_edge_peak(clamped) < 1.80
    assert 1.7 < line_load(sprung, 5.0, RADIAL) / line_load(clamped, 5.0, RADIAL) < 2.7


@pytest.mark.parametrize("assumption", ASSUMPTIONS)
@pytest.mark.parametrize("source", SOURCES)
def test_uniform_line_load_gains_exactly_the_closed_formula(
    source: FoundationSource, assumption: DisplacementAssumption
) -> None:
    """A straight uniform tooth without lateral strain is a beam: springs add the plane formula, nothing else.

    The sprung trial space of one more function is the clamped one plus the rigid motions, so it holds at any height;
    in the thesis form the shear strain gains a function too, which leaves a few parts in ten thousand at the tip.
    """
    material = Material(206000.0, 0.0)
    foundation = ElasticFoundation(source, 0.9)
    clamped = Shell(PLATE, material, modes=(5, 5), assumption=assumption)
    sprung = Shell(
        PLATE, material, modes=(6 if assumption is five_field else 7, 5), assumption=assumption, foundation=foundation
    )
    for height in (3.0, 6.0, 10.0) if assumption is five_field else (10.0,):
        gained = line_load(sprung, height, RADIAL) - line_load(clamped, height, RADIAL)
        expected = float(plane_flexibility(foundation, height, 4.0, material))
        assert gained == pytest.approx(expected, rel=1e-9 if assumption is five_field else 1e-3)


@pytest.mark.parametrize("source", SOURCES)
def test_inclined_line_load_gains_the_axial_term(source: FoundationSource) -> None:
    material = Material(206000.0, 0.0)
    foundation = ElasticFoundation(source)
    clamped = Shell(PLATE, material, modes=(5, 5))
    sprung = Shell(PLATE, material, modes=(5, 5), foundation=foundation)
    angle = 0.4
    direction = (-math.sin(angle), 0.0, math.cos(angle))
    gained = line_load(sprung, 10.0, direction) - line_load(clamped, 10.0, direction)
    expected = float(plane_flexibility(foundation, 10.0, 4.0, material, angle))
    assert gained == pytest.approx(expected, rel=1e-8)


def test_published_constants() -> None:
    """Steel: Weber 5.2, 1, 1.4 (1 + 0.29 tan^2); O'Donnell 5.306, 1.143, 1.534 (1 + 0.32 tan^2)."""
    unit = 1.0 / STEEL.plane_strain_modulus
    for source, numbers in (("weber", (5.2, 1.0, 1.4, 0.29)), ("odonnell", (5.306, 1.143, 1.534, 0.3205))):
        a, b, c, k = numbers
        foundation = ElasticFoundation("weber" if source == "weber" else "odonnell")
        for slenderness in (0.0, 0.5, 1.5):
            angle = 0.3
            expected = a * slenderness**2 + b * slenderness + c * (1.0 + k * math.tan(angle) ** 2)
            actual = plane_flexibility(foundation, slenderness * 7.0, 7.0, STEEL, angle)
            assert float(actual) == pytest.approx(unit * math.cos(angle) ** 2 * expected, rel=1e-3)


def test_body_share_against_plane_finite_elements() -> None:
    """Line load on a deep body, root to tip: Weber over finite elements 0.90 to 1.00, O'Donnell 0.97 to 1.05.

    So the two formulas stand in the ratio of those figures.
    """
    heights = 9.5 * np.array([0.3, 0.5, 0.7, 0.9])
    weber = plane_flexibility(ElasticFoundation("weber"), heights, 8.0, STEEL)
    odonnell = plane_flexibility(ElasticFoundation("odonnell"), heights, 8.0, STEEL)
    np.testing.assert_allclose(
        weber / odonnell, np.divide([0.90, 0.96, 0.99, 1.00], [0.97, 1.03, 1.05, 1.05]), atol=0.02
    )


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("poisson_ratio", [0.0, 0.3, 0.49])
def test_spring_stiffness_is_symmetric_positive_definite(source: FoundationSource, poisson_ratio: float) -> None:
    stiffness = ElasticFoundation(source).stiffness(np.array([3.0, 7.0, 12.0]), Material(206000.0, poisson_ratio))
    np.testing.assert_array_equal(stiffness, np.swapaxes(stiffness, 1, 2))
    assert np.linalg.eigvalsh(stiffness).min() > 0.0


@pytest.mark.parametrize("source", SOURCES)
def test_spring_stiffness_inverts_the_line_load_formula(source: FoundationSource) -> None:
    """Unit shear force and its moment at the root: the work of the springs' answer is the closed formula."""
    foundation = ElasticFoundation(source, 0.8)
    flexibility = np.linalg.inv(foundation.stiffness(np.array([7.0]), STEEL)[0])
    for height in (0.0, 4.0, 9.0):
        load = np.array([1.0, height, 0.0, 0.0, 0.0])
        assert load @ flexibility @ load == pytest.approx(float(plane_flexibility(foundation, height, 7.0, STEEL)))


def test_antiplane_motions_follow_the_half_space_kernels() -> None:
    """Shift along the trace and twist are 1 / (1 - nu) times as flexible as deflection and rotation."""
    flexibility = np.linalg.inv(ElasticFoundation("odonnell").stiffness(np.array([7.0]), STEEL)[0])
    assert flexibility[3, 3] / flexibility[0, 0] == pytest.approx(1.0 / 0.7)
    assert flexibility[4, 4] / flexibility[1, 1] == pytest.approx(1.0 / 0.7)


def random_loads(shell: Shell) -> FloatArray:
    random = np.random.default_rng(4)
    y = random.uniform(0.0, 45.0, 15)
    x = shell.dimensions.height(y) * random.uniform(0.2, 1.0, 15)
    direction = random.normal(size=(15, 3))
    return shell.load_vectors(x, y, direction)


@pytest.mark.parametrize("assumption", ASSUMPTIONS)
def test_softer_springs_only_add_compliance(assumption: DisplacementAssumption) -> None:
    """The difference of the compliance matrices is positive semidefinite, from clamped over stiff to soft springs."""
    chain = [Shell(MEDIUM_TOOTH, STEEL, modes=(4, 7), assumption=assumption)]
    for factor in (1e-2, 0.5, 1.0, 2.0):
        foundation = ElasticFoundation(factor=factor)
        chain.append(Shell(MEDIUM_TOOTH, STEEL, modes=(6, 7), assumption=assumption, foundation=foundation))
    matrices = [shell.compliance(random_loads(shell)) for shell in chain]
    for stiffer, softer in itertools.pairwise(matrices):
        eigenvalues = np.linalg.eigvalsh(softer - stiffer)
        assert eigenvalues[0] > -1e-12 * np.linalg.eigvalsh(softer)[-1]


def test_stiff_springs_tend_to_the_clamped_root() -> None:
    """Linearly in the factor. A free space with one function more contains the clamped one: compare those."""
    clamped = Shell(MEDIUM_TOOTH, STEEL, modes=(5, 9))
    expected = clamped.compliance(random_loads(clamped))
    differences = []
    for factor in (1e-4, 1e-5):
        sprung = Shell(MEDIUM_TOOTH, STEEL, modes=(6, 9), foundation=ElasticFoundation(factor=factor))
        difference = sprung.compliance(random_loads(sprung)) - expected
        differences.append(np.abs(difference).max() / np.abs(expected).max())
    assert differences[1] < 2e-4
    assert differences[0] / differences[1] == pytest.approx(10.0, rel=0.1)


def test_bad_inputs_are_named() -> None:
    with pytest.raises(InputError, match="factor"):
        ElasticFoundation("weber", 0.0)
    with pytest.raises(InputError, match="weber, odonnell"):
        ElasticFoundation("stegemiller")  # type: ignore[arg-type]


# The cheap root stress: balance of the root springs, and the notch factor's published constants


TOOTH = ToothDimensions(36.0, math.inf, 7.0, 9.5, 5.5, 7.5, 2.5, 2.5)


def test_root_springs_balance_the_load() -> None:
    """Whatever acts wherever on a straight tooth: its force, and its moment about the root line, come back."""
    shell = Shell(TOOTH, STEEL, foundation=ElasticFoundation())
    x, y = np.array([3.0, 6.0]), np.array([10.0, 30.0])
    loads = shell.load_vectors(x, y, np.array([[0.0, 0.0, 1.0], [-0.4, 0.0, 0.9]]))
    at, weights = np.polynomial.legendre.leggauss(24)
    forces = root_section_forces(shell, 18.0 * (1.0 + at), loads)
    total = 18.0 * np.einsum("s,asn->an", weights, forces)
    np.testing.assert_allclose(total[ROOT_DEFLECTION], [1.0, 0.9], rtol=1e-9)
    np.testing.assert_allclose(total[ROOT_HEIGHT_SHIFT], [0.0, -0.4], atol=1e-9)
    np.testing.assert_allclose(np.abs(total[ROOT_ROTATION]), [3.0, 6.0 * 0.9], rtol=1e-9)


def test_notch_factor_has_its_printed_exponents() -> None:
    """At 20 degrees the photoelastic tests gave 0.18, 0.15 and 0.45; at 14.5 degrees 0.22, 0.20 and 0.40."""
    for degrees, (base, by_radius, by_height) in ((20.0, (0.18, 0.15, 0.45)), (14.5, (0.22, 0.20, 0.40))):
        expected = base + 6.0**by_radius * 1.2**by_height
        found = notch_factor(np.array(6.0), 1.0, np.array(5.0), math.radians(degrees))
        assert found == pytest.approx(expected, abs=0.015)


def test_stress_of_a_uniform_line_load_is_that_of_a_beam() -> None:
    """Of a material that does not contract, so that its ends are like its middle."""
    plate = ToothDimensions(30.0, math.inf, 10.0, 10.0, 4.0, 4.0, 4.0, 4.0)
    shell = Shell(plate, Material(206000.0, 0.0), foundation=ElasticFoundation())
    at, weights = np.polynomial.legendre.leggauss(9)
    y = 15.0 * (1.0 + at)
    load = 600.0 * shell.load_vectors(np.full(9, 8.0), y, (0.0, 0.0, 1.0), 0.5 * weights)
    stress = shell_root_stress(shell, y, load[None], 1.0, math.radians(20.0))
    nominal = 6.0 * (600.0 / 30.0 * 8.0) / 4.0**2
    factor = notch_factor(np.array(4.0), 1.0, np.array(8.0), math.radians(20.0))
    np.testing.assert_allclose(stress[:, 0], nominal * factor, rtol=1e-6)


def test_no_springs_or_no_fillet_no_stress() -> None:
    clamped, sprung = Shell(TOOTH, STEEL), Shell(TOOTH, STEEL, foundation=ElasticFoundation())
    load = np.ones((1, clamped.size))
    with pytest.raises(InputError, match="clamped"):
        root_section_forces(clamped, np.array([1.0]), load)
    with pytest.raises(InputError, match="fillet_radius"):
        shell_root_stress(sprung, np.array([1.0]), np.ones((1, sprung.size)), 0.0, 0.3)
