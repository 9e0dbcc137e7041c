"""Points of a sweep as a table of rows, in the order in which the least is computed anew from one to the next."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .axis import Axis
from .swept_quantity import Stage, swept_quantity

Array = NDArray[Any]


@dataclass(frozen=True)
class PointTable:
    """Rows of a sweep: every combination of the points along its axes.

    Parameters
    ----------
    axes
        Axes whose points are analysed apart; those over which one analysis goes are not among them.

    Examples
    --------
    >>> from easeoff.study.sweep.axis import grid_axis
    >>> table = PointTable((grid_axis("P", "0,0.1"), grid_axis("E", "0,0.1,0.2")))
    >>> table.shape, table.count, table.values(4)
    ((2, 3), 6, {'P': 0.1, 'E': 0.1})
    """

    axes: tuple[Axis, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """Numbers of points along the axes."""
        return tuple(axis.size for axis in self.axes)

    @property
    def count(self) -> int:
        """Number of rows."""
        return int(np.prod(self.shape, dtype=np.int64))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the coordinates of a row."""
        return tuple(name for axis in self.axes for name in axis.columns)

    def columns(self, rows: Array) -> dict[str, Array]:
        """Values of every coordinate in some rows."""
        places = np.unravel_index(rows, self.shape) if self.axes else ()
        return {
            name: values[place]
            for axis, place in zip(self.axes, places, strict=True)
            for name, values in axis.columns.items()
        }

    def values(self, row: int) -> dict[str, Any]:
        """Values of every coordinate in one row."""
        return {name: found[0].item() for name, found in self.columns(np.array([row])).items()}

    @cached_property
    def order(self) -> Array:
        """Rows in the order of the work: those of one pair together, within them those of one assembly."""
        codes = self._codes
        return np.lexsort([codes[name] for name in reversed(self._by_stage)]) if codes else np.arange(self.count)

    @cached_property
    def starts(self) -> Array:
        """Places in the order of the work at which another assembly begins."""
        changed = np.zeros(self.count, dtype=bool)
        changed[0] = True
        for name in self._by_stage:
            if swept_quantity(name).stage <= Stage.ASSEMBLY:
                sorted_codes = self._codes[name][self.order]
                changed[1:] |= sorted_codes[1:] != sorted_codes[:-1]
        return np.flatnonzero(changed)

    def bound(self, first: int, size: int) -> int:
        """Where a batch of about ``size`` rows ends that begins at a place: between assemblies where possible."""
        wanted = first + max(size, 1)
        if wanted >= self.count:
            return self.count
        whole = int(self.starts[np.searchsorted(self.starts, wanted, side="right") - 1])
        return whole if whole > first else wanted

    @property
    def _by_stage(self) -> Sequence[str]:
        return sorted(self.names, key=lambda name: swept_quantity(name).stage)

    @cached_property
    def _codes(self) -> dict[str, Array]:
        """The value of every coordinate in every row as its number among those that there are."""
        places = np.unravel_index(np.arange(self.count), self.shape) if self.axes else ()
        return {
            name: np.unique(values, return_inverse=True)[1][place]
            for axis, place in zip(self.axes, places, strict=True)
            for name, values in axis.columns.items()
        }


def assemblies(columns: dict[str, Array], count: int) -> Iterator[list[int]]:
    """Places of neighbouring rows that have the pair and the assembly in common."""
    names = [name for name in columns if swept_quantity(name).stage <= Stage.ASSEMBLY]
    together: list[int] = []
    for place in range(count):
        if together and any(columns[name][place] != columns[name][together[0]] for name in names):
            yield together
            together = []
        together.append(place)
    if together:
        yield together
