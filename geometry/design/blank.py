"""Blanks of bevel and hypoid gears by ISO 23509:2016: from basic data to every cone, apex, depth and thickness.

A blank prescribes spiral angle and pressure angle at the mean point; basic settings aim at them by formulas. Here they
are measured, so that the settings can be corrected until the flank has them.

From the pitch cones to the teeth there is one function for each step of ISO 23509:2016, clause 7. Pairs of values are
ordered pinion, gear.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...core.arrays import Array, shared_fields
from ...core.checks import instance
from ...core.errors import GeometryError, InputError
from ..cutting.generating_surface import GeneratingSurface, Hand
from ..flanks.blank_section import BlankSection
from ..flanks.flank import solve_flank
from .iso23509.blank_dimensions import (
    BlankDesign as BlankDesign,
    BlankDimensions as BlankDimensions,
    MemberBlank,
    MemberFrame,
    member_blank,
)
from .iso23509.pitch_cones import PitchCones, crown_gear, pitch_cones


@dataclass(frozen=True)
class _MeanPoint:
    """Module, ends of the gear's face and distances along the axes [mm] (formulas 116, 122, 123, 126, 129, 130)."""

    mean_normal_module: float
    outer_transverse_module: float
    gear_outer: float
    gear_inner: float
    pinion_distance: float
    gear_distance: float
    gear_apex: float


