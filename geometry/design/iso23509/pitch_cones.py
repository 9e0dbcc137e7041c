"""The pitch cones of a pair: two cones that touch at the mean point and suit the cutter (ISO 23509:2016, clause 6).

Given the axes, the tooth numbers and the gear's mean point, the touching pitch cones of a hypoid pair form a family
with one parameter. The methods differ in the condition that picks one member:

* method 1 (Gleason): the limit radius of curvature equals the tooth line's radius of curvature;
* method 2 (Oerlikon): both pitch apexes and the cutter centre lie on one line of the pitch plane;
* method 3 (Klingelnberg): the standard's own condition on the pinion's mean cone distance.

Every condition is solved to rounding. The standard stops at 1 % (methods 1 and 2) or 0.01 % (method 3), so the last
printed digits of its samples may differ.

The crown gear has the tooth line that a cutter traces on the gear's developed pitch cone. A face-milling cutter traces
a circle. A face-hobbing cutter turns in step with the work and traces an extended epicycloid: a circle rolling on the
base circle carries the blade. Without blade groups the epicycloid becomes the circle, so that one set of formulas
serves both.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Protocol

from ....core.checks import check_fields
from ....core.errors import GeometryError, InputError
from .blank_dimensions import BlankDesign


@dataclass(frozen=True)
class PitchCones:
    """Pitch cones that touch at the mean point [mm, rad]."""

    shaft_angle: float
    hypoid_offset: float
    pinion_pitch_angle: float
    gear_pitch_angle: float
    pinion_mean_cone_distance: float
    gear_mean_cone_distance: float
    pinion_mean_spiral_angle: float
    gear_mean_spiral_angle: float
    face_width_factor: float = 0.5  # share of the gear's face width outside the mean point (c_be2)

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def pinion_mean_pitch_diameter(self) -> float:
        """Mean pitch diameter dm1 [mm] (formula 110)."""
        return 2.0 * self.pinion_mean_cone_distance * math.sin(self.pinion_pitch_angle)

    @property
    def gear_mean_pitch_diameter(self) -> float:
        """Mean pitch diameter dm2 [mm] (formula 111)."""
        return 2.0 * self.gear_mean_cone_distance * math.sin(self.gear_pitch_angle)

    @property
    def axial_offset_angle(self) -> float:
        """Pinion offset angle in the pinion axial plane zeta_m [rad] (formula 113)."""
        lean = math.cos(self.gear_pitch_angle) / math.cos(self.pinion_pitch_angle)
        reach = self.gear_mean_pitch_diameter + self.pinion_mean_pitch_diameter * lean
        return math.asin(2.0 * self.hypoid_offset / reach)

    @property
    def offset_angle(self) -> float:
        """Pinion offset angle in the pitch plane zeta_mp [rad], between the two cone elements (formula 114)."""
        sine = math.sin(self.axial_offset_angle) * math.sin(self.shaft_angle) / math.cos(self.pinion_pitch_angle)
        return math.asin(sine)

    @property
    def limit_pressure_angle(self) -> float:
        """Pressure angle alpha_lim [rad] of the flank that would not mesh at all (formulas 32 and 117)."""
        pinion, gear = math.tan(self.pinion_pitch_angle), math.tan(self.gear_pitch_angle)
        r1, r2 = self.pinion_mean_cone_distance, self.gear_mean_cone_distance
        unbalance = r1 * math.sin(self.pinion_mean_spiral_angle) - r2 * math.sin(self.gear_mean_spiral_angle)
        return -math.atan(pinion * gear * unbalance / (math.cos(self.offset_angle) * (r1 * pinion + r2 * gear)))

    @property
    def limit_curvature(self) -> float:
        """Lengthwise curvature 1/rho_lim [1/mm] of the limit flank (formula 33); NaN without offset, where any fits."""
        slope1, slope2 = math.tan(self.pinion_mean_spiral_angle), math.tan(self.gear_mean_spiral_angle)
        if slope1 == slope2:
            return math.nan
        r1, r2 = self.pinion_mean_cone_distance, self.gear_mean_cone_distance
        limit = self.limit_pressure_angle
        twist = slope1 / (r1 * math.tan(self.pinion_pitch_angle)) + slope2 / (r2 * math.tan(self.gear_pitch_angle))
        gap = 1.0 / (r1 * math.cos(self.pinion_mean_spiral_angle)) - 1.0 / (r2 * math.cos(self.gear_mean_spiral_angle))
        return math.cos(limit) * (gap - math.tan(limit) * twist) / (slope1 - slope2)

    @property
    def limit_radius_of_curvature(self) -> float:
        """Lengthwise radius of curvature rho_lim [mm] of the limit flank; infinite where it is straight."""
        curvature = self.limit_curvature
        return math.inf if curvature == 0.0 else 1.0 / curvature


class CutterAndTeeth(Protocol):
    """Basic data of a pair that a crown gear takes."""

    @property
    def cutter_radius(self) -> float:
        """Mean radius of the cutter (r_c0) [mm]."""

    @property
    def number_of_blade_groups(self) -> int | None:
        """Starts of a face-hobbing cutter (z0); none or zero for face milling."""

    @property
    def number_of_teeth(self) -> tuple[int, int]:
        """Pinion, gear (z1, z2)."""


@dataclass(frozen=True)
class CrownGear:
    """Tooth line on the gear's developed pitch cone [mm, rad]."""

    cutter_radius: float
    cutter_lead_angle: float  # its radius to the normal of the tooth line (nu) [rad]; 0 face-milled
    centre_distance: float  # to the centre of the cutter (rho_P0) [mm]
    base_radius: float  # rho_b [mm]; the centre distance when face-milled
    tooth_line_radius_of_curvature: float  # at the mean point

    def spiral_angle(self, cone_distance: float) -> float:
        """Spiral angle [rad] at a distance from the apex [mm] along the cone (ISO 23509:2016, 179 to 184)."""
        angle = self.generating_angle(cone_distance)
        return math.atan2(cone_distance - self.base_radius * math.cos(angle), self.base_radius * math.sin(angle))

    def generating_angle(self, cone_distance: float) -> float:
        """Angle at the centre between a point of the tooth line and the cutter's centre (q) [rad]."""
        centre, cutter = self.centre_distance, self.cutter_radius
        cosine = (cone_distance**2 + centre**2 - cutter**2) / (2.0 * cone_distance * centre)
        if not abs(cosine) < 1.0:
            raise GeometryError(
                f"the cutter (cutter_radius = {cutter:g} mm) does not reach the cone distance {cone_distance:g} mm"
            )
        return math.acos(cosine)

    @property
    def involute_cone_distance(self) -> float:
        """Cone distance at which the tooth line is curved as an involute [mm]; NaN where there is none.

        Generating and spiral angle agree there: from ``rho_b = R cos(q)`` and the triangle of both centres and the
        point; face-milled it is formula 39 of AGMA 929-B22, face-hobbed the solution of its 41 to 46.
        """
        centre = self.centre_distance
        square = 2.0 * centre * self.base_radius - centre**2 + self.cutter_radius**2
        return math.sqrt(square) if square > 0.0 else math.nan


