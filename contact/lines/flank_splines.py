"""Tensor splines of several fields on the gear flank, through the nodes of a grid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field

import numpy as np

from ...core.arrays import Array, Bools, record
from ...core.errors import InputError
from .tensor_spline import TensorSpline

SPLINE_DEGREE = 5
Orders = Sequence[tuple[int, int]]  # of derivatives by the two fractions
SLOPES = [(1, 0), (0, 1)]  # orders of derivatives, for ``FlankSplines.derivatives``
VALUE_AND_SLOPES = [(0, 0), *SLOPES]
BENDS = [(2, 0), (1, 1), (0, 2)]


@record(frozen=True)
class FlankSplines:
    """Splines of named fields on the unit square (lengthwise, profile)."""

    spline: TensorSpline
    columns: Mapping[str, tuple[slice, tuple[int, ...]]]  # place among the components, and shape of the field
    holes: Array
    lengthwise: Array
    profile: Array
    _parts: dict[tuple[str, ...], TensorSpline] = field(default_factory=dict, init=False, repr=False, compare=False)

    def __call__(self, name: str, points: Array, derivative: tuple[int, int] = (0, 0)) -> Array:
        """Values (*field shape, ...) of one field, or of a derivative by the two fractions, at points (2, ...)."""
        return self.evaluate([name], points, derivative)[name]

    def evaluate(self, names: list[str], points: Array, derivative: tuple[int, int] = (0, 0)) -> dict[str, Array]:
        """Evaluate several fields at once; see ``__call__``."""
        return self.derivatives(names, points, [derivative])[0]

    def derivatives(self, names: Sequence[str], points: Array, orders: Orders) -> list[dict[str, Array]]:
        """Values (*field shape, ...) by name of several fields, for several derivatives by both fractions."""
        shape = np.shape(points)[1:]
        derivatives = self._part(tuple(names)).evaluate(np.reshape(points, (2, -1)), orders)
        return self._by_name(names, [values.reshape(len(values), *shape) for values in derivatives])

    def on_grid(self, names: Sequence[str], lengthwise: Array, profile: Array) -> dict[str, Array]:
        """Values (*field shape, p, q) of fields on the grid from fractions (p) and (q), quicker than by point."""
        return self._by_name(names, [self._part(tuple(names)).on_grid(lengthwise, profile)])[0]

    def _by_name(self, names: Sequence[str], found: Sequence[Array]) -> list[dict[str, Array]]:
        """Values (components, ...) of several derivatives, by the names of the fields."""
        results: list[dict[str, Array]] = [{} for _ in found]
        start = 0
        for name in names:
            components, of_field = self.columns[name]
            rows = slice(start, start := start + components.stop - components.start)
            for result, values in zip(results, found, strict=True):
                result[name] = values[rows].reshape(*of_field, *values.shape[1:])
        return results

    def _part(self, names: tuple[str, ...]) -> TensorSpline:
        """Spline of some of the fields alone, made once."""
        if names not in self._parts:
            components = [np.arange(one.start, one.stop) for one in (self.columns[name][0] for name in names)]
            self._parts[names] = self.spline.part(np.concatenate(components))
        return self._parts[names]

    def in_hole(self, points: Array) -> Bools:
        """True where points (2, ...) lie in a cell with a node that has no value."""
        if not self.holes.any():
            return np.zeros(np.shape(points)[1:], dtype=bool)
        i = np.clip(np.searchsorted(self.lengthwise, points[0], side="right") - 1, 0, self.lengthwise.size - 2)
        j = np.clip(np.searchsorted(self.profile, points[1], side="right") - 1, 0, self.profile.size - 2)
        return np.asarray(self.holes[i, j], dtype=bool)


def fit(lengthwise: Array, profile: Array, fields: Mapping[str, Array]) -> FlankSplines:
    """Splines of degree five (less on small grids) through fields (nt, nh, ...) by name, on a grid that increases.

    Nodes with NaN in any field are holes: bridged, and every cell that touches one is marked. An ``InputError`` refuses
    fewer than four nodes in a direction, or fewer than half of all valid.
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
        from scipy.interpolate import RBFInterpolator

        grid = np.stack(np.meshgrid(lengthwise, profile, indexing="ij"), axis=-1)
        bridge = RBFInterpolator(grid[~missing], stacked[~missing], neighbors=40, degree=2)
        stacked[missing] = bridge(grid[missing])
    degrees = [min(SPLINE_DEGREE, n - 1) for n in shape]
    spline = TensorSpline.through((lengthwise, profile), stacked, (degrees[0], degrees[1]))
    columns, start = {}, 0
    for name, value in fields.items():
        shape_of_field = np.shape(value)[2:]
        columns[name] = (slice(start, start := start + int(np.prod(shape_of_field, dtype=int))), shape_of_field)
    holes = missing[:-1, :-1] | missing[1:, :-1] | missing[:-1, 1:] | missing[1:, 1:]
    return FlankSplines(spline, columns, holes, np.asarray(lengthwise), np.asarray(profile))
