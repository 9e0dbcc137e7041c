r"""A structured lattice of bricks in one tooth and the body under it, on the real tooth's own surfaces.

At every lengthwise fraction a section of the member is a piece of a cone at right angles to the tooth's length of the
blank. In it the tooth is ruled between its two sides, from the middle of the fillets to the tip, and the body is ruled
between the root and a line at an even depth below it:

                 ____
                /    \             tooth: lines from side to side
               /      \
    __________/________\__________   the corners sit within the fillets, where three bricks share the half circle
    |   |   | |   |    | |   |   |
    |___|___|_|___|____|_|___|___|   body: straight columns, one pitch to either side of the tooth's slots

Beyond toe and heel the body runs on a little, as blanks do: one that ended flush with the tooth would be much too soft
there. The neighbouring teeth are left out: the body that all share is another lattice, of one pitch, from mid slot to
mid slot (``LatticeSize(beside=0)``). Every brick has 27 nodes.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ...core.arrays import Array, Integers, record
from ...core.checks import instance, positive, two_whole, whole
from ...core.errors import GeometryError, InputError
from ..flanks.blank_section import BlankSection
from ..flanks.flank import into_tooth
from ..pair.gear_pair import GearPair
from .tooth_flanks import named_member
from .tooth_surface import ToothSide, azimuth, between, tooth_surface


@dataclass(frozen=True)
class LatticeSize:
    """Number of bricks in each direction.

    Parameters
    ----------
    lengthwise
        Along the face.
    upward
        From the middle of the fillet to the tip.
    through
        From one side of the tooth to the other.
    slot
        From the middle of the slot to the middle of the fillet, on either side.
    beside
        In the pitch beyond the slot, on either side; zero to let the lattice end in mid slot.
    deep
        From the root to the bottom of the body.
    overhang
        Of the body beyond either end of the tooth; zero to let it end there.

    Examples
    --------
    >>> LatticeSize(lengthwise=6).finer(0.5)
    LatticeSize(lengthwise=3, upward=2, through=2, slot=1, beside=1, deep=2, overhang=1)
    """

    lengthwise: int = 14
    upward: int = 5
    through: int = 4
    slot: int = 2
    beside: int = 2
    deep: int = 3
    overhang: int = 2

    def __post_init__(self) -> None:
        for name, bricks in vars(self).items():
            whole(name, bricks, 0 if name in ("beside", "overhang") else 1)

    def finer(self, factor: float) -> LatticeSize:
        """The same lattice with ``factor`` times as many bricks in every direction."""
        return LatticeSize(*(max(round(factor * bricks), 1) for bricks in astuple(self)))


@record(frozen=True)
class ToothLattice:
    """Nodes and bricks of one tooth on its body, in the member's frame.

    The nodes of the tooth and of the body under it are found by three numbers: lengthwise, through the tooth from the
    loaded side, and up from the bottom of the body.

    Parameters
    ----------
    nodes
        Points (n, 3) [mm].
    cells
        Nodes (m, 3, 3, 3) of every brick.
    column
        Nodes (2 l + 1, 2 t + 1, 2 (d + u) + 1) of the tooth and the body under it.
    root_row
        Third index in ``column`` where the tooth begins.
    fixed_nodes
        Nodes at the bottom and at both sides of the body.
    flank_normal
        Unit normals (2 l + 1, 2 u + 1, 3) of the loaded side at the nodes ``flank``, outwards.
    lengthwise
        Lengthwise fractions (2 l + 1) of the sections.
    profile
        Profile fractions (2 l + 1, 2 u + 1) of the nodes ``flank`` on the blank; negative in the fillet.
    slot
        Nodes (2, 2 l + 1, 2 s + 1) of the slots' floors on the loaded and the opposite side, towards the tooth.
    through, upward
        Fractions (2 t + 1) through the tooth from the loaded side, and (2 u + 1) from the middle of the fillet to the
        tip.
    body_bricks
        Number of bricks of the body; they come first.
    body
        Nodes (2 (l + 2 o) + 1, c, 2 d + 1) of the body: from toe to heel with the o bricks of the overhang at either
        end, across it from the loaded side, and up from its bottom.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import tooth_lattice
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> lattice = tooth_lattice(pair, "gear", LatticeSize(4, 2, 2, 1, 1, 1, 0))
    >>> lattice.cells.shape, lattice.flank.shape
    ((40, 3, 3, 3), (9, 5))
    """

    nodes: Array
    cells: Integers
    column: Integers
    root_row: int
    fixed_nodes: Integers
    flank_normal: Array
    lengthwise: Array
    profile: Array
    slot: Integers
    through: Array
    upward: Array
    body_bricks: int
    body: Integers = field(default_factory=lambda: np.empty((0, 0, 0), dtype=np.int64))

    @property
    def flank(self) -> Integers:
        """Nodes (2 l + 1, 2 u + 1) on the loaded side, from the middle of the fillet to the tip."""
        return self.column[:, 0, self.root_row :]

    @property
    def sides(self) -> Integers:
        """Nodes (2, 2 (l + 2 o) + 1, 2 d + 1) at the sides of the body, the loaded one first."""
        return np.stack([self.body[:, 0], self.body[:, -1]])


def numbered(
    nodes: Array,
    ends: list[Array],
    size: LatticeSize,
    body: tuple[int, int],
    normal: Array,
    spacing: LatticeSpacing,
    profile: Array,
) -> ToothLattice:
    """The lattice; of each section's nodes (nt, per section, 3) the body's (columns, rows) come first."""
    columns, rows = body
    t = spacing.lengthwise
    in_body = np.arange(columns * rows).reshape(columns, rows)
    beside, first = 2 * size.beside, 2 * (size.beside + size.slot)
    last = columns - first
    above = columns * rows + np.arange(2 * size.upward * (2 * size.through + 1)).reshape(2 * size.upward, -1)
    in_column = np.concatenate([in_body[first:last], above.T], axis=1)
    tooth = np.arange(t.size) * nodes.shape[1]
    counts = [len(end) for end in ends]
    toe, heel = np.split(nodes.shape[0] * nodes.shape[1] + np.arange(sum(counts)) * in_body.size, counts[:1])
    whole = np.concatenate([toe[::-1], tooth, heel])
    in_the_body = layers(whole, in_body)
    cells = np.concatenate([in_the_body, layers(tooth, in_column[:, rows - 1 :])])
    fixed_nodes = np.unique(np.concatenate([in_body[:, 0], in_body[0], in_body[-1]]))
    floors = np.stack([in_body[beside : first + 1, -1], in_body[last - 1 : columns - beside, -1][::-1]])
    flat = np.concatenate([nodes.reshape(-1, 3), *(end.reshape(-1, 3) for end in ends)])
    # Left-handed or right-handed, as the tooth's hand has it: all bricks are to have positive volume.
    axes = [flat[cells[0][index]] - flat[cells[0][0, 0, 0]] for index in ((2, 0, 0), (0, 2, 0), (0, 0, 2))]
    if np.linalg.det(np.stack(axes)) < 0.0:
        cells = cells[:, ::-1]
    return ToothLattice(
        flat,
        np.ascontiguousarray(cells),
        tooth[:, None, None] + in_column,
        rows - 1,
        (whole[:, None] + fixed_nodes).ravel(),
        normal,
        t,
        profile,
        np.moveaxis(tooth[:, None, None] + floors, 1, 0),
        spacing.through,
        spacing.upward,
        len(in_the_body),
        whole[:, None, None] + in_body,
    )


def layers(sections: Integers, plane: Integers) -> Integers:
    """Nodes (m, 3, 3, 3) of bricks between sections that begin at given nodes, on the cells of a plane lattice."""
    threes = sliding_window_view(sections, 3)[::2]
    cells = sliding_window_view(plane, (3, 3))[::2, ::2].reshape(-1, 3, 3)
    return np.asarray((threes[:, None, :, None, None] + cells[:, None]).reshape(-1, 3, 3, 3))


EDGE_THICKNESS_RATIO = 0.12  # of the outer bricks through the tooth to the inner ones, for the root stress


def graded(count: int, ratio: float, steady: int = 3) -> Array:
    """Fractions (2 count + 1) from 0 to 1 of vertices and middles; the first ``steady`` intervals grow by ``ratio``."""
    sizes = ratio ** np.minimum(np.arange(count), steady)
    return with_middles(np.concatenate([[0.0], np.cumsum(sizes)]) / sizes.sum())


def with_middles(ends: Array) -> Array:
    """The ends (n + 1) of intervals and their middles between (2 n + 1)."""
    fractions = np.empty(2 * ends.size - 1)
    fractions[::2] = ends
    fractions[1::2] = 0.5 * (ends[1:] + ends[:-1])
    return fractions


@record(frozen=True)
class LatticeSpacing:
    """Ends and middles of the bricks of a tooth: an odd number of increasing fractions from 0 to 1 each."""

    lengthwise: Array
    upward: Array  # of a side from the middle of the fillet to the tip
    through: Array  # of the thickness, from the loaded side

    @classmethod
    def of_size(cls, size: LatticeSize) -> LatticeSpacing:
        """Even along the face, smaller bricks near the fillet, thin ones at both sides."""
        return cls(graded(size.lengthwise, 1.0), graded(size.upward, 1.5), _both_ends(size.through))


def _both_ends(count: int) -> Array:
    """Fractions (2 count + 1) from side to side, with thinner bricks at both."""
    if count < 3:
        return graded(count, 1.0)
    sizes = np.minimum(np.arange(count), np.arange(count)[::-1])
    ends = np.concatenate([[0.0], np.cumsum(np.where(sizes == 0, EDGE_THICKNESS_RATIO, 1.0))])
    return with_middles(ends / ends[-1])


COLUMN_SPREAD = 0.25  # widening of the columns under the tooth, over the depth
SPREAD_LIMIT = 0.3  # of the way from there to the side of the body
DEPTH_PER_HEIGHT = 1.2  # default depth of the body over the height of the tooth
WEB_FALL_MINIMUM = 0.5  # of the web's radius per mm: flatter cones than of 30 degrees lead to no bore
WEB_SLOPE_LENGTH = 0.25  # over which the rim passes into the web, over the overhang at the toe
WEB_BRICK_LENGTH = 0.7  # of a brick of the web, over that overhang
DEPTH_SHARE_LIMIT = 0.65  # of the way from the root to the member's axis


@dataclass(frozen=True)
class Web:
    """Web that carries the rim below the teeth, from its toe end inwards along the root cone to a bore."""

    bore_diameter: float
    thickness: float | None = None  # [mm] across the root cone, flush with the rim's bottom; that of the rim if None

    def __post_init__(self) -> None:
        positive("bore_diameter", self.bore_diameter, "mm")
        if self.thickness is not None:
            positive("web_thickness", self.thickness, "mm")


@dataclass(frozen=True)
class LatticeSections:
    """Plane coordinates (across, up) [mm] in the sections (nt), zero in mid tooth, negative on the loaded side."""

    blank: BlankSection
    lengthwise: Array
    turn: float
    middle: Array

    @cached_property
    def depth(self) -> Array:
        """Depth of the blank (nt) [mm]."""
        root, tip = (self.blank.points(self.lengthwise, np.full_like(self.lengthwise, h)) for h in (0.0, 1.0))
        return np.asarray(np.hypot(*(tip - root)))

    def plane(self, points: Array) -> Array:
        """Coordinates (2, nt, ...) of points (3, nt, ...)."""
        radius = np.hypot(points[0], points[1])
        _, height = self.blank.fractions(points[2], radius)
        shape = (-1, *([1] * (points.ndim - 2)))
        angle = self.turn * (np.arctan2(points[1], points[0]) - self.middle.reshape(shape))
        angle = np.mod(angle + np.pi, 2.0 * np.pi) - np.pi
        return np.stack([radius * angle, height * self.depth.reshape(shape)])

    def points(self, plane: Array) -> Array:
        """Points (3, nt, ...) of coordinates (2, nt, ...)."""
        shape = (-1, *([1] * (plane.ndim - 2)))
        axial, radius = self.radial(plane[1])
        angle = self.middle.reshape(shape) + self.turn * plane[0] / radius
        return np.stack([radius * np.cos(angle), radius * np.sin(angle), axial])

    def radial(self, up: Array) -> Array:
        """Axial and radial coordinates (2, nt, ...) at heights (nt, ...)."""
        shape = (-1, *([1] * (up.ndim - 1)))
        return self.blank.points(self.lengthwise.reshape(shape), up / self.depth.reshape(shape))


def usual_depth(blank: BlankSection) -> float:
    """Default depth of the body [mm]: 1.2 times the tooth's height at mid face, about 2.5 normal modules.

    That is the rim of the finite elements that the root springs were compared with.
    """
    root, tip = (np.array(blank.points(np.array(0.5), np.array(h))) for h in (0.0, 1.0))
    return DEPTH_PER_HEIGHT * (float(np.linalg.norm(tip - root)) + blank.clearance)


def body_nodes(sections: LatticeSections, top: Array, corner: int, through: Array, depth: float, rise: Array) -> Array:
    """Nodes (2, nt, columns, rows) of the body, from its bottom to the root."""
    floor = top[1].min(axis=1)
    radii, below = (sections.radial(up)[1] for up in (floor, floor - 1.0))
    falling = np.maximum(radii - below, 1e-9)  # of the radius per mm of depth
    bottom = floor - np.minimum(depth, DEPTH_SHARE_LIMIT * radii / falling)
    angle = top[0] / sections.radial(top[1])[1]
    last = top.shape[2] - 1 - corner
    room = np.minimum(angle[:, corner] - angle[:, 0], angle[:, -1] - angle[:, last])
    spread = np.minimum(COLUMN_SPREAD * (floor - bottom) / radii, SPREAD_LIMIT * room)
    left, right = angle[:, corner] - spread, angle[:, last] + spread
    lower = angle.copy()
    lower[:, corner : last + 1] = left[:, None] + (right - left)[:, None] * through
    for edge, ends, new in ((0, slice(0, corner + 1), left), (-1, slice(last, None), right)):
        old = angle[:, corner if edge == 0 else last]
        share = (angle[:, ends] - angle[:, [edge]]) / (old - angle[:, edge])[:, None]
        lower[:, ends] = angle[:, [edge]] + share * (new - angle[:, edge])[:, None]
    radius = sections.radial(bottom)[1]
    base = np.stack([radius[:, None] * lower, np.broadcast_to(bottom[:, None], lower.shape)])
    return np.asarray((1.0 - rise) * top[..., None] + rise * base[..., None])


def overhang(sections: LatticeSections, body: Array, end: int, away: Array, web: Web | None = None) -> Array:
    """Nodes (n, columns rows, 3) of the body beyond an end of the tooth, at distances (n) [mm], and of a web."""
    if away.size == 0:
        return np.empty((0, body[0, 0].size, 3))
    roots = np.asarray(sections.blank.points(np.array([0.0, 1.0]), np.zeros(2)))
    length = float(np.linalg.norm(roots[:, 1] - roots[:, 0]))
    next_to = -2 if end else 1
    step = abs(sections.lengthwise[end] - sections.lengthwise[next_to])
    slope = (sections.middle[end] - sections.middle[next_to]) / step * np.minimum(away, away[-1]) / length
    up = np.broadcast_to(body[1, end], (away.size, *body[1, end].shape))
    if web is not None:
        further = _web_distances(sections, float(body[1, end, 0, 0]), float(away[-1]), length, web)
        floor, rise = body[1, end, :, :1], body[1, end] - body[1, end, :, :1]
        slimmer = floor + rise / rise[:, -1:] * (web.thickness or float(rise[:, -1].min()))
        up = np.concatenate([up, np.broadcast_to(slimmer, (further.size, *slimmer.shape))])
        # The node in the middle of the first brick of the web, half way from the rim to the web.
        up[away.size] = 0.5 * (up[away.size - 1] + slimmer)
        away, slope = np.concatenate([away, further]), np.append(slope, np.full(further.size, slope[-1]))
    t = sections.lengthwise[end] + (away if end else -away) / length
    beyond = LatticeSections(sections.blank, t, sections.turn, sections.middle[end] + slope)
    up = up.reshape(t.size, -1)
    angle = body[0, end] / sections.radial(body[1])[1][end]
    plane = np.stack([angle.ravel() * beyond.radial(up)[1], up])
    return np.moveaxis(beyond.points(plane), 0, -1)


def _web_distances(sections: LatticeSections, floor: float, start: float, length: float, web: Web) -> Array:
    """Distances (n) [mm] along the root of the sections of a web, from the rim to where its bottom is at its bore."""

    def radius(away: float) -> float:
        t = np.array([sections.lengthwise[0] - away / length])
        one = LatticeSections(sections.blank, t, sections.turn, np.zeros(1))
        return float(one.radial(np.array([floor]))[1][0])

    wanted, at_rim, falling = 0.5 * web.bore_diameter, radius(start), radius(start) - radius(start + 1.0)
    if not (wanted < at_rim and falling > WEB_FALL_MINIMUM):
        raise InputError(
            f"bore_diameter = {web.bore_diameter:g} mm: must be less than that of the rim's bottom at the toe, "
            f"{2.0 * at_rim:.4g} mm, on a member whose root cone leads there; hold its back instead"
        )
    reach = (at_rim - wanted) / falling
    first = min(WEB_SLOPE_LENGTH * start, reach / 3.0)
    count = max(round((reach - first) / (start * WEB_BRICK_LENGTH)), 2)
    rest = first + (reach - first) * np.arange(1, 2 * count + 1) / (2 * count)
    return np.asarray(start + np.concatenate([[0.5 * first, first], rest]))


SURFACE_NODES = (25, 25)  # up the fillet and up the flank
# Share of the fillet, from the root land, at which the lattice has its corner: at about 45 degrees to the flank.
CORNER_SHARE = 0.6
DEPTH_GROWTH = 1.7  # every brick of the body than the one above
OVERHANG_PER_DEPTH = 0.75  # of the body beyond toe and heel, over its depth
SHELL_HINT = '[compliance] model = "shell" needs no whole tooth (in Python ElasticModel())'


def tooth_lattice(
    pair: GearPair,
    member: str,
    size: LatticeSize | None = None,
    rim_depth: float | None = None,
    spacing: LatticeSpacing | None = None,
    surface_nodes: tuple[int, int] = SURFACE_NODES,
    web: Web | None = None,
) -> ToothLattice:
    """Lattice of one member's tooth.

    Parameters
    ----------
    pair
        The gear pair.
    member
        ``"pinion"`` or ``"gear"``.
    size
        Number of bricks.
    rim_depth
        Depth of the elastic body below the root [mm]; ``None`` for ``usual_depth``. Never more than 65 % of the way to
        the member's axis.
    spacing
        Where the bricks of the tooth end; overrides their numbers in ``size``.
    surface_nodes
        Nodes up the fillet and up the flank, from which the lattice's nodes are taken.
    web
        Web from the toe end of the body, which has an overhang there, to a bore.

    Raises
    ------
    GeometryError
        If there is no whole tooth to fill: undercut, pointed, with overlapping fillets or flanks that cross.
    InputError
        If the member has another name, the depth is not positive, or the web leads to no such bore.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> coarse, fine = (tooth_lattice(pair, "pinion", LatticeSize(n, 2, 2, 1, 1, 1, 0)) for n in (3, 6))
    >>> len(fine.cells) / len(coarse.cells)
    2.0
    """
    instance("size", size, LatticeSize | None)
    instance("spacing", spacing, LatticeSpacing | None)
    instance("web", web, Web | None)
    fillet_nodes, flank_nodes = two_whole("surface_nodes", surface_nodes, 2)
    size = size or LatticeSize()
    blank = named_member(pair, member).section
    depth = usual_depth(blank) if rim_depth is None else positive("rim_depth", rim_depth, "mm")
    if spacing is None:
        spacing = LatticeSpacing.of_size(size)
    t, up, through = spacing.lengthwise, spacing.upward, spacing.through
    size = replace(size, lengthwise=t.size // 2, upward=up.size // 2, through=through.size // 2)
    try:
        tooth = tooth_surface(pair, member, (t.size, flank_nodes), fillet_nodes, t)
    except GeometryError as error:
        raise GeometryError(f"the {member}'s tooth cannot be filled with bricks: {error}; {SHELL_HINT}") from error
    turn = into_tooth(tooth.loaded.flank, tooth.loaded.flank_normal)
    tip, other_tip = tooth.loaded.flank[:, :, -1], tooth.opposite.flank[:, :, -1]
    sections = LatticeSections(blank, t, turn, azimuth(tip) + 0.5 * turn * between(tip, other_tip, turn))
    pitch = 2.0 * np.pi / named_member(pair, member).teeth

    floors, sides = [], []
    for on_side, land, sense in zip((tooth.loaded, tooth.opposite), tooth.root_lands, (1.0, -1.0), strict=True):
        floor, side = _side_curves(sections, on_side, land, size.slot, up)
        radius = sections.radial(floor[1, :, :1])[1]
        away = graded(size.beside, 1.6)[:0:-1] * pitch if size.beside else np.empty(0)
        beyond = np.stack([floor[0, :, :1] - sense * radius * away, np.repeat(floor[1, :, :1], away.size, axis=1)])
        floors.append(np.concatenate([beyond, floor], axis=2))
        sides.append(side)
    inside = (1.0 - through) * sides[0][..., None] + through * sides[1][..., None]  # (2, nt, up, through)
    if np.any(sides[1][0] <= sides[0][0]):
        raise GeometryError(f"the sides of the {member}'s tooth cross each other between fillet and tip; {SHELL_HINT}")

    top = np.concatenate([floors[0], inside[:, :, 0, 1:-1], floors[1][:, :, ::-1]], axis=2)
    body = body_nodes(sections, top, floors[0].shape[2] - 1, through, depth, graded(size.deep, DEPTH_GROWTH)[::-1])
    plane = np.concatenate([body.reshape(2, t.size, -1), inside[:, :, 1:].reshape(2, t.size, -1)], axis=2)
    nodes = np.moveaxis(sections.points(plane), 0, -1)
    away = OVERHANG_PER_DEPTH * depth * graded(size.overhang, 1.5)[1:] if size.overhang else np.empty(0)
    ends = [overhang(sections, body, 0, away, web), overhang(sections, body, -1, away)]

    profile, normal = sides[0][1] / sections.depth[:, None], _flank_normals(sections, tooth.loaded, up)
    return numbered(nodes, ends, size, body.shape[2:], normal, spacing, profile)


def _corner(side: ToothSide) -> int:
    """Index of the lattice's corner among the points of a side."""
    nodes: int = side.fillet.shape[2]
    return round(CORNER_SHARE * (nodes - 1))


