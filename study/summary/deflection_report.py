"""Misalignment over the torque as a table, and whether its deflections are continued beyond their own table."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from ...core.arrays import Array
from ...core.attributes import ordered
from .quantities import Quantity
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
