"""Deviations between the nodes of a measuring grid: a spline, a smoothed spline, and a weighted average.

Both are functions of the axial and radial coordinate of a flank point, analytic in the sense that they can be
differentiated by complex step. No coordinates of the flank itself are interpolated, its deviations alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from ..newton import cramers_rule, determinant

if TYPE_CHECKING:
    from scipy.interpolate import NdBSpline

Array = NDArray[Any]
SPLINE_DEGREE = 3
# Lengths over which the parts of the spline fade to constants, as shares of the grid's size:
TREND_FADING = 0.25  # the surface of second order, beyond the edge of the flank
REST_FADING = 0.02  # what the nodes have besides, beyond the grid
SQUARED_DISTANCE_OFFSET = 1e-12  # [mm^2]; added to squared distances, so that a node is no division by zero
LOCATING_STEP_LIMIT = 30


class Interpolant(Protocol):
    """A deviation as a function of axial and radial coordinate."""

    def __call__(self, axial: Array, radial: Array) -> tuple[Array, Array]:
        """Deviation (...) [mm] and its slope by the axial and the radial coordinate (2, ...) [1]."""
        ...


@dataclass(frozen=True, eq=False)
class WeightedAverage:
    """All nodes, weighted by the inverse of their squared distance in the axial plane.

    The dissertation interpolates and extrapolates by "a simple weighted average" (Kolivand 2009, section 4.5.2) and
    does not print the weights; these are Shepard's (1968, doi:10.1145/800186.810616). Exact at the nodes, where the
    slope is zero; between them drawn to the mean of all.

    Parameters
    ----------
    axial, radial
        Coordinates of the nodes (k) [mm].
    value
        Deviations at the nodes (k) [mm].
    """

    axial: Array
    radial: Array
    value: Array

    def __call__(self, axial: Array, radial: Array) -> tuple[Array, Array]:
        """See ``Interpolant``."""
        shift = np.stack([axial[..., None] - self.axial, radial[..., None] - self.radial])
        weight = 1.0 / (shift[0] ** 2 + shift[1] ** 2 + SQUARED_DISTANCE_OFFSET)
        total = weight.sum(axis=-1)
        value = (weight * self.value).sum(axis=-1) / total
        by_point = -2.0 * shift * weight**2
        return value, (by_point * (self.value - value[..., None])).sum(axis=-1) / total


@frozen_arrays
@dataclass(frozen=True, eq=False)
class GridSpline:
    """A bicubic spline through the nodes, in the grid's own coordinates.

    Exact at the nodes and between them for every polynomial of third order in the grid's coordinates (of second, where
    a direction has three nodes). Grid coordinates run from 0 to 1 over the columns (u) and rows (v). Beyond the grid
    the surface of second order in the axial plane that fits all nodes best is continued, up to the edge of the flank;
    what the nodes have besides soon ceases to change. So a global error is extrapolated as such, and the scatter of
    the outermost nodes is not magnified.

    Parameters
    ----------
    axial, radial
        Coordinates of the nodes (columns, rows) [mm].
    value
        Deviations at the nodes (columns, rows) [mm].
    edge
        Axial and radial coordinates of the flank's corners (2, k) [mm].
    """

    axial: Array
    radial: Array
    value: Array
    edge: Array

    @cached_property
    def _spline(self) -> NdBSpline:
        """Tensor spline with the components axial, radial, surface of second order, and the rest."""
        from scipy.interpolate import NdBSpline, make_interp_spline

        x, y = (values - values.mean() for values in (self.axial, self.radial))
        terms = np.stack([np.ones_like(x), x, y, x**2, x * y, y**2], axis=-1).reshape(-1, 6)
        size = np.max(np.abs(terms), axis=0)
        trend = (terms / size @ np.linalg.lstsq(terms / size, self.value.ravel(), rcond=None)[0]).reshape(x.shape)
        nodes = np.stack([self.axial, self.radial, trend, self.value - trend], axis=-1)
        knots, degrees, coefficients = [], [], nodes
        for axis in (0, 1):
            steps = np.linalg.norm(np.diff(nodes[..., :2], axis=axis), axis=-1).mean(axis=1 - axis)
            point = np.concatenate([[0.0], np.cumsum(steps)]) / np.sum(steps)
            degree = min(SPLINE_DEGREE, point.size - 1)
            one_way = make_interp_spline(point, coefficients, k=degree, axis=axis)
            # The spline puts the direction it went through first.
            coefficients = np.moveaxis(one_way.c, 0, axis)
            knots.append(one_way.t)
            degrees.append(degree)
        return NdBSpline(tuple(knots), np.ascontiguousarray(coefficients), tuple(degrees))

    @cached_property
    def _bounds(self) -> Array:
        """Grid coordinates of the flank's edges (2, lower/upper), at least those of the grid."""
        corners = self.locate(*self.edge)
        return np.stack([np.minimum(corners.min(axis=1), 0.0), np.maximum(corners.max(axis=1), 1.0)], axis=1)

    def _derivatives(self, point: Array, order: int) -> Array:
        """Values and derivatives (order + 1, order + 1, 4, n) of the components by both grid coordinates (2, n).

        Beyond the grid, the polynomials of that order from its edge.
        """
        inside = np.clip(point, 0.0, 1.0)
        beyond = point - inside
        degrees = [int(degree) for degree in np.asarray(self._spline.k)]
        table = np.zeros((order + 1, order + 1, 4, point.shape[1]))
        for a in range(min(order, degrees[0]) + 1):
            for b in range(min(order, degrees[1]) + 1):
                table[a, b] = self._spline(inside.T, nu=(a, b)).T
        for axis, shift in enumerate(beyond):
            terms = np.moveaxis(table, axis, 0)
            if order == 2:
                terms[0] += shift * terms[1] + 0.5 * shift**2 * terms[2]
                terms[1] += shift * terms[2]
            else:
                terms[0] += shift * terms[1]
        return table

    def locate(self, axial: Array, radial: Array) -> Array:
        """Grid coordinates (2, n) of real axial and radial coordinates (n) [mm], by Newton from the mean plane."""
        target = np.stack([axial, radial])
        corners = self._derivatives(np.array([[0.5, 0.5], [0.5, 0.5]]), 1)[..., 0]
        jacobian = np.stack([corners[1, 0, :2], corners[0, 1, :2]], axis=1)
        point = 0.5 + np.linalg.solve(jacobian, target - corners[0, 0, :2, None])
        for _ in range(LOCATING_STEP_LIMIT):
            here = self._derivatives(point, 1)
            step = cramers_rule(here[1, 0, :2], here[0, 1, :2], target - here[0, 0, :2])
            point = point + step / np.maximum(1.0, np.abs(step) / 0.5)
            if np.max(np.abs(np.nan_to_num(step)), initial=0.0) < 1e-12:
                break
        return np.asarray(point)

    def __call__(self, axial: Array, radial: Array) -> tuple[Array, Array]:
        """See ``Interpolant``."""
        shape = np.shape(axial)
        target = np.stack([np.ravel(axial), np.ravel(radial)])
        point = self.locate(*target.real)
        chart = self._derivatives(point, 1)
        along, up = chart[1, 0, :2], chart[0, 1, :2]
        # A last Newton step in the given numbers carries an imaginary part over to the grid coordinates.
        shift = cramers_rule(along, up, target - chart[0, 0, :2])
        grid = np.array([[0.0, 1.0], [0.0, 1.0]])
        value = self._settled(point, 2, self._bounds, TREND_FADING) + self._settled(point, 3, grid, REST_FADING)
        deviation = value[0, 0] + shift[0] * value[1, 0] + shift[1] * value[0, 1]
        slope = np.stack([value[1, 0], value[0, 1]]) + shift[0] * np.stack([value[2, 0], value[1, 1]])
        slope = slope + shift[1] * np.stack([value[1, 1], value[0, 2]])
        if np.iscomplexobj(target):
            bend = self._derivatives(point, 2)[:, :, :2]
            along = along + shift[0] * bend[2, 0] + shift[1] * bend[1, 1]
            up = up + shift[0] * bend[1, 1] + shift[1] * bend[0, 2]
        by_axial, by_radial = determinant(slope, (along[1], up[1])), -determinant(slope, (along[0], up[0]))
        gradient = np.stack([by_axial, by_radial]) / determinant(along, up)
        return deviation.reshape(shape), gradient.reshape(2, *shape)

    def _settled(self, point: Array, component: int, bounds: Array, fading: float) -> Array:
        """A component and its derivatives (3, 3, n) by grid coordinates (2, n), settling beyond bounds (2, 2)."""
        held, first, second = point.copy(), np.ones_like(point), np.zeros_like(point)
        for axis, (lower, upper) in enumerate(bounds):
            for bound, sign in ((lower, -1.0), (upper, 1.0)):
                beyond = np.maximum(sign * (point[axis] - bound), 0.0) / fading
                settled, out = np.tanh(beyond), beyond > 0.0
                held[axis, out] = bound + sign * fading * settled[out]
                first[axis, out] = 1.0 - settled[out] ** 2
                second[axis, out] = -2.0 * sign / fading * settled[out] * first[axis, out]
        table = self._derivatives(held, 2)[:, :, component]
        for axis in (0, 1):
            terms = np.moveaxis(table, axis, 0)
            terms[2] = terms[2] * first[axis] ** 2 + terms[1] * second[axis]
            terms[1] = terms[1] * first[axis]
        return table


def smoothed(value: Array) -> Array:
    """Values at the nodes of a grid (columns, rows), of the surface of third order by rows and columns that fits best.

    Waves and scatter go, what a global error is stays: surfaces of third order are kept exactly.
    """
    along, up = (np.linspace(-1.0, 1.0, n) for n in value.shape)
    largest = [min(SPLINE_DEGREE, n - 1) for n in value.shape]
    orders = [(i, j) for i in range(largest[0] + 1) for j in range(min(SPLINE_DEGREE - i, largest[1]) + 1)]
    terms = np.stack([np.multiply.outer(along**i, up**j).ravel() for i, j in orders], axis=-1)
    found, *_ = np.linalg.lstsq(terms, value.ravel(), rcond=None)
    return np.asarray((terms @ found).reshape(value.shape))