def blank_dimensions(design: BlankDesign, cones: PitchCones | None = None) -> BlankDimensions:
    """Dimensions of the blanks of a pair.

    Parameters
    ----------
    design
        Basic data.
    cones
        Pitch cones to take instead of those of the design's method, for a pair whose cones are known.

    Returns
    -------
    BlankDimensions
        Cones, apexes, depths and thicknesses of both members [mm, rad].

    Raises
    ------
    InputError
        If a value of the design cannot be used.
    GeometryError
        If the design has no pitch cones, or teeth that do not fit them.

    Notes
    -----
    Source: ISO 23509:2016, clauses 6 and 7, annex C.5. Bare formula numbers in the modules of ``iso23509`` are those
    of the standard.

    Examples
    --------
    >>> from math import degrees, radians
    >>> design = BlankDesign(
    ...     method=0, process="face_milled", number_of_teeth=(14, 39), mean_spiral_angle=radians(35.0),
    ...     gear_outer_pitch_diameter=176.893, gear_face_width=25.4, cutter_radius=114.3,
    ...     nominal_drive_pressure_angle=radians(20.0), nominal_coast_pressure_angle=radians(20.0),
    ...     gear_mean_addendum_factor=0.24737, depth_factor=2.0, clearance_factor=0.125, thickness_factor=0.0915,
    ...     outer_normal_backlash=0.127, depth_taper="constant_slot_width",
    ... )
    >>> round(degrees(blank_dimensions(design).gear.face_angle), 3)
    72.387
    """
    instance("design", design, BlankDesign)
    instance("cones", cones, PitchCones | None)
    cones = pitch_cones(design) if cones is None else cones
    mean, pressure = _mean_point(design, cones), pressure_angles(design, cones)
    gear_distance, gear_angle = cones.gear_mean_cone_distance, cones.gear_pitch_angle
    depth = tooth_depth(design, mean.mean_normal_module, pressure.mean_normal_pressure_angle)
    above, below = _gear_taper(design, cones, mean, pressure, depth)

    # face and root cones (formulas 140 to 153)
    face_angle, root_angle = gear_angle + above, gear_angle - below
    face_rise = gear_distance * math.sin(above) - depth.addendum[1] * math.cos(above)
    root_fall = gear_distance * math.sin(below) - depth.dedendum[1] * math.cos(below)
    face_apex = mean.gear_apex - face_rise / math.sin(face_angle)
    root_apex = mean.gear_apex + root_fall / math.sin(root_angle)
    pinion_face = mating_cone(cones, mean.gear_apex, root_angle, below, root_apex, depth.clearance)
    pinion_root = mating_cone(cones, mean.gear_apex, face_angle, above, face_apex, depth.clearance)

    # ends of the pinion as points of the gear's pitch plane (formulas 174, 175, 185, 186)
    width = pinion_face_width(design, cones, mean.mean_normal_module, depth, pinion_face)
    plane_offset = gear_distance * math.sin(cones.offset_angle)
    along = gear_distance * math.cos(cones.offset_angle)
    outer_reach = math.hypot(along + width.outside, plane_offset)
    inner_reach = math.hypot(along - width.inside, plane_offset)

    crown = crown_gear(design, gear_angle, gear_distance, cones.gear_mean_spiral_angle)
    outer_spiral, inner_spiral = crown.spiral_angle(outer_reach), crown.spiral_angle(inner_reach)
    gear_outer_spiral = crown.spiral_angle(mean.gear_outer)
    changes = thickness_modification(design, cones, mean, pressure, depth, gear_outer_spiral)
    both: dict[str, tuple[Any, Any]] = {
        "number_of_teeth": design.number_of_teeth,
        "pitch_angle": (cones.pinion_pitch_angle, gear_angle),
        "mean_cone_distance": (cones.pinion_mean_cone_distance, gear_distance),
        "mean_point_distance": (mean.pinion_distance, mean.gear_distance),
        "outer_face_width": (width.outside, mean.gear_outer - gear_distance),
        "inner_face_width": (width.inside, gear_distance - mean.gear_inner),
        "face_angle": (pinion_face.angle, face_angle),
        "root_angle": (pinion_root.angle, root_angle),
        "face_apex": (pinion_face.apex, face_apex),
        "root_apex": (pinion_root.apex, root_apex),
        "mean_addendum": depth.addendum,
        "mean_dedendum": depth.dedendum,
        "outer_spiral_angle": (outer_spiral + math.asin(plane_offset / outer_reach), gear_outer_spiral),
        "mean_spiral_angle": (cones.pinion_mean_spiral_angle, cones.gear_mean_spiral_angle),
        "inner_spiral_angle": (
            inner_spiral + math.asin(plane_offset / inner_reach),
            crown.spiral_angle(mean.gear_inner),
        ),
        "thickness_modification_coefficient": changes,
    }
    frames = [MemberFrame(**{name: values[member] for name, values in both.items()}) for member in (0, 1)]
    shift = depth.profile_shift_coefficient
    pinion_blank = member_blank(frames[0], mean.mean_normal_module, pressure.mean_normal_pressure_angle, shift)
    return BlankDimensions(
        pinion=pinion_blank,
        gear=member_blank(frames[1], mean.mean_normal_module, pressure.mean_normal_pressure_angle, -shift),
        **shared_fields(BlankDimensions, cones, mean, pressure, depth, crown, width),
        gear_ratio=design.number_of_teeth[1] / design.number_of_teeth[0],
        root_offset_angle=pinion_face.offset_angle,
        face_offset_angle=pinion_root.offset_angle,
        pitch_plane_offset=plane_offset,
        mean_whole_depth=depth.mean_working_depth + depth.clearance,
        pinion_whole_depth=_normal_whole_depth(pinion_blank),
        pinion_width_in_pitch_plane=width_in_pitch_plane(cones, mean.gear_inner, mean.gear_outer),
        pinion_inner_width_in_pitch_plane=width_in_pitch_plane(cones, mean.gear_inner, gear_distance),
        pinion_outer_gear_cone_distance=outer_reach,
        pinion_inner_gear_cone_distance=inner_reach,
        pinion_outer_gear_spiral_angle=outer_spiral,
        pinion_inner_gear_spiral_angle=inner_spiral,
        crown_centre_distance=crown.centre_distance,
        crown_base_radius=crown.base_radius,
        theoretical_thickness_modification_coefficient=depth.thickness_modification_coefficient,
    )


