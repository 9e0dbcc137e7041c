"""Private folder in which a file is written before it gets its name, and the remains of processes that were ended.

The folder has a name that nobody can guess and lets in its owner alone, so that no link can wait in it for what is
written. Its process holds the lock of a file in it: a folder whose lock is free belongs to a process that was ended.
"""

from __future__ import annotations

import contextlib
import os
import re
import secrets
import stat
from collections.abc import Iterator
from pathlib import Path

from .file_lock import try_lock

NAME = re.compile(r"\.easeoff-[0-9a-f]{16}\.tmp")
LOCK = "lock"
#: Folders made before it is given up; one is lost only to another run that clears up at the same instant.
ATTEMPT_COUNT = 20


@contextlib.contextmanager
def private_folder(parent: Path) -> Iterator[Path]:
    """Make a private folder in another, and remove it with everything in it on leaving.

    What processes that were ended have left in the other folder is removed first.

    Parameters
    ----------
    parent
        The other folder.

    Yields
    ------
    Path
        The private folder. It holds a file ``lock``; other names are free.

    Raises
    ------
    OSError
        If it cannot be made.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as parent:
    ...     with private_folder(Path(parent)) as folder:
    ...         oct(folder.stat().st_mode & 0o777)
    ...     folder.exists()
    '0o700'
    False
    """
    clear_remains(parent)
    folder, lock = _made(parent)
    try:
        yield folder
    finally:
        _remove(folder, lock)


def clear_remains(parent: Path) -> None:
    """Remove the private folders of processes that were ended: those of this user whose lock is free.

    Parameters
    ----------
    parent
        Folder to clear; it need not exist.

    Examples
    --------
    >>> clear_remains(Path("no such folder"))
    """
    with contextlib.suppress(OSError), os.scandir(parent) as entries:
        found = [Path(entry.path) for entry in entries if NAME.fullmatch(entry.name)]
        for folder in found:
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
            held = try_lock(lock)
        except OSError:  # no locks in this file system
            held = True
        if held and os.fstat(lock).st_nlink:
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
