"""Cells of a pressure field on the flank of the gear, around one potential contact line, with their gap.

The line of the ease-off method only says where to lay the cells. Their points and normals are those of the generated
gear flank, their gap is that to the generated pinion flank, both at their position of the mesh.

Gaps of potential contact segments, on contact lines and on edges, are compared with that of the turned flanks.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..contact.lines.closest_approach import closest_approach
from ..contact.lines.contact_lines import arc_length, contact_splines
from ..contact.lines.flank_splines import FlankSplines
from ..contact.loaded import LoadedCase
from ..contact.mesh_cycle import MeshCycle
from ..core.arrays import Array, Integers, record
from ..geometry.flanks.flank import solve_flank
from ..geometry.pair.conjugate_motion import ConjugateMotion
from ..geometry.pair.gear_pair import DEFAULT_NODES, GearPair, PairGeometry, pair_geometry
from .smallest_gap import FlankGap, flank_gap

FACING_COSINE_LIMIT = 0.9  # smallest cosine between the normals of flanks that meet


@dataclass(frozen=True)
class FlanksInMesh:
    """Flanks of a pair and splines of its ease-off.

    Parameters
    ----------
    pair
        The pair.
    motion
        Axes, senses and the pinion flank.
    splines
        Splines of ``contact_splines``, and of the ``pinion_parameters`` of conjugate points.
    first_contact
        Closing angle at which the transmission error counts zero [rad].

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> flanks = flanks_in_mesh(pair, (9, 7))
    >>> flanks.splines("pinion_parameters", np.array([0.5, 0.5])).shape
    (2,)
    """

    pair: GearPair
    motion: ConjugateMotion
    splines: FlankSplines
    first_contact: float


def flanks_in_mesh(pair: GearPair, nodes: tuple[int, int] = DEFAULT_NODES) -> FlanksInMesh:
    """Ease-off of a pair with what is needed to return to its surfaces; raises as ``geometry.pair_geometry``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> flanks = flanks_in_mesh(pair, (9, 7))
    >>> flanks.pair == pair
    True
    """
    return flanks_of(pair_geometry(pair, nodes))


def flanks_of(geometry: PairGeometry) -> FlanksInMesh:
    """As ``flanks_in_mesh``, from a geometry."""
    surface, ease_off = geometry.exact, geometry.ease_off
    parameters = np.moveaxis(surface.pinion_parameters.reshape(2, *geometry.nodes), 0, -1)
    usable = np.isfinite(surface.angle).reshape(*geometry.nodes, 1)
    fields = contact_splines(geometry.flanks, ease_off, {"pinion_parameters": np.where(usable, parameters, np.nan)})
    return FlanksInMesh(geometry.pair, surface.motion, fields, float(ease_off.attrs["first_contact_rad"]))


@record(frozen=True)
class SurfaceCells:
    """Cells (n) of one tooth pair at one mesh position."""

    station: Integers
    row: Integers  # across, zero on the line
    along: Array
    across: Array
    sides: Array  # along and across (n, 2) [mm]
    position: Array  # middle (n, 3) in the gear's frame [mm]
    gear_fractions: Array
    pinion_fractions: Array
    separation: Array  # normal gap at first contact's closing angle [mm]
    lever_arm: Array

    @property
    def area(self) -> Array:
        """Areas (n) [mm^2]."""
        return np.asarray(self.sides[:, 0] * self.sides[:, 1])


def cells_on_line(
    flanks: FlanksInMesh,
    line: Array,
    rotation: float,
    *,
    step: tuple[float, float],
    half_band: float,
    extension: float,
    widest_gap: float,
) -> SurfaceCells:
    """Cells around a contact line (2, m), or one not far from it, in lengthwise and profile fractions.

    Lengths in [mm]: steps along and across, half-width of the band, extension beyond the ends on both flanks, widest
    gap of a cell. The rotation is from the pinion's middle [rad].
    """
    middle, slope = _stations(flanks.splines, line, step[0], extension)
    half = int(np.ceil(half_band / step[1]))
    across = step[1] * np.arange(-half, half + 1)
    points = middle[:, :, None] + slope[:, :, None] * across  # (2, stations, across)
    shape = points.shape[1:]
    gear = flanks.pair.gear
    axial, radial = gear.section.points(points[0].ravel(), points[1].ravel())
    nodes = solve_flank(gear.loaded, gear.section, axial, radial)
    position = nodes.position.reshape(3, *shape)
    sides = [np.gradient(position, axis=1), np.gradient(position, axis=2)]
    lengths = [np.linalg.norm(side, axis=0) for side in sides]
    on_gear = points.reshape(2, -1)
    gap, on_pinion = _gap_at(flanks, on_gear, nodes.position, nodes.normal, rotation)
    with np.errstate(invalid="ignore"):
        both = np.all((on_gear >= 0) & (on_gear <= 1) & (on_pinion >= 0) & (on_pinion <= 1), axis=0)
        chosen = nodes.inside & both & (gap.facing > FACING_COSINE_LIMIT) & (gap.gap < widest_gap)
    arm = np.abs(nodes.position[0] * nodes.normal[1] - nodes.position[1] * nodes.normal[0])

    def flat(vectors: Array) -> Array:
        return np.asarray(vectors.reshape(vectors.shape[0], -1).T[chosen])

    station, row = np.indices(shape).reshape(2, -1)[:, chosen]
    along, across_line = (flat(side / length) for side, length in zip(sides, lengths, strict=True))
    places = station, row - half, along, across_line, flat(np.stack(lengths)), flat(position)
    return SurfaceCells(*places, on_gear[:, chosen], on_pinion[:, chosen], gap.gap[chosen], arm[chosen])


def _gap_at(
    flanks: FlanksInMesh, points: Array, position: Array, normal: Array, rotation: float
) -> tuple[FlankGap, Array]:
    """Gap at points (2, n) of the gear in fractions, and fractions (2, n) on the pinion; NaN off the pinion.

    Their positions and normals are those of the gear (3, n); the rotation is from the pinion's middle [rad].
    """
    start = flanks.splines("pinion_parameters", np.clip(points, 0.0, 1.0))
    gap = flank_gap(flanks.motion, position, normal, rotation + flanks.motion.center, flanks.first_contact, start)
    axial, radial = gap.pinion_position[2], np.hypot(*gap.pinion_position[:2])
    return gap, np.stack(flanks.pair.pinion.section.fractions(axial, radial))


def _stations(splines: FlankSplines, points: Array, step: float, extension: float) -> tuple[Array, Array]:
    """Stations (2, k) evenly along a line (2, m) and beyond its ends, and the fractions (2, k) of 1 mm across it."""
    closest = np.clip(points + closest_approach(splines, points).shift, 0.0, 1.0)
    length = arc_length(splines, closest[:, None])[0]
    # Cells of even length fill the line from end to end: where it ends at toe or heel so do they, without a part of a
    # cell beyond the tooth or short of its end. Two are the fewest that have a direction.
    on_line = max(int(np.ceil(length[-1] / step)), 2)
    step = length[-1] / on_line
    beyond = int(np.ceil(extension / step))
    wanted = step * (np.arange(-beyond, on_line + beyond) + 0.5)
    inside = np.clip(wanted, 0.0, length[-1])
    middle = np.stack([np.interp(inside, length, one) for one in closest])
    tangent = np.stack([np.interp(inside, length, np.gradient(one, length)) for one in closest])
    surface = [splines("position", middle, d) for d in ((1, 0), (0, 1))]
    along = tangent[0] * surface[0] + tangent[1] * surface[1]
    # In the tangent plane, at right angles to the line: one fraction follows from the other.
    dots = [np.sum(along * one, axis=0) for one in surface]
    slope = np.stack([dots[1], -dots[0]])
    slope /= np.linalg.norm(slope[0] * surface[0] + slope[1] * surface[1], axis=0)
    return middle + tangent * (wanted - inside), slope


@record(frozen=True)
class SegmentGaps:
    """Gaps of the segments (n) of one solved case, as gear rotations [rad]."""

    separation_angle: Array  # of the case
    exact: Array  # of the turned flanks; NaN off the pinion
    share: Array  # in one more unit of torque; zero where it does not touch

    @property
    def rotation_error(self) -> float:
        """Error of the transmission error by those of the gaps, to first order by Betti's theorem [rad]."""
        touching = self.share != 0.0
        return float(self.share[touching] @ (self.separation_angle - self.exact)[touching])