def blank_section(member: MemberBlank, clearance: float) -> BlankSection:
    """Axial section of one member of a blank; the flank ends at the clearance above the root cone.

    Examples
    --------
    >>> from easeoff.cases import designed_blanks, read_design
    >>> design = read_design("fm-11x41")
    >>> blanks = designed_blanks(design.blank_design, (11, 41), design.pair)
    >>> blank_section(blanks.gear, blanks.clearance).face_width == blanks.gear.face_width
    True
    """
    instance("member", member, MemberBlank)
    return BlankSection(**shared_fields(BlankSection, member), clearance=clearance)


def _mean_point(design: BlankDesign, cones: PitchCones) -> _MeanPoint:
    distance, gear_angle = cones.gear_mean_cone_distance, cones.gear_pitch_angle
    teeth = design.number_of_teeth[1]
    outer = distance + cones.face_width_factor * design.gear_face_width
    inner = outer - design.gear_face_width
    if not 0.0 < inner < distance < outer:
        raise GeometryError(
            f"gear_face_width = {design.gear_face_width:g} mm: the mean point, at cone distance {distance:g} mm, is "
            f"not inside the face, which runs from {inner:g} to {outer:g} mm"
        )
    excess, axial = cones.shaft_angle - math.pi / 2, cones.axial_offset_angle
    gear_diameter = cones.gear_mean_pitch_diameter
    lean = cones.pinion_mean_pitch_diameter / math.cos(cones.pinion_pitch_angle)
    tilt = math.cos(axial) * math.tan(excess)
    along_gear = (lean * math.sin(gear_angle) - tilt * (gear_diameter + lean * math.cos(gear_angle))) / 2.0
    return _MeanPoint(
        mean_normal_module=gear_diameter * math.cos(cones.gear_mean_spiral_angle) / teeth,
        outer_transverse_module=2.0 * outer * math.sin(gear_angle) / teeth,
        gear_outer=outer,
        gear_inner=inner,
        pinion_distance=gear_diameter / 2.0 * math.cos(axial) * math.cos(excess) - along_gear * math.sin(excess),
        gear_distance=along_gear,
        gear_apex=distance * math.cos(gear_angle) - along_gear,
    )


def _gear_taper(
    design: BlankDesign, cones: PitchCones, mean: _MeanPoint, pressure: PressureAngles, depth: ToothDepth
) -> tuple[float, float]:
    """Addendum and dedendum angle of the gear, as given or by the kind of taper [rad] (annex C.5).

    Their sum over both members opens the roots towards the heel. Standard taper makes the depth proportional to the
    cone distance; constant slot width (duplex) tilts the root line until a slot has the same width at toe and heel, so
    that one cutter can finish both flanks; modified slot width (tilted root line) does the same up to 1.3 times the
    standard sum.
    """
    taper, distance = design.depth_taper, cones.gear_mean_cone_distance
    if design.gear_addendum_angle is not None and design.gear_dedendum_angle is not None:
        return design.gear_addendum_angle, design.gear_dedendum_angle
    if taper == "uniform":
        return 0.0, 0.0
    # the gear's face cone follows the pinion's root cone (C.3, C.6 to C.8)
    of_pinion = math.atan(depth.dedendum[0] / distance)
    standard = of_pinion + math.atan(depth.dedendum[1] / distance)
    if taper == "standard":
        return of_pinion, standard - of_pinion
    total = _constant_slot_width(design, cones, mean, pressure)
    if taper == "modified_slot_width":
        total = min(total, 1.3 * standard)
    addendum_angle = total * depth.addendum[1] / depth.mean_working_depth
    return addendum_angle, total - addendum_angle


def _constant_slot_width(design: BlankDesign, cones: PitchCones, mean: _MeanPoint, pressure: PressureAngles) -> float:
    """Sum of both dedendum angles with constant slot width [rad] (C.5)."""
    distance, spiral = cones.gear_mean_cone_distance, cones.gear_mean_spiral_angle
    opening = 1.0 - distance * math.sin(spiral) / design.cutter_radius
    if opening < 0.0:
        raise GeometryError(
            f"cutter_radius = {design.cutter_radius:g} mm: too small for this depth_taper, must be at least "
            f"{distance * math.sin(spiral):g} mm"
        )
    slope = math.tan(pressure.mean_normal_pressure_angle)
    return math.pi / 2 * mean.outer_transverse_module / (mean.gear_outer * slope * math.cos(spiral)) * opening


