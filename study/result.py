"""Results on disk: one netCDF-4 file with a group a stage, complete or not there at all."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

import xarray as xr

from ..core.errors import InputError

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
    target = Path(path)
    check_writable(target)
    temporary = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    encoding = {
        node.path: {
            str(name): {"zlib": True, "complevel": 1}
            for name, variable in node.dataset.variables.items()
            if variable.dtype.kind in "fi" and variable.ndim
        }
        for node in tree.subtree
        if node.path != "/"
    }
    try:
        tree.to_netcdf(temporary, engine="netcdf4", format="NETCDF4", encoding=encoding)
        os.replace(temporary, target)
    except OSError as error:
        raise InputError(f"{target} cannot be written: {error.strerror or error}") from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink()


def check_writable(path: str | os.PathLike[str]) -> None:
    """Refuse an output path before any work is done for it.

    Raises
    ------
    InputError
        If the folder does not exist and cannot be made, may not be written to, or the path is a folder.
    """
    target = Path(path)
    if target.is_dir():
        raise InputError(f"{target} is a folder: give the name of a file")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{target} cannot be written: {error.strerror or error}") from error
    if not os.access(target.parent, os.W_OK) or (target.exists() and not os.access(target, os.W_OK)):
        raise InputError(f"{target} cannot be written: no permission")


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
    if not source.is_file():
        raise InputError(f"{source}: there is no such file")
    try:
        with xr.open_datatree(source, engine="netcdf4") as opened:
            tree = opened.load()
    except (OSError, ValueError, RuntimeError) as error:
        raise InputError(f"{source} is not a netCDF file that can be read: {error}") from error
    missing = [name for name in GROUPS if name not in tree.children]
    if "easeoff_version" not in tree.attrs or missing:
        raise InputError(
            f"{source} is a netCDF file, but no result of easeoff"
            + (f" (no group {', '.join(missing)})" if missing else "")
            + ": make one with 'easeoff run CASE -o FILE'"
        )
    return tree
