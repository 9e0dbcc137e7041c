"""Customary methods of cutting a pinion: which settings each uses, and the limits of the machine."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Literal

from ...core.checks import one_of
from ...core.errors import InputError
from ..cutting.named_settings import scale_of

PinionMethod = Literal["closest_fit", "fixed_setting", "modified_roll", "tilt", "completing"]
SetUpMethod = Literal["fixed_setting", "modified_roll", "tilt", "completing"]

BLADE_SETTINGS = ("point_radius", "pressure_angle")
MACHINE_SETTINGS = ("radial_distance", "work_offset", "machine_center_to_crossing_point", "ratio_of_roll")
MODIFIED_ROLL = ("modified_roll_2c", "modified_roll_6d", "modified_roll_24e", "modified_roll_120f")
TILT_SETTINGS = ("sliding_base", "machine_root_angle", "cutter_tilt", "cutter_swivel")
HELICAL_MOTION = "sliding_base_motion_1"
#: Machine settings of a method beside those that all have.
SETTINGS_OF_METHOD: dict[SetUpMethod, tuple[str, ...]] = {
    "fixed_setting": (),
    "modified_roll": MODIFIED_ROLL,
    "tilt": TILT_SETTINGS,
    "completing": (*TILT_SETTINGS, *MODIFIED_ROLL, HELICAL_MOTION),
}
#: What to do where a method misses its target by far.
ADVICE: dict[PinionMethod, str] = {
    "closest_fit": "free other settings of the pinion (free_settings)",
    "fixed_setting": 'take method = "modified_roll" or "tilt"',
    "modified_roll": 'widen the limits of the modified roll, take method = "tilt"',
    "tilt": 'widen the limits in [pinion.limits], take method = "modified_roll"',
    "completing": 'widen the limits in [pinion.limits], cut each flank by its own set-up (method = "tilt")',
}
AT_LIMIT = 1e-3  # of its usual step: a setting nearer to a limit stands at it
SLIDING_BASE_SHARE = 0.5  # of the cutter radius: limit of sliding base and helical motion where none is given


@dataclass(frozen=True)
class SettingLimits:
    """Limits of the settings of a pinion [mm, rad]; a limit of zero takes the setting out of use."""

    cutter_tilt: float = math.radians(30.0)
    cutter_swivel: float = math.pi
    machine_root_angle: float = math.radians(30.0)  # [rad] off the blank's root angle; none without tilt
    sliding_base: float | None = None  # [mm], half the cutter radius if None; without tilt it follows
    modified_roll_2c: float = 0.5
    modified_roll_6d: float = 1.0
    modified_roll_24e: float = 0.0
    modified_roll_120f: float = 0.0
    helical_motion: float | None = None  # [mm/rad], of the sliding base; half the cutter radius if None
    blade_point_radius: float = 0.2  # off the mean cutter radius, as a share of it
    blade_pressure_angle: tuple[float, float] = (math.radians(5.0), math.radians(40.0))

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not None and not all(v >= 0.0 for v in (value if isinstance(value, tuple) else (value,))):
                raise InputError(f"limit of {field.name} = {value}: must be zero or more")
        low, high = self.blade_pressure_angle
        if not low < high:
            raise InputError(f"limit of blade_pressure_angle = {(low, high)}: the first must be below the second")

    def allowed(self, name: str, root_angle: float, cutter_radius: float) -> tuple[float, float]:
        """Least and largest value of a setting by name [mm, rad or per rad]; infinite where there is no limit."""
        if name == "pressure_angle":
            return self.blade_pressure_angle
        if name in ("radial_distance", "ratio_of_roll"):
            return 0.0, math.inf
        reach = self.largest(name, cutter_radius)
        if name == "point_radius":
            return (1.0 - self.blade_point_radius) * cutter_radius, (1.0 + self.blade_point_radius) * cutter_radius
        if name == "machine_root_angle":
            return root_angle - reach, root_angle + reach
        if name == "cutter_tilt" and self.cutter_swivel < math.pi:
            return 0.0, reach
        return -reach, reach

    def largest(self, name: str, cutter_radius: float) -> float:
        """Largest size of a free setting, or of its change; infinite where there is no limit."""
        key = {HELICAL_MOTION: "helical_motion"}.get(name, name)
        if key in ("sliding_base", "helical_motion") and getattr(self, key) is None:
            return SLIDING_BASE_SHARE * cutter_radius
        return float(getattr(self, key, math.inf))


def shared_settings(method: SetUpMethod, limits: SettingLimits, cutter_radius: float) -> tuple[str, ...]:
    """Machine settings that a method may move, without those whose limit is zero."""
    one_of("method", method, tuple(SETTINGS_OF_METHOD))
    names = [*MACHINE_SETTINGS, *SETTINGS_OF_METHOD[method]]
    unused = {name for name in names if limits.largest(name, cutter_radius) == 0.0}
    if "cutter_tilt" in unused:
        unused.add("cutter_swivel")
    return tuple(name for name in names if name not in unused)


def at_limit(values: Mapping[str, float], limits: SettingLimits, root_angle: float, radius: float) -> tuple[str, ...]:
    """Names of the fitted settings [mm, rad or per rad] that stand at a limit; the radius is the cutter's [mm]."""
    names = []
    for name, value in values.items():
        low, high = limits.allowed(name, root_angle, radius)
        if min(value - low, high - value) < AT_LIMIT * scale_of(name):
            names.append(name)
    return tuple(names)
