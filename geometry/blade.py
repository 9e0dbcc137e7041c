"""The cutter blade: the straight edge that sweeps the generating cone of a face-milling cutter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..core.errors import InputError

Array = NDArray[Any]  # real, or complex while a complex step differentiates

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

    def tip(self, cutter_angle: Array) -> Array:
        """Blade tip in the cutter frame.

        Parameters
        ----------
        cutter_angle
            Rotation of the cutter (n) [rad].

        Returns
        -------
        Array
            Position (3, n) [mm].
        """
        zero = np.zeros_like(cutter_angle)
        return np.stack([self.point_radius * np.cos(cutter_angle), self.point_radius * np.sin(cutter_angle), zero])

    def edge(self, cutter_angle: Array) -> Array:
        """Unit vector (3, n) along the edge, from the tip to the shank (Kolivand 2009, Eq. 2.5)."""
        radial = self.side_sign * np.sin(self.pressure_angle)
        axial = np.full_like(cutter_angle, -np.cos(self.pressure_angle))
        return np.stack([radial * np.cos(cutter_angle), radial * np.sin(cutter_angle), axial])

    def normal(self, cutter_angle: Array) -> Array:
        """Unit normal (3, n) of the generating cone, pointing out of the tooth that is cut, into the slot."""
        radial = -self.side_sign * np.cos(self.pressure_angle)
        axial = np.full_like(cutter_angle, -np.sin(self.pressure_angle))
        return np.stack([radial * np.cos(cutter_angle), radial * np.sin(cutter_angle), axial])
