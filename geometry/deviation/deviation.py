"""Deviation of a made or worn flank from the designed one: a field on the flank of one member.

A deviation is measured along the outward normal of the designed flank and is **positive where there is more metal**.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, get_args

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.attributes import labelled
from ...core.checks import array, frozen_arrays, instance, one_of, two_whole
from ...core.errors import InputError
from ..flanks.blank_section import BlankSection
from .interpolation import GridSpline, Interpolant, WeightedAverage, smoothed

Array = NDArray[Any]
Method = Literal["spline", "smooth", "weighted_average"]
DEVIATION_LIMIT = 2.0  # [mm]; what departs further is another flank
FORMULA_NODES = (49, 25)  # nodes at which a formula is taken, lengthwise and up the profile
FRACTION_TOLERANCE = 1e-9


def require_method(name: str) -> None:
    """Refuse an unknown method of interpolation.

    Raises
    ------
    InputError
        If the name is unknown; the message lists the methods.
    """
    one_of("interpolation", name, get_args(Method))


@frozen_arrays
@dataclass(frozen=True, eq=False)
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

    def extrapolated(self, lengthwise: Array, profile: Array) -> NDArray[np.bool_]:
        """Whether fractions (...) of the flank lie beyond the outermost nodes (...)."""
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
        grid = ("lengthwise", "profile")
        return labelled(
            xr.Dataset(
                {
                    "deviation": (grid, 1e3 * self.at(t, h)),
                    "extrapolated": (grid, self.extrapolated(t, h).astype(np.int8)),
                },
                coords={"lengthwise": lengthwise, "profile": profile},
            )
        )


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
    return Deviation(
        section, axial, radial, 1e-3 * (np.zeros(t.shape) + array("formula", formula(t, h), "um", anything=True))
    )


def deviation_from_dataset(section: BlankSection, dataset: xr.Dataset, method: Method = "spline") -> Deviation:
    """A deviation from a dataset such as ``Deviation.on_grid`` gives.

    Parameters
    ----------
    section
        Blank of the member.
    dataset
        ``deviation`` [um] over (lengthwise, profile), both increasing fractions within 0 to 1.
    method
        As in ``Deviation``.

    Raises
    ------
    InputError
        If the variable or a coordinate is missing or of another kind; and as ``Deviation``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("fm-11x41"))
    >>> from easeoff.geometry import GlobalErrors
    >>> deviation = deviation_from_formula(pair.gear.section, GlobalErrors(twist=3.0))
    >>> stored = deviation.on_grid(np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 5))
    >>> again = deviation_from_dataset(pair.gear.section, stored)
    >>> again.value.shape
    (5, 5)
    """
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
