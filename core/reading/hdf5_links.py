"""Links of an HDF5 file that lead out of it or round in circles; a file that netCDF writes has none of them.

The netCDF library follows links to other files without a question, and ends the process in a circle of groups. Neither
can be told not to; h5py names a link before it is followed.
"""

from __future__ import annotations

import os
from typing import Any

from ..errors import InputError
from .regular_file import named

MEMBER_COUNT_LIMIT = 20_000  # groups and variables of a file


def check_links(path: str | os.PathLike[str]) -> None:
    """Refuse an HDF5 file with data in other files, links to names, or a group in itself.

    Parameters
    ----------
    path
        The file; an older format of netCDF, which has no links, passes.

    Raises
    ------
    InputError
        If it has such a link, or more groups and variables than ``MEMBER_COUNT_LIMIT``.
    """
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
