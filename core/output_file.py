"""Files to be written: whole or not at all, and paths checked before any work is done.

A file is written in a private folder before it gets its name, and the permissions of one that it replaces. The folder
has a name that nobody can guess and lets in its owner alone, so that no link can wait in it for what is written. Its
process holds the lock of a file in it until it ends, however it ends: a folder whose lock is free belongs to a process
that was ended.
"""

from __future__ import annotations

import contextlib
import errno
import os
import re
import secrets
import stat
import sys
from collections.abc import Iterator
from pathlib import Path

from .checks import file_path
from .errors import InputError
from .file_name import check_name
from .regular_file import require_regular, status_of

ACCESS_LIST = "system.posix_acl_access"


def take_over_permissions(new: Path, old: Path) -> None:
    """Give a new file the owner, group, mode and access control list of the file that it is to replace.

    A group that cannot be kept gets no more than everybody. A link as the old file has nothing to pass on.
    """
    try:
        before = old.lstat()
    except FileNotFoundError:
        return
    if not stat.S_ISREG(before.st_mode):
        return
    mode = before.st_mode & 0o777
    for owner, group in ((before.st_uid, -1), (-1, before.st_gid)):
        with contextlib.suppress(AttributeError, OSError):
            os.chown(new, owner, group)
    if new.stat().st_gid != before.st_gid:
        mode &= 0o707 | (mode & 0o007) << 3
    elif hasattr(os, "setxattr"):
        try:
            os.setxattr(new, ACCESS_LIST, os.getxattr(old, ACCESS_LIST))
        except OSError:  # the old file has none, or the file system
            with contextlib.suppress(OSError):
                os.removexattr(new, ACCESS_LIST)
    os.chmod(new, mode)


NAME = re.compile(r"\.easeoff-[0-9a-f]{16}\.tmp")
LOCK = "lock"
#: Folders made before it is given up; one is lost only to another run that clears up at the same instant.
ATTEMPT_COUNT = 20


@contextlib.contextmanager
def private_folder(parent: Path) -> Iterator[Path]:
    """A private folder in another, cleared of remains first, removed on leaving; its file ``lock`` is taken."""
    clear_remains(parent)
    folder, lock = _made(parent)
    try:
        yield folder
    finally:
        _remove(folder, lock)


def clear_remains(parent: Path) -> None:
    """Remove the private folders of processes that were ended: those of this user whose lock is free."""
    with contextlib.suppress(OSError), os.scandir(parent) as entries:
        for folder in [Path(entry.path) for entry in entries if NAME.fullmatch(entry.name)]:
            with contextlib.suppress(OSError):
                _clear(folder)


def _clear(folder: Path) -> None:
    status = folder.lstat()
    if not stat.S_ISDIR(status.st_mode) or (hasattr(os, "geteuid") and status.st_uid != os.geteuid()):
        return
    try:
        lock = os.open(folder / LOCK, os.O_RDWR | getattr(os, "O_NOFOLLOW", 0))
    except FileNotFoundError:
        # Ended before it had a lock, or after it had removed it; one that is about to make its lock makes another.
        folder.rmdir()
        return
    try:
        dead = try_lock(lock)
    except OSError:  # no locks in this file system: nothing tells the living from the dead
        dead = False
    if dead:
        _remove(folder, lock)
    else:
        os.close(lock)


def _made(parent: Path) -> tuple[Path, int]:
    """Private folder, and the descriptor that holds its lock."""
    for _ in range(ATTEMPT_COUNT):
        folder = parent / f".easeoff-{secrets.token_hex(8)}.tmp"
        folder.mkdir(mode=0o700)
        try:
            lock = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
        except FileNotFoundError:  # cleared in this instant
            continue
        except OSError:
            with contextlib.suppress(OSError):
                folder.rmdir()
            raise
        try:
            locked = try_lock(lock)
        except OSError:  # no locks in this file system
            locked = True
        if locked and os.fstat(lock).st_nlink:
            return folder, lock
        os.close(lock)
    raise OSError(f"a temporary folder was removed {ATTEMPT_COUNT} times by another process")


