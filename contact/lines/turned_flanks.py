"""Gap between the flanks of a pair at any pinion rotation, exact in the motion, with its derivatives on the gear flank.

A point of the gear closes its gap on a circle about the gear axis. The pinion flank, turned by its rotation, meets that
circle at an azimuth, found by Newton's method on the generated surface; its derivatives by the axial and the radial
coordinate follow from the pinion's normal. Less the azimuth of the gear flank that is the gap as a gear rotation.

An ease-off that was put in by hand or updated for deviations has no surface of its own. What it changes of the ease-off
is added to the gap, and what it changes of the roll angle is taken off the rotation: beside its own contact lines the
gap opens as that of the generated flanks does. That is right to the first order of the change.

A blade with a toprem or flankrem cuts every part of the flank with a section of its own. Where sections join at a
protruding kink both cut the same points, and the deeper cut remains (``geometry/flanks/flank.py``). A part ends where
its blade section does, or where another cuts deeper.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...core.arrays import Array, Bools
from ...core.attributes import ordered
from ...geometry.cutting.generating_surface import GeneratingSurface, area_ratio
from ...geometry.flanks.flank import Flank, pick, seed_lattice, solve_parts
from ...geometry.newton import COLUMNS_PER_BLOCK, complex_steps, cramers_rule, determinant
from ...geometry.pair.conjugate_motion import ConjugateMotion
from ...geometry.pair.ease_off import EaseOff
from ...geometry.pair.gear_pair import Member, PairGeometry
from ...geometry.vectors import column, cos_sin, turn_z
from .flank_splines import BENDS, VALUE_AND_SLOPES, FlankSplines, fit

KINK_LIMIT = 1e-5  # [rad per fraction of the flank]; below it two cuts join smoothly, and their sections' ends decide


@dataclass(frozen=True)
class FlankCuts:
    """Cuts of every part (p) of a flank at points (n), with derivatives by the fractions."""

    depth: Array  # metal removed, as a rotation that opens the gap (p, n) [rad]
    depth_slope: Array
    coordinate: Array  # along the blade, as a fraction of the flank's depth (p, n)
    coordinate_slope: Array
    begin: Array  # of the section (p); lowest part: end of the blade's edge radius
    end: Array
    known: Bools

    def margins(self, part: NDArray[np.int8]) -> tuple[Array, Array]:
        """Fractions (3, n) by which the cut of one part (n) lies inside its bounds, and their derivatives (3, 2, n).

        From the beginning of its section, from the end of it, and from where another part cuts deeper.
        """
        columns = np.arange(part.size)
        depth, depth_slope = self.depth[part, columns], self.depth_slope[part, :, columns].T
        coordinate, slope = self.coordinate[part, columns], self.coordinate_slope[part, :, columns].T
        cut, cut_slope = np.full(part.size, np.inf), np.zeros((2, part.size))
        for other in range(self.begin.size if self.begin.size > 1 else 0):
            away, away_slope = self._beyond(other)
            with np.errstate(all="ignore"):
                # Both as distances on the flank: from where the other section ends, and from where it cuts as deep.
                steepness = np.linalg.norm(depth_slope - self.depth_slope[other], axis=0)
                kinked = steepness > KINK_LIMIT
                scale = np.where(kinked, np.linalg.norm(away_slope, axis=0) / steepness, 0.0)
                deeper = scale * (depth - self.depth[other])
                kinked &= deeper > away
            away = np.where(kinked, deeper, away)
            away_slope = np.where(kinked, scale * (depth_slope - self.depth_slope[other]), away_slope)
            nearer = (part != other) & self.known[other] & (away < cut)
            cut, cut_slope = np.where(nearer, away, cut), np.where(nearer, away_slope, cut_slope)
        margins = [coordinate - self.begin[part], self.end[part] - coordinate, cut]
        return np.stack(margins), np.stack([slope, -slope, cut_slope])

    def _beyond(self, part: int) -> tuple[Array, Array]:
        """Distance (n) of points beyond the nearer end of a part's section, and the derivatives (2, n)."""
        coordinate, slope = self.coordinate[part], self.coordinate_slope[part]
        below = self.begin[part] - coordinate if part > 0 else np.full(coordinate.size, -np.inf)
        above = coordinate - self.end[part]
        return np.maximum(below, above), np.where(below > above, -slope, slope)


