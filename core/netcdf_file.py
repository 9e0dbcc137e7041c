"""netCDF files, read with every fault as one message, and written whole or not at all.

What the header declares is checked before any data are read. The libraries for netCDF and HDF5 crash on some damaged
files; they read in a process of their own.

The netCDF library follows links to other files without a question, and ends the process in a circle of groups. Neither
can be told not to; h5py names a link before it is followed. A file that netCDF writes has no such links.

A file of another version of the package that cannot be read is refused with the version that can.
"""

from __future__ import annotations

import contextlib
import importlib
import math
import os
import re
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from importlib.metadata import version
from typing import Any, TypeVar

import numpy as np
import xarray as xr

from .errors import InputError, memory_in_words, shortened
from .forked_process import ProcessEndedError, in_forked_process, netcdf_to_oneself
from .memory import available_memory
from .output_file import whole_file
from .regular_file import faults_in_words, named, reason, require_file

MEMBER_COUNT_LIMIT = 20_000  # groups and variables of a file


def check_links(path: str | os.PathLike[str]) -> None:
    """Refuse an HDF5 file with data in other files, links to names, a group in itself, or too many members."""
    import h5py

    if not h5py.is_hdf5(os.fspath(path)):
        return
    with h5py.File(os.fspath(path), "r") as file:
        waiting: list[Any] = [file]
        groups, members = {_address(file)}, 0
        while waiting:
            group = waiting.pop()
            members += len(group)
            if members > MEMBER_COUNT_LIMIT:
                raise InputError(f"{named(path)} has over {MEMBER_COUNT_LIMIT} groups and variables: it is not read")
            for name in group:
                if not isinstance(group.get(name, getlink=True), h5py.HardLink):
                    raise InputError(f"{named(path)} has links to other names or files: it is not read")
                member = group[name]
                if isinstance(member, h5py.Dataset):
                    if member.is_virtual or member.external:
                        raise InputError(f"{named(path)} has data in other files: it is not read")
                elif isinstance(member, h5py.Group):
                    if _address(member) in groups:
                        raise InputError(f"{named(path)} has a group under two names: it is not read")
                    groups.add(_address(member))
                    waiting.append(member)


def _address(group: Any) -> int:
    """Place of a group in its file, the same under all its names."""
    import h5py

    return int(h5py.h5o.get_info(group.id).addr)


Content = TypeVar("Content", xr.Dataset, xr.DataTree)

UNPACKED_SIZE_LIMIT = 4_000_000_000  # of all variables of a file in memory [bytes]
MEMORY_SHARE = 0.5  # of the free memory that the variables of a file may take
GROUP_COUNT_LIMIT = 1000
GROUP_DEPTH_LIMIT = 16
VARIABLE_COUNT_LIMIT = 10_000
NUMBER_SIZE = 8  # of a number in memory, at least: decoding may widen it [bytes]
STRING_SIZE = 64  # of a short string in memory [bytes]


class ReadingEndedError(InputError):
    """The process that read a file ended without a result; no other reader of this module fares better."""


def read_tree(path: str | os.PathLike[str]) -> xr.DataTree:
    """All groups of a netCDF file, in memory; the file is closed again. A file that declares too much is refused."""
    return _read(path, whole_tree)


def read_dataset(path: str | os.PathLike[str], *, square: bool = False) -> xr.Dataset:
    """Outermost group of a netCDF file, in memory; with ``square`` a variable may have one dimension twice."""
    return _read(path, group_dataset, square=square)


def tree_or_none(path: str | os.PathLike[str], *, square: bool = False) -> xr.DataTree | None:
    """Tree of a file, to tell its kind; ``None`` where the reader of that kind will say what is wrong with it.

    ReadingEndedError if the process that read it ended without a result.
    """
    try:
        return _read(path, whole_tree, square=square)
    except ReadingEndedError:
        raise
    except InputError:
        return None


def in_memory(content: Content) -> Content:
    """The tree or dataset with all values in memory, wherever xarray keeps them; the given one stays as it is.

    Values in memory are not copied; those whose file was closed, changed or removed are refused.
    """
    try:
        return _computed(content)
    except Exception as error:
        raise InputError(
            f"values that xarray keeps in a file cannot be read any more: {reason(error)}; open it again, call load()"
        ) from error


