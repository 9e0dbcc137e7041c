"""Tooth passage: a tooth pair from entering to leaving the mesh, from the cycle in which all pairs were computed.

Pair 0 at mesh position k of a cycle of K positions does what pair -1 did K positions earlier. All pairs are alike, so
that the rows of a table over (pair, mesh position) are pieces of one curve, and any number of cycles follows from it.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from ...core.arrays import Array, Integers, record

CYCLES = 2  # of the mesh that curves show
STEP_POINT_COUNT = 8  # points of a curve a mesh position


@record(frozen=True)
class ToothPassage:
    """Values of a tooth pair from entering the mesh to leaving it, by steps of the mesh cycle."""

    first: int  # step n of pair 0 is mesh position n
    per_cycle: int
    values: Array  # at consecutive steps (m, ...), NaN where there are none

    @property
    def steps(self) -> Integers:
        """Steps (m) of the values."""
        return np.arange(self.first, self.first + self.values.shape[0])

    def at(self, steps: Array) -> Array:
        """Values (n, ...) at any steps (n), linear between neighbours, NaN outside and next to missing ones."""
        offset = np.asarray(steps, dtype=float) - self.first
        low = np.floor(offset).astype(int)
        weight = np.reshape(offset - low, (-1, *(1,) * (self.values.ndim - 1)))
        ends = [self._at_index(low + side) for side in (0, 1)]
        return np.where(weight == 0.0, ends[0], (1.0 - weight) * ends[0] + weight * ends[1])

    def _at_index(self, index: Integers) -> Array:
        count = self.values.shape[0]
        inside = np.reshape((index >= 0) & (index < count), (-1, *(1,) * (self.values.ndim - 1)))
        return np.where(inside, self.values[np.clip(index, 0, count - 1)], np.nan)


def tooth_passage(pairs: Array, table: Array) -> ToothPassage:
    """Passage of a tooth pair from a table (p, mesh positions, ...) of all pairs (p) over one cycle."""
    pairs = np.asarray(pairs).astype(int)
    count = table.shape[1]
    values = np.full(((int(np.ptp(pairs)) + 1) * count, *table.shape[2:]), np.nan)
    for pair, row in zip(pairs, table, strict=True):
        start = (int(pairs.max()) - pair) * count
        values[start : start + count] = row
    return ToothPassage(-int(pairs.max()) * count, count, values)


def pairs_in_view(course: ToothPassage, cycles: float) -> range:
    """Numbers of the tooth pairs that are in mesh at some time between zero and ``cycles`` cycles."""
    finite = np.flatnonzero(np.any(np.isfinite(np.reshape(course.values, (course.values.shape[0], -1))), axis=1))
    if finite.size == 0:
        return range(0)
    first, last = course.steps[finite[[0, -1]]] / course.per_cycle
    return range(int(np.ceil(-last)), int(np.floor(cycles - first)) + 1)


def envelope(course: ToothPassage, cycles: Array) -> Array:
    """Smallest value (n) of all tooth pairs at times (n) in cycles; NaN where there is none."""
    cycles = np.asarray(cycles, dtype=float)
    steps = np.round(cycles * course.per_cycle, 9)  # without rounding a time on a step might miss it
    values = [course.at(steps - pair * course.per_cycle) for pair in pairs_in_view(course, float(np.max(cycles)))]
    return np.asarray(np.fmin.reduce([np.full(cycles.size, np.nan), *values]))


def two_cycles(values: Array, cycles: int = CYCLES) -> tuple[Array, Array]:
    """Times in cycles, and the values (n) of a cycle repeated, with the first one at the end."""
    count = values.size
    return np.arange(cycles * count + 1) / count, np.append(np.tile(values, cycles), values[:1])


def unloaded_curves(unloaded: xr.Dataset) -> tuple[ToothPassage, Array, Array]:
    """Passage of a tooth pair [urad], and times in cycles with the envelope over all pairs [urad].

    An older result has no envelope between the mesh positions: there it is that of the curves drawn.
    """
    course = tooth_passage(
        unloaded["pair"].values, unloaded["transmission_error"].transpose("pair", "mesh_position").values
    )
    if "fine_envelope" in unloaded:
        return course, *two_cycles(unloaded["fine_envelope"].values)
    times = np.arange(CYCLES * STEP_POINT_COUNT * course.per_cycle + 1) / (STEP_POINT_COUNT * course.per_cycle)
    return course, times, envelope(course, times)
