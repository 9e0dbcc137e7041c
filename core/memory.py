"""Memory that is free for this process, and refusal of work that needs more."""

from __future__ import annotations

import os
from pathlib import Path

from .checks import positive
from .errors import MEMORY_UNITS, InputError, memory_in_words

MEMORY_VARIABLE = "EASEOFF_MEMORY"  # [GB] to reckon with, instead of what is free
UNLIMITED = 2**60  # [byte]; limits above this are none


def require_memory(size: str, needed: float, what: str) -> None:
    """Refuse work that needs more memory [byte] than is free, if that is known; ``size`` names the numbers to lower."""
    free = available_memory()
    if free is None or needed <= free:
        return
    raise InputError(
        f"{size}: must be smaller, as {what} needs about {memory_in_words(needed)} of memory, and "
        f"{memory_in_words(free)} are free; the environment variable {MEMORY_VARIABLE} [GB] allows more or less"
    )


def available_memory() -> float | None:
    """Memory that this process may still take [byte]: the least that machine, container and process limit leave.

    The environment variable ``EASEOFF_MEMORY`` [GB] takes its place. ``None`` where the system does not tell.
    """
    given = os.environ.get(MEMORY_VARIABLE)
    if given:
        try:
            size = float(given)
        except ValueError:
            raise InputError(f"{MEMORY_VARIABLE} = {given[:80]!r}: must be a number above 0 [GB]") from None
        return positive(MEMORY_VARIABLE, size, "GB") * MEMORY_UNITS["GB"]
    known = [size for size in (_machine(), _container(Path("/")), _process()) if size is not None]
    return max(min(known), 0.0) if known else None


def _machine() -> float | None:
    """Memory that the machine has free, its caches included [byte]."""
    try:
        for line in Path("/proc/meminfo").read_text(encoding="ascii").splitlines():
            if line.startswith("MemAvailable:"):
                return 1024.0 * int(line.split()[1])
    except (OSError, ValueError):
        pass
    try:  # without Linux's files: all the memory that is built in
        return float(os.sysconf("SC_PAGE_SIZE")) * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, OSError, ValueError):
        return None


def _container(root: Path) -> float | None:
    """Least memory that the control groups of this process, below ``root``, leave [byte]; ``None`` without a limit."""
    left = []
    try:
        lines = (root / "proc/self/cgroup").read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError):
        return None
    for line in lines:
        _, controllers, path = [*line.split(":", 2), "", ""][:3]
        if controllers not in ("", "memory"):
            continue
        base = root / ("sys/fs/cgroup/memory" if controllers else "sys/fs/cgroup")
        limit, used = (
            ("memory.limit_in_bytes", "memory.usage_in_bytes") if controllers else ("memory.max", "memory.current")
        )
        group = base / path.strip("/")
        # Of a container the path may be that outside of it, which does not exist within.
        for folder in (base, *(one for one in (group, *group.parents) if base in one.parents)):
            most, now = _number(folder / limit), _number(folder / used)
            if most is not None and now is not None and most < UNLIMITED:
                left.append(most - now + _reclaimable(folder / "memory.stat"))
    return min(left) if left else None


def _number(file: Path) -> float | None:
    """The number in a file; none where there is no such file or number."""
    try:
        return float(int(file.read_text(encoding="ascii")))
    except (OSError, ValueError):
        return None


def _reclaimable(file: Path) -> float:
    """Pages of files in a control group's statistics, which make room when memory is short [byte]."""
    try:
        words = dict(line.split() for line in file.read_text(encoding="ascii").splitlines())
        return float(int(words.get("total_inactive_file", words.get("inactive_file", "0"))))
    except (OSError, ValueError):
        return 0.0


def _process() -> float | None:
    """Memory that the limit of this process's addresses leaves (``ulimit -v``) [byte]; none without a limit."""
    try:
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        if limit in (resource.RLIM_INFINITY, -1) or limit >= UNLIMITED:
            return None
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
        return float(limit - pages * os.sysconf("SC_PAGE_SIZE"))
    except (ImportError, OSError, ValueError):
        return None
