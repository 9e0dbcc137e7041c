"""A force on a half space, and half spaces on a grid of cells: equilibrium, known limits, Hertz, the dense problem."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from easeoff import InputError
from easeoff.contact import STEEL, ContactProblem, HalfSpaceCompliance, Material, OperatorCompliance, certify, solve
from easeoff.contact.compliance.half_space_cells import even_pressure_integral
from easeoff.verification import problems
from easeoff.verification.flank_contact import half_space_compliance
from easeoff.verification.flank_response import point_force_displacement, point_force_traction
from easeoff.verification.problem_classes import PROBLEM_CLASSES
from easeoff.verification.surface_cells import SurfaceCells

RNG = np.random.default_rng(4)
INWARD = np.array([0.6, 0.0, 0.8])


def test_tractions_are_those_of_the_displacements() -> None:
    """Hooke's law on a difference quotient, inside the half space and a little beyond its surface."""
    nu, shear = STEEL.poisson_ratio, STEEL.shear_modulus
    step = 1e-5
    for offset in ([1.2, -0.7, 0.5], [-0.4, 0.3, 1.0], [1.0, 0.5, -0.9]):
        normal = RNG.normal(size=3)
        normal /= np.linalg.norm(normal)
        shifts = step * np.eye(3)
        gradient = np.stack(
            [
                (
                    point_force_displacement(offset + s, INWARD, STEEL)
                    - point_force_displacement(offset - s, INWARD, STEEL)
                )
                / (2.0 * step)
                for s in shifts
            ]
        )
        strain = 0.5 * (gradient + gradient.T)
        stress = 2.0 * shear * (strain + nu / (1.0 - 2.0 * nu) * np.trace(strain) * np.eye(3))
        found = point_force_traction(np.array(offset), INWARD, normal, nu)
        np.testing.assert_allclose(found, stress @ normal, rtol=1e-6, atol=1e-9)


def test_a_half_sphere_carries_the_force() -> None:
    """The tractions on any half sphere around the force balance it, and the surface itself is free."""
    z, weights = np.polynomial.legendre.leggauss(20)
    z, weights = 0.5 * (z + 1.0), 0.5 * weights
    angle = np.arange(40) * 2.0 * np.pi / 40
    radius = np.sqrt(1.0 - z**2)
    sides = (np.array([0.8, 0.0, -0.6]), np.array([0.0, 1.0, 0.0]))
    points = z[:, None, None] * INWARD + radius[:, None, None] * (
        np.cos(angle)[:, None] * sides[0] + np.sin(angle)[:, None] * sides[1]
    )
    for size in (0.3, 5.0):
        traction = point_force_traction(size * points, INWARD, points, STEEL.poisson_ratio)
        total = size**2 * 2.0 * np.pi / 40 * np.einsum("i,ijx->x", weights, traction)
        np.testing.assert_allclose(total, -INWARD, atol=1e-12)
    on_surface = 2.0 * sides[0] - 3.0 * sides[1]
    assert np.abs(point_force_traction(on_surface, INWARD, -INWARD, STEEL.poisson_ratio)).max() < 1e-17


def test_surface_sinks_by_the_closed_form() -> None:
    """(1 - nu^2) / (pi E r) at a distance r along the surface."""
    sunk = point_force_displacement(np.array([0.0, 2.5, 0.0]), INWARD, STEEL) @ INWARD
    assert sunk == pytest.approx(1.0 / (np.pi * STEEL.plane_strain_modulus * 2.5), rel=1e-14)


def test_integral_over_a_rectangle() -> None:
    """In the middle of a square 8 a ln(1 + sqrt 2) of its half side a; far away the area over the distance."""
    a = np.array(0.7)
    middle = even_pressure_integral(np.array(0.0), np.array(0.0), a, a)
    assert middle == pytest.approx(8.0 * 0.7 * np.log(1.0 + np.sqrt(2.0)), rel=1e-14)
    far = even_pressure_integral(np.array(30.0), np.array(40.0), a, 0.5 * a)
    assert far == pytest.approx(2.0 * 0.7**2 / 50.0, rel=1e-4)
    x, w = np.polynomial.legendre.leggauss(24)
    distance = np.hypot(1.1 - 0.7 * x[:, None], 0.4 - 0.2 * x[None, :])
    numeric = 0.7 * 0.2 * float(np.sum(np.outer(w, w) / distance))
    assert even_pressure_integral(np.array(1.1), np.array(0.4), a, np.array(0.2)) == pytest.approx(numeric, rel=1e-9)


# Half spaces on a grid of cells, solved by products alone: Hertz, the dense problem, identities


BOTH = (STEEL, STEEL)
MODULUS = 0.5 * STEEL.plane_strain_modulus
FORCE = 100.0  # [N]


