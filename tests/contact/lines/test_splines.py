"""The monotone cubic and the tensor spline beside those of scipy, and on what they must reproduce."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import NdBSpline, PchipInterpolator, make_interp_spline

from easeoff.contact.lines.flank_splines import MonotoneCubic, TensorSpline

Array = NDArray[Any]
ORDERS = [(a, b) for a in range(4) for b in range(4 - a)]


@pytest.mark.parametrize("count", [2, 3, 4, 30])
def test_monotone_cubic_is_that_of_scipy(count: int) -> None:
    rng = np.random.default_rng(count)
    for _ in range(20):
        places, values = np.cumsum(rng.uniform(0.1, 2.0, count)), rng.normal(size=count).round(1)
        at = np.concatenate([places, rng.uniform(places[0] - 1.0, places[-1] + 1.0, 50)])
        wanted = PchipInterpolator(places, values, extrapolate=False)(at)
        np.testing.assert_allclose(MonotoneCubic(places, values)(at), wanted, rtol=0, atol=1e-13)


def test_monotone_cubic_stays_between_neighbouring_values() -> None:
    values = np.array([0.0, 0.1, 5.0, 5.0, 1.0])
    fine = MonotoneCubic(np.arange(5.0), values)(np.linspace(0.0, 4.0, 401)).reshape(-1)
    for i in range(4):
        low, high = sorted(values[i : i + 2])
        part = fine[100 * i : 100 * i + 101]
        assert low - 1e-15 <= part.min() <= part.max() <= high + 1e-15


def surface(nodes: tuple[Array, Array]) -> Array:
    t, h = np.meshgrid(*nodes, indexing="ij")
    return np.stack([np.sin(3.0 * t + k) * np.cos(2.0 * h - k) + t * h for k in range(3)], axis=-1)


@pytest.mark.parametrize("shape", [(31, 21), (9, 7), (6, 5), (5, 4)])
def test_tensor_spline_and_its_derivatives_are_those_of_scipy(shape: tuple[int, int]) -> None:
    """Also a little beyond the grid, on uneven nodes of even and odd degrees."""
    nodes = np.linspace(0.0, 1.0, shape[0]) ** 1.1, np.linspace(0.0, 1.0, shape[1])
    values, degrees = surface(nodes), (min(5, shape[0] - 1), min(5, shape[1] - 1))
    along = make_interp_spline(nodes[0], values, k=degrees[0], axis=0)
    across = make_interp_spline(nodes[1], np.moveaxis(along.c, 1, 0), k=degrees[1], axis=0)
    known = NdBSpline((along.t, across.t), np.ascontiguousarray(np.moveaxis(across.c, 0, 1)), degrees)
    points = np.random.default_rng(1).uniform(-0.01, 1.01, (2, 500))
    found = TensorSpline.through(nodes, values, degrees).evaluate(points, ORDERS)
    for order, mine in zip(ORDERS, found, strict=True):
        wanted = known(points.T, nu=order).T
        scale = max(float(np.abs(wanted).max()), 1.0)
        np.testing.assert_allclose(mine / scale, wanted / scale, rtol=0, atol=1e-10)


def test_tensor_spline_passes_through_its_nodes_and_keeps_its_parts() -> None:
    nodes = np.linspace(0.0, 1.0, 31), np.linspace(0.0, 1.0, 21)
    spline = TensorSpline.through(nodes, surface(nodes), (5, 5))
    points = np.stack(np.meshgrid(*nodes, indexing="ij")).reshape(2, -1)
    (found,) = spline.evaluate(points, [(0, 0)])
    np.testing.assert_allclose(found.T.reshape(31, 21, 3), surface(nodes), rtol=0, atol=1e-14)
    np.testing.assert_array_equal(spline.part(np.array([2, 0])).evaluate(points, [(0, 0)])[0], found[[2, 0]])


@pytest.mark.parametrize("shape", [(31, 21), (5, 4)])
def test_values_on_a_grid_are_those_of_its_points(shape: tuple[int, int]) -> None:
    nodes = np.linspace(0.0, 1.0, shape[0]) ** 1.1, np.linspace(0.0, 2.0, shape[1])
    spline = TensorSpline.through(nodes, surface(nodes), (min(5, shape[0] - 1), min(5, shape[1] - 1)))
    axes = np.linspace(-0.01, 1.01, 70), np.concatenate([nodes[1], [0.13, 2.02]])
    points = np.stack(np.meshgrid(*axes, indexing="ij"))
    (wanted,) = spline.evaluate(points.reshape(2, -1), [(0, 0)])
    np.testing.assert_allclose(spline.on_grid(*axes), wanted.reshape(3, *points.shape[1:]), rtol=0, atol=1e-13)


def test_polynomials_of_fifth_degree_are_exact() -> None:
    nodes = np.linspace(0.0, 1.0, 12), np.linspace(0.0, 1.0, 9)
    t, h = np.meshgrid(*nodes, indexing="ij")
    spline = TensorSpline.through(nodes, ((t - 0.3) ** 5 * (h - 0.6) ** 4)[..., None], (5, 5))
    t, h = points = np.random.default_rng(2).uniform(0.0, 1.0, (2, 100))
    value, mixed = spline.evaluate(points, [(0, 0), (1, 2)])
    np.testing.assert_allclose(value[0], (t - 0.3) ** 5 * (h - 0.6) ** 4, rtol=0, atol=1e-14)
    np.testing.assert_allclose(mixed[0], 60.0 * (t - 0.3) ** 4 * (h - 0.6) ** 2, rtol=0, atol=1e-10)


def test_points_are_evaluated_each_alone() -> None:
    """At nodes, beside them, beyond the grid and where a point is not finite; whatever stands beside the point."""
    nodes = np.linspace(0.0, 1.0, 31) ** 1.1, np.linspace(0.0, 2.0, 9)
    spline = TensorSpline.through(nodes, np.tile(surface(nodes), 3)[..., :7], (5, 5))
    points = np.random.default_rng(1).uniform(-0.01, 1.01, (2, 300)) * [[1.0], [2.0]]
    points[0, :31], points[1, 40:49] = nodes[0], nodes[1]
    points[:, 60], points[0, 61], points[1, 62] = np.nan, np.nan, np.nan
    found = spline.evaluate(points, ORDERS)
    for mine in found:
        assert np.flatnonzero(np.isnan(mine).any(axis=0)).tolist() == [60, 61, 62]
    for i in (0, 60, 299):
        for mine, alone in zip(found, spline.evaluate(points[:, [i]], ORDERS), strict=True):
            np.testing.assert_array_equal(mine[:, i], alone[:, 0])
