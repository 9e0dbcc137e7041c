"""A tooth flank on a set of nodes: positions and normals at given axial and radial coordinates, each with a status.

Several sections of a blade cut a surface of its own each, and the deepest cut remains. At every node each section's
surface is solved on its own. Those whose touched point lies within the section's ends are candidates. Where sections
join without a kink exactly one is; at a kink, where the blade protrudes on both sides, both or neither may be, and the
one that has removed more metal decides. Where the section in question cuts no point there is no flank: the others do
not reach beyond their ends.

The search begins at the mean point of the flank and a lattice of seeds about it; principal curvatures follow by
fundamental forms.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ...core.arrays import Array, Bools, record
from ...core.checks import instance
from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface, SurfacePoints, axial_and_radial, points_at
from ..newton import complex_steps, solve
from ..vectors import dot
from .blank_section import BlankSection

JOINT_TOLERANCE = 1e-9  # [mm]


def deepest(
    parts: Sequence[GeneratingSurface], coordinates: Sequence[Array], depths: Sequence[Array]
) -> NDArray[np.int8]:
    """Index (n) of the flank part, ordered from the blade's tip upwards, that cuts deepest at each node.

    Depths (n) in any unit, NaN where a part has no point; where there is no flank, the index is that of such a part.
    """
    depth = np.stack([np.where(np.isfinite(d), d, -np.inf) for d in depths])
    within = np.stack(
        [
            (c <= part.section.end + JOINT_TOLERANCE) & ((index == 0) | (c >= part.section.begin - JOINT_TOLERANCE))
            for index, (part, c) in enumerate(zip(parts, coordinates, strict=True))
        ]
    )
    within &= np.isfinite(depth)
    # Where two sections join at a kink: beyond the end of the lower one, before the beginning of the upper one.
    beyond = np.stack([c > part.section.end for c, part in zip(coordinates, parts, strict=True)])
    before = np.stack([c < part.section.begin for c, part in zip(coordinates, parts, strict=True)])
    gap = np.isfinite(depth[:-1]) & np.isfinite(depth[1:]) & beyond[:-1] & before[1:]
    joint = np.zeros_like(within)
    joint[:-1] |= gap
    joint[1:] |= gap
    candidates = np.where(within | (joint & ~np.any(within, axis=0)), depth, -np.inf)
    missing = np.argmin(np.isfinite(depth), axis=0)
    chosen = np.where(np.any(np.isfinite(candidates), axis=0), np.argmax(candidates, axis=0), missing)
    return np.asarray(chosen, dtype=np.int8)


def pick(values: Sequence[Array], choice: NDArray[np.int8]) -> Array:
    """Take from k arrays (..., n), node by node, the one with the given index (n)."""
    picked = np.array(values[0])
    for index in range(1, len(values)):
        mask = choice == index
        picked[..., mask] = values[index][..., mask]
    return picked


def on_parts(
    parts: Sequence[GeneratingSurface],
    choice: NDArray[np.int8],
    parameters: Array,
    function: Callable[[GeneratingSurface, Array], Array],
) -> Array:
    """Evaluate a function (..., n) of the surface parameters (2, n), each node on its own part."""
    return pick([function(part, parameters) for part in parts], choice)


SEEDS = 25  # in either direction, the mean point in the middle
NEIGHBOURS = 9  # seeds near a target that are looked at
SHEET_DISTANCE = 4.0  # [seeds]; neighbours further apart than that lie on two sheets of a folded surface
STRAY_LIMIT = 6.0  # [seeds]; a solution further from its seed is not the one that was sought


@lru_cache(maxsize=64)
def mean_parameters(surface: GeneratingSurface, section: BlankSection) -> Array:
    """Parameters (2, 1) of the flank's mean point, on the blade's profile, searched over all cutter positions."""
    surface = surface.on("profile")
    target = section.points(np.array([0.5]), np.array([0.5]))
    depth = float(np.linalg.norm(section.corners[0, 1] - section.corners[0, 0]))
    # The blade's tip runs along the root cone: that tells how far up the blade the middle of the flank is cut, and with
    # it which of the cutter's several crossings with the blank is the tooth.
    expected = float(section.height_above_root(*target)[0]) / np.cos(surface.blade.pressure_angle)
    cutter_angle = np.linspace(-np.pi, np.pi, 91)
    second = np.linspace(-1.0, 1.0, 31) if surface.settings.generated else np.linspace(0.0, 3.0 * depth, 9)
    lattice = np.stack(np.meshgrid(cutter_angle, second, indexing="ij")).reshape(2, -1)
    with np.errstate(all="ignore"):
        position, _, distance = surface.evaluate(lattice)
        mismatch = np.hypot(position[2] - target[0], np.hypot(position[0], position[1]) - target[1])
        mismatch = mismatch + np.abs(distance - expected)
    candidates = np.flatnonzero(np.isfinite(mismatch))
    candidates = candidates[np.argsort(mismatch[candidates])[:24]]
    if candidates.size:
        start, wanted = lattice[:, candidates], np.repeat(target, candidates.size, 1)
        solution = solve(surface.axial_and_radial, start, wanted, surface.max_step)
        _, _, distance = surface.evaluate(solution.parameters)
        error = np.where(solution.converged, np.abs(distance - expected), np.inf)
        best = int(np.argmin(error))
        if error[best] < 1.5 * depth:
            parameters = _nearest_slot(surface, solution.parameters[:, [best]])
            parameters.setflags(write=False)  # remembered for the next caller
            return np.asarray(parameters)
    raise GeometryError(
        "these machine settings cut no tooth in this blank: the cutter does not pass through the middle of the face "
        f"(axial {target[0, 0]:.3f} mm, radial {target[1, 0]:.3f} mm); check radial_distance, cradle_angle, "
        "machine_root_angle, machine_center_to_crossing_point and the blank's cones"
    )


def _nearest_slot(surface: GeneratingSurface, parameters: Array) -> Array:
    """Same point (2, 1) in the slot nearest to the x axis: the flank must not depend on the slot that was found.

    A whole turn of a face-hobbing cutter leads to another slot of the same member.
    """
    if surface.settings.indexing_ratio == 0.0:
        return parameters
    turns = parameters + np.outer([2.0 * np.pi, 0.0], np.arange(-2, 3))
    position, _, _ = surface.evaluate(turns)
    return np.asarray(turns[:, [int(np.argmax(position[0]))]])


@dataclass(frozen=True)
class SeedLattice:
    """Surface parameters spread over the whole flank and somewhat beyond, as first guesses."""

    points: SurfacePoints  # the seeds (m), m = SEEDS^2
    side: Bools  # on the same side of the surface as the mean point (m)
    orientation: float
    step: Array

    def nearest(self, coordinates: Array, usable: Bools, target: Array) -> SurfacePoints:
        """Usable seeds (n) whose coordinates (2, m) lie nearest to each target (2, n); NaN if none is usable.

        An envelope that folds twice covers targets a second time, on the mean point's side again: of near seeds on two
        such sheets the one nearest to the mean point is taken.
        """
        from scipy.spatial import cKDTree

        kept = np.flatnonzero(usable & np.all(np.isfinite(coordinates), axis=0))
        if kept.size == 0:
            return self.points.at(np.zeros(target.shape[1], dtype=int)).moved(np.full(target.shape, np.nan))
        count = min(NEIGHBOURS, kept.size)
        _, seeds = cKDTree(coordinates[:, kept].T).query(target.T, k=count)
        seeds = kept[np.reshape(seeds, (target.shape[1], count))]
        places = np.stack(np.divmod(seeds, SEEDS)) - (SEEDS - 1) / 2.0
        apart = np.max(np.abs(places - places[:, :, :1]), axis=0)
        best = np.argmin(np.hypot(*places), axis=1)
        choice = np.where(np.any(apart > SHEET_DISTANCE, axis=1), best, 0)
        return self.points.at(seeds[np.arange(seeds.shape[0]), choice])

    def strayed(self, start: Array, solutions: Array) -> Bools:
        """True for solutions (2, n) so far from their starts (2, n) that they belong to another sheet."""
        return np.asarray(np.any(np.abs(solutions - start) > STRAY_LIMIT * self.step[:, None], axis=0))


@lru_cache(maxsize=64)
def seed_lattice(surface: GeneratingSurface, section: BlankSection) -> SeedLattice:
    """Seeds about the mean point of a flank; GeometryError if the cutter meets no tooth of this blank."""
    mean = mean_parameters(surface, section)
    corners = section.corners.reshape(4, 2)
    reach = float(np.max(np.linalg.norm(corners - corners.mean(axis=0), axis=1)))
    orientation = float(np.sign(surface.orientation(mean))[0])
    # Linear reach of each parameter, doubled: contact may use more than the blank, and the flank is curved.
    _, derivatives = complex_steps(surface.axial_and_radial, mean)
    span = 2.0 * reach * np.linalg.norm(np.linalg.inv(derivatives[:, :, 0].T), axis=1)
    span = np.minimum(span, surface.max_step * np.array([4.0, 6.0]))
    axes = [np.linspace(-s, s, SEEDS) + m for s, m in zip(span, mean[:, 0], strict=True)]
    lattice = np.stack(np.meshgrid(*axes, indexing="ij")).reshape(2, -1)
    with np.errstate(all="ignore"):
        points = SurfacePoints.of(surface, lattice)
        side = np.sign(points.orientation) == orientation
    for array in (lattice, points.values, points.slopes, side):
        array.setflags(write=False)  # remembered for the next caller
    return SeedLattice(points, side, orientation, 2.0 * span / (SEEDS - 1))


class NodeStatus(IntEnum):
    """Status of a flank node: usable, or why not; stored with CF ``flag_values`` and ``flag_meanings``."""

    INSIDE = 0
    NO_SOLUTION = 1
    UNDERCUT = 2
    BEYOND_BLADE_TIP = 3
    OUTSIDE_BLANK = 4


@record(frozen=True)
class Flank:
    """A flank on a set of nodes.

    Parameters
    ----------
    surface
        Its generating surface.
    parameters
        Surface parameters of the nodes (2, n).
    position
        Positions (3, n) in the member frame [mm].
    normal
        Outward unit normals (3, n).
    blade_distance
        Distance along the blade from the end of its edge radius (n) [mm].
    status
        ``NodeStatus`` of every node (n).
    part
        Which of the surface's ``flank_parts`` the node belongs to (n).

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> gear = geometry.members.gear
    >>> gear.position.shape, bool(gear.inside.all())
    ((3, 63), True)
    """

    surface: GeneratingSurface
    parameters: Array
    position: Array
    normal: Array
    blade_distance: Array
    status: NDArray[np.int8]
    part: NDArray[np.int8]
    ARRAYS: ClassVar = ("parameters", "position", "normal", "blade_distance", "status", "part")

    @property
    def inside(self) -> Bools:
        """True where the node is a usable point of the flank (n)."""
        return np.asarray(self.status == NodeStatus.INSIDE)


def solve_flank(surface: GeneratingSurface, section: BlankSection, axial: Array, radial: Array) -> Flank:
    """Flank at axial and radial coordinates (n) [mm], by Newton on all nodes; NaN and a status where unusable."""
    parts, flanks = surface.flank_parts, solve_parts(surface, section, axial, radial)
    if len(flanks) == 1:
        return flanks[0]
    # The deepest cut lies furthest into the tooth along the azimuth.
    azimuth = np.stack([np.arctan2(f.position[1], f.position[0]) for f in flanks])
    depths = np.full_like(azimuth, np.nan)
    if np.any(np.isfinite(azimuth)):
        turn = into_tooth(np.hstack([f.position for f in flanks]), np.hstack([f.normal for f in flanks]))
        depths = turn * np.mod(azimuth - np.nanmedian(azimuth) + np.pi, 2 * np.pi)
    choice = deepest(parts, [f.blade_distance for f in flanks], list(depths))
    picked = {name: pick([getattr(flank, name) for flank in flanks], choice) for name in Flank.ARRAYS}
    return Flank(surface, **picked | {"part": choice})


def solve_parts(surface: GeneratingSurface, section: BlankSection, axial: Array, radial: Array) -> tuple[Flank, ...]:
    """Every part of a flank by itself, as if its section of the blade had no ends; arguments as of ``solve_flank``."""
    target = np.stack([np.ravel(axial), np.ravel(radial)]).astype(float)
    return tuple(_solve_part(part, section, target) for part in surface.flank_parts)


def into_tooth(position: Array, normal: Array) -> float:
    """Sense of rotation about the axis from a flank into its tooth: the outward normals (3, ...) point against it."""
    return -float(np.sign(np.nanmedian(position[0] * normal[1] - position[1] * normal[0])))


def _solve_part(surface: GeneratingSurface, section: BlankSection, target: Array) -> Flank:
    """The surface that one section of the blade cuts, at all nodes, with a status for each."""
    seeds = seed_lattice(surface, section)
    start = seeds.nearest(axial_and_radial(seeds.points)[0], seeds.side, target)
    points, solution = points_at(axial_and_radial, surface, start, target)
    position, normal, distance = points.position, points.normal, points.coordinate
    side = points.orientation * seeds.orientation
    status = np.full(target.shape[1], NodeStatus.INSIDE, dtype=np.int8)
    status[distance < -1e-9] = NodeStatus.BEYOND_BLADE_TIP
    status[~(side > 0.0)] = NodeStatus.UNDERCUT
    status[~solution.converged | seeds.strayed(start.parameters, solution.parameters)] = NodeStatus.NO_SOLUTION
    unusable = (status == NodeStatus.NO_SOLUTION) | (status == NodeStatus.UNDERCUT)
    position, normal = np.where(unusable, np.nan, position), np.where(unusable, np.nan, normal)
    return Flank(surface, solution.parameters, position, normal, distance, status, np.zeros_like(status))


@record(frozen=True)
class Curvatures:
    """Principal curvatures of a flank at n nodes."""

    curvature: Array  # (2, n) [1/mm], the larger one first; positive where the tooth is convex
    direction: Array  # (3, n) of the first one, in the member's frame


def shape_operator(flank: Flank) -> tuple[Array, Array, Array]:
    """Tangents (3, 2, n) by both parameters, and first and second fundamental form (2, 2, n) of a flank.

    The second is taken with the inward normal, so that convex teeth have positive curvature.
    """
    parts, parameters = flank.surface.flank_parts, flank.parameters.reshape(2, -1)
    with np.errstate(all="ignore"):
        derivatives = on_parts(parts, flank.part.ravel(), parameters, lambda part, p: SurfacePoints.of(part, p).slopes)
    tangents, turning = derivatives[:, :3].swapaxes(0, 1), derivatives[:, 3:6].swapaxes(0, 1)
    first = np.einsum("ian,ibn->abn", tangents, tangents)
    second = np.einsum("ian,ibn->abn", turning, tangents)
    return tangents, first, 0.5 * (second + second.transpose(1, 0, 2))


def principal_curvatures(flank: Flank) -> Curvatures:
    """Principal curvatures and first principal direction of a flank at its nodes.

    Unusable nodes carry NaN.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> first, second = principal_curvatures(geometry.members.gear).curvature
    >>> bool((first > second).all())
    True
    """
    instance("flank", flank, Flank)
    tangents, first, second = shape_operator(flank)
    usable = np.all(np.isfinite(flank.normal.reshape(3, -1)), axis=0)
    usable &= np.all(np.isfinite(first) & np.isfinite(second), axis=(0, 1))
    identity = np.eye(2)[..., None]
    # Orthonormal tangent basis: with I = L L^T the operator L^-1 II L^-T is symmetric.
    inverse = np.linalg.inv(np.linalg.cholesky(np.where(usable, first, identity).transpose(2, 0, 1)))
    symmetric = inverse @ np.where(usable, second, identity).transpose(2, 0, 1) @ inverse.transpose(0, 2, 1)
    values, vectors = np.linalg.eigh(symmetric)
    direction = np.einsum("ian,an->in", tangents, np.einsum("nba,nb->an", inverse, vectors[:, :, 1]))
    with np.errstate(all="ignore"):
        direction = direction / np.sqrt(dot(direction, direction))
    blank = np.where(usable, 1.0, np.nan)
    return Curvatures(values[:, ::-1].T * blank, direction * blank)