def grid(count: int, side: float) -> tuple[NDArray[Any], NDArray[Any]]:
    """Middles of square cells (count, count) [mm] around the origin."""
    middle = side * (np.arange(count) - 0.5 * (count - 1))
    x, y = np.meshgrid(middle, middle, indexing="ij")
    return x, y


def random_problem(seed: int, shape: tuple[int, int] = (9, 11)) -> ContactProblem:
    """Rough surface under a torque about an axis, dense."""
    rng = np.random.default_rng(seed)
    compliance = HalfSpaceCompliance(shape, (0.1, 0.07), (STEEL, Material(70e3, 0.33)))
    n = shape[0] * shape[1]
    return ContactProblem(2e-3 * rng.random(n), 40.0 + 5.0 * rng.random(n), 4e3, compliance @ np.eye(n))


def as_operator(problem: ContactProblem, shape: tuple[int, int] = (9, 11)) -> ContactProblem:
    compliance = HalfSpaceCompliance(shape, (0.1, 0.07), (STEEL, Material(70e3, 0.33)))
    return ContactProblem(problem.separation, problem.lever_arm, problem.torque, compliance)


def test_products_are_those_of_the_matrix() -> None:
    """Against the same influence coefficients pair by pair, from cells in space."""
    shape, sides = (4, 7), (0.2, 0.05)
    operator = HalfSpaceCompliance(shape, sides, BOTH)
    n = 28
    position = np.zeros((n, 3))
    position[:, 0], position[:, 1] = (
        side * index for side, index in zip(sides, np.indices(shape).reshape(2, n), strict=True)
    )
    axes = np.repeat(np.eye(3)[:, None], n, axis=1)
    at, zero = np.zeros(n, dtype=int), np.zeros((2, n))
    cells = SurfaceCells(at, at, axes[0], axes[1], np.tile(sides, (n, 1)), position, zero, zero, np.ones(n), np.ones(n))
    matrix = half_space_compliance(cells, BOTH)
    np.testing.assert_allclose(operator @ np.eye(n), matrix, rtol=0, atol=1e-14 * matrix.max())
    np.testing.assert_allclose(operator.diagonal(), matrix.diagonal(), rtol=1e-14)
    force = np.random.default_rng(3).random(n)
    np.testing.assert_allclose(operator.T @ force, operator @ force, rtol=1e-14)
    assert np.linalg.eigvalsh(matrix).min() > 0.0


def test_far_away_a_cell_is_a_point_force() -> None:
    operator = HalfSpaceCompliance((1, 101), (0.1, 0.1), BOTH)
    force = np.zeros(101)
    force[0] = 1.0
    far = (operator @ force)[100]
    assert far == pytest.approx(1.0 / (np.pi * MODULUS * 10.0), rel=1e-4)


@pytest.mark.parametrize("seed", range(4))
def test_solution_is_that_of_the_dense_problem(seed: int) -> None:
    dense = random_problem(seed)
    expected, found = solve(dense), solve(as_operator(dense))
    assert found.certified
    assert found.method == "projected_conjugate_gradients"
    assert 5 < np.count_nonzero(expected.force) < dense.size
    assert np.array_equal(found.active, expected.active)
    np.testing.assert_allclose(found.force, expected.force, rtol=0, atol=1e-8 * expected.force.max())
    assert found.elastic_rotation == pytest.approx(expected.elastic_rotation, rel=1e-10)
    assert certify(dense, found.force, found.rotation, found.elastic_rotation).worst < 1e-9


@pytest.mark.parametrize("name", PROBLEM_CLASSES)
def test_every_class_of_problems_is_solved_by_products(name: str) -> None:
    """Degenerate, badly scaled, nearly singular, with lever arms of both signs."""
    for given in problems(name, 5):
        matrix = given.dense_compliance
        products = OperatorCompliance(_products(matrix), matrix.diagonal())
        found = solve(ContactProblem(given.separation, given.lever_arm, given.torque, products))
        assert found.certified, (name, found.message)
        assert found.elastic_rotation == pytest.approx(solve(given).elastic_rotation, rel=1e-9)


def _products(matrix: NDArray[Any]) -> Any:
    from scipy.sparse.linalg import aslinearoperator

    return aslinearoperator(matrix)


def sphere(count: int) -> tuple[ContactProblem, float, float, float]:
    """Sphere of 20 mm on a plane, and by Hertz the approach, the greatest pressure and the radius of contact."""
    radius = (0.75 * FORCE * 20.0 / MODULUS) ** (1.0 / 3.0)
    side = 3.0 * radius / count
    x, y = grid(count, side)
    compliance = HalfSpaceCompliance((count, count), (side, side), BOTH)
    problem = ContactProblem((0.5 * (x**2 + y**2) / 20.0).ravel(), np.ones(count**2), FORCE, compliance)
    return problem, radius**2 / 20.0, 1.5 * FORCE / (np.pi * radius**2), radius


