"""Edge contact beside the contact lines: tip, toe or heel of one tooth on the flank of the other.

Across a contact line the gap grows both ways. Beyond the end of a line, and on a tooth that has no line yet or no
longer, the way to the closest approach leaves a flank: the flanks come closest at the edge where it does. An edge of
the gear is fixed on the gear flank; an edge of the pinion moves over it as the pinion turns, see ``closest_approach``.

A contact line is the curve of conjugate contact, clipped to both flanks. The flanks come closest a little beside it, on
steep ease-offs by some tenths of a millimetre. Where a line runs into an edge at a small angle, its last part can have
its closest approach beyond the edge. There is no flank there: the edge itself touches. At the other end the closest
approach can lie on both flanks though the line has left them. Here a line is cut or extended to where its closest
approach lies on both flanks, so that edges begin exactly where lines end.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields as dataclass_fields, replace
from itertools import product
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...core.arrays import Array, Bools, Integers, record
from .closest_approach import (
    EXTRAPOLATION_LIMIT,
    SEARCH_RADIUS_LIMIT,
    AcrossLine,
    OppositePoints,
    across_line,
    conjugate_points,
    points_below,
    solved,
)
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
from .mesh_lines import MeshLines

Around = TypeVar("Around", bound="EdgeElements | _TouchingParts | AcrossLine | OppositePoints")

ELEMENTS_PER_EDGE = 160
EDGES = ((0, 0.0), (0, 1.0), (1, 1.0))  # which fraction is held, and where: toe, heel, tip
GAP_ESTIMATE_MARGIN = 1.5  # ratio of the estimated gap to the widest one up to which an element is looked at


@dataclass(frozen=True)
class EdgeElements:
    """Pieces (n) of edges that may touch."""

    level: Integers
    points: Array
    separation_angle: Array  # gap as a gear rotation [rad]
    lever_arm: Array
    length: Array  # along the contact line [mm]
    curvature: Array
    overhang: Array  # of the closest approach beyond the edge, across the line [mm]
    still_opens: Bools
    edge: Integers
    element: Integers


@dataclass(frozen=True)
class MeshEdges:
    """Pieces (n) of the edges of every tooth pair over a mesh cycle; positions and pairs count as in ``MeshLines``."""

    elements: EdgeElements
    position: Integers
    pair: Integers


def edges_in_mesh(splines: FlankSplines, mesh: MeshLines, widest: Array, edges: Sequence[FlankEdge]) -> MeshEdges:
    """Pieces of the edges of every tooth pair that may touch, over a mesh cycle.

    By position, nothing touches above the gap ``widest`` as a gear rotation [rad]; a pair before the first and one
    after the last are looked at too.
    """
    pairs = np.arange(mesh.pair.min() - 1, mesh.pair.max() + 2)
    levels = mesh.rotations[:, None] - pairs * mesh.pinion_pitch
    elements = edge_elements(splines, levels.ravel(), np.repeat(widest, pairs.size), edges)
    return MeshEdges(elements, elements.level // pairs.size, pairs[elements.level % pairs.size])


def flank_edges(splines: FlankSplines, near: Sequence[FlankEdge] | None = None) -> tuple[FlankEdge, ...]:
    """Toe, heel and tip of both members; those of the pinion are found sooner from the edges of a similar pair."""
    along = np.linspace(0.0, 1.0, ELEMENTS_PER_EDGE + 1)
    each = [[along, np.full(along.size, value)][:: 1 if fraction else -1] for fraction, value in EDGES]
    nodes = np.stack(each, axis=1)
    of_gear = nodes.reshape(2, -1)
    start = None if near is None else np.concatenate([edge.points for edge in near if edge.of_pinion], axis=1)
    points = np.concatenate([of_gear, conjugate_points(splines, of_gear, start)], axis=1)
    expansion, opposite = across_line(splines, points), OppositePoints.of(splines, points)
    blade_distance = splines("blade_distance", np.clip(points, 0.0, 1.0))
    edges = []
    for (number, (fraction, value)), of_pinion in product(enumerate(EDGES), (False, True)):
        first = (number + of_pinion * len(EDGES)) * along.size
        columns = slice(first, first + along.size)
        line, beside = _at(expansion, columns), _at(opposite, columns)
        passing = beside.slopes - beside.rate[:, None] * line.gradient[None]
        moving = -solved(passing, beside.rate) if of_pinion else np.zeros((2, along.size))
        nearing, outward = 1.0 - np.sum(moving * line.gradient, axis=0), 1.0 if value == 1.0 else -1.0
        leaving = np.sum(passing[fraction] * line.direction, axis=0) if of_pinion else line.direction[fraction]
        place = nodes[:, number], points[:, columns], line, beside
        motion = moving, nearing, leaving, blade_distance[columns]
        edges.append(FlankEdge(of_pinion, fraction, outward, *place, *motion))
    return tuple(edges)


def _at(values: Around, chosen: NDArray[Any] | slice) -> Around:
    """The same at some of the points alone."""
    return type(values)(*(getattr(values, field.name)[..., chosen] for field in dataclass_fields(values)))


def edge_elements(splines: FlankSplines, rotations: Array, widest: Array, edges: Sequence[FlankEdge]) -> EdgeElements:
    """Pieces of one tooth pair's edges that may touch at pinion rotations (q) [rad] counted as the roll angle.

    Nothing touches above the gap ``widest`` (q), as a gear rotation [rad].
    """
    near = [_near_elements(edge, rotations, widest) for edge in edges]
    edge = np.repeat(np.arange(len(edges)), [row.size for row, _ in near])
    rows, element = (np.concatenate(values) for values in zip(*near, strict=True))
    parts = _touching_parts(edges, rotations[rows], edge, element)
    some = parts.share > 0.0
    rows = rows[some]
    pieces = _pieces(splines, rotations[rows], _at(parts, some))
    kept = (pieces.separation_angle < widest[rows]) & (pieces.curvature > 0.0) & (pieces.length > 0.0)
    kept &= pieces.still_opens & ~splines.in_hole(pieces.points)
    return _at(replace(pieces, level=rows), kept)


def chosen_elements(
    splines: FlankSplines, rotations: Array, edges: Sequence[FlankEdge], edge: Integers, element: Integers
) -> EdgeElements:
    """Given pieces (n) of edges, each at its own rotation (n) [rad] and level; without length where none may touch.

    The rotation of the pinion counts as the roll angle.
    """
    return _pieces(splines, rotations, _touching_parts(edges, rotations, edge, element))


def _pieces(splines: FlankSplines, rotations: Array, parts: _TouchingParts) -> EdgeElements:
    """The parts (n) of elements with the gap at their middles, each at a pinion rotation of its own (n)."""
    way = parts.end - parts.start
    points = parts.start + parts.middle * way
    moving = np.flatnonzero(parts.of_pinion)
    points[:, moving] = points_below(splines, parts.wanted[:, moving], points[:, moving], rotations[moving])
    points = np.clip(points, 0.0, 1.0)
    expansion = across_line(splines, points)
    left = rotations - expansion.roll_angle
    gap, curvature = expansion.gap(left), expansion.curvature
    with np.errstate(divide="ignore", invalid="ignore"):
        overhang = np.abs(expansion.gap_slope(left)) * expansion.lever_arm / curvature
    level, length = np.arange(rotations.size), parts.share * expansion.length_along(way)
    rest = length, curvature, overhang, expansion.still_opens(left), parts.edge, parts.element
    return EdgeElements(level, points, gap, expansion.lever_arm, *rest)


@dataclass(frozen=True)
class _TouchingParts:
    """Parts of elements (n) of edges that may touch."""

    edge: Integers
    element: Integers
    of_pinion: Bools
    wanted: Array  # the middle on the member (2, n)
    start: Array
    end: Array
    middle: Array
    share: Array  # of the element; zero without such a part


@record(frozen=True)
class FlankEdge:
    """Nodes (k) of one edge, and where on the gear they are in conjugate contact."""

    of_pinion: bool
    fraction: int  # the one held along the edge
    outward: float
    nodes: Array
    points: Array  # fractions on the gear (2, k); NaN where there are none
    expansion: AcrossLine
    opposite: OppositePoints
    moving: Array  # velocity by the pinion rotation (2, k) [1/rad]; zero for the gear
    nearing: Array  # rotation lost on the point's conjugate contact per rotation (k); one if fixed
    leaving: Array  # of a way across the contact line by this edge (k) [1/mm]
    blade_distance: Array


def _near_elements(edge: FlankEdge, rotations: Array, widest: Array) -> tuple[Integers, Integers]:
    """Indices of the rotations and numbers of the elements of an edge (n) whose gap may be below the widest one."""
    left = (rotations[:, None] - edge.expansion.roll_angle) * edge.nearing
    with np.errstate(invalid="ignore"):
        gap = np.where(edge.expansion.still_opens(left), edge.expansion.gap(left), np.inf)
    nearest = np.minimum(gap[:, 1:], gap[:, :-1])
    row, element = np.nonzero(nearest < GAP_ESTIMATE_MARGIN * widest[:, None])
    return row, element


def _touching_parts(edges: Sequence[FlankEdge], rotations: Array, edge: Integers, element: Integers) -> _TouchingParts:
    """Parts of elements (n) that may touch, each at a pinion rotation of its own (n).

    Such a part belongs to both flanks, and the gap falls beyond the edge. Where a node has no point, neither holds.
    """
    count = element.size
    margins, ends, wanted = np.empty((2, 6, count)), np.empty((2, 2, count)), np.empty((2, 2, count))
    of_pinion = np.zeros(count, dtype=bool)
    for number, one in enumerate(edges):
        columns = np.flatnonzero(edge == number)
        of_pinion[columns] = one.of_pinion
        for side in (0, 1):
            at = element[columns] + side
            margins[side][:, columns], ends[side][:, columns] = _margins(one, rotations[columns], at)
            wanted[side][:, columns] = one.nodes[:, at]
    low, high = np.zeros(count), np.ones(count)
    for first, last in zip(*margins, strict=True):
        with np.errstate(divide="ignore", invalid="ignore"):
            zero = first / (first - last)
        low = np.maximum(low, np.where(first > 0.0, 0.0, np.where(last > 0.0, zero, 1.0)))
        high = np.minimum(high, np.where(last > 0.0, 1.0, np.where(first > 0.0, zero, 0.0)))
    share = np.where(high > low, high - low, 0.0)
    middle = 0.5 * (low + high)
    between = wanted[0] + middle * (wanted[1] - wanted[0])
    return _TouchingParts(edge, element, of_pinion, between, ends[0], ends[1], middle, share)


def _margins(edge: FlankEdge, rotations: Array, at: Integers) -> tuple[Array, Array]:
    """Margins (6, n), positive at nodes of an edge that may touch, and the nodes' points on the gear (2, n)."""
    expansion = _at(edge.expansion, at)
    away = rotations - expansion.roll_angle
    falls = -expansion.gap_slope(away * edge.nearing[at]) * edge.leaving[at] * edge.outward
    moved = edge.points[:, at] + edge.moving[:, at] * away
    other = moved if edge.of_pinion else _at(edge.opposite, at).after(away)
    return np.stack([falls, *other, *(1.0 - other), edge.blade_distance[at]]), moved


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
