"""The cutter blade: the straight edge that sweeps the generating cone of a face-milling cutter, or one that hobs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..core.errors import InputError

BladeSide = Literal["outside", "inside"]


@dataclass(frozen=True)
class Blade:
    """Straight blade.

    The cutter frame has its axis along z, pointing from the shank towards the blank, with the blade tips in the
    plane z = 0. The distance along the edge is counted from the tip, positive towards the shank.

    Parameters
    ----------
    point_radius
        Distance of the blade tip from the cutter axis [mm].
    pressure_angle
        Angle between edge and cutter axis [rad], positive where the slot widens towards the shank.
    side
        An outside blade cuts the concave flank, an inside blade the convex one.
    offset_angle, rake_angle, hook_angle
        Where a face-hobbing blade stands off the radial direction, and how its edge is turned [rad]. A face-milling
        blade sweeps a surface of revolution, for which only the pressure angle matters: zero.

    Raises
    ------
    InputError
        If the radius is not positive or the angle is not between -90 and 90 degrees.
    """

    point_radius: float
    pressure_angle: float
    side: BladeSide
    offset_angle: float = 0.0
    rake_angle: float = 0.0
    hook_angle: float = 0.0

    def __post_init__(self) -> None:
        if not self.point_radius > 0.0:
            raise InputError(f"blade_point_radius = {self.point_radius}: must be a positive length in mm")
        if not abs(self.pressure_angle) < np.pi / 2:
            raise InputError(
                f"blade_pressure_angle = {np.degrees(self.pressure_angle)}: must lie between -90 and 90 degrees"
            )
        if self.side not in ("outside", "inside"):
            raise InputError(f"blade side = {self.side!r}: allowed are 'outside' and 'inside'")

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
        """Unit vector along the edge, tip to shank: radial, tangential, axial (Kolivand 2009, Eq. 2.5 and 2.6a)."""
        radial, axial = self.side_sign * np.sin(self.pressure_angle), -np.cos(self.pressure_angle)
        # Rake about the cutter axis, then hook about the radial direction, then the offset of the blade.
        radial, tangential = radial * np.cos(self.rake_angle), radial * np.sin(self.rake_angle)
        cosine, sine = np.cos(self.hook_angle), np.sin(self.hook_angle)
        tangential, axial = cosine * tangential - sine * axial, sine * tangential + cosine * axial
        cosine, sine = np.cos(self.offset_angle), np.sin(self.offset_angle)
        radial, tangential = cosine * radial - sine * tangential, sine * radial + cosine * tangential
        return float(radial), float(tangential), float(axial)
