"""Pair in its assembly: misalignment over the torque, how supports hold the members, and bearing loads."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from ...core.arrays import Array
from ...core.attributes import ordered
from ...geometry.pair.member_names import MEMBERS
from .quantities import Quantity, written
from .table import ROW_COUNT_LIMIT, Table


@dataclass(frozen=True)
class AssemblyError:
    """An assembly error as people read it, and as results keep it."""

    symbol: str
    name: str  # of its variable in the group ``misalignment``, and of the key of the case
    unit: str = "mm"
    stored_unit: str = "mm"  # of the attribute
    factor: float = 1.0  # of what is read over what is stored

    @property
    def attribute(self) -> str:
        """Attribute of the root of a result with its value without torque."""
        return f"misalignment_{self.name}_{self.stored_unit}"

    def quantity(self, form: str) -> Quantity:
        """The error as a column of a table, written in a form."""
        return Quantity(
            self.symbol, self.unit.replace("deg", "°"), form, self.factor, column=f"{self.symbol}\n{self.unit}"
        )

    def words(self, value: float, form: str = "+g") -> str:
        """A value [mm, degree] with symbol and unit."""
        return f"{self.symbol} {value:{form}} {self.unit}"


ERRORS = (
    AssemblyError("E", "offset"),
    AssemblyError("P", "pinion_axial"),
    AssemblyError("G", "gear_axial"),
    AssemblyError("Sigma", "shaft_angle", "deg", "rad", math.degrees(1.0)),
)


def misalignment_over_torque(tree: xr.DataTree) -> tuple[Array, Array] | None:
    """Torques (t) [N m], rising from zero, and misalignments (t, k, 4) [mm, rad] over the mesh positions.

    ``None`` if the misalignment does not depend on the torque.
    """
    if "misalignment" not in tree.children:  # older results
        return None
    group = tree["misalignment"].to_dataset().sortby("torque")
    errors = np.stack([ordered(group, error.name, "torque", "mesh_position") for error in ERRORS], axis=-1)
    unloaded = np.array([float(tree.attrs[error.attribute]) for error in ERRORS])
    if np.all(errors == unloaded):
        return None
    whole = np.concatenate([np.broadcast_to(unloaded, (1, *errors.shape[1:])), errors])
    return np.concatenate([[0.0], group["torque"].values]), whole


def mean_misalignment(tree: xr.DataTree) -> tuple[Array, Array] | None:
    """Torques (t) [N m] and misalignments (t, 4) [mm, degree], means over the mesh cycle; ``None`` as above."""
    course = misalignment_over_torque(tree)
    return None if course is None else (course[0], course[1].mean(axis=1) * [error.factor for error in ERRORS])


def error_values(attributes: Mapping[Any, Any]) -> dict[AssemblyError, float]:
    """Assembly errors [mm, degree] in the attributes of a result or sweep."""
    return {
        error: error.factor * float(attributes[error.attribute]) for error in ERRORS if error.attribute in attributes
    }


def misalignment_words(attributes: Mapping[Any, Any]) -> str:
    """Misalignment without torque in words, from the attributes of a result; empty if there is none."""
    return ", ".join(error.words(value) for error, value in error_values(attributes).items() if value)


def deflection_tables(tree: xr.DataTree) -> list[Table]:
    """Table of the mean misalignment of a mesh cycle, a row a torque; none if it does not depend on the torque."""
    course = mean_misalignment(tree)
    if course is None:
        return []
    rows = [
        (f"{torque:g}", *("0" if value == 0.0 else f"{value:+.4f}" for value in row))
        for torque, row in zip(course[0], course[1].tolist(), strict=True)
    ]
    heads: list[str | Quantity] = ["torque\nN m", *(error.quantity("+.4f") for error in ERRORS)]
    title = "Misalignment over the torque, mean over the mesh cycle"
    variables = tuple(f"misalignment/{name}" for name in ("torque", *(error.name for error in ERRORS)))
    return [Table(heads, rows, 0, title, variables=variables, group="misalignment")]


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


def toleranced_backlash(
    play: xr.Dataset, mounting: float = 0.0, thinner: float = 0.0, run_out: float = 0.0
) -> tuple[float, float] | None:
    """Least and greatest normal backlash at the heel [mm] of a group ``backlash`` within tolerances; ``None`` without.

    Both mounting distances may be off by ``mounting``, both teeth thinner by ``thinner``, and the run-outs of both
    members, together ``run_out`` between the flanks, at their least or greatest [mm].
    """
    if not (mounting or thinner or run_out):
        return None
    values = play["outer_normal_backlash"].values
    shifts = np.abs([play[f"backlash_by_{member}_axial"].values for member in MEMBERS]).sum(axis=0) * mounting
    lost = 2.0 * thinner * abs(float(play["backlash_by_thickness"]))
    return float(np.min(values - shifts)) - run_out, float(np.max(values + shifts)) + lost + run_out


def backlash_words(tree: xr.DataTree) -> str:
    """Backlash of a result in words, with the tolerances of its case, or why it is not known; empty if it is older."""
    if "backlash" not in tree.children:
        return str(tree.attrs.get("backlash_left_out", "")).replace("the backlash is not known: ", "not known: ")
    play, drawing = tree["backlash"].to_dataset(), stored_table(tree, "drawing")
    values = play["outer_normal_backlash"].values
    words = f"{millimetres(values.min())} to {millimetres(values.max())} mm, normal, at the heel of the gear"
    within = toleranced_backlash(play, *(drawing.get(f"{each}_tolerance", 0.0) for each in ("mounting", "thickness")))
    return words if within is None else f"{words}; within tolerances {' to '.join(map(millimetres, within))} mm"


MISFIT = -0.002  # [mm]; less is not told


def misfit(play: xr.Dataset) -> list[str]:
    """Warning of teeth that do not fit, by a group ``backlash``; none if they do."""
    least = float(play["outer_normal_backlash"].min())
    if not least < MISFIT:
        return []
    return [
        f"Warning: the backlash is negative, down to {millimetres(least)} mm: the teeth do not fit between each other; "
        "a smaller mean_normal_circular_thickness or larger mounting distances (pinion_axial, gear_axial) give more."
    ]


def millimetres(value: float, form: str = ".3f") -> str:
    """A length [mm] to the micrometre, without a minus sign of zero."""
    return f"{round(float(value), 3) + 0.0:{form}}"


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
