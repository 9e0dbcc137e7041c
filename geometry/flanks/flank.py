"""A tooth flank on a set of nodes: positions and normals at given axial and radial coordinates, each with a status."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from ..cutting.generating_surface import GeneratingSurface
from ..cutting.surface_points import axial_and_radial, points_at
from .blank_section import BlankSection
from .flank_parts import deepest, pick
from .seed_lattice import seed_lattice

Array = NDArray[Any]


class NodeStatus(IntEnum):
    """Status of a flank node: usable, or why not; stored with CF ``flag_values`` and ``flag_meanings``.

    Examples
    --------
    >>> NodeStatus(2).name
    'UNDERCUT'
    """

    INSIDE = 0
    NO_SOLUTION = 1
    UNDERCUT = 2
    BEYOND_BLADE_TIP = 3
    OUTSIDE_BLANK = 4


@frozen_arrays
@dataclass(frozen=True)
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

    @property
    def inside(self) -> NDArray[np.bool_]:
        """Where the node is a usable point of the flank (n)."""
        return np.asarray(self.status == NodeStatus.INSIDE)

    def reshape(self, *shape: int) -> Flank:
        """The same nodes in another arrangement."""
        return replace(
            self,
            parameters=self.parameters.reshape(2, *shape),
            position=self.position.reshape(3, *shape),
            normal=self.normal.reshape(3, *shape),
            blade_distance=self.blade_distance.reshape(shape),
            status=self.status.reshape(shape),
            part=self.part.reshape(shape),
        )


def solve_flank(surface: GeneratingSurface, section: BlankSection, axial: Array, radial: Array) -> Flank:
    """Flank at the nodes with given axial and radial coordinates, by Newton on all nodes at once.

    Parameters
    ----------
    surface
        Generating surface of the flank.
    section
        The blank; it locates the tooth and supplies the first guesses.
    axial, radial
        Coordinates of the nodes about the member's axis (n) [mm].

    Returns
    -------
    Flank
        Nodes that cannot be used carry NaN and a status that says why.

    Raises
    ------
    GeometryError
        If the cutter meets no tooth of this blank.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> axial, radial = pair.gear.section.points(np.array([0.5]), np.array([0.5]))
    >>> gear = solve_flank(pair.gear.loaded, pair.gear.section, axial, radial)
    >>> np.allclose(gear.position[2], axial), np.allclose(np.hypot(*gear.position[:2]), radial)
    (True, True)
    """
    parts, flanks = surface.flank_parts, solve_parts(surface, section, axial, radial)
    if len(flanks) == 1:
        return flanks[0]
    # The deepest cut lies furthest into the tooth along the azimuth.
    azimuth = np.stack([np.arctan2(f.position[1], f.position[0]) for f in flanks])
    depths = np.full_like(azimuth, np.nan)
    if np.any(np.isfinite(azimuth)):
        turn = into_tooth(
            *(np.concatenate(v, axis=1) for v in zip(*((f.position, f.normal) for f in flanks), strict=True))
        )
        depths = turn * np.mod(azimuth - np.nanmedian(azimuth) + np.pi, 2 * np.pi)
    choice = deepest(parts, [f.blade_distance for f in flanks], list(depths))
    return Flank(
        surface,
        pick([f.parameters for f in flanks], choice),
        pick([f.position for f in flanks], choice),
        pick([f.normal for f in flanks], choice),
        pick([f.blade_distance for f in flanks], choice),
        pick([f.status for f in flanks], choice),
        choice,
    )


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
    points, found = points_at(axial_and_radial, surface, start, target)
    position, normal, distance = points.position, points.normal, points.coordinate
    side = points.orientation * seeds.orientation
    status = np.full(target.shape[1], NodeStatus.INSIDE, dtype=np.int8)
    status[distance < -1e-9] = NodeStatus.BEYOND_BLADE_TIP
    status[~(side > 0.0)] = NodeStatus.UNDERCUT
    status[~found.converged | seeds.strayed(start.parameters, found.parameters)] = NodeStatus.NO_SOLUTION
    unusable = (status == NodeStatus.NO_SOLUTION) | (status == NodeStatus.UNDERCUT)
    position, normal = np.where(unusable, np.nan, position), np.where(unusable, np.nan, normal)
    return Flank(surface, found.parameters, position, normal, distance, status, np.zeros(status.shape, dtype=np.int8))
