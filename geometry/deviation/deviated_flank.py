"""The deviated flank as a surface of its own, for every step of the geometry.

A point of the designed flank moves along its normal by the deviation. The normal leans against the deviation's slope:
with the tangents **r**_k, the deviation d and its derivatives d_k, the new normal is along **n** - **w**, where **w**
lies in the tangent plane and **w** . (**r**_k + d **n**_k) = d_k. That is exact, not to first order.

The ease-off is updated from that of the designed flanks (Kolivand 2009, chapter 4, Eq. 4.5a corrected). A deviation d
along the normal moves the point where the flank meets a circle about the member's axis by the angle d / ((a x r) . n),
the lever arm in the denominator. Kolivand 2009, Eq. 4.5a prints the product (u . n) d / L instead, with u the
circumferential direction and L the distance from the axis, which is low by (u . n)^2. With the condition of conjugate
contact, R (a_p x r) . n = (a_g x r) . n, the normal gap changes by just the sum of both deviations.

The roll angle of a point of the gear is where its gap is smallest. At a fixed point of the gear the gap of the designed
flanks is a + (1/2) c (q - Q)^2. What the pinion shows to that point moves on with q, so its deviation takes off
D(q) = d / lever, and the smallest gap moves to Q + D'(Q) / c. Kolivand 2009, Eq. 4.6 has the change d / ((a_p x r) . n)
instead: right for a flank turned as a whole, but without the slope of the deviation, which is the larger part.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import xarray as xr

from ...core.arrays import Array, Bools, record, shared_fields
from ...core.attributes import labelled
from ...core.checks import instance, number, two_whole
from ...core.errors import GeometryError, InputError
from ..cutting.generating_surface import GeneratingSurface
from ..flanks.blank_section import BlankSection
from ..flanks.flank import Flank, solve_flank
from ..newton import cramers_rule, solve
from ..pair.gear_pair import GearPair, Member, PairGeometry, first_contact
from ..vectors import dot, rotate_z
from .deviation import DEVIATION_LIMIT, Deviation, normal_distance

RELATIVE_STEP = 1e-5  # of the surface parameters, for central differences: a relative error of 1e-10


@dataclass(frozen=True)
class DeviatedFlank(GeneratingSurface):
    """Generated flank with its deviation from the design."""

    deviation: Deviation | None = None

    @property
    def designed(self) -> GeneratingSurface:
        """The surface without the deviation."""
        return GeneratingSurface(**shared_fields(GeneratingSurface, self))

    @np.errstate(all="ignore")
    def evaluate(self, parameters: Array) -> tuple[Array, Array, Array]:
        """As ``GeneratingSurface.evaluate``; the blade coordinate is that of the designed flank."""
        position, normal, coordinate = super().evaluate(parameters)
        if self.deviation is None:
            return position, normal, coordinate
        distance = np.sqrt(position[0] ** 2 + position[1] ** 2)
        deviation, slope = self.deviation.interpolant(position[2], distance)
        tangents, stretched, climbs = [], [], []
        for index, step in enumerate(RELATIVE_STEP * self.max_step):
            shift = np.zeros_like(parameters)
            shift[index] = step
            ahead, behind = (super(DeviatedFlank, self).evaluate(parameters + s * shift) for s in (1.0, -1.0))
            tangent, turned = ((a - b) / (2.0 * step) for a, b in zip(ahead[:2], behind[:2], strict=True))
            radial = (position[0] * tangent[0] + position[1] * tangent[1]) / distance
            tangents.append(tangent)
            stretched.append(tangent + deviation * turned)
            climbs.append(slope[0] * tangent[2] + slope[1] * radial)
        products, mixed = ([dot(tangent, other) for other in stretched] for tangent in tangents)
        first, second = cramers_rule(products, mixed, climbs)
        lean = first * tangents[0] + second * tangents[1]
        return position + deviation * normal, (normal - lean) / np.sqrt(1.0 + dot(lean, lean)), coordinate


def deviated_member(member: Member, deviation: Deviation | None) -> Member:
    """Member with a deviated loaded flank; InputError if the deviation belongs to another blank."""
    if deviation is None:
        return member
    if deviation.section != member.section:
        raise InputError("deviation: must have the section of this member; it was made for another blank")
    designed = shared_fields(GeneratingSurface, member.loaded.designed)
    return replace(member, loaded=DeviatedFlank(**designed, deviation=deviation))


def deviated_pair(pair: GearPair, *, pinion: Deviation | None = None, gear: Deviation | None = None) -> GearPair:
    """Pair with deviated flanks, for geometry and contact of the deviated surfaces themselves."""
    return replace(pair, pinion=deviated_member(pair.pinion, pinion), gear=deviated_member(pair.gear, gear))


@record(frozen=True)
class RecutFlank:
    """Designed flank at measuring points, from where flanks of other settings are found."""

    surface: GeneratingSurface
    section: BlankSection
    target: Array  # axial and radial coordinates (2, n) [mm]
    flank: Flank

    @classmethod
    def of(cls, member: Member, axial: Array, radial: Array) -> RecutFlank:
        """Loaded flank of a member at points (...) [mm]; GeometryError if one lies off the designed flank."""
        surface, target = member.loaded.designed, np.stack([np.ravel(axial), np.ravel(radial)])
        flank = solve_flank(surface, member.section, *target)
        if not np.all(np.isfinite(flank.position)):
            raise GeometryError("measured points lie off the designed flank: check the measuring grid")
        return cls(surface, member.section, target, flank)

    def at(self, chosen: Bools) -> RecutFlank:
        """The same flank at some of the points (n)."""
        arrays = {name: getattr(self.flank, name)[..., chosen] for name in Flank.ARRAYS}
        return replace(self, target=self.target[:, chosen], flank=replace(self.flank, **arrays))

    @cached_property
    def lever(self) -> Array:
        """Deviation of the points by a rotation of the tooth about its axis (n) [mm/rad]."""
        (x, y, _), (along_x, along_y, _) = self.flank.position, self.flank.normal
        return np.asarray(x * along_y - y * along_x)

    @cached_property
    def _parts(self) -> tuple[tuple[GeneratingSurface, Bools], ...]:
        """Parts of the flank that have points, and which ones (n)."""
        owned = [(part, self.flank.part == number) for number, part in enumerate(self.surface.flank_parts)]
        return tuple((part, mask) for part, mask in owned if np.any(mask))

    @cached_property
    def _orientation(self) -> Array:
        """Signs of the side of the surface that is the flank (n): on the other one it is undercut."""
        sign = np.empty(self.lever.shape)
        for part, mask in self._parts:
            sign[mask] = np.sign(part.orientation(self.flank.parameters[:, mask]))
        return sign

    def turn(self, surface: GeneratingSurface) -> float:
        """Rotation that brings a flank of another surface near the designed one [rad]; NaN without points.

        From points with the same axial and radial coordinates, weighted by their lever arms.
        """
        around = np.full(self.lever.shape, np.nan)
        for part, mask in self._parts:
            moved = surface.on(part.part)
            start, target = self.flank.parameters[:, mask], self.target[:, mask]
            solution = solve(moved.axial_and_radial, start, target, moved.max_step)
            position = moved.evaluate(solution.parameters)[0]
            around[mask] = np.where(solution.converged, np.arctan2(position[1], position[0]), np.nan)
        ahead = around - np.arctan2(self.flank.position[1], self.flank.position[0])
        ahead = np.mod(ahead + np.pi, 2.0 * np.pi) - np.pi
        weight = np.where(np.isfinite(ahead), self.lever**2, 0.0)
        return float(np.nansum(ahead * weight) / weight.sum()) if np.any(weight) else np.nan

    def distance(self, surface: GeneratingSurface, turn: float | None = None) -> Array:
        """Distance (n) [mm] along the normals to another surface, turned back: its deviation; positive for more metal.

        The turn [rad] is by default that of ``turn``. NaN where the normal misses the surface, or meets it undercut or
        beyond ``DEVIATION_LIMIT``.
        """
        ahead = np.full(self.lever.shape, self.turn(surface) if turn is None else turn)
        position, normal = rotate_z(ahead, self.flank.position), rotate_z(ahead, self.flank.normal)
        distances = np.full(ahead.shape, np.nan)
        for part, mask in self._parts:
            start = self.flank.parameters[:, mask]
            distance, points = normal_distance(surface.on(part.part), position[:, mask], normal[:, mask], start)
            usable = (points.orientation * self._orientation[mask] > 0.0) & (np.abs(distance) <= DEVIATION_LIMIT)
            distances[mask] = np.where(usable, distance, np.nan)
        return distances

    def displacement(self, surface: GeneratingSurface) -> Array:
        """Distance (n) [mm] to first order in the change of the settings, not turned back.

        A point cut by the same place of the blade at the same cradle rotation also slides along the surface, which is
        of second order for the distance.
        """
        moved = np.empty(self.lever.shape)
        for part, mask in self._parts:
            position = surface.on(part.part).evaluate(self.flank.parameters[:, mask])[0]
            moved[mask] = dot(position - self.flank.position[:, mask], self.flank.normal[:, mask])
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


GRID = ("lengthwise", "profile")


def deviated_ease_off(
    geometry: PairGeometry, *, pinion: Deviation | None = None, gear: Deviation | None = None
) -> xr.Dataset:
    """Ease-off and surface of roll angle of a pair with deviated flanks (Kolivand 2009, Eq. 4.3 to 4.10).

    Of first order, but the pinion's deviation goes by the lever arm of the gear's normal: both members count alike.
    Also ``ease_off_change`` [um], both deviations, and ``extrapolated``, 1 beyond the outermost nodes.
    """
    ease_off, ratio = geometry.ease_off, geometry.pair.assembly.ratio
    fields = {name: ease_off[name].transpose(*GRID).values for name in ("lever_arm", "ease_off_angle", "roll_angle")}
    lever, roll = fields["lever_arm"], fields["roll_angle"]
    t, h = np.meshgrid(ease_off["lengthwise"].values, ease_off["profile"].values, indexing="ij")
    pinion_t, pinion_h = (ease_off[f"pinion_{name}"].transpose(*GRID).values for name in GRID)
    on_gear, beyond_gear = _sampled(gear, t, h)
    on_pinion, beyond_pinion = _sampled(pinion, pinion_t, pinion_h)
    if pinion is not None:
        roll = roll + _later(geometry, pinion).reshape(t.shape)
    by_gear, by_pinion = 1.0 / lever, ratio / lever  # rotation of a member per deviation of its flank [rad/mm]
    change = -(on_pinion * by_pinion / ratio + on_gear * by_gear)
    angle = fields["ease_off_angle"] + change
    inside = ease_off["inside"].transpose(*GRID).values.astype(bool)
    # The difference of two zeros, so that without deviation nothing changes in the last digit.
    shift = first_contact(angle, inside) - first_contact(fields["ease_off_angle"], inside)
    return labelled(
        ease_off.assign(
            ease_off_angle=(GRID, angle - shift),
            ease_off=(GRID, ease_off["ease_off"].transpose(*GRID).values + 1e3 * (change - shift) * lever),
            roll_angle=(GRID, roll),
            pinion_deviation=(GRID, 1e3 * on_pinion),
            gear_deviation=(GRID, 1e3 * on_gear),
            ease_off_change=(GRID, 1e3 * change * lever),
            extrapolated=(GRID, (beyond_pinion | beyond_gear).astype(np.int8)),
        ).assign_attrs(first_contact_rad=ease_off.attrs["first_contact_rad"] + shift)
    )


def _sampled(deviation: Deviation | None, lengthwise: Array, profile: Array) -> tuple[Array, Bools]:
    """Deviation [mm] at fractions (nt, nh), and where it is taken beyond its outermost nodes."""
    if deviation is None:
        return np.zeros(lengthwise.shape), np.zeros(lengthwise.shape, dtype=bool)
    return deviation.at(lengthwise, profile), deviation.extrapolated(lengthwise, profile)


def _later(geometry: PairGeometry, deviation: Deviation) -> Array:
    """Change of the roll angle of the gear's nodes (n) by the pinion's deviation [rad]."""
    exact, moving = geometry.exact, geometry.drift
    position, lever = exact.pinion_position, exact.lever_arm
    value, slope = deviation.interpolant(position[2], np.hypot(position[0], position[1]))
    rate = (slope[0] * moving.axial + slope[1] * moving.radial) / lever - value * moving.lever_arm / lever**2
    return np.asarray(rate / exact.separation_curvature)
