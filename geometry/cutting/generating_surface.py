"""The generating surface of a flank: a blade on a machine, and the envelope of its motion.

A generated flank has the two parameters (cutter angle, cradle rotation); the blade coordinate follows from the
equation of meshing (Kolivand 2009, Eq. 2.8). A Formate flank is what the blade sweeps, with the parameters (cutter
angle, blade coordinate). Every section of the blade has its own surface.

By that equation the edge, the velocity of its point by the cutter's turning and that by the cradle's lie in one plane
where the blade touches the flank. A velocity by a rotation is given as (spin, shift): velocity = spin x point + shift.

Cutting a point is the costly part of every flank: here it is done once a point, with its derivatives, which tell
everything that depends on the place of the surface in space.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from ...core.arrays import Array, Integers, record
from ...core.checks import check_fields
from ..newton import NewtonResult, complex_steps, solve_by
from ..vectors import cos_sin, cross, dot
from .blade import Blade, BladeSection, SectionName
from .machine import IncrementSense, MachinePose, MachineSettings, machine_pose

Velocity = tuple[Array, Array]

ITERATION_LIMIT = 12  # from a start within a few degrees; five are usual
FLAT_TURN_LIMIT = 0.2  # [rad] an arc and its tangent are near enough up to here


def _of(velocity: Velocity, point: Array) -> Array:
    return cross(velocity[0], point) + velocity[1]


def straight_edge(origin: Array, edge: Array, by_cutter: Velocity, by_cradle: Velocity) -> Array:
    """Distance from the origin along a straight edge, a unit vector (3, n), to the touched point (n) [mm].

    Both velocities are linear in it, so the condition is quadratic. Its other root is far away: for a face-milling
    cutter it is always the apex of the cone.
    """
    at_origin = [_of(velocity, origin) for velocity in (by_cutter, by_cradle)]
    along = [cross(spin, edge) for spin, _ in (by_cutter, by_cradle)]
    constant = dot(edge, cross(at_origin[0], at_origin[1]))
    linear = dot(edge, cross(along[0], at_origin[1]) + cross(at_origin[0], along[1]))
    quadratic = dot(edge, cross(along[0], along[1]))
    root = np.sqrt(linear * linear - 4.0 * constant * quadratic)
    return np.asarray(-2.0 * constant / (linear + np.sign(linear.real) * root))


@dataclass(frozen=True, eq=False)
class Arc:
    """Circular edge of a blade. The radius is positive with the centre in the metal, or zero."""

    middle: Array  # (3, n) [mm]
    radius: float
    plane: tuple[Array, Array]  # outward, and to the shank (3, n)
    angle: float  # of the edge in its middle, against the cutter axis

    @property
    def real(self) -> Arc:
        """The arc without an imaginary part."""
        outward, upward = self.plane
        return Arc(self.middle.real, self.radius, (outward.real, upward.real), self.angle)

    def at(self, turn: Array) -> tuple[Array, Array]:
        """Point [mm] and direction (3, n) at ``turn`` (n) [rad] of the direction from the middle.

        The point lies on the chord, whose direction is that of the edge half way: exact for a radius of any size.
        """
        outward, upward = self.plane
        _, half_sine = cos_sin(0.5 * turn)
        cosine, sine = cos_sin(self.angle + 0.5 * turn)
        chord = sine * outward + cosine * upward
        end_cosine, end_sine = cos_sin(self.angle + turn)
        return self.middle + 2.0 * self.radius * half_sine * chord, end_sine * outward + end_cosine * upward

    def touched(self, by_cutter: Velocity, by_cradle: Velocity) -> Array:
        """Turn (n) [rad] from the middle to the touched point, the one nearest to the middle.

        In closed form for face milling, by Newton from there for face hobbing.
        """
        velocities = [(spin.real, shift.real) for spin, shift in (by_cutter, by_cradle)]
        arc = self.real
        turn = arc._start(velocities)
        for _ in range(ITERATION_LIMIT):
            step = arc._newton_step(velocities, turn)
            turn = turn + step
            if not np.any(np.abs(step) > 1e-14):
                break
        # One more step in the possibly complex data carries the derivatives.
        return np.asarray(turn + self._newton_step([by_cutter, by_cradle], turn))

    def _start(self, velocities: list[Velocity]) -> Array:
        """Solution with the cutting velocity of the middle of the arc; for a flat arc, that of its tangent there."""
        outward, upward = self.plane
        sine, cosine = np.sin(self.angle), np.cos(self.angle)
        center = self.middle + self.radius * (cosine * outward - sine * upward)
        cutting, rolling = _of(velocities[0], self.middle), _of(velocities[1], center)
        angle = np.arctan2(-dot(rolling, cross(upward, cutting)), dot(rolling, cross(outward, cutting)))
        turn = np.mod(angle - self.angle + np.pi / 2, np.pi) - np.pi / 2
        if self.radius != 0.0:
            along_tangent = straight_edge(self.middle, sine * outward + cosine * upward, *velocities) / self.radius
            turn = np.where(np.abs(along_tangent) < FLAT_TURN_LIMIT, along_tangent, turn)
        return np.asarray(turn)

    def _newton_step(self, velocities: list[Velocity], turn: Array) -> Array:
        point, edge = self.at(turn)
        cosine, sine = cos_sin(self.angle + turn)
        inward = sine * self.plane[1] - cosine * self.plane[0]
        cutting, rolling = (_of(velocity, point) for velocity in velocities)
        plane_normal = cross(cutting, rolling)
        value = dot(edge, plane_normal)
        changes = cross(cross(velocities[0][0], edge), rolling) + cross(cutting, cross(velocities[1][0], edge))
        return np.asarray(-value / (self.radius * dot(edge, changes) - dot(inward, plane_normal)))


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

    def rounded(self, radius: float) -> GeneratingSurface:
        """The same flank with another edge radius of its blade [mm]."""
        return replace(self, blade=replace(self.blade, edge_radius=radius))

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
        meshing = velocities if self.settings.generated else None
        point, edge, coordinate = self._on_blade(tip, plane, parameters[1], meshing)
        return (*self._in_member(pose, velocities[0], point, edge, parameters[0]), coordinate)

    def rows(self, parameters: Array) -> Array:
        """Results of ``evaluate`` as one array (7, n)."""
        position, normal, coordinate = self.evaluate(parameters)
        return np.concatenate([position, normal, coordinate[None]])

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
        point, edge, _ = self._on_blade(tip, plane, np.full_like(parameters[1], coordinate))
        position, normal = self._in_member(pose, velocities[0], point, edge, parameters[0])
        across = cross(edge, _of(velocities[0], point))
        return position, normal, dot(across, _of(velocities[1], point)) / np.sqrt(dot(across, across))

    def _blade(self, parameters: Array) -> tuple[MachinePose, Array, tuple[Array, Array], tuple[Velocity, Velocity]]:
        """Pose of the machine, tip of the blade, its plane, and the velocities of its points (3, n)."""
        cutter_angle, second = parameters
        pose = machine_pose(self.settings, second if self.settings.generated else np.zeros_like(second), self.sense)

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
        normal = -self.blade.side_sign * cross(edge, _of(by_cutter, point))
        normal = normal / np.sqrt(dot(normal, normal))
        position, normal = pose.both_to_member(point, normal, -self.settings.indexing_ratio * cutter_angle)
        if self.hand == "left":
            position[1], normal[1] = -position[1], -normal[1]
        return position, normal

    def _on_blade(
        self,
        tip: Array,
        plane: tuple[Array, Array],
        coordinate: Array,
        velocities: tuple[Velocity, Velocity] | None = None,
    ) -> tuple[Array, Array, Array]:
        """Point of the blade [mm], direction of the edge there (3, n), and blade coordinate (n).

        With velocities the equation of meshing gives the coordinate; without it is the one asked for.
        """
        section, (outward, upward) = self.section, plane
        if section.radius is None:
            along_outward, along_upward = math.sin(section.angle), math.cos(section.angle)
            edge = along_outward * outward + along_upward * upward
            origin = tip + (section.outward - section.begin * along_outward) * outward
            origin = origin + (section.height - section.begin * along_upward) * upward
            if velocities is not None:
                coordinate = straight_edge(origin, edge, *velocities)
            return origin + coordinate * edge, edge, coordinate
        middle, middle_angle = section.point(section.middle), section.angle_at(section.middle)
        arc = Arc(tip + middle[0] * outward + middle[1] * upward, section.radius, plane, middle_angle)
        if velocities is None:
            return (*arc.at(section.rate * (coordinate - section.middle)), coordinate)
        turn = arc.touched(*velocities)
        return (*arc.at(turn), section.middle + turn / section.rate)

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
        return SurfacePoints.of(self, parameters).orientation


Flanks = tuple[GeneratingSurface, GeneratingSurface]  # convex and concave of a gear
Locate = Callable[["SurfacePoints"], tuple[Array, Array]]
LINEAR_STEP = 1e-11  # of the longest step; along so short a one a point and its tangents are followed linearly


@record(frozen=True)
class SurfacePoints:
    """Points of a generating surface (n) in the member's frame."""

    parameters: Array
    values: Array  # (7, n) position [mm], outward normal, blade coordinate [mm]
    slopes: Array  # (2, 7, n) by both parameters

    @classmethod
    def of(cls, surface: GeneratingSurface, parameters: Array) -> SurfacePoints:
        """Points at given parameters (2, n)."""
        return cls(parameters, *complex_steps(surface.rows, parameters))

    @property
    def position(self) -> Array:
        """Positions (3, n) [mm]."""
        return self.values[:3]

    @property
    def normal(self) -> Array:
        """Outward unit normals (3, n)."""
        return self.values[3:6]

    @property
    def coordinate(self) -> Array:
        """Blade coordinate (n) [mm]."""
        return np.asarray(self.values[6])

    @property
    def orientation(self) -> Array:
        """Signed area ratio (n), as ``GeneratingSurface.orientation``."""
        return area_ratio(self.slopes[0], self.slopes[1], self.normal)

    def at(self, chosen: Any) -> SurfacePoints:
        """Some of the points."""
        return SurfacePoints(self.parameters[:, chosen], self.values[:, chosen], self.slopes[..., chosen])

    def moved(self, step: Array) -> SurfacePoints:
        """The points after so short a step of the parameters (2, n) that it is linear."""
        return SurfacePoints(
            self.parameters + step, self.values + step[0] * self.slopes[0] + step[1] * self.slopes[1], self.slopes
        )

    def with_others(self, chosen: Any, others: SurfacePoints) -> SurfacePoints:
        """The points with others in place of some of them."""
        arrays = np.array(self.parameters), np.array(self.values), np.array(self.slopes)
        for array, other in zip(arrays, (others.parameters, others.values, others.slopes), strict=True):
            array[..., chosen] = other
        return SurfacePoints(*arrays)


