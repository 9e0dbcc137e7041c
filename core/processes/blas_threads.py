"""Threads of the linear algebra library.

The matrices of a contact analysis are small: shared out over threads they take longer, and threads that wait take
processor time as well. How a product is shared out also decides its last bit.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Let linear algebra of this process run in one thread within this context.

    Examples
    --------
    >>> with one_blas_thread():
    ...     {library.num_threads for library in _libraries().lib_controllers if library.user_api == "blas"}
    {1}
    """
    with _libraries().limit(limits=1, user_api="blas"):
        yield


@cache
def _libraries() -> Any:
    """The libraries of this process, with numpy's and scipy's."""
    import scipy.linalg  # noqa: F401  # loads a library of its own
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
