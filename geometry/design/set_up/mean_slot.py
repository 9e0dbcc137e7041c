"""The width of a pinion's slot at its mean point, where one cutter cuts both flanks of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...cutting.generating_surface import GeneratingSurface
from ...flanks.blank_section import BlankSection
from ...flanks.flank import solve_flank
from ...newton import solve
from ..blank import BlankDimensions
from ..iso23509.blank_dimensions import MemberBlank

Array = NDArray[Any]


@dataclass
class MeanSlot:
    """The mean point on both flanks, and the width that the blank wants between them.

    Parameters
    ----------
    point
        Axial and radial coordinates of the mean point (2, 1) [mm].
    width_per_angle
        Normal width per angle about the member's axis [mm/rad].
    wanted
        Normal width of the slot [mm].
    parameters
        Surface parameters (2, 1) of the point on the concave and on the convex flank, a start for other settings.
    """

    point: Array
    width_per_angle: float
    wanted: float
    parameters: tuple[Array, Array]

    @classmethod
    def of(
        cls, concave: GeneratingSurface, convex: GeneratingSurface, section: BlankSection, blank: BlankDimensions
    ) -> MeanSlot:
        """The slot of the pinion of a blank. Raises GeometryError if the cutter meets no tooth of it."""
        member: MemberBlank = blank.pinion
        axial = member.mean_cone_distance * math.cos(member.pitch_angle) - member.pitch_apex
        radial = member.mean_cone_distance * math.sin(member.pitch_angle)
        point = np.array([[axial], [radial]])
        found = [solve_flank(surface, section, point[0], point[1]).parameters for surface in (concave, convex)]
        wanted = math.pi * blank.mean_normal_module - member.mean_normal_thickness
        return cls(point, radial * math.cos(member.mean_spiral_angle), wanted, (found[0], found[1]))

    def width(self, concave: GeneratingSurface, convex: GeneratingSurface) -> float:
        """Normal width of the slot that two flanks of one set-up leave [mm]; NaN where a flank is not found."""
        azimuths, parameters = [], []
        for surface, start in zip((concave, convex), self.parameters, strict=True):
            found = solve(surface.axial_and_radial, start, self.point, surface.max_step)
            if not np.all(found.converged):
                return math.nan
            position = surface.evaluate(found.parameters)[0][:, 0]
            hand = 1.0 if surface.hand == "right" else -1.0
            azimuths.append(math.atan2(hand * position[1], position[0]))
            parameters.append(found.parameters)
        self.parameters = parameters[0], parameters[1]
        return math.remainder(azimuths[1] - azimuths[0], 2.0 * math.pi) * self.width_per_angle

    def change(
        self, here: GeneratingSurface, behind: GeneratingSurface, ahead: GeneratingSurface, *, convex: bool
    ) -> float:
        """Change of the width [mm] from one flank to another near it, to first order: the other side stays.

        Parameters
        ----------
        here
            The flank that the parameters belong to.
        behind, ahead
            Flanks near it.
        convex
            Whether it is the convex flank.
        """
        parameters = self.parameters[1 if convex else 0]
        position, normal = (vector[:, 0] for vector in here.evaluate(parameters)[:2])
        moved = (ahead.evaluate(parameters)[0] - behind.evaluate(parameters)[0])[:, 0]
        around = float(position[0] * normal[1] - position[1] * normal[0])
        hand = 1.0 if here.hand == "right" else -1.0
        turn = hand * float(moved @ normal) / around
        return (1.0 if convex else -1.0) * turn * self.width_per_angle

    def error(self, concave: GeneratingSurface, convex: GeneratingSurface) -> float:
        """Width less the wanted one [mm]."""
        return self.width(concave, convex) - self.wanted