def axial_and_radial(points: SurfacePoints) -> tuple[Array, Array]:
    """Axial and radial coordinates (2, n) [mm] about the member's axis, and their derivatives (2, 2, n)."""
    x, y, z = points.position
    radial = np.sqrt(x**2 + y**2)
    along, outward = points.slopes[:, 2], (x * points.slopes[:, 0] + y * points.slopes[:, 1]) / radial
    return np.stack([z, radial]), np.stack([along, outward], axis=1)


def points_at(
    locate: Locate, surface: GeneratingSurface, start: SurfacePoints, target: Array
) -> tuple[SurfacePoints, NewtonResult]:
    """Points with target coordinates (2, n) by Newton's method, and how the search ended.

    ``locate`` gives two coordinates of points (2, n) and their derivatives by both parameters (2, 2, n).
    """
    kept, known = start, True

    def derivatives(parameters: Array, active: Integers) -> tuple[Array, Array]:
        nonlocal kept, known
        if known:
            known = False
            return locate(kept)
        points = SurfacePoints.of(surface, parameters)
        kept = points if active.size == target.shape[1] else kept.with_others(active, points)
        return locate(points)

    with np.errstate(all="ignore"):
        solution = solve_by(derivatives, start.parameters, target, surface.max_step)
        step = solution.parameters - kept.parameters
        far = np.flatnonzero(~np.all(np.abs(step) < LINEAR_STEP * surface.max_step[:, None], axis=0))
        kept = kept.moved(step)
        if far.size:
            kept = kept.with_others(far, SurfacePoints.of(surface, solution.parameters[:, far]))
    return kept, solution