def segment_gaps(flanks: FlanksInMesh, cycle: MeshCycle, case: LoadedCase) -> SegmentGaps:
    """Gaps of a solved case's segments against those of the turned flanks."""
    # Where edges may touch, the lines end at the edges and know how far these are.
    cut = bool(np.any(np.isfinite(case.segments.line_contact.overhang)))
    line_segments = cycle.segments.to_edges if cut else cycle.segments
    segments, on_lines, lines = case.segments, line_segments.on_lines, line_segments.on_lines.lines
    rows = np.flatnonzero(lines.position == case.mesh_position)
    points, weights = on_lines.quadrature
    places = (points + line_segments.closest.shift)[:, rows].reshape(2, -1)
    pairs = np.repeat(lines.pair[rows], points.shape[2])
    # The segments of the lines come first, then pieces of edges.
    count = rows.size * on_lines.count
    places = np.concatenate([places, segments.point[:, count:]], axis=1)
    pairs = np.concatenate([pairs, segments.pair[count:]])
    rotation = lines.rotations[case.mesh_position] - pairs * lines.pinion_pitch
    gap, _ = exact_gap(flanks, places, rotation)
    edge = count * weights.size
    exact = np.concatenate([gap[:edge].reshape(-1, weights.size) @ weights, gap[edge:]])
    return SegmentGaps(segments.separation_angle, exact, _share_of_more_torque(case))


def _share_of_more_torque(case: LoadedCase) -> Array:
    """Share (n) of the segments in a small increase of the torque, from the compliance of those that touch."""
    touching = case.solution.force > 0.0
    arm = case.problem.lever_arm[touching]
    force = np.linalg.solve(case.problem.dense_compliance[np.ix_(touching, touching)], arm)
    share = np.zeros(touching.size)
    share[touching] = force * arm / (force @ arm)
    return share


def exact_gap(flanks: FlanksInMesh, places: Array, rotation: Array) -> tuple[Array, Array]:
    """Gap of the turned flanks as a gear rotation (n) [rad], zero at first contact, and pinion fractions (2, n).

    Along the gear's normals at fractions (2, n), at rotations (n) from the pinion's middle [rad]; NaN off the pinion.
    """
    gear = flanks.pair.gear
    nodes = solve_flank(gear.loaded, gear.section, *gear.section.points(*places))
    arm = np.abs(nodes.position[0] * nodes.normal[1] - nodes.position[1] * nodes.normal[0])
    gap, fractions = np.full(rotation.shape, np.nan), np.full(places.shape, np.nan)
    for angle in np.unique(rotation):
        indices = np.flatnonzero(rotation == angle)
        position, normal = nodes.position[:, indices], nodes.normal[:, indices]
        gaps, fractions[:, indices] = _gap_at(flanks, places[:, indices], position, normal, angle)
        gap[indices] = gaps.gap / arm[indices]
    return gap, fractions
