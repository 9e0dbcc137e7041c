"""Settings of processes: environment of those started, BLAS threads, freed memory, search for circles of objects.

The matrices of a contact analysis are small: shared out over threads they take longer, and threads that wait take
processor time as well. How a product is shared out also decides its last bit.
"""

from __future__ import annotations

import gc
import os
import signal
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache
from typing import Any

#: Numbers of threads, which libraries read when they are loaded. Processes that share a machine take one thread each,
#: and a comparison is of methods, not of how many cores a library takes.
THREAD_VARIABLES = (
    "OPENBLAS_NUM_THREADS",
    "OMP_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "RAYON_NUM_THREADS",
)


@contextmanager
def child_environment(variables: Mapping[str, str] | None = None) -> Iterator[None]:
    """Set environment variables for processes started within, which import nothing from the current folder.

    For ``python -c`` that comes first: a file ``pickle.py`` there would run. Once started they take over the path of
    modules of the process that started them.
    """
    wanted = {"PYTHONSAFEPATH": "1", **(variables or {})}
    before = {name: os.environ.get(name) for name in wanted}
    os.environ.update(wanted)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def end_with_parent() -> None:
    """Let this process end when the one ends that started it, however that does; for those of multiprocessing."""
    import multiprocessing

    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_with(sentinel: Any) -> None:
    from multiprocessing.connection import wait

    with suppress(OSError):
        wait([sentinel])
    os._exit(1)


@contextmanager
def children_without_interrupts() -> Iterator[None]:
    """Let processes started within ignore Ctrl-C: it is meant for the study, which ends them."""
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread may change this
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Let linear algebra of this process run in one thread within this context."""
    with _libraries().limit(limits=1, user_api="blas"):
        yield


@cache
def _libraries() -> Any:
    """The libraries of this process, with numpy's and scipy's."""
    import scipy.linalg  # noqa: F401  # loads a library of its own
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


# Parameters of glibc's ``mallopt`` and their values [byte].
MMAP_THRESHOLD, LARGEST_KEPT_ARRAY = -3, 2**25
TRIM_THRESHOLD, KEPT_MEMORY = -1, 2**28


def keep_freed_memory() -> None:
    """Let this process keep 256 MB that it has freed, if it has glibc: page faults cost a twentieth of an analysis."""
    if os.name != "posix":
        return
    import ctypes

    library = ctypes.CDLL(None)
    if hasattr(library, "mallopt"):
        library.mallopt(MMAP_THRESHOLD, LARGEST_KEPT_ARRAY)
        library.mallopt(TRIM_THRESHOLD, KEPT_MEMORY)


@contextmanager
def without_garbage_collection(*, at_all: bool = False) -> Iterator[None]:
    """Put off the search for garbage, a thirtieth of the time of an analysis, to the end of this context.

    With ``at_all``, where the process ends after it, what it has made until then is never searched.
    """
    searches = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if at_all:
            gc.freeze()
        if searches:
            gc.enable()