def test_point_contact_converges_to_hertz() -> None:
    """Approach with the square of the cell's side in the mean; pressure in the middle and area with it."""
    error = {}
    for count in (17, 33, 65, 129):
        problem, approach, peak, radius = sphere(count)
        solution = solve(problem)
        assert solution.certified
        area = (3.0 * radius / count) ** 2
        error[count] = solution.rotation / approach - 1.0
        assert solution.force.max() / area == pytest.approx(peak, rel=0.5 / count)
        assert solution.active.sum() * area == pytest.approx(np.pi * radius**2, rel=1.0 / count)
    order = np.polyfit(np.log(list(error)), np.log(np.abs(list(error.values()))), 1)[0]
    assert -2.6 < order < -1.6
    assert abs(error[129]) < 3e-5


def test_slender_contact_is_hertz_ellipse_and_line_contact_in_its_middle() -> None:
    """Radii of 1600 and 20 mm. The exact ellipse (Johnson 1985, Eqs. 4.26 to 4.30), and the line load in its middle."""
    along, across = 1.0 / 1600.0, 1.0 / 20.0

    def ratio(k: float) -> float:
        m = 1.0 - k**2
        return float((ellipe(m) / k**2 - ellipk(m)) / (ellipk(m) - ellipe(m)) - across / along)

    k = brentq(ratio, 1e-3, 0.99)
    m = 1.0 - k**2
    a = (3.0 * FORCE / (np.pi * MODULUS * m * along) * (ellipk(m) - ellipe(m))) ** (1.0 / 3.0)
    peak, approach = 1.5 * FORCE / (np.pi * k * a**2), 1.5 * FORCE / (np.pi * a * MODULUS) * ellipk(m)
    count, sides = 97, (2.4 * a / 97, 2.4 * k * a / 97)
    x, y = (side * (np.arange(count) - 48) for side in sides)
    separation = 0.5 * (along * x[:, None] ** 2 + across * y[None] ** 2)
    arm = 40.0
    problem = ContactProblem(
        separation.ravel(), np.full(count**2, arm), arm * FORCE, HalfSpaceCompliance((count, count), sides, BOTH)
    )
    solution = solve(problem)
    assert solution.certified
    assert arm * solution.rotation == pytest.approx(approach, rel=2e-4)
    pressure = solution.force.reshape(count, count) / (sides[0] * sides[1])
    exact = peak * np.sqrt(np.maximum(1.0 - (x[:, None] / a) ** 2 - (y[None] / (k * a)) ** 2, 0.0))
    assert np.abs(pressure - exact).mean() < 2e-3 * peak
    assert pressure.max() == pytest.approx(peak, rel=2e-3)
    load = pressure[48].sum() * sides[1]  # [N/mm]
    assert pressure[48].max() == pytest.approx(np.sqrt(load * MODULUS * across / np.pi), rel=0.02)


def test_work_of_the_torque_is_that_on_the_cells() -> None:
    """F'C F + S'F = theta T, r'F = T; and the torque does the work: dE/dT = theta."""
    dense = random_problem(11)
    problem = as_operator(dense)

    def energy(torque: float) -> float:
        at = solve(problem.with_torque(torque))
        return float(at.force @ (0.5 * problem.deflection(at.force) + problem.separation))

    found, step = solve(problem), 1e-4 * problem.torque
    work = float(found.force @ problem.deflection(found.force) + problem.separation @ found.force)
    assert work == pytest.approx(found.rotation * problem.torque, rel=1e-10)
    assert problem.lever_arm @ found.force == pytest.approx(problem.torque, rel=1e-12)
    slope = (energy(problem.torque + step) - energy(problem.torque - step)) / (2.0 * step)
    assert slope == pytest.approx(found.rotation, rel=1e-6)


def test_warm_start_saves_steps() -> None:
    problem, *_ = sphere(65)
    cold = solve(problem)
    warm = solve(problem, initial_active=cold.active)
    assert warm.certified
    assert warm.iterations < cold.iterations
    np.testing.assert_allclose(warm.force, cold.force, rtol=0, atol=1e-8 * cold.force.max())


def test_lengths_and_numbers_are_checked() -> None:
    with pytest.raises(InputError, match="sides"):
        HalfSpaceCompliance((4, 4), (0.1, -0.1), BOTH)
    with pytest.raises(InputError, match="shape"):
        HalfSpaceCompliance((4, 0), (0.1, 0.1), BOTH)
