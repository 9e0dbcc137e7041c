"""Resolution of machine and cutter settings: the steps to which they are set, and how they are written.

The steps are those of a numerically controlled machine that is set by the digits of a summary sheet; a change of one
moves a flank by a tenth of a micrometre or less. Blades are ground and trued to coarser ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from ...core.checks import number
from .named_settings import MACHINE_STEPS, MODIFIED_ROLL_ORDERS, scale_of

LARGEST_STEP = 10.0  # mm or degrees


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
        steps = round(round(written / self.step) * self.step, 12)
        if self.reciprocal:
            return 1.0 / steps if steps else value
        return steps / self.factor

    def text(self, value: float) -> str:
        """A setting [internal unit] as it is written."""
        written = self.written(value)
        return "straight" if math.isinf(written) else f"{written:.{self.decimals}f}"


ANGLES = frozenset({"cradle_angle", "machine_root_angle", "cutter_tilt", "cutter_swivel"})
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
    if name in MODIFIED_ROLL_ORDERS:
        return SettingStep("1", resolution.modified_roll)
    if name == "ratio_of_roll":
        return SettingStep("1", resolution.roll)
    if name == "point_radius":
        return SettingStep("mm", resolution.blade_radius)
    if name == "blade_curvature":
        return SettingStep("mm radius", resolution.profile_radius, reciprocal=True)
    if name in MACHINE_STEPS:
        is_angle = name in ANGLES
        return SettingStep("deg", resolution.angle, PER_RADIAN) if is_angle else SettingStep("mm", resolution.length)
    if "_motion_" not in name:
        return SettingStep("deg", resolution.blade_angle, PER_RADIAN)
    setting, order = name.rsplit("_motion_", 1)
    unit, factor = ("deg", PER_RADIAN) if setting in ANGLES else ("mm", 1.0)
    return SettingStep(f"{unit}/rad^{order}", resolution.motion, factor)
