"""Shafts on bearings as supports of the members, in the pair's global frame, also where bearings depend on the load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...core.arrays import RealArray as Array
from ...core.checks import array
from ...geometry.pair.assembly import Assembly
from ...geometry.tooth.tooth_flanks import MemberName
from .shaft import Shaft
from .support import ORIGIN, BearingReaction, Support, Supports, shifted_wrench


@dataclass(frozen=True, eq=False)
class ShaftSupport:
    """A shaft with its place in the global frame."""

    shaft: Shaft
    origin: ArrayLike  # the member's crossing point (3) [mm], global frame
    frame: ArrayLike  # axes in columns (3, 3), z along the shaft

    def __post_init__(self) -> None:
        object.__setattr__(self, "origin", array("origin", self.origin, "mm", ndim=1, size=3, frozen=True))
        object.__setattr__(self, "frame", array("frame", self.frame, ndim=2, size=9, frozen=True))

    @classmethod
    def of(cls, shaft: Shaft, assembly: Assembly, member: MemberName) -> ShaftSupport:
        """The shaft of a member of a pair."""
        if member == "gear":
            return cls(shaft, assembly.gear_origin, np.eye(3))
        return cls(shaft, assembly.pinion_origin, assembly.pinion_frame)

    def at(self, wrench: Array) -> Support:
        """The support under a wrench (6) on the member about the global origin [N, N mm], with the bearings' loads."""
        turned = np.kron(np.eye(2), np.asarray(self.frame))
        reference = self._point(self.shaft.reference)
        shaft = self.shaft.under(turned.T @ shifted_wrench(wrench, ORIGIN, reference))
        bearings = tuple(
            BearingReaction(bearing.name, self._point(bearing.position), turned @ load @ turned.T)
            for bearing, load in zip(shaft.bearings, shaft.loads, strict=True)
        )
        return Support(reference, turned @ shaft.compliance @ turned.T, bearings)

    def _point(self, place: float) -> Array:
        return np.asarray(self.origin) + place * np.asarray(self.frame)[:, 2]


@dataclass(frozen=True, eq=False)
class ShaftSupports:
    """Supports of pinion and gear of which one or both are shafts whose bearings may depend on the load."""

    pinion: ShaftSupport | Support
    gear: ShaftSupport | Support
    wind_up: bool = False

    @property
    def is_linear(self) -> bool:
        """True if the supports do not depend on the load."""
        return all(not isinstance(one, ShaftSupport) or one.shaft.is_linear for one in (self.pinion, self.gear))

    def at(self, pinion_wrench: Array, gear_wrench: Array) -> Supports:
        """The supports under wrenches (6) on pinion and gear about the origin, see ``LoadedSupports``."""
        pinion, gear = (
            one.at(wrench) if isinstance(one, ShaftSupport) else one
            for one, wrench in ((self.pinion, pinion_wrench), (self.gear, gear_wrench))
        )
        return Supports(pinion, gear, wind_up=self.wind_up)
