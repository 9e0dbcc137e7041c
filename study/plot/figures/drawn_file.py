"""File of a result of any kind, read to be drawn."""

from __future__ import annotations

import os
from pathlib import Path

import xarray as xr

from ....core.netcdf_file import tree_or_none
from ....core.regular_file import named
from ...result import checked_result, read_result
from ...result_layout import require_layout
from ...sweep.sweep_file import checked_sweep, is_sweep


def read_drawn(path: str | os.PathLike[str]) -> xr.DataTree | xr.Dataset:
    """Read a file of ``easeoff run``, ``modify``, ``optimize``, ``sweep``, ``vh`` or ``wear``.

    Raises
    ------
    InputError
        If there is no such file, or it is none of these or damaged.

    Examples
    --------
    >>> from easeoff import InputError
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
    for sign, kind in (("print_excess", "V-H check"), ("wear_depth", "wear")):
        if sign in found.variables:
            require_layout(named(path), found, kind)
            return found
    return checked_result(tree, Path(path))
