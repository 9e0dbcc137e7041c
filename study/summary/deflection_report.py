"""Misalignment over the torque as a table, and whether its deflections are continued beyond their own table."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from tabulate import tabulate

Array = NDArray[Any]

#: Variables of the group ``misalignment`` by the symbols that people know them by, with the attributes of the root.
ERRORS = {
    "E": ("offset", "misalignment_offset_mm"),
    "P": ("pinion_axial", "misalignment_pinion_axial_mm"),
    "G": ("gear_axial", "misalignment_gear_axial_mm"),
    "Sigma": ("shaft_angle", "misalignment_shaft_angle_rad"),
}
ROW_COUNT_LIMIT = 40  # of the table


def misalignment_over_torque(tree: xr.DataTree) -> tuple[Array, Array] | None:
    """Torques (t) [N m], rising from zero, and misalignments (t, k, 4) [mm, rad] over the mesh positions.

    ``None`` if the misalignment does not depend on the torque.
    """
    if "misalignment" not in tree.children:  # older results
        return None
    group = tree["misalignment"].to_dataset().sortby("torque")
    errors = np.stack([group[name].transpose("torque", "mesh_position").values for name, _ in ERRORS.values()], axis=-1)
    unloaded = np.array([float(tree.attrs[attribute]) for _, attribute in ERRORS.values()])
    if np.all(errors == unloaded):
        return None
    whole = np.concatenate([np.broadcast_to(unloaded, (1, *errors.shape[1:])), errors])
    return np.concatenate([[0.0], group["torque"].values]), whole


def misalignment_words(attributes: Mapping[Any, Any]) -> str:
    """Misalignment without torque in words, from the attributes of a result; empty if there is none."""
    return ", ".join(words for words, value in zip(*error_words(attributes), strict=True) if value)


def error_words(attributes: Mapping[Any, Any]) -> tuple[list[str], list[float]]:
    """Assembly errors in the attributes of a result or sweep, in words, and their values [mm, degree]."""
    values = {symbol: float(attributes[name]) for symbol, (_, name) in ERRORS.items() if name in attributes}
    if "Sigma" in values:
        values["Sigma"] = float(np.degrees(values["Sigma"]))
    words = [
        f"{symbol} {f'{value:+g}' if value else '0'} {'deg' if symbol == 'Sigma' else 'mm'}"
        for symbol, value in values.items()
    ]
    return words, list(values.values())


def deflection_table(tree: xr.DataTree) -> str:
    """Table of the mean misalignment of a mesh cycle, a row a torque; empty if it does not depend on the torque."""
    course = misalignment_over_torque(tree)
    if course is None:
        return ""
    torques, errors = course
    mean = errors.mean(axis=1)
    mean[:, 3] = np.degrees(mean[:, 3])
    rows = [
        (f"{torque:g}", *("0" if value == 0.0 else f"{value:+.4f}" for value in row))
        for torque, row in zip(torques, mean.tolist(), strict=True)
    ]
    table = tabulate(
        rows[:ROW_COUNT_LIMIT],
        headers=("torque\nN m", "E\nmm", "P\nmm", "G\nmm", "Sigma\ndeg"),
        disable_numparse=True,
        colalign=("right",) * 5,
    )
    left = len(rows) - ROW_COUNT_LIMIT
    return f"{table}\n... and {left} more in the group misalignment" if left > 0 else table


def deflection_notes(tree: xr.DataTree) -> list[str]:
    """Note on torques beyond the table of deflections, if there are some."""
    if "deflection_torques_N_m" not in tree.attrs:
        return []
    last = float(np.asarray(tree.attrs["deflection_torques_N_m"])[1])
    beyond = [torque for torque in np.sort(tree["loaded"].to_dataset()["torque"].values) if torque > last]
    if not beyond:
        return []
    at = ", ".join(f"{torque:g}" for torque in beyond[:ROW_COUNT_LIMIT])
    return [
        f"Note: the table of deflections ends at {last:g} N m; at {at} N m E, P, G and Sigma were extrapolated, "
        "straight on from its last row."
    ]
