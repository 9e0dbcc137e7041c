"""A flank cut anew with other settings, and how far it departs from the designed one at measuring points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..flanks.blank_section import BlankSection
from ..flanks.flank import Flank, solve_flank
from ..newton import solve
from ..pair.gear_pair import Member
from ..vectors import dot, rotate_z
from .deviation import Deviation
from .measurement import zeroed

Array = NDArray[Any]


@dataclass(frozen=True)
class RecutFlank:
    """The designed flank at measuring points, from where flanks of other settings are found.

    Parameters
    ----------
    surface
        The designed surface.
    section
        Blank of the member.
    target
        Axial and radial coordinates of the points (2, n) [mm].
    flank
        The designed flank there.
    """

    surface: GeneratingSurface
    section: BlankSection
    target: Array
    flank: Flank

    @classmethod
    def of(cls, member: Member, axial: Array, radial: Array) -> RecutFlank:
        """The loaded flank of a member at points (...) [mm].

        Raises
        ------
        GeometryError
            If a point lies off the designed flank.
        """
        surface, target = member.loaded.designed, np.stack([np.ravel(axial), np.ravel(radial)])
        flank = solve_flank(surface, member.section, *target)
        if not np.all(np.isfinite(flank.position)):
            raise GeometryError("measured points lie off the designed flank: check the measuring grid")
        return cls(surface, member.section, target, flank)

    @property
    def lever(self) -> Array:
        """Deviation of the points by a rotation of the tooth about its axis (n) [mm/rad]."""
        (x, y, _), (along_x, along_y, _) = self.flank.position, self.flank.normal
        return np.asarray(x * along_y - y * along_x)

    def _recut(self, surface: GeneratingSurface) -> tuple[Array, Array]:
        """Points and normals (3, n) of another surface at the same coordinates; NaN where it has none."""
        position, normal = np.full((2, *self.flank.position.shape), np.nan)
        for number, part in enumerate(self.surface.flank_parts):
            own = self.flank.part == number
            if not np.any(own):
                continue
            moved = surface.on(part.part)
            found = solve(moved.axial_and_radial, self.flank.parameters[:, own], self.target[:, own], moved.max_step)
            there = moved.evaluate(found.parameters)
            position[:, own], normal[:, own] = (np.where(found.converged, v, np.nan) for v in there[:2])
        return position, normal

    def turn(self, surface: GeneratingSurface) -> float:
        """Rotation that brings a flank of another surface nearest to the designed one [rad]."""
        return self._turn(self._recut(surface)[0])

    def _turn(self, position: Array) -> float:
        weight = self.lever**2
        around = np.arctan2(position[1], position[0]) - np.arctan2(self.flank.position[1], self.flank.position[0])
        around = np.mod(around + np.pi, 2.0 * np.pi) - np.pi
        return float(around @ weight / weight.sum())

    def distance(self, surface: GeneratingSurface, turn: float | None = None) -> Array:
        """Distance from the points along their normals to another surface, turned back.

        Parameters
        ----------
        surface
            The other surface.
        turn
            Rotation that is taken off [rad]; the one of ``turn`` if left out.

        Returns
        -------
        Array
            Distance (n) [mm], positive where the other surface has more metal; from its tangent plane, which errs by
            the square of the distance over the radius of curvature. NaN where it is not found.
        """
        position, normal = self._recut(surface)
        back = np.full(position.shape[1], -(self._turn(position) if turn is None else turn))
        position, normal = rotate_z(back, position), rotate_z(back, normal)
        return np.asarray(dot(position - self.flank.position, normal) / dot(self.flank.normal, normal))


def departure(
    member: Member, surface: GeneratingSurface, nodes: tuple[int, int] = (9, 5), margin: float = 0.1
) -> Deviation:
    """Deviation that a machine with other settings makes, as it is measured: zero in the middle of the flank.

    Parameters
    ----------
    member
        The member as designed, seen from the flank.
    surface
        The loaded flank with other settings.
    nodes
        Columns and rows of the measuring grid.
    margin
        Fraction of the flank that the grid keeps clear of its edges.

    Raises
    ------
    GeometryError
        If the settings cut no flank at a point of the grid.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import with_settings
    >>> gear = gear_pair(read_case("fm-11x41")).gear
    >>> wrong = with_settings(gear.loaded, {"radial_distance": gear.loaded.settings.radial_distance + 0.1})
    >>> departure(gear, wrong).value.shape
    (9, 5)
    """
    fractions = (np.linspace(margin, 1.0 - margin, count) for count in nodes)
    axial, radial = member.section.points(*np.meshgrid(*fractions, indexing="ij"))
    value = RecutFlank.of(member, axial, radial).distance(surface.designed).reshape(axial.shape)
    if not np.all(np.isfinite(value)):
        raise GeometryError("these settings cut no flank at some of the measuring points")
    return zeroed(Deviation(member.section, axial, radial, value), member.loaded)
