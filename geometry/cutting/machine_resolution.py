"""Resolution of machine and cutter settings: the steps to which they are set, and how they are written.

The steps are those of a numerically controlled machine that is set by the digits of a summary sheet; a change of one
moves a flank by a tenth of a micrometre or less. Blades are ground and trued to coarser ones.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields

from ...core.checks import number
from .named_settings import MODIFIED_ROLL_ORDERS, scale_of

LARGEST_STEP = 10.0  # mm or degrees
STEP_NOISE = 1e-14  # of a bound: a multiple that passes it by less is on it


@dataclass(frozen=True)
class MachineResolution:
    """Steps in which settings are given; mm and degrees, as in case files.

    Parameters
    ----------
    length
        Of linear settings of the machine [mm].
    angle
        Of angular settings of the machine [deg].
    roll
        Of the ratio of roll.
    modified_roll
        Of the coefficients of the modified roll.
    motion
        Of the derivatives of moving settings [mm/rad or deg/rad].
    blade_radius
        Of the radius of a blade tip [mm].
    blade_angle
        Of the angles of a blade [deg].
    edge_radius
        Of the edge radius of a blade [mm].
    profile_radius
        Of the radius of a curved blade profile [mm].

    Raises
    ------
    InputError
        If a step is not positive.

    Examples
    --------
    >>> MachineResolution(angle=0.01).length
    0.001
    """

    length: float = 0.001
    angle: float = 0.001
    roll: float = 1e-6
    modified_roll: float = 1e-5
    motion: float = 0.001
    blade_radius: float = 0.01
    blade_angle: float = 0.01
    edge_radius: float = 0.01
    profile_radius: float = 1.0

    def __post_init__(self) -> None:
        for field in fields(self):
            number(f"resolution of {field.name}", getattr(self, field.name), above=0.0, below=LARGEST_STEP)


@dataclass(frozen=True)
class SettingStep:
    """Step of one setting.

    Parameters
    ----------
    unit
        Unit in which it is set and written.
    step
        Smallest step [unit].
    factor
        Units per internal one: mm, rad or per radian.
    reciprocal
        Whether one over the setting is set and written, as the radius of a blade's profile is.

    Examples
    --------
    >>> SettingStep("deg", 0.001, math.degrees(1.0)).text(math.radians(70.0863))
    '70.086'
    """

    unit: str
    step: float
    factor: float = 1.0
    reciprocal: bool = False

    @property
    def decimals(self) -> int:
        """Decimals of a written value."""
        return max(0, -math.floor(math.log10(self.step) + 1e-9))

    def written(self, value: float) -> float:
        """A setting [internal unit] in the unit in which it is written; infinite where that is one over zero."""
        if self.reciprocal:
            return math.inf if value == 0.0 else 1.0 / value
        return self.factor * value

    def rounded(self, value: float) -> float:
        """The nearest setting that can be set [internal unit].

        Examples
        --------
        >>> round(SettingStep("mm", 0.001).rounded(1.23456), 9)
        1.235
        """
        written = self.written(value)
        if math.isinf(written):
            return 0.0
        steps = nearest_multiple(written, self.step)
        if self.reciprocal:
            return 1.0 / steps if steps else value
        return steps / self.factor

    def text(self, value: float) -> str:
        """A setting [internal unit] as it is written."""
        written = self.written(value)
        return "straight" if math.isinf(written) else f"{written:.{self.decimals}f}"


def nearest_multiple(value: float, step: float, low: float = -math.inf, high: float = math.inf) -> float:
    """The nearest multiple of a step between bounds, without the noise of the product; where none is, the value itself.

    >>> nearest_multiple(70.08634, 0.001), nearest_multiple(70.08634, 0.001, high=70.0859)
    (70.086, 70.085)
    """
    count = step_count(value, step, low, high)
    return value if count is None else round(count * step, 12) + 0.0


def step_count(value: float, step: float, low: float = -math.inf, high: float = math.inf) -> int | None:
    """Number of steps nearest to a value between bounds; ``None`` where no multiple of the step is.

    >>> step_count(0.019, 0.01, high=0.019), step_count(0.019, 0.01, 0.015, 0.019)
    (1, None)
    """
    count = round(min(max(value, low), high) / step)
    low, high = low - STEP_NOISE * abs(low), high + STEP_NOISE * abs(high)
    count += int(count * step < low) - int(count * step > high)
    return count if low <= count * step <= high else None


ANGLES = ("cradle_angle", "machine_root_angle", "cutter_tilt", "cutter_swivel")
LENGTHS = (
    "radial_distance",
    "horizontal_distance",
    "vertical_distance",
    "work_offset",
    "sliding_base",
    "machine_center_to_crossing_point",
)
#: The resolution that each setting takes, but for modified roll and motions.
RESOLUTION_OF: Mapping[str, str] = {
    **dict.fromkeys(ANGLES, "angle"),
    **dict.fromkeys(LENGTHS, "length"),
    "ratio_of_roll": "roll",
    **dict.fromkeys(("pressure_angle", "offset_angle", "rake_angle", "hook_angle"), "blade_angle"),
    "point_radius": "blade_radius",
    "edge_radius": "edge_radius",
    "blade_curvature": "profile_radius",
}
PER_RADIAN = math.degrees(1.0)
USUAL_RESOLUTION = MachineResolution()


def setting_step(name: str, resolution: MachineResolution = USUAL_RESOLUTION) -> SettingStep:
    """Step of a setting by its name in ``named_settings``. Raises as ``scale_of``.

    Examples
    --------
    >>> setting_step("machine_root_angle").step, setting_step("sliding_base_motion_1").unit
    (0.001, 'mm/rad^1')
    """
    scale_of(name)
    step = step_of(name, resolution)
    assert step is not None  # every named setting has one
    if name in MODIFIED_ROLL_ORDERS or name == "ratio_of_roll":
        return SettingStep("1", step)
    if name == "blade_curvature":
        return SettingStep("mm radius", step, reciprocal=True)
    setting, _, order = name.partition("_motion_")
    per_cradle = f"/rad^{order}" if order else ""
    if setting in ANGLES or RESOLUTION_OF.get(setting) == "blade_angle":
        return SettingStep(f"deg{per_cradle}", step, PER_RADIAN)
    return SettingStep(f"mm{per_cradle}", step)


def step_of(name: str, resolution: MachineResolution) -> float | None:
    """Step of a setting of machine or blade [mm or deg]; ``None`` where it has none, as the reliefs of a blade.

    >>> step_of("work_offset_motion_1", MachineResolution()), step_of("toprem_depth", MachineResolution())
    (0.001, None)
    """
    if name in MODIFIED_ROLL_ORDERS:
        return resolution.modified_roll
    if "_motion_" in name:
        return resolution.motion
    return None if (field := RESOLUTION_OF.get(name)) is None else float(getattr(resolution, field))
