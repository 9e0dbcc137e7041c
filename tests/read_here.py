"""Files that are read in this process: the copy of it, in which a library may crash, is for the tests of that."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from easeoff import InputError
from easeoff.contact.problem.exchange import fclib_file, matlab_file
from easeoff.core.processes.forked_process import ProcessEndedError
from easeoff.core.reading import netcdf_file


@contextmanager
def reading_here() -> Iterator[None]:
    """Read all kinds of files in this process within this context, with the same errors."""
    with pytest.MonkeyPatch.context() as patch:
        for module in (netcdf_file, fclib_file, matlab_file):
            patch.setattr(module, "in_forked_process", _in_this_process)
        yield


def _in_this_process(work: Callable[[], Any]) -> Any:
    try:
        return work()
    except InputError:
        raise
    except Exception as error:
        raise ProcessEndedError("the library that reads it crashed") from error
