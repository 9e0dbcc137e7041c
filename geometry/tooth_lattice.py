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
there. The neighbouring teeth are left out: they change the deflections by less than 1 %. Every brick has 27 nodes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from ..core.errors import GeometryError, InputError
from .flank_surface import into_tooth
from .pair import GearPair
from .section import BlankSection
from .tooth_flanks import named_member
from .tooth_surface import ToothSide, tooth_surface

Array = NDArray[Any]

SURFACE_NODES = (25, 25)  # up the fillet and up the flank, from which the lattice's nodes are taken
CORNER = (
    0.6  # place of the lattice's corner in the fillet, 0 at the root land: the surface is at about 45 degrees there
)
EDGE = 0.12  # of the bricks through the tooth, the thickness of those at its sides, for the sake of the root stress
DEEPER = 1.7  # every brick of the body than the one above
COLUMN_SPREAD = 0.25  # how much wider the columns under the tooth become, over the depth
OVERHANG = 0.75  # of the body's depth, that it runs on beyond toe and heel
DEEPEST = 0.65  # of the way from the root to the member's axis
SHELL_HINT = 'the shell (model = "shell" in [compliance]) needs no whole tooth'


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
        In the pitch beyond the slot, on either side.
    deep
        From the root to the bottom of the body.
    overhang
        Of the body beyond either end of the tooth; zero to let it end there.
    """

    lengthwise: int = 14
    upward: int = 5
    through: int = 4
    slot: int = 2
    beside: int = 2
    deep: int = 3
    overhang: int = 2

    def __post_init__(self) -> None:
        if min(self.lengthwise, self.upward, self.through, self.slot, self.beside, self.deep) < 1 or self.overhang < 0:
            raise InputError(f"{self}: every number of bricks must be at least 1")

    def finer(self, factor: float) -> LatticeSize:
        """The same lattice with ``factor`` times as many bricks in every direction."""
        return LatticeSize(
            *(max(round(factor * n), 1) for n in (self.lengthwise, self.upward, self.through, self.slot)),
            *(max(round(factor * n), 1) for n in (self.beside, self.deep, self.overhang)),
        )


@dataclass(frozen=True)
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
    held
        Nodes at the bottom and at both sides of the body.
    flank_normal
        Unit normals (2 l + 1, 2 u + 1, 3) of the loaded side at the nodes ``flank``, outwards.
    lengthwise
        Lengthwise fractions (2 l + 1) of the sections.
    profile
        Profile fractions (2 l + 1, 2 u + 1) of the nodes ``flank`` on the blank; negative in the fillet.
    slot
        Nodes (2, 2 l + 1, 2 s + 1) of the slots' floors on the loaded and the opposite side, towards the tooth.
    """

    nodes: Array
    cells: NDArray[np.int64]
    column: NDArray[np.int64]
    root_row: int
    held: NDArray[np.int64]
    flank_normal: Array
    lengthwise: Array
    profile: Array
    slot: NDArray[np.int64]

    @property
    def flank(self) -> NDArray[np.int64]:
        """Nodes (2 l + 1, 2 u + 1) on the loaded side, from the middle of the fillet to the tip."""
        return self.column[:, 0, self.root_row :]

    @property
    def opposite_flank(self) -> NDArray[np.int64]:
        """Nodes (2 l + 1, 2 u + 1) on the other side."""
        return self.column[:, -1, self.root_row :]


def graded(count: int, ratio: float, steady: int = 3) -> Array:
    """Places (2 count + 1) from 0 to 1 of vertices and middles; the first ``steady`` intervals grow by ``ratio``."""
    sizes = ratio ** np.minimum(np.arange(count), steady)
    ends = np.concatenate([[0.0], np.cumsum(sizes)]) / sizes.sum()
    return with_middles(ends)


def with_middles(ends: Array) -> Array:
    """The ends (n + 1) of intervals and their middles between (2 n + 1)."""
    places = np.empty(2 * ends.size - 1)
    places[::2] = ends
    places[1::2] = 0.5 * (ends[1:] + ends[:-1])
    return places


