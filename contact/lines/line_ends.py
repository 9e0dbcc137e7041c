"""Contact lines that end at the edges, where the closest approach beside them does.

A contact line is the curve of conjugate contact, clipped to both flanks. The flanks come closest a little beside it, on
steep ease-offs by some tenths of a millimetre. Where a line runs into an edge at a small angle, its last part can have
its closest approach beyond the edge. There is no flank there: the edge itself touches, see ``mesh_edges``. At the other
end the closest approach can lie on both flanks though the line has left them. Here a line is cut or extended to where
its closest approach lies on both flanks, so that edges begin exactly where lines end.
"""

from __future__ import annotations

import numpy as np

from ...core.arrays import Array, Bools
from .closest_approach import EXTRAPOLATION_LIMIT, SEARCH_RADIUS_LIMIT, OppositePoints, across_line
from .contact_lines import (
    LENGTH_RATIO_LIMIT,
    POINTS_PER_LINE,
    ContactLines,
    arc_length,
    between_points,
    boundary_distance,
    evenly_spaced,
    onto_level,
)
from .flank_splines import FlankSplines
from .mesh_edges import EDGES
from .mesh_lines import MeshLines

EXTENSION_RATIO = 0.08  # of a line beyond either end, over the length of the longest; designed pairs need up to 0.03
EXTENSION_POINTS = 12  # in either extension
POINT_STRIDE = 2  # of the points of a line at which its closest approach is looked at


def lines_to_edges(splines: FlankSplines, mesh: MeshLines) -> MeshLines:
    """Contact lines that end where their closest approach leaves a flank; those without any on both are dropped."""
    lines, rotation = mesh.lines, line_rotations(mesh)[:, None]
    points = onto_level(splines, _extended(lines), rotation, beyond=EXTRAPOLATION_LIMIT)
    first, last, has_part = _inside(_margin(splines, points, rotation))
    rows, span = np.flatnonzero(has_part), np.linspace(0.0, 1.0, POINTS_PER_LINE)
    at = first[rows, None] + (last - first)[rows, None] * span
    curves = onto_level(splines, between_points(points, rows, at), rotation[rows], beyond=EXTRAPOLATION_LIMIT)
    length = arc_length(splines, curves)
    spaced = evenly_spaced(curves, length, POINTS_PER_LINE)
    curves = onto_level(splines, spaced, rotation[rows], steps=2, beyond=EXTRAPOLATION_LIMIT)
    kept = length[:, -1] > LENGTH_RATIO_LIMIT * lines.length.max()
    chosen = rows[kept]
    ended = ContactLines(lines.level[chosen], curves[:, kept], length[kept, -1])
    return MeshLines(mesh.rotations, ended, mesh.position[chosen], mesh.pair[chosen], mesh.pinion_pitch)


def line_rotations(mesh: MeshLines) -> Array:
    """Pinion rotation of every line (m) [rad], counted as the roll angle of its own tooth pair."""
    return np.asarray(mesh.rotations[mesh.position] - mesh.pair * mesh.pinion_pitch)


def edge_distance(splines: FlankSplines, points: Array, rotation: Array) -> Array:
    """Distance (n) [mm] across the line of the closest approach from the nearest toe, heel or tip of either member.

    At pinion rotations (n) [rad] counted as the roll angle.
    """
    expansion = across_line(splines, points)
    closest = points + expansion.direction * expansion.to_closest / expansion.slope
    there, opposite = across_line(splines, closest), OppositePoints.of(splines, closest)
    fractions = closest, opposite.after(rotation - there.roll_angle)
    passing = opposite.slopes - opposite.rate[:, None] * there.gradient[None]
    leaving = there.direction, np.einsum("pgn,gn->pn", passing, there.direction)
    with np.errstate(divide="ignore"):
        each = [
            np.abs(fraction[axis] - value) / np.abs(slope[axis])
            for fraction, slope in zip(fractions, leaving, strict=True)
            for axis, value in EDGES
        ]
    return np.asarray(np.min(each, axis=0))


def _extended(lines: ContactLines) -> Array:
    """Points (2, m, k) along the lines, and on their tangents beyond both ends."""
    points = lines.points
    step = EXTENSION_RATIO * lines.length.max() / EXTENSION_POINTS
    spacing = lines.length / (POINTS_PER_LINE - 1)
    away = step * np.arange(1, EXTENSION_POINTS + 1)
    before, after = (
        points[:, :, [end]] + ((points[:, :, end] - points[:, :, inner]) / (4.0 * spacing))[:, :, None] * away
        for end, inner in ((0, 4), (POINTS_PER_LINE - 1, POINTS_PER_LINE - 5))
    )
    return np.concatenate([before[:, :, ::-1], points[:, :, ::POINT_STRIDE], after], axis=2)


def _margin(splines: FlankSplines, points: Array, rotation: Array) -> Array:
    """Fraction by which the closest approach beside points (2, m, k) lies inside both flanks; negative beyond."""
    expansion = across_line(splines, points)
    way = expansion.direction * expansion.to_closest / expansion.slope
    closest = points + way
    left = rotation - splines("roll_angle", closest)
    opposite = OppositePoints.of(splines, closest.reshape(2, -1)).after(left.ravel()).reshape(closest.shape)
    within = np.min(np.concatenate([closest, 1.0 - closest, opposite, 1.0 - opposite]), axis=0)
    near = np.clip(closest, 0.0, 1.0)
    within = np.minimum(within, splines("blade_distance", near))
    within = np.where(splines.in_hole(near), -1.0, within)
    # Where there is no such step to a closest approach the flank's own boundary ends the line, as it was traced.
    outside = np.any((points < 0.0) | (points > 1.0), axis=0)
    boundary_margin = np.where(outside, -1.0, boundary_distance(splines, np.clip(points, 0.0, 1.0)))
    steps = (expansion.stiffness > 0.0) & (np.max(np.abs(way), axis=0) <= SEARCH_RADIUS_LIMIT)
    within = np.where(steps, within, boundary_margin)
    return np.where(np.any(np.abs(points - 0.5) >= 0.5 + EXTRAPOLATION_LIMIT, axis=0), -1.0, within)


def _inside(margin: Array) -> tuple[Array, Array, Bools]:
    """First and last index (m) of the inside part of every row (m, k) nearest its middle; True if there is one.

    Between two points the border is where the margin, taken as linear, is zero.
    """
    rows, count = np.arange(len(margin)), margin.shape[1]
    inside, place = margin > 0.0, np.arange(count)
    has_part = np.any(inside, axis=1)
    middle = np.argmin(np.where(inside, np.abs(place - 0.5 * (count - 1)), np.inf), axis=1)[:, None]
    low = np.max(np.where(~inside & (place < middle), place, -1), axis=1) + 1
    high = np.min(np.where(~inside & (place > middle), place, count), axis=1) - 1
    with np.errstate(divide="ignore", invalid="ignore"):
        at_low, at_high = (margin[rows, np.clip(end, 0, count - 1)] for end in (low, high))
        before = at_low / (at_low - margin[rows, np.maximum(low - 1, 0)])
        after = at_high / (at_high - margin[rows, np.minimum(high + 1, count - 1)])
    first = low - np.where(has_part & (low > 0), before, 0.0)
    last = high + np.where(has_part & (high < count - 1), after, 0.0)
    return np.where(has_part, first, 0.0), np.where(has_part, last, 0.0), has_part
