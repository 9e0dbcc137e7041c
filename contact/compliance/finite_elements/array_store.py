"""Arrays kept on disk under a key, so that no tooth is factored twice; a full folder loses those longest unused."""

from __future__ import annotations

import contextlib
import hashlib
import os
import warnings
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import platformdirs
from numpy.typing import NDArray

from ....core.errors import InputError
from ....core.files import whole_file

Array = NDArray[Any]
FOLDER_VARIABLE = "EASEOFF_CACHE"
FOLDER_SIZE_LIMIT = 500e6  # [bytes], about fifty pairs
KEY_LENGTH = 40


def cache_folder() -> Path | None:
    """Folder of the arrays: ``EASEOFF_CACHE``, else the user's cache folder; ``None`` if that variable is empty."""
    named = os.environ.get(FOLDER_VARIABLE)
    if named is not None:
        return Path(named) if named else None
    return Path(platformdirs.user_cache_dir("easeoff", appauthor=False))


def key_of(*parts: Any) -> str:
    """Hexadecimal key of arrays by their values and of anything else by its ``repr``."""
    digest = hashlib.sha256()
    for part in parts:
        if isinstance(part, np.ndarray):
            digest.update(f"{part.dtype.str}{part.shape}".encode())
            digest.update(np.ascontiguousarray(part).tobytes())
        else:
            digest.update(repr(part).encode())
    return digest.hexdigest()[:KEY_LENGTH]


def kept(key: str, make: Callable[[], Mapping[str, Array]]) -> dict[str, Array]:
    """Arrays by name, read from disk if they are there, else made and kept.

    Of more than ``FOLDER_SIZE_LIMIT`` bytes those not asked for the longest are deleted. A file that cannot be read is
    made anew. If it cannot be written, a warning says so, and the arrays are returned all the same.

    Parameters
    ----------
    key
        From ``key_of``, of everything the arrays depend on.
    make
        Makes them.
    """
    folder = cache_folder()
    if folder is None:
        return dict(make())
    path = folder / f"{key}.npz"
    try:
        with np.load(path, allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in stored.files}
        with contextlib.suppress(OSError):  # of a folder that can only be read
            os.utime(path)
        return arrays
    except (OSError, ValueError, EOFError, KeyError, zipfile.BadZipFile):
        pass
    arrays = dict(make())
    try:
        with whole_file(path) as temporary, open(temporary, "wb") as stream:
            np.savez(stream, allow_pickle=False, **arrays)
        _make_room(folder, path)
    except InputError as error:
        warnings.warn(f"the tooth's compliance is not kept: {error}; set {FOLDER_VARIABLE}", stacklevel=2)
    return arrays


def _make_room(folder: Path, newest: Path) -> None:
    """Delete the files longest unused, except the newest, until the rest fits."""
    files = []
    for path in folder.glob(f"{'[0-9a-f]' * KEY_LENGTH}.npz"):
        with contextlib.suppress(OSError):  # another run may have deleted it just now
            status = path.stat()
            files.append((status.st_mtime, status.st_size, path))
    total = sum(size for _, size, _ in files)
    for _, size, path in sorted(files):
        if total <= FOLDER_SIZE_LIMIT:
            return
        if path != newest:
            with contextlib.suppress(OSError):
                path.unlink()
            total -= size