def _remove(folder: Path, lock: int) -> None:
    """Remove a private folder; the lock goes last, so that the rest of an interrupted removal is found again."""
    with contextlib.suppress(OSError):
        for entry in sorted(folder.rglob("*"), reverse=True):
            if entry != folder / LOCK:
                with contextlib.suppress(OSError):
                    entry.rmdir() if entry.is_dir() and not entry.is_symlink() else entry.unlink()
    os.close(lock)
    with contextlib.suppress(OSError):
        (folder / LOCK).unlink()
        folder.rmdir()


#: Format of a suffix, in messages.
FORMATS = {".nc": "netCDF", ".toml": "TOML", ".html": "HTML", ".csv": "text in columns"}
SUFFIX_LENGTH_LIMIT = 10  # of a name under which a file is written


@contextlib.contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Path to write to in a private folder; the file gets its name when it is complete and on the disk.

    A replaced file leaves its permissions to the new one; a link is replaced, not its target. If writing fails, nothing
    is left behind and an earlier file stays. Of two processes that write one file, one leaves its whole file.
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
    except (OSError, UnicodeEncodeError) as error:
        raise InputError(f"{target} cannot be written: {getattr(error, 'strerror', None) or error}") from error
    except RuntimeError as error:
        # The netCDF library raises this for every failure; a full disk is the usual reason.
        if not str(error).startswith("NetCDF"):
            raise
        raise InputError(f"{target} cannot be written: {error}; is there room on the disk?") from error


@contextlib.contextmanager
def existing_folder(folder: Path) -> Iterator[None]:
    """Make a folder and those above it; if what follows fails, the new ones that are empty are removed."""
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
    """Refuse a file that cannot be written, has another suffix, or is one of its sources; leaves nothing behind."""
    target = file_path("path", path)
    _check_replaceable(target)
    for source in sources:
        if os.path.isfile(target) and os.path.isfile(source) and os.path.samefile(target, source):
            raise InputError(f"{target} is the file that is read: writing would destroy it; give another name")
    if suffix is not None and target.suffix.lower() != suffix:
        raise InputError(f"{target}: must be a name that ends in {suffix}; the file is written as {FORMATS[suffix]}")
    _check_access(target.parent, target)


def check_folder(path: str | os.PathLike[str], purpose: str) -> None:
    """Refuse a folder, which need not exist, that cannot be written to; leaves nothing behind."""
    target = Path(path)
    check_name(target)
    if os.path.exists(target) and not os.path.isdir(target):
        raise InputError(f"{target} is a file: give a folder for the {purpose}")
    _check_access(target, target)


def _check_replaceable(target: Path) -> None:
    """Check that a path can be that of a file, and that a file or link which is there may be replaced."""
    check_name(target)
    status = status_of(target)
    if status is not None:
        require_regular(status, str(target))
        if not os.access(target, os.W_OK):
            raise InputError(f"{target} cannot be written: no permission")
    kept_by_another = False
    with contextlib.suppress(OSError, ValueError):  # nothing to replace, or no longer
        owner, folder = os.lstat(target).st_uid, os.stat(target.parent)
        user = os.geteuid() if hasattr(os, "geteuid") else owner
        kept_by_another = bool(folder.st_mode & stat.S_ISVTX) and user not in (0, folder.st_uid, owner)
    if kept_by_another:
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


if sys.platform == "win32":
    import msvcrt
else:
    import fcntl


def try_lock(descriptor: int) -> bool:
    """True if an open file could be locked, False while another holds the lock; OSError without locks."""
    if sys.platform == "win32":
        try:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def wait_for_lock(descriptor: int) -> None:
    """Lock an open file once no other holds the lock; without effect on Windows or a file system without locks."""
    if sys.platform != "win32":
        with contextlib.suppress(OSError):
            fcntl.flock(descriptor, fcntl.LOCK_EX)
