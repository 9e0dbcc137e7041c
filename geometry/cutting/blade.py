"""The cutter blade: position of its edge on the cutter, and the sections of the edge."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from ...core.checks import check_fields
from ...core.errors import InputError
from .blade_sections import BladeSection, Relief, SectionName, blade_sections

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
        return blade_sections(
            self.pressure_angle,
            spheric_radius=self.spheric_radius,
            reference_height=self.reference_height,
            edge_radius=self.edge_radius,
            toprem=self.toprem,
            flankrem=self.flankrem,
        )

    @property
    def side_sign(self) -> float:
        """+1 for an outside blade, -1 for an inside blade."""
        return 1.0 if self.side == "outside" else -1.0

    @property
    def tip(self) -> tuple[float, float]:
        """Radial and tangential component of the blade tip, in the frame that turns with the blade [mm]."""
        return self.point_radius * float(np.cos(self.offset_angle)), self.point_radius * float(
            np.sin(self.offset_angle)
        )

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
