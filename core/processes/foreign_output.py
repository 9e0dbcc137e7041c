"""What libraries in other languages print: kept out of the standard output, which bears the results of a command."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

OUTPUT = 1  # descriptor of the standard output of a process


@contextmanager
def without_foreign_output() -> Iterator[None]:
    """Drop what is written to the descriptor of the standard output, by other threads as well.

    Examples
    --------
    >>> with without_foreign_output():
    ...     _ = os.write(1, b"Running HiGHS")
    """
    with suppress(OSError, ValueError):
        sys.stdout.flush()
    _flush()
    try:
        kept = os.dup(OUTPUT)
    except OSError:  # no standard output
        yield
        return
    try:
        with suppress(OSError), open(os.devnull, "wb") as nowhere:
            os.dup2(nowhere.fileno(), OUTPUT)
        yield
        _flush()
    finally:
        os.dup2(kept, OUTPUT)
        os.close(kept)


def _flush() -> None:
    """Write what the C library keeps of its standard output."""
    with suppress(OSError, AttributeError, TypeError):  # where the C library is not found like this
        ctypes.CDLL(None).fflush(None)
