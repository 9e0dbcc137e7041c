"""The real tooth as a surface: both flanks with their fillets, the top land, and half of the root land on either side.

A flank ends where the blade's edge radius begins to cut; from there the edge radius cuts the fillet down to the root.
Lines of equal lengthwise fraction run from the root land over fillet, flank and top land, so that all patches share
their borders.

With it come what the tooth is bounded by: the blade's tip above the root cone, the depth that the mate's tip reaches,
toe and heel faces (the ends of spiral teeth are blunt or sharp wedges), the widths of the lands; and the tooth as a
labelled dataset.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.arrays import Array, record
from ...core.attributes import flag_attributes, labelled
from ...core.checks import two_whole
from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..flanks.blank_section import BlankSection
from ..flanks.flank import into_tooth, solve_flank
from ..newton import solve
from ..pair.ease_off import exact_ease_off
from ..pair.gear_pair import GearPair, Member
from ..pair.tooth_body import Z_AXIS
from ..vectors import cross, rotate
from .tooth_flanks import PlacedFlank, Side, named_member, placed_flanks, side, tooth_angle

FLANK_NODES_MINIMUM = 5  # in each direction
FILLET_NODES = 9
ROOT_LAND_NODES = 5
TOP_LAND_NODES = 5
FILLET_STEP_LIMIT = np.array([0.05, 0.05])  # of both parameters, in Newton steps along the fillet
STRIDE_HALVINGS = 3  # of a stride along the fillet that leads to no point


@record(frozen=True)
class ToothSide:
    """Fillet and flank of one side of a tooth, in the member's frame."""

    fillet: Array  # (3, nt, nf) [mm] from the root land to the end of the flank
    fillet_normal: Array
    flank: Array  # (3, nt, nh) [mm] to the tip; the first ones are the last of the fillet
    flank_normal: Array

    @property
    def points(self) -> Array:
        """From the root land to the tip (3, nt, nf + nh - 1) [mm]."""
        return np.concatenate([self.fillet[:, :, :-1], self.flank], axis=2)

    @property
    def normals(self) -> Array:
        """Outward unit normals at the points."""
        return np.concatenate([self.fillet_normal[:, :, :-1], self.flank_normal], axis=2)

    def turned(self, angle: float) -> ToothSide:
        """The same side turned about the member's axis [rad]."""
        vectors = (self.fillet, self.fillet_normal, self.flank, self.flank_normal)
        return ToothSide(*(rotate(Z_AXIS, np.asarray(angle), each) for each in vectors))


@lru_cache(maxsize=8)  # a tooth and the body under it have the same sides, loaded on either
def tooth_side(
    surface: GeneratingSurface,
    section: BlankSection,
    fractions: tuple[float, ...],
    flank_nodes: int,
    fillet_nodes: int = FILLET_NODES,
) -> ToothSide:
    """Fillet and flank that one blade cuts, at lengthwise fractions (nt); GeometryError where they are missing."""
    lengthwise = np.array(fractions)
    fillet, fillet_normal = _fillet(surface, section, lengthwise, np.linspace(-1.0, 0.0, fillet_nodes))
    joint = fillet[:, :, -1]
    _, start = section.fractions(joint[2], np.hypot(joint[0], joint[1]))
    if np.any(start > 0.9):
        raise GeometryError(
            f"the fillet of the {side(surface)} flank reaches {100 * start.max():.0f} % of the way to the tip: check "
            "tool_edge_radius and toprem_depth"
        )
    heights = start[:, None] + (1.0 - start[:, None]) * np.linspace(0.0, 1.0, flank_nodes)[1:]
    t = np.broadcast_to(lengthwise[:, None], heights.shape)
    flank = solve_flank(surface, section, *section.points(t.ravel(), heights.ravel()))
    missing = ~np.all(np.isfinite(flank.position), axis=0)
    if np.any(missing):
        raise GeometryError(
            f"the {side(surface)} flank is undercut or missing on {100 * missing.mean():.1f} % of the tooth between "
            "fillet and tip: there is no whole tooth to show; check the blank and the machine settings"
        )

    def whole(first: Array, rest: Array) -> Array:
        return np.concatenate([first[:, :, None], rest.reshape(3, *heights.shape)], axis=2)

    return ToothSide(fillet, fillet_normal, whole(joint, flank.position), whole(fillet_normal[:, :, -1], flank.normal))


