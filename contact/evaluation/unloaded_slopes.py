"""Derivatives of the unloaded transmission error: those of the gap where the flanks touch.

By the envelope theorem the smallest gap changes as the gap at a fixed point of the gear does, less what the bound on
which the point lies moves: times the gap's slope across the bound, over that of the distance from it. Edges of the gear
stand still on its flank; those of the pinion move over it with the settings.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...core.arrays import Array, Bools
from ...geometry.flanks.flank import on_parts, pick
from ...geometry.newton import cramers_rule
from ...geometry.pair.field_slopes import gear_gap_slopes, held_point_slopes, pinion_gap_slopes
from ...geometry.pair.gear_pair import PairGeometry
from ...geometry.pair.near_pair import PairSetting
from ..lines.flank_splines import FlankSplines, fit
from ..lines.mesh_lines import MeshLines
from ..lines.touching_points import TouchingPoints
from ..lines.turned_flanks import BOUNDS, TurnedFlanks, circles_met
from ..loaded import extremes
from ..unloaded import ENVELOPE_REFINEMENT, NEIGHBOUR_DISTANCE_LIMIT, PEAK_TOLERANCE, PairErrors

ON_BOUND = 1e-6  # fraction of the flank within which a point lies on a bound
LEVEL_SLOPE = 1e-9  # [rad per fraction of the flank]; a gap that falls by less towards a bound is not held by it
PINION_BOUNDS = BOUNDS.index("pinion_toe"), BOUNDS.index("pinion_tip") + 1
PEAK_STEP = 1e-4  # of a pitch, in differences of the courses of tooth pairs about a peak
PEAK_ROUNDS = 4  # of Newton's method to where courses cross or are level


@dataclass(frozen=True)
class UnloadedSlopes:
    """Unloaded transmission error of the pair that carries, and its derivatives by settings (j)."""

    error: Array  # (n) [rad], ENVELOPE_REFINEMENT times the mesh positions
    slopes: Array
    peak_to_peak: float
    peak_slopes: Array


def unloaded_slopes(
    geometry: PairGeometry, mesh: MeshLines, settings: Sequence[PairSetting], slopes: Mapping[str, Array]
) -> UnloadedSlopes:
    """Unloaded transmission error of the pair that carries, and its derivatives by settings (j).

    NaN where the end of a blade touches, or another part of a flank begins, which move with the settings.
    """
    errors = PairErrors.of(TurnedFlanks(geometry), mesh)
    moving = _TouchingMotion(geometry, errors, settings, slopes)
    count = ENVELOPE_REFINEMENT * mesh.rotations.size
    ahead = np.arange(count) / count
    carrying, touching = errors.carrying_at(ahead)
    places = extremes(1e6 * touching.gap, lambda at: 1e6 * errors.envelope_at(at), PEAK_TOLERANCE)
    peaks = [_Extreme.near(errors, place) for place, _ in places]
    # All points at once: the pairs near this one are the same for all of them.
    joined = TouchingPoints.joined([touching, *(peak.touching for peak in peaks)])
    rotation = np.concatenate([errors.rotations_at(ahead, carrying), *(peak.rotation for peak in peaks)])
    change = moving(joined, rotation)
    of_peaks = [peak.slopes(change[count + 2 * k : count + 2 * k + 2]) for k, peak in enumerate(peaks)]
    values = [peak.value(1e-6 * value) for peak, (_, value) in zip(peaks, places, strict=True)]
    return UnloadedSlopes(touching.gap, change[:count], values[0] - values[1], of_peaks[0] - of_peaks[1])


@dataclass(frozen=True)
class _TouchingMotion:
    """Derivatives of the smallest gap by settings; called with points of contact and their rotations."""

    geometry: PairGeometry
    errors: PairErrors
    settings: Sequence[PairSetting]
    slopes: Mapping[str, Array]

    def __call__(self, at: TouchingPoints, rotation: Array) -> Array:
        """Derivatives (n, j) [rad] at points of contact (n), at pinion rotations (n) [rad]."""
        known = np.isfinite(at.gap) & np.isfinite(at.points[0])
        result = np.full((at.gap.size, len(self.settings)), np.nan)
        if known.any() and self.settings:
            result[known] = self._found(at.at(np.flatnonzero(known)), rotation[known])
        return result

    def _found(self, at: TouchingPoints, rotation: Array) -> Array:
        geometry, members = self.geometry, self.geometry.members
        parts = geometry.exact.motion.surface.flank_parts
        of_pinion = (at.part % len(parts)).astype(np.int8)
        turned_gap = self.errors.flanks.at(at.points, rotation, at.parameters, at.part)
        parameters = turned_gap.parameters.reshape(-1, 2, at.gap.size)[of_pinion, :, np.arange(at.gap.size)].T
        change = pinion_gap_slopes(geometry, self.settings, parameters, of_pinion, rotation)
        change = change + pick([spline("gap", at.points) for spline in self._gear_slopes], at.part // len(parts)).T
        put_in = fit(members.lengthwise, members.profile, {"put_in": self.slopes["put_in"]})("put_in", at.points)
        change = change + put_in.T

        force, only_edges = _bound_forces(turned_gap.slope, turned_gap.margins, turned_gap.margin_slopes)
        columns = np.flatnonzero(np.any(force[slice(*PINION_BOUNDS)] != 0.0, axis=0))
        if columns.size:
            place = geometry.pair.gear.section.points(*at.points[:, columns])
            margins = self._pinion_margins(parameters[:, columns], of_pinion[columns], rotation[columns], place)
            change[columns] -= np.einsum("bn,bnj->nj", force[slice(*PINION_BOUNDS), columns], margins)
        return np.where(only_edges[:, None], change, np.nan)

    @cached_property
    def _gear_slopes(self) -> list[FlankSplines]:
        """Splines of the derivatives by the motion of each gear part, as the gap is made of splines of the parts."""
        members, shape = self.geometry.members, (*self.geometry.nodes, len(self.settings))
        part_slopes = [gear_gap_slopes(self.geometry, self.settings, part) for part in self.errors.flanks.continued]
        return [fit(members.lengthwise, members.profile, {"gap": slopes.reshape(shape)}) for slopes in part_slopes]

    def _pinion_margins(self, parameters: Array, part: NDArray[np.int8], rotation: Array, place: Array) -> Array:
        """Derivatives (4, n, j) of the distances of fixed points of the gear from the pinion's toe, heel, root, tip."""
        exact = self.geometry.exact
        by_place = on_parts(
            exact.motion.surface.flank_parts,
            part,
            np.concatenate([parameters, rotation[None], place]),
            lambda surface, v: circles_met(exact, surface, v[:2], v[2], v[3:]).bound_slopes[:2].reshape(4, -1),
        ).reshape(2, 2, -1)
        moved, fractions = held_point_slopes(self.geometry, self.settings, parameters, part, rotation)
        lengthwise, profile = fractions - np.einsum("fpn,pnj->fnj", by_place, moved)
        return np.stack([lengthwise, -lengthwise, profile, -profile])


