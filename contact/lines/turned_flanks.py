"""Gap between the flanks of a pair at any pinion rotation, exact in the motion, with its derivatives on the gear flank.

A point of the gear closes its gap on a circle about the gear axis. The pinion flank, turned by its rotation, meets that
circle at an azimuth, found by Newton's method on the generated surface; its derivatives by the axial and the radial
coordinate follow from the pinion's normal. Less the azimuth of the gear flank that is the gap as a gear rotation.

An ease-off that was put in by hand or updated for deviations has no surface of its own. What it changes of the ease-off
is added to the gap, and what it changes of the roll angle is taken off the rotation: beside its own contact lines the
gap opens as that of the generated flanks does. That is right to the first order of the change.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.ordered_values import ordered
from ...geometry.cutting.generating_surface import GeneratingSurface
from ...geometry.flanks.flank import Flank, solve_parts
from ...geometry.flanks.flank_parts import pick
from ...geometry.newton import COLUMNS_PER_BLOCK
from ...geometry.pair.gear_pair import Member, PairGeometry
from .flank_cuts import FlankCuts
from .flank_splines import BENDS, VALUE_AND_SLOPES, FlankSplines, fit
from .turned_pinion import CirclesMet, circles_met, nearer_parameters

Array = NDArray[Any]

MISS_LIMIT = 0.1  # [mm]; a pinion part whose point is farther from where it is looked for has none
SAME_EASE_OFF_LIMIT = 1e-12  # [rad]; a change of the ease-off by less is that of a zero alone
#: Bounds of the flanks, in the order of ``margins``. After the edges come, for either member, where its flank part
#: begins, at the lowest part where the edge radius of the blade ends, where it ends, and where another cuts deeper.
BOUNDS = (
    *(f"{member}_{edge}" for member in ("gear", "pinion") for edge in ("toe", "heel", "root", "tip")),
    *(f"{member}_{end}" for end in ("blade", "joint", "crease") for member in ("gear", "pinion")),
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
        Parameters (2 p, n) of the points opposite on the p parts of the pinion flank, by one step of Newton's method
        from the given ones.
    following
        Their derivatives by the fractions (2 p, 2, n).
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
    def parts(self) -> tuple[tuple[GeneratingSurface, ...], tuple[Flank, ...]]:
        """Parts of the pinion flank, and those of the gear flank at the nodes."""
        gear, known = self.geometry.pair.gear, self.geometry.members.gear
        if len(gear.loaded.flank_parts) == 1:
            return self.geometry.exact.motion.surface.flank_parts, (known,)
        t, h = np.meshgrid(self.geometry.members.lengthwise, self.geometry.members.profile, indexing="ij")
        parts = solve_parts(gear.loaded, gear.section, *gear.section.points(t.ravel(), h.ravel()))
        return self.geometry.exact.motion.surface.flank_parts, parts

    @cached_property
    def continued(self) -> tuple[Flank, ...]:
        """Parts of the gear flank; one that exists on a lesser share of it is continued by what the others cut."""
        known = self.geometry.members.gear
        if len(self.parts[1]) == 1:
            return self.parts[1]
        flanks = []
        for number, part in enumerate(self.parts[1]):
            alone = np.isfinite(part.position[0]) | (np.mean(np.isfinite(part.position[0])) >= 0.5)
            names = ("parameters", "position", "normal", "blade_distance")
            taken = {name: np.where(alone, getattr(part, name), getattr(known, name)) for name in names}
            own = np.where(alone, number, known.part).astype(np.int8)
            flanks.append(replace(part, surface=known.surface, part=own, **taken))
        return tuple(flanks)

    @cached_property
    def own(self) -> tuple[FlankSplines, ...]:
        """Splines of every gear part's azimuth less what is put in, of a later roll angle, and of its blade."""
        geometry, exact = self.geometry, self.geometry.exact
        known, members = geometry.members.gear, geometry.members
        put_in, later = (
            _change(ordered(geometry.ease_off, name, "lengthwise", "profile").ravel(), values)
            for name, values in (("ease_off_angle", exact.angle), ("roll_angle", exact.roll_angle))
        )
        middle = np.nanmedian(np.arctan2(known.position[1], known.position[0]))
        splines = []
        for part in self.continued:
            x, y = part.position[:2]
            azimuth = np.mod(np.arctan2(y, x) - middle + np.pi, 2.0 * np.pi) - np.pi + middle
            values = (
                put_in - exact.motion.pinion_sense * azimuth,
                later,
                part.blade_distance / _depth(geometry.pair.gear),
            )
            grid = {name: np.reshape(v, geometry.nodes) for name, v in zip(_OWN_FIELDS, values, strict=True)}
            splines.append(fit(members.lengthwise, members.profile, grid))
        return tuple(splines)

    @property
    def part_count(self) -> int:
        """Number of combinations of a pinion part and a gear part."""
        return len(self.parts[0]) * len(self.parts[1])

    def at(self, points: Array, rotations: Array, parameters: Array, part: NDArray[np.int8]) -> TurnedGap:
        """Gap at points of the gear at pinion rotations.

        Parameters
        ----------
        points
            Lengthwise and profile fractions (2, n).
        rotations
            Pinion rotations (n) [rad], counted as the roll angle.
        parameters
            Parameters (2 p, n) near the points opposite, on each of the p parts of the pinion flank.
        part
            Index (n) of the parts that touch: of the pinion's, and p times that of the gear's.
        """
        if rotations.size > COLUMNS_PER_BLOCK:
            starts = range(0, rotations.size, COLUMNS_PER_BLOCK)
            cuts = [slice(i, i + COLUMNS_PER_BLOCK) for i in starts]
            found = [self.at(points[:, c], rotations[c], parameters[:, c], part[c]) for c in cuts]
            joined = (np.concatenate([getattr(f, one.name) for f in found], axis=-1) for one in fields(TurnedGap))
            return TurnedGap(*joined)
        of_gear, of_pinion = np.divmod(part, len(self.parts[0]))
        each = [spline.derivatives(_OWN_FIELDS, points, [*VALUE_AND_SLOPES, *BENDS]) for spline in self.own]
        taken = each[0] if len(each) == 1 else [_picked(values, of_gear) for values in zip(*each, strict=True)]
        value, by_t, by_h, by_tt, by_th, by_hh = taken
        slopes = {name: np.array([by_t[name], by_h[name]]) for name in _OWN_FIELDS}
        place, along, twist = self._circles(points)
        every = self._met(parameters, rotations - value["later"], place)
        met = every[0] if len(every) == 1 else _of_parts(every, of_pinion)

        mixed = np.sum(met.slope * twist, axis=0) + by_th["closing"]
        own_bend = np.array([[by_tt["closing"], mixed], [mixed, by_hh["closing"]]])
        t, h = points
        one, none = np.ones_like(t), np.zeros_like(t)
        gear_edges = [[one, none], [-one, none], [none, one], [none, -one]]
        lengthwise, profile, _ = _chain(met.bound_slopes, along)
        depths = _depth(self.geometry.pair.gear), _depth(self.geometry.pair.pinion)
        with np.errstate(invalid="ignore"):
            ends = (
                _gear_cuts(self.parts[1], each, depths[0]).margins(of_gear),
                _pinion_cuts(self.parts[0], every, along, depths[1]).margins(of_pinion),
            )
        ends_and_slopes = [np.stack(both, axis=1).reshape(6, *both[0].shape[1:]) for both in zip(*ends, strict=True)]
        return TurnedGap(
            gap=np.mod(met.azimuth + value["closing"] + np.pi, 2.0 * np.pi) - np.pi,
            slope=slopes["closing"] + _chain(met.slope, along) - met.ahead * slopes["later"],
            bend=own_bend + _chain(_chain(met.bend, along).swapaxes(0, 1), along),
            margins=np.array([t, 1.0 - t, h, 1.0 - h, *_between(met.bounds[:2]), *ends_and_slopes[0]]),
            margin_slopes=np.array([*gear_edges, lengthwise, -lengthwise, profile, -profile, *ends_and_slopes[1]]),
            parameters=np.concatenate([m.parameters for m in every]),
            following=np.concatenate([_chain(m.following, along) for m in every]),
            miss=met.miss,
        )

    def opposite(self, points: Array, rotations: Array, parameters: Array, part: NDArray[np.int8]) -> Array:
        """Parameters (2 p, n) of the points opposite, by one step of Newton's method; arguments as of ``at``."""
        place, of_gear = self._circles(points)[0], part // len(self.parts[0])
        later = pick([spline("later", points) for spline in self.own], of_gear)
        motion, near = self.geometry.exact.motion, np.split(parameters, len(self.parts[0]))
        each = zip(self.parts[0], near, strict=True)
        return np.concatenate([nearer_parameters(motion, *one, rotations - later, place) for one in each])

    def in_hole(self, points: Array, part: NDArray[np.int8]) -> NDArray[np.bool_]:
        """Whether points (2, n) lie in a cell of the gear's grid with a node without a value; ``part`` as of ``at``."""
        return pick([spline.in_hole(points) for spline in self.own], part // len(self.parts[0]))

    def _circles(self, points: Array) -> tuple[Array, Array, Array]:
        """Axial and radial coordinate (2, n) [mm], their derivatives (2, 2, n), and the second, mixed one (2, 1)."""
        (toe_root, toe_tip), (heel_root, heel_tip) = self.geometry.pair.gear.section.corners
        t, h = points
        by_t = np.multiply.outer(heel_root - toe_root, 1.0 - h) + np.multiply.outer(heel_tip - toe_tip, h)
        by_h = np.multiply.outer(toe_tip - toe_root, 1.0 - t) + np.multiply.outer(heel_tip - heel_root, t)
        twist = heel_tip - heel_root - toe_tip + toe_root
        return self.geometry.pair.gear.section.points(t, h), np.array([by_t, by_h]).swapaxes(0, 1), twist[:, None]

    def _met(self, parameters: Array, rotations: Array, place: Array) -> list[CirclesMet]:
        near = np.split(parameters, len(self.parts[0]))
        exact = self.geometry.exact
        return [circles_met(exact, *one, rotations, place) for one in zip(self.parts[0], near, strict=True)]


def _of_parts(every: list[CirclesMet], part: NDArray[np.int8]) -> CirclesMet:
    """Of what was met on every part, that on the part of an index (n)."""
    return CirclesMet(*(pick([getattr(met, one.name) for met in every], part) for one in fields(CirclesMet)))


def _picked(values: tuple[dict[str, Array], ...], part: NDArray[np.int8]) -> dict[str, Array]:
    return {name: pick([value[name] for value in values], part) for name in _OWN_FIELDS}


def _gear_cuts(parts: tuple[Flank, ...], each: list[list[dict[str, Array]]], depth: float) -> FlankCuts:
    """What the parts of the gear cut, from the values and derivatives of their splines."""
    value, by_t, by_h = (
        {name: np.stack([spline[k][name] for spline in each]) for name in _OWN_FIELDS} for k in range(3)
    )
    slope = {name: np.stack([by_t[name], by_h[name]], axis=1) for name in _OWN_FIELDS}
    ends = _ends([part.surface for part in parts], depth)
    known = np.ones(value["blade"].shape, dtype=bool)
    return FlankCuts(value["closing"], slope["closing"], value["blade"], slope["blade"], *ends, known)


def _pinion_cuts(
    parts: tuple[GeneratingSurface, ...], every: list[CirclesMet], along: Array, depth: float
) -> FlankCuts:
    """What the parts of the pinion cut, from where they are met."""
    azimuth = np.stack([met.azimuth for met in every])
    azimuth = azimuth[0] + np.mod(azimuth - azimuth[0] + np.pi, 2.0 * np.pi) - np.pi
    slopes = [_chain(np.stack([met.slope, met.bound_slopes[2] / depth]), along) for met in every]
    with np.errstate(invalid="ignore"):
        known = np.isfinite(azimuth) & (np.stack([met.miss for met in every]) < MISS_LIMIT)
    return FlankCuts(
        depth=azimuth,
        depth_slope=np.stack([slope[0] for slope in slopes]),
        coordinate=np.stack([met.bounds[2] for met in every]) / depth,
        coordinate_slope=np.stack([slope[1] for slope in slopes]),
        begin=_ends(parts, depth)[0],
        end=_ends(parts, depth)[1],
        known=known,
    )


def _ends(parts: Sequence[GeneratingSurface], depth: float) -> tuple[Array, Array]:
    """Ends (p) of the blade sections, as fractions of a flank's depth; the lowest part begins with the flank."""
    begin = [0.0, *(part.section.begin / depth for part in parts[1:])]
    return np.array(begin), np.array([part.section.end / depth for part in parts])


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
