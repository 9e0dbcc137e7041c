"""Environment of the processes that the package starts."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator, Mapping


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
