"""Key numbers of a result: what an engineer looks for first, as one labelled dataset."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from ...contact.problem.certificate import CERTIFICATE_FIELDS
from ...contact.solvers import Status
from ...core.attributes import labelled

PATTERN = ("pattern_centre_lengthwise", "pattern_centre_profile", "pattern_length", "pattern_height")
UNLOADED = ("contact_ratio", "pinion_peak_to_peak", *PATTERN)
LIGHT_LOAD = ("torque", "contact_ratio", *PATTERN)
LOADED = (
    "mean_level",
    "peak_to_peak",
    "pinion_mean_level",
    "pinion_peak_to_peak",
    "rms",
    "contact_ratio",
    "max_load_share",
    *PATTERN,
    "max_pressure",
    "max_pressure_lengthwise",
    "max_pressure_profile",
    "max_pressure_position",
    "max_pressure_pair",
    "max_pressure_line_end",
    "mean_mesh_stiffness",
)
FRICTION = (
    "efficiency",
    "mean_power_loss",
    "mean_rolling_loss",
    "mean_friction_coefficient",
    "min_film_thickness",
    "min_film_position",
    "min_film_lengthwise",
    "min_film_profile",
)


def key_numbers(tree: xr.DataTree) -> xr.Dataset:
    """Key numbers of a result, those that ``easeoff show`` prints.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``; of an older version of this package those numbers are left out that
        it does not have.

    Returns
    -------
    xr.Dataset
        Numbers without a dimension: of the flanks, of the unloaded contact (``unloaded_...``) and of that at light load
        (``light_load_...``). Over ``torque``: of the loaded contact. Over ``torque``, ``speed``, ``temperature`` and
        ``roughness``: of friction.

    Examples
    --------
    >>> import easeoff
    >>> numbers = key_numbers(easeoff.analyze("nasa-12x36", torques=[100.0]))
    >>> numbers["peak_to_peak"].dims, numbers["peak_to_peak"].attrs["units"]
    (('torque',), 'urad')
    >>> round(float(numbers["unloaded_pattern_length"]), 2)
    0.61
    """
    numbers = _unloaded(tree) | _loaded(tree["loaded"].to_dataset())
    if "light_load" in tree.children:
        light = tree["light_load"].to_dataset().isel(torque=0)
        numbers |= {f"light_load_{name}": light[name].drop_vars("torque") for name in LIGHT_LOAD}
    if "root_stress" in tree.children:
        numbers["max_root_stress"] = tree["root_stress"]["max_root_stress"]
    if "friction" in tree.children:
        friction = tree["friction"].to_dataset()
        numbers |= {name: friction[name] for name in FRICTION if name in friction}
    dataset = xr.Dataset(numbers)
    for variable in dataset.data_vars.values():
        variable.attrs = {key: value for key, value in variable.attrs.items() if key.startswith("flag_")}
    return labelled(dataset)


def number_names(*, friction: bool) -> tuple[str, ...]:
    """Names of the key numbers that vary from result to result, also of those that not every one has.

    Parameters
    ----------
    friction
        Whether the results have friction.

    Examples
    --------
    >>> "efficiency" in number_names(friction=True), "efficiency" in number_names(friction=False)
    (True, False)
    """
    return (
        *("common_flank", "max_ease_off", "unloaded_peak_to_peak", "unloaded_rms", "unloaded_harmonic"),
        *(f"unloaded_{name}" for name in UNLOADED),
        "geometric_contact_ratio",
        *(name for name in LOADED if name != "max_pressure_line_end"),
        *("harmonic", "certified_positions", "worst_certificate", "max_edge_share"),
        *(f"light_load_{name}" for name in LIGHT_LOAD),
        "max_root_stress",
        *(FRICTION if friction else ()),
    )


def _unloaded(tree: xr.DataTree) -> dict[str, Any]:
    """Numbers of geometry and unloaded contact."""
    ease_off, unloaded = tree["ease_off"].to_dataset(), tree["unloaded"].to_dataset()
    inside = ease_off["inside"].values == 1
    attributes = unloaded.attrs
    numbers: dict[str, Any] = {
        "common_flank": inside.mean(),
        "max_ease_off": ease_off["ease_off"].values[inside].max(initial=-np.inf),
        "unloaded_peak_to_peak": attributes["peak_to_peak"],
        "unloaded_rms": attributes["rms"],
        "unloaded_harmonic": ("order", np.atleast_1d(attributes["harmonics"])),
        "marking": attributes["separation"],
    }
    numbers |= {f"unloaded_{name}": unloaded[name] for name in UNLOADED if name in unloaded}
    return numbers | {name: unloaded[name] for name in ("geometric_contact_ratio",) if name in unloaded}


def _loaded(loaded: xr.Dataset) -> dict[str, Any]:
    """Numbers of the loaded contact."""
    worst = np.max(
        [loaded[name].transpose("torque", "mesh_position").values for name in CERTIFICATE_FIELDS], axis=(0, 2)
    )
    numbers: dict[str, Any] = {name: loaded[name] for name in LOADED if name in loaded}
    numbers["harmonic"] = loaded["harmonic"].isel(order=slice(3))
    numbers["certified_positions"] = (loaded["status"].drop_attrs() == Status.CERTIFIED).sum("mesh_position")
    numbers["worst_certificate"] = ("torque", worst)
    if "overhang" in loaded and bool(loaded["overhang"].notnull().any()):
        numbers["max_edge_share"] = loaded["edge_share"].max("mesh_position")
    return numbers
