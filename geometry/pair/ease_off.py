"""Ease-off and surface of roll angle of a pair, on the grid of the gear flank.

For every gear node the pinion point is sought whose conjugate gear point has the node's axial and radial coordinates;
the two then differ by a rotation about the gear axis alone. That rotation is the ease-off as an angle, the pinion
rotation that makes the conjugate point is the roll angle (Kolivand 2009, sections 2.5 and 4.2). No first-order
shortcut is taken.

Sliding of the flanks, and speed of the contact line across either flank, are velocities by the pinion rotation
[mm/rad], at points in conjugate contact. Times the pinion's angular velocity they are velocities in space.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.arrays import Array, Bools, record
from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface, SurfacePoints, points_at
from ..flanks.blank_section import BlankSection
from ..flanks.flank import Flank, NodeStatus, SeedLattice, deepest, mean_parameters, on_parts, pick, seed_lattice
from ..newton import complex_steps, cramers_rule, determinant
from ..vectors import column, cross, dot
from .assembly import Assembly
from .conjugate_motion import ConjugateMotion


@record(frozen=True)
class EaseOff:
    """Ease-off of a pair at the nodes (n) of the gear flank, with the conjugate point of each on the pinion."""

    motion: ConjugateMotion
    pinion_section: BlankSection
    pinion_parameters: Array
    pinion_passing: Array  # (2, 2, n) of the points that face the node SKEW_STEP before and after
    pinion_position: Array
    pinion_normal: Array
    action_position: Array  # of conjugate contact (3, n) [mm], in the global frame
    action_normal: Array
    roll_angle: Array  # pinion rotation [rad], zero at the pinion's mean point
    angle: Array  # gear rotation [rad] against the drive sense to contact, growing with the gap, up to a constant
    lever_arm: Array
    separation_curvature: Array  # second derivative of the gap by the pinion rotation at a fixed gear point [1/rad]
    separation_skew: Array  # third derivative [1/rad^2]
    pinion_lengthwise: Array
    pinion_profile: Array
    blade_distance: Array  # along the blade to its edge radius [mm], the smaller of both; negative without a flank
    status: NDArray[np.int8]
    part: NDArray[np.int8]

    @property
    def inside(self) -> Bools:
        """True where gear node and conjugate pinion point both lie on their flanks (n)."""
        return np.asarray(self.status == NodeStatus.INSIDE)


def conjugate_motion(
    surface: GeneratingSurface, section: BlankSection, assembly: Assembly, gear_middle: Array
) -> ConjugateMotion:
    """Conjugate motion of a pinion flank: sense of drive rotation, and root branch from the pinion's mean point.

    The right root meets ``gear_middle``: axial and radial coordinate (2) [mm] of the middle of the gear flank.
    """
    # Of the designed flank: a deviation does not move the zero of the roll angle.
    designed = surface.designed
    mean = mean_parameters(designed, section)
    position, normal, _ = designed.evaluate(mean)
    # The pinion pushes along its outward normal; that is the sense in which this flank drives.
    sense = float(np.sign(position[0] * normal[1] - position[1] * normal[0])[0])
    motion = ConjugateMotion(designed, assembly, sense)
    roots = motion.roots(*motion.pinion_point(mean))
    if not np.isfinite(roots[0][0]):
        raise GeometryError(
            "the middle of the pinion flank never meets a conjugate gear: check shaft_angle, "
            "hypoid_offset and the hands of the members"
        )
    misses = []
    for root in roots:
        point = motion.in_gear(motion.action_point(mean, root)[0], root)[:, 0]
        misses.append(np.hypot(point[2] - gear_middle[0], np.hypot(point[0], point[1]) - gear_middle[1]))
    choice = int(np.argmin(misses))
    return replace(motion, surface=surface, branch=(1.0, -1.0)[choice], center=float(roots[choice][0]))


SKEW_STEP = 1e-3  # [rad]; central difference of a smooth function: error 1e-6 of it


def _separation(motion: ConjugateMotion, points: SurfacePoints, rotation: Array) -> tuple[Array, Array, Array]:
    """Second and third derivative (n) of the gap by the pinion rotation at a fixed gear point; ``pinion_passing``."""
    (_, *place), slopes = motion.closing_and_place(points, rotation)
    curvature, following = _gap_curvature(slopes)
    # The points that follow the node come near by their rates; one step of Newton's method then leaves an error of 1e-5
    # in second derivatives.
    shifts = np.repeat([-SKEW_STEP, SKEW_STEP], rotation.size)
    near = np.tile(points.parameters, 2) + shifts * np.tile(following, 2)
    values, slopes = motion.closing_and_place(SurfacePoints.of(motion.surface, near), np.tile(rotation, 2) + shifts)
    before, after = _gap_curvature(slopes)[0].reshape(2, -1)
    passing = near + cramers_rule(slopes[0, 1:], slopes[1, 1:], np.tile(place, 2) - values[1:])
    return curvature, (after - before) / (2.0 * SKEW_STEP), passing.reshape(2, 2, -1).swapaxes(0, 1)


def _gap_curvature(slopes: Array) -> tuple[Array, Array]:
    """Second derivative (n) of the gap by the pinion rotation at a fixed gear point, at any rotation.

    Also how both pinion parameters follow the rotation while that point stays fixed (2, n).
    """
    following = -cramers_rule(slopes[0, 1:], slopes[1, 1:], slopes[2, 1:])
    return np.asarray(-(slopes[2, 0] + slopes[0, 0] * following[0] + slopes[1, 0] * following[1])), following


def exact_ease_off(
    gear: Flank, pinion_surface: GeneratingSurface, pinion_section: BlankSection, assembly: Assembly
) -> EaseOff:
    """Ease-off and roll angle of a pair at the gear's nodes (n); NaN and a status without a conjugate point."""
    target, usable = _targets(gear)
    if not np.any(usable):
        raise GeometryError("no node of the gear flank exists: check the gear's machine settings and blank")
    middle = target[:, usable].mean(axis=1)
    motion = conjugate_motion(pinion_surface.on("profile"), pinion_section, assembly, middle)
    surfaces = []
    for part in pinion_surface.flank_parts:
        on_part = replace(motion, surface=part)
        seeds = seed_lattice(part, pinion_section)
        start, sheet = _starts(on_part, seeds, target)
        points, solution = points_at(on_part.conjugate_place, part, start, target)
        sought = (_sheet(solution.jacobian) == sheet) & ~seeds.strayed(start.parameters, solution.parameters)
        solved = solution.converged & usable & sought
        surfaces.append(classified(on_part, pinion_section, gear, points, solved, seeds.orientation))
    result = surfaces[0] if len(surfaces) == 1 else _deepest(motion, surfaces)
    result = replace(result, blade_distance=np.minimum(result.blade_distance, gear.blade_distance))
    if not np.any(result.inside):
        raise GeometryError(
            "no part of the gear flank meets the pinion flank: check the blanks, the hands, "
            "hypoid_offset and shaft_angle"
        )
    return result