def _bound_forces(slope: Array, margins: Array, margin_slopes: Array) -> tuple[Array, Bools]:
    """Multipliers of the bounds (b, n) that hold smallest gaps, and True where these are toe, heel, root or tip.

    The gap's slope (2, n) is the sum of the slopes of the margins (b, 2, n) times the multipliers.
    """
    columns = np.arange(slope.shape[1])
    force = np.zeros(margins.shape)
    first, second = np.argsort(margins, axis=0, kind="stable")[:2]
    on = [margins[bound, columns] < ON_BOUND for bound in (first, second)]
    one, other = (margin_slopes[bound, :, columns].T for bound in (first, second))
    with np.errstate(divide="ignore", invalid="ignore"):
        single = np.sum(slope * one, axis=0) / np.sum(one**2, axis=0)
        both = cramers_rule(one, other, slope)
    corner = on[0] & on[1] & np.all(np.isfinite(both), axis=0)
    steep = np.max(np.abs(slope), axis=0) > LEVEL_SLOPE
    force[first, columns] = np.where(steep & on[0], np.where(corner, both[0], single), 0.0)
    force[second, columns] = np.where(steep & corner, both[1], 0.0)
    return force, ~np.any(force[PINION_BOUNDS[1] :] != 0.0, axis=0)


@dataclass(frozen=True)
class _Extreme:
    """Greatest or least value of the carrying pair's error: two pairs' courses cross there, or one is level."""

    touching: TouchingPoints  # points of contact of both pairs, or twice of one
    rotation: Array
    rates: Array  # by the rotation in pitches (2) [rad]; NaN without such a place

    @classmethod
    def near(cls, errors: PairErrors, place: float) -> _Extreme:
        """The one near a place, as of ``PairErrors.envelope_at``."""
        rates, place = np.full(2, np.nan), place if np.isfinite(place) else 0.0
        # Beside a crossing the pairs on either side carry; a sample of the envelope away they do for certain.
        beside = 1.0 / (ENVELOPE_REFINEMENT * errors.mesh.rotations.size)
        either = place + np.array([-beside, beside])
        # A pair further on in the next cycle is the one before it in this.
        carrying_pairs = errors.carrying_at(np.mod(either, 1.0))[0]
        pairs = carrying_pairs + np.floor(either).astype(np.int64)
        if np.any((pairs < 0) | (pairs >= errors.pairs.size)):
            pairs = carrying_pairs
        steps = np.array([-1.0, 0.0, 1.0])
        for _ in range(PEAK_ROUNDS):
            contacts = errors.touching_at(np.repeat(pairs, 3), place + PEAK_STEP * np.tile(steps, 2))
            if not np.max(np.ptp(contacts.points.reshape(2, 2, 3), axis=2)) < NEIGHBOUR_DISTANCE_LIMIT:
                rates = np.full(2, np.nan)
                break
            before, middle, after = contacts.gap.reshape(2, 3).T
            rates = (after - before) / (2.0 * PEAK_STEP)
            fall = -(after - 2.0 * middle + before)[0] / PEAK_STEP**2 if pairs[0] == pairs[1] else rates[0] - rates[1]
            rise = rates[0] if pairs[0] == pairs[1] else middle[1] - middle[0]
            place += float(np.clip(rise / fall if fall != 0.0 else 0.0, -beside, beside))
        at = np.full(2, place)
        return cls(errors.touching_at(pairs, at), errors.rotations_at(at, pairs), rates)

    def value(self, known: float) -> float:
        """Error there [rad]: where courses cross or are level, else the known value, off by the tolerance of peaks."""
        error = float(np.mean(self.touching.gap))
        close = abs(error - known) <= 1e-6 * PEAK_TOLERANCE
        return error if close and np.all(np.isfinite(self.rates)) else known

    def slopes(self, change: Array) -> Array:
        """Derivatives (j) of the value from those of both pairs there (2, j): a crossing keeps both equal."""
        first, second = change
        apart = self.rates[0] - self.rates[1]
        share = self.rates[0] / apart if apart != 0.0 else 0.0 * self.rates[0]
        return np.asarray(first - share * (first - second))
