"""Permissions of a file that replaces another."""

from __future__ import annotations

import contextlib
import os
import stat
from pathlib import Path

ACCESS_LIST = "system.posix_acl_access"


def take_over_permissions(new: Path, old: Path) -> None:
    """Give a new file the owner, group, mode and access control list of the file it is to replace, if there is one.

    Only the administrator can give a file to another owner, and only members of a group to that group. A new file of
    another group grants that group no more than everybody.

    Parameters
    ----------
    new, old
        The two files; a link as the old one has nothing to pass on.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     new, old = Path(folder, "new"), Path(folder, "old")
    ...     new.touch()
    ...     old.touch(mode=0o600)
    ...     take_over_permissions(new, old)
    ...     oct(new.stat().st_mode & 0o777)
    '0o600'
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