def crown_gear(
    design: CutterAndTeeth, gear_pitch_angle: float, gear_mean_cone_distance: float, gear_mean_spiral_angle: float
) -> CrownGear:
    """Crown gear from the mean point of the gear [mm, rad] (ISO 23509:2016, 34 to 40 and 176 to 178)."""
    cutter = design.cutter_radius
    distance, spiral = gear_mean_cone_distance, gear_mean_spiral_angle
    groups = design.number_of_blade_groups or 0
    crown_teeth = design.number_of_teeth[1] / math.sin(gear_pitch_angle)
    lead_sine = distance * groups * math.cos(spiral) / (cutter * crown_teeth)
    if not lead_sine < 1.0:
        raise GeometryError(f"number_of_blade_groups = {groups}: too many for cutter_radius = {cutter:g} mm")
    lead = math.asin(lead_sine)
    centre = math.sqrt(distance**2 + cutter**2 - 2.0 * distance * cutter * math.sin(spiral - lead))
    base = centre / (1.0 + groups / crown_teeth)
    if groups == 0:
        return CrownGear(cutter, lead, centre, base, cutter)
    # direction from the crown gear's centre to the cutter's, counted from the tangent of the tooth line; formula 52
    # rather than 38, because it keeps the sign when the cutter is small
    along = cutter * math.sin(lead) + distance * math.cos(spiral)
    across = cutter * math.cos(lead) - distance * math.sin(spiral)
    pole = across / along
    slope = math.tan(spiral)
    curvature_radius = distance * math.cos(spiral) * (slope + pole / (1.0 + math.tan(lead) * (slope + pole)))
    return CrownGear(cutter, lead, centre, base, curvature_radius)