def _normal_whole_depth(pinion: MemberBlank) -> float:
    """Whole depth at the heel at right angles to the root cone [mm] (formula 226)."""
    along_face = (pinion.face_apex + pinion.crown_distance) / math.cos(pinion.face_angle)
    depth = along_face * math.sin(pinion.addendum_angle + pinion.dedendum_angle)
    return depth - (pinion.root_apex - pinion.face_apex) * math.sin(pinion.root_angle)


@dataclass(frozen=True)
class MeanPointAngles:
    """Angles of a flank at the mean point's axial and radial coordinates."""

    spiral_angle: float  # [rad] in the tangent plane of the pitch cone, positive for the member's hand
    pressure_angle: float  # [rad], positive where the tooth narrows towards its tip
    azimuth: float  # [rad] about the member's axis, as on a right-hand member


def mean_point_angles(surface: GeneratingSurface, section: BlankSection, member: MemberBlank) -> MeanPointAngles:
    """Angles of a flank at the mean point of its blank; GeometryError if it does not pass through that point."""
    flank = solve_flank(surface, section, *np.array(member.mean_point)[:, None])
    position, normal = flank.position[:, 0], flank.normal[:, 0]
    if not np.all(np.isfinite(position)):
        raise GeometryError("the flank does not pass through the mean point of its blank")
    return angles_of_normal(position, normal, member.pitch_angle, surface.hand)


def angles_of_normal(position: Array, normal: Array, pitch_angle: float, hand: Hand) -> MeanPointAngles:
    """Angles of a flank at a point (3) [mm] from its outward normal, against a cone of ``pitch_angle`` [rad]."""
    sine, cosine = math.sin(pitch_angle), math.cos(pitch_angle)
    side = 1.0 if hand == "right" else -1.0
    azimuth = math.atan2(side * position[1], position[0])
    towards_axis = np.array([math.cos(azimuth), math.sin(azimuth)])
    across = np.array([normal[0], side * normal[1]])
    outward = float(towards_axis @ across)
    around = float(towards_axis[0] * across[1] - towards_axis[1] * across[0])
    along_element = sine * outward + cosine * float(normal[2])
    off_cone = cosine * outward - sine * float(normal[2])
    # The trace is at right angles to the normal; towards the heel of a right-hand member the azimuth grows along it.
    return MeanPointAngles(math.atan(-along_element / around), math.asin(off_cone), azimuth)


@dataclass(frozen=True)
class PressureAngles:
    """Normal pressure angles of both flanks [rad] (formulas 118 to 121 and 201)."""

    generated_drive_pressure_angle: float
    generated_coast_pressure_angle: float
    effective_drive_pressure_angle: float  # against the limit flank (alpha_eD)
    effective_coast_pressure_angle: float  # likewise (alpha_eC)
    mean_normal_pressure_angle: float  # mean of both generated angles (alpha_n)


@dataclass(frozen=True)
class ToothDepth:
    """Tooth depth at the mean point [mm] (formulas 132 to 139), with the coefficients it came from."""

    profile_shift_coefficient: float
    thickness_modification_coefficient: float
    mean_working_depth: float
    clearance: float
    addendum: tuple[float, float]
    dedendum: tuple[float, float]


@dataclass(frozen=True)
class MatingCone:
    """Cone of the pinion that runs at a distance along a cone of the gear."""

    offset_angle: float
    angle: float
    apex: float


@dataclass(frozen=True)
class PinionFaceWidth:
    """Face width of the pinion from the mean point outwards and inwards [mm] (formulas 156 to 173)."""

    outside: float
    inside: float
    pinion_width_axial_angle: float = math.nan
    pinion_face_contact_width: float = math.nan


