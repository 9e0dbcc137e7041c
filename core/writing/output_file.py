"""Files to be written: whole or not at all, and paths checked before any work is done."""

from __future__ import annotations

import contextlib
import errno
import os
import stat
from collections.abc import Iterator
from pathlib import Path

from ..checks import file_path
from ..errors import InputError
from .file_name import check_name
from .permissions import take_over_permissions
from .private_folder import private_folder

#: Format of a suffix, in messages.
FORMATS = {".nc": "netCDF", ".toml": "TOML", ".html": "HTML", ".csv": "text in columns"}
SUFFIX_LENGTH_LIMIT = 10  # of a name under which a file is written


@contextlib.contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Write a file in a private folder beside it, and give it its name when it is complete and on the disk.

    A file that is replaced leaves its permissions (mode, access control list, owner and group where the system allows
    it) to the new one. A link is replaced, not the file it points to. Of two processes that write the same file, one
    leaves its whole file. What an earlier process left that was ended while writing is removed.

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

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     with whole_file(f"{folder}/new/table.txt") as temporary:
    ...         _ = temporary.write_text("complete")
    ...     Path(f"{folder}/new/table.txt").read_text()
    'complete'
    """
    target = file_path("path", path)
    _check_replaceable(target)
    try:
        with existing_folder(target.parent), private_folder(target.parent) as folder:
            # A plain name: not every library that writes files takes every name. Absolute: one takes ~ for home.
            suffix = target.suffix if target.suffix.isascii() and len(target.suffix) <= SUFFIX_LENGTH_LIMIT else ""
            temporary = Path(os.path.abspath(folder / f"content{suffix}"))
            yield temporary
            take_over_permissions(temporary, target)
            _synchronize(temporary, os.O_RDWR)
            os.replace(temporary, target)
        with contextlib.suppress(PermissionError):  # a folder that may be written to, but not read
            _synchronize(target.parent, os.O_RDONLY)
    except OSError as error:
        raise InputError(f"{target} cannot be written: {error.strerror or error}") from error
    except UnicodeEncodeError as error:
        raise InputError(f"{target} cannot be written: {error}") from error
    except RuntimeError as error:
        # The netCDF library raises this for every failure; a full disk is the usual reason.
        if not str(error).startswith("NetCDF"):
            raise
        raise InputError(f"{target} cannot be written: {error}; is there room on the disk?") from error


@contextlib.contextmanager
def existing_folder(folder: Path) -> Iterator[None]:
    """Make a folder and those above it that are missing; if what follows fails, those that are empty are removed.

    Raises
    ------
    OSError
        If a folder cannot be made.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as parent:
    ...     with contextlib.suppress(ValueError), existing_folder(Path(parent, "new", "deep")):
    ...         raise ValueError
    ...     os.listdir(parent)
    []
    """
    missing = [parent for parent in (folder, *folder.parents) if not os.path.exists(parent)]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        yield
    except BaseException:
        for parent in missing:
            with contextlib.suppress(OSError):
                parent.rmdir()
        raise


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
    target = file_path("path", path)
    _check_replaceable(target)
    for source in sources:
        if os.path.isfile(target) and os.path.isfile(source) and os.path.samefile(target, source):
            raise InputError(f"{target} is the file that is read: writing would destroy it; give another name")
    if suffix is not None and target.suffix.lower() != suffix:
        raise InputError(f"{target}: must be a name that ends in {suffix}; the file is written as {FORMATS[suffix]}")
    _check_access(target.parent, target)


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
    check_name(target)
    if os.path.exists(target) and not os.path.isdir(target):
        raise InputError(f"{target} is a file: give a folder for the {purpose}")
    _check_access(target, target)


def _check_replaceable(target: Path) -> None:
    """Check that a path can be that of a file, and that a file or link which is there may be replaced."""
    check_name(target)
    if os.path.isdir(target):
        raise InputError(f"{target} is a folder: give the name of a file")
    if os.path.exists(target) and not os.path.isfile(target):
        raise InputError(f"{target} is a device or a pipe, not a file: give the name of a file")
    if os.path.exists(target) and not os.access(target, os.W_OK):
        raise InputError(f"{target} cannot be written: no permission")
    if os.path.lexists(target) and hasattr(os, "geteuid"):
        folder, user = os.stat(target.parent), os.geteuid()
        if folder.st_mode & stat.S_ISVTX and user not in (0, folder.st_uid, os.lstat(target).st_uid):
            raise InputError(f"{target} cannot be written: it is another user's, and only they can replace it there")


def _check_access(folder: Path, target: Path) -> None:
    """Check that a folder can be made and written to, and that a name in it can exist."""
    there = next(parent for parent in (folder, *folder.parents) if os.path.lexists(parent))
    if os.path.exists(there) and not os.access(there, os.W_OK):
        raise InputError(f"{target} cannot be written: no permission")
    try:
        # Only making them tells whether folders and names can be made.
        with private_folder(there) as trial:
            copy = trial.joinpath("trial", *(part for part in folder.relative_to(there).parts if part != ".."))
            copy.mkdir(parents=True)
            if target != folder:
                (copy / target.name).touch(exist_ok=False)
    except OSError as error:
        raise InputError(f"{target} cannot be written: {error.strerror or error}") from error


def _synchronize(path: Path, flags: int) -> None:
    """Wait until a file or folder is on the disk, as far as the file system can tell."""
    if flags == os.O_RDONLY and os.name == "nt":
        return  # folders cannot be opened there
    descriptor = os.open(path, flags)
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOSYS, errno.ENOTSUP):
            raise
    finally:
        os.close(descriptor)
