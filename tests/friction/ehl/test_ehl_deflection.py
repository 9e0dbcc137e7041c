"""Elastic deflection of the film model, and the direct solver of its linear systems."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.linalg import toeplitz

from easeoff.friction.ehl import hierarchical_matrix as hierarchical
from easeoff.friction.ehl.hierarchical_matrix import Deflection, logarithm_of_hats

Array = NDArray[np.float64]


@pytest.mark.parametrize("k", [0, 1, 2, 7, 39, 40, 41, 300])
def test_hat_integral_is_that_of_quadrature(k: int) -> None:
    def integrand(x: float) -> float:
        return float((1.0 - abs(x)) * np.log(abs(k - x))) if x != k else 0.0

    expected = quad(integrand, -1.0, 0.0, epsabs=1e-13)[0] + quad(integrand, 0.0, 1.0, epsabs=1e-13)[0]
    assert logarithm_of_hats(np.array(k)) == pytest.approx(expected, abs=1e-10)


def test_series_and_closed_form_of_the_hat_integral_agree_where_they_meet() -> None:
    k = np.arange(30, 60)
    second = np.diff(logarithm_of_hats(k), 2)
    np.testing.assert_allclose(second, np.diff(np.log(k) - 1 / (12.0 * k**2) - 1 / (60.0 * k**4), 2), atol=1e-12)


@pytest.mark.parametrize("n", [65, 200, 513])
def test_fourier_transforms_give_the_dense_product(n: int) -> None:
    deflection = Deflection(n, 0.013)
    pressure = np.random.default_rng(n).normal(size=(3, n))
    dense = toeplitz(deflection.influence) @ pressure.T
    np.testing.assert_allclose(deflection(pressure), dense.T, rtol=0, atol=1e-13 * np.abs(dense).max() * n)


def hertz_errors(n: int) -> tuple[float, float]:
    """Errors of the deflection under a Hertz pressure: within the contact (flat but for the parabola), and outside."""
    x = np.linspace(-3.0, 3.0, n)
    deflection = Deflection(n, x[1] - x[0])(np.sqrt(np.maximum(1.0 - x**2, 0.0)))
    closed = 0.25 * (1.0 + 2.0 * np.log(2.0)) - 0.5 * x**2
    far = np.abs(x) > 1.0
    root = np.sqrt(x[far] ** 2 - 1.0)
    closed[far] += 0.5 * (np.abs(x[far]) * root - np.log(np.abs(x[far]) + root))
    error = np.abs(deflection - closed)
    return float(error[np.abs(x) < 0.9].max()), float(error[np.abs(x) > 1.1].max())


def test_hertz_pressure_flattens_the_contact() -> None:
    """Its deflection in closed form; the infinite slope at the edge of the pressure leaves an order of 3/2."""
    errors = np.array([hertz_errors(n) for n in (193, 385, 769, 1537)])
    order = np.log2(errors[:-1] / errors[1:])
    assert ((order > 1.4) & (order < 1.6)).all()
    assert errors[-1].max() < 6e-5


def test_deflection_under_a_smooth_pressure_converges_to_second_order() -> None:
    """Against adaptive quadrature of the logarithm."""

    def exact(x: float) -> float:
        value, _ = quad(lambda s: (1.0 - s**2) ** 3 * np.log(abs(x - s)), -1.0, 1.0, points=[x], epsabs=1e-13)
        return float(-value / np.pi)

    expected = np.array([exact(x) for x in (-0.5, 0.0, 0.75)])
    errors = []
    for n in (129, 257, 513):
        x = np.linspace(-2.0, 2.0, n)
        computed = Deflection(n, x[1] - x[0])(np.maximum(1.0 - x**2, 0.0) ** 3)
        errors.append(np.abs(computed[np.searchsorted(x, [-0.5, 0.0, 0.75])] - expected).max())
    order = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert (np.abs(order - 2.0) < 0.1).all()


def bands(n: int, rng: np.random.Generator) -> tuple[Array, Array]:
    """Bands like those of the contact: Poiseuille flow at one end, advection at the other."""
    a, c = np.zeros((4, n)), np.zeros((4, n))
    a[2], a[1], a[3] = 2.0 * np.geomspace(1.0, 1e-6, n), -np.geomspace(1.0, 1e-6, n), -np.geomspace(1.0, 1e-6, n)
    c[2], c[1], c[0] = 1.5, -2.0, 0.5
    a[0] = 0.01 * rng.random(n)
    c *= -0.01 / np.pi * rng.uniform(0.5, 1.0, n)
    for k, offset in enumerate(hierarchical.OFFSETS):
        outside = (np.arange(n) + offset < 0) | (np.arange(n) + offset >= n)
        a[k, outside] = c[k, outside] = 0.0
    return a, c


def dense(diagonals: Array) -> Array:
    n = diagonals.shape[1]
    matrix = np.zeros((n, n))
    for k, offset in enumerate(hierarchical.OFFSETS):
        row = np.arange(max(0, -offset), n - max(0, offset))
        matrix[row, row + offset] = diagonals[k, row]
    return matrix


@pytest.mark.parametrize("n", [50, 97, 131, 256, 500, 771])
def test_hierarchical_solver_is_as_good_as_a_dense_one(n: int) -> None:
    rng = np.random.default_rng(n)
    a, c = bands(n, rng)
    matrix = dense(a) + dense(c) @ toeplitz(logarithm_of_hats(np.arange(n)))
    sides = rng.normal(size=(n, 2))
    solution = hierarchical.solve(a, c, sides)
    direct = np.linalg.solve(matrix, sides)
    backward_error = np.abs(matrix @ solution - sides).max() / (np.abs(matrix).sum(axis=1).max() * np.abs(direct).max())
    assert backward_error < 1e-12
    np.testing.assert_allclose(solution, direct, rtol=0, atol=1e-9 * np.abs(direct).max())


def test_ranks_of_the_blocks_hardly_grow_with_the_nodes() -> None:
    """What makes the cost n log^2 n: seven doublings add a rank of one or two each."""
    ranks = [h.on_first[0].shape[1] for h in hierarchical._tree(6144).halvings]
    assert len(ranks) == 7
    assert max(ranks) <= 26
    assert all(abs(a - b) <= 3 for a, b in pairwise(ranks))
