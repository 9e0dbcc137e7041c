"""Key numbers of a result: what an engineer looks for first, as one labelled dataset.

From the attributes of the root come two texts: departures of the flanks from the designed ones, and the elastic model.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from ...contact.evaluation.flank_region import flank_share
from ...contact.outcomes import CERTIFICATE_FIELDS, Status
from ...core.attributes import labelled, ordered
from ...core.checks import instance
from ...core.errors import InputError
from ...geometry.pair.member_names import MEMBERS
from ..result import CONDITIONS, GRID, KEY_NUMBERS, PATTERN

HARMONIC_COUNT = 3  # of the transmission error
UNLOADED = ("contact_ratio", "pinion_peak_to_peak", *PATTERN)
LIGHT_LOAD = ("torque", "contact_ratio", *PATTERN)
#: Numbers over the torque, of the group ``loaded``; and over the operating conditions, of ``friction``.
LOADED, FRICTION = KEY_NUMBERS["torque",], KEY_NUMBERS[CONDITIONS]


def key_numbers(result: xr.DataTree | Mapping[str, xr.Dataset]) -> xr.Dataset:
    """Key numbers of a result, those that ``easeoff show`` prints.

    Parameters
    ----------
    result
        A result of ``analyze`` or ``read_result``, or its groups by name; of an older version of this package those
        numbers are left out that it does not have.

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
    groups: Mapping[str, xr.Dataset]
    if isinstance(result, xr.DataTree):
        groups = {name: child.to_dataset() for name, child in result.children.items()}
    else:
        groups = result
    instance("result", groups, Mapping)
    if not {"ease_off", "loaded", "unloaded"} <= set(groups):
        raise InputError("result: must be of analyze or read_result, or its groups by name")
    loaded, unloaded = groups["loaded"], groups["unloaded"]
    numbers = _unloaded(groups["ease_off"], unloaded) | _loaded(loaded)
    sources = [unloaded, loaded]
    if "light_load" in groups:
        light = groups["light_load"].variables
        numbers |= {f"light_load_{name}": light[name].to_base_variable().isel(torque=0) for name in LIGHT_LOAD}
    if "backlash" in groups:
        play = groups["backlash"].variables["outer_normal_backlash"].values
        numbers |= {"least_backlash": xr.Variable((), play.min()), "greatest_backlash": xr.Variable((), play.max())}
    if "root_stress" in groups:
        numbers["max_root_stress"] = groups["root_stress"].variables["max_root_stress"]
        sources.append(groups["root_stress"])
    if "friction" in groups:
        friction = groups["friction"]
        numbers |= {name: friction.variables[name] for name in FRICTION if name in friction}
        sources.append(friction)
    dimensions = {name for number in numbers.values() for name in number.dims}
    coordinates = {
        name: values.variable
        for source in reversed(sources)
        for name, values in source.coords.items()
        if values.dims and dimensions.issuperset(values.dims)
    }
    if "order" in coordinates:
        coordinates["order"] = coordinates["order"][:HARMONIC_COUNT]
    dataset = xr.Dataset(numbers, coords=coordinates)
    for name in dataset.data_vars:
        variable = dataset.variables[name]
        variable.attrs = {key: value for key, value in variable.attrs.items() if key.startswith("flag_")}
    return labelled(dataset)


def number_names(*, friction: bool) -> tuple[str, ...]:
    """Names of the key numbers that vary from result to result, also of those that not every one has."""
    return (
        "common_flank",
        "max_ease_off",
        "unloaded_peak_to_peak",
        "unloaded_rms",
        "unloaded_harmonic",
        *(f"unloaded_{name}" for name in UNLOADED),
        "geometric_contact_ratio",
        *(name for name in LOADED if name != "max_pressure_line_end"),
        "harmonic",
        "certified_positions",
        "worst_certificate",
        "max_edge_share",
        *(f"light_load_{name}" for name in LIGHT_LOAD),
        "max_root_stress",
        *(FRICTION if friction else ()),
    )