@dataclass(frozen=True)
class LatticePlaces:
    """Where the bricks of the tooth end, and their middles, from 0 to 1: an odd number of increasing places each.

    Parameters
    ----------
    lengthwise
        Lengthwise fractions.
    upward
        Of the length of a side from the middle of the fillet to the tip.
    through
        Of the thickness, from the loaded side.
    """

    lengthwise: Array
    upward: Array
    through: Array

    @classmethod
    def of_size(cls, size: LatticeSize) -> LatticePlaces:
        """Even along the face, smaller bricks near the fillet, thin ones at both sides."""
        return cls(graded(size.lengthwise, 1.0), graded(size.upward, 1.5), _both_ends(size.through))

    def thinner_edges(self, ratio: float) -> LatticePlaces:
        """The same number of bricks, those at tip, toe and heel thinner by a ratio, the next by its square root."""
        heel = _thinner_end(self.lengthwise, ratio)
        both = 1.0 - _thinner_end((1.0 - heel)[::-1], ratio)[::-1]
        return LatticePlaces(both, _thinner_end(self.upward, ratio), self.through)


def _thinner_end(places: Array, ratio: float) -> Array:
    sizes = np.diff(places[::2])
    sizes[-2:] *= np.array([np.sqrt(ratio), ratio])[-sizes.size :]
    return with_middles(np.concatenate([[0.0], np.cumsum(sizes)]) / sizes.sum())


@dataclass(frozen=True)
class _Sections:
    """Plane coordinates (across, up) [mm] in the sections (nt), zero in mid tooth, negative on the loaded side."""

    blank: BlankSection
    lengthwise: Array
    turn: float
    middle: Array
    depth: Array

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


