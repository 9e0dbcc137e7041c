"""Pair on supports: how the members are held, shares of the gear's rotation and bearing loads, a row a torque."""

from __future__ import annotations

import tomllib
from typing import Any

import numpy as np
import xarray as xr

from ...core.arrays import Array
from ...core.attributes import ordered
from ...geometry.pair.member_names import MEMBERS
from .deflection_report import error_values, misalignment_words
from .quantities import written
from .table import Table

#: Parts of the gear's rotation by name, with their variables in the group ``supports``.
SHARES = {
    "teeth": "teeth_rotation",
    "contact": "contact_rotation",
    "supports": "supports_rotation",
    "ease-off": "ease_off_rotation",
}
BEARING_COUNT_LIMIT = 5  # side by side
OVER = ("torque", "mesh_position")


def supports_tables(tree: xr.DataTree) -> list[Table]:
    """Tables of a pair on supports, means over the mesh cycle: shares of the gear's rotation, and bearing loads."""
    if "supports" not in tree.children:
        return []
    group = tree["supports"].to_dataset().sortby("torque")
    torques = [f"{torque:g}" for torque in group["torque"].values]
    whole = ordered(group, "whole_rotation", *OVER).mean(axis=1)
    parts = [ordered(group, name, *OVER).mean(axis=1) for name in SHARES.values()]
    columns = [_written(whole, ".1f"), *(_written(100.0 * part / whole, ".1f") for part in parts)]
    tables = [
        Table(
            ("torque\nN m", "whole\nurad", *(f"{name}\n%" for name in SHARES)),
            tuple(zip(torques, *columns, strict=True)),
            0,
            "Rotation of the gear by the load, mean over the mesh cycle",
            variables=("supports/whole_rotation", *(f"supports/{name}" for name in SHARES.values())),
            group="supports",
        )
    ]
    names, radial, axial = bearing_loads(tree)
    for first in range(0, len(names), BEARING_COUNT_LIMIT):
        bearings = range(first, min(first + BEARING_COUNT_LIMIT, len(names)))
        means = [(radial[number].mean(axis=1), axial[number].mean(axis=1)) for number in bearings]
        loads = [[f"{written(r, '.0f')}, {written(a, '+.0f')}" for r, a in zip(*both, strict=True)] for both in means]
        tables.append(
            Table(
                ("torque\nN m", *("\n".join(names[number].split(" ", 1)) for number in bearings)),
                tuple(zip(torques, *loads, strict=True)),
                0,
                "Bearing loads in N, radial and axial (positive towards the heel), mean over the mesh cycle",
                variables=("supports/bearing_force",),
                group="supports",
            )
        )
    return tables


def bearing_loads(tree: xr.DataTree) -> tuple[list[str], Array, Array]:
    """Names of bearings, and radial and axial force (bearing, torque, mesh_position) [N] on each, torques rising.

    Axial forces are positive from the crossing point to the heel. No bearings where matrices hold the members.
    """
    group = tree["supports"].to_dataset().sortby("torque")
    if "bearing_force" not in group:
        return [], np.zeros((0, 0, 0)), np.zeros((0, 0, 0))
    names = [str(name) for name in group["bearing"].values]
    force = ordered(group, "bearing_force", "bearing", *OVER, "space")
    axes = {member: towards_heel(tree["ease_off"].to_dataset(), member) for member in MEMBERS}
    directions = np.stack([axes["pinion" if name.startswith("pinion ") else "gear"] for name in names])
    axial = np.einsum("btks,bs->btk", force, directions)
    across = force - axial[..., None] * directions[:, None, None, :]
    return names, np.linalg.norm(across, axis=-1), axial


def supports_words(tree: xr.DataTree) -> str:
    """Supports of the members in words; empty without supports."""
    if "supports" not in tree.children:
        return ""
    name = str(tree.attrs.get("supports_name", ""))
    return f"{name}: {_held(tree)}" if name and name != "of the case" else _held(tree)


def added_notes(tree: xr.DataTree) -> list[str]:
    """Note that the misalignment of the case, if the result has it, is added to that of the supports.

    A published one may stand for deflections under load, which would then count twice.
    """
    if "supports" not in tree.children or "deflections" in tree.attrs:
        return []
    words, table = misalignment_words(tree.attrs), stored_table(tree, "misalignment")
    errors = error_values(tree.attrs).items()
    alike = all(np.isclose(value, float(table.get(error.name, 0.0))) for error, value in errors)
    if not words or not alike:
        return []
    return [
        f"Note: the case's misalignment {words} stands without torque and is added to that of the supports; "
        "--misalignment E=0 leaves it out, as it should be where it stands for deflections under load."
    ]


def _held(tree: xr.DataTree) -> str:
    """Bearings or matrix that hold each member, in words."""
    table = stored_table(tree, "supports")
    if "housing" in table:
        return "both members by one matrix, with the housing"
    group = tree["supports"].to_dataset()
    names = [str(name) for name in group["bearing"].values] if "bearing" in group.coords else []
    parts = []
    for member in MEMBERS:
        bearings = [name.partition(" ")[2] for name in names if name.startswith(f"{member} ")]
        if bearings:
            parts.append(f"{member} on bearings {', '.join(bearings)}")
        elif table:
            parts.append(f"{member} by a matrix" if member in table else f"{member} rigid")
    return "; ".join(parts) or "by matrices"


def stored_table(tree: xr.DataTree, name: str) -> dict[str, Any]:
    """A table in the text of the case that a result keeps; empty if there is none."""
    text = str(tree.attrs.get("case", ""))
    try:
        data = tomllib.loads(text)
        table = data.get(name, {})
    except (ValueError, AttributeError):
        return {}
    return table if isinstance(table, dict) else {}


def towards_heel(ease_off: xr.Dataset, member: str) -> Array:
    """Unit vector (3) of a member's axis, in the global frame, from its crossing point to the mesh."""
    axis = np.asarray(ease_off.attrs[f"{member}_axis"], dtype=float)
    origin = np.asarray(ease_off.attrs[f"{member}_origin_mm"], dtype=float)
    action = ordered(ease_off, "action_position", "lengthwise", "profile", "space").reshape(-1, 3)
    mesh = np.mean(action[np.all(np.isfinite(action), axis=1)], axis=0)
    return np.asarray(axis * np.sign(axis @ (mesh - origin)))


def _written(values: Array, form: str) -> list[str]:
    return [written(value, form) for value in values]
