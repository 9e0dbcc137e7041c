"""The basic data of a blank, and the dimensions that follow from them, each with its symbol in ISO 23509:2016.

Basic data are those of tables 2 and 3; dimensions of one member follow from its cones and its depth at the mean point
(7.7 to 7.9).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from ....core.checks import bounded, check_fields, two_whole
from ....core.errors import GeometryError, InputError
from .usual_proportions import BACKLASHES, DATA_TYPE_1

Process = Literal["face_milled", "face_hobbed"]
DepthTaper = Literal["standard", "uniform", "constant_slot_width", "modified_slot_width"]

DATA_TYPE_2 = ("gear_mean_addendum_factor", "depth_factor", "clearance_factor")
THICKNESS_2 = ("thickness_factor", "gear_mean_slot_width")
POSITIVE, NOT_NEGATIVE, SHARE = bounded(above=0.0), bounded(least=0.0), bounded(least=0.0, most=1.0)
SHAFT_ANGLE = bounded("rad", above=0.0, below=math.pi)
SHARP_ANGLE = bounded("rad", least=0.0, below=math.pi / 2)
TAPER_ANGLE = bounded("rad", above=-math.pi / 4, below=math.pi / 4)


@dataclass(frozen=True, kw_only=True)
class BlankDesign:
    """Basic data of a bevel or hypoid pair.

    The tooth is described either by data type I (the four coefficients ``profile_shift_coefficient`` to
    ``thickness_modification_coefficient``) or by data type II (``gear_mean_addendum_factor``, ``depth_factor``,
    ``clearance_factor`` and one of ``thickness_factor`` and ``gear_mean_slot_width``). The taper of the gear tooth is
    described either by both its angles or by ``depth_taper``.

    Parameters
    ----------
    method
        Pitch cones of a spiral bevel pair (0), or of a hypoid pair after Gleason (1), Oerlikon (2), Klingelnberg (3).
    process
        ``"face_milled"`` or ``"face_hobbed"``; methods 2 and 3 are face-hobbed.
    number_of_teeth
        Pinion, gear (z1, z2).
    mean_spiral_angle
        Of the pinion in method 1 (the desired value), of the gear in methods 0, 2 and 3 (beta_m) [rad].
    gear_face_width
        Along the pitch cone (b2) [mm].
    cutter_radius
        Mean radius of the cutter (rc0) [mm].
    nominal_drive_pressure_angle, nominal_coast_pressure_angle
        Nominal design pressure angles (alpha_dD, alpha_dC) [rad].
    gear_outer_pitch_diameter
        Needed by methods 0, 1 and 3 (de2) [mm].
    gear_mean_pitch_diameter
        Needed by method 2 (dm2) [mm].
    shaft_angle
        Angle between the axes (Sigma) [rad].
    hypoid_offset
        Distance between the axes (a) [mm], positive if the pinion's spiral angle is to be larger than the gear's.
    number_of_blade_groups
        Starts of a face-hobbing cutter (z0).
    limit_pressure_angle_influence
        Share of the limit pressure angle by which the generated pressure angles are shifted (f_alim), 0 to 1: 0 keeps
        the nominal angles as generated ones, 1 makes the effective angles equal to the nominal ones.
    profile_shift_coefficient, basic_addendum_factor, basic_dedendum_factor, thickness_modification_coefficient
        Data type I (x_hm1, k_hap, k_hfp, x_smn).
    gear_mean_addendum_factor, depth_factor, clearance_factor, thickness_factor
        Data type II (c_ham, k_d, k_c, k_t).
    gear_mean_slot_width
        Width of the gear's slot at its bottom at mid face, normal to the tooth (W_m2) [mm].
    outer_normal_backlash, outer_transverse_backlash, mean_normal_backlash, mean_transverse_backlash
        At most one of j_en, j_et2, j_mn, j_mt2 [mm]; none means no backlash.
    gear_addendum_angle, gear_dedendum_angle
        Taper of the gear tooth (theta_a2, theta_f2) [rad].
    depth_taper
        ``"standard"``, ``"uniform"``, ``"constant_slot_width"`` (duplex) or ``"modified_slot_width"`` (tilted root
        line), from which the two angles follow. Face-hobbed teeth: ``"uniform"`` only.

    Raises
    ------
    InputError
        If a value is missing, superfluous or out of range; the message names the key.

    Notes
    -----
    Source: ISO 23509:2016, tables 2 and 3; symbols of the standard in brackets.

    Examples
    --------
    >>> from easeoff.cases import read_design
    >>> from easeoff.cases.conversion import blank_design
    >>> design = read_design("fm-11x41")
    >>> blank_design(design.blank_design, (11, 41), design.pair).hypoid_offset
    20.0
    """

    method: int = field(metadata=bounded(most=3))
    process: Process
    number_of_teeth: tuple[int, int]
    mean_spiral_angle: Annotated[float, "beta_m1", "beta_m2"] = field(metadata=SHARP_ANGLE)
    gear_face_width: Annotated[float, "b2"] = field(metadata=POSITIVE)
    cutter_radius: Annotated[float, "rc0"] = field(metadata=POSITIVE)
    nominal_drive_pressure_angle: Annotated[float, "alpha_dD"] = field(metadata=SHARP_ANGLE)
    nominal_coast_pressure_angle: Annotated[float, "alpha_dC"] = field(metadata=SHARP_ANGLE)
    gear_outer_pitch_diameter: Annotated[float | None, "de2"] = field(default=None, metadata=POSITIVE)
    gear_mean_pitch_diameter: Annotated[float | None, "dm2"] = field(default=None, metadata=POSITIVE)
    shaft_angle: Annotated[float, "Sigma"] = field(default=math.pi / 2, metadata=SHAFT_ANGLE)
    hypoid_offset: Annotated[float, "a"] = 0.0
    number_of_blade_groups: Annotated[int | None, "z0"] = None
    limit_pressure_angle_influence: Annotated[float, "f_alim"] = field(default=0.0, metadata=SHARE)
    profile_shift_coefficient: Annotated[float | None, "x_hm1"] = None
    basic_addendum_factor: Annotated[float | None, "k_hap"] = field(default=None, metadata=POSITIVE)
    basic_dedendum_factor: Annotated[float | None, "k_hfp"] = field(default=None, metadata=POSITIVE)
    thickness_modification_coefficient: Annotated[float | None, "x_smn"] = None
    gear_mean_addendum_factor: Annotated[float | None, "c_ham"] = None
    depth_factor: Annotated[float | None, "k_d"] = field(default=None, metadata=POSITIVE)
    clearance_factor: Annotated[float | None, "k_c"] = field(default=None, metadata=NOT_NEGATIVE)
    thickness_factor: Annotated[float | None, "k_t"] = None
    gear_mean_slot_width: Annotated[float | None, "W_m2"] = field(default=None, metadata=POSITIVE)
    outer_normal_backlash: Annotated[float | None, "j_en"] = field(default=None, metadata=NOT_NEGATIVE)
    outer_transverse_backlash: Annotated[float | None, "j_et2"] = field(default=None, metadata=NOT_NEGATIVE)
    mean_normal_backlash: Annotated[float | None, "j_mn"] = field(default=None, metadata=NOT_NEGATIVE)
    mean_transverse_backlash: Annotated[float | None, "j_mt2"] = field(default=None, metadata=NOT_NEGATIVE)
    gear_addendum_angle: Annotated[float | None, "theta_a2"] = field(default=None, metadata=TAPER_ANGLE)
    gear_dedendum_angle: Annotated[float | None, "theta_f2"] = field(default=None, metadata=TAPER_ANGLE)
    depth_taper: DepthTaper | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        two_whole("number_of_teeth", self.number_of_teeth, 1)
        if mistakes := list(unsuited_data(vars(self))):
            raise InputError("\n".join(mistakes))


def _given(values: Mapping[str, Any], names: tuple[str, ...]) -> list[str]:
    return [name for name in names if values[name] is not None]


def unsuited_data(values: Mapping[str, Any]) -> Iterator[str]:
    """Mistakes of basic data, by the names of `BlankDesign`, that lack a value or do not suit one another."""
    method, process, groups = values["method"], values["process"], values["number_of_blade_groups"]
    pinion_teeth, gear_teeth = values["number_of_teeth"]
    if pinion_teeth > gear_teeth:
        yield f"number_of_teeth = {values['number_of_teeth']}: must be pinion first, pinion <= gear"
    if process == "face_milled" and groups is not None:
        yield "number_of_blade_groups: belongs to a face-hobbed pair, leave it out for face_milled"
    if process == "face_hobbed" and (groups is None or int(groups) != groups or groups < 1):
        yield f"number_of_blade_groups = {groups!r}: face_hobbed needs a whole number, 1 or more"
    if method == 0 and values["hypoid_offset"] != 0.0:
        yield f"hypoid_offset = {values['hypoid_offset']}: method 0 has none; take method 1, 2 or 3"
    if method == 1 and values["hypoid_offset"] == 0.0:
        yield "hypoid_offset = 0: method 1 needs an offset; take method 0 for a spiral bevel pair"
    if method in (2, 3) and process != "face_hobbed":
        yield f"process = {process!r}: method {method} describes face_hobbed gears"
    needed, other = "gear_outer_pitch_diameter", "gear_mean_pitch_diameter"
    if method == 2:
        needed, other = other, needed
    if values[needed] is None:
        yield f"{needed} is missing: method {method} needs it"
    if values[other] is not None:
        yield f"{other}: method {method} takes {needed} instead, leave it out"
    type_1, type_2 = _given(values, DATA_TYPE_1), _given(values, DATA_TYPE_2 + THICKNESS_2)
    if type_1 and type_2:
        yield f"{type_2[0]}: belongs to data type II, {type_1[0]} to data type I; give one type only"
    elif not type_1 and not type_2:
        yield f"{DATA_TYPE_2[0]}: missing; give data type II, or data type I with {DATA_TYPE_1[0]}"
    else:
        for name in DATA_TYPE_1 if type_1 else DATA_TYPE_2:
            if values[name] is None:
                yield f"{name}: missing from data type {'I' if type_1 else 'II'}"
        if type_2 and len(_given(values, THICKNESS_2)) != 1:
            yield f"{' or '.join(THICKNESS_2)}: data type II needs exactly one of them"
    if len(backlashes := _given(values, BACKLASHES)) > 1:
        yield f"{backlashes[1]}: give at most one of {', '.join(BACKLASHES)}"
    taper, angles = values["depth_taper"], _given(values, ("gear_addendum_angle", "gear_dedendum_angle"))
    if (taper is None) != (len(angles) == 2) or (taper is not None and angles):
        yield "depth_taper: give either it or both gear_addendum_angle and gear_dedendum_angle"
    if process == "face_hobbed" and taper not in (None, "uniform"):
        yield f"depth_taper = {taper!r}: face_hobbed teeth have uniform depth"


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
    ends: dict[str, Any] = {}
    for end, before, beyond in (("outer", "", frame.outer_face_width), ("inner", "front_", -frame.inner_face_width)):
        addendum = frame.mean_addendum + beyond * math.tan(above)
        dedendum = frame.mean_dedendum + beyond * math.tan(below)
        distance = frame.mean_cone_distance + beyond
        if min(distance, addendum + dedendum) <= 0.0:
            raise GeometryError(
                f"member with {frame.number_of_teeth} teeth: nothing is left of the tooth at one end; reduce "
                "gear_face_width or the taper (gear_addendum_angle, gear_dedendum_angle)"
            )
        ends |= {
            f"{end}_cone_distance": distance,
            f"{end}_pitch_diameter": 2.0 * distance * sine,
            f"{end}_tip_diameter": 2.0 * distance * sine + 2.0 * addendum * cosine,
            f"{end}_root_diameter": 2.0 * distance * sine - 2.0 * dedendum * cosine,
            f"{end}_addendum": addendum,
            f"{end}_dedendum": dedendum,
            f"{end}_whole_depth": addendum + dedendum,
            f"{before}crown_distance": frame.mean_point_distance + beyond * cosine - addendum * sine,
        }
    mean_diameter = 2.0 * frame.mean_cone_distance * sine
    spiral = frame.mean_spiral_angle
    shift = profile_shift_coefficient * math.tan(normal_pressure_angle)
    thickness = module * (math.pi / 2.0 + 2.0 * (frame.thickness_modification_coefficient + shift))
    if not thickness > 0.0:
        raise GeometryError(
            f"member with {frame.number_of_teeth} teeth: mean normal thickness {thickness:g} mm; for the pinion a "
            "larger, for the gear a smaller thickness_factor, thickness_modification_coefficient or "
            "gear_mean_slot_width helps"
        )
    normal_diameter = mean_diameter / (cosine * (1.0 - (math.sin(spiral) * math.cos(normal_pressure_angle)) ** 2))
    half_angle = thickness / normal_diameter
    return MemberBlank(
        **vars(frame),
        **ends,
        addendum_angle=above,
        dedendum_angle=below,
        pitch_apex=frame.mean_cone_distance * cosine - frame.mean_point_distance,
        face_width=frame.outer_face_width + frame.inner_face_width,
        mean_pitch_diameter=mean_diameter,
        mean_normal_thickness=thickness,
        mean_transverse_thickness=thickness / math.cos(spiral),
        mean_normal_diameter=normal_diameter,
        mean_normal_chordal_thickness=normal_diameter * math.sin(half_angle),
        mean_chordal_addendum=frame.mean_addendum + 0.5 * normal_diameter * cosine * (1.0 - math.cos(half_angle)),
    )
