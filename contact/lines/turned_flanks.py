"""Gap between the flanks of a pair at any pinion rotation, exact in the motion, with its derivatives on the gear flank.

A point of the gear closes its gap on a circle about the gear axis. The pinion flank, turned by its rotation, meets that
circle at an azimuth, found by Newton's method on the generated surface; its derivatives by the axial and the radial
coordinate follow from the pinion's normal. Less the azimuth of the gear flank that is the gap as a gear rotation.

An ease-off that was put in by hand or updated for deviations has no surface of its own. What it changes of the ease-off
is added to the gap, and what it changes of the roll angle is taken off the rotation: beside its own contact lines the
gap opens as that of the generated flanks does. That is right to the first order of the change.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.cutting.generating_surface import GeneratingSurface
from ...geometry.flanks.flank_parts import pick
from ...geometry.newton import COLUMNS_PER_BLOCK, complex_steps, cramers_rule
from ...geometry.pair.conjugate_motion import ConjugateMotion
from ...geometry.pair.ease_off import EaseOff
from ...geometry.pair.gear_pair import Member, PairGeometry
from ...geometry.vectors import column, rotate
from .flank_splines import FlankSplines, fit

Array = NDArray[Any]

SAME_EASE_OFF_LIMIT = 1e-12  # [rad]; a change of the ease-off by less is that of a zero alone
#: Bounds of the flanks, in the order of ``margins``. After the edges come the places where the edge radius of a blade
#: begins to cut or, on an upper flank part of the pinion, where the part below ends.
#: The last is where that part ends itself.
BOUNDS = (
    *(f"{member}_{edge}" for member in ("gear", "pinion") for edge in ("toe", "heel", "root", "tip")),
    "gear_blade",
    "pinion_blade",
    "pinion_joint",
)
_OWN_FIELDS = ["closing", "later", "blade"]


@dataclass(frozen=True)
class TurnedGap:
    """Gap at points (n) of the gear flank at pinion rotations (n).

    Parameters
    ----------
    gap
        As a gear rotation [rad].
    slope, bend
        Its derivatives by the fractions (2, n) and (2, 2, n) [rad].
    margins
        How far inside each of the ``BOUNDS`` (b, n) the point lies, as a fraction of the flank; negative outside.
    margin_slopes
        Their derivatives by the fractions (b, 2, n).
    parameters
        Parameters (2, n) of the pinion point opposite, by one step of Newton's method from the given ones.
    following
        Their derivatives by the fractions (2, 2, n).
    miss
        Distance (n) from the circle to the pinion point at the given parameters [mm]: everything is extrapolated over
        it.
    """

    gap: Array
    slope: Array
    bend: Array
    margins: Array
    margin_slopes: Array
    parameters: Array
    following: Array
    miss: Array


@dataclass(frozen=True)
class TurnedFlanks:
    """Both flanks of a pair at any pinion rotation.

    Parameters
    ----------
    geometry
        The pair, with the ease-off of its flanks or another one on the same grid.
    """

    geometry: PairGeometry

    @cached_property
    def own(self) -> FlankSplines:
        """Splines of what belongs to the gear flank: its azimuth less what is put in, a later roll angle, its blade."""
        geometry, exact = self.geometry, self.geometry.exact
        gear, members = geometry.members.gear, geometry.members
        put_in, later = (
            _change(geometry.ease_off[name].transpose("lengthwise", "profile").values.ravel(), values)
            for name, values in (("ease_off_angle", exact.angle), ("roll_angle", exact.roll_angle))
        )
        azimuth = np.arctan2(gear.position[1], gear.position[0])
        middle = np.nanmedian(azimuth)
        azimuth = np.mod(azimuth - middle + np.pi, 2.0 * np.pi) - np.pi + middle
        values = (put_in - exact.motion.pinion_sense * azimuth, later, gear.blade_distance / _depth(geometry.pair.gear))
        grid = {name: np.reshape(v, geometry.nodes) for name, v in zip(_OWN_FIELDS, values, strict=True)}
        return fit(members.lengthwise, members.profile, grid)

    def at(self, points: Array, rotations: Array, parameters: Array, part: NDArray[np.int8]) -> TurnedGap:
        """Gap at points of the gear at pinion rotations.

        Parameters
        ----------
        points
            Lengthwise and profile fractions (2, n).
        rotations
            Pinion rotations (n) [rad], counted as the roll angle.
        parameters
            Pinion parameters (2, n) near the point opposite.
        part
            Index (n) of the pinion's flank part on which it lies.
        """
        if rotations.size > COLUMNS_PER_BLOCK:
            starts = range(0, rotations.size, COLUMNS_PER_BLOCK)
            cuts = [slice(i, i + COLUMNS_PER_BLOCK) for i in starts]
            found = [self.at(points[:, c], rotations[c], parameters[:, c], part[c]) for c in cuts]
            joined = (np.concatenate([getattr(f, one.name) for f in found], axis=-1) for one in fields(TurnedGap))
            return TurnedGap(*joined)
        value, by_t, by_h, by_tt, by_th, by_hh = (
            self.own.evaluate(_OWN_FIELDS, points, d) for d in ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
        )
        slopes = {name: np.stack([by_t[name], by_h[name]]) for name in _OWN_FIELDS}
        place, along, twist = self._circles(points)
        met = self._met(parameters, rotations - value["later"], place, part)

        mixed = np.sum(met.slope * twist, axis=0) + by_th["closing"]
        own_bend = np.stack([np.stack([by_tt["closing"], mixed]), np.stack([mixed, by_hh["closing"]])])
        t, h = points
        one, none = np.ones_like(t), np.zeros_like(t)
        of_gear = [[one, none], [-one, none], [none, one], [none, -one]]
        lengthwise, profile, blade, joint = _chain(met.bound_slopes, along)
        return TurnedGap(
            gap=np.mod(met.azimuth + value["closing"] + np.pi, 2.0 * np.pi) - np.pi,
            slope=slopes["closing"] + _chain(met.slope, along) - met.ahead * slopes["later"],
            bend=own_bend + _chain(_chain(met.bend, along).swapaxes(0, 1), along),
            margins=np.stack([t, 1.0 - t, h, 1.0 - h, *_between(met.bounds[:2]), value["blade"], *met.bounds[2:]]),
            margin_slopes=np.stack(
                [*map(np.stack, of_gear), lengthwise, -lengthwise, profile, -profile, slopes["blade"], blade, joint]
            ),
            parameters=met.parameters,
            following=_chain(met.following, along),
            miss=met.miss,
        )

    def opposite(self, points: Array, rotations: Array, parameters: Array, part: NDArray[np.int8]) -> Array:
        """Parameters (2, n) of the pinion points opposite, by one step of Newton's method; arguments as of ``at``."""
        place, later = self._circles(points)[0], self.own("later", points)
        return self._met(parameters, rotations - later, place, part).parameters

    def _circles(self, points: Array) -> tuple[Array, Array, Array]:
        """Axial and radial coordinate (2, n) [mm], their derivatives (2, 2, n), and the second, mixed one (2, 1)."""
        (toe_root, toe_tip), (heel_root, heel_tip) = self.geometry.pair.gear.section.corners
        t, h = points
        by_t = np.multiply.outer(heel_root - toe_root, 1.0 - h) + np.multiply.outer(heel_tip - toe_tip, h)
        by_h = np.multiply.outer(toe_tip - toe_root, 1.0 - t) + np.multiply.outer(heel_tip - heel_root, t)
        twist = heel_tip - heel_root - toe_tip + toe_root
        return self.geometry.pair.gear.section.points(t, h), np.stack([by_t, by_h], axis=1), twist[:, None]

    def _met(self, parameters: Array, rotations: Array, place: Array, part: NDArray[np.int8]) -> _Met:
        exact = self.geometry.exact
        depth = _depth(self.geometry.pair.pinion)
        parts = exact.motion.surface.flank_parts
        met = [_met(exact, surface, parameters, rotations, place, depth) for surface in parts]
        if len(met) == 1:
            return met[0]
        return _Met(*(pick([getattr(m, one.name) for m in met], part) for one in fields(_Met)))


