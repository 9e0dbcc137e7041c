"""The dimensions of a blank, as a frozen record with the names of the field instead of symbols."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class MemberBlank:
    """Blank of one member: lengths in mm, angles in rad; ISO 23509 symbols in brackets, without the member's digit.

    ``outer`` is the heel, ``inner`` the toe, ``mean`` the mean point; the three apexes are counted from the crossing
    point of the axes, positive beyond it, away from the teeth.

    Parameters
    ----------
    number_of_teeth
        z.
    pitch_angle, face_angle, root_angle
        Angles of the cones (delta, delta_a, delta_f).
    addendum_angle, dedendum_angle
        Between pitch and face cone, pitch and root cone (theta_a, theta_f).
    pitch_apex, face_apex, root_apex
        Apexes beyond the crossing point (t_z, t_zF, t_zR).
    mean_point_distance
        From the crossing point to the mean point along the axis (t_zm).
    crown_distance, front_crown_distance
        From the crossing point to the outer and the inner end of the face cone along the axis (t_xo, t_xi).
    outer_cone_distance, mean_cone_distance, inner_cone_distance
        From the pitch apex along the pitch cone (R_e, R_m, R_i).
    face_width, outer_face_width, inner_face_width
        Along the pitch cone: total, mean point to heel, toe to mean point (b, b_e, b_i).
    outer_spiral_angle, mean_spiral_angle, inner_spiral_angle
        On the pitch cone (beta_e, beta_m, beta_i).
    outer_pitch_diameter, mean_pitch_diameter, inner_pitch_diameter
        d_e, d_m, d_i.
    outer_tip_diameter, inner_tip_diameter, outer_root_diameter, inner_root_diameter
        At the ends of face and root cone (d_ae, d_ai, d_fe, d_fi).
    outer_addendum, mean_addendum, inner_addendum
        h_ae, h_am, h_ai.
    outer_dedendum, mean_dedendum, inner_dedendum
        h_fe, h_fm, h_fi.
    outer_whole_depth, inner_whole_depth
        h_e, h_i.
    thickness_modification_coefficient
        x_sm.
    mean_normal_thickness, mean_transverse_thickness
        Circular tooth thickness at the mean point with backlash (s_mn, s_mt).
    mean_normal_diameter
        Of the virtual cylinder in the normal section (d_mn).
    mean_normal_chordal_thickness, mean_chordal_addendum
        For measuring the tooth (s_mnc, h_amc).
    """

    number_of_teeth: int
    pitch_angle: float
    face_angle: float
    root_angle: float
    addendum_angle: float
    dedendum_angle: float
    pitch_apex: float
    face_apex: float
    root_apex: float
    mean_point_distance: float
    crown_distance: float
    front_crown_distance: float
    outer_cone_distance: float
    mean_cone_distance: float
    inner_cone_distance: float
    face_width: float
    outer_face_width: float
    inner_face_width: float
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
    mean_normal_thickness: float
    mean_transverse_thickness: float
    mean_normal_diameter: float
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
