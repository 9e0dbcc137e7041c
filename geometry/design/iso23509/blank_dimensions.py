"""The dimensions of a blank, by names of the field, each with its symbol in ISO 23509.

The dimensions of one member, from its cones and its depth at the mean point (ISO 23509:2016, 7.7 to 7.9).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

from ....core.errors import GeometryError


@dataclass(frozen=True, kw_only=True)
class MemberFrame:
    """Cones, face width, spiral angles and mean depth of one member [mm, rad], from which the rest follows."""

    number_of_teeth: Annotated[int, "z"]
    pitch_angle: Annotated[float, "delta"]
    face_angle: Annotated[float, "delta_a"]
    root_angle: Annotated[float, "delta_f"]
    face_apex: Annotated[float, "tzF"]
    root_apex: Annotated[float, "tzR"]
    mean_point_distance: Annotated[float, "tzm"]  # from the crossing point along the axis
    mean_cone_distance: Annotated[float, "Rm"]
    outer_face_width: Annotated[float, "be"]  # mean point to heel
    inner_face_width: Annotated[float, "bi"]  # toe to mean point
    outer_spiral_angle: Annotated[float, "beta_e"]
    mean_spiral_angle: Annotated[float, "beta_m"]
    inner_spiral_angle: Annotated[float, "beta_i"]
    mean_addendum: Annotated[float, "ham"]
    mean_dedendum: Annotated[float, "hfm"]
    thickness_modification_coefficient: Annotated[float, "xsm"]


@dataclass(frozen=True, kw_only=True)
class MemberBlank(MemberFrame):
    """Blank of one member [mm, rad]; each field with its symbol in ISO 23509, without the member's digit.

    ``outer`` is the heel, ``inner`` the toe, ``mean`` the mean point. Apexes are counted from the crossing point of the
    axes, positive beyond it, away from the teeth.
    """

    addendum_angle: Annotated[float, "theta_a"]
    dedendum_angle: Annotated[float, "theta_f"]
    pitch_apex: Annotated[float, "tz"]
    crown_distance: Annotated[float, "txo"]  # outer end of the face cone from the crossing point
    front_crown_distance: Annotated[float, "txi"]  # its inner end
    outer_cone_distance: Annotated[float, "Re"]  # from the pitch apex along the pitch cone
    inner_cone_distance: Annotated[float, "Ri"]
    face_width: Annotated[float, "b"]
    outer_pitch_diameter: Annotated[float, "de"]
    mean_pitch_diameter: Annotated[float, "dm"]
    inner_pitch_diameter: Annotated[float, "di"]
    outer_tip_diameter: Annotated[float, "dae"]
    inner_tip_diameter: Annotated[float, "dai"]
    outer_root_diameter: Annotated[float, "dfe"]
    inner_root_diameter: Annotated[float, "dfi"]
    outer_addendum: Annotated[float, "hae"]
    inner_addendum: Annotated[float, "hai"]
    outer_dedendum: Annotated[float, "hfe"]
    inner_dedendum: Annotated[float, "hfi"]
    outer_whole_depth: Annotated[float, "he"]
    inner_whole_depth: Annotated[float, "hi"]
    mean_normal_thickness: Annotated[float, "smn"]  # circular, with backlash
    mean_transverse_thickness: Annotated[float, "smt"]
    mean_normal_diameter: Annotated[float, "dmn"]  # of the virtual cylinder in the normal section
    mean_normal_chordal_thickness: Annotated[float, "smnc"]
    mean_chordal_addendum: Annotated[float, "hamc"]

    @property
    def mean_point(self) -> tuple[float, float]:
        """Axial and radial coordinate of the mean point [mm]."""
        sine, cosine = math.sin(self.pitch_angle), math.cos(self.pitch_angle)
        return self.mean_cone_distance * cosine - self.pitch_apex, self.mean_cone_distance * sine


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
    shaft_angle: Annotated[float, "Sigma"]
    hypoid_offset: Annotated[float, "a"]
    gear_ratio: Annotated[float, "u"]
    axial_offset_angle: Annotated[float, "zeta_m"]
    offset_angle: Annotated[float, "zeta_mp"]
    root_offset_angle: Annotated[float, "zeta_R"]
    face_offset_angle: Annotated[float, "zeta_o"]
    pitch_plane_offset: Annotated[float, "ap"]
    mean_normal_module: Annotated[float, "m_mn"]
    outer_transverse_module: Annotated[float, "met2"]
    limit_pressure_angle: Annotated[float, "alpha_lim"]
    generated_drive_pressure_angle: Annotated[float, "alpha_nD"]
    generated_coast_pressure_angle: Annotated[float, "alpha_nC"]
    effective_drive_pressure_angle: Annotated[float, "alpha_eD"]
    effective_coast_pressure_angle: Annotated[float, "alpha_eC"]
    mean_normal_pressure_angle: Annotated[float, "alpha_n"]
    limit_radius_of_curvature: Annotated[float, "rho_lim"]
    tooth_line_radius_of_curvature: Annotated[float, "rho_mbeta"]
    face_width_factor: Annotated[float, "c_be2"]
    mean_working_depth: Annotated[float, "hmw"]
    clearance: Annotated[float, "c"]
    mean_whole_depth: Annotated[float, "hm"]
    pinion_whole_depth: Annotated[float, "ht1"]
    pinion_width_in_pitch_plane: Annotated[float, "bp1"]
    pinion_inner_width_in_pitch_plane: Annotated[float, "b1A"]
    pinion_outer_gear_cone_distance: Annotated[float, "Re21"]
    pinion_inner_gear_cone_distance: Annotated[float, "Ri21"]
    pinion_outer_gear_spiral_angle: Annotated[float, "beta_e21"]
    pinion_inner_gear_spiral_angle: Annotated[float, "beta_i21"]
    cutter_lead_angle: Annotated[float, "nu"]
    crown_centre_distance: Annotated[float, "rho_P0"]
    crown_base_radius: Annotated[float, "rho_b"]
    pinion_width_axial_angle: Annotated[float, "lambda_p"]
    pinion_face_contact_width: Annotated[float, "b_reri1"]
    profile_shift_coefficient: Annotated[float, "x_hm1"]
    theoretical_thickness_modification_coefficient: Annotated[float, "x_smn"]


def member_blank(
    frame: MemberFrame, module: float, normal_pressure_angle: float, profile_shift_coefficient: float
) -> MemberBlank:
    """Dimensions of one member [mm, rad] (ISO 23509:2016, 195 to 200, 206, 211 to 225); a positive shift thickens."""
    sine, cosine = math.sin(frame.pitch_angle), math.cos(frame.pitch_angle)
    above, below = frame.face_angle - frame.pitch_angle, frame.pitch_angle - frame.root_angle
    outer_addendum = frame.mean_addendum + frame.outer_face_width * math.tan(above)
    inner_addendum = frame.mean_addendum - frame.inner_face_width * math.tan(above)
    outer_dedendum = frame.mean_dedendum + frame.outer_face_width * math.tan(below)
    inner_dedendum = frame.mean_dedendum - frame.inner_face_width * math.tan(below)
    outer_distance = frame.mean_cone_distance + frame.outer_face_width
    inner_distance = frame.mean_cone_distance - frame.inner_face_width
    if min(inner_distance, inner_addendum + inner_dedendum, outer_addendum + outer_dedendum) <= 0.0:
        raise GeometryError(
            f"member with {frame.number_of_teeth} teeth: nothing is left of the tooth at one end; reduce "
            "gear_face_width or the taper (gear_addendum_angle, gear_dedendum_angle)"
        )
    mean_diameter = 2.0 * frame.mean_cone_distance * sine
    outer_diameter, inner_diameter = 2.0 * outer_distance * sine, 2.0 * inner_distance * sine
    spiral = frame.mean_spiral_angle
    shift = profile_shift_coefficient * math.tan(normal_pressure_angle)
    thickness = module * (math.pi / 2.0 + 2.0 * (frame.thickness_modification_coefficient + shift))
    if not thickness > 0.0:
        raise GeometryError(
            f"member with {frame.number_of_teeth} teeth: mean normal thickness {thickness:g} mm; change the thickness "
            "or profile shift coefficients"
        )
    normal_diameter = mean_diameter / (cosine * (1.0 - (math.sin(spiral) * math.cos(normal_pressure_angle)) ** 2))
    half_angle = thickness / normal_diameter
    return MemberBlank(
        **vars(frame),
        addendum_angle=above,
        dedendum_angle=below,
        pitch_apex=frame.mean_cone_distance * cosine - frame.mean_point_distance,
        crown_distance=frame.mean_point_distance + frame.outer_face_width * cosine - outer_addendum * sine,
        front_crown_distance=frame.mean_point_distance - frame.inner_face_width * cosine - inner_addendum * sine,
        outer_cone_distance=outer_distance,
        inner_cone_distance=inner_distance,
        face_width=frame.outer_face_width + frame.inner_face_width,
        outer_pitch_diameter=outer_diameter,
        mean_pitch_diameter=mean_diameter,
        inner_pitch_diameter=inner_diameter,
        outer_tip_diameter=outer_diameter + 2.0 * outer_addendum * cosine,
        inner_tip_diameter=inner_diameter + 2.0 * inner_addendum * cosine,
        outer_root_diameter=outer_diameter - 2.0 * outer_dedendum * cosine,
        inner_root_diameter=inner_diameter - 2.0 * inner_dedendum * cosine,
        outer_addendum=outer_addendum,
        inner_addendum=inner_addendum,
        outer_dedendum=outer_dedendum,
        inner_dedendum=inner_dedendum,
        outer_whole_depth=outer_addendum + outer_dedendum,
        inner_whole_depth=inner_addendum + inner_dedendum,
        mean_normal_thickness=thickness,
        mean_transverse_thickness=thickness / math.cos(spiral),
        mean_normal_diameter=normal_diameter,
        mean_normal_chordal_thickness=normal_diameter * math.sin(half_angle),
        mean_chordal_addendum=frame.mean_addendum + 0.5 * normal_diameter * cosine * (1.0 - math.cos(half_angle)),
    )
