"""The basic data of a blank, from which its dimensions follow (ISO 23509:2016, tables 2 and 3)."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Annotated, Literal

from ....core.checks import number, one_of, positive, two_whole, whole
from ....core.errors import InputError

Process = Literal["face_milled", "face_hobbed"]
DepthTaper = Literal["standard", "uniform", "constant_slot_width", "modified_slot_width"]

PROCESSES = ("face_milled", "face_hobbed")
DEPTH_TAPERS = ("standard", "uniform", "constant_slot_width", "modified_slot_width")
BACKLASHES = ("outer_normal_backlash", "outer_transverse_backlash", "mean_normal_backlash", "mean_transverse_backlash")
DATA_TYPE_1 = (
    "profile_shift_coefficient",
    "basic_addendum_factor",
    "basic_dedendum_factor",
    "thickness_modification_coefficient",
)
DATA_TYPE_2 = ("gear_mean_addendum_factor", "depth_factor", "clearance_factor")
THICKNESS_2 = ("thickness_factor", "gear_mean_slot_width")


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

    method: int
    process: Process
    number_of_teeth: tuple[int, int]
    mean_spiral_angle: Annotated[float, "beta_m1", "beta_m2"]
    gear_face_width: Annotated[float, "b2"]
    cutter_radius: Annotated[float, "rc0"]
    nominal_drive_pressure_angle: Annotated[float, "alpha_dD"]
    nominal_coast_pressure_angle: Annotated[float, "alpha_dC"]
    gear_outer_pitch_diameter: Annotated[float | None, "de2"] = None
    gear_mean_pitch_diameter: Annotated[float | None, "dm2"] = None
    shaft_angle: Annotated[float, "Sigma"] = math.pi / 2
    hypoid_offset: Annotated[float, "a"] = 0.0
    number_of_blade_groups: Annotated[int | None, "z0"] = None
    limit_pressure_angle_influence: Annotated[float, "f_alim"] = 0.0
    profile_shift_coefficient: Annotated[float | None, "x_hm1"] = None
    basic_addendum_factor: Annotated[float | None, "k_hap"] = None
    basic_dedendum_factor: Annotated[float | None, "k_hfp"] = None
    thickness_modification_coefficient: Annotated[float | None, "x_smn"] = None
    gear_mean_addendum_factor: Annotated[float | None, "c_ham"] = None
    depth_factor: Annotated[float | None, "k_d"] = None
    clearance_factor: Annotated[float | None, "k_c"] = None
    thickness_factor: Annotated[float | None, "k_t"] = None
    gear_mean_slot_width: Annotated[float | None, "W_m2"] = None
    outer_normal_backlash: Annotated[float | None, "j_en"] = None
    outer_transverse_backlash: Annotated[float | None, "j_et2"] = None
    mean_normal_backlash: Annotated[float | None, "j_mn"] = None
    mean_transverse_backlash: Annotated[float | None, "j_mt2"] = None
    gear_addendum_angle: Annotated[float | None, "theta_a2"] = None
    gear_dedendum_angle: Annotated[float | None, "theta_f2"] = None
    depth_taper: DepthTaper | None = None

    def __post_init__(self) -> None:
        self._check_types()
        self._check_choices()
        self._check_ranges()
        self._check_method()
        self._check_tooth()

    def _given(self, names: tuple[str, ...]) -> list[str]:
        return [name for name in names if getattr(self, name) is not None]

    def _check_types(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name in ("method", "process", "number_of_teeth", "depth_taper"):
                continue
            if value is None and field.default is None:
                continue
            number(field.name, value)

    def _check_choices(self) -> None:
        whole("method", self.method, 0, 3)
        one_of("process", self.process, PROCESSES)
        if self.depth_taper is not None:
            one_of("depth_taper", self.depth_taper, DEPTH_TAPERS)
        pinion_teeth, gear_teeth = two_whole("number_of_teeth", self.number_of_teeth, 1)
        if pinion_teeth > gear_teeth:
            raise InputError(f"number_of_teeth = {self.number_of_teeth}: must be pinion first, pinion <= gear")
        if self.process == "face_milled" and self.number_of_blade_groups is not None:
            raise InputError("number_of_blade_groups: belongs to a face-hobbed pair, leave it out for face_milled")
        if self.process == "face_hobbed":
            groups = self.number_of_blade_groups
            if groups is None or int(groups) != groups or groups < 1:
                raise InputError(f"number_of_blade_groups = {groups!r}: face_hobbed needs a whole number, 1 or more")

    def _check_ranges(self) -> None:
        above_zero = (
            "gear_face_width",
            "cutter_radius",
            "gear_outer_pitch_diameter",
            "gear_mean_pitch_diameter",
            "basic_addendum_factor",
            "basic_dedendum_factor",
            "depth_factor",
            "gear_mean_slot_width",
        )
        for name in self._given(above_zero):
            positive(name, getattr(self, name))
        for name in self._given((*BACKLASHES, "clearance_factor")):
            positive(name, getattr(self, name), zero=True)
        below_right_angle = ("mean_spiral_angle", "nominal_drive_pressure_angle", "nominal_coast_pressure_angle")
        for name in below_right_angle:
            number(name, getattr(self, name), "rad", least=0.0, below=math.pi / 2)
        for name in self._given(("gear_addendum_angle", "gear_dedendum_angle")):
            number(name, getattr(self, name), "rad", above=-math.pi / 4, below=math.pi / 4)
        number("shaft_angle", self.shaft_angle, "rad", above=0.0, below=math.pi)
        number("limit_pressure_angle_influence", self.limit_pressure_angle_influence, least=0.0, most=1.0)

    def _check_method(self) -> None:
        if self.method == 0 and self.hypoid_offset != 0.0:
            raise InputError(f"hypoid_offset = {self.hypoid_offset}: method 0 has none; take method 1, 2 or 3")
        if self.method == 1 and self.hypoid_offset == 0.0:
            raise InputError("hypoid_offset = 0: method 1 needs an offset; take method 0 for a spiral bevel pair")
        if self.method in (2, 3) and self.process != "face_hobbed":
            raise InputError(f"process = {self.process!r}: method {self.method} describes face_hobbed gears")
        needed, other = "gear_outer_pitch_diameter", "gear_mean_pitch_diameter"
        if self.method == 2:
            needed, other = other, needed
        if getattr(self, needed) is None:
            raise InputError(f"{needed}: method {self.method} needs it")
        if getattr(self, other) is not None:
            raise InputError(f"{other}: method {self.method} takes {needed} instead, leave it out")

    def _check_tooth(self) -> None:
        type_1, type_2 = self._given(DATA_TYPE_1), self._given(DATA_TYPE_2 + THICKNESS_2)
        if type_1 and type_2:
            raise InputError(f"{type_2[0]}: belongs to data type II, {type_1[0]} to data type I; give one type only")
        if not type_1 and not type_2:
            raise InputError(f"{DATA_TYPE_2[0]}: missing; give data type II, or data type I with {DATA_TYPE_1[0]}")
        for name in DATA_TYPE_1 if type_1 else DATA_TYPE_2:
            if getattr(self, name) is None:
                raise InputError(f"{name}: missing from data type {'I' if type_1 else 'II'}")
        if type_2 and len(self._given(THICKNESS_2)) != 1:
            raise InputError(f"{' or '.join(THICKNESS_2)}: data type II needs exactly one of them")
        if len(self._given(BACKLASHES)) > 1:
            raise InputError(f"{self._given(BACKLASHES)[1]}: give at most one of {', '.join(BACKLASHES)}")
        angles = self._given(("gear_addendum_angle", "gear_dedendum_angle"))
        if (self.depth_taper is None) != (len(angles) == 2) or (self.depth_taper is not None and angles):
            raise InputError("depth_taper: give either it or both gear_addendum_angle and gear_dedendum_angle")
        if self.process == "face_hobbed" and self.depth_taper not in (None, "uniform"):
            raise InputError(f"depth_taper = {self.depth_taper!r}: face_hobbed teeth have uniform depth")
