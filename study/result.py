"""Result of an analysis as a netCDF-4 file, a group a stage; the kinds of what files of this package hold."""

from __future__ import annotations

import os
from pathlib import Path

import xarray as xr

from ..core.checks import file_path, instance
from ..core.errors import InputError
from ..core.file_origin import layout_fault, unreadable
from ..core.netcdf_file import read_tree, tree_or_none, write_netcdf
from ..core.regular_file import named
from .result_layout import RESULT_SCHEMA_VERSION, SWEEP_MARK, VARIABLES, faults, load_case_faults, require_layout

COMPRESSED_SIZE = 4096  # [bytes] from which a variable is compressed: chunks of less take longer, and more room
#: What reports and pictures are made of.
ACCEPTED = "'easeoff run', 'modify', 'optimize', 'wear' or 'vh'"
#: What netCDF files of other commands are, by a variable that no result has.
OTHER_KINDS = {
    "print_excess": "of 'easeoff vh', for 'easeoff show', 'plot' and 'report'",
    "wear_depth": "of 'easeoff wear', for 'easeoff show', 'plot', 'report' and --deviation",
    "comparison_status": "the table of 'easeoff verify', for xarray.open_dataset",
    "solver_tolerance": "the table of 'easeoff compare', which wrote its report and pictures beside it",
}


def write_result(tree: xr.DataTree, path: str | os.PathLike[str]) -> None:
    """Write a result to a netCDF-4 file.

    Parameters
    ----------
    tree
        Result of ``analyze``, ``modify``, ``optimize`` or ``study.analyze_load_cases``.
    path
        The file, replaced if it exists; missing folders are made.

    Raises
    ------
    InputError
        If the file cannot be written; nothing is left behind then.

    Examples
    --------
    >>> import easeoff
    >>> from tempfile import TemporaryDirectory
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> with TemporaryDirectory() as folder:
    ...     easeoff.write_result(tree, f"{folder}/nasa.nc")
    ...     easeoff.read_result(f"{folder}/nasa.nc").identical(tree)
    True
    """
    instance("tree", tree, xr.DataTree)
    encoding = {
        node.path: {
            str(name): {"zlib": True, "complevel": 1}
            for name, variable in node.dataset.variables.items()
            if variable.dtype.kind in "fiu" and variable.nbytes >= COMPRESSED_SIZE
        }
        for node in tree.subtree
        if node.path != "/"
    }
    write_netcdf(tree, path, encoding)


def read_result(path: str | os.PathLike[str]) -> xr.DataTree:
    """Read a result from a netCDF-4 file, which is closed again.

    Parameters
    ----------
    path
        A file written by ``write_result`` or ``easeoff run``.

    Returns
    -------
    xr.DataTree
        Groups and variables as described in the page ``docs/engineer/reference/results.md``.

    Raises
    ------
    InputError
        If there is no such file, or it is no result of this package.

    Examples
    --------
    >>> import easeoff
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     easeoff.write_result(easeoff.analyze("nasa-12x36", torques=[100.0]), f"{folder}/nasa.nc")
    ...     tree = easeoff.read_result(f"{folder}/nasa.nc")
    >>> tree["loaded/peak_to_peak"].attrs["units"]
    'urad'
    """
    from ..cases.reading import CASE  # what is shown or drawn of a file needs no case

    source = file_path("path", path)
    if not os.path.exists(path) and str(path) in CASE.names():
        raise InputError(f"{named(source)} is a case, not a result: make one with 'easeoff run {source} -o FILE'")
    if source.suffix == ".toml":
        raise InputError(f"{source} is not a netCDF file; of a case make a result: 'easeoff run {source} -o FILE'")
    return checked_result(read_tree(source), source)


def checked_result(tree: xr.DataTree, source: Path) -> xr.DataTree:
    """The result that a file holds; raises as ``read_result``, which it ends."""
    if SWEEP_MARK in tree.attrs:
        raise InputError(f"{source} is of a sweep: easeoff.study.sweep.read_sweep reads it, 'easeoff show' shows it")
    defects = load_case_faults(tree) if "load_cases" in tree.children else faults(tree)
    if "easeoff_version" not in tree.attrs or defects == [f"no group {name}" for name in VARIABLES]:
        other = next((words for sign, words in OTHER_KINDS.items() if sign in tree.variables), None)
        description = f"is {other}" if other else "is a netCDF file, but no result of 'easeoff run'"
        raise InputError(f"{source} {description}: make a result with 'easeoff run CASE -o FILE'")
    defects = layout_fault(tree.attrs, "schema_version", RESULT_SCHEMA_VERSION) or defects
    if defects:
        raise unreadable(source, tree.attrs, defects, "easeoff run CASE -o FILE")
    return tree


def kind_of(given: xr.DataTree | xr.Dataset) -> str:
    """Kind of what is given: ``result``, ``sweep``, ``V-H check`` or ``wear``."""
    if SWEEP_MARK in given.attrs:
        return "sweep"
    if isinstance(given, xr.Dataset):
        return "wear" if "wear_depth" in given else "V-H check" if "print_excess" in given else "other"
    return "result"


def read_given(path: Path) -> xr.DataTree | xr.Dataset:
    """Read a result, a V-H check or wear from its file."""
    tree = tree_or_none(path)
    return read_result(path) if tree is None else checked_given(tree, path)


def checked_given(tree: xr.DataTree, path: Path) -> xr.DataTree | xr.Dataset:
    """The same of what a file holds."""
    dataset = tree.to_dataset()
    kind = kind_of(dataset)
    if kind == "other":
        return checked_result(tree, path)
    require_kind(named(path), kind)
    require_layout(named(path), dataset, kind)
    return dataset


def require_kind(name: str, kind: str) -> None:
    """Refuse what has no pictures."""
    if kind == "sweep":
        raise InputError(
            f"{name}: is of 'easeoff sweep', which keeps numbers and no pictures: must be a result of {ACCEPTED}; "
            "'easeoff show' and 'easeoff plot' show a sweep"
        )
    if kind == "other":
        raise InputError(f"{name}: must be a result of {ACCEPTED}")