def _computed(content: Content) -> Content:
    """The content with all values in memory; ``DataTree.load`` leaves out variables that are called as their group."""
    if isinstance(content, xr.Dataset):
        return content.compute()
    groups = {
        "/" if node is content else node.relative_to(content): node.to_dataset(inherit=node is content).compute()
        for node in content.subtree
    }
    return xr.DataTree.from_dict(groups, name=content.name)


def whole_tree(file: Any) -> xr.DataTree:
    """Tree of all groups of an open netCDF file, in memory."""
    groups, waiting = {}, [file]
    while waiting:
        group = waiting.pop()
        groups[group.path] = group_dataset(group)
        waiting += reversed(group.groups.values())
    return xr.DataTree.from_dict(groups)


def group_dataset(group: Any) -> xr.Dataset:
    """Dataset of a group of an open netCDF file, in memory."""
    store = xr.backends.NetCDF4DataStore(group)  # type: ignore[no-untyped-call]
    return xr.open_dataset(store, engine="store", decode_times=False, decode_timedelta=False).compute()


def _read(path: str | os.PathLike[str], content: Callable[[Any], Content], *, square: bool = False) -> Content:
    """Content that a function takes from an open netCDF file, in a process of its own."""
    # Loaded here, once for all files: both libraries, and what xarray loads for the first index and variable.
    for library in ("netCDF4", "h5py"):
        importlib.import_module(library)
    xr.DataArray([0], coords={"x": [0]}).astype(float)

    def read() -> Content:
        with _opened(path, square=square) as file:
            result = content(file)
        result.encoding["source"] = os.path.abspath(path)  # as xarray does
        return result

    try:
        return in_forked_process(read)
    except ProcessEndedError as error:
        raise ReadingEndedError(f"{named(path)} is not a netCDF file, or it is damaged: {error}") from error


