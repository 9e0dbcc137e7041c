"""A tooth flank as the envelope of the cutter: positions and normals at given axial and radial coordinates.

A generated flank has the two parameters (cutter angle, cradle rotation); the distance along the blade follows from
the equation of meshing in closed form (Kolivand 2009, Eq. 2.8). A Formate flank is the cutter cone itself, with the
parameters (cutter angle, distance along the blade).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum
from functools import cached_property, lru_cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..core.errors import GeometryError
from .blade import Blade
from .machine import (
    IncrementSense,
    MachineSettings,
    cutter_frame,
    machine_to_member,
    work_axis,
    work_rotation,
)
from .newton import complex_step, solve
from .section import BlankSection
from .vectors import column, cos_sin, cross, dot, rotate_z

Array = NDArray[Any]
Hand = Literal["left", "right"]


class NodeStatus(IntEnum):
    """Why a node of a flank can or cannot be used; stored with CF ``flag_values`` and ``flag_meanings``."""

    INSIDE = 0
    NO_SOLUTION = 1
    UNDERCUT = 2
    BEYOND_BLADE_TIP = 3
    OUTSIDE_BLANK = 4


@dataclass(frozen=True)
class GeneratingSurface:
    """What cuts one flank: a blade, the machine that carries it, and the hand of the member.

    Parameters
    ----------
    blade
        The cutter blade.
    settings
        The machine settings.
    hand
        Hand of spiral of the member; a left-hand flank is the mirror image (y to -y) of the right-hand one.
    sense
        Sense of the cradle increment, see ``machine.IncrementSense``.
    """

    blade: Blade
    settings: MachineSettings
    hand: Hand
    sense: IncrementSense

    @cached_property
    def _frame(self) -> Array:
        return cutter_frame(self.settings)

    def _blade_in_cradle(self, cutter_angle: Array) -> tuple[Array, Array, Array]:
        """Cone normal, blade direction and blade tip (3, n) in the frame that turns with the cradle."""
        cosine, sine = cos_sin(cutter_angle)
        x_axis, y_axis, axis = (column(self._frame[:, i], cosine[None]) for i in range(3))
        radial = x_axis * cosine + y_axis * sine
        (normal_r, normal_z), (edge_r, edge_z) = self.blade.normal, self.blade.edge
        center = column(np.array([self.settings.radial_distance, 0.0, 0.0]), cosine[None])
        tip = center + self.blade.point_radius * radial
        return normal_r * radial + normal_z * axis, edge_r * radial + edge_z * axis, tip

    def _edge_distance(self, blade: tuple[Array, Array, Array], cradle_rotation: Array) -> Array:
        """Distance along the blade [mm] where the generated flank touches it, from the equation of meshing.

        The cone normal is constant along the edge and the relative velocity is linear in the distance, so the
        condition normal . velocity = 0 is linear too (its other solution is always the apex of the cone).
        """
        normal, edge, tip = blade
        direction, crossing_point = work_axis(self.settings)
        _, ratio = work_rotation(self.settings, cradle_rotation, self.sense)
        # The work axis seen from the cradle; the relative velocity is that of the cradle less that of the work.
        back = -(self.settings.cradle_angle + cradle_rotation)
        axis, origin = rotate_z(back, tuple(direction)), rotate_z(back, tuple(crossing_point))
        spin = -ratio * axis
        spin[2] += 1.0
        shift = ratio * cross(axis, origin)
        return np.asarray(-dot(normal, cross(spin, tip) + shift) / dot(normal, cross(spin, edge)))

    def evaluate(self, parameters: Array) -> tuple[Array, Array, Array]:
        """Flank at given parameters; analytic, so that it can be differentiated by complex step.

        Parameters
        ----------
        parameters
            Cutter angle [rad] and, generated, cradle rotation [rad] or, Formate, distance along the blade [mm]: (2, n).

        Returns
        -------
        tuple
            Position (3, n) [mm] and outward unit normal (3, n) in the member frame, distance along the blade (n) [mm].
        """
        cutter_angle, second = parameters
        blade = self._blade_in_cradle(cutter_angle)
        if self.settings.generated:
            cradle_rotation, distance = second, self._edge_distance(blade, second)
        else:
            cradle_rotation, distance = np.zeros_like(second), second
        normal, edge, tip = blade
        cradle = self.settings.cradle_angle + cradle_rotation
        rotation, _ = work_rotation(self.settings, cradle_rotation, self.sense)
        position = machine_to_member(self.settings, rotation, rotate_z(cradle, tip + distance * edge), point=True)
        normal = machine_to_member(self.settings, rotation, rotate_z(cradle, normal), point=False)
        if self.hand == "left":
            position[1], normal[1] = -position[1], -normal[1]
        return position, normal, distance

    def axial_and_radial(self, parameters: Array) -> Array:
        """Axial and radial coordinates (2, n) [mm] of the flank at given parameters (2, n)."""
        position, _, _ = self.evaluate(parameters)
        return np.stack([position[2], np.sqrt(position[0] ** 2 + position[1] ** 2)])

    @property
    def max_step(self) -> Array:
        """Largest Newton step of the two parameters."""
        return np.array([0.2, 0.2 if self.settings.generated else 0.2 * self.blade.point_radius])

    def orientation(self, parameters: Array) -> Array:
        """Signed area ratio of the parametrisation (n): it changes sign where the flank is undercut."""

        def position(p: Array) -> Array:
            return self.evaluate(p)[0]

        _, first = complex_step(position, parameters, 0)
        _, second = complex_step(position, parameters, 1)
        _, normal, _ = self.evaluate(parameters)
        return np.asarray(dot(cross(first, second), normal))


@dataclass(frozen=True)
class Flank:
    """A flank on a set of nodes.

    Parameters
    ----------
    surface
        What generates it.
    parameters
        Surface parameters of the nodes (2, n).
    position
        Positions (3, n) in the member frame [mm].
    normal
        Outward unit normals (3, n).
    blade_distance
        Distance along the blade from its tip (n) [mm].
    status
        ``NodeStatus`` of every node (n).
    orientation
        Sign of the valid side of the surface, see ``GeneratingSurface.orientation``.
    """

    surface: GeneratingSurface
    parameters: Array
    position: Array
    normal: Array
    blade_distance: Array
    status: NDArray[np.int8]
    orientation: float

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
        )


@lru_cache(maxsize=64)
def mean_parameters(surface: GeneratingSurface, section: BlankSection) -> Array:
    """Parameters (2, 1) of the flank's mean point, searched over every position of the cutter.

    Raises
    ------
    GeometryError
        If the cutter meets no tooth of this blank.
    """
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
            parameters = found.parameters[:, [best]]
            parameters.setflags(write=False)  # remembered for the next caller
            return np.asarray(parameters)
    raise GeometryError(
        "these machine settings cut no tooth in this blank: the cutter does not pass through the middle of the face "
        f"(axial {target[0, 0]:.3f} mm, radial {target[1, 0]:.3f} mm); check radial_distance, cradle_angle, "
        "machine_root_angle, machine_center_to_crossing_point and the blank's cones"
    )


def seed_lattice(surface: GeneratingSurface, section: BlankSection, mean: Array) -> tuple[Array, Array]:
    """Surface parameters spread over the whole flank and somewhat beyond, as first guesses.

    Parameters
    ----------
    surface
        What generates the flank.
    section
        The blank.
    mean
        Parameters of the mean point (2, 1).

    Returns
    -------
    tuple
        Parameters (2, m) on the same side of the surface as the mean point, and that side's orientation sign.
    """
    corners = section.corners.reshape(4, 2)
    reach = float(np.max(np.linalg.norm(corners - corners.mean(axis=0), axis=1)))
    orientation = float(np.sign(surface.orientation(mean))[0])
    # Linear reach of each parameter, doubled: contact may use more than the blank, and the flank is curved.
    _, first = complex_step(surface.axial_and_radial, mean, 0)
    _, second = complex_step(surface.axial_and_radial, mean, 1)
    inverse = np.linalg.inv(np.stack([first[:, 0], second[:, 0]], axis=1))
    span = 2.0 * reach * np.linalg.norm(inverse, axis=1)
    span = np.minimum(span, surface.max_step * np.array([4.0, 6.0]))
    axes = [np.linspace(-s, s, 25) + m for s, m in zip(span, mean[:, 0], strict=True)]
    lattice = np.stack(np.meshgrid(*axes, indexing="ij")).reshape(2, -1)
    with np.errstate(all="ignore"):
        keep = np.sign(surface.orientation(lattice)) == orientation
    return lattice[:, keep], np.array(orientation)


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
        What generates the flank.
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
    """
    target = np.stack([np.ravel(axial), np.ravel(radial)]).astype(float)
    mean = mean_parameters(surface, section)
    lattice, orientation = seed_lattice(surface, section, mean)
    start = nearest_seeds(surface.axial_and_radial(lattice), lattice, target)
    found = solve(surface.axial_and_radial, start, target, surface.max_step)
    return _classified(surface, found.parameters, found.converged, float(orientation))


def _classified(
    surface: GeneratingSurface, parameters: Array, converged: NDArray[np.bool_], orientation: float
) -> Flank:
    """Attach a status to every node and blank out those that are no points of the flank."""
    with np.errstate(all="ignore"):
        position, normal, distance = surface.evaluate(parameters)
        side = surface.orientation(parameters) * orientation
    status = np.full(parameters.shape[1], NodeStatus.INSIDE, dtype=np.int8)
    status[distance < -1e-9] = NodeStatus.BEYOND_BLADE_TIP
    status[~(side > 0.0)] = NodeStatus.UNDERCUT
    status[~converged] = NodeStatus.NO_SOLUTION
    unusable = (status == NodeStatus.NO_SOLUTION) | (status == NodeStatus.UNDERCUT)
    position, normal = np.where(unusable, np.nan, position), np.where(unusable, np.nan, normal)
    return Flank(surface, parameters, position, normal, distance, status, orientation)