def angle_near(motion: ConjugateMotion, start: Array, side: float, sheet: float, gear: Flank) -> tuple[Array, Array]:
    """Ease-off as a gear rotation (n) [rad], up to a constant, near a known solution, and the parameters (2, n).

    NaN where there is none. ``side`` is the orientation sign of the valid side of the pinion, ``sheet`` the sign of
    ``sheet_area`` of the valid sheet of the conjugate gear.
    """
    target, usable = _targets(gear)
    with np.errstate(all="ignore"):
        points, solution = points_at(
            motion.conjugate_place, motion.surface, SurfacePoints.of(motion.surface, start), target
        )
        point, _ = motion.conjugate_gear(solution.parameters)
        valid_side = points.orientation * side > 0.0
        valid_side &= _sheet(solution.jacobian) == sheet
    known = usable & solution.converged & np.all(np.isfinite(point), axis=0) & valid_side
    return np.where(known, -motion.pinion_sense * _turned(gear, point, known), np.nan), solution.parameters


def _targets(gear: Flank) -> tuple[Array, Bools]:
    """Axial and radial coordinate of the gear nodes (2, n) [mm], and which nodes exist; the middle for the others."""
    target = np.stack([gear.position[2], np.hypot(gear.position[0], gear.position[1])])
    usable = np.all(np.isfinite(target), axis=0)
    return np.where(usable, target, target[:, usable].mean(axis=1, keepdims=True)) if np.any(usable) else target, usable


def _turned(gear: Flank, point: Array, known: Bools) -> Array:
    """Azimuth of the gear nodes beyond that of the conjugate points (n) [rad], without jumps by a turn."""
    turned = np.arctan2(gear.position[1], gear.position[0]) - np.arctan2(point[1], point[0])
    reference = turned[np.argmax(known)]
    return np.asarray(np.mod(turned - reference + np.pi, 2 * np.pi) - np.pi + reference)


def _whole_turns(angles: Array) -> float:
    """Number of whole turns in angles [rad] that are known; a section may cut nothing."""
    known = angles[np.isfinite(angles)]
    return round(float(np.median(known)) / (2.0 * np.pi)) if known.size else 0.0