@contextlib.contextmanager
def _opened(path: str | os.PathLike[str], *, square: bool) -> Iterator[Any]:
    """An open netCDF file whose header was checked: every failure is one message, nothing is warned of."""
    from netCDF4 import Dataset

    limit = unpacked_size_limit()
    require_file(path, limit)
    if not os.path.getsize(path):
        raise InputError(f"{named(path)} is empty")
    with faults_in_words(path, "a netCDF file"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what an attribute misleads the decoding to shows in the values
        check_links(path)
        with Dataset(os.path.abspath(path)) as file:  # of a relative name the library drops leading blanks
            _check_header(file, path, limit, square=square)
            yield file


def unpacked_size_limit() -> int:
    """Greatest size of all variables of a file in memory [byte]: ``UNPACKED_SIZE_LIMIT``, less where less is free."""
    free = available_memory()
    return UNPACKED_SIZE_LIMIT if free is None else min(UNPACKED_SIZE_LIMIT, int(MEMORY_SHARE * free))


def _check_header(file: Any, path: str | os.PathLike[str], limit: int, *, square: bool) -> None:
    """Refuse a file by what its header declares: nested groups, types of its own, dimensions, and sizes."""
    size = count = variables = 0
    waiting: list[tuple[Any, int]] = [(file, 0)]
    while waiting:
        group, depth = waiting.pop()
        count, variables = count + 1, variables + len(group.variables)
        if depth > GROUP_DEPTH_LIMIT or count > GROUP_COUNT_LIMIT or variables > VARIABLE_COUNT_LIMIT:
            raise InputError(
                f"{named(path)} has too many groups or variables: more than {GROUP_COUNT_LIMIT} groups, "
                f"{GROUP_DEPTH_LIMIT} levels of groups or {VARIABLE_COUNT_LIMIT} variables are not read"
            )
        if group.cmptypes or group.vltypes or group.enumtypes:
            raise InputError(f"{named(path)} has data types of its own; numbers and text alone are read")
        for name, variable in group.variables.items():
            if not square and len(set(variable.dimensions)) < len(variable.dimensions):
                raise InputError(
                    f"{named(path)}: the variable {shortened(repr(str(name)))} has a dimension twice: must have "
                    "each once"
                )
        size += sum(_unpacked_size(path, variable) for variable in group.variables.values())
        waiting += [(child, depth + 1) for child in group.groups.values()]
    if size > limit:
        raise InputError(
            f"{named(path)} would take {memory_in_words(size)} in memory, by the sizes that it declares: must be at "
            f"most {memory_in_words(limit)}"
        )


def _unpacked_size(path: str | os.PathLike[str], variable: Any) -> int:
    """Size of a variable in memory [bytes], or of one of its chunks, if that is greater."""
    kind = variable.dtype
    if kind is not str and getattr(kind, "kind", "O") not in "fiuSU":
        raise InputError(
            f"{named(path)}: the variable {shortened(repr(str(variable.name)))} holds neither numbers nor text"
        )
    each = STRING_SIZE if kind is str else max(NUMBER_SIZE, int(kind.itemsize))
    chunks = variable.chunking()
    chunk = math.prod(map(int, chunks)) if isinstance(chunks, list | tuple) else 0
    return max(math.prod(map(int, variable.shape)), chunk) * each


COMPRESSED_SIZE = 4096  # [bytes] from which a variable is compressed: chunks of less take longer, and more room


class _LaterWriter:
    """Writer in place of xarray's that keeps the values back until all variables of the file are defined.

    Otherwise netCDF writes the header anew after each definition, in time with the square of the number of variables.
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


def write_netcdf(content: xr.Dataset | xr.DataTree, path: str | os.PathLike[str], *, packed: bool = False) -> None:
    """Write a dataset or a tree to a netCDF-4 file, replaced if it exists; missing folders are made.

    If it fails nothing is left behind. Many numbers are compressed; with ``packed``, as in files that other programs
    take over, all are, and no value stands for none.
    """
    from netCDF4 import Dataset

    tree = content if isinstance(content, xr.DataTree) else xr.DataTree(content)
    groups = [(node.relative_to(tree), in_memory(node.to_dataset(inherit=node is tree))) for node in tree.subtree]
    later = _LaterWriter()
    with whole_file(path) as temporary, netcdf_to_oneself(), Dataset(temporary, "w", format="NETCDF4") as file:
        for name, dataset in groups:
            group = file if name == "." else file.createGroup(name)
            store = xr.backends.NetCDF4DataStore(group, lock=False)  # type: ignore[no-untyped-call]
            numbers = {key: one for key, one in dataset.variables.items() if one.dtype.kind in "fiu"}
            encodings: dict[Any, dict[str, Any]] = {key: {"_FillValue": None} if packed else {} for key in numbers}
            for key in (key for key, one in numbers.items() if packed or one.nbytes >= COMPRESSED_SIZE):
                encodings[key] |= {"zlib": True, "complevel": 1}
            dataset.dump_to_store(store, writer=later, encoding=encodings)
        later.write()


FAULT_COUNT_LIMIT = 3  # that a message names
VERSION = re.compile(r"\d{1,4}(\.\d{1,6}){1,3}[a-z0-9.]{0,12}")


def layout_fault(attributes: Mapping[Any, Any], name: str, known: int) -> list[str]:
    """Fault of a file whose attribute ``name``, the number of its layout, is beyond the known; else empty."""
    number = attributes.get(name, known)
    if not isinstance(number, int | np.integer) or number <= known:
        return []
    return [f"its layout {name} = {number} is later than {known}"]


def unreadable(
    path: str | os.PathLike[str], attributes: Mapping[Any, Any], faults: Sequence[str], remedy: str
) -> InputError:
    """Error of a file with faults: damaged, or written by another version, which is named; ``remedy`` makes it anew."""
    more = f", and {len(faults) - FAULT_COUNT_LIMIT} more" if len(faults) > FAULT_COUNT_LIMIT else ""
    what = f"{'; '.join(faults[:FAULT_COUNT_LIMIT])}{more}"
    wrote, this_version = str(attributes.get("easeoff_version", "")), version("easeoff")
    if wrote != this_version and VERSION.fullmatch(wrote):
        return InputError(
            f"{named(path)} was written by easeoff {wrote} and this is {this_version}: {what}; easeoff {wrote} reads "
            f"it ('pip install easeoff=={wrote}'), or make it anew with '{remedy}'"
        )
    return InputError(
        f"{named(path)} is damaged, changed by hand or made by another version of easeoff: {what}; make it anew with "
        f"'{remedy}'"
    )
