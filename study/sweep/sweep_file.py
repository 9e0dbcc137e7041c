"""A sweep as a netCDF-4 file, and the layout that it must have for its table and pictures."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from ...core.attributes import StoredStatus
from ...core.errors import InputError
from ...core.netcdf_file import layout_fault, read_dataset, unreadable, write_netcdf
from ...core.regular_file import named
from ..result import ATTRIBUTES, MAGNITUDE_LIMIT, OPTIONAL_ATTRIBUTES, SWEEP_MARK, attribute_faults, form_faults
from .reductions import LOADS, ROWS, point_dimensions, swept_names

SWEEP_SCHEMA_VERSION = 1  # of what older versions do not read as it is meant
#: Dimensions that a number may have beside those of the points and of the loads.
OTHER_DIMENSIONS = ("order", "member")


class PointStatus(StoredStatus):
    """End of the analysis of a point of a sweep."""

    CERTIFIED = 0
    UNCERTIFIED = 1
    NOT_POSSIBLE = 2
    NO_CONTACT = 3
    FAILED = 4


def sweep_faults(dataset: xr.Dataset) -> list[str]:
    """Parts that the dataset of a sweep lacks, or has in another form, one phrase each; empty if it is whole."""
    faults = attribute_faults(dataset.attrs, ATTRIBUTES["sweep"], needed=True)
    for group in ("", "sweep"):
        faults += attribute_faults(dataset.attrs, OPTIONAL_ATTRIBUTES[group], needed=False)
    try:
        names = swept_names(dataset)
    except InputError:
        return [*faults, "the attribute 'swept' must be a list of coordinates"]
    faults += [*form_faults(dataset), *_coordinate_faults(dataset, names), *_status_faults(dataset, names)]
    return faults or list(_number_faults(dataset))


def _coordinate_faults(dataset: xr.Dataset, names: list[str]) -> Iterator[str]:
    for name in (*names, *(one for one in LOADS if one in dataset.coords)):
        values = dataset[name].values
        if values.ndim != 1 or not values.size or dataset[name].dims[0] not in (name, *ROWS):
            yield f"{name!r} must hold values in a row, over itself or over {' or '.join(ROWS)}"
        elif not (_is_text(values) or (values.dtype.kind in "fiu" and np.all(np.isfinite(values)))):
            yield f"{name!r} must hold finite numbers or texts"
        elif name in LOADS and values.dtype.kind not in "fiu":
            yield f"{name!r} must hold numbers"
    for key, variable in dataset.variables.items():
        if not isinstance(variable.attrs.get("units", ""), str):
            yield f"{key!r}: the attribute 'units' must be a text"


def _status_faults(dataset: xr.Dataset, names: list[str]) -> Iterator[str]:
    dimensions = {dim for name in names for dim in dataset[name].dims}
    status, known = dataset.get("status"), [int(one) for one in PointStatus]
    if status is None or status.dtype.kind not in "iu" or not np.all(np.isin(status.values, known)):
        yield f"no whole numbers 'status' from {min(known)} to {max(known)}"
    elif not dimensions - {*LOADS} <= {*status.dims} <= dimensions | {"torque"} or not status.size:
        yield "'status' must be over the swept coordinates and torque"
    elif "reason" not in dataset or dataset["reason"].dims != status.dims or not _is_text(dataset["reason"].values):
        yield "no texts 'reason' over the dimensions of 'status'"


def _number_faults(dataset: xr.Dataset) -> Iterator[str]:
    dimensions = {*point_dimensions(dataset)}
    known = dimensions | {*LOADS, *OTHER_DIMENSIONS}
    for name, variable in dataset.data_vars.items():
        if name in ("status", "reason"):
            continue
        if variable.dtype.kind not in "fiu" or not dimensions <= {*variable.dims} <= known:
            yield f"no numbers {name!r} over the points"
        elif np.any(np.abs(variable.values) > MAGNITUDE_LIMIT):  # infinite ones too; NaN where there is none
            yield f"{name!r} holds numbers beyond {MAGNITUDE_LIMIT:g}"


def _is_text(values: Any) -> bool:
    return values.dtype.kind == "U" or (
        values.dtype.kind == "O" and all(isinstance(one, str) for one in values.ravel().tolist())
    )


def write_sweep(dataset: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write the dataset of a sweep to a netCDF-4 file, whole or not at all; missing folders are made."""
    write_netcdf(dataset, path)


def read_sweep(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read the dataset of a sweep from a netCDF-4 file.

    Raises
    ------
    InputError
        If there is no such file, it is not of a sweep, or it is damaged.

    Examples
    --------
    >>> try:
    ...     read_sweep("no-such-file.nc")
    ... except InputError as error:
    ...     print(error)
    no-such-file.nc: there is no such file
    """
    dataset = read_dataset(path)
    if not is_sweep(dataset):
        raise InputError(f"{named(path)} is a netCDF file, but no sweep: make one with 'easeoff sweep CASE -o FILE'")
    return checked_sweep(dataset, path)


def is_sweep(dataset: xr.Dataset) -> bool:
    """True if a dataset has the mark of a sweep."""
    return SWEEP_MARK in getattr(dataset, "attrs", ())


def checked_sweep(dataset: xr.Dataset, path: str | os.PathLike[str]) -> xr.Dataset:
    """The dataset of a sweep as read from a file, with texts as texts; InputError with its faults if not whole."""
    faults = layout_fault(dataset.attrs, SWEEP_MARK, SWEEP_SCHEMA_VERSION) or sweep_faults(dataset)
    if faults:
        raise unreadable(path, dataset.attrs, faults, "easeoff sweep CASE -o FILE")
    texts = {
        name: (variable.dims, variable.values.astype(str), variable.attrs)
        for name, variable in dataset.variables.items()
        if variable.dtype.kind == "O"
    }
    return dataset.assign(texts)
