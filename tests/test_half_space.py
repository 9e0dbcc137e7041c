"""A force on a half space: equilibrium, free surface, known limits."""

from __future__ import annotations

import numpy as np
import pytest

from easeoff.contact import STEEL
from easeoff.contact.compliance.half_space_cells import even_pressure_integral
from easeoff.verification.flank_contact.half_space import point_force_displacement, point_force_traction

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