def _unloaded(ease_off: xr.Dataset, unloaded: xr.Dataset) -> dict[str, xr.Variable]:
    """Numbers of geometry and unloaded contact."""
    inside = ordered(ease_off, "inside", *GRID) == 1
    attributes = unloaded.attrs
    numbers: dict[str, xr.Variable] = {
        "common_flank": xr.Variable((), flank_share(inside)),
        "max_ease_off": xr.Variable((), np.max([*ordered(ease_off, "ease_off", *GRID)[inside], -np.inf])),
        "unloaded_peak_to_peak": xr.Variable((), attributes["peak_to_peak"]),
        "unloaded_rms": xr.Variable((), attributes["rms"]),
        "unloaded_harmonic": xr.Variable("order", np.atleast_1d(attributes["harmonics"])),
        "marking": xr.Variable((), attributes["separation"]),
    }
    numbers |= {f"unloaded_{name}": unloaded.variables[name] for name in UNLOADED if name in unloaded}
    return numbers | {name: unloaded.variables[name] for name in ("geometric_contact_ratio",) if name in unloaded}


def _loaded(loaded: xr.Dataset) -> dict[str, xr.Variable]:
    """Numbers of the loaded contact."""
    over = ("torque", "mesh_position")
    numbers: dict[str, xr.Variable] = {name: loaded.variables[name] for name in LOADED if name in loaded}
    numbers["harmonic"] = loaded.variables["harmonic"].isel(order=slice(HARMONIC_COUNT))
    certified = ordered(loaded, "status", *over) == Status.CERTIFIED
    numbers["certified_positions"] = xr.Variable("torque", np.sum(certified, axis=1))
    worst = np.max([ordered(loaded, name, *over) for name in CERTIFICATE_FIELDS], axis=(0, 2))
    numbers["worst_certificate"] = xr.Variable("torque", worst)
    if "overhang" in loaded and bool(np.isfinite(loaded.variables["overhang"].values).any()):
        share = ordered(loaded, "edge_share", *over)
        greatest = np.where(np.isnan(share), -np.inf, share).max(axis=1)
        numbers["max_edge_share"] = xr.Variable("torque", np.where(np.isfinite(greatest), greatest, np.nan))
    return numbers


TERM_COUNT_LIMIT = 5  # of a modification, the largest first; more are counted


def deviations(attributes: Mapping[Any, Any]) -> str:
    """Largest deviations of the flanks, and how they were taken in; empty if there are none.

    >>> deviations({"deviated": "surface", "largest_deviation_gear_um": 8.4})
    'gear up to 8.4 um, surfaces recomputed'
    """
    names = {member: f"largest_deviation_{member}_um" for member in MEMBERS}
    parts = [f"{member} up to {attributes[name]:.3g} um" for member, name in names.items() if name in attributes]
    way = {"ease_off": "ease-off updated", "surface": "surfaces recomputed"}.get(attributes.get("deviated", ""))
    return ", ".join([*parts, way] if parts and way else parts)


def modification(attributes: Mapping[Any, Any]) -> str:
    """Modification of the ease-off as text; empty if there is none."""
    terms = json.loads(str(attributes.get("modification_um", "{}")))
    largest = sorted(((n, v) for n, v in terms.items() if v), key=lambda term: -abs(term[1]))
    words = [f"{name.replace('_', ' ')} {value:+.3g} um" for name, value in largest[:TERM_COUNT_LIMIT]]
    left = len(largest) - len(words)
    return ", ".join([*words, f"{left} more terms"] if left else words)


MODEL_NAMES = {"shell": "shell", "solid_shell": "solid shell", "fe": "finite elements"}


def model_name(attributes: Mapping[Any, Any]) -> str:
    """Elastic model and whether edges touch, as text; of a result of an older version as it is recorded."""
    model = str(attributes.get("compliance_model", ""))
    edges = {1: "edges", 0: "lines only"}.get(int(attributes.get("edge_contact", -1)), "")
    return ", ".join(part for part in (MODEL_NAMES.get(model, model), edges) if part)
