"""Operating conditions and reported numbers: label, unit, format and factor of each in one place."""

from __future__ import annotations

import math
from dataclasses import dataclass

import xarray as xr

NO_VALUE = "–"
#: Units of results as pictures show them.
UNIT_SIGNS = {"urad": "µrad", "um": "µm", "degree": "°", "degC": "°C", "rpm": "1/min", "1": ""}

_CONDITIONS = {
    "speed": ("speed of the pinion", "1/min"),
    "torque": ("torque at the pinion", "N m"),
    "temperature": ("oil temperature", "°C"),
    "roughness": ("RMS roughness", "µm"),
}
#: Operating conditions of friction: labels of axes, and units.
CONDITION_LABELS = {name: f"{label} [{unit}]" for name, (label, unit) in _CONDITIONS.items()}
CONDITION_UNITS = {name: unit for name, (_, unit) in _CONDITIONS.items()}
MEAN_ROUGHNESS = "quadratic mean of both flanks' RMS roughnesses [µm]"  # where they differ


@dataclass(frozen=True)
class Quantity:
    """A number of a result as people read it."""

    label: str
    unit: str
    form: str
    factor: float = 1.0  # of what is read over what is stored
    column: str = ""  # head of a narrow column in a terminal, with the unit; that of a wide one if left out

    @property
    def head(self) -> str:
        """Label with the unit, of a column or an axis."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    def written(self, value: float, *, rough: bool = False) -> str:
        """A stored value as it is read; a dash if there is none, and a digit less if it is ``rough``."""
        form = f".{int(self.form[1]) - 1}f" if rough else self.form
        return written(self.factor * value, form)


def harmonic(order: float) -> Quantity:
    """Amplitude of the transmission error at a multiple of the mesh frequency."""
    return Quantity(f"transmission error, order {order:g}", "µrad", ".2f")


def written(value: float, form: str) -> str:
    """Number in a format; a dash if there is none."""
    return format(value, form) if math.isfinite(value) else NO_VALUE


def with_percent(dataset: xr.Dataset) -> xr.Dataset:
    """A dataset with places and sizes of patterns in percent, as people read them."""
    names = [name for name in dataset.data_vars if name in LOADED and str(name).startswith("pattern_")]
    return dataset.assign(
        {name: (100.0 * dataset[name]).assign_attrs(dataset[name].attrs, units="%") for name in names}
    )


def roughness_words(friction: xr.Dataset | xr.DataArray, index: int) -> str:
    """RMS roughness [um] of a number, of both flanks if they differ: pinion/gear."""
    pinion, gear = (f"{friction[f'roughness_{member}'].values[index]:.4g}" for member in ("pinion", "gear"))
    return pinion if pinion == gear else f"{pinion}/{gear}"


def value_name(friction: xr.Dataset | xr.DataArray, condition: str, index: int) -> str:
    """Value of an operating condition with its unit."""
    rough = condition == "roughness"
    value = roughness_words(friction, index) if rough else f"{float(friction[condition].values[index]):.4g}"
    return f"{value} {CONDITION_UNITS[condition]}"


#: Numbers over torque, by their variables in ``loaded``.
LOADED = {
    "mean_level": Quantity("transmission error, mean", "µrad", ".1f"),
    "peak_to_peak": Quantity("transmission error, peak to peak", "µrad", ".2f", column="peak to\npeak urad"),
    "pinion_mean_level": Quantity("transmission error of the pinion, mean", "µrad", ".1f"),
    "pinion_peak_to_peak": Quantity("transmission error of the pinion, peak to peak", "µrad", ".2f"),
    "mean_mesh_stiffness": Quantity("mesh stiffness, mean", "N m/µrad", ".3f"),
    "contact_ratio": Quantity("contact ratio under load", "", ".2f", column="contact\nratio"),
    "max_load_share": Quantity("greatest share of a tooth pair", "%", ".1f", 100.0),
    "pattern_centre_lengthwise": Quantity("pattern, centre from the toe", "%", ".0f", 100.0, "pattern at\ntoe %"),
    "pattern_centre_profile": Quantity("pattern, centre from the root", "%", ".0f", 100.0),
    "pattern_length": Quantity("pattern, length", "%", ".0f", 100.0, "length\n%"),
    "pattern_height": Quantity("pattern, height", "%", ".0f", 100.0),
    "max_pressure": Quantity("greatest pressure", "MPa", ".0f", column="pressure\nMPa"),
    "max_pressure_lengthwise": Quantity("greatest pressure, from the toe", "%", ".0f", 100.0),
    "max_pressure_profile": Quantity("greatest pressure, from the root", "%", ".0f", 100.0),
    "max_pressure_position": Quantity("greatest pressure, mesh position", "", ".2f"),
}
GEAR_TORQUE = Quantity("torque of the gear, without losses", "N m", ".4g")
PINION_POWER = Quantity("power of the pinion", "kW", ".4g", 1e-3)
#: Lengths at the mean pitch radius and along the common normal: of an angle [urad] times a radius or an arm [mm].
ERROR_AT_RADIUS = Quantity("transmission error at the mean pitch radius, peak to peak", "µm", ".3f", 1e-3)
ERROR_ALONG_NORMAL = Quantity("transmission error along the normal, peak to peak", "µm", ".3f", 1e-3)
#: N m/urad is 1e9 N mm/rad; over an arm and a face width, in mm^2 and mm, that is N/mm^2, a thousandth of it N/(um mm).
STIFFNESS_BY_WIDTH = Quantity("mesh stiffness along the normal by face width", "N/(µm mm)", ".2f", 1e6)
EDGE_SHARE = Quantity("greatest share on tooth edges", "%", ".1f", 100.0)
#: Numbers of the summary, by their names in ``key_numbers``.
LOADED_ROWS = LOADED | {"max_edge_share": EDGE_SHARE, "max_pressure_pair": Quantity("tooth pair", "", ".0f")}
ROOT_STRESS = Quantity("greatest root stress", "MPa", ".0f", column="root stress\nMPa")
#: Numbers without load, by their names in ``key_numbers``, with the variables or attributes that they are.
UNLOADED = {
    "common_flank": (Quantity("common flank, part of the gear flank", "%", ".0f", 100.0), "ease_off/inside"),
    "max_ease_off": (Quantity("greatest ease-off", "µm", ".1f"), "ease_off/ease_off"),
    "unloaded_peak_to_peak": (LOADED["peak_to_peak"], "unloaded.peak_to_peak"),
    "unloaded_pinion_peak_to_peak": (LOADED["pinion_peak_to_peak"], "unloaded/pinion_peak_to_peak"),
    "unloaded_contact_ratio": (Quantity("contact ratio", "", ".2f"), "unloaded/contact_ratio"),
    "geometric_contact_ratio": (
        Quantity("geometric contact ratio, of contact lines alone (edges count under load, too)", "", ".2f"),
        "unloaded/geometric_contact_ratio",
    ),
    "unloaded_pattern_length": (Quantity("marking print, length", "%", ".0f", 100.0), "unloaded/pattern_length"),
    "unloaded_pattern_height": (Quantity("marking print, height", "%", ".0f", 100.0), "unloaded/pattern_height"),
}
BACKLASH = {
    "least_backlash": Quantity("least normal backlash at the heel", "mm", ".3f"),
    "greatest_backlash": Quantity("greatest normal backlash at the heel", "mm", ".3f"),
}
#: Numbers over the operating conditions, by their variables in ``friction``.
FRICTION = {
    "mean_friction_coefficient": Quantity("mean friction coefficient", "", ".4f", column="mean\nmu"),
    "friction_coefficient": Quantity("greatest friction coefficient", "", ".4f"),
    "sliding_velocity": Quantity("greatest sliding", "m/s", ".2f"),
    "max_pressure_velocity": Quantity("greatest pressure × sliding", "MPa m/s", ".0f", column="greatest p v\nMPa m/s"),
    "max_flash_temperature": Quantity("greatest flash temperature", "K", ".1f", column="flash\nK"),
    "max_contact_temperature": Quantity("greatest contact temperature", "°C", ".1f", column="contact\ndegC"),
    "min_film_thickness": Quantity("least film", "µm", ".3f", column="least\nfilm um"),
    "mean_power_loss": Quantity("power loss", "W", ".1f", column="power\nloss W"),
    "mean_rolling_loss": Quantity("of it rolling", "W", ".1f"),
    "efficiency": Quantity("efficiency", "%", ".2f", 100.0, "efficiency\n%"),
}
#: Numbers that a report compares with limits, by their names in ``key_numbers``.
LIMITED = (
    LOADED_ROWS
    | {"max_root_stress": ROOT_STRESS}
    | {name: one for name, (one, _) in UNLOADED.items()}
    | BACKLASH
    | FRICTION
)
ROLLING_SHARE = Quantity("rolling part of the power loss", "%", ".1f", 100.0, "rolling\npart %")
#: Numbers of an optimization, by their variables.
OPTIMIZED = {
    "max_line_load": Quantity("greatest line load", "N/mm", ".0f"),
    "max_pressure": LOADED["max_pressure"],
    "max_end_load": Quantity("greatest line load at the edges", "N/mm", ".0f"),
    "peak_to_peak": Quantity("transmission error, peak to peak", "µrad", ".1f"),
}
WEAR_DEPTH = Quantity("greatest wear depth", "µm", ".2f")
#: Titles of panels that show numbers of sweeps, wear and optimizations.
TITLES = {
    **{name: quantity.head for name, quantity in OPTIMIZED.items()},
    "contact_ratio": LOADED["contact_ratio"].head,
    "pattern_centre_lengthwise": "centre of the pattern from the toe [%]",
    "max_root_stress": ROOT_STRESS.head,
    "efficiency": "efficiency",
    "largest_depth": WEAR_DEPTH.head,
}
