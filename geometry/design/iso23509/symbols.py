"""The symbols of ISO 23509 and the fields that hold them, for people who know the standard.

Symbols are written in plain letters: ``beta_m2`` is the mean spiral angle of the gear, ``tzF1`` the distance of the
pinion's face apex beyond the crossing point. In :data:`ISO_SYMBOLS` a field of a member is written ``pinion.face_apex``
or ``gear.face_apex``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ....core.errors import InputError
from .blank_design import BlankDesign
from .blank_dimensions import BlankDimensions

_MEMBER_SYMBOLS = {
    "z": "number_of_teeth",
    "delta": "pitch_angle",
    "delta_a": "face_angle",
    "delta_f": "root_angle",
    "theta_a": "addendum_angle",
    "theta_f": "dedendum_angle",
    "tz": "pitch_apex",
    "tzF": "face_apex",
    "tzR": "root_apex",
    "tzm": "mean_point_distance",
    "txo": "crown_distance",
    "txi": "front_crown_distance",
    "Re": "outer_cone_distance",
    "Rm": "mean_cone_distance",
    "Ri": "inner_cone_distance",
    "b": "face_width",
    "be": "outer_face_width",
    "bi": "inner_face_width",
    "beta_e": "outer_spiral_angle",
    "beta_m": "mean_spiral_angle",
    "beta_i": "inner_spiral_angle",
    "de": "outer_pitch_diameter",
    "dm": "mean_pitch_diameter",
    "di": "inner_pitch_diameter",
    "dae": "outer_tip_diameter",
    "dai": "inner_tip_diameter",
    "dfe": "outer_root_diameter",
    "dfi": "inner_root_diameter",
    "hae": "outer_addendum",
    "ham": "mean_addendum",
    "hai": "inner_addendum",
    "hfe": "outer_dedendum",
    "hfm": "mean_dedendum",
    "hfi": "inner_dedendum",
    "he": "outer_whole_depth",
    "hi": "inner_whole_depth",
    "xsm": "thickness_modification_coefficient",
    "smn": "mean_normal_thickness",
    "smt": "mean_transverse_thickness",
    "dmn": "mean_normal_diameter",
    "smnc": "mean_normal_chordal_thickness",
    "hamc": "mean_chordal_addendum",
}

ISO_SYMBOLS: dict[str, str] = {
    **{f"{symbol}1": f"pinion.{field}" for symbol, field in _MEMBER_SYMBOLS.items()},
    **{f"{symbol}2": f"gear.{field}" for symbol, field in _MEMBER_SYMBOLS.items()},
    "Sigma": "shaft_angle",
    "a": "hypoid_offset",
    "u": "gear_ratio",
    "zeta_m": "axial_offset_angle",
    "zeta_mp": "offset_angle",
    "zeta_R": "root_offset_angle",
    "zeta_o": "face_offset_angle",
    "ap": "pitch_plane_offset",
    "m_mn": "mean_normal_module",
    "met2": "outer_transverse_module",
    "alpha_lim": "limit_pressure_angle",
    "alpha_nD": "generated_drive_pressure_angle",
    "alpha_nC": "generated_coast_pressure_angle",
    "alpha_eD": "effective_drive_pressure_angle",
    "alpha_eC": "effective_coast_pressure_angle",
    "alpha_n": "mean_normal_pressure_angle",
    "rho_lim": "limit_radius_of_curvature",
    "rho_mbeta": "tooth_line_radius_of_curvature",
    "c_be2": "face_width_factor",
    "hmw": "mean_working_depth",
    "c": "clearance",
    "hm": "mean_whole_depth",
    "ht1": "pinion_whole_depth",
    "bp1": "pinion_width_in_pitch_plane",
    "b1A": "pinion_inner_width_in_pitch_plane",
    "Re21": "pinion_outer_gear_cone_distance",
    "Ri21": "pinion_inner_gear_cone_distance",
    "beta_e21": "pinion_outer_gear_spiral_angle",
    "beta_i21": "pinion_inner_gear_spiral_angle",
    "nu": "cutter_lead_angle",
    "rho_P0": "crown_centre_distance",
    "rho_b": "crown_base_radius",
    "lambda_p": "pinion_width_axial_angle",
    "b_reri1": "pinion_face_contact_width",
    "x_hm1": "profile_shift_coefficient",
    "x_smn": "theoretical_thickness_modification_coefficient",
}
"""Symbol of a result -> field of :class:`BlankDimensions`."""

ISO_INPUT_SYMBOLS: dict[str, str] = {
    "Sigma": "shaft_angle",
    "a": "hypoid_offset",
    "de2": "gear_outer_pitch_diameter",
    "dm2": "gear_mean_pitch_diameter",
    "b2": "gear_face_width",
    "beta_m1": "mean_spiral_angle",
    "beta_m2": "mean_spiral_angle",
    "rc0": "cutter_radius",
    "z0": "number_of_blade_groups",
    "alpha_dD": "nominal_drive_pressure_angle",
    "alpha_dC": "nominal_coast_pressure_angle",
    "f_alim": "limit_pressure_angle_influence",
    "x_hm1": "profile_shift_coefficient",
    "k_hap": "basic_addendum_factor",
    "k_hfp": "basic_dedendum_factor",
    "x_smn": "thickness_modification_coefficient",
    "c_ham": "gear_mean_addendum_factor",
    "k_d": "depth_factor",
    "k_c": "clearance_factor",
    "k_t": "thickness_factor",
    "W_m2": "gear_mean_slot_width",
    "j_en": "outer_normal_backlash",
    "j_et2": "outer_transverse_backlash",
    "j_mn": "mean_normal_backlash",
    "j_mt2": "mean_transverse_backlash",
    "theta_a2": "gear_addendum_angle",
    "theta_f2": "gear_dedendum_angle",
}
"""Symbol of a basic datum -> field of :class:`BlankDesign`; ``z1`` and ``z2`` together are ``number_of_teeth``."""

_GREEK_ANGLES = ("Sigma", "delta", "theta", "beta", "zeta", "alpha", "lambda", "nu")


def is_angle(symbol: str) -> bool:
    """True if a symbol stands for an angle."""
    return symbol.startswith(_GREEK_ANGLES)


def dimensions_by_symbol(dimensions: BlankDimensions, *, degrees: bool = False) -> dict[str, float]:
    """Value of every symbol of ``ISO_SYMBOLS`` [mm, rad or degrees]."""
    values: dict[str, float] = {}
    for symbol, path in ISO_SYMBOLS.items():
        owner, _, field = path.rpartition(".")
        value = float(getattr(getattr(dimensions, owner) if owner else dimensions, field))
        values[symbol] = math.degrees(value) if degrees and is_angle(symbol) else value
    return values


def blank_design_from_symbols(values: Mapping[str, Any], *, degrees: bool = False) -> BlankDesign:
    """Basic data from ``z1``, ``z2``, ``ISO_INPUT_SYMBOLS`` [mm, rad or degrees], fields of ``BlankDesign``."""
    fields: dict[str, Any] = {}
    if "z1" not in values or "z2" not in values:
        raise InputError("z1, z2: both numbers of teeth are needed")
    unwanted = "beta_m2" if values.get("method") == 1 else "beta_m1"
    if unwanted in values:
        raise InputError(f"{unwanted}: method {values.get('method')} takes the other member's mean spiral angle")
    for name, value in values.items():
        if name in ("z1", "z2"):
            continue
        field = ISO_INPUT_SYMBOLS.get(name, name)
        if field not in BlankDesign.__dataclass_fields__:
            raise InputError(f"{name}: no such basic datum; known are {', '.join(ISO_INPUT_SYMBOLS)}")
        angle = degrees and (is_angle(name) or (field == name and name.endswith("_angle")))
        fields[field] = math.radians(value) if angle and isinstance(value, (int, float)) else value
    try:
        return BlankDesign(number_of_teeth=(values["z1"], values["z2"]), **fields)
    except TypeError as error:  # a required field is missing
        raise InputError(str(error).replace("BlankDesign.__init__() ", "basic data: ")) from None
