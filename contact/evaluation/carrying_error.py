"""Unloaded transmission error of one tooth pair, and of the pair that carries, at any pinion rotation."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property

import numpy as np
import xarray as xr
from numpy.lib.stride_tricks import sliding_window_view

from ...core.arrays import Array, record
from ..lines.monotone_cubic import MonotoneCubic
from .tooth_passage import ToothPassage, tooth_passage

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
        single = MonotoneCubic(self.passage.steps[known], self.passage.values[known])
        return single

    @cached_property
    def _cycle(self) -> tuple[Array, Array]:
        """Steps of one cycle with both ends, and the least error there."""
        count = self.passage.per_cycle
        time = np.arange(count * FINE_STEP_COUNT + 1) / FINE_STEP_COUNT
        ahead = np.arange(self.passage.steps[0] // count - 1, self.passage.steps[-1] // count + 2) * count
        errors = self._single(time + ahead[:, None])
        least = np.where(np.isfinite(errors), errors, np.inf).min(axis=0)
        return time, np.where(np.isfinite(least), least, np.nan)
