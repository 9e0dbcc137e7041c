"""Points at which two bounded flanks come closest at a pinion rotation: inside, on an edge or at a corner of a member.

The gap as a gear rotation is a function of the point on the gear flank, within bounds that both members set. It is
looked at on the grid of the gear flank, by its expansion about conjugate contact; from the lowest nodes Newton's method
on the turned flanks finds the minimum within the bounds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.arrays import Array, Integers
from ...core.attributes import ordered
from ...geometry.newton import cramers_rule
from ...geometry.pair.gear_pair import PairGeometry
from .closest_approach import PASSING_FIELDS, PINION_FRACTIONS, gap_beside, still_opens
from .turned_flanks import BOUNDS, TurnedFlanks, TurnedGap

STARTS_PER_ROTATION = 4
NODES_PER_BLOCK = 20_000  # of all rotations that are looked at together, so that they stay in the processor's cache
GAP_LIMIT = 0.02  # [rad]; a tooth pair farther from contact has no part in the mesh
START_MARGIN = 0.1  # fraction of the pinion flank by which a first guess may lie beyond it
APPROACH_ITERATIONS = 3  # of Newton's method for the pinion point opposite a first guess
ITERATION_LIMIT = 15
STEP_LIMIT = 0.15  # fraction of the flank
NEAREST_BOUNDS = 4  # of all bounds, those a step may meet
PROMISE_TOLERANCE = 5e-13  # [rad]; a step that promises less is not worth taking
LEVEL_PROMISE = 5e-8  # [rad]; of a step that leads on along a level valley
LAST_STEP, LAST_PROMISE = 1e-3, 1e-11  # [fraction of the flank], [rad]; a step that short keeps its promise
BOUND_TOLERANCE = 1e-7  # fraction of the flank
MISS_TOLERANCE = 0.01  # [mm]; the gap is extrapolated over it to second order
DAMPING_MINIMUM = 1e-6  # least curvature of the gap that a step reckons with, by the greatest one
BLADES = BOUNDS.index("gear_blade"), BOUNDS.index("pinion_blade")
EDGE_COUNT = len(BLADES) + min(BLADES)  # bounds that are edges of a flank; the others lie between its parts
_BOUND_PAIRS = np.array(list(combinations(range(NEAREST_BOUNDS), 2))).T  # (2, pairs)
_EXPANSION_FIELDS = ("roll_angle", "ease_off_angle", "separation_curvature", "separation_skew")
_SEARCH_FIELDS = (*_EXPANSION_FIELDS, *PINION_FRACTIONS, *PASSING_FIELDS)


@dataclass(frozen=True)
class TouchingPoints:
    """Smallest gap at pinion rotations (n); NaN where none was found."""

    gap: Array  # as a gear rotation [rad]
    points: Array
    parameters: Array  # on each of the p parts of the pinion flank (2 p, n)
    part: NDArray[np.int8]
    bound: Integers  # index into BOUNDS, -1 inside

    @classmethod
    def joined(cls, parts: Sequence[TouchingPoints]) -> TouchingPoints:
        """Several, one after the other."""
        return cls(*(np.concatenate([getattr(part, each.name) for part in parts], axis=-1) for each in fields(cls)))

    def at(self, index: NDArray[Any]) -> TouchingPoints:
        """Those at an index (m)."""
        return TouchingPoints(*(getattr(self, each.name)[..., index] for each in fields(self)))


def touching_points(flanks: TurnedFlanks, rotations: Array) -> TouchingPoints:
    """Smallest gap of one tooth pair at pinion rotations (n) [rad], counted as the roll angle."""
    row, node = lowest_nodes(flanks.geometry, rotations)
    exact, members = flanks.geometry.exact, flanks.geometry.members
    count = members.profile.size
    points = np.stack([members.lengthwise[node // count], members.profile[node % count]])
    # The lowest point of flanks of several parts is that of one of them on each member.
    parts = len(flanks.parts[0]) * len(flanks.parts[1])
    row, node, points = np.repeat(row, parts), np.repeat(node, parts), np.repeat(points, parts, axis=1)
    parameters = np.tile(exact.pinion_parameters[:, node], (len(flanks.parts[0]), 1))
    part = (np.arange(row.size) % parts).astype(np.int8)
    for _ in range(APPROACH_ITERATIONS):
        parameters = flanks.opposite(points, rotations[row], parameters, part)
    return least(refined(flanks, points, rotations[row], parameters, part), row, rotations.size)


def least(points: TouchingPoints, row: NDArray[Any], count: int) -> TouchingPoints:
    """Of several points (m) that belong to rows (m), the one with the smallest gap in each of ``count`` rows."""
    known = np.flatnonzero(np.isfinite(points.gap))
    order = known[np.argsort(-points.gap[known], kind="stable")]
    best = np.full(count, -1)
    best[row[order]] = order
    if not row.size:
        nothing = np.full((2, count), np.nan)
        parameters = np.full((points.parameters.shape[0], count), np.nan)
        return TouchingPoints(nothing[0], nothing, parameters, best.astype(np.int8), best)
    result = points.at(best)
    missing = best < 0
    result.gap[missing], result.points[:, missing], result.bound[missing] = np.nan, np.nan, -1
    return result


def lowest_nodes(geometry: PairGeometry, rotations: Array) -> tuple[Integers, Integers]:
    """Rotations and nodes of the grid (m) at which a search of the smallest gap starts.

    A node is a start where the gap across its cell, which lies below its own, is lower than around the neighbours.
    """
    field = {name: ordered(geometry.ease_off, name, "lengthwise", "profile") for name in _SEARCH_FIELDS}
    across = [np.nan_to_num(np.abs(np.gradient(field["roll_angle"], axis=axis))) for axis in (0, 1)]
    reach = 0.5 * (across[0] + across[1])
    step = max(NODES_PER_BLOCK // reach.size, 1)
    blocks = [_lowest(field, reach, rotations[start : start + step]) for start in range(0, rotations.size, step)]
    row = np.concatenate([rows + step * block for block, (rows, _) in enumerate(blocks)])
    return row, np.concatenate([node for _, node in blocks])


def _lowest(field: Mapping[str, Array], reach: Array, rotations: Array) -> tuple[Integers, Integers]:
    """As ``lowest_nodes``, from the ease-off's fields (nt, nh) and how far the roll angle reaches around its nodes."""
    curvature, skew = field["separation_curvature"], field["separation_skew"]
    left = rotations[:, None, None] - field["roll_angle"]
    nearer = left - np.minimum(np.maximum(left, -reach), reach)
    with np.errstate(invalid="ignore"):
        gap = gap_beside(field["ease_off_angle"], curvature, skew, nearer)
        usable = still_opens(curvature, skew, nearer) & (gap < GAP_LIMIT)
        for name in PINION_FRACTIONS:
            there = field[name] + (field[f"{name}_rate"] + 0.5 * field[f"{name}_acceleration"] * left) * left
            usable &= np.abs(there - 0.5) < 0.5 + START_MARGIN
    padded = np.full((rotations.size, reach.shape[0] + 2, reach.shape[1] + 2), np.inf)
    padded[:, 1:-1, 1:-1] = gap = np.where(usable, gap, np.inf)
    beside = np.minimum(np.minimum(padded[:, :-2], padded[:, 1:-1]), padded[:, 2:])
    around = np.minimum(np.minimum(beside[..., :-2], beside[..., 1:-1]), beside[..., 2:])
    row, node = np.divmod(np.flatnonzero(usable & (gap <= around)), reach.size)
    order = np.lexsort((gap.reshape(rotations.size, -1)[row, node], row))
    row, node = row[order], node[order]
    chosen = np.arange(row.size) - np.searchsorted(row, row) < STARTS_PER_ROTATION
    return row[chosen], node[chosen]