def pressure_angles(design: BlankDesign, cones: PitchCones) -> PressureAngles:
    """Pressure angles, shifted by the asked share of the limit pressure angle."""
    limit = cones.limit_pressure_angle
    shift = design.limit_pressure_angle_influence * limit
    drive, coast = design.nominal_drive_pressure_angle + shift, design.nominal_coast_pressure_angle - shift
    return PressureAngles(drive, coast, drive - limit, coast + limit, (drive + coast) / 2.0)


def tooth_depth(design: BlankDesign, module: float, normal_pressure_angle: float) -> ToothDepth:
    """Tooth depth from data type I, or from type II turned into type I (ISO 23509:2016, table 4)."""
    shift, thickness = design.profile_shift_coefficient, design.thickness_modification_coefficient
    above, below = design.basic_addendum_factor, design.basic_dedendum_factor
    if design.depth_factor is not None:
        addendum_factor, clearance_factor = design.gear_mean_addendum_factor, design.clearance_factor
        if addendum_factor is None or clearance_factor is None:
            raise InputError("gear_mean_addendum_factor, clearance_factor: data type II needs both")
        above = design.depth_factor / 2.0
        shift = design.depth_factor * (0.5 - addendum_factor)
        below = design.depth_factor * (clearance_factor + 0.5)
        if design.thickness_factor is not None:
            thickness = design.thickness_factor / 2.0
        elif design.gear_mean_slot_width is not None:
            # the slot narrows from its width at the pitch cone by both flanks down to the gear's dedendum
            slope = math.tan(normal_pressure_angle)
            thickness = (design.gear_mean_slot_width / module + 2.0 * below * slope - math.pi / 2.0) / 2.0
    if shift is None or above is None or below is None or thickness is None:
        raise InputError("profile_shift_coefficient: data type I is incomplete")
    return ToothDepth(
        profile_shift_coefficient=shift,
        thickness_modification_coefficient=thickness,
        mean_working_depth=2.0 * module * above,
        clearance=module * (below - above),
        addendum=(module * (above + shift), module * (above - shift)),
        dedendum=(module * (below - shift), module * (below + shift)),
    )


def mating_cone(
    cones: PitchCones, gear_pitch_apex: float, cone_angle: float, taper: float, apex: float, clearance: float
) -> MatingCone:
    """Pinion cone that clears a gear cone: face over root, or root under face (formulas 142 to 147, 152, 153).

    Angles [rad]; apexes beyond the crossing point and clearance [mm]; ``taper`` is the angle of that cone against the
    pitch cone, without sign. GeometryError if the offset leaves no common plane.
    """
    excess, offset = cones.shaft_angle - math.pi / 2, cones.hypoid_offset
    reach = cones.gear_mean_cone_distance * math.cos(taper) - gear_pitch_apex * math.cos(cone_angle)
    tilt = math.atan(offset * math.tan(excess) * math.cos(cone_angle) / reach)
    sine = offset * math.cos(tilt) * math.sin(cone_angle) / reach
    if not abs(sine) < 1.0:
        raise GeometryError(f"hypoid_offset = {offset:g} mm: no pinion cone can follow the gear's face and root cones")
    turn = math.asin(sine) - tilt
    level_part, turned_part = math.sin(excess) * math.sin(cone_angle), math.cos(excess) * math.cos(cone_angle)
    pinion_angle = math.asin(level_part + turned_part * math.cos(turn))
    level = offset * math.sin(turn) * math.cos(cone_angle) - apex * math.sin(cone_angle)
    return MatingCone(turn, pinion_angle, (level - clearance) / math.sin(pinion_angle))


def width_in_pitch_plane(cones: PitchCones, inner: float, outer: float) -> float:
    """Pinion face width between two cone distances of the gear [mm] (formulas 154 and 155)."""
    offset = cones.gear_mean_cone_distance * math.sin(cones.offset_angle)
    if not inner > abs(offset):
        raise GeometryError(f"gear_face_width: the gear's inner cone distance {inner:g} mm falls short of the offset")
    return math.sqrt(outer**2 - offset**2) - math.sqrt(inner**2 - offset**2)


