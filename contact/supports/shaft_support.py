"""Shafts on bearings as supports of the members, in the pair's global frame, also where bearings depend on the load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...core.checks import array
from ...geometry.pair.assembly import Assembly
from ...geometry.tooth.tooth_flanks import MemberName
from .shaft import Shaft
from .support import ORIGIN, BearingReaction, Support, Supports, shifted_wrench

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ShaftSupport:
    """A shaft and where its axis lies.

    Parameters
    ----------
    shaft
        The shaft, with places along z of the member's frame.
    origin
        Origin of this frame, the member's crossing point (3) [mm], in the global frame.
    frame
        Axes of this frame (3, 3), in columns, z along the shaft.

    Examples
    --------
    >>> from easeoff.contact.supports.bearing import Bearing
    >>> from easeoff.contact.supports.shaft_section import ShaftSection
    >>> bearings = Bearing("head", 40.0, 6e5, 1e5), Bearing("tail", 100.0, 4e5)
    >>> shaft = Shaft((ShaftSection(0.0, 120.0, 40.0),), bearings, reference=10.0)
    >>> ShaftSupport(shaft, (0.0, 20.0, 0.0), np.eye(3)).at(np.zeros(6)).reference.tolist()
    [0.0, 20.0, 10.0]
    """

    shaft: Shaft
    origin: ArrayLike
    frame: ArrayLike

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
    """Supports of pinion and gear of which one or both are shafts whose bearings may depend on the load.

    Parameters
    ----------
    pinion, gear
        Support of each.
    wind_up
        As of ``Supports``.

    Examples
    --------
    >>> both = ShaftSupports(Support.rigid(), Support.rigid())
    >>> both.at(np.zeros(6), np.zeros(6)).wind_up
    False
    """

    pinion: ShaftSupport | Support
    gear: ShaftSupport | Support
    wind_up: bool = False

    @property
    def is_linear(self) -> bool:
        """Whether the supports do not depend on the load."""
        return all(not isinstance(one, ShaftSupport) or one.shaft.is_linear for one in (self.pinion, self.gear))

    def at(self, pinion_wrench: Array, gear_wrench: Array) -> Supports:
        """The supports under wrenches (6) on pinion and gear about the origin, see ``LoadedSupports``."""
        pinion, gear = (
            one.at(wrench) if isinstance(one, ShaftSupport) else one
            for one, wrench in ((self.pinion, pinion_wrench), (self.gear, gear_wrench))
        )
        return Supports(pinion, gear, wind_up=self.wind_up)
