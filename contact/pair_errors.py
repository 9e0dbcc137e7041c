"""Unloaded transmission error of every tooth pair, and of the pair that carries at any rotation of a mesh cycle."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..core.arrays import Array, Integers
from .lines.mesh_lines import MeshLines
from .lines.touching_points import TouchingPoints, least, refined, touching_points
from .lines.turned_flanks import TurnedFlanks

ENVELOPE_REFINEMENT = 16  # rotations between two mesh positions at which the envelope is taken
NEIGHBOUR_DISTANCE_LIMIT = 0.2  # fraction of the flank; points farther apart do not belong to one course of the contact


@dataclass(frozen=True)
class PairErrors:
    """Gap of each tooth pair by itself, also of one before the first and one after the last, which may touch edges."""

    flanks: TurnedFlanks
    mesh: MeshLines
    pairs: Integers  # (p)
    touching: TouchingPoints  # (p * k), pair by pair

    @classmethod
    def of(cls, flanks: TurnedFlanks, mesh: MeshLines) -> PairErrors:
        """Search all tooth pairs at all rotations of a mesh cycle."""
        pairs = np.arange(mesh.pair.min() - 1, mesh.pair.max() + 2)
        turned = mesh.rotations[None, :] - pairs[:, None] * mesh.pinion_pitch
        return cls(flanks, mesh, pairs, touching_points(flanks, turned.ravel()))

    def table(self, values: Array) -> Array:
        """Values (..., p * k) as (p, k, ...)."""
        shape = (self.pairs.size, self.mesh.rotations.size)
        return np.asarray(np.moveaxis(values.reshape(*values.shape[:-1], *shape), (-2, -1), (0, 1)))

    @property
    def error(self) -> Array:
        """Gap of every tooth pair at every rotation (p, k), as a gear rotation [rad]; NaN where it has none."""
        return self.table(self.touching.gap)

    def fine_envelope(self) -> Array:
        """Smallest gap over all tooth pairs, at ENVELOPE_REFINEMENT times as many rotations [rad]."""
        count = self.mesh.rotations.size * ENVELOPE_REFINEMENT
        return self.envelope_at(np.arange(count) / count)

    def envelope_at(self, ahead: Array) -> Array:
        """Smallest gap over all pairs (m) [rad], at rotations (m) beyond the first, as fractions of a pitch.

        Contact is found anew wherever a pair may carry: kinks, at edges and transfers, lie between the mesh positions.
        """
        return self.carrying_at(ahead)[1].gap

    def carrying_at(self, ahead: Array) -> tuple[Integers, TouchingPoints]:
        """Number of the pair that carries (m) and its point of contact, at rotations as of ``envelope_at``."""
        course = self._course[0]
        before, share = self._between_positions(ahead[None, :], np.arange(self.pairs.size)[:, None])
        estimate, doubt = _between(course.gap, before, share)
        highest = np.min(np.where(np.isfinite(estimate), estimate + doubt, np.inf), axis=0)
        pair, place = np.nonzero(estimate - doubt <= highest)
        points = self.touching_at(pair, ahead[place])
        fine = np.where(np.isfinite(estimate), estimate, np.inf)
        fine[pair, place] = np.where(np.isfinite(points.gap), points.gap, fine[pair, place])
        number = np.full(fine.shape, -1)
        number[pair, place] = np.arange(pair.size)
        carrying, places = np.argmin(fine, axis=0), np.arange(ahead.size)
        index = number[carrying, places]
        touching = points.at(index) if pair.size else course.at(np.zeros(ahead.size, dtype=np.int64))
        touching.gap[:] = np.where(np.isfinite(fine[carrying, places]), fine[carrying, places], np.nan)
        lost = (index < 0) | ~np.isfinite(points.gap[index]) if pair.size else np.ones(ahead.size, dtype=bool)
        touching.points[:, lost] = np.nan
        return carrying, touching

    def touching_at(self, pair: Integers, ahead: Array) -> TouchingPoints:
        """Points of contact of given pairs (n), by their numbers, each at a rotation (n) as of ``envelope_at``."""
        before, share = self._between_positions(ahead, pair)
        return self._found(self._course[0], before, share, self.rotations_at(ahead, pair))

    def rotations_at(self, ahead: Array, pair: Integers) -> Array:
        """Pinion rotations [rad], counted as the roll angle of each pair, at rotations as of ``envelope_at``."""
        return np.asarray(self.mesh.rotations[0] + (ahead - self.pairs[pair]) * self.mesh.pinion_pitch)

    def _between_positions(self, ahead: Array, pair: Integers) -> tuple[Integers, Array]:
        """Elements of the course before places of pairs, and how far on towards the next."""
        turned, wanted = self._course[1], self.rotations_at(ahead, pair)
        before = np.clip(np.searchsorted(turned, wanted, side="right") - 1, 0, turned.size - 2)
        return before, np.clip((wanted - turned[before]) / (turned[before + 1] - turned[before]), 0.0, 1.0)

    @cached_property
    def _course(self) -> tuple[TouchingPoints, Array]:
        """Points of contact of all pairs in the order of their rotations, as of one pair, and these rotations."""
        turned = (self.mesh.rotations[None, :] - self.pairs[:, None] * self.mesh.pinion_pitch).ravel()
        order = np.argsort(turned)
        return self.touching.at(order), turned[order]

    def _found(self, course: TouchingPoints, before: Integers, share: Array, wanted: Array) -> TouchingPoints:
        """Points of contact (n) at rotations (n) from those of a course (m) between which they lie."""
        first, second = course.at(before), course.at(before + 1)
        near = np.max(np.abs(first.points - second.points), axis=0) < NEIGHBOUR_DISTANCE_LIMIT
        near &= first.part == second.part
        # One start between both neighbours, or one at each of them.
        shares = np.stack([np.where(near, share, 0.0), np.ones_like(share)])
        row = np.tile(np.arange(share.size), 2)
        kept = np.flatnonzero(np.concatenate([near | np.isfinite(first.gap), ~near & np.isfinite(second.gap)]))
        weight, row = shares.ravel()[kept], row[kept]

        def between(one: Array, other: Array) -> Array:
            mixed = one[:, row] * (1.0 - weight) + other[:, row] * weight
            return np.where(weight == 0.0, one[:, row], np.where(weight == 1.0, other[:, row], mixed))

        points = between(first.points, second.points)
        parameters = between(first.parameters, second.parameters)
        part = np.where(weight == 1.0, second.part[row], first.part[row])
        return least(refined(self.flanks, points, wanted[row], parameters, part), row, share.size)


def smallest(values: Array) -> Array:
    """Smallest value along the first axis, NaN where there is none."""
    minimum = np.where(np.isfinite(values), values, np.inf).min(axis=0)
    return np.where(np.isfinite(minimum), minimum, np.nan)


def _between(values: Array, before: Integers, share: Array) -> tuple[Array, Array]:
    """Values between those of a course (m), and by how much they may be wrong, at places after its elements (...)."""
    first, second = values[before], values[before + 1]
    middle = np.where(np.isfinite(first), first, second) * (1.0 - share)
    middle = middle + np.where(np.isfinite(second), second, first) * share
    steps = np.diff(values, prepend=np.nan, append=np.nan)
    bends = np.nan_to_num(np.abs(np.diff(steps)))
    either = np.maximum(bends[before], bends[before + 1])
    alone = np.isfinite(first) != np.isfinite(second)
    beside = np.fmax(np.abs(steps[before]), np.abs(steps[np.minimum(before + 2, steps.size - 1)]))
    return middle, np.where(alone, 2.0 * np.nan_to_num(beside), 0.5 * either)
