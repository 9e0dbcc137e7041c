"""The arrays of a file of contact problems, also one that another program wrote with less care.

What can be told from the numbers need not be said: without ``size`` a problem ends where its separations do, without
``structured`` the form is that of the compliance that is there, without ``mode_count`` the factor ends where its
numbers do. Dimensions may come in another order. Units may be left out, but other units are refused, not guessed at.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..core.errors import InputError
from .problem_dataset import ATTRIBUTES

#: Dimensions of every array of a file, in the order in which they are read.
DIMENSIONS: dict[str, tuple[str, ...]] = {
    "torque": ("problem",),
    "separation": ("problem", "segment"),
    "lever_arm": ("problem", "segment"),
    "compliance": ("problem", "segment", "segment_other"),
    "compliance_diagonal": ("problem", "segment"),
    "compliance_factor": ("problem", "segment", "mode"),
    "size": ("problem",),
    "structured": ("problem",),
    "mode_count": ("problem",),
}


def require_arrays(dataset: xr.Dataset) -> None:
    """Refuse a Dataset that lacks what nothing can replace.

    Raises
    ------
    InputError
        The message lists the missing variables.
    """
    missing = [name for name in ("separation", "lever_arm", "torque") if name not in dataset.variables]
    parts = [name for name in ("compliance_diagonal", "compliance_factor") if name not in dataset.variables]
    if "compliance" not in dataset.variables and parts:
        missing += ["compliance"] if len(parts) == 2 else parts
    if missing:
        raise InputError(f"incomplete, without {', '.join(missing)}")


def problem_arrays(dataset: xr.Dataset) -> dict[str, NDArray[Any]]:
    """Return the arrays of `DIMENSIONS` that describe the problems of a Dataset, `size` and the like always among them.

    Raises
    ------
    InputError
        A variable is missing, has other dimensions, or other units.
    """
    require_arrays(dataset)
    data = {name: _array(dataset, name) for name in DIMENSIONS if name in dataset.variables}
    count = data["separation"].shape[0]
    for name, array in data.items():
        if array.shape[0] != count:
            raise InputError(f"{name} has {array.shape[0]} problems, separation has {count}")
    if "size" not in data:
        data["size"] = _length(np.isfinite(data["separation"]))
    if "structured" not in data:
        # Where both forms are there, each problem has numbers in one of them.
        factor = data.get("compliance_diagonal")
        data["structured"] = np.zeros(count, dtype=np.int8) if factor is None else np.isfinite(factor).any(axis=1)
    if "mode_count" not in data and "compliance_factor" in data:
        data["mode_count"] = _length(np.isfinite(data["compliance_factor"]).any(axis=1))
    return data


def _array(dataset: xr.Dataset, name: str) -> NDArray[Any]:
    variable, expected = dataset[name], DIMENSIONS[name]
    if set(variable.dims) == set(expected):
        variable = variable.transpose(*expected)
    elif variable.ndim != len(expected):
        found = ", ".join(map(str, variable.dims))
        raise InputError(f"{name} has the dimensions ({found}), expected ({', '.join(expected)})")
    units = str(variable.attrs.get("units", "")).strip()
    wanted = ATTRIBUTES.get(name, {}).get("units", "1")
    if units.replace(" ", "") not in ("", "1", wanted.replace(" ", "")):
        raise InputError(f"{name} is in {units!r}, expected {wanted!r}: convert the file")
    return variable.to_numpy()


def _length(present: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Length of each row up to its last entry that is present; an empty row counts as one, to be refused later."""
    width = present.shape[1]
    length: NDArray[np.intp] = np.where(present.any(axis=1), width - np.argmax(present[:, ::-1], axis=1), min(1, width))
    return length
