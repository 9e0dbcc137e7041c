"""Results on disk: one netCDF-4 file with a group a stage, complete or not there at all."""

from __future__ import annotations

import os
from pathlib import Path

import xarray as xr

from ..core.errors import InputError
from ..core.files import require_file, whole_file

GROUPS = ("flanks", "ease_off", "teeth", "unloaded", "loaded")


def write_result(tree: xr.DataTree, path: str | os.PathLike[str]) -> None:
    """Write an analysis to a netCDF-4 file.

    Parameters
    ----------
    tree
        What ``analyze`` returned.
    path
        The file, replaced if it exists; missing folders are made.

    Raises
    ------
    InputError
        If the file cannot be written; nothing is left behind then.
    """
    encoding = {
        node.path: {
            str(name): {"zlib": True, "complevel": 1}
            for name, variable in node.dataset.variables.items()
            if variable.dtype.kind in "fiu" and variable.ndim
        }
        for node in tree.subtree
        if node.path != "/"
    }
    with whole_file(path) as temporary:
        tree.to_netcdf(temporary, engine="netcdf4", format="NETCDF4", encoding=encoding)


def read_result(path: str | os.PathLike[str]) -> xr.DataTree:
    """Read an analysis; the file is closed again.

    Parameters
    ----------
    path
        A file written by ``write_result``.

    Raises
    ------
    InputError
        If there is no such file, or it is no result of this package.
    """
    source = Path(path)
    require_file(source)
    try:
        with xr.open_datatree(source, engine="netcdf4") as opened:
            tree = opened.load()
    except (OSError, ValueError, RuntimeError) as error:
        raise InputError(f"{source} is not a netCDF file that can be read: {error}") from error
    missing = [name for name in GROUPS if name not in tree.children]
    if "easeoff_version" not in tree.attrs or missing:
        raise InputError(
            f"{source} is a netCDF file, but no result of 'easeoff run'"
            + (f" (no group {', '.join(missing)})" if missing else "")
            + ": make one with 'easeoff run CASE -o FILE'"
        )
    return tree
