"""A stepped round beam: stretching, torsion, and bending in two planes with shear (Timoshenko).

The compliance of a cylindrical piece follows from the unit-load theorem in closed form. Pieces in a row carry the same
wrench, taken about one point, so their compliances about that point add up: without nodes, elements or meshing error.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....core.checks import shown
from ....core.errors import InputError
from ...compliance.material import Material
from .shaft_section import ShaftSection, shear_coefficient

Array = NDArray[np.float64]
SECTION_COUNT_LIMIT = 200
JOINT_TOLERANCE = 1e-9  # between the end of a section and the start of the next [mm]


@dataclass(frozen=True)
class Beam:
    """A beam of cylindrical sections along z.

    Parameters
    ----------
    sections
        In their order along the axis, without gaps.
    material
        Its material.

    Raises
    ------
    InputError
        If there is no section, too many, or a section does not begin where the one before it ends.

    Examples
    --------
    >>> beam = Beam((ShaftSection(0.0, 60.0, 40.0), ShaftSection(60.0, 100.0, 35.0)), Material(206000.0, 0.3))
    >>> beam.start, beam.end
    (0.0, 100.0)
    """

    sections: tuple[ShaftSection, ...]
    material: Material

    def __post_init__(self) -> None:
        if not 1 <= len(self.sections) <= SECTION_COUNT_LIMIT:
            raise InputError(f"{len(self.sections)} sections: must be 1 to {SECTION_COUNT_LIMIT}")
        for at, (before, section) in enumerate(zip(self.sections, self.sections[1:], strict=False), start=2):
            if abs(section.start - before.end) > JOINT_TOLERANCE:
                what = "overlaps the one before it" if section.start < before.end else "leaves a gap before it"
                raise InputError(
                    f"section {at} {what}: start = {shown(section.start)}: must be {shown(before.end)} [mm], where the "
                    "section before it ends; give sections in the order of their positions"
                )

    @property
    def start(self) -> float:
        """Where the first section begins [mm]."""
        return self.sections[0].start

    @property
    def end(self) -> float:
        """Where the last section ends [mm]."""
        return self.sections[-1].end

    def compliance(self, start: float, end: float, origin: float = 0.0) -> Array:
        """How the cross section at ``end`` moves against that at ``start`` under a wrench.

        Parameters
        ----------
        start, end
            Places on the beam [mm], in either order.
        origin
            Place on the axis about which wrench and twist are taken [mm].

        Returns
        -------
        numpy.ndarray
            Twist for wrench (6, 6) [mm/N, 1/N, 1/(N mm)], symmetric: forces along x, y, z, then moments.

        Examples
        --------
        The tip of a cantilever under a force across it, and what bending alone makes of that:

        >>> section = ShaftSection(0.0, 100.0, 40.0)
        >>> tip = Beam((section,), Material(206000.0, 0.3)).compliance(0.0, 100.0, origin=100.0)
        >>> bending = 100.0**3 / (3.0 * 206000.0 * section.second_moment)
        >>> round(1e6 * float(tip[0, 0]), 2), round(1e6 * bending, 2)
        (14.01, 12.88)
        """
        lower, upper = min(start, end), max(start, end)
        total = np.zeros((6, 6))
        for section in self.sections:
            first, last = max(lower, section.start), min(upper, section.end)
            if last > first:
                total += _piece(section, self.material, first - origin, last - origin)
        return total

    def torsion(self, start: float, end: float) -> float:
        """Rotation about the axis between two places for a unit torque [1/(N mm)]."""
        return float(self.compliance(start, end)[5, 5])


def _piece(section: ShaftSection, material: Material, start: float, end: float) -> Array:
    """Compliance (6, 6) of a cylindrical piece about the origin of its ends [mm]."""
    length, middle = end - start, 0.5 * (start + end)
    shear = shear_coefficient(section.inner_diameter / section.outer_diameter, material.poisson_ratio)
    stretching = length / (material.elastic_modulus * section.area)
    sliding = length / (shear * material.shear_modulus * section.area)
    bending = length / (material.elastic_modulus * section.second_moment)
    twisting = length / (2.0 * material.shear_modulus * section.second_moment)
    # A force at the origin has the bending moment z F at z: the mean of z^2 is middle^2 + length^2 / 12.
    forced = sliding + bending * (middle**2 + length**2 / 12.0)
    found = np.diag([forced, forced, stretching, bending, bending, twisting])
    found[0, 4] = found[4, 0] = -middle * bending
    found[1, 3] = found[3, 1] = middle * bending
    return found