def _deepest(motion: ConjugateMotion, surfaces: list[EaseOff]) -> EaseOff:
    """Ease-off with a pinion flank of several sections: at every node the section with the largest gap."""
    angles = [s.angle - 2 * np.pi * _whole_turns(s.angle - surfaces[0].angle) for s in surfaces]
    choice = deepest(motion.surface.flank_parts, [s.blade_distance for s in surfaces], angles)
    names = [f.name for f in fields(EaseOff) if f.name not in ("motion", "pinion_section", "angle", "part")]
    picked: dict[str, Any] = {name: pick([getattr(s, name) for s in surfaces], choice) for name in names}
    return replace(surfaces[0], motion=motion, angle=pick(angles, choice), part=choice, **picked)


def _starts(motion: ConjugateMotion, seeds: SeedLattice, target: Array) -> tuple[SurfacePoints, float]:
    """First guess of the pinion points (n) for each target, and the sheet of the conjugate gear to stay on.

    That surface folds back on itself, some way off the flank or on it; seeds beyond the fold are left out.
    """
    with np.errstate(all="ignore"):
        coordinates, slopes = motion.conjugate_place(seeds.points)
        sheets = _sheet(slopes.swapaxes(0, 1))
    sheet = float(sheets[sheets.size // 2])
    return seeds.nearest(coordinates, seeds.side & (sheets == sheet), target), sheet


def sheet_area(motion: ConjugateMotion, parameters: Array) -> Array:
    """Area of the conjugate gear's axial section per pinion parameters (n), with a sign that changes at a fold."""
    with np.errstate(all="ignore"):
        _, (first, second) = motion.conjugate_place(SurfacePoints.of(motion.surface, parameters))
        return determinant(first, second)


def _sheet(jacobian: Array) -> Array:
    """Sign (n) of the determinant of Jacobians (2, 2, n): it changes where a surface folds."""
    with np.errstate(all="ignore"):
        return np.sign(determinant(jacobian[:, 0], jacobian[:, 1]))


def classified(
    motion: ConjugateMotion, section: BlankSection, gear: Flank, points: SurfacePoints, solved: Bools, side: float
) -> EaseOff:
    """Evaluate everything at the pinion points found, and give every node a status."""
    position, normal, distance = points.position, points.normal, points.coordinate
    with np.errstate(all="ignore"):
        in_space = motion.assembly.pinion_to_global(position, normal)
        roll_angle = motion.rotation(*in_space)
        action_position, action_normal = motion.turned(*in_space, roll_angle)
        point = motion.in_gear(action_position, roll_angle)
        valid_side = points.orientation * side > 0.0
        # Along the gear axis as oriented by the drive rotation, closing the gap turns the gear backwards.
        turned = _turned(gear, point, solved)
        curvature, skew, passing = _separation(motion, points, roll_angle)
    lengthwise, profile = section.fractions(position[2], np.hypot(position[0], position[1]))

    on_pinion = (lengthwise >= 0.0) & (lengthwise <= 1.0) & (profile >= 0.0) & (profile <= 1.0)
    status = np.where(on_pinion, gear.status, NodeStatus.OUTSIDE_BLANK).astype(np.int8)
    status[distance < -1e-9] = NodeStatus.BEYOND_BLADE_TIP
    status[~valid_side] = NodeStatus.UNDERCUT
    status[~(solved & np.isfinite(turned))] = NodeStatus.NO_SOLUTION
    missing = (status == NodeStatus.NO_SOLUTION) | (status == NodeStatus.UNDERCUT)

    def known(values: Array) -> Array:
        return np.where(missing, np.nan, values)

    return EaseOff(
        motion=motion,
        pinion_section=section,
        pinion_parameters=points.parameters,
        pinion_passing=passing,
        pinion_position=known(position),
        pinion_normal=known(normal),
        action_position=known(action_position),
        action_normal=known(action_normal),
        roll_angle=known(roll_angle - motion.center),
        angle=known(-motion.pinion_sense * turned),
        lever_arm=known(np.abs(gear.position[0] * gear.normal[1] - gear.position[1] * gear.normal[0])),
        separation_curvature=known(curvature),
        separation_skew=known(skew),
        pinion_lengthwise=known(lengthwise),
        pinion_profile=known(profile),
        blade_distance=known(distance),
        status=status,
        part=np.zeros(status.shape, dtype=np.int8),
    )


@dataclass(frozen=True)
class Rolling:
    """Motion of the flanks past the contact line, at the nodes of an ease-off (n) [mm/rad]."""

    sliding: Array
    pinion_speed: Array  # of the contact line across the pinion flank
    gear_speed: Array


def relative_velocity(motion: ConjugateMotion, position: Array) -> Array:
    """Velocity of the pinion relative to the gear (3, n) [mm/rad] at points (3, n) [mm] in space."""
    pinion = cross(column(motion.pinion_axis, position), position - column(motion.assembly.pinion_origin, position))
    gear = cross(column(motion.gear_axis, position), position - column(motion.assembly.gear_origin, position))
    return np.asarray(pinion - gear / motion.assembly.ratio)


def rolling(ease_off: EaseOff) -> Rolling:
    """Sliding and rolling at the nodes of an ease-off.

    The speed of the line across a flank is one over the slope of the roll angle on that flank.
    """

    def on_part(surface: GeneratingSurface, parameters: Array) -> Array:
        motion = replace(ease_off.motion, surface=surface)

        def points_and_rotation(p: Array) -> Array:
            gear, rotation = motion.conjugate_gear(p)
            return np.concatenate([surface.evaluate(p)[0], gear, rotation[None]])

        value, slopes = complex_steps(points_and_rotation, parameters)
        space, _ = motion.action_point(parameters, value[6])
        speeds = [_across(slopes[:, k : k + 3], slopes[:, 6]) for k in (0, 3)]
        return np.stack([np.linalg.norm(relative_velocity(motion, space), axis=0), *speeds])

    with np.errstate(all="ignore"):
        values = on_parts(ease_off.motion.surface.flank_parts, ease_off.part, ease_off.pinion_parameters, on_part)
    return Rolling(*np.where(np.isfinite(ease_off.angle), values, np.nan))


def _across(tangents: Array, slopes: Array) -> Array:
    """One over the gradient (n) on a surface with tangents (2, 3, n) of a function with derivatives (2, n)."""
    first, second, mixed = dot(tangents[0], tangents[0]), dot(tangents[1], tangents[1]), dot(tangents[0], tangents[1])
    squared = second * slopes[0] ** 2 - 2.0 * mixed * slopes[0] * slopes[1] + first * slopes[1] ** 2
    return np.asarray(np.sqrt((first * second - mixed**2) / squared))


@record(frozen=True)
class Drift:
    """Rates, by the pinion rotation, of the pinion point opposite a fixed gear point, at the nodes (n) [mm/rad]."""

    axial: Array
    radial: Array
    lengthwise: Array  # first and second derivative of the fraction (2, n) [1/rad, 1/rad^2]
    profile: Array
    lever_arm: Array

    @property
    def of_fractions(self) -> dict[str, Array]:
        """Derivatives (n) of both fractions, by their names in results."""
        rates, accelerations = zip(self.lengthwise, self.profile, strict=True)
        names = [f"pinion_{way}_{order}" for order in ("rate", "acceleration") for way in ("lengthwise", "profile")]
        return dict(zip(names, (*rates, *accelerations), strict=True))


def drift(ease_off: EaseOff) -> Drift:
    """Drift of the pinion points opposite the gear's nodes, by central differences as the separation skew."""
    # Before and after that rotation, in one call.
    rotation = ease_off.roll_angle + ease_off.motion.center
    rotations = np.concatenate([rotation - SKEW_STEP, rotation + SKEW_STEP])

    def on_part(surface: GeneratingSurface, parameters: Array) -> Array:
        motion = replace(ease_off.motion, surface=surface)
        points, own_normal, _ = surface.evaluate(parameters)
        position, normal = motion.turned(*motion.assembly.pinion_to_global(points, own_normal), rotations)
        relative = position - column(motion.assembly.gear_origin, position)
        lever = np.abs(relative[0] * normal[1] - relative[1] * normal[0])
        radial = np.hypot(points[0], points[1])
        return np.stack([points[2], radial, lever, *ease_off.pinion_section.fractions(points[2], radial)])

    with np.errstate(all="ignore"):
        parts, both = ease_off.motion.surface.flank_parts, ease_off.pinion_passing.swapaxes(0, 1).reshape(2, -1)
        shown = on_parts(parts, np.tile(ease_off.part, 2), both, on_part).reshape(5, 2, -1)
        before, after = shown[:, 0], shown[:, 1]
        fractions = np.stack([ease_off.pinion_lengthwise, ease_off.pinion_profile])
        rates = (after - before) / (2.0 * SKEW_STEP)
        bends = (after[3:] - 2.0 * fractions + before[3:]) / SKEW_STEP**2
    missing = ~np.isfinite(ease_off.angle)
    rates[:, missing], bends[:, missing] = np.nan, np.nan
    return Drift(rates[0], rates[1], np.stack([rates[3], bends[0]]), np.stack([rates[4], bends[1]]), rates[2])
