"""A package that is not imported although it is installed."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def without_package(name: str) -> Iterator[None]:
    """Let imports of a package fail within this context, as if it were not installed; unless it is loaded already.

    Libraries then leave out what they would do with it. Those that look for it once do not find it later, either.

    Parameters
    ----------
    name
        Name of the package.

    Examples
    --------
    >>> from importlib.util import find_spec
    >>> with without_package("wave"):
    ...     find_spec("wave")
    >>> find_spec("wave").name
    'wave'
    """
    if name in sys.modules:
        yield
        return
    sys.modules[name] = None  # type: ignore[assignment]  # Python's own sign for it
    try:
        yield
    finally:
        sys.modules.pop(name, None)