@dataclass(frozen=True)
class CirclesMet:
    """Points where circles (n) about the gear axis meet the pinion; derivatives by axial and radial coordinate."""

    azimuth: Array  # in the drive sense, the gear turned by the ratio [rad]
    slope: Array
    bend: Array
    ahead: Array  # derivative of the azimuth by the pinion rotation
    bounds: Array  # both fractions, and coordinate along the blade [mm] (3, n)
    bound_slopes: Array
    parameters: Array
    following: Array
    miss: Array  # distance of extrapolation [mm]; infinite where undercut


def circles_met(
    exact: EaseOff, surface: GeneratingSurface, parameters: Array, rotations: Array, place: Array
) -> CirclesMet:
    """Points where circles meet one part of the pinion flank, near its ``parameters`` (2, n), at rotations (n) [rad].

    ``place`` has the axial and radial coordinates (2, n) of the circles [mm].
    """
    if rotations.size > COLUMNS_PER_BLOCK:  # of which each has a rotation of its own
        parts = _blocks(rotations.size)
        blocks = [circles_met(exact, surface, parameters[:, i], rotations[i], place[:, i]) for i in parts]
        joined = (np.concatenate([getattr(met, one.name) for met in blocks], axis=-1) for one in fields(CirclesMet))
        return CirclesMet(*joined)
    motion, section = exact.motion, exact.pinion_section
    turned = rotations + motion.center

    def seen(p: Array) -> Array:
        points, own_normal, coordinate = surface.evaluate(p)
        (x, y, z), normal = _in_space(motion, np.tile(turned, len(parameters)), points, own_normal)
        radial = np.sqrt(x**2 + y**2)
        # Along the surface the azimuth changes so that the step is at right angles to the normal.
        share = -motion.pinion_sense / (x * normal[1] - y * normal[0])
        by_radial = share * (x * normal[0] + y * normal[1]) / radial
        bounds = section.fractions(points[2], np.sqrt(points[0] ** 2 + points[1] ** 2))
        return np.array([x, y, z, radial, share * normal[2], by_radial, *bounds, coordinate, *normal])

    with np.errstate(all="ignore"):
        value, (first, second) = complex_steps(seen, parameters)
        inverse = np.array([[second[3], -second[2]], [-first[3], first[2]]]) / determinant(first[2:4], second[2:4])
        away = place - value[2:4]
        slopes = first[4:9, None] * inverse[0] + second[4:9, None] * inverse[1]
        bend, bound_slopes = slopes[:2], slopes[2:]
        position, normal = value[:3], value[9:]
        cut = area_ratio(first[:3], second[:3], normal) * seed_lattice(surface, section).orientation > 0.0
        azimuth = motion.pinion_sense * np.arctan2(value[1], value[0]) + turned / motion.assembly.ratio
        return CirclesMet(
            azimuth=azimuth + np.sum((value[4:6] + 0.5 * _along(bend, away)) * away, axis=0),
            slope=value[4:6] + _along(bend, away),
            bend=bend,
            ahead=-motion.closing_velocity(position + column(motion.assembly.gear_origin, position), normal),
            bounds=value[6:9] + _along(bound_slopes, away),
            bound_slopes=bound_slopes,
            parameters=parameters + _along(inverse, away),
            following=inverse,
            miss=np.where(cut, np.max(np.abs(away), axis=0), np.inf),
        )


def nearer_parameters(
    motion: ConjugateMotion, surface: GeneratingSurface, parameters: Array, rotations: Array, place: Array
) -> Array:
    """Of ``circles_met`` the parameters (2, n) alone."""
    if rotations.size > COLUMNS_PER_BLOCK:
        parts = _blocks(rotations.size)
        blocks = [nearer_parameters(motion, surface, parameters[:, i], rotations[i], place[:, i]) for i in parts]
        return np.concatenate(blocks, axis=-1)
    turned = rotations + motion.center

    def seen(p: Array) -> Array:
        ((x, y, z),) = _in_space(motion, np.tile(turned, len(parameters)), surface.evaluate(p)[0])
        return np.array([z, np.sqrt(x**2 + y**2)])

    with np.errstate(all="ignore"):
        value, (first, second) = complex_steps(seen, parameters)
        return parameters + cramers_rule(first, second, place - value)


def _blocks(count: int) -> list[slice]:
    return [slice(start, start + COLUMNS_PER_BLOCK) for start in range(0, count, COLUMNS_PER_BLOCK)]


