"""Potential contact lines: level sets of the roll-angle surface, clipped at the flank's boundary, cut into segments.

At a pinion rotation q the tooth pair can touch along the curve where the roll angle equals q (Kolivand 2009, section
2.5). Where the ease-off changes across that curve the closest approach lies a little beside it; the gap next to the
curve is (1/2) c (q - Q)^2 with the separation curvature c, and a term of third order. The correction is of second order
in the ease-off's slope and makes the method agree with conventional contact analysis.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import contourpy
import numpy as np
import xarray as xr

from ...core.arrays import Array, Bools, Integers, record
from ...core.attributes import ordered
from .flank_splines import VALUE_AND_SLOPES, FlankSplines, fit

BOUNDARY_FIELDS = ("pinion_lengthwise", "pinion_profile", "blade_distance")  # end the common flank

POINTS_PER_LINE = 65  # points along a curve while it is traced and clipped
LENGTH_RATIO_LIMIT = 1e-3  # to the longest curve; shorter curves are dropped
SEPARATION_CURVATURE_SCALE = 0.1  # [1/rad], of ordinary pairs; matters for the interpolation alone
SPACING_ROUNDS = 2  # of even spacing; what is left depends on where the curve was traced by 1e-8 of its length
BORDER_STEPS, BORDER_STEP = 4, 0.05  # of Newton's method along the border, and the longest one, a fraction
CROSSING_ITERATIONS = 40  # false position on the boundary; five are usual, a hole takes thirty
CROSSING_TOLERANCE = 1e-12  # distance from the boundary at which a crossing is found
CONVERGED_STEP = 1e-8  # of a fraction; quadratic convergence leaves nothing to gain after such a step


def contact_splines(flanks: xr.Dataset, ease_off: xr.Dataset, extra: Mapping[str, Array] | None = None) -> FlankSplines:
    """Splines of the fields on the gear flank that the contact needs, and ``extra`` ones (lengthwise, profile, ...)."""
    names = ("roll_angle", "ease_off_angle", "lever_arm", *BOUNDARY_FIELDS)
    order = ("lengthwise", "profile")
    fields = {name: ordered(ease_off, name, *order) for name in names}
    # Towards undercut the curvature grows without limit, and a spline through it would swing far into the flank. Its
    # arc tangent, and the derivative of that by the rotation, stay finite; ``curvature_and_skew`` takes them back.
    curvature, skew = (ordered(ease_off, n, *order) for n in ("separation_curvature", "separation_skew"))
    bend, slope = bend_and_slope(curvature, skew)
    fields |= {"separation_bend": bend, "separation_bend_slope": slope}
    gear = int(np.flatnonzero(ordered(flanks, "member", "member") == "gear")[0])
    fields["position"] = ordered(flanks, "position", "member", *order, "xyz")[gear]
    fields |= extra or {}
    return fit(ease_off["lengthwise"].values, ease_off["profile"].values, fields)


def bend_and_slope(curvature: Array, skew: Array) -> tuple[Array, Array]:
    """The fields ``separation_bend`` and its slope from separation curvature [1/rad] and skew [1/rad^2]."""
    share = curvature / SEPARATION_CURVATURE_SCALE
    return np.arctan(share), skew / (1.0 + share**2) / SEPARATION_CURVATURE_SCALE


def curvature_and_skew(bend: Array, slope: Array) -> tuple[Array, Array]:
    """Separation curvature [1/rad] and skew [1/rad^2] from the fields ``separation_bend`` and its slope."""
    share = np.tan(bend)
    return SEPARATION_CURVATURE_SCALE * share, SEPARATION_CURVATURE_SCALE * (1.0 + share**2) * slope


@record(frozen=True)
class ContactLines:
    """Clipped contact curves of one tooth pair at many pinion rotations."""

    level: Integers
    points: Array  # (2, m, POINTS_PER_LINE), evenly spaced in length
    length: Array


def boundary_distance(splines: FlankSplines, points: Array) -> Array:
    """Distance from the boundary of the common flank (...): positive inside, negative outside."""
    values = splines.evaluate(list(BOUNDARY_FIELDS), np.clip(points, 0.0, 1.0))
    return distance_inside(values, splines.in_hole(points))


def distance_inside(values: Mapping[str, Array], in_hole: Bools) -> Array:
    """The same (...) from the ``BOUNDARY_FIELDS`` at points of the flank, and whether they lie in a hole of it."""
    t, h, blade = (values[name] for name in BOUNDARY_FIELDS)
    inside = np.minimum(np.minimum(t, 1.0 - t), np.minimum(h, 1.0 - h))
    return np.where(in_hole, -1.0, np.minimum(inside, blade))


def onto_level(splines: FlankSplines, points: Array, level: Array, steps: int = 3, beyond: float = 0.0) -> Array:
    """Move points (2, ...) along the gradient of the roll angle onto their level, ``beyond`` the flank at most."""
    shape, moved = np.shape(points), np.reshape(points, (2, -1))
    target = np.broadcast_to(level, shape[1:]).ravel()
    active: Integers | slice = slice(None)
    for _ in range(steps):
        at = moved[:, active]
        value, *by_fraction = (d["roll_angle"] for d in splines.derivatives(["roll_angle"], at, VALUE_AND_SLOPES))
        slope = np.stack(by_fraction)
        step = (target[active] - value) * slope / (slope[0] ** 2 + slope[1] ** 2)
        free = at + step
        there = np.clip(free, -beyond, 1.0 + beyond)
        moved = np.array(moved)
        moved[:, active] = there
        # Newton's method converges at once, but not where a border holds a point back, which goes on along it.
        on = np.any((np.abs(step) > CONVERGED_STEP) | (there != free), axis=0)
        active = np.arange(target.size)[active][on]
        if active.size == 0:
            break
    return moved.reshape(shape)


def resampled(polylines: Sequence[Array], count: int) -> Array:
    """Points (2, m, count) evenly spaced along each of m polylines (k, 2), k of every one its own."""
    sizes = np.array([len(one) for one in polylines])
    points, first = np.concatenate(polylines), np.cumsum(sizes) - sizes
    steps = np.zeros(len(points))
    steps[1:] = np.hypot(*np.diff(points, axis=0).T)
    steps[first] = 1.0  # between one and the next
    measure = np.cumsum(steps)
    start, end = measure[first], measure[first + sizes - 1]
    target = start[:, None] + (end - start)[:, None] * np.linspace(0.0, 1.0, count)
    return np.stack([np.interp(target.ravel(), measure, one).reshape(target.shape) for one in points.T])


def evenly_spaced(points: Array, measure: Array, count: int) -> Array:
    """Points (2, m, count) evenly spaced in ``measure`` (m, k) along each of the polylines (2, m, k)."""
    rows, last = np.arange(measure.shape[0])[:, None], measure.shape[1] - 2
    start, length = measure[:, :1], measure[:, -1:] - measure[:, :1]
    target = start + length * np.linspace(0.0, 1.0, count)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.nan_to_num((measure - start) / length)
    # All rows in one ascending sequence: the shares of a row lie between twice its number and one more.
    place = np.searchsorted((shares + 2.0 * rows).ravel(), np.linspace(0.0, 1.0, count) + 2.0 * rows, side="right")
    low = np.clip(place - 1 - rows * measure.shape[1], 0, last)
    step = measure[rows, low + 1] - measure[rows, low]
    weight = np.where(step > 0.0, target - measure[rows, low], 0.0) / np.where(step > 0.0, step, 1.0)
    return np.asarray(points[:, rows, low] + weight * (points[:, rows, low + 1] - points[:, rows, low]))


def arc_length(splines: FlankSplines, points: Array) -> Array:
    """Length (m, k) [mm] along curves (2, m, k) on the gear flank, from their first point."""
    return length_through(splines("position", points))


def length_through(position: Array) -> Array:
    """Length (m, k) [mm] along smooth curves through points in space (3, m, k), from their first point.

    Chords corrected for the bend by the tangents at both ends, of fourth order; chords alone where points nearly
    coincide.
    """
    chord = np.linalg.norm(np.diff(position, axis=-1), axis=0)
    second = np.zeros_like(position)
    second[..., 1:-1] = position[..., 2:] - 2.0 * position[..., 1:-1] + position[..., :-2]
    second[..., 0], second[..., -1] = second[..., 1], second[..., -2]
    bend = np.sum(second**2, axis=0)
    both = 0.5 * (bend[..., 1:] + bend[..., :-1])
    with np.errstate(divide="ignore", invalid="ignore"):
        step = chord * (1.0 + np.where(both < chord**2, both / (24.0 * chord**2), 0.0))
    return np.concatenate([np.zeros((*chord.shape[:-1], 1)), np.cumsum(step, axis=-1)], axis=-1)


def trace(splines: FlankSplines, levels: Array) -> ContactLines:
    """Contact curves at roll angles (k) [rad], clipped: every piece of every level set on the common flank."""
    coarse_t, coarse_h = np.linspace(0, 1, 41), np.linspace(0, 1, 25)
    grid = np.stack(np.meshgrid(coarse_t, coarse_h, indexing="ij"))
    generator = contourpy.contour_generator(coarse_t, coarse_h, splines("roll_angle", grid).T)
    pieces = [(i, np.asarray(piece)) for i, level in enumerate(levels) for piece in generator.lines(float(level))]
    if not pieces:
        return ContactLines(np.zeros(0, dtype=np.int64), np.zeros((2, 0, POINTS_PER_LINE)), np.zeros(0))
    index, raw = zip(*pieces, strict=True)
    points = resampled(raw, POINTS_PER_LINE)
    kept = np.sum(np.hypot(*np.diff(points, axis=2)), axis=1) > LENGTH_RATIO_LIMIT
    return _clip(splines, np.asarray(levels), np.array(index)[kept], points[:, kept])


def _clip(splines: FlankSplines, levels: Array, index: Integers, points: Array) -> ContactLines:
    """Keep the parts of the curves (2, m, POINTS_PER_LINE) inside the boundary, with exact ends."""
    raw_ends = points[:, :, [0, -1]]
    points = onto_level(splines, points, levels[index][:, None])
    points[:, :, [0, -1]] = _onto_border(splines, raw_ends, points[:, :, [0, -1]], levels[index][:, None])
    distance = boundary_distance(splines, points)
    changes = np.diff(np.pad(distance > 0.0, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    (rows, first), (_, beyond) = np.nonzero(changes == 1), np.nonzero(changes == -1)
    if not rows.size:
        return ContactLines(np.zeros(0, dtype=np.int64), np.zeros((2, 0, POINTS_PER_LINE)), np.zeros(0))
    starts = np.stack([first, np.maximum(first - 1, 0)], axis=1)
    ends = np.stack([beyond - 1, np.minimum(beyond, POINTS_PER_LINE - 1)], axis=1)
    both = np.concatenate([starts, ends])
    parameter = _crossing(splines, levels[index], points, np.tile(rows, 2), both).reshape(2, -1)
    # Lay POINTS_PER_LINE points between the two ends, then space them evenly in length.
    along = parameter[0][:, None] + (parameter[1] - parameter[0])[:, None] * np.linspace(0.0, 1.0, POINTS_PER_LINE)
    even = onto_level(splines, between_points(points, rows, along), levels[index[rows]][:, None])
    for _ in range(SPACING_ROUNDS):
        spaced = evenly_spaced(even, arc_length(splines, even), POINTS_PER_LINE)
        even = onto_level(splines, spaced, levels[index[rows]][:, None], steps=2)
    length = arc_length(splines, even)[:, -1]
    long_enough = length > LENGTH_RATIO_LIMIT * float(np.max(length))
    return ContactLines(index[rows][long_enough], even[:, long_enough], length[long_enough])


def _onto_border(splines: FlankSplines, raw: Array, ends: Array, level: Array) -> Array:
    """Ends (2, m, 2) of curves on their levels; where they lay on the border of the gear flank, exactly on it."""
    on_border = (raw == 0.0) | (raw == 1.0)
    axis = np.where(on_border[0], 0, 1)
    rows = np.meshgrid(*(np.arange(n) for n in axis.shape), indexing="ij")
    moved = np.where(on_border, raw, ends)
    for _ in range(BORDER_STEPS):
        value, *slopes = (d["roll_angle"] for d in splines.derivatives(["roll_angle"], moved, VALUE_AND_SLOPES))
        slope = np.where(axis == 0, slopes[1], slopes[0])
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.nan_to_num((level - value) / slope, posinf=0.0, neginf=0.0)
        moved[1 - axis, *rows] = np.clip(moved[1 - axis, *rows] + np.clip(step, -BORDER_STEP, BORDER_STEP), 0.0, 1.0)
    with np.errstate(invalid="ignore"):
        close = np.max(np.abs(moved - ends), axis=0) < BORDER_STEP
    return np.where(np.any(on_border, axis=0) & close, moved, ends)


def between_points(points: Array, rows: Integers, parameter: Array) -> Array:
    """Points (..., m, k) at fractional indices (m, k), linearly, along the polylines ``rows`` of (..., n, p)."""
    low = np.clip(parameter.astype(int), 0, points.shape[-1] - 2)
    weight = parameter - low
    return np.asarray(points[..., rows[:, None], low] * (1 - weight) + points[..., rows[:, None], low + 1] * weight)


def _crossing(splines: FlankSplines, level: Array, points: Array, rows: Integers, pairs: Integers) -> Array:
    """Fractional index (m) where each curve crosses the boundary between an inside and an outside point."""
    inside, outside = pairs[:, 0].astype(float), pairs[:, 1].astype(float)
    cut = inside != outside

    def distance(parameter: Array) -> Array:
        place = between_points(points, rows[cut], parameter[:, None])
        return boundary_distance(splines, onto_level(splines, place, level[rows[cut]][:, None], steps=1))[:, 0]

    if np.any(cut):
        a, b = inside[cut], outside[cut]
        at_a, at_b = distance(a), distance(b)
        crossing, last = a, np.zeros(a.size)
        closed = np.zeros(a.size, dtype=bool)
        for _ in range(CROSSING_ITERATIONS):
            # False position with the Illinois weights, and a bisection where a hole makes the distance jump.
            with np.errstate(divide="ignore", invalid="ignore"):
                guess = (a * at_b - b * at_a) / (at_b - at_a)
            jump = ~np.isfinite(guess) | (at_b <= -1.0)
            guess = np.where(closed, crossing, np.where(jump, 0.5 * (a + b), guess))
            sample = distance(guess)
            side = np.where(sample > 0.0, 1.0, -1.0)
            again = np.where(side == last, 0.5, 1.0)  # the weight of an end that stays a second time
            at_a = np.where(side > 0.0, sample, again * at_a)
            at_b = np.where(side > 0.0, np.where(jump, 1.0, again) * at_b, sample)
            a, b, last = np.where(side > 0.0, guess, a), np.where(side > 0.0, b, guess), side
            reached = closed | (np.abs(sample) < CROSSING_TOLERANCE)
            crossing = np.where(reached, guess, a)
            closed = reached | (np.abs(a - b) < 1e-9)
            if np.all(closed):
                break
        inside[cut] = crossing
    return inside
