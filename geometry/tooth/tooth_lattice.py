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

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import instance, positive, two_whole
from ...core.errors import GeometryError
from ..flanks.blank_section import BlankSection
from ..flanks.flank import into_tooth
from ..pair.gear_pair import GearPair
from .body_lattice import DEPTH_PER_HEIGHT, LatticeSections, Web, body_nodes, overhang, usual_depth
from .lattice_numbering import LatticeSize, ToothLattice, numbered
from .lattice_spacing import LatticeSpacing, graded
from .tooth_flanks import named_member
from .tooth_surface import ToothSide, tooth_surface

__all__ = [
    "DEPTH_PER_HEIGHT",
    "SHELL_HINT",
    "LatticeSize",
    "ToothLattice",
    "Web",
    "tooth_lattice",
    "usual_depth",
]

Array = NDArray[Any]

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
    sections = _sections(blank, t, turn, tooth.loaded.flank[:, :, -1], tooth.opposite.flank[:, :, -1])
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

    normal = _flank_normals(sections, tooth.loaded, up)
    profile = sides[0][1] / sections.depth[:, None]
    return numbered(nodes, ends, size, body.shape[2:], normal, (t, through, up), profile)


def _sections(blank: BlankSection, t: Array, turn: float, front: Array, back: Array) -> LatticeSections:
    azimuths = [np.arctan2(tip[1], tip[0]) for tip in (front, back)]
    swing = np.mod(turn * (azimuths[1] - azimuths[0]) + np.pi, 2.0 * np.pi) - np.pi
    root, tip = (np.asarray(blank.points(t, np.full_like(t, h))) for h in (0.0, 1.0))
    return LatticeSections(blank, t, turn, azimuths[0] + 0.5 * turn * swing, np.hypot(*(tip - root)))


def _upward(side: ToothSide, fillet: Array, flank: Array) -> tuple[Array, int]:
    """Values up the whole side and the index of the lattice's corner."""
    corner = round(CORNER_SHARE * (side.fillet.shape[2] - 1))
    return np.concatenate([fillet[:, :, :-1], flank], axis=2), corner


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
    points, corner = _upward(side, side.fillet, side.flank)
    upward, floor = sections.plane(points), sections.plane(land)
    floor = np.concatenate([floor[:, :, :-1], upward[:, :, : corner + 1]], axis=2)
    towards = 1.0 - graded(slot, 1.5)[::-1]
    return _along(floor, floor, towards), _along(upward[:, :, corner:], upward[:, :, corner:], up)


def _flank_normals(sections: LatticeSections, side: ToothSide, up: Array) -> Array:
    points, corner = _upward(side, side.fillet, side.flank)
    normals, _ = _upward(side, side.fillet_normal, side.flank_normal)
    found = _along(normals[:, :, corner:], sections.plane(points)[:, :, corner:], up)
    return np.moveaxis(found / np.sqrt(np.sum(found**2, axis=0)), 0, -1)
