"""The generating surface of a flank: a blade on a machine, and the envelope of its motion.

A generated flank has the two parameters (cutter angle, cradle rotation); the blade coordinate follows from the
equation of meshing (Kolivand 2009, Eq. 2.8). A Formate flank is what the blade sweeps, with the parameters (cutter
angle, blade coordinate). Every section of the blade has its own surface.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ...core.checks import check_fields
from ..newton import complex_steps
from ..vectors import cos_sin, cross, dot
from .blade import Blade
from .blade_sections import BladeSection, SectionName
from .machine import IncrementSense, MachineSettings
from .machine_pose import MachinePose, machine_pose
from .meshing import Velocity, circular_edge, on_arc, straight_edge

Array = NDArray[Any]
Hand = Literal["left", "right"]


def area_ratio(first: Array, second: Array, normal: Array) -> Array:
    """Area per parameters (n), from the derivatives of points and outward normals (3, n): see ``orientation``."""
    return np.asarray(dot(cross(first[:3], second[:3]), normal))


@dataclass(frozen=True)
class GeneratingSurface:
    """Generating surface of one flank: blade, machine settings and hand of the member.

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
    part
        Section of the blade that cuts; the profile unless said.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("fm-11x41"))
    >>> gear = pair.gear.loaded
    >>> gear.settings.generated, gear.hand
    (False, 'right')
    >>> position, normal, _ = gear.evaluate(np.array([[1.0], [5.0]]))  # cutter angle [rad] and blade coordinate [mm]
    >>> round(float(np.linalg.norm(normal)), 12)
    1.0
    """

    blade: Blade
    settings: MachineSettings
    hand: Hand
    sense: IncrementSense
    part: SectionName = "profile"

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def section(self) -> BladeSection:
        """The section of the blade that cuts."""
        return self.blade.sections[self.part]

    def on(self, part: SectionName) -> GeneratingSurface:
        """The surface that another section of the same blade cuts."""
        return self if part == self.part else replace(self, part=part)

    @property
    def designed(self) -> GeneratingSurface:
        """The surface without deviation."""
        return self

    @property
    def flank_parts(self) -> tuple[GeneratingSurface, ...]:
        """Surfaces of the sections that cut the flank, all but the edge radius, from the tip of the blade upwards."""
        return tuple(self.on(name) for name in self.blade.sections if name != "edge")

    @np.errstate(all="ignore")
    def evaluate(self, parameters: Array) -> tuple[Array, Array, Array]:
        """Flank at given parameters; analytic, so that it can be differentiated by complex step.

        NaN where the blade has no point of the flank.

        Parameters
        ----------
        parameters
            Cutter angle [rad] and, generated, cradle rotation [rad] or, Formate, blade coordinate: (2, n).

        Returns
        -------
        tuple
            Position (3, n) [mm] and outward unit normal (3, n) in the member frame, and the blade coordinate (n): mm
            along it from the end of its edge radius, see ``blade_sections``.
        """
        pose, tip, plane, velocities = self._blade(parameters)
        point, edge, coordinate = self._on_blade(tip, plane, velocities, parameters[1])
        return (*self._in_member(pose, velocities[0], point, edge, parameters[0]), coordinate)

    @np.errstate(all="ignore")
    def at_coordinate(self, parameters: Array, coordinate: float) -> tuple[Array, Array, Array]:
        """A given point of the blade on a generated flank, and how far it is from touching the flank.

        For points where the contact line runs along the blade: there ``evaluate`` cannot tell its points apart.

        Parameters
        ----------
        parameters
            Cutter angle and cradle rotation (2, n) [rad].
        coordinate
            Blade coordinate, as ``evaluate`` returns it [mm].

        Returns
        -------
        tuple
            Position (3, n) [mm] and normal (3, n) in the member frame, and the velocity along the normal (n) [mm/rad]
            that the cradle's rotation gives the point: zero where the equation of meshing holds.
        """
        pose, tip, plane, velocities = self._blade(parameters)
        point, edge = self._given_point(tip, plane, np.full_like(parameters[1], coordinate))
        position, normal = self._in_member(pose, velocities[0], point, edge, parameters[0])
        spin, shift = velocities[1]
        across = cross(edge, cross(velocities[0][0], point) + velocities[0][1])
        return position, normal, dot(across, cross(spin, point) + shift) / np.sqrt(dot(across, across))

    def _blade(self, parameters: Array) -> tuple[MachinePose, Array, tuple[Array, Array], tuple[Velocity, Velocity]]:
        """Pose of the machine, tip of the blade, its plane, and the velocities of its points (3, n)."""
        cutter_angle, second = parameters
        cradle_rotation = second if self.settings.generated else np.zeros_like(second)
        pose = machine_pose(self.settings, cradle_rotation, self.sense)

        cosine, sine = cos_sin(cutter_angle)
        x_axis, y_axis, cutter_axis = pose.frame
        radial, tangential = x_axis * cosine + y_axis * sine, y_axis * cosine - x_axis * sine

        def seen(r: float, t: float, z: float) -> Array:
            return np.asarray(r * radial + t * tangential + z * cutter_axis)

        tip = pose.center + seen(*self.blade.tip, 0.0)
        outward, upward = (seen(*vector) for vector in self.blade.plane)

        # Velocity of a blade point relative to the work, by the cutter angle, as spin x point + shift.
        indexing = self.settings.indexing_ratio
        spin = cutter_axis + indexing * pose.axis
        shift = -cross(cutter_axis, pose.center) - indexing * cross(pose.axis, pose.origin)
        return pose, tip, (outward, upward), ((spin, shift), (pose.spin, pose.shift))

    def _in_member(
        self, pose: MachinePose, by_cutter: Velocity, point: Array, edge: Array, cutter_angle: Array
    ) -> tuple[Array, Array]:
        """Position [mm] and outward unit normal (3, n) in the member frame of a point of the blade."""
        spin, shift = by_cutter
        normal = -self.blade.side_sign * cross(edge, cross(spin, point) + shift)
        normal = normal / np.sqrt(dot(normal, normal))

        turned = -self.settings.indexing_ratio * cutter_angle
        position, normal = pose.both_to_member(point, normal, turned)
        if self.hand == "left":
            position[1], normal[1] = -position[1], -normal[1]
        return position, normal

    def _given_point(self, tip: Array, plane: tuple[Array, Array], coordinate: Array) -> tuple[Array, Array]:
        """Point of the blade [mm] at a coordinate, and direction of the edge there (3, n)."""
        section, (outward, upward) = self.section, plane
        if section.radius is None:
            along_outward, along_upward = math.sin(section.angle), math.cos(section.angle)
            edge = along_outward * outward + along_upward * upward
            origin = tip + (section.outward - section.begin * along_outward) * outward
            origin = origin + (section.height - section.begin * along_upward) * upward
            return origin + coordinate * edge, edge
        middle, middle_angle = section.point(section.middle), section.angle_at(section.middle)
        origin = tip + middle[0] * outward + middle[1] * upward
        return on_arc(origin, section.radius, plane, middle_angle, section.rate * (coordinate - section.middle))

    def _on_blade(
        self, tip: Array, plane: tuple[Array, Array], velocities: tuple[Velocity, Velocity], coordinate: Array
    ) -> tuple[Array, Array, Array]:
        """Point of the blade that cuts [mm], direction of the edge there (3, n), and blade coordinate (n).

        Generated, the equation of meshing gives the coordinate; Formate, it is the one asked for.
        """
        section, (outward, upward) = self.section, plane
        if section.radius is None:
            along_outward, along_upward = math.sin(section.angle), math.cos(section.angle)
            edge = along_outward * outward + along_upward * upward
            origin = tip + (section.outward - section.begin * along_outward) * outward
            origin = origin + (section.height - section.begin * along_upward) * upward
            if self.settings.generated:
                coordinate = straight_edge(origin, edge, *velocities)
            return origin + coordinate * edge, edge, coordinate
        middle, middle_angle = section.point(section.middle), section.angle_at(section.middle)
        origin = tip + middle[0] * outward + middle[1] * upward
        if self.settings.generated:
            turn = circular_edge(origin, section.radius, plane, *velocities, middle_angle)
            coordinate = section.middle + turn / section.rate
        else:
            turn = section.rate * (coordinate - section.middle)
        point, edge = on_arc(origin, section.radius, plane, middle_angle, turn)
        return point, edge, coordinate

    def axial_and_radial(self, parameters: Array) -> Array:
        """Axial and radial coordinates (2, n) [mm] of the flank at given parameters (2, n)."""
        position, _, _ = self.evaluate(parameters)
        return np.stack([position[2], np.sqrt(position[0] ** 2 + position[1] ** 2)])

    @property
    def max_step(self) -> Array:
        """Largest Newton step of the two parameters."""
        within_edge = self.part == "edge"
        return np.array([0.2, 0.2 if self.settings.generated or within_edge else 0.2 * self.blade.point_radius])

    def orientation(self, parameters: Array) -> Array:
        """Signed area ratio of the parametrisation (n): it changes sign where the flank is undercut."""

        def position_and_normal(p: Array) -> Array:
            return np.concatenate(self.evaluate(p)[:2])

        value, (first, second) = complex_steps(position_and_normal, parameters)
        return area_ratio(first, second, value[3:])