def _fillet(
    surface: GeneratingSurface, section: BlankSection, lengthwise: Array, coordinates: Array
) -> tuple[Array, Array]:
    """Points and normals (3, nt, nf) that the edge radius cuts, at blade coordinates within it."""
    lowest = surface.flank_parts[0]
    # On the joint, where both surfaces touch; then downwards: the coordinate changes ever faster towards the root land.
    start = solve_flank(lowest, section, *section.points(lengthwise, np.zeros_like(lengthwise)))
    parameters, _, _ = _at_coordinate(lowest, section, lengthwise, 0.0, start.parameters)
    points, normals = [], []
    for stride in pairwise([0.0, *coordinates[::-1].tolist()]):
        parameters, position, normal = _followed(surface.on("edge"), section, lengthwise, stride, parameters)
        points.append(position)
        normals.append(normal)
    return np.stack(points[::-1], axis=2), np.stack(normals[::-1], axis=2)


def _followed(
    surface: GeneratingSurface,
    section: BlankSection,
    lengthwise: Array,
    stride: tuple[float, float],
    start: Array,
    halvings: int = STRIDE_HALVINGS,
) -> tuple[Array, Array, Array]:
    """As ``_at_coordinate`` after a stride from one coordinate to another, in halves where it leads to no points."""
    first, last = stride
    try:
        return _at_coordinate(surface, section, lengthwise, last, start)
    except GeometryError:
        if halvings == 0 or first == last:
            raise
    middle = 0.5 * (first + last)
    start, _, _ = _followed(surface, section, lengthwise, (first, middle), start, halvings - 1)
    return _followed(surface, section, lengthwise, (middle, last), start, halvings - 1)


def _at_coordinate(
    surface: GeneratingSurface, section: BlankSection, lengthwise: Array, coordinate: float, start: Array
) -> tuple[Array, Array, Array]:
    """Parameters (2, nt), points and normals that one blade coordinate cuts, at given lengthwise fractions.

    Where the contact line runs along the blade the parameters do not tell a node; it is found by the equation of
    meshing for that point of the blade, from its neighbours.
    """

    def fraction_and_coordinate(parameters: Array) -> Array:
        position, _, distance = surface.evaluate(parameters)
        return np.stack([_lengthwise(section, position), distance])

    def fraction_and_meshing(parameters: Array) -> Array:
        position, _, velocity = surface.at_coordinate(parameters, coordinate)
        return np.stack([_lengthwise(section, position), velocity / surface.blade.point_radius])

    target = np.stack([lengthwise, np.full_like(lengthwise, coordinate)])
    if not surface.settings.generated:
        start = np.stack([start[0], target[1]])
    solution = solve(fraction_and_coordinate, start, target, FILLET_STEP_LIMIT, iterations=60)
    position, normal, _ = surface.evaluate(solution.parameters)
    lost = np.flatnonzero(~solution.converged)
    if lost.size == 0:
        return solution.parameters, position, normal
    parameters, refound = solution.parameters.copy(), np.zeros(0, dtype=bool)
    first, second = _neighbours(lost, lengthwise.size)
    if surface.settings.generated and np.all(solution.converged[[first, second]]):
        share = (lengthwise[lost] - lengthwise[first]) / (lengthwise[second] - lengthwise[first])
        reach = np.abs(parameters[:, second] - parameters[:, first])
        guess = parameters[:, first] + share * (parameters[:, second] - parameters[:, first])
        wanted = np.stack([lengthwise[lost], np.zeros(lost.size)])
        near = solve(fraction_and_meshing, guess, wanted, FILLET_STEP_LIMIT, iterations=60)
        refound = near.converged & np.all(np.abs(near.parameters - guess) <= reach, axis=0)
        parameters[:, lost] = near.parameters
        position[:, lost], normal[:, lost], _ = surface.at_coordinate(near.parameters, coordinate)
    missing = lost.size - np.count_nonzero(refound)
    if missing:
        raise GeometryError(
            f"the end of the blade cuts no fillet on {100 * missing / lengthwise.size:.0f} % of the {side(surface)} "
            "flank's root: it is undercut, or the blade tip runs far from the root cone; check the machine settings "
            "and tool_edge_radius"
        )
    return parameters, position, normal