#: Step of the search for pitch cones, and how far it goes [rad].
SEARCH_STEP, FARTHEST_ANGLE = 0.004, 0.8
#: Search for the spiral angle of one member from that of the other [rad].
MOST_TRIALS, LARGEST_SPIRAL_ANGLE, SPIRAL_TOLERANCE = 60, math.radians(85.0), 1e-10
#: Relative mismatch up to which a change of sign is a root, and no pole; with small offsets it is rounding.
ROOT_MISMATCH = 1e-6


def pitch_cones(design: BlankDesign) -> PitchCones:
    """Pitch cones by the method of the design; GeometryError if no pair of cones meets its condition."""
    if not _bevel_gear_angle(design) < math.pi / 2:
        raise InputError(
            f"shaft_angle = {math.degrees(design.shaft_angle):g} deg: too large for number_of_teeth = "
            f"{design.number_of_teeth}, the gear's pitch angle reaches a right angle; it does not below "
            f"{math.floor(10.0 * math.degrees(math.acos(-1.0 / _ratio(design)))) / 10.0:g} deg"
        )
    return (_bevel, _gleason, _oerlikon, _klingelnberg)[design.method](design)


def mate_spiral_angle(design: BlankDesign, wanted: float) -> float:
    """Mean spiral angle for the method of a design with which the mate of its member has a wanted one [rad].

    Raises GeometryError if no pitch cones have it.
    """
    first = 1.0 if design.method == 1 else -1.0
    diameter = design.gear_outer_pitch_diameter or design.gear_mean_pitch_diameter or math.inf
    angle = wanted + first * math.asin(max(-0.9, min(0.9, 2.4 * design.hypoid_offset / diameter)))
    for _ in range(MOST_TRIALS):
        cones = pitch_cones(replace(design, mean_spiral_angle=min(max(angle, 0.0), LARGEST_SPIRAL_ANGLE)))
        miss = (cones.gear_mean_spiral_angle if design.method == 1 else cones.pinion_mean_spiral_angle) - wanted
        angle -= miss  # the offset angle between both hardly changes
        if abs(miss) < SPIRAL_TOLERANCE:
            return angle
    raise GeometryError(
        f"method {design.method}: no pitch cones have {'a gear' if design.method == 1 else 'a pinion'} with a mean "
        f"spiral angle of {math.degrees(wanted):g} degrees; give that of the other member"
    )


def _ratio(design: BlankDesign) -> float:
    return design.number_of_teeth[1] / design.number_of_teeth[0]


def _outer_diameter(design: BlankDesign) -> float:
    assert design.gear_outer_pitch_diameter is not None  # given but for method 2
    return design.gear_outer_pitch_diameter


