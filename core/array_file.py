"""Files of NumPy arrays (``.npz``): what the headers declare is checked before any array is read."""

from __future__ import annotations

import math
import os
import zipfile
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import InputError, memory_in_words
from .netcdf_file import unpacked_size_limit
from .regular_file import faults_in_words, named, require_file

ARRAY_COUNT_LIMIT = 1000


def read_arrays(path: str | os.PathLike[str]) -> dict[str, NDArray[Any] | None]:
    """Arrays of a file by name; ``None`` where it holds a Python object, which is never read."""
    limit = unpacked_size_limit()
    require_file(path, limit)
    with faults_in_words(path, "a file of NumPy arrays"), zipfile.ZipFile(path) as archive:
        entries = archive.infolist()
        size = sum(entry.file_size for entry in entries)
        if len(entries) > ARRAY_COUNT_LIMIT or size > limit:
            raise InputError(
                f"{named(path)} would take {memory_in_words(size)} in {len(entries)} arrays: at most "
                f"{memory_in_words(limit)} in {ARRAY_COUNT_LIMIT} arrays are read"
            )
        return {
            entry.filename.removesuffix(".npy"): _array(archive, entry)
            for entry in entries
            if entry.filename.endswith(".npy")
        }


def _array(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> NDArray[Any] | None:
    """Array of an entry, of no more bytes than the entry has."""
    with archive.open(entry) as stream:
        version = np.lib.format.read_magic(stream)
        if version not in ((1, 0), (2, 0)):
            raise ValueError(f"format {version} of the array {entry.filename!r} is unknown")
        read_header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, turned, kind = read_header(stream)
        if kind.hasobject:
            return None
        count = math.prod(map(int, shape))
        if count < 0 or count * max(kind.itemsize, 1) > entry.file_size:
            raise ValueError(f"the array {entry.filename!r} is longer than its entry")
        content = stream.read(count * kind.itemsize)
        stream.read()  # to the end, where the checksum is compared
    return np.frombuffer(content, dtype=kind, count=count).reshape(shape, order="F" if turned else "C").copy()