def refined(
    flanks: TurnedFlanks, points: Array, rotations: Array, parameters: Array, part: NDArray[np.int8]
) -> TouchingPoints:
    """Minima of the gap within the bounds, by Newton's method from points (2, n) at rotations (n) [rad]."""
    count = rotations.size
    points, parameters = points.copy(), parameters.copy()
    gap, bound = np.full(count, np.nan), np.full(count, -1)
    damping = np.full(count, DAMPING_MINIMUM)
    best = _Best.none(count, parameters.shape[0])
    active = np.arange(count)
    for _ in range(ITERATION_LIMIT):
        turned_gap = flanks.at(points[:, active], rotations[active], parameters[:, active], part[active])
        step, promised = _bounded_step(turned_gap, damping[active])
        inside = np.min(turned_gap.margins, axis=0)
        edge = np.where(inside < BOUND_TOLERANCE, np.argmin(turned_gap.margins, axis=0), -1)
        edge[edge >= EDGE_COUNT] = -1
        for blade, index in zip(BLADES, np.divmod(part[active], len(flanks.parts[0])), strict=True):
            edge[(edge == blade) & (index > 0)] = -1
        sure = (inside > -BOUND_TOLERANCE) & (turned_gap.miss < MISS_TOLERANCE)
        short = (np.max(np.abs(step), axis=0) < LAST_STEP) & (np.abs(promised) < LAST_PROMISE)
        done = sure & (short | (np.abs(promised) < PROMISE_TOLERANCE))
        # After a step that raises the gap the next one starts where that one did, and is held back along the valley.
        raised = (turned_gap.gap > best.gap[active] + PROMISE_TOLERANCE) & ~done
        better = sure & ~raised
        best.keep(active[better], points[:, active[better]], turned_gap.gap[better], promised[better], edge[better])
        best.parameters[:, active[better]] = turned_gap.parameters[:, better]
        gap[active[done]] = (turned_gap.gap + np.where(short, promised, 0.0))[done]
        bound[active[done]] = edge[done]
        step = step * np.minimum(1.0, STEP_LIMIT / np.maximum(np.max(np.abs(step), axis=0), STEP_LIMIT))
        damping[active] = np.where(raised, damping[active] * 100.0, np.maximum(0.1 * damping[active], DAMPING_MINIMUM))
        step = np.where(done & ~short, 0.0, step)
        following = turned_gap.parameters + np.einsum("kin,in->kn", turned_gap.following, step)
        points[:, active] = np.where(raised, best.points[:, active], points[:, active] + step)
        parameters[:, active] = np.where(raised, best.parameters[:, active], following)
        active = active[~done & np.isfinite(promised) & (np.abs(turned_gap.gap) < GAP_LIMIT)]
        if not active.size:
            break
    # Along a valley without a slope to speak of there is no end to the steps, and no need of one.
    level = np.isnan(gap) & (np.abs(best.promised) < LEVEL_PROMISE)
    gap[level], bound[level] = best.gap[level], best.bound[level]
    points[:, level], parameters[:, level] = best.points[:, level], best.parameters[:, level]
    hole = flanks.in_hole(np.clip(points, 0.0, 1.0), part)
    minima = TouchingPoints(np.where(hole, np.nan, gap), points, parameters, part, bound)
    return _nearer_to_edges(flanks, minima, rotations)


