"""Search for objects that refer to each other in circles, which Python does while it computes."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def without_garbage_collection(*, at_all: bool = False) -> Iterator[None]:
    """Leave the search to the end of this context: it takes a thirtieth of the time of an analysis.

    Parameters
    ----------
    at_all
        Whether the process ends after it: what it has made until then is never searched.

    Examples
    --------
    >>> with without_garbage_collection():
    ...     gc.isenabled()
    False
    >>> gc.isenabled()
    True
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