def _bevel(design: BlankDesign) -> PitchCones:
    """Pitch cones with a common apex (formulas 1 to 7)."""
    shaft = design.shaft_angle
    pinion = math.atan2(math.sin(shaft), math.cos(shaft) + _ratio(design))
    gear = shaft - pinion
    distance = _outer_diameter(design) / (2.0 * math.sin(gear)) - design.gear_face_width / 2.0
    if not distance > design.gear_face_width / 2.0:
        raise InputError(f"gear_face_width = {design.gear_face_width}: reaches beyond the pitch apex")
    spiral = design.mean_spiral_angle
    return PitchCones(shaft, 0.0, pinion, gear, distance, distance, spiral, spiral)


def _gleason(design: BlankDesign) -> PitchCones:
    """Limit radius of curvature equal to that of the tooth line (ISO 23509:2016, 8 to 41).

    The pinion's spiral angle is met to first order of the correction by 20 to 26, as in the standard: it may differ by
    some thousandths of a degree.
    """
    ratio, desired = _ratio(design), math.tan(design.mean_spiral_angle)
    outer, offset = _outer_diameter(design), design.hypoid_offset
    excess = design.shaft_angle - math.pi / 2
    first = math.atan2(ratio * math.cos(excess), 1.2 * (1.0 - ratio * math.sin(excess)))
    radius = (outer - design.gear_face_width * math.sin(first)) / 2.0
    _check_face_width(design, radius)
    _check_offset(design, radius)
    angle = math.asin(offset * math.sin(first) / radius)
    enlargement = desired * math.sin(angle) + math.cos(angle)
    pinion_radius = radius * enlargement / ratio

    def cones(gear_offset_angle: float) -> PitchCones:
        sine = math.sin(gear_offset_angle)

        def pinion_angle(axial: float) -> float:
            slope = sine / (math.tan(axial) * math.cos(excess)) + math.tan(excess) * math.cos(gear_offset_angle)
            return math.atan(slope)

        axial = math.asin((offset - pinion_radius * sine) / radius)
        offset_angle = math.asin(math.sin(axial) * math.cos(excess) / math.cos(pinion_angle(axial)))
        spiral_slope = (enlargement - math.cos(offset_angle)) / math.sin(offset_angle)
        correction = math.sin(offset_angle) * (desired - spiral_slope)
        radius_change = radius * correction / ratio
        axial = math.asin(math.sin(axial) - radius_change / radius * sine)
        pinion = pinion_angle(axial)
        offset_angle = math.asin(math.sin(axial) * math.cos(excess) / math.cos(pinion))
        spiral = math.atan((enlargement + correction - math.cos(offset_angle)) / math.sin(offset_angle))
        gear = math.atan(
            math.sin(axial) / (math.tan(gear_offset_angle) * math.cos(excess)) + math.cos(axial) * math.tan(excess)
        )
        distance = radius / math.sin(gear)
        return PitchCones(
            shaft_angle=design.shaft_angle,
            hypoid_offset=offset,
            pinion_pitch_angle=pinion,
            gear_pitch_angle=gear,
            pinion_mean_cone_distance=(pinion_radius + radius_change) / math.sin(pinion),
            gear_mean_cone_distance=distance,
            pinion_mean_spiral_angle=spiral,
            gear_mean_spiral_angle=spiral - offset_angle,
            face_width_factor=(outer / (2.0 * math.sin(gear)) - distance) / design.gear_face_width,
        )

    def mismatch(trial: PitchCones) -> float:
        crown = crown_gear(design, trial.gear_pitch_angle, trial.gear_mean_cone_distance, trial.gear_mean_spiral_angle)
        return crown.tooth_line_radius_of_curvature * trial.limit_curvature - 1.0

    reach = radius * (math.tan(first) * math.cos(excess) - math.sin(excess)) + pinion_radius
    start = math.atan2(offset, reach)
    # Of the size of the offset is also the range of angles in which cones exist.
    step, farthest = min(SEARCH_STEP, abs(start) / 50.0), min(FARTHEST_ANGLE, 8.0 * abs(start))
    return _nearest_cones(cones, mismatch, start, design, step, farthest)