def _lengthwise(section: BlankSection, position: Array) -> Array:
    """Lengthwise fractions (n) of points (3, n)."""
    return section.fractions(position[2], np.sqrt(position[0] ** 2 + position[1] ** 2))[0]


def _neighbours(nodes: NDArray[np.intp], count: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The nodes on both sides of each of ``nodes`` out of ``count``; at an end the two next to it."""
    first = np.clip(nodes - 1, 0, count - 3)
    second = np.where(nodes == count - 1, count - 2, np.minimum(first + 2, count - 1))
    return np.where(first == nodes, nodes + 1, first), second


@dataclass(frozen=True)
class ToothSurface:
    """A whole tooth of a member, in the member's frame."""

    loaded: ToothSide
    opposite: ToothSide
    names: tuple[Side, ...]  # concave or convex, the loaded one first
    top_land: Array
    root_lands: tuple[Array, Array]  # (3, nt, nw) [mm] from mid slot to fillet, loaded and opposite


def tooth_surface(
    pair: GearPair,
    member: str,
    nodes: tuple[int, int] = (31, 21),
    fillet_nodes: int = FILLET_NODES,
    lengthwise: Array | None = None,
) -> ToothSurface:
    """The real tooth of one member, as thick as in ``gear_pair.bodies``; nodes lengthwise and up the flank.

    GeometryError if a flank is undercut or missing, fillets of a slot overlap, or the tooth is pointed below its tip.
    """
    which = named_member(pair, member)
    along, up = two_whole("nodes", nodes, FLANK_NODES_MINIMUM)
    t = tuple((np.linspace(0.0, 1.0, along) if lengthwise is None else lengthwise).tolist())
    placed = placed_flanks(which, tooth_angle(pair, member))
    front, back = (tooth_side(p.surface, p.section, t, up, fillet_nodes).turned(p.rotation) for p in placed.values())
    turn = into_tooth(front.flank, front.flank_normal)
    tips = between(front.flank[:, :, -1], back.flank[:, :, -1], turn)
    if np.any(tips <= 0.0):
        raise GeometryError(
            f"the {member}'s tooth is pointed: its flanks meet below the tip on {100 * np.mean(tips <= 0):.0f} % of "
            "the face; a smaller depth_factor of a design, or face_angle of a blank, lowers its tip"
        )
    pitch = 2.0 * np.pi / which.teeth
    roots = pitch - between(front.fillet[:, :, 0], back.fillet[:, :, 0], turn)
    if np.any(roots <= 0.0):
        raise GeometryError(
            f"the fillets of the {member}'s slot overlap on {100 * np.mean(roots <= 0):.0f} % of the face: make "
            "tool_edge_radius smaller"
        )
    width, half = np.linspace(0.0, 1.0, TOP_LAND_NODES), np.linspace(0.5, 0.0, ROOT_LAND_NODES)
    top_land = _land(front.flank[:, :, -1], back.flank[:, :, -1], turn * tips, width)
    root_lands = (
        _land(front.fillet[:, :, 0], back.fillet[:, :, 0], -turn * roots, half),
        _land(back.fillet[:, :, 0], front.fillet[:, :, 0], turn * roots, half),
    )
    return ToothSurface(front, back, tuple(placed), top_land, root_lands)


def azimuth(points: Array) -> Array:
    """Azimuth (...) [rad] of points (3, ...)."""
    return np.asarray(np.arctan2(points[1], points[0]))


def between(front: Array, back: Array, turn: float) -> Array:
    """Angle from the loaded side through the tooth to the other one (nt) [rad], within half a turn."""
    angle = turn * (azimuth(back) - azimuth(front))
    return np.asarray(np.mod(angle + np.pi, 2.0 * np.pi) - np.pi)


def _land(start: Array, end: Array, swing: Array, share: Array) -> Array:
    """Points (3, nt, nw) from ``start`` to the point ``end`` turned to ``swing`` [rad] away, evenly in all."""
    turned = azimuth(start)[:, None] + swing[:, None] * share
    radius, axial = (
        (1.0 - share) * a[:, None] + share * b[:, None]
        for a, b in ((np.hypot(*start[:2]), np.hypot(*end[:2])), (start[2], end[2]))
    )
    return np.stack([radius * np.cos(turned), radius * np.sin(turned), axial])


def tooth_patches(pair: GearPair, member: str, nodes: tuple[int, int] = (31, 21)) -> dict[str, Array]:
    """The tooth of ``tooth_surface`` as grids of points by name, sharing their borders.

    A fillet without width, of a sharp Formate blade, is left out.

    Parameters
    ----------
    pair, member, nodes
        As ``tooth_surface``, which also says what is raised.

    Returns
    -------
    dict
        Points (m, n, 3) [mm] of the patches. Of both flanks the derivative along the first index times the one along
        the second points out of the tooth.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> patches = tooth_patches(pair, "gear", (5, 5))
    >>> print(*patches)
    convex_flank convex_fillet convex_root_land concave_flank concave_fillet concave_root_land top_land
    >>> patches["convex_flank"].shape
    (5, 5, 3)
    """
    tooth = tooth_surface(pair, member, nodes)
    patches: dict[str, Array] = {}
    for name, on_side, land in zip(tooth.names, (tooth.loaded, tooth.opposite), tooth.root_lands, strict=True):
        points = on_side.flank
        along, up = points[:, 1:, :-1] - points[:, :-1, :-1], points[:, :-1, 1:] - points[:, :-1, :-1]
        outward = float(np.sum(cross(along, up) * on_side.flank_normal[:, :-1, :-1]))
        order = slice(None) if outward > 0.0 else slice(None, None, -1)
        patches[f"{name}_flank"] = points[:, order]
        if np.max(np.ptp(on_side.fillet, axis=2)) > 1e-9:
            patches[f"{name}_fillet"] = on_side.fillet[:, order]
        patches[f"{name}_root_land"] = land[:, order]
    patches["top_land"] = tooth.top_land
    return {name: np.ascontiguousarray(np.moveaxis(points, 0, -1)) for name, points in patches.items()}


SIDE_NODES = 5  # up the flank, of which the lower end is used
TOE_MIDDLE_HEEL = np.array([0.0, 0.5, 1.0])


def tip_gap(surface: GeneratingSurface, section: BlankSection) -> Array:
    """Height of the blade tip above the root cone at toe, middle, heel (3) [mm]; negative deeper, NaN undercut."""
    try:
        side = tooth_side(surface.designed, section, tuple(TOE_MIDDLE_HEEL.tolist()), SIDE_NODES, FILLET_NODES)
    except GeometryError:
        return np.full(TOE_MIDDLE_HEEL.size, np.nan)
    lowest = side.fillet[:, :, 0]
    return section.height_above_root(lowest[2], np.hypot(lowest[0], lowest[1]))


PROFILE_NODES = 21


def contact_heights(pair: GearPair, lengthwise: Array) -> tuple[Array, Array]:
    """Least heights of contact above the root cones of pinion and gear (2, n) [mm], and their places (2, n).

    The pinion's is where the gear's tip touches and vice versa; NaN where a tip finds no flank of its mate. Places are
    lengthwise fractions on pinion and gear.
    """
    gear, section = pair.gear.flank(lengthwise, np.linspace(0.0, 1.0, PROFILE_NODES)), pair.pinion.section
    ease_off = exact_ease_off(gear, pair.pinion.loaded, section, pair.assembly)
    shape = (lengthwise.size, PROFILE_NODES)
    position = ease_off.pinion_position.reshape(3, *shape)
    radius = np.hypot(position[0], position[1])
    on_pinion = section.height_above_root(position[2], radius)[:, -1]
    along, above = section.fractions(position[2].ravel(), radius.ravel())
    height = pair.gear.section.height_above_root(gear.position[2], np.hypot(gear.position[0], gear.position[1]))
    on_gear = [_at_tip(*each) for each in zip(above.reshape(shape), height.reshape(shape), strict=True)]
    return np.stack([on_pinion, np.array(on_gear)]), np.stack([along.reshape(shape)[:, -1], lengthwise])


def _at_tip(fraction: Array, height: Array) -> float:
    """Height on the gear at which the conjugate point is the tip of the pinion, whose fraction falls towards it."""
    known = np.isfinite(fraction) & np.isfinite(height)
    fraction, height = fraction[known], height[known]
    if fraction.size < 2 or not fraction.min() < 1.0 < fraction.max():
        return float("nan")
    order = np.argsort(fraction)
    return float(np.interp(1.0, fraction[order], height[order]))


@dataclass(frozen=True)
class EndFace:
    """One end of a tooth."""

    slant: float  # against the normal of the flank [rad], positive where the tooth is a sharp wedge
    height: float


def end_faces(member: Member) -> tuple[EndFace, EndFace]:
    """Toe and heel; the slants are those in the middle of the height."""
    corners = member.section.corners
    flank = member.flank(np.array([0.0, 1.0]), np.array([0.5]))
    up = corners[:, 1] - corners[:, 0]
    heights = np.linalg.norm(up, axis=1)
    face = np.stack([up[:, 1], -up[:, 0]], axis=1) / heights[:, None]  # (axial, radial)
    outward = np.array([[-1.0], [1.0]]) * (corners[1] - corners[0]).mean(axis=0)
    face *= np.sign(np.sum(face * outward, axis=1, keepdims=True))
    radial = flank.position[:2] / np.hypot(*flank.position[:2])
    agreeing = face[:, 0] * flank.normal[2] + face[:, 1] * np.sum(radial * flank.normal[:2], axis=0)
    toe, heel = zip((-np.arcsin(agreeing)).tolist(), heights.tolist(), strict=True)
    return EndFace(*toe), EndFace(*heel)


LENGTHWISE_STEP = 1e-3  # of the face, over which the slope of the tooth line is taken


@record(frozen=True)
class LandWidths:
    """Lands of one member (n) [mm]; NaN where a flank is undercut or missing."""

    top_land: Array  # on the face cone across the tooth; negative if it ends in an edge below
    slot: Array  # at the bottom, between the blade tips as if without edge radius
    root_line: Array  # tips above the root cone, loaded and other side (2, n); negative if deeper


def land_widths(pair: GearPair, member: str, lengthwise: Array) -> LandWidths:
    """Top land and slot of one member at lengthwise fractions (n), as thick as in ``gear_pair.bodies``."""
    which = named_member(pair, member)
    front, back = placed_flanks(which, tooth_angle(pair, member)).values()
    section = which.section
    fractions = (lengthwise + LENGTHWISE_STEP * np.array([[-1.0], [0.0], [1.0]])).ravel()
    axial, radial = section.points(fractions, np.ones_like(fractions))
    tips = [side.at(axial, radial) for side in (front, back)]
    turn = into_tooth(tips[0].position, tips[0].normal)
    tooth, around = _width(tips[0].position, tips[1].position, turn)
    feet, beside = zip(*(_tip_path(side, fractions) for side in (front, back)), strict=True)
    bottom, whole = _width(feet[0], feet[1], turn)
    pitch = 2.0 * np.pi / which.teeth
    middle = slice(lengthwise.size, 2 * lengthwise.size)
    heights = [section.height_above_root(foot[2], np.hypot(foot[0], foot[1]))[middle] for foot in feet]
    return LandWidths(tooth * around, (pitch - bottom) * whole + beside[0] + beside[1], np.stack(heights))


def _tip_path(side: PlacedFlank, fractions: Array) -> tuple[Array, Array]:
    """Points (3, 3 n) [mm] that the tip of a blade cuts, and how far from its corner along the tip (n) [mm].

    The blade is without edge radius. Where it cuts no whole flank, the deepest point of the edge radius, beside the
    corner, gives the slot to a tenth of that radius; NaN where that cuts none either.
    """
    blade, places = side.surface.blade, fractions.reshape(3, -1)
    points, beside = np.full((3, *places.shape), np.nan), np.zeros(places.shape[1])
    for number in range(places.shape[1]):
        for radius, nodes in ((0.0, 2), (blade.edge_radius, FILLET_NODES)):
            surface = side.surface.rounded(radius)
            with suppress(GeometryError):
                tip_side = tooth_side(surface, side.section, tuple(places[:, number].tolist()), SIDE_NODES, nodes)
                points[:, :, number] = tip_side.turned(side.rotation).fillet[:, :, 0]
                beside[number] = radius * (1.0 - np.sin(blade.pressure_angle)) / np.cos(blade.pressure_angle)
                break
    return points.reshape(3, -1), beside


def _width(front: Array, back: Array, turn: float) -> tuple[Array, Array]:
    """Angle from one edge to the other into the tooth (n) [rad], and normal width per angle (n) [mm/rad].

    The edges (3, 3 n) [mm] are given a little before, at and a little behind each place.
    """
    angle = between(front, back, turn)
    middle = (azimuth(front) + 0.5 * turn * angle).reshape(3, -1)
    radius = 0.5 * (np.hypot(front[0], front[1]) + np.hypot(back[0], back[1])).reshape(3, -1)
    axial = 0.5 * (front[2] + back[2]).reshape(3, -1)
    around = 2.0 * radius[1] * np.sin(0.5 * (middle[2] - middle[0]))
    along = np.hypot(axial[2] - axial[0], radius[2] - radius[0])
    return angle.reshape(3, -1)[1], np.asarray(radius[1] * along / np.hypot(along, around))


THICKNESS_LEVELS = 21
REGION_FLAGS = flag_attributes({0: "fillet", 1: "flank"})


def tooth(pair: GearPair, member: str, nodes: tuple[int, int] = (31, 21)) -> xr.Dataset:
    """The real tooth of one member.

    Parameters
    ----------
    pair
        The gear pair.
    member
        ``"pinion"`` or ``"gear"``.
    nodes
        Nodes lengthwise and up the flank.

    Returns
    -------
    xr.Dataset
        ``position`` [mm] and ``normal`` over (side, lengthwise, upward, xyz), the first side loaded, both in the
        member's frame and where they belong around the tooth; ``region`` says which nodes are fillet; and
        ``transverse_thickness`` [mm] over (lengthwise, level), from the higher end of both fillets to the tip.

    Raises
    ------
    GeometryError
        As ``tooth_surface.tooth_surface``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> dict(tooth(pair, "gear", (5, 5))["position"].sizes)
    {'side': 2, 'lengthwise': 5, 'upward': 13, 'xyz': 3}
    """
    surface = tooth_surface(pair, member, nodes)
    section = named_member(pair, member).section
    sides = (surface.loaded, surface.opposite)
    fillet_nodes, flank_nodes = sides[0].fillet.shape[2], sides[0].flank.shape[2]
    grid = ("side", "lengthwise", "upward", "xyz")
    lengthwise = np.linspace(0.0, 1.0, nodes[0])
    return labelled(
        xr.Dataset(
            {
                "position": (grid, np.stack([np.moveaxis(s.points, 0, -1) for s in sides])),
                "normal": (grid, np.stack([np.moveaxis(s.normals, 0, -1) for s in sides])),
                "region": ("upward", np.repeat([0, 1], [fillet_nodes - 1, flank_nodes]).astype(np.int8), REGION_FLAGS),
                "transverse_thickness": (("lengthwise", "level"), transverse_thickness(surface, section)),
            },
            coords={
                "side": list(surface.names),
                "lengthwise": lengthwise,
                "level": np.linspace(0.0, 1.0, THICKNESS_LEVELS),
                "xyz": list("xyz"),
            },
            attrs={"member": member},
        )
    )


def transverse_thickness(surface: ToothSurface, section: BlankSection) -> Array:
    """Chord across the tooth at right angles to the member's axis (nt, levels) [mm]."""
    from scipy.interpolate import PchipInterpolator

    thickness = np.empty((surface.top_land.shape[1], THICKNESS_LEVELS))
    for index in range(thickness.shape[0]):
        profiles = [_profile(side, section, index) for side in (surface.loaded, surface.opposite)]
        common = np.linspace(max(heights[0] for heights, _ in profiles), 1.0, THICKNESS_LEVELS)
        front, back = (PchipInterpolator(*profile)(common) for profile in profiles)
        _, radius = section.points(np.full(THICKNESS_LEVELS, index / (thickness.shape[0] - 1)), common)
        thickness[index] = 2.0 * radius * np.abs(np.sin(0.5 * (back - front)))
    return thickness


def _profile(side: ToothSide, section: BlankSection, index: int) -> tuple[Array, Array]:
    """Profile fraction and azimuth [rad] of one line from root land to tip."""
    x, y, z = side.points[:, index]
    _, height = section.fractions(z, np.hypot(x, y))
    # A fillet without height, of a sharp Formate blade, gives one node many times over.
    rising = np.concatenate([[True], np.diff(height) > 1e-9])
    return height[rising], np.unwrap(np.arctan2(y, x))[rising]
