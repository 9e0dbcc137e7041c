"""A flank cut anew with other settings, and how far it departs from the designed one at measuring points."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays, instance, number, two_whole
from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..flanks.blank_section import BlankSection
from ..flanks.flank import Flank, solve_flank
from ..newton import solve
from ..pair.gear_pair import Member
from ..vectors import dot, rotate_z
from .deviation import DEVIATION_LIMIT, Deviation
from .normal_distance import normal_distance

Array = NDArray[Any]


@frozen_arrays
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

    def at(self, chosen: NDArray[np.bool_]) -> RecutFlank:
        """The same flank at some of the points (n)."""
        flank = self.flank
        own = {
            field.name: getattr(flank, field.name)[..., chosen] for field in fields(Flank) if field.name != "surface"
        }
        return replace(self, target=self.target[:, chosen], flank=replace(flank, **own))

    @cached_property
    def lever(self) -> Array:
        """Deviation of the points by a rotation of the tooth about its axis (n) [mm/rad]."""
        (x, y, _), (along_x, along_y, _) = self.flank.position, self.flank.normal
        return np.asarray(x * along_y - y * along_x)

    @cached_property
    def _parts(self) -> tuple[tuple[GeneratingSurface, NDArray[np.bool_]], ...]:
        """Parts of the flank that have points, and which ones (n)."""
        owned = [(part, self.flank.part == number) for number, part in enumerate(self.surface.flank_parts)]
        return tuple((part, own) for part, own in owned if np.any(own))

    @cached_property
    def _orientation(self) -> Array:
        """Signs of the side of the surface that is the flank (n): on the other one it is undercut."""
        sign = np.empty(self.lever.shape)
        for part, own in self._parts:
            sign[own] = np.sign(part.orientation(self.flank.parameters[:, own]))
        return sign

    def turn(self, surface: GeneratingSurface) -> float:
        """Rotation that brings a flank of another surface near the designed one [rad].

        From points with the same axial and radial coordinates, each weighted by what a rotation changes of its
        deviation. NaN if there are none.
        """
        around = np.full(self.lever.shape, np.nan)
        for part, own in self._parts:
            moved = surface.on(part.part)
            found = solve(moved.axial_and_radial, self.flank.parameters[:, own], self.target[:, own], moved.max_step)
            position = moved.evaluate(found.parameters)[0]
            around[own] = np.where(found.converged, np.arctan2(position[1], position[0]), np.nan)
        ahead = around - np.arctan2(self.flank.position[1], self.flank.position[0])
        ahead = np.mod(ahead + np.pi, 2.0 * np.pi) - np.pi
        weight = np.where(np.isfinite(ahead), self.lever**2, 0.0)
        return float(np.nansum(ahead * weight) / weight.sum()) if np.any(weight) else np.nan

    def distance(self, surface: GeneratingSurface, turn: float | None = None) -> Array:
        """Distance from the points along their normals to another surface, turned back: the deviation that it is.

        Parameters
        ----------
        surface
            The other surface.
        turn
            Rotation that is taken off [rad]; the one of ``turn`` if left out.

        Returns
        -------
        Array
            Distance (n) [mm], positive where the other surface has more metal. NaN where the normal misses it, meets it
            where it is undercut, or only further away than ``DEVIATION_LIMIT``.
        """
        ahead = np.full(self.lever.shape, self.turn(surface) if turn is None else turn)
        position, normal = rotate_z(ahead, self.flank.position), rotate_z(ahead, self.flank.normal)
        found = np.full(ahead.shape, np.nan)
        for part, own in self._parts:
            start = self.flank.parameters[:, own]
            distance, points = normal_distance(surface.on(part.part), position[:, own], normal[:, own], start)
            usable = (points.orientation * self._orientation[own] > 0.0) & (np.abs(distance) <= DEVIATION_LIMIT)
            found[own] = np.where(usable, distance, np.nan)
        return found

    def displacement(self, surface: GeneratingSurface) -> Array:
        """Distance (n) [mm] as ``distance``, not turned back, to first order in the change of the settings.

        A point that the same place of the blade cuts at the same cradle rotation moves along the surface, too, which is
        of second order for the distance.
        """
        moved = np.empty(self.lever.shape)
        for part, own in self._parts:
            position = surface.on(part.part).evaluate(self.flank.parameters[:, own])[0]
            moved[own] = dot(position - self.flank.position[:, own], self.flank.normal[:, own])
        return moved


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
        If the settings cut no flank near a point of the grid.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry.cutting.named_settings import with_settings
    >>> gear = gear_pair(read_case("fm-11x41")).gear
    >>> wrong = with_settings(gear.loaded, {"radial_distance": gear.loaded.settings.radial_distance + 0.1})
    >>> departure(gear, wrong).value.shape
    (9, 5)
    """
    instance("member", member, Member)
    instance("surface", surface, GeneratingSurface)
    ends = number("margin", margin, least=0.0, below=0.5)
    fractions = (np.linspace(ends, 1.0 - ends, count) for count in two_whole("nodes", nodes, 2))
    axial, radial = member.section.points(*np.meshgrid(*fractions, indexing="ij"))
    real = surface.designed
    # The measuring machine turns the tooth until its flank passes through the reference point.
    turn = RecutFlank.of(member, *member.section.points(np.array([0.5]), np.array([0.5]))).turn(real)
    value = RecutFlank.of(member, axial, radial).distance(real, turn).reshape(axial.shape)
    if not np.all(np.isfinite(value)):
        raise GeometryError(
            f"these settings cut no flank within {DEVIATION_LIMIT:g} mm of some of the measuring points"
        )
    return Deviation(member.section, axial, radial, value)
