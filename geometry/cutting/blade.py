"""The cutter blade: position of its edge on the cutter, and the sections of the edge.

The edge is a chain of straight lines and circular arcs: edge radius, toprem, profile, flankrem. The plane of the blade
has the coordinates ``outward``, counted from the point radius towards the metal that is cut, and ``height``, counted
from the tip plane towards the shank. Along the edge runs one coordinate: millimetres from the end of the edge radius
upwards, and from -1 (tip land) to 0 within the edge radius, whatever its size.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from ...core.checks import check_fields
from ...core.errors import InputError

SectionName = Literal["edge", "toprem", "profile", "flankrem"]


@dataclass(frozen=True)
class Relief:
    """Toprem or flankrem [mm, rad]: relief at one end of the blade's profile; a positive angle removes metal.

    It kinks the profile: a toprem's pressure angle is smaller by it, a flankrem's larger.
    """

    height: float  # of its beginning above the tip plane [mm]
    angle: float = 0.0
    radius: float | None = None  # of an arc [mm] with the centre in the metal; straight if None

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class BladeSection:
    """A straight or circular part of a blade's edge.

    Parameters
    ----------
    name
        Name of the part.
    begin, end
        Coordinate of its ends along the edge; the last section has no end.
    outward, height
        Coordinates of its beginning in the plane of the blade [mm].
    angle
        Angle between edge and cutter axis at the beginning [rad].
    rate
        Change of that angle per coordinate.
    radius
        Radius of the arc [mm], positive with the centre on the side of the metal; ``None`` for a straight line.

    Examples
    --------
    >>> flank = BladeSection("flank", begin=0.0, end=10.0, outward=0.0, height=2.0, angle=0.0)
    >>> flank.middle, flank.point(5.0), flank.at_height(4.0)
    (5.0, (0.0, 7.0), 2.0)
    """

    name: SectionName
    begin: float
    end: float
    outward: float
    height: float
    angle: float
    rate: float = 0.0
    radius: float | None = None

    @property
    def center(self) -> tuple[float, float]:
        """Centre of the arc (outward, height) [mm]."""
        radius = self.radius or 0.0
        return self.outward + radius * math.cos(self.angle), self.height - radius * math.sin(self.angle)

    @property
    def middle(self) -> float:
        """Coordinate of the middle; of the beginning of a section without end."""
        return self.begin if math.isinf(self.end) else 0.5 * (self.begin + self.end)

    def angle_at(self, coordinate: float) -> float:
        """Angle between edge and cutter axis [rad]."""
        return self.angle + self.rate * (coordinate - self.begin)

    def point(self, coordinate: float) -> tuple[float, float]:
        """Point (outward, height) [mm] at a coordinate."""
        along = coordinate - self.begin
        if self.radius is None:
            return self.outward + along * math.sin(self.angle), self.height + along * math.cos(self.angle)
        # Along the chord: exact for an arc of any radius, with no difference of large numbers.
        half = 0.5 * self.rate * along
        chord = 2.0 * self.radius * math.sin(half)
        return self.outward + chord * math.sin(self.angle + half), self.height + chord * math.cos(self.angle + half)

    def at_height(self, height: float) -> float:
        """Coordinate at a height above the tip plane.

        Raises
        ------
        InputError
            If the arc does not reach this height.
        """
        if self.radius is None:
            return self.begin + (height - self.height) / math.cos(self.angle)
        sine = (height - self.center[1]) / self.radius
        if not abs(sine) < 1.0:
            raise InputError(
                f"the {self.name} of the blade, an arc of radius {abs(self.radius):g} mm, does not reach the height "
                f"{height:g} mm above the tip plane: check its radius and the heights of the reliefs"
            )
        return self.begin + (math.asin(sine) - self.angle) / self.rate


def _part(
    name: SectionName, point: tuple[float, float], angle: float, radius: float | None, begin: float = 0.0
) -> BladeSection:
    """A section through a point; the coordinate counts from there, both ways."""
    rate = 0.0 if radius is None else 1.0 / radius
    return BladeSection(name, begin, math.inf, point[0], point[1], angle, rate, radius)


def blade_sections(blade: Blade) -> dict[SectionName, BladeSection]:
    """Sections of a blade's edge from the tip land upwards, joined end to end; parts that do not fit are refused.

    The profile touches the line of the pressure angle at the reference height [mm]; reliefs begin on the profile, with
    a kink if they have an angle; the edge radius touches what lies above it and the tip plane.
    """
    edge_radius, toprem, flankrem = blade.edge_radius, blade.toprem, blade.flankrem
    reference = (blade.reference_height * math.tan(blade.pressure_angle), blade.reference_height)
    profile = _part("profile", reference, blade.pressure_angle, blade.spheric_radius)
    lowest, start = profile, 0.0
    if toprem is not None:
        start = profile.at_height(toprem.height)
        lowest = _part("toprem", profile.point(start), profile.angle_at(start) - toprem.angle, toprem.radius)
    foot = _edge_joint(lowest, edge_radius)
    sections: dict[SectionName, BladeSection] = {"edge": _edge(lowest, foot, edge_radius)}
    begin = 0.0
    if toprem is None:
        start = foot
    else:
        begin = -foot
        if not begin > 0.0:
            raise InputError(
                f"toprem_depth = {toprem.height:g} mm: the edge radius {edge_radius:g} mm reaches above it; make the "
                "edge radius smaller or let the toprem begin higher"
            )
        sections["toprem"] = _cut(lowest, foot, 0.0, begin)
    if flankrem is None:
        return sections | {"profile": _cut(profile, start, begin, math.inf)}
    top = profile.at_height(flankrem.height)
    if not top > start:
        raise InputError(
            f"flankrem_depth = {flankrem.height:g} mm: must be above the edge radius and the toprem, which reach "
            f"{profile.point(start)[1]:g} mm above the tip plane"
        )
    sections["profile"] = _cut(profile, start, begin, begin + top - start)
    point, angle = profile.point(top), profile.angle_at(top) + flankrem.angle
    return sections | {"flankrem": _part("flankrem", point, angle, flankrem.radius, begin + top - start)}


def _cut(part: BladeSection, start: float, begin: float, end: float) -> BladeSection:
    """The part from its coordinate ``start`` on, with the coordinate counted from ``begin`` there."""
    outward, height = part.point(start)
    return replace(part, begin=begin, end=end, outward=outward, height=height, angle=part.angle_at(start))


def _edge_joint(part: BladeSection, radius: float) -> float:
    """Coordinate on the lowest part where an edge radius that touches the tip plane touches it.

    At the joint the height is ``radius (1 - sin angle)``.
    """
    if part.radius is None:
        return part.at_height(radius * (1.0 - math.sin(part.angle)))
    sine = (radius - part.center[1]) / (part.radius + radius) if part.radius + radius else math.inf
    if not abs(sine) < 1.0:
        raise InputError(
            f"tool_edge_radius = {radius:g} mm: no such arc touches the blade's {part.name}, an arc of "
            f"{abs(part.radius):g} mm"
        )
    return part.begin + (math.asin(sine) - part.angle) / part.rate


def _edge(lowest: BladeSection, foot: float, radius: float) -> BladeSection:
    """The edge radius, from the tip land up to the lowest part."""
    outward, height = lowest.point(foot)
    angle = lowest.angle_at(foot)
    tip = (outward - radius * math.cos(angle), height - radius * (1.0 - math.sin(angle)))
    return BladeSection("edge", -1.0, 0.0, *tip, math.pi / 2, angle - math.pi / 2, -radius)


BladeSide = Literal["outside", "inside"]


@dataclass(frozen=True)
class Blade:
    """A blade with a straight or circular profile, its reliefs and its edge radius.

    The cutter frame has its axis along z, pointing from the shank towards the blank, with the blade tips in the
    plane z = 0.

    Parameters
    ----------
    point_radius
        Distance from the cutter axis to the blade point, where the line of the pressure angle meets the tip plane [mm].
    pressure_angle
        Angle between edge and cutter axis [rad], positive where the slot widens towards the shank.
    side
        An outside blade cuts the concave flank, an inside blade the convex one.
    offset_angle, rake_angle, hook_angle
        Where a face-hobbing blade stands off the radial direction, and how its edge is turned [rad]. A face-milling
        blade sweeps a surface of revolution, for which only the pressure angle matters: zero.
    spheric_radius
        Radius of a circular profile [mm]: positive for a hollow edge, whose pressure angle grows towards the shank and
        which crowns the flank; straight when ``None``.
    reference_height
        Height above the tip plane at which a circular profile has the pressure angle and touches its line [mm].
    edge_radius
        Radius between profile (or toprem) and tip land, which cuts the fillet [mm].
    toprem, flankrem
        Reliefs next to the tip and to the shank of the blade; none when ``None``.

    Raises
    ------
    InputError
        If a length or an angle is out of range, or the sections do not fit onto one another.

    Examples
    --------
    A straight outside blade: its pressure angle leans the edge outwards, the shank lies towards negative z.

    >>> blade = Blade(point_radius=75.0, pressure_angle=np.radians(20.0), side="outside")
    >>> [round(v, 3) for v in blade.edge]
    [0.342, 0.0, -0.94]
    """

    point_radius: float
    pressure_angle: float
    side: BladeSide
    offset_angle: float = 0.0
    rake_angle: float = 0.0
    hook_angle: float = 0.0
    spheric_radius: float | None = None
    reference_height: float = 0.0
    edge_radius: float = 0.0
    toprem: Relief | None = None
    flankrem: Relief | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        if not self.point_radius > 0.0:
            raise InputError(f"blade_point_radius = {self.point_radius}: must be a positive length in mm")
        if not abs(self.pressure_angle) < np.pi / 2:
            raise InputError(
                f"blade_pressure_angle = {np.degrees(self.pressure_angle)}: must be between -90 and 90 degrees"
            )
        if not self.edge_radius >= 0.0:
            raise InputError(f"tool_edge_radius = {self.edge_radius}: must be 0 mm or more")
        if self.spheric_radius is not None and not abs(self.spheric_radius) > 1.0:
            raise InputError(f"blade_spheric_radius = {self.spheric_radius}: must be above 1 mm or below -1 mm")
        _ = self.sections  # a blade whose parts do not fit is refused when it is made

    @cached_property
    def sections(self) -> dict[SectionName, BladeSection]:
        """Parts of the edge by name, from the tip land upwards."""
        return blade_sections(self)

    @property
    def side_sign(self) -> float:
        """+1 for an outside blade, -1 for an inside blade."""
        return 1.0 if self.side == "outside" else -1.0

    @property
    def tip(self) -> tuple[float, float]:
        """Radial and tangential component of the blade tip, in the frame that turns with the blade [mm]."""
        cosine, sine = float(np.cos(self.offset_angle)), float(np.sin(self.offset_angle))
        return self.point_radius * cosine, self.point_radius * sine

    @property
    def edge(self) -> tuple[float, float, float]:
        """Unit vector of the pressure angle's line, tip to shank (Kolivand 2009, Eq. 2.5 and 2.6a)."""
        outward, upward = self.plane
        sine, cosine = np.sin(self.pressure_angle), np.cos(self.pressure_angle)
        x, y, z = (float(sine * a + cosine * b) for a, b in zip(outward, upward, strict=True))
        return x, y, z

    @property
    def plane(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Unit vectors of the blade's plane, outward and towards the shank: radial, tangential, axial each."""
        return self._turned(self.side_sign, 0.0), self._turned(0.0, -1.0)

    def _turned(self, radial: float, axial: float) -> tuple[float, float, float]:
        """Rake about the cutter axis, then hook about the radial direction, then the offset of the blade."""
        radial, tangential = radial * np.cos(self.rake_angle), radial * np.sin(self.rake_angle)
        cosine, sine = np.cos(self.hook_angle), np.sin(self.hook_angle)
        tangential, axial = cosine * tangential - sine * axial, sine * tangential + cosine * axial
        cosine, sine = np.cos(self.offset_angle), np.sin(self.offset_angle)
        radial, tangential = cosine * radial - sine * tangential, sine * radial + cosine * tangential
        return float(radial), float(tangential), float(axial)
