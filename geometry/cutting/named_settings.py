"""Settings of a generating surface by name, so that a fit can move them: blade, machine, modified roll and motions.

A name is that of a field of ``Blade`` or ``MachineSettings``; ``blade_curvature`` is one over the radius of a circular
profile (``spheric_radius``), zero for a straight one; ``modified_roll_2c`` to ``modified_roll_720g`` are the
derivatives of the work rotation, and ``sliding_base_motion_1``, ``sliding_base_motion_2``, ... those of a setting by
the cradle increment, as in case files (there degrees, here radians).

Of a set-up those may be moved that its machine and its blade have, in steps to which they are set. The steps are those
of a numerically controlled machine that is set by the digits of a summary sheet; a change of one moves a flank by a
tenth of a micrometre or less. Blades are ground and trued to coarser ones.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

from ...core.checks import instance, number, words
from ...core.errors import InputError, suggestion
from .generating_surface import GeneratingSurface
from .machine import MOVING_SETTINGS

# Usual steps of the settings, which change the flank by about as much each: mm, rad, or per radian.
BLADE_STEPS = {"point_radius": 1.0, "pressure_angle": 0.01, "rake_angle": 0.05, "hook_angle": 0.05}
MACHINE_STEPS = {
    "radial_distance": 1.0,
    "cradle_angle": 0.01,
    "machine_root_angle": 0.01,
    "work_offset": 1.0,
    "sliding_base": 1.0,
    "machine_center_to_crossing_point": 1.0,
    "cutter_tilt": 0.01,
    "cutter_swivel": 0.02,
    "ratio_of_roll": 0.02,
}
MODIFIED_ROLL_ORDERS = {f"modified_roll_{key}": n for n, key in enumerate(("2c", "6d", "24e", "120f", "720g"), start=2)}
MOTION_PATTERN = re.compile(rf"({'|'.join(MOVING_SETTINGS)})_motion_([1-6])")
CURVATURE_STEPS = {"blade_curvature": 1e-3}
CRADLE_INCREMENT_SCALE = 0.3  # cradle increment at which a motion changes the flank as much as the setting itself [rad]


def scale_of(name: str) -> float:
    """Usual step of a setting, which changes the flank about as much as that of any other [mm, rad or per rad]."""
    plain = {**BLADE_STEPS, **CURVATURE_STEPS, **MACHINE_STEPS}
    if name in plain:
        return plain[name]
    if name in MODIFIED_ROLL_ORDERS:
        return float(0.02 * 10.0 ** (MODIFIED_ROLL_ORDERS[name] - 2))
    motion = MOTION_PATTERN.fullmatch(name)
    if motion is None:
        raise InputError(
            f"free setting = {name!r}: must be one of {', '.join([*plain, *MODIFIED_ROLL_ORDERS])}, or the name of a "
            f"moving setting ({', '.join(MOVING_SETTINGS)}) with _motion_1 to _motion_6"
        )
    order = int(motion[2])
    return MACHINE_STEPS[motion[1]] * math.factorial(order) / CRADLE_INCREMENT_SCALE**order


def get_setting(surface: GeneratingSurface, name: str) -> float:
    """One setting of a generating surface by name [mm, rad or per rad]."""
    scale_of(name)
    if name in BLADE_STEPS:
        return float(getattr(surface.blade, name))
    if name in CURVATURE_STEPS:
        radius = surface.blade.spheric_radius
        return 0.0 if radius is None else 1.0 / radius
    if name in MACHINE_STEPS:
        return float(getattr(surface.settings, name))
    if name in MODIFIED_ROLL_ORDERS:
        return _derivative(surface.settings.modified_roll, MODIFIED_ROLL_ORDERS[name], 2)
    base, order = name.rsplit("_motion_", 1)
    return _derivative(dict(surface.settings.motions).get(base, ()), int(order), 1)


def with_settings(surface: GeneratingSurface, values: Mapping[str, float]) -> GeneratingSurface:
    """Generating surface with some settings changed by name [mm, rad or per rad]."""
    blade: dict[str, Any] = {}
    machine: dict[str, Any] = {}
    roll, motions = surface.settings.modified_roll, dict(surface.settings.motions)
    for name, value in values.items():
        scale_of(name)
        if name in BLADE_STEPS:
            blade[name] = value
        elif name in CURVATURE_STEPS:
            blade["spheric_radius"] = 1.0 / value if value else None
        elif name in MACHINE_STEPS:
            machine[name] = value
        elif name in MODIFIED_ROLL_ORDERS:
            roll = _with_derivative(roll, MODIFIED_ROLL_ORDERS[name], 2, value)
        else:
            base, order = name.rsplit("_motion_", 1)
            motions[base] = _with_derivative(motions.get(base, ()), int(order), 1, value)
    settings = replace(surface.settings, **machine, modified_roll=roll, motions=tuple(motions.items()))
    return replace(surface, blade=replace(surface.blade, **blade), settings=settings)


def _derivative(coefficients: tuple[float, ...], order: int, first: int) -> float:
    """Derivative of a polynomial whose coefficients begin with the order ``first``."""
    return coefficients[order - first] * math.factorial(order) if order - first < len(coefficients) else 0.0


def _with_derivative(coefficients: tuple[float, ...], order: int, first: int, value: float) -> tuple[float, ...]:
    result = [*coefficients, *[0.0] * (order - first + 1 - len(coefficients))]
    result[order - first] = value / math.factorial(order)
    return tuple(result)


# Formate: no roll. The flank has four degrees of freedom; the fifth setting holds the root.
FREE_FORMATE_SETTINGS = (
    "radial_distance",
    "cradle_angle",
    "machine_root_angle",
    "sliding_base",
    "machine_center_to_crossing_point",
)
# Generated: the basic cradle angle turns the tooth. Tilt, swivel and modified roll only where the design has them.
FREE_MACHINE_SETTINGS = (*MOVING_SETTINGS, "ratio_of_roll", "modified_roll_2c", "modified_roll_6d")
BLADE_SETTINGS = (*BLADE_STEPS, *CURVATURE_STEPS)
TILTS = ("cutter_tilt", "cutter_swivel")


def usual_settings(surface: GeneratingSurface) -> tuple[str, ...]:
    """Settings that corrections move unless others are named: those of the machine, no blades.

    Coefficients of the modified roll that are zero in the design stay zero.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> usual_settings(gear_pair(read_case("fm-11x41")).gear.loaded)[:3]
    ('radial_distance', 'cradle_angle', 'machine_root_angle')
    """
    instance("surface", surface, GeneratingSurface)
    if not surface.settings.generated:
        return FREE_FORMATE_SETTINGS
    unused = [name for name in MODIFIED_ROLL_ORDERS if get_setting(surface, name) == 0.0]
    return tuple(name for name in FREE_MACHINE_SETTINGS if name in movable_settings(surface) and name not in unused)


def movable_settings(surface: GeneratingSurface) -> tuple[str, ...]:
    """Settings of a surface that can be moved, but for its higher-order motions; a Formate flank has no roll."""
    held = _held(surface)
    return tuple(name for name in (*BLADE_SETTINGS, *MACHINE_STEPS, *MODIFIED_ROLL_ORDERS) if name not in held)


def free_settings(surface: GeneratingSurface, given: Sequence[str] | None) -> tuple[str, ...]:
    """Settings to move, the usual ones if none are given; refused if the machine has none such, or if named twice."""
    names = words("free", given) if given is not None else usual_settings(surface)
    allowed, rolled = movable_settings(surface), surface.settings.generated
    motions = f", or a motion: {', '.join(MOVING_SETTINGS)} with _motion_1 to _motion_6" if rolled else ""
    if not names:
        raise InputError(f"free settings: must name one at least of {', '.join(allowed)}{motions}")
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"free setting = {name!r}: must be named once")
        if name not in allowed and not (rolled and MOTION_PATTERN.fullmatch(name)):
            why = NO_ROLL if MOTION_PATTERN.fullmatch(name) else _held(surface).get(name, suggestion(name, allowed))
            raise InputError(f"free setting = {name!r}: must be one of {', '.join(allowed)}{motions}{why}")
    return names


NO_ROLL = "; this member is Formate and has no roll"


def _held(surface: GeneratingSurface) -> dict[str, str]:
    """Settings that exist elsewhere and cannot be moved here, and why."""
    settings = surface.settings
    blade = ("rake_angle", "hook_angle") if settings.indexing_ratio == 0.0 else ()
    return {
        **dict.fromkeys(blade, "; a face-milling blade sweeps a surface of revolution"),
        **dict.fromkeys(TILTS if settings.cutter_tilt == 0.0 else (), "; the cutter of this machine is not tilted"),
        **dict.fromkeys(() if settings.generated else ("ratio_of_roll", *MODIFIED_ROLL_ORDERS), NO_ROLL),
    }


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
    """Unit and smallest step of one setting."""

    unit: str
    step: float
    factor: float = 1.0  # units per mm, rad or per radian
    reciprocal: bool = False  # one over it is set and written, as a profile's radius

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
        """Nearest value that can be set [mm, rad or per rad]."""
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
    """Nearest multiple of a step between bounds, without the noise of the product; the value where none is."""
    count = step_count(value, step, low, high)
    return value if count is None else round(count * step, 12) + 0.0


def step_count(value: float, step: float, low: float = -math.inf, high: float = math.inf) -> int | None:
    """Number of steps nearest to a value between bounds; ``None`` where no multiple of the step is."""
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
    """Unit and step of a setting by its name in ``named_settings``."""
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
    """Step of a setting of machine or blade [mm or deg]; ``None`` where it has none, as the reliefs of a blade."""
    if name in MODIFIED_ROLL_ORDERS:
        return resolution.modified_roll
    if "_motion_" in name:
        return resolution.motion
    return None if (field := RESOLUTION_OF.get(name)) is None else float(getattr(resolution, field))
