"""Deviation of a made or worn flank from the designed one: a field on the flank of one member.

A deviation is measured along the outward normal of the designed flank and is **positive where there is more metal**.

Between the nodes of a measuring grid it is a spline, a smoothed spline, or a weighted average. All are functions of the
axial and radial coordinate of a flank point that can be differentiated by complex step. No coordinates of the flank
itself are interpolated, its deviations alone.

Of two surfaces it is the distance along given normals, whatever its size. A measuring machine states it as zero at the
reference point in the middle of the flank.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal, Protocol, get_args

import numpy as np
import xarray as xr

from ...core.arrays import Array, Bools, Integers, record
from ...core.attributes import labelled
from ...core.checks import array, instance, one_of, two_whole
from ...core.errors import InputError
from ..cutting.generating_surface import GeneratingSurface, SurfacePoints
from ..flanks.blank_section import BlankSection
from ..flanks.flank import solve_flank
from ..newton import complex_steps, cramers_rule, determinant, solve_by
from ..vectors import cross, dot

if TYPE_CHECKING:
    from scipy.interpolate import NdBSpline

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


@dataclass(frozen=True, eq=False)
class WeightedAverage:
    """Average of all nodes by the inverse of their squared distance in the axial plane (Kolivand 2009, 4.5.2).

    The weights are Shepard's (1968, doi:10.1145/800186.810616), not printed there: exact at the nodes, where the slope
    is zero; drawn to the mean between them.
    """

    axial: Array
    radial: Array
    value: Array  # (k) [mm] at nodes (k)

    def __call__(self, axial: Array, radial: Array) -> tuple[Array, Array]:
        """See ``Interpolant``."""
        shift = np.stack([axial[..., None] - self.axial, radial[..., None] - self.radial])
        weight = 1.0 / (shift[0] ** 2 + shift[1] ** 2 + SQUARED_DISTANCE_OFFSET)
        total = weight.sum(axis=-1)
        value = (weight * self.value).sum(axis=-1) / total
        by_point = -2.0 * shift * weight**2
        return value, (by_point * (self.value - value[..., None])).sum(axis=-1) / total


@record(frozen=True, eq=False)
class GridSpline:
    """Bicubic spline through the nodes, in the grid's own coordinates from 0 to 1 over columns (u) and rows (v).

    Exact for polynomials of third order (second, where a direction has three nodes). Beyond the grid it goes over to
    the best fit of second order in the axial plane, so that the scatter of the outermost nodes is not magnified.
    """

    axial: Array
    radial: Array
    value: Array  # (columns, rows) [mm]
    edge: Array  # axial and radial coordinates of the flank's corners (2, k) [mm]

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
            table = self._derivatives(point, 1)
            step = cramers_rule(table[1, 0, :2], table[0, 1, :2], target - table[0, 0, :2])
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
        place, first, second = point.copy(), np.ones_like(point), np.zeros_like(point)
        for axis, (lower, upper) in enumerate(bounds):
            for bound, sign in ((lower, -1.0), (upper, 1.0)):
                beyond = np.maximum(sign * (point[axis] - bound), 0.0) / fading
                settled, out = np.tanh(beyond), beyond > 0.0
                place[axis, out] = bound + sign * fading * settled[out]
                first[axis, out] = 1.0 - settled[out] ** 2
                second[axis, out] = -2.0 * sign / fading * settled[out] * first[axis, out]
        table = self._derivatives(place, 2)[:, :, component]
        for axis in (0, 1):
            terms = np.moveaxis(table, axis, 0)
            terms[2] = terms[2] * first[axis] ** 2 + terms[1] * second[axis]
            terms[1] = terms[1] * first[axis]
        return table


def smoothed(value: Array) -> Array:
    """Best surface of third order by rows and columns through the nodes of a grid (columns, rows): without waves."""
    along, up = (np.linspace(-1.0, 1.0, n) for n in value.shape)
    largest = [min(SPLINE_DEGREE, n - 1) for n in value.shape]
    orders = [(i, j) for i in range(largest[0] + 1) for j in range(min(SPLINE_DEGREE - i, largest[1]) + 1)]
    terms = np.stack([np.multiply.outer(along**i, up**j).ravel() for i, j in orders], axis=-1)
    coefficients, *_ = np.linalg.lstsq(terms, value.ravel(), rcond=None)
    return np.asarray((terms @ coefficients).reshape(value.shape))


Method = Literal["spline", "smooth", "weighted_average"]
DEVIATION_LIMIT = 2.0  # [mm]; what departs further is another flank
FORMULA_NODES = (49, 25)  # nodes at which a formula is taken, lengthwise and up the profile
FRACTION_TOLERANCE = 1e-9


def require_method(name: str) -> None:
    """Refuse an unknown method of interpolation."""
    one_of("interpolation", name, get_args(Method))


@record(frozen=True, eq=False)
class Deviation:
    """Deviation of one flank, given at the nodes of a grid.

    Parameters
    ----------
    section
        Blank of the member whose flank it is.
    axial, radial
        Where the nodes are about the member's axis (columns, rows) [mm], columns from toe to heel, rows from root to
        tip.
    value
        Deviations along the outward normal at the nodes (columns, rows) [mm], positive where there is more metal.
    method
        Between the nodes: ``spline`` through all of them; ``smooth``, the surface of third order that fits them best;
        or, as in the dissertation, ``weighted_average``.

    Raises
    ------
    InputError
        If the shapes differ, a value is not finite or larger than 2 mm, or the method is unknown.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("fm-11x41"))
    >>> section = pair.gear.section
    >>> axial, radial = section.points(*np.meshgrid([0.1, 0.5, 0.9], [0.2, 0.8], indexing="ij"))
    >>> measured = Deviation(section, axial, radial, np.array([[0.004, 0.002], [0.0, 0.0], [0.002, 0.004]]))
    >>> round(1e3 * float(measured.at(np.array([0.1]), np.array([0.2]))[0]), 6)  # [um]
    4.0
    """

    section: BlankSection
    axial: Array
    radial: Array
    value: Array
    method: Method = "spline"

    def __post_init__(self) -> None:
        require_method(self.method)
        instance("section", self.section, BlankSection)
        for name in ("axial", "radial", "value"):
            object.__setattr__(self, name, array(name, getattr(self, name), "mm", anything=True))
        shapes = {name: np.shape(getattr(self, name)) for name in ("axial", "radial", "value")}
        if len(set(shapes.values())) != 1 or np.ndim(self.value) != 2 or min(np.shape(self.value)) < 2:
            given = ", ".join(f"{name} {shape}" for name, shape in shapes.items())
            raise InputError(f"shapes = {given}: must be one shape (columns, rows), at least 2 each")
        for name in shapes:
            bad = np.argwhere(~np.isfinite(getattr(self, name)))
            if bad.size:
                column, row = bad[0] + 1
                raise InputError(
                    f"{name}: {len(bad)} of {np.size(self.value)} values are not finite, the first in row {row}, "
                    f"column {column}; measure these points again, or leave their rows or columns out"
                )
        largest = float(np.max(np.abs(self.value)))
        if largest > DEVIATION_LIMIT:
            raise InputError(
                f"largest deviation = {largest:g} mm: must be at most {DEVIATION_LIMIT:g} mm. Are the values in um?"
            )

    @cached_property
    def interpolant(self) -> Interpolant:
        """The deviation as a function of axial and radial coordinate [mm], see ``Interpolant``."""
        if self.method == "weighted_average":
            return WeightedAverage(self.axial.ravel(), self.radial.ravel(), self.value.ravel())
        return self._spline

    @property
    def scatter(self) -> float:
        """Root mean square distance of the nodes from the smooth surface [mm]: noise, waves and local wear."""
        return float(np.sqrt(np.mean((self.value - smoothed(self.value)) ** 2)))

    @cached_property
    def _spline(self) -> GridSpline:
        value = smoothed(self.value) if self.method == "smooth" else self.value
        return GridSpline(self.axial, self.radial, value, self.section.corners.reshape(4, 2).T)

    def at(self, lengthwise: Array, profile: Array) -> Array:
        """Deviation (...) [mm] at fractions (...) of the flank."""
        return self.interpolant(*self.section.points(lengthwise, profile))[0]

    def extrapolated(self, lengthwise: Array, profile: Array) -> Bools:
        """True where fractions (...) of the flank lie beyond the outermost nodes (...)."""
        shape = np.broadcast_shapes(np.shape(lengthwise), np.shape(profile))
        point = self._spline.locate(*self.section.points(lengthwise, profile).reshape(2, -1))
        beyond = (point < -FRACTION_TOLERANCE) | (point > 1.0 + FRACTION_TOLERANCE)
        return np.asarray(np.any(beyond, axis=0)).reshape(shape)

    def on_grid(self, lengthwise: Array, profile: Array) -> xr.Dataset:
        """The deviation on a grid of the flank.

        Parameters
        ----------
        lengthwise, profile
            Fractions (nt), (nh) of the flank, from 0 to 1.

        Returns
        -------
        xr.Dataset
            ``deviation`` [um] and ``extrapolated`` (1 beyond the outermost nodes) over (lengthwise, profile).

        Raises
        ------
        InputError
            If a fraction lies beyond the flank: nothing is known of it there.
        """
        for name, values in (("lengthwise", lengthwise), ("profile", profile)):
            if np.min(values) < -FRACTION_TOLERANCE or np.max(values) > 1.0 + FRACTION_TOLERANCE:
                raise InputError(
                    f"{name} = {np.min(values):g} to {np.max(values):g}: must be fractions of the flank, from 0 to 1"
                )
        t, h = np.meshgrid(lengthwise, profile, indexing="ij")
        grid, beyond = ("lengthwise", "profile"), self.extrapolated(t, h).astype(np.int8)
        fields = {"deviation": (grid, 1e3 * self.at(t, h)), "extrapolated": (grid, beyond)}
        return labelled(xr.Dataset(fields, coords={"lengthwise": lengthwise, "profile": profile}))


def deviation_from_formula(
    section: BlankSection, formula: Callable[[Array, Array], Array], nodes: tuple[int, int] = FORMULA_NODES
) -> Deviation:
    """A deviation given by a formula, such as ``GlobalErrors``.

    Parameters
    ----------
    section
        Blank of the member.
    formula
        Deviation (...) [um] of fractions (...) lengthwise and up the profile, positive where there is more metal.
    nodes
        Number of nodes lengthwise and up the profile, evenly spread; a polynomial up to the third order is kept
        exactly.

    Raises
    ------
    InputError
        As ``Deviation``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("fm-11x41"))
    >>> from easeoff.geometry import GlobalErrors
    >>> deviation = deviation_from_formula(pair.gear.section, GlobalErrors(spiral_angle=5.0))
    >>> round(1e3 * float(deviation.at(np.array([1.0]), np.array([0.5]))[0]), 6)  # at the heel [um]
    5.0
    """
    instance("section", section, BlankSection)
    instance("formula", formula, Callable)
    t, h = np.meshgrid(*(np.linspace(0.0, 1.0, count) for count in two_whole("nodes", nodes, 2)), indexing="ij")
    axial, radial = section.points(t, h)
    value = 1e-3 * (np.zeros(t.shape) + array("formula", formula(t, h), "um", anything=True))
    return Deviation(section, axial, radial, value)


def deviation_from_dataset(section: BlankSection, dataset: xr.Dataset, method: Method = "spline") -> Deviation:
    """A deviation from a dataset such as ``Deviation.on_grid`` gives [um], over fractions that increase."""
    grid = ("lengthwise", "profile")
    if "deviation" not in dataset or set(dataset["deviation"].dims) != set(grid):
        raise InputError(f"dataset: must have a variable 'deviation' over ({', '.join(grid)})")
    unit = dataset["deviation"].attrs.get("units", "um")
    if unit != "um":
        raise InputError(f"units of 'deviation' = {unit!r}: must be um")
    for name in grid:
        values = dataset[name].values if name in dataset.coords else np.zeros(0)
        within = np.all(np.abs(values - 0.5) <= 0.5 + FRACTION_TOLERANCE)
        if values.size < 2 or np.any(np.diff(values) <= 0.0) or not within:
            raise InputError(f"coordinate {name!r} of the dataset: must increase, within 0 and 1")
    t, h = np.meshgrid(dataset["lengthwise"].values, dataset["profile"].values, indexing="ij")
    axial, radial = section.points(t, h)
    return Deviation(section, axial, radial, 1e-3 * dataset["deviation"].transpose(*grid).values, method)


def normal_distance(
    surface: GeneratingSurface, position: Array, normal: Array, start: Array
) -> tuple[Array, SurfacePoints]:
    """Distance (n) [mm] along unit normals (3, n) from points to a surface, and its points, by Newton's method.

    Positive along the normal; NaN where no crossing has the outward side ahead. ``start`` (2, n): parameters near it.
    """
    first = cross(np.eye(3)[:, np.argmin(np.abs(normal), axis=0)], normal)
    first = first / np.sqrt(dot(first, first))
    across = first, cross(normal, first)

    def derivatives(places: Array, active: Integers) -> tuple[Array, Array]:
        directions = [direction[:, active] for direction in across]
        point, slopes = complex_steps(lambda p: surface.evaluate(p)[0], places)
        return (
            np.stack([dot(direction, point) for direction in directions]),
            np.stack([np.stack([dot(direction, slope) for direction in directions]) for slope in slopes]),
        )

    target = np.stack([dot(direction, position) for direction in across])
    solution = solve_by(derivatives, start, target, surface.max_step)
    with np.errstate(all="ignore"):
        points = SurfacePoints.of(surface, solution.parameters)
    usable = solution.converged & (dot(points.normal, normal) > 0.0)
    return np.where(usable, dot(points.position - position, normal), np.nan), points


def zeroed(deviation: Deviation, surface: GeneratingSurface) -> Deviation:
    """The deviation with the tooth turned about its axis so that the middle of the flank has none, as measured.

    A constant would not do: the lever arm, and with it the effect of a rotation, changes along the flank.
    """
    section, shape = deviation.section, deviation.value.shape
    middle = section.points(np.array([0.5]), np.array([0.5]))
    nodes = np.stack([deviation.axial.ravel(), deviation.radial.ravel()])
    flank = solve_flank(surface.designed, section, *np.concatenate([nodes, middle], axis=1))
    lever = flank.position[0] * flank.normal[1] - flank.position[1] * flank.normal[0]
    turn = float(deviation.at(np.array([0.5]), np.array([0.5]))[0]) / lever[-1]
    return replace(deviation, value=deviation.value - turn * lever[:-1].reshape(shape))
