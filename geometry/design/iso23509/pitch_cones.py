"""The pitch cones of a pair: two cones that touch at the mean point and suit the cutter (ISO 23509:2016, clause 6).

Given the axes, the tooth numbers and the gear's mean point, the touching pitch cones of a hypoid pair form a family
with one parameter. The methods differ in the condition that picks one member:

* method 1 (Gleason): the limit radius of curvature equals the tooth line's radius of curvature;
* method 2 (Oerlikon): both pitch apexes and the cutter centre lie on one line of the pitch plane;
* method 3 (Klingelnberg): the standard's own condition on the pinion's mean cone distance.

Every condition is solved to rounding. The standard stops at 1 % (methods 1 and 2) or 0.01 % (method 3), so the last
printed digits of its samples may differ.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress

from ....core.errors import GeometryError, InputError
from .blank_design import BlankDesign
from .cones import PitchCones
from .crown_gear import crown_gear

#: Step of the search for pitch cones, and how far it goes [rad].
SEARCH_STEP, FARTHEST_ANGLE = 0.004, 0.8
#: Relative mismatch up to which a change of sign is a root, and no pole; with small offsets it is rounding.
ROOT_MISMATCH = 1e-6


def pitch_cones(design: BlankDesign) -> PitchCones:
    """Pitch cones by the method of the design.

    Parameters
    ----------
    design
        Basic data.

    Returns
    -------
    PitchCones
        The cones.

    Raises
    ------
    InputError
        If the offset is larger than the gear's mean radius, or the gear would have internal teeth.
    GeometryError
        If no pair of cones satisfies the method's condition.
    """
    if not _bevel_gear_angle(design) < math.pi / 2:
        raise InputError(
            f"shaft_angle = {math.degrees(design.shaft_angle):g} deg: too large for number_of_teeth = "
            f"{design.number_of_teeth}, the gear's pitch angle reaches a right angle; it does not below "
            f"{math.floor(10.0 * math.degrees(math.acos(-1.0 / _ratio(design)))) / 10.0:g} deg"
        )
    return (_bevel, _gleason, _oerlikon, _klingelnberg)[design.method](design)


def _ratio(design: BlankDesign) -> float:
    return design.number_of_teeth[1] / design.number_of_teeth[0]


def _outer_diameter(design: BlankDesign) -> float:
    if design.gear_outer_pitch_diameter is None:
        raise InputError(f"gear_outer_pitch_diameter: method {design.method} needs it")
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
    """Limit radius of curvature equal to that of the tooth line (formulas 8 to 41).

    The desired spiral angle of the pinion is met to first order of the correction made by formulas 20 to 26, as in
    the standard: the angle in the result may differ by some thousandths of a degree.
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
        return crown.mean_radius_of_curvature * trial.limit_curvature - 1.0

    reach = radius * (math.tan(first) * math.cos(excess) - math.sin(excess)) + pinion_radius
    start = math.atan2(offset, reach)
    # Of the size of the offset is also the range of angles in which cones exist.
    step, farthest = min(SEARCH_STEP, abs(start) / 50.0), min(FARTHEST_ANGLE, 8.0 * abs(start))
    return _nearest_cones(cones, mismatch, start, design, step, farthest)


def _oerlikon(design: BlankDesign) -> PitchCones:
    """Both apexes and the cutter centre on one line (formulas 42 to 83).

    The standard reaches the cones by a chain of approximations and stops when this condition holds to 1 %; here the
    offset, the shaft angle and the condition hold exactly.
    """
    if design.gear_mean_pitch_diameter is None:
        raise InputError("gear_mean_pitch_diameter: method 2 needs it")
    diameter = design.gear_mean_pitch_diameter
    cutter = design.cutter_radius

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
        diameter = outer - design.gear_face_width * math.sin(gear_pitch_angle)
        return _touching_cones(design, gear_pitch_angle, diameter)

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
    """Cones touching at the mean point for a given gear pitch angle and spiral angle (formulas 89 to 97).

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
