"""File of a result of any kind, read to be drawn."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import xarray as xr

from ....core.errors import InputError
from ....core.reading.netcdf_file import tree_or_none
from ....core.reading.regular_file import named
from ...result import checked_result, read_result
from ...result_layout import index_faults, variable_faults
from ...sweep.sweep_file import checked_sweep, is_sweep

FLANK = ("lengthwise", "profile")
#: What a V-H check must have to be drawn, and its grid if it has one.
VH_CHECK: dict[tuple[str, ...], tuple[str, ...]] = {
    ("place",): (*("v", "h", "place_lengthwise", "place_profile"), *(f"pattern_centre_{name}" for name in FLANK)),
    ("place", *FLANK): ("print_excess",),
    ("plane_axis", *FLANK): ("in_plane",),
    ("lengthwise",): ("lengthwise",),
    ("profile",): ("profile",),
}
VH_GRID: dict[tuple[str, ...], tuple[str, ...]] = {
    ("v_grid",): ("v_grid",),
    ("h_grid",): ("h_grid",),
    ("v_grid", "h_grid"): tuple(f"grid_pattern_centre_{name}" for name in FLANK),
    ("v_grid", "h_grid", *FLANK): ("grid_print_excess",),
}
WEAR: dict[tuple[str, ...], tuple[str, ...]] = {
    ("step",): ("revolutions",),
    ("step", "member"): ("largest_depth",),
    ("step", "torque"): ("peak_to_peak", "max_pressure"),
    ("step", "member", *FLANK): ("wear_depth",),
    ("torque",): ("torque",),
    ("lengthwise",): ("lengthwise",),
    ("profile",): ("profile",),
}
FLANK_SIZE_MINIMUM = 1e-3  # length and height of a flank that can be drawn [mm]
SIZES = {"print_excess": {"plane_axis": 2, "place": 3}, "wear_depth": {"member": 2}}
LEAST = {"lengthwise": 2, "profile": 2, "step": 1, "torque": 1, "v_grid": 1, "h_grid": 1}


def read_drawn(path: str | os.PathLike[str]) -> xr.DataTree | xr.Dataset:
    """Read a file of ``easeoff run``, ``modify``, ``optimize``, ``sweep``, ``vh`` or ``wear``.

    Raises
    ------
    InputError
        If there is no such file, or it is none of these or damaged.

    Examples
    --------
    >>> try:
    ...     read_drawn("no-such-file.nc")
    ... except InputError as error:
    ...     print(error)
    no-such-file.nc: there is no such file
    """
    tree = tree_or_none(path)
    if tree is None:
        return read_result(path)  # says what is wrong with the file
    found = tree.to_dataset()
    if is_sweep(found):
        return checked_sweep(found, path)
    for sign, layout, command in (("print_excess", VH_CHECK, "vh"), ("wear_depth", WEAR, "wear")):
        if sign in found.variables:
            faults = study_faults(found, sign, layout)
            if faults:
                raise InputError(
                    f"{named(path)} is damaged, changed by hand or made by another version of easeoff: {faults[0]}; "
                    f"make it anew with 'easeoff {command} CASE -o FILE'"
                )
            return found
    return checked_result(tree, Path(path))


def study_faults(found: xr.Dataset, sign: str, layout: dict[tuple[str, ...], tuple[str, ...]]) -> list[str]:
    """What a V-H check or wear lacks to be drawn, one phrase each.

    Examples
    --------
    >>> study_faults(xr.Dataset(), "wear_depth", {("step",): ("revolutions",)})[0]
    "no numbers 'revolutions' over step"
    """
    grid = VH_GRID if sign == "print_excess" and "v_grid" in found.sizes else {}
    faults = [*variable_faults(found, layout | grid), *index_faults(found)]
    if faults:
        return faults
    for dimension, size in SIZES[sign].items():
        if found.sizes[dimension] != size:
            faults.append(f"{found.sizes[dimension]} values along {dimension}, expected {size}")
    few = [name for name, least in LEAST.items() if found.sizes.get(name, least) < least]
    faults += [f"too few values along {name}" for name in few]
    members = [str(value) for value in found["member"].values] if "member" in found.coords else []
    if sign == "wear_depth" and sorted(members) != ["gear", "pinion"]:
        faults.append("members must be 'pinion' and 'gear'")
    if sign == "print_excess":
        plane = found["in_plane"].transpose("plane_axis", ...).values
        if not np.all(np.isfinite(plane)) or not np.all(np.ptp(plane.reshape(2, -1), axis=1) > FLANK_SIZE_MINIMUM):
            faults.append("'in_plane' must hold the flank's points")
    if sign == "print_excess" and not isinstance(found.attrs.get("separation"), float):
        faults.append("no number in the attribute 'separation'")
    return faults