def _in_space(motion: ConjugateMotion, turned: Array, *vectors: Array) -> tuple[Array, ...]:
    """Pinion points (3, n) from the origin of the gear, and normals (3, n) if given, after the pinion has turned."""
    assembly = motion.assembly
    cosine, sine = cos_sin(motion.pinion_sense * turned)
    turned_vectors = [np.tensordot(assembly.pinion_frame, turn_z(cosine, sine, vector), axes=1) for vector in vectors]
    turned_vectors[0] += column(assembly.pinion_origin - assembly.gear_origin, turned_vectors[0])
    return tuple(turned_vectors)


def _along(slopes: Array, way: Array) -> Array:
    """Changes (k, n) over a way (2, n) of quantities with derivatives (k, 2, n)."""
    return np.asarray(slopes[:, 0] * way[0] + slopes[:, 1] * way[1])


MISS_LIMIT = 0.1  # [mm]; a pinion part whose point is farther from where it is looked for has none
SAME_EASE_OFF_LIMIT = 1e-12  # [rad]; a change of the ease-off by less is that of a zero alone
#: Bounds of the flanks, in the order of ``margins``. After the edges come, for either member, where its flank part
#: begins, at the lowest part where the edge radius of the blade ends, where it ends, and where another cuts deeper.
BOUNDS = (
    *(f"{member}_{edge}" for member in ("gear", "pinion") for edge in ("toe", "heel", "root", "tip")),
    *(f"{member}_{end}" for end in ("blade", "joint", "crease") for member in ("gear", "pinion")),
)
_GEAR_FIELDS = ["closing", "later", "blade"]


@dataclass(frozen=True)
class TurnedGap:
    """Gap at points (n) of the gear flank at pinion rotations (n), with derivatives by the fractions."""

    gap: Array
    slope: Array
    bend: Array
    margins: Array  # inside each of the BOUNDS, in fractions (b, n); negative outside
    margin_slopes: Array
    parameters: Array
    following: Array
    miss: Array  # from circle to pinion point, extrapolated over [mm]


