"""The path of a blade's tip against the root cone of the blank."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...core.arrays import Array
from ..cutting.generating_surface import GeneratingSurface
from ..flanks.blank_section import BlankSection
from ..flanks.flank import solve_flank
from ..newton import complex_steps, cramers_rule, solve

LENGTHWISE_FRACTIONS = np.array([0.0, 0.5, 1.0])  # toe, middle, heel
PROFILE_FRACTIONS = (0.15, 0.3, 0.45)  # of the nodes: near the root, or higher up where no flank is cut there


@dataclass(frozen=True)
class RootLine:
    """Nodes near the root of a flank at toe, middle and heel, and the parameters that cut them.

    It measures along the blade's axis where the blade cuts these nodes, not the path of the rolling blade's tip, see
    ``tooth_surface.tip_gap``; a change moves both by nearly as much.
    """

    section: BlankSection
    parameters: Array  # (2, 3) of the nodes, a start for other settings
    profile: float = PROFILE_FRACTIONS[0]

    @classmethod
    def of(cls, surface: GeneratingSurface, section: BlankSection) -> RootLine:
        """The nodes of a flank. Raises GeometryError if the cutter meets no tooth of the blank."""
        lines = []
        for profile in PROFILE_FRACTIONS:
            axial, radial = section.points(LENGTHWISE_FRACTIONS, np.full_like(LENGTHWISE_FRACTIONS, profile))
            flank = solve_flank(surface, section, axial, radial)
            lines.append(cls(section, flank.parameters, profile))
            if np.all(np.isfinite(flank.position)):
                return lines[-1]
        return lines[0]

    def gap(self, surface: GeneratingSurface) -> tuple[Array, RootLine]:
        """Distance of the blade's tip above the root cone (3) [mm], and the nodes of this surface, near the known one.

        Negative where it cuts deeper, NaN where the node is not found.
        """
        target = self.section.points(LENGTHWISE_FRACTIONS, np.full_like(LENGTHWISE_FRACTIONS, self.profile))
        solution = solve(surface.axial_and_radial, self.parameters, target, surface.max_step)
        gap = self.section.height_above_root(target[0], target[1]) - _above_tip(surface, solution.parameters)
        parameters = np.where(solution.converged, solution.parameters, self.parameters)
        return np.where(solution.converged, gap, np.nan), RootLine(self.section, parameters, self.profile)

    def change(self, surface: GeneratingSurface, behind: GeneratingSurface, ahead: GeneratingSurface) -> Array:
        """Change of the gap (3) [mm] from one near flank to another, to first order: one step of Newton's method."""
        coordinates, (first, second) = complex_steps(surface.axial_and_radial, self.parameters)

        def above_tip(near: GeneratingSurface) -> Array:
            step = cramers_rule(first, second, coordinates - near.axial_and_radial(self.parameters))
            return _above_tip(near, self.parameters + step)

        return above_tip(behind) - above_tip(ahead)


def root_gap(surface: GeneratingSurface, section: BlankSection) -> Array:
    """Distance of the blade's tip above the root cone at toe, middle and heel (3) [mm], see ``RootLine``."""
    return RootLine.of(surface, section).gap(surface)[0]


def _above_tip(surface: GeneratingSurface, parameters: Array) -> Array:
    """Height of flank points above the tip of the blade, along its axis (n) [mm]."""
    _, _, coordinates = surface.evaluate(parameters)
    return np.array([surface.section.point(c)[1] for c in coordinates])
