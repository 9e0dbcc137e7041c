"""Resolution of machine and cutter settings: the steps to which they are set, and how they are written.

The steps are those of a numerically controlled machine that is set by the digits of a summary sheet; a change of one
moves a flank by a tenth of a micrometre or less. Blades are ground and trued to coarser ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from .named_settings import MACHINE_STEPS, MODIFIED_ROLL_ORDERS, scale_of


@dataclass(frozen=True)
class Resolution:
    """Resolution of one setting.

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
    >>> Resolution("deg", 0.001, math.degrees(1.0)).text(math.radians(70.0863))
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
        >>> round(Resolution("mm", 0.001).rounded(1.23456), 9)
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


LENGTH = Resolution("mm", 0.001)
ANGLE = Resolution("deg", 0.001, math.degrees(1.0))
#: Resolutions of machine and blade settings; those of the modified roll and of motions: see ``resolution_of``.
RESOLUTIONS = {
    **dict.fromkeys(MACHINE_STEPS, LENGTH),
    **dict.fromkeys(("cradle_angle", "machine_root_angle", "cutter_tilt", "cutter_swivel"), ANGLE),
    "ratio_of_roll": Resolution("1", 1e-6),
    "point_radius": Resolution("mm", 0.01),
    **dict.fromkeys(("pressure_angle", "rake_angle", "hook_angle"), Resolution("deg", 0.01, math.degrees(1.0))),
    "blade_curvature": Resolution("mm radius", 1.0, reciprocal=True),
}
ROLL_COEFFICIENT = Resolution("1", 1e-5)


def resolution_of(name: str) -> Resolution:
    """Resolution of a setting by its name in ``named_settings``. Raises as ``scale_of``.

    Examples
    --------
    >>> resolution_of("machine_root_angle").step, resolution_of("sliding_base_motion_1").unit
    (0.001, 'mm/rad^1')
    """
    scale_of(name)
    if name in RESOLUTIONS:
        return RESOLUTIONS[name]
    if name in MODIFIED_ROLL_ORDERS:
        return ROLL_COEFFICIENT
    setting, order = name.rsplit("_motion_", 1)
    base = RESOLUTIONS[setting]
    return Resolution(f"{base.unit}/rad^{order}", base.step, base.factor)
