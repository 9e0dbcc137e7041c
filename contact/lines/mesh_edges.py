"""Edge contact beside the contact lines: tip, toe or heel of one tooth on the flank of the other.

Across a contact line the gap grows both ways. Beyond the end of a line, and on a tooth that has no line yet or no
longer, the way to the closest approach leaves a flank: the flanks come closest at the edge where it does. An edge of
the gear is fixed on the gear flank; an edge of the pinion moves over it as the pinion turns, see ``opposite_points``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import fields as dataclass_fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .closest_approach import AcrossLine, across_line
from .flank_splines import FlankSplines
from .mesh_lines import MeshLines
from .opposite_points import OppositePoints, conjugate_points, points_below, solved

Array = NDArray[Any]

ELEMENTS_PER_EDGE = 160
EDGES = ((0, 0.0), (0, 1.0), (1, 1.0))  # which fraction is held, and where: toe, heel, tip
GAP_ESTIMATE_MARGIN = 1.5  # ratio of the estimated gap to the widest one up to which an element is looked at


@dataclass(frozen=True)
class EdgeElements:
    """Pieces (n) of edges that may touch.

    Parameters
    ----------
    level
        Index into the pinion rotations that were asked for.
    points
        Lengthwise and profile fractions (2, n) on the gear.
    separation_angle
        Gap as a gear rotation [rad].
    lever_arm
        Arm of the normal force about the gear axis [mm].
    length
        Length along the contact line, at right angles to which the gap opens [mm].
    curvature
        Relative curvature of the gap across the contact line [1/mm].
    overhang
        Distance beyond the edge at which the flanks would come closest, across the contact line [mm].
    estimate
        Estimate of the gap [rad], by which the pieces were looked for.
    """

    level: NDArray[np.int64]
    points: Array
    separation_angle: Array
    lever_arm: Array
    length: Array
    curvature: Array
    overhang: Array
    estimate: Array

    def at(self, chosen: NDArray[Any]) -> EdgeElements:
        """Some of the pieces."""
        return EdgeElements(*(getattr(self, field.name)[..., chosen] for field in dataclass_fields(EdgeElements)))


@dataclass(frozen=True)
class MeshEdges:
    """Pieces (n) of the edges of every tooth pair over a mesh cycle.

    Parameters
    ----------
    elements
        The pieces.
    position, pair
        Index of the mesh position, and the tooth pair, as ``MeshLines`` counts them (n).
    """

    elements: EdgeElements
    position: NDArray[np.int64]
    pair: NDArray[np.int64]


def edges_in_mesh(
    splines: FlankSplines, mesh: MeshLines, widest: Array, edges: Sequence[FlankEdge] | None = None
) -> MeshEdges:
    """Pieces of the edges of every tooth pair that may touch, over a mesh cycle.

    Parameters
    ----------
    splines
        Splines from ``loaded_splines``.
    mesh
        Contact lines from ``lines_in_mesh``; a tooth pair before the first and one after the last is looked at
        as well.
    widest
        For every mesh position the gap above which nothing touches, as a gear rotation [rad].
    edges
        The edges from ``flank_edges``, if they are known.
    """
    pairs = np.arange(mesh.pair.min() - 1, mesh.pair.max() + 2)
    levels = mesh.rotations[:, None] - pairs * mesh.pinion_pitch
    elements = edge_elements(splines, levels.ravel(), np.repeat(widest, pairs.size), edges)
    return MeshEdges(elements, elements.level // pairs.size, pairs[elements.level % pairs.size])


def flank_edges(splines: FlankSplines) -> tuple[FlankEdge, ...]:
    """Toe, heel and tip of both members, at no rotation in particular."""
    return tuple(FlankEdge.of(splines, *edge, of_pinion=of_pinion) for edge in EDGES for of_pinion in (False, True))


def edge_elements(
    splines: FlankSplines, rotations: Array, widest: Array, edges: Sequence[FlankEdge] | None = None
) -> EdgeElements:
    """Pieces of the edges of one tooth pair that may touch.

    Parameters
    ----------
    splines
        Splines from ``loaded_splines``.
    rotations
        Pinion rotations (q) [rad], counted as the roll angle.
    widest
        Gap (q) above which nothing touches, as a gear rotation [rad].
    edges
        The edges from ``flank_edges``, if they are known.
    """
    parts = [_touching(splines, edge, rotations, widest) for edge in edges or flank_edges(splines)]
    return EdgeElements(
        *(np.concatenate([getattr(p, field.name) for p in parts], axis=-1) for field in dataclass_fields(EdgeElements))
    )


def may_touch(gap: Array, estimate: Array, widest: Array) -> NDArray[np.bool_]:
    """Whether pieces with a gap and its estimate (n) may touch, where nothing does above the gap ``widest`` (n)."""
    return np.asarray((gap < widest) & (estimate < GAP_ESTIMATE_MARGIN * widest))


@dataclass(frozen=True)
class FlankEdge:
    """Nodes (k) of one edge, and where on the gear they are in conjugate contact.

    Parameters
    ----------
    of_pinion
        Whose edge it is.
    fraction, outward
        Which fraction is held along the edge, and the sense in which it leaves the flank.
    nodes, points
        Fractions (2, k) on the member and on the gear; NaN where there is no such point.
    here
        Gap around the points.
    opposite
        Fractions on the pinion opposite the points.
    moving
        Velocity of the points with the pinion rotation (2, k) [1/rad]; zero for an edge of the gear.
    nearing
        How fast a moving point falls behind its own conjugate contact, by the rotation (k); one for a fixed point.
    leaving
        How fast a way across the contact line leaves the flank by this edge (k) [1/mm].
    blade_distance
        As ``geometry.EaseOff`` has it (k) [mm].
    """

    of_pinion: bool
    fraction: int
    outward: float
    nodes: Array
    points: Array
    here: AcrossLine
    opposite: OppositePoints
    moving: Array
    nearing: Array
    leaving: Array
    blade_distance: Array

    @classmethod
    def of(cls, splines: FlankSplines, fraction: int, value: float, *, of_pinion: bool) -> FlankEdge:
        """Nodes of the edge on which one fraction has the given value."""
        along = np.linspace(0.0, 1.0, ELEMENTS_PER_EDGE + 1)
        nodes = np.full((2, along.size), value)
        nodes[1 - fraction] = along
        points = conjugate_points(splines, nodes) if of_pinion else nodes
        here = across_line(splines, points)
        opposite = OppositePoints.of(splines, points)
        passing = opposite.slopes - opposite.rate[:, None] * here.gradient[None]
        moving = -solved(passing, opposite.rate) if of_pinion else np.zeros(nodes.shape)
        leaving = np.sum(passing[fraction] * here.direction, axis=0) if of_pinion else here.direction[fraction]
        return cls(
            of_pinion,
            fraction,
            1.0 if value == 1.0 else -1.0,
            nodes,
            points,
            here,
            opposite,
            moving,
            1.0 - np.sum(moving * here.gradient, axis=0),
            leaving,
            splines("blade_distance", np.clip(points, 0.0, 1.0)),
        )


def _touching(splines: FlankSplines, edge: FlankEdge, rotations: Array, widest: Array) -> EdgeElements:
    """Elements of one edge at all rotations."""
    row, element, low, high, estimate = _candidates(edge, rotations, widest)
    middle = 0.5 * (low + high)

    def between(nodes: Array) -> Array:
        return np.asarray(nodes[:, element] + middle * (nodes[:, element + 1] - nodes[:, element]))

    away = rotations[row] - edge.here.roll_angle[[element, element + 1]]
    first, last = (edge.points[:, element + i] + edge.moving[:, element + i] * away[i] for i in (0, 1))
    points = first + middle * (last - first)
    if edge.of_pinion:
        points = points_below(splines, between(edge.nodes), points, rotations[row])
    points = np.clip(points, 0.0, 1.0)
    here = across_line(splines, points)
    left = rotations[row] - here.roll_angle
    gap, curvature = here.gap(left), here.curvature
    with np.errstate(divide="ignore", invalid="ignore"):
        overhang = np.abs(here.gap_slope(left)) * here.lever_arm / curvature
    length = (high - low) * here.length_along(last - first)
    kept = may_touch(gap, estimate, widest[row]) & (curvature > 0.0) & (length > 0.0)
    kept &= here.still_opens(left) & ~splines.in_hole(points)
    return EdgeElements(row, points, gap, here.lever_arm, length, curvature, overhang, estimate).at(kept)


def _candidates(edge: FlankEdge, rotations: Array, widest: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Rotations and elements (n) of an edge that may touch, the part of each between two fractions (n), and its gap.

    That part belongs to both flanks, and the gap falls beyond the edge. Where a node has no point, neither holds. The
    gap (n) is an estimate.
    """
    left = (rotations[:, None] - edge.here.roll_angle) * edge.nearing
    with np.errstate(invalid="ignore"):
        gap = np.where(edge.here.still_opens(left), edge.here.gap(left), np.inf)
        falls = -edge.here.gap_slope(left) * edge.leaving * edge.outward
        away = rotations[:, None] - edge.here.roll_angle
        moved = edge.points[:, None] + edge.moving[:, None] * away
        other = moved if edge.of_pinion else edge.opposite.after(away)
        blade = np.broadcast_to(edge.blade_distance, gap.shape)
        estimate = np.minimum(gap[:, 1:], gap[:, :-1])
    row, element = np.nonzero(estimate < GAP_ESTIMATE_MARGIN * widest[:, None])
    low, high = np.zeros(row.size), np.ones(row.size)
    for margin in (falls, *other, *(1.0 - other), blade):
        first, last = margin[row, element], margin[row, element + 1]
        with np.errstate(divide="ignore", invalid="ignore"):
            zero = first / (first - last)
        low = np.maximum(low, np.where(first > 0.0, 0.0, np.where(last > 0.0, zero, 1.0)))
        high = np.minimum(high, np.where(last > 0.0, 1.0, np.where(first > 0.0, zero, 0.0)))
    kept = high > low
    row, element = row[kept], element[kept]
    return row, element, low[kept], high[kept], estimate[row, element]