def _along(values: Array, curve: Array, fractions: Array) -> Array:
    """Values (k, nt, m) known along curves (2, nt, m), at fractions (n) of the curves' length."""
    from scipy.interpolate import PchipInterpolator

    result = np.empty((values.shape[0], values.shape[1], fractions.size))
    for index in range(values.shape[1]):
        steps = np.hypot(*np.diff(curve[:, index], axis=1))
        moved = np.concatenate([[True], steps > 1e-9])  # a fillet without width is one node many times over
        length = np.concatenate([[0.0], np.cumsum(steps)])[moved]
        known = PchipInterpolator(length, values[:, index][:, moved], axis=1)
        result[:, index] = known(fractions * length[-1])
    return result


def _side_curves(sections: LatticeSections, side: ToothSide, land: Array, slot: int, up: Array) -> tuple[Array, Array]:
    """Slot floor (2, nt, 2 slot + 1) towards the corner, and side (2, nt, up) from there to the tip."""
    corner, upward, floor = _corner(side), sections.plane(side.points), sections.plane(land)
    floor = np.concatenate([floor[:, :, :-1], upward[:, :, : corner + 1]], axis=2)
    towards = 1.0 - graded(slot, 1.5)[::-1]
    return _along(floor, floor, towards), _along(upward[:, :, corner:], upward[:, :, corner:], up)


def _flank_normals(sections: LatticeSections, side: ToothSide, up: Array) -> Array:
    corner = _corner(side)
    vectors = _along(side.normals[:, :, corner:], sections.plane(side.points)[:, :, corner:], up)
    return np.moveaxis(vectors / np.sqrt(np.sum(vectors**2, axis=0)), 0, -1)
