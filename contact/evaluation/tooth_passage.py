"""Tooth passage: a tooth pair from entering to leaving the mesh, from the cycle in which all pairs were computed.

Pair 0 at mesh position k of a cycle of K positions does what pair -1 did K positions earlier. All pairs are alike, so
that the rows of a table over (pair, mesh position) are pieces of one curve, and any number of cycles follows from it.

So does the unloaded transmission error, of one tooth pair and of the pair that carries, at any pinion rotation.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property

import numpy as np
import xarray as xr
from numpy.lib.stride_tricks import sliding_window_view

from ...core.arrays import Array, Integers, record
from ..lines.flank_splines import MonotoneCubic

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
    table = unloaded["transmission_error"].transpose("pair", "mesh_position").values
    course = tooth_passage(unloaded["pair"].values, table)
    if "fine_envelope" in unloaded:
        return course, *two_cycles(unloaded["fine_envelope"].values)
    times = np.arange(CYCLES * STEP_POINT_COUNT * course.per_cycle + 1) / (STEP_POINT_COUNT * course.per_cycle)
    return course, times, envelope(course, times)


FINE_STEP_COUNT = 32  # between two mesh positions


@record(frozen=True)
class CarryingError:
    """Transmission error of a tooth pair over its passage through the mesh, and the least of all pairs."""

    passage: ToothPassage
    start: float  # pinion rotation of step 0 [rad]
    pinion_pitch: float

    @classmethod
    def of(cls, unloaded: xr.Dataset, pinion_pitch: float) -> CarryingError:
        """From the group ``/unloaded``."""
        table = unloaded["transmission_error"].transpose("pair", "mesh_position").values
        passage = tooth_passage(unloaded["pair"].values, 1e-6 * table)
        return cls(passage, float(unloaded["pinion_rotation"].values[0]), pinion_pitch)

    @property
    def is_known(self) -> bool:
        """True if there are enough values to interpolate."""
        return bool(np.sum(np.isfinite(self.passage.values)) > 1)

    @property
    def steps(self) -> Array:
        """Steps (m) from the first to the last at which the pair can touch, ``FINE_STEP_COUNT`` to a mesh position."""
        known = self.passage.steps[np.isfinite(self.passage.values)]
        return np.arange(known[0] * FINE_STEP_COUNT, known[-1] * FINE_STEP_COUNT + 1) / FINE_STEP_COUNT

    def rotation(self, steps: Array) -> Array:
        """Pinion rotations [rad] of steps."""
        return np.asarray(self.start + steps * self.pinion_pitch / self.passage.per_cycle)

    def of_pair(self, rotation: Array) -> Array:
        """Transmission error [rad] of the pair at pinion rotations (...) [rad]; NaN where it cannot touch."""
        return np.asarray(self._single(self.step(rotation)))

    def least(self, rotation: Array) -> Array:
        """Transmission error [rad] of the pair that carries, at any pinion rotations (...) [rad]."""
        time, values = self._cycle
        return np.asarray(np.interp(self.step(rotation) % self.passage.per_cycle, time, values))

    def greatest_near(self, rotation: Array, reach: float) -> Array:
        """Bound (...) [rad] that ``least`` nowhere exceeds within ``reach`` [rad] of pinion rotations (...) [rad]."""
        values, count = self.over_cycle[:-1], self.passage.per_cycle
        cells = math.ceil(reach / self.pinion_pitch * values.size)
        around = np.pad(values, (cells, cells + 1), mode="wrap")
        greatest = sliding_window_view(around, 2 * cells + 2).max(axis=1)
        place = (self.step(rotation) % count * FINE_STEP_COUNT).astype(int)
        return np.asarray(greatest[np.minimum(place, values.size - 1)])

    @property
    def over_cycle(self) -> Array:
        """Transmission error [rad] of the pair that carries over one mesh cycle, ``FINE_STEP_COUNT`` to a position."""
        return self._cycle[1]

    @property
    def steepest(self) -> float:
        """Greatest size of the slope of ``least`` by the pinion rotation [1]."""
        time, values = self._cycle
        spacing = (time[1] - time[0]) * self.pinion_pitch / self.passage.per_cycle
        return float(np.max(np.abs(np.diff(values))) / spacing)

    def step(self, rotation: Array) -> Array:
        """Steps of pinion rotations [rad]."""
        return np.asarray((rotation - self.start) / self.pinion_pitch * self.passage.per_cycle)

    @cached_property
    def _single(self) -> Callable[[Array], Array]:
        if not self.is_known:
            return lambda steps: np.full(np.shape(steps), np.nan)
        known = np.isfinite(self.passage.values)
        return MonotoneCubic(self.passage.steps[known], self.passage.values[known])

    @cached_property
    def _cycle(self) -> tuple[Array, Array]:
        """Steps of one cycle with both ends, and the least error there."""
        count = self.passage.per_cycle
        time = np.arange(count * FINE_STEP_COUNT + 1) / FINE_STEP_COUNT
        ahead = np.arange(self.passage.steps[0] // count - 1, self.passage.steps[-1] // count + 2) * count
        errors = self._single(time + ahead[:, None])
        least = np.where(np.isfinite(errors), errors, np.inf).min(axis=0)
        return time, np.where(np.isfinite(least), least, np.nan)
