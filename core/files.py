"""Files to be written: whole or not at all, and paths checked before any work is done; see ``reading`` for others."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

from .errors import InputError

#: Format of a suffix, in messages.
FORMATS = {".nc": "netCDF", ".toml": "TOML"}


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
        Path to write to. If writing fails, nothing is left behind and an earlier file stays as it was.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    target = Path(path)
    check_writable(target)
    # Cut, because a name of the greatest length leaves no room for more.
    temporary = target.with_name(f".{target.name[:50]}.{os.getpid()}.tmp")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        yield temporary
        os.replace(temporary, target)
    except OSError as error:
        raise InputError(f"{target} cannot be written: {error.strerror or error}") from error
    except RuntimeError as error:
        # The netCDF library raises this for every failure; a full disk is the usual reason.
        if not str(error).startswith("NetCDF"):
            raise
        raise InputError(f"{target} cannot be written: {error}; is there room on the disk?") from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink()


def check_writable(path: str | os.PathLike[str], *sources: str | os.PathLike[str], suffix: str | None = None) -> None:
    """Check that a file can be written; nothing is left behind.

    Parameters
    ----------
    path
        The file to be written.
    *sources
        Its sources: files that must not be overwritten, or names that are no files.
    suffix
        Required suffix of the name; any if left out.

    Raises
    ------
    InputError
        If the name has another suffix or is too long, the folder does not exist and cannot be made, may not be written
        to, or the path is a folder, a device or one of the sources.
    """
    target = Path(path)
    if os.path.isdir(target):
        raise InputError(f"{target} is a folder: give the name of a file")
    if os.path.exists(target) and not os.path.isfile(target):
        raise InputError(f"{target} is a device or a pipe, not a file: give the name of a file")
    for source in sources:
        if os.path.isfile(target) and os.path.isfile(source) and os.path.samefile(target, source):
            raise InputError(f"{target} is the file that is read: writing would destroy it; give another name")
    if suffix is not None and target.suffix.lower() != suffix:
        raise InputError(f"{target}: must be a name that ends in {suffix}; the file is written as {FORMATS[suffix]}")
    _check_access(target.parent, target)
    if os.path.exists(target) and not os.access(target, os.W_OK):
        raise InputError(f"{target} cannot be written: no permission")


def check_folder(path: str | os.PathLike[str], purpose: str) -> None:
    """Check that a folder can be written to; nothing is left behind.

    Parameters
    ----------
    path
        The folder; it need not exist.
    purpose
        Its contents, as messages name them.

    Raises
    ------
    InputError
        If it is a file, its name is too long, or it cannot be made or written to.
    """
    target = Path(path)
    if os.path.exists(target) and not os.path.isdir(target):
        raise InputError(f"{target} is a file: give a folder for the {purpose}")
    _check_access(target, target)


def _check_access(folder: Path, target: Path) -> None:
    """Check that a folder can be made and written to, and that a name in it can exist."""
    # Only making folders tells whether they can be made; they are removed again until there is something to write.
    missing = [parent for parent in (folder, *folder.parents) if not os.path.exists(parent)]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with contextlib.suppress(FileNotFoundError):
            target.stat()
        allowed = os.access(folder, os.W_OK)
    except OSError as error:
        raise InputError(f"{target} cannot be written: {error.strerror or error}") from error
    finally:
        for parent in missing:
            with contextlib.suppress(OSError):
                parent.rmdir()
    if not allowed:
        raise InputError(f"{target} cannot be written: no permission")
