"""Memory that a process has freed."""

from __future__ import annotations

import os

# Parameters of glibc's ``mallopt`` and their values [byte].
MMAP_THRESHOLD, LARGEST_KEPT_ARRAY = -3, 2**25
TRIM_THRESHOLD, KEPT_MEMORY = -1, 2**28


def keep_freed_memory() -> None:
    """Let this process keep 256 MB that it has freed, if its C library is glibc.

    Otherwise arrays above 128 kB go back to the system, and the next ones cost a page fault for every four kilobytes: a
    twentieth of the time of an analysis.

    Examples
    --------
    >>> keep_freed_memory()
    """
    if os.name != "posix":
        return
    import ctypes

    library = ctypes.CDLL(None)
    if hasattr(library, "mallopt"):
        library.mallopt(MMAP_THRESHOLD, LARGEST_KEPT_ARRAY)
        library.mallopt(TRIM_THRESHOLD, KEPT_MEMORY)
