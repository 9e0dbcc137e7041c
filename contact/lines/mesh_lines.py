"""Contact lines of every tooth pair over a mesh cycle, and quadrature points on their segments.

At its points a line knows distance and obliqueness of toe and heel of either member, and where pinion and gear are
loaded, with what line contact and bending both ask of these places.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ...core.arrays import Array, Integers, record
from ...core.checks import instance, positive, whole
from ...core.errors import GeometryError
from ...geometry.pair.gear_pair import MEMBERS
from .closest_approach import SEARCH_RADIUS_LIMIT, one_step
from .contact_lines import BOUNDARY_FIELDS, ContactLines, distance_inside, trace
from .flank_splines import VALUE_AND_SLOPES, FlankSplines

GAUSS_POINTS = 3
MESH_POSITION_LIMIT = 10_000
ROLL_SEARCH_GRID = (61, 31)
ROLL_SIGNS = np.array([-1.0, 1.0])  # of the roll angle where its least and its greatest value are searched
ZOOM_ROUND_COUNT, ZOOM_GRID = 6, (21, 21)  # each round looks at a window of four cells of the round before


def mesh_rotations(pinion_pitch: float, positions: int) -> Array:
    """Pinion rotations (positions) [rad] spread evenly over one pitch, the middle of the flank in its middle."""
    return (np.arange(whole("mesh_positions", positions, 1, MESH_POSITION_LIMIT)) / positions - 0.5) * pinion_pitch


@record(frozen=True)
class MeshLines:
    """Contact lines (m) of every tooth pair at every pinion rotation (k) of a mesh cycle.

    Parameters
    ----------
    rotations
        Pinion rotations (k) [rad].
    lines
        The lines.
    position
        Index of each line's pinion rotation (m).
    pair
        Tooth pair of each line (m). The pair 0 is the one that is at its middle in the middle of the mesh cycle; the
        pair -1 is one pitch ahead of it, the pair 1 one pitch behind.
    pinion_pitch
        Angular pitch of the pinion [rad].

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=5)
    >>> set(cycle.lines.position.tolist()), set(cycle.lines.at(1).position.tolist())
    ({0, 1}, {0})
    """

    rotations: Array
    lines: ContactLines
    position: Integers
    pair: Integers
    pinion_pitch: float

    def at(self, position: int) -> MeshLines:
        """The contact lines of one pinion rotation alone."""
        position = whole("position", position, 0, self.rotations.size - 1)
        chosen = np.flatnonzero(self.position == position)
        every = self.lines
        lines = ContactLines(every.level[chosen], every.points[:, chosen], every.length[chosen])
        number = np.zeros(chosen.size, dtype=np.int64)
        return MeshLines(self.rotations[position : position + 1], lines, number, self.pair[chosen], self.pinion_pitch)


def lines_in_mesh(splines: FlankSplines, pinion_pitch: float, mesh_positions: int = 32) -> MeshLines:
    """Trace the contact lines of every tooth pair that can touch, over one mesh cycle.

    Parameters
    ----------
    splines
        Splines from ``contact_lines.contact_splines``.
    pinion_pitch
        Angular pitch of the pinion [rad].
    mesh_positions
        Pinion rotations in one pitch.

    Raises
    ------
    GeometryError
        If no tooth pair can touch at any rotation.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact.loaded import loaded_splines
    >>> from easeoff.geometry import pair_geometry
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> geometry = pair_geometry(pair, (9, 7))
    >>> fields = loaded_splines(geometry.flanks, geometry.ease_off, geometry.teeth)
    >>> lines_in_mesh(fields, pair.assembly.pinion_pitch, 2).rotations.size
    2
    """
    instance("splines", splines, FlankSplines)
    positive("pinion_pitch", pinion_pitch, "rad")
    return lines_at(splines, pinion_pitch, mesh_rotations(pinion_pitch, mesh_positions))


def lines_at(splines: FlankSplines, pinion_pitch: float, rotations: Array) -> MeshLines:
    """As ``lines_in_mesh``, at the given pinion rotations (k) [rad] of one pitch."""
    corner = np.linspace(0.0, 1.0, 21)
    roll = splines("roll_angle", np.stack(np.meshgrid(corner, corner, indexing="ij")))
    ahead = int(np.ceil((float(np.max(roll)) - float(np.min(rotations))) / pinion_pitch))
    behind = int(np.ceil((float(np.max(rotations)) - float(np.min(roll))) / pinion_pitch))
    pairs = np.arange(-ahead, behind + 1)
    levels = (rotations[:, None] - pairs[None, :] * pinion_pitch).ravel()
    position = np.repeat(np.arange(rotations.size), pairs.size)
    pair = np.tile(pairs, rotations.size)
    lines = trace(splines, levels)
    if lines.level.size == 0:
        raise GeometryError("no contact line lies on the common flank of gear and pinion: check the blanks")
    return MeshLines(rotations, lines, position[lines.level], pair[lines.level], pinion_pitch)


def lost_contact(splines: FlankSplines, mesh: MeshLines) -> float:
    """Share of the points of the contact lines next to which there is no line contact.

    The gap does not open to both sides there, or its closest approach is too far for the expansion. Designed flanks
    have none; flanks that bend from node to node of a measuring grid have many.
    """
    closest = one_step(splines, mesh.lines.points)
    far = np.max(np.abs(closest.shift), axis=0) > SEARCH_RADIUS_LIMIT
    return float(np.mean(far | ~(closest.curvature > 0.0)))


def roll_limits(splines: FlankSplines) -> tuple[float, float]:
    """Least and greatest roll angle of contact lines on the common flank [rad]; NaN if it is too small to be found."""
    low, high, shape = np.zeros((2, 2)), np.ones((2, 2)), ROLL_SEARCH_GRID  # by fraction and by side
    sides, best = np.arange(2), np.full(2, -np.inf)
    for _ in range(ZOOM_ROUND_COUNT):  # grids around the best point so far
        axes = [np.linspace(a, b, n) for a, b, n in zip(low, high, shape, strict=True)]
        points = np.stack(np.broadcast_arrays(axes[0][:, None], axes[1][None])).reshape(2, -1, 2)
        value = splines.evaluate(["roll_angle", *BOUNDARY_FIELDS], points)
        within = distance_inside(value, splines.in_hole(points)) >= 0.0
        roll = np.where(within, value["roll_angle"] * ROLL_SIGNS, -np.inf)
        place = np.argmax(roll, axis=0)
        best = np.maximum(best, roll[place, sides])
        reach = 2.0 * (high - low) / (np.array(shape)[:, None] - 1)
        low, high = (np.clip(points[:, place, sides] + way * reach, 0.0, 1.0) for way in (-1.0, 1.0))
        shape = ZOOM_GRID
    least, greatest = np.where(np.isfinite(best), ROLL_SIGNS * best, np.nan)
    return float(least), float(greatest)


def gauss_points(lines: ContactLines, segments: int) -> tuple[Array, Array]:
    """Quadrature points (2, m, segments * GAUSS_POINTS) of even segments, and weights of one, which add up to one."""
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    fraction = ((np.arange(segments)[:, None] + 0.5 * (nodes + 1.0)) / segments).ravel()
    dense = fraction * (lines.points.shape[2] - 1)
    low = np.clip(dense.astype(int), 1, lines.points.shape[2] - 3)
    x = dense - low
    # Cubic through the four points around: the curve bends, and a chord would leave the level set.
    cubic = (
        (-x * (x - 1) * (x - 2) / 6, -1),
        ((x + 1) * (x - 1) * (x - 2) / 2, 0),
        (-(x + 1) * x * (x - 2) / 2, 1),
        ((x + 1) * x * (x - 1) / 6, 2),
    )
    points = sum(weight * lines.points[:, :, low + shift] for weight, shift in cubic)
    return np.asarray(points), weights / 2.0


@record(frozen=True)
class ToothEnds:
    """Toe and heel of a member seen from points (...) of its flank."""

    distance: Array  # from toe and heel along the flank (2, ...) [mm]; zero beyond the end
    cosine: Array  # between contact line and normal of the end's edge, in the flank (...)


def tooth_ends(splines: FlankSplines, member: str, points: Array) -> ToothEnds:
    """Toe and heel from points (2, ...) on the gear where a member is loaded: fraction over length of its gradient."""
    of_pinion = member == "pinion"
    names = ["position", "roll_angle", *(["pinion_lengthwise"] if of_pinion else [])]
    value, *slopes = splines.derivatives(names, points, VALUE_AND_SLOPES)
    fraction, by_fraction = points[0], [np.ones_like(points[0]), np.zeros_like(points[0])]
    if of_pinion:
        fraction, by_fraction = value["pinion_lengthwise"], [each["pinion_lengthwise"] for each in slopes]
    tangents, roll = [each["position"] for each in slopes], [each["roll_angle"] for each in slopes]
    # Gradients along the surface, with the metric of the two fractions: dots of the tangents.
    dots = [np.sum(tangents[i] * tangents[j], axis=0) for i, j in ((0, 0), (0, 1), (1, 1))]
    area = np.sqrt(dots[0] * dots[2] - dots[1] ** 2)
    steep, level = (_gradient(dots, *one) / area for one in (by_fraction, roll))
    # The roll angle is even along the line: the sine between both gradients is the cosine between line and gradient.
    turned = np.abs(by_fraction[0] * roll[1] - by_fraction[1] * roll[0]) / area
    distance = np.maximum(np.stack([fraction, 1.0 - fraction]), 0.0) / steep
    return ToothEnds(distance, turned / (steep * level))


def _gradient(dots: list[Array], first: Array, second: Array) -> Array:
    """Length of a gradient from its two derivatives, times the area of the fractions."""
    return np.asarray(np.sqrt(dots[2] * first**2 - 2.0 * dots[1] * first * second + dots[0] * second**2))


@record(frozen=True)
class LoadedPlaces:
    """Points (2, ...) at which both members are loaded, as fractions on the gear."""

    fields: FlankSplines
    pinion: Array
    gear: Array

    @property
    def points(self) -> tuple[Array, Array]:
        """Those of pinion and gear."""
        return self.pinion, self.gear

    @cached_property
    def depths(self) -> list[Array]:
        """Distances of the mid-surfaces along the normal (...) [mm]; not positive next to a sharp edge."""
        return [self.fields(f"depth_{member}", one) for member, one in zip(MEMBERS, self.points, strict=True)]

    @cached_property
    def ends(self) -> list[ToothEnds]:
        """Toe and heel of either member."""
        return [tooth_ends(self.fields, member, one) for member, one in zip(MEMBERS, self.points, strict=True)]
