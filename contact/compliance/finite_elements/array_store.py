"""Arrays kept on disk under a key, so that no tooth is factored twice; a full folder loses those longest unused."""

from __future__ import annotations

import contextlib
import hashlib
import os
import warnings
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import platformdirs

from ....core.array_file import read_arrays
from ....core.arrays import Array
from ....core.errors import InputError
from ....core.output_file import whole_file

#: Shape of every array by name; ``None`` stands for any length.
Shapes = Mapping[str, tuple[int | None, ...]]

FOLDER_VARIABLE = "EASEOFF_CACHE"
FOLDER_SIZE_LIMIT = 500e6  # [bytes], about fifty pairs
KEY_LENGTH = 40
KEY_NAME, DIGEST_NAME = "key", "digest"  # of the key and of the digest of the arrays within their file
#: Folders of the package whose code makes the arrays.
CODE = ("geometry", "contact/compliance")


def cache_folder() -> Path | None:
    """Folder of the arrays: ``EASEOFF_CACHE``, else the user's cache folder; ``None`` if that variable is empty."""
    if (named := os.environ.get(FOLDER_VARIABLE)) is not None:
        return Path(named) if named else None
    return Path(platformdirs.user_cache_dir("easeoff", appauthor=False))


def key_of(*parts: Any) -> str:
    """Hexadecimal key of numbers, texts, arrays, dataclasses, tuples and lists by value, and of this release's code."""
    digest = hashlib.sha256(code_digest().encode())
    for part in parts:
        _add(digest, part)
    return digest.hexdigest()[:KEY_LENGTH]


def _add(digest: Any, part: Any) -> None:
    if isinstance(part, np.ndarray):
        digest.update(f"array {part.dtype.str}{part.shape}".encode())
        digest.update(np.ascontiguousarray(part).tobytes())
    elif is_dataclass(part) and not isinstance(part, type):
        digest.update(f"{type(part).__qualname__} {len(fields(part))}".encode())
        for field in fields(part):
            digest.update(field.name.encode())
            _add(digest, getattr(part, field.name))
    elif isinstance(part, tuple | list):
        digest.update(f"list {len(part)}".encode())
        for entry in part:
            _add(digest, entry)
    elif part is None or isinstance(part, str | int | float | np.generic):
        value = part.item() if isinstance(part, np.generic) else part
        digest.update(f"{type(value).__name__} {value!r};".encode())
    else:
        raise TypeError(f"{type(part).__name__} has no key by its value")


def content_digest(key: str, arrays: Mapping[str, Array]) -> str:
    """Hexadecimal digest of a key and of the arrays kept under it."""
    digest = hashlib.sha256(key.encode())
    for name in sorted(arrays):
        _add(digest, name)
        _add(digest, arrays[name])
    return digest.hexdigest()


@cache
def code_digest() -> str:
    """Digest of the code in ``CODE``."""
    root, digest = Path(__file__).parents[3], hashlib.sha256()
    for folder in CODE:
        for file in sorted((root / folder).rglob("*.py")):
            digest.update(f"{file.relative_to(root).as_posix()} ".encode() + file.read_bytes())
    return digest.hexdigest()


def kept(key: str, shapes: Shapes, make: Callable[[], Mapping[str, Array]]) -> dict[str, Array]:
    """Arrays by name, read from disk if they are there, else made and kept.

    A file that is damaged or of another key is replaced; beyond ``FOLDER_SIZE_LIMIT`` bytes the longest unused are
    deleted; a file that cannot be written gives a warning only.
    """
    if (folder := cache_folder()) is None:
        return dict(make())
    path = folder / f"{key}.npz"
    if (stored := _read(path, key, shapes)) is not None:
        return stored
    arrays = dict(make())
    with contextlib.suppress(OSError):  # of another user, in a folder where it can be removed
        if not os.access(path, os.W_OK):
            path.unlink()
    try:
        with whole_file(path) as temporary, open(temporary, "wb") as stream:
            labels = {KEY_NAME: np.array(key), DIGEST_NAME: np.array(content_digest(key, arrays))}
            np.savez(stream, allow_pickle=False, **arrays, **labels)
        _make_room(folder, path)
    except InputError as error:
        warnings.warn(f"the tooth's compliance is not kept: {error}; set {FOLDER_VARIABLE}", stacklevel=2)
    return arrays


def _read(path: Path, key: str, shapes: Shapes) -> dict[str, Array] | None:
    """Arrays of a file, or ``None`` if they are not all there as they must be."""
    try:
        arrays = read_arrays(path)
    except InputError:
        return None
    stored_key, digest = (str(arrays.pop(name, "")) for name in (KEY_NAME, DIGEST_NAME))
    if stored_key != key or arrays.keys() != shapes.keys() or any(array is None for array in arrays.values()):
        return None
    stored_arrays = {name: array for name, array in arrays.items() if array is not None}
    if digest != content_digest(key, stored_arrays):
        return None
    for name, shape in shapes.items():
        array = stored_arrays[name]
        fits = len(shape) == array.ndim and all(n in (None, m) for n, m in zip(shape, array.shape, strict=True))
        if not fits or array.dtype != float or not np.all(np.isfinite(array)):
            return None
    with contextlib.suppress(OSError):  # of a folder that can only be read
        os.utime(path)
    return stored_arrays


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
