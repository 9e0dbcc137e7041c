"""Files that are complete or not there at all."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

from .errors import InputError


@contextlib.contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Write a file under a temporary name beside it, and give it its own name when it is complete.

    Parameters
    ----------
    path
        The file, replaced if it exists; missing folders are made.

    Yields
    ------
    Path
        Where to write. If writing fails, nothing is left behind and a file that was there before stays as it was.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    target = Path(path)
    check_writable(target)
    temporary = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        yield temporary
        os.replace(temporary, target)
    except OSError as error:
        raise InputError(f"{target} cannot be written: {error.strerror or error}") from error
    except RuntimeError as error:
        # The netCDF library has no other exception, whatever went wrong; a full disk is the usual reason.
        if not str(error).startswith("NetCDF"):
            raise
        raise InputError(f"{target} cannot be written: {error}; is there room on the disk?") from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink()


def check_writable(path: str | os.PathLike[str], *sources: str | os.PathLike[str]) -> None:
    """Refuse an output path before any work is done for it; nothing is left behind.

    Parameters
    ----------
    path
        The file to be written.
    *sources
        What it is made from: files that shall not be overwritten, or names that are no files.

    Raises
    ------
    InputError
        If the folder does not exist and cannot be made, may not be written to, or the path is a folder, a
        device or one of the sources.
    """
    target = Path(path)
    if target.is_dir():
        raise InputError(f"{target} is a folder: give the name of a file")
    if target.exists() and not target.is_file():
        raise InputError(f"{target} is a device or a pipe, not a file: give the name of a file")
    for source in sources:
        if target.exists() and Path(source).is_file() and target.samefile(source):
            raise InputError(f"{target} is the file that is read: writing would destroy it; give another name")
    # Whether folders can be made is known by making them; until there is something to write they go again.
    missing = [folder for folder in target.parents if not folder.exists()]
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        allowed = os.access(target.parent, os.W_OK)
    except OSError as error:
        raise InputError(f"{target} cannot be written: {error.strerror or error}") from error
    finally:
        for folder in missing:
            with contextlib.suppress(OSError):
                folder.rmdir()
    if not allowed or (target.exists() and not os.access(target, os.W_OK)):
        raise InputError(f"{target} cannot be written: no permission")