def _nearer_to_edges(flanks: TurnedFlanks, points: TouchingPoints, rotations: Array) -> TouchingPoints:
    """Points (n) after one more step of those on edges: an edge is curved, and a step ends beside it by the square.

    The gap off the edge errs by 1e-14 rad, of which differences over small changes of a setting see five digits.
    """
    columns = np.flatnonzero((points.bound >= 0) & np.isfinite(points.gap))
    if not columns.size:
        return points
    part, parameters = points.part[columns], points.parameters[:, columns]
    turned_gap = flanks.at(points.points[:, columns], rotations[columns], parameters, part)
    step, promised = _bounded_step(turned_gap, np.full(columns.size, DAMPING_MINIMUM))
    short = (np.max(np.abs(step), axis=0) < LAST_STEP) & (np.abs(promised) < LAST_PROMISE)
    kept, step = columns[short], step[:, short]
    points.gap[kept] = (turned_gap.gap + promised)[short]
    points.points[:, kept] += step
    following = np.einsum("kin,in->kn", turned_gap.following[..., short], step)
    points.parameters[:, kept] = turned_gap.parameters[:, short] + following
    return points


@dataclass(frozen=True)
class _Best:
    """Points (n) with the lowest gap within the bounds so far, and what the step from there promises."""

    gap: Array
    promised: Array
    points: Array
    parameters: Array
    bound: Integers

    @classmethod
    def none(cls, count: int, rows: int) -> _Best:
        """Nothing found yet, with so many rows of parameters."""
        nothing = np.full((4 + rows, count), np.nan)
        return cls(np.full(count, np.inf), nothing[1], nothing[2:4], nothing[4:], np.full(count, -1))

    def keep(self, index: NDArray[Any], points: Array, gap: Array, promised: Array, bound: NDArray[Any]) -> None:
        """Replace those at an index."""
        self.gap[index], self.promised[index], self.bound[index] = gap, promised, bound
        self.points[:, index] = points


