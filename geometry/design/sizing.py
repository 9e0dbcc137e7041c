"""First size of a pair by ratio, torque and use: teeth, diameter, face width, spiral angle and cutter, with sources."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ...core import checks
from ...core.errors import InputError
from .iso23509.usual_proportions import FACE_WIDTH, FACE_WIDTH_OVER_MODULE, DefaultValue, usual_proportions

SPIRAL_ANGLE = math.radians(35.0)  # of pairs without offset
PRESSURE_ANGLE = math.radians(20.0)
ELASTICITY = 189.8  # Z_E of steel [MPa^0.5]
CONTACT_RATIO = 1.25  # transverse, at that spiral angle
#: Square of greatest over mean pressure: ellipse along the line; crowning 1.5 and mounting 1.25 of ANSI/AGMA 2003-B97.
CONCENTRATION = 4.0 / math.pi * 1.5 * 1.25
#: Ratios up to which vehicles have so many pinion teeth, and teeth of other hardened pinions over the ratio.
VEHICLE_TEETH = ((1.75, 2.0, 2.5, 4.0, 4.5, 5.0, 6.0, 7.5), (14, 13, 11, 10, 9, 8, 7, 6, 5))
OTHER_TEETH = ((1.0, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0, 5.0, 6.0, 7.5, 10.0), (18, 17, 16, 15, 13, 12, 10, 8, 7, 6, 5))
VEHICLE_RATIO = 1.5  # from which the former hold
FEWEST_BEVEL_TEETH = 7  # without offset
RATIO_TOLERANCE = 0.02  # within which teeth without a common factor are taken
#: Radii of cutters [mm] and their blade groups, 1 of face-milling ones.
MILLS = (
    *((6.35, 1), (13.97, 1), (19.05, 1), (25.4, 1), (34.925, 1), (44.45, 1), (57.15, 1), (63.5, 1), (76.2, 1)),
    *((95.25, 1), (114.3, 1), (133.35, 1), (152.4, 1), (203.2, 1), (228.6, 1), (304.8, 1)),
)
HOBS = (
    *((25.0, 5), (30.0, 7), (39.0, 7), (51.0, 7), (64.0, 11), (76.0, 13), (88.0, 13), (88.0, 17), (105.0, 13)),
    *((125.0, 13), (150.0, 17), (175.0, 19), (210.0, 5), (260.0, 5), (350.0, 5), (450.0, 5)),
)
CUTTER_RANGE = 2.0  # mean cone distance over cutter radius, or its inverse, at most
SHARED_FACTOR = 0.25  # relative distance of radii for which hobs are taken whose groups share no factor with the teeth
LARGEST_PITCH_ANGLE = math.radians(86.0)  # of a gear


class Use(NamedTuple):
    """How a use loads the flanks, and what it allows."""

    lasting_share: float  # of the torque
    overload: float
    pressure: float  # allowable [MPa]
    quality: int  # number of AGMA 2003, for the dynamic factor
    offset_limit: float  # over the gear's outer pitch diameter
    vehicle: bool
    words: str


USES = {
    "industrial": Use(1.0, 1.25, 1380.0, 10, 0.25, False, "lasting torque, overload factor 1.25, carburized grade 1"),
    "automotive": Use(0.5, 1.0, 1550.0, 11, 0.25, True, "half the peak torque, carburized grade 2"),
    "truck": Use(0.5, 1.0, 1550.0, 11, 0.125, True, "half the peak torque, carburized grade 2"),
    "aircraft": Use(1.0, 1.0, 1550.0, 12, 0.25, False, "lasting torque, carburized grade 2"),
}


def first_size(
    ratio: float,
    torque: float,
    *,
    speed: float | None = None,
    shaft_angle: float = math.pi / 2.0,
    offset: float = 0.0,
    use: str = "industrial",
    hobbed: bool = False,
) -> tuple[DefaultValue, ...]:
    """Size a pair of case-hardened steel whose flanks last.

    Parameters
    ----------
    ratio
        Wanted ratio of the numbers of teeth, 1 to 10.
    torque
        At the pinion [N m]: the peak of a vehicle, the lasting one of other uses.
    speed
        Of the pinion [1/min]; without it the dynamic factor is 1.
    shaft_angle
        Angle between the axes [rad].
    offset
        Hypoid offset [mm].
    use
        ``industrial``, ``automotive``, ``truck`` or ``aircraft``.
    hobbed
        If the pair is face-hobbed, not face-milled.

    Returns
    -------
    tuple
        Values by the names of a design file [mm, rad], those of members with a dot, and where each is from.

    Raises
    ------
    InputError
        If a value is out of range, or no standard cutter is near the size.

    Notes
    -----
    The greatest Hertzian pressure of the virtual cylindrical pair at the mean point, with the factors of ANSI/AGMA
    2003-B97, is the allowable one. The diameter of a hypoid gear is smaller by the offset (ISO 23509:2016, annex B).

    Examples
    --------
    >>> sized = first_size(3.73, 800.0, offset=20.0, use="automotive")
    >>> {each.name: each.value for each in sized}["gear_outer_pitch_diameter"]
    213.0
    """
    checks.number("ratio", ratio, least=1.0, most=10.0)
    checks.number("shaft_angle", shaft_angle, "rad", above=0.0, below=math.pi)
    checks.number("torque", torque, "N m", above=0.0, below=1e7)
    checks.number("offset", offset, "mm", least=0.0, below=1e4)
    if speed is not None:
        checks.number("speed", speed, "1/min", least=1e-6, most=1e6)
    return tuple(_sized(ratio, torque, speed, shaft_angle, offset, checks.one_of("use", use, USES), hobbed))


def _sized(
    ratio: float, torque: float, speed: float | None, shaft_angle: float, offset: float, use: str, hobbed: bool
) -> Iterator[DefaultValue]:
    of_use = USES[use]
    teeth, source = numbers_of_teeth(ratio, of_use.vehicle, offset)
    for member, count in zip(("pinion", "gear"), teeth, strict=True):
        yield DefaultValue(f"{member}.number_of_teeth", count, source)
    widest = LARGEST_PITCH_ANGLE + math.asin(teeth[0] / teeth[1] * math.sin(LARGEST_PITCH_ANGLE))
    if shaft_angle > widest:
        raise InputError(
            f"shaft_angle = {math.degrees(shaft_angle):g} deg: must be at most {math.degrees(widest):.4g} deg at this "
            "ratio; beyond, the gear's pitch angle is above 86 deg"
        )
    lasting = torque * of_use.lasting_share * of_use.overload
    pinion = pinion_diameter(lasting, teeth, shaft_angle, of_use.pressure)
    still, factor = pinion, 1.0
    for _ in range(8 * (speed is not None)):  # the dynamic factor of a size, then the size of that factor
        factor = dynamic_factor(math.pi * pinion * (speed or 0.0) / 6e4, of_use.quality)
        pinion = still * factor ** (1.0 / 3.0)
    bevel_gear = pinion * teeth[1] / teeth[0]
    diameter = float(f"{bevel_gear - offset:.3g}")
    limit = bevel_gear * of_use.offset_limit / (1.0 + of_use.offset_limit)
    if offset > limit:
        raise InputError(
            f"offset = {offset:g}: must be at most {of_use.offset_limit:g} times the diameter of the gear for use = "
            f"{use}, {limit:.3g} mm at this ratio and torque"
        )
    words = f"{of_use.words}, {of_use.pressure:g} MPa, dynamic factor {factor:.3g}: ANSI/AGMA 2003-B97"
    hypoid = "; less the offset: ISO 23509:2016, annex B" if offset else ""
    yield DefaultValue("gear_outer_pitch_diameter", diameter, words + hypoid)
    spiral = SPIRAL_ANGLE
    if offset:
        spiral = math.radians(25.0 + 5.0 * math.sqrt(teeth[1] / teeth[0]) + 90.0 * offset / diameter)
    angle = f"{'pinion' if offset else 'gear'}_mean_spiral_angle"
    given = {"gear_outer_pitch_diameter": diameter, angle: spiral}
    face = next(each for each in usual_proportions(given, teeth, shaft_angle, offset) if each.name == "gear_face_width")
    yield face
    gleason = "25 + 5 sqrt(ratio) + 90 offset / diameter: Gleason"
    yield DefaultValue(angle, spiral, gleason if offset else "usual without offset: ANSI/AGMA 2005-D03")
    middle = 0.5 * (diameter / math.sin(gear_pitch_angle(teeth, shaft_angle)) - face.value)

    def distance(cutter: tuple[float, int]) -> float:
        """Of a cutter from the wanted radius, more if its groups have a common factor with the teeth."""
        return abs(math.log(cutter[0] / middle)) + SHARED_FACTOR * (math.gcd(cutter[1], teeth[0] * teeth[1]) > 1)

    radius, groups = min(HOBS if hobbed else MILLS, key=distance)
    if not 1.0 / CUTTER_RANGE <= radius / middle <= CUTTER_RANGE:
        raise InputError(
            f"torque = {torque:g}: must be {'less' if radius < middle else 'more'} at this ratio; the gear has a mean "
            f"cone distance of {middle:.3g} mm, more than a factor of {CUTTER_RANGE:g} from the nearest standard "
            f"cutter radius, {radius:g} mm; there are {MILLS[0][0]:g} to {MILLS[-1][0]:g} face-milled, {HOBS[0][0]:g} "
            f"to {HOBS[-1][0]:g} face-hobbed"
        )
    yield DefaultValue("cutter_radius", radius, f"standard radius nearest the mean cone distance, {middle:.4g} mm")
    if hobbed:
        common = "with" if math.gcd(groups, teeth[0] * teeth[1]) > 1 else "without"
        yield DefaultValue("number_of_blade_groups", groups, f"of this cutter, {common} a common factor with the teeth")


def numbers_of_teeth(ratio: float, vehicle: bool, offset: float) -> tuple[tuple[int, int], str]:
    """Pinion and gear teeth near a ratio, without a common factor if there are such within a tolerance."""
    if vehicle and ratio >= VEHICLE_RATIO:
        bounds, counts = VEHICLE_TEETH
        usual, source = counts[bisect_left(bounds, ratio)], "vehicles, ratio 1.5 to 10: Krenzer and Hotchkiss"
    else:
        usual, source = round(float(np.interp(ratio, *OTHER_TEETH))), "hardened, ratio 1 to 6: Niemann and Winter"
    fewest = 5 if offset else FEWEST_BEVEL_TEETH
    usual = max(usual, fewest)
    pairs = [
        (pinion, gear)
        for pinion in range(max(usual - 1, fewest), usual + 2)
        for gear in range(max(pinion, math.floor(ratio * pinion) - 1), math.ceil(ratio * pinion) + 2)
    ]

    def miss(teeth: tuple[int, int]) -> float:
        """Relative error of the ratio, plus a share of the distance from the usual number."""
        return abs(teeth[1] / teeth[0] / ratio - 1.0) + 0.005 * abs(teeth[0] - usual)

    hunting = min((each for each in pairs if math.gcd(*each) == 1), key=miss)
    if abs(hunting[1] / hunting[0] / ratio - 1.0) <= RATIO_TOLERANCE:
        return hunting, f"{source}; without a common factor"
    nearest = min(pairs, key=miss)
    return nearest, f"{source}; with a common factor, for none without is within 2 % of the ratio"


def gear_pitch_angle(teeth: tuple[int, int], shaft_angle: float) -> float:
    """Pitch angle of a gear without offset [rad]."""
    return math.atan2(math.sin(shaft_angle), teeth[0] / teeth[1] + math.cos(shaft_angle))


def pinion_diameter(torque: float, teeth: tuple[int, int], shaft_angle: float, pressure: float) -> float:
    """Outer pitch diameter [mm] of a spiral bevel pinion with this greatest pressure [MPa] under a torque [N m].

    Hertz: p² = Z_E² q F cos β cos β_b / (ε b ρ sin α cos α), F = 2 T / d_m, ρ = d_m1 u sin δ_1 / (2 sin Σ), the face
    width b as of the blank.
    """
    ten_modules = 2.0 * FACE_WIDTH_OVER_MODULE * math.sin(gear_pitch_angle(teeth, shaft_angle)) / teeth[1]
    share = min(FACE_WIDTH[False], ten_modules)
    base = math.cos(math.asin(math.sin(SPIRAL_ANGLE) * math.cos(PRESSURE_ANGLE)))
    load = 2e3 * torque * CONCENTRATION * math.cos(SPIRAL_ANGLE) * base * math.sin(shaft_angle) * teeth[0] / teeth[1]
    room = CONTACT_RATIO * 0.25 * share * (1.0 - 0.5 * share) ** 2 * 0.5 * math.sin(2.0 * PRESSURE_ANGLE)
    return float((ELASTICITY**2 * load / (room * pressure**2)) ** (1.0 / 3.0))


def dynamic_factor(pitch_line_velocity: float, quality: int) -> float:
    """Dynamic factor of ANSI/AGMA 2003-B97 by the outer pitch line velocity [m/s] and the quality number, 5 to 12."""
    power = 0.25 * (12.0 - quality) ** (2.0 / 3.0)
    scale = 50.0 + 56.0 * (1.0 - power)
    return float((1.0 + math.sqrt(200.0 * pitch_line_velocity) / scale) ** power)
