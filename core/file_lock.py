"""Lock of an open file, held until the file is closed or its process ends, however it ends."""

from __future__ import annotations

import contextlib
import sys

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl


def try_lock(descriptor: int) -> bool:
    """Lock an open file; return whether this succeeded, which it does not while another holds the lock.

    Parameters
    ----------
    descriptor
        Of the open file.

    Raises
    ------
    OSError
        If the file system has no locks.

    Examples
    --------
    >>> from tempfile import TemporaryFile
    >>> with TemporaryFile() as file:
    ...     try_lock(file.fileno())
    True
    """
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
    """Lock an open file as soon as no other holds the lock; without effect where the file system has no locks.

    Without effect on Windows, too, where a lock is on bytes of a file and not on the file.

    Parameters
    ----------
    descriptor
        Of the open file.

    Examples
    --------
    >>> from tempfile import TemporaryFile
    >>> with TemporaryFile() as file:
    ...     wait_for_lock(file.fileno())
    ...     _ = file.write(b"alone")
    """
    if sys.platform != "win32":
        with contextlib.suppress(OSError):
            fcntl.flock(descriptor, fcntl.LOCK_EX)