def _oerlikon(design: BlankDesign) -> PitchCones:
    """Both apexes and the cutter centre on one line (ISO 23509:2016, 42 to 83).

    Here offset, shaft angle and that condition hold exactly; the standard stops at 1 % of it.
    """
    diameter, cutter = design.gear_mean_pitch_diameter, design.cutter_radius
    assert diameter is not None  # given for method 2

    def cones(gear_pitch_angle: float) -> PitchCones:
        return _touching_cones(design, gear_pitch_angle, diameter)

    def mismatch(trial: PitchCones) -> float:
        distance = trial.gear_mean_cone_distance
        crown = crown_gear(design, trial.gear_pitch_angle, distance, trial.gear_mean_spiral_angle)
        # polar angle of the cutter centre about the gear apex, counted from the gear's cone element
        course = trial.gear_mean_spiral_angle - crown.cutter_lead_angle
        polar = math.atan2(cutter * math.cos(course), distance - cutter * math.sin(course))
        return distance * math.sin(polar) / math.sin(trial.offset_angle + polar) / trial.pinion_mean_cone_distance - 1.0

    return _nearest_cones(cones, mismatch, _bevel_gear_angle(design), design)


def _klingelnberg(design: BlankDesign) -> PitchCones:
    """Pinion's mean cone distance from the cutter (formulas 84 to 109)."""
    outer, cutter = _outer_diameter(design), design.cutter_radius
    _check_face_width(design, outer - design.gear_face_width * math.sin(_bevel_gear_angle(design)))

    def cones(gear_pitch_angle: float) -> PitchCones:
        return _touching_cones(design, gear_pitch_angle, outer - design.gear_face_width * math.sin(gear_pitch_angle))

    def mismatch(trial: PitchCones) -> float:
        gear_pitch_angle = trial.gear_pitch_angle
        distance, spiral = trial.gear_mean_cone_distance, trial.gear_mean_spiral_angle
        lead = crown_gear(design, gear_pitch_angle, distance, spiral).cutter_lead_angle
        lean = math.atan(math.sin(gear_pitch_angle) * math.tan(trial.axial_offset_angle))
        turned = spiral - lead
        cross = math.sin(trial.offset_angle)
        cutter_term = cutter * math.cos(turned) ** 2
        gear_term = distance * math.cos(spiral + lean) * math.cos(spiral)
        offset_term = cross * math.cos(lean) * math.cos(lead)
        reach = distance * math.cos(spiral) + cutter * math.sin(lead)
        pinion_term = math.cos(trial.pinion_mean_spiral_angle) * math.cos(spiral + lean)
        pinion_term -= math.sin(spiral + lean - lead) * cross / math.cos(turned)
        required = cutter_term * gear_term / (offset_term * reach + cutter_term * pinion_term)
        return required / trial.pinion_mean_cone_distance - 1.0

    return _nearest_cones(cones, mismatch, _bevel_gear_angle(design), design)


def _bevel_gear_angle(design: BlankDesign) -> float:
    """Pitch angle the gear would have without offset [rad]."""
    return design.shaft_angle - math.atan2(math.sin(design.shaft_angle), math.cos(design.shaft_angle) + _ratio(design))


def _check_face_width(design: BlankDesign, gear_mean_size: float) -> None:
    """Refuse a gear without a positive mean radius or diameter."""
    if not gear_mean_size > 0.0:
        raise InputError(
            f"gear_outer_pitch_diameter = {_outer_diameter(design)}: must be greater, the gear_face_width of "
            f"{design.gear_face_width} mm reaches beyond its axis"
        )


def _check_offset(design: BlankDesign, gear_mean_radius: float) -> None:
    offset = design.hypoid_offset
    if not abs(offset) < gear_mean_radius:
        raise InputError(f"hypoid_offset = {offset}: must be less than the gear's mean radius {gear_mean_radius:g} mm")


