"""Tensor splines of several fields on the gear flank, through the nodes of a grid."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import NdBSpline, RBFInterpolator, make_interp_spline

from ...core.errors import InputError

Array = NDArray[Any]
SPLINE_DEGREE = 5


@dataclass(frozen=True)
class FlankSplines:
    """Splines of named fields on the unit square (lengthwise, profile).

    Parameters
    ----------
    spline
        Tensor spline with one trailing component per scalar field.
    columns
        Where each named field stands among the components, and its shape.
    holes
        Cells (nt - 1, nh - 1) with a node that has no value.
    lengthwise, profile
        Grid coordinates (nt), (nh).
    """

    spline: NdBSpline
    columns: Mapping[str, tuple[slice, tuple[int, ...]]]
    holes: Array
    lengthwise: Array
    profile: Array
    _parts: dict[tuple[str, ...], NdBSpline] = field(default_factory=dict, init=False, repr=False, compare=False)

    def __call__(self, name: str, points: Array, derivative: tuple[int, int] = (0, 0)) -> Array:
        """Evaluate one field.

        Parameters
        ----------
        name
            Name of the field.
        points
            Lengthwise and profile fractions (2, ...).
        derivative
            Orders of the derivatives by the two fractions.

        Returns
        -------
        Array
            Values (*field shape, ...).
        """
        return self.evaluate([name], points, derivative)[name]

    def evaluate(self, names: list[str], points: Array, derivative: tuple[int, int] = (0, 0)) -> dict[str, Array]:
        """Evaluate several fields at once, sharing the basis; see ``__call__``."""
        flat = np.reshape(points, (2, -1))
        values = self._part(tuple(names))(flat.T, nu=derivative).T
        result, start = {}, 0
        for name in names:
            shape = self.columns[name][1]
            count = int(np.prod(shape, dtype=int))
            result[name] = values[start : start + count].reshape(*shape, *np.shape(points)[1:])
            start += count
        return result

    def _part(self, names: tuple[str, ...]) -> NdBSpline:
        """Spline of some of the fields alone, made once."""
        if names not in self._parts:
            index = np.concatenate([np.arange(self.columns[n][0].start, self.columns[n][0].stop) for n in names])
            chosen = np.ascontiguousarray(self.spline.c[..., index])
            self._parts[names] = NdBSpline(self.spline.t, chosen, self.spline.k)
        return self._parts[names]

    def in_hole(self, points: Array) -> NDArray[np.bool_]:
        """Whether points (2, ...) lie in a cell with a node that has no value."""
        i = np.clip(np.searchsorted(self.lengthwise, points[0], side="right") - 1, 0, self.lengthwise.size - 2)
        j = np.clip(np.searchsorted(self.profile, points[1], side="right") - 1, 0, self.profile.size - 2)
        return np.asarray(self.holes[i, j], dtype=bool)


def fit(lengthwise: Array, profile: Array, fields: Mapping[str, Array]) -> FlankSplines:
    """Splines through fields given on a grid.

    Parameters
    ----------
    lengthwise, profile
        Grid coordinates (nt) and (nh), increasing.
    fields
        Values (nt, nh, ...) by name. Nodes with NaN in any field are holes: they are bridged so that the spline exists,
        and every cell that touches one is marked, so that nothing is read there unseen.

    Returns
    -------
    FlankSplines
        The fields as splines of degree five (less on small grids).

    Raises
    ------
    InputError
        If the grid has fewer than four nodes in a direction or fewer than half of its nodes are valid.
    """
    shape = (lengthwise.size, profile.size)
    if min(shape) < 4:
        raise InputError(f"grid of {shape[0]} x {shape[1]} nodes: must have at least 4 in each direction")
    stacked = np.concatenate([np.reshape(v, (*shape, -1)) for v in fields.values()], axis=2)
    missing = ~np.all(np.isfinite(stacked), axis=2)
    if missing.mean() > 0.5:
        raise InputError(
            f"{100 * (1 - missing.mean()):.0f} % of the grid's nodes have values, too few: must be at least 50 %"
        )
    if np.any(missing):
        grid = np.stack(np.meshgrid(lengthwise, profile, indexing="ij"), axis=-1)
        bridge = RBFInterpolator(grid[~missing], stacked[~missing], neighbors=40, degree=2)
        stacked[missing] = bridge(grid[missing])
    degrees = [min(SPLINE_DEGREE, n - 1) for n in shape]
    along = make_interp_spline(lengthwise, stacked, k=degrees[0], axis=0)
    across = make_interp_spline(profile, np.moveaxis(along.c, 1, 0), k=degrees[1], axis=0)
    spline = NdBSpline((along.t, across.t), np.ascontiguousarray(np.moveaxis(across.c, 0, 1)), tuple(degrees))
    columns, start = {}, 0
    for name, value in fields.items():
        shape_of_field = np.shape(value)[2:]
        count = int(np.prod(shape_of_field, dtype=int))
        columns[name] = (slice(start, start + count), shape_of_field)
        start += count
    holes = missing[:-1, :-1] | missing[1:, :-1] | missing[:-1, 1:] | missing[1:, 1:]
    return FlankSplines(spline, columns, holes, np.asarray(lengthwise), np.asarray(profile))
