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
    """Limits of the settings of a pinion; a limit of zero takes the setting out of use.

    Parameters
    ----------
    cutter_tilt
        Largest tilt of the cutter axis [rad].
    cutter_swivel
        Largest swivel to either side [rad].
    machine_root_angle
        Largest difference of machine root angle and root angle of the blank where the cutter is tilted [rad]; without
        tilt there is none.
    sliding_base
        Largest sliding base [mm]; half the cutter radius where ``None``. Without tilt it follows from the machine
        centre.
    modified_roll_2c, modified_roll_6d, modified_roll_24e, modified_roll_120f
        Largest coefficients of the modified roll.
    helical_motion
        Largest first derivative of the sliding base by the cradle rotation [mm/rad]; half the cutter radius where
        ``None``.
    blade_point_radius
        Largest difference of the radius of the blade tip and the mean cutter radius, as a share of it.
    blade_pressure_angle
        Smallest and largest blade angle [rad].

    Raises
    ------
    InputError
        If a limit is negative.

    Examples
    --------
    >>> SettingLimits(cutter_tilt=0.3).allowed("cutter_tilt", root_angle=0.27, cutter_radius=95.0)
    (-0.3, 0.3)
    >>> SettingLimits().allowed("sliding_base", root_angle=0.27, cutter_radius=80.0)
    (-40.0, 40.0)
    """

    cutter_tilt: float = math.radians(30.0)
    cutter_swivel: float = math.pi
    machine_root_angle: float = math.radians(30.0)
    sliding_base: float | None = None
    modified_roll_2c: float = 0.5
    modified_roll_6d: float = 1.0
    modified_roll_24e: float = 0.0
    modified_roll_120f: float = 0.0
    helical_motion: float | None = None
    blade_point_radius: float = 0.2
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
        """Least and largest value of a free setting; infinite where there is no limit.

        Parameters
        ----------
        name
            Of the setting, see ``named_settings``.
        root_angle
            Of the pinion's blank [rad].
        cutter_radius
            Mean radius of the cutter [mm].
        """
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
        own = {HELICAL_MOTION: "helical_motion"}.get(name, name)
        if own in ("sliding_base", "helical_motion") and getattr(self, own) is None:
            return SLIDING_BASE_SHARE * cutter_radius
        return float(getattr(self, own, math.inf))


def shared_settings(method: SetUpMethod, limits: SettingLimits, cutter_radius: float) -> tuple[str, ...]:
    """Machine settings that a method may move, without those whose limit is zero.

    Examples
    --------
    >>> shared_settings("modified_roll", SettingLimits(modified_roll_6d=0.0), 95.0)[-2:]
    ('ratio_of_roll', 'modified_roll_2c')
    """
    one_of("method", method, tuple(SETTINGS_OF_METHOD))
    names = [*MACHINE_SETTINGS, *SETTINGS_OF_METHOD[method]]
    unused = {name for name in names if limits.largest(name, cutter_radius) == 0.0}
    if "cutter_tilt" in unused:
        unused.add("cutter_swivel")
    return tuple(name for name in names if name not in unused)


def at_limit(
    values: Mapping[str, float], limits: SettingLimits, root_angle: float, cutter_radius: float
) -> tuple[str, ...]:
    """Names of the fitted settings that stand at a limit.

    Parameters
    ----------
    values
        Fitted settings by name [mm, rad or per rad].
    limits
        Their limits.
    root_angle
        Of the pinion's blank [rad].
    cutter_radius
        Mean radius of the cutter [mm].

    Examples
    --------
    >>> at_limit({"modified_roll_2c": -0.5, "work_offset": 3.0}, SettingLimits(), 0.27, 95.0)
    ('modified_roll_2c',)
    """
    found = []
    for name, value in values.items():
        low, high = limits.allowed(name, root_angle, cutter_radius)
        if min(value - low, high - value) < AT_LIMIT * scale_of(name):
            found.append(name)
    return tuple(found)
