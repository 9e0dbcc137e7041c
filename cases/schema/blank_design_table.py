"""Basic data of the blanks of a pair, after ISO 23509, in a case or design file."""

from __future__ import annotations

import math
from typing import Any, Literal, Self

from pydantic import PrivateAttr, model_validator

from ...core.errors import GeometryError, InputError
from ...geometry.design.iso23509.blank_dimensions import BlankDesign, unsuited_data
from ...geometry.design.iso23509.usual_proportions import DefaultValue, usual_proportions
from .schema_table import Table, in_radians, key, number, optional


class BlankDesignTable(Table):
    """Basic data of both blanks, by ISO 23509:2016, in degrees; ``geometry.BlankDesign`` checks what goes together.

    What is left out has a default where the standard has one, see `usual_proportions`.
    """

    method: Literal[0, 1, 2, 3] | None = optional(
        "pitch cones: spiral bevel (0), or hypoid after Gleason (1), Oerlikon (2), Klingelnberg (3); by offset and "
        "process if left out",
        "1",
    )
    process: Literal["face_milled", "face_hobbed"] | None = key(
        "face_hobbed in methods 2 and 3, and if left out where number_of_blade_groups is given", default=None
    )
    pinion_mean_spiral_angle: float | None = optional(
        "taken by method 1; from the gear's if left out", "deg", ge=0, lt=90
    )
    gear_mean_spiral_angle: float | None = optional(
        "taken by methods 0, 2 and 3; from the pinion's if left out", "deg", ge=0, lt=90
    )
    gear_face_width: float | None = optional(
        "along the pitch cone; at most 0.3 of the outer cone distance and 10 modules if left out", "mm", gt=0.5, lt=1000
    )
    cutter_radius: float = number("mean radius", "mm", gt=1, lt=2000)
    nominal_drive_pressure_angle: float = number("nominal drive pressure angle", "deg", default=20.0, ge=0, lt=45)
    nominal_coast_pressure_angle: float = number("nominal coast pressure angle", "deg", default=20.0, ge=0, lt=45)
    gear_outer_pitch_diameter: float | None = optional("methods 0, 1 and 3", "mm", gt=1, lt=10000)
    gear_mean_pitch_diameter: float | None = optional("method 2", "mm", gt=1, lt=10000)
    number_of_blade_groups: int | None = optional("of a face-hobbing cutter", "1", ge=1, le=100)
    limit_pressure_angle_influence: float | None = optional(
        "share of the limit pressure angle that shifts the generated ones; if left out 1 in method 1, else 0",
        "1",
        ge=0,
        le=1,
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
        "change of depth along the face; uniform if left out where face-hobbed, else modified_slot_width", default=None
    )
    _defaults: tuple[DefaultValue, ...] = PrivateAttr(default=())

    @model_validator(mode="before")
    @classmethod
    def _renamed(cls, data: Any) -> Any:
        if isinstance(data, dict) and "mean_spiral_angle" in data:
            raise ValueError(
                "mean_spiral_angle: is now pinion_mean_spiral_angle in method 1, and gear_mean_spiral_angle in methods "
                "0, 2 and 3"
            )
        return data

    @property
    def defaults(self) -> tuple[DefaultValue, ...]:
        """Values taken for keys that the file leaves out."""
        return self._defaults

    def with_defaults(self, changed: tuple[DefaultValue, ...]) -> Self:
        """The table with these values in place of those that were taken before."""
        copy = self.model_copy(update={each.name: each.value for each in changed})
        others = {each.name: each for each in changed}
        copy._defaults = tuple(others.pop(each.name, each) for each in self._defaults) + tuple(others.values())
        return copy

    def completed(self, teeth: tuple[int, int], shaft_angle: float, hypoid_offset: float) -> Self:
        """The table with values for what is left out; an `InputError` names all that is missing or does not suit.

        Shaft angle [deg], offset [mm]; teeth of pinion and gear.
        """
        if mistakes := self.mistakes(teeth, shaft_angle, hypoid_offset):
            raise InputError("\n".join(mistakes))
        whole = self._with_proportions(teeth, shaft_angle, hypoid_offset)
        name, other = whole.spiral_angles
        if getattr(whole, name) is not None:
            return whole
        angle, source = getattr(whole, other), "no offset: that of the other member"
        if hypoid_offset != 0.0:
            from ...geometry.design.iso23509.pitch_cones import mate_spiral_angle

            source = f"with it method {whole.method} gives {other} = {angle:g}"
            trial = whole.model_copy(update={name: angle}).basic_data(teeth, shaft_angle, hypoid_offset)
            try:
                angle = math.degrees(mate_spiral_angle(trial, math.radians(angle)))
            except GeometryError as error:
                raise InputError(f"[blank_design] {other} = {angle:g}: {error}") from error
        return whole.with_defaults((DefaultValue(name, angle, source),))

    def _with_proportions(self, teeth: tuple[int, int], shaft_angle: float, hypoid_offset: float) -> Self:
        return self.with_defaults(usual_proportions(in_radians(self), teeth, math.radians(shaft_angle), hypoid_offset))

    def mistakes(self, teeth: tuple[int, int], shaft_angle: float, hypoid_offset: float) -> list[str]:
        """All that is missing or does not suit other values, once what may be left out has its default."""
        whole = self._with_proportions(teeth, shaft_angle, hypoid_offset)
        data = {**dict(whole), "number_of_teeth": (0, 0), "hypoid_offset": hypoid_offset}
        texts = list(unsuited_data(data))
        name, other = whole.spiral_angles
        if getattr(whole, name) is None and getattr(whole, other) is None:
            texts.insert(0, f"{name} is missing: method {whole.method} needs it, or {other}")
        texts = [f"[blank_design] {text}" for text in texts]
        if teeth[0] > teeth[1]:
            texts.append(
                f"pinion.number_of_teeth = {teeth[0]}: must be at most gear.number_of_teeth = {teeth[1]}; the pinion "
                "has the fewer teeth"
            )
        return texts

    def basic_data(self, teeth: tuple[int, int], shaft_angle: float, hypoid_offset: float) -> BlankDesign:
        """Basic data in rad, of a completed table; shaft angle [deg], offset [mm]."""
        values = {key: value for key, value in in_radians(self).items() if not key.endswith("_mean_spiral_angle")}
        return BlankDesign(
            number_of_teeth=teeth,
            mean_spiral_angle=math.radians(self.mean_spiral_angle),
            shaft_angle=math.radians(shaft_angle),
            hypoid_offset=hypoid_offset,
            **values,
        )

    @property
    def spiral_angles(self) -> tuple[str, str]:
        """Key of the spiral angle that the method takes, and that of the other member."""
        names = ("gear_mean_spiral_angle", "pinion_mean_spiral_angle")
        return names[::-1] if self.method == 1 else names

    def tooth_size(self, teeth: tuple[int, int]) -> tuple[float, float]:
        """Outer transverse module and face width of the gear [mm], of completed basic data."""
        width, diameter = self.gear_face_width or 0.0, self.gear_outer_pitch_diameter or 0.0
        if self.gear_mean_pitch_diameter is not None:
            diameter = self.gear_mean_pitch_diameter + width * teeth[1] / math.hypot(*teeth)
        return diameter / teeth[1], width

    @property
    def mean_spiral_angle(self) -> float:
        """Mean spiral angle that the method takes [deg]."""
        angle = getattr(self, self.spiral_angles[0])
        assert angle is not None  # the validator sees to it
        return float(angle)
