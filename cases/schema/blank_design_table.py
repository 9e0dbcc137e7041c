"""Basic data of the blanks of a pair, after ISO 23509, in a case or design file."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import model_validator

from .schema_table import Table, key, number, optional


class BlankDesignTable(Table):
    """Basic data of both blanks, by ISO 23509:2016, in degrees; ``geometry.BlankDesign`` checks what goes together."""

    method: Literal[0, 1, 2, 3] = number(
        "pitch cones: spiral bevel (0), or hypoid after Gleason (1), Oerlikon (2), Klingelnberg (3)", "1"
    )
    process: Literal["face_milled", "face_hobbed"] = key("face_hobbed in methods 2 and 3")
    pinion_mean_spiral_angle: float | None = optional("method 1", "deg", ge=0, lt=90)
    gear_mean_spiral_angle: float | None = optional(
        "methods 0, 2 and 3; without an offset the pinion's, too", "deg", ge=0, lt=90
    )
    gear_face_width: float = number("along the pitch cone", "mm", gt=0.5, lt=1000)
    cutter_radius: float = number("mean radius", "mm", gt=1, lt=2000)
    nominal_drive_pressure_angle: float = number("nominal drive pressure angle", "deg", default=20.0, ge=0, lt=45)
    nominal_coast_pressure_angle: float = number("nominal coast pressure angle", "deg", default=20.0, ge=0, lt=45)
    gear_outer_pitch_diameter: float | None = optional("methods 0, 1 and 3", "mm", gt=1, lt=10000)
    gear_mean_pitch_diameter: float | None = optional("method 2", "mm", gt=1, lt=10000)
    number_of_blade_groups: int | None = optional("of a face-hobbing cutter", "1", ge=1, le=100)
    limit_pressure_angle_influence: float = number(
        "share of the limit pressure angle that shifts the generated pressure angles", "1", default=0.0, ge=0, le=1
    )
    profile_shift_coefficient: float | None = optional("data type I: of the pinion", "1", gt=-2, lt=2)
    basic_addendum_factor: float | None = optional("data type I: addendum over module", "1", gt=0, lt=3)
    basic_dedendum_factor: float | None = optional("data type I: dedendum over module", "1", gt=0, lt=3)
    thickness_modification_coefficient: float | None = optional(
        "data type I: of the pinion, over module", "1", gt=-1, lt=1
    )
    gear_mean_addendum_factor: float | None = optional(
        "data type II: gear addendum over working depth", "1", gt=-1, lt=2
    )
    depth_factor: float | None = optional("data type II: working depth over module", "1", gt=0, lt=5)
    clearance_factor: float | None = optional("data type II: clearance over working depth", "1", ge=0, lt=1)
    thickness_factor: float | None = optional(
        "data type II: excess of the pinion's mean thickness over half the pitch and the profile shift, and deficit of "
        "the gear's, over module",
        "1",
        gt=-1,
        lt=1,
    )
    gear_mean_slot_width: float | None = optional(
        "data type II, instead of thickness_factor: at the bottom, mid face", "mm", gt=0, lt=200
    )
    outer_normal_backlash: float | None = optional("at the heel", "mm", ge=0, lt=10)
    outer_transverse_backlash: float | None = optional("at the heel", "mm", ge=0, lt=10)
    mean_normal_backlash: float | None = optional("at mid face", "mm", ge=0, lt=10)
    mean_transverse_backlash: float | None = optional("at mid face", "mm", ge=0, lt=10)
    gear_addendum_angle: float | None = optional("face less pitch angle, instead of depth_taper", "deg", gt=-45, lt=45)
    gear_dedendum_angle: float | None = optional("pitch less root angle, instead of depth_taper", "deg", gt=-45, lt=45)
    depth_taper: Literal["standard", "uniform", "constant_slot_width", "modified_slot_width"] | None = key(
        "change of depth along the face", default=None
    )

    @model_validator(mode="before")
    @classmethod
    def _renamed(cls, data: Any) -> Any:
        if isinstance(data, dict) and "mean_spiral_angle" in data:
            raise ValueError(
                "mean_spiral_angle: is now pinion_mean_spiral_angle in method 1, and gear_mean_spiral_angle in methods "
                "0, 2 and 3"
            )
        return data

    def _check(self) -> None:
        wanted, other = "gear_mean_spiral_angle", "pinion_mean_spiral_angle"
        if self.method == 1:
            wanted, other = other, wanted
        if getattr(self, other) is not None:
            raise ValueError(f"{other} = {getattr(self, other)}: method {self.method} takes {wanted} instead")
        if getattr(self, wanted) is None:
            raise ValueError(f"{wanted} is missing: method {self.method} needs it")

    @property
    def mean_spiral_angle(self) -> float:
        """Mean spiral angle that the method takes [deg]."""
        angle = self.pinion_mean_spiral_angle if self.method == 1 else self.gear_mean_spiral_angle
        assert angle is not None  # the validator sees to it
        return angle
