"""What libraries in other languages print: kept out of the standard output, which bears the results of a command."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress

OUTPUT, ERRORS = 1, 2  # descriptors of a process


@contextmanager
def foreign_output_on_errors() -> Iterator[None]:
    """Send what is written to the descriptor of the standard output to that of the errors instead.

    HiGHS prints its name whenever it is made, whatever it is told. Python's own ``sys.stdout`` must not be written to
    meanwhile.

    Examples
    --------
    >>> with foreign_output_on_errors():
    ...     _ = os.write(1, b"")
    """
    _flush()
    try:
        kept = os.dup(OUTPUT)
    except OSError:  # no standard output
        yield
        return
    try:
        with suppress(OSError):  # no standard error output
            os.dup2(ERRORS, OUTPUT)
        yield
        _flush()
    finally:
        os.dup2(kept, OUTPUT)
        os.close(kept)


def _flush() -> None:
    """Write what the C library keeps of its standard output."""
    with suppress(OSError, AttributeError, TypeError):  # where the C library is not found like this
        ctypes.CDLL(None).fflush(None)