def pinion_face_width(
    design: BlankDesign, cones: PitchCones, module: float, depth: ToothDepth, face: MatingCone
) -> PinionFaceWidth:
    """Face width of the pinion by the rule of its method (formulas 156 to 173); method 1 uses the face cone."""
    width, share = design.gear_face_width, cones.face_width_factor
    if design.method == 0:
        return PinionFaceWidth(share * width, (1.0 - share) * width)
    if design.method == 2:
        total = width * (1.0 + math.tan(cones.offset_angle) ** 2)
        return PinionFaceWidth(share * total, (1.0 - share) * total)
    if design.method == 3:
        outer = cones.gear_mean_cone_distance + share * width
        inner = outer - width
        in_plane = width_in_pitch_plane(cones, inner, outer)
        # the standard asks for a whole number of millimetres
        total = math.floor(in_plane + 3.0 * module * abs(math.tan(cones.offset_angle)) + 1.0)
        inside = width_in_pitch_plane(cones, inner, cones.gear_mean_cone_distance) + (total - in_plane) / 2.0
        return PinionFaceWidth(total - inside, inside)
    return _gleason_face_width(design, cones, depth, face)


def _gleason_face_width(design: BlankDesign, cones: PitchCones, depth: ToothDepth, face: MatingCone) -> PinionFaceWidth:
    """Face width of the pinion long enough to cover the gear's, along its axis (formulas 159 to 165)."""
    ratio = design.number_of_teeth[1] / design.number_of_teeth[0]
    pinion, gear, turn = cones.pinion_pitch_angle, cones.gear_pitch_angle, cones.offset_angle
    tilt = math.atan2(math.sin(turn) * math.cos(gear), ratio * math.cos(pinion) + math.cos(gear) * math.cos(turn))
    contact = design.gear_face_width * math.cos(tilt) / math.cos(turn - tilt)
    # one millimetre along the pitch cone covers this much of the pinion axis, measured on the face cone
    axial = math.cos(face.angle) / math.cos(face.angle - pinion)
    margin = depth.mean_working_depth * abs(math.sin(face.offset_angle)) * (1.0 - 1.0 / ratio)
    step = (depth.dedendum[1] - depth.clearance) * math.sin(pinion)
    raised = depth.addendum[0] * math.sin(pinion)
    share = cones.face_width_factor
    outside = (share * contact * axial + margin - step + raised) / axial
    inside = ((1.0 - share) * contact * axial + margin + step - raised) / axial
    return PinionFaceWidth(outside, inside, tilt, contact)


def thickness_modification(
    design: BlankDesign,
    cones: PitchCones,
    mean: _MeanPoint,
    pressure: PressureAngles,
    depth: ToothDepth,
    outer_spiral: float,
) -> tuple[float, float]:
    """Coefficients x_sm1, x_sm2, half the backlash taken off each member (formulas 202 to 210).

    ``outer_spiral`` is the gear's spiral angle at the heel [rad].
    """
    mean_spiral, scale = cones.gear_mean_spiral_angle, cones.gear_mean_cone_distance / mean.gear_outer
    normal = 1.0 / math.cos(pressure.mean_normal_pressure_angle)
    factors = (
        (design.outer_normal_backlash, normal * scale * math.cos(mean_spiral) / math.cos(outer_spiral)),
        (design.outer_transverse_backlash, scale * math.cos(mean_spiral)),
        (design.mean_normal_backlash, normal),
        (design.mean_transverse_backlash, math.cos(mean_spiral)),
    )
    # normal to the tooth at the mean point, as the circular thickness that both members lose together
    lost = sum(backlash * factor for backlash, factor in factors if backlash is not None)
    theoretical, each = depth.thickness_modification_coefficient, lost / (4.0 * mean.mean_normal_module)
    return theoretical - each, -theoretical - each
