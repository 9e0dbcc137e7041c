"""Arrays of a file of contact problems, also of an incomplete file from another program.

Entries that follow from the numbers may be missing: without ``size`` a problem ends where its separations do, without
``structured`` the form is that of the compliance that is there, without ``mode_count`` the factor ends where its
numbers do. Dimensions may come in another order or have other names; a file with a single problem need not have that of
the problem. Where nothing was written a number may be NaN, the variable's ``_FillValue`` or netCDF's own. Units may be
left out or be spelt otherwise, but other units are refused, not guessed at.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.checks import shown
from ...core.errors import InputError
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


#: Value of netCDF where nothing was written to a variable of floating point numbers without its own fill value.
NETCDF_FILL = 9.969209968386869e36

#: Other spellings of units, without blanks and asterisks.
SPELLINGS = {
    "mm": ("millimeter", "millimetre"),
    "N mm": ("N.mm", "mmN", "mm.N"),
    "mm/N": ("mmN-1", "mm.N-1", "mmN^-1"),
    "(mm/N)^0.5": ("(mm/N)0.5", "(mm/N)^(1/2)", "mm^0.5N^-0.5", "sqrt(mm/N)"),
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
    """Return the arrays of `DIMENSIONS` that a Dataset has, and `size`, `structured` and `mode_count` if it has not.

    Parameters
    ----------
    dataset
        Complete by `require_arrays`.

    Raises
    ------
    InputError
        A variable has other dimensions or other units, holds no numbers, or counts what is not there.
    """
    single = dataset["torque"].ndim == 0
    data = {name: _array(dataset, name, single) for name in DIMENSIONS if name in dataset.variables}
    separation, factor = data["separation"], data.get("compliance_factor")
    if not separation.size:
        raise InputError(f"separation = {shown(separation)}: must hold one problem of one segment, or more")
    count = separation.shape[0]
    for name, array in data.items():
        if array.shape[0] != count:
            raise InputError(f"{name} = {shown(array)}: must hold {count} problems, as separation")
    sizes = data.get("size", _length(np.isfinite(separation)))
    data["size"] = _counts(sizes, "size", 1, separation.shape[1])
    if "structured" not in data:
        # Where both forms are there, each problem has numbers in one of them.
        diagonal = data.get("compliance_diagonal")
        data["structured"] = np.zeros(count) if diagonal is None else np.isfinite(diagonal).any(axis=1)
    data["structured"] = _counts(data["structured"], "structured", 0, 1)
    for flag, name in ((0, "compliance"), (1, "compliance_diagonal"), (1, "compliance_factor")):
        if name not in data and (data["structured"] == flag).any():
            number = int(np.argmax(data["structured"] == flag))
            raise InputError(
                f"structured of problem {number} = {flag}: must go with the variable {name}, which is missing"
            )
    if factor is not None:
        modes = data.get("mode_count", _length(np.isfinite(factor).any(axis=1)))
        data["mode_count"] = _counts(modes, "mode_count", 0, factor.shape[2])
    return data


def _array(dataset: xr.Dataset, name: str, single: bool) -> NDArray[Any]:
    variable, expected = dataset[name], DIMENSIONS[name][1 if single else 0 :]
    if sorted(map(str, variable.dims)) == sorted(expected):
        variable = variable.transpose(*expected)
    elif variable.ndim != len(expected):
        found = ", ".join(map(str, variable.dims))
        raise InputError(f"{name} = array over ({found}): must have the dimensions ({', '.join(expected)})")
    units = str(variable.attrs.get("units", "")).translate(str.maketrans("", "", " *"))
    wanted = ATTRIBUTES.get(name, {}).get("units", "1")
    if units not in ("", "1", wanted.replace(" ", ""), *SPELLINGS.get(wanted, ())):
        raise InputError(f"units of {name} = {variable.attrs['units']!r}: must be {wanted!r}; convert the file")
    array = variable.to_numpy()
    if array.dtype.kind not in "biuf":
        raise InputError(f"{name} = array of {array.dtype}: must hold numbers")
    if array.dtype.kind == "f":
        array = np.where(array == NETCDF_FILL, np.nan, array.astype(np.float64, copy=False))
    return array[np.newaxis] if single else array


def _counts(values: NDArray[Any], name: str, least: int, most: int) -> NDArray[np.intp]:
    """Return whole numbers within limits; InputError otherwise."""
    wrong = ~((values >= least) & (values <= most) & (values == np.floor(values)))
    if wrong.any():
        number = int(np.argmax(wrong))
        given = shown(values[number])
        raise InputError(f"{name} of problem {number} = {given}: must be a whole number from {least} to {most}")
    return values.astype(np.intp)


def _length(present: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Length of each row up to its last entry that is present; an empty row counts as one, to be refused later."""
    width = present.shape[1]
    if not width:  # no modes
        return np.zeros(present.shape[0], dtype=np.intp)
    length: NDArray[np.intp] = np.where(present.any(axis=1), width - np.argmax(present[:, ::-1], axis=1), 1)
    return length
