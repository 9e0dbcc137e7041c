"""Environment of the processes that the package starts."""

from __future__ import annotations

import contextlib
import os
import signal
import threading
from collections.abc import Iterator, Mapping
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


@contextlib.contextmanager
def child_environment(variables: Mapping[str, str] | None = None) -> Iterator[None]:
    """Set environment variables for processes started within, which import nothing from the current folder.

    Python starts them as ``python -c ...``, for which the current folder comes first: a file ``pickle.py`` there would
    run in place of Python's own. Once started they take over the path of modules of the process that started them.

    Parameters
    ----------
    variables
        Further variables.

    Examples
    --------
    >>> with child_environment({"OMP_NUM_THREADS": "1"}):
    ...     os.environ["PYTHONSAFEPATH"]
    '1'
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

    with contextlib.suppress(OSError):
        wait([sentinel])
    os._exit(1)


@contextlib.contextmanager
def children_without_interrupts() -> Iterator[None]:
    """Let processes started within ignore Ctrl-C: it is meant for the study, which ends them.

    Examples
    --------
    >>> with children_without_interrupts():
    ...     signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    True
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread may change this
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
