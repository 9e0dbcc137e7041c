"""The dimensions of a blank, as a frozen record with the names of the field instead of symbols.

The dimensions of one member, from its cones and its depth at the mean point (ISO 23509:2016, 7.7 to 7.9).

Taper of the tooth depth along the face: addendum and dedendum angle of the gear (ISO 23509:2016, annex C.5).

The sum of the dedendum angles of both members is the amount by which the roots of pinion and gear open towards the
heel. Standard taper makes the depth proportional to the cone distance; constant slot width (duplex) tilts the root
line until a slot has the same width at toe and heel, so that one cutter can finish both flanks; modified slot width
(tilted root line) does the same but never exceeds 1.3 times the standard sum.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ....core.errors import GeometryError
from .blank_design import DepthTaper


@dataclass(frozen=True, kw_only=True)
class MemberBlank:
    """Blank of one member [mm, rad], by the symbols of ISO 23509 without the member's digit.

    ``outer`` is the heel, ``inner`` the toe, ``mean`` the mean point. Apexes are counted from the crossing point of the
    axes, positive beyond it, away from the teeth.
    """

    number_of_teeth: int
    pitch_angle: float
    face_angle: float
    root_angle: float
    addendum_angle: float
    dedendum_angle: float
    pitch_apex: float  # t_z; face t_zF, root t_zR
    face_apex: float
    root_apex: float
    mean_point_distance: float  # t_zm, from the crossing point along the axis
    crown_distance: float  # t_xo, outer end of the face cone from the crossing point
    front_crown_distance: float  # t_xi, its inner end
    outer_cone_distance: float  # R_e, from the pitch apex along the pitch cone
    mean_cone_distance: float
    inner_cone_distance: float
    face_width: float
    outer_face_width: float  # b_e, mean point to heel
    inner_face_width: float  # b_i, toe to mean point
    outer_spiral_angle: float
    mean_spiral_angle: float
    inner_spiral_angle: float
    outer_pitch_diameter: float
    mean_pitch_diameter: float
    inner_pitch_diameter: float
    outer_tip_diameter: float
    inner_tip_diameter: float
    outer_root_diameter: float
    inner_root_diameter: float
    outer_addendum: float
    mean_addendum: float
    inner_addendum: float
    outer_dedendum: float
    mean_dedendum: float
    inner_dedendum: float
    outer_whole_depth: float
    inner_whole_depth: float
    thickness_modification_coefficient: float
    mean_normal_thickness: float  # s_mn, circular, with backlash
    mean_transverse_thickness: float
    mean_normal_diameter: float  # d_mn, of the virtual cylinder in the normal section
    mean_normal_chordal_thickness: float
    mean_chordal_addendum: float


@dataclass(frozen=True, kw_only=True)
class BlankDimensions:
    """Blanks of both members and what they share: lengths in mm, angles in rad; ISO 23509 symbols in brackets.

    A value that a method or a process does not have is NaN.

    Parameters
    ----------
    pinion, gear
        The members.
    shaft_angle, hypoid_offset
        Position of the axes (Sigma, a).
    gear_ratio
        u.
    axial_offset_angle, offset_angle, root_offset_angle, face_offset_angle
        Offset angle of the pinion in its axial plane, in the pitch plane, in the gear's root and face plane (zeta_m,
        zeta_mp, zeta_R, zeta_o).
    pitch_plane_offset
        Offset in the pitch plane (a_p).
    mean_normal_module, outer_transverse_module
        m_mn, m_et2.
    limit_pressure_angle
        alpha_lim.
    generated_drive_pressure_angle, generated_coast_pressure_angle
        alpha_nD, alpha_nC.
    effective_drive_pressure_angle, effective_coast_pressure_angle
        alpha_eD, alpha_eC.
    mean_normal_pressure_angle
        alpha_n.
    limit_radius_of_curvature
        Of the limit flank, lengthwise (rho_lim); NaN without offset.
    tooth_line_radius_of_curvature
        Of the tooth line on the crown gear at the mean point (rho_m_beta).
    face_width_factor
        Share of the gear's face width outside the mean point (c_be2).
    mean_working_depth, clearance, mean_whole_depth
        h_mw, c, h_m.
    pinion_whole_depth
        At right angles to the pinion's root cone, at the heel (h_t1).
    pinion_width_in_pitch_plane, pinion_inner_width_in_pitch_plane
        b_p1, b_1A.
    pinion_outer_gear_cone_distance, pinion_inner_gear_cone_distance
        Cone distance on the gear of the pinion's ends (R_e21, R_i21).
    pinion_outer_gear_spiral_angle, pinion_inner_gear_spiral_angle
        Spiral angle of the gear there (beta_e21, beta_i21).
    cutter_lead_angle, crown_centre_distance, crown_base_radius
        Crown gear (nu, rho_P0, rho_b).
    pinion_width_axial_angle, pinion_face_contact_width
        Auxiliary values of method 1 (lambda', b_reri1).
    profile_shift_coefficient, theoretical_thickness_modification_coefficient
        x_hm1, x_smn, also when data type II was given.

    Examples
    --------
    >>> from easeoff.cases import designed_blanks, read_design
    >>> design = read_design("fm-11x41")
    >>> blanks = designed_blanks(design.blank_design, (11, 41), design.pair)
    >>> round(blanks.mean_normal_module, 3), round(blanks.gear.pitch_angle, 4)
    (3.847, 1.2685)
    """

    pinion: MemberBlank
    gear: MemberBlank
    shaft_angle: float
    hypoid_offset: float
    gear_ratio: float
    axial_offset_angle: float
    offset_angle: float
    root_offset_angle: float
    face_offset_angle: float
    pitch_plane_offset: float
    mean_normal_module: float
    outer_transverse_module: float
    limit_pressure_angle: float
    generated_drive_pressure_angle: float
    generated_coast_pressure_angle: float
    effective_drive_pressure_angle: float
    effective_coast_pressure_angle: float
    mean_normal_pressure_angle: float
    limit_radius_of_curvature: float
    tooth_line_radius_of_curvature: float
    face_width_factor: float
    mean_working_depth: float
    clearance: float
    mean_whole_depth: float
    pinion_whole_depth: float
    pinion_width_in_pitch_plane: float
    pinion_inner_width_in_pitch_plane: float
    pinion_outer_gear_cone_distance: float
    pinion_inner_gear_cone_distance: float
    pinion_outer_gear_spiral_angle: float
    pinion_inner_gear_spiral_angle: float
    cutter_lead_angle: float
    crown_centre_distance: float
    crown_base_radius: float
    pinion_width_axial_angle: float
    pinion_face_contact_width: float
    profile_shift_coefficient: float
    theoretical_thickness_modification_coefficient: float


@dataclass(frozen=True, kw_only=True)
class MemberFrame:
    """Data that one member's dimensions follow from [mm, rad]."""

    number_of_teeth: int
    pitch_angle: float
    mean_cone_distance: float
    mean_point_distance: float
    outer_width: float
    inner_width: float
    face_angle: float
    root_angle: float
    face_apex: float
    root_apex: float
    addendum: float
    dedendum: float
    spiral_angles: tuple[float, float, float]  # at heel, mean point and toe
    profile_shift_coefficient: float  # positive: thicker tooth
    thickness_modification_coefficient: float


def member_blank(frame: MemberFrame, module: float, normal_pressure_angle: float) -> MemberBlank:
    """Dimensions of one member [mm, rad] (ISO 23509:2016, 195 to 200, 206, 211 to 225)."""
    sine, cosine = math.sin(frame.pitch_angle), math.cos(frame.pitch_angle)
    above, below = frame.face_angle - frame.pitch_angle, frame.pitch_angle - frame.root_angle
    outer_addendum = frame.addendum + frame.outer_width * math.tan(above)
    inner_addendum = frame.addendum - frame.inner_width * math.tan(above)
    outer_dedendum = frame.dedendum + frame.outer_width * math.tan(below)
    inner_dedendum = frame.dedendum - frame.inner_width * math.tan(below)
    outer_distance = frame.mean_cone_distance + frame.outer_width
    inner_distance = frame.mean_cone_distance - frame.inner_width
    if min(inner_distance, inner_addendum + inner_dedendum, outer_addendum + outer_dedendum) <= 0.0:
        raise GeometryError(
            f"member with {frame.number_of_teeth} teeth: nothing is left of the tooth at one end; reduce "
            "gear_face_width or the taper (gear_addendum_angle, gear_dedendum_angle)"
        )
    mean_diameter = 2.0 * frame.mean_cone_distance * sine
    outer_diameter, inner_diameter = 2.0 * outer_distance * sine, 2.0 * inner_distance * sine

    spiral = frame.spiral_angles[1]
    shift = frame.profile_shift_coefficient * math.tan(normal_pressure_angle)
    thickness = module * (math.pi / 2.0 + 2.0 * (frame.thickness_modification_coefficient + shift))
    if not thickness > 0.0:
        raise GeometryError(
            f"member with {frame.number_of_teeth} teeth: mean normal thickness {thickness:g} mm; change the thickness "
            "or profile shift coefficients"
        )
    normal_diameter = mean_diameter / (cosine * (1.0 - (math.sin(spiral) * math.cos(normal_pressure_angle)) ** 2))
    half_angle = thickness / normal_diameter
    return MemberBlank(
        number_of_teeth=frame.number_of_teeth,
        pitch_angle=frame.pitch_angle,
        face_angle=frame.face_angle,
        root_angle=frame.root_angle,
        addendum_angle=above,
        dedendum_angle=below,
        pitch_apex=frame.mean_cone_distance * cosine - frame.mean_point_distance,
        face_apex=frame.face_apex,
        root_apex=frame.root_apex,
        mean_point_distance=frame.mean_point_distance,
        crown_distance=frame.mean_point_distance + frame.outer_width * cosine - outer_addendum * sine,
        front_crown_distance=frame.mean_point_distance - frame.inner_width * cosine - inner_addendum * sine,
        outer_cone_distance=outer_distance,
        mean_cone_distance=frame.mean_cone_distance,
        inner_cone_distance=inner_distance,
        face_width=frame.outer_width + frame.inner_width,
        outer_face_width=frame.outer_width,
        inner_face_width=frame.inner_width,
        outer_spiral_angle=frame.spiral_angles[0],
        mean_spiral_angle=spiral,
        inner_spiral_angle=frame.spiral_angles[2],
        outer_pitch_diameter=outer_diameter,
        mean_pitch_diameter=mean_diameter,
        inner_pitch_diameter=inner_diameter,
        outer_tip_diameter=outer_diameter + 2.0 * outer_addendum * cosine,
        inner_tip_diameter=inner_diameter + 2.0 * inner_addendum * cosine,
        outer_root_diameter=outer_diameter - 2.0 * outer_dedendum * cosine,
        inner_root_diameter=inner_diameter - 2.0 * inner_dedendum * cosine,
        outer_addendum=outer_addendum,
        mean_addendum=frame.addendum,
        inner_addendum=inner_addendum,
        outer_dedendum=outer_dedendum,
        mean_dedendum=frame.dedendum,
        inner_dedendum=inner_dedendum,
        outer_whole_depth=outer_addendum + outer_dedendum,
        inner_whole_depth=inner_addendum + inner_dedendum,
        thickness_modification_coefficient=frame.thickness_modification_coefficient,
        mean_normal_thickness=thickness,
        mean_transverse_thickness=thickness / math.cos(spiral),
        mean_normal_diameter=normal_diameter,
        mean_normal_chordal_thickness=normal_diameter * math.sin(half_angle),
        mean_chordal_addendum=frame.addendum + 0.5 * normal_diameter * cosine * (1.0 - math.cos(half_angle)),
    )


def standard_sum_of_dedendum_angles(
    pinion_mean_dedendum: float, gear_mean_dedendum: float, gear_mean_cone_distance: float
) -> float:
    """Sum of both dedendum angles with standard taper [rad] (ISO 23509:2016, C.3)."""
    return math.atan(pinion_mean_dedendum / gear_mean_cone_distance) + math.atan(
        gear_mean_dedendum / gear_mean_cone_distance
    )


def constant_slot_width_sum_of_dedendum_angles(
    *,
    outer_transverse_module: float,
    gear_outer_cone_distance: float,
    gear_mean_cone_distance: float,
    mean_normal_pressure_angle: float,
    gear_mean_spiral_angle: float,
    cutter_radius: float,
) -> float:
    """Sum of both dedendum angles with constant slot width [rad] (ISO 23509:2016, C.5)."""
    opening = 1.0 - gear_mean_cone_distance * math.sin(gear_mean_spiral_angle) / cutter_radius
    if opening < 0.0:
        raise GeometryError(
            f"cutter_radius = {cutter_radius:g} mm: too small for this depth_taper, must be at least "
            f"{gear_mean_cone_distance * math.sin(gear_mean_spiral_angle):g} mm"
        )
    width = gear_outer_cone_distance * math.tan(mean_normal_pressure_angle) * math.cos(gear_mean_spiral_angle)
    return math.pi / 2 * outer_transverse_module / width * opening


def gear_taper_angles(
    taper: DepthTaper,
    *,
    pinion_mean_dedendum: float,
    gear_mean_dedendum: float,
    gear_mean_addendum: float,
    mean_working_depth: float,
    outer_transverse_module: float,
    gear_outer_cone_distance: float,
    gear_mean_cone_distance: float,
    mean_normal_pressure_angle: float,
    gear_mean_spiral_angle: float,
    cutter_radius: float,
) -> tuple[float, float]:
    """Addendum and dedendum angle of the gear [rad] for a kind of taper (ISO 23509:2016, C.6 to C.11)."""
    if taper == "uniform":
        return 0.0, 0.0
    standard = standard_sum_of_dedendum_angles(pinion_mean_dedendum, gear_mean_dedendum, gear_mean_cone_distance)
    if taper == "standard":
        # the gear's face cone follows the pinion's root cone
        addendum_angle = math.atan(pinion_mean_dedendum / gear_mean_cone_distance)
        return addendum_angle, standard - addendum_angle
    total = constant_slot_width_sum_of_dedendum_angles(
        outer_transverse_module=outer_transverse_module,
        gear_outer_cone_distance=gear_outer_cone_distance,
        gear_mean_cone_distance=gear_mean_cone_distance,
        mean_normal_pressure_angle=mean_normal_pressure_angle,
        gear_mean_spiral_angle=gear_mean_spiral_angle,
        cutter_radius=cutter_radius,
    )
    if taper == "modified_slot_width":
        total = min(total, 1.3 * standard)
    addendum_angle = total * gear_mean_addendum / mean_working_depth
    return addendum_angle, total - addendum_angle
