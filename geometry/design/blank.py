"""Blanks of bevel and hypoid gears by ISO 23509:2016: from basic data to every cone, apex, depth and thickness.

The angles of a generated flank at a point of the pitch cone, measured on the surface itself.

A blank prescribes spiral angle and pressure angle at the mean point; basic settings aim at them by formulas. Here they
are measured, so that the settings can be corrected until the flank has them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...core.arrays import Array
from ...core.checks import instance
from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface, Hand
from ..flanks.blank_section import BlankSection
from ..flanks.flank import solve_flank
from .iso23509.blank_design import BlankDesign as BlankDesign
from .iso23509.blank_dimensions import BlankDimensions as BlankDimensions, MemberBlank, MemberFrame, member_blank
from .iso23509.pitch_cones import PitchCones, crown_gear, pitch_cones
from .iso23509.teeth import (
    PressureAngles,
    ToothDepth,
    mating_cone,
    pinion_face_width,
    pressure_angles,
    thickness_modification,
    tooth_depth,
    width_in_pitch_plane,
)


@dataclass(frozen=True)
class _MeanPoint:
    """Module, ends of the gear's face and distances along the axes [mm] (formulas 116, 122, 123, 126, 129, 130)."""

    module: float
    outer_module: float
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
    depth = tooth_depth(design, mean.module, pressure.mean)
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
    width = pinion_face_width(design, cones, mean.module, depth, pinion_face)
    plane_offset = gear_distance * math.sin(cones.offset_angle)
    along = gear_distance * math.cos(cones.offset_angle)
    outer_reach = math.hypot(along + width.outside, plane_offset)
    inner_reach = math.hypot(along - width.inside, plane_offset)

    crown = crown_gear(design, gear_angle, gear_distance, cones.gear_mean_spiral_angle)
    outer_spiral, inner_spiral = crown.spiral_angle(outer_reach), crown.spiral_angle(inner_reach)
    gear_outer_spiral = crown.spiral_angle(mean.gear_outer)
    changes = thickness_modification(
        design,
        mean.module,
        depth.thickness_modification_coefficient,
        pressure.mean,
        (cones.gear_mean_spiral_angle, gear_outer_spiral),
        (gear_distance, mean.gear_outer),
    )
    pinion = MemberFrame(
        number_of_teeth=design.number_of_teeth[0],
        pitch_angle=cones.pinion_pitch_angle,
        mean_cone_distance=cones.pinion_mean_cone_distance,
        mean_point_distance=mean.pinion_distance,
        outer_face_width=width.outside,
        inner_face_width=width.inside,
        face_angle=pinion_face.angle,
        root_angle=pinion_root.angle,
        face_apex=pinion_face.apex,
        root_apex=pinion_root.apex,
        mean_addendum=depth.addendum[0],
        mean_dedendum=depth.dedendum[0],
        outer_spiral_angle=outer_spiral + math.asin(plane_offset / outer_reach),
        mean_spiral_angle=cones.pinion_mean_spiral_angle,
        inner_spiral_angle=inner_spiral + math.asin(plane_offset / inner_reach),
        thickness_modification_coefficient=changes[0],
    )
    gear = MemberFrame(
        number_of_teeth=design.number_of_teeth[1],
        pitch_angle=gear_angle,
        mean_cone_distance=gear_distance,
        mean_point_distance=mean.gear_distance,
        outer_face_width=mean.gear_outer - gear_distance,
        inner_face_width=gear_distance - mean.gear_inner,
        face_angle=face_angle,
        root_angle=root_angle,
        face_apex=face_apex,
        root_apex=root_apex,
        mean_addendum=depth.addendum[1],
        mean_dedendum=depth.dedendum[1],
        outer_spiral_angle=gear_outer_spiral,
        mean_spiral_angle=cones.gear_mean_spiral_angle,
        inner_spiral_angle=crown.spiral_angle(mean.gear_inner),
        thickness_modification_coefficient=changes[1],
    )
    pinion_blank = member_blank(pinion, mean.module, pressure.mean, depth.profile_shift_coefficient)
    return BlankDimensions(
        pinion=pinion_blank,
        gear=member_blank(gear, mean.module, pressure.mean, -depth.profile_shift_coefficient),
        shaft_angle=cones.shaft_angle,
        hypoid_offset=cones.hypoid_offset,
        gear_ratio=design.number_of_teeth[1] / design.number_of_teeth[0],
        axial_offset_angle=cones.axial_offset_angle,
        offset_angle=cones.offset_angle,
        root_offset_angle=pinion_face.offset_angle,
        face_offset_angle=pinion_root.offset_angle,
        pitch_plane_offset=plane_offset,
        mean_normal_module=mean.module,
        outer_transverse_module=mean.outer_module,
        limit_pressure_angle=pressure.limit,
        generated_drive_pressure_angle=pressure.generated_drive,
        generated_coast_pressure_angle=pressure.generated_coast,
        effective_drive_pressure_angle=pressure.effective_drive,
        effective_coast_pressure_angle=pressure.effective_coast,
        mean_normal_pressure_angle=pressure.mean,
        limit_radius_of_curvature=cones.limit_radius_of_curvature,
        tooth_line_radius_of_curvature=crown.mean_radius_of_curvature,
        face_width_factor=cones.face_width_factor,
        mean_working_depth=depth.working_depth,
        clearance=depth.clearance,
        mean_whole_depth=depth.working_depth + depth.clearance,
        pinion_whole_depth=_normal_whole_depth(pinion_blank),
        pinion_width_in_pitch_plane=width_in_pitch_plane(cones, mean.gear_inner, mean.gear_outer),
        pinion_inner_width_in_pitch_plane=width_in_pitch_plane(cones, mean.gear_inner, gear_distance),
        pinion_outer_gear_cone_distance=outer_reach,
        pinion_inner_gear_cone_distance=inner_reach,
        pinion_outer_gear_spiral_angle=outer_spiral,
        pinion_inner_gear_spiral_angle=inner_spiral,
        cutter_lead_angle=crown.cutter_lead_angle,
        crown_centre_distance=crown.centre_distance,
        crown_base_radius=crown.base_radius,
        pinion_width_axial_angle=width.axial_angle,
        pinion_face_contact_width=width.face_contact_width,
        profile_shift_coefficient=depth.profile_shift_coefficient,
        theoretical_thickness_modification_coefficient=depth.thickness_modification_coefficient,
    )


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
        module=gear_diameter * math.cos(cones.gear_mean_spiral_angle) / teeth,
        outer_module=2.0 * outer * math.sin(gear_angle) / teeth,
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
    addendum_angle = total * depth.addendum[1] / depth.working_depth
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
    width = mean.gear_outer * math.tan(pressure.mean) * math.cos(spiral)
    return math.pi / 2 * mean.outer_module / width * opening


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
    return MeanPointAngles(
        spiral_angle=math.atan(-along_element / around),
        pressure_angle=math.asin(off_cone),
        azimuth=azimuth,
    )
