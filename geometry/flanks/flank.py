"""A tooth flank on a set of nodes: positions and normals at given axial and radial coordinates, each with a status."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..newton import complex_steps, solve
from .blank_section import BlankSection
from .flank_parts import deepest, pick

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


@lru_cache(maxsize=64)
def mean_parameters(surface: GeneratingSurface, section: BlankSection) -> Array:
    """Parameters (2, 1) of the flank's mean point, on the blade's profile, searched over every position of the cutter.

    Raises
    ------
    GeometryError
        If the cutter meets no tooth of this blank.
    """
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
        found = solve(
            surface.axial_and_radial, lattice[:, candidates], np.repeat(target, candidates.size, 1), surface.max_step
        )
        _, _, distance = surface.evaluate(found.parameters)
        error = np.where(found.converged, np.abs(distance - expected), np.inf)
        best = int(np.argmin(error))
        if error[best] < 1.5 * depth:
            parameters = _nearest_slot(surface, found.parameters[:, [best]])
            parameters.setflags(write=False)  # remembered for the next caller
            return np.asarray(parameters)
    raise GeometryError(
        "these machine settings cut no tooth in this blank: the cutter does not pass through the middle of the face "
        f"(axial {target[0, 0]:.3f} mm, radial {target[1, 0]:.3f} mm); check radial_distance, cradle_angle, "
        "machine_root_angle, machine_center_to_crossing_point and the blank's cones"
    )


def _nearest_slot(surface: GeneratingSurface, parameters: Array) -> Array:
    """The same point (2, 1) in the slot nearest to the x axis.

    A whole turn of a face-hobbing cutter leads to another slot of the same member. Which one a search comes upon is
    chance, and the flank must not depend on it.
    """
    if surface.settings.indexing_ratio == 0.0:
        return parameters
    turns = parameters + np.outer([2.0 * np.pi, 0.0], np.arange(-2, 3))
    position, _, _ = surface.evaluate(turns)
    return np.asarray(turns[:, [int(np.argmax(position[0]))]])


@lru_cache(maxsize=64)
def seed_lattice(surface: GeneratingSurface, section: BlankSection) -> tuple[Array, float]:
    """Surface parameters spread over the whole flank and somewhat beyond, as first guesses.

    Parameters
    ----------
    surface
        Generating surface of the flank.
    section
        The blank.

    Returns
    -------
    tuple
        Parameters (2, m) on the same side of the surface as the mean point, and that side's orientation sign.

    Raises
    ------
    GeometryError
        If the cutter meets no tooth of this blank.
    """
    mean = mean_parameters(surface, section)
    corners = section.corners.reshape(4, 2)
    reach = float(np.max(np.linalg.norm(corners - corners.mean(axis=0), axis=1)))
    orientation = float(np.sign(surface.orientation(mean))[0])
    # Linear reach of each parameter, doubled: contact may use more than the blank, and the flank is curved.
    _, derivatives = complex_steps(surface.axial_and_radial, mean)
    inverse = np.linalg.inv(derivatives[:, :, 0].T)
    span = 2.0 * reach * np.linalg.norm(inverse, axis=1)
    span = np.minimum(span, surface.max_step * np.array([4.0, 6.0]))
    axes = [np.linspace(-s, s, 25) + m for s, m in zip(span, mean[:, 0], strict=True)]
    lattice = np.stack(np.meshgrid(*axes, indexing="ij")).reshape(2, -1)
    with np.errstate(all="ignore"):
        lattice = lattice[:, np.sign(surface.orientation(lattice)) == orientation]
    lattice.setflags(write=False)  # remembered for the next caller
    return lattice, orientation


def nearest_seeds(coordinates: Array, lattice: Array, target: Array) -> Array:
    """Lattice parameters (2, n) whose coordinates (2, m) lie nearest to each target (2, n)."""
    usable = np.all(np.isfinite(coordinates), axis=0)
    _, index = cKDTree(coordinates[:, usable].T).query(target.T)
    return np.asarray(lattice[:, usable][:, index])


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
    target = np.stack([np.ravel(axial), np.ravel(radial)]).astype(float)
    parts = surface.flank_parts
    flanks = [_solve_part(part, section, target) for part in parts]
    if len(flanks) == 1:
        return flanks[0]
    # The deepest cut lies furthest into the tooth along the azimuth.
    front = flanks[[part.part for part in parts].index("profile")]
    turn = into_tooth(front.position, front.normal)
    azimuth = [np.arctan2(f.position[1], f.position[0]) for f in flanks]
    reference = np.nanmedian(azimuth[0])
    depths = [turn * (np.mod(a - reference + np.pi, 2 * np.pi)) for a in azimuth]
    choice = deepest(parts, [f.blade_distance for f in flanks], depths)
    return Flank(
        surface,
        pick([f.parameters for f in flanks], choice),
        pick([f.position for f in flanks], choice),
        pick([f.normal for f in flanks], choice),
        pick([f.blade_distance for f in flanks], choice),
        pick([f.status for f in flanks], choice),
        choice,
    )


def into_tooth(position: Array, normal: Array) -> float:
    """Sense of rotation about the axis from a flank into its tooth: the outward normals (3, ...) point against it."""
    return -float(np.sign(np.nanmedian(position[0] * normal[1] - position[1] * normal[0])))


def _solve_part(surface: GeneratingSurface, section: BlankSection, target: Array) -> Flank:
    """The surface that one section of the blade cuts, at all nodes, with a status for each."""
    lattice, orientation = seed_lattice(surface, section)
    start = nearest_seeds(surface.axial_and_radial(lattice), lattice, target)
    found = solve(surface.axial_and_radial, start, target, surface.max_step)
    with np.errstate(all="ignore"):
        position, normal, distance = surface.evaluate(found.parameters)
        side = surface.orientation(found.parameters) * orientation
    status = np.full(target.shape[1], NodeStatus.INSIDE, dtype=np.int8)
    status[distance < -1e-9] = NodeStatus.BEYOND_BLADE_TIP
    status[~(side > 0.0)] = NodeStatus.UNDERCUT
    status[~found.converged] = NodeStatus.NO_SOLUTION
    unusable = (status == NodeStatus.NO_SOLUTION) | (status == NodeStatus.UNDERCUT)
    position, normal = np.where(unusable, np.nan, position), np.where(unusable, np.nan, normal)
    return Flank(surface, found.parameters, position, normal, distance, status, np.zeros(status.shape, dtype=np.int8))
