"""Dataset of a sweep as a netCDF-4 file."""

from __future__ import annotations

import os

import xarray as xr

from ...core.errors import InputError
from ...core.file_origin import layout_fault, unreadable
from ...core.netcdf_file import read_dataset, write_netcdf
from ...core.regular_file import named
from .sweep_layout import SWEEP_SCHEMA_VERSION, sweep_faults

MARK = "sweep_schema_version"  # attribute by which the file of a sweep is known


def write_sweep(dataset: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write the dataset of a sweep to a netCDF-4 file, whole or not at all.

    Parameters
    ----------
    dataset
        From ``sweep``.
    path
        The file, replaced if it exists; missing folders are made.

    Raises
    ------
    InputError
        If the file cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from easeoff.study.sweep import sweep
    >>> found = sweep("nasa-12x36", {"E": [0.02]}, torques=[100.0])
    >>> with TemporaryDirectory() as folder:
    ...     write_sweep(found, f"{folder}/sweep.nc")
    ...     read_sweep(f"{folder}/sweep.nc").identical(found)
    True
    """
    encoding = {
        str(name): {"zlib": True, "complevel": 1}
        for name, variable in dataset.variables.items()
        if variable.dtype.kind in "fiu" and variable.ndim
    }
    write_netcdf(dataset, path, encoding)


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
    found = read_dataset(path)
    if not is_sweep(found):
        raise InputError(f"{named(path)} is a netCDF file, but no sweep: make one with 'easeoff sweep CASE -o FILE'")
    return checked_sweep(found, path)


def is_sweep(dataset: xr.Dataset) -> bool:
    """Whether a dataset has the mark of a sweep.

    Examples
    --------
    >>> is_sweep(xr.Dataset())
    False
    """
    return MARK in getattr(dataset, "attrs", ())


def checked_sweep(dataset: xr.Dataset, path: str | os.PathLike[str]) -> xr.Dataset:
    """The dataset of a sweep as it was read from a file, with texts as texts.

    Raises
    ------
    InputError
        If it is not whole; says what is wrong.

    Examples
    --------
    >>> try:
    ...     checked_sweep(xr.Dataset(attrs={MARK: 1}), "sweep.nc")
    ... except InputError as error:
    ...     print(str(error).partition(":")[0])
    sweep.nc is damaged, changed by hand or made by another version of easeoff
    """
    faults = layout_fault(dataset.attrs, MARK, SWEEP_SCHEMA_VERSION) or sweep_faults(dataset)
    if faults:
        raise unreadable(path, dataset.attrs, faults, "easeoff sweep CASE -o FILE")
    texts = {
        name: (variable.dims, variable.values.astype(str), variable.attrs)
        for name, variable in dataset.variables.items()
        if variable.dtype.kind == "O"
    }
    return dataset.assign(texts)