def _bounded_step(gap: TurnedGap, damping: Array) -> tuple[Array, Array]:
    """Step (2, n) to the minimum of the gap's second-order model within the linearised bounds, and its promise (n).

    The lowest of those inside, on one of the nearest bounds or where two meet. A gap that is not convex is made so, to
    keep the step downhill.
    """
    slope, bend = gap.slope, _convex(gap.bend, damping)
    with np.errstate(all="ignore"):
        size = np.sqrt(np.sum(gap.margin_slopes**2, axis=1))
        distance = gap.margins / size
        nearest = np.argsort(np.where(np.isfinite(distance), distance, np.inf), axis=0)[:NEAREST_BOUNDS]
        columns = np.arange(slope.shape[1])
        normal = gap.margin_slopes[nearest, :, columns[None]].transpose(0, 2, 1) / size[nearest, columns][:, None]
        margin = distance[nearest, columns]
        across = normal.swapaxes(0, 1)  # (2, k, n)
        foot, along = -margin * across, np.array([-across[1], across[0]])
        push = np.sum(along * (slope[:, None] + _times(bend[:, :, None], foot)), axis=0)
        on_bounds = foot - along * push / np.sum(along * _times(bend[:, :, None], along), axis=0)
        corners = -cramers_rule(across[0, _BOUND_PAIRS], across[1, _BOUND_PAIRS], margin[_BOUND_PAIRS])
        inside = -cramers_rule(bend[:, 0], bend[:, 1], slope)
        steps = np.concatenate([inside[:, None], on_bounds, corners], axis=1)  # (2, candidates, n)
        beyond = -np.min(margin[:, None] + np.einsum("kin,icn->kcn", normal, steps), axis=0)
        model = np.einsum("in,icn->cn", slope, steps) + 0.5 * np.einsum("icn,ijn,jcn->cn", steps, bend, steps)
        allowed = beyond <= BOUND_TOLERANCE
        lowest = np.argmin(np.where(allowed, model, np.inf), axis=0)
        least_beyond = np.argmin(np.where(np.isfinite(beyond), beyond, np.inf), axis=0)
        choice = np.where(np.any(allowed, axis=0), lowest, least_beyond)
    return steps[:, choice, columns], model[choice, columns]


def _convex(bend: Array, ratio: Array) -> Array:
    """Second derivatives (2, 2, n) whose least curvature has a given ratio (n) to the greatest one, or a higher one."""
    mean, half = 0.5 * (bend[0, 0] + bend[1, 1]), 0.5 * (bend[0, 0] - bend[1, 1])
    radius = np.hypot(half, bend[0, 1])
    smallest = mean - radius
    wanted = np.maximum(np.abs(smallest), ratio * np.abs(mean + radius))
    return np.asarray(bend + np.eye(2)[..., None] * (wanted - smallest))


def _times(matrix: Array, vector: Array) -> Array:
    return np.asarray(matrix[:, 0] * vector[0] + matrix[:, 1] * vector[1])
