"""The cutter blade: the straight edge that sweeps the generating cone of a face-milling cutter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..core.errors import InputError

BladeSide = Literal["outside", "inside"]


@dataclass(frozen=True)
class Blade:
    """Straight blade of a face-milling cutter.

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

    Raises
    ------
    InputError
        If the radius is not positive or the angle is not between -90 and 90 degrees.
    """

    point_radius: float
    pressure_angle: float
    side: BladeSide

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
    def edge(self) -> tuple[float, float]:
        """Radial and axial component of the unit vector along the edge, tip to shank (Kolivand 2009, Eq. 2.5)."""
        return self.side_sign * float(np.sin(self.pressure_angle)), -float(np.cos(self.pressure_angle))

    @property
    def normal(self) -> tuple[float, float]:
        """Radial and axial component of the cone's unit normal, out of the tooth that is cut, into the slot."""
        return -self.side_sign * float(np.cos(self.pressure_angle)), -float(np.sin(self.pressure_angle))