@dataclass(frozen=True)
class _Met:
    """Where circles (n) about the gear axis meet the pinion flank; derivatives by axial and radial coordinate.

    Parameters
    ----------
    azimuth
        In the drive sense of the gear, the gear turned by the ratio [rad].
    slope, bend
        Its derivatives (2, n) and (2, 2, n) [rad/mm, rad/mm^2].
    ahead
        Its derivative by the pinion rotation (n).
    bounds, bound_slopes
        Lengthwise and profile fraction, and distances along the blade from both ends of the section that cuts, as
        fractions of the flank's depth (4, n), and their derivatives (4, 2, n).
    parameters, following
        Surface parameters (2, n) and their derivatives (2, 2, n).
    miss
        Distance (n) over which all this is extrapolated [mm].
    """

    azimuth: Array
    slope: Array
    bend: Array
    ahead: Array
    bounds: Array
    bound_slopes: Array
    parameters: Array
    following: Array
    miss: Array


def _met(
    exact: EaseOff, surface: GeneratingSurface, parameters: Array, rotations: Array, place: Array, depth: float
) -> _Met:
    """Circles at axial and radial coordinates (2, n) with the flank turned by rotations (n) and its parameters near."""
    motion, section = exact.motion, exact.pinion_section
    turned = rotations + motion.center

    def seen(p: Array) -> Array:
        own, own_normal, coordinate = surface.evaluate(p)
        x, y, z, *normal = _in_space(motion, own, own_normal, np.tile(turned, p.shape[1] // turned.size))
        radial = np.sqrt(x**2 + y**2)
        # Along the surface the azimuth changes so that the step is at right angles to the normal.
        share = -motion.pinion_sense / (x * normal[1] - y * normal[0])
        by_radial = share * (x * normal[0] + y * normal[1]) / radial
        bounds = section.fractions(own[2], np.sqrt(own[0] ** 2 + own[1] ** 2))
        return np.stack([z, radial, share * normal[2], by_radial, *bounds, coordinate / depth, x, y, *normal])

    cut = surface.section
    begin = cut.begin if surface.part != motion.surface.flank_parts[0].part else 0.0

    with np.errstate(all="ignore"):
        value, (first, second) = complex_steps(seen, parameters)
        inverse = np.stack([cramers_rule(first[:2], second[:2], unit) for unit in np.eye(2)], axis=1)
        away = place - value[:2]
        slopes = first[:, None] * inverse[0] + second[:, None] * inverse[1]
        bend, bound_slopes = slopes[2:4], slopes[4:7]
        slope, bounds = value[2:4] + _along(bend, away), value[4:7] + _along(bound_slopes, away)
        x, y, z = value[7], value[8], value[0]
        here = np.stack([x, y, z + motion.assembly.gear_origin[2]])
        azimuth = motion.pinion_sense * np.arctan2(y, x) + turned / motion.assembly.ratio
        return _Met(
            azimuth=azimuth + np.sum((value[2:4] + 0.5 * _along(bend, away)) * away, axis=0),
            slope=slope,
            bend=bend,
            ahead=-motion.closing_velocity(here, value[9:12]),
            bounds=np.stack([*bounds[:2], bounds[2] - begin / depth, cut.end / depth - bounds[2]]),
            bound_slopes=np.concatenate([bound_slopes, -bound_slopes[2:]]),
            parameters=parameters + _along(inverse, away),
            following=inverse,
            miss=np.max(np.abs(away), axis=0),
        )


def _in_space(motion: ConjugateMotion, position: Array, normal: Array, turned: Array) -> Array:
    """Pinion points from the origin of the gear, and below them their normals (6, n), after the pinion has turned."""
    assembly = motion.assembly
    position, normal = assembly.pinion_to_global(position, normal)
    origin = column(assembly.pinion_origin, position)
    position = rotate(motion.pinion_axis, turned, position - origin) + origin
    gear = column(assembly.gear_origin, position)
    return np.concatenate([position - gear, rotate(motion.pinion_axis, turned, normal)])


def _along(slopes: Array, way: Array) -> Array:
    """Changes (k, n) over a way (2, n) of quantities with derivatives (k, 2, n)."""
    return np.asarray(slopes[:, 0] * way[0] + slopes[:, 1] * way[1])


def _chain(outer: Array, inner: Array) -> Array:
    """Derivatives (..., 2, n) by the fractions, from those by the coordinates (..., 2, n) and of these (2, 2, n)."""
    with np.errstate(invalid="ignore"):  # infinite where the pinion has no normal opposite
        return np.asarray(outer[..., 0, None, :] * inner[0] + outer[..., 1, None, :] * inner[1])


def _between(fractions: Array) -> list[Array]:
    """Distances of fractions (2, n) from 0 and from 1, one after the other."""
    return [side for fraction in fractions for side in (fraction, 1.0 - fraction)]


def _change(values: Array, exact: Array) -> Array:
    """What an ease-off's field (n) has beside that of the flanks; one number where both are the same but for a zero."""
    change = values - exact
    constant = float(np.nanmedian(change))
    return np.where(np.nanmax(np.abs(change - constant)) < SAME_EASE_OFF_LIMIT, constant, change)


def _depth(member: Member) -> float:
    """Depth of a flank at its toe [mm]."""
    root, tip = member.section.corners[0]
    return float(np.linalg.norm(tip - root))
