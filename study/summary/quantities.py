"""Operating conditions and reported numbers: label, unit, format and factor of each, from ``quantities.toml``."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from importlib import resources
from typing import Any

import xarray as xr

NO_VALUE = "–"
#: What ``quantities.toml`` holds, by the names of its tables.
TABLES: dict[str, dict[str, Any]] = tomllib.loads(
    resources.files(__package__).joinpath("quantities.toml").read_text(encoding="utf-8")
)
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


def _quantities(table: str) -> dict[str, Quantity]:
    """Numbers of a table by their variables."""
    return {name: Quantity(*row) for name, row in TABLES[table].items()}


#: Numbers over torque, without load by their names in ``key_numbers``, and over the operating conditions.
LOADED, _UNLOADED, BACKLASH, FRICTION = map(_quantities, ("loaded", "unloaded", "backlash", "friction"))
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
    name: (_UNLOADED.get(name) or LOADED[name.removeprefix("unloaded_")], source)
    for name, source in TABLES["unloaded_sources"].items()
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
