"""Operating conditions and reported numbers: label, unit, format and factor of each in one place."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .table import NO_VALUE

_CONDITIONS = {
    "speed": ("speed of the pinion", "1/min"),
    "torque": ("torque at the pinion", "N m"),
    "temperature": ("oil temperature", "°C"),
    "roughness": ("RMS roughness", "µm"),
}
#: Operating conditions of friction: labels of axes, and units.
CONDITION_LABELS = {name: f"{label} [{unit}]" for name, (label, unit) in _CONDITIONS.items()}
CONDITION_UNITS = {name: unit for name, (_, unit) in _CONDITIONS.items()}


@dataclass(frozen=True)
class Quantity:
    """A number of a result as people read it."""

    label: str
    unit: str
    form: str
    factor: float = 1.0  # of what is read over what is stored

    @property
    def head(self) -> str:
        """Label with the unit, of a column or an axis."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    def written(self, value: float) -> str:
        """A stored value as it is read; a dash if there is none."""
        return written(self.factor * value, self.form)


def written(value: float, form: str) -> str:
    """Number in a format; a dash if there is none."""
    return format(value, form) if math.isfinite(value) else NO_VALUE


#: Numbers over torque, by their variables in ``loaded``.
LOADED = {
    "mean_level": Quantity("transmission error of the gear, mean", "µrad", ".1f"),
    "peak_to_peak": Quantity("transmission error of the gear, peak to peak", "µrad", ".2f"),
    "pinion_mean_level": Quantity("transmission error of the pinion, mean", "µrad", ".1f"),
    "pinion_peak_to_peak": Quantity("transmission error of the pinion, peak to peak", "µrad", ".2f"),
    "mean_mesh_stiffness": Quantity("mesh stiffness, mean", "N m/µrad", ".3f"),
    "contact_ratio": Quantity("contact ratio under load", "", ".2f"),
    "max_load_share": Quantity("greatest share of a tooth pair", "%", ".1f", 100.0),
    "pattern_centre_lengthwise": Quantity("pattern, centre from the toe", "%", ".0f", 100.0),
    "pattern_centre_profile": Quantity("pattern, centre from the root", "%", ".0f", 100.0),
    "pattern_length": Quantity("pattern, length", "%", ".0f", 100.0),
    "pattern_height": Quantity("pattern, height", "%", ".0f", 100.0),
    "max_pressure": Quantity("greatest pressure", "MPa", ".0f"),
    "max_pressure_lengthwise": Quantity("greatest pressure, from the toe", "%", ".0f", 100.0),
    "max_pressure_profile": Quantity("greatest pressure, from the root", "%", ".0f", 100.0),
    "max_pressure_position": Quantity("greatest pressure, mesh position", "", ".2f"),
}
#: Numbers without load, by their names in ``key_numbers``, with the variables or attributes that they are.
UNLOADED = {
    "common_flank": (Quantity("common flank, part of the gear flank", "%", ".0f", 100.0), "ease_off/inside"),
    "max_ease_off": (Quantity("greatest ease-off", "µm", ".1f"), "ease_off/ease_off"),
    "unloaded_peak_to_peak": (Quantity("transmission error, peak to peak", "µrad", ".2f"), "unloaded.peak_to_peak"),
    "unloaded_pinion_peak_to_peak": (LOADED["pinion_peak_to_peak"], "unloaded/pinion_peak_to_peak"),
    "unloaded_contact_ratio": (Quantity("contact ratio", "", ".2f"), "unloaded/contact_ratio"),
    "geometric_contact_ratio": (
        Quantity("geometric contact ratio, of contact lines alone (edges count under load, too)", "", ".2f"),
        "unloaded/geometric_contact_ratio",
    ),
    "unloaded_pattern_length": (Quantity("marking print, length", "%", ".0f", 100.0), "unloaded/pattern_length"),
    "unloaded_pattern_height": (Quantity("marking print, height", "%", ".0f", 100.0), "unloaded/pattern_height"),
}
#: Numbers over the operating conditions, by their variables in ``friction``.
FRICTION = {
    "mean_friction_coefficient": Quantity("mean friction coefficient", "", ".4f"),
    "friction_coefficient": Quantity("greatest friction coefficient", "", ".4f"),
    "sliding_velocity": Quantity("greatest sliding", "m/s", ".2f"),
    "max_pressure_velocity": Quantity("greatest pressure × sliding", "MPa m/s", ".0f"),
    "max_flash_temperature": Quantity("greatest flash temperature", "K", ".1f"),
    "max_contact_temperature": Quantity("greatest contact temperature", "°C", ".1f"),
    "min_film_thickness": Quantity("least film", "µm", ".3f"),
    "mean_power_loss": Quantity("power loss", "W", ".1f"),
    "mean_rolling_loss": Quantity("of it rolling", "W", ".1f"),
    "efficiency": Quantity("efficiency", "%", ".2f", 100.0),
}
#: Titles of panels that show numbers of sweeps, wear and optimizations.
TITLES = {
    "peak_to_peak": UNLOADED["unloaded_peak_to_peak"][0].head,
    "max_pressure": LOADED["max_pressure"].head,
    "contact_ratio": LOADED["contact_ratio"].head,
    "pattern_centre_lengthwise": "centre of the pattern, toe 0 to heel 1",
    "max_root_stress": "greatest root stress [MPa]",
    "efficiency": "efficiency",
    "largest_depth": "largest wear depth [µm]",
    "max_line_load": "greatest line load [N/mm]",
    "max_end_load": "greatest line load at the edges [N/mm]",
}