def tooth_lattice(
    pair: GearPair,
    member: str,
    size: LatticeSize | None = None,
    rim_depth: float | None = None,
    places: LatticePlaces | None = None,
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
    places
        Where the bricks of the tooth end; overrides their numbers in ``size``.

    Raises
    ------
    GeometryError
        If there is no whole tooth to fill: undercut, pointed, with overlapping fillets or flanks that cross.
    InputError
        If the member has another name or the depth is not positive.
    """
    size = size or LatticeSize()
    blank = named_member(pair, member).section
    depth = usual_depth(blank) if rim_depth is None else float(rim_depth)
    if not (np.isfinite(depth) and depth > 0.0):
        raise InputError(f"rim_depth = {rim_depth!r}: must be a positive length in mm")
    if places is None:
        places = LatticePlaces.of_size(size)
    t, up, through = places.lengthwise, places.upward, places.through
    size = replace(size, lengthwise=t.size // 2, upward=up.size // 2, through=through.size // 2)
    try:
        tooth = tooth_surface(pair, member, (t, SURFACE_NODES[1]), SURFACE_NODES[0])
    except GeometryError as error:
        raise GeometryError(f"{error}; {SHELL_HINT}") from error
    turn = into_tooth(tooth.loaded.flank, tooth.loaded.flank_normal)
    sections = _sections(blank, t, turn, tooth.loaded.flank[:, :, -1], tooth.opposite.flank[:, :, -1])
    pitch = 2.0 * np.pi / named_member(pair, member).teeth

    floors, sides = [], []
    for on_side, land, sense in zip((tooth.loaded, tooth.opposite), tooth.root_lands, (1.0, -1.0), strict=True):
        floor, side = _side_curves(sections, on_side, land, size.slot, up)
        radius = sections.radial(floor[1, :, :1])[1]
        away = graded(size.beside, 1.6)[:0:-1] * pitch
        beyond = np.stack([floor[0, :, :1] - sense * radius * away, np.repeat(floor[1, :, :1], away.size, axis=1)])
        floors.append(np.concatenate([beyond, floor], axis=2))
        sides.append(side)
    inside = (1.0 - through) * sides[0][..., None] + through * sides[1][..., None]  # (2, nt, up, through)
    if np.any(sides[1][0] <= sides[0][0]):
        raise GeometryError(f"the sides of the {member}'s tooth cross each other between fillet and tip; {SHELL_HINT}")

    top = np.concatenate([floors[0], inside[:, :, 0, 1:-1], floors[1][:, :, ::-1]], axis=2)
    body = _body(sections, top, floors[0].shape[2] - 1, through, depth, graded(size.deep, DEEPER)[::-1])
    plane = np.concatenate([body.reshape(2, t.size, -1), inside[:, :, 1:].reshape(2, t.size, -1)], axis=2)
    nodes = np.moveaxis(sections.points(plane), 0, -1)
    ends = [_overhang(sections, body, end, OVERHANG * depth, size.overhang) for end in (0, -1)]

    normal = _flank_normals(sections, tooth.loaded, up)
    profile = sides[0][1] / sections.depth[:, None]
    return _numbered(nodes, ends, size, body.shape[2:], normal, t, profile)


def usual_depth(blank: BlankSection) -> float:
    """Depth of the body that is taken if none is given [mm]: 1.2 times the tooth's height at mid face.

    That is about 2.5 normal modules, the rim of the finite elements that the root springs were compared with.
    """
    root, tip = (np.array(blank.points(np.array(0.5), np.array(h))) for h in (0.0, 1.0))
    return 1.2 * (float(np.linalg.norm(tip - root)) + blank.clearance)


def _sections(blank: BlankSection, t: Array, turn: float, front: Array, back: Array) -> _Sections:
    azimuths = [np.arctan2(tip[1], tip[0]) for tip in (front, back)]
    swing = np.mod(turn * (azimuths[1] - azimuths[0]) + np.pi, 2.0 * np.pi) - np.pi
    root, tip = (np.asarray(blank.points(t, np.full_like(t, h))) for h in (0.0, 1.0))
    return _Sections(blank, t, turn, azimuths[0] + 0.5 * turn * swing, np.hypot(*(tip - root)))


def _both_ends(count: int) -> Array:
    """Places (2 count + 1) from side to side, with thinner bricks at both."""
    if count < 3:
        return graded(count, 1.0)
    sizes = np.minimum(np.arange(count), np.arange(count)[::-1])
    ends = np.concatenate([[0.0], np.cumsum(np.where(sizes == 0, EDGE, 1.0))])
    ends /= ends[-1]
    return np.asarray(np.interp(np.arange(2 * count + 1), np.arange(0, 2 * count + 1, 2), ends))


def _upward(side: ToothSide, fillet: Array, flank: Array) -> tuple[Array, int]:
    """Values up the whole side and the index of the lattice's corner."""
    corner = round(CORNER * (side.fillet.shape[2] - 1))
    return np.concatenate([fillet[:, :, :-1], flank], axis=2), corner


def _along(values: Array, curve: Array, places: Array) -> Array:
    """Values (k, nt, m) known along curves (2, nt, m), at places (n) counted evenly in the curves' length."""
    result = np.empty((values.shape[0], values.shape[1], places.size))
    for index in range(values.shape[1]):
        steps = np.hypot(*np.diff(curve[:, index], axis=1))
        moved = np.concatenate([[True], steps > 1e-9])  # a fillet without width is one node many times over
        length = np.concatenate([[0.0], np.cumsum(steps)])[moved]
        known = PchipInterpolator(length, values[:, index][:, moved], axis=1)
        result[:, index] = known(places * length[-1])
    return result


def _side_curves(sections: _Sections, side: ToothSide, land: Array, slot: int, up: Array) -> tuple[Array, Array]:
    """Slot floor (2, nt, 2 slot + 1) towards the corner, and side (2, nt, up) from there to the tip."""
    points, corner = _upward(side, side.fillet, side.flank)
    upward, floor = sections.plane(points), sections.plane(land)
    floor = np.concatenate([floor[:, :, :-1], upward[:, :, : corner + 1]], axis=2)
    towards = 1.0 - graded(slot, 1.5)[::-1]
    return _along(floor, floor, towards), _along(upward[:, :, corner:], upward[:, :, corner:], up)


def _flank_normals(sections: _Sections, side: ToothSide, up: Array) -> Array:
    points, corner = _upward(side, side.fillet, side.flank)
    normals, _ = _upward(side, side.fillet_normal, side.flank_normal)
    found = _along(normals[:, :, corner:], sections.plane(points)[:, :, corner:], up)
    return np.moveaxis(found / np.sqrt(np.sum(found**2, axis=0)), 0, -1)


def _body(sections: _Sections, top: Array, corner: int, through: Array, depth: float, rise: Array) -> Array:
    """Nodes (2, nt, columns, rows) of the body, from its bottom to the root."""
    floor = top[1].min(axis=1)
    here, below = (sections.radial(up)[1] for up in (floor, floor - 1.0))
    falling = np.maximum(here - below, 1e-9)  # of the radius per mm of depth
    bottom = floor - np.minimum(depth, DEEPEST * here / falling)
    angle = top[0] / sections.radial(top[1])[1]
    last = top.shape[2] - 1 - corner
    spread = COLUMN_SPREAD * (floor - bottom) / here
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


def _overhang(sections: _Sections, body: Array, end: int, length: float, bricks: int) -> Array:
    """Nodes (2 bricks, columns rows, 3) of the body beyond one end of the tooth, outwards."""
    if bricks == 0:
        return np.empty((0, body[0, 0].size, 3))
    roots = np.asarray(sections.blank.points(np.array([0.0, 1.0]), np.zeros(2)))
    away = graded(bricks, 1.5)[1:] * length / np.linalg.norm(roots[:, 1] - roots[:, 0])
    t = sections.lengthwise[end] + (away if end else -away)
    next_to = -2 if end else 1
    step = abs(sections.lengthwise[end] - sections.lengthwise[next_to])
    middle = sections.middle[end] + (sections.middle[end] - sections.middle[next_to]) * away / step
    root, tip = (np.asarray(sections.blank.points(t, np.full_like(t, h))) for h in (0.0, 1.0))
    beyond = _Sections(sections.blank, t, sections.turn, middle, np.hypot(*(tip - root)))
    up = np.broadcast_to(body[1, end].ravel(), (t.size, body[1, end].size))
    angle = body[0, end] / sections.radial(body[1])[1][end]
    plane = np.stack([angle.ravel() * beyond.radial(up)[1], up])
    return np.moveaxis(beyond.points(plane), 0, -1)


def _numbered(
    nodes: Array,
    ends: list[Array],
    size: LatticeSize,
    body: tuple[int, int],
    normal: Array,
    t: Array,
    profile: Array,
) -> ToothLattice:
    """The lattice; of each section's nodes (nt, per section, 3) the body's (columns, rows) come first."""
    columns, rows = body
    in_body = np.arange(columns * rows).reshape(columns, rows)
    first, last = 2 * (size.beside + size.slot), columns - 2 * (size.beside + size.slot)
    above = columns * rows + np.arange(2 * size.upward * (2 * size.through + 1)).reshape(2 * size.upward, -1)
    under = in_body[first:last]
    in_column = np.concatenate([under, above.T], axis=1)
    tooth = np.arange(t.size) * nodes.shape[1]
    toe, heel = np.split(nodes.shape[0] * nodes.shape[1] + np.arange(4 * size.overhang) * in_body.size, 2)
    whole = np.concatenate([toe[::-1], tooth, heel])
    cells = np.concatenate([_layers(whole, in_body), _layers(tooth, in_column[:, rows - 1 :])])
    held = np.unique(np.concatenate([in_body[:, 0], in_body[0], in_body[-1]]))
    floors = np.stack(
        [in_body[2 * size.beside : first + 1, -1], in_body[last - 1 : columns - 2 * size.beside, -1][::-1]]
    )
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
        (whole[:, None] + held).ravel(),
        normal,
        t,
        profile,
        np.moveaxis(tooth[:, None, None] + floors, 1, 0),
    )


def _layers(sections: NDArray[np.int64], plane: NDArray[np.int64]) -> NDArray[np.int64]:
    """Nodes (m, 3, 3, 3) of bricks between sections that begin at given nodes, on the cells of a plane lattice."""
    threes = np.lib.stride_tricks.sliding_window_view(sections, 3)[::2]
    return np.asarray((threes[:, None, :, None, None] + _cells(plane)[:, None]).reshape(-1, 3, 3, 3))


def _cells(lattice: NDArray[np.int64]) -> NDArray[np.int64]:
    """Nodes (m, 3, 3) of the plane cells of a lattice (2 a + 1, 2 b + 1)."""
    windows = np.lib.stride_tricks.sliding_window_view(lattice, (3, 3))[::2, ::2]
    return np.asarray(windows.reshape(-1, 3, 3))
