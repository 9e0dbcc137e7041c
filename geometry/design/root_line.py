"""The path of a blade's tip against the root cone of the blank."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..cutting.generating_surface import GeneratingSurface
from ..flanks.blank_section import BlankSection
from ..flanks.flank import solve_flank
from ..newton import complex_steps, cramers_rule, solve

Array = NDArray[Any]

LENGTHWISE_FRACTIONS = np.array([0.0, 0.5, 1.0])  # toe, middle, heel
PROFILE_FRACTION = 0.15  # profile fraction of the nodes: near the root, yet on the flank


@dataclass(frozen=True)
class RootLine:
    """Nodes near the root of a flank at toe, middle and heel, and the parameters that cut them.

    Parameters
    ----------
    section
        The blank.
    parameters
        Surface parameters (2, 3) of the nodes, a start for other settings.
    """

    section: BlankSection
    parameters: Array

    @classmethod
    def of(cls, surface: GeneratingSurface, section: BlankSection) -> RootLine:
        """The nodes of a flank. Raises GeometryError if the cutter meets no tooth of the blank."""
        axial, radial = section.points(LENGTHWISE_FRACTIONS, np.full_like(LENGTHWISE_FRACTIONS, PROFILE_FRACTION))
        return cls(section, solve_flank(surface, section, axial, radial).parameters)

    def gap(self, surface: GeneratingSurface) -> tuple[Array, RootLine]:
        """Distance of the blade's tip above the root cone (3) [mm], negative where it cuts deeper.

        Parameters
        ----------
        surface
            Generating surface, near the one of the parameters.

        Returns
        -------
        tuple
            The gap, NaN where the node is not found, and the nodes of this surface.
        """
        target = self.section.points(LENGTHWISE_FRACTIONS, np.full_like(LENGTHWISE_FRACTIONS, PROFILE_FRACTION))
        found = solve(surface.axial_and_radial, self.parameters, target, surface.max_step)
        gap = self.section.height_above_root(target[0], target[1]) - _above_tip(surface, found.parameters)
        parameters = np.where(found.converged, found.parameters, self.parameters)
        return np.where(found.converged, gap, np.nan), RootLine(self.section, parameters)

    def change(self, surface: GeneratingSurface, behind: GeneratingSurface, ahead: GeneratingSurface) -> Array:
        """Change of the gap (3) [mm] from one flank to another, to first order: one step of Newton's method.

        Parameters
        ----------
        surface
            The flank that these parameters belong to.
        behind, ahead
            Flanks near it.
        """
        here, (first, second) = complex_steps(surface.axial_and_radial, self.parameters)

        def above_tip(near: GeneratingSurface) -> Array:
            step = cramers_rule(first, second, here - near.axial_and_radial(self.parameters))
            return _above_tip(near, self.parameters + step)

        return above_tip(behind) - above_tip(ahead)


def _above_tip(surface: GeneratingSurface, parameters: Array) -> Array:
    """Height of flank points above the tip of the blade, along its axis (n) [mm]."""
    _, _, coordinates = surface.evaluate(parameters)
    return np.array([surface.section.point(c)[1] for c in coordinates])