def _touching_cones(design: BlankDesign, gear_pitch_angle: float, gear_mean_diameter: float) -> PitchCones:
    """Cones that touch at the mean point for a gear pitch angle and spiral angle (formulas 89 to 97).

    The one unknown is the offset angle in the pinion axial plane, at which the axes have the wanted distance.
    """
    from scipy.optimize import brentq

    shaft, offset, spiral = design.shaft_angle, design.hypoid_offset, design.mean_spiral_angle
    _check_offset(design, gear_mean_diameter / 2.0)
    ratio = _ratio(design)

    def elements(axial: float) -> tuple[float, float]:
        sine = math.cos(axial) * math.sin(shaft) * math.cos(gear_pitch_angle)
        pinion = math.asin(sine - math.cos(shaft) * math.sin(gear_pitch_angle))
        return pinion, math.asin(math.sin(axial) * math.sin(shaft) / math.cos(pinion))

    def excess(axial: float) -> float:  # times the cosine of the pinion's spiral angle: no pole
        pinion, offset_angle = elements(axial)
        cosine = math.cos(spiral + offset_angle)
        lean = math.cos(spiral) / ratio * math.cos(gear_pitch_angle) / math.cos(pinion)
        return math.sin(axial) * (cosine + lean) - 2.0 * offset / gear_mean_diameter * cosine

    farthest = math.asin(2.0 * offset / gear_mean_diameter)
    axial = 0.0 if offset == 0.0 else float(brentq(excess, 0.0, farthest, xtol=1e-16))
    pinion, offset_angle = elements(axial)
    pinion_diameter = gear_mean_diameter / ratio * math.cos(spiral) / math.cos(spiral + offset_angle)
    return PitchCones(
        shaft_angle=shaft,
        hypoid_offset=offset,
        pinion_pitch_angle=pinion,
        gear_pitch_angle=gear_pitch_angle,
        pinion_mean_cone_distance=pinion_diameter / (2.0 * math.sin(pinion)),
        gear_mean_cone_distance=gear_mean_diameter / (2.0 * math.sin(gear_pitch_angle)),
        pinion_mean_spiral_angle=spiral + offset_angle,
        gear_mean_spiral_angle=spiral,
    )


def _nearest_cones(
    cones: Callable[[float], PitchCones],
    mismatch: Callable[[PitchCones], float],
    start: float,
    design: BlankDesign,
    step: float = SEARCH_STEP,
    farthest: float = FARTHEST_ANGLE,
) -> PitchCones:
    """Cones without mismatch whose angle [rad] is nearest to a starting one.

    Sign changes through a pole, outside the domain or between cones that are none are passed over.
    """
    from scipy.optimize import brentq

    def value(angle: float) -> float:
        try:
            trial = cones(angle)
            angles_exist = min(trial.pinion_pitch_angle, trial.gear_pitch_angle) > 0.0
            return mismatch(trial) if angles_exist and 0.0 < trial.face_width_factor < 1.0 else math.nan
        except (ValueError, ZeroDivisionError, GeometryError):  # no such cones
            return math.nan

    ends = {1.0: (start, value(start)), -1.0: (start, value(start))}
    for count in range(1, int(farthest / step)):
        for side, (last, last_value) in ends.items():
            angle = start + side * count * step
            now = value(angle)
            if last_value == 0.0:
                return cones(last)
            if last_value * now < 0.0:
                with suppress(ValueError):  # between them are angles without cones
                    root = float(brentq(value, last, angle, xtol=1e-16))
                    if abs(value(root)) < ROOT_MISMATCH:
                        return cones(root)
            ends[side] = (angle, now)
    with suppress(ValueError, ZeroDivisionError):
        mismatch(cones(start))  # a cutter that suits no cones is told in its own words
    raise GeometryError(
        f"method {design.method}: no pitch cones suit cutter_radius = {design.cutter_radius:g} mm with "
        f"hypoid_offset = {design.hypoid_offset:g} mm and this mean spiral angle; change one of them"
    )
