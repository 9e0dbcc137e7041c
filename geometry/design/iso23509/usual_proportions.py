"""Basic data that drawings omit: proportions of teeth and blanks by ISO 23509:2016, annex C, with their sources."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from ..tolerances import usual_backlash

BACKLASHES = ("outer_normal_backlash", "outer_transverse_backlash", "mean_normal_backlash", "mean_transverse_backlash")
THICKNESSES = ("thickness_factor", "gear_mean_slot_width", "thickness_modification_coefficient")
DATA_TYPE_1 = (
    "profile_shift_coefficient",
    "basic_addendum_factor",
    "basic_dedendum_factor",
    "thickness_modification_coefficient",
)
FACE_WIDTH = {True: 0.25, False: 0.3}  # most, over the outer cone distance: of a Zerol pair, of all others
FACE_WIDTH_OVER_MODULE = 10.0  # most, over the outer transverse module
ZEROL_LIMIT = math.radians(10.0)  # spiral angles below
FEW_TEETH = range(9, 21)  # of hypoid pinions whose gears have a small addendum
#: Depth factors of pinions of few teeth (ANSI/AGMA 2005-D03).
FEW_TEETH_DEPTHS = {6: 1.765, 7: 1.835, 8: 1.895, 9: 1.94, 10: 1.975, 11: 1.995}
STANDARD = "ISO 23509:2016"


@dataclass(frozen=True)
class DefaultValue:
    """Value taken for basic data that were left out, and where it is from."""

    name: str
    value: Any
    source: str

    def __str__(self) -> str:
        value = f'"{self.value}"' if isinstance(self.value, str) else f"{self.value:.5g}"
        return f"{self.name} = {value} ({self.source})"


def usual_proportions(
    given: Mapping[str, Any], teeth: tuple[int, int], shaft_angle: float, offset: float
) -> tuple[DefaultValue, ...]:
    """Values for those of the basic data that are left out or ``None``.

    Parameters
    ----------
    given
        Basic data as `BlankDesign` has them, with `pinion_mean_spiral_angle` and `gear_mean_spiral_angle` [mm, rad].
    teeth
        Pinion, gear.
    shaft_angle
        Angle between the axes [rad].
    offset
        Distance between the axes [mm].

    Returns
    -------
    tuple
        Values in the order in which they are taken. What a drawing must show has none: diameter, spiral angle, cutter.

    Notes
    -----
    Source: ISO 23509:2016, annexes B and C, and ANSI/AGMA 2005-D03 for the addendum of hypoid gears and the thickness
    factor, which the sample F.2 of the ISO standard has, too.

    Examples
    --------
    >>> given = {"gear_outer_pitch_diameter": 176.893, "gear_mean_spiral_angle": 0.61, "cutter_radius": 114.3}
    >>> {each.name: each.value for each in usual_proportions(given, (14, 39), 1.5707963, 0.0)}["clearance_factor"]
    0.125
    """
    known = {name: value for name, value in given.items() if value is not None}
    taken = []
    for each in _values(known, teeth, shaft_angle, offset):
        if each.name not in known:
            known[each.name] = each.value
            taken.append(each)
    return tuple(taken)


def _values(
    known: Mapping[str, Any], teeth: tuple[int, int], shaft_angle: float, offset: float
) -> Iterator[DefaultValue]:
    """Values that there are, whether given or not; ``known`` has each before the next is asked for."""
    groups = "number_of_blade_groups" in known
    as_given = not known.keys().isdisjoint((*THICKNESSES, *BACKLASHES))  # a given thickness is not made less
    source = f"{'' if groups else 'no '}number_of_blade_groups"
    yield DefaultValue("process", "face_hobbed" if groups else "face_milled", source)
    hobbed = known["process"] == "face_hobbed"
    yield _method(known, hobbed, offset)
    yield DefaultValue("limit_pressure_angle_influence", float(known["method"] == 1), f"{STANDARD}, C.2.5")
    ratio = teeth[1] / teeth[0]
    pinion_angle = math.atan2(math.sin(shaft_angle), ratio + math.cos(shaft_angle))
    gear_angle = shaft_angle - pinion_angle
    yield from _face_width(known, teeth[1], gear_angle)
    yield from _depths(known, teeth[0], ratio, ratio * math.cos(pinion_angle) / max(math.cos(gear_angle), 1e-9), offset)
    if "gear_addendum_angle" not in known and "gear_dedendum_angle" not in known:
        yield _taper(known, hobbed, gear_angle, offset)
    diameter = known.get("gear_outer_pitch_diameter", known.get("gear_mean_pitch_diameter"))
    usual = None if diameter is None else usual_backlash(diameter / teeth[1])
    if usual is not None and not as_given:
        yield DefaultValue("outer_normal_backlash", round(sum(usual) / 2.0, 3), "AGMA, mean of qualities 7 to 13")


def _method(known: Mapping[str, Any], hobbed: bool, offset: float) -> DefaultValue:
    if offset == 0.0:
        return DefaultValue("method", 0, "no offset")
    if "gear_mean_pitch_diameter" in known:
        return DefaultValue("method", 2, "offset, gear_mean_pitch_diameter")
    if hobbed and "pinion_mean_spiral_angle" not in known:
        return DefaultValue("method", 3, "face-hobbed, offset, spiral angle of the gear")
    return DefaultValue("method", 1, "offset")


def _face_width(known: Mapping[str, Any], gear_teeth: int, gear_angle: float) -> Iterator[DefaultValue]:
    """Least of a share of the outer cone distance and ten modules, rounded down to 0.1 mm (annex B)."""
    spiral = known.get("gear_mean_spiral_angle", known.get("pinion_mean_spiral_angle", math.inf))
    share = FACE_WIDTH[spiral < ZEROL_LIMIT]
    diameter = known.get("gear_outer_pitch_diameter")
    if diameter is None and "gear_mean_pitch_diameter" in known:
        diameter = known["gear_mean_pitch_diameter"] / (1.0 - 0.5 * share)
    if diameter is not None:
        width = min(share * diameter / (2.0 * math.sin(gear_angle)), FACE_WIDTH_OVER_MODULE * diameter / gear_teeth)
        yield DefaultValue("gear_face_width", math.floor(10.0 * width) / 10.0, f"{STANDARD}, annex B")


def _depths(
    known: Mapping[str, Any], pinion_teeth: int, ratio: float, squared: float, offset: float
) -> Iterator[DefaultValue]:
    """Addendum, dedendum and thickness; ``squared`` is the square of the equivalent ratio at 90 degrees."""
    if offset != 0.0 and pinion_teeth in FEW_TEETH:
        addendum = DefaultValue("gear_mean_addendum_factor", 0.17, "ANSI/AGMA 2005-D03, hypoid of 9 to 20 pinion teeth")
    else:
        addendum = DefaultValue("gear_mean_addendum_factor", 0.21 + 0.29 / squared, f"{STANDARD}, table C.2")
    if any(name in known for name in DATA_TYPE_1):
        yield DefaultValue("basic_addendum_factor", 1.0, f"{STANDARD}, C.3.1.1")
        yield DefaultValue("basic_dedendum_factor", 1.25, f"{STANDARD}, C.3.1.1")
        shift = known["basic_addendum_factor"] * (1.0 - 2.0 * addendum.value)
        yield DefaultValue("profile_shift_coefficient", shift, f"addendum of the gear by {addendum.source}")
        yield DefaultValue("thickness_modification_coefficient", 0.0, "equal thicknesses but for the profile shift")
        return
    yield addendum
    few = FEW_TEETH_DEPTHS.get(max(pinion_teeth, min(FEW_TEETH_DEPTHS)), 2.0)
    source = f"{STANDARD}, C.3.2.1" if few == 2.0 else f"ANSI/AGMA 2005-D03, {pinion_teeth} pinion teeth"
    yield DefaultValue("depth_factor", few, source)
    yield DefaultValue("clearance_factor", 0.125, f"{STANDARD}, C.3.2.2")
    if "gear_mean_slot_width" not in known:
        factor = -0.088 + 0.092 * ratio - 0.004 * ratio**2 + 0.0016 * (pinion_teeth - 30) * (ratio - 1.0)
        yield DefaultValue("thickness_factor", max(factor, 0.0), f"{STANDARD}, figure C.1")


def _taper(known: Mapping[str, Any], hobbed: bool, gear_angle: float, offset: float) -> DefaultValue:
    """Uniform if hobbed, or if the cutter is too small for a slot of constant width; else the tilted root line."""
    if hobbed:
        return DefaultValue("depth_taper", "uniform", f"{STANDARD}, 5.3: face-hobbed")
    diameter, width = known.get("gear_outer_pitch_diameter"), known.get("gear_face_width")
    if diameter is not None and width is not None:
        mean_diameter = diameter - width * math.sin(gear_angle)
        spiral = known.get("gear_mean_spiral_angle")
        if spiral is None and mean_diameter > 2.0 * abs(offset):  # about
            spiral = known.get("pinion_mean_spiral_angle", 0.0) - math.asin(2.0 * offset / mean_diameter)
        least_radius = mean_diameter / (2.0 * math.sin(gear_angle)) * math.sin(spiral or 0.0)
        if least_radius > known.get("cutter_radius", math.inf):
            return DefaultValue("depth_taper", "uniform", f"{STANDARD}, C.5: a cutter of this radius")
    return DefaultValue("depth_taper", "modified_slot_width", f"{STANDARD}, C.5: tilted root line")