@dataclass(frozen=True)
class TurnedFlanks:
    """Both flanks of a pair at any pinion rotation."""

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
            part_numbers = np.where(alone, number, known.part).astype(np.int8)
            flanks.append(replace(part, surface=known.surface, part=part_numbers, **taken))
        return tuple(flanks)

    @cached_property
    def gear_splines(self) -> tuple[FlankSplines, ...]:
        """Splines of every gear part's azimuth less what is put in, of a later roll angle, and of its blade."""
        geometry, exact = self.geometry, self.geometry.exact
        known, members = geometry.members.gear, geometry.members
        put_in, later = (
            _change(ordered(geometry.ease_off, name, "lengthwise", "profile").ravel(), values)
            for name, values in (("ease_off_angle", exact.angle), ("roll_angle", exact.roll_angle))
        )
        middle = np.nanmedian(np.arctan2(known.position[1], known.position[0]))
        splines, depth = [], _depth(geometry.pair.gear)
        for part in self.continued:
            x, y = part.position[:2]
            azimuth = np.mod(np.arctan2(y, x) - middle + np.pi, 2.0 * np.pi) - np.pi + middle
            closing, blade = put_in - exact.motion.pinion_sense * azimuth, part.blade_distance / depth
            values = closing, later, blade
            grid = {name: np.reshape(v, geometry.nodes) for name, v in zip(_GEAR_FIELDS, values, strict=True)}
            splines.append(fit(members.lengthwise, members.profile, grid))
        return tuple(splines)

    def at(self, points: Array, rotations: Array, parameters: Array, part: NDArray[np.int8]) -> TurnedGap:
        """Gap at points (2, n) of the gear at pinion rotations (n) [rad], counted as the roll angle.

        ``parameters`` (2 p, n) are near the points opposite, on each of the p parts of the pinion flank; ``part`` (n)
        is the index of the pinion's part that touches, plus p times that of the gear's.
        """
        if rotations.size > COLUMNS_PER_BLOCK:
            cuts = _blocks(rotations.size)
            blocks = [self.at(points[:, c], rotations[c], parameters[:, c], part[c]) for c in cuts]
            joined = (np.concatenate([getattr(f, one.name) for f in blocks], axis=-1) for one in fields(TurnedGap))
            return TurnedGap(*joined)
        of_gear, of_pinion = np.divmod(part, len(self.parts[0]))
        each = [spline.derivatives(_GEAR_FIELDS, points, [*VALUE_AND_SLOPES, *BENDS]) for spline in self.gear_splines]
        taken = each[0] if len(each) == 1 else [_picked(values, of_gear) for values in zip(*each, strict=True)]
        value, by_t, by_h, by_tt, by_th, by_hh = taken
        slopes = {name: np.array([by_t[name], by_h[name]]) for name in _GEAR_FIELDS}
        place, along, twist = self._circles(points)
        near = zip(self.parts[0], np.split(parameters, len(self.parts[0])), strict=True)
        every = [circles_met(self.geometry.exact, *one, rotations - value["later"], place) for one in near]
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
        later = pick([spline("later", points) for spline in self.gear_splines], of_gear)
        motion = self.geometry.exact.motion
        near = zip(self.parts[0], np.split(parameters, len(self.parts[0])), strict=True)
        return np.concatenate([nearer_parameters(motion, *one, rotations - later, place) for one in near])

    def in_hole(self, points: Array, part: NDArray[np.int8]) -> Bools:
        """True where points (2, n) lie in a cell of the gear's grid with a node without a value."""
        return pick([spline.in_hole(points) for spline in self.gear_splines], part // len(self.parts[0]))

    def _circles(self, points: Array) -> tuple[Array, Array, Array]:
        """Axial and radial coordinate (2, n) [mm], their derivatives (2, 2, n), and the second, mixed one (2, 1)."""
        (toe_root, toe_tip), (heel_root, heel_tip) = self.geometry.pair.gear.section.corners
        t, h = points
        by_t = np.multiply.outer(heel_root - toe_root, 1.0 - h) + np.multiply.outer(heel_tip - toe_tip, h)
        by_h = np.multiply.outer(toe_tip - toe_root, 1.0 - t) + np.multiply.outer(heel_tip - heel_root, t)
        twist = heel_tip - heel_root - toe_tip + toe_root
        return self.geometry.pair.gear.section.points(t, h), np.array([by_t, by_h]).swapaxes(0, 1), twist[:, None]


def _of_parts(every: list[CirclesMet], part: NDArray[np.int8]) -> CirclesMet:
    """Of what was met on every part, that on the part of an index (n)."""
    return CirclesMet(*(pick([getattr(met, one.name) for met in every], part) for one in fields(CirclesMet)))


def _picked(values: tuple[dict[str, Array], ...], part: NDArray[np.int8]) -> dict[str, Array]:
    return {name: pick([value[name] for value in values], part) for name in _GEAR_FIELDS}


def _gear_cuts(parts: tuple[Flank, ...], each: list[list[dict[str, Array]]], depth: float) -> FlankCuts:
    """Cuts of the parts of the gear, from the values and derivatives of their splines."""
    value, by_t, by_h = ({name: np.stack([one[k][name] for one in each]) for name in _GEAR_FIELDS} for k in range(3))
    slope = {name: np.stack([by_t[name], by_h[name]], axis=1) for name in _GEAR_FIELDS}
    ends = _ends([part.surface for part in parts], depth)
    known = np.ones(value["blade"].shape, dtype=bool)
    return FlankCuts(value["closing"], slope["closing"], value["blade"], slope["blade"], *ends, known)


def _pinion_cuts(parts: tuple[GeneratingSurface, ...], each: list[CirclesMet], along: Array, depth: float) -> FlankCuts:
    """Cuts of the parts of the pinion, from where they are met."""
    azimuth = np.stack([met.azimuth for met in each])
    azimuth = azimuth[0] + np.mod(azimuth - azimuth[0] + np.pi, 2.0 * np.pi) - np.pi
    slopes = [_chain(np.stack([met.slope, met.bound_slopes[2] / depth]), along) for met in each]
    with np.errstate(invalid="ignore"):
        known = np.isfinite(azimuth) & (np.stack([met.miss for met in each]) < MISS_LIMIT)
    coordinate = np.stack([met.bounds[2] for met in each]) / depth
    depth_slope, coordinate_slope = (np.stack(parts_slopes) for parts_slopes in zip(*slopes, strict=True))
    return FlankCuts(azimuth, depth_slope, coordinate, coordinate_slope, *_ends(parts, depth), known)


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
    """Difference of an ease-off's field (n) from that of the flanks; one number if it is the same everywhere."""
    change = values - exact
    constant = float(np.nanmedian(change))
    return np.where(np.nanmax(np.abs(change - constant)) < SAME_EASE_OFF_LIMIT, constant, change)


def _depth(member: Member) -> float:
    """Depth of a flank at its toe [mm]."""
    root, tip = member.section.corners[0]
    return float(np.linalg.norm(tip - root))
