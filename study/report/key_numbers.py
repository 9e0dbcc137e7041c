"""Key numbers of a result: what an engineer looks for first, as one labelled dataset."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from ...contact.loaded_cases import CERTIFICATE
from ...contact.solvers import Status
from ...core.attributes import labelled

LOADED = (
    "mean_level",
    "peak_to_peak",
    "rms",
    "harmonic",
    "max_pressure",
)
LOSSES = ("efficiency", "mean_power_loss", "mean_rolling_loss", "mean_friction_coefficient")


def key_numbers(tree: xr.DataTree) -> xr.Dataset:
    """Key numbers of a result, those that ``easeoff show`` prints.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.

    Returns
    -------
    xr.Dataset
        Numbers without a dimension (geometry and unloaded contact), over ``torque`` (loaded contact), and over
        ``torque``, ``speed``, ``temperature`` and ``roughness`` (friction).

    Examples
    --------
    >>> import easeoff
    >>> numbers = key_numbers(easeoff.analyze("nasa-12x36", torques=[100.0]))
    >>> numbers["peak_to_peak"].dims, numbers["peak_to_peak"].attrs["units"]
    (('torque',), 'urad')
    """
    numbers = _unloaded(tree) | _loaded(tree["loaded"].to_dataset())
    if "root_stress" in tree.children:
        numbers["max_root_stress"] = tree["root_stress"]["max_root_stress"]
    if "friction" in tree.children:
        friction = tree["friction"].to_dataset()
        numbers |= {name: friction[name] for name in LOSSES}
    return labelled(xr.Dataset(numbers))


def _unloaded(tree: xr.DataTree) -> dict[str, Any]:
    """Numbers of geometry and unloaded contact."""
    ease_off, unloaded = tree["ease_off"].to_dataset(), tree["unloaded"].to_dataset()
    inside = ease_off["inside"].values == 1
    attributes = unloaded.attrs
    return {
        "common_flank": inside.mean(),
        "max_ease_off": ease_off["ease_off"].values[inside].max(initial=-np.inf),
        "unloaded_peak_to_peak": attributes["peak_to_peak"],
        "unloaded_rms": attributes["rms"],
        "unloaded_harmonic": ("order", np.resize(np.atleast_1d(attributes["harmonics"]), 3)),
    }


def _loaded(loaded: xr.Dataset) -> dict[str, Any]:
    """Numbers of the loaded contact."""
    worst = np.max([loaded[name].transpose("torque", "mesh_position").values for name in CERTIFICATE], axis=(0, 2))
    numbers: dict[str, Any] = {name: loaded[name] for name in LOADED if name in loaded}
    numbers["harmonic"] = numbers["harmonic"].isel(order=slice(3))
    numbers["max_load_share"] = loaded["load_share"].max(("mesh_position", "pair"))
    numbers["certified_positions"] = (loaded["status"] == Status.CERTIFIED).sum("mesh_position")
    numbers["worst_certificate"] = ("torque", worst)
    if "overhang" in loaded and bool(loaded["overhang"].notnull().any()):
        numbers["max_edge_share"] = loaded["edge_share"].max("mesh_position")
    return numbers
