"""netCDF-4 files: a dataset or a tree of them, written whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import xarray as xr

from ..processes.forked_process import netcdf_to_oneself
from ..reading.netcdf_file import in_memory
from .output_file import whole_file


class _LaterWriter:
    """Takes the place of xarray's writer and keeps the values back until all variables of the file are defined.

    netCDF writes the whole header anew with the first values after a definition: in turn, the time grows with the
    square of the number of variables.
    """

    def __init__(self) -> None:
        self.kept: list[tuple[Any, Any]] = []

    def add(self, source: Any, target: Any, region: Any = None) -> None:
        """Keep values and the variable that they are written to; a region is given for parts of a file alone."""
        assert region is None
        self.kept.append((source, target))

    def write(self) -> None:
        """Write the values."""
        for source, target in self.kept:
            target[...] = source


def write_netcdf(
    content: xr.Dataset | xr.DataTree,
    path: str | os.PathLike[str],
    encoding: Mapping[str, Mapping[str, Any]] | None = None,
) -> None:
    """Write a dataset or a tree to a netCDF-4 file.

    Parameters
    ----------
    content
        What is written.
    path
        The file, replaced if it exists; missing folders are made.
    encoding
        As of ``Dataset.to_netcdf``: by variable, or of a tree by group and variable.

    Raises
    ------
    InputError
        If the file cannot be written; nothing is left behind then.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> tree = xr.DataTree.from_dict({"/inner": xr.Dataset({"force": ("segment", [1.0, 2.0])})})
    >>> with TemporaryDirectory() as folder:
    ...     write_netcdf(tree, f"{folder}/forces.nc")
    ...     with xr.open_datatree(f"{folder}/forces.nc") as found:
    ...         found.identical(tree)
    True
    """
    from netCDF4 import Dataset

    tree, by_group = content, encoding or {}
    if not isinstance(tree, xr.DataTree):
        tree, by_group = xr.DataTree(tree), {"/": by_group}
    groups = [
        (node.relative_to(tree), in_memory(node.to_dataset(inherit=node is tree)), by_group.get(node.path, {}))
        for node in tree.subtree
    ]
    later = _LaterWriter()
    with whole_file(path) as temporary, netcdf_to_oneself(), Dataset(temporary, "w", format="NETCDF4") as file:
        for name, dataset, own in groups:
            group = file if name == "." else file.createGroup(name)
            store = xr.backends.NetCDF4DataStore(group, lock=False)  # type: ignore[no-untyped-call]
            dataset.dump_to_store(store, writer=later, encoding={key: dict(each) for key, each in own.items()})
        later.write()
