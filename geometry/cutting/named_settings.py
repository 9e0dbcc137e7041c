"""Settings of a generating surface by name, so that a fit can move them: blade, machine, modified roll and motions.

A name is that of a field of ``Blade`` or ``MachineSettings``; ``blade_curvature`` is one over the radius of a circular
profile (``spheric_radius``), zero for a straight one; ``modified_roll_2c`` to ``modified_roll_720g`` are the
derivatives of the work rotation, and ``sliding_base_motion_1``, ``sliding_base_motion_2``, ... those of a setting by
the cradle increment, as in case files (there degrees, here radians).
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ...core.errors import InputError
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
    """Usual step of a setting, which changes the flank about as much as those of the others [mm, rad or per radian].

    Raises
    ------
    InputError
        If there is no setting of that name.
    """
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
    """One setting of a generating surface by name. Raises as ``scale_of``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> round(get_setting(pair.pinion.loaded, "radial_distance"), 3)
    74.874
    """
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
    """The same surface with some settings changed by name. Raises as ``scale_of``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> moved = with_settings(pair.pinion.loaded, {"radial_distance": 60.0})
    >>> get_setting(moved, "radial_distance")
    60.0
    """
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
    index = order - first
    return coefficients[index] * math.factorial(order) if index < len(coefficients) else 0.0


def _with_derivative(coefficients: tuple[float, ...], order: int, first: int, value: float) -> tuple[float, ...]:
    result = [*coefficients, *[0.0] * (order - first + 1 - len(coefficients))]
    result[order - first] = value / math.factorial(order)
    return tuple(result)
